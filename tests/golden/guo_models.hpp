// Guo's evaluator in golden cases: its weights, packed inputs, the order of rows in its wrapper.
#pragma once

#include <numeric>

#include <motionlang/metrics/guo_evaluator.hpp>

#include "tensors.hpp"

namespace golden {

using ml::Index;

/// in/NAME (batch, rows, width), the first in/LENGTHS rows of each.
template <ml::Backend B>
ml::Sequences<B> packed_rows(const Case& c, const std::string& name, const std::string& lengths) {
  const auto n = c.values<Index>("in/" + lengths);
  return ml::from_padded(tensor<B, 3>(c, "in/" + name), std::span<const Index>(n));
}
/// Word vectors with their tags behind them.
template <ml::Backend B>
ml::Sequences<B> words(const Case& c, const std::string& lengths) {
  const auto vectors = packed_rows<B>(c, "word_emb", lengths);
  return vectors.with(ml::concat(1, vectors.rows, packed_rows<B>(c, "pos_onehot", lengths).rows));
}

/// Sizes are those of the weights.
template <ml::Backend B>
ml::GuoEvaluator<B> evaluator(const Case& c) {
  auto size = [&](const std::string& weight, int axis) { return c.shape("weights/" + weight)[axis]; };
  ml::Philox rng;
  ml::GuoEvaluator<B> m({.features = c.config()["dim_pose"].as<Index>(),
                         .movement_hidden = size("movement_encoder.main.0.weight", 0),
                         .movement_latent = size("movement_encoder.main.3.weight", 0),
                         .word = size("text_encoder.pos_emb.weight", 0),
                         .pos = size("text_encoder.pos_emb.weight", 1),
                         .text_hidden = size("text_encoder.hidden", 2),
                         .motion_hidden = size("motion_encoder.hidden", 2),
                         .embedding = size("text_encoder.output_net.3.weight", 0)},
                        rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}
/// The wrapper's order of rows: ascending motion length, turned round.
inline std::vector<Index> wrapper_order(const Case& c) {
  const auto lengths = c.values<Index>("in/motion_lengths");
  std::vector<Index> order(lengths.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return lengths[static_cast<std::size_t>(a)] < lengths[static_cast<std::size_t>(b)];
  });
  std::reverse(order.begin(), order.end());
  return order;
}
template <ml::Backend B>
struct Embeddings {
  ml::Tensor<B, 2> text, motion;
};
template <ml::Backend B>
Embeddings<B> embeddings(const Case& c, const ml::GuoEvaluator<B>& m) {
  const auto order = wrapper_order(c);
  const auto movements = m.movements(packed_rows<B>(c, "motions", "motion_lengths"), c.shape("in/motions")[1]);
  return {ml::gather(m.embed_texts(words<B>(c, "text_lengths")), order),
          ml::gather(m.motion_encoder(movements), order)};
}

}  // namespace golden
