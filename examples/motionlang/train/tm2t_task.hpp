// Training of TM2T, stage by stage: the motion tokenizer, the transformer from motions to texts, the recurrent
// network from texts to motions with inverse alignment.
#pragma once

#include <algorithm>

#include <motionlang/datasets/motion_tokens.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/systems/tm2t.hpp>

#include "described_words.hpp"
#include "epoch_task.hpp"
#include "motion_batch.hpp"
#include "tm2t_config.hpp"

namespace program {

/// Numbers as constants of another backend.
template <ml::Backend T>
ml::Sequences<T> constants(const ml::Sequences<TrainingBackend>& x) {
  const auto numbers = x.rows.span();
  return {ml::Tensor<T, 2>::from(std::vector<float>(numbers.begin(), numbers.end()), x.rows.shape()), x.offsets};
}

/// Mean and deviation as the tokenizer has them: those of the features, each deviation the mean of its group as
/// HumanML3D has it, and then smaller for root and contacts.
/// folder   with Mean.npy and Std.npy, whose groups are made already; empty: of these motions
inline ml::Normalizer<TrainingBackend> tm2t_statistics(const DescribedMotions& data,
                                                       const std::filesystem::path& folder, double bias) {
  const ml::Index width = data.width, joints = (width + 1) / 12;
  auto out = statistics_of(folder, data);
  std::vector<double> std(out.std.span().begin(), out.std.span().end());
  if (folder.empty()) std = ml::group_means(std::move(std), ml::Guoh3dSlots{joints}.groups());
  std = ml::tm2t_deviation(std::move(std), joints, bias);
  out.std = ml::Tensor<TrainingBackend, 1>::from(std::vector<float>(std.begin(), std.end()), {width});
  out.eps = 0;
  return out;
}

// ---- the tokenizer ------------------------------------------------------------------------------------------------

/// Windows of all motions. Differs from the published program: parts of clips with texts of their own count as
/// motions, the last batch of an epoch is kept, and whole motions are validated with.
class TokenizerTask
    : public EpochTask<Tm2tTrainingConfig, ml::MotionTokenizer<TrainingTape>, ml::MotionTokenizer<TrainingBackend>> {
 public:
  TokenizerTask(const Tm2tTrainingConfig& config, const DescribedMotions& data, ml::Normalizer<B> statistics)
      : TokenizerTask(config, data, std::move(statistics), windows_of(config, data)) {}

  const ml::Normalizer<B>& statistics() const { return statistics_; }

  ml::LossTerms<A> loss(const ml::Philox&, ml::Index step, const ml::Context&) {
    MotionBatch<B> batch(statistics_);
    for (const ml::Index i : batches_(step, seed())) {
      const ml::ClipWindow& w = windows_[static_cast<std::size_t>(i)];
      batch.add(data_->training[static_cast<std::size_t>(w.clip)].rows, {w.start, config_.tokenizer.window});
    }
    const auto x = constants<A>(batch.normalized());
    const auto result = learner_.model(x);
    if (step < first_adversarial()) return ml::tokenizer_losses<A>(result, x);
    const auto made = x.with(ml::stop_gradient(result.reconstruction.rows));
    const auto real = discriminator_->train(x).logits, generated = discriminator_->train(made).logits;
    const double weight = config_.tokenizer.adversarial;
    judge_.config.lr = config_.optimiser.rate(step, steps());
    judge_.step(*discriminator_, ml::backward(ml::hinge_discriminator_loss(real, generated) * weight));
    return ml::tokenizer_losses<A>(result, x, &*discriminator_, weight);
  }
  /// The loss without the discriminator, and how many codes are in use, as it were.
  std::vector<Measure> validate() {
    double perplexity = 0;
    const double loss = over_validation([&](std::span<const ml::Index> which, const ml::Philox&) {
      MotionBatch<B> batch(statistics_);
      for (const ml::Index i : which) {
        const auto& rows = data_->validation[static_cast<std::size_t>(i)].rows;
        batch.add(rows, {0, std::ssize(rows) / data_->width / 4 * 4});
      }
      const auto x = batch.normalized();
      const auto result = learner_.average(x);
      perplexity += result.quantized.perplexity * static_cast<double>(which.size());
      return static_cast<double>(ml::tokenizer_losses<B>(result, x).total().item());
    });
    return {{"loss", loss}, {"perplexity", perplexity / static_cast<double>(data_->validation.size()), true}};
  }

  void add_to(ml::TensorStore& store) const {
    EpochTask::add_to(store);
    if (!discriminator_) return;
    store.add_module(*discriminator_, "discriminator.");
    add_moments(store, "discriminator_adam.", judge_);
  }
  void load(const ml::SafetensorsFile& file, ml::Index steps_done) {
    EpochTask::load(file, steps_done);
    if (!discriminator_) return;
    ml::load_module(*discriminator_, file, "discriminator.");
    restore_moments(judge_, *discriminator_, file, "discriminator_adam.",
                    std::max<ml::Index>(0, steps_done - first_adversarial()));
  }

 private:
  TokenizerTask(const Tm2tTrainingConfig& config, const DescribedMotions& data, ml::Normalizer<B> statistics,
                std::vector<ml::ClipWindow> windows)
      : EpochTask("tm2t tokenizer", config, data, std::ssize(windows)),
        windows_(std::move(windows)),
        statistics_(std::move(statistics)) {
    const auto& t = config_.tokenizer;
    auto init = ml::Philox{.seed = seed()}.split("init"), other = ml::Philox{.seed = seed()}.split("discriminator");
    begin(ml::MotionTokenizer<B>({.features = data.width,
                                  .channels = t.channels,
                                  .codes = t.codes,
                                  .residual_blocks = t.residual_blocks,
                                  .beta = t.beta},
                                 init));
    if (t.adversarial == 0) return;
    discriminator_ = ml::convert<A>(ml::VqDiscriminator<B>(data.width, t.discriminator, 2, other));
    judge_.config = config_.optimiser.adamw();
  }
  static std::vector<ml::ClipWindow> windows_of(const Tm2tTrainingConfig& config, const DescribedMotions& data) {
    std::vector<ml::Index> lengths;
    for (const DescribedMotion& m : data.training) lengths.push_back(std::ssize(m.rows) / data.width);
    auto out = ml::tm2t_windows(lengths, config.tokenizer.window);
    if (out.empty())
      ml::raise<ml::config_error>(
          102, "no motion to train on has more than tokenizer.window = ", ml::counted(config.tokenizer.window, "frame"),
          "; the longest has ", *std::max_element(lengths.begin(), lengths.end()));
    return out;
  }
  ml::Index first_adversarial() const {
    return discriminator_ ? config_.tokenizer.adversarial_from * batches_.per_epoch() : steps();
  }

  std::vector<ml::ClipWindow> windows_;
  ml::Normalizer<B> statistics_;
  std::optional<ml::VqDiscriminator<A>> discriminator_;
  ml::AdamW<A> judge_{};
};

// ---- tokens and words ---------------------------------------------------------------------------------------------

/// A text and the motion that it is about, as both are learnt.
struct TokenizedText {
  ml::TokenLines lines;  // from one frame on, from the next ...
  std::vector<ml::Index> words;
};
using TokenizedMotions = std::vector<std::vector<TokenizedText>>;  // texts of each motion

/// Tokens of every text's frames from each of the first four frames on that leave as many whole tokens, and its
/// words. What is longer than 196 frames is cut. Differs from the published program, which draws the first frame
/// five times for the whole clip.
inline TokenizedMotions tokenized(const std::vector<DescribedMotion>& motions, const ml::Tm2t<TrainingBackend>& model,
                                  const ml::GloVe& words, ml::Progress progress) {
  const ml::Index width = model.statistics.mean.size(0);
  TokenizedMotions out(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const DescribedMotion& m = motions[i];
    for (std::size_t k = 0; k < m.texts.size(); ++k) {
      const ml::FrameSlice frames = m.texts[k].frames;
      TokenizedText t{{}, ml::marked_words(words, words_of(m.texts[k], words))};
      const bool same = k > 0 && m.texts[k - 1].frames == frames;
      if (same) t.lines = out[i].back().lines;
      const ml::Index length = std::min(frames.length / 4 * 4, ml::tm2t_longest);
      for (ml::Index first = 0; !same && first < std::min<ml::Index>(4, frames.length - length + 1); ++first) {
        const auto begin = m.rows.begin() + (frames.first + first) * width;
        const std::vector<float> rows(begin, begin + length * width);
        const ml::Sequences<TrainingBackend> x{ml::Tensor<TrainingBackend, 2>::from(rows, {length, width}),
                                               ml::Offsets{length}};
        t.lines.push_back(model.tokens(x).ids);
      }
      out[i].push_back(std::move(t));
    }
    progress(static_cast<ml::Index>(i) + 1, std::ssize(motions));
  }
  return out;
}

struct TokenizedBatch {
  ml::IdSequences tokens, words;  // with their marks
};

/// What the stages behind the tokenizer learn from.
struct TokenizedData {
  ml::Tm2t<TrainingBackend> model;  // the tokenizer; for inverse alignment the transformer, too
  ml::GloVe words;
  TokenizedMotions training{}, validation{};

  void tokenize(const DescribedMotions& data, ml::Progress progress) {
    training = tokenized(data.training, model, words, progress);
    validation = tokenized(data.validation, model, words, progress);
  }
  /// draw: which text, which line, and whether a token is dropped; null: the first ones, and none.
  TokenizedBatch batch(const TokenizedMotions& of, std::span<const ml::Index> which, ml::Philox* draw) const {
    std::vector<std::vector<ml::Index>> tokens, said;
    const auto below = [&](std::size_t n) { return draw == nullptr ? 0 : draw->below(static_cast<std::uint32_t>(n)); };
    for (const ml::Index i : which) {
      const auto& texts = of[static_cast<std::size_t>(i)];
      const TokenizedText& text = texts[below(texts.size())];
      const auto& line = text.lines[below(text.lines.size())];
      const bool drop = draw != nullptr && line.size() > 1 && below(3) == 2;
      const auto what = !drop ? ml::TokenDrop::none : below(2) == 0 ? ml::TokenDrop::last : ml::TokenDrop::first;
      tokens.push_back(ml::marked_tokens(line, model.vocabulary(), what));
      said.push_back(text.words);
    }
    return {ml::IdSequences::from(tokens), ml::IdSequences::from(said)};
  }
  /// What a checkpoint has to have been trained with.
  void add_to(std::map<std::string, std::string>& settings) const {
    const auto codes = model.tokenizer.quantizer.embedding.weight.span();
    settings["tokenizer"] = ml::detail::hexadecimal(ml::detail::content_hash(std::as_bytes(codes)));
    std::string& all = settings["words"];
    for (const std::string& word : words.words()) all += word + "\n";
  }
};

/// How many symbols are written in sequences: all but the marks of beginning.
inline double written_symbols(const ml::IdSequences& x) { return static_cast<double>(std::ssize(x.ids) - x.count()); }

/// Share of the symbols that logits find most probable.
template <ml::Backend B>
double right_symbols(const ml::Tensor<B, 2>& logits, const ml::IdSequences& written) {
  const auto found = ml::arg_max(logits), wanted = written.without_ends(1, 0).ids;
  double right = 0;
  for (std::size_t i = 0; i < found.size(); ++i) right += found[i] == wanted[i] ? 1 : 0;
  return right / static_cast<double>(found.size());
}

/// What both stages behind the tokenizer have in common.
template <ml::Module Tape, ml::Module Plain>
class TokenTask : public EpochTask<Tm2tTrainingConfig, Tape, Plain> {
 public:
  using Base = EpochTask<Tm2tTrainingConfig, Tape, Plain>;

  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    tokens_->add_to(out);
    return out;
  }

 protected:
  TokenTask(std::string system, const Tm2tTrainingConfig& config, const DescribedMotions& data,
            const TokenizedData& tokens)
      : Base(std::move(system), config, data), tokens_(&tokens) {}

  TokenizedBatch batch(const ml::Philox& rng, ml::Index step) const {
    auto draw = rng.split("texts");
    return tokens_->batch(tokens_->training, this->batches_(step, this->seed()), &draw);
  }
  /// loss(batch): logits of what is written and the written; name: of the loss for each symbol.
  template <class F>
  std::vector<Measure> measured(const char* name, F logits_and_written) {
    double right = 0;
    const double loss = this->over_validation([&](std::span<const ml::Index> which, const ml::Philox&) {
      const auto [logits, written] = logits_and_written(tokens_->batch(tokens_->validation, which, nullptr));
      right += right_symbols(logits, written) * static_cast<double>(which.size());
      return static_cast<double>(ml::next_symbol_loss(logits, written).item()) / written_symbols(written);
    });
    return {{name, loss}, {"accuracy", right / static_cast<double>(tokens_->validation.size()), true}};
  }

  const TokenizedData* tokens_;
};

// ---- motions to texts ---------------------------------------------------------------------------------------------

inline ml::Seq2SeqConfig describer_sizes(const Tm2tDescriberConfig& c, const ml::MotionVocabulary& tokens,
                                         const ml::GloVe& words) {
  return {.source_symbols = tokens.size(),
          .target_symbols = words.size() + 1,
          .d_model = c.latent_dim,
          .d_inner = c.ff_size,
          .heads = c.num_heads,
          .head_width = c.latent_dim / c.num_heads,
          .encoder_layers = c.num_layers,
          .decoder_layers = c.num_layers,
          .dropout = c.dropout};
}

class DescriberTask : public TokenTask<ml::Seq2SeqTransformer<TrainingTape>, ml::Seq2SeqTransformer<TrainingBackend>> {
 public:
  DescriberTask(const Tm2tTrainingConfig& config, const DescribedMotions& data, const TokenizedData& tokens)
      : TokenTask("tm2t motion-to-text", config, data, tokens) {
    auto init = ml::Philox{.seed = seed()}.split("init");
    begin(ml::Seq2SeqTransformer<B>(describer_sizes(config_.motion_to_text, tokens.model.vocabulary(), tokens.words),
                                    init));
  }

  /// As published the sum over the words of the batch.
  ml::LossTerms<A> loss(const ml::Philox& rng, ml::Index step, const ml::Context& context) const {
    const auto b = batch(rng, step);
    ml::LossTerms<A> out;
    out.add("words", 1,
            ml::next_symbol_loss(logits_of(learner_.model, b, context), b.words, config_.motion_to_text.smoothing));
    return out;
  }
  std::vector<Measure> validate() {
    return measured("loss of a word",
                    [&](const TokenizedBatch& b) { return std::pair(logits_of(learner_.average, b, {}), b.words); });
  }

 private:
  template <ml::Backend T>
  static ml::Tensor<T, 2> logits_of(const ml::Seq2SeqTransformer<T>& model, const TokenizedBatch& b,
                                    const ml::Context& context) {
    return model.logits(b.words.without_ends(0, 1), model.encode(b.tokens, context), context);
  }
};

// ---- texts to motions ---------------------------------------------------------------------------------------------

class WriterTask : public TokenTask<ml::Seq2SeqGru<TrainingTape>, ml::Seq2SeqGru<TrainingBackend>> {
 public:
  /// With inverse alignment `tokens` has the transformer from motions to texts.
  WriterTask(const Tm2tTrainingConfig& config, const DescribedMotions& data, const TokenizedData& tokens)
      : TokenTask("tm2t text-to-motion", config, data, tokens) {
    const auto& c = config_.text_to_motion;
    for (const std::string& word : tokens.words.words()) {
      const auto row = tokens.words.vector(word);
      vectors_.insert(vectors_.end(), row.begin(), row.end());
    }
    if (c.alignment) describer_ = ml::convert<A>(tokens.model.m2t_transformer);
    auto init = ml::Philox{.seed = seed()}.split("init");
    begin(ml::Seq2SeqGru<B>({.word = tokens.words.width(),
                             .text_hidden = c.text_hidden,
                             .motion_hidden = c.motion_hidden,
                             .layers = c.layers,
                             .symbols = tokens.model.vocabulary().size(),
                             .late = c.late},
                            init));
  }

  /// As published an update by the tokens, made here, and another by what the describer says of what is written: the
  /// terms are both, the gradient is that of the second. The describer has dropout and is not trained.
  ml::LossTerms<A> loss(const ml::Philox& rng, ml::Index step, const ml::Context& context) {
    const auto& c = config_.text_to_motion;
    const auto b = batch(rng, step);
    const ml::TeacherForcing forcing{c.forced_first, c.forced_last, c.forced_epochs};
    const bool forced = rng.split("forced").uniform() < forcing(step / batches_.per_epoch());
    const auto words = vectors_of<A>(b.words);
    const auto tokens =
        ml::next_symbol_loss(learner_.model.logits(words, b.tokens.without_ends(0, 1), forced), b.tokens);
    ml::LossTerms<A> out;
    if (step < first_alignment()) {
      out.add("tokens", 1, tokens);
      return out;
    }
    out.add("tokens", 1, ml::Tensor<A, 0>(static_cast<double>(tokens.item())));
    update(ml::backward(tokens), step);
    auto noise = rng.split("noise");
    const ml::MotionVocabulary vocabulary = tokens_->model.vocabulary();
    out.add("words", 1,
            ml::inverse_alignment_loss(learner_.model, *describer_, words, b.words,
                                       {.begin = vocabulary.begin(), .end = vocabulary.end()}, noise, context));
    return out;
  }
  /// The model reads what it has written itself.
  std::vector<Measure> validate() {
    return measured("loss of a token", [&](const TokenizedBatch& b) {
      return std::pair(learner_.average.logits(vectors_of<B>(b.words), b.tokens.without_ends(0, 1), false), b.tokens);
    });
  }
  void load(const ml::SafetensorsFile& file, ml::Index steps_done) {
    TokenTask::load(file, steps_done + std::max<ml::Index>(0, steps_done - first_alignment()));  // updates
  }

 private:
  template <ml::Backend T>
  ml::Sequences<T> vectors_of(const ml::IdSequences& words) const {
    const ml::Index width = tokens_->words.width();
    std::vector<float> rows;
    for (const ml::Index id : words.ids)
      rows.insert(rows.end(), vectors_.begin() + id * width, vectors_.begin() + (id + 1) * width);
    return {ml::Tensor<T, 2>::from(rows, {std::ssize(words.ids), width}), words.offsets};
  }
  ml::Index first_alignment() const {
    return describer_ ? config_.text_to_motion.alignment_from * batches_.per_epoch() : steps();
  }

  std::vector<float> vectors_;  // of the words by their ids
  std::optional<ml::Seq2SeqTransformer<A>> describer_;
};

}  // namespace program
