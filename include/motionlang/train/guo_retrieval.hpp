// SPDX-License-Identifier: MIT
/// Guo's evaluator as the model that retrieves: vectors of texts and motions for the rows "Guo et al." of TMR's tables.
///
///     const LatentTable table = guo_latents(judge, data.test, data.width);
///     retrieval_results(table, nullptr, sentences, {.ids = ids, .euclidean = true});
///
/// It reads the first 196 frames of a motion.
/// Source  thesis tables 5.1, 5.2, 5.7; TMR (Petrovich, Black, Varol, ICCV 2023), tables 1, 2
#pragma once

#include <algorithm>  // min
#include <cstdint>    // seed
#include <vector>     // motions

#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/text_motion_batch.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The vectors of every motion and of its first text.
/// make  makes motions for the texts, and these are embedded instead; none: the recorded ones
template <Backend B>
LatentTable guo_latents(const GuoJudge<B>& judge, const std::vector<DescribedMotion>& part, Index width,
                        const GuoMaker<B>& make = {}, std::uint64_t seed = 0) {
  LatentTable out;
  constexpr Index at_once = 32;
  const Index count = std::ssize(part);
  for (Index at = 0; at < count; at += at_once) {
    std::vector<GuoWanted> wanted;
    std::vector<std::string> texts, captions;
    std::vector<typename B::scalar> values;
    std::vector<Index> frames;
    for (Index i = at; i < std::min(at + at_once, count); ++i) {
      const DescribedMotion& m = part[static_cast<std::size_t>(i)];
      const DescribedText& t = m.texts.front();
      const Index length = std::min<Index>(t.frames.length, 196);
      texts.push_back(tagged_text(t)), captions.push_back(t.text);
      wanted.push_back({texts.back(), t.text, length, &m});
      const auto first = m.rows.begin() + t.frames.first * width;
      values.insert(values.end(), first, first + length * width);
      frames.push_back(length);
    }
    const Offsets offsets(frames);
    const auto motions = make ? make(wanted, Philox{.seed = seed}.split(static_cast<std::uint64_t>(at)))
                              : Sequences<B>{Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets};
    out.add(captions, judge.texts(texts), judge.motions(motions));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
