// Generators from the seed of a case.
#pragma once

#include <concepts>
#include <cstdint>

#include <motionlang/core/python_random.hpp>
#include <motionlang/file/json.hpp>

namespace golden {

namespace ml = motionlang;

/// The seed may be negative or above 2^63.
template <class G>
G seeded(const ml::JsonView& seed) {
  if (seed.json().is_number_unsigned()) return G(seed.as<std::uint64_t>());
  const auto number = seed.as<std::int64_t>();
  if constexpr (std::same_as<G, ml::PythonRandom>)
    return G(number);  // takes its absolute value
  else
    return G(static_cast<std::uint64_t>(number));
}

}  // namespace golden
