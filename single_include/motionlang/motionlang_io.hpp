// SPDX-License-Identifier: MIT
/// motionlang 0.1.0, generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.
#pragma once

#include <motionlang/motionlang.hpp>

#ifndef MOTIONLANG_HAS_FILE_FILE_HPP  // <motionlang/file/file.hpp>
#define MOTIONLANG_HAS_FILE_FILE_HPP
/// Whole files: read, map into memory, and write so that a reader never sees half of one.

#ifndef MOTIONLANG_HAS_FILE_FILE_PATH_HPP  // <motionlang/file/file_path.hpp>
#define MOTIONLANG_HAS_FILE_FILE_PATH_HPP
/// Names of files.

MOTIONLANG_NAMESPACE_BEGIN

/// The name of a file: a string, or a std::filesystem::path, whose header takes longer to compile than this library's
/// io.
class FilePath {
 public:
  FilePath(const char* text) : text_(text) {}
  FilePath(std::string text) : text_(std::move(text)) {}
  template <class Path>
  requires requires(const Path& path) { path.lexically_normal().string(); }
  FilePath(const Path& path) : text_(path.string()) {}

  const std::string& string() const { return text_; }
  const char* c_str() const { return text_.c_str(); }
  /// The name of a file in this folder; "" is the current folder, as parent_path() of a bare name has it.
  std::string inside(const std::string& name) const { return text_.empty() ? name : text_ + "/" + name; }
  /// The last part without its extension: "walk" of "clips/walk.bvh".
  std::string stem() const {
#if defined(_WIN32)
    constexpr const char* separators = "/\\";
#else
    constexpr const char* separators = "/";
#endif
    const std::string name = text_.substr(text_.find_last_of(separators) + 1);
    const std::size_t dot = name.find_last_of('.');
    return dot == 0 ? name : name.substr(0, dot);
  }

 private:
  std::string text_;
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A file mapped into memory for reading. Pages are loaded when they are touched (on Windows, all when it is opened).
class MappedFile {
 public:
  /// Throws io_error 401.
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

/// The whole file as text. Throws io_error 401.
std::string read_file(const FilePath& path);

/// Writes to a temporary name beside `path` and renames: the old file stays whole until the new one is, which has its
/// permissions. Of a symbolic link, the file that it leads to is written. Throws io_error 401, also for devices and
/// pipes.
void write_file(const FilePath& path, std::span<const std::byte> contents);
void write_file(const FilePath& path, std::string_view contents);

/// Makes the folder unless it is there. Its parent has to be. Throws io_error 401.
void make_folder(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_FILE_IPP  // <motionlang/file/file.ipp>
#define MOTIONLANG_HAS_FILE_FILE_IPP
// Bodies of file.hpp.

#include <cerrno>      // errno
#include <filesystem>  // symbolic links

#ifndef MOTIONLANG_HAS_FILE_DETAIL_SYSTEM_FILE_HPP  // <motionlang/file/detail/system_file.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_SYSTEM_FILE_HPP
/// What the system does with files: POSIX, and Windows by what MinGW's C library has of it. errno says why a call
/// failed.

#include <fcntl.h>     // open
#include <sys/stat.h>  // fstat, fchmod, mkdir
#include <unistd.h>    // read, write, close, getpid
#if defined(_WIN32)
#include <io.h>      // _commit
#include <malloc.h>  // _aligned_malloc

#else
#include <sys/mman.h>  // mmap
#endif

#if defined(_WIN32)
// As windows.h declares it, which would bring macros named min, max, near and far.
extern "C" __declspec(dllimport) int __stdcall MoveFileExA(const char* from, const char* to, unsigned long flags);
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail::system {

/// An open file of a new name where temporary files go, for this user only; -1 if there is no place for it.
inline int create_temporary(std::string& name) {
  std::error_code problem;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(problem);
  name = problem ? "a temporary file" : (folder / "motionlang-XXXXXX").string();
  if (problem) return errno = problem.default_error_condition().value(), -1;
  return ::mkstemp(name.data());
}

#if defined(_WIN32)

inline int open_to_read(const char* path) { return ::open(path, O_RDONLY | O_BINARY | O_NOINHERIT); }
/// A file that is not there yet, else errno is EEXIST.
inline int create(const char* path) { return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_BINARY | O_NOINHERIT, 0666); }
/// An open file that has no name any more. Windows knows none.
inline int create_nameless() { return -1; }
inline bool is_regular(int file, std::uint64_t& size) {
  struct _stat64 s {};
  if (::_fstat64(file, &s) != 0 || !S_ISREG(s.st_mode)) return false;
  size = static_cast<std::uint64_t>(s.st_size);
  return true;
}
inline void copy_permissions(const char*, int) {}  // of a folder, for all in it
inline bool flush(int file) { return ::_commit(file) == 0; }
inline void unmap(void* data, std::size_t) { ::_aligned_free(data); }
/// The whole file, for reading; null if that fails. size > 0. A copy: nobody could write a file anew that is mapped,
/// such as the checkpoint from which a training goes on.
inline void* map(int file, std::size_t size) {
  auto* const data = static_cast<char*>(::_aligned_malloc(size, 64));
  if (data == nullptr) return errno = ENOMEM, nullptr;
  for (std::size_t done = 0; done < size;) {
    const int n = ::read(file, data + done, static_cast<unsigned>(std::min<std::size_t>(size - done, 1u << 30)));
    if (n <= 0) {
      if (n == 0) errno = EIO;  // it has become shorter
      return unmap(data, size), nullptr;
    }
    done += static_cast<std::size_t>(n);
  }
  return data;
}
inline void forget(void*, std::size_t) {}  // there is no other copy
inline bool rename_over(const char* from, const char* to) {
  constexpr unsigned long replace = 1;
  if (::MoveFileExA(from, to, replace) != 0) return true;
  errno = EACCES;  // it is open
  return false;
}
inline bool make_folder(const char* path) { return ::mkdir(path) == 0; }

#else

inline int open_to_read(const char* path) { return ::open(path, O_RDONLY | O_CLOEXEC); }
/// A file that is not there yet, else errno is EEXIST.
inline int create(const char* path) { return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); }
/// An open file that has no name any more; -1 if there is no place for it.
inline int create_nameless() {
  std::string name;
  const int file = create_temporary(name);
  if (file >= 0) ::unlink(name.c_str());
  return file;
}
inline bool is_regular(int file, std::uint64_t& size) {
  struct stat s {};
  if (::fstat(file, &s) != 0 || !S_ISREG(s.st_mode)) return false;
  size = static_cast<std::uint64_t>(s.st_size);
  return true;
}
/// Who may read and write an open file as another one, if that is there. Not every file system knows such permissions.
inline void copy_permissions(const char* from, int to) {
  struct stat s {};
  if (::stat(from, &s) == 0) static_cast<void>(::fchmod(to, s.st_mode & 0777));
}
inline bool flush(int file) { return ::fsync(file) == 0; }
/// The whole file, for reading; null if that fails. size > 0.
inline void* map(int file, std::size_t size) {
  void* const data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  return data == MAP_FAILED ? nullptr : data;
}
inline void unmap(void* data, std::size_t size) { ::munmap(data, size); }
/// Gives memory of a mapping back: whoever reads it gets it from the file once more.
inline void forget(void* data, std::size_t size) { ::madvise(data, size, MADV_DONTNEED); }
inline bool rename_over(const char* from, const char* to) { return std::rename(from, to) == 0; }
inline bool make_folder(const char* path) { return ::mkdir(path, 0777) == 0; }

#endif

inline bool is_folder(const char* path) {
  struct stat s {};
  return ::stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

}  // namespace detail::system
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::mutex mapped_mutex;
inline MappedFile* first_mapped = nullptr;  // all that are mapped

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

MOTIONLANG_BODY std::shared_ptr<const MappedFile> MappedFile::open(const FilePath& path) {
  return std::shared_ptr<const MappedFile>(new MappedFile(path));
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

MOTIONLANG_BODY void write_file(const FilePath& path, std::string_view contents) {
  write_file(path, std::as_bytes(std::span(contents.data(), contents.size())));
}

MOTIONLANG_BODY void make_folder(const FilePath& path) {
  if (detail::system::make_folder(path.c_str()) || detail::system::is_folder(path.c_str())) return;
  raise<io_error>(401, "cannot make the folder ", path.string());
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_FILE_VALUE_HPP  // <motionlang/file/file_value.hpp>
#define MOTIONLANG_HAS_FILE_FILE_VALUE_HPP
/// Single values of a file, flat: each with the keys that lead to it.

#include <variant>      // values

MOTIONLANG_NAMESPACE_BEGIN

/// A truth value, a number or a text, and the keys from the root of the file to it: "hyper_parameters/layers/0".
struct FileValue {
  std::string path;
  std::variant<bool, std::int64_t, double, std::string> value;
};
std::string to_string(const FileValue& v);
/// The value at a path, or null.
const FileValue* find_value(const std::vector<FileValue>& values, std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_FILE_VALUE_IPP  // <motionlang/file/file_value.ipp>
#define MOTIONLANG_HAS_FILE_FILE_VALUE_IPP
// Bodies of file_value.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string to_string(const FileValue& v) {
  return std::visit([](const auto& value) { return concat_text(value); }, v.value);
}

MOTIONLANG_BODY const FileValue* find_value(const std::vector<FileValue>& values, std::string_view path) {
  for (const FileValue& v : values) {
    if (v.path == path) return &v;
  }
  return nullptr;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_GZIP_HPP  // <motionlang/file/gzip.hpp>
#define MOTIONLANG_HAS_FILE_GZIP_HPP
/// Gzip files of one member (RFC 1952): unpacking. Nothing here compresses.

MOTIONLANG_NAMESPACE_BEGIN

bool is_gzip(std::span<const std::byte> bytes);

/// The unpacked contents. Allocates no more than deflate can pack into the bytes that are there.
/// Throws  io_error 402 if the stream ends too early, 403 if it is malformed or its checksum is wrong, 404 for an
///         unknown method, 405 if it unpacks to more than it declares or declares more than it can hold
std::vector<std::byte> gunzip_bytes(std::span<const std::byte> bytes, std::string_view name = "gzip");
/// The same as a text.
std::string gunzip(std::span<const std::byte> bytes, std::string_view name = "gzip");

/// A text file, packed with gzip or not. Throws io_error 401 and as gunzip.
std::string read_text(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_GZIP_IPP  // <motionlang/file/gzip.ipp>
#define MOTIONLANG_HAS_FILE_GZIP_IPP
// Bodies of gzip.hpp.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_INFLATE_HPP  // <motionlang/file/detail/inflate.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_INFLATE_HPP
/// Inflate (RFC 1951): unpacks deflated data of zip members, gzip and zlib streams. And the checksums of zip, gzip and
/// zlib. Nothing here compresses. zlib would do the same, but has to be linked, and this library needs nothing but its
/// headers to read .npz, .pt and .gz; tests/unit/file compares with data that zlib packed.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_BYTES_HPP  // <motionlang/file/detail/bytes.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_BYTES_HPP
/// Little-endian numbers in byte buffers: checked reading, appending. And base64.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

static_assert(std::endian::native == std::endian::little, "the files are little-endian and are copied as they are");

template <class T>
concept Plain = std::is_trivially_copyable_v<T>;

/// The value stored at `at`. Throws io_error 402 if it does not lie inside; `what` and `file` are for the message.
template <Plain T>
T load(std::span<const std::byte> bytes, std::uint64_t at, std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) {
    raise<io_error>(402, file, ": ends inside ", what, " at byte ", at, " (", counted(bytes.size(), "byte"), ")");
  }
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// `size` bytes from `at`. Throws io_error 402 if they do not lie inside.
std::span<const std::byte> slice(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t size,
                                 std::string_view file, std::string_view what);

inline void append_bytes(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  const std::size_t size = out.size();
  out.resize(size + bytes.size());
  std::memcpy(out.data() + size, bytes.data(), bytes.size());  // vector::insert makes GCC 12 warn of overflow at -O3
}
inline void append_text(std::vector<std::byte>& out, std::string_view text) {
  append_bytes(out, std::as_bytes(std::span(text.data(), text.size())));
}
template <Plain T>
void append_value(std::vector<std::byte>& out, const T& value) {
  append_bytes(out, std::as_bytes(std::span(&value, 1)));
}

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Source  RFC 4648, section 4.
std::string to_base64(std::span<const std::byte> bytes);

/// White space is skipped. `name` stands in messages. Throws io_error 403 on any other character outside the alphabet.
std::vector<std::byte> from_base64(std::string_view text, std::string_view name = "text");

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_DETAIL_BYTES_IPP  // <motionlang/file/detail/bytes.ipp>
#define MOTIONLANG_HAS_FILE_DETAIL_BYTES_IPP
// Bodies of bytes.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::span<const std::byte> slice(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t size,
                                                 std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < size) {
    raise<io_error>(402, file, ": ", what, " needs ", counted(size, "byte"), " at byte ", at, ", the file has ",
                    bytes.size());
  }
  return bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
}

inline constexpr std::string_view base64_alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

MOTIONLANG_BODY std::string to_base64(std::span<const std::byte> bytes) {
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? base64_alphabet[group >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::byte> from_base64(std::string_view text, std::string_view name) {
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t group = 0;
  int bits = 0;
  for (std::size_t i = 0; i < text.size() && text[i] != '='; ++i) {
    if (text[i] == '\n' || text[i] == '\r' || text[i] == ' ') continue;
    const std::size_t digit = base64_alphabet.find(text[i]);
    if (digit == std::string_view::npos) raise<io_error>(403, name, ": character ", i, " is not of base64");
    group = (group << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFFu;
    if ((bits += 6) >= 8) out.push_back(static_cast<std::byte>(group >> (bits -= 8) & 255u));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// CRC-32 as in zip, gzip and PNG: reflected polynomial 0xEDB88320.
std::uint32_t crc32(std::span<const std::byte> bytes);

/// Of zlib streams: two sums modulo 65521.
std::uint32_t adler32(std::span<const std::byte> bytes);

/// What inflate gives back: the data, and how many bytes of the stream it took.
struct Inflated {
  std::vector<std::byte> data;
  std::size_t consumed = 0;
};

/// In place of unpacked bytes: how many they are.
struct ByteCount {
  std::size_t bytes = 0;
  std::size_t size() const { return bytes; }
  void push_back(std::byte) { ++bytes; }
};

/// Unpacks one deflate stream of at most `limit` bytes of output; returns how many bytes of the stream it took. It
/// stops early once there are `enough`.
/// Throws  io_error 402 if the stream ends too early, 403 if it is malformed, 405 beyond the limit
std::size_t inflate_to(std::vector<std::byte>& out, std::span<const std::byte> stream, std::size_t limit,
                       std::string_view file, std::size_t enough = std::numeric_limits<std::size_t>::max());
std::size_t inflate_to(ByteCount& out, std::span<const std::byte> stream, std::size_t limit, std::string_view file,
                       std::size_t enough = std::numeric_limits<std::size_t>::max());

/// The same into memory; room for `expected` bytes is made before.
Inflated inflate(std::span<const std::byte> stream, std::size_t limit, std::string_view file, std::size_t expected = 0);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_DETAIL_INFLATE_IPP  // <motionlang/file/detail/inflate.ipp>
#define MOTIONLANG_HAS_FILE_DETAIL_INFLATE_IPP
// Bodies of inflate.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::uint32_t crc32(std::span<const std::byte> bytes) {
  static constexpr auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = (c & 1u) != 0 ? 0xEDB88320u ^ c >> 1 : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t c = 0xFFFFFFFFu;
  for (const std::byte b : bytes) c = table[(c ^ std::to_integer<std::uint32_t>(b)) & 255u] ^ c >> 8;
  return ~c;
}

MOTIONLANG_BODY std::uint32_t adler32(std::span<const std::byte> bytes) {
  std::uint32_t a = 1, b = 0;
  for (const std::byte v : bytes) {
    a = (a + std::to_integer<std::uint32_t>(v)) % 65521;
    b = (b + a) % 65521;
  }
  return b << 16 | a;
}

/// The bits of a deflate stream, least significant first.
class BitReader {
 public:
  BitReader(std::span<const std::byte> bytes, std::string_view file) : bytes_(bytes), file_(file) {}

  /// The next n <= 16 bits without taking them; past the end they are 0.
  std::uint32_t peek(int n) {
    while (held_ < n) {
      if (at_ < bytes_.size()) hold_ |= std::to_integer<std::uint64_t>(bytes_[at_]) << held_;
      ++at_;
      held_ += 8;
    }
    return static_cast<std::uint32_t>(hold_ & ((std::uint64_t{1} << n) - 1));
  }
  /// Throws io_error 402 past the end.
  void drop(int n) {
    hold_ >>= n;
    held_ -= n;
    if (position() > bytes_.size()) raise<io_error>(402, file_, ": deflated data ends too early");
  }
  std::uint32_t take(int n) {
    const std::uint32_t bits = peek(n);
    drop(n);
    return bits;
  }
  /// To the next whole byte.
  void align() { drop(held_ % 8); }
  /// Whole bytes taken so far.
  std::size_t position() const { return at_ - static_cast<std::size_t>(held_ / 8); }

  /// `size` bytes after align().
  std::span<const std::byte> take_bytes(std::size_t size) {
    at_ = position();
    hold_ = 0;
    held_ = 0;
    const auto part = slice(bytes_, at_, size, file_, "stored block");
    at_ += size;
    return part;
  }
  [[noreturn]] void malformed(const char* what) const {
    raise<io_error>(403, file_, ": deflated data: ", what, " at byte ", position());
  }

 private:
  std::span<const std::byte> bytes_;
  std::string_view file_;
  std::size_t at_ = 0;
  std::uint64_t hold_ = 0;
  int held_ = 0;
};

/// A canonical Huffman code (RFC 1951, 3.2.2): symbols of equal length have consecutive codes.
class HuffmanCode {
 public:
  /// lengths   bits of the code of each symbol; 0 for a symbol that does not occur
  HuffmanCode(std::span<const std::uint8_t> lengths, const BitReader& in) {
    for (const std::uint8_t n : lengths) ++count_[n];
    count_[0] = 0;
    int free = 1, used = 0;
    for (std::size_t n = 1; n <= longest; ++n) {
      free = 2 * free - count_[n];
      used += count_[n];
      if (free < 0) in.malformed("over-subscribed code");
    }
    if (free > 0 && !(used == 0 || (used == 1 && count_[1] == 1))) in.malformed("incomplete code");

    std::array<std::uint16_t, longest + 2> next_code{}, next_place{};
    for (std::size_t n = 1; n <= longest; ++n) {
      next_code[n + 1] = static_cast<std::uint16_t>((next_code[n] + count_[n]) << 1);
      next_place[n + 1] = static_cast<std::uint16_t>(next_place[n] + count_[n]);
    }
    for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
      const std::size_t n = lengths[symbol];
      if (n == 0) continue;
      symbols_[next_place[n]++] = static_cast<std::uint16_t>(symbol);
      const std::uint32_t code = next_code[n]++;
      if (n > quick_bits) continue;
      for (std::uint32_t rest = 0; rest < 1u << (quick_bits - n); ++rest) {
        quick_[reversed(code, n) | rest << n] = static_cast<std::uint16_t>(symbol << 4 | n);
      }
    }
  }

  std::uint32_t decode(BitReader& in) const {
    if (const std::uint32_t q = quick_[in.peek(quick_bits)]; q != 0) {
      in.drop(static_cast<int>(q & 15u));
      return q >> 4;
    }
    std::uint32_t code = 0, first = 0, place = 0;
    for (std::size_t n = 1; n <= longest; ++n) {
      code |= in.take(1);
      if (code - first < count_[n]) return symbols_[place + code - first];
      place += count_[n];
      first = (first + count_[n]) << 1;
      code <<= 1;
    }
    in.malformed("a code that is not in the table");
  }

 private:
  static constexpr std::size_t longest = 15, quick_bits = 9;

  static std::uint32_t reversed(std::uint32_t code, std::size_t n) {
    std::uint32_t r = 0;
    for (; n > 0; --n, code >>= 1) r = r << 1 | (code & 1u);
    return r;
  }
  std::array<std::uint16_t, longest + 1> count_{};
  std::array<std::uint16_t, 288> symbols_{};
  std::array<std::uint16_t, 1 << quick_bits> quick_{};  // symbol << 4 | length for codes of up to 9 bits
};

/// The two codes of one block.
struct BlockCodes {
  HuffmanCode literal, distance;

  /// RFC 1951, 3.2.6.
  static BlockCodes fixed(const BitReader& in) {
    std::array<std::uint8_t, 288> literal{};
    for (std::size_t i = 0; i < 288; ++i) literal[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
    std::array<std::uint8_t, 32> distance{};
    distance.fill(5);
    return {HuffmanCode(literal, in), HuffmanCode(distance, in)};
  }
  /// RFC 1951, 3.2.7.
  static BlockCodes dynamic(BitReader& in) {
    const std::size_t literals = in.take(5) + 257, distances = in.take(5) + 1, count = in.take(4) + 4;
    if (literals > 286 || distances > 30) in.malformed("too many codes");
    static constexpr std::array<std::uint8_t, 19> order{16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                        11, 4,  12, 3, 13, 2, 14, 1, 15};
    std::array<std::uint8_t, 19> meta_lengths{};
    for (std::size_t i = 0; i < count; ++i) meta_lengths[order[i]] = static_cast<std::uint8_t>(in.take(3));
    const HuffmanCode meta(meta_lengths, in);

    std::array<std::uint8_t, 286 + 30> lengths{};
    const std::size_t total = literals + distances;
    for (std::size_t i = 0; i < total;) {
      const std::uint32_t symbol = meta.decode(in);
      if (symbol < 16) {
        lengths[i++] = static_cast<std::uint8_t>(symbol);
        continue;
      }
      if (symbol == 16 && i == 0) in.malformed("a repetition of nothing");
      const std::uint8_t repeated = symbol == 16 ? lengths[i - 1] : std::uint8_t{0};
      const std::size_t n = symbol == 16 ? 3 + in.take(2) : symbol == 17 ? 3 + in.take(3) : 11 + in.take(7);
      if (i + n > total) in.malformed("too many code lengths");
      for (const std::size_t end = i + n; i < end; ++i) lengths[i] = repeated;
    }
    if (lengths[256] == 0) in.malformed("a block without an end");
    const std::span<const std::uint8_t> all(lengths);
    return {HuffmanCode(all.first(literals), in), HuffmanCode(all.subspan(literals, distances), in)};
  }
};

inline void append_bytes(ByteCount& out, std::span<const std::byte> bytes) { out.bytes += bytes.size(); }

/// Appends `length` bytes, each the one that stands `distance` before it.
inline void repeat(ByteCount& out, std::size_t, std::size_t length) { out.bytes += length; }

inline void repeat(std::vector<std::byte>& out, std::size_t distance, std::size_t length) {
  for (std::size_t k = 0; k < length; ++k) out.push_back(out[out.size() - distance]);
}

template <class Out>
std::size_t inflate_stream(Out& out, std::span<const std::byte> stream, std::size_t limit, std::string_view file,
                           std::size_t enough) {
  // RFC 1951, 3.2.5: symbols 257 ... 285 and 0 ... 29
  static constexpr std::array<std::uint16_t, 29> length_base{3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                                             15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                                             67, 83, 99, 115, 131, 163, 195, 227, 258};
  static constexpr std::array<std::uint8_t, 29> length_bits{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                            2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
  static constexpr std::array<std::uint16_t, 30> distance_base{
      1,   2,   3,   4,   5,   7,    9,    13,   17,   25,   33,   49,   65,    97,    129,
      193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
  BitReader in(stream, file);
  auto room_for = [&](std::size_t n) {
    if (limit - out.size() < n) raise<io_error>(405, file, ": deflated data gives more than ", limit, " bytes");
  };
  for (bool last = false; !last && out.size() < enough;) {
    last = in.take(1) != 0;
    const std::uint32_t kind = in.take(2);
    if (kind == 3) in.malformed("unknown kind of block");
    if (kind == 0) {
      in.align();
      const std::uint32_t size = in.take(16);
      if ((in.take(16) ^ size) != 0xFFFFu) in.malformed("length of a stored block");
      room_for(size);
      append_bytes(out, in.take_bytes(size));
      continue;
    }
    const BlockCodes codes = kind == 1 ? BlockCodes::fixed(in) : BlockCodes::dynamic(in);
    for (std::uint32_t symbol = codes.literal.decode(in); symbol != 256; symbol = codes.literal.decode(in)) {
      if (symbol < 256) {
        room_for(1);
        out.push_back(static_cast<std::byte>(symbol));
        if (out.size() >= enough) break;
        continue;
      }
      if (symbol > 285) in.malformed("unknown length");
      const std::size_t length = length_base[symbol - 257] + in.take(length_bits[symbol - 257]);
      const std::uint32_t d = codes.distance.decode(in);
      if (d > 29) in.malformed("unknown distance");
      const std::size_t distance = distance_base[d] + in.take(static_cast<int>(d < 2 ? 0 : d / 2 - 1));
      if (distance > out.size()) in.malformed("a distance before the start");
      room_for(length);
      repeat(out, distance, length);
      if (out.size() >= enough) break;
    }
  }
  return in.position();
}

MOTIONLANG_BODY std::size_t inflate_to(std::vector<std::byte>& out, std::span<const std::byte> stream,
                                       std::size_t limit, std::string_view file, std::size_t enough) {
  return inflate_stream(out, stream, limit, file, enough);
}

MOTIONLANG_BODY std::size_t inflate_to(ByteCount& out, std::span<const std::byte> stream, std::size_t limit,
                                       std::string_view file, std::size_t enough) {
  return inflate_stream(out, stream, limit, file, enough);
}

MOTIONLANG_BODY Inflated inflate(std::span<const std::byte> stream, std::size_t limit, std::string_view file,
                                 std::size_t expected) {
  Inflated out;
  out.data.reserve(expected);
  out.consumed = inflate_to(out.data, stream, limit, file);
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool is_gzip(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{0x1F} && bytes[1] == std::byte{0x8B};
}

MOTIONLANG_BODY std::vector<std::byte> gunzip_bytes(std::span<const std::byte> bytes, std::string_view name) {
  constexpr std::uint8_t has_checksum = 2, has_extra = 4, has_name = 8, has_comment = 16, reserved = 0xE0;
  if (!is_gzip(bytes)) raise<io_error>(403, name, ": does not begin as a gzip file");
  if (const auto method = detail::load<std::uint8_t>(bytes, 2, name, "the method"); method != 8)
    raise<io_error>(404, name, ": gzip method ", int{method}, ", only 8 (deflate) is known");
  const auto flags = detail::load<std::uint8_t>(bytes, 3, name, "the flags");
  if ((flags & reserved) != 0) raise<io_error>(404, name, ": gzip flags ", int{flags});
  std::uint64_t at = 10;
  if ((flags & has_extra) != 0) at += 2u + detail::load<std::uint16_t>(bytes, at, name, "the extra field");
  for (const auto text : {has_name, has_comment}) {
    if ((flags & text) == 0) continue;
    while (detail::load<char>(bytes, at, name, "a text of the header") != '\0') ++at;
    ++at;
  }
  if ((flags & has_checksum) != 0) at += 2;
  if (at > bytes.size() || bytes.size() - at < 8) raise<io_error>(402, name, ": ends inside the header or the trailer");
  const std::uint64_t trailer = bytes.size() - 8;
  const auto crc = detail::load<std::uint32_t>(bytes, trailer, name, "the checksum");
  const auto size = detail::load<std::uint32_t>(bytes, trailer + 4, name, "the size");
  const auto stream = bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(trailer - at));
  constexpr std::uint64_t largest_ratio = 1032;
  if (size > largest_ratio * stream.size())
    raise<io_error>(405, name, ": declares ", counted(size, "byte"), ", packed in ", stream.size());
  detail::Inflated out = detail::inflate(stream, size, name, size);
  if (out.consumed != stream.size())
    raise<io_error>(403, name, ": ", counted(stream.size() - out.consumed, "byte"),
                    " between the data and the trailer");
  if (out.data.size() != size)
    raise<io_error>(403, name, ": declares ", counted(size, "byte"), ", holds ", out.data.size());
  if (detail::crc32(out.data) != crc) raise<io_error>(403, name, ": wrong checksum");
  return std::move(out.data);
}

MOTIONLANG_BODY std::string gunzip(std::span<const std::byte> bytes, std::string_view name) {
  return std::string(detail::as_text(gunzip_bytes(bytes, name)));
}

MOTIONLANG_BODY std::string read_text(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return is_gzip(file->bytes()) ? gunzip(file->bytes(), path.string()) : std::string(detail::as_text(file->bytes()));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_ID_LIST_HPP  // <motionlang/file/id_list.hpp>
#define MOTIONLANG_HAS_FILE_ID_LIST_HPP
/// Lists of clips: the split files of data sets (train.txt, val.txt, test.txt, ...), one id on each line.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Whether an id names a file in the folder of its data set: it has no control characters and does not lead out.
bool is_clip_id(std::string_view id);

}  // namespace detail

/// The ids of a text in its order, without blanks around them; empty lines are skipped. Repeated ids stay.
/// Throws io_error 403, with the line, for an id that cannot be the name of a file below a folder.
std::vector<std::string> parse_ids(std::string_view text, std::string_view name = "list of ids");
/// Throws io_error 401 and as parse_ids.
std::vector<std::string> read_ids(const FilePath& path);
/// Throws io_error 401, 403 for an id that would not be read again.
void write_ids(const FilePath& path, std::span<const std::string> ids);

/// Mirrored clips have an M in front of their ids.
inline std::string mirrored_id(std::string_view id) { return concat_text("M", id); }

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_ID_LIST_IPP  // <motionlang/file/id_list.ipp>
#define MOTIONLANG_HAS_FILE_ID_LIST_IPP
// Bodies of id_list.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool is_clip_id(std::string_view id) {
  if (id.empty() || id.front() == '/' || trim(id) != id || id.find('\\') != id.npos) return false;
  for (std::size_t at = 0; at <= id.size();) {
    const std::size_t end = std::min(id.find('/', at), id.size());
    const std::string_view part = id.substr(at, end - at);
    if (part.empty() || part == "." || part == "..") return false;
    at = end + 1;
  }
  return std::none_of(id.begin(), id.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> parse_ids(std::string_view text, std::string_view name) {
  std::vector<std::string> ids;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    const std::string_view id = detail::trim(line);
    if (id.empty()) return;
    if (!detail::is_clip_id(id)) raise<io_error>(403, name, ":", number, ": '", id, "' is no id of a clip");
    ids.emplace_back(id);
  });
  return ids;
}

MOTIONLANG_BODY std::vector<std::string> read_ids(const FilePath& path) {
  return parse_ids(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

MOTIONLANG_BODY void write_ids(const FilePath& path, std::span<const std::string> ids) {
  std::string text;
  for (const std::string& id : ids) {
    if (!detail::is_clip_id(id)) raise<io_error>(403, path.string(), ": '", id, "' is no id of a clip");
    text += id + '\n';
  }
  write_file(path, text);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_JSON_HPP  // <motionlang/file/json.hpp>
#define MOTIONLANG_HAS_FILE_JSON_HPP
/// JSON documents: reading with positions in the messages, and typed access that names the way to a wrong value. The
/// only header that includes nlohmann/json.hpp; it costs a translation unit 1.5 s, so include it in few.
///
///     const nlohmann::json document = read_json("config.json");
///     const JsonView config(document, "config.json");
///     const int width = config["model"]["latent_dim"].as<int>();
///     const double rate = config["optim"].value_or("lr", 1e-4);

#include <nlohmann/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Deepest nesting that is read: what works on documents later recurses.
inline constexpr int max_json_depth = 256;

namespace detail {

/// Line and column of a byte of the text, "3:14".
std::string json_place(std::string_view text, std::size_t byte);
/// Throws io_error 403 with line and column of a byte of the text.
[[noreturn]] void raise_json(std::string_view text, std::size_t byte, std::string_view name, std::string_view what);

/// Position behind the string that begins at a quote; npos if it has no end.
std::size_t json_string_end(std::string_view text, std::size_t quote);

/// Reads the document in `size` bytes of a text from `begin` on; messages give the place in the whole text.
nlohmann::json parse_json_part(std::string_view text, std::size_t begin, std::size_t size, std::string_view name);

}  // namespace detail

/// Reads a document. `name` stands in messages. Throws io_error 403 with line and column, also where an object has a
/// duplicate name.
nlohmann::json parse_json(std::string_view text, std::string_view name = "JSON");

/// Reads a file. Throws io_error 401, 403.
nlohmann::json read_json(const FilePath& path);

/// A value inside a document that lives elsewhere, together with the way to it: "config.json: model.layers[2].width".
/// Every access to a value of the wrong kind throws config_error 107 with that way.
class JsonView {
 public:
  explicit JsonView(const nlohmann::json& document, std::string name = "JSON")
      : value_(&document), path_(std::move(name)) {}
  JsonView(nlohmann::json&&, std::string = {}) = delete;  // a view does not keep its document

  const nlohmann::json& json() const { return *value_; }
  const std::string& path() const { return path_; }

  bool is_null() const { return value_->is_null(); }
  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  bool is_string() const { return value_->is_string(); }
  bool is_number() const { return value_->is_number(); }

  /// Whether this is an object with that member.
  bool contains(const std::string& key) const;
  JsonView operator[](const std::string& key) const;
  JsonView operator[](Index i) const;
  /// Number of elements of an array.
  Index size() const;
  /// Names of the members of an object, sorted.
  std::vector<std::string> keys() const;

  /// bool, integers, float, double, std::string, and vectors and maps of these. A number with a fraction is no integer
  /// and an integer has to fit.
  template <class T>
  T as() const {
    T out{};
    get(out);
    return out;
  }
  /// The member `key` if it is there and not null, else `otherwise`.
  template <class T>
  T value_or(const std::string& key, T otherwise) const {
    return contains(key) && !(*value_)[key].is_null() ? (*this)[key].as<T>() : otherwise;
  }
  std::string value_or(const std::string& key, const char* otherwise) const;

 private:
  struct Inner {};
  JsonView(const nlohmann::json& value, std::string path, Inner)
      : value_(&value), path_(std::move(path)), is_root_(false) {}

  [[noreturn]] void fail(std::string_view wanted) const;

  void get(bool& out) const;
  void get(std::string& out) const;
  template <std::floating_point T>
  void get(T& out) const {
    if (!value_->is_number()) fail("a number");
    out = value_->get<T>();
  }
  template <std::integral T>
  void get(T& out) const {
    if (value_->is_number_float()) return get_whole(out);
    if (!value_->is_number_integer()) fail("an integer");
    const bool fits = value_->is_number_unsigned() ? std::in_range<T>(value_->get<std::uint64_t>())
                                                   : std::in_range<T>(value_->get<std::int64_t>());
    if (!fits) raise<config_error>(107, path_, ": ", value_->dump(), " is out of range");
    out = value_->get<T>();
  }
  /// 20.0 where 20 is due: Python writes such numbers.
  template <std::integral T>
  void get_whole(T& out) const {
    const auto number = value_->get<double>();
    if (!(std::abs(number) < 0x1p53) || number != std::trunc(number)) fail("an integer");
    if (!std::in_range<T>(static_cast<std::int64_t>(number))) fail("a smaller integer");
    out = static_cast<T>(number);
  }
  template <class T>
  void get(std::vector<T>& out) const {
    for (Index i = 0; i < size(); ++i) out.push_back((*this)[i].as<T>());
  }
  template <class T>
  void get(std::map<std::string, T>& out) const {
    for (const std::string& key : keys()) out[key] = (*this)[key].template as<T>();
  }

  const nlohmann::json* value_;
  std::string path_;
  bool is_root_ = true;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_JSON_IPP  // <motionlang/file/json.ipp>
#define MOTIONLANG_HAS_FILE_JSON_IPP
// Bodies of json.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string json_place(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const std::size_t line = before.rfind('\n') + 1;  // npos + 1 = 0
  return concat_text(std::count(before.begin(), before.end(), '\n') + 1, ":", before.size() - line + 1);
}

MOTIONLANG_BODY void raise_json(std::string_view text, std::size_t byte, std::string_view name, std::string_view what) {
  raise<io_error>(403, name, ":", json_place(text, byte), ": ", what);
}

MOTIONLANG_BODY std::size_t json_string_end(std::string_view text, std::size_t quote) {
  std::size_t at = quote + 1;
  while (at < text.size() && text[at] != '"') at += text[at] == '\\' ? 2 : 1;
  return at < text.size() ? at + 1 : text.npos;
}

/// Number of members of all objects in a document.
inline std::size_t json_members(const nlohmann::json& document) {
  std::size_t count = document.is_object() ? document.size() : 0;
  if (document.is_structured()) {
    for (const auto& value : document) count += json_members(value);
  }
  return count;
}

/// Throws io_error 403 for a name that appears twice in an object of the well-formed document in a part of the text.
inline void refuse_json_repetition(std::string_view text, std::size_t begin, std::size_t size, std::string_view name) {
  std::vector<std::map<std::string, std::size_t>> objects;  // around the place: names and where they are
  const std::size_t end = begin + size;
  for (std::size_t at = begin; at < end;) {
    const std::size_t start = at++;
    if (text[start] == '{') objects.emplace_back();
    if (text[start] == '}') objects.pop_back();
    if (text[start] != '"') continue;
    at = json_string_end(text, start);
    const std::size_t next = text.find_first_not_of(" \t\r\n", at);
    if (next >= end || text[next] != ':') continue;  // a value
    const std::string key = nlohmann::json::parse(text.substr(start, at - start)).get<std::string>();
    const auto [first, is_new] = objects.back().emplace(key, start);
    if (!is_new)
      raise_json(text, start, name,
                 concat_text("the name '", key, "' appears twice, first at ", json_place(text, first->second)));
  }
}

MOTIONLANG_BODY nlohmann::json parse_json_part(std::string_view text, std::size_t begin, std::size_t size,
                                               std::string_view name) {
  const std::string_view part = text.substr(begin, size);
  std::size_t names = 0;
  const auto shallow = [&](int depth, nlohmann::json::parse_event_t event, const nlohmann::json&) {
    names += event == nlohmann::json::parse_event_t::key;
    if (depth > max_json_depth) raise<io_error>(403, name, ": nested deeper than ", max_json_depth, " levels");
    return true;
  };
  const auto malformed = [&](const nlohmann::json::parse_error& e) -> bool {
    const std::string_view message = e.what();
    const std::size_t detail = message.find(": ");  // behind id and position
    raise_json(text, begin + (e.byte == 0 ? 0 : e.byte - 1), name,
               detail == message.npos ? message : message.substr(detail + 2));
  };
  const auto too_large = [&](const nlohmann::json::out_of_range& e) -> bool {  // ... parsing '1e999'
    const std::string_view message = e.what();
    const std::size_t number = message.find('\'') + 1;
    const std::size_t at = part.find(message.substr(number, message.rfind('\'') - number));
    raise_json(text, begin + std::min(at, size), name, "a number beyond the range of double");
  };
  nlohmann::json document;
  const auto parse = [&] { document = nlohmann::json::parse(part, shallow, has_exceptions); };
  guard<nlohmann::json::parse_error>([&] { guard<nlohmann::json::out_of_range>(parse, too_large); }, malformed);
  if (document.is_discarded())
    raise_json(text, begin, name, "not JSON, or a number beyond the range of double");  // no exceptions
  if (names != json_members(document)) refuse_json_repetition(text, begin, size, name);
  return document;
}

}  // namespace detail

MOTIONLANG_BODY nlohmann::json parse_json(std::string_view text, std::string_view name) {
  return detail::parse_json_part(text, 0, text.size(), name);
}

MOTIONLANG_BODY nlohmann::json read_json(const FilePath& path) { return parse_json(read_file(path), path.string()); }

MOTIONLANG_BODY bool JsonView::contains(const std::string& key) const {
  return value_->is_object() && value_->contains(key);
}

MOTIONLANG_BODY JsonView JsonView::operator[](const std::string& key) const {
  if (!value_->is_object()) fail("an object");
  const auto member = value_->find(key);
  if (member == value_->end()) raise<config_error>(107, path_, ": has no member '", key, "'");
  return {*member, path_ + (is_root_ ? ": " : ".") + key, Inner{}};
}

MOTIONLANG_BODY JsonView JsonView::operator[](Index i) const {
  if (i < 0 || i >= size()) raise<config_error>(107, path_, ": no element ", i, " among ", size());
  return {(*value_)[static_cast<std::size_t>(i)], concat_text(path_, is_root_ ? ": [" : "[", i, "]"), Inner{}};
}

MOTIONLANG_BODY Index JsonView::size() const {
  if (!value_->is_array()) fail("an array");
  return static_cast<Index>(value_->size());
}

MOTIONLANG_BODY std::vector<std::string> JsonView::keys() const {
  if (!value_->is_object()) fail("an object");
  std::vector<std::string> out;
  for (const auto& member : value_->items()) out.push_back(member.key());
  return out;
}

MOTIONLANG_BODY std::string JsonView::value_or(const std::string& key, const char* otherwise) const {
  return value_or(key, std::string(otherwise));
}

MOTIONLANG_BODY void JsonView::fail(std::string_view wanted) const {
  raise<config_error>(107, path_, ": expected ", wanted, ", found ", value_->type_name());
}

MOTIONLANG_BODY void JsonView::get(bool& out) const {
  if (!value_->is_boolean()) fail("true or false");
  out = value_->get<bool>();
}

MOTIONLANG_BODY void JsonView::get(std::string& out) const {
  if (!value_->is_string()) fail("a string");
  out = value_->get_ref<const std::string&>();
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_JSON_MEMBERS_HPP  // <motionlang/file/json_members.hpp>
#define MOTIONLANG_HAS_FILE_JSON_MEMBERS_HPP
/// The members of the object that a JSON file consists of, found without reading their values: a large file of many
/// entries opens quickly and stays on the disk, an entry is parsed when it is asked for.
///
///     const auto file = JsonMembers::open("annotations.json");
///     for (const std::string& id : file.keys()) use(file.load(id));

MOTIONLANG_NAMESPACE_BEGIN

class JsonMembers {
 public:
  /// Throws io_error 401; 403 if the file is not an object, if a name appears twice, and at the end of the file where
  /// something is not closed. Mistakes inside of a value show when it is loaded.
  static JsonMembers open(const FilePath& path);
  static JsonMembers from_text(std::string text, std::string name = "JSON");

  const std::string& name() const { return name_; }
  /// In the order of the file.
  const std::vector<std::string>& keys() const { return keys_; }
  bool has(const std::string& key) const { return parts_.contains(key); }
  /// Throws config_error 103 if there is no such member, io_error 403 with line and column if its value is malformed.
  nlohmann::json load(const std::string& key) const;
  /// Where a member stands, for the messages of a JsonView of it: "annotations.json: 00001".
  std::string place(const std::string& key) const { return name_ + ": " + key; }

 private:
  struct Part {
    std::size_t begin, size;
  };

  JsonMembers(std::string_view text, std::string name, std::shared_ptr<const void> owner);

  void add_member();
  /// To the place behind a value: brackets are counted and strings stepped over. What stands between them is for the
  /// parser.
  void skip_value();
  void skip_string();

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks();
  bool accept(char c);
  void expect(char c);
  [[noreturn]] void fail(std::size_t at, std::string_view what) const { detail::raise_json(text_, at, name_, what); }

  std::string_view text_;
  std::string name_;
  std::shared_ptr<const void> owner_;
  std::size_t at_ = 0;
  std::vector<std::string> keys_;
  std::unordered_map<std::string, Part> parts_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_JSON_MEMBERS_IPP  // <motionlang/file/json_members.ipp>
#define MOTIONLANG_HAS_FILE_JSON_MEMBERS_IPP
// Bodies of json_members.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY JsonMembers JsonMembers::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return JsonMembers(detail::as_text(file->bytes()), path.string(), file);
}

MOTIONLANG_BODY JsonMembers JsonMembers::from_text(std::string text, std::string name) {
  const auto kept = std::make_shared<const std::string>(std::move(text));
  return JsonMembers(*kept, std::move(name), kept);
}

MOTIONLANG_BODY nlohmann::json JsonMembers::load(const std::string& key) const {
  const auto found = parts_.find(key);
  if (found == parts_.end()) raise<config_error>(103, name_, ": has no member '", key, "'");
  return detail::parse_json_part(text_, found->second.begin, found->second.size, name_);
}

MOTIONLANG_BODY JsonMembers::JsonMembers(std::string_view text, std::string name, std::shared_ptr<const void> owner)
    : text_(text), name_(std::move(name)), owner_(std::move(owner)) {
  if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // byte order mark
  expect('{');
  if (!accept('}')) {
    do add_member();
    while (accept(','));
    expect('}');
  }
  skip_blanks();
  if (at_ != text_.size()) fail(at_, "something follows the object");
}

MOTIONLANG_BODY void JsonMembers::add_member() {
  skip_blanks();
  const std::size_t start = at_;
  if (peek() != '"') fail(at_, "expected a name in quotes");
  skip_string();
  const auto key = detail::parse_json_part(text_, start, at_ - start, name_).get<std::string>();
  expect(':');
  skip_blanks();
  const std::size_t value = at_;
  skip_value();
  if (at_ == value) fail(at_, "expected a value");
  const auto [first, is_new] = parts_.emplace(key, Part{value, at_ - value});
  if (!is_new)
    fail(start, concat_text("the name '", key, "' appears twice, first with the value at ",
                            detail::json_place(text_, first->second.begin)));
  keys_.push_back(key);
}

MOTIONLANG_BODY void JsonMembers::skip_value() {
  if (peek() != '{' && peek() != '[' && peek() != '"') {
    at_ = std::min(text_.find_first_of(",:{}[]\" \t\r\n", at_), text_.size());
    return;
  }
  int depth = 0;
  do {
    const char c = peek();
    if (at_ == text_.size()) fail(at_, "the text ends inside of a value");
    if (c == '"') {
      skip_string();
    } else {
      depth += (c == '{' || c == '[') - (c == '}' || c == ']');
      ++at_;
    }
  } while (depth > 0);
}

MOTIONLANG_BODY void JsonMembers::skip_string() {
  const std::size_t end = detail::json_string_end(text_, at_);
  if (end == text_.npos) fail(at_, "a string has no end");
  at_ = end;
}

MOTIONLANG_BODY void JsonMembers::skip_blanks() {
  while (peek() == ' ' || peek() == '\t' || peek() == '\r' || peek() == '\n') ++at_;
}

MOTIONLANG_BODY bool JsonMembers::accept(char c) {
  skip_blanks();
  return peek() == c && (++at_, true);
}

MOTIONLANG_BODY void JsonMembers::expect(char c) {
  if (!accept(c)) fail(at_, concat_text("expected '", c, "'"));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_KEY_REPORT_HPP  // <motionlang/file/key_report.hpp>
#define MOTIONLANG_HAS_FILE_KEY_REPORT_HPP
/// Names of tensors that do not match between a file and a model, as one list that a person can act on.

MOTIONLANG_NAMESPACE_BEGIN

/// Names that a file lacks, and names that nobody asked for.
struct KeyReport {
  std::vector<std::string> missing, unexpected;
};

/// How many characters have to be inserted, removed or exchanged to make b of a (Levenshtein), or `limit` if it is that
/// many.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit);

/// The name that is most like `name`; empty if none has half of it. Of a long list only the first 2,000 names are
/// looked at.
std::string nearest_name(std::string_view name, const std::vector<std::string>& among);

/// A line for each name, and beside it the name of the other list that is most like it.
std::string to_string(const KeyReport& report);

namespace detail {

[[noreturn]] void raise_key_mismatch(std::string_view file, const KeyReport& report);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_KEY_REPORT_IPP  // <motionlang/file/key_report.ipp>
#define MOTIONLANG_HAS_FILE_KEY_REPORT_IPP
// Bodies of key_report.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) >= limit) return limit;
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t k = 0; k < row.size(); ++k) row[k] = k;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t exchanged = diagonal + (a[i] == b[k] ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min(exchanged, std::min(diagonal, row[k]) + 1);
    }
  }
  return std::min(row.back(), limit);
}

MOTIONLANG_BODY std::string nearest_name(std::string_view name, const std::vector<std::string>& among) {
  constexpr std::size_t longest = 256;
  std::string_view best;
  std::size_t distance = std::min(name.size(), longest) / 2 + 1;
  for (const std::string& candidate : std::span(among).first(std::min<std::size_t>(among.size(), 2000))) {
    if (name.size() > longest || candidate.size() > longest) continue;
    const std::size_t d = edit_distance(name, candidate, distance);
    if (d < distance) distance = d, best = candidate;
  }
  return std::string(best);
}

MOTIONLANG_BODY std::string to_string(const KeyReport& report) {
  constexpr std::size_t most = 20;  // lines of a list
  std::string text;
  const auto list = [&](const char* what, const std::vector<std::string>& names, const std::vector<std::string>& others,
                        const char* has) {
    for (std::size_t i = 0; i < names.size() && i < most; ++i) {
      const std::string like = nearest_name(names[i], others);
      text += concat_text("\n  ", what, " ", names[i]);
      if (!like.empty()) text += concat_text("  (", has, " ", like, ")");
    }
    if (names.size() > most) text += concat_text("\n  ", what, " ", names.size() - most, " more");
  };
  list("missing   ", report.missing, report.unexpected, "the file has");
  list("unexpected", report.unexpected, report.missing, "the model has");
  return text;
}

namespace detail {

MOTIONLANG_BODY void raise_key_mismatch(std::string_view file, const KeyReport& report) {
  raise<io_error>(406, file, ": ", counted(report.missing.size(), "tensor is missing", "tensors are missing"), ", ",
                  counted(report.unexpected.size(), "is", "are"), " not expected:", report);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_NPY_HPP  // <motionlang/file/npy.hpp>
#define MOTIONLANG_HAS_FILE_NPY_HPP
/// NumPy arrays: .npy files, versions 1 to 3. Numbers, booleans and texts of fixed width; neither objects (a pickle)
/// nor records nor complex numbers.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_NPY_HEADER_HPP  // <motionlang/file/detail/npy_header.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_NPY_HEADER_HPP
/// The header of a .npy file: a small parser for the Python dictionary in which NumPy describes an array.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Reads the header of a .npy file: a Python dictionary with the keys descr, fortran_order and shape.
/// Source  numpy.lib.format; also the Python 2 form of integers (3L).
class NpyHeader {
 public:
  std::string descr;
  bool fortran_order = false;
  std::vector<Index> shape;

  NpyHeader(std::string_view text, std::size_t offset, std::string_view file);

  template <class... T>
  [[noreturn]] void fail(const T&... what) const {
    raise<io_error>(403, file_, ": npy header: ", what..., " at byte ", offset_ + at_);
  }
  template <class... T>
  [[noreturn]] void unsupported(const T&... what) const {
    raise<io_error>(404, file_, ": npy header: ", what..., " at byte ", offset_ + at_);
  }

 private:
  static constexpr std::size_t max_rank = 64;  // NumPy 2; NumPy 1 has 32

  char peek();
  bool accept(char c) { return peek() == c && (++at_, true); }
  void expect(char c);
  bool accept_word(std::string_view word);
  std::string quoted();
  bool boolean();
  std::vector<Index> tuple();

  std::string_view text_;
  std::size_t offset_;
  std::string_view file_;
  std::size_t at_ = 0;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_DETAIL_NPY_HEADER_IPP  // <motionlang/file/detail/npy_header.ipp>
#define MOTIONLANG_HAS_FILE_DETAIL_NPY_HEADER_IPP
// Bodies of npy_header.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY NpyHeader::NpyHeader(std::string_view text, std::size_t offset, std::string_view file)
    : text_(text), offset_(offset), file_(file) {
  expect('{');
  std::string seen;
  while (!accept('}')) {
    const std::string key = quoted();
    expect(':');
    if (seen.find(key + ",") != std::string::npos) fail("key '", key, "' twice");
    seen += key + ",";
    if (key == "descr") {
      if (peek() == '[') unsupported("a record type");
      descr = quoted();
    } else if (key == "fortran_order") {
      fortran_order = boolean();
    } else if (key == "shape") {
      shape = tuple();
    } else {
      fail("unknown key '", key, "'");
    }
    if (!accept(',') && peek() != '}') fail("no comma after '", key, "'");
  }
  if (peek() != '\0') fail("characters after the dictionary");
  if (seen.size() != std::string_view("descr,fortran_order,shape,").size()) fail("has only the keys ", seen);
}

MOTIONLANG_BODY char NpyHeader::peek() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t')) ++at_;
  return at_ < text_.size() ? text_[at_] : '\0';
}

MOTIONLANG_BODY void NpyHeader::expect(char c) {
  if (!accept(c)) fail("'", c, "' expected");
}

MOTIONLANG_BODY bool NpyHeader::accept_word(std::string_view word) {
  peek();
  if (!text_.substr(at_).starts_with(word)) return false;
  at_ += word.size();
  return true;
}

MOTIONLANG_BODY std::string NpyHeader::quoted() {
  const char quote = peek();
  if (quote != '\'' && quote != '"') fail("a text in quotes expected");
  const std::size_t start = ++at_;
  const std::size_t end = text_.find(quote, start);
  if (end == std::string_view::npos) fail("a text without end");
  at_ = end + 1;
  return std::string(text_.substr(start, end - start));
}

MOTIONLANG_BODY bool NpyHeader::boolean() {
  if (accept_word("True")) return true;
  if (!accept_word("False")) fail("True or False expected");
  return false;
}

MOTIONLANG_BODY std::vector<Index> NpyHeader::tuple() {
  std::vector<Index> sizes;
  expect('(');
  while (!accept(')')) {
    peek();
    Index size = 0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), size);
    if (error != std::errc() || size < 0) fail("a size that is not negative expected");
    at_ = static_cast<std::size_t>(end - text_.data());
    if (at_ < text_.size() && text_[at_] == 'L') ++at_;
    if (sizes.size() == max_rank) fail("more than ", max_rank, " sizes");
    sizes.push_back(size);
    if (!accept(',') && peek() != ')') fail("no comma in the shape");
  }
  return sizes;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Calls f with a value of the element type that NumPy calls kind and size; false if there is no such number. Halves
/// are handed over as HalfBits.
struct HalfBits {
  std::uint16_t bits;
};
template <class F>
bool with_npy_number(char kind, std::size_t size, F f) {
  auto call = [&](auto value) { return f(value), true; };
  switch (kind) {
    case 'f':
      return size == 2 ? call(HalfBits{}) : size == 4 ? call(float{}) : size == 8 && call(double{});
    case 'b':
      return size == 1 && call(std::uint8_t{});  // any byte but 0 is true
    case 'i':
      return size == 1   ? call(std::int8_t{})
             : size == 2 ? call(std::int16_t{})
             : size == 4 ? call(std::int32_t{})
                         : size == 8 && call(std::int64_t{});
    case 'u':
      return size == 1   ? call(std::uint8_t{})
             : size == 2 ? call(std::uint16_t{})
             : size == 4 ? call(std::uint32_t{})
                         : size == 8 && call(std::uint64_t{});
    default:
      return false;
  }
}

template <class T>
constexpr char npy_kind = std::same_as<T, bool>       ? 'b'
                          : std::floating_point<T>    ? 'f'
                          : std::signed_integral<T>   ? 'i'
                          : std::unsigned_integral<T> ? 'u'
                                                      : '?';
/// Elements that are stored as they are in memory.
template <class T>
concept NpyNumber = std::is_arithmetic_v<T> && sizeof(T) <= 8 && sizeof(bool) == 1;

}  // namespace detail

/// An array as a file holds it: element type, sizes, and the elements, little-endian, in C order (last index fastest).
struct NpyArray {
  char kind = 'f';            // f real, i integer, u unsigned, b boolean, S bytes, U text
  std::size_t item_size = 4;  // bytes of one element; a character of U has four
  std::vector<Index> shape;   // empty: a single value
  std::vector<std::byte> data;
  std::string place = "NpyArray";  // for messages: where it was read

  /// Throws shape_error 205 if the number of values does not fit the shape.
  template <detail::NpyNumber T>
  static NpyArray of(std::span<const T> values, std::vector<Index> shape) {
    NpyArray a{detail::npy_kind<T>, sizeof(T), std::move(shape), {}};
    if (static_cast<Index>(values.size()) != a.count()) {
      raise<shape_error>(205, "NpyArray: ", counted(values.size(), "value"), " for a shape of ", a.count());
    }
    detail::append_bytes(a.data, std::as_bytes(values));
    return a;
  }
  template <detail::NpyNumber T>
  static NpyArray scalar(T value) {
    return of(std::span<const T>(&value, 1), {});
  }
  /// A single text (type U), from UTF-8; bytes that are not UTF-8 become U+FFFD.
  static NpyArray text(std::string_view utf8);

  /// Number of elements.
  Index count() const;
  bool is_text() const { return kind == 'S' || kind == 'U'; }
  /// Element type as NumPy writes it, for instance "<f4".
  std::string type() const;

  /// All elements as T. Real numbers from any number; integers from integers and booleans.
  /// Throws io_error 407 for texts, for real numbers as integers, and for integers out of T's range.
  template <class T>
  requires std::is_arithmetic_v<T> std::vector<T> to()
  const;
  /// The only element as T. Throws io_error 407 if there are more.
  template <class T>
  T value() const {
    require_one();
    return to<T>().front();
  }

  /// All texts as UTF-8, without the NULs that fill them up. Throws io_error 407 if the elements are numbers.
  std::vector<std::string> texts() const;
  /// The only text. Throws io_error 407 if there are more, or if it is a number.
  std::string text() const;

 private:
  void require_one() const;
  template <class T, class E>
  T converted(E value) const {
    if constexpr (std::same_as<E, detail::HalfBits>) {
      return converted<T>(half_to_float(value.bits));
    } else if constexpr (std::integral<T> && !std::same_as<T, bool>) {
      if constexpr (std::floating_point<E>) {
        raise<io_error>(407, place, ": real numbers where integers are expected");
      } else {
        if (!std::in_range<T>(value)) raise<io_error>(407, place, ": ", value, " is out of range");
        return static_cast<T>(value);
      }
    } else {
      return static_cast<T>(value);
    }
  }
};

template <class T>
requires std::is_arithmetic_v<T> std::vector<T> NpyArray::to()
const {
  std::vector<T> out;
  out.reserve(static_cast<std::size_t>(count()));
  const bool known = detail::with_npy_number(kind, item_size, [&](auto type_tag) {
    using E = decltype(type_tag);
    for (std::size_t at = 0; at < data.size(); at += sizeof(E)) {
      E value;
      std::memcpy(&value, data.data() + at, sizeof(E));
      out.push_back(converted<T>(value));
    }
  });
  if (!known) raise<io_error>(407, place, ": elements of type ", type(), " are not numbers");
  return out;
}

namespace detail {

/// Bytes of an array of this shape. Throws io_error 405 if they cannot be counted in 63 bits, 404 for elements of no
/// size.
std::size_t checked_size(std::span<const Index> shape, std::size_t item_size, std::string_view where);

/// An array of an element type of NumPy (">f8") and a shape, without its elements. `where` is for messages.
/// Throws  io_error 404 for other element types
NpyArray described_array(std::string_view type, std::vector<Index> shape, std::string_view where);

/// Throws io_error 402 if the data have fewer bytes than the array, 403 if they have more, 405 for impossible sizes.
void check_raw_size(const NpyArray& array, std::size_t bytes, std::string_view where);

/// An array as NumPy stores it, in .npy files and in pickles. `raw` are all its bytes. Throws like the two above.
NpyArray stored_array(std::string_view type, bool fortran_order, std::vector<Index> shape,
                      std::span<const std::byte> raw, std::string_view where);

inline constexpr std::size_t longest_npy_header = 65536;

/// A .npy file in parts: what its header says, and the bytes behind it.
struct NpyParts {
  NpyHeader header;
  std::span<const std::byte> raw;
  std::string where;  // for messages
};
/// Throws io_error 402 if the file is too short, 403 if the header is malformed, 404 for other versions, 405 for a long
/// header.
NpyParts npy_parts(std::span<const std::byte> bytes, std::string_view file);

/// Compares the header of a .npy file, of which the first bytes are given, with its size. Throws as parse_npy.
void check_npy_size(std::span<const std::byte> head, std::uint64_t size, std::string_view file);

}  // namespace detail

/// An array from the bytes of a .npy file.
/// file    for messages
/// Throws  io_error 402 if the file is too short, 403 if it is malformed (trailing bytes, too), 404 for other element
///         types and versions, 405 for impossible sizes
NpyArray parse_npy(std::span<const std::byte> bytes, std::string_view file);

/// The bytes of a .npy file, version 1.0, data at a multiple of 64: exactly what numpy.save writes.
std::vector<std::byte> npy_bytes(const NpyArray& array);

/// Throws io_error 401 to 405.
NpyArray read_npy(const FilePath& path);
/// Throws io_error 401.
void write_npy(const FilePath& path, const NpyArray& array);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_NPY_IPP  // <motionlang/file/npy.ipp>
#define MOTIONLANG_HAS_FILE_NPY_IPP
// Bodies of npy.hpp.

#include <functional>  // multiplies

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY NpyArray NpyArray::text(std::string_view utf8) {
  NpyArray a{'U', 0, {}, {}};
  for (std::size_t at = 0; at < utf8.size();) {
    const char32_t c = decode_utf8(utf8, at);
    detail::append_value(a.data, c == invalid_code_point ? U'\uFFFD' : c);
  }
  if (a.data.empty()) detail::append_value(a.data, U'\0');  // NumPy has no texts of no characters
  a.item_size = a.data.size();
  return a;
}

MOTIONLANG_BODY Index NpyArray::count() const {
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  return std::accumulate(shape.begin(), shape.end(), Index{1}, std::multiplies<>());
}

MOTIONLANG_BODY std::string NpyArray::type() const {
  const bool one_byte = item_size == 1 || kind == 'S';
  return concat_text(one_byte ? '|' : '<', kind, kind == 'U' ? item_size / 4 : item_size);
}

MOTIONLANG_BODY std::vector<std::string> NpyArray::texts() const {
  if (!is_text()) raise<io_error>(407, place, ": elements of type ", type(), " are not texts");
  std::vector<std::string> out(static_cast<std::size_t>(count()));
  const std::size_t unit = kind == 'U' ? 4 : 1;
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t at = i * item_size; at < (i + 1) * item_size; at += unit) {
      char32_t c = 0;
      std::memcpy(&c, data.data() + at, unit);
      if (kind == 'S') {
        out[i] += static_cast<char>(c);
      } else {
        append_utf8(out[i], c > 0x10FFFF || (c >= 0xD800 && c < 0xE000) ? U'\uFFFD' : c);
      }
    }
    out[i].erase(out[i].find_last_not_of('\0') + 1);
  }
  return out;
}

MOTIONLANG_BODY std::string NpyArray::text() const {
  require_one();
  return texts().front();
}

MOTIONLANG_BODY void NpyArray::require_one() const {
  if (count() != 1) raise<io_error>(407, place, ": ", counted(count(), "element"), " where one is expected");
}

namespace detail {

/// Reorders elements whose first index is the fastest to C order. Visits them in C order with an odometer of indices.
inline std::vector<std::byte> from_fortran_order(std::span<const std::byte> in, std::span<const Index> shape,
                                                 std::size_t item_size) {
  std::vector<std::byte> out;
  out.reserve(in.size());
  std::vector<std::size_t> index(shape.size(), 0), stride(shape.size(), item_size);
  for (std::size_t d = 1; d < shape.size(); ++d) stride[d] = stride[d - 1] * static_cast<std::size_t>(shape[d - 1]);
  std::size_t at = 0;
  while (out.size() < in.size()) {
    append_bytes(out, in.subspan(at, item_size));
    for (std::size_t d = shape.size(); d-- > 0;) {
      at += stride[d];
      if (++index[d] < static_cast<std::size_t>(shape[d])) break;
      at -= stride[d] * index[d];
      index[d] = 0;
    }
  }
  return out;
}

MOTIONLANG_BODY std::size_t checked_size(std::span<const Index> shape, std::size_t item_size, std::string_view where) {
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  std::uint64_t size = item_size;
  if (size == 0) raise<io_error>(404, where, ": elements of no size");
  for (const Index n : shape) {
    if (size > static_cast<std::uint64_t>(INT64_MAX) / static_cast<std::uint64_t>(n)) {
      raise<io_error>(405, where, ": the product of the shape is too large");
    }
    size *= static_cast<std::uint64_t>(n);
  }
  return static_cast<std::size_t>(size);
}

MOTIONLANG_BODY NpyArray described_array(std::string_view type, std::vector<Index> shape, std::string_view where) {
  NpyArray array;
  array.shape = std::move(shape);
  array.place = where;
  std::size_t digits = 0;
  const char* end = type.data() + type.size();
  if (type.size() < 3 || std::from_chars(type.data() + 2, end, digits).ptr != end || digits > 1'000'000'000) {
    raise<io_error>(404, where, ": element type '", type, "'");
  }
  array.kind = type[1];
  array.item_size = array.kind == 'U' ? 4 * digits : digits;
  const bool known_order = type[0] == '<' || type[0] == '>' || type[0] == '|' || type[0] == '=';
  if (!known_order || !(array.is_text() || with_npy_number(array.kind, digits, [](auto) {}))) {
    raise<io_error>(404, where, ": element type '", type, "'");
  }
  return array;
}

MOTIONLANG_BODY void check_raw_size(const NpyArray& array, std::size_t bytes, std::string_view where) {
  const std::size_t needed = checked_size(array.shape, array.item_size, where);
  if (bytes < needed) raise<io_error>(402, where, ": array data of ", counted(bytes, "byte"), ", ", needed, " needed");
  if (bytes > needed) raise<io_error>(403, where, ": ", counted(bytes - needed, "byte"), " after the array data");
}

MOTIONLANG_BODY NpyArray stored_array(std::string_view type, bool fortran_order, std::vector<Index> shape,
                                      std::span<const std::byte> raw, std::string_view where) {
  NpyArray array = described_array(type, std::move(shape), where);
  check_raw_size(array, raw.size(), where);
  array.data = fortran_order ? from_fortran_order(raw, array.shape, array.item_size)
                             : std::vector<std::byte>(raw.begin(), raw.end());
  const std::size_t unit = array.kind == 'U' ? 4 : array.kind == 'S' ? 1 : array.item_size;
  if (type[0] == '>') {
    for (auto at = array.data.begin(); at != array.data.end(); at += static_cast<std::ptrdiff_t>(unit)) {
      std::reverse(at, at + static_cast<std::ptrdiff_t>(unit));
    }
  }
  return array;
}

MOTIONLANG_BODY NpyParts npy_parts(std::span<const std::byte> bytes, std::string_view file) {
  constexpr std::string_view magic = "\x93NUMPY";
  if (!as_text(bytes).starts_with(magic)) raise<io_error>(403, file, ": not a .npy file (byte 0)");
  const auto major = load<std::uint8_t>(bytes, 6, file, "npy version");
  if (major < 1 || major > 3) raise<io_error>(404, file, ": .npy version ", int{major}, " at byte 6");
  const std::size_t length = major == 1 ? load<std::uint16_t>(bytes, 8, file, "npy header length")
                                        : load<std::uint32_t>(bytes, 8, file, "npy header length");
  if (length > longest_npy_header)
    raise<io_error>(405, file, ": npy header of ", counted(length, "byte"), " at byte 8");
  const std::size_t start = major == 1 ? 10 : 12;
  return {NpyHeader(as_text(slice(bytes, start, length, file, "npy header")), start, file),
          bytes.subspan(start + length), concat_text(file, ": npy at byte ", start)};
}

MOTIONLANG_BODY void check_npy_size(std::span<const std::byte> head, std::uint64_t size, std::string_view file) {
  const NpyParts npy = npy_parts(head, file);
  const std::uint64_t before = head.size() - npy.raw.size();
  if (size < before)
    raise<io_error>(402, npy.where, ": a header of ", counted(before, "byte"), ", the file has ", size);
  check_raw_size(described_array(npy.header.descr, npy.header.shape, npy.where),
                 static_cast<std::size_t>(size - before), npy.where);
}

}  // namespace detail

MOTIONLANG_BODY NpyArray parse_npy(std::span<const std::byte> bytes, std::string_view file) {
  detail::NpyParts npy = detail::npy_parts(bytes, file);
  return detail::stored_array(npy.header.descr, npy.header.fortran_order, std::move(npy.header.shape), npy.raw,
                              npy.where);
}

MOTIONLANG_BODY std::vector<std::byte> npy_bytes(const NpyArray& array) {
  std::string header = concat_text("{'descr': '", array.type(), "', 'fortran_order': False, 'shape': (",
                                   join_text(array.shape), array.shape.size() == 1 ? ",), }" : "), }");
  constexpr std::size_t before = 10, alignment = 64;
  header.append(alignment - 1 - (before + header.size()) % alignment, ' ');
  header += '\n';
  std::vector<std::byte> out;
  detail::append_text(out, std::string_view("\x93NUMPY\x01\x00", 8));
  detail::append_value(out, static_cast<std::uint16_t>(header.size()));
  detail::append_text(out, header);
  detail::append_bytes(out, array.data);
  return out;
}

MOTIONLANG_BODY NpyArray read_npy(const FilePath& path) {
  return parse_npy(MappedFile::open(path)->bytes(), path.string());
}

MOTIONLANG_BODY void write_npy(const FilePath& path, const NpyArray& array) { write_file(path, npy_bytes(array)); }

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_NPZ_HPP  // <motionlang/file/npz.hpp>
#define MOTIONLANG_HAS_FILE_NPZ_HPP
/// NumPy's .npz archives: several arrays in a zip, array "poses" as member "poses.npy". Written uncompressed.

#ifndef MOTIONLANG_HAS_FILE_ZIP_HPP  // <motionlang/file/zip.hpp>
#define MOTIONLANG_HAS_FILE_ZIP_HPP
/// Zip archives, as NumPy (.npz) and PyTorch write them: reading stored and deflated members, writing stored ones.
///
/// Reading believes the central directory only and refuses what an honest writer does not produce. No encryption, no
/// archives in several parts; written archives are below 4 GiB.

MOTIONLANG_NAMESPACE_BEGIN

/// One member: where its bytes lie in the archive, and what they should be.
struct ZipEntry {
  std::string name;
  std::uint64_t offset = 0;  // of the (packed) data
  std::uint64_t packed = 0;  // bytes in the archive
  std::uint64_t size = 0;    // bytes after unpacking
  std::uint32_t crc = 0;
  bool deflated = false;
};

/// An archive that is being read. Its directory is checked on opening, a member when it is asked for.
class ZipArchive {
 public:
  /// Throws io_error 401 to 405.
  static ZipArchive open(const FilePath& path);
  /// name    for messages
  /// owner   kept alive as long as the archive is, for instance the mapped file that holds `bytes`
  ZipArchive(std::span<const std::byte> bytes, std::string name, std::shared_ptr<const void> owner = nullptr);

  const std::string& name() const { return name_; }
  const std::vector<ZipEntry>& entries() const { return entries_; }
  /// The member of that name, or null.
  const ZipEntry* find(std::string_view member) const;

  /// The bytes of a stored member where they lie, without a copy and without a checksum. Throws io_error 404 if it is
  /// deflated.
  std::span<const std::byte> stored(const ZipEntry& entry) const;
  /// The same after a look at the checksum. Throws io_error 403, 404.
  std::span<const std::byte> checked(const ZipEntry& entry) const;
  /// The first unpacked bytes of a deflated member, at least `count` of them if it has so many; not checked. Throws
  /// io_error 402, 403.
  std::vector<std::byte> head(const ZipEntry& entry, std::size_t count) const;
  /// The unpacked bytes, checked against size and checksum.
  /// Throws  io_error 402, 403 if the data are damaged, 405 if they are more than the directory says
  std::vector<std::byte> read(const ZipEntry& entry) const;

 private:
  void check_crc(const ZipEntry& entry, std::span<const std::byte> data) const;
  template <class T>
  T at(std::uint64_t offset, std::string_view what) const {
    return detail::load<T>(bytes_, offset, name_, what);
  }

  /// Finds the end record from the back; with ZIP64 the larger record that stands before it.
  void read_directory();

  /// Reads the directory entry at `position` and gives the position of the next.
  std::uint64_t read_entry(std::uint64_t position);

  /// Extra field 1: eight bytes for each of size, packed, header that does not fit into four.
  void read_zip64(std::uint64_t position, std::uint64_t length, ZipEntry& e, std::uint64_t& header) const;

  static bool leads_out(const std::string& member);

  void check_ranges() const;

  std::span<const std::byte> bytes_;
  std::string name_;
  std::shared_ptr<const void> owner_;
  std::vector<ZipEntry> entries_;
};

/// An archive that is being written: add members, then take the bytes. The same members give the same bytes (no dates).
class ZipWriter {
 public:
  /// Throws io_error 405 when the archive would need ZIP64.
  void add(std::string_view name, std::span<const std::byte> data);

  /// The whole archive; the writer is empty afterwards.
  std::vector<std::byte> finish();

 private:
  template <class N>
  static void append_numbers(std::vector<std::byte>& out, std::initializer_list<N> numbers) {
    for (const N n : numbers) detail::append_value(out, n);
  }
  std::vector<std::byte> bytes_, directory_;
  std::uint16_t count_ = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_ZIP_IPP  // <motionlang/file/zip.ipp>
#define MOTIONLANG_HAS_FILE_ZIP_IPP
// Bodies of zip.hpp.

#include <unordered_set>  // repeated names

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY ZipArchive ZipArchive::open(const FilePath& path) {
  auto file = MappedFile::open(path);
  return ZipArchive(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY ZipArchive::ZipArchive(std::span<const std::byte> bytes, std::string name,
                                       std::shared_ptr<const void> owner)
    : bytes_(bytes), name_(std::move(name)), owner_(std::move(owner)) {
  read_directory();
  check_ranges();
}

MOTIONLANG_BODY const ZipEntry* ZipArchive::find(std::string_view member) const {
  for (const ZipEntry& e : entries_) {
    if (e.name == member) return &e;
  }
  return nullptr;
}

MOTIONLANG_BODY std::span<const std::byte> ZipArchive::stored(const ZipEntry& entry) const {
  if (entry.deflated)
    raise<io_error>(404, name_, ": member '", entry.name, "' at byte ", entry.offset, " is compressed");
  return bytes_.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.packed));
}

MOTIONLANG_BODY std::span<const std::byte> ZipArchive::checked(const ZipEntry& entry) const {
  const auto data = stored(entry);
  check_crc(entry, data);
  return data;
}

MOTIONLANG_BODY std::vector<std::byte> ZipArchive::head(const ZipEntry& entry, std::size_t count) const {
  const auto raw = bytes_.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.packed));
  std::vector<std::byte> out;
  detail::inflate_to(out, raw, std::numeric_limits<std::size_t>::max(), name_ + "/" + entry.name, count);
  return out;
}

MOTIONLANG_BODY std::vector<std::byte> ZipArchive::read(const ZipEntry& entry) const {
  const auto raw = bytes_.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.packed));
  const std::string where = name_ + "/" + entry.name;
  const auto size = static_cast<std::size_t>(entry.size);
  std::vector<std::byte> data =
      entry.deflated ? detail::inflate(raw, size, where, size).data : std::vector<std::byte>(raw.begin(), raw.end());
  if (data.size() != entry.size) {
    raise<io_error>(403, where, " at byte ", entry.offset, ": unpacks to ", counted(data.size(), "byte"),
                    ", the directory says ", entry.size);
  }
  check_crc(entry, data);
  return data;
}

MOTIONLANG_BODY void ZipArchive::check_crc(const ZipEntry& entry, std::span<const std::byte> data) const {
  if (const std::uint32_t crc = detail::crc32(data); crc != entry.crc) {
    raise<io_error>(403, name_, "/", entry.name, " at byte ", entry.offset, ": checksum ", crc, ", the directory says ",
                    entry.crc);
  }
}

MOTIONLANG_BODY void ZipArchive::read_directory() {
  constexpr std::uint64_t end_size = 22, longest_comment = 65535, locator_size = 20;
  if (bytes_.size() < end_size)
    raise<io_error>(403, name_, ": ", counted(bytes_.size(), "byte is", "bytes are"), " too short for a zip archive");
  std::uint64_t end = bytes_.size() - end_size;
  const std::uint64_t first = end > longest_comment ? end - longest_comment : 0;
  while (at<std::uint32_t>(end, "end record") != 0x06054B50u) {
    if (end == first)
      raise<io_error>(403, name_, ": no end record of a zip archive from byte ", first, " on: not a zip, or cut off");
    --end;
  }
  std::uint64_t count = at<std::uint16_t>(end + 10, "end record"), size = at<std::uint32_t>(end + 12, "end record");
  std::uint64_t start = at<std::uint32_t>(end + 16, "end record");
  if (at<std::uint16_t>(end + 4, "end record") != at<std::uint16_t>(end + 6, "end record")) {
    raise<io_error>(404, name_, ": zip archive in several parts, says its end record at byte ", end);
  }
  if (end >= locator_size && at<std::uint32_t>(end - locator_size, "ZIP64 locator") == 0x07064B50u) {
    const auto large = at<std::uint64_t>(end - locator_size + 8, "ZIP64 locator");
    if (at<std::uint32_t>(large, "ZIP64 end record") != 0x06064B50u) {
      raise<io_error>(403, name_, ": no ZIP64 end record at byte ", large);
    }
    count = at<std::uint64_t>(large + 32, "ZIP64 end record");
    size = at<std::uint64_t>(large + 40, "ZIP64 end record");
    start = at<std::uint64_t>(large + 48, "ZIP64 end record");
  }
  const auto directory = detail::slice(bytes_, start, size, name_, "zip directory");
  constexpr std::uint64_t most_members = 100'000;
  if (count > most_members)
    raise<io_error>(405, name_, ": ", counted(count, "member"), ", says the end record at byte ", end, "; at most ",
                    most_members);
  std::uint64_t position = start;
  for (std::uint64_t i = 0; i < count; ++i) position = read_entry(position);
  if (position > start + directory.size())
    raise<io_error>(403, name_, ": zip directory runs past its end at byte ", start + directory.size());
}

MOTIONLANG_BODY std::uint64_t ZipArchive::read_entry(std::uint64_t position) {
  constexpr std::string_view what = "zip directory entry";
  if (at<std::uint32_t>(position, what) != 0x02014B50u) {
    raise<io_error>(403, name_, ": no zip directory entry at byte ", position);
  }
  const auto flags = at<std::uint16_t>(position + 8, what), method = at<std::uint16_t>(position + 10, what);
  const auto name_size = at<std::uint16_t>(position + 28, what), extra_size = at<std::uint16_t>(position + 30, what);
  const auto comment_size = at<std::uint16_t>(position + 32, what);
  ZipEntry e;
  e.name = detail::as_text(detail::slice(bytes_, position + 46, name_size, name_, what));
  e.crc = at<std::uint32_t>(position + 16, what);
  e.packed = at<std::uint32_t>(position + 20, what);
  e.size = at<std::uint32_t>(position + 24, what);
  e.deflated = method == 8;
  std::uint64_t header = at<std::uint32_t>(position + 42, what);
  read_zip64(position + 46 + name_size, extra_size, e, header);

  const auto refuse = [&](int id, const auto&... why) {
    raise<io_error>(id, name_, ": zip directory entry at byte ", position, ": member '", e.name, "' ", why...);
  };
  if ((flags & 1u) != 0) refuse(404, "is encrypted");
  if (method != 0 && method != 8) refuse(404, "has method ", method);
  if (!e.deflated && e.packed != e.size) refuse(403, "is stored and has ", e.packed, " and ", counted(e.size, "byte"));
  constexpr std::uint64_t highest_ratio = 1032;  // of deflate: 258 bytes from two bits
  if (e.deflated && e.size / highest_ratio > e.packed)
    refuse(405, "of ", counted(e.size, "byte"), " cannot come from ", e.packed);
  if (leads_out(e.name)) refuse(403, "leads out of the archive");
  if (at<std::uint32_t>(header, "zip member") != 0x04034B50u) {
    raise<io_error>(403, name_, ": no member '", e.name, "' at byte ", header);
  }
  e.offset = header + 30 + at<std::uint16_t>(header + 26, "zip member") + at<std::uint16_t>(header + 28, "zip member");
  detail::slice(bytes_, e.offset, e.packed, name_, e.name);
  entries_.push_back(std::move(e));
  return position + 46 + name_size + extra_size + comment_size;
}

MOTIONLANG_BODY void ZipArchive::read_zip64(std::uint64_t position, std::uint64_t length, ZipEntry& e,
                                            std::uint64_t& header) const {
  const std::uint64_t end = position + length;
  while (position + 4 <= end) {
    const auto id = at<std::uint16_t>(position, "extra field"), size = at<std::uint16_t>(position + 2, "extra field");
    position += 4;
    if (id == 1) {
      std::uint64_t value = position;
      for (std::uint64_t* number : {&e.size, &e.packed, &header}) {
        if (*number != 0xFFFFFFFFu) continue;
        *number = at<std::uint64_t>(value, "ZIP64 extra field");
        value += 8;
      }
    }
    position += size;
  }
}

MOTIONLANG_BODY bool ZipArchive::leads_out(const std::string& member) {
  return member.empty() || member.front() == '/' || ("/" + member + "/").find("/../") != std::string::npos ||
         member.find_first_of(std::string_view("\0\\", 2)) != std::string::npos;
}

MOTIONLANG_BODY void ZipArchive::check_ranges() const {
  std::unordered_set<std::string_view> names;
  std::vector<const ZipEntry*> sorted;
  for (const ZipEntry& e : entries_) {
    if (!names.insert(e.name).second)
      raise<io_error>(403, name_, ": two members are called '", e.name, "', one of them at byte ", e.offset);
    sorted.push_back(&e);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return a->offset < b->offset; });
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i - 1]->offset + sorted[i - 1]->packed > sorted[i]->offset) {
      raise<io_error>(403, name_, ": members '", sorted[i - 1]->name, "' and '", sorted[i]->name, "' overlap at byte ",
                      sorted[i]->offset);
    }
  }
}

MOTIONLANG_BODY void ZipWriter::add(std::string_view name, std::span<const std::byte> data) {
  if (data.size() + bytes_.size() > 0xFFFF0000u || name.size() > 0xFFFFu || count_ == 0xFFFFu) {
    raise<io_error>(405, "zip: member '", name, "' of ", counted(data.size(), "byte"),
                    " is too much for a zip without ZIP64");
  }
  std::vector<std::byte> common;                               // what the local header and the directory have in common
  append_numbers<std::uint16_t>(common, {20, 0, 0, 0, 0x21});  // version, flags, stored, 0:00 of 1980-01-01
  append_numbers<std::uint32_t>(
      common, {detail::crc32(data), static_cast<std::uint32_t>(data.size()), static_cast<std::uint32_t>(data.size())});
  append_numbers<std::uint16_t>(common, {static_cast<std::uint16_t>(name.size()), 0});

  append_numbers<std::uint32_t>(directory_, {0x02014B50u});
  append_numbers<std::uint16_t>(directory_, {20});
  detail::append_bytes(directory_, common);
  append_numbers<std::uint16_t>(directory_, {0, 0, 0, 0, 0});
  append_numbers<std::uint32_t>(directory_, {static_cast<std::uint32_t>(bytes_.size())});
  detail::append_text(directory_, name);

  append_numbers<std::uint32_t>(bytes_, {0x04034B50u});
  detail::append_bytes(bytes_, common);
  detail::append_text(bytes_, name);
  detail::append_bytes(bytes_, data);
  ++count_;
}

MOTIONLANG_BODY std::vector<std::byte> ZipWriter::finish() {
  const auto start = static_cast<std::uint32_t>(bytes_.size());
  detail::append_bytes(bytes_, directory_);
  append_numbers<std::uint32_t>(bytes_, {0x06054B50u});
  append_numbers<std::uint16_t>(bytes_, {0, 0, count_, count_});
  append_numbers<std::uint32_t>(bytes_, {static_cast<std::uint32_t>(directory_.size()), start});
  append_numbers<std::uint16_t>(bytes_, {0});
  return std::exchange(*this, ZipWriter()).bytes_;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// An archive that is being read. Arrays are read when they are asked for: members that we cannot read (objects) do not
/// disturb the others.
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

#ifndef MOTIONLANG_HAS_FILE_NPZ_IPP  // <motionlang/file/npz.ipp>
#define MOTIONLANG_HAS_FILE_NPZ_IPP
// Bodies of npz.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> NpzArchive::names() const {
  std::vector<std::string> out;
  for (const ZipEntry& e : zip_.entries()) {
    if (e.name.ends_with(suffix)) out.push_back(e.name.substr(0, e.name.size() - suffix.size()));
  }
  return out;
}

MOTIONLANG_BODY bool NpzArchive::has(std::string_view name) const {
  return zip_.find(concat_text(name, suffix)) != nullptr;
}

MOTIONLANG_BODY NpyArray NpzArchive::read(std::string_view name) const {
  const ZipEntry* entry = zip_.find(concat_text(name, suffix));
  if (entry == nullptr) raise<io_error>(406, zip_.name(), ": no array '", name, "' in the archive");
  const std::string where = concat_text(zip_.name(), "/", name);
  constexpr std::uint64_t large = 1 << 20;  // then it is not unpacked before its header is known to want so much
  if (entry->deflated && entry->size > large)
    detail::check_npy_size(zip_.head(*entry, detail::longest_npy_header + 12), entry->size, where);
  return parse_npy(zip_.read(*entry), where);
}

MOTIONLANG_BODY std::vector<std::byte> npz_bytes(std::span<const NamedArray> arrays) {
  ZipWriter zip;
  for (const NamedArray& a : arrays) zip.add(a.name + ".npy", npy_bytes(a.array));
  return zip.finish();
}

MOTIONLANG_BODY void write_npz(const FilePath& path, std::span<const NamedArray> arrays) {
  write_file(path, npz_bytes(arrays));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_OPTIONS_FILE_HPP  // <motionlang/file/options_file.hpp>
#define MOTIONLANG_HAS_FILE_OPTIONS_FILE_HPP
/// Options of a training run, flat: config.json, args.json (JSON), opt.yaml, config.yaml (YAML), opt.txt.
///
///     const auto options = read_options("run/opt.yaml");
///     const FileValue* width = find_value(options, "model/latent_dim");
///
/// Of YAML the part that programs write: nested mappings and lists by indentation, plain and quoted texts, numbers,
/// flat lists and mappings in brackets, tags (which are ignored). No texts of several lines, no anchors.
/// opt.txt is what text-to-motion, TM2T and MotionDiffuse write: a banner of dashes, lines of "key: value", a banner.
/// A whole number of more than 64 bits is a text, its digits. A name that appears twice is refused.
/// OmegaConf's references "${model.latent_dim}" are texts; `find_option` follows them.

MOTIONLANG_NAMESPACE_BEGIN

/// The values of a text, JSON if it begins with a brace, an opt.txt if with a banner. `name` stands in messages.
/// Throws  io_error 403 with the line if it is malformed, 404 for YAML that is not read, 405 if it is too large
std::vector<FileValue> parse_options(std::string_view text, std::string_view name);
/// Throws io_error 401, and as above.
std::vector<FileValue> read_options(const FilePath& path);

/// The value at a path; if that is a reference "${a.b}", the value at "a/b", and so on. Null if there is none.
const FileValue* find_option(const std::vector<FileValue>& values, std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_OPTIONS_FILE_IPP  // <motionlang/file/options_file.ipp>
#define MOTIONLANG_HAS_FILE_OPTIONS_FILE_IPP
// Bodies of options_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string below(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : concat_text(path, "/", key);
}

/// Values as they are found. A text of options is small: a large one, or one whose paths or values take much memory, is
/// refused.
class OptionValues {
 public:
  OptionValues(std::string_view text, std::string_view file) : file_(file) {
    if (text.size() > most_text)
      raise<io_error>(405, file_, ": ", counted(text.size(), "byte"), " of options, at most ", most_text);
  }
  template <class T>
  void add(const std::string& path, T value) {
    spend(path);
    values_.push_back({path, std::move(value)});
  }
  /// Throws io_error 403 if the key at the end of the path stood in a line before.
  void add_key(const std::string& path, std::size_t line) {
    spend(path);
    const auto [first, is_new] = lines_.emplace(path, line);
    if (!is_new) raise<io_error>(403, file_, ":", line, ": '", path, "' appears twice, first in line ", first->second);
  }
  /// A plain or quoted text as what it means; nothing if it means that there is no value.
  void add_text(const std::string& path, std::string_view text);
  /// More of the text that came last. Whether it was a text.
  bool append_to_last(std::string_view text);

  bool empty() const { return values_.empty(); }
  std::vector<FileValue> take() { return std::move(values_); }

 private:
  static constexpr std::size_t most_text = std::size_t{1} << 20;
  void spend(const std::string& path) {
    const std::size_t cost = 3 * sizeof(FileValue) + path.size();
    if (cost > left_) raise<io_error>(405, file_, ": more options than a file of options has");
    left_ -= cost;
  }
  std::string_view file_;
  std::map<std::string, std::size_t> lines_;  // of keys
  std::vector<FileValue> values_;
  std::size_t left_ = std::size_t{24} << 20;  // bytes
};

inline bool is_quoted(std::string_view text) {
  return text.size() >= 2 && text.front() == text.back() && (text.front() == '"' || text.front() == '\'');
}

/// What stands between the quotes: '' is one quote in the single kind, a backslash takes the next character in the
/// double kind.
inline std::string unquoted(std::string_view text) {
  const char quote = text.front();
  text = text.substr(1, text.size() - 2);
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == (quote == '"' ? '\\' : '\'') && i + 1 < text.size();
    if (!escape) {
      out += text[i];
      continue;
    }
    const char c = text[++i];
    out += quote == '"' && c == 'n' ? '\n' : quote == '"' && c == 't' ? '\t' : c;
  }
  return out;
}

inline void OptionValues::add_text(const std::string& path, std::string_view text) {
  if (text == "null" || text == "~" || text == "{}") return;
  if (text == "true" || text == "false") return add(path, text == "true");
  const char* const end = text.data() + text.size();
  const auto all_of_it = [&](const std::from_chars_result& r) { return r.ec == std::errc{} && r.ptr == end; };
  std::int64_t integer = 0;
  const auto whole = detail::from_chars(text.data(), end, integer);
  if (!text.empty() && all_of_it(whole)) return add(path, integer);
  if (whole.ec == std::errc::result_out_of_range && whole.ptr == end) return add(path, std::string(text));
  double real = 0;
  const bool number = !text.empty() && text.find_first_not_of("0123456789+-.eE") == text.npos;
  if (number && all_of_it(detail::from_chars(text.data(), end, real))) return add(path, real);
  add(path, is_quoted(text) ? unquoted(text) : std::string(text));
}

inline bool OptionValues::append_to_last(std::string_view text) {
  std::string* last = values_.empty() ? nullptr : std::get_if<std::string>(&values_.back().value);
  if (last == nullptr) return false;
  last->append(" ").append(text);
  if (is_quoted(*last)) *last = unquoted(*last);
  return true;
}

class YamlReader {
 public:
  YamlReader(std::string_view text, std::string_view file) : values(text, file), file_(file) {
    levels_.push_back({0, "", false, 0});
    while (!text.empty()) {
      ++line_;
      const std::size_t end = std::min(text.find('\n'), text.size());
      read_line(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }
  OptionValues values;

 private:
  static constexpr std::size_t deepest = 64;
  struct Level {
    std::size_t indent;
    std::string path;
    bool list;
    std::size_t items;
  };
  struct Folded {  // a text that may go on in the next line: programs fold long ones
    std::size_t indent;
    char quote;  // in which it is still; else 0
  };
  struct Pending {  // a key whose value follows on the next lines
    std::size_t indent;
    std::string path;
  };

  [[noreturn]] void fail(int id, std::string_view what) const { raise<io_error>(id, file_, ":", line_, ": ", what); }

  static bool is_quote(char c) { return c == '"' || c == '\''; }
  static std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \r"), last = text.find_last_not_of(" \r");
    return first == text.npos ? std::string_view() : text.substr(first, last - first + 1);
  }
  /// Position behind the quote that ends a quoted text, of which `at` is inside; the size of the text if there is none.
  static std::size_t quote_end(std::string_view text, char quote, std::size_t at) {
    for (; at < text.size(); ++at) {
      const bool twice = text.substr(at).starts_with("''");
      if (quote == '"' ? text[at] == '\\' : twice)
        ++at;
      else if (text[at] == quote)
        return at + 1;
    }
    return text.size();
  }
  /// open   the quote of a text that began in a line before and goes on; else 0
  static std::string_view without_comment(std::string_view line, char open) {
    for (std::size_t i = open == 0 ? 0 : quote_end(line, open, 0); i < line.size();) {
      const bool begins = i == 0 || std::string_view(" [,{").find(line[i - 1]) != std::string_view::npos;
      if (line[i] == '#' && (i == 0 || line[i - 1] == ' ')) return line.substr(0, i);
      i = begins && is_quote(line[i]) ? quote_end(line, line[i], i + 1) : i + 1;
    }
    return line;
  }

  void read_line(std::string_view line) {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const bool goes_on = folded_ && indent > folded_->indent;
    const std::string_view text = trimmed(without_comment(line, goes_on ? folded_->quote : '\0'));
    if (text.empty() || text == "---" || text == "...") return;
    if (text[0] == '\t') fail(403, "a tab as indentation");
    if (goes_on && (folded_->quote != 0 || key_end(text) == text.npos) && values.append_to_last(text)) {
      if (folded_->quote != 0 && text.back() == folded_->quote) folded_.reset();
      return;
    }
    folded_.reset();
    const bool item = is_item(text);
    if (pending_) {
      const bool inside = indent > pending_->indent || (item && indent == pending_->indent);
      if (inside) levels_.push_back({indent, pending_->path, item, 0});
      pending_.reset();
      if (levels_.size() > deepest) fail(405, "nested too deeply");
    }
    while (levels_.size() > 1 &&
           (levels_.back().indent > indent || (levels_.back().indent == indent && levels_.back().list && !item))) {
      levels_.pop_back();
    }
    if (levels_.size() == 1 && item && values.empty()) levels_.back().list = true;
    if (levels_.back().indent != indent || levels_.back().list != item)
      fail(403, "indentation that fits no line above");
    item ? read_item(text, indent) : read_key(text, indent);
  }
  static bool is_item(std::string_view text) { return text == "-" || text.starts_with("- "); }

  void read_item(std::string_view text, std::size_t indent) {
    Level& list = levels_.back();
    const std::string path = below(list.path, concat_text(list.items++));
    const std::string_view rest = trimmed(text.substr(1));
    const std::size_t inner = indent + static_cast<std::size_t>(rest.data() - text.data());
    if (rest.empty()) {
      pending_ = Pending{indent, path};
    } else if (is_item(rest) || key_end(rest) != rest.npos) {
      levels_.push_back({inner, path, is_item(rest), 0});
      if (levels_.size() > deepest) fail(405, "nested too deeply");
      is_item(rest) ? read_item(rest, inner) : read_key(rest, inner);
    } else {
      read_value(path, rest, indent);
    }
  }
  /// Position of the colon behind a key.
  static std::size_t key_end(std::string_view text) {
    if (text.empty() || text[0] == '[' || text[0] == '{') return text.npos;
    const std::size_t from = is_quote(text[0]) ? quote_end(text, text[0], 1) : 0;
    for (std::size_t at = text.find(':', from); at != text.npos; at = text.find(':', at + 1)) {
      if (at + 1 == text.size() || text[at + 1] == ' ') return at;
    }
    return text.npos;
  }
  /// The path of the key before a colon, in a mapping at `path`.
  std::string key_path(const std::string& path, std::string_view text) {
    text = trimmed(text);
    std::string out = below(path, is_quoted(text) ? unquoted(text) : std::string(text));
    values.add_key(out, line_);
    return out;
  }
  void read_key(std::string_view text, std::size_t indent) {
    const std::size_t colon = key_end(text);
    if (colon == text.npos) fail(403, "a key with a colon expected");
    read_value(key_path(levels_.back().path, text.substr(0, colon)), trimmed(text.substr(colon + 1)), indent);
  }

  void read_value(const std::string& path, std::string_view text, std::size_t indent) {
    if (text.starts_with('!') || text.starts_with('&'))
      text = trimmed(text.substr(std::min(text.find(' '), text.size())));
    if (text.empty()) {
      pending_ = Pending{indent, path};
    } else if (text[0] == '|' || text[0] == '>' || text[0] == '*') {
      fail(404, "texts of several lines and references are not read");
    } else if ((text[0] == '[' && text.back() == ']') || (text[0] == '{' && text.back() == '}')) {
      read_brackets(path, text);
    } else {
      values.add_text(path, text);
      const bool open = is_quote(text[0]) && quote_end(text, text[0], 1) == text.size() && text.back() != text[0];
      if (text[0] != '[' && text[0] != '{') folded_ = Folded{indent, open ? text[0] : '\0'};
    }
  }
  /// A list or a mapping in one line.
  void read_brackets(const std::string& path, std::string_view text) {
    const bool mapping = text[0] == '{';
    text = text.substr(1, text.size() - 2);
    for (std::size_t i = 0; !trimmed(text).empty(); ++i) {
      const std::size_t comma = comma_outside_quotes(text);
      std::string_view element = trimmed(text.substr(0, comma));
      std::string place;
      if (mapping) {
        const std::size_t colon = key_end(element);
        if (colon == element.npos) fail(403, "a key with a colon expected in the braces");
        place = key_path(path, element.substr(0, colon));
        element = trimmed(element.substr(colon + 1));
      } else {
        place = below(path, concat_text(i));
      }
      if (element.starts_with('[') || element.starts_with('{')) fail(404, "brackets in brackets are not read");
      if (!mapping || !element.empty()) values.add_text(place, element);
      text.remove_prefix(std::min(comma + 1, text.size()));
    }
  }
  static std::size_t comma_outside_quotes(std::string_view text) {
    char before = ':';  // no blank
    for (std::size_t i = 0; i < text.size();) {
      if (text[i] == ',') return i;
      const std::size_t next = before == ':' && is_quote(text[i]) ? quote_end(text, text[i], i + 1) : i + 1;
      if (text[i] != ' ') before = text[i];
      i = next;
    }
    return text.size();
  }

  std::string_view file_;
  std::size_t line_ = 0;
  std::vector<Level> levels_;
  std::optional<Pending> pending_;
  std::optional<Folded> folded_;
};

/// A file begins so if it is an opt.txt; of YAML a line of three dashes is part.
inline constexpr std::string_view option_banner = "----";

/// "key: value" on each line; True and False are truth values.
inline std::vector<FileValue> parse_option_lines(std::string_view text, std::string_view name) {
  OptionValues out(text, name);
  for_each_line(text, [&](std::string_view line, Index number) {
    const std::size_t last = line.find_last_not_of(" \t");
    line = line.substr(0, last + 1);  // npos + 1 = 0
    if (line.empty() || line.starts_with(option_banner)) return;
    const std::size_t colon = line.find(':');
    if (colon == line.npos || colon == 0) raise<io_error>(403, name, ":", number, ": 'key: value' expected");
    const std::string key(line.substr(0, colon));
    out.add_key(key, static_cast<std::size_t>(number));
    line.remove_prefix(std::min(line.find_first_not_of(' ', colon + 1), line.size()));
    if (line == "True" || line == "False")
      out.add(key, line == "True");
    else
      out.add_text(key, line);
  });
  return out.take();
}

inline void add_json_values(const nlohmann::json& value, const std::string& path, OptionValues& out) {
  if (value.is_boolean()) out.add(path, value.get<bool>());
  if (value.is_number_integer()) out.add_text(path, value.dump());
  if (value.is_number_float()) out.add(path, value.get<double>());
  if (value.is_string()) out.add(path, value.get<std::string>());
  if (!value.is_structured()) return;
  for (const auto& member : value.items()) add_json_values(member.value(), below(path, member.key()), out);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<FileValue> parse_options(std::string_view text, std::string_view name) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != text.npos && text.substr(first).starts_with(detail::option_banner))
    return detail::parse_option_lines(text, name);
  if (first == text.npos || text[first] != '{') return detail::YamlReader(text, name).values.take();
  detail::OptionValues out(text, name);
  detail::add_json_values(parse_json(text, name), "", out);
  return out.take();
}

MOTIONLANG_BODY std::vector<FileValue> read_options(const FilePath& path) {
  return parse_options(read_file(path), path.string());
}

MOTIONLANG_BODY const FileValue* find_option(const std::vector<FileValue>& values, std::string_view path) {
  const FileValue* found = find_value(values, path);
  for (int step = 0; found != nullptr && step < 8; ++step) {
    const std::string* text = std::get_if<std::string>(&found->value);
    if (text == nullptr || !text->starts_with("${") || !text->ends_with('}')) return found;
    std::string target = text->substr(2, text->size() - 3);
    std::replace(target.begin(), target.end(), '.', '/');
    found = find_value(values, target);
  }
  return nullptr;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_PICKLE_HPP  // <motionlang/file/pickle.hpp>
#define MOTIONLANG_HAS_FILE_PICKLE_HPP
/// Python pickles, protocols 0 to 5, read without executing anything.
///
/// A pickle is a program that builds objects. This reader runs the part that builds plain values (numbers, texts,
/// lists, dictionaries) and turns every class and every call into an inert `object` that remembers what the file asked
/// for: name, arguments, state, items. What such an object means is the business of the caller, who looks at the names
/// that it knows: file/pickle_arrays.hpp does so for NumPy, SciPy and chumpy; tensors of PyTorch come as objects whose
/// storages are `persistent`.
///
///     Pickle file = Pickle::open("model.pkl");
///     NpyArray weights = to_array(file.root()["weights"]);
///
/// Refused are names that only a program that attacks its reader needs (os.system, eval), and whatever is malformed.
/// Memory is bounded by the size of the file: lengths are checked before anything is allocated, texts and bytes are
/// views into the file.
///
/// Source  CPython Lib/pickle.py and pickletools.py; spec weights.md, section 5

#ifndef MOTIONLANG_HAS_FILE_DETAIL_PICKLE_NODE_HPP  // <motionlang/file/detail/pickle_node.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_PICKLE_NODE_HPP
/// The values of a pickle as its stack machine makes them.

MOTIONLANG_NAMESPACE_BEGIN

enum class PickleKind : std::uint8_t {
  none,
  boolean,
  integer,
  real,
  text,   // also whole numbers of more than 64 bits in protocol 0: their digits
  bytes,  // also the texts of Python 2, and such numbers in other protocols: little-endian
  list,   // also sets
  tuple,
  dict,
  name,        // of a class or a function
  object,      // what calling one would have made
  persistent,  // something outside the pickle, known by an id
};
inline std::string_view name_of(PickleKind k) {
  constexpr std::string_view names[] = {"None",         "a truth value", "a whole number", "a real number",
                                        "a text",       "bytes",         "a list",         "a tuple",
                                        "a dictionary", "a name",        "an object",      "a persistent id"};
  return names[static_cast<std::size_t>(k)];
}
inline std::string to_string(PickleKind k) { return std::string(name_of(k)); }

class PickleValue;

/// Bytes in the file that belong to an object but not to the pickle.
struct InlineBytes {
  std::uint64_t begin = 0, size = 0;  // begin 0: there are none
};

struct PickleOptions {
  /// Names that may occur, "collections.OrderedDict" or, ending with a dot, everything below a module: "numpy.". Empty:
  /// all but those that execute something; classes that nobody knows are inert objects.
  std::span<const std::string_view> allowed{};
  bool persistent_ids = false;         // PyTorch's storages
  std::size_t max_values = 4'000'000;  // values and links between them; never more than the bytes of the file allow
  std::uint64_t max_memory = 0;        // bytes for them; 0: 24 MiB and as much as the file has
  /// Called with every object that has got its state: what follows it at `position` (joblib's arrays). Reading goes on
  /// behind.
  InlineBytes (*inline_bytes)(const PickleValue& object, std::span<const std::byte> file,
                              std::uint64_t position) = nullptr;
};

namespace detail {

using PickleRef = std::uint32_t;
inline constexpr PickleRef no_pickle_value = UINT32_MAX;

struct PickleNode {
  PickleKind kind = PickleKind::none;
  bool keyed = false;  // items are keys and values in turn
  PickleRef callee = no_pickle_value, arguments = no_pickle_value, state = no_pickle_value;
  std::uint64_t at = 0;
  std::int64_t integer = 0;
  double real = 0;
  std::string_view text, attribute;  // of a name: module and attribute; of an object: the bytes that follow it
  std::vector<PickleRef> items;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

class Pickle;

namespace detail {
class PickleMachine;
}

/// A value in a pickle: a handle, valid as long as its Pickle lives. Graphs may share values and may be cyclic: whoever
/// descends into one limits the depth.
class PickleValue {
 public:
  PickleKind kind() const { return node().kind; }
  bool is(PickleKind k) const { return kind() == k; }
  /// The same for handles of the same value.
  std::uint32_t id() const { return ref_; }
  /// Offset of the byte that made it.
  std::uint64_t at() const { return node().at; }
  const std::string& file() const;

  /// Values of these kinds. A whole number also reads as a real one, a truth value as 0 or 1. Throws io_error 407.
  std::int64_t integer() const;
  bool boolean() const;
  double real() const { return is(PickleKind::real) ? node().real : static_cast<double>(integer()); }
  /// UTF-8; of a Python-2 string the bytes as they are, which is Latin-1. Throws io_error 407.
  std::string_view text() const;
  std::span<const std::byte> bytes() const;

  /// Number of elements of a list, a tuple or a set, or of entries of a dictionary; of objects, what was appended or
  /// set.
  std::size_t size() const { return node().items.size() / (node().keyed ? 2 : 1); }
  /// Whether the elements are entries: of dictionaries, and of objects that behave like one.
  bool keyed() const { return node().keyed; }
  /// Element of a sequence. Throws io_error 407 if there is no such element.
  PickleValue operator[](std::size_t i) const;
  /// Key and value of entry i < size() of a dictionary. Throws io_error 407 if it is none.
  PickleValue key(std::size_t i) const { return entry(2 * i); }
  PickleValue value(std::size_t i) const { return entry(2 * i + 1); }
  /// The entry of a dictionary with this text as its key; of several the last, as in Python.
  std::optional<PickleValue> find(std::string_view name) const;
  /// Throws io_error 406 if there is none.
  PickleValue operator[](std::string_view name) const;

  /// "module.attribute" of a name, and of the class or function that made an object; "" for all others.
  std::string name() const;
  /// Of an object: what its class or function was called with. Of a persistent value: its id.
  PickleValue arguments() const { return related(node().arguments, "arguments"); }
  /// Of an object: what it was asked to restore itself from.
  PickleValue state() const { return related(node().state, "a state"); }
  bool has_state() const { return node().state != detail::no_pickle_value; }
  /// Of an object: the bytes behind it that are not part of the pickle (PickleOptions::inline_bytes).
  std::span<const std::byte> inline_bytes() const;

  /// For the readers of objects: io_error `id` with the file, what is wrong, and where.
  template <class... T>
  [[noreturn]] void fail(int id, const T&... what) const {
    fail_with(id, concat_text(what...));
  }

 private:
  friend class Pickle;
  friend class detail::PickleMachine;
  PickleValue(const detail::PickleMachine& machine, detail::PickleRef ref) : machine_(&machine), ref_(ref) {}
  const detail::PickleNode& node() const;
  [[noreturn]] void fail_with(int id, const std::string& what) const;
  [[noreturn]] void wrong(const char* expected) const;
  PickleValue entry(std::size_t i) const;
  PickleValue related(detail::PickleRef ref, const char* what) const;

  const detail::PickleMachine* machine_;
  detail::PickleRef ref_;
};

/// A pickle that has been read.
class Pickle {
 public:
  /// file    for messages
  /// owner   keeps `bytes` alive
  /// start   of the pickle in the bytes: several may follow each other
  /// Throws  io_error 402 if it ends too early, 403 if it is malformed, 404 if it names what must not be executed, what
  ///         `options` do not allow, or an extension, 405 beyond the limits
  Pickle(std::span<const std::byte> bytes, std::string file, const PickleOptions& options = {},
         std::shared_ptr<const void> owner = nullptr, std::uint64_t start = 0);
  /// Throws io_error 401, and as above.
  static Pickle open(const FilePath& path, const PickleOptions& options = {});

  Pickle(Pickle&&) noexcept;
  Pickle& operator=(Pickle&&) noexcept;
  ~Pickle();

  PickleValue root() const { return {*machine_, root_}; }
  /// The values that stand for something outside of the pickle, in the order of the file.
  std::vector<PickleValue> persistent() const;
  /// Of the bytes that it was allowed.
  std::uint64_t memory_left() const;
  /// Offset behind the pickle.
  std::uint64_t end() const;

 private:
  std::unique_ptr<detail::PickleMachine> machine_;  // values point to it
  std::shared_ptr<const void> owner_;
  detail::PickleRef root_ = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_PICKLE_IPP  // <motionlang/file/pickle.ipp>
#define MOTIONLANG_HAS_FILE_PICKLE_IPP
// Bodies of pickle.hpp.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_PICKLE_MACHINE_HPP  // <motionlang/file/detail/pickle_machine.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_PICKLE_MACHINE_HPP
/// The stack machine of a pickle: opcodes in, a graph of inert values out. Nothing is called or imported.

#include <deque>          // unescaped texts: views to them stay valid

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

// clang-format off
/// Of an opcode, as pickletools calls it; empty if there is none.
inline std::string_view opcode_name(unsigned char opcode) {
  constexpr std::pair<unsigned char, std::string_view> names[] = {
      {'(', "MARK"}, {')', "EMPTY_TUPLE"}, {'.', "STOP"}, {'0', "POP"}, {'1', "POP_MARK"}, {'2', "DUP"}, {'B', "BINBYTES"},
      {'C', "SHORT_BINBYTES"}, {'F', "FLOAT"}, {'G', "BINFLOAT"}, {'I', "INT"}, {'J', "BININT"}, {'K', "BININT1"}, {'L', "LONG"},
      {'M', "BININT2"}, {'N', "NONE"}, {'P', "PERSID"}, {'Q', "BINPERSID"}, {'R', "REDUCE"}, {'S', "STRING"}, {'T', "BINSTRING"},
      {'U', "SHORT_BINSTRING"}, {'V', "UNICODE"}, {'X', "BINUNICODE"}, {']', "EMPTY_LIST"}, {'a', "APPEND"}, {'b', "BUILD"},
      {'c', "GLOBAL"}, {'d', "DICT"}, {'e', "APPENDS"}, {'g', "GET"}, {'h', "BINGET"}, {'i', "INST"}, {'j', "LONG_BINGET"},
      {'l', "LIST"}, {'o', "OBJ"}, {'p', "PUT"}, {'q', "BINPUT"}, {'r', "LONG_BINPUT"}, {'s', "SETITEM"}, {'t', "TUPLE"},
      {'u', "SETITEMS"}, {'}', "EMPTY_DICT"}, {0x80, "PROTO"}, {0x81, "NEWOBJ"}, {0x82, "EXT1"}, {0x83, "EXT2"}, {0x84, "EXT4"},
      {0x85, "TUPLE1"}, {0x86, "TUPLE2"}, {0x87, "TUPLE3"}, {0x88, "NEWTRUE"}, {0x89, "NEWFALSE"}, {0x8A, "LONG1"}, {0x8B, "LONG4"},
      {0x8C, "SHORT_BINUNICODE"}, {0x8D, "BINUNICODE8"}, {0x8E, "BINBYTES8"}, {0x8F, "EMPTY_SET"}, {0x90, "ADDITEMS"},
      {0x91, "FROZENSET"}, {0x92, "NEWOBJ_EX"}, {0x93, "STACK_GLOBAL"}, {0x94, "MEMOIZE"}, {0x95, "FRAME"}, {0x96, "BYTEARRAY8"},
      {0x97, "NEXT_BUFFER"}, {0x98, "READONLY_BUFFER"}};
  for (const auto& [code, name] : names) {
    if (code == opcode) return name;
  }
  return "";
}
// clang-format on

class PickleMachine {
 public:
  PickleMachine(std::span<const std::byte> bytes, std::string file, const PickleOptions& options)
      : bytes_(bytes), file_(std::move(file)), options_(options) {
    budget_ = std::min<std::uint64_t>(options_.max_values, 16 + 2 * std::uint64_t{bytes.size()});
    memory_ = options_.max_memory != 0 ? options_.max_memory : (std::uint64_t{24} << 20) + bytes.size();
  }

  const std::string& file() const { return file_; }
  const PickleNode& node(PickleRef ref) const { return nodes_[ref]; }
  std::uint64_t position() const { return position_; }
  std::uint64_t memory_left() const { return memory_; }
  /// Values that stand for something outside of the pickle, in the order of the file.
  const std::vector<PickleRef>& persistent() const { return persistent_; }
  /// For messages: " at byte 7 (BINGET)".
  std::string place(std::uint64_t at) const {
    const auto name =
        at < bytes_.size() ? opcode_name(std::to_integer<unsigned char>(bytes_[static_cast<std::size_t>(at)])) : "";
    return name.empty() ? concat_text(" at byte ", at) : concat_text(" at byte ", at, " (", name, ")");
  }

  /// Reads from `start` to STOP and gives the value that is left.
  PickleRef run(std::uint64_t start) {
    position_ = start;
    for (;;) {
      opcode_at_ = position_;
      const auto opcode = static_cast<unsigned char>(number<std::uint8_t>("opcode"));
      if (opcode == '.') return pop();
      execute(opcode);
    }
  }

 private:
  static constexpr std::size_t max_stack = 1'000'000, max_marks = 100'000, max_line = 65536, max_digits = 1024;

  template <class... T>
  [[noreturn]] void fail(int id, const T&... what) const {
    raise<io_error>(id, file_, ": pickle: ", what..., place(opcode_at_));
  }

  // The file.

  std::uint64_t left() const { return bytes_.size() - std::min<std::uint64_t>(position_, bytes_.size()); }
  template <class T>
  T number(std::string_view what) {
    if (left() < sizeof(T)) fail(402, "ends inside ", what);
    const T value = load<T>(bytes_, position_, file_, what);
    position_ += sizeof(T);
    return value;
  }
  std::string_view take(std::uint64_t size, std::string_view what) {
    if (left() < size) fail(402, what, " of ", counted(size, "byte"), " where ", left(), " are left");
    const auto part = slice(bytes_, position_, size, file_, what);
    position_ += size;
    return as_text(part);
  }
  /// Up to the end of the line, which is skipped.
  std::string_view line(std::size_t longest) {
    const std::string_view rest = as_text(bytes_.subspan(static_cast<std::size_t>(position_)));
    const std::size_t end = rest.substr(0, longest).find('\n');
    if (end == std::string_view::npos) {
      fail(rest.size() > longest ? 405 : 402, "a line without end");
    }
    position_ += end + 1;
    const std::string_view text = rest.substr(0, end);
    return text.ends_with('\r') ? text.substr(0, end - 1) : text;
  }
  std::string_view keep(std::string text) {
    spend(sizeof(std::string) + text.size());
    return owned_.emplace_back(std::move(text));
  }

  // The stack. Marks are positions in it; what lies below the last one is out of reach.

  void charge(std::size_t count) {
    if (count > budget_) fail(405, "more values than a file of ", counted(bytes_.size(), "byte"), " may have");
    budget_ -= count;
    spend(count * 2 * sizeof(PickleRef));
  }
  void spend(std::uint64_t bytes) {
    if (bytes > memory_) fail(405, "more memory than a file of ", counted(bytes_.size(), "byte"), " may need");
    memory_ -= bytes;
  }
  PickleRef add(PickleKind kind) {
    charge(1);
    spend(sizeof(PickleNode));
    nodes_.push_back({});
    nodes_.back().kind = kind;
    nodes_.back().at = opcode_at_;
    return static_cast<PickleRef>(nodes_.size() - 1);
  }
  void push(PickleRef ref) {
    if (stack_.size() >= max_stack) fail(405, "more than ", max_stack, " values on the stack");
    stack_.push_back(ref);
  }
  PickleNode& push_new(PickleKind kind) {
    push(add(kind));
    return nodes_.back();
  }
  std::size_t floor() const { return marks_.empty() ? 0 : marks_.back(); }
  PickleRef top() const {
    if (stack_.size() <= floor()) fail(403, "nothing on the stack");
    return stack_.back();
  }
  PickleRef pop() {
    const PickleRef ref = top();
    stack_.pop_back();
    return ref;
  }
  PickleNode& pop_node(PickleKind kind) {
    PickleNode& n = nodes_[pop()];
    if (n.kind != kind) fail(403, name_of(kind), " expected on the stack, found ", name_of(n.kind));
    return n;
  }
  /// Values above the last mark; the mark goes, too.
  std::vector<PickleRef> pop_marked() {
    if (marks_.empty()) fail(403, "no mark on the stack");
    const auto first = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
    std::vector<PickleRef> items(first, stack_.end());
    stack_.erase(first, stack_.end());
    marks_.pop_back();
    return items;
  }
  std::vector<PickleRef> pop_some(std::size_t count) {
    std::vector<PickleRef> items(count);
    for (std::size_t i = count; i-- > 0;) items[i] = pop();
    return items;
  }

  // Values.

  void push_integer(std::int64_t value) { push_new(PickleKind::integer).integer = value; }
  void push_boolean(bool value) { push_new(PickleKind::boolean).integer = value ? 1 : 0; }
  void push_real(double value) { push_new(PickleKind::real).real = value; }
  void push_text(PickleKind kind, std::string_view text) { push_new(kind).text = text; }
  void push_items(PickleKind kind, std::vector<PickleRef> items) {
    charge(items.size());
    PickleNode& n = push_new(kind);
    n.keyed = kind == PickleKind::dict;
    if (n.keyed && items.size() % 2 != 0) fail(403, "a key without a value");
    n.items = std::move(items);
  }
  void add_items(bool keyed, const std::vector<PickleRef>& items) {
    PickleNode& n = nodes_[top()];
    const bool fits = keyed ? n.kind == PickleKind::dict : n.kind == PickleKind::list;
    const bool object = n.kind == PickleKind::object && (n.items.empty() || n.keyed == keyed);
    if (!fits && !object) fail(403, keyed ? "entries for " : "elements for ", name_of(n.kind));
    if (keyed && items.size() % 2 != 0) fail(403, "a key without a value");
    charge(items.size());
    n.keyed = keyed;
    n.items.insert(n.items.end(), items.begin(), items.end());
  }

  /// Little-endian two's complement of any length.
  void push_long(std::string_view digits) {
    if (digits.size() > 8) return push_text(PickleKind::bytes, digits);
    const bool negative = !digits.empty() && (digits.back() & 0x80) != 0;
    std::uint64_t value = negative ? ~std::uint64_t{0} : 0;
    for (std::size_t i = digits.size(); i-- > 0;) value = value << 8 | static_cast<unsigned char>(digits[i]);
    push_integer(static_cast<std::int64_t>(value));
  }
  template <class T>
  T parse(std::string_view digits, const char* what) {
    T value{};
    const char* const end = digits.data() + digits.size();
    const auto [stop, problem] = detail::from_chars(digits.data(), end, value);
    if (problem != std::errc() || stop != end) fail(403, "not ", what, ": '", digits, "'");
    return value;
  }
  void push_decimal(std::string_view digits) {
    if (digits.ends_with('L')) digits.remove_suffix(1);
    std::int64_t value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, problem] = detail::from_chars(digits.data(), end, value);
    if (problem == std::errc::invalid_argument || stop != end) fail(403, "not a whole number: '", digits, "'");
    if (problem != std::errc()) return push_text(PickleKind::text, digits);
    push_integer(value);
  }
  /// UTF-8, or with surrogates of their own, which Python writes as three bytes each.
  void push_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t start = at;
      if (decode_utf8(text, at) != invalid_code_point) continue;
      if (text[start] != '\xED' || start + 2 >= text.size()) fail(403, "a text that is not UTF-8");
      at = start + 3;
    }
    push_text(PickleKind::text, text);
  }

  static int hexadecimal(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  }
  /// The number of `count` hexadecimal digits from text[at].
  char32_t code(std::string_view text, std::size_t at, std::size_t count) {
    char32_t value = 0;
    for (std::size_t i = at; i < at + count; ++i) {
      const int digit = i < text.size() ? hexadecimal(text[i]) : -1;
      if (digit < 0) fail(403, "a damaged escape in a text");
      value = value << 4 | static_cast<char32_t>(digit);
    }
    return value;
  }
  /// 'text' in quotes, with the escapes of Python's repr.
  std::string unquoted(std::string_view text) {
    const bool quoted =
        text.size() >= 2 && text.front() == text.back() && (text.front() == '\'' || text.front() == '"');
    if (!quoted) fail(403, "a text without quotes");
    text = text.substr(1, text.size() - 2);
    constexpr std::string_view letters = "abfnrtv\\'\"", meanings = "\a\b\f\n\r\t\v\\'\"";
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] != '\\') {
        out += text[i];
        continue;
      }
      const char c = ++i < text.size() ? text[i] : '\0';
      if (const std::size_t k = letters.find(c); k != std::string_view::npos) {
        out += meanings[k];
      } else if (c == 'x') {
        out += static_cast<char>(code(text, i + 1, 2));
        i += 2;
      } else if (c >= '0' && c < '8') {
        unsigned value = 0;
        std::size_t end = i;
        for (; end < text.size() && end < i + 3 && text[end] >= '0' && text[end] < '8'; ++end) {
          value = value * 8 + static_cast<unsigned>(text[end] - '0');
        }
        out += static_cast<char>(value & 255u);
        i = end - 1;
      } else {
        fail(403, "a damaged escape in a text");
      }
    }
    return out;
  }
  /// Latin-1 with \uXXXX and \UXXXXXXXX.
  std::string raw_unicode(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char next = i + 1 < text.size() ? text[i + 1] : '\0';
      char32_t c = static_cast<unsigned char>(text[i]);
      if (c == '\\' && (next == 'u' || next == 'U')) {
        const std::size_t digits = next == 'u' ? 4 : 8;
        c = code(text, i + 2, digits);
        if (c > 0x10FFFF) fail(403, "a damaged escape in a text");
        i += 1 + digits;
      }
      append_utf8(out, c);
    }
    return out;
  }

  // Names and calls.

  static bool executes(std::string_view module, std::string_view attribute) {
    constexpr std::string_view modules[] = {"os",    "posix",     "nt",  "subprocess", "sys",      "socket", "shutil",
                                            "runpy", "importlib", "pty", "ctypes",     "commands", "popen2", "code"};
    constexpr std::string_view builtins[] = {"eval",  "exec",       "execfile",  "compile", "open",
                                             "file",  "__import__", "getattr",   "setattr", "delattr",
                                             "apply", "input",      "breakpoint"};
    const std::string_view package = module.substr(0, module.find('.'));
    if (std::find(std::begin(modules), std::end(modules), package) != std::end(modules)) return true;
    return is_builtin(module) && std::find(std::begin(builtins), std::end(builtins), attribute) != std::end(builtins);
  }
  static bool is_builtin(std::string_view module) { return module == "__builtin__" || module == "builtins"; }
  bool allowed(std::string_view module, std::string_view attribute) const {
    const std::string name = concat_text(module, ".", attribute);
    return options_.allowed.empty() ||
           std::any_of(options_.allowed.begin(), options_.allowed.end(), [&](std::string_view pattern) {
             return pattern.ends_with('.') ? name.starts_with(pattern) : name == pattern;
           });
  }
  void push_name(std::string_view module, std::string_view attribute) {
    if (module.size() > max_line || attribute.size() > max_line) fail(405, "a name of more than ", max_line, " bytes");
    if (executes(module, attribute)) {
      fail(404, "names ", module, ".", attribute, ": the file tries to execute code");
    }
    if (!allowed(module, attribute)) fail(404, "names ", module, ".", attribute, ", which is not allowed here");
    PickleNode& n = push_new(PickleKind::name);
    n.text = module;
    n.attribute = attribute;
  }

  /// One byte for every code point of a text: how Python 3 writes bytes in protocols 0 to 2. Each text is converted
  /// once, however often it is asked for.
  std::string_view latin1(PickleRef ref) {
    const auto [slot, first] = latin1_.try_emplace(ref);
    if (!first) return slot->second;
    spend(sizeof(*slot) + 2 * sizeof(void*));
    const std::string_view text = nodes_[ref].text;
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
      const char32_t c = decode_utf8(text, at);
      if (c > 255) fail(403, "bytes outside Latin-1");
      out += static_cast<char>(static_cast<unsigned char>(c));
    }
    return slot->second = keep(std::move(out));
  }

  /// Result of calling `callee`: a plain value if Python's own types are meant, else an object that remembers the call.
  void call(PickleRef callee, PickleRef arguments) {
    const std::string_view module = nodes_[callee].text, attribute = nodes_[callee].attribute;
    const bool named = nodes_[callee].kind == PickleKind::name;
    const std::vector<PickleRef>& given = nodes_[arguments].items;
    auto is_sequence = [&](PickleRef r) {
      return nodes_[r].kind == PickleKind::list || nodes_[r].kind == PickleKind::tuple;
    };
    if (named && module == "collections" && (attribute == "OrderedDict" || attribute == "defaultdict")) {
      if (attribute == "defaultdict" || given.empty()) return push_items(PickleKind::dict, {});
      if (given.size() == 1 && is_sequence(given[0])) return push_pairs(given[0]);
      fail(403, "arguments of collections.OrderedDict");
    }
    const bool encode = named && module == "_codecs" && attribute == "encode";
    const bool encoded = given.size() == 2 && nodes_[given[0]].kind == PickleKind::text &&
                         (nodes_[given[1]].text == "latin1" || nodes_[given[1]].text == "latin-1");
    if (encode && !encoded) fail(404, "an encoding other than Latin-1");
    if (named && is_builtin(module)) {
      const bool bytes = attribute == "bytes" || attribute == "bytearray";
      if (bytes && encoded) return push_bytes(given[0]);
      if (bytes && given.empty()) return push_text(PickleKind::bytes, {});
      const bool collection =
          attribute == "list" || attribute == "tuple" || attribute == "set" || attribute == "frozenset";
      if (collection && given.empty()) return push_items(PickleKind::list, {});
      if (collection && given.size() == 1 && is_sequence(given[0])) return push(given[0]);
      if (attribute == "bytearray" && given.size() == 1 && nodes_[given[0]].kind == PickleKind::bytes) {
        return push(given[0]);
      }
    }
    if (encode) return push_bytes(given[0]);
    const bool rebuilt = named && (module == "copy_reg" || module == "copyreg") && attribute == "_reconstructor";
    if (rebuilt && given.empty()) fail(403, "arguments of copyreg._reconstructor");
    const PickleRef made_by = rebuilt ? given[0] : callee;  // (class, base, state of the base)
    PickleNode& n = push_new(PickleKind::object);
    n.callee = made_by;
    n.arguments = arguments;
  }
  void push_bytes(PickleRef text) { push_text(PickleKind::bytes, latin1(text)); }
  void push_pairs(PickleRef list) {
    std::vector<PickleRef> items;
    for (const PickleRef pair : nodes_[list].items) {
      const std::vector<PickleRef>& entry = nodes_[pair].items;
      if (entry.size() != 2 || nodes_[pair].keyed) fail(403, "a pair of key and value expected");
      items.insert(items.end(), entry.begin(), entry.end());
    }
    push_items(PickleKind::dict, std::move(items));
  }

  void build() {
    const PickleRef state = pop();
    PickleNode& n = nodes_[top()];
    if (n.kind != PickleKind::object && n.kind != PickleKind::dict && n.kind != PickleKind::list) {
      fail(403, "a state for ", name_of(n.kind));
    }
    n.state = state;
    if (options_.inline_bytes != nullptr && n.kind == PickleKind::object) read_inline(top());
  }
  void read_inline(PickleRef object);  // in file/pickle.ipp: it needs PickleValue

  void put(std::uint64_t index) {
    const auto [slot, first] = memo_.try_emplace(index);
    if (first) spend(sizeof(*slot) + 2 * sizeof(void*));
    slot->second = top();
  }
  void get(std::uint64_t index) {
    const auto found = memo_.find(index);
    if (found == memo_.end()) fail(403, "memo ", index, " was never written");
    push(found->second);
  }
  void push_persistent(PickleRef id) {
    if (!options_.persistent_ids) fail(404, "a persistent id, which means something outside this file");
    const std::vector<PickleRef>& parts = nodes_[id].items;
    // PyTorch's older form refers to the source code of classes
    if (!parts.empty() && nodes_[parts[0]].text == "module")
      fail(404, "a whole module with its source code, not its tensors: save its state_dict()");
    push_new(PickleKind::persistent).arguments = id;
    persistent_.push_back(stack_.back());
  }

  // clang-format off
  void execute(unsigned char opcode) {
    switch (opcode) {
      case 0x80: if (const int v = number<std::uint8_t>("protocol"); v > 5) fail(404, "protocol ", v); return;
      case 0x95: frame(number<std::uint64_t>("frame")); return;
      case '(': if (marks_.size() >= max_marks) fail(405, "too many marks"); marks_.push_back(stack_.size()); return;
      case '0': if (stack_.size() == floor() && !marks_.empty()) marks_.pop_back(); else pop(); return;
      case '1': pop_marked(); return;
      case '2': push(top()); return;

      case 'N': push_new(PickleKind::none); return;
      case 0x88: push_boolean(true); return;
      case 0x89: push_boolean(false); return;
      case 'K': push_integer(number<std::uint8_t>("integer")); return;
      case 'M': push_integer(number<std::uint16_t>("integer")); return;
      case 'J': push_integer(number<std::int32_t>("integer")); return;
      case 'I': {
        const std::string_view digits = line(max_digits);
        if (digits == "00" || digits == "01") return push_boolean(digits == "01");
        return push_decimal(digits);
      }
      case 'L': push_decimal(line(max_digits)); return;
      case 'F': push_real(parse<double>(line(max_digits), "a real number")); return;
      case 'G': push_real(detail::bit_cast<double>(__builtin_bswap64(number<std::uint64_t>("real number")))); return;
      case 0x8A: push_long(take(number<std::uint8_t>("length"), "integer")); return;
      case 0x8B: push_long(take(length(), "integer")); return;

      case 'X': push_utf8(take(number<std::uint32_t>("length"), "text")); return;
      case 0x8C: push_utf8(take(number<std::uint8_t>("length"), "text")); return;
      case 0x8D: push_utf8(take(number<std::uint64_t>("length"), "text")); return;
      case 'V': push_text(PickleKind::text, keep(raw_unicode(line(bytes_.size())))); return;
      case 'U': push_text(PickleKind::bytes, take(number<std::uint8_t>("length"), "text")); return;
      case 'T': push_text(PickleKind::bytes, take(length(), "text")); return;
      case 'S': push_text(PickleKind::bytes, keep(unquoted(line(bytes_.size())))); return;
      case 'C': push_text(PickleKind::bytes, take(number<std::uint8_t>("length"), "bytes")); return;
      case 'B': push_text(PickleKind::bytes, take(number<std::uint32_t>("length"), "bytes")); return;
      case 0x8E: case 0x96: push_text(PickleKind::bytes, take(number<std::uint64_t>("length"), "bytes")); return;

      case ')': push_items(PickleKind::tuple, {}); return;
      case 0x85: push_items(PickleKind::tuple, pop_some(1)); return;
      case 0x86: push_items(PickleKind::tuple, pop_some(2)); return;
      case 0x87: push_items(PickleKind::tuple, pop_some(3)); return;
      case 't': push_items(PickleKind::tuple, pop_marked()); return;
      case ']': case 0x8F: push_items(PickleKind::list, {}); return;
      case 'l': case 0x91: push_items(PickleKind::list, pop_marked()); return;
      case 'a': { const auto items = pop_some(1); return add_items(false, items); }
      case 'e': case 0x90: { const auto items = pop_marked(); return add_items(false, items); }
      case '}': push_items(PickleKind::dict, {}); return;
      case 'd': push_items(PickleKind::dict, pop_marked()); return;
      case 's': { const auto items = pop_some(2); return add_items(true, items); }
      case 'u': { const auto items = pop_marked(); return add_items(true, items); }

      case 'q': put(number<std::uint8_t>("memo")); return;
      case 'r': put(number<std::uint32_t>("memo")); return;
      case 'p': put(parse<std::uint64_t>(line(max_digits), "a memo number")); return;
      case 0x94: put(memo_.size()); return;
      case 'h': get(number<std::uint8_t>("memo")); return;
      case 'j': get(number<std::uint32_t>("memo")); return;
      case 'g': get(parse<std::uint64_t>(line(max_digits), "a memo number")); return;

      case 'c': { const std::string_view module = line(max_line); return push_name(module, line(max_line)); }
      case 0x93: {
        const std::string_view attribute = pop_node(PickleKind::text).text;
        return push_name(pop_node(PickleKind::text).text, attribute);
      }
      case 'R': case 0x81: {
        const PickleRef arguments = pop();
        return call_with_tuple(pop(), arguments);
      }
      case 0x92: {
        const PickleRef keywords = top();
        const bool none = pop_node(PickleKind::dict).items.empty();
        const PickleRef arguments = pop();
        return call_with_tuple(pop(), none ? arguments : with_last(arguments, keywords));
      }
      case 'i': {
        const std::string_view module = line(max_line);
        push_items(PickleKind::tuple, pop_marked());
        const PickleRef arguments = pop();
        push_name(module, line(max_line));
        return call_with_tuple(pop(), arguments);
      }
      case 'o': {
        std::vector<PickleRef> items = pop_marked();
        if (items.empty()) fail(403, "an object without a class");
        const PickleRef callee = items.front();
        items.erase(items.begin());
        push_items(PickleKind::tuple, std::move(items));
        return call_with_tuple(callee, pop());
      }
      case 'b': build(); return;
      case 'Q': push_persistent(pop()); return;
      case 'P': push_text(PickleKind::text, line(max_line)); push_persistent(pop()); return;

      case 0x82: case 0x83: case 0x84: case 0x97: case 0x98: fail(404, "an extension or a buffer outside the file");
      default: fail(403, "opcode ", int{opcode});
    }
  }
  // clang-format on

  void frame(std::uint64_t size) {
    if (left() < size) fail(402, "a frame of ", counted(size, "byte"), " where ", left(), " are left");
  }
  std::uint64_t length() {
    const auto n = number<std::int32_t>("length");
    if (n < 0) fail(403, "a negative length");
    return static_cast<std::uint64_t>(n);
  }
  /// A tuple with one value more: keyword arguments stand behind the others.
  PickleRef with_last(PickleRef tuple, PickleRef last) {
    std::vector<PickleRef> items = nodes_[tuple].items;
    items.push_back(last);
    push_items(nodes_[tuple].kind, std::move(items));
    return pop();
  }
  void call_with_tuple(PickleRef callee, PickleRef arguments) {
    const PickleKind kind = nodes_[callee].kind;
    if (kind != PickleKind::name && kind != PickleKind::object) fail(403, "a call of ", name_of(kind));
    if (nodes_[arguments].kind != PickleKind::tuple) fail(403, "a call with ", name_of(nodes_[arguments].kind));
    call(callee, arguments);
  }

  std::span<const std::byte> bytes_;
  std::string file_;
  PickleOptions options_;
  std::uint64_t position_ = 0, opcode_at_ = 0, budget_ = 0, memory_ = 0;
  std::deque<PickleNode> nodes_;
  std::vector<PickleRef> stack_, persistent_;
  std::vector<std::size_t> marks_;
  std::unordered_map<std::uint64_t, PickleRef> memo_;
  std::unordered_map<PickleRef, std::string_view> latin1_;
  std::deque<std::string> owned_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY const std::string& PickleValue::file() const { return machine_->file(); }

MOTIONLANG_BODY std::int64_t PickleValue::integer() const {
  if (!is(PickleKind::integer) && !is(PickleKind::boolean)) wrong("a whole number");
  return node().integer;
}

MOTIONLANG_BODY bool PickleValue::boolean() const {
  if (!is(PickleKind::boolean)) integer();
  return node().integer != 0;
}

MOTIONLANG_BODY std::string_view PickleValue::text() const {
  if (!is(PickleKind::text) && !is(PickleKind::bytes)) wrong("a text");
  return node().text;
}

MOTIONLANG_BODY std::span<const std::byte> PickleValue::bytes() const {
  if (!is(PickleKind::bytes)) wrong("bytes");
  return std::as_bytes(std::span(node().text.data(), node().text.size()));
}

MOTIONLANG_BODY PickleValue PickleValue::operator[](std::size_t i) const {
  if (node().keyed || i >= node().items.size()) wrong("a sequence of more elements");
  return {*machine_, node().items[i]};
}

MOTIONLANG_BODY std::optional<PickleValue> PickleValue::find(std::string_view name) const {
  for (std::size_t i = node().keyed ? size() : 0; i-- > 0;) {
    const PickleValue k = key(i);
    if ((k.is(PickleKind::text) || k.is(PickleKind::bytes)) && k.text() == name) return value(i);
  }
  return std::nullopt;
}

MOTIONLANG_BODY PickleValue PickleValue::operator[](std::string_view name) const {
  const auto found = find(name);
  if (!found) raise<io_error>(406, machine_->file(), ": no entry '", name, "' in the dictionary at byte ", at());
  return *found;
}

MOTIONLANG_BODY std::string PickleValue::name() const {
  if (is(PickleKind::name)) return concat_text(node().text, ".", node().attribute);
  if (!is(PickleKind::object)) return "";
  return machine_->node(node().callee).kind == PickleKind::name ? PickleValue(*machine_, node().callee).name() : "";
}

MOTIONLANG_BODY std::span<const std::byte> PickleValue::inline_bytes() const {
  if (!is(PickleKind::object)) wrong("an object with bytes behind it");
  return std::as_bytes(std::span(node().text.data(), node().text.size()));
}

MOTIONLANG_BODY const detail::PickleNode& PickleValue::node() const { return machine_->node(ref_); }

MOTIONLANG_BODY void PickleValue::fail_with(int id, const std::string& what) const {
  raise<io_error>(id, machine_->file(), ": ", what, machine_->place(at()));
}

MOTIONLANG_BODY void PickleValue::wrong(const char* expected) const {
  const std::string n = name();
  fail(407, expected, " expected, found ", to_string(kind()), n.empty() ? "" : " ", n);
}

MOTIONLANG_BODY PickleValue PickleValue::entry(std::size_t i) const {
  if (!node().keyed || i >= node().items.size()) wrong("a dictionary of more entries");
  return {*machine_, node().items[i]};
}

MOTIONLANG_BODY PickleValue PickleValue::related(detail::PickleRef ref, const char* what) const {
  if (ref == detail::no_pickle_value) wrong(what);
  return {*machine_, ref};
}

namespace detail {

inline void PickleMachine::read_inline(PickleRef object) {
  const InlineBytes found = options_.inline_bytes(PickleValue(*this, object), bytes_, position_);
  if (found.begin == 0) return;
  nodes_[object].text = as_text(slice(bytes_, found.begin, found.size, file_, "bytes behind an object"));
  position_ = found.begin + found.size;
}

}  // namespace detail

MOTIONLANG_BODY Pickle::Pickle(std::span<const std::byte> bytes, std::string file, const PickleOptions& options,
                               std::shared_ptr<const void> owner, std::uint64_t start)
    : machine_(std::make_unique<detail::PickleMachine>(bytes, std::move(file), options)), owner_(std::move(owner)) {
  root_ = machine_->run(start);
}

MOTIONLANG_BODY Pickle::Pickle(Pickle&&) noexcept = default;
MOTIONLANG_BODY Pickle& Pickle::operator=(Pickle&&) noexcept = default;
MOTIONLANG_BODY Pickle::~Pickle() = default;

MOTIONLANG_BODY Pickle Pickle::open(const FilePath& path, const PickleOptions& options) {
  auto file = MappedFile::open(path);
  return Pickle(file->bytes(), path.string(), options, file);
}

MOTIONLANG_BODY std::vector<PickleValue> Pickle::persistent() const {
  std::vector<PickleValue> out;
  for (const detail::PickleRef ref : machine_->persistent()) out.push_back({*machine_, ref});
  return out;
}

MOTIONLANG_BODY std::uint64_t Pickle::memory_left() const { return machine_->memory_left(); }

MOTIONLANG_BODY std::uint64_t Pickle::end() const { return machine_->position(); }

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_PICKLE_ARRAYS_HPP  // <motionlang/file/pickle_arrays.hpp>
#define MOTIONLANG_HAS_FILE_PICKLE_ARRAYS_HPP
/// Arrays in pickles: NumPy's arrays and scalars, joblib's, which lie between the opcodes, SciPy's sparse matrices,
/// chumpy's nodes (which SMPL's first files hold).
///
///     Pickle dump = Pickle::open("grouped.pth.tar", {.inline_bytes = joblib_array_bytes});
///
/// Source  spec weights.md, sections 5.2, 6, 7, 8.2

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

bool is_joblib_array(const PickleValue& v);
bool is_numpy_scalar(const PickleValue& v);
bool is_numpy_array(const PickleValue& v);

/// An array of NumPy as the file holds it. The bytes live as long as the Pickle and the file.
struct PickledArray {
  std::string type;  // NumPy's: "<f4"
  bool fortran_order = false;
  std::vector<Index> shape;
  std::span<const std::byte> raw;
  std::string where;  // for messages
};
PickledArray pickled_array(const PickleValue& v);

}  // namespace detail

/// Where the bytes of an array of joblib are: for PickleOptions. In front of them stands, in newer files, a number of
/// bytes that fill up to an aligned address.
/// Throws  io_error 403 if its description is damaged, 404 for arrays of objects
InlineBytes joblib_array_bytes(const PickleValue& object, std::span<const std::byte> file, std::uint64_t position);

/// The array that a value of a pickle means: of NumPy or joblib, a single number, a sparse matrix of SciPy in full
/// (csc, csr, coo; as real numbers), or the value of a chumpy node.
/// Throws  io_error 402, 403 if it is damaged, 404 for elements and classes that are not read, 405 for impossible
///         sizes, 407 if the value is no array
NpyArray to_array(const PickleValue& value);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_PICKLE_ARRAYS_IPP  // <motionlang/file/pickle_arrays.ipp>
#define MOTIONLANG_HAS_FILE_PICKLE_ARRAYS_IPP
// Bodies of pickle_arrays.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool is_numpy(const PickleValue& v, std::string_view function) {
  const std::string name = v.name();
  constexpr std::string_view modules[] = {"numpy.core.multiarray.", "numpy._core.multiarray.", "numpy.core.numeric.",
                                          "numpy._core.numeric.", "numpy."};
  return std::any_of(std::begin(modules), std::end(modules), [&](std::string_view module) {
    return name.starts_with(module) && std::string_view(name).substr(module.size()) == function;
  });
}

inline std::vector<Index> shape_of(const PickleValue& sizes) {
  std::vector<Index> shape;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::int64_t n = sizes[i].integer();
    if (n < 0 || i >= 32) sizes.fail(403, "not the shape of an array");
    shape.push_back(static_cast<Index>(n));
  }
  return shape;
}

/// numpy.dtype('f8', False, True) with the state (3, '<', None, ...): "<f8".
inline std::string dtype_of(const PickleValue& v) {
  if (!is_numpy(v, "dtype")) v.fail(407, "an element type expected");
  std::string type(v.arguments()[0].text());
  if (type.starts_with('<') || type.starts_with('>') || type.starts_with('|')) return type;
  return concat_text(v.has_state() ? v.state()[1].text() : "=", type);
}

MOTIONLANG_BODY bool is_joblib_array(const PickleValue& v) {
  return v.name() == "joblib.numpy_pickle.NumpyArrayWrapper";
}

MOTIONLANG_BODY bool is_numpy_scalar(const PickleValue& v) { return is_numpy(v, "scalar"); }

MOTIONLANG_BODY bool is_numpy_array(const PickleValue& v) {
  return is_numpy(v, "_reconstruct") || is_numpy(v, "_frombuffer") || is_joblib_array(v);
}

MOTIONLANG_BODY PickledArray pickled_array(const PickleValue& v) {
  const std::string where = concat_text(v.file(), ": array at byte ", v.at());
  if (is_numpy(v, "_reconstruct")) {
    const PickleValue state = v.state();  // version, shape, element type, whether the first index is the fastest, bytes
    if (state[4].is(PickleKind::list)) v.fail(404, "an array of objects");
    return {dtype_of(state[2]), state[3].boolean(), shape_of(state[1]), state[4].bytes(), where};
  }
  if (is_joblib_array(v)) {
    const PickleValue state = v.state();
    return {dtype_of(state["dtype"]), state["order"].text() == "F", shape_of(state["shape"]), v.inline_bytes(), where};
  }
  const PickleValue given = v.arguments();
  if (is_numpy(v, "_frombuffer")) {  // bytes, element type, shape, order
    return {dtype_of(given[1]), given[3].text() == "F", shape_of(given[2]), given[0].bytes(), where};
  }
  return {dtype_of(given[0]), false, {}, given[1].bytes(), where};
}

inline NpyArray numpy_array(const PickleValue& v) {
  PickledArray a = pickled_array(v);
  return stored_array(a.type, a.fortran_order, std::move(a.shape), a.raw, a.where);
}

/// A sparse matrix in full. Compressed by columns (csc) or rows (csr): entries indptr[c] ... indptr[c + 1] - 1 lie in
/// column (row) c at row (column) indices[k]. As a list (coo): entry k at row[k], col[k], which newer files call
/// coords.
inline NpyArray dense_matrix(const PickleValue& v) {
  const std::string name = v.name();
  const std::string_view kind = std::string_view(name).substr(name.rfind('.') + 1);
  const bool by_column = kind == "csc_matrix" || kind == "csc_array",
             by_row = kind == "csr_matrix" || kind == "csr_array";
  if (!by_column && !by_row && kind != "coo_matrix" && kind != "coo_array")
    v.fail(404, "a sparse matrix of class ", name);
  const PickleValue state = v.state();
  const auto shape = shape_of(state.find("_shape") ? state["_shape"] : state["shape"]);
  constexpr Index most = 2'000'000;
  if (shape.size() != 2) v.fail(403, "a sparse matrix with ", counted(shape.size(), "size"));
  const Index rows = shape[0], columns = shape[1];
  if (rows > most || columns > most || rows * columns > most) {
    v.fail(405, "a sparse matrix of ", rows, " x ", columns, " is too large");
  }
  const auto data = numpy_array(state["data"]).to<double>();
  const auto places = [](const PickleValue& array) { return numpy_array(array).to<std::int64_t>(); };
  std::vector<std::int64_t> row, column;
  if (by_column || by_row) {
    const auto starts = places(state["indptr"]);
    if (std::ssize(starts) != (by_column ? columns : rows) + 1 || starts.front() != 0 ||
        starts.back() != std::ssize(data) || !std::is_sorted(starts.begin(), starts.end())) {
      v.fail(403, "a sparse matrix whose arrays do not fit together");
    }
    (by_column ? row : column) = places(state["indices"]);
    std::vector<std::int64_t>& outer = by_column ? column : row;
    for (std::size_t c = 0; c + 1 < starts.size(); ++c)
      outer.resize(static_cast<std::size_t>(starts[c + 1]), static_cast<std::int64_t>(c));
  } else {
    const auto both = state.find("coords");
    row = places(both ? (*both)[0] : state["row"]);
    column = places(both ? (*both)[1] : state["col"]);
  }
  if (row.size() != data.size() || column.size() != data.size())
    v.fail(403, "a sparse matrix whose arrays do not fit together");
  std::vector<double> dense(static_cast<std::size_t>(rows * columns), 0.0);
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (row[k] < 0 || row[k] >= rows || column[k] < 0 || column[k] >= columns)
      v.fail(403, "entry ", row[k], ", ", column[k], " in a sparse matrix of ", rows, " x ", columns);
    dense[static_cast<std::size_t>(row[k] * columns + column[k])] += data[k];
  }
  return NpyArray::of(std::span<const double>(dense), {rows, columns});
}

inline NpyArray to_array(const PickleValue& v, int depth);

/// Select: a flattened, elements idxs of it, in the shape preferred_shape.
inline NpyArray selected_array(const PickleValue& v, int depth) {
  const PickleValue state = v.state();
  const auto values = to_array(state["a"], depth).to<double>();
  const auto indices = to_array(state["idxs"], depth).to<std::int64_t>();
  std::vector<double> out;
  for (const std::int64_t i : indices) {
    if (i < 0 || i >= std::ssize(values)) v.fail(403, "index ", i, " into ", counted(values.size(), "value"));
    out.push_back(values[static_cast<std::size_t>(i)]);
  }
  const auto preferred = state.find("preferred_shape");
  const bool has_shape = preferred && !preferred->is(PickleKind::none);
  auto shape = has_shape ? shape_of(*preferred) : std::vector<Index>{std::ssize(out)};
  if (static_cast<std::size_t>(checked_size(shape, 1, "chumpy")) != out.size()) {
    v.fail(403, counted(out.size(), "selected value"), " for another shape");
  }
  return NpyArray::of(std::span<const double>(out), std::move(shape));
}

/// Any other node of chumpy: its only value, called x or a.
inline NpyArray node_array(const PickleValue& v, int depth) {
  if (!v.has_state()) v.fail(404, "an array of class ", v.name());
  const auto x = v.state().find("x"), a = v.state().find("a");
  if (x.has_value() == a.has_value()) v.fail(404, "an array of class ", v.name());
  return to_array(x ? *x : *a, depth);
}

inline NpyArray to_array(const PickleValue& v, int depth) {
  constexpr int deepest = 32;
  if (depth > deepest) v.fail(405, "arrays in arrays, more than ", deepest, " deep");
  if (v.is(PickleKind::integer) || v.is(PickleKind::boolean)) return NpyArray::scalar(v.integer());
  if (v.is(PickleKind::real)) return NpyArray::scalar(v.real());
  if (is_numpy_array(v) || is_numpy_scalar(v)) return numpy_array(v);
  const std::string name = v.name();
  if (name.starts_with("scipy.sparse.")) return dense_matrix(v);
  if (name == "chumpy.reordering.Select") return selected_array(v, depth + 1);
  if (name.starts_with("chumpy.")) return node_array(v, depth + 1);
  v.fail(407, "an array expected, found ", name.empty() ? to_string(v.kind()) : name);
}

}  // namespace detail

MOTIONLANG_BODY InlineBytes joblib_array_bytes(const PickleValue& object, std::span<const std::byte> file,
                                               std::uint64_t position) {
  if (!detail::is_joblib_array(object)) return {};
  const PickleValue state = object.state();
  const auto alignment = state.find("numpy_array_alignment_bytes");
  if (alignment && !alignment->is(PickleKind::none)) {
    position += 1 + detail::load<std::uint8_t>(file, position, object.file(), "padding of an array");
  }
  const NpyArray described = detail::described_array(detail::dtype_of(state["dtype"]), detail::shape_of(state["shape"]),
                                                     concat_text(object.file(), ": array at byte ", object.at()));
  return {position, detail::checked_size(described.shape, described.item_size, object.file())};
}

MOTIONLANG_BODY NpyArray to_array(const PickleValue& value) { return detail::to_array(value, 0); }

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_PNG_HPP  // <motionlang/file/png.hpp>
#define MOTIONLANG_HAS_FILE_PNG_HPP
/// Pictures as PNG files (ISO/IEC 15948): writing of 8-bit RGB.

MOTIONLANG_NAMESPACE_BEGIN

/// Rows from top to bottom, red, green, blue.
struct Picture {
  Index width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

namespace detail {

/// Most significant byte first.
std::string big_endian(std::uint32_t v);

}  // namespace detail

/// Each row as differences to the row above. Throws shape_error 205 if the numbers are not width x height x 3,
/// config_error 101 for a picture without pixels or with more than 2^31 of them in a row.
std::string encode_png(const Picture& picture);

/// Throws io_error 401, and as encode_png.
void write_png(const FilePath& path, const Picture& picture);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_PNG_IPP  // <motionlang/file/png.ipp>
#define MOTIONLANG_HAS_FILE_PNG_IPP
// Bodies of png.hpp.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_DEFLATE_HPP  // <motionlang/file/detail/deflate.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_DEFLATE_HPP
/// Deflate (RFC 1951) in its plainest form: matches found by one table of three bytes, the codes that the standard
/// fixes. For pictures of a few flat colours, where nothing better is needed, and not zlib, which would have to be
/// linked. Unpacking is in inflate.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

std::string deflate(std::span<const std::byte> bytes);

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_DETAIL_DEFLATE_IPP  // <motionlang/file/detail/deflate.ipp>
#define MOTIONLANG_HAS_FILE_DETAIL_DEFLATE_IPP
// Bodies of deflate.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The bits of a deflate stream, least significant first.
class BitWriter {
 public:
  void put(std::uint32_t bits, int count) {
    hold_ |= std::uint64_t{bits} << held_;
    for (held_ += count; held_ >= 8; held_ -= 8, hold_ >>= 8) out_ += static_cast<char>(hold_ & 255u);
  }
  /// A Huffman code, most significant bit first.
  void put_code(std::uint32_t code, int count) {
    std::uint32_t reversed = 0;
    for (int i = 0; i < count; ++i) reversed |= (code >> i & 1u) << (count - 1 - i);
    put(reversed, count);
  }
  std::string finish() {
    if (held_ > 0) put(0, 8 - held_);
    return std::move(out_);
  }

 private:
  std::string out_;
  std::uint64_t hold_ = 0;
  int held_ = 0;
};

/// Writes literals and matches with the fixed codes (RFC 1951, 3.2.6).
class FixedCodes {
 public:
  void literal(std::uint32_t symbol) {
    if (symbol < 144) return bits_.put_code(0x30 + symbol, 8);
    if (symbol < 256) return bits_.put_code(0x190 + symbol - 144, 9);
    if (symbol < 280) return bits_.put_code(symbol - 256, 7);
    bits_.put_code(0xC0 + symbol - 280, 8);
  }
  /// length  3 ... 258; distance 1 ... 32768. Both in groups that double in size, lengths four to a size, distances
  ///         two.
  void match(std::uint32_t length, std::uint32_t distance) {
    if (length == 258) {
      literal(285);
    } else {
      const auto [symbol, extra, value] = group(length - 3, 4);
      literal(257 + symbol);
      bits_.put(value, extra);
    }
    const auto [symbol, extra, value] = group(distance - 1, 2);
    bits_.put_code(symbol, 5);
    bits_.put(value, extra);
  }
  void begin() { bits_.put(1 | 1 << 1, 3); }  // the last block, fixed codes
  std::string finish() {
    literal(256);
    return bits_.finish();
  }

 private:
  struct Group {
    std::uint32_t symbol;
    int extra;  // bits behind the symbol
    std::uint32_t value;
  };
  static Group group(std::uint32_t n, std::uint32_t each) {
    if (n < 2 * each) return {n, 0, 0};
    const int extra = static_cast<int>(std::bit_width(n / each)) - 1;
    return {(static_cast<std::uint32_t>(extra) * each) + (n >> extra), extra, n & ((1u << extra) - 1)};
  }

  BitWriter bits_;
};

MOTIONLANG_BODY std::string deflate(std::span<const std::byte> bytes) {
  constexpr std::size_t shortest = 3, longest = 258, farthest = 32768;
  std::vector<std::size_t> places(1 << 15, ~std::size_t{0});  // where three bytes stood last, by their hash
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  const auto hash = [&](std::size_t i) { return ((at(i) << 16 | at(i + 1) << 8 | at(i + 2)) * 2654435761u) >> 17; };
  FixedCodes out;
  out.begin();
  for (std::size_t i = 0; i < bytes.size();) {
    std::size_t length = 0, from = 0;
    if (i + shortest <= bytes.size()) {
      from = std::exchange(places[hash(i)], i);
      if (from < i && i - from <= farthest) {
        const std::size_t most = std::min(longest, bytes.size() - i);
        while (length < most && bytes[from + length] == bytes[i + length]) ++length;
      }
    }
    if (length >= shortest) {
      out.match(static_cast<std::uint32_t>(length), static_cast<std::uint32_t>(i - from));
      i += length;
    } else {
      out.literal(at(i++));
    }
  }
  return out.finish();
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string big_endian(std::uint32_t v) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(v >> shift & 255u);
  return out;
}

inline std::string png_chunk(std::string_view type, std::string_view data) {
  const std::string body = concat_text(type, data);
  return concat_text(big_endian(static_cast<std::uint32_t>(data.size())), body,
                     big_endian(crc32(std::as_bytes(std::span(body)))));
}

}  // namespace detail

MOTIONLANG_BODY std::string encode_png(const Picture& picture) {
  const auto fits = [](Index n) { return n > 0 && n <= 0x7fffffff / 3; };
  if (!fits(picture.width) || !fits(picture.height)) {
    raise<config_error>(101, "encode_png: ", picture.width, " x ", picture.height, " pixels");
  }
  const auto row = static_cast<std::size_t>(3 * picture.width), rows = static_cast<std::size_t>(picture.height);
  if (picture.rgb.size() / row != rows || picture.rgb.size() % row != 0) {
    raise<shape_error>(205, "encode_png: ", counted(picture.rgb.size(), "number"), " for ", picture.width, " x ",
                       picture.height);
  }
  constexpr std::byte up{2};
  std::vector<std::byte> filtered;
  filtered.reserve((row + 1) * rows);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
    if (i % row == 0) filtered.push_back(up);
    const int above = i >= row ? picture.rgb[i - row] : 0;
    filtered.push_back(static_cast<std::byte>((picture.rgb[i] - above) & 255));
  }
  const std::string header = concat_text(detail::big_endian(static_cast<std::uint32_t>(picture.width)),
                                         detail::big_endian(static_cast<std::uint32_t>(picture.height)),
                                         std::string_view("\x08\x02\x00\x00\x00", 5));
  const std::string data = concat_text(std::string_view("\x78\x01"), detail::deflate(filtered),
                                       detail::big_endian(detail::adler32(filtered)));
  return concat_text(std::string_view("\x89PNG\r\n\x1a\n"), detail::png_chunk("IHDR", header),
                     detail::png_chunk("IDAT", data), detail::png_chunk("IEND", {}));
}

MOTIONLANG_BODY void write_png(const FilePath& path, const Picture& picture) { write_file(path, encode_png(picture)); }

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_SAFETENSORS_HPP  // <motionlang/file/safetensors.hpp>
#define MOTIONLANG_HAS_FILE_SAFETENSORS_HPP
/// safetensors files: reading without a copy, writing. Includes no JSON library (see detail/json_cursor.hpp).
///
///     const auto file = SafetensorsFile::open("weights.safetensors");
///     for (const TensorView& t : file.tensors()) ...                  // sorted by name
///     std::vector<float> bias = values_of<float>(file.tensor("head.bias"));
///
/// Layout   8 bytes: length N of the header; N bytes: JSON, name -> {dtype, shape, data_offsets}, "__metadata__" -> map
///          of strings; the rest: data, without holes
/// Checked  everything, before any tensor is handed out (spec weights.md 2.2): lengths, strict JSON, UTF-8, no name
///          twice, products without overflow, ranges that tile the data exactly. Memory stays below a small multiple of
///          the header, and nothing is allocated for what a file merely claims.
/// Caution  a file that another process shortens while it is mapped ends the program (SIGBUS); write_file never does so

#ifndef MOTIONLANG_HAS_FILE_TENSOR_SET_HPP  // <motionlang/file/tensor_set.hpp>
#define MOTIONLANG_HAS_FILE_TENSOR_SET_HPP
/// Named tensors of a file: what every reader of weights gives, and what modules are filled from.

#ifndef MOTIONLANG_HAS_FILE_TENSOR_VIEW_HPP  // <motionlang/file/tensor_view.hpp>
#define MOTIONLANG_HAS_FILE_TENSOR_VIEW_HPP
/// A tensor as a file holds it: name, element type, shape, bytes. Every reader of arrays yields these and every writer
/// takes them; nothing is converted until somebody asks for values.

MOTIONLANG_NAMESPACE_BEGIN

// clang-format off
/// Element types of safetensors files. Values of those up to F64 can be read; of the others only the size is known.
enum class DType : std::uint8_t {
  BOOL, U8, I8, U16, I16, U32, I32, U64, I64, F16, BF16, F32, F64,
  F8_E5M2, F8_E4M3, F8_E8M0, F8_E4M3FNUZ, F8_E5M2FNUZ, F4, F6_E2M3, F6_E3M2, C64
};

struct DTypeInfo {
  std::string_view name;
  int bits;
};
inline constexpr std::array<DTypeInfo, 22> dtype_table{{
    {"BOOL", 8}, {"U8", 8}, {"I8", 8}, {"U16", 16}, {"I16", 16}, {"U32", 32}, {"I32", 32}, {"U64", 64}, {"I64", 64},
    {"F16", 16}, {"BF16", 16}, {"F32", 32}, {"F64", 64},
    {"F8_E5M2", 8}, {"F8_E4M3", 8}, {"F8_E8M0", 8}, {"F8_E4M3FNUZ", 8}, {"F8_E5M2FNUZ", 8},
    {"F4", 4}, {"F6_E2M3", 6}, {"F6_E3M2", 6}, {"C64", 64}}};
// clang-format on

constexpr const DTypeInfo& info(DType t) { return dtype_table[static_cast<std::size_t>(t)]; }
std::string to_string(DType t);
constexpr std::optional<DType> parse_dtype(std::string_view name) {
  for (std::size_t i = 0; i < dtype_table.size(); ++i) {
    if (dtype_table[i].name == name) return static_cast<DType>(i);
  }
  return std::nullopt;
}
/// Whether values of this type are whole numbers.
constexpr bool is_integer(DType t) { return t <= DType::I64; }

/// The element type that holds a C++ number.
template <class T>
requires std::integral<T> || std::floating_point<T>
consteval DType dtype_of() {
  if constexpr (std::same_as<T, bool>) return DType::BOOL;
  if constexpr (std::floating_point<T>) return sizeof(T) == 4 ? DType::F32 : DType::F64;
  constexpr std::array table{DType::U8, DType::U16, DType::U32, DType::U64};
  constexpr auto size = static_cast<unsigned>(std::bit_width(sizeof(T)) - 1);
  return static_cast<DType>(static_cast<unsigned>(table[size]) + (std::signed_integral<T> ? 1u : 0u));
}

/// Sizes of an array in a file, slowest axis first: as many as NumPy and PyTorch allow. A Shape, of what is calculated
/// with, has six at most.
class FileShape {
 public:
  static constexpr int max_rank = 64;

  FileShape() = default;
  FileShape(const Shape& shape);
  FileShape(std::initializer_list<Index> sizes) : FileShape(std::span<const Index>(sizes.begin(), sizes.size())) {}
  explicit FileShape(std::span<const Index> sizes);
  /// Throws shape_error 206 for more than six.
  operator Shape() const { return Shape(std::span<const Index>(sizes_)); }

  int rank() const { return static_cast<int>(sizes_.size()); }
  Index operator[](int axis) const { return sizes_[static_cast<std::size_t>(axis)]; }
  Index& operator[](int axis) { return sizes_[static_cast<std::size_t>(axis)]; }
  std::span<const Index> sizes() const { return sizes_; }
  /// Number of elements.
  Index count() const;
  /// Throws shape_error 205 for a negative size, 206 for more than 64 of them.
  void push_back(Index n);
  friend bool operator==(const FileShape&, const FileShape&) = default;
  friend bool operator==(const FileShape& a, const Shape& b) { return a == FileShape(b); }

 private:
  std::vector<Index> sizes_;
};

/// "(2, 60, 512)"
std::string to_string(const FileShape& s);

/// Row-major, without strides. Does not own its bytes.
struct TensorView {
  std::string name;
  DType dtype = DType::F32;
  FileShape shape;
  std::span<const std::byte> bytes;
};

/// A view of numbers in memory, for writing.
template <class T>
TensorView tensor_view(std::string name, const FileShape& shape, std::span<const T> values) {
  if (static_cast<std::size_t>(shape.count()) != values.size()) {
    raise<shape_error>(205, "tensor_view: ", counted(values.size(), "value"), " for '", name, "' of shape ", shape);
  }
  return {std::move(name), dtype_of<T>(), shape, std::as_bytes(values)};
}

/// The numbers themselves, without a copy: if the view holds Ts and they are aligned.
template <class T>
std::optional<std::span<const T>> direct(const TensorView& view) {
  if (view.dtype != dtype_of<T>() || reinterpret_cast<std::uintptr_t>(view.bytes.data()) % alignof(T) != 0) {
    return std::nullopt;
  }
  return std::span(reinterpret_cast<const T*>(view.bytes.data()), view.bytes.size() / sizeof(T));
}

namespace detail {

template <class Stored, class T, class Decode>
void convert(const TensorView& view, std::span<T> out, Decode decode) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    Stored s;
    std::memcpy(&s, view.bytes.data() + i * sizeof(Stored), sizeof(Stored));
    out[i] = decode(s);
  }
}

template <class Stored, class T>
void convert_numbers(const TensorView& view, std::span<T> out) {
  convert<Stored>(view, out, [&](Stored s) {
    if constexpr (std::integral<Stored> && std::integral<T>) {
      if (!std::in_range<T>(s)) {
        raise<io_error>(407, "tensor '", view.name, "': ", s, " does not fit the integer that is asked for");
      }
    }
    return static_cast<T>(s);
  });
}

}  // namespace detail

/// Copies all values, converted to T. Numbers of every kind become float or double; only whole numbers become integers.
/// Throws shape_error 205 if the sizes differ, io_error 404 for an element type that cannot be read, 407 if the values
/// are not of the kind of T or do not fit.
template <class T>
void copy_values(const TensorView& view, std::span<T> out) {
  if (view.bytes.size() * 8 != out.size() * static_cast<std::size_t>(info(view.dtype).bits)) {
    raise<shape_error>(205, "tensor '", view.name, "' of shape ", view.shape, " does not have ",
                       counted(out.size(), "value"));
  }
  if constexpr (std::integral<T>) {
    if (!is_integer(view.dtype)) {
      raise<io_error>(407, "tensor '", view.name, "' holds ", view.dtype, ", not whole numbers");
    }
  }
  switch (view.dtype) {
    case DType::BOOL:
      return detail::convert<std::uint8_t>(view, out, [](std::uint8_t b) { return static_cast<T>(b != 0); });
    case DType::U8:
      return detail::convert_numbers<std::uint8_t>(view, out);
    case DType::I8:
      return detail::convert_numbers<std::int8_t>(view, out);
    case DType::U16:
      return detail::convert_numbers<std::uint16_t>(view, out);
    case DType::I16:
      return detail::convert_numbers<std::int16_t>(view, out);
    case DType::U32:
      return detail::convert_numbers<std::uint32_t>(view, out);
    case DType::I32:
      return detail::convert_numbers<std::int32_t>(view, out);
    case DType::U64:
      return detail::convert_numbers<std::uint64_t>(view, out);
    case DType::I64:
      return detail::convert_numbers<std::int64_t>(view, out);
    case DType::F16:
      return detail::convert<std::uint16_t>(view, out, [](auto h) { return static_cast<T>(half_to_float(h)); });
    case DType::BF16:
      return detail::convert<std::uint16_t>(view, out, [](auto b) { return static_cast<T>(bfloat16_to_float(b)); });
    case DType::F32:
      return detail::convert_numbers<float>(view, out);
    case DType::F64:
      return detail::convert_numbers<double>(view, out);
    default:
      raise<io_error>(404, "tensor '", view.name, "': elements of type ", view.dtype, " are not supported");
  }
}

template <class T>
std::vector<T> values_of(const TensorView& view) {
  std::vector<T> out(static_cast<std::size_t>(view.shape.count()));
  copy_values(view, std::span<T>(out));
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_TENSOR_VIEW_IPP  // <motionlang/file/tensor_view.ipp>
#define MOTIONLANG_HAS_FILE_TENSOR_VIEW_IPP
// Bodies of tensor_view.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string to_string(DType t) { return std::string(info(t).name); }

MOTIONLANG_BODY FileShape::FileShape(const Shape& shape) {
  for (int i = 0; i < shape.rank(); ++i) push_back(shape[i]);
}

MOTIONLANG_BODY FileShape::FileShape(std::span<const Index> sizes) {
  for (const Index n : sizes) push_back(n);
}

MOTIONLANG_BODY Index FileShape::count() const {
  // beside a 0 the others may be of any size
  if (std::find(sizes_.begin(), sizes_.end(), 0) != sizes_.end()) return 0;
  Index n = 1;
  for (const Index size : sizes_) n *= size;
  return n;
}

MOTIONLANG_BODY void FileShape::push_back(Index n) {
  if (n < 0) raise<shape_error>(205, "FileShape: negative size ", n);
  if (rank() == max_rank) raise<shape_error>(206, "FileShape: more than ", max_rank, " axes");
  sizes_.push_back(n);
}

MOTIONLANG_BODY std::string to_string(const FileShape& s) { return detail::shape_text(s.sizes()); }

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

class TensorSet {
 public:
  /// Of the file, for messages.
  const std::string& name() const { return name_; }
  /// Keeps the bytes of all tensors alive.
  const std::shared_ptr<const void>& owner() const { return owner_; }

  /// All tensors, sorted by name.
  std::span<const TensorView> tensors() const { return tensors_; }
  std::vector<std::string> names() const;
  /// Null if no tensor has that name.
  const TensorView* find(std::string_view tensor) const;
  /// Throws io_error 406, with the most similar name, if no tensor has that name.
  const TensorView& tensor(std::string_view tensor) const;

 protected:
  TensorSet(std::string name, std::shared_ptr<const void> owner) : name_(std::move(name)), owner_(std::move(owner)) {}

  std::string name_;
  std::shared_ptr<const void> owner_;
  std::vector<TensorView> tensors_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_TENSOR_SET_IPP  // <motionlang/file/tensor_set.ipp>
#define MOTIONLANG_HAS_FILE_TENSOR_SET_IPP
// Bodies of tensor_set.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> TensorSet::names() const {
  std::vector<std::string> out;
  for (const TensorView& t : tensors_) out.push_back(t.name);
  return out;
}

MOTIONLANG_BODY const TensorView* TensorSet::find(std::string_view tensor) const {
  const auto t = std::lower_bound(tensors_.begin(), tensors_.end(), tensor,
                                  [](const TensorView& a, std::string_view b) { return a.name < b; });
  return t != tensors_.end() && t->name == tensor ? &*t : nullptr;
}

MOTIONLANG_BODY const TensorView& TensorSet::tensor(std::string_view tensor) const {
  const TensorView* t = find(tensor);
  if (t != nullptr) return *t;
  const std::string like = nearest_name(tensor, names());
  raise<io_error>(406, name_, ": no tensor '", tensor, "' among ", tensors_.size(),
                  like.empty() ? "" : concat_text("; the file has '", like, "'"));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
class JsonCursor;
}

class SafetensorsFile : public TensorSet {
 public:
  /// Longest header that is read, as in the reference implementation.
  static constexpr std::uint64_t max_header = 100'000'000;

  /// Maps a file. Throws io_error 401 (cannot be opened), 402 (ends too early), 403 (malformed), 404 (more than 64
  /// axes), 405 (impossible sizes).
  static SafetensorsFile open(const FilePath& path);
  /// A file in memory. `owner` keeps the bytes alive; without one they have to outlive the object. `name` stands in
  /// messages.
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

  /// The range has exactly the bytes that shape and type need; the product of the sizes does not overflow, not even of
  /// those that are not 0.
  static void check_size(const Cursor& json, const TensorView& view, const Range& range);

  /// The ranges follow each other without overlap or hole and end where the data end.
  static void check_tiling(const Cursor& json, std::vector<Range>& ranges, std::uint64_t size);

  std::map<std::string, std::string> metadata_;
};

/// The bytes of a file: tensors by element size, largest first, then by name; the data begin at a multiple of 8, so
/// every element is aligned. What is written is read back before it is returned: a name twice, a size that does not fit
/// the shape, or text that is not UTF-8 throws the io_error of the reader.
std::vector<std::byte> safetensors_bytes(std::span<const TensorView> tensors,
                                         const std::map<std::string, std::string>& metadata = {{"format", "pt"}});

/// Writes a file in one step: readers see the old one or the new one. Throws io_error 401, and what safetensors_bytes
/// throws. The metadata {"format": "pt"} let Python tools accept the file.
void write_safetensors(const FilePath& path, std::span<const TensorView> tensors,
                       const std::map<std::string, std::string>& metadata = {{"format", "pt"}});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_SAFETENSORS_IPP  // <motionlang/file/safetensors.ipp>
#define MOTIONLANG_HAS_FILE_SAFETENSORS_IPP
// Bodies of safetensors.hpp.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_JSON_CURSOR_HPP  // <motionlang/file/detail/json_cursor.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_JSON_CURSOR_HPP
/// A strict reader for the small JSON subset of a safetensors header, which walks over the text and stores nothing but
/// keys. Documents in general are read by file/json.hpp.
///
/// nlohmann's SAX reader does the same work but costs every translation unit that opens a weight file 1.5 s of
/// compilation (GCC 12, -O0), this one 0.2 s. Stricter than JSON: no name twice in an object, nesting up to
/// `max_depth`.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

class JsonCursor {
 public:
  static constexpr int max_depth = 4;
  static constexpr std::size_t max_members = 100'000;  // of an object: what one needs in memory is many times its text

  /// `offset` is where the text begins in the file; it only serves messages.
  JsonCursor(std::string_view text, std::string_view file, std::size_t offset)
      : text_(text), file_(file), offset_(offset) {}

  /// Throws io_error with the file and the byte of position `at`.
  [[noreturn]] void fail(int id, std::size_t at, std::string_view what) const {
    raise<io_error>(id, file_, ": byte ", offset_ + at, ": ", what);
  }
  std::size_t position() const { return at_; }

  void skip_space() {
    while (at_ < text_.size() && (peek() == ' ' || peek() == '\n' || peek() == '\r' || peek() == '\t')) ++at_;
  }
  bool at_end() const { return at_ == text_.size(); }
  /// The next character, '\0' at the end.
  char peek() const { return at_end() ? '\0' : text_[at_]; }

  /// Takes white space and c, if it is there.
  bool accept(char c) {
    skip_space();
    if (at_end() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(403, at_, concat_text("expected '", c, at_end() ? "', but the header ends" : "'"));
  }

  /// An object: on_value(key) is called for every member and has to take its value.
  template <class F>
  void object(F on_value) {
    enter();
    expect('{');
    std::set<std::string> keys;
    if (!accept('}')) {
      do {
        const std::size_t start = at_;
        const auto [key, is_new] = keys.insert(string());
        if (keys.size() > max_members) fail(405, start, concat_text("more than ", max_members, " names in one object"));
        if (!is_new) fail(403, start, "the name '" + *key + "' appears twice in one object");
        expect(':');
        on_value(*key);
      } while (accept(','));
      expect('}');
    }
    --depth_;
  }

  /// An array: on_value() is called for every element and has to take it.
  template <class F>
  void array(F on_value) {
    enter();
    expect('[');
    if (!accept(']')) {
      do on_value();
      while (accept(','));
      expect(']');
    }
    --depth_;
  }

  std::string string() {
    expect('"');
    std::string out;
    for (;;) {
      const std::size_t start = at_;
      if (at_end()) fail(403, at_, "a string has no end");
      const char32_t c = decode_utf8(text_, at_);
      if (c == invalid_code_point) fail(403, start, "not UTF-8");
      if (c < 0x20) fail(403, start, "a control character in a string");
      if (c == '"') return out;
      if (c == '\\')
        escape(out);
      else
        out += text_.substr(start, at_ - start);
    }
  }

  /// An integer in 0 ... 2^63-1, written with digits only.
  std::int64_t count() {
    skip_space();
    std::int64_t n = 0;
    const char* first = text_.data() + at_;
    const auto [end, status] = std::from_chars(first, text_.data() + text_.size(), n);
    const auto digits = static_cast<std::size_t>(end - first);
    if (digits == 0 || *first == '-') fail(403, at_, "expected an integer of at least 0");
    if (status != std::errc{}) fail(405, at_, "an integer above 2^63 - 1");
    if (digits > 1 && *first == '0') fail(403, at_, "an integer with a leading zero");
    at_ += digits;
    if (peek() == '.' || peek() == 'e' || peek() == 'E') fail(403, at_, "a fraction where an integer is due");
    return n;
  }

  /// Takes any value and forgets it.
  void skip_value() {
    skip_space();
    const char c = peek();
    if (c == '{') return object([&](const std::string&) { skip_value(); });
    if (c == '[') return array([&] { skip_value(); });
    if (c == '"') return void(string());
    if (c == '-' || (c >= '0' && c <= '9')) return skip_number();
    for (std::string_view word : {"true", "false", "null"}) {
      if (text_.substr(at_).starts_with(word)) return void(at_ += word.size());
    }
    fail(403, at_, "expected a value");
  }

 private:
  void enter() {
    if (++depth_ > max_depth) fail(403, at_, "nested too deeply");
  }

  void skip_digits() {
    const std::size_t start = at_;
    while (peek() >= '0' && peek() <= '9') ++at_;
    if (at_ == start) fail(403, at_, "expected a digit");
  }
  void skip_number() {
    if (peek() == '-') ++at_;
    if (peek() == '0')
      ++at_;
    else
      skip_digits();
    if (peek() == '.') ++at_, skip_digits();
    if (peek() == 'e' || peek() == 'E') {
      ++at_;
      if (peek() == '+' || peek() == '-') ++at_;
      skip_digits();
    }
  }

  void escape(std::string& out) {
    constexpr std::string_view letters = "\"\\/bfnrt", meaning = "\"\\/\b\f\n\r\t";
    const char c = peek();
    if (c == 'u') {
      ++at_;
      return append_utf8(out, escaped_code_point());
    }
    const std::size_t i = letters.find(c);
    if (at_end() || i == letters.npos) fail(403, at_, "an unknown escape in a string");
    out += meaning[i];
    ++at_;
  }
  char32_t escaped_code_point() {
    const std::size_t start = at_;
    const char32_t high = four_hex_digits();
    if (high < 0xD800 || high > 0xDFFF) return high;
    if (high < 0xDC00 && text_.substr(at_).starts_with("\\u")) {
      at_ += 2;
      const char32_t low = four_hex_digits();
      if (low >= 0xDC00 && low <= 0xDFFF) return 0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00);
    }
    fail(403, start, "half of a surrogate pair");
  }
  char32_t four_hex_digits() {
    const std::string_view digits = text_.substr(at_, 4);
    unsigned value = 0;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (status != std::errc{} || end != digits.data() + 4) fail(403, at_, "expected four hexadecimal digits");
    at_ += 4;
    return value;
  }

  std::string_view text_, file_;
  std::size_t offset_, at_ = 0;
  int depth_ = 0;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SafetensorsFile SafetensorsFile::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return from_bytes(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY SafetensorsFile SafetensorsFile::from_bytes(std::span<const std::byte> bytes, std::string name,
                                                            std::shared_ptr<const void> owner) {
  return SafetensorsFile(bytes, std::move(name), std::move(owner));
}

MOTIONLANG_BODY SafetensorsFile::SafetensorsFile(std::span<const std::byte> bytes, std::string name,
                                                 std::shared_ptr<const void> owner)
    : TensorSet(std::move(name), std::move(owner)) {
  const auto length = detail::load<std::uint64_t>(bytes, 0, name_, "the header length");
  if (length > max_header)
    raise<io_error>(405, name_, ": a header of ", counted(length, "byte"), "; at most ", max_header,
                    ". Is it a .safetensors file?");
  const auto header = detail::slice(bytes, prefix, length, name_, "the header");
  Cursor json(detail::as_text(header), name_, prefix);
  const auto data = bytes.subspan(prefix + static_cast<std::size_t>(length));

  std::vector<Range> ranges;
  if (json.peek() != '{') json.fail(403, 0, "a header has to begin with '{'");
  json.object([&](const std::string& key) {
    if (key == "__metadata__")
      read_metadata(json);
    else
      ranges.push_back(read_entry(json, key, data));
  });
  json.skip_space();
  if (!json.at_end()) json.fail(403, json.position(), "text behind the header's object");
  check_tiling(json, ranges, data.size());
  detail::sort(tensors_, [](const TensorView& a, const TensorView& b) { return a.name < b.name; });
}

MOTIONLANG_BODY void SafetensorsFile::read_metadata(Cursor& json) {
  json.object([&](const std::string& key) { metadata_[key] = json.string(); });
}

MOTIONLANG_BODY SafetensorsFile::Range SafetensorsFile::read_entry(Cursor& json, const std::string& name,
                                                                   std::span<const std::byte> data) {
  TensorView view{.name = name, .dtype = {}, .shape = {}, .bytes = {}};
  std::vector<std::int64_t> offsets;
  bool has_type = false, has_shape = false;
  const std::size_t at = json.position();
  json.object([&](const std::string& member) {
    if (member == "dtype") {
      view.dtype = read_dtype(json);
      has_type = true;
    } else if (member == "shape") {
      view.shape = read_shape(json);
      has_shape = true;
    } else if (member == "data_offsets") {
      json.array([&] {
        if (offsets.size() == 2) json.fail(403, json.position(), "more than two data_offsets");
        offsets.push_back(json.count());
      });
    } else {
      json.skip_value();
    }
  });
  if (!has_type || !has_shape || offsets.size() != 2) {
    json.fail(403, at, "tensor '" + view.name + "' lacks one of dtype, shape, data_offsets [begin, end]");
  }
  const Range range{static_cast<std::uint64_t>(offsets[0]), static_cast<std::uint64_t>(offsets[1]), at};
  check_size(json, view, range);
  if (range.end > data.size()) {
    json.fail(
        402, at,
        concat_text("tensor '", view.name, "' ends at ", range.end, ", the data have ", counted(data.size(), "byte")));
  }
  view.bytes = data.subspan(range.begin, range.end - range.begin);
  tensors_.push_back(std::move(view));
  return range;
}

MOTIONLANG_BODY DType SafetensorsFile::read_dtype(Cursor& json) {
  const std::size_t at = json.position();
  const std::string text = json.string();
  const auto dtype = parse_dtype(text);
  if (!dtype) json.fail(404, at, "unknown dtype '" + text + "'");
  return *dtype;
}

MOTIONLANG_BODY FileShape SafetensorsFile::read_shape(Cursor& json) {
  FileShape shape;
  json.array([&] {
    if (shape.rank() == FileShape::max_rank) {
      json.fail(404, json.position(), concat_text("more than ", FileShape::max_rank, " axes are not supported"));
    }
    shape.push_back(json.count());
  });
  return shape;
}

MOTIONLANG_BODY void SafetensorsFile::check_size(const Cursor& json, const TensorView& view, const Range& range) {
  constexpr std::uint64_t most_bits = std::uint64_t{1} << 62;
  std::uint64_t bits = static_cast<std::uint64_t>(info(view.dtype).bits);
  bool empty = false;
  for (int axis = 0; axis < view.shape.rank(); ++axis) {
    const auto n = static_cast<std::uint64_t>(view.shape[axis]);
    empty = empty || n == 0;
    if (n > 1 && bits > most_bits / n) {
      json.fail(405, range.declared_at, concat_text("tensor '", view.name, "': shape ", view.shape, " is too large"));
    }
    bits *= n > 1 ? n : 1;
  }
  if (empty) bits = 0;
  if (range.begin > range.end || bits % 8 != 0 || range.end - range.begin != bits / 8) {
    json.fail(405, range.declared_at,
              concat_text("tensor '", view.name, "': ", view.dtype, " ", view.shape, " does not fill data_offsets [",
                          range.begin, ", ", range.end, "]"));
  }
}

MOTIONLANG_BODY void SafetensorsFile::check_tiling(const Cursor& json, std::vector<Range>& ranges, std::uint64_t size) {
  detail::sort(ranges,
               [](const Range& a, const Range& b) { return a.begin != b.begin ? a.begin < b.begin : a.end < b.end; });
  std::uint64_t end = 0;
  for (const Range& r : ranges) {
    if (r.begin != end) {
      json.fail(
          403, r.declared_at,
          concat_text("data_offsets [", r.begin, ", ", r.end, "] ",
                      r.begin < end ? "overlap the range before, which ends at " : "leave a hole after byte ", end));
    }
    end = r.end;
  }
  if (end != size)
    json.fail(403, 0,
              concat_text(counted(size - end, "byte of data belongs", "bytes of data belong"), " to no tensor"));
}

namespace detail {

/// A JSON string. Throws io_error 403 if the text is not UTF-8.
inline void append_json_string(std::string& out, std::string_view text) {
  if (!is_utf8(text)) raise<io_error>(403, "safetensors: the name '", text, "' is not UTF-8");
  constexpr std::string_view digits = "0123456789abcdef";
  out += '"';
  for (char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\', out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += "\\u00";
      out += digits[static_cast<std::size_t>(c >> 4)], out += digits[static_cast<std::size_t>(c & 15)];
    } else {
      out += c;
    }
  }
  out += '"';
}

inline std::string safetensors_header(std::span<const TensorView* const> order,
                                      const std::map<std::string, std::string>& metadata) {
  std::string json = "{";
  const auto separate = [&] { json += json.size() > 1 ? "," : ""; };
  if (!metadata.empty()) {
    json += "\"__metadata__\":";
    char before = '{';
    for (const auto& [key, value] : metadata) {
      json += std::exchange(before, ',');
      append_json_string(json, key), json += ':', append_json_string(json, value);
    }
    json += '}';
  }
  std::size_t at = 0;
  for (const TensorView* t : order) {
    separate();
    append_json_string(json, t->name);
    json += concat_text(":{\"dtype\":\"", t->dtype, "\",\"shape\":[", join_text(t->shape.sizes(), ","),
                        "],\"data_offsets\":[", at, ",", at + t->bytes.size(), "]}");
    at += t->bytes.size();
  }
  json += '}';
  json.append((8 - json.size() % 8) % 8, ' ');
  return json;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::byte> safetensors_bytes(std::span<const TensorView> tensors,
                                                         const std::map<std::string, std::string>& metadata) {
  std::vector<const TensorView*> order;
  std::size_t size = 0;
  for (const TensorView& t : tensors) order.push_back(&t), size += t.bytes.size();
  detail::sort(order, [](const TensorView* a, const TensorView* b) {
    const int bits_a = info(a->dtype).bits, bits_b = info(b->dtype).bits;
    return bits_a != bits_b ? bits_a > bits_b : a->name < b->name;
  });
  const std::string header = detail::safetensors_header(order, metadata);
  std::vector<std::byte> out;
  out.reserve(sizeof(std::uint64_t) + header.size() + size);
  detail::append_value(out, std::uint64_t{header.size()});
  detail::append_text(out, header);
  for (const TensorView* t : order) detail::append_bytes(out, t->bytes);
  SafetensorsFile::from_bytes(out, "safetensors to be written");
  return out;
}

MOTIONLANG_BODY void write_safetensors(const FilePath& path, std::span<const TensorView> tensors,
                                       const std::map<std::string, std::string>& metadata) {
  write_file(path, safetensors_bytes(tensors, metadata));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_TENSOR_MEMORY_HPP  // <motionlang/file/tensor_memory.hpp>
#define MOTIONLANG_HAS_FILE_TENSOR_MEMORY_HPP
/// What keeps the bytes of tensors alive, and an account of what a file may cost: whoever reads weights asks here
/// before it allocates.

MOTIONLANG_NAMESPACE_BEGIN

/// The file in which most tensors lie, and the bytes of those that had to be unpacked or put into another order.
class TensorMemory {
 public:
  /// file_size   tensors may cost as many bytes besides the file itself, and 12 MiB
  TensorMemory(std::shared_ptr<const void> file, std::uint64_t file_size, std::string name)
      : file_(std::move(file)), name_(std::move(name)), left_(file_size + (std::uint64_t{12} << 20)) {}

  /// Throws io_error 405 if the file has cost too much already.
  void spend(std::uint64_t bytes);
  void allow(std::uint64_t more) { left_ += more; }
  /// What may still be spent.
  std::uint64_t left() const { return left_; }

  /// A place for bytes that live as long as this. They have been paid for.
  template <class T>
  const T& keep(T value) {
    auto kept = std::make_shared<const T>(std::move(value));
    const T& result = *kept;
    kept_.push_back(std::move(kept));
    return result;
  }

 private:
  std::shared_ptr<const void> file_;
  std::string name_;
  std::uint64_t left_;
  std::deque<std::shared_ptr<const void>> kept_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FILE_TENSOR_MEMORY_IPP  // <motionlang/file/tensor_memory.ipp>
#define MOTIONLANG_HAS_FILE_TENSOR_MEMORY_IPP
// Bodies of tensor_memory.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void TensorMemory::spend(std::uint64_t bytes) {
  if (bytes > left_) {
    raise<io_error>(405, name_, ": needs ", counted(bytes, "byte"), " more than a file of its size justifies");
  }
  left_ -= bytes;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FILE_TORCH_FILE_HPP  // <motionlang/file/torch_file.hpp>
#define MOTIONLANG_HAS_FILE_TORCH_FILE_HPP
/// PyTorch's files: zip archives (torch >= 1.6), TorchScript archives, and the older form of five pickles and raw
/// storages.
///
///     const TorchFile file = TorchFile::open("model.ckpt");
///     const TensorView bias = file.tensor(file.root()["state_dict"]["head.bias"]);
///
/// The objects in the file are a pickle, which is read without executing anything (file/pickle.hpp); this class gives
/// its tensors. Those that lie in order in the file are views of it, without a copy; others (transposed, expanded,
/// big-endian) are gathered. weights/weight_file.hpp finds all tensors of a file by their names.
///
/// Checked  sizes, strides and offsets against the storage, storages against the archive, the checksum of the pickle
/// Source   spec weights.md, sections 3 and 4

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The magic number of an older file, as pickles of all protocols from 2 on have it behind their first two bytes.
inline constexpr std::string_view torch_legacy_number{"\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e", 13};

class TorchTensors;

}  // namespace detail

class ZipArchive;

class TorchFile {
 public:
  /// Throws  io_error 401; 402, 403, 405 if the file is damaged; 404 for what is not supported, and for names that only
  ///         code that attacks its reader needs
  static TorchFile open(const FilePath& path);
  /// A file in memory. `owner` keeps the bytes alive; without one they have to outlive the object. `name` stands in
  /// messages.
  static TorchFile from_bytes(std::span<const std::byte> bytes, const std::string& name,
                              std::shared_ptr<const void> owner = {});
  /// A file of the older form.
  static TorchFile from_legacy(std::span<const std::byte> bytes, const std::string& name,
                               const std::shared_ptr<TensorMemory>& memory);
  /// An archive that is open already. `checksums`: those of stored storages are compared, too, which reads all of them.
  static TorchFile from_archive(const ZipArchive& zip, const std::shared_ptr<TensorMemory>& memory,
                                bool checksums = false);

  /// A plain pickle, in which tensors bring their storages.
  static TorchFile from_pickle(Pickle pickle, const std::shared_ptr<TensorMemory>& memory);

  static bool is_legacy(std::span<const std::byte> bytes);
  /// The first folder of an archive that has a data.pkl, with a slash; empty if there is none.
  static std::string root_folder(const ZipArchive& zip);

  /// Bytes that follow the pickle of an archive and mean nothing.
  std::uint64_t bytes_behind() const { return behind_; }
  /// "torch zip", "TorchScript", "torch legacy" or "pickle".
  const std::string& format() const { return format_; }
  PickleValue root() const { return object_.root(); }
  static bool is_tensor(const PickleValue& v);
  /// Not for several threads at once: what is allocated for tensors is counted.
  /// Throws  io_error 403, 405 if the tensor does not fit its storage, 404 if its elements are of no type that is
  ///         known, 407 if the value is no tensor
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

#ifndef MOTIONLANG_HAS_FILE_TORCH_FILE_IPP  // <motionlang/file/torch_file.ipp>
#define MOTIONLANG_HAS_FILE_TORCH_FILE_IPP
// Bodies of torch_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// How many bytes at the start of a file are the pickle of that number; 0: it begins otherwise.
inline std::size_t torch_legacy_magic(std::string_view file) {
  constexpr std::string_view frame{"\x95\x0d\0\0\0\0\0\0\0", 9};  // around the number from protocol 4 on
  if (file.size() < 2 || file[0] != '\x80' || file[1] < 2 || file[1] > 5) return 0;
  const std::size_t start = file.substr(2).starts_with(frame) ? 2 + frame.size() : 2;
  return file.substr(start).starts_with(torch_legacy_number) ? start + torch_legacy_number.size() : 0;
}

struct NamedDType {
  std::string_view name;
  DType dtype;
};

/// "torch.FloatStorage" and the like.
inline std::optional<DType> storage_dtype(std::string_view name) {
  constexpr NamedDType classes[] = {{"Float", DType::F32},     {"Double", DType::F64},      {"Half", DType::F16},
                                    {"BFloat16", DType::BF16}, {"Long", DType::I64},        {"Int", DType::I32},
                                    {"Short", DType::I16},     {"Char", DType::I8},         {"Byte", DType::U8},
                                    {"Bool", DType::BOOL},     {"ComplexFloat", DType::C64}};
  if (!name.starts_with("torch.") || !name.ends_with("Storage")) return std::nullopt;
  name = name.substr(name.rfind('.') + 1);
  name.remove_suffix(std::string_view("Storage").size());
  for (const NamedDType& c : classes) {
    if (c.name == name) return c.dtype;
  }
  return std::nullopt;
}

/// "torch.float32" and the like.
inline std::optional<DType> torch_dtype(std::string_view name) {
  constexpr NamedDType types[] = {{"float32", DType::F32},
                                  {"float64", DType::F64},
                                  {"float16", DType::F16},
                                  {"bfloat16", DType::BF16},
                                  {"int64", DType::I64},
                                  {"int32", DType::I32},
                                  {"int16", DType::I16},
                                  {"int8", DType::I8},
                                  {"uint8", DType::U8},
                                  {"uint16", DType::U16},
                                  {"uint32", DType::U32},
                                  {"uint64", DType::U64},
                                  {"bool", DType::BOOL},
                                  {"float8_e4m3fn", DType::F8_E4M3},
                                  {"float8_e5m2", DType::F8_E5M2},
                                  {"complex64", DType::C64}};
  if (!name.starts_with("torch.")) return std::nullopt;
  for (const NamedDType& t : types) {
    if (t.name == name.substr(6)) return t.dtype;
  }
  return std::nullopt;
}

inline std::uint64_t bytes_of(DType t) { return static_cast<std::uint64_t>(info(t).bits) / 8; }

/// A tensor as the pickle describes it: elements of a storage, in any order. Offset and strides count elements.
struct StridedTensor {
  DType dtype = DType::F32;
  std::span<const std::byte> storage;
  std::uint64_t offset = 0;
  FileShape shape, strides;
  bool swapped = false;  // big-endian

  bool contiguous() const {
    Index expected = 1;
    for (int axis = shape.rank(); axis-- > 0;) {
      if (shape[axis] != 1 && strides[axis] != expected) return false;
      expected *= shape[axis];
    }
    return true;
  }
};

/// The elements in row-major order. Visits them with an odometer of indices.
inline std::vector<std::byte> gathered(const StridedTensor& t) {
  const std::uint64_t size = bytes_of(t.dtype);
  std::vector<std::byte> out(static_cast<std::size_t>(t.shape.count()) * size);
  FileShape index = t.shape;
  for (int axis = 0; axis < index.rank(); ++axis) index[axis] = 0;
  std::uint64_t at = t.offset;
  for (std::size_t to = 0; to < out.size(); to += size) {
    std::memcpy(out.data() + to, t.storage.data() + at * size, size);
    if (t.swapped && t.dtype == DType::C64) {  // two numbers, each of them swapped
      std::reverse(out.data() + to, out.data() + to + size / 2);
      std::reverse(out.data() + to + size / 2, out.data() + to + size);
    } else if (t.swapped) {
      std::reverse(out.data() + to, out.data() + to + size);
    }
    for (int axis = t.shape.rank(); axis-- > 0;) {
      at += static_cast<std::uint64_t>(t.strides[axis]);
      if (++index[axis] < t.shape[axis]) break;
      at -= static_cast<std::uint64_t>(t.strides[axis] * index[axis]);
      index[axis] = 0;
    }
  }
  return out;
}

/// Pairs of a size and a stride are in range: every element lies in a storage of `count` elements. Gives back the
/// reason if not.
inline const char* out_of_range(const StridedTensor& t, std::uint64_t count) {
  constexpr std::uint64_t most_repeated = std::uint64_t{1}
                                          << 20;  // elements of a tensor that repeats those of its storage
  const std::uint64_t most = std::max(count, most_repeated);
  std::uint64_t product = 1;
  bool empty = false;
  for (int axis = 0; axis < t.shape.rank(); ++axis) {
    const auto n = static_cast<std::uint64_t>(t.shape[axis]);
    empty = empty || n == 0;
    if (n > 1 && product > most / n) return "has more elements than its storage allows";
    product *= std::max<std::uint64_t>(n, 1);
  }
  if (empty) return nullptr;
  if (t.offset >= count) return "begins behind the end of its storage";
  std::uint64_t room = count - 1 - t.offset;
  for (int axis = 0; axis < t.shape.rank(); ++axis) {
    const auto steps = static_cast<std::uint64_t>(t.shape[axis]) - 1,
               stride = static_cast<std::uint64_t>(t.strides[axis]);
    if (steps > 0 && stride > room / steps) return "reaches behind the end of its storage";
    if (steps > 0) room -= steps * stride;
  }
  return nullptr;
}

/// The tensors of one pickle, given the storages that it refers to.
class TorchTensors {
 public:
  using Storages = std::map<std::string, std::span<const std::byte>, std::less<>>;

  explicit TorchTensors(std::shared_ptr<TensorMemory> memory) : memory_(std::move(memory)) {}

  void add_storage(std::string key, std::span<const std::byte> bytes) {
    memory_->spend(sizeof(Storages::value_type) + 4 * sizeof(void*) + key.size());
    storages_.emplace(std::move(key), bytes);
  }
  void set_swapped(bool swapped) { swapped_ = swapped; }

  static bool is_tensor(const PickleValue& v) {
    constexpr std::string_view functions[] = {"torch._utils._rebuild_tensor_v2", "torch._utils._rebuild_tensor_v3",
                                              "torch._utils._rebuild_tensor", "torch._utils._rebuild_parameter",
                                              "torch._utils._rebuild_parameter_with_state"};
    return v.is(PickleKind::object) &&
           std::find(std::begin(functions), std::end(functions), v.name()) != std::end(functions);
  }

  TensorView tensor(PickleValue v) const {
    constexpr int deepest = 8;
    for (int depth = 0; is_tensor(v) && v.name().find("_rebuild_parameter") != std::string::npos; ++depth) {
      if (depth == deepest) v.fail(405, "a parameter of a parameter, more than ", deepest, " deep");
      v = v.arguments()[0];
    }
    if (!is_tensor(v)) v.fail(407, "a tensor expected, found ", v.name().empty() ? to_string(v.kind()) : v.name());
    const StridedTensor t = described(v);
    const std::uint64_t size = bytes_of(t.dtype), bytes = static_cast<std::uint64_t>(t.shape.count()) * size;
    TensorView view{.name = {}, .dtype = t.dtype, .shape = t.shape, .bytes = {}};
    if (bytes == 0) return view;
    if (t.contiguous() && !t.swapped) {
      view.bytes = t.storage.subspan(static_cast<std::size_t>(t.offset * size), static_cast<std::size_t>(bytes));
    } else {
      memory_->spend(bytes);
      view.bytes = memory_->keep(gathered(t));
    }
    return view;
  }

 private:
  struct Storage {
    std::span<const std::byte> bytes;
    std::optional<DType> dtype;  // none: the tensor knows
  };

  /// ("storage", class, key, location, number of elements) and, in older files, (key, offset, number) of a part of it.
  Storage storage(const PickleValue& v) const {
    if (v.name() == "torch.storage._load_from_bytes") return nested_storage(v);
    if (!v.is(PickleKind::persistent)) v.fail(403, "a tensor without a storage");
    const PickleValue id = v.arguments();
    if (id.size() < 5 || id[0].text() != "storage") v.fail(403, "not the id of a storage");
    const std::string type = id[1].name();
    const bool untyped = type.ends_with("UntypedStorage");
    const auto dtype = storage_dtype(type);
    if (!untyped && !dtype) v.fail(404, "a storage of class ", type.empty() ? "?" : type);
    const std::uint64_t size = untyped ? 1 : bytes_of(*dtype);
    const auto found = storages_.find(id[2].text());
    if (found == storages_.end()) v.fail(403, "storage '", id[2].text(), "' is not in the file");
    std::span<const std::byte> bytes = found->second;
    const std::int64_t count = id[4].integer();
    if (count < 0 || static_cast<std::uint64_t>(count) != bytes.size() / size || bytes.size() % size != 0) {
      v.fail(405, "storage '", id[2].text(), "' has ", counted(bytes.size(), "byte"), ", not ", count, " times ", size);
    }
    if (id.size() > 5 && !id[5].is(PickleKind::none)) {
      const std::int64_t first = id[5][1].integer(), part = id[5][2].integer();
      if (first < 0 || part < 0 || first > count || part > count - first) v.fail(405, "a part outside of its storage");
      bytes = bytes.subspan(static_cast<std::size_t>(first) * size, static_cast<std::size_t>(part) * size);
    }
    return {bytes, dtype};
  }
  Storage nested_storage(const PickleValue& v) const;

  StridedTensor described(const PickleValue& v) const {
    const PickleValue given = v.arguments();
    const std::string function = v.name();
    const Storage from = storage(given[0]);
    StridedTensor t;
    std::optional<DType> dtype = from.dtype;
    if (function.ends_with("_v3")) dtype = torch_dtype(given[6].name());
    if (!dtype) v.fail(404, "a tensor of unknown element type");
    t.dtype = *dtype;
    t.storage = from.bytes;
    const std::int64_t offset = given[1].integer();
    if (offset < 0) v.fail(405, "a tensor with a negative offset");
    t.offset = static_cast<std::uint64_t>(offset);
    t.shape = sizes(given[2]);
    t.strides = sizes(given[3]);
    t.swapped = swapped_ && bytes_of(t.dtype) > 1;
    // of _rebuild_tensor_v2, since PyTorch 2: elements are to be negated or conjugated on reading
    constexpr std::size_t metadata = 6;
    if (function.ends_with("_v2") && given.size() > metadata && given[metadata].size() > 0)
      v.fail(404, "a tensor that is negated or conjugated when it is read");
    if (t.shape.rank() != t.strides.rank())
      v.fail(403, "a tensor with ", counted(t.shape.rank(), "size"), " and ", counted(t.strides.rank(), "stride"));
    if (const char* problem = out_of_range(t, t.storage.size() / bytes_of(t.dtype))) {
      v.fail(405, "a tensor of shape ", t.shape, " ", problem);
    }
    return t;
  }
  /// A tuple, or torch.Size.
  static FileShape sizes(const PickleValue& v) {
    const PickleValue list = v.name() == "torch.Size" ? v.arguments()[0] : v;
    FileShape shape;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::int64_t n = list[i].integer();
      if (n < 0) v.fail(405, "a tensor with a negative size or stride");
      if (shape.rank() == FileShape::max_rank) v.fail(404, "a tensor with more than ", FileShape::max_rank, " axes");
      shape.push_back(static_cast<Index>(n));
    }
    return shape;
  }

  std::shared_ptr<TensorMemory> memory_;
  Storages storages_;
  bool swapped_ = false;
};

/// Five pickles in a row and the storages behind them. `Storages` are filled; the pickle of the object is given back.
inline Pickle read_torch_legacy(std::span<const std::byte> bytes, const std::string& name, TorchTensors& tensors,
                                const std::shared_ptr<TensorMemory>& memory) {
  const auto part = [&](std::uint64_t start, bool persistent = false, std::uint64_t most = 0) {
    return Pickle(bytes, name, {.persistent_ids = persistent, .max_memory = most}, memory, start);
  };
  const auto end_of_version = [&] {  // of these two pickles nothing is kept
    const Pickle version = part(torch_legacy_magic(as_text(bytes)));
    if (version.root().integer() != 1001)
      version.root().fail(404, "protocol ", version.root().integer(), " of PyTorch");
    return version.end();
  }();
  const auto end_of_system = [&] {
    const Pickle system = part(end_of_version);
    tensors.set_swapped(!system.root()["little_endian"].boolean());
    return system.end();
  }();
  Pickle object = part(end_of_system, true);

  std::map<std::string, std::uint64_t, std::less<>> element_size;
  for (const PickleValue& v : object.persistent()) {
    const PickleValue id = v.arguments();
    if (id.size() < 5) v.fail(403, "not the id of a storage");
    const auto dtype = storage_dtype(id[1].name());
    memory->spend(2 * sizeof(std::string) + 6 * sizeof(void*) + id[2].text().size());
    element_size.emplace(id[2].text(), dtype ? bytes_of(*dtype) : 1);
  }
  // Both are held at the same time: together they may need what one may.
  const Pickle keys = part(object.end(), false, std::max<std::uint64_t>(1, object.memory_left()));
  std::uint64_t at = keys.end();
  for (std::size_t i = 0; i < keys.root().size(); ++i) {
    const PickleValue key = keys.root()[i];
    const auto size = element_size.find(key.text());
    if (size == element_size.end()) key.fail(403, "storage '", key.text(), "' belongs to no tensor");
    const auto count = load<std::uint64_t>(bytes, at, name, "the size of a storage");
    at += sizeof count;
    if (count > bytes.size() / size->second) {
      raise<io_error>(405, name, ": storage '", key.text(), "' of ", counted(count, "element"), " at byte ", at, " of ",
                      bytes.size());
    }
    tensors.add_storage(std::string(key.text()), slice(bytes, at, count * size->second, name, "a storage"));
    at += count * size->second;
  }
  return object;
}

/// A storage that was pickled with the object: an older file of its own, in bytes.
inline TorchTensors::Storage TorchTensors::nested_storage(const PickleValue& v) const {
  const auto bytes = v.arguments()[0].bytes();
  if (torch_legacy_magic(as_text(bytes)) == 0) v.fail(403, "bytes that are no storage of PyTorch");
  memory_->spend(bytes.size());  // for the time it takes, too: many tensors may name the same bytes
  TorchTensors inner(memory_);
  const Pickle object = read_torch_legacy(bytes, v.file(), inner, memory_);
  if (!object.root().is(PickleKind::persistent)) v.fail(403, "bytes that are no storage of PyTorch");
  if (inner.swapped_) v.fail(404, "a big-endian storage in a little-endian file");
  return inner.storage(object.root());
}

}  // namespace detail

MOTIONLANG_BODY TorchFile TorchFile::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return from_bytes(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY TorchFile TorchFile::from_bytes(std::span<const std::byte> bytes, const std::string& name,
                                                std::shared_ptr<const void> owner) {
  const auto memory = std::make_shared<TensorMemory>(std::move(owner), bytes.size(), name);
  return is_legacy(bytes) ? from_legacy(bytes, name, memory) : from_archive(ZipArchive(bytes, name), memory);
}

MOTIONLANG_BODY TorchFile TorchFile::from_legacy(std::span<const std::byte> bytes, const std::string& name,
                                                 const std::shared_ptr<TensorMemory>& memory) {
  detail::TorchTensors tensors(memory);
  Pickle object = detail::read_torch_legacy(bytes, name, tensors, memory);
  return TorchFile(std::move(object), std::move(tensors), memory, "torch legacy");
}

MOTIONLANG_BODY TorchFile TorchFile::from_archive(const ZipArchive& zip, const std::shared_ptr<TensorMemory>& memory,
                                                  bool checksums) {
  const std::string folder = root_folder(zip);
  if (folder.empty()) raise<io_error>(403, zip.name(), ": no data.pkl in the archive: not a file of PyTorch");
  for (const ZipEntry& e : zip.entries()) {
    if (is_root_pickle(e.name) && !e.name.starts_with(folder))
      raise<io_error>(403, zip.name(), ": both '", folder, "data.pkl' and '", e.name, "' at byte ", e.offset,
                      ": which is meant?");
  }
  detail::TorchTensors tensors(memory);
  const std::string data = folder + "data/";
  bool script = false;
  for (const ZipEntry& e : zip.entries()) {
    script = script || e.name == folder + "constants.pkl" || e.name.starts_with(folder + "code/");
    if (!e.name.starts_with(data)) continue;
    if (e.deflated) memory->spend(e.size);
    tensors.add_storage(e.name.substr(data.size()), e.deflated  ? std::span<const std::byte>(memory->keep(zip.read(e)))
                                                    : checksums ? zip.checked(e)
                                                                : zip.stored(e));
  }
  if (const ZipEntry* order = zip.find(folder + "byteorder")) {
    const std::string_view text = detail::as_text(zip.checked(*order));
    if (text != "little" && text != "big") raise<io_error>(403, zip.name(), ": byte order '", utf8_head(text, 16), "'");
    tensors.set_swapped(text == "big");
  }
  const auto bytes = zip.checked(*zip.find(folder + "data.pkl"));
  Pickle object(bytes, concat_text(zip.name(), "/", folder, "data.pkl"), {.persistent_ids = true}, memory);
  const std::uint64_t behind = bytes.size() - object.end();
  TorchFile out(std::move(object), std::move(tensors), memory, script ? "TorchScript" : "torch zip");
  out.behind_ = behind;
  return out;
}

MOTIONLANG_BODY TorchFile TorchFile::from_pickle(Pickle pickle, const std::shared_ptr<TensorMemory>& memory) {
  return TorchFile(std::move(pickle), detail::TorchTensors(memory), memory, "pickle");
}

MOTIONLANG_BODY bool TorchFile::is_legacy(std::span<const std::byte> bytes) {
  return detail::torch_legacy_magic(detail::as_text(bytes)) > 0;
}

MOTIONLANG_BODY std::string TorchFile::root_folder(const ZipArchive& zip) {
  for (const ZipEntry& e : zip.entries()) {
    if (is_root_pickle(e.name)) return e.name.substr(0, e.name.find('/') + 1);
  }
  return "";
}

MOTIONLANG_BODY bool TorchFile::is_tensor(const PickleValue& v) { return detail::TorchTensors::is_tensor(v); }

MOTIONLANG_BODY TensorView TorchFile::tensor(const PickleValue& v) const { return tensors_->tensor(v); }

MOTIONLANG_BODY TorchFile::TorchFile(Pickle object, detail::TorchTensors tensors, std::shared_ptr<TensorMemory> memory,
                                     std::string format)
    : object_(std::move(object)),
      tensors_(std::make_shared<const detail::TorchTensors>(std::move(tensors))),
      memory_(std::move(memory)),
      format_(std::move(format)) {}

MOTIONLANG_BODY bool TorchFile::is_root_pickle(std::string_view member) {
  const std::size_t slash = member.find('/');
  return slash != member.npos && member.substr(slash + 1) == "data.pkl";
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_AMASS_HPP  // <motionlang/formats/amass.hpp>
#define MOTIONLANG_HAS_FORMATS_AMASS_HPP
/// AMASS-style .npz files (poses as rotation vectors, Z up), which SMPL tools and the Blender add-ons read, and joint
/// positions as .npy. No body model is needed; hands and faces are neither written nor kept: amass_body.hpp keeps them.
///
/// AMASS stores tau, not the pelvis: a body model puts the pelvis at J_0(beta) + tau, where J_0 is its rest position in
/// the model's own frame, some 20 cm off the origin. We do not have the model, so J_0 is an argument and 0 by default:
/// `trans` is then the pelvis itself, and a viewer with a real body shows the same motion shifted by J_0.

#ifndef MOTIONLANG_HAS_FORMATS_AMASS_SEQUENCE_HPP  // <motionlang/formats/amass_sequence.hpp>
#define MOTIONLANG_HAS_FORMATS_AMASS_SEQUENCE_HPP
/// AMASS files as they stand, for a body model: all rotation vectors, shape and gender, world Z up. As a Motion on
/// SMPL's bones: amass.hpp.
///
/// Source  Mahmood et al. (ICCV 2019); spec body-models.md 6

MOTIONLANG_NAMESPACE_BEGIN

class NpzArchive;

namespace detail {

/// Throws numeric_error 301.
void require_finite_betas(const std::string& file, std::span<const double> betas);

}  // namespace detail

/// The array that the poses of a sequence begin with: "poses", or "root_orient" or "global_orient" where they are
/// stored in parts. "" where the archive holds no sequence, as the shape.npz files beside them.
std::string_view amass_poses(const NpzArchive& npz);

/// Frames per second of a sequence, as its file says them; it may say none, or impossible ones.
std::optional<double> amass_rate(const NpzArchive& npz);

/// A sequence of SMPL (72 columns), SMPL-H (156, mocap_framerate) or SMPL-X (165, mocap_frame_rate), whose poses
/// may be stored in parts (root_orient, pose_body, ...), also by the names that smplx has for them (global_orient,
/// body_pose, transl, ...). The gender may be a text or an array of one, as in SSM_synced, or that as an object of
/// Python. Of betas for each frame, the first are taken.
/// fps     frames per second of a file that does not say them; 0: it is refused
/// Throws  io_error 401 to 405, 406 if an array is missing (as in the shape.npz files beside the sequences, which are
///         no motion), 407 if one has another shape, 403 for an impossible frame rate; config_error 102 if the file
///         says another rate; numeric_error 301 if a number of betas is not finite
AmassSequence read_amass_sequence(const FilePath& path, double fps = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_AMASS_SEQUENCE_IPP  // <motionlang/formats/amass_sequence.ipp>
#define MOTIONLANG_HAS_FORMATS_AMASS_SEQUENCE_IPP
// Bodies of amass_sequence.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Names of the arrays of poses that are stored in parts: face and hands need not be there.
struct PosePartNames {
  std::string_view root, body;
  std::array<std::string_view, 5> more;  // in the order of SMPL-X
  std::string_view path;
};
inline constexpr PosePartNames pose_part_names[] = {
    {"root_orient", "pose_body", {"pose_jaw", "pose_eye", "pose_hand"}, "trans"},  // AMASS of SMPL-X
    {"global_orient",                                                              // parameters of the package smplx
     "body_pose",
     {"jaw_pose", "leye_pose", "reye_pose", "left_hand_pose", "right_hand_pose"},
     "transl"}};

/// The parts side by side. A hand of other than 45 numbers is not of angles but of coefficients, and is left out.
template <class Matrix>
void join_pose_parts(const NpzArchive& npz, const PosePartNames& names, const Matrix& matrix, AmassSequence& out) {
  constexpr Index hand = 45;
  std::vector<NpyArray> parts{matrix(names.root), matrix(names.body)};
  for (const std::string_view name : names.more) {
    if (name.empty() || !npz.has(name)) continue;
    NpyArray part = matrix(name);
    if (!name.ends_with("_hand_pose") || part.shape[1] == hand) parts.push_back(std::move(part));
  }
  out.frames = parts.front().shape[0];
  for (const NpyArray& part : parts) {
    if (part.shape[0] != out.frames)
      raise<io_error>(407, npz.file(), ": parts of the poses have ", out.frames, " and ",
                      counted(part.shape[0], "row"));
    out.columns += part.shape[1];
  }
  out.poses.resize(static_cast<std::size_t>(out.frames * out.columns));
  Index first = 0;
  for (const NpyArray& part : parts) {
    const std::vector<double> numbers = part.to<double>();
    for (Index f = 0; f < out.frames; ++f)
      std::copy_n(numbers.begin() + f * part.shape[1], part.shape[1], out.poses.begin() + f * out.columns + first);
    first += part.shape[1];
  }
}

/// The gender of a file that has one: a text, or an array of one, or either as an object of Python, which is read and
/// not run. Throws io_error 402 to 407 for anything else.
inline std::string amass_gender(const ZipArchive& zip) {
  const std::vector<std::byte> bytes = zip.read(*zip.find("gender.npy"));
  const std::string where = concat_text(zip.name(), "/gender");
  const NpyParts npy = npy_parts(bytes, where);
  if (npy.header.descr != "|O") return parse_npy(bytes, where).text();
  const Pickle pickle(npy.raw, where);
  return std::string(pickle.root().state()[4][0].text());  // version, shape, element type, order, elements
}

MOTIONLANG_BODY void require_finite_betas(const std::string& file, std::span<const double> betas) {
  for (std::size_t i = 0; i < betas.size(); ++i) {
    if (!std::isfinite(betas[i])) raise<numeric_error>(301, file, ": number ", i, " of 'betas' is ", betas[i]);
  }
}

}  // namespace detail

MOTIONLANG_BODY std::string_view amass_poses(const NpzArchive& npz) {
  if (npz.has("poses")) return "poses";
  for (const detail::PosePartNames& names : detail::pose_part_names) {
    if (npz.has(names.root)) return names.root;
  }
  return "";
}

MOTIONLANG_BODY std::optional<double> amass_rate(const NpzArchive& npz) {
  for (const char* name : {"mocap_frame_rate", "mocap_framerate", "fps"}) {
    if (npz.has(name)) return npz.read(name).value<double>();
  }
  return std::nullopt;
}

MOTIONLANG_BODY AmassSequence read_amass_sequence(const FilePath& path, double fps) {
  const ZipArchive zip = ZipArchive::open(path);
  const NpzArchive npz(zip);
  constexpr Index most_columns = 4096;
  auto matrix = [&](std::string_view name) {
    NpyArray array = npz.read(name);
    if (array.shape.size() != 2) {
      raise<io_error>(407, npz.file(), ": '", name, "' has ", counted(array.shape.size(), "axis", "axes"),
                      ", 2 are expected");
    }
    if (array.shape[1] > most_columns)  // of no rows they could be any number
      raise<io_error>(405, npz.file(), ": '", name, "' has ", counted(array.shape[1], "column"), ", at most ",
                      most_columns, " are expected");
    return array;
  };
  AmassSequence out;
  std::string_view path_name = "trans";
  const auto names = std::find_if(std::begin(detail::pose_part_names), std::end(detail::pose_part_names),
                                  [root = amass_poses(npz)](const auto& n) { return n.root == root; });
  if (names != std::end(detail::pose_part_names)) {
    detail::join_pose_parts(npz, *names, matrix, out);
    path_name = names->path;
  } else {
    const NpyArray poses = matrix("poses");
    out.frames = poses.shape[0], out.columns = poses.shape[1], out.poses = poses.to<double>();
  }
  const NpyArray trans = matrix(path_name);
  if (out.columns < 66 || out.columns % 3 != 0 || trans.shape[1] != 3 || trans.shape[0] != out.frames) {
    raise<io_error>(407, npz.file(), ": poses (", out.frames, ", ", out.columns, ") and ", path_name, " (",
                    trans.shape[0], ", ", trans.shape[1], "), expected (N, 66 or more) and (N, 3)");
  }
  out.trans = trans.to<double>();
  const std::optional<double> own = amass_rate(npz);
  if (!own && fps == 0)
    raise<io_error>(406, npz.file(), ": no frame rate 'mocap_frame_rate', 'mocap_framerate' or 'fps': --rate says it");
  out.fps = own.value_or(fps);
  if (!(out.fps > 0 && out.fps < 1e6)) raise<io_error>(403, npz.file(), ": frame rate ", out.fps);
  if (fps != 0 && fps != out.fps)
    raise<config_error>(102, npz.file(), ": has ", out.fps, " frames per second, --rate says ", fps,
                        " (--fps resamples, --speed makes faster)");
  if (npz.has("gender")) out.gender = detail::amass_gender(zip);
  if (npz.has("betas")) {
    const NpyArray betas = npz.read("betas");
    out.betas = betas.to<double>();
    if (betas.shape.size() == 2) out.betas.resize(std::min(out.betas.size(), static_cast<std::size_t>(betas.shape[1])));
    detail::require_finite_betas(npz.file(), out.betas);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Y up (this library) to Z up (AMASS) and back: a quarter turn about x.
inline Vec3<double> y_up_to_z_up(const Vec3<double>& v) { return {v.x, -v.z, v.y}; }
inline Vec3<double> z_up_to_y_up(const Vec3<double>& v) { return {v.x, v.z, -v.y}; }

/// Whose motion it is. Only carried along.
struct AmassBody {
  std::string gender = "neutral";
  std::vector<double> betas = std::vector<double>(16, 0.0);
};

struct AmassClip {
  Motion motion;
  AmassBody body;
};

namespace detail {

inline constexpr std::size_t amass_joints = 22;  // SMPL's without the hands: the first 66 numbers of a pose

}  // namespace detail

/// Writes trans (N, 3), poses (N, 156; fingers 0), betas, gender and the frame rate under both of its spellings.
/// motion       on a skeleton whose first 22 joints are SMPL's; joints after them (the hands) are left out
/// rest_pelvis  J_0 of the body that will be shown, in the model's own frame; see the head of this file
/// Throws       config_error 106 for another skeleton, numeric_error 301 if a number is not finite, io_error 401
void write_amass(const FilePath& path, const Motion& motion, const AmassBody& body = {},
                 const Vec3<double>& rest_pelvis = {});

namespace detail {

/// Joint `joint` of a sequence in one frame, as the file has it.
Quaternion<double> amass_rotation(const AmassSequence& sequence, Index frame, Index joint);

}  // namespace detail

/// The body joints of a sequence: SMPL (72 columns), SMPL-H (156) or SMPL-X (165); fingers and face are dropped, the
/// two hand joints stay at rest. Bones are those of smpl24_skeleton(), whatever betas say. Throws numeric_error 301 if
/// a value is not finite
Motion amass_motion(const AmassSequence& sequence, std::string name, const Vec3<double>& rest_pelvis = {});

/// Reads the body joints of an AMASS file. fps: as for read_amass_sequence. Throws as that does, and numeric_error 301
/// if a value is not finite.
AmassClip read_amass(const FilePath& path, const Vec3<double>& rest_pelvis = {}, double fps = 0);

/// Joint positions as (frames, joints, 3) in float32, Z up: what STMC saves and its evaluation reads. Joints stand in
/// the order of the skeleton; readers take 22 or 24 for SMPL's. Throws io_error 401, numeric_error 301 for a position
/// that float32 cannot hold.
void write_joints_npy(const FilePath& path, const Motion& motion);

/// Joint positions as write_joints_npy wrote them, turned to Y up: (frames, joints), joint fastest.
struct JointPositions {
  Index frames = 0, joints = 0;
  std::vector<Vec3<double>> positions;
};
/// Throws io_error 401 to 405, 407 if the array is not (frames, joints, 3).
JointPositions read_joints_npy(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_AMASS_IPP  // <motionlang/formats/amass.ipp>
#define MOTIONLANG_HAS_FORMATS_AMASS_IPP
// Bodies of amass.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::size_t amass_columns = 156;  // SMPL-H: and 2 x 45 numbers of fingers

inline Quaternion<double> quarter_turn_about_x(double sign) {
  return from_axis_angle(Vec3<double>{1, 0, 0}, sign * std::numbers::pi / 2);
}

/// Throws config_error 106 unless the skeleton begins with SMPL's body joints.
inline void require_smpl(const Skeleton& skeleton) {
  const Skeleton& smpl = smpl24_skeleton();
  if (skeleton.size() < static_cast<int>(amass_joints)) {
    raise<config_error>(106, "AMASS: the skeleton has ", counted(skeleton.size(), "joint"), ", SMPL's body has ",
                        amass_joints);
  }
  for (int j = 0; j < static_cast<int>(amass_joints); ++j) {
    if (skeleton.name(j) != smpl.name(j) || skeleton.parent(j) != smpl.parent(j)) {
      raise<config_error>(106, "AMASS: joint ", j, " is '", skeleton.name(j), "' where SMPL has '", smpl.name(j),
                          "': retarget the motion first");
    }
  }
}

}  // namespace detail

MOTIONLANG_BODY void write_amass(const FilePath& path, const Motion& motion, const AmassBody& body,
                                 const Vec3<double>& rest_pelvis) {
  motion.validate();
  detail::require_smpl(motion.skeleton);
  detail::require_finite_betas(path.string(), body.betas);
  std::vector<double> trans, poses;
  const Quaternion<double> upright = detail::quarter_turn_about_x(1);
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    const Vec3<double> t = y_up_to_z_up(motion.root_at(frame)) - rest_pelvis;
    trans.insert(trans.end(), {t.x, t.y, t.z});
    const auto local = motion.rotations(frame);
    for (std::size_t j = 0; j < detail::amass_joints; ++j) {
      const Vec3<double> v = to_axis_angle(normalized(j == 0 ? upright * local[0] : local[j])).v;
      poses.insert(poses.end(), {v.x, v.y, v.z});
    }
    poses.resize(static_cast<std::size_t>(frame + 1) * detail::amass_columns, 0.0);
  }
  const Index frames = motion.frames();
  const std::vector<NamedArray> arrays{
      {"trans", NpyArray::of(std::span<const double>(trans), {frames, 3})},
      {"gender", NpyArray::text(body.gender)},
      {"mocap_framerate", NpyArray::scalar(motion.fps)},
      {"mocap_frame_rate", NpyArray::scalar(motion.fps)},  // the spelling of SMPL-X tools
      {"betas", NpyArray::of(std::span<const double>(body.betas), {static_cast<Index>(body.betas.size())})},
      {"poses", NpyArray::of(std::span<const double>(poses), {frames, static_cast<Index>(detail::amass_columns)})}};
  write_npz(path, arrays);
}

namespace detail {

MOTIONLANG_BODY Quaternion<double> amass_rotation(const AmassSequence& sequence, Index frame, Index joint) {
  const double* const v = sequence.poses.data() + frame * sequence.columns + 3 * joint;
  return to_quaternion(AxisAngle<double>{{v[0], v[1], v[2]}});
}

}  // namespace detail

MOTIONLANG_BODY Motion amass_motion(const AmassSequence& sequence, std::string name, const Vec3<double>& rest_pelvis) {
  Motion motion{smpl24_skeleton(), sequence.fps, {}, {}, std::move(name)};
  const Index joints = motion.skeleton.size();
  motion.local.assign(static_cast<std::size_t>(sequence.frames * joints), Quaternion<double>::identity());
  const Quaternion<double> lying = detail::quarter_turn_about_x(-1);
  for (Index frame = 0; frame < sequence.frames; ++frame) {
    const double* const t = sequence.trans.data() + 3 * frame;
    motion.root.push_back(z_up_to_y_up(Vec3<double>{t[0], t[1], t[2]} + rest_pelvis));
    const auto local = motion.rotations(frame);
    for (std::size_t j = 0; j < detail::amass_joints; ++j) {
      const auto q = detail::amass_rotation(sequence, frame, static_cast<Index>(j));
      local[j] = j == 0 ? lying * q : q;
    }
  }
  motion.validate();
  return motion;
}

MOTIONLANG_BODY AmassClip read_amass(const FilePath& path, const Vec3<double>& rest_pelvis, double fps) {
  AmassSequence sequence = read_amass_sequence(path, fps);
  AmassClip clip{amass_motion(sequence, path.stem(), rest_pelvis), {}};
  clip.body.gender = std::move(sequence.gender);
  if (!sequence.betas.empty()) clip.body.betas = std::move(sequence.betas);
  return clip;
}

MOTIONLANG_BODY void write_joints_npy(const FilePath& path, const Motion& motion) {
  motion.validate();
  std::vector<float> values;
  for (const Vec3<double>& p : motion.positions()) {
    const Vec3<float> v = vec_cast<float>(y_up_to_z_up(p));
    if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z))) {
      const Index at = std::ssize(values) / 3, joints = motion.skeleton.size();
      raise<numeric_error>(301, "write_joints_npy: joint ", at % joints, " of frame ", at / joints, " is at (", p.x,
                           ", ", p.y, ", ", p.z, "), too far for float32");
    }
    values.insert(values.end(), {v.x, v.y, v.z});
  }
  write_npy(path, NpyArray::of(std::span<const float>(values), {motion.frames(), motion.skeleton.size(), 3}));
}

MOTIONLANG_BODY JointPositions read_joints_npy(const FilePath& path) {
  const NpyArray array = read_npy(path);
  if (array.shape.size() != 3 || array.shape[2] != 3) {
    raise<io_error>(407, path.string(), ": not an array (frames, joints, 3)");
  }
  JointPositions out{array.shape[0], array.shape[1], {}};
  const std::vector<double> v = array.to<double>();
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) out.positions.push_back(z_up_to_y_up({v[i], v[i + 1], v[i + 2]}));
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_AMASS_BODY_HPP  // <motionlang/formats/amass_body.hpp>
#define MOTIONLANG_HAS_FORMATS_AMASS_BODY_HPP
/// AMASS sequences on a body of SMPL's family: hands and face, shape, and the place where AMASS has the pelvis.
///
///     const auto clip = amass_on_body(read_amass_sequence("a.npz"), "a", body);
///     write_body_glb("a.glb", body, std::span(&clip.motion, 1), std::span<const float>(clip.betas));
///
/// Source  Mahmood et al. (ICCV 2019); spec body-models.md 1, 2, 6

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct AmassOnBody {
  Motion motion;  // on the body's joints, turned to Y up
  std::vector<typename B::scalar>
      betas;                            // the file's, as many as the body has, if it has these shapes; the others are 0
  std::vector<std::string> parts{};     // that move in the file besides the 22 body joints: "left hand", ...
  std::vector<std::string> left_out{};  // those of them that the body does not have
};

namespace detail {

/// The rotations of the joints that follow the 22 of the body and that move, with the names of what they are part of.
void add_amass_parts(const AmassSequence& sequence, const Skeleton& skeleton, Motion& motion,
                     std::vector<std::string>& parts, std::vector<std::string>& left_out);

}  // namespace detail

/// Whether betas of a sequence mean the same shape on a body: SMPL and SMPL-H share theirs, SMPL-X has its own.
bool has_shapes_of(const AmassSequence& sequence, BodyKind body);

/// A part whose numbers are all 0 in the file is not in it: hands then have the mean pose of the body's, as in
/// motion_on_body.
/// Throws  config_error 106 for a body of another kind, numeric_error 301 if a value is not finite
template <Backend B>
AmassOnBody<B> amass_on_body(const AmassSequence& sequence, const std::string& name, const Body<B>& body) {
  using S = typename B::scalar;
  if (body.kind == BodyKind::other)
    raise<config_error>(106, "amass_on_body: a body of ", counted(body.model.joints(), "joint"),
                        " is not one of SMPL, SMPL-H and SMPL-X");
  const Index coefficients = body.model.shapedirs.size(1);
  std::vector<S> betas(static_cast<std::size_t>(coefficients), S(0));
  const Index common =
      has_shapes_of(sequence, body.kind) ? std::min(std::ssize(sequence.betas), coefficients - body.expressions) : 0;
  std::transform(sequence.betas.begin(), sequence.betas.begin() + common, betas.begin(),
                 [](double b) { return static_cast<S>(b); });

  const Skeleton skeleton = body_skeleton(body, std::span<const S>(betas));
  Motion motion = amass_motion(sequence, name, skeleton.offset(0));
  // its legs: the path is not scaled
  std::copy_n(skeleton.offsets.begin(), detail::amass_joints, motion.skeleton.offsets.begin());
  AmassOnBody<B> out{motion_on_body(body, motion, std::span<const S>(betas)), betas};
  detail::add_amass_parts(sequence, skeleton, out.motion, out.parts, out.left_out);
  out.motion.validate();
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_AMASS_BODY_IPP  // <motionlang/formats/amass_body.ipp>
#define MOTIONLANG_HAS_FORMATS_AMASS_BODY_IPP
// Bodies of amass_body.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Joints of a sequence that follow the 22 of the body.
struct AmassPart {
  std::string_view name;
  Index first, count;
};
inline std::vector<AmassPart> amass_parts(Index columns) {
  const auto after = static_cast<Index>(amass_joints), joints = columns / 3;
  const BodyKind kind = body_kind_of(joints);
  if (kind == BodyKind::other) return {{"joints after the 22nd", after, joints - after}};
  const BodyKindInfo& info = body_kinds[static_cast<std::size_t>(kind)];
  if (kind == BodyKind::smpl) return {{"hands", after, 2}};
  std::vector<AmassPart> parts{{"left hand", info.left_hand, 15}, {"right hand", info.right_hand, 15}};
  if (kind == BodyKind::smplx) parts.push_back({"jaw and eyes", after, 3});
  return parts;
}
inline bool moves(const AmassSequence& sequence, const AmassPart& part) {
  for (Index frame = 0; frame < sequence.frames; ++frame) {
    const auto numbers = std::span(sequence.poses)
                             .subspan(static_cast<std::size_t>(frame * sequence.columns + 3 * part.first),
                                      static_cast<std::size_t>(3 * part.count));
    if (std::any_of(numbers.begin(), numbers.end(), [](double x) { return x != 0; })) return true;
  }
  return false;
}

MOTIONLANG_BODY void add_amass_parts(const AmassSequence& sequence, const Skeleton& skeleton, Motion& motion,
                                     std::vector<std::string>& parts, std::vector<std::string>& left_out) {
  const auto names = body_joint_names(body_kind_of(sequence.columns / 3), sequence.columns / 3);
  for (const AmassPart& part : amass_parts(sequence.columns)) {
    if (!moves(sequence, part)) continue;
    const int own = skeleton.find(names[static_cast<std::size_t>(part.first)]);
    (own >= 0 ? parts : left_out).emplace_back(part.name);
    for (Index frame = 0; own >= 0 && frame < sequence.frames; ++frame) {
      for (Index j = 0; j < part.count; ++j)
        motion.rotations(frame)[static_cast<std::size_t>(own + j)] = amass_rotation(sequence, frame, part.first + j);
    }
  }
}

}  // namespace detail

MOTIONLANG_BODY bool has_shapes_of(const AmassSequence& sequence, BodyKind body) {
  return (body_kind_of(sequence.columns / 3) == BodyKind::smplx) == (body == BodyKind::smplx);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_AMC_HPP  // <motionlang/formats/amc.hpp>
#define MOTIONLANG_HAS_FORMATS_AMC_HPP
/// The original files of the CMU motion capture database: ASF (Acclaim skeleton) and AMC (Acclaim motion). Reading
/// only.
///
///     L = C M C^-1,   C, M: products of axis rotations, the axis named first is turned about first (R = Rz Ry Rx)
/// C is the bone's "axis", M has the angles of its degrees of freedom. A joint of the motion is the start of a bone: it
/// stands where the parent bone ends, and its rotation turns the bone. In the rest pose all rotations are the identity.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_ASF_SKELETON_HPP  // <motionlang/formats/detail/asf_skeleton.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_ASF_SKELETON_HPP
/// The skeleton of an ASF file, as it stands there.

MOTIONLANG_NAMESPACE_BEGIN

/// One number of a bone in an AMC frame: along or about an axis (0, 1, 2). A changing length (dof "l") is read, not
/// used.
struct AsfChannel {
  enum class Kind { translation, rotation, length };
  Kind kind;
  int axis = 0;
};

struct AsfBone {
  std::string name;
  int parent = -1;                      // number of the bone; -1 for the root
  Vec3<double> end{};                   // of the bone, seen from its start, in units of the file
  Quaternion<double> axis{1, 0, 0, 0};  // the frame in which the angles are meant (C)
  std::vector<AsfChannel> channels{};   // in the order of the numbers in the AMC file
};

/// Bone 0 is the root, which has no extent (its `end` is the position given in the file); parents come before their
/// children.
struct AsfSkeleton {
  std::vector<AsfBone> bones;
  double metres_per_unit = 0.0254;  // CMU: ":units length 0.45" means inches / 0.45
  bool degrees = true;
  std::string name{};

  /// Number of a bone, or -1.
  int find(std::string_view bone) const {
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (bones[b].name == bone) return static_cast<int>(b);
    }
    return -1;
  }
};

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct AmcReadOptions {
  double fps = 120;  // the format does not say it
};

/// Reads the text of an ASF file. Throws io_error 402 (too short), 403 (malformed), 405 (too many bones).
AsfSkeleton parse_asf(std::string_view text, std::string_view name = "ASF text");
/// Throws io_error 401 and as parse_asf.
AsfSkeleton read_asf(const FilePath& path);

/// One joint for each bone, at its start; metres.
Skeleton to_skeleton(const AsfSkeleton& asf);

/// Reads the text of an AMC file that belongs to the skeleton. Bones that no frame names rest; translations count for
/// the root only. Throws io_error 402 (too short), 403 (malformed, unknown bone, frames that are not numbered one after
/// the other, bones that a frame names twice or, unlike others, not at all), 405 (far more bones than numbers),
/// config_error 101 (fps), numeric_error 301 (numbers so large that they overflow).
Motion parse_amc(std::string_view text, const AsfSkeleton& asf, const AmcReadOptions& options = {},
                 std::string_view name = "AMC text");
/// Throws io_error 401 and as parse_amc.
Motion read_amc(const FilePath& path, const AsfSkeleton& asf, const AmcReadOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_AMC_IPP  // <motionlang/formats/amc.ipp>
#define MOTIONLANG_HAS_FORMATS_AMC_IPP
// Bodies of amc.hpp.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_ASF_PARSER_HPP  // <motionlang/formats/detail/asf_parser.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_ASF_PARSER_HPP
/// The grammar of ASF files (Acclaim skeletons). Sections begin with ":", comments with "#"; unknown properties are
/// skipped line by line.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_TEXT_SCANNER_HPP  // <motionlang/file/detail/text_scanner.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_TEXT_SCANNER_HPP
/// Reads words, numbers and lines of a text and says where it stands when something is wrong. For formats made of words
/// between blanks (BVH, ASF, AMC); knows no format itself.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// More joints than any file has; keeps searches for names in a hostile one short.
inline constexpr std::size_t max_text_joints = 4096;
/// How many rotations (32 bytes each) a text of so many bytes may stand for. Real files have several bytes for each;
/// joints that a frame does not mention could otherwise make much of little.
constexpr std::size_t max_text_rotations(std::size_t bytes) { return 1'000'000 + 16 * bytes; }

constexpr bool same_word(std::string_view a, std::string_view lower_case) {
  if (a.size() != lower_case.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (lower(a[i]) != lower_case[i]) return false;
  }
  return true;
}

/// A position in a text. Blank is everything up to and including the space, so CR, LF and CRLF end lines alike.
/// Throws io_error 402 where the text ends too early, 403 where it is malformed; messages begin "name:line:column: ".
class TextScanner {
 public:
  TextScanner(std::string_view text, std::string_view name) : text_(text), name_(name) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // byte order mark
  }

  bool at_end() {
    skip_blanks();
    return at_ == text_.size();
  }
  std::size_t bytes_left() const { return text_.size() - at_; }

  /// The next word without moving; empty at the end of the text. A brace is a word of its own.
  std::string_view peek() {
    skip_blanks();
    std::size_t end = at_;
    if (end < text_.size() && is_brace(text_[end])) return text_.substr(at_, 1);
    while (end < text_.size() && !is_blank(text_[end]) && !is_brace(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }
  /// The next word. Throws io_error 402 at the end of the text.
  std::string_view word(std::string_view wanted) {
    const std::string_view w = peek();
    if (w.empty()) fail(402, "the text ends where ", wanted, " should be");
    last_ = at_;
    at_ += w.size();
    return w;
  }
  /// Steps over these characters (no blanks among them), as "Frames:" of "Frames:12"; leading blanks are skipped.
  bool skip_prefix(std::string_view lower_case) {
    skip_blanks();
    if (!same_word(text_.substr(at_, lower_case.size()), lower_case)) return false;
    last_ = at_;
    at_ += lower_case.size();
    return true;
  }
  void expect(std::string_view lower_case) {
    const std::string_view w = word(lower_case);
    if (!same_word(w, lower_case)) fail(403, "expected '", lower_case, "', found '", shortened(w), "'");
  }

  /// A finite number; a leading plus sign is accepted, a value too small for a double is 0.
  double number(std::string_view wanted) {
    double value = 0;
    if (plain_decimal(value)) return value;
    const std::string_view w = word(wanted);
    const auto [end, problem] = from_digits(w, value);
    const bool whole = end == w.data() + w.size();
    if (whole && problem == std::errc::result_out_of_range && (w.find("e-") != w.npos || w.find("E-") != w.npos))
      return 0;
    if (problem != std::errc{} || !whole || !std::isfinite(value)) {
      fail(403, "expected ", wanted, ", found '", shortened(w), "'");
    }
    return value;
  }
  /// A whole number that is not negative.
  template <std::integral I>
  I count(std::string_view wanted) {
    const std::string_view w = word(wanted);
    I value = 0;
    const auto [end, problem] = from_digits(w, value);
    if (problem != std::errc{} || end != w.data() + w.size() || value < 0) {
      fail(403, "expected ", wanted, ", found '", shortened(w), "'");
    }
    return value;
  }

  /// Whether nothing but blanks stands before the last word on its line.
  bool began_line() const {
    std::size_t at = last_;
    while (at > 0 && is_blank(text_[at - 1]) && !is_line_end(text_[at - 1])) --at;
    return at == 0 || is_line_end(text_[at - 1]);
  }
  /// The next word of this line; empty where the line ends.
  std::string_view word_on_line() {
    while (at_ < text_.size() && is_blank(text_[at_]) && !is_line_end(text_[at_])) ++at_;
    if (at_ == text_.size() || is_blank(text_[at_])) return {};
    return word("");
  }
  /// The rest of the line, without the blanks around it; moves to the line's end.
  std::string_view rest_of_line() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end;
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line;
  }

  /// Throws with the place of the last word that was read.
  template <class... T>
  [[noreturn]] void fail(int id, const T&... parts) const {
    const auto [line, column] = place(id == 402 ? text_.size() : last_);
    raise<io_error>(id, name_, ":", line, ":", column, ": ", parts...);
  }

  /// A word for a message: cut after 40 bytes.
  static std::string shortened(std::string_view w) {
    return std::string(utf8_head(w, 40)) + (w.size() > 40 ? "..." : "");
  }

 private:
  struct Place {
    std::size_t line, column;
  };
  static bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }
  /// Takes a number that is written as most are, in one pass: up to 15 digits with a point at most, before a blank.
  /// Digits and power of ten are then exact doubles, so that their quotient is the double nearest to the text.
  bool plain_decimal(double& value) {
    static constexpr double powers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                        1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    skip_blanks();
    const char* const end = text_.data() + text_.size();
    const char* p = text_.data() + at_;
    const bool negative = p != end && *p == '-';
    const char* const first = p += negative;
    const char* behind_point = nullptr;
    std::uint64_t digits = 0;
    for (; p != end; ++p) {
      const unsigned digit = static_cast<unsigned char>(*p) - unsigned{'0'};
      if (digit < 10)
        digits = 10 * digits + digit;
      else if (*p == '.' && behind_point == nullptr)
        behind_point = p + 1;
      else
        break;
    }
    const auto count = p - first - (behind_point != nullptr);
    if (count < 1 || count > 15 || (p != end && !is_blank(*p))) return false;
    const double size = static_cast<double>(digits) / powers[behind_point == nullptr ? 0 : p - behind_point];
    value = negative ? -size : size;
    last_ = at_;
    at_ = static_cast<std::size_t>(p - text_.data());
    return true;
  }
  template <class N>
  static std::from_chars_result from_digits(std::string_view w, N& value) {
    if (w.size() > 1 && w[0] == '+' && w[1] != '-') w.remove_prefix(1);
    return detail::from_chars(w.data(), w.data() + w.size(), value);
  }
  Place place(std::size_t offset) const {
    std::size_t line = 1, start = 0;
    for (std::size_t i = 0; i < offset; ++i) {
      if (text_[i] == '\n' || (text_[i] == '\r' && (i + 1 == text_.size() || text_[i + 1] != '\n'))) {
        ++line;
        start = i + 1;
      }
    }
    return {line, offset - start + 1};
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_ = 0;
  std::size_t last_ = 0;  // where the last word began
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Rotation about a coordinate axis (0, 1, 2).
inline Quaternion<double> about_axis(int axis, double radians) {
  return from_axis_angle(Vec3<double>{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0}, radians);
}

class AsfParser {
 public:
  AsfParser(std::string_view text, std::string_view name) : scan_(text, name) {
    skeleton_.name = name;
    skeleton_.bones.push_back({.name = "root"});
    axes_.push_back({});
    children_.emplace_back();
  }

  AsfSkeleton parse() && {
    while (more()) {
      const std::string_view word = scan_.word("a section");
      if (same_word(word, ":units")) {
        units();
      } else if (same_word(word, ":root")) {
        root();
      } else if (same_word(word, ":bonedata")) {
        while (in_section()) bone();
      } else if (same_word(word, ":hierarchy")) {
        hierarchy();
      } else {
        scan_.rest_of_line();  // version, name, documentation, skin
      }
    }
    for (std::size_t b = 0; b < axes_.size(); ++b) skeleton_.bones[b].axis = axes_[b].rotation(skeleton_.degrees);
    return parents_first();
  }

 private:
  /// Angles about three axes, the first of `order` is turned about first.
  struct Axis {
    Vec3<double> angles{};
    std::array<int, 3> order{0, 1, 2};

    Quaternion<double> rotation(bool degrees) const {
      const double unit = degrees ? degree : 1, angle[3] = {angles.x, angles.y, angles.z};
      Quaternion<double> q = Quaternion<double>::identity();
      for (std::size_t i = 0; i < 3; ++i) q = about_axis(order[i], unit * angle[order[i]]) * q;
      return q;
    }
  };

  /// Whether a word follows outside of comments.
  bool more() {
    while (scan_.peek().starts_with('#')) scan_.rest_of_line();
    return !scan_.at_end();
  }
  bool in_section() { return more() && !scan_.peek().starts_with(':'); }
  std::string_view keyword() {
    more();
    return scan_.word("a keyword");
  }
  Vec3<double> vector(std::string_view wanted) {
    const double x = scan_.number(wanted), y = scan_.number(wanted);
    return {x, y, scan_.number(wanted)};
  }
  std::array<int, 3> order() {
    const std::string_view word = scan_.word("an order of axes");
    std::array<int, 3> axis{};
    unsigned seen = 0;
    for (std::size_t i = 0; i < 3 && word.size() == 3; ++i) {
      axis[i] = lower(word[i]) - 'x';
      if (axis[i] >= 0 && axis[i] <= 2) seen |= 1u << static_cast<unsigned>(axis[i]);
    }
    if (seen != 7) scan_.fail(403, "'", TextScanner::shortened(word), "' is not an order of axes");
    return axis;
  }

  void units() {
    while (in_section()) {
      const std::string_view word = keyword();
      if (same_word(word, "length")) {
        const double length = scan_.number("the unit of length");
        if (!(length > 0)) scan_.fail(403, "the unit of length is ", length);
        skeleton_.metres_per_unit = 0.0254 / length;
      } else if (same_word(word, "angle")) {
        skeleton_.degrees = !same_word(scan_.word("'deg' or 'rad'").substr(0, 3), "rad");
      } else {
        scan_.rest_of_line();
      }
    }
  }
  void root() {
    while (in_section()) {
      const std::string_view word = keyword();
      if (same_word(word, "order")) {
        channels(skeleton_.bones[0]);
      } else if (same_word(word, "axis")) {
        axes_[0].order = order();
      } else if (same_word(word, "position")) {
        skeleton_.bones[0].end = vector("a position");
      } else if (same_word(word, "orientation")) {
        axes_[0].angles = vector("an orientation");
      } else {
        scan_.rest_of_line();
      }
    }
  }
  void bone() {
    if (skeleton_.bones.size() == max_text_joints) scan_.fail(405, "more than ", max_text_joints, " bones");
    scan_.expect("begin");
    AsfBone bone;
    Axis axis;
    Vec3<double> direction{};
    double length = 0;
    for (std::string_view word = keyword(); !same_word(word, "end"); word = keyword()) {
      if (same_word(word, "name")) {
        bone.name = scan_.word("the name of a bone");
      } else if (same_word(word, "direction")) {
        direction = vector("a direction");
      } else if (same_word(word, "length")) {
        length = scan_.number("the length of a bone");
      } else if (same_word(word, "axis")) {
        axis.angles = vector("an angle");
        axis.order = order();
      } else if (same_word(word, "dof")) {
        channels(bone);
      } else if (word.starts_with(':')) {
        scan_.fail(403, "the bone '", bone.name, "' has no 'end'");
      } else {
        scan_.rest_of_line();  // id, limits, masses
      }
    }
    if (bone.name.empty()) scan_.fail(403, "a bone without a name");
    if (skeleton_.find(bone.name) >= 0) scan_.fail(403, "two bones are called '", bone.name, "'");
    bone.end = length * normalized(direction);
    skeleton_.bones.push_back(std::move(bone));
    axes_.push_back(axis);
    children_.emplace_back();
  }
  /// "TX TY TZ RX RY RZ", "rx rz", "l": to the end of the line.
  void channels(AsfBone& bone) {
    using enum AsfChannel::Kind;
    for (std::string_view w = scan_.word_on_line(); !w.empty() && w[0] != '#'; w = scan_.word_on_line()) {
      const char kind = lower(w[0]);
      const int axis = w.size() == 2 ? lower(w[1]) - 'x' : -1;
      if (kind == 'l' && w.size() == 1) {
        bone.channels.push_back({length, 0});
      } else if ((kind == 't' || kind == 'r') && axis >= 0 && axis <= 2) {
        bone.channels.push_back({kind == 't' ? translation : rotation, axis});
      } else {
        scan_.fail(403, "'", TextScanner::shortened(w), "' is not a degree of freedom");
      }
    }
  }
  /// Lines "parent child child ..." between begin and end.
  void hierarchy() {
    scan_.expect("begin");
    for (std::string_view w = keyword(); !same_word(w, "end"); w = keyword()) {
      const int parent = known(w);
      for (w = scan_.word_on_line(); !w.empty() && w[0] != '#'; w = scan_.word_on_line()) {
        const int child = known(w);
        AsfBone& bone = skeleton_.bones[static_cast<std::size_t>(child)];
        if (child == 0 || bone.parent >= 0) scan_.fail(403, "the bone '", bone.name, "' has two parents");
        bone.parent = parent;
        children_[static_cast<std::size_t>(parent)].push_back(child);
      }
    }
  }
  int known(std::string_view bone) {
    const int b = skeleton_.find(bone);
    if (b < 0) scan_.fail(403, "no bone is called '", TextScanner::shortened(bone), "'");
    return b;
  }

  /// Renumbers the bones depth first.
  AsfSkeleton parents_first() {
    AsfSkeleton sorted{{}, skeleton_.metres_per_unit, skeleton_.degrees, skeleton_.name};
    std::vector<int> number(skeleton_.bones.size(), -1), open{0};
    while (!open.empty()) {
      const auto old = static_cast<std::size_t>(open.back());
      open.pop_back();
      number[old] = static_cast<int>(sorted.bones.size());
      AsfBone bone = skeleton_.bones[old];
      if (bone.parent >= 0) bone.parent = number[static_cast<std::size_t>(bone.parent)];
      sorted.bones.push_back(std::move(bone));
      open.insert(open.end(), children_[old].rbegin(), children_[old].rend());
    }
    for (std::size_t b = 0; b < number.size(); ++b) {
      if (number[b] < 0) scan_.fail(403, "the hierarchy does not lead to the bone '", skeleton_.bones[b].name, "'");
    }
    return sorted;
  }

  TextScanner scan_;
  AsfSkeleton skeleton_;
  std::vector<Axis> axes_;  // of the bones; the unit of angles may come after them
  std::vector<std::vector<int>> children_;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY AsfSkeleton parse_asf(std::string_view text, std::string_view name) {
  return detail::AsfParser(text, name).parse();
}

MOTIONLANG_BODY AsfSkeleton read_asf(const FilePath& path) { return parse_asf(read_file(path), path.string()); }

MOTIONLANG_BODY Skeleton to_skeleton(const AsfSkeleton& asf) {
  Skeleton skeleton;
  for (const AsfBone& bone : asf.bones) {
    const bool below_root = bone.parent > 0;  // the root itself has no extent: its children start where it stands
    const Vec3<double> start = below_root ? asf.bones[static_cast<std::size_t>(bone.parent)].end : Vec3<double>{};
    skeleton.names.push_back(bone.name);
    skeleton.parents.push_back(bone.parent);
    skeleton.offsets.push_back(asf.metres_per_unit * (bone.parent < 0 ? bone.end : start));
  }
  skeleton.validate();
  return skeleton;
}

namespace detail {

class AmcParser {
 public:
  AmcParser(std::string_view text, std::string_view name, const AsfSkeleton& asf)
      : scan_(text, name),
        asf_(asf),
        limit_(max_text_rotations(text.size())),
        unit_(asf.degrees ? degree : 1),
        named_(asf.bones.size()) {
    motion_.name = name;
    motion_.skeleton = to_skeleton(asf);
  }

  Motion parse(double fps) && {
    motion_.fps = fps;
    while (!scan_.at_end()) {
      const std::string_view word = scan_.word("a bone");
      if (word[0] == '#') {
        scan_.rest_of_line();
      } else if (word[0] == ':') {
        header(word);
      } else if (word.find_first_not_of("0123456789") == word.npos) {
        if (!scan_.began_line())
          scan_.fail(403, "'", TextScanner::shortened(word), "' is a value too many, or a frame that begins no line");
        new_frame(word);
      } else {
        values(word);
      }
    }
    if (motion_.root.empty()) scan_.fail(402, "no frame");
    require_all_bones();
    motion_.validate();
    return std::move(motion_);
  }

 private:
  void header(std::string_view word) {
    if (same_word(word, ":degrees")) unit_ = degree;
    if (same_word(word, ":radians")) unit_ = 1;
    scan_.rest_of_line();
  }
  /// Frames are numbered one after the other, from any number on.
  void new_frame(std::string_view word) {
    std::uint64_t number = 0;
    const bool too_long = std::from_chars(word.data(), word.data() + word.size(), number).ec != std::errc{};
    if (too_long) scan_.fail(403, "frame ", TextScanner::shortened(word), ", a number too large");
    if (!motion_.root.empty() && number != number_ + 1) scan_.fail(403, "frame ", number, " after frame ", number_);
    if (!motion_.root.empty()) require_all_bones();
    number_ = number;
    const std::size_t joints = asf_.bones.size();
    if (motion_.local.size() + joints > limit_) {
      scan_.fail(405, "more than ", motion_.frames(), " frames of ", counted(joints, "bone"));
    }
    motion_.root.push_back(motion_.skeleton.offset(0));
    motion_.local.resize(motion_.local.size() + joints, Quaternion<double>::identity());
  }
  /// A bone that one frame names is named by all; those that none names rest.
  void require_all_bones() const {
    for (std::size_t b = 0; b < named_.size(); ++b) {
      if (named_[b] != 0 && named_[b] != motion_.root.size())
        scan_.fail(403, "frame ", number_, ", which ends here, has no numbers of '", asf_.bones[b].name,
                   "', unlike those before it");
    }
  }
  /// The numbers of one bone in the current frame.
  void values(std::string_view name) {
    const int number = asf_.find(name);
    if (number < 0) scan_.fail(403, "the skeleton has no bone '", TextScanner::shortened(name), "'");
    if (motion_.root.empty()) scan_.fail(403, "numbers of '", name, "' before the first frame");
    const AsfBone& bone = asf_.bones[static_cast<std::size_t>(number)];
    std::size_t& frames = named_[static_cast<std::size_t>(number)];
    if (frames == motion_.root.size()) scan_.fail(403, "frame ", number_, " has numbers of '", name, "' twice");
    if (frames == 0 && motion_.root.size() > 1)
      scan_.fail(403, "frame ", number_, " has numbers of '", name, "', unlike those before it");
    frames = motion_.root.size();
    Vec3<double> translation{};
    Quaternion<double> turn = Quaternion<double>::identity();
    for (const AsfChannel& channel : bone.channels) {
      const double v = scan_.number("a value of the motion");
      if (channel.kind == AsfChannel::Kind::rotation) turn = about_axis(channel.axis, unit_ * v) * turn;
      if (channel.kind == AsfChannel::Kind::translation) {
        (channel.axis == 0 ? translation.x : channel.axis == 1 ? translation.y : translation.z) = v;
      }
    }
    motion_.rotations(motion_.frames() - 1)[static_cast<std::size_t>(number)] = bone.axis * turn * inverse(bone.axis);
    if (number == 0) motion_.root.back() = motion_.skeleton.offset(0) + asf_.metres_per_unit * translation;
  }

  TextScanner scan_;
  const AsfSkeleton& asf_;
  std::size_t limit_;               // of rotations
  double unit_;                     // radians per unit of the angles
  std::uint64_t number_ = 0;        // of the frame
  std::vector<std::size_t> named_;  // frames that there were when a bone was named last
  Motion motion_;
};

}  // namespace detail

MOTIONLANG_BODY Motion parse_amc(std::string_view text, const AsfSkeleton& asf, const AmcReadOptions& options,
                                 std::string_view name) {
  return detail::AmcParser(text, name, asf).parse(options.fps);
}

MOTIONLANG_BODY Motion read_amc(const FilePath& path, const AsfSkeleton& asf, const AmcReadOptions& options) {
  return parse_amc(read_file(path), asf, options, path.string());
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_BODY_FILE_HPP  // <motionlang/formats/body_file.hpp>
#define MOTIONLANG_HAS_FORMATS_BODY_FILE_HPP
/// The user's own SMPL, SMPL-H and SMPL-X files, .npz or .pkl, as body models. The
/// content of a file says which form it has, the number of joints says which kind of body it is. A body of any other
/// number of joints is read, too. No file of these is or may be part of this library.
///
///     auto file = find_body_file("models", BodyKind::smplh);
///     auto body = read_body<EigenBackend<float>>(file, {.betas = 16});
///     auto posed = body.model(betas, rotations, translation);        // vertices, joints, extra points
///
/// Coefficients are those of shape and then those of expression. Source: spec weights.md 8, body-models.md 2, 4, 7.

MOTIONLANG_NAMESPACE_BEGIN

struct NpyArray;

struct BodyFileOptions {
  Index betas = 10;      // coefficients of shape, which the file must have
  Index most_betas = 0;  // so many of a file that has more of them than `betas`
  /// SMPL-X: coefficients of expression, which follow those of shape. -1: those that the file has, up to 10.
  Index expressions = -1;
  /// SMPL-X: directions of shape in the file. 0: known of files with 400 directions (300) and 20 (10), in others all of
  /// them.
  Index shape_directions = 0;
  /// Nose, eyes, ears, feet and finger tips (kinematics/body.hpp), if the vertices are those of the kind.
  bool extra_points = true;
};

namespace detail {

/// The named arrays of a file of either form.
class BodyArrays {
 public:
  explicit BodyArrays(const FilePath& path);

  const std::string& file() const { return file_; }
  bool has(const char* name) const;
  NpyArray read(const char* name) const;
  /// An array of this shape; a size below 0 may be any. Throws io_error 407, numeric_error 301 if a number is not
  /// finite. T: float, double or std::int64_t.
  template <class T>
  std::vector<T> read(const char* name, std::vector<Index> wanted, std::vector<Index>* found = nullptr) const;

 private:
  struct Source;  // one of two forms
  std::string file_;
  std::shared_ptr<const Source> source_;
};

/// Columns first ... first + count - 1 of every row.
template <class T>
void copy_columns(const std::vector<T>& from, Index width, Index first, Index count, std::vector<T>& to, Index to_width,
                  Index to_first) {
  for (Index row = 0; row < static_cast<Index>(from.size()) / width; ++row) {
    std::copy_n(from.begin() + row * width + first, count, to.begin() + row * to_width + to_first);
  }
}

/// Row 0: parents, the root's as -1 of any width. Row 1: the joints' own numbers, which must be 0, 1, 2, ...
std::vector<int> body_parents(const BodyArrays& arrays);

template <class S>
void check_weights(const BodyArrays& arrays, const std::vector<S>& weights, Index joints) {
  for (std::size_t at = 0; at < weights.size(); at += static_cast<std::size_t>(joints)) {
    double sum = 0;
    for (Index j = 0; j < joints; ++j) sum += static_cast<double>(weights[at + static_cast<std::size_t>(j)]);
    if (std::abs(sum - 1) > 1e-3) {
      raise<io_error>(403, arrays.file(), ": 'weights' of vertex ", at / static_cast<std::size_t>(joints),
                      " sum up to ", sum);
    }
  }
}

std::vector<std::array<Index, 3>> body_faces(const BodyArrays& arrays, Index vertices);

template <Backend B>
std::optional<HandPoses<B>> hand_poses(const BodyArrays& arrays, const char* components, const char* mean) {
  if (!arrays.has(components)) return std::nullopt;
  using S = typename B::scalar;
  std::vector<Index> shape;
  const auto rows = arrays.read<S>(components, {-1, 45}, &shape);
  return HandPoses<B>{Tensor<B, 2>::from(rows, {shape[0], 45}), Tensor<B, 1>::from(arrays.read<S>(mean, {45}), {45})};
}

/// Where the directions of expression begin: 300 shape and 100 expression directions in new files, 10 and 10 in old
/// ones.
Index first_expression(BodyKind kind, Index directions, Index told);

/// Points on triangles: one row of triangles, or several.
std::vector<SurfacePoints> rows_of_points(const BodyArrays& arrays, const char* triangles, const char* weights,
                                          std::span<const std::array<Index, 3>> faces);

bool readable(const FilePath& path);

}  // namespace detail

/// Throws  io_error 401 to 407 for files that cannot be read or are not a body, numeric_error 301 for numbers that are
///         not finite, config_error 101 if the file has fewer coefficients than asked for
template <Backend B>
Body<B> read_body(const FilePath& path, const BodyFileOptions& options = {}) {
  using S = typename B::scalar;
  const detail::BodyArrays arrays(path);
  Body<B> body;
  BodyModel<B>& model = body.model;
  model.parents = detail::body_parents(arrays);
  const Index joints = model.joints();
  body.kind = body_kind_of(joints);

  std::vector<Index> shape;
  auto tensor = [](const std::vector<S>& values, Index rows, Index columns) {
    return Tensor<B, 2>::from(values, {rows, columns});
  };
  const auto points = arrays.read<S>("v_template", {-1, 3}, &shape);
  const Index vertices = shape[0];
  model.v_template = tensor(points, vertices, 3);
  model.posedirs = tensor(arrays.read<S>("posedirs", {vertices, 3, 9 * (joints - 1)}), 3 * vertices, 9 * (joints - 1));
  model.J_regressor = tensor(arrays.read<S>("J_regressor", {joints, vertices}), joints, vertices);
  const auto weights = arrays.read<S>("weights", {vertices, joints});
  detail::check_weights(arrays, weights, joints);
  model.weights = tensor(weights, vertices, joints);

  const auto directions = arrays.read<S>("shapedirs", {vertices, 3, -1}, &shape);
  const Index first_expression = detail::first_expression(body.kind, shape[2], options.shape_directions);
  const Index betas = std::max(options.betas, std::min(options.most_betas, first_expression));
  const Index expressions =
      options.expressions >= 0 ? options.expressions : std::min<Index>(10, shape[2] - first_expression);
  body.expressions = body.kind == BodyKind::smplx ? expressions : 0;
  if (options.betas < 0 || options.betas > first_expression || body.expressions < 0 ||
      body.expressions > shape[2] - first_expression) {
    raise<config_error>(101, path.string(), ": ", counted(options.betas, "coefficient"), " of shape and ",
                        body.expressions, " of expression asked for, the file has ", first_expression, " and ",
                        shape[2] - first_expression);
  }
  const Index wanted = betas + body.expressions;
  std::vector<S> chosen(static_cast<std::size_t>(3 * vertices * wanted));
  if (shape[2] > 0) {
    detail::copy_columns(directions, shape[2], 0, betas, chosen, wanted, 0);
    detail::copy_columns(directions, shape[2], first_expression, body.expressions, chosen, wanted, betas);
  }
  model.shapedirs = tensor(chosen, 3 * vertices, wanted);

  body.faces = detail::body_faces(arrays, vertices);
  const bool published =
      body.kind != BodyKind::other && vertices == body_kinds[static_cast<std::size_t>(body.kind)].vertices;
  if (options.extra_points && published) model.extra = extra_vertices(body.kind);
  body.left_hand = detail::hand_poses<B>(arrays, "hands_componentsl", "hands_meanl");
  body.right_hand = detail::hand_poses<B>(arrays, "hands_componentsr", "hands_meanr");
  const std::span<const std::array<Index, 3>> faces(body.faces);
  if (auto rows = detail::rows_of_points(arrays, "lmk_faces_idx", "lmk_bary_coords", faces); !rows.empty())
    body.landmarks = std::move(rows.front());
  body.contours = detail::rows_of_points(arrays, "dynamic_lmk_faces_idx", "dynamic_lmk_bary_coords", faces);
  model.validate();
  return body;
}

/// The poses of a hand from MANO's own file, for bodies of SMPL-H whose file has none:
///
///     body.left_hand = read_hand<B>("MANO_LEFT.pkl");
/// Throws  as read_body; io_error 406 for a file without the arrays
template <Backend B>
HandPoses<B> read_hand(const FilePath& path) {
  const detail::BodyArrays arrays(path);
  if (auto hand = detail::hand_poses<B>(arrays, "hands_components", "hands_mean")) return std::move(*hand);
  raise<io_error>(406, path.string(), ": no 'hands_components'; not a hand of MANO");
}

/// The file of a body below a folder, under one of its usual names: smpl/SMPL_NEUTRAL.pkl, smplh/SMPLH_MALE.npz,
/// smplh/female/model.npz, smplx/SMPLX_NEUTRAL.npz, and the names of the downloads.
/// Throws  io_error 401, which says where the file can be had, if there is none; config_error 101 for a body of kind
///         `other`
FilePath find_body_file(const FilePath& root, BodyKind kind, BodyGender gender = BodyGender::neutral);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_BODY_FILE_IPP  // <motionlang/formats/body_file.ipp>
#define MOTIONLANG_HAS_FORMATS_BODY_FILE_IPP
// Bodies of body_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

struct BodyArrays::Source {
  std::variant<NpzArchive, Pickle> file;

  static std::shared_ptr<const Source> open(const FilePath& path) {
    auto file = MappedFile::open(path);
    if (as_text(file->bytes()).starts_with("PK\x03\x04"))
      return std::make_shared<const Source>(Source{NpzArchive(ZipArchive(file->bytes(), path.string(), file))});
    return std::make_shared<const Source>(Source{Pickle(file->bytes(), path.string(), {}, file)});
  }
};

MOTIONLANG_BODY BodyArrays::BodyArrays(const FilePath& path) : file_(path.string()), source_(Source::open(path)) {}

MOTIONLANG_BODY bool BodyArrays::has(const char* name) const {
  if (const auto* npz = std::get_if<NpzArchive>(&source_->file)) return npz->has(name);
  return std::get<Pickle>(source_->file).root().find(name).has_value();
}

MOTIONLANG_BODY NpyArray BodyArrays::read(const char* name) const {
  if (const auto* npz = std::get_if<NpzArchive>(&source_->file)) return npz->read(name);
  return to_array(std::get<Pickle>(source_->file).root()[name]);
}

template <class T>
std::vector<T> BodyArrays::read(const char* name, std::vector<Index> wanted, std::vector<Index>* found) const {
  const NpyArray array = read(name);
  bool fits = array.shape.size() == wanted.size();
  for (std::size_t i = 0; fits && i < wanted.size(); ++i) fits = wanted[i] < 0 || array.shape[i] == wanted[i];
  if (!fits)
    raise<io_error>(407, file_, ": '", name, "' is ", detail::shape_text(array.shape), ", expected ",
                    detail::shape_text(wanted));
  if (found != nullptr) *found = array.shape;
  std::vector<T> values = array.to<T>();
  for (const T x : values) {
    if (!std::isfinite(static_cast<double>(x))) raise<numeric_error>(301, file_, ": '", name, "' is not finite");
  }
  return values;
}

MOTIONLANG_BODY std::vector<int> body_parents(const BodyArrays& arrays) {
  std::vector<Index> shape;
  const auto table = arrays.read<double>("kintree_table", {2, -1}, &shape);
  const auto joints = static_cast<std::size_t>(shape[1]);
  std::vector<int> parents;
  for (std::size_t j = 0; j < joints; ++j) {
    if (table[joints + j] != static_cast<double>(j)) {
      raise<io_error>(403, arrays.file(), ": 'kintree_table' calls joint ", j, " ", table[joints + j]);
    }
    if (j > 0 && !(table[j] >= 0 && table[j] < static_cast<double>(j))) {
      raise<io_error>(403, arrays.file(), ": 'kintree_table': joint ", j, " has parent ", table[j],
                      ", which does not come before it");
    }
    parents.push_back(j == 0 ? -1 : static_cast<int>(table[j]));
  }
  if (joints == 0) raise<io_error>(403, arrays.file(), ": 'kintree_table' has no joints");
  return parents;
}

MOTIONLANG_BODY std::vector<std::array<Index, 3>> body_faces(const BodyArrays& arrays, Index vertices) {
  std::vector<std::array<Index, 3>> faces;
  const auto numbers = arrays.read<std::int64_t>("f", {-1, 3});
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    std::array<Index, 3> face{};
    for (std::size_t c = 0; c < 3; ++c) {
      face[c] = static_cast<Index>(numbers[i + c]);
      if (face[c] < 0 || face[c] >= vertices) {
        raise<io_error>(403, arrays.file(), ": face ", i / 3, " has vertex ", face[c], " of ", vertices);
      }
    }
    faces.push_back(face);
  }
  return faces;
}

MOTIONLANG_BODY Index first_expression(BodyKind kind, Index directions, Index told) {
  if (kind != BodyKind::smplx) return directions;
  if (told > 0) return std::min(told, directions);
  return directions > 300 ? 300 : directions == 20 ? 10 : directions;
}

MOTIONLANG_BODY std::vector<SurfacePoints> rows_of_points(const BodyArrays& arrays, const char* triangles,
                                                          const char* weights,
                                                          std::span<const std::array<Index, 3>> faces) {
  std::vector<SurfacePoints> out;
  if (!arrays.has(triangles)) return out;
  std::vector<Index> shape = arrays.read(triangles).shape;
  if (shape.empty() || shape.size() > 2)
    raise<io_error>(407, arrays.file(), ": '", triangles, "' has ", counted(shape.size(), "axis", "axes"),
                    ", expected 1 or 2");
  const auto numbers = arrays.read<std::int64_t>(triangles, shape);
  const auto columns = static_cast<std::size_t>(shape.back());
  shape.push_back(3);
  const auto shares = arrays.read<double>(weights, shape);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] < 0 || numbers[i] >= std::ssize(faces)) {
      raise<io_error>(403, arrays.file(), ": '", triangles, "' has triangle ", numbers[i], " of ", faces.size());
    }
    if (i % columns == 0) out.emplace_back();
    out.back().corners.push_back(faces[static_cast<std::size_t>(numbers[i])]);
    out.back().weights.push_back({shares[3 * i], shares[3 * i + 1], shares[3 * i + 2]});
  }
  return out;
}

MOTIONLANG_BODY bool readable(const FilePath& path) { return ::access(path.c_str(), R_OK) == 0; }

}  // namespace detail

MOTIONLANG_BODY FilePath find_body_file(const FilePath& root, BodyKind kind, BodyGender gender) {
  if (kind == BodyKind::other) raise<config_error>(101, "find_body_file: a body of kind 'other' has no usual name");
  struct Names {
    const char *small, *large, *letter;
  };
  constexpr Names names[] = {{"neutral", "NEUTRAL", "neutral"}, {"male", "MALE", "m"}, {"female", "FEMALE", "f"}};
  const Names& g = names[static_cast<std::size_t>(gender)];
  constexpr const char* folders[] = {"smpl", "smplh", "smplx"};
  constexpr const char* prefixes[] = {"SMPL_", "SMPLH_", "SMPLX_"};
  const std::string folder = concat_text(root.string(), "/", folders[static_cast<std::size_t>(kind)], "/");
  const std::string usual = concat_text(folder, prefixes[static_cast<std::size_t>(kind)], g.large);
  std::vector<std::string> candidates{usual + ".npz", usual + ".pkl", concat_text(folder, g.small, "/model.npz"),
                                      concat_text(folder, g.small, "/model.pkl")};
  for (const char* model : {"basicmodel_", "basicModel_"}) {
    for (const char* version : {"_lbs_10_207_0_v1.1.0.pkl", "_lbs_10_207_0_v1.0.0.pkl"}) {
      if (kind == BodyKind::smpl) candidates.push_back(concat_text(folder, model, g.letter, version));
    }
  }
  for (const std::string& c : candidates) {
    if (detail::readable(c)) return c;
  }
  const BodyKindInfo& info = body_kinds[static_cast<std::size_t>(kind)];
  raise<io_error>(401, "no ", info.name, " file such as ", usual, kind == BodyKind::smpl ? ".pkl" : ".npz",
                  ": register at ", info.site, " to download it (free for research, no redistribution)");
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_BODY_GLB_HPP  // <motionlang/formats/body_glb.hpp>
#define MOTIONLANG_HAS_FORMATS_BODY_GLB_HPP
/// The user's body in motion: as a GLB file with its skin, and as one OBJ file for each frame.
///
///     write_body_glb("walk.glb", body, motion);                 // moves in every viewer; pose blend shapes are left
///     out
///     write_body_objs("walk.obj", body, motion);                // walk_0000.obj, ...: exactly the model's vertices
///
/// A vertex in a GLB file follows at most four joints: the four largest weights, which is all that SMPL has.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_BODY_MESH_HPP  // <motionlang/formats/detail/body_mesh.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_BODY_MESH_HPP
/// The surface of a body at rest as a mesh with a skin.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_SKINNED_MESH_HPP  // <motionlang/formats/detail/skinned_mesh.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_SKINNED_MESH_HPP
/// A surface that follows joints, as files and pages take it.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// A surface at rest whose vertices follow four joints each. W: std::uint8_t or std::uint16_t, of which the largest is
/// 1.
template <class W>
struct SkinnedMesh {
  std::vector<Vec3<float>> positions, normals;
  std::vector<std::uint16_t> joints;  // four for each vertex
  std::vector<W> weights;             // four for each vertex, together 1
  std::vector<std::uint32_t> triangles;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The four largest weights of a vertex with their joints, as shares of 65535.
struct FourWeights {
  std::array<std::uint16_t, 4> joints{}, weights{};
};
template <class S>
FourWeights four_weights(std::span<const S> row) {
  FourWeights out;
  std::array<double, 4> largest{};
  for (std::size_t j = 0; j < row.size(); ++j) {
    double w = static_cast<double>(row[j]);
    auto joint = static_cast<std::uint16_t>(j);
    for (std::size_t k = 0; k < 4; ++k) {
      if (w > largest[k]) std::swap(w, largest[k]), std::swap(joint, out.joints[k]);
    }
  }
  const double sum = largest[0] + largest[1] + largest[2] + largest[3];
  int left = 65535;
  for (std::size_t k = 4; k-- > 1;) {
    const int share = sum > 0 ? static_cast<int>(std::lround(65535 * largest[k] / sum)) : 0;
    out.weights[k] = static_cast<std::uint16_t>(share);
    if (share == 0) out.joints[k] = 0;
    left -= share;
  }
  out.weights[0] = static_cast<std::uint16_t>(left);
  return out;
}

/// The surface at rest for one shape, with a normal for every vertex: the mean of its faces', by their areas.
template <Backend B>
SkinnedMesh<std::uint16_t> body_mesh(const Body<B>& body, std::span<const typename B::scalar> betas) {
  const BodyModel<B>& model = body.model;
  const auto vertices = static_cast<std::size_t>(model.vertices()), joints = static_cast<std::size_t>(model.joints());
  const auto points = model.v_template.span(), directions = model.shapedirs.span(), weights = model.weights.span();
  SkinnedMesh<std::uint16_t> mesh;
  for (std::size_t v = 0; v < vertices; ++v) {
    std::array<double, 3> p{};
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = static_cast<double>(points[3 * v + c]);
      const std::size_t row = (3 * v + c) * static_cast<std::size_t>(model.shapedirs.size(1));
      for (std::size_t k = 0; k < betas.size(); ++k) p[c] += static_cast<double>(directions[row + k] * betas[k]);
    }
    mesh.positions.push_back(vec_cast<float>(Vec3<double>{p[0], p[1], p[2]}));
    const FourWeights four = four_weights(weights.subspan(v * joints, joints));
    mesh.joints.insert(mesh.joints.end(), four.joints.begin(), four.joints.end());
    mesh.weights.insert(mesh.weights.end(), four.weights.begin(), four.weights.end());
  }
  std::vector<Vec3<double>> normals(vertices);
  for (const auto& face : body.faces) {
    const auto at = [&](std::size_t k) { return vec_cast<double>(mesh.positions[static_cast<std::size_t>(face[k])]); };
    const Vec3<double> area = cross(at(1) - at(0), at(2) - at(0));
    for (const Index v : face) {
      normals[static_cast<std::size_t>(v)] = normals[static_cast<std::size_t>(v)] + area;
      mesh.triangles.push_back(static_cast<std::uint32_t>(v));
    }
  }
  for (const Vec3<double>& n : normals) {
    mesh.normals.push_back(vec_cast<float>(norm(n) > 0 ? normalized(n) : Vec3<double>{0, 1, 0}));
  }
  return mesh;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_FORMATS_GLB_WRITER_HPP  // <motionlang/formats/glb_writer.hpp>
#define MOTIONLANG_HAS_FORMATS_GLB_WRITER_HPP
/// GLB files (glTF 2.0) for viewers, engines and Blender: a skinned figure of round cones with animations. Y up,
/// metres, seconds, facing +Z: the library's own conventions.

MOTIONLANG_NAMESPACE_BEGIN

struct GlbWriteOptions {
  Vec3<double> colour{0.62, 0.66, 0.72};  // of the body: red, green, blue, linear, 0 to 1
  double roughness = 0.85;                // 1: matt
};

namespace detail {

/// Throws  config_error 101 without any motion or frame, 102 if skeletons differ; what Motion::validate throws
void require_glb_motions(std::span<const Motion> motions);

/// The motions, of which require_glb_motions approves, with the mesh that their skeleton moves.
std::vector<std::byte> skinned_glb(std::span<const Motion> motions, const SkinnedMesh<std::uint8_t>& mesh,
                                   const char* name, const GlbWriteOptions& options);
std::vector<std::byte> skinned_glb(std::span<const Motion> motions, const SkinnedMesh<std::uint16_t>& mesh,
                                   const char* name, const GlbWriteOptions& options);

}  // namespace detail

/// The bytes of a GLB file with one animation for every motion; all on the same skeleton. The user's own body instead
/// of the figure: body_glb.hpp.
/// Throws  config_error 101 without any motion or frame, or for an impossible frame rate; 102 if skeletons differ; what
///         Motion::validate throws
std::vector<std::byte> glb_bytes(std::span<const Motion> motions, const GlbWriteOptions& options = {});

/// Throws io_error 401, and what glb_bytes throws.
void write_glb(const FilePath& path, std::span<const Motion> motions, const GlbWriteOptions& options = {});
void write_glb(const FilePath& path, const Motion& motion, const GlbWriteOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_GLB_WRITER_IPP  // <motionlang/formats/glb_writer.ipp>
#define MOTIONLANG_HAS_FORMATS_GLB_WRITER_IPP
// Bodies of glb_writer.hpp.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_MESH_HPP  // <motionlang/formats/detail/figure_mesh.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_MESH_HPP
/// Triangles of a figure: every round cone a closed surface of its own, in the rest pose.

#ifndef MOTIONLANG_HAS_FORMATS_FIGURE_HPP  // <motionlang/formats/figure.hpp>
#define MOTIONLANG_HAS_FORMATS_FIGURE_HPP
/// A body for any skeleton: round cones along the bones, thick where much hangs on them, and a head. It is what the
/// film strip, the viewer and GLB files show. Only the search for the head looks at names.

MOTIONLANG_NAMESPACE_BEGIN

/// The hull of two spheres that move with one joint. All in the frame of the joint, metres.
struct RoundCone {
  int joint = 0;
  Vec3<double> from, to;
  double radius_from = 0, radius_to = 0;
  Side side = Side::middle;
};

struct Figure {
  std::vector<RoundCone> cones;
  double size = 1;  // about the height of the body
};

/// The body of a skeleton; proportions are those of a person, from bone lengths alone. A bone belongs to the joint from
/// which it goes out, so each cone turns with that joint.
Figure make_figure(const Skeleton& skeleton);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_FIGURE_IPP  // <motionlang/formats/figure.ipp>
#define MOTIONLANG_HAS_FORMATS_FIGURE_IPP
// Bodies of figure.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// What the shape of a skeleton says about each joint.
struct Anatomy {
  std::vector<Vec3<double>> rest;
  std::vector<double> reach;  // length of the longest chain of bones below the joint
  std::vector<bool> trunk;    // several limbs hang on it: from the pelvis to the shoulders
  std::vector<bool> hidden;   // the bone to it is not drawn: above the pelvis, or inside the head
  std::vector<Side> side;     // from the names; if they tell nothing, from the rest pose
  int head = -1;
  double size = 0;  // about the height of a person

  explicit Anatomy(const Skeleton& s) : rest(s.rest_positions()) {
    const auto joints = static_cast<std::size_t>(s.size());
    reach.assign(joints, 0.0);
    trunk.assign(joints, false);
    hidden.assign(joints, false);
    find_trunk(s);
    find_head(s);
    for (const std::string& name : s.names) side.push_back(side_of_name(name));
    const bool named = std::any_of(side.begin(), side.end(), [](Side x) { return x != Side::middle; });
    for (std::size_t j = 0; j < joints && !named; ++j) {
      const double x = rest[j].x - rest[0].x;
      if (std::abs(x) > 0.02 * size) side[j] = x > 0 ? Side::left : Side::right;
    }
  }

 private:
  /// The measure of a body is a leg: the longest chain that has one as long beside it. Limbs are chains of a third of
  /// it; joints on which two of them hang, and all above these, are the trunk. Bones that lead to the first such joint
  /// (from a root on the floor, say) are hidden.
  void find_trunk(const Skeleton& s) {
    std::vector<double> second(reach.size(), 0.0);  // length of the second longest chain below the joint
    for (std::size_t j = reach.size(); j-- > 1;) {
      const auto p = static_cast<std::size_t>(s.parents[j]);
      const double chain = reach[j] + norm(s.offsets[j]);
      second[p] = std::max(second[p], std::min(reach[p], chain));
      reach[p] = std::max(reach[p], chain);
    }
    const double leg = *std::max_element(second.begin(), second.end());
    size = leg > 0 ? 1.5 * leg : reach[0] > 0 ? reach[0] : 1;
    std::size_t first = 0;
    for (std::size_t j = reach.size(); j-- > 0 && leg > 0;) {
      if (second[j] > leg / 3) trunk[j] = true, first = j;
      if (trunk[j] && j > 0) trunk[static_cast<std::size_t>(s.parents[j])] = true;
    }
    for (std::size_t j = 1; j <= first; ++j) hidden[j] = trunk[j];
  }

  /// The first joint with "head" in its name, else the highest joint that is no part of the trunk, if it is above it.
  void find_head(const Skeleton& s) {
    auto is_named = [](std::string name) {
      for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return name.find("head") != std::string::npos;
    };
    int highest = 0;
    for (int j = 1; j < s.size(); ++j) {
      if (head < 0 && is_named(s.name(j))) head = j;
      if (rest[static_cast<std::size_t>(j)].y > rest[static_cast<std::size_t>(highest)].y) highest = j;
    }
    if (head < 0 && trunk[0] && !trunk[static_cast<std::size_t>(highest)]) head = highest;
    if (head < 0) return;
    for (auto j = static_cast<std::size_t>(head) + 1; j < hidden.size(); ++j) {
      const int p = s.parents[j];
      if (p == head || (p > head && hidden[static_cast<std::size_t>(p)])) hidden[j] = true;
    }
  }
};

/// A foot is a bone near the floor that ends there and goes forward: it gets a sole from the heel to the tip of the
/// toes.
inline std::optional<RoundCone> sole(const Anatomy& anatomy, const RoundCone& bone, double reach) {
  const double unit = anatomy.size / 1.6, start = anatomy.rest[static_cast<std::size_t>(bone.joint)].y;
  const auto lower = [](const Vec3<double>& a, const Vec3<double>& b) { return a.y < b.y; };
  const double floor = std::min_element(anatomy.rest.begin(), anatomy.rest.end(), lower)->y;
  const Vec3<double> forward{bone.to.x, 0, bone.to.z};
  if (start - floor > 0.15 * unit || reach > 0.12 * unit || bone.side == Side::middle) return std::nullopt;
  if (norm(forward) < 0.05 * unit) return std::nullopt;
  return RoundCone{bone.joint, bone.to - 1.25 * forward, bone.to + 0.3 * forward, 0.034 * unit, 0.026 * unit,
                   bone.side};
}

}  // namespace detail

MOTIONLANG_BODY Figure make_figure(const Skeleton& skeleton) {
  const detail::Anatomy anatomy(skeleton);
  const double unit = anatomy.size / 1.6;  // 1 for a grown-up: the span of the arms in joints
  const double trunk_radius = 0.122 * unit;
  auto limb_radius = [&](std::size_t j) { return std::min(0.030 * unit + 0.052 * anatomy.reach[j], 0.078 * unit); };
  auto is_middle = [&](std::size_t j) { return std::abs(anatomy.rest[j].x - anatomy.rest[0].x) < 0.02 * anatomy.size; };

  Figure figure{{}, anatomy.size};
  for (int joint = 1; joint < skeleton.size(); ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    const auto p = static_cast<std::size_t>(skeleton.parents[j]);
    const double length = norm(skeleton.offsets[j]);
    if (anatomy.hidden[j] || length < 1e-4 * anatomy.size) continue;
    RoundCone cone{skeleton.parents[j], {}, skeleton.offsets[j], limb_radius(p), limb_radius(j), Side::middle};
    if (anatomy.trunk[j]) {
      cone.radius_from = cone.radius_to = trunk_radius;
    } else if (anatomy.trunk[p]) {  // hips, collars, neck: the ends of the trunk, a little inside the limb that follows
      cone.radius_from = 0.85 * trunk_radius;
      cone.radius_to *= 0.97;
    } else if (anatomy.reach[j] + length < 0.2 * unit && !is_middle(j)) {  // fingers, toes, tips: thinner than long
      cone.radius_to = std::min(cone.radius_to, 0.4 * length);
      cone.radius_from = std::min(cone.radius_from, std::max(cone.radius_to, 0.5 * length));
    }
    if (is_middle(j) && !anatomy.trunk[j]) cone.radius_to = std::max(cone.radius_to, 0.045 * unit);  // neck
    if (!anatomy.trunk[p]) cone.side = anatomy.side[j];
    figure.cones.push_back(cone);
    if (const auto sole = detail::sole(anatomy, cone, anatomy.reach[j])) figure.cones.push_back(*sole);
  }
  for (std::size_t j = 0; j < skeleton.ends.size(); ++j) {  // feet without joints of toes
    if (anatomy.reach[j] > 0) continue;
    const RoundCone cone{static_cast<int>(j), {}, skeleton.ends[j], limb_radius(j), limb_radius(j), anatomy.side[j]};
    if (const auto sole = detail::sole(anatomy, cone, 0)) figure.cones.insert(figure.cones.end(), {cone, *sole});
  }
  if (anatomy.head >= 0) {
    const Vec3<double> up = normalized(skeleton.offset(anatomy.head));
    figure.cones.push_back(
        {anatomy.head, 0.035 * unit * up, 0.105 * unit * up, 0.078 * unit, 0.092 * unit, Side::middle});
  }
  if (figure.cones.empty()) figure.cones.push_back({0, {}, {}, 0.06 * unit, 0.06 * unit, Side::middle});
  return figure;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

struct FigureMesh {
  std::vector<Vec3<float>> positions, normals;
  std::vector<std::uint16_t> joints;     // of each vertex: the one that moves it
  std::vector<std::uint32_t> triangles;  // three vertices each, counter-clockwise from outside
};

FigureMesh make_mesh(const Figure& figure, const Skeleton& skeleton);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_MESH_IPP  // <motionlang/formats/detail/figure_mesh.ipp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_MESH_IPP
// Bodies of figure_mesh.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Adds the surface of a cone: rings from the pole beyond `from` to the pole beyond `to`.
///     position = centre + r n,   n = cos(latitude) (cos a u + sin a v) + sin(latitude) axis
/// The straight part touches both spheres at the latitude s with sin s = (r_from - r_to) / length.
inline void add_round_cone(FigureMesh& mesh, const RoundCone& cone, const Vec3<double>& origin) {
  constexpr int around = 16, rings = 5;  // of each half
  constexpr double half_pi = std::numbers::pi / 2;
  const Vec3<double> bone = cone.to - cone.from;
  const double length = norm(bone), difference = cone.radius_from - cone.radius_to;
  const Vec3<double> axis = length > 1e-9 ? normalized(bone) : Vec3<double>{0, 1, 0};
  const Vec3<double> u =
      normalized(cross(axis, std::abs(axis.y) < 0.9 ? Vec3<double>{0, 1, 0} : Vec3<double>{1, 0, 0}));
  const Vec3<double> v = cross(axis, u);
  const double seam =
      std::abs(difference) < length ? std::asin(difference / length) : std::copysign(half_pi, difference);

  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int ring = 0; ring < 2 * (rings + 1); ++ring) {
    const bool start = ring <= rings;
    const double share = static_cast<double>(start ? ring : ring - rings - 1) / rings;
    const double latitude = start ? -half_pi + share * (seam + half_pi) : seam + share * (half_pi - seam);
    for (int k = 0; k < around; ++k) {
      const double a = 2 * std::numbers::pi * k / around;
      const Vec3<double> n = std::cos(latitude) * (std::cos(a) * u + std::sin(a) * v) + std::sin(latitude) * axis;
      const Vec3<double> centre = origin + (start ? cone.from : cone.to);
      mesh.positions.push_back(vec_cast<float>(centre + (start ? cone.radius_from : cone.radius_to) * n));
      mesh.normals.push_back(vec_cast<float>(n));
      mesh.joints.push_back(static_cast<std::uint16_t>(cone.joint));
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < 2 * (rings + 1); ++ring) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t a = first + ring * around + k, b = first + ring * around + (k + 1) % around;
      if (ring > 0) mesh.triangles.insert(mesh.triangles.end(), {a, b, a + around});  // else a = b: the pole
      if (ring < 2 * rings) mesh.triangles.insert(mesh.triangles.end(), {b, b + around, a + around});
    }
  }
}

MOTIONLANG_BODY FigureMesh make_mesh(const Figure& figure, const Skeleton& skeleton) {
  const std::vector<Vec3<double>> rest = skeleton.rest_positions();
  FigureMesh mesh;
  for (const RoundCone& c : figure.cones) add_round_cone(mesh, c, rest[static_cast<std::size_t>(c.joint)]);
  return mesh;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLB_BUILDER_HPP  // <motionlang/formats/detail/glb_builder.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLB_BUILDER_HPP
/// A GLB file while it is written: document and binary data, and the animations in them.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLB_CONTAINER_HPP  // <motionlang/formats/detail/glb_container.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLB_CONTAINER_HPP
/// The two chunks of a GLB file: a JSON document and binary data. A .gltf file is the document alone. Source: glTF 2.0,
/// section 4.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::uint32_t glb_magic = 0x46546C67u, glb_json = 0x4E4F534Au, glb_binary = 0x004E4942u;

// NOLINTNEXTLINE(bugprone-exception-escape): a document moves without throwing
struct GlbChunks {
  std::string_view text;  // of the document, in the bytes that were parsed
  nlohmann::json document;
  std::span<const std::byte> binary;  // of the bytes that were parsed
};

/// Throws  io_error 402 if the file ends too early, 403 if it is malformed, 404 for another version
inline GlbChunks parse_glb_chunks(std::span<const std::byte> bytes, std::string_view file) {
  const std::string_view all = as_text(bytes);
  if (all.substr(0, all.find_first_not_of(" \t\r\n") + 1).ends_with('{')) return {all, parse_json(all, file), {}};
  const auto number = [&](std::uint64_t at) { return load<std::uint32_t>(bytes, at, file, "GLB header"); };
  if (number(0) != glb_magic) raise<io_error>(403, file, ": not a GLB file (byte 0)");
  if (number(4) != 2) raise<io_error>(404, file, ": glTF version ", number(4), " at byte 4");
  if (number(8) > bytes.size()) {
    raise<io_error>(402, file, ": ", counted(number(8), "byte"), " announced at byte 8, the file has ", bytes.size());
  }
  bytes = bytes.first(number(8));

  GlbChunks chunks;
  std::uint64_t at = 12;
  for (int i = 0; at < bytes.size(); ++i) {
    const auto chunk = slice(bytes, at + 8, number(at), file, "GLB chunk");
    const std::uint32_t kind = number(at + 4);
    if (i == 0 && kind != glb_json) raise<io_error>(403, file, ": the first chunk at byte ", at, " is not JSON");
    if (i == 0) chunks.text = as_text(chunk), chunks.document = parse_json(chunks.text, file);
    if (i == 1 && kind == glb_binary) chunks.binary = chunk;
    at += 8 + chunk.size();
  }
  if (chunks.document.is_null()) raise<io_error>(402, file, ": no JSON chunk");
  return chunks;
}

/// Chunks are filled up to multiples of four: text with spaces, data with zeros. Throws io_error 405 from 4 GiB on.
inline std::vector<std::byte> glb_file(std::string document, std::vector<std::byte> binary) {
  document.append((4 - document.size() % 4) % 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4);
  const std::uint64_t total = 12 + 8 + document.size() + 8 + binary.size();
  if (total > 0xFFFFFFFFu) raise<io_error>(405, "GLB: ", counted(total, "byte"), " do not fit into one file");
  std::vector<std::byte> out;
  out.reserve(total);
  for (const std::uint32_t n :
       {glb_magic, 2u, static_cast<std::uint32_t>(total), static_cast<std::uint32_t>(document.size()), glb_json}) {
    append_value(out, n);
  }
  append_text(out, document);
  append_value(out, static_cast<std::uint32_t>(binary.size()));
  append_value(out, glb_binary);
  append_bytes(out, binary);
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Builds the document and the binary chunk side by side. Every accessor has a view of its own, aligned to four bytes.
class GlbBuilder {
 public:
  nlohmann::ordered_json document{{"asset", {{"version", "2.0"}, {"generator", "motionlang " MOTIONLANG_VERSION}}},
                                  {"scene", 0},
                                  {"scenes", nlohmann::ordered_json::array()},
                                  {"nodes", nlohmann::ordered_json::array()},
                                  {"meshes", nlohmann::ordered_json::array()},
                                  {"materials", nlohmann::ordered_json::array()},
                                  {"skins", nlohmann::ordered_json::array()},
                                  {"animations", nlohmann::ordered_json::array()},
                                  {"accessors", nlohmann::ordered_json::array()},
                                  {"bufferViews", nlohmann::ordered_json::array()}};

  GlbBuilder() = default;
  /// Goes on with a file that is there: its document, whose only buffer in the file is the first, and its binary data.
  GlbBuilder(nlohmann::ordered_json file, std::span<const std::byte> binary)
      : document(std::move(file)), binary_(binary.begin(), binary.end()) {}

  enum Target { none = 0, attributes = 34962, indices = 34963 };
  template <class T>
  static constexpr int component_type = std::same_as<T, float>           ? 5126
                                        : std::same_as<T, std::uint32_t> ? 5125
                                        : std::same_as<T, std::uint16_t> ? 5123
                                                                         : 5121;

  /// Stores values and gives the number of their accessor. `with_range`: the smallest and largest of every component.
  /// Throws numeric_error 301 at a number that single precision cannot hold.
  template <class T>
  std::size_t add(std::span<const T> values, const char* type, Target target, bool with_range = false) {
    const std::size_t components = std::string_view(type) == "SCALAR" ? 1
                                   : std::string_view(type) == "VEC3" ? 3
                                   : std::string_view(type) == "VEC4" ? 4
                                                                      : 16;
    if constexpr (std::same_as<T, float>) {
      if (!std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); }))
        raise<numeric_error>(301, "GLB: a number is too large for single precision");
    }
    binary_.resize((binary_.size() + 3) / 4 * 4);
    nlohmann::ordered_json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", values.size_bytes()}};
    if (target != none) view["target"] = static_cast<int>(target);
    append_bytes(binary_, std::as_bytes(values));
    nlohmann::ordered_json accessor{{"bufferView", document["bufferViews"].size()},
                                    {"componentType", component_type<T>},
                                    {"count", values.size() / components},
                                    {"type", type}};
    for (std::size_t c = 0; with_range && c < components; ++c) {
      T low = values[c], high = values[c];
      for (std::size_t i = c; i < values.size(); i += components) {
        low = std::min(low, values[i]);
        high = std::max(high, values[i]);
      }
      accessor["min"].push_back(low);
      accessor["max"].push_back(high);
    }
    document["bufferViews"].push_back(std::move(view));
    document["accessors"].push_back(std::move(accessor));
    return document["accessors"].size() - 1;
  }
  std::size_t add(std::span<const Vec3<float>> values, Target target, bool with_range = false) {
    static_assert(sizeof(Vec3<float>) == 3 * sizeof(float));
    std::vector<float> flat;
    for (const Vec3<float>& v : values) flat.insert(flat.end(), {v.x, v.y, v.z});
    return add(std::span<const float>(flat), "VEC3", target, with_range);
  }

  /// Takes the binary data from byte `size` on away.
  void cut(std::size_t size) { binary_.resize(std::min(size, binary_.size())); }

  std::vector<std::byte> finish() {
    if (document["buffers"].empty()) document["buffers"].push_back(nlohmann::ordered_json::object());
    document["buffers"][0]["byteLength"] = binary_.size();
    constexpr auto repair = nlohmann::ordered_json::error_handler_t::replace;  // names that are not UTF-8
    return glb_file(document.dump(-1, ' ', false, repair), std::move(binary_));
  }

 private:
  std::vector<std::byte> binary_;
};

inline nlohmann::ordered_json to_json(const Vec3<double>& v) { return nlohmann::ordered_json::array({v.x, v.y, v.z}); }

/// Rotation of one joint over time as x, y, z, w: unit quaternions, each on the side of the one before.
inline std::vector<float> rotation_track(const Motion& motion, std::size_t joint) {
  std::vector<float> out;
  Quaternion<double> before = Quaternion<double>::identity();
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    Quaternion<double> q = normalized(motion.rotations(frame)[joint]);
    if (dot(before, q) < 0) q = -q;
    before = q;
    for (const double x : {q.x, q.y, q.z, q.w}) out.push_back(static_cast<float>(x));
  }
  return out;
}

/// nodes   that of every joint, -1 for a joint that gets no channel; rotations are relative to the node's parent
/// Throws  config_error 101 if two frames fall on the same time in single precision
inline void add_animation(GlbBuilder& glb, const Motion& motion, std::span<const int> nodes) {
  std::vector<float> times;
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    times.push_back(static_cast<float>(static_cast<double>(frame) / motion.fps));
    if (frame > 0 && !(times.back() > times[times.size() - 2])) {
      raise<config_error>(101, "GLB: frames ", frame - 1, " and ", frame, " of '", motion.name,
                          "' have the same time at ", motion.fps, " frames per second");
    }
  }
  const std::size_t input = glb.add(std::span<const float>(times), "SCALAR", GlbBuilder::none, true);
  nlohmann::ordered_json animation{{"name", motion.name.empty() ? "motion" : motion.name},
                                   {"channels", nlohmann::ordered_json::array()},
                                   {"samplers", nlohmann::ordered_json::array()}};
  auto add_channel = [&](int node, const char* path, std::size_t output) {
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    animation["samplers"].push_back({{"input", input}, {"interpolation", "LINEAR"}, {"output", output}});
  };
  std::vector<Vec3<float>> root;
  for (const Vec3<double>& p : motion.root) root.push_back(vec_cast<float>(p));
  add_channel(nodes[0], "translation", glb.add(root, GlbBuilder::none));
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    if (nodes[j] < 0) continue;
    const std::vector<float> track = rotation_track(motion, j);
    add_channel(nodes[j], "rotation", glb.add(std::span<const float>(track), "VEC4", GlbBuilder::none));
  }
  glb.document["animations"].push_back(std::move(animation));
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Node j is joint j; rest rotations are the identity.
inline void add_joints(GlbBuilder& glb, const Skeleton& skeleton) {
  for (int j = 0; j < skeleton.size(); ++j) {
    nlohmann::ordered_json node{{"name", skeleton.name(j)}, {"translation", to_json(skeleton.offset(j))}};
    for (const int child : skeleton.children(j)) node["children"].push_back(child);
    glb.document["nodes"].push_back(std::move(node));
  }
}

/// The figure of a skeleton: every vertex moves with one joint.
inline SkinnedMesh<std::uint8_t> figure_skin(const Skeleton& skeleton) {
  FigureMesh mesh = make_mesh(make_figure(skeleton), skeleton);
  SkinnedMesh<std::uint8_t> out{std::move(mesh.positions), std::move(mesh.normals), {}, {}, std::move(mesh.triangles)};
  for (const std::uint16_t j : mesh.joints) {
    out.joints.insert(out.joints.end(), {j, 0, 0, 0});
    out.weights.insert(out.weights.end(), {255, 0, 0, 0});
  }
  return out;
}

/// A mesh bound to the joints, in a node of its own at the root of the scene.
template <class W>
void add_mesh(GlbBuilder& glb, const Skeleton& skeleton, const SkinnedMesh<W>& mesh, const char* name,
              const GlbWriteOptions& options) {
  const std::size_t weights_accessor = glb.add(std::span<const W>(mesh.weights), "VEC4", GlbBuilder::attributes);
  glb.document["accessors"][weights_accessor]["normalized"] = true;
  const nlohmann::ordered_json primitive{
      {"attributes",
       {{"POSITION", glb.add(mesh.positions, GlbBuilder::attributes, true)},
        {"NORMAL", glb.add(mesh.normals, GlbBuilder::attributes)},
        {"JOINTS_0", glb.add(std::span<const std::uint16_t>(mesh.joints), "VEC4", GlbBuilder::attributes)},
        {"WEIGHTS_0", weights_accessor}}},
      {"indices", glb.add(std::span<const std::uint32_t>(mesh.triangles), "SCALAR", GlbBuilder::indices)},
      {"material", 0}};

  std::vector<float> inverse_bind;
  for (const Vec3<double>& p : skeleton.rest_positions()) {  // column by column: the translation by -p
    const Vec3<float> t = vec_cast<float>(-p);
    inverse_bind.insert(inverse_bind.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, t.x, t.y, t.z, 1});
  }
  nlohmann::ordered_json skin{
      {"inverseBindMatrices", glb.add(std::span<const float>(inverse_bind), "MAT4", GlbBuilder::none)},
      {"skeleton", 0}};
  for (int j = 0; j < skeleton.size(); ++j) skin["joints"].push_back(j);

  nlohmann::ordered_json& document = glb.document;
  document["materials"].push_back(
      {{"name", "body"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor",
          nlohmann::ordered_json::array({options.colour.x, options.colour.y, options.colour.z, 1.0})},
         {"metallicFactor", 0.0},
         {"roughnessFactor", options.roughness}}}});
  document["meshes"].push_back({{"name", name}, {"primitives", nlohmann::ordered_json::array({primitive})}});
  document["skins"].push_back(std::move(skin));
  document["nodes"].push_back({{"name", name}, {"mesh", 0}, {"skin", 0}});
  document["scenes"].push_back({{"nodes", nlohmann::ordered_json::array({0, skeleton.size()})}});
}

MOTIONLANG_BODY void require_glb_motions(std::span<const Motion> motions) {
  if (motions.empty()) raise<config_error>(101, "GLB: no motion to write");
  const Skeleton& skeleton = motions.front().skeleton;
  for (const Motion& motion : motions) {
    motion.validate();
    if (motion.frames() == 0) raise<config_error>(101, "GLB: motion '", motion.name, "' has no frames");
    if (motion.skeleton != skeleton) {
      raise<config_error>(102, "GLB: motions '", motions.front().name, "' and '", motion.name,
                          "' have different skeletons");
    }
  }
  if (skeleton.size() > 65535) raise<config_error>(101, "GLB: ", counted(skeleton.size(), "joint"));
}

template <class W>
std::vector<std::byte> glb_of_mesh(std::span<const Motion> motions, const SkinnedMesh<W>& mesh, const char* name,
                                   const GlbWriteOptions& options) {
  const Skeleton& skeleton = motions.front().skeleton;
  GlbBuilder glb;
  add_joints(glb, skeleton);
  add_mesh(glb, skeleton, mesh, name, options);
  std::vector<int> nodes(skeleton.parents.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  for (const Motion& motion : motions) add_animation(glb, motion, nodes);
  return glb.finish();
}

MOTIONLANG_BODY std::vector<std::byte> skinned_glb(std::span<const Motion> motions,
                                                   const SkinnedMesh<std::uint8_t>& mesh, const char* name,
                                                   const GlbWriteOptions& options) {
  return glb_of_mesh(motions, mesh, name, options);
}

MOTIONLANG_BODY std::vector<std::byte> skinned_glb(std::span<const Motion> motions,
                                                   const SkinnedMesh<std::uint16_t>& mesh, const char* name,
                                                   const GlbWriteOptions& options) {
  return glb_of_mesh(motions, mesh, name, options);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::byte> glb_bytes(std::span<const Motion> motions, const GlbWriteOptions& options) {
  detail::require_glb_motions(motions);
  return detail::skinned_glb(motions, detail::figure_skin(motions.front().skeleton), "figure", options);
}

MOTIONLANG_BODY void write_glb(const FilePath& path, std::span<const Motion> motions, const GlbWriteOptions& options) {
  write_file(path, glb_bytes(motions, options));
}

MOTIONLANG_BODY void write_glb(const FilePath& path, const Motion& motion, const GlbWriteOptions& options) {
  write_glb(path, std::span(&motion, 1), options);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_OBJ_HPP  // <motionlang/formats/obj.hpp>
#define MOTIONLANG_HAS_FORMATS_OBJ_HPP
/// Wavefront OBJ: a surface in one pose, for every program that shows meshes. Y up, metres.

MOTIONLANG_NAMESPACE_BEGIN

/// vertices (V, 3), one after the other; faces: three vertices each, counted from 0.
/// Throws shape_error 205 if vertices are not triples or a face names a vertex that does not exist, numeric_error 301
template <class S>
std::string obj_text(std::span<const S> vertices, std::span<const std::array<Index, 3>> faces) {
  if (vertices.size() % 3 != 0)
    raise<shape_error>(205, "OBJ: ", counted(vertices.size(), "coordinate"), " of vertices");
  const auto count = static_cast<Index>(vertices.size()) / 3;
  std::string out;
  for (std::size_t i = 0; i < vertices.size(); i += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(vertices[i + c] - vertices[i + c] == 0)) raise<numeric_error>(301, "OBJ: vertex ", i / 3, " is not finite");
    }
    out += concat_text("v ", vertices[i], " ", vertices[i + 1], " ", vertices[i + 2], "\n");
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (const Index v : faces[i]) {
      if (v < 0 || v >= count) raise<shape_error>(205, "OBJ: face ", i, " has vertex ", v, " of ", count);
    }
    out += concat_text("f ", faces[i][0] + 1, " ", faces[i][1] + 1, " ", faces[i][2] + 1, "\n");
  }
  return out;
}

/// Throws io_error 401, and what obj_text throws.
template <class S>
void write_obj(const FilePath& path, std::span<const S> vertices, std::span<const std::array<Index, 3>> faces) {
  write_file(path, obj_text(vertices, faces));
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// motions  as motion_on_body takes them
/// Throws   what glb_bytes and motion_on_body throw; config_error 101 for a body without faces
template <Backend B>
std::vector<std::byte> body_glb_bytes(const Body<B>& body, std::span<const Motion> motions,
                                      std::span<const typename B::scalar> betas = {},
                                      const GlbWriteOptions& options = {}) {
  if (body.faces.empty()) raise<config_error>(101, "GLB: the body has no faces");
  std::vector<Motion> own;
  for (const Motion& m : motions) own.push_back(motion_on_body(body, m, betas));
  detail::require_glb_motions(own);
  return detail::skinned_glb(own, detail::body_mesh(body, betas), "body", options);
}
/// Throws io_error 401, and what body_glb_bytes throws.
template <Backend B>
void write_body_glb(const FilePath& path, const Body<B>& body, std::span<const Motion> motions,
                    std::span<const typename B::scalar> betas = {}, const GlbWriteOptions& options = {}) {
  write_file(path, body_glb_bytes(body, motions, betas, options));
}

/// One file for each frame, "walk.obj" becoming walk_0000.obj, walk_0001.obj, ... Returns how many.
/// Throws io_error 401, and what motion_on_body, pose_body and obj_text throw.
template <Backend B>
Index write_body_objs(const FilePath& path, const Body<B>& body, const Motion& motion,
                      std::span<const typename B::scalar> betas = {}) {
  const std::string& name = path.string();
  const std::string stem = name.ends_with(".obj") ? name.substr(0, name.size() - 4) : name;
  const Motion own = motion_on_body(body, motion, betas);
  const std::span<const std::array<Index, 3>> faces(body.faces);
  constexpr Index at_once = 32;
  for (Index first = 0; first < own.frames(); first += at_once) {
    const Index end = std::min(own.frames(), first + at_once);
    Motion part{own.skeleton, own.fps, {}, {}, own.name};
    part.root.assign(own.root.begin() + first, own.root.begin() + end);
    part.local.assign(own.local.begin() + first * own.skeleton.size(), own.local.begin() + end * own.skeleton.size());
    const PosedBody<B> posed = pose_body(body.model, part, betas);
    const auto width = static_cast<std::size_t>(3 * body.model.vertices());
    for (Index f = first; f < end; ++f) {
      std::string number = std::to_string(f);
      if (number.size() < 4) number.insert(0, 4 - number.size(), '0');
      write_obj(stem + "_" + number + ".obj",
                std::span<const typename B::scalar>(posed.vertices.span())
                    .subspan(static_cast<std::size_t>(f - first) * width, width),
                faces);
    }
  }
  return own.frames();
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_FORMATS_BVH_HPP  // <motionlang/formats/bvh.hpp>
#define MOTIONLANG_HAS_FORMATS_BVH_HPP
/// BVH files as motions: what their channels mean, and how to write them so that all programs read them.
///
/// The format has no units and no up axis: reading takes metres per unit and expects Y up. Meaning of the channels:
/// "Zrotation Xrotation Yrotation" is R = Rz Rx Ry on column vectors (the first named is the outermost); a position
/// channel replaces that coordinate of the OFFSET.

#ifndef MOTIONLANG_HAS_FORMATS_BVH_TEXT_HPP  // <motionlang/formats/bvh_text.hpp>
#define MOTIONLANG_HAS_FORMATS_BVH_TEXT_HPP
/// BVH files (Biovision hierarchy) as they stand: hierarchy, channels and numbers, read and written without loss. What
/// they mean as a `Motion` is in bvh.hpp.

MOTIONLANG_NAMESPACE_BEGIN

/// One column of the motion table. The axis is value % 3.
enum class BvhChannel : std::uint8_t { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };
constexpr bool is_rotation(BvhChannel c) { return c >= BvhChannel::x_rotation; }
constexpr int axis_of(BvhChannel c) { return static_cast<int>(c) % 3; }

/// A ROOT, a JOINT or an End Site.
struct BvhNode {
  std::string name;  // blanks in the file become "_"; of an end site the words after "End", usually "Site"
  int parent = -1;   // number of the node; -1 for a root
  bool end_site = false;
  Vec3<double> offset{};
  std::vector<BvhChannel> channels{};
};

/// A BVH file in its own units: nodes in file order (depth first), the table as it stands, degrees.
/// Laws   parse_bvh(format_bvh(x)) equals x up to the six printed decimals
struct Bvh {
  std::vector<BvhNode> nodes{};
  double frame_time = 1.0 / 30;  // seconds
  Index frames = 0;
  std::vector<double> values{};  // (frames, channels)
  std::string name{};            // of the file, for messages

  Index channels() const {
    std::size_t n = 0;
    for (const BvhNode& node : nodes) n += node.channels.size();
    return static_cast<Index>(n);
  }
  std::span<const double> frame(Index f) const {
    return std::span(values).subspan(static_cast<std::size_t>(f * channels()), static_cast<std::size_t>(channels()));
  }
};

/// Reads the text of a BVH file. Accepts any order and number of channels, positions on every joint, keywords in any
/// case, any line ends, frames broken over lines, names with blanks, names after "End Site", several ROOTs, and joints
/// without channels. Throws io_error 402 (too short), 403 (malformed; also when numbers are left over), 405 (too many
/// joints); messages give file, line and column.
Bvh parse_bvh(std::string_view text, std::string_view name = "BVH text");
/// Throws io_error 401 and as parse_bvh.
Bvh read_bvh(const FilePath& path);

/// The text of a file that strict, line-based readers (Blender's) accept too: one keyword a line, one frame a line, LF,
/// fixed notation with six decimals, nothing after the last frame. The frame time has up to nine decimals.
/// Throws numeric_error 301 for a number that is not finite, 302 for a frame time that would be written as 0.
std::string format_bvh(const Bvh& file);
/// Throws io_error 401, and what format_bvh throws.
void write_bvh(const FilePath& path, const Bvh& file);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_BVH_TEXT_IPP  // <motionlang/formats/bvh_text.ipp>
#define MOTIONLANG_HAS_FORMATS_BVH_TEXT_IPP
// Bodies of bvh_text.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

class BvhParser {
 public:
  BvhParser(std::string_view text, std::string_view name) : scan_(text, name) { bvh_.name = name; }

  Bvh parse() && {
    scan_.expect("hierarchy");
    do {
      root();
    } while (same_word(scan_.peek(), "root"));
    scan_.expect("motion");
    motion();
    return std::move(bvh_);
  }

 private:
  /// One tree, without recursion: `open` holds the node of every brace that is not yet closed.
  void root() {
    scan_.expect("root");
    std::vector<int> open{node(-1, false)};
    while (!open.empty()) {
      const int current = open.back();
      BvhNode& here = bvh_.nodes[static_cast<std::size_t>(current)];
      const std::string_view word = scan_.word("'}'");
      if (word == "}") {
        if (!has_offset_.back()) scan_.fail(403, "'", here.name, "' has no OFFSET");
        open.pop_back();
        has_offset_.pop_back();
      } else if (same_word(word, "offset")) {
        here.offset = {scan_.number("an offset"), scan_.number("an offset"), scan_.number("an offset")};
        has_offset_.back() = true;
      } else if (same_word(word, "channels") && !here.end_site) {
        channels(here);
      } else if (same_word(word, "joint") && !here.end_site) {
        open.push_back(node(current, false));
      } else if (same_word(word, "end") && !here.end_site) {
        open.push_back(node(current, true));
      } else {
        scan_.fail(403, "'", TextScanner::shortened(word), "' does not belong into '", here.name, "'");
      }
    }
  }
  /// Name and opening brace; the number of the new node.
  int node(int parent, bool end_site) {
    std::string name;
    for (std::string_view w = scan_.word("'{'"); w != "{"; w = scan_.word("'{'")) {
      if (w == "}") scan_.fail(403, "expected '{', found '}'");
      if (!name.empty()) name += '_';
      name += w;
    }
    if (name.empty()) scan_.fail(403, "a joint without a name");
    if (bvh_.nodes.size() == max_text_joints) scan_.fail(405, "more than ", max_text_joints, " joints");
    bvh_.nodes.push_back({.name = std::move(name), .parent = parent, .end_site = end_site});
    has_offset_.push_back(false);
    return static_cast<int>(bvh_.nodes.size()) - 1;
  }
  void channels(BvhNode& joint) {
    const auto count = scan_.count<std::size_t>("the number of channels");
    for (std::size_t i = 0; i < count; ++i) {
      joint.channels.push_back(channel());
      if (std::count(joint.channels.begin(), joint.channels.end(), joint.channels.back()) > 1)
        scan_.fail(403, "joint '", TextScanner::shortened(joint.name), "' has a channel twice");
    }
  }
  BvhChannel channel() {
    const std::string_view word = scan_.word("a channel");
    const int axis = lower(word[0]) - 'x';
    const bool rotation = same_word(word.substr(1), "rotation");
    if (axis < 0 || axis > 2 || (!rotation && !same_word(word.substr(1), "position"))) {
      scan_.fail(403, "'", TextScanner::shortened(word), "' is not a channel");
    }
    return static_cast<BvhChannel>(axis + (rotation ? 3 : 0));
  }

  void motion() {
    label("frames");
    bvh_.frames = scan_.count<Index>("the number of frames");
    scan_.expect("frame");
    label("time");
    bvh_.frame_time = scan_.number("the frame time");
    if (!(bvh_.frame_time > 0)) scan_.fail(403, "the frame time is ", bvh_.frame_time, " seconds");
    const auto frames = static_cast<std::size_t>(bvh_.frames), columns = static_cast<std::size_t>(bvh_.channels());
    if (frames != 0 && columns == 0) scan_.fail(403, counted(frames, "frame"), ", but no channels");
    // each number takes at least two bytes, one of them a blank (which the last may lack)
    if (frames != 0 && (scan_.bytes_left() + 1) / 2 / columns < frames) {
      scan_.fail(402, "the text is too short for ", counted(frames, "frame"), " of ", counted(columns, "channel"),
                 ", which it declares");
    }
    bvh_.values.resize(frames * columns);
    for (double& v : bvh_.values) v = scan_.number("a value of the motion");
    if (!scan_.at_end()) {
      const std::string_view extra = scan_.word("the end");
      scan_.fail(403, "'", TextScanner::shortened(extra), "' follows the ", counted(frames, "declared frame"), " of ",
                 counted(columns, "channel"));
    }
  }
  /// "Frames:", "FRAMES :", "frames".
  void label(std::string_view lower_case) {
    if (!scan_.skip_prefix(lower_case)) scan_.expect(lower_case);
    scan_.skip_prefix(":");
  }

  TextScanner scan_;
  Bvh bvh_;
  std::vector<bool> has_offset_;  // of the nodes that are open
};

}  // namespace detail

MOTIONLANG_BODY Bvh parse_bvh(std::string_view text, std::string_view name) {
  return detail::BvhParser(text, name).parse();
}

MOTIONLANG_BODY Bvh read_bvh(const FilePath& path) {
  return parse_bvh(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

namespace detail {

/// Fixed notation, no exponent; never "-0.000000".
inline void append_fixed(std::string& out, double value, int decimals) {
  char digits[400];  // the largest double has 309 digits before the point
  const auto end = detail::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr;
  const std::string_view text(digits, static_cast<std::size_t>(end - digits));
  const bool zero = text.find_first_not_of("-0.") == text.npos;
  out += zero && text[0] == '-' ? text.substr(1) : text;
}
inline void append_fixed(std::string& out, const Vec3<double>& v) {
  for (const double value : {v.x, v.y, v.z}) {
    out += ' ';
    append_fixed(out, value, 6);
  }
}

inline void append_node(std::string& out, const BvhNode& node, int depth) {
  const std::string indent(static_cast<std::size_t>(depth), '\t');
  out += indent + (node.end_site ? "End " : depth == 0 ? "ROOT " : "JOINT ") + node.name + '\n';
  out += indent + "{\n" + indent + "\tOFFSET";
  append_fixed(out, node.offset);
  out += '\n';
  if (node.end_site) return;
  out += indent + "\tCHANNELS " + std::to_string(node.channels.size());
  for (const BvhChannel c : node.channels) {
    out += ' ';
    out += static_cast<char>('X' + axis_of(c));
    out += is_rotation(c) ? "rotation" : "position";
  }
  out += '\n';
}

}  // namespace detail

MOTIONLANG_BODY std::string format_bvh(const Bvh& file) {
  const auto require_finite = [&](double number, const auto&... what) {
    if (!std::isfinite(number)) raise<numeric_error>(301, "BVH: motion '", file.name, "': ", what..., " is ", number);
  };
  require_finite(file.frame_time, "the frame time");
  if (!(file.frame_time >= 1e-9))
    raise<numeric_error>(302, "BVH: motion '", file.name, "': the frame time is ", file.frame_time,
                         " s, expected 1e-09 or more");
  std::string out = "HIERARCHY\n";
  std::vector<int> open;  // nodes whose brace is not closed
  auto close = [&] {
    open.pop_back();
    out += std::string(open.size(), '\t') + "}\n";
  };
  for (std::size_t n = 0; n < file.nodes.size(); ++n) {
    const BvhNode& node = file.nodes[n];
    while (!open.empty() && open.back() != node.parent) close();
    for (const double x : {node.offset.x, node.offset.y, node.offset.z})
      require_finite(x, "a number of the offset of '", node.name, "'");
    detail::append_node(out, node, static_cast<int>(open.size()));
    open.push_back(static_cast<int>(n));
  }
  while (!open.empty()) close();
  out += "MOTION\nFrames: " + std::to_string(file.frames) + "\nFrame Time: ";
  std::string time;
  detail::append_fixed(time, file.frame_time, 9);
  while (time.back() == '0' && time.size() - time.find('.') > 7) time.pop_back();
  out += time + '\n';
  const Index columns = file.channels();
  for (Index f = 0; f < file.frames; ++f) {
    for (Index c = 0; c < columns; ++c) {
      const double value = file.values[static_cast<std::size_t>(f * columns + c)];
      require_finite(value, "number ", c, " of frame ", f);
      detail::append_fixed(out, value, 6);
      out += c + 1 < columns ? ' ' : '\n';
    }
  }
  return out;
}

MOTIONLANG_BODY void write_bvh(const FilePath& path, const Bvh& file) { write_file(path, format_bvh(file)); }

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct BvhReadOptions {
  double scale = 0.01;  // metres per unit of the file; 0.01: the file is in centimetres
  int root = 0;         // which ROOT of a file with several
};

struct BvhWriteOptions {
  double scale = 100;              // units per metre; 100: centimetres (Blender: import with scale 0.01)
  std::string_view order = "ZXY";  // of the rotation channels: three different axes
  // Metres, of the bones after leaf joints where the skeleton has none, but no longer than the bone before: for bones
  // of length 0, Blender invents a length of its own.
  double end_length = 0.1;
};

/// What the file means. End sites are the ends of bones, no joints; joints of one name get numbers ("Hand", "Hand_2").
/// Below the root, positions that change (stretching bones) are replaced by their mean. A root that merely carries
/// another moving root is joined with it, so that the root of the motion is the one that moves.
/// Throws  config_error 101 (scale, number of the root), io_error 405 (far more joints than channels),
///         numeric_error 301 (numbers so large that they overflow)
Motion to_motion(const Bvh& file, const BvhReadOptions& options = {});
/// How many ROOTs the file has: each is a motion of its own.
int bvh_roots(const Bvh& file);
/// Names of the joints below a root that move through positions of their own, as bones that stretch do: to_motion
/// leaves this out. Throws config_error 101 (number of the root).
std::vector<std::string> stretched_joints(const Bvh& file, int root = 0);
/// Throws io_error 401 and as parse_bvh, to_motion.
Motion read_bvh_motion(const FilePath& path, const BvhReadOptions& options = {});

namespace detail {

/// The angles of the same rotation that continue a curve: of the triple and its twin (a + pi, pi - b, c + pi), each
/// plus multiples of 2 pi, the closer one to the frame before.
EulerAngles<double> continue_curve(const EulerAngles<double>& angles, const EulerAngles<double>& before);

/// Joints so that every child follows its parent before any other branch: the order of a BVH file.
std::vector<int> depth_first_order(const Skeleton& skeleton);

}  // namespace detail

/// The motion as a BVH file: root first with OFFSET 0 and three positions, three rotation channels on every joint, an
/// end site behind every leaf. Joints come depth first, whatever their order in the skeleton. Angles follow smooth
/// curves and so may exceed 180 degrees.
/// Throws  config_error 101 (order with an axis twice, scale), 103 (order), shape_error 205 and numeric_error 301
///         (Motion::validate)
Bvh to_bvh(const Motion& motion, const BvhWriteOptions& options = {});
/// Throws io_error 401 and as to_bvh, format_bvh.
void write_bvh(const FilePath& path, const Motion& motion, const BvhWriteOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_BVH_IPP  // <motionlang/formats/bvh.ipp>
#define MOTIONLANG_HAS_FORMATS_BVH_IPP
// Bodies of bvh.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Frame times are printed with few digits: 0.0166667 s means 60 frames per second.
inline double frames_per_second(double frame_time) {
  const double fps = 1 / frame_time, whole = std::round(fps);
  return fps < 1000 && whole > 0 && std::abs(1 / whole - frame_time) < 1e-6 ? whole : fps;
}

inline double& coordinate(Vec3<double>& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// q times the rotation by `angle` about the coordinate axis x, y or z.
inline Quaternion<double> turned(const Quaternion<double>& q, int axis, double angle) {
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
  if (axis == 0) return {q.w * c - q.x * s, q.x * c + q.w * s, q.y * c + q.z * s, q.z * c - q.y * s};
  if (axis == 1) return {q.w * c - q.y * s, q.x * c - q.z * s, q.y * c + q.w * s, q.z * c + q.x * s};
  return {q.w * c - q.z * s, q.x * c + q.y * s, q.y * c - q.x * s, q.z * c + q.w * s};
}

/// Gives every name only once: "Hand", "Hand_2", "Hand_3".
class UniqueNames {
 public:
  std::string operator()(const std::string& name) {
    int& number = next_.try_emplace(name, 1).first->second;
    std::string unique = name;
    for (; !taken_.insert(unique).second; unique = name + "_" + std::to_string(number)) ++number;
    return unique;
  }

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, int> next_;  // the number that was tried last
};

/// A joint of the file with the place of its channels in a frame.
struct BvhJoint {
  const BvhNode* node;
  int number;       // among the nodes
  int parent = -1;  // among the joints that are kept
  std::size_t first_channel;

  bool has_positions() const {
    return std::any_of(node->channels.begin(), node->channels.end(), [](BvhChannel c) { return !is_rotation(c); });
  }
  Vec3<double> translation(std::span<const double> frame) const {
    Vec3<double> t = node->offset;
    for (std::size_t c = 0; c < node->channels.size(); ++c) {
      const BvhChannel channel = node->channels[c];
      if (!is_rotation(channel)) coordinate(t, axis_of(channel)) = frame[first_channel + c];
    }
    return t;
  }
  Quaternion<double> rotation(std::span<const double> frame) const {
    Quaternion<double> q = Quaternion<double>::identity();
    for (std::size_t c = 0; c < node->channels.size(); ++c) {
      const BvhChannel channel = node->channels[c];
      if (is_rotation(channel)) q = turned(q, axis_of(channel), frame[first_channel + c] * degree);
    }
    return q;
  }
};

/// Joints below the chosen root, without end sites, in file order.
inline std::vector<BvhJoint> bvh_joints(const Bvh& file, int root) {
  std::vector<BvhJoint> joints;
  std::vector<int> kept(file.nodes.size(), -1);  // node -> number among `joints`
  std::size_t channel = 0;
  int roots = 0;
  for (std::size_t n = 0; n < file.nodes.size(); ++n) {
    const BvhNode& node = file.nodes[n];
    const int parent = node.parent < 0 ? -1 : kept[static_cast<std::size_t>(node.parent)];
    const bool chosen = node.parent < 0 ? roots++ == root : parent >= 0;
    if (chosen && !node.end_site) {
      kept[n] = static_cast<int>(joints.size());
      joints.push_back({&node, static_cast<int>(n), parent, channel});
    }
    channel += node.channels.size();
  }
  if (joints.empty()) raise<config_error>(101, file.name, ": root ", root, " was asked for, the file has ", roots);
  return joints;
}

/// A table row by row; `Bvh::frame` would count the channels again for every row.
struct BvhTable {
  explicit BvhTable(const Bvh& file)
      : values(file.values), columns(static_cast<std::size_t>(file.channels())), rows(file.frames) {}
  std::span<const double> operator[](Index row) const {
    return values.subspan(static_cast<std::size_t>(row) * columns, columns);
  }
  std::span<const double> values;
  std::size_t columns;
  Index rows;
};

/// Whether the positions of a joint change from frame to frame by more than rounding.
inline bool moves(const BvhJoint& joint, const BvhTable& table) {
  if (!joint.has_positions() || table.rows == 0) return false;
  const Vec3<double> first = joint.translation(table[0]);
  for (Index f = 1; f < table.rows; ++f) {
    if (norm(joint.translation(table[f]) - first) > 1e-4 * (1 + norm(first))) return true;
  }
  return false;
}

/// Takes away the roots that only carry another root (Bandai-Namco's joint_Root, a "Reference" node): while the first
/// joint has one child and that child moves through positions of its own.
inline std::vector<BvhJoint> take_carriers(std::vector<BvhJoint>& joints, const BvhTable& table) {
  std::vector<BvhJoint> carriers;
  auto children = [&] {
    return std::count_if(joints.begin(), joints.end(), [](const BvhJoint& j) { return j.parent == 0; });
  };
  while (joints.size() > 1 && children() == 1 && moves(joints[1], table)) {
    carriers.push_back(joints.front());
    joints.erase(joints.begin());
    for (BvhJoint& j : joints) --j.parent;
  }
  return carriers;
}

/// The offset of a joint below the root; position channels replace it, by their mean (a skeleton has constant bones).
inline Vec3<double> constant_offset(const BvhJoint& joint, const BvhTable& table) {
  if (!joint.has_positions() || table.rows == 0) return joint.node->offset;
  Vec3<double> sum{};
  for (Index f = 0; f < table.rows; ++f) sum = sum + joint.translation(table[f]);
  return (1.0 / static_cast<double>(table.rows)) * sum;
}

/// Where the end sites of the joints are: of several at one joint the first; none if the file has none.
inline std::vector<Vec3<double>> bvh_ends(const Bvh& file, std::span<const BvhJoint> joints, double scale) {
  std::vector<Vec3<double>> ends;
  std::vector<int> joint_of(file.nodes.size(), -1);  // that has no end yet
  for (std::size_t j = 0; j < joints.size(); ++j)
    joint_of[static_cast<std::size_t>(joints[j].number)] = static_cast<int>(j);
  for (const BvhNode& node : file.nodes) {
    if (!node.end_site || node.parent < 0) continue;
    const int joint = std::exchange(joint_of[static_cast<std::size_t>(node.parent)], -1);
    if (joint < 0) continue;
    ends.resize(joints.size());
    ends[static_cast<std::size_t>(joint)] = scale * node.offset;
  }
  return ends;
}

}  // namespace detail

MOTIONLANG_BODY Motion to_motion(const Bvh& file, const BvhReadOptions& options) {
  if (!(options.scale > 0)) raise<config_error>(101, file.name, ": scale ", options.scale);
  const detail::BvhTable table(file);
  auto joints = detail::bvh_joints(file, options.root);
  const auto frames = static_cast<std::size_t>(file.frames);
  if (frames > detail::max_text_rotations(2 * file.values.size()) / joints.size()) {
    raise<io_error>(405, file.name, ": ", counted(frames, "frame"), " of ", counted(joints.size(), "joint"));
  }
  const auto carriers = detail::take_carriers(joints, table);

  Motion motion;
  motion.name = file.name;
  motion.fps = detail::frames_per_second(file.frame_time);
  Skeleton& skeleton = motion.skeleton;
  detail::UniqueNames unique;
  for (const detail::BvhJoint& j : joints) {
    skeleton.names.push_back(unique(j.node->name));
    skeleton.parents.push_back(j.parent);
    const bool is_root = skeleton.size() == 1;
    skeleton.offsets.push_back(options.scale * (is_root ? j.node->offset : detail::constant_offset(j, table)));
  }
  skeleton.ends = detail::bvh_ends(file, joints, options.scale);
  motion.root.reserve(frames);
  motion.local.reserve(frames * joints.size());
  for (Index f = 0; f < file.frames; ++f) {
    const auto row = table[f];
    Vec3<double> position{};
    auto rotation = Quaternion<double>::identity();
    for (const detail::BvhJoint& carrier : carriers) {
      position = position + rotate(rotation, carrier.translation(row));
      rotation = rotation * carrier.rotation(row);
    }
    motion.root.push_back(options.scale * (position + rotate(rotation, joints[0].translation(row))));
    for (const detail::BvhJoint& j : joints) motion.local.push_back(j.rotation(row));
    auto& root_rotation = motion.local[motion.local.size() - joints.size()];
    root_rotation = rotation * root_rotation;
  }
  motion.validate();
  return motion;
}

MOTIONLANG_BODY int bvh_roots(const Bvh& file) {
  return static_cast<int>(
      std::count_if(file.nodes.begin(), file.nodes.end(), [](const BvhNode& n) { return n.parent == -1; }));
}

MOTIONLANG_BODY std::vector<std::string> stretched_joints(const Bvh& file, int root) {
  const detail::BvhTable table(file);
  auto joints = detail::bvh_joints(file, root);
  detail::take_carriers(joints, table);
  std::vector<std::string> names;
  for (const detail::BvhJoint& j : std::span(joints).subspan(1)) {
    if (detail::moves(j, table)) names.push_back(j.node->name);
  }
  return names;
}

MOTIONLANG_BODY Motion read_bvh_motion(const FilePath& path, const BvhReadOptions& options) {
  return to_motion(read_bvh(path), options);
}

namespace detail {

MOTIONLANG_BODY EulerAngles<double> continue_curve(const EulerAngles<double>& angles,
                                                   const EulerAngles<double>& before) {
  constexpr double pi = std::numbers::pi;
  auto near = [](double angle, double target) { return angle - 2 * pi * std::round((angle - target) / (2 * pi)); };
  auto moved = [&](double a, double b, double c) {
    return EulerAngles<double>{near(a, before.a), near(b, before.b), near(c, before.c), angles.order};
  };
  auto step = [&](const EulerAngles<double>& e) {
    return std::abs(e.a - before.a) + std::abs(e.b - before.b) + std::abs(e.c - before.c);
  };
  const auto same = moved(angles.a, angles.b, angles.c);
  const auto twin = moved(angles.a + pi, pi - angles.b, angles.c + pi);
  return step(twin) < step(same) ? twin : same;
}

/// A name that every reader accepts: letters, digits, "_", "-", "." (no blanks, no ":").
inline std::string plain_name(std::string_view name) {
  std::string plain(name);
  for (char& c : plain) {
    const bool keep =
        (lower(c) >= 'a' && lower(c) <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    if (!keep) c = '_';
  }
  return plain.empty() ? "joint" : plain;
}

MOTIONLANG_BODY std::vector<int> depth_first_order(const Skeleton& skeleton) {
  std::vector<int> order, open{0};
  while (!open.empty()) {
    const int joint = open.back();
    open.pop_back();
    order.push_back(joint);
    const std::vector<int> children = skeleton.children(joint);
    open.insert(open.end(), children.rbegin(), children.rend());
  }
  return order;
}

/// Where a leaf's bone ends: as the skeleton says, else `length` metres along the bone before it, upwards if there is
/// none.
inline Vec3<double> end_offset(const Skeleton& skeleton, int joint, double length) {
  if (!skeleton.ends.empty() && norm(skeleton.ends[static_cast<std::size_t>(joint)]) > 0)
    return skeleton.ends[static_cast<std::size_t>(joint)];
  const Vec3<double> bone = joint == 0 ? Vec3<double>{} : skeleton.offset(joint);
  const double before = norm(bone);
  return before > 1e-9 ? std::min(1.0, length / before) * bone : Vec3<double>{0, length, 0};
}

}  // namespace detail

MOTIONLANG_BODY Bvh to_bvh(const Motion& motion, const BvhWriteOptions& options) {
  motion.validate();
  const EulerOrder order = EulerOrder::parse(options.order);
  if (order.axis[0] == order.axis[2]) raise<config_error>(101, "to_bvh: order '", options.order, "' has an axis twice");
  if (!(options.scale > 0)) raise<config_error>(101, "to_bvh: scale ", options.scale);
  const Skeleton& skeleton = motion.skeleton;
  const std::vector<int> joints = detail::depth_first_order(skeleton);

  Bvh file{.frame_time = 1 / motion.fps, .frames = motion.frames(), .name = motion.name};
  std::vector<BvhChannel> channels{BvhChannel::x_position, BvhChannel::y_position, BvhChannel::z_position};
  for (const int axis : order.axis) channels.push_back(static_cast<BvhChannel>(axis + 3));
  std::vector<int> node_of(joints.size());
  detail::UniqueNames unique;
  for (const int j : joints) {
    const std::string name = unique(detail::plain_name(skeleton.name(j)));
    node_of[static_cast<std::size_t>(j)] = static_cast<int>(file.nodes.size());
    const int parent = j == 0 ? -1 : node_of[static_cast<std::size_t>(skeleton.parent(j))];
    const Vec3<double> offset = j == 0 ? Vec3<double>{} : options.scale * skeleton.offset(j);
    file.nodes.push_back({.name = name, .parent = parent, .offset = offset, .channels = channels});
    if (skeleton.children(j).empty()) {
      const Vec3<double> end = options.scale * detail::end_offset(skeleton, j, options.end_length);
      file.nodes.push_back(
          {.name = "Site", .parent = static_cast<int>(file.nodes.size()) - 1, .end_site = true, .offset = end});
    }
    if (j == 0) channels.erase(channels.begin(), channels.begin() + 3);
  }

  std::vector<EulerAngles<double>> before(joints.size());
  file.values.reserve(static_cast<std::size_t>(file.frames * file.channels()));
  for (Index f = 0; f < file.frames; ++f) {
    const Vec3<double> root = options.scale * motion.root_at(f);
    file.values.insert(file.values.end(), {root.x, root.y, root.z});
    for (const int j : joints) {
      EulerAngles<double>& last = before[static_cast<std::size_t>(j)];
      const auto& rotation = motion.rotations(f)[static_cast<std::size_t>(j)];
      const auto angles = to_euler(rotation, order, last.c);
      last = f == 0 ? angles : detail::continue_curve(angles, last);
      for (const double a : {last.a, last.b, last.c}) file.values.push_back(a / degree);
    }
  }
  return file;
}

MOTIONLANG_BODY void write_bvh(const FilePath& path, const Motion& motion, const BvhWriteOptions& options) {
  write_bvh(path, to_bvh(motion, options));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_FIGURE_BODY_HPP  // <motionlang/formats/figure_body.hpp>
#define MOTIONLANG_HAS_FORMATS_FIGURE_BODY_HPP
/// A free body: the figure of any skeleton (formats/figure.hpp, the round cones that GLB files and pages show) as a
/// body model, so that every motion has vertices and faces without a licensed file. A vertex follows one joint; there
/// are no blend shapes.
///
///     auto body = figure_body<EigenBackend<float>>(motion.skeleton);
///     auto posed = pose_body(body.model, motion);                       // vertices (frames, V, 3)

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Weights that give each joint's rest position as an affine combination of the vertices, (joints, vertices); of all
/// such weights the smallest:
///     w_i = 1 / V + (x_i - c) C^-1 (p - c),   c = mean of x,   C = sum (x_i - c) (x_i - c)^T
template <class S>
std::vector<S> rest_regressor(const std::vector<Vec3<float>>& vertices, const std::vector<Vec3<double>>& joints) {
  const auto count = static_cast<double>(vertices.size());
  Vec3<double> centre{};
  for (const auto& v : vertices) centre = centre + 1 / count * vec_cast<double>(v);
  Vec3<double> a{}, b{}, c{};  // columns of C
  for (const auto& v : vertices) {
    const Vec3<double> d = vec_cast<double>(v) - centre;
    a = a + d.x * d, b = b + d.y * d, c = c + d.z * d;
  }
  const double determinant = dot(a, cross(b, c));
  std::vector<S> out;
  for (const Vec3<double>& joint : joints) {
    const Vec3<double> p = joint - centre;
    const Vec3<double> solved{dot(p, cross(b, c)), dot(p, cross(c, a)), dot(p, cross(a, b))};
    for (const auto& v : vertices) {
      out.push_back(static_cast<S>(1 / count + dot(vec_cast<double>(v) - centre, solved) / determinant));
    }
  }
  return out;
}

}  // namespace detail

/// A body of kind `other` with the joints of the skeleton, in its rest pose; metres.
template <Backend B>
Body<B> figure_body(const Skeleton& skeleton) {
  using S = typename B::scalar;
  const detail::FigureMesh mesh = detail::make_mesh(make_figure(skeleton), skeleton);
  const auto vertices = static_cast<Index>(mesh.positions.size());
  const Index joints = skeleton.size();
  std::vector<S> points, weights(static_cast<std::size_t>(vertices * joints), S(0));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto& p = mesh.positions[v];
    points.insert(points.end(), {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)});
    weights[v * static_cast<std::size_t>(joints) + mesh.joints[v]] = S(1);
  }
  Body<B> body;
  body.model.v_template = Tensor<B, 2>::from(points, {vertices, 3});
  body.model.shapedirs = body.model.posedirs = Tensor<B, 2>::zeros({3 * vertices, 0});
  body.model.J_regressor =
      Tensor<B, 2>::from(detail::rest_regressor<S>(mesh.positions, skeleton.rest_positions()), {joints, vertices});
  body.model.weights = Tensor<B, 2>::from(weights, {vertices, joints});
  body.model.parents = skeleton.parents;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    body.faces.push_back({static_cast<Index>(mesh.triangles[i]), static_cast<Index>(mesh.triangles[i + 1]),
                          static_cast<Index>(mesh.triangles[i + 2])});
  }
  return body;
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_FORMATS_GLB_HPP  // <motionlang/formats/glb.hpp>
#define MOTIONLANG_HAS_FORMATS_GLB_HPP
/// GLB files, both ways.

#ifndef MOTIONLANG_HAS_FORMATS_GLB_READER_HPP  // <motionlang/formats/glb_reader.hpp>
#define MOTIONLANG_HAS_FORMATS_GLB_READER_HPP
/// GLB files, and .gltf files with their data in base64, as motions: skins and animations of glTF 2.0. Meshes,
/// materials and morph targets are left out. The bones of a VRM avatar (.vrm, .vrma) have the names of VRM's humanoid.
///
/// The skeleton's rest pose is that of the file, with all rotations the identity as everywhere in this library: with B
/// the world rotation of a node at rest and r its local rotation, L_j = B_parent r_j B_j^-1, and the offset of a joint
/// is its rest translation turned by B_parent. Bones keep their length: only the root moves; animated scales and
/// translations of other joints are dropped (stretched_joints names these).
///
/// Two keys of a small file can be years apart. What is sampled has at most 10 million rotations (frames x joints;
/// nearly four hours at 30 per second with 24 joints: 320 MB), or 16 for each key of a channel in the file, which is
/// enough for any recording with keys at its frames. motions() counts all animations together, and for each of them the
/// rotations that would fill the memory of its skeleton, of which every motion has its own.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_SKELETON_HPP  // <motionlang/formats/detail/gltf_skeleton.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_SKELETON_HPP
/// The skeleton in a glTF document: which nodes are joints, which of them is the root, and where they stand at rest.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_ANIMATION_HPP  // <motionlang/formats/detail/gltf_animation.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_ANIMATION_HPP
/// Animations of a glTF document: the transform of any node at any time. Source: glTF 2.0, 3.11 and appendix C.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_NODE_HPP  // <motionlang/formats/detail/gltf_node.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_NODE_HPP
/// Nodes of a glTF document.

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

namespace detail {

class GltfDocument;
class SharedAccessors;

/// Translation, rotation and scale of a node relative to its parent.
struct GltfTransform {
  Vec3<double> translation{};
  Quaternion<double> rotation = Quaternion<double>::identity();
  Vec3<double> scale{1, 1, 1};
};

struct GltfNode {
  std::string name;  // of a bone of VRM's humanoid that of the bone: "leftUpperLeg"
  int parent = -1;
  std::vector<int> children{};
  GltfTransform rest;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Keys of one property of one node over time.
struct GltfChannel {
  enum Mode { step, linear, cubic };
  std::shared_ptr<const std::vector<double>> times, values;
  Mode mode = linear;
  std::size_t components = 3;

  /// The value at `time`; before the first and after the last key theirs. Rotations are x, y, z, w and not normalised.
  std::array<double, 4> at(double time) const;

 private:
  using Value = std::array<double, 4>;

  /// Key k; a cubic one has an in-tangent before it and an out-tangent behind it.
  Value key(std::size_t k, int part = 1) const;
  static Value combine(double s, const Value& a, double t, const Value& b);
  /// p(u) = (2u^3 - 3u^2 + 1) a + span (u^3 - 2u^2 + u) a' + (3u^2 - 2u^3) b + span (u^3 - u^2) b'
  Value hermite(std::size_t k, const Value& a, const Value& b, double span, double u) const;
};

class GltfAnimation {
 public:
  /// Throws  io_error 402 to 405, config_error 107
  GltfAnimation(SharedAccessors& keys, Index number);

  const std::string& name() const { return name_; }
  /// Time of the last key, seconds.
  double duration() const { return duration_; }
  /// Keys per second, where all keys are at whole frames of one rate: those of the channel that has most, the first at
  /// 0.
  std::optional<double> rate() const;
  /// Keys of all channels; those that channels share count for each.
  std::size_t keys() const;
  bool animates(int node) const { return translations_.contains(node) || rotations_.contains(node); }

  /// Transform of a node, from its transform at rest; the scale stays.
  GltfTransform at(int node, GltfTransform transform, double time) const;
  /// Whether the node ever leaves its place at rest by more than a hundredth of its distance to the parent.
  bool moves_away(int node, const Vec3<double>& rest) const { return leaves(translations_, node, rest); }
  /// Whether its scale ever is another than at rest, by more than a hundredth.
  bool grows(int node, const Vec3<double>& rest) const { return leaves(scales_, node, rest); }

 private:
  /// Channels may share them: each once.
  std::set<const std::vector<double>*> lists_of_times() const;
  static bool leaves(const std::map<int, GltfChannel>& channels, int node, const Vec3<double>& rest);
  GltfChannel channel(SharedAccessors& keys, const JsonView& sampler, std::size_t components);

  std::string name_;
  std::map<int, GltfChannel> translations_, rotations_, scales_;
  double duration_ = 0;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_ANIMATION_IPP  // <motionlang/formats/detail/gltf_animation.ipp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_ANIMATION_IPP
// Bodies of gltf_animation.hpp.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_DOCUMENT_HPP  // <motionlang/formats/detail/gltf_document.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_DOCUMENT_HPP
/// Accessors and nodes of a glTF document whose data are in the file: in the binary chunk of GLB, or in base64. Every
/// number of the file is checked before it is used.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws io_error 404 if the data of an object of the file are packed by one of these extensions.
inline void refuse_packed(const JsonView& object, std::initializer_list<const char*> extensions) {
  for (const char* packed : extensions) {
    if (object.contains("extensions") && object["extensions"].contains(packed))
      raise<io_error>(404, object.path(), ": packed by ", packed,
                      ": unpack the file first, for instance with gltf-transform");
  }
}

/// Of extensions that a file requires only those matter that pack what is read here; others are of meshes and
/// materials.
class GltfDocument {
 public:
  /// Throws  io_error 402 to 404; config_error 107 where JSON has a value of the wrong kind
  GltfDocument(std::span<const std::byte> bytes, std::string file)
      : file_(std::move(file)), size_(bytes.size()), chunks_(parse_glb_chunks(bytes, file_)) {
    const std::string version = root()["asset"]["version"].as<std::string>();
    if (!version.starts_with("2.")) raise<io_error>(404, file_, ": glTF of version ", version, ", known is 2");
    decode_buffers();
    read_nodes();
    name_humanoid();
  }

  const std::string& file() const { return file_; }
  /// Bytes of the file.
  std::size_t size() const { return size_; }
  JsonView root() const { return JsonView(chunks_.document, file_); }
  /// The data of a buffer: the binary chunk without what fills it up, or what stands in the document in base64.
  /// Throws io_error 402; 404 if they are not in this file.
  std::span<const std::byte> buffer(Index i) const {
    const JsonView b = element("buffers", i);
    const bool decoded = b.contains("uri");
    if (decoded ? !is_data(b["uri"].as<std::string>()) : i != 0) {
      raise<io_error>(404, b.path(),
                      ": the buffer is not in this file: make one .glb file of all, for instance with "
                      "gltf-transform");
    }
    const std::span<const std::byte> data = decoded ? std::span(decoded_[static_cast<std::size_t>(i)]) : chunks_.binary;
    return slice(data, 0, b["byteLength"].as<std::uint64_t>(), b.path(), "buffer");
  }
  /// The elements of a top-level array; none if it is missing.
  Index count(const std::string& array) const { return root().contains(array) ? root()[array].size() : 0; }
  JsonView element(const std::string& array, Index i) const { return root()[array][i]; }

  const std::vector<GltfNode>& nodes() const { return nodes_; }
  const GltfNode& node(int i) const { return nodes_[static_cast<std::size_t>(i)]; }
  /// All nodes, every parent before its children, depth first.
  const std::vector<int>& depth_first() const { return order_; }

  /// The number that `reference` holds, which must be that of a node. Throws io_error 403.
  int node_number(const JsonView& reference) const {
    const auto i = reference.as<std::int64_t>();
    if (i < 0 || i >= static_cast<std::int64_t>(nodes_.size())) {
      raise<io_error>(403, reference.path(), ": node ", i, " of ", nodes_.size());
    }
    return static_cast<int>(i);
  }

  /// The values of an accessor, `components` per element; integers that are marked as normalised become real numbers.
  /// Those that the file does not have are 0, and a sparse accessor replaces some.
  /// Source  glTF 2.0, 3.6.2
  /// Throws  io_error 402 if they lie outside of the file, 403, 404 for data in other files, 405 if the file does not
  ///         have them and is too small for so many
  std::vector<double> values(Index accessor, std::size_t components) const {
    const JsonView a = element("accessors", accessor);
    const std::size_t kinds = components_of(a["type"].as<std::string>());
    if (kinds != components)
      raise<io_error>(403, a.path(), ": ", counted(kinds, "component"), ", expected ", components);
    const int type = a["componentType"].as<int>();
    const std::size_t size = size_of(type, a);
    const auto count = a["count"].as<std::uint64_t>();
    const bool normalised = a.value_or("normalized", false);

    std::vector<double> out;
    auto read = [&](const Elements& from, std::uint64_t i, std::uint64_t to) {
      for (std::size_t c = 0; c < components; ++c) {
        double& value = out[to * components + c];
        value = number(from.at(i) + c * size, type, normalised);
        if (!std::isfinite(value)) raise<io_error>(403, a.path(), ": element ", to, " is not finite");
      }
    };
    if (a.contains("bufferView")) {
      const Elements stored = elements(a, count, size * components);
      out.resize(count * components);
      for (std::uint64_t i = 0; i < count; ++i) read(stored, i, i);
    } else {
      if (count > (size_ / 4 + most_made_up) / components)
        raise<io_error>(405, a.path(), ": ", counted(count, "element"), " that are not in the file, which has ",
                        counted(size_, "byte"));
      out.resize(count * components);
    }
    if (a.contains("sparse")) replace_some(a["sparse"], count, size * components, read);
    return out;
  }

 private:
  static constexpr std::size_t most_made_up = 1 << 20;  // values that a small file may leave out

  static std::size_t components_of(std::string_view type) {
    return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : type == "MAT4" ? 16 : 0;
  }
  static std::size_t size_of(int component_type, const JsonView& accessor) {
    switch (component_type) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        raise<io_error>(403, accessor.path(), ": componentType ", component_type);
    }
  }
  /// Source  glTF 2.0, 3.11 for normalised integers
  static double number(const std::byte* at, int component_type, bool normalised) {
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, at, sizeof value);
      if constexpr (std::integral<T>) {
        if (normalised) return std::max(static_cast<double>(value) / std::numeric_limits<T>::max(), -1.0);
      }
      return static_cast<double>(value);
    };
    switch (component_type) {
      case 5120:
        return as(std::int8_t{});
      case 5121:
        return as(std::uint8_t{});
      case 5122:
        return as(std::int16_t{});
      case 5123:
        return as(std::uint16_t{});
      case 5125:
        return as(std::uint32_t{});
      default:
        return as(float{});
    }
  }

  static constexpr std::string_view base64_mark = ";base64,";
  static bool is_data(std::string_view uri) { return uri.starts_with("data:") && uri.find(base64_mark) != uri.npos; }
  void decode_buffers() {
    for (Index i = 0; i < count("buffers"); ++i) {
      const JsonView b = element("buffers", i);
      const std::string uri = b.value_or("uri", "");
      decoded_.emplace_back();
      const std::size_t begin = uri.find(base64_mark) + base64_mark.size();
      if (is_data(uri)) decoded_.back() = from_base64(std::string_view(uri).substr(begin), b.path());
    }
  }

  /// Elements of an accessor, or of a part of a sparse one, in a buffer.
  struct Elements {
    const std::byte* first;
    std::uint64_t stride;  // bytes
    const std::byte* at(std::uint64_t i) const { return first + i * stride; }
  };
  /// `count` elements of `item` bytes each, where the object's bufferView and byteOffset say.
  Elements elements(const JsonView& object, std::uint64_t count, std::uint64_t item) const {
    const JsonView view = element("bufferViews", object["bufferView"].as<Index>());
    refuse_packed(view, {"EXT_meshopt_compression", "KHR_meshopt_compression"});
    const auto data = slice(buffer(view["buffer"].as<Index>()), view.value_or("byteOffset", std::uint64_t{0}),
                            view["byteLength"].as<std::uint64_t>(), view.path(), "buffer view");
    const auto start = object.value_or("byteOffset", std::uint64_t{0}), stride = view.value_or("byteStride", item);
    if (stride < item)
      raise<io_error>(403, view.path(), ": byteStride ", stride, " for elements of ", counted(item, "byte"));
    const bool fits = count == 0 || (start <= data.size() && item <= data.size() - start &&
                                     (count - 1) <= (data.size() - start - item) / stride);
    if (!fits)
      raise<io_error>(402, object.path(), ": ", counted(count, "element does not fit", "elements do not fit"), " into ",
                      counted(data.size(), "byte"));
    return {count == 0 ? data.data() : data.data() + start, stride};
  }
  /// Calls read(values, i, place) for every element of a sparse accessor; their places among `count` elements ascend.
  template <class F>
  void replace_some(const JsonView& sparse, std::uint64_t count, std::uint64_t item, F read) const {
    const JsonView indices = sparse["indices"];
    const int type = indices["componentType"].as<int>();
    if (type != 5121 && type != 5123 && type != 5125) raise<io_error>(403, indices.path(), ": componentType ", type);
    const auto some = sparse["count"].as<std::uint64_t>();
    const Elements places = elements(indices, some, size_of(type, indices));
    const Elements values = elements(sparse["values"], some, item);
    std::uint64_t next = 0;  // the first place that may follow
    for (std::uint64_t i = 0; i < some; ++i) {
      const auto place = static_cast<std::uint64_t>(number(places.at(i), type, false));
      if (place < next || place >= count)
        raise<io_error>(403, indices.path(), ": index ", i, " is ", place, ", expected one from ", next,
                        " on and below ", count);
      read(values, i, place);
      next = place + 1;
    }
  }

  Vec3<double> vector(const JsonView& node, const std::string& key, const Vec3<double>& otherwise) const {
    const auto v = node.value_or(key, std::vector<double>{otherwise.x, otherwise.y, otherwise.z});
    if (v.size() != 3 || !std::isfinite(v[0] + v[1] + v[2])) raise<io_error>(403, node.path(), ": ", key);
    return {v[0], v[1], v[2]};
  }
  Quaternion<double> quaternion(const JsonView& node) const {
    const auto v = node.value_or("rotation", std::vector<double>{0, 0, 0, 1});
    const double squared = std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
    if (v.size() != 4 || !(squared > 1e-6 && squared < 1e6)) raise<io_error>(403, node.path(), ": rotation");
    return normalized(Quaternion<double>{v[3], v[0], v[1], v[2]});
  }
  /// Columns of a matrix without shear: lengths are the scale, directions the rotation.
  GltfTransform decomposed(const JsonView& node) const {
    const auto m = node["matrix"].as<std::vector<double>>();
    const double sum = std::accumulate(m.begin(), m.end(), 0.0);
    if (m.size() != 16 || !std::isfinite(sum)) raise<io_error>(403, node.path(), ": matrix");
    const Vec3<double> x{m[0], m[1], m[2]}, y{m[4], m[5], m[6]}, z{m[8], m[9], m[10]};
    const Matrix3<double> r = Matrix3<double>::from_columns(normalized(x), normalized(y), normalized(z));
    const double determinant = dot(r.column(0), cross(r.column(1), r.column(2)));
    if (!(determinant > 0.5)) raise<io_error>(404, node.path(), ": matrix with shear, reflection or no extent");
    return {{m[12], m[13], m[14]}, normalized(to_quaternion(r)), {norm(x), norm(y), norm(z)}};
  }

  void read_nodes() {
    nodes_.resize(static_cast<std::size_t>(count("nodes")));
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const JsonView n = element("nodes", static_cast<Index>(i));
      nodes_[i].name = n.value_or("name", "");
      if (nodes_[i].name.empty()) nodes_[i].name = concat_text("node_", i);
      nodes_[i].rest = n.contains("matrix")
                           ? decomposed(n)
                           : GltfTransform{vector(n, "translation", {}), quaternion(n), vector(n, "scale", {1, 1, 1})};
      for (Index c = 0; n.contains("children") && c < n["children"].size(); ++c) {
        const int child = node_number(n["children"][c]);
        GltfNode& target = nodes_[static_cast<std::size_t>(child)];
        if (target.parent >= 0) raise<io_error>(403, n.path(), ": child ", child, " has two parents");
        target.parent = static_cast<int>(i);
        nodes_[i].children.push_back(child);
      }
    }
    std::vector<int> open;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (nodes_[i].parent < 0) open.push_back(static_cast<int>(i));
    }
    while (!open.empty()) {
      const int i = open.back();
      open.pop_back();
      order_.push_back(i);
      const auto& c = node(i).children;
      open.insert(open.end(), c.rbegin(), c.rend());
    }
    if (order_.size() != nodes_.size()) raise<io_error>(403, file_, ": the tree of nodes has a cycle");
  }

  /// Avatars say which of their nodes are the bones of a humanoid, whatever these are called. -1: a bone without a
  /// node.
  /// Source  VRM 0.x: VRM; 1.0: VRMC_vrm, VRMC_vrm_animation
  void name_humanoid() {
    if (!root().contains("extensions")) return;
    const JsonView extensions = root()["extensions"];
    std::map<int, std::string> bones;
    auto add = [&](const std::string& bone, const JsonView& node) {
      if (node.as<std::int64_t>() != -1) bones[node_number(node)] = bone;
    };
    for (const char* name : {"VRMC_vrm", "VRMC_vrm_animation"}) {
      if (!extensions.contains(name)) continue;
      const JsonView all = extensions[name]["humanoid"]["humanBones"];
      for (const std::string& bone : all.keys()) add(bone, all[bone]["node"]);
    }
    if (extensions.contains("VRM")) {
      const JsonView all = extensions["VRM"]["humanoid"]["humanBones"];
      for (Index i = 0; i < all.size(); ++i) add(all[i]["bone"].as<std::string>(), all[i]["node"]);
    }
    std::set<std::string> names;
    for (const auto& [node, bone] : bones) names.insert(bone);
    for (GltfNode& node : nodes_) {
      if (names.contains(node.name)) node.name += " (no bone)";
    }
    for (const auto& [node, bone] : bones) nodes_[static_cast<std::size_t>(node)].name = bone;
  }

  std::string file_;
  std::size_t size_;
  GlbChunks chunks_;
  std::vector<std::vector<std::byte>> decoded_;  // of the buffers in base64
  std::vector<GltfNode> nodes_;
  std::vector<int> order_;
};

inline Vec3<double> scaled(const Vec3<double>& s, const Vec3<double>& v) { return {s.x * v.x, s.y * v.y, s.z * v.z}; }

/// World transforms of all nodes at rest. Scales are multiplied axis by axis: exact unless an uneven scale stands above
/// a rotation. Throws io_error 403 for a node that is infinitely far away.
inline std::vector<GltfTransform> world_at_rest(const GltfDocument& document) {
  std::vector<GltfTransform> world(document.nodes().size());
  for (const int n : document.depth_first()) {
    const GltfNode& node = document.node(n);
    GltfTransform& w = world[static_cast<std::size_t>(n)];
    w = node.rest;
    if (node.parent >= 0) {
      const GltfTransform& p = world[static_cast<std::size_t>(node.parent)];
      w = {p.translation + rotate(p.rotation, scaled(p.scale, node.rest.translation)),
           normalized(p.rotation * node.rest.rotation), scaled(p.scale, node.rest.scale)};
    }
    if (!std::isfinite(norm(w.translation) + norm(w.scale))) {
      raise<io_error>(403, document.file(), ": node ", n, " '", node.name, "' is infinitely far away");
    }
  }
  return world;
}

/// Accessors that are used several times (the times of an animation), each read once. A small file whose objects all
/// point to the same place could ask for much more work than it has bytes: that is refused.
class SharedAccessors {
 public:
  using Values = std::shared_ptr<const std::vector<double>>;

  explicit SharedAccessors(const GltfDocument& document) : document_(document), left_(16 * document.size()) {}

  const GltfDocument& document() const { return document_; }
  /// Throws io_error 402 to 405.
  Values values(Index accessor, std::size_t components) {
    auto& known = known_[{accessor, components}];
    if (known == nullptr) known = std::make_shared<const std::vector<double>>(document_.values(accessor, components));
    if (known->size() > left_)
      raise<io_error>(405, document_.file(), ": uses its data more often than an honest file does");
    left_ -= known->size();
    return known;
  }

 private:
  const GltfDocument& document_;
  std::map<std::pair<Index, std::size_t>, Values> known_;
  std::size_t left_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::array<double, 4> GltfChannel::at(double time) const {
  const auto& t = *times;
  const auto next = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), time) - t.begin());
  if (next == 0) return key(0);
  if (next == t.size() || mode == step) return key(next - 1);
  const double span = t[next] - t[next - 1], u = (time - t[next - 1]) / span;
  const auto a = key(next - 1), b = key(next);
  if (mode == cubic) return hermite(next - 1, a, b, span, u);
  if (components == 4) {
    const auto q = slerp(Quaternion<double>{a[3], a[0], a[1], a[2]}, Quaternion<double>{b[3], b[0], b[1], b[2]}, u);
    return {q.x, q.y, q.z, q.w};
  }
  return combine(1 - u, a, u, b);
}

MOTIONLANG_BODY GltfChannel::Value GltfChannel::key(std::size_t k, int part) const {
  const std::size_t at = mode == cubic ? 3 * k + static_cast<std::size_t>(part) : k;
  Value v{};
  std::copy_n(values->begin() + static_cast<std::ptrdiff_t>(at * components), components, v.begin());
  return v;
}

MOTIONLANG_BODY GltfChannel::Value GltfChannel::combine(double s, const Value& a, double t, const Value& b) {
  Value v{};
  for (std::size_t c = 0; c < 4; ++c) v[c] = s * a[c] + t * b[c];
  return v;
}

MOTIONLANG_BODY GltfChannel::Value GltfChannel::hermite(std::size_t k, const Value& a, const Value& b, double span,
                                                        double u) const {
  const double u2 = u * u, u3 = u2 * u;
  const Value tangents = combine(span * (u3 - 2 * u2 + u), key(k, 2), span * (u3 - u2), key(k + 1, 0));
  return combine(1, combine(2 * u3 - 3 * u2 + 1, a, 3 * u2 - 2 * u3, b), 1, tangents);
}

MOTIONLANG_BODY GltfAnimation::GltfAnimation(SharedAccessors& keys, Index number) {
  const GltfDocument& document = keys.document();
  const JsonView animation = document.element("animations", number);
  name_ = animation.value_or("name", concat_text("animation_", number));
  const JsonView samplers = animation["samplers"], channels = animation["channels"];
  for (Index i = 0; i < channels.size(); ++i) {
    const JsonView target = channels[i]["target"];
    if (!target.contains("node")) continue;
    const std::string path = target["path"].as<std::string>();
    const int node = document.node_number(target["node"]);
    if (path != "translation" && path != "rotation" && path != "scale") continue;  // weights: not of a skeleton
    auto& place = path == "rotation" ? rotations_ : path == "scale" ? scales_ : translations_;
    const JsonView sampler = samplers[channels[i]["sampler"].as<Index>()];
    if (!place.emplace(node, channel(keys, sampler, path == "rotation" ? 4 : 3)).second) {
      raise<io_error>(403, target.path(), ": a second channel for the ", path, " of node ", node);
    }
  }
}

MOTIONLANG_BODY std::optional<double> GltfAnimation::rate() const {
  const auto all = lists_of_times();
  if (all.empty()) return std::nullopt;
  const auto fewer = [](const auto* a, const auto* b) { return a->size() < b->size(); };
  const auto most = std::max_element(all.begin(), all.end(), fewer);
  if ((*most)->size() < 2) return std::nullopt;
  const double step = duration_ / static_cast<double>((*most)->size() - 1);
  const auto is_frame =
      [step](double t) {  // times are floats, which late ones round by more than a hundredth of a frame
        constexpr double rounding = std::numeric_limits<float>::epsilon();
        return std::abs(t / step - std::round(t / step)) < std::clamp(rounding * t / step, 0.01, 0.25);
      };
  for (const auto* times : all) {
    if (!std::all_of(times->begin(), times->end(), is_frame)) return std::nullopt;
  }
  const double rate = 1 / step, round = std::round(1000 * rate) / 1000;  // times are floats
  return std::abs(rate - round) <= std::numeric_limits<float>::epsilon() * rate ? round : rate;
}

MOTIONLANG_BODY std::size_t GltfAnimation::keys() const {
  std::size_t sum = 0;
  for (const auto* channels : {&translations_, &rotations_, &scales_}) {
    for (const auto& [node, c] : *channels) sum += c.times->size();
  }
  return sum;
}

MOTIONLANG_BODY GltfTransform GltfAnimation::at(int node, GltfTransform transform, double time) const {
  if (const auto c = translations_.find(node); c != translations_.end()) {
    const auto v = c->second.at(time);
    transform.translation = {v[0], v[1], v[2]};
  }
  if (const auto c = rotations_.find(node); c != rotations_.end()) {
    const auto v = c->second.at(time);
    const Quaternion<double> q{v[3], v[0], v[1], v[2]};
    if (dot(q, q) > 1e-12) transform.rotation = normalized(q);
  }
  return transform;
}

MOTIONLANG_BODY std::set<const std::vector<double>*> GltfAnimation::lists_of_times() const {
  std::set<const std::vector<double>*> out;
  for (const auto* channels : {&translations_, &rotations_, &scales_}) {
    for (const auto& [node, c] : *channels) out.insert(c.times.get());
  }
  return out;
}

MOTIONLANG_BODY bool GltfAnimation::leaves(const std::map<int, GltfChannel>& channels, int node,
                                           const Vec3<double>& rest) {
  const auto c = channels.find(node);
  if (c == channels.end()) return false;
  return std::any_of(c->second.times->begin(), c->second.times->end(), [&](double t) {
    const auto v = c->second.at(t);
    return norm(Vec3<double>{v[0], v[1], v[2]} - rest) > 1e-2 * std::max(norm(rest), 1e-3);
  });
}

MOTIONLANG_BODY GltfChannel GltfAnimation::channel(SharedAccessors& keys, const JsonView& sampler,
                                                   std::size_t components) {
  const std::string mode = sampler.value_or("interpolation", "LINEAR");
  GltfChannel c;
  c.components = components;
  c.mode = mode == "LINEAR" ? GltfChannel::linear : mode == "STEP" ? GltfChannel::step : GltfChannel::cubic;
  if (c.mode == GltfChannel::cubic && mode != "CUBICSPLINE") {
    raise<io_error>(404, sampler.path(), ": interpolation '", mode, "'");
  }
  c.times = keys.values(sampler["input"].as<Index>(), 1);
  c.values = keys.values(sampler["output"].as<Index>(), components);
  const std::vector<double>& t = *c.times;
  const std::size_t expected = t.size() * components * (c.mode == GltfChannel::cubic ? 3 : 1);
  if (t.empty() || c.values->size() != expected) {
    raise<io_error>(403, sampler.path(), ": ", counted(t.size(), "time"), " and ", counted(c.values->size(), "number"),
                    ", expected ", expected);
  }
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (!(t[i] > t[i - 1])) raise<io_error>(403, sampler.path(), ": time ", i, " is not after the one before");
  }
  if (t.front() < 0) raise<io_error>(403, sampler.path(), ": negative time ", t.front());
  duration_ = std::max(duration_, t.back());
  return c;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Which nodes become joints, and how they stand at rest.
class GltfSkeleton {
 public:
  Skeleton skeleton;
  std::vector<int> nodes;                          // of each joint; -1 for a root that is made up
  std::vector<Quaternion<double>> rest_rotations;  // of each joint in the world

  GltfSkeleton(const GltfDocument& document, std::span<const GltfAnimation> animations, Index skin);

 private:
  static constexpr std::size_t max_joints = 4096;
  static constexpr int nowhere = std::numeric_limits<int>::max();

  static std::size_t slot(int node) { return static_cast<std::size_t>(node); }

  /// below_ counts the joints in the subtree of every node, weighted_ tells whether they move a vertex.
  void mark_joints(const GltfDocument& document, std::span<const GltfAnimation> animations, Index skin);

  void mark_weighted(const GltfDocument& document, const std::vector<int>& joints, Index skin);

  /// The lowest node that has all joints below it, or -1 if there is none.
  int common_root(const GltfDocument& document) const;

  /// Game rigs put the hips below a root on the floor and move both. The library moves only the root of a skeleton, so
  /// that becomes the hips: the only child of `root` whose joints move vertices, if an animation moves it. -1 if not.
  int moving_hips(const GltfDocument& document, int root, std::span<const GltfAnimation> animations) const;

  /// The skeleton from `root` down: parents before children, else in the order of the skin.
  void build(const GltfDocument& document, int root);

  void add_joint(int node, int parent, const std::string& name, const Vec3<double>& offset,
                 const Quaternion<double>& q);

  std::vector<int> below_;
  std::vector<bool> weighted_;
  std::vector<int> place_;  // in the skin; of other nodes, that of the first joint below
  int total_ = 0;
  std::unordered_map<std::string, int> copies_;  // how often a name was made unique
  std::unordered_set<std::string> taken_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_SKELETON_IPP  // <motionlang/formats/detail/gltf_skeleton.ipp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_GLTF_SKELETON_IPP
// Bodies of gltf_skeleton.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY GltfSkeleton::GltfSkeleton(const GltfDocument& document, std::span<const GltfAnimation> animations,
                                           Index skin)
    : below_(document.nodes().size(), 0),
      weighted_(document.nodes().size(), false),
      place_(document.nodes().size(), nowhere) {
  mark_joints(document, animations, skin);
  const int common = common_root(document);
  const int hips = common < 0 ? -1 : moving_hips(document, common, animations);
  build(document, hips >= 0 ? hips : common);
}

MOTIONLANG_BODY void GltfSkeleton::mark_joints(const GltfDocument& document, std::span<const GltfAnimation> animations,
                                               Index skin) {
  if (document.count("skins") > 0) {
    const JsonView joints = document.element("skins", skin)["joints"];
    std::vector<int> numbers;
    for (Index i = 0; i < joints.size(); ++i) numbers.push_back(document.node_number(joints[i]));
    for (std::size_t i = numbers.size(); i-- > 0;) {
      below_[slot(numbers[i])] = 1;
      place_[slot(numbers[i])] = static_cast<int>(i);
    }
    if (!animations.empty()) mark_weighted(document, numbers, skin);  // only moving_hips asks for it
  } else {  // no skin: all nodes that an animation turns or moves
    for (const GltfAnimation& a : animations) {
      for (const int n : document.depth_first()) {
        if (a.animates(n)) below_[slot(n)] = 1, weighted_[slot(n)] = true, place_[slot(n)] = n;
      }
    }
  }
  const std::vector<int> own_place = place_;
  const auto& order = document.depth_first();
  for (auto n = order.rbegin(); n != order.rend(); ++n) {  // NOLINT(modernize-loop-convert): needs reverse_view
    const int p = document.node(*n).parent;
    if (p < 0) continue;
    if (own_place[slot(p)] == nowhere) place_[slot(p)] = std::min(place_[slot(p)], place_[slot(*n)]);
    below_[slot(p)] += below_[slot(*n)];
    if (weighted_[slot(*n)]) weighted_[slot(p)] = true;
  }
  total_ = std::accumulate(order.begin(), order.end(), 0,
                           [&](int sum, int n) { return sum + (document.node(n).parent < 0 ? below_[slot(n)] : 0); });
  if (total_ == 0) raise<io_error>(404, document.file(), ": no skin and no animated node");
}

MOTIONLANG_BODY void GltfSkeleton::mark_weighted(const GltfDocument& document, const std::vector<int>& joints,
                                                 Index skin) {
  SharedAccessors accessors(document);
  for (Index n = 0; n < document.count("nodes"); ++n) {
    const JsonView node = document.element("nodes", n);
    if (!node.contains("mesh") || !node.contains("skin") || node["skin"].as<Index>() != skin) continue;
    const JsonView primitives = document.element("meshes", node["mesh"].as<Index>())["primitives"];
    for (Index p = 0; p < primitives.size(); ++p) {
      refuse_packed(primitives[p], {"KHR_draco_mesh_compression"});
      const JsonView attributes = primitives[p]["attributes"];
      if (!attributes.contains("JOINTS_0") || !attributes.contains("WEIGHTS_0")) continue;
      const auto index_values = accessors.values(attributes["JOINTS_0"].as<Index>(), 4);
      const auto weight_values = accessors.values(attributes["WEIGHTS_0"].as<Index>(), 4);
      const std::vector<double>&index = *index_values, &weight = *weight_values;
      for (std::size_t i = 0; i < std::min(index.size(), weight.size()); ++i) {
        if (weight[i] > 0 && index[i] >= 0 && index[i] < static_cast<double>(joints.size())) {
          weighted_[slot(joints[static_cast<std::size_t>(index[i])])] = true;
        }
      }
    }
  }
}

MOTIONLANG_BODY int GltfSkeleton::common_root(const GltfDocument& document) const {
  int root = -1;
  for (const int n : document.depth_first()) {
    if (below_[slot(n)] == total_) root = n;
  }
  return root;
}

MOTIONLANG_BODY int GltfSkeleton::moving_hips(const GltfDocument& document, int root,
                                              std::span<const GltfAnimation> animations) const {
  int hips = -1;
  for (const int n : document.depth_first()) {
    if (document.node(n).parent != root || below_[slot(n)] == 0) continue;
    const bool matters = weighted_[slot(n)] || !weighted_[slot(root)];
    if (matters && hips >= 0) return -1;
    if (matters) hips = n;
  }
  for (const GltfAnimation& a : animations) {
    if (hips >= 0 && a.moves_away(hips, document.node(hips).rest.translation)) return hips;
  }
  return -1;
}

MOTIONLANG_BODY void GltfSkeleton::build(const GltfDocument& document, int root) {
  const std::vector<GltfTransform> world = world_at_rest(document);
  struct Open {
    int place, node, parent;  // in the skin, in the document, in the skeleton
    bool operator>(const Open& other) const { return place > other.place; }
  };
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  if (root >= 0) open.push({0, root, -1});
  if (root < 0) {
    add_joint(-1, -1, "root", {}, Quaternion<double>::identity());
    for (const int n : document.depth_first()) {
      if (document.node(n).parent < 0 && below_[slot(n)] > 0) open.push({place_[slot(n)], n, 0});
    }
  }
  while (!open.empty()) {
    const auto [place, n, parent] = open.top();
    open.pop();
    if (nodes.size() == max_joints) raise<io_error>(405, document.file(), ": more than ", max_joints, " joints");
    const GltfNode& node = document.node(n);
    const Vec3<double> origin = parent < 0 || node.parent < 0 ? Vec3<double>{} : world[slot(node.parent)].translation;
    const int joint = static_cast<int>(nodes.size());
    add_joint(n, parent, node.name, world[slot(n)].translation - origin, world[slot(n)].rotation);
    for (const int c : node.children) {
      if (below_[slot(c)] > 0) open.push({place_[slot(c)], c, joint});
    }
  }
  skeleton.validate();
}

MOTIONLANG_BODY void GltfSkeleton::add_joint(int node, int parent, const std::string& name, const Vec3<double>& offset,
                                             const Quaternion<double>& q) {
  std::string unique = name;
  for (int& i = copies_[name]; !taken_.insert(unique).second;) unique = concat_text(name, "_", ++i + 1);
  nodes.push_back(node);
  skeleton.names.push_back(std::move(unique));
  skeleton.parents.push_back(parent);
  skeleton.offsets.push_back(offset);
  rest_rotations.push_back(q);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// A GLB file in memory, from which several motions can be taken.
class GlbFile {
 public:
  /// skin    which of the file's skins; a file without any gives a skeleton of all animated nodes
  /// Throws  io_error 401 to 405; config_error 107 where the JSON has a value of the wrong kind
  static GlbFile open(const FilePath& path, Index skin = 0);
  GlbFile(std::span<const std::byte> bytes, std::string name, Index skin = 0);

  const Skeleton& skeleton() const { return joints_.skeleton; }
  std::vector<std::string> animation_names() const;

  /// Seconds from time 0 to the last key of an animation. Throws config_error 103 if there is no such animation.
  double duration(Index animation) const;

  /// Names of the joints below the root that an animation moves away from their place at rest, by more than a hundredth
  /// of the bone, or by the scale of the joint before: motion() leaves this out. Throws config_error 103 if there is no
  /// such animation.
  std::vector<std::string> stretched_joints(Index animation) const;

  /// Frames per second at which motion() takes an animation: those of its keys, where all are at whole frames of one
  /// rate of 10 to 1000; 30 for others. Throws config_error 103 if there is no such animation.
  double rate(Index animation) const;

  /// The animation from time 0 to its last key, at `wanted` frames per second or as rate() says.
  /// Throws  config_error 103 if there is no such animation, 101 for an impossible frame rate, io_error 405 if the
  ///         motion would be too long
  Motion motion(Index animation, std::optional<double> wanted = {}) const;
  /// All animations. Throws what motion(number) throws; io_error 405 if they would be too long together.
  std::vector<Motion> motions(std::optional<double> wanted = {}) const;
  /// The animation of that name. Throws config_error 103, and what motion(number) throws.
  Motion motion(std::string_view animation, std::optional<double> fps = {}) const;

 private:
  GlbFile(const detail::GltfDocument& document, Index skin);

  static std::vector<detail::GltfAnimation> load(const detail::GltfDocument& document);

  const detail::GltfAnimation& at(Index animation) const;

  double frames_of(const detail::GltfAnimation& a, double fps) const;
  static double most_rotations(std::size_t keys);
  /// How many rotations take as much memory as the skeleton of a motion.
  double skeleton_rotations() const;

  detail::GltfTransform transform(const detail::GltfAnimation& a, int node, double time) const;

  /// The root with all that stands above it in the file.
  detail::GltfTransform root_in_world(const detail::GltfAnimation& a, double time) const;

  void append_pose(Motion& motion, const detail::GltfAnimation& a, double time) const;

  std::string file_;
  std::vector<detail::GltfNode> nodes_;
  std::vector<detail::GltfAnimation> animations_;
  detail::GltfSkeleton joints_;
};

struct GlbReadOptions {
  std::string animation{};      // by name; "": the first
  std::optional<double> fps{};  // none: GlbFile::rate
  Index skin = 0;
};

/// Throws what GlbFile::open and GlbFile::motion throw.
Motion read_glb(const FilePath& path, const GlbReadOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_GLB_READER_IPP  // <motionlang/formats/glb_reader.ipp>
#define MOTIONLANG_HAS_FORMATS_GLB_READER_IPP
// Bodies of glb_reader.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GlbFile GlbFile::open(const FilePath& path, Index skin) {
  return GlbFile(MappedFile::open(path)->bytes(), path.string(), skin);
}

MOTIONLANG_BODY GlbFile::GlbFile(std::span<const std::byte> bytes, std::string name, Index skin)
    : GlbFile(detail::GltfDocument(bytes, std::move(name)), skin) {}

MOTIONLANG_BODY std::vector<std::string> GlbFile::animation_names() const {
  std::vector<std::string> out;
  for (const auto& a : animations_) out.push_back(a.name());
  return out;
}

MOTIONLANG_BODY double GlbFile::duration(Index animation) const { return at(animation).duration(); }

MOTIONLANG_BODY std::vector<std::string> GlbFile::stretched_joints(Index animation) const {
  const detail::GltfAnimation& a = at(animation);
  std::vector<std::string> names;
  for (std::size_t j = 1; j < joints_.nodes.size(); ++j) {
    const int node = joints_.nodes[j], before = joints_.nodes[static_cast<std::size_t>(skeleton().parents[j])];
    const bool stretched = before >= 0 && a.grows(before, nodes_[static_cast<std::size_t>(before)].rest.scale);
    if (stretched || a.moves_away(node, nodes_[static_cast<std::size_t>(node)].rest.translation)) {
      names.push_back(skeleton().names[j]);
    }
  }
  return names;
}

MOTIONLANG_BODY double GlbFile::rate(Index animation) const {
  const double own = at(animation).rate().value_or(0);
  return own >= 10 && own <= 1000 ? own : 30;
}

MOTIONLANG_BODY Motion GlbFile::motion(Index animation, std::optional<double> wanted) const {
  const detail::GltfAnimation& a = at(animation);
  const double fps = wanted ? *wanted : rate(animation), frames = frames_of(a, fps);
  const double rotations = frames * skeleton().size(), most = most_rotations(a.keys());
  if (rotations > most)
    raise<io_error>(405, file_, ": animation '", a.name(), "' of ", a.duration(), " s at ", fps,
                    " per second: ", rotations, " rotations (frames x joints), at most ", most, " of ",
                    counted(a.keys(), "key"));
  Motion motion{skeleton(), fps, {}, {}, a.name()};
  motion.root.reserve(static_cast<std::size_t>(frames));
  motion.local.reserve(static_cast<std::size_t>(frames) * joints_.nodes.size());
  for (double frame = 0; frame < frames; ++frame) append_pose(motion, a, frame / fps);
  return motion;
}

MOTIONLANG_BODY std::vector<Motion> GlbFile::motions(std::optional<double> wanted) const {
  double frames = 0;
  std::size_t keys = 0;
  for (std::size_t i = 0; i < animations_.size(); ++i) {
    frames += frames_of(animations_[i], wanted ? *wanted : rate(static_cast<Index>(i)));
    keys += animations_[i].keys();
  }
  const double rotations = frames * skeleton().size(), most = most_rotations(keys),
               skeletons = std::ceil(static_cast<double>(animations_.size()) * skeleton_rotations());
  if (rotations + skeletons > most)
    raise<io_error>(405, file_, ": ", counted(animations_.size(), "animation"), ": ", rotations,
                    " rotations (frames x joints) and skeletons that take the memory of ", skeletons, ", at most ",
                    most, " of ", counted(keys, "key"));
  std::vector<Motion> out;
  for (std::size_t i = 0; i < animations_.size(); ++i) out.push_back(motion(static_cast<Index>(i), wanted));
  return out;
}

MOTIONLANG_BODY Motion GlbFile::motion(std::string_view animation, std::optional<double> fps) const {
  for (std::size_t i = 0; i < animations_.size(); ++i) {
    if (animations_[i].name() == animation) return motion(static_cast<Index>(i), fps);
  }
  raise<config_error>(103, file_, ": no animation '", animation, "' among ", animations_.size());
}

MOTIONLANG_BODY GlbFile::GlbFile(const detail::GltfDocument& document, Index skin)
    : file_(document.file()),
      nodes_(document.nodes()),
      animations_(load(document)),
      joints_(document, animations_, skin) {}

MOTIONLANG_BODY std::vector<detail::GltfAnimation> GlbFile::load(const detail::GltfDocument& document) {
  detail::SharedAccessors keys(document);
  std::vector<detail::GltfAnimation> out;
  for (Index i = 0; i < document.count("animations"); ++i) out.emplace_back(keys, i);
  return out;
}

MOTIONLANG_BODY const detail::GltfAnimation& GlbFile::at(Index animation) const {
  if (animation < 0 || animation >= static_cast<Index>(animations_.size())) {
    raise<config_error>(103, file_, ": animation ", animation, " of ", animations_.size());
  }
  return animations_[static_cast<std::size_t>(animation)];
}

MOTIONLANG_BODY double GlbFile::frames_of(const detail::GltfAnimation& a, double fps) const {
  if (!(fps > 0 && fps < 1e6)) raise<config_error>(101, file_, ": ", fps, " frames per second");
  const double last = a.duration() * fps;  // the time of the last key is a float
  return std::floor(last + std::max(1e-4, std::numeric_limits<float>::epsilon() * last)) + 1;
}

MOTIONLANG_BODY double GlbFile::most_rotations(std::size_t keys) {
  constexpr double most_of_any = 1e7, most_of_key = 16;
  return std::max(most_of_any, most_of_key * static_cast<double>(keys));
}

MOTIONLANG_BODY double GlbFile::skeleton_rotations() const {
  std::size_t bytes = 0;
  for (const std::string& name : skeleton().names)
    bytes += sizeof(std::string) + name.size() + sizeof(int) + sizeof(Vec3<double>);
  return static_cast<double>(bytes) / sizeof(Quaternion<double>);
}

MOTIONLANG_BODY detail::GltfTransform GlbFile::transform(const detail::GltfAnimation& a, int node, double time) const {
  return a.at(node, nodes_[static_cast<std::size_t>(node)].rest, time);
}

MOTIONLANG_BODY detail::GltfTransform GlbFile::root_in_world(const detail::GltfAnimation& a, double time) const {
  detail::GltfTransform world;
  for (int n = joints_.nodes.front(); n >= 0; n = nodes_[static_cast<std::size_t>(n)].parent) {
    const detail::GltfTransform t = transform(a, n, time);
    world.translation = t.translation + rotate(t.rotation, detail::scaled(t.scale, world.translation));
    world.rotation = normalized(t.rotation * world.rotation);
  }
  return world;
}

MOTIONLANG_BODY void GlbFile::append_pose(Motion& motion, const detail::GltfAnimation& a, double time) const {
  const detail::GltfTransform root = root_in_world(a, time);
  motion.root.push_back(root.translation);
  motion.local.push_back(normalized(root.rotation * inverse(joints_.rest_rotations.front())));
  for (std::size_t j = 1; j < joints_.nodes.size(); ++j) {
    const auto parent = static_cast<std::size_t>(skeleton().parents[j]);
    const Quaternion<double> r = transform(a, joints_.nodes[j], time).rotation;
    motion.local.push_back(normalized(joints_.rest_rotations[parent] * r * inverse(joints_.rest_rotations[j])));
  }
}

MOTIONLANG_BODY Motion read_glb(const FilePath& path, const GlbReadOptions& options) {
  const GlbFile file = GlbFile::open(path, options.skin);
  return options.animation.empty() ? file.motion(0, options.fps) : file.motion(options.animation, options.fps);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_GLB_RIG_HPP  // <motionlang/formats/glb_rig.hpp>
#define MOTIONLANG_HAS_FORMATS_GLB_RIG_HPP
/// The user's character: a GLB file with mesh, skin and textures, to which motions are added.
///
/// The binary data of the file are kept byte for byte and new ones are put behind them; of the document only the arrays
/// of animations, accessors and buffer views grow, and the length of the buffer. (Data of the first buffer that stand
/// in the document in base64 become binary data.) The joint that is the pelvis moves; what stands above it (armature,
/// root) stays as it is at rest.

MOTIONLANG_NAMESPACE_BEGIN

struct GlbRigOptions {
  bool keep_animations = true;  // of the character's file; without them their data go, as far as they are the last
};

class GlbRig {
 public:
  /// Says which joint of a skeleton is which: one of the known tables, or read_skeleton_table.
  using FindTable = std::function<SkeletonTable(const Skeleton&)>;

  /// Of several skins, the first for which there is a table; of very many (thousands in a file of thousands of nodes),
  /// only the first are tried.
  /// Throws  what GlbFile throws; config_error 103 with the joint that is missing if no table fits, for every skin if
  ///         there are several
  static GlbRig open(const FilePath& path, const FindTable& find_table = detect_skeleton_table);
  GlbRig(std::span<const std::byte> bytes, std::string name, const FindTable& find_table = detect_skeleton_table);

  const std::string& file() const;
  /// From the pelvis down; a root position is that of the pelvis in the world.
  const Skeleton& skeleton() const { return skeleton_; }
  /// The kind of skeleton that it is.
  const SkeletonTable& table() const { return table_; }
  /// How it follows a skeleton of a known kind. Throws what SkeletonMap throws.
  SkeletonMap map_from(const Skeleton& source) const;

  /// The file with one more animation for every motion, retargeted unless it is on this skeleton. A name that is taken
  /// gets a number.
  /// Throws  config_error 101 without any motion or frame, or for an impossible frame rate; 103 where a motion's
  ///         skeleton is of no known kind; 107 where the file has a value of the wrong kind; what Motion::validate
  ///         throws; io_error 405 from 4 GiB on
  std::vector<std::byte> with(std::span<const Motion> motions, const GlbRigOptions& options = {}) const;

 private:
  void find_joints(Index skin, const FindTable& find_table);

  /// The motion as nodes have it: r_j = B_parent^-1 L_j B_j with B the world rotations at rest, and the place of the
  /// pelvis as seen from the node above it.
  Motion in_nodes(Motion motion) const;
  /// The nodes of joints that ever leave the pose at rest; -1 for fingers and the like, which need no keys.
  std::vector<int> moved_nodes(const Motion& motion) const;

  std::shared_ptr<const std::vector<std::byte>> bytes_;
  std::shared_ptr<const detail::GltfDocument> document_;
  SkeletonTable table_;
  Skeleton skeleton_;
  std::vector<int> nodes_;  // of the joints
  std::vector<Quaternion<double>> rest_rotations_;
  detail::GltfTransform above_;  // of the pelvis' parent in the world, at rest
};

/// Throws io_error 401, and what GlbRig::with throws. The file is whole or not there at all.
void write_glb(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
               const GlbRigOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_GLB_RIG_IPP  // <motionlang/formats/glb_rig.ipp>
#define MOTIONLANG_HAS_FORMATS_GLB_RIG_IPP
// Bodies of glb_rig.hpp.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_DROP_ANIMATIONS_HPP  // <motionlang/formats/detail/drop_animations.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_DROP_ANIMATIONS_HPP
/// Animations out of a glTF document that is being built, with what only they use.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Calls f(object) for every object in a document.
template <class F>
void for_each_object(const nlohmann::ordered_json& document, const F& f) {
  if (document.is_object()) f(document);
  for (const nlohmann::ordered_json& inner : document) {
    if (inner.is_structured()) for_each_object(inner, f);
  }
}

/// All numbers in the members of that name, wherever they stand: indices of accessors or of views.
inline std::set<double> numbers_under(const nlohmann::ordered_json& document,
                                      std::initializer_list<const char*> names) {
  std::set<double> out;
  const auto add = [&](const nlohmann::ordered_json& value) {
    if (value.is_number()) out.insert(value.get<double>());
  };
  for_each_object(document, [&](const nlohmann::ordered_json& object) {
    for (const char* name : names) {
      if (!object.contains(name)) continue;
      const nlohmann::ordered_json& member = object[name];
      add(member);
      for_each_object(member,
                      [&](const nlohmann::ordered_json& inner) { std::for_each(inner.begin(), inner.end(), add); });
    }
  });
  return out;
}

/// Takes the animations away, and of their accessors, views and bytes those that nothing else uses and that are the
/// last: what stays keeps its number and its place, which extensions may refer to. Blender writes animations last.
inline void drop_animations(GlbBuilder& glb) {
  nlohmann::ordered_json& d = glb.document;
  const auto drop_last = [](nlohmann::ordered_json& array, const std::set<double>& dropped,
                            const std::set<double>& used) {
    auto last = [&] { return static_cast<double>(array.size()) - 1; };
    while (!array.empty() && dropped.contains(last()) && !used.contains(last())) array.erase(array.size() - 1);
  };
  const auto of_animations = numbers_under(d["animations"], {"input", "output"});
  d["animations"].clear();
  nlohmann::ordered_json& accessors = d["accessors"];
  const auto views_before = numbers_under(accessors, {"bufferView"});
  drop_last(accessors, of_animations, numbers_under(d, {"attributes", "targets", "indices", "inverseBindMatrices"}));
  drop_last(d["bufferViews"], views_before, numbers_under(d, {"bufferView"}));

  double end = 0;  // of the bytes that something refers to
  for_each_object(d, [&](const nlohmann::ordered_json& object) {
    const auto number = [&](const char* name) {
      return object.contains(name) && object[name].is_number() ? object[name].get<double>() : 0;
    };
    if (object.contains("buffer") && number("buffer") == 0)
      end = std::max(end, number("byteOffset") + number("byteLength"));
  });
  if (end < 0x1p53) glb.cut(static_cast<std::size_t>(end));
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GlbRig GlbRig::open(const FilePath& path, const FindTable& find_table) {
  return GlbRig(MappedFile::open(path)->bytes(), path.string(), find_table);
}

MOTIONLANG_BODY GlbRig::GlbRig(std::span<const std::byte> bytes, std::string name, const FindTable& find_table)
    : bytes_(std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end())),
      document_(std::make_shared<const detail::GltfDocument>(*bytes_, std::move(name))) {
  const Index skins = document_->count("skins");
  if (skins < 2) {
    find_joints(0, find_table);
    return;
  }
  constexpr Index most_visits = 10'000'000, most_reasons = 8;  // each skin is looked for among all nodes
  const Index tried = std::min(skins, 1 + most_visits / (1 + std::ssize(document_->nodes())));
  std::string reasons;
  for (Index skin = 0; skin < tried; ++skin) {
    const auto find = [&] { find_joints(skin, find_table); };
    const auto not_it = [&](const config_error& e) {
      const std::string_view what = e.what();
      if (skin < most_reasons) reasons += concat_text("; skin ", skin, ": ", what.substr(what.find("] ") + 2));
      return e.id() == 103;
    };
    if (detail::guard<config_error>(find, not_it)) return;
  }
  raise<config_error>(103, file(), ": none of ", tried < skins ? concat_text("the first ", tried, " of ") : "",
                      counted(skins, "skin"), " is a body that is known", reasons);
}

MOTIONLANG_BODY const std::string& GlbRig::file() const { return document_->file(); }

MOTIONLANG_BODY SkeletonMap GlbRig::map_from(const Skeleton& source) const {
  return SkeletonMap(source, detect_skeleton_table(source), skeleton_, table_);
}

MOTIONLANG_BODY std::vector<std::byte> GlbRig::with(std::span<const Motion> motions,
                                                    const GlbRigOptions& options) const {
  if (motions.empty()) raise<config_error>(101, file(), ": no motion to add");
  for (const char* grows : {"accessors", "bufferViews", "animations"}) document_->count(grows);  // must be an array
  const detail::GlbChunks chunks = detail::parse_glb_chunks(*bytes_, file());
  detail::GlbBuilder glb(nlohmann::ordered_json::parse(chunks.text),
                         document_->count("buffers") > 0 ? document_->buffer(0) : std::span<const std::byte>());
  if (document_->count("buffers") > 0) glb.document["buffers"][0].erase("uri");
  if (!options.keep_animations) detail::drop_animations(glb);
  std::set<std::string> taken;
  for (Index i = 0; options.keep_animations && i < document_->count("animations"); ++i) {
    taken.insert(document_->element("animations", i).value_or("name", ""));
  }
  for (const Motion& motion : motions) {
    motion.validate();
    if (motion.frames() == 0) raise<config_error>(101, "GLB: motion '", motion.name, "' has no frames");
    Motion added = in_nodes(motion.skeleton == skeleton_ ? motion : retarget(motion, map_from(motion.skeleton)));
    const std::string name = motion.name.empty() ? "motion" : motion.name;
    added.name = name;
    for (int k = 2; !taken.insert(added.name).second; ++k) added.name = concat_text(name, "_", k);
    detail::add_animation(glb, added, moved_nodes(added));
  }
  return glb.finish();
}

MOTIONLANG_BODY void GlbRig::find_joints(Index skin, const FindTable& find_table) {
  std::vector<detail::GltfAnimation> animations;
  detail::SharedAccessors keys(*document_);
  if (document_->count("skins") == 0) {  // then joints are what moves
    for (Index i = 0; i < document_->count("animations"); ++i) animations.emplace_back(keys, i);
  }
  const detail::GltfSkeleton all(*document_, animations, skin);
  table_ = find_table(all.skeleton);
  const int pelvis = find_joint(all.skeleton, table_.find("pelvis")->source);
  if (all.nodes[static_cast<std::size_t>(pelvis)] < 0) {  // "root", which was made up over several trees
    raise<config_error>(103, file(), ": no node is the joint '", all.skeleton.name(pelvis), "'");
  }

  std::vector<int> number(all.nodes.size(), -1);  // of a joint of `all` in the skeleton from the pelvis down
  for (std::size_t j = 0; j < all.nodes.size(); ++j) {
    const int parent = all.skeleton.parents[j];
    const bool root = static_cast<int>(j) == pelvis;
    if (!root && (parent < 0 || number[static_cast<std::size_t>(parent)] < 0)) continue;
    number[j] = static_cast<int>(nodes_.size());
    nodes_.push_back(all.nodes[j]);
    rest_rotations_.push_back(all.rest_rotations[j]);
    skeleton_.names.push_back(all.skeleton.names[j]);
    skeleton_.parents.push_back(root ? -1 : number[static_cast<std::size_t>(parent)]);
    skeleton_.offsets.push_back(root ? all.skeleton.rest_positions()[j] : all.skeleton.offsets[j]);
  }
  skeleton_.validate();
  const std::vector<detail::GltfTransform> world = detail::world_at_rest(*document_);
  const int above = document_->node(nodes_.front()).parent;
  if (above >= 0) above_ = world[static_cast<std::size_t>(above)];
  if (const auto& s = above_.scale; !(s.x > 0 && s.y > 0 && s.z > 0)) {
    raise<io_error>(404, file(), ": the scale above '", skeleton_.name(0), "' is not positive");
  }
}

MOTIONLANG_BODY Motion GlbRig::in_nodes(Motion motion) const {
  const auto undo = inverse(above_.rotation);
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto local = motion.rotations(f);
    for (std::size_t j = 0; j < local.size(); ++j) {
      const int parent = skeleton_.parents[j];
      const auto up = parent < 0 ? above_.rotation : rest_rotations_[static_cast<std::size_t>(parent)];
      local[j] = inverse(up) * local[j] * rest_rotations_[j];
    }
    Vec3<double>& root = motion.root[static_cast<std::size_t>(f)];
    const Vec3<double> seen = rotate(undo, root - above_.translation);
    root = {seen.x / above_.scale.x, seen.y / above_.scale.y, seen.z / above_.scale.z};
  }
  return motion;
}

MOTIONLANG_BODY std::vector<int> GlbRig::moved_nodes(const Motion& motion) const {
  std::vector<int> nodes = nodes_;
  for (std::size_t j = 1; j < nodes.size(); ++j) {
    const auto& rest = document_->node(nodes_[j]).rest.rotation;
    bool moves = false;
    for (Index f = 0; f < motion.frames() && !moves; ++f) moves = distance(motion.rotations(f)[j], rest) > 1e-6;
    if (!moves) nodes[j] = -1;
  }
  return nodes;
}

MOTIONLANG_BODY void write_glb(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
                               const GlbRigOptions& options) {
  write_file(path, rig.with(motions, options));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_MDM_RESULTS_HPP  // <motionlang/formats/mdm_results.hpp>
#define MOTIONLANG_HAS_FORMATS_MDM_RESULTS_HPP
/// Motions that MDM has generated: results.npy, as its sample/generate.py saves it, or the array of positions alone.
///
///     std::vector<Motion> clips = read_motions_npy("results.npy");
///
///     {'motion': (n, joints, 3, frames), 'text': n texts, 'lengths': (n)}
/// This is an object of Python, which is read and not run. Joints are HumanML3D's 22, SMPL's 24 or KIT's 21; Y is up
/// unless the options say Z. A motion ends at its length. Its name is its number, or the first 160 bytes of its text,
/// so that the name fits into a file's name.
/// Source  Tevet et al., "Human Motion Diffusion Model" (ICLR 2023); GuyTevet/motion-diffusion-model sample/generate.py

#ifndef MOTIONLANG_HAS_FORMATS_MOTION_NPY_HPP  // <motionlang/formats/motion_npy.hpp>
#define MOTIONLANG_HAS_FORMATS_MOTION_NPY_HPP
/// Clips from NumPy arrays of joint positions or of features, as models and data sets have them.
///
///     Motion clip = read_motion_npy("new_joint_vecs/012314.npy");   // 263 numbers in a row: HumanML3D
///
///     (frames, numbers) of the features that motion_features.hpp names, known by the width of a row: not normalised
///     (frames, 24 or 22, 3) joints of SMPL, (frames, 21, 3) of MMM
/// Several motions in one file: mdm_results.hpp.
/// Positions become rotations by motion_from_joints.hpp. MMM's joints are in metres or, if they are large, in KIT's
/// units; with Y up they are reflected, as KIT has them and TEMOS makes them, and are reflected back, so that "L" is
/// the left.
/// Source  specs humanml3d-features.md 1.2 and 10, temos.md 4.3

MOTIONLANG_NAMESPACE_BEGIN

struct NpyArray;

enum class UpAxis { found, y, z };

struct MotionArrayOptions {
  double fps = 0;             // 0: as published, 20 or 12.5 frames per second
  UpAxis up = UpAxis::found;  // of positions: where, on average, the head is above the ankles
};

namespace detail {

bool is_joint_count(Index joints);

}  // namespace detail

/// Throws io_error 407 if the array has none of these shapes; shape_error 205, numeric_error 301 for values that are
/// not finite; config_error 101 unless the rate is 0 or positive and finite.
Motion motion_from_array(const NpyArray& array, const MotionArrayOptions& options = {},
                         std::string_view name = "array");

/// Throws io_error 401 to 405 besides.
Motion read_motion_npy(const FilePath& path, const MotionArrayOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_MOTION_NPY_IPP  // <motionlang/formats/motion_npy.ipp>
#define MOTIONLANG_HAS_FORMATS_MOTION_NPY_IPP
// Bodies of motion_npy.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool is_joint_count(Index joints) { return joints == 24 || joints == 22 || joints == mmm_joints; }

inline Motion motion_from_positions(std::vector<Vec3<double>> joints, Index count, const MotionArrayOptions& options) {
  const Vec3<double> height = mean_height(joints, static_cast<std::size_t>(count));
  const bool z_up = options.up == UpAxis::z || (options.up == UpAxis::found && std::abs(height.z) > std::abs(height.y));
  if (z_up) joints = turned_up(std::move(joints), false);
  if (count != mmm_joints)
    return motion_from_joints(smpl24_skeleton(), joints, count, options.fps > 0 ? options.fps : 20);
  if (z_up) {  // these were not reflected
    for (Vec3<double>& p : joints) p.x = -p.x;
  }
  return motion_from_joints(kit21_skeleton(), mmm_in_metres(std::move(joints)), options.fps > 0 ? options.fps : 12.5);
}

inline Motion motion_from_rows(std::span<const double> rows, Index width, double fps, std::string_view name) {
  for (const MotionFeatures& f : all_motion_features) {
    if (f.width == width) return motion_of_rows(f, rows, fps);
  }
  raise<io_error>(407, name, ": rows of ", counted(width, "number"), " are no features of motion that are known");
}

}  // namespace detail

MOTIONLANG_BODY Motion motion_from_array(const NpyArray& array, const MotionArrayOptions& options,
                                         std::string_view name) {
  if (options.fps != 0 && !(options.fps > 0 && std::isfinite(options.fps)))
    raise<config_error>(101, name, ": ", options.fps, " frames per second");
  const auto& shape = array.shape;
  const bool rows = shape.size() == 2;
  const bool joints = shape.size() == 3 && shape[2] == 3 && detail::is_joint_count(shape[1]);
  if ((!rows && !joints) || array.is_text()) {
    raise<io_error>(407, name, ": neither (frames, numbers) nor (frames, 21, 22 or 24 joints, 3)");
  }
  const std::vector<double> v = array.to<double>();
  const auto odd = std::find_if(v.begin(), v.end(), [](double x) { return !std::isfinite(x); });
  if (odd != v.end()) {
    const Index numbers = std::ssize(v) / shape[0], at = odd - v.begin();
    raise<numeric_error>(301, name, ": number ", at % numbers, " of frame ", at / numbers, " is not finite");
  }
  if (rows) return detail::motion_from_rows(v, shape[1], options.fps, name);
  std::vector<Vec3<double>> positions;
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) positions.push_back({v[i], v[i + 1], v[i + 2]});
  return detail::motion_from_positions(std::move(positions), shape[1], options);
}

MOTIONLANG_BODY Motion read_motion_npy(const FilePath& path, const MotionArrayOptions& options) {
  return motion_from_array(read_npy(path), options, path.string());
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// Whether a file of NumPy holds motions of MDM, by its header, which does not say what an object is.
/// Throws  io_error 401 to 405
bool may_be_mdm_motions(const FilePath& path);

/// All motions of a file: MDM's, or the only one of the others (motion_npy.hpp), which gets no name.
/// Throws  io_error 401 to 405, 406 if the object lacks an entry, 407 if something has another shape or type, and as
///         motion_from_array
std::vector<Motion> read_motions_npy(const FilePath& path, const MotionArrayOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_MDM_RESULTS_IPP  // <motionlang/formats/mdm_results.ipp>
#define MOTIONLANG_HAS_FORMATS_MDM_RESULTS_IPP
// Bodies of mdm_results.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A dictionary or another object that numpy.save was given: an array of objects without sizes.
inline bool is_single_object(const NpyHeader& header) { return header.descr == "|O" && header.shape.empty(); }

inline bool is_mdm_shape(std::span<const Index> shape) {
  return shape.size() == 4 && shape[2] == 3 && is_joint_count(shape[1]);
}

/// lengths  frames of each motion; none: all of them. One beyond the frames cuts nothing, as in MDM's own pictures
inline std::vector<Motion> mdm_motions(const NpyArray& array, std::span<const std::int64_t> lengths,
                                       MotionArrayOptions options, const std::string& name) {
  const auto& shape = array.shape;
  if (!is_mdm_shape(shape) || array.count() == 0 || array.is_text())
    raise<io_error>(407, name, ": motions ", shape_text(shape), " of type ", array.type(),
                    ", expected numbers (motions, 21, 22 or 24 joints, 3, frames)");
  if (options.up == UpAxis::found) options.up = UpAxis::y;
  const Index rows = 3 * shape[1], frames = shape[3];
  const std::vector<double> values = array.to<double>();
  std::vector<Motion> out;
  for (Index i = 0; i < shape[0]; ++i) {
    const Index length = lengths.empty() ? frames : std::min<Index>(lengths[static_cast<std::size_t>(i)], frames);
    if (length < 1) raise<io_error>(407, name, ": motion ", i, " has ", length, " of ", counted(frames, "frame"));
    std::vector<double> positions;  // (length, joints, 3)
    for (Index f = 0; f < length; ++f) {
      for (Index row = 0; row < rows; ++row)
        positions.push_back(values[static_cast<std::size_t>((i * rows + row) * frames + f)]);
    }
    out.push_back(motion_from_array(NpyArray::of(std::span<const double>(positions), {length, shape[1], 3}), options,
                                    concat_text(name, ": motion ", i)));
    out.back().name = std::to_string(i);
  }
  return out;
}

/// The text of a motion, or its texts where they change on the way, cut behind a whole character.
inline std::string mdm_name(const PickleValue& text) {
  constexpr std::size_t longest = 160;
  std::string all;
  if (text.is(PickleKind::list)) {
    for (std::size_t i = 0; i < text.size() && all.size() <= longest; ++i)
      all += concat_text(i == 0 ? "" : ", ", text[i].text().substr(0, longest + 1));
  } else {
    all = text.text().substr(0, longest + 1);
  }
  std::size_t end = 0;
  for (std::size_t next = 0; next < all.size(); end = next <= longest ? next : end) decode_utf8(all, next);
  return all.substr(0, end);
}

inline std::vector<Motion> mdm_motions(const PickleValue& object, const MotionArrayOptions& options) {
  if (!is_numpy_array(object) || object.state()[4].size() != 1) object.fail(407, "not one object");
  const PickleValue results = object.state()[4][0];  // version, shape, element type, order, elements
  const PickleValue texts = results["text"];
  const NpyArray array = to_array(results["motion"]);
  const auto lengths = to_array(results["lengths"]).to<std::int64_t>();
  const Index motions = array.shape.empty() ? 0 : array.shape[0];
  if (std::ssize(lengths) != motions || static_cast<Index>(texts.size()) != motions)
    results.fail(407, counted(motions, "motion"), ", ", counted(lengths.size(), "length"), " and ",
                 counted(texts.size(), "text"));
  std::vector<Motion> out = mdm_motions(array, lengths, options, object.file());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::string text = mdm_name(texts[i]); !text.empty()) out[i].name = std::move(text);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY bool may_be_mdm_motions(const FilePath& path) {
  const auto file = MappedFile::open(path);
  const auto header = detail::npy_parts(file->bytes(), path.string()).header;
  return detail::is_single_object(header) || detail::is_mdm_shape(header.shape);
}

MOTIONLANG_BODY std::vector<Motion> read_motions_npy(const FilePath& path, const MotionArrayOptions& options) {
  const auto file = MappedFile::open(path);
  const detail::NpyParts npy = detail::npy_parts(file->bytes(), path.string());
  if (detail::is_single_object(npy.header)) {
    const std::uint64_t start = file->bytes().size() - npy.raw.size();
    const Pickle pickle(file->bytes(), path.string(), {}, nullptr, start);
    if (const auto behind = file->bytes().size() - pickle.end(); behind > 0)
      raise<io_error>(403, path.string(), ": ", counted(behind, "byte"), " behind the object, which ends at byte ",
                      pickle.end());
    return detail::mdm_motions(pickle.root(), options);
  }
  const NpyArray array = parse_npy(file->bytes(), path.string());
  if (array.shape.size() == 4) return detail::mdm_motions(array, {}, options, path.string());
  return {motion_from_array(array, options, path.string())};
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_MERGED_BODY_HPP  // <motionlang/formats/merged_body.hpp>
#define MOTIONLANG_HAS_FORMATS_MERGED_BODY_HPP
/// SMPL-H with the hands of MANO in one file, as TEMOS wants it: the downloads have them apart.
///
///     merge_smplh("smplh/male/model.npz", "MANO_LEFT.pkl", "MANO_RIGHT.pkl", "smplh/SMPLH_MALE.npz");
///
/// Source   spec weights.md 8.1: hands_components, hands_mean, hands_coeffs of MANO, with l and r behind them
/// Differs  from TEMOS' script: the members of the archive are stored, not deflated; what forward passes do not read is
///          left out

MOTIONLANG_NAMESPACE_BEGIN

/// Throws  io_error 401 to 407 for files that cannot be read, are no body of 52 joints or no hand; numeric_error 301
void merge_smplh(const FilePath& body, const FilePath& left, const FilePath& right, const FilePath& out);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_MERGED_BODY_IPP  // <motionlang/formats/merged_body.ipp>
#define MOTIONLANG_HAS_FORMATS_MERGED_BODY_IPP
// Bodies of merged_body.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void merge_smplh(const FilePath& body, const FilePath& left, const FilePath& right,
                                 const FilePath& out) {
  const detail::BodyArrays arrays(body);
  if (const auto joints = std::ssize(detail::body_parents(arrays)); body_kind_of(joints) != BodyKind::smplh)
    raise<io_error>(407, arrays.file(), ": a body of ", counted(joints, "joint"),
                    "; hands belong to SMPL-H, which has 52");
  std::vector<NamedArray> merged;
  for (const char* name : {"v_template", "f", "shapedirs", "posedirs", "J_regressor", "weights", "kintree_table"})
    merged.push_back({name, arrays.read(name)});
  if (arrays.has("J")) merged.push_back({"J", arrays.read("J")});
  for (const auto& [file, side] : {std::pair{&left, "l"}, {&right, "r"}}) {
    const detail::BodyArrays hand(*file);
    for (const auto& [name, shape] :
         {std::pair{"hands_components", std::vector<Index>{-1, 45}}, {"hands_mean", {45}}}) {
      if (!hand.has(name)) raise<io_error>(406, hand.file(), ": no '", name, "'; not a hand of MANO");
      hand.read<double>(name, shape);  // of that shape, and finite
      merged.push_back({concat_text(name, side), hand.read(name)});
    }
    if (hand.has("hands_coeffs")) merged.push_back({concat_text("hands_coeffs", side), hand.read("hands_coeffs")});
  }
  write_npz(out, merged);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_FORMATS_SKELETON_TABLE_FILE_HPP  // <motionlang/formats/skeleton_table_file.hpp>
#define MOTIONLANG_HAS_FORMATS_SKELETON_TABLE_FILE_HPP
/// A table of the user's own: which joint of a skeleton has the part of which joint of SMPL. One line for each joint of
/// SMPL, fields between tabs:
///
///     pelvis<TAB>Bip01 Pelvis
///     left_hip<TAB>Bip01 L Thigh<TAB>+z-x
/// The third field are the local axes of the joint that point to the left and up in a T-pose, "+x+y" unless given.
/// Empty lines and those that begin with # are skipped. Joints of SMPL without a line follow none.

MOTIONLANG_NAMESPACE_BEGIN

/// The table of a text for a skeleton.
/// Throws  with the line: io_error 403 for a line without two or three fields, config_error 103 for a joint that
///         SMPL or the skeleton lacks, and for unknown axes, 102 for a second line of the same joint;
///         config_error 103 if the pelvis, a hip, a knee or an ankle has no line
SkeletonTable parse_skeleton_table(std::string_view text, const Skeleton& skeleton,
                                   std::string_view name = "table of joints");
/// Throws io_error 401 and as parse_skeleton_table.
SkeletonTable read_skeleton_table(const FilePath& path, const Skeleton& skeleton);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_SKELETON_TABLE_FILE_IPP  // <motionlang/formats/skeleton_table_file.ipp>
#define MOTIONLANG_HAS_FORMATS_SKELETON_TABLE_FILE_IPP
// Bodies of skeleton_table_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SkeletonTable parse_skeleton_table(std::string_view text, const Skeleton& skeleton,
                                                   std::string_view name) {
  SkeletonTable table{.name = std::string(name), .joints = {}, .level_soles = true};
  std::array<Index, 24> line_of{};  // 0: none yet
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    if (detail::trim(line).empty() || detail::trim(line).starts_with('#')) return;
    std::array<std::string_view, 3> fields{"", "", "+x+y"};
    std::size_t n = 0;
    for (std::size_t at = 0; at <= line.size(); ++n) {
      const std::size_t end = std::min(line.find('\t', at), line.size());
      if (n < fields.size()) fields[n] = detail::trim(line.substr(at, end - at));
      at = end + 1;
    }
    const auto& [target, source, axes] = fields;
    if (n < 2 || n > 3 || source.empty())
      raise<io_error>(403, name, ":", number, ": '", line, "' is not 'joint of SMPL<TAB>joint[<TAB>axes]'");
    const int role = smpl24_skeleton().find(target);
    if (role < 0)
      raise<config_error>(103, name, ":", number, ": '", target,
                          "' is no joint of SMPL: ", join_text(smpl24_skeleton().names));
    Index& before = line_of[static_cast<std::size_t>(role)];
    if (before > 0) raise<config_error>(102, name, ":", number, ": '", target, "' is in line ", before, " already");
    before = number;
    if (find_joint(skeleton, source) < 0)
      raise<config_error>(103, name, ":", number, ": the skeleton has no joint '", source,
                          "': ", join_text(skeleton.names));
    table.joints.push_back({std::string(target), std::string(source), std::string(axes)});
    if (!detail::is_axes(axes))
      raise<config_error>(103, name, ":", number, ": '", axes, "' does not name two axes, as +x+y does");
  });
  for (const char* needed :
       {"pelvis", "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle"}) {
    if (table.find(needed) == nullptr) raise<config_error>(103, name, ": no line says which joint is '", needed, "'");
  }
  return table;
}

MOTIONLANG_BODY SkeletonTable read_skeleton_table(const FilePath& path, const Skeleton& skeleton) {
  return parse_skeleton_table(detail::as_text(MappedFile::open(path)->bytes()), skeleton, path.string());
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_ACTION_NAMES_HPP  // <motionlang/datasets/action_names.hpp>
#define MOTIONLANG_HAS_DATASETS_ACTION_NAMES_HPP
/// What the classes of data sets of actions are called, by their numbers.
/// Source  spec actor.md 8.1

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr std::string_view humanact12_actions[] = {
    "warm_up", "walk",   "run",  "jump", "drink", "lift_dumbbell", "sit", "eat", "turn steering wheel",
    "phone",   "boxing", "throw"};

/// What a data set calls its classes; nothing if they are only numbers, or are not so many.
inline std::vector<std::string> action_labels(std::string_view dataset, Index classes) {
  if (dataset != "humanact12" || classes != std::ssize(humanact12_actions)) return {};
  return {std::begin(humanact12_actions), std::end(humanact12_actions)};
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_DATASETS_AMASS_RELEASES_HPP  // <motionlang/datasets/amass_releases.hpp>
#define MOTIONLANG_HAS_DATASETS_AMASS_RELEASES_HPP
/// What is known to be wrong in the files of AMASS, and to have another name from one release to the next.
///
///     sequence.fps = corrected_amass_fps(path, sequence.fps);
///     for (const std::string& path : amass_paths(babel.feat_p)) ...      // the file of an annotation, of whatever
///     release
///
/// No reader corrects a rate by itself: a file that was resampled lies below the same name and says what is true.
/// Source  TEACH (Athanasiou et al., 3DV 2022), amass_files; specs teach.md 4.1, body-models.md 6

MOTIONLANG_NAMESPACE_BEGIN

/// Frames per second of a sequence as it was released, whatever its file says.
struct AmassRate {
  std::string_view path;  // a part of it
  double fps = 0;
};
inline constexpr std::array<AmassRate, 3> amass_rates{
    {{"BMLhandball", 240}, {"20160930_50032", 59}, {"20161014_50033", 59}}};

/// fps: what the file says; the result where it is right.
double corrected_amass_fps(std::string_view path, double fps);

/// Folders of data sets: as annotations of HumanML3D, BABEL and their like have them, and as they are released today.
struct AmassRename {
  std::string_view before, today;
};
inline constexpr std::array<AmassRename, 8> amass_renames{{{"BioMotionLab_NTroje", "BMLrub"},
                                                           {"DFaust_67", "DFaust"},
                                                           {"MPI_HDM05", "HDM05"},
                                                           {"MPI_Limits", "PosePrior"},
                                                           {"MPI_mosh", "MoSh"},
                                                           {"SSM_synced", "SSM"},
                                                           {"TCD_handMocap", "TCDHands"},
                                                           {"Transitions_mocap", "Transitions"}}};

/// The path of a sequence, then those with the names before and today where they differ from it.
std::vector<std::string> amass_paths(std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_AMASS_RELEASES_IPP  // <motionlang/datasets/amass_releases.ipp>
#define MOTIONLANG_HAS_DATASETS_AMASS_RELEASES_IPP
// Bodies of amass_releases.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double corrected_amass_fps(std::string_view path, double fps) {
  for (const AmassRate& known : amass_rates) {
    if (path.find(known.path) != path.npos) return known.fps;
  }
  return fps;
}

MOTIONLANG_BODY std::vector<std::string> amass_paths(std::string_view path) {
  auto renamed = [&](std::string_view AmassRename::*from, std::string_view AmassRename::*to) {
    std::string out;
    for (std::size_t at = 0; at <= path.size();) {
      const std::size_t end = std::min(path.find('/', at), path.size());
      std::string_view folder = path.substr(at, end - at);
      for (const AmassRename& r : amass_renames) {
        if (folder == r.*from) {
          folder = r.*to;
          break;
        }
      }
      out += folder;
      if (end < path.size()) out += '/';
      at = end + 1;
    }
    return out;
  };
  std::vector<std::string> out{std::string(path)};
  for (std::string other :
       {renamed(&AmassRename::today, &AmassRename::before), renamed(&AmassRename::before, &AmassRename::today)}) {
    if (other != path) out.push_back(std::move(other));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_AMASS_RESAMPLE_HPP  // <motionlang/datasets/amass_resample.hpp>
#define MOTIONLANG_HAS_DATASETS_AMASS_RESAMPLE_HPP
/// How STMC's training data were prepared from AMASS: another frame rate, and mirrored copies. For parity; for clips of
/// one's own use kinematics/motion_tools.hpp.
///
/// Source  STMC, prepare/amasstools/fix_fps.py and smpl_mirroring.py

MOTIONLANG_NAMESPACE_BEGIN

/// SMPL poses as AMASS files have them.
template <Scalar S>
struct AmassPoses {
  std::vector<S> poses;  // (frames, 3 joints) rotation vectors
  std::vector<S> trans;  // (frames, 3)
};

namespace detail {

/// Numbers of one pose. Throws shape_error 205 unless both arrays have the same number of frames.
template <Scalar S>
std::size_t amass_width(std::span<const S> poses, std::span<const S> trans, const char* op) {
  const std::size_t frames = trans.size() / 3;
  if (trans.size() % 3 != 0 || (frames == 0 ? !poses.empty() : poses.size() % (3 * frames) != 0)) {
    raise<shape_error>(205, op, ": ", poses.size(), " pose values for ", trans.size(), " translation values");
  }
  return frames == 0 ? 0 : poses.size() / frames;
}

/// Spherical interpolation of vectors that keep their lengths as weights:
///     (sin((1-t) h) a + sin(t h) b) / sin h,   h: the angle between a and b; linear if |cos h| > 0.9995 or one is zero
/// Not a rotation halfway between two rotations, but what the data were made with.
template <Scalar S>
Vec3<S> slerp_of_vectors(const Vec3<S>& a, const Vec3<S>& b, S t) {
  const S lengths = norm(a) * norm(b), cosine = lengths > 0 ? dot(a, b) / lengths : S(1);
  if (std::abs(cosine) > S(0.9995)) return (S(1) - t) * a + t * b;
  const S h = std::acos(cosine), sine = std::sin(h);
  return (std::sin((S(1) - t) * h) / sine) * a + (std::sin(t * h) / sine) * b;
}

}  // namespace detail

/// floor(T new / old) frames; frame i shows the source at (i + 1/2) old / new - 1/2, not before its first frame.
/// Coordinates are float32, as published. Translations linear, poses by slerp of their rotation vectors.
/// Throws shape_error 205, config_error 101 unless both rates are positive.
template <Scalar S>
AmassPoses<S> amass_resample(std::span<const S> poses, std::span<const S> trans, double old_fps, double new_fps) {
  detail::require_rates("amass_resample", old_fps, new_fps);
  const std::size_t width = detail::amass_width(poses, trans, "amass_resample"), source = trans.size() / 3;
  const auto frames = static_cast<std::size_t>(std::floor(static_cast<double>(source) * new_fps / old_fps));
  AmassPoses<S> out;
  for (std::size_t i = 0; i < frames; ++i) {
    const auto ratio = static_cast<float>(old_fps / new_fps);
    const float at = std::max((static_cast<float>(i) + 0.5f) * ratio - 0.5f, 0.0f);
    const std::size_t a = std::min(static_cast<std::size_t>(at), source - 1), b = std::min(a + 1, source - 1);
    const S t = static_cast<S>(at - static_cast<float>(a));
    for (std::size_t k = 0; k < 3; ++k) out.trans.push_back((S(1) - t) * trans[3 * a + k] + t * trans[3 * b + k]);
    for (std::size_t k = 0; k < width; k += 3) {
      const S *p = &poses[a * width + k], *q = &poses[b * width + k];
      const auto v = detail::slerp_of_vectors<S>({p[0], p[1], p[2]}, {q[0], q[1], q[2]}, t);
      out.poses.insert(out.poses.end(), {v.x, v.y, v.z});
    }
  }
  return out;
}

/// Left and right exchanged: partners swap their rotation vectors, whose y and z change sign, and the path its x.
/// Exact. Throws shape_error 205 unless poses have the 22 or 24 joints of SMPL.
template <Scalar S>
AmassPoses<S> amass_mirror(std::span<const S> poses, std::span<const S> trans) {
  const std::size_t width = detail::amass_width(poses, trans, "amass_mirror"), frames = trans.size() / 3;
  if (frames != 0 && width != 66 && width != 72) {
    raise<shape_error>(205, "amass_mirror: poses of ", width, " values; expected 66 or 72");
  }
  AmassPoses<S> out{{poses.begin(), poses.end()}, {trans.begin(), trans.end()}};
  for (std::size_t f = 0; f < frames; ++f) {
    out.trans[3 * f] = -trans[3 * f];
    for (std::size_t j = 0; 3 * j < width; ++j) {
      const S* from = &poses[f * width + 3 * static_cast<std::size_t>(smpl_mirror_joint[j])];
      S* to = &out.poses[f * width + 3 * j];
      to[0] = from[0], to[1] = -from[1], to[2] = -from[2];
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_DATASETS_ANNOTATIONS_HPP  // <motionlang/datasets/annotations.hpp>
#define MOTIONLANG_HAS_DATASETS_ANNOTATIONS_HPP
/// The annotation JSON of TMR and STMC: which texts describe which seconds of which AMASS sequence. Read entry by
/// entry, written in the published layout.
///
///     {"000000": {"path": "KIT/3/kick_high_left02_poses", "duration": 5.82, "annotations": [
///         {"seg_id": "000000_0", "text": "a man kicks.", "start": 0.0, "end": 5.82}, ...]}, ...}
///
///     const auto file = AnnotationFile::open("annotations.json");
///     for (const std::string& id : file.select(read_ids("splits/train.txt"))) {
///       for (const Annotation& a : training_annotations(file.load(id), "train")) ...
///     }
///
/// Source  AMASS-Annotation-Unifier; TMR (Petrovich et al. 2023), src/data/text_motion.py; spec exchange-formats.md 5.1

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

struct Annotation {
  std::string seg_id;  // "<id>_<number>"
  std::string text;
  double start = 0, end = 0;  // seconds
  std::string babel_id{};     // of a label of BABEL: its seg_id there
  bool operator==(const Annotation&) const = default;
};

struct AnnotatedMotion {
  std::string id;
  std::string path;  // AMASS-relative, without extension; "M/..." of mirrored motions, "humanact12/..." of HumanAct12
  double duration = 0;  // seconds
  std::vector<Annotation> annotations;
  bool operator==(const AnnotatedMotion&) const = default;
};

/// An annotation file that is being read. Entries are parsed when they are asked for.
class AnnotationFile {
 public:
  /// What is open already.
  explicit AnnotationFile(JsonMembers members) : members_(std::move(members)) {}
  /// Throws io_error 401, 403 (JsonMembers).
  static AnnotationFile open(const FilePath& path);
  static AnnotationFile from_text(std::string text, std::string name = "annotations");

  /// In the order of the file.
  const std::vector<std::string>& ids() const { return members_.keys(); }
  bool has(const std::string& id) const { return members_.has(id); }

  /// Throws config_error 103 for an unknown id, 107 for a value of the wrong kind (with its path), io_error 403 for
  /// malformed JSON (with line and column) and for times that are not valid.
  AnnotatedMotion load(const std::string& id) const;
  /// The motion of an entry. Throws what load throws for its values.
  static AnnotatedMotion parse(const std::string& id, const JsonView& view);

  /// The ids of a split that have an entry, in the order of the split. Others are left out silently, as published.
  std::vector<std::string> select(std::span<const std::string> split) const;

 private:
  JsonMembers members_;
};

/// What TMR trains on: texts of 2 to 10 seconds. A split whose name contains "test" keeps all. Motions without any are
/// left out of the split. Evaluation takes the first text.
std::vector<Annotation> training_annotations(const AnnotatedMotion& motion, std::string_view split, double least = 2,
                                             double most = 10);

/// The frames of a text: int(start fps) up to int(end fps), as far as the motion goes.
FrameSlice annotated_frames(const Annotation& a, double fps, Index frames);

/// The entry of the mirrored motion: "M" in front of id, seg_id and path, and captions of the other side.
AnnotatedMotion mirrored(AnnotatedMotion motion);

/// The text of an annotation file, laid out as the published ones.
/// Laws    AnnotationFile::from_text(annotations_json(x)) loads x
/// Throws  io_error 403 for a repeated id, a text that is not UTF-8, and times that are not valid
std::string annotations_json(std::span<const AnnotatedMotion> motions);
/// Throws io_error 401 and as annotations_json.
void write_annotations(const FilePath& path, std::span<const AnnotatedMotion> motions);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_ANNOTATIONS_IPP  // <motionlang/datasets/annotations.ipp>
#define MOTIONLANG_HAS_DATASETS_ANNOTATIONS_IPP
// Bodies of annotations.hpp.

#ifndef MOTIONLANG_HAS_DATASETS_DETAIL_ANNOTATED_TIMES_HPP  // <motionlang/datasets/detail/annotated_times.hpp>
#define MOTIONLANG_HAS_DATASETS_DETAIL_ANNOTATED_TIMES_HPP
/// The check of times in annotation files.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// Throws io_error 403 unless 0 <= start <= end are times, with the place in the message.
inline void require_times(std::string_view place, double start, double end) {
  if (!(start >= 0 && start <= end && std::isfinite(end)))
    raise<io_error>(403, place, ": from ", start, " to ", end, " seconds");
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY AnnotationFile AnnotationFile::open(const FilePath& path) {
  return AnnotationFile(JsonMembers::open(path));
}

MOTIONLANG_BODY AnnotationFile AnnotationFile::from_text(std::string text, std::string name) {
  return AnnotationFile(JsonMembers::from_text(std::move(text), std::move(name)));
}

MOTIONLANG_BODY AnnotatedMotion AnnotationFile::load(const std::string& id) const {
  const nlohmann::json document = members_.load(id);
  return parse(id, JsonView(document, members_.place(id)));
}

MOTIONLANG_BODY AnnotatedMotion AnnotationFile::parse(const std::string& id, const JsonView& view) {
  AnnotatedMotion motion{id, view["path"].as<std::string>(), view["duration"].as<double>(), {}};
  detail::require_times(view["duration"].path(), 0, motion.duration);
  const JsonView list = view["annotations"];
  for (Index i = 0; i < list.size(); ++i) {
    const JsonView a = list[i];
    motion.annotations.push_back({a["seg_id"].as<std::string>(), a["text"].as<std::string>(), a["start"].as<double>(),
                                  a["end"].as<double>(), a.value_or("babel_id", "")});
    detail::require_times(a.path(), motion.annotations.back().start, motion.annotations.back().end);
  }
  return motion;
}

MOTIONLANG_BODY std::vector<std::string> AnnotationFile::select(std::span<const std::string> split) const {
  std::vector<std::string> out;
  std::copy_if(split.begin(), split.end(), std::back_inserter(out), [&](const std::string& id) { return has(id); });
  return out;
}

MOTIONLANG_BODY std::vector<Annotation> training_annotations(const AnnotatedMotion& motion, std::string_view split,
                                                             double least, double most) {
  if (split.find("test") != split.npos) return motion.annotations;
  std::vector<Annotation> out;
  for (const Annotation& a : motion.annotations) {
    if (a.end - a.start >= least && a.end - a.start <= most) out.push_back(a);
  }
  return out;
}

MOTIONLANG_BODY FrameSlice annotated_frames(const Annotation& a, double fps, Index frames) {
  return slice_of_seconds(a.start, a.end, fps, frames);
}

MOTIONLANG_BODY AnnotatedMotion mirrored(AnnotatedMotion motion) {
  motion.id = mirrored_id(motion.id);
  motion.path = concat_text("M/", motion.path);
  for (Annotation& a : motion.annotations) {
    a.seg_id = mirrored_id(a.seg_id);
    a.text = mirror_caption(a.text);
  }
  return motion;
}

MOTIONLANG_BODY std::string annotations_json(std::span<const AnnotatedMotion> motions) {
  std::string out = "{";
  std::unordered_set<std::string_view> seen;
  for (const AnnotatedMotion& m : motions) {
    const std::string place = "annotations: " + m.id;
    auto checked = [&](const std::string& text) {
      if (!is_utf8(text)) raise<io_error>(403, place, ": a text is not UTF-8");
      return text;
    };
    if (!seen.insert(m.id).second) raise<io_error>(403, place, ": the id is repeated");
    detail::require_times(place, 0, m.duration);
    auto list = nlohmann::ordered_json::array();
    for (const Annotation& a : m.annotations) {
      detail::require_times(place, a.start, a.end);
      list.push_back({{"seg_id", checked(a.seg_id)}, {"text", checked(a.text)}, {"start", a.start}, {"end", a.end}});
      if (!a.babel_id.empty()) list.back()["babel_id"] = checked(a.babel_id);
    }
    const nlohmann::ordered_json entry{
        {"path", checked(m.path)}, {"duration", m.duration}, {"annotations", std::move(list)}};
    out += (out.size() == 1 ? "\n  " : ",\n  ") + nlohmann::json(checked(m.id)).dump(-1, ' ', true) + ": ";
    for (const char c : entry.dump(2, ' ', true)) {
      out += c;
      if (c == '\n') out += "  ";
    }
  }
  return out + (motions.empty() ? "}" : "\n}");
}

MOTIONLANG_BODY void write_annotations(const FilePath& path, std::span<const AnnotatedMotion> motions) {
  write_file(path, annotations_json(motions));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_BABEL_HPP  // <motionlang/datasets/babel.hpp>
#define MOTIONLANG_HAS_DATASETS_BABEL_HPP
/// BABEL: texts for whole sequences of AMASS and for stretches of them. Read entry by entry; the stretches as TEACH and
/// SINC take them; and all texts as an entry of the annotation JSON of TMR and STMC.
///
///     const auto file = BabelFile::open("train.json");
///     for (const std::string& id : file.ids()) {
///       const BabelSequence sequence = file.load(id);
///       for (const auto& a : sequence.frame_annotations) use(babel_segments(a.labels, 30, frames, spelling));
///     }
///
/// Source  Punnakkal et al. (CVPR 2021), babel v1.0; TEACH and SINC, extract_frame_labels; spec exchange-formats.md 5.1
///         and 5.4, teach.md 4, sinc.md 5, tmr.md 8.1

#ifndef MOTIONLANG_HAS_DATASETS_BABEL_SEGMENT_HPP  // <motionlang/datasets/babel_segment.hpp>
#define MOTIONLANG_HAS_DATASETS_BABEL_SEGMENT_HPP
/// Stretches of a motion with a text, as BABEL has them. What TEACH and SINC make of them: teach_pairs.hpp,
/// simultaneous_segments.hpp. Read by datasets/babel.hpp.

MOTIONLANG_NAMESPACE_BEGIN

/// Frames [start, end) with their text.
struct BabelSegment {
  Index start = 0, end = 0;
  std::string text;
  bool operator==(const BabelSegment&) const = default;

  bool is_transition() const { return text == "transition"; }
};

/// Labels that TEACH and SINC train nothing on.
inline constexpr std::array<std::string_view, 7> babel_excluded_labels{"t-pose", "a-pose", "a pose",    "t pose",
                                                                       "tpose",  "apose",  "transition"};
bool is_babel_excluded(std::string_view label);

/// The segments that SINC takes, in their order: without empty ones and excluded labels. One without text stays here
/// (it
/// counts as simultaneous with others) and is nothing to train on. Source  spec sinc.md 5.1
std::vector<BabelSegment> sinc_segments(std::vector<BabelSegment> segments);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_BABEL_SEGMENT_IPP  // <motionlang/datasets/babel_segment.ipp>
#define MOTIONLANG_HAS_DATASETS_BABEL_SEGMENT_IPP
// Bodies of babel_segment.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool is_babel_excluded(std::string_view label) {
  return std::find(babel_excluded_labels.begin(), babel_excluded_labels.end(), label) != babel_excluded_labels.end();
}

MOTIONLANG_BODY std::vector<BabelSegment> sinc_segments(std::vector<BabelSegment> segments) {
  std::erase_if(segments, [](const BabelSegment& s) { return s.end <= s.start || is_babel_excluded(s.text); });
  return segments;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct BabelLabel {
  std::string raw_label, proc_label, seg_id;
  std::vector<std::string> act_cat;  // empty where the file has null
  double start = 0, end = 0;         // seconds; of a whole sequence: all of it
  bool operator==(const BabelLabel&) const = default;
};

/// By one annotator. Labels stand in the order of the file: not sorted, perhaps overlapping, the last one perhaps a few
/// milliseconds longer than the sequence.
struct BabelAnnotation {
  std::string babel_lid, anntr_id;
  bool mul_act = false;  // several actions
  std::vector<BabelLabel> labels;
  bool operator==(const BabelAnnotation&) const = default;
};

struct BabelSequence {
  std::string id;
  std::int64_t babel_sid = 0;
  std::string url, feat_p;  // feat_p: "CMU/CMU/141/141_05_poses.npz", the folder of the data set twice
  double dur = 0;           // seconds, rounded to hundredths; 0 if the file has none
  std::vector<BabelAnnotation> sequence_annotations, frame_annotations;
  bool operator==(const BabelSequence&) const = default;
};

/// A file that is being read: train, val, test (no labels), extra_train, extra_val (several annotations for a
/// sequence).
class BabelFile {
 public:
  /// What is open already.
  explicit BabelFile(JsonMembers members) : members_(std::move(members)) {}
  /// Throws io_error 401, 403 (JsonMembers).
  static BabelFile open(const FilePath& path);
  static BabelFile from_text(std::string text, std::string name = "BABEL");

  /// In the order of the file.
  const std::vector<std::string>& ids() const { return members_.keys(); }
  bool has(const std::string& id) const { return members_.has(id); }

  /// Throws config_error 103 for an unknown id, 107 for a value of the wrong kind (with its path), io_error 403 for
  /// malformed JSON (with line and column) and for times that are not valid.
  BabelSequence load(const std::string& id) const;
  /// Whether an entry is one of BABEL, and not one of the annotation JSON.
  static bool is_entry(const JsonView& view);
  /// The sequence of an entry. Throws what load throws for its values.
  static BabelSequence parse(const std::string& id, const JsonView& view);

 private:
  struct Times {
    double start, end;
    bool in_file;
  };

  /// An annotation, a list of them, null or nothing.
  static void read(const JsonView& entry, const std::string& key, const Times& times,
                   std::vector<BabelAnnotation>& out);
  static BabelAnnotation annotation(const JsonView& view, const Times& times);
  static BabelLabel label(const JsonView& view, const Times& times);

  JsonMembers members_;
};

/// What a word of a label is replaced by: "foward" by "forward", or by several words, or by none.
using SpellingTable = std::unordered_map<std::string, std::string>;

/// The label word by word through the table, joined by single blanks, which also surround words that are replaced by
/// nothing. The published table is the user's to supply.
std::string clean_babel_label(std::string_view label, const SpellingTable& spelling = {});

/// The stretches of an annotation in a motion of `frames` frames, in the order of the file and nothing left out:
/// int(start fps) up to int(end fps), cut at the end of the motion, perhaps empty. Throws config_error 101 unless the
/// rate is positive and finite.
std::vector<BabelSegment> babel_intervals(std::span<const BabelLabel> labels, double fps, Index frames,
                                          const SpellingTable& spelling = {});

struct BabelSegmentOptions {
  bool keep_transitions = false;  // TEACH pairs actions by the transition between them
};

/// Those to train on, sorted by start and end: without empty ones, those without text and excluded labels. Throws
/// config_error 101 unless the rate is positive and finite.
std::vector<BabelSegment> babel_segments(std::span<const BabelLabel> labels, double fps, Index frames,
                                         const SpellingTable& spelling = {}, const BabelSegmentOptions& options = {});

/// The texts of a sequence as an entry of the annotation JSON: those of the whole sequence, then those of stretches, in
/// the order of the file. The id has five digits or more, the path is that of AMASS: without the first of the two
/// folders and without extension. Labels without a word are left out, no others.
/// Throws  io_error 403 for a sequence without feat_p or dur
AnnotatedMotion annotated_motion(const BabelSequence& sequence, const SpellingTable& spelling = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_BABEL_IPP  // <motionlang/datasets/babel.ipp>
#define MOTIONLANG_HAS_DATASETS_BABEL_IPP
// Bodies of babel.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY BabelFile BabelFile::open(const FilePath& path) { return BabelFile(JsonMembers::open(path)); }

MOTIONLANG_BODY BabelFile BabelFile::from_text(std::string text, std::string name) {
  return BabelFile(JsonMembers::from_text(std::move(text), std::move(name)));
}

MOTIONLANG_BODY BabelSequence BabelFile::load(const std::string& id) const {
  const nlohmann::json document = members_.load(id);
  return parse(id, JsonView(document, members_.place(id)));
}

MOTIONLANG_BODY bool BabelFile::is_entry(const JsonView& view) { return view.contains("babel_sid"); }

MOTIONLANG_BODY BabelSequence BabelFile::parse(const std::string& id, const JsonView& view) {
  BabelSequence out{id,
                    view["babel_sid"].as<std::int64_t>(),
                    view.value_or("url", ""),
                    view.value_or("feat_p", ""),
                    view.value_or("dur", 0.0),
                    {},
                    {}};
  if (!(out.dur >= 0 && std::isfinite(out.dur))) raise<io_error>(403, view.path(), ": dur is ", out.dur);
  for (const char* key : {"seq_ann", "seq_anns"}) read(view, key, {0, out.dur, false}, out.sequence_annotations);
  for (const char* key : {"frame_ann", "frame_anns"}) read(view, key, {0, 0, true}, out.frame_annotations);
  return out;
}

MOTIONLANG_BODY void BabelFile::read(const JsonView& entry, const std::string& key, const Times& times,
                                     std::vector<BabelAnnotation>& out) {
  if (!entry.contains(key) || entry[key].is_null()) return;
  const JsonView view = entry[key];
  if (!view.is_array()) return out.push_back(annotation(view, times));
  for (Index i = 0; i < view.size(); ++i) {
    if (!view[i].is_null()) out.push_back(annotation(view[i], times));
  }
}

MOTIONLANG_BODY BabelAnnotation BabelFile::annotation(const JsonView& view, const Times& times) {
  BabelAnnotation out{
      view.value_or("babel_lid", ""), view.value_or("anntr_id", ""), view.value_or("mul_act", false), {}};
  const JsonView labels = view["labels"];
  for (Index i = 0; i < labels.size(); ++i) out.labels.push_back(label(labels[i], times));
  return out;
}

MOTIONLANG_BODY BabelLabel BabelFile::label(const JsonView& view, const Times& times) {
  BabelLabel out{view.value_or("raw_label", ""),
                 view.value_or("proc_label", ""),
                 view.value_or("seg_id", ""),
                 view.value_or("act_cat", std::vector<std::string>{}),
                 times.start,
                 times.end};
  if (times.in_file) {
    out.start = view["start_t"].as<double>();
    out.end = view["end_t"].as<double>();
    detail::require_times(view.path(), out.start, out.end);
  }
  return out;
}

MOTIONLANG_BODY std::string clean_babel_label(std::string_view label, const SpellingTable& spelling) {
  std::string out;
  const char* blank = "";
  for_each_word(label, [&](std::string_view word) {
    const auto found = spelling.find(std::string(word));
    out += std::exchange(blank, " ");
    out += found == spelling.end() ? word : found->second;
  });
  return out;
}

MOTIONLANG_BODY std::vector<BabelSegment> babel_intervals(std::span<const BabelLabel> labels, double fps, Index frames,
                                                          const SpellingTable& spelling) {
  if (!(fps > 0 && std::isfinite(fps))) raise<config_error>(101, "babel_intervals: ", fps, " frames per second");
  const auto frame = [&](double seconds, Index last) {
    return static_cast<Index>(std::min(seconds * fps, static_cast<double>(last)));
  };
  std::vector<BabelSegment> out;
  for (const BabelLabel& label : labels) {
    out.push_back(
        {frame(label.start, latest_time), frame(label.end, frames), clean_babel_label(label.proc_label, spelling)});
  }
  return out;
}

MOTIONLANG_BODY std::vector<BabelSegment> babel_segments(std::span<const BabelLabel> labels, double fps, Index frames,
                                                         const SpellingTable& spelling,
                                                         const BabelSegmentOptions& options) {
  std::vector<BabelSegment> out = babel_intervals(labels, fps, frames, spelling);
  std::erase_if(out, [&](const BabelSegment& s) {
    const bool kept = options.keep_transitions && s.is_transition();
    return s.end <= s.start || s.text.empty() || (is_babel_excluded(s.text) && !kept);
  });
  std::stable_sort(out.begin(), out.end(), [](const BabelSegment& a, const BabelSegment& b) {
    return std::pair(a.start, a.end) < std::pair(b.start, b.end);
  });
  return out;
}

MOTIONLANG_BODY AnnotatedMotion annotated_motion(const BabelSequence& sequence, const SpellingTable& spelling) {
  const std::string& id = sequence.id;
  if (sequence.feat_p.empty() || sequence.dur == 0)
    raise<io_error>(403, "BABEL: ", id, ": ", sequence.feat_p.empty() ? "no feat_p" : "no dur");
  const bool number = id.find_first_not_of("0123456789") == id.npos;
  AnnotatedMotion out{number && id.size() < 5 ? std::string(5 - id.size(), '0') + id : id,
                      sequence.feat_p.substr(sequence.feat_p.find('/') + 1),
                      sequence.dur,
                      {}};
  if (out.path.ends_with(".npz")) out.path.resize(out.path.size() - 4);
  for (const auto* annotations : {&sequence.sequence_annotations, &sequence.frame_annotations}) {
    for (const BabelAnnotation& a : *annotations) {
      for (const BabelLabel& label : a.labels) {
        std::string text = clean_babel_label(label.proc_label, spelling);
        if (text.empty()) continue;
        std::string seg_id = concat_text(out.id, "_", out.annotations.size());
        out.annotations.push_back({std::move(seg_id), std::move(text), label.start, label.end, label.seg_id});
      }
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_BODY_PART_TABLE_HPP  // <motionlang/datasets/body_part_table.hpp>
#define MOTIONLANG_HAS_DATASETS_BODY_PART_TABLE_HPP
/// A language model's answers about body parts from a file: label -> answers, of which SINC takes the third.
///
///     {"wave right hand": ["", "", "Answer: right arm"], ...}
///
/// Source  SINC (Athanasiou et al., ICCV 2023); spec sinc.md 6.1. The published table is the user's to supply.

MOTIONLANG_NAMESPACE_BEGIN

class JsonMembers;

/// Throws io_error 401, 403 (JsonMembers), config_error 107 if there is no such answer, 103 if it names no part.
BodyPartTable read_body_part_table(const JsonMembers& file, Index answer = 2);
BodyPartTable open_body_part_table(const FilePath& path, Index answer = 2);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_BODY_PART_TABLE_IPP  // <motionlang/datasets/body_part_table.ipp>
#define MOTIONLANG_HAS_DATASETS_BODY_PART_TABLE_IPP
// Bodies of body_part_table.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY BodyPartTable read_body_part_table(const JsonMembers& file, Index answer) {
  BodyPartTable table;
  for (const std::string& label : file.keys()) {
    const nlohmann::json answers = file.load(label);
    table.add(label, JsonView(answers, file.place(label))[answer].as<std::string>());
  }
  return table;
}

MOTIONLANG_BODY BodyPartTable open_body_part_table(const FilePath& path, Index answer) {
  return read_body_part_table(JsonMembers::open(path), answer);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_GUO_CLIP_HPP  // <motionlang/datasets/guo_clip.hpp>
#define MOTIONLANG_HAS_DATASETS_GUO_CLIP_HPP
/// Which clips, and which frames of them, the loader of Guo et al. hands to its evaluator and its models. The caption
/// beside them is `GloVe::framed`.
///
/// Source  text-to-motion data/dataset.py, Text2MotionDatasetV2; spec evaluation-guo.md 1.3, 2.4

MOTIONLANG_NAMESPACE_BEGIN

struct GuoClipLimits {
  Index least = 40;   // frames; KIT: 24
  Index below = 200;  // frames
  Index unit = 4;     // lengths are multiples
};
inline GuoClipLimits guo_clip_limits(bool kit) { return {.least = kit ? 24 : 40}; }

/// The clips that are kept, the shortest first; of equals in their order.
std::vector<Index> guo_kept_clips(std::span<const Index> lengths, const GuoClipLimits& limits = {});

/// Frames of an item: the whole units of the clip, one less where `shorter`, which one coin in three says.
/// Throws config_error 101 if that leaves none.
Index guo_item_frames(Index frames, bool shorter, Index unit = 4);
/// The same, from a random start on: NumPy draws the coin, then Python the start.
FrameSlice guo_item(Index frames, NumpyRandom& coin, PythonRandom& start, Index unit = 4);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_GUO_CLIP_IPP  // <motionlang/datasets/guo_clip.ipp>
#define MOTIONLANG_HAS_DATASETS_GUO_CLIP_IPP
// Bodies of guo_clip.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> guo_kept_clips(std::span<const Index> lengths, const GuoClipLimits& limits) {
  std::vector<Index> out;
  auto frames = [&](Index clip) { return lengths[static_cast<std::size_t>(clip)]; };
  for (Index i = 0; i < std::ssize(lengths); ++i) {
    if (frames(i) >= limits.least && frames(i) < limits.below) out.push_back(i);
  }
  std::stable_sort(out.begin(), out.end(), [&](Index a, Index b) { return frames(a) < frames(b); });
  return out;
}

MOTIONLANG_BODY Index guo_item_frames(Index frames, bool shorter, Index unit) {
  const Index units = unit > 0 ? frames / unit - (shorter ? 1 : 0) : 0;
  if (units < 1) raise<config_error>(101, "guo_item_frames: of ", frames, " frames in units of ", unit);
  return units * unit;
}

MOTIONLANG_BODY FrameSlice guo_item(Index frames, NumpyRandom& coin, PythonRandom& start, Index unit) {
  const Index length = guo_item_frames(frames, coin.randint(0, 3) == 2, unit);
  return {static_cast<Index>(start.randint(0, frames - length)), length};
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_HUMANML3D_FOLDER_HPP  // <motionlang/datasets/humanml3d_folder.hpp>
#define MOTIONLANG_HAS_DATASETS_HUMANML3D_FOLDER_HPP
/// Data sets in the form of HumanML3D, which KIT-ML and most own data take, too: read clip by clip, and written.
///
///     new_joint_vecs/<id>.npy  (N, 263) float32        texts/<id>.txt      captions (humanml3d_texts.hpp)
///     new_joints/<id>.npy      (N, 22, 3) float32      Mean.npy, Std.npy   (263) float32
///     train.txt, val.txt, test.txt, train_val.txt, all.txt    ids, of mirrored clips with an M in front
///
///     const HumanMl3dFolder data("HumanML3D");
///     for (const std::string& id : data.ids("train")) use(data.load(id));
///
/// Source  Guo et al. (CVPR 2022); spec humanml3d-features.md 10, exchange-formats.md 5.2

#ifndef MOTIONLANG_HAS_DATASETS_HUMANML3D_TEXTS_HPP  // <motionlang/datasets/humanml3d_texts.hpp>
#define MOTIONLANG_HAS_DATASETS_HUMANML3D_TEXTS_HPP
/// The captions of a clip of HumanML3D or KIT-ML (texts/<id>.txt), and index.csv, which says what the clips were cut
/// from.
///
///     caption#word/POS word/POS ...#start#end          seconds; 0.0 and 0.0: the whole clip; "nan" is 0
///
/// Source  Guo et al. (CVPR 2022); spec humanml3d-features.md 8 and 10, exchange-formats.md 5.2

#ifndef MOTIONLANG_HAS_DATASETS_HUMANML3D_SOURCE_HPP  // <motionlang/datasets/humanml3d_source.hpp>
#define MOTIONLANG_HAS_DATASETS_HUMANML3D_SOURCE_HPP
/// From raw AMASS to the joints that HumanML3D begins with: which frames a row of index.csv takes, and the axes. The
/// body is the caller's: a function that poses frames, such as a BodyModel of SMPL-H on the user's own model file.
///
/// Source   Guo et al. (CVPR 2022), raw_pose_processing.ipynb; spec humanml3d-features.md 8
/// World    in: Z up, metres (AMASS); out: Y up, (x, y, z) -> (-x, z, y). HumanAct12 clips come as joints that are Y up
///          and stay as they are, and the index is not applied to them.
///
///     const auto joints = humanml3d_source_joints<double>(row, frames, fps, [&](std::span<const Index> numbers) {
///       return posed_joints(model, sequence, numbers);      // (numbers.size(), J), J >= 22
///     });

MOTIONLANG_NAMESPACE_BEGIN

/// A row of index.csv: a clip is a part of a sequence.
struct HumanMl3dSource {
  std::string source_path;  // "./pose_data/KIT/3/kick_high_left02_poses.npy"
  Index start_frame = 0;    // at 20 frames per second, behind the lead
  Index end_frame = -1;     // -1: to the end, as published without the last frame
  std::string new_name;     // "000000.npy"
  bool operator==(const HumanMl3dSource&) const = default;
};

struct HumanMl3dSourceOptions {
  /// The published program slices [start:-1], which leaves the last frame out where "to the end" is meant. true: it is
  /// kept.
  bool keep_last_frame = false;
};

inline bool is_humanact12(std::string_view source_path) { return source_path.find("humanact12") != source_path.npos; }
/// HumanML3D has two bodies: everybody but "male" is posed with the female one.
inline bool humanml3d_uses_male_body(std::string_view gender) { return gender == "male"; }

/// Frames at 20 per second that are dropped before the index counts: people stand in a T-pose there.
Index humanml3d_lead(std::string_view source_path);

/// The frames of a sequence that a row of the index takes: every floor(fps / 20)-th, behind the lead, from start to
/// end. An end behind the last frame is the last frame, as Python slices are. Empty if the sequence is too short.
/// Throws config_error 101 for a rate below 20 frames per second and for frames that are negative (except end -1).
std::vector<Index> humanml3d_source_frames(const HumanMl3dSource& row, Index frames, double fps,
                                           const HumanMl3dSourceOptions& options = {});

/// The first 22 joints of the frames of a row, (frames, 22). `pose` takes frame numbers and gives their joints,
/// (frames, J) with J >= 22: of AMASS Z up, of HumanAct12 as its files have them (give 20 as their fps).
/// Throws config_error 101 as humanml3d_source_frames, shape_error 205 if `pose` gives other than whole frames.
template <Scalar S, class Pose>
std::vector<Vec3<S>> humanml3d_source_joints(const HumanMl3dSource& row, Index frames, double fps, Pose&& pose,
                                             const HumanMl3dSourceOptions& options = {}) {
  const std::vector<Index> numbers = humanml3d_source_frames(row, frames, fps, options);
  if (numbers.empty()) return {};
  const std::vector<Vec3<S>> posed = pose(std::span<const Index>(numbers));
  const std::size_t joints = posed.size() / numbers.size();
  if (joints < 22 || posed.size() % numbers.size() != 0) {
    raise<shape_error>(205, "humanml3d_source_joints: ", posed.size(), " joints for ", numbers.size(),
                       " frames; expected 22 or more for each");
  }
  const bool y_up = is_humanact12(row.source_path);
  std::vector<Vec3<S>> out;
  out.reserve(22 * numbers.size());
  for (std::size_t at = 0; at < posed.size(); at += joints) {
    for (std::size_t j = at; j < at + 22; ++j) {
      const Vec3<S>& p = posed[j];
      out.push_back(y_up ? p : Vec3<S>{-p.x, p.z, p.y});
    }
  }
  return out;
}

/// Joints of some frames of a sequence with a body model, (frames, J), in the sequence's own world. The model takes the
/// first rotations and shape coefficients that it has use for: SMPL-H all 52 joints, HumanML3D 10 coefficients.
/// Throws shape_error 205 if the sequence has fewer of them, 203 for a frame that it lacks.
template <Backend B>
std::vector<Vec3<typename B::scalar>> posed_joints(const BodyModel<B>& model, const AmassSequence& sequence,
                                                   std::span<const Index> frames) {
  using S = typename B::scalar;
  const Index n = std::ssize(frames), joints = model.joints(), shapes = model.shapedirs.size(1);
  if (sequence.columns < 3 * joints || std::ssize(sequence.betas) < shapes) {
    raise<shape_error>(205, "posed_joints: ", sequence.columns, " pose values and ", sequence.betas.size(),
                       " shape coefficients, the model needs ", 3 * joints, " and ", shapes);
  }
  std::vector<S> betas, rotations, translations;
  for (const Index frame : frames) {
    if (frame < 0 || frame >= sequence.frames) {
      raise<shape_error>(203, "posed_joints: frame ", frame, " of ", sequence.frames);
    }
    for (Index k = 0; k < shapes; ++k) betas.push_back(static_cast<S>(sequence.betas[static_cast<std::size_t>(k)]));
    const auto pose = std::span(sequence.poses).subspan(static_cast<std::size_t>(frame * sequence.columns));
    for (std::size_t j = 0; j < static_cast<std::size_t>(joints); ++j) {
      const auto r = to_matrix(AxisAngle<double>{{pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]}});
      for (const double value : r.m) rotations.push_back(static_cast<S>(value));
    }
    const double* t = sequence.trans.data() + 3 * frame;
    for (int k = 0; k < 3; ++k) translations.push_back(static_cast<S>(t[k]));
  }
  const auto posed =
      model.posed_joints(Tensor<B, 2>::from(betas, {n, shapes}), Tensor<B, 3>::from(rotations, {n, joints, 9}),
                         Tensor<B, 2>::from(translations, {n, 3}));
  const auto values = posed.to_vector();
  std::vector<Vec3<S>> out;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) out.push_back({values[i], values[i + 1], values[i + 2]});
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_HUMANML3D_SOURCE_IPP  // <motionlang/datasets/humanml3d_source.ipp>
#define MOTIONLANG_HAS_DATASETS_HUMANML3D_SOURCE_IPP
// Bodies of humanml3d_source.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Index humanml3d_lead(std::string_view source_path) {
  struct Lead {
    std::string_view data_set;
    Index frames;
  };
  constexpr Lead leads[] = {{"Eyes_Japan_Dataset", 60},
                            {"MPI_HDM05", 60},
                            {"TotalCapture", 20},
                            {"MPI_Limits", 20},
                            {"Transitions_mocap", 10}};
  Index frames = 0;
  for (const Lead& lead : leads) {
    if (source_path.find(lead.data_set) != source_path.npos) frames += lead.frames;
  }
  return frames;
}

MOTIONLANG_BODY std::vector<Index> humanml3d_source_frames(const HumanMl3dSource& row, Index frames, double fps,
                                                           const HumanMl3dSourceOptions& options) {
  std::vector<Index> picked = every_nth_frame(frames, fps, 20);
  if (is_humanact12(row.source_path)) return picked;
  if (row.start_frame < 0 || row.end_frame < -1) {
    raise<config_error>(101, "humanml3d_source_frames: '", row.new_name, "' from frame ", row.start_frame, " to ",
                        row.end_frame);
  }
  const Index available = std::max<Index>(0, std::ssize(picked) - humanml3d_lead(row.source_path));
  const Index last = row.end_frame == -1 ? available - (options.keep_last_frame ? 0 : 1) : row.end_frame;
  picked.erase(picked.begin(), picked.end() - available);
  picked.resize(static_cast<std::size_t>(std::clamp<Index>(last, 0, available)));
  picked.erase(picked.begin(), picked.begin() + std::min<Index>(row.start_frame, std::ssize(picked)));
  return picked;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct MotionCaption {
  std::string text;
  std::vector<TaggedWord> words;  // may be empty; T2M and its evaluation need them
  double start = 0, end = 0;      // seconds
  bool of_whole_clip() const { return start == 0 && end == 0; }
  bool operator==(const MotionCaption&) const = default;
};

/// Fields are split off from the right, so a caption may contain '#'. Lines with fewer than four fields are skipped, as
/// published. Throws io_error 403, with the line, for a time that is not valid.
std::vector<MotionCaption> parse_captions(std::string_view text, std::string_view name = "captions");
/// Throws io_error 401, 403.
std::vector<MotionCaption> read_captions(const FilePath& path);

/// `name` stands in messages.
/// Laws    parse_captions(format_captions(x)) equals x
/// Throws  timeline_error 510 for a caption or word that other readers would take apart: with '#', a line end, blanks
///         at its ends or in a word, '/' in a tag; io_error 403 for a time that is not valid
std::string format_captions(std::span<const MotionCaption> captions, std::string_view name = "captions");

/// The caption of the mirrored clip: other sides in the text and in its words.
MotionCaption mirrored(MotionCaption caption);

/// index.csv: a head line, then source_path,start_frame,end_frame,new_name.
/// Throws io_error 403, with the line, for another number of fields and for a frame that is no integer of -1 or more.
std::vector<HumanMl3dSource> parse_humanml3d_index(std::string_view text, std::string_view name = "index.csv");
/// Throws io_error 401, 403.
std::vector<HumanMl3dSource> read_humanml3d_index(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_HUMANML3D_TEXTS_IPP  // <motionlang/datasets/humanml3d_texts.ipp>
#define MOTIONLANG_HAS_DATASETS_HUMANML3D_TEXTS_IPP
// Bodies of humanml3d_texts.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A time in seconds, 0 for "nan". Throws io_error 403 with the place.
inline double caption_time(std::string_view field, std::string_view name, Index line) {
  field = trim(field);
  double seconds = 0;
  const auto [end, status] = detail::from_chars(field.data(), field.data() + field.size(), seconds);
  if (status == std::errc{} && end == field.data() + field.size()) {
    if (std::isnan(seconds)) return 0;
    if (seconds >= 0 && std::isfinite(seconds)) return seconds;
  }
  raise<io_error>(403, name, ":", line, ": '", utf8_head(field, 40), "' is no time");
}

inline std::vector<TaggedWord> tagged_words(std::string_view field) {
  std::vector<TaggedWord> words;
  for (field = trim(field); !field.empty();) {
    const std::string_view token = field.substr(0, std::min(field.find(' '), field.size()));
    const std::size_t slash = token.rfind('/');
    words.push_back(
        {std::string(token.substr(0, slash)), std::string(slash == token.npos ? "" : token.substr(slash + 1))});
    field = trim(field.substr(token.size()));
  }
  return words;
}

/// As Python prints it: "0.0", "2.5".
inline std::string time_text(double seconds) {
  const std::string text = concat_text(seconds);
  return text.find_first_of(".e") == text.npos ? text + ".0" : text;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<MotionCaption> parse_captions(std::string_view text, std::string_view name) {
  std::vector<MotionCaption> captions;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    std::string_view fields[3];  // end, start, words
    for (std::string_view& field : fields) {
      const std::size_t mark = line.rfind('#');
      if (mark == line.npos) return;
      field = line.substr(mark + 1);
      line = line.substr(0, mark);
    }
    captions.push_back({std::string(detail::trim(line)), detail::tagged_words(fields[2]),
                        detail::caption_time(fields[1], name, number), detail::caption_time(fields[0], name, number)});
  });
  return captions;
}

MOTIONLANG_BODY std::vector<MotionCaption> read_captions(const FilePath& path) {
  return parse_captions(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

MOTIONLANG_BODY std::string format_captions(std::span<const MotionCaption> captions, std::string_view name) {
  std::string out;
  auto require = [&](bool holds, const std::string& text) {
    if (!holds) raise<timeline_error>(510, name, ": '", text, "' cannot stand in a file of captions");
  };
  for (const MotionCaption& c : captions) {
    require(c.text.find_first_of("#\r\n") == c.text.npos && detail::trim(c.text) == c.text, c.text);
    out += c.text + '#';
    for (std::size_t i = 0; i < c.words.size(); ++i) {
      const auto& [word, tag] = c.words[i];
      const bool plain = (word + tag).find_first_of("# \t\r\n\v\f") == word.npos;
      require(
          plain && !(word + tag).empty() && tag.find('/') == tag.npos && (!tag.empty() || word.find('/') == word.npos),
          word + "/" + tag);
      out += (i > 0 ? " " : "") + word + (tag.empty() ? "" : "/" + tag);
    }
    for (const double seconds : {c.start, c.end}) {
      if (!(seconds >= 0 && std::isfinite(seconds)))
        raise<io_error>(403, name, ": '", c.text, "': ", seconds, " is no time");
      out += '#' + detail::time_text(seconds);
    }
    out += '\n';
  }
  return out;
}

MOTIONLANG_BODY MotionCaption mirrored(MotionCaption caption) {
  caption.text = mirror_caption(caption.text);
  std::vector<TaggedWord> words;
  for (TaggedWord& w : std::exchange(caption.words, {})) {
    const bool in_parts =
        !words.empty() && w.word == "clockwise" && (words.back().word == "counter" || words.back().word == "anti");
    if (in_parts) {
      words.back() = std::move(w);  // "counter clockwise" becomes "clockwise"
    } else {
      words.push_back({mirror_caption(w.word), std::move(w.tag)});
    }
  }
  caption.words = std::move(words);
  return caption;
}

MOTIONLANG_BODY std::vector<HumanMl3dSource> parse_humanml3d_index(std::string_view text, std::string_view name) {
  constexpr std::string_view head = "source_path,start_frame,end_frame,new_name";
  std::vector<HumanMl3dSource> rows;
  bool has_head = false;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    line = detail::trim(line);
    if (line.empty()) return;
    if (!std::exchange(has_head, true)) {
      if (line != head) raise<io_error>(403, name, ":", number, ": expected '", head, "'");
      return;
    }
    std::vector<std::string_view> fields;
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      fields.push_back(detail::trim(line.substr(at, end - at)));
      at = end + 1;
    }
    if (fields.size() != 4)
      raise<io_error>(403, name, ":", number, ": ", counted(fields.size(), "field"), ", 4 are expected");
    auto frame = [&](std::string_view field) {
      Index value = 0;
      const auto [end, status] = detail::from_chars(field.data(), field.data() + field.size(), value);
      if (status != std::errc{} || end != field.data() + field.size() || value < -1)
        raise<io_error>(403, name, ":", number, ": '", utf8_head(field, 40), "' is no frame");
      return value;
    };
    rows.push_back({std::string(fields[0]), frame(fields[1]), frame(fields[2]), std::string(fields[3])});
  });
  if (!has_head) raise<io_error>(403, name, ":1: expected '", head, "'");
  return rows;
}

MOTIONLANG_BODY std::vector<HumanMl3dSource> read_humanml3d_index(const FilePath& path) {
  return parse_humanml3d_index(detail::as_text(MappedFile::open(path)->bytes()), path.string());
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// What tells the data sets apart. Captions are cut at 20 frames per second in both, as published.
struct HumanMl3dForm {
  Index joints = 22;
  double fps = 20;
  Index shortest = 40, longest = 199;  // frames of a clip that the published loaders keep

  Index width() const { return Guoh3dSlots{joints}.size(); }
};
inline constexpr HumanMl3dForm humanml3d_form{}, kit_ml_form{21, 12.5, 24, 199};

struct HumanMl3dClip {
  std::string id;
  Index frames = 0;
  std::vector<float> features;  // (frames, 12 J - 1)
  std::vector<float> joints;    // (frames, J, 3)
  std::vector<MotionCaption> captions;
  bool operator==(const HumanMl3dClip&) const = default;

  /// The published set has clips with NaN (007975 and its mirror).
  bool is_finite() const;
};

/// A folder that is being read. Nothing is kept in memory: every call reads its files.
class HumanMl3dFolder {
 public:
  explicit HumanMl3dFolder(FilePath folder, const HumanMl3dForm& form = {}) : folder_(std::move(folder)), form_(form) {}

  const HumanMl3dForm& form() const { return form_; }
  /// The ids of <split>.txt. Throws io_error 401, 403.
  std::vector<std::string> ids(std::string_view split = "all") const;
  /// Features, joints and captions. Throws io_error 401 to 405 as read_npy, 403 as read_captions, 407 for arrays of
  /// another shape and for features and joints of different lengths.
  HumanMl3dClip load(const std::string& id) const;
  /// (frames, 12 J - 1). Throws io_error 401 to 405, 407.
  std::vector<float> features(const std::string& id) const;
  /// (frames, J, 3). Throws io_error 401 to 405, 407.
  std::vector<float> joints(const std::string& id) const;
  /// Throws io_error 401, 403.
  std::vector<MotionCaption> captions(const std::string& id) const;

  /// (12 J - 1). Throws io_error 401 to 405, 407.
  std::vector<float> mean() const;
  std::vector<float> deviation() const;

 private:
  /// Throws io_error 403 for an id that leads out of the folder.
  FilePath file(std::string_view kind, const std::string& id, std::string_view extension) const;

  FilePath folder_;
  HumanMl3dForm form_;
};

/// What the published loaders make of a clip: one item of the whole clip with the captions of all of it, and one for
/// each caption with times of its own.
struct HumanMl3dItem {
  FrameSlice frames;
  std::vector<std::size_t> captions;  // numbers among those of the clip
  bool operator==(const HumanMl3dItem&) const = default;
};
/// Items of a length that the loaders keep; none if the clip itself is too short or too long. Seconds count at 20
/// frames per second, for KIT-ML too, as published.
std::vector<HumanMl3dItem> humanml3d_items(std::span<const MotionCaption> captions, Index frames,
                                           const HumanMl3dForm& form = {});

/// Writes the files of a clip, captions last, and makes the folders that are missing. Write the lists of ids
/// (write_ids) when all clips are there: a list then names no clip that is not whole.
/// Throws io_error 401, 403 for an id that leads out of the folder, shape_error 205 if the values do not fit the form,
/// timeline_error 510 as format_captions
void write_humanml3d_clip(const FilePath& folder, const HumanMl3dClip& clip, const HumanMl3dForm& form = {});
/// Mean.npy and Std.npy, of FeatureStatistics for instance. Throws io_error 401, shape_error 205 for another width.
void write_humanml3d_statistics(const FilePath& folder, std::span<const float> mean, std::span<const float> deviation,
                                const HumanMl3dForm& form = {});

namespace detail {

/// The values of an array of this shape, or of any number of rows of it. Throws io_error 407 for another shape.
std::vector<float> read_rows(const FilePath& path, std::vector<Index> shape, bool any_number = false);

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_HUMANML3D_FOLDER_IPP  // <motionlang/datasets/humanml3d_folder.ipp>
#define MOTIONLANG_HAS_DATASETS_HUMANML3D_FOLDER_IPP
// Bodies of humanml3d_folder.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool HumanMl3dClip::is_finite() const {
  auto finite = [](float x) { return std::isfinite(x); };
  return std::all_of(features.begin(), features.end(), finite) && std::all_of(joints.begin(), joints.end(), finite);
}

namespace detail {

inline FilePath below(const FilePath& folder, std::string_view name) { return concat_text(folder.string(), "/", name); }

MOTIONLANG_BODY std::vector<float> read_rows(const FilePath& path, std::vector<Index> shape, bool any_number) {
  const NpyArray array = read_npy(path);
  if (any_number && !array.shape.empty()) shape.insert(shape.begin(), array.shape[0]);
  if (array.shape != shape) {
    raise<io_error>(407, path.string(), ": an array ", shape_text(array.shape), ", expected ", shape_text(shape));
  }
  return array.to<float>();
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> HumanMl3dFolder::ids(std::string_view split) const {
  return read_ids(detail::below(folder_, concat_text(split, ".txt")));
}

MOTIONLANG_BODY HumanMl3dClip HumanMl3dFolder::load(const std::string& id) const {
  HumanMl3dClip clip{id, 0, features(id), joints(id), captions(id)};
  clip.frames = std::ssize(clip.features) / form_.width();
  const Index frames = std::ssize(clip.joints) / (3 * form_.joints);
  if (frames != clip.frames) {
    raise<io_error>(407, folder_.string(), ": clip '", id, "' has ", counted(clip.frames, "frame"), " of features and ",
                    frames, " of joints");
  }
  return clip;
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::features(const std::string& id) const {
  return detail::read_rows(file("new_joint_vecs", id, ".npy"), {form_.width()}, /*any_number=*/true);
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::joints(const std::string& id) const {
  return detail::read_rows(file("new_joints", id, ".npy"), {form_.joints, 3}, /*any_number=*/true);
}

MOTIONLANG_BODY std::vector<MotionCaption> HumanMl3dFolder::captions(const std::string& id) const {
  return read_captions(file("texts", id, ".txt"));
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::mean() const {
  return detail::read_rows(detail::below(folder_, "Mean.npy"), {form_.width()});
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::deviation() const {
  return detail::read_rows(detail::below(folder_, "Std.npy"), {form_.width()});
}

MOTIONLANG_BODY FilePath HumanMl3dFolder::file(std::string_view kind, const std::string& id,
                                               std::string_view extension) const {
  if (!detail::is_clip_id(id)) raise<io_error>(403, folder_.string(), ": '", id, "' is no id of a clip");
  return detail::below(folder_, concat_text(kind, "/", id, extension));
}

MOTIONLANG_BODY std::vector<HumanMl3dItem> humanml3d_items(std::span<const MotionCaption> captions, Index frames,
                                                           const HumanMl3dForm& form) {
  auto kept = [&](Index length) { return length >= form.shortest && length <= form.longest; };
  std::vector<HumanMl3dItem> items;
  if (!kept(frames)) return items;
  HumanMl3dItem whole{{0, frames}, {}};
  for (std::size_t i = 0; i < captions.size(); ++i) {
    const MotionCaption& c = captions[i];
    const FrameSlice slice = c.of_whole_clip() ? FrameSlice{} : slice_of_seconds(c.start, c.end, 20, frames);
    if (c.of_whole_clip())
      whole.captions.push_back(i);
    else if (kept(slice.length))
      items.push_back({slice, {i}});
  }
  if (!whole.captions.empty()) items.push_back(std::move(whole));
  return items;
}

MOTIONLANG_BODY void write_humanml3d_clip(const FilePath& folder, const HumanMl3dClip& clip,
                                          const HumanMl3dForm& form) {
  if (!detail::is_clip_id(clip.id) || clip.id.find('/') != clip.id.npos)
    raise<io_error>(403, folder.string(), ": '", clip.id, "' is no name of a file");
  const FilePath texts = detail::below(folder, concat_text("texts/", clip.id, ".txt"));
  const std::string captions = format_captions(clip.captions, texts.string());
  const auto features = NpyArray::of(std::span<const float>(clip.features), {clip.frames, form.width()});
  const auto joints = NpyArray::of(std::span<const float>(clip.joints), {clip.frames, form.joints, 3});
  auto file = [&](std::string_view kind, std::string_view extension) {
    make_folder(folder);
    make_folder(detail::below(folder, kind));
    return detail::below(folder, concat_text(kind, "/", clip.id, extension));
  };
  write_npy(file("new_joint_vecs", ".npy"), features);
  write_npy(file("new_joints", ".npy"), joints);
  write_file(file("texts", ".txt"), captions);
}

MOTIONLANG_BODY void write_humanml3d_statistics(const FilePath& folder, std::span<const float> mean,
                                                std::span<const float> deviation, const HumanMl3dForm& form) {
  const auto m = NpyArray::of(mean, {form.width()}), s = NpyArray::of(deviation, {form.width()});
  make_folder(folder);
  write_npy(detail::below(folder, "Mean.npy"), m);
  write_npy(detail::below(folder, "Std.npy"), s);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_KIT_RECORDINGS_HPP  // <motionlang/datasets/kit_recordings.hpp>
#define MOTIONLANG_HAS_DATASETS_KIT_RECORDINGS_HPP
/// Raw KIT Motion-Language, as TEMOS reads it: texts, and joint positions at 100 frames per second.
///
///     <id>_annotations.json   ["A person waves.", ...]
///     <id>_meta.json          {"nb_annotations": 1, ...}
///     <id>_fke.csv            a head line; then an index and x, y, z of MMM's 21 joints on each line, millimetres
///
/// Source  Plappert et al. (2016); the csv files from the preprocessing of Ghosh et al.; spec exchange-formats.md 5.3,
///         temos.md 9

MOTIONLANG_NAMESPACE_BEGIN

struct KitRecording {
  static constexpr double fps = 100;
  static constexpr std::size_t joint_count = 21;
  std::string id;
  std::vector<std::string> annotations;
  std::vector<Vec3<double>> joints;  // (frames, 21), joint fastest; in the units and axes of the file

  Index frames() const { return static_cast<Index>(joints.size() / joint_count); }
};

/// The positions in a text of _fke.csv. Throws io_error 403, with the line, unless every line has 64 numbers. The
/// first is an index, which is only checked.
std::vector<Vec3<double>> parse_kit_joints(std::string_view text, std::string_view name = "fke.csv");

/// A folder that is being read. Nothing is kept in memory: every call reads its files.
class KitRecordings {
 public:
  explicit KitRecordings(FilePath folder) : folder_(std::move(folder)) {}

  /// All ids with a _meta.json, sorted. Throws io_error 401.
  std::vector<std::string> ids() const;
  /// The texts of a recording; none if its meta data say so: TEMOS skips such recordings.
  /// Throws io_error 401, 403 (malformed; a number of texts other than announced), config_error 107.
  std::vector<std::string> annotations(const std::string& id) const;
  /// Throws as annotations and parse_kit_joints.
  KitRecording load(const std::string& id) const;

 private:
  FilePath file(const std::string& id, std::string_view ending) const;
  FilePath folder_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_KIT_RECORDINGS_IPP  // <motionlang/datasets/kit_recordings.ipp>
#define MOTIONLANG_HAS_DATASETS_KIT_RECORDINGS_IPP
// Bodies of kit_recordings.hpp.

#include <dirent.h>   // opendir

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Vec3<double>> parse_kit_joints(std::string_view text, std::string_view name) {
  constexpr std::size_t columns = 1 + 3 * KitRecording::joint_count;
  std::vector<Vec3<double>> joints;
  Index lines = 0;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    line = detail::trim(line);
    if (line.empty() || ++lines == 1) return;
    double values[columns];
    std::size_t n = 0;
    for (std::size_t at = 0; at <= line.size(); ++n) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      const std::string_view field = detail::trim(line.substr(at, end - at));
      double value = 0;
      const auto [last, status] = detail::from_chars(field.data(), field.data() + field.size(), value);
      if (status != std::errc{} || last != field.data() + field.size() || !std::isfinite(value))
        raise<io_error>(403, name, ":", number, ": '", utf8_head(field, 40), "' is no number");
      if (n < columns) values[n] = value;
      at = end + 1;
    }
    if (n != columns)
      raise<io_error>(403, name, ":", number, ": ", counted(n, "number"), ", ", columns, " are expected");
    for (std::size_t i = 1; i < columns; i += 3) joints.push_back({values[i], values[i + 1], values[i + 2]});
  });
  if (lines == 0) raise<io_error>(402, name, ": the file is empty");
  return joints;
}

MOTIONLANG_BODY std::vector<std::string> KitRecordings::ids() const {
  constexpr std::string_view ending = "_meta.json";
  DIR* const folder = ::opendir(folder_.c_str());
  if (folder == nullptr) raise<io_error>(401, "cannot read the folder ", folder_.string());
  std::vector<std::string> out;
  while (const dirent* entry = ::readdir(folder)) {
    const std::string_view name = entry->d_name;
    if (name.size() > ending.size() && name.ends_with(ending))
      out.emplace_back(name.substr(0, name.size() - ending.size()));
  }
  ::closedir(folder);
  std::sort(out.begin(), out.end());
  return out;
}

MOTIONLANG_BODY std::vector<std::string> KitRecordings::annotations(const std::string& id) const {
  const FilePath meta_path = file(id, "_meta.json"), texts_path = file(id, "_annotations.json");
  const nlohmann::json meta = read_json(meta_path);
  const auto count = JsonView(meta, meta_path.string())["nb_annotations"].as<Index>();
  if (count == 0) return {};
  const nlohmann::json texts = read_json(texts_path);
  auto out = JsonView(texts, texts_path.string()).as<std::vector<std::string>>();
  if (std::ssize(out) != count) {
    raise<io_error>(403, texts_path.string(), ": ", counted(out.size(), "text"), ", ", meta_path.string(), " has ",
                    count);
  }
  return out;
}

MOTIONLANG_BODY KitRecording KitRecordings::load(const std::string& id) const {
  const FilePath path = file(id, "_fke.csv");
  return {id, annotations(id), parse_kit_joints(detail::as_text(MappedFile::open(path)->bytes()), path.string())};
}

MOTIONLANG_BODY FilePath KitRecordings::file(const std::string& id, std::string_view ending) const {
  if (!detail::is_clip_id(id)) raise<io_error>(403, folder_.string(), ": '", id, "' is no id of a clip");
  return concat_text(folder_.string(), "/", id, ending);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_MOTION_TOKENS_HPP  // <motionlang/datasets/motion_tokens.hpp>
#define MOTIONLANG_HAS_DATASETS_MOTION_TOKENS_HPP
/// Motion tokens in files, and the pairs of tokens and words that TM2T is trained on.
///
///     <tokenizer>/<id>.txt     a line for each pass over the clip (five), ids of codes with blanks between them, no
///                              marks
///
/// Source  TM2T (Guo et al., ECCV 2022), tokenize_script.py, data/dataset.py; spec tm2t.md 2, 3. TM2T's script appends
///         to a file that is there already; here it is replaced.

MOTIONLANG_NAMESPACE_BEGIN

class GloVe;
class NumpyRandom;
struct MotionVocabulary;

/// The tokens of a clip: one list for each pass, from other frames on.
using TokenLines = std::vector<std::vector<Index>>;

/// Throws io_error 403, with the line, for what is no id below `codes`.
TokenLines parse_token_lines(std::string_view text, Index codes = 1024, std::string_view name = "tokens");
/// Throws io_error 401, 403.
TokenLines read_token_lines(const FilePath& path, Index codes = 1024);
/// Laws  parse_token_lines(format_token_lines(x)) equals x without its empty lists
std::string format_token_lines(const TokenLines& lines);

/// A clip or a part of one with what is said about it.
struct TokenEntry {
  std::string name;  // the id; of a part with its times in seconds: "000123_1.000000_3.400000"
  TokenLines lines;
  std::vector<MotionCaption> captions;
};

struct TokenEntryOptions {
  double tokens_per_second = 5;
  /// As published a part is cut out of what the part before has left, and the clip is trained with what the last one
  /// has left.
  bool cut_again = false;
};

/// The entries of a clip, the whole one last, if it has a caption. Parts without tokens are left out (as published only
/// those of no length).
std::vector<TokenEntry> token_entries(const std::string& id, std::span<const MotionCaption> captions, TokenLines lines,
                                      const TokenEntryOptions& options = {});

/// One item in three loses a token, the first or the last: the model cannot count on where motions begin.
enum class TokenDrop { none, first, last };
TokenDrop token_drop(NumpyRandom& random);

/// The mark of the beginning, tokens, the mark of the end. Throws shape_error 207 if a token is to be dropped and none
/// is there.
std::vector<Index> marked_tokens(std::span<const Index> tokens, const MotionVocabulary& vocabulary,
                                 TokenDrop drop = TokenDrop::none);
/// The numbers of "sos", of at most `longest` words, and of "eos".
std::vector<Index> marked_words(const GloVe& glove, std::span<const TaggedWord> words, Index longest = 20);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_MOTION_TOKENS_IPP  // <motionlang/datasets/motion_tokens.ipp>
#define MOTIONLANG_HAS_DATASETS_MOTION_TOKENS_IPP
// Bodies of motion_tokens.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TokenLines parse_token_lines(std::string_view text, Index codes, std::string_view name) {
  TokenLines out;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    line = detail::trim(line);
    if (line.empty()) return;
    out.emplace_back();
    while (!line.empty()) {
      const std::string_view field = line.substr(0, line.find_first_of(" \t"));
      Index id = -1;
      const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), id);
      if (status != std::errc{} || end != field.data() + field.size() || id < 0 || id >= codes)
        raise<io_error>(403, name, ":", number, ": '", utf8_head(field, 40), "' is no token of ",
                        counted(codes, "code"));
      out.back().push_back(id);
      line = detail::trim(line.substr(field.size()));
    }
  });
  return out;
}

MOTIONLANG_BODY TokenLines read_token_lines(const FilePath& path, Index codes) {
  return parse_token_lines(detail::as_text(MappedFile::open(path)->bytes()), codes, path.string());
}

MOTIONLANG_BODY std::string format_token_lines(const TokenLines& lines) {
  std::string out;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) out += (i > 0 ? " " : "") + std::to_string(line[i]);
    if (!line.empty()) out += '\n';
  }
  return out;
}

MOTIONLANG_BODY std::vector<TokenEntry> token_entries(const std::string& id, std::span<const MotionCaption> captions,
                                                      TokenLines lines, const TokenEntryOptions& options) {
  std::vector<TokenEntry> out;
  TokenEntry whole{id, {}, {}};
  for (const MotionCaption& c : captions) {
    if (c.of_whole_clip()) {
      whole.captions.push_back(c);
      continue;
    }
    TokenEntry part{id, {}, {c}};
    const auto token = [&](double seconds) { return std::floor(seconds * options.tokens_per_second); };
    bool any = options.cut_again && !lines.empty() && token(c.start) < token(c.end);
    for (const auto& line : lines) {
      auto at = [&](double seconds) {
        return line.begin() + static_cast<Index>(std::min(std::max(0.0, seconds * options.tokens_per_second),
                                                          static_cast<double>(line.size())));
      };
      const auto first = at(c.start), last = std::max(first, at(c.end));
      part.lines.emplace_back(first, last);
      any = any || first != last;
    }
    if (options.cut_again) lines = part.lines;
    if (!any) continue;
    for (const double time : {c.start, c.end}) {
      std::array<char, 400> digits{};  // the largest double has 309 before the point
      char *const first = digits.data(), *const last = first + digits.size();
      part.name.append("_").append(first, detail::to_chars(first, last, time, std::chars_format::fixed, 6).ptr);
    }
    out.push_back(std::move(part));
  }
  if (whole.captions.empty()) return out;
  whole.lines = std::move(lines);
  out.push_back(std::move(whole));
  return out;
}

MOTIONLANG_BODY TokenDrop token_drop(NumpyRandom& random) {
  if (random.randint(0, 3) != 2) return TokenDrop::none;
  return random.randint(0, 2) == 0 ? TokenDrop::last : TokenDrop::first;
}

MOTIONLANG_BODY std::vector<Index> marked_tokens(std::span<const Index> tokens, const MotionVocabulary& vocabulary,
                                                 TokenDrop drop) {
  if (drop != TokenDrop::none && tokens.empty()) raise<shape_error>(207, "marked_tokens: no token to drop");
  if (drop == TokenDrop::first) tokens = tokens.subspan(1);
  if (drop == TokenDrop::last) tokens = tokens.first(tokens.size() - 1);
  std::vector<Index> out{vocabulary.begin()};
  out.insert(out.end(), tokens.begin(), tokens.end());
  out.push_back(vocabulary.end());
  return out;
}

MOTIONLANG_BODY std::vector<Index> marked_words(const GloVe& glove, std::span<const TaggedWord> words, Index longest) {
  std::vector<Index> out;
  for (const TaggedWord& w : GloVe::framed(words, longest)) out.push_back(glove.id(w.word));
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_SIMULTANEOUS_SEGMENTS_HPP  // <motionlang/datasets/simultaneous_segments.hpp>
#define MOTIONLANG_HAS_DATASETS_SIMULTANEOUS_SEGMENTS_HPP
/// Stretches in which several actions happen at once, out of overlapping segments of one motion: what SINC is trained
/// on.
///
///     simultaneous_segments(std::vector<BabelSegment>{{0, 60, "walk"}, {30, 90, "wave"}})   // [30, 60) {walk, wave}
///
/// Source   SINC (Athanasiou et al., ICCV 2023), spatial_compositions; spec sinc.md 5.2
/// Differs  from the code, whose order of labels is that of a hash table: here they are sorted

MOTIONLANG_NAMESPACE_BEGIN

struct SimultaneousSegment {
  Index start = 0, end = 0;
  std::vector<std::string> texts;  // sorted; a text that two segments have is there two times
  bool operator==(const SimultaneousSegment&) const = default;
};

/// Between any two neighbouring starts or ends: the texts that are active, if they are two to `most`. An action and a
/// transition are no two actions. Throws config_error 101 for a segment that is empty.
std::vector<SimultaneousSegment> simultaneous_segments(std::span<const BabelSegment> segments, Index most = 4);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_SIMULTANEOUS_SEGMENTS_IPP  // <motionlang/datasets/simultaneous_segments.ipp>
#define MOTIONLANG_HAS_DATASETS_SIMULTANEOUS_SEGMENTS_IPP
// Bodies of simultaneous_segments.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<SimultaneousSegment> simultaneous_segments(std::span<const BabelSegment> segments,
                                                                       Index most) {
  std::vector<Index> cuts;
  for (const BabelSegment& s : segments) {
    if (s.end <= s.start) {
      raise<config_error>(101, "simultaneous_segments: '", s.text, "' goes from ", s.start, " to ", s.end);
    }
    cuts.insert(cuts.end(), {s.start, s.end});
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<SimultaneousSegment> out;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    SimultaneousSegment piece{cuts[i], cuts[i + 1], {}};
    bool transition = false;
    for (const BabelSegment& s : segments) {
      if (s.start > piece.start || s.end < piece.end) continue;
      piece.texts.push_back(s.text);
      transition |= s.is_transition();
    }
    const Index count = std::ssize(piece.texts);
    if (count < 2 || count > most || (count == 2 && transition)) continue;
    std::sort(piece.texts.begin(), piece.texts.end());
    out.push_back(std::move(piece));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_SINC_ITEMS_HPP  // <motionlang/datasets/sinc_items.hpp>
#define MOTIONLANG_HAS_DATASETS_SINC_ITEMS_HPP
/// What SINC trains on in one step: an item as it is, or one combined with an action of other body parts.
///
///     const SincItems items(list_of_items, table);
///     const SincElement e = items.draw(k, {}, rng);
///     if (e.partner) train(compose_motions(features of k, e.parts[0], features of *e.partner, e.parts[1]));
///
/// Source   SINC (Athanasiou et al., ICCV 2023), load_keyid; spec sinc.md 5.3, 5.4

MOTIONLANG_NAMESPACE_BEGIN

/// Where an item comes from, the first word of its key: "seg", "seq", "spatial_pairs", "separate_pairs".
enum class SincSource { segment, sequence, simultaneous, pair };

struct SincItem {
  SincSource source = SincSource::segment;
  std::vector<std::string> labels;
  Index frames = 0;
};

struct SincDrawOptions {
  double proportion = 0.5;  // of single actions that get a partner
  bool synthetic = true;
  bool random = false;  // any partner, any parts: the ablation
  SincWindow window{};
};

struct SincElement {
  std::optional<Index> partner;     // number of the item that is combined with this one
  std::vector<std::string> labels;  // of the item; with a partner: the first one of each
  std::vector<SincParts> parts;     // of each label
  FrameSlice window;                // of the item; a combined one is not cut
};

/// Philox and other generators of single numbers: uniform in [0, 1), and below n.
template <class G>
concept UniformDraws = requires(G& g, std::uint32_t n) {
  { g.uniform() } -> std::convertible_to<double>;
  { g.below(n) } -> std::integral;
};

/// All items, and which can be combined. Holds a table of parts by reference.
class SincItems {
 public:
  SincItems(std::vector<SincItem> items, const BodyPartTable& table);

  /// Single actions whose first label moves no part that the first label of item k moves: by label in the order of the
  /// table, then in their own. Throws config_error 103 for a label without parts.
  std::vector<Index> partners(Index k) const;

  /// Draws: whether a partner is wanted (for every item), the partner, in random mode twelve bits, the window.
  /// Throws config_error 101 for a number that is no item, 103 for a label without parts.
  template <UniformDraws G>
  SincElement draw(Index k, const SincDrawOptions& options, G& rng) const {
    const SincItem& item = at(k);
    SincElement out{std::nullopt, item.labels, {}, {}};
    const double u = rng.uniform();
    if (options.synthetic && u < options.proportion && is_single(item)) {
      const std::vector<Index> candidates = options.random ? not_simultaneous_ : partners(k);
      if (!candidates.empty()) out.partner = candidates[static_cast<std::size_t>(below(rng, std::ssize(candidates)))];
    }
    if (out.partner) out.labels = {item.labels.front(), at(*out.partner).labels.front()};
    for (const std::string& label : out.labels) {
      SincParts& parts = out.parts.emplace_back();
      if (!out.partner || !options.random) {
        parts = table_->parts(label);
      } else {
        for (std::size_t p = 0; p < sinc_part_count; ++p) parts[p] = below(rng, 2) == 1;
      }
    }
    out.window = options.window.of(item.frames, [&](Index n) { return below(rng, n); });
    return out;
  }

 private:
  static bool is_single(const SincItem& item) {
    return item.source == SincSource::segment || item.source == SincSource::sequence;
  }
  template <class G>
  static Index below(G& rng, Index n) {
    return static_cast<Index>(rng.below(static_cast<std::uint32_t>(n)));
  }
  const SincItem& at(Index k) const;

  std::vector<SincItem> items_;
  const BodyPartTable* table_;
  std::unordered_map<std::string, std::vector<Index>> singles_;  // by their first label
  std::vector<Index> not_simultaneous_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_SINC_ITEMS_IPP  // <motionlang/datasets/sinc_items.ipp>
#define MOTIONLANG_HAS_DATASETS_SINC_ITEMS_IPP
// Bodies of sinc_items.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SincItems::SincItems(std::vector<SincItem> items, const BodyPartTable& table)
    : items_(std::move(items)), table_(&table) {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const SincItem& item = items_[i];
    if (item.labels.empty()) raise<config_error>(101, "SincItems: item ", i, " has no label");
    if (is_single(item)) singles_[item.labels.front()].push_back(static_cast<Index>(i));
    if (item.source != SincSource::simultaneous) not_simultaneous_.push_back(static_cast<Index>(i));
  }
}

MOTIONLANG_BODY std::vector<Index> SincItems::partners(Index k) const {
  const SincParts& own = table_->parts(at(k).labels.front());
  std::vector<Index> out;
  for (const std::string& label : table_->labels()) {
    const auto found = singles_.find(label);
    if (found == singles_.end() || !are_compatible(own, table_->parts(label))) continue;
    out.insert(out.end(), found->second.begin(), found->second.end());
  }
  return out;
}

MOTIONLANG_BODY const SincItem& SincItems::at(Index k) const {
  if (k < 0 || k >= std::ssize(items_)) raise<config_error>(101, "SincItems: no item ", k, " of ", items_.size());
  return items_[static_cast<std::size_t>(k)];
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_DATASETS_TEACH_PAIRS_HPP  // <motionlang/datasets/teach_pairs.hpp>
#define MOTIONLANG_HAS_DATASETS_TEACH_PAIRS_HPP
/// Pairs of actions that follow one another, out of overlapping segments of one motion: what TEACH is trained on.
///
///     for (const ActionPair& pair : teach_pairs(babel_intervals(labels, 30, frames))) {
///       const PairFrames cut = pair.frames();
///       if (is_teach_length(cut)) train(pair.first.text, pair.second.text, cut);
///     }
///
/// Source    TEACH (Athanasiou et al., 3DV 2022), separate_actions; spec teach.md 4.3
/// Notation  segment S -> (start, end); X before S: X begins and ends earlier and touches S; X after S likewise
/// Differs   from the paper: two overlapping actions are not parted in the middle of their overlap but half of it after
///           the end of the first one, as the code does

MOTIONLANG_NAMESPACE_BEGIN

/// Frames of a pair: the parts lie end to end. Published: the last frame of each, and of the second action the frame
/// behind its last.
struct PairFrames {
  FrameRange first;
  std::optional<FrameRange> transition;
  FrameRange second;

  FrameRange all() const { return {first.start, second.end}; }
  Index transition_size() const { return transition ? transition->size() : 0; }
  bool operator==(const PairFrames&) const = default;
};

struct ActionPair {
  BabelSegment first;
  std::optional<BabelSegment> transition;
  BabelSegment second;
  bool operator==(const ActionPair&) const = default;

  /// A transition counts only where the actions do not touch each other.
  PairFrames frames() const;
};

/// Every action with the ones that it touches, and every transition with the actions on both sides, in the order of the
/// segments; each pair once. `segments` may stand in any order.
std::vector<ActionPair> teach_pairs(std::span<const BabelSegment> segments);

/// Frames that TEACH trains on; its evaluation takes up to 100,000.
struct TeachLengths {
  Index shortest = 15, longest = 750;
};
/// Whether the first action, and the second one with its transition, are neither too short nor too long.
bool is_teach_length(const PairFrames& frames, const TeachLengths& limits = {});

/// Pairs as one segment with both texts ("walk, sit down"): what the baseline "Joint" is trained on. Of several with
/// the same times the first.
std::vector<BabelSegment> joined_pairs(std::span<const ActionPair> pairs);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_DATASETS_TEACH_PAIRS_IPP  // <motionlang/datasets/teach_pairs.ipp>
#define MOTIONLANG_HAS_DATASETS_TEACH_PAIRS_IPP
// Bodies of teach_pairs.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY PairFrames ActionPair::frames() const {
  if (transition && first.end < second.start) {
    const Index cut = transition->start + 1;
    return {{first.start, cut}, FrameRange{cut, second.start}, {second.start, second.end}};
  }
  const Index overlap = transition ? second.start - first.end : first.end - second.start;
  const Index cut = (2 * first.end + overlap) / 2 + 1;
  return {{first.start, cut}, std::nullopt, {cut, second.end}};
}

namespace detail {

inline bool is_before(const BabelSegment& x, const BabelSegment& s) {
  return x.start < s.start && x.end < s.end && x.end >= s.start;
}
inline bool is_after(const BabelSegment& x, const BabelSegment& s) {
  return s.start < x.start && x.start <= s.end && x.end > s.end;
}

/// Sorted by start and end, without poses at rest. Of several with the same times the last text counts.
inline std::vector<BabelSegment> actions_and_transitions(std::span<const BabelSegment> segments) {
  std::map<std::pair<Index, Index>, std::string_view> texts;
  for (const BabelSegment& s : segments) {
    if (s.is_transition() || !is_babel_excluded(s.text)) texts[{s.start, s.end}] = s.text;
  }
  std::vector<BabelSegment> out;
  out.reserve(texts.size());
  for (const auto& [times, text] : texts) out.push_back({times.first, times.second, std::string(text)});
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<ActionPair> teach_pairs(std::span<const BabelSegment> segments) {
  const std::vector<BabelSegment> sorted = detail::actions_and_transitions(segments);
  std::vector<ActionPair> out;
  const auto add = [&](ActionPair pair) {
    if (std::find(out.begin(), out.end(), pair) == out.end()) out.push_back(std::move(pair));
  };
  for (const BabelSegment& s : sorted) {
    std::vector<BabelSegment> before, after;
    for (const BabelSegment& x : sorted) {
      if (x.is_transition() && !s.is_transition()) continue;
      if (detail::is_before(x, s)) before.push_back(x);
      if (detail::is_after(x, s)) after.push_back(x);
    }
    if (!s.is_transition()) {
      for (const BabelSegment& b : before) add({b, std::nullopt, s});
      for (const BabelSegment& a : after) add({s, std::nullopt, a});
    } else if (s.start > 0) {
      for (const BabelSegment& b : before) {
        for (const BabelSegment& a : after) add({b, s, a});
      }
    }
  }
  return out;
}

MOTIONLANG_BODY bool is_teach_length(const PairFrames& frames, const TeachLengths& limits) {
  const auto fits = [&](Index n) { return limits.shortest <= n && n <= limits.longest; };
  return fits(frames.first.size()) && fits(frames.transition_size() + frames.second.size());
}

MOTIONLANG_BODY std::vector<BabelSegment> joined_pairs(std::span<const ActionPair> pairs) {
  std::vector<BabelSegment> out;
  for (const ActionPair& p : pairs) {
    BabelSegment whole{std::min(p.first.start, p.second.start), std::max(p.first.end, p.second.end),
                       p.first.text + ", " + p.second.text};
    if (p.transition) {
      whole.start = std::min(whole.start, p.transition->start);
      whole.end = std::max(whole.end, p.transition->end);
    }
    const bool known = std::any_of(out.begin(), out.end(),
                                   [&](const BabelSegment& s) { return s.start == whole.start && s.end == whole.end; });
    if (!known) out.push_back(std::move(whole));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_SEARCH_MOTION_INDEX_FILE_HPP  // <motionlang/search/motion_index_file.hpp>
#define MOTIONLANG_HAS_SEARCH_MOTION_INDEX_FILE_HPP
/// A MotionIndex as one file, whose vectors are used where they lie in it.
///
///     MotionIndex index = read_motion_index("moves.index");
///     index.add(...), index.remove_if(...);
///     write_motion_index("moves.index", index);                     // the old one stays whole until the new one is
///
/// Layout   safetensors (any reader of it can have the vectors), with
///              clips, moments, captions   F32 (n, width), rows of length 1
///              moment_frames              I64 (moments, 3): clip, first frame, frames
///              about                      U8: JSON, {"model": {...}, "clips": [{"path", "modified", ...}, ...]}
///              graph_clips, graph_moments U8, where there is one: search/vector_graph.hpp
///          and "format", "version" and "checksum" (of all tensors) in the metadata
/// Checked  everything, before any vector is handed out: a file that was cut off or changed is refused

MOTIONLANG_NAMESPACE_BEGIN

/// What else an index file may have: bytes by the name of their tensor ("graph_clips").
using IndexExtras = std::map<std::string, std::vector<std::byte>>;

namespace detail {

inline constexpr const char *index_format = "motionlang.index", *index_version = "1";

/// Of the bytes and the sizes of all tensors, by name.
std::string index_checksum(std::span<const TensorView> tensors);

}  // namespace detail

/// An index file that is open.
class MotionIndexFile {
 public:
  /// Throws io_error 401, 402 (ends too early), 403 (no index, or damaged), 404 (another version), 405, 406, 407;
  /// config_error 107; numeric_error 302
  static MotionIndexFile open(const FilePath& path);
  static MotionIndexFile from_bytes(std::span<const std::byte> bytes, std::string name = "index",
                                    std::shared_ptr<const void> owner = {});

  const std::string& name() const { return file_.name(); }
  const MotionIndex& index() const { return index_; }
  /// The bytes of another tensor; nothing if there is none.
  std::span<const std::byte> extra(std::string_view name) const;

 private:
  explicit MotionIndexFile(SafetensorsFile file) : file_(std::move(file)), index_(read(file_)) {}

  static MotionIndex read(const SafetensorsFile& file);

  SafetensorsFile file_;
  MotionIndex index_;
};

inline MotionIndex read_motion_index(const FilePath& path) { return MotionIndexFile::open(path).index(); }

std::vector<std::byte> motion_index_bytes(const MotionIndex& index, const IndexExtras& extras = {});
/// Throws io_error 401.
void write_motion_index(const FilePath& path, const MotionIndex& index, const IndexExtras& extras = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_SEARCH_MOTION_INDEX_FILE_IPP  // <motionlang/search/motion_index_file.ipp>
#define MOTIONLANG_HAS_SEARCH_MOTION_INDEX_FILE_IPP
// Bodies of motion_index_file.hpp.

#ifndef MOTIONLANG_HAS_FILE_DETAIL_CONTENT_HASH_HPP  // <motionlang/file/detail/content_hash.hpp>
#define MOTIONLANG_HAS_FILE_DETAIL_CONTENT_HASH_HPP
/// A checksum of many bytes at the speed of memory. Against accidents, not against forgery.

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// FNV-1a over words of 64 bits in four lanes, then over the lanes, the rest and the length. Every step can be undone,
/// so one changed word always changes the result.
inline std::uint64_t content_hash(std::span<const std::byte> bytes, std::uint64_t before = 0xCBF29CE484222325u) {
  constexpr std::uint64_t prime = 0x100000001B3u;
  std::uint64_t lanes[4] = {before, before ^ 1u, before ^ 2u, before ^ 3u}, words[4];
  const std::uint64_t size = bytes.size();
  for (; bytes.size() >= sizeof words; bytes = bytes.subspan(sizeof words)) {
    std::memcpy(words, bytes.data(), sizeof words);
    for (int i = 0; i < 4; ++i) lanes[i] = (lanes[i] ^ words[i]) * prime;
  }
  std::uint64_t h = before;
  for (const std::uint64_t lane : lanes) h = (h ^ lane) * prime;
  for (const std::byte b : bytes) h = (h ^ static_cast<std::uint64_t>(b)) * prime;
  h = (h ^ size) * prime;
  return h ^ h >> 32;
}

inline std::string hexadecimal(std::uint64_t value) {
  std::string out(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) out[i] = "0123456789abcdef"[value & 15u];
  return out;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string index_checksum(std::span<const TensorView> tensors) {
  std::vector<const TensorView*> sorted;
  for (const TensorView& t : tensors) sorted.push_back(&t);
  std::sort(sorted.begin(), sorted.end(), [](const TensorView* a, const TensorView* b) { return a->name < b->name; });
  std::uint64_t hash = 1;
  for (const TensorView* t : sorted) {
    const std::string about = concat_text(t->name, " ", t->dtype, " ", t->shape);
    hash = content_hash(t->bytes, content_hash(std::as_bytes(std::span(about)), hash));
  }
  return hexadecimal(hash);
}

inline nlohmann::ordered_json index_about(const MotionIndex& index) {
  const IndexModel& m = index.model();
  nlohmann::ordered_json clips = nlohmann::ordered_json::array();
  for (const IndexedClip& c : index.clips()) {
    nlohmann::ordered_json clip{{"path", c.path}, {"modified", c.modified}, {"bytes", c.bytes},  {"start", c.start},
                                {"end", c.end},   {"fps", c.fps},           {"frames", c.frames}};
    if (!c.content.empty()) clip["content"] = c.content;
    if (!c.lines.empty()) clip["lines"] = c.lines;
    if (!c.name.empty()) clip["name"] = c.name;
    if (!c.captions.empty()) clip["captions"] = c.captions;
    if (!c.license.empty()) clip["license"] = c.license;
    clips.push_back(std::move(clip));
  }
  return {{"model",
           {{"id", m.id},
            {"path", m.path},
            {"text_encoder", m.text_encoder},
            {"width", m.width},
            {"fps", m.fps},
            {"windows", m.windows},
            {"stride", m.stride}}},
          {"clips", std::move(clips)}};
}

inline IndexModel index_model(const JsonView& v) {
  return {v["id"].as<std::string>(), v["path"].as<std::string>(), v.value_or("text_encoder", ""),
          v["width"].as<Index>(),    v["fps"].as<double>(),       v["windows"].as<std::vector<Index>>(),
          v["stride"].as<Index>()};
}

inline IndexedClip indexed_clip(const JsonView& v) {
  IndexedClip c{.path = v["path"].as<std::string>(),
                .name = v.value_or("name", ""),
                .modified = v["modified"].as<std::int64_t>(),
                .bytes = v["bytes"].as<std::int64_t>(),
                .content = v.value_or("content", ""),
                .lines = v.value_or("lines", ""),
                .start = v["start"].as<double>(),
                .end = v["end"].as<double>(),
                .fps = v["fps"].as<double>(),
                .frames = v["frames"].as<Index>(),
                .captions = {},
                .license = v.value_or("license", "")};
  if (v.contains("captions")) c.captions = v["captions"].as<std::vector<std::string>>();
  return c;
}

/// The rows of a tensor where they lie, or copied if they are not aligned there.
inline VectorTable index_rows(const SafetensorsFile& file, const std::string& name, Index width) {
  const TensorView& t = file.tensor(name);
  if (t.dtype != DType::F32 || t.shape.rank() != 2 || t.shape[1] != width)
    raise<io_error>(407, file.name(), ": '", name, "' is ", t.dtype, " ", t.shape, ", not F32 vectors of ", width);
  const auto rows = direct<float>(t);
  if (rows && file.owner() != nullptr) return {*rows, file.owner()};
  VectorTable copied;
  copied.append(values_of<float>(t));
  return copied;
}

}  // namespace detail

MOTIONLANG_BODY MotionIndexFile MotionIndexFile::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return from_bytes(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY MotionIndexFile MotionIndexFile::from_bytes(std::span<const std::byte> bytes, std::string name,
                                                            std::shared_ptr<const void> owner) {
  return MotionIndexFile(SafetensorsFile::from_bytes(bytes, std::move(name), std::move(owner)));
}

MOTIONLANG_BODY std::span<const std::byte> MotionIndexFile::extra(std::string_view name) const {
  const TensorView* t = file_.find(name);
  return t == nullptr ? std::span<const std::byte>{} : t->bytes;
}

MOTIONLANG_BODY MotionIndex MotionIndexFile::read(const SafetensorsFile& file) {
  const auto about_file = [&](const char* key) {
    const auto found = file.metadata().find(key);
    return found == file.metadata().end() ? std::string() : found->second;
  };
  if (about_file("format") != detail::index_format) raise<io_error>(403, file.name(), ": not an index of motionlang");
  if (about_file("version") != detail::index_version)
    raise<io_error>(404, file.name(), ": version ", about_file("version"), " of an index, known is ",
                    detail::index_version);
  if (const std::string found = detail::index_checksum(file.tensors()); found != about_file("checksum"))
    raise<io_error>(403, file.name(), ": damaged: its checksum is ", found, ", it was written with ",
                    about_file("checksum"));

  const TensorView& about = file.tensor("about");
  if (about.dtype != DType::U8) raise<io_error>(407, file.name(), ": 'about' is ", about.dtype, ", not U8");
  const std::string where = file.name() + ": about";
  const auto document = parse_json(detail::as_text(about.bytes), where);
  const JsonView view(document, where);
  IndexModel model = detail::index_model(view["model"]);
  const JsonView list = view["clips"];
  std::vector<IndexedClip> clips;
  for (Index i = 0; i < list.size(); ++i) clips.push_back(detail::indexed_clip(list[i]));

  const TensorView& frames = file.tensor("moment_frames");
  if (frames.shape.rank() != 2 || frames.shape[1] != 3)
    raise<io_error>(407, file.name(), ": 'moment_frames' is ", frames.shape, ", not three numbers for each moment");
  const auto numbers = values_of<std::int64_t>(frames);
  std::vector<MotionIndex::Moment> moments;
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    const auto number = [&](std::size_t j) { return static_cast<Index>(numbers[i + j]); };
    moments.push_back({number(0), {number(1), number(2)}});
  }

  const auto rows = [&](const char* name) { return detail::index_rows(file, name, model.width); };
  VectorTable clip_rows = rows("clips"), moment_rows = rows("moments"), caption_rows = rows("captions");
  return MotionIndex(file.name(), std::move(model), std::move(clips), std::move(moments), std::move(clip_rows),
                     std::move(moment_rows), std::move(caption_rows));
}

MOTIONLANG_BODY std::vector<std::byte> motion_index_bytes(const MotionIndex& index, const IndexExtras& extras) {
  const Index width = index.model().width;
  const std::string about = detail::index_about(index).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::vector<std::int64_t> frames;
  for (const auto& m : index.moments()) frames.insert(frames.end(), {m.clip, m.frames.first, m.frames.length});
  const auto rows = [&](const char* name, std::span<const float> values) {
    return tensor_view(name, {std::ssize(values) / width, width}, values);
  };
  std::vector<TensorView> tensors{rows("clips", index.clip_rows()),
                                  rows("moments", index.moment_rows()),
                                  rows("captions", index.caption_rows()),
                                  tensor_view<std::int64_t>("moment_frames", {std::ssize(index.moments()), 3}, frames),
                                  {"about", DType::U8, {std::ssize(about)}, std::as_bytes(std::span(about))}};
  for (const auto& [name, bytes] : extras) tensors.push_back({name, DType::U8, {std::ssize(bytes)}, bytes});
  return safetensors_bytes(tensors, {{"format", detail::index_format},
                                     {"version", detail::index_version},
                                     {"checksum", detail::index_checksum(tensors)}});
}

MOTIONLANG_BODY void write_motion_index(const FilePath& path, const MotionIndex& index, const IndexExtras& extras) {
  write_file(path, motion_index_bytes(index, extras));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_SEARCH_VECTOR_GRAPH_HPP  // <motionlang/search/vector_graph.hpp>
#define MOTIONLANG_HAS_SEARCH_VECTOR_GRAPH_HPP
/// Approximate search over many vectors with hnswlib, where its header is installed (Debian: libhnswlib-dev). Most of
/// the nearest are found, in time that grows with the logarithm of the gallery. Without hnswlib, which needs
/// exceptions, every search is exact.
///
///     auto graphs = motion_graphs(index, 100'000);                       // for galleries of so many vectors or more
///     write_motion_index("moves.index", index, graphs);
///     const MotionIndexFile file = MotionIndexFile::open("moves.index");
///     const MotionSearch search = open_motion_search(file);              // with the graphs that the file has
///     graphs = motion_graphs(more, 100'000, {}, &file);                  // these again, with the vectors that were
///     added
///
/// The graph holds numbers of vectors, not the vectors: these are read where the index file has them.
///
/// Source  Malkov and Yashunin, "Efficient and robust approximate nearest neighbor search using hierarchical navigable
///         small world graphs" (TPAMI 2020)

#if __has_include(<hnswlib/hnswlib.h>) && defined(__cpp_exceptions)
#define MOTIONLANG_HAS_HNSWLIB 1
#else
#define MOTIONLANG_HAS_HNSWLIB 0
#endif

MOTIONLANG_NAMESPACE_BEGIN

#if MOTIONLANG_HAS_HNSWLIB

struct VectorGraphOptions {
  Index links = 16;    // of a vector, upwards of the lowest level
  Index effort = 200;  // candidates that are looked at where a vector is put in
};

namespace detail {
class GraphSpace;
class HnswGraph;
}  // namespace detail

class VectorGraph : public VectorSearch {
 public:
  /// rows      (count, width) of length 1, which have to outlive the object unless an owner keeps them
  /// progress  is called with the number of vectors that are in the graph
  /// One after the other, so that the same rows always give the same graph.
  static VectorGraph build(std::span<const float> rows, Index width, const VectorGraphOptions& options = {},
                           Progress progress = {}, std::shared_ptr<const void> owner = {});
  /// A graph that was built for these rows. Throws io_error 401, 402, 403, config_error 101.
  static VectorGraph from_bytes(std::span<const std::byte> bytes, std::span<const float> rows, Index width,
                                const std::string& name = "graph", std::shared_ptr<const void> owner = {});
  /// A graph that was built for the first `known` of these rows, and gets the others. It is not the graph that build()
  /// makes of all, but finds as many. Throws io_error 401, 402, 403, config_error 101.
  static VectorGraph extended(std::span<const std::byte> bytes, Index known, std::span<const float> rows, Index width,
                              Progress progress = {}, const std::string& name = "graph",
                              std::shared_ptr<const void> owner = {});
  VectorGraph(VectorGraph&&) noexcept;
  VectorGraph& operator=(VectorGraph&&) noexcept;
  ~VectorGraph() override;
  std::vector<std::byte> bytes() const;

  Index count() const override { return std::ssize(rows_) / width_; }
  Index width() const override { return width_; }
  std::vector<std::vector<Neighbour>> search(std::span<const float> queries, Index k) const override;

 private:
  VectorGraph(std::span<const float> rows, Index width, std::shared_ptr<const void> owner);
  void add_from(Index first, Progress progress);

  std::span<const float> rows_;
  Index width_;
  std::shared_ptr<const void> owner_;
  std::unique_ptr<detail::GraphSpace> space_;
  std::unique_ptr<detail::HnswGraph> graph_;
};

#endif

namespace detail {

/// Rows of an index that can have a graph, and its name in the file.
struct GraphRows {
  const char* name;
  std::span<const float> rows;
};
/// Those of `least` rows or more.
std::vector<GraphRows> graph_rows(const MotionIndex& index, Index least);

}  // namespace detail

/// Whether the file has the graphs that motion_graphs would make.
bool has_graphs(const MotionIndexFile& file, Index least);

/// Graphs for the clips and the moments of an index where there are `least` of them or more; none without hnswlib.
/// Where the rows of `before` are the first of these, its graph is taken over and gets the others. Throws io_error 401,
/// 402, 403.
IndexExtras motion_graphs(const MotionIndex& index, Index least, Progress progress = {},
                          const MotionIndexFile* before = nullptr);

/// Searches with the graphs that the file has, or without any; then with scans of `storage`. The file has to outlive
/// it. Throws io_error 401, 402, 403.
MotionSearch open_motion_search(const MotionIndexFile& file, bool exact = false,
                                ScanStorage storage = ScanStorage::float32);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_SEARCH_VECTOR_GRAPH_IPP  // <motionlang/search/vector_graph.ipp>
#define MOTIONLANG_HAS_SEARCH_VECTOR_GRAPH_IPP
// Bodies of vector_graph.hpp.

#if MOTIONLANG_HAS_HNSWLIB
#ifndef NO_MANUAL_VECTORIZATION
// Distances are ours: those of hnswlib bring functions that two translation units must not both define.
#define NO_MANUAL_VECTORIZATION
#endif
#include <hnswlib/hnswlib.h>
#endif

MOTIONLANG_NAMESPACE_BEGIN

#if MOTIONLANG_HAS_HNSWLIB

namespace detail {

/// What hnswlib takes for a vector: the number of a row, or -1 and a vector of somebody who asks.
struct GraphPoint {
  std::int64_t row = -1;
  const float* vector = nullptr;
};

/// 1 - cosine between points. hnswlib keeps a pointer to this object.
class GraphSpace : public hnswlib::SpaceInterface<float> {
 public:
  GraphSpace(const float* rows, Index width) : rows_(rows), width_(width), dot_(RowScan<float>::dot_function()) {}
  GraphSpace(const GraphSpace&) = delete;
  GraphSpace& operator=(const GraphSpace&) = delete;

  std::size_t get_data_size() override { return sizeof(std::int64_t); }
  hnswlib::DISTFUNC<float> get_dist_func() override { return &distance; }
  void* get_dist_func_param() override { return this; }

 private:
  const float* vector_of(const void* point) const {
    std::int64_t row;
    std::memcpy(&row, point, sizeof row);
    return row >= 0 ? rows_ + row * width_ : static_cast<const GraphPoint*>(point)->vector;
  }
  static float distance(const void* a, const void* b, const void* space) {
    const auto& self = *static_cast<const GraphSpace*>(space);
    float cosine = 0;
    self.dot_(self.vector_of(a), 1, self.width_, self.vector_of(b), &cosine);
    return 1 - cosine;
  }

  const float* rows_;
  Index width_;
  decltype(RowScan<float>::dot_function()) dot_;
};

class HnswGraph : public hnswlib::HierarchicalNSW<float> {
 public:
  using hnswlib::HierarchicalNSW<float>::HierarchicalNSW;
};

/// Follows every link of a saved graph, so that hnswlib can do it without looking. Throws io_error 402, 403.
inline void check_graph(std::span<const std::byte> bytes, Index vectors, const std::string& name) {
  struct Header {
    std::uint64_t offset_level0, capacity, count, element, label_offset, data_offset;
    std::int32_t top;
    std::uint32_t entry;
    std::uint64_t links, links0, m;
    double mult;
    std::uint64_t effort;
  };
  const auto wrong = [&](const char* what) { raise<io_error>(403, name, ": a graph with ", what); };
  const auto h = load<Header>(bytes, 0, name, "the header of a graph");
  constexpr std::uint64_t id = sizeof(std::uint32_t), most_links = 10000;
  const auto n = static_cast<std::uint64_t>(vectors);
  if (h.count != n || h.capacity != n) wrong("another number of vectors");
  if (h.links < 1 || h.links > most_links || h.links0 != 2 * h.links || h.m != h.links) wrong("wrong numbers of links");
  const std::uint64_t lowest = id + h.links0 * id, upper = id + h.links * id;
  if (h.effort < h.m || !(std::abs(h.mult * std::log(static_cast<double>(h.m)) - 1) < 1e-6)) wrong("a wrong effort");
  if (h.offset_level0 != 0 || h.data_offset != lowest || h.label_offset != lowest + 8 || h.element != lowest + 16)
    wrong("wrong sizes");
  const std::size_t base = sizeof(Header);
  slice(bytes, base, static_cast<std::size_t>(n * h.element), name, "a graph");
  std::vector<std::size_t> place;    // of the upper levels of each vector
  std::vector<std::uint64_t> level;  // of each vector
  std::size_t at = base + static_cast<std::size_t>(n * h.element);
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto size = load<std::uint32_t>(bytes, at, name, "a graph");
    place.push_back(at + id), level.push_back(size / upper);
    if (size % upper != 0 || level.back() > 1000) wrong("a list of links of a wrong size");
    slice(bytes, at + id, size, name, "a graph");
    at += id + size;
  }
  if (at != bytes.size()) wrong("something behind its end");
  if (n > 0 && (h.entry >= n || h.top < 0 || level[h.entry] != static_cast<std::uint64_t>(h.top)))
    wrong("a wrong beginning");
  const auto check_links = [&](std::size_t list, std::uint64_t most, std::uint64_t on_level) {
    const auto count = load<std::uint32_t>(bytes, list, name, "a graph");
    if (count > most) wrong("too many links");
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto to = load<std::uint32_t>(bytes, list + id + k * id, name, "a graph");
      if (to >= n || level[to] < on_level) wrong("a link to nowhere");
    }
  };
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto element = base + static_cast<std::size_t>(i * h.element);
    check_links(element, h.links0, 0);
    const auto row = load<std::int64_t>(bytes, element + static_cast<std::size_t>(h.data_offset), name, "a graph");
    const auto label = load<std::int64_t>(bytes, element + static_cast<std::size_t>(h.label_offset), name, "a graph");
    if (row < 0 || row >= vectors || label != row) wrong("a vector that there is not");
    for (std::uint64_t l = 0; l < level[i]; ++l)
      check_links(place[i] + static_cast<std::size_t>(l * upper), h.links, l + 1);
  }
}

/// A file that nobody else sees, for a library that reads and writes files only.
class ScratchFile {
 public:
  ScratchFile() {
    const int file = system::create_temporary(path_);
    if (file < 0) raise<io_error>(401, "cannot make ", path_, ": ", std::strerror(errno));
    ::close(file);
  }
  ~ScratchFile() { std::remove(path_.c_str()); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace detail

MOTIONLANG_BODY VectorGraph VectorGraph::build(std::span<const float> rows, Index width,
                                               const VectorGraphOptions& options, Progress progress,
                                               std::shared_ptr<const void> owner) {
  VectorGraph g(rows, width, std::move(owner));
  g.graph_ = std::make_unique<detail::HnswGraph>(
      g.space_.get(), static_cast<std::size_t>(std::max<Index>(1, g.count())), static_cast<std::size_t>(options.links),
      static_cast<std::size_t>(options.effort));
  g.add_from(0, progress);
  return g;
}

MOTIONLANG_BODY VectorGraph VectorGraph::from_bytes(std::span<const std::byte> bytes, std::span<const float> rows,
                                                    Index width, const std::string& name,
                                                    std::shared_ptr<const void> owner) {
  return extended(bytes, detail::whole_rows("VectorGraph", rows.size(), width), rows, width, {}, name,
                  std::move(owner));
}

MOTIONLANG_BODY VectorGraph VectorGraph::extended(std::span<const std::byte> bytes, Index known,
                                                  std::span<const float> rows, Index width, Progress progress,
                                                  const std::string& name, std::shared_ptr<const void> owner) {
  VectorGraph g(rows, width, std::move(owner));
  if (known > g.count()) raise<config_error>(101, name, ": a graph of ", counted(known, "vector"), " for ", g.count());
  detail::check_graph(bytes, known, name);
  const detail::ScratchFile file;
  write_file(file.path(), bytes);
  detail::guard<std::exception>(
      [&] {
        g.graph_ = std::make_unique<detail::HnswGraph>(g.space_.get(), file.path(), false,
                                                       static_cast<std::size_t>(g.count()));
      },
      [&](const std::exception& e) -> bool { raise<io_error>(403, name, ": ", e.what()); });
  g.graph_->num_deleted_ = 0;  // hnswlib leaves it open
  // else every addition draws the same levels
  g.graph_->level_generator_.seed(static_cast<std::uint32_t>(known + 1));
  g.add_from(known, progress);
  return g;
}

MOTIONLANG_BODY VectorGraph::VectorGraph(VectorGraph&&) noexcept = default;
MOTIONLANG_BODY VectorGraph& VectorGraph::operator=(VectorGraph&&) noexcept = default;
MOTIONLANG_BODY VectorGraph::~VectorGraph() = default;

MOTIONLANG_BODY std::vector<std::byte> VectorGraph::bytes() const {
  const detail::ScratchFile file;
  graph_->saveIndex(file.path());
  const auto mapped = MappedFile::open(file.path());
  return {mapped->bytes().begin(), mapped->bytes().end()};
}

MOTIONLANG_BODY std::vector<std::vector<Neighbour>> VectorGraph::search(std::span<const float> queries, Index k) const {
  if (k < 0) raise<config_error>(101, "VectorGraph: the ", k, " nearest");
  const Index n = detail::whole_rows("VectorGraph: queries", queries.size(), width_);
  const std::vector<float> units = unit_rows(queries, width_);
  std::vector<std::vector<Neighbour>> out(static_cast<std::size_t>(n));
  k = std::min(k, count());
  if (k == 0) return out;
  // hnswlib follows as many as are asked for
  const auto candidates = static_cast<std::size_t>(std::max<Index>(100, 2 * k));
  parallel_for(n, [&](Index q) {
    const float* query = units.data() + q * width_;
    const detail::GraphPoint point{-1, query};
    NearestK best(k);
    for (auto found = graph_->searchKnn(&point, candidates); !found.empty(); found.pop()) {
      const auto row = static_cast<Index>(found.top().second);
      best.offer({row, exact_cosine(query, rows_.data() + row * width_, width_)});
    }
    out[static_cast<std::size_t>(q)] = best.take();
  });
  return out;
}

MOTIONLANG_BODY VectorGraph::VectorGraph(std::span<const float> rows, Index width, std::shared_ptr<const void> owner)
    : rows_(rows), width_(width), owner_(std::move(owner)) {
  require_unit_rows("VectorGraph", rows, width);
  space_ = std::make_unique<detail::GraphSpace>(rows.data(), width);
}

MOTIONLANG_BODY void VectorGraph::add_from(Index first, Progress progress) {
  for (Index i = first; i < count(); ++i) {
    if ((i - first) % 256 == 0) progress(i, count());
    const detail::GraphPoint point{i};
    graph_->addPoint(&point, static_cast<hnswlib::labeltype>(i));
  }
  progress(count(), count());
}

#endif

MOTIONLANG_BODY std::vector<detail::GraphRows> detail::graph_rows(const MotionIndex& index, Index least) {
  std::vector<GraphRows> out;
  for (const GraphRows& g : {GraphRows{"graph_clips", index.clip_rows()}, {"graph_moments", index.moment_rows()}})
    if (std::ssize(g.rows) / index.model().width >= std::max<Index>(1, least)) out.push_back(g);
  return out;
}

MOTIONLANG_BODY bool has_graphs(const MotionIndexFile& file, Index least) {
  const auto wanted = detail::graph_rows(file.index(), least);
  return std::all_of(wanted.begin(), wanted.end(), [&](const auto& g) { return !file.extra(g.name).empty(); });
}

MOTIONLANG_BODY IndexExtras motion_graphs([[maybe_unused]] const MotionIndex& index, [[maybe_unused]] Index least,
                                          [[maybe_unused]] Progress progress,
                                          [[maybe_unused]] const MotionIndexFile* before) {
  IndexExtras out;
#if MOTIONLANG_HAS_HNSWLIB
  const Index width = index.model().width;
  for (const auto& [name, rows] : detail::graph_rows(index, least)) {
    const auto graph = before != nullptr ? before->extra(name) : std::span<const std::byte>{};
    std::span<const float> known;
    if (!graph.empty()) {
      for (const auto& old : detail::graph_rows(before->index(), 1))
        if (std::string_view(old.name) == name) known = old.rows;
    }
    const bool only_added =
        !known.empty() && known.size() <= rows.size() && std::equal(known.begin(), known.end(), rows.begin());
    out[name] = (only_added ? VectorGraph::extended(graph, std::ssize(known) / width, rows, width, progress,
                                                    before->name() + ": " + name)
                            : VectorGraph::build(rows, width, {}, progress))
                    .bytes();
  }
#endif
  return out;
}

MOTIONLANG_BODY MotionSearch open_motion_search(const MotionIndexFile& file, [[maybe_unused]] bool exact,
                                                ScanStorage storage) {
  std::shared_ptr<const VectorSearch> clips, moments;
#if MOTIONLANG_HAS_HNSWLIB
  const auto graph = [&](const char* name, std::span<const float> rows) -> std::shared_ptr<const VectorSearch> {
    const auto bytes = file.extra(name);
    if (exact || bytes.empty()) return {};
    return std::make_shared<VectorGraph>(
        VectorGraph::from_bytes(bytes, rows, file.index().model().width, file.name() + ": " + name));
  };
  clips = graph("graph_clips", file.index().clip_rows());
  moments = graph("graph_moments", file.index().moment_rows());
#endif
  return MotionSearch(file.index(), std::move(clips), std::move(moments), storage);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_ACTOR_FILE_HPP  // <motionlang/weights/actor_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_ACTOR_FILE_HPP
/// ACTOR and the classifiers that judge it from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto actor = load_actor<B>(open_weights(run.weights), run);     // run = find_run("exps/humanact12"); or
///     weights/vae_run.hpp const auto gru =
///     load_gru_classifier<B>(open_weights("models/actionrecognition/humanact12_gru.tar")); const auto stgcn =
///     load_stgcn<B>(open_weights("models/actionrecognition/uestc_rot6d_stgcn.tar"));
///
/// Options  opt.yaml of the run says what shapes do not: pose_rep, activation, num_heads, ablation, num_frames,
///          max_len, sampling, sampling_step, jointstype. Without it the published values: 6D rotations, GELU, 4 heads,
///          none, 60 consecutive frames, vertices
/// Ignored  tables of positions (*.pe), SMPL
/// Throws   io_error 404 for variants that are not known, 406, 407 if names or shapes do not match; config_error 102
///          where options and tensors differ, 101, 103, 107 for options that mean nothing; numeric_error 301 for NaN
///          or infinity
/// Source   spec actor.md 2.8, 3.1, 3.2, 6.3, 7.2, 7.3

#ifndef MOTIONLANG_HAS_WEIGHTS_DETAIL_RUN_READER_HPP  // <motionlang/weights/detail/run_reader.hpp>
#define MOTIONLANG_HAS_WEIGHTS_DETAIL_RUN_READER_HPP
/// What the readers of official run folders share: options and shapes of tensors compared, statistics of features.

#ifndef MOTIONLANG_HAS_WEIGHTS_MODULE_FILE_HPP  // <motionlang/weights/module_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_MODULE_FILE_HPP
/// Parameters of modules in files of weights: paths of fields are the names of tensors. Any TensorSet will do:
/// SafetensorsFile, WeightFile.

MOTIONLANG_NAMESPACE_BEGIN

/// The name under which a tensor of the module is filed: its path, unless the module translates (`official_key`).
template <Module M>
std::string tensor_key(const std::string& prefix, const std::string& path) {
  if constexpr (requires { M::official_key(path); })
    return prefix + M::official_key(path);
  else
    return prefix + path;
}

namespace detail {
/// Looks at the bits of the exponent, which are all set in NaN and infinity, because compilers vectorise such a loop.
template <Scalar S>
bool all_finite(std::span<const S> numbers) {
  using Bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits exponent = detail::bit_cast<Bits>(std::numeric_limits<S>::infinity());
  std::atomic<bool> finite{true};
  parallel_ranges(std::ssize(numbers), 1, [&](Index first, Index last) {
    Bits wrong = 0;
    for (const S x : numbers.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)))
      wrong |= static_cast<Bits>((detail::bit_cast<Bits>(x) & exponent) == exponent);
    if (wrong != 0) finite.store(false, std::memory_order_relaxed);
  });
  return finite;
}
}  // namespace detail

/// Gives a tensor the numbers of a view, converted to its scalar. float from F32 is a view of the file, without a copy.
/// A variable stays the variable it was. NaN is let through. Throws io_error 407 if the shape is another.
template <Backend B>
void assign_tensor(typename B::tensor& tensor, const TensorView& view, const std::shared_ptr<const void>& owner,
                   const std::string& where) {
  if constexpr (AutodiffBackend<B>) {
    assign_tensor<typename B::inner>(B::mutable_value(tensor), view, owner, where);
  } else {
    using S = typename B::scalar;
    const Shape shape = B::shape(tensor);
    if (view.shape != shape)
      raise<io_error>(407, where, ": tensor '", view.name, "' is ", view.shape, ", the model has ", shape);
    if constexpr (std::is_constructible_v<typename B::tensor, const S*, Shape, std::shared_ptr<const void>>) {
      const auto numbers = direct<S>(view);
      if (numbers && owner != nullptr) {
        tensor = typename B::tensor(numbers->data(), view.shape, owner);
        return;
      }
    }
    tensor = written_tensor<B>(
        shape, [&](S* to) { copy_values(view, std::span<S>(to, static_cast<std::size_t>(shape.count()))); });
  }
}
/// What a module is loaded for. For inference it is made ready as by prepare_loaded, in the same pass over the file:
/// all its matrices are weights, and it is neither trained nor changed afterwards.
enum class LoadFor { any_use, inference };

namespace detail {

/// Throws numeric_error 301 if a number is NaN or infinite.
template <Scalar S>
void require_finite(std::span<const S> numbers, const TensorView& view, const std::string& where) {
  if (all_finite(numbers)) return;
  const auto wrong = std::find_if(numbers.begin(), numbers.end(), [](auto x) { return !std::isfinite(x); });
  raise<numeric_error>(301, where, ": number ", wrong - numbers.begin(), " of tensor '", view.name, "' is ", *wrong);
}

/// Fills tensors from a file by their names. For inference their numbers are looked at later.
struct TensorLoader {
  const TensorSet& file;
  const std::string& prefix;
  std::string (*key)(const std::string& prefix, const std::string& path);
  LoadFor use;
  KeyReport& report;
  std::set<std::string>& known;

  template <Backend B>
  void fill(const ModuleTensor<B>& tensor) const {
    const std::string& name = *known.insert(key(prefix, tensor.path)).first;
    const TensorView* view = file.find(name);
    if (view == nullptr) {
      report.missing.push_back(name);
      return;
    }
    assign_tensor<B>(*tensor.data, *view, file.owner(), file.name());
    if (use == LoadFor::any_use) require_finite<typename B::scalar>(tensor.span(), *view, file.name());
    MappedFile::forget_if_mapped(view->bytes);  // until it is needed
  }
};

/// Whether the tensor repeats one of the module under another name. Throws io_error 407 if it should but is different.
template <class M>
bool is_copy(const M& module, const TensorSet& file, const std::string& prefix, const TensorView& t) {
  if constexpr (requires { module.copy_of(t.name); }) {
    const std::string path = module.copy_of(t.name.substr(prefix.size()));
    const TensorView* original = path.empty() ? nullptr : file.find(prefix + path);
    if (original == nullptr) return false;
    if (values_of<double>(*original) != values_of<double>(t))
      raise<io_error>(407, file.name(), ": tensor '", t.name, "' should repeat '", original->name, "' but is another");
    return true;
  }
  return false;
}

}  // namespace detail

/// Tensors on their way into a file, with their own memory.
class TensorStore {
 public:
  /// Copies the numbers, rounded to `dtype` (F32, F64, F16 or BF16). Throws config_error 101 for another, numeric_error
  /// 301 for a number that would become infinite; F16 holds no NaN and infinity either.
  template <Scalar S>
  void add(std::string name, const FileShape& shape, std::span<const S> values, DType dtype) {
    switch (dtype) {
      case DType::F32:
        require_held(name, values, dtype, std::numeric_limits<float>::infinity());
        return put<float>(std::move(name), shape, values, dtype, [](S x) { return static_cast<float>(x); });
      case DType::F64:
        return put<double>(std::move(name), shape, values, dtype, [](S x) { return static_cast<double>(x); });
      case DType::F16:
        require_held(name, values, dtype, 65520);
        return put<std::uint16_t>(std::move(name), shape, values, dtype,
                                  [](S x) { return float_to_half(static_cast<float>(x)); });
      case DType::BF16:
        require_held(name, values, dtype, 0x1.FFp127F);
        return put<std::uint16_t>(std::move(name), shape, values, dtype,
                                  [](S x) { return float_to_bfloat16(static_cast<float>(x)); });
      default:
        raise<config_error>(101, "TensorStore: '", name, "' cannot be stored as ", dtype);
    }
  }
  /// All tensors of a module.
  template <Module M>
  void add_module(const M& module, const std::string& prefix = "", DType dtype = DType::F32) {
    for (const auto& t : tensors_of(module)) add(tensor_key<M>(prefix, t.path), t.shape(), t.span(), dtype);
  }
  std::vector<TensorView> views() const {
    std::vector<TensorView> out;
    for (const Entry& e : entries_) out.push_back({e.name, e.dtype, e.shape, e.bytes});
    return out;
  }

 private:
  struct Entry {
    std::string name;
    DType dtype;
    FileShape shape;
    std::vector<std::byte> bytes;
  };
  /// end   what rounds to infinity, and all above it
  template <Scalar S>
  static void require_held(const std::string& name, std::span<const S> values, DType dtype, float end) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::abs(static_cast<float>(values[i])) < end) continue;
      if (std::isfinite(values[i]) || dtype == DType::F16)
        raise<numeric_error>(301, "TensorStore: number ", i, " of '", name, "' is ", values[i], ", too large for ",
                             dtype);
    }
  }
  template <class Stored, Scalar S, class F>
  void put(std::string name, const FileShape& shape, std::span<const S> values, DType dtype, F convert) {
    Entry e{std::move(name), dtype, shape, std::vector<std::byte>(values.size() * sizeof(Stored))};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Stored v = convert(values[i]);
      std::memcpy(e.bytes.data() + i * sizeof(Stored), &v, sizeof(Stored));
    }
    entries_.push_back(std::move(e));
  }
  std::vector<Entry> entries_;
};

namespace detail {
/// Packs a weight. If it lies in a mapped file, its memory there is given back: who still reads it gets it from the
/// file again. Whether all its numbers are finite.
template <PackingBackend B>
bool pack_loaded(const typename B::tensor& weight) {
  const bool finite = pack_weight<B>(weight);
  MappedFile::forget_if_mapped(std::as_bytes(B::to_span(weight)));
  return finite;
}

/// Numbers that are the weight's own, because they had to be converted, go into a file without a name, where there is a
/// place for it.
template <PackingBackend B>
void put_aside(typename B::tensor& weight) {
  const auto bytes = std::as_bytes(B::to_span(weight));
  if (MappedFile::that_holds(bytes) != nullptr || !weight.unique()) return;
  const auto aside = MappedFile::put_aside(bytes);
  if (aside == nullptr) return;
  const auto* numbers = reinterpret_cast<const typename B::scalar*>(aside->bytes().data());
  weight = typename B::tensor(numbers, B::shape(weight), aside);
  BufferPool::local().trim();  // packed, it may need a larger buffer than the one that it leaves
}

/// A small tensor in a mapped file becomes a copy: for a bias the system may keep two megabytes of the file in memory.
template <Backend B>
void copy_small(typename B::tensor& t) {
  if constexpr (requires { t.attached(); }) {
    constexpr std::size_t small = 1 << 14;
    const auto numbers = B::to_span(t);
    const auto bytes = std::as_bytes(numbers);
    const MappedFile* const file = MappedFile::that_holds(bytes);
    if (file == nullptr || t.attached() != nullptr || numbers.size() >= small) return;
    auto copy = B::from_span(numbers, B::shape(t));
    file->forget(bytes);  // before the tensor, which may be the last to keep the file
    t = std::move(copy);
  }
}

/// Makes a tensor ready; returns whether its numbers are finite, if they are `looked_at`.
template <Backend B>
bool prepare_loaded_tensor(const ModuleTensor<B>& t, bool looked_at) {
  bool finite = true;
  if constexpr (PackingBackend<B>) {
    if (has_panels<B>(t.rank)) {
      finite = pack_loaded<B>(*t.data);
      looked_at = false;
    }
  }
  if (looked_at) finite = all_finite(t.span());
  copy_small<B>(*t.data);
  return finite;
}
/// For large networks: a weight that had to be converted is put aside, so that it is not there twice. If it cannot be,
/// it is not packed.
template <Backend B>
void prepare_loaded_once(const ModuleTensor<B>& t) {
  if constexpr (PackingBackend<B>) {
    if (has_panels<B>(t.rank)) {
      put_aside<B>(*t.data);
      if (MappedFile::that_holds(std::as_bytes(t.span())) != nullptr) pack_loaded<B>(*t.data);
    }
  }
  copy_small<B>(*t.data);
}
/// Every thread takes some tensors: new memory is slow to come, and a thread gets it for itself. `finite` (null: not
/// looked at) becomes false if a number is not.
template <Backend B>
void prepare_in_shares(const std::vector<ModuleTensor<B>>& tensors, std::atomic<bool>* finite) {
  const Index count = std::ssize(tensors), shares = parallel_width();
  parallel_for(shares, [&](Index share) {
    for (Index i = 0; i < count; ++i) {
      if (i * shares / count != share) continue;
      const bool good = prepare_loaded_tensor(tensors[static_cast<std::size_t>(i)], finite != nullptr);
      if (finite != nullptr && !good) finite->store(false);
    }
  });
}
}  // namespace detail

/// `prepare` for networks all of whose matrices are weights, straight from a file: the memory of a mapped file is given
/// back as soon as a weight is packed, so that none is there twice, and small tensors become copies. Whoever still
/// reads the file gets it from the disk. Weights that had to be converted are packed beside their numbers.
template <Module M>
void prepare_loaded(M& model) {
  detail::prepare_in_shares(tensors_of(model), nullptr);
}

/// Fills all tensors of a module from the tensors whose names begin with `prefix`. The module has its sizes already.
/// Returns what did not match (then the module is not made ready); throws io_error 407 for a tensor of another shape,
/// numeric_error 301 for NaN and infinity. A module may say (`copy_of`) which further names repeat a tensor of its own;
/// io_error 407 if such a tensor is another one.
template <Module M>
KeyReport load_module_partly(M& module, const TensorSet& file, const std::string& prefix = "",
                             LoadFor use = LoadFor::any_use) {
  const auto tensors = tensors_of(module);
  KeyReport report;
  std::set<std::string> known;
  const auto fill = [&](LoadFor how) {
    report = {};
    known.clear();
    const detail::TensorLoader loader{file, prefix, &tensor_key<M>, how, report, known};
    for (const auto& t : tensors) loader.fill(t);
  };
  fill(use);
  if (use == LoadFor::inference) {
    std::atomic<bool> finite{report.missing.empty()};
    if (finite) detail::prepare_in_shares(tensors, &finite);
    if (!finite) fill(LoadFor::any_use);  // says which number is not
  }
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(prefix) || known.contains(t.name)) continue;
    if (!detail::is_copy(module, file, prefix, t)) report.unexpected.push_back(t.name);
  }
  return report;
}
/// The same, where every name has to match. Throws io_error 406 with both lists, and what looks like a name of either.
template <Module M>
void load_module(M& module, const TensorSet& file, const std::string& prefix = "", LoadFor use = LoadFor::any_use) {
  const KeyReport report = load_module_partly(module, file, prefix, use);
  if (report.missing.empty() && report.unexpected.empty()) return;
  detail::raise_key_mismatch(file.name(), report);
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_TEXT_NETWORK_FILE_HPP  // <motionlang/weights/text_network_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_TEXT_NETWORK_FILE_HPP
/// Text networks from the files of Hugging Face and OpenAI.
///
///     const auto document = read_json("distilbert/config.json");
///     const auto network = load_text_network<DistilBert<B>>(JsonView(document, "config.json"),
///     open_weights("model.safetensors")); const auto clip = load_clip_text<B>(open_weights("ViT-B-32.pt"));
///
/// Prefix   what stands before the name of the word embedding ("embeddings.word_embeddings.weight",
///          "token_embedding.weight") stands before all names of the network: "distilbert.", "bert.",
///          "textencoder.text_model." (TEMOS, TEACH, SINC), "clip_model." (MDM) ... Tensors with other names are not
///          read
/// Ignored  position_ids, poolers, heads of the pre-training (vocab_*, cls.*, lm_head.*); CLIP: logit_scale and the
///          image tower
/// Aliases  LayerNorm.gamma and .beta for .weight and .bias; CLIP in the form of Hugging Face, whose projections of
///          query, key and value are stacked and whose text_projection is transposed
/// Memory   tensors of 32-bit numbers are views of the file. Weights of layers are packed for the kernels (prepare) and
///          their memory in the file is given back, so that no weight is there twice; those that had to be converted or
///          put together lie in temporary files for that. Where there is no place for such files, they are packed
///          whenever they are used
/// Throws   config_error 103 for another model_type, activation or position_embedding_type, 101 for impossible sizes,
///          102 for sizes far above those of the file; io_error 406, 407 if names or shapes do not match
/// Source   spec text-encoders.md, sections 2 to 5

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

namespace detail {

/// The tensors of a file under other names, some of them put together.
class RenamedTensors : public TensorSet {
 public:
  explicit RenamedTensors(const TensorSet& file);
  void add(TensorView view, std::string name);
  /// A tensor that was made; matrices are put aside, so that they can be packed like those of the file.
  void add(TensorView view, std::string name, std::vector<std::byte> bytes);
  void sort();

 private:
  struct Memory {
    std::shared_ptr<const void> file;
    std::vector<std::shared_ptr<const MappedFile>> aside;
    std::deque<std::vector<std::byte>> made;
  };
  std::shared_ptr<Memory> memory_ = std::make_shared<Memory>();
};

/// What stands before `name` in the only tensor whose name ends so, at a dot. Nothing if there is none; throws io_error
/// 406 if there are two.
std::optional<std::string> prefix_of(const TensorSet& file, std::string_view name);

inline bool begins_with_any(std::string_view name, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(), [&](std::string_view b) { return name.starts_with(b); });
}

RenamedTensors bert_tensors(const TensorSet& file);

/// The tensors of the text tower under OpenAI's names.
RenamedTensors clip_tensors(const TensorSet& file);

template <class Layer>
void pack_layers(std::vector<Layer>& layers) {
  for (Layer& layer : layers) {
    for (const auto& t : tensors_of(layer)) prepare_loaded_once(t);
  }
}

/// For a network that is about to be made and filled from these weights.
ParameterRoom room_of(const TensorSet& weights);

}  // namespace detail

/// The sizes in the config.json of a member of the BERT family; `model_type` says which one it has to be.
BertConfig bert_config(const JsonView& config, std::string_view model_type);

/// Fills a network of the BERT family.
template <class Network>
Network load_text_network(const BertConfig& config, const TensorSet& weights) {
  const auto room = detail::room_of(weights);
  NoInit zeros;
  Network network(config, zeros);
  load_module(network, detail::bert_tensors(weights));
  detail::pack_layers(network.layers);
  return network;
}
/// Network is DistilBert<B>, Bert<B> or Mpnet<B>.
template <class Network>
Network load_text_network(const JsonView& config, const TensorSet& weights) {
  return load_text_network<Network>(bert_config(config, Network::keys::model_type), weights);
}

/// The sizes of a DistilBERT from the shapes of its tensors, with 64 numbers a head: inside checkpoints of TEMOS, TEACH
/// and SINC. Throws io_error 406, 407.
BertConfig distilbert_config(const TensorSet& file);

/// The sizes in the config.json of a CLIP model, or of its text tower alone. What it leaves out, as newer files do with
/// whatever is usual, is as in ViT-B/32.
ClipTextConfig clip_text_config(const JsonView& config);

/// The sizes of a text tower from the shapes of its tensors, with 64 numbers a head. Throws io_error 406, 407.
ClipTextConfig clip_text_config(const TensorSet& file);

template <Backend B>
ClipText<B> load_clip_text(const ClipTextConfig& config, const TensorSet& weights) {
  const auto room = detail::room_of(weights);
  NoInit zeros;
  ClipText<B> network(config, zeros);
  load_module(network, detail::clip_tensors(weights));
  detail::pack_layers(network.blocks);
  return network;
}
template <Backend B>
ClipText<B> load_clip_text(const JsonView& config, const TensorSet& weights) {
  return load_clip_text<B>(clip_text_config(config), weights);
}
template <Backend B>
ClipText<B> load_clip_text(const TensorSet& weights) {
  const auto tensors = detail::clip_tensors(weights);  // put together once
  return load_clip_text<B>(clip_text_config(tensors), tensors);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_TEXT_NETWORK_FILE_IPP  // <motionlang/weights/text_network_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_TEXT_NETWORK_FILE_IPP
// Bodies of text_network_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY RenamedTensors::RenamedTensors(const TensorSet& file) : TensorSet(file.name(), nullptr) {
  if (file.owner() == nullptr) return;  // bytes that nobody keeps: tensors will be copies
  memory_->file = file.owner();
  owner_ = memory_;
}

MOTIONLANG_BODY void RenamedTensors::add(TensorView view, std::string name) {
  view.name = std::move(name);
  tensors_.push_back(std::move(view));
}

MOTIONLANG_BODY void RenamedTensors::add(TensorView view, std::string name, std::vector<std::byte> bytes) {
  if (auto aside = view.shape.rank() == 2 ? MappedFile::put_aside(bytes) : nullptr)
    view.bytes = memory_->aside.emplace_back(std::move(aside))->bytes();
  else
    view.bytes = memory_->made.emplace_back(std::move(bytes));
  add(std::move(view), std::move(name));
}

MOTIONLANG_BODY void RenamedTensors::sort() {
  detail::sort(tensors_, [](const TensorView& a, const TensorView& b) { return a.name < b.name; });
}

MOTIONLANG_BODY std::optional<std::string> prefix_of(const TensorSet& file, std::string_view name) {
  std::optional<std::string> prefix;
  for (const TensorView& t : file.tensors()) {
    const std::string_view whole = t.name;
    if (!whole.ends_with(name)) continue;
    const std::string_view before = whole.substr(0, whole.size() - name.size());
    if (!before.empty() && before.back() != '.') continue;
    if (prefix)
      raise<io_error>(406, file.name(), ": two networks, '", *prefix, name, "' and '", whole, "': which one is meant?");
    prefix = before;
  }
  return prefix;
}

MOTIONLANG_BODY RenamedTensors bert_tensors(const TensorSet& file) {
  constexpr std::string_view words = "embeddings.word_embeddings.weight";
  const auto prefix = prefix_of(file, words);
  if (!prefix) raise<io_error>(406, file.name(), ": no tensor '", words, "', with or without a prefix");
  RenamedTensors out(file);
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(*prefix)) continue;
    std::string name = t.name.substr(prefix->size());
    if (name.ends_with("position_ids") || begins_with_any(name, {"pooler.", "vocab_", "cls.", "lm_head."})) continue;
    if (name.ends_with("LayerNorm.gamma")) name.replace(name.size() - 5, 5, "weight");
    if (name.ends_with("LayerNorm.beta")) name.replace(name.size() - 4, 4, "bias");
    out.add(t, std::move(name));
  }
  out.sort();
  return out;
}

/// The rows of several tensors, one below the other.
inline void add_stacked(RenamedTensors& out, const std::array<const TensorView*, 3>& parts, std::string name,
                        std::string_view where) {
  TensorView whole = *parts[0];
  std::vector<std::byte> bytes;
  for (const TensorView* p : parts) {
    if (p->dtype != whole.dtype || p->shape != parts[0]->shape || p->shape.rank() == 0)
      raise<io_error>(407, where, ": '", p->name, "' is ", p->dtype, " ", p->shape, ", '", parts[0]->name, "' ",
                      whole.dtype, " ", parts[0]->shape);
    bytes.insert(bytes.end(), p->bytes.begin(), p->bytes.end());
    MappedFile::forget_if_mapped(p->bytes);
  }
  whole.shape[0] = 3 * parts[0]->shape[0];
  out.add(std::move(whole), std::move(name), std::move(bytes));
}

inline void add_transposed(RenamedTensors& out, TensorView view, std::string name, std::string_view where) {
  if (view.shape.rank() != 2) raise<io_error>(407, where, ": '", view.name, "' is ", view.shape, ", not a matrix");
  const auto rows = static_cast<std::size_t>(view.shape[0]), columns = static_cast<std::size_t>(view.shape[1]);
  const std::size_t size = static_cast<std::size_t>(info(view.dtype).bits) / 8;
  std::vector<std::byte> bytes(view.bytes.size());
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c)
      std::memcpy(bytes.data() + (c * rows + r) * size, view.bytes.data() + (r * columns + c) * size, size);
  }
  std::swap(view.shape[0], view.shape[1]);
  MappedFile::forget_if_mapped(view.bytes);
  out.add(std::move(view), std::move(name), std::move(bytes));
}

/// From the names of Hugging Face to those of OpenAI. `prefix` stands before "text_model.".
inline RenamedTensors clip_tensors_of_hugging_face(const TensorSet& file, const std::string& prefix) {
  constexpr std::string_view layers = "encoder.layers.";
  constexpr std::array<std::array<std::string_view, 2>, 3> whole{
      {{"embeddings.token_embedding.", "token_embedding."},
       {"embeddings.position_embedding.weight", "positional_embedding"},
       {"final_layer_norm.", "ln_final."}}};
  constexpr std::array<std::array<std::string_view, 2>, 5> parts{{{"layer_norm1.", "ln_1."},
                                                                  {"layer_norm2.", "ln_2."},
                                                                  {"self_attn.out_proj.", "attn.out_proj."},
                                                                  {"mlp.fc1.", "mlp.c_fc."},
                                                                  {"mlp.fc2.", "mlp.c_proj."}}};
  const auto renamed = [](std::string_view name, const auto& table) {
    for (const auto& [from, to] : table) {
      if (name.starts_with(from)) return std::string(to).append(name.substr(from.size()));
    }
    return std::string(name);  // to be reported
  };
  RenamedTensors out(file);
  const std::string model = prefix + "text_model.";
  if (const TensorView* t = file.find(prefix + "text_projection.weight"))
    add_transposed(out, *t, "text_projection", file.name());
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(model) || t.name.ends_with("position_ids")) continue;
    const std::string_view name = std::string_view(t.name).substr(model.size());
    if (!name.starts_with(layers)) {
      out.add(t, renamed(name, whole));
      continue;
    }
    const std::size_t dot = std::min(name.find('.', layers.size()), name.size() - 1);
    const std::string block =
        "transformer.resblocks." + std::string(name.substr(layers.size(), dot + 1 - layers.size()));
    const std::string_view part = name.substr(dot + 1);
    const std::string before = t.name.substr(0, t.name.size() - part.size());
    bool stacked = false;
    for (const char* kind : {"weight", "bias"}) {
      const auto of = [&](const char* p) { return file.find(before + "self_attn." + p + "_proj." + kind); };
      const std::array<const TensorView*, 3> qkv{of("q"), of("k"), of("v")};
      if (qkv[0] == nullptr || qkv[1] == nullptr || qkv[2] == nullptr) continue;
      if (&t == qkv[0]) add_stacked(out, qkv, block + "attn.in_proj_" + kind, file.name());
      stacked = stacked || &t == qkv[0] || &t == qkv[1] || &t == qkv[2];
    }
    if (!stacked) out.add(t, block + renamed(part, parts));
  }
  out.sort();
  return out;
}

MOTIONLANG_BODY RenamedTensors clip_tensors(const TensorSet& file) {
  if (const auto prefix = prefix_of(file, "text_model.embeddings.token_embedding.weight"))
    return clip_tensors_of_hugging_face(file, *prefix);
  const auto prefix = prefix_of(file, "token_embedding.weight");
  if (!prefix) raise<io_error>(406, file.name(), ": no tensor 'token_embedding.weight', with or without a prefix");
  RenamedTensors out(file);
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(*prefix)) continue;
    std::string name = t.name.substr(prefix->size());
    if (begins_with_any(name, {"visual.", "logit_scale", "input_resolution", "context_length", "vocab_size"})) continue;
    out.add(t, std::move(name));
  }
  out.sort();
  return out;
}

MOTIONLANG_BODY ParameterRoom room_of(const TensorSet& weights) {
  Index numbers = 0;
  for (const TensorView& t : weights.tensors()) numbers += t.shape.count();
  return {weights.name(), numbers};
}

/// A size in a configuration file, 1 ... largest.
inline Index config_size(const JsonView& config, const std::string& key, Index largest) {
  const Index n = config[key].as<Index>();
  if (n < 1 || n > largest) raise<config_error>(101, config.path(), ": ", key, " is ", n, ", not 1 ... ", largest);
  return n;
}

inline Activation config_activation(const JsonView& config, const std::string& key) {
  const auto name = config[key].as<std::string>();
  if (name != "relu" && name != "gelu" && name != "gelu_new" && name != "quick_gelu")
    raise<config_error>(103, config.path(), ": ", key, " '", name, "' is not one of relu, gelu, gelu_new, quick_gelu");
  return parse_activation(name);
}

inline constexpr Index largest_width = 16384, largest_vocabulary = 10'000'000, largest_depth = 1024;

}  // namespace detail

MOTIONLANG_BODY BertConfig bert_config(const JsonView& config, std::string_view model_type) {
  using detail::config_size;
  if (const auto found = config["model_type"].as<std::string>(); found != model_type)
    raise<config_error>(103, config.path(), ": model_type '", found, "', expected '", model_type, "'");
  if (const auto kind = config.value_or("position_embedding_type", "absolute"); kind != "absolute")
    raise<config_error>(103, config.path(), ": position_embedding_type '", kind, "' is not 'absolute'");
  const bool distilled = model_type == "distilbert";
  BertConfig c;
  c.vocabulary = config_size(config, "vocab_size", detail::largest_vocabulary);
  c.width = config_size(config, distilled ? "dim" : "hidden_size", detail::largest_width);
  c.heads = config_size(config, distilled ? "n_heads" : "num_attention_heads", detail::largest_width);
  c.layers = config_size(config, distilled ? "n_layers" : "num_hidden_layers", detail::largest_depth);
  c.d_ff = config_size(config, distilled ? "hidden_dim" : "intermediate_size", 8 * detail::largest_width);
  c.positions = config_size(config, "max_position_embeddings", detail::largest_vocabulary);
  c.activation = detail::config_activation(config, distilled ? "activation" : "hidden_act");
  c.padding = config.value_or("pad_token_id", Index{model_type == "mpnet" ? 1 : 0});
  if (!distilled) c.eps = config.value_or("layer_norm_eps", 1e-12);
  if (model_type == "bert") c.token_types = config_size(config, "type_vocab_size", detail::largest_vocabulary);
  if (config.contains("relative_attention_num_buckets"))
    c.buckets = config_size(config, "relative_attention_num_buckets", detail::largest_vocabulary);
  if (c.buckets != 32) raise<config_error>(101, config.path(), ": ", c.buckets, " buckets of distances, known are 32");
  if (c.padding < 0 || c.padding >= c.vocabulary)
    raise<config_error>(101, config.path(), ": pad_token_id ", c.padding, " in a vocabulary of ", c.vocabulary);
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_BODY BertConfig distilbert_config(const TensorSet& file) {
  const auto tensors = detail::bert_tensors(file);
  const auto matrix = [&](const std::string& name) {
    const TensorView& t = tensors.tensor(name);
    if (t.shape.rank() != 2) raise<io_error>(407, file.name(), ": '", name, "' is ", t.shape, ", not a matrix");
    return t.shape;
  };
  const Shape words = matrix("embeddings.word_embeddings.weight");
  BertConfig c{.vocabulary = words[0],
               .width = words[1],
               .heads = std::max<Index>(1, words[1] / 64),
               .d_ff = matrix("transformer.layer.0.ffn.lin1.weight")[0],
               .layers = 0,
               .positions = matrix("embeddings.position_embeddings.weight")[0]};
  while (tensors.find(concat_text("transformer.layer.", c.layers, ".ffn.lin1.weight")) != nullptr) ++c.layers;
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_BODY ClipTextConfig clip_text_config(const JsonView& config) {
  using detail::config_size;
  const JsonView text =
      config.contains("text_config") && config["text_config"].is_object() ? config["text_config"] : config;
  const bool older = config.contains("text_config_dict") && config["text_config_dict"].is_object();
  const auto at = [&](const std::string& key) {  // where older files say it twice, the dictionary wins
    if (key == "projection_dim" && config.contains(key)) return config;
    return older && config["text_config_dict"].contains(key) ? config["text_config_dict"] : text;
  };
  ClipTextConfig c;
  const auto read = [&](Index& size, const std::string& key, Index largest) {
    if (at(key).contains(key)) size = config_size(at(key), key, largest);
  };
  read(c.vocabulary, "vocab_size", detail::largest_vocabulary);
  read(c.width, "hidden_size", detail::largest_width);
  read(c.heads, "num_attention_heads", detail::largest_width);
  read(c.layers, "num_hidden_layers", detail::largest_depth);
  read(c.d_ff, "intermediate_size", 8 * detail::largest_width);
  read(c.context, "max_position_embeddings", detail::largest_vocabulary);
  read(c.out, "projection_dim", detail::largest_width);
  if (at("hidden_act").contains("hidden_act")) c.activation = detail::config_activation(at("hidden_act"), "hidden_act");
  c.eps = at("layer_norm_eps").value_or("layer_norm_eps", c.eps);
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_BODY ClipTextConfig clip_text_config(const TensorSet& file) {
  const auto tensors = detail::clip_tensors(file);
  const auto matrix = [&](const std::string& name) {
    const TensorView& t = tensors.tensor(name);
    if (t.shape.rank() != 2) raise<io_error>(407, file.name(), ": '", name, "' is ", t.shape, ", not a matrix");
    return t.shape;
  };
  const Shape words = matrix("token_embedding.weight");
  ClipTextConfig c{.vocabulary = words[0],
                   .width = words[1],
                   .heads = std::max<Index>(1, words[1] / 64),
                   .d_ff = matrix("transformer.resblocks.0.mlp.c_fc.weight")[0],
                   .layers = 0,
                   .context = matrix("positional_embedding")[0],
                   .out = matrix("text_projection")[1]};
  while (tensors.find(concat_text("transformer.resblocks.", c.layers, ".ln_1.weight")) != nullptr) ++c.layers;
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_WEIGHT_FILE_HPP  // <motionlang/weights/weight_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_WEIGHT_FILE_HPP
/// Weights from whatever file they are in: safetensors, PyTorch (zip, TorchScript, the older form, Lightning), NumPy
/// (npy, npz), pickles, joblib dumps, and folders of them as training runs leave them. The format is known by content,
/// never by name.
///
///     const WeightFile file = open_weights("logs/last.ckpt");
///     load_module(model, file, "denoiser.");
///     if (const FileValue* epoch = file.value("epoch")) ...
///
/// Nothing in a file is executed: objects of classes that are not known are skipped, and listed; numbers and texts in
/// their fields are read as values. Tensors that lie in order in the file are views of it, without a copy.
///
/// Memory   besides the mapped file at most twice its size and 64 MiB. What is packed as a whole (a joblib dump that
///          was written with compress=, or gzip) is unpacked in memory: to at most twice the size of the file and 30
///          MiB, into which the copies of arrays in another order have to fit, too; what gives more is refused with
///          io_error 405, and what is packed with bzip2, xz, lzma, lz4 or zstd with 404: unpack it first
/// Source   spec weights.md

#ifndef MOTIONLANG_HAS_WEIGHTS_RUN_FOLDER_HPP  // <motionlang/weights/run_folder.hpp>
#define MOTIONLANG_HAS_WEIGHTS_RUN_FOLDER_HPP
/// The folders in which the published systems leave a model: which system it is, and where options, weights and
/// statistics are. Nothing is opened but the options.
///
///     const RunFolder run = find_run("models/mdm-smpl_clip_smplrifke_humanml3d");   // run.system == "stmc"
///
/// System         known by                                        weights
/// motionlang     config.json with "format": "motionlang"         weights.safetensors (weights/model_folder.hpp)
/// stmc           config.json with diffusion/...                  logs/checkpoints/last.ckpt, else the latest epoch
/// tmr            config.json with model/motion_encoder/...       last_weights/*.pt, else as stmc
/// hugging face   config.json with model_type                     model.safetensors, pytorch_model.bin, with an index
///                where in shards
/// mdm            args.json                                       model000475000.pt: the one with the largest number
/// actor          opt.yaml, or a checkpoint_0100.pth.tar          the checkpoint with the largest number
/// temos          .hydra/config.yaml (TEMOS, TEACH, SINC)         checkpoints/last.ckpt, else the latest epoch
/// motiondiffuse  opt.txt with diffusion_steps                    model/latest.tar, else the latest epoch
/// tm2t           any other opt.txt                               model/finest.tar, latest.tar, else the latest epoch
///
/// Packed         a config.json of "format": "motionlang" that says "published": what weights/pack_run.hpp made of the
///                folder of a system; that system, with its options and weights.safetensors. One of tm2t is packed,
///                whoever trained it
/// Statistics     mean and std (TEMOS: jfeats_mean, rfeats_mean ...), .pt or .npy, in the folder itself or in stats,
///                *_stats or meta
/// Source         spec weights.md 9; actor.md 3.2, temos.md 3.2, tmr.md 3.2, mdm.md 2.2, 3.5, 4.4, tm2t.md 6

MOTIONLANG_NAMESPACE_BEGIN

struct RunFolder {
  std::filesystem::path folder;
  std::string system;                                  // as above; "": none of them
  std::filesystem::path options_file;                  // empty if there is none
  std::vector<FileValue> options;                      // of that file
  std::filesystem::path weights;                       // the file with the tensors; empty if they are in parts
  std::map<std::string, std::filesystem::path> parts;  // files by what the names of their tensors begin with
  bool packed = false;                                 // one file of weights, with the statistics

  /// Null if no option has this path; follows references.
  const FileValue* option(std::string_view path) const { return find_option(options, path); }
};

namespace detail {

/// Numbers in names count as numbers: epoch=99 before epoch=100.
bool before_by_number(std::string_view a, std::string_view b);

/// What is in a folder, in the order of `before_by_number`; nothing if it is none.
std::vector<std::filesystem::path> listed(const std::filesystem::path& folder);

/// The options behind "config/", which in a folder of ours are those of the system.
std::vector<FileValue> options_of_config(const RunFolder& run);

}  // namespace detail

/// Looks at a folder. What is missing stays empty: it is an error of whoever needs it.
/// Throws  io_error 401 if it cannot be listed, and what read_options throws
RunFolder find_run(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_RUN_FOLDER_IPP  // <motionlang/weights/run_folder.ipp>
#define MOTIONLANG_HAS_WEIGHTS_RUN_FOLDER_IPP
// Bodies of run_folder.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool before_by_number(std::string_view a, std::string_view b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto number = [&](std::string_view& text) {  // without zeros in front; takes it off
    std::size_t end = 0;
    while (end < text.size() && digit(text[end])) ++end;
    const std::string_view whole = text.substr(0, end);
    text.remove_prefix(end);
    return whole.substr(std::min(whole.find_first_not_of('0'), whole.size()));
  };
  while (!a.empty() && !b.empty()) {
    if (digit(a[0]) && digit(b[0])) {
      const std::string_view x = number(a), y = number(b);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[0] != b[0]) return a[0] < b[0];
      a.remove_prefix(1), b.remove_prefix(1);
    }
  }
  return a.size() < b.size();
}

MOTIONLANG_BODY std::vector<std::filesystem::path> listed(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) out.push_back(entry.path());
  detail::sort(
      out, [](const auto& a, const auto& b) { return before_by_number(a.filename().string(), b.filename().string()); });
  return out;
}

/// The file of a folder that comes first in `names`, else the last one whose name begins and ends so; empty if there is
/// none.
inline std::filesystem::path best_file(const std::filesystem::path& folder, std::initializer_list<const char*> names,
                                       std::string_view begin, std::string_view end) {
  std::error_code ignored;
  for (const char* name : names) {
    if (std::filesystem::is_regular_file(folder / name, ignored)) return folder / name;
  }
  std::filesystem::path best;
  for (const auto& p : listed(folder)) {
    const std::string name = p.filename().string();
    if (name.starts_with(begin) && name.ends_with(end) && std::filesystem::is_regular_file(p, ignored)) best = p;
  }
  return best;
}

/// The first that is not empty.
inline std::filesystem::path first_found(std::initializer_list<std::filesystem::path> paths) {
  for (const auto& p : paths) {
    if (!p.empty()) return p;
  }
  return {};
}

inline bool has_option_below(const RunFolder& run, std::string_view beginning) {
  return std::any_of(run.options.begin(), run.options.end(),
                     [&](const FileValue& v) { return v.path.starts_with(beginning); });
}

/// The system from the options, "" if they say nothing.
inline std::string system_of_options(const RunFolder& run) {
  const std::string file = run.options_file.filename().string();
  if (file == "args.json") return "mdm";
  if (file == "opt.yaml") return "actor";
  if (file == "config.yaml") return "temos";
  if (file == "opt.txt") return run.option("diffusion_steps") != nullptr ? "motiondiffuse" : "tm2t";
  if (const FileValue* format = run.option("format"); format != nullptr && to_string(*format) == "motionlang")
    return "motionlang";
  if (has_option_below(run, "diffusion/")) return "stmc";
  if (has_option_below(run, "model/motion_encoder/")) return "tmr";
  return run.option("model_type") != nullptr ? "hugging face" : "";
}

MOTIONLANG_BODY std::vector<FileValue> options_of_config(const RunFolder& run) {
  constexpr std::string_view below = "config/";
  std::vector<FileValue> out;
  for (const FileValue& v : run.options) {
    if (v.path.starts_with(below)) out.push_back({v.path.substr(below.size()), v.value});
  }
  return out;
}

/// Of a packed run the run.
inline void unpack(RunFolder& run) {
  const FileValue *published = run.option("published"), *system = run.option("system");
  if (run.system != "motionlang" || system == nullptr) return;
  if ((published == nullptr || to_string(*published) != "true") && to_string(*system) != "tm2t") return;
  run.system = to_string(*system);
  if (run.system == "teach" || run.system == "sinc") run.system = "temos";  // whose folders look alike
  run.options = options_of_config(run);
  run.packed = true;
}

/// Files of statistics under the names "mean" and "std", behind that of their folder.
inline void add_statistics(RunFolder& run) {
  const auto add = [&](const std::filesystem::path& folder, const std::string& prefix) {
    for (const auto& p : listed(folder)) {
      const std::string name = p.filename().string();
      for (const char* what : {"mean", "std"}) {
        const std::string capital = std::string(1, static_cast<char>(what[0] - 'a' + 'A')) + (what + 1);
        for (const std::string& stem :
             {std::string(what), capital, concat_text("jfeats_", what), concat_text("rfeats_", what)}) {
          if (name == stem + ".pt" || name == stem + ".npy") run.parts.emplace(prefix + what, p);
        }
      }
    }
  };
  add(run.folder, "");
  for (const auto& p : listed(run.folder)) {
    const std::string name = p.filename().string();
    if (name == "stats" || name == "meta" || name.ends_with("_stats")) add(p, name + ".");
  }
}

inline void find_weights(RunFolder& run) {
  namespace fs = std::filesystem;
  const fs::path& folder = run.folder;
  const auto lightning = [&](const fs::path& sub) {
    return best_file(folder / sub, {"last.ckpt"}, "latest-epoch=", ".ckpt");
  };
  const fs::path whole =
      best_file(folder, {"weights.safetensors", "model.safetensors"}, "model", ".safetensors.index.json");
  const fs::path checkpoint = best_file(folder, {}, "checkpoint_", ".pth.tar");
  const fs::path model = best_file(folder, {}, "model0", ".pt");
  fs::path split;  // a folder of one file for each module
  for (const auto& p : listed(folder)) {
    if (p.filename().string().ends_with("_weights") && split.filename() != "last_weights") split = p;
  }
  if (run.system.empty() && !checkpoint.empty()) run.system = "actor";
  if (run.system.empty() && !split.empty()) run.system = "tmr";
  if (run.system.empty() && !model.empty() && whole.empty()) run.system = "mdm";

  if (run.packed)
    run.weights = whole;
  else if (run.system == "stmc" || run.system == "temos")
    run.weights = first_found({lightning("logs/checkpoints"), lightning("checkpoints")});
  else if (run.system == "mdm")
    run.weights = first_found({model, best_file(folder, {}, "model", ".pt")});
  else if (run.system == "actor")
    run.weights = first_found({checkpoint, best_file(folder, {}, "retraincheckpoint_", ".pth.tar")});
  else if (run.system == "motiondiffuse")
    run.weights = first_found({best_file(folder / "model", {"latest.tar"}, "ckpt_", ".tar"),
                               best_file(folder, {"latest.tar"}, "ckpt_", ".tar")});
  else if (run.system == "tm2t")
    run.weights = first_found({best_file(folder / "model", {"finest.tar", "latest.tar"}, "E", ".tar"),
                               best_file(folder, {"finest.tar", "latest.tar"}, "E", ".tar")});
  else if (run.system != "tmr" || !whole.empty())
    run.weights = first_found({whole, best_file(folder, {"pytorch_model.bin"}, "pytorch_model", ".bin.index.json")});

  const auto add_parts = [&](const fs::path& of) {
    for (const auto& p : listed(of)) {
      if (p.extension() == ".pt") run.parts.emplace(p.stem().string(), p);
    }
  };
  if (run.weights.empty() && !split.empty()) {
    add_parts(split);
  } else if (run.weights.empty() && run.system == "tmr") {
    run.weights = first_found({lightning("logs/checkpoints"), lightning("checkpoints")});
  }
  add_statistics(run);
  if (run.weights.empty() && split.empty()) add_parts(folder);  // of a system that nobody knows: every file is a part
}

}  // namespace detail

MOTIONLANG_BODY RunFolder find_run(const FilePath& path) {
  namespace fs = std::filesystem;
  RunFolder run{.folder = path.string(), .system = {}, .options_file = {}, .options = {}, .weights = {}, .parts = {}};
  std::error_code problem;
  static_cast<void>(fs::directory_iterator(run.folder, problem));
  if (problem) raise<io_error>(401, "cannot list ", path.string(), ": ", problem.message());
  std::error_code ignored;
  for (const char* name : {"config.json", "args.json", "opt.yaml", "opt.txt", ".hydra/config.yaml"}) {
    if (run.options_file.empty() && fs::is_regular_file(run.folder / name, ignored))
      run.options_file = run.folder / name;
  }
  if (!run.options_file.empty()) {
    run.options = read_options(run.options_file);
    run.system = detail::system_of_options(run);
    detail::unpack(run);
  }
  detail::find_weights(run);
  return run;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct WeightOptions {
  /// Keys from the root of the file to the dictionary of tensors, "state_dict" or "a/b"; "" means the root. Unless
  /// given: the root if it holds tensors itself, else its "state_dict", "model_state_dict" or "model", else the root.
  std::optional<std::string> path{};
  bool strict = false;     // refuse what is skipped otherwise
  bool checksums = false;  // compare those of PyTorch's storages, too: reads the whole file
};

/// Something that was passed over: the keys from the root of the file to it, and its class or element type.
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
/// Throws io_error 402, 403 if the stream is damaged, 405 if it is longer than `limit`. Looks how long it is before it
/// allocates.
std::vector<std::byte> from_zlib(std::span<const std::byte> bytes, std::size_t limit, const std::string& name);
}  // namespace detail

/// Tensors of a file, sorted by name, and what else it says. A tensor in dictionaries is called by their keys, joined
/// with '.' in PyTorch's files and with '/' in others; a tensor on its own is called "array".
class WeightFile : public TensorSet {
 public:
  /// "safetensors", "torch zip", "TorchScript", "torch legacy", "npy", "npz", "pickle", "joblib", "shards", "folder",
  /// or "TMR run folder" and the like.
  const std::string& format() const { return format_; }
  /// The first 10,000 of them, in the order of the file.
  const std::vector<FileValue>& values() const { return values_; }
  /// Null if there is none at these keys.
  const FileValue* value(std::string_view path) const { return find_value(values_, path); }
  /// The first 1,000 values that were passed over, in the order of the file.
  const std::vector<SkippedValue>& skipped() const { return skipped_; }
  /// All files that hold these tensors; of shards their index as well. None of bytes in memory.
  const std::vector<std::filesystem::path>& files() const { return files_; }

  /// A file in memory. `owner` keeps the bytes alive; without one they have to outlive the object. `name` stands in
  /// messages.
  /// Throws  io_error 402, 403, 405 if the file is damaged, 404 if its format is not known or not supported, or if it
  ///         tries to execute code, 406 if it holds no tensors or `options.path` leads nowhere
  static WeightFile from_bytes(std::span<const std::byte> bytes, std::string name,
                               std::shared_ptr<const void> owner = {}, const WeightOptions& options = {});
  /// The files of a folder. Throws io_error 404 if there are none, and what open_weights throws.
  static WeightFile from_run(const RunFolder& run, const WeightOptions& options = {});

 private:
  friend class detail::WeightReader;
  friend WeightFile open_weights(const FilePath& path, const WeightOptions& options);
  WeightFile(std::string name, std::shared_ptr<const void> owner, std::string format)
      : TensorSet(std::move(name), std::move(owner)), format_(std::move(format)) {}

  static WeightFile from_safetensors(const SafetensorsFile& file);
  static WeightFile from_shards(const FilePath& index, const WeightOptions& options);
  /// Takes over what another file holds, its names behind a prefix. `owners` are those of this file.
  void add(const WeightFile& file, const std::string& prefix, std::vector<std::shared_ptr<const void>>& owners);
  void sort_tensors();

  std::string format_;
  std::vector<FileValue> values_;
  std::vector<SkippedValue> skipped_;
  std::vector<std::filesystem::path> files_;
};

/// Whether this is a folder, or a file that begins as open_weights expects it or is no text, so that open_weights can
/// say best what is wrong with it; older pickles, which are text, are not seen.
bool may_be_weights(const FilePath& path);

/// Opens a file, the index.json of weights in shards, or the folder of a training run (weights/run_folder.hpp).
/// Throws  io_error 401 if it cannot be opened, 406 if a shard lacks a tensor, and what WeightFile::from_bytes and
///         find_run throw
WeightFile open_weights(const FilePath& path, const WeightOptions& options);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_WEIGHT_FILE_IPP  // <motionlang/weights/weight_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_WEIGHT_FILE_IPP
// Bodies of weight_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void WeightFile::sort_tensors() {
  detail::sort(tensors_, [](const TensorView& a, const TensorView& b) { return a.name < b.name; });
  for (std::size_t i = 1; i < tensors_.size(); ++i) {
    if (tensors_[i - 1].name == tensors_[i].name)
      raise<io_error>(403, name_, ": two tensors are called '", tensors_[i].name, "'");
  }
}

namespace detail {

/// Fills a WeightFile.
class WeightReader {
 public:
  /// file_size   an honest file has no more values to look at than bytes
  WeightReader(WeightFile& out, TensorMemory& memory, const WeightOptions& options, std::uint64_t file_size)
      : out_(out),
        memory_(memory),
        options_(options),
        visits_left_(std::min(10'000 + file_size, most_visits)),
        visits_for_known_(visits_left_ / 2) {}

  void read(const TorchFile& file) {
    torch_ = &file;
    separator_ = file.format() == "pickle" ? '/' : '.';
    const std::string selection = options_.path ? *options_.path : default_path(file.root());
    find_selection(file.root(), selection);
    visit(file.root());
    if (separator_ == '/' && joblib_) out_.format_ = "joblib";
  }
  void read(const NpzArchive& file, const ZipArchive& zip) {
    constexpr std::string_view suffix = ".npy";
    for (const ZipEntry& e : zip.entries()) {
      if (!e.name.ends_with(suffix)) continue;
      path_.assign(1, std::string_view(e.name).substr(0, e.name.size() - suffix.size()));
      attempt(e.name, [&] {
        if (e.deflated) memory_.spend(e.size);
        const auto bytes = e.deflated ? std::span<const std::byte>(memory_.keep(zip.read(e))) : zip.checked(e);
        add_npy(bytes, concat_text(file.file(), "/", e.name));
      });
    }
  }
  void read_npy(std::span<const std::byte> bytes) { add_npy(bytes, out_.name()); }

 private:
  static constexpr std::size_t deepest = 64, most_values = 10'000, most_texts = 1'000, most_skipped = 1'000;
  static constexpr std::uint64_t most_visits = 2'000'000;

  // What to look for.

  bool holds_tensors(const PickleValue& v) const {
    for (std::size_t i = 0; v.is(PickleKind::dict) && i < v.size(); ++i) {
      if (TorchFile::is_tensor(v.value(i))) return true;
    }
    return false;
  }
  std::string default_path(const PickleValue& root) const {
    if (!root.is(PickleKind::dict) || holds_tensors(root)) return "";
    for (const char* key : {"state_dict", "model_state_dict", "model"}) {
      if (const auto found = root.find(key); found && holds_tensors(*found)) return key;
    }
    return "";
  }
  void find_selection(PickleValue v, std::string_view keys) {
    while (!keys.empty()) {
      const std::size_t slash = std::min(keys.find('/'), keys.size());
      selection_.emplace_back(keys.substr(0, slash));
      const auto found = entry(v, selection_.back());
      if (!found)
        raise<io_error>(406, out_.name(), ": no entry '", selection_.back(), "' in the value at byte ", v.at());
      v = *found;
      keys.remove_prefix(std::min(slash + 1, keys.size()));
    }
  }
  /// What a key leads to: a text, a number, or the place in a list.
  static std::optional<PickleValue> entry(const PickleValue& v, std::string_view key) {
    if (const auto found = v.find(key)) return found;
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (!v.keyed() && concat_text(i) == key) return v[i];
      if (v.keyed() && v.key(i).is(PickleKind::integer) && concat_text(v.key(i).integer()) == key) return v.value(i);
    }
    return std::nullopt;
  }
  bool selected() const {
    return unknown_.empty() && path_.size() >= selection_.size() &&
           std::equal(selection_.begin(), selection_.end(), path_.begin());
  }

  // Walking through a pickle.

  /// An account of time: as many values as the file justifies. What takes longer than looking at one counts as more.
  void spend_visits(const PickleValue& v, std::uint64_t count = 1) {
    if (visits_left_ < count) v.fail(405, "more values to look at than the file justifies");
    visits_left_ -= count;
  }
  void visit(const PickleValue& v) {
    spend_visits(v);
    if (path_.size() > deepest || depth_ > 4 * deepest) return skip("a value that is nested too deeply", "");
    ++depth_;
    visit_kind(v);
    --depth_;
  }
  void visit_kind(const PickleValue& v) {
    switch (v.kind()) {
      case PickleKind::boolean:
        return torch_->format() == "TorchScript" ? void() : add_value(v.boolean());
      case PickleKind::integer:
        return add_value(v.integer());
      case PickleKind::real:
        return add_value(v.real());
      case PickleKind::text:
      case PickleKind::bytes:
        return add_text(v.text());
      case PickleKind::list:
      case PickleKind::tuple:
        return visit_list(v);
      case PickleKind::dict:
        return visit_entries(v);
      case PickleKind::object:
        return visit_object(v);
      default:
        return;
    }
  }
  void visit_at(std::string_view key, const PickleValue& v) {
    path_.push_back(key);
    visit(v);
    path_.pop_back();
  }
  void visit_entries(const PickleValue& v) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      const PickleValue key = v.key(i);
      if (key.is(PickleKind::text) || key.is(PickleKind::bytes))
        visit_at(key.text(), v.value(i));
      else if (key.is(PickleKind::integer))
        visit_at(concat_text(key.integer()), v.value(i));
      else
        skip(concat_text("an entry whose key is ", key.kind()), "");
    }
  }
  void visit_list(const PickleValue& v) {
    if (separator_ == '/' && add_numbers(v)) return;
    for (std::size_t i = 0; i < v.size(); ++i) visit_at(concat_text(i), v[i]);
  }

  /// Entry of a dictionary that many objects may share.
  std::optional<PickleValue> find_counted(const PickleValue& dict, std::string_view key) {
    spend_visits(dict, dict.size() / 8);
    return dict.find(key);
  }
  /// What an object of omegaconf stands for, or of a class that is made like it.
  std::optional<PickleValue> content(const PickleValue& state) {
    const auto inner = find_counted(state, "_content");
    return inner ? inner : find_counted(state, "_val");
  }

  void visit_object(const PickleValue& v) {
    const std::string name = v.name();
    spend_visits(v, name.size() / 256);
    const auto state = v.has_state() && v.state().is(PickleKind::dict) ? std::optional(v.state()) : std::nullopt;
    if (TorchFile::is_tensor(v)) {
      if (selected()) attempt(name, [&] { add_tensor(torch_->tensor(v)); });
    } else if (is_numpy_scalar(v)) {
      attempt(name, [&] { add_number(to_array(v)); });
    } else if (is_numpy_array(v)) {
      joblib_ = joblib_ || is_joblib_array(v);
      attempt(name, [&] { add_array(pickled_array(v), is_joblib_array(v)); });
    } else if (name.starts_with("chumpy.") || name.starts_with("scipy.sparse.")) {
      if (selected()) attempt(name, [&] { add_copy(to_array(v)); });
    } else if (const auto inner = name.starts_with("omegaconf.") && state ? content(*state) : std::nullopt) {
      visit(*inner);
    } else if (name.starts_with("pathlib.")) {
      add_path(v.arguments());
    } else if (name == "torch.Size" || name == "torch.device") {
      if (v.arguments().size() > 0) visit(v.arguments()[0]);
    } else if (state && (name.starts_with("__torch__.") || name == "argparse.Namespace")) {
      visit_entries(*state);
    } else if (v.size() > 0) {  // of a class that behaves like a list or a dictionary
      v.keyed() ? visit_entries(v) : visit_list(v);
      visit_unknown(v);
    } else {
      if (unknown_.empty()) skip(name, "an object of class ");
      visit_unknown(v);
    }
  }

  /// The fields of an object whose class nobody knows, as values. Its tensors are passed over: the class may mean
  /// anything by them. Objects may share others and lead back to themselves, so each is looked into a few times at
  /// most, and all of them together leave enough visits for what is known.
  void visit_unknown(const PickleValue& v) {
    constexpr int most_looks = 4;
    const bool inside = std::find(unknown_.begin(), unknown_.end(), v.id()) != unknown_.end();
    if (inside || looks_.size() >= most_values || out_.values_.size() >= most_values) return;
    if (++looks_[v.id()] > most_looks) return;
    const std::uint64_t kept = unknown_.empty() ? std::min(visits_left_, visits_for_known_) : 0;
    visits_left_ -= kept;
    unknown_.push_back(v.id());
    const std::size_t keys = path_.size(), depth = depth_;
    guard<io_error>([&] { visit_fields(v); }, [](const io_error&) { return true; });
    path_.resize(keys);  // where there were too many
    depth_ = depth;
    unknown_.pop_back();
    visits_left_ += kept;
  }
  /// Fields are the entries of dictionaries: of the state, of several in the state (attributes and slots, the keywords
  /// of functools.partial), and among the arguments of the call that made the object. An object that was made from one
  /// other value only stands for that value, as an Enum does.
  void visit_fields(const PickleValue& v) {
    constexpr std::size_t most_dictionaries = 8;
    std::vector<PickleValue> fields;
    const auto add = [&](const PickleValue& from) {
      spend_visits(v, from.size() / 8);
      if (from.keyed()) return fields.push_back(from);
      for (std::size_t i = 0; i < from.size() && fields.size() < most_dictionaries; ++i) {
        if (from[i].keyed()) fields.push_back(from[i]);
      }
    };
    add(v.arguments());
    if (v.has_state()) add(v.state());
    for (const PickleValue& f : fields) {
      if (const auto inner = content(f)) return visit(*inner);
    }
    std::vector<PickleValue> visited;
    if (v.keyed()) visited.push_back(v);
    for (const PickleValue& f : fields) {
      if (std::none_of(visited.begin(), visited.end(),
                       [&](const PickleValue& other) { return have_same_keys(f, other); }))
        visit_entries(f);
      visited.push_back(f);
    }
    const bool alone = visited.empty() && v.size() == 0 && !v.has_state() && v.arguments().size() == 1;
    if (alone) visit(v.arguments()[0]);
  }
  /// Compares the number of keys and the first one: some classes keep their entries as attributes, too.
  static bool have_same_keys(const PickleValue& a, const PickleValue& b) {
    return a.size() == b.size() && a.size() > 0 && a.key(0).is(PickleKind::text) && b.find(a.key(0).text());
  }

  // What was found.

  /// Runs `read`; what is not supported is passed over, and so is whatever is wrong where no tensors are wanted.
  template <class F>
  void attempt(const std::string& name, F read) {
    constexpr std::uint64_t visits_of_a_failure = 50;
    guard<io_error>(read, [&](const io_error& e) {
      visits_left_ -= std::min(visits_left_, visits_of_a_failure);
      if (selected() && (e.id() != 404 || options_.strict)) return false;
      skip(name, "");
      return true;
    });
  }
  void skip(const std::string& name, const char* what) {
    if (options_.strict && selected())
      raise<io_error>(404, out_.name(), ": ", what, name, " at '", joined(0, '/'), "'");
    if (out_.skipped_.size() >= most_skipped) return;
    memory_.spend(3 * sizeof(SkippedValue) + name.size());
    out_.skipped_.push_back({joined(0, '/'), name});
  }

  std::string joined(std::size_t first, char separator) const {
    std::size_t size = 0;
    for (std::size_t i = first; i < path_.size(); ++i) size += path_[i].size() + 1;
    memory_.spend(size);
    std::string out;
    out.reserve(size);
    for (std::size_t i = first; i < path_.size(); ++i) {
      if (i > first) out += separator;
      out += path_[i];
    }
    return out;
  }

  template <class T>
  void add_value(T value) {
    if (out_.values_.size() >= most_values) return;
    memory_.spend(3 * sizeof(FileValue));
    out_.values_.push_back({joined(0, '/'), std::move(value)});
  }
  void add_text(std::string_view text) {
    if (out_.values_.size() >= most_values || !is_utf8(text) || text.find('\0') != std::string_view::npos) return;
    memory_.spend(text.size());
    add_value(std::string(text));
  }
  void add_path(const PickleValue& parts) {
    std::string out;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string_view part = parts[i].text();
      memory_.spend(2 * part.size());
      out += concat_text(i > 0 && out != "/" ? "/" : "", part);
    }
    add_text(out);
  }
  void add_number(const NpyArray& a) {
    if (a.is_text()) return add_text(a.text());
    if (a.kind == 'f') return add_value(a.value<double>());
    if (a.kind == 'b') return add_value(a.value<int>() != 0);
    add_value(a.value<std::int64_t>());
  }

  void add_tensor(TensorView view) {
    memory_.spend(3 * sizeof(TensorView) + static_cast<std::size_t>(view.shape.rank()) * sizeof(Index));
    view.name = joined(selection_.size(), separator_);
    if (view.name.empty()) view.name = "array";
    out_.tensors_.push_back(std::move(view));
  }
  /// Elements of an array as a tensor.
  void add_elements(char kind, std::size_t size, const std::vector<Index>& shape, std::span<const std::byte> bytes) {
    if (shape.size() > FileShape::max_rank)
      raise<io_error>(404, out_.name(), ": an array with ", counted(shape.size(), "axis", "axes"));
    DType dtype = kind == 'b' ? DType::BOOL : DType::F16;
    if (kind != 'b' && !(kind == 'f' && size == 2)) {
      with_npy_number(kind, size, [&](auto number) {
        if constexpr (std::is_arithmetic_v<decltype(number)>) dtype = motionlang::dtype_of<decltype(number)>();
      });
    }
    add_tensor({.name = {}, .dtype = dtype, .shape = FileShape(std::span<const Index>(shape)), .bytes = bytes});
  }
  void add_copy(NpyArray array) {
    memory_.spend(array.data.size() + array.place.size());
    const NpyArray& kept = memory_.keep(std::move(array));
    add_elements(kept.kind, kept.item_size, kept.shape, kept.data);
  }
  /// lasting   the bytes live as long as the file
  void add_array(const PickledArray& a, bool lasting) {
    const NpyArray described = described_array(a.type, a.shape, a.where);
    check_raw_size(described, a.raw.size(), a.where);
    if (described.is_text()) return add_texts(described, a);
    if (!selected()) return;
    const bool in_order = !a.fortran_order || a.shape.size() < 2;
    if (lasting && in_order && (a.type[0] != '>' || described.item_size == 1)) {
      return add_elements(described.kind, described.item_size, a.shape, a.raw);
    }
    if (a.raw.size() > memory_.left()) memory_.spend(a.raw.size());
    add_copy(stored_array(a.type, a.fortran_order, a.shape, a.raw, a.where));
  }
  void add_texts(const NpyArray& described, const PickledArray& a) {
    const auto count = static_cast<std::size_t>(described.count());
    if (count > most_texts) return skip(described.type(), "texts of type ");
    memory_.spend(2 * a.raw.size());
    const auto texts = stored_array(a.type, a.fortran_order, a.shape, a.raw, a.where).texts();
    if (a.shape.empty()) return add_text(texts.front());
    for (std::size_t i = 0; i < count; ++i) {
      const std::string index = concat_text(i);
      path_.push_back(index);
      add_text(texts[i]);
      path_.pop_back();
    }
  }
  void add_npy(std::span<const std::byte> bytes, const std::string& file) {
    const NpyParts npy = npy_parts(bytes, file);
    add_array({npy.header.descr, npy.header.fortran_order, npy.header.shape, npy.raw, npy.where}, true);
  }
  /// A list of nothing but numbers, as a tensor; false if it is none.
  bool add_numbers(const PickleValue& list) {
    bool real = false;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!list[i].is(PickleKind::integer) && !list[i].is(PickleKind::real)) return false;
      real = real || list[i].is(PickleKind::real);
    }
    if (list.size() == 0 || !selected()) return false;
    memory_.spend(2 * sizeof(double) * list.size());
    const auto copy = [&]<class T>(std::vector<T> numbers) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        if constexpr (std::integral<T>)
          numbers.push_back(list[i].integer());
        else
          numbers.push_back(list[i].real());
      }
      add_copy(NpyArray::of(std::span<const T>(numbers), {std::ssize(numbers)}));
    };
    real ? copy(std::vector<double>()) : copy(std::vector<std::int64_t>());
    return true;
  }

  WeightFile& out_;
  TensorMemory& memory_;
  const WeightOptions& options_;
  const TorchFile* torch_ = nullptr;
  char separator_ = '/';
  std::vector<std::string> selection_;
  std::vector<std::string_view> path_;  // keys from the root to the value that is looked at
  std::uint64_t visits_left_, visits_for_known_;
  std::vector<std::uint32_t> unknown_;              // objects around the value whose classes nobody knows
  std::unordered_map<std::uint32_t, int> looks_{};  // how often such objects were looked into
  std::size_t depth_ = 0;  // values around the one that is looked at; objects that stand for another one add no key
  bool joblib_ = false;
};

/// joblib writes compressed dumps as one zlib stream (RFC 1950).
inline bool is_zlib(std::span<const std::byte> bytes) {
  if (bytes.size() < 6) return false;
  const auto first = std::to_integer<unsigned>(bytes[0]), second = std::to_integer<unsigned>(bytes[1]);
  return first == 0x78 && (first * 256 + second) % 31 == 0;
}

MOTIONLANG_BODY std::vector<std::byte> from_zlib(std::span<const std::byte> bytes, std::size_t limit,
                                                 const std::string& name) {
  ByteCount size;
  inflate_to(size, bytes.subspan(2), limit, name);
  Inflated unpacked = inflate(bytes.subspan(2), limit, name, size.bytes);
  const auto said = __builtin_bswap32(load<std::uint32_t>(bytes, 2 + unpacked.consumed, name, "a checksum"));
  if (const std::uint32_t sum = adler32(unpacked.data); sum != said)
    raise<io_error>(403, name, ": checksum ", sum, ", the file says ", said);
  return std::move(unpacked.data);
}

/// Throws as gunzip, and io_error 405 if the file declares more than `limit` bytes.
inline std::vector<std::byte> from_gzip(std::span<const std::byte> bytes, std::size_t limit, const std::string& name) {
  const auto size = load<std::uint32_t>(bytes, bytes.size() - std::min<std::size_t>(bytes.size(), 4), name, "a size");
  if (size > limit) raise<io_error>(405, name, ": declares ", counted(size, "byte"), ", may give ", limit);
  return gunzip_bytes(bytes, name);
}

/// What packed the bytes, if it is something that is not unpacked here; else empty.
inline std::string_view unread_packing(std::string_view text) {
  using namespace std::string_view_literals;
  constexpr std::pair<std::string_view, std::string_view> marks[] = {{"BZh"sv, "bzip2"},
                                                                     {"\xFD"
                                                                      "7zXZ\0"sv,
                                                                      "xz"},
                                                                     {"\x5D\0\0"sv, "lzma"},
                                                                     {"\x04\x22\x4D\x18"sv, "lz4"},
                                                                     {"\x28\xB5\x2F\xFD"sv, "zstd"}};
  for (const auto& [mark, name] : marks) {
    if (text.starts_with(mark)) return name;
  }
  return "";
}

/// Whether bytes begin with the length of a header that they can hold, and with its brace.
inline bool is_safetensors(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  return text.size() > 8 && text[8] == '{' && load<std::uint64_t>(bytes, 0, "", "") <= text.size() - 8;
}

/// Whether the first number is the length of a header that the file holds, and which is no longer than one may be.
inline bool has_header_length(std::span<const std::byte> bytes) {
  if (bytes.size() < sizeof(std::uint64_t)) return false;
  const auto length = load<std::uint64_t>(bytes, 0, "", "");
  return length <= SafetensorsFile::max_header && length <= bytes.size() - sizeof length;
}

/// Whether bytes begin like a file of weights in a binary format, or with a zero byte in them, which no text has.
inline bool begins_weights(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  // a wrong length
  const bool damaged = text.size() > 8 && text[8] == '{' && (text[7] == '\0' || !is_utf8(text.substr(0, 8)));
  return is_safetensors(bytes) || damaged || text.starts_with("PK\x03\x04") || text.starts_with("\x93NUMPY") ||
         text.starts_with('\x80') || is_zlib(bytes) || is_gzip(bytes) || text.substr(0, 4096).find('\0') != text.npos;
}

/// Whether the bytes can begin a pickle: its protocol, or in protocols 0 and 1 an opcode that makes a container or a
/// name.
inline bool begins_pickle(std::string_view text) {
  if (text.empty()) return false;
  if (text[0] == '\x80') return text.size() > 1 && text[1] >= 1 && text[1] <= 5;
  return std::string_view("(c]}").find(text[0]) != std::string_view::npos;
}

}  // namespace detail

MOTIONLANG_BODY WeightFile WeightFile::from_safetensors(const SafetensorsFile& file) {
  WeightFile out(file.name(), file.owner(), "safetensors");
  out.tensors_.assign(file.tensors().begin(), file.tensors().end());
  for (const auto& [key, text] : file.metadata()) out.values_.push_back({key, text});
  return out;
}

MOTIONLANG_BODY WeightFile WeightFile::from_bytes(std::span<const std::byte> bytes, std::string name,
                                                  std::shared_ptr<const void> owner, const WeightOptions& options) {
  const std::string_view text = detail::as_text(bytes);
  constexpr std::size_t safetensors_start = 8;
  const auto refuse_keys = [&](const char* format) {
    if (options.path && !options.path->empty())
      raise<io_error>(406, name, ": no entry '", *options.path, "': ", format, " has no dictionaries");
  };
  const bool brace = text.size() > safetensors_start && text[safetensors_start] == '{';
  const bool by_chance = detail::is_zlib(bytes) && !detail::is_safetensors(bytes);  // packed bytes may be a brace
  if (brace && !by_chance) {
    refuse_keys("safetensors");
    return from_safetensors(SafetensorsFile::from_bytes(bytes, std::move(name), std::move(owner)));
  }
  const auto memory = std::make_shared<TensorMemory>(std::move(owner), bytes.size(), name);
  WeightFile out(name, memory, "");
  detail::WeightReader reader(out, *memory, options, bytes.size());
  const auto read_torch = [&](const TorchFile& file) {
    out.format_ = file.format();
    reader.read(file);
    if (out.tensors_.empty() && !out.skipped_.empty())
      raise<io_error>(406, name, ": no tensors that can be read in this ", out.format_,
                      "; skipped: ", to_string(out.skipped_.front()),
                      " (of a whole module or model, save its state_dict())");
    if (out.tensors_.empty()) raise<io_error>(406, name, ": no tensors in this ", out.format_);
    if (file.bytes_behind() > 0)
      out.skipped_.push_back({"", concat_text(counted(file.bytes_behind(), "byte"), " behind the end of data.pkl")});
  };
  if (text.starts_with("PK\x03\x04")) {
    const ZipArchive zip(bytes, name);
    if (!TorchFile::root_folder(zip).empty()) {
      read_torch(TorchFile::from_archive(zip, memory, options.checksums));
    } else {
      const NpzArchive npz(zip);
      if (npz.names().empty())
        raise<io_error>(403, name, ": a zip archive without data.pkl (PyTorch) and .npy (NumPy)");
      refuse_keys("npz");
      out.format_ = "npz";
      memory->allow(bytes.size() + (std::uint64_t{28} << 20));  // what a pickle would need
      reader.read(npz, zip);
    }
  } else if (TorchFile::is_legacy(bytes)) {
    read_torch(TorchFile::from_legacy(bytes, name, memory));
  } else if (text.starts_with("\x93NUMPY")) {
    refuse_keys("npy");
    out.format_ = "npy";
    reader.read_npy(bytes);
  } else if (text.size() > 262 && text.substr(257, 5) == "ustar") {
    raise<io_error>(404, name, ": a tar archive, as PyTorch wrote them before 0.1.10");
  } else if (const auto packed = detail::unread_packing(text); !packed.empty()) {
    raise<io_error>(404, name, ": packed with ", packed, ", which is not read: unpack it first");
  } else if (detail::is_zlib(bytes) || is_gzip(bytes)) {
    // What any pickle may need for its values; with it, and 10 MiB that are not counted, twice the size and 64 MiB.
    constexpr std::uint64_t values = std::uint64_t{24} << 20;
    memory->allow(bytes.size() + (std::uint64_t{18} << 20));
    const std::vector<std::byte>& unpacked =
        memory->keep(is_gzip(bytes) ? detail::from_gzip(bytes, memory->left(), name)
                                    : detail::from_zlib(bytes, memory->left(), name));
    memory->spend(unpacked.size());
    const std::uint64_t most = values + std::min<std::uint64_t>(bytes.size(), memory->left());
    Pickle pickle(unpacked, name, {.max_memory = most, .inline_bytes = joblib_array_bytes});
    memory->spend(std::max(values, most - pickle.memory_left()) - values);
    read_torch(TorchFile::from_pickle(std::move(pickle), memory));
  } else if (detail::begins_pickle(text)) {
    Pickle pickle(bytes, name, {.inline_bytes = joblib_array_bytes});
    // of 8 bytes, or more
    const bool number = pickle.root().is(PickleKind::integer) || pickle.root().is(PickleKind::bytes);
    if (number && pickle.end() < bytes.size() && bytes[static_cast<std::size_t>(pickle.end())] == std::byte{0x80})
      pickle.root().fail(404, "not the magic number of PyTorch's older files, although pickles follow it,");
    read_torch(TorchFile::from_pickle(std::move(pickle), memory));
  } else if (detail::has_header_length(bytes)) {
    refuse_keys("safetensors");
    return from_safetensors(SafetensorsFile::from_bytes(bytes, std::move(name), std::move(owner)));
  } else if (text.size() < safetensors_start) {
    raise<io_error>(402, name, ": ", counted(text.size(), "byte is", "bytes are"), " no file of weights of any kind");
  } else {
    raise<io_error>(404, name, ": not a file of weights: neither safetensors, PyTorch, NumPy, nor a pickle");
  }
  out.sort_tensors();
  return out;
}

MOTIONLANG_BODY void WeightFile::add(const WeightFile& file, const std::string& prefix,
                                     std::vector<std::shared_ptr<const void>>& owners) {
  owners.push_back(file.owner());
  files_.insert(files_.end(), file.files_.begin(), file.files_.end());
  for (TensorView t : file.tensors()) {
    if (!prefix.empty()) t.name = t.name == "array" ? prefix : prefix + "." + t.name;
    tensors_.push_back(std::move(t));
  }
  for (const FileValue& v : file.values())
    values_.push_back({prefix.empty() ? v.path : prefix + "/" + v.path, v.value});
  for (const SkippedValue& v : file.skipped())
    skipped_.push_back({prefix.empty() ? v.path : prefix + "/" + v.path, v.type});
}

/// The files that "weight_map" of an index.json names, each with the tensors that are said to be in it.
MOTIONLANG_BODY WeightFile WeightFile::from_shards(const FilePath& index, const WeightOptions& options) {
  const auto document = read_json(index);
  const auto map = JsonView(document, index.string())["weight_map"].as<std::map<std::string, std::string>>();
  if (map.empty()) raise<io_error>(406, index.string(), ": weight_map names no tensors");
  const auto owners = std::make_shared<std::vector<std::shared_ptr<const void>>>();
  WeightFile out(index.string(), owners, "shards");
  std::map<std::string, std::vector<std::string>> files;
  for (const auto& [tensor, file] : map) files[file].push_back(tensor);
  const auto folder = std::filesystem::path(index.string()).parent_path();
  out.files_.emplace_back(index.string());
  for (const auto& [name, tensors] : files) {
    if (name.empty() || name == ".." || name.find_first_of(std::string_view("/\\\0", 3)) != name.npos)
      raise<io_error>(403, index.string(), ": '", name, "' is no name of a file in the same folder");
    const auto bytes = MappedFile::open(folder / name);
    const WeightFile shard = from_bytes(bytes->bytes(), (folder / name).string(), bytes, options);
    owners->push_back(shard.owner());
    out.files_.push_back(folder / name);
    for (const std::string& tensor : tensors) out.tensors_.push_back(shard.tensor(tensor));
    out.skipped_.insert(out.skipped_.end(), shard.skipped().begin(), shard.skipped().end());
  }
  out.sort_tensors();
  return out;
}

/// The files of a training run: its weights under their own names, parts and statistics (TMR's
/// last_weights/motion_encoder.pt, stats/mean.pt) behind the name of the part: "motion_encoder.tokens", "stats.mean".
MOTIONLANG_BODY WeightFile WeightFile::from_run(const RunFolder& run, const WeightOptions& options) {
  if (run.weights.empty() && run.parts.empty())
    raise<io_error>(404, run.folder.string(), ": no weights in this folder (.pt, .ckpt, .tar, .safetensors)");
  if (run.parts.empty() && (run.system.empty() || run.system == "motionlang" || run.system == "hugging face"))
    return open_weights(run.weights, options);
  std::string format = "folder";
  for (const auto& [system, name] : {std::pair<std::string_view, const char*>{"stmc", "STMC run folder"},
                                     {"tmr", "TMR run folder"},
                                     {"mdm", "MDM run folder"},
                                     {"actor", "ACTOR run folder"},
                                     {"temos", "TEMOS run folder"},
                                     {"motiondiffuse", "MotionDiffuse run folder"},
                                     {"tm2t", "TM2T run folder"}}) {
    if (run.system == system) format = name;
  }
  const auto owners = std::make_shared<std::vector<std::shared_ptr<const void>>>();
  WeightFile out(run.folder.string(), owners, std::move(format));
  if (!run.weights.empty()) out.add(open_weights(run.weights, options), "", *owners);
  const WeightOptions own{.path = run.weights.empty() ? options.path : std::nullopt, .strict = options.strict};
  for (const auto& [part, path] : run.parts) out.add(open_weights(path, own), part, *owners);
  out.sort_tensors();
  return out;
}

MOTIONLANG_BODY bool may_be_weights(const FilePath& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path.string(), ignored) ||
         detail::begins_weights(MappedFile::open(path)->bytes());
}

MOTIONLANG_BODY WeightFile open_weights(const FilePath& path, const WeightOptions& options) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path.string(), ignored)) return WeightFile::from_run(find_run(path), options);
  if (path.string().ends_with(".index.json")) return WeightFile::from_shards(path, options);
  const auto file = MappedFile::open(path);
  WeightFile out = WeightFile::from_bytes(file->bytes(), path.string(), file, options);
  out.files_.emplace_back(path.string());
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The folder around one, also of "a/b/" and ".".
std::filesystem::path folder_around(const std::filesystem::path& folder);

/// Options of a run and shapes of its tensors, compared.
class RunReader {
 public:
  RunReader(const RunFolder& run, const TensorSet& weights, std::string prefix)
      : run_(&run), weights_(&weights), prefix_(std::move(prefix)) {}

  const std::string& prefix() const { return prefix_; }
  bool has(const std::string& name) const { return weights_->find(prefix_ + name) != nullptr; }
  /// Size of a tensor along an axis. Throws io_error 407 if it has no such axis or no numbers.
  Index size(const std::string& name, int axis) const;
  /// The same, where options may state it.
  Index size(const std::string& name, int axis, std::initializer_list<const char*> options) const;
  /// The same for a tensor that may be missing: then an option has to state the size 0.
  Index size_if_any(const std::string& name, int axis, std::initializer_list<const char*> options) const;
  /// How many tensors there are of a numbered name, "layers.#.weight".
  Index count(const std::string& before, const std::string& behind, std::initializer_list<const char*> options) const;

  /// Of several names for an option the first that there is. Throws config_error 101 unless it is smallest ... largest.
  Index number(std::initializer_list<const char*> keys, Index otherwise, Index largest, Index smallest = 1) const;
  double real(const char* key, double otherwise) const;
  bool flag(const char* key, bool otherwise) const;
  std::string text(const char* key, const char* otherwise) const;
  std::string one_of(const char* key, const char* otherwise, std::initializer_list<std::string_view> known) const;
  std::string place(const char* key) const { return concat_text(run_->options_file.string(), ": ", key); }

 private:
  std::optional<Index> whole(const char* key) const;
  [[noreturn]] void wrong_kind(const char* key, const char* wanted, const FileValue& v) const;

  const RunFolder* run_;
  const TensorSet* weights_;
  std::string prefix_;
};

RunReader reader_of(const RunFolder& run, const TensorSet& weights, std::string_view name);

/// Mean and std behind the first of the prefixes that has both; null if none has.
struct Statistics {
  const TensorView *mean = nullptr, *std = nullptr;
};
/// Throws io_error 407 for another width.
Statistics find_statistics(const TensorSet& file, Index width, std::initializer_list<const char*> prefixes);
template <Backend B>
std::optional<Normalizer<B>> find_normalizer(const TensorSet& file, Index width,
                                             std::initializer_list<const char*> prefixes) {
  const Statistics found = find_statistics(file, width, prefixes);
  if (found.mean == nullptr) return std::nullopt;
  using S = typename B::scalar;
  Normalizer<B> out = Normalizer<B>::identity(width);
  out.mean = Tensor<B, 1>::from(values_of<S>(*found.mean), {width});
  out.std = Tensor<B, 1>::from(values_of<S>(*found.std), {width});
  return out;
}

/// The files of statistics of a folder.
WeightFile statistics_of(const RunFolder& run);

[[noreturn]] void raise_no_statistics(const RunFolder& folder, std::string_view missing);

/// Mean and std of a folder. `missing` ends the message "no statistics of ...". Throws io_error 401, 407.
template <Backend B>
Normalizer<B> folder_normalizer(const RunFolder& folder, Index width, std::initializer_list<const char*> prefixes,
                                std::string_view missing) {
  if (!folder.parts.empty()) {
    if (auto found = find_normalizer<B>(statistics_of(folder), width, prefixes)) return *std::move(found);
  }
  raise_no_statistics(folder, missing);
}
/// Those of the motions: of the folder `elsewhere` if one is named, else in weights that are packed, else of the run.
template <Backend B>
Normalizer<B> run_normalizer(const RunFolder& run, const TensorSet& weights, Index width,
                             std::initializer_list<const char*> prefixes, std::string_view missing,
                             const FilePath& elsewhere = "") {
  if (!elsewhere.string().empty()) return folder_normalizer<B>(find_run(elsewhere), width, prefixes, missing);
  if (auto packed = find_normalizer<B>(weights, width, {"motion_normalizer."})) return *std::move(packed);
  return folder_normalizer<B>(run, width, prefixes, missing);
}

/// Fills a module. `beside(name)`: tensors that the file may hold besides.
template <Module M, class F>
void load_run_module(M& module, const TensorSet& file, const std::string& prefix, F beside,
                     LoadFor use = LoadFor::any_use) {
  KeyReport report = load_module_partly(module, file, prefix, use);
  std::erase_if(report.unexpected, beside);
  if (!report.missing.empty() || !report.unexpected.empty()) raise_key_mismatch(file.name(), report);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_DETAIL_RUN_READER_IPP  // <motionlang/weights/detail/run_reader.ipp>
#define MOTIONLANG_HAS_WEIGHTS_DETAIL_RUN_READER_IPP
// Bodies of run_reader.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::filesystem::path folder_around(const std::filesystem::path& folder) {
  auto own = folder.lexically_normal();
  if (!own.has_filename()) own = own.parent_path();
  return own == "." || own.filename() == ".." ? own / ".." : own.parent_path();
}

MOTIONLANG_BODY Index RunReader::size(const std::string& name, int axis) const {
  const TensorView& t = weights_->tensor(prefix_ + name);
  if (axis >= t.shape.rank() || t.shape.count() < 1)
    raise<io_error>(407, weights_->name(), ": tensor '", t.name, "' is ", t.shape);
  return t.shape[axis];
}

MOTIONLANG_BODY Index RunReader::size(const std::string& name, int axis,
                                      std::initializer_list<const char*> options) const {
  const Index found = size(name, axis);
  for (const char* key : options) {
    const std::optional<Index> stated = whole(key);
    if (stated && *stated != found)
      raise<config_error>(102, place(key), " is ", *stated, ", tensor '", prefix_, name, "' in ", weights_->name(),
                          " is ", weights_->tensor(prefix_ + name).shape);
  }
  return found;
}

MOTIONLANG_BODY Index RunReader::size_if_any(const std::string& name, int axis,
                                             std::initializer_list<const char*> options) const {
  const bool none =
      !has(name) && std::any_of(options.begin(), options.end(), [&](const char* key) { return whole(key) == 0; });
  return none ? 0 : size(name, axis, options);
}

MOTIONLANG_BODY Index RunReader::count(const std::string& before, const std::string& behind,
                                       std::initializer_list<const char*> options) const {
  Index n = 0;
  while (has(concat_text(before, n, behind))) ++n;
  for (const char* key : options) {
    if (const auto stated = whole(key); stated && *stated != n)
      raise<config_error>(102, place(key), " is ", *stated, ", ", weights_->name(), " has ", n, " of '", prefix_,
                          before, "#", behind, "'");
  }
  if (n == 0) weights_->tensor(concat_text(prefix_, before, 0, behind));  // throws
  return n;
}

MOTIONLANG_BODY Index RunReader::number(std::initializer_list<const char*> keys, Index otherwise, Index largest,
                                        Index smallest) const {
  for (const char* key : keys) {
    const std::optional<Index> n = whole(key);
    if (!n) continue;
    if (*n < smallest || *n > largest)
      raise<config_error>(101, place(key), " is ", *n, ", not ", smallest, " ... ", largest);
    return *n;
  }
  return otherwise;
}

MOTIONLANG_BODY double RunReader::real(const char* key, double otherwise) const {
  const FileValue* v = run_->option(key);
  if (v == nullptr) return otherwise;
  if (const auto* d = std::get_if<double>(&v->value)) return *d;
  if (const auto* n = std::get_if<std::int64_t>(&v->value)) return static_cast<double>(*n);
  wrong_kind(key, "a number", *v);
}

MOTIONLANG_BODY bool RunReader::flag(const char* key, bool otherwise) const {
  const FileValue* v = run_->option(key);
  if (v == nullptr) return otherwise;
  if (const auto* b = std::get_if<bool>(&v->value)) return *b;
  wrong_kind(key, "true or false", *v);
}

MOTIONLANG_BODY std::string RunReader::text(const char* key, const char* otherwise) const {
  const FileValue* v = run_->option(key);
  return v == nullptr ? otherwise : to_string(*v);
}

MOTIONLANG_BODY std::string RunReader::one_of(const char* key, const char* otherwise,
                                              std::initializer_list<std::string_view> known) const {
  std::string found = text(key, otherwise);
  if (std::find(known.begin(), known.end(), found) != known.end()) return found;
  raise<io_error>(404, place(key), " is '", found, "', known are ", join_text(known));
}

MOTIONLANG_BODY std::optional<Index> RunReader::whole(const char* key) const {
  const FileValue* v = run_->option(key);
  if (v == nullptr) return std::nullopt;
  if (const auto* n = std::get_if<std::int64_t>(&v->value)) return static_cast<Index>(*n);
  if (const auto* d = std::get_if<double>(&v->value); d != nullptr && std::abs(*d) < 1e9 && *d == std::trunc(*d))
    return static_cast<Index>(*d);
  wrong_kind(key, "a whole number", *v);
}

MOTIONLANG_BODY void RunReader::wrong_kind(const char* key, const char* wanted, const FileValue& v) const {
  raise<config_error>(107, place(key), " is '", to_string(v), "', not ", wanted);
}

MOTIONLANG_BODY RunReader reader_of(const RunFolder& run, const TensorSet& weights, std::string_view name) {
  const auto prefix = prefix_of(weights, name);
  if (!prefix) raise<io_error>(406, weights.name(), ": no tensor '", name, "', with or without a prefix");
  return RunReader(run, weights, *prefix);
}

MOTIONLANG_BODY WeightFile statistics_of(const RunFolder& run) {
  RunFolder only = run;
  only.weights.clear();
  only.system.clear();
  return WeightFile::from_run(only);
}

MOTIONLANG_BODY Statistics find_statistics(const TensorSet& file, Index width,
                                           std::initializer_list<const char*> prefixes) {
  for (const std::string prefix : prefixes) {
    const TensorView *mean = file.find(prefix + "mean"), *std = file.find(prefix + "std");
    if (mean == nullptr || std == nullptr) continue;
    for (const TensorView* t : {mean, std}) {
      if (t->shape.count() != width)
        raise<io_error>(407, file.name(), ": tensor '", t->name, "' is ", t->shape, ", the model has ",
                        counted(width, "feature"));
    }
    return {mean, std};
  }
  return {};
}

MOTIONLANG_BODY void raise_no_statistics(const RunFolder& folder, std::string_view missing) {
  raise<io_error>(401, folder.folder.string(), ": no statistics of ", missing);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

ActorConfig actor_config(const RunReader& r);
GruClassifierConfig gru_classifier_config(const TensorSet& file);
StGcnConfig stgcn_config(const TensorSet& file);

}  // namespace detail

/// Frames of the longest motions that a run learned from: num_frames. Where that is -1 (whole clips) or -2 (windows of
/// any length) it is max_len, and where this is -1 as well what the table of positions has room for, beside two tokens.
/// Spec actor.md 6.3
Index actor_longest(const RunFolder& run, const TensorSet& weights, const ActorConfig& config);

/// How a run chose frames of a clip: sampling and sampling_step.
ActorFrameOptions actor_frame_options(const RunFolder& run, const TensorSet& weights);

/// The points of a body that the loss of a run compares: jointstype. Throws config_error 103.
inline ActorPoints actor_loss_points(const RunFolder& run, const TensorSet& weights) {
  return parse_actor_points(detail::RunReader(run, weights, "").text("jointstype", "vertices"));
}

/// How a run writes motions, for `actor_points`.
ActorPointOptions actor_point_options(const RunFolder& run, const TensorSet& weights);

/// `run` has the options, if there are any.
template <Backend B>
Actor<B> load_actor(const TensorSet& file, const RunFolder& run = {}) {
  const ActorConfig config = detail::actor_config(detail::RunReader(run, file, ""));
  const auto room = detail::room_of(file);
  NoInit zeros;
  Actor<B> model(config, zeros);
  detail::load_run_module(model, file, "", [](const std::string& name) {
    return name.ends_with(".pe") || name.starts_with("rotation2xyz.");
  });
  return model;
}

/// The tensors are in the file's entry "model", which open_weights finds.
template <Backend B>
GruClassifier<B> load_gru_classifier(const TensorSet& file) {
  const GruClassifierConfig config = detail::gru_classifier_config(file);
  const auto room = detail::room_of(file);
  NoInit zeros;
  GruClassifier<B> model(config, zeros);
  load_module(model, file);
  return model;
}

/// The graph is that of the file. A block that has a convolution past it halves the frames, as published.
template <Backend B>
StGcn<B> load_stgcn(const TensorSet& file) {
  const StGcnConfig config = detail::stgcn_config(file);
  const auto room = detail::room_of(file);
  NoInit zeros;
  StGcn<B> model(config, zeros);
  load_module(model, file);
  return model;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_ACTOR_FILE_IPP  // <motionlang/weights/actor_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_ACTOR_FILE_IPP
// Bodies of actor_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The repository's name for a pair of networks; empty for a pair that it does not have.
inline std::string_view actor_archiname(const ActorConfig& c) {
  const bool transformer = c.encoder == ActorEncoderKind::tokens || c.encoder == ActorEncoderKind::average;
  switch (c.decoder) {
    case ActorDecoderKind::transformer:
      return transformer ? "transformer" : c.encoder == ActorEncoderKind::gru ? "grutrans" : "";
    case ActorDecoderKind::gru:
      return transformer ? "transgru" : c.encoder == ActorEncoderKind::gru ? "gru" : "";
    case ActorDecoderKind::fully_connected:
      return c.encoder == ActorEncoderKind::fully_connected ? "fc" : "";
    default:
      return transformer ? "autotrans" : "";
  }
}

MOTIONLANG_BODY ActorConfig actor_config(const RunReader& r) {
  if (r.text("pose_rep", "rot6d") == "xyz")
    raise<io_error>(404, r.place("pose_rep"), " is xyz: models of positions are not supported");
  const std::string e = "encoder.", d = "decoder.", linear1 = ".layers.0.linear1.weight";
  ActorConfig c{.nfeats = size(parse_pose_representation(r.text("pose_rep", "rot6d"))),
                .num_heads = r.number({"num_heads"}, 4, 1024),
                .activation = parse_activation(r.one_of("activation", "gelu", {"gelu", "relu"}))};
  if (r.has(e + "muQuery")) {
    c.latent_dim = r.size(e + "muQuery", 1, {"latent_dim"});
  } else if (r.has(e + "mu_layer.weight")) {
    c.encoder = ActorEncoderKind::average;
    c.latent_dim = r.size(e + "mu_layer.weight", 0, {"latent_dim"});
  } else {
    c.encoder = r.has(e + "gru.weight_ih_l0") ? ActorEncoderKind::gru : ActorEncoderKind::fully_connected;
    c.latent_dim = r.size(e + "mu.weight", 0, {"latent_dim"});
  }
  Index features = 0;
  if (r.has(d + "finallayer.weight")) {
    const std::string ablation =
        r.one_of("ablation", "", {"", "average_encoder", "zandtime", "concat_bias", "time_encoding"});
    const bool one_hot = r.has(d + "ztimelinear.weight");
    if ((ablation == "zandtime" && !one_hot) ||
        (ablation == "average_encoder" && c.encoder != ActorEncoderKind::average))
      raise<config_error>(102, r.place("ablation"), " is '", ablation, "', which the tensors are not of");
    features = r.size(d + "finallayer.weight", 0);
    c.num_classes = one_hot ? r.size(d + "ztimelinear.weight", 1) - c.latent_dim : r.size(d + "actionBiases", 0);
    c.conditioning = one_hot                       ? ActorConditioning::zandtime
                     : ablation == "concat_bias"   ? ActorConditioning::concat_bias
                     : ablation == "time_encoding" ? ActorConditioning::time_encoding
                                                   : ActorConditioning::action_bias;
  } else if (r.has(d + "gru.weight_ih_l0")) {
    c.decoder = ActorDecoderKind::gru;
    features = r.size(d + "final_layer.weight", 0);
    c.num_classes = r.size(d + "feats_embedding.weight", 1) - c.latent_dim - 1;
  } else if (r.has(d + "embedding_x.weight")) {
    c.decoder = ActorDecoderKind::autoregressive;
    features = r.size(d + "output_layer.weight", 0);
    c.num_classes = r.size(d + "embedding_x.weight", 1) - features - 1;
  } else {
    c.decoder = ActorDecoderKind::fully_connected;
    c.num_frames = r.number({"num_frames"}, 60, 100'000, 2);
    features = r.size(d + "fully_connected.4.weight", 0) / c.num_frames;
    c.num_classes = r.size(d + "fully_connected.0.weight", 1) - c.latent_dim;
  }
  if (const std::string stated = r.text("archiname", ""); !stated.empty() && stated != actor_archiname(c))
    raise<config_error>(102, r.place("archiname"), " is '", stated, "', the tensors are those of ", actor_archiname(c));
  if (features % c.nfeats != 0)
    raise<config_error>(102, r.place("pose_rep"), ": rotations of ", counted(c.nfeats, "number"), ", frames have ",
                        features);
  c.njoints = features / c.nfeats;
  for (const auto& [before, behind] : {std::pair{e + "seqTransEncoder.layers.", ".linear1.weight"},
                                       {d + "seqTransDecoder.layers.", ".linear1.weight"},
                                       {d + "layers.", ".trg_trg_att.k_layer.weight"},
                                       {e + "gru.weight_ih_l", ""},
                                       {d + "gru.weight_ih_l", ""}}) {
    if (r.has(before + "0" + behind)) c.num_layers = r.count(before, behind, {"num_layers"});
  }
  for (const std::string& name : {e + "seqTransEncoder" + linear1, d + "seqTransDecoder" + linear1,
                                  d + "layers.0.feed_forward.pwff_layer.0.weight"}) {
    if (r.has(name)) c.ff_size = r.size(name, 0, {"ff_size"});
  }
  if (c.num_classes < 1 || c.njoints < 1)
    raise<io_error>(407, "ACTOR: the shapes of its tensors leave ", counted(c.num_classes, "class", "classes"), " and ",
                    counted(c.njoints, "joint"));
  return c;
}

MOTIONLANG_BODY GruClassifierConfig gru_classifier_config(const TensorSet& file) {
  const RunFolder no_options{};
  const RunReader t(no_options, file, "");
  return {.input_size = t.size("recurrent.weight_ih_l0", 1),
          .hidden_size = t.size("recurrent.weight_hh_l0", 1),
          .num_layers = t.count("recurrent.weight_ih_l", "", {}),
          .num_classes = t.size("linear2.weight", 0)};
}

MOTIONLANG_BODY StGcnConfig stgcn_config(const TensorSet& file) {
  const RunFolder no_options{};
  const RunReader t(no_options, file, "");
  auto shape = [&](const std::string& name, int rank) {
    const TensorView& view = file.tensor(name);
    if (view.shape.rank() != rank) raise<io_error>(407, file.name(), ": tensor '", name, "' is ", view.shape);
    return view.shape;
  };
  const FileShape edges = shape("A", 3);
  const Index joints = edges[1], numbers = shape("data_bn.weight", 1)[0];
  if (edges[0] < 1 || edges[2] != joints) raise<io_error>(407, file.name(), ": tensor 'A' is ", edges);
  StGcnConfig c{.in_channels = numbers / std::max<Index>(joints, 1),
                .num_classes = shape("fcn.weight", 4)[0],
                .channels = {},
                .strides = {}};
  c.parents.assign(static_cast<std::size_t>(joints), -1);
  const std::string block = "st_gcn_networks.";
  for (Index i = 0; t.has(concat_text(block, i, ".tcn.2.weight")); ++i) {
    const std::string name = concat_text(block, i);
    c.channels.push_back(shape(name + ".tcn.2.weight", 4)[0]);
    c.strides.push_back(t.has(name + ".residual.0.weight") ? 2 : 1);
  }
  return c;
}

}  // namespace detail

MOTIONLANG_BODY Index actor_longest(const RunFolder& run, const TensorSet& weights, const ActorConfig& config) {
  const detail::RunReader r(run, weights, "");
  const auto frames = [&r](const char* key, Index otherwise, Index least) {
    const Index n = r.number({key}, otherwise, 100'000, least);
    return n < 0 ? n : r.number({key}, otherwise, 100'000, 2);  // 0 and 1 frames are no motion
  };
  const Index stated = frames("num_frames", 60, -2), most = stated < 0 ? frames("max_len", -1, -1) : stated;
  return std::min(most < 0 ? config.max_len : most, config.max_len - 2);
}

MOTIONLANG_BODY ActorFrameOptions actor_frame_options(const RunFolder& run, const TensorSet& weights) {
  const detail::RunReader r(run, weights, "");
  const std::string sampling = r.one_of("sampling", "conseq", {"conseq", "random_conseq", "random"});
  const Index step = r.number({"sampling_step"}, 1, 100'000, -1);
  if (step == 0) raise<config_error>(101, r.place("sampling_step"), " is 0, not -1 or 1 ... 100000");
  return {.random_step = sampling == "random_conseq", .step = step, .scattered = sampling == "random"};
}

MOTIONLANG_BODY ActorPointOptions actor_point_options(const RunFolder& run, const TensorSet& weights) {
  const detail::RunReader r(run, weights, "");
  const Vec3<double> turn = ActorPointOptions{}.global_rotation;
  return {
      .features = {.rotations = parse_pose_representation(r.text("pose_rep", "rot6d")),
                   .translation = r.flag("translation", true),
                   .global = r.flag("glob", true)},
      .translate = r.flag("vertstrans", false),
      .global_rotation = {r.real("glob_rot/0", turn.x), r.real("glob_rot/1", turn.y), r.real("glob_rot/2", turn.z)}};
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_DIFFUSION_FOLDER_HPP  // <motionlang/weights/diffusion_folder.hpp>
#define MOTIONLANG_HAS_WEIGHTS_DIFFUSION_FOLDER_HPP
/// A published diffusion model as a model folder of ours: one file of weights with the statistics, its sizes, its
/// licence.
///
///     pack_diffusion_run<B>(find_run("mdm/humanml_trans_enc_512"), "mdm", {.license = "MIT", .provenance =
///     "github.com/..."}); const auto stmc = load_diffusion_run<B>("mdm");

#ifndef MOTIONLANG_HAS_WEIGHTS_DIFFUSION_RUN_HPP  // <motionlang/weights/diffusion_run.hpp>
#define MOTIONLANG_HAS_WEIGHTS_DIFFUSION_RUN_HPP
/// The published diffusion models from the folders in which their repositories leave them: STMC's MDM-SMPL, MDM,
/// MotionDiffuse. And from model folders of ours that were made of them (weights/diffusion_folder.hpp).
///
///     const auto stmc = load_diffusion_run<B>("models/mdm-smpl_clip_smplrifke_humanml3d", {.text_encoder =
///     "ViT-B-32.pt"});
///     const auto features = stmc.generate(timeline, Philox{.seed = 7});        // (frames, stmc.layout.size)
///
/// Sizes       from the shapes of the tensors; where options state them, too, both have to agree. Number of heads,
///             steps, schedule and representation from the options, else as published
/// Statistics  from the checkpoint (STMC), mean and std beside it (MDM: those of HumanML3D, which are not in its
///             folder)
/// Source      spec mdm.md 2.1, 2.2, 3.5, 3.6, 4.4; stmc.md 6
/// Throws      io_error 401 for a file that is missing, naming it; 404 for variants that are not supported; 406, 407
///             for tensors; config_error 102 where options and tensors differ, 101, 103, 107

#ifndef MOTIONLANG_HAS_WEIGHTS_TEXT_ENCODER_FOLDER_HPP  // <motionlang/weights/text_encoder_folder.hpp>
#define MOTIONLANG_HAS_WEIGHTS_TEXT_ENCODER_FOLDER_HPP
/// Text encoders from the folders and files in which they are published, whatever network is in them.
///
///     const auto clip = load_text_encoder<B>("clip-vit-base-patch32", clip_sentences());       // Hugging Face: a
///     folder
///     const auto same = load_text_encoder<B>("ViT-B-32.pt", clip_sentences());                 // OpenAI: vocabulary
///     beside it
///     const auto words = load_text_encoder<B>("distilbert-base-uncased");                      // the states of all
///     words
///
/// Hugging Face  config.json with model_type clip, clip_text_model, distilbert, bert or mpnet; weights
///               (weights/run_folder.hpp); a tokenizer.json, vocab.txt, or vocab.json with merges.txt
/// OpenAI        a file or a folder with the tensors of CLIP (ViT-B-32.pt), and bpe_simple_vocab_16e6.txt.gz in the
///               same folder

#ifndef MOTIONLANG_HAS_WEIGHTS_TOKENIZER_JSON_HPP  // <motionlang/weights/tokenizer_json.hpp>
#define MOTIONLANG_HAS_WEIGHTS_TOKENIZER_JSON_HPP
/// Tokenizers from the JSON files of Hugging Face: tokenizer.json, tokenizer_config.json, vocab.json. Only the kinds
/// that BERT, MPNet and CLIP have; any other normaliser, splitter or frame is refused by its name, because without it
/// ids would be wrong and look right.
///
///     const AnyTokenizer tokenizer = read_tokenizer("all-mpnet-base-v2");   // a folder
///
/// Source  spec text-encoders.md 9.2, 10

#ifndef MOTIONLANG_HAS_WEIGHTS_TOKENIZER_FILES_HPP  // <motionlang/weights/tokenizer_files.hpp>
#define MOTIONLANG_HAS_WEIGHTS_TOKENIZER_FILES_HPP
/// Vocabularies of tokenizers as plain text: vocab.txt of BERT, merges.txt, bpe_simple_vocab_16e6.txt(.gz) of CLIP. The
/// JSON files are another header, weights/tokenizer_json.hpp.
///
/// Source  spec text-encoders.md 7, 9, 10

MOTIONLANG_NAMESPACE_BEGIN

/// One piece on each line; its id is the number of the line, from 0.
/// Throws io_error 403, with the line, for a piece that is empty, duplicated or not UTF-8
std::vector<std::string> parse_vocabulary(std::string_view text, std::string_view name = "vocab.txt");
/// Throws io_error 401 and as parse_vocabulary.
std::vector<std::string> read_vocabulary(const FilePath& path);

namespace detail {

/// "a b". Throws io_error 403 with the place.
std::pair<std::string, std::string> parse_merge(std::string_view line, std::string_view name, Index number);

}  // namespace detail

/// Two symbols with a blank between on each line, in the order of their rank, up to the first empty line. A line that
/// begins with "#version", or in a text of OpenAI's with "\"bpe_simple_vocab", is a comment.
/// most    further lines are not read
/// Throws  io_error 403, with the line, for a line of another form or a duplicated pair
BytePairMerges parse_merges(std::string_view text, std::string_view name = "merges.txt",
                            std::size_t most = static_cast<std::size_t>(-1));
/// Throws io_error 401 and as parse_merges and gunzip.
BytePairMerges read_merges(const FilePath& path, std::size_t most = static_cast<std::size_t>(-1));

/// Merges of bpe_simple_vocab_16e6.txt that CLIP takes; the file has 262,144.
inline constexpr std::size_t clip_merges = 48894;

/// CLIP's tokenizer from OpenAI's file, packed or not. Throws as read_merges, and as the constructor of ClipTokenizer.
inline ClipTokenizer read_clip_tokenizer(const FilePath& path, const ClipTokenizerOptions& options = {}) {
  return ClipTokenizer(read_merges(path, clip_merges), options, path.string());
}

/// BERT's tokenizer from vocab.txt. Throws as read_vocabulary, and as the constructor of BertTokenizer.
inline BertTokenizer read_bert_tokenizer(const FilePath& path, BertTokenizerOptions options = {}) {
  return BertTokenizer(read_vocabulary(path), std::move(options), path.string());
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_TOKENIZER_FILES_IPP  // <motionlang/weights/tokenizer_files.ipp>
#define MOTIONLANG_HAS_WEIGHTS_TOKENIZER_FILES_IPP
// Bodies of tokenizer_files.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> parse_vocabulary(std::string_view text, std::string_view name) {
  std::vector<std::string> pieces;
  std::unordered_set<std::string_view> seen;
  detail::for_each_line(text, [&](std::string_view piece, Index line) {
    const char* wrong = piece.empty() ? "an empty line" : !is_utf8(piece) ? "not UTF-8" : nullptr;
    if (wrong != nullptr) raise<io_error>(403, name, ":", line, ": ", std::string_view(wrong));
    if (!seen.insert(piece).second) raise<io_error>(403, name, ":", line, ": piece '", piece, "' is duplicated");
    pieces.emplace_back(piece);
  });
  return pieces;
}

namespace detail {

MOTIONLANG_BODY std::pair<std::string, std::string> parse_merge(std::string_view line, std::string_view name,
                                                                Index number) {
  const std::size_t blank = line.find(' ');
  const bool two = blank != line.npos && blank > 0 && blank + 1 < line.size() && line.find(' ', blank + 1) == line.npos;
  if (!two || !is_utf8(line))
    raise<io_error>(403, name, ":", number, ": '", utf8_head(line, 40), "' is not two symbols with one blank between");
  return {std::string(line.substr(0, blank)), std::string(line.substr(blank + 1))};
}

}  // namespace detail

MOTIONLANG_BODY BytePairMerges parse_merges(std::string_view text, std::string_view name, std::size_t most) {
  BytePairMerges merges;
  std::unordered_set<std::string_view> seen;
  bool ended = false;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    ended = ended || line.empty() || merges.size() == most;
    if (ended || line.starts_with("#version") || (number == 1 && line.starts_with("\"bpe_simple_vocab"))) return;
    merges.push_back(detail::parse_merge(line, name, number));
    if (!seen.insert(line).second) raise<io_error>(403, name, ":", number, ": '", line, "' is duplicated");
  });
  return merges;
}

MOTIONLANG_BODY std::vector<std::string> read_vocabulary(const FilePath& path) {
  return parse_vocabulary(read_text(path), path.string());
}

MOTIONLANG_BODY BytePairMerges read_merges(const FilePath& path, std::size_t most) {
  return parse_merges(read_text(path), path.string(), most);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

/// One of the tokenizers that files describe.
class AnyTokenizer {
 public:
  AnyTokenizer(BertTokenizer t) : kind_(std::move(t)) {}
  AnyTokenizer(ClipTokenizer t) : kind_(std::move(t)) {}

  std::vector<Index> encode(std::string_view text) const {
    return std::visit([&](const auto& t) { return t.encode(text); }, kind_);
  }
  std::string decode(std::span<const Index> ids) const {
    return std::visit([&](const auto& t) { return t.decode(ids); }, kind_);
  }
  Index size() const {
    return std::visit([](const auto& t) { return t.size(); }, kind_);
  }
  Index pad_id() const {
    return std::visit([](const auto& t) { return t.pad_id(); }, kind_);
  }
  /// Null if it is the other kind.
  const BertTokenizer* bert() const { return std::get_if<BertTokenizer>(&kind_); }
  const ClipTokenizer* clip() const { return std::get_if<ClipTokenizer>(&kind_); }

 private:
  std::variant<BertTokenizer, ClipTokenizer> kind_;
};
static_assert(Tokenizer<AnyTokenizer>);

/// What the caller decides; a tokenizer.json has it too, but the published systems do not apply that.
struct TokenizerLimits {
  std::optional<Index> longest = {};  // ids of a text with its frame; unless set 512 of BERT and MPNet, 77 of CLIP
  std::optional<bool> truncate = {};  // unless set: BERT and MPNet refuse, CLIP cuts
  bool stored = false;                // take both from the block "truncation" of the file, if it has one
  // of CLIP: as these files say; MDM and STMC were trained with the original
  ClipCleaning cleaning = ClipCleaning::hugging_face;
};

namespace detail {

/// Pieces by id from an object of ids, and added tokens that it lacks. Throws io_error 403 unless every id from 0 on
/// has one.
std::vector<std::string> pieces_by_id(const JsonView& vocabulary, std::span<const AddedToken> added = {});

std::vector<AddedToken> added_tokens(const JsonView& document);

}  // namespace detail

/// The tokenizer that a tokenizer.json describes.
/// Throws  io_error 403 if it is malformed, 404, naming the type, if it asks for a kind that is not known here;
///         config_error 107 for values of the wrong kind, missing pieces, merges of unknown ones
AnyTokenizer tokenizer_from_json(const JsonView& document, const TokenizerLimits& limits = {});
/// Throws io_error 401 and as tokenizer_from_json.
AnyTokenizer read_tokenizer_json(const FilePath& path, const TokenizerLimits& limits = {});

/// vocab.json: the id of every piece. Throws io_error 401, 403 unless the ids are 0, 1, ...; config_error 107.
std::vector<std::string> read_vocabulary_json(const FilePath& path);

/// What a tokenizer_config.json says about a tokenizer whose vocabulary stands in another file.
struct TokenizerConfig {
  std::string tokenizer_class;
  std::optional<bool> lower_case = {}, strip_accents = {}, split_cjk = {};
  std::optional<Index> longest = {};          // model_max_length; none if it is beyond every length
  std::map<std::string, std::string> tokens;  // "cls_token" -> "[CLS]", ...
};

/// Throws config_error 107.
TokenizerConfig tokenizer_config_from_json(const JsonView& view);

namespace detail {

inline bool file_exists(const FilePath& path) { return ::access(path.c_str(), R_OK) == 0; }

}  // namespace detail

/// The tokenizer in the folder of a model: its tokenizer.json, else vocab.txt (BERT, MPNet) or vocab.json and
/// merges.txt (CLIP), as its tokenizer_config.json says. model_max_length is not applied, as the published systems do
/// not. Throws io_error 401 if all of these files are missing, and as their readers
AnyTokenizer read_tokenizer(const FilePath& folder, const TokenizerLimits& limits = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_TOKENIZER_JSON_IPP  // <motionlang/weights/tokenizer_json.ipp>
#define MOTIONLANG_HAS_WEIGHTS_TOKENIZER_JSON_IPP
// Bodies of tokenizer_json.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws io_error 404: the file asks for a kind of thing that is not known here.
[[noreturn]] inline void unknown_kind(const JsonView& view, std::string_view wanted) {
  const std::string found = view.contains("type") && view["type"].is_string() ? view["type"].as<std::string>() : "none";
  raise<io_error>(404, view.path(), ": type ", utf8_head(found, 40), ", known are ", wanted);
}

inline bool has_type(const JsonView& view, std::string_view type) {
  return view.contains("type") && view["type"].is_string() && view["type"].as<std::string>() == type;
}

/// Throws io_error 404 unless the member is missing or has the only value that is known here.
template <class T>
void require_value(const JsonView& view, const std::string& key, const T& value) {
  if (view.value_or(key, value) != value)
    raise<io_error>(404, view.path(), ": '", key, "' has a value that is not known here");
}

MOTIONLANG_BODY std::vector<std::string> pieces_by_id(const JsonView& vocabulary, std::span<const AddedToken> added) {
  if (!vocabulary.is_object()) raise<config_error>(107, vocabulary.path(), ": expected an object of pieces and ids");
  std::size_t count = vocabulary.json().size();
  for (const AddedToken& t : added) count += !vocabulary.contains(t.content);
  std::vector<std::string> pieces(count);
  std::vector<bool> taken(count);
  const auto put = [&](const std::string& piece, Index id) {
    const auto at = static_cast<std::size_t>(id);
    if (id < 0 || at >= count)
      raise<io_error>(403, vocabulary.path(), ": '", piece, "' has id ", id, " among ", counted(count, "piece"));
    if (taken[at] && pieces[at] != piece)
      raise<io_error>(403, vocabulary.path(), ": '", pieces[at], "' and '", piece, "' have the same id ", id);
    taken[at] = true;
    pieces[at] = piece;
  };
  for (const auto& [piece, id] : vocabulary.json().items()) {
    if (!id.is_number_integer() || !std::in_range<Index>(id.get<std::int64_t>()))
      raise<config_error>(107, vocabulary.path(), ": the id of '", piece, "' is no integer");
    put(piece, static_cast<Index>(id.get<std::int64_t>()));
  }
  for (const AddedToken& t : added) put(t.content, t.id);
  if (const auto hole = std::find(taken.begin(), taken.end(), false); hole != taken.end())
    raise<io_error>(403, vocabulary.path(), ": no piece has id ", hole - taken.begin(), ", others are duplicated");
  return pieces;
}

MOTIONLANG_BODY std::vector<AddedToken> added_tokens(const JsonView& document) {
  std::vector<AddedToken> out;
  if (!document.contains("added_tokens")) return out;
  const JsonView list = document["added_tokens"];
  for (Index i = 0; i < list.size(); ++i) {
    const JsonView t = list[i];
    require_value(t, "single_word", false);
    out.push_back({t["content"].as<std::string>(), t["id"].as<Index>(), t.value_or("normalized", false)});
  }
  return out;
}

struct Frames {
  std::vector<FramePart> single, pair;
};

inline std::vector<FramePart> template_frame(const JsonView& parts, const JsonView& specials) {
  std::vector<FramePart> out;
  for (Index i = 0; i < parts.size(); ++i) {
    if (parts[i].contains("Sequence")) {
      const JsonView text = parts[i]["Sequence"];
      const auto name = text["id"].as<std::string>();
      if (name != "A" && name != "B") raise<io_error>(404, text.path(), ": text '", name, "', known are A and B");
      out.push_back({name == "A" ? FramePart::text_a : FramePart::text_b, 0, text["type_id"].as<Index>()});
      continue;
    }
    const JsonView token = parts[i]["SpecialToken"];
    for (const Index id : specials[token["id"].as<std::string>()]["ids"].as<std::vector<Index>>())
      out.push_back({FramePart::token, id, token["type_id"].as<Index>()});
  }
  return out;
}

inline Frames read_frames(const JsonView& view) {
  using enum FramePart::Kind;
  if (has_type(view, "TemplateProcessing"))
    return {template_frame(view["single"], view["special_tokens"]),
            template_frame(view["pair"], view["special_tokens"])};
  const bool bert = has_type(view, "BertProcessing");
  if (!bert && !has_type(view, "RobertaProcessing"))
    unknown_kind(view, "TemplateProcessing, BertProcessing, RobertaProcessing");
  const Index begin = view["cls"][1].as<Index>(), end = view["sep"][1].as<Index>(), second = bert ? 1 : 0;
  Frames out{{{token, begin}, {text_a}, {token, end}}, {{token, begin}, {text_a}, {token, end}}};
  if (!bert) out.pair.push_back({token, end});
  out.pair.insert(out.pair.end(), {{text_b, 0, second}, {token, end, second}});
  return out;
}

/// The pieces of the first and the last id of a frame. Throws io_error 404 if it does not begin and end with one.
inline std::pair<std::string, std::string> frame_ends(const Frames& frames, const std::vector<std::string>& pieces,
                                                      const JsonView& view) {
  const auto& f = frames.single;
  const auto piece = [&](const FramePart& part) -> std::string {
    if (part.id < 0 || part.id >= std::ssize(pieces))
      raise<config_error>(107, view.path(), ": id ", part.id, " among ", counted(pieces.size(), "piece"));
    return pieces[static_cast<std::size_t>(part.id)];
  };
  if (f.size() < 3 || f.front().kind != FramePart::token || f.back().kind != FramePart::token)
    raise<io_error>(404, view.path(), ": a frame that does not begin and end with a token");
  return {piece(f.front()), piece(f.back())};
}

template <class Options>
void set_limits(Options& options, const JsonView& document, const TokenizerLimits& limits) {
  if (limits.stored && document.contains("truncation") && document["truncation"].is_object()) {
    options.longest = document["truncation"]["max_length"].as<Index>();
    options.truncate = true;
  }
  options.longest = limits.longest.value_or(options.longest);
  options.truncate = limits.truncate.value_or(options.truncate);
}

inline BertTokenizer bert_from_json(const JsonView& document, const TokenizerLimits& limits) {
  const JsonView model = document["model"], normalizer = document["normalizer"], post = document["post_processor"];
  if (!has_type(normalizer, "BertNormalizer")) unknown_kind(normalizer, "BertNormalizer");
  if (!has_type(document["pre_tokenizer"], "BertPreTokenizer"))
    unknown_kind(document["pre_tokenizer"], "BertPreTokenizer");
  BertTokenizerOptions o;
  o.clean_text = normalizer.value_or("clean_text", true);
  o.split_cjk = normalizer.value_or("handle_chinese_chars", true);
  o.lower_case = normalizer.value_or("lowercase", true);
  if (normalizer.contains("strip_accents") && !normalizer["strip_accents"].is_null())
    o.strip_accents = normalizer["strip_accents"].as<bool>();
  o.unknown = model.value_or("unk_token", "[UNK]");
  o.continuation = model.value_or("continuing_subword_prefix", "##");
  o.longest_word = model.value_or("max_input_chars_per_word", Index{100});
  set_limits(o, document, limits);
  const auto added = added_tokens(document);
  auto pieces = pieces_by_id(model["vocab"], added);
  Frames frames = read_frames(post);
  std::tie(o.begin, o.end) = frame_ends(frames, pieces, post);
  if (std::find(pieces.begin(), pieces.end(), "<pad>") != pieces.end()) o.pad = "<pad>";
  BertTokenizer out(std::move(pieces), std::move(o), document.path(), added);
  out.set_frames(std::move(frames.single), std::move(frames.pair), document.path());
  return out;
}

/// The patterns by which CLIP's words are found.
inline bool is_clip_pattern(std::string_view pattern) {
  constexpr std::string_view marks = R"(<\|startoftext\|>|<\|endoftext\|>|)";
  if (pattern.starts_with(marks)) pattern.remove_prefix(marks.size());
  return pattern == R"('s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+)";
}

inline void require_clip_steps(const JsonView& document) {
  const JsonView normalizer = document["normalizer"], splitter = document["pre_tokenizer"];
  if (!has_type(normalizer, "Sequence")) unknown_kind(normalizer, "Sequence of NFC, Replace, Lowercase");
  const JsonView steps = normalizer["normalizers"];
  const std::vector<std::string> known{"NFC", "Replace", "Lowercase"};
  for (Index i = 0; i < std::max<Index>(steps.size(), 3); ++i) {
    if (i >= 3 || !has_type(steps[i], known[static_cast<std::size_t>(i)]))
      unknown_kind(steps[i], i < 3 ? known[static_cast<std::size_t>(i)] : "NFC, Replace, Lowercase and no more");
  }
  require_value(steps[1]["pattern"], "Regex", std::string("\\s+"));
  require_value(steps[1], "content", std::string(" "));

  if (!has_type(splitter, "Sequence")) unknown_kind(splitter, "Sequence of Split, ByteLevel");
  const JsonView parts = splitter["pretokenizers"];
  if (!has_type(parts[0], "Split")) unknown_kind(parts[0], "Split");
  if (!has_type(parts[1], "ByteLevel")) unknown_kind(parts[1], "ByteLevel");
  if (parts.size() > 2) unknown_kind(parts[2], "Split, ByteLevel and no more");
  if (!is_clip_pattern(parts[0]["pattern"]["Regex"].as<std::string>()))
    raise<io_error>(404, parts[0].path(), ": another pattern than that of CLIP");
  require_value(parts[0], "behavior", std::string("Removed"));
  require_value(parts[0], "invert", true);
  require_value(parts[1], "add_prefix_space", false);
}

/// An array of "a b" in older files, of ["a", "b"] in newer ones.
inline BytePairMerges merges_from_json(const JsonView& list) {
  BytePairMerges merges;
  for (Index i = 0; i < list.size(); ++i) {
    const JsonView merge = list[i];
    if (merge.is_string())
      merges.push_back(parse_merge(merge.as<std::string>(), list.path(), i));
    else if (merge.size() == 2)
      merges.emplace_back(merge[0].as<std::string>(), merge[1].as<std::string>());
    else
      raise<io_error>(403, merge.path(), ": ", counted(merge.size(), "symbol"), ", a merge has 2");
  }
  return merges;
}

inline ClipTokenizer clip_from_json(const JsonView& document, const TokenizerLimits& limits) {
  const JsonView model = document["model"], post = document["post_processor"];
  require_clip_steps(document);
  require_value(model, "byte_fallback", false);
  require_value(model, "ignore_merges", false);
  require_value(model, "continuing_subword_prefix", std::string());
  if (model.contains("dropout") && !model["dropout"].is_null())
    raise<io_error>(404, model.path(), ": dropout of merges");
  ClipTokenizerOptions o;
  o.cleaning = limits.cleaning;
  o.word_end = model.value_or("end_of_word_suffix", "");
  o.unknown = model.value_or("unk_token", "");
  set_limits(o, document, limits);
  const auto added = added_tokens(document);
  auto pieces = pieces_by_id(model["vocab"], added);
  Frames frames = read_frames(post);
  std::tie(o.begin, o.end) = frame_ends(frames, pieces, post);
  ClipTokenizer out(std::move(pieces), merges_from_json(model["merges"]), std::move(o), document.path(), added);
  out.set_frames(std::move(frames.single), std::move(frames.pair), document.path());
  return out;
}

}  // namespace detail

MOTIONLANG_BODY AnyTokenizer tokenizer_from_json(const JsonView& document, const TokenizerLimits& limits) {
  const JsonView model = document["model"];
  if (detail::has_type(model, "WordPiece")) return detail::bert_from_json(document, limits);
  if (detail::has_type(model, "BPE")) return detail::clip_from_json(document, limits);
  detail::unknown_kind(model, "WordPiece, BPE");
}

MOTIONLANG_BODY AnyTokenizer read_tokenizer_json(const FilePath& path, const TokenizerLimits& limits) {
  const auto document = read_json(path);
  return tokenizer_from_json(JsonView(document, path.string()), limits);
}

MOTIONLANG_BODY std::vector<std::string> read_vocabulary_json(const FilePath& path) {
  const auto document = read_json(path);
  return detail::pieces_by_id(JsonView(document, path.string()));
}

MOTIONLANG_BODY TokenizerConfig tokenizer_config_from_json(const JsonView& view) {
  TokenizerConfig out;
  const auto flag = [&](const std::string& key) -> std::optional<bool> {
    return view.contains(key) && !view[key].is_null() ? std::optional(view[key].as<bool>()) : std::nullopt;
  };
  out.tokenizer_class = view.value_or("tokenizer_class", "");
  out.lower_case = flag("do_lower_case");
  out.strip_accents = flag("strip_accents");
  out.split_cjk = flag("tokenize_chinese_chars");
  if (view.value_or("model_max_length", 1e30) < 1e9) out.longest = view["model_max_length"].as<Index>();
  for (const std::string& key : view.keys()) {
    if (!key.ends_with("_token")) continue;
    if (view[key].is_string()) out.tokens[key] = view[key].as<std::string>();
    if (view[key].is_object()) out.tokens[key] = view[key]["content"].as<std::string>();
  }
  return out;
}

namespace detail {

inline BertTokenizer bert_from_folder(const std::string& folder, const TokenizerConfig& config,
                                      const TokenizerLimits& limits) {
  std::vector<std::string> vocabulary = read_vocabulary(folder + "/vocab.txt");
  const std::vector<std::string> marks = mpnet_vocabulary({});  // the last one stands at the end
  const bool mpnet =
      config.tokenizer_class.starts_with("MPNet") ||
      (vocabulary.size() >= marks.size() && std::equal(marks.begin(), marks.end() - 1, vocabulary.begin()));
  BertTokenizerOptions o = mpnet ? BertTokenizerOptions::mpnet() : BertTokenizerOptions();
  o.lower_case = config.lower_case.value_or(o.lower_case);
  o.strip_accents = config.strip_accents;
  o.split_cjk = config.split_cjk.value_or(o.split_cjk);
  const std::pair<const char*, std::string*> names[] = {
      {"cls_token", &o.begin}, {"sep_token", &o.end}, {"pad_token", &o.pad}};
  for (const auto& [key, name] : names) {
    if (const auto found = config.tokens.find(key); found != config.tokens.end()) *name = found->second;
  }
  // MPNet's own unknown token is not that of its words.
  if (const auto found = config.tokens.find("unk_token"); !mpnet && found != config.tokens.end())
    o.unknown = found->second;
  for (const auto& [key, token] : config.tokens) {
    if (std::find(o.special.begin(), o.special.end(), token) == o.special.end()) o.special.push_back(token);
  }
  o.longest = limits.longest.value_or(o.longest);
  o.truncate = limits.truncate.value_or(o.truncate);
  return BertTokenizer(std::move(vocabulary), std::move(o), folder + "/vocab.txt");
}

inline ClipTokenizer clip_from_folder(const std::string& folder, const TokenizerLimits& limits) {
  ClipTokenizerOptions o;
  o.cleaning = limits.cleaning;
  o.longest = limits.longest.value_or(o.longest);
  o.truncate = limits.truncate.value_or(o.truncate);
  return ClipTokenizer(read_vocabulary_json(folder + "/vocab.json"), read_merges(folder + "/merges.txt"), std::move(o),
                       folder);
}

}  // namespace detail

MOTIONLANG_BODY AnyTokenizer read_tokenizer(const FilePath& folder, const TokenizerLimits& limits) {
  const std::string& name = folder.string();
  if (detail::file_exists(name + "/tokenizer.json")) return read_tokenizer_json(name + "/tokenizer.json", limits);
  TokenizerConfig config;
  if (const std::string file = name + "/tokenizer_config.json"; detail::file_exists(file)) {
    const auto document = read_json(file);
    config = tokenizer_config_from_json(JsonView(document, file));
  }
  if (detail::file_exists(name + "/vocab.txt")) return detail::bert_from_folder(name, config, limits);
  if (detail::file_exists(name + "/vocab.json")) return detail::clip_from_folder(name, limits);
  raise<io_error>(401, name, ": neither tokenizer.json nor vocab.txt nor vocab.json");
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// One of the networks, where which one it is shows only when a file is read.
template <Backend B>
struct AnyTextNetwork {
  std::variant<ClipText<B>, DistilBert<B>, Bert<B>, Mpnet<B>> network;

  bool is_clip() const { return network.index() == 0; }
  TextFeatures<B> operator()(const TokenBatch& batch) const {
    return std::visit([&](const auto& n) { return n(batch); }, network);
  }
  /// Throws config_error 102 if the network has no end token that stands for a text.
  TokenBatch until_end(const TokenBatch& batch) const { return clip().until_end(batch); }
  Tensor<B, 2> project(const Tensor<B, 2>& rows) const { return clip().project(rows); }

 private:
  const ClipText<B>& clip() const {
    if (!is_clip()) raise<config_error>(102, "AnyTextNetwork: only CLIP's end token stands for the text");
    return std::get<0>(network);
  }
};

template <Backend B>
using AnyTextEncoder = TokenizedEncoder<AnyTokenizer, AnyTextNetwork<B>>;

/// What a system takes from its encoder.
struct TextEncoderOptions {
  TextOptions text{};
  TokenizerLimits limits{};
};
/// One vector of CLIP for each text: MDM-SMPL; MDM has its texts cut to 22 ids. Texts are cleaned as by OpenAI, whose
/// CLIP these systems were trained with, wherever the vocabulary comes from.
TextEncoderOptions clip_sentences(Index longest = 77);
/// All 77 rows of CLIP: MotionDiffuse. Cleaned likewise.
inline TextEncoderOptions clip_states() {
  return {.text = {.width = 77}, .limits = {.longest = 77, .truncate = true, .cleaning = ClipCleaning::original}};
}

namespace detail {

inline constexpr const char* clip_vocabularies[] = {"bpe_simple_vocab_16e6.txt.gz", "bpe_simple_vocab_16e6.txt"};

AnyTokenizer tokenizer_of(const std::filesystem::path& folder, const TokenizerLimits& limits, bool clip);

/// The weights of a folder, and the sizes in its config.json.
struct TextNetworkFiles {
  WeightFile weights;
  std::variant<ClipTextConfig, BertConfig> config;
  std::string type;  // distilbert, bert or mpnet, where it is not CLIP
};
/// file  its config.json. Throws config_error 103 for another model_type
TextNetworkFiles text_network_files(const FilePath& file, const FilePath& folder);

template <Backend B>
AnyTextNetwork<B> text_network(const TextNetworkFiles& files) {
  if (const auto* clip = std::get_if<ClipTextConfig>(&files.config)) return {load_clip_text<B>(*clip, files.weights)};
  const auto& config = std::get<BertConfig>(files.config);
  if (files.type == "distilbert") return {load_text_network<DistilBert<B>>(config, files.weights)};
  if (files.type == "bert") return {load_text_network<Bert<B>>(config, files.weights)};
  return {load_text_network<Mpnet<B>>(config, files.weights)};
}

/// The highest id that a tokenizer gives has to have a row.
void check_vocabulary(const AnyTokenizer& tokenizer, Index rows, const std::string& where);
template <Backend B>
void check_vocabulary(const AnyTokenizer& tokenizer, const AnyTextNetwork<B>& network, const std::string& where) {
  const Index rows = std::visit(
      [](const auto& n) {
        if constexpr (requires { n.token_embedding; })
          return n.token_embedding.weight.size(0);
        else
          return n.words.weight.size(0);
      },
      network.network);
  check_vocabulary(tokenizer, rows, where);
}

}  // namespace detail

/// CLIP's text tower among other tensors ("clip." in checkpoints of MotionDiffuse), with the tokenizer of a folder.
template <Backend B>
AnyTextEncoder<B> load_clip_encoder(const TensorSet& weights, const FilePath& tokenizer_folder,
                                    const TextEncoderOptions& options) {
  AnyTokenizer tokenizer = detail::tokenizer_of(tokenizer_folder.string(), options.limits, true);
  AnyTextNetwork<B> network{load_clip_text<B>(weights)};
  detail::check_vocabulary(tokenizer, network, weights.name());
  return {std::move(tokenizer), std::move(network), options.text};
}

/// path    a folder, or OpenAI's file
/// Throws  io_error 401, naming the file that is missing; config_error 103 for another network, 102 if tokenizer and
///         network do not fit, and what their readers throw
template <Backend B>
AnyTextEncoder<B> load_text_encoder(const FilePath& path, const TextEncoderOptions& options = {}) {
  const std::filesystem::path given = path.string();
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(given, ignored);
  const auto folder = is_folder ? given : given.parent_path();
  const auto file = folder / "config.json";
  if (!is_folder || !detail::file_exists(file)) return load_clip_encoder<B>(open_weights(path), folder, options);
  AnyTextNetwork<B> network = detail::text_network<B>(detail::text_network_files(file, path));
  AnyTokenizer tokenizer = detail::tokenizer_of(folder, options.limits, network.is_clip());
  detail::check_vocabulary(tokenizer, network, given.string());
  return {std::move(tokenizer), std::move(network), options.text};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_TEXT_ENCODER_FOLDER_IPP  // <motionlang/weights/text_encoder_folder.ipp>
#define MOTIONLANG_HAS_WEIGHTS_TEXT_ENCODER_FOLDER_IPP
// Bodies of text_encoder_folder.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TextEncoderOptions clip_sentences(Index longest) {
  return {.text = {.pooling = Pooling::end},
          .limits = {.longest = longest, .truncate = true, .cleaning = ClipCleaning::original}};
}

namespace detail {

MOTIONLANG_BODY AnyTokenizer tokenizer_of(const std::filesystem::path& folder, const TokenizerLimits& limits,
                                          bool clip) {
  for (const char* name : {"tokenizer.json", "vocab.txt", "vocab.json"}) {
    if (file_exists(folder / name)) return read_tokenizer(folder, limits);
  }
  ClipTokenizerOptions options;
  options.longest = limits.longest.value_or(options.longest);
  options.truncate = limits.truncate.value_or(options.truncate);
  for (const char* name : clip_vocabularies) {
    if (clip && file_exists(folder / name)) return read_clip_tokenizer(folder / name, options);
  }
  raise<io_error>(401, folder.string(), ": no tokenizer of the text encoder: put ",
                  clip ? "bpe_simple_vocab_16e6.txt.gz (of github.com/openai/CLIP), or tokenizer.json, "
                       : "tokenizer.json, or vocab.txt, ",
                  "there");
}

MOTIONLANG_BODY TextNetworkFiles text_network_files(const FilePath& file, const FilePath& folder) {
  const auto document = read_json(file);
  const JsonView config(document, file.string());
  WeightFile weights = open_weights(folder);
  const auto type = config["model_type"].as<std::string>();
  if (type == "clip" || type == "clip_text_model") return {std::move(weights), clip_text_config(config), type};
  if (type != "distilbert" && type != "bert" && type != "mpnet")
    raise<config_error>(103, config.path(), ": model_type '", type, "' is not one of clip, distilbert, bert, mpnet");
  return {std::move(weights), bert_config(config, type), type};
}

MOTIONLANG_BODY void check_vocabulary(const AnyTokenizer& tokenizer, Index rows, const std::string& where) {
  if (tokenizer.size() > rows)
    raise<config_error>(102, where, ": a tokenizer of ", counted(tokenizer.size(), "piece"), ", the network knows ",
                        rows);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// What the files say about a model, before memory is taken for it. The member that `system` names counts.
struct DiffusionRun {
  std::string system;  // stmc, mdm, motiondiffuse
  std::string prefix;  // of the names of the denoiser's tensors
  MdmSmplConfig mdm_smpl{};
  MdmConfig mdm{};
  MotionDiffuseConfig motiondiffuse{};
  Index steps = 1000;
  std::string schedule = "cosine";  // or linear
  double fps = 20;
  std::string features;               // smplrifke, guoh3dfeats
  std::string text_encoder = "clip";  // or bert, none

  Index width() const {
    return system == "stmc" ? mdm_smpl.nfeats : system == "mdm" ? mdm.nfeats : motiondiffuse.input_feats;
  }
  Index text_width() const {
    return system == "stmc" ? mdm_smpl.tx_dim : system == "mdm" ? mdm.text_dim : motiondiffuse.clip_dim;
  }
  GaussianDiffusion diffusion() const;
  FeatureLayout layout() const;
};

struct DiffusionRunOptions {
  FilePath text_encoder = "";  // a folder or a file; looked for beside the model unless given
  FilePath statistics = "";    // a folder with mean and std, .pt or .npy; else that of the model
};

template <Backend B>
using PublishedStmc = Stmc<B, AnyDenoiser<B>, AnyTextEncoder<B>>;

namespace detail {

void read_mdm(DiffusionRun& out, const RunReader& r);

RunReader reader_of(const RunFolder& run, const TensorSet& weights);

/// Tensors that checkpoints hold besides: tables of positions, CLIP, SMPL, optimisers.
inline bool is_beside(std::string_view name) {
  return name.ends_with("sequence_pos_encoder.pe") || begins_with_any(name, {"clip.", "clip_model.", "rot2xyz."});
}

/// Ready for inference.
template <Module M>
void load_denoiser(M& module, const TensorSet& file, const std::string& prefix) {
  const auto beside = [&](const std::string& name) {
    return is_beside(std::string_view(name).substr(prefix.size())) ||
           begins_with_any(name, {"motion_normalizer.", "text_normalizer."});
  };
  load_run_module(module, file, prefix, beside, LoadFor::inference);
}

std::filesystem::path find_text_encoder(const std::filesystem::path& model, const std::string& kind);

/// The vocabulary of a model that has CLIP in its checkpoint.
std::filesystem::path clip_vocabulary_of(const std::filesystem::path& model);

/// The checkpoint: the entry of the file that holds the model's tensors.
WeightFile run_weights(const RunFolder& run);

template <Backend B>
AnyDenoiser<B> make_denoiser(const DiffusionRun& run, const TensorSet& weights) {
  const auto room = room_of(weights);
  NoInit zeros;
  AnyDenoiser<B> out;
  if (run.system == "stmc")
    out.mdm_smpl.emplace(run.mdm_smpl, zeros);
  else if (run.system == "mdm")
    out.mdm.emplace(run.mdm, zeros);
  else
    out.motiondiffuse.emplace(run.motiondiffuse, zeros);
  return out;
}

/// Of a model folder of ours the run that is in it.
RunFolder published_run(const RunFolder& run);

template <Backend B>
Normalizer<B> motion_normalizer(const RunFolder& run, const TensorSet& weights, Index width,
                                const DiffusionRunOptions& options) {
  return run_normalizer<B>(
      run, weights, width, {"motion_stats.", "meta.", "stats.", ""},
      concat_text("the motions: put mean and std of the data set there (",
                  run.system == "mdm" ? "Mean.npy and Std.npy, in HumanML3D's own folder" : "meta/mean.npy and std.npy",
                  "), or name their folder"),
      options.statistics);
}

/// Of STMC; the others have none.
template <Backend B>
std::optional<Normalizer<B>> text_normalizer(const RunFolder& run, const TensorSet& weights,
                                             const DiffusionRun& about) {
  if (about.system != "stmc") return std::nullopt;
  if (auto packed = find_normalizer<B>(weights, about.text_width(), {"text_normalizer."})) return packed;
  return folder_normalizer<B>(run, about.text_width(), {"text_stats."},
                              "the texts: text_stats/mean.pt and std.pt are missing");
}

/// Throws io_error 404 for models whose texts are not supported.
TextEncoderOptions wanted_text_encoder(const RunFolder& run, const DiffusionRun& about);
/// Throws config_error 102 if the text encoder at `named` is another network than the model needs.
void require_text_encoder(const RunFolder& run, const DiffusionRun& about, const std::string& named, bool clip);

template <Backend B>
AnyTextEncoder<B> encoder_of(const RunFolder& run, const TensorSet& weights, const DiffusionRun& about,
                             const DiffusionRunOptions& options) {
  const TextEncoderOptions wanted = wanted_text_encoder(run, about);
  const bool motiondiffuse = about.system == "motiondiffuse";
  const std::string named = options.text_encoder.string();
  if (named.empty() && motiondiffuse && weights.find("clip.token_embedding.weight") != nullptr)
    return load_clip_encoder<B>(weights, clip_vocabulary_of(run.folder).parent_path(), wanted);
  auto encoder = load_text_encoder<B>(
      named.empty() ? FilePath(find_text_encoder(run.folder, about.text_encoder)) : options.text_encoder, wanted);
  require_text_encoder(run, about, named, encoder.network.is_clip());
  return encoder;
}

}  // namespace detail

/// What options and tensors say of a run of stmc, mdm or motiondiffuse.
DiffusionRun diffusion_run(const RunFolder& run, const TensorSet& weights);

/// A model that is ready to generate.
template <Backend B>
PublishedStmc<B> load_diffusion_run(const RunFolder& given, const DiffusionRunOptions& options = {}) {
  const RunFolder run = detail::published_run(given);
  const WeightFile weights = detail::run_weights(run);
  const DiffusionRun about = diffusion_run(run, weights);
  const bool stmc = about.system == "stmc";
  Normalizer<B> motion = detail::motion_normalizer<B>(run, weights, about.width(), options);
  AnyTextEncoder<B> encoder = detail::encoder_of<B>(run, weights, about, options);
  auto text = detail::text_normalizer<B>(run, weights, about);
  AnyDenoiser<B> denoiser = detail::make_denoiser<B>(about, weights);
  if (denoiser.mdm_smpl) detail::load_denoiser(*denoiser.mdm_smpl, weights, about.prefix);
  if (denoiser.mdm) detail::load_denoiser(*denoiser.mdm, weights, about.prefix);
  if (denoiser.motiondiffuse) detail::load_denoiser(*denoiser.motiondiffuse, weights, about.prefix);
  return {.denoiser = std::move(denoiser),
          .text_encoder = std::move(encoder),
          .motion_normalizer = std::move(motion),
          .text_normalizer = text ? std::move(*text) : Normalizer<B>::identity(about.text_width()),
          .diffusion = about.diffusion(),
          .layout = about.layout(),
          .guidance = about.system == "motiondiffuse" ? 1.0 : 2.5,
          .sampling = {.noise_scale = stmc ? NoiseScale::posterior_variance : NoiseScale::posterior_std},
          .fps = about.fps};
}
template <Backend B>
PublishedStmc<B> load_diffusion_run(const FilePath& folder, const DiffusionRunOptions& options = {}) {
  return load_diffusion_run<B>(find_run(folder), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_DIFFUSION_RUN_IPP  // <motionlang/weights/diffusion_run.ipp>
#define MOTIONLANG_HAS_WEIGHTS_DIFFUSION_RUN_IPP
// Bodies of diffusion_run.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GaussianDiffusion DiffusionRun::diffusion() const {
  return schedule == "linear" ? GaussianDiffusion(LinearSchedule{.steps = steps})
                              : GaussianDiffusion(CosineSchedule{.steps = steps});
}

MOTIONLANG_BODY FeatureLayout DiffusionRun::layout() const {
  if (features == "smplrifke") return smplrifke_layout();
  return width() == Guoh3dSlots{21}.size() ? guoh3dfeats_layout(kit_part_of_joint) : guoh3dfeats_layout();
}

namespace detail {

inline void read_stmc(DiffusionRun& out, const RunReader& r) {
  const std::string layer = "seqTransEncoder.layers.";
  out.mdm_smpl = {
      .nfeats = r.size("skel_embedding.weight", 1, {"diffusion/denoiser/nfeats", "data/motion_loader/nfeats"}),
      .tx_dim = r.size("tx_embedding.0.weight", 1, {"diffusion/denoiser/tx_dim"}),
      .latent_dim = r.size("skel_embedding.weight", 0, {"diffusion/denoiser/latent_dim"}),
      .ff_size = r.size(layer + "0.linear1.weight", 0, {"diffusion/denoiser/ff_size"}),
      .num_layers = r.count(layer, ".linear1.weight", {"diffusion/denoiser/num_layers"}),
      .num_heads = r.number({"diffusion/denoiser/num_heads"}, 8, 1024),
      .nb_registers = r.size_if_any("registers", 0, {"diffusion/denoiser/nb_registers"}),
      .activation = parse_activation(r.one_of("diffusion/denoiser/activation", "gelu", {"gelu", "relu"}))};
  out.steps =
      r.number({"diffusion/timesteps", "diffusion/schedule/timesteps", "diffusion/schedule/steps"}, 100, 10'000);
  r.one_of("diffusion/prediction", "x", {"x"});
  out.mdm_smpl.max_len = std::max(out.mdm_smpl.max_len, out.steps);
  out.fps = r.real("data/motion_loader/fps", 20);
  out.features = "smplrifke";
}

MOTIONLANG_BODY void read_mdm(DiffusionRun& out, const RunReader& r) {
  MdmConfig& c = out.mdm;
  const bool decoder = r.has("seqTransDecoder.layers.0.linear1.weight"), recurrent = r.has("gru.weight_ih_l0");
  c.arch = recurrent ? MdmArch::gru : decoder ? MdmArch::trans_dec : MdmArch::trans_enc;
  const std::string stated = r.text("arch", "");
  const std::string_view found = recurrent ? "gru" : decoder ? "trans_dec" : "trans_enc";
  if (!stated.empty() && stated != found)
    raise<config_error>(102, r.place("arch"), " is '", stated, "', the tensors are those of ", found);
  if (r.number({"context_len"}, 0, 100'000, 0) > 0)
    raise<io_error>(404, r.place("context_len"), ": models that continue a motion (DiP) are not supported");
  const std::string layers = recurrent ? "gru.weight_ih_l"
                             : decoder ? "seqTransDecoder.layers."
                                       : "seqTransEncoder.layers.";
  c.nfeats = r.size("output_process.poseFinal.weight", 0);
  c.latent_dim = r.size("input_process.poseEmbedding.weight", 0, {"latent_dim"});
  c.num_layers = r.count(layers, recurrent ? "" : ".linear1.weight", {"layers"});
  if (!recurrent) c.ff_size = r.size(layers + "0.linear1.weight", 0);
  const bool text = r.has("embed_text.weight"), action = r.has("embed_action.action_embedding");
  c.condition = text ? MdmCondition::text : action ? MdmCondition::action : MdmCondition::none;
  if (action) c.num_actions = r.size("embed_action.action_embedding", 0);
  if (text) c.text_dim = r.size("embed_text.weight", 1);
  out.text_encoder = !text ? "none" : r.one_of("text_encoder_type", "clip", {"clip", "bert"});
  c.text_sequence = decoder && out.text_encoder == "bert";
  if (decoder && r.flag("emb_trans_dec", false))
    c.class_token = out.text_encoder == "bert" ? MdmClassToken::time_only : MdmClassToken::time_plus_text;
  c.mask_frames = r.flag("mask_frames", false);
  out.steps = r.number({"diffusion_steps"}, 1000, 10'000);
  out.schedule = r.one_of("noise_schedule", "cosine", {"cosine", "linear"});
  c.max_len = std::max({c.max_len, out.steps, c.crop_frames + 1});
}

inline void read_motiondiffuse(DiffusionRun& out, const RunReader& r) {
  MotionDiffuseConfig& c = out.motiondiffuse;
  const std::string block = "temporal_decoder_blocks.", layer = "textTransEncoder.layers.";
  c.input_feats = r.size("joint_embed.weight", 1);
  c.num_frames = r.size("sequence_embedding", 0);
  c.latent_dim = r.size("sequence_embedding", 1, {"latent_dim"});
  c.ff_size = r.size(block + "0.ffn.linear1.weight", 0, {"ff_size"});
  c.num_layers = r.count(block, ".ffn.linear1.weight", {"num_layers"});
  c.num_heads = r.number({"num_heads"}, 8, 1024);
  c.clip_dim = r.size("text_pre_proj.weight", 1);
  c.text_latent_dim = r.size("text_pre_proj.weight", 0, {"text_latent_dim"});
  c.text_ff_size = r.size(layer + "0.linear1.weight", 0, {"text_ff_size"});
  c.num_text_layers = r.count(layer, ".linear1.weight", {"num_text_layers"});
  c.text_num_heads = r.number({"text_num_heads"}, 4, 1024);
  c.no_eff = r.flag("no_eff", false);
  out.steps = r.number({"diffusion_steps"}, 1000, 10'000);
  out.schedule = "linear";
}

/// HumanML3D's vector of 22 joints, or KIT's of 21.
inline void read_representation(DiffusionRun& out, const std::string& where) {
  const Index kit = Guoh3dSlots{21}.size(), human = Guoh3dSlots{22}.size();
  if (out.width() != kit && out.width() != human)
    raise<io_error>(404, where, ": motions of ", counted(out.width(), "number"), " a frame, known are ", human,
                    " (HumanML3D) and ", kit, " (KIT-ML)");
  out.features = "guoh3dfeats";
  out.fps = out.width() == kit ? 12.5 : 20;
}

MOTIONLANG_BODY RunReader reader_of(const RunFolder& run, const TensorSet& weights) {
  return reader_of(run, weights,
                   run.system == "stmc"  ? "skel_embedding.weight"
                   : run.system == "mdm" ? "input_process.poseEmbedding.weight"
                                         : "joint_embed.weight");
}

/// Where a text encoder is looked for, relative to the folder of the model and to the one around it.
inline constexpr const char* clip_places[] = {"text_encoder", "clip", "ViT-B-32.pt", "clip-vit-base-patch32"};

inline constexpr const char* bert_places[] = {"text_encoder", "distilbert-base-uncased"};

MOTIONLANG_BODY std::filesystem::path find_text_encoder(const std::filesystem::path& model, const std::string& kind) {
  std::vector<std::string> tried;
  const auto places = kind == "clip" ? std::span<const char* const>(clip_places) : bert_places;
  for (const auto& folder : {model, folder_around(model)}) {
    for (const char* name : places) {
      std::error_code ignored;
      if (std::filesystem::exists(folder / name, ignored)) return folder / name;
      tried.push_back((folder / name).string());
    }
  }
  raise<io_error>(401, model.string(), ": its text encoder is not in the folder: give ",
                  kind == "clip" ? "CLIP ViT-B/32 (ViT-B-32.pt with bpe_simple_vocab_16e6.txt.gz, or the folder "
                                   "clip-vit-base-patch32)"
                                 : "the folder distilbert-base-uncased",
                  "; looked for ", join_text(tried));
}

MOTIONLANG_BODY std::filesystem::path clip_vocabulary_of(const std::filesystem::path& model) {
  for (const auto& folder : {model, model / "text_encoder", model / "clip", folder_around(model)}) {
    for (const char* name : clip_vocabularies) {
      if (file_exists(folder / name)) return folder / name;
    }
  }
  raise<io_error>(401, model.string(),
                  ": CLIP is in the checkpoint, its vocabulary is not: put "
                  "bpe_simple_vocab_16e6.txt.gz (of github.com/openai/CLIP) there, or name a text encoder");
}

MOTIONLANG_BODY WeightFile run_weights(const RunFolder& run) {
  if (run.weights.extension() == ".safetensors") return open_weights(run.weights);  // of ours
  if (run.system == "motiondiffuse") return open_weights(run.weights, {.path = "encoder"});
  const FileValue* average = run.option("use_ema");
  if (run.system == "mdm" && average != nullptr && std::get_if<bool>(&average->value) &&
      std::get<bool>(average->value)) {
    const WeightFile plain = open_weights(run.weights, {.path = ""});
    for (const TensorView& t : plain.tensors()) {
      if (t.name.starts_with("model_avg.")) return open_weights(run.weights, {.path = "model_avg"});
    }
  }
  return open_weights(run.weights);
}

MOTIONLANG_BODY RunFolder published_run(const RunFolder& run) {
  RunFolder out = run;
  if (run.system == "motionlang") {
    const FileValue* system = run.option("system");
    out.system = system == nullptr ? "" : to_string(*system);
    out.options = options_of_config(run);
  }
  if (out.system != "stmc" && out.system != "mdm" && out.system != "motiondiffuse")
    raise<io_error>(404, run.folder.string(), ": ",
                    out.system.empty() ? "of no system that is known" : "of " + out.system,
                    "; diffusion models are those of stmc, mdm and motiondiffuse");
  if (run.weights.empty())
    raise<io_error>(401, run.folder.string(), ": no checkpoint of ", out.system,
                    " (see weights/run_folder.hpp for its name)");
  return out;
}

MOTIONLANG_BODY TextEncoderOptions wanted_text_encoder(const RunFolder& run, const DiffusionRun& about) {
  if (about.text_encoder == "none")
    raise<io_error>(404, run.folder.string(),
                    ": a model without texts: actions and unconditional motions are not supported");
  if (about.text_encoder == "bert" && !about.mdm.text_sequence)
    raise<io_error>(404, run.folder.string(), ": texts of DistilBERT without a decoder (trans_dec)");
  const bool motiondiffuse = about.system == "motiondiffuse";
  return about.text_encoder == "bert" ? TextEncoderOptions{}
         : motiondiffuse              ? clip_states()
         : about.system == "mdm"      ? clip_sentences(22)
                                      : clip_sentences();
}

MOTIONLANG_BODY void require_text_encoder(const RunFolder& run, const DiffusionRun& about, const std::string& named,
                                          bool clip) {
  if (clip != (about.text_encoder == "clip"))
    raise<config_error>(102, run.folder.string(), ": needs ", about.text_encoder == "clip" ? "CLIP" : "DistilBERT",
                        " as its text encoder, ", named, " is ", clip ? "CLIP" : "of the BERT family");
}

}  // namespace detail

MOTIONLANG_BODY DiffusionRun diffusion_run(const RunFolder& run, const TensorSet& weights) {
  const detail::RunReader r = detail::reader_of(run, weights);
  DiffusionRun out;
  out.system = run.system;
  out.prefix = r.prefix();
  if (run.system == "stmc") {
    detail::read_stmc(out, r);
    if (const Index wanted = smplrifke_layout().size; out.width() != wanted)
      raise<io_error>(404, weights.name(), ": motions of ", counted(out.width(), "number"), " a frame, smplrifke has ",
                      wanted);
  } else {
    run.system == "mdm" ? detail::read_mdm(out, r) : detail::read_motiondiffuse(out, r);
    detail::read_representation(out, weights.name());
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_MODEL_FOLDER_HPP  // <motionlang/weights/model_folder.hpp>
#define MOTIONLANG_HAS_WEIGHTS_MODEL_FOLDER_HPP
/// Model folders of ours.
///
///     FOLDER/config.json            what the model is (below)
///     FOLDER/weights.safetensors    its tensors under their published names, and motion_normalizer.mean,
///                                   motion_normalizer.std
///     FOLDER/text_encoder/          if it has one of its own: as Hugging Face or OpenAI publish it
///                                   (weights/text_encoder_folder.hpp)
///
///     {"format": "motionlang", "version": 1, "system": "stmc",
///      "license": "MIT", "provenance": "trained on ...",
///      "features": "smplrifke", "fps": 20, "text_encoder": "clip",
///      "config": {...}}            hyperparameters under the names of the system's own options
///
/// Whoever writes a folder says what the weights may be used for and where they come from. Other members are kept as
/// they are.
/// Atomicity  the folder appears under its name when all of it is written

MOTIONLANG_NAMESPACE_BEGIN

struct ModelFolder {
  std::string system, license, provenance, features, text_encoder;
  double fps = 20;
  nlohmann::ordered_json config = nlohmann::ordered_json::object();
  // other members of config.json
  nlohmann::ordered_json others = nlohmann::ordered_json::object();
};

namespace detail {

inline constexpr const char *model_format = "motionlang", *model_config_file = "config.json",
                            *model_weights_file = "weights.safetensors";

}  // namespace detail

/// What a config.json says. `name` stands in messages.
/// Throws  io_error 403 if it is malformed, 404 for a newer version; config_error 103 for another format, 107 for a
///         member that is missing or of another kind, 101 for an impossible frame rate, always with both values
ModelFolder parse_model_config(std::string_view text, const std::string& name);

/// Throws io_error 401 if there is no config.json, and as parse_model_config.
ModelFolder read_model_folder(const FilePath& folder);

/// The text of config.json. Throws config_error 101 without a system, a licence or a provenance, 102 for invalid
/// `others`; io_error 403 for texts that are not UTF-8.
std::string model_config_text(const ModelFolder& m, const std::string& name = detail::model_config_file);

/// Writes a folder that is not there yet. text_encoder_files: copied into its text_encoder/.
/// Throws io_error 401 if there is one already or something cannot be written, and as model_config_text
void write_model_folder(const FilePath& path, const ModelFolder& model, std::span<const TensorView> tensors,
                        std::span<const std::filesystem::path> text_encoder_files = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_MODEL_FOLDER_IPP  // <motionlang/weights/model_folder.ipp>
#define MOTIONLANG_HAS_WEIGHTS_MODEL_FOLDER_IPP
// Bodies of model_folder.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr int model_version = 1;

inline constexpr std::string_view model_members[] = {"format",   "version", "system",       "license", "provenance",
                                                     "features", "fps",     "text_encoder", "config"};

inline bool is_model_member(std::string_view name) {
  return std::find(std::begin(model_members), std::end(model_members), name) != std::end(model_members);
}

}  // namespace detail

MOTIONLANG_BODY ModelFolder parse_model_config(std::string_view text, const std::string& name) {
  const auto document = parse_json(text, name);
  const JsonView view(document, name);
  if (const auto format = view["format"].as<std::string>(); format != detail::model_format)
    raise<config_error>(103, name, ": format is '", utf8_head(format, 80), "', expected '", detail::model_format, "'");
  if (const Index version = view.value_or("version", Index{1}); version != detail::model_version)
    raise<io_error>(404, name, ": version is ", version, ", known is ", detail::model_version);
  ModelFolder out;
  out.system = view["system"].as<std::string>();
  out.license = view.value_or("license", "");
  out.provenance = view.value_or("provenance", "");
  out.features = view.value_or("features", "");
  out.text_encoder = view.value_or("text_encoder", "");
  out.fps = view.value_or("fps", 20.0);
  if (!(out.fps > 0 && out.fps <= 1000)) raise<config_error>(101, name, ": fps is ", out.fps, ", not in (0, 1000]");
  if (!view["config"].is_object()) raise<config_error>(107, name, ": config: expected an object");
  out.config = nlohmann::ordered_json(view["config"].json());
  for (const std::string& key : view.keys()) {
    if (!detail::is_model_member(key)) out.others[key] = view[key].json();
  }
  return out;
}

MOTIONLANG_BODY ModelFolder read_model_folder(const FilePath& folder) {
  const std::string path = folder.inside(detail::model_config_file);
  return parse_model_config(read_file(path), path);
}

MOTIONLANG_BODY std::string model_config_text(const ModelFolder& m, const std::string& name) {
  for (const auto& [key, text] : {std::pair<const char*, const std::string&>{"system", m.system},
                                  {"license", m.license},
                                  {"provenance", m.provenance}}) {
    if (text.empty()) raise<config_error>(101, name, ": ", key, " is empty: who gets the model has to know it");
    if (!is_utf8(text)) raise<io_error>(403, name, ": ", key, " is not UTF-8");
  }
  nlohmann::ordered_json out{{"format", detail::model_format},
                             {"version", detail::model_version},
                             {"system", m.system},
                             {"license", m.license},
                             {"provenance", m.provenance},
                             {"features", m.features},
                             {"fps", m.fps},
                             {"text_encoder", m.text_encoder},
                             {"config", m.config}};
  for (const auto& [key, value] : m.others.items()) {
    if (detail::is_model_member(key))
      raise<config_error>(102, name, ": '", key, "' says what the model is, not something else");
    out[key] = value;
  }
  return out.dump(2) + "\n";
}

MOTIONLANG_BODY void write_model_folder(const FilePath& path, const ModelFolder& model,
                                        std::span<const TensorView> tensors,
                                        std::span<const std::filesystem::path> text_encoder_files) {
  namespace fs = std::filesystem;
  const std::string config = model_config_text(model, path.inside(detail::model_config_file));
  fs::path target = fs::path(path.string()).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  if (std::error_code ignored; fs::exists(target, ignored))
    raise<io_error>(401, path.string(), " is there already; another name, or remove it");
  const fs::path part = target.string() + ".part-" + std::to_string(::getpid());
  std::error_code problem;
  fs::remove_all(part, problem);  // of a run that was killed and had the same number
  problem.clear();
  const auto check = [&](const char* what) {
    if (!problem) return;
    const std::string reason = problem.message();
    fs::remove_all(part, problem);
    raise<io_error>(401, "cannot ", what, " ", path.string(), ": ", reason);
  };
  fs::create_directories(part, problem);
  check("make");
  const auto write = [&] {
    write_safetensors(part / detail::model_weights_file, tensors, {{"format", "motionlang"}});
    write_file(part / detail::model_config_file, std::string_view(config));
  };
  detail::guard_all(write, [&] {
    fs::remove_all(part, problem);
    return false;
  });
  if (!text_encoder_files.empty()) fs::create_directories(part / "text_encoder", problem);
  check("make text_encoder in");
  for (const fs::path& file : text_encoder_files) {
    fs::copy_file(file, part / "text_encoder" / file.filename(), problem);
    check("copy the text encoder to");
  }
  fs::rename(part, target, problem);
  check("rename to");
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct PackOptions {
  std::string license, provenance;
  DiffusionRunOptions sources{};
  bool text_encoder = false;  // copied into the folder
  FilePath tokenizer = "";    // of TM2T: the folder of its motion tokenizer, looked for beside the model unless given
};

namespace detail {

/// The options that `diffusion_run` reads, under the names that the systems give them.
nlohmann::ordered_json diffusion_options(const DiffusionRun& run);

/// The files of a text encoder that reading it takes. `weights`: not only those of its tokenizer.
std::vector<std::filesystem::path> text_encoder_files(const std::filesystem::path& path, bool weights = true);

/// Whether a tensor of the checkpoint belongs to the model: of what is beside it only CLIP's text tower.
bool is_packed(const std::string& name, const DiffusionRun& run);

/// Everything but the statistics. tensors: those of the statistics
void write_diffusion_folder(const FilePath& path, const RunFolder& run, const TensorSet& weights,
                            const DiffusionRun& about, std::vector<TensorView> tensors, const PackOptions& options);

}  // namespace detail

/// Throws what load_diffusion_run and write_model_folder throw.
template <Backend B>
void pack_diffusion_run(const RunFolder& given, const FilePath& path, const PackOptions& options) {
  const RunFolder run = detail::published_run(given);
  const WeightFile weights = detail::run_weights(run);
  const DiffusionRun about = diffusion_run(run, weights);
  const Normalizer<B> motion = detail::motion_normalizer<B>(run, weights, about.width(), options.sources);
  const auto text = detail::text_normalizer<B>(run, weights, about);
  TensorStore statistics;
  statistics.add_module(motion, "motion_normalizer.");
  if (text) statistics.add_module(*text, "text_normalizer.");
  detail::write_diffusion_folder(path, run, weights, about, statistics.views(), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_DIFFUSION_FOLDER_IPP  // <motionlang/weights/diffusion_folder.ipp>
#define MOTIONLANG_HAS_WEIGHTS_DIFFUSION_FOLDER_IPP
// Bodies of diffusion_folder.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY nlohmann::ordered_json diffusion_options(const DiffusionRun& run) {
  nlohmann::ordered_json out;
  if (run.system == "stmc") {
    const MdmSmplConfig& c = run.mdm_smpl;
    out["data"]["motion_loader"] = {{"fps", run.fps}, {"nfeats", c.nfeats}};
    out["diffusion"] = {{"timesteps", run.steps}, {"prediction", "x"}};
    out["diffusion"]["denoiser"] = {{"latent_dim", c.latent_dim},
                                    {"ff_size", c.ff_size},
                                    {"num_layers", c.num_layers},
                                    {"num_heads", c.num_heads},
                                    {"nb_registers", c.nb_registers},
                                    {"tx_dim", c.tx_dim},
                                    {"activation", std::string(to_string(c.activation))}};
  } else if (run.system == "mdm") {
    const MdmConfig& c = run.mdm;
    out = {{"arch", c.arch == MdmArch::gru         ? "gru"
                    : c.arch == MdmArch::trans_dec ? "trans_dec"
                                                   : "trans_enc"},
           {"latent_dim", c.latent_dim},
           {"layers", c.num_layers},
           {"emb_trans_dec", c.class_token != MdmClassToken::none},
           {"mask_frames", c.mask_frames},
           {"text_encoder_type", run.text_encoder},
           {"diffusion_steps", run.steps},
           {"noise_schedule", run.schedule}};
  } else {
    const MotionDiffuseConfig& c = run.motiondiffuse;
    out = {{"latent_dim", c.latent_dim},
           {"ff_size", c.ff_size},
           {"num_layers", c.num_layers},
           {"num_heads", c.num_heads},
           {"text_latent_dim", c.text_latent_dim},
           {"num_text_layers", c.num_text_layers},
           {"text_num_heads", c.text_num_heads},
           {"text_ff_size", c.text_ff_size},
           {"no_eff", c.no_eff},
           {"diffusion_steps", run.steps}};
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::filesystem::path> text_encoder_files(const std::filesystem::path& path, bool weights) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  const auto folder = is_folder ? path : path.parent_path();
  std::vector<std::filesystem::path> out;
  for (const char* name : {"config.json", "tokenizer.json", "tokenizer_config.json", "vocab.txt", "vocab.json",
                           "merges.txt", clip_vocabularies[0], clip_vocabularies[1]}) {
    if (file_exists(folder / name)) out.push_back(folder / name);
  }
  if (!is_folder) {
    out.push_back(path);
    return out;
  }
  if (!weights) return out;
  const RunFolder run = motionlang::find_run(path);
  if (!run.weights.empty()) out.push_back(run.weights);
  for (const auto& [part, file] : run.parts) out.push_back(file);
  if (run.weights.string().ends_with(".index.json")) {
    for (const auto& p : listed(folder)) {
      if (p.extension() == ".safetensors" || p.extension() == ".bin") out.push_back(p);
    }
  }
  return out;
}

MOTIONLANG_BODY bool is_packed(const std::string& name, const DiffusionRun& run) {
  if (name.starts_with("clip.")) return run.system == "motiondiffuse" && !name.starts_with("clip.visual.");
  return name.starts_with(run.prefix) && !is_beside(std::string_view(name).substr(run.prefix.size())) &&
         !begins_with_any(name, {"motion_normalizer.", "text_normalizer."});
}

MOTIONLANG_BODY void write_diffusion_folder(const FilePath& path, const RunFolder& run, const TensorSet& weights,
                                            const DiffusionRun& about, std::vector<TensorView> tensors,
                                            const PackOptions& options) {
  for (const TensorView& t : weights.tensors()) {
    if (is_packed(t.name, about)) tensors.push_back(t);
  }
  std::vector<std::filesystem::path> files;
  const std::string encoder = options.sources.text_encoder.string();
  if (options.text_encoder && about.system == "motiondiffuse" && encoder.empty())
    files = {clip_vocabulary_of(run.folder)};
  else if (options.text_encoder)
    files = text_encoder_files(encoder.empty() ? find_text_encoder(run.folder, about.text_encoder)
                                               : std::filesystem::path(encoder));
  ModelFolder model;
  model.system = about.system;
  model.license = options.license;
  model.provenance = options.provenance;
  model.features = about.features;
  model.text_encoder = about.text_encoder;
  model.fps = about.fps;
  model.config = diffusion_options(about);
  write_model_folder(path, model, tensors, files);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_EMBEDDING_CACHE_HPP  // <motionlang/weights/embedding_cache.hpp>
#define MOTIONLANG_HAS_WEIGHTS_EMBEDDING_CACHE_HPP
/// Embeddings of texts on disk, in the layout of TMR and STMC.
///
///     folder/<model>.npy          all rows of all texts, (rows, width), F32
///     folder/<model>_slice.npy    int64 (texts, 2): first row and one past the last; absent where every text has one
///                                 row and no slices are wanted (TMR's sent_embeddings)
///     folder/<model>_index.json   text -> its number
///
/// Folders    TMR: token_embeddings, sent_embeddings; STMC: text_embeddings, with slices
/// Model      "distilbert-base-uncased"; a slash makes a sub-folder ("ViT-B/32")
/// Texts      UTF-8, found by their exact characters; "" is a text like any other
/// Memory     rows are read where they lie in the file
/// Atomicity  every file is replaced as a whole, the index last, and none before all of them are made. Files of two
///            caches (a reader came in between, or the disk is full) are refused where their numbers of rows or texts
///            differ, and only there
/// Source     spec text-encoders.md, section 11

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// rows_of(text) -> the rows of the text, row-major.
template <Backend B, class F>
TextFeatures<B> features_of_rows(std::span<const std::string> texts, Index width, F rows_of) {
  std::vector<typename B::scalar> values;
  std::vector<Index> lengths;
  for (const std::string& t : texts) {
    const std::span<const float> rows = rows_of(t);
    values.insert(values.end(), rows.begin(), rows.end());
    lengths.push_back(static_cast<Index>(rows.size()) / std::max<Index>(1, width));
  }
  const Offsets offsets(lengths);
  return {{Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets}};
}

}  // namespace detail

class EmbeddingCache {
 public:
  /// Without texts.
  explicit EmbeddingCache(Index width) : width_(width) {}

  /// Throws io_error 401 if a file is missing, 403 if they do not fit each other, and what read_npy and read_json
  /// throw.
  static EmbeddingCache read(const FilePath& folder, const std::string& model);
  /// The same of files in memory; `base` stands in messages. The bytes of the rows have to outlive the cache unless
  /// `owner` keeps them.
  static EmbeddingCache from_bytes(std::span<const std::byte> row_file,
                                   std::optional<std::span<const std::byte>> slice_file, std::string_view index_text,
                                   const std::string& base, std::shared_ptr<const void> owner = nullptr);

  /// Makes the folder and those inside it that the name of the model asks for. Throws io_error 401; 403 if slices
  /// are not wanted and a text has another number of rows than one.
  void write(const FilePath& folder, const std::string& model, bool with_slices = true) const;

  /// Texts, and numbers of a row.
  Index count() const { return static_cast<Index>(slices_.size()); }
  Index width() const { return width_; }
  bool contains(const std::string& text) const { return number_.contains(text); }
  /// The rows of a text, row-major. Throws config_error 103 for a text that is not here.
  std::span<const float> find(const std::string& text) const;
  /// Adds a text; `values` are no rows of this cache itself. Throws shape_error 204 unless they are whole rows,
  /// config_error 102 for a text that is here already, io_error 403 for one that is not UTF-8: the index could not be
  /// written.
  void add(const std::string& text, std::span<const float> values);
  /// Adds those of the texts that are not here yet. Throws shape_error 204 if the encoder gives rows of another width,
  /// io_error 403 for a text that is not UTF-8, before anything is encoded.
  template <Backend B, TextEncoder<B> E>
  void add(const E& encoder, std::span<const std::string> texts) {
    std::vector<std::string> missing;
    std::unordered_map<std::string, bool> seen;
    for (const std::string& t : texts) {
      if (contains(t) || !seen.emplace(t, true).second) continue;
      check_utf8(t);
      missing.push_back(t);
    }
    if (missing.empty()) return;
    const TextFeatures<B> features = encoder.template encode<B>(std::span<const std::string>(missing));
    if (const Index width = features.tokens.width(); width != width_)
      raise<shape_error>(204, "embedding cache: an encoder with rows of ", counted(width, "number"),
                         ", here they have ", width_);
    for (std::size_t i = 0; i < missing.size(); ++i) {
      const auto rows = features.tokens[static_cast<Index>(i)].to_vector();
      add(missing[i], std::vector<float>(rows.begin(), rows.end()));
    }
  }

  /// The cache is a text encoder for the texts that it has. Throws config_error 103 for others.
  template <Backend B>
  TextFeatures<B> encode(std::span<const std::string> texts) const {
    return detail::features_of_rows<B>(texts, width_, [&](const std::string& t) { return find(t); });
  }

 private:
  struct Slice {
    Index begin, end;
  };

  static void check_utf8(const std::string& text);
  std::span<const float> rows() const { return is_view_ ? mapped_ : std::span<const float>(own_); }
  Index row_count() const { return width_ == 0 ? 0 : static_cast<Index>(rows().size()) / width_; }

  /// Rows as they are written above are a view of the file; any other array of numbers is converted.
  void read_rows(std::span<const std::byte> bytes, const std::string& path, std::shared_ptr<const void> owner);

  Index width_;
  std::vector<Slice> slices_;
  std::unordered_map<std::string, std::size_t> number_;
  std::vector<float> own_;
  std::span<const float> mapped_;
  bool is_view_ = false;
  std::shared_ptr<const void> owner_;
};

/// Takes texts from a cache and has the others encoded. Throws io_error 403 for a text that is not UTF-8.
template <class E>
struct CachedEncoder {
  EmbeddingCache cache;
  E encoder;

  template <Backend B>
  requires TextEncoder<E, B> TextFeatures<B> encode(std::span<const std::string> texts)
  const {
    EmbeddingCache others(cache.width());
    std::vector<std::string> unknown;
    for (const std::string& t : texts) {
      if (!cache.contains(t)) unknown.push_back(t);
    }
    others.add<B>(encoder, unknown);
    return detail::features_of_rows<B>(
        texts, cache.width(), [&](const std::string& t) { return cache.contains(t) ? cache.find(t) : others.find(t); });
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_EMBEDDING_CACHE_IPP  // <motionlang/weights/embedding_cache.ipp>
#define MOTIONLANG_HAS_WEIGHTS_EMBEDDING_CACHE_IPP
// Bodies of embedding_cache.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY EmbeddingCache EmbeddingCache::read(const FilePath& folder, const std::string& model) {
  const std::string base = folder.inside(model);
  const auto rows = MappedFile::open(base + ".npy"), index = MappedFile::open(base + "_index.json");
  std::shared_ptr<const MappedFile> slices;
  std::error_code ignored;
  if (const std::string path = base + "_slice.npy"; std::filesystem::exists(path, ignored))
    slices = MappedFile::open(path);
  return from_bytes(rows->bytes(), slices == nullptr ? std::nullopt : std::optional(slices->bytes()),
                    detail::as_text(index->bytes()), base, rows);
}

MOTIONLANG_BODY EmbeddingCache EmbeddingCache::from_bytes(std::span<const std::byte> row_file,
                                                          std::optional<std::span<const std::byte>> slice_file,
                                                          std::string_view index_text, const std::string& base,
                                                          std::shared_ptr<const void> owner) {
  const std::string slices = base + "_slice.npy", index = base + "_index.json";
  EmbeddingCache cache(0);
  cache.read_rows(row_file, base + ".npy", std::move(owner));
  const Index count = cache.row_count();
  if (slice_file) {
    const NpyArray array = parse_npy(*slice_file, slices);
    if (array.shape.size() != 2 || array.shape[1] != 2) raise<io_error>(403, slices, ": not pairs of rows");
    const auto bounds = array.to<std::int64_t>();
    for (std::size_t i = 0; i < bounds.size(); i += 2) {
      if (bounds[i] < 0 || bounds[i + 1] < bounds[i] || bounds[i + 1] > count)
        raise<io_error>(403, slices, ": text ", i / 2, " has the rows ", bounds[i], " ... ", bounds[i + 1], " of ",
                        count);
      cache.slices_.push_back({static_cast<Index>(bounds[i]), static_cast<Index>(bounds[i + 1])});
    }
  } else {
    for (Index i = 0; i < count; ++i) cache.slices_.push_back({i, i + 1});
  }
  std::vector<char> taken(cache.slices_.size(), false);
  const auto document = parse_json(index_text, index);
  for (const auto& [text, number] : JsonView(document, index).as<std::map<std::string, Index>>()) {
    if (number < 0 || number >= cache.count())
      raise<io_error>(403, index, ": '", text, "' has number ", number, " of ", cache.count());
    if (std::exchange(taken[static_cast<std::size_t>(number)], true))
      raise<io_error>(403, index, ": '", text, "' has number ", number, ", which another text has, too");
    cache.number_.emplace(text, static_cast<std::size_t>(number));
  }
  if (static_cast<Index>(cache.number_.size()) != cache.count())
    raise<io_error>(403, index, ": ", counted(cache.number_.size(), "text"), ", the rows are of ", cache.count());
  return cache;
}

MOTIONLANG_BODY void EmbeddingCache::write(const FilePath& folder, const std::string& model, bool with_slices) const {
  const std::string base = folder.inside(model);
  if (!folder.string().empty()) make_folder(folder.string());
  for (std::size_t from = 0, slash; (slash = model.find('/', from)) != model.npos; from = slash + 1)
    make_folder(folder.inside(model.substr(0, slash)));
  std::vector<std::int64_t> bounds;
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    const auto [begin, end] = slices_[i];
    if (!with_slices && (begin != static_cast<Index>(i) || end != begin + 1))
      raise<io_error>(403, base, ": text ", i, " has ", counted(end - begin, "row"),
                      "; without slices every text has one");
    bounds.insert(bounds.end(), {begin, end});
  }
  nlohmann::json numbers = nlohmann::json::object();
  for (const auto& [text, number] : number_) numbers[text] = number;
  const std::string index = numbers.dump();
  write_npy(base + ".npy", NpyArray::of(rows(), {row_count(), width_}));
  if (with_slices)
    write_npy(base + "_slice.npy", NpyArray::of(std::span<const std::int64_t>(bounds), {count(), 2}));
  else
    std::remove((base + "_slice.npy").c_str());  // of a cache that stood here before
  write_file(base + "_index.json", std::string_view(index));
}

MOTIONLANG_BODY std::span<const float> EmbeddingCache::find(const std::string& text) const {
  const auto found = number_.find(text);
  if (found == number_.end()) raise<config_error>(103, "embedding cache: no text '", text, "' among ", count());
  const auto [begin, end] = slices_[found->second];
  return rows().subspan(static_cast<std::size_t>(begin * width_), static_cast<std::size_t>((end - begin) * width_));
}

MOTIONLANG_BODY void EmbeddingCache::add(const std::string& text, std::span<const float> values) {
  if (width_ == 0 || values.size() % static_cast<std::size_t>(width_) != 0)
    raise<shape_error>(204, "embedding cache: ", counted(values.size(), "number"), " for rows of ", width_);
  if (contains(text)) raise<config_error>(102, "embedding cache: '", text, "' is there already");
  check_utf8(text);
  if (is_view_) {  // from here on in memory
    own_.assign(mapped_.begin(), mapped_.end());
    is_view_ = false;
    owner_.reset();
  }
  const Index begin = row_count();
  own_.insert(own_.end(), values.begin(), values.end());
  number_.emplace(text, slices_.size());
  slices_.push_back({begin, row_count()});
}

MOTIONLANG_BODY void EmbeddingCache::check_utf8(const std::string& text) {
  if (!is_utf8(text)) raise<io_error>(403, "embedding cache: the text '", text, "' is not UTF-8");
}

MOTIONLANG_BODY void EmbeddingCache::read_rows(std::span<const std::byte> bytes, const std::string& path,
                                               std::shared_ptr<const void> owner) {
  const auto npy = detail::npy_parts(bytes, path);
  const auto& shape = npy.header.shape;
  if (shape.size() != 2)
    raise<io_error>(403, path, ": ", counted(shape.size(), "axis", "axes"), ", expected rows of numbers");
  width_ = shape[1];
  const bool aligned = reinterpret_cast<std::uintptr_t>(npy.raw.data()) % alignof(float) == 0;
  if (npy.header.descr == "<f4" && !npy.header.fortran_order && aligned &&
      npy.raw.size() == detail::checked_size(shape, sizeof(float), path)) {
    is_view_ = true;
    owner_ = std::move(owner);
    mapped_ = {reinterpret_cast<const float*>(npy.raw.data()), npy.raw.size() / sizeof(float)};
  } else {
    own_ = parse_npy(bytes, path).to<float>();
  }
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_GLOVE_FILE_HPP  // <motionlang/weights/glove_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_GLOVE_FILE_HPP
/// The word vectors of the HumanML3D evaluators: three files with one stem ("our_vab").
///
///     stem_data.npy    (words, 300)
///     stem_words.pkl   list of words
///     stem_idx.pkl     word -> row
/// Source  spec text-encoders.md, section 6

MOTIONLANG_NAMESPACE_BEGIN

/// Throws io_error 401 to 407; 403 if the files do not fit each other.
GloVe read_glove(const FilePath& stem);

/// The three files.
/// Laws    read_glove of them has the same words in the same rows, and their vectors
/// Throws  io_error 401
void write_glove(const FilePath& stem, const GloVe& glove);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_GLOVE_FILE_IPP  // <motionlang/weights/glove_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_GLOVE_FILE_IPP
// Bodies of glove_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GloVe read_glove(const FilePath& stem) {
  const std::string& base = stem.string();
  const std::string data = base + "_data.npy", places = base + "_idx.pkl";
  const NpyArray array = read_npy(data);
  const Pickle words = Pickle::open(base + "_words.pkl"), index = Pickle::open(places);
  const PickleValue rows = index.root(), list = words.root();
  if (array.shape.size() != 2 || array.shape[0] != static_cast<Index>(list.size()) || rows.size() != list.size())
    raise<io_error>(403, data, ": not one row for each of ", counted(list.size(), "word"), ", of which ", places,
                    " has ", rows.size());
  std::vector<std::string> in_order(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::int64_t row = rows.value(i).integer();
    if (row < 0 || row >= static_cast<std::int64_t>(list.size()) || !in_order[static_cast<std::size_t>(row)].empty())
      rows.value(i).fail(403, "row ", row, " is not the one of a word among ", list.size());
    in_order[static_cast<std::size_t>(row)] = rows.key(i).text();
  }
  GloVe out(in_order, array.to<float>(), array.shape[1]);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (const std::string word(list[i].text()); !out.contains(word))
      list[i].fail(403, "the word '", word, "' has no row");
  }
  return out;
}

namespace detail {

/// A pickle of protocol 2: the list of the words, or a dictionary from each to its row.
inline std::string pickled_words(std::span<const std::string> words, bool rows) {
  std::string out = rows ? "\x80\x02}(" : "\x80\x02](";
  const auto number = [&](std::size_t n) {  // four bytes, the lowest first
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(n >> shift & 0xff);
  };
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += 'X';
    number(words[i].size());
    out += words[i];
    if (!rows) continue;
    out += 'J';
    number(i);
  }
  return out + (rows ? "u." : "e.");
}

}  // namespace detail

MOTIONLANG_BODY void write_glove(const FilePath& stem, const GloVe& glove) {
  const std::string& base = stem.string();
  const std::vector<std::string> words = glove.words();
  std::vector<float> vectors;
  for (const std::string& word : words) {
    const auto row = glove.vector(word);
    vectors.insert(vectors.end(), row.begin(), row.end());
  }
  write_npy(base + "_data.npy", NpyArray::of(std::span<const float>(vectors), {glove.size(), glove.width()}));
  write_file(base + "_words.pkl", std::string_view(detail::pickled_words(words, false)));
  write_file(base + "_idx.pkl", std::string_view(detail::pickled_words(words, true)));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_GUO_EVALUATOR_FILE_HPP  // <motionlang/weights/guo_evaluator_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_GUO_EVALUATOR_FILE_HPP
/// The published checkpoint of Guo's evaluator.
///
///     const auto evaluator = load_guo_evaluator<B>(open_weights("text_mot_match/model/finest.tar", {.path = ""}));
///
/// Source  Guo et al. (CVPR 2022), networks/evaluator_wrapper.py; spec evaluation-guo.md 2

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of the networks in a file, from the shapes of its tensors. Throws io_error 406, 407.
GuoEvaluatorConfig guo_evaluator_config(const TensorSet& file);

/// The networks, ready to run. States of optimisers beside them are passed over. Throws io_error 406, 407,
/// numeric_error 301.
template <Backend B>
GuoEvaluator<B> load_guo_evaluator(const TensorSet& file) {
  const auto room = detail::room_of(file);
  NoInit zeros;
  GuoEvaluator<B> networks(guo_evaluator_config(file), zeros);
  detail::load_run_module(networks, file, "", [](const std::string& name) { return name.starts_with("opt_"); });
  prepare(networks);
  return networks;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_GUO_EVALUATOR_FILE_IPP  // <motionlang/weights/guo_evaluator_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_GUO_EVALUATOR_FILE_IPP
// Bodies of guo_evaluator_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GuoEvaluatorConfig guo_evaluator_config(const TensorSet& file) {
  const RunFolder no_options{};
  const detail::RunReader t(no_options, file, "");
  const std::string movement = "movement_encoder.main.", text = "text_encoder.";
  return {.features = t.size(movement + "0.weight", 1) + 4,
          .movement_hidden = t.size(movement + "0.weight", 0),
          .movement_latent = t.size(movement + "3.weight", 0),
          .word = t.size(text + "pos_emb.weight", 0),
          .pos = t.size(text + "pos_emb.weight", 1),
          .text_hidden = t.size(text + "hidden", 2),
          .motion_hidden = t.size("motion_encoder.hidden", 2),
          .embedding = t.size(text + "output_net.3.weight", 0)};
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_MDM_ACTION_RUN_HPP  // <motionlang/weights/mdm_action_run.hpp>
#define MOTIONLANG_HAS_WEIGHTS_MDM_ACTION_RUN_HPP
/// MDM's models of actions (HumanAct12, UESTC), and of HumanAct12 without its actions (--unconstrained), from the
/// folders in which their repository leaves them.
///
///     const auto run = load_mdm_action_run<B>(find_run("save/humanact12/my_model"));      // args.json,
///     model000750000.pt const auto motions = run.model.generate(actions, Philox{.seed = 7});
///
/// Differs   from models of texts: motions are rotations in 6D and the way of the root, not normalised, of 60 frames; a
///           model that was trained without empty actions (cond_mask_prob 0, as the published command has it) is not
///           guided
/// Source    spec mdm.md 3, 3.1, 3.5
/// Throws    as weights/diffusion_run.hpp

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct MdmActionRun {
  MdmActions<B> model;
  ActorFeatureOptions features{};   // what a frame is made of
  std::vector<std::string> labels;  // of the classes; empty if they are numbers; "any" of an unconstrained model
  double fps = 20;                  // of the repository's videos; data have none
};

namespace detail {
inline constexpr ActorFeatureOptions mdm_action_features{
    .rotations = PoseRepresentation::rot6d, .translation = true, .global = true};
/// Throws io_error 404 if it is not a model of actions.
DiffusionRun mdm_action_sizes(const RunFolder& run, const TensorSet& weights, const RunReader& r);
}  // namespace detail

/// Whether a run folder is MDM's and of actions, or unconstrained.
bool is_mdm_action_run(const RunFolder& run);

template <Backend B>
MdmActionRun<B> load_mdm_action_run(const RunFolder& run) {
  const WeightFile weights = detail::run_weights(run);
  const detail::RunReader r = detail::reader_of(run, weights);
  const DiffusionRun about = detail::mdm_action_sizes(run, weights, r);
  const MdmConfig& c = about.mdm;
  const bool unconstrained = c.condition == MdmCondition::none;
  const auto room = detail::room_of(weights);
  NoInit zeros;
  MdmActionRun<B> out{
      .model = {.denoiser = MdmDenoiser<B>(c, zeros),
                .diffusion = about.diffusion(),
                .guidance = r.real("cond_mask_prob", 0.1) == 0 ? 1.0 : 2.5},
      .features = detail::mdm_action_features,
      .labels = unconstrained ? std::vector<std::string>{"any"} : action_labels(r.text("dataset", ""), c.num_actions)};
  detail::load_denoiser(out.model.denoiser, weights, r.prefix());
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_MDM_ACTION_RUN_IPP  // <motionlang/weights/mdm_action_run.ipp>
#define MOTIONLANG_HAS_WEIGHTS_MDM_ACTION_RUN_IPP
// Bodies of mdm_action_run.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool is_unconstrained_mdm(const RunFolder& run) {
  const FileValue *now = run.option("unconstrained"), *before = run.option("cond_mode");
  return now != nullptr ? to_string(*now) == "true" : before != nullptr && to_string(*before) == "no_cond";
}

MOTIONLANG_BODY DiffusionRun mdm_action_sizes(const RunFolder& run, const TensorSet& weights, const RunReader& r) {
  DiffusionRun about;
  about.system = "mdm";
  read_mdm(about, r);
  MdmConfig& c = about.mdm;
  if (const Index wanted = 25 * size(mdm_action_features.rotations); c.nfeats != wanted)
    raise<io_error>(404, weights.name(), ": motions of ", counted(c.nfeats, "number"),
                    " a frame; models of actions have ", wanted);
  const bool unconstrained = c.condition == MdmCondition::none;
  if (c.condition == MdmCondition::text || unconstrained != is_unconstrained_mdm(run))
    raise<io_error>(404, weights.name(), ": not a model of actions");
  if (unconstrained) c.num_actions = 1;
  c.crop_frames = r.number({"num_frames"}, 60, 10'000);
  return about;
}

}  // namespace detail

MOTIONLANG_BODY bool is_mdm_action_run(const RunFolder& run) {
  return run.system == "mdm" && !run.weights.empty() &&
         (detail::is_unconstrained_mdm(run) ||
          detail::prefix_of(detail::run_weights(run), "embed_action.action_embedding").has_value());
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_PACK_RUN_HPP  // <motionlang/weights/pack_run.hpp>
#define MOTIONLANG_HAS_WEIGHTS_PACK_RUN_HPP
/// The run folder of any published system as a model folder of ours: one file of weights with the statistics, licence,
/// provenance.
///
///     pack_run<B>(find_run("pretrained/temos"), "temos", {.license = "...", .provenance = "github.com/Mathux/TEMOS",
///                                                         .sources = {.statistics = "deps/.../kit-amass-xyz"}});
///     const auto temos = load_temos_run<B>("temos");            // as from the run itself
///
/// STMC, MDM and MotionDiffuse for texts as weights/diffusion_folder.hpp does it. ACTOR, TEMOS, TEACH, SINC, TMR, TM2T
/// and MDM for actions with all their options, under a config.json that says "published"; find_run knows such a folder
/// for one of the system.
/// Left out   what is not the model's: SMPL, losses, metrics, optimisers

#ifndef MOTIONLANG_HAS_WEIGHTS_TM2T_RUN_HPP  // <motionlang/weights/tm2t_run.hpp>
#define MOTIONLANG_HAS_WEIGHTS_TM2T_RUN_HPP
/// TM2T's models from texts to motions and from motions to texts from the folders in which its repository leaves them.
///
///     const auto run = load_tm2t_run<B>(find_run("checkpoints/t2m/T2M_Seq2Seq_NML1_Ear_SME0_N"));
///     const auto motions = run.model.generate(run.words.encode<B>(texts), Philox{.seed = 7});        // features
///     const auto other = load_tm2t_describer<B>(find_run("checkpoints/t2m/M2T_EL4_DL4_NH8_PS"));
///     const auto texts = other.model.describe(features, other.words);
///
/// Three places: the folder of the recurrent model or of the transformer (opt.txt, model/finest.tar); the one of the
/// motion tokenizer, beside it (its checkpoint, meta/mean.npy, meta/std.npy); the word vectors glove/our_vab_*, in one
/// of the folders above.
///
/// Sizes    from the shapes of the tensors; early or late attention, too, which the options have to agree with. The
///          number of heads from the options, 8 unless they say it
/// Differs  from the published program: `model` has what is in the folder and the tokenizer; the rest of it is empty
/// Source   spec tm2t.md 1, 2, 4.1, 5, 6
/// Throws   io_error 401 for what is missing, saying where it was looked for; 404 for another model; 406, 407 for
///          tensors; config_error 102 where the parts do not fit each other

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Tm2tRun {
  Tm2t<B> model;
  GloVe words;
  double fps = 20;

  Index width() const { return model.statistics.mean.size(0); }
};

struct Tm2tRunOptions {
  FilePath tokenizer = "";  // its folder; looked for beside the model unless given
  FilePath words = "";      // the folder with our_vab_data.npy; looked for in the folders above unless given
};

namespace detail {

WeightFile tm2t_weights(const RunFolder& run);

/// The folder that the options name, else the only one beside the model that has a tokenizer.
RunFolder tm2t_tokenizer_run(const RunFolder& run, const Tm2tRunOptions& options);

FilePath tm2t_words(const RunFolder& run, const Tm2tRunOptions& options);

MotionTokenizerConfig tm2t_tokenizer_config(const RunReader& r);

Seq2SeqGruConfig tm2t_gru_config(const RunReader& r);

Seq2SeqConfig tm2t_describer_config(const RunReader& r, const TensorSet& weights);

/// Those of the features, in the weights of a packed run or in the folder of the tokenizer. Throws io_error 401, 407.
template <Backend B>
Normalizer<B> tm2t_normalizer(const RunFolder& run, const TensorSet& weights, Index features) {
  return run_normalizer<B>(run, weights, features, {"meta.", ""},
                           "the motions: meta/mean.npy and meta/std.npy are missing");
}

}  // namespace detail

/// Whether a run folder holds the model from texts to motions, or the one from motions to texts.
bool is_tm2t_generator(const RunFolder& run);
bool is_tm2t_describer(const RunFolder& run);

/// The tokenizer alone, with its statistics, of its own folder or of a packed one.
template <Backend B>
Tm2t<B> load_tm2t_tokenizer(const RunFolder& run) {
  const WeightFile weights = detail::tm2t_weights(run);
  if (weights.find("quantizer.embedding.weight") == nullptr)
    raise<io_error>(404, weights.name(), ": not TM2T's motion tokenizer (vq_encoder, quantizer, vq_decoder)");
  const MotionTokenizerConfig config = detail::tm2t_tokenizer_config(detail::RunReader(run, weights, ""));
  Tm2t<B> out;
  const auto room = detail::room_of(weights);
  NoInit zeros;
  out.tokenizer = MotionTokenizer<B>(config, zeros);
  detail::load_run_module(
      out.tokenizer, weights, "",
      [](const std::string& name) {
        return !detail::begins_with_any(name, {"vq_encoder.", "quantizer.", "vq_decoder."});
      },
      LoadFor::inference);
  out.statistics = detail::tm2t_normalizer<B>(run, weights, config.features);
  out.statistics.eps = 0;
  return out;
}

namespace detail {

/// Everything but the model that the folder is named after, which knows so many symbols of motions.
template <Backend B>
Tm2tRun<B> tm2t_around(const RunFolder& run, const WeightFile& weights, Index symbols, const Tm2tRunOptions& options) {
  const RunFolder tokenizer_run = tm2t_tokenizer_run(run, options);
  Tm2tRun<B> out{.model = load_tm2t_tokenizer<B>(tokenizer_run), .words = read_glove(tm2t_words(run, options))};
  if (out.width() == 251) out.fps = 12.5;
  const MotionVocabulary vocabulary = out.model.vocabulary();
  if (symbols != vocabulary.size())
    raise<config_error>(102, weights.name(), ": has ", counted(symbols, "motion symbol"), ", ",
                        tokenizer_run.weights.string(), " has ", counted(vocabulary.codes, "code"), " and three marks");
  return out;
}

}  // namespace detail

template <Backend B>
Tm2tRun<B> load_tm2t_run(const RunFolder& run, const Tm2tRunOptions& options = {}) {
  const WeightFile weights = detail::tm2t_weights(run);
  const std::string prefix = "t2m_model.";
  const detail::RunReader r(run, weights, prefix);
  if (!r.has("motion_decoder_step.input_emb.weight"))
    raise<io_error>(404, weights.name(), ": not TM2T's recurrent model from texts to motions (t2m_model)");
  const Seq2SeqGruConfig gru = detail::tm2t_gru_config(r);
  auto out = detail::tm2t_around<B>(run, weights, gru.symbols, options);
  if (gru.word != out.words.width())
    raise<config_error>(102, weights.name(), ": reads word vectors of ", counted(gru.word, "number"),
                        ", those found have ", out.words.width());
  const auto room = detail::room_of(weights);
  NoInit zeros;
  out.model.t2m_model = Seq2SeqGru<B>(gru, zeros);
  detail::load_run_module(
      out.model.t2m_model, weights, prefix, [](const std::string&) { return false; }, LoadFor::inference);
  return out;
}

template <Backend B>
Tm2tRun<B> load_tm2t_describer(const RunFolder& run, const Tm2tRunOptions& options = {}) {
  const WeightFile weights = detail::tm2t_weights(run);
  const std::string prefix = "m2t_transformer.";
  const detail::RunReader r(run, weights, prefix);
  if (!r.has("encoder.src_word_emb.weight"))
    raise<io_error>(404, weights.name(), ": not TM2T's transformer from motions to texts (m2t_transformer)");
  const Seq2SeqConfig config = detail::tm2t_describer_config(r, weights);
  auto out = detail::tm2t_around<B>(run, weights, config.source_symbols, options);
  if (config.target_symbols != out.words.size() + 1)
    raise<config_error>(102, weights.name(), ": writes ", counted(config.target_symbols, "symbol"),
                        ", the words found are ", out.words.size(), " and one for padding");
  const auto room = detail::room_of(weights);
  NoInit zeros;
  out.model.m2t_transformer = Seq2SeqTransformer<B>(config, zeros);
  detail::load_run_module(
      out.model.m2t_transformer, weights, prefix, [](const std::string&) { return false; }, LoadFor::inference);
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_TM2T_RUN_IPP  // <motionlang/weights/tm2t_run.ipp>
#define MOTIONLANG_HAS_WEIGHTS_TM2T_RUN_IPP
// Bodies of tm2t_run.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY WeightFile tm2t_weights(const RunFolder& run) {
  if (run.system != "tm2t")
    raise<io_error>(404, run.folder.string(), ": ",
                    run.system.empty() ? "of no system that is known" : "of " + run.system, ", expected tm2t");
  if (run.weights.empty()) raise<io_error>(401, run.folder.string(), ": no model/finest.tar");
  return open_weights(run.weights, {.path = ""});
}

inline bool has_motion_tokenizer(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         tm2t_weights(run).find("quantizer.embedding.weight") != nullptr;
}

MOTIONLANG_BODY RunFolder tm2t_tokenizer_run(const RunFolder& run, const Tm2tRunOptions& options) {
  namespace fs = std::filesystem;
  if (!options.tokenizer.string().empty()) return motionlang::find_run(options.tokenizer);
  if (run.packed) return run;
  const fs::path around = folder_around(run.folder);
  std::vector<RunFolder> found;
  for (const fs::path& folder : listed(around.empty() ? fs::path(".") : around)) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) continue;
    RunFolder other = motionlang::find_run(folder);
    if (!has_motion_tokenizer(other)) continue;
    for (const char* key : {"tokenizer_name", "tokenizer_name_motion"}) {
      const FileValue* named = run.option(key);
      if (named != nullptr && to_string(*named) == folder.filename().string()) return other;
    }
    found.push_back(std::move(other));
  }
  if (found.size() == 1) return std::move(found.front());
  raise<io_error>(401, run.folder.string(), ": ", counted(found.size(), "folder"),
                  " with a motion tokenizer beside it (",
                  "VQVAEV3_CB1024_CMT_H1024_NRES3 as published): put it there, or name it");
}

MOTIONLANG_BODY FilePath tm2t_words(const RunFolder& run, const Tm2tRunOptions& options) {
  namespace fs = std::filesystem;
  std::vector<fs::path> places;
  if (!options.words.string().empty()) {
    places.emplace_back(options.words.string());
  } else {
    fs::path folder = fs::absolute(run.folder).lexically_normal();
    for (int up = 0; up < 5 && folder != folder.root_path(); ++up, folder = folder.parent_path()) {
      places.push_back(folder);
      places.push_back(folder / "glove");
      if (run.packed) places.push_back(folder / "text_encoder");
    }
  }
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (fs::is_regular_file(place / "our_vab_data.npy", ignored)) return place / "our_vab";
  }
  raise<io_error>(401, run.folder.string(),
                  ": no word vectors: put glove/our_vab_data.npy, our_vab_words.pkl and our_vab_idx.pkl "
                  "in a folder above, or name their folder");
}

MOTIONLANG_BODY MotionTokenizerConfig tm2t_tokenizer_config(const RunReader& r) {
  MotionTokenizerConfig c;
  c.channels.clear();
  const std::string encoder = "vq_encoder.main.", decoder = "vq_decoder.main.";
  for (Index i = 0; r.has(concat_text(encoder, i, ".weight"));
       i += 3)  // a convolution, its activation, a residual block
    c.channels.push_back(r.size(concat_text(encoder, i, ".weight"), 0));
  c.features = r.size(encoder + "0.weight", 1) + 4;
  c.codes = r.size("quantizer.embedding.weight", 0);
  c.residual_blocks = r.count(decoder, ".model.0.weight", {"n_resblk"});
  return c;
}

MOTIONLANG_BODY Seq2SeqGruConfig tm2t_gru_config(const RunReader& r) {
  const std::string step = "motion_decoder_step.";
  Seq2SeqGruConfig c{.word = r.size("text_encoder.input_emb.weight", 1),
                     .text_hidden = r.size("text_encoder.gru.weight_hh_l0", 1, {"dim_txt_hid"}),
                     .motion_hidden = r.size(step + "input_emb.weight", 1, {"dim_mot_hid"}),
                     .layers = r.count(step + "gru.", ".weight_ih", {"n_mot_layers"}),
                     .symbols = r.size(step + "input_emb.weight", 0),
                     .late = r.has(step + "att_linear.3.weight")};
  if (const std::string stated = r.one_of("early_or_late", c.late ? "late" : "early", {"early", "late"});
      (stated == "late") != c.late)
    raise<config_error>(102, r.place("early_or_late"), " is ", stated, ", the tensors are those of ",
                        c.late ? "late" : "early", " attention");
  return c;
}

MOTIONLANG_BODY Seq2SeqConfig tm2t_describer_config(const RunReader& r, const TensorSet& weights) {
  const std::string encoder = "encoder.layer_stack.", decoder = "decoder.layer_stack.",
                    target = "decoder.trg_word_emb.weight", projection = "trg_word_prj.weight";
  Seq2SeqConfig c{.source_symbols = r.size("encoder.src_word_emb.weight", 0),
                  .target_symbols = r.size(target, 0),
                  .d_model = r.size("encoder.src_word_emb.weight", 1, {"d_model"}),
                  .d_inner = r.size(encoder + "0.pos_ffn.w_1.weight", 0),
                  .heads = r.number({"n_head"}, 8, 4096),
                  .encoder_layers = r.count(encoder, ".slf_attn.w_qs.weight", {"n_enc_layers"}),
                  .decoder_layers = r.count(decoder, ".slf_attn.w_qs.weight", {"n_dec_layers"}),
                  .source_positions = r.size("encoder.position_enc.positional_encoding", 0),
                  .target_positions = r.size("decoder.position_enc.positional_encoding", 0)};
  if (r.has(projection)) {
    if (r.size(projection, 0) != c.target_symbols)
      raise<io_error>(404, weights.name(), ": writes ", counted(r.size(projection, 0), "word"),
                      " and reads vectors of ", counted(r.size(target, 1), "number"),
                      " (m2t_v3), which cannot write word by word");
    const auto numbers = [&](const std::string& name) { return values_of<float>(weights.tensor(r.prefix() + name)); };
    c.shared_projection = numbers(projection) == numbers(target);
  }
  const auto of_a_head = [&](const char* layer, const char* what) {
    const Index width = r.size(encoder + "0.slf_attn." + layer + ".weight", 0);
    if (width % c.heads != 0)
      raise<config_error>(102, r.place("n_head"), " is ", c.heads, ", ", weights.name(), " has ", what, " of ",
                          counted(width, "number"));
    return width / c.heads;
  };
  c.head_width = of_a_head("w_qs", "queries");
  c.value_width = of_a_head("w_vs", "values");
  return c;
}

}  // namespace detail

MOTIONLANG_BODY bool is_tm2t_generator(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         detail::tm2t_weights(run).find("t2m_model.motion_decoder_step.input_emb.weight") != nullptr;
}

MOTIONLANG_BODY bool is_tm2t_describer(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         detail::tm2t_weights(run).find("m2t_transformer.encoder.src_word_emb.weight") != nullptr;
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_VAE_RUN_HPP  // <motionlang/weights/vae_run.hpp>
#define MOTIONLANG_HAS_WEIGHTS_VAE_RUN_HPP
/// ACTOR, TEMOS, TEACH and SINC from the folders in which their repositories leave them.
///
///     const auto actor = load_actor_run<B>("exps/humanact12");                  // opt.yaml, checkpoint_5000.pth.tar
///     const auto temos = load_temos_run<B>("kit-amass-xyz/5xp9647f", {.text_encoder = "distilbert-base-uncased",
///                                                                     .statistics = "deps/.../kit-amass-xyz"});
///
/// Sizes    from the shapes of the tensors; options that state them have to agree. Heads and representation from the
///          options
/// ACTOR    all networks of its repository (weights/actor_file.hpp)
/// TEMOS, TEACH, SINC  with DistilBERT inside of the checkpoint; tokenizer and statistics are in no run folder. Their
/// folders look alike:
///          `lightning_system` tells them apart by their tensors
/// Source   spec actor.md 3, 8; temos.md 3, 4.4; teach.md 1, 2.4; sinc.md 1, 2.4
/// Throws   io_error 401 for a file that is missing, naming it; 404 for variants that are not supported; 406, 407 for
///          tensors; config_error 101, 102 where options and tensors differ, 103, 107

#ifndef MOTIONLANG_HAS_WEIGHTS_TEACH_SINC_FILE_HPP  // <motionlang/weights/teach_sinc_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_TEACH_SINC_FILE_HPP
/// TEACH and SINC from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto teach = load_teach<B>(open_weights("last.ckpt"), find_run(folder));
///     const auto sinc = load_sinc<B>(open_weights("last.ckpt"));
///
/// Heads    do not show in shapes: from the options of the run, else 4. The options ask for 6 under a misspelled name,
///          which the code passes over
/// Ignored  tables of positions, DistilBERT (textencoder.text_model.*), sums of losses, metrics, SINC's eval_model.*
/// Throws   as weights/text_motion_file.hpp
/// Source   spec teach.md 2.4, sinc.md 2.4

#ifndef MOTIONLANG_HAS_WEIGHTS_TEXT_MOTION_FILE_HPP  // <motionlang/weights/text_motion_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_TEXT_MOTION_FILE_HPP
/// TEMOS and TMR from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto tmr = load_tmr<B>(open_weights(folder), find_run(folder));   // last_weights/*.pt, or a .ckpt
///     const auto temos = load_temos<B>(open_weights("last.ckpt"));            // with statistics and texts:
///     weights/vae_run.hpp
///
/// Heads    do not show in shapes: from the options of the run, else 4, which is what both papers' models have. TEMOS'
///          options ask for 6 under a misspelled name, which its code passes over
/// Ignored  tables of positions, DistilBERT (textencoder.text_model.*), sums of losses and metrics, statistics
/// Throws   io_error 406, 407 if names or shapes do not match; numeric_error 301 for NaN and infinity;
///          config_error 101 if the heads do not divide the width, 102 where options and tensors differ, or the file is
///          too small for a network of its sizes
/// Source   spec temos.md 2, 3.1; tmr.md 3

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// What the configurations of TEMOS, TEACH and SINC have in common.
template <class Config>
Config temos_sizes(const RunReader& r) {
  const std::string stack = "textencoder.seqTransEncoder.layers.";
  Config c;
  c.nfeats = r.size("motiondecoder.final_layer.weight", 0);
  c.text_dim = r.size("textencoder.projection.1.weight", 1);
  c.latent_dim = r.size("textencoder.projection.1.weight", 0, {"model/latent_dim"});
  c.ff_size = r.size(stack + "0.linear1.weight", 0, {"model/ff_size"});
  c.num_layers = r.count(stack, ".linear1.weight", {"model/num_layers"});
  c.num_heads = r.number({"model/num_heads"}, 4, 1024);
  c.activation = parse_activation(r.one_of("model/activation", "gelu", {"gelu", "relu"}));
  return c;
}
TemosConfig temos_config(const RunReader& r);

TmrConfig tmr_config(const RunReader& r);

/// Tensors of a checkpoint that are not the model's.
bool beside_temos(const std::string& name);

}  // namespace detail

/// `run` has the options, if there are any.
template <Backend B>
Temos<B> load_temos(const TensorSet& file, const RunFolder& run = {}) {
  const TemosConfig config = detail::temos_config(detail::RunReader(run, file, ""));
  const auto room = detail::room_of(file);
  NoInit zeros;
  Temos<B> model(config, zeros);
  detail::load_run_module(model, file, "", detail::beside_temos);
  return model;
}
template <Backend B>
Tmr<B> load_tmr(const TensorSet& file, const RunFolder& run = {}) {
  const TmrConfig config = detail::tmr_config(detail::RunReader(run, file, ""));
  const auto room = detail::room_of(file);
  NoInit zeros;
  Tmr<B> model(config, zeros);
  detail::load_run_module(model, file, "", [](const std::string& name) {
    return name.ends_with(".pe") || detail::begins_with_any(name, {"stats.", "meta."});
  });
  return model;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_TEXT_MOTION_FILE_IPP  // <motionlang/weights/text_motion_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_TEXT_MOTION_FILE_IPP
// Bodies of text_motion_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY TemosConfig temos_config(const RunReader& r) {
  auto network = [&](const std::string& module, const char* transformer) {
    if (r.has(module + ".gru.weight_ih_l0")) return TemosNetwork::gru;
    return r.has(module + transformer) ? TemosNetwork::transformer : TemosNetwork::none;
  };
  auto c = temos_sizes<TemosConfig>(r);
  c.vae = r.has("textencoder.mu_token");
  c.motion_encoder = network("motionencoder", ".skel_embedding.weight");
  c.motion_decoder = network("motiondecoder", ".final_layer.weight");
  return c;
}

MOTIONLANG_BODY TmrConfig tmr_config(const RunReader& r) {
  const std::string stack = "motion_encoder.seqTransEncoder.layers.";
  return {.motion_nfeats = r.size("motion_encoder.projection.weight", 1, {"model/motion_encoder/nfeats"}),
          .text_nfeats = r.size("text_encoder.projection.weight", 1, {"model/text_encoder/nfeats"}),
          .latent_dim = r.size("motion_encoder.projection.weight", 0, {"model/motion_encoder/latent_dim"}),
          .ff_size = r.size(stack + "0.linear1.weight", 0, {"model/motion_encoder/ff_size"}),
          .num_layers = r.count(stack, ".linear1.weight", {"model/motion_encoder/num_layers"}),
          .num_heads = r.number({"model/motion_encoder/num_heads"}, 4, 1024),
          .activation = parse_activation(r.one_of("model/motion_encoder/activation", "gelu", {"gelu", "relu"})),
          .vae = r.size("motion_encoder.tokens", 0) == 2};
}

MOTIONLANG_BODY bool beside_temos(const std::string& name) {
  return name.ends_with("sequence_pos_encoding.pe") ||
         begins_with_any(name, {"textencoder.text_model.", "_losses.", "metrics.", "losses.", "motion_normalizer."});
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool beside_teach_and_sinc(const std::string& name) {
  return beside_temos(name) || name.starts_with("eval_model.");
}

}  // namespace detail

/// hist_frames and z_prev_text do not show in shapes: from the options of the run, else 5 and no.
template <Backend B>
Teach<B> load_teach(const TensorSet& file, const RunFolder& run = {}) {
  const detail::RunReader r(run, file, "");
  auto config = detail::temos_sizes<TeachConfig>(r);
  config.hist_frames = r.number({"model/hist_frames"}, config.hist_frames, 1024);
  config.z_prev_text = r.flag("model/z_prev_text", false);
  config.motion_encoder = r.has("motionencoder.mu_token");
  config.unused_encoder = r.has("textencoder.motionTransEncoder.layers.0.linear1.weight");
  const auto room = detail::room_of(file);
  NoInit zeros;
  Teach<B> model(config, zeros);
  detail::load_run_module(model, file, "", detail::beside_teach_and_sinc);
  return model;
}
/// mode: not to be seen in the tensors; released models take one sentence.
template <Backend B>
Sinc<B> load_sinc(const TensorSet& file, const RunFolder& run = {}, SincMode mode = SincMode::single) {
  const detail::RunReader r(run, file, "");
  auto config = detail::temos_sizes<SincConfig>(r);
  config.mode = mode;
  config.motion_encoder = r.has("motionencoder.mu_token");
  const auto room = detail::room_of(file);
  NoInit zeros;
  Sinc<B> model(config, zeros);
  detail::load_run_module(model, file, "", detail::beside_teach_and_sinc);
  return model;
}

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct ActorRun {
  Actor<B> model;
  ActorFeatureOptions features{};
  ActorPoints points = ActorPoints::vertices;  // that its loss compared
  ActorFrameOptions frames{};                  // of a clip that it learned from; how many: `longest`
  bool camera = true;                          // the figure stands on its head: Y down, as cameras have it
  Index longest = 60;                          // frames of motions that it learned from
  std::vector<std::string> labels;             // of the classes; empty if they are numbers
};

/// A model from texts to motions, with all that it needs.
template <Backend B, class Model>
struct TextMotionRun {
  Model model;
  Normalizer<B> normalizer;
  AnyTextEncoder<B> text_encoder;
  double fps = 12.5;

  Index width() const { return normalizer.mean.count(); }
};
template <Backend B>
using TemosRun = TextMotionRun<B, Temos<B>>;
template <Backend B>
using TeachRun = TextMotionRun<B, Teach<B>>;
template <Backend B>
using SincRun = TextMotionRun<B, Sinc<B>>;

struct TemosRunOptions {
  // folder of distilbert-base-uncased, or one with its tokenizer; looked for beside the model unless given
  FilePath text_encoder = "";
  FilePath statistics = "";  // folder with jfeats_mean.pt and jfeats_std.pt (rfeats_ of SMPL models)
};

namespace detail {

void require_checkpoint(const RunFolder& run, const char* system, const char* wanted);

/// Where its tokenizer is, or the whole text encoder. Throws io_error 401.
std::filesystem::path temos_text_folder(const RunFolder& run, const TemosRunOptions& options);

/// DistilBERT of the checkpoint with a tokenizer from elsewhere, or the whole encoder from elsewhere.
template <Backend B>
AnyTextEncoder<B> temos_text_encoder(const RunFolder& run, const TensorSet& weights, const TemosRunOptions& options) {
  const bool inside = weights.find("textencoder.text_model.embeddings.word_embeddings.weight") != nullptr;
  const std::filesystem::path folder = temos_text_folder(run, options);
  if (!inside) return load_text_encoder<B>(folder);
  AnyTokenizer tokenizer = tokenizer_of(folder, {}, false);
  RenamedTensors own(weights);  // the eval_model of older checkpoints of SINC has a DistilBERT as well
  for (const TensorView& t : weights.tensors()) {
    if (t.name.starts_with("textencoder.text_model.")) own.add(t, t.name);
  }
  AnyTextNetwork<B> network{load_text_network<DistilBert<B>>(distilbert_config(own), own)};
  check_vocabulary(tokenizer, network, folder.string());
  return {std::move(tokenizer), std::move(network), {}};
}

}  // namespace detail

template <Backend B>
ActorRun<B> load_actor_run(const RunFolder& run) {
  detail::require_checkpoint(run, "actor", "checkpoint_0000.pth.tar");
  const WeightFile weights = open_weights(run.weights);
  const detail::RunReader r(run, weights, "");
  ActorRun<B> out;
  out.model = load_actor<B>(weights, run);
  out.longest = actor_longest(run, weights, out.model.config);
  out.features = actor_point_options(run, weights).features;
  out.points = actor_loss_points(run, weights);
  out.frames = actor_frame_options(run, weights);
  const Index joints = 23 + (out.features.global ? 1 : 0) + (out.features.translation ? 1 : 0);
  if (out.model.config.njoints != joints)
    raise<config_error>(102, run.options_file.string(), ": glob and translation make ", counted(joints, "row"),
                        " a frame, ", weights.name(), " has ", out.model.config.njoints);
  out.labels = action_labels(r.text("dataset", ""), out.model.config.num_classes);
  prepare_loaded(out.model);
  return out;
}
template <Backend B>
ActorRun<B> load_actor_run(const FilePath& folder) {
  return load_actor_run<B>(find_run(folder));
}

/// "temos", "teach" or "sinc", by the token that stands between texts.
std::string lightning_system(const TensorSet& weights);

namespace detail {

/// Of the options' folder, else in the weights of a packed run, else of the run's. Throws io_error 401, 407.
template <Backend B>
Normalizer<B> temos_normalizer(const RunFolder& run, const TensorSet& weights, const TemosRunOptions& options) {
  const Index nfeats = RunReader(run, weights, "").size("motiondecoder.final_layer.weight", 0);
  return run_normalizer<B>(
      run, weights, nfeats, {"", "stats.", "motion_stats."},
      concat_text("the motions: put ",
                  nfeats == 135 ? "rfeats_mean.pt and rfeats_std.pt" : "jfeats_mean.pt and jfeats_std.pt",
                  " (deps/transforms/... of TEMOS) there, or name their folder"),
      options.statistics);
}

/// The statistics and the text encoder that belong to a model. eps: of the normalisation, backwards.
template <Backend B, class Model>
TextMotionRun<B, Model> text_motion_run(const RunFolder& run, const TensorSet& weights, Model model, double fps,
                                        double eps, const TemosRunOptions& options) {
  const RunReader r(run, weights, "");
  auto normalizer = temos_normalizer<B>(run, weights, options);
  normalizer.eps = eps;
  TextMotionRun<B, Model> out{.model = std::move(model),
                              .normalizer = std::move(normalizer),
                              .text_encoder = temos_text_encoder<B>(run, weights, options),
                              .fps = r.real("data/framerate", fps)};
  prepare_loaded(out.model);
  return out;
}
WeightFile lightning_weights(const RunFolder& run, const char* system);

}  // namespace detail

template <Backend B>
TemosRun<B> load_temos_run(const RunFolder& run, const TemosRunOptions& options = {}) {
  const WeightFile weights = detail::lightning_weights(run, "temos");
  return detail::text_motion_run<B>(run, weights, load_temos<B>(weights, run), 12.5, 0, options);
}
template <Backend B>
TeachRun<B> load_teach_run(const RunFolder& run, const TemosRunOptions& options = {}) {
  const WeightFile weights = detail::lightning_weights(run, "teach");
  return detail::text_motion_run<B>(run, weights, load_teach<B>(weights, run), 30, 0, options);
}
template <Backend B>
SincRun<B> load_sinc_run(const RunFolder& run, const TemosRunOptions& options = {}) {
  const WeightFile weights = detail::lightning_weights(run, "sinc");
  return detail::text_motion_run<B>(run, weights, load_sinc<B>(weights, run), 30, sinc_eps, options);
}
template <Backend B>
TemosRun<B> load_temos_run(const FilePath& folder, const TemosRunOptions& options = {}) {
  return load_temos_run<B>(find_run(folder), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_VAE_RUN_IPP  // <motionlang/weights/vae_run.ipp>
#define MOTIONLANG_HAS_WEIGHTS_VAE_RUN_IPP
// Bodies of vae_run.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_checkpoint(const RunFolder& run, const char* system, const char* wanted) {
  if (run.system != system)
    raise<io_error>(404, run.folder.string(), ": ",
                    run.system.empty() ? "of no system that is known" : "of " + run.system, ", expected ", system);
  if (run.weights.empty()) raise<io_error>(401, run.folder.string(), ": no ", wanted);
}

MOTIONLANG_BODY std::filesystem::path temos_text_folder(const RunFolder& run, const TemosRunOptions& options) {
  std::filesystem::path folder = options.text_encoder.string();
  for (const auto& near : {run.folder, folder_around(run.folder)}) {
    for (const char* name : {"", "text_encoder", "distilbert-base-uncased"}) {
      const bool found = file_exists(near / name / "tokenizer.json") || file_exists(near / name / "vocab.txt");
      if (folder.empty() && found) folder = near / name;
    }
  }
  if (folder.empty())
    raise<io_error>(401, run.folder.string(),
                    ": no tokenizer of DistilBERT: put vocab.txt or tokenizer.json of "
                    "distilbert-base-uncased there, or name its folder");
  return folder;
}

}  // namespace detail

MOTIONLANG_BODY std::string lightning_system(const TensorSet& weights) {
  if (weights.find("textencoder.seperation_token") != nullptr) return "teach";  // as published
  return weights.find("textencoder.separation_token") != nullptr ? "sinc" : "temos";
}

namespace detail {

MOTIONLANG_BODY WeightFile lightning_weights(const RunFolder& run, const char* system) {
  require_checkpoint(run, "temos", "checkpoints/last.ckpt");
  WeightFile weights = open_weights(run.weights);
  if (const std::string found = lightning_system(weights); found != system)
    raise<io_error>(404, weights.name(), ": a checkpoint of ", found, ", expected ", system);
  return weights;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// What goes into the folder.
struct PackedFiles {
  ModelFolder model{};
  std::vector<WeightFile> weights{};  // with different names
  std::vector<std::filesystem::path> text_encoder{};
};
template <Backend B>
struct PackedParts : PackedFiles {
  std::optional<Normalizer<B>> statistics{};
};
/// tensors: those of the statistics
void write_packed(const FilePath& path, const RunFolder& run, PackedFiles& parts, std::vector<TensorView> tensors,
                  const PackOptions& options);

template <Backend B>
void add_lightning(PackedParts<B>& out, const RunFolder& run, const PackOptions& options) {
  require_checkpoint(run, "temos", "checkpoints/last.ckpt");
  const TensorSet& weights = out.weights.emplace_back(open_weights(run.weights));
  const TemosRunOptions sources{.text_encoder = options.sources.text_encoder, .statistics = options.sources.statistics};
  out.model.system = lightning_system(weights);
  out.model.fps = RunReader(run, weights, "").real("data/framerate", out.model.system == "temos" ? 12.5 : 30);
  out.model.text_encoder = "distilbert";
  out.statistics = temos_normalizer<B>(run, weights, sources);
  const bool inside = weights.find("textencoder.text_model.embeddings.word_embeddings.weight") != nullptr;
  if (options.text_encoder) out.text_encoder = text_encoder_files(temos_text_folder(run, sources), !inside);
}

template <Backend B>
void add_tmr(PackedParts<B>& out, const RunFolder& run) {
  const TensorSet& weights = out.weights.emplace_back(open_weights(run.folder));
  if (weights.find("stats.mean") == nullptr || weights.find("stats.std") == nullptr)
    raise<io_error>(401, run.folder.string(), ": no statistics of the motions: stats/mean.pt and std.pt are missing");
  out.model.features = "guoh3dfeats";
  out.model.text_encoder = "distilbert";
}

template <Backend B>
void add_tm2t(PackedParts<B>& out, const RunFolder& run, const PackOptions& options) {
  const Tm2tRunOptions sources{.tokenizer = options.tokenizer, .words = options.sources.text_encoder};
  const RunFolder tokenizer_run = tm2t_tokenizer_run(run, sources);
  out.weights.push_back(tm2t_weights(run));
  if (!tokenizer_run.packed) out.weights.push_back(tm2t_weights(tokenizer_run));
  const TensorSet& weights = out.weights.back();
  const Index features = tm2t_tokenizer_config(RunReader(tokenizer_run, weights, "")).features;
  out.statistics = tm2t_normalizer<B>(tokenizer_run, weights, features);
  out.model.features = "guoh3dfeats";
  out.model.fps = features == 251 ? 12.5 : 20;
  if (!options.text_encoder) return;
  for (const char* end : {"_data.npy", "_words.pkl", "_idx.pkl"})
    out.text_encoder.emplace_back(tm2t_words(run, sources).string() + end);
}

}  // namespace detail

/// Throws what the readers of the system and write_model_folder throw; io_error 404 for a folder of none of them.
template <Backend B>
void pack_run(const RunFolder& run, const FilePath& path, const PackOptions& options) {
  detail::PackedParts<B> parts;
  parts.model.system = run.system;
  if (run.system == "actor") {
    detail::require_checkpoint(run, "actor", "checkpoint_0000.pth.tar");
    parts.weights.push_back(open_weights(run.weights));
  } else if (run.system == "temos") {
    detail::add_lightning(parts, run, options);
  } else if (run.system == "tmr") {
    detail::add_tmr(parts, run);
  } else if (is_tm2t_generator(run) || is_tm2t_describer(run)) {
    detail::add_tm2t(parts, run, options);
  } else if (is_mdm_action_run(run)) {
    parts.weights.push_back(detail::run_weights(run));
  } else {
    return pack_diffusion_run<B>(run, path, options);
  }
  TensorStore statistics;
  if (parts.statistics) statistics.add_module(*parts.statistics, "motion_normalizer.");
  detail::write_packed(path, run, parts, statistics.views(), options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_PACK_RUN_IPP  // <motionlang/weights/pack_run.ipp>
#define MOTIONLANG_HAS_WEIGHTS_PACK_RUN_IPP
// Bodies of pack_run.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool is_of_a_model(const std::string& name) {
  return !begins_with_any(name, {"rotation2xyz.", "rot2xyz.", "clip_model.", "_losses.", "losses.", "metrics.",
                                 "eval_model.", "opt_", "motion_normalizer."});
}

MOTIONLANG_BODY void write_packed(const FilePath& path, const RunFolder& run, PackedFiles& parts,
                                  std::vector<TensorView> tensors, const PackOptions& options) {
  parts.model.license = options.license;
  parts.model.provenance = options.provenance;
  parts.model.others["published"] = true;
  for (const FileValue& v : run.options) {  // "model/latent_dim": the reader makes the same path of it
    const auto* text = std::get_if<std::string>(&v.value);
    if (is_utf8(v.path) && (text == nullptr || is_utf8(*text)))
      std::visit([&](const auto& x) { parts.model.config[v.path] = x; }, v.value);
  }
  for (const WeightFile& file : parts.weights) {
    for (const TensorView& t : file.tensors()) {
      if (is_of_a_model(t.name)) tensors.push_back(t);
    }
  }
  write_model_folder(path, parts.model, tensors, parts.text_encoder);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_FILE_HPP  // <motionlang/weights/stmc_file.hpp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_FILE_HPP
/// An STMC model in one safetensors file: weights under their names, sizes and vocabulary in the metadata.
///
/// Metadata    model = "stmc", format = "1", denoiser.*, text.*, diffusion.*, features, fps; how the model should be
///             sampled: guidance and sampling ("ddpm 20": sampler and steps, all without a number); and, for people:
///             license, provenance, data, command, commit. Nothing in the file is executed.

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of a bundled model: everything that its constructor needs.
struct StmcModelConfig {
  MdmSmplConfig denoiser{};
  CaptionEncoderConfig text{};
  Index diffusion_steps = 100;
  // What the model should be sampled with:
  NoiseScale noise_scale = NoiseScale::posterior_std;
  SamplingOptions::Sampler sampler = SamplingOptions::Sampler::ddpm;
  Index sampling_steps = 0;  // 0: all
  double guidance = 2.5;
  double fps = 20;
};

namespace detail {

using Metadata = std::map<std::string, std::string>;

template <class N>
N number_in_metadata(std::string_view text, const std::string& key, const std::string& file) {
  N value{};
  const auto [end, error] = detail::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    raise<config_error>(107, file, ": metadata '", key, "' = '", text, "' is not a number");
  }
  return value;
}
template <class N>
N metadata_number(const Metadata& metadata, const std::string& key, const std::string& file) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) raise<config_error>(107, file, ": metadata '", key, "' is missing");
  return number_in_metadata<N>(found->second, key, file);
}
std::string metadata_text(const Metadata& metadata, const std::string& key, const std::string& otherwise);
/// A size that a file may ask for: a hostile one must not make us allocate.
Index metadata_size(const Metadata& metadata, const std::string& key, Index largest, const std::string& file,
                    Index smallest = 1);

WordPiece metadata_vocabulary(const Metadata& metadata, const std::string& file);
/// What users say about a model or a record. Throws config_error 102 for a key that is there already.
void add_metadata(Metadata& metadata, const Metadata& about, std::string_view whose, const std::string& file);

}  // namespace detail

/// The sizes as metadata. `vocabulary` of the tokenizer. Throws config_error 101 for more steps of sampling than there
/// are.
std::map<std::string, std::string> stmc_metadata(const StmcModelConfig& c, const WordPiece& tokenizer);
/// The sizes that a file declares. Throws config_error 101, 103, 107.
StmcModelConfig stmc_config(const SafetensorsFile& file);

/// A model of the given sizes. `rng` draws the parameters; NoInit leaves them zero.
template <Backend B>
Stmc<B> make_stmc(const StmcModelConfig& c, WordPiece tokenizer, Rng auto rng) {
  auto denoiser_rng = rng.split("denoiser");
  auto text_rng = rng.split("text");
  return {.denoiser = MdmSmplDenoiser<B>(c.denoiser, denoiser_rng),
          .text_encoder = CaptionEncoder<B>(c.text, std::move(tokenizer), text_rng),
          .motion_normalizer = Normalizer<B>::identity(c.denoiser.nfeats),
          .text_normalizer = Normalizer<B>::identity(c.denoiser.tx_dim),
          .diffusion = GaussianDiffusion(CosineSchedule{.steps = c.diffusion_steps}),
          .layout = smplrifke_layout(),
          .guidance = c.guidance,
          .sampling = {.sampler = c.sampler, .noise_scale = c.noise_scale},
          .steps = c.sampling_steps,
          .fps = c.fps};
}

/// Compares the tensors that decide how large a model is with its sizes, before memory is taken for what the metadata
/// claim. Throws io_error 406, 407.
void check_sizes(const SafetensorsFile& file, const StmcModelConfig& c, Index vocabulary);

/// Reads a model and makes it ready for inference. Throws io_error 401 ... 407, config_error 101, 103, 107,
/// numeric_error 301.
template <Backend B>
Stmc<B> load_stmc(const SafetensorsFile& file) {
  const StmcModelConfig c = stmc_config(file);
  WordPiece tokenizer = detail::metadata_vocabulary(file.metadata(), file.name());
  check_sizes(file, c, tokenizer.size());
  Stmc<B> model = make_stmc<B>(c, std::move(tokenizer), NoInit{});
  load_module(model, file, "", LoadFor::inference);
  return model;
}
template <Backend B>
Stmc<B> load_stmc(const FilePath& path) {
  return load_stmc<B>(SafetensorsFile::open(path));
}

/// Writes a model. `about` is added to the metadata: license, provenance, data, command, commit. Throws io_error 401,
/// config_error 102 if `about` would change what the model is.
template <Backend B>
void save_stmc(const FilePath& path, const Stmc<B>& model, const StmcModelConfig& config,
               const std::map<std::string, std::string>& about, DType dtype = DType::F16) {
  TensorStore store;
  store.add_module(model, "", dtype);
  auto metadata = stmc_metadata(config, model.text_encoder.tokenizer);
  detail::add_metadata(metadata, about, "model", path.string());
  write_safetensors(path, store.views(), metadata);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_FILE_IPP  // <motionlang/weights/stmc_file.ipp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_FILE_IPP
// Bodies of stmc_file.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string metadata_text(const Metadata& metadata, const std::string& key,
                                          const std::string& otherwise) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? otherwise : found->second;
}

MOTIONLANG_BODY Index metadata_size(const Metadata& metadata, const std::string& key, Index largest,
                                    const std::string& file, Index smallest) {
  const auto n = metadata_number<Index>(metadata, key, file);
  if (n < smallest || n > largest)
    raise<config_error>(101, file, ": metadata '", key, "' = ", n, " is not in ", smallest, " ... ", largest);
  return n;
}

inline double metadata_real(const Metadata& metadata, const std::string& key, double least, double largest,
                            const std::string& file) {
  const auto x = metadata_number<double>(metadata, key, file);
  if (!(x >= least && x <= largest))
    raise<config_error>(101, file, ": metadata '", key, "' = ", x, " is not in ", least, " ... ", largest);
  return x;
}

/// "ddpm 20"; the number is left out for all steps.
inline std::string sampling_text(const StmcModelConfig& c) {
  const std::string_view sampler = to_string(c.sampler);
  return c.sampling_steps == 0 ? std::string(sampler) : concat_text(sampler, ' ', c.sampling_steps);
}

inline void check_sampling_steps(const StmcModelConfig& c, const std::string& where) {
  if (c.sampling_steps < 0 || c.sampling_steps > c.diffusion_steps)
    raise<config_error>(101, where, ": ", counted(c.sampling_steps, "step"), " of sampling, the process has ",
                        c.diffusion_steps);
}

inline void read_sampling(const Metadata& metadata, StmcModelConfig& c, const std::string& file) {
  const std::string wanted = metadata_text(metadata, "sampling", sampling_text({}));
  const std::size_t space = std::min(wanted.find(' '), wanted.size());
  c.sampler = parse_sampler(std::string_view(wanted).substr(0, space), file + ": metadata 'sampling':");
  if (space == wanted.size()) return;
  c.sampling_steps = number_in_metadata<Index>(std::string_view(wanted).substr(space + 1), "sampling", file);
  check_sampling_steps(c, file);
}

MOTIONLANG_BODY WordPiece metadata_vocabulary(const Metadata& metadata, const std::string& file) {
  const auto found = metadata.find("text.vocabulary");
  if (found == metadata.end()) raise<config_error>(107, file, ": metadata 'text.vocabulary' is missing");
  std::vector<std::string> pieces;
  for (std::size_t at = 0; at <= found->second.size();) {
    const std::size_t end = std::min(found->second.find('\n', at), found->second.size());
    pieces.push_back(found->second.substr(at, end - at));
    at = end + 1;
  }
  return WordPiece(std::move(pieces), file + ": metadata 'text.vocabulary'");
}

MOTIONLANG_BODY void add_metadata(Metadata& metadata, const Metadata& about, std::string_view whose,
                                  const std::string& file) {
  for (const auto& [key, value] : about) {
    if (!metadata.emplace(key, value).second)
      raise<config_error>(102, file, ": metadata '", key, "' belongs to the ", whose, " and cannot be given");
  }
}

}  // namespace detail

MOTIONLANG_BODY std::map<std::string, std::string> stmc_metadata(const StmcModelConfig& c, const WordPiece& tokenizer) {
  detail::check_sampling_steps(c, "stmc_metadata");
  std::string vocabulary;
  for (const std::string& piece : tokenizer.vocabulary()) vocabulary += (vocabulary.empty() ? "" : "\n") + piece;
  auto text = [](auto n) { return concat_text(n); };
  return {
      {"model", "stmc"},
      {"format", "1"},
      {"features", "smplrifke"},
      {"fps", text(c.fps)},
      {"denoiser.nfeats", text(c.denoiser.nfeats)},
      {"denoiser.latent_dim", text(c.denoiser.latent_dim)},
      {"denoiser.ff_size", text(c.denoiser.ff_size)},
      {"denoiser.num_layers", text(c.denoiser.num_layers)},
      {"denoiser.num_heads", text(c.denoiser.num_heads)},
      {"denoiser.nb_registers", text(c.denoiser.nb_registers)},
      {"denoiser.activation", std::string(to_string(c.denoiser.activation))},
      {"denoiser.max_len", text(c.denoiser.max_len)},
      {"text.width", text(c.text.width)},
      {"text.heads", text(c.text.heads)},
      {"text.d_ff", text(c.text.d_ff)},
      {"text.layers", text(c.text.layers)},
      {"text.out", text(c.text.out)},
      {"text.longest", text(c.text.longest)},
      {"text.vocabulary", vocabulary},
      {"diffusion.schedule", "cosine"},
      {"diffusion.steps", text(c.diffusion_steps)},
      {"diffusion.noise_scale", c.noise_scale == NoiseScale::posterior_std ? "posterior_std" : "posterior_variance"},
      {"sampling", detail::sampling_text(c)},
      {"guidance", text(c.guidance)}};
}

MOTIONLANG_BODY StmcModelConfig stmc_config(const SafetensorsFile& file) {
  const auto& m = file.metadata();
  const std::string& name = file.name();
  if (detail::metadata_text(m, "model", "") != "stmc" || detail::metadata_text(m, "format", "") != "1") {
    raise<config_error>(103, name, ": not an STMC model of format 1 (metadata 'model' and 'format')");
  }
  if (detail::metadata_text(m, "features", "") != "smplrifke" ||
      detail::metadata_text(m, "diffusion.schedule", "") != "cosine") {
    raise<config_error>(103, name, ": features '", detail::metadata_text(m, "features", ""), "' or schedule '",
                        detail::metadata_text(m, "diffusion.schedule", ""), "' is unknown");
  }
  const std::string scale = detail::metadata_text(m, "diffusion.noise_scale", "posterior_std");
  if (scale != "posterior_std" && scale != "posterior_variance")
    raise<config_error>(103, name, ": diffusion.noise_scale '", scale,
                        "' is neither posterior_std nor posterior_variance");
  auto size = [&](const std::string& key, Index largest) { return detail::metadata_size(m, key, largest, name); };
  auto size_or = [&](const std::string& key, Index largest, Index otherwise) {
    return m.contains(key) ? size(key, largest) : otherwise;
  };
  auto heads = [&](const std::string& key, Index width) {
    const Index n = size(key, 256);
    if (width % n != 0 || width % 2 != 0)
      raise<config_error>(101, name, ": ", key, " = ", n, " does not divide the even width ", width);
    return n;
  };
  StmcModelConfig c;
  c.denoiser.nfeats = size("denoiser.nfeats", 4096);
  if (const Index features = smplrifke_layout().size; c.denoiser.nfeats != features)
    raise<config_error>(101, name, ": denoiser.nfeats is ", c.denoiser.nfeats, ", smplrifke has ",
                        counted(features, "feature"));
  c.denoiser.latent_dim = size("denoiser.latent_dim", 8192);
  c.denoiser.ff_size = size("denoiser.ff_size", 32768);
  c.denoiser.num_layers = size("denoiser.num_layers", 256);
  c.denoiser.num_heads = heads("denoiser.num_heads", c.denoiser.latent_dim);
  c.denoiser.nb_registers = detail::metadata_size(m, "denoiser.nb_registers", 256, name, 0);
  c.text.width = size("text.width", 8192);
  c.text.heads = heads("text.heads", c.text.width);
  c.text.d_ff = size("text.d_ff", 32768);
  c.text.layers = size("text.layers", 256);
  c.text.out = c.denoiser.tx_dim = size("text.out", 8192);
  const std::string activation = detail::metadata_text(m, "denoiser.activation", "gelu");
  if (activation != "gelu" && activation != "relu")
    raise<config_error>(103, name, ": denoiser.activation '", activation, "' is neither gelu nor relu");
  c.denoiser.activation = parse_activation(activation);
  c.denoiser.max_len = size_or("denoiser.max_len", 8192, c.denoiser.max_len);
  c.text.longest = size_or("text.longest", 8192, c.text.longest);
  c.diffusion_steps = size("diffusion.steps", c.denoiser.max_len);  // a row of the table of positions tells the step
  c.fps = detail::metadata_real(m, "fps", 1, 1000, name);
  c.guidance = detail::metadata_real(m, "guidance", 0, 1000, name);
  c.noise_scale = scale == "posterior_std" ? NoiseScale::posterior_std : NoiseScale::posterior_variance;
  detail::read_sampling(m, c, name);
  return c;
}

MOTIONLANG_BODY void check_sizes(const SafetensorsFile& file, const StmcModelConfig& c, Index vocabulary) {
  auto expect = [&](const std::string& name, const Shape& shape) {
    if (const FileShape& found = file.tensor(name).shape; found != shape)
      raise<io_error>(407, file.name(), ": tensor '", name, "' is ", found, ", the metadata say ", shape);
  };
  auto transformer = [&](const std::string& prefix, Index layers, Index width, Index d_ff) {
    for (Index i = 0; i < layers; ++i) {
      const std::string layer = concat_text(prefix, ".layers.", i);
      expect(layer + ".self_attn.in_proj_weight", {3 * width, width});
      expect(layer + ".linear1.weight", {d_ff, width});
    }
  };
  const MdmSmplConfig& d = c.denoiser;
  if (d.nb_registers > 0) expect("denoiser.registers", {d.nb_registers, d.latent_dim});
  expect("denoiser.skel_embedding.weight", {d.latent_dim, d.nfeats});
  expect("denoiser.tx_embedding.0.weight", {2 * d.latent_dim, d.tx_dim});
  transformer("denoiser.seqTransEncoder", d.num_layers, d.latent_dim, d.ff_size);
  expect("text_encoder.embedding.weight", {vocabulary, c.text.width});
  expect("text_encoder.projection.weight", {c.text.out, c.text.width});
  transformer("text_encoder.encoder", c.text.layers, c.text.width, c.text.d_ff);
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_HPP  // <motionlang/weights/stmc_record.hpp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_HPP
/// The record of an STMC run in one safetensors file, for edits in another process.
///
/// Metadata   record = "stmc", format = "1", model (a checksum of the weights), precision (core/precision.hpp), the
///            generator and the options of the run
/// Tensors    x0/000, x0/001, ... (timelines * rows, features), normalised; timeline/0, ... (texts, 3): first frame,
///            end, body parts as bits; their texts are metadata text/0/0, ...

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Of all numbers of a module and their scalar.
template <Module M>
std::string weights_checksum(const M& module) {
  std::uint64_t h = 0;
  for (const auto& t : tensors_of(module)) h = content_hash(std::as_bytes(t.span()), h);
  return hexadecimal(h);
}
/// "x0/007": names whose order is that of the numbers, below 1000.
std::string numbered_name(const char* what, std::size_t i);

/// What does not depend on the backend.
struct RecordAbout {
  std::vector<Timeline> timelines{};
  Philox rng{};
  StmcOptions options{};
  Index rows = 0;
  bool exact = true;
};
/// Guidance and sampling are set in the options. The timelines are put into the store.
Metadata record_metadata(const RecordAbout& run, const std::string& model, std::size_t steps, TensorStore& store);
/// model   the checksum of the weights that are to go on with it
RecordAbout read_record(const SafetensorsFile& file, const std::string& model, Index most_steps);

}  // namespace detail

/// `about` is added to the metadata. Throws io_error 401, config_error 102 if `about` would change what the record is.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
void save_stmc_record(const FilePath& path, const StmcRecord<B>& record, const Stmc<B, D, E>& stmc,
                      const std::map<std::string, std::string>& about = {}) {
  using S = typename B::scalar;
  detail::RecordAbout run{record.timelines, record.rng, record.options, record.rows, record.exact};
  run.options.sampling = record.options.sampling.value_or(stmc.sampling);
  run.options.guidance = record.options.guidance.value_or(stmc.guidance);
  TensorStore store;
  auto metadata = detail::record_metadata(run, detail::weights_checksum(stmc), record.x0.size(), store);
  detail::add_metadata(metadata, about, "record", path.string());
  std::vector<TensorView> views = store.views();
  for (std::size_t k = 0; k < record.x0.size(); ++k) {
    views.push_back({.name = detail::numbered_name("x0", k),
                     .dtype = sizeof(S) == 4 ? DType::F32 : DType::F64,
                     .shape = record.x0[k].shape(),
                     .bytes = std::as_bytes(record.x0[k].span())});
  }
  write_safetensors(path, views, metadata);
}

/// Reads a record and compares it with the model that is to go on with it. Throws io_error 401 ... 407, config_error
/// 101, 102 (made with other weights or another precision), 103 (no record, or of an unknown sampler), 107.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
StmcRecord<B> load_stmc_record(const SafetensorsFile& file, const Stmc<B, D, E>& stmc) {
  detail::RecordAbout run = detail::read_record(file, detail::weights_checksum(stmc), stmc.diffusion.steps());
  const Shape shape{std::ssize(run.timelines) * run.rows, stmc.layout.size};
  StmcRecord<B> out{.timelines = std::move(run.timelines),
                    .rng = run.rng,
                    .options = run.options,
                    .rows = run.rows,
                    .exact = run.exact};
  for (Index k = 0; k < *out.options.steps; ++k) {
    const TensorView& view = file.tensor(detail::numbered_name("x0", static_cast<std::size_t>(k)));
    if (view.shape != shape)
      raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", expected ", shape);
    out.x0.push_back(Tensor<B, 2>::from(values_of<typename B::scalar>(view), shape));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_IPP  // <motionlang/weights/stmc_record.ipp>
#define MOTIONLANG_HAS_WEIGHTS_STMC_RECORD_IPP
// Bodies of stmc_record.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string metadata_real_text(double x) {
  std::string out;
  append_python_float(out, x);
  return out;
}

MOTIONLANG_BODY std::string numbered_name(const char* what, std::size_t i) {
  const std::string digits = std::to_string(i);
  return concat_text(what, '/', digits.size() < 3 ? std::string(3 - digits.size(), '0') : "", digits);
}

inline Timeline record_timeline(const SafetensorsFile& file, std::size_t m, Index rows) {
  const TensorView& view = file.tensor(numbered_name("timeline", m));
  if (view.shape.rank() != 2 || view.shape[1] != 3)
    raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", not (texts, 3)");
  const auto numbers = values_of<double>(view);
  Timeline out;
  for (std::size_t i = 0; 3 * i < numbers.size(); ++i) {
    const auto number = [&](std::size_t column, Index largest) {
      const double x = numbers[3 * i + column];
      if (!(x >= 0 && x <= static_cast<double>(largest)))
        raise<config_error>(101, file.name(), ": ", x, " in tensor '", view.name, "' is not in 0 ... ", largest);
      return static_cast<Index>(x);
    };
    const auto text = file.metadata().find(concat_text("text/", m, '/', i));
    if (text == file.metadata().end())
      raise<config_error>(107, file.name(), ": metadata 'text/", m, "/", i, "' is missing");
    out.intervals.push_back(
        {text->second, number(0, rows), number(1, rows), {static_cast<unsigned>(number(2, BodyParts::all().bits))}});
  }
  return out;
}

MOTIONLANG_BODY Metadata record_metadata(const RecordAbout& run, const std::string& model, std::size_t steps,
                                         TensorStore& store) {
  const StmcOptions& o = run.options;
  const SamplingOptions sampling = *o.sampling;
  auto text = [](auto value) { return std::to_string(value); };
  Metadata metadata{
      {"record", "stmc"},
      {"format", "1"},
      {"model", model},
      {"precision", precision_name(product_precision())},
      {"seed", text(run.rng.seed)},
      {"stream", text(run.rng.stream)},
      {"timelines", text(run.timelines.size())},
      {"steps", text(steps)},
      {"rows", text(run.rows)},
      {"exact", run.exact ? "1" : "0"},
      {"overlap", text(o.overlap)},
      {"guidance", metadata_real_text(*o.guidance)},
      {"sampler", std::string(to_string(sampling.sampler))},
      {"eta", metadata_real_text(sampling.eta)},
      {"noise_scale", sampling.noise_scale == NoiseScale::posterior_std ? "posterior_std" : "posterior_variance"},
      {"clip", sampling.clip ? "1" : "0"},
      {"gaps", o.gaps == Gaps::fill ? "fill" : "refuse"},
      {"hidden", o.hidden == HiddenTexts::refuse ? "refuse" : "ignore"}};
  for (std::size_t m = 0; m < run.timelines.size(); ++m) {
    std::vector<double> rows;
    for (const Interval& i : run.timelines[m].intervals) {
      metadata.emplace(concat_text("text/", m, '/', rows.size() / 3), i.text);
      for (const auto n : {i.start, i.end, static_cast<Index>(i.parts.bits)}) rows.push_back(static_cast<double>(n));
    }
    store.add<double>(numbered_name("timeline", m), {std::ssize(rows) / 3, 3}, rows, DType::F64);
  }
  return metadata;
}

MOTIONLANG_BODY RecordAbout read_record(const SafetensorsFile& file, const std::string& model, Index most_steps) {
  const auto& m = file.metadata();
  const std::string& name = file.name();
  const auto word = [&](const char* key) { return metadata_text(m, key, ""); };
  const auto whole = [&](const char* key) { return metadata_number<std::uint64_t>(m, key, name); };
  const auto real = [&](const char* key) { return metadata_number<double>(m, key, name); };
  if (word("record") != "stmc" || word("format") != "1")
    raise<config_error>(103, name, ": not a record of an STMC run of format 1 (metadata 'record' and 'format')");
  if (word("model") != model)
    raise<config_error>(
        102, name, ": made with weights of checksum ", word("model"), ", these have ", model,
        "; the checksum of the same weights is another in another scalar, which other backends may use");
  const std::string precision = precision_name(product_precision());
  if (word("precision") != precision)
    raise<config_error>(102, name, ": made with products in ", word("precision"), ", not ", precision);
  RecordAbout out{.rng = {.seed = whole("seed"), .stream = whole("stream")}};
  out.rows = metadata_size(m, "rows", latest_time, name);
  out.exact = word("exact") == "1";
  out.options = {.overlap = metadata_number<Index>(m, "overlap", name),
                 .guidance = real("guidance"),
                 .steps = metadata_size(m, "steps", most_steps, name),
                 .sampling = SamplingOptions{.sampler = parse_sampler(word("sampler"), name + ": metadata 'sampler':"),
                                             .eta = real("eta"),
                                             .clip = word("clip") == "1"},
                 .gaps = word("gaps") == "refuse" ? Gaps::refuse : Gaps::fill,
                 .hidden = word("hidden") == "ignore" ? HiddenTexts::ignore : HiddenTexts::refuse};
  if (word("noise_scale") == "posterior_std") out.options.sampling->noise_scale = NoiseScale::posterior_std;
  const Index timelines = metadata_size(m, "timelines", latest_time, name);
  for (Index i = 0; i < timelines; ++i) {
    out.timelines.push_back(record_timeline(file, static_cast<std::size_t>(i), out.rows));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_VIEW_BODY_VIEWER_HPP  // <motionlang/view/body_viewer.hpp>
#define MOTIONLANG_HAS_VIEW_BODY_VIEWER_HPP
/// A page that shows motions on the user's own body instead of the figure of cones (which a browser without WebGL still
/// shows). The page contains the surface at rest: whoever may not pass the body on may not pass the page on.

#ifndef MOTIONLANG_HAS_VIEW_VIEWER_HPP  // <motionlang/view/viewer.hpp>
#define MOTIONLANG_HAS_VIEW_VIEWER_HPP
/// A page in which motions can be watched: one HTML file without anything from outside, drawn with WebGL (or, where
/// that is missing, on a 2D canvas), with the texts of a timeline below the figure.

#ifndef MOTIONLANG_HAS_VIEW_TRACK_HPP  // <motionlang/view/track.hpp>
#define MOTIONLANG_HAS_VIEW_TRACK_HPP
/// A row of a timeline as pictures show it: a text, when it holds, and for which parts of the body.

MOTIONLANG_NAMESPACE_BEGIN

struct Track {
  std::string text;
  double start = 0, end = 0;         // seconds
  std::vector<std::string> parts{};  // names as in body_part_names; empty: the whole body
};

namespace detail {

void require_finite_times(const char* who, std::span<const Track> tracks);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_VIEW_TRACK_IPP  // <motionlang/view/track.ipp>
#define MOTIONLANG_HAS_VIEW_TRACK_IPP
// Bodies of track.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_finite_times(const char* who, std::span<const Track> tracks) {
  for (const Track& t : tracks) {
    if (!std::isfinite(t.start + t.end))
      raise<config_error>(101, who, ": track '", t.text, "' from ", t.start, " s to ", t.end, " s");
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

struct ViewerOptions {
  std::string title{};    // "": the name of the first motion
  std::string info{};     // a line beside it: model, seed, ...
  bool autoplay = false;  // start at once (never for readers who ask for less movement)
};

/// One of several motions of a page.
struct ViewerMotion {
  Motion motion;
  std::vector<Track> tracks{};
  std::string note{};  // shown beside ViewerOptions::info while this motion is chosen
};

namespace detail {

/// The page with the user's body instead of the figures. The motions are on the joints of the skeleton.
std::string body_viewer_page(std::span<const ViewerMotion> motions, const SkinnedMesh<std::uint16_t>& mesh,
                             const Skeleton& skeleton, const ViewerOptions& options);

}  // namespace detail

/// The page as text.
/// tracks  rows below the figure; times in seconds from the start of the motion
/// Throws  config_error 101 without any motion or frame, or for times that are not finite; what Motion::validate
///         throws; numeric_error 301 for a place that single precision cannot hold
std::string viewer_html(const Motion& motion, std::span<const Track> tracks = {}, const ViewerOptions& options = {});
std::string viewer_html(std::span<const ViewerMotion> motions, const ViewerOptions& options = {});

/// Throws io_error 401, and what viewer_html throws.
void write_viewer(const FilePath& path, const Motion& motion, std::span<const Track> tracks = {},
                  const ViewerOptions& options = {});
/// Several motions, of which the reader chooses one.
void write_viewer(const FilePath& path, std::span<const ViewerMotion> motions, const ViewerOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_VIEW_VIEWER_IPP  // <motionlang/view/viewer.ipp>
#define MOTIONLANG_HAS_VIEW_VIEWER_IPP
// Bodies of viewer.hpp.

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_POSE_HPP  // <motionlang/formats/detail/figure_pose.hpp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_POSE_HPP
/// A figure in the pose of a frame: where its cones are, and the floor on which it stands.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

struct ConeEnds {
  Vec3<double> from, to;
};

inline ConeEnds cone_ends(const JointTransforms<double>& world, const RoundCone& c) {
  const auto j = static_cast<std::size_t>(c.joint);
  return {world.position[j] + world.rotation[j] * c.from, world.position[j] + world.rotation[j] * c.to};
}

/// The floor under a body, and its highest point in all frames. The floor is where the lowest point of the body is in
/// most frames (the lower quartile): the tip of a foot that pushes off dips below it for a moment.
struct Heights {
  double floor = 0, high = std::numeric_limits<double>::lowest();
};
/// Throws numeric_error 301 for a place that single precision cannot hold, with which pages draw.
Heights heights(const Motion& motion, const Figure& figure);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_POSE_IPP  // <motionlang/formats/detail/figure_pose.ipp>
#define MOTIONLANG_HAS_FORMATS_DETAIL_FIGURE_POSE_IPP
// Bodies of figure_pose.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Heights heights(const Motion& motion, const Figure& figure) {
  const auto require_near = [&](const Vec3<double>& p, int joint, Index frame) {
    const double most = std::numeric_limits<float>::max();
    if (!(std::abs(p.x) <= most && std::abs(p.y) <= most && std::abs(p.z) <= most))
      raise<numeric_error>(301, "Motion '", motion.name, "': joint '", motion.skeleton.name(joint), "' of frame ",
                           frame, " or what hangs on it is at (", p.x, ", ", p.y, ", ", p.z, "), too far to be drawn");
  };
  Heights h;
  std::vector<double> lows;
  JointTransforms<double> world;
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    motion.world(frame, world);
    for (int j = 0; j < motion.skeleton.size(); ++j)
      require_near(world.position[static_cast<std::size_t>(j)], j, frame);
    double low = std::numeric_limits<double>::max();
    for (const RoundCone& c : figure.cones) {
      const auto [from, to] = cone_ends(world, c);
      require_near(from, c.joint, frame), require_near(to, c.joint, frame);
      low = std::min({low, from.y - c.radius_from, to.y - c.radius_to});
      h.high = std::max({h.high, from.y + c.radius_from, to.y + c.radius_to});
    }
    lows.push_back(low);
  }
  if (lows.empty()) return h;
  const std::size_t quarter = lows.size() / 4;
  h.floor = nth_smallest(std::move(lows), quarter);
  return h;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_VIEW_DETAIL_MARKUP_HPP  // <motionlang/view/detail/markup.hpp>
#define MOTIONLANG_HAS_VIEW_DETAIL_MARKUP_HPP
/// Text and numbers as they stand in SVG and HTML.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// UTF-8 in which nothing is markup: & < > " ' as entities, bytes that are not UTF-8 and characters that XML forbids as
/// U+FFFD.
std::string escape_markup(std::string_view text);

/// A number with a fixed count of decimals, without zeros at the end.
std::string fixed(double value, int decimals = 1);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_VIEW_DETAIL_MARKUP_IPP  // <motionlang/view/detail/markup.ipp>
#define MOTIONLANG_HAS_VIEW_DETAIL_MARKUP_IPP
// Bodies of markup.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Source  XML 1.0, production 2 (decode_utf8 gives no surrogates).
constexpr bool is_xml_character(char32_t c) {
  return c == '\t' || c == '\n' || (c >= 32 && c < 0xFFFE) || (c > 0xFFFF && c <= 0x10FFFF);
}

MOTIONLANG_BODY std::string escape_markup(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = decode_utf8(text, at);
    switch (c) {
      case U'&':
        out += "&amp;";
        break;
      case U'<':
        out += "&lt;";
        break;
      case U'>':
        out += "&gt;";
        break;
      case U'"':
        out += "&quot;";
        break;
      case U'\'':
        out += "&#39;";
        break;
      default:
        append_utf8(out, is_xml_character(c) ? c : U'\uFFFD');
    }
  }
  return out;
}

MOTIONLANG_BODY std::string fixed(double value, int decimals) {
  char digits[64];
  const auto end = detail::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals);
  if (end.ec != std::errc()) return "0";
  std::string out(digits, end.ptr);
  if (out.find('.') != std::string::npos) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_VIEW_DETAIL_VIEWER_PAGE_HPP  // <motionlang/view/detail/viewer_page.hpp>
#define MOTIONLANG_HAS_VIEW_DETAIL_VIEWER_PAGE_HPP
/// The source of the viewer's page: style, elements, program. viewer.hpp puts title and data between them. Plain HTML
/// and JavaScript without libraries; the page asks nothing of any network.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view viewer_style = R"page(
:root {
  color-scheme: light dark;
  --back: #f3f5f8; --panel: #ffffff; --text: #1d222b; --faint: #667081; --line: #d9dee6; --accent: #2676ba;
}
@media (prefers-color-scheme: dark) {
  :root {
    --back: #14171c; --panel: #1d2128; --text: #e6e9ef; --faint: #98a2b3; --line: #323945; --accent: #62aef0;
  }
}
* { box-sizing: border-box; }
html, body { height: 100%; margin: 0; }
body {
  display: flex; flex-direction: column; background: var(--back); color: var(--text);
  font: 14px/1.4 system-ui, -apple-system, "Segoe UI", sans-serif;
}
header { display: flex; flex-wrap: wrap; gap: 2px 16px; align-items: baseline; padding: 10px 16px 8px; }
h1 { font-size: 17px; margin: 0; }
#info { color: var(--faint); }
#stage { position: relative; flex: 1 1 auto; min-height: 220px; }
#view { position: absolute; inset: 0; width: 100%; height: 100%; touch-action: none; cursor: grab; }
#view:active { cursor: grabbing; }
#hint { position: absolute; right: 14px; bottom: 8px; color: var(--faint); font-size: 12px; pointer-events: none; }
footer { background: var(--panel); border-top: 1px solid var(--line); padding: 8px 16px 12px; }
#controls { display: flex; flex-wrap: wrap; gap: 8px; align-items: center; }
button, select {
  font: inherit; color: inherit; background: var(--back); border: 1px solid var(--line); border-radius: 7px;
  padding: 5px 10px; min-height: 32px;
}
#play { min-width: 84px; background: var(--accent); border-color: var(--accent); color: #fff; font-weight: 600; }
@media (prefers-color-scheme: dark) { #play { color: #10141a; } }
button[aria-pressed="true"] { border-color: var(--accent); box-shadow: inset 0 0 0 1px var(--accent); }
button:disabled { opacity: 0.45; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
#clock { font-variant-numeric: tabular-nums; margin-left: auto; }
#scrub { display: block; width: 100%; margin: 10px 0 4px; accent-color: var(--accent); height: 20px; }
#timeline { position: relative; max-height: 34vh; overflow-x: hidden; overflow-y: auto; cursor: pointer; }
#axis { position: relative; height: 16px; color: var(--faint); font-size: 11px; margin: 0 8px; }
#axis span { position: absolute; transform: translateX(-50%); }
#tracks { position: relative; margin: 0 8px; }
.track { position: relative; height: 28px; border-top: 1px solid var(--line); }
.bar {
  position: absolute; top: 2px; height: 23px; min-height: 0; padding: 0 0 0 7px; border: 0; border-radius: 4px;
  border-left: 4px solid var(--hue); text-align: left; white-space: nowrap; cursor: pointer; line-height: 23px;
  background: color-mix(in srgb, var(--hue) 22%, transparent);
}
.bar > span { display: inline-block; overflow: hidden; text-overflow: ellipsis; vertical-align: top; }
.bar.now { background: color-mix(in srgb, var(--hue) 48%, transparent); }
.bar.turned { direction: rtl; }
.bar.turned span { direction: ltr; unicode-bidi: embed; }
.bar small { color: var(--faint); margin: 0 6px; }
#cursor {
  position: absolute; top: 0; bottom: 0; width: 2px; margin-left: -1px; background: var(--accent); pointer-events: none;
}
)page";

inline constexpr std::string_view viewer_body = R"page(
<header><h1 id="title"></h1><span id="info"></span></header>
<main id="stage">
  <canvas id="view" tabindex="0" role="img" aria-label="Moving figure. Drag or use the arrow keys to turn it, plus and
minus to zoom."></canvas>
  <span id="hint">drag: turn &middot; wheel: zoom &middot; shift+drag: move &middot; space: play</span>
</main>
<footer>
  <div id="controls">
    <button id="play" type="button" aria-pressed="false">Play</button>
    <label id="choice" hidden>Motion <select id="motion"></select></label>
    <label>Speed <select id="speed">
      <option value="0.25">0.25&times;</option><option value="0.5">0.5&times;</option>
      <option value="1" selected>1&times;</option><option value="2">2&times;</option>
    </select></label>
    <button id="loop" type="button" aria-pressed="true">Loop</button>
    <button id="follow" type="button" aria-pressed="true">Follow</button>
    <button id="reset" type="button">Reset view</button>
    <span id="clock"></span>
  </div>
  <input id="scrub" type="range" min="0" step="any" value="0" aria-label="Time">
  <div id="timeline"><div id="axis" aria-hidden="true"></div><div id="tracks"><div id="cursor"></div></div></div>
</footer>
)page";

/// Poses: decoding, interpolation, forward kinematics. The camera.
inline constexpr std::string_view viewer_script_pose = R"page(
"use strict";
const page = JSON.parse(document.getElementById("data").textContent);
const element = (id) => document.getElementById(id);

// Vectors are arrays of three numbers, quaternions are [x, y, z, w], matrices are 16 numbers, column by column.
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => scale(a, 1 / Math.hypot(...a));
const mix = (a, b, t) => a + (b - a) * t;
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const turn = (q, v) => {  // q v q^-1
  const t = scale(cross(q, v), 2);
  return add(add(v, scale(t, q[3])), cross(q, t));
};
const compose = (a, b) => [
  a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
  a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
const multiply = (a, b) => {
  const m = new Float32Array(16);
  for (let c = 0; c < 4; ++c) {
    for (let r = 0; r < 4; ++r) {
      for (let k = 0; k < 4; ++k) m[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    }
  }
  return m;
};

/** One motion: root positions as float32, then local rotations as int16, joint fastest; unit = 32767. */
class Clip {
  constructor(source) {
    Object.assign(this, source);
    const bytes = Uint8Array.from(atob(source.data), (c) => c.charCodeAt(0));
    this.roots = new Float32Array(bytes.buffer, 0, 3 * this.frames);
    this.turns = new Int16Array(bytes.buffer, 12 * this.frames);
    this.seconds = (this.frames - 1) / this.fps;
  }
  rootAt(frame) { return Array.from(this.roots.subarray(3 * frame, 3 * frame + 3)); }
  rotation(frame, joint) {
    const at = 4 * (frame * this.parents.length + joint);
    return this.turns.subarray(at, at + 4);
  }
  /** Positions and rotations of all joints in the world; between two frames interpolated. */
  pose(time) {
    const exact = clamp(time * this.fps, 0, this.frames - 1), a = Math.floor(exact);
    const b = Math.min(a + 1, this.frames - 1), share = exact - a;
    const positions = [], rotations = [];
    this.parents.forEach((parent, joint) => {
      const p = this.rotation(a, joint), q = this.rotation(b, joint);
      const side = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3] < 0 ? -1 : 1;
      const raw = [0, 1, 2, 3].map((i) => mix(p[i], side * q[i], share)), size = Math.hypot(...raw) || 1;
      const local = raw.map((x) => x / size);
      if (parent < 0) {
        positions.push([0, 1, 2].map((i) => mix(this.roots[3 * a + i], this.roots[3 * b + i], share)));
        rotations.push(local);
      } else {
        positions.push(add(positions[parent], turn(rotations[parent], this.offsets[joint])));
        rotations.push(compose(rotations[parent], local));
      }
    });
    return { positions, rotations };
  }
  /** The cones of the figure in the world: ends, radii, side of the body. */
  shapes(pose) {
    return this.cones.map(([joint, fx, fy, fz, tx, ty, tz, radiusFrom, radiusTo, side]) => {
      const place = (v) => add(pose.positions[joint], turn(pose.rotations[joint], v));
      return { from: place([fx, fy, fz]), to: place([tx, ty, tz]), radiusFrom, radiusTo, side };
    });
  }
}

/** A body of the reader's own: a surface at rest, of which every vertex follows four joints. */
class Mesh {
  constructor({ positions, joints, weights, triangles, offsets, parents }) {
    const decode = (text, Type) => new Type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
    this.positions = decode(positions, Float32Array);
    this.joints = decode(joints, Uint16Array);
    this.weights = Float32Array.from(decode(weights, Uint16Array), (w) => w / 65535);
    this.triangles = decode(triangles, Uint32Array);
    this.rest = [];
    parents.forEach((p, joint) => this.rest.push(p < 0 ? offsets[joint] : add(this.rest[p], offsets[joint])));
    this.makeNormals();
    this.skinned = new Float32Array(2 * this.positions.length);  // position and normal of every vertex
  }
  makeNormals() {
    const at = (v) => Array.from(this.positions.subarray(3 * v, 3 * v + 3));
    this.normals = new Float32Array(this.positions.length);
    for (let i = 0; i < this.triangles.length; i += 3) {
      const corners = this.triangles.subarray(i, i + 3), [a, b, c] = Array.from(corners, at);
      const area = cross(sub(b, a), sub(c, a));
      for (const v of corners) for (let k = 0; k < 3; ++k) this.normals[3 * v + k] += area[k];
    }
  }
  /** The surface in a pose of its joints. */
  skin({ positions, rotations }) {
    const turns = rotations.flatMap((q) => [[1, 0, 0], [0, 1, 0], [0, 0, 1]].flatMap((axis) => turn(q, axis)));
    const moves = positions.flatMap((p, joint) => sub(p, turn(rotations[joint], this.rest[joint])));
    const m = new Float32Array(12), out = this.skinned;
    for (let v = 0; v < this.positions.length / 3; ++v) {
      m.fill(0);
      for (let k = 4 * v; k < 4 * v + 4; ++k) {
        const joint = this.joints[k], w = this.weights[k];
        if (w === 0) continue;
        for (let i = 0; i < 9; ++i) m[i] += w * turns[9 * joint + i];
        for (let i = 0; i < 3; ++i) m[9 + i] += w * moves[3 * joint + i];
      }
      const [x, y, z] = this.positions.subarray(3 * v, 3 * v + 3), [a, b, c] = this.normals.subarray(3 * v, 3 * v + 3);
      for (let i = 0; i < 3; ++i) {
        out[6 * v + i] = m[i] * x + m[3 + i] * y + m[6 + i] * z + m[9 + i];
        out[6 * v + 3 + i] = m[i] * a + m[3 + i] * b + m[6 + i] * c;
      }
    }
    return out;
  }
}

/** Looks at a point from a distance; angles in radians. */
class Camera {
  static fieldOfView = 0.6;
  reset(clip) {
    const facing = turn(clip.pose(0).rotations[0], [0, 0, 1]);
    this.yaw = Math.atan2(facing[0], facing[2]) + 0.6;
    this.pitch = 0.22;
    this.distance = 2.5 * clip.size;
    this.shift = [0, 0, 0];
    this.goal = [0, 0.5 * clip.size, 0];
  }
  /** Unit vectors: towards the viewer, to the right, upwards. */
  get axes() {
    const c = Math.cos(this.pitch);
    const back = [c * Math.sin(this.yaw), Math.sin(this.pitch), c * Math.cos(this.yaw)];
    const right = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
    return { back, right, up: cross(back, right) };
  }
  get target() { return add(this.goal, this.shift); }
  get eye() { return add(this.target, scale(this.axes.back, this.distance)); }
  /** Half heights of the picture per unit at distance 1; a narrow window shows the figure smaller. */
  focus(aspect) { return Math.min(1, 1.2 * aspect) / Math.tan(Camera.fieldOfView / 2); }
  matrix(aspect) {
    const { back, right, up } = this.axes, eye = this.eye;
    const f = this.focus(aspect), near = 0.02 * this.distance, far = 60 * this.distance;
    const view = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
                  -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
    const lens = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
                  0, 0, 2 * far * near / (near - far), 0];
    return multiply(lens, view);
  }
  orbit(dx, dy) {
    this.yaw -= 0.008 * dx;
    this.pitch = clamp(this.pitch + 0.006 * dy, -0.1, 1.5);
  }
  zoom(factor) { this.distance = clamp(this.distance * factor, 0.05, 500); }
  move(dx, dy, height) {
    const perPixel = 2 * this.distance * Math.tan(Camera.fieldOfView / 2) / height, { right, up } = this.axes;
    this.shift = add(this.shift, add(scale(right, -dx * perPixel), scale(up, dy * perPixel)));
  }
}

const palettes = {
  light: { back: [0.953, 0.961, 0.973], floor: [0.90, 0.915, 0.935], line: [0.74, 0.77, 0.81], shade: 0.42,
           sides: [[0.52, 0.57, 0.64], [0.92, 0.42, 0.20], [0.17, 0.49, 0.78]] },
  dark: { back: [0.078, 0.090, 0.110], floor: [0.13, 0.148, 0.175], line: [0.25, 0.28, 0.33], shade: 0.62,
          sides: [[0.60, 0.65, 0.73], [0.96, 0.50, 0.27], [0.30, 0.62, 0.92]] } };
)page";

/// Drawing with WebGL 2, and with a 2D canvas where that is missing.
inline constexpr std::string_view viewer_script_draw = R"page(
/** The surface of a round cone, spanned by the shader between two spheres; `Ring` runs from pole to pole. */
const coneShader = `#version 300 es
layout(location = 0) in vec2 surface;   // 0..1: first half, 1..2: second half; angle about the axis
layout(location = 1) in vec4 from;      // centre, radius
layout(location = 2) in vec4 to;
layout(location = 3) in vec3 colour;
uniform mat4 camera;
uniform vec4 shadow;  // x, z, half width of the shadow map, height of the floor; width 0: no shadow pass
uniform vec3 light;
out vec3 normal, world, tint;
void main() {
  vec3 bone = to.xyz - from.xyz;
  float size = length(bone);
  vec3 axis = size > 1e-6 ? bone / size : vec3(0, 1, 0);
  vec3 u = normalize(cross(axis, abs(axis.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0))), v = cross(axis, u);
  float seam = asin(clamp((from.w - to.w) / max(size, 1e-6), -1.0, 1.0)), pole = 1.5707963;
  bool start = surface.x <= 1.0;
  float latitude = start ? mix(-pole, seam, surface.x) : mix(seam, pole, surface.x - 1.0);
  normal = cos(latitude) * (cos(surface.y) * u + sin(surface.y) * v) + sin(latitude) * axis;
  world = start ? from.xyz + from.w * normal : to.xyz + to.w * normal;
  tint = colour;
  gl_Position = camera * vec4(world, 1);
  if (shadow.z > 0.0) {                 // along the light onto the floor
    vec2 at = world.xz - light.xz / light.y * (world.y - shadow.w);
    gl_Position = vec4((at - shadow.xy) / shadow.z, 0, 1);
  }
}`;
/** Vertices that are in their places already. */
const meshShader = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 direction;
uniform mat4 camera;
uniform vec4 shadow;                    // as above
uniform vec3 light, colour;
out vec3 normal, world, tint;
void main() {
  world = position;
  normal = direction;
  tint = colour;
  gl_Position = camera * vec4(world, 1);
  if (shadow.z > 0.0) {
    vec2 at = world.xz - light.xz / light.y * (world.y - shadow.w);
    gl_Position = vec4((at - shadow.xy) / shadow.z, 0, 1);
  }
}`;
const bodyShader = `#version 300 es
precision highp float;
in vec3 normal, world, tint;
uniform vec3 light, eye;
uniform vec4 shadow;
out vec4 result;
void main() {
  if (shadow.z > 0.0) {                 // dark where the body is near the floor, faint where it is high
    result = vec4(mix(0.45, 1.0, exp(-2.5 * max(world.y - shadow.w, 0.0))));
    return;
  }
  vec3 n = normalize(normal), view = normalize(eye - world);
  float key = max((dot(n, light) + 0.25) / 1.25, 0.0), sky = 0.5 + 0.5 * n.y;
  float rim = pow(1.0 - max(dot(n, view), 0.0), 3.0);
  float shine = pow(max(dot(n, normalize(light + view)), 0.0), 24.0);
  float head = max(dot(n, view), 0.0);
  vec3 c = tint * (mix(0.26, 0.44, sky) + 0.54 * key + 0.20 * head) + 0.10 * rim + 0.07 * shine;
  result = vec4(c, 1);
}`;
const floorShader = `#version 300 es
layout(location = 0) in vec2 corner;
uniform mat4 camera;
uniform vec4 place;                     // centre x, z, half width, height
out vec2 at;
void main() {
  at = place.xy + corner * place.z;
  gl_Position = camera * vec4(at.x, place.w, at.y, 1);
}`;
const gridShader = `#version 300 es
precision highp float;
in vec2 at;
uniform sampler2D shadowMap;
uniform vec4 place, shadow;
uniform vec3 back, ground, line;
uniform float shade;
out vec4 result;
float grid(float step) {
  vec2 g = at / step, d = abs(fract(g - 0.5) - 0.5) / fwidth(g);
  return 1.0 - min(min(d.x, d.y), 1.0);
}
void main() {
  vec3 c = mix(ground, line, max(grid(1.0), 0.28 * grid(0.25)));
  vec2 uv = (at - shadow.xy) / shadow.z * 0.5 + 0.5;
  float dark = 0.0;
  if (clamp(uv, 0.0, 1.0) == uv) {
    for (int i = 0; i < 8; ++i) {       // eight taps on two rings of a mipmap
      float a = 0.785398 * float(i), r = i % 2 == 0 ? 0.006 : 0.014;
      dark += textureLod(shadowMap, uv + r * vec2(cos(a), sin(a)), 2.0).r / 8.0;
    }
    float here = textureLod(shadowMap, uv, 1.0).r;  // sharp where the body touches the floor
    dark = mix(dark, max(dark, here), smoothstep(0.72, 0.95, here));
  }
  c *= 1.0 - shade * dark;
  float far = smoothstep(0.15, 1.0, length(at - place.xy) / place.z);
  result = vec4(mix(c, back, far), 1);
}`;

class GlRenderer {
  kind = "webgl2";
  constructor(canvas) {
    const gl = this.gl = canvas.getContext("webgl2", { antialias: true });
    if (!gl) throw new Error("no WebGL 2");
    this.cone = this.program(coneShader, bodyShader);
    this.floor = this.program(floorShader, gridShader);
    this.makeCone(20, 7);
    if (page.body) this.makeMesh(new Mesh(page.body));
    this.makeFloor();
    this.makeShadowMap(512);
  }
  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const at = new Map();
    return { program, at: (name) => at.has(name) ? at.get(name)
      : at.set(name, gl.getUniformLocation(program, name)).get(name) };
  }
  makeCone(around, rings) {
    const gl = this.gl, vertices = [], triangles = [];
    for (let ring = 0; ring <= 2 * rings + 1; ++ring) {
      const s = ring <= rings ? ring / rings : 1 + Math.max((ring - rings - 1) / rings, 1e-5);
      for (let k = 0; k <= around; ++k) {
        vertices.push(s, 2 * Math.PI * k / around);
        if (k === around || ring === 2 * rings + 1) continue;
        const a = ring * (around + 1) + k, b = a + around + 1;
        triangles.push(a, a + 1, b, a + 1, b + 1, b);
      }
    }
    this.coneCount = triangles.length;
    this.coneArray = gl.createVertexArray();
    gl.bindVertexArray(this.coneArray);
    this.fill(gl.ARRAY_BUFFER, new Float32Array(vertices));
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    this.fill(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(triangles));
    this.instances = this.fill(gl.ARRAY_BUFFER, new Float32Array(0));
    [[1, 4, 0], [2, 4, 16], [3, 3, 32]].forEach(([location, size, offset]) => {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, gl.FLOAT, false, 44, offset);
      gl.vertexAttribDivisor(location, 1);
    });
  }
  makeMesh(mesh) {
    const gl = this.gl;
    this.mesh = mesh;
    this.meshProgram = this.program(meshShader, bodyShader);
    this.meshArray = gl.createVertexArray();
    gl.bindVertexArray(this.meshArray);
    this.fill(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles);
    this.meshVertices = this.fill(gl.ARRAY_BUFFER, mesh.skinned);
    for (const location of [0, 1]) {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 24, 12 * location);
    }
  }
  makeFloor() {
    const gl = this.gl;
    this.floorArray = gl.createVertexArray();
    gl.bindVertexArray(this.floorArray);
    this.fill(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  }
  makeShadowMap(size) {
    const gl = this.gl;
    this.shadowSize = size;
    this.shadowMap = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.shadowMap);
    gl.texStorage2D(gl.TEXTURE_2D, 6, gl.RGBA8, size, size);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    this.shadowBuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowBuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.shadowMap, 0);
  }
  fill(target, data) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(target, buffer);
    gl.bufferData(target, data, gl.STATIC_DRAW);
    return buffer;
  }
  /** The mesh, or else so many cones. */
  drawFigure(count, uniforms) {
    const gl = this.gl, { program, at } = this.mesh ? this.meshProgram : this.cone;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("camera"), false, uniforms.camera);
    gl.uniform4fv(at("shadow"), uniforms.shadow);
    gl.uniform3fv(at("light"), uniforms.light);
    gl.uniform3fv(at("eye"), uniforms.eye);
    if (this.mesh) {
      gl.uniform3fv(at("colour"), uniforms.colour);
      gl.bindVertexArray(this.meshArray);
      gl.drawElements(gl.TRIANGLES, this.mesh.triangles.length, gl.UNSIGNED_INT, 0);
    } else {
      gl.bindVertexArray(this.coneArray);
      gl.drawElementsInstanced(gl.TRIANGLES, this.coneCount, gl.UNSIGNED_SHORT, 0, count);
    }
  }
  /** Brings the surface, or the cones, of this moment to the graphics card. */
  place({ shapes, pose, palette }) {
    const gl = this.gl;
    const data = this.mesh ? this.mesh.skin(pose) : new Float32Array(shapes.flatMap((s) =>
      [...s.from, s.radiusFrom, ...s.to, s.radiusTo, ...palette.sides[s.side]]));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.mesh ? this.meshVertices : this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
  }
  draw(scene) {
    const gl = this.gl, { shapes, camera, palette, clip, root, width, height } = scene;
    const light = unit([0.45, 1, 0.35]), reach = 1.3 * clip.size;
    const shadow = [root[0], root[2], reach, clip.floor], matrix = camera.matrix(width / height), eye = camera.eye;
    const colour = palette.sides[0];
    this.place(scene);

    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowBuffer);
    gl.viewport(0, 0, this.shadowSize, this.shadowSize);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.MAX);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    this.drawFigure(shapes.length, { camera: matrix, shadow, light, eye, colour });
    gl.bindTexture(gl.TEXTURE_2D, this.shadowMap);
    gl.generateMipmap(gl.TEXTURE_2D);

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(...palette.back, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { program, at } = this.floor, target = camera.target;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("camera"), false, matrix);
    gl.uniform4f(at("place"), target[0], target[2], 5 * camera.distance, clip.floor);
    gl.uniform4fv(at("shadow"), shadow);
    gl.uniform3fv(at("back"), palette.back);
    gl.uniform3fv(at("ground"), palette.floor);
    gl.uniform3fv(at("line"), palette.line);
    gl.uniform1f(at("shade"), palette.shade);
    gl.bindVertexArray(this.floorArray);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    this.drawFigure(shapes.length, { camera: matrix, shadow: [0, 0, 0, 0], light, eye, colour });
  }
}

/** The same picture without shading: cones as flat outlines, far ones first. */
class FlatRenderer {
  kind = "canvas";
  constructor(canvas) { this.context = canvas.getContext("2d"); }
  draw({ shapes, camera, palette, clip, root, width, height }) {
    const context = this.context, matrix = camera.matrix(width / height);
    const colour = (c) => `rgb(${c.map((x) => Math.round(255 * x)).join(" ")})`;
    const project = (p) => {
      const row = (r) => matrix[r] * p[0] + matrix[4 + r] * p[1] + matrix[8 + r] * p[2] + matrix[12 + r];
      const x = row(0), y = row(1), w = row(3);
      return { x: width * (0.5 + 0.5 * x / w), y: height * (0.5 - 0.5 * y / w), depth: w,
               scale: 0.5 * height * camera.focus(width / height) / w };
    };
    context.fillStyle = colour(palette.back);
    context.fillRect(0, 0, width, height);
    context.strokeStyle = colour(palette.line);
    context.lineWidth = 1;
    const middle = [Math.round(root[0]), Math.round(root[2])];
    for (let i = -6; i <= 6; ++i) {
      for (const [from, to] of [[[i, -6], [i, 6]], [[-6, i], [6, i]]]) {
        const a = project([middle[0] + from[0], clip.floor, middle[1] + from[1]]);
        const b = project([middle[0] + to[0], clip.floor, middle[1] + to[1]]);
        if (a.depth < 0.1 || b.depth < 0.1) continue;
        context.beginPath();
        context.moveTo(a.x, a.y);
        context.lineTo(b.x, b.y);
        context.stroke();
      }
    }
    const foot = project([root[0], clip.floor, root[2]]), spread = 0.24 * clip.size * foot.scale;
    context.fillStyle = "rgb(0 0 0 / 0.18)";
    context.beginPath();
    context.ellipse(foot.x, foot.y, spread, spread * Math.max(0.12, Math.sin(camera.pitch)), 0, 0, 2 * Math.PI);
    context.fill();

    const flat = shapes.map((s) => ({ a: project(s.from), b: project(s.to), s }))
      .filter(({ a, b }) => Math.min(a.depth, b.depth) > 0.05);
    flat.sort((f, g) => g.a.depth + g.b.depth - f.a.depth - f.b.depth);
    context.strokeStyle = colour(palette.back);
    for (const { a, b, s } of flat) {
      const ra = s.radiusFrom * a.scale, rb = s.radiusTo * b.scale;
      const axis = Math.atan2(b.y - a.y, b.x - a.x), distance = Math.hypot(b.x - a.x, b.y - a.y);
      const tangent = Math.acos(clamp((ra - rb) / Math.max(distance, 1e-9), -1, 1));
      context.fillStyle = colour(palette.sides[s.side]);
      context.beginPath();
      context.arc(a.x, a.y, ra, axis + tangent, axis - tangent);
      context.arc(b.x, b.y, rb, axis - tangent, axis + tangent);
      context.closePath();
      context.fill();
      context.stroke();
    }
  }
}
)page";

/// State, controls, timeline.
inline constexpr std::string_view viewer_script_control = R"page(
const clips = page.motions.map((m) => new Clip(m));
const camera = new Camera(), canvas = element("view");
const hues = ["#2b78c5", "#d0621c", "#2f9157", "#8a58c2", "#c0436d", "#97801b"];
const dark = matchMedia("(prefers-color-scheme: dark)");
let clip = clips[0], time = 0, playing = false, looping = true, following = true, speed = 1;
let scheduled = false, before = 0;
let pace = 16, quality = 1;  // milliseconds between frames, pixels drawn per pixel of the screen

let renderer;
try {
  renderer = new GlRenderer(canvas);
} catch (reason) {
  console.info("drawing without WebGL:", reason.message);
  const fresh = canvas.cloneNode();  // a canvas that was asked for WebGL has no 2D context
  if (!canvas.getContext("2d")) canvas.replaceWith(fresh);
  renderer = new FlatRenderer(element("view"));
}
const view = element("view");

const text = (tag, content, parent) => {
  const e = document.createElement(tag);
  e.textContent = content;
  parent.append(e);
  return e;
};
const shown = (seconds) => seconds.toFixed(2) + " s";

function seek(seconds) {
  time = clamp(seconds, 0, clip.seconds);
  refresh();
}
function play(on) {
  playing = on && clip.seconds > 0;
  if (playing && !looping && time >= clip.seconds) seek(0);
  element("play").textContent = playing ? "Pause" : "Play";
  element("play").setAttribute("aria-pressed", playing);
  before = performance.now();
  refresh();
}
function choose(number) {
  clip = clips[number];
  camera.reset(clip);
  element("scrub").max = clip.seconds || 1;
  element("play").disabled = element("scrub").disabled = clip.seconds === 0;
  element("info").textContent = [page.info, clip.note, `${clip.parents.length} joints`, `${clip.frames} frames`,
    `${+clip.fps.toFixed(3)} fps`].filter(Boolean).join(" \u00b7 ");
  buildTimeline();
  seek(0);
  if (playing) play(true);
}

function buildTimeline() {
  const axis = element("axis"), tracks = element("tracks"), length = clip.seconds || 1;
  axis.replaceChildren();
  tracks.replaceChildren(element("cursor"));
  element("timeline").hidden = clip.tracks.length === 0;
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60, 300].find((s) => length / s <= 12) || length / 10;
  for (let t = 0; t <= length + 1e-9; t += step) {
    text("span", +t.toFixed(1) + " s", axis).style.left = 100 * t / length + "%";
  }
  clip.tracks.forEach((track, i) => {
    const row = text("div", "", tracks), bar = text("button", "", row), label = text("span", track.text, bar);
    row.className = "track";
    bar.className = "bar";
    bar.type = "button";
    const from = clamp(track.start, 0, length), to = clamp(track.end, from, length);
    Object.assign(bar.style, { left: 100 * from / length + "%", width: 100 * (to - from) / length + "%" });
    bar.style.setProperty("--hue", hues[i % hues.length]);
    bar.title = [`${track.text}: ${shown(track.start)} to ${shown(track.end)}`, ...track.parts].join(", ");
    bar.setAttribute("aria-label", bar.title);
    if (track.parts.length) text("small", track.parts.join(" \u00b7 "), label);
    bar.addEventListener("click", (event) => { if (event.detail === 0) seek(track.start); });  // by keyboard
  });
  placeLabels();
}
/** A text that would run out of the picture ends at the right end of its bar instead, or is cut. */
function placeLabels() {
  const { left, right } = element("tracks").getBoundingClientRect();
  for (const bar of document.querySelectorAll(".bar")) {
    const label = bar.firstChild;
    bar.classList.remove("turned");
    label.style.maxWidth = "";
    const place = label.getBoundingClientRect(), overflows = place.right > right;
    if (overflows && bar.getBoundingClientRect().right - place.width > left) bar.classList.add("turned");
    else if (overflows) label.style.maxWidth = right - place.left + "px";
  }
}

function render() {
  const ratio = quality * Math.min(devicePixelRatio || 1, 2), width = Math.round(view.clientWidth * ratio);
  const height = Math.round(view.clientHeight * ratio), pose = clip.pose(time), root = pose.positions[0];
  if (!width || !height) return;
  if (view.width !== width || view.height !== height) Object.assign(view, { width, height });
  if (following) camera.goal = [root[0], clip.floor + 0.52 * clip.size, root[2]];
  const palette = palettes[dark.matches ? "dark" : "light"];
  renderer.draw({ shapes: clip.shapes(pose), pose, camera, palette, clip, root, width, height });

  element("scrub").value = time;
  element("clock").textContent = `${shown(time)} / ${shown(clip.seconds)} \u00b7 frame ${Math.round(time * clip.fps)}`;
  element("scrub").setAttribute("aria-valuetext", shown(time));
  element("cursor").style.left = 100 * time / (clip.seconds || 1) + "%";
  document.querySelectorAll(".bar").forEach((bar, i) =>
    bar.classList.toggle("now", clip.tracks[i].start <= time && time < clip.tracks[i].end));
}
/** Asks for one more frame; while the motion plays, every frame asks for the next. */
function refresh() {
  if (!scheduled) requestAnimationFrame(frame);
  scheduled = true;
}
function frame(now) {
  scheduled = false;
  if (playing) {
    time += speed * Math.max(0, now - before) / 1000;
    pace = mix(pace, now - before, 0.15);
    before = now;
    if (pace > 60 && quality > 0.5) [pace, quality] = [30, 0.8 * quality];  // slow to draw: coarser
    if (time > clip.seconds && looping) time %= clip.seconds;
    if (time > clip.seconds) seek(clip.seconds), play(false);
    refresh();
  }
  render();
}

// Buttons and keys.
const toggle = (id, change) => element(id).addEventListener("click", () => {
  const on = element(id).getAttribute("aria-pressed") !== "true";
  element(id).setAttribute("aria-pressed", on);
  change(on);
  refresh();
});
element("play").addEventListener("click", () => play(!playing));
toggle("loop", (on) => { looping = on; });
toggle("follow", (on) => { following = on; });
element("reset").addEventListener("click", () => { camera.reset(clip); refresh(); });
element("speed").addEventListener("change", (event) => { speed = +event.target.value; });
element("motion").addEventListener("change", (event) => { choose(+event.target.value); });
element("scrub").addEventListener("input", (event) => { seek(+event.target.value); });
element("timeline").addEventListener("pointerdown", (event) => {
  const area = element("tracks").getBoundingClientRect();
  const go = (e) => { seek(clip.seconds * (e.clientX - area.left) / area.width); };
  const stop = () => { removeEventListener("pointermove", go); removeEventListener("pointerup", stop); };
  go(event);
  addEventListener("pointermove", go);
  addEventListener("pointerup", stop);
});
const step = (frames) => { play(false); seek((Math.round(time * clip.fps) + frames) / clip.fps); };
const keys = {
  " ": () => play(!playing), ",": () => step(-1), ".": () => step(1),
  Home: () => seek(0), End: () => seek(clip.seconds),
  f: () => element("follow").click(), l: () => element("loop").click(), r: () => element("reset").click() };
const viewKeys = {
  ArrowLeft: () => camera.orbit(-20, 0), ArrowRight: () => camera.orbit(20, 0), ArrowUp: () => camera.orbit(0, 20),
  ArrowDown: () => camera.orbit(0, -20), "+": () => camera.zoom(0.9), "-": () => camera.zoom(1.1) };
const frameKeys = { ArrowLeft: () => step(-1), ArrowRight: () => step(1) };
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const tag = event.target.tagName;
  if (tag === "SELECT" || (tag === "BUTTON" && (event.key === " " || event.key === "Enter"))) return;
  if (tag === "INPUT" && /^(Arrow|Home|End)/.test(event.key)) return;
  const action = (event.target === view ? viewKeys : frameKeys)[event.key] || keys[event.key];
  if (!action) return;
  event.preventDefault();
  action();
  refresh();
});

// Mouse and fingers: one turns, two zoom.
const pointers = new Map();
const spread = () => {
  const [a, b] = [...pointers.values()];
  return Math.hypot(a.x - b.x, a.y - b.y);
};
view.addEventListener("pointerdown", (event) => {
  view.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
});
view.addEventListener("pointermove", (event) => {
  const last = pointers.get(event.pointerId);
  if (!last) return;
  const dx = event.clientX - last.x, dy = event.clientY - last.y, apart = pointers.size === 2 ? spread() : 0;
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  if (pointers.size === 2) camera.zoom(apart / Math.max(spread(), 1));
  else if (event.shiftKey || event.buttons > 1) camera.move(dx, dy, view.clientHeight);
  else camera.orbit(dx, dy);
  refresh();
});
for (const end of ["pointerup", "pointercancel"]) {
  view.addEventListener(end, (event) => pointers.delete(event.pointerId));
}
view.addEventListener("contextmenu", (event) => event.preventDefault());
view.addEventListener("wheel", (event) => {
  event.preventDefault();
  camera.zoom(Math.exp(0.001 * event.deltaY));
  refresh();
}, { passive: false });
dark.addEventListener("change", refresh);
new ResizeObserver(() => { placeLabels(); refresh(); }).observe(element("stage"));

/** For scripts that look at the page: what is shown now, as a copy. */
window.motionlang = Object.freeze({
  state: () => ({
    name: clip.name, motion: clips.indexOf(clip), motions: clips.length, playing, time, seconds: clip.seconds,
    frame: Math.round(time * clip.fps), frames: clip.frames, fps: clip.fps, speed, following,
    renderer: renderer.kind, joints: clip.pose(time).positions,
    camera: { yaw: camera.yaw, pitch: camera.pitch, distance: camera.distance } }) });

element("title").textContent = page.title;
clips.forEach((c, i) => { text("option", c.name || `motion ${i + 1}`, element("motion")).value = i; });
element("choice").hidden = clips.length < 2;
choose(0);
play(page.autoplay && !matchMedia("(prefers-reduced-motion: reduce)").matches);
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Root positions as float32, then local rotations x, y, z, w as int16, 32767 for 1: 12 + 8 joints bytes per frame. The
/// error of a rotation is below 1e-4 rad.
inline std::string pack_motion(const Motion& motion) {
  std::vector<std::byte> bytes;
  for (const Vec3<double>& p : motion.root) append_value(bytes, vec_cast<float>(p));
  for (const Quaternion<double>& q : motion.local) {
    const Quaternion<double> u = normalized(q);
    for (const double x : {u.x, u.y, u.z, u.w}) append_value(bytes, static_cast<std::int16_t>(std::lround(32767 * x)));
  }
  return to_base64(bytes);
}

/// Lengths to the hundredth of a millimetre: short in text.
inline double rounded(double x) { return std::round(x * 1e5) / 1e5; }
inline nlohmann::ordered_json rounded(const Vec3<double>& v) {
  return nlohmann::ordered_json::array({rounded(v.x), rounded(v.y), rounded(v.z)});
}

inline nlohmann::ordered_json viewer_json(const Motion& motion, std::span<const Track> tracks,
                                          const std::string& note) {
  using json = nlohmann::ordered_json;
  const Figure figure = make_figure(motion.skeleton);
  json offsets = json::array(), cones = json::array(), rows = json::array();
  for (const Vec3<double>& o : motion.skeleton.offsets) offsets.push_back(rounded(o));
  for (const RoundCone& c : figure.cones) {
    json cone = json::array({c.joint});
    for (const Vec3<double>& p : {c.from, c.to}) {
      for (const double x : {p.x, p.y, p.z}) cone.push_back(rounded(x));
    }
    cone.push_back(rounded(c.radius_from));
    cone.push_back(rounded(c.radius_to));
    cone.push_back(static_cast<int>(c.side));
    cones.push_back(std::move(cone));
  }
  for (const Track& t : tracks) {
    rows.push_back({{"text", t.text}, {"start", t.start}, {"end", t.end}, {"parts", t.parts}});
  }
  return {{"name", motion.name},
          {"note", note},
          {"fps", motion.fps},
          {"frames", motion.frames()},
          {"floor", rounded(heights(motion, figure).floor)},
          {"size", rounded(figure.size)},
          {"parents", motion.skeleton.parents},
          {"offsets", std::move(offsets)},
          {"cones", std::move(cones)},
          {"tracks", std::move(rows)},
          {"data", pack_motion(motion)}};
}

/// A view of one of the caller's motions.
struct ViewerEntry {
  const Motion& motion;
  std::span<const Track> tracks;
  std::string note;
};

/// body  null: the figure of every motion's own skeleton
inline std::string viewer_page(std::span<const ViewerEntry> entries, const ViewerOptions& options,
                               nlohmann::ordered_json body = {}) {
  if (entries.empty()) raise<config_error>(101, "viewer: no motion to show");
  nlohmann::ordered_json motions = nlohmann::ordered_json::array();
  for (const ViewerEntry& e : entries) {
    e.motion.validate();
    if (e.motion.frames() == 0) raise<config_error>(101, "viewer: motion '", e.motion.name, "' has no frames");
    require_finite_times("viewer", e.tracks);
    motions.push_back(viewer_json(e.motion, e.tracks, e.note));
  }
  const std::string& name = entries.front().motion.name;
  const std::string title = !options.title.empty() ? options.title : name.empty() ? "Motion" : name;
  nlohmann::ordered_json page{
      {"title", title}, {"info", options.info}, {"autoplay", options.autoplay}, {"motions", std::move(motions)}};
  if (!body.is_null()) page["body"] = std::move(body);
  std::string data;
  for (const char c : page.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) {
    data += c == '<' ? "\\u003c" : std::string(1, c);  // no tag can end the script; '<' only stands in texts
  }
  return concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'\">\n<title>",
      escape_markup(title), "</title>\n<style>", viewer_style, "</style>\n</head>\n<body>", viewer_body,
      "<script type=\"application/json\" id=\"data\">", data, "</script>\n<script>", viewer_script_pose,
      viewer_script_draw, viewer_script_control, "</script>\n</body>\n</html>\n");
}

MOTIONLANG_BODY std::string body_viewer_page(std::span<const ViewerMotion> motions,
                                             const SkinnedMesh<std::uint16_t>& mesh, const Skeleton& skeleton,
                                             const ViewerOptions& options) {
  const auto packed = [](const auto& values) { return to_base64(std::as_bytes(std::span(values))); };
  nlohmann::ordered_json offsets = nlohmann::ordered_json::array();
  for (const Vec3<double>& o : skeleton.offsets) offsets.push_back(rounded(o));
  const nlohmann::ordered_json json{{"positions", packed(mesh.positions)}, {"joints", packed(mesh.joints)},
                                    {"weights", packed(mesh.weights)},     {"triangles", packed(mesh.triangles)},
                                    {"offsets", std::move(offsets)},       {"parents", skeleton.parents}};
  std::vector<ViewerEntry> entries;
  for (const ViewerMotion& m : motions) entries.push_back({m.motion, m.tracks, m.note});
  return viewer_page(entries, options, json);
}

}  // namespace detail

MOTIONLANG_BODY std::string viewer_html(const Motion& motion, std::span<const Track> tracks,
                                        const ViewerOptions& options) {
  const detail::ViewerEntry entry{motion, tracks, {}};
  return detail::viewer_page(std::span(&entry, 1), options);
}

MOTIONLANG_BODY std::string viewer_html(std::span<const ViewerMotion> motions, const ViewerOptions& options) {
  std::vector<detail::ViewerEntry> entries;
  for (const ViewerMotion& m : motions) entries.push_back({m.motion, m.tracks, m.note});
  return detail::viewer_page(entries, options);
}

MOTIONLANG_BODY void write_viewer(const FilePath& path, const Motion& motion, std::span<const Track> tracks,
                                  const ViewerOptions& options) {
  write_file(path, viewer_html(motion, tracks, options));
}

MOTIONLANG_BODY void write_viewer(const FilePath& path, std::span<const ViewerMotion> motions,
                                  const ViewerOptions& options) {
  write_file(path, viewer_html(motions, options));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// motions  as motion_on_body takes them
/// Throws   what viewer_html and motion_on_body throw; config_error 101 for a body without faces
template <Backend B>
std::string body_viewer_html(const Body<B>& body, std::span<const ViewerMotion> motions,
                             std::span<const typename B::scalar> betas = {}, const ViewerOptions& options = {}) {
  if (body.faces.empty()) raise<config_error>(101, "viewer: the body has no faces");
  const Skeleton skeleton = body_skeleton(body, betas);  // refuses betas that the body lacks
  const auto mesh = detail::body_mesh(body, betas);
  std::vector<ViewerMotion> own;
  for (const ViewerMotion& m : motions) own.push_back({motion_on_body(body, m.motion, betas), m.tracks, m.note});
  return detail::body_viewer_page(own, mesh, skeleton, options);
}
/// Throws io_error 401, and what body_viewer_html throws.
template <Backend B>
void write_body_viewer(const FilePath& path, const Body<B>& body, std::span<const ViewerMotion> motions,
                       std::span<const typename B::scalar> betas = {}, const ViewerOptions& options = {}) {
  write_file(path, body_viewer_html(body, motions, betas, options));
}

MOTIONLANG_NAMESPACE_END
#endif

#ifndef MOTIONLANG_HAS_VIEW_FILM_STRIP_HPP  // <motionlang/view/film_strip.hpp>
#define MOTIONLANG_HAS_VIEW_FILM_STRIP_HPP
/// A motion as one picture: poses from left to right in time, their shadows along the path of the root, and the texts
/// of a timeline below. An SVG file without anything from outside, or pixels.

MOTIONLANG_NAMESPACE_BEGIN

struct FilmStripOptions {
  int poses = 0;          // 0: as many as fit, from 5 to 12
  double width = 1280;    // pixels; the height follows
  std::string title{};    // "": the name of the motion
  double resolution = 2;  // of PNG: pixels for each of these
};

/// The picture as SVG text.
/// tracks   shown below the poses, one row each; times in seconds from the start of the motion
/// Throws   shape_error 205, numeric_error 301 if the motion is not valid or too far away for single precision;
///          config_error 101 without any frame, for a width below 100 or above a million, or times that are not finite
std::string film_strip_svg(const Motion& motion, std::span<const Track> tracks = {},
                           const FilmStripOptions& options = {});

/// The picture in pixels. Throws as film_strip_svg, and config_error 101 for a resolution that is not positive and
/// for a picture of more than 20,000 pixels a side.
Picture film_strip_picture(const Motion& motion, std::span<const Track> tracks = {},
                           const FilmStripOptions& options = {});

/// SVG; for pixels write_png(path, film_strip_picture(motion)). Throws io_error 401, and what film_strip_svg throws.
void write_film_strip(const FilePath& path, const Motion& motion, std::span<const Track> tracks = {},
                      const FilmStripOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_VIEW_FILM_STRIP_IPP  // <motionlang/view/film_strip.ipp>
#define MOTIONLANG_HAS_VIEW_FILM_STRIP_IPP
// Bodies of film_strip.hpp.

#ifndef MOTIONLANG_HAS_VIEW_DETAIL_FILM_STRIP_DRAWING_HPP  // <motionlang/view/detail/film_strip_drawing.hpp>
#define MOTIONLANG_HAS_VIEW_DETAIL_FILM_STRIP_DRAWING_HPP
/// What a film strip is drawn with: the shapes, and two surfaces that take them, one for SVG, one for pixels.

#ifndef MOTIONLANG_HAS_VIEW_DETAIL_STROKE_FONT_HPP  // <motionlang/view/detail/stroke_font.hpp>
#define MOTIONLANG_HAS_VIEW_DETAIL_STROKE_FONT_HPP
/// Letters as lines on a grid, for pictures of pixels: printable ASCII and the middle dot.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A point of the grid: descenders reach down to y = 0, letters stand on 4, small ones reach up to 10, capitals to 13.
struct GridPoint {
  int x, y;
};
inline constexpr int font_baseline = 4, font_em = 13, font_gap = 2;  // em: size of the font in units of the grid

/// Lines of a text from left to right, in units of the grid, and how wide it is. Letters that the font does not have
/// are boxes.
struct StrokedText {
  std::vector<std::vector<GridPoint>> strokes;
  int width = 0;
};
StrokedText stroke_text(std::string_view text);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_VIEW_DETAIL_STROKE_FONT_IPP  // <motionlang/view/detail/stroke_font.ipp>
#define MOTIONLANG_HAS_VIEW_DETAIL_STROKE_FONT_IPP
// Bodies of stroke_font.hpp.

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Strokes of ASCII 33 ... 126, two hexadecimal digits (x and y) for a point. A stroke of one point is a dot.
// clang-format off
inline constexpr std::array<std::string_view, 94> stroke_letters{
    "0d07 04", "0d0b 2d2b", "2d14 4d34 0a5a 0757", "5c4d1d0c0a19485755441405 3e33", "6d04 0d2d2b0b0d 4666644446",
    "540b1d3d3b0705143457", "0d0b", "2e0b0622", "0e2b2602", "2d29 0c4a 4c0a", "0848 2a26", "1402", "0848", "04", "4e02",
    "2434565b3d2d0b0624", "0b2d24", "0c1d4d5c5a0454", "0c1d4d5c5a4929 495855441405", "444d0757", "5d0d09495855441405",
    "4d2d0b0614445558491908", "0d5d24", "19495a5c4d1d0c0a1908051444555849", "594818090c1d4d5b563414",
    "04 09", "09 1402", "4a0846", "0949 0747", "0a4806", "0c1d3d4c4a2827 24",
    "56362729 3a5a56767b5d2d0b062454",
    "043d64 1757", "040d4d5c5a4909 4958554404", "6b4d2d0b06244466", "040d3d6a673404", "5d0d0454 0949", "5d0d04 0949",
    "6b4d2d0b062444666848", "0d04 6d64 0969", "0d04", "4d46341406", "0d04 5d08 2a64", "0d0454", "040d376d64", "040d646d",
    "2444666b4d2d0b0624", "040d4d5c594808", "2444666b4d2d0b0624 4673", "040d4d5c594808 3854",
    "5c4d1d0c0a19485755441405", "0d6d 3d34", "0d062444666d", "0d346d", "0d244b648d", "0d64 6d04", "0d396d 3934", "0d6d0464",
    "2e0e0222", "0e42", "0e2e2202", "0b2d4b", "0353", "0d1b",
    "243456583a2a080624 5a54", "0d04 243456583a2a080624", "594a2a0806244455", "243456583a2a080624 5d54",
    "0757583a2a080624344455", "4d3d2c24 0a4a", "243456583a2a080624 5a52301001", "0d04 082a3a5854", "0a04 0d", "2a211000 2d",
    "0d04 4a06 2854", "0d04", "0a04 082a3a4844 486a7a8884", "0a04 082a3a5854", "243456583a2a080624", "0a00 243456583a2a080624",
    "243456583a2a080624 5a50", "0a04 082a4a", "493a1a090817374645341405", "1d152434 0a3a", "0a06243456 5a54", "0a244a",
    "0a244a648a", "0a44 4a04", "0a24 4a1000", "0a4a0444",
    "3e2d2918272332", "0e01", "0e1d1928171302", "07183748"};
// clang-format on

MOTIONLANG_BODY StrokedText stroke_text(std::string_view text) {
  StrokedText out;
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = decode_utf8(text, at);
    std::string_view letter = c == U'\u00B7' ? "08" : c > 32 && c < 127 ? stroke_letters[c - 33] : "";
    if (c <= 32) out.width += 4;
    if (c > 126 && letter.empty()) letter = "040d5d5404";
    if (letter.empty()) continue;
    int right = 0;
    std::vector<GridPoint>* stroke = nullptr;
    for (std::size_t i = 0; i < letter.size();) {
      if (letter[i] == ' ') {
        stroke = nullptr, ++i;
        continue;
      }
      if (stroke == nullptr) stroke = &out.strokes.emplace_back();
      const int x = digit(letter[i]), y = digit(letter[i + 1]);
      stroke->push_back({out.width + x, y});
      right = std::max(right, x);
      i += 2;
    }
    out.width += right + font_gap;
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
#endif
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

struct Point2 {
  double x = 0, y = 0;
};

struct Rgb {
  int r = 0, g = 0, b = 0;
};

/// The hull of two circles.
struct RoundCone2 {
  Point2 from;
  double radius_from;
  Point2 to;
  double radius_to;

  /// One circle holds the other.
  bool is_circle() const {
    return std::hypot(to.x - from.x, to.y - from.y) <= std::abs(radius_from - radius_to) + 1e-9;
  }
};

enum class TextAnchor { start, middle, end };
/// `bar`: white, on a coloured bar.
enum class TextRole { usual, title, small, bar };

/// Writes SVG. The y axis points down, as in the picture.
class SvgSurface {
 public:
  SvgSurface(double width, double height, std::string_view title) {
    out_ = concat_text("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", fixed(width), " ", fixed(height),
                       "\" width=\"", fixed(width), "\" height=\"", fixed(height), "\" role=\"img\">\n<title>",
                       escape_markup(title), "</title>\n", style,
                       "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
  }
  std::string finish() { return out_ + "</svg>\n"; }

  void floor(double top, double height) {
    out_ += concat_text("<rect x=\"0\" y=\"", fixed(top), "\" width=\"100%\" height=\"", fixed(height),
                        "\" fill=\"url(#floor)\"/>\n");
  }
  void disc(Point2 c, double r, const Rgb& colour) {
    out_ += concat_text("<circle cx=\"", fixed(c.x), "\" cy=\"", fixed(c.y), "\" r=\"", fixed(r), "\" fill=\"",
                        hex(colour), "\"/>\n");
  }
  void dotted_line(std::span<const Point2> points) {
    std::string d;
    for (const Point2& p : points) d += concat_text(d.empty() ? "M" : "L", fixed(p.x), " ", fixed(p.y));
    out_ += concat_text("<path d=\"", d,
                        "\" fill=\"none\" stroke=\"#9aa3b0\" stroke-width=\"1.5\" stroke-dasharray=\"1 5\" ",
                        "stroke-linecap=\"round\"/>\n");
  }
  void begin_pose() { out_ += "<g class=\"pose\">\n"; }
  void end_pose() { out_ += "</g>\n"; }
  void shadow(Point2 c, double rx, double ry, double opacity) {
    out_ += concat_text("<ellipse cx=\"", fixed(c.x), "\" cy=\"", fixed(c.y), "\" rx=\"", fixed(rx), "\" ry=\"",
                        fixed(ry), "\" fill=\"url(#shadow)\" opacity=\"", fixed(opacity, 2), "\"/>\n");
  }
  /// One shape with a white line around it.
  void piece(std::span<const RoundCone2> cones, const Rgb& colour) {
    std::string shapes;
    for (const RoundCone2& c : cones) shapes += outline(c);
    out_ += concat_text("<path d=\"", shapes, "\" stroke=\"#fff\" stroke-width=\"1.8\"/><path d=\"", shapes,
                        "\" fill=\"", hex(colour), "\"/>\n");
  }
  void guide(double x, double top, double bottom) {
    out_ += concat_text("<path d=\"M", fixed(x), " ", fixed(top), "V", fixed(bottom),
                        "\" stroke=\"#d5dae1\" stroke-width=\"1\"/>\n");
  }
  void bar(Point2 corner, double width, double height, const Rgb& colour) {
    out_ += concat_text("<rect x=\"", fixed(corner.x), "\" y=\"", fixed(corner.y), "\" width=\"", fixed(width),
                        "\" height=\"", fixed(height), "\" rx=\"5\" fill=\"", hex(colour), "\"/>\n");
  }
  /// `paler` follows the text.
  void text(Point2 at, std::string_view text, TextRole role, TextAnchor anchor, std::string_view paler = {}) {
    constexpr std::array<std::string_view, 4> of_role{"", " class=\"title\"", " class=\"small\"", " class=\"bar\""};
    constexpr std::array<std::string_view, 3> of_anchor{"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    out_ += concat_text("<text", of_role[static_cast<std::size_t>(role)], of_anchor[static_cast<std::size_t>(anchor)],
                        " x=\"", fixed(at.x), "\" y=\"", fixed(at.y), "\"");
    // it begins with a space, which some programs would leave out
    if (!paler.empty()) out_ += " xml:space=\"preserve\"";
    out_ += ">" + escape_markup(text);
    if (!paler.empty()) out_ += concat_text("<tspan opacity=\".75\">", escape_markup(paler), "</tspan>");
    out_ += "</text>\n";
  }

 private:
  static constexpr std::string_view style =
      "<style>text{font:12px system-ui,-apple-system,'Segoe UI',sans-serif;fill:#4a5260}"
      ".title{font-size:15px;font-weight:600;fill:#20242c}.bar{fill:#fff;font-weight:500}.small{font-size:11px}</"
      "style>\n"
      "<defs><radialGradient id=\"shadow\"><stop offset=\"0\" stop-color=\"#20242c\" stop-opacity=\".34\"/>"
      "<stop offset=\".55\" stop-color=\"#20242c\" stop-opacity=\".16\"/><stop offset=\"1\" stop-color=\"#20242c\" "
      "stop-opacity=\"0\"/></radialGradient><linearGradient id=\"floor\" x2=\"0\" y2=\"1\"><stop offset=\"0\" "
      "stop-color=\"#eef1f5\" stop-opacity=\"0\"/><stop offset=\"1\" "
      "stop-color=\"#e9edf2\"/></linearGradient></defs>\n";

  static std::string hex(const Rgb& colour) {
    std::string out = "#";
    for (const int c : {colour.r, colour.g, colour.b}) {
      constexpr std::string_view digits = "0123456789abcdef";
      out += digits[static_cast<std::size_t>(c / 16)];
      out += digits[static_cast<std::size_t>(c % 16)];
    }
    return out;
  }
  /// Two arcs and the tangents between them.
  static std::string outline(const RoundCone2& cone) {
    const auto& [a, ra, b, rb] = cone;
    const double dx = b.x - a.x, dy = b.y - a.y;
    auto arc = [](double r, bool large, Point2 to) {
      return concat_text("A", fixed(r), " ", fixed(r), " 0 ", large ? 1 : 0, " 1 ", fixed(to.x), " ", fixed(to.y));
    };
    if (cone.is_circle()) {
      const double r = std::max(ra, rb);
      const Point2 c = ra > rb ? a : b;
      return concat_text("M", fixed(c.x - r), " ", fixed(c.y), arc(r, false, {c.x + r, c.y}),
                         arc(r, false, {c.x - r, c.y}), "Z");
    }
    const double axis = std::atan2(dy, dx), tangent = std::acos((ra - rb) / std::hypot(dx, dy));
    auto on = [](Point2 c, double r, double angle) {
      return Point2{c.x + r * std::cos(angle), c.y + r * std::sin(angle)};
    };
    const Point2 a1 = on(a, ra, axis + tangent), a2 = on(a, ra, axis - tangent);
    const Point2 b1 = on(b, rb, axis + tangent), b2 = on(b, rb, axis - tangent);
    const bool a_large = tangent < std::numbers::pi / 2;
    return concat_text("M", fixed(a1.x), " ", fixed(a1.y), arc(ra, a_large, a2), "L", fixed(b2.x), " ", fixed(b2.y),
                       arc(rb, !a_large, b1), "Z");
  }

  std::string out_;
};

/// Paints pixels. A shape is a signed distance (negative inside); a pixel that the edge cuts is covered by half a pixel
/// minus the distance of its middle.
class PixelSurface {
 public:
  /// width, height   in the units of the drawing; each is `scale` pixels
  PixelSurface(double width, double height, double scale)
      : scale_(scale),
        picture_{static_cast<Index>(std::ceil(width * scale)), static_cast<Index>(std::ceil(height * scale)), {}} {
    picture_.rgb.assign(static_cast<std::size_t>(3 * picture_.width * picture_.height), 255);
  }
  Picture finish() { return std::move(picture_); }

  void floor(double top, double height) {
    const Box all{{0, top}, {1e9, top + height}};
    fill(
        all, [&](Point2 p) { return std::max(top - p.y, p.y - top - height); },
        [&](Point2 p) {
          const double t = std::clamp((p.y - top) / height, 0.0, 1.0);
          return Ink{mix({0xee, 0xf1, 0xf5}, {0xe9, 0xed, 0xf2}, t), t};
        });
  }
  void disc(Point2 c, double r, const Rgb& colour) {
    const RoundCone2 circle{c, r, c, r};
    piece_without_edge(std::span(&circle, 1), 0, {colour, 1});
  }
  /// Dots of 1.5 units, 6 apart.
  void dotted_line(std::span<const Point2> points) {
    double next = 0, way = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Point2 a = points[i - 1], b = points[i];
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      for (; next < way + length; next += 6) {
        const double t = (next - way) / length;
        disc({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}, 0.9, {0x9a, 0xa3, 0xb0});
      }
      way += length;
    }
  }
  void begin_pose() {}
  void end_pose() {}
  void shadow(Point2 c, double rx, double ry, double opacity) {
    fill(
        {{c.x - rx, c.y - ry}, {c.x + rx, c.y + ry}}, [](Point2) { return -1.0; },
        [&](Point2 p) {
          const double r = std::hypot((p.x - c.x) / rx, (p.y - c.y) / ry);
          const double stop = r < 0.55 ? 0.34 + (0.16 - 0.34) * r / 0.55 : 0.16 * std::max(0.0, 1 - r) / 0.45;
          return Ink{{0x20, 0x24, 0x2c}, stop * opacity};
        });
  }
  void piece(std::span<const RoundCone2> cones, const Rgb& colour) {
    piece_without_edge(cones, 0.9, {{255, 255, 255}, 1});
    piece_without_edge(cones, 0, {colour, 1});
  }
  void guide(double x, double top, double bottom) {
    fill(
        {{x - 1, top}, {x + 1, bottom}}, [&](Point2 p) { return std::abs(p.x - x) - 0.5; },
        [](Point2) {
          return Ink{{0xd5, 0xda, 0xe1}, 1};
        });
  }
  void bar(Point2 corner, double width, double height, const Rgb& colour) {
    const double round = std::min(5.0, width / 2);
    const Point2 half{width / 2, height / 2}, middle{corner.x + half.x, corner.y + half.y};
    fill(
        {corner, {corner.x + width, corner.y + height}},
        [&](Point2 p) {
          const double x = std::abs(p.x - middle.x) - half.x + round, y = std::abs(p.y - middle.y) - half.y + round;
          return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) - round;
        },
        [&](Point2) {
          return Ink{colour, 1};
        });
  }
  void text(Point2 at, std::string_view text, TextRole role, TextAnchor anchor, std::string_view paler = {}) {
    const double size = role == TextRole::title ? 15 : role == TextRole::small ? 11 : 12, unit = size / font_em;
    const StrokedText first = stroke_text(text), second = stroke_text(paler);
    const int width = first.width + second.width - font_gap;
    const Rgb colour = role == TextRole::title ? Rgb{0x20, 0x24, 0x2c}
                       : role == TextRole::bar ? Rgb{255, 255, 255}
                                               : Rgb{0x4a, 0x52, 0x60};
    if (anchor != TextAnchor::start) at.x -= width * unit / (anchor == TextAnchor::middle ? 2 : 1);
    const double thick = role == TextRole::title || role == TextRole::bar ? 0.056 * size : 0.044 * size;
    strokes(first, at, unit, thick, {colour, 1});
    strokes(second, {at.x + first.width * unit, at.y}, unit, thick, {colour, 0.75});
  }

 private:
  struct Box {
    Point2 low, high;
  };
  struct Ink {
    Rgb colour;
    double opacity;
  };
  static Rgb mix(const Rgb& a, const Rgb& b, double t) {
    const auto one = [&](int x, int y) { return static_cast<int>(std::lround(x + t * (y - x))); };
    return {one(a.r, b.r), one(a.g, b.g), one(a.b, b.b)};
  }

  /// Source  Inigo Quilez, "2D distance functions", uneven capsule
  static double distance(const RoundCone2& c, Point2 p) {
    const auto& [a, ra, b, rb] = c;
    if (c.is_circle()) {
      const Point2 m = ra > rb ? a : b;
      return std::hypot(p.x - m.x, p.y - m.y) - std::max(ra, rb);
    }
    const Point2 axis{b.x - a.x, b.y - a.y}, q{p.x - a.x, p.y - a.y};
    const double h = axis.x * axis.x + axis.y * axis.y, slope = ra - rb, rise = std::sqrt(h - slope * slope);
    const double u = std::abs(q.x * axis.y - q.y * axis.x) / h, v = (q.x * axis.x + q.y * axis.y) / h;
    const double side = rise * v - slope * u, n = u * u + v * v;
    if (side < 0) return std::sqrt(h * n) - ra;
    if (side > rise) return std::sqrt(h * (n + 1 - 2 * v)) - rb;
    return rise * u + slope * v - ra;
  }

  void piece_without_edge(std::span<const RoundCone2> cones, double wider, const Ink& ink) {
    Box box{{1e9, 1e9}, {-1e9, -1e9}};
    for (const RoundCone2& c : cones) {
      for (const auto& [p, r] : {std::pair{c.from, c.radius_from + wider}, std::pair{c.to, c.radius_to + wider}}) {
        box.low = {std::min(box.low.x, p.x - r), std::min(box.low.y, p.y - r)};
        box.high = {std::max(box.high.x, p.x + r), std::max(box.high.y, p.y + r)};
      }
    }
    fill(
        box,
        [&](Point2 p) {
          double d = 1e9;
          for (const RoundCone2& c : cones) d = std::min(d, distance(c, p));
          return d - wider;
        },
        [&](Point2) { return ink; });
  }
  void strokes(const StrokedText& text, Point2 at, double unit, double radius, const Ink& ink) {
    for (const auto& stroke : text.strokes) {
      std::vector<RoundCone2> lines;
      const auto point = [&](const GridPoint& g) {
        return Point2{at.x + g.x * unit, at.y - (g.y - font_baseline) * unit};
      };
      for (std::size_t i = 0; i < stroke.size(); ++i) {
        if (i == 0 && stroke.size() > 1) continue;
        const double r = stroke.size() > 1 ? radius : 1.4 * radius;  // dots are a little thicker than lines
        lines.push_back({point(stroke[i > 0 ? i - 1 : 0]), r, point(stroke[i]), r});
      }
      piece_without_edge(lines, 0, ink);
    }
  }

  /// distance(p) and ink(p) are asked for at the middle of every pixel in and around the box.
  template <class Distance, class InkAt>
  void fill(const Box& box, Distance distance, InkAt ink) {
    const auto pixel = [&](double v, Index limit) {
      return static_cast<Index>(std::clamp(v * scale_, -1.0, static_cast<double>(limit) + 1));
    };
    const Index x0 = std::max<Index>(0, pixel(box.low.x, picture_.width) - 1),
                y0 = std::max<Index>(0, pixel(box.low.y, picture_.height) - 1),
                x1 = std::min(picture_.width, pixel(box.high.x, picture_.width) + 2),
                y1 = std::min(picture_.height, pixel(box.high.y, picture_.height) + 2);
    for (Index y = y0; y < y1; ++y) {
      for (Index x = x0; x < x1; ++x) {
        const Point2 p{(static_cast<double>(x) + 0.5) / scale_, (static_cast<double>(y) + 0.5) / scale_};
        const double coverage = std::clamp(0.5 - distance(p) * scale_, 0.0, 1.0);
        if (coverage > 0) blend(x, y, ink(p), coverage);
      }
    }
  }
  void blend(Index x, Index y, const Ink& ink, double coverage) {
    std::uint8_t* pixel = &picture_.rgb[static_cast<std::size_t>(3 * (y * picture_.width + x))];
    for (const int c : {ink.colour.r, ink.colour.g, ink.colour.b}) {
      *pixel = static_cast<std::uint8_t>(std::lround(*pixel + coverage * ink.opacity * (c - *pixel)));
      ++pixel;
    }
  }

  double scale_;
  Picture picture_;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
#endif

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Parallel projection of the world, seen slightly from above. Depth grows away from the viewer.
struct ObliqueView {
  Vec3<double> right{1, 0, 0}, away{0, 0, -1};  // on the floor
  double sine = std::sin(elevation), cosine = std::cos(elevation);
  static constexpr double elevation = 14 * degree;

  /// The way of the root goes to the right and a little towards the viewer. Without a way worth the name, the figure
  /// faces the viewer, half turned to the right.
  static ObliqueView of(const Motion& motion) {
    const Vec3<double> way = main_direction(motion);
    const Vec3<double> facing = rotate(motion.rotations(0)[0], Vec3<double>{0, 0, 1});
    return norm(way) > 0 ? turned(way, 28) : turned(facing, 58);
  }

 private:
  /// The view in which a direction on the floor appears at `degrees` towards the viewer from the right.
  static ObliqueView turned(const Vec3<double>& direction, double degrees) {
    const double angle = std::atan2(direction.x, direction.z) - (90 - degrees) * degree;
    const Vec3<double> towards{std::sin(angle), 0, std::cos(angle)};
    ObliqueView view;
    view.away = -towards;
    view.right = {towards.z, 0, -towards.x};
    return view;
  }
  /// From the mean of the first third of the root's path to the mean of the last third; 0 if below 0.4 m.
  static Vec3<double> main_direction(const Motion& motion) {
    const Index third = std::max<Index>(1, motion.frames() / 3);
    Vec3<double> way{};
    for (Index i = 0; i < third; ++i) way = way + motion.root_at(motion.frames() - 1 - i) - motion.root_at(i);
    way = (1.0 / static_cast<double>(third)) * Vec3<double>{way.x, 0, way.z};
    return norm(way) < 0.4 ? Vec3<double>{} : way;
  }
};

/// Lays the picture out and draws it on a surface; the y axis points down.
class FilmStrip {
 public:
  FilmStrip(const Motion& motion, std::span<const Track> tracks, const FilmStripOptions& options)
      : motion_(motion),
        tracks_(tracks),
        options_(options),
        figure_(make_figure(motion.skeleton)),
        view_(ObliqueView::of(motion)),
        last_(static_cast<double>(motion.frames() - 1) / motion.fps) {
    const double wished = options.poses > 0 ? options.poses : std::clamp(1.5 * last_ + 1, 5.0, 12.0);
    poses_ = static_cast<int>(std::min(std::round(wished), static_cast<double>(motion.frames())));
    cell_ = (options.width - 2 * margin) / poses_;
    measure();
  }

  double height() const {
    return tracks_top() + row * static_cast<double>(tracks_.size()) + (tracks_.empty() ? 0 : 10) + 8;
  }
  std::string title() const { return options_.title.empty() ? motion_.name : options_.title; }

  template <class Surface>
  void draw(Surface& on) const {
    backdrop(on);
    path(on);
    for (int i = 0; i < poses_; ++i) pose(on, i);
    time_labels(on);
    track_rows(on);
  }

 private:
  static constexpr double margin = 24, header = 44, row = 26, bar = 20;
  /// By side (middle, left, right): fill near the viewer and far from them. Distinguishable for colour-blind readers.
  static constexpr std::array<Rgb, 3> near_colour{{{98, 108, 122}, {230, 97, 44}, {38, 118, 186}}};
  static constexpr Rgb far_colour{150, 158, 170};
  static constexpr std::array<Rgb, 6> bar_colour{{{0x2b, 0x6c, 0xb0},
                                                  {0xb4, 0x53, 0x1a},
                                                  {0x2f, 0x7d, 0x4f},
                                                  {0x7a, 0x4a, 0xa8},
                                                  {0xa6, 0x3a, 0x5e},
                                                  {0x7d, 0x6a, 0x12}}};

  double time_of(int i) const { return poses_ > 1 ? last_ * i / (poses_ - 1) : 0; }
  Index frame_of(int i) const { return static_cast<Index>(std::lround(time_of(i) * motion_.fps)); }
  /// The x axis is time: the first pose stands in the middle of the first cell, the last in the middle of the last.
  double x_of(double time) const {
    const double share = last_ > 0 ? std::clamp(time / last_, 0.0, 1.0) : 0;
    return margin + cell_ / 2 + share * (cell_ * (poses_ - 1));
  }
  /// Of a point on the floor at this depth.
  double floor_y(double depth) const { return floor_ - (depth - nearest_) * view_.sine * depth_scale_; }
  double depth_of_root(Index frame) const { return dot(motion_.root_at(frame), view_.away); }

  /// Chooses the scale so that figures fit into their cells, and the places of the floor and of everything below it.
  void measure() {
    const auto [floor, high] = heights(motion_, figure_);
    ground_ = floor;
    nearest_ = farthest_ = depth_of_root(0);
    for (Index frame = 1; frame < motion_.frames(); ++frame) {
      nearest_ = std::min(nearest_, depth_of_root(frame));
      farthest_ = std::max(farthest_, depth_of_root(frame));
    }
    double half_width = 0.2 * figure_.size;
    JointTransforms<double> world;
    for (int i = 0; i < poses_; ++i) {
      motion_.world(frame_of(i), world);
      for (const RoundCone& c : figure_.cones) {
        const auto [from, to] = cone_ends(world, c);
        for (const auto& [p, r] : {std::pair{from, c.radius_from}, std::pair{to, c.radius_to}}) {
          half_width = std::max(half_width, std::abs(dot(p - motion_.root_at(frame_of(i)), view_.right)) + r);
        }
      }
    }
    const double tallest_figure = 300 / figure_.size, tallest_picture = 420 / (high - floor);
    scale_ = std::min({1.25 * cell_ / (2 * half_width), tallest_figure, tallest_picture});
    const double depth = farthest_ - nearest_, tallest = 0.45 * figure_.size;  // of the floor in the picture
    depth_scale_ = depth * view_.sine > tallest ? scale_ * tallest / (depth * view_.sine) : scale_;
    const double rise = depth * view_.sine * depth_scale_;
    floor_ = header + (high - floor) * view_.cosine * scale_ + rise + 0.08 * figure_.size * scale_;
    labels_ = floor_ + 0.16 * figure_.size * scale_ + 14;
  }

  template <class Surface>
  void backdrop(Surface& on) const {
    const double top = floor_y(farthest_) - 34, bottom = labels_ - 18;
    on.text({margin, 28}, title(), TextRole::title, TextAnchor::start);
    on.floor(top, bottom - top);
    for (const auto& [side, name, x] :
         {std::tuple{Side::left, "left", 104.0}, std::tuple{Side::right, "right", 52.0}}) {
      on.disc({options_.width - x, 23}, 5, colour(side, 0));
      on.text({options_.width - x + 9, 27}, name, TextRole::small, TextAnchor::start);
    }
  }

  /// Where the root goes over the floor; its shadow line.
  template <class Surface>
  void path(Surface& on) const {
    std::vector<Point2> points;
    const Index step = std::max<Index>(1, motion_.frames() / 400);
    for (Index frame = 0; frame < motion_.frames(); frame += step) {
      points.push_back({x_of(static_cast<double>(frame) / motion_.fps), floor_y(depth_of_root(frame))});
    }
    on.dotted_line(points);
  }

  /// Cones that are drawn as one shape: the trunk with the head, or all of one joint.
  struct Piece {
    std::vector<const RoundCone*> cones;
    double depth = 0;     // along the line of sight, mean over the cones
    double distance = 0;  // behind the root, on the floor
  };
  /// From far to near.
  std::vector<Piece> pieces(const JointTransforms<double>& world, const Vec3<double>& root) const {
    std::map<int, Piece> by_joint;
    for (const RoundCone& c : figure_.cones) by_joint[c.side == Side::middle ? -1 : c.joint].cones.push_back(&c);
    std::vector<Piece> out;
    for (auto& [joint, piece] : by_joint) {
      const double share = 1.0 / static_cast<double>(piece.cones.size());
      for (const RoundCone* c : piece.cones) {
        const auto [from, to] = cone_ends(world, *c);
        const Vec3<double> r = 0.5 * (from + to) - root;
        piece.depth += share * (dot(r, view_.away) * view_.cosine - r.y * view_.sine);
        piece.distance += share * dot(r, view_.away);
      }
      out.push_back(std::move(piece));
    }
    std::stable_sort(out.begin(), out.end(), [](const Piece& a, const Piece& b) { return a.depth > b.depth; });
    return out;
  }

  /// One figure with its shadow; limbs far from the viewer first.
  template <class Surface>
  void pose(Surface& on, int i) const {
    const Index frame = frame_of(i);
    const Vec3<double>& root = motion_.root_at(frame);
    const double x = x_of(time_of(i)), y = floor_y(depth_of_root(frame)), lift = root.y - ground_;
    const double spread = 0.26 * figure_.size * scale_;
    on.begin_pose();
    on.shadow({x, y}, spread, 0.36 * spread, std::clamp(1.6 - lift / (0.7 * figure_.size), 0.25, 1.0));
    JointTransforms<double> world;
    motion_.world(frame, world);
    auto project = [&](const Vec3<double>& p) {
      const Vec3<double> r = p - root;
      return Point2{x + dot(r, view_.right) * scale_,
                    y - ((p.y - ground_) * view_.cosine + dot(r, view_.away) * view_.sine) * scale_};
    };
    for (const Piece& piece : pieces(world, root)) {
      const double shade = std::clamp(piece.distance / (0.35 * figure_.size), 0.0, 1.0);
      std::vector<RoundCone2> shapes;
      for (const RoundCone* c : piece.cones) {
        const auto [from, to] = cone_ends(world, *c);
        shapes.push_back({project(from), c->radius_from * scale_, project(to), c->radius_to * scale_});
      }
      on.piece(shapes, colour(piece.cones.front()->side, shade));
    }
    on.end_pose();
  }

  /// distance   0 near the root or before it, 1 far behind it
  static Rgb colour(Side side, double distance) {
    const Rgb& near = near_colour[static_cast<std::size_t>(side)];
    const auto one = [&](int n, int far) { return static_cast<int>(std::lround(n + 0.55 * distance * (far - n))); };
    return {one(near.r, far_colour.r), one(near.g, far_colour.g), one(near.b, far_colour.b)};
  }

  template <class Surface>
  void time_labels(Surface& on) const {
    for (int i = 0; i < poses_; ++i) {
      const double x = x_of(time_of(i));
      if (!tracks_.empty()) on.guide(x, labels_ + 6, tracks_top() + row * static_cast<double>(tracks_.size()));
      on.text({x, labels_}, fixed(static_cast<double>(frame_of(i)) / motion_.fps, 2) + " s", TextRole::usual,
              TextAnchor::middle);
    }
  }

  double tracks_top() const { return labels_ + (tracks_.empty() ? 4 : 14); }

  /// A bar for every text, with the text in it or, if it is too long, beside it.
  template <class Surface>
  void track_rows(Surface& on) const {
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      const Track& track = tracks_[i];
      const double x = x_of(track.start), width = std::max(3.0, x_of(track.end) - x);
      const double y = tracks_top() + row * static_cast<double>(i) + (row - bar) / 2;
      std::string parts;
      for (const std::string& p : track.parts) parts += (parts.empty() ? " \u00B7 " : ", ") + p;
      const double letters = 6.6 * static_cast<double>(track.text.size() + parts.size());
      const bool inside = letters + 16 < width;
      const bool after = !inside && x + width + letters + 12 < options_.width;
      const double text_x = inside ? x + 8 : after ? x + width + 6 : x - 6;
      on.bar({x, y}, width, bar, bar_colour[i % bar_colour.size()]);
      on.text({text_x, y + 14.5}, track.text, inside ? TextRole::bar : TextRole::usual,
              inside || after ? TextAnchor::start : TextAnchor::end, parts);
    }
  }

  const Motion& motion_;
  std::span<const Track> tracks_;
  const FilmStripOptions& options_;
  Figure figure_;
  ObliqueView view_;
  double last_;  // time of the last frame
  int poses_ = 1;
  double cell_ = 0, scale_ = 1, depth_scale_ = 1;  // pixels per cell, per metre, per metre of depth of the floor
  double ground_ = 0;                              // height of the floor
  double nearest_ = 0, farthest_ = 0;              // depth of the root
  double floor_ = 0, labels_ = 0;                  // y of the nearest root's floor, of the time labels
};

inline FilmStrip film_strip(const Motion& motion, std::span<const Track> tracks, const FilmStripOptions& options) {
  motion.validate();
  if (motion.frames() == 0) raise<config_error>(101, "film strip: motion '", motion.name, "' has no frames");
  if (!(options.width >= 100 && options.width <= 1e6)) raise<config_error>(101, "film strip: width ", options.width);
  require_finite_times("film strip", tracks);
  return FilmStrip(motion, tracks, options);
}

}  // namespace detail

MOTIONLANG_BODY std::string film_strip_svg(const Motion& motion, std::span<const Track> tracks,
                                           const FilmStripOptions& options) {
  const detail::FilmStrip strip = detail::film_strip(motion, tracks, options);
  detail::SvgSurface surface(options.width, strip.height(), strip.title());
  strip.draw(surface);
  return surface.finish();
}

MOTIONLANG_BODY Picture film_strip_picture(const Motion& motion, std::span<const Track> tracks,
                                           const FilmStripOptions& options) {
  const detail::FilmStrip strip = detail::film_strip(motion, tracks, options);
  if (!(options.resolution > 0 && options.resolution * options.width <= 20000)) {
    raise<config_error>(101, "film strip: width ", options.width, " at ", options.resolution, " pixels each");
  }
  if (!(options.resolution * strip.height() <= 20000))
    raise<config_error>(101, "film strip: height ", strip.height(), " at ", options.resolution, " pixels each");
  detail::PixelSurface surface(options.width, strip.height(), options.resolution);
  strip.draw(surface);
  return surface.finish();
}

MOTIONLANG_BODY void write_film_strip(const FilePath& path, const Motion& motion, std::span<const Track> tracks,
                                      const FilmStripOptions& options) {
  write_file(path, film_strip_svg(motion, tracks, options));
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_VIEW_INSPECTION_PAGE_HPP  // <motionlang/view/inspection_page.hpp>
#define MOTIONLANG_HAS_VIEW_INSPECTION_PAGE_HPP
/// The findings of a folder of motions as one HTML page: a table of what was found how often, then every motion with
/// its findings and, for some of each kind, a film strip. Nothing comes from outside the file.

MOTIONLANG_NAMESPACE_BEGIN

/// A motion of the page, or a file that could not be read.
struct InspectedMotion {
  std::string name;                 // path, and animation if there are several
  std::string about;                // length, frame rate, joints
  std::string unreadable{};         // the error of the reader; "": it was read
  std::vector<Finding> findings{};  // empty: nothing is wrong
  std::string strip{};              // film_strip_svg, or "" for none

  bool good() const { return unreadable.empty() && findings.empty(); }
};

/// How many motions have each fault, by Fault.
std::array<Index, fault_info.size()> count_faults(std::span<const InspectedMotion> motions);

/// title   of the page, the name of the folder
std::string inspection_html(std::span<const InspectedMotion> motions, std::string_view title);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_VIEW_INSPECTION_PAGE_IPP  // <motionlang/view/inspection_page.ipp>
#define MOTIONLANG_HAS_VIEW_INSPECTION_PAGE_IPP
// Bodies of inspection_page.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::array<Index, fault_info.size()> count_faults(std::span<const InspectedMotion> motions) {
  std::array<Index, fault_info.size()> count{};
  for (const InspectedMotion& m : motions) {
    for (const Finding& f : m.findings) ++count[static_cast<std::size_t>(f.fault)];
  }
  return count;
}

MOTIONLANG_BODY std::string inspection_html(std::span<const InspectedMotion> motions, std::string_view title) {
  using detail::escape_markup;
  const auto total = std::ssize(motions);
  const auto good = std::count_if(motions.begin(), motions.end(), [](const auto& m) { return m.good(); });
  const auto unreadable =
      std::count_if(motions.begin(), motions.end(), [](const auto& m) { return !m.unreadable.empty(); });
  std::string out = concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<title>",
      escape_markup(title), "</title>\n<style>body{font:15px/1.45 system-ui,-apple-system,'Segoe UI',sans-serif;",
      "color:#20242c;max-width:1330px;margin:2em auto;padding:0 1em}table{border-collapse:collapse;margin:1em 0}",
      "td,th{text-align:left;padding:.25em 1em .25em 0;border-bottom:1px solid #e1e5ea;vertical-align:top}",
      "td.n,th.n{text-align:right}h1{font-size:1.5em}h2{font-size:1.05em;margin:1.6em 0 .2em}",
      ".about{color:#5b6472;font-weight:400}ul{margin:.2em 0 .4em;padding-left:1.3em}b{font-weight:600;color:#a3380e}",
      "svg{max-width:100%;height:auto;border:1px solid #e1e5ea;border-radius:6px}</style>\n</head>\n<body>\n<h1>",
      escape_markup(title), "</h1>\n<p>", counted(total, "motion"), ": ", good, " without a finding, ",
      total - good - unreadable, " with findings, ", unreadable, " unreadable.</p>\n");
  if (good < total) {
    out += "<table>\n<tr><th>finding</th><th class=\"n\">motions</th><th>meaning</th><th>mended</th></tr>\n";
    const auto count = count_faults(motions);
    for (std::size_t i = 0; i < count.size(); ++i) {
      if (count[i] == 0) continue;
      out += concat_text("<tr><td>", fault_info[i].name, "</td><td class=\"n\">", count[i], "</td><td>",
                         fault_info[i].meaning, "</td><td>", fault_info[i].mendable ? "yes" : "no", "</td></tr>\n");
    }
    out += "</table>\n";
  }
  for (const InspectedMotion& m : motions) {
    if (m.good()) continue;
    out += concat_text("<h2>", escape_markup(m.name), " <span class=\"about\">", escape_markup(m.about),
                       "</span></h2>\n<ul>\n");
    if (!m.unreadable.empty()) out += concat_text("<li><b>unreadable</b>: ", escape_markup(m.unreadable), "</li>\n");
    for (const Finding& f : m.findings) {
      out += concat_text("<li><b>", info(f.fault).name, "</b>: ", escape_markup(f.text), "</li>\n");
    }
    out += concat_text("</ul>\n", m.strip);
  }
  return out + "</body>\n</html>\n";
}

MOTIONLANG_NAMESPACE_END
#endif
#endif

#ifndef MOTIONLANG_HAS_VIEW_SEARCH_PAGE_HPP  // <motionlang/view/search_page.hpp>
#define MOTIONLANG_HAS_VIEW_SEARCH_PAGE_HPP
/// What a search found, as one HTML page: for each clip or moment its score, where it is, what is said about it, and a
/// film strip. Nothing comes from outside the file.

MOTIONLANG_NAMESPACE_BEGIN

/// A hit of the page.
struct FoundMotion {
  IndexedClip clip;
  double start = 0, end = 0;  // seconds in the file
  double score = 0;           // 0 to 1
  std::string strip{};        // film_strip_svg, or "" for none
  std::string problem{};      // why there is none
};

/// query    what was searched for, in words
/// summary  how many were searched, and what they are
std::string search_html(std::span<const FoundMotion> found, std::string_view query, std::string_view summary);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_HAS_VIEW_SEARCH_PAGE_IPP  // <motionlang/view/search_page.ipp>
#define MOTIONLANG_HAS_VIEW_SEARCH_PAGE_IPP
// Bodies of search_page.hpp.

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string search_html(std::span<const FoundMotion> found, std::string_view query,
                                        std::string_view summary) {
  using detail::escape_markup, detail::fixed;
  std::string out = concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<title>",
      escape_markup(query), "</title>\n<style>body{font:15px/1.45 system-ui,-apple-system,'Segoe UI',sans-serif;",
      "color:#20242c;max-width:1330px;margin:2em auto;padding:0 1em}h1{font-size:1.5em;margin-bottom:.1em}",
      "h2{font-size:1.05em;margin:0;overflow-wrap:anywhere}section{margin:1.8em "
      "0}header{display:flex;gap:1em;align-items:baseline}",
      ".score{font-variant-numeric:tabular-nums;font-weight:600;min-width:3.2em}",
      ".bar{display:inline-block;height:.6em;border-radius:.3em;background:#2b6cb0;margin-right:.6em}",
      ".about{color:#5b6472;margin:.1em 0 .5em}.problem{color:#a3380e}",
      "svg{max-width:100%;height:auto;border:1px solid #e1e5ea;border-radius:6px}</style>\n</head>\n<body>\n<h1>",
      escape_markup(query), "</h1>\n<p class=\"about\">", escape_markup(summary), "</p>\n");
  int place = 0;
  for (const FoundMotion& f : found) {
    std::string about = concat_text(fixed(f.start, 2), " to ", fixed(f.end, 2), " s");
    if (!f.clip.name.empty()) about += " of " + f.clip.name;
    for (const std::string& c : f.clip.captions) about += " · “" + c + "”";
    if (!f.clip.license.empty()) about += " · " + f.clip.license;
    out += concat_text(
        "<section>\n<header><span class=\"score\">", fixed(f.score, 3), "</span><h2>", ++place, ". ",
        escape_markup(f.clip.path), "</h2></header>\n<p class=\"about\"><span class=\"bar\" style=\"width:",
        fixed(12 * std::clamp(f.score, 0.0, 1.0), 2), "em\"></span>", escape_markup(about), "</p>\n", f.strip);
    if (!f.problem.empty()) out += concat_text("<p class=\"problem\">", escape_markup(f.problem), "</p>\n");
    out += "</section>\n";
  }
  if (found.empty()) out += "<p>Nothing was found.</p>\n";
  return out + "</body>\n</html>\n";
}

MOTIONLANG_NAMESPACE_END
#endif
#endif
