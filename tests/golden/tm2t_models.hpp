// TM2T's models in golden cases: built from the config, filled from weights/.
#pragma once

#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/nn/seq2seq_transformer.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

#include "tensors.hpp"

namespace golden {

using ml::Index;

inline ml::MotionTokenizerConfig tokenizer_config(const ml::JsonView& config) {
  return {.features = config["dim_pose"].as<Index>(),
          .channels = config["channels"].as<std::vector<Index>>(),
          .codes = config["codebook"].as<Index>(),
          .residual_blocks = config.value_or("n_resblk", Index{0}),
          .beta = config.value_or("beta", 1.0)};
}
/// The parts that the case has weights of.
template <ml::Backend B>
ml::MotionTokenizer<B> motion_tokenizer(const Case& c) {
  ml::Philox rng;
  ml::MotionTokenizer<B> m(tokenizer_config(c.config()), rng);
  ml::load_module(m.vq_encoder, c.file(), "weights/vq_encoder.");
  ml::load_module(m.quantizer, c.file(), "weights/quantizer.");
  if (!c.names("weights/vq_decoder.").empty()) ml::load_module(m.vq_decoder, c.file(), "weights/vq_decoder.");
  return m;
}

/// The configuration for "kind": m2t (motion tokens to words), m2t_v3 (decoder reads word vectors), t2m (word vectors
/// to motion tokens), t2m_v2 (word ids).
inline ml::Seq2SeqConfig seq2seq_config(const ml::JsonView& config) {
  const auto kind = config["kind"].as<std::string>();
  const Index words = config["text_words"].as<Index>() + 1, tokens = config["codebook"].as<Index>() + 3;
  const Index vector = config.value_or("d_word_vec", Index{0});
  const bool to_text = kind.starts_with("m2t");
  return {.source_symbols = kind == "t2m" ? 0
                            : to_text     ? tokens
                                          : words,
          .source_width = kind == "t2m" ? vector : 0,
          .target_symbols = to_text ? words : tokens,
          .target_width = kind == "m2t_v3" ? vector : 0,
          .d_model = config["d_model"].as<Index>(),
          .d_inner = config["d_inner"].as<Index>(),
          .heads = config["n_head"].as<Index>(),
          .head_width = config["d_k"].as<Index>(),
          .value_width = config.value_or("d_v", Index{0}),
          .encoder_layers = config["n_enc_layers"].as<Index>(),
          .decoder_layers = config["n_dec_layers"].as<Index>(),
          .source_positions = config["n_src_position"].as<Index>(),
          .target_positions = config["n_trg_position"].as<Index>(),
          .shared_projection = config["proj_share_weight"].as<bool>()};
}
template <ml::Backend B>
ml::Seq2SeqTransformer<B> seq2seq_transformer(const Case& c, const ml::JsonView& config,
                                              const std::string& prefix = "weights/") {
  ml::Philox rng;
  ml::Seq2SeqTransformer<B> m(seq2seq_config(config), rng);
  ml::load_module(m, c.file(), prefix);
  return m;
}

template <ml::Backend B>
ml::Seq2SeqGru<B> seq2seq_gru(const Case& c, const std::string& prefix = "weights/") {
  const auto config = c.config();
  ml::Philox rng;
  ml::Seq2SeqGru<B> m({.word = config["dim_word"].as<Index>(),
                       .text_hidden = config["dim_txt_hid"].as<Index>(),
                       .motion_hidden = config["dim_mot_hid"].as<Index>(),
                       .layers = config["n_mot_layers"].as<Index>(),
                       .symbols = config["codebook"].as<Index>() + 3,
                       .late = config["early_or_late"].as<std::string>() == "late"},
                      rng);
  ml::load_module(m, c.file(), prefix);
  return m;
}

/// in/NAME (batch, n) without the padding.
inline ml::IdSequences ids(const Case& c, const std::string& name, Index pad) {
  return ml::IdSequences::from_padded(c.values<Index>(name), c.shape(name)[1], pad);
}
/// in/NAME (batch, n) with the padding as if it were symbols, without the last ids.
inline ml::IdSequences padded_ids(const Case& c, const std::string& name, Index without_last = 0) {
  const auto shape = c.shape(name);
  return ml::IdSequences(c.values<Index>(name), ml::Offsets::equal(shape[0], shape[1])).without_ends(0, without_last);
}
/// 1 where an id is not the padding.
inline std::vector<unsigned char> visible_ids(const ml::IdSequences& list, Index pad) {
  std::vector<unsigned char> out;
  for (const Index id : list.ids) out.push_back(id != pad ? 1 : 0);
  return out;
}
/// 1 for the first lengths[i] - less of `longest`.
inline std::vector<unsigned char> visible_rows(const Case& c, const std::string& lengths, Index longest,
                                               Index less = 0) {
  std::vector<unsigned char> out;
  for (const Index n : c.values<Index>(lengths)) {
    for (Index i = 0; i < longest; ++i) out.push_back(i < n - less ? 1 : 0);
  }
  return out;
}

/// Sequences of one length, of which other rows see only those of a mask. The library leaves the others out; the
/// published outputs have rows for them, too.
template <ml::Backend B>
ml::Sequences<B> masked(const ml::Sequences<B>& x, std::span<const unsigned char> mask) {
  return ml::from_padded(ml::reshape<3>(x.rows, {x.count(), x.offsets.length(0), x.width()}), mask);
}
template <ml::Backend B>
ml::Sequences<B> padded_encoder(const ml::Seq2SeqEncoder<B>& m, const ml::Sequences<B>& embedded,
                                std::span<const unsigned char> mask) {
  auto x = ml::detail::seq2seq_input(embedded, m.position_enc);
  for (const auto& layer : m.layer_stack) x.rows = layer(x, masked(x, mask));
  return x;
}
template <ml::Backend B, class Target>
ml::Tensor<B, 3> padded_logits(const ml::Seq2SeqTransformer<B>& m, const Target& target,
                               std::span<const unsigned char> mask, const ml::Sequences<B>& memory) {
  auto x = ml::detail::seq2seq_input(m.embed_target(target), m.decoder.position_enc);
  for (const auto& layer : m.decoder.layer_stack) x.rows = layer(x, masked(x, mask), memory);
  return ml::reshape<3>(m.project(x.rows), {x.count(), x.offsets.length(0), -1});
}

/// The loss as published, a sum, and how many symbols were the most probable ones.
template <ml::Backend B>
ml::Tensor<B, 0> out_summed_loss(Case& c, const ml::Tensor<B, 2>& logits, const std::vector<Index>& wanted,
                                 double smoothing = 0) {
  const auto best = ml::arg_max(logits);
  Index correct = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) correct += best[i] == wanted[i] ? 1 : 0;
  c.out("n_correct", {}, std::vector<Index>{correct});
  c.out("n_word", {}, std::vector<Index>{std::ssize(wanted)});
  const auto loss = ml::sum(ml::cross_entropies(logits, wanted, smoothing));
  out(c, "loss", loss);
  return loss;
}

}  // namespace golden
