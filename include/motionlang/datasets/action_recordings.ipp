// SPDX-License-Identifier: MIT
// Bodies of action_recordings.hpp.
#pragma once

#include <algorithm>  // find, min, max
#include <cmath>      // sqrt
#include <numbers>    // pi
#include <optional>   // entries

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/action_names.hpp>
#include <motionlang/datasets/action_recordings.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/pickle_arrays.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::size_t vibe_joints = 49, vibe_hip = 8;  // SPIN's joints; the middle of the hips
inline constexpr int uestc_action_count = 40;

/// An array of a pickle whose rows have `width` numbers.
inline std::vector<double> pickled_rows(const PickleValue& value, Index width) {
  const NpyArray array = to_array(value);
  Index in_row = 1;
  for (std::size_t i = 1; i < array.shape.size(); ++i) in_row *= array.shape[i];
  if (array.shape.empty() || in_row != width)
    value.fail(407, "an array ", shape_text(array.shape), ", expected rows of ", counted(width, "number"));
  auto out = array.to<double>();
  if (!std::all_of(out.begin(), out.end(), [](double x) { return std::isfinite(x); }))
    value.fail(403, "an array with numbers that are not finite");
  return out;
}

inline std::vector<Vec3<double>> pickled_points(const PickleValue& value, Index per_frame) {
  const auto numbers = pickled_rows(value, 3 * per_frame);
  std::vector<Vec3<double>> out;
  for (std::size_t i = 0; i < numbers.size(); i += 3) out.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  return out;
}

/// A motion in our world, from what a camera sees: across, down, away.
/// poses  (frames, 72) rotation vectors
/// turn   of the whole in the world of the camera
inline Motion seen_motion(std::span<const double> poses, std::span<const Vec3<double>> root,
                          const Quaternion<double>& turn, double fps) {
  const auto upright = from_axis_angle(Vec3<double>{1, 0, 0}, std::numbers::pi) * turn;
  Motion out{smpl24_skeleton(), fps, {}, {}, {}};
  for (const auto& p : root) out.root.push_back(rotate(upright, p));
  for (std::size_t i = 0; i < 72 * root.size(); i += 3) {
    const auto q = to_quaternion(AxisAngle<double>{{poses[i], poses[i + 1], poses[i + 2]}});
    out.local.push_back(i % 72 == 0 ? upright * q : q);
  }
  return out;
}

/// Throws io_error 407 unless there are as many poses as root positions.
inline void require_same_frames(const PickleValue& at, std::size_t poses, std::size_t points) {
  if (poses != 72 * points || points == 0)
    at.fail(407, counted(poses / 72, "pose"), " and ", counted(points, "frame"), " of joints");
}

inline LeftOut read_humanact12(const FilePath& folder, double fps, const std::function<void(ActionRecording)>& use,
                               Progress progress) {
  const FilePath path = folder.string() + "/humanact12poses.pkl";
  const Pickle file = Pickle::open(path, {.inline_bytes = joblib_array_bytes});
  const PickleValue poses = file.root()["poses"], joints = file.root()["joints3D"], classes = file.root()["y"];
  if (poses.size() != joints.size() || poses.size() != classes.size())
    raise<io_error>(407, path.string(), ": ", poses.size(), " poses, ", joints.size(), " joints3D and ", classes.size(),
                    " y");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto rotations = pickled_rows(poses[i], 72);
    const auto points = pickled_points(joints[i], 24);
    require_same_frames(poses[i], rotations.size(), points.size() / 24);
    const auto action = to_array(classes[i]).value<std::int64_t>();
    if (action < 0 || action >= std::ssize(humanact12_actions))
      classes[i].fail(403, "class ", action, " of ", std::size(humanact12_actions));
    std::vector<Vec3<double>> root;
    for (std::size_t at = 0; at < points.size(); at += 24) root.push_back(points[at]);
    use({std::to_string(i), std::string(humanact12_actions[action]),
         seen_motion(rotations, root, Quaternion<double>::identity(), fps)});
    progress(static_cast<Index>(i) + 1, static_cast<Index>(poses.size()));
  }
  return {};
}

/// The number in a text. Throws io_error 403.
inline int whole_number(std::string_view digits, std::string_view where) {
  int value = 0;
  const auto [end, problem] = from_chars(digits.data(), digits.data() + digits.size(), value);
  if (problem != std::errc() || end != digits.data() + digits.size() || digits.empty() || value < 0)
    raise<io_error>(403, where, ": '", utf8_head(digits, 40), "' is not a whole number");
  return value;
}

inline LeftOut read_uestc(const FilePath& folder, double fps, const std::function<void(ActionRecording)>& use,
                          Progress progress) {
  const FilePath path = folder.string() + "/vibe_cache_refined.pkl",
                 lengths_path = folder.string() + "/info/num_frames_min.txt";
  const auto names = read_ids(folder.string() + "/info/names.txt"), lengths = read_ids(lengths_path);
  constexpr std::size_t most = 40'000'000;  // 25600 videos of seven arrays
  const Pickle file = Pickle::open(path, {.max_values = most, .inline_bytes = joblib_array_bytes});
  const PickleValue poses = file.root()["pose"], joints = file.root()["joints3d"], cameras = file.root()["orig_cam"];
  for (const std::size_t n : {lengths.size(), poses.size(), joints.size(), cameras.size()}) {
    if (n != names.size())
      raise<io_error>(407, path.string(), ": ", names.size(), " names, ", lengths.size(), " num_frames_min, ",
                      poses.size(), " pose, ", joints.size(), " joints3d and ", cameras.size(), " orig_cam");
  }
  LeftOut left_out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    progress(static_cast<Index>(i) + 1, static_cast<Index>(names.size()));
    const UestcVideo video = parse_uestc_video(names[i]);
    if (video.action >= uestc_action_count)
      raise<io_error>(403, folder.string(), "/info/names.txt: ", names[i], ": action ", video.action, " of ",
                      uestc_action_count);
    if (video.camera != 1 && video.view == 8) {
      left_out.add("of a camera that moves", names[i]);
      continue;
    }
    const auto rotations = pickled_rows(poses[i], 72), camera = pickled_rows(cameras[i], 4);
    const auto points = pickled_points(joints[i], vibe_joints);
    const std::size_t found = points.size() / vibe_joints;
    require_same_frames(poses[i], rotations.size(), found);
    if (camera.size() != 4 * found) cameras[i].fail(407, counted(camera.size() / 4, "frame"), ", expected ", found);
    const auto frames = std::min(found, static_cast<std::size_t>(whole_number(lengths[i], lengths_path.string())));
    if (frames == 0) {
      left_out.add("without frames", names[i]);
      continue;
    }
    const auto path_of_root = uestc_path(camera, points);
    std::vector<Vec3<double>> root;
    for (std::size_t f = 0; f < frames; ++f) root.push_back(points[f * vibe_joints + vibe_hip] + path_of_root[f]);
    const double angle = video.camera == 1 ? 0 : -video.view * std::numbers::pi / 4;
    const bool training = trains_with_uestc_subject(video.subject);
    use({names[i], std::to_string(video.action),
         seen_motion(rotations, root, from_axis_angle(Vec3<double>{0, 1, 0}, angle), fps), training, !training});
  }
  return left_out;
}

/// The value at the whole number `key` of a dictionary.
inline std::optional<PickleValue> numbered_entry(const PickleValue& dictionary, std::int64_t key) {
  for (std::size_t i = 0; dictionary.keyed() && i < dictionary.size(); ++i) {
    const PickleValue k = dictionary.key(i);
    if (k.is(PickleKind::integer) ? k.integer() == key : is_numpy_scalar(k) && to_array(k).value<std::int64_t>() == key)
      return dictionary.value(i);
  }
  return std::nullopt;
}

inline LeftOut read_ntu13(const FilePath& folder, double fps, const std::function<void(ActionRecording)>& use,
                          Progress progress) {
  const auto paths = read_ids(folder.string() + "/ntu_vibe_list.txt");
  LeftOut left_out;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    progress(static_cast<Index>(i) + 1, static_cast<Index>(paths.size()));
    const int action = ntu13_class(paths[i]);
    if (action < 0) {
      left_out.add("of another action", paths[i]);
      continue;
    }
    const Pickle file = Pickle::open(folder.string() + "/" + paths[i], {.inline_bytes = joblib_array_bytes});
    const auto person = numbered_entry(file.root(), 1);
    if (!person) {
      left_out.add("without a person 1", paths[i]);
      continue;
    }
    const auto rotations = pickled_rows((*person)["pose"], 72);
    const auto points = pickled_points((*person)["joints3d"], vibe_joints);
    require_same_frames(*person, rotations.size(), points.size() / vibe_joints);
    std::vector<Vec3<double>> root;
    for (std::size_t at = vibe_hip; at < points.size(); at += vibe_joints) root.push_back(points[at]);
    use({paths[i], std::to_string(action), seen_motion(rotations, root, Quaternion<double>::identity(), fps)});
  }
  return left_out;
}

}  // namespace detail

MOTIONLANG_BODY std::string action_data_set(const std::filesystem::path& folder) {
  for (const auto& [name, file] : {std::pair("humanact12", "humanact12poses.pkl"),
                                   {"uestc", "vibe_cache_refined.pkl"},
                                   {"ntu13", "ntu_vibe_list.txt"}}) {
    if (std::filesystem::exists(folder / file)) return name;
  }
  return "";
}

MOTIONLANG_BODY LeftOut read_action_recordings(std::string_view name, const FilePath& folder, double fps,
                                               const std::function<void(ActionRecording)>& use, Progress progress) {
  if (name == "humanact12") return detail::read_humanact12(folder, fps, use, progress);
  if (name == "ntu13") return detail::read_ntu13(folder, fps, use, progress);
  if (name == "uestc") return detail::read_uestc(folder, fps, use, progress);
  raise<config_error>(103, "data set '", name, "' is not humanact12, uestc or ntu13");
}

MOTIONLANG_BODY UestcVideo parse_uestc_video(std::string_view name) {
  UestcVideo out;
  std::size_t at = 0;
  for (const auto& [letter, value] :
       {std::pair('a', &out.action), {'d', &out.view}, {'p', &out.subject}, {'c', &out.camera}}) {
    const std::size_t end = std::min(name.find('_', at), name.size());
    if (at >= name.size() || name[at] != letter)
      raise<io_error>(403, "'", utf8_head(name, 60), "' is not the name of a video, such as a12_d3_p045_c2_color.avi");
    *value = detail::whole_number(name.substr(at + 1, end - at - 1), name);
    at = end + 1;
  }
  return out;
}

MOTIONLANG_BODY bool trains_with_uestc_subject(int subject) {
  constexpr int people[] = {1,  2,  6,  12, 13, 16, 21, 24, 28, 29, 30,  31,  33,  35,  39,  41,  42,
                            45, 47, 50, 52, 54, 55, 57, 59, 61, 63, 64,  67,  69,  70,  71,  73,  77,
                            81, 84, 86, 87, 88, 90, 91, 93, 96, 99, 102, 103, 104, 107, 108, 112, 113};
  return std::binary_search(std::begin(people), std::end(people), subject);
}

MOTIONLANG_BODY std::vector<Vec3<double>> uestc_path(std::span<const double> camera,
                                                     std::span<const Vec3<double>> joints) {
  const std::size_t frames = camera.size() / 4, count = frames == 0 ? 0 : joints.size() / frames;
  constexpr double focal = 500, height = 540;
  std::vector<Vec3<double>> out;
  for (std::size_t f = 0; f < frames; ++f) {
    const double scale = camera[4 * f], x = camera[4 * f + 2], y = camera[4 * f + 3];
    Vec3<double> least = joints[f * count], most = least;
    for (std::size_t j = 1; j < count; ++j) {
      const Vec3<double>& p = joints[f * count + j];
      least = {std::min(least.x, p.x), std::min(least.y, p.y), 0};
      most = {std::max(most.x, p.x), std::max(most.y, p.y), 0};
    }
    const double across = most.x - least.x, down = most.y - least.y, extent = std::sqrt(across * across + down * down);
    const double in_picture = std::abs(scale) * 0.5 * height * extent;  // shifts do not change it
    out.push_back({x, y, in_picture > 0 ? focal * extent / in_picture : 0});
  }
  for (std::size_t f = frames; f-- > 0;) out[f] = out[f] - out[0];
  return out;
}

MOTIONLANG_BODY int ntu13_class(std::string_view path) {
  constexpr int kept[] = {6, 7, 8, 9, 22, 23, 24, 38, 80, 93, 99, 100, 102};
  const std::size_t letter = path.find('A');
  if (letter == path.npos || path.size() < letter + 5)
    raise<io_error>(403, "'", utf8_head(path, 60), "' has no number of an action behind an A");
  const int action = detail::whole_number(path.substr(letter + 1, path.size() - 4 - letter - 1), path);
  const auto found = std::find(std::begin(kept), std::end(kept), action);
  return found == std::end(kept) ? -1 : static_cast<int>(found - std::begin(kept));
}

MOTIONLANG_NAMESPACE_END
