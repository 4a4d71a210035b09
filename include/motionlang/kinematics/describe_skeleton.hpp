// SPDX-License-Identifier: MIT
/// A skeleton as text, for programs that show what a file holds.
#pragma once

#include <string>  // lines

#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A line for each joint: its number, its name and its parent.
std::string describe_skeleton(const Skeleton& skeleton);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/describe_skeleton.ipp>
#endif
