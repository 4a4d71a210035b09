// SPDX-License-Identifier: MIT
/// Converts files of motion to other files, with edits: motions, features, clips of a data set, characters, bodies,
/// pages and pictures.
///
///     convert_motions("dance.bvh", "dance.glb", {.edits = {.mirror = true}});
///     FolderConversion done;
///     convert_folder("clips", "pages", ".html", {}, done);
///     use(done.converted, done.failures);
#pragma once

#include <filesystem>  // files
#include <functional>  // what a model makes of a motion
#include <map>         // notes
#include <optional>    // a skeleton
#include <set>         // names that are taken
#include <span>        // motions
#include <string>      // notes
#include <utility>     // pair
#include <vector>      // failures

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/view/shown_body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The changes of motions between reading and writing. At most one of `rig`, `body`, `features` and `data_set` is set,
/// and what they point to must outlive the conversion.
struct MotionConversion {
  MotionReadOptions read{};
  TimeEdits time{};
  std::function<Motion(const Motion&)> denoise{};  // after the edits of its time; none: unchanged
  MotionEdits edits{};
  std::optional<Skeleton> skeleton{};  // of the result; none: its own
  /// Adds the motions to a character's file and reports in lines how its skeleton follows (formats/glb_rig.hpp).
  std::function<std::string(const std::filesystem::path&, std::span<const Motion>)> rig{};
  const ShownBody* body = nullptr;        // shows the motions
  std::string features{};                 // a name of motion_features.hpp: write rows of these features, not motions
  const DataSetForm* data_set = nullptr;  // the result is a clip of a folder of this form
  bool replace = false;                   // a clip replaces another motion of the same name
  double scale = 100;                     // units per metre of a BVH file to write
  InputFiles inputs{};                    // further files that must not be overwritten
};

/// Lines about a conversion.
struct ConversionNotes {
  std::string input{};    // lines that begin with the name of the input: what it has and the result lacks
  std::string results{};  // what was written
};

/// Converts every motion of a file. Several go into one file if the format holds them, else each into a file of its
/// own:
/// out_walk.bvh, out_jump.bvh. If one fails, the others are still converted.
/// notes   are filled even if an error is thrown
/// taken   the names that clips or files have already; new names are added; null: none
/// Throws  config_error 101 if some of several motions could not be made, with the reasons; option_error 101 if nothing
///         is between the times, 102 for a result that would replace an input, 103 for an extension that cannot be
///         written; what read_motions, the edits and the writers throw
void convert_motions(const std::filesystem::path& in, const std::filesystem::path& out, const MotionConversion& how,
                     ConversionNotes* notes = nullptr, std::set<std::string>* taken = nullptr);

/// The outcome for the files of a folder.
struct FolderConversion {
  std::size_t files = 0, done = 0, converted = 0;
  std::vector<std::string> failures{};  // the file, and the reason
  /// Notes without the name of the file at their beginning: the first such line, and how many more files have it.
  std::map<std::string, std::pair<std::string, Index>> notes{};
};
/// The motion files in a folder and below it, as input for convert_files.
/// extension  of the results; ".npy" for a data set
/// skipped    gets a line for each skipped file and folder
/// Throws     option_error 102 for results that would be among the originals; config_error 101 if there is no motion
///            file, and what motion_files_below throws
std::vector<std::filesystem::path> files_to_convert(const std::filesystem::path& in, const std::filesystem::path& out,
                                                    const std::string& extension, std::string* skipped = nullptr);
/// Converts the files of a folder to the same place below another folder, or into a data set. If one fails, the others
/// are still converted.
/// out        "": beside each motion, as walk.bvh.html
/// extension  of the results; ignored for a data set
/// result     is filled even if an error is thrown
/// Throws     cancelled
void convert_files(const std::vector<std::filesystem::path>& files, const std::filesystem::path& in,
                   const std::filesystem::path& out, const std::string& extension, MotionConversion how,
                   FolderConversion& result, Progress progress = {});
/// Calls files_to_convert and convert_files. Throws what they throw.
void convert_folder(const std::filesystem::path& in, const std::filesystem::path& out, const std::string& extension,
                    MotionConversion how, FolderConversion& result, Progress progress = {});

/// The default path of a page or a picture: the whole name of the motion's file and the extension, because NAME.html
/// beside NAME.bvh may be another page.
inline std::filesystem::path beside_motion(const std::filesystem::path& motion, const std::string& extension) {
  return motion.string() + extension;
}

/// "walk.glb: 60 frames at 20 per second, 3.00 s, 24 joints" and the end of the line, for a motion that was written.
std::string line_about_motion(const std::filesystem::path& path, const Motion& motion);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/convert_motions.ipp>
#endif
