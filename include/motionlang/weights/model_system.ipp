// SPDX-License-Identifier: MIT
// Bodies of model_system.hpp.
#pragma once

#include <algorithm>   // any_of
#include <filesystem>  // folders

#include <motionlang/weights/known_systems.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/model_system.hpp>
#include <motionlang/weights/vae_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool ModelSystem::is_diffusion() const { return is_diffusion_system(name); }

MOTIONLANG_BODY ModelSystem model_system(const FilePath& model) {
  namespace fs = std::filesystem;
  const fs::path folder = model.string();
  if (!fs::is_directory(folder)) return {"stmc", true};
  const std::string found = system_of_run(model);
  if (!found.empty() && found != "motionlang") return {found, false};
  const auto is_weights = [](const auto& entry) { return entry.path().extension() == ".safetensors"; };
  if (!fs::exists(folder / "config.json") &&
      std::any_of(fs::directory_iterator(folder), fs::directory_iterator(), is_weights))
    return {"stmc", true};
  return {read_model_folder(model).system, true};
}

MOTIONLANG_NAMESPACE_END
