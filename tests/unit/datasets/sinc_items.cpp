// SINC's training items: partners, draws, windows.
#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/datasets/sinc_items.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using Numbers = std::vector<ml::Index>;
using enum ml::SincSource;

namespace {

ml::BodyPartTable table() {
  ml::BodyPartTable t;
  t.add("wave", "right arm"), t.add("walk", "left leg\nright leg\nbuttocks"), t.add("nod", "neck");
  return t;
}
const std::vector<ml::SincItem> list{
    {segment, {"nod"}, 40},   {segment, {"wave"}, 400}, {simultaneous, {"walk", "wave"}, 60},
    {sequence, {"walk"}, 20}, {segment, {"wave"}, 30},  {pair, {"walk", "nod"}, 50}};

}  // namespace

TEST_CASE("SINC items: partners move other parts, in the order of the table") {
  const auto parts = table();
  const ml::SincItems items(list, parts);
  CHECK(items.partners(0) == Numbers{1, 4, 3});
  CHECK(items.partners(1) == Numbers{3, 0});
  CHECK(items.partners(2) == Numbers{1, 4, 0});
  CHECK_ERROR(items.partners(6), "[motionlang.config.101] SincItems: no item 6 of 6");
  CHECK_ERROR(ml::SincItems({{segment, {}, 3}}, parts), "[motionlang.config.101]");
  CHECK_ERROR(ml::SincItems({{segment, {"fly"}, 3}}, parts).partners(0), "[motionlang.config.103]");
}

TEST_CASE("SINC items: half of the single actions get a partner") {
  const auto parts = table();
  const ml::SincItems items(list, parts);
  ml::Philox rng{.seed = 3};
  int combined = 0, random_walk = 0;
  for (int i = 0; i < 2000; ++i) {
    const ml::SincElement e = items.draw(1, {}, rng);
    combined += e.partner.has_value();
    REQUIRE(e.labels.size() == e.parts.size());
    REQUIRE(e.labels.size() == (e.partner ? 2 : 1));
    if (e.partner) REQUIRE((*e.partner == 3 || *e.partner == 0));
    CHECK(e.window.length == 300);
    CHECK(e.window.first <= 99);
    CHECK_FALSE(items.draw(2, {}, rng).partner);  // simultaneous already
    CHECK_FALSE(items.draw(5, {.proportion = 1}, rng).partner);
    CHECK_FALSE(items.draw(1, {.synthetic = false}, rng).partner);
    const auto any = items.draw(1, {.proportion = 1, .random = true}, rng);
    REQUIRE(any.partner);
    CHECK(*any.partner != 2);
    random_walk += any.parts[0] != parts.parts("wave");
  }
  CHECK(combined > 900);
  CHECK(combined < 1100);
  CHECK(random_walk > 1900);
}

TEST_CASE("SINC windows") {
  const ml::SincWindow training, whole{.request = 0, .longest = 800};
  const auto last = [](ml::Index n) { return n - 1; };
  CHECK(training.of(299, last) == ml::FrameSlice{0, 299});
  CHECK(training.of(300, last) == ml::FrameSlice{0, 300});
  CHECK(training.of(301, last) == ml::FrameSlice{0, 300});
  CHECK(training.of(500, last) == ml::FrameSlice{199, 300});
  CHECK(training.accepts(700));
  CHECK_FALSE(training.accepts(14));
  CHECK(whole.of(700, last) == ml::FrameSlice{0, 700});
  CHECK(whole.accepts(800));
  CHECK_FALSE(whole.accepts(801));
}
