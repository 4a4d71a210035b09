// SPDX-License-Identifier: MIT
/// Reads safetensors files without a copy, and writes them. Includes no JSON library (see detail/json_cursor.hpp).
///
///     const auto file = SafetensorsFile::open("weights.safetensors");
///     for (const TensorView& t : file.tensors()) use(t);              // sorted by name
///     std::vector<float> bias = values_of<float>(file.tensor("head.bias"));
///
/// Layout   8 bytes: length N of the header; N bytes: JSON, name -> {dtype, shape, data_offsets}, "__metadata__" -> map
///          of strings; the rest: data, without holes
/// Checked  Everything is checked before any tensor is handed out: lengths, strict JSON, UTF-8, unique names, products
///          without overflow, ranges that tile the data exactly. Memory stays below a small multiple of the header, and
///          nothing is allocated for what a file merely claims.
/// Caution  If another process shortens a file while it is mapped, the program ends (SIGBUS). write_file never shortens
///          one
#pragma once

#include <cstdint>  // sizes
#include <map>      // metadata

#include <motionlang/file/file.hpp>
#include <motionlang/file/tensor_set.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
class JsonCursor;
}

class SafetensorsFile : public TensorSet {
 public:
  /// The longest header that is read, as in the reference implementation.
  static constexpr std::uint64_t max_header = 100'000'000;

  /// Maps a file. Throws io_error 401 (cannot be opened), 402 (ends too early), 403 (malformed), 404 (more than 64
  /// axes), 405 (impossible sizes).
  static SafetensorsFile open(const FilePath& path);
  /// A file in memory. `owner` keeps the bytes alive; without an owner they must outlive the object. Messages contain
  /// `name`.
  static SafetensorsFile from_bytes(std::span<const std::byte> bytes, std::string name = "safetensors data",
                                    std::shared_ptr<const void> owner = {});

  const std::map<std::string, std::string>& metadata() const { return metadata_; }

 private:
  using Cursor = detail::JsonCursor;
  static constexpr std::size_t prefix = 8;  // bytes of the header length

  struct Range {
    std::uint64_t begin, end;
    std::size_t declared_at;  // in the header, for messages
  };

  SafetensorsFile(std::span<const std::byte> bytes, std::string name, std::shared_ptr<const void> owner);

  void read_metadata(Cursor& json);

  Range read_entry(Cursor& json, const std::string& name, std::span<const std::byte> data);

  static DType read_dtype(Cursor& json);

  static FileShape read_shape(Cursor& json);

  /// Checks that the range has exactly the bytes that shape and type need. The product of the sizes, also of those that
  /// are not 0, must not overflow.
  static void check_size(const Cursor& json, const TensorView& view, const Range& range);

  /// Checks that the ranges follow each other without overlap or hole and end at the end of the data.
  static void check_tiling(const Cursor& json, std::vector<Range>& ranges, std::uint64_t size);

  std::map<std::string, std::string> metadata_;
};

/// The bytes of a file. Tensors are sorted by element size, largest first, then by name. The data begin at a multiple
/// of 8, so every element is aligned. The bytes are read back before they are returned. A duplicate name, a size that
/// does not fit the shape, or text that is not UTF-8 throws the io_error of the reader.
std::vector<std::byte> safetensors_bytes(std::span<const TensorView> tensors,
                                         const std::map<std::string, std::string>& metadata = {{"format", "pt"}});

/// Writes a file in one step: readers see the old one or the new one. Throws io_error 401, and what safetensors_bytes
/// throws. Python tools accept the file because of the metadata {"format": "pt"}.
void write_safetensors(const FilePath& path, std::span<const TensorView> tensors,
                       const std::map<std::string, std::string>& metadata = {{"format", "pt"}});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/safetensors.ipp>
#endif
