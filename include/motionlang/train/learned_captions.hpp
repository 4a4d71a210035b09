// SPDX-License-Identifier: MIT
/// The captions of a training set as a model knows them (text/known_captions.hpp). It knows how long their actions
/// take, if they repeat, what follows them, and how near a text has to be.
///
///     const auto known = learned_captions(data, text_vectors(stmc.text_encoder), stmc.text_encoder.vectors);
///     save_stmc("model.safetensors", stmc, config, {}, DType::F16, known);
///
/// Repeats    an action in cycles, one that is still all the time, and one that was cut out of a longer motion. A cut
///            action does not come to rest at its end, and nothing was put after it
/// Follows    a caption of the still segment whose pose is nearest to the last pose of the action: "stand still", "sit"
/// Nearness   divides captions from texts of other words. A caption is compared with those of segments that it is not
///            about. Texts of other words are captions whose words were replaced by words drawn from the vectors, or
///            spelled backwards if there are none
#pragma once

#include <motionlang/datasets/training_set.hpp>
#include <motionlang/text/known_captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Without captions it is empty. The result depends only on the arguments.
KnownCaptions learned_captions(const TrainingSet& data, TextVectors encode, const WordVectors& words = {});

/// The captions under which samples show a segment: its own, and those for walking backwards and along curves, if it
/// is played like that. Not those with a second action or another speed.
std::vector<std::string> sampled_captions(const CaptionedSegment& segment);

/// The actions of the segments. What follows is a text, also for those that repeat.
std::vector<KnownAction> segment_actions(const std::vector<CaptionedSegment>& segments);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/learned_captions.ipp>
#endif
