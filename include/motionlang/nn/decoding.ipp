// SPDX-License-Identifier: MIT
// Bodies of decoding.hpp.
#pragma once

#include <algorithm>  // all_of, find, stable_sort
#include <cmath>      // log, pow
#include <numeric>    // accumulate

#include <motionlang/nn/decoding.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY Index draw(std::span<const double> p, double u) {
  const double all = std::accumulate(p.begin(), p.end(), 0.0);
  if (!(all > 0))
    raise<numeric_error>(302, "decoding: no symbol that may follow has a probability; take a larger top_k");
  double sum = 0;
  Index last = 0;
  for (Index i = 0; i < std::ssize(p); ++i) {
    const double share = p[static_cast<std::size_t>(i)] / all;
    if (share == 0) continue;
    sum += share, last = i;
    if (sum > u) break;
  }
  return last;
}

}  // namespace detail

MOTIONLANG_BODY IdSequences Decoded::written() const {
  std::vector<std::vector<Index>> out;
  for (std::size_t i = 0; i < ids.size(); ++i) out.emplace_back(ids[i].begin() + 1, ids[i].begin() + 1 + lengths[i]);
  return IdSequences::from(out);
}

namespace detail {

MOTIONLANG_BODY void require_beams(const BeamOptions& o) {
  if (o.beams < 1 || o.max_length < 2) raise<config_error>(101, "beam_search: ", o.beams, " beams of ", o.max_length);
}

inline bool has_ended(const std::vector<Index>& beam, const BeamOptions& o) {
  return std::find(beam.begin(), beam.end(), o.end) != beam.end();
}

MOTIONLANG_BODY void continue_beams(BeamSearch& found, const std::vector<std::vector<double>>& p,
                                    const BeamOptions& o) {
  struct Candidate {
    std::size_t beam;
    Index id;
    double score;
  };
  auto best_first = [](const Candidate& a, const Candidate& b) { return a.score > b.score; };
  if (o.beams > std::ssize(p[0]))
    raise<config_error>(101, "beam_search: ", o.beams, " beams, ", p[0].size(), " symbols");
  std::vector<Candidate> candidates;
  for (std::size_t b = 0; b < p.size(); ++b) {
    std::vector<Candidate> own;
    for (std::size_t i = 0; i < p[b].size(); ++i)
      own.push_back({b, static_cast<Index>(i), found.scores[b] + std::log(p[b][i])});
    std::stable_sort(own.begin(), own.end(), best_first);
    candidates.insert(candidates.end(), own.begin(), own.begin() + o.beams);
  }
  std::stable_sort(candidates.begin(), candidates.end(), best_first);
  std::vector<std::vector<Index>> beams;
  found.scores.clear();
  for (Index b = 0; b < o.beams; ++b) {
    const Candidate& c = candidates[static_cast<std::size_t>(b)];
    beams.push_back(found.beams[c.beam]);
    beams.back().push_back(c.id);
    found.scores.push_back(c.score);
  }
  found.beams = std::move(beams);
}

MOTIONLANG_BODY bool all_ended(const BeamSearch& found, const BeamOptions& o) {
  return std::all_of(found.beams.begin(), found.beams.end(),
                     [&](const std::vector<Index>& beam) { return has_ended(beam, o); });
}

MOTIONLANG_BODY void order_beams(BeamSearch& found, const BeamOptions& o) {
  auto value = [&](std::size_t b) {
    return found.scores[b] / std::pow(static_cast<double>(found.lengths[b]), o.alpha);
  };
  for (std::size_t b = 0; b < found.beams.size(); ++b) {
    auto& beam = found.beams[b];
    const Index first_end = std::find(beam.begin(), beam.end(), o.end) - beam.begin() + 1;
    found.lengths.push_back(has_ended(beam, o) ? first_end : o.max_length);
    beam.resize(static_cast<std::size_t>(o.max_length), o.pad);
    found.order.push_back(b);
  }
  std::stable_sort(found.order.begin(), found.order.end(),
                   [&](std::size_t a, std::size_t b) { return value(a) > value(b); });
  const std::size_t best = found.order.front();
  found.ids.assign(found.beams[best].begin(), found.beams[best].begin() + found.lengths[best]);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
