// SPDX-License-Identifier: MIT
// Bodies of amass_body.hpp.
#pragma once

#include <algorithm>  // any_of

#include <motionlang/formats/amass_body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Joints of a sequence that follow the 22 of the body.
struct AmassPart {
  std::string_view name;
  Index first, count;
};
inline std::vector<AmassPart> amass_parts(Index columns) {
  const auto after = static_cast<Index>(amass_joints), joints = columns / 3;
  const BodyKind kind = body_kind_of(joints);
  if (kind == BodyKind::other) return {{"joints after the 22nd", after, joints - after}};
  const BodyKindInfo& info = body_kinds[static_cast<std::size_t>(kind)];
  if (kind == BodyKind::smpl) return {{"hands", after, 2}};
  std::vector<AmassPart> parts{{"left hand", info.left_hand, 15}, {"right hand", info.right_hand, 15}};
  if (kind == BodyKind::smplx) parts.push_back({"jaw and eyes", after, 3});
  return parts;
}
inline bool moves(const AmassSequence& sequence, const AmassPart& part) {
  for (Index frame = 0; frame < sequence.frames; ++frame) {
    const auto numbers = std::span(sequence.poses)
                             .subspan(static_cast<std::size_t>(frame * sequence.columns + 3 * part.first),
                                      static_cast<std::size_t>(3 * part.count));
    if (std::any_of(numbers.begin(), numbers.end(), [](double x) { return x != 0; })) return true;
  }
  return false;
}

MOTIONLANG_BODY void add_amass_parts(const AmassSequence& sequence, const Skeleton& skeleton, Motion& motion,
                                     std::vector<std::string>& parts, std::vector<std::string>& left_out) {
  const auto names = body_joint_names(body_kind_of(sequence.columns / 3), sequence.columns / 3);
  for (const AmassPart& part : amass_parts(sequence.columns)) {
    if (!moves(sequence, part)) continue;
    const int own = skeleton.find(names[static_cast<std::size_t>(part.first)]);
    (own >= 0 ? parts : left_out).emplace_back(part.name);
    for (Index frame = 0; own >= 0 && frame < sequence.frames; ++frame) {
      for (Index j = 0; j < part.count; ++j)
        motion.rotations(frame)[static_cast<std::size_t>(own + j)] = amass_rotation(sequence, frame, part.first + j);
    }
  }
}

}  // namespace detail

MOTIONLANG_BODY bool has_shapes_of(const AmassSequence& sequence, BodyKind body) {
  return (body_kind_of(sequence.columns / 3) == BodyKind::smplx) == (body == BodyKind::smplx);
}

MOTIONLANG_NAMESPACE_END
