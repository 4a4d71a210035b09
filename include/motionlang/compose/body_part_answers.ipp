// SPDX-License-Identifier: MIT
// Bodies of body_part_answers.hpp.
#pragma once

#include <algorithm>  // find
#include <array>      // words without meaning
#include <set>        // named parts

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/core/error.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Lower case, without ASCII punctuation and without the word "answer".
inline std::string plain_answer(std::string_view answer) {
  std::string out;
  for (const char c : answer) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'), digit = c >= '0' && c <= '9';
    if (c > ' ' && c < 0x7f && !letter && !digit) continue;
    out += lower(c);
  }
  constexpr std::string_view word = "answer";
  for (std::size_t at = out.find(word); at != out.npos; at = out.find(word, at)) out.erase(at, word.size());
  return out;
}

}  // namespace detail

namespace detail {

/// The names in an answer, without those that mean nothing.
inline std::set<std::string, std::less<>> named_parts(std::string_view answer) {
  std::set<std::string, std::less<>> named;
  const std::string plain = plain_answer(answer);
  for_each_line(plain, [&](std::string_view line, Index) {
    if (const auto part = trim(line); !part.empty()) named.emplace(part);
  });
  for (const char* nothing : {"right side of face", "right eye", "wrist", "hand"}) named.erase(nothing);
  const bool arm = named.contains("left arm") || named.contains("right arm");
  if (named.erase("shoulders") > 0 && !arm) named.insert({"left arm", "right arm"});
  return named;
}
inline std::optional<SincPart> part_of_answer(std::string_view name) {
  return parse_sinc_part(name == "buttocks" || name == "waist" ? "global"
                         : name == "neck"                      ? "torso"
                         : name == "left shoulder"             ? "left arm"
                         : name == "right shoulder"            ? "right arm"
                                                               : name);
}

}  // namespace detail

MOTIONLANG_BODY std::optional<SincParts> known_body_part_answer(std::string_view answer) {
  SincParts parts;
  for (const std::string& name : detail::named_parts(answer)) {
    const auto part = detail::part_of_answer(name);
    if (!part) return std::nullopt;
    parts.set(static_cast<std::size_t>(*part));
  }
  return parts.none() ? std::nullopt : std::optional(parts);
}

MOTIONLANG_BODY SincParts parse_body_part_answer(std::string_view answer) {
  SincParts parts;
  for (const std::string& name : detail::named_parts(answer)) {
    const auto part = detail::part_of_answer(name);
    if (!part) raise<config_error>(103, "parse_body_part_answer: '", name, "' is not a body part, in '", answer, "'");
    parts.set(static_cast<std::size_t>(*part));
  }
  if (parts.none()) raise<config_error>(103, "parse_body_part_answer: no body part in '", answer, "'");
  return parts;
}

MOTIONLANG_BODY void BodyPartTable::add(const std::string& label, std::string_view answer) {
  static constexpr std::array<std::string_view, 5> everything{"animal behavior series", "bird behavior series",
                                                              "marine animal behavior series",
                                                              "elephant behavior series", "swim on air"};
  const bool forced = std::find(everything.begin(), everything.end(), label) != everything.end();
  const SincParts parts = forced ? ~SincParts{} : parse_body_part_answer(answer);
  if (parts_.insert_or_assign(label, parts).second) labels_.push_back(label);
}

MOTIONLANG_BODY const SincParts& BodyPartTable::parts(const std::string& label) const {
  const auto found = parts_.find(label);
  if (found == parts_.end()) raise<config_error>(103, "BodyPartTable: no parts of '", label, "'");
  return found->second;
}

MOTIONLANG_NAMESPACE_END
