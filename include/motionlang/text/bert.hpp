// SPDX-License-Identifier: MIT
/// The BERT family: DistilBERT, BERT (MiniLM), RoBERTa and MPNet. They are one network. They differ in the names of
/// their tensors, in token types, and in the counting of positions.
///
///     // weights/text_network_file.hpp
///     const DistilBert<B> network = load_text_network<DistilBert<B>>(config, weights);
///     const Sequences<B> states = network(tokenize(tokenizer, texts)).tokens;
///
/// Batches are packed: padding is never computed, and a text has the same values alone and among others. Loading a file
/// packs the weights for the kernels; call `prepare` for a network from elsewhere. On an Autodiff backend it can be
/// trained.
#pragma once

#include <motionlang/nn/dropout.hpp>
#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/layer_norm.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/nn/multihead_attention.hpp>
#include <motionlang/nn/sequence_groups.hpp>
#include <motionlang/nn/text_features.hpp>
#include <motionlang/text/token_offsets.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct BertConfig {
  Index vocabulary = 30522, width = 768, heads = 12, d_ff = 3072, layers = 6, positions = 512;
  Index token_types = 2, buckets = 32;  // only if the member has them
  Index padding = 0;                    // the id of padding; positions of MPNet and RoBERTa depend on it
  Activation activation = Activation::gelu;
  double eps = 1e-12;
  double dropout = 0.1;  // of training
};

inline constexpr BertConfig distilbert_base{};
inline constexpr BertConfig minilm_l6{.width = 384, .d_ff = 1536};
inline constexpr BertConfig roberta_base{
    .vocabulary = 50265, .layers = 12, .positions = 514, .token_types = 1, .padding = 1, .eps = 1e-5};
inline constexpr BertConfig mpnet_base{.vocabulary = 30527, .layers = 12, .positions = 514, .padding = 1, .eps = 1e-5};

/// Names in the published state dicts (Hugging Face), and the parts of a member.
struct DistilBertKeys {
  static constexpr const char *model_type = "distilbert", *layers = "transformer.layer", *query = "attention.q_lin",
                              *key = "attention.k_lin", *value = "attention.v_lin", *attended = "attention.out_lin",
                              *attended_norm = "sa_layer_norm", *up = "ffn.lin1", *down = "ffn.lin2",
                              *norm = "output_layer_norm";
  static constexpr bool token_types = false, relative_scores = false, positions_behind_padding = false,
                        attended_dropout = false;
};
struct BertKeys {
  static constexpr const char *model_type = "bert", *layers = "encoder.layer", *query = "attention.self.query",
                              *key = "attention.self.key", *value = "attention.self.value",
                              *attended = "attention.output.dense", *attended_norm = "attention.output.LayerNorm",
                              *up = "intermediate.dense", *down = "output.dense", *norm = "output.LayerNorm";
  static constexpr bool token_types = true, relative_scores = false, positions_behind_padding = false,
                        attended_dropout = true;
};
/// BERT with one token type, whose positions count from behind that of padding.
struct RobertaKeys : BertKeys {
  static constexpr const char* model_type = "roberta";
  static constexpr bool positions_behind_padding = true;
};
struct MpnetKeys {
  static constexpr const char *model_type = "mpnet", *layers = "encoder.layer", *query = "attention.attn.q",
                              *key = "attention.attn.k", *value = "attention.attn.v", *attended = "attention.attn.o",
                              *attended_norm = "attention.LayerNorm", *up = "intermediate.dense",
                              *down = "output.dense", *norm = "output.LayerNorm";
  static constexpr bool token_types = false, relative_scores = true, positions_behind_padding = true,
                        attended_dropout = true;
};

/// The bucket, among 32, of a relative position r = key - query. 0 ... 15 are for keys up to the query, 16 ... 31 for
/// later ones. Up to 8 every distance has its own bucket. Source  MPNet (Song et al. 2020), after T5 (Raffel et al.
/// 2020), section 2.1; the borders 8 * 16^(i / 8) as whole numbers (huggingface/transformers, modeling_mpnet.py).
constexpr Index mpnet_bucket(Index r) {
  constexpr Index borders[] = {12, 16, 23, 32, 46, 64, 91};
  const Index distance = r < 0 ? -r : r, later = r > 0 ? 16 : 0;
  if (distance < 8) return later + distance;
  Index offset = 8;
  for (Index border : borders) offset += distance >= border ? 1 : 0;
  return later + offset;
}

/// Post-norm:   x = LN(SA(x) + x);   x = LN(W2 act(W1 x) + x)
/// Dropout (only with a context) acts on the attention weights and W2's result; in BERT and MPNet also on SA's.
template <Backend B, class Keys>
struct BertLayer {
  Linear<B> query, key, value, attended;
  LayerNorm<B> attended_norm;
  Linear<B> up, down;
  LayerNorm<B> norm;
  Index heads = 1;
  Activation activation = Activation::gelu;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = BertLayer;
    return motionlang::fields(Keys::query, &M::query, Keys::key, &M::key, Keys::value, &M::value, Keys::attended,
                              &M::attended, Keys::attended_norm, &M::attended_norm, Keys::up, &M::up, Keys::down,
                              &M::down, Keys::norm, &M::norm, "heads", &M::heads, "activation", &M::activation,
                              "dropout_p", &M::dropout_p);
  }
  BertLayer() = default;
  BertLayer(const BertConfig& c, Rng auto& rng)
      : query(c.width, c.width, rng),
        key(c.width, c.width, rng),
        value(c.width, c.width, rng),
        attended(c.width, c.width, rng),
        attended_norm(c.width),
        up(c.width, c.d_ff, rng),
        down(c.d_ff, c.width, rng),
        norm(c.width),
        heads(c.heads),
        activation(c.activation),
        dropout_p(c.dropout) {
    check_heads(c.width, c.heads);
    attended_norm.eps = norm.eps = c.eps;
  }

  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets, const Tensor<B, 2>* relative_scores,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return reading(x, offsets, x, offsets, relative_scores, context);
  }
  /// `rows` attend to x, which need not contain them.
  Tensor<B, 2> reading(const Tensor<B, 2>& rows, const Offsets& of_rows, const Tensor<B, 2>& x, const Offsets& offsets,
                       const Tensor<B, 2>* relative_scores = nullptr, const Context& context = {}) const {
    const auto a = attention(
        query(rows), key(x), value(x), of_rows, offsets,
        {.heads = heads, .dropout = next_dropout(dropout_p, context), .precision = precision_of(query.weight)},
        relative_scores);
    const auto drop = Keys::attended_dropout ? next_dropout(dropout_p, context) : Dropout{};
    const auto y = attended_norm(attended(a, Activation::none, &rows, drop));
    return norm(down(up(y, activation), Activation::none, &y, next_dropout(dropout_p, context)));
  }
};

/// Source  Sanh et al. (2019), Devlin et al. (2019), Liu et al. (2019), Song et al. (2020); huggingface/transformers,
///         modeling_distilbert.py, modeling_bert.py, modeling_roberta.py, modeling_mpnet.py. Without pooler and heads.
template <Backend B, class Keys>
struct BertNetwork {
  Embedding<B> words, positions;
  std::optional<Embedding<B>> token_types, relative_scores;
  LayerNorm<B> norm;
  std::vector<BertLayer<B, Keys>> layers;
  Index padding = 0;
  double dropout_p = 0.1;  // of the embeddings

  static constexpr auto fields() {
    using M = BertNetwork;
    return motionlang::fields("embeddings.word_embeddings", &M::words, "embeddings.position_embeddings", &M::positions,
                              "embeddings.token_type_embeddings", &M::token_types, "embeddings.LayerNorm", &M::norm,
                              Keys::layers, &M::layers, "encoder.relative_attention_bias", &M::relative_scores,
                              "padding", &M::padding, "dropout_p", &M::dropout_p);
  }
  using Config = BertConfig;
  using keys = Keys;

  BertNetwork() = default;
  BertNetwork(const BertConfig& c, Rng auto& rng)
      : words(c.vocabulary, c.width, rng, 0.02),
        positions(c.positions, c.width, rng, 0.02),
        norm(c.width),
        padding(c.padding),
        dropout_p(c.dropout) {
    norm.eps = c.eps;
    if (Keys::token_types) token_types.emplace(c.token_types, c.width, rng, 0.02);
    if (Keys::relative_scores) relative_scores.emplace(c.buckets, c.heads, rng, 0.02);
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }

  /// The number of ids for which there are positions.
  Index longest() const { return positions.weight.size(0) - first_position(); }

  /// The states of the last layer, one row for every id. Throws config_error 101 for a text that is too long,
  /// shape_error 203 for an unknown id.
  TextFeatures<B> operator()(const TokenBatch& batch, const Context& context = {}) const {
    const ModuleScope scope(*this);
    const Offsets offsets = token_offsets(batch);
    check_length(offsets.longest());
    auto x = dropout(embedded(batch.ids, position_ids(batch)), dropout_p, context);
    std::optional<Tensor<B, 2>> scores;
    if (relative_scores) scores = scores_of_distances(std::max<Index>(1, offsets.longest()));
    const Sequences<B> texts(std::move(x), offsets);
    return {texts.with(detail::in_groups(texts, texts.offsets, context, [&](Sequences<B> some) {
      for (const auto& layer : layers) some.rows = layer(some.rows, some.offsets, scores ? &*scores : nullptr, context);
      return some.rows;
    }))};
  }

  /// The row of a padded batch at `place` after the end of each text, (texts, width): a token of padding, which attends
  /// to the text and is not attended to. Published SINC models with separate texts read it. Throws config_error 101 if
  /// there is no such position.
  Tensor<B, 2> padding_states(const TokenBatch& batch, Index place) const requires(!Keys::relative_scores) {
    const Offsets offsets = token_offsets(batch), one = Offsets::equal(offsets.count(), 1);
    check_length(std::max(offsets.longest(), place + 1));
    const auto texts = static_cast<std::size_t>(offsets.count());
    auto x = embedded(batch.ids, position_ids(batch));
    auto pad = embedded(std::vector<Index>(texts, padding), std::vector<Index>(texts, place));
    for (const auto& layer : layers) {
      pad = layer.reading(pad, one, x, offsets);
      x = layer(x, offsets, nullptr);
    }
    return pad;
  }

 private:
  void check_length(Index pieces) const {
    if (pieces > longest())
      raise<config_error>(101, Keys::model_type, ": a text of ", pieces, " pieces; there are positions for ", longest(),
                          " (let the tokenizer cut it)");
  }
  Tensor<B, 2> embedded(std::span<const Index> ids, std::span<const Index> places) const {
    auto x = words(ids) + positions(places);
    if (token_types) x = x + slice(token_types->weight, 0, 0, 1);
    return norm(x);
  }
  Index first_position() const { return Keys::positions_behind_padding ? padding + 1 : 0; }

  std::vector<Index> position_ids(const TokenBatch& batch) const {
    std::vector<Index> out;
    for (Index length : batch.lengths) {
      Index next = first_position();
      for (Index i = 0; i < length; ++i) {
        const bool padded = Keys::positions_behind_padding && batch.ids[out.size()] == padding;
        out.push_back(padded ? padding : next++);
      }
    }
    return out;
  }
  /// (heads, 2 n - 1): for the distances -(n - 1) ... n - 1.
  Tensor<B, 2> scores_of_distances(Index n) const {
    PoolVector<Index> buckets;
    for (Index r = 1 - n; r < n; ++r) buckets.push_back(mpnet_bucket(r));
    return transpose(gather(relative_scores->weight, buckets));
  }
};

/// Packs the weights of the layers. Embeddings are looked up, not multiplied.
template <Backend B, class Keys>
void prepare(BertNetwork<B, Keys>& network) {
  for (auto& layer : network.layers) prepare(layer);
}

template <Backend B>
using DistilBert = BertNetwork<B, DistilBertKeys>;
template <Backend B>
using Bert = BertNetwork<B, BertKeys>;
template <Backend B>
using Roberta = BertNetwork<B, RobertaKeys>;
template <Backend B>
using Mpnet = BertNetwork<B, MpnetKeys>;

MOTIONLANG_NAMESPACE_END
