// SPDX-License-Identifier: MIT
/// TEACH from one folder: one that train-teach wrote, or the run folder of the published one (.hydra/config.yaml,
/// checkpoints/last.ckpt).
///
///     const auto teach = load_teach<B>("teach-run", {.text_encoder = "distilbert", .statistics = "deps/..."});
///
/// Source  Athanasiou et al. (3DV 2022); thesis, annex A
#pragma once

#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/text_motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
using TeachCheckpoint = TextMotionCheckpoint<B, Teach<B>>;

/// Throws  io_error 401 for a missing file, 403 to 407 for files and tensors; config_error 102 for a model of another
///         system and if options and tensors differ, 101, 103, 107
template <Backend B>
TeachCheckpoint<B> load_teach(const FilePath& path, const CheckpointOptions& options = {}) {
  const std::filesystem::path folder = found_model_folder(path);
  if (const RunFolder run = find_run(folder); run.system != "motionlang")
    return detail::checkpoint_of<B>(load_teach_run<B>(run, {options.text_encoder, options.statistics}), folder,
                                    options);
  const auto file = read_babel_config<TeachTrainingConfig>(folder);
  detail::require_trained(folder, file.system, "teach");
  return detail::checkpoint_of<B>(load_text_motion<Teach, B>(folder, file), file, file.config.longest_seconds(), folder,
                                  options);
}

MOTIONLANG_NAMESPACE_END
