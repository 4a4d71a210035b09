// SPDX-License-Identifier: MIT
/// The similarity of generated and recorded motions to a motion encoder: collects motions for the TEMOS score.
///
///     MotionLikeness<B> likeness("sinc-of-single-actions", {}, motion_features("smplvelp"));
///     for (const auto& [generated, recorded_rows] : items) likeness.add(generated, recorded_rows);
///     use(likeness.score());                               // 0 to 1
///
/// Source  thesis B.3.1; SINC (Athanasiou et al., ICCV 2023) sample_eval_latent.py
#pragma once

#include <algorithm>   // rotate
#include <filesystem>  // a model
#include <functional>  // its encoder
#include <utility>     // move
#include <vector>      // latents

#include <motionlang/metrics/temos_score.hpp>
#include <motionlang/weights/babel_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
class MotionLikeness {
  using S = typename B::scalar;

 public:
  /// folder   a model of `features` (with_babel_checkpoint), preferably one of single actions
  /// Throws   what with_babel_checkpoint throws
  MotionLikeness(const std::filesystem::path& folder, const CheckpointOptions& options, const MotionFeatures& features)
      : exact_yaw_(features.name == "smplvelp") {
    with_babel_checkpoint<B>(folder, options, features, [&](auto model) {
      mean_of_ = [model = std::move(model)](const std::vector<S>& rows) {
        const Index width = model.features->width, frames = std::ssize(rows) / width;
        const auto x = model.normalizer.normalize(Tensor<B, 2>::from(rows, {frames, width}));
        return model.model.encode_motion(Sequences<B>(x, Offsets{frames})).mu.to_vector();
      };
    });
  }

  /// A generated and a recorded motion in the latent space, which another object of the same model can add.
  struct Latents {
    std::vector<S> made, recorded;
  };
  /// made      is turned to face ahead again, as published
  /// recorded  rows of features, not normalised
  Latents latents(const SmplVelpMotion<S>& made, const std::vector<float>& recorded) const {
    return {latent(made), mean_of_(std::vector<S>(recorded.begin(), recorded.end()))};
  }
  void add(Latents pair) { made_.push_back(std::move(pair.made)), recorded_.push_back(std::move(pair.recorded)); }
  void add(const SmplVelpMotion<S>& made, const std::vector<float>& recorded) { add(latents(made, recorded)); }
  /// The latent of a motion alone.
  std::vector<S> latent(const SmplVelpMotion<S>& made) const {
    return mean_of_(smplvelp_features(std::span<const Matrix3<S>>(made.rotations), std::span<const Vec3<S>>(made.trans),
                                      {.exact_yaw = exact_yaw_}));
  }
  /// composed  the latent of another motion for what was added last, such as one of its labels alone. Throws
  ///           numeric_error 302 before anything was added
  void add_composed(std::vector<S> composed) {
    if (recorded_.empty()) raise<numeric_error>(302, "add_composed: there is no recorded motion to compare with");
    composed_.push_back(std::move(composed));
    recorded_of_composed_.push_back(recorded_.back());
  }

  /// The TEMOS score of the generated motions. Throws numeric_error 302 before anything was added.
  double score() const { return score_of(made_, recorded_); }
  bool has_composed() const { return !composed_.empty(); }
  /// The score of the composed motions. Throws numeric_error 302 if there are none.
  double score_of_composed() const { return score_of(composed_, recorded_of_composed_); }
  /// The score of each recorded motion against the next one.
  double score_of_others() const {
    auto others = recorded_;
    if (!others.empty()) std::rotate(others.begin(), others.begin() + 1, others.end());
    return score_of(others, recorded_);
  }

 private:
  static double score_of(const std::vector<std::vector<S>>& of, const std::vector<std::vector<S>>& recorded) {
    const auto rows = [](const std::vector<std::vector<S>>& means) {
      std::vector<S> all;
      for (const auto& m : means) all.insert(all.end(), m.begin(), m.end());
      return all;
    };
    const Index width = recorded.empty() ? 1 : std::ssize(recorded.front());
    const auto a = rows(of), b = rows(recorded);
    return temos_score(Rows<S>(a, width), Rows<S>(b, width));
  }

  bool exact_yaw_;
  std::function<std::vector<S>(const std::vector<S>&)> mean_of_;
  std::vector<std::vector<S>> made_, recorded_, composed_, recorded_of_composed_;
};

MOTIONLANG_NAMESPACE_END
