// SPDX-License-Identifier: MIT
/// TEACH's way to put generated parts one behind the other: the next part is turned and moved onto the last frame of the
/// one before it, the frames between them are interpolated.
///
/// Source    TEACH (Athanasiou et al., 3DV 2022), tools/interpolation.py; spec teach.md 5.1
/// Notation  last frame of what is there -> e, first frame of the next part -> b
/// World     Z up. The turn is the difference of the z of two rotation vectors, which is that of the headings only for
///           bodies that do not lean; published so.
#pragma once

#include <motionlang/features/smplvelp.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Pose and place of one frame.
template <Scalar S>
struct PoseInWorld {
  std::span<const Matrix3<S>> rotations;  // (joints); joint 0 in the world
  Vec3<S> trans;
};

/// Whether the next part is also turned to the heading of what is there, or moved only.
enum class Alignment { full, translation };

/// The part's first frame comes to stand where e stands; heights stay.
/// rotations  (frames, joints) of the part, turned in place
/// trans      (frames), moved in place
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
void align_to(const PoseInWorld<S>& e, std::span<Matrix3<S>> rotations, std::span<Vec3<S>> trans,
              Alignment alignment = Alignment::full) {
  const std::size_t joints = e.rotations.size();
  if (joints == 0 || rotations.size() != trans.size() * joints) {
    raise<shape_error>(205, "align_to: ", rotations.size(), " rotations for ", trans.size(), " frames of ", joints,
                       " joints");
  }
  if (trans.empty()) return;
  auto turn = Matrix3<S>::identity();
  if (alignment == Alignment::full) {
    const S angle = pytorch3d::matrix_to_axis_angle(rotations[0]).z - pytorch3d::matrix_to_axis_angle(e.rotations[0]).z;
    turn = axis_rotation(2, -angle);
  }
  const Vec3<S> first = trans[0];
  for (std::size_t f = 0; f < trans.size(); ++f) {
    rotations[f * joints] = turn * rotations[f * joints];
    const Vec3<S> path = turn * (trans[f] - first);
    trans[f] = {e.trans.x + path.x, e.trans.y + path.y, trans[f].z};
  }
}

namespace detail {

/// sin((1-t) o)/sin o a + sin(t o)/sin o b for the shorter way round; straight for a . b > 0.99.
template <Scalar S>
Quaternion<S> teach_slerp(const Quaternion<S>& p, const Quaternion<S>& q, S t) {
  const Quaternion<S> a = normalized(p), other = normalized(q);
  const S d = dot(a, other), cosine = std::abs(d);
  const Quaternion<S> b = (d < S(0) ? S(-1) : S(1)) * other;
  S wa = S(1) - t, wb = t;
  if (!(S(1) - cosine < S(0.01))) {
    const S o = std::acos(cosine);
    wa = std::sin(wa * o) / std::sin(o), wb = std::sin(wb * o) / std::sin(o);
  }
  return normalized(wa * a + wb * b);
}

}  // namespace detail

/// `frames` frames between two, at k / (frames + 1): rotations along the shorter arc, places in a straight line.
/// Throws shape_error 205 if the poses differ in their joints.
template <Scalar S>
SmplVelpMotion<S> slerp_window(const PoseInWorld<S>& e, const PoseInWorld<S>& b, Index frames) {
  if (e.rotations.size() != b.rotations.size()) {
    raise<shape_error>(205, "slerp_window: ", e.rotations.size(), " and ", b.rotations.size(), " joints");
  }
  SmplVelpMotion<S> out;
  for (Index k = 1; k <= frames; ++k) {
    const S t = static_cast<S>(k) / static_cast<S>(frames + 1);
    for (std::size_t j = 0; j < e.rotations.size(); ++j) {
      out.rotations.push_back(to_matrix(detail::teach_slerp(pytorch3d::matrix_to_quaternion(e.rotations[j]),
                                                            pytorch3d::matrix_to_quaternion(b.rotations[j]), t)));
    }
    out.trans.push_back((S(1) - t) * e.trans + t * b.trans);
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
