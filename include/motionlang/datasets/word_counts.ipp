// SPDX-License-Identifier: MIT
// Bodies of word_counts.hpp.
#pragma once

#include <algorithm>  // count_if
#include <set>        // ids, verbs
#include <utility>    // move

#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/annotated_texts.hpp>
#include <motionlang/datasets/caption_card.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/datasets/word_counts.hpp>
#include <motionlang/text/action_phrases.hpp>
#include <motionlang/text/word_forms.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Letters, digits, apostrophes and inner hyphens make words.
inline std::vector<std::string> plain_words(std::string_view text) {
  std::vector<std::string> out(1);
  for (const char c : text) {
    const char l = lower(c);
    const bool part = (l >= 'a' && l <= 'z') || (l >= '0' && l <= '9') || l == '\'' || l == '-' || (l & 0x80) != 0;
    if (part)
      out.back() += l;
    else if (!out.back().empty())
      out.emplace_back();
  }
  for (std::string& w : out) {
    while (!w.empty() && (w.back() == '-' || w.back() == '\'')) w.pop_back();
    while (!w.empty() && (w.front() == '-' || w.front() == '\'')) w.erase(0, 1);
  }
  std::erase(out, "");
  return out;
}

}  // namespace detail

MOTIONLANG_BODY DataTexts texts_of_data(const std::filesystem::path& path) {
  DataTexts out;
  if (std::filesystem::is_directory(path)) {
    const HumanMl3dFolder data{FilePath(path)};
    std::vector<std::string> splits{"all"};
    if (!std::filesystem::exists(path / "all.txt")) splits = {"train", "val", "test"};
    std::set<std::string> ids;
    for (const std::string& split : splits) {
      for (std::string& id : data.ids(split)) ids.insert(std::move(id));
    }
    for (const std::string& id : ids) {
      if (id.front() == 'M' && ids.contains(id.substr(1))) continue;
      for (const MotionCaption& caption : data.captions(id)) {
        out.texts.push_back(caption.text);
        for (std::string& phrase : action_phrases(caption.words)) out.phrases.push_back(std::move(phrase));
      }
    }
  } else if (path.extension() == ".json") {
    for (const AnnotatedMotion& m : read_annotated_texts(path)) {
      for (const Annotation& a : m.annotations) out.texts.push_back(a.text);
    }
  } else {
    for (const ClipLine& line : read_captions(path, path.parent_path()))
      out.texts.insert(out.texts.end(), line.texts.begin(), line.texts.end());
  }
  return out;
}

MOTIONLANG_BODY std::map<std::string, std::size_t> word_counts(std::span<const std::string> texts) {
  std::map<std::string, std::size_t> out;
  for (const std::string& text : texts) {
    for (const std::string& word : detail::plain_words(text)) ++out[word];
  }
  return out;
}

MOTIONLANG_BODY std::size_t words_at_least(const std::map<std::string, std::size_t>& counts, std::size_t least) {
  return static_cast<std::size_t>(
      std::count_if(counts.begin(), counts.end(), [&](const auto& word) { return word.second >= least; }));
}

MOTIONLANG_BODY std::vector<std::string> commanded_verbs(std::span<const std::string> texts) {
  std::set<std::string> out;
  for (const std::string& text : texts) out.insert(commanded_verb(text));
  out.erase("");
  return {out.begin(), out.end()};
}

MOTIONLANG_BODY std::map<std::string, std::size_t> verb_counts(std::span<const std::string> texts,
                                                               std::span<const std::string> verbs) {
  const std::set<std::string> known(verbs.begin(), verbs.end());
  std::map<std::string, std::size_t> out;
  for (const std::string& text : texts) {
    std::set<std::string> said;
    for (const std::string& word : detail::plain_words(text)) {
      const std::string form = known_form(word, [&](const std::string& w) { return known.contains(w); });
      if (known.contains(form)) said.insert(form);
    }
    for (const std::string& verb : said) ++out[verb];
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
