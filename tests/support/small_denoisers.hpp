// SPDX-License-Identifier: MIT
/// Small models over each of the three published denoisers: MDM-SMPL, MDM, MotionDiffuse.
#pragma once

#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>

#include "small_model.hpp"

namespace small {

using B = ml::EigenBackend<float>;

/// Says where the end token stands, as MotionDiffuse wants to know, and gives "" a vector of choice.
struct Encoder {
  ml::CaptionEncoder<B> captions;
  double empty = 1;  // factor of the features of ""

  template <ml::Backend C>
  ml::TextFeatures<C> encode(std::span<const std::string> texts) const {
    auto features = captions.template encode<C>(texts);
    features.end_position.assign(texts.size(), 0);
    std::vector<float> factors;
    for (const std::string& t : texts) factors.push_back(t.empty() ? static_cast<float>(empty) : 1);
    features.tokens.rows = features.tokens.rows * ml::Tensor<C, 2>::from(factors, {std::ssize(factors), 1});
    return features;
  }
};

constexpr Index crop_frames = 24;

template <class D>
D denoiser_of(ml::Philox rng) {
  if constexpr (std::same_as<D, ml::MdmSmplDenoiser<B>>) {
    return D(config().denoiser, rng);
  } else if constexpr (std::same_as<D, ml::MdmDenoiser<B>>) {
    return D({.nfeats = 205,
              .text_dim = 12,
              .latent_dim = 32,
              .ff_size = 48,
              .num_layers = 2,
              .num_heads = 4,
              .crop_frames = crop_frames},
             rng);
  } else {
    return D({.input_feats = 205,
              .num_frames = crop_frames,
              .latent_dim = 32,
              .ff_size = 48,
              .num_layers = 2,
              .num_heads = 4,
              .clip_dim = 12,
              .text_latent_dim = 16,
              .num_text_layers = 1,
              .text_num_heads = 2,
              .text_ff_size = 24},
             rng);
  }
}

template <class D>
ml::Stmc<B, D, Encoder> model_of(double empty = 1) {
  const ml::Philox rng{.seed = 5};
  auto text_rng = rng.split("text");
  return {.denoiser = denoiser_of<D>(rng.split("denoiser")),
          .text_encoder = {ml::CaptionEncoder<B>(config().text, tokenizer(), text_rng), empty},
          .motion_normalizer = ml::Normalizer<B>::identity(205),
          .text_normalizer = ml::Normalizer<B>::identity(12),
          .diffusion = ml::GaussianDiffusion(ml::CosineSchedule{.steps = 6})};
}

}  // namespace small
