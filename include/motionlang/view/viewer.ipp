// SPDX-License-Identifier: MIT
// Bodies of viewer.hpp.
#pragma once

#include <cmath>    // lround, round
#include <cstddef>  // byte
#include <cstdint>  // packed rotations

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/formats/detail/figure_pose.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/detail/viewer_page.hpp>
#include <motionlang/view/viewer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Root positions as float32, then local rotations x, y, z, w as int16, 32767 for 1: 12 + 8 joints bytes per frame. The
/// error of a rotation is below 1e-4 rad.
inline std::string pack_motion(const Motion& motion) {
  std::vector<std::byte> bytes;
  for (const Vec3<double>& p : motion.root) append_value(bytes, vec_cast<float>(p));
  for (const Quaternion<double>& q : motion.local) {
    const Quaternion<double> u = normalized(q);
    for (const double x : {u.x, u.y, u.z, u.w}) append_value(bytes, static_cast<std::int16_t>(std::lround(32767 * x)));
  }
  return to_base64(bytes);
}

/// Rounds lengths to the hundredth of a millimetre, which gives short text.
inline double rounded(double x) { return std::round(x * 1e5) / 1e5; }
inline nlohmann::ordered_json rounded(const Vec3<double>& v) {
  return nlohmann::ordered_json::array({rounded(v.x), rounded(v.y), rounded(v.z)});
}

inline nlohmann::ordered_json viewer_json(const Motion& motion, std::span<const Track> tracks,
                                          const std::string& note) {
  using json = nlohmann::ordered_json;
  const Figure figure = make_figure(motion.skeleton);
  json offsets = json::array(), cones = json::array(), rows = json::array();
  for (const Vec3<double>& o : motion.skeleton.offsets) offsets.push_back(rounded(o));
  for (const RoundCone& c : figure.cones) {
    json cone = json::array({c.joint});
    for (const Vec3<double>& p : {c.from, c.to}) {
      for (const double x : {p.x, p.y, p.z}) cone.push_back(rounded(x));
    }
    cone.push_back(rounded(c.radius_from));
    cone.push_back(rounded(c.radius_to));
    cone.push_back(static_cast<int>(c.side));
    cones.push_back(std::move(cone));
  }
  for (const Track& t : tracks) {
    rows.push_back({{"text", t.text}, {"start", t.start}, {"end", t.end}, {"parts", t.parts}});
  }
  return {{"name", motion.name},
          {"note", note},
          {"fps", motion.fps},
          {"frames", motion.frames()},
          {"floor", rounded(heights(motion, figure).floor)},
          {"size", rounded(figure.size)},
          {"parents", motion.skeleton.parents},
          {"offsets", std::move(offsets)},
          {"cones", std::move(cones)},
          {"tracks", std::move(rows)},
          {"data", pack_motion(motion)}};
}

/// A view of one of the caller's motions.
struct ViewerEntry {
  const Motion& motion;
  std::span<const Track> tracks;
  std::string note;
};

/// body  null: the figure of every motion's own skeleton
inline std::string viewer_page(std::span<const ViewerEntry> entries, const ViewerOptions& options,
                               nlohmann::ordered_json body = {}) {
  if (entries.empty()) raise<config_error>(101, "viewer: no motion to show");
  nlohmann::ordered_json motions = nlohmann::ordered_json::array();
  for (const ViewerEntry& e : entries) {
    e.motion.validate();
    if (e.motion.frames() == 0) raise<config_error>(101, "viewer: motion '", e.motion.name, "' has no frames");
    require_finite_times("viewer", e.tracks);
    motions.push_back(viewer_json(e.motion, e.tracks, e.note));
  }
  const std::string& name = entries.front().motion.name;
  const std::string title = !options.title.empty() ? options.title : name.empty() ? "Motion" : name;
  nlohmann::ordered_json page{
      {"title", title}, {"info", options.info}, {"autoplay", options.autoplay}, {"motions", std::move(motions)}};
  if (!body.is_null()) page["body"] = std::move(body);
  std::string data;
  for (const char c : page.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) {
    data += c == '<' ? "\\u003c" : std::string(1, c);  // no tag can end the script; '<' only stands in texts
  }
  return concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'\">\n<title>",
      escape_markup(title), "</title>\n<style>", viewer_style, "</style>\n</head>\n<body>", viewer_body,
      "<script type=\"application/json\" id=\"data\">", data, "</script>\n<script>", viewer_script_pose,
      viewer_script_draw, viewer_script_control, "</script>\n</body>\n</html>\n");
}

MOTIONLANG_BODY std::string body_viewer_page(std::span<const ViewerMotion> motions,
                                             const SkinnedMesh<std::uint16_t>& mesh, const Skeleton& skeleton,
                                             const ViewerOptions& options) {
  const auto packed = [](const auto& values) { return to_base64(std::as_bytes(std::span(values))); };
  nlohmann::ordered_json offsets = nlohmann::ordered_json::array();
  for (const Vec3<double>& o : skeleton.offsets) offsets.push_back(rounded(o));
  const nlohmann::ordered_json json{{"positions", packed(mesh.positions)}, {"joints", packed(mesh.joints)},
                                    {"weights", packed(mesh.weights)},     {"triangles", packed(mesh.triangles)},
                                    {"offsets", std::move(offsets)},       {"parents", skeleton.parents}};
  std::vector<ViewerEntry> entries;
  for (const ViewerMotion& m : motions) entries.push_back({m.motion, m.tracks, m.note});
  return viewer_page(entries, options, json);
}

}  // namespace detail

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
