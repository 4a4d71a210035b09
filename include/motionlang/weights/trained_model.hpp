// SPDX-License-Identifier: MIT
/// The folder of a model that was trained here: weights/model_folder.hpp, with a record of its training.
#pragma once

#include <filesystem>  // folders
#include <map>         // the record
#include <string>      // systems

#include <motionlang/text/word_vectors.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/module_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A model with licence and provenance from `about`, and the other entries as the member "about".
ModelFolder described_model(const std::string& system, std::map<std::string, std::string> about);

/// Vectors of words beside the weights: weights/word_vector_file.hpp, with `prefix` before the names of their tensors.
struct ModelWordVectors {
  const WordVectors& vectors;
  std::string prefix;
};

/// Writes config.json and weights.safetensors over the existing ones. The weights are written first, so that a
/// config.json always has its weights. Throws io_error 401, and what model_config_text throws.
/// words  null: none
void overwrite_model(const std::filesystem::path& folder, const ModelFolder& model, const TensorStore& weights,
                     const ModelWordVectors* words = nullptr);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/trained_model.ipp>
#endif
