// SPDX-License-Identifier: MIT
/// Cuts texts where their body parts change.
///
/// As published, a text that goes on while another borrows its arms is one crop. So the denoiser sees raised arms in
/// the middle of "walk forward" and keeps them up before and after. If the text is cut at these times, it walks with
/// its own arms, then without them, then with its own again. The transitions stay where they were.
///
///     const auto motion = stmc.generate(cut_at_handovers(timeline, 10), rng);
///
/// Differs  from STMC (thesis 6.2.3, "Motion cropping and denoising"), where each text is one crop
#pragma once

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Cuts every text at the times at which it gets or loses body parts, unless a piece would be shorter than `least`
/// frames. Throws config_error 101 if too many texts overlap.
Timeline cut_at_handovers(const Timeline& timeline, Index least);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/handovers.ipp>
#endif
