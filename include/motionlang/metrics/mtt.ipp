// SPDX-License-Identifier: MIT
// Bodies of mtt.hpp.
#pragma once

#include <set>  // points

#include <motionlang/metrics/mtt.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> transition_points(const Timeline& timeline, Index feature_frames,
                                                     MttFlavour flavour) {
  std::set<Index> points;
  for (const Interval& i : timeline.intervals) {
    for (const Index p : {i.start, i.end}) {
      if (flavour == MttFlavour::as_written || p < feature_frames) points.insert(p);
    }
  }
  if (points.size() <= 2) return {};
  return {std::next(points.begin()), std::prev(points.end())};
}

MOTIONLANG_BODY std::vector<Index> fixed_crop_starts(const RealismCrops& crops) {
  NumpyRandom rng(crops.seed);
  std::vector<Index> out;
  for (Index i = 0; i < crops.samples; ++i) {
    out.push_back(static_cast<Index>(rng.randint(0, crops.features - crops.frames)));
  }
  return out;
}

MOTIONLANG_BODY std::vector<Index> random_crop_starts(Index feature_frames, NumpyRandom& rng,
                                                      const RealismCrops& crops) {
  std::vector<Index> out;
  for (Index i = 0; i < crops.samples; ++i) {
    out.push_back(static_cast<Index>(rng.randint(0, std::max<Index>(1, feature_frames - crops.frames + 1))));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
