// SPDX-License-Identifier: MIT
/// Points of the user's own body, which ACTOR's loss compares.
#pragma once

#include <filesystem>  // files
#include <optional>    // a regressor
#include <string>      // names
#include <vector>      // shapes

#include <motionlang/datasets/actor_clips.hpp>
#include <motionlang/features/actor_points.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/body_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct BodyPoints {
  ActorPoints points;
  BodyModel<B> body;
  std::optional<Tensor<B, 2>> J_regressor_extra{};

  /// name       "vertices", "smpl", "a2m", "a2mpl", "vibe"; the last three are vertices of SMPL and points that a
  ///            regressor computes from all of them (ACTOR src/models/smpl.py)
  /// regressor  J_regressor_extra.npy (9, vertices), which SPIN and VIBE publish
  /// Throws  config_error 103 for another name, 102 for a regressor that is missing or not needed, and for a body
  ///         without the vertices; io_error 407 for a regressor of another shape; what read_body throws
  BodyPoints(const std::string& name, const std::filesystem::path& path, const std::filesystem::path& regressor)
      : points(parse_actor_points(name)), body(read_body<B>(path).model) {
    const bool regressed = points != ActorPoints::vertices && points != ActorPoints::smpl;
    if (regressed == regressor.empty())
      raise<config_error>(
          102, "points '", name,
          regressed ? "' need `regressor`, J_regressor_extra.npy of SPIN or VIBE" : "' have no use for `regressor` ",
          regressor.string());
    if (points != ActorPoints::vertices && body.joints() != 24)
      raise<config_error>(102, path.string(), ": a body of ", counted(body.joints(), "joint"), "; points '", name,
                          "' are of SMPL's 24");
    if (!regressed) return;
    const Index vertices = body.vertices();
    if (body.extra.empty())
      raise<config_error>(102, path.string(), ": a body of ", counted(vertices, "vertex", "vertices"), "; points '",
                          name, "' are of SMPL's 6890");
    const NpyArray array = read_npy(regressor);
    if (const std::vector<Index> wanted{9, vertices}; array.shape != wanted)
      raise<io_error>(407, regressor.string(), ": an array ", detail::shape_text(array.shape), ", expected ",
                      detail::shape_text(wanted));
    J_regressor_extra = Tensor<B, 2>::from(array.to<typename B::scalar>(), {9, vertices});
  }
  /// The same over another backend.
  template <Backend From>
  explicit BodyPoints(const BodyPoints<From>& from) : points(from.points), body(convert<B>(from.body)) {
    if (from.J_regressor_extra)
      J_regressor_extra = Tensor<B, 2>::from(from.J_regressor_extra->to_vector(), from.J_regressor_extra->shape());
  }

  /// (frames, 3 points); `translate`: moved by the path of the root.
  Sequences<B> operator()(const Sequences<B>& x, const ActorClipsConfig& clips, bool translate) const {
    const ActorPointOptions options{.features = {.rotations = parse_pose_representation(clips.pose),
                                                 .translation = clips.translation,
                                                 .global = clips.global},
                                    .translate = translate,
                                    .global_rotation = {}};
    return actor_points(x, body, J_regressor_extra ? &*J_regressor_extra : nullptr, points, options);
  }
};

MOTIONLANG_NAMESPACE_END
