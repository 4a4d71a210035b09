// SPDX-License-Identifier: MIT
// Bodies of file.hpp.
#pragma once

#include <algorithm>   // min, max
#include <atomic>      // numbers of temporary files
#include <cerrno>      // errno
#include <cstdio>      // remove
#include <cstring>     // strerror
#include <filesystem>  // symbolic links
#include <mutex>       // list of mapped files
#include <utility>     // exchange

#include <motionlang/file/detail/system_file.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::mutex mapped_mutex;
inline MappedFile* first_mapped = nullptr;  // the list of all mapped files

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
  /// True if all bytes were written; otherwise errno gives the reason.
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

MOTIONLANG_BODY std::shared_ptr<const MappedFile> MappedFile::open(const FilePath& path) {
  auto file = std::shared_ptr<const MappedFile>(new MappedFile(path));
  refuse_lfs_pointer(file->bytes(), path.string());
  return file;
}

MOTIONLANG_BODY void refuse_lfs_pointer(std::span<const std::byte> bytes, std::string_view name) {
  constexpr std::size_t longest = 1024;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), longest));
  if (bytes.size() >= longest || !text.starts_with("version https://git-lfs.github.com/spec/")) return;
  const std::size_t size = text.find("\nsize ");
  const std::string_view number = size == text.npos ? "?" : text.substr(size + 6, text.find('\n', size + 6) - size - 6);
  raise<io_error>(401, name, " is not the file but a Git LFS pointer to it (", number,
                  " bytes): 'git lfs pull' in its repository fetches the file");
}

MOTIONLANG_BODY std::shared_ptr<const MappedFile> MappedFile::put_aside(std::span<const std::byte> bytes) {
  const detail::Descriptor file(bytes.empty() ? -1 : detail::system::create_nameless());
  if (file.get() < 0 || !file.write(bytes)) return nullptr;
  auto out = std::shared_ptr<MappedFile>(new MappedFile);
  return out->map(file.get(), bytes.size()) ? out : nullptr;
}

MOTIONLANG_BODY const MappedFile* MappedFile::that_holds(std::span<const std::byte> bytes) {
  const std::scoped_lock lock(detail::mapped_mutex);
  const MappedFile* f = detail::first_mapped;
  while (f != nullptr && (address(bytes) < address(f->bytes()) ||
                          address(bytes) + bytes.size() > address(f->bytes()) + f->bytes().size()))
    f = f->next_;
  return f;
}

MOTIONLANG_BODY MappedFile::~MappedFile() {
  if (size_ == 0) return;
  {
    const std::scoped_lock lock(detail::mapped_mutex);
    MappedFile** place = &detail::first_mapped;
    while (*place != this) place = &(*place)->next_;
    *place = next_;
  }
  detail::system::unmap(data_, size_);
}

MOTIONLANG_BODY void MappedFile::forget(std::span<const std::byte> part) const {
  constexpr std::uintptr_t block = std::uintptr_t{2} << 20;
  const std::uintptr_t begin = std::max(address(part) / block * block, address(bytes())),
                       end = std::min((address(part) + part.size() + block - 1) / block * block,
                                      address(bytes()) + size_);
  if (begin < end) detail::system::forget(static_cast<std::byte*>(data_) + (begin - address(bytes())), end - begin);
}

MOTIONLANG_BODY void MappedFile::forget_if_mapped(std::span<const std::byte> part) {
  if (const MappedFile* file = that_holds(part)) file->forget(part);
}

MOTIONLANG_BODY MappedFile::MappedFile(const FilePath& path) {
  const detail::Descriptor file(path);
  const std::size_t size = file.size(path);
  if (size > 0 && !map(file.get(), size))  // an empty mapping is an error of mmap
    raise<io_error>(401, "cannot map ", path.string(), ": ", std::strerror(errno));
}

MOTIONLANG_BODY bool MappedFile::map(int fd, std::size_t size) {
  void* const data = detail::system::map(fd, size);
  if (data == nullptr) return false;
  data_ = data, size_ = size;
  const std::scoped_lock lock(detail::mapped_mutex);
  next_ = std::exchange(detail::first_mapped, this);
  return true;
}

MOTIONLANG_BODY std::uintptr_t MappedFile::address(std::span<const std::byte> bytes) {
  return reinterpret_cast<std::uintptr_t>(bytes.data());
}

MOTIONLANG_BODY std::string read_file(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return std::string(reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size());
}

MOTIONLANG_BODY void write_file(const FilePath& path, std::span<const std::byte> contents) {
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
                    ": it is not a file but a device or a pipe, which a file would replace");
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

MOTIONLANG_BODY void write_file(const FilePath& path, std::string_view contents) {
  write_file(path, std::as_bytes(std::span(contents.data(), contents.size())));
}

MOTIONLANG_BODY void make_folder(const FilePath& path) {
  if (detail::system::make_folder(path.c_str()) || detail::system::is_folder(path.c_str())) return;
  raise<io_error>(401, "cannot make the folder ", path.string());
}

MOTIONLANG_BODY std::string safe_file_name(std::string name) {
  for (char& c : name) {
    const bool odd =
        static_cast<unsigned char>(c) < ' ' || std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos;
    if (odd) c = '_';
  }
  return name;
}

MOTIONLANG_NAMESPACE_END
