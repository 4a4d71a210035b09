// SPDX-License-Identifier: MIT
/// Weights of any format as one safetensors file, with the other values of the file in the metadata.
///
///     write_safetensors_copy("model.safetensors", open_weights("last.ckpt"), DType::F16);
#pragma once

#include <optional>  // element type

#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Smaller matrices, vectors and single numbers keep their type when `stored` is I8.
inline constexpr Index int8_matrix_least = 4096;  // numbers

/// stored  element type to which floating-point tensors are rounded; none: unchanged. I8: matrices of at least
///         int8_matrix_least numbers become whole numbers of 8 bits (weights/int8_matrix.hpp), and the rest stays.
///         Such matrices become floating-point numbers again with any other type. Tensors of captions and of
///         remembered motions (`captions.*`, `memory.*`) keep their types
/// Throws  io_error 401, and what write_safetensors, TensorStore::add and int8_matrix throw
void write_safetensors_copy(const FilePath& path, const WeightFile& weights, std::optional<DType> stored = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/safetensors_copy.ipp>
#endif
