#include <motionlang/datasets/action_names.hpp>

#include <doctest/doctest.h>

namespace ml = motionlang;

TEST_CASE("only HumanAct12 with its twelve classes has names") {
  const auto names = ml::action_labels("humanact12", 12);
  REQUIRE(names.size() == 12);
  CHECK(names[0] == "warm_up");
  CHECK(names[1] == "walk");
  CHECK(names[11] == "throw");
  CHECK(ml::action_labels("humanact12", 13).empty());
  CHECK(ml::action_labels("uestc", 40).empty());
}
