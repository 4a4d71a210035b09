// SPDX-License-Identifier: MIT
/// Pieces of self-contained pages that play motions: the motions as JSON, and the page around data and program. The
/// bodies of the pages include it.
#pragma once

#include <cmath>             // lround, round
#include <cstddef>           // byte
#include <cstdint>           // packed rotations
#include <initializer_list>  // scripts
#include <span>              // tracks
#include <string>            // pages
#include <string_view>       // scripts

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/formats/detail/figure_pose.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Root positions as float32, then local rotations x, y, z, w as int16, 32767 for 1: 12 + 8 joints bytes per frame. The
/// error of a rotation is below 1e-4 rad. Of the two quaternions of a rotation it is that with w >= 0.
inline std::string pack_motion(const Motion& motion) {
  std::vector<std::byte> bytes;
  for (const Vec3<double>& p : motion.root) append_value(bytes, vec_cast<float>(p));
  for (const Quaternion<double>& q : motion.local) {
    const Quaternion<double> u = normalized(q);
    const double one = u.w < 0 ? -32767 : 32767;
    for (const double x : {u.x, u.y, u.z, u.w}) append_value(bytes, static_cast<std::int16_t>(std::lround(one * x)));
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

/// Motions that share their figures, as { "figures": [...], "motions": [...] }. The member "figure" of a motion is the
/// number of its figure.
class SharedMotions {
 public:
  /// Throws config_error 101 without a frame, and what Motion::validate and the figure throw. `what` begins messages.
  void add(const char* what, const Motion& motion, std::span<const Track> tracks, const std::string& note) {
    motion.validate();
    if (motion.frames() == 0) raise<config_error>(101, what, ": motion '", motion.name, "' has no frames");
    require_finite_times(what, tracks);
    nlohmann::ordered_json one = viewer_json(motion, tracks, note), figure;
    for (const char* member : {"size", "parents", "offsets", "cones"}) {
      figure[member] = std::move(one[member]);
      one.erase(member);
    }
    std::size_t number = 0;
    while (number < figures_.size() && figures_[number] != figure) ++number;
    if (number == figures_.size()) figures_.push_back(std::move(figure));
    one["figure"] = number;
    motions_.push_back(std::move(one));
  }
  void put_into(nlohmann::ordered_json& page) && {
    page["figures"] = std::move(figures_);
    page["motions"] = std::move(motions_);
  }

 private:
  nlohmann::ordered_json figures_ = nlohmann::ordered_json::array(), motions_ = nlohmann::ordered_json::array();
};

/// A page that loads nothing. Its program finds the data, as JSON, in the element "data".
/// allowed  sources of scripts besides those in the page, and further rules of its security policy
inline std::string self_contained_page(std::string_view title, std::string_view style, std::string_view body,
                                       const nlohmann::ordered_json& page,
                                       std::initializer_list<std::string_view> scripts, std::string_view allowed = "") {
  std::string data, program;
  for (const char c : json_text(page)) {
    data += c == '<' ? "\\u003c" : std::string(1, c);  // no tag can end the script; '<' only stands in texts
  }
  for (const std::string_view script : scripts) program += script;
  return concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'",
      allowed, "\">\n<title>", escape_markup(title), "</title>\n<style>", style, "</style>\n</head>\n<body>", body,
      "<script type=\"application/json\" id=\"data\">", data, "</script>\n<script>", program,
      "</script>\n</body>\n</html>\n");
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
