// SPDX-License-Identifier: MIT
/// Recognises joints of fingers by their names, which every program forms in its own way. No table lists them, because
/// hands may have any number of fingers.
#pragma once

#include <string>       // names
#include <string_view>  // names

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// SMPL-H's name of a joint of a finger, "left_index1": the side, the finger, and 1, 2 or 3 from the hand on. It knows
/// "LeftHandIndex1" (Mixamo), "index_01_l" (Unreal), "DEF-f_index.01.L" (Rigify), "lIndex1" (Daz), "leftIndexProximal"
/// (VRM, whose thumbs begin with leftThumbMetacarpal) and similar names. "" for other joints, and for tips and other
/// metacarpals.
std::string finger_of(std::string_view joint);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/finger_names.ipp>
#endif
