// SPDX-License-Identifier: MIT
/// Feet that stay where they stand. Y up, metres. Generated motions slide a little: the path of the root and the legs
/// are predicted side by side and agree only nearly.
///
///     Motion steady = fix_feet(motion);      // path_from_feet, then lock_feet
#pragma once

#include <algorithm>  // max
#include <array>      // feet of a leg
#include <cstdint>    // flags
#include <optional>   // frames in the air
#include <vector>     // one value for each frame

#include <motionlang/kinematics/foot_contact.hpp>
#include <motionlang/kinematics/limb_ik.hpp>
#include <motionlang/kinematics/smoothing.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// A leg and its toe.
struct Leg {
  Limb limb;
  int toe = 0;
};
inline constexpr Leg smpl_legs[] = {{{1, 4, 7}, 10}, {{2, 5, 8}, 11}};

struct FootFixOptions {
  double floor = 0;
  double ankle_height = smpl_ankle_contact, toe_height = smpl_toe_contact;  // below: in contact
  double speed = 0.5;       // m/s; lock_feet takes a foot that slides faster to swing
  double path_speed = 2;    // m/s; path_from_feet takes no foot that slides faster to carry the body
  double path_sigma = 1.5;  // frames; smoothness of the correction of the path
  Index blend = 4;          // frames before and after a contact in which the leg comes and goes
};

namespace detail {

/// Throws config_error 103 unless the skeleton has these legs.
inline void require_legs(std::string_view function, const Skeleton& skeleton, std::span<const Leg> legs) {
  for (const Leg& leg : legs) {
    require_limb(function, skeleton, leg.limb);
    if (leg.toe < 0 || leg.toe >= skeleton.size())
      raise<config_error>(103, function, ": toe ", leg.toe, " of a skeleton of ", skeleton.size());
  }
}

/// The two joints of a leg that may stand: ankle and toe.
inline std::array<ContactJoint, 2> feet_of(const Leg& leg, const FootFixOptions& options) {
  return {{{leg.limb.end, options.ankle_height}, {leg.toe, options.toe_height}}};
}

}  // namespace detail

/// The clip with its path over the floor corrected so that the foot that stands (of the low ones the slowest) does not
/// slide: where somebody goes is decided by the legs. Rotations and heights stay; in the air the path stays, too.
/// Throws config_error 103 if the skeleton has no such legs, 101 unless path_sigma > 0.
inline Motion path_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                             const FootFixOptions& options = {}) {
  detail::require_legs("path_from_feet", motion.skeleton, legs);
  const Index joints = motion.skeleton.size(), steps = motion.frames() - 1;
  if (steps < 1) return motion;
  const auto positions = motion.positions();
  std::vector<double> wanted;  // (steps, 3): x, z, weight
  for (Index f = 0; f < steps; ++f) {
    std::optional<detail::Slide> slowest;
    for (const Leg& leg : legs) {
      for (const ContactJoint& foot : detail::feet_of(leg, options)) {
        const auto s = detail::slide(positions, joints, f, foot, options.floor);
        const bool stands = s.low && s.length() * motion.fps < options.path_speed;
        if (stands && (!slowest || s.length() < slowest->length())) slowest = s;
      }
    }
    if (slowest)
      wanted.insert(wanted.end(), {slowest->step.x, slowest->step.z, 1.0});
    else
      wanted.insert(wanted.end(), {0.0, 0.0, 0.0});
  }
  const auto smooth = gaussian_smooth(std::span<const double>(wanted), 3, options.path_sigma);
  Motion out = motion;
  Vec3<double> moved{};
  for (Index f = 0; f < steps; ++f) {
    const double* s = smooth.data() + 3 * f;
    const double weight = std::max(s[2], 0.25);  // few contacts near: less
    moved = moved - Vec3<double>{s[0] / weight, 0, s[1] / weight};
    auto& root = out.root[static_cast<std::size_t>(f) + 1];
    root = root + moved;
  }
  return out;
}

namespace detail {

/// (frames): by how much a foot has to be moved to stay where it stands. During a contact the offset undoes the slide; its
/// mean is zero, so that the foot stands where it was on average. Between contacts it fades out and in.
inline std::vector<Vec3<double>> foot_offsets(const Motion& motion, std::span<const Vec3<double>> positions,
                                              const Leg& leg, const FootFixOptions& options) {
  const Index joints = motion.skeleton.size(), frames = motion.frames();
  // held[f]: the foot stands from frame f to f + 1; step: how far it slides meanwhile
  std::vector<std::uint8_t> held(static_cast<std::size_t>(frames), 0), fixed(held);
  std::vector<Vec3<double>> step(held.size()), offset(held.size());
  const auto [ankle_joint, toe_joint] = feet_of(leg, options);
  for (Index f = 0; f + 1 < frames; ++f) {
    const auto ankle = slide(positions, joints, f, ankle_joint, options.floor),
               toe = slide(positions, joints, f, toe_joint, options.floor);
    const auto& pivot = toe.low && (!ankle.low || toe.length() < ankle.length()) ? toe : ankle;
    const auto at = static_cast<std::size_t>(f);
    if (pivot.low && pivot.length() * motion.fps < options.speed) held[at] = 1, step[at] = pivot.step;
  }
  for (std::size_t f = 0; f < held.size(); ++f) {
    if (held[f] == 0) continue;
    const std::size_t first = f;
    Vec3<double> sum{};
    for (; held[f] != 0; ++f) {  // the last frame is never held
      offset[f + 1] = offset[f] - step[f];
      sum = sum + offset[f + 1];
    }
    const Vec3<double> mean = (1.0 / static_cast<double>(f - first + 1)) * sum;
    for (std::size_t i = first; i <= f; ++i) offset[i] = offset[i] - mean, fixed[i] = 1;
  }
  for (Index f = 0; f < frames; ++f) {
    if (fixed[static_cast<std::size_t>(f)] != 0) continue;
    double share = 0;
    auto fade = [&](Index direction) {  // from the nearest contact on one side
      for (Index d = 1; d <= options.blend; ++d) {
        const Index from = f + direction * d;
        if (from < 0 || from >= frames) break;
        if (fixed[static_cast<std::size_t>(from)] == 0) continue;
        const double t = 1 - static_cast<double>(d) / static_cast<double>(options.blend + 1);
        const double weight = t * t * (3 - 2 * t);
        share += weight;
        return weight * offset[static_cast<std::size_t>(from)];
      }
      return Vec3<double>{};
    };
    const Vec3<double> both = fade(-1) + fade(1);
    offset[static_cast<std::size_t>(f)] = (1 / std::max(share, 1.0)) * both;  // contacts that are near: their mean
  }
  return offset;
}

}  // namespace detail

/// The clip with legs bent so that ankles and toes in contact stay in place. Between contacts the correction fades out
/// and in. Throws config_error 103 if the skeleton has no such legs, numeric_error 302 if a leg has no length.
inline Motion lock_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                        const FootFixOptions& options = {}) {
  detail::require_legs("lock_feet", motion.skeleton, legs);
  if (motion.frames() < 2) return motion;
  const auto positions = motion.positions();
  Motion out = motion;
  JointTransforms<double> world;
  for (const Leg& leg : legs) {
    const auto offset = detail::foot_offsets(motion, positions, leg, options);
    for (Index f = 0; f < motion.frames(); ++f) {
      const Vec3<double> by = offset[static_cast<std::size_t>(f)];
      if (norm(by) < 1e-6) continue;
      out.world(f, world);
      const Vec3<double> target = world.position[static_cast<std::size_t>(leg.limb.end)] + by;
      const Vec3<double> forward = world.rotation[static_cast<std::size_t>(leg.limb.upper)] * Vec3<double>{0, 0, 1};
      reach(out.skeleton, out.rotations(f), world, leg.limb, target, forward);
    }
  }
  return out;
}

/// path_from_feet, then lock_feet. Throws what they throw.
inline Motion fix_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                       const FootFixOptions& options = {}) {
  return lock_feet(path_from_feet(motion, legs, options), legs, options);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
