// SPDX-License-Identifier: MIT
/// The user's body in motion, as a GLB file with its skin or as one OBJ file for each frame.
///
///     write_body_glb("walk.glb", body, std::span(&motion, 1));  // moves in every viewer; without pose blend shapes
///     write_body_objs("walk.obj", body, motion);                // walk_0000.obj, ...: exactly the model's vertices
///
/// A vertex in a GLB file follows at most four joints: those with the largest weights. SMPL has no more.
#pragma once

#include <algorithm>  // min

#include <motionlang/formats/detail/body_mesh.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/formats/obj.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// motions  as motion_on_body takes them
/// Throws   what glb_bytes and motion_on_body throw; config_error 101 for a body without faces
template <Backend B>
std::vector<std::byte> body_glb_bytes(const Body<B>& body, std::span<const Motion> motions,
                                      std::span<const typename B::scalar> betas = {},
                                      const GlbWriteOptions& options = {}) {
  if (body.faces.empty()) raise<config_error>(101, "GLB: the body has no faces");
  std::vector<Motion> own;
  for (const Motion& m : motions) own.push_back(motion_on_body(body, m, betas));
  detail::require_glb_motions(own);
  return detail::skinned_glb(own, detail::body_mesh(body, betas), "body", options);
}
/// Throws io_error 401, and what body_glb_bytes throws.
template <Backend B>
void write_body_glb(const FilePath& path, const Body<B>& body, std::span<const Motion> motions,
                    std::span<const typename B::scalar> betas = {}, const GlbWriteOptions& options = {}) {
  write_file(path, body_glb_bytes(body, motions, betas, options));
}

/// One file for each frame: "walk.obj" becomes walk_0000.obj, walk_0001.obj, ... Returns their number. Throws io_error
/// 401, and what motion_on_body, pose_body and obj_text throw.
template <Backend B>
Index write_body_objs(const FilePath& path, const Body<B>& body, const Motion& motion,
                      std::span<const typename B::scalar> betas = {}) {
  const std::string& name = path.string();
  const std::string stem = name.ends_with(".obj") ? name.substr(0, name.size() - 4) : name;
  const Motion own = motion_on_body(body, motion, betas);
  const std::span<const std::array<Index, 3>> faces(body.faces);
  constexpr Index at_once = 32;
  for (Index first = 0; first < own.frames(); first += at_once) {
    const Index end = std::min(own.frames(), first + at_once);
    Motion part{own.skeleton, own.fps, {}, {}, own.name};
    part.root.assign(own.root.begin() + first, own.root.begin() + end);
    part.local.assign(own.local.begin() + first * own.skeleton.size(), own.local.begin() + end * own.skeleton.size());
    const PosedBody<B> posed = pose_body(body.model, part, betas);
    const auto width = static_cast<std::size_t>(3 * body.model.vertices());
    for (Index f = first; f < end; ++f) {
      std::string number = std::to_string(f);
      if (number.size() < 4) number.insert(0, 4 - number.size(), '0');
      write_obj(stem + "_" + number + ".obj",
                std::span<const typename B::scalar>(posed.vertices.span())
                    .subspan(static_cast<std::size_t>(f - first) * width, width),
                faces);
    }
  }
  return own.frames();
}

MOTIONLANG_NAMESPACE_END
