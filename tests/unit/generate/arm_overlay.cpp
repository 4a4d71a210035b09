// Arms that a collage loses.
#include <motionlang/generate/arm_overlay.hpp>

#include <doctest/doctest.h>

#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using ml::BodyPart;

namespace {

constexpr auto arms = ml::BodyParts{}.with(BodyPart::left_arm).with(BodyPart::right_arm);
constexpr auto right = ml::BodyParts{}.with(BodyPart::right_arm);

/// A figure that stands and raises its right arm to a share of the way.
ml::Motion raising(double share, int frames = 40) {
  const auto stand = synthetic::walk({.frames = 1});
  ml::Motion m = stand;
  for (int f = 1; f < frames; ++f) {
    m.root.push_back(stand.root[0]);
    m.local.insert(m.local.end(), stand.local.begin(), stand.local.end());
    m.rotations(f)[17] = synthetic::about_z(share * 2.4 * f / frames) * m.rotations(f)[17];
  }
  return m;
}

}  // namespace

TEST_CASE("texts of arms, while another text has the legs") {
  const ml::Timeline timeline{
      {{"sit down", 0, 80, ml::BodyParts::all()}, {"raise both arms", 20, 60, arms}, {"wave", 40, 80, right}}};
  const auto texts = ml::arm_texts(timeline, 10);
  REQUIRE(texts.size() == 3);
  CHECK((texts[0].arm == BodyPart::left_arm && texts[1].arm == BodyPart::right_arm &&
         texts[2].arm == BodyPart::right_arm));
  CHECK(texts[0].start == 20);
  CHECK(texts[0].alone.intervals[0].text == "raise both arms");
  CHECK(texts[0].alone.end() == 40);
  CHECK(std::count(texts[0].on.begin(), texts[0].on.end(), 1) == 40);
  CHECK(std::count(texts[1].on.begin(), texts[1].on.end(), 1) == 20);  // then the other text has it
  CHECK(ml::arm_texts(timeline, 30).size() == 2);
  CHECK(ml::arm_texts({{{"raise both arms", 0, 80, arms}}}, 10).empty());  // it has the legs, too
  CHECK(ml::arm_texts({{{"sit down", 0, 80, ml::BodyParts::all()}}}, 10).empty());
}

TEST_CASE("an arm is lost where it comes less far than alone; it is laid over where it is the text's") {
  const ml::Timeline timeline{{{"stand", 0, 80, ml::BodyParts::all()}, {"raise the right arm", 20, 60, right}}};
  const auto text = ml::arm_texts(timeline, 10).at(0);
  const auto alone = raising(1), collage = raising(0, 80);
  CHECK(ml::arm_extent(alone, BodyPart::right_arm, text.on) > 0.3);
  CHECK(ml::is_arm_lost(collage, alone, text));
  CHECK(ml::is_arm_lost(raising(0.5, 80), alone, text));
  CHECK_FALSE(ml::is_arm_lost(raising(2, 80), alone, text));
  const auto laid = ml::lay_arm_over(collage, alone, text);
  CHECK(laid.root == collage.root);
  for (ml::Index f = 0; f < 80; ++f) {
    for (std::size_t j = 0; j < 24; ++j) {
      const bool arm = ml::smpl_part_of_joint[j] == BodyPart::right_arm && f >= 20 && f < 60;
      if (!arm) CHECK(laid.rotations(f)[j] == collage.rotations(f)[j]);
    }
  }
  CHECK(laid.rotations(40)[17] == alone.rotations(20)[17]);
  CHECK_FALSE(laid.rotations(58)[17] == alone.rotations(38)[17]);  // the arm goes back
}
