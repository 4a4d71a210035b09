// SPDX-License-Identifier: MIT
// Bodies of trained_model.hpp.
#pragma once

#include <motionlang/weights/trained_model.hpp>
#include <motionlang/weights/word_vector_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY ModelFolder described_model(const std::string& system, std::map<std::string, std::string> about) {
  ModelFolder model;
  model.system = system, model.license = about["license"], model.provenance = about["provenance"];
  about.erase("license"), about.erase("provenance");
  model.others["about"] = about;
  return model;
}

MOTIONLANG_BODY void overwrite_model(const std::filesystem::path& folder, const ModelFolder& model,
                                     const TensorStore& weights, const ModelWordVectors* words) {
  const std::string config = model_config_text(model, (folder / "config.json").string());
  std::filesystem::create_directories(folder);
  auto tensors = weights.views();
  std::map<std::string, std::string> metadata{{"format", "motionlang"}};
  if (words != nullptr) store_word_vectors(tensors, metadata, words->vectors, words->prefix);
  write_safetensors(folder / "weights.safetensors", tensors, metadata);
  write_file(folder / "config.json", std::string_view(config));
}

MOTIONLANG_NAMESPACE_END
