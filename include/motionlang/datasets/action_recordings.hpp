// SPDX-License-Identifier: MIT
/// The data sets of ACTOR in their own files: HumanAct12, UESTC and NTU-13. The pickles are read without executing
/// anything, and each array only when its recording is wanted.
///
///     read_action_recordings("humanact12", "data/HumanAct12Poses", 30, [&](ActionRecording r) { use(r.motion); });
///
///    humanact12  humanact12poses.pkl: poses, joints3D and y of each recording
///    uestc       vibe_cache_refined.pkl, info/names.txt and num_frames_min.txt. VIBE found the poses in videos, whose
///                camera gives the path. Videos of the second camera are turned to the front
///    ntu13       ntu_vibe_list.txt, the paths of joblib files with the person 1 of a video
///
/// The classes of UESTC and NTU-13 are numbers from 0 on, as in published models.
/// The files name no frame rate: motions keep their frames, and have the rate of the caller. They are turned from the
/// world of a camera (Y down) to ours.
/// Source   thesis 3.3.1; ACTOR src/datasets/humanact12poses.py, uestc.py, ntu13.py
/// Differs  positions follow from the rotations on the library's own skeleton, where the published representation xyz
///          has the joints of the files. NTU-13's person 1 of a file of another action is left out and counted
#pragma once

#include <filesystem>   // folders
#include <functional>   // receivers
#include <span>         // frames
#include <string>       // names
#include <string_view>  // names
#include <vector>       // frames

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/left_out.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct ActionRecording {
  std::string id;      // a number (HumanAct12), or the name of the video
  std::string action;  // name of the class
  Motion motion;       // on SMPL's 24 joints
  bool training = true, test = true;
};

/// The name of the data set whose files a folder has; "" for other folders.
std::string action_data_set(const std::filesystem::path& folder);

/// Reads all recordings, in the order of the published lists.
/// fps     of the motions
/// Throws  config_error 103 for another name; io_error 401 to 407 of files whose arrays do not fit
LeftOut read_action_recordings(std::string_view name, const FilePath& folder, double fps,
                               const std::function<void(ActionRecording)>& use, Progress progress = {});

/// A video of UESTC: a12_d3_p045_c2_color.avi.
struct UestcVideo {
  int action = 0, view = 0, subject = 0, camera = 0;
};
/// Throws io_error 403.
UestcVideo parse_uestc_video(std::string_view name);

/// True for the 51 of 118 people whose videos are for training.
bool trains_with_uestc_subject(int subject);

/// The path of the camera's view, relative to the first frame. The depth is 500 times the extent of the joints over
/// that of their picture.
/// camera  (frames, 4): scale across and down, shift across and down
/// joints  (frames, joints) of each frame
std::vector<Vec3<double>> uestc_path(std::span<const double> camera, std::span<const Vec3<double>> joints);

/// The class of a file of NTU-13, 0 to 12, by the number behind the first "A" of its path; -1 for another action.
/// Throws io_error 403 for a path without one.
int ntu13_class(std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/action_recordings.ipp>
#endif
