// SPDX-License-Identifier: MIT
// Bodies of skeleton_table_file.hpp.
#pragma once

#include <array>  // what must be there

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/formats/skeleton_table_file.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SkeletonTable parse_skeleton_table(std::string_view text, const Skeleton& skeleton,
                                                   std::string_view name) {
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
                          "' is not a joint of SMPL: ", join_text(smpl24_skeleton().names));
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

MOTIONLANG_BODY SkeletonTable read_skeleton_table(const FilePath& path, const Skeleton& skeleton) {
  return parse_skeleton_table(detail::as_text(MappedFile::open(path)->bytes()), skeleton, path.string());
}

MOTIONLANG_NAMESPACE_END
