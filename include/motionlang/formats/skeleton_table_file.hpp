// SPDX-License-Identifier: MIT
/// A table of your own for the joints of a skeleton. Each line has a joint of SMPL and the joint of your skeleton that
/// takes its part, separated by tabs:
///
///     pelvis<TAB>Bip01 Pelvis
///     left_hip<TAB>Bip01 L Thigh<TAB>+z-x
/// The third field has the local axes of the joint that point to the left and up in a T-pose; the default is "+x+y".
/// Empty lines and lines that begin with # are skipped. Joints of SMPL without a line follow no joint.
#pragma once

#include <string_view>  // texts

#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/skeleton_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Reads the table of a skeleton from a text.
/// Throws  with the line: io_error 403 for a line without two or three fields, config_error 103 for a joint that
///         SMPL or the skeleton lacks, and for unknown axes, 102 for a second line of the same joint;
///         config_error 103 if the pelvis, a hip, a knee or an ankle has no line
SkeletonTable parse_skeleton_table(std::string_view text, const Skeleton& skeleton,
                                   std::string_view name = "table of joints");
/// Throws io_error 401 and as parse_skeleton_table.
SkeletonTable read_skeleton_table(const FilePath& path, const Skeleton& skeleton);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/skeleton_table_file.ipp>
#endif
