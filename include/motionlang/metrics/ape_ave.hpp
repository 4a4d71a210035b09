// SPDX-License-Identifier: MIT
/// Average position error and average variance error of generated motions against recorded ones, and the jump between
/// two actions.
///
///     ApeAveMetric<double> metric(temos_rifke(), 0.001);                      // joints in mm, errors in m
///     for (const auto& [generated, recorded] : pairs) metric.add(generated, recorded);  // joints, (frames, J) each
///     const ApeAve errors = metric.result();                             // errors.ape.root, errors.ave.mean_joints()
///
/// Both motions are moved to the start: root at the origin, heading 0, on the floor. x is the root (3 coordinates), the
/// trajectory (2), each joint seen from the body ("local", "pose") or each joint in the world:
///     APE_x = sum_clips sum_t |x_t - x*_t| / sum_clips L
///     AVE_x = mean_clips |v - v*|,   v = sum_t (x_t - mean x)^2 / (L - 1) of each coordinate
/// Source  TEMOS (Petrovich, Black, Varol, ECCV 2022), section 4.1 and appendix C: APE is TEMOS eq. 4, AVE is
///         TEMOS eq. 5 of the variance in TEMOS eq. 6; thesis 4.3.1, A.3.2, B.3.1; TEMOS
///         temos/model/metrics/compute*.py, TEACH teach/model/metrics/compute.py and compute_td.py, SINC
///         sinc/model/metrics/compute_sinc.py
/// Units   those of the joints times `unit`; AVE in their square
/// Differs from the paper: APE is an average over the frames of the whole set, not over clips, and the variance has no
/// square root. As published, the body's heading is that of knees and elbows in TEMOS and TEACH (temos_rifke), and is
/// swapped in SINC (sinc_rifke). The floor is that of the whole clip, which is cut to the common length afterwards
#pragma once

#include <array>    // level coordinates
#include <numeric>  // accumulate
#include <vector>   // joints

#include <motionlang/features/rifke.hpp>
#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A motion moved to the start. Frames follow each other.
template <Scalar S>
struct CanonicalMotion {
  std::vector<Vec3<S>> joints;               // (frames, J)
  std::vector<Vec3<S>> local;                // (frames, J - 1): joints 1 ... seen from the body, heights unchanged
  std::vector<Vec3<S>> root;                 // (frames)
  std::vector<std::array<S, 2>> trajectory;  // (frames): the root over the ground

  Index frames() const { return std::ssize(root); }
};

/// joints  (frames, J) of the variant
/// unit    all results are multiplied by it: 0.001 for millimetres
/// Throws  shape_error 205, 203
template <Scalar S>
CanonicalMotion<S> canonical_motion(const RifkeVariant& variant, std::span<const Vec3<S>> joints, S unit = S(1)) {
  const auto features = rifke_features(variant, joints).features;
  CanonicalMotion<S> out;
  out.joints = rifke_joints(variant, std::span<const S>(features));
  for (Vec3<S>& p : out.joints) p = unit * p;
  const auto width = static_cast<std::size_t>(variant.size()), n = static_cast<std::size_t>(variant.joints);
  for (std::size_t at = 0; at < features.size(); at += width) {
    for (std::size_t j = 1; j + 3 < width; j += 3) {
      out.local.push_back(unit * Vec3<S>{features[at + j], features[at + j + 1], features[at + j + 2]});
    }
  }
  for (std::size_t at = 0; at < out.joints.size(); at += n) {
    const auto level = detail::leveled(out.joints[at], variant.z_up);
    out.root.push_back(out.joints[at]);
    out.trajectory.push_back({level.a, level.b});
  }
  return out;
}

/// Errors of one kind.
struct PositionErrors {
  double root = 0, trajectory = 0;
  std::vector<double> local{}, joints{};  // of each joint; joint 0 has no local one

  double mean_local() const { return mean(local); }    // "mean local", "mean pose"
  double mean_joints() const { return mean(joints); }  // "mean global"

 private:
  static double mean(const std::vector<double>& x) {
    return x.empty() ? 0 : std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  }
};
struct ApeAve {
  PositionErrors ape, ave;
};

namespace detail {

inline std::array<double, 3> coordinates(const auto& p) {
  if constexpr (requires { p.z; }) {
    return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  } else {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), 0.0};
  }
}

/// Point j of every frame of `per_frame` points: the sum of distances over time, and the distance of the variances.
struct PointErrors {
  double distance = 0, variance = 0;
};
template <class Point>
PointErrors point_errors(const std::vector<Point>& a, const std::vector<Point>& b, std::size_t frames,
                         std::size_t per_frame, std::size_t j) {
  PointErrors out;
  std::array<double, 3> mean_a{}, mean_b{}, difference{};
  for (std::size_t t = 0; t < frames; ++t) {
    const auto x = coordinates(a[t * per_frame + j]), y = coordinates(b[t * per_frame + j]);
    double squares = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      squares += (x[i] - y[i]) * (x[i] - y[i]);
      mean_a[i] += x[i] / static_cast<double>(frames), mean_b[i] += y[i] / static_cast<double>(frames);
    }
    out.distance += std::sqrt(squares);  // TEMOS eq. 4
  }
  for (std::size_t t = 0; t < frames; ++t) {
    const auto x = coordinates(a[t * per_frame + j]), y = coordinates(b[t * per_frame + j]);
    for (std::size_t i = 0; i < 3; ++i) {
      difference[i] += (x[i] - mean_a[i]) * (x[i] - mean_a[i]) - (y[i] - mean_b[i]) * (y[i] - mean_b[i]);
    }
  }
  // TEMOS eq. 5: the length of the difference of two variances, each by TEMOS eq. 6.
  for (const double d : difference) out.variance += d * d;
  out.variance = std::sqrt(out.variance) / static_cast<double>(frames - 1);
  return out;
}

/// The errors of one pair: sums over time, and variances, of the first `frames` frames.
template <Scalar S>
ApeAve clip_errors(const CanonicalMotion<S>& a, const CanonicalMotion<S>& b, Index frames) {
  const auto n = static_cast<std::size_t>(frames);
  ApeAve out;
  auto one = [&](const auto& x, const auto& y, double PositionErrors::*where) {
    const PointErrors e = point_errors(x, y, n, 1, 0);
    out.ape.*where = e.distance, out.ave.*where = e.variance;
  };
  auto all = [&](const auto& x, const auto& y, std::vector<double> PositionErrors::*where) {
    const std::size_t per_frame = x.size() / static_cast<std::size_t>(a.frames());
    for (std::size_t j = 0; j < per_frame; ++j) {
      const PointErrors e = point_errors(x, y, n, per_frame, j);
      (out.ape.*where).push_back(e.distance), (out.ave.*where).push_back(e.variance);
    }
  };
  one(a.root, b.root, &PositionErrors::root);
  one(a.trajectory, b.trajectory, &PositionErrors::trajectory);
  all(a.local, b.local, &PositionErrors::local);
  all(a.joints, b.joints, &PositionErrors::joints);
  return out;
}

/// to += x
inline void add_errors(PositionErrors& to, const PositionErrors& x) {
  to.root += x.root, to.trajectory += x.trajectory;
  to.local.resize(x.local.size()), to.joints.resize(x.joints.size());
  for (std::size_t j = 0; j < x.local.size(); ++j) to.local[j] += x.local[j];
  for (std::size_t j = 0; j < x.joints.size(); ++j) to.joints[j] += x.joints[j];
}
inline PositionErrors divided(PositionErrors x, double by) {
  x.root /= by, x.trajectory /= by;
  for (double& e : x.local) e /= by;
  for (double& e : x.joints) e /= by;
  return x;
}

}  // namespace detail

/// The mean of several results, such as "avg" over samples with one result each. Throws numeric_error 302 without
/// results.
inline ApeAve mean_errors(std::span<const ApeAve> results) {
  if (results.empty()) raise<numeric_error>(302, "mean_errors: no results");
  ApeAve sums;
  for (const ApeAve& e : results) detail::add_errors(sums.ape, e.ape), detail::add_errors(sums.ave, e.ave);
  const auto n = static_cast<double>(results.size());
  return {detail::divided(sums.ape, n), detail::divided(sums.ave, n)};
}

/// Collects pairs of clips.
template <Scalar S>
class ApeAveMetric {
 public:
  using Joints = std::span<const Vec3<S>>;

  /// The errors of one pair of clips, which another metric of the same kind can add.
  struct Clip {
    ApeAve errors{};  // sums over the frames, and variances
    Index frames = 0;
  };

  explicit ApeAveMetric(RifkeVariant variant, S unit = S(1)) : variant_(std::move(variant)), unit_(unit) {}

  /// Adds a pair of joints, (frames, J) each, which are compared up to the shorter length. Throws shape_error 205, 203;
  /// numeric_error 302 unless two frames are compared
  void add(Joints generated, Joints reference) { add(clip(generated, reference)); }
  void add(const Clip& c) { collect(c.errors, c.frames); }
  Clip clip(Joints generated, Joints reference) const {
    const auto a = canonical(generated), b = canonical(reference);
    return {errors_of(a, b, common(a, b)), common(a, b)};
  }
  /// The same for motions that were padded at the end. The padding counts for the floor, as in TEMOS' validation. Also
  /// throws shape_error 203 if there are fewer than `frames`.
  void add_padded(Joints generated, Joints reference, Index frames) {
    const auto a = canonical(generated), b = canonical(reference);
    if (frames > std::min(a.frames(), b.frames()))
      raise<shape_error>(203, "ApeAveMetric: ", frames, " of ", a.frames(), " and ", b.frames(), " frames");
    collect(errors_of(a, b, frames), frames);
  }
  /// Adds the sample with the smallest (largest) sum of root errors. As published, all its sums are divided by the
  /// frames of the first sample. Also throws numeric_error 302 without samples.
  void add_best(std::span<const Joints> samples, Joints reference) { add(best_clip(samples, reference)); }
  void add_worst(std::span<const Joints> samples, Joints reference) { add(worst_clip(samples, reference)); }
  Clip best_clip(std::span<const Joints> samples, Joints reference) const { return chosen(samples, reference, false); }
  Clip worst_clip(std::span<const Joints> samples, Joints reference) const { return chosen(samples, reference, true); }

  Index clips() const { return clips_; }

  /// Throws numeric_error 302 before the first pair.
  ApeAve result() const {
    if (clips_ == 0) raise<numeric_error>(302, "ApeAveMetric: no clips");
    return {detail::divided(sums_.ape, static_cast<double>(frames_)),
            detail::divided(sums_.ave, static_cast<double>(clips_))};
  }

 private:
  CanonicalMotion<S> canonical(Joints joints) const { return canonical_motion(variant_, joints, unit_); }
  static Index common(const CanonicalMotion<S>& a, const CanonicalMotion<S>& b) {
    return std::min(a.frames(), b.frames());
  }
  static ApeAve errors_of(const CanonicalMotion<S>& a, const CanonicalMotion<S>& b, Index frames) {
    if (frames < 2) raise<numeric_error>(302, "ApeAveMetric: a variance over ", frames, " frames");
    return detail::clip_errors(a, b, frames);
  }
  void collect(const ApeAve& errors, Index frames) {
    detail::add_errors(sums_.ape, errors.ape);
    detail::add_errors(sums_.ave, errors.ave);
    frames_ += frames;
    ++clips_;
  }
  Clip chosen(std::span<const Joints> samples, Joints reference, bool worst) const {
    if (samples.empty()) raise<numeric_error>(302, "ApeAveMetric: no samples");
    const auto b = canonical(reference);
    Clip out;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const auto a = canonical(samples[s]);
      ApeAve errors = errors_of(a, b, common(a, b));
      if (s == 0) out.frames = common(a, b);
      const double now = errors.ape.root, before = out.errors.ape.root;
      if (s == 0 || (worst ? now > before : now < before)) out.errors = std::move(errors);
    }
    return out;
  }

  RifkeVariant variant_;
  S unit_;
  ApeAve sums_;  // over frames, over clips
  Index frames_ = 0, clips_ = 0;
};

/// The jump at a frame: the mean over joints of |X[frame] - X[frame - 1]|. TEACH uses the first frame of the second
/// action of pairs, generated without interpolation, and averages over pairs.
/// joints  (frames, J)
/// Throws  shape_error 205, 203 unless 1 <= frame < frames
template <Scalar S>
double transition_distance(std::span<const Vec3<S>> joints, Index per_frame, Index frame) {
  if (per_frame < 1 || std::ssize(joints) % per_frame != 0)
    raise<shape_error>(205, "transition_distance: ", joints.size(), " joints are not frames of ", per_frame);
  const Index frames = std::ssize(joints) / per_frame;
  if (frame < 1 || frame >= frames) raise<shape_error>(203, "transition_distance: at frame ", frame, " of ", frames);
  double sum = 0;
  for (Index j = 0; j < per_frame; ++j) {
    const auto now = static_cast<std::size_t>(frame * per_frame + j);
    sum += static_cast<double>(norm(joints[now] - joints[now - static_cast<std::size_t>(per_frame)]));
  }
  return sum / static_cast<double>(per_frame);
}

MOTIONLANG_NAMESPACE_END
