// SPDX-License-Identifier: MIT
// Bodies of epoch_task.hpp.
#pragma once

#include <motionlang/train/epoch_task.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::map<std::string, std::string> task_settings(const std::string& system, std::size_t motions,
                                                                 const std::map<std::string, std::string>& config) {
  std::map<std::string, std::string> out{{"model", system + " training"}, {"data.motions", std::to_string(motions)}};
  for (const auto& [name, value] : config) {
    if (name == "optimiser.epochs" || name.starts_with("validation.")) continue;
    const bool free = name.starts_with("optimiser.") || name.starts_with("losses.");
    out[free ? "training." + name : name] = value;
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
