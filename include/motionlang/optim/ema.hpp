// SPDX-License-Identifier: MIT
/// Exponential moving average of the parameters: the model that is saved and sampled from.
#pragma once

#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     e = rate e + (1 - rate) p
/// `rate` grows from 0.1 as min(rate, (1 + k) / (10 + k)), so that the first updates are not held back by the initial
/// values. Source  Polyak and Juditsky (1992); the warm-up is the one of common diffusion code.
template <Module Average, Module Model>
void update_ema(Average& average, const Model& model, double rate, Index step) {
  const double k = static_cast<double>(step), r = std::min(rate, (1 + k) / (10 + k));
  zip(average, model, [&](const std::string&, auto& e, const auto& p) {
    using T = std::remove_cvref_t<decltype(e)>;
    if constexpr (is_tensor<T>) {
      using S = typename T::scalar;
      std::vector<S> values = e.to_vector();
      const auto now = p.span();
      for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<S>(r * static_cast<double>(values[i]) + (1 - r) * static_cast<double>(now[i]));
      }
      e = T::from(values, e.shape());
    }
  });
}

MOTIONLANG_NAMESPACE_END
