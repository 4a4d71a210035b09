// SPDX-License-Identifier: MIT
/// Charts that compare the words of data sets: how many words appear how often, and how many texts have each verb.
///
/// Source  TEACH (thesis annex A), figure A.3
#pragma once

#include <cstddef>  // number of verbs
#include <span>     // data sets
#include <string>   // names
#include <vector>   // texts

#include <motionlang/view/bar_chart.hpp>
#include <motionlang/view/loss_curves.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The texts of a data set.
struct NamedTexts {
  std::string name;
  std::vector<std::string> texts;
  std::vector<std::string> phrases{};  // action phrases of the texts (text/action_phrases.hpp), if they are known
};
struct WordCharts {
  CurvePanel words;     // for 1 ... 50 times, how many words of each set appear at least so often
  BarChart verbs;       // texts of each set with the verbs that most texts have
  std::string about{};  // a line for each set: texts, words, verbs, action phrases
};
/// most  number of verbs
WordCharts word_charts(std::span<const NamedTexts> sets, std::size_t most = 25);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/word_charts.ipp>
#endif
