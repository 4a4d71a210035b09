// SPDX-License-Identifier: MIT
/// Cuts texts into parts that a denoiser generates better. It cuts where their action is over, where they give body
/// parts to another text or regain them, and where they are too long.
///
///     const auto motion = stmc.generate(cut_texts(timeline, stmc.fps), rng);
///
/// Differs  from STMC (thesis 6.2.3, "Motion cropping and denoising"), where each text is one crop
#pragma once

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Seconds of a text that a denoiser generates as a whole. HumanML3D's clips and ours end at 9.8 s, and a model has
/// seen the longest crops least often. Ours walks as far in 8 s as in 10.
inline constexpr double longest_whole_text = 8;
/// The least seconds of a part, so that the denoiser can do what the text says.
inline constexpr double shortest_part = 0.5;

/// Applies end_actions, cut_at_handovers and divide_long_texts. Throws what they throw.
Timeline cut_texts(const Timeline& timeline, double fps);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/cut_texts.ipp>
#endif
