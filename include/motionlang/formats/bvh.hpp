// SPDX-License-Identifier: MIT
/// BVH files as motions: the meaning of their channels, and writing in a form that all programs read.
///
/// The format has no units and no up axis: reading takes metres per unit and assumes Y up. The channels "Zrotation
/// Xrotation Yrotation" mean R = Rz Rx Ry on column vectors (the first named is the outermost). A position channel
/// replaces that coordinate of the OFFSET.
#pragma once

#include <functional>   // tables
#include <optional>     // tables
#include <string>       // names
#include <string_view>  // order of rotations
#include <vector>       // joints

#include <motionlang/formats/bvh_text.hpp>
#include <motionlang/geometry/euler.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/skeleton_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct BvhReadOptions {
  double scale = 0.01;  // metres per unit of the file; 0.01: the file is in centimetres
  int root = 0;         // number of the ROOT, if there are several
  /// Finds the table of a body by its joints, because the root of the motion is that of the body; none: the built-in
  /// tables.
  std::function<std::optional<SkeletonTable>(const Skeleton&)> find_table{};
};

struct BvhWriteOptions {
  double scale = 100;              // units per metre; 100: centimetres (Blender: import with scale 0.01)
  std::string_view order = "ZXY";  // of the rotation channels: three different axes
  // Metres, for the bones after leaf joints that have none in the skeleton, but at most the length of the bone before.
  // For bones of length 0, Blender invents a length.
  double end_length = 0.1;
};

/// The motion of the file. End sites are the ends of bones, not joints. Joints with equal names get numbers ("Hand",
/// "Hand_2"). The root of the motion is that of the body (kinematics/body_root.hpp), with all movement above it.
/// Everything beside it is left out (joints_beside_body). Below it, changing positions (stretching bones) are replaced
/// by their mean.
/// Throws  config_error 101 (scale, number of the root), io_error 405 (far more joints than channels), numeric_error
///         301 (values so large that they overflow)
Motion to_motion(const Bvh& file, const BvhReadOptions& options = {});
/// The number of ROOTs in the file. Each is a motion of its own.
int bvh_roots(const Bvh& file);
/// Names of the joints below a root that have changing positions of their own, like bones that stretch. to_motion
/// leaves these positions out. Throws config_error 101 (number of the root).
std::vector<std::string> stretched_joints(const Bvh& file, const BvhReadOptions& options = {});
/// Names of the joints beside the body under a root: bones for inverse kinematics, props, cameras. Throws config_error
/// 101 (number of the root).
std::vector<std::string> joints_beside_body(const Bvh& file, const BvhReadOptions& options = {});
/// Throws io_error 401 and as parse_bvh, to_motion.
Motion read_bvh_motion(const FilePath& path, const BvhReadOptions& options = {});

namespace detail {

/// The angles of the same rotation that continue a curve. There is the triple and its twin (a + pi, pi - b, c + pi),
/// each plus multiples of 2 pi; this is the one closest to the frame before.
EulerAngles<double> continue_curve(const EulerAngles<double>& angles, const EulerAngles<double>& before);

/// Orders joints so that every child follows its parent before any other branch, as in a BVH file.
std::vector<int> depth_first_order(const Skeleton& skeleton);

}  // namespace detail

/// The names of the joints in a BVH file. They are those of the skeleton, in UTF-8 and with colons. Blanks, control
/// characters and braces become "_". A name that is then no longer unique gets a number.
std::vector<std::string> bvh_names(const Skeleton& skeleton);

/// The motion as a BVH file: root first with OFFSET 0 and three positions, three rotation channels on every joint, an
/// end site after every leaf. Joints come depth first, whatever their order in the skeleton. Angles follow smooth
/// curves, so they may exceed 180 degrees.
/// Throws  config_error 101 (order with an axis twice, scale), 103 (order), shape_error 205 and numeric_error 301
///         (Motion::validate)
Bvh to_bvh(const Motion& motion, const BvhWriteOptions& options = {});
/// Throws io_error 401 and as to_bvh, format_bvh.
void write_bvh(const FilePath& path, const Motion& motion, const BvhWriteOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/bvh.ipp>
#endif
