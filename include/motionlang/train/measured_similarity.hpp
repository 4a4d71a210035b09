// SPDX-License-Identifier: MIT
/// Measures what the cosines of a trained TMR mean (metrics/similarity_scale.hpp).
///
///     const SimilarityScale scale = measured_similarity(model, data, nullptr, sentences, &strangers);
///
/// Texts      of the validation part, which training did not see; of the training part if there is none
/// Motions    of both parts
/// Unlike     a text and a motion of another clip whose texts have little in common with it
#pragma once

#include <motionlang/text/stranger_texts.hpp>
#include <motionlang/train/text_motion_batch.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SimilarityOptions {
  Index texts = 2000, motions = 4000, strangers = 500;  // the largest numbers to measure
  double unlike = 0.3;                                  // largest cosine of the sentences of an unlike pair
};

namespace detail {

/// At most `most` numbers below `count`, evenly spread.
std::vector<Index> spread_numbers(Index count, Index most);
/// Rows of length 1. Throws numeric_error 301, 302.
std::vector<float> unit_latents(std::span<const float> rows, Index width);

/// Texts with the motions that show them.
struct MeasuredTexts {
  std::vector<std::string> texts{};
  std::vector<Index> motions{};  // their numbers among those that are measured
};

/// The scale of unit rows; an empty one if no pair is unlike.
/// clips      (motions): motions of one clip do not count as unlike
/// sentences  unit vectors of the texts, and of a text for each motion
SimilarityScale scale_of_latents(const MeasuredTexts& texts, std::span<const float> text_rows,
                                 std::span<const float> motion_rows, std::span<const float> stranger_rows, Index width,
                                 const std::vector<std::string>& clips, const std::vector<std::string>& motion_texts,
                                 const EmbeddingCache& sentences, double unlike);

}  // namespace detail

/// states     of a language model, for a model that has none and no word pieces; otherwise null
/// sentences  unit vectors of all texts of `data`, which tell which pairs are unlike
/// strangers  null: none, and the scale does not tell if a text is shown
/// The scale is empty if no pair is unlike.
template <Backend B>
SimilarityScale measured_similarity(const TmrModel<B>& model, const DescribedMotions& data,
                                    const EmbeddingCache* states, const EmbeddingCache& sentences,
                                    const StrangerTexts* strangers, const SimilarityOptions& options = {}) {
  detail::MeasuredTexts measured;
  std::vector<std::string> clips, motion_texts;
  std::vector<float> motion_rows;
  Index width = 0;
  const auto add = [&](std::vector<float>& rows, const Tensor<B, 2>& latents) {
    width = latents.size(1);
    for (const auto x : latents.span()) rows.push_back(static_cast<float>(x));
  };
  constexpr std::size_t at_once = 64;
  const auto take = [&](const std::vector<DescribedMotion>& part, bool with_texts, Index most) {
    const auto numbers = detail::spread_numbers(std::ssize(part), most);
    for (const Index i : numbers) {
      const DescribedMotion& m = part[static_cast<std::size_t>(i)];
      for (std::size_t k = 0; with_texts && k < m.texts.size(); ++k) {
        if (m.texts[k].frames != m.texts.front().frames) continue;  // the first text's frames are encoded
        measured.texts.push_back(m.texts[k].text);
        measured.motions.push_back(std::ssize(clips));
      }
      clips.push_back(m.clip);
      motion_texts.push_back(m.texts.front().text);
    }
    for (std::size_t at = 0; at < numbers.size(); at += at_once) {
      const auto which = std::span(numbers).subspan(at, std::min(at_once, numbers.size() - at));
      const auto batch = text_motion_batch<B>(part, which, model.motion_normalizer, [](const auto&) { return 0u; });
      add(motion_rows, model.system.encode_motion(batch.motions).mu);
    }
  };
  const bool held_out = !data.validation.empty();
  take(data.validation, true, options.motions / 2);
  take(data.training, !held_out, options.motions - std::ssize(clips));
  detail::MeasuredTexts chosen;
  for (const Index i : detail::spread_numbers(std::ssize(measured.texts), options.texts)) {
    chosen.texts.push_back(measured.texts[static_cast<std::size_t>(i)]);
    chosen.motions.push_back(measured.motions[static_cast<std::size_t>(i)]);
  }
  const auto encoded = [&](const std::vector<std::string>& texts) {
    std::vector<float> rows;
    for (std::size_t at = 0; at < texts.size(); at += at_once) {
      const auto some = std::span(texts).subspan(at, std::min(at_once, texts.size() - at));
      add(rows, model.system.encode_text(model.tokens(some, states)).mu);
    }
    return detail::unit_latents(rows, width);
  };
  const auto strange = strangers == nullptr
                           ? std::vector<std::string>()
                           : strangers->draw(options.strangers, Philox{.seed = 1}.split("measured strangers"));
  return detail::scale_of_latents(chosen, encoded(chosen.texts), detail::unit_latents(motion_rows, width),
                                  encoded(strange), width, clips, motion_texts, sentences, options.unlike);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/measured_similarity.ipp>
#endif
