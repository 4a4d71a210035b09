// SPDX-License-Identifier: MIT
// Bodies of foot_lock.hpp.
#pragma once

#include <algorithm>  // max
#include <array>      // feet of a leg
#include <cmath>      // sin
#include <cstdint>    // flags
#include <numbers>    // pi
#include <optional>   // frames in the air
#include <vector>     // one value for each frame

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::span<const Leg> known_legs(const Skeleton& skeleton) {
  auto is = [&](const Skeleton& s) { return skeleton.names == s.names && skeleton.parents == s.parents; };
  if (is(smpl24_skeleton()) || is(humanml3d22_skeleton())) return smpl_legs;
  if (is(kit21_skeleton())) return kit_legs;
  return {};
}

namespace detail {

MOTIONLANG_BODY void require_legs(std::string_view function, const Skeleton& skeleton, std::span<const Leg> legs) {
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

MOTIONLANG_BODY Motion turn_from_feet(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
  detail::require_legs("turn_from_feet", motion.skeleton, legs);
  if (motion.frames() < 2 || legs.size() != 2) return motion;
  const auto positions = motion.positions();
  const Index joints = motion.skeleton.size();
  const auto at = [&](Index f, int joint) { return positions[static_cast<std::size_t>(f * joints + joint)]; };
  const auto down = [&](Index f) {
    return std::all_of(legs.begin(), legs.end(), [&](const Leg& leg) {
      return at(f, leg.limb.end).y - options.floor < options.ankle_height ||
             at(f, leg.toe).y - options.floor < options.toe_height;
    });
  };
  const double pivot = options.pivot * std::numbers::pi / 180 / motion.fps;
  std::vector<double> turned(static_cast<std::size_t>(motion.frames()), 0.0);  // the excess turn up to each frame
  for (Index f = 0; f + 1 < motion.frames(); ++f) {
    if (!down(f) || !down(f + 1)) continue;
    std::array<double, 2> turn{};
    for (std::size_t side = 0; side < 2; ++side) {
      const Vec3<double> a = at(f, legs[side].toe) - at(f, legs[side].limb.end),
                         b = at(f + 1, legs[side].toe) - at(f + 1, legs[side].limb.end);
      turn[side] = std::remainder(std::atan2(b.x, b.z) - std::atan2(a.x, a.z), 2 * std::numbers::pi);
    }
    if (turn[0] * turn[1] <= 0) continue;
    const double both = std::min(std::abs(turn[0]), std::abs(turn[1]));
    turned[static_cast<std::size_t>(f) + 1] = std::copysign(std::max(0.0, both - pivot), turn[0]);
  }
  const auto smooth = gaussian_smooth(std::span<const double>(turned), 1, options.path_sigma);
  Motion out = motion;
  double back = 0;
  for (std::size_t f = 1; f < smooth.size(); ++f) {
    const Vec3<double> up{0, 1, 0};
    Vec3<double> step = motion.root[f] - motion.root[f - 1];
    step = rotate(from_axis_angle(up, back), step);
    back -= smooth[f];
    out.root[f] = {out.root[f - 1].x + step.x, motion.root[f].y, out.root[f - 1].z + step.z};
    Quaternion<double>& root = out.rotations(static_cast<Index>(f))[0];
    root = normalized(from_axis_angle(up, back) * root);
  }
  return out;
}

MOTIONLANG_BODY Motion path_from_feet(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
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

/// (frames): the slide of a standing foot to the next frame, on its toe or its ankle, whichever carries it. Nothing for
/// a foot that swings, and in the last frame.
inline std::vector<std::optional<Vec3<double>>> standing_steps(const Motion& motion,
                                                               std::span<const Vec3<double>> positions, const Leg& leg,
                                                               const FootFixOptions& options) {
  std::vector<std::optional<Vec3<double>>> steps(static_cast<std::size_t>(motion.frames()));
  const auto [ankle_joint, toe_joint] = feet_of(leg, options);
  for (Index f = 0; f + 1 < motion.frames(); ++f) {
    const auto ankle = slide(positions, motion.skeleton.size(), f, ankle_joint, options.floor),
               toe = slide(positions, motion.skeleton.size(), f, toe_joint, options.floor);
    const auto& pivot = toe.low && (!ankle.low || toe.length() < ankle.length()) ? toe : ankle;
    if (pivot.low && pivot.length() * motion.fps < options.speed) steps[static_cast<std::size_t>(f)] = pivot.step;
  }
  return steps;
}

/// The direction in which the knee of a straight leg bends, seen from the thigh: that of the toes in the rest pose. +Z
/// if the foot does not show it.
inline Vec3<double> forward_of(const Skeleton& skeleton, const Leg& leg) {
  const auto rest = skeleton.rest_positions();
  const auto at = [&](int joint) { return rest[static_cast<std::size_t>(joint)]; };
  const Vec3<double> shank = at(leg.limb.end) - at(leg.limb.upper), foot = at(leg.toe) - at(leg.limb.end);
  const double length = dot(shank, shank);
  const Vec3<double> forward = length > 0 ? foot - (dot(foot, shank) / length) * shank : foot;
  return norm(forward) > 0.1 * norm(foot) ? normalized(forward) : Vec3<double>{0, 0, 1};
}

MOTIONLANG_BODY void move_foot(Motion& motion, const Leg& leg, std::span<const Vec3<double>> offset) {
  JointTransforms<double> world;
  const Vec3<double> forward_at_rest = forward_of(motion.skeleton, leg);
  for (Index f = 0; f < motion.frames(); ++f) {
    const Vec3<double> by = offset[static_cast<std::size_t>(f)];
    if (norm(by) < 1e-6) continue;
    motion.world(f, world);
    const Vec3<double> target = world.position[static_cast<std::size_t>(leg.limb.end)] + by;
    const Vec3<double> forward = world.rotation[static_cast<std::size_t>(leg.limb.upper)] * forward_at_rest;
    reach(motion.skeleton, motion.rotations(f), world, leg.limb, target, forward);
  }
}

/// (frames): the lift of a foot whose toe would otherwise swing too low. It must be `clearance` above the lower of the
/// heights at which it leaves the floor and returns. There is one bump sin^2 for each swing, at most `clearance` or a
/// tenth of its distance high, so that jitter is not lifted.
inline std::vector<Vec3<double>> swing_lifts(const Motion& motion, std::span<const Vec3<double>> positions,
                                             const Leg& leg, const FootFixOptions& options) {
  const Index frames = motion.frames(), joints = motion.skeleton.size();
  const auto standing = standing_steps(motion, positions, leg, options);
  auto toe = [&](Index f) { return positions[static_cast<std::size_t>(f * joints + leg.toe)]; };
  std::vector<Vec3<double>> lift(static_cast<std::size_t>(frames));
  for (Index first = 0; first + 1 < frames; ++first) {  // first: the last frame in which the foot stands
    if (standing[static_cast<std::size_t>(first)]) continue;
    Index last = first + 1;  // the next frame in which it stands
    while (last + 1 < frames && !standing[static_cast<std::size_t>(last)]) ++last;
    const bool from_floor = first > 0, to_floor = last + 1 < frames;
    auto bump = [&](Index f) {  // at an end of the clip the foot is in mid-swing
      const double t = static_cast<double>(f - first) / static_cast<double>(last - first);
      const double s = std::sin(std::numbers::pi * (from_floor && to_floor ? t : from_floor ? t / 2 : (1 - t) / 2));
      return s * s;
    };
    if (from_floor || to_floor) {
      const double from = toe(first).y, to = toe(last).y;
      const double level = options.clearance + (!to_floor ? from : !from_floor ? to : std::min(from, to));
      double height = 0, way = 0;
      for (Index f = first; f <= last; ++f) {
        if (bump(f) > 0.5) height = std::max(height, (level - toe(f).y) / bump(f));
        if (f > first) way += norm(Vec3<double>{toe(f).x - toe(f - 1).x, 0, toe(f).z - toe(f - 1).z});
      }
      height = std::min({height, options.clearance, way / 10});
      for (Index f = first; f <= last; ++f) lift[static_cast<std::size_t>(f)].y = height * bump(f);
    }
    first = last - 1;
  }
  return lift;
}

/// (frames): the offset that keeps a standing foot in its place. During a contact the offset undoes the slide; its mean
/// is zero, so that the foot stands at its average place. Between contacts it fades out and in.
inline std::vector<Vec3<double>> foot_offsets(const Motion& motion, std::span<const Vec3<double>> positions,
                                              const Leg& leg, const FootFixOptions& options) {
  const Index frames = motion.frames();
  const auto standing = standing_steps(motion, positions, leg, options);
  std::vector<std::uint8_t> fixed(standing.size(), 0);
  std::vector<Vec3<double>> offset(standing.size());
  for (std::size_t f = 0; f < standing.size(); ++f) {
    if (!standing[f]) continue;
    const std::size_t first = f;
    Vec3<double> sum{};
    for (; standing[f]; ++f) {  // nothing in the last frame
      offset[f + 1] = offset[f] - *standing[f];
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
        const double weight = smoothstep(1 - static_cast<double>(d) / static_cast<double>(options.blend + 1));
        share += weight;
        return weight * offset[static_cast<std::size_t>(from)];
      }
      return Vec3<double>{};
    };
    const Vec3<double> both = fade(-1) + fade(1);
    offset[static_cast<std::size_t>(f)] = (1 / std::max(share, 1.0)) * both;  // near contacts: their mean
  }
  return offset;
}

}  // namespace detail

MOTIONLANG_BODY Motion lock_feet(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
  detail::require_legs("lock_feet", motion.skeleton, legs);
  if (motion.frames() < 2) return motion;
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) detail::move_foot(out, leg, detail::foot_offsets(motion, positions, leg, options));
  return out;
}

MOTIONLANG_BODY Motion raise_swings(const Motion& motion, std::span<const Leg> legs, const FootFixOptions& options) {
  detail::require_legs("raise_swings", motion.skeleton, legs);
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) detail::move_foot(out, leg, detail::swing_lifts(motion, positions, leg, options));
  return out;
}

MOTIONLANG_NAMESPACE_END
