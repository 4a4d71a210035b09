// SPDX-License-Identifier: MIT
/// Whole files: read, map into memory, and write so that a reader never sees half of one.
#pragma once

#include <fcntl.h>     // open
#include <sys/mman.h>  // mmap
#include <sys/stat.h>  // fstat
#include <unistd.h>    // close, fsync, getpid

#include <cerrno>      // errno
#include <cstddef>     // byte
#include <cstdint>     // addresses
#include <cstdio>      // rename, remove
#include <cstring>     // strerror
#include <memory>      // shared_ptr
#include <mutex>       // list of mapped files
#include <span>        // contents
#include <string>      // contents
#include <utility>     // exchange

#include <motionlang/core/error.hpp>
#include <motionlang/io/file_path.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// A file descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  Descriptor(const FilePath& path, int flags, mode_t mode = 0)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {
    if (fd_ < 0) raise<io_error>(401, "cannot open ", path.string(), ": ", std::strerror(errno));
  }
  ~Descriptor() { ::close(fd_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  std::size_t size(const FilePath& path) const {
    struct stat s {};
    if (::fstat(fd_, &s) != 0 || !S_ISREG(s.st_mode)) raise<io_error>(401, path.string(), " is not a regular file");
    return static_cast<std::size_t>(s.st_size);
  }

 private:
  int fd_;
};

}  // namespace detail

/// A file mapped into memory for reading. Pages are loaded when they are touched.
class MappedFile {
 public:
  /// Throws io_error 401.
  static std::shared_ptr<const MappedFile> open(const FilePath& path) {
    return std::shared_ptr<const MappedFile>(new MappedFile(path));
  }
  /// The one in which these bytes lie, or nothing. It lasts as long as whoever keeps the bytes.
  static const MappedFile* that_holds(std::span<const std::byte> bytes) {
    const std::scoped_lock lock(mutex_);
    const MappedFile* f = first_;
    while (f != nullptr && (address(bytes) < address(f->bytes()) ||
                            address(bytes) + bytes.size() > address(f->bytes()) + f->bytes().size()))
      f = f->next_;
    return f;
  }
  ~MappedFile() {
    if (size_ == 0) return;
    {
      const std::scoped_lock lock(mutex_);
      MappedFile** place = &first_;
      while (*place != this) place = &(*place)->next_;
      *place = next_;
    }
    ::munmap(data_, size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }
  /// Gives the memory of a part back that will hardly be read again: whoever reads it gets it from the file once more.
  void forget(std::span<const std::byte> part) const {
    const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    const std::uintptr_t begin = (address(part) + page - 1) / page * page,
                         end = (address(part) + part.size()) / page * page;
    if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
  }
  /// The same of bytes that lie in a mapped file or elsewhere.
  static void forget_if_mapped(std::span<const std::byte> part) {
    if (const MappedFile* file = that_holds(part)) file->forget(part);
  }

 private:
  explicit MappedFile(const FilePath& path) {
    const detail::Descriptor file(path, O_RDONLY);
    size_ = file.size(path);
    if (size_ == 0) return;  // an empty mapping is an error of mmap
    data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.get(), 0);
    if (data_ == MAP_FAILED) raise<io_error>(401, "cannot map ", path.string(), ": ", std::strerror(errno));
    const std::scoped_lock lock(mutex_);
    next_ = std::exchange(first_, this);
  }
  static std::uintptr_t address(std::span<const std::byte> bytes) {
    return reinterpret_cast<std::uintptr_t>(bytes.data());
  }

  void* data_ = nullptr;
  std::size_t size_ = 0;
  MappedFile* next_ = nullptr;

  inline static std::mutex mutex_;
  inline static MappedFile* first_ = nullptr;  // all that are mapped
};

/// The whole file as text. Throws io_error 401.
inline std::string read_file(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return std::string(reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size());
}

/// Writes to a temporary name beside `path` and renames: the old file stays whole until the new one is. Throws io_error
/// 401.
inline void write_file(const FilePath& path, std::span<const std::byte> contents) {
  const FilePath temporary = path.string() + ".part-" + std::to_string(::getpid());
  auto failed = [&](const char* what) {
    const int reason = errno;
    std::remove(temporary.c_str());
    raise<io_error>(401, "cannot ", what, " ", path.string(), ": ", std::strerror(reason));
  };
  {
    const detail::Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    while (!contents.empty()) {
      const ssize_t n = ::write(file.get(), contents.data(), contents.size());
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) failed("write");
      contents = contents.subspan(static_cast<std::size_t>(n));
    }
    if (::fsync(file.get()) != 0) failed("flush");
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) failed("rename to");
}
inline void write_file(const FilePath& path, std::string_view contents) {
  write_file(path, std::as_bytes(std::span(contents.data(), contents.size())));
}

/// Makes the folder unless it is there. Its parent has to be. Throws io_error 401.
inline void make_folder(const FilePath& path) {
  struct stat s {};
  if (::mkdir(path.c_str(), 0777) == 0 || (::stat(path.c_str(), &s) == 0 && S_ISDIR(s.st_mode))) return;
  raise<io_error>(401, "cannot make the folder ", path.string());
}

}  // namespace motionlang::inline MOTIONLANG_ABI
