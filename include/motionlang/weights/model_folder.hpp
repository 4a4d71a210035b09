// SPDX-License-Identifier: MIT
/// Model folders of ours.
///
///     FOLDER/config.json            what the model is (below)
///     FOLDER/weights.safetensors    its tensors under their published names, and motion_normalizer.mean,
///                                   motion_normalizer.std
///     FOLDER/text_encoder/          if it has its own: in the form of Hugging Face or OpenAI
///     (weights/text_encoder_folder.hpp)
///
///     {"format": "motionlang", "version": 1, "system": "stmc",
///      "license": "MIT", "provenance": "trained on ...",
///      "features": "smplrifke", "fps": 20, "text_encoder": "clip",
///      "config": {...}}            hyperparameters under the names of the system's own options
///
/// The writer of a folder must state what the weights may be used for and where they come from. Other members are kept.
/// Atomicity  the folder appears under its name once it is complete
#pragma once

#include <filesystem>  // folders

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/file/safetensors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct ModelFolder {
  std::string system, license, provenance, features, text_encoder;
  double fps = 20;
  nlohmann::ordered_json config = nlohmann::ordered_json::object();
  // other members of config.json
  nlohmann::ordered_json others = nlohmann::ordered_json::object();
};

namespace detail {

inline constexpr const char *model_format = "motionlang", *model_config_file = "config.json",
                            *model_weights_file = "weights.safetensors";

}  // namespace detail

/// The contents of a config.json. Messages contain `name`.
/// Throws  io_error 403 if it is malformed, 404 for a newer version; config_error 103 for another format, 107 for a
///         member that is missing or of another kind, 101 for an impossible frame rate, always with both values
ModelFolder parse_model_config(std::string_view text, const std::string& name);

/// Throws io_error 401 if there is no config.json, and as parse_model_config.
ModelFolder read_model_folder(const FilePath& folder);

/// The text of config.json. Throws config_error 101 without a system, a licence or a provenance, 102 for invalid
/// `others`; io_error 403 for texts that are not UTF-8.
std::string model_config_text(const ModelFolder& m, const std::string& name = detail::model_config_file);

/// Writes a new folder, and copies text_encoder_files into its text_encoder/.
/// Throws io_error 401 if the folder exists or something cannot be written, and as model_config_text
void write_model_folder(const FilePath& path, const ModelFolder& model, std::span<const TensorView> tensors,
                        std::span<const std::filesystem::path> text_encoder_files = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/model_folder.ipp>
#endif
