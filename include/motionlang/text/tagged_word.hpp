// SPDX-License-Identifier: MIT
/// A word of a caption with its part of speech, as the caption files of HumanML3D list them.
#pragma once

#include <string>  // words

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A word as its lemma, with its part of speech: "walk" and "VERB". No tag: none was written.
struct TaggedWord {
  std::string word, tag;
  bool operator==(const TaggedWord&) const = default;
};

MOTIONLANG_NAMESPACE_END
