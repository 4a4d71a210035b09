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

TEST_CASE("motions between two texts show shares of both") {
  const fake::Latent model;
  const auto from = ml::whole_body_timeline("0", 30), to = ml::whole_body_timeline("1", 30);
  const auto made = ml::generate_between(model, from, to, 5, {.seed = 3});
  REQUIRE(made.size() == 5);
  const auto shown = [&](std::size_t i) { return made[i].timeline.intervals.front().text; };
  CHECK(shown(0) == "0");
  CHECK(shown(1) == "0 75 %, 1 25 %");
  CHECK(shown(3) == "0 25 %, 1 75 %");
  CHECK(shown(4) == "1");
  const auto line = model.between(from, to, 5, {.seed = 3});
  for (std::size_t i = 0; i < 5; ++i) CHECK(made[i].motion.root == line[i].root);
  CHECK_ERROR(ml::generate_between(model, from, to, 1), "[motionlang.config.101]");
}

TEST_CASE("names of files: of a text, and of all samples") {
  CHECK(ml::result_name("a person walks") == "a_person_walks");
  CHECK(ml::result_name("  wave, then sit/down!") == "wave_then_sit_down");
  CHECK(ml::result_name("gehen \xC3\xBC"
                        "ber") ==
        "gehen_\xC3\xBC"
        "ber");
  CHECK(ml::result_name("../..") == "motion");
  CHECK(ml::result_name("") == "motion");
  CHECK(ml::result_name(std::string(100, 'a')).size() == 40);
  CHECK(ml::result_name("a\xFF"
                        "b") == "a_b");

  using Names = std::vector<std::string>;
  CHECK(ml::sample_names("walk", 1, 1) == Names{"walk"});
  CHECK(ml::sample_names("walk", 2, 1) == Names{"walk_0", "walk_1"});
  CHECK(ml::sample_names("walk", 1, 2) == Names{"walk_1", "walk_2"});
  CHECK(ml::sample_names("walk", 2, 2) == Names{"walk_0_1", "walk_0_2", "walk_1_1", "walk_1_2"});
}
