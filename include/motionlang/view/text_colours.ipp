// SPDX-License-Identifier: MIT
// Bodies of text_colours.hpp.
#pragma once

#include <algorithm>         // find
#include <initializer_list>  // words

#include <motionlang/core/text_lines.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/joint_sides.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/view/text_colours.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The part in a joint's name; "" if the name says nothing.
inline std::string part_in_name(std::string_view name) {
  std::string lowered(name);
  for (char& c : lowered) c = lower(c);
  const auto has = [&](std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(), [&](const char* w) { return lowered.find(w) != lowered.npos; });
  };
  if (has({"hip", "leg", "thigh", "knee", "shin", "calf", "ankle", "foot", "toe", "pelvis"})) return "legs";
  if (has({"head", "neck", "jaw", "eye"})) return "head";
  const Side side = side_of_name(name);
  if (side != Side::middle &&
      has({"collar", "clavicle", "shoulder", "arm", "elbow", "wrist", "hand", "finger", "thumb"}))
    return side == Side::left ? "left arm" : "right arm";
  return has({"spine", "chest", "back", "torso", "abdomen"}) ? "spine" : "";
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> parts_of_joints(const Skeleton& skeleton) {
  std::vector<std::string> out;
  const bool kit = skeleton.names == kit21_skeleton().names;
  for (int j = 0; j < skeleton.size(); ++j) {
    std::string part =
        kit ? to_string(kit_part_of_joint[static_cast<std::size_t>(j)]) : detail::part_in_name(skeleton.name(j));
    const int parent = skeleton.parent(j);
    if (parent < 0)
      part = "legs";
    else if (part.empty())
      part = skeleton.parent(parent) < 0 ? "spine" : out[static_cast<std::size_t>(parent)];
    out.push_back(std::move(part));
  }
  return out;
}

MOTIONLANG_BODY int newest_track(std::span<const Track> tracks, double time, std::string_view part) {
  int out = -1;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Track& t = tracks[i];
    const bool whole = part.empty() || t.parts.empty() || t.parts.front() == whole_body;
    if (!whole && std::find(t.parts.begin(), t.parts.end(), part) == t.parts.end()) continue;
    if (t.start > time || time >= t.end) continue;
    if (out < 0 || t.start >= tracks[static_cast<std::size_t>(out)].start) out = static_cast<int>(i);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
