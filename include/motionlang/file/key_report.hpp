// SPDX-License-Identifier: MIT
/// Names of tensors that do not match between a file and a model, as a list that tells a person what to do.
#pragma once

#include <cstddef>      // sizes
#include <string>       // names
#include <string_view>  // names
#include <vector>       // lists

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Names that a file lacks, and names that the model does not use.
struct KeyReport {
  std::vector<std::string> missing, unexpected;
};

/// The number of steps that turn a into b, but at most `limit`. A step inserts, removes or exchanges a character, or
/// swaps two neighbours, as in "rigth" (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit);

/// The name that is most similar to `name`; empty if none shares half of it. Only the first 2,000 names of a long list
/// are compared.
std::string nearest_name(std::string_view name, const std::vector<std::string>& among);

/// A line for each name, with the most similar name of the other list.
std::string to_string(const KeyReport& report);

namespace detail {

[[noreturn]] void raise_key_mismatch(std::string_view file, const KeyReport& report);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/key_report.ipp>
#endif
