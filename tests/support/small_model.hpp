// SPDX-License-Identifier: MIT
/// A small STMC model with drawn weights, and timelines for it: every system test runs in milliseconds.
#pragma once

#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/weights/stmc_file.hpp>

namespace small {

namespace ml = motionlang;
using ml::Index;

inline ml::StmcModelConfig config(Index diffusion_steps = 8) {
  return {.denoiser = {.tx_dim = 12, .latent_dim = 32, .ff_size = 48, .num_layers = 2, .num_heads = 4},
          .text = {.width = 16, .heads = 2, .d_ff = 24, .layers = 1, .out = 12},
          .diffusion_steps = diffusion_steps};
}

inline ml::WordPiece tokenizer() {
  const std::vector<std::string> captions{"walk forward", "raise both arms", "sit down", "wave the right hand"};
  return ml::WordPiece::learn(captions, 60);
}

/// The weights depend on the seed only; mean and deviation of the features are drawn as well.
template <ml::Backend B>
ml::Stmc<B> model(const ml::StmcModelConfig& c = config(), std::uint64_t seed = 1) {
  ml::Philox rng{.seed = seed};
  auto m = ml::make_stmc<B>(c, tokenizer(), rng);
  auto statistics = rng.split("statistics");
  m.motion_normalizer.mean = ml::normal_init<B, 1>({c.denoiser.nfeats}, 1, statistics);
  m.motion_normalizer.std = ml::uniform_init<B, 1>({c.denoiser.nfeats}, 0.5, statistics) + 1.0;
  return m;
}

/// Three tracks, a cut, a stretch in which one text moves everything.
inline ml::Timeline several_tracks() {
  return ml::parse_timeline(
      "walk forward # 0 # 2 # legs\n"
      "raise both arms # 0.5 # 1.5 # left arm # right arm\n"
      "sit down # 2 # 3.5 # legs # spine\n"
      "wave the right hand # 2.5 # 3 # right arm\n");
}
inline ml::Timeline one_track() { return ml::parse_timeline("walk forward # 0 # 1.5\nsit down # 1.5 # 2\n"); }
inline ml::Timeline one_text(Index frames = 30) { return {{{"wave the right hand", 0, frames, ml::BodyParts::all()}}}; }

template <ml::Backend B, int R>
std::vector<typename B::scalar> numbers(const ml::Tensor<B, R>& t) {
  return {t.span().begin(), t.span().end()};
}
template <ml::Backend B, int R>
bool is_finite(const ml::Tensor<B, R>& t) {
  return std::all_of(t.span().begin(), t.span().end(), [](auto x) { return std::isfinite(x); });
}

}  // namespace small
