// SPDX-License-Identifier: MIT
/// The body part and the meaning of each value of a feature vector. Composition needs only the body parts of a
/// representation.
///
/// Source  STMC (Petrovich et al. 2024), bptools: joint j owns its position, its 6D rotation and its velocity. The
///         values of the root and the foot contacts belong to the legs. The tables are generated from that rule. In
///         other bodies the part with the path takes the place of the legs. Meanings and units: HumanML3D
///         motion_representation.ipynb; STMC src/tools/smplrifke_feats.py; TEMOS
///         temos/transforms/joints2jfeats/rifke.py; TMR src/rifke.py
#pragma once

#include <array>        // one list for each part
#include <span>         // parts of joints
#include <string>       // name
#include <string_view>  // meanings
#include <utility>      // move
#include <vector>       // ranges

#include <motionlang/kinematics/body_partition.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Half-open range of positions.
struct IndexRange {
  Index begin = 0, end = 0;
  constexpr Index size() const { return end - begin; }
  bool operator==(const IndexRange&) const = default;
};

/// The meaning of some values of a feature vector. A table of these covers the vector without gap or overlap.
struct FeatureRange {
  IndexRange numbers;
  std::string_view meaning;  // with `joints`: of each joint
  std::string_view unit;     // "1": none; frames are those of the features
  IndexRange joints{};       // in order, each with equally many values; empty: the root's values, contacts
};

/// A feature vector divided into body parts: every value belongs to exactly one. Your own representation is a name, a
/// size and the ranges, or `from_owner`:
///
///     const auto owner = [](Index i) { return i < 40 ? BodyPart::legs : BodyPart::head; };
///     auto layout = FeatureLayout::from_owner("my features", 64, owner);
struct FeatureLayout {
  std::string name;
  Index size = 0;                                              // values of one frame
  std::array<std::vector<IndexRange>, most_body_parts> parts;  // ascending and separate, in the order of the parts
  BodyPartition body{};                                        // whose parts; the human body unless given

  /// From a function position -> BodyPart, or the number of a part. Throws config_error 102 for a part that the body
  /// lacks.
  template <class F>
  static FeatureLayout from_owner(std::string name, Index size, F owner) {
    return from_owner(std::move(name), size, BodyPartition(), std::move(owner));
  }
  template <class F>
  static FeatureLayout from_owner(std::string name, Index size, BodyPartition body, F owner) {
    FeatureLayout layout{std::move(name), size, {}, std::move(body)};
    for (Index i = 0; i < size; ++i) {
      const auto part = static_cast<Index>(owner(i));
      if (part < 0 || part >= layout.body.size())
        raise<config_error>(102, "FeatureLayout '", layout.name, "': number ", i, " belongs to part ", part, " of ",
                            layout.body.size());
      auto& ranges = layout.parts[static_cast<std::size_t>(part)];
      if (ranges.empty() || ranges.back().end != i) ranges.push_back({i, i});
      ranges.back().end = i + 1;
    }
    return layout;
  }

  const std::vector<IndexRange>& ranges(BodyPart part) const { return parts[static_cast<std::size_t>(part)]; }

  /// All positions of a part, ascending.
  std::vector<Index> indices(BodyPart part) const;

  /// Throws config_error 102 unless the ranges cover 0 ... size-1, each position once, and belong to parts of the body.
  void validate() const;
  bool operator==(const FeatureLayout&) const = default;
};

/// smplrifke: 4 root numbers, 6D rotations of `rotations` joints, positions of joints 1 ... J-1: 4 + 6 * 22 + 3 * 23 =
/// 205 for SMPL.
FeatureLayout smplrifke_layout(std::span<const BodyPart> part_of_joint = smpl_part_of_joint, Index rotations = 22,
                               const BodyPartition& body = {});

/// The meaning of the values of `smplrifke_layout`. World: Z up.
inline constexpr std::array<FeatureRange, 6> smplrifke_ranges{{
    {{0, 1}, "height of the pelvis above the lowest joint of the clip", "m"},
    {{1, 3}, "velocity of the pelvis to the next frame, seen from the body: x, y", "m/frame"},
    {{3, 4}, "turn of the heading to the next frame", "rad/frame"},
    {{4, 10}, "rotation in the world without the heading: the first two rows of the matrix", "1", {0, 1}},
    {{10, 136}, "rotation relative to the parent: the first two rows of the matrix", "1", {1, 22}},
    {{136, 205}, "position relative to the pelvis, seen from the body: x, y, z", "m", {1, 24}},
}};

/// The places in the vector of HumanML3D (22 joints: 263 values) and of KIT (21: 251); 12 J - 1 in all.
///
///     0              turn of the heading to the next frame: half the angle, radians
///     1:3            velocity of the root along x and z, seen from the body of the next frame
///     3              height of the root
///     positions      joints 1 ... J-1 seen from the body, heights above the floor: 3 each
///     rotations      joints 1 ... J-1: two columns of the matrix, 6 each
///     velocities     joints 0 ... J-1 to the next frame, seen from the body: 3 each
///     contacts       left ankle, left toes, right ankle, right toes: 1 if they stand, else 0
struct Guoh3dSlots {
  Index joints = 22;

  constexpr IndexRange positions() const { return {4, 4 + 3 * (joints - 1)}; }
  constexpr IndexRange rotations() const { return {positions().end, positions().end + 6 * (joints - 1)}; }
  constexpr IndexRange velocities() const { return {rotations().end, rotations().end + 3 * joints}; }
  constexpr IndexRange contacts() const { return {velocities().end, velocities().end + 4}; }
  constexpr Index size() const { return contacts().end; }
  /// The seven groups for which one deviation each was published.
  constexpr std::array<IndexRange, 7> groups() const {
    return {{{0, 1}, {1, 3}, {3, 4}, positions(), rotations(), velocities(), contacts()}};
  }
};

/// The vector of HumanML3D or, with 21 joints, of KIT: see Guoh3dSlots. The root and the contacts belong to the legs,
/// or to the part with the path.
FeatureLayout guoh3dfeats_layout(std::span<const BodyPart> part_of_joint = std::span(smpl_part_of_joint).first<22>(),
                                 const BodyPartition& body = {});

namespace detail {

constexpr std::array<FeatureRange, 7> guoh3dfeats_ranges_of(const Guoh3dSlots& slots, std::string_view length,
                                                            std::string_view speed, std::string_view contacts) {
  const auto [turn, velocity, height, positions, rotations, velocities, feet] = slots.groups();
  return {{
      {turn, "half the turn of the heading to the next frame", "rad/frame"},
      {velocity, "velocity of the root to the next frame, seen from the body of the next frame: x, z", speed},
      {height, "height of the root above the floor", length},
      {positions, "position from the floor below the root, seen from the body: x, y, z", length, {1, slots.joints}},
      {rotations,
       "rotation of the bone that ends here relative to the one before it in its chain, of the first to the root: "
       "the first two columns of the matrix",
       "1",
       {1, slots.joints}},
      {velocities, "velocity to the next frame, seen from the body: x, y, z", speed, {0, slots.joints}},
      {feet, contacts, "1"},
  }};
}

}  // namespace detail

/// The meaning of the values of `guoh3dfeats_layout`: of HumanML3D, and of KIT with MMM's joints. World: Y up.
inline constexpr auto guoh3dfeats_ranges = detail::guoh3dfeats_ranges_of(
    {22}, "m", "m/frame", "left ankle, left foot, right ankle, right foot: 1 if it stands, else 0");
inline constexpr auto kit_ranges =
    detail::guoh3dfeats_ranges_of({21}, "m/640", "m/640/frame", "RMrot, RF, LMrot, LF: 1 if it stands, else 0");

/// rifke: the root's height, positions of joints 1 ... J-1, the root's turn and velocity (see rifke.hpp): 3 J + 1, 67
/// for SMPL's 22 joints and with `kit_part_of_joint` TEMOS's 64.
FeatureLayout rifke_layout(std::span<const BodyPart> part_of_joint = std::span(smpl_part_of_joint).first<22>(),
                           const BodyPartition& body = {});

/// The meaning of the values of `rifke_layout`: of TMR, Z up, and of TEMOS on KIT, Y up.
inline constexpr std::array<FeatureRange, 4> rifke_ranges{{
    {{0, 1}, "height of the root", "m"},
    {{1, 64}, "position from the ground below the root, seen from the body: x, y, z", "m", {1, 22}},
    {{64, 65}, "turn of the heading to the next frame", "rad/frame"},
    {{65, 67}, "velocity of the root to the next frame, seen from the body: x, y", "m/frame"},
}};
inline constexpr std::array<FeatureRange, 4> rifke64_ranges{{
    {{0, 1}, "height of the root above the floor", "m/640"},
    {{1, 61}, "position from the floor below the root, seen from the body: x, y, z", "m/640", {1, 21}},
    {{61, 62}, "turn of the heading since the frame before", "rad/frame"},
    {{62, 64}, "velocity of the root since the frame before, seen from the body: x, z", "m/640/frame"},
}};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/layout.ipp>
#endif
