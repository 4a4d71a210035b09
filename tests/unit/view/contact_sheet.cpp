// Many motions as one picture, and the frames whose poses differ most.
#include <motionlang/view/contact_sheet.hpp>

#include <doctest/doctest.h>

#include <cmath>

#include "../../support/markup.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

/// Stands, with the right arm up in the frames 20 to 24 and the left leg ahead in the frames 40 to 44.
ml::Motion arm_then_leg() {
  const ml::Motion stand = synthetic::walk({.frames = 1});
  ml::Motion out = stand;
  for (int frame = 1; frame < 50; ++frame) {
    out.root.push_back(stand.root[0]);
    out.local.insert(out.local.end(), stand.local.begin(), stand.local.end());
  }
  const auto at = [&](ml::Index frame, const char* joint) -> ml::Quaternion<double>& {
    return out.rotations(frame)[static_cast<std::size_t>(out.skeleton[joint])];
  };
  for (ml::Index frame = 20; frame < 25; ++frame) at(frame, "right_shoulder") = synthetic::about_z(-1.3);
  for (ml::Index frame = 40; frame < 45; ++frame) at(frame, "left_hip") = synthetic::about_x(-0.9);
  return out;
}

}  // namespace

TEST_CASE("key frames are those that differ most, in the order of time") {
  const ml::Motion motion = arm_then_leg();
  const auto three = ml::key_frames(motion, 3);
  REQUIRE(three.size() == 3);
  int arm = 0, leg = 0;
  for (const ml::Index f : three) arm += f >= 20 && f < 25, leg += f >= 40 && f < 45;
  CHECK(arm == 1);
  CHECK(leg == 1);
  CHECK((three[0] < three[1] && three[1] < three[2]));
  // The place on the floor does not matter: a statue that is carried has no pose that differs.
  ml::Motion carried = motion;
  for (ml::Index f = 0; f < carried.frames(); ++f)
    carried.root[static_cast<std::size_t>(f)].x = 0.3 * static_cast<double>(f);
  CHECK(ml::key_frames(carried, 3) == three);
  CHECK(ml::key_frames(motion, 0).empty());
  CHECK(ml::key_frames(synthetic::walk({.frames = 2}), 5) == std::vector<ml::Index>{0, 1});
  const ml::Motion still = synthetic::walk({.frames = 1});
  ml::Motion statue = still;
  statue.root.push_back(still.root[0]);
  statue.local.insert(statue.local.end(), still.local.begin(), still.local.end());
  CHECK(ml::key_frames(statue, 2) == std::vector<ml::Index>{0, 1});
}

TEST_CASE("a cell for each motion, with its poses and its caption") {
  const ml::Motion walk = synthetic::walk({.frames = 40}), move = arm_then_leg();
  const std::vector<ml::SheetEntry> entries{{walk, "walk & <run>"}, {move, "raise"}, {walk, "walk again"}};
  const ml::ContactSheetOptions options{.columns = 2, .poses = 3, .width = 640, .title = "Two by two"};
  const std::string svg = ml::contact_sheet_svg(entries, options);
  CHECK(is_well_formed(svg));
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(occurrences(svg, "class=\"pose\"") == 9);
  CHECK(occurrences(svg, "url(#floor)") == 3);
  CHECK(svg.find(">walk &amp; &lt;run&gt;</text>") != std::string::npos);
  CHECK(occurrences(svg, "Two by two") == 2);  // title of the file, and letters
  // The second row makes it higher.
  const auto height = [](const std::string& s) { return std::stod(s.substr(s.find(" height=\"") + 9)); };
  const double one = height(ml::contact_sheet_svg(std::span(entries).first(2), options)), two = height(svg);
  CHECK((two > one + 100 && two < 2 * one));

  const ml::Picture picture = ml::contact_sheet_picture(entries, options);
  CHECK(picture.width == 960);
  CHECK(picture.height == static_cast<ml::Index>(std::ceil(1.5 * two)));
  // Figures in the three cells, none in the fourth.
  const auto coloured = [&](bool right, bool below) {
    int n = 0;
    for (ml::Index y = 0; y < picture.height; ++y) {
      for (ml::Index x = 0; x < picture.width; ++x) {
        const auto* p = &picture.rgb[static_cast<std::size_t>(3 * (y * picture.width + x))];
        n += (x > picture.width / 2) == right && (y > picture.height / 2) == below && p[0] == 230 && p[1] == 97;
      }
    }
    return n;
  };
  CHECK(coloured(false, false) > 100);
  CHECK(coloured(true, false) > 100);
  CHECK(coloured(false, true) > 100);
  CHECK(coloured(true, true) == 0);
}

TEST_CASE("what cannot be drawn on a contact sheet is an error") {
  const ml::Motion walk = synthetic::walk({.frames = 3});
  const std::vector<ml::SheetEntry> one{{walk, "walk"}};
  const auto refused = [&](const ml::ContactSheetOptions& options) {
    CHECK_THROWS_WITH_AS(ml::contact_sheet_svg(one, options), doctest::Contains("contact sheet: "), ml::config_error);
  };
  refused({.columns = 0});
  refused({.poses = 0});
  refused({.columns = 20, .width = 1000});
  refused({.width = INFINITY});
  CHECK_THROWS_WITH_AS(ml::contact_sheet_svg({}), doctest::Contains("no motion to show"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::contact_sheet_picture(one, {.resolution = 0}), doctest::Contains("pixels each"),
                       ml::config_error);
  ml::Motion empty = walk;
  empty.root.clear(), empty.local.clear();
  const std::vector<ml::SheetEntry> none{{empty, "none"}};
  CHECK_THROWS_WITH_AS(ml::contact_sheet_svg(none), doctest::Contains("has no frames"), ml::config_error);
}
