// Two motions in one body.
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
