// SPDX-License-Identifier: MIT
/// Tiny text networks for tests: their state dicts with weights by a formula.
#pragma once

#include <cmath>
#include <map>

#include <motionlang/weights/text_network_file.hpp>

namespace text_networks {

namespace ml = motionlang;
using ml::Index;
using ml::Shape;
using Shapes = std::map<std::string, Shape>;  // in the order of bytes, as the formula wants
using Numbers = std::map<std::string, std::pair<Shape, std::vector<double>>>;

/// Element i of tensor k is 0.3 sin(0.7 k + 0.31 i + 0.01 i^2), and one more in the gains of norms.
inline Numbers by_formula(const Shapes& shapes) {
  Numbers out;
  double k = 0;
  for (const auto& [name, shape] : shapes) {
    std::vector<double> values;
    for (Index n = 0; n < shape.count(); ++n) {
      const auto i = static_cast<double>(n);
      values.push_back(0.3 * std::sin(0.7 * k + 0.31 * i + 0.01 * i * i) +
                       (shape.rank() == 1 && name.ends_with("weight") ? 1 : 0));
    }
    out[name] = {shape, std::move(values)};
    ++k;
  }
  return out;
}

/// A file in memory that keeps its bytes.
inline ml::SafetensorsFile file_of(const Numbers& numbers, ml::DType dtype = ml::DType::F64) {
  ml::TensorStore store;
  for (const auto& [name, t] : numbers) store.add(name, t.first, std::span<const double>(t.second), dtype);
  const auto bytes = std::make_shared<const std::vector<std::byte>>(ml::safetensors_bytes(store.views(), {}));
  return ml::SafetensorsFile::from_bytes(*bytes, "tiny.safetensors", bytes);
}

inline void add_linear(Shapes& s, const std::string& name, Index in, Index out) {
  s[name + ".weight"] = {out, in};
  s[name + ".bias"] = {out};
}
inline void add_norm(Shapes& s, const std::string& name, Index width) {
  s[name + ".weight"] = s[name + ".bias"] = {width};
}

inline constexpr ml::BertConfig tiny_bert{
    .vocabulary = 20, .width = 8, .heads = 2, .d_ff = 16, .layers = 2, .positions = 16};
inline constexpr ml::BertConfig tiny_mpnet{
    .vocabulary = 20, .width = 8, .heads = 2, .d_ff = 16, .layers = 2, .positions = 16, .padding = 1, .eps = 1e-5};
inline constexpr ml::ClipTextConfig tiny_clip{
    .vocabulary = 20, .width = 8, .heads = 2, .d_ff = 32, .layers = 2, .context = 9, .out = 6};

template <class Keys>
Shapes bert_shapes() {
  constexpr ml::BertConfig c = tiny_bert;
  Shapes s{{"embeddings.word_embeddings.weight", {c.vocabulary, c.width}},
           {"embeddings.position_embeddings.weight", {c.positions, c.width}}};
  add_norm(s, "embeddings.LayerNorm", c.width);
  if (Keys::token_types) s["embeddings.token_type_embeddings.weight"] = {c.token_types, c.width};
  if (Keys::relative_scores) s["encoder.relative_attention_bias.weight"] = {c.buckets, c.heads};
  if (!std::is_same_v<Keys, ml::DistilBertKeys>) add_linear(s, "pooler.dense", c.width, c.width);
  for (Index i = 0; i < c.layers; ++i) {
    const std::string layer = ml::concat_text(Keys::layers, ".", i, ".");
    for (const char* name : {Keys::query, Keys::key, Keys::value, Keys::attended})
      add_linear(s, layer + name, c.width, c.width);
    add_linear(s, layer + Keys::up, c.width, c.d_ff);
    add_linear(s, layer + Keys::down, c.d_ff, c.width);
    add_norm(s, layer + Keys::attended_norm, c.width);
    add_norm(s, layer + Keys::norm, c.width);
  }
  return s;
}

inline Shapes clip_shapes() {
  constexpr ml::ClipTextConfig c = tiny_clip;
  Shapes s{{"token_embedding.weight", {c.vocabulary, c.width}},
           {"positional_embedding", {c.context, c.width}},
           {"text_projection", {c.width, c.out}},
           {"logit_scale", {}}};
  add_norm(s, "ln_final", c.width);
  for (Index i = 0; i < c.layers; ++i) {
    const std::string block = ml::concat_text("transformer.resblocks.", i, ".");
    s[block + "attn.in_proj_weight"] = {3 * c.width, c.width};
    s[block + "attn.in_proj_bias"] = {3 * c.width};
    add_linear(s, block + "attn.out_proj", c.width, c.width);
    add_linear(s, block + "mlp.c_fc", c.width, c.d_ff);
    add_linear(s, block + "mlp.c_proj", c.d_ff, c.width);
    add_norm(s, block + "ln_1", c.width);
    add_norm(s, block + "ln_2", c.width);
  }
  return s;
}

inline std::pair<Shape, std::vector<double>> block_of_rows(const std::pair<Shape, std::vector<double>>& t, Index part) {
  Shape s = t.first;
  s[0] /= 3;
  const auto from = t.second.begin() + part * s.count();
  return {s, {from, from + s.count()}};
}

/// The tiny CLIP under the names of huggingface/transformers, modeling_clip.py.
inline Numbers hugging_face(const Numbers& openai) {
  Numbers out;
  for (const auto& [name, t] : openai) {
    if (name == "logit_scale") {
      out[name] = t;
    } else if (name == "token_embedding.weight" || name == "positional_embedding") {
      out[name[0] == 't' ? "text_model.embeddings.token_embedding.weight"
                         : "text_model.embeddings.position_embedding.weight"] = t;
    } else if (name == "text_projection") {
      std::vector<double> transposed;
      for (Index c = 0; c < t.first[1]; ++c) {
        for (Index r = 0; r < t.first[0]; ++r)
          transposed.push_back(t.second[static_cast<std::size_t>(r * t.first[1] + c)]);
      }
      out["text_projection.weight"] = {{t.first[1], t.first[0]}, transposed};
    } else if (name.starts_with("ln_final")) {
      out["text_model.final_layer_norm" + name.substr(8)] = t;
    } else {
      const auto dot = name.find('.', 22);
      const std::string layer = "text_model.encoder.layers." + name.substr(22, dot - 22) + ".",
                        part = name.substr(dot + 1);
      if (part.starts_with("attn.in_proj_")) {
        for (Index i = 0; i < 3; ++i)
          out[layer + "self_attn." + "qkv"[i] + "_proj." + part.substr(13)] = block_of_rows(t, i);
      } else {
        const std::vector<std::pair<std::string, std::string>> names{{"ln_1", "layer_norm1"},
                                                                     {"ln_2", "layer_norm2"},
                                                                     {"attn.out_proj", "self_attn.out_proj"},
                                                                     {"mlp.c_fc", "mlp.fc1"},
                                                                     {"mlp.c_proj", "mlp.fc2"}};
        for (const auto& [from, to] : names) {
          if (part.starts_with(from)) out[layer + to + part.substr(from.size())] = t;
        }
      }
    }
  }
  return out;
}

template <ml::Backend B, class Keys>
ml::BertNetwork<B, Keys> tiny() {
  return ml::load_text_network<ml::BertNetwork<B, Keys>>(Keys::relative_scores ? tiny_mpnet : tiny_bert,
                                                         file_of(by_formula(bert_shapes<Keys>())));
}
template <ml::Backend B>
ml::ClipText<B> tiny_clip_text() {
  return ml::load_clip_text<B>(tiny_clip, file_of(by_formula(clip_shapes())));
}

}  // namespace text_networks
