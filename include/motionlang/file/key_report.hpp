// SPDX-License-Identifier: MIT
/// Names of tensors that do not match between a file and a model, as one list that a person can act on.
#pragma once

#include <cstddef>      // sizes
#include <string>       // names
#include <string_view>  // names
#include <vector>       // lists

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Names that a file lacks, and names that nobody asked for.
struct KeyReport {
  std::vector<std::string> missing, unexpected;
};

/// How many characters have to be inserted, removed or exchanged to make b of a (Levenshtein), or `limit` if it is that
/// many.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit);

/// The name that is most like `name`; empty if none has half of it. Of a long list only the first 2,000 names are
/// looked at.
std::string nearest_name(std::string_view name, const std::vector<std::string>& among);

/// A line for each name, and beside it the name of the other list that is most like it.
std::string to_string(const KeyReport& report);

namespace detail {

[[noreturn]] void raise_key_mismatch(std::string_view file, const KeyReport& report);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/key_report.ipp>
#endif
