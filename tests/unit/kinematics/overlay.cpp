// Two motions in one body.
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/overlay.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using enum ml::BodyPart;

TEST_CASE("the parts come from the other motion, the path and the rest from the base") {
  const auto base = synthetic::walk({.frames = 30}), other = synthetic::walk({.frames = 20, .steps_per_second = 3});
  const auto both = ml::overlay_parts(base, other, ml::BodyParts{}.with(left_arm).with(legs));
  REQUIRE(both.frames() == 20);
  both.validate();
  for (ml::Index f = 0; f < 20; ++f) {
    CHECK(both.root_at(f) == base.root_at(f));
    for (std::size_t j = 0; j < 24; ++j) {
      const bool taken = j > 0 && (ml::smpl_part_of_joint[j] == left_arm || ml::smpl_part_of_joint[j] == legs);
      CHECK(both.rotations(f)[j] == (taken ? other : base).rotations(f)[j]);  // the pelvis keeps the direction
    }
  }
  CHECK(ml::overlay_parts(base, other, {}).local.size() == both.local.size());
}

TEST_CASE("parts come from the other motion for a while, and turn there and back") {
  const auto base = synthetic::walk({.frames = 40}), other = synthetic::walk({.frames = 20, .steps_per_second = 3});
  const auto both = ml::overlay_parts_for_a_while(base, other, ml::BodyParts{}.with(left_arm), 10, 4);
  REQUIRE(both.frames() == 40);
  both.validate();
  constexpr std::size_t shoulder = 16, knee = 4;
  for (ml::Index f = 0; f < 40; ++f) {
    CAPTURE(f);
    CHECK(both.root_at(f) == base.root_at(f));
    CHECK(both.rotations(f)[knee] == base.rotations(f)[knee]);
    const auto arm = both.rotations(f)[shoulder], before = base.rotations(f)[shoulder];
    if (f < 10 || f >= 30) {
      CHECK(arm == before);
      continue;
    }
    const auto after = other.rotations(f - 10)[shoulder];
    if (f >= 14 && f < 26) CHECK(arm == after);
    const double share = std::min({1.0, double(f - 9) / 5, double(30 - f) / 5});  // 1/5 ... 4/5, 1, ..., 1, 4/5 ... 1/5
    CHECK(ml::distance(before, arm) == doctest::Approx(share * ml::distance(before, after)).epsilon(1e-6));
  }
  const auto cut = ml::overlay_parts_for_a_while(base, other, ml::BodyParts{}.with(left_arm), 39, 0);
  CHECK(cut.rotations(39)[shoulder] == other.rotations(0)[shoulder]);
  CHECK(ml::overlay_parts_for_a_while(base, other, ml::BodyParts::all(), 40, 0).local == base.local);
  CHECK_ERROR(ml::overlay_parts_for_a_while(base, other, {}, -1, 0), "[motionlang.config.101]");
}

TEST_CASE("other skeletons are refused") {
  const auto base = synthetic::walk(), other = synthetic::walk({}, ml::humanml3d22_skeleton());
  CHECK_ERROR(ml::overlay_parts(base, other, ml::BodyParts::all()), "[motionlang.config.103] overlay_parts");
  auto renamed = base;
  std::swap(renamed.skeleton.names[1], renamed.skeleton.names[20]);  // another order of joints
  CHECK_ERROR(ml::overlay_parts(renamed, renamed, ml::BodyParts::all()), "[motionlang.config.103]");
  CHECK(ml::overlay_parts(other, other, ml::BodyParts::all()).local.size() == other.local.size());
  auto large = base;
  large.skeleton = ml::Skeleton::from_joints({{"a", "", {}}});
  for (int j = 1; j < 25; ++j) {
    large.skeleton.names.push_back(std::to_string(j));
    large.skeleton.parents.push_back(0);
    large.skeleton.offsets.push_back({});
  }
  CHECK_ERROR(ml::overlay_parts(large, large, ml::BodyParts::all()), "[motionlang.config.103]");
  auto faster = base;
  faster.fps = 120;
  CHECK_ERROR(ml::overlay_parts(base, faster, ml::BodyParts::all()), "[motionlang.config.102] overlay_parts");
}
