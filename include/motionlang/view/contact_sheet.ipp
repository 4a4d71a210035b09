// SPDX-License-Identifier: MIT
// Bodies of contact_sheet.hpp.
#pragma once

#include <algorithm>  // max, min, sort
#include <cmath>      // ceil
#include <limits>     // infinity
#include <string>     // captions
#include <vector>     // lines

#include <motionlang/view/contact_sheet.hpp>
#include <motionlang/view/detail/figure_drawing.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Positions of all joints, seen from the root over the floor. (frames, joints)
inline std::vector<Vec3<double>> positions_from_root(const Motion& motion) {
  auto out = motion.positions();
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3<double>& root = motion.root[i / joints];
    out[i] = out[i] - Vec3<double>{root.x, 0, root.z};
  }
  return out;
}

/// A text in lines of at most `letters`, where its words allow that.
inline std::vector<std::string> lines_of_text(const std::string& text, std::size_t letters) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > letters) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    at = end + 1;
  }
  return lines;
}

/// Lays the cells out and draws them.
class ContactSheet {
 public:
  ContactSheet(std::span<const SheetEntry> entries, const ContactSheetOptions& options)
      : entries_(entries), o_(options), cell_((options.width - 2 * margin) / options.columns) {
    rows_ = (static_cast<int>(entries.size()) + o_.columns - 1) / o_.columns;
    for (const SheetEntry& e : entries) lines_ = std::max(lines_, caption_lines(e).size());
  }
  double height() const { return top() + rows_ * cell_height() + margin; }

  template <class Surface>
  void draw(Surface& on) const {
    if (!o_.title.empty()) on.text({margin, 30}, o_.title, TextRole::title, TextAnchor::start);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const auto column = static_cast<int>(i) % o_.columns, row = static_cast<int>(i) / o_.columns;
      cell(on, entries_[i], {margin + column * cell_, top() + row * cell_height()});
    }
  }

 private:
  static constexpr double margin = 16, line_height = 15, letter_width = 7;
  double top() const { return o_.title.empty() ? margin : 44; }
  /// A person of 1.6 m is half as high as a cell is wide.
  double figure_height() const { return 0.5 * cell_; }
  double cell_height() const { return 1.45 * figure_height() + static_cast<double>(lines_) * line_height + 13; }
  std::vector<std::string> caption_lines(const SheetEntry& entry) const {
    return lines_of_text(entry.caption, static_cast<std::size_t>(cell_ / letter_width));
  }

  template <class Surface>
  void cell(Surface& on, const SheetEntry& entry, Point2 corner) const {
    const FigureDrawing figure(entry.motion);
    const double body = 1.15 * figure_height();
    const double scale = std::min(figure_height() / figure.size(), body / figure.reach());
    const double floor = corner.y + 1.3 * figure_height();
    on.floor(floor - 0.16 * figure_height(), 0.3 * figure_height(), corner.x + 3, cell_ - 6);
    const auto frames = key_frames(entry.motion, o_.poses);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(frames.size());
      figure.pose(on, frames[i], {corner.x + 0.08 * cell_ + 0.84 * share * cell_, floor}, scale);
    }
    double y = corner.y + 1.45 * figure_height() + line_height;
    for (const std::string& line : caption_lines(entry)) {
      on.text({corner.x + cell_ / 2, y}, line, TextRole::usual, TextAnchor::middle);
      y += line_height;
    }
  }

  std::span<const SheetEntry> entries_;
  const ContactSheetOptions& o_;
  double cell_;
  int rows_ = 0;
  std::size_t lines_ = 1;  // of the longest caption
};

inline ContactSheet contact_sheet(std::span<const SheetEntry> entries, const ContactSheetOptions& o) {
  if (entries.empty()) raise<config_error>(101, "contact sheet: no motion to show");
  for (const SheetEntry& e : entries) {
    e.motion.validate();
    if (e.motion.frames() == 0) raise<config_error>(101, "contact sheet: motion '", e.motion.name, "' has no frames");
  }
  if (o.columns < 1 || o.poses < 1 || !(o.width / o.columns >= 60 && o.width <= 1e6))
    raise<config_error>(101, "contact sheet: ", o.columns, " columns in a width of ", o.width, ", ", o.poses, " poses");
  return {entries, o};
}

}  // namespace detail

MOTIONLANG_BODY std::vector<Index> key_frames(const Motion& motion, int count) {
  const auto positions = detail::positions_from_root(motion);
  const auto frames = static_cast<std::size_t>(motion.frames()),
             joints = positions.size() / std::max<std::size_t>(1, frames);
  std::vector<Vec3<double>> mean(joints, Vec3<double>{});
  for (std::size_t i = 0; i < positions.size(); ++i)
    mean[i % joints] = mean[i % joints] + (1.0 / static_cast<double>(frames)) * positions[i];
  const auto distance = [&](std::size_t frame, const Vec3<double>* from) {
    double sum = 0;
    for (std::size_t j = 0; j < joints; ++j) sum += norm(positions[frame * joints + j] - from[j]);
    return sum;
  };
  std::vector<double> nearest(frames, std::numeric_limits<double>::infinity());  // distance to what is chosen
  std::vector<Index> out;
  while (out.size() < std::min(frames, static_cast<std::size_t>(std::max(count, 0)))) {
    std::size_t best = 0;
    double farthest = -1;
    for (std::size_t f = 0; f < frames; ++f) {
      const double away = out.empty() ? distance(f, mean.data()) : nearest[f];
      if (away > farthest + 1e-9) best = f, farthest = away;  // the first of poses that hardly differ
    }
    out.push_back(static_cast<Index>(best));
    for (std::size_t f = 0; f < frames; ++f) nearest[f] = std::min(nearest[f], distance(f, &positions[best * joints]));
    nearest[best] = -2;  // never twice, even if nothing moves
  }
  std::sort(out.begin(), out.end());
  return out;
}

MOTIONLANG_BODY std::string contact_sheet_svg(std::span<const SheetEntry> entries, const ContactSheetOptions& options) {
  const detail::ContactSheet sheet = detail::contact_sheet(entries, options);
  detail::SvgSurface surface(options.width, sheet.height(), options.title);
  sheet.draw(surface);
  return surface.finish();
}

MOTIONLANG_BODY Picture contact_sheet_picture(std::span<const SheetEntry> entries, const ContactSheetOptions& options) {
  const detail::ContactSheet sheet = detail::contact_sheet(entries, options);
  if (!(options.resolution > 0 && options.resolution * std::max(options.width, sheet.height()) <= 20000))
    raise<config_error>(101, "contact sheet: ", options.width, " by ", sheet.height(), " at ", options.resolution,
                        " pixels each");
  detail::PixelSurface surface(options.width, sheet.height(), options.resolution);
  sheet.draw(surface);
  return surface.finish();
}

MOTIONLANG_NAMESPACE_END
