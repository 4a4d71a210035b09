// SPDX-License-Identifier: MIT
// Bodies of timeline_picture.hpp.
#pragma once

#include <algorithm>  // max, min
#include <vector>     // plans

#include <motionlang/compose/plan.hpp>
#include <motionlang/view/detail/figure_drawing.hpp>
#include <motionlang/view/timeline_picture.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Draws one timeline after the other. The y axis points down.
class TimelinePicture {
 public:
  explicit TimelinePicture(double fps) : fps_(fps) {}

  double height(const TimelinePlan& plan) const {
    return axis + line * texts(plan) + gap + part_line * plan.timeline.body.size() + 2 * gap;
  }
  void draw(SvgSurface& on, const TimelinePlan& plan, double top) const {
    const double scale = (width - left - right) / std::max<double>(1, static_cast<double>(plan.frames));
    const auto x_of = [&](Index frame) { return left + scale * static_cast<double>(frame); };
    const double bars = top + axis, parts = bars + line * texts(plan) + gap;
    const double end = parts + part_line * plan.timeline.body.size();
    const double seconds = static_cast<double>(plan.frames) / fps_;
    for (double t = 0; t <= seconds + 1e-9; t += tick(seconds)) {
      const double x = left + scale * t * fps_;
      on.guide(x, bars - 4, end);
      on.text({x, bars - 8}, fixed(t, 1) + " s", TextRole::small, TextAnchor::middle);
    }
    int row = 0;
    for (std::size_t i = 0; i < plan.timeline.intervals.size(); ++i) {
      const Interval& text = plan.timeline.intervals[i];
      if (text.text.empty()) continue;
      labelled_bar(on, {x_of(text.start), bars + line * row++ + 3}, x_of(text.end), line - 6, colour(i), text.text);
    }
    for (int p = 0; p < plan.timeline.body.size(); ++p) {
      const double y = parts + part_line * p;
      on.text({left - 10, y + 13}, plan.timeline.body.name(static_cast<BodyPart>(p)), TextRole::small, TextAnchor::end);
      for (const PartInterval& piece : plan.merged) {
        const auto owner = static_cast<std::size_t>(piece.owner);
        if (piece.part != static_cast<BodyPart>(p)) continue;
        const bool free = plan.timeline.intervals[owner].text.empty();
        const double x = x_of(piece.range.start);
        on.bar({x + 1, y + 2}, std::max(1.0, x_of(piece.range.end) - x - 2), part_line - 4,
               free ? Rgb{0xdd, 0xe2, 0xe8} : colour(owner));
      }
    }
  }
  static constexpr double width = 900;

 private:
  static constexpr double left = 90, right = 24, axis = 26, line = 28, part_line = 20, gap = 10;

  static int texts(const TimelinePlan& plan) {
    int n = 0;
    for (const Interval& i : plan.timeline.intervals) n += i.text.empty() ? 0 : 1;
    return n;
  }
  static Rgb colour(std::size_t text) { return text_colours[text % text_colours.size()]; }
  static double tick(double seconds) {
    for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 300.0}) {
      if (seconds / step <= 14) return step;
    }
    return seconds / 10;
  }
  /// A text stands in its bar, or beside it where it does not fit.
  static void labelled_bar(SvgSurface& on, Point2 corner, double end, double height, const Rgb& colour,
                           const std::string& text) {
    const double letters = 6.6 * static_cast<double>(text.size()), size = std::max(2.0, end - corner.x);
    const bool inside = letters + 16 < size, after = !inside && end + letters + 12 < width;
    on.bar(corner, size, height, colour);
    on.text({inside  ? corner.x + 8
             : after ? end + 6
                     : corner.x - 6,
             corner.y + height - 6},
            text, inside ? TextRole::bar : TextRole::usual, inside || after ? TextAnchor::start : TextAnchor::end);
  }

  double fps_;
};

}  // namespace detail

MOTIONLANG_BODY std::string timelines_svg(std::span<const Timeline> timelines, double fps) {
  if (timelines.empty()) raise<config_error>(101, "timelines_svg: no timeline");
  if (!(fps > 0)) raise<config_error>(101, "timelines_svg: frame rate ", fps);
  const detail::TimelinePicture picture(fps);
  std::vector<TimelinePlan> plans;
  double height = 8;
  for (const Timeline& t : timelines) {
    plans.push_back(plan_timeline(t, {.hidden = HiddenTexts::ignore}));
    height += picture.height(plans.back());
  }
  detail::SvgSurface surface(picture.width, height, timelines.size() == 1 ? "timeline" : "timelines");
  double top = 8;
  for (const TimelinePlan& plan : plans) {
    picture.draw(surface, plan, top);
    top += picture.height(plan);
  }
  return surface.finish();
}

MOTIONLANG_NAMESPACE_END
