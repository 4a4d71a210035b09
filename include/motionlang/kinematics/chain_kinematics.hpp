// SPDX-License-Identifier: MIT
/// Rotations from joint positions and back, along chains of bones: the analytic inverse kinematics of HumanML3D.
///
/// The rotation of a joint is that of the bone that ENDS at it, without twist. The first rotation of a chain is
/// relative to the root, even if the chain begins at another joint. These are not SMPL's rotations.
///
///     g_j = between(direction_j, p_j - p_parent(j)),   g_0 = root,   q_j = g_before(j)^-1 g_j
///     back:  g_j = g_before(j) q_j,   p_j = p_parent(j) + g_j offset_j
/// Source  Guo et al. (CVPR 2022), HumanML3D common/skeleton.py inverse_kinematics_np, forward_kinematics
/// Shapes  joints (frames, joints), joint fastest, any unit of length
#pragma once

#include <algorithm>    // max
#include <cmath>        // atan2
#include <limits>       // infinity
#include <span>         // joints
#include <string_view>  // who complains
#include <vector>       // results

#include <motionlang/geometry/guo.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>
#include <motionlang/kinematics/guo_chains.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct FacingOptions {
  double sigma = 0;            // frames; of the Gaussian filter over time, 0: none
  bool legacy_forward = true;  // as published: hips count left minus right; false: right minus left, like shoulders
};
struct ChainRotationOptions {
  FacingOptions facing{};
  bool fix_first_frame = false;     // false, as published: the root of frame 0 is the identity, whatever its heading
  bool fix_opposite_bones = false;  // false, as published: NaN for a bone exactly opposite to its zero direction, and
                                    // for a body that faces -Z
};

namespace detail {

/// Number of frames. Throws shape_error 205 if the joints are not whole frames.
template <class T>
std::size_t chain_frames(std::string_view function, const ChainSkeleton& skeleton, std::span<const T> values) {
  const std::size_t frames = values.size() / std::max<std::size_t>(skeleton.size(), 1);
  if (values.size() != frames * skeleton.size()) {
    raise<shape_error>(205, function, ": ", values.size(), " values are not frames of ", skeleton.size(), " joints");
  }
  return frames;
}

/// Throws numeric_error 302 for a bone of length 0, 301 for one that is not finite.
template <Scalar S>
[[noreturn]] void refuse_bone(const ChainSkeleton& skeleton, const ChainBone& bone, std::size_t frame, S length) {
  raise<numeric_error>(length == 0 ? 302 : 301, "'", skeleton.name, "' frame ", frame, ": the bone from joint ",
                       bone.parent, " to ", bone.joint, " has length ", length);
}
/// The vector from a bone's parent to its joint, and its length, which is positive.
template <Scalar S>
struct MeasuredBone {
  Vec3<S> vector;
  S length;
};
template <Scalar S>
MeasuredBone<S> measure_bone(const ChainSkeleton& skeleton, const ChainBone& bone, const Vec3<S>* joints,
                             std::size_t frame) {
  const Vec3<S> v = joints[bone.joint] - joints[bone.parent];
  const S length = norm(v);
  if (!(length > 0 && length < std::numeric_limits<S>::infinity())) refuse_bone(skeleton, bone, frame, length);
  return {v, length};
}

/// The joint with this number.
template <class T>
const T& joint_of(const T* frame, int joint) {
  return frame[static_cast<std::size_t>(joint)];
}

}  // namespace detail

/// Lengths of the bones in one frame, 0 for the root. Throws shape_error 205, numeric_error 301, 302.
template <Scalar S>
std::vector<S> bone_lengths(const ChainSkeleton& skeleton, std::span<const Vec3<S>> frame) {
  if (frame.size() != skeleton.size()) {
    raise<shape_error>(205, "bone_lengths: ", frame.size(), " joints for a skeleton of ", skeleton.size());
  }
  std::vector<S> out(skeleton.size());
  for (const ChainBone& b : skeleton.bones()) {
    out[b.joint] = detail::measure_bone(skeleton, b, frame.data(), 0).length;
  }
  return out;
}

/// Zero direction times length for every joint. Throws shape_error 204 unless there is one length for each joint.
template <Scalar S, Scalar L>
std::vector<Vec3<S>> chain_offsets(const ChainSkeleton& skeleton, std::span<const L> lengths) {
  if (lengths.size() != skeleton.size()) {
    raise<shape_error>(204, "chain_offsets: ", lengths.size(), " lengths for ", skeleton.size(), " joints");
  }
  std::vector<Vec3<S>> out;
  for (std::size_t j = 0; j < lengths.size(); ++j) {
    out.push_back(static_cast<S>(lengths[j]) * vec_cast<S>(skeleton.directions[j]));
  }
  return out;
}

/// The facing direction of a body in one frame; `frame` points to its first joint. It is level and not of unit length
/// (shorter if hips and shoulders are not level).
///    a = (hip_r - hip_l) + (shoulder_r - shoulder_l) normalised,   forward = Y x a
/// legacy: the hips are exchanged, as in the published inverse kinematics.
template <Scalar S>
Vec3<S> facing(const ChainSkeleton& skeleton, const Vec3<S>* frame, bool legacy) {
  auto across = [&](std::size_t right, std::size_t left) {
    return detail::joint_of(frame, skeleton.face[right]) - detail::joint_of(frame, skeleton.face[left]);
  };
  const Vec3<S> hips = across(0, 1), a = normalized((legacy ? -hips : hips) + across(2, 3));
  return {a.z, S(0), -a.x};
}

/// The facing direction in every frame, as unit vectors. Throws shape_error 205, config_error 101 (sigma) and 106.
template <Scalar S>
std::vector<Vec3<S>> facing_directions(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                       const FacingOptions& options = {}) {
  const std::size_t frames = detail::chain_frames("facing_directions", skeleton, joints);
  skeleton.validate();
  std::vector<S> level;  // (frames, 2): x and z
  for (std::size_t t = 0; t < frames; ++t) {
    const Vec3<S> f = facing(skeleton, &joints[t * skeleton.size()], options.legacy_forward);
    level.insert(level.end(), {f.x, f.z});
  }
  if (options.sigma != 0) level = gaussian_smooth(std::span<const S>(level), 2, options.sigma);
  std::vector<Vec3<S>> out;
  for (std::size_t t = 0; t < frames; ++t) out.push_back(normalized(Vec3<S>{level[2 * t], S(0), level[2 * t + 1]}));
  return out;
}

namespace detail {

/// The turn about Y from a level direction to +Z; half a turn for -Z.
template <Scalar S>
Quaternion<S> turn_ahead(const Vec3<S>& level) {
  const S half = std::atan2(level.x, level.z) / 2;
  return {std::cos(half), S(0), -std::sin(half), S(0)};
}

/// Rotations of the root in all frames.
template <Scalar S>
std::vector<Quaternion<S>> chain_roots(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                       const ChainRotationOptions& options) {
  std::vector<Quaternion<S>> out;
  for (const Vec3<S>& forward : facing_directions(skeleton, joints, options.facing)) {
    const Vec3<S> ahead{S(0), S(0), S(1)};
    const bool replaced = out.empty() && !options.fix_first_frame;
    out.push_back(replaced                     ? Quaternion<S>::identity()
                  : options.fix_opposite_bones ? turn_ahead(forward)
                                               : guo::between(forward, ahead));
  }
  return out;
}

/// Rotations of all joints of one frame, or of one frame in each lane.
/// zero    directions of the bones
/// world   workspace (joints)
/// local   result (joints)
/// Returns 0 if any bone has no length.
template <ScalarLike T>
T chain_rotations(std::span<const ChainBone> bones, std::span<const Vec3<T>> zero, const Vec3<T>* joints,
                  const Quaternion<T>& root, bool fix_opposite, Quaternion<T>* world, Quaternion<T>* local) {
  const T none = T(0), one = T(1), infinite = T(std::numeric_limits<float>::max());
  T bad = none;
  world[0] = local[0] = root;
  for (const ChainBone& b : bones) {
    const Vec3<T> v = joints[b.joint] - joints[b.parent];
    const T squared = dot(v, v);
    bad = bad + where_less(none, squared, where_less(squared, infinite, none, one), one);
    world[b.joint] = fix_opposite ? rotation_between(zero[b.joint], v) : guo::between(zero[b.joint], v, sqrt(squared));
    local[b.joint] = inverse(world[b.before]) * world[b.joint];
  }
  return bad;
}

/// Throws numeric_error 301 or 302 for the first bone of a frame that has no direction.
template <Scalar S>
void require_bones(const ChainSkeleton& skeleton, std::span<const ChainBone> bones, const Vec3<S>* joints,
                   std::size_t frame) {
  for (const ChainBone& b : bones) measure_bone(skeleton, b, joints, frame);
}

}  // namespace detail

/// result  (frames, joints); joint 0: the rotation that turns the facing direction onto +Z
/// Throws  shape_error 205, config_error 101 (sigma) and 106, numeric_error 301 and 302 for a bone without direction
template <Scalar S>
std::vector<Quaternion<S>> chain_inverse_kinematics(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                                    const ChainRotationOptions& options = {}) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("chain_inverse_kinematics", skeleton, joints);
  const auto bones = skeleton.bones();
  const auto roots = detail::chain_roots(skeleton, joints, options);
  const auto zero = chain_offsets<S>(skeleton, std::span<const S>(std::vector<S>(n, S(1))));
  std::vector<Quaternion<S>> out(frames * n), world(n);
  for (std::size_t t = 0; t < frames; ++t) {
    const S bad = detail::chain_rotations<S>(bones, zero, &joints[t * n], roots[t], options.fix_opposite_bones,
                                             world.data(), &out[t * n]);
    if (bad > 0) detail::require_bones(skeleton, bones, &joints[t * n], t);
  }
  return out;
}

/// local    (frames, joints), quaternions or matrices
/// root     (frames)
/// offsets  (joints), or (frames, joints) if bones change over time; see chain_offsets
/// result   (frames, joints)
/// Throws   shape_error 204, 205, config_error 106
template <Rotation R, Scalar S>
std::vector<Vec3<S>> chain_forward_kinematics(const ChainSkeleton& skeleton, std::span<const R> local,
                                              std::span<const Vec3<S>> root, std::span<const Vec3<S>> offsets,
                                              bool root_rotation = true) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("chain_forward_kinematics", skeleton, local);
  if (root.size() != frames || (offsets.size() != n && offsets.size() != local.size())) {
    raise<shape_error>(204, "chain_forward_kinematics: ", frames, " frames of ", n, " joints, ", root.size(),
                       " root positions, ", offsets.size(), " offsets");
  }
  const auto bones = skeleton.bones();
  std::vector<Vec3<S>> out(local.size());
  std::vector<R> world(n);
  for (std::size_t t = 0; t < frames; ++t) {
    Vec3<S>* position = &out[t * n];
    const Vec3<S>* offset = &offsets[offsets.size() == n ? 0 : t * n];
    position[0] = root[t];
    world[0] = root_rotation ? local[t * n] : R::identity();
    for (const ChainBone& b : bones) {
      world[b.joint] = world[b.before] * local[t * n + b.joint];
      position[b.joint] = position[b.parent] + rotate(world[b.joint], offset[b.joint]);
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
