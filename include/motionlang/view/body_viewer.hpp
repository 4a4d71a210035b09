// SPDX-License-Identifier: MIT
/// A page that shows motions on the user's own body instead of the figure of cones (which a browser without WebGL still
/// shows). The page contains the surface of the body at rest. So a user who may not share the body may not share the
/// page.
#pragma once

#include <motionlang/file/file.hpp>
#include <motionlang/formats/detail/body_mesh.hpp>
#include <motionlang/view/viewer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// motions  as motion_on_body takes them
/// Throws   what viewer_html and motion_on_body throw; config_error 101 for a body without faces
template <Backend B>
std::string body_viewer_html(const Body<B>& body, std::span<const ViewerMotion> motions,
                             std::span<const typename B::scalar> betas = {}, const ViewerOptions& options = {}) {
  if (body.faces.empty()) raise<config_error>(101, "viewer: the body has no faces");
  const Skeleton skeleton = body_skeleton(body, betas);  // refuses betas that the body lacks
  const auto mesh = detail::body_mesh(body, betas);
  std::vector<ViewerMotion> own;
  for (const ViewerMotion& m : motions) own.push_back({motion_on_body(body, m.motion, betas), m.tracks, m.note});
  return detail::body_viewer_page(own, mesh, skeleton, options);
}
/// Throws io_error 401, and what body_viewer_html throws.
template <Backend B>
void write_body_viewer(const FilePath& path, const Body<B>& body, std::span<const ViewerMotion> motions,
                       std::span<const typename B::scalar> betas = {}, const ViewerOptions& options = {}) {
  write_file(path, body_viewer_html(body, motions, betas, options));
}

MOTIONLANG_NAMESPACE_END
