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

MOTIONLANG_BODY StmcModelConfig completed(const StmcTrainingConfig& c) {
  auto model = c.model;
  model.denoiser.tx_dim = model.text.out;
  return model;
}

MOTIONLANG_BODY std::vector<std::string> said_texts(const TrainingSet& data) {
  std::vector<std::string> out(2, std::string(added_caption_words));
  for (const CaptionedSegment& s : data.segments()) out.insert(out.end(), s.captions.begin(), s.captions.end());
  return out;
}

MOTIONLANG_BODY std::map<std::string, std::string> stmc_settings(const StmcTrainingConfig& config,
                                                                 const std::string& fingerprint) {
  std::map<std::string, std::string> out;
  auto add = [&](const std::string& name, auto value) { out["training." + name] = concat_text(value); };
  add("data", fingerprint);
  add("batch", config.batch);
  add("lr", config.lr);
  add("warmup", config.warmup);
  add("weight_decay", config.weight_decay);
  add("clip_norm", config.clip_norm);
  add("ema", config.ema);
  add("velocity_weight", config.velocity_weight);
  add("noise_focus", config.noise_focus);
  add("snr_cap", config.snr_cap);
  add("root_weight", config.root_weight);
  add("foot_weight", config.foot_weight);
  add("text_weight", config.text_weight);
  add("verb_weight", config.verb_weight);
  add("text_steps", config.text_steps);
  add("dropout", config.model.denoiser.dropout);
  add("text_dropout", config.model.text.dropout);
  add("seed", config.seed);
  if (!config.practised.empty()) {
    add("practised", concat_text(join_text(config.practised), " (", config.practice, " times as often)"));
  }
  add("samples",
      concat_text(config.samples.shortest, " to ", counted(config.samples.longest, "frame"), ", no text ",
                  config.samples.no_text, ", composed ", config.samples.compose, ", still ", config.samples.still,
                  ", passing ", config.samples.passing, ", mirrored ", config.samples.mirror, ", speed ",
                  config.samples.speed, ", stretched ", config.samples.stretch, ", tempo ", config.samples.tempo,
                  ", reversed ", config.samples.reverse, ", curved ", config.samples.curve, ", then ",
                  config.samples.then));
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
