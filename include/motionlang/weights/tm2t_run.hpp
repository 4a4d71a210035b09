// SPDX-License-Identifier: MIT
/// TM2T's models from texts to motions and from motions to texts from the folders in which its repository leaves them.
///
///     const auto run = load_tm2t_run<B>(find_run("checkpoints/t2m/T2M_Seq2Seq_NML1_Ear_SME0_N"));
///     const auto motions = run.model.generate(run.words.encode<B>(texts), Philox{.seed = 7});        // features
///     const auto other = load_tm2t_describer<B>(find_run("checkpoints/t2m/M2T_EL4_DL4_NH8_PS"));
///     const auto texts = other.model.describe(features, other.words);
///
/// Three places: the folder of the recurrent model or of the transformer (opt.txt, model/finest.tar); the one of the
/// motion tokenizer, beside it (its checkpoint, meta/mean.npy, meta/std.npy); the word vectors glove/our_vab_*, in one
/// of the folders above.
///
/// Sizes    from the shapes of the tensors; early or late attention, too, which the options have to agree with. The
///          number of heads from the options, 8 unless they say it
/// Differs  from the published program: `model` has what is in the folder and the tokenizer; the rest of it is empty
/// Source   spec tm2t.md 1, 2, 4.1, 5, 6
/// Throws   io_error 401 for what is missing, saying where it was looked for; 404 for another model; 406, 407 for
///          tensors; config_error 102 where the parts do not fit each other
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
  FilePath tokenizer = "";  // its folder; looked for beside the model unless given
  FilePath words = "";      // the folder with our_vab_data.npy; looked for in the folders above unless given
};

namespace detail {

inline WeightFile tm2t_weights(const RunFolder& run) {
  if (run.system != "tm2t")
    raise<io_error>(404, run.folder.string(), ": ",
                    run.system.empty() ? "of no system that is known" : "of " + run.system, ", expected tm2t");
  if (run.weights.empty()) raise<io_error>(401, run.folder.string(), ": no model/finest.tar");
  return open_weights(run.weights, {.path = ""});
}
inline bool has_motion_tokenizer(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         tm2t_weights(run).find("quantizer.embedding.weight") != nullptr;
}

/// The folder that the options name, else the only one beside the model that has a tokenizer.
inline RunFolder tm2t_tokenizer_run(const RunFolder& run, const Tm2tRunOptions& options) {
  namespace fs = std::filesystem;
  if (!options.tokenizer.string().empty()) return motionlang::find_run(options.tokenizer);
  if (run.packed) return run;
  const fs::path around = folder_around(run.folder);
  std::vector<RunFolder> found;
  for (const fs::path& folder : listed(around.empty() ? fs::path(".") : around)) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) continue;
    RunFolder other = motionlang::find_run(folder);
    if (!has_motion_tokenizer(other)) continue;
    for (const char* key : {"tokenizer_name", "tokenizer_name_motion"}) {
      const FileValue* named = run.option(key);
      if (named != nullptr && to_string(*named) == folder.filename().string()) return other;
    }
    found.push_back(std::move(other));
  }
  if (found.size() == 1) return std::move(found.front());
  raise<io_error>(401, run.folder.string(), ": ", counted(found.size(), "folder"),
                  " with a motion tokenizer beside it (",
                  "VQVAEV3_CB1024_CMT_H1024_NRES3 as published): put it there, or name it");
}

inline FilePath tm2t_words(const RunFolder& run, const Tm2tRunOptions& options) {
  namespace fs = std::filesystem;
  std::vector<fs::path> places;
  if (!options.words.string().empty()) {
    places.emplace_back(options.words.string());
  } else {
    fs::path folder = fs::absolute(run.folder).lexically_normal();
    for (int up = 0; up < 5 && folder != folder.root_path(); ++up, folder = folder.parent_path()) {
      places.push_back(folder);
      places.push_back(folder / "glove");
      if (run.packed) places.push_back(folder / "text_encoder");
    }
  }
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (fs::is_regular_file(place / "our_vab_data.npy", ignored)) return place / "our_vab";
  }
  raise<io_error>(401, run.folder.string(),
                  ": no word vectors: put glove/our_vab_data.npy, our_vab_words.pkl and our_vab_idx.pkl "
                  "in a folder above, or name their folder");
}

inline MotionTokenizerConfig tm2t_tokenizer_config(const RunReader& r) {
  MotionTokenizerConfig c;
  c.channels.clear();
  const std::string encoder = "vq_encoder.main.", decoder = "vq_decoder.main.";
  for (Index i = 0; r.has(concat_text(encoder, i, ".weight"));
       i += 3)  // a convolution, its activation, a residual block
    c.channels.push_back(r.size(concat_text(encoder, i, ".weight"), 0));
  c.features = r.size(encoder + "0.weight", 1) + 4;
  c.codes = r.size("quantizer.embedding.weight", 0);
  c.residual_blocks = r.count(decoder, ".model.0.weight", {"n_resblk"});
  return c;
}

inline Seq2SeqGruConfig tm2t_gru_config(const RunReader& r) {
  const std::string step = "motion_decoder_step.";
  Seq2SeqGruConfig c{.word = r.size("text_encoder.input_emb.weight", 1),
                     .text_hidden = r.size("text_encoder.gru.weight_hh_l0", 1, {"dim_txt_hid"}),
                     .motion_hidden = r.size(step + "input_emb.weight", 1, {"dim_mot_hid"}),
                     .layers = r.count(step + "gru.", ".weight_ih", {"n_mot_layers"}),
                     .symbols = r.size(step + "input_emb.weight", 0),
                     .late = r.has(step + "att_linear.3.weight")};
  if (const std::string stated = r.one_of("early_or_late", c.late ? "late" : "early", {"early", "late"});
      (stated == "late") != c.late)
    raise<config_error>(102, r.place("early_or_late"), " is ", stated, ", the tensors are those of ",
                        c.late ? "late" : "early", " attention");
  return c;
}

inline Seq2SeqConfig tm2t_describer_config(const RunReader& r, const TensorSet& weights) {
  const std::string encoder = "encoder.layer_stack.", decoder = "decoder.layer_stack.",
                    target = "decoder.trg_word_emb.weight", projection = "trg_word_prj.weight";
  Seq2SeqConfig c{.source_symbols = r.size("encoder.src_word_emb.weight", 0),
                  .target_symbols = r.size(target, 0),
                  .d_model = r.size("encoder.src_word_emb.weight", 1, {"d_model"}),
                  .d_inner = r.size(encoder + "0.pos_ffn.w_1.weight", 0),
                  .heads = r.number({"n_head"}, 8, 4096),
                  .encoder_layers = r.count(encoder, ".slf_attn.w_qs.weight", {"n_enc_layers"}),
                  .decoder_layers = r.count(decoder, ".slf_attn.w_qs.weight", {"n_dec_layers"}),
                  .source_positions = r.size("encoder.position_enc.positional_encoding", 0),
                  .target_positions = r.size("decoder.position_enc.positional_encoding", 0)};
  if (r.has(projection)) {
    if (r.size(projection, 0) != c.target_symbols)
      raise<io_error>(404, weights.name(), ": writes ", counted(r.size(projection, 0), "word"),
                      " and reads vectors of ", counted(r.size(target, 1), "number"),
                      " (m2t_v3), which cannot write word by word");
    const auto numbers = [&](const std::string& name) { return values_of<float>(weights.tensor(r.prefix() + name)); };
    c.shared_projection = numbers(projection) == numbers(target);
  }
  const auto of_a_head = [&](const char* layer, const char* what) {
    const Index width = r.size(encoder + "0.slf_attn." + layer + ".weight", 0);
    if (width % c.heads != 0)
      raise<config_error>(102, r.place("n_head"), " is ", c.heads, ", ", weights.name(), " has ", what, " of ",
                          counted(width, "number"));
    return width / c.heads;
  };
  c.head_width = of_a_head("w_qs", "queries");
  c.value_width = of_a_head("w_vs", "values");
  return c;
}

/// Those of the features, in the weights of a packed run or in the folder of the tokenizer. Throws io_error 401, 407.
template <Backend B>
Normalizer<B> tm2t_normalizer(const RunFolder& run, const TensorSet& weights, Index features) {
  return run_normalizer<B>(run, weights, features, {"meta.", ""},
                           "the motions: meta/mean.npy and meta/std.npy are missing");
}

}  // namespace detail

/// Whether a run folder holds the model from texts to motions, or the one from motions to texts.
inline bool is_tm2t_generator(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         detail::tm2t_weights(run).find("t2m_model.motion_decoder_step.input_emb.weight") != nullptr;
}
inline bool is_tm2t_describer(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         detail::tm2t_weights(run).find("m2t_transformer.encoder.src_word_emb.weight") != nullptr;
}

/// The tokenizer alone, with its statistics, of its own folder or of a packed one.
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

/// Everything but the model that the folder is named after, which knows so many symbols of motions.
template <Backend B>
Tm2tRun<B> tm2t_around(const RunFolder& run, const WeightFile& weights, Index symbols, const Tm2tRunOptions& options) {
  const RunFolder tokenizer_run = tm2t_tokenizer_run(run, options);
  Tm2tRun<B> out{.model = load_tm2t_tokenizer<B>(tokenizer_run), .words = read_glove(tm2t_words(run, options))};
  if (out.width() == 251) out.fps = 12.5;
  const MotionVocabulary vocabulary = out.model.vocabulary();
  if (symbols != vocabulary.size())
    raise<config_error>(102, weights.name(), ": has ", counted(symbols, "motion symbol"), ", ",
                        tokenizer_run.weights.string(), " has ", counted(vocabulary.codes, "code"), " and three marks");
  return out;
}

}  // namespace detail

template <Backend B>
Tm2tRun<B> load_tm2t_run(const RunFolder& run, const Tm2tRunOptions& options = {}) {
  const WeightFile weights = detail::tm2t_weights(run);
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
  if (!r.has("encoder.src_word_emb.weight"))
    raise<io_error>(404, weights.name(), ": not TM2T's transformer from motions to texts (m2t_transformer)");
  const Seq2SeqConfig config = detail::tm2t_describer_config(r, weights);
  auto out = detail::tm2t_around<B>(run, weights, config.source_symbols, options);
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
