// SPDX-License-Identifier: MIT
/// Search results as lines, as JSON, and as one self-contained HTML page: for each clip or moment its score, its place,
/// its captions, and on the page a film strip.
#pragma once

#include <span>         // hits
#include <string>       // texts
#include <string_view>  // query
#include <vector>       // hits

#include <motionlang/formats/motion_file.hpp>
#include <motionlang/search/text_answer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A hit of the page.
struct FoundMotion {
  IndexedClip clip;
  double start = 0, end = 0;  // seconds in the file
  double score = 0;           // 0 to 1
  std::string strip{};        // film_strip_svg, or "" for none
  std::string problem{};      // the reason if there is no strip
};

/// The hits of an answer with their clips.
std::vector<FoundMotion> found_motions(const IndexTables& index, const TextAnswer& answer);
inline std::vector<FoundMotion> found_motions(const MotionIndex& index, const TextAnswer& answer) {
  return found_motions(TablesOfIndex(index), answer);
}

/// Lines: the words that the model does not know, if nothing shows the query (`one`: "clip" or "moment"), and the hits.
std::string search_text(std::span<const FoundMotion> found, const TextAnswer& answer, std::string_view one);
/// kind  what was searched: "clips", "moments", "captions"
std::string search_json(std::span<const FoundMotion> found, const TextAnswer& answer, std::string_view query,
                        std::string_view kind);

/// Draws the strips: reads the files of the hits, or records why a strip could not be drawn.
void draw_found(std::span<FoundMotion> found, const MotionReadOptions& read = {});

/// query    the query, in words
/// summary  how many items were searched, and their kind
std::string search_html(std::span<const FoundMotion> found, std::string_view query, std::string_view summary);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/search_page.ipp>
#endif
