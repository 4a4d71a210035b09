// SPDX-License-Identifier: MIT
/// Tools to draw a film strip: the shapes, and two surfaces that draw them, one for SVG, one for pixels.
#pragma once

#include <algorithm>  // clamp
#include <array>      // colours
#include <cmath>      // distances

#include <motionlang/file/png.hpp>
#include <motionlang/geometry/vec.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/detail/stroke_font.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

struct Point2 {
  double x = 0, y = 0;
};

struct Rgb {
  int r = 0, g = 0, b = 0;
};

/// The hull of two circles.
struct RoundCone2 {
  Point2 from;
  double radius_from;
  Point2 to;
  double radius_to;

  /// True if one circle contains the other.
  bool is_circle() const {
    return std::hypot(to.x - from.x, to.y - from.y) <= std::abs(radius_from - radius_to) + 1e-9;
  }
};

/// The parts of horizontal lines inside a round cone: from x to x at a height. The hull is two circles and the
/// quadrangle of the points where both tangents touch them.
class RoundConeRows {
 public:
  /// wider   added to both radii; circles without a positive radius are left out
  RoundConeRows(const RoundCone2& cone, double wider) {
    const auto& [a, ra, b, rb] = cone;
    const double from = ra + wider, to = rb + wider;
    if (from > 0 && (ra >= rb || !cone.is_circle())) circles_[circle_count_++] = {a, from};
    if (to > 0 && (ra < rb || !cone.is_circle())) circles_[circle_count_++] = {b, to};
    if (circle_count_ < 2) return;
    const double axis = std::atan2(b.y - a.y, b.x - a.x);
    const double tangent = std::acos(std::clamp((ra - rb) / std::hypot(b.x - a.x, b.y - a.y), -1.0, 1.0));
    for (std::size_t side = 0; side < 2; ++side) {
      const double angle = side == 0 ? axis + tangent : axis - tangent, x = std::cos(angle), y = std::sin(angle);
      corners_[side] = {a.x + from * x, a.y + from * y};
      corners_[3 - side] = {b.x + to * x, b.y + to * y};
    }
  }

  struct Row {
    double low = 0, high = -1;  // empty if high < low
  };
  Row at(double y) const {
    Row row{1e300, -1e300};
    const auto take = [&](double x) { row = {std::min(row.low, x), std::max(row.high, x)}; };
    for (std::size_t i = 0; i < circle_count_; ++i) {
      const auto& [middle, radius] = circles_[i];
      const double square = radius * radius - (y - middle.y) * (y - middle.y);
      if (square < 0) continue;
      const double half = std::sqrt(square);
      take(middle.x - half), take(middle.x + half);
    }
    for (std::size_t i = 0; i < 4 && circle_count_ == 2; ++i) {
      const Point2 &p = corners_[i], &q = corners_[(i + 1) % 4];
      if ((p.y <= y) != (q.y <= y)) take(p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x));
    }
    return row;
  }

 private:
  struct Circle {
    Point2 middle;
    double radius = 0;
  };
  std::array<Circle, 2> circles_{};
  std::size_t circle_count_ = 0;
  std::array<Point2, 4> corners_{};
};

enum class TextAnchor { start, middle, end };
/// `bar`: white, on a coloured bar.
enum class TextRole { usual, title, small, bar };

/// Writes SVG. The y axis points down, as in the picture.
class SvgSurface {
 public:
  SvgSurface(double width, double height, std::string_view title) {
    out_ = concat_text("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", fixed(width), " ", fixed(height),
                       "\" width=\"", fixed(width), "\" height=\"", fixed(height), "\" role=\"img\">\n<title>",
                       escape_markup(title), "</title>\n", style,
                       "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
  }
  std::string finish() { return out_ + "</svg>\n"; }

  /// width   0: all of the picture
  void floor(double top, double height, double left = 0, double width = 0) {
    out_ +=
        concat_text("<rect x=\"", fixed(left), "\" y=\"", fixed(top), "\" width=\"", width > 0 ? fixed(width) : "100%",
                    "\" height=\"", fixed(height), "\" fill=\"url(#floor)\"/>\n");
  }
  void disc(Point2 c, double r, const Rgb& colour) {
    out_ += concat_text("<circle cx=\"", fixed(c.x), "\" cy=\"", fixed(c.y), "\" r=\"", fixed(r), "\" fill=\"",
                        hex(colour), "\"/>\n");
  }
  void dotted_line(std::span<const Point2> points) {
    std::string d;
    for (const Point2& p : points) d += concat_text(d.empty() ? "M" : "L", fixed(p.x), " ", fixed(p.y));
    out_ += concat_text("<path d=\"", d,
                        "\" fill=\"none\" stroke=\"#9aa3b0\" stroke-width=\"1.5\" stroke-dasharray=\"1 5\" ",
                        "stroke-linecap=\"round\"/>\n");
  }
  void begin_pose() { out_ += "<g class=\"pose\">\n"; }
  void end_pose() { out_ += "</g>\n"; }
  void shadow(Point2 c, double rx, double ry, double opacity) {
    out_ += concat_text("<ellipse cx=\"", fixed(c.x), "\" cy=\"", fixed(c.y), "\" rx=\"", fixed(rx), "\" ry=\"",
                        fixed(ry), "\" fill=\"url(#shadow)\" opacity=\"", fixed(opacity, 2), "\"/>\n");
  }
  /// Several round cones as one shape with a white line around it.
  void piece(std::span<const RoundCone2> cones, const Rgb& colour) {
    std::string shapes;
    for (const RoundCone2& c : cones) shapes += outline(c);
    out_ += concat_text("<path d=\"", shapes, "\" stroke=\"#fff\" stroke-width=\"1.8\"/><path d=\"", shapes,
                        "\" fill=\"", hex(colour), "\"/>\n");
  }
  void guide(double x, double top, double bottom) {
    out_ += concat_text("<path d=\"M", fixed(x), " ", fixed(top), "V", fixed(bottom),
                        "\" stroke=\"#d5dae1\" stroke-width=\"1\"/>\n");
  }
  void bar(Point2 corner, double width, double height, const Rgb& colour) {
    out_ += concat_text("<rect x=\"", fixed(corner.x), "\" y=\"", fixed(corner.y), "\" width=\"", fixed(width),
                        "\" height=\"", fixed(height), "\" rx=\"5\" fill=\"", hex(colour), "\"/>\n");
  }
  /// `paler` follows the text.
  void text(Point2 at, std::string_view text, TextRole role, TextAnchor anchor, std::string_view paler = {}) {
    constexpr std::array<std::string_view, 4> of_role{"", " class=\"title\"", " class=\"small\"", " class=\"bar\""};
    constexpr std::array<std::string_view, 3> of_anchor{"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    out_ += concat_text("<text", of_role[static_cast<std::size_t>(role)], of_anchor[static_cast<std::size_t>(anchor)],
                        " x=\"", fixed(at.x), "\" y=\"", fixed(at.y), "\"");
    // It begins with a space, which some programs would drop.
    if (!paler.empty()) out_ += " xml:space=\"preserve\"";
    out_ += ">" + escape_markup(text);
    if (!paler.empty()) out_ += concat_text("<tspan opacity=\".75\">", escape_markup(paler), "</tspan>");
    out_ += "</text>\n";
  }

 private:
  static constexpr std::string_view style =
      "<style>text{font:12px system-ui,-apple-system,'Segoe UI',sans-serif;fill:#4a5260}"
      ".title{font-size:15px;font-weight:600;fill:#20242c}.bar{fill:#fff;font-weight:500}.small{font-size:11px}</"
      "style>\n"
      "<defs><radialGradient id=\"shadow\"><stop offset=\"0\" stop-color=\"#20242c\" stop-opacity=\".34\"/>"
      "<stop offset=\".55\" stop-color=\"#20242c\" stop-opacity=\".16\"/><stop offset=\"1\" stop-color=\"#20242c\" "
      "stop-opacity=\"0\"/></radialGradient><linearGradient id=\"floor\" x2=\"0\" y2=\"1\"><stop offset=\"0\" "
      "stop-color=\"#eef1f5\" stop-opacity=\"0\"/><stop offset=\"1\" "
      "stop-color=\"#e9edf2\"/></linearGradient></defs>\n";

  static std::string hex(const Rgb& colour) {
    std::string out = "#";
    for (const int c : {colour.r, colour.g, colour.b}) {
      constexpr std::string_view digits = "0123456789abcdef";
      out += digits[static_cast<std::size_t>(c / 16)];
      out += digits[static_cast<std::size_t>(c % 16)];
    }
    return out;
  }
  /// Two arcs and the tangents between them.
  static std::string outline(const RoundCone2& cone) {
    const auto& [a, ra, b, rb] = cone;
    const double dx = b.x - a.x, dy = b.y - a.y;
    auto arc = [](double r, bool large, Point2 to) {
      return concat_text("A", fixed(r), " ", fixed(r), " 0 ", large ? 1 : 0, " 1 ", fixed(to.x), " ", fixed(to.y));
    };
    if (cone.is_circle()) {
      const double r = std::max(ra, rb);
      const Point2 c = ra > rb ? a : b;
      return concat_text("M", fixed(c.x - r), " ", fixed(c.y), arc(r, false, {c.x + r, c.y}),
                         arc(r, false, {c.x - r, c.y}), "Z");
    }
    const double axis = std::atan2(dy, dx), tangent = std::acos((ra - rb) / std::hypot(dx, dy));
    auto on = [](Point2 c, double r, double angle) {
      return Point2{c.x + r * std::cos(angle), c.y + r * std::sin(angle)};
    };
    const Point2 a1 = on(a, ra, axis + tangent), a2 = on(a, ra, axis - tangent);
    const Point2 b1 = on(b, rb, axis + tangent), b2 = on(b, rb, axis - tangent);
    const bool a_large = tangent < std::numbers::pi / 2;
    return concat_text("M", fixed(a1.x), " ", fixed(a1.y), arc(ra, a_large, a2), "L", fixed(b2.x), " ", fixed(b2.y),
                       arc(rb, !a_large, b1), "Z");
  }

  std::string out_;
};

/// Paints pixels. A shape is a signed distance (negative inside). A pixel that the edge cuts is covered by half a pixel
/// minus the distance of its centre.
class PixelSurface {
 public:
  /// width, height   in the units of the drawing; each unit is `scale` pixels
  PixelSurface(double width, double height, double scale)
      : scale_(scale),
        picture_{static_cast<Index>(std::ceil(width * scale)), static_cast<Index>(std::ceil(height * scale)), {}} {
    picture_.rgb.assign(static_cast<std::size_t>(3 * picture_.width * picture_.height), 255);
  }
  Picture finish() { return std::move(picture_); }

  void floor(double top, double height, double left = 0, double width = 0) {
    const double right = width > 0 ? left + width : 1e9;
    fill(
        {{left, top}, {right, top + height}},
        [&](Point2 p) {
          return std::max({top - p.y, p.y - top - height, left - p.x, p.x - right});
        },
        [&](Point2 p) {
          const double t = std::clamp((p.y - top) / height, 0.0, 1.0);
          return Ink{mix({0xee, 0xf1, 0xf5}, {0xe9, 0xed, 0xf2}, t), t};
        });
  }
  void disc(Point2 c, double r, const Rgb& colour) {
    const RoundCone2 circle{c, r, c, r};
    piece_without_edge(std::span(&circle, 1), {colour, 1});
  }
  /// Dots of 1.5 units, 6 apart.
  void dotted_line(std::span<const Point2> points) {
    double next = 0, way = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Point2 a = points[i - 1], b = points[i];
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      for (; next < way + length; next += 6) {
        const double t = (next - way) / length;
        disc({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}, 0.9, {0x9a, 0xa3, 0xb0});
      }
      way += length;
    }
  }
  void begin_pose() {}
  void end_pose() {}
  void shadow(Point2 c, double rx, double ry, double opacity) {
    fill(
        {{c.x - rx, c.y - ry}, {c.x + rx, c.y + ry}}, [](Point2) { return -1.0; },
        [&](Point2 p) {
          const double r = std::hypot((p.x - c.x) / rx, (p.y - c.y) / ry);
          const double stop = r < 0.55 ? 0.34 + (0.16 - 0.34) * r / 0.55 : 0.16 * std::max(0.0, 1 - r) / 0.45;
          return Ink{{0x20, 0x24, 0x2c}, stop * opacity};
        });
  }
  void piece(std::span<const RoundCone2> cones, const Rgb& colour) {
    layers(cones, {{{0.9, {{255, 255, 255}, 1}}, {0, {colour, 1}}}});
  }
  void guide(double x, double top, double bottom) {
    fill(
        {{x - 1, top}, {x + 1, bottom}}, [&](Point2 p) { return std::abs(p.x - x) - 0.5; },
        [](Point2) {
          return Ink{{0xd5, 0xda, 0xe1}, 1};
        });
  }
  void bar(Point2 corner, double width, double height, const Rgb& colour) {
    const double round = std::min(5.0, width / 2);
    const Point2 half{width / 2, height / 2}, middle{corner.x + half.x, corner.y + half.y};
    fill(
        {corner, {corner.x + width, corner.y + height}},
        [&](Point2 p) {
          const double x = std::abs(p.x - middle.x) - half.x + round, y = std::abs(p.y - middle.y) - half.y + round;
          return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) - round;
        },
        [&](Point2) {
          return Ink{colour, 1};
        });
  }
  void text(Point2 at, std::string_view text, TextRole role, TextAnchor anchor, std::string_view paler = {}) {
    const double size = role == TextRole::title ? 15 : role == TextRole::small ? 11 : 12, unit = size / font_em;
    const StrokedText first = stroke_text(text), second = stroke_text(paler);
    const int width = first.width + second.width - font_gap;
    const Rgb colour = role == TextRole::title ? Rgb{0x20, 0x24, 0x2c}
                       : role == TextRole::bar ? Rgb{255, 255, 255}
                                               : Rgb{0x4a, 0x52, 0x60};
    if (anchor != TextAnchor::start) at.x -= width * unit / (anchor == TextAnchor::middle ? 2 : 1);
    const double thick = role == TextRole::title || role == TextRole::bar ? 0.056 * size : 0.044 * size;
    strokes(first, at, unit, thick, {colour, 1});
    strokes(second, {at.x + first.width * unit, at.y}, unit, thick, {colour, 0.75});
  }

 private:
  struct Box {
    Point2 low, high;
  };
  struct Ink {
    Rgb colour;
    double opacity;
  };
  static Rgb mix(const Rgb& a, const Rgb& b, double t) {
    const auto one = [&](int x, int y) { return static_cast<int>(std::lround(x + t * (y - x))); };
    return {one(a.r, b.r), one(a.g, b.g), one(a.b, b.b)};
  }

  /// Source  Inigo Quilez, "2D distance functions", uneven capsule
  static double distance(const RoundCone2& c, Point2 p) {
    const auto& [a, ra, b, rb] = c;
    if (c.is_circle()) {
      const Point2 m = ra > rb ? a : b;
      return std::hypot(p.x - m.x, p.y - m.y) - std::max(ra, rb);
    }
    const Point2 axis{b.x - a.x, b.y - a.y}, q{p.x - a.x, p.y - a.y};
    const double h = axis.x * axis.x + axis.y * axis.y, slope = ra - rb, rise = std::sqrt(h - slope * slope);
    const double u = std::abs(q.x * axis.y - q.y * axis.x) / h, v = (q.x * axis.x + q.y * axis.y) / h;
    const double side = rise * v - slope * u, n = u * u + v * v;
    if (side < 0) return std::sqrt(h * n) - ra;
    if (side > rise) return std::sqrt(h * (n + 1 - 2 * v)) - rb;
    return rise * u + slope * v - ra;
  }

  /// The colour of points nearer to a shape than `wider`.
  struct Layer {
    double wider;
    Ink ink;
  };
  void piece_without_edge(std::span<const RoundCone2> cones, const Ink& ink) {
    layers(cones, {{{0, ink}, {0, {ink.colour, 0}}}});
  }
  /// Paints the first layer, then the second. The distance to the nearest cone is computed once, and only near the edge
  /// of a cone, because thousands of cones overlap in a piece.
  void layers(std::span<const RoundCone2> cones, const std::array<Layer, 2>& both) {
    constexpr double far = 1e9;
    const double widest = std::max(both[0].wider, both[1].wider), pixel = 1 / scale_;
    Box box{{far, far}, {-far, -far}};
    for (const RoundCone2& c : cones) {
      for (const auto& [p, r] : {std::pair{c.from, c.radius_from + widest}, std::pair{c.to, c.radius_to + widest}}) {
        box.low = {std::min(box.low.x, p.x - r), std::min(box.low.y, p.y - r)};
        box.high = {std::max(box.high.x, p.x + r), std::max(box.high.y, p.y + r)};
      }
    }
    const PixelBox area = pixels(box);
    if (area.x0 >= area.x1 || area.y0 >= area.y1) return;
    const auto columns = static_cast<std::size_t>(area.x1 - area.x0),
               rows = static_cast<std::size_t>(area.y1 - area.y0);
    if (nearest_.size() < columns * rows) nearest_.resize(columns * rows, far);
    rows_.assign(rows, {});
    for (const RoundCone2& c : cones) {
      const RoundConeRows outer(c, widest + 1.5 * pixel), inner(c, -1.5 * pixel);
      const PixelBox own = pixels({{0, std::min(c.from.y - c.radius_from, c.to.y - c.radius_to) - widest},
                                   {0, std::max(c.from.y + c.radius_from, c.to.y + c.radius_to) + widest}});
      for (Index y = std::max(own.y0, area.y0); y < std::min(own.y1, area.y1); ++y) {
        const double middle = (static_cast<double>(y) + 0.5) * pixel;
        const auto [from, to] = columns_of(outer.at(middle), area);
        PieceRow& row = rows_[static_cast<std::size_t>(y - area.y0)];
        if (from >= to || (from >= row.full_from && to <= row.full_to)) continue;
        const auto [full_from, full_to] = columns_of(inner.at(middle), area);
        double* const nearest = nearest_.data() + static_cast<std::size_t>(y - area.y0) * columns;
        for (Index x = from; x < to; ++x) {
          double& d = nearest[x - area.x0];
          if (x >= row.full_from && x < row.full_to) {
            x = row.full_to - 1;
          } else if (x >= full_from && x < full_to) {
            d = -far;
          } else {
            d = std::min(d, distance(c, {(static_cast<double>(x) + 0.5) * pixel, middle}));
          }
        }
        row.add(from, to, full_from, full_to);
      }
    }
    for (const Layer& layer : both) {
      if (layer.ink.opacity == 0) continue;
      for (std::size_t y = 0; y < rows; ++y) {
        const double* const nearest = nearest_.data() + y * columns;
        for (Index x = rows_[y].from; x < rows_[y].to; ++x) {
          const double coverage = std::clamp(0.5 - (nearest[x - area.x0] - layer.wider) * scale_, 0.0, 1.0);
          if (coverage > 0) blend(x, area.y0 + static_cast<Index>(y), layer.ink, coverage);
        }
      }
    }
    for (std::size_t y = 0; y < rows; ++y) {  // restored for the next piece
      for (Index x = rows_[y].from; x < rows_[y].to; ++x)
        nearest_[y * columns + static_cast<std::size_t>(x - area.x0)] = far;
    }
  }

  struct PixelBox {
    Index x0, y0, x1, y1;
  };
  /// The pixels in and around a box.
  PixelBox pixels(const Box& box) const {
    const auto pixel = [&](double v, Index limit) {
      return static_cast<Index>(std::clamp(v * scale_, -1.0, static_cast<double>(limit) + 1));
    };
    return {std::max<Index>(0, pixel(box.low.x, picture_.width) - 1),
            std::max<Index>(0, pixel(box.low.y, picture_.height) - 1),
            std::min(picture_.width, pixel(box.high.x, picture_.width) + 2),
            std::min(picture_.height, pixel(box.high.y, picture_.height) + 2)};
  }
  /// The pixels whose centres lie on a part of a row.
  std::pair<Index, Index> columns_of(const RoundConeRows::Row& row, const PixelBox& area) const {
    if (row.high < row.low) return {0, 0};
    const double low = std::clamp(row.low * scale_ - 0.5, -1.0, static_cast<double>(area.x1) + 1),
                 high = std::clamp(row.high * scale_ - 0.5, -1.0, static_cast<double>(area.x1) + 1);
    return {std::max(area.x0, static_cast<Index>(std::ceil(low))),
            std::min(area.x1, static_cast<Index>(std::floor(high)) + 1)};
  }
  /// Pixels of a row of a piece: those that it touches, and those that it covers completely.
  struct PieceRow {
    Index from = 0, to = 0, full_from = 0, full_to = 0;

    void add(Index first, Index last, Index full_first, Index full_last) {
      from = from == to ? first : std::min(from, first);
      to = std::max(to, last);
      if (full_first >= full_last) return;
      if (full_first <= full_to && full_last >= full_from && full_from < full_to) {
        full_from = std::min(full_from, full_first), full_to = std::max(full_to, full_last);
      } else if (full_last - full_first > full_to - full_from) {
        full_from = full_first, full_to = full_last;
      }
    }
  };

  void strokes(const StrokedText& text, Point2 at, double unit, double radius, const Ink& ink) {
    for (const auto& stroke : text.strokes) {
      std::vector<RoundCone2> lines;
      const auto point = [&](const GridPoint& g) {
        return Point2{at.x + g.x * unit, at.y - (g.y - font_baseline) * unit};
      };
      for (std::size_t i = 0; i < stroke.size(); ++i) {
        if (i == 0 && stroke.size() > 1) continue;
        const double r = stroke.size() > 1 ? radius : 1.4 * radius;  // dots are a little thicker than lines
        lines.push_back({point(stroke[i > 0 ? i - 1 : 0]), r, point(stroke[i]), r});
      }
      piece_without_edge(lines, ink);
    }
  }

  /// distance(p) and ink(p) are called at the centre of every pixel in and around the box.
  template <class Distance, class InkAt>
  void fill(const Box& box, Distance distance, InkAt ink) {
    const auto [x0, y0, x1, y1] = pixels(box);
    for (Index y = y0; y < y1; ++y) {
      for (Index x = x0; x < x1; ++x) {
        const Point2 p{(static_cast<double>(x) + 0.5) / scale_, (static_cast<double>(y) + 0.5) / scale_};
        const double coverage = std::clamp(0.5 - distance(p) * scale_, 0.0, 1.0);
        if (coverage > 0) blend(x, y, ink(p), coverage);
      }
    }
  }
  void blend(Index x, Index y, const Ink& ink, double coverage) {
    std::uint8_t* pixel = &picture_.rgb[static_cast<std::size_t>(3 * (y * picture_.width + x))];
    for (const int c : {ink.colour.r, ink.colour.g, ink.colour.b}) {
      *pixel = static_cast<std::uint8_t>(std::lround(*pixel + coverage * ink.opacity * (c - *pixel)));
      ++pixel;
    }
  }

  double scale_;
  Picture picture_;
  std::vector<double> nearest_;  // distances of a piece for each pixel; a large value between pieces
  std::vector<PieceRow> rows_;   // of a piece
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
