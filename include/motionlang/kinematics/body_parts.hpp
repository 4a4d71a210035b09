// SPDX-License-Identifier: MIT
/// Body parts: the five of STMC with their names, sets of parts, and the joints of each part on a skeleton. A
/// BodyPartition (body_partition.hpp) names the parts of other bodies.
#pragma once

#include <array>     // lists of parts
#include <optional>  // unknown names
#include <utility>   // synonyms

#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The number of a body part. The enumerators are the five human parts, in the order that STMC uses everywhere. Other
/// bodies have BodyPart{0}, BodyPart{1}, ... in the order of their BodyPartition.
/// Source  STMC (Petrovich et al., CVPR workshops 2024); the thesis says "torso" for `spine`; neck and head are `head`.
enum class BodyPart : int { left_arm, right_arm, legs, head, spine };
inline constexpr int body_part_count = 5;
inline constexpr std::array<std::string_view, body_part_count> body_part_names{"left arm", "right arm", "legs", "head",
                                                                               "spine"};
/// Other names of the human parts.
inline constexpr std::array<std::pair<std::string_view, BodyPart>, 6> body_part_synonyms{{
    {"torso", BodyPart::spine},
    {"neck", BodyPart::head},
    {"left hand", BodyPart::left_arm},
    {"right hand", BodyPart::right_arm},
    {"left leg", BodyPart::legs},
    {"right leg", BodyPart::legs},
}};
/// A body has at most this many parts.
inline constexpr int most_body_parts = 32;

/// A set of body parts, one bit for each.
struct BodyParts {
  unsigned bits = 0;

  /// The five human parts. BodyPartition::all() gives those of another body.
  static constexpr BodyParts all() { return {(1u << body_part_count) - 1}; }
  /// All parts of any body, for callers that do not know the body.
  static constexpr BodyParts every() { return {~0u}; }
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

/// The human part with this name or synonym in a timeline file. Case-sensitive, as published. Nothing for an unknown
/// name.
constexpr std::optional<BodyPart> parse_body_part(std::string_view name) {
  for (int p = 0; p < body_part_count; ++p) {
    if (name == body_part_names[static_cast<std::size_t>(p)]) return static_cast<BodyPart>(p);
  }
  for (const auto& [synonym, part] : body_part_synonyms) {
    if (name == synonym) return part;
  }
  return std::nullopt;
}
/// The name of a human part. Any other number gives "part 7"; BodyPartition::name knows the names of other bodies.
inline std::string to_string(BodyPart part) {
  const auto p = static_cast<std::size_t>(part);
  return p < body_part_names.size() ? std::string(body_part_names[p]) : concat_text("part ", static_cast<int>(part));
}

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
