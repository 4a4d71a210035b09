// SPDX-License-Identifier: MIT
/// TEMOS from one folder: one that train-temos wrote, or the run folder of the published one (.hydra/config.yaml,
/// checkpoints/last.ckpt).
///
///     const auto temos = load_temos<B>("kit-amass-xyz/5xp9647f", {.text_encoder = "distilbert-base-uncased",
///                                                                 .statistics = "deps/.../kit-amass-xyz"});
///
/// Source  Petrovich et al. (ECCV 2022); thesis, chapter 4
#pragma once

#include <motionlang/weights/text_motion_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
using TemosCheckpoint = TextMotionCheckpoint<B, Temos<B>>;

/// Throws  io_error 401 for a missing file, 403 to 407 for files and tensors; config_error 102 for a model of another
///         system and if options and tensors differ, 101, 103, 107
template <Backend B>
TemosCheckpoint<B> load_temos(const FilePath& path, const CheckpointOptions& options = {}) {
  const std::filesystem::path folder = found_model_folder(path);
  if (const RunFolder run = find_run(folder); run.system != "motionlang")
    return detail::checkpoint_of<B>(load_temos_run<B>(run, {options.text_encoder, options.statistics}), folder,
                                    options);
  const TextMotionFile file = read_text_motion_config(folder);
  return detail::checkpoint_of<B>(load_text_motion<Temos, B>(folder, file), file, file.config.data.max_seconds, folder,
                                  options);
}

MOTIONLANG_NAMESPACE_END
