// SPDX-License-Identifier: MIT
/// A small text encoder that is trained together with a denoiser: a DistilBERT of a few layers with word pieces of the
/// training texts. Its folder has the form of Hugging Face, so load_text_encoder reads it.
///
///     const auto pieces = own_vocabulary(texts, 800);
///     const OwnTextEncoder<B> encoder({.vocabulary = std::ssize(pieces), .width = 128}, pieces, true, rng);
///     write_own_text_encoder("run/model/text_encoder", encoder);
#pragma once

#include <filesystem>  // folders
#include <memory>      // a tokenizer
#include <span>        // texts
#include <string>      // pieces
#include <utility>     // move
#include <vector>      // pieces

#include <motionlang/nn/pooling.hpp>
#include <motionlang/text/bert.hpp>
#include <motionlang/text/bert_tokenizer.hpp>
#include <motionlang/weights/module_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Ids of a text with its marks of start and end; the rest is cut off.
inline constexpr Index own_text_longest = 64;

/// The marks of BERT, and up to `size` word pieces of the texts.
std::vector<std::string> own_vocabulary(std::span<const std::string> texts, Index size);

struct OwnTokenizer {
  static constexpr bool is_option = true;  // holds no tensors
  std::shared_ptr<const BertTokenizer> pieces{};
  BertConfig sizes{};
  bool pooled = true;  // one vector for each text, the mean of its states; otherwise all states
};

template <Backend B>
struct OwnTextEncoder {
  DistilBert<B> network;
  OwnTokenizer tokenizer;

  static constexpr auto fields() {
    using M = OwnTextEncoder;
    return motionlang::fields("network", &M::network, "tokenizer", &M::tokenizer);
  }
  OwnTextEncoder() = default;
  /// sizes.vocabulary and sizes.positions follow from the rest.
  OwnTextEncoder(BertConfig sizes, const std::vector<std::string>& vocabulary, bool pooled, Rng auto& rng) {
    sizes.vocabulary = std::ssize(vocabulary), sizes.positions = own_text_longest;
    BertTokenizerOptions options;
    options.longest = own_text_longest, options.truncate = true;
    tokenizer = {std::make_shared<const BertTokenizer>(vocabulary, options), sizes, pooled};
    network = DistilBert<B>(sizes, rng);
  }

  TextFeatures<B> operator()(std::span<const std::string> texts, const Context& context = {}) const {
    const ModuleScope scope(*this);
    auto states = network(tokenize(*tokenizer.pieces, texts), context);
    if (tokenizer.pooled) return TextFeatures<B>::pooled(mean_rows(states.tokens));
    for (Index i = 0; i < states.count(); ++i) states.end_position.push_back(states.tokens.offsets.length(i) - 1);
    return states;
  }
};

namespace detail {
/// config.json and vocab.txt.
void write_own_tokenizer(const std::filesystem::path& folder, const OwnTokenizer& tokenizer);
}  // namespace detail

/// Writes config.json, vocab.txt and model.safetensors over the existing ones. Throws io_error 401.
template <Backend B>
void write_own_text_encoder(const std::filesystem::path& folder, const OwnTextEncoder<B>& encoder) {
  TensorStore store;
  store.add_module(encoder.network);
  std::filesystem::create_directories(folder);
  write_safetensors(folder / "model.safetensors", store.views(), {{"format", "pt"}});
  detail::write_own_tokenizer(folder, encoder.tokenizer);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/own_text_encoder.ipp>
#endif
