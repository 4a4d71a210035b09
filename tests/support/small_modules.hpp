// SPDX-License-Identifier: MIT
/// A small instance of every module of the library: Small<ml::Linear>::make<B>(rng), and the variants of the denoisers.
#pragma once

#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/text/caption_encoder.hpp>

namespace modules {

namespace ml = motionlang;
using ml::Index;

template <template <class> class M>
struct Small;

inline constexpr ml::TransformerConfig small_transformer{.d_model = 8, .heads = 2, .d_ff = 12, .layers = 2};

template <>
struct Small<ml::Linear> {
  template <ml::Backend B>
  static ml::Linear<B> make(ml::Philox rng) {
    return {3, 5, rng};
  }
};
template <>
struct Small<ml::Embedding> {
  template <ml::Backend B>
  static ml::Embedding<B> make(ml::Philox rng) {
    return {7, 4, rng};
  }
};
template <>
struct Small<ml::LayerNorm> {
  template <ml::Backend B>
  static ml::LayerNorm<B> make(ml::Philox) {
    return ml::LayerNorm<B>(6);
  }
};
template <>
struct Small<ml::Normalizer> {
  template <ml::Backend B>
  static ml::Normalizer<B> make(ml::Philox) {
    return ml::Normalizer<B>::identity(6);
  }
};
template <>
struct Small<ml::MultiheadAttention> {
  template <ml::Backend B>
  static ml::MultiheadAttention<B> make(ml::Philox rng) {
    return {8, 2, 0.1, rng};
  }
};
template <>
struct Small<ml::Gru> {
  template <ml::Backend B>
  static ml::Gru<B> make(ml::Philox rng) {
    return {3, 4, 2, rng};
  }
};
template <>
struct Small<ml::TimestepEmbedding> {
  template <ml::Backend B>
  static ml::TimestepEmbedding<B> make(ml::Philox rng) {
    return {8, rng};
  }
};
template <>
struct Small<ml::TransformerEncoder> {
  template <ml::Backend B>
  static ml::TransformerEncoder<B> make(ml::Philox rng) {
    return {small_transformer, rng};
  }
};
template <>
struct Small<ml::TransformerDecoder> {
  template <ml::Backend B>
  static ml::TransformerDecoder<B> make(ml::Philox rng) {
    return {small_transformer, rng};
  }
};
template <>
struct Small<ml::CaptionEncoder> {
  template <ml::Backend B>
  static ml::CaptionEncoder<B> make(ml::Philox rng) {
    const std::vector<std::string> captions{"walk forward", "raise both arms", "sit down", "walk and sit down"};
    return {{.width = 8, .heads = 2, .d_ff = 12, .layers = 1, .out = 5}, ml::WordPiece::learn(captions, 40), rng};
  }
};

/// The input of denoisers in these tests: 11 features, texts of width 12.
inline constexpr Index small_features = 11, small_text = 12;

/// One vector for each text.
struct PooledTexts {
  template <ml::Backend B>
  static ml::TextFeatures<B> texts(Index n, ml::Philox rng) {
    return ml::TextFeatures<B>::pooled(ml::Tensor<B, 2>::randn({n, small_text}, rng));
  }
};
/// Texts of two, three, ... tokens, the last one the end.
struct TokenTexts {
  template <ml::Backend B>
  static ml::TextFeatures<B> texts(Index n, ml::Philox rng) {
    std::vector<Index> lengths, end;
    for (Index i = 0; i < n; ++i) lengths.push_back(i + 2), end.push_back(i + 1);
    const ml::Offsets offsets(lengths);
    return {{ml::Tensor<B, 2>::randn({offsets.rows(), small_text}, rng), offsets}, end};
  }
};

struct SmallMdmSmpl : PooledTexts {
  template <ml::Backend B>
  static ml::MdmSmplDenoiser<B> make(ml::Philox rng) {
    return {{.nfeats = small_features,
             .tx_dim = small_text,
             .latent_dim = 16,
             .ff_size = 24,
             .num_layers = 2,
             .num_heads = 2},
            rng};
  }
};

inline constexpr ml::MdmConfig small_mdm{.nfeats = small_features,
                                         .text_dim = small_text,
                                         .latent_dim = 16,
                                         .ff_size = 24,
                                         .num_layers = 2,
                                         .num_heads = 2,
                                         .max_len = 64};
struct SmallMdmEncoder : PooledTexts {
  template <ml::Backend B>
  static ml::MdmDenoiser<B> make(ml::Philox rng) {
    return {small_mdm, rng};
  }
};
struct SmallMdmDecoder : PooledTexts {
  template <ml::Backend B>
  static ml::MdmDenoiser<B> make(ml::Philox rng) {
    auto c = small_mdm;
    c.arch = ml::MdmArch::trans_dec, c.class_token = ml::MdmClassToken::time_plus_text;
    return {c, rng};
  }
};
struct SmallMdmTokens : TokenTexts {
  template <ml::Backend B>
  static ml::MdmDenoiser<B> make(ml::Philox rng) {
    auto c = small_mdm;
    c.arch = ml::MdmArch::trans_dec, c.class_token = ml::MdmClassToken::time_only, c.text_sequence = true;
    return {c, rng};
  }
};
/// The recurrence over time: the published one runs over the batch, so that sequences depend on each other.
struct SmallMdmGru : PooledTexts {
  static constexpr bool equal_lengths = true;
  template <ml::Backend B>
  static ml::MdmDenoiser<B> make(ml::Philox rng) {
    auto c = small_mdm;
    c.arch = ml::MdmArch::gru, c.gru_over_batch = false;
    return {c, rng};
  }
};

template <bool standard_attention>
struct SmallMotionDiffuse : TokenTexts {
  template <ml::Backend B>
  static ml::MotionDiffuseDenoiser<B> make(ml::Philox rng) {
    return {{.input_feats = small_features,
             .num_frames = 64,
             .latent_dim = 16,
             .ff_size = 24,
             .num_layers = 1,
             .num_heads = 2,
             .clip_dim = small_text,
             .text_latent_dim = 8,
             .num_text_layers = 1,
             .text_num_heads = 2,
             .text_ff_size = 12,
             .no_eff = standard_attention},
            rng};
  }
};

}  // namespace modules
