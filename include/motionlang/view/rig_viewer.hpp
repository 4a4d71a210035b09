// SPDX-License-Identifier: MIT
/// A page that shows motions on the user's character, a GLB or VRM file, in one colour. The page contains the surface
/// at rest: a user who may not share the character may not share the page.
///
///     const GlbRig rig = GlbRig::open("character.vrm");
///     write_rig_viewer("walk.html", rig, std::span(&motion, 1));
#pragma once

#include <span>    // motions
#include <string>  // the page

#include <motionlang/formats/glb_rig.hpp>
#include <motionlang/view/viewer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The turn about Y, by quarters of a circle, after which a character faces +Z at rest. The page looks at a figure from
/// there in the beginning, and characters of VRM 0.x face -Z.
Quaternion<double> turn_to_front(const GlbRig& rig);
/// The same motion of a skeleton whose rest pose is turned.
Motion with_turned_rest(Motion m, const Quaternion<double>& turn);

}  // namespace detail

/// motions  are retargeted unless they are on the character's skeleton
/// Throws   what viewer_html, motions_on_rig and GlbRig::mesh throw
std::string rig_viewer_html(const GlbRig& rig, std::span<const Motion> motions, const ViewerOptions& options = {});
/// The data of such a page for one motion, as JSON: {"motion": ..., "body": ...}. The body is the surface at rest.
std::string rig_viewer_data(const GlbRig& rig, const Motion& motion);
/// Throws io_error 401, and what rig_viewer_html throws.
void write_rig_viewer(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
                      const ViewerOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/rig_viewer.ipp>
#endif
