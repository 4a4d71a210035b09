// SPDX-License-Identifier: MIT
/// Keeps standing feet in place. Y up, metres. Generated motions slide a little, because the model predicts the path of
/// the root and the legs side by side, and they agree only approximately.
///
///     Motion steady = fix_feet(motion);      // turn_from_feet, path_from_feet, lock_feet, raise_swings
#pragma once

#include <motionlang/kinematics/foot_contact.hpp>
#include <motionlang/kinematics/limb_ik.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A leg and its toe.
struct Leg {
  Limb limb;
  int toe = 0;
};
inline constexpr Leg smpl_legs[] = {{{1, 4, 7}, 10}, {{2, 5, 8}, 11}};
inline constexpr Leg kit_legs[] = {{{11, 12, 13}, 15}, {{16, 17, 18}, 20}};

/// The legs of a skeleton with the joints of SMPL, with or without its hands, or of KIT. None for other skeletons.
std::span<const Leg> known_legs(const Skeleton& skeleton);

struct FootFixOptions {
  double floor = 0;
  double ankle_height = smpl_ankle_contact, toe_height = smpl_toe_contact;  // below: in contact
  double speed = 0.5;       // m/s; lock_feet treats a foot that slides faster as swinging
  double path_speed = 2;    // m/s; path_from_feet ignores a foot that slides faster
  double path_sigma = 1.5;  // frames; smoothness of the correction of the path
  Index blend = 4;          // frames before and after a contact over which the leg is blended
  double pivot = 15;        // degrees/s; turn_from_feet allows two feet on the floor to turn together at this speed
  double clearance = 0.03;  // m; toes swing this much above their standing height; recorded walks: 2.7 to 5.5 cm
};

/// The clip, turned so that the body does not rotate on standing feet. If both feet turn together on the floor faster
/// than `pivot`, the body does not turn by the excess. So the legs decide the heading, and the path turns with it.
/// Throws config_error 103 if the skeleton has no such legs. A body without two legs is not changed.
Motion turn_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// The clip with its path over the floor corrected so that the standing foot (the slowest of the low ones) does not
/// slide. So the legs decide the path. Rotations and heights stay; in the air the path stays, too. Throws config_error
/// 103 if the skeleton has no such legs, and 101 unless path_sigma > 0.
Motion path_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

namespace detail {

/// Throws config_error 103 unless the skeleton has these legs.
void require_legs(std::string_view function, const Skeleton& skeleton, std::span<const Leg> legs);
/// Moves the foot of a leg in every frame by its offset.
void move_foot(Motion& motion, const Leg& leg, std::span<const Vec3<double>> offset);

}  // namespace detail

/// The clip with bent legs, so that ankles and toes in contact stay in place. Between contacts the correction fades out
/// and in. Throws config_error 103 if the skeleton has no such legs, and numeric_error 302 if a leg has no length.
Motion lock_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// The clip with bent legs, so that a swinging foot passes over the floor and not along it. Generated feet swing too
/// low. A standing foot is not moved. Throws as lock_feet.
Motion raise_swings(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// Applies turn_from_feet, path_from_feet, lock_feet and raise_swings. Throws what they throw.
inline Motion fix_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                       const FootFixOptions& options = {}) {
  const Motion carried = path_from_feet(turn_from_feet(motion, legs, options), legs, options);
  return raise_swings(lock_feet(carried, legs, options), legs, options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/foot_lock.ipp>
#endif
