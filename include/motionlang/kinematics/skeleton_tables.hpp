// SPDX-License-Identifier: MIT
/// The tables for retargeting, which map the joints of known skeletons to those of SMPL, and functions that recognise a
/// skeleton. Tables are used in both directions, because SMPL's 24 joints are common to all skeletons.
#pragma once

#include <motionlang/kinematics/skeleton_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view own_table_hint =
    "a file can name the joints and their axes: read_skeleton_table, option `joints`";

}  // namespace detail

/// The built-in tables.
const std::vector<SkeletonTable>& skeleton_tables();

/// The table whose joints the skeleton has. Among several it prefers one whose rest pose fits, then the one with the
/// most joints. Null if none fits.
const SkeletonTable* find_skeleton_table(const Skeleton& source);
/// The same. If none fits, throws config_error 103 with the joint that is missing for the closest table.
const SkeletonTable& detect_skeleton_table(const Skeleton& source);
/// A built-in table by name. Throws config_error 103.
const SkeletonTable& skeleton_table(std::string_view name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/skeleton_tables.ipp>
#endif
