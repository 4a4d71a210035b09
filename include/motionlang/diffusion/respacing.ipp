// SPDX-License-Identifier: MIT
// Bodies of respacing.hpp.
#pragma once

#include <charconv>  // from_chars
#include <cmath>     // nearbyint

#include <motionlang/diffusion/respacing.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> respace(Index steps, std::span<const Index> counts) {
  std::vector<Index> kept;
  const auto sections = static_cast<Index>(counts.size());
  if (sections == 0) raise<config_error>(105, "respacing: no sections");
  Index begin = 0;
  for (Index i = 0; i < sections; ++i) {
    const Index size = steps / sections + (i < steps % sections ? 1 : 0), count = counts[static_cast<std::size_t>(i)];
    if (count < 0 || size < count)
      raise<config_error>(105, "respacing: cannot take ", count, " of ", size, " steps in section ", i);
    const double stride = count > 1 ? static_cast<double>(size - 1) / static_cast<double>(count - 1) : 1;
    double position = 0;
    for (Index k = 0; k < count; ++k, position += stride)
      kept.push_back(begin + static_cast<Index>(std::nearbyint(position)));
    begin += size;
  }
  if (kept.empty()) raise<config_error>(105, "respacing: no steps are kept of ", steps);
  return kept;
}

MOTIONLANG_BODY std::vector<Index> respace(Index steps, std::string_view specification) {
  auto number = [&](std::string_view digits) {
    while (digits.starts_with(' ')) digits.remove_prefix(1);  // as Python reads numbers
    while (digits.ends_with(' ')) digits.remove_suffix(1);
    Index n = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
    if (error != std::errc{} || end != digits.data() + digits.size() || n < 0) {
      raise<config_error>(105, "respacing: '", specification, "' is neither ddimN nor a list of counts");
    }
    return n;
  };
  if (specification.empty()) return respace(steps, std::vector<Index>{steps});
  if (specification.starts_with("ddim")) {
    const Index wanted = number(specification.substr(4));
    for (Index stride = 1; stride < steps; ++stride) {
      if ((steps + stride - 1) / stride != wanted) continue;
      std::vector<Index> kept;
      for (Index t = 0; t < steps; t += stride) kept.push_back(t);
      return kept;
    }
    raise<config_error>(105, "respacing: no stride keeps ", wanted, " of ", steps, " steps");
  }
  std::vector<Index> counts;
  for (std::size_t at = 0; at <= specification.size();) {
    const std::size_t comma = std::min(specification.find(',', at), specification.size());
    counts.push_back(number(specification.substr(at, comma - at)));
    at = comma + 1;
  }
  return respace(steps, counts);
}

MOTIONLANG_NAMESPACE_END
