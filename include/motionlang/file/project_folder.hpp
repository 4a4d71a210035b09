// SPDX-License-Identifier: MIT
/// One folder, whose files somebody reads and writes by their names alone. Names are checked by the caller's rule, and
/// links are not followed, so no file elsewhere is reached.
///
///     const ProjectFolder folder("my project", is_studio_file);
///     folder.write("walk.bvh", bytes);
///     for (const std::string& name : folder.names()) offer(name);
#pragma once

#include <cstddef>      // contents
#include <filesystem>   // the folder
#include <functional>   // the rule
#include <span>         // contents
#include <string>       // names
#include <string_view>  // names
#include <vector>       // names

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True for a file itself, not for a link to one.
bool is_own_file(const std::filesystem::path& path);
/// True if a write stays at this path: a file itself is there, or nothing.
bool is_own_place(const std::filesystem::path& path);

class ProjectFolder {
 public:
  using Rule = std::function<bool(std::string_view)>;

  /// The folder must exist. The rule is true for names that are allowed. Throws io_error 401.
  ProjectFolder(const std::filesystem::path& folder, Rule is_allowed);

  /// The files with allowed names, sorted; at most 1000. Links and folders are left out.
  std::vector<std::string> names() const;
  /// Throws config_error 103 for a name that is not allowed, io_error 401 unless it is a file of its own, and for one
  /// that is larger.
  std::string read(const std::string& name, std::size_t most) const;
  /// Throws config_error 103 and io_error 401, also for a name that a link or a folder has.
  void write(const std::string& name, std::span<const std::byte> contents) const;

  /// The mark of contents: 16 digits, FNV-1a over the bytes. It does not protect against forgery.
  static std::string mark(std::span<const std::byte> contents);
  /// Writes if there is no such file, or if its contents have this mark. False: there are others, or more than `most`
  /// bytes, and nothing is written. Throws as write does. Two calls at the same time need a lock of the caller.
  bool write_over(const std::string& name, std::span<const std::byte> contents, std::string_view mark,
                  std::size_t most) const;

 private:
  std::filesystem::path path_of(const std::string& name) const;

  std::filesystem::path folder_;
  Rule is_allowed_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/project_folder.ipp>
#endif
