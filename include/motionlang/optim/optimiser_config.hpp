// SPDX-License-Identifier: MIT
/// Hyperparameters of every training: those of the optimiser, and the times of validation.
#pragma once

#include <cmath>    // pow
#include <cstdint>  // seed
#include <string>   // schedule

#include <motionlang/core/fields.hpp>
#include <motionlang/core/require_value.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/optim/lr_schedule.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// AdamW. The defaults are those of TEMOS and TMR.
struct OptimiserConfig {
  double lr = 1e-4, beta1 = 0.9, beta2 = 0.999, eps = 1e-8, weight_decay = 0.01;
  double clip_norm = 0;               // largest gradient norm; 0: any
  double ema = 0;                     // rate of the running average that is used in the end; 0: the weights themselves
  std::string schedule = "constant";  // or "cosine", down to a fiftieth; "step", SINC's: a tenth after every 200 epochs
  Index warmup = 0;                   // steps
  Index batch = 32;
  Index epochs = 500;
  std::uint64_t seed = 1234;

  static constexpr auto fields() {
    using C = OptimiserConfig;
    return motionlang::fields("lr", &C::lr, "beta1", &C::beta1, "beta2", &C::beta2, "eps", &C::eps, "weight_decay",
                              &C::weight_decay, "clip_norm", &C::clip_norm, "ema", &C::ema, "schedule", &C::schedule,
                              "warmup", &C::warmup, "batch", &C::batch, "epochs", &C::epochs, "seed", &C::seed);
  }

  void require_sound() const {
    require_value("eps", eps, eps > 0, "a number above 0");
    for (const auto& [name, value] : {std::pair("beta1", beta1), {"beta2", beta2}, {"ema", ema}})
      require_value(name, value, value >= 0 && value < 1, "0 or more, and less than 1");
    for (const auto& [name, value] : {std::pair("lr", lr), {"weight_decay", weight_decay}, {"clip_norm", clip_norm}})
      require_value(name, value, value >= 0, "0 or more");
    for (const auto& [name, value] : {std::pair("batch", batch), {"epochs", epochs}})
      require_value(name, value, value >= 1, "1 or more");
    require_value("warmup", warmup, warmup >= 0, "0 or more");
  }
  AdamWConfig adamw() const {
    return {.lr = lr, .beta1 = beta1, .beta2 = beta2, .eps = eps, .weight_decay = weight_decay};
  }
  /// The rate of a step out of `total`. Throws config_error 103 for an unknown schedule.
  double rate(Index step, Index total) const {
    if (schedule == "cosine")
      return WarmupCosine{.peak = lr, .floor = lr * 0.02, .warmup = warmup, .total = total}(step);
    if (schedule == "step") {
      const Index tenths = step * epochs / total / 200;  // whole ones
      return lr * std::pow(0.1, static_cast<double>(tenths));
    }
    if (schedule != "constant")
      raise<config_error>(103, "optimiser.schedule '", schedule, "' is not constant, cosine or step");
    return step < warmup ? lr * static_cast<double>(step + 1) / static_cast<double>(warmup) : lr;
  }
};

struct ValidationConfig {
  Index every = 1;             // epochs; 0: never
  Index patience = 0;          // validations without improvement before training stops; 0: never
  bool keep_best = false;      // use the weights of the best validation, not the last
  std::string watch = "loss";  // the value that must improve; TMR: or "retrieval", the sum of the recalls

  static constexpr auto fields() {
    using C = ValidationConfig;
    return motionlang::fields("every", &C::every, "patience", &C::patience, "keep_best", &C::keep_best, "watch",
                              &C::watch);
  }
};

MOTIONLANG_NAMESPACE_END
