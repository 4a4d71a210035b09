// SPDX-License-Identifier: MIT
// Bodies of project_folder.hpp.
#pragma once

#include <algorithm>     // sort
#include <system_error>  // error_code
#include <utility>       // move

#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/project_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool is_own_file(const std::filesystem::path& path) {
  std::error_code failed;
  return std::filesystem::is_regular_file(std::filesystem::symlink_status(path, failed));
}
MOTIONLANG_BODY bool is_own_place(const std::filesystem::path& path) {
  std::error_code failed;
  const auto status = std::filesystem::symlink_status(path, failed);
  return status.type() == std::filesystem::file_type::not_found || std::filesystem::is_regular_file(status);
}

MOTIONLANG_BODY ProjectFolder::ProjectFolder(const std::filesystem::path& folder, Rule is_allowed)
    : is_allowed_(std::move(is_allowed)) {
  std::error_code failed;
  folder_ = std::filesystem::canonical(folder, failed);
  if (failed || !std::filesystem::is_directory(folder_))
    raise<io_error>(401, folder.string(), ": there is no such folder");
}

MOTIONLANG_BODY std::vector<std::string> ProjectFolder::names() const {
  constexpr std::size_t most = 1000;
  std::vector<std::string> out;
  std::error_code failed;
  for (std::filesystem::directory_iterator at(folder_, failed), end; !failed && at != end; at.increment(failed)) {
    const std::string name = at->path().filename().string();
    if (is_allowed_(name) && is_own_file(at->path()) && out.size() < most) out.push_back(name);
  }
  std::sort(out.begin(), out.end());
  return out;
}

MOTIONLANG_BODY std::filesystem::path ProjectFolder::path_of(const std::string& name) const {
  const std::filesystem::path file(name);
  if (!is_allowed_(name) || file != file.filename())
    raise<config_error>(103, "'", name, "' cannot be the name of a file of the project");
  return folder_ / file;
}

MOTIONLANG_BODY std::string ProjectFolder::read(const std::string& name, std::size_t most) const {
  const auto path = path_of(name);
  if (!is_own_file(path)) raise<io_error>(401, name, ": there is no such file in the project");
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed || size > most) raise<io_error>(401, name, ": ", failed ? 0 : size, " bytes, at most ", most);
  return read_file(path);
}

MOTIONLANG_BODY void ProjectFolder::write(const std::string& name, std::span<const std::byte> contents) const {
  const auto path = path_of(name);
  if (!is_own_place(path)) raise<io_error>(401, name, ": something else in the project has this name");
  write_file(path, contents);
}

MOTIONLANG_BODY std::string ProjectFolder::mark(std::span<const std::byte> contents) {
  return detail::hexadecimal(detail::byte_hash(contents));  // some pairs of changes keep content_hash
}

MOTIONLANG_BODY bool ProjectFolder::write_over(const std::string& name, std::span<const std::byte> contents,
                                               std::string_view mark, std::size_t most) const {
  const auto path = path_of(name);
  if (is_own_file(path)) {
    std::error_code failed;
    if (std::filesystem::file_size(path, failed) > most || failed) return false;
    const std::string there = read_file(path);
    if (this->mark(std::as_bytes(std::span(there))) != mark) return false;
  }
  write(name, contents);
  return true;
}

MOTIONLANG_NAMESPACE_END
