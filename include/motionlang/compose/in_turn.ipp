// SPDX-License-Identifier: MIT
// Bodies of in_turn.hpp.
#pragma once

#include <algorithm>  // min
#include <array>      // joining words
#include <utility>    // exchange

#include <motionlang/compose/in_turn.hpp>
#include <motionlang/compose/long_texts.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A word of a sentence as written, and as compared: in lower case without commas and stops around it.
struct SentenceWord {
  std::string_view written;
  std::string plain;

  bool ends_action() const { return written.ends_with(';') || written.ends_with('.'); }
};

inline std::vector<SentenceWord> sentence_words(std::string_view sentence) {
  constexpr std::string_view space = " \t\r\n", stops = ",;.";
  std::vector<SentenceWord> words;
  for (std::size_t at = sentence.find_first_not_of(space); at < sentence.size();) {
    const std::size_t end = std::min(sentence.find_first_of(space, at), sentence.size());
    SentenceWord word{.written = sentence.substr(at, end - at), .plain = {}};
    for (const char c : word.written) {
      if (stops.find(c) == stops.npos) word.plain += lower(c);
    }
    words.push_back(std::move(word));
    at = sentence.find_first_not_of(space, end);
  }
  return words;
}

/// The number of words from word i on that announce another action: "then", "after that", ...
inline std::size_t words_of_turn(const std::vector<SentenceWord>& words, std::size_t i) {
  static constexpr std::array<std::array<std::string_view, 2>, 5> turns{
      {{"then", ""}, {"afterwards", ""}, {"after", "that"}, {"after", "which"}, {"followed", "by"}}};
  for (const auto& [first, second] : turns) {
    if (words[i].plain != first) continue;
    if (second.empty()) return 1;
    if (i + 1 < words.size() && words[i + 1].plain == second) return 2;
  }
  return 0;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> actions_in_turn(std::string_view sentence) {
  const auto words = detail::sentence_words(sentence);
  std::vector<std::string> actions;
  std::string action;
  const auto end_action = [&] {
    action.resize(action.find_last_not_of(" ,;.") + 1);
    if (!action.empty()) actions.push_back(std::exchange(action, {}));
  };
  for (std::size_t i = 0; i < words.size();) {
    const bool joined = words[i].plain == "and" && i + 1 < words.size();
    if (const std::size_t turn = detail::words_of_turn(words, joined ? i + 1 : i); turn > 0) {
      end_action();
      i += turn + (joined ? 1 : 0);
      continue;
    }
    action.append(action.empty() ? "" : " ").append(words[i].written);
    if (words[i++].ends_action()) end_action();
  }
  end_action();
  return actions.size() > 1 ? actions : std::vector<std::string>{std::string(sentence)};
}

MOTIONLANG_BODY std::vector<std::string> listed_in_turn(std::string_view sentence) {
  std::vector<std::string> out;
  for (const std::string& action : actions_in_turn(sentence)) {
    std::vector<std::string> parts(1);
    for (const detail::SentenceWord& word : detail::sentence_words(action)) {
      if (parts.back().empty() && parts.size() > 1 && word.plain == "and") continue;
      parts.back().append(parts.back().empty() ? "" : " ").append(word.written);
      if (!word.written.ends_with(',')) continue;
      parts.back().pop_back();
      parts.emplace_back();
    }
    constexpr std::string_view last_and = " and ";
    if (const auto at = parts.back().rfind(last_and); parts.size() > 1 && at != std::string::npos) {
      parts.push_back(parts.back().substr(at + last_and.size()));
      parts[parts.size() - 2].resize(at);
    }
    std::erase(parts, "");
    out.insert(out.end(), parts.begin(), parts.end());
  }
  return out.size() > 1 ? out : std::vector<std::string>{std::string(sentence)};
}

MOTIONLANG_BODY Timeline in_turn(const Timeline& timeline) {
  Timeline out{{}, timeline.body};
  for (const Interval& whole : timeline.intervals) {
    const auto actions = actions_in_turn(whole.text);
    if (whole.end - whole.start < std::ssize(actions))
      raise<config_error>(101, "in_turn: '", whole.text, "' has ", counted(actions.size(), "action"), " in ",
                          counted(whole.end - whole.start, "frame"));
    auto parts = detail::equal_parts(whole, std::ssize(actions));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      parts[i].text = actions[i];
      out.intervals.push_back(std::move(parts[i]));
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
