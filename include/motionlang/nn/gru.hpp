// SPDX-License-Identifier: MIT
/// Gated recurrent unit, several layers, PyTorch's gates and names.
#pragma once

#include <span>         // layers
#include <string>       // keys
#include <string_view>  // keys
#include <vector>       // states

#include <motionlang/core/sort.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Packed sequences as steps of time. Step t has row t of every sequence that is long enough, the longest first. With
/// `backwards`, t counts from the end. This is like PyTorch's packed sequences.
template <Backend B>
struct TimeSteps {
  std::vector<Tensor<B, 2>> steps;
  PoolVector<Index> order;  // of the sequences in a step
  PoolVector<Index> back;   // for every packed row its place among the rows of all steps

  explicit TimeSteps(const Sequences<B>& x, bool backwards = false) : back(static_cast<std::size_t>(x.offsets.rows())) {
    for (Index s = 0; s < x.count(); ++s) order.push_back(s);
    detail::sort(order, [&](Index a, Index b) {
      const Index la = x.offsets.length(a), lb = x.offsets.length(b);
      return la != lb ? la > lb : a < b;
    });
    Index done = 0;
    for (Index t = 0; t < x.offsets.longest(); ++t) {
      PoolVector<Index> rows;
      for (Index s : order) {
        if (x.offsets.length(s) <= t) break;
        const Index row = backwards ? x.offsets.end(s) - 1 - t : x.offsets.begin(s) + t;
        rows.push_back(row);
        back[static_cast<std::size_t>(row)] = done++;
      }
      steps.push_back(gather(x.rows, rows));
    }
  }
  /// Rows of steps in the order of the sequences.
  Tensor<B, 2> packed(const std::vector<Tensor<B, 2>>& list) const {
    return gather(concat(std::span<const Tensor<B, 2>>(list), 0), back);
  }
};

}  // namespace detail

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

  /// x: one (rows, in) per time step; h0 (rows, hidden) -> one (rows, hidden) per step. Steps may have fewer rows than
  /// the ones before, because the last sequences have ended.
  std::vector<Tensor<B, 2>> operator()(const std::vector<Tensor<B, 2>>& x, const Tensor<B, 2>& h0) const {
    const ModuleScope scope(*this);
    const Index n = hidden();
    Tensor<B, 2> h = h0;
    std::vector<Tensor<B, 2>> out;
    for (const auto& i : read(x)) {
      if (i.size(0) < h.size(0)) h = slice(h, 0, 0, i.size(0));
      const auto g = linear(h, weight_hh, &bias_hh);
      const auto gates = activate(slice(i, 1, 0, 2 * n) + slice(g, 1, 0, 2 * n), Activation::sigmoid);
      const auto r = slice(gates, 1, 0, n), z = slice(gates, 1, n, 2 * n);
      const auto candidate = activate(slice(i, 1, 2 * n, 3 * n) + r * slice(g, 1, 2 * n, 3 * n), Activation::tanh);
      h = (1.0 - z) * candidate + z * h;
      out.push_back(h);
    }
    return out;
  }
  /// Runs each sequence on its own, from its first row to the last or `backwards`; h0 (sequences, hidden). Every row
  /// gives a row of the result. Throws shape_error 204.
  Sequences<B> operator()(const Sequences<B>& x, const Tensor<B, 2>& h0, bool backwards = false) const {
    const ModuleScope scope(*this);
    if (h0.shape() != Shape{x.count(), hidden()})
      raise<shape_error>(204, "GruLayer: h0 ", h0.shape(), " for ", counted(hidden(), "unit"), " and ",
                         counted(x.count(), "sequence"));
    const detail::TimeSteps<B> time(x, backwards);
    if (time.steps.empty()) return x.with(Tensor<B, 2>::zeros({0, hidden()}));
    return x.with(time.packed((*this)(time.steps, gather(h0, time.order))));
  }

 private:
  /// W_i x + b_i of all gates for each step, by one product for all steps, which reads the weights once. Not used on a
  /// tape, where the gradient of each step would have all rows.
  std::vector<Tensor<B, 2>> read(const std::vector<Tensor<B, 2>>& x) const {
    std::vector<Tensor<B, 2>> out;
    if (AutodiffBackend<B> || x.size() < 2) {
      for (const auto& step : x) out.push_back(linear(step, weight_ih, &bias_ih));
      return out;
    }
    const auto all = linear(concat(std::span<const Tensor<B, 2>>(x), 0), weight_ih, &bias_ih);
    Index at = 0;
    for (const auto& step : x) {
      out.push_back(slice(all, 0, at, at + step.size(0)));
      at += step.size(0);
    }
    return out;
  }
};

/// One step of time through a stack of layers, for models that write what they read next: x (rows, in) -> (rows,
/// hidden). `states` has one (rows, hidden) for each layer, and goes on. Steps may have fewer rows than those before.
/// Throws shape_error 204 for another number of states.
template <Backend B>
Tensor<B, 2> gru_step(std::span<const GruLayer<B>> layers, Tensor<B, 2> x, std::vector<Tensor<B, 2>>& states) {
  if (states.size() != layers.size())
    raise<shape_error>(204, "gru_step: ", counted(static_cast<Index>(states.size()), "state"), " for ",
                       counted(static_cast<Index>(layers.size()), "layer"));
  for (std::size_t i = 0; i < layers.size(); ++i)
    x = states[i] = layers[i](std::vector<Tensor<B, 2>>{x}, states[i]).front();
  return x;
}

/// A stack of layers. Every layer starts from zeros unless the caller passes a state. Official keys are weight_ih_l0,
/// ...: see `gru_key`.
template <Backend B>
struct Gru {
  std::vector<GruLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &Gru::layers); }

  Gru() = default;
  Gru(Index in, Index hidden, Index count, Rng auto& rng) {
    for (Index i = 0; i < count; ++i) layers.emplace_back(i == 0 ? in : hidden, hidden, rng);
  }
  std::vector<Tensor<B, 2>> operator()(std::vector<Tensor<B, 2>> x) const {
    const ModuleScope scope(*this);
    for (const auto& layer : layers) {
      if (!x.empty()) x = layer(x, Tensor<B, 2>::zeros({x.front().size(0), layer.hidden()}));
    }
    return x;
  }
  /// Runs each sequence on its own. Every row gives a row of the result. h0 (layers, sequences, hidden), null for
  /// zeros. Throws shape_error 204.
  Sequences<B> operator()(const Sequences<B>& x, const Tensor<B, 3>* h0 = nullptr) const {
    const ModuleScope scope(*this);
    const Index n = x.count(), hidden = layers.empty() ? 0 : layers.front().hidden();
    if (h0 != nullptr && h0->shape() != Shape{std::ssize(layers), n, hidden}) {
      raise<shape_error>(204, "Gru: h0 ", h0->shape(), " for ", layers.size(), " layers of ", hidden, " and ", n,
                         " sequences");
    }
    const detail::TimeSteps<B> time(x);
    auto steps = time.steps;
    if (steps.empty()) return {Tensor<B, 2>::zeros({0, hidden}), x.offsets};
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const auto layer = static_cast<Index>(i);
      steps = layers[i](steps, h0 == nullptr
                                   ? Tensor<B, 2>::zeros({n, layers[i].hidden()})
                                   : gather(reshape<2>(slice(*h0, 0, layer, layer + 1), {n, hidden}), time.order));
    }
    return x.with(time.packed(steps));
  }
};

/// "gru.layers.2.weight_ih" -> "gru.weight_ih_l2", at any depth, because PyTorch numbers the parameters instead of
/// nesting them. Other paths stay. `name`: the name of the Gru in the model.
std::string gru_key(const std::string& path, std::string_view name = "gru");

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/nn/gru.ipp>
#endif
