// SPDX-License-Identifier: MIT
/// The system of a model: of a folder or a file that was trained here, or of a published folder.
#pragma once

#include <string>  // names

#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct ModelSystem {
  std::string name;   // "stmc", "tmr", "classifier", ...; "": a folder of an unknown system
  bool ours = false;  // it was trained here

  /// True if its motions are those of a diffusion model of texts, so that timelines are measured.
  bool is_diffusion() const;
};
/// A .safetensors file, alone or in a folder without a config.json, is an STMC of ours. Throws what find_run and
/// read_model_folder throw.
ModelSystem model_system(const FilePath& model);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/model_system.ipp>
#endif
