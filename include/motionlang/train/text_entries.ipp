// SPDX-License-Identifier: MIT
// Bodies of text_entries.hpp.
#pragma once

#include <algorithm>  // find_if
#include <iterator>   // ssize

#include <motionlang/train/text_entries.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<TextEntry> text_entries(const std::vector<DescribedMotion>& part, const std::string& name) {
  std::vector<TextEntry> out;
  for (const DescribedMotion& m : part) {
    const auto first = std::ssize(out);
    for (const DescribedText& t : m.texts) {
      auto same =
          std::find_if(out.begin() + first, out.end(), [&](const TextEntry& e) { return e.frames == t.frames; });
      if (same == out.end()) same = out.insert(same, {&m, t.frames});
      same->texts.push_back(&t);
    }
  }
  if (out.empty()) raise<config_error>(101, "the part '", name, "' has no motions");
  return out;
}

MOTIONLANG_BODY std::span<const float> entry_rows(const TextEntry& e, Index first, Index length, Index width) {
  return std::span(e.motion->rows)
      .subspan(static_cast<std::size_t>((e.frames.first + first) * width), static_cast<std::size_t>(length * width));
}

MOTIONLANG_BODY CaptionPair entry_references(const TextEntry& e, const GloVe& words) {
  CaptionPair out;
  for (const DescribedText* t : e.texts) out.references.push_back(lemmas(words_of(*t, words)));
  out.references = three_references(out.references);
  return out;
}

MOTIONLANG_NAMESPACE_END
