// SPDX-License-Identifier: MIT
/// Reads whole files, maps them into memory, and writes them so that no reader sees an incomplete one.
#pragma once

#include <cstddef>      // byte
#include <cstdint>      // addresses
#include <memory>       // shared_ptr
#include <span>         // contents
#include <string>       // contents
#include <string_view>  // contents

#include <motionlang/core/error.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A file that is mapped into memory for reading. Pages are loaded at first use (on Windows, all of them at once).
class MappedFile {
 public:
  /// Throws io_error 401, also for a Git LFS pointer, which replaces a file that was not fetched.
  static std::shared_ptr<const MappedFile> open(const FilePath& path);
  /// Stores these bytes in a file without a name, which disappears with the mapping. Their memory can be released and
  /// read again. Null if that fails.
  static std::shared_ptr<const MappedFile> put_aside(std::span<const std::byte> bytes);
  /// The mapped file that holds these bytes, or null. It lives as long as the owner of the bytes.
  static const MappedFile* that_holds(std::span<const std::byte> bytes);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }
  /// Releases the memory of a part that will hardly be read again. Later reads load it from the file. The system maps
  /// up to two megabytes around a byte that is read, so this releases whole ones.
  void forget(std::span<const std::byte> part) const;
  /// The same for bytes that may lie in a mapped file or elsewhere.
  static void forget_if_mapped(std::span<const std::byte> part);

 private:
  explicit MappedFile(const FilePath& path);
  MappedFile() = default;
  bool map(int fd, std::size_t size);
  static std::uintptr_t address(std::span<const std::byte> bytes);

  void* data_ = nullptr;
  std::size_t size_ = 0;
  MappedFile* next_ = nullptr;  // in a list of all mapped files
};

/// Throws io_error 401 if the bytes of a file are a Git LFS pointer.
/// Source  the specification of Git LFS, "The Pointer"
void refuse_lfs_pointer(std::span<const std::byte> bytes, std::string_view name);

/// The whole file as text. Throws io_error 401, also for a Git LFS pointer.
std::string read_file(const FilePath& path);

/// Writes to a temporary name beside `path` and renames. So the old file stays complete until the new one, with the
/// same permissions, replaces it. Through a symbolic link, it writes the file to which the link leads. Throws io_error
/// 401, also for devices and pipes.
void write_file(const FilePath& path, std::span<const std::byte> contents);
void write_file(const FilePath& path, std::string_view contents);

/// Makes the folder if it does not exist. Its parent must exist. Throws io_error 401.
void make_folder(const FilePath& path);

/// A name for use in a file's name. Characters that some system forbids become "_".
std::string safe_file_name(std::string name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/file.ipp>
#endif
