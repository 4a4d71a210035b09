// SPDX-License-Identifier: MIT
// Bodies of rig_viewer.hpp.
#pragma once

#include <cmath>    // atan2
#include <numbers>  // pi
#include <vector>   // motions

#include <motionlang/file/file.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>
#include <motionlang/view/rig_viewer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Quaternion<double> turn_to_front(const GlbRig& rig) {
  const auto standing = StandingSkeleton::of(rig.skeleton(), rig.table());
  const auto rest = rig.skeleton().rest_positions();
  const auto place = [&](const char* role) { return rest[static_cast<std::size_t>(standing.joint(role))]; };
  const Vec3<double> across = place("left_hip") - place("right_hip");
  constexpr double quarter = std::numbers::pi / 2;
  const double quarters = std::round(std::atan2(-across.z, across.x) / quarter);
  return from_axis_angle(Vec3<double>{0, 1, 0}, -quarters * quarter);
}
MOTIONLANG_BODY Motion with_turned_rest(Motion m, const Quaternion<double>& turn) {
  for (auto* bones : {&m.skeleton.offsets, &m.skeleton.ends}) {
    for (Vec3<double>& o : *bones) o = rotate(turn, o);
  }
  for (Index f = 0; f < m.frames(); ++f) {
    const auto pose = m.rotations(f);
    for (std::size_t j = 0; j < pose.size(); ++j) pose[j] = (j == 0 ? pose[j] : turn * pose[j]) * inverse(turn);
  }
  return m;
}

}  // namespace detail

MOTIONLANG_BODY std::string rig_viewer_html(const GlbRig& rig, std::span<const Motion> motions,
                                            const ViewerOptions& options) {
  const Quaternion<double> turn = detail::turn_to_front(rig);
  std::vector<ViewerMotion> shown;
  for (Motion& m : motions_on_rig(rig, motions).motions)
    shown.push_back({detail::with_turned_rest(std::move(m), turn)});
  auto mesh = rig.mesh();
  for (auto* vectors : {&mesh.positions, &mesh.normals}) {
    for (Vec3<float>& v : *vectors) v = vec_cast<float>(rotate(turn, vec_cast<double>(v)));
  }
  Skeleton skeleton = rig.skeleton();
  for (Vec3<double>& o : skeleton.offsets) o = rotate(turn, o);
  return detail::body_viewer_page(shown, mesh, skeleton, options);
}

MOTIONLANG_BODY void write_rig_viewer(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
                                      const ViewerOptions& options) {
  write_file(path, rig_viewer_html(rig, motions, options));
}

MOTIONLANG_NAMESPACE_END
