// SPDX-License-Identifier: MIT
/// AMASS sequences on a body of SMPL's family: hands and face, shape, and the place where AMASS has the pelvis.
///
///     const auto clip = amass_on_body(read_amass_sequence("a.npz"), "a", body);
///     write_body_glb("a.glb", body, std::span(&clip.motion, 1), std::span<const float>(clip.betas));
///
/// Source  Mahmood et al. (ICCV 2019); spec body-models.md 1, 2, 6
#pragma once

#include <motionlang/formats/amass.hpp>
#include <motionlang/kinematics/body_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct AmassOnBody {
  Motion motion;  // on the body's joints, turned to Y up
  std::vector<typename B::scalar>
      betas;                            // the file's, as many as the body has, if it has these shapes; the others are 0
  std::vector<std::string> parts{};     // that move in the file besides the 22 body joints: "left hand", ...
  std::vector<std::string> left_out{};  // those of them that the body does not have
};

namespace detail {

/// Joints of a sequence that follow the 22 of the body.
struct AmassPart {
  std::string_view name;
  Index first, count;
};
inline std::vector<AmassPart> amass_parts(Index columns) {
  const auto after = static_cast<Index>(amass_joints), joints = columns / 3;
  const BodyKind kind = body_kind_of(joints);
  if (kind == BodyKind::other) return {{"joints after the 22nd", after, joints - after}};
  const BodyKindInfo& info = body_kinds[static_cast<std::size_t>(kind)];
  if (kind == BodyKind::smpl) return {{"hands", after, 2}};
  std::vector<AmassPart> parts{{"left hand", info.left_hand, 15}, {"right hand", info.right_hand, 15}};
  if (kind == BodyKind::smplx) parts.push_back({"jaw and eyes", after, 3});
  return parts;
}
inline bool moves(const AmassSequence& sequence, const AmassPart& part) {
  for (Index frame = 0; frame < sequence.frames; ++frame) {
    const auto numbers = std::span(sequence.poses)
                             .subspan(static_cast<std::size_t>(frame * sequence.columns + 3 * part.first),
                                      static_cast<std::size_t>(3 * part.count));
    if (std::any_of(numbers.begin(), numbers.end(), [](double x) { return x != 0; })) return true;
  }
  return false;
}

}  // namespace detail

/// Whether betas of a sequence mean the same shape on a body: SMPL and SMPL-H share theirs, SMPL-X has its own.
inline bool has_shapes_of(const AmassSequence& sequence, BodyKind body) {
  return (body_kind_of(sequence.columns / 3) == BodyKind::smplx) == (body == BodyKind::smplx);
}

/// A part whose numbers are all 0 in the file is not in it: hands then have the mean pose of the body's, as in
/// motion_on_body.
/// Throws  config_error 106 for a body of another kind, numeric_error 301 if a value is not finite
template <Backend B>
AmassOnBody<B> amass_on_body(const AmassSequence& sequence, const std::string& name, const Body<B>& body) {
  using S = typename B::scalar;
  if (body.kind == BodyKind::other)
    raise<config_error>(106, "amass_on_body: a body of ", counted(body.model.joints(), "joint"),
                        " is none of SMPL, SMPL-H and SMPL-X");
  const Index coefficients = body.model.shapedirs.size(1);
  std::vector<S> betas(static_cast<std::size_t>(coefficients), S(0));
  const Index common =
      has_shapes_of(sequence, body.kind) ? std::min(std::ssize(sequence.betas), coefficients - body.expressions) : 0;
  std::transform(sequence.betas.begin(), sequence.betas.begin() + common, betas.begin(),
                 [](double b) { return static_cast<S>(b); });

  const Skeleton skeleton = body_skeleton(body, std::span<const S>(betas));
  Motion motion = amass_motion(sequence, name, skeleton.offset(0));
  // its legs: the path is not scaled
  std::copy_n(skeleton.offsets.begin(), detail::amass_joints, motion.skeleton.offsets.begin());
  AmassOnBody<B> out{motion_on_body(body, motion, std::span<const S>(betas)), betas};
  const auto names = body_joint_names(body_kind_of(sequence.columns / 3), sequence.columns / 3);
  for (const detail::AmassPart& part : detail::amass_parts(sequence.columns)) {
    if (!detail::moves(sequence, part)) continue;
    const int own = skeleton.find(names[static_cast<std::size_t>(part.first)]);
    (own >= 0 ? out.parts : out.left_out).emplace_back(part.name);
    for (Index frame = 0; own >= 0 && frame < sequence.frames; ++frame) {
      for (Index j = 0; j < part.count; ++j)
        out.motion.rotations(frame)[static_cast<std::size_t>(own + j)] =
            detail::amass_rotation(sequence, frame, part.first + j);
    }
  }
  out.motion.validate();
  return out;
}

MOTIONLANG_NAMESPACE_END
