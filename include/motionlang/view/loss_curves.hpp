// SPDX-License-Identifier: MIT
/// Curves as a picture: losses of a training run, or the values of a table.
///
///     write_file("figure.svg", curves_svg(parse_curves("duration\tfixed\tvariable\n40\t85\t88\n60\t91\t91\n")));
#pragma once

#include <span>         // values
#include <string>       // names
#include <string_view>  // tables
#include <utility>      // pair
#include <vector>       // curves

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Values over the steps of a run, left to right.
struct Curve {
  std::string name;
  std::vector<double> steps, values;
};
/// Curves over the same steps. Heights of losses are logarithmic if no value is negative and the largest is more than
/// ten times the smallest that is not 0. Zeros then lie at the bottom.
struct CurvePanel {
  std::string title;
  std::vector<Curve> curves;
  std::string axis{};  // of the steps: "frames"; "": steps of a training. Another axis has marks, and linear heights
  std::vector<std::pair<double, double>> shaded{};  // ranges of the axis behind the curves: "here is the truth"
  std::vector<double> marks{};                      // dashed lines across the curves
};

/// The values of the steps after the first `before` steps, as the means of at most 200 groups of neighbouring steps.
Curve curve_of_steps(std::string name, std::span<const float> values, std::size_t before = 0);

/// Panels below each other, as SVG. Beside each panel are the names of its curves, with their last values. Values and
/// steps that are not finite are left out.
std::string curves_svg(std::span<const CurvePanel> panels);

/// The panels of a table of text. Cells are separated by tabs or by two or more blanks. The first line has the name of
/// the axis and the names of the curves. Each other line has a step and the values of the curves, "-" for none. A line
/// that starts with # is the title of the next panel. An empty line ends a panel.
/// rows     the first line has the name of the curves and the steps; each other line has the name and values of a curve
/// Throws   io_error 403 with name and line for another number of cells, a cell that is not a number, and a step that
///          is not finite; config_error 101 without any panel
std::vector<CurvePanel> parse_curves(std::string_view table, bool rows = false, std::string_view name = "table");

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/loss_curves.ipp>
#endif
