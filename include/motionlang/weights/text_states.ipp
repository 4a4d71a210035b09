// SPDX-License-Identifier: MIT
// Bodies of text_states.hpp.
#pragma once

#include <map>  // texts about the same frames
#include <set>  // texts about the same frames

#include <motionlang/weights/text_states.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool reads_pieces(const TextTokensConfig& text, const std::filesystem::path& from) {
  if (text.encoder != "word_pieces" && text.encoder != "distilbert")
    raise<config_error>(103, "text.encoder '", text.encoder, "' is not word_pieces or distilbert");
  const bool pieces = text.encoder == "word_pieces";
  if (pieces != from.empty())
    raise<config_error>(102, pieces ? "`text_encoder` is for text.encoder = distilbert"
                                    : "text.encoder = distilbert needs `text_encoder`, a folder or a cache; "
                                      "without one: text.encoder = word_pieces");
  return pieces;
}

namespace detail {

MOTIONLANG_BODY std::map<std::string, std::string> texts_beside(const DescribedMotions& data) {
  std::map<std::string, std::set<std::string>> beside;
  for (const auto* part : data.parts()) {
    for (const DescribedMotion& m : *part) {
      for (const DescribedText& a : m.texts) {
        for (const DescribedText& b : m.texts) {
          if (a.frames == b.frames) beside[a.text].insert(b.text);
        }
      }
    }
  }
  std::map<std::string, std::string> joined;
  for (const auto& [text, all] : beside) {
    std::string& lines = joined[text];
    for (const std::string& other : all) lines += other + "\n";
  }
  return joined;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
