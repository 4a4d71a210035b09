// SPDX-License-Identifier: MIT
/// MotionDiffuse: linear attention, conditioning by scale and shift, a transformer over CLIP's token states.
#pragma once

#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/nn/linear_attention.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of the HumanML3D release.
struct MotionDiffuseConfig {
  static constexpr bool is_option = true;  // holds no tensors
  Index input_feats = 263;
  Index num_frames = 196;  // rows of the learned positions
  Index latent_dim = 512;
  Index ff_size = 1024;
  Index num_layers = 8;
  Index num_heads = 8;
  Index clip_dim = 512;
  Index text_latent_dim = 256;
  Index num_text_layers = 4;
  Index text_num_heads = 4;
  Index text_ff_size = 2048;
  Activation activation = Activation::gelu;
  bool no_eff = false;  // standard attention, which masks nothing in the released code
};

/// "Stylization": Linear(silu(LN(h) (1 + scale) + shift)), scale and shift from the embedding of time and text.
template <Backend B>
struct StylizationBlock {
  Linear<B> emb_layer, out_layer;
  LayerNorm<B> norm;

  static constexpr auto fields() {
    using M = StylizationBlock;
    return motionlang::fields("emb_layers.1", &M::emb_layer, "norm", &M::norm, "out_layers.2", &M::out_layer);
  }
  StylizationBlock() = default;
  StylizationBlock(Index width, Index time_width, Rng auto& rng)
      : emb_layer(time_width, 2 * width, rng), out_layer(width, width, rng), norm(width) {}

  /// h and x (rows, width), emb (sequences, time width): adds the result for h to x
  Tensor<B, 2> operator()(const Tensor<B, 2>& h, const Tensor<B, 2>& emb, const Offsets& offsets,
                          const Tensor<B, 2>& x) const {
    const ModuleScope scope(*this);
    const Index d = h.size(1);
    const auto modulation = emb_layer(activate(emb, Activation::silu));
    const auto scale = repeat_for_rows(slice(modulation, 1, 0, d) + 1.0, offsets);
    const auto shift = repeat_for_rows(slice(modulation, 1, d, 2 * d), offsets);
    return out_layer(activate(norm(h) * scale + shift, Activation::silu), Activation::none, &x);
  }
};

/// Attention of a decoder block, to the motion itself or to the text.
template <Backend B>
struct MotionDiffuseAttention {
  LayerNorm<B> norm;
  std::optional<LayerNorm<B>> text_norm;  // cross-attention only
  Linear<B> query, key, value;
  StylizationBlock<B> proj_out;
  Index heads = 8;
  bool no_eff = false;

  static constexpr auto fields() {
    using M = MotionDiffuseAttention;
    return motionlang::fields("norm", &M::norm, "text_norm", &M::text_norm, "query", &M::query, "key", &M::key, "value",
                              &M::value, "proj_out", &M::proj_out, "heads", &M::heads, "no_eff", &M::no_eff);
  }
  MotionDiffuseAttention() = default;
  MotionDiffuseAttention(const MotionDiffuseConfig& c, bool cross, Rng auto& rng)
      : norm(c.latent_dim),
        query(c.latent_dim, c.latent_dim, rng),
        key(cross ? c.text_latent_dim : c.latent_dim, c.latent_dim, rng),
        value(cross ? c.text_latent_dim : c.latent_dim, c.latent_dim, rng),
        proj_out(c.latent_dim, 4 * c.latent_dim, rng),
        heads(c.num_heads),
        no_eff(c.no_eff) {
    if (cross) text_norm.emplace(c.text_latent_dim);
  }

  /// Self-attention if there is no text.
  Tensor<B, 2> operator()(const Sequences<B>& x, const Sequences<B>* text, const Tensor<B, 2>& emb) const {
    const ModuleScope scope(*this);
    const auto n = norm(x.rows), source = text == nullptr ? n : (*text_norm)(text->rows);
    const Offsets& keys = text == nullptr ? x.offsets : text->offsets;
    const auto q = query(n), k = key(source), v = value(source);
    const auto y = no_eff
                       ? attention(q, k, v, x.offsets, keys, {.heads = heads, .precision = precision_of(query.weight)})
                       : linear_attention(q, k, v, x.offsets, keys, heads);
    return proj_out(y, emb, x.offsets, x.rows);
  }
};

template <Backend B>
struct MotionDiffuseFeedForward {
  Linear<B> linear1, linear2;
  StylizationBlock<B> proj_out;

  static constexpr auto fields() {
    using M = MotionDiffuseFeedForward;
    return motionlang::fields("linear1", &M::linear1, "linear2", &M::linear2, "proj_out", &M::proj_out);
  }
  Tensor<B, 2> operator()(const Sequences<B>& x, const Tensor<B, 2>& emb) const {
    const ModuleScope scope(*this);
    return proj_out(linear2(linear1(x.rows, Activation::gelu)), emb, x.offsets, x.rows);
  }
};

template <Backend B>
struct MotionDiffuseBlock {
  MotionDiffuseAttention<B> sa_block, ca_block;
  MotionDiffuseFeedForward<B> ffn;

  static constexpr auto fields() {
    using M = MotionDiffuseBlock;
    return motionlang::fields("sa_block", &M::sa_block, "ca_block", &M::ca_block, "ffn", &M::ffn);
  }
  MotionDiffuseBlock() = default;
  MotionDiffuseBlock(const MotionDiffuseConfig& c, Rng auto& rng)
      : sa_block(c, false, rng),
        ca_block(c, true, rng),
        ffn{{c.latent_dim, c.ff_size, rng}, {c.ff_size, c.latent_dim, rng}, {c.latent_dim, 4 * c.latent_dim, rng}} {}

  Sequences<B> operator()(Sequences<B> x, const Sequences<B>& text, const Tensor<B, 2>& emb) const {
    const ModuleScope scope(*this);
    x.rows = sa_block(x, nullptr, emb);
    x.rows = ca_block(x, &text, emb);
    x.rows = ffn(x, emb);
    return x;
  }
};

/// Predicts the noise. Frames beyond a sequence's length are absent, because linear attention gives masked frames no
/// weight. With `no_eff` the released mask shifts whole rows of scores and hides nothing, so there all frames must be
/// given.
/// Source  Zhang et al. (2022), section 3; mingyuan-zhang/MotionDiffuse text2motion/models/transformer.py, with its
///         keys (without the CLIP tower, whose states after the last layer norm are the input)
template <Backend B>
struct MotionDiffuseDenoiser {
  Tensor<B, 2> sequence_embedding;  // (num_frames, latent)
  Linear<B> text_pre_proj;
  TransformerEncoder<B> textTransEncoder;
  LayerNorm<B> text_ln;
  Linear<B> text_proj, joint_embed, time_in, time_out;
  std::vector<MotionDiffuseBlock<B>> temporal_decoder_blocks;
  Linear<B> out;
  MotionDiffuseConfig config;

  static constexpr auto fields() {
    using M = MotionDiffuseDenoiser;
    return motionlang::fields("sequence_embedding", &M::sequence_embedding, "text_pre_proj", &M::text_pre_proj,
                              "textTransEncoder", &M::textTransEncoder, "text_ln", &M::text_ln, "text_proj.0",
                              &M::text_proj, "joint_embed", &M::joint_embed, "time_embed.0", &M::time_in,
                              "time_embed.2", &M::time_out, "temporal_decoder_blocks", &M::temporal_decoder_blocks,
                              "out", &M::out, "config", &M::config);
  }
  MotionDiffuseDenoiser() = default;
  MotionDiffuseDenoiser(const MotionDiffuseConfig& c, Rng auto& rng)
      : sequence_embedding(normal_init<B, 2>({c.num_frames, c.latent_dim}, 1, rng)),
        text_pre_proj(c.clip_dim, c.text_latent_dim, rng),
        textTransEncoder({.d_model = c.text_latent_dim,
                          .heads = c.text_num_heads,
                          .d_ff = c.text_ff_size,
                          .layers = c.num_text_layers,
                          .activation = c.activation,
                          .dropout = 0},
                         rng),
        text_ln(c.text_latent_dim),
        text_proj(c.text_latent_dim, 4 * c.latent_dim, rng),
        joint_embed(c.input_feats, c.latent_dim, rng),
        time_in(c.latent_dim, 4 * c.latent_dim, rng),
        time_out(4 * c.latent_dim, 4 * c.latent_dim, rng),
        out(c.latent_dim, c.input_feats, rng),
        config(c) {
    for (Index i = 0; i < c.num_layers; ++i) temporal_decoder_blocks.emplace_back(c, rng);
  }

  DenoiserTraits traits() const {
    return {.prediction = Prediction::eps, .crop_frames = config.num_frames, .uses_lengths = !config.no_eff};
  }

  /// The part that depends only on the text. It is the same at every step.
  struct EncodedText {
    Tensor<B, 2> xf_proj;  // (sequences, 4 latent)
    Sequences<B> xf_out;   // text rows, text width
  };
  /// Throws shape_error 204 unless every text has an end token, and 203 if the end token is outside the text.
  EncodedText encode(const TextFeatures<B>& text) const {
    if (static_cast<Index>(text.end_position.size()) != text.count()) {
      raise<shape_error>(204, "MotionDiffuseDenoiser: ", text.count(), " texts, ", text.end_position.size(),
                         " end tokens");
    }
    const auto states = textTransEncoder(text.tokens.with(text_pre_proj(text.tokens.rows)));
    auto xf_out = states.with(text_ln(states.rows));
    PoolVector<Index> end;
    for (Index s = 0; s < text.count(); ++s) {
      const Index position = text.end_position[static_cast<std::size_t>(s)], length = xf_out.offsets.length(s);
      if (position < 0 || position >= length) {
        raise<shape_error>(203, "MotionDiffuseDenoiser: end token at row ", position, " of ", length, " of text ", s);
      }
      end.push_back(xf_out.offsets.begin(s) + position);
    }
    return {text_proj(gather(xf_out.rows, end)), xf_out};
  }
  /// The time MLP over a sinusoid with cosines first: w_k = exp(-ln(10000) k / half).
  Tensor<B, 2> time_embedding(std::span<const Index> t) const {
    using S = typename B::scalar;
    const Index half = config.latent_dim / 2;
    PoolVector<S> values(t.size() * static_cast<std::size_t>(2 * half));
    for (std::size_t s = 0; s < t.size(); ++s) {
      for (Index k = 0; k < half; ++k) {
        const float w =
            torch_exp(static_cast<float>(-std::log(10000.0)) * static_cast<float>(k) / static_cast<float>(half));
        const float angle = static_cast<float>(t[s]) * w;
        values[s * static_cast<std::size_t>(2 * half) + static_cast<std::size_t>(k)] = static_cast<S>(std::cos(angle));
        values[s * static_cast<std::size_t>(2 * half) + static_cast<std::size_t>(half + k)] =
            static_cast<S>(std::sin(angle));
      }
    }
    return time_out(time_in(Tensor<B, 2>::from(std::span<const S>(values), {static_cast<Index>(t.size()), 2 * half}),
                            Activation::silu));
  }
  Sequences<B> embed_frames(const Sequences<B>& x) const {
    PoolVector<Index> position;
    for (Index s = 0; s < x.count(); ++s) {
      for (Index i = 0; i < x.offsets.length(s); ++i) position.push_back(i);
    }
    return x.with(joint_embed(x.rows) + gather(sequence_embedding, position));
  }

  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const EncodedText& text,
                          const Context& = {}) const {
    const ModuleScope scope(*this);
    if (text.xf_out.count() != x.count() || static_cast<Index>(t.size()) != x.count()) {
      raise<shape_error>(204, "MotionDiffuseDenoiser: ", x.count(), " sequences, ", text.xf_out.count(), " texts, ",
                         t.size(), " steps");
    }
    const auto emb = time_embedding(t) + text.xf_proj;
    auto h = embed_frames(x);
    for (const auto& block : temporal_decoder_blocks) h = block(h, text.xf_out, emb);
    return out(h);
  }
  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return (*this)(x, t, encode(text), context);
  }
};

MOTIONLANG_NAMESPACE_END
