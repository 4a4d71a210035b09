// SPDX-License-Identifier: MIT
// Bodies of int8_matrix.hpp.
#pragma once

#include <algorithm>  // max, min
#include <cmath>      // abs, nearbyint

#include <motionlang/weights/int8_matrix.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A scale: the least normal half that is not below a number, or 0 if all codes are 0 with the least normal half.
/// Halves below that are coarser, and the codes of a copy of a copy would differ.
inline std::uint16_t half_at_least(float x) {
  constexpr float least = 6.103515625e-5F;  // 2^-14
  if (127 * x <= least / 2) return 0;       // all codes are 0
  if (x < least) return float_to_half(least);
  const std::uint16_t nearest = float_to_half(x);
  return half_to_float(nearest) < x ? static_cast<std::uint16_t>(nearest + 1) : nearest;
}

}  // namespace detail

MOTIONLANG_BODY Int8Matrix int8_matrix(std::span<const float> values, Index rows, Index columns,
                                       const std::string& name) {
  if (std::ssize(values) != rows * columns)
    raise<shape_error>(205, "int8_matrix: ", counted(values.size(), "value"), " for '", name, "' of ", rows,
                       " rows of ", columns);
  constexpr float largest_code = 127, largest_half = 65504;
  Int8Matrix out{.codes = {}, .scales = {}, .rows = rows, .columns = columns};
  out.codes.reserve(values.size());
  for (Index row = 0; row < rows; ++row) {
    for (Index first = 0; first < columns; first += int8_group) {
      const auto group = values.subspan(static_cast<std::size_t>(row * columns + first),
                                        static_cast<std::size_t>(std::min(int8_group, columns - first)));
      float most = 0;
      for (const float x : group) {
        if (!(std::abs(x) <= largest_code * largest_half))
          raise<numeric_error>(301, "int8_matrix: '", name, "' has ", x, " in row ", row, ", too large for a scale");
        most = std::max(most, std::abs(x));
      }
      out.scales.push_back(detail::half_at_least(most / largest_code));
      const float scale = half_to_float(out.scales.back());
      for (const float x : group) {
        const float code = scale == 0 ? 0 : std::nearbyint(x / scale);
        out.codes.push_back(static_cast<std::int8_t>(std::max(-largest_code, std::min(code, largest_code))));
      }
    }
  }
  return out;
}

MOTIONLANG_BODY const TensorView* int8_scales_of(const TensorSet& file, const TensorView& tensor) {
  if (tensor.dtype != DType::I8 || tensor.shape.rank() != 2) return nullptr;
  const TensorView* const scales = file.find(tensor.name + int8_scales);
  if (scales == nullptr) return nullptr;
  const FileShape expected{tensor.shape[0], int8_groups(tensor.shape[1])};
  if (scales->dtype != DType::F16 || scales->shape != expected)
    raise<io_error>(407, file.name(), ": tensor '", scales->name, "' is ", scales->dtype, " ", scales->shape,
                    ", the scales of '", tensor.name, "' are ", DType::F16, " ", expected);
  return scales;
}

MOTIONLANG_BODY bool is_int8_scales(const TensorSet& file, const TensorView& tensor) {
  const std::string_view name = tensor.name, end = int8_scales;
  if (!name.ends_with(end)) return false;
  const TensorView* const codes = file.find(name.substr(0, name.size() - end.size()));
  return codes != nullptr && int8_scales_of(file, *codes) == &tensor;
}

MOTIONLANG_NAMESPACE_END
