// SPDX-License-Identifier: MIT
/// Whole files: read, map into memory, and write so that a reader never sees half of one.
#pragma once

#include <algorithm>   // min, max
#include <atomic>      // numbers of temporary files
#include <cerrno>      // errno
#include <cstddef>     // byte
#include <cstdint>     // addresses
#include <cstdio>      // remove
#include <cstring>     // strerror
#include <filesystem>  // symbolic links
#include <memory>      // shared_ptr
#include <mutex>       // list of mapped files
#include <span>        // contents
#include <string>      // contents
#include <utility>     // exchange

#include <motionlang/core/error.hpp>
#include <motionlang/file/detail/system_file.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A file descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  /// To read. Throws io_error 401.
  explicit Descriptor(const FilePath& path) : fd_(system::open_to_read(path.c_str())) {
    if (fd_ < 0) raise<io_error>(401, "cannot open ", path.string(), ": ", std::strerror(errno));
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  /// Whether all bytes could be written; errno says why not.
  bool write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const auto n = ::write(fd_, bytes.data(), static_cast<unsigned>(std::min<std::size_t>(bytes.size(), 1u << 30)));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return true;
  }
  std::size_t size(const FilePath& path) const {
    std::uint64_t size = 0;
    if (!system::is_regular(fd_, size)) raise<io_error>(401, path.string(), " is not a regular file");
    return static_cast<std::size_t>(size);
  }

 private:
  int fd_;
};

}  // namespace detail

/// A file mapped into memory for reading. Pages are loaded when they are touched (on Windows, all when it is opened).
class MappedFile {
 public:
  /// Throws io_error 401.
  static std::shared_ptr<const MappedFile> open(const FilePath& path) {
    return std::shared_ptr<const MappedFile>(new MappedFile(path));
  }
  /// These bytes in a file without a name, which is gone with the mapping: memory that can be given back and read
  /// again. Null if there is no place for it.
  static std::shared_ptr<const MappedFile> put_aside(std::span<const std::byte> bytes) {
    const detail::Descriptor file(bytes.empty() ? -1 : detail::system::create_nameless());
    if (file.get() < 0 || !file.write(bytes)) return nullptr;
    auto out = std::shared_ptr<MappedFile>(new MappedFile);
    return out->map(file.get(), bytes.size()) ? out : nullptr;
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
    detail::system::unmap(data_, size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }
  /// Gives the memory of a part back that will hardly be read again: whoever reads it gets it from the file once more.
  /// The system maps up to two megabytes around a byte that is read, so it takes whole ones.
  void forget(std::span<const std::byte> part) const {
    constexpr std::uintptr_t block = std::uintptr_t{2} << 20;
    const std::uintptr_t begin = std::max(address(part) / block * block, address(bytes())),
                         end = std::min((address(part) + part.size() + block - 1) / block * block,
                                        address(bytes()) + size_);
    if (begin < end) detail::system::forget(reinterpret_cast<void*>(begin), end - begin);
  }
  /// The same of bytes that lie in a mapped file or elsewhere.
  static void forget_if_mapped(std::span<const std::byte> part) {
    if (const MappedFile* file = that_holds(part)) file->forget(part);
  }

 private:
  explicit MappedFile(const FilePath& path) {
    const detail::Descriptor file(path);
    const std::size_t size = file.size(path);
    if (size > 0 && !map(file.get(), size))  // an empty mapping is an error of mmap
      raise<io_error>(401, "cannot map ", path.string(), ": ", std::strerror(errno));
  }
  MappedFile() = default;
  bool map(int fd, std::size_t size) {
    void* const data = detail::system::map(fd, size);
    if (data == nullptr) return false;
    data_ = data, size_ = size;
    const std::scoped_lock lock(mutex_);
    next_ = std::exchange(first_, this);
    return true;
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

/// Writes to a temporary name beside `path` and renames: the old file stays whole until the new one is, which has its
/// permissions. Of a symbolic link, the file that it leads to is written. Throws io_error 401, also for devices and
/// pipes.
inline void write_file(const FilePath& path, std::span<const std::byte> contents) {
  static std::atomic<unsigned> writers{0};
  std::error_code problem;
  std::filesystem::path followed = path.string();
  constexpr int most_links = 40;                                                  // as Linux follows
  for (int links = 0; std::filesystem::is_symlink(followed, problem); ++links) {  // the last may lead to no file yet
    if (links == most_links) raise<io_error>(401, "cannot write ", path.string(), ": more than ", most_links, " links");
    followed = followed.parent_path() / std::filesystem::read_symlink(followed, problem);
  }
  if (std::filesystem::is_other(std::filesystem::status(followed, problem)))
    raise<io_error>(401, "cannot write ", path.string(),
                    ": it is no file but a device or a pipe, which a file would replace");
  const std::string target = followed.string();
  std::string temporary;
  int opened = -1;
  do {  // a name that no other thread and no other machine has
    temporary = (followed.parent_path() / concat_text(".part-", ::getpid(), "-", writers++)).string();
    opened = detail::system::create(temporary.c_str());
  } while (opened < 0 && errno == EEXIST);
  int reason = 0;
  auto failed = [&](const char* what) {
    if (opened >= 0) std::remove(temporary.c_str());
    raise<io_error>(401, "cannot ", what, " ", path.string(), ": ", std::strerror(reason));
  };
  const char* wrong = nullptr;
  {
    const detail::Descriptor file(opened);
    if (file.get() >= 0) detail::system::copy_permissions(target.c_str(), file.get());
    if (file.get() < 0 || !file.write(contents))
      wrong = "write";
    else if (!detail::system::flush(file.get()))
      wrong = "flush";
    reason = errno;
  }
  if (wrong != nullptr) failed(wrong);
  if (detail::system::rename_over(temporary.c_str(), target.c_str())) return;
  reason = errno;
  failed("rename to");
}
inline void write_file(const FilePath& path, std::string_view contents) {
  write_file(path, std::as_bytes(std::span(contents.data(), contents.size())));
}

/// Makes the folder unless it is there. Its parent has to be. Throws io_error 401.
inline void make_folder(const FilePath& path) {
  if (detail::system::make_folder(path.c_str()) || detail::system::is_folder(path.c_str())) return;
  raise<io_error>(401, "cannot make the folder ", path.string());
}

MOTIONLANG_NAMESPACE_END
