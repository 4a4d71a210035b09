// SPDX-License-Identifier: MIT
/// Lists of clips: the split files of data sets (train.txt, val.txt, test.txt, ...), one id on each line.
#pragma once

#include <span>         // ids
#include <string>       // ids
#include <string_view>  // ids
#include <vector>       // ids

#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// True if an id can be the name of a file in the folder of its data set: it has no control characters and does not
/// lead out.
bool is_clip_id(std::string_view id);

}  // namespace detail

/// The ids in a text, in order, without blanks around them. Empty lines are skipped, and repeated ids stay. Throws
/// io_error 403, with the line, for an id that cannot name a file below a folder.
std::vector<std::string> parse_ids(std::string_view text, std::string_view name = "list of ids");
/// Throws io_error 401 and as parse_ids.
std::vector<std::string> read_ids(const FilePath& path);
/// Throws io_error 401, and 403 for an id that could not be read again.
void write_ids(const FilePath& path, std::span<const std::string> ids);

/// The ids of mirrored clips begin with M.
inline std::string mirrored_id(std::string_view id) { return concat_text("M", id); }

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/id_list.ipp>
#endif
