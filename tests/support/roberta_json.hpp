// SPDX-License-Identifier: MIT
/// A made-up tokenizer of RoBERTa.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <motionlang/text/clip_tokenizer.hpp>

/// A tokenizer.json of RoBERTa with all symbols of bytes and one merge.
inline std::string roberta_json() {
  const auto symbols = motionlang::ClipTokenizer(motionlang::BytePairMerges{}).vocabulary();
  std::string vocabulary = R"("<s>": 0, "<pad>": 1, "</s>": 2, "<unk>": 3)";
  for (std::size_t i = 0; i < 256; ++i)
    vocabulary += ", " + nlohmann::json(symbols[i]).dump() + ": " + std::to_string(4 + i);
  return R"({"added_tokens": [{"id": 0, "content": "<s>", "normalized": true}, {"id": 261, "content": "<mask>"}],
    "normalizer": null, "pre_tokenizer": {"type": "ByteLevel", "add_prefix_space": false, "trim_offsets": true},
    "post_processor": {"type": "RobertaProcessing", "sep": ["</s>", 2], "cls": ["<s>", 0], "add_prefix_space": false},
    "model": {"type": "BPE", "dropout": null, "unk_token": null, "continuing_subword_prefix": "",
      "end_of_word_suffix": "", "vocab": {)" +
         vocabulary + R"(, "wa": 260}, "merges": [["w", "a"]]}})";
}
