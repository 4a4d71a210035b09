// Curves of a training run as a picture.
#include <doctest/doctest.h>

#include <limits>
#include <numeric>

#include <motionlang/view/loss_curves.hpp>

#include "../../support/markup.hpp"

namespace ml = motionlang;

TEST_CASE("neighbouring steps are averaged to at most 200 points, whose last step is the last one") {
  std::vector<float> values(1000);
  std::iota(values.begin(), values.end(), 0.0f);
  const ml::Curve curve = ml::curve_of_steps("loss", values, 50);
  CHECK(curve.name == "loss");
  REQUIRE(curve.values.size() == 200);
  REQUIRE(curve.steps.size() == 200);
  CHECK(curve.values.front() == doctest::Approx(2));   // of 0 to 4
  CHECK(curve.values.back() == doctest::Approx(997));  // of 995 to 999
  CHECK(curve.steps.front() == 53);                    // of 51 to 55
  CHECK(curve.steps.back() == 1048);
  const ml::Curve few = ml::curve_of_steps("few", std::span(values).first(3));
  CHECK(few.values == std::vector<double>{0, 1, 2});
  CHECK(ml::curve_of_steps("none", {}).values.empty());
}

TEST_CASE("a picture names its curves; values that are not finite are left out") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<ml::CurvePanel> panels{{"loss", {{"total", {1, 2, 3}, {100, 10, 0.5}}}},
                                           {"recall", {{"flat", {1, 2, 3}, {nan, -1, 2}}, {"empty", {}, {}}}},
                                           {"later", {}}};
  const std::string svg = ml::curves_svg(panels);
  CHECK(is_well_formed(svg));
  for (const char* text : {"loss (logarithmic)", "total 0.5", ">recall<", "flat 2", "later: no values yet"})
    CHECK_MESSAGE(svg.find(text) != svg.npos, text, " in ", svg);
  CHECK(svg.find("nan") == svg.npos);
  CHECK(is_well_formed(ml::curves_svg({})));
}
