// The similarity of texts and a motion as curves.
#include <motionlang/view/similarity_picture.hpp>

#include <doctest/doctest.h>

#include "../../support/speed_encoder.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

TEST_CASE("a panel for each text: a curve over the seconds, the truth, and a mark at the best frame") {
  ml::Motion motion = synthetic::walk({.frames = 41, .fps = 20});
  for (int f = 0; f < 41; ++f)  // stands for a second, then walks
    motion.root[static_cast<std::size_t>(f)] = {f < 21 ? 0.0 : 0.1 * (f - 20), 1, 0};
  const SpeedEncoder encoder;
  const std::vector<ml::TextToLocate> texts{{"walk 2", std::pair(1.0, 2.0)}, {"walk 0"}};
  const auto picture = ml::similarity_picture(encoder, texts, motion, 0.2);
  REQUIRE(picture.panels.size() == 2);
  const ml::CurvePanel& walk = picture.panels[0];
  CHECK(walk.title == "walk 2");
  CHECK(walk.axis == "seconds");
  REQUIRE(walk.curves.size() == 1);
  CHECK(walk.curves[0].values.size() == 40);
  CHECK(walk.curves[0].steps.back() == doctest::Approx(39.0 / 20));
  CHECK(walk.shaded == std::vector<std::pair<double, double>>{{1, 2}});
  REQUIRE(walk.marks.size() == 1);
  CHECK(walk.marks[0] >= 1);
  CHECK(picture.panels[1].shaded.empty());
  CHECK(picture.panels[1].marks[0] == 0);
  CHECK(picture.about.find("walk 0                                   0.00 s, similarity 1.000\n") != std::string::npos);
}
