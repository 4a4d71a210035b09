// SPDX-License-Identifier: MIT
/// A tokenizer and a network make a text encoder.
///
///     // MDM, STMC
///     const TokenizedEncoder clip(clip_tokenizer, load_clip_text<B>(weights), {.pooling = Pooling::end});
///     // TEMOS, TMR
///     const TokenizedEncoder tokens(bert_tokenizer, load_text_network<DistilBert<B>>(config, weights));
///     const TokenizedEncoder sentences(bert_tokenizer, load_text_network<Mpnet<B>>(config, weights),
///                                      {.pooling = Pooling::mean, .normalize = true});
#pragma once

#include <motionlang/nn/pooling.hpp>
#include <motionlang/text/text_encoder.hpp>
#include <motionlang/text/tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TextOptions {
  Pooling pooling = Pooling::none;
  bool normalize = false;  // scale pooled vectors to length 1
  Index width = 0;         // pads all texts to this many ids, as for MotionDiffuse (77); 0: no padding, as for the mean
  Index padding = 0;       // the id of padding
};

/// The network takes a TokenBatch and returns TextFeatures<B>. Two functions are optional: `until_end(batch)`, the part
/// that the end token depends on, and `project(rows)`, which is applied to its vector.
template <Tokenizer T, class Network>
struct TokenizedEncoder {
  T tokenizer;
  Network network;
  TextOptions options{};

  TokenizedEncoder(T t, Network n, const TextOptions& o = {})
      : tokenizer(std::move(t)), network(std::move(n)), options(o) {}

  template <Backend B>
  requires requires(const Network& n, const TokenBatch& batch) {
    { n(batch) } -> std::same_as<TextFeatures<B>>;
  }
  TextFeatures<B> encode(std::span<const std::string> texts) const {
    TokenBatch batch = tokenize(tokenizer, texts);
    if (options.width > 0) {
      batch.ids = batch.padded(options.padding, options.width);
      batch.lengths.assign(batch.lengths.size(), options.width);
    }
    if (options.pooling == Pooling::none) return network(batch);
    const bool end = options.pooling == Pooling::end;
    if constexpr (requires { network.until_end(batch); }) {
      if (end) batch = network.until_end(batch);
    }
    auto rows = pool(network(batch), options.pooling);
    if constexpr (requires { network.project(rows); }) {
      if (end) rows = network.project(rows);
    }
    return TextFeatures<B>::pooled(options.normalize ? normalize_rows(rows) : rows);
  }
};

MOTIONLANG_NAMESPACE_END
