// SPDX-License-Identifier: MIT
// Bodies of stmc_training.hpp.
#pragma once

#include <motionlang/core/parallel.hpp>
#include <motionlang/train/stmc_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<TrainingSample> draw_batch(const TrainingSet& data, const StmcTrainingConfig& config,
                                                       Philox rng, Index count) {
  std::vector<TrainingSample> batch(static_cast<std::size_t>(count));
  parallel_for(count, [&](Index i) {
    batch[static_cast<std::size_t>(i)] = data.draw(rng.split(static_cast<std::uint64_t>(i)), config.samples);
  });
  return batch;
}

MOTIONLANG_BODY void append_summary(std::vector<float>& out, std::span<const float> rows) {
  const Index frames = std::ssize(rows) / smplrifke_size;
  FeatureStatistics all;
  for (Index k = 0; k < summary_parts; ++k) {
    const Index first = frames * k / summary_parts, last = std::max(first + 1, frames * (k + 1) / summary_parts);
    const auto quarter = rows.subspan(static_cast<std::size_t>(first * smplrifke_size),
                                      static_cast<std::size_t>((last - first) * smplrifke_size));
    FeatureStatistics part;
    part.add(quarter, smplrifke_size);
    for (double mean : part.mean()) out.push_back(static_cast<float>(mean));
  }
  all.add(rows, smplrifke_size);
  const auto n = static_cast<double>(all.count());
  for (double unbiased : all.standard_deviation()) out.push_back(static_cast<float>(unbiased * std::sqrt((n - 1) / n)));
}

MOTIONLANG_BODY Index draw_t(Philox& rng, Index steps, double focus) {
  if (rng.uniform() >= focus) return static_cast<Index>(rng.below(static_cast<std::uint32_t>(steps)));
  const double from_the_end = 0.2 * static_cast<double>(steps) * std::pow(rng.uniform(), 1.5);
  return std::max<Index>(0, steps - 1 - static_cast<Index>(from_the_end));
}

MOTIONLANG_BODY double snr_weight(double abar, double cap) {
  if (!(cap >= 1)) raise<config_error>(101, "snr_weight: a cap of ", cap, ", at least 1 is needed");
  return abar >= 1 ? cap : std::clamp(abar / (1 - abar), 1.0, cap);
}

MOTIONLANG_BODY std::vector<std::string> said_texts(const TrainingSet& data) {
  std::vector<std::string> out(2, std::string(added_caption_words));
  for (const CaptionedSegment& s : data.segments()) out.insert(out.end(), s.captions.begin(), s.captions.end());
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
