// SPDX-License-Identifier: MIT
/// The side of the body in the name of a joint, and possible names of its partner.
#pragma once

#include <string>       // names
#include <string_view>  // names
#include <vector>       // candidates

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Side of the body: a rest pose faces +Z, its left is at +X.
enum class Side : int { middle, left, right };

namespace detail {

/// The side in a joint's name: left, Left, l_, _L, .l, _L_, lHand, LHip, and the same for the right.
Side side_of_name(std::string_view name);

bool has_side_word(std::string_view name);
/// Possible names of the joint on the other side. A letter may be a coincidence ("lowerback"), so look the names up.
std::vector<std::string> other_side(const std::string& name);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/joint_sides.ipp>
#endif
