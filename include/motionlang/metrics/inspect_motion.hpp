// SPDX-License-Identifier: MIT
/// Faults of a clip: the checks of `motionlang doctor`, and the repair of faults that can be repaired.
///
///     const Inspection found = inspect_motion(motion);
///     for (const Finding& f : found.findings) std::puts(f.text.c_str());
///     Motion better = mended(motion, found.cure);
///
/// A wrong scale, up axis or frame rate is corrected before the checks that follow it, so that each finding has one
/// cause. All limits are in SI units and named in InspectionLimits.
///
/// A usual but wrong frame rate shows only where physics leaves no choice: in jumps and runs, in which the body falls
/// with 9.81 m/s2, and in steps that would sink faster than anything falls. Slow motion without a flight is not a
/// finding: a person may walk as slowly.
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
  double moment = 0;  // seconds into the clip, of what happens at a time
};

/// The steps of `mended`, in this order. Frames count in the clip that was inspected.
struct Cure {
  std::vector<Index> spikes;               // frames that are replaced by the middle of their neighbours
  Index lead_in = 0;                       // frames that are cut off at the start
  Quaternion<double> upright{1, 0, 0, 0};  // turns the up axis of the clip to +Y
  double scale = 1;
  double root = 1;  // by which the root's positions are to be multiplied, besides
  double lift = 0;  // metres, after scaling
  double fps = 0;   // the true frame rate; 0: as it is
};

struct Inspection {
  std::vector<Finding> findings;
  Cure cure;

  bool has(Fault fault) const {
    return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.fault == fault; });
  }
};

struct InspectionLimits {
  double shortest = 1.0, tallest = 2.3;  // m: a person
  double doll = 0.3, giant = 5;          // m: between these a figure may be drawn so, unless it has a person's legs,
  double least_legs = 0.45, most_legs = 0.72;  // of the height up to the head; recordings have 0.55 to 0.67
  double upright = 0.8;     // mean direction of trunk and legs along another axis than +Y; 1: exactly
  double standing = 0.3;    // m that feet may be off 0 along an axis that is taken for the true one
  double swapped = 0.4;     // mean cosine between the right that names tell and the left that toes and knees tell
  double wrong_rate = 1.6;  // the stated rate over the one at which bodies fall as they do, or the other way round
  double least_rise = 0.015, least_flight = 0.06;  // m that the centre of mass rises, in a step and in a jump
  double parabola = 0.04;                          // of that rise: how far off a parabola in the mean
  double off_floor = 0.08;                         // m that the lower foot is above where it stands, in a flight
  double spike = 0.08;                             // m that a joint is off the middle of its neighbours in time
  double jump = 0.15;                              // m between two frames, and
  double jump_speed = 8;                           // m/s: a fast punch or kick
  double jump_seconds = 0.1;                       // a jump may be spread over this many
  double isolated = 5;    // spikes and jumps: this many times what the joint does in the frames around
  double violent = 1000;  // m/s2 that no joint takes in any surroundings; recordings have up to 700
  double slide = 0.2;     // m/s of feet in contact, median over the contacts; recordings have 0.01 to 0.1
  double low = 0.03;      // m above where a foot joint is when it stands: still on the floor
  // Part of the length of the legs that the pelvis is above a foot that carries it: not for those who swim or crawl.
  double carried = 0.4;
  double on_the_spot = 0.5;           // m across which the root moves in a clip in place
  double below = 0.08, above = 0.10;  // m that feet may be below or above y = 0
};

/// All findings of a clip. Skeletons that no table of skeleton_tables.hpp fits are checked for values, frame rate,
/// spikes and jumps only. Throws config_error 106 for a malformed skeleton, 101 for a wrong frame rate,
/// shape_error 205 if the arrays do not fit.
Inspection inspect_motion(const Motion& motion, const InspectionLimits& limits = {});

/// The clip with what the cure says. Throws shape_error 203 if it names frames that the clip does not have.
Motion mended(const Motion& motion, const Cure& cure);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/inspect_motion.ipp>
#endif
