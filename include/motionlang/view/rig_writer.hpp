// SPDX-License-Identifier: MIT
/// Writes motions on the character of a user: a GLB file with the motions added, or a page.
///
///     const RigWriter write = rig_writer({.file = "character.glb"});
///     const std::string report = write("walk.glb", std::span(&motion, 1));
#pragma once

#include <filesystem>  // results
#include <functional>  // writers
#include <span>        // motions
#include <string>      // files

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The character of a user.
struct RigOptions {
  std::string file{};            // "": no character, and no writer
  std::string joints{};          // table of its joints (formats/skeleton_table_file.hpp); "": a known one
  bool drop_animations = false;  // of the character's file
};

/// Writes motions into a GLB file or a page (.html), and returns lines about how the skeleton follows. Throws
/// option_error 103 for another extension, config_error 103 without motions, and what the writers throw.
using RigWriter = std::function<std::string(const std::filesystem::path&, std::span<const Motion>)>;
/// The character is read immediately. Throws what GlbRig and read_skeleton_table throw.
RigWriter rig_writer(const RigOptions& options);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/rig_writer.ipp>
#endif
