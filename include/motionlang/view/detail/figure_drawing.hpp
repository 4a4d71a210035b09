// SPDX-License-Identifier: MIT
/// Draws the figure of a motion in one pose, with its shadow, on a surface of film_strip_drawing.hpp.
#pragma once

#include <algorithm>   // clamp, stable_sort
#include <array>       // colours
#include <cmath>       // angles
#include <functional>  // colours of pieces
#include <map>         // cones of a joint
#include <numbers>     // pi
#include <utility>     // move
#include <vector>      // pieces

#include <motionlang/formats/detail/figure_pose.hpp>
#include <motionlang/geometry/degree.hpp>
#include <motionlang/view/detail/film_strip_drawing.hpp>

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

/// Colours of texts: dark enough for white letters, and distinguishable for colour-blind readers.
inline constexpr std::array<Rgb, 6> text_colours{{{0x2b, 0x6c, 0xb0},
                                                  {0xb4, 0x53, 0x1a},
                                                  {0x2f, 0x7d, 0x4f},
                                                  {0x7a, 0x4a, 0xa8},
                                                  {0xa6, 0x3a, 0x5e},
                                                  {0x7d, 0x6a, 0x12}}};
/// Colours of the sides of a body (middle, left, right) near the viewer.
inline constexpr std::array<Rgb, 3> side_colours{{{98, 108, 122}, {230, 97, 44}, {38, 118, 186}}};

/// The figure of a motion. The y axis of the picture points down.
class FigureDrawing {
 public:
  /// The colour of a joint's cones in a frame. Cones of different colours are drawn as different pieces.
  using Paint = std::function<Rgb(int joint, Index frame)>;

  /// paint   none: left, right and middle have their colours, and the trunk is one piece
  explicit FigureDrawing(const Motion& motion, Paint paint = {})
      : motion_(motion),
        figure_(make_figure(motion.skeleton)),
        view_(ObliqueView::of(motion)),
        paint_(std::move(paint)) {
    const Heights h = heights(motion, figure_);
    ground_ = h.floor, high_ = h.high;
  }

  const ObliqueView& view() const { return view_; }
  double size() const { return figure_.size; }
  double ground() const { return ground_; }
  /// The height of the highest point of all frames above the floor.
  double reach() const { return high_ - ground_; }
  double depth_of_root(Index frame) const { return dot(motion_.root_at(frame), view_.away); }

  /// The largest distance of the body from its root to the left or right in a frame, metres.
  double half_width(Index frame) const {
    JointTransforms<double> world;
    motion_.world(frame, world);
    double out = 0;
    for (const RoundCone& c : figure_.cones) {
      const auto [from, to] = cone_ends(world, c);
      for (const auto& [p, r] : {std::pair{from, c.radius_from}, std::pair{to, c.radius_to}})
        out = std::max(out, std::abs(dot(p - motion_.root_at(frame), view_.right)) + r);
    }
    return out;
  }

  /// One figure with its shadow, limbs far from the viewer first.
  /// foot    the point of the floor below the root, in the picture
  /// scale   pixels per metre
  template <class Surface>
  void pose(Surface& on, Index frame, Point2 foot, double scale) const {
    const Vec3<double>& root = motion_.root_at(frame);
    const double lift = root.y - ground_, spread = 0.26 * figure_.size * scale;
    on.begin_pose();
    on.shadow(foot, spread, 0.36 * spread, std::clamp(1.6 - lift / (0.7 * figure_.size), 0.25, 1.0));
    JointTransforms<double> world;
    motion_.world(frame, world);
    auto project = [&](const Vec3<double>& p) {
      const Vec3<double> r = p - root;
      return Point2{foot.x + dot(r, view_.right) * scale,
                    foot.y - ((p.y - ground_) * view_.cosine + dot(r, view_.away) * view_.sine) * scale};
    };
    for (const Piece& piece : pieces(frame, world, root)) {
      const double shade = std::clamp(piece.distance / (0.35 * figure_.size), 0.0, 1.0);
      std::vector<RoundCone2> shapes;
      for (const RoundCone* c : piece.cones) {
        const auto [from, to] = cone_ends(world, *c);
        shapes.push_back({project(from), c->radius_from * scale, project(to), c->radius_to * scale});
      }
      on.piece(shapes, shaded(piece.colour, shade));
    }
    on.end_pose();
  }

 private:
  static constexpr Rgb far_colour{150, 158, 170};

  /// Cones that are drawn as one shape: the trunk with the head, or all of one joint.
  struct Piece {
    std::vector<const RoundCone*> cones;
    Rgb colour{};
    double depth = 0;     // along the line of sight, mean over the cones
    double distance = 0;  // behind the root, on the floor
  };
  Rgb colour_of(const RoundCone& c, Index frame) const {
    return paint_ ? paint_(c.joint, frame) : side_colours[static_cast<std::size_t>(c.side)];
  }
  /// From far to near.
  std::vector<Piece> pieces(Index frame, const JointTransforms<double>& world, const Vec3<double>& root) const {
    std::map<std::pair<int, int>, Piece> by_joint;
    for (const RoundCone& c : figure_.cones) {
      const Rgb colour = colour_of(c, frame);
      const int one = (colour.r * 256 + colour.g) * 256 + colour.b;
      Piece& piece = by_joint[{c.side == Side::middle ? -1 : c.joint, one}];
      piece.cones.push_back(&c);
      piece.colour = colour;
    }
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
  /// distance   0 near the root or before it, 1 far behind it
  static Rgb shaded(const Rgb& near, double distance) {
    const auto one = [&](int n, int far) { return static_cast<int>(std::lround(n + 0.55 * distance * (far - n))); };
    return {one(near.r, far_colour.r), one(near.g, far_colour.g), one(near.b, far_colour.b)};
  }

  const Motion& motion_;
  Figure figure_;
  ObliqueView view_;
  Paint paint_;
  double ground_ = 0, high_ = 0;  // heights
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
