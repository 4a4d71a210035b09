// Feature layouts: the published tables, own layouts, partitions. The index lists themselves are golden cases.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include <motionlang/features/layout.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/features/statistics.hpp>

namespace ml = motionlang;
using enum ml::BodyPart;
using Ranges = std::vector<ml::IndexRange>;

TEST_CASE("smplrifke") {  // STMC src/bptools.py
  const auto layout = ml::smplrifke_layout();
  CHECK(layout.size == 205);
  layout.validate();
  CHECK(layout.ranges(legs) ==
        Ranges{{0, 22}, {28, 40}, {46, 58}, {64, 76}, {136, 142}, {145, 151}, {154, 160}, {163, 169}});
  CHECK(layout.ranges(head) == Ranges{{76, 82}, {94, 100}, {169, 172}, {178, 181}});
  CHECK(layout.indices(left_arm).size() == 39);
  CHECK(layout.indices(right_arm).size() == 39);
  CHECK(layout.indices(spine).size() == 27);
}

TEST_CASE("guoh3dfeats, also of another skeleton") {
  const auto layout = ml::guoh3dfeats_layout();
  CHECK(layout.size == 263);
  layout.validate();
  CHECK(layout.ranges(spine) ==
        Ranges{{10, 13}, {19, 22}, {28, 31}, {79, 85}, {97, 103}, {115, 121}, {202, 205}, {211, 214}, {220, 223}});
  CHECK(layout.ranges(legs).front() == ml::IndexRange{0, 10});
  CHECK(layout.ranges(legs).back() == ml::IndexRange{259, 263});
  const std::vector<ml::BodyPart> kit(21, head);
  const auto other = ml::guoh3dfeats_layout(kit);
  CHECK(other.size == 251);
  other.validate();
  CHECK(other.indices(legs).size() == 8);
}

TEST_CASE("rifke, smplvelp and ACTOR's frames") {
  const auto rifke = ml::rifke_layout();
  CHECK(rifke.size == 67);
  CHECK(rifke.ranges(spine) == Ranges{{7, 10}, {16, 19}, {25, 28}});                    // spine1, 2, 3
  CHECK(rifke.ranges(legs) == Ranges{{0, 7}, {10, 16}, {19, 25}, {28, 34}, {64, 67}});  // height; turn and velocity
  CHECK(ml::rifke_layout(ml::smpl_part_of_joint).size == 73);
  const auto mmm = ml::rifke_layout(ml::kit_part_of_joint);
  CHECK(mmm.size == 64);
  CHECK(mmm.ranges(left_arm) == Ranges{{13, 22}});
  CHECK(mmm.ranges(legs) == Ranges{{0, 1}, {31, 64}});
  const auto velp = ml::smplvelp_layout();
  CHECK(velp.size == 135);
  CHECK(velp.ranges(legs).front() == ml::IndexRange{0, 21});  // the root's height and velocity, pelvis, hips
  CHECK(velp.ranges(head) == Ranges{{75, 81}, {93, 99}});
  const auto quaternions =
      ml::smplvelp_layout(std::span(ml::smpl_part_of_joint).first<22>(), ml::PoseRepresentation::rotquat);
  CHECK(quaternions.size == 3 + 4 * 22);
  const auto actor = ml::actor_layout();
  CHECK(actor.size == 150);
  CHECK(actor.ranges(legs).back() == ml::IndexRange{144, 150});
  CHECK(actor.ranges(left_arm) == Ranges{{78, 84}, {96, 102}, {108, 114}, {120, 126}, {132, 138}});
  const auto local = ml::actor_layout(ml::smpl_part_of_joint, {.translation = false, .global = false});
  CHECK(local.size == 138);
  CHECK(local.ranges(legs).front() == ml::IndexRange{0, 12});
  for (const auto& layout : {rifke, mmm, velp, quaternions, actor, local}) layout.validate();
  CHECK_THROWS_AS(ml::rifke_layout({}), ml::config_error);
  CHECK_THROWS_AS(ml::smplvelp_layout({}), ml::config_error);
  CHECK_THROWS_AS(ml::actor_layout({}), ml::config_error);
}

TEST_CASE("own layouts") {
  const auto own = ml::FeatureLayout::from_owner("own", 10, [](ml::Index i) { return i % 2 == 0 ? legs : spine; });
  own.validate();
  CHECK(own.indices(spine) == std::vector<ml::Index>{1, 3, 5, 7, 9});
  CHECK(own.ranges(head).empty());

  ml::FeatureLayout broken{"broken", 4, {}};
  broken.parts[0] = {{0, 2}};
  broken.parts[3] = {{3, 4}};
  CHECK_THROWS_WITH_AS(broken.validate(), doctest::Contains("number 2 belongs to 0 body parts"), ml::config_error);
  broken.parts[3] = {{1, 4}};
  CHECK_THROWS_WITH_AS(broken.validate(), doctest::Contains("number 1 belongs to 2 body parts"), ml::config_error);
  broken.parts[3] = {{2, 5}};
  CHECK_THROWS_WITH_AS(broken.validate(), doctest::Contains("[motionlang.config.102]"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::smplrifke_layout(ml::smpl_part_of_joint, 25), doctest::Contains("[motionlang.config.101]"),
                       ml::config_error);
  CHECK_THROWS_AS(ml::guoh3dfeats_layout({}), ml::config_error);
}

TEST_CASE("layouts of other bodies: the part with the path has what belongs to the root") {
  const ml::BodyPartition halves({.names = {"upper", "lower", "a", "b", "c", "d"}, .path = "lower"});
  const std::vector<ml::BodyPart> parts{ml::BodyPart{1}, ml::BodyPart{0}, ml::BodyPart{5}};
  const auto guo = ml::guoh3dfeats_layout(parts, halves), rifke = ml::rifke_layout(parts, halves),
             smpl = ml::smplrifke_layout(parts, 2, halves), actor = ml::actor_layout(parts, {}, halves),
             velp = ml::smplvelp_layout(parts, ml::PoseRepresentation::rot6d, halves);
  for (const auto& layout : {guo, rifke, smpl, actor, velp}) {
    layout.validate();
    CHECK(layout.body == halves);
    CHECK_FALSE(layout.ranges(ml::BodyPart{0}).empty());
    CHECK_FALSE(layout.ranges(ml::BodyPart{5}).empty());
    CHECK(layout.ranges(ml::BodyPart{2}).empty());
  }
  CHECK(guo.ranges(ml::BodyPart{1}) == Ranges{{0, 4}, {22, 25}, {31, 35}});  // root, velocity of joint 0, contacts
  CHECK(rifke.ranges(ml::BodyPart{1}) == Ranges{{0, 1}, {7, 10}});
  CHECK(smpl.ranges(ml::BodyPart{1}) == Ranges{{0, 10}});
  CHECK(actor.ranges(ml::BodyPart{1}) == Ranges{{0, 6}, {18, 24}});
  CHECK(velp.ranges(ml::BodyPart{1}) == Ranges{{0, 9}});

  auto broken = rifke;
  broken.body = {};
  CHECK_THROWS_WITH_AS(broken.validate(),
                       doctest::Contains("[motionlang.config.102] FeatureLayout 'rifke': range 4:7 "
                                         "belongs to part 5 of 5"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(ml::rifke_layout(parts), doctest::Contains("number 4 belongs to part 5 of 5"), ml::config_error);
  CHECK_THROWS_WITH_AS(
      ml::FeatureLayout::from_owner("own", 3, halves, [](ml::Index i) { return i - 1; }),
      doctest::Contains("[motionlang.config.102] FeatureLayout 'own': number 0 belongs to part -1 of 6"),
      ml::config_error);
}

TEST_CASE("statistics of clips are those of all frames together") {
  const std::vector<double> a{1, 1000, 3, 1000, 5, 1000}, b{7, 1000};
  ml::FeatureStatistics statistics;
  statistics.add(std::span<const double>(a), 2);
  statistics.add(std::span<const double>(b), 2);
  CHECK(statistics.count() == 4);
  CHECK(statistics.mean() == std::vector<double>{4, 1000});
  CHECK(statistics.standard_deviation()[0] == doctest::Approx(std::sqrt(20.0 / 3)));
  CHECK(statistics.standard_deviation()[1] == 0);
  CHECK_THROWS_WITH_AS(statistics.add(std::span<const double>(a), 3), doctest::Contains("[motionlang.shape.204]"),
                       ml::shape_error);
  CHECK_THROWS_WITH_AS(statistics.add(std::span<const double>(a), 4), doctest::Contains("[motionlang.shape.205]"),
                       ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::FeatureStatistics().standard_deviation(), doctest::Contains("[motionlang.numeric.302]"),
                       ml::numeric_error);
}
