// SPDX-License-Identifier: MIT
// Bodies of body_partition.hpp.
#pragma once

#include <algorithm>  // find, any_of

#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/kinematics/body_partition.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws config_error 101 unless a line of a timeline can hold the name.
inline void check_part_name(std::string_view name) {
  if (name.empty() || name != trim(name) || name.find_first_of("#\r\n") != name.npos || !is_utf8(name))
    raise<config_error>(101, "BodyPartition: '", name, "' cannot be the name of a body part in a timeline");
}

}  // namespace detail

MOTIONLANG_BODY BodyPartition::BodyPartition(const BodyPartNames& names) {
  if (names.names.empty() || names.names.size() > most_body_parts)
    raise<config_error>(101, "BodyPartition: ", counted(names.names.size(), "part"), ", expected 1 to ",
                        most_body_parts);
  const auto made = std::make_shared<State>();
  state_ = made;  // find and parts read the present state
  const auto check_new = [&](const std::string& name) {
    detail::check_part_name(name);
    if (find(name)) raise<config_error>(102, "BodyPartition: '", name, "' is the name of two body parts");
  };
  for (const std::string& name : names.names) {
    check_new(name);
    made->names.push_back(name);
  }
  const auto known = [&](std::string_view name) {
    const auto part = find(name);
    if (!part) raise<config_error>(103, "BodyPartition: '", name, "' is not one of ", join_text(made->names));
    return *part;
  };
  made->path = known(names.path);
  for (const PartSynonym& s : names.synonyms) {
    check_new(s.name);
    made->synonyms.push_back({s.name, known(s.part)});
  }
  for (const PartWord& w : names.words) {
    if (w.stem.empty() || std::any_of(w.stem.begin(), w.stem.end(), [](char c) { return c < 'a' || c > 'z'; }))
      raise<config_error>(101, "BodyPartition: the word '", w.stem, "' has other characters than a to z");
    made->words.push_back({w.stem, parts(w.parts)});
  }
}

MOTIONLANG_BODY const std::string& BodyPartition::name(BodyPart part) const {
  const auto p = static_cast<std::size_t>(part);
  if (p >= names().size())
    raise<config_error>(101, "BodyPartition: part ", static_cast<int>(part), " of a body of ",
                        counted(names().size(), "part"));
  return names()[p];
}

MOTIONLANG_BODY std::optional<BodyPart> BodyPartition::find(std::string_view name) const {
  const auto found = std::find(names().begin(), names().end(), name);
  if (found != names().end()) return static_cast<BodyPart>(found - names().begin());
  for (const Named& s : synonyms()) {
    if (s.name == name) return s.part;
  }
  return std::nullopt;
}

MOTIONLANG_BODY BodyParts BodyPartition::parts(std::span<const std::string> names) const {
  BodyParts out;
  for (const std::string& name : names) {
    const auto part = find(name);
    if (!part) raise<config_error>(103, "BodyPartition: '", name, "' is not one of ", join_text(this->names()));
    out = out.with(*part);
  }
  return out;
}

MOTIONLANG_BODY bool BodyPartition::operator==(const BodyPartition& other) const {
  return state_ == other.state_ || (path() == other.path() && names() == other.names());
}

MOTIONLANG_BODY const BodyPartition::State& BodyPartition::human() {
  static const State human = [] {
    State s{std::vector<std::string>(body_part_names.begin(), body_part_names.end()), BodyPart::legs, {}, {}};
    for (const auto& [name, part] : body_part_synonyms) s.synonyms.push_back({std::string(name), part});
    return s;
  }();
  return human;
}

MOTIONLANG_BODY std::string to_string(const BodyPartition& body) {
  return join_text(body.names(), ", ", [&](const std::string& name) {
    return name == body.name(body.path()) ? name + " (with the path)" : name;
  });
}

MOTIONLANG_NAMESPACE_END
