// SPDX-License-Identifier: MIT
// Bodies of joint_sides.hpp.
#pragma once

#include <algorithm>  // any_of
#include <cctype>     // tolower
#include <iterator>   // begin
#include <utility>    // pair

#include <motionlang/kinematics/joint_sides.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The characters that separate the words of a name.
inline bool is_separator(char c) { return c == '_' || c == '.' || c == '-' || c == ' '; }

/// The place of a single letter inside a name (J_Bip_L_Hand, "Bip01 L Thigh"), or npos.
inline std::size_t lone_letter(std::string_view name, char letter) {
  for (std::size_t at = 1; at + 1 < name.size(); ++at) {
    if (name[at] == letter && is_separator(name[at - 1]) && is_separator(name[at + 1])) return at;
  }
  return name.npos;
}

MOTIONLANG_BODY Side side_of_name(std::string_view name) {
  auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
  auto is_capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  std::string small(name);
  std::transform(small.begin(), small.end(), small.begin(), lower);
  for (const auto& [side, word] : {std::pair{Side::left, std::string_view("left")}, {Side::right, "right"}}) {
    const char letter = word.front();
    if (small.find(word) != std::string::npos) return side;
    if (name.size() < 2) continue;
    const char second = name[1], before_last = name[name.size() - 2];
    if (small.front() == letter && (second == '_' || second == '.' || is_capital(second))) return side;
    if (small.back() == letter && is_separator(before_last)) return side;
    if (lone_letter(small, letter) != small.npos) return side;
  }
  return Side::middle;
}

/// Marks of the side in names: words anywhere, single letters at either end or alone (lThigh, UpperArm_L,
/// J_Bip_L_Hand).
inline constexpr std::string_view side_words[][2] = {{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}};

inline constexpr std::string_view side_letters[][2] = {{"l", "r"}, {"L", "R"}};

MOTIONLANG_BODY bool has_side_word(std::string_view name) {
  return std::any_of(std::begin(side_words), std::end(side_words), [&](const auto& pair) {
    return name.find(pair[0]) != name.npos || name.find(pair[1]) != name.npos;
  });
}

MOTIONLANG_BODY std::vector<std::string> other_side(const std::string& name) {
  std::vector<std::string> candidates;
  auto replaced = [&](std::string_view mark, std::string_view other, std::size_t at) {
    candidates.push_back(std::string(name).replace(at, mark.size(), other));
  };
  for (const int side : {0, 1}) {
    for (const auto& pair : side_words) {
      if (const auto at = name.find(pair[side]); at != name.npos) replaced(pair[side], pair[1 - side], at);
    }
    for (const auto& pair : side_letters) {
      if (name.starts_with(pair[side])) replaced(pair[side], pair[1 - side], 0);
      if (name.ends_with(pair[side])) replaced(pair[side], pair[1 - side], name.size() - 1);
      if (const auto at = lone_letter(name, pair[side][0]); at != name.npos) replaced(pair[side], pair[1 - side], at);
    }
  }
  return candidates;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
