// SPDX-License-Identifier: MIT
// Bodies of handovers.hpp.
#pragma once

#include <motionlang/compose/handovers.hpp>
#include <motionlang/compose/intervals.hpp>
#include <motionlang/compose/sinc_assignment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Timeline cut_at_handovers(const Timeline& timeline, Index least) {
  const auto pieces = elementary_pieces(timeline);
  const auto parts = static_cast<std::size_t>(timeline.body.size());
  std::vector<PartOwners> owners;
  owners.reserve(pieces.size());
  FirstWins ties;
  for (const Piece& piece : pieces) {
    owners.push_back(piece.intervals.empty() ? PartOwners(parts) : assign_parts(timeline, piece.intervals, ties));
  }
  least = std::max<Index>(least, 1);
  Timeline out{{}, timeline.body};
  for (Index i = 0; i < std::ssize(timeline.intervals); ++i) {
    Interval rest = timeline.intervals[static_cast<std::size_t>(i)];
    for (std::size_t k = 1; k < pieces.size(); ++k) {
      const Index cut = pieces[k].start;
      const bool changes = [&] {
        for (std::size_t p = 0; p < parts; ++p) {
          if ((owners[k][p] == i) != (owners[k - 1][p] == i)) return true;
        }
        return false;
      }();
      if (!changes || cut - rest.start < least || rest.end - cut < least) continue;
      out.intervals.push_back(rest);
      out.intervals.back().end = cut;
      rest.start = cut;
    }
    out.intervals.push_back(rest);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
