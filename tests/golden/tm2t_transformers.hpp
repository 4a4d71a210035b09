// Golden functions: TM2T's transformers from motion to text and from text to motion, with gradients through Autodiff. A
// source for each backend registers them: together they would take long to compile.
#pragma once

#include <motionlang/backend/autodiff.hpp>

#include "tm2t_models.hpp"

namespace golden::tm2t_transformers {

/// Encoder output and logits with their padding, and the loss of packed sequences.
template <ml::Backend B>
void transformer(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  const auto kind = config["kind"].template as<std::string>();
  const auto m = ml::convert<A>(golden::seq2seq_transformer<B>(c, config));
  const Index word_pad = config["text_words"].template as<Index>(),
              token_pad = config["codebook"].template as<Index>() + 2;
  const bool to_text = kind.starts_with("m2t");
  const std::string target_name = to_text ? "in/word_ids" : "in/motion_ids";
  const std::string source_name = to_text ? "in/motion_ids" : "in/word_ids";
  const Index target_pad = to_text ? word_pad : token_pad, source_pad = to_text ? token_pad : word_pad;
  const double smoothing = config.value_or("label_smoothing", false) ? 0.1 : 0;

  ml::Sequences<A> all, memory;  // the encoder's output with padding, and without
  if (kind == "t2m") {
    const auto lengths = c.values<Index>("in/text_lengths");
    const auto vectors = tensor<A, 3>(c, "in/word_emb");
    const auto embedded = ml::from_equal(vectors);
    const auto mask = golden::visible_rows(c, "in/text_lengths", vectors.size(1));
    all = golden::padded_encoder(m.encoder, embedded.with((*m.encoder.emb)(embedded.rows)), mask);
    memory = m.encode(ml::from_padded(vectors, std::span<const Index>(lengths)));
  } else {
    const auto source = golden::padded_ids(c, source_name);
    const auto mask = golden::visible_ids(source, source_pad);
    all = golden::padded_encoder(m.encoder, {(*m.encoder.src_word_emb)(source.ids), source.offsets}, mask);
    memory = m.encode(golden::ids(c, source_name, source_pad));
  }
  golden::out(c, "encoder_output", ml::to_padded(all));

  const auto target = golden::ids(c, target_name, target_pad);
  const auto padded = golden::padded_ids(c, target_name, 1);
  ml::Tensor<A, 2> logits;
  if (kind == "m2t_v3") {
    const auto vectors = tensor<A, 3>(c, "in/word_emb");
    const auto inputs = ml::slice(vectors, 1, 0, vectors.size(1) - 1);
    const auto mask = golden::visible_rows(c, "in/text_lengths", inputs.size(1), 1);
    golden::out(c, "logits", golden::padded_logits(m, ml::from_equal(inputs), mask, memory));
    logits = m.logits(ml::from_padded(inputs, std::span<const unsigned char>(mask)), memory);
  } else {
    golden::out(c, "logits", golden::padded_logits(m, padded, golden::visible_ids(padded, target_pad), memory));
    logits = m.logits(target.without_ends(0, 1), memory);
  }
  golden::out_gradients(c, m, golden::out_summed_loss(c, logits, target.without_ends(1, 0).ids, smoothing));
}

template <ml::Backend B>
void one_hot_source(Case& c) {
  const auto m = golden::seq2seq_transformer<B>(c, c.config());
  const Index word_pad = c.config()["text_words"].as<Index>(), token_pad = c.config()["codebook"].as<Index>() + 2;
  const auto lengths = c.values<Index>("in/lengths");
  const auto target = golden::padded_ids(c, "in/word_ids", 1);
  auto result = [&](const std::string& name, const ml::Sequences<B>& memory) {
    golden::out(c, name, golden::padded_logits(m, target, golden::visible_ids(target, word_pad), memory));
  };
  auto shares = [&](const std::string& name) {
    return ml::from_padded(tensor<B, 3>(c, name), std::span<const Index>(lengths));
  };
  result("logits_ids", m.encode(golden::ids(c, "in/motion_ids", token_pad)));
  result("logits_onehot", m.encode_shares(shares("in/onehot")));
  result("logits_soft", m.encode_shares(shares("in/soft")));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"tm2t motion2text transformer", variant, transformer<B>},
          {"tm2t motion2text transformer with word vectors", variant, transformer<B>},
          {"tm2t text2motion transformer", variant, transformer<B>},
          {"tm2t text2motion transformer with word ids", variant, transformer<B>},
          {"tm2t one-hot source", variant, one_hot_source<B>}};
}

}  // namespace golden::tm2t_transformers
