// SPDX-License-Identifier: MIT
/// Operations for which a backend may have a kernel. Each is defined here in primitives, which are its meaning.
///
/// `if constexpr (requires { B::linear(...); })` takes the kernel of a backend that has one. `Autodiff<B>` has the
/// operation, with a hand-written derivative, exactly if B has its kernels. Otherwise the definition below is
/// differentiated.
#pragma once

#include <cmath>  // sqrt

#include <motionlang/core/activation.hpp>
#include <motionlang/core/dropout.hpp>
#include <motionlang/core/precision.hpp>
#include <motionlang/tensor/ops.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void check_dropout(const Dropout& d) {
  if (!(d.p >= 0 && d.p < 1)) raise<config_error>(101, "dropout: probability ", d.p, " is not in [0, 1)");
}

}  // namespace detail

/// x times the mask of core/dropout.hpp; positions are row-major. Throws config_error 101 unless 0 <= p < 1.
template <Backend B, int R>
Tensor<B, R> dropout(const Tensor<B, R>& x, const Dropout& d) {
  detail::require_tensor("dropout", x);
  detail::check_dropout(d);
  if (d.p == 0) return x;
  if constexpr (requires { B::dropout(x.data(), d); }) {
    return Tensor<B, R>(B::dropout(x.data(), d));
  } else {
    std::vector<typename B::scalar> mask(static_cast<std::size_t>(x.count()));
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = static_cast<typename B::scalar>(d.factor(i));
    return x * Tensor<B, R>::from(mask, x.shape());
  }
}

/// Applies a nonlinearity element by element (core/activation.hpp has the formulas).
template <Backend B, int R>
Tensor<B, R> activate(const Tensor<B, R>& x, Activation act) {
  detail::require_tensor("activate", x);
  if constexpr (requires { B::activate(x.data(), act); }) {
    return Tensor<B, R>(B::activate(x.data(), act));
  } else {
    switch (act) {
      case Activation::none:
        return x;
      case Activation::relu:
        return maximum(x, Tensor<B, R>(0.0));  // slope 1 at 0; 0 in the kernels, as in PyTorch
      case Activation::gelu:
        return x * 0.5 * (erf(x * std::sqrt(0.5)) + 1.0);
      case Activation::silu:
        return x / (exp(-x) + 1.0);
      case Activation::tanh:
        return tanh(x);
      case Activation::quick_gelu:
        return x / (exp(x * -1.702) + 1.0);
      case Activation::gelu_new:
        return x * 0.5 * (tanh((x + x * x * x * 0.044715) * 0.79788456080286536) + 1.0);
      case Activation::sigmoid:
        return 1.0 / (exp(-x) + 1.0);
    }
    return x;
  }
}

namespace detail {

template <Backend B>
void check_linear(const Tensor<B, 2>& x, const Tensor<B, 2>& weight, const Tensor<B, 1>* bias,
                  const Tensor<B, 2>* residual) {
  if (x.size(1) != weight.size(1)) {
    raise<shape_error>(201, "linear: inner sizes differ: input ", x.shape(), ", weight ", weight.shape());
  }
  if (bias != nullptr && bias->size(0) != weight.size(0)) {
    raise<shape_error>(204, "linear: bias ", bias->shape(), " for weight ", weight.shape());
  }
  if (residual != nullptr && residual->shape() != Shape{x.size(0), weight.size(0)}) {
    raise<shape_error>(204, "linear: residual ", residual->shape(), " for input ", x.shape(), " and weight ",
                       weight.shape());
  }
  require_tensor("linear", x);
  require_tensor("linear", weight);
  if (bias != nullptr) require_tensor("linear", *bias);
}

}  // namespace detail

/// y = dropout(act(x W^T + bias)) + residual.   x (rows, in), weight (out, in), bias (out), residual (rows, out) ->
/// (rows, out). Bias and residual may be null. Throws shape_error 201, 204, and as dropout.
template <Backend B>
Tensor<B, 2> linear(const Tensor<B, 2>& x, const Tensor<B, 2>& weight, const Tensor<B, 1>* bias,
                    Activation act = Activation::none, const Tensor<B, 2>* residual = nullptr,
                    const Dropout& drop = {}) {
  detail::check_linear(x, weight, bias, residual);
  detail::check_dropout(drop);
  using T = const typename B::tensor*;
  if constexpr (requires { B::linear(x.data(), weight.data(), T{}, act, T{}, drop); }) {
    return Tensor<B, 2>(B::linear(x.data(), weight.data(), bias == nullptr ? nullptr : &bias->data(), act,
                                  residual == nullptr ? nullptr : &residual->data(), drop));
  } else {
    auto y = matmul(x, weight, {.transpose_b = true});
    if (bias != nullptr) y = y + *bias;
    if (act != Activation::none) y = activate(y, act);
    y = dropout(y, drop);
    return residual == nullptr ? y : y + *residual;
  }
}

/// Layer normalisation over the last axis (Ba et al. 2016): (x - mean) / sqrt(variance + eps) weight + bias, with the
/// variance divided by n. Throws shape_error 204.
template <Backend B>
Tensor<B, 2> layer_norm(const Tensor<B, 2>& x, const Tensor<B, 1>& weight, const Tensor<B, 1>& bias,
                        double eps = 1e-5) {
  if (weight.size(0) != x.size(1) || bias.size(0) != x.size(1)) {
    raise<shape_error>(204, "layer_norm: weight ", weight.shape(), " and bias ", bias.shape(), " for input ",
                       x.shape());
  }
  detail::require_tensor("layer_norm", x);
  if constexpr (requires { B::layer_norm(x.data(), weight.data(), bias.data(), eps); }) {
    return Tensor<B, 2>(B::layer_norm(x.data(), weight.data(), bias.data(), eps));
  } else {
    const Index rows = x.size(0);
    const auto centred = x - reshape<2>(mean(x, 1), {rows, 1});
    const auto variance = reshape<2>(mean(square(centred), 1), {rows, 1});
    return centred / sqrt(variance + eps) * weight + bias;
  }
}
/// layer_norm(x + residual): the second half of a post-norm block.
template <Backend B>
Tensor<B, 2> add_layer_norm(const Tensor<B, 2>& x, const Tensor<B, 2>& residual, const Tensor<B, 1>& weight,
                            const Tensor<B, 1>& bias, double eps = 1e-5) {
  if constexpr (requires { B::add_layer_norm(x.data(), residual.data(), weight.data(), bias.data(), eps); }) {
    if (x.shape() != residual.shape() || weight.size(0) != x.size(1) || bias.size(0) != x.size(1)) {
      raise<shape_error>(204, "add_layer_norm: input ", x.shape(), ", residual ", residual.shape(), ", weight ",
                         weight.shape());
    }
    detail::require_tensor("add_layer_norm", x);
    return Tensor<B, 2>(B::add_layer_norm(x.data(), residual.data(), weight.data(), bias.data(), eps));
  } else {
    return layer_norm(x + residual, weight, bias, eps);
  }
}

/// softmax over the last axis: exp(x - max) / sum.
template <Backend B>
Tensor<B, 2> softmax(const Tensor<B, 2>& x) {
  detail::require_tensor("softmax", x);
  if constexpr (requires { B::softmax(x.data()); }) {
    return Tensor<B, 2>(B::softmax(x.data()));
  } else {
    const auto e = exp(x - reshape<2>(max(x, 1), {x.size(0), 1}));
    return e / reshape<2>(sum(e, 1), {x.size(0), 1});
  }
}

struct AttentionOptions {
  Index heads = 1;
  bool causal = false;                        // a query only sees keys up to its own position
  Dropout dropout{};                          // on the attention weights
  Precision precision = product_precision();  // layers take that of their weights
};

/// In which precision products with a weight are computed: that of `prepare`, else the one of the process.
template <Backend B, int R>
Precision precision_of(const Tensor<B, R>& weight) {
  if constexpr (PackingBackend<B>) {
    return B::precision_of(weight.data());
  } else {
    return product_precision();
  }
}

namespace detail {

template <Backend B>
void check_attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, const Offsets& q_offsets,
                     const Offsets& k_offsets, const AttentionOptions& options,
                     const Tensor<B, 2>* relative_scores = nullptr) {
  if (q.size(1) != k.size(1) || k.shape() != v.shape()) {
    raise<shape_error>(204, "attention: q ", q.shape(), ", k ", k.shape(), ", v ", v.shape());
  }
  if (options.heads < 1 || q.size(1) % options.heads != 0) {
    raise<config_error>(101, "attention: ", options.heads, " heads do not divide width ", q.size(1));
  }
  if (q_offsets.rows() != q.size(0) || k_offsets.rows() != k.size(0) || q_offsets.count() != k_offsets.count()) {
    raise<shape_error>(207, "attention: offsets for ", q_offsets.rows(), " and ", k_offsets.rows(), " rows, q ",
                       q.shape(), ", k ", k.shape());
  }
  for (Index s = 0; s < k_offsets.count(); ++s) {
    if (k_offsets.length(s) == 0 && q_offsets.length(s) > 0)
      raise<shape_error>(207, "attention: sequence ", s, " has no keys");
    if (k_offsets.length(s) > 65536) raise<shape_error>(207, "attention: sequence ", s, " has more than 65536 keys");
  }
  require_tensor("attention", q);
  require_tensor("attention", k);
  if (relative_scores == nullptr) return;
  const Index farthest = std::max(q_offsets.longest(), k_offsets.longest()) - 1;
  if (relative_scores->size(0) != options.heads || relative_scores->size(1) % 2 != 1 ||
      relative_scores->size(1) / 2 < farthest) {
    raise<shape_error>(204, "attention: relative scores ", relative_scores->shape(), " for ", options.heads,
                       " heads and distances up to ", farthest);
  }
}

/// (queries, keys) of one head: element (i, j) is that of distance j - i.
template <Backend B>
Tensor<B, 2> scores_of_distances(const Tensor<B, 2>& relative_scores, Index head, Index tq, Index tk) {
  const Index zero = relative_scores.size(1) / 2;  // the column of distance 0
  PoolVector<Index> columns;
  for (Index i = 0; i < tq; ++i) {
    for (Index j = 0; j < tk; ++j) columns.push_back(zero + j - i);
  }
  return reshape<2>(gather(reshape<1>(slice(relative_scores, 0, head, head + 1), {-1}), columns), {tq, tk});
}

/// softmax(q k^T / sqrt(width) + relative scores) v for one head of one sequence; q (tq, width), k and v (tk, width).
template <Backend B>
Tensor<B, 2> attend(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, Index first_row, Index head,
                    const AttentionOptions& o, const Tensor<B, 2>* relative_scores) {
  const Index tq = q.size(0), tk = k.size(0);
  auto scores = matmul(q, k, {.transpose_b = true}) * (1.0 / std::sqrt(static_cast<double>(q.size(1))));
  if (relative_scores != nullptr) scores = scores + scores_of_distances(*relative_scores, head, tq, tk);
  using S = typename B::scalar;
  std::vector<S> values(static_cast<std::size_t>(tq * tk));
  if (o.causal) {
    for (Index i = 0; i < tq; ++i) {
      for (Index j = i + 1; j < tk; ++j) values[static_cast<std::size_t>(i * tk + j)] = S(-1e30);
    }
    scores = scores + Tensor<B, 2>::from(values, {tq, tk});
  }
  auto weights = softmax(scores);
  if (o.dropout.p > 0) {
    for (Index i = 0; i < tq; ++i) {
      for (Index j = 0; j < tk; ++j) {
        values[static_cast<std::size_t>(i * tk + j)] =
            static_cast<S>(o.dropout.factor(Dropout::attention_position(first_row + i, o.heads, head, j)));
      }
    }
    weights = weights * Tensor<B, 2>::from(values, {tq, tk});
  }
  return matmul(weights, v);
}

}  // namespace detail

/// Multi-head attention over packed sequences (Vaswani et al. 2017, eq. 1); heads are contiguous slices of the width.
///     O_h = softmax(Q_h K_h^T / sqrt(width / heads) + R_h) V_h     within each sequence
/// q (query rows, width), k and v (key rows, width) -> (query rows, width). There is no padding: a masked key is not in
/// the sequence (see from_padded). R may be null. Element (i, j) of R_h is the value for the distance j - i: column j -
/// i + n of relative_scores (heads, 2 n + 1). Throws config_error 101, shape_error 204, 207.
template <Backend B>
Tensor<B, 2> attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, const Offsets& q_offsets,
                       const Offsets& k_offsets, const AttentionOptions& options,
                       const Tensor<B, 2>* relative_scores = nullptr) {
  detail::check_attention(q, k, v, q_offsets, k_offsets, options, relative_scores);
  using T = const typename B::tensor*;
  if constexpr (requires { B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options, T{}); }) {
    return Tensor<B, 2>(B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options,
                                     relative_scores == nullptr ? nullptr : &relative_scores->data()));
  } else {
    if constexpr (requires { B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options); }) {
      if (relative_scores == nullptr)
        return Tensor<B, 2>(B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options));
    }
    const Index width = q.size(1) / options.heads;
    std::vector<Tensor<B, 2>> sequences, heads;
    for (Index s = 0; s < q_offsets.count(); ++s) {
      const auto qs = slice(q, 0, q_offsets.begin(s), q_offsets.end(s));
      const auto ks = slice(k, 0, k_offsets.begin(s), k_offsets.end(s)),
                 vs = slice(v, 0, k_offsets.begin(s), k_offsets.end(s));
      heads.clear();
      for (Index h = 0; h < options.heads; ++h) {
        auto columns = [&](const Tensor<B, 2>& t) { return slice(t, 1, h * width, (h + 1) * width); };
        heads.push_back(
            detail::attend(columns(qs), columns(ks), columns(vs), q_offsets.begin(s), h, options, relative_scores));
      }
      sequences.push_back(concat(std::span<const Tensor<B, 2>>(heads), 1));
    }
    return sequences.empty() ? q : concat(std::span<const Tensor<B, 2>>(sequences), 0);
  }
}

/// The same with q, k and v side by side, the result of one projection: qkv (rows, 3 width) -> (rows, width).
template <Backend B>
Tensor<B, 2> self_attention(const Tensor<B, 2>& qkv, const Offsets& offsets, const AttentionOptions& options) {
  if (qkv.size(1) % 3 != 0) raise<shape_error>(204, "self_attention: ", qkv.shape(), " is not three parts wide");
  detail::require_tensor("self_attention", qkv);
  const Index d = qkv.size(1) / 3;
  if constexpr (requires { B::self_attention(qkv.data(), offsets, options); }) {
    if (options.heads < 1 || d % options.heads != 0) {
      raise<config_error>(101, "self_attention: ", options.heads, " heads do not divide width ", d);
    }
    if (offsets.rows() != qkv.size(0))
      raise<shape_error>(207, "self_attention: offsets for ", offsets.rows(), " rows, ", qkv.shape());
    if (offsets.longest() > 65536) raise<shape_error>(207, "self_attention: a sequence has more than 65536 rows");
    return Tensor<B, 2>(B::self_attention(qkv.data(), offsets, options));
  } else {
    return attention(slice(qkv, 1, 0, d), slice(qkv, 1, d, 2 * d), slice(qkv, 1, 2 * d, 3 * d), offsets, offsets,
                     options);
  }
}

/// One step of AdamW on one parameter; optim/adamw.hpp has the formula.
struct AdamwUpdate {
  double lr = 0, beta1 = 0, beta2 = 0, eps = 0, weight_decay = 0, gradient_scale = 1;
  Index step = 1;  // 1 for the first
};

/// Updates the parameter p and the moments m and v with gradient g, all of one shape.
template <Backend B>
void adamw_update(typename B::tensor& p, typename B::tensor& m, typename B::tensor& v, const typename B::tensor& g,
                  const AdamwUpdate& u) {
  if constexpr (requires { B::adamw(p, m, v, g, u); }) {
    B::adamw(p, m, v, g, u);
  } else {
    using T = typename B::tensor;
    auto number = [](double c) { return B::full(Shape{}, static_cast<typename B::scalar>(c)); };
    auto times = [&](const T& a, double c) { return B::mul(a, number(c)); };
    const double k = static_cast<double>(u.step);
    const T scaled = times(g, u.gradient_scale);
    m = B::add(times(m, u.beta1), times(scaled, 1 - u.beta1));
    v = B::add(times(v, u.beta2), times(B::mul(scaled, scaled), 1 - u.beta2));
    const T root = times(B::sqrt(v), 1 / std::sqrt(1 - std::pow(u.beta2, k)));
    const T change = B::div(m, B::add(root, number(u.eps)));
    p = B::sub(times(p, 1 - u.lr * u.weight_decay), times(change, u.lr / (1 - std::pow(u.beta1, k))));
  }
}

MOTIONLANG_NAMESPACE_END
