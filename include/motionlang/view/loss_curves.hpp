// SPDX-License-Identifier: MIT
/// Curves of a training run as a picture.
#pragma once

#include <span>    // values
#include <string>  // names
#include <vector>  // curves

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Values over the steps of a run, left to right.
struct Curve {
  std::string name;
  std::vector<double> steps, values;
};
/// Curves over the same steps. Heights are logarithmic if no value is negative and the largest is more than ten times
/// the smallest that is not 0; zeros then lie at the bottom.
struct CurvePanel {
  std::string title;
  std::vector<Curve> curves;
};

/// The values of the steps after the first `before` steps, as the means of at most 200 groups of neighbouring steps.
Curve curve_of_steps(std::string name, std::span<const float> values, std::size_t before = 0);

/// Panels below each other, as SVG. Beside each panel are the names of its curves, with their last values. Values that
/// are not finite are left out.
std::string curves_svg(std::span<const CurvePanel> panels);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/loss_curves.ipp>
#endif
