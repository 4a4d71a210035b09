// How the machine is used: the options that every command with a model has.
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
        .add_option("--threads", threads, "Threads; unless given, as many as the machine has or its container is given")
        ->check(in_range(1, 1024));
    command
        .add_option("--precision", precision,
                    "Of products: fp32, or bf16 (factors rounded to 8 bits, sums in float): up to several times faster "
                    "where the processor multiplies bfloat16; packed weights take half the memory; or bf16x3 (three "
                    "bfloat16 for a float, as exact as fp32): faster on few threads with AMX")
        ->check(CLI::IsMember({"fp32", "bf16", "bf16x3"}))
        ->capture_default_str();
  }
  /// Before a model is loaded.
  void apply() const {
    if (threads > 0) motionlang::set_thread_count(threads);
    motionlang::set_product_precision(motionlang::precision_named(precision).value());
  }
};

}  // namespace program
