// The skeletons of the field and one of our own, and the feature layouts over them.
#include <motionlang/kinematics/known_skeletons.hpp>

#include "skeleton_laws.hpp"

namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of skeletons", S, float, double) {
  laws::skeleton_laws<S>(ml::smpl24_skeleton());
  laws::skeleton_laws<S>(ml::humanml3d22_skeleton());
  laws::skeleton_laws<S>(ml::kit21_skeleton());
  laws::skeleton_laws<S>(ml::Skeleton::from_joints({{"only", "", {1, 2, 3}}}));
  laws::skeleton_laws<S>(ml::Skeleton::from_joints(
      {{"hips", "", {0, 1, 0}}, {"knee", "hips", {0, -0.4, 0}}, {"tail", "hips", {0, 0, 0}}}));
}

TEST_CASE("laws of feature layouts") {
  laws::layout_laws(ml::smplrifke_layout());
  laws::layout_laws(ml::guoh3dfeats_layout());
  laws::layout_laws(ml::guoh3dfeats_layout(std::vector<ml::BodyPart>(21, ml::BodyPart::head)));
  laws::layout_laws(ml::FeatureLayout::from_owner("every fifth", 17, [](ml::Index i) { return ml::BodyPart(i % 5); }));
  const ml::BodyPartition spider({.names = {"1", "2", "3", "4", "5", "6", "7", "8", "body"}, .path = "body"});
  laws::layout_laws(ml::FeatureLayout::from_owner("spider", 31, spider, [](ml::Index i) { return i % 9; }));
}
