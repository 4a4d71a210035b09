// SPDX-License-Identifier: MIT
/// Files of motion to other files, edited on the way: motions, features, clips of a data set, characters, bodies, pages
/// and pictures.
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
  std::function<Motion(const Motion&)> denoise{};  // after its time was edited; none: it stays
  MotionEdits edits{};
  std::optional<Skeleton> skeleton{};  // of the result; none: its own
  /// Adds the motions to a character's file and says in lines how its skeleton follows (formats/glb_rig.hpp).
  std::function<std::string(const std::filesystem::path&, std::span<const Motion>)> rig{};
  const ShownBody* body = nullptr;        // that motions are shown on
  std::string features{};                 // rows of them are written, not motions; of motion_features.hpp
  const DataSetForm* data_set = nullptr;  // the result is a clip of a folder of this form
  bool replace = false;                   // a clip takes the place of another motion that has its name there
  double scale = 100;                     // units per metre of a BVH file that is written
  InputFiles inputs{};                    // further files that must not be written
};

/// Lines about a conversion.
struct ConversionNotes {
  std::string input{};    // begin with the name of the input: what it has and the result lacks
  std::string results{};  // what was written
};

/// Every motion of a file. Several go into one file where the format holds them, else each into a file of its own:
/// out_walk.bvh, out_jump.bvh. One that fails stops no other.
/// notes   are filled also where something is thrown
/// taken   names that clips or files have already, and get; null: none
/// Throws  config_error 101 if some of several motions could not be made, with the reasons; option_error 101 if nothing
///         is between the times, 102 for a result in the place of an input, 103 for an extension that is not written;
///         what read_motions, the edits and the writers throw
void convert_motions(const std::filesystem::path& in, const std::filesystem::path& out, const MotionConversion& how,
                     ConversionNotes* notes = nullptr, std::set<std::string>* taken = nullptr);

/// The outcome for the files of a folder.
struct FolderConversion {
  std::size_t files = 0, done = 0, converted = 0;
  std::vector<std::string> failures{};  // the file, and why
  /// Without the name of the file at its beginning: the first such line, and how many files more have it.
  std::map<std::string, std::pair<std::string, Index>> notes{};
};
/// The motion files in a folder and below it, which convert_files is given.
/// extension  of the results, ".npy" of a data set
/// skipped    gets a line for each file and folder that is skipped
/// Throws     option_error 102 for motions that would be among the originals; config_error 101 if there is no motion
///            file, and what motion_files_below throws
std::vector<std::filesystem::path> files_to_convert(const std::filesystem::path& in, const std::filesystem::path& out,
                                                    const std::string& extension, std::string* skipped = nullptr);
/// Converts the files of a folder to the same place below another folder, or into a data set. One that fails stops no
/// other.
/// out        "": beside each motion, as walk.bvh.html
/// extension  of the results; of a data set it counts for nothing
/// result     is filled also where something is thrown
/// Throws     cancelled
void convert_files(const std::vector<std::filesystem::path>& files, const std::filesystem::path& in,
                   const std::filesystem::path& out, const std::string& extension, MotionConversion how,
                   FolderConversion& result, Progress progress = {});
/// Both one after the other. Throws what they throw.
void convert_folder(const std::filesystem::path& in, const std::filesystem::path& out, const std::string& extension,
                    MotionConversion how, FolderConversion& result, Progress progress = {});

/// A page or a picture that is given no name: under the whole name of the motion's file, as NAME.html beside NAME.bvh
/// may be another one.
inline std::filesystem::path beside_motion(const std::filesystem::path& motion, const std::string& extension) {
  return motion.string() + extension;
}

/// "walk.glb: 60 frames at 20 per second, 3.00 s, 24 joints" and the end of the line, for a motion that is in a file
/// now.
std::string line_about_motion(const std::filesystem::path& path, const Motion& motion);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/convert_motions.ipp>
#endif
