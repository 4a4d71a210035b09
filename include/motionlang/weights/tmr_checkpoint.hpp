// SPDX-License-Identifier: MIT
/// TMR from one folder: the model that comes with motionlang (examples/models/tmr_free), one that train-tmr wrote, or
/// the run folder of the published one (config.json, last_weights/*.pt, stats/mean.pt, stats/std.pt).
///
///     const auto tmr = load_tmr<EigenBackend<float>>("examples/models/tmr_free");
///     const auto text = tmr.encode_text("a person jumps");                                       // (1, 256)
///
/// Texts   the model that comes with motionlang has its own word pieces; others read the states of DistilBERT
/// Queries the model that comes with motionlang knows few words. The captions of the bundled STMC, beside its folder,
///         tell what a query means
/// Source  Petrovich et al. (ICCV 2023); thesis, chapter 5
#pragma once

#include <motionlang/weights/caption_encoder_file.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
using TmrCheckpoint = TextMotionCheckpoint<B, Tmr<B>>;

/// Throws  io_error 401 for a missing file, 403 to 407 for files and tensors; numeric_error 301; config_error 102 for a
///         model of another system, if options and tensors differ, and if the file of known captions has none, 103 for
///         a folder of an unknown kind, 101, 107
template <Backend B>
TmrCheckpoint<B> load_tmr(const FilePath& path, const CheckpointOptions& options = {}) {
  const std::filesystem::path folder = found_model_folder(path);
  const TextMotionFile file = read_text_motion_config(folder);
  const WeightFile weights = file.published ? WeightFile::from_run(*file.published) : open_weights(folder);
  auto out = detail::checkpoint_of<B>(load_text_motion<Tmr, B>(weights, file), file, file.config.data.max_seconds,
                                      folder, options);
  out.id = tensors_checksum(weights.tensors());
  if (const std::string& known = file.config.text.known_captions; !known.empty()) {
    if (!std::filesystem::exists(folder / known))
      raise<io_error>(401, folder.string(), ": text.known_captions names ", (folder / known).string(),
                      ", which does not exist");
    const auto motions = SafetensorsFile::open(folder / known);
    out.captions = load_known_captions<B>(motions);
    if (out.captions.empty())
      raise<config_error>(102, motions.name(), ": text.known_captions of ", folder.string(),
                          " names this file, which lists no captions");
    auto words = known_words(motions.metadata());
    words.insert(words.end(), out.captions.table().said_words().begin(), out.captions.table().said_words().end());
    out.known_words = KnownWords(std::move(words), out.captions.table().words());
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
