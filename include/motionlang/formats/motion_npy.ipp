// SPDX-License-Identifier: MIT
// Bodies of motion_npy.hpp.
#pragma once

#include <algorithm>  // find_if
#include <cmath>      // isfinite

#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/motion_npy.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool is_joint_count(Index joints) { return joints == 24 || joints == 22 || joints == mmm_joints; }

inline Motion motion_from_positions(std::vector<Vec3<double>> joints, Index count, const MotionArrayOptions& options) {
  const Vec3<double> height = mean_height(joints, static_cast<std::size_t>(count));
  const bool z_up = options.up == UpAxis::z || (options.up == UpAxis::found && std::abs(height.z) > std::abs(height.y));
  if (z_up) {
    joints = turned_up(std::move(joints), false);
  } else if (const auto upright = upright_rotation(options.up); options.up > UpAxis::z) {
    for (Vec3<double>& p : joints) p = rotate(upright, p);
  }
  if (count != mmm_joints)
    return motion_from_joints(smpl24_skeleton(), joints, count, options.fps > 0 ? options.fps : 20);
  if (z_up || options.up > UpAxis::z) {  // these were not reflected
    for (Vec3<double>& p : joints) p.x = -p.x;
  }
  return motion_from_joints(kit21_skeleton(), mmm_in_metres(std::move(joints)), options.fps > 0 ? options.fps : 12.5);
}

inline Motion motion_from_rows(std::span<const double> rows, Index width, double fps, std::string_view name) {
  for (const MotionFeatures& f : all_motion_features) {
    if (f.width == width) return motion_of_rows(f, rows, fps);
  }
  raise<io_error>(407, name, ": rows of ", counted(width, "number"), " are not known motion features");
}

}  // namespace detail

MOTIONLANG_BODY Motion motion_from_array(const NpyArray& array, const MotionArrayOptions& options,
                                         std::string_view name) {
  if (options.fps != 0 && !(options.fps > 0 && std::isfinite(options.fps)))
    raise<config_error>(101, name, ": ", options.fps, " frames per second");
  const auto& shape = array.shape;
  const bool rows = shape.size() == 2;
  const bool joints = shape.size() == 3 && shape[2] == 3 && detail::is_joint_count(shape[1]);
  if ((!rows && !joints) || array.is_text()) {
    raise<io_error>(407, name, ": neither (frames, numbers) nor (frames, 21, 22 or 24 joints, 3)");
  }
  const std::vector<double> v = array.to<double>();
  const auto odd = std::find_if(v.begin(), v.end(), [](double x) { return !std::isfinite(x); });
  if (odd != v.end()) {
    const Index numbers = std::ssize(v) / shape[0], at = odd - v.begin();
    raise<numeric_error>(301, name, ": number ", at % numbers, " of frame ", at / numbers, " is not finite");
  }
  if (rows) return detail::motion_from_rows(v, shape[1], options.fps, name);
  std::vector<Vec3<double>> positions;
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) positions.push_back({v[i], v[i + 1], v[i + 2]});
  return detail::motion_from_positions(std::move(positions), shape[1], options);
}

MOTIONLANG_BODY Motion read_motion_npy(const FilePath& path, const MotionArrayOptions& options) {
  return motion_from_array(read_npy(path), options, path.string());
}

MOTIONLANG_NAMESPACE_END
