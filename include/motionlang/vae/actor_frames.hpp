// SPDX-License-Identifier: MIT
/// A VAE with one latent for every frame, which ACTOR is compared with (thesis table 3.7): the kind of Action2Motion.
#pragma once

#include <vector>  // states

#include <motionlang/vae/actor_gru.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The distribution of a frame's latent, from frames up to it.
template <Backend B>
struct ActorFrameGaussian {
  Linear<B> embed;
  Gru<B> gru;
  Linear<B> mu, logvar;

  static constexpr auto fields() {
    using M = ActorFrameGaussian;
    return motionlang::fields("embed", &M::embed, "gru", &M::gru, "mu", &M::mu, "logvar", &M::logvar);
  }
  ActorFrameGaussian() = default;
  ActorFrameGaussian(Index in, Index hidden, Index latent, Rng auto& rng)
      : embed(in, hidden, rng), gru(hidden, hidden, 1, rng), mu(hidden, latent, rng), logvar(hidden, latent, rng) {}

  LatentGaussian<B> operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    const auto h = gru(embed(x)).rows;
    return {mu(h), logvar(h)};
  }
};

///     posterior of z_t = GRU(W [frame t, one-hot y, time]),   prior of z_t = GRU(W [frame t - 1, one-hot y, time])
///     frame t = V GRU(W [frame t - 1, one-hot y, time, z_t])
/// Training reads the true frames, generation those that it made. The KL divergence is that of the posterior from the
/// prior.
/// Source   thesis 2.2.1 and 3.3.3: Action2Motion is a VAE of frames, conditioned on actions, with GRUs
/// Differs  Action2Motion also has losses of a Lie algebra, and trains with some of its own frames. The thesis gives no
///          formulas for them
template <Backend B>
struct ActorFrames {
  ActorFrameGaussian<B> posterior, prior;
  Linear<B> embed;
  Gru<B> gru;
  Linear<B> final_layer;

  static constexpr auto fields() {
    using M = ActorFrames;
    return motionlang::fields("posterior", &M::posterior, "prior", &M::prior, "embed", &M::embed, "gru", &M::gru,
                              "final_layer", &M::final_layer);
  }
  static std::string official_key(const std::string& path) { return gru_key(path); }

  ActorFrames() = default;
  /// hidden: width of the GRUs;  layers: of the GRU that writes frames
  ActorFrames(Index nfeats, Index classes, Index latent, Index hidden, Index layers, Rng auto& rng)
      : posterior(nfeats + classes + 1, hidden, latent, rng),
        prior(nfeats + classes + 1, hidden, latent, rng),
        embed(nfeats + classes + 1 + latent, hidden, rng),
        gru(hidden, hidden, layers, rng),
        final_layer(hidden, nfeats, rng) {}

  Index width() const { return final_layer.out(); }
  Index latent_dim() const { return prior.mu.out(); }

  /// A latent for every frame, (frames, latent). Throws shape_error 203 for a label that is not a class.
  LatentGaussian<B> encode(const Sequences<B>& x, std::span<const Index> labels) const {
    const ModuleScope scope(*this);
    return posterior(x.with(concat(1, x.rows, side(labels, x.offsets))));
  }
  /// The prior of each latent, before its frame is seen, (frames, latent).
  LatentGaussian<B> expect(const Sequences<B>& x, std::span<const Index> labels) const {
    const ModuleScope scope(*this);
    return prior(known_before(labels, x));
  }
  /// Frames from the true ones before them. z: (frames, latent).
  Sequences<B> teach(const Tensor<B, 2>& z, std::span<const Index> labels, const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    const auto seen = known_before(labels, x);
    return final_layer(gru(embed(seen.with(concat(1, seen.rows, z)))));
  }
  /// Frames from those that were made before them. z: (frames, latent).
  Sequences<B> decode(const Tensor<B, 2>& z, std::span<const Index> labels, const Offsets& lengths) const {
    return written(z, labels, lengths, [](const Tensor<B, 2>&, const Tensor<B, 2>& given) { return given; });
  }
  /// The same with latents of the prior. noise: standard normal values (frames, latent).
  Sequences<B> generate(const Tensor<B, 2>& noise, std::span<const Index> labels, const Offsets& lengths) const {
    auto states = zero_states(prior.gru, lengths.count());
    return written(noise, labels, lengths, [&](const Tensor<B, 2>& seen, const Tensor<B, 2>& eps) {
      const auto h = gru_step<B>(prior.gru.layers, prior.embed(seen), states);
      return LatentGaussian<B>{prior.mu(h), prior.logvar(h)}.sample(eps);
    });
  }

 private:
  /// The states of a stack before the first frame.
  static std::vector<Tensor<B, 2>> zero_states(const Gru<B>& stack, Index motions) {
    std::vector<Tensor<B, 2>> out;
    for (const GruLayer<B>& layer : stack.layers) out.push_back(Tensor<B, 2>::zeros({motions, layer.hidden()}));
    return out;
  }
  /// Rows of what is known before each frame: the last frame, the action and the time. The prior reads them.
  Sequences<B> known_before(std::span<const Index> labels, const Sequences<B>& x) const {
    const auto before = detail::frames_before(x);
    return before.with(concat(1, before.rows, side(labels, x.offsets)));
  }
  Tensor<B, 2> side(std::span<const Index> labels, const Offsets& lengths) const {
    return detail::action_and_time<B>(labels, prior.embed.in() - width() - 1, lengths, true);
  }
  /// latents(seen, given): those of the next frames, from what the prior reads and from rows of `given`.
  template <class Latents>
  Sequences<B> written(const Tensor<B, 2>& given, std::span<const Index> labels, const Offsets& lengths,
                       Latents latents) const {
    const ModuleScope scope(*this);
    if (given.shape() != Shape{lengths.rows(), latent_dim()})
      raise<shape_error>(204, "ActorFrames: latents ", given.shape(), " for ", counted(lengths.rows(), "frame"),
                         ", expected ", latent_dim(), " values each");
    const Sequences<B> about(concat(1, side(labels, lengths), given), lengths);
    const detail::TimeSteps<B> time(about);
    auto states = zero_states(gru, lengths.count());
    std::vector<Tensor<B, 2>> frames;
    for (const auto& now : time.steps) {
      const Index motions = now.size(0), known = now.size(1) - latent_dim();
      const auto last = frames.empty() ? Tensor<B, 2>::zeros({motions, width()}) : slice(frames.back(), 0, 0, motions);
      const auto seen = concat(1, last, slice(now, 1, 0, known));
      const auto z = latents(seen, slice(now, 1, known, now.size(1)));
      frames.push_back(final_layer(gru_step<B>(gru.layers, embed(concat(1, seen, z)), states)));
    }
    return {frames.empty() ? Tensor<B, 2>::zeros({0, width()}) : time.packed(frames), lengths};
  }
};

MOTIONLANG_NAMESPACE_END
