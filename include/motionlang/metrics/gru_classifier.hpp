// SPDX-License-Identifier: MIT
/// Action2Motion's classifier of joint positions, a recurrent network. Its accuracy and its features judge generated
/// motions.
#pragma once

#include <motionlang/nn/gru.hpp>
#include <motionlang/nn/pooling.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The output of a classifier for each sequence: features for statistics of motions, and a score for each class.
template <Backend B>
struct Recognition {
  Tensor<B, 2> features, logits;
};

struct GruClassifierConfig {
  Index input_size = 72;  // three values of 24 joints; 54 for NTU-13
  Index hidden_size = 128;
  Index num_layers = 2;
  Index num_classes = 12;
};

///     features = tanh(W1 h),  logits = W2 features,   h: the network's output at the last frame
/// Source  Guo et al., "Action2Motion" (2020), as ACTOR evaluates with it; thesis 3.3.1; ACTOR
///         src/evaluate/action2motion/models.py MotionDiscriminator. Keys of the official file (below "model"):
///         recurrent.weight_ih_l0, ..., linear1, linear2.
template <Backend B>
struct GruClassifier {
  static constexpr Index feature_count = 30;
  Gru<B> recurrent;
  Linear<B> linear1, linear2;

  static constexpr auto fields() {
    using M = GruClassifier;
    return motionlang::fields("recurrent", &M::recurrent, "linear1", &M::linear1, "linear2", &M::linear2);
  }
  static std::string official_key(const std::string& path) { return gru_key(path, "recurrent"); }

  GruClassifier() = default;
  GruClassifier(const GruClassifierConfig& c, Rng auto& rng)
      : recurrent(c.input_size, c.hidden_size, c.num_layers, rng),
        linear1(c.hidden_size, feature_count, rng),
        linear2(feature_count, c.num_classes, rng) {}

  /// x: frames of joint positions, joint by joint. The official code draws h0 (layers, sequences, hidden) from N(0, 1)
  /// at every call, also after training. Here the caller supplies it (`initial_state`). Without it the network starts
  /// from zeros.
  Recognition<B> operator()(const Sequences<B>& x, const Tensor<B, 3>* h0 = nullptr) const {
    const auto h = last_row(recurrent(x, h0));
    const auto features = linear1(h, Activation::tanh);
    return {features, linear2(features)};
  }
  Tensor<B, 3> initial_state(Index sequences, Rng auto& rng) const {
    return Tensor<B, 3>::randn({std::ssize(recurrent.layers), sequences, linear1.in()}, rng);
  }
};

MOTIONLANG_NAMESPACE_END
