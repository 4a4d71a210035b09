// SPDX-License-Identifier: MIT
/// Joint positions from the 263 values per frame of HumanML3D ("guoh3dfeats"), or KIT's 251. The other direction is in
/// guoh3d_extraction.hpp. Guoh3dSlots in layout.hpp explains the values.
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb recover_root_rot_pos, recover_from_ric,
///         recover_from_rot
/// World   Y up, frame 0 at x = z = 0; units as the features have them (metres; KIT: about 1/640 m), not normalised
#pragma once

#include <span>         // features
#include <string_view>  // who complains
#include <vector>       // joints

#include <motionlang/features/layout.hpp>
#include <motionlang/geometry/rotation6d.hpp>
#include <motionlang/kinematics/chain_kinematics.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The path of the root. `turn` converts directions of the world to those seen from the body.
template <Scalar S>
struct Guoh3dRoot {
  std::vector<Quaternion<S>> turn;  // (frames)
  std::vector<Vec3<S>> position;    // (frames)
};

struct Guoh3dRecovery {
  /// Adds the frame after the last one. Features of T frames of joints are T - 1 rows, and this gives all T frames
  /// back. Its positions are those of the last row, moved by the velocities of that row.
  bool last_frame = false;
};

namespace detail {

template <Scalar S>
Vec3<S> vector_at(std::span<const S> values, Index at) {
  const auto i = static_cast<std::size_t>(at);
  return {values[i], values[i + 1], values[i + 2]};
}
/// Rows of the features. Throws shape_error 205 if they are not whole, and config_error 101 for a body without joints.
template <Scalar S>
std::size_t guoh3d_rows(std::string_view function, std::span<const S> features, Index joints) {
  const Index width = Guoh3dSlots{joints}.size();
  if (joints < 1) raise<config_error>(101, function, ": ", joints, " joints");
  if (std::ssize(features) % width != 0) {
    raise<shape_error>(205, function, ": ", features.size(), " values are not rows of ", width, " (", joints,
                       " joints)");
  }
  return features.size() / static_cast<std::size_t>(width);
}

}  // namespace detail

/// features (frames, 12 J - 1)
///     a_t = sum_{s<t} f[s, 0],   r_t = (cos a_t, 0, sin a_t, 0)
///     p_t = p_{t-1} + r_t^-1 (f[t-1, 1], 0, f[t-1, 2]),   p_t.y = f[t, 3]
/// Throws shape_error 205, config_error 101
template <Scalar S>
Guoh3dRoot<S> guoh3d_root(std::span<const S> features, Index joints = 22) {
  const std::size_t frames = detail::guoh3d_rows("guoh3d_root", features, joints);
  const auto width = static_cast<std::size_t>(Guoh3dSlots{joints}.size());
  Guoh3dRoot<S> out;
  S angle{};
  Vec3<S> p{};
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * width, width);
    const Quaternion<S> turn{cos(angle), S(0), sin(angle), S(0)};
    if (t > 0) {
      const S* before = row.data() - width;
      p = p + rotate(inverse(turn), Vec3<S>{before[1], S(0), before[2]});
    }
    p.y = row[3];
    out.turn.push_back(turn);
    out.position.push_back(p);
    angle += row[0];
  }
  return out;
}

/// features (frames, 12 J - 1) -> (frames, J), or (frames + 1, J) with `last_frame`, from the positions of the rows.
///     X_{t,j} = r_t^-1 ric_{t,j} + (p_t.x, 0, p_t.z),   X_{t,0} = p_t
/// Throws shape_error 205, config_error 101
template <Scalar S>
std::vector<Vec3<S>> guoh3d_joints(std::span<const S> features, Index joints = 22, const Guoh3dRecovery& options = {}) {
  const auto root = guoh3d_root(features, joints);
  const Guoh3dSlots slots{joints};
  const std::size_t frames = root.turn.size();
  std::vector<Vec3<S>> out;
  out.reserve((frames + 1) * static_cast<std::size_t>(joints));
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * static_cast<std::size_t>(slots.size()));
    const auto back = inverse(root.turn[t]);
    const Vec3<S>& p = root.position[t];
    out.push_back(p);
    for (Index j = 1; j < joints; ++j) {
      out.push_back(rotate(back, detail::vector_at(row, slots.positions().begin + 3 * (j - 1))) +
                    Vec3<S>{p.x, S(0), p.z});
    }
  }
  if (options.last_frame && frames > 0) {
    const auto row = features.last(static_cast<std::size_t>(slots.size()));
    const auto back = inverse(root.turn.back());
    for (Index j = 0; j < joints; ++j) {
      const Vec3<S> before = out[out.size() - static_cast<std::size_t>(joints)];
      out.push_back(before + rotate(back, detail::vector_at(row, slots.velocities().begin + 3 * j)));
    }
  }
  return out;
}

/// The same from the rotations of the rows, with bones of other lengths.
/// offsets  (joints), see chain_offsets
/// Throws   shape_error 204, 205, config_error 101, 106
template <Scalar S>
std::vector<Vec3<S>> guoh3d_joints_from_rotations(const ChainSkeleton& skeleton, std::span<const S> features,
                                                  std::span<const Vec3<S>> offsets) {
  const Guoh3dSlots slots{static_cast<Index>(skeleton.size())};
  const auto root = guoh3d_root(features, slots.joints);
  std::vector<Matrix3<S>> local;
  local.reserve(root.turn.size() * skeleton.size());
  for (std::size_t t = 0; t < root.turn.size(); ++t) {
    const auto row = features.subspan(t * static_cast<std::size_t>(slots.size()));
    local.push_back(to_matrix(root.turn[t]));
    for (Index at = slots.rotations().begin; at < slots.rotations().end; at += 6) {
      local.push_back(to_matrix(Rotation6dColumns<S>{detail::vector_at(row, at), detail::vector_at(row, at + 3)}));
    }
  }
  return chain_forward_kinematics(skeleton, std::span<const Matrix3<S>>(local), std::span<const Vec3<S>>(root.position),
                                  offsets);
}

MOTIONLANG_NAMESPACE_END
