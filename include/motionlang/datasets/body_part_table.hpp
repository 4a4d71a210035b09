// SPDX-License-Identifier: MIT
/// A language model's answers about body parts from a file: label -> answers, of which SINC takes the third.
///
///     {"wave right hand": ["", "", "Answer: right arm"], ...}
///
/// Source  SINC (Athanasiou et al., ICCV 2023), thesis B.2.1. The published table is the user's to supply.
#pragma once

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonMembers;

/// Throws io_error 401, 403 (JsonMembers), config_error 107 if there is no such answer, 103 if it names no part.
BodyPartTable read_body_part_table(const JsonMembers& file, Index answer = 2);
BodyPartTable open_body_part_table(const FilePath& path, Index answer = 2);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/body_part_table.ipp>
#endif
