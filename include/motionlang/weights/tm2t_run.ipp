// SPDX-License-Identifier: MIT
// Bodies of tm2t_run.hpp.
#pragma once

#include <motionlang/weights/tm2t_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY WeightFile tm2t_weights(const RunFolder& run) {
  if (run.system != "tm2t")
    raise<io_error>(404, run.folder.string(), ": ", run.system.empty() ? "of no known system" : "of " + run.system,
                    ", expected tm2t");
  if (run.weights.empty()) raise<io_error>(401, run.folder.string(), ": no model/finest.tar");
  return open_weights(run.weights, {.path = ""});
}

inline bool has_motion_tokenizer(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         tm2t_weights(run).find("quantizer.embedding.weight") != nullptr;
}

MOTIONLANG_BODY RunFolder tm2t_tokenizer_run(const RunFolder& run, const Tm2tRunOptions& options) {
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

MOTIONLANG_BODY FilePath tm2t_words(const RunFolder& run, const Tm2tRunOptions& options) {
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

MOTIONLANG_BODY MotionTokenizerConfig tm2t_tokenizer_config(const RunReader& r) {
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

MOTIONLANG_BODY Seq2SeqGruConfig tm2t_gru_config(const RunReader& r) {
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

MOTIONLANG_BODY Seq2SeqConfig tm2t_describer_config(const RunReader& r, const TensorSet& weights) {
  const std::string encoder = "encoder.layer_stack.", decoder = "decoder.layer_stack.",
                    target = "decoder.trg_word_emb.weight", projection = "trg_word_prj.weight";
  const bool symbols = r.has("encoder.src_word_emb.weight");  // or vectors
  Seq2SeqConfig c{.source_symbols = symbols ? r.size("encoder.src_word_emb.weight", 0) : 0,
                  .source_width = symbols ? 0 : r.size("encoder.emb.weight", 1),
                  .target_symbols = r.size(target, 0),
                  .d_model = symbols ? r.size("encoder.src_word_emb.weight", 1, {"d_model"})
                                     : r.size("encoder.emb.weight", 0, {"d_model"}),
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

}  // namespace detail

MOTIONLANG_BODY bool is_tm2t_generator(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         (detail::tm2t_weights(run).find("t2m_model.motion_decoder_step.input_emb.weight") != nullptr ||
          detail::tm2t_weights(run).find("t2m_transformer.encoder.position_enc.positional_encoding") != nullptr);
}

MOTIONLANG_BODY bool is_tm2t_describer(const RunFolder& run) {
  return run.system == "tm2t" && !run.weights.empty() &&
         detail::tm2t_weights(run).find("m2t_transformer.encoder.position_enc.positional_encoding") != nullptr;
}

MOTIONLANG_NAMESPACE_END
