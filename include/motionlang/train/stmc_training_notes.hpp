// SPDX-License-Identifier: MIT
/// Metadata of a model that StmcTraining made: how much it learned from, and what its motions are compared with.
///
///     trainer.task().export_model("run/stmc.safetensors", stmc_training_notes(data));
#pragma once

#include <map>     // metadata
#include <string>  // metadata

#include <motionlang/datasets/training_set.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// real.skate, real.jitter  means over the recordings, m/s and m/s^3: `motionlang judge` prints them beside the model's
/// data                     "120 captioned segments, 5.5 minutes"
/// words                    of the captions (text/known_words.hpp)
/// version                  of the library
/// Precondition: there are segments.
std::map<std::string, std::string> stmc_training_notes(const TrainingSet& data);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/stmc_training_notes.ipp>
#endif
