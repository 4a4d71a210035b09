// SPDX-License-Identifier: MIT
/// Described motions of random numbers, for tests of trainings.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/datasets/described_motions.hpp>

/// Motions "m0", "m1", ... at 20 frames per second. The first `training` ones are to train on, the others to validate.
/// frames_of(i)         frames of motion i
/// texts_of(i, frames)  its texts
template <class Frames, class Texts>
motionlang::DescribedMotions motions_of_noise(motionlang::Index width, int training, int all, Frames frames_of,
                                              Texts texts_of) {
  motionlang::DescribedMotions out{width, 20, {}, {}, {}};
  for (int i = 0; i < all; ++i) {
    auto rng = motionlang::Philox{.seed = 5}.split(static_cast<std::uint64_t>(i));
    const motionlang::Index frames = frames_of(i);
    motionlang::DescribedMotion m{"m" + std::to_string(i), "m" + std::to_string(i), {}, {}};
    m.rows.resize(static_cast<std::size_t>(frames * width));
    rng.normal(std::span<float>(m.rows));
    m.texts = texts_of(i, frames);
    (i < training ? out.training : out.validation).push_back(std::move(m));
  }
  return out;
}
