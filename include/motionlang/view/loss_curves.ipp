// SPDX-License-Identifier: MIT
// Bodies of loss_curves.hpp.
#pragma once

#include <algorithm>  // max, min
#include <charconv>   // numbers
#include <cmath>      // isfinite, log10
#include <limits>     // empty ranges

#include <motionlang/core/text_lines.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/detail/plot_axes.hpp>
#include <motionlang/view/loss_curves.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail::curves {

inline constexpr double width = 1000, height = 300, left = 70, right = 250, top = 34, bottom = 34;
struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double x) {
    if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
  }
  double size() const { return std::max(high - low, 1e-12); }
};

/// Marks of both axes, with lines across the panel.
struct PanelScale {
  double x0, x_unit, y0, y_unit;  // pixels: of step 0 and value 0, and for a unit of each; heights grow upwards
};
inline std::string grid_svg(const PanelScale& at, const Range& steps, const Range& values, double top_y) {
  std::string out;
  for (const double t : plot_ticks(steps.low, steps.high)) {
    const double x = at.x0 + t * at.x_unit;
    out += concat_text("<path d='M", x, " ", top_y + top, "V", top_y + height - bottom, "' stroke='#eceff2'/>");
    out += label(x - 6, top_y + height - bottom + 17, number(t));
  }
  for (const double t : plot_ticks(values.low, values.high)) {
    const double y = at.y0 - t * at.y_unit;
    out += concat_text("<path d='M", left, " ", y, "H", width - right, "' stroke='#eceff2'/>");
    out += label(14, y + 4, number(t));
  }
  return out;
}

inline std::string panel_svg(const CurvePanel& panel, double y0) {
  Range steps, values, positive;
  for (const Curve& c : panel.curves) {
    for (std::size_t k = 0; k < c.values.size(); ++k) {
      if (!std::isfinite(c.steps[k])) continue;
      const double v = c.values[k];
      steps.add(c.steps[k]);
      values.add(v);
      if (v > 0) positive.add(v);
    }
  }
  if (!(values.low <= values.high)) return label(left, y0 + top, escape_markup(panel.title) + ": no values yet");
  const bool plain = panel.axis.empty();  // losses over the steps of a training
  const bool logarithmic = plain && values.low >= 0 && values.high > 10 * positive.low;
  if (logarithmic) values = positive;
  auto scaled = [&](double v) { return logarithmic ? std::log10(std::max(v, values.low)) : v; };
  Range shown;
  shown.add(scaled(values.low)), shown.add(scaled(values.high));
  const auto x_of = [&](double step) { return left + (width - left - right) * (step - steps.low) / steps.size(); };
  const double high = height - top - bottom;
  std::string out;
  for (const auto& [from, to] : panel.shaded)
    out += concat_text("<rect class='shaded' x='", x_of(std::max(from, steps.low)), "' y='", y0 + top, "' width='",
                       std::max(0.0, x_of(std::min(to, steps.high)) - x_of(std::max(from, steps.low))), "' height='",
                       high, "' fill='#3a7d44' opacity='0.18'/>");
  if (!plain) {
    const double x_unit = (width - left - right) / steps.size(), y_unit = high / shown.size();
    out += grid_svg({left - steps.low * x_unit, x_unit, y0 + top + shown.high * y_unit, y_unit}, steps, shown, y0);
  }
  out += concat_text("<rect x='", left, "' y='", y0 + top, "' width='", width - left - right, "' height='", high,
                     "' fill='none' stroke='#ddd'/>");
  out += label(left, y0 + 22, escape_markup(panel.title) + (logarithmic ? " (logarithmic)" : ""));
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& c = panel.curves[i];
    std::string points;
    for (std::size_t k = 0; k < c.values.size(); ++k) {
      if (!std::isfinite(c.steps[k]) || !std::isfinite(c.values[k])) continue;
      points +=
          concat_text(x_of(c.steps[k]), ",", y0 + top + high * (shown.high - scaled(c.values[k])) / shown.size(), " ");
    }
    const char* colour = colours[i % colours.size()];
    out += concat_text("<polyline points='", points, "' fill='none' stroke='", colour, "' stroke-width='2'/>");
    const double line = y0 + top + 12 + 20 * static_cast<double>(i);
    const std::string last = plain && !c.values.empty() ? " " + number(c.values.back()) : "";
    out += label(width - right + 12, line, escape_markup(c.name) + last, colour);
  }
  for (const double mark : panel.marks)
    out += concat_text("<path class='mark' d='M", x_of(mark), " ", y0 + top, "v", high,
                       "' stroke='#d1495b' stroke-width='1.5' stroke-dasharray='5 4'/>");
  if (!plain) return out + label(width - right + 12, y0 + height - bottom + 17, escape_markup(panel.axis));
  out += label(4, y0 + top + 12, number(values.high)) + label(4, y0 + height - bottom, number(values.low));
  return out + label(left, y0 + height - 12, "step " + number(steps.low)) +
         label(width - right - 90, y0 + height - 12, "step " + number(steps.high));
}

/// Cells between tabs or between two or more blanks.
inline std::vector<std::string> table_cells(std::string_view line) {
  std::vector<std::string> out(1);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool gap = line[i] == '\t' || line.substr(i, 2) == "  ";
    if (!gap) {
      out.back() += line[i];
      continue;
    }
    while (i + 1 < line.size() && line[i] == ' ' && line[i + 1] == ' ') ++i;
    out.emplace_back();
  }
  for (std::string& cell : out) cell = std::string(trim(cell));
  return out;
}

/// Reads lines into panels.
class CurveTable {
 public:
  CurveTable(std::string_view table, bool rows, std::string_view name) : rows_(rows), name_(name) {
    for_each_line(table, [&](std::string_view line, Index number) {
      if (trim(line).empty()) {
        header_.clear();
      } else if (line.starts_with('#')) {
        title_ = std::string(trim(line.substr(1)));
        header_.clear();
      } else if (header_.empty()) {
        start(table_cells(trim(line)), number);
      } else {
        add(table_cells(trim(line)), number);
      }
    });
    if (out_.empty()) raise<config_error>(101, name_, ": no values to draw");
  }
  std::vector<CurvePanel> panels() && { return std::move(out_); }

 private:
  double value(const std::string& cell, Index line) const {
    if (cell == "-") return std::numeric_limits<double>::quiet_NaN();
    double x = 0;
    const auto end = detail::from_chars(cell.data(), cell.data() + cell.size(), x);
    if (end.ec != std::errc{} || end.ptr != cell.data() + cell.size())
      raise<io_error>(403, name_, ":", line, ": '", cell, "' is not a number");
    return x;
  }
  double step(const std::string& cell, Index line) const {
    const double x = value(cell, line);
    if (!std::isfinite(x)) raise<io_error>(403, name_, ":", line, ": '", cell, "' is not a finite step");
    return x;
  }
  void start(std::vector<std::string> cells, Index line) {
    if (cells.size() < 2) raise<io_error>(403, name_, ":", line, ": one column, where curves need two");
    header_ = std::move(cells);
    CurvePanel panel{.title = std::exchange(title_, {}), .curves = {}, .axis = header_[0]};
    steps_.clear();
    for (std::size_t i = 1; i < header_.size(); ++i) {
      if (rows_)
        steps_.push_back(step(header_[i], line));
      else
        panel.curves.push_back({header_[i], {}, {}});
    }
    out_.push_back(std::move(panel));
  }
  void add(const std::vector<std::string>& cells, Index line) {
    if (cells.size() != header_.size())
      raise<io_error>(403, name_, ":", line, ": ", cells.size(), " cells below ", header_.size(), " names");
    std::vector<Curve>& curves = out_.back().curves;
    if (rows_) curves.push_back({cells[0], steps_, {}});
    for (std::size_t i = 1; i < cells.size(); ++i) {
      Curve& curve = rows_ ? curves.back() : curves[i - 1];
      if (!rows_) curve.steps.push_back(step(cells[0], line));
      curve.values.push_back(value(cells[i], line));
    }
  }

  bool rows_;
  std::string name_, title_;
  std::vector<std::string> header_;
  std::vector<double> steps_;
  std::vector<CurvePanel> out_;
};

}  // namespace detail::curves

MOTIONLANG_BODY Curve curve_of_steps(std::string name, std::span<const float> values, std::size_t before) {
  Curve out{std::move(name), {}, {}};
  const std::size_t groups = std::min<std::size_t>(200, values.size());
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t a = values.size() * g / groups, b = values.size() * (g + 1) / groups;
    double total = 0;
    for (std::size_t i = a; i < b; ++i) total += static_cast<double>(values[i]);
    out.steps.push_back(static_cast<double>(2 * before + a + b + 1) / 2);
    out.values.push_back(total / static_cast<double>(b - a));
  }
  return out;
}

MOTIONLANG_BODY std::vector<CurvePanel> parse_curves(std::string_view table, bool rows, std::string_view name) {
  return detail::curves::CurveTable(table, rows, name).panels();
}

MOTIONLANG_BODY std::string curves_svg(std::span<const CurvePanel> panels) {
  using namespace detail::curves;
  std::string out =
      concat_text("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 ", width, " ",
                  height * static_cast<double>(panels.size()), "'><rect width='100%' height='100%' fill='white'/>");
  for (std::size_t i = 0; i < panels.size(); ++i) out += panel_svg(panels[i], height * static_cast<double>(i));
  return out + "</svg>\n";
}

MOTIONLANG_NAMESPACE_END
