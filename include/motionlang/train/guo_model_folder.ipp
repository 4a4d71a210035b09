// SPDX-License-Identifier: MIT
// Bodies of guo_model_folder.hpp.
#pragma once

#include <motionlang/train/guo_model_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void write_guo_config(const std::filesystem::path& folder, const std::string& system,
                                      const GuoTrainingConfig& config, double fps,
                                      const std::map<std::string, std::string>& about) {
  auto model = described_model(system, about);
  model.features = config.features;
  model.fps = fps;
  model.text_encoder = system == "guo evaluator" ? "glove" : "";
  model.others["training"] = config_json(config);
  const std::filesystem::path file = folder / "config.json";
  const std::string text = model_config_text(model, file.string());
  std::filesystem::create_directories(folder);
  write_file(file, std::string_view(text));
}

MOTIONLANG_BODY std::filesystem::path guo_meta_near(const std::filesystem::path& checkpoint) {
  const auto folder = std::filesystem::absolute(checkpoint).parent_path();
  for (const auto& place : {folder / "meta", folder.parent_path() / "meta"}) {
    if (std::filesystem::exists(place / "mean.npy")) return place;
  }
  return {};
}

}  // namespace detail

MOTIONLANG_BODY std::optional<DataConfig> data_config_of(const std::filesystem::path& model) {
  const auto file = (std::filesystem::is_directory(model) ? model : model.parent_path()) / "config.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const auto document = read_json(file);
  for (const char* place : {"training", "config"}) {
    if (!document.is_object() || !document.contains(place)) continue;
    const auto& settings = document.at(place);
    if (!settings.is_object() || !settings.contains("data") || !settings.at("data").contains("mirror")) continue;
    DataConfig out;
    read_config(out, JsonView(document, file.string())[place]["data"]);
    out.mirror = false;
    return out;
  }
  return std::nullopt;
}

MOTIONLANG_NAMESPACE_END
