// SPDX-License-Identifier: MIT
/// Folders for results, looked at before long work rather than after it.
///
///     const OutputFolder out("`out`", "results/today");   // removed again if nothing is written there
#pragma once

#include <filesystem>   // paths
#include <string_view>  // what a message calls a folder
#include <vector>       // paths

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws io_error 401 unless the folder is there in which a file is to be written.
void require_folder_of(const std::filesystem::path& file);

/// Makes a folder unless it is there. Throws io_error 401 if it cannot be written in; the message begins with `what`.
void make_output_folder(std::string_view what, const std::filesystem::path& folder);

/// The same. What it made goes again in the end if it is still empty.
class OutputFolder {
 public:
  OutputFolder(std::string_view what, const std::filesystem::path& folder);

 private:
  struct Made {                                  // of its own, so that it goes as well where the constructor throws
    std::vector<std::filesystem::path> paths{};  // the innermost last

    Made() = default;
    Made(const Made&) = delete;
    Made& operator=(const Made&) = delete;
    ~Made();
  } made_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/output_folder.ipp>
#endif
