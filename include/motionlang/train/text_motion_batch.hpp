// SPDX-License-Identifier: MIT
/// Batches of motions with a text each, and the latents of both.
#pragma once

#include <algorithm>  // min
#include <span>       // numbers of motions
#include <string>     // texts
#include <vector>     // values

#include <motionlang/train/motion_batch.hpp>
#include <motionlang/weights/text_motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Motions with one text each, as a model takes them.
template <Backend B>
struct TextMotionBatch {
  std::vector<std::string> texts;
  Sequences<B> motions;  // normalised
};
/// A motion, and the one of its texts that is chosen.
struct ChosenText {
  const DescribedMotion* motion;
  const DescribedText* text;
};
template <Backend B>
TextMotionBatch<B> text_motion_batch(std::span<const ChosenText> chosen, const Normalizer<B>& normalizer) {
  TextMotionBatch<B> out;
  MotionBatch<B> batch(normalizer);
  for (const ChosenText& c : chosen) {
    out.texts.push_back(c.text->text);
    batch.add(c.motion->rows, c.text->frames);
  }
  out.motions = batch.normalized();
  return out;
}
/// `which` holds numbers of motions; text(motion) chooses one of its texts.
template <class Choose>
std::vector<ChosenText> chosen_texts(const std::vector<DescribedMotion>& motions, std::span<const Index> which,
                                     Choose text) {
  std::vector<ChosenText> out;
  for (const Index i : which) {
    const DescribedMotion& m = motions[static_cast<std::size_t>(i)];
    out.push_back({&m, &m.texts[text(m)]});
  }
  return out;
}
template <Backend B, class Choose>
TextMotionBatch<B> text_motion_batch(const std::vector<DescribedMotion>& motions, std::span<const Index> which,
                                     const Normalizer<B>& normalizer, Choose text) {
  return text_motion_batch<B>(chosen_texts(motions, which, text), normalizer);
}

/// Means of the latents of motions and of their first texts, (motions, latent) row by row: what retrieval compares.
struct LatentTable {
  std::vector<std::string> texts;
  std::vector<float> text, motion;
  Index width = 0;

  template <Backend B>
  void add(const std::vector<std::string>& more, const Tensor<B, 2>& of_texts, const Tensor<B, 2>& of_motions) {
    texts.insert(texts.end(), more.begin(), more.end());
    text.insert(text.end(), of_texts.span().begin(), of_texts.span().end());
    motion.insert(motion.end(), of_motions.span().begin(), of_motions.span().end());
    width = of_texts.size(1);
  }
};
/// seen(batch)  motions to encode instead of those of the batch, normalised
template <template <class> class System, Backend B, class Seen>
LatentTable latents_of(const TextMotionModel<B, System>& model, const std::vector<DescribedMotion>& motions,
                       const EmbeddingCache* states, Seen seen) {
  LatentTable out;
  constexpr Index at_once = 32;
  for (Index at = 0; at < std::ssize(motions); at += at_once) {
    std::vector<Index> which;
    for (Index i = at; i < std::min(at + at_once, std::ssize(motions)); ++i) which.push_back(i);
    const auto batch = text_motion_batch<B>(motions, which, model.motion_normalizer, [](const auto&) { return 0u; });
    out.add(batch.texts, model.system.encode_text(model.tokens(batch.texts, states)).mu,
            model.system.encode_motion(seen(batch)).mu);
  }
  return out;
}
template <template <class> class System, Backend B>
LatentTable latents_of(const TextMotionModel<B, System>& model, const std::vector<DescribedMotion>& motions,
                       const EmbeddingCache* states) {
  return latents_of(model, motions, states, [](const TextMotionBatch<B>& batch) { return batch.motions; });
}

MOTIONLANG_NAMESPACE_END
