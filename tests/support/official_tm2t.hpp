// SPDX-License-Identifier: MIT
/// The folders of TM2T as its repository leaves them, with drawn weights: the models from texts to motions and from
/// motions to texts, the tokenizer, word vectors.
#pragma once

#include <motionlang/weights/tm2t_run.hpp>

#include "glove_files.hpp"
#include "official_folders.hpp"

namespace official {

inline ml::Tm2tConfig small_tm2t() {
  return {.tokenizer = {.channels = {6, 8}, .codes = 10, .residual_blocks = 2},
          .motion_to_text = {.source_symbols = 13,
                             .target_symbols = 8,
                             .d_model = 8,
                             .d_inner = 12,
                             .heads = 2,
                             .head_width = 4,
                             .encoder_layers = 2,
                             .decoder_layers = 1},
          .text_to_motion = {.word = 4, .text_hidden = 5, .motion_hidden = 12, .symbols = 13}};
}
inline ml::Tm2t<B> tm2t(const ml::Tm2tConfig& c) {
  ml::Philox rng{.seed = 91}, other{.seed = 92}, third{.seed = 93};
  ml::Tm2t<B> out;
  out.tokenizer = ml::MotionTokenizer<B>(c.tokenizer, rng);
  out.t2m_model = ml::Seq2SeqGru<B>(c.text_to_motion, other);
  out.m2t_transformer = ml::Seq2SeqTransformer<B>(c.motion_to_text, third);
  out.statistics = statistics(c.tokenizer.features, 7);
  out.statistics.eps = 0;
  return out;
}
inline const std::vector<std::string> tm2t_words{"sos", "eos", "unk", "a", "person", "walk", "turn"};
inline std::vector<float> tm2t_vectors() {
  std::vector<float> out;
  for (int i = 0; i < 28; ++i) out.push_back(0.1f * static_cast<float>(i % 9 - 4));
  return out;
}

/// checkpoints/t2m/{T2M_Seq2Seq, M2T_EL2_DL1_NH2_PS, VQVAEV3} and glove in a folder; returns the first.
inline fs::path write_tm2t_runs(const fs::path& folder, const ml::Tm2tConfig& c) {
  const auto model = tm2t(c);
  const fs::path runs = folder / "checkpoints/t2m", t2m = runs / "T2M_Seq2Seq", m2t = runs / "M2T_EL2_DL1_NH2_PS",
                 tokenizer = runs / "VQVAEV3";
  const std::string banner = "------------ Options -------------\n", end = "-------------- End ----------------\n";
  write_text(t2m / "opt.txt", ml::concat_text(banner, "batch_size: 64\ndim_mot_hid: ", c.text_to_motion.motion_hidden,
                                              "\nearly_or_late: early\nis_train: True\nn_mot_layers: 1\n", end));
  write_text(tokenizer / "opt.txt",
             ml::concat_text(banner, "n_down: 2\nn_resblk: ", c.tokenizer.residual_blocks, "\n", end));
  TorchArchive archive;
  archive.begin("t2m_model");
  add_module(archive, model.t2m_model);
  const auto& embedding = model.t2m_model.motion_decoder_step.input_emb.weight;
  archive.tensor(
      "motion_decoder_step.trg_word_prj.weight",
      {.name = "", .dtype = ml::DType::F32, .shape = embedding.shape(), .bytes = std::as_bytes(embedding.span())});
  archive.end();
  archive.begin("opt_t2m_model");
  add_zeros(archive, "moment", {3});
  archive.end();
  archive.number("ep", 10);
  write_bytes(t2m / "model/finest.tar", archive.finish());
  write_text(m2t / "opt.txt", ml::concat_text(banner, "d_model: ", c.motion_to_text.d_model, "\nn_head: ",
                                              c.motion_to_text.heads, "\nproj_share_weight: True\n", end));
  TorchArchive words;
  words.begin("m2t_transformer");
  add_module(words, model.m2t_transformer);
  const auto& symbols = model.m2t_transformer.decoder.symbols->weight;
  words.tensor("trg_word_prj.weight",
               {.name = "", .dtype = ml::DType::F32, .shape = symbols.shape(), .bytes = std::as_bytes(symbols.span())});
  words.end();
  words.begin("opt_m2t_transformer");
  add_zeros(words, "moment", {3});
  words.end();
  write_bytes(m2t / "model/finest.tar", words.finish());
  TorchArchive other;
  other.begin("vq_encoder");
  add_module(other, model.tokenizer.vq_encoder);
  other.end();
  other.begin("quantizer");
  add_module(other, model.tokenizer.quantizer);
  other.end();
  other.begin("vq_decoder");
  add_module(other, model.tokenizer.vq_decoder);
  other.end();
  other.begin("discriminator");
  add_zeros(other, "out_net.bias", {1});
  other.end();
  write_bytes(tokenizer / "model/finest.tar", other.finish());
  write_npy_statistics(tokenizer / "meta", model.statistics, "mean.npy", "std.npy");
  fs::create_directories(folder / "glove");
  glove_files::write((folder / "glove/our_vab").string(), tm2t_words, tm2t_words, tm2t_vectors());
  return t2m;
}

}  // namespace official
