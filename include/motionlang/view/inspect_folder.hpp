// SPDX-License-Identifier: MIT
/// Finds faults in the motions of a folder: reads and inspects every file, and writes mended copies.
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
  std::filesystem::path clean{};  // folder for mended copies (.bvh) under the names of the originals; "": none
  int strips = 0;                 // motions with each fault that get a film strip
};

/// The motions of `files`, which are below `folder`, in their order. A file that cannot be read also counts as one.
/// notes   gets what the readers note about the files
/// Throws  option_error 102 for a copy that would replace an original; io_error 401 for a copy that cannot be written;
///         cancelled
std::vector<InspectedMotion> inspect_files(const std::vector<std::filesystem::path>& files,
                                           const std::filesystem::path& folder, const InspectFolderOptions& options,
                                           Progress progress = {}, std::string* notes = nullptr);
/// The motions of the files that motion_files_below finds.
/// notes   gets a line about each skipped file and folder, and what the readers note
/// Throws  config_error 101 if there is none, what motion_files_below throws, and what inspect_files throws
std::vector<InspectedMotion> inspect_folder(const std::filesystem::path& folder,
                                            const InspectFolderOptions& options = {}, std::string* notes = nullptr,
                                            Progress progress = {});

/// The findings as lines: the motions with one (`all`: every motion), then how many have each fault.
std::string describe_inspection(const std::vector<InspectedMotion>& found, bool all = false);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/inspect_folder.ipp>
#endif
