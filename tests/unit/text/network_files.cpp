// Text networks from files: prefixes, other names, config.json, what is refused.
#include <doctest/doctest.h>

#include <motionlang/backend/reference.hpp>
#include <motionlang/file/json.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"
#include "../../support/text_networks.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<double>;
using tensors::same_bits;
using namespace text_networks;

namespace {

Numbers with_prefix(const Numbers& numbers, const std::string& prefix) {
  Numbers out;
  for (const auto& [name, t] : numbers) out[prefix + name] = t;
  return out;
}
Numbers replaced(const Numbers& numbers, const std::string& from, const std::string& to) {
  Numbers out;
  for (const auto& [name, t] : numbers) {
    std::string other = name;
    if (const auto at = other.find(from); at != other.npos) other.replace(at, from.size(), to);
    out[other] = t;
  }
  return out;
}
const Numbers openai = by_formula(clip_shapes()), distil = by_formula(bert_shapes<ml::DistilBertKeys>()),
              bert = by_formula(bert_shapes<ml::BertKeys>());
const ml::TokenBatch text{{2, 7, 3, 19}, {4}};

auto distil_states(const Numbers& n) {
  return ml::load_text_network<ml::DistilBert<B>>(tiny_bert, file_of(n))(text).tokens.rows;
}
auto bert_states(const Numbers& n) {
  return ml::load_text_network<ml::Bert<B>>(tiny_bert, file_of(n))(text).tokens.rows;
}
auto clip_vector(const Numbers& n) {
  const auto network = ml::load_clip_text<B>(tiny_clip, file_of(n));
  return network.project(ml::pool(network(text), ml::Pooling::end));
}

}  // namespace

TEST_CASE("prefixes, heads and position_ids; LayerNorm.gamma and beta") {
  const auto want = distil_states(distil);
  Numbers saved = with_prefix(distil, "distilbert.");
  saved["vocab_projector.bias"] = saved["distilbert.embeddings.position_ids"] = {{2}, {1, 2}};
  CHECK(same_bits(distil_states(saved), want));
  Numbers checkpoint = with_prefix(distil, "textencoder.text_model.");
  checkpoint["motionencoder.mu_token"] = {{2}, {1, 2}};
  CHECK(same_bits(distil_states(checkpoint), want));
  Numbers bare = distil;
  bare["vocab_transform.weight"] = {{2}, {1, 2}};
  CHECK(same_bits(distil_states(bare), want));
  const auto old = replaced(replaced(bert, "LayerNorm.weight", "LayerNorm.gamma"), "LayerNorm.bias", "LayerNorm.beta");
  CHECK(same_bits(bert_states(with_prefix(old, "bert.")), bert_states(bert)));
}

TEST_CASE("CLIP: the forms of Hugging Face and OpenAI, alone or inside of a larger model") {
  const auto want = clip_vector(openai);
  Numbers inside = with_prefix(openai, "clip_model.");
  inside["clip_model.visual.proj"] = inside["seqTransEncoder.layers.0.norm1.bias"] = {{2}, {1, 2}};
  CHECK(same_bits(clip_vector(inside), want));
  Numbers other = hugging_face(openai);
  other["vision_model.post_layernorm.bias"] = other["text_model.embeddings.position_ids"] = {{2}, {1, 2}};
  CHECK(same_bits(clip_vector(other), want));
  CHECK(same_bits(clip_vector(with_prefix(other, "model.")), want));
}

TEST_CASE("the error says what does not match") {
  Numbers n = distil;
  n["transformer.layer.0.ffn.lin1.wieght"] = n["transformer.layer.0.ffn.lin1.weight"];
  n.erase("transformer.layer.0.ffn.lin1.weight");
  CHECK_ERROR(distil_states(n), "transformer.layer.0.ffn.lin1.wieght");
  n = distil;
  n["embeddings.LayerNorm.bias"] = {{9}, std::vector<double>(9)};
  CHECK_ERROR(distil_states(n), "[motionlang.io.407]");
  CHECK_ERROR(distil_states(openai), "[motionlang.io.406]");
  CHECK_ERROR(clip_vector(distil), "[motionlang.io.406]");
  n = with_prefix(distil, "a.");
  n.merge(with_prefix(distil, "b."));
  CHECK_ERROR(distil_states(n), "two networks");
  n = hugging_face(openai);
  n["text_model.encoder.layers.0.self_attn.k_proj.weight"] = {{7, 8}, std::vector<double>(56)};
  CHECK_ERROR(clip_vector(n), "[motionlang.io.407]");
  n = hugging_face(openai);
  n.erase("text_model.encoder.layers.0.self_attn.k_proj.weight");
  CHECK_ERROR(clip_vector(n), "[motionlang.io.406]");
}

TEST_CASE("no memory for sizes that the file does not justify") {
  ml::BertConfig huge = tiny_bert;
  huge.vocabulary = 10'000'000, huge.width = 16'384;
  CHECK_ERROR(ml::load_text_network<ml::DistilBert<B>>(huge, file_of(distil)), "[motionlang.config.102]");
  huge = tiny_bert;
  huge.layers = 1024, huge.d_ff = 131'072;
  CHECK_ERROR(ml::load_text_network<ml::Bert<B>>(huge, file_of(bert)), "[motionlang.config.102]");
  ml::ClipTextConfig clip = tiny_clip;
  clip.context = 10'000'000;
  CHECK_ERROR(ml::load_clip_text<B>(clip, file_of(openai)), "[motionlang.config.102]");
}

TEST_CASE("sizes of CLIP from the shapes of its tensors") {
  for (const Numbers& n : {openai, hugging_face(openai)}) {
    const auto c = ml::clip_text_config(file_of(n));
    CHECK(c.vocabulary == 20);
    CHECK(c.width == 8);
    CHECK(c.heads == 1);
    CHECK(c.d_ff == 32);
    CHECK(c.layers == 2);
    CHECK(c.context == 9);
    CHECK(c.out == 6);
  }
}

TEST_CASE("config.json") {
  const auto config_of = [](const char* json, const char* type) {
    const auto document = ml::parse_json(json);
    return ml::bert_config(ml::JsonView(document, "config.json"), type);
  };
  const auto d = config_of(R"({"model_type": "distilbert", "dim": 768, "n_heads": 12, "n_layers": 6, "hidden_dim": 3072,
    "vocab_size": 30522, "max_position_embeddings": 512, "activation": "gelu", "pad_token_id": 0, "dropout": 0.1})",
                           "distilbert");
  CHECK(d.width == 768);
  CHECK(d.heads == 12);
  CHECK(d.layers == 6);
  CHECK(d.d_ff == 3072);
  CHECK(d.vocabulary == 30522);
  CHECK(d.eps == 1e-12);
  std::string mpnet = R"({"model_type": "mpnet", "hidden_size": 768, "num_attention_heads": 12, "num_hidden_layers": 12,
    "intermediate_size": 3072, "vocab_size": 30527, "max_position_embeddings": 514, "hidden_act": "gelu",
    "layer_norm_eps": 1e-05, "relative_attention_num_buckets": 32, "pad_token_id": 1})";
  const auto m = config_of(mpnet.c_str(), "mpnet");
  CHECK(m.eps == 1e-5);
  CHECK(m.padding == 1);
  CHECK(m.positions == 514);
  CHECK(m.buckets == 32);
  CHECK_ERROR(config_of(mpnet.c_str(), "bert"), "[motionlang.config.103]");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string s = mpnet;
    s.replace(s.find(from), from.size(), to);
    return s;
  };
  CHECK_ERROR(config_of(changed("gelu", "mish").c_str(), "mpnet"), "[motionlang.config.103]");
  CHECK_ERROR(config_of(changed("12", "7").c_str(), "mpnet"), "[motionlang.config.101]");
  CHECK_ERROR(config_of(changed("30527", "1e300").c_str(), "mpnet"), "[motionlang.config.10");
  CHECK_ERROR(config_of(changed("514", "0").c_str(), "mpnet"), "[motionlang.config.101]");
  CHECK_ERROR(
      config_of(changed("\"pad_token_id\": 1", "\"position_embedding_type\": \"relative_key\"").c_str(), "mpnet"),
      "[motionlang.config.103]");

  const auto document = ml::parse_json(R"({"model_type": "clip", "projection_dim": 512,
    "text_config": {"hidden_size": 8, "intermediate_size": 2048, "num_hidden_layers": 12, "num_attention_heads": 8, "eos_token_id": 2,
      "max_position_embeddings": 77, "vocab_size": 49408, "hidden_act": "quick_gelu", "layer_norm_eps": 1e-05},
    "text_config_dict": {"hidden_size": 512}})");
  const auto c = ml::clip_text_config(ml::JsonView(document, "config.json"));
  CHECK(c.width == 512);
  CHECK(c.heads == 8);
  CHECK(c.d_ff == 2048);
  CHECK(c.out == 512);
  CHECK(c.context == 77);
  CHECK(c.activation == ml::Activation::quick_gelu);

  const auto partial =
      ml::parse_json(R"({"model_type": "clip", "projection_dim": 768, "text_config": {"hidden_size": 768,
    "intermediate_size": 3072, "num_attention_heads": 12, "hidden_act": "gelu"}})");
  const auto l14 = ml::clip_text_config(ml::JsonView(partial, "config.json"));
  CHECK((l14.width == 768 && l14.d_ff == 3072 && l14.heads == 12 && l14.out == 768));
  CHECK((l14.vocabulary == 49408 && l14.layers == 12 && l14.context == 77 && l14.eps == 1e-5));
  CHECK(l14.activation == ml::Activation::gelu);
  const auto wrong = ml::parse_json(R"({"model_type": "clip", "text_config": {"vocab_size": 0}})");
  CHECK_ERROR(ml::clip_text_config(ml::JsonView(wrong, "config.json")), "[motionlang.config.101]");
}
