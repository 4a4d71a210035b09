// SPDX-License-Identifier: MIT
// Bodies of the headers in file/, compiled once for motionlang::instantiated.
#include <motionlang/file/detail/bytes.ipp>
#include <motionlang/file/detail/deflate.ipp>
#include <motionlang/file/detail/inflate.ipp>
#include <motionlang/file/detail/npy_header.ipp>
#include <motionlang/file/file.ipp>
#include <motionlang/file/file_value.ipp>
#include <motionlang/file/gzip.ipp>
#include <motionlang/file/id_list.ipp>
#include <motionlang/file/key_report.ipp>
#include <motionlang/file/npy.ipp>
#include <motionlang/file/npz.ipp>
#include <motionlang/file/output_folder.ipp>
#include <motionlang/file/pickle.ipp>
#include <motionlang/file/pickle_arrays.ipp>
#include <motionlang/file/png.ipp>
#include <motionlang/file/project_folder.ipp>
#include <motionlang/file/safetensors.ipp>
#include <motionlang/file/tensor_memory.ipp>
#include <motionlang/file/tensor_set.ipp>
#include <motionlang/file/tensor_view.ipp>
#include <motionlang/file/torch_archive.ipp>
#include <motionlang/file/torch_file.ipp>
#include <motionlang/file/zip.ipp>

template void motionlang::copy_values(const TensorView& view, std::span<float> out);
template void motionlang::copy_values(const TensorView& view, std::span<double> out);
template std::vector<float> motionlang::NpyArray::to() const;
template std::vector<double> motionlang::NpyArray::to() const;
template std::vector<std::int64_t> motionlang::NpyArray::to() const;
