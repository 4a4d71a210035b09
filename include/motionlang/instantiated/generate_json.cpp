// SPDX-License-Identifier: MIT
// Bodies of the headers in generate/ that need nlohmann_json, compiled once for motionlang::instantiated.
#include <motionlang/generate/describe_files.ipp>
#include <motionlang/generate/gallery_prompts.ipp>
#include <motionlang/generate/guo_motions.ipp>
#include <motionlang/generate/joined_timeline.ipp>
#include <motionlang/generate/missing_parts.ipp>
#include <motionlang/generate/motion_model_place.ipp>
#include <motionlang/generate/mtt_runs.ipp>
#include <motionlang/generate/studio_request.ipp>
#include <motionlang/generate/studio_server.ipp>
#include <motionlang/generate/timeline_report.ipp>
#include <motionlang/generate/token_clips.ipp>
