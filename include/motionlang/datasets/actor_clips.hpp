// SPDX-License-Identifier: MIT
/// Motions in the form that ACTOR and its classifiers read: rows of rotations and the path of the root, windows of
/// frames, and points.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <motionlang/core/fields.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/features/pose_representation.hpp>
#include <motionlang/kinematics/body_model.hpp>
#include <motionlang/kinematics/forward_batch.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/tensor/sequences.hpp>

#include <motionlang/datasets/described_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct ActorClipsConfig {
  std::string pose = "rot6d";  // "xyz", "rotvec", "rotquat", "rotmat"
  bool translation = true;     // the path of the root is a row of its own; not for xyz
  bool global = true;          // includes the rotation of joint 0; without it all face +Z; not for xyz
  bool turned_ahead = true;    // every clip begins facing +Z
  bool camera = false;         // rotations in the world of a camera, where figures are upside down, as published
  double fps = 30;
  Index num_frames = 60;    // of a training item; -1: the whole clip, -2: between min_len and max_len
  Index sampling_step = 1;  // frames from one to the next; -1: the largest step that fits
  bool random_step = false;
  bool random_frames = false;  // any frames of the clip, in their order
  Index min_len = 60, max_len = 100;

  /// Throws config_error 102 if settings contradict each other.
  void require_sound() const;
  static constexpr auto fields() {
    using C = ActorClipsConfig;
    return motionlang::fields("pose", &C::pose, "translation", &C::translation, "global", &C::global, "turned_ahead",
                              &C::turned_ahead, "camera", &C::camera, "fps", &C::fps, "num_frames", &C::num_frames,
                              "sampling_step", &C::sampling_step, "random_step", &C::random_step, "random_frames",
                              &C::random_frames, "min_len", &C::min_len, "max_len", &C::max_len);
  }
  bool is_xyz() const { return pose == "xyz"; }
  /// Joints with a row in each frame, all its rows, and the values of each row.
  Index rotations() const { return is_xyz() || global ? 24 : 23; }
  Index joints() const { return rotations() + (is_xyz() || !translation ? 0 : 1); }
  Index numbers() const;
  Index width() const { return joints() * numbers(); }
  /// The position in a frame at which the path of the root begins.
  Index way() const { return rotations() * numbers(); }
};

/// The clips of a published ACTOR: 20 frames per second as in its viewer, in the world of a camera, not turned ahead.
/// rotations  none: frames have the position of each joint
ActorClipsConfig published_actor_clips(const std::optional<ActorFeatureOptions>& rotations);

/// Throws config_error 103 for an unknown pose.
RowMaker actor_row_maker(const ActorClipsConfig& config);

/// The frames of an item (features/frame_sampling.hpp). The path starts at the first of them. (frames, width)
std::vector<float> actor_window(const DescribedMotion& motion, const ActorClipsConfig& config, PythonRandom& random);

/// A clip on SMPL's 24 joints from rows.
Motion actor_motion(std::span<const float> rows, const ActorClipsConfig& config);

/// All labels of the data, sorted. The number of a class is its place here.
std::vector<std::string> labels_of(const DescribedMotions& data);
/// The number of each motion's class. Throws config_error 103 for a label that is not a class.
std::vector<Index> classes_of(const std::vector<DescribedMotion>& motions, std::span<const std::string> labels);

/// Positions of the 24 joints in metres, relative to the root of the first frame of the window. (frames, 72)
template <Backend B>
Sequences<B> joint_points(const Sequences<B>& x, const ActorClipsConfig& config) {
  if (config.is_xyz()) return x;
  const Index frames = x.rows.size(0), numbers = config.numbers();
  auto rotations = slice(x.rows, 1, 0, config.way());
  if (config.pose != "rot6d") {
    const auto form = parse_pose_representation(config.pose);
    const auto matrices = rotation_rows(reshape<3>(rotations, {frames, config.rotations(), numbers}),
                                        [form](const auto& n) { return rotation_from(form, n); });
    rotations = reshape<2>(slice(matrices, 2, 0, 6), {frames, 6 * config.rotations()});
  }
  if (!config.global) {
    const auto ahead = Tensor<B, 2>::from(std::vector<typename B::scalar>{1, 0, 0, 0, 1, 0}, {1, 6});
    rotations = concat(1, broadcast_to<2>(ahead, {frames, 6}), rotations);
  }
  const auto root =
      config.translation ? slice(x.rows, 1, config.way(), config.way() + 3) : Tensor<B, 2>::zeros({frames, 3});
  const auto places = forward_kinematics(
      smpl24_skeleton(), lanes(reshape<4>(rotations, {1, frames, 24, 6}), reshape<3>(root, {1, frames, 3})));
  return x.with(reshape<2>(places, {frames, 72}));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/actor_clips.ipp>
#endif
