// SPDX-License-Identifier: MIT
// Bodies of pack_run.hpp.
#pragma once

#include <motionlang/weights/pack_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool is_of_a_model(const std::string& name) {
  return !begins_with_any(name, {"rotation2xyz.", "rot2xyz.", "clip_model.", "_losses.", "losses.", "metrics.",
                                 "eval_model.", "opt_", "motion_normalizer."});
}

MOTIONLANG_BODY void write_packed(const FilePath& path, const RunFolder& run, PackedFiles& parts,
                                  std::vector<TensorView> tensors, const PackOptions& options) {
  parts.model.license = options.license;
  parts.model.provenance = options.provenance;
  parts.model.others["published"] = true;
  for (const FileValue& v : run.options) {  // "model/latent_dim": the reader makes the same path of it
    const auto* text = std::get_if<std::string>(&v.value);
    if (is_utf8(v.path) && (text == nullptr || is_utf8(*text)))
      std::visit([&](const auto& x) { parts.model.config[v.path] = x; }, v.value);
  }
  for (const WeightFile& file : parts.weights) {
    for (const TensorView& t : file.tensors()) {
      if (is_of_a_model(t.name)) tensors.push_back(t);
    }
  }
  write_model_folder(path, parts.model, tensors, parts.text_encoder);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
