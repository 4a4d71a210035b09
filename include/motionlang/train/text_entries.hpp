// SPDX-License-Identifier: MIT
/// Motions with all texts about the same frames, as the evaluations of descriptions take them.
#pragma once

#include <span>    // rows
#include <string>  // names
#include <vector>  // texts

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/datasets/described_words.hpp>
#include <motionlang/metrics/captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Some frames of a motion, and the texts about them.
struct TextEntry {
  const DescribedMotion* motion;
  FrameSlice frames;
  std::vector<const DescribedText*> texts{};
};
/// The entries of a part, which must outlive them. `name` appears in messages. Throws config_error 101 if there are
/// none.
std::vector<TextEntry> text_entries(const std::vector<DescribedMotion>& part, const std::string& name);

/// `length` frames of an entry, from frame `first` on.
std::span<const float> entry_rows(const TextEntry& e, Index first, Index length, Index width);

/// Three of its texts, to compare a description with.
CaptionPair entry_references(const TextEntry& e, const GloVe& words);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/text_entries.ipp>
#endif
