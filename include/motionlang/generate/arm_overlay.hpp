// SPDX-License-Identifier: MIT
/// Repairs arms that do not do what their text says. Beside a text that sits, stands or bends, the text of an arm may
/// move it half as far as alone, or not at all. The arm of a motion from that text alone then replaces it.
///
///     for (const ArmText& text : arm_texts(timeline, 10))   // that last ten frames or longer
///       if (is_arm_lost(motion, alone, text)) motion = lay_arm_over(motion, alone, text);    // alone: of text.alone
///
/// Source  the composition of SINC (Athanasiou et al., ICCV 2023; kinematics/overlay.hpp), for the arms only
#pragma once

#include <motionlang/compose/timeline.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A text of one arm or both, while other texts have the legs.
struct ArmText {
  Timeline alone;                // the text by itself, on the whole body
  Index start = 0;               // the frame of the timeline at which it begins
  BodyPart arm{};                // left_arm or right_arm
  std::vector<std::uint8_t> on;  // (frames of `alone`): 1 where the arm belongs to the text
};

/// One entry for each arm of each text that has only arms, while another text has the legs. Texts that have the arm for
/// less than `shortest` frames are left out.
std::vector<ArmText> arm_texts(const Timeline& timeline, Index shortest);

/// The range of the wrist in a clip, seen from the chest: the diagonal of its bounding box in metres. For SMPL's
/// joints. Only frames in which `on` is 1 count; `start` is the frame of the clip at which it begins.
double arm_extent(const Motion& motion, BodyPart arm, std::span<const std::uint8_t> on, Index start = 0);

/// An arm is lost if its range in the collage is below this share of its range alone.
inline constexpr double lost_arm_share = 0.8;

/// True if the range of the arm is below lost_arm_share of that alone.
bool is_arm_lost(const Motion& motion, const Motion& alone, const ArmText& text);

/// The motion with the local rotations of the arm from `alone`. They are blended in and out over `blend` frames, if the
/// arm has frames before or after.
Motion lay_arm_over(const Motion& motion, const Motion& alone, const ArmText& text, Index blend = 6);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/arm_overlay.ipp>
#endif
