// SPDX-License-Identifier: MIT
/// Puts bodies on the floor. Generated bodies hover, sink in, and stay in the air longer than gravity allows. Metres, Y
/// up.
///
///     Motion grounded = fix_floor(motion);      // stand_on_floor, lift_sunken_feet
///
/// The floor is flat: a body that stands on stairs, a ladder or a seat for long comes down to the floor.
#pragma once

#include <algorithm>  // min

#include <motionlang/kinematics/foot_lock.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct FloorFixOptions {
  double floor = 0;
  double ankle_stands = 0.07, toe_stands = 0.015;  // m; height of these joints of a standing foot
  double body_rests = 0.05;                        // m; of any other joint on which a body rests
  double tolerance = 0.04;                         // m; a body within this distance of the floor stays
  double longest_flight = 1.2;                     // s; a body that is above the floor for longer hovers
  double gravity = 9.81;                           // m/s^2
  double sigma = 0.05;                             // s; smoothness of the correction
  double foot_sinks = 0.02;                        // m; a foot that sinks in less than this stays
  double seated = 0;  // m; if the root is lower, the trunk rests on the floor and feet carry nothing; 0: never
};

namespace detail {

/// The distance of a foot above its standing height, at its toe or its ankle, whichever is nearer to the floor.
inline double foot_over_floor(std::span<const Vec3<double>> pose, const Leg& leg, const FloorFixOptions& options) {
  const auto at = [&](int joint) { return pose[static_cast<std::size_t>(joint)].y - options.floor; };
  return std::min(at(leg.limb.end) - options.ankle_stands, at(leg.toe) - options.toe_stands);
}

}  // namespace detail

/// (frames): the distance of the lowest part of the body above the floor, relative to the heights at which it stands or
/// rests. Negative values mean that it has sunk in. Within 0.2 m above options.seated, feet count less for a lower
/// root; below that they do not count. Throws config_error 103 if the skeleton has no such legs.
std::vector<double> heights_over_floor(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                                       const FloorFixOptions& options = {});

/// The clip with its root moved up and down so that the floor carries it: h_f of heights_over_floor becomes 0 where the
/// body stands. Rotations and the path over the floor stay.
///    hovering   the rest of h after flights of at most longest_flight are removed (a morphological opening)
///    flights    no higher than a thrown body of the same peak:   h_f <= H - g/2 (t_f - t_peak)^2, or 0
///    sunken     raised by their depth below the floor
/// A correction starts at `tolerance`, and is complete from twice that on. Throws config_error 103 if the skeleton has
/// no such legs, and 101 unless longest_flight and sigma are positive.
Motion stand_on_floor(const Motion& motion, std::span<const Leg> legs = smpl_legs, const FloorFixOptions& options = {});

/// The clip with bent legs, so that no foot sinks deeper into the floor than foot_sinks. Throws as lock_feet.
Motion lift_sunken_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                        const FloorFixOptions& options = {});

/// Applies stand_on_floor and lift_sunken_feet. Throws what they throw.
inline Motion fix_floor(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                        const FloorFixOptions& options = {}) {
  return lift_sunken_feet(stand_on_floor(motion, legs, options), legs, options);
}

/// A recorded clip on the floor: moved up or down by what its lowest tenth is off, then fix_floor.
/// seated  somebody sits, lies or does exercises on the floor: hips below 0.6 m come down to it, nothing flies
/// Throws what fix_floor throws.
Motion ground_recording(const Motion& motion, bool seated = false, std::span<const Leg> legs = smpl_legs,
                        FloorFixOptions options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/floor_fix.ipp>
#endif
