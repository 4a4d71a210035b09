// SPDX-License-Identifier: MIT
// Bodies of amass.hpp.
#pragma once

#include <cmath>    // isfinite
#include <numbers>  // pi

#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::size_t amass_columns = 156;  // SMPL-H: and 2 x 45 numbers of fingers

inline Quaternion<double> quarter_turn_about_x(double sign) {
  return from_axis_angle(Vec3<double>{1, 0, 0}, sign * std::numbers::pi / 2);
}

/// Throws config_error 106 unless the skeleton begins with SMPL's body joints.
inline void require_smpl(const Skeleton& skeleton) {
  const Skeleton& smpl = smpl24_skeleton();
  if (skeleton.size() < static_cast<int>(amass_joints)) {
    raise<config_error>(106, "AMASS: the skeleton has ", counted(skeleton.size(), "joint"), ", SMPL's body has ",
                        amass_joints);
  }
  for (int j = 0; j < static_cast<int>(amass_joints); ++j) {
    if (skeleton.name(j) != smpl.name(j) || skeleton.parent(j) != smpl.parent(j)) {
      raise<config_error>(106, "AMASS: joint ", j, " is '", skeleton.name(j), "' where SMPL has '", smpl.name(j),
                          "': retarget the motion first");
    }
  }
}

}  // namespace detail

MOTIONLANG_BODY void write_amass(const FilePath& path, const Motion& motion, const AmassBody& body,
                                 const Vec3<double>& rest_pelvis) {
  write_file(path, amass_bytes(motion, body, rest_pelvis, path.string()));
}

MOTIONLANG_BODY std::vector<std::byte> amass_bytes(const Motion& motion, const AmassBody& body,
                                                   const Vec3<double>& rest_pelvis, const std::string& name) {
  motion.validate();
  detail::require_smpl(motion.skeleton);
  detail::require_finite_betas(name, body.betas);
  std::vector<double> trans, poses;
  const Quaternion<double> upright = detail::quarter_turn_about_x(1);
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    const Vec3<double> t = y_up_to_z_up(motion.root_at(frame)) - rest_pelvis;
    trans.insert(trans.end(), {t.x, t.y, t.z});
    const auto local = motion.rotations(frame);
    for (std::size_t j = 0; j < detail::amass_joints; ++j) {
      const Vec3<double> v = to_axis_angle(normalized(j == 0 ? upright * local[0] : local[j])).v;
      poses.insert(poses.end(), {v.x, v.y, v.z});
    }
    poses.resize(static_cast<std::size_t>(frame + 1) * detail::amass_columns, 0.0);
  }
  const Index frames = motion.frames();
  const std::vector<NamedArray> arrays{
      {"trans", NpyArray::of(std::span<const double>(trans), {frames, 3})},
      {"gender", NpyArray::text(body.gender)},
      {"mocap_framerate", NpyArray::scalar(motion.fps)},
      {"mocap_frame_rate", NpyArray::scalar(motion.fps)},  // the spelling of SMPL-X tools
      {"betas", NpyArray::of(std::span<const double>(body.betas), {static_cast<Index>(body.betas.size())})},
      {"poses", NpyArray::of(std::span<const double>(poses), {frames, static_cast<Index>(detail::amass_columns)})}};
  return npz_bytes(arrays);
}

namespace detail {

MOTIONLANG_BODY Quaternion<double> amass_rotation(const AmassSequence& sequence, Index frame, Index joint) {
  const double* const v = sequence.poses.data() + frame * sequence.columns + 3 * joint;
  return to_quaternion(AxisAngle<double>{{v[0], v[1], v[2]}});
}

}  // namespace detail

MOTIONLANG_BODY Motion amass_motion(const AmassSequence& sequence, std::string name, const Vec3<double>& rest_pelvis) {
  Motion motion{smpl24_skeleton(), sequence.fps, {}, {}, std::move(name)};
  const Index joints = motion.skeleton.size();
  motion.local.assign(static_cast<std::size_t>(sequence.frames * joints), Quaternion<double>::identity());
  const Quaternion<double> lying = detail::quarter_turn_about_x(-1);
  for (Index frame = 0; frame < sequence.frames; ++frame) {
    const double* const t = sequence.trans.data() + 3 * frame;
    motion.root.push_back(z_up_to_y_up(Vec3<double>{t[0], t[1], t[2]} + rest_pelvis));
    const auto local = motion.rotations(frame);
    for (std::size_t j = 0; j < detail::amass_joints; ++j) {
      const auto q = detail::amass_rotation(sequence, frame, static_cast<Index>(j));
      local[j] = j == 0 ? lying * q : q;
    }
  }
  motion.validate();
  return motion;
}

MOTIONLANG_BODY AmassClip read_amass(const FilePath& path, const Vec3<double>& rest_pelvis, double fps) {
  AmassSequence sequence = read_amass_sequence(path, fps);
  AmassClip clip{amass_motion(sequence, path.stem(), rest_pelvis), {}};
  clip.body.gender = std::move(sequence.gender);
  if (!sequence.betas.empty()) clip.body.betas = std::move(sequence.betas);
  return clip;
}

MOTIONLANG_BODY void write_joints_npy(const FilePath& path, const Motion& motion) {
  write_file(path, joints_npy_bytes(motion));
}

MOTIONLANG_BODY std::vector<std::byte> joints_npy_bytes(const Motion& motion) {
  motion.validate();
  std::vector<float> values;
  for (const Vec3<double>& p : motion.positions()) {
    const Vec3<float> v = vec_cast<float>(y_up_to_z_up(p));
    if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z))) {
      const Index at = std::ssize(values) / 3, joints = motion.skeleton.size();
      raise<numeric_error>(301, "write_joints_npy: joint ", at % joints, " of frame ", at / joints, " is at (", p.x,
                           ", ", p.y, ", ", p.z, "), too far for float32");
    }
    values.insert(values.end(), {v.x, v.y, v.z});
  }
  return npy_bytes(NpyArray::of(std::span<const float>(values), {motion.frames(), motion.skeleton.size(), 3}));
}

MOTIONLANG_BODY JointPositions read_joints_npy(const FilePath& path) {
  const NpyArray array = read_npy(path);
  if (array.shape.size() != 3 || array.shape[2] != 3) {
    raise<io_error>(407, path.string(), ": not an array (frames, joints, 3)");
  }
  JointPositions out{array.shape[0], array.shape[1], {}};
  const std::vector<double> v = array.to<double>();
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) out.positions.push_back(z_up_to_y_up({v[i], v[i + 1], v[i + 2]}));
  return out;
}

MOTIONLANG_NAMESPACE_END
