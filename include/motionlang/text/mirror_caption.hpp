// SPDX-License-Identifier: MIT
/// The caption of a mirrored motion: left and right are exchanged.
///
///     left <-> right, with the endings -s, -ward(s), -most, -hand(ed)
///     clockwise <-> counterclockwise, anticlockwise -> clockwise; also in parts: "counter-clockwise", "clock-wise"
///
/// Only whole words are exchanged, all at once, with their capitals. The verb "left" is exchanged, too, because words
/// alone do not show the difference.
///
/// Source   Guo et al. (CVPR 2022): HumanML3D contains finished texts of mirrored clips, but no program that makes them
/// Differs  from the texts of the published KIT annotations, which exchange inside words: "upright" is "upleft" there
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
