// SPDX-License-Identifier: MIT
/// The card of a data set: clips, minutes, captions and verbs of a table of captions.
///
///     for (const auto& [verb, segments] : caption_card(read_captions("captions.tsv", "clips")).verbs) ...
#pragma once

#include <cstddef>      // counts
#include <map>          // folders, verbs
#include <set>          // clips
#include <string>       // names
#include <string_view>  // captions
#include <vector>       // lines

#include <motionlang/datasets/clip_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct CaptionCard {
  struct Folder {
    std::set<std::string> clips{};
    std::size_t segments = 0, captions = 0;
    double seconds = 0;          // of all segments
    double without_overlap = 0;  // seconds of clips that a segment is about
  };
  std::map<std::string, Folder>
      folders{};  // by the path of their clips up to the last /, or to the . of a file of many
  Folder all{};
  std::set<std::string> captions{}, words{};   // different ones
  std::map<std::string, std::size_t> verbs{};  // with which commands begin, and the segments that have such a command
};

/// "walk" of "walk along"; "" of what commands nothing: "a person walks", "walking", "someone walks".
std::string commanded_verb(std::string_view caption);

namespace detail {

/// Words in lower case, without commas.
std::vector<std::string> caption_words(std::string_view text);

}  // namespace detail

/// Lines about whole clips count as segments of no length, since clips are not read.
CaptionCard caption_card(const std::vector<ClipLine>& lines);

/// The card as lines: each folder and all of them, then the verbs, the most frequent first.
std::string describe_card(const CaptionCard& card);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/caption_card.ipp>
#endif
