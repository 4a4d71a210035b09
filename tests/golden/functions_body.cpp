// Golden functions: body models, with gradients through Autodiff.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/features/smplrifke.hpp>

#include "bodies.hpp"

namespace {

using golden::body_of, golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void forward_and_gradient(Case& c) {
  using A = ml::Autodiff<B>;
  const auto body = ml::convert<A>(body_of<B>(c, "in/body."));
  const auto s = c.shape("in/rotations");
  const auto betas = ml::variable<A>(tensor<B, 2>(c, "in/betas"));
  const auto rotations = ml::variable<A>(ml::reshape<3>(tensor<B, 4>(c, "in/rotations"), {s[0], s[1], 9}));
  const auto translation = ml::variable<A>(tensor<B, 2>(c, "in/translation"));
  const auto posed = body(betas, rotations, translation);
  const auto joints = ml::concat(1, posed.joints, posed.extra);
  const auto loss =
      ml::sum(posed.vertices * tensor<A, 3>(c, "in/d_vertices")) + ml::sum(joints * tensor<A, 3>(c, "in/d_joints"));
  golden::out(c, "vertices", posed.vertices);
  golden::out(c, "joints", joints);
  c.out_scalar("loss", static_cast<double>(loss.item()));
  const auto g = ml::backward(loss);
  const auto d_rotations = g[rotations];
  c.out("d_rotations", s, d_rotations.span());
  golden::out(c, "d_betas", g[betas]);
  golden::out(c, "d_translation", g[translation]);
}

/// The 205-vector shown on SMPL-H: shape 0, hands at their mean pose, translation = position of the pelvis.
template <ml::Backend B>
void smplrifke_to_smplh(Case& c) {
  using S = typename B::scalar;
  const auto body = golden::body_with_hands<B>(c, "weights/");
  const auto motion =
      ml::smplrifke_inverse<S>(c.values<S>("in/features"), {.first_angle = c.config()["first_angle"].as<double>()});
  const auto frames = static_cast<Index>(motion.trans.size());
  std::vector<S> points, rotations, translation;
  for (const auto& p : motion.joints) points.insert(points.end(), {p.x, p.y, p.z});
  c.out("joints", {frames, 24, 3}, points);
  for (Index f = 0; f < frames; ++f) {
    for (Index j = 0; j < 22; ++j) {
      const auto& m = motion.rotations[static_cast<std::size_t>(22 * f + j)].m;
      rotations.insert(rotations.end(), m.begin(), m.end());
    }
    const auto& p = motion.trans[static_cast<std::size_t>(f)];
    translation.insert(translation.end(), {p.x, p.y, p.z});
  }
  const auto posed = body.model(ml::Tensor<B, 2>::zeros({frames, body.model.shapedirs.size(1)}),
                                ml::with_mean_hands(body, ml::Tensor<B, 3>::from(rotations, {frames, 22, 9})),
                                ml::Tensor<B, 2>::from(translation, {frames, 3}));
  golden::out(c, "vertices", posed.vertices);
  // the 24 joints of SMPL among the 52 of SMPL-H
  golden::out(c, "joints_smpl", ml::concat(1, ml::slice(posed.joints, 1, 0, 23), ml::slice(posed.joints, 1, 37, 38)));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"smplx body model forward and gradient", variant, forward_and_gradient<B>},
          {"smplrifke to smplh", variant, smplrifke_to_smplh<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
