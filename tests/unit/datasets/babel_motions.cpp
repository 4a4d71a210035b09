#include <motionlang/datasets/babel_motions.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("settings of SINC's and TEACH's data that leave nothing are refused") {
  CHECK_NOTHROW(ml::SincDataConfig{}.require_sound());
  CHECK_NOTHROW(ml::TeachDataConfig{}.require_sound());
  CHECK_ERROR(ml::SincDataConfig{.shortest = 0}.require_sound(), "shortest");
  CHECK_ERROR((ml::SincDataConfig{.shortest = 20, .window = 19}.require_sound()), "window");
  CHECK_ERROR(ml::SincDataConfig{.simultaneous_max = 1}.require_sound(), "simultaneous_max");
  CHECK_ERROR(ml::SincDataConfig{.proportion = 1.5}.require_sound(), "proportion");
  CHECK_ERROR(ml::SincDataConfig{.test_share = 1}.require_sound(), "test_share");
  CHECK_ERROR((ml::TeachDataConfig{.shortest = 20, .longest = 10}.require_sound()), "longest");
  CHECK(ml::split_config(ml::TeachDataConfig{.test_share = 0.3, .split_seed = 5}).split_seed == 5);
}

TEST_CASE("sources that contradict each other are refused") {
  CHECK_ERROR(ml::BabelSources{.data = "clips"}.require_sound(), "[motionlang.config.102]");
  CHECK_NOTHROW((ml::BabelSources{.data = "clips", .babel = "train.json"}.require_sound()));
  CHECK_NOTHROW((ml::BabelSources{.data = "clips", .babel = "train.json", .validation = "val.json"}.require_sound()));
  CHECK_ERROR((ml::BabelSources{.data = "clips", .babel = "train.json", .validation = "val.json", .splits = "lists"}
                   .require_sound()),
              "[motionlang.config.102]");
}
