// SPDX-License-Identifier: MIT
// Bodies of study.hpp.
#pragma once

#include <algorithm>  // count_if, find
#include <charconv>   // whole numbers
#include <cmath>      // isfinite
#include <set>        // names

#include <motionlang/core/rng.hpp>
#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/metrics/study.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::vector<std::string> study_cells(std::string_view line, char separator = '\t') {
  std::vector<std::string> out(1);
  for (const char c : line) {
    if (c == separator)
      out.emplace_back();
    else
      out.back() += c;
  }
  for (std::string& cell : out) cell = std::string(trim(cell));
  return out;
}

inline std::uint64_t study_fingerprint(std::string_view table, StudyKind kind) {
  const std::string all = concat_text(to_string(kind), "\n", table);
  return byte_hash(std::as_bytes(std::span(all)));
}

template <class T>
bool parse_whole(std::string_view text, T& out, int base = 10) {
  const auto end = std::from_chars(text.data(), text.data() + text.size(), out, base);
  return end.ec == std::errc{} && end.ptr == text.data() + text.size();
}

template <class T>
void shuffle(std::vector<T>& list, Philox& draw) {
  for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[draw.below(static_cast<std::uint32_t>(i))]);
}

/// The columns of the table.
class StudyTable {
 public:
  StudyTable(std::string_view table, StudyKind kind, std::string_view name) : name_(name) {
    out_.kind = kind;
    out_.fingerprint = study_fingerprint(table, kind);
    for_each_line(table, [&](std::string_view line, Index number) {
      if (trim(line).empty() || line.starts_with('#')) return;
      if (columns_.empty())
        read_header(study_cells(line), number);
      else
        read_item(study_cells(line), number);
    });
    if (out_.items.empty()) raise<io_error>(403, name_, ": no line below the names of the columns");
  }
  Study study() && { return std::move(out_); }

 private:
  void read_header(std::vector<std::string> cells, Index line) {
    columns_ = std::move(cells);
    std::set<std::string> seen;
    for (const std::string& c : columns_) {
      if (c.empty() || !seen.insert(c).second)
        raise<io_error>(403, name_, ":", line, ": column '", c, "' is not a new name");
      if (c == "motion") out_.ranks_texts = true;
      if (c != "role" && c != "text" && c != "motion" && c != "timeline") out_.systems.push_back(c);
    }
    if (out_.systems.empty() || (out_.systems.size() < 2 && out_.kind != StudyKind::rating))
      raise<io_error>(403, name_, ":", line, ": the columns have ", counted(out_.systems.size(), "system"));
  }
  void read_item(const std::vector<std::string>& cells, Index line) {
    if (cells.size() > columns_.size())
      raise<io_error>(403, name_, ":", line, ": ", cells.size(), " cells below ", counted(columns_.size(), "column"));
    StudyItem item;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const std::string cell = i < cells.size() ? cells[i] : "";
      const std::string& column = columns_[i];
      if (column == "text")
        item.text = cell;
      else if (column == "motion")
        item.motion = cell;
      else if (column == "timeline")
        item.timeline = cell;
      else if (column == "role")
        read_role(cell, item, line);
      else
        item.choices.push_back(cell);
    }
    const auto choices =
        std::count_if(item.choices.begin(), item.choices.end(), [](const auto& c) { return !c.empty(); });
    if (choices < (out_.kind == StudyKind::rating ? 1 : 2))
      raise<io_error>(403, name_, ":", line, ": ", counted(choices, "choice"), " to compare");
    if (out_.ranks_texts && item.motion.empty()) raise<io_error>(403, name_, ":", line, ": no motion");
    if (item.right >= 0 && item.choices[static_cast<std::size_t>(item.right)].empty())
      raise<io_error>(403, name_, ":", line, ": the right answer has no choice");
    out_.items.push_back(std::move(item));
  }
  void read_role(const std::string& cell, StudyItem& item, Index line) const {
    if (cell.empty()) return;
    if (cell == "warmup") {
      item.role = StudyRole::warmup;
      return;
    }
    const auto& systems = out_.systems;
    const auto right =
        cell.starts_with("catch ") ? std::find(systems.begin(), systems.end(), trim(cell.substr(6))) : systems.end();
    if (right == systems.end())
      raise<io_error>(403, name_, ":", line, ": role '", cell, "' is not warmup, or catch and a system");
    item.role = StudyRole::catch_trial;
    item.right = static_cast<int>(right - systems.begin());
  }

  std::string name_;
  std::vector<std::string> columns_;
  Study out_;
};

/// The trials of an item, with their choices in the order of the table.
inline std::vector<StudyTrial> trials_of_item(const Study& study, std::size_t number) {
  const StudyItem& item = study.items[number];
  std::vector<int> systems;
  for (std::size_t s = 0; s < item.choices.size(); ++s) {
    if (!item.choices[s].empty()) systems.push_back(static_cast<int>(s));
  }
  if (study.kind == StudyKind::ranking) return {{number, systems}};
  std::vector<StudyTrial> out;
  for (std::size_t a = 0; a < systems.size(); ++a) {
    if (study.kind == StudyKind::rating) out.push_back({number, {systems[a]}});
    for (std::size_t b = a + 1; b < systems.size() && study.kind == StudyKind::pairs; ++b) {
      const bool asked = item.right < 0 || systems[a] == item.right || systems[b] == item.right;
      if (asked) out.push_back({number, {systems[a], systems[b]}});
    }
  }
  return out;
}

/// A finite number that is not negative. False if the text is none.
inline bool read_seconds(std::string_view text, double& out) {
  const auto end = detail::from_chars(text.data(), text.data() + text.size(), out);
  return end.ec == std::errc{} && end.ptr == text.data() + text.size() && std::isfinite(out) && out >= 0;
}

/// An answer as a file has it. False if the trial does not have it.
inline bool read_answer(std::string_view text, StudyKind kind, std::size_t shown, StudyAnswer& out) {
  if (kind == StudyKind::rating) return parse_whole(text, out.rating) && out.rating >= 1 && out.rating <= 5;
  if (text == "-") return kind == StudyKind::pairs;
  std::set<int> seen;
  for (const std::string& cell : study_cells(text, ',')) {
    int place = 0;
    if (!parse_whole(cell, place) || place < 0 || place >= static_cast<int>(shown) || !seen.insert(place).second)
      return false;
    out.places.push_back(place);
  }
  return out.places.size() == (kind == StudyKind::pairs ? 1 : shown);
}

}  // namespace detail

MOTIONLANG_BODY std::string to_string(StudyKind kind) {
  return kind == StudyKind::pairs ? "pairs" : kind == StudyKind::ranking ? "ranking" : "rating";
}
MOTIONLANG_BODY StudyKind parse_study_kind(std::string_view name) {
  for (const StudyKind kind : {StudyKind::pairs, StudyKind::ranking, StudyKind::rating}) {
    if (to_string(kind) == name) return kind;
  }
  raise<config_error>(103, "study '", name, "' is not one of pairs, ranking, rating");
}

MOTIONLANG_BODY Study parse_study(std::string_view table, StudyKind kind, std::string_view name) {
  return detail::StudyTable(table, kind, name).study();
}

MOTIONLANG_BODY std::vector<StudyTrial> study_trials(const Study& study, std::uint64_t seed) {
  std::vector<StudyTrial> out, later;
  Philox draw = Philox{.seed = seed}.split("study");
  for (std::size_t i = 0; i < study.items.size(); ++i) {
    for (StudyTrial& trial : detail::trials_of_item(study, i)) {
      detail::shuffle(trial.shown, draw);
      (study.items[i].role == StudyRole::warmup ? out : later).push_back(std::move(trial));
    }
  }
  detail::shuffle(later, draw);
  out.insert(out.end(), later.begin(), later.end());
  return out;
}

MOTIONLANG_BODY std::string describe_trials(const Study& study, std::span<const StudyTrial> trials) {
  const auto count = [&](StudyRole role, const char* name) {
    return counted(std::count_if(trials.begin(), trials.end(),
                                 [&](const StudyTrial& t) { return study.items[t.item].role == role; }),
                   name);
  };
  return concat_text(count(StudyRole::counted, "trial"), ", ", count(StudyRole::warmup, "warm-up"), " and ",
                     count(StudyRole::catch_trial, "catch trial"));
}

MOTIONLANG_BODY StudyAnswers parse_study_answers(std::string_view text, const Study& study, std::string_view name) {
  StudyAnswers out;
  std::vector<StudyTrial> trials;
  std::set<std::string> headers;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    const auto fail = [&](const auto&... what) { raise<io_error>(403, name, ":", number, ": ", what...); };
    if (detail::trim(line).empty() || line.starts_with('#')) return;
    const auto cells = detail::study_cells(line);
    if (trials.empty()) {
      std::uint64_t fingerprint = 0;
      const std::string value = cells.size() > 1 ? cells[1] : "";
      if (cells[0] == "study" && (!detail::parse_whole(value, fingerprint, 16) || fingerprint != study.fingerprint))
        fail("answers to another study, or to another version of its table");
      if (cells[0] == "seed" && !detail::parse_whole(value, out.seed)) fail("seed '", value, "'");
      if (cells[0] == "rater") out.rater = value;
      headers.insert(cells[0]);
      if (cells[0] != "trial") return;
      if (!headers.contains("study") || !headers.contains("seed")) fail("no study or no seed before the answers");
      trials = study_trials(study, out.seed);
      return;
    }
    StudyAnswer answer;
    if (cells.size() != 3 || !detail::parse_whole(cells[0], answer.trial) || answer.trial >= trials.size())
      fail("a line has a trial below ", trials.size(), ", an answer and seconds");
    if (!detail::read_seconds(cells[2], answer.seconds)) fail("'", cells[2], "' is not a number of seconds");
    if (!detail::read_answer(cells[1], study.kind, trials[answer.trial].shown.size(), answer))
      fail("'", cells[1], "' does not answer this trial of ", to_string(study.kind));
    std::erase_if(out.answers, [&](const StudyAnswer& a) { return a.trial == answer.trial; });
    out.answers.push_back(std::move(answer));
  });
  if (trials.empty()) raise<io_error>(403, name, ": no answers");
  return out;
}

MOTIONLANG_NAMESPACE_END
