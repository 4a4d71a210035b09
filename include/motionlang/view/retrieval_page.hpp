// SPDX-License-Identifier: MIT
/// Ranked galleries: for each text the nearest motions as film strips, with their similarity and with that of their own
/// texts to the query. One self-contained HTML page.
///
/// Source  TMR (Petrovich, Black, Varol, ICCV 2023), figures 3 and 4; thesis figures 5.3 to 5.7
#pragma once

#include <functional>   // strips
#include <span>         // queries
#include <string>       // texts
#include <string_view>  // title
#include <vector>       // motions

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A motion that a text finds.
struct RankedMotion {
  Index number = 0;  // in the part that is searched
  std::string id;
  std::string text;            // its own
  double similarity = 0;       // of the motion to the query, 0 to 1
  double text_similarity = 0;  // of its text to the query, 0 to 1
  bool own = false;            // the query is a text of this motion
};
/// A text and the motions that are nearest to it, the nearest first.
struct RankedQuery {
  std::string text;
  double rank = 0;  // of its own motion; 1 is the best. Motions at the same distance share their mean
  std::vector<RankedMotion> motions{};
};

/// title   what was searched
/// strip   the picture of a motion as SVG
std::string retrieval_page(std::span<const RankedQuery> queries, std::string_view title,
                           const std::function<std::string(const RankedMotion&)>& strip);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/retrieval_page.ipp>
#endif
