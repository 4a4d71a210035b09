// SPDX-License-Identifier: MIT
/// The files that some work reads and must not overwrite with its result.
///
///     const InputFiles inputs{"walk.bvh", "rig.glb"};
///     inputs.refuse(output);                           // before long work rather than after it
#pragma once

#include <algorithm>         // any_of
#include <filesystem>        // paths
#include <initializer_list>  // paths
#include <set>               // paths
#include <system_error>      // paths that are not there
#include <vector>            // paths

#include <motionlang/core/option_error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class InputFiles {
 public:
  InputFiles() = default;
  InputFiles(std::initializer_list<std::filesystem::path> files) {
    for (const auto& file : files) add(file);
  }
  template <class File>
  explicit InputFiles(const std::vector<File>& files) {
    for (const auto& file : files) add(file);
  }

  /// "": none. For a folder, pass the files in it that are read. Its other files may be results of an earlier run.
  void add(const std::filesystem::path& file) {
    std::error_code problem;
    if (!file.empty()) files_.insert(std::filesystem::weakly_canonical(file, problem));
  }

  /// True if a file is one of them under any name: a path with links, or a hard link.
  bool has(const std::filesystem::path& file) const {
    std::error_code problem, missing;
    const auto is_same = [&](const auto& input) { return std::filesystem::equivalent(input, file, problem); };
    const bool linked = std::filesystem::hard_link_count(file, missing) > 1 && !missing;
    return files_.contains(std::filesystem::weakly_canonical(file, problem)) ||
           (linked && std::any_of(files_.begin(), files_.end(), is_same));
  }
  /// Throws option_error 102 if the file is one of them.
  void refuse(const std::filesystem::path& output) const {
    if (has(output)) raise<option_error>(102, output.string(), " is an input: name another file for the result");
  }

 private:
  std::set<std::filesystem::path> files_;  // absolute, without links
};

MOTIONLANG_NAMESPACE_END
