// SPDX-License-Identifier: MIT
// Bodies of rig_writer.hpp.
#pragma once

#include <motionlang/core/option_error.hpp>
#include <motionlang/formats/glb_rig.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/formats/skeleton_table_file.hpp>
#include <motionlang/view/rig_viewer.hpp>
#include <motionlang/view/rig_writer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY RigWriter rig_writer(const RigOptions& options) {
  if (options.file.empty()) return {};
  GlbRig::FindTable find_table = detect_skeleton_table;
  if (!options.joints.empty()) find_table = [&](const Skeleton& s) { return read_skeleton_table(options.joints, s); };
  return [rig = GlbRig::open(options.file, find_table), options](const std::filesystem::path& path,
                                                                 std::span<const Motion> motions) {
    const std::string kind = file_kind(path);
    if (kind != ".glb" && kind != ".html")
      raise<option_error>(103, path.string(), ": a character (`rig`) is written to .glb and .html, not '", kind, "'");
    if (motions.empty()) raise<config_error>(103, path.string(), ": no motion");
    const MotionsOnRig on_rig = motions_on_rig(rig, motions);
    if (kind == ".html")
      write_rig_viewer(path, rig, on_rig.motions);
    else
      write_glb(path, rig, on_rig.motions, {.keep_animations = !options.drop_animations});
    return concat_text(
        path.string(), " on ", options.file, "\n",
        on_rig.report ? to_string(*on_rig.report) : std::string("all joints follow: it is the motion's own skeleton"),
        "\n");
  };
}

MOTIONLANG_NAMESPACE_END
