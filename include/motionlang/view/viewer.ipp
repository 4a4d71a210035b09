// SPDX-License-Identifier: MIT
// Bodies of viewer.hpp.
#pragma once

#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/view/detail/page_parts.hpp>
#include <motionlang/view/detail/viewer_page.hpp>
#include <motionlang/view/viewer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A view of one of the caller's motions.
struct ViewerEntry {
  const Motion& motion;
  std::span<const Track> tracks;
  std::string note;
};

/// Throws config_error 101 without a frame, and what Motion::validate throws.
inline nlohmann::ordered_json shown_motion(const Motion& motion, std::span<const Track> tracks,
                                           const std::string& note) {
  motion.validate();
  if (motion.frames() == 0) raise<config_error>(101, "viewer: motion '", motion.name, "' has no frames");
  require_finite_times("viewer", tracks);
  return viewer_json(motion, tracks, note);
}

/// body  null: the figure of every motion's own skeleton
inline std::string viewer_page(std::span<const ViewerEntry> entries, const ViewerOptions& options,
                               nlohmann::ordered_json body = {}) {
  if (entries.empty()) raise<config_error>(101, "viewer: no motion to show");
  nlohmann::ordered_json motions = nlohmann::ordered_json::array();
  for (const ViewerEntry& e : entries) motions.push_back(shown_motion(e.motion, e.tracks, e.note));
  const std::string& name = entries.front().motion.name;
  const std::string title = !options.title.empty() ? options.title : name.empty() ? "Motion" : name;
  nlohmann::ordered_json page{
      {"title", title}, {"info", options.info}, {"autoplay", options.autoplay}, {"motions", std::move(motions)}};
  if (!body.is_null()) page["body"] = std::move(body);
  return self_contained_page(
      title, concat_text(page_colours, viewer_style),
      concat_text(viewer_header, viewer_stage, "<footer>", viewer_controls, viewer_timeline, "</footer>\n"), page,
      {viewer_script_pose, viewer_script_draw, viewer_script_player, viewer_script_control});
}

inline nlohmann::ordered_json body_json(const SkinnedMesh<std::uint16_t>& mesh, const Skeleton& skeleton) {
  const auto packed = [](const auto& values) { return to_base64(std::as_bytes(std::span(values))); };
  nlohmann::ordered_json offsets = nlohmann::ordered_json::array();
  for (const Vec3<double>& o : skeleton.offsets) offsets.push_back(rounded(o));
  return {{"positions", packed(mesh.positions)}, {"joints", packed(mesh.joints)}, {"weights", packed(mesh.weights)},
          {"triangles", packed(mesh.triangles)}, {"offsets", std::move(offsets)}, {"parents", skeleton.parents}};
}

MOTIONLANG_BODY std::string body_viewer_page(std::span<const ViewerMotion> motions,
                                             const SkinnedMesh<std::uint16_t>& mesh, const Skeleton& skeleton,
                                             const ViewerOptions& options) {
  std::vector<ViewerEntry> entries;
  for (const ViewerMotion& m : motions) entries.push_back({m.motion, m.tracks, m.note});
  return viewer_page(entries, options, body_json(mesh, skeleton));
}

MOTIONLANG_BODY std::string body_viewer_data(const Motion& motion, const SkinnedMesh<std::uint16_t>& mesh,
                                             const Skeleton& skeleton) {
  return json_text(
      nlohmann::ordered_json{{"motion", shown_motion(motion, {}, "")}, {"body", body_json(mesh, skeleton)}});
}

}  // namespace detail

MOTIONLANG_BODY std::string viewer_data(const Motion& motion) {
  return detail::json_text(detail::shown_motion(motion, {}, ""));
}

MOTIONLANG_BODY std::string viewer_html(const Motion& motion, std::span<const Track> tracks,
                                        const ViewerOptions& options) {
  const detail::ViewerEntry entry{motion, tracks, {}};
  return detail::viewer_page(std::span(&entry, 1), options);
}

MOTIONLANG_BODY std::string viewer_html(std::span<const ViewerMotion> motions, const ViewerOptions& options) {
  std::vector<detail::ViewerEntry> entries;
  for (const ViewerMotion& m : motions) entries.push_back({m.motion, m.tracks, m.note});
  return detail::viewer_page(entries, options);
}

MOTIONLANG_BODY void write_viewer(const FilePath& path, const Motion& motion, std::span<const Track> tracks,
                                  const ViewerOptions& options) {
  write_file(path, viewer_html(motion, tracks, options));
}

MOTIONLANG_BODY void write_viewer(const FilePath& path, std::span<const ViewerMotion> motions,
                                  const ViewerOptions& options) {
  write_file(path, viewer_html(motions, options));
}

MOTIONLANG_NAMESPACE_END
