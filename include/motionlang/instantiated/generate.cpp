// SPDX-License-Identifier: MIT
// Bodies of the headers in generate/, compiled once for motionlang::instantiated.
#include <motionlang/generate/actor_latents.ipp>
#include <motionlang/generate/arm_overlay.ipp>
#include <motionlang/generate/babel_latents.ipp>
#include <motionlang/generate/detail/kept_clip.ipp>
#include <motionlang/generate/finish_motion.ipp>
#include <motionlang/generate/judged_clips.ipp>
#include <motionlang/generate/judged_prompts.ipp>
#include <motionlang/generate/judged_verbs.ipp>
#include <motionlang/generate/judgement_report.ipp>
#include <motionlang/generate/kept_clip_text.ipp>
#include <motionlang/generate/latent_motion_model.ipp>
#include <motionlang/generate/motion_model.ipp>
#include <motionlang/generate/reuse_notes.ipp>
#include <motionlang/generate/samples.ipp>
#include <motionlang/generate/shared_motions.ipp>
#include <motionlang/generate/text_warnings.ipp>
#include <motionlang/generate/timeline_tracks.ipp>
#include <motionlang/generate/timelines_of_text.ipp>
