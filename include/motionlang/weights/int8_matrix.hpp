// SPDX-License-Identifier: MIT
/// Matrices of weights as whole numbers of 8 bits: half of the place of F16. write_safetensors_copy writes them, and
/// load_module reads them like other weights.
///
///     X[row, column] = codes[row, column] * scales[row, column / 64]
///
/// Tensors    X (rows, columns) I8, -127 to 127; X.scales (rows, groups of 64 columns) F16, the last group may be
///            shorter
/// Rounding   a scale is the least normal half that brings the largest value of its group to at most 127, or 0; ties to
///            even. So a value is at most half a scale away from its original, or 2^-15 if that is more. A copy of a
///            copy has the same bits
/// Notation   X, the name of the tensor -> codes and X.scales
#pragma once

#include <cstdint>  // codes
#include <span>     // values
#include <string>   // names
#include <vector>   // codes

#include <motionlang/file/tensor_set.hpp>

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr Index int8_group = 64;                // columns with one scale
inline constexpr const char* int8_scales = ".scales";  // behind the name of the matrix

/// A matrix in that form, with its own memory.
struct Int8Matrix {
  std::vector<std::int8_t> codes{};
  std::vector<std::uint16_t> scales{};  // halves
  Index rows = 0, columns = 0;
};

/// The number of groups of a row.
constexpr Index int8_groups(Index columns) { return (columns + int8_group - 1) / int8_group; }

/// Values (rows, columns). Throws numeric_error 301 for NaN, infinity, and a value that is too large for a scale.
Int8Matrix int8_matrix(std::span<const float> values, Index rows, Index columns, const std::string& name);

/// The scales of a tensor, or NULL if it is not a matrix in that form. Throws io_error 407 for scales of another type
/// or shape.
const TensorView* int8_scales_of(const TensorSet& file, const TensorView& tensor);
/// True for the scales of such a matrix in the same file.
bool is_int8_scales(const TensorSet& file, const TensorView& tensor);

/// The values of such a matrix. Throws shape_error 205 if `out` has another size.
template <class S>
void copy_int8_values(const TensorView& codes, const TensorView& scales, std::span<S> out) {
  const auto code = values_of<std::int8_t>(codes);
  const auto scale = values_of<float>(scales);
  if (code.size() != out.size())
    raise<shape_error>(205, "tensor '", codes.name, "' of shape ", codes.shape, " does not have ",
                       counted(out.size(), "value"));
  const auto columns = static_cast<std::size_t>(codes.shape[1]);
  const auto groups = static_cast<std::size_t>(scales.shape[1]);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t row = i / columns, group = i % columns / static_cast<std::size_t>(int8_group);
    out[i] = static_cast<S>(static_cast<float>(code[i]) * scale[row * groups + group]);
  }
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/int8_matrix.ipp>
#endif
