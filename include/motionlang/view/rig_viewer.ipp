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

/// The surface and the skeleton of a character that faces +Z at rest.
struct TurnedRig {
  SkinnedMesh<std::uint16_t> mesh;
  Skeleton skeleton;
  Quaternion<double> turn;
};
inline TurnedRig turned_rig(const GlbRig& rig) {
  TurnedRig out{rig.mesh(), rig.skeleton(), turn_to_front(rig)};
  for (auto* vectors : {&out.mesh.positions, &out.mesh.normals}) {
    for (Vec3<float>& v : *vectors) v = vec_cast<float>(rotate(out.turn, vec_cast<double>(v)));
  }
  for (Vec3<double>& o : out.skeleton.offsets) o = rotate(out.turn, o);
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::string rig_viewer_html(const GlbRig& rig, std::span<const Motion> motions,
                                            const ViewerOptions& options) {
  const detail::TurnedRig turned = detail::turned_rig(rig);
  std::vector<ViewerMotion> shown;
  for (Motion& m : motions_on_rig(rig, motions).motions)
    shown.push_back({detail::with_turned_rest(std::move(m), turned.turn)});
  return detail::body_viewer_page(shown, turned.mesh, turned.skeleton, options);
}

MOTIONLANG_BODY std::string rig_viewer_data(const GlbRig& rig, const Motion& motion) {
  const detail::TurnedRig turned = detail::turned_rig(rig);
  Motion on_rig = std::move(motions_on_rig(rig, std::span(&motion, 1)).motions.front());
  return detail::body_viewer_data(detail::with_turned_rest(std::move(on_rig), turned.turn), turned.mesh,
                                  turned.skeleton);
}

MOTIONLANG_BODY void write_rig_viewer(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
                                      const ViewerOptions& options) {
  write_file(path, rig_viewer_html(rig, motions, options));
}

MOTIONLANG_NAMESPACE_END
