// SPDX-License-Identifier: MIT
// Bodies of actor_clips.hpp.
#pragma once

#include <algorithm>
#include <numbers>
#include <set>

#include <motionlang/datasets/actor_clips.hpp>
#include <motionlang/features/pose_representation.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>
#include <motionlang/kinematics/root_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Index ActorClipsConfig::numbers() const { return is_xyz() ? 3 : size(parse_pose_representation(pose)); }

MOTIONLANG_BODY void ActorClipsConfig::require_sound() const {
  if (random_frames && (random_step || sampling_step != 1))
    raise<config_error>(102, "clips.random_frames has no steps; clips.random_step is ", random_step ? "true" : "false",
                        ", clips.sampling_step ", sampling_step);
}

namespace detail {

inline Motion turned_motion(Motion motion, const Quaternion<double>& turn) {
  for (Index f = 0; f < motion.frames(); ++f) {
    auto& root = motion.root[static_cast<std::size_t>(f)];
    root = rotate(turn, root);
    motion.rotations(f)[0] = turn * motion.rotations(f)[0];
  }
  return motion;
}
/// The clip turned about the vertical axis so that it begins facing +Z.
inline Motion turned_to_z(const Motion& motion) {
  if (motion.frames() == 0) return motion;
  const auto ahead = rotate(motion.rotations(0)[0], Vec3<double>{0, 0, 1});
  return turned_motion(motion, from_axis_angle(Vec3<double>{0, 1, 0}, -std::atan2(ahead.x, ahead.z)));
}
/// From our world, where Y is up, to that of the camera; and back.
inline Motion turned_for_camera(const Motion& motion) {
  return turned_motion(motion, from_axis_angle(Vec3<double>{1, 0, 0}, std::numbers::pi));
}

inline ActorFeatureOptions actor_feature_options(const ActorClipsConfig& c) {
  return {.rotations = parse_pose_representation(c.pose), .translation = c.translation, .global = c.global};
}

inline std::vector<double> actor_rows(const Motion& given, const ActorClipsConfig& c) {
  const Motion ahead = c.turned_ahead ? turned_to_z(given) : given,
               motion = c.camera ? turned_for_camera(ahead) : ahead;
  std::vector<double> out;
  if (c.is_xyz()) {
    for (const auto& p : motion.positions()) {
      const auto from = p - motion.root_at(0);
      out.insert(out.end(), {from.x, from.y, from.z});
    }
    return out;
  }
  std::vector<Matrix3<double>> rotations;
  for (const auto& q : motion.local) rotations.push_back(to_matrix(q));
  return actor_frame_features(std::span<const Matrix3<double>>(rotations), std::span<const Vec3<double>>(motion.root),
                              motion.skeleton.size(), actor_feature_options(c));
}

}  // namespace detail

MOTIONLANG_BODY ActorClipsConfig published_actor_clips(const std::optional<ActorFeatureOptions>& rotations) {
  ActorClipsConfig out;
  out.pose = "xyz";
  if (rotations) {
    out.pose = std::string(pose_representation_names[static_cast<std::size_t>(rotations->rotations)]);
    out.translation = rotations->translation, out.global = rotations->global;
  }
  out.turned_ahead = false, out.camera = true, out.fps = 20;
  return out;
}

MOTIONLANG_BODY RowMaker actor_row_maker(const ActorClipsConfig& config) {
  return {"actor", config.width(), config.fps, [config](const Motion& m) { return detail::actor_rows(m, config); }};
}

MOTIONLANG_BODY std::vector<float> actor_window(const DescribedMotion& motion, const ActorClipsConfig& c,
                                                PythonRandom& random) {
  const auto width = static_cast<std::size_t>(c.width());
  const Index frames = std::ssize(motion.rows) / c.width();
  Index wanted = c.num_frames;
  if (wanted == -1) wanted = std::min(frames, c.max_len);
  if (wanted == -2)
    wanted = static_cast<Index>(random.randint(c.min_len, std::max(std::min(frames, c.max_len), c.min_len)));
  std::vector<float> out;
  const ActorFrameOptions taken{
      .frames = wanted, .random_step = c.random_step, .step = c.sampling_step, .scattered = c.random_frames};
  for (const Index f : actor_frames(frames, taken, random)) {
    const auto at = motion.rows.begin() + static_cast<std::ptrdiff_t>(f) * c.width();
    out.insert(out.end(), at, at + c.width());
  }
  // positions count from the root of the first frame
  const std::size_t first = c.is_xyz() ? 0 : static_cast<std::size_t>(c.way());
  if (c.is_xyz() || c.translation) {
    const float origin[] = {out[first], out[first + 1], out[first + 2]};
    const std::size_t points = c.is_xyz() ? 24 : 1;
    for (std::size_t at = first; at < out.size(); at += width) {
      for (std::size_t i = 0; i < 3 * points; ++i) out[at + i] -= origin[i % 3];
    }
  }
  return out;
}

MOTIONLANG_BODY Motion actor_motion(std::span<const float> rows, const ActorClipsConfig& c) {
  const auto& skeleton = smpl24_skeleton();
  if (c.is_xyz()) {
    std::vector<Vec3<double>> joints;
    for (std::size_t at = 0; at + 2 < rows.size(); at += 3)
      joints.push_back(vec_cast<double>(Vec3<float>{rows[at], rows[at + 1], rows[at + 2]}));
    const Motion out = motion_from_joints(skeleton, joints, c.fps);
    return c.camera ? detail::turned_for_camera(out) : out;
  }
  const auto motion = actor_inverse(rows, 24, detail::actor_feature_options(c));
  Motion out{skeleton, c.fps, {}, {}, {}};
  for (const auto& r : motion.rotations) out.local.push_back(to_quaternion(matrix_cast<double>(r)));
  if (!c.global) {
    for (std::size_t at = 0; at < out.local.size(); at += 24) out.local[at] = Quaternion<double>::identity();
  }
  for (const auto& p : motion.root) out.root.push_back(vec_cast<double>(p));
  return c.camera ? detail::turned_for_camera(out) : out;
}

MOTIONLANG_BODY std::vector<std::string> labels_of(const DescribedMotions& data) {
  std::set<std::string> labels;
  for (const auto* part : data.parts()) {
    for (const DescribedMotion& m : *part) labels.insert(m.texts.front().text);
  }
  return {labels.begin(), labels.end()};
}

MOTIONLANG_BODY std::vector<Index> classes_of(const std::vector<DescribedMotion>& motions,
                                              std::span<const std::string> labels) {
  std::vector<Index> out;
  for (const DescribedMotion& m : motions) {
    const auto found = std::find(labels.begin(), labels.end(), m.texts.front().text);
    if (found == labels.end())
      raise<config_error>(103, m.id, ": the label '", m.texts.front().text, "' is not a class of the model");
    out.push_back(found - labels.begin());
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
