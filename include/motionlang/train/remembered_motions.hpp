// SPDX-License-Identifier: MIT
/// Recordings of a training set as motions that a model remembers. Nothing is trained.
///
///     const TrainingSet data("captions.tsv", "clips", {});
///     const KnownCaptions known = load_known_captions(path, stmc.text_encoder);
///     write_motion_memory(path, "with_gestures.safetensors", remembered_motions(known, data));
#pragma once

#include <motionlang/datasets/motion_memory.hpp>
#include <motionlang/datasets/training_set.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The captions of the model and of the recordings, and the recordings. All captions are encoded anew, so they may be
/// those of older weights. A caption of recordings has their action: its length, and what follows it.
/// words   recordings count if a caption has one of these words or phrases ("nod" also finds "nodding"); none: all
/// Throws  config_error 102 for words that no caption has, and for a model that knows no captions
MotionMemory remembered_motions(const KnownCaptions& known, const TrainingSet& data,
                                std::span<const std::string> words = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/remembered_motions.ipp>
#endif
