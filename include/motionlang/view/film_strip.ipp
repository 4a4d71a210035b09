// SPDX-License-Identifier: MIT
// Bodies of film_strip.hpp.
#pragma once

#include <algorithm>  // clamp, max, min
#include <cmath>      // round
#include <tuple>      // legend
#include <vector>     // rows

#include <motionlang/file/file.hpp>
#include <motionlang/view/detail/figure_drawing.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/text_colours.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

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

/// The colours that options ask for; `tracks` must outlive them.
inline FigureDrawing::Paint strip_paint(const Motion& motion, std::span<const Track> tracks, StripColours colours) {
  if (colours == StripColours::sides) return {};
  auto parts = parts_of_joints(motion.skeleton);
  if (colours == StripColours::newest_text) parts.assign(parts.size(), "");
  return [=, fps = motion.fps, parts = std::move(parts)](int joint, Index frame) {
    const int track = newest_track(tracks, static_cast<double>(frame) / fps, parts[static_cast<std::size_t>(joint)]);
    return track < 0 ? side_colours[0] : text_colours[static_cast<std::size_t>(track) % text_colours.size()];
  };
}

/// Lays the picture out and draws it on a surface; the y axis points down.
class FilmStrip {
 public:
  FilmStrip(const Motion& motion, std::span<const Track> tracks, const FilmStripOptions& options)
      : motion_(motion),
        tracks_(tracks),
        options_(options),
        figure_(motion, strip_paint(motion, tracks, options.colours)),
        last_(static_cast<double>(motion.frames() - 1) / motion.fps) {
    choose_poses();
    make_rows();
  }

  double height() const { return rows_.back().bottom + 8; }
  std::string title() const { return options_.title.empty() ? motion_.name : options_.title; }

  template <class Surface>
  void draw(Surface& on) const {
    legend(on);
    for (const Row& row : rows_) {
      backdrop(on, row);
      path(on, row);
      for (int i = row.first; i < row.end; ++i)
        figure_.pose(on, frame_of(i), {x_of(row, place_of(i)), floor_y(row, frame_of(i))}, scale_);
      time_labels(on, row);
      track_lines(on, row);
    }
  }

 private:
  static constexpr double margin = 24, header = 44, line = 26, bar = 20, gap = 22;
  static constexpr int most_in_row = 12, most_rows = 4, fewest = 3;

  /// Poses from `first` up to `end` side by side, and the part of the tracks below them. Places are numbers of poses:
  /// 1.5 is halfway between the poses 1 and 2.
  struct Row {
    int first = 0, end = 0;
    double low = 0, high = 0;               // its part of the time, as places
    double nearest = 0, farthest = 0;       // depth of the root
    double top = 0, floor = 0, labels = 0;  // y: of the row, of the nearest root's floor, of the time labels
    double depth_scale = 1;                 // pixels for a metre of depth of the floor
    double tracks_top = 0, bottom = 0;      // y
    std::vector<std::size_t> tracks{};      // those that are shown
  };

  /// Beyond 18 wished poses, the motion takes as many rows as it fills with twelve.
  void choose_poses() {
    const int in_row = std::clamp(static_cast<int>((options_.width - 2 * margin) / 90), fewest, most_in_row);
    const double needed =
        options_.poses > 0 ? options_.poses : std::max(fewest + 0.0, 1 + way_of_joints(motion_) / 0.25);
    double rows = std::clamp(std::round(needed / in_row), 1.0, most_rows + 0.0);
    if (options_.poses > 0) rows = std::ceil(needed / most_in_row);
    const double fitting = options_.poses > 0 ? needed : std::min(needed, rows * in_row);
    poses_ = static_cast<int>(std::min(std::round(fitting), static_cast<double>(motion_.frames())));
    rows_.resize(std::min(static_cast<std::size_t>(rows), static_cast<std::size_t>(poses_)));
    columns_ = (poses_ + static_cast<int>(rows_.size()) - 1) / static_cast<int>(rows_.size());
    rows_.resize(static_cast<std::size_t>((poses_ + columns_ - 1) / columns_));
    cell_ = (options_.width - 2 * margin) / columns_;
  }

  double time_of(double place) const { return poses_ > 1 ? last_ * place / (poses_ - 1) : 0; }
  Index frame_of(int i) const { return static_cast<Index>(std::lround(time_of(i) * motion_.fps)); }
  static double place_of(int i) { return static_cast<double>(i); }
  double place_at(double time) const { return last_ > 0 ? std::clamp(time / last_, 0.0, 1.0) * (poses_ - 1) : 0; }
  /// The x axis is time: the first pose stands in the middle of the first cell.
  double x_of(const Row& row, double place) const {
    return margin + cell_ / 2 + (std::clamp(place, row.low, row.high) - row.first) * cell_;
  }
  /// The height of the floor below the root of a frame.
  double floor_y(const Row& row, Index frame) const {
    return row.floor - (figure_.depth_of_root(frame) - row.nearest) * figure_.view().sine * row.depth_scale;
  }

  /// Chooses the scale so that figures fit into their cells, and the places of the floor and of everything below it.
  void make_rows() {
    double half_width = 0.2 * figure_.size();
    for (int i = 0; i < poses_; ++i) half_width = std::max(half_width, figure_.half_width(frame_of(i)));
    const double tallest_figure = 300 / figure_.size(), tallest_picture = 420 / figure_.reach();
    scale_ = std::min({1.25 * cell_ / (2 * half_width), tallest_figure, tallest_picture});
    double top = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Row& row = rows_[i];
      row.first = static_cast<int>(i) * columns_;
      row.end = std::min(poses_, row.first + columns_);
      row.low = i == 0 ? 0 : row.first - 0.5;
      row.high = row.end == poses_ ? poses_ - 1 : row.end - 0.5;
      row.top = top;
      measure(row);
      top = row.bottom + gap;
    }
  }
  void measure(Row& row) const {
    row.nearest = row.farthest = figure_.depth_of_root(frame_of(row.first));
    for (Index frame = first_frame(row); frame < end_frame(row); ++frame) {
      row.nearest = std::min(row.nearest, figure_.depth_of_root(frame));
      row.farthest = std::max(row.farthest, figure_.depth_of_root(frame));
    }
    const double depth = (row.farthest - row.nearest) * figure_.view().sine, tallest = 0.45 * figure_.size();
    row.depth_scale = depth > tallest ? scale_ * tallest / depth : scale_;
    const double head = row.top > 0 ? 0 : header;
    row.floor = row.top + head + figure_.reach() * figure_.view().cosine * scale_ + depth * row.depth_scale +
                0.08 * figure_.size() * scale_;
    row.labels = row.floor + 0.16 * figure_.size() * scale_ + 14;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      if (rows_.size() == 1 || is_seen(tracks_[i], row)) row.tracks.push_back(i);
    }
    row.tracks_top = row.labels + (row.tracks.empty() ? 4 : 14);
    row.bottom = row.tracks_top + line * static_cast<double>(row.tracks.size()) + (row.tracks.empty() ? 0 : 10);
  }
  /// True if a row shows a third of a pose of a track, or all of it.
  bool is_seen(const Track& track, const Row& row) const {
    const double start = place_at(track.start), end = place_at(track.end);
    const bool inside = start >= row.low && end <= row.high;
    return inside || std::min(end, row.high) - std::max(start, row.low) > 0.3;
  }
  Index first_frame(const Row& row) const { return static_cast<Index>(std::ceil(time_of(row.low) * motion_.fps)); }
  Index end_frame(const Row& row) const {
    const auto end = static_cast<Index>(std::floor(time_of(row.high) * motion_.fps + 1e-6)) + 1;
    return std::min(end, motion_.frames());
  }

  template <class Surface>
  void legend(Surface& on) const {
    on.text({margin, 28}, title(), TextRole::title, TextAnchor::start);
    if (options_.colours != StripColours::sides) return;
    for (const auto& [side, name, x] :
         {std::tuple{Side::left, "left", 104.0}, std::tuple{Side::right, "right", 52.0}}) {
      on.disc({options_.width - x, 23}, 5, side_colours[static_cast<std::size_t>(side)]);
      on.text({options_.width - x + 9, 27}, name, TextRole::small, TextAnchor::start);
    }
  }
  template <class Surface>
  void backdrop(Surface& on, const Row& row) const {
    const double rise = (row.farthest - row.nearest) * figure_.view().sine * row.depth_scale;
    const double top = row.floor - rise - 34, bottom = row.labels - 18;
    on.floor(top, bottom - top);
  }

  /// The path of the root over the floor, as its shadow line.
  template <class Surface>
  void path(Surface& on, const Row& row) const {
    std::vector<Point2> points;
    const Index step = std::max<Index>(1, (end_frame(row) - first_frame(row)) / 400);
    for (Index frame = first_frame(row); frame < end_frame(row); frame += step)
      points.push_back({x_of(row, place_at(static_cast<double>(frame) / motion_.fps)), floor_y(row, frame)});
    on.dotted_line(points);
  }

  template <class Surface>
  void time_labels(Surface& on, const Row& row) const {
    for (int i = row.first; i < row.end; ++i) {
      const double x = x_of(row, place_of(i));
      if (!row.tracks.empty())
        on.guide(x, row.labels + 6, row.tracks_top + line * static_cast<double>(row.tracks.size()));
      on.text({x, row.labels}, fixed(static_cast<double>(frame_of(i)) / motion_.fps, 2) + " s", TextRole::usual,
              TextAnchor::middle);
    }
  }

  /// A bar for every text, with the text in it or, if it is too long, beside it.
  template <class Surface>
  void track_lines(Surface& on, const Row& row) const {
    for (std::size_t i = 0; i < row.tracks.size(); ++i) {
      const Track& track = tracks_[row.tracks[i]];
      const double x = x_of(row, place_at(track.start));
      const double width = std::max(3.0, x_of(row, place_at(track.end)) - x);
      const double y = row.tracks_top + line * static_cast<double>(i) + (line - bar) / 2;
      std::string parts;
      for (const std::string& p : track.parts) parts += (parts.empty() ? " \u00B7 " : ", ") + p;
      const double letters = 6.6 * static_cast<double>(track.text.size() + parts.size());
      const bool inside = letters + 16 < width;
      const bool after = !inside && x + width + letters + 12 < options_.width;
      const double text_x = inside ? x + 8 : after ? x + width + 6 : x - 6;
      on.bar({x, y}, width, bar, text_colours[row.tracks[i] % text_colours.size()]);
      on.text({text_x, y + 14.5}, track.text, inside ? TextRole::bar : TextRole::usual,
              inside || after ? TextAnchor::start : TextAnchor::end, parts);
    }
  }

  const Motion& motion_;
  std::span<const Track> tracks_;
  const FilmStripOptions& options_;
  FigureDrawing figure_;
  double last_;  // time of the last frame
  int poses_ = 1, columns_ = 1;
  double cell_ = 0, scale_ = 1;  // pixels per cell, per metre
  std::vector<Row> rows_;
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
