// The files that a command reads, which it must not write: a result would take the place of what it is made from.
#pragma once

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <set>
#include <system_error>
#include <vector>

#include <motionlang/core/error.hpp>

#include "../usage_error.hpp"

namespace program {

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

  /// "": none. Of a folder, what is read of it: its other files may be results of an earlier run.
  void add(const std::filesystem::path& file) {
    std::error_code problem;
    if (!file.empty()) files_.insert(std::filesystem::weakly_canonical(file, problem));
  }

  /// Throws usage_error 102 if the file is one of them, by whatever name.
  void refuse(const std::filesystem::path& output) const {
    std::error_code problem, missing;
    const auto is_output = [&](const auto& file) { return std::filesystem::equivalent(file, output, problem); };
    const bool linked = std::filesystem::hard_link_count(output, missing) > 1 && !missing;
    if (files_.contains(std::filesystem::weakly_canonical(output, problem)) ||
        (linked && std::ranges::any_of(files_, is_output)))
      motionlang::raise<usage_error>(102, output.string(), " is what is read: name another file for the result");
  }

 private:
  std::set<std::filesystem::path> files_;  // absolute, without links
};

}  // namespace program
