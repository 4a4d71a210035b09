// SPDX-License-Identifier: MIT
/// Arms that a collage of texts loses: beside a text that sits, stands or bends, a text of an arm may move it half as
/// far as alone, or not at all. What the text makes alone is then laid over the collage.
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
  Index start = 0;               // frame of the timeline in which it begins
  BodyPart arm{};                // left_arm or right_arm
  std::vector<std::uint8_t> on;  // (frames of `alone`): 1 where the arm is the text's
};

/// One entry for each arm of each text that has no other part than arms, where another text has the legs meanwhile.
/// Texts that have the arm for less than `shortest` frames are left out.
std::vector<ArmText> arm_texts(const Timeline& timeline, Index shortest);

/// How far the wrist comes in a clip, seen from the chest: the diagonal of the box in which it stays, metres. SMPL's
/// joints. Counts frames in which `on` is 1; `start` is the frame of the clip where it begins.
double arm_extent(const Motion& motion, BodyPart arm, std::span<const std::uint8_t> on, Index start = 0);

/// A share of the extent of an arm alone. In the collage, an arm that comes less far is lost.
inline constexpr double lost_arm_share = 0.8;

/// True if an arm comes less than lost_arm_share as far as alone.
bool is_arm_lost(const Motion& motion, const Motion& alone, const ArmText& text);

/// The motion with the local rotations of the arm from `alone`; they come and go within `blend` frames, as far as the
/// arm has any before or behind.
Motion lay_arm_over(const Motion& motion, const Motion& alone, const ArmText& text, Index blend = 6);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/arm_overlay.ipp>
#endif
