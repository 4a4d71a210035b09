// SPDX-License-Identifier: MIT
/// TEMOS and TMR small enough for tests, and a batch for them.
#pragma once

#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>

#include "tensors.hpp"

namespace small_text_motion {

namespace ml = motionlang;

inline constexpr ml::TemosConfig temos_config{
    .nfeats = 64, .text_dim = 5, .latent_dim = 8, .ff_size = 12, .num_layers = 2, .num_heads = 2, .max_len = 32};
inline constexpr ml::TmrConfig tmr_config{.motion_nfeats = 263,
                                          .text_nfeats = 5,
                                          .latent_dim = 8,
                                          .ff_size = 12,
                                          .num_layers = 2,
                                          .num_heads = 2,
                                          .max_len = 32};

template <ml::Backend B>
ml::Temos<B> temos(const ml::TemosConfig& c = temos_config, std::uint64_t seed = 1) {
  ml::Philox rng{.seed = seed};
  return {c, rng};
}
template <ml::Backend B>
ml::Tmr<B> tmr(const ml::TmrConfig& c = tmr_config, std::uint64_t seed = 1) {
  ml::Philox rng{.seed = seed};
  return {c, rng};
}

/// Three texts of 2, 4 and 1 tokens, three motions of 5, 1 and 3 frames.
template <ml::Backend B>
ml::Sequences<B> texts(ml::Index width = 5) {
  return {tensors::normal<B, 2>({7, width}, 20), ml::Offsets{2, 4, 1}};
}
template <ml::Backend B>
ml::Sequences<B> motions(ml::Index width) {
  return {tensors::normal<B, 2>({9, width}, 21), ml::Offsets{5, 1, 3}};
}

}  // namespace small_text_motion
