// SPDX-License-Identifier: MIT
/// A body: its model, its surface and its hands. Also the public facts of the SMPL family: sizes, and the vertices that
/// serve as extra joints. Bodies come from the user's own files (formats/body_file.hpp) or from any skeleton
/// (formats/figure_body.hpp).
///
/// Source  vchoutas/smplx smplx/body_models.py, joint_names.py and vertex_ids.py; TEMOS
///         temos/transforms/rots2joints/smplh.py
#pragma once

#include <array>        // tables
#include <optional>     // hands
#include <string>       // messages
#include <string_view>  // names
#include <vector>       // vertices

#include <motionlang/kinematics/body_model.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/surface_points.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The kind of a body, recognised by its number of joints. `other`: a body of the same form that is not of the family.
enum class BodyKind { smpl, smplh, smplx, other };
enum class BodyGender { neutral, male, female };

struct BodyKindInfo {
  BodyKind kind;
  std::string_view name;
  Index joints, vertices;
  int left_hand, right_hand;  // first finger joint; -1: the model has none
  std::string_view site;      // where to download its files
};
inline constexpr std::array<BodyKindInfo, 3> body_kinds{{
    {BodyKind::smpl, "SMPL", 24, 6890, -1, -1, "https://smpl.is.tue.mpg.de"},
    {BodyKind::smplh, "SMPL-H", 52, 6890, 22, 37, "https://mano.is.tue.mpg.de"},
    {BodyKind::smplx, "SMPL-X", 55, 10475, 25, 40, "https://smpl-x.is.tue.mpg.de"},
}};
constexpr BodyKind body_kind_of(Index joints) {
  for (const BodyKindInfo& k : body_kinds) {
    if (k.joints == joints) return k.kind;
  }
  return BodyKind::other;
}
inline std::string to_string(BodyKind kind) {
  return kind == BodyKind::other ? "other" : std::string(body_kinds[static_cast<std::size_t>(kind)].name);
}

/// A point of the body: its name and its vertex.
struct BodyPoint {
  std::string_view name;
  Index smpl, smplx;  // vertex in SMPL and SMPL-H, vertex in SMPL-X
};
/// In the order in which they follow the joints.
inline constexpr std::array<BodyPoint, 21> body_points{{
    {"nose", 332, 9120},
    {"right_eye", 6260, 9929},
    {"left_eye", 2800, 9448},
    {"right_ear", 4071, 616},
    {"left_ear", 583, 6},
    {"left_big_toe", 3216, 5770},
    {"left_small_toe", 3226, 5780},
    {"left_heel", 3387, 8846},
    {"right_big_toe", 6617, 8463},
    {"right_small_toe", 6624, 8474},
    {"right_heel", 6787, 8635},
    {"left_thumb", 2746, 5361},
    {"left_index", 2319, 4933},
    {"left_middle", 2445, 5058},
    {"left_ring", 2556, 5169},
    {"left_pinky", 2673, 5286},
    {"right_thumb", 6191, 8079},
    {"right_index", 5782, 7669},
    {"right_middle", 5905, 7794},
    {"right_ring", 6016, 7905},
    {"right_pinky", 6133, 8022},
}};
/// The vertices of `body_points` in a body of this kind; none for other bodies.
inline std::vector<Index> extra_vertices(BodyKind kind) {
  std::vector<Index> out;
  for (const BodyPoint& p : body_points) {
    if (kind != BodyKind::other) out.push_back(kind == BodyKind::smplx ? p.smplx : p.smpl);
  }
  return out;
}

/// The space of poses of one hand: 15 joints as rotation vectors.
template <Backend B>
struct HandPoses {
  static constexpr bool trainable = false;
  Tensor<B, 2> components;  // (n, 45): the most important first
  Tensor<B, 1> mean;        // (45)

  static constexpr auto fields() {
    return motionlang::fields("components", &HandPoses::components, "mean", &HandPoses::mean);
  }
  /// coefficients (N, n) of the first n components -> rotation vectors (N, 15, 3). `flat`: all zeros mean a stretched
  /// hand, not the mean pose. Throws shape_error 203 if there are fewer components.
  Tensor<B, 3> operator()(const Tensor<B, 2>& coefficients, bool flat = false) const {
    const auto offset = matmul(coefficients, slice(components, 0, 0, coefficients.size(1)));
    return reshape<3>(flat ? offset : offset + reshape<2>(mean, {1, 45}), {coefficients.size(0), 15, 3});
  }
};

/// A body with its surface. Nothing in it is trained.
template <Backend B>
struct Body {
  static constexpr bool trainable = false;
  BodyKind kind = BodyKind::other;
  BodyModel<B> model;
  std::vector<std::array<Index, 3>> faces;  // vertices of every triangle, counter-clockwise from outside
  Index expressions = 0;                    // of the model's coefficients, the last ones
  std::optional<HandPoses<B>> left_hand, right_hand;
  SurfacePoints landmarks{};              // of the face; surface_points.hpp places them
  std::vector<SurfacePoints> contours{};  // of the face, one for each direction of view
};

/// Rotations (N, n, 9) of all joints of a body. If `rotations` end before the fingers, both hands have their mean pose.
/// Throws config_error 106 if the body has no such hands, and shape_error 204 for another number of joints.
template <Backend B>
Tensor<B, 3> with_mean_hands(const Body<B>& body, const Tensor<B, 3>& rotations) {
  const Index n = rotations.size(0), given = rotations.size(1), joints = body.model.joints();
  if (given == joints) return rotations;
  if (!body.left_hand || !body.right_hand)
    raise<config_error>(106, "with_mean_hands: ", given, " rotations for a body of ", joints, " joints without hands");
  if (given + 30 != joints)
    raise<shape_error>(204, "with_mean_hands: rotations ", rotations.shape(), " for ", joints,
                       " joints with 30 of hands");
  auto mean = [&](const HandPoses<B>& hand) {
    return broadcast_to<3>(rotation_rows(reshape<3>(hand.mean, {1, 15, 3})), {n, 15, 9});
  };
  return concat(1, rotations, mean(*body.left_hand), mean(*body.right_hand));
}

/// The body in every frame of a motion. The motion's joints are the first ones of the model; the others (for example
/// fingers) stay at rest. The root joint is at the place in the motion. betas (K): one shape for all frames; none means
/// zeros.
/// Throws  config_error 106 if the joints of the motion are not the first ones of the model, shape_error 204
template <Backend B>
PosedBody<B> pose_body(const BodyModel<B>& model, const Motion& motion,
                       std::span<const typename B::scalar> betas = {}) {
  using S = typename B::scalar;
  const std::vector<int>& own = motion.skeleton.parents;
  if (own.size() > model.parents.size() || !std::equal(own.begin(), own.end(), model.parents.begin())) {
    raise<config_error>(106, "pose_body: the ", own.size(), " joints of motion '", motion.name,
                        "' are not the first ones of a body of ", model.joints());
  }
  const Index frames = motion.frames(), joints = model.joints(), coefficients = model.shapedirs.size(1);
  std::vector<S> shape(betas.begin(), betas.end()), rotations, translation;
  if (shape.empty()) shape.assign(static_cast<std::size_t>(coefficients), S(0));
  if (static_cast<Index>(shape.size()) != coefficients) {
    raise<shape_error>(204, "pose_body: ", shape.size(), " coefficients for a body of ", coefficients);
  }
  const auto one = Tensor<B, 2>::from(shape, {1, coefficients});
  const auto rest = model.rest_joints(one);
  const Vec3<S> pelvis{rest.span()[0], rest.span()[1], rest.span()[2]};
  for (Index f = 0; f < frames; ++f) {
    for (Index j = 0; j < joints; ++j) {
      const auto i = static_cast<std::size_t>(j);
      const Matrix3<double> m = i < own.size() ? to_matrix(motion.rotations(f)[i]) : Matrix3<double>::identity();
      for (const double x : m.m) rotations.push_back(static_cast<S>(x));
    }
    const Vec3<S> t = vec_cast<S>(motion.root_at(f)) - pelvis;
    translation.insert(translation.end(), {t.x, t.y, t.z});
  }
  return model(broadcast_to<2>(one, {frames, coefficients}), Tensor<B, 3>::from(rotations, {frames, joints, 9}),
               Tensor<B, 2>::from(translation, {frames, 3}));
}

MOTIONLANG_NAMESPACE_END
