// SPDX-License-Identifier: MIT
// Bodies of key_report.hpp.
#pragma once

#include <algorithm>  // min
#include <span>       // lists
#include <utility>    // swap

#include <motionlang/file/key_report.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) >= limit) return limit;
  std::vector<std::size_t> row(b.size() + 1), above(row), second(row);  // the row of a prefix of a, and those before it
  for (std::size_t k = 0; k < row.size(); ++k) row[k] = k;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::swap(second, above);
    std::swap(above, row);
    row[0] = i + 1;
    for (std::size_t k = 0; k < b.size(); ++k) {
      row[k + 1] = std::min(above[k] + (a[i] == b[k] ? 0 : 1), std::min(above[k + 1], row[k]) + 1);
      if (i > 0 && k > 0 && a[i] == b[k - 1] && a[i - 1] == b[k]) row[k + 1] = std::min(row[k + 1], second[k - 1] + 1);
    }
  }
  return std::min(row.back(), limit);
}

MOTIONLANG_BODY std::string nearest_name(std::string_view name, const std::vector<std::string>& among) {
  constexpr std::size_t longest = 256;
  std::string_view best;
  std::size_t distance = std::min(name.size(), longest) / 2 + 1;
  for (const std::string& candidate : std::span(among).first(std::min<std::size_t>(among.size(), 2000))) {
    if (name.size() > longest || candidate.size() > longest) continue;
    const std::size_t d = edit_distance(name, candidate, distance);
    if (d < distance) distance = d, best = candidate;
  }
  return std::string(best);
}

MOTIONLANG_BODY std::string to_string(const KeyReport& report) {
  constexpr std::size_t most = 20;  // lines of a list
  std::string text;
  const auto list = [&](const char* what, const std::vector<std::string>& names, const std::vector<std::string>& others,
                        const char* has) {
    for (std::size_t i = 0; i < names.size() && i < most; ++i) {
      const std::string like = nearest_name(names[i], others);
      text += concat_text("\n  ", what, " ", names[i]);
      if (!like.empty()) text += concat_text("  (", has, " ", like, ")");
    }
    if (names.size() > most) text += concat_text("\n  ", what, " ", names.size() - most, " more");
  };
  list("missing   ", report.missing, report.unexpected, "the file has");
  list("unexpected", report.unexpected, report.missing, "the model has");
  return text;
}

namespace detail {

MOTIONLANG_BODY void raise_key_mismatch(std::string_view file, const KeyReport& report) {
  raise<io_error>(406, file, ": ", counted(report.missing.size(), "tensor is missing", "tensors are missing"), ", ",
                  counted(report.unexpected.size(), "is", "are"), " not expected:", report);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
