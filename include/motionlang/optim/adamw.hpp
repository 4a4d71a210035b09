// SPDX-License-Identifier: MIT
/// AdamW, and the norm of all gradients.
#pragma once

#include <array>    // sums side by side
#include <cmath>    // pow, sqrt
#include <map>      // state by parameter
#include <numeric>  // their sum
#include <set>      // paths
#include <span>     // values of a gradient
#include <utility>  // move

#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct AdamWConfig {
  double lr = 1e-4;
  double beta1 = 0.9, beta2 = 0.999;
  double eps = 1e-8;
  double weight_decay = 0.01;
  bool allow_constants = false;  // parameters that are not variables do not change; otherwise they are an error
};

namespace detail {

/// In double, as eight sums side by side; a single sum would wait for each addition.
template <Scalar S>
double sum_of_squares(std::span<const S> values) {
  std::array<double, 8> sums{};
  std::size_t i = 0;
  for (; i + sums.size() <= values.size(); i += sums.size()) {
    for (std::size_t lane = 0; lane < sums.size(); ++lane) {
      const auto x = static_cast<double>(values[i + lane]);
      sums[lane] += x * x;
    }
  }
  for (; i < values.size(); ++i) sums[0] += static_cast<double>(values[i]) * static_cast<double>(values[i]);
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace detail

/// Square root of the sum of squares of all gradients, in double and in the order of the fields.
template <AutodiffBackend A, Module M>
double gradient_norm(const M& model, const Gradients<A>& gradients) {
  double total = 0;
  for (const auto& t : tensors_of(model)) {
    if (const auto* g = gradients.find(*t.data))
      total += detail::sum_of_squares<typename A::scalar>(A::inner::to_span(*g));
  }
  return std::sqrt(total);
}
/// The factor that reduces a norm to `max_norm`: min(1, max_norm / (norm + 1e-6)), as in PyTorch.
inline double clip_scale(double norm, double max_norm) { return std::min(1.0, max_norm / (norm + 1e-6)); }

/// Decoupled weight decay (Loshchilov and Hutter 2019, algorithm 2) with PyTorch's order of operations:
///     p = p (1 - lr wd);   m = b1 m + (1 - b1) g;   v = b2 v + (1 - b2) g^2
///     p = p - lr / (1 - b1^k) m / (sqrt(v / (1 - b2^k)) + eps)
/// All parameters decay, including biases and norms. Parameters that the loss does not reach do not change. With
/// weight_decay = 0 this is Adam. Tensors of modules with `trainable = false` are not parameters.
template <AutodiffBackend A>
class AdamW {
 public:
  using B = typename A::inner;
  struct Moments {
    typename B::tensor m, v;
  };

  explicit AdamW(AdamWConfig c = {}) : config(c) {}

  AdamWConfig config;

  /// One update. Gradients are first multiplied by `scale` (clip_scale). The model keeps its variables. Throws
  /// config_error 102 for a parameter that is not a variable (unless config.allow_constants) and for two parameters
  /// with the same path, before anything has changed. Throws shape_error 204 if restored moments belong to another
  /// model.
  template <Module M>
  void step(M& model, const Gradients<A>& gradients, double scale = 1) {
    const auto tensors = tensors_of(model);
    check(tensors);
    ++steps_;
    for (const auto& t : tensors) update(t, gradients, scale);
  }

  /// The number of updates, and the moments by path, for a checkpoint.
  Index steps() const { return steps_; }
  const std::map<std::string, Moments>& state() const { return state_; }
  void restore(Index steps, std::map<std::string, Moments> state) {
    steps_ = steps;
    state_ = std::move(state);
  }

 private:
  void check(const std::vector<ModuleTensor<A>>& tensors) const {
    std::set<std::string_view> paths;
    for (const auto& t : tensors) {
      if (!paths.insert(t.path).second) raise<config_error>(102, "AdamW: two parameters are '", t.path, "'");
      const auto& node = t.data->node;
      if (config.allow_constants || !t.trainable || t.shape().rank() != t.rank) continue;  // the last: it is unset
      if (node == nullptr || !node->variable) {
        raise<config_error>(102, "AdamW: parameter '", t.path, "' is ",
                            node == nullptr ? "a constant" : "the result of an operation",
                            ", not a variable: it would not be trained");
      }
    }
  }
  void update(const ModuleTensor<A>& t, const Gradients<A>& gradients, double scale) {
    const auto* g = gradients.find(*t.data);
    if (g == nullptr) return;
    auto found = state_.find(t.path);
    if (found == state_.end()) {
      const auto zero = B::full(B::shape(*g), 0);
      found = state_.emplace(t.path, Moments{zero, zero}).first;
    }
    Moments& s = found->second;
    for (const auto* moment : {&s.m, &s.v}) {
      if (B::shape(*moment) != t.shape())
        raise<shape_error>(204, "AdamW: '", t.path, "' is ", t.shape(), ", its restored moments are ",
                           B::shape(*moment));
    }
    const AdamwUpdate u{.lr = config.lr,
                        .beta1 = config.beta1,
                        .beta2 = config.beta2,
                        .eps = config.eps,
                        .weight_decay = config.weight_decay,
                        .gradient_scale = scale,
                        .step = steps_};
    adamw_update<B>(A::mutable_value(*t.data), s.m, s.v, *g, u);
  }

  Index steps_ = 0;
  std::map<std::string, Moments> state_;
};

MOTIONLANG_NAMESPACE_END
