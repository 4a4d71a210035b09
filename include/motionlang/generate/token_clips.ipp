// SPDX-License-Identifier: MIT
// Bodies of token_clips.hpp.
#pragma once

#include <algorithm>  // find_if, stable_sort

#include <motionlang/generate/token_clips.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/film_strip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::pair<Index, Index>> counted_codes(std::span<const std::vector<Index>> motions) {
  std::map<Index, Index> uses;
  for (const auto& codes : motions) {
    for (const Index code : codes) ++uses[code];
  }
  std::vector<std::pair<Index, Index>> out(uses.begin(), uses.end());
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

MOTIONLANG_BODY std::vector<std::pair<Index, Index>> codes_to_show(std::span<const Index> named,
                                                                   std::span<const std::vector<Index>> motions,
                                                                   Index most, Index known) {
  auto counts = counted_codes(motions);
  std::vector<std::pair<Index, Index>> out;
  for (const Index code : named) {
    const auto found = std::find_if(counts.begin(), counts.end(), [&](const auto& c) { return c.first == code; });
    out.emplace_back(code, found == counts.end() ? 0 : found->second);
  }
  if (!named.empty()) return out;
  if (counts.empty()) {
    for (Index code = 0; code < known; ++code) counts.emplace_back(code, 0);
  }
  if (std::ssize(counts) > most) counts.resize(static_cast<std::size_t>(most));
  return counts;
}

MOTIONLANG_BODY std::string token_page(std::span<const TokenClip> clips, const std::string& title) {
  const std::string name = detail::escape_markup(title);
  std::string out = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>" + name +
                    "</title>\n<style>body{font:15px sans-serif;margin:2em}main{display:grid;grid-template-columns:"
                    "repeat(auto-fill,minmax(18em,1fr));gap:1em}figure{margin:0}svg{width:100%;height:auto}</style>\n"
                    "<h1>" +
                    name + "</h1>\n<main>\n";
  for (const TokenClip& clip : clips) {
    const std::string caption =
        concat_text("code ", clip.code, clip.uses > 0 ? ", " + counted(clip.uses, "time") : std::string());
    out += "<figure>" + film_strip_svg(clip.motion, {}, {.poses = 4, .width = 480, .title = caption}) + "<figcaption>" +
           caption + "</figcaption></figure>\n";
  }
  return out + "</main>\n</html>\n";
}

MOTIONLANG_NAMESPACE_END
