// Golden functions: the classifiers that judge ACTOR's motions.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/metrics/stgcn.hpp>

#include "tensors.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

/// [B, joints, features, frames] as (B, frames, joints features).
template <ml::Backend B>
ml::Tensor<B, 3> frames_of(const Case& c) {
  const auto s = c.shape("in/x");
  return ml::reshape<3>(golden::mdm_rows(tensor<B, 4>(c, "in/x")), {s[0], s[3], s[1] * s[2]});
}

template <ml::Backend B>
void gru_classifier(Case& c) {
  const auto config = c.config();
  ml::NoInit zeros;
  ml::GruClassifier<B> m({.input_size = config["input_size"].as<Index>(),
                          .hidden_size = config["hidden_size"].as<Index>(),
                          .num_layers = config["num_layers"].as<Index>(),
                          .num_classes = config["num_classes"].as<Index>()},
                         zeros);
  ml::load_module(m, c.file(), "weights/");
  const auto lengths = c.values<Index>("in/lengths");
  const auto h0 = tensor<B, 3>(c, "noise/h0");
  const auto said = m(ml::from_padded(frames_of<B>(c), std::span<const Index>(lengths)), &h0);
  golden::out(c, "features", said.features);
  golden::out(c, "logits", said.logits);
}

/// Rows by joint, sequence and frame to [B, channels, frames, joints].
template <ml::Backend B>
ml::Tensor<B, 4> block_layout(const ml::Sequences<B>& x, Index joints) {
  return ml::permute(ml::reshape<4>(x.rows, {joints, x.count() / joints, x.offsets.length(0), x.width()}),
                     {1, 3, 2, 0});
}

template <ml::Backend B>
void stgcn_classifier(Case& c) {
  const auto config = c.config();
  ml::StGcnConfig sizes{.in_channels = config["in_channels"].as<Index>(),
                        .num_classes = config["num_classes"].as<Index>(),
                        .channels = config["channels"].as<std::vector<Index>>(),
                        .strides = config["strides"].as<std::vector<Index>>()};
  if (config["layout"].as<std::string>() == "smpl_noglobal")
    sizes.parents = ml::StGcnConfig::without_root(sizes.parents);
  ml::Philox rng;
  ml::StGcn<B> m(sizes, rng);
  golden::out(c, "adjacency", m.graph.A);
  ml::load_module(m, c.file(), "weights/");
  const auto x = ml::from_equal(frames_of<B>(c));
  auto y = ml::StGcn<B>::joint_sequences(std::as_const(m), x);
  for (std::size_t i = 0; i < m.st_gcn_networks.size(); ++i) {
    y = m.st_gcn_networks[i](y, m.graph.A * m.edge_importance[i]);
    golden::out_if_wanted(c, "block_" + std::to_string(i), block_layout(y, m.joints()));
  }
  const auto said = std::as_const(m)(x);
  golden::out(c, "features", said.features);
  golden::out(c, "logits", said.logits);
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"actor gru classifier", variant, gru_classifier<B>},
          {"actor stgcn classifier", variant, stgcn_classifier<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
