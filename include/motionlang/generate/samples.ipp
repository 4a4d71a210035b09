// SPDX-License-Identifier: MIT
// Bodies of samples.hpp.
#pragma once

#include <algorithm>  // min
#include <cstdio>     // shares
#include <utility>    // move

#include <motionlang/core/utf8.hpp>
#include <motionlang/generate/samples.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<LabelledMotion> generate_between(const LatentMotionModel& model, const Timeline& from,
                                                             const Timeline& to, Index count,
                                                             const GenerateOptions& options) {
  std::vector<Motion> motions = model.between(from, to, count, options);
  std::vector<LabelledMotion> out;
  for (Index i = 0; i < count; ++i) {
    Timeline shown = i == count - 1 ? to : from;
    if (i > 0 && i < count - 1) {
      const double share = 100 * static_cast<double>(i) / static_cast<double>(count - 1);
      char shares[2][16];
      std::snprintf(shares[0], sizeof shares[0], "%.0f", 100 - share);
      std::snprintf(shares[1], sizeof shares[1], "%.0f", share);
      shown.intervals.front().text =
          concat_text(only_text(from).text, " ", shares[0], " %, ", only_text(to).text, " ", shares[1], " %");
    }
    out.push_back({std::move(motions[static_cast<std::size_t>(i)]), std::move(shown)});
  }
  return out;
}

MOTIONLANG_BODY std::string result_name(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string name;
  for (std::size_t at = 0; at < std::min(text.size(), longest);) {
    const std::size_t first = at;
    const char32_t c = decode_utf8(text, at);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                        (c > 0xA0 && c != invalid_code_point);
    if (letter)
      name.append(text, first, at - first);
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name.empty() ? "motion" : name;
}

MOTIONLANG_BODY std::vector<std::string> sample_names(const std::string& name, std::size_t timelines, Index samples) {
  std::vector<std::string> names;
  for (std::size_t t = 0; t < timelines; ++t) {
    for (Index s = 0; s < samples; ++s)
      names.push_back(
          concat_text(name, timelines == 1 ? "" : concat_text("_", t), samples == 1 ? "" : concat_text("_", s + 1)));
  }
  return names;
}

MOTIONLANG_NAMESPACE_END
