// SPDX-License-Identifier: MIT
// Bodies of text_network_file.hpp.
#pragma once

#include <motionlang/core/sort.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/weights/text_network_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY RenamedTensors::RenamedTensors(const TensorSet& file) : TensorSet(file.name(), nullptr) {
  if (file.owner() == nullptr) return;  // the bytes have no owner: tensors will be copies
  memory_->file = file.owner();
  owner_ = memory_;
}

MOTIONLANG_BODY void RenamedTensors::add(TensorView view, std::string name) {
  view.name = std::move(name);
  tensors_.push_back(std::move(view));
}

MOTIONLANG_BODY void RenamedTensors::add(TensorView view, std::string name, std::vector<std::byte> bytes) {
  if (auto aside = view.shape.rank() == 2 ? MappedFile::put_aside(bytes) : nullptr)
    view.bytes = memory_->aside.emplace_back(std::move(aside))->bytes();
  else
    view.bytes = memory_->made.emplace_back(std::move(bytes));
  add(std::move(view), std::move(name));
}

MOTIONLANG_BODY void RenamedTensors::sort() {
  detail::sort(tensors_, [](const TensorView& a, const TensorView& b) { return a.name < b.name; });
}

MOTIONLANG_BODY std::optional<std::string> prefix_of(const TensorSet& file, std::string_view name) {
  std::optional<std::string> prefix;
  for (const TensorView& t : file.tensors()) {
    const std::string_view whole = t.name;
    if (!whole.ends_with(name)) continue;
    const std::string_view before = whole.substr(0, whole.size() - name.size());
    if (!before.empty() && before.back() != '.') continue;
    if (prefix)
      raise<io_error>(406, file.name(), ": two networks, '", *prefix, name, "' and '", whole, "': which one is meant?");
    prefix = before;
  }
  return prefix;
}

MOTIONLANG_BODY RenamedTensors bert_tensors(const TensorSet& file) {
  constexpr std::string_view words = "embeddings.word_embeddings.weight";
  const auto prefix = prefix_of(file, words);
  if (!prefix) raise<io_error>(406, file.name(), ": no tensor '", words, "', with or without a prefix");
  RenamedTensors out(file);
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(*prefix)) continue;
    std::string name = t.name.substr(prefix->size());
    if (name.ends_with("position_ids") || begins_with_any(name, {"pooler.", "vocab_", "cls.", "lm_head."})) continue;
    if (name.ends_with("LayerNorm.gamma")) name.replace(name.size() - 5, 5, "weight");
    if (name.ends_with("LayerNorm.beta")) name.replace(name.size() - 4, 4, "bias");
    out.add(t, std::move(name));
  }
  out.sort();
  return out;
}

/// The rows of several tensors, one below the other.
inline void add_stacked(RenamedTensors& out, const std::array<const TensorView*, 3>& parts, std::string name,
                        std::string_view where) {
  TensorView whole = *parts[0];
  std::vector<std::byte> bytes;
  for (const TensorView* p : parts) {
    if (p->dtype != whole.dtype || p->shape != parts[0]->shape || p->shape.rank() == 0)
      raise<io_error>(407, where, ": '", p->name, "' is ", p->dtype, " ", p->shape, ", '", parts[0]->name, "' ",
                      whole.dtype, " ", parts[0]->shape);
    bytes.insert(bytes.end(), p->bytes.begin(), p->bytes.end());
    MappedFile::forget_if_mapped(p->bytes);
  }
  whole.shape[0] = 3 * parts[0]->shape[0];
  out.add(std::move(whole), std::move(name), std::move(bytes));
}

inline void add_transposed(RenamedTensors& out, TensorView view, std::string name, std::string_view where) {
  if (view.shape.rank() != 2) raise<io_error>(407, where, ": '", view.name, "' is ", view.shape, ", not a matrix");
  const auto rows = static_cast<std::size_t>(view.shape[0]), columns = static_cast<std::size_t>(view.shape[1]);
  const std::size_t size = static_cast<std::size_t>(info(view.dtype).bits) / 8;
  std::vector<std::byte> bytes(view.bytes.size());
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c)
      std::memcpy(bytes.data() + (c * rows + r) * size, view.bytes.data() + (r * columns + c) * size, size);
  }
  std::swap(view.shape[0], view.shape[1]);
  MappedFile::forget_if_mapped(view.bytes);
  out.add(std::move(view), std::move(name), std::move(bytes));
}

/// From the names of Hugging Face to those of OpenAI. `prefix` stands before "text_model.".
inline RenamedTensors clip_tensors_of_hugging_face(const TensorSet& file, const std::string& prefix) {
  constexpr std::string_view layers = "encoder.layers.";
  constexpr std::array<std::array<std::string_view, 2>, 3> whole{
      {{"embeddings.token_embedding.", "token_embedding."},
       {"embeddings.position_embedding.weight", "positional_embedding"},
       {"final_layer_norm.", "ln_final."}}};
  constexpr std::array<std::array<std::string_view, 2>, 5> parts{{{"layer_norm1.", "ln_1."},
                                                                  {"layer_norm2.", "ln_2."},
                                                                  {"self_attn.out_proj.", "attn.out_proj."},
                                                                  {"mlp.fc1.", "mlp.c_fc."},
                                                                  {"mlp.fc2.", "mlp.c_proj."}}};
  const auto renamed = [](std::string_view name, const auto& table) {
    for (const auto& [from, to] : table) {
      if (name.starts_with(from)) return std::string(to).append(name.substr(from.size()));
    }
    return std::string(name);  // for the report
  };
  RenamedTensors out(file);
  const std::string model = prefix + "text_model.";
  if (const TensorView* t = file.find(prefix + "text_projection.weight"))
    add_transposed(out, *t, "text_projection", file.name());
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(model) || t.name.ends_with("position_ids")) continue;
    const std::string_view name = std::string_view(t.name).substr(model.size());
    if (!name.starts_with(layers)) {
      out.add(t, renamed(name, whole));
      continue;
    }
    const std::size_t dot = std::min(name.find('.', layers.size()), name.size() - 1);
    const std::string block =
        "transformer.resblocks." + std::string(name.substr(layers.size(), dot + 1 - layers.size()));
    const std::string_view part = name.substr(dot + 1);
    const std::string before = t.name.substr(0, t.name.size() - part.size());
    bool stacked = false;
    for (const char* kind : {"weight", "bias"}) {
      const auto of = [&](const char* p) { return file.find(before + "self_attn." + p + "_proj." + kind); };
      const std::array<const TensorView*, 3> qkv{of("q"), of("k"), of("v")};
      if (qkv[0] == nullptr || qkv[1] == nullptr || qkv[2] == nullptr) continue;
      if (&t == qkv[0]) add_stacked(out, qkv, block + "attn.in_proj_" + kind, file.name());
      stacked = stacked || &t == qkv[0] || &t == qkv[1] || &t == qkv[2];
    }
    if (!stacked) out.add(t, block + renamed(part, parts));
  }
  out.sort();
  return out;
}

MOTIONLANG_BODY RenamedTensors clip_tensors(const TensorSet& file) {
  if (const auto prefix = prefix_of(file, "text_model.embeddings.token_embedding.weight"))
    return clip_tensors_of_hugging_face(file, *prefix);
  const auto prefix = prefix_of(file, "token_embedding.weight");
  if (!prefix) raise<io_error>(406, file.name(), ": no tensor 'token_embedding.weight', with or without a prefix");
  RenamedTensors out(file);
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(*prefix)) continue;
    std::string name = t.name.substr(prefix->size());
    if (begins_with_any(name, {"visual.", "logit_scale", "input_resolution", "context_length", "vocab_size"})) continue;
    out.add(t, std::move(name));
  }
  out.sort();
  return out;
}

MOTIONLANG_BODY ParameterRoom room_of(const TensorSet& weights) {
  Index numbers = 0;
  for (const TensorView& t : weights.tensors()) numbers += t.shape.count();
  return {weights.name(), numbers};
}

/// A size in a configuration file, 1 ... largest.
inline Index config_size(const JsonView& config, const std::string& key, Index largest) {
  const Index n = config[key].as<Index>();
  if (n < 1 || n > largest) raise<config_error>(101, config.path(), ": ", key, " is ", n, ", not 1 ... ", largest);
  return n;
}

inline Activation config_activation(const JsonView& config, const std::string& key) {
  const auto name = config[key].as<std::string>();
  if (name != "relu" && name != "gelu" && name != "gelu_new" && name != "quick_gelu")
    raise<config_error>(103, config.path(), ": ", key, " '", name, "' is not one of relu, gelu, gelu_new, quick_gelu");
  return parse_activation(name);
}

inline constexpr Index largest_width = 16384, largest_vocabulary = 10'000'000, largest_depth = 1024;

}  // namespace detail

MOTIONLANG_BODY BertConfig bert_config(const JsonView& config, std::string_view model_type) {
  using detail::config_size;
  if (const auto found = config["model_type"].as<std::string>(); found != model_type)
    raise<config_error>(103, config.path(), ": model_type '", found, "', expected '", model_type, "'");
  if (const auto kind = config.value_or("position_embedding_type", "absolute"); kind != "absolute")
    raise<config_error>(103, config.path(), ": position_embedding_type '", kind, "' is not 'absolute'");
  const bool distilled = model_type == "distilbert";
  BertConfig c;
  c.vocabulary = config_size(config, "vocab_size", detail::largest_vocabulary);
  c.width = config_size(config, distilled ? "dim" : "hidden_size", detail::largest_width);
  c.heads = config_size(config, distilled ? "n_heads" : "num_attention_heads", detail::largest_width);
  c.layers = config_size(config, distilled ? "n_layers" : "num_hidden_layers", detail::largest_depth);
  c.d_ff = config_size(config, distilled ? "hidden_dim" : "intermediate_size", 8 * detail::largest_width);
  c.positions = config_size(config, "max_position_embeddings", detail::largest_vocabulary);
  c.activation = detail::config_activation(config, distilled ? "activation" : "hidden_act");
  c.padding = config.value_or("pad_token_id", Index{model_type == "mpnet" || model_type == "roberta" ? 1 : 0});
  if (!distilled) c.eps = config.value_or("layer_norm_eps", 1e-12);
  if (model_type == "bert" || model_type == "roberta")
    c.token_types = config_size(config, "type_vocab_size", detail::largest_vocabulary);
  if (config.contains("relative_attention_num_buckets"))
    c.buckets = config_size(config, "relative_attention_num_buckets", detail::largest_vocabulary);
  if (c.buckets != 32) raise<config_error>(101, config.path(), ": ", c.buckets, " buckets of distances, expected 32");
  if (c.padding < 0 || c.padding >= c.vocabulary)
    raise<config_error>(101, config.path(), ": pad_token_id ", c.padding, " in a vocabulary of ", c.vocabulary);
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_BODY BertConfig distilbert_config(const TensorSet& file) {
  const auto tensors = detail::bert_tensors(file);
  const auto matrix = [&](const std::string& name) {
    const TensorView& t = tensors.tensor(name);
    if (t.shape.rank() != 2) raise<io_error>(407, file.name(), ": '", name, "' is ", t.shape, ", not a matrix");
    return t.shape;
  };
  const Shape words = matrix("embeddings.word_embeddings.weight");
  BertConfig c{.vocabulary = words[0],
               .width = words[1],
               .heads = std::max<Index>(1, words[1] / 64),
               .d_ff = matrix("transformer.layer.0.ffn.lin1.weight")[0],
               .layers = 0,
               .positions = matrix("embeddings.position_embeddings.weight")[0]};
  while (tensors.find(concat_text("transformer.layer.", c.layers, ".ffn.lin1.weight")) != nullptr) ++c.layers;
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_BODY ClipTextConfig clip_text_config(const JsonView& config) {
  using detail::config_size;
  const JsonView text =
      config.contains("text_config") && config["text_config"].is_object() ? config["text_config"] : config;
  const bool older = config.contains("text_config_dict") && config["text_config_dict"].is_object();
  const auto at = [&](const std::string& key) {  // where older files say it twice, the dictionary wins
    if (key == "projection_dim" && config.contains(key)) return config;
    return older && config["text_config_dict"].contains(key) ? config["text_config_dict"] : text;
  };
  ClipTextConfig c;
  const auto read = [&](Index& size, const std::string& key, Index largest) {
    if (at(key).contains(key)) size = config_size(at(key), key, largest);
  };
  read(c.vocabulary, "vocab_size", detail::largest_vocabulary);
  read(c.width, "hidden_size", detail::largest_width);
  read(c.heads, "num_attention_heads", detail::largest_width);
  read(c.layers, "num_hidden_layers", detail::largest_depth);
  read(c.d_ff, "intermediate_size", 8 * detail::largest_width);
  read(c.context, "max_position_embeddings", detail::largest_vocabulary);
  read(c.out, "projection_dim", detail::largest_width);
  if (at("hidden_act").contains("hidden_act")) c.activation = detail::config_activation(at("hidden_act"), "hidden_act");
  c.eps = at("layer_norm_eps").value_or("layer_norm_eps", c.eps);
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_BODY ClipTextConfig clip_text_config(const TensorSet& file) {
  const auto tensors = detail::clip_tensors(file);
  const auto matrix = [&](const std::string& name) {
    const TensorView& t = tensors.tensor(name);
    if (t.shape.rank() != 2) raise<io_error>(407, file.name(), ": '", name, "' is ", t.shape, ", not a matrix");
    return t.shape;
  };
  const Shape words = matrix("token_embedding.weight");
  ClipTextConfig c{.vocabulary = words[0],
                   .width = words[1],
                   .heads = std::max<Index>(1, words[1] / 64),
                   .d_ff = matrix("transformer.resblocks.0.mlp.c_fc.weight")[0],
                   .layers = 0,
                   .context = matrix("positional_embedding")[0],
                   .out = matrix("text_projection")[1]};
  while (tensors.find(concat_text("transformer.resblocks.", c.layers, ".ln_1.weight")) != nullptr) ++c.layers;
  check_heads(c.width, c.heads);
  return c;
}

MOTIONLANG_NAMESPACE_END
