// SPDX-License-Identifier: MIT
// Bodies of the headers in compose/, compiled once for motionlang::instantiated.
#include <motionlang/compose/baselines.ipp>
#include <motionlang/compose/body_part_answers.ipp>
#include <motionlang/compose/body_part_lexicon.ipp>
#include <motionlang/compose/body_part_prompts.ipp>
#include <motionlang/compose/collage.ipp>
#include <motionlang/compose/cut_texts.ipp>
#include <motionlang/compose/describe_plan.ipp>
#include <motionlang/compose/detail/seconds_text.ipp>
#include <motionlang/compose/edits.ipp>
#include <motionlang/compose/handovers.ipp>
#include <motionlang/compose/in_turn.ipp>
#include <motionlang/compose/long_texts.ipp>
#include <motionlang/compose/mtt_timelines.ipp>
#include <motionlang/compose/natural_lengths.ipp>
#include <motionlang/compose/overlap.ipp>
#include <motionlang/compose/plan.ipp>
#include <motionlang/compose/sinc_composition.ipp>
#include <motionlang/compose/stitching.ipp>
#include <motionlang/compose/text_sinc_parts.ipp>
#include <motionlang/compose/text_timeline.ipp>
#include <motionlang/compose/timeline.ipp>
#include <motionlang/compose/timeline_text.ipp>
