// Names that the usage examples of features/, kinematics/ and diffusion/ use without declaring them.
#include "usage.hpp"

#include <motionlang/diffusion/mdm_actions.hpp>
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/body_motion.hpp>
#include <motionlang/kinematics/curved_path.hpp>
#include <motionlang/kinematics/face_landmarks.hpp>
#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/forward_batch.hpp>
#include <motionlang/kinematics/leading_side.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/kinematics/up_axis.hpp>

void actions(const MdmDenoiser<B>& network, const std::vector<Index>& actions) {
#include "diffusion/mdm_actions.1.inc"
}
void extract(const std::vector<Vec3<double>>& given) {
  const std::span<const Vec3<double>> joints(given);
#include "features/guoh3d_extraction.1.inc"
}
void layout() {
#include "features/layout.1.inc"
}
void rows(const Motion& clip) {
#include "features/motion_features.1.inc"
}
void statistics_of(FeatureStatistics& statistics, const std::vector<std::vector<float>>& clips,
                   const Guoh3dSlots& slots) {
#include "features/statistics.1.inc"
}
void blend(const Motion& walk, const Motion& run, const Motion& motion) {
#include "kinematics/blend.1.inc"
}
void curve(const Motion& walk) {
#include "kinematics/curved_path.1.inc"
}
void own_body(const Body<B>& body, const Motion& on_smpls_joints, const std::vector<float>& betas) {
#include "kinematics/body_motion.1.inc"
}
void landmarks(const Body<B>& body, const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
               const Tensor<B, 2>& translation) {
#include "kinematics/face_landmarks.1.inc"
}
void floor_(const Motion& motion) {
#include "kinematics/floor_fix.1.inc"
}
void feet(const Motion& motion) {
#include "kinematics/foot_lock.1.inc"
}
void usual_side(Motion wave) {
#include "kinematics/leading_side.1.inc"
}
void batch(const Skeleton& skeleton, const Tensor<B, 4>& rot6d, const Tensor<B, 3>& root) {
#include "kinematics/forward_batch.1.inc"
}
void from_joints(const std::vector<Vec3<double>>& joints) {
#include "kinematics/motion_from_joints.1.inc"
}
void up_axis(Motion motion) {
#include "kinematics/up_axis.1.inc"
}
