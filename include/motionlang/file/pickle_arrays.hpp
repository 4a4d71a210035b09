// SPDX-License-Identifier: MIT
/// Arrays in pickles: NumPy's arrays and scalars, joblib's, which lie between the opcodes, SciPy's sparse matrices, and
/// chumpy's nodes (in the first files of SMPL).
///
///     Pickle dump = Pickle::open("grouped.pth.tar", {.inline_bytes = joblib_array_bytes});
///
/// Source  NumPy: numpy/lib/format.py, numpy.core.multiarray._reconstruct; joblib/numpy_pickle.py; chumpy.ch.Ch
#pragma once

#include <span>    // bytes
#include <string>  // element type
#include <vector>  // shape

#include <motionlang/file/npy.hpp>
#include <motionlang/file/pickle.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

bool is_joblib_array(const PickleValue& v);
bool is_numpy_scalar(const PickleValue& v);
bool is_numpy_array(const PickleValue& v);

/// An array of NumPy as stored in the file. The bytes live as long as the Pickle and the file.
struct PickledArray {
  std::string type;  // NumPy's: "<f4"
  bool fortran_order = false;
  std::vector<Index> shape;
  std::span<const std::byte> raw;
  std::string where;  // for messages
};
PickledArray pickled_array(const PickleValue& v);

}  // namespace detail

/// The place of the bytes of a joblib array, for PickleOptions. In newer files, a number of bytes precedes them that
/// pads to an aligned address.
/// Throws  io_error 403 if its description is damaged, 404 for arrays of objects
InlineBytes joblib_array_bytes(const PickleValue& object, std::span<const std::byte> file, std::uint64_t position);

/// The array in a value of a pickle: from NumPy or joblib, a single number, a sparse matrix of SciPy in full (csc, csr,
/// coo; as real numbers), or the value of a chumpy node.
/// Throws  io_error 402, 403 if it is damaged, 404 for unsupported elements and classes, 405 for impossible sizes, 407
///         if the value is not an array
NpyArray to_array(const PickleValue& value);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/pickle_arrays.ipp>
#endif
