// SPDX-License-Identifier: MIT
/// Gated recurrent unit, several layers, PyTorch's gates and names.
#pragma once

#include <motionlang/nn/linear.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

///     r = sig(W_ir x + b_ir + W_hr h + b_hr),  z = sig(W_iz x + b_iz + W_hz h + b_hz),
///     n = tanh(W_in x + b_in + r (W_hn h + b_hn)),  h' = (1 - z) n + z h
/// Source  Cho et al. (2014) with PyTorch's placement of r. Rows of the weights: r, z, n.
template <Backend B>
struct GruLayer {
  Tensor<B, 2> weight_ih, weight_hh;  // (3 hidden, in), (3 hidden, hidden)
  Tensor<B, 1> bias_ih, bias_hh;      // (3 hidden)

  static constexpr auto fields() {
    using M = GruLayer;
    return motionlang::fields("weight_ih", &M::weight_ih, "weight_hh", &M::weight_hh, "bias_ih", &M::bias_ih, "bias_hh",
                              &M::bias_hh);
  }
  GruLayer() = default;
  GruLayer(Index in, Index hidden, Rng auto& rng) {
    const double bound = 1 / std::sqrt(static_cast<double>(hidden));
    weight_ih = uniform_init<B, 2>({3 * hidden, in}, bound, rng);
    weight_hh = uniform_init<B, 2>({3 * hidden, hidden}, bound, rng);
    bias_ih = uniform_init<B, 1>({3 * hidden}, bound, rng);
    bias_hh = uniform_init<B, 1>({3 * hidden}, bound, rng);
  }

  Index hidden() const { return weight_hh.size(1); }

  /// x: one (rows, in) per time step; h0 (rows, hidden) -> one (rows, hidden) per step
  std::vector<Tensor<B, 2>> operator()(const std::vector<Tensor<B, 2>>& x, const Tensor<B, 2>& h0) const {
    const Index n = hidden();
    Tensor<B, 2> h = h0;
    std::vector<Tensor<B, 2>> out;
    for (const auto& step : x) {
      const auto i = linear(step, weight_ih, &bias_ih), g = linear(h, weight_hh, &bias_hh);
      auto sigmoid = [](const Tensor<B, 2>& t) { return 1.0 / (exp(-t) + 1.0); };
      const auto r = sigmoid(slice(i, 1, 0, n) + slice(g, 1, 0, n));
      const auto z = sigmoid(slice(i, 1, n, 2 * n) + slice(g, 1, n, 2 * n));
      const auto candidate = tanh(slice(i, 1, 2 * n, 3 * n) + r * slice(g, 1, 2 * n, 3 * n));
      h = (1.0 - z) * candidate + z * h;
      out.push_back(h);
    }
    return out;
  }
};

/// A stack of layers; every layer starts from zeros. Official keys are weight_ih_l0, ...: see `gru_key`.
template <Backend B>
struct Gru {
  std::vector<GruLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &Gru::layers); }

  Gru() = default;
  Gru(Index in, Index hidden, Index count, Rng auto& rng) {
    for (Index i = 0; i < count; ++i) layers.emplace_back(i == 0 ? in : hidden, hidden, rng);
  }
  std::vector<Tensor<B, 2>> operator()(std::vector<Tensor<B, 2>> x) const {
    for (const auto& layer : layers) {
      if (!x.empty()) x = layer(x, Tensor<B, 2>::zeros({x.front().size(0), layer.hidden()}));
    }
    return x;
  }
};

/// "gru.layers.2.weight_ih" -> "gru.weight_ih_l2": PyTorch numbers the parameters instead of nesting them. Other paths
/// stay.
inline std::string gru_key(const std::string& path) {
  constexpr std::string_view nested = "gru.layers.";
  if (!path.starts_with(nested)) return path;
  const auto dot = path.find('.', nested.size());
  return "gru." + path.substr(dot + 1) + "_l" + path.substr(nested.size(), dot - nested.size());
}

}  // namespace motionlang::inline MOTIONLANG_ABI
