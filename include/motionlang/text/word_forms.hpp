// SPDX-License-Identifier: MIT
/// The forms of English words: "strolled" is looked up as "stroll" where only that is known.
#pragma once

#include <string>       // words
#include <string_view>  // endings

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The word itself if it is known, else its first known form without -ing, -ed, -es or -s ("hopping" is "hop", "waving"
/// is "wave", "hurries" is "hurry"), else the word.
/// known  whether a word has an entry
template <class Known>
std::string known_form(const std::string& word, const Known& known) {
  if (known(word)) return word;
  for (const std::string_view end : {"ies", "ied", "ing", "ed", "es", "s"}) {
    if (!word.ends_with(end) || word.size() < end.size() + 2) continue;
    std::string stem = word.substr(0, word.size() - end.size());
    if (end.front() == 'i' && end != "ing") {
      if (known(stem + "y")) return stem + "y";
      continue;
    }
    if (known(stem)) return stem;
    if (known(stem + "e")) return stem + "e";
    if (stem.back() == stem[stem.size() - 2] && known(stem.substr(0, stem.size() - 1)))
      return stem.substr(0, stem.size() - 1);
  }
  return word;
}

MOTIONLANG_NAMESPACE_END
