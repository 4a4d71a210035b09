// SPDX-License-Identifier: MIT
/// SINC from one folder: one that train-sinc wrote, or the run folder of the published one (.hydra/config.yaml,
/// checkpoints/last.ckpt).
///
///     const auto sinc = load_sinc<B>("sinc-run", {.text_encoder = "distilbert", .statistics = "deps/..."});
///
/// Source  Athanasiou et al. (ICCV 2023); thesis, annex B
#pragma once

#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/text_motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
using SincCheckpoint = TextMotionCheckpoint<B, Sinc<B>>;

/// Throws  io_error 401 for a missing file, 403 to 407 for files and tensors; config_error 102 for a model of another
///         system and if options and tensors differ, 101, 103, 107
template <Backend B>
SincCheckpoint<B> load_sinc(const FilePath& path, const CheckpointOptions& options = {}) {
  const std::filesystem::path folder = found_model_folder(path);
  if (const RunFolder run = find_run(folder); run.system != "motionlang")
    return detail::checkpoint_of<B>(load_sinc_run<B>(run, {options.text_encoder, options.statistics}), folder, options);
  const auto file = read_babel_config<SincTrainingConfig>(folder);
  detail::require_trained(folder, file.system, "sinc");
  return detail::checkpoint_of<B>(load_text_motion<Sinc, B>(folder, file), file, file.config.longest_seconds(), folder,
                                  options);
}

MOTIONLANG_NAMESPACE_END
