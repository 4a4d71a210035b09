// SPDX-License-Identifier: MIT
/// TM2T: motions to texts and texts to motions, both through motion tokens. This header assembles it from
/// vae/motion_tokenizer.hpp, nn/seq2seq_transformer.hpp, nn/seq2seq_gru.hpp and nn/decoding.hpp.
///
///     for (const auto& text : tm2t.describe(features, glove)) use(text);             // "a person walk forward"
///     const auto motions = tm2t.generate(glove.encode<B>(texts), rng);               // features, four frames a token
///
/// Source  Guo, Zuo, Wang, Cheng, "TM2T: stochastic and tokenized modeling for the reciprocal generation of 3D human
///         motions and texts" (ECCV 2022), section 3
#pragma once

#include <concepts>  // noise

#include <motionlang/datasets/tm2t_data.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/nn/seq2seq_writer.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Published sizes for HumanML3D. KIT: 251 features, three layers.
struct Tm2tConfig {
  MotionTokenizerConfig tokenizer{};
  Seq2SeqConfig motion_to_text{};
  Seq2SeqGruConfig text_to_motion{};
};

/// The published way from texts to motions.
struct Tm2tSampling {
  Index max_tokens = 49, top_k = 100;
};

/// A description of a motion, and the logarithm of its probability under the model.
struct Description {
  std::string text;
  double log_probability = 0;
};

/// Rows of four frames side by side. Frames after the last whole four are dropped. Throws shape_error 205 for fewer
/// than four.
template <Backend B>
Sequences<B> four_frame_rows(const Sequences<B>& x) {
  PoolVector<Index> pick, lengths;
  for (Index s = 0; s < x.count(); ++s) {
    const Index units = x.offsets.length(s) / 4;
    if (units == 0) raise<shape_error>(205, "four_frame_rows: ", x.offsets.length(s), " frames");
    for (Index i = 0; i < 4 * units; ++i) pick.push_back(x.offsets.begin(s) + i);
    lengths.push_back(units);
  }
  const Offsets offsets{std::span<const Index>(lengths)};
  return {reshape<2>(gather(x.rows, pick), {offsets.rows(), 4 * x.width()}), offsets};
}

/// The members of the published checkpoints, each from a file of its own.
template <Backend B>
struct Tm2t {
  Normalizer<B> statistics;  // those of the tokenizer, see tm2t_deviation
  MotionTokenizer<B> tokenizer;
  Seq2SeqTransformer<B> m2t_transformer;
  Seq2SeqGru<B> t2m_model;
  std::optional<Seq2SeqTransformer<B>> t2m_transformer{};  // writes motions instead: "baseline (T)" of the paper

  static constexpr auto fields() {
    using M = Tm2t;
    return motionlang::fields("statistics", &M::statistics, "tokenizer", &M::tokenizer, "m2t_transformer",
                              &M::m2t_transformer, "t2m_model", &M::t2m_model, "t2m_transformer", &M::t2m_transformer);
  }
  Tm2t() = default;
  Tm2t(const Tm2tConfig& c, Rng auto& rng)
      : statistics(Normalizer<B>::identity(c.tokenizer.features)),
        tokenizer(c.tokenizer, rng),
        m2t_transformer(c.motion_to_text, rng),
        t2m_model(c.text_to_motion, rng) {}

  MotionVocabulary vocabulary() const { return tokenizer.vocabulary(); }

  /// Features to codes, without marks. Frames after the last group of four are dropped. Throws shape_error 205 for
  /// fewer than four.
  IdSequences tokens(const Sequences<B>& features) const {
    return tokenizer.tokens(features.with(statistics.normalize(features.rows)));
  }
  /// Codes to features. A motion without codes has no frames.
  Sequences<B> motions(const IdSequences& codes) const {
    std::vector<std::vector<Index>> lists;
    std::vector<Index> frames;
    for (Index i = 0; i < codes.count(); ++i) {
      const auto own = codes[i];
      if (!own.empty()) lists.emplace_back(own.begin(), own.end());
      frames.push_back(4 * std::ssize(own));
    }
    if (lists.empty()) return {Tensor<B, 2>::zeros({0, statistics.mean.size(0)}), Offsets(frames)};
    return {statistics.denormalize(tokenizer.motions(IdSequences::from(lists)).rows), Offsets(frames)};
  }

  /// The input of the transformer: codes between the marks.
  IdSequences marked(const IdSequences& codes) const {
    std::vector<std::vector<Index>> lists;
    for (Index i = 0; i < codes.count(); ++i) {
      const auto own = codes[i];
      lists.push_back({vocabulary().begin()});
      lists.back().insert(lists.back().end(), own.begin(), own.end());
      lists.back().push_back(vocabulary().end());
    }
    return IdSequences::from(lists);
  }
  /// The motions as m2t_transformer remembers them: their codes, or without motion tokens ("w/o MT") their features.
  Sequences<B> remembered(const Sequences<B>& features) const {
    if (!m2t_transformer.encoder.emb) return m2t_transformer.encode(marked(tokens(features)));
    return m2t_transformer.encode(four_frame_rows(features.with(statistics.normalize(features.rows))));
  }

  /// A description of each motion, the best of several beams: lemmas with blanks between them.
  /// Differs from the published program, which removes the last word of a description without an end
  std::vector<std::string> describe(const Sequences<B>& features, const GloVe& glove, BeamOptions options = {}) const {
    std::vector<std::string> out;
    for_each_search(features, glove, options,
                    [&](const BeamSearch& found, const Sequences<B>&) { out.push_back(sentence(found.ids, glove)); });
    return out;
  }
  /// All beams with different words, the best first.
  std::vector<std::vector<Description>> descriptions(const Sequences<B>& features, const GloVe& glove,
                                                     BeamOptions options = {}) const {
    std::vector<std::vector<Description>> out;
    for_each_search(features, glove, options, [&](const BeamSearch& found, const Sequences<B>& memory) {
      auto& said = out.emplace_back();
      for (const std::size_t b : found.order)
        add(said, std::span(found.beams[b]).first(static_cast<std::size_t>(found.lengths[b])), memory, glove);
    });
    return out;
  }
  /// Descriptions sampled word by word.
  std::vector<std::string> describe_at_random(const Sequences<B>& features, const GloVe& glove, const Philox& rng,
                                              DecodingOptions options = {}) const {
    set_marks(options, glove);
    const auto memory = remembered(features);
    const auto words =
        decode_batch(Seq2SeqWriter<B>(m2t_transformer, memory), memory.count(), options, uniform_of(rng)).written();
    std::vector<std::string> out;
    for (Index i = 0; i < words.count(); ++i) out.push_back(sentence(words[i], glove));
    return out;
  }
  /// `draws` of them for each motion, without duplicates.
  std::vector<std::vector<Description>> descriptions_at_random(const Sequences<B>& features, const GloVe& glove,
                                                               const Philox& rng, Index draws,
                                                               DecodingOptions options = {}) const {
    set_marks(options, glove);
    const auto memory = remembered(features);
    std::vector<std::vector<Description>> out(static_cast<std::size_t>(memory.count()));
    for (Index k = 0; k < draws; ++k) {
      const auto uniform = uniform_of(k == 0 ? rng : rng.split(static_cast<std::uint64_t>(k)));
      auto drawn = decode_batch(Seq2SeqWriter<B>(m2t_transformer, memory), memory.count(), options, uniform);
      for (std::size_t i = 0; i < out.size(); ++i) {
        const auto at = static_cast<Index>(i);
        auto& ids = drawn.ids[i];
        ids.resize(static_cast<std::size_t>(1 + drawn.lengths[i]));
        if (drawn.lengths[i] < options.max_steps) ids.push_back(options.end);
        add(out[i], ids, {memory[at], Offsets{memory.offsets.length(at)}}, glove);
      }
    }
    return out;
  }

  /// The codes of a motion for each text. text: from GloVe::encode; parts of speech are not read.
  IdSequences write_tokens(const TextFeatures<B>& text, const Philox& rng, const Tm2tSampling& options = {}) const {
    const DecodingOptions how{.begin = vocabulary().begin(),
                              .end = vocabulary().end(),
                              .pad = vocabulary().pad(),
                              .max_steps = options.max_tokens,
                              .top_k = options.top_k};
    if (t2m_transformer) {
      const auto memory = t2m_transformer->encode(word_vectors(text));
      return decode_batch(Seq2SeqWriter<B>(*t2m_transformer, memory), text.count(), how, uniform_of(rng)).written();
    }
    auto state = t2m_model.start(word_vectors(text));
    return decode_batch(t2m_model.next(state), text.count(), how, uniform_of(rng)).written();
  }
  /// Their features. A text for which the model writes nothing gets no frames.
  Sequences<B> generate(const TextFeatures<B>& text, const Philox& rng, const Tm2tSampling& options = {}) const {
    return motions(write_tokens(text, rng, options));
  }

  Sequences<B> word_vectors(const TextFeatures<B>& text) const {
    const Index width = t2m_transformer
                            ? detail::present(t2m_transformer->encoder.emb, "its source are symbols").weight.size(1)
                            : t2m_model.text_encoder.input_emb.in();
    return text.tokens.with(slice(text.tokens.rows, 1, 0, width));
  }

 private:
  static void set_marks(auto& options, const GloVe& glove) {
    options.begin = glove.id("sos"), options.end = glove.id("eos"), options.pad = glove.size();
  }
  /// Calls f(the result of the search for a motion's words, the motion in the transformer's memory).
  template <class F>
  void for_each_search(const Sequences<B>& features, const GloVe& glove, BeamOptions options, F f) const {
    set_marks(options, glove);
    const auto memory = remembered(features);
    for (Index i = 0; i < memory.count(); ++i) {
      const Sequences<B> own{memory[i], Offsets{memory.offsets.length(i)}};
      f(beam_search(Seq2SeqWriter<B>(m2t_transformer, own), options), own);
    }
  }
  /// Adds the description in these symbols of a memory's motion, unless it is a duplicate.
  void add(std::vector<Description>& to, std::span<const Index> ids, const Sequences<B>& memory,
           const GloVe& glove) const {
    std::string text = sentence(ids, glove);
    if (std::any_of(to.begin(), to.end(), [&](const Description& d) { return d.text == text; })) return;
    const auto written = IdSequences::one(ids);
    const auto logits = m2t_transformer.logits(written.without_ends(0, 1), memory);
    to.push_back({std::move(text), -static_cast<double>(next_symbol_loss(logits, written).item())});
  }
  /// Words without marks.
  static std::string sentence(std::span<const Index> ids, const GloVe& glove) {
    std::string out;
    for (const Index id : ids) {
      if (id == glove.id("sos") || id == glove.id("eos") || id == glove.size()) continue;
      out += (out.empty() ? "" : " ") + glove.word(id);
    }
    return out;
  }
};

/// "Inverse alignment": the motion that the recurrent model writes for a text must be described by that text again.
/// Returns the loss of the description. Its gradient reaches the recurrent model through a Gumbel sample; the model
/// from motion to text must not change.
///    text: word vectors; described: ids of the words with their marks; noise(step): as for gumbel_sample
/// Source   TM2T, section 3.3: the second sum of TM2T eq. 7; TM2T networks/trainers.py Seq2SeqT2MJointTrainer
///          forward_cycle
/// Differs  from TM2T eq. 7, which adds both sums. As published, this is a separate step after that of the tokens (the
///          first sum, `next_symbol_loss`). Each step clips its gradients at norm 0.5
template <AutodiffBackend A, class Noise>
requires std::invocable<const Noise&, Index> Tensor<A, 0> inverse_alignment_loss(
    const Seq2SeqGru<A>& t2m, const Seq2SeqTransformer<A>& m2t, const Sequences<A>& text, const IdSequences& described,
    const GumbelOptions& options, const Noise& noise, const Context& context = {}) {
  const auto sample = gumbel_sample(t2m, text, options, noise);
  const auto memory = m2t.encode_shares(sample.rows(), context);
  // The second sum of TM2T eq. 7.
  return next_symbol_loss(m2t.logits(described.without_ends(0, 1), memory, context), described);
}
/// The same with noise that a generator draws.
template <AutodiffBackend A>
Tensor<A, 0> inverse_alignment_loss(const Seq2SeqGru<A>& t2m, const Seq2SeqTransformer<A>& m2t,
                                    const Sequences<A>& text, const IdSequences& described,
                                    const GumbelOptions& options, Philox& rng, const Context& context = {}) {
  const Index symbols = t2m.motion_decoder_step.input_emb.weight.size(0);
  return inverse_alignment_loss(
      t2m, m2t, text, described, options, [&](Index) { return gumbel_noise<A>(text.count(), symbols, rng); }, context);
}

MOTIONLANG_NAMESPACE_END
