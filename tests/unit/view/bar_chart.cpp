// Bars as a picture: widths, stacks, intervals, and round marks of axes.
#include <motionlang/view/bar_chart.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include <motionlang/core/error.hpp>
#include <motionlang/view/detail/plot_axes.hpp>

#include "../../support/markup.hpp"

namespace ml = motionlang;

namespace {

/// A number after the last place of a word before it.
std::vector<double> numbers_after(const std::string& svg, const std::string& tag, const std::string& word) {
  std::vector<double> out;
  for (std::size_t at = svg.find(tag); at != svg.npos; at = svg.find(tag, at + 1))
    out.push_back(std::stod(svg.substr(svg.find(word, at) + word.size())));
  return out;
}

}  // namespace

TEST_CASE("widths are in proportion; stacked bars continue each other") {
  ml::BarChart chart{.title = "Votes & <ties>",
                     .series = {"ours", "tie", "theirs"},
                     .groups = {{"realism", {50, 20, 30}, 0, 0}, {"text", {25, 25, 50}, 40, 60}},
                     .stacked = true,
                     .mark = 50};
  const std::string svg = ml::bar_chart_svg(chart);
  CHECK(is_well_formed(svg));
  CHECK(svg.find("Votes &amp; &lt;ties&gt;") != svg.npos);
  const auto x = numbers_after(svg, "<rect class='bar'", " x='"),
             width = numbers_after(svg, "<rect class='bar'", "width='");
  REQUIRE(width.size() == 6);
  CHECK(width[0] == doctest::Approx(2.5 * width[1]));
  CHECK(x[1] == doctest::Approx(x[0] + width[0]));
  CHECK(x[2] == doctest::Approx(x[1] + width[1]));
  CHECK(x[2] + width[2] == doctest::Approx(x[5] + width[5]));  // both groups are 100
  CHECK(occurrences(svg, "class='interval'") == 1);
  CHECK(occurrences(svg, "stroke-dasharray") == 1);
  chart.stacked = false;
  const std::string beside = ml::bar_chart_svg(chart);
  const auto start = numbers_after(beside, "<rect class='bar'", " x='");
  CHECK(start[0] == start[2]);
  CHECK(numbers_after(beside, "<rect class='bar'", " y='")[1] > numbers_after(beside, "<rect class='bar'", " y='")[0]);
  chart.groups[0].values.pop_back();
  CHECK_THROWS_WITH_AS(ml::bar_chart_svg(chart), doctest::Contains("'realism' has 2 values for 3 series"),
                       ml::config_error);
  chart.groups[0].values = {1, 1, -1};
  CHECK_THROWS_WITH_AS(ml::bar_chart_svg(chart), doctest::Contains("the value -1"), ml::config_error);
  CHECK(is_well_formed(ml::bar_chart_svg({.title = "none", .series = {}, .groups = {}})));
}

TEST_CASE("marks of an axis are round and lie in its range") {
  CHECK(ml::detail::plot_ticks(0, 1) == std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1});
  for (const auto& [low, high] : {std::pair{40.0, 120.0}, {-3.0, 17.5}, {0.001, 0.0042}, {12345.0, 99999.0}}) {
    const auto ticks = ml::detail::plot_ticks(low, high);
    CHECK((ticks.size() >= 4 && ticks.size() <= 11));
    for (const double t : ticks) CHECK((t >= low - 1e-9 && t <= high + 1e-9));
  }
  CHECK(ml::detail::plot_ticks(3, 3) == std::vector<double>{3});
  CHECK(ml::detail::plot_ticks(0, std::numeric_limits<double>::infinity()).size() == 1);
}

TEST_CASE("an axis of huge values has few marks, each once") {
  for (const double low : {1e17, -1e17}) {
    const double high = low + 32;  // three doubles farther
    const auto ticks = ml::detail::plot_ticks(low, high);
    CHECK((!ticks.empty() && ticks.size() <= 3));
    for (std::size_t i = 1; i < ticks.size(); ++i) CHECK(ticks[i] > ticks[i - 1]);
    for (const double t : ticks) CHECK((t >= low && t <= high));
  }
}
