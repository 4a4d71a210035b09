// SPDX-License-Identifier: MIT
// Bodies of word_charts.hpp.
#pragma once

#include <algorithm>  // min, stable_sort
#include <map>        // counts
#include <utility>    // pair

#include <motionlang/core/error.hpp>
#include <motionlang/datasets/word_counts.hpp>
#include <motionlang/text/action_phrases.hpp>
#include <motionlang/view/word_charts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY WordCharts word_charts(std::span<const NamedTexts> sets, std::size_t most) {
  WordCharts out{.words = {.title = "words that appear at least so often", .curves = {}, .axis = "times"},
                 .verbs = {.title = "texts with a verb", .series = {}, .groups = {}}};
  std::vector<std::string> all;
  for (const NamedTexts& set : sets) all.insert(all.end(), set.texts.begin(), set.texts.end());
  const auto verbs = commanded_verbs(all);
  std::map<std::string, std::size_t> total;
  std::vector<std::map<std::string, std::size_t>> of_set;
  for (const NamedTexts& set : sets) {
    const auto counts = word_counts(set.texts);
    Curve curve{set.name, {}, {}};
    for (std::size_t least = 1; least <= 50; ++least) {
      curve.steps.push_back(static_cast<double>(least));
      curve.values.push_back(static_cast<double>(words_at_least(counts, least)));
    }
    out.words.curves.push_back(std::move(curve));
    out.verbs.series.push_back(set.name);
    of_set.push_back(verb_counts(set.texts, verbs));
    for (const auto& [verb, count] : of_set.back()) total[verb] += count;
    out.about += concat_text(set.name, ": ", counted(set.texts.size(), "text"), ", ", counted(counts.size(), "word"),
                             ", ", counted(of_set.back().size(), "verb"));
    const std::string phrases = PhraseCounts(set.phrases).text();
    out.about += (phrases.empty() ? "" : "; " + phrases) + "\n";
  }
  std::vector<std::pair<std::size_t, std::string>> order;
  order.reserve(total.size());
  for (const auto& [verb, count] : total) order.emplace_back(count, verb);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; i < std::min(order.size(), most); ++i) {
    BarGroup group{.name = order[i].second, .values = {}};
    for (auto& counts : of_set) group.values.push_back(static_cast<double>(counts[group.name]));
    out.verbs.groups.push_back(std::move(group));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
