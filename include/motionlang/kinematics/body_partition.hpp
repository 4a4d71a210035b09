// SPDX-License-Identifier: MIT
/// The parts of a body: their names, and the part that carries the path over the floor. Timelines, plans and feature
/// layouts hold such a partition; the default is the human body of STMC (body_parts.hpp).
///
///     const BodyPartition dog({.names = {"front left", "front right", "hind left", "hind right", "trunk"},
///                              .path = "trunk",
///                              .synonyms = {{"tail", "trunk"}},
///                              .words = {{"wag", {"trunk"}}, {"dig", {"front left", "front right"}}}});
///     const auto timeline = parse_timeline("trot # 0 # 4\nshake hands # 1 # 2 # front left\n", {.body = dog});
///
/// Differs  from STMC (Petrovich et al. 2024), which knows the human body only. Its base texts are those with legs.
///          Here they are those with the part that carries the path
#pragma once

#include <initializer_list>  // sets of parts
#include <memory>            // names that copies share
#include <optional>          // unknown names
#include <span>              // sets of parts
#include <string>            // names
#include <string_view>       // lookups
#include <vector>            // names

#include <motionlang/kinematics/body_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Another name of a part.
struct PartSynonym {
  std::string name, part;
};

/// A word that tells which parts a text moves: lower-case letters, the beginning of a word ("walk" for "walking").
struct PartWord {
  std::string stem;
  std::vector<std::string> parts;
};

/// The parts from which a BodyPartition is made.
struct BodyPartNames {
  std::vector<std::string> names;       // in the order of their numbers
  std::string path;                     // the part that carries the others over the floor
  std::vector<PartSynonym> synonyms{};  // for reading
  std::vector<PartWord> words{};        // for guesses, see guess_body_parts
};

/// A value that copies share. It never changes.
class BodyPartition {
 public:
  /// The human body: the five parts of STMC, whose legs carry the path.
  BodyPartition() = default;
  /// Throws config_error 101 without a part, for more than `most_body_parts`, for a name that a timeline file cannot
  /// hold (it is empty, has '#', a line end or outer blanks, or is not UTF-8), and for a word with characters other
  /// than a ... z. Throws 102 for a duplicate name, and 103 for a part that is not one of the names.
  explicit BodyPartition(const BodyPartNames& names);

  int size() const { return static_cast<int>(names().size()); }
  const std::vector<std::string>& names() const { return state().names; }
  /// Throws config_error 101 for a number that the body lacks.
  const std::string& name(BodyPart part) const;
  /// The part that carries the path: its texts are preferred as base texts, and features of the root belong to it.
  BodyPart path() const { return state().path; }
  /// The set of all parts.
  BodyParts all() const { return {~0u >> (most_body_parts - size())}; }
  /// The part of this name or synonym, case-sensitive. Nothing for an unknown name.
  std::optional<BodyPart> find(std::string_view name) const;
  /// The set of these parts, by name or synonym. Throws config_error 103 for an unknown name.
  BodyParts parts(std::span<const std::string> names) const;
  BodyParts parts(std::initializer_list<std::string> names) const {
    return parts(std::span(names.begin(), names.size()));
  }

  struct Named {
    std::string name;
    BodyPart part;
  };
  struct Word {
    std::string stem;
    BodyParts parts;
  };
  const std::vector<Named>& synonyms() const { return state().synonyms; }
  /// Empty for the human body, whose lexicon is in compose/body_part_lexicon.hpp.
  const std::vector<Word>& words() const { return state().words; }

  /// True for the same names in the same order and the same part for the path. Synonyms and words do not count.
  bool operator==(const BodyPartition& other) const;

 private:
  struct State {
    std::vector<std::string> names;
    BodyPart path{};
    std::vector<Named> synonyms;
    std::vector<Word> words;
  };
  static const State& human();
  const State& state() const { return state_ ? *state_ : human(); }

  std::shared_ptr<const State> state_;  // none: the human body
};

/// "front left, front right, hind left, hind right, trunk (with the path)"
std::string to_string(const BodyPartition& body);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/body_partition.ipp>
#endif
