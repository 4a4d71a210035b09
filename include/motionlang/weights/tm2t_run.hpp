// SPDX-License-Identifier: MIT
/// TM2T's models from texts to motions and from motions to texts, from the folders of its repository.
///
///     const auto run = load_tm2t_run<B>(find_run("checkpoints/t2m/T2M_Seq2Seq_NML1_Ear_SME0_N"));
///     const auto motions = run.model.generate(run.words.encode<B>(texts), Philox{.seed = 7});        // features
///     const auto other = load_tm2t_describer<B>(find_run("checkpoints/t2m/M2T_EL4_DL4_NH8_PS"));
///     const auto described = other.model.describe(features, other.words);
///
/// There are three places: the folder of the recurrent model or of the transformer (opt.txt, model/finest.tar); the
/// folder of the motion tokenizer, beside it (its checkpoint, meta/mean.npy, meta/std.npy); the word vectors
/// glove/our_vab_*, in one of the folders above.
///
/// Sizes    come from the shapes of the tensors, as does early or late attention. The options must agree with them. The
///          number of heads comes from the options; the default is 8
/// Differs  from the published program: `model` holds the parts in the folder and the tokenizer; its other parts are
///          empty
/// Source   TM2T networks/modules.py, networks/transformer.py, and the files that its training programs write
/// Throws   io_error 401 for a missing file, with all places searched; 404 for another model; 406, 407 for tensors;
///          config_error 102 if the parts do not match
#pragma once

#include <motionlang/systems/tm2t.hpp>
#include <motionlang/weights/detail/run_reader.hpp>
#include <motionlang/weights/glove_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Tm2tRun {
  Tm2t<B> model;
  GloVe words;
  double fps = 20;

  Index width() const { return model.statistics.mean.size(0); }
};

struct Tm2tRunOptions {
  FilePath tokenizer = "";  // its folder; by default searched beside the model
  FilePath words = "";      // the folder with our_vab_data.npy; by default searched in the folders above
};

namespace detail {

WeightFile tm2t_weights(const RunFolder& run);

/// The folder that the options name, else the only folder with a tokenizer beside the model.
RunFolder tm2t_tokenizer_run(const RunFolder& run, const Tm2tRunOptions& options);

FilePath tm2t_words(const RunFolder& run, const Tm2tRunOptions& options);

MotionTokenizerConfig tm2t_tokenizer_config(const RunReader& r);

Seq2SeqGruConfig tm2t_gru_config(const RunReader& r);

Seq2SeqConfig tm2t_describer_config(const RunReader& r, const TensorSet& weights);

/// The statistics of the features, in the weights of a packed run or in the folder of the tokenizer. Throws io_error
/// 401, 407.
template <Backend B>
Normalizer<B> tm2t_normalizer(const RunFolder& run, const TensorSet& weights, Index features) {
  return run_normalizer<B>(run, weights, features, {"meta.", ""},
                           "the motions: meta/mean.npy and meta/std.npy are missing");
}

}  // namespace detail

/// True if a run folder holds the model from texts to motions, false for the one from motions to texts.
bool is_tm2t_generator(const RunFolder& run);
bool is_tm2t_describer(const RunFolder& run);

/// The tokenizer alone, with its statistics, from its own folder or from a packed one.
template <Backend B>
Tm2t<B> load_tm2t_tokenizer(const RunFolder& run) {
  const WeightFile weights = detail::tm2t_weights(run);
  if (weights.find("quantizer.embedding.weight") == nullptr)
    raise<io_error>(404, weights.name(), ": not TM2T's motion tokenizer (vq_encoder, quantizer, vq_decoder)");
  const MotionTokenizerConfig config = detail::tm2t_tokenizer_config(detail::RunReader(run, weights, ""));
  Tm2t<B> out;
  const auto room = detail::room_of(weights);
  NoInit zeros;
  out.tokenizer = MotionTokenizer<B>(config, zeros);
  detail::load_run_module(
      out.tokenizer, weights, "",
      [](const std::string& name) {
        return !detail::begins_with_any(name, {"vq_encoder.", "quantizer.", "vq_decoder."});
      },
      LoadFor::inference);
  out.statistics = detail::tm2t_normalizer<B>(run, weights, config.features);
  out.statistics.eps = 0;
  return out;
}

namespace detail {

/// Everything except the folder's main model, which has this many motion symbols; 0: it reads features.
template <Backend B>
Tm2tRun<B> tm2t_around(const RunFolder& run, const WeightFile& weights, Index symbols, const Tm2tRunOptions& options) {
  const RunFolder tokenizer_run = tm2t_tokenizer_run(run, options);
  Tm2tRun<B> out{.model = load_tm2t_tokenizer<B>(tokenizer_run), .words = read_glove(tm2t_words(run, options))};
  if (out.width() == 251) out.fps = 12.5;
  const MotionVocabulary vocabulary = out.model.vocabulary();
  if (symbols != 0 && symbols != vocabulary.size())
    raise<config_error>(102, weights.name(), ": has ", counted(symbols, "motion symbol"), ", ",
                        tokenizer_run.weights.string(), " has ", counted(vocabulary.codes, "code"), " and three marks");
  return out;
}

}  // namespace detail

namespace detail {

/// The transformer of the paper's baseline (T), from texts to motions.
template <Backend B>
Tm2tRun<B> load_tm2t_transformer(const RunFolder& run, const WeightFile& weights, const Tm2tRunOptions& options) {
  const std::string prefix = "t2m_transformer.";
  const RunReader r(run, weights, prefix);
  if (r.has("encoder.src_word_emb.weight"))
    raise<io_error>(404, weights.name(), ": a transformer that reads numbers of words (t2m_v2), not their vectors");
  const Seq2SeqConfig config = tm2t_describer_config(r, weights);
  auto out = tm2t_around<B>(run, weights, config.target_symbols, options);
  if (config.source_width != out.words.width())
    raise<config_error>(102, weights.name(), ": reads word vectors of ", counted(config.source_width, "number"),
                        ", those found have ", out.words.width());
  const auto room = room_of(weights);
  NoInit zeros;
  out.model.t2m_transformer.emplace(config, zeros);
  load_run_module(
      *out.model.t2m_transformer, weights, prefix, [](const std::string&) { return false; }, LoadFor::inference);
  return out;
}

}  // namespace detail

template <Backend B>
Tm2tRun<B> load_tm2t_run(const RunFolder& run, const Tm2tRunOptions& options = {}) {
  const WeightFile weights = detail::tm2t_weights(run);
  if (weights.find("t2m_transformer.encoder.position_enc.positional_encoding") != nullptr)
    return detail::load_tm2t_transformer<B>(run, weights, options);
  const std::string prefix = "t2m_model.";
  const detail::RunReader r(run, weights, prefix);
  if (!r.has("motion_decoder_step.input_emb.weight"))
    raise<io_error>(404, weights.name(), ": not TM2T's recurrent model from texts to motions (t2m_model)");
  const Seq2SeqGruConfig gru = detail::tm2t_gru_config(r);
  auto out = detail::tm2t_around<B>(run, weights, gru.symbols, options);
  if (gru.word != out.words.width())
    raise<config_error>(102, weights.name(), ": reads word vectors of ", counted(gru.word, "number"),
                        ", those found have ", out.words.width());
  const auto room = detail::room_of(weights);
  NoInit zeros;
  out.model.t2m_model = Seq2SeqGru<B>(gru, zeros);
  detail::load_run_module(
      out.model.t2m_model, weights, prefix, [](const std::string&) { return false; }, LoadFor::inference);
  return out;
}

template <Backend B>
Tm2tRun<B> load_tm2t_describer(const RunFolder& run, const Tm2tRunOptions& options = {}) {
  const WeightFile weights = detail::tm2t_weights(run);
  const std::string prefix = "m2t_transformer.";
  const detail::RunReader r(run, weights, prefix);
  if (!r.has("encoder.src_word_emb.weight") && !r.has("encoder.emb.weight"))
    raise<io_error>(404, weights.name(), ": not TM2T's transformer from motions to texts (m2t_transformer)");
  const Seq2SeqConfig config = detail::tm2t_describer_config(r, weights);
  auto out = detail::tm2t_around<B>(run, weights, config.source_symbols, options);
  if (config.source_symbols == 0 && config.source_width != 4 * out.width())
    raise<config_error>(102, weights.name(), ": reads four frames of ", counted(config.source_width, "number"),
                        ", the motions have ", 4 * out.width());
  if (config.target_symbols != out.words.size() + 1)
    raise<config_error>(102, weights.name(), ": writes ", counted(config.target_symbols, "symbol"),
                        ", the words found are ", out.words.size(), " and one for padding");
  const auto room = detail::room_of(weights);
  NoInit zeros;
  out.model.m2t_transformer = Seq2SeqTransformer<B>(config, zeros);
  detail::load_run_module(
      out.model.m2t_transformer, weights, prefix, [](const std::string&) { return false; }, LoadFor::inference);
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/tm2t_run.ipp>
#endif
