// Points of a body that the user has, as ACTOR's loss compares them.
#pragma once

#include <motionlang/features/actor_points.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/body_file.hpp>

#include "actor_clips.hpp"

namespace program {

template <ml::Backend B>
struct BodyPoints {
  ml::ActorPoints points;
  ml::BodyModel<B> body;
  std::optional<ml::Tensor<B, 2>> J_regressor_extra{};

  /// name       "vertices", "smpl", "a2m", "a2mpl", "vibe"; the last three have vertices of SMPL among them, and what a
  ///            regressor takes from all of them (spec actor.md 5.3)
  /// regressor  J_regressor_extra.npy (9, vertices), which SPIN and VIBE publish
  /// Throws  config_error 103 for another name, 102 for a regressor that is missing or not read, and for a body without
  ///         the vertices; io_error 407 for a regressor of another shape; what read_body throws
  BodyPoints(const std::string& name, const std::filesystem::path& path, const std::filesystem::path& regressor)
      : points(ml::parse_actor_points(name)), body(ml::read_body<B>(path).model) {
    const bool regressed = points != ml::ActorPoints::vertices && points != ml::ActorPoints::smpl;
    if (regressed == regressor.empty())
      ml::raise<ml::config_error>(102, "points '", name,
                                  regressed ? "' need --joint-regressor, J_regressor_extra.npy of SPIN or VIBE"
                                            : "' have no use for --joint-regressor ",
                                  regressor.string());
    if (points != ml::ActorPoints::vertices && body.joints() != 24)
      ml::raise<ml::config_error>(102, path.string(), ": a body of ", ml::counted(body.joints(), "joint"), "; points '",
                                  name, "' are of SMPL's 24");
    if (!regressed) return;
    const ml::Index vertices = body.vertices();
    if (body.extra.empty())
      ml::raise<ml::config_error>(102, path.string(), ": a body of ", ml::counted(vertices, "vertex", "vertices"),
                                  "; points '", name, "' are of SMPL's 6890");
    const ml::NpyArray array = ml::read_npy(regressor);
    if (const std::vector<ml::Index> wanted{9, vertices}; array.shape != wanted)
      ml::raise<ml::io_error>(407, regressor.string(), ": an array ", ml::detail::shape_text(array.shape),
                              ", expected ", ml::detail::shape_text(wanted));
    J_regressor_extra = ml::Tensor<B, 2>::from(array.to<typename B::scalar>(), {9, vertices});
  }
  /// The same over another backend.
  template <ml::Backend From>
  explicit BodyPoints(const BodyPoints<From>& from) : points(from.points), body(ml::convert<B>(from.body)) {
    if (from.J_regressor_extra)
      J_regressor_extra = ml::Tensor<B, 2>::from(from.J_regressor_extra->to_vector(), from.J_regressor_extra->shape());
  }

  /// (frames, 3 points); `translate`: moved by the way of the root.
  ml::Sequences<B> operator()(const ml::Sequences<B>& x, const ActorClipsConfig& clips, bool translate) const {
    const ml::ActorPointOptions options{.features = {.rotations = ml::parse_pose_representation(clips.pose),
                                                     .translation = clips.translation,
                                                     .global = clips.global},
                                        .translate = translate,
                                        .global_rotation = {}};
    return ml::actor_points(x, body, J_regressor_extra ? &*J_regressor_extra : nullptr, points, options);
  }
};

}  // namespace program
