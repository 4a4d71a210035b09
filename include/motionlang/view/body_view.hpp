// SPDX-License-Identifier: MIT
/// Motions on a body, in a format chosen by the extension: a GLB file with its skin, a page, or an OBJ file for each
/// frame.
///
///     auto body = read_body<B>("SMPLH_NEUTRAL.npz");
///     write_on_body("walk.glb", body, std::span(&motion, 1));
#pragma once

#include <motionlang/core/option_error.hpp>
#include <motionlang/formats/body_glb.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/view/body_viewer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if write_on_body writes this many motions to a file of this kind: .glb and .html take several, .obj takes one.
inline bool is_body_view(const FilePath& path, std::size_t motions) {
  const std::string kind = file_kind(path);
  return kind == ".glb" || kind == ".html" || (kind == ".obj" && motions == 1);
}

/// motions  as motion_on_body takes them
/// Returns  the number of files written: 1, or one .obj for each frame
/// Throws   option_error 103 for another extension, io_error 401, and what the writers throw
template <Backend B>
Index write_on_body(const FilePath& path, const Body<B>& body, std::span<const Motion> motions,
                    std::span<const typename B::scalar> betas = {}) {
  const std::string kind = file_kind(path);
  if (!is_body_view(path, motions.size()))
    raise<option_error>(103, path.string(),
                        ": motions on a body are written to .glb and .html, one alone also to .obj, not '", kind, "'");
  if (kind == ".obj") return write_body_objs(path, body, motions.front(), betas);
  if (kind == ".glb") {
    write_body_glb(path, body, motions, betas);
    return 1;
  }
  std::vector<ViewerMotion> shown;
  for (const Motion& m : motions) shown.push_back({m});
  write_body_viewer(path, body, std::span<const ViewerMotion>(shown), betas);
  return 1;
}

MOTIONLANG_NAMESPACE_END
