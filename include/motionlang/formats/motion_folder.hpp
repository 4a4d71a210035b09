// SPDX-License-Identifier: MIT
/// The motion files of a folder, for a conversion, an index or a training.
///
///     for (const auto& file : motion_files_below("clips")) read_motions(file, options_for_file(options, file));
#pragma once

#include <filesystem>  // paths
#include <string>      // notes
#include <vector>      // files

#include <motionlang/formats/motion_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The motion files (is_motion_file) in a folder and its subfolders, in order. It leaves out .npy files with one axis,
/// which are mean and deviation of a data set. It leaves out joints if the data set also has features of the same
/// clips.
/// Subfolders that cannot be read, and links that lead in a circle, are skipped.
/// results  a folder for results; its files are not inputs even if it is inside the other folder
/// notes    gets a line about each folder and file that was skipped
/// Throws   io_error 401 if the folder itself cannot be read
std::vector<std::filesystem::path> motion_files_below(const FilePath& folder, const FilePath& results = "",
                                                      std::string* notes = nullptr);

/// The options for one of many files. An AMC file is read with the skeleton beside it, and an .npz file with its own
/// rate. Throws what NpzArchive::open throws.
MotionReadOptions options_for_file(MotionReadOptions options, const FilePath& file);

/// True if an .npy file may hold a motion: it has more than one axis, or it cannot be read and its reader reports why.
bool may_hold_frames(const FilePath& npy);

/// True if two paths lead to one place. It need not exist.
bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/motion_folder.ipp>
#endif
