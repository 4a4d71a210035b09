// SPDX-License-Identifier: MIT
// Bodies of the headers in kinematics/, compiled once for motionlang::instantiated.
#include <motionlang/kinematics/blend.ipp>
#include <motionlang/kinematics/body_joints.ipp>
#include <motionlang/kinematics/body_motion.ipp>
#include <motionlang/kinematics/finger_names.ipp>
#include <motionlang/kinematics/foot_contact.ipp>
#include <motionlang/kinematics/foot_lock.ipp>
#include <motionlang/kinematics/guo_chains.ipp>
#include <motionlang/kinematics/joint_sides.ipp>
#include <motionlang/kinematics/known_skeletons.ipp>
#include <motionlang/kinematics/limb_ik.ipp>
#include <motionlang/kinematics/loops.ipp>
#include <motionlang/kinematics/mirror_joints.ipp>
#include <motionlang/kinematics/motion.ipp>
#include <motionlang/kinematics/motion_from_joints.ipp>
#include <motionlang/kinematics/motion_tools.ipp>
#include <motionlang/kinematics/overlay.ipp>
#include <motionlang/kinematics/retarget.ipp>
#include <motionlang/kinematics/root_motion.ipp>
#include <motionlang/kinematics/skeleton.ipp>
#include <motionlang/kinematics/skeleton_table.ipp>
#include <motionlang/kinematics/skeleton_tables.ipp>
#include <motionlang/kinematics/smooth_motion.ipp>
#include <motionlang/kinematics/standing_skeleton.ipp>
