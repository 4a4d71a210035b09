// SPDX-License-Identifier: MIT
// Bodies of text_encoder_folder.hpp.
#pragma once

#include <motionlang/file/json.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TextEncoderOptions clip_sentences(Index longest) {
  return {.text = {.pooling = Pooling::end},
          .limits = {.longest = longest, .truncate = true, .cleaning = ClipCleaning::original}};
}

namespace detail {

MOTIONLANG_BODY AnyTokenizer tokenizer_of(const std::filesystem::path& folder, const TokenizerLimits& limits,
                                          bool clip) {
  for (const char* name : {"tokenizer.json", "vocab.txt", "vocab.json"}) {
    if (file_exists(folder / name)) return read_tokenizer(folder, limits);
  }
  ClipTokenizerOptions options;
  options.longest = limits.longest.value_or(options.longest);
  options.truncate = limits.truncate.value_or(options.truncate);
  for (const char* name : clip_vocabularies) {
    if (clip && file_exists(folder / name)) return read_clip_tokenizer(folder / name, options);
  }
  raise<io_error>(401, folder.string(), ": no tokenizer of the text encoder: put ",
                  clip ? "bpe_simple_vocab_16e6.txt.gz (of github.com/openai/CLIP), or tokenizer.json, "
                       : "tokenizer.json, or vocab.txt, ",
                  "there");
}

MOTIONLANG_BODY TextNetworkFiles text_network_files(const FilePath& file, const FilePath& folder) {
  const auto document = read_json(file);
  const JsonView config(document, file.string());
  WeightFile weights = open_weights(folder);
  const auto type = config["model_type"].as<std::string>();
  if (type == "clip" || type == "clip_text_model") return {std::move(weights), clip_text_config(config), type};
  if (type != "distilbert" && type != "bert" && type != "roberta" && type != "mpnet")
    raise<config_error>(103, config.path(), ": model_type '", type,
                        "' is not one of clip, distilbert, bert, roberta, mpnet");
  return {std::move(weights), bert_config(config, type), type};
}

MOTIONLANG_BODY void check_vocabulary(const AnyTokenizer& tokenizer, Index rows, const std::string& where) {
  if (tokenizer.size() > rows)
    raise<config_error>(102, where, ": a tokenizer of ", counted(tokenizer.size(), "piece"), ", the network knows ",
                        rows);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
