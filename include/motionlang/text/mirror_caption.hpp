// SPDX-License-Identifier: MIT
/// The caption of a mirrored motion: left and right are exchanged.
///
///     left <-> right, with the endings -s, -ward(s), -most, -hand(ed)
///     clockwise <-> counterclockwise, anticlockwise -> clockwise; also in parts: "counter-clockwise", "clock-wise"
///
/// Whole words, capitals kept, all at once. "left" as a verb is exchanged, too: words do not tell.
///
/// Source   Guo et al. (CVPR 2022): HumanML3D ships finished texts of mirrored clips, no program that makes them
/// Differs  from the texts of the published KIT annotations, which exchange inside of words: "upright" is "upleft"
///          there
#pragma once

#include <string>       // caption
#include <string_view>  // parts of it

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The caption of the mirrored motion.
std::string mirror_caption(std::string_view caption);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/mirror_caption.ipp>
#endif
