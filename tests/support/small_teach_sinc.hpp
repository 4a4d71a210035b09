// SPDX-License-Identifier: MIT
/// TEACH and SINC small enough for tests, and batches for them.
#pragma once

#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>

#include "tensors.hpp"

namespace small_teach_sinc {

namespace ml = motionlang;
using ml::Offsets;

inline constexpr ml::TeachConfig teach_config{
    .text_dim = 5, .latent_dim = 8, .ff_size = 12, .num_layers = 2, .num_heads = 2, .hist_frames = 2, .max_len = 32};
inline constexpr ml::SincConfig sinc_config{
    .text_dim = 5, .latent_dim = 8, .ff_size = 12, .num_layers = 2, .num_heads = 2, .max_len = 32};

template <ml::Backend B>
ml::Teach<B> teach(const ml::TeachConfig& c = teach_config, std::uint64_t seed = 1) {
  ml::Philox rng{.seed = seed};
  return {c, rng};
}
template <ml::Backend B>
ml::Sinc<B> sinc(ml::SincMode mode = ml::SincMode::single, std::uint64_t seed = 1) {
  ml::Philox rng{.seed = seed};
  auto c = sinc_config;
  c.mode = mode;
  return {c, rng};
}

template <ml::Backend B>
ml::Sequences<B> sequences(const Offsets& lengths, ml::Index width, std::uint64_t seed) {
  return {tensors::normal<B, 2>({lengths.rows(), width}, seed), lengths};
}
/// Three pairs; the transitions have 1, 0 and 2 frames.
template <ml::Backend B>
ml::TeachPairs<B> pairs() {
  return {sequences<B>({2, 4, 1}, 5, 20), sequences<B>({3, 1, 2}, 5, 21), sequences<B>({5, 2, 3}, 135, 22),
          sequences<B>({3, 4, 6}, 135, 23), Offsets{1, 0, 2}};
}
/// Texts of three motions: two, one, two.
template <ml::Backend B>
ml::SincTexts<B> texts() {
  return {sequences<B>({4, 2, 3, 1, 4}, 5, 24), {0, 0, 1, 2, 2}, tensors::normal<B, 2>({5, 5}, 25)};
}

}  // namespace small_teach_sinc
