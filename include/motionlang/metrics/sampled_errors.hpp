// SPDX-License-Identifier: MIT
/// Errors of joint positions (metrics/ape_ave.hpp) over several motions for each text, and of motions that ignore the
/// text. These are the measurements of TEMOS, SINC and TEACH.
///
///     SampledErrors sampled(JointErrors(variant, 1.0), 10);
///     for (const auto& [ten_motions_of_a_text, recorded] : items) sampled.add(ten_motions_of_a_text, recorded);
///     sampled.mean().ape.root;
#pragma once

#include <cstdint>     // seed
#include <functional>  // motions
#include <span>        // rows
#include <string>      // names of rows
#include <vector>      // positions

#include <motionlang/core/rng.hpp>
#include <motionlang/metrics/ape_ave.hpp>

MOTIONLANG_NAMESPACE_BEGIN

using JointFrames = std::vector<Vec3<double>>;  // (frames, joints)
using JointErrors = ApeAveMetric<double>;

/// Errors of several motions for each text.
class SampledErrors {
 public:
  SampledErrors(const JointErrors& none, Index samples)
      : of_sample_(static_cast<std::size_t>(samples), none), best_of_(of_sample_), worst_(none) {}

  /// samples  one motion for each of the samples
  void add(const std::vector<JointFrames>& samples, const JointFrames& truth) { add(clips(samples, truth)); }
  /// The errors of the motions of a text: of each, of the best of the first 1, 2, 3, ..., and of the worst. Another
  /// object can add them.
  std::vector<JointErrors::Clip> clips(const std::vector<JointFrames>& samples, const JointFrames& truth) const;
  void add(std::span<const JointErrors::Clip> of_text);

  Index samples() const { return std::ssize(of_sample_); }
  /// The errors of the first motion of each text.
  ApeAve first() const { return of_sample_.front().result(); }
  /// The mean over the samples.
  ApeAve mean() const;
  /// The errors of the best and of the worst motion of each text.
  ApeAve best() const { return best_of_.back().result(); }
  ApeAve worst() const { return worst_.result(); }
  /// The errors of the best of the first motions of each text. Source  thesis figure 4.5
  ApeAve best_of(Index first) const { return best_of_.at(static_cast<std::size_t>(first - 1)).result(); }

 private:
  std::vector<JointErrors> of_sample_, best_of_;  // of one sample, of the first 1, 2, 3, ...
  JointErrors worst_;
};

/// Errors of motions that ignore the text. One is the mean of all poses, seen from the body, standing still. The other
/// is another, random motion.
class BlindErrors {
 public:
  using Motions = std::function<JointFrames(Index)>;

  /// joints_of(i): the joints of training motion i, of this many
  BlindErrors(const RifkeVariant& variant, const JointErrors& none, Index motions, Motions joints_of,
              std::uint64_t seed);

  /// own: the number of the motion itself, if it is a training motion; it is not chosen if there are others.
  void add(const JointFrames& truth, Index own = -1);

  ApeAve mean_pose() const { return pose_.result(); }
  ApeAve random_clip() const { return clip_.result(); }

 private:
  JointErrors pose_, clip_;
  Index motions_;
  Motions joints_of_;
  JointFrames mean_;
  Philox draws_;
};

/// A row of a table of errors.
struct NamedErrors {
  std::string name;
  ApeAve errors;
};
/// "one sample", the first motion of each text. If there are several, also "mean of 10 samples", "best of 10 samples"
/// and "worst of 10 samples".
std::vector<NamedErrors> named_errors(const SampledErrors& errors);
/// The root's APE of the best of 1, 2, 3, ... motions: a line with the numbers of samples and one with the errors, as
/// `figure curves --rows` reads them (view/loss_curves.hpp).
std::string best_of_table(const SampledErrors& errors);
/// "mean pose" and "random clip".
std::vector<NamedErrors> named_errors(const BlindErrors& errors);
/// The rows below a header: APE in metres and AVE in square metres, of the root, its trajectory, and the joints,
/// relative to the root and in the world.
std::string errors_table(std::span<const NamedErrors> rows);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/sampled_errors.ipp>
#endif
