// SPDX-License-Identifier: MIT
/// The start of a training from weights of an earlier one. What those know is kept, although the new training has other
/// words and other statistics of the features.
///
///     start_from(model, SafetensorsFile::open("examples/models/stmc_free.safetensors"));   // of the same sizes
#pragma once

#include <algorithm>  // clamp, min
#include <vector>     // rows

#include <motionlang/weights/stmc_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Rows (pieces, width) for the pieces of `wanted` from those of `known`, (pieces, width). A piece that both know keeps
/// its row. A word gets the mean of the pieces that it was split into. All others, and [UNK], get the mean of those.
/// has_vectors: unknown words had the row of [UNK] and a vector of their own, so they get that row.
std::vector<float> started_rows(const WordPiece& wanted, const WordPiece& known, const std::vector<float>& rows,
                                bool has_vectors);

/// Features that were normalised by `before` are now normalised by `after`: changes the first and the last layer, so
/// that the denoiser still does the same. The deviations of some features may grow many times. As the noise is the same
/// for all, no weight grows by more than `most`.
template <Backend B>
void change_normalizer(MdmSmplDenoiser<B>& denoiser, const Normalizer<B>& before, const Normalizer<B>& after) {
  using S = typename B::scalar;
  constexpr S most = 2;
  const Index features = denoiser.to_skel_layer.out(), width = denoiser.to_skel_layer.in();
  const auto mean0 = before.mean.span(), std0 = before.std.span(), mean1 = after.mean.span(), std1 = after.std.span();
  std::vector<S> in = denoiser.skel_embedding.weight.to_vector(), in_bias = denoiser.skel_embedding.bias.to_vector();
  std::vector<S> out = denoiser.to_skel_layer.weight.to_vector(), out_bias = denoiser.to_skel_layer.bias.to_vector();
  for (Index f = 0; f < features; ++f) {
    const auto k = static_cast<std::size_t>(f);
    const S moved = std::clamp<S>((mean1[k] - mean0[k]) / std0[k], -1, 1);
    const S wider = std::min<S>(std1[k] / std0[k], most), narrower = std::min<S>(std0[k] / std1[k], most);
    for (Index w = 0; w < width; ++w) {
      S& weight = in[static_cast<std::size_t>(w * features + f)];
      in_bias[static_cast<std::size_t>(w)] += weight * moved;
      weight *= wider;
      out[static_cast<std::size_t>(f * width + w)] *= narrower;
    }
    out_bias[k] = out_bias[k] * narrower + (mean0[k] - mean1[k]) / std1[k];
  }
  denoiser.skel_embedding.weight = Tensor<B, 2>::from(in, {width, features});
  denoiser.skel_embedding.bias = Tensor<B, 1>::from(in_bias, {width});
  denoiser.to_skel_layer.weight = Tensor<B, 2>::from(out, {features, width});
  denoiser.to_skel_layer.bias = Tensor<B, 1>::from(out_bias, {features});
}

}  // namespace detail

/// Fills a model that has its vocabulary, word vectors and normaliser. Vectors of words that `trained` does not have
/// count nothing at first. Throws io_error 406, 407 for other sizes, config_error 102 if both have word vectors and
/// they differ, and config_error 103, 107 if it is not an STMC model.
template <Backend B>
void start_from(Stmc<B>& model, const SafetensorsFile& trained) {
  stmc_config(trained);
  CaptionEncoder<B>& encoder = model.text_encoder;
  const WordPiece known = detail::metadata_vocabulary(trained.metadata(), trained.name());
  const WordVectors vectors = stored_word_vectors(trained, detail::vector_tensors);
  if (!vectors.empty() && vectors.checksum() != encoder.vectors.checksum())
    raise<config_error>(102, trained.name(), " has the word vectors ", vectors.checksum(), ", the training has ",
                        encoder.vectors.empty() ? std::string("none") : encoder.vectors.checksum());
  load_module(model.denoiser, trained, "denoiser.");
  load_module(encoder.encoder, trained, "text_encoder.encoder.");
  load_module(encoder.norm, trained, "text_encoder.norm.");
  load_module(encoder.projection, trained, "text_encoder.projection.");
  load_module(model.text_normalizer, trained, "text_normalizer.");

  const Index width = encoder.embedding.weight.size(1);
  Embedding<B> embedding;
  embedding.weight = Tensor<B, 2>::zeros({known.size(), width});
  load_module(embedding, trained, "text_encoder.embedding.");
  const std::vector<float> rows(embedding.weight.span().begin(), embedding.weight.span().end());
  const auto started = detail::started_rows(encoder.tokenizer, known, rows, !vectors.empty());
  encoder.embedding.weight = Tensor<B, 2>::from(std::vector<typename B::scalar>(started.begin(), started.end()),
                                                {encoder.tokenizer.size(), width});
  if (!vectors.empty()) {
    load_module(*encoder.vector_projection, trained, "text_encoder.vector_projection.");
  } else if (encoder.vector_projection) {
    encoder.vector_projection->weight = Tensor<B, 2>::zeros(encoder.vector_projection->weight.shape());
  }

  auto before = Normalizer<B>::identity(model.denoiser.to_skel_layer.out());
  load_module(before, trained, "motion_normalizer.");
  detail::change_normalizer(model.denoiser, before, model.motion_normalizer);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/stmc_start.ipp>
#endif
