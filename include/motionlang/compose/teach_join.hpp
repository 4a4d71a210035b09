// SPDX-License-Identifier: MIT
/// Joins generated parts as TEACH does. The next part is turned and moved onto the last frame of the part before it,
/// and the frames between them are interpolated.
///
/// Source    thesis A.2.3 and A.3.4; TEACH (Athanasiou et al., 3DV 2022) teach/tools/interpolation.py
/// Notation  last frame of the motion so far -> e, first frame of the next part -> b
/// World     Z up. As published, the turn is the difference of the z of two rotation vectors. It equals that of the
///           headings only if the bodies do not lean.
#pragma once

#include <algorithm>  // copy

#include <motionlang/features/smplvelp.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Pose and place of one frame.
template <Scalar S>
struct PoseInWorld {
  std::span<const Matrix3<S>> rotations;  // (joints); joint 0 in the world
  Vec3<S> trans;
};

/// The way in which the next part joins: turned to the heading of the end and moved, or only moved.
enum class Alignment { full, translation };

/// Moves the part so that its first frame is where e is. Heights stay.
/// rotations  (frames, joints) of the part, turned in place
/// trans      (frames), moved in place
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
void align_to(const PoseInWorld<S>& e, std::span<Matrix3<S>> rotations, std::span<Vec3<S>> trans,
              Alignment alignment = Alignment::full) {
  const std::size_t joints = e.rotations.size();
  if (joints == 0 || rotations.size() != trans.size() * joints) {
    raise<shape_error>(205, "align_to: ", counted(rotations.size(), "rotation"), " for ",
                       counted(trans.size(), "frame"), " of ", counted(joints, "joint"));
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

/// sin((1-t) o)/sin o a + sin(t o)/sin o b along the shorter arc; linear for a . b > 0.99.
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

/// `frames` frames between two poses, at k / (frames + 1). Rotations follow the shorter arc, and places a straight
/// line. Throws shape_error 205 if the poses differ in their joints.
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

/// Aligns each part to the end of the one before it, and interpolates the first `window` frames of all parts except the
/// first.
/// lengths  frames of the parts, which together are those of the motion
/// Throws   shape_error 205 if the motion has another number of frames, or a part has no frame behind its window;
///          config_error 101 for a negative window
template <Scalar S>
void join_parts(SmplVelpMotion<S>& motion, std::span<const Index> lengths, Index window = 0,
                Alignment alignment = Alignment::full) {
  if (window < 0) raise<config_error>(101, "join_parts: a window of ", window, " frames");
  const auto frames = std::ssize(motion.trans);
  const auto joints = frames == 0 ? 0 : motion.rotations.size() / motion.trans.size();
  const auto rotations = std::span(motion.rotations);
  const auto trans = std::span(motion.trans);
  const auto pose = [&](std::size_t f) {
    return PoseInWorld<S>{std::span<const Matrix3<S>>(rotations.subspan(f * joints, joints)), trans[f]};
  };
  Index end = 0;
  for (std::size_t part = 0; part < lengths.size(); ++part) {
    const Index start = end, gap = part == 0 ? 0 : window;
    end += lengths[part];
    if (lengths[part] <= gap || end > frames)
      raise<shape_error>(205, "join_parts: part ", part, " of ", lengths[part], " frames, window ", window,
                         ", motion of ", frames, " frames");
    if (part == 0) continue;
    const auto last = static_cast<std::size_t>(start - 1), next = static_cast<std::size_t>(start + gap),
               count = static_cast<std::size_t>(end - start - gap);
    align_to(pose(last), rotations.subspan(next * joints, count * joints), trans.subspan(next, count), alignment);
    const auto between = slerp_window(pose(last), pose(next), gap);
    std::copy(between.rotations.begin(), between.rotations.end(), rotations.subspan((last + 1) * joints).begin());
    std::copy(between.trans.begin(), between.trans.end(), trans.subspan(last + 1).begin());
  }
  if (end != frames) raise<shape_error>(205, "join_parts: parts of ", end, " frames, motion of ", frames);
}

MOTIONLANG_NAMESPACE_END
