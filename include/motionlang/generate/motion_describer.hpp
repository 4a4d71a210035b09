// SPDX-License-Identifier: MIT
/// Describes motions in words with a TM2T model from motions to texts. A long motion is described in parts.
///
///     const MotionDescriber<B> describer(load_tm2t_describer<B>(find_run("M2T_EL4_DL4_NH8_PS")));
///     for (const DescribedPart& part : describer(read_motion("walk.bvh"), Philox{}))
///       use(part.start, part.end, part.texts.front().text);
///
/// Source  TM2T (Guo et al., ECCV 2022), section 3.3
#pragma once

#include <algorithm>  // stable_sort
#include <span>       // rows
#include <string>     // names
#include <utility>    // move
#include <vector>     // descriptions

#include <motionlang/datasets/tm2t_data.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/weights/tm2t_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Options for the choice of words.
struct DescribeOptions {
  Index top = 1;        // descriptions of each part, if there are as many different ones
  Index beams = 2;      // of the search, at least `top`; 1: the most probable word at each step
  bool sample = false;  // samples words by their probability instead
  Index top_k = 100;    // samples only from this many of the most probable words
};

/// A part of a motion and its descriptions, the most probable first.
struct DescribedPart {
  double start = 0, end = 0;  // seconds
  std::vector<Description> texts{};
};

template <Backend B>
class MotionDescriber {
 public:
  /// Throws config_error 102 for a tokenizer of features other than those of HumanML3D or KIT-ML.
  explicit MotionDescriber(Tm2tRun<B> run)
      : run_(std::move(run)), features_(&motion_features(run_.width() == 251 ? "kit" : "guoh3d")) {
    if (features_->width != run_.width())
      raise<config_error>(102, "MotionDescriber: a tokenizer of ", counted(run_.width(), "number"),
                          " a frame, expected 263 or 251");
  }

  /// The features that the model reads.
  const MotionFeatures& features() const { return *features_; }

  /// rows     (frames, width), not normalised, at the rate of the features
  /// name     for messages
  /// Returns  as few equal parts as possible, none longer than the training motions of such models
  /// Throws   numeric_error 301 for features that are not finite, shape_error 205 for fewer than four frames
  std::vector<DescribedPart> describe_rows(std::span<const float> rows, const Philox& rng,
                                           const DescribeOptions& options = {},
                                           const std::string& name = "describe_rows") const {
    if (!detail::all_finite(rows)) raise<numeric_error>(301, name, ": features that are not finite");
    const Index frames = std::ssize(rows) / features_->width;
    const Index parts = (frames + tm2t_longest - 1) / tm2t_longest;
    std::vector<Index> lengths;
    for (Index p = 0; p < parts; ++p) lengths.push_back(frames * (p + 1) / parts - frames * p / parts);
    const std::vector<typename B::scalar> values(rows.begin(), rows.end());
    const Sequences<B> x{Tensor<B, 2>::from(values, {frames, features_->width}), Offsets(lengths)};
    auto texts = said(x, rng, options);
    std::vector<DescribedPart> out;
    for (Index p = 0; p < parts; ++p)
      out.push_back({static_cast<double>(x.offsets.begin(p)) / features_->fps,
                     static_cast<double>(x.offsets.end(p)) / features_->fps,
                     std::move(texts[static_cast<std::size_t>(p)])});
    return out;
  }
  /// A motion on any joints. Throws as above, and what rows_of_motion throws.
  std::vector<DescribedPart> operator()(const Motion& motion, const Philox& rng,
                                        const DescribeOptions& options = {}) const {
    const auto values = rows_of_motion(*features_, motion, features_->fps);
    auto out = describe_rows(std::vector<float>(values.begin(), values.end()), rng, options, motion.name);
    if (!out.empty()) out.back().end = motion.seconds();
    return out;
  }

 private:
  std::vector<std::vector<Description>> said(const Sequences<B>& x, const Philox& rng, const DescribeOptions& o) const {
    if (o.sample) {
      auto drawn = run_.model.descriptions_at_random(x, run_.words, rng, o.top, {.top_k = o.top_k});
      for (auto& own : drawn)
        std::stable_sort(own.begin(), own.end(), [](const Description& a, const Description& b) {
          return a.log_probability > b.log_probability;
        });
      return drawn;
    }
    auto found = run_.model.descriptions(x, run_.words, {.beams = std::max(o.beams, o.top)});
    for (auto& own : found) own.resize(std::min(own.size(), static_cast<std::size_t>(o.top)));
    return found;
  }

  Tm2tRun<B> run_;
  const MotionFeatures* features_;
};

MOTIONLANG_NAMESPACE_END
