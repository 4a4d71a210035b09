// SPDX-License-Identifier: MIT
/// A motion on the joints of a body of the SMPL family, for its mesh, skin and files.
///
///     const Motion own = motion_on_body(body, on_smpls_joints, betas);
///     const PosedBody<B> posed = pose_body(body.model, own, betas);
///
/// Rotations are used unchanged, because the rest poses of SMPL and of the motion are both a T-pose. Unless the motion
/// has all joints of the body, fingers have the mean pose of the body's hands, or are stretched. Jaw and eyes are at
/// rest. The path is scaled with the length of the legs.
/// Source  smplx body_models.py and joint_names.py: the names of SMPL, SMPL-H and SMPL-X for their joints
#pragma once

#include <motionlang/kinematics/body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class BodyHands { mean, flat };

/// Names of a body's joints in their order. For a body of another kind "joint_0", "joint_1", ...
std::vector<std::string> body_joint_names(BodyKind kind, Index joints);

/// The skeleton of a body for one shape; none means zeros. Throws shape_error 204 for another number of coefficients.
template <Backend B>
Skeleton body_skeleton(const Body<B>& body, std::span<const typename B::scalar> betas = {}) {
  using S = typename B::scalar;
  const Index coefficients = body.model.shapedirs.size(1);
  std::vector<S> shape(betas.begin(), betas.end());
  if (shape.empty()) shape.assign(static_cast<std::size_t>(coefficients), S(0));
  if (std::ssize(shape) != coefficients) {
    raise<shape_error>(204, "body_skeleton: ", shape.size(), " coefficients for a body of ", coefficients);
  }
  const auto rest = body.model.rest_joints(Tensor<B, 2>::from(shape, {1, coefficients}));
  const std::vector<int>& parents = body.model.parents;
  std::vector<Vec3<double>> places, offsets;
  for (std::size_t j = 0; j < parents.size(); ++j) {
    const auto* p = rest.span().data() + 3 * j;
    places.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    offsets.push_back(parents[j] < 0 ? places[j] : places[j] - places[static_cast<std::size_t>(parents[j])]);
  }
  return Skeleton::from_arrays(body_joint_names(body.kind, body.model.joints()), parents, offsets);
}

/// motion   on SMPL's 24 joints or the first 22, or on the body's own (by their names); for a body of another kind, on
///          its first joints
/// Throws   config_error 106 if the joints are others, shape_error 204
template <Backend B>
Motion motion_on_body(const Body<B>& body, const Motion& motion, std::span<const typename B::scalar> betas = {},
                      BodyHands hands = BodyHands::mean) {
  Motion out{body_skeleton(body, betas), motion.fps, {}, {}, motion.name};
  const auto joints = static_cast<std::size_t>(out.skeleton.size());
  const bool family = body.kind != BodyKind::other;
  const bool own_joints = motion.skeleton.names == out.skeleton.names;
  const std::size_t most = own_joints || !family ? joints : body.kind == BodyKind::smpl ? 24 : 22;
  const std::size_t common = std::min(most, motion.skeleton.parents.size());
  const auto& own = motion.skeleton.parents;
  if ((family && common < 22) ||
      !std::equal(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(common), out.skeleton.parents.begin())) {
    raise<config_error>(106, "motion_on_body: the ", own.size(), " joints of motion '", motion.name,
                        "' are not the first ones of ", to_string(body.kind), ", ", joints, " joints");
  }
  std::vector<Quaternion<double>> at_rest(joints, Quaternion<double>::identity());
  if (family && hands == BodyHands::mean) {
    const BodyKindInfo& info = body_kinds[static_cast<std::size_t>(body.kind)];
    for (const auto& [hand, first] :
         {std::pair{&body.left_hand, info.left_hand}, {&body.right_hand, info.right_hand}}) {
      for (std::size_t k = 0; *hand && first >= 0 && k < 15; ++k) {
        const auto* v = (*hand)->mean.span().data() + 3 * k;
        at_rest[static_cast<std::size_t>(first) + k] = to_quaternion(
            AxisAngle<double>{{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])}});
      }
    }
  }
  const auto leg = [](const Skeleton& s) { return norm(s.offset(4)) + norm(s.offset(7)); };
  const double scale = family && leg(motion.skeleton) > 0 ? leg(out.skeleton) / leg(motion.skeleton) : 1;
  for (Index f = 0; f < motion.frames(); ++f) {
    out.root.push_back(scale * motion.root_at(f));
    const auto from = motion.rotations(f);
    out.local.insert(out.local.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(common));
    out.local.insert(out.local.end(), at_rest.begin() + static_cast<std::ptrdiff_t>(common), at_rest.end());
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/body_motion.ipp>
#endif
