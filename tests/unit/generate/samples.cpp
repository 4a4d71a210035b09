#include <motionlang/generate/samples.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;

TEST_CASE("samples are made in one run, those of a timeline together") {
  const fake::Model model;
  const std::vector<ml::Timeline> timelines{ml::whole_body_timeline("walk", 30), ml::whole_body_timeline("run", 30)};
  const auto made = ml::generate_samples(model, timelines, 3);
  CHECK(model.calls == 1);
  REQUIRE((made.size() == 2 && made[0].size() == 3 && made[1].size() == 3));
  CHECK(made[0][0].name == "walk 1");  // its places in the run: the first ones are those of a run without samples
  CHECK(made[1][0].name == "run 2");
  CHECK(made[1][2].name == "run 6");
  CHECK_ERROR(ml::generate_samples(model, timelines, 0), "[motionlang.config.101] generate_samples: 0 motions");
}
