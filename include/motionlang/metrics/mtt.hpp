// SPDX-License-Identifier: MIT
/// The metrics of STMC on MTT: motions made from timelines, compared with their texts.
///
///     const auto features = mtt_features(humanml3d_chains(), joints, 24);          // of each motion, Z up, 20 fps
///     const MttScores s = mtt_scores(motions, reference, encode);                  // encode: TMR's motion encoder
///
/// R@1, R@3     share of the intervals whose text is the first (among the first three) of all texts, 0 to 1
/// M2T, M2M     mean of (cos + 1) / 2 of an interval's latent with that of its text, of its recorded motion
/// FID          of unit latents of five crops of each motion against those of the recorded motions (FID+)
/// transition   mean displacement of the joints between two frames where a text begins or ends [m]; printed in cm
/// Two variants: `as_coded` gives the published tables, `as_written` follows the thesis. Their values cannot be
/// compared.
/// Source  thesis 6.3.2; STMC (Petrovich et al., CVPR workshops 2024) mtt/stmc_metrics.py, mtt/metrics.py,
///         mtt/motion_representation_local.py
/// Differs as coded from the thesis: the crops for FID begin at five fixed frames (47, 117, 67, 103, 9), because the
/// number of features is taken for the length. They are shorter if the motion ends. The reference is whole clips.
/// Transitions subtract the x coordinate of each joint instead of the root, and leave the last one out
#pragma once

#include <algorithm>  // sort, unique
#include <array>      // quarters
#include <cmath>      // isnan
#include <limits>     // NaN
#include <numeric>    // accumulate
#include <vector>     // features

#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/numpy_random.hpp>
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/metrics/frechet.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class MttFlavour { as_coded, as_written };

/// HumanML3D's values of joint positions, of which the first 22 count.
/// joints     (frames, per_frame)
/// z_up       as in MDM-SMPL; false: Y up, as in MDM and MotionDiffuse
/// result     (frames - 1, 263), not normalised
/// Throws     shape_error 205 and what guoh3d_features throws
template <Scalar S>
std::vector<S> mtt_features(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints, Index per_frame,
                            bool z_up = true) {
  const auto kept = static_cast<Index>(skeleton.size());
  if (per_frame < kept || std::ssize(joints) % per_frame != 0)
    raise<shape_error>(205, "mtt_features: ", joints.size(), " joints are not frames of ", per_frame);
  std::vector<Vec3<S>> y_up;
  for (Index at = 0; at < std::ssize(joints); at += per_frame) {
    for (Index j = 0; j < kept; ++j) {
      const Vec3<S>& p = joints[static_cast<std::size_t>(at + j)];
      y_up.push_back(z_up ? Vec3<S>{p.x, p.z, -p.y} : p);
    }
  }
  const std::vector<S> lengths(skeleton.lengths.begin(), skeleton.lengths.end());
  const Guoh3dOptions options{.rotations = {.facing = {.sigma = 20}, .fix_opposite_bones = true}};
  return guoh3d_features(skeleton, std::span<const Vec3<S>>(y_up), std::span<const S>(lengths), options);
}

/// Joints without the turns, so that every pose is seen in its own heading and the root moves by its own velocities.
/// features  (frames, 12 J - 1), not normalised
/// result    (frames, J), Z up
/// Throws    shape_error 205
template <Scalar S>
std::vector<Vec3<S>> mtt_local_joints(std::span<const S> features, Index joints = 22) {
  std::vector<S> straight(features.begin(), features.end());
  const auto width = static_cast<std::size_t>(Guoh3dSlots{joints}.size());
  for (std::size_t at = 0; at < straight.size(); at += width) straight[at] = S(0);
  auto out = guoh3d_joints(std::span<const S>(straight), joints);
  for (Vec3<S>& p : out) p = {p.x, -p.z, p.y};
  return out;
}

/// Frames at which a text begins or ends, in order, without the beginning and the end of the whole. As coded, frames
/// beyond the features are removed first, which drops the last real one.
std::vector<Index> transition_points(const Timeline& timeline, Index feature_frames, MttFlavour flavour);
/// Points of a motion without intervals: recorded clips, and motions of one text.
inline std::array<Index, 3> quarter_points(Index feature_frames) {
  return {feature_frames / 4, 2 * feature_frames / 4, 3 * feature_frames / 4};
}

/// The offset that is subtracted from a joint before it is compared with the frame before.
enum class MttOrigin {
  root,   // the root, as written and for recorded motions
  own_x,  // its own x, from all of its coordinates: as coded for generated motions
};
inline MttOrigin mtt_origin(MttFlavour flavour) {
  return flavour == MttFlavour::as_coded ? MttOrigin::own_x : MttOrigin::root;
}

/// The mean over joints of |Q[p] - Q[p - 1]| at each point. Points without a frame, or without one before, are left
/// out.
/// joints  (frames, per_frame), see mtt_local_joints
/// Throws  shape_error 205
template <Scalar S>
std::vector<double> mtt_transitions(std::span<const Vec3<S>> joints, std::span<const Index> points, MttOrigin origin,
                                    Index per_frame = 22) {
  if (per_frame < 1 || std::ssize(joints) % per_frame != 0)
    raise<shape_error>(205, "mtt_transitions: ", joints.size(), " joints are not frames of ", per_frame);
  auto seen = [&](Index frame, Index j) {
    const Vec3<S>& p = joints[static_cast<std::size_t>(frame * per_frame + j)];
    return p -
           (origin == MttOrigin::root ? joints[static_cast<std::size_t>(frame * per_frame)] : Vec3<S>{p.x, p.x, p.x});
  };
  std::vector<double> out;
  for (const Index p : points) {
    if (p < 1 || p * per_frame >= std::ssize(joints)) continue;
    double sum = 0;
    for (Index j = 0; j < per_frame; ++j) sum += static_cast<double>(norm(seen(p, j) - seen(p - 1, j)));
    out.push_back(sum / static_cast<double>(per_frame));
  }
  return out;
}

/// Crops of a motion for FID.
struct RealismCrops {
  Index frames = 100, samples = 5;
  std::uint32_t seed = 0;
  Index features = 263;  // as coded, starts are below this number minus the frames, the same for every motion
};
/// As coded: NumPy's generator, with a new seed for each motion. Throws config_error 101.
std::vector<Index> fixed_crop_starts(const RealismCrops& crops = {});
/// As written: anywhere in the motion. A shorter motion is taken whole. Throws config_error 101.
std::vector<Index> random_crop_starts(Index feature_frames, NumpyRandom& rng, const RealismCrops& crops = {});
/// Frames of a crop that begins at `start`, fewer at the end of the motion.
inline Index crop_frames(Index start, Index feature_frames, const RealismCrops& crops = {}) {
  return std::clamp<Index>(feature_frames - start, 0, crops.frames);
}

/// Retrieval shares and similarities of latents for known texts.
struct MttSemantics {
  double r1 = 0, r3 = 0, m2t = 0, m2m = 0;
};
/// latents                  (n, d), of intervals
/// labels                   (n), the right text of each
/// text_latents, motion_latents  (texts, d)
/// Throws                   shape_error 204, 203; numeric_error 302 without latents, 301 for a NaN
template <Scalar S, Scalar T>
MttSemantics mtt_semantics(const Rows<S>& latents, std::span<const Index> labels, const Rows<T>& text_latents,
                           const Rows<T>& motion_latents) {
  detail::require_same_count("mtt_semantics: latents against labels", latents.size(), std::ssize(labels));
  detail::require_same_count("mtt_semantics: texts against their motions", text_latents.size(), motion_latents.size());
  if (latents.size() == 0) raise<numeric_error>(302, "mtt_semantics: no latents");
  const auto to_text = cosine_similarities(latents, text_latents),
             to_motion = cosine_similarities(latents, motion_latents);
  for (const auto* table : {&to_text, &to_motion}) {
    for (const double s : *table) {
      if (std::isnan(s)) raise<numeric_error>(301, "mtt_semantics: a similarity is NaN");
    }
  }
  const Index texts = text_latents.size();
  MttSemantics out;
  for (Index i = 0; i < latents.size(); ++i) {
    const Index label = labels[static_cast<std::size_t>(i)];
    if (label < 0 || label >= texts) raise<shape_error>(203, "mtt_semantics: text ", label, " of ", texts);
    const auto row = std::span(to_text).subspan(static_cast<std::size_t>(i * texts), static_cast<std::size_t>(texts));
    const double own = row[static_cast<std::size_t>(label)];
    const auto closer = std::count_if(row.begin(), row.end(), [&](double s) { return s > own; });
    out.r1 += closer < 1 ? 1 : 0, out.r3 += closer < 3 ? 1 : 0;
    out.m2t += similarity_score(own);
    out.m2m += similarity_score(to_motion[static_cast<std::size_t>(i * texts + label)]);
  }
  for (double* sum : {&out.r1, &out.r3, &out.m2t, &out.m2m}) *sum /= static_cast<double>(latents.size());
  return out;
}

/// A motion with the intervals of its timeline, and the number of each interval's text.
template <Scalar S>
struct MttMotion {
  Timeline timeline;          // frames at 20 fps
  std::vector<Index> labels;  // (intervals)
  std::vector<S> features;    // (frames - 1, 263), see mtt_features
};
/// One recorded motion for each text, or none at all. Latents (texts, latent).
template <Scalar S>
struct MttReference {
  std::vector<double> text_latents, motion_latents;  // the latter empty without recorded motions
  std::vector<std::vector<S>> features;  // (frames - 1, 263) of each; for the transitions of the ground truth
  Index latent = 256;
};

struct MttEvaluation {
  MttFlavour flavour = MttFlavour::as_coded;
  bool one_text = false;  // each motion comes from one sentence: compare the whole with each of its texts
  RealismCrops crops{};
  std::uint32_t seed = 0;  // of the crops as written
  Index joints = 22;
};

/// M2M and FID need recorded motions, and the transition a point that is measured: without them they are NaN. As coded,
/// few motions may have no such point.
struct MttScores {
  double r1 = 0, r3 = 0, m2t = 0, m2m = 0, fid = 0, transition = 0;
};

namespace detail {

/// NaN of none.
inline double mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The similarities with texts alone where there are no recorded motions.
template <Scalar S>
MttSemantics semantics_of(const Rows<double>& latents, std::span<const Index> labels,
                          const MttReference<S>& reference) {
  const Rows texts(reference.text_latents, reference.latent);
  const bool recorded = !reference.motion_latents.empty();
  auto out = mtt_semantics(latents, labels, texts, recorded ? Rows(reference.motion_latents, reference.latent) : texts);
  if (!recorded) out.m2m = std::numeric_limits<double>::quiet_NaN();
  return out;
}

/// FID of unit latents; NaN where there are no recorded motions.
template <Scalar S>
double realism_of(const Rows<double>& crops, const MttReference<S>& reference) {
  if (reference.motion_latents.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto made = unit_rows(crops), recorded = unit_rows(Rows(reference.motion_latents, reference.latent));
  return frechet_distance(Rows(made, reference.latent), Rows(recorded, reference.latent));
}

}  // namespace detail

/// encode(rows) -> latent values of a crop; rows: Rows<S> of (frames, 263), not normalised
/// As coded, motions of one text are cut after 263 frames.
/// Throws  shape_error 203 (an interval outside of its motion), 204, 205; numeric_error 302
template <Scalar S, class Encode>
MttScores mtt_scores(std::span<const MttMotion<S>> motions, const MttReference<S>& reference, Encode&& encode,
                     const MttEvaluation& options = {}) {
  const Index width = Guoh3dSlots{options.joints}.size();
  std::vector<double> intervals, crops, transitions;
  std::vector<Index> labels;
  NumpyRandom rng(options.seed);
  for (const MttMotion<S>& m : motions) {
    const Rows rows(m.features, width);
    const Index frames = rows.size();
    detail::require_same_count("mtt_scores: intervals against texts", std::ssize(m.timeline.intervals),
                               std::ssize(m.labels));
    auto append = [&](std::vector<double>& to, Index first, Index count) {
      for (const auto x : encode(rows.slice(first, count))) to.push_back(static_cast<double>(x));
    };
    labels.insert(labels.end(), m.labels.begin(), m.labels.end());
    for (const Interval& i : m.timeline.intervals) {
      const Index whole = options.flavour == MttFlavour::as_coded ? std::min(frames, width) : frames;
      options.one_text ? append(intervals, 0, whole)
                       : append(intervals, i.start, std::min(i.end, frames) - i.start);  // the last row may be missing
    }
    const auto starts = options.flavour == MttFlavour::as_coded ? fixed_crop_starts(options.crops)
                                                                : random_crop_starts(frames, rng, options.crops);
    for (const Index start : starts) {
      if (const Index count = crop_frames(start, frames, options.crops); count > 0) append(crops, start, count);
    }
    const auto quarters = quarter_points(frames);
    const auto points = options.one_text ? std::vector<Index>(quarters.begin(), quarters.end())
                                         : transition_points(m.timeline, frames, options.flavour);
    const auto joints = mtt_local_joints(std::span<const S>(m.features), options.joints);
    for (const double d :
         mtt_transitions(std::span<const Vec3<S>>(joints), points, mtt_origin(options.flavour), options.joints)) {
      transitions.push_back(d);
    }
  }
  const auto s = detail::semantics_of(Rows(intervals, reference.latent), labels, reference);
  return {.r1 = s.r1,
          .r3 = s.r3,
          .m2t = s.m2t,
          .m2m = s.m2m,
          .fid = detail::realism_of(Rows(crops, reference.latent), reference),
          .transition = detail::mean_of(transitions)};
}

namespace detail {

/// Latents that each belong to the text of the same number.
template <Scalar S>
MttSemantics own_semantics(const Rows<S>& motion_latents, const Rows<S>& text_latents) {
  std::vector<Index> labels(static_cast<std::size_t>(motion_latents.size()));
  std::iota(labels.begin(), labels.end(), Index{0});
  return mtt_semantics(motion_latents, labels, text_latents, motion_latents);
}

}  // namespace detail

/// The row of the recorded motions themselves: M2M is 1 and FID 0.
template <Scalar S>
MttScores mtt_ground_truth(const MttReference<S>& reference, Index joints = 22) {
  const Rows text_latents(reference.text_latents, reference.latent),
      motion_latents(reference.motion_latents, reference.latent);
  const auto s = detail::own_semantics(motion_latents, text_latents);
  std::vector<double> transitions;
  for (const auto& features : reference.features) {
    const auto local = mtt_local_joints(std::span<const S>(features), joints);
    const auto points = quarter_points(std::ssize(local) / joints);
    for (const double d : mtt_transitions(std::span<const Vec3<S>>(local), points, MttOrigin::root, joints))
      transitions.push_back(d);
  }
  return {.r1 = s.r1, .r3 = s.r3, .m2t = s.m2t, .m2m = s.m2m, .fid = 0, .transition = detail::mean_of(transitions)};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/mtt.ipp>
#endif
