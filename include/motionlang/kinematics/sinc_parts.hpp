// SPDX-License-Identifier: MIT
/// The six body parts of SINC and their joints. STMC's five are in body_parts.hpp.
///
/// Source  thesis B.2.1; SINC (Athanasiou et al., ICCV 2023) sinc/info/joints.py get_compat_matrix
#pragma once

#include <array>        // lists of parts
#include <bitset>       // sets of parts
#include <optional>     // unknown names
#include <string_view>  // names

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// In the order of SINC's part vectors. `global` is the pelvis: the place and orientation of the body.
enum class SincPart : std::size_t { global, torso, left_arm, right_arm, left_leg, right_leg };
inline constexpr std::size_t sinc_part_count = 6;
inline constexpr std::array<std::string_view, sinc_part_count> sinc_part_names{"global",    "torso",    "left arm",
                                                                               "right arm", "left leg", "right leg"};

/// A set of parts; bit i is part i of the vector.
using SincParts = std::bitset<sinc_part_count>;
template <class... Part>
SincParts sinc_parts(Part... parts) {
  SincParts out;
  (out.set(static_cast<std::size_t>(parts)), ...);
  return out;
}
inline bool has(const SincParts& parts, SincPart part) { return parts[static_cast<std::size_t>(part)]; }

/// Does not throw: an unknown name gives nothing.
constexpr std::optional<SincPart> parse_sinc_part(std::string_view name) {
  for (std::size_t p = 0; p < sinc_part_count; ++p) {
    if (name == sinc_part_names[p]) return static_cast<SincPart>(p);
  }
  return std::nullopt;
}

/// True if no part acts in both, so that both actions can be done at the same time.
inline bool are_compatible(const SincParts& a, const SincParts& b) { return (a & b).none(); }

/// Part of each of SMPL's first 22 joints. Collars belong to the arms, neck and head to the torso.
inline constexpr std::array<SincPart, 22> sinc_part_of_joint = [] {
  using enum SincPart;
  return std::array{global,    left_leg,  right_leg, torso,     left_leg, right_leg, torso,     left_leg,
                    right_leg, torso,     left_leg,  right_leg, torso,    left_arm,  right_arm, torso,
                    left_arm,  right_arm, left_arm,  right_arm, left_arm, right_arm};
}();

MOTIONLANG_NAMESPACE_END
