// What a model folder tells about how it was made, and writing one over another.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/module_file.hpp>

namespace program {

namespace ml = motionlang;

/// A model with licence and provenance from `about`, and the rest of it as the member "about".
inline ml::ModelFolder described_model(const std::string& system, std::map<std::string, std::string> about) {
  ml::ModelFolder model;
  model.system = system, model.license = about["license"], model.provenance = about["provenance"];
  about.erase("license"), about.erase("provenance");
  model.others["about"] = about;
  return model;
}

/// The last training of a folder is the one that counts: weights first, so that a config.json always has its weights.
inline void overwrite_model(const std::filesystem::path& folder, const ml::ModelFolder& model,
                            const ml::TensorStore& weights) {
  const std::string config = ml::model_config_text(model, (folder / "config.json").string());
  std::filesystem::create_directories(folder);
  ml::write_safetensors(folder / "weights.safetensors", weights.views(), {{"format", "motionlang"}});
  ml::write_file(folder / "config.json", std::string_view(config));
}

}  // namespace program
