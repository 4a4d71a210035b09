// SPDX-License-Identifier: MIT
// Bodies of vae_run.hpp.
#pragma once

#include <motionlang/weights/vae_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_checkpoint(const RunFolder& run, const char* system, const char* wanted) {
  if (run.system != system)
    raise<io_error>(404, run.folder.string(), ": ", run.system.empty() ? "of no known system" : "of " + run.system,
                    ", expected ", system);
  if (run.weights.empty()) raise<io_error>(401, run.folder.string(), ": no ", wanted);
}

MOTIONLANG_BODY std::filesystem::path temos_text_folder(const RunFolder& run, const TemosRunOptions& options) {
  std::filesystem::path folder = options.text_encoder.string();
  for (const auto& near : {run.folder, folder_around(run.folder)}) {
    for (const char* name : {"", "text_encoder", "distilbert-base-uncased"}) {
      const bool found = file_exists(near / name / "tokenizer.json") || file_exists(near / name / "vocab.txt");
      if (folder.empty() && found) folder = near / name;
    }
  }
  if (folder.empty())
    raise<io_error>(401, run.folder.string(),
                    ": no tokenizer of DistilBERT: put vocab.txt or tokenizer.json of "
                    "distilbert-base-uncased there, or name its folder");
  return folder;
}

}  // namespace detail

MOTIONLANG_BODY std::string lightning_system(const TensorSet& weights) {
  if (weights.find("textencoder.seperation_token") != nullptr) return "teach";  // as published
  return weights.find("textencoder.separation_token") != nullptr ? "sinc" : "temos";
}

MOTIONLANG_BODY std::string system_of_run(const FilePath& folder) {
  const RunFolder run = find_run(folder);
  if (run.system != "temos" || run.weights.empty()) return run.system;
  return lightning_system(open_weights(run.weights));
}

namespace detail {

MOTIONLANG_BODY WeightFile lightning_weights(const RunFolder& run, const char* system) {
  require_checkpoint(run, "temos", "checkpoints/last.ckpt");
  WeightFile weights = open_weights(run.weights);
  if (const std::string found = lightning_system(weights); found != system)
    raise<io_error>(404, weights.name(), ": a checkpoint of ", found, ", expected ", system);
  return weights;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
