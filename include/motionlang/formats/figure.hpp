// SPDX-License-Identifier: MIT
/// A body for any skeleton: round cones along the bones, thicker where more joints follow, and a head. The film strip,
/// the viewer and GLB files show it. Only the search for the head uses names.
#pragma once

#include <vector>  // cones

#include <motionlang/kinematics/joint_sides.hpp>
#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The hull of two spheres that move with one joint, in the frame of the joint, metres.
struct RoundCone {
  int joint = 0;
  Vec3<double> from, to;
  double radius_from = 0, radius_to = 0;
  Side side = Side::middle;
};

struct Figure {
  std::vector<RoundCone> cones;
  double size = 1;  // about the height of the body
};

/// The body of a skeleton. Its proportions are those of a person, computed from bone lengths alone. A bone belongs to
/// the joint at its start, so each cone turns with that joint.
Figure make_figure(const Skeleton& skeleton);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/figure.ipp>
#endif
