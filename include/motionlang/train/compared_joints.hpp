// SPDX-License-Identifier: MIT
/// The joints for comparing motions of TEACH and SINC: those of the user's SMPL-H body, as published, or those of our
/// own skeleton.
///
///     const ComparedJoints<B> joints_of("smplnh", "SMPLH_MALE.npz");
///     const JointFrames joints = joints_of(sinc_motion(normalizer, rows));      // metres, frame by frame
///
/// Differs  without a body, the ankles of our own skeleton replace the heels of the published joints
#pragma once

#include <filesystem>  // a body
#include <optional>    // a body
#include <string>      // name of the set
#include <vector>      // values

#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/smplh_joints.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/metrics/sampled_errors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
class ComparedJoints {
 public:
  /// set   of features/joint_sets.hpp
  /// body  file of an SMPL-H body; "": our own skeleton
  /// Throws config_error 102 for another body, and what read_body throws.
  explicit ComparedJoints(std::string set, const std::filesystem::path& body = {}) : set_(std::move(set)) {
    if (body.empty()) return;
    body_ = read_body<B>(body);
    if (body_->kind != BodyKind::smplh || body_->model.extra.empty())
      raise<config_error>(102, body.string(), ": a body of ", counted(body_->model.joints(), "joint"), " and ",
                          counted(body_->model.vertices(), "vertex", "vertices"),
                          "; BABEL is measured on SMPL-H's 52 and 6890");
  }

  /// clip    rotations of 22 joints and translation, Z up, at any rate
  /// Throws  config_error 103 for an unknown set
  template <Scalar S>
  JointFrames operator()(const SmplVelpMotion<S>& clip) const {
    return body_ ? on_body(clip) : on_own_skeleton(clip);
  }
  /// True if they are those of SMPL-H.
  bool has_body() const { return body_.has_value(); }

 private:
  template <Scalar S>
  JointFrames on_body(const SmplVelpMotion<S>& clip) const {
    using T = typename B::scalar;
    const Index frames = std::ssize(clip.trans);
    std::vector<T> rotations, trans;
    for (const auto& r : clip.rotations) {
      for (const S x : r.m) rotations.push_back(static_cast<T>(x));
    }
    for (const auto& p : clip.trans) {
      for (const S x : {p.x, p.y, p.z}) trans.push_back(static_cast<T>(x));
    }
    const auto joints = smplh_joints(set_, *body_, Tensor<B, 3>::from(rotations, {frames, 22, 9}),
                                     Tensor<B, 2>::from(trans, {frames, 3}));
    JointFrames out;
    const auto x = joints.span();
    for (std::size_t i = 0; i < x.size(); i += 3) out.push_back(vec_cast<double>(Vec3<T>{x[i], x[i + 1], x[i + 2]}));
    return out;
  }
  template <Scalar S>
  JointFrames on_own_skeleton(const SmplVelpMotion<S>& clip) const {
    const auto own = detail::turned_up(detail::first_joints(motion_of_smplvelp(clip, 1), 22), true);
    JointFrames points, trans;  // of SMPL-H; a set has the first ones and the heels
    constexpr std::size_t of_body = 73, left_heel = 59, left_ankle = 7, right_ankle = 8;
    for (std::size_t t = 0; t < clip.trans.size(); ++t) {
      trans.push_back(vec_cast<double>(clip.trans[t]));
      for (std::size_t j = 0; j < of_body; ++j)
        points.push_back(own[22 * t + (j < 22 ? j : j == left_heel ? left_ankle : right_ankle)]);
    }
    return select_joints<double>(set_, points, trans);
  }

  std::string set_;
  std::optional<Body<B>> body_;
};

MOTIONLANG_NAMESPACE_END
