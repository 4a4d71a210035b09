// Golden functions: body models, with gradients through Autodiff.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/kinematics/body_model.hpp>

#include "tensors.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
ml::BodyModel<B> body_of(const Case& c, const std::string& prefix) {
  ml::BodyModel<B> body;
  auto flat = [&](const std::string& name, Index rows, Index columns) {
    return ml::Tensor<B, 2>::from(c.values<typename B::scalar>(prefix + name), {rows, columns});
  };
  const Index v = c.shape(prefix + "v_template")[0], j = c.shape(prefix + "J_regressor")[0];
  body.v_template = flat("v_template", v, 3);
  body.shapedirs = c.has(prefix + "shapedirs") ? flat("shapedirs", 3 * v, c.shape(prefix + "shapedirs")[2])
                                               : ml::Tensor<B, 2>::zeros({3 * v, 1});
  body.posedirs = flat("posedirs", 3 * v, 9 * (j - 1));
  body.J_regressor = flat("J_regressor", j, v);
  body.weights = flat("weights", v, j);
  const auto parents = c.values<Index>(prefix + (c.has(prefix + "kintree_table") ? "kintree_table" : "parents"));
  for (Index i = 0; i < j; ++i)
    body.parents.push_back(i == 0 ? -1 : static_cast<int>(parents[static_cast<std::size_t>(i)]));
  if (c.has(prefix + "extra_vertex_ids")) body.extra = c.values<Index>(prefix + "extra_vertex_ids");
  body.validate();
  return body;
}

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
  c.out("d_rotations", s, g[rotations].span());
  golden::out(c, "d_betas", g[betas]);
  golden::out(c, "d_translation", g[translation]);
}

/// The 205-vector shown on SMPL-H: shape 0, hands at their mean pose, translation = position of the pelvis.
template <ml::Backend B>
void smplrifke_to_smplh(Case& c) {
  using S = typename B::scalar;
  const auto body = body_of<B>(c, "weights/");
  const auto motion =
      ml::smplrifke_inverse<S>(c.values<S>("in/features"), {.first_angle = c.config()["first_angle"].as<double>()});
  const auto frames = static_cast<Index>(motion.trans.size()), joints = body.joints();
  std::vector<S> points, rotations, translation;
  for (const auto& p : motion.joints) points.insert(points.end(), {p.x, p.y, p.z});
  c.out("joints", {frames, 24, 3}, points);
  std::vector<ml::Matrix3<S>> hands;
  for (const char* side : {"weights/hands_meanl", "weights/hands_meanr"}) {
    const auto v = c.values<S>(side);
    for (std::size_t i = 0; i < v.size(); i += 3)
      hands.push_back(ml::to_matrix(ml::AxisAngle<S>{{v[i], v[i + 1], v[i + 2]}}));
  }
  for (Index f = 0; f < frames; ++f) {
    auto put = [&](const ml::Matrix3<S>& m) { rotations.insert(rotations.end(), m.m.begin(), m.m.end()); };
    for (Index j = 0; j < 22; ++j) put(motion.rotations[static_cast<std::size_t>(22 * f + j)]);
    for (const auto& m : hands) put(m);
    const auto& p = motion.trans[static_cast<std::size_t>(f)];
    translation.insert(translation.end(), {p.x, p.y, p.z});
  }
  const auto posed =
      body(ml::Tensor<B, 2>::zeros({frames, body.shapedirs.size(1)}),
           ml::Tensor<B, 3>::from(rotations, {frames, joints, 9}), ml::Tensor<B, 2>::from(translation, {frames, 3}));
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
