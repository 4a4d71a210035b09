#include <motionlang/generate/babel_latents.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::BodyParts;

TEST_CASE("texts one after the other, by their start; texts at the same time as one sentence") {
  const ml::Timeline apart{{{"sit", 20, 30, BodyParts::all()}, {"walk", 0, 20, BodyParts::all()}}};
  const auto sorted = ml::detail::texts_in_order(apart);
  REQUIRE(sorted.size() == 2);
  CHECK((sorted[0].text == "walk" && sorted[1].text == "sit"));
  const ml::Timeline together{{{"walk", 0, 20, BodyParts::all()}, {"wave", 5, 30, BodyParts::all()}}};
  CHECK_ERROR(
      ml::detail::texts_in_order(together),
      "[motionlang.timeline.509] 'walk' and 'wave' overlap; this model (TEACH) takes texts one after the other");
  const ml::Interval one = ml::detail::texts_together(together);
  CHECK((one.start == 0 && one.end == 30 && one.parts == BodyParts::all()));
  CHECK(one.text.find("walk") == 0);
  CHECK(one.text.find("wave") != std::string::npos);
}
