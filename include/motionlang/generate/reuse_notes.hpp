// SPDX-License-Identifier: MIT
/// Records of runs on disk, and what a run says that reused one.
///
///     options.reuse = find_record("out");                      // the only *.steps.safetensors there
///     std::cout << reuse_notes(*notes.reuse, options.keep_beyond);
#pragma once

#include <filesystem>  // records
#include <optional>    // seconds
#include <string>      // notes

#include <motionlang/systems/stmc_reuse.hpp>

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr const char* record_extension = ".steps.safetensors";

/// The file of a run with GenerateOptions::record: the path itself, or the only such file in the folder. Throws
/// io_error 401.
std::filesystem::path find_record(const std::filesystem::path& path);

/// Lines: how much was reused, whether the motion is that of a whole run, and why not more.
/// keep_beyond  that of the run
std::string reuse_notes(const StmcReuse& reuse, std::optional<double> keep_beyond);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/reuse_notes.ipp>
#endif
