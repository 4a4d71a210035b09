// SPDX-License-Identifier: MIT
// Bodies of body_part_lexicon.hpp.
#pragma once

#include <algorithm>  // find, search
#include <array>      // lexicon
#include <span>       // lists of words
#include <string>     // words
#include <vector>     // words

#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The meaning of a word stem for the body. `arm` is one arm; the rest of the text gives the side.
struct WordMeaning {
  std::string_view stem;
  bool arm = false, arms = false, legs = false, head = false, spine = false;
};

// clang-format off
inline constexpr std::array lexicon = {
    // nouns
    WordMeaning{.stem = "arm", .arm = true},       WordMeaning{.stem = "arms", .arms = true},
    WordMeaning{.stem = "hand", .arm = true},      WordMeaning{.stem = "hands", .arms = true},
    WordMeaning{.stem = "elbow", .arm = true},     WordMeaning{.stem = "elbows", .arms = true},
    WordMeaning{.stem = "wrist", .arm = true},     WordMeaning{.stem = "wrists", .arms = true},
    WordMeaning{.stem = "fist", .arm = true},      WordMeaning{.stem = "fists", .arms = true},
    WordMeaning{.stem = "finger", .arm = true},    WordMeaning{.stem = "thumb", .arm = true},
    WordMeaning{.stem = "shoulders", .arms = true}, WordMeaning{.stem = "shoulder", .arm = true},
    WordMeaning{.stem = "leg", .legs = true},      WordMeaning{.stem = "foot", .legs = true},
    WordMeaning{.stem = "feet", .legs = true},     WordMeaning{.stem = "knee", .legs = true},
    WordMeaning{.stem = "ankle", .legs = true},    WordMeaning{.stem = "toe", .legs = true},
    WordMeaning{.stem = "hip", .legs = true},      WordMeaning{.stem = "stair", .legs = true},
    WordMeaning{.stem = "head", .head = true},     WordMeaning{.stem = "neck", .head = true},
    WordMeaning{.stem = "torso", .spine = true},   WordMeaning{.stem = "spine", .spine = true},
    WordMeaning{.stem = "waist", .spine = true},   WordMeaning{.stem = "belly", .spine = true},
    // one arm
    WordMeaning{.stem = "wav", .arm = true},       WordMeaning{.stem = "point", .arm = true},
    WordMeaning{.stem = "throw", .arm = true},     WordMeaning{.stem = "toss", .arm = true},
    WordMeaning{.stem = "punch", .arm = true},     WordMeaning{.stem = "salut", .arm = true},
    WordMeaning{.stem = "knock", .arm = true},     WordMeaning{.stem = "writ", .arm = true},
    WordMeaning{.stem = "scratch", .arm = true},   WordMeaning{.stem = "wip", .arm = true},
    WordMeaning{.stem = "stir", .arm = true},      WordMeaning{.stem = "pour", .arm = true},
    WordMeaning{.stem = "drink", .arm = true, .head = true}, WordMeaning{.stem = "eat", .arm = true, .head = true},
    WordMeaning{.stem = "phon", .arm = true, .head = true},  WordMeaning{.stem = "grab", .arm = true},
    WordMeaning{.stem = "reach", .arm = true},     WordMeaning{.stem = "pick", .arm = true, .spine = true},
    WordMeaning{.stem = "brush", .arm = true},     WordMeaning{.stem = "flick", .arm = true},
    // both arms
    WordMeaning{.stem = "clap", .arms = true},     WordMeaning{.stem = "juggl", .arms = true},
    WordMeaning{.stem = "box", .arms = true},      WordMeaning{.stem = "catch", .arms = true},
    WordMeaning{.stem = "push", .arms = true},     WordMeaning{.stem = "pull", .arms = true},
    WordMeaning{.stem = "lift", .arms = true},     WordMeaning{.stem = "carry", .arms = true},
    WordMeaning{.stem = "hug", .arms = true},      WordMeaning{.stem = "wash", .arms = true},
    WordMeaning{.stem = "sweep", .arms = true},    WordMeaning{.stem = "gestur", .arms = true},
    WordMeaning{.stem = "shrug", .arms = true},    WordMeaning{.stem = "typ", .arms = true},
    WordMeaning{.stem = "guitar", .arms = true},   WordMeaning{.stem = "piano", .arms = true},
    WordMeaning{.stem = "violin", .arms = true},   WordMeaning{.stem = "golf", .arms = true, .spine = true},
    WordMeaning{.stem = "headphone", .arms = true, .head = true},
    // legs
    WordMeaning{.stem = "walk", .legs = true},     WordMeaning{.stem = "run", .legs = true},
    WordMeaning{.stem = "jog", .legs = true},      WordMeaning{.stem = "sprint", .legs = true},
    WordMeaning{.stem = "step", .legs = true},     WordMeaning{.stem = "strid", .legs = true},
    WordMeaning{.stem = "stroll", .legs = true},   WordMeaning{.stem = "march", .legs = true},
    WordMeaning{.stem = "jump", .legs = true},     WordMeaning{.stem = "hop", .legs = true},
    WordMeaning{.stem = "leap", .legs = true},     WordMeaning{.stem = "skip", .legs = true},
    WordMeaning{.stem = "kick", .legs = true},     WordMeaning{.stem = "limp", .legs = true},
    WordMeaning{.stem = "sneak", .legs = true},    WordMeaning{.stem = "tiptoe", .legs = true},
    WordMeaning{.stem = "turn", .legs = true},     WordMeaning{.stem = "spin", .legs = true},
    WordMeaning{.stem = "stand", .legs = true},    WordMeaning{.stem = "lung", .legs = true},
    WordMeaning{.stem = "sit", .legs = true, .spine = true},
    WordMeaning{.stem = "squat", .legs = true, .spine = true},
    WordMeaning{.stem = "crouch", .legs = true, .spine = true},
    WordMeaning{.stem = "kneel", .legs = true, .spine = true},
    // head and torso
    WordMeaning{.stem = "nod", .head = true},      WordMeaning{.stem = "look", .head = true},
    WordMeaning{.stem = "gaz", .head = true},      WordMeaning{.stem = "peer", .head = true},
    WordMeaning{.stem = "chin", .head = true},     WordMeaning{.stem = "yawn", .head = true},
    WordMeaning{.stem = "bend", .spine = true},    WordMeaning{.stem = "bow", .head = true, .spine = true},
    WordMeaning{.stem = "lean", .spine = true},    WordMeaning{.stem = "twist", .spine = true},
    WordMeaning{.stem = "arch", .spine = true},
    // everything
    WordMeaning{"danc", false, true, true, true, true},      WordMeaning{"swim", false, true, true, true, true},
    WordMeaning{"crawl", false, true, true, true, true},     WordMeaning{"climb", false, true, true, true, true},
    WordMeaning{"cartwheel", false, true, true, true, true}, WordMeaning{"handstand", false, true, true, true, true},
    WordMeaning{"somersault", false, true, true, true, true}, WordMeaning{"exercis", false, true, true, true, true},
    WordMeaning{"fall", false, true, true, true, true},      WordMeaning{"roll", false, true, true, true, true},
};
// clang-format on

/// The entry with the longest stem of the word: the stem and at most four more letters ("step" + "ping"). Null if there
/// is none.
template <class Entries>
const auto* meaning_of(const Entries& entries, std::string_view word) {
  const typename Entries::value_type* best = nullptr;
  for (const auto& m : entries) {
    const bool fits = word.starts_with(m.stem) && word.size() - m.stem.size() <= 4;
    if (fits && (best == nullptr || m.stem.size() > best->stem.size())) best = &m;
  }
  return best;
}

/// Runs of letters in lower case. With `digits`, digits also count as letters ("arm 2").
inline std::vector<std::string> words_of(std::string_view text, bool digits = false) {
  std::vector<std::string> words;
  bool inside = false;
  for (char c : text) {
    const char small = lower(c);
    const bool letter = (small >= 'a' && small <= 'z') || (digits && small >= '0' && small <= '9');
    if (letter && !inside) words.emplace_back();
    if (letter) words.back() += small;
    inside = letter;
  }
  return words;
}

/// "left" and "right" are sides of an arm if the next word, or the one after "and right", is an arm: not in "turn
/// left".
struct Sides {
  bool left = false, right = false;

  explicit Sides(std::span<const std::string> words) {
    const auto names_arm = [&](std::size_t i) {
      static constexpr std::array<std::string_view, 10> nouns{"arm",    "arms", "hand",  "hands", "elbow",
                                                              "finger", "fist", "wrist", "thumb", "shoulder"};
      return i < words.size() && std::find(nouns.begin(), nouns.end(), words[i]) != nouns.end();
    };
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] == "both") left = right = true;
      if (words[i] != "left" && words[i] != "right") continue;
      const bool pair = i + 2 < words.size() && (words[i + 1] == "and" || words[i + 1] == "or");
      if (!names_arm(i + 1) && !(pair && names_arm(i + 3))) continue;
      (words[i] == "left" ? left : right) = true;
    }
  }
};

}  // namespace detail

MOTIONLANG_BODY BodyParts guess_body_parts(std::string_view text) {
  using enum BodyPart;
  const std::vector<std::string> words = detail::words_of(text);
  detail::WordMeaning sum;
  for (const std::string& word : words) {
    const detail::WordMeaning* m = detail::meaning_of(detail::lexicon, word);
    if (m == nullptr) continue;
    sum.arm |= m->arm, sum.arms |= m->arms, sum.legs |= m->legs, sum.head |= m->head, sum.spine |= m->spine;
  }
  const detail::Sides sides(words);
  BodyParts parts;
  if (sum.arm || sum.arms) {
    const bool told = sides.left || sides.right;
    if (told ? sides.left : sum.arms) parts = parts.with(left_arm);
    if (told ? sides.right : true) parts = parts.with(right_arm);
  }
  if (sum.legs) parts = parts.with(legs);
  if (sum.head) parts = parts.with(head);
  if (sum.spine) parts = parts.with(spine);
  return parts.empty() ? BodyParts::all() : parts;
}

MOTIONLANG_BODY BodyParts guess_body_parts(std::string_view text, const BodyPartition& body) {
  if (body.words().empty() && body == BodyPartition()) return guess_body_parts(text);
  const std::vector<std::string> words = detail::words_of(text, true);
  BodyParts parts;
  for (const std::string& word : words) {
    if (const auto* m = detail::meaning_of(body.words(), word)) parts.bits |= m->parts.bits;
  }
  const auto add_named = [&](std::string_view name, BodyPart part) {
    const std::vector<std::string> wanted = detail::words_of(name, true);
    const auto found = std::search(words.begin(), words.end(), wanted.begin(), wanted.end());
    if (!wanted.empty() && found != words.end()) parts = parts.with(part);
  };
  for (int p = 0; p < body.size(); ++p) {
    const auto part = static_cast<BodyPart>(p);
    add_named(body.name(part), part);
  }
  for (const BodyPartition::Named& s : body.synonyms()) add_named(s.name, s.part);
  return parts.empty() ? body.all() : parts;
}

MOTIONLANG_NAMESPACE_END
