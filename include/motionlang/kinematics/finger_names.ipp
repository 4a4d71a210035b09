// SPDX-License-Identifier: MIT
// Bodies of finger_names.hpp.
#pragma once

#include <array>    // names
#include <utility>  // pair

#include <motionlang/core/text_lines.hpp>
#include <motionlang/kinematics/finger_names.hpp>
#include <motionlang/kinematics/joint_sides.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string finger_of(std::string_view joint) {
  const Side side = detail::side_of_name(joint);
  if (side == Side::middle) return "";
  const std::string_view own = side == Side::left ? "left" : "right", opposite = side == Side::left ? "right" : "left";
  std::string name(joint);
  for (char& c : name) c = detail::lower(c);
  const auto has = [&](std::string_view part) { return name.find(part) != name.npos; };
  if (has(opposite)) return "";
  if (joint == concat_text(own, "ThumbMetacarpal")) return concat_text(own, "_thumb1");
  if (joint == concat_text(own, "ThumbProximal")) return concat_text(own, "_thumb2");
  for (const char* other : {"leaf", "end", "tip", "nub", "meta", "twist"}) {
    if (has(other)) return "";
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> fingers{{{"thumb", "thumb"},
                                                                                  {"index", "index"},
                                                                                  {"mid", "middle"},
                                                                                  {"ring", "ring"},
                                                                                  {"pinky", "pinky"},
                                                                                  {"little", "pinky"}}};
  constexpr std::array<std::string_view, 3> phalanges{"proximal", "intermediate", "distal"};
  for (const auto& [part, finger] : fingers) {
    const std::size_t at = name.find(part);
    if (at == name.npos) continue;
    std::size_t number = 0;
    for (std::size_t i = name.find_first_of("0123456789", at);
         i < name.size() && '0' <= name[i] && name[i] <= '9' && number < 10; ++i)
      number = 10 * number + static_cast<std::size_t>(name[i] - '0');
    for (std::size_t i = 0; i < phalanges.size() && number == 0; ++i) number = has(phalanges[i]) ? i + 1 : 0;
    if (number < 1 || number > 3) return "";
    return std::string(own) + "_" + std::string(finger) + static_cast<char>('0' + number);
  }
  return "";
}

MOTIONLANG_NAMESPACE_END
