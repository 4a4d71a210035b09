// SPDX-License-Identifier: MIT
/// The 135-vector of TEMOS ("smplvelp"), TEACH and SINC ("Globalvelandy"): height, velocity over the ground, rotations.
///
///    0        height of the translation, unchanged
///     1:3      its velocity x, y; 0 in the first frame
///     3:135    22 rotations as two rows of the matrix: the body in the world, then joints 1 ... 21
/// World: Z up, metres; velocities per frame (TEMOS 12.5 frames per second, TEACH and SINC 30).
///
/// Source  TEMOS (Petrovich et al., ECCV 2022), appendix B.2, temos/transforms/rots2rfeats/smplvelp.py; TEACH
///         teach/transforms/rots2rfeats/globvelandy.py. Normalise with eps 1e-12, SINC with 1e-5 both ways.
#pragma once

#include <motionlang/features/pose_representation.hpp>
#include <motionlang/features/smplrifke.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SmplVelpOptions {
  PoseRepresentation rotations = PoseRepresentation::rot6d;
  /// Turns the clip about Z by the angle of the first frame that `exact_yaw` chooses (and by a quarter, `offset`).
  bool canonicalize = true;
  bool offset = true;
  /// false, as published: the z of the first rotation vector. It is not a heading, so a second pass turns again. true:
  /// the heading. Clips that differ only by a turn about Z become the same.
  bool exact_yaw = false;
};

template <Scalar S>
struct SmplVelpMotion {
  std::vector<Matrix3<S>> rotations;  // (frames, joints); joint 0 in the world
  std::vector<Vec3<S>> trans;         // (frames)
};

/// smplvelp: the root's height and velocity, then a rotation of each joint, as above: 135 for 22 joints in 6D.
inline FeatureLayout smplvelp_layout(
    std::span<const BodyPart> part_of_joint = std::span(smpl_part_of_joint).first<22>(),
    PoseRepresentation rotations = PoseRepresentation::rot6d, const BodyPartition& body = {}) {
  const Index joints = std::ssize(part_of_joint), numbers = motionlang::size(rotations);
  if (joints < 1) raise<config_error>(101, "smplvelp_layout: no joints");
  return FeatureLayout::from_owner("smplvelp", 3 + numbers * joints, body, [&](Index i) {
    return i < 3 ? body.path() : part_of_joint[static_cast<std::size_t>((i - 3) / numbers)];
  });
}

/// The meaning of the values of `smplvelp_layout`. World: Z up, turned as in SmplVelpOptions.
inline constexpr std::array<FeatureRange, 4> smplvelp_ranges{{
    {{0, 1}, "height of the translation in the world", "m"},
    {{1, 3}, "velocity of the translation since the frame before, in the world: x, y", "m/frame"},
    {{3, 9}, "rotation in the world: the first two rows of the matrix", "1", {0, 1}},
    {{9, 135}, "rotation relative to the parent: the first two rows of the matrix", "1", {1, 22}},
}};

/// rotations  (frames, joints); joint 0 in the world
/// trans      (frames)
/// result     (frames, 3 + 6 joints), or 3 + 4 joints for quaternions, ...
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> smplvelp_features(std::span<const Matrix3<S>> rotations, std::span<const Vec3<S>> trans,
                                 const SmplVelpOptions& options = {}) {
  const std::size_t frames = trans.size(), joints = frames == 0 ? 0 : rotations.size() / frames;
  if (rotations.size() != frames * joints || (frames > 0 && joints == 0)) {
    raise<shape_error>(205, "smplvelp_features: ", rotations.size(), " rotations for ", frames, " frames");
  }
  std::vector<S> out;
  if (frames == 0) return out;
  S angle{};
  if (options.canonicalize) {
    angle =
        options.exact_yaw ? detail::zyx_angles(rotations[0], true).z : pytorch3d::matrix_to_axis_angle(rotations[0]).z;
    if (options.offset) angle += S(std::numbers::pi / 2);
  }
  const Matrix3<S> back = axis_rotation(2, -angle);
  for (std::size_t t = 0; t < frames; ++t) {
    const Vec3<S> velocity = back * (trans[t] - trans[t == 0 ? 0 : t - 1]);
    out.insert(out.end(), {trans[t].z, velocity.x, velocity.y});
    for (std::size_t j = 0; j < joints; ++j) {
      const Matrix3<S>& r = rotations[t * joints + j];
      append_rotation(out, options.rotations, j == 0 ? back * r : r);
    }
  }
  return out;
}

/// features  (frames, 3 + 6 joints), not normalised
/// The path starts at x = y = 0, and the heading is that of the features. Throws shape_error 205.
template <Scalar S>
SmplVelpMotion<S> smplvelp_inverse(std::span<const S> features, Index joints = 22,
                                   PoseRepresentation representation = PoseRepresentation::rot6d) {
  const Index numbers = size(representation), width = 3 + numbers * joints;
  if (joints < 1 || std::ssize(features) % width != 0) {
    raise<shape_error>(205, "smplvelp_inverse: ", features.size(), " values are not rows of ", width);
  }
  SmplVelpMotion<S> out;
  Vec3<S> position{};
  for (std::size_t at = 0; at < features.size(); at += static_cast<std::size_t>(width)) {
    if (at > 0) position = position + Vec3<S>{features[at + 1], features[at + 2], S(0)};
    position.z = features[at];
    out.trans.push_back(position);
    for (Index j = 0; j < joints; ++j) {
      const auto own =
          features.subspan(at + 3 + static_cast<std::size_t>(numbers * j), static_cast<std::size_t>(numbers));
      out.rotations.push_back(rotation_from(representation, own));
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
