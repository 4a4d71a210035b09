// SPDX-License-Identifier: MIT
/// The folder of a TM2T: the part that a stage has trained, with the parts trained before. It has the form of
/// weights/pack_run.hpp, which load_tm2t_run and similar functions read.
#pragma once

#include <filesystem>  // folders
#include <map>         // the record of a training
#include <string>      // the record of a training

#include <motionlang/features/normalizer.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/nn/seq2seq_transformer.hpp>
#include <motionlang/train/tm2t_config.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>
#include <motionlang/weights/glove_file.hpp>
#include <motionlang/weights/trained_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Parts that do not exist yet are null.
template <Backend B>
struct Tm2tParts {
  const MotionTokenizer<B>& tokenizer;
  const Normalizer<B>& statistics;
  const GloVe* words = nullptr;
  const Seq2SeqTransformer<B>* describer = nullptr;           // from motions to texts
  const Seq2SeqGru<B>* writer = nullptr;                      // from texts to motions
  const Seq2SeqTransformer<B>* transformer_writer = nullptr;  // likewise, the baseline
};

/// Writes the folder over the existing one. Throws what overwrite_model throws.
template <Backend B>
void save_tm2t(const std::filesystem::path& folder, const Tm2tTrainingConfig& config, double fps,
               const std::map<std::string, std::string>& about, const Tm2tParts<B>& m) {
  TensorStore store;
  store.add_module(m.tokenizer);
  store.add_module(m.statistics, "motion_normalizer.");
  if (m.describer != nullptr) store.add_module(*m.describer, "m2t_transformer.");
  if (m.writer != nullptr) store.add_module(*m.writer, "t2m_model.");
  if (m.transformer_writer != nullptr) store.add_module(*m.transformer_writer, "t2m_transformer.");
  auto model = described_model("tm2t", about);
  model.features = "guoh3dfeats";
  model.fps = fps;
  model.text_encoder = m.words != nullptr ? "glove" : "";
  if (m.describer != nullptr)
    model.config["n_head"] = m.describer->encoder.layer_stack.at(0).slf_attn.heads;  // no tensor shows it
  if (m.transformer_writer != nullptr)
    model.config["n_head"] = m.transformer_writer->encoder.layer_stack.at(0).slf_attn.heads;
  model.others["training"] = config_json(config);
  if (m.words != nullptr) {
    std::filesystem::create_directories(folder / "text_encoder");
    write_glove(folder / "text_encoder/our_vab", *m.words);
  }
  overwrite_model(folder, model, store);
}

MOTIONLANG_NAMESPACE_END
