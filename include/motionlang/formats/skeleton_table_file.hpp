// SPDX-License-Identifier: MIT
/// A table of the user's own: which joint of a skeleton has the part of which joint of SMPL. One line for each joint of
/// SMPL, fields between tabs:
///
///     pelvis<TAB>Bip01 Pelvis
///     left_hip<TAB>Bip01 L Thigh<TAB>+z-x
/// The third field are the local axes of the joint that point to the left and up in a T-pose, "+x+y" unless given.
/// Empty lines and those that begin with # are skipped. Joints of SMPL without a line follow none.
#pragma once

#include <array>  // what must be there

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/skeleton_table.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The table of a text for a skeleton.
/// Throws  with the line: io_error 403 for a line that has not two or three fields, config_error 103 for a joint that
///         SMPL or the skeleton has not, and for axes that are none, 102 for a second line of the same joint;
///         config_error 103 if the pelvis, a hip, a knee or an ankle has no line
inline SkeletonTable parse_skeleton_table(std::string_view text, const Skeleton& skeleton,
                                          std::string_view name = "table of joints") {
  SkeletonTable table{.name = std::string(name), .joints = {}, .level_soles = true};
  std::array<Index, 24> line_of{};  // 0: none yet
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    if (detail::trim(line).empty() || detail::trim(line).starts_with('#')) return;
    std::array<std::string_view, 3> fields{"", "", "+x+y"};
    std::size_t n = 0;
    for (std::size_t at = 0; at <= line.size(); ++n) {
      const std::size_t end = std::min(line.find('\t', at), line.size());
      if (n < fields.size()) fields[n] = detail::trim(line.substr(at, end - at));
      at = end + 1;
    }
    const auto& [target, source, axes] = fields;
    if (n < 2 || n > 3 || source.empty())
      raise<io_error>(403, name, ":", number, ": '", line, "' is not 'joint of SMPL<TAB>joint[<TAB>axes]'");
    const int role = smpl24_skeleton().find(target);
    if (role < 0)
      raise<config_error>(103, name, ":", number, ": '", target,
                          "' is no joint of SMPL: ", join_text(smpl24_skeleton().names));
    Index& before = line_of[static_cast<std::size_t>(role)];
    if (before > 0) raise<config_error>(102, name, ":", number, ": '", target, "' is in line ", before, " already");
    before = number;
    if (find_joint(skeleton, source) < 0)
      raise<config_error>(103, name, ":", number, ": the skeleton has no joint '", source,
                          "': ", join_text(skeleton.names));
    table.joints.push_back({std::string(target), std::string(source), std::string(axes)});
    if (!detail::is_axes(axes))
      raise<config_error>(103, name, ":", number, ": '", axes, "' does not name two axes, as +x+y does");
  });
  for (const char* needed :
       {"pelvis", "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle"}) {
    if (table.find(needed) == nullptr) raise<config_error>(103, name, ": no line says which joint is '", needed, "'");
  }
  return table;
}
/// Throws io_error 401 and as parse_skeleton_table.
inline SkeletonTable read_skeleton_table(const FilePath& path, const Skeleton& skeleton) {
  return parse_skeleton_table(detail::as_text(MappedFile::open(path)->bytes()), skeleton, path.string());
}

MOTIONLANG_NAMESPACE_END
