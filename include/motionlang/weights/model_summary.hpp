// SPDX-License-Identifier: MIT
/// A summary of a model folder for readers: motions, texts or actions, and networks.
#pragma once

#include <string>   // names and values
#include <utility>  // pairs
#include <vector>   // lines

#include <motionlang/weights/run_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Lines of a name and a value each.
using ModelSummary = std::vector<std::pair<std::string, std::string>>;

/// For the published ACTOR, TEMOS, TEACH, SINC, TMR, TM2T and MDM of actions, the sizes from their tensors. For folders
/// of our own trainings, what their config.json says. For other folders, nothing. Throws what the readers of these
/// folders throw.
ModelSummary model_summary(const RunFolder& run);

/// The same as text with the system, its files and its licence, a line each: "  system                   tmr". "" for a
/// folder of an unknown system. Throws what find_run and read_model_folder throw.
std::string describe_folder(const FilePath& folder);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/model_summary.ipp>
#endif
