// The subcommands that need a build with training, and the message about them in a build without.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace program {

inline constexpr std::array<std::string_view, 13> training_commands{
    "train-tmr",           "train-temos",       "train-sinc",      "train-teach",    "train-tm2t",
    "train-actor",         "train-classifier",  "train-evaluator", "train-mdm-smpl", "train-mdm",
    "train-motiondiffuse", "train-mdm-actions", "evaluate"};
inline constexpr const char* build_with_training =
    "cmake --preset release -DMOTIONLANG_TRAINING=ON && cmake --build build/release --target motionlang_program";

/// The message for a subcommand that this program lacks.
inline std::string no_subcommand(const std::string& name) {
  if (std::ranges::find(training_commands, name) == training_commands.end())
    return "there is no subcommand '" + name + "'";
  return "'" + name +
         "' needs a program that is built with training; in the folder of motionlang: " + build_with_training;
}

}  // namespace program
