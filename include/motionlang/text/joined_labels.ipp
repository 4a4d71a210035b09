// SPDX-License-Identifier: MIT
// Bodies of joined_labels.hpp.
#pragma once

#include <motionlang/text/joined_labels.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string second_verb_to_gerund(std::span<const TaggedWord> words) {
  std::string out;
  int verbs = 0;
  for (const TaggedWord& w : words) {
    if (!out.empty()) out += ' ';
    out += w.word;
    if (w.tag == "VERB" && ++verbs == 2 && !w.word.ends_with("ing")) out += "ing";
  }
  return out;
}

namespace detail {

MOTIONLANG_BODY std::string sentence_of_labels(std::span<const std::string> labels, Conjunction conjunction) {
  using enum Conjunction;
  const bool several = labels.size() > 1;
  const std::string_view between = conjunction == while_   ? " while "
                                   : conjunction == during ? " during "
                                   : conjunction == comma  ? ", "
                                                           : " and ";
  std::string out;
  for (const std::string& label : labels) {
    if (&label != labels.data()) out += between;
    out += label;
  }
  if (several && conjunction == simultaneously) out = "simultaneously " + out;
  if (several && conjunction == same_time) out += " at the same time";
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
