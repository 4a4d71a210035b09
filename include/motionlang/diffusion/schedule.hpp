// SPDX-License-Identifier: MIT
/// Noise schedules: the amount of noise that step t adds.
#pragma once

#include <vector>  // lists of betas

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A forward process q(x_t | x_{t-1}) = N(sqrt(1 - beta_t) x_{t-1}, beta_t I), t = 0 ... steps-1 (thesis eq. 6.1).
/// Minimum   steps, beta(t)
/// Deduced   everything in gaussian.hpp
/// Laws      0 < beta(t) <= 1 (checked where the tables are built)
/// Models    LinearSchedule, ScaledLinearSchedule, CosineSchedule, ChenCosineSchedule, BetaList
template <class S>
concept Schedule = requires(const S& s, Index t) {
  { s.steps } -> std::convertible_to<Index>;
  { s.beta(t) } -> std::convertible_to<double>;
};

/// Ho et al. (2020), rescaled so that any number of steps ends in the same noise:
///     beta_t from 0.0001 c to 0.02 c, c = scale_betas 1000 / steps
struct LinearSchedule {
  Index steps = 1000;
  double scale_betas = 1;

  double beta(Index t) const;
};

/// Linear in the square root, as in latent diffusion.
struct ScaledLinearSchedule {
  Index steps = 1000;
  double b0 = 0.00085, b1 = 0.012;

  double beta(Index t) const;
};

/// Nichol and Dhariwal (2021), eq. 17. The schedule of MDM and, with 100 steps, of STMC (the thesis cites Chen 2023,
/// but the released code has this one):
///     f(u) = cos((u + s) / (1 + s) pi / 2)^2,   beta_t = min(1 - f((t + 1) / steps) / f(t / steps), 0.999)
struct CosineSchedule {
  Index steps = 100;
  double s = 0.008;

  double beta(Index t) const;
};

/// Chen (2023), which the thesis cites; no published checkpoint uses it.
///     v(u) = cos((u (end - start) + start) pi / 2)^(2 tau)
///     alpha_bar(u) = clip((v(1) - v(u)) / (v(1) - v(0)), clip_min, 1)
struct ChenCosineSchedule {
  Index steps = 100;
  double start = 0, end = 1, tau = 1, clip_min = 1e-9;

  double alpha_bar(double u) const;
  double beta(Index t) const;
};

/// Any list, for example the betas of a respaced process.
struct BetaList {
  std::vector<double> betas;
  Index steps = static_cast<Index>(betas.size());

  double beta(Index t) const { return betas[static_cast<std::size_t>(t)]; }
};

static_assert(Schedule<LinearSchedule> && Schedule<ScaledLinearSchedule> && Schedule<CosineSchedule> &&
              Schedule<ChenCosineSchedule> && Schedule<BetaList>);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/diffusion/schedule.ipp>
#endif
