// SPDX-License-Identifier: MIT
/// Feet that stay where they stand. Y up, metres. Generated motions slide a little: the path of the root and the legs
/// are predicted side by side and agree only nearly.
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

/// Those of a skeleton with the joints of SMPL, with or without its hands, or of KIT; none of another one.
std::span<const Leg> known_legs(const Skeleton& skeleton);

struct FootFixOptions {
  double floor = 0;
  double ankle_height = smpl_ankle_contact, toe_height = smpl_toe_contact;  // below: in contact
  double speed = 0.5;       // m/s; lock_feet takes a foot that slides faster to swing
  double path_speed = 2;    // m/s; path_from_feet takes no foot that slides faster to carry the body
  double path_sigma = 1.5;  // frames; smoothness of the correction of the path
  Index blend = 4;          // frames before and after a contact in which the leg comes and goes
  double pivot = 15;        // degrees/s; turn_from_feet lets two feet on the floor turn together that fast
  double clearance = 0.03;  // m; toes swing this high above where they stand; in recorded walks mostly 2.7 to 5.5 cm
};

/// The clip turned so that nobody turns like a turntable: what both feet turn together while they are on the floor,
/// beyond `pivot`, the body does not turn. Where it looks is decided by the legs. The way turns with it.
/// Throws config_error 103 if the skeleton has no such legs. A body without two legs stays as it is.
Motion turn_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// The clip with its path over the floor corrected so that the foot that stands (of the low ones the slowest) does not
/// slide: where somebody goes is decided by the legs. Rotations and heights stay; in the air the path stays, too.
/// Throws config_error 103 if the skeleton has no such legs, 101 unless path_sigma > 0.
Motion path_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

namespace detail {

/// Throws config_error 103 unless the skeleton has these legs.
void require_legs(std::string_view function, const Skeleton& skeleton, std::span<const Leg> legs);
/// Moves the foot of a leg in every frame by its offset.
void move_foot(Motion& motion, const Leg& leg, std::span<const Vec3<double>> offset);

}  // namespace detail

/// The clip with legs bent so that ankles and toes in contact stay in place. Between contacts the correction fades out
/// and in. Throws config_error 103 if the skeleton has no such legs, numeric_error 302 if a leg has no length.
Motion lock_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// The clip with legs bent so that a foot swings over the floor, not along it: generated ones pass too low. A foot that
/// stands is not moved. Throws as lock_feet.
Motion raise_swings(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FootFixOptions& options = {});

/// turn_from_feet, path_from_feet, lock_feet, raise_swings. Throws what they throw.
inline Motion fix_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                       const FootFixOptions& options = {}) {
  const Motion carried = path_from_feet(turn_from_feet(motion, legs, options), legs, options);
  return raise_swings(lock_feet(carried, legs, options), legs, options);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/foot_lock.ipp>
#endif
