// SINC's body parts of golden cases: rows of six bits.
#pragma once

#include <motionlang/kinematics/sinc_parts.hpp>

#include "golden.hpp"

namespace golden {

inline std::vector<ml::SincParts> part_vectors(const Case& c, const std::string& name) {
  const auto bits = c.values<ml::Index>("in/" + name);
  std::vector<ml::SincParts> out(bits.size() / ml::sinc_part_count);
  for (std::size_t i = 0; i < bits.size(); ++i) out[i / ml::sinc_part_count][i % ml::sinc_part_count] = bits[i] != 0;
  return out;
}

}  // namespace golden
