// SPDX-License-Identifier: MIT
// Bodies of own_text_encoder.hpp.
#pragma once

#include <algorithm>  // find

#include <motionlang/file/file.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/weights/own_text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> own_vocabulary(std::span<const std::string> texts, Index size) {
  const WordPiece learned = WordPiece::learn(texts, size);
  std::vector<std::string> out{"[PAD]"};
  out.insert(out.end(), learned.vocabulary().begin(), learned.vocabulary().end());
  for (const char* mark : {".", ",", "'", "-"}) {
    if (std::find(out.begin(), out.end(), mark) == out.end()) out.emplace_back(mark);
  }
  return out;
}

namespace detail {

MOTIONLANG_BODY void write_own_tokenizer(const std::filesystem::path& folder, const OwnTokenizer& tokenizer) {
  const BertConfig& c = tokenizer.sizes;
  const nlohmann::ordered_json config{{"model_type", "distilbert"},
                                      {"dim", c.width},
                                      {"n_heads", c.heads},
                                      {"n_layers", c.layers},
                                      {"hidden_dim", c.d_ff},
                                      {"vocab_size", c.vocabulary},
                                      {"max_position_embeddings", c.positions},
                                      {"activation", "gelu"},
                                      {"pad_token_id", c.padding}};
  std::string pieces;
  for (const std::string& piece : tokenizer.pieces->vocabulary()) pieces += piece + "\n";
  write_file(folder / "config.json", std::string_view(config.dump(2) + "\n"));
  write_file(folder / "vocab.txt", std::string_view(pieces));
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
