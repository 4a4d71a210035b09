// SPDX-License-Identifier: MIT
// Bodies of schedule.hpp.
#pragma once

#include <algorithm>  // min, max
#include <cmath>      // cos, sqrt, pow
#include <numbers>    // pi

#include <motionlang/diffusion/schedule.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double LinearSchedule::beta(Index t) const {
  const double c = scale_betas * 1000 / static_cast<double>(steps), low = c * 0.0001, high = c * 0.02;
  return steps == 1 ? low : low + (high - low) * static_cast<double>(t) / static_cast<double>(steps - 1);
}

MOTIONLANG_BODY double ScaledLinearSchedule::beta(Index t) const {
  const double a = std::sqrt(b0), b = std::sqrt(b1);
  const double r = steps == 1 ? a : a + (b - a) * static_cast<double>(t) / static_cast<double>(steps - 1);
  return r * r;
}

MOTIONLANG_BODY double CosineSchedule::beta(Index t) const {
  auto f = [&](double u) {
    const double c = std::cos((u + s) / (1 + s) * std::numbers::pi / 2);
    return c * c;
  };
  const double n = static_cast<double>(steps), i = static_cast<double>(t);
  return std::min(1 - f((i + 1) / n) / f(i / n), 0.999);
}

MOTIONLANG_BODY double ChenCosineSchedule::alpha_bar(double u) const {
  auto v = [&](double x) { return std::pow(std::cos((x * (end - start) + start) * std::numbers::pi / 2), 2 * tau); };
  return std::clamp((v(1) - v(u)) / (v(1) - v(0)), clip_min, 1.0);
}

MOTIONLANG_BODY double ChenCosineSchedule::beta(Index t) const {
  const double n = static_cast<double>(steps), i = static_cast<double>(t);
  return std::min(1 - alpha_bar((i + 1) / n) / alpha_bar(i / n), 0.999);
}

MOTIONLANG_NAMESPACE_END
