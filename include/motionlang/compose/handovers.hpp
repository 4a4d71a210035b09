// SPDX-License-Identifier: MIT
/// Texts cut where what they own changes.
///
/// A text that goes on while another borrows its arms is one crop as published, so the denoiser sees raised arms in the
/// middle of "walk forward" and keeps them up before and after. Cut at these times, it walks with its own arms, then
/// without them, then with its own again; the transitions are where they were.
///
///     const auto motion = stmc.generate(cut_at_handovers(timeline, 10), rng);
///
/// Differs  from STMC (Petrovich et al. 2024), section 3.3, where each text is one crop
#pragma once

#include <motionlang/compose/intervals.hpp>
#include <motionlang/compose/sinc_assignment.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Cuts every text at the times at which it gets or loses body parts, unless a stretch would be shorter than `least`
/// frames. Throws config_error 101 if too many texts lie over each other.
inline Timeline cut_at_handovers(const Timeline& timeline, Index least) {
  const auto pieces = elementary_pieces(timeline);
  std::vector<PartOwners> owners;
  FirstWins ties;
  for (const Piece& piece : pieces) {
    owners.push_back(piece.intervals.empty() ? PartOwners{} : assign_parts(timeline, piece.intervals, ties));
  }
  least = std::max<Index>(least, 1);
  Timeline out;
  for (Index i = 0; i < std::ssize(timeline.intervals); ++i) {
    Interval rest = timeline.intervals[static_cast<std::size_t>(i)];
    for (std::size_t k = 1; k < pieces.size(); ++k) {
      const Index cut = pieces[k].start;
      const bool changes = [&] {
        for (std::size_t p = 0; p < body_part_count; ++p) {
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
