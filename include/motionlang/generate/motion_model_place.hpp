// SPDX-License-Identifier: MIT
/// The place and the system of a model that makes motions, and its files elsewhere. Loads nothing.
///
///     const MotionModelPlace place = find_motion_model("exps/humanact12");       // place.system == "actor"
#pragma once

#include <filesystem>  // folders
#include <string>      // systems

#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Files outside the folder that published models need. By default ("") they are searched beside them.
struct ModelSources {
  std::string text_encoder{};  // a folder or a file
  std::string statistics{};    // a folder with mean and std
  std::string tokenizer{};     // TM2T: the folder of its motion tokenizer

  bool empty() const { return text_encoder.empty() && statistics.empty() && tokenizer.empty(); }
};

/// The place of a model, and its system.
struct MotionModelPlace {
  std::filesystem::path path{};  // a file of ours, or the folder of a model
  std::string system{};          // "": STMC of ours; of others that of the folder: "stmc", "mdm", "motiondiffuse",
                                 // "actor", "temos", "teach", "sinc", "tmr", "tm2t", "mdm of actions"; of our trainings
                                 // "trained actor", "trained temos", ...

  /// True if only a loader of `trained` models reads it.
  bool is_trained() const { return system == "tmr" || system.starts_with("trained "); }
  /// True if it goes through STMC, with any backend.
  bool is_diffusion() const;
};

/// Looks at a file or a folder. If a training's folder has the model inside, it takes that one. Throws io_error 401 for
/// a folder without a model, and what find_run throws.
MotionModelPlace find_motion_model(const std::filesystem::path& path);

/// Throws option_error 102 if `sources` name a file and the model has its own.
void require_no_sources(const MotionModelPlace& place, const ModelSources& sources);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/motion_model_place.ipp>
#endif
