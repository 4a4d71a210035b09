// SPDX-License-Identifier: MIT
// Bodies of output_folder.hpp.
#pragma once

#include <unistd.h>  // access

#include <cerrno>        // the reason
#include <system_error>  // the reason

#include <motionlang/file/output_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void require_folder_of(const std::filesystem::path& file) {
  const auto folder = file.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    raise<io_error>(401, file.string(), ": there is no folder ", folder.string());
}

MOTIONLANG_BODY void make_output_folder(std::string_view what, const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (!problem && ::access(folder.string().c_str(), W_OK) != 0) problem = {errno, std::generic_category()};
  if (problem) raise<io_error>(401, what, " ", folder.string(), ": ", problem.message());
}

MOTIONLANG_BODY OutputFolder::OutputFolder(std::string_view what, const std::filesystem::path& folder) {
  std::filesystem::path path;
  for (const auto& name : std::filesystem::absolute(folder)) {
    std::error_code unknown;  // make_output_folder says it
    path /= name;
    if (!name.empty() && !std::filesystem::exists(path, unknown)) made_.paths.push_back(path);
  }
  make_output_folder(what, folder);
}
MOTIONLANG_BODY OutputFolder::Made::~Made() {
  for (; !paths.empty(); paths.pop_back()) {
    std::error_code not_empty;
    std::filesystem::remove(paths.back(), not_empty);
  }
}

MOTIONLANG_NAMESPACE_END
