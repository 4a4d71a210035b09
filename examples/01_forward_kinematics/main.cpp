// A leg of three joints: the place of the ankle when the knee bends, and the direction in which the knee lifts it.
#include <cmath>
#include <cstdio>
#include <vector>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/kinematics/forward_batch.hpp>

namespace ml = motionlang;

int main() {
  const auto leg = ml::Skeleton::from_joints(
      {{"hips", "", {0, 0.9, 0}}, {"knee", "hips", {0, -0.4, 0}}, {"ankle", "knee", {0, -0.4, 0}}});
  const int knee = leg["knee"], ankle = leg["ankle"];

  // One pose. p_ankle = p_knee + R_knee offset_ankle
  auto pose = ml::Pose<double>::rest(leg);
  pose.local[static_cast<std::size_t>(knee)] = ml::from_axis_angle(ml::Vec3<double>{1, 0, 0}, 0.5);
  const auto at = ml::forward_kinematics(leg, pose).position[static_cast<std::size_t>(ankle)];
  std::printf("knee bent by 0.5 rad: ankle at (%.3f, %.3f, %.3f) m\n", at.x, at.y, at.z);

  // A batch of poses, differentiable: d(height of the ankle) / d(6D rotation of the knee)
  using A = ml::Autodiff<ml::EigenBackend<double>>;
  std::vector<double> rows;
  for (int joint = 0; joint < leg.size(); ++joint) {
    const double c = joint == knee ? std::cos(0.5) : 1, s = joint == knee ? std::sin(0.5) : 0;
    rows.insert(rows.end(), {1, 0, 0, 0, c, -s});  // the first two rows of a rotation about x
  }
  const auto rot6d = ml::variable<A>(ml::Tensor<A::inner, 4>::from(rows, {1, 1, 3, 6}));  // (batch, time, joints, 6)
  const auto root = ml::Tensor<A, 3>::from({0, 0.9, 0}, {1, 1, 3});
  const auto joints = ml::forward_kinematics(leg, ml::lanes(rot6d, root));  // (batch, time, joints, 3)
  const auto height = ml::sum(ml::slice(ml::slice(joints, 2, ankle, ankle + 1), 3, 1, 2));
  const auto gradient = ml::backward(height)[rot6d].to_vector();
  std::printf("height of the ankle %.3f m; gradient with respect to the knee's second row (%.3f, %.3f, %.3f)\n",
              height.item(), gradient[9], gradient[10], gradient[11]);
}
