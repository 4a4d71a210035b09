// Golden functions: rotations on body models, as ACTOR and TEMOS read points from them.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/features/actor_points.hpp>
#include <motionlang/features/smplh_joints.hpp>

#include "bodies.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void rotations_to_xyz(Case& c) {
  using S = typename B::scalar;
  const auto config = c.config();
  const auto body = golden::body_of<B>(c, "in/body.");
  const auto extra = c.has("in/body.J_regressor_extra") ? tensor<B, 2>(c, "in/body.J_regressor_extra")
                                                        : ml::Tensor<B, 2>::zeros({9, body.vertices()});
  ml::ActorPointOptions o{.features = {.rotations = ml::parse_pose_representation(config["pose_rep"].as<std::string>()),
                                       .translation = config["translation"].as<bool>(),
                                       .global = config["glob"].as<bool>()},
                          .translate = config["vertstrans"].as<bool>(),
                          .second_beta = config.value_or("beta", 0.0)};
  if (config.contains("glob_rot")) {
    const auto r = config["glob_rot"].as<std::vector<double>>();
    o.global_rotation = {r[0], r[1], r[2]};
  }
  const auto shape = c.shape("in/x");  // [batch, rows, numbers, frames]
  const Index batch = shape[0], frames = shape[3];
  const auto mask = c.values<unsigned char>("in/mask");
  const auto x =
      ml::from_padded(ml::reshape<3>(golden::mdm_rows(tensor<B, 4>(c, "in/x")), {batch, frames, shape[1] * shape[2]}),
                      std::span<const unsigned char>(mask));
  const auto raw = c.values<S>("in/x");
  for (const auto& name : config["jointstypes"].as<std::vector<std::string>>()) {
    const auto points = ml::actor_points(x, body, &extra, ml::parse_actor_points(name), o);
    const Index count = points.width() / 3;
    auto out = ml::to_padded(points, 0, frames).to_vector();
    // The official code moves padded frames as well.
    for (Index b = 0; b < batch && o.features.translation && o.translate; ++b) {
      for (Index t = 0; t < frames; ++t) {
        if (mask[static_cast<std::size_t>(b * frames + t)] != 0) continue;
        for (Index i = 0; i < 3 * count; ++i) {
          const Index row = ((b * shape[1] + shape[1] - 1) * shape[2] + i % 3) * frames;
          out[static_cast<std::size_t>((b * frames + t) * 3 * count + i)] =
              raw[static_cast<std::size_t>(row + t)] - raw[static_cast<std::size_t>(row)];
        }
      }
    }
    golden::out(c, name, ml::permute(ml::Tensor<B, 4>::from(out, {batch, frames, count, 3}), {0, 2, 3, 1}));
  }
}

template <ml::Backend B>
void smplh_joints(Case& c) {
  const auto body = golden::body_with_hands<B>(c, "in/body.");
  const auto shape = c.shape("in/rotations");  // [..., frames, joints, 3, 3]
  const int rank = shape.rank();
  const Index frames = shape[rank - 4], joints = shape[rank - 3], sequences = shape.count(0, rank - 4);
  const auto rotations =
      ml::Tensor<B, 3>::from(c.values<typename B::scalar>("in/rotations"), {sequences * frames, joints, 9});
  const auto translation = golden::rows<B>(c, "in/translation");
  for (const auto& name : c.config()["jointstypes"].as<std::vector<std::string>>()) {
    std::vector<ml::Tensor<B, 3>> parts;
    for (Index s = 0; s < sequences; ++s) {
      const Index first = s * frames, last = first + frames;
      parts.push_back(
          ml::smplh_joints(name, body, ml::slice(rotations, 0, first, last), ml::slice(translation, 0, first, last)));
    }
    const auto all = ml::concat(std::span<const ml::Tensor<B, 3>>(parts), 0);
    ml::Shape to;
    for (int i = 0; i < rank - 3; ++i) to.push_back(shape[i]);
    to.push_back(all.size(1)), to.push_back(3);
    c.out(name, to, all.span());
  }
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"actor rotations to xyz", variant, rotations_to_xyz<B>}, {"temos smplh joints", variant, smplh_joints<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
