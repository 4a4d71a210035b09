// Timelines as a picture: texts over time, and the text of each body part.
#include <motionlang/view/timeline_picture.hpp>

#include <doctest/doctest.h>

#include <vector>

#include <motionlang/compose/timeline_text.hpp>

#include "../../support/markup.hpp"

namespace ml = motionlang;

TEST_CASE("bars of texts and of body parts") {
  const std::vector<ml::Timeline> one{
      ml::parse_timeline("walk & turn # 0 # 6 # legs\nraise both arms # 2 # 5 # left arm # right arm\n")};
  const std::string svg = ml::timelines_svg(one, 20);
  CHECK(is_well_formed(svg));
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(svg.find(">walk &amp; turn</text>") != std::string::npos);
  for (const char* part : {"left arm", "right arm", "legs", "head", "spine"})
    CHECK_MESSAGE(svg.find(std::string(">") + part + "</text>") != std::string::npos, part);
  // The walk has its own bar, three parts all the time, and two parts before and after the arms are raised.
  CHECK(occurrences(svg, "fill=\"#2b6cb0\"") == 1 + 3 + 4);
  CHECK(occurrences(svg, "fill=\"#b4531a\"") == 1 + 2);
  CHECK(svg.find(">6 s</text>") != std::string::npos);
  // A gap moves freely: five grey bars.
  const std::vector<ml::Timeline> gap{ml::parse_timeline("walk # 0 # 1\nrun # 2 # 3\n")};
  CHECK(occurrences(ml::timelines_svg(gap, 20), "fill=\"#dde2e8\"") == 5);

  const std::vector<ml::Timeline> two{one[0], gap[0]};
  const auto height = [](const std::string& s) { return std::stod(s.substr(s.find(" height=\"") + 9)); };
  CHECK(height(ml::timelines_svg(two, 20)) ==
        doctest::Approx(height(svg) + height(ml::timelines_svg(gap, 20)) - 8).epsilon(1e-6));
}

TEST_CASE("a timeline picture needs a timeline and a rate") {
  CHECK_THROWS_WITH_AS(ml::timelines_svg({}, 20), doctest::Contains("no timeline"), ml::config_error);
  const std::vector<ml::Timeline> one{ml::parse_timeline("walk # 0 # 1\n")};
  CHECK_THROWS_WITH_AS(ml::timelines_svg(one, 0), doctest::Contains("frame rate 0"), ml::config_error);
}
