// SPDX-License-Identifier: MIT
/// SINC's text encoder: one motion with several labels at the same time.
#pragma once

#include <algorithm>  // max

#include <motionlang/vae/parted_text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How several labels are encoded. single: one sentence (text/joined_labels.hpp; the released models). separate_texts:
/// one sequence of separate texts ("SINC-STE"). separate_latents: a latent for each label; the decoder attends to all.
enum class SincMode { single, separate_texts, separate_latents };

/// The labels of a batch of motions, as texts.
template <Backend B>
struct SincTexts {
  Sequences<B> states;                // the last states of the language model, with those of [CLS] and [SEP]
  std::vector<Index> motion{};        // the motion of each text: 0, ..., 0, 1, ...; empty: one text for each
  std::optional<Tensor<B, 2>> end{};  // (texts, text_dim): see SincTextEncoder::joined
  Index padded_tokens = 0;            // of the batch, if it is padded beyond its longest text

  /// The number of texts of each motion. Throws shape_error 205 unless `motion` counts from 0 without gaps and has one
  /// entry for each text.
  Offsets per_motion() const {
    if (motion.empty()) return Offsets::equal(states.count(), 1);
    if (std::ssize(motion) != states.count())
      raise<shape_error>(205, "SincTexts: ", motion.size(), " numbers of motions for ", states.count(), " texts");
    std::vector<Index> texts;
    for (Index m : motion) {
      if (m == std::ssize(texts))
        texts.push_back(1);
      else if (!texts.empty() && m == std::ssize(texts) - 1)
        ++texts.back();
      else
        raise<shape_error>(205, "SincTexts: motion ", m, " behind ", texts.size(), " motions");
    }
    return Offsets(texts);
  }
};

struct SincTextKeys {
  static constexpr const char* separation_token = "separation_token";
};

///     single             [mu, logvar, text]                               no positions: the language model has its own
///     separate_texts     [mu, logvar, text 0, separation, text 1, ...]
///     separate_latents   [mu, logvar, text + positions]                   each text alone
/// Source  SINC (Athanasiou, Petrovich, Black, Varol, ICCV 2023): thesis B.2.2 (one text) and B.3.3 (separate texts);
///         SINC sinc/model/textencoder/text_space.py
template <Backend B>
struct SincTextEncoder {
  PartedTextEncoder<B, SincTextKeys> text;

  static constexpr auto fields() { return motionlang::fields("", &SincTextEncoder::text); }

  SincTextEncoder() = default;
  SincTextEncoder(Index text_dim, const TransformerConfig& c, Index max_len, Rng auto& rng)
      : text(text_dim, c, max_len, rng) {}

  /// The input of the first layer for each text alone.
  Sequences<B> alone(const Sequences<B>& states, bool positions, const Context& context = {}) const {
    const auto words = text.projected(states);
    const auto tokens = repeat_sequence(text.beginning(), states.count());
    return concat_tokens(tokens, positions ? text.placed(words, context) : words);
  }
  /// The input of the first layer for the texts of each motion together.
  /// legacy_mask  As published, the mask is shifted by one after the first text. Of each further text shorter than the
  ///              padded length of the batch, the last token is hidden and the last padding place is visible
  ///              (`texts.end`: the state of the language model there, distilbert.padding_states(batch, last place)). A
  ///              motion with fewer texts than another sees one row of zeros for each missing text
  /// Throws       config_error 101 if `texts.end` is needed and missing
  Sequences<B> joined(const SincTexts<B>& texts, bool legacy_mask) const {
    const Offsets of_motion = texts.per_motion(), &words = texts.states.offsets;
    const Index width = text.mu_token.size(0), longest = std::max(words.longest(), texts.padded_tokens);
    const bool cut = legacy_mask && of_motion.longest() > 1 && !(words == Offsets::equal(words.count(), longest));
    if (cut && !texts.end)
      raise<config_error>(101,
                          "SincTextEncoder: the published mask needs the states at the ends of padded texts "
                          "(SincTexts::end), or legacy_ste_mask = false");
    const Index first_word = 2, separation = first_word + words.rows(), zero = separation + 1, end = separation + 2;
    auto table = concat(0, text.beginning(), text.projected(texts.states).rows);
    if (of_motion.longest() > 1) table = concat(0, table, text.separation(), Tensor<B, 2>::zeros({1, width}));
    if (cut) {
      const Sequences<B> ends(*texts.end, Offsets::equal(words.count(), 1));
      table = concat(0, table, text.projected(ends).rows);
    }
    std::vector<Index> pick, lengths;
    for (Index m = 0; m < of_motion.count(); ++m) {
      const auto before = std::ssize(pick);
      pick.insert(pick.end(), {0, 1});
      for (Index t = of_motion.begin(m); t < of_motion.end(m); ++t) {
        const bool further = t > of_motion.begin(m), cut_here = cut && further && words.length(t) < longest;
        if (further) pick.push_back(separation);
        for (Index i = words.begin(t); i < words.end(t); ++i) pick.push_back(first_word + i);
        if (cut_here) pick.back() = end + t;
      }
      if (legacy_mask)
        pick.insert(pick.end(), static_cast<std::size_t>(of_motion.longest() - of_motion.length(m)), zero);
      lengths.push_back(std::ssize(pick) - before);
    }
    return {gather(table, pick), Offsets(lengths)};
  }
  /// A distribution for each motion; in mode separate_latents, for each text. Throws shape_error 205 for a motion with
  /// several texts in mode single.
  LatentGaussian<B> operator()(const SincTexts<B>& texts, SincMode mode, bool legacy_mask = true,
                               const Context& context = {}) const {
    const ModuleScope scope(*this);
    const Offsets of_motion = texts.per_motion();
    if (mode == SincMode::separate_texts) return text.encode(joined(texts, legacy_mask), context);
    if (mode == SincMode::single && of_motion.longest() > 1)
      raise<shape_error>(205, "SincTextEncoder: ", of_motion.longest(),
                         " texts for one motion; join them to one sentence");
    return text.encode(alone(texts.states, mode == SincMode::separate_latents, context), context);
  }
};

MOTIONLANG_NAMESPACE_END
