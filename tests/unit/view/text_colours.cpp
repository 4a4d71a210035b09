// The text that a joint follows, and film strips in the colours of texts.
#include <motionlang/view/text_colours.hpp>

#include <doctest/doctest.h>

#include <map>

#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/view/film_strip.hpp>

#include "../../support/markup.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

TEST_CASE("parts of joints by their names are those of SMPL and KIT") {
  const auto& smpl = ml::smpl24_skeleton();
  const auto parts = ml::parts_of_joints(smpl);
  for (int j = 0; j < smpl.size(); ++j)
    CHECK_MESSAGE(
        parts[static_cast<std::size_t>(j)] == ml::to_string(ml::smpl_part_of_joint[static_cast<std::size_t>(j)]),
        smpl.name(j));
  const auto kit = ml::parts_of_joints(ml::kit21_skeleton());
  for (std::size_t j = 0; j < kit.size(); ++j) CHECK(kit[j] == ml::to_string(ml::kit_part_of_joint[j]));
  const auto mixamo =
      ml::parts_of_joints(ml::Skeleton::from_joints({{"mixamorig:Hips", "", {0, 1, 0}},
                                                     {"mixamorig:Spine", "mixamorig:Hips", {0, 0.1, 0}},
                                                     {"mixamorig:LeftArm", "mixamorig:Spine", {0.2, 0.4, 0}},
                                                     {"tip", "mixamorig:LeftArm", {0.2, 0, 0}},
                                                     {"mixamorig:RightUpLeg", "mixamorig:Hips", {-0.1, 0, 0}},
                                                     {"rod", "mixamorig:Hips", {0, 0, 0.1}}}));
  CHECK(mixamo == std::vector<std::string>{"legs", "spine", "left arm", "left arm", "legs", "spine"});
}

TEST_CASE("the newest text wins, for the body or for a part") {
  const std::vector<ml::Track> tracks{
      {"walk", 0, 6, {ml::whole_body}}, {"wave", 2, 5, {"left arm"}}, {"nod", 2, 3, {"head"}}, {"stand", 8, 9}};
  CHECK(ml::newest_track(tracks, 1) == 0);
  CHECK(ml::newest_track(tracks, 2) == 2);  // both start now: the last in the list
  CHECK(ml::newest_track(tracks, 3) == 1);  // the end of "nod" is not in it
  CHECK(ml::newest_track(tracks, 5.5) == 0);
  CHECK(ml::newest_track(tracks, 7) == -1);
  CHECK(ml::newest_track(tracks, 8.5) == 3);
  CHECK(ml::newest_track(tracks, 2.5, "left arm") == 1);
  CHECK(ml::newest_track(tracks, 2.5, "legs") == 0);
  CHECK(ml::newest_track(tracks, 8.5, "legs") == 3);  // without parts: the whole body
  CHECK(ml::newest_track({}, 0) == -1);
}

TEST_CASE("a film strip in the colours of its texts") {
  const ml::Motion walk = synthetic::walk({.frames = 60});
  const std::vector<ml::Track> tracks{{"walk", 0, 2, {ml::whole_body}}, {"wave", 1, 2, {"left arm"}}};
  const auto strip = [&](ml::StripColours colours) {
    return ml::film_strip_svg(walk, tracks, {.poses = 4, .colours = colours});  // at 0, 1, 2 and 3 s
  };
  // How many pieces have each colour of a text, if no piece is far from the viewer; shades differ a little.
  const std::string sides = strip(ml::StripColours::sides), newest = strip(ml::StripColours::newest_text),
                    parts = strip(ml::StripColours::text_of_part);
  for (const std::string* svg : {&sides, &newest, &parts}) {
    CHECK(is_well_formed(*svg));
    CHECK(occurrences(*svg, "class=\"pose\"") == 4);
  }
  CHECK(occurrences(sides, ">left</text>") == 1);
  CHECK(occurrences(newest, ">left</text>") == 0);  // no legend of sides
  const auto pose = [](const std::string& svg, int number) {
    std::size_t at = 0;
    for (int i = 0; i <= number; ++i) at = svg.find("class=\"pose\"", at + 1);
    return svg.substr(at, svg.find("</g>", at) - at);
  };
  // The trunk stands at the root, so it has the colour itself: of walk at 0 s; of wave at 1 s, or in parts still of
  // walk; of no text at 3 s.
  const std::string walk_colour = "#2b6cb0", wave_colour = "#b4531a", none = "#626c7a";
  CHECK(occurrences(pose(newest, 0), walk_colour) > 0);
  CHECK(occurrences(pose(newest, 1), walk_colour) == 0);
  CHECK(occurrences(pose(newest, 1), wave_colour) > 0);
  CHECK(occurrences(pose(parts, 1), walk_colour) > 0);
  CHECK(occurrences(pose(newest, 3), none) > 0);
  CHECK(occurrences(pose(newest, 3), walk_colour) == 0);
  CHECK(pose(parts, 1) != pose(newest, 1));
}
