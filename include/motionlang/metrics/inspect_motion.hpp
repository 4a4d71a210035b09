// SPDX-License-Identifier: MIT
/// Faults of a clip: the checks of `motionlang doctor`, and the repair of faults that can be repaired.
///
///     const Inspection found = inspect_motion(motion);
///     for (const Finding& f : found.findings) std::puts(f.text.c_str());
///     Motion better = mended(motion, found.cure);
///
/// A wrong scale, up axis or frame rate is corrected before later checks, so that each finding has one cause. All
/// limits are in SI units and named in InspectionLimits.
///
/// A common but wrong frame rate shows only where physics allows no other choice: in jumps and runs, in which the body
/// falls with 9.81 m/s2, and in steps that would sink faster than anything falls. Slow motion without a flight is not a
/// finding, because a person may walk slowly.
#pragma once

#include <algorithm>  // any_of
#include <array>      // names
#include <string>     // findings
#include <vector>     // findings

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class Fault : int {
  empty,
  not_finite,
  frame_rate,
  fall,
  lead_in,
  scale,
  up_axis,
  root_unit,
  swapped_sides,
  spike,
  jump,
  sliding_feet,
  floor
};
struct FaultInfo {
  std::string_view name, meaning;
  bool mendable;
};
/// By Fault.
inline constexpr std::array<FaultInfo, 13> fault_info{{
    {"no motion", "fewer than two frames", false},
    {"not finite", "a value is NaN or infinite, or a rotation has length 0", false},
    {"frame rate", "no rate that cameras, engines or data sets use", false},
    {"fall", "bodies fall faster or slower than they do: the frame rate is wrong", true},
    {"T-pose", "an inserted T-pose at the start that nobody performed", true},
    {"scale", "the figure is not as tall as a person", true},
    {"up axis", "the figure does not stand along +Y", true},
    {"root unit", "the root moves in another unit than the bones", true},
    {"sides", "left and right are exchanged: names against the way the toes point", false},
    {"spike", "one frame stands out from both of its neighbours", true},
    {"jump", "a joint goes a way between two frames that nobody can go", false},
    {"sliding feet", "the foot that carries the body moves over the floor", false},
    {"floor", "the feet are not on y = 0", true},
}};
inline const FaultInfo& info(Fault fault) { return fault_info[static_cast<std::size_t>(fault)]; }

struct Finding {
  Fault fault;
  std::string text;   // with figures and units
  double moment = 0;  // seconds into the clip, for findings at one time
};

/// The steps of `mended`, in this order. Frames are those of the inspected clip.
struct Cure {
  std::vector<Index> spikes;               // frames to replace by the middle of their neighbours
  Index lead_in = 0;                       // frames to cut off at the start
  Quaternion<double> upright{1, 0, 0, 0};  // turns the up axis of the clip to +Y
  double scale = 1;
  double root = 1;  // additional factor for the root's positions
  double lift = 0;  // metres, after scaling
  double fps = 0;   // the true frame rate; 0: unchanged
};

struct Inspection {
  std::vector<Finding> findings;
  Cure cure;

  bool has(Fault fault) const {
    return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.fault == fault; });
  }
};

struct InspectionLimits {
  double shortest = 1.0, tallest = 2.3;        // m: a person
  double doll = 0.3, giant = 5;                // m: a figure between these is accepted unless it has a person's legs
  double least_legs = 0.45, most_legs = 0.72;  // of the height up to the head; recordings have 0.55 to 0.67
  double upright = 0.8;     // mean direction of trunk and legs along an axis other than +Y; 1: exactly
  double standing = 0.3;    // m: distance of the feet from 0 along an axis that is taken for the true one
  double swapped = 0.4;     // mean cosine between the right by names and the left by toes and knees
  double wrong_rate = 1.6;  // the stated rate over the rate at which bodies fall correctly, or the inverse
  double least_rise = 0.015, least_flight = 0.06;  // m: rise of the centre of mass, in a step and in a jump
  double parabola = 0.04;                          // of that rise: mean distance from a parabola
  double off_floor = 0.08;                         // m: height of the lower foot above its standing height, in a flight
  double spike = 0.08;                             // m: distance of a joint from the middle of its neighbours in time
  double jump = 0.15;                              // m between two frames, and
  double jump_speed = 8;                           // m/s: a fast punch or kick
  double jump_seconds = 0.1;                       // a jump may be spread over this many
  double isolated = 5;    // spikes and jumps: this many times the movement of the joint in the frames around
  double violent = 1000;  // m/s2 that no joint reaches; recordings have up to 700
  double slide = 0.2;     // m/s of feet in contact, median over the contacts; recordings have 0.01 to 0.1
  double low = 0.03;      // m above the standing height of a foot joint: still on the floor
  // Height of the pelvis above the foot that carries it, as a share of the leg length: less for swimming or crawling.
  double carried = 0.4;
  double on_the_spot = 0.5;           // m: range of the root in a clip in place
  double below = 0.08, above = 0.10;  // m: depth or height of feet below or above y = 0
};

/// All findings of a clip. If no table of skeleton_tables.hpp fits, only values, frame rate, spikes and jumps are
/// checked. Throws config_error 106 for a malformed skeleton, 101 for a wrong frame rate, and shape_error 205 if the
/// arrays do not fit.
Inspection inspect_motion(const Motion& motion, const InspectionLimits& limits = {});

/// Applies the cure to the clip. Throws shape_error 203 if it names frames that the clip does not have.
Motion mended(const Motion& motion, const Cure& cure);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/inspect_motion.ipp>
#endif
