// SPDX-License-Identifier: MIT
/// A VAE with one latent for every frame, which ACTOR is compared with (thesis table 3.7): the kind of Action2Motion.
#pragma once

#include <vector>  // states

#include <motionlang/vae/actor_gru.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A stack of GRU layers that is run one frame at a time.
template <Backend B>
class GruSteps {
 public:
  explicit GruSteps(const Gru<B>& gru) : gru_(gru) {}

  /// The next frame of each motion, (motions, in). Motions that have ended are missing at the end.
  Tensor<B, 2> operator()(Tensor<B, 2> x) {
    for (std::size_t i = 0; i < gru_.layers.size(); ++i) {
      const auto& layer = gru_.layers[i];
      if (states_.size() == i) states_.push_back(Tensor<B, 2>::zeros({x.size(0), layer.hidden()}));
      x = states_[i] = layer(std::vector<Tensor<B, 2>>{x}, states_[i]).front();
    }
    return x;
  }

 private:
  const Gru<B>& gru_;
  std::vector<Tensor<B, 2>> states_;
};

}  // namespace detail

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
    const auto before = detail::frames_before(x);
    return prior(before.with(concat(1, before.rows, side(labels, x.offsets))));
  }
  /// Frames from the true ones before them. z: (frames, latent).
  Sequences<B> teach(const Tensor<B, 2>& z, std::span<const Index> labels, const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    const auto before = detail::frames_before(x);
    return final_layer(gru(embed(before.with(concat(1, before.rows, side(labels, x.offsets), z)))));
  }
  /// Frames from those that were made before them. z: (frames, latent).
  Sequences<B> decode(const Tensor<B, 2>& z, std::span<const Index> labels, const Offsets& lengths) const {
    return written(z, labels, lengths, [](const Tensor<B, 2>&, const Tensor<B, 2>& given) { return given; });
  }
  /// The same with latents of the prior. noise: standard normal values (frames, latent).
  Sequences<B> generate(const Tensor<B, 2>& noise, std::span<const Index> labels, const Offsets& lengths) const {
    detail::GruSteps<B> expected(prior.gru);
    return written(noise, labels, lengths, [&](const Tensor<B, 2>& seen, const Tensor<B, 2>& eps) {
      const auto h = expected(prior.embed(seen));
      return LatentGaussian<B>{prior.mu(h), prior.logvar(h)}.sample(eps);
    });
  }

 private:
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
    detail::GruSteps<B> writer(gru);
    std::vector<Tensor<B, 2>> frames;
    for (const auto& now : time.steps) {
      const Index motions = now.size(0), known = now.size(1) - latent_dim();
      const auto last = frames.empty() ? Tensor<B, 2>::zeros({motions, width()}) : slice(frames.back(), 0, 0, motions);
      const auto seen = concat(1, last, slice(now, 1, 0, known));
      const auto z = latents(seen, slice(now, 1, known, now.size(1)));
      frames.push_back(final_layer(writer(embed(concat(1, seen, z)))));
    }
    return {frames.empty() ? Tensor<B, 2>::zeros({0, width()}) : time.packed(frames), lengths};
  }
};

MOTIONLANG_NAMESPACE_END
