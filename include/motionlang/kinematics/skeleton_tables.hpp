// SPDX-License-Identifier: MIT
/// Which joint of a known skeleton has the part of which joint of SMPL: the tables behind retargeting, and how to
/// recognise one. They are read in both directions: SMPL's 24 joints are what all skeletons have in common.
#pragma once

#include <motionlang/kinematics/skeleton_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view own_table_hint =
    "a file can name the joints and their axes: read_skeleton_table, option `joints`";

}  // namespace detail

/// The built-in tables.
const std::vector<SkeletonTable>& skeleton_tables();

/// The table whose joints the skeleton has; of several one by which it stands at rest, then the one with the most. Null
/// if none fits.
const SkeletonTable* find_skeleton_table(const Skeleton& source);
/// The same. Throws config_error 103 with the joint that the closest table misses if none fits.
const SkeletonTable& detect_skeleton_table(const Skeleton& source);
/// A built-in table by name. Throws config_error 103.
const SkeletonTable& skeleton_table(std::string_view name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/skeleton_tables.ipp>
#endif
