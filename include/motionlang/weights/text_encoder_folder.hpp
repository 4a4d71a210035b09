// SPDX-License-Identifier: MIT
/// Text encoders of several networks from the folders and files of their publishers.
///
///     // Hugging Face: a folder. OpenAI: a file, with the vocabulary beside it.
///     const auto clip = load_text_encoder<B>("clip-vit-base-patch32", clip_sentences());
///     const auto same = load_text_encoder<B>("ViT-B-32.pt", clip_sentences());
///     // The states of all words.
///     const auto words = load_text_encoder<B>("distilbert-base-uncased");
///
/// Hugging Face  config.json with model_type clip, clip_text_model, distilbert, bert, roberta or mpnet; weights
///               (weights/run_folder.hpp); a tokenizer.json, vocab.txt, or vocab.json with merges.txt
/// OpenAI        a file or a folder with the tensors of CLIP (ViT-B-32.pt), and bpe_simple_vocab_16e6.txt.gz in the
///               same folder
#pragma once

#include <motionlang/text/tokenized_encoder.hpp>
#include <motionlang/weights/text_network_file.hpp>
#include <motionlang/weights/tokenizer_json.hpp>
#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One of several networks; the file decides which.
template <Backend B>
struct AnyTextNetwork {
  std::variant<ClipText<B>, DistilBert<B>, Bert<B>, Mpnet<B>, Roberta<B>> network;

  bool is_clip() const { return network.index() == 0; }
  TextFeatures<B> operator()(const TokenBatch& batch) const {
    return std::visit([&](const auto& n) { return n(batch); }, network);
  }
  /// Throws config_error 102 if the network has no end token that represents a text.
  TokenBatch until_end(const TokenBatch& batch) const { return clip().until_end(batch); }
  Tensor<B, 2> project(const Tensor<B, 2>& rows) const { return clip().project(rows); }

 private:
  const ClipText<B>& clip() const {
    if (!is_clip()) raise<config_error>(102, "AnyTextNetwork: only CLIP's end token stands for the text");
    return std::get<0>(network);
  }
};

template <Backend B>
using AnyTextEncoder = TokenizedEncoder<AnyTokenizer, AnyTextNetwork<B>>;

/// The outputs of the encoder that a system uses.
struct TextEncoderOptions {
  TextOptions text{};
  TokenizerLimits limits{};
};
/// One vector of CLIP for each text, for MDM-SMPL and MDM (which cuts texts to 22 ids). Texts are always cleaned as by
/// OpenAI, because these systems were trained with its CLIP.
TextEncoderOptions clip_sentences(Index longest = 77);
/// All 77 rows of CLIP, for MotionDiffuse. Texts are cleaned likewise.
inline TextEncoderOptions clip_states() {
  return {.text = {.width = 77}, .limits = {.longest = 77, .truncate = true, .cleaning = ClipCleaning::original}};
}

namespace detail {

inline constexpr const char* clip_vocabularies[] = {"bpe_simple_vocab_16e6.txt.gz", "bpe_simple_vocab_16e6.txt"};

AnyTokenizer tokenizer_of(const std::filesystem::path& folder, const TokenizerLimits& limits, bool clip);

/// The weights of a folder, and the sizes in its config.json.
struct TextNetworkFiles {
  WeightFile weights;
  std::variant<ClipTextConfig, BertConfig> config;
  std::string type;  // distilbert, bert, roberta or mpnet; unused for CLIP
};
/// file  its config.json. Throws config_error 103 for another model_type
TextNetworkFiles text_network_files(const FilePath& file, const FilePath& folder);

template <Backend B>
AnyTextNetwork<B> text_network(const TextNetworkFiles& files) {
  if (const auto* clip = std::get_if<ClipTextConfig>(&files.config)) return {load_clip_text<B>(*clip, files.weights)};
  const auto& config = std::get<BertConfig>(files.config);
  if (files.type == "distilbert") return {load_text_network<DistilBert<B>>(config, files.weights)};
  if (files.type == "bert") return {load_text_network<Bert<B>>(config, files.weights)};
  if (files.type == "roberta") return {load_text_network<Roberta<B>>(config, files.weights)};
  return {load_text_network<Mpnet<B>>(config, files.weights)};
}

/// Throws unless the highest id of a tokenizer has a row.
void check_vocabulary(const AnyTokenizer& tokenizer, Index rows, const std::string& where);
template <Backend B>
void check_vocabulary(const AnyTokenizer& tokenizer, const AnyTextNetwork<B>& network, const std::string& where) {
  const Index rows = std::visit(
      [](const auto& n) {
        if constexpr (requires { n.token_embedding; })
          return n.token_embedding.weight.size(0);
        else
          return n.words.weight.size(0);
      },
      network.network);
  check_vocabulary(tokenizer, rows, where);
}

}  // namespace detail

/// CLIP's text tower among other tensors ("clip." in checkpoints of MotionDiffuse), with the tokenizer of a folder.
template <Backend B>
AnyTextEncoder<B> load_clip_encoder(const TensorSet& weights, const FilePath& tokenizer_folder,
                                    const TextEncoderOptions& options) {
  AnyTokenizer tokenizer = detail::tokenizer_of(tokenizer_folder.string(), options.limits, true);
  AnyTextNetwork<B> network{load_clip_text<B>(weights)};
  detail::check_vocabulary(tokenizer, network, weights.name());
  return {std::move(tokenizer), std::move(network), options.text};
}

/// path    a folder, or OpenAI's file
/// Throws  io_error 401 with the name of the missing file; config_error 103 for another network, 102 if tokenizer and
///         network do not match, and what their readers throw
template <Backend B>
AnyTextEncoder<B> load_text_encoder(const FilePath& path, const TextEncoderOptions& options = {}) {
  const std::filesystem::path given = path.string();
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(given, ignored);
  const auto folder = is_folder ? given : given.parent_path();
  const auto file = folder / "config.json";
  if (!is_folder || !detail::file_exists(file)) return load_clip_encoder<B>(open_weights(path), folder, options);
  AnyTextNetwork<B> network = detail::text_network<B>(detail::text_network_files(file, path));
  AnyTokenizer tokenizer = detail::tokenizer_of(folder, options.limits, network.is_clip());
  detail::check_vocabulary(tokenizer, network, given.string());
  return {std::move(tokenizer), std::move(network), options.text};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/text_encoder_folder.ipp>
#endif
