// SPDX-License-Identifier: MIT
/// NumPy's .npz archives: several arrays in a zip, array "poses" as member "poses.npy". Written uncompressed.
#pragma once

#include <motionlang/file/npy.hpp>
#include <motionlang/file/zip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// An archive that is open for reading. Arrays are read on request, so members that we cannot read (objects) do not
/// affect the others.
class NpzArchive {
 public:
  /// Throws io_error 401 to 405.
  static NpzArchive open(const FilePath& path) { return NpzArchive(ZipArchive::open(path)); }
  explicit NpzArchive(ZipArchive zip) : zip_(std::move(zip)) {}

  const std::string& file() const { return zip_.name(); }
  std::vector<std::string> names() const;
  bool has(std::string_view name) const;

  /// Throws  io_error 406 if there is no such array, 402 to 405 if it cannot be read
  NpyArray read(std::string_view name) const;

 private:
  static constexpr std::string_view suffix = ".npy";
  ZipArchive zip_;
};

struct NamedArray {
  std::string name;
  NpyArray array;
};

/// Throws io_error 405 above 4 GiB.
std::vector<std::byte> npz_bytes(std::span<const NamedArray> arrays);
/// Throws io_error 401 if the file cannot be written, 405 above 4 GiB.
void write_npz(const FilePath& path, std::span<const NamedArray> arrays);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/npz.ipp>
#endif
