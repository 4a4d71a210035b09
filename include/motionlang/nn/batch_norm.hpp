// SPDX-License-Identifier: MIT
/// Batch normalisation of rows, with running statistics.
#pragma once

#include <motionlang/core/context.hpp>
#include <motionlang/nn/init.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/module.hpp>
#include <motionlang/tensor/ops.hpp>
#include <motionlang/tensor/sum_over_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Running statistics of a BatchNorm from training. They are saved and loaded, but not trained.
template <Backend B>
struct RunningStatistics {
  static constexpr bool trainable = false;
  Tensor<B, 1> running_mean, running_var;  // (channels)
  Tensor<B, 0> num_batches_tracked;        // PyTorch counts batches and, with a momentum, does not use it

  static constexpr auto fields() {
    using M = RunningStatistics;
    return motionlang::fields("running_mean", &M::running_mean, "running_var", &M::running_var, "num_batches_tracked",
                              &M::num_batches_tracked);
  }
};

///     y = (x - m) / sqrt(v + eps) weight + bias
/// Source  Ioffe and Szegedy (2015), algorithms 1 and 2; parameter names of PyTorch.
/// In use, m and v are the running statistics. In training, `train(x)`, they are mean and variance (divided by n) of
/// the rows. The running ones move towards them: r = (1 - momentum) r + momentum s, where s has the variance divided by
/// n - 1. With `context.sums` the rows are a part of those of a batch, and mean, variance and n are those of the batch.
template <Backend B>
struct BatchNorm {
  Tensor<B, 1> weight, bias;  // (channels)
  RunningStatistics<B> statistics;
  double eps = 1e-5, momentum = 0.1;

  static constexpr auto fields() {
    using M = BatchNorm;
    return motionlang::fields("weight", &M::weight, "bias", &M::bias, "", &M::statistics, "eps", &M::eps, "momentum",
                              &M::momentum);
  }
  BatchNorm() = default;
  explicit BatchNorm(Index channels)
      : weight(constant_init<B, 1>({channels}, 1)),
        bias(constant_init<B, 1>({channels}, 0)),
        statistics{Tensor<B, 1>::zeros({channels}), Tensor<B, 1>::full({channels}, 1), Tensor<B, 0>::zeros({})} {}

  /// (rows, channels)
  Tensor<B, 2> operator()(const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    check(x);
    const auto scale = weight / sqrt(statistics.running_var + eps);
    return x * scale + (bias - statistics.running_mean * scale);
  }
  /// The same with the statistics of these rows, which are stored. Throws shape_error 205 for a batch of fewer than two
  /// rows.
  Tensor<B, 2> train(const Tensor<B, 2>& x, const Context& context = {}) {
    const ModuleScope scope(*this);
    check(x);
    auto n = static_cast<double>(x.size(0));
    const auto sum_of_batch = [&](const Tensor<B, 2>& rows, double* count = nullptr) {
      return context.sums == nullptr ? sum(rows, 0) : sum_over_parts(sum(rows, 0), *context.sums, count);
    };
    const auto total = sum_of_batch(x, &n);
    if (n < 2) raise<shape_error>(205, "BatchNorm: ", x.shape(), " has no variance to train with");
    const auto m = total / n;
    const auto centred = x - m;
    const auto v = sum_of_batch(square(centred)) / n;
    if (context.sums == nullptr || context.sums->keeps_statistics()) remember(m, v, n);
    return centred * (weight / sqrt(v + eps)) + bias;
  }

 private:
  void remember(const Tensor<B, 1>& m, const Tensor<B, 1>& v, double n) {
    follow(statistics.running_mean, m, momentum);
    follow(statistics.running_var, v, momentum, n / (n - 1));
    statistics.num_batches_tracked = statistics.num_batches_tracked + 1.0;
  }
  void check(const Tensor<B, 2>& x) const {
    if (x.size(1) != weight.size(0))
      raise<shape_error>(204, "BatchNorm: input ", x.shape(), " for ", weight.size(0), " channels");
  }
  static void follow(Tensor<B, 1>& running, const Tensor<B, 1>& seen, double momentum, double factor = 1) {
    running = stop_gradient(running * (1 - momentum) + seen * (momentum * factor));
  }
};

/// Uses running statistics for a constant norm, and those of the rows for a norm that may change. So one function runs
/// a network both ways.
template <Backend B>
Tensor<B, 2> batch_norm(const BatchNorm<B>& norm, const Tensor<B, 2>& x, const Context& = {}) {
  return norm(x);
}
template <Backend B>
Tensor<B, 2> batch_norm(BatchNorm<B>& norm, const Tensor<B, 2>& x, const Context& context = {}) {
  return norm.train(x, context);
}

MOTIONLANG_NAMESPACE_END
