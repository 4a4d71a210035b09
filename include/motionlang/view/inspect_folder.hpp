// SPDX-License-Identifier: MIT
/// Finds what is wrong with the motions of a folder: every file is read and inspected, and mended copies are written.
///
///     const auto found = inspect_folder("clips", {.clean = "mended", .strips = 3});
///     write_file("report.html", inspection_html(found, "clips"));
#pragma once

#include <filesystem>  // folders
#include <string>      // notes
#include <vector>      // what was found

#include <motionlang/core/progress.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/view/inspection_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct InspectFolderOptions {
  MotionReadOptions read{};
  std::filesystem::path clean{};  // folder for mended copies (.bvh) below the names of the originals; "": none
  int strips = 0;                 // motions with each fault that get a film strip
};

/// The motions of `files`, which are below `folder`, in their order; a file that cannot be read is one of them.
/// notes   gets what the readers note about the files
/// Throws  option_error 102 for a copy that would take the place of an original; io_error 401 for a copy that cannot be
///         written; cancelled
std::vector<InspectedMotion> inspect_files(const std::vector<std::filesystem::path>& files,
                                           const std::filesystem::path& folder, const InspectFolderOptions& options,
                                           Progress progress = {}, std::string* notes = nullptr);
/// Those that motion_files_below finds.
/// notes   gets a line about each file and folder that was skipped, and what the readers note
/// Throws  config_error 101 if there is none, what motion_files_below throws, and as above
std::vector<InspectedMotion> inspect_folder(const std::filesystem::path& folder,
                                            const InspectFolderOptions& options = {}, std::string* notes = nullptr,
                                            Progress progress = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/inspect_folder.ipp>
#endif
