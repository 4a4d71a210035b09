// SPDX-License-Identifier: MIT
/// Options for planning timelines.
#pragma once

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The rule for frames without a text: let the model move freely, or throw timeline_error 505.
enum class Gaps { fill, refuse };
/// The rule for a cut at which no part changes its owner, because other texts hide a text. `refuse` throws
/// timeline_error 506, and `ignore` leaves the transition out. The result is the same without it.
enum class HiddenTexts { refuse, ignore };

/// The default number of frames that go through the denoiser together. Timelines of 12 s with five tracks have fewer,
/// with and without their texts. The published network needs about 90 MB for them.
inline constexpr Index usual_rows_at_once = 4096;

struct PlanOptions {
  Index overlap = 10;            // frames in total around a cut; 0.5 s at 20 fps
  bool extend = true;            // intervals reach into their neighbours by the overlap
  bool transition_crops = true;  // an unconditional crop around every cut. Both off: SINC, hard cuts
  Gaps gaps = Gaps::fill;
  HiddenTexts hidden = HiddenTexts::refuse;
  Index longest_crop = 0;  // frames that the denoiser accepts; 0: any
};

MOTIONLANG_NAMESPACE_END
