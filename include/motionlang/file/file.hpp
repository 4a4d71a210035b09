// SPDX-License-Identifier: MIT
/// Whole files: read, map into memory, and write so that a reader never sees half of one.
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

/// A file mapped into memory for reading. Pages are loaded when they are touched (on Windows, all when it is opened).
class MappedFile {
 public:
  /// Throws io_error 401, also for a pointer of Git LFS, which stands in a repository for a file that was not fetched.
  static std::shared_ptr<const MappedFile> open(const FilePath& path);
  /// These bytes in a file without a name, which is gone with the mapping: memory that can be given back and read
  /// again. Null if there is no place for it.
  static std::shared_ptr<const MappedFile> put_aside(std::span<const std::byte> bytes);
  /// The one in which these bytes lie, or nothing. It lasts as long as whoever keeps the bytes.
  static const MappedFile* that_holds(std::span<const std::byte> bytes);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }
  /// Gives the memory of a part back that will hardly be read again: whoever reads it gets it from the file once more.
  /// The system maps up to two megabytes around a byte that is read, so it takes whole ones.
  void forget(std::span<const std::byte> part) const;
  /// The same of bytes that lie in a mapped file or elsewhere.
  static void forget_if_mapped(std::span<const std::byte> part);

 private:
  explicit MappedFile(const FilePath& path);
  MappedFile() = default;
  bool map(int fd, std::size_t size);
  static std::uintptr_t address(std::span<const std::byte> bytes);

  void* data_ = nullptr;
  std::size_t size_ = 0;
  MappedFile* next_ = nullptr;  // of all that are mapped
};

/// Throws io_error 401 if the bytes of a file are a pointer of Git LFS.
/// Source  the specification of Git LFS, "The Pointer"
void refuse_lfs_pointer(std::span<const std::byte> bytes, std::string_view name);

/// The whole file as text. Throws io_error 401, also for a pointer of Git LFS.
std::string read_file(const FilePath& path);

/// Writes to a temporary name beside `path` and renames: the old file stays whole until the new one is, which has its
/// permissions. Of a symbolic link, the file that it leads to is written. Throws io_error 401, also for devices and
/// pipes.
void write_file(const FilePath& path, std::span<const std::byte> contents);
void write_file(const FilePath& path, std::string_view contents);

/// Makes the folder unless it is there. Its parent has to be. Throws io_error 401.
void make_folder(const FilePath& path);

/// A name as a part of a file's name: characters that some system does not allow there become "_".
std::string safe_file_name(std::string name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/file.ipp>
#endif
