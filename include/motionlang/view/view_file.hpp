// SPDX-License-Identifier: MIT
/// Pages (.html) and film strips (.svg, .png) of motions; the extension of the name chooses.
///
///     write_view("walk.html", read_motion("walk.bvh"));
///     write_motion_or_view(argv[2], motion);             // or a motion file, by the extension
#pragma once

#include <span>  // motions

#include <motionlang/formats/motion_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if write_view writes this kind: .html, .svg, .png.
bool is_view(const FilePath& path);

/// Writes a page or a picture. Throws config_error 103 for another extension, io_error 401, and what the writers throw.
void write_view(const FilePath& path, const Motion& motion);

/// Writes a motion file (formats/motion_file.hpp) or a page or picture. Throws option_error 103 for another extension,
/// and what write_motion and write_view throw.
void write_motion_or_view(const FilePath& path, const Motion& motion, const MotionWriteOptions& options = {});

/// The contents of such a file. `kind` is the extension, ".html", or a name that ends in it. Throws what
/// write_motion_or_view throws, except io_error 401.
std::vector<std::byte> motion_or_view_bytes(const FilePath& kind, const Motion& motion,
                                            const MotionWriteOptions& options = {});

/// True if one file of this kind holds several motions: .glb, .html.
bool holds_several(const FilePath& path);
/// True if one file of this kind holds these motions (at least one). A GLB file holds motions on one skeleton.
bool holds_together(const FilePath& path, std::span<const Motion> motions);
/// Writes several motions into one file: animations of a GLB file, or a page with a menu of motions.
/// Throws config_error 103 for another extension, io_error 401, and what write_glb and write_viewer throw.
void write_motions(const FilePath& path, std::span<const Motion> motions);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/view_file.ipp>
#endif
