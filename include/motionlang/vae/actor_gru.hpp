// SPDX-License-Identifier: MIT
/// The recurrent encoder and decoder that ACTOR is compared with (thesis table 3.4).
#pragma once

#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/gru.hpp>
#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The action of each frame's motion, one-hot, and if wanted the relative time of the frame in its motion:
/// (frames, classes), or one more column.
template <Backend B>
Tensor<B, 2> action_and_time(std::span<const Index> labels, Index classes, const Offsets& lengths, bool time) {
  const auto action = repeat_for_rows(one_hot<B>(labels, classes), lengths);
  return time ? concat(1, action, relative_time<B>(lengths)) : action;
}

/// Each frame as the one before it, zeros for the first.
template <Backend B>
Sequences<B> frames_before(const Sequences<B>& x) {
  PoolVector<Index> rows;  // of a table that begins with a frame of zeros
  for (Index s = 0; s < x.count(); ++s) {
    for (Index t = 0; t < x.offsets.length(s); ++t) rows.push_back(t == 0 ? 0 : x.offsets.begin(s) + t);
  }
  return x.with(gather(concat(0, Tensor<B, 2>::zeros({1, x.width()}), x.rows), rows));
}

}  // namespace detail

///     h = GRU(W [frame, one-hot y, time]);   mu and logvar from the last frame's h
/// Source  thesis 3.3.2, table 3.4; ACTOR src/models/architectures/gru.py
template <Backend B>
struct ActorGruEncoder {
  Linear<B> feats_embedding;
  Gru<B> gru;
  Linear<B> mu, var;
  bool concatenate_time = true;

  static constexpr auto fields() {
    using M = ActorGruEncoder;
    return motionlang::fields("feats_embedding", &M::feats_embedding, "gru", &M::gru, "mu", &M::mu, "var", &M::var,
                              "concatenate_time", &M::concatenate_time);
  }
  static std::string official_key(const std::string& path) { return gru_key(path); }

  ActorGruEncoder() = default;
  ActorGruEncoder(Index nfeats, Index classes, Index width, Index layers, bool time, Rng auto& rng)
      : feats_embedding(nfeats + classes + (time ? 1 : 0), width, rng),
        gru(width, width, layers, rng),
        mu(width, width, rng),
        var(width, width, rng),
        concatenate_time(time) {}

  /// Throws shape_error 203 for a label that is not a class or a motion without frames.
  LatentGaussian<B> operator()(const Sequences<B>& x, std::span<const Index> labels) const {
    const ModuleScope scope(*this);
    const Index classes = feats_embedding.in() - x.width() - (concatenate_time ? 1 : 0);
    const auto side = detail::action_and_time<B>(labels, classes, x.offsets, concatenate_time);
    const auto last = last_row(gru(feats_embedding(x.with(concat(1, x.rows, side)))));
    return {mu(last), var(last)};
  }
};

///     frame t = V h_t,   h = GRU(W [z, one-hot y, time])
/// Source  thesis 3.3.2, table 3.4; ACTOR src/models/architectures/gru.py
template <Backend B>
struct ActorGruDecoder {
  Linear<B> feats_embedding;
  Gru<B> gru;
  Linear<B> final_layer;
  bool concatenate_time = true;

  static constexpr auto fields() {
    using M = ActorGruDecoder;
    return motionlang::fields("feats_embedding", &M::feats_embedding, "gru", &M::gru, "final_layer", &M::final_layer,
                              "concatenate_time", &M::concatenate_time);
  }
  static std::string official_key(const std::string& path) { return gru_key(path); }

  ActorGruDecoder() = default;
  ActorGruDecoder(Index nfeats, Index classes, Index width, Index layers, bool time, Rng auto& rng)
      : feats_embedding(width + classes + (time ? 1 : 0), width, rng),
        gru(width, width, layers, rng),
        final_layer(width, nfeats, rng),
        concatenate_time(time) {}

  Sequences<B> operator()(const Tensor<B, 2>& z, std::span<const Index> labels, const Offsets& lengths) const {
    const ModuleScope scope(*this);
    const Index classes = feats_embedding.in() - z.size(1) - (concatenate_time ? 1 : 0);
    const auto side = detail::action_and_time<B>(labels, classes, lengths, concatenate_time);
    return final_layer(gru(feats_embedding(Sequences<B>(concat(1, repeat_for_rows(z, lengths), side), lengths))));
  }
};

MOTIONLANG_NAMESPACE_END
