// SPDX-License-Identifier: MIT
// Bodies of film_strip.hpp.
#pragma once

#include <algorithm>  // clamp, max, min, stable_sort
#include <array>      // colours
#include <cmath>      // angles
#include <map>        // cones of a joint
#include <numbers>    // pi
#include <tuple>      // legend

#include <motionlang/file/file.hpp>
#include <motionlang/formats/detail/figure_pose.hpp>
#include <motionlang/geometry/degree.hpp>
#include <motionlang/view/detail/film_strip_drawing.hpp>
#include <motionlang/view/film_strip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Parallel projection of the world, seen slightly from above. Depth grows away from the viewer.
struct ObliqueView {
  Vec3<double> right{1, 0, 0}, away{0, 0, -1};  // on the floor
  double sine = std::sin(elevation), cosine = std::cos(elevation);
  static constexpr double elevation = 14 * degree;

  /// The path of the root goes to the right and a little towards the viewer. Without a noticeable path, the figure
  /// faces the viewer, half turned to the right.
  static ObliqueView of(const Motion& motion) {
    const Vec3<double> way = main_direction(motion);
    const Vec3<double> facing = rotate(motion.rotations(0)[0], Vec3<double>{0, 0, 1});
    return norm(way) > 0 ? turned(way, 28) : turned(facing, 58);
  }

 private:
  /// The view in which a direction on the floor appears at `degrees` towards the viewer from the right.
  static ObliqueView turned(const Vec3<double>& direction, double degrees) {
    const double angle = std::atan2(direction.x, direction.z) - (90 - degrees) * degree;
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

/// The extent of the joints' movement, seen from the root, and of the root's height: metres, a mean over the joints.
inline double way_of_joints(const Motion& motion) {
  const auto positions = motion.positions();
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  double way = 0;
  for (std::size_t i = joints; i < positions.size(); ++i) {
    const Vec3<double> by = motion.root[i / joints] - motion.root[i / joints - 1];
    way += norm(positions[i] - positions[i - joints] - Vec3<double>{by.x, 0, by.z});
  }
  return way / static_cast<double>(joints);
}

/// Lays the picture out and draws it on a surface; the y axis points down.
class FilmStrip {
 public:
  FilmStrip(const Motion& motion, std::span<const Track> tracks, const FilmStripOptions& options)
      : motion_(motion),
        tracks_(tracks),
        options_(options),
        figure_(make_figure(motion.skeleton)),
        view_(ObliqueView::of(motion)),
        last_(static_cast<double>(motion.frames() - 1) / motion.fps) {
    const double wished = options.poses > 0 ? options.poses : std::clamp(1 + way_of_joints(motion) / 0.25, 5.0, 12.0);
    poses_ = static_cast<int>(std::min(std::round(wished), static_cast<double>(motion.frames())));
    cell_ = (options.width - 2 * margin) / poses_;
    measure();
  }

  double height() const {
    return tracks_top() + row * static_cast<double>(tracks_.size()) + (tracks_.empty() ? 0 : 10) + 8;
  }
  std::string title() const { return options_.title.empty() ? motion_.name : options_.title; }

  template <class Surface>
  void draw(Surface& on) const {
    backdrop(on);
    path(on);
    for (int i = 0; i < poses_; ++i) pose(on, i);
    time_labels(on);
    track_rows(on);
  }

 private:
  static constexpr double margin = 24, header = 44, row = 26, bar = 20;
  /// By side (middle, left, right): fill near the viewer and far from them. Distinguishable for colour-blind readers.
  static constexpr std::array<Rgb, 3> near_colour{{{98, 108, 122}, {230, 97, 44}, {38, 118, 186}}};
  static constexpr Rgb far_colour{150, 158, 170};
  static constexpr std::array<Rgb, 6> bar_colour{{{0x2b, 0x6c, 0xb0},
                                                  {0xb4, 0x53, 0x1a},
                                                  {0x2f, 0x7d, 0x4f},
                                                  {0x7a, 0x4a, 0xa8},
                                                  {0xa6, 0x3a, 0x5e},
                                                  {0x7d, 0x6a, 0x12}}};

  double time_of(int i) const { return poses_ > 1 ? last_ * i / (poses_ - 1) : 0; }
  Index frame_of(int i) const { return static_cast<Index>(std::lround(time_of(i) * motion_.fps)); }
  /// The x axis is time: the first pose stands in the middle of the first cell, the last in the middle of the last.
  double x_of(double time) const {
    const double share = last_ > 0 ? std::clamp(time / last_, 0.0, 1.0) : 0;
    return margin + cell_ / 2 + share * (cell_ * (poses_ - 1));
  }
  /// The height of a point on the floor at this depth.
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

  template <class Surface>
  void backdrop(Surface& on) const {
    const double top = floor_y(farthest_) - 34, bottom = labels_ - 18;
    on.text({margin, 28}, title(), TextRole::title, TextAnchor::start);
    on.floor(top, bottom - top);
    for (const auto& [side, name, x] :
         {std::tuple{Side::left, "left", 104.0}, std::tuple{Side::right, "right", 52.0}}) {
      on.disc({options_.width - x, 23}, 5, colour(side, 0));
      on.text({options_.width - x + 9, 27}, name, TextRole::small, TextAnchor::start);
    }
  }

  /// The path of the root over the floor, as its shadow line.
  template <class Surface>
  void path(Surface& on) const {
    std::vector<Point2> points;
    const Index step = std::max<Index>(1, motion_.frames() / 400);
    for (Index frame = 0; frame < motion_.frames(); frame += step) {
      points.push_back({x_of(static_cast<double>(frame) / motion_.fps), floor_y(depth_of_root(frame))});
    }
    on.dotted_line(points);
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
  template <class Surface>
  void pose(Surface& on, int i) const {
    const Index frame = frame_of(i);
    const Vec3<double>& root = motion_.root_at(frame);
    const double x = x_of(time_of(i)), y = floor_y(depth_of_root(frame)), lift = root.y - ground_;
    const double spread = 0.26 * figure_.size * scale_;
    on.begin_pose();
    on.shadow({x, y}, spread, 0.36 * spread, std::clamp(1.6 - lift / (0.7 * figure_.size), 0.25, 1.0));
    JointTransforms<double> world;
    motion_.world(frame, world);
    auto project = [&](const Vec3<double>& p) {
      const Vec3<double> r = p - root;
      return Point2{x + dot(r, view_.right) * scale_,
                    y - ((p.y - ground_) * view_.cosine + dot(r, view_.away) * view_.sine) * scale_};
    };
    for (const Piece& piece : pieces(world, root)) {
      const double shade = std::clamp(piece.distance / (0.35 * figure_.size), 0.0, 1.0);
      std::vector<RoundCone2> shapes;
      for (const RoundCone* c : piece.cones) {
        const auto [from, to] = cone_ends(world, *c);
        shapes.push_back({project(from), c->radius_from * scale_, project(to), c->radius_to * scale_});
      }
      on.piece(shapes, colour(piece.cones.front()->side, shade));
    }
    on.end_pose();
  }

  /// distance   0 near the root or before it, 1 far behind it
  static Rgb colour(Side side, double distance) {
    const Rgb& near = near_colour[static_cast<std::size_t>(side)];
    const auto one = [&](int n, int far) { return static_cast<int>(std::lround(n + 0.55 * distance * (far - n))); };
    return {one(near.r, far_colour.r), one(near.g, far_colour.g), one(near.b, far_colour.b)};
  }

  template <class Surface>
  void time_labels(Surface& on) const {
    for (int i = 0; i < poses_; ++i) {
      const double x = x_of(time_of(i));
      if (!tracks_.empty()) on.guide(x, labels_ + 6, tracks_top() + row * static_cast<double>(tracks_.size()));
      on.text({x, labels_}, fixed(static_cast<double>(frame_of(i)) / motion_.fps, 2) + " s", TextRole::usual,
              TextAnchor::middle);
    }
  }

  double tracks_top() const { return labels_ + (tracks_.empty() ? 4 : 14); }

  /// A bar for every text, with the text in it or, if it is too long, beside it.
  template <class Surface>
  void track_rows(Surface& on) const {
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
      on.bar({x, y}, width, bar, bar_colour[i % bar_colour.size()]);
      on.text({text_x, y + 14.5}, track.text, inside ? TextRole::bar : TextRole::usual,
              inside || after ? TextAnchor::start : TextAnchor::end, parts);
    }
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

inline FilmStrip film_strip(const Motion& motion, std::span<const Track> tracks, const FilmStripOptions& options) {
  motion.validate();
  if (motion.frames() == 0) raise<config_error>(101, "film strip: motion '", motion.name, "' has no frames");
  if (!(options.width >= 100 && options.width <= 1e6)) raise<config_error>(101, "film strip: width ", options.width);
  require_finite_times("film strip", tracks);
  return FilmStrip(motion, tracks, options);
}

}  // namespace detail

MOTIONLANG_BODY std::string film_strip_svg(const Motion& motion, std::span<const Track> tracks,
                                           const FilmStripOptions& options) {
  const detail::FilmStrip strip = detail::film_strip(motion, tracks, options);
  detail::SvgSurface surface(options.width, strip.height(), strip.title());
  strip.draw(surface);
  return surface.finish();
}

MOTIONLANG_BODY Picture film_strip_picture(const Motion& motion, std::span<const Track> tracks,
                                           const FilmStripOptions& options) {
  const detail::FilmStrip strip = detail::film_strip(motion, tracks, options);
  if (!(options.resolution > 0 && options.resolution * options.width <= 20000)) {
    raise<config_error>(101, "film strip: width ", options.width, " at ", options.resolution, " pixels each");
  }
  if (!(options.resolution * strip.height() <= 20000))
    raise<config_error>(101, "film strip: height ", strip.height(), " at ", options.resolution, " pixels each");
  detail::PixelSurface surface(options.width, strip.height(), options.resolution);
  strip.draw(surface);
  return surface.finish();
}

MOTIONLANG_BODY void write_film_strip(const FilePath& path, const Motion& motion, std::span<const Track> tracks,
                                      const FilmStripOptions& options) {
  write_file(path, film_strip_svg(motion, tracks, options));
}

MOTIONLANG_NAMESPACE_END
