// Curves of a training run as a picture.
#include <doctest/doctest.h>

#include <cmath>
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

TEST_CASE("steps that are not finite are left out of a picture") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const ml::Curve curve{"a", {1, nan, 2, infinite}, {3, 900, 4, 5000}};
  for (const char* axis : {"", "frames"}) {
    const std::vector<ml::CurvePanel> panels{{.title = "all", .curves = {curve}, .axis = axis},
                                             {.title = "none", .curves = {{"b", {nan}, {1}}}, .axis = axis}};
    const std::string svg = ml::curves_svg(panels);
    CHECK(is_well_formed(svg));
    CHECK(svg.find("nan") == svg.npos);
    CHECK(svg.find("inf") == svg.npos);
    CHECK(svg.find("(logarithmic)") == svg.npos);  // their values do not count either
    CHECK(svg.find("none: no values yet") != svg.npos);
  }
}

TEST_CASE("curves of a table: columns or rows, titles, and what is missing") {
  const auto panels = ml::parse_curves(
      "# accuracy & more\nframes\tfixed\tvariable\n40\t85.5\t88\n60\t91\t-\n\nframes  FID of all\n40  3.5\n60  "
      "-1e-2\n");
  REQUIRE(panels.size() == 2);
  CHECK(panels[0].title == "accuracy & more");
  CHECK(panels[0].axis == "frames");
  REQUIRE(panels[0].curves.size() == 2);
  CHECK(panels[0].curves[0].name == "fixed");
  CHECK(panels[0].curves[0].steps == std::vector<double>{40, 60});
  CHECK(panels[0].curves[0].values == std::vector<double>{85.5, 91});
  CHECK(std::isnan(panels[0].curves[1].values[1]));
  CHECK(panels[1].title.empty());
  CHECK(panels[1].curves[0].name == "FID of all");
  CHECK(panels[1].curves[0].values == std::vector<double>{3.5, -0.01});
  // As `evaluate --moments` prints it: each line is a curve.
  const auto rows =
      ml::parse_curves("  windows      0.3     0.4\n  1 s          17.50   9.00\n  all lengths  20   -\n", true);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].axis == "windows");
  REQUIRE(rows[0].curves.size() == 2);
  CHECK(rows[0].curves[0].name == "1 s");
  CHECK(rows[0].curves[1].steps == std::vector<double>{0.3, 0.4});
  const auto refused = [](const char* table, const char* why, bool by_row = false) {
    CHECK_THROWS_WITH(ml::parse_curves(table, by_row, "t.tsv"), doctest::Contains(why));
  };
  refused("", "t.tsv: no values");
  refused("frames\n1\n", "t.tsv:1: one column");
  refused("frames\ta\n1\t2\t3\n", "t.tsv:2: 3 cells below 2 names");
  refused("frames\ta\n1\tx\n", "t.tsv:2: 'x' is not a number");
  refused("frames\ta\n", "t.tsv:1: 'a' is not a number", true);
  for (const std::string step : {"-", "nan", "inf"}) {
    refused(("frames\ta\n" + step + "\t1\n").c_str(), ("t.tsv:2: '" + step + "' is not a finite step").c_str());
    refused(("frames\t" + step + "\na\t1\n").c_str(), ("t.tsv:1: '" + step + "' is not a finite step").c_str(), true);
  }
}

TEST_CASE("a panel with an axis has marks, ranges and dashed lines, and linear heights") {
  ml::CurvePanel panel{.title = "sit <down>", .curves = {{"similarity", {0, 1, 2, 3, 4}, {0.001, 0.1, 0.9, 0.2, 0}}}};
  const std::vector<ml::CurvePanel> plain{panel};
  CHECK(ml::curves_svg(plain).find("(logarithmic)") != std::string::npos);
  panel.axis = "seconds";
  panel.shaded = {{1.5, 99}};
  panel.marks = {2};
  const std::vector<ml::CurvePanel> panels{panel};
  const std::string svg = ml::curves_svg(panels);
  CHECK(is_well_formed(svg));
  CHECK(svg.find("(logarithmic)") == std::string::npos);
  CHECK(svg.find("sit &lt;down&gt;") != std::string::npos);
  CHECK(svg.find(">seconds<") != std::string::npos);
  CHECK(occurrences(svg, "class='shaded'") == 1);
  CHECK(occurrences(svg, "class='mark'") == 1);
  // The dashed line is at the highest point of the curve, and the range ends with the panel.
  const auto number_at = [&](const char* tag, const char* word) {
    const std::size_t at = svg.find(word, svg.find(tag)) + std::string(word).size();
    return std::stod(svg.substr(at));
  };
  CHECK(number_at("class='mark'", "d='M") == doctest::Approx(70 + 680 * 0.5));
  CHECK(number_at("class='shaded'", " x='") == doctest::Approx(70 + 680 * 1.5 / 4));
  CHECK(number_at("class='shaded'", "width='") == doctest::Approx(680 * 2.5 / 4));
}
