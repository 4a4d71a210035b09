// SPDX-License-Identifier: MIT
/// PyTorch's files: zip archives (torch >= 1.6), TorchScript archives, and the older form of five pickles and raw
/// storages.
///
///     const TorchFile file = TorchFile::open("model.ckpt");
///     const TensorView bias = file.tensor(file.root()["state_dict"]["head.bias"]);
///
/// The objects in the file are a pickle, which is read without executing anything (file/pickle.hpp). This class returns
/// its tensors. Tensors that lie in order in the file are views of it, without a copy. Others (transposed, expanded,
/// big-endian) are gathered. weights/weight_file.hpp finds all tensors of a file by their names.
///
/// Checked  sizes, strides and offsets against the storage; storages against the archive; the checksum of the pickle
/// Source   pytorch/pytorch torch/serialization.py (_save, _legacy_save) and torch/_utils.py (_rebuild_tensor_v2)
#pragma once

#include <memory>  // what keeps the bytes

#include <motionlang/file/pickle.hpp>
#include <motionlang/file/tensor_memory.hpp>
#include <motionlang/file/tensor_view.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The magic number of an older file, after the first two bytes of pickles of protocol 2 and later.
inline constexpr std::string_view torch_legacy_number{"\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e", 13};

class TorchTensors;

}  // namespace detail

class ZipArchive;

class TorchFile {
 public:
  /// Throws  io_error 401; 402, 403, 405 if the file is damaged; 404 for unsupported content, and for names that only
  ///         an attack needs
  static TorchFile open(const FilePath& path);
  /// A file in memory. `owner` keeps the bytes alive; without an owner they must outlive the object. Messages contain
  /// `name`.
  static TorchFile from_bytes(std::span<const std::byte> bytes, const std::string& name,
                              std::shared_ptr<const void> owner = {});
  /// A file of the older form.
  static TorchFile from_legacy(std::span<const std::byte> bytes, const std::string& name,
                               const std::shared_ptr<TensorMemory>& memory);
  /// An archive that is already open. `checksums`: also compare those of stored storages, which reads all of them.
  static TorchFile from_archive(const ZipArchive& zip, const std::shared_ptr<TensorMemory>& memory,
                                bool checksums = false);

  /// A plain pickle, whose tensors contain their storages.
  static TorchFile from_pickle(Pickle pickle, const std::shared_ptr<TensorMemory>& memory);

  static bool is_legacy(std::span<const std::byte> bytes);
  /// The first folder of an archive that has a data.pkl, with a slash; empty if there is none.
  static std::string root_folder(const ZipArchive& zip);

  /// Bytes after the pickle of an archive, which mean nothing.
  std::uint64_t bytes_behind() const { return behind_; }
  /// "torch zip", "TorchScript", "torch legacy" or "pickle".
  const std::string& format() const { return format_; }
  PickleValue root() const { return object_.root(); }
  static bool is_tensor(const PickleValue& v);
  /// Do not call this from several threads at once: it counts the memory of tensors.
  /// Throws  io_error 403, 405 if the tensor does not fit its storage, 404 if its element type is unknown, 407 if the
  ///         value is not a tensor
  TensorView tensor(const PickleValue& v) const;
  /// Keeps the bytes of all tensors alive.
  const std::shared_ptr<TensorMemory>& owner() const { return memory_; }

 private:
  TorchFile(Pickle object, detail::TorchTensors tensors, std::shared_ptr<TensorMemory> memory, std::string format);
  static bool is_root_pickle(std::string_view member);

  Pickle object_;
  std::shared_ptr<const detail::TorchTensors> tensors_;
  std::shared_ptr<TensorMemory> memory_;
  std::string format_;
  std::uint64_t behind_ = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/torch_file.ipp>
#endif
