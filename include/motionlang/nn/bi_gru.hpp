// SPDX-License-Identifier: MIT
/// Sequences read from both ends by gated recurrent units: the encoders of Guo et al. for texts and motions.
#pragma once

#include <motionlang/nn/gru.hpp>
#include <motionlang/nn/pooling.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The states of both directions after each row. Rows are those of the input.
template <Backend B>
struct BiGruStates {
  Sequences<B> forward, backward;

  /// The states after the whole sequence: the last row of `forward` beside the first of `backward`, (sequences, 2
  /// hidden). Throws shape_error 203 for a sequence without rows.
  Tensor<B, 2> ends() const {
    const PoolVector<Index> first(static_cast<std::size_t>(backward.count()), 0);
    return concat(1, last_row(forward), pick_rows(backward, first));
  }
  /// Row t of `forward` beside row n - 1 - t of `backward`, as in TM2T: both have read t + 1 rows.
  Sequences<B> equally_far() const {
    const Offsets& offsets = forward.offsets;
    PoolVector<Index> turned;
    for (Index s = 0; s < offsets.count(); ++s) {
      for (Index r = offsets.end(s); r-- > offsets.begin(s);) turned.push_back(r);
    }
    return forward.with(concat(1, forward.rows, gather(backward.rows, turned)));
  }
};

/// One layer for each direction, with PyTorch's names.
template <Backend B>
struct BiGru {
  Tensor<B, 2> weight_ih_l0, weight_hh_l0, weight_ih_l0_reverse, weight_hh_l0_reverse;
  Tensor<B, 1> bias_ih_l0, bias_hh_l0, bias_ih_l0_reverse, bias_hh_l0_reverse;

  static constexpr auto fields() {
    using M = BiGru;
    return motionlang::fields("weight_ih_l0", &M::weight_ih_l0, "weight_hh_l0", &M::weight_hh_l0, "bias_ih_l0",
                              &M::bias_ih_l0, "bias_hh_l0", &M::bias_hh_l0, "weight_ih_l0_reverse",
                              &M::weight_ih_l0_reverse, "weight_hh_l0_reverse", &M::weight_hh_l0_reverse,
                              "bias_ih_l0_reverse", &M::bias_ih_l0_reverse, "bias_hh_l0_reverse",
                              &M::bias_hh_l0_reverse);
  }
  BiGru() = default;
  BiGru(Index in, Index hidden, Rng auto& rng) {
    const GruLayer<B> a(in, hidden, rng), b(in, hidden, rng);
    weight_ih_l0 = a.weight_ih, weight_hh_l0 = a.weight_hh, bias_ih_l0 = a.bias_ih, bias_hh_l0 = a.bias_hh;
    weight_ih_l0_reverse = b.weight_ih, weight_hh_l0_reverse = b.weight_hh;
    bias_ih_l0_reverse = b.bias_ih, bias_hh_l0_reverse = b.bias_hh;
  }

  Index hidden() const { return weight_hh_l0.size(1); }

  /// h0 (2, sequences, hidden), for both directions. Throws shape_error 204, 205.
  BiGruStates<B> operator()(const Sequences<B>& x, const Tensor<B, 3>& h0) const {
    const ModuleScope scope(*this);
    GruLayer<B> a, b;
    a.weight_ih = weight_ih_l0, a.weight_hh = weight_hh_l0, a.bias_ih = bias_ih_l0, a.bias_hh = bias_hh_l0;
    b.weight_ih = weight_ih_l0_reverse, b.weight_hh = weight_hh_l0_reverse;
    b.bias_ih = bias_ih_l0_reverse, b.bias_hh = bias_hh_l0_reverse;
    auto start = [&](Index direction) {
      return reshape<2>(slice(h0, 0, direction, direction + 1), {x.count(), hidden()});
    };
    return {a(x, start(0)), b(x, start(1), true)};
  }
};

/// Rows are projected, then read from both ends, starting from a learned state.
/// Source  text-to-motion networks/modules.py TextEncoderBiGRUCo and MotionEncoderBiGRUCo; TM2T networks/modules.py
template <Backend B>
struct BiGruEncoder {
  Tensor<B, 3> hidden;  // (2, 1, hidden)
  Linear<B> input_emb;
  BiGru<B> gru;

  static constexpr auto fields() {
    using M = BiGruEncoder;
    return motionlang::fields("hidden", &M::hidden, "input_emb", &M::input_emb, "gru", &M::gru);
  }
  BiGruEncoder() = default;
  BiGruEncoder(Index in, Index units, Rng auto& rng)
      : hidden(normal_init<B, 3>({2, 1, units}, 1, rng)), input_emb(in, units, rng), gru(units, units, rng) {
    input_emb.weight = xavier_normal<B, 2>({units, in}, rng);
    input_emb.bias = constant_init<B, 1>({units}, 0);
  }

  BiGruStates<B> operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    return gru(input_emb(x), broadcast_to<3>(hidden, {2, x.count(), gru.hidden()}));
  }
};

MOTIONLANG_NAMESPACE_END
