// SPDX-License-Identifier: MIT
// Bodies of action_phrases.hpp.
#pragma once

#include <algorithm>         // count_if, find, max_element
#include <cmath>             // round
#include <initializer_list>  // tags
#include <string_view>       // tags

#include <motionlang/core/error.hpp>
#include <motionlang/text/action_phrases.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> action_phrases(std::span<const TaggedWord> words) {
  const auto is_one_of = [](std::string_view tag, std::initializer_list<std::string_view> tags) {
    return std::find(tags.begin(), tags.end(), tag) != tags.end();
  };
  std::vector<std::string> out;
  bool open = false;
  for (const TaggedWord& w : words) {
    if (w.tag == "VERB") {
      out.push_back(w.word);
      open = true;
    } else if (is_one_of(w.tag, {"AUX", "CCONJ", "CONJ", "SCONJ", "PUNCT"})) {
      open = false;
    } else if (open && !is_one_of(w.tag, {"DET", "PRON"})) {
      out.back() += " " + w.word;
    }
  }
  return out;
}

MOTIONLANG_BODY PhraseCounts::PhraseCounts(std::span<const std::string> phrases) {
  for (const std::string& phrase : phrases) ++times[phrase];
}

MOTIONLANG_BODY std::size_t PhraseCounts::below(std::size_t limit) const {
  return static_cast<std::size_t>(
      std::count_if(times.begin(), times.end(), [&](const auto& phrase) { return phrase.second < limit; }));
}

MOTIONLANG_BODY std::string PhraseCounts::text() const {
  if (times.empty()) return {};
  std::size_t all = 0;
  for (const auto& [phrase, count] : times) all += count;
  const auto most =
      std::max_element(times.begin(), times.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const double mean = std::round(100 * static_cast<double>(all) / static_cast<double>(times.size())) / 100;
  return concat_text(counted(times.size(), "action phrase"), ", ", mean, mean == 1 ? " time" : " times",
                     " on average; '", most->first, "' most often, ", counted(most->second, "time"), "; ", below(10),
                     " less than ten times, ", below(2), " once");
}

MOTIONLANG_NAMESPACE_END
