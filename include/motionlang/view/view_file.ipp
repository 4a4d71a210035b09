// SPDX-License-Identifier: MIT
// Bodies of view_file.hpp.
#pragma once

#include <algorithm>  // all_of

#include <motionlang/core/option_error.hpp>
#include <motionlang/file/png.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/view_file.hpp>
#include <motionlang/view/viewer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool is_view(const FilePath& path) {
  const std::string kind = file_kind(path);
  return kind == ".html" || kind == ".svg" || kind == ".png";
}

namespace detail {

inline std::string view_text(const std::string& kind, const Motion& motion) {
  if (kind == ".html") return viewer_html(motion);
  if (kind == ".svg") return film_strip_svg(motion);
  return encode_png(film_strip_picture(motion));
}

}  // namespace detail

MOTIONLANG_BODY void write_view(const FilePath& path, const Motion& motion) {
  const std::string kind = file_kind(path);
  if (!is_view(path))
    raise<config_error>(103, path.string(), ": pages and pictures are written to .html, .svg and .png, not '", kind,
                        "'");
  write_file(path, detail::view_text(kind, motion));
}

MOTIONLANG_BODY std::vector<std::byte> motion_or_view_bytes(const FilePath& kind, const Motion& motion,
                                                            const MotionWriteOptions& options) {
  const std::string wanted = detail::wanted_kind(kind);
  if (is_view("view" + wanted)) {
    const std::string text = detail::view_text(wanted, motion);
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
  }
  if (is_written_motion("motion" + wanted)) return motion_bytes(kind, motion, options);
  raise<option_error>(103, kind.string(),
                      ": motions are written to .bvh, .glb, .vrma, .npz, .npy, .html, .svg and .png, not '", wanted,
                      "'", wanted == ".obj" ? ": .obj shows a body, `body` says which" : detail::about_fbx(wanted));
}

MOTIONLANG_BODY void write_motion_or_view(const FilePath& path, const Motion& motion,
                                          const MotionWriteOptions& options) {
  write_file(path, motion_or_view_bytes(path, motion, options));
}

MOTIONLANG_BODY bool holds_several(const FilePath& path) {
  const std::string kind = file_kind(path);
  return kind == ".glb" || kind == ".html";
}

MOTIONLANG_BODY bool holds_together(const FilePath& path, std::span<const Motion> motions) {
  const auto alike = [&](const Motion& m) { return m.skeleton == motions.front().skeleton; };
  return holds_several(path) && (file_kind(path) != ".glb" || std::all_of(motions.begin(), motions.end(), alike));
}

MOTIONLANG_BODY void write_motions(const FilePath& path, std::span<const Motion> motions) {
  const std::string kind = file_kind(path);
  if (!holds_several(path))
    raise<config_error>(103, path.string(), ": several motions are written to .glb and .html, not '", kind, "'");
  if (kind == ".glb") return write_glb(path, motions);
  std::vector<ViewerMotion> shown;
  for (const Motion& m : motions) shown.push_back({m});
  write_viewer(path, shown);
}

MOTIONLANG_NAMESPACE_END
