// SPDX-License-Identifier: MIT
/// The text that a joint follows at a time, by which pictures colour bodies.
///
/// Source  thesis figure 6.7: "the coloring follows the input text, prioritizing the newest prompt when there is an
///         overlap across tracks"
#pragma once

#include <span>         // tracks
#include <string>       // names
#include <string_view>  // names
#include <vector>       // joints

#include <motionlang/kinematics/skeleton.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The name of the body part of each joint, by the joints' names: "left arm", "right arm", "legs", "head" or "spine".
/// The root belongs to the legs. A joint whose name says nothing belongs to the part of its parent.
std::vector<std::string> parts_of_joints(const Skeleton& skeleton);

/// The number of the track at a time, -1 without one. Of several, it is the one that started last, and of these the
/// last in the list.
/// part   only tracks with this part, or with the whole body; "": all tracks
int newest_track(std::span<const Track> tracks, double time, std::string_view part = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/text_colours.ipp>
#endif
