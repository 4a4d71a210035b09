// SPDX-License-Identifier: MIT
/// The text tower of CLIP.
///
///     const ClipText<B> network = load_clip_text<B>(weights);                       // weights/text_network_file.hpp
///     const auto text = network(network.until_end(tokenize(tokenizer, texts)));     // nothing behind the end token
///     const auto vectors = network.project(pool(text, Pooling::end));               // what MDM and STMC take
#pragma once

#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/pooling.hpp>
#include <motionlang/nn/sequence_groups.hpp>
#include <motionlang/nn/transformer_encoder.hpp>
#include <motionlang/text/token_offsets.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct ClipTextConfig {
  Index vocabulary = 49408, width = 512, heads = 8, d_ff = 2048, layers = 12, context = 77, out = 512;
  Activation activation = Activation::quick_gelu;
  double eps = 1e-5;
};

inline constexpr ClipTextConfig clip_vit_b32{};
inline constexpr ClipTextConfig clip_vit_l14{.width = 768, .heads = 12, .d_ff = 3072, .out = 768};

/// Pre-norm; every token sees those before it:   x = x + SA(LN1 x);   x = x + W2 act(W1 LN2 x)
template <Backend B>
struct ClipBlock {
  MultiheadAttention<B> attn;
  LayerNorm<B> ln_1, ln_2;
  Linear<B> c_fc, c_proj;
  Activation activation = Activation::quick_gelu;

  static constexpr auto fields() {
    using M = ClipBlock;
    return motionlang::fields("ln_1", &M::ln_1, "attn", &M::attn, "ln_2", &M::ln_2, "mlp.c_fc", &M::c_fc, "mlp.c_proj",
                              &M::c_proj, "activation", &M::activation);
  }
  ClipBlock() = default;
  ClipBlock(const ClipTextConfig& c, Rng auto& rng)
      : attn(c.width, c.heads, 0, rng),
        ln_1(c.width),
        ln_2(c.width),
        c_fc(c.width, c.d_ff, rng),
        c_proj(c.d_ff, c.width, rng),
        activation(c.activation) {
    ln_1.eps = ln_2.eps = c.eps;
  }

  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets) const {
    const ModuleScope scope(*this);
    const auto y = attn.self(ln_1(x), offsets, {}, &x, /*causal=*/true);
    return c_proj(c_fc(ln_2(y), activation), Activation::none, &y);
  }
};

/// Source  Radford et al. (2021), section 2.4; parameter names of OpenAI's state dict; openai/CLIP
///         clip/model.py.
template <Backend B>
struct ClipText {
  Embedding<B> token_embedding;
  Tensor<B, 2> positional_embedding;  // (context, width)
  std::vector<ClipBlock<B>> blocks;
  LayerNorm<B> ln_final;
  Tensor<B, 2> text_projection;  // (width, out)

  static constexpr auto fields() {
    using M = ClipText;
    return motionlang::fields("token_embedding", &M::token_embedding, "positional_embedding", &M::positional_embedding,
                              "transformer.resblocks", &M::blocks, "ln_final", &M::ln_final, "text_projection",
                              &M::text_projection);
  }
  ClipText() = default;
  ClipText(const ClipTextConfig& c, Rng auto& rng)
      : token_embedding(c.vocabulary, c.width, rng, 0.02),
        positional_embedding(normal_init<B, 2>({c.context, c.width}, 0.01, rng)),
        ln_final(c.width),
        text_projection(normal_init<B, 2>({c.width, c.out}, 1 / std::sqrt(static_cast<double>(c.width)), rng)) {
    ln_final.eps = c.eps;
    for (Index i = 0; i < c.layers; ++i) blocks.emplace_back(c, rng);
  }

  Index longest() const { return positional_embedding.size(0); }

  /// The normalised states of the last layer, one row for every id, and the places of the end tokens (the first of the
  /// largest id). A row depends only on the ids up to it. Throws config_error 101 for a text longer than the context,
  /// and shape_error 203 for an unknown id.
  TextFeatures<B> operator()(const TokenBatch& batch) const {
    const ModuleScope scope(*this);
    const Offsets offsets = token_offsets(batch);
    if (offsets.longest() > longest())
      raise<config_error>(101, "CLIP: a text of ", offsets.longest(), " pieces for a context of ", longest(),
                          " (let the tokenizer cut it)");
    std::vector<Index> position_ids;
    for (Index length : batch.lengths) {
      for (Index i = 0; i < length; ++i) position_ids.push_back(i);
    }
    const Sequences<B> texts(token_embedding(batch.ids) + gather(positional_embedding, position_ids), offsets);
    return {texts.with(detail::in_groups(texts, texts.offsets, {},
                                         [&](Sequences<B> some) {
                                           for (const auto& block : blocks) some.rows = block(some.rows, some.offsets);
                                           return ln_final(some.rows);
                                         })),
            end_positions(batch)};
  }

  /// Projects vectors of end tokens to the space of texts and images, (texts, width) -> (texts, out). Their length is
  /// not 1.
  Tensor<B, 2> project(const Tensor<B, 2>& end_rows) const { return matmul(end_rows, text_projection); }

  /// The texts up to their end tokens. Later ids do not affect the vector of a text.
  TokenBatch until_end(const TokenBatch& batch) const {
    TokenBatch out;
    token_offsets(batch);  // checks them
    auto from = batch.ids.begin();
    const auto ends = end_positions(batch);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const Index length = std::min(batch.lengths[i], ends[i] + 1);
      out.ids.insert(out.ids.end(), from, from + length);
      out.lengths.push_back(length);
      from += batch.lengths[i];
    }
    return out;
  }

 private:
  static std::vector<Index> end_positions(const TokenBatch& batch) {
    std::vector<Index> out;
    auto from = batch.ids.begin();
    for (Index length : batch.lengths) {
      out.push_back(std::max_element(from, from + length) - from);
      from += length;
    }
    return out;
  }
};

/// Packs the weights of the blocks. Embeddings are looked up, not multiplied.
template <Backend B>
void prepare(ClipText<B>& network) {
  for (auto& block : network.blocks) prepare(block);
}

MOTIONLANG_NAMESPACE_END
