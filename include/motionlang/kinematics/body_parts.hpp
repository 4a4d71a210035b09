// SPDX-License-Identifier: MIT
/// Named body parts: the five of STMC, and the joints of each on a skeleton.
#pragma once

#include <array>     // lists of parts
#include <optional>  // unknown names

#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The five parts in the order that STMC uses everywhere.
/// Source  STMC (Petrovich et al., CVPR workshops 2024); the thesis says "torso" for `spine`; neck and head are `head`.
enum class BodyPart : int { left_arm, right_arm, legs, head, spine };
inline constexpr int body_part_count = 5;
inline constexpr std::array<std::string_view, body_part_count> body_part_names{"left arm", "right arm", "legs", "head",
                                                                               "spine"};

/// A set of body parts.
struct BodyParts {
  unsigned bits = 0;

  static constexpr BodyParts all() { return {(1u << body_part_count) - 1}; }
  constexpr bool has(BodyPart p) const { return (bits >> static_cast<unsigned>(p) & 1u) != 0; }
  constexpr BodyParts with(BodyPart p) const { return {bits | 1u << static_cast<unsigned>(p)}; }
  constexpr int count() const {
    int n = 0;
    for (unsigned b = bits; b != 0; b &= b - 1) ++n;
    return n;
  }
  constexpr bool empty() const { return bits == 0; }
  constexpr bool operator==(const BodyParts&) const = default;
};

/// Part of a name as it stands in a timeline file; synonyms: torso = spine, neck = head, left hand = left arm, right
/// hand = right arm, left leg = right leg = legs. Case-sensitive, as published. Nothing for an unknown name.
constexpr std::optional<BodyPart> parse_body_part(std::string_view name) {
  for (int p = 0; p < body_part_count; ++p) {
    if (name == body_part_names[static_cast<std::size_t>(p)]) return static_cast<BodyPart>(p);
  }
  if (name == "torso") return BodyPart::spine;
  if (name == "neck") return BodyPart::head;
  if (name == "left hand") return BodyPart::left_arm;
  if (name == "right hand") return BodyPart::right_arm;
  if (name == "left leg" || name == "right leg") return BodyPart::legs;
  return std::nullopt;
}
inline std::string to_string(BodyPart part) { return std::string(body_part_names[static_cast<std::size_t>(part)]); }

/// Part of each SMPL joint (24; the first 22 are HumanML3D's). Collars belong to the arms, the pelvis to the legs.
inline constexpr std::array<BodyPart, 24> smpl_part_of_joint = [] {
  using enum BodyPart;
  return std::array{legs,     legs,      legs,     spine,     legs,     legs,      spine,     legs,
                    legs,     spine,     legs,     legs,      head,     left_arm,  right_arm, head,
                    left_arm, right_arm, left_arm, right_arm, left_arm, right_arm, left_arm,  right_arm};
}();

/// Part of each joint of KIT-ML (21, Master Motor Map): the neck belongs to the head, as in SMPL.
inline constexpr std::array<BodyPart, 21> kit_part_of_joint = [] {
  using enum BodyPart;
  return std::array{legs, spine, spine, head, head, left_arm, left_arm, left_arm, right_arm, right_arm, right_arm,
                    legs, legs,  legs,  legs, legs, legs,     legs,     legs,     legs,      legs};
}();

/// Partner of each SMPL joint under reflection in the sagittal plane.
inline constexpr std::array<int, 24> smpl_mirror_joint{0,  2,  1,  3,  5,  4,  6,  8,  7,  9,  11, 10,
                                                       12, 14, 13, 15, 17, 16, 19, 18, 21, 20, 23, 22};

MOTIONLANG_NAMESPACE_END
