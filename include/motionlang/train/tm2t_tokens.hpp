// SPDX-License-Identifier: MIT
/// The data of the stages of TM2T after the tokenizer: motions as tokens, with the words of their texts.
#pragma once

#include <algorithm>  // min
#include <cstdint>    // draws
#include <map>        // settings
#include <span>       // numbers of motions
#include <string>     // words
#include <utility>    // move
#include <vector>     // tokens

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/described_words.hpp>
#include <motionlang/datasets/motion_tokens.hpp>
#include <motionlang/datasets/tm2t_data.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/nn/seq2seq_transformer.hpp>
#include <motionlang/systems/tm2t.hpp>
#include <motionlang/tensor/arg_max.hpp>
#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/epoch_task.hpp>
#include <motionlang/train/tm2t_model_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The sizes of a transformer of TM2T that its configuration gives; c: of the describer or of the writer.
template <class C>
Seq2SeqConfig tm2t_transformer_sizes(const C& c) {
  return {.d_model = c.latent_dim,
          .d_inner = c.ff_size,
          .heads = c.num_heads,
          .head_width = c.latent_dim / c.num_heads,
          .encoder_layers = c.num_layers,
          .decoder_layers = c.num_layers,
          .dropout = c.dropout};
}

}  // namespace detail

/// A text and its motion, as they are used in training.
struct TokenizedText {
  TokenLines lines;  // from frame 0 on, from frame 1 on ...
  std::vector<Index> words;
};
using TokenizedMotions = std::vector<std::vector<TokenizedText>>;  // texts of each motion

/// The tokens of every text's frames, and its words. There is a line of tokens from each of the first four frames on
/// that leaves as many whole tokens. Frames after the 196th are cut. Differs from the published program, which draws
/// the first frame five times for the whole clip.
template <Backend B>
TokenizedMotions tokenized(const std::vector<DescribedMotion>& motions, const Tm2t<B>& model, const GloVe& words,
                           Progress progress) {
  const Index width = model.statistics.mean.size(0);
  TokenizedMotions out(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const DescribedMotion& m = motions[i];
    for (std::size_t k = 0; k < m.texts.size(); ++k) {
      const FrameSlice frames = m.texts[k].frames;
      TokenizedText t{{}, marked_words(words, words_of(m.texts[k], words))};
      const bool same = k > 0 && m.texts[k - 1].frames == frames;
      if (same) t.lines = out[i].back().lines;
      const Index length = std::min(frames.length / 4 * 4, tm2t_longest);
      for (Index first = 0; !same && first < std::min<Index>(4, frames.length - length + 1); ++first) {
        const auto begin = m.rows.begin() + (frames.first + first) * width;
        const std::vector<typename B::scalar> rows(begin, begin + length * width);
        const Sequences<B> x{Tensor<B, 2>::from(rows, {length, width}), Offsets{length}};
        t.lines.push_back(model.tokens(x).ids);
      }
      out[i].push_back(std::move(t));
    }
    progress(static_cast<Index>(i) + 1, std::ssize(motions));
  }
  return out;
}

struct TokenizedBatch {
  IdSequences tokens, words;  // with their marks
  Index longest = 0;          // words of the longest text, if the batch of the step has longer ones
};

/// Tokens and words of a batch.
/// draw  chooses a text and a line, and decides if a token is dropped; null: the first ones, and nothing is dropped
TokenizedBatch tokenized_batch(const TokenizedMotions& of, const MotionVocabulary& vocabulary,
                               std::span<const Index> which, Philox* draw);

template <Backend B>
struct TokenizedData {
  Tm2t<B> model;  // the tokenizer; for inverse alignment also the transformer
  GloVe words;
  TokenizedMotions training{}, validation{};

  void tokenize(const DescribedMotions& data, Progress progress = {}) {
    training = tokenized(data.training, model, words, progress);
    validation = tokenized(data.validation, model, words, progress);
  }
  TokenizedBatch batch(const TokenizedMotions& of, std::span<const Index> which, Philox* draw) const {
    return tokenized_batch(of, model.vocabulary(), which, draw);
  }
  /// Adds the settings with which a checkpoint must have been trained.
  void add_to(std::map<std::string, std::string>& settings) const {
    const auto codes = model.tokenizer.quantizer.embedding.weight.span();
    settings["tokenizer"] = detail::hexadecimal(detail::content_hash(std::as_bytes(codes)));
    std::string& all = settings["words"];
    for (const std::string& word : words.words()) all += word + "\n";
  }
};

/// The vectors of all words, by id.
inline std::vector<float> word_table(const GloVe& words) {
  std::vector<float> out;
  for (const std::string& word : words.words()) {
    const auto row = words.vector(word);
    out.insert(out.end(), row.begin(), row.end());
  }
  return out;
}
/// Those of sequences of words. width: of a vector.
template <Backend T>
Sequences<T> word_rows(const std::vector<float>& table, Index width, const IdSequences& words) {
  std::vector<float> rows;
  for (const Index id : words.ids)
    rows.insert(rows.end(), table.begin() + id * width, table.begin() + (id + 1) * width);
  return {Tensor<T, 2>::from(rows, {std::ssize(words.ids), width}), words.offsets};
}

/// The number of symbols to predict in sequences: all except the start marks.
inline double written_symbols(const IdSequences& x) { return static_cast<double>(std::ssize(x.ids) - x.count()); }

/// The share of the symbols that the logits find most probable.
template <Backend B>
double right_symbols(const Tensor<B, 2>& logits, const IdSequences& written) {
  const auto found = arg_max(logits), wanted = written.without_ends(1, 0).ids;
  double right = 0;
  for (std::size_t i = 0; i < found.size(); ++i) right += found[i] == wanted[i] ? 1 : 0;
  return right / static_cast<double>(found.size());
}

/// The sequences of a part of a batch.
inline IdSequences part_of(const IdSequences& batch, const BatchPart& part) {
  if (part.count() == batch.count()) return batch;
  std::vector<std::vector<Index>> out;
  for (Index s = part.first; s < part.last; ++s)
    out.emplace_back(batch.ids.begin() + batch.offsets.begin(s), batch.ids.begin() + batch.offsets.end(s));
  return IdSequences::from(out);
}

/// The common part of both stages after the tokenizer.
template <Module Taped, Module Plain>
class TokenTask : public EpochTask<Tm2tTrainingConfig, Taped, Plain> {
 public:
  using Base = EpochTask<Tm2tTrainingConfig, Taped, Plain>;
  using typename Base::B;

  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    tokens_->add_to(out);
    return out;
  }

 protected:
  /// data, tokens  must outlive the task
  TokenTask(std::string system, const Tm2tTrainingConfig& config, const DescribedMotions& data,
            const TokenizedData<B>& tokens)
      : Base(std::move(system), config, data), tokens_(&tokens) {}

  /// Some samples of the batch of a step.
  TokenizedBatch batch(const Philox& rng, Index step, const BatchPart& part) const {
    auto draw = rng.split("texts");
    const auto all = tokens_->batch(tokens_->training, this->batches_(step, this->seed()), &draw);
    return {part_of(all.tokens, part), part_of(all.words, part), all.words.offsets.longest()};
  }
  /// logits_and_written(batch): the logits, and the sequences that they predict; name: of the loss for each symbol.
  template <class F>
  std::vector<Measure> measured(const char* name, F logits_and_written) {
    double right = 0;
    const double loss = this->over_validation([&](std::span<const Index> which, const Philox&) {
      const auto [logits, written] = logits_and_written(tokens_->batch(tokens_->validation, which, nullptr));
      right += right_symbols(logits, written) * static_cast<double>(which.size());
      return static_cast<double>(next_symbol_loss(logits, written).item()) / written_symbols(written);
    });
    return {{name, loss}, {"accuracy", right / static_cast<double>(tokens_->validation.size()), true}};
  }

  const TokenizedData<B>* tokens_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/tm2t_tokens.ipp>
#endif
