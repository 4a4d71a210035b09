// SPDX-License-Identifier: MIT
/// The tools to draw a film strip: the shapes, and two surfaces that take them, one for SVG, one for pixels.
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

  /// One circle holds the other.
  bool is_circle() const {
    return std::hypot(to.x - from.x, to.y - from.y) <= std::abs(radius_from - radius_to) + 1e-9;
  }
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

  void floor(double top, double height) {
    out_ += concat_text("<rect x=\"0\" y=\"", fixed(top), "\" width=\"100%\" height=\"", fixed(height),
                        "\" fill=\"url(#floor)\"/>\n");
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
  /// One shape with a white line around it.
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
    // it begins with a space, which some programs would leave out
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

/// Paints pixels. A shape is a signed distance (negative inside); a pixel that the edge cuts is covered by half a pixel
/// minus the distance of its middle.
class PixelSurface {
 public:
  /// width, height   in the units of the drawing; each is `scale` pixels
  PixelSurface(double width, double height, double scale)
      : scale_(scale),
        picture_{static_cast<Index>(std::ceil(width * scale)), static_cast<Index>(std::ceil(height * scale)), {}} {
    picture_.rgb.assign(static_cast<std::size_t>(3 * picture_.width * picture_.height), 255);
  }
  Picture finish() { return std::move(picture_); }

  void floor(double top, double height) {
    const Box all{{0, top}, {1e9, top + height}};
    fill(
        all, [&](Point2 p) { return std::max(top - p.y, p.y - top - height); },
        [&](Point2 p) {
          const double t = std::clamp((p.y - top) / height, 0.0, 1.0);
          return Ink{mix({0xee, 0xf1, 0xf5}, {0xe9, 0xed, 0xf2}, t), t};
        });
  }
  void disc(Point2 c, double r, const Rgb& colour) {
    const RoundCone2 circle{c, r, c, r};
    piece_without_edge(std::span(&circle, 1), 0, {colour, 1});
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
    piece_without_edge(cones, 0.9, {{255, 255, 255}, 1});
    piece_without_edge(cones, 0, {colour, 1});
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

  void piece_without_edge(std::span<const RoundCone2> cones, double wider, const Ink& ink) {
    Box box{{1e9, 1e9}, {-1e9, -1e9}};
    for (const RoundCone2& c : cones) {
      for (const auto& [p, r] : {std::pair{c.from, c.radius_from + wider}, std::pair{c.to, c.radius_to + wider}}) {
        box.low = {std::min(box.low.x, p.x - r), std::min(box.low.y, p.y - r)};
        box.high = {std::max(box.high.x, p.x + r), std::max(box.high.y, p.y + r)};
      }
    }
    fill(
        box,
        [&](Point2 p) {
          double d = 1e9;
          for (const RoundCone2& c : cones) d = std::min(d, distance(c, p));
          return d - wider;
        },
        [&](Point2) { return ink; });
  }
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
      piece_without_edge(lines, 0, ink);
    }
  }

  /// distance(p) and ink(p) are asked for at the middle of every pixel in and around the box.
  template <class Distance, class InkAt>
  void fill(const Box& box, Distance distance, InkAt ink) {
    const auto pixel = [&](double v, Index limit) {
      return static_cast<Index>(std::clamp(v * scale_, -1.0, static_cast<double>(limit) + 1));
    };
    const Index x0 = std::max<Index>(0, pixel(box.low.x, picture_.width) - 1),
                y0 = std::max<Index>(0, pixel(box.low.y, picture_.height) - 1),
                x1 = std::min(picture_.width, pixel(box.high.x, picture_.width) + 2),
                y1 = std::min(picture_.height, pixel(box.high.y, picture_.height) + 2);
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
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
