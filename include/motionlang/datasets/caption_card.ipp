// SPDX-License-Identifier: MIT
// Bodies of caption_card.hpp.
#pragma once

#include <algorithm>  // max, sort, stable_sort
#include <cmath>      // isinf
#include <utility>    // pair

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/datasets/caption_card.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The folder of a clip, or the file with many animations that holds it.
inline std::string folder_of_clip(const std::string& clip) {
  const auto animation = clip.rfind('#');
  std::string file = clip.substr(0, animation);
  if (animation != clip.npos) return file;
  const auto folder = file.rfind('/');
  return folder == file.npos ? "." : file.substr(0, folder);
}

/// How many seconds the union of stretches lasts.
inline double seconds_of_union(std::vector<std::pair<double, double>> stretches) {
  std::sort(stretches.begin(), stretches.end());
  double sum = 0, until = 0;
  for (const auto& [start, end] : stretches) {
    sum += std::max(0.0, end - std::max(start, until));
    until = std::max(until, end);
  }
  return sum;
}

MOTIONLANG_BODY std::vector<std::string> caption_words(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ' ' || c == ',')
      words.emplace_back();
    else
      words.back() += lower(c);
  }
  std::erase(words, "");
  return words;
}

}  // namespace detail

MOTIONLANG_BODY std::string commanded_verb(std::string_view caption) {
  static const std::set<std::string> subjects{"a",  "an",  "the", "someone", "somebody",
                                              "he", "she", "it",  "they",    "one"};
  const auto words = detail::caption_words(caption);
  if (words.empty() || subjects.contains(words.front())) return "";
  const std::string& first = words.front();
  static const std::set<std::string> commands_in_ing{"bring", "swing", "spring", "fling", "wring", "sing", "ring"};
  return first.ends_with("ing") && !commands_in_ing.contains(first) ? "" : first;
}

MOTIONLANG_BODY CaptionCard caption_card(const std::vector<ClipLine>& lines) {
  CaptionCard card;
  std::map<std::string, std::vector<std::pair<double, double>>> stretches;  // of a clip
  for (const ClipLine& line : lines) {
    const bool whole = std::isinf(line.end);
    for (CaptionCard::Folder* f : {&card.all, &card.folders[detail::folder_of_clip(line.clip)]}) {
      f->clips.insert(line.clip);
      f->segments += 1;
      f->captions += line.texts.size();
      if (!whole) f->seconds += line.end - line.start;
    }
    if (!whole) stretches[line.clip].emplace_back(line.start, line.end);
    std::set<std::string> verbs;
    for (const std::string& text : line.texts) {
      card.captions.insert(text);
      for (std::string& word : detail::caption_words(text)) card.words.insert(std::move(word));
      verbs.insert(commanded_verb(text));
    }
    verbs.erase("");
    for (const std::string& v : verbs) ++card.verbs[v];
  }
  for (auto& [clip, list] : stretches) {
    const double seconds = detail::seconds_of_union(std::move(list));
    card.all.without_overlap += seconds;
    card.folders[detail::folder_of_clip(clip)].without_overlap += seconds;
  }
  return card;
}

namespace detail {

inline std::string card_row(const std::string& name, const CaptionCard::Folder& f) {
  return formatted("  %-52s %5zu clips %6zu segments %7.1f min %7.1f min without overlaps %7zu captions\n",
                   printable(name).c_str(), f.clips.size(), f.segments, f.seconds / 60, f.without_overlap / 60,
                   f.captions);
}

}  // namespace detail

MOTIONLANG_BODY std::string describe_card(const CaptionCard& card) {
  std::string out;
  for (const auto& [name, folder] : card.folders) out += detail::card_row(name, folder);
  out += detail::card_row("all", card.all);
  out += concat_text(card.captions.size(), " different captions, ", card.words.size(), " different words, ",
                     card.verbs.size(), " verbs with the segments that show them:\n");
  std::vector<std::pair<std::size_t, std::string>> verbs;
  for (const auto& [verb, segments] : card.verbs) verbs.emplace_back(segments, verb);
  std::stable_sort(verbs.begin(), verbs.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::size_t column = 0;
  for (const auto& [segments, verb] : verbs) {
    const std::string next = concat_text(" ", printable(verb), " ", segments);
    if (column + next.size() > 118) out += "\n", column = 0;
    out += (column == 0 ? " " : "") + next;
    column += next.size();
  }
  return out + "\n";
}

MOTIONLANG_NAMESPACE_END
