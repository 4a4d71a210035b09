// SPDX-License-Identifier: MIT
// Bodies of text_sinc_parts.hpp.
#pragma once

#include <vector>  // names

#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/text_sinc_parts.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::optional<SincParts> parse_sinc_parts(std::string_view list) {
  SincParts parts;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const auto part = parse_sinc_part(detail::trim(list.substr(0, comma)));
    if (!part) return std::nullopt;
    parts.set(static_cast<std::size_t>(*part));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return parts;
}

MOTIONLANG_BODY SincParts as_sinc_parts(const BodyParts& parts) {
  using enum SincPart;
  SincParts out;
  if (parts.has(BodyPart::left_arm)) out |= sinc_parts(left_arm);
  if (parts.has(BodyPart::right_arm)) out |= sinc_parts(right_arm);
  if (parts.has(BodyPart::legs)) out |= sinc_parts(global, left_leg, right_leg);
  if (parts.has(BodyPart::spine) || parts.has(BodyPart::head)) out |= sinc_parts(torso);
  return out;
}

MOTIONLANG_BODY SincParts text_sinc_parts(const std::string& text, const BodyPartTable* table) {
  if (text.empty()) return ~SincParts{};
  if (const auto listed = parse_sinc_parts(text)) return *listed;
  return table != nullptr ? table->parts(text) : as_sinc_parts(guess_body_parts(text));
}

MOTIONLANG_BODY std::string list_sinc_parts(const SincParts& parts) {
  std::vector<std::string_view> names;
  for (std::size_t p = 0; p < sinc_part_count; ++p) {
    if (parts[p]) names.push_back(sinc_part_names[p]);
  }
  return join_text(names);
}

MOTIONLANG_NAMESPACE_END
