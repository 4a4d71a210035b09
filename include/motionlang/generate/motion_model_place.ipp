// SPDX-License-Identifier: MIT
// Bodies of motion_model_place.hpp.
#pragma once

#include <motionlang/generate/generate_options.hpp>
#include <motionlang/generate/motion_model_place.hpp>
#include <motionlang/weights/known_systems.hpp>
#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/vae_run.hpp>
#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The system of a folder; "" for a folder with nothing but a file of ours.
inline std::string generating_system(const RunFolder& run) {
  if (is_mdm_action_run(run)) return "mdm of actions";
  if (run.system == "temos") return system_of_run(run.folder);
  const FileValue* system = run.system == "motionlang" ? run.option("system") : nullptr;
  const std::string own = system == nullptr ? "" : to_string(*system);
  const KnownSystem* const known = known_system(own);
  return known != nullptr && known->trained_generates ? "trained " + own : run.system;
}

}  // namespace detail

MOTIONLANG_BODY bool MotionModelPlace::is_diffusion() const {
  const KnownSystem* const known = known_system(system);
  return !is_trained() && system != "mdm of actions" && (known == nullptr || known->diffusion);
}

MOTIONLANG_BODY MotionModelPlace find_motion_model(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path, ""};
  const RunFolder run = find_model_run(path);
  return {run.folder, detail::generating_system(run)};
}

MOTIONLANG_BODY void require_no_sources(const MotionModelPlace& place, const ModelSources& sources) {
  if (!sources.empty())
    raise<option_error>(
        102, place.path.string(),
        ": `text_encoder`, `statistics` and `tokenizer` are for published models; this one has its own");
}

MOTIONLANG_NAMESPACE_END
