// SPDX-License-Identifier: MIT
// Bodies of text_motion_checkpoint.hpp.
#pragma once

#include <motionlang/weights/text_motion_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string checkpoint_system(const RunFolder& run) {
  const FileValue* system = run.system == "motionlang" ? run.option("system") : nullptr;
  return system == nullptr ? run.system : "trained " + to_string(*system);
}

MOTIONLANG_BODY KnownWords known_words_of(const WordPiece& pieces, const WordVectors& vectors) {
  if (vectors.empty()) return {};
  std::vector<std::string> words;
  for (const std::string& piece : pieces.vocabulary()) {
    if (piece.front() != '#' && piece.front() != '[') words.push_back(piece);
  }
  return KnownWords(std::move(words), vectors);
}

MOTIONLANG_BODY void require_trained(const std::filesystem::path& folder, const std::string& found,
                                     const char* wanted) {
  if (found != wanted) raise<config_error>(102, folder.string(), ": a model of ", found, ", not ", wanted);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
