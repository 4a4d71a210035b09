// SPDX-License-Identifier: MIT
/// A motion as one picture: poses from left to right in time, their shadows along the path of the root, and the texts
/// of a timeline below. An SVG file without anything from outside.
#pragma once

#include <array>    // colours
#include <cmath>    // angles
#include <map>      // cones of a joint
#include <numbers>  // pi
#include <tuple>    // legend

#include <motionlang/io/detail/figure_pose.hpp>
#include <motionlang/io/detail/markup.hpp>
#include <motionlang/io/file.hpp>
#include <motionlang/io/track.hpp>
#include <motionlang/kinematics/motion.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

struct FilmStripOptions {
  int poses = 0;        // 0: as many as fit, from 5 to 12
  double width = 1280;  // pixels; the height follows
  std::string title{};  // "": the name of the motion
};

namespace detail {

struct Point2 {
  double x = 0, y = 0;
};

/// Parallel projection of the world, seen slightly from above. Depth grows away from the viewer.
struct ObliqueView {
  Vec3<double> right{1, 0, 0}, away{0, 0, -1};  // on the floor
  double sine = std::sin(elevation), cosine = std::cos(elevation);
  static constexpr double elevation = 14 * std::numbers::pi / 180;

  /// The way of the root goes to the right and a little towards the viewer. Without a way worth the name, the figure
  /// faces the viewer, half turned to the right.
  static ObliqueView of(const Motion& motion) {
    const Vec3<double> way = main_direction(motion);
    const Vec3<double> facing = rotate(motion.rotations(0)[0], Vec3<double>{0, 0, 1});
    return norm(way) > 0 ? turned(way, 28) : turned(facing, 58);
  }

 private:
  /// The view in which a direction on the floor appears at `degrees` towards the viewer from the right.
  static ObliqueView turned(const Vec3<double>& direction, double degrees) {
    const double angle = std::atan2(direction.x, direction.z) - (90 - degrees) * std::numbers::pi / 180;
    const Vec3<double> towards{std::sin(angle), 0, std::cos(angle)};
    ObliqueView view;
    view.away = -towards;
    view.right = {towards.z, 0, -towards.x};
    return view;
  }
  /// From the mean of the first third of the root's path to the mean of the last third; 0 if below 0.4 m.
  static Vec3<double> main_direction(const Motion& motion) {
    const Index third = std::max<Index>(1, motion.frames() / 3);
    Vec3<double> way{};
    for (Index i = 0; i < third; ++i) way = way + motion.root_at(motion.frames() - 1 - i) - motion.root_at(i);
    way = (1.0 / static_cast<double>(third)) * Vec3<double>{way.x, 0, way.z};
    return norm(way) < 0.4 ? Vec3<double>{} : way;
  }
};

/// Builds the picture; the y axis of SVG points down.
class FilmStrip {
 public:
  FilmStrip(const Motion& motion, std::span<const Track> tracks, const FilmStripOptions& options)
      : motion_(motion),
        tracks_(tracks),
        options_(options),
        figure_(make_figure(motion.skeleton)),
        view_(ObliqueView::of(motion)),
        last_(static_cast<double>(motion.frames() - 1) / motion.fps) {
    const double wished = options.poses > 0 ? options.poses : std::clamp(1.5 * last_ + 1, 5.0, 12.0);
    poses_ = static_cast<int>(std::min(std::round(wished), static_cast<double>(motion.frames())));
    cell_ = (options.width - 2 * margin) / poses_;
    measure();
  }

  std::string svg() {
    std::string body = backdrop() + path();
    for (int i = 0; i < poses_; ++i) body += pose(i);
    body += time_labels() + track_rows();
    const double height = tracks_top() + row * static_cast<double>(tracks_.size()) + (tracks_.empty() ? 0 : 10) + 8;
    const std::string size = concat_text(fixed(options_.width), " ", fixed(height));
    return concat_text("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", size, "\" width=\"",
                       fixed(options_.width), "\" height=\"", fixed(height), "\" role=\"img\">\n<title>",
                       escape_markup(title()), "</title>\n", style,
                       "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n", body, "</svg>\n");
  }

 private:
  static constexpr double margin = 24, header = 44, row = 26, bar = 20;
  static constexpr std::string_view style =
      "<style>text{font:12px system-ui,-apple-system,'Segoe UI',sans-serif;fill:#4a5260}"
      ".title{font-size:15px;font-weight:600;fill:#20242c}.bar{fill:#fff;font-weight:500}.small{font-size:11px}</"
      "style>\n"
      "<defs><radialGradient id=\"shadow\"><stop offset=\"0\" stop-color=\"#20242c\" stop-opacity=\".34\"/>"
      "<stop offset=\".55\" stop-color=\"#20242c\" stop-opacity=\".16\"/><stop offset=\"1\" stop-color=\"#20242c\" "
      "stop-opacity=\"0\"/></radialGradient><linearGradient id=\"floor\" x2=\"0\" y2=\"1\"><stop offset=\"0\" "
      "stop-color=\"#eef1f5\" stop-opacity=\"0\"/><stop offset=\"1\" "
      "stop-color=\"#e9edf2\"/></linearGradient></defs>\n";
  /// By side (middle, left, right): fill near the viewer and far from them. Distinguishable for colour-blind readers.
  static constexpr std::array<std::array<int, 3>, 3> near_colour{{{98, 108, 122}, {230, 97, 44}, {38, 118, 186}}};
  static constexpr std::array<int, 3> far_colour{150, 158, 170};
  static constexpr std::array<std::string_view, 6> bar_colour{"#2b6cb0", "#b4531a", "#2f7d4f",
                                                              "#7a4aa8", "#a63a5e", "#7d6a12"};

  std::string title() const { return options_.title.empty() ? motion_.name : options_.title; }
  double time_of(int i) const { return poses_ > 1 ? last_ * i / (poses_ - 1) : 0; }
  Index frame_of(int i) const { return static_cast<Index>(std::lround(time_of(i) * motion_.fps)); }
  /// The x axis is time: the first pose stands in the middle of the first cell, the last in the middle of the last.
  double x_of(double time) const {
    const double share = last_ > 0 ? std::clamp(time / last_, 0.0, 1.0) : 0;
    return margin + cell_ / 2 + share * (cell_ * (poses_ - 1));
  }
  /// Of a point on the floor at this depth.
  double floor_y(double depth) const { return floor_ - (depth - nearest_) * view_.sine * depth_scale_; }
  double depth_of_root(Index frame) const { return dot(motion_.root_at(frame), view_.away); }

  /// Chooses the scale so that figures fit into their cells, and the places of the floor and of everything below it.
  void measure() {
    const auto [floor, high] = heights(motion_, figure_);
    ground_ = floor;
    nearest_ = farthest_ = depth_of_root(0);
    for (Index frame = 1; frame < motion_.frames(); ++frame) {
      nearest_ = std::min(nearest_, depth_of_root(frame));
      farthest_ = std::max(farthest_, depth_of_root(frame));
    }
    double half_width = 0.2 * figure_.size;
    JointTransforms<double> world;
    for (int i = 0; i < poses_; ++i) {
      motion_.world(frame_of(i), world);
      for (const RoundCone& c : figure_.cones) {
        const auto [from, to] = cone_ends(world, c);
        for (const auto& [p, r] : {std::pair{from, c.radius_from}, std::pair{to, c.radius_to}}) {
          half_width = std::max(half_width, std::abs(dot(p - motion_.root_at(frame_of(i)), view_.right)) + r);
        }
      }
    }
    const double tallest_figure = 300 / figure_.size, tallest_picture = 420 / (high - floor);
    scale_ = std::min({1.25 * cell_ / (2 * half_width), tallest_figure, tallest_picture});
    const double depth = farthest_ - nearest_, tallest = 0.45 * figure_.size;  // of the floor in the picture
    depth_scale_ = depth * view_.sine > tallest ? scale_ * tallest / (depth * view_.sine) : scale_;
    const double rise = depth * view_.sine * depth_scale_;
    floor_ = header + (high - floor) * view_.cosine * scale_ + rise + 0.08 * figure_.size * scale_;
    labels_ = floor_ + 0.16 * figure_.size * scale_ + 14;
  }

  std::string backdrop() const {
    const double top = floor_y(farthest_) - 34, bottom = labels_ - 18;
    std::string out =
        concat_text("<text class=\"title\" x=\"", fixed(margin), "\" y=\"28\">", escape_markup(title()), "</text>\n");
    out += concat_text("<rect x=\"0\" y=\"", fixed(top), "\" width=\"100%\" height=\"", fixed(bottom - top),
                       "\" fill=\"url(#floor)\"/>\n");
    for (const auto& [side, name, x] :
         {std::tuple{Side::left, "left", 104.0}, std::tuple{Side::right, "right", 52.0}}) {
      out += concat_text("<circle cx=\"", fixed(options_.width - x), "\" cy=\"23\" r=\"5\" fill=\"", colour(side, 0),
                         "\"/><text class=\"small\" x=\"", fixed(options_.width - x + 9), "\" y=\"27\">", name,
                         "</text>\n");
    }
    return out;
  }

  /// Where the root goes over the floor; its shadow line.
  std::string path() const {
    std::string d;
    const Index step = std::max<Index>(1, motion_.frames() / 400);
    for (Index frame = 0; frame < motion_.frames(); frame += step) {
      const double t = static_cast<double>(frame) / motion_.fps;
      d += concat_text(frame == 0 ? "M" : "L", fixed(x_of(t)), " ", fixed(floor_y(depth_of_root(frame))));
    }
    return concat_text("<path d=\"", d,
                       "\" fill=\"none\" stroke=\"#9aa3b0\" stroke-width=\"1.5\" stroke-dasharray=\"1 5\" ",
                       "stroke-linecap=\"round\"/>\n");
  }

  /// Cones that are drawn as one shape: the trunk with the head, or all of one joint.
  struct Piece {
    std::vector<const RoundCone*> cones;
    double depth = 0;     // along the line of sight, mean over the cones
    double distance = 0;  // behind the root, on the floor
  };
  /// From far to near.
  std::vector<Piece> pieces(const JointTransforms<double>& world, const Vec3<double>& root) const {
    std::map<int, Piece> by_joint;
    for (const RoundCone& c : figure_.cones) by_joint[c.side == Side::middle ? -1 : c.joint].cones.push_back(&c);
    std::vector<Piece> out;
    for (auto& [joint, piece] : by_joint) {
      const double share = 1.0 / static_cast<double>(piece.cones.size());
      for (const RoundCone* c : piece.cones) {
        const auto [from, to] = cone_ends(world, *c);
        const Vec3<double> r = 0.5 * (from + to) - root;
        piece.depth += share * (dot(r, view_.away) * view_.cosine - r.y * view_.sine);
        piece.distance += share * dot(r, view_.away);
      }
      out.push_back(std::move(piece));
    }
    std::stable_sort(out.begin(), out.end(), [](const Piece& a, const Piece& b) { return a.depth > b.depth; });
    return out;
  }

  /// One figure with its shadow; limbs far from the viewer first.
  std::string pose(int i) const {
    const Index frame = frame_of(i);
    const Vec3<double>& root = motion_.root_at(frame);
    const double x = x_of(time_of(i)), y = floor_y(depth_of_root(frame)), lift = root.y - ground_;
    const double spread = 0.26 * figure_.size * scale_;
    std::string out =
        concat_text("<g class=\"pose\">\n<ellipse cx=\"", fixed(x), "\" cy=\"", fixed(y), "\" rx=\"", fixed(spread),
                    "\" ry=\"", fixed(0.36 * spread), "\" fill=\"url(#shadow)\" opacity=\"",
                    fixed(std::clamp(1.6 - lift / (0.7 * figure_.size), 0.25, 1.0), 2), "\"/>\n");
    JointTransforms<double> world;
    motion_.world(frame, world);
    auto project = [&](const Vec3<double>& p) {
      const Vec3<double> r = p - root;
      return Point2{x + dot(r, view_.right) * scale_,
                    y - ((p.y - ground_) * view_.cosine + dot(r, view_.away) * view_.sine) * scale_};
    };
    for (const Piece& piece : pieces(world, root)) {
      const double shade = std::clamp(piece.distance / (0.35 * figure_.size), 0.0, 1.0);
      std::string shapes;
      for (const RoundCone* c : piece.cones) {
        const auto [from, to] = cone_ends(world, *c);
        shapes += outline(project(from), c->radius_from * scale_, project(to), c->radius_to * scale_);
      }
      const std::string fill = colour(piece.cones.front()->side, shade);
      out += concat_text("<path d=\"", shapes, "\" stroke=\"#fff\" stroke-width=\"1.8\"/><path d=\"", shapes,
                         "\" fill=\"", fill, "\"/>\n");
    }
    return out + "</g>\n";
  }

  /// The hull of two circles: two arcs and the tangents between them.
  static std::string outline(Point2 a, double ra, Point2 b, double rb) {
    const double dx = b.x - a.x, dy = b.y - a.y, distance = std::hypot(dx, dy);
    auto arc = [](double r, bool large, Point2 to) {
      return concat_text("A", fixed(r), " ", fixed(r), " 0 ", large ? 1 : 0, " 1 ", fixed(to.x), " ", fixed(to.y));
    };
    if (distance <= std::abs(ra - rb) + 1e-9) {  // one circle holds the other
      const double r = std::max(ra, rb);
      const Point2 c = ra > rb ? a : b;
      return concat_text("M", fixed(c.x - r), " ", fixed(c.y), arc(r, false, {c.x + r, c.y}),
                         arc(r, false, {c.x - r, c.y}), "Z");
    }
    const double axis = std::atan2(dy, dx), tangent = std::acos((ra - rb) / distance);
    auto on = [&](Point2 c, double r, double angle) {
      return Point2{c.x + r * std::cos(angle), c.y + r * std::sin(angle)};
    };
    const Point2 a1 = on(a, ra, axis + tangent), a2 = on(a, ra, axis - tangent);
    const Point2 b1 = on(b, rb, axis + tangent), b2 = on(b, rb, axis - tangent);
    const bool a_large = tangent < std::numbers::pi / 2;
    return concat_text("M", fixed(a1.x), " ", fixed(a1.y), arc(ra, a_large, a2), "L", fixed(b2.x), " ", fixed(b2.y),
                       arc(rb, !a_large, b1), "Z");
  }

  /// distance   0 near the root or before it, 1 far behind it
  static std::string colour(Side side, double distance) {
    std::string out = "#";
    for (std::size_t k = 0; k < 3; ++k) {
      const int near = near_colour[static_cast<std::size_t>(side)][k];
      const int c = static_cast<int>(std::lround(near + 0.55 * distance * (far_colour[k] - near)));
      constexpr std::string_view hex = "0123456789abcdef";
      out += hex[static_cast<std::size_t>(c / 16)];
      out += hex[static_cast<std::size_t>(c % 16)];
    }
    return out;
  }

  std::string time_labels() const {
    std::string out;
    for (int i = 0; i < poses_; ++i) {
      const double x = x_of(time_of(i));
      if (!tracks_.empty()) {
        out += concat_text("<path d=\"M", fixed(x), " ", fixed(labels_ + 6), "V",
                           fixed(tracks_top() + row * static_cast<double>(tracks_.size())),
                           "\" stroke=\"#d5dae1\" stroke-width=\"1\"/>\n");
      }
      out += concat_text("<text text-anchor=\"middle\" x=\"", fixed(x), "\" y=\"", fixed(labels_), "\">",
                         fixed(static_cast<double>(frame_of(i)) / motion_.fps, 2), " s</text>\n");
    }
    return out;
  }

  double tracks_top() const { return labels_ + (tracks_.empty() ? 4 : 14); }

  /// A bar for every text, with the text in it or, if it is too long, beside it.
  std::string track_rows() const {
    std::string out;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      const Track& track = tracks_[i];
      const double x = x_of(track.start), width = std::max(3.0, x_of(track.end) - x);
      const double y = tracks_top() + row * static_cast<double>(i) + (row - bar) / 2;
      std::string parts;
      for (const std::string& p : track.parts) parts += (parts.empty() ? " \u00B7 " : ", ") + p;
      const double letters = 6.6 * static_cast<double>(track.text.size() + parts.size());
      const bool inside = letters + 16 < width;
      const bool after = !inside && x + width + letters + 12 < options_.width;
      const double text_x = inside ? x + 8 : after ? x + width + 6 : x - 6;
      out += concat_text("<rect x=\"", fixed(x), "\" y=\"", fixed(y), "\" width=\"", fixed(width), "\" height=\"",
                         fixed(bar), "\" rx=\"5\" fill=\"", bar_colour[i % bar_colour.size()], "\"/>\n<text x=\"",
                         fixed(text_x), "\" y=\"", fixed(y + 14.5), "\"", inside ? " class=\"bar\"" : "",
                         inside || after ? "" : " text-anchor=\"end\"", ">", escape_markup(track.text),
                         "<tspan opacity=\".75\">", escape_markup(parts), "</tspan></text>\n");
    }
    return out;
  }

  const Motion& motion_;
  std::span<const Track> tracks_;
  const FilmStripOptions& options_;
  Figure figure_;
  ObliqueView view_;
  double last_;  // time of the last frame
  int poses_ = 1;
  double cell_ = 0, scale_ = 1, depth_scale_ = 1;  // pixels per cell, per metre, per metre of depth of the floor
  double ground_ = 0;                              // height of the floor
  double nearest_ = 0, farthest_ = 0;              // depth of the root
  double floor_ = 0, labels_ = 0;                  // y of the nearest root's floor, of the time labels
};

}  // namespace detail

/// The picture as SVG text.
/// tracks   shown below the poses, one row each; times in seconds from the start of the motion
/// Throws   shape_error 205, numeric_error 301 if the motion is not valid; config_error 101 without any frame, or for a
///          width below 100
inline std::string film_strip_svg(const Motion& motion, std::span<const Track> tracks = {},
                                  const FilmStripOptions& options = {}) {
  motion.validate();
  if (motion.frames() == 0) raise<config_error>(101, "film strip: motion '", motion.name, "' has no frames");
  if (!(options.width >= 100)) raise<config_error>(101, "film strip: width ", options.width);
  return detail::FilmStrip(motion, tracks, options).svg();
}

/// Throws io_error 401, and what film_strip_svg throws.
inline void write_film_strip(const FilePath& path, const Motion& motion,
                             std::span<const Track> tracks = {}, const FilmStripOptions& options = {}) {
  write_file(path, film_strip_svg(motion, tracks, options));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
