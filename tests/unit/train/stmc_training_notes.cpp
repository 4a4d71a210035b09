#include <motionlang/train/stmc_training_notes.hpp>

#include <doctest/doctest.h>

#include <motionlang/metrics/motion_quality.hpp>

#include "../../support/training_set.hpp"

namespace ml = motionlang;

TEST_CASE("a model says what it learned from, and how its recordings skate and shake") {
  const ml::TrainingSet& data = captioned::training_set();
  const auto notes = ml::stmc_training_notes(data);
  REQUIRE_FALSE(data.segments().empty());
  double skate = 0, jitter = 0;
  for (const auto& s : data.segments()) {
    skate += ml::motion_quality(s.motion).feet.speed / static_cast<double>(data.segments().size());
    jitter += ml::motion_quality(s.motion).jitter / static_cast<double>(data.segments().size());
  }
  CHECK(std::stod(notes.at("real.skate")) == doctest::Approx(skate));
  CHECK(std::stod(notes.at("real.jitter")) == doctest::Approx(jitter));
  CHECK(notes.at("data").starts_with(std::to_string(data.segments().size()) + " captioned segments, "));
  CHECK(notes.at("text.words").find("walk") != std::string::npos);
  CHECK(notes.at("version") == MOTIONLANG_VERSION);
}
