// Curves of a training run as a picture.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace program {

/// Values over the steps of a run, left to right.
struct Curve {
  std::string name;
  std::vector<double> steps, values;
};
/// Curves over the same steps. Heights are logarithmic where every value is positive and the largest is more than ten
/// times the smallest.
struct CurvePanel {
  std::string title;
  std::vector<Curve> curves;
};

/// The value of every step, as the means of at most 200 groups of neighbouring steps.
Curve curve_of_steps(std::string name, std::span<const float> values);

/// Panels below each other, as SVG. Values that are not finite are left out.
std::string curves_svg(std::span<const CurvePanel> panels);

}  // namespace program
