// SPDX-License-Identifier: MIT
/// TMR from one folder: the model that comes with motionlang (examples/models/tmr_free), one that train-tmr wrote, or
/// the run folder of the published one (config.json, last_weights/*.pt, stats/mean.pt, stats/std.pt).
///
///     const auto tmr = load_tmr<EigenBackend<float>>("examples/models/tmr_free");
///     const auto text = tmr.encode_text("a person jumps");                                       // (1, 256)
///
/// Texts   the model that comes with motionlang has its own word pieces; others read the states of DistilBERT
/// Source  Petrovich et al. (ICCV 2023); thesis, chapter 5
#pragma once

#include <motionlang/weights/text_motion_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
using TmrCheckpoint = TextMotionCheckpoint<B, Tmr<B>>;

/// Throws  io_error 401 for a missing file, 403 to 407 for files and tensors; config_error 102 for a model of another
///         system and if options and tensors differ, 103 for a folder of an unknown kind, 101, 107
template <Backend B>
TmrCheckpoint<B> load_tmr(const FilePath& path, const CheckpointOptions& options = {}) {
  const std::filesystem::path folder = found_model_folder(path);
  const TextMotionFile file = read_text_motion_config(folder);
  const WeightFile weights = file.published ? WeightFile::from_run(*file.published) : open_weights(folder);
  auto out = detail::checkpoint_of<B>(load_text_motion<Tmr, B>(weights, file), file, file.config.data.max_seconds,
                                      folder, options);
  out.id = tensors_checksum(weights.tensors());
  return out;
}

MOTIONLANG_NAMESPACE_END
