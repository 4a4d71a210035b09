// SPDX-License-Identifier: MIT
/// AMASS sequences on a body of SMPL's family, with hands and face, shape, and the pelvis where AMASS has it.
///
///     const auto clip = amass_on_body(read_amass_sequence("a.npz"), "a", body);
///     write_body_glb("a.glb", body, std::span(&clip.motion, 1), std::span<const float>(clip.betas));
///
/// Source  Mahmood et al. (ICCV 2019); vchoutas/smplx smplx/body_models.py
#pragma once

#include <algorithm>  // copy_n, min, transform

#include <motionlang/formats/amass.hpp>
#include <motionlang/kinematics/body_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct AmassOnBody {
  Motion motion;  // on the body's joints, turned to Y up
  std::vector<typename B::scalar>
      betas;  // the file's, as many as the body has, if both have the same shapes; the others are 0
  std::vector<std::string> parts{};     // parts that move in the file besides the 22 body joints: "left hand", ...
  std::vector<std::string> left_out{};  // those of them that the body lacks
};

namespace detail {

/// The rotations of the moving joints after the 22 of the body, with the names of their parts.
void add_amass_parts(const AmassSequence& sequence, const Skeleton& skeleton, Motion& motion,
                     std::vector<std::string>& parts, std::vector<std::string>& left_out);

}  // namespace detail

/// True if the betas of a sequence mean the same shape on this body: SMPL and SMPL-H share theirs, SMPL-X has its own.
bool has_shapes_of(const AmassSequence& sequence, BodyKind body);

/// A part whose values are all 0 counts as missing in the file. Hands then have the body's mean hand pose, as in
/// motion_on_body.
/// Throws  config_error 106 for a body of another kind, numeric_error 301 if a value is not finite
template <Backend B>
AmassOnBody<B> amass_on_body(const AmassSequence& sequence, const std::string& name, const Body<B>& body) {
  using S = typename B::scalar;
  if (body.kind == BodyKind::other)
    raise<config_error>(106, "amass_on_body: a body of ", counted(body.model.joints(), "joint"),
                        " is not one of SMPL, SMPL-H and SMPL-X");
  const Index coefficients = body.model.shapedirs.size(1);
  std::vector<S> betas(static_cast<std::size_t>(coefficients), S(0));
  const Index common =
      has_shapes_of(sequence, body.kind) ? std::min(std::ssize(sequence.betas), coefficients - body.expressions) : 0;
  std::transform(sequence.betas.begin(), sequence.betas.begin() + common, betas.begin(),
                 [](double b) { return static_cast<S>(b); });

  const Skeleton skeleton = body_skeleton(body, std::span<const S>(betas));
  Motion motion = amass_motion(sequence, name, skeleton.offset(0));
  // The body's own legs: the path is not scaled.
  std::copy_n(skeleton.offsets.begin(), detail::amass_joints, motion.skeleton.offsets.begin());
  AmassOnBody<B> out{motion_on_body(body, motion, std::span<const S>(betas)), betas};
  detail::add_amass_parts(sequence, skeleton, out.motion, out.parts, out.left_out);
  out.motion.validate();
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/amass_body.ipp>
#endif
