// SPDX-License-Identifier: MIT
/// Weights from files of every kind: safetensors, PyTorch (zip, TorchScript, the older form, Lightning), NumPy (npy,
/// npz), pickles, joblib dumps, and folders of them from training runs. The content decides the format, never the name.
///
///     const WeightFile file = open_weights("logs/last.ckpt");
///     load_module(model, file, "denoiser.");
///     if (const FileValue* epoch = file.value("epoch")) use(*epoch);
///
/// Nothing in a file is executed. Objects of unknown classes are skipped and listed; numbers and texts in their fields
/// are read as values. Tensors that lie in order in the file are views of it, without a copy.
///
/// Memory   besides the mapped file at most twice its size and 64 MiB. A file that is packed as a whole (gzip, or a
///          joblib dump written with compress=) is unpacked in memory, to at most twice its size and 30 MiB. The limit
///          includes copies of arrays in another order. A larger result is io_error 405. Files packed with bzip2, xz,
///          lzma, lz4 or zstd are io_error 404: unpack them first
/// Source   the readers of the formats: safetensors.hpp, torch_file.hpp, pickle_arrays.hpp, npz.hpp
#pragma once

#include <motionlang/file/file_value.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/weights/run_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct WeightOptions {
  /// Keys from the root of the file to the dictionary of tensors, "state_dict" or "a/b"; "" means the root. The default
  /// is the root if it holds tensors itself, else its "state_dict", "model_state_dict" or "model", else the root.
  std::optional<std::string> path{};
  bool strict = false;     // refuse values that are otherwise skipped
  bool checksums = false;  // also compare PyTorch's checksums of storages, which reads the whole file
};

/// Something that was skipped: the keys from the root of the file to it, and its class or element type.
struct SkippedValue {
  std::string path, type;
  bool operator==(const SkippedValue&) const = default;
};
/// "nobody.Config at 'hyper_parameters/config'".
inline std::string to_string(const SkippedValue& v) {
  return v.path.empty() ? v.type : concat_text(v.type, " at '", v.path, "'");
}

class WeightFile;
WeightFile open_weights(const FilePath& path, const WeightOptions& options = {});

namespace detail {
class WeightReader;
/// Throws io_error 402, 403 if the stream is damaged, 405 if it is longer than `limit`. It checks the length before it
/// allocates.
std::vector<std::byte> from_zlib(std::span<const std::byte> bytes, std::size_t limit, const std::string& name);
}  // namespace detail

/// The tensors of a file, sorted by name, and its other values. The name of a tensor in dictionaries is their keys,
/// joined with '.' in PyTorch's files and with '/' in others; a tensor on its own is called "array".
class WeightFile : public TensorSet {
 public:
  /// "safetensors", "torch zip", "TorchScript", "torch legacy", "npy", "npz", "pickle", "joblib", "shards", "folder",
  /// or "TMR run folder" and the like.
  const std::string& format() const { return format_; }
  /// The first 10,000 values, in the order of the file.
  const std::vector<FileValue>& values() const { return values_; }
  /// Null if there is no value at these keys.
  const FileValue* value(std::string_view path) const { return find_value(values_, path); }
  /// The first 1,000 values that were skipped, in the order of the file.
  const std::vector<SkippedValue>& skipped() const { return skipped_; }
  /// All files that hold these tensors, with the index of shards. None for bytes in memory.
  const std::vector<std::filesystem::path>& files() const { return files_; }

  /// A file in memory. `owner` keeps the bytes alive; without one they must outlive the object. `name` appears in
  /// messages.
  /// Throws  io_error 402, 403, 405 if the file is damaged, 404 if its format is unknown or not supported, or if it
  ///         tries to execute code, 406 if it holds no tensors or `options.path` is not in the file
  static WeightFile from_bytes(std::span<const std::byte> bytes, std::string name,
                               std::shared_ptr<const void> owner = {}, const WeightOptions& options = {});
  /// The weight files of a run folder. Throws io_error 404 if there are none, and what open_weights throws.
  static WeightFile from_run(const RunFolder& run, const WeightOptions& options = {});

 private:
  friend class detail::WeightReader;
  friend WeightFile open_weights(const FilePath& path, const WeightOptions& options);
  WeightFile(std::string name, std::shared_ptr<const void> owner, std::string format)
      : TensorSet(std::move(name), std::move(owner)), format_(std::move(format)) {}

  static WeightFile from_safetensors(const SafetensorsFile& file);
  /// The files of an index `*.index.json`, as one. Throws io_error 403, 404 and what open_weights throws.
  static WeightFile from_shards(const FilePath& index, const WeightOptions& options);
  /// Adds the contents of another file, with a prefix before its names. `owners` are those of this file.
  void add(const WeightFile& file, const std::string& prefix, std::vector<std::shared_ptr<const void>>& owners);
  void sort_tensors();

  std::string format_;
  std::vector<FileValue> values_;
  std::vector<SkippedValue> skipped_;
  std::vector<std::filesystem::path> files_;
};

/// True for a folder and for a file that begins as open_weights expects. Also true for any other file that is not text,
/// because open_weights gives the best error for it. Older pickles are text and are not recognised.
bool may_be_weights(const FilePath& path);

/// Opens a file, the index.json of weights in shards, or the folder of a training run (weights/run_folder.hpp).
/// Throws  io_error 401 if it cannot be opened, 406 if a shard lacks a tensor, and what WeightFile::from_bytes and
///         find_run throw
WeightFile open_weights(const FilePath& path, const WeightOptions& options);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/weight_file.ipp>
#endif
