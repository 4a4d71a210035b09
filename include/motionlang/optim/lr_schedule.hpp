// SPDX-License-Identifier: MIT
/// Learning rates over the steps of a training.
#pragma once

#include <algorithm>  // min
#include <cmath>      // cos
#include <numbers>    // pi

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Linear rise over `warmup` steps, then half a cosine from `peak` down to `floor` at step `total` (Loshchilov, Hutter
/// 2017).
struct WarmupCosine {
  double peak = 1e-4;
  double floor = 0;
  Index warmup = 0;
  Index total = 1;

  double operator()(Index step) const {
    if (step < warmup) return peak * static_cast<double>(step + 1) / static_cast<double>(warmup);
    const double progress =
        std::min(1.0, static_cast<double>(step - warmup) / static_cast<double>(std::max<Index>(1, total - warmup)));
    return floor + (peak - floor) * 0.5 * (1 + std::cos(std::numbers::pi * progress));
  }
};

/// The rate, divided by `factor` after every `every` steps.
struct StepDecay {
  double rate = 1e-4;
  double factor = 10;
  Index every = 1;

  double operator()(Index step) const {
    const Index times = step / std::max<Index>(1, every);
    return rate / std::pow(factor, static_cast<double>(times));
  }
};

MOTIONLANG_NAMESPACE_END
