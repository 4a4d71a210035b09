// The options for the use of the machine, which every command with a model has.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include <motionlang/backend/precision.hpp>
#include <motionlang/core/parallel.hpp>

#include "option_checks.hpp"

namespace program {

struct MachineOptions {
  int threads = 0;  // as many as the machine has
  std::string precision = "fp32";

  void add_to(CLI::App& command) {
    command
        .add_option("--threads", threads,
                    "Number of threads. The default is the number of processors of the machine or its container")
        ->check(in_range(1, 1024));
    checked_option(
        command, "--precision", precision, CLI::IsMember({"fp32", "bf16", "bf16x3"}),
        "Precision of matrix products. bf16 rounds factors to bfloat16 and sums in float; it is several times "
        "faster on processors that multiply bfloat16, and halves the memory of packed weights. bf16x3 uses "
        "three bfloat16 for a float, is as exact as fp32, and is faster on few threads with AMX");
  }
  /// Call it before a model is loaded.
  void apply() const {
    if (threads > 0) motionlang::set_thread_count(threads);
    motionlang::set_product_precision(motionlang::precision_named(precision).value());
  }
};

}  // namespace program
