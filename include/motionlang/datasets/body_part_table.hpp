// SPDX-License-Identifier: MIT
/// A language model's answers about body parts from a file: label -> answers. SINC takes the third one.
///
///     {"wave right hand": ["", "", "Answer: right arm"], ...}
///
/// Source  SINC (Athanasiou et al., ICCV 2023), thesis B.2.1. The published table is not part of this library.
#pragma once

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonMembers;

/// Throws io_error 401, 403 (JsonMembers), and config_error 107 if there is no such answer, 103 if it names no part.
BodyPartTable read_body_part_table(const JsonMembers& file, Index answer = 2);
BodyPartTable open_body_part_table(const FilePath& path, Index answer = 2);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/body_part_table.ipp>
#endif
