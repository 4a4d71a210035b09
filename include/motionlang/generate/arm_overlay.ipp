// SPDX-License-Identifier: MIT
// Bodies of arm_overlay.hpp.
#pragma once

#include <algorithm>  // max, min

#include <motionlang/compose/plan.hpp>
#include <motionlang/generate/arm_overlay.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<ArmText> arm_texts(const Timeline& timeline, Index shortest) {
  constexpr BodyParts both = BodyParts{}.with(BodyPart::left_arm).with(BodyPart::right_arm);
  std::vector<ArmText> out;
  if (!(timeline.body == BodyPartition{})) return out;
  FirstWins ties;
  const auto pieces = elementary_pieces(timeline);
  for (Index i = 0; i < std::ssize(timeline.intervals); ++i) {
    const Interval& text = timeline.intervals[static_cast<std::size_t>(i)];
    if (text.parts.empty() || (text.parts.bits & ~both.bits) != 0) continue;
    for (const BodyPart arm : {BodyPart::left_arm, BodyPart::right_arm}) {
      ArmText entry{{{{text.text, 0, text.end - text.start, BodyParts::all()}}}, text.start, arm, {}};
      entry.on.assign(static_cast<std::size_t>(text.end - text.start), 0);
      Index frames = 0;
      for (const Piece& piece : pieces) {
        if (piece.intervals.empty()) continue;
        const auto owners = assign_parts(timeline, piece.intervals, ties);
        const auto owner = [&](BodyPart part) { return owners[static_cast<std::size_t>(part)]; };
        if (owner(arm) != i || owner(BodyPart::legs) == i) continue;
        for (Index f = piece.start; f < piece.end; ++f, ++frames)
          entry.on[static_cast<std::size_t>(f - text.start)] = 1;
      }
      if (frames >= shortest) out.push_back(std::move(entry));
    }
  }
  return out;
}

MOTIONLANG_BODY double arm_extent(const Motion& motion, BodyPart arm, std::span<const std::uint8_t> on, Index start) {
  constexpr std::size_t chest = 9;
  const std::size_t wrist = arm == BodyPart::left_arm ? 20 : 21;
  Vec3<double> low{1e9, 1e9, 1e9}, high = -1.0 * low;
  JointTransforms<double> world;
  const Index frames = std::min(std::ssize(on), motion.frames() - start);
  for (Index f = 0; f < frames; ++f) {
    if (on[static_cast<std::size_t>(f)] == 0) continue;
    motion.world(start + f, world);
    const Vec3<double> p =
        rotate(inverse(to_quaternion(world.rotation[chest])), world.position[wrist] - world.position[chest]);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return low.x > high.x ? 0 : norm(high - low);
}

MOTIONLANG_BODY bool is_arm_lost(const Motion& motion, const Motion& alone, const ArmText& text) {
  return arm_extent(motion, text.arm, text.on, text.start) < lost_arm_share * arm_extent(alone, text.arm, text.on);
}

MOTIONLANG_BODY Motion lay_arm_over(const Motion& motion, const Motion& alone, const ArmText& text, Index blend) {
  Motion out = motion;
  const Index frames = std::min({std::ssize(text.on), alone.frames(), motion.frames() - text.start});
  const auto on = [&](Index f) { return f >= 0 && f < frames && text.on[static_cast<std::size_t>(f)] != 0; };
  for (Index f = 0; f < frames; ++f) {
    if (!on(f)) continue;
    Index near = blend + 1;  // frames to the next one of another text; ends of the motion do not count
    for (Index d = 1; d <= blend; ++d) {
      const bool before = text.start + f - d >= 0 && !on(f - d),
                 behind = text.start + f + d < motion.frames() && !on(f + d);
      if (before || behind) near = std::min(near, d);
    }
    const double weight = smoothstep(static_cast<double>(near) / static_cast<double>(blend + 1));
    const auto from = alone.rotations(f);
    const auto to = out.rotations(text.start + f);
    for (std::size_t j = 1; j < to.size(); ++j) {
      if (smpl_part_of_joint[j] == text.arm) to[j] = slerp(to[j], from[j], weight);
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
