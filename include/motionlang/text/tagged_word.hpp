// SPDX-License-Identifier: MIT
/// A word of a caption with its part of speech, as in the caption files of HumanML3D.
#pragma once

#include <string>  // words

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A word as its lemma, with its part of speech: "walk" and "VERB". The tag is empty if none was written.
struct TaggedWord {
  std::string word, tag;
  bool operator==(const TaggedWord&) const = default;
};

MOTIONLANG_NAMESPACE_END
