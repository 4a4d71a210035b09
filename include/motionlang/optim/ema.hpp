// SPDX-License-Identifier: MIT
/// Exponential moving average of the parameters: the model that is saved and sampled from.
#pragma once

#include <algorithm>  // min

#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     e = rate e + (1 - rate) p
/// `rate` grows from 0.1 as min(rate, (1 + k) / (10 + k)), so that the initial values do not slow down the first
/// updates. Source  Polyak and Juditsky (1992); the warm-up is that of common diffusion code. Throws shape_error 204 if
/// the two differ in structure.
template <Module Average, Module Model>
void update_ema(Average& average, const Model& model, double rate, Index step) {
  using B = module_backend<Average>;
  using S = typename B::scalar;
  const double k = static_cast<double>(step), r = std::min(rate, (1 + k) / (10 + k));
  zip_tensors(average, model, [&](const auto& e, const auto& p) {
    if (e.shape() != p.shape())
      raise<shape_error>(204, "update_ema: '", e.path, "' is ", e.shape(), ", the model has ", p.shape());
    const auto before = e.span();
    std::vector<S> values(before.begin(), before.end());
    const auto now = p.span();
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<S>(r * static_cast<double>(values[i]) + (1 - r) * static_cast<double>(now[i]));
    *e.data = B::from_span(values, e.shape());
  });
}

MOTIONLANG_NAMESPACE_END
