// SPDX-License-Identifier: MIT
/// File calls of the system: POSIX, and on Windows those of MinGW's C library. errno has the reason of a failure.
#pragma once

#include <fcntl.h>     // open
#include <sys/stat.h>  // fstat, fchmod, mkdir
#include <unistd.h>    // read, write, close, getpid
#if defined(_WIN32)
#include <io.h>      // _commit
#include <malloc.h>  // _aligned_malloc

#include <algorithm>  // min
#else
#include <sys/mman.h>  // mmap
#endif

#include <cerrno>        // errno
#include <cstddef>       // byte
#include <cstdint>       // sizes
#include <cstdio>        // rename
#include <cstdlib>       // mkstemp
#include <filesystem>    // folder of temporary files
#include <string>        // names
#include <system_error>  // no folder of temporary files

#include <motionlang/version.hpp>

#if defined(_WIN32)
// Declared here as in windows.h, which would bring macros named min, max, near and far.
extern "C" __declspec(dllimport) int __stdcall MoveFileExA(const char* from, const char* to, unsigned long flags);
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail::system {

/// Creates and opens a temporary file with a new name, for this user only. Returns -1 if that fails.
inline int create_temporary(std::string& name) {
  std::error_code problem;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(problem);
  name = problem ? "a temporary file" : (folder / "motionlang-XXXXXX").string();
  if (problem) return errno = problem.default_error_condition().value(), -1;
  return ::mkstemp(name.data());
}

#if defined(_WIN32)

inline int open_to_read(const char* path) { return ::open(path, O_RDONLY | O_BINARY | O_NOINHERIT); }
/// Creates a new file. errno is EEXIST if it exists.
inline int create(const char* path) { return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_BINARY | O_NOINHERIT, 0666); }
/// Creates a file without a name. Windows has no such files.
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
/// The whole file, for reading; null if that fails. size > 0. This is a copy, because nobody could rewrite a mapped
/// file, such as the checkpoint of a training.
inline void* map(int file, std::size_t size) {
  auto* const data = static_cast<char*>(::_aligned_malloc(size, 64));
  if (data == nullptr) return errno = ENOMEM, nullptr;
  for (std::size_t done = 0; done < size;) {
    const int n = ::read(file, data + done, static_cast<unsigned>(std::min<std::size_t>(size - done, 1u << 30)));
    if (n <= 0) {
      if (n == 0) errno = EIO;  // it is shorter now
      return unmap(data, size), nullptr;
    }
    done += static_cast<std::size_t>(n);
  }
  return data;
}
inline void forget(void*, std::size_t) {}  // there is no other copy
inline void will_read(const void*, std::size_t) {}
inline bool rename_over(const char* from, const char* to) {
  constexpr unsigned long replace = 1;
  if (::MoveFileExA(from, to, replace) != 0) return true;
  errno = EACCES;  // it is open
  return false;
}
inline bool make_folder(const char* path) { return ::mkdir(path) == 0; }

#else

inline int open_to_read(const char* path) { return ::open(path, O_RDONLY | O_CLOEXEC); }
/// Creates a new file. errno is EEXIST if it exists.
inline int create(const char* path) { return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); }
/// Creates a file without a name; -1 if that fails.
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
/// Gives an open file the permissions of another one, if that exists. Some file systems have no such permissions.
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
/// Releases the memory of a mapping. Later reads load it from the file again.
inline void forget(void* data, std::size_t size) { ::madvise(data, size, MADV_DONTNEED); }
/// Begins to load a part of a mapping, from the beginning of a page on.
inline void will_read(const void* data, std::size_t size) { ::madvise(const_cast<void*>(data), size, MADV_WILLNEED); }
inline bool rename_over(const char* from, const char* to) { return std::rename(from, to) == 0; }
inline bool make_folder(const char* path) { return ::mkdir(path, 0777) == 0; }

#endif

inline bool is_folder(const char* path) {
  struct stat s {};
  return ::stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

}  // namespace detail::system
MOTIONLANG_NAMESPACE_END
