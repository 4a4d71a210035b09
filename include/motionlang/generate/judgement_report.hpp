// SPDX-License-Identifier: MIT
/// Judgements as text and pictures: how many motions do what their prompts say, what recordings do, what steps cost.
#pragma once

#include <map>     // metadata
#include <string>  // tables

#include <motionlang/file/file_path.hpp>
#include <motionlang/generate/judged_clips.hpp>
#include <motionlang/generate/judged_prompts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A line for each prompt with the number of motions that do what it says, and its rule; then the sum, foot skate,
/// jitter, and the shares of motions that look wrong.
/// details  adds a line for each motion, with the reason if it fails
std::string describe_judgement(const Judgement& judgement, bool details = false);

/// The header of a table in Markdown with a row for each judgement, and such a row.
/// seconds  of the motions; 0: each prompt has its own length
std::string judgement_header();
std::string judgement_row(const Judgement& judgement, const std::string& about, double seconds);

/// The measures of recordings, and for each verb how many of them do what their captions say.
/// details  adds the recordings that fail, with the reason
std::string describe_recordings(const RecordedFigures& figures, bool details = false);

/// The line about the recordings of a training, from the metadata of its weights; "" if it is not there. `name` is the
/// file. Throws config_error 107 for a value that is not a number.
std::string recordings_line(const std::map<std::string, std::string>& metadata, const std::string& name);

/// The header of a table in Markdown with a row for each number of steps, and such a row.
std::string steps_cost_header();
std::string steps_cost_row(const std::string& sampler, const StepsCost& cost);

/// Writes a film strip of each motion, NAME_PROMPT_SEED.png, with the verdict as its title. The judgement must have
/// kept its motions. Throws io_error 401.
void write_judged_strips(const FilePath& folder, const std::string& name, const Judgement& judgement);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/judgement_report.ipp>
#endif
