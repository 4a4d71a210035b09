// SPDX-License-Identifier: MIT
/// A stack of convolutions over time and the steps between them, numbered like PyTorch's Sequential.
///
///     ConvStack<B> main;
///     // main.0, main.1, main.2
///     main.conv(259, 512, 4, {.stride = 2, .padding = 1}, rng).dropout(0.2).leaky_relu();
///
/// The networks of Guo et al. are such stacks: the movement encoder and decoder of their evaluator (CVPR 2022), and
/// TM2T's tokenizer and discriminator (ECCV 2022). Weights of convolutions begin as xavier_normal, biases as 0.
#pragma once

#include <motionlang/nn/batch_norm.hpp>
#include <motionlang/nn/conv_transpose1d.hpp>
#include <motionlang/nn/dropout.hpp>
#include <motionlang/nn/leaky_relu.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Repeats every row several times, so that sequences become longer.
template <Backend B>
Sequences<B> repeat_rows(const Sequences<B>& x, Index times) {
  PoolVector<Index> pick, lengths;
  for (Index i = 0; i < x.offsets.rows() * times; ++i) pick.push_back(i / times);
  for (Index s = 0; s < x.count(); ++s) lengths.push_back(x.offsets.length(s) * times);
  return {gather(x.rows, pick), Offsets(std::span<const Index>(lengths))};
}

namespace detail {

template <Backend B>
Conv1d<B> xavier_conv(Index in, Index out, Index kernel, const Conv1dOptions& o, Rng auto& rng) {
  NoInit none;
  Conv1d<B> conv(in, out, kernel, o, none);
  conv.weight = xavier_normal<B, 3>({out, in, kernel}, rng);
  conv.bias = constant_init<B, 1>({out}, 0);
  return conv;
}

}  // namespace detail

///     x + W2 * leaky_relu(W1 * x),   W: convolutions of kernel 3 that keep the length
/// Source  TM2T networks/modules.py VQEncoderV3. No nonlinearity around it.
template <Backend B>
struct ConvResidual {
  Conv1d<B> first, second;

  static constexpr auto fields() {
    return motionlang::fields("model.0", &ConvResidual::first, "model.2", &ConvResidual::second);
  }
  ConvResidual() = default;
  ConvResidual(Index channels, Rng auto& rng)
      : first(detail::xavier_conv<B>(channels, channels, 3, {.padding = 1}, rng)),
        second(detail::xavier_conv<B>(channels, channels, 3, {.padding = 1}, rng)) {}

  Sequences<B> operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    auto inner = first(x);
    inner.rows = leaky_relu(inner.rows);
    return x.with(x.rows + second(inner).rows);
  }
};

enum class ConvStep { conv, transposed, norm, residual, leaky_relu, dropout, repeat };

/// One step. Only the member that it needs is set.
template <Backend B>
struct ConvStackLayer {
  ConvStep step = ConvStep::conv;
  std::optional<Conv1d<B>> conv{};
  std::optional<ConvTranspose1d<B>> transposed{};
  std::optional<BatchNorm<B>> norm{};
  std::optional<ConvResidual<B>> residual{};
  double amount = 0;  // slope, probability of dropout, times

  static constexpr auto fields() {
    using M = ConvStackLayer;
    return motionlang::fields("step", &M::step, "", &M::conv, "", &M::transposed, "", &M::norm, "", &M::residual,
                              "amount", &M::amount);
  }
};

template <Backend B>
class ConvStack {
 public:
  static constexpr auto fields() { return motionlang::fields("", &ConvStack::layers_); }

  ConvStack& conv(Index in, Index out, Index kernel, const Conv1dOptions& o, Rng auto& rng) {
    add(ConvStep::conv).conv = detail::xavier_conv<B>(in, out, kernel, o, rng);
    return *this;
  }
  ConvStack& transposed(Index in, Index out, Index kernel, Index stride, Index padding, Rng auto& rng) {
    NoInit none;
    ConvTranspose1d<B> conv(in, out, kernel, stride, padding, none);
    conv.weight = xavier_normal<B, 3>({in, out, kernel}, rng);
    conv.bias = constant_init<B, 1>({out}, 0);
    add(ConvStep::transposed).transposed = std::move(conv);
    return *this;
  }
  ConvStack& norm(Index channels) {
    add(ConvStep::norm).norm = BatchNorm<B>(channels);
    return *this;
  }
  ConvStack& residual(Index channels, Rng auto& rng) {
    add(ConvStep::residual).residual = ConvResidual<B>(channels, rng);
    return *this;
  }
  ConvStack& leaky_relu(double slope = 0.2) { return with_amount(ConvStep::leaky_relu, slope); }
  ConvStack& dropout(double p) { return with_amount(ConvStep::dropout, p); }
  /// "Upsampling" to the nearest row.
  ConvStack& repeat(Index times) { return with_amount(ConvStep::repeat, static_cast<double>(times)); }

  Index size() const { return std::ssize(layers_); }

  /// In use: norms take their running statistics.
  Sequences<B> operator()(const Sequences<B>& x, const Context& context = {}) const { return run(*this, x, context); }
  /// In training: norms take the statistics of these rows, and store them.
  Sequences<B> train(const Sequences<B>& x, const Context& context = {}) { return run(*this, x, context); }

 private:
  ConvStackLayer<B>& add(ConvStep step) {
    layers_.push_back({.step = step});
    return layers_.back();
  }
  ConvStack& with_amount(ConvStep step, double amount) {
    add(step).amount = amount;
    return *this;
  }
  template <class Self>
  static Sequences<B> run(Self& self, Sequences<B> x, const Context& context) {
    const ModuleScope scope(self);
    for (std::size_t i = 0; i < self.layers_.size(); ++i) {
      auto& layer = self.layers_[i];
      switch (layer.step) {
        case ConvStep::conv:
          x = (*layer.conv)(x);
          break;
        case ConvStep::transposed:
          x = (*layer.transposed)(x);
          break;
        case ConvStep::norm:
          x.rows = batch_norm(*layer.norm, x.rows, context);
          break;
        case ConvStep::residual:
          x = (*layer.residual)(x);
          break;
        case ConvStep::leaky_relu:
          x.rows = motionlang::leaky_relu(x.rows, layer.amount);
          break;
        case ConvStep::dropout:
          x.rows = motionlang::dropout(x.rows, layer.amount, context);
          break;
        case ConvStep::repeat:
          x = repeat_rows(x, static_cast<Index>(layer.amount));
          break;
      }
    }
    return x;
  }

  std::vector<ConvStackLayer<B>> layers_;
};

MOTIONLANG_NAMESPACE_END
