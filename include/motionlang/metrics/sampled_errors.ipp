// SPDX-License-Identifier: MIT
// Bodies of sampled_errors.hpp.
#pragma once

#include <utility>  // move

#include <motionlang/core/formatted.hpp>
#include <motionlang/metrics/sampled_errors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The mean of the poses of all motions, seen from a body that faces ahead.
inline JointFrames mean_pose(const RifkeVariant& variant, Index motions, const BlindErrors::Motions& joints_of) {
  const auto n = static_cast<std::size_t>(variant.joints);
  JointFrames sum(n);
  double frames = 0;
  for (Index i = 0; i < motions; ++i) {
    const JointFrames joints = joints_of(i);
    const auto c = canonical_motion(variant, std::span<const Vec3<double>>(joints));
    for (Index t = 0; t < c.frames(); ++t, ++frames) {
      const auto frame = static_cast<std::size_t>(t);
      const Vec3<double>& root = c.root[frame];
      sum[0] = sum[0] + (variant.z_up ? Vec3<double>{0, 0, root.z} : Vec3<double>{0, root.y, 0});
      for (std::size_t j = 1; j < n; ++j) sum[j] = sum[j] + c.local[frame * (n - 1) + j - 1];
    }
  }
  for (auto& p : sum) p = (1 / frames) * p;
  return sum;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<JointErrors::Clip> SampledErrors::clips(const std::vector<JointFrames>& samples,
                                                                    const JointFrames& truth) const {
  const std::vector<JointErrors::Joints> all(samples.begin(), samples.end());
  std::vector<JointErrors::Clip> out;
  for (std::size_t k = 0; k < of_sample_.size(); ++k) out.push_back(worst_.clip(all[k], truth));
  for (std::size_t k = 0; k < best_of_.size(); ++k) out.push_back(worst_.best_clip(std::span(all).first(k + 1), truth));
  out.push_back(worst_.worst_clip(all, truth));
  return out;
}

MOTIONLANG_BODY void SampledErrors::add(std::span<const JointErrors::Clip> of_text) {
  const std::size_t count = of_sample_.size();
  if (of_text.size() != 2 * count + 1)
    raise<shape_error>(205, "SampledErrors: ", of_text.size(), " errors of ", counted(count, "sample"), ", expected ",
                       2 * count + 1);
  for (std::size_t k = 0; k < count; ++k) of_sample_[k].add(of_text[k]), best_of_[k].add(of_text[count + k]);
  worst_.add(of_text.back());
}

MOTIONLANG_BODY ApeAve SampledErrors::mean() const {
  std::vector<ApeAve> results;
  for (const JointErrors& e : of_sample_) results.push_back(e.result());
  return mean_errors(results);
}

MOTIONLANG_BODY BlindErrors::BlindErrors(const RifkeVariant& variant, const JointErrors& none, Index motions,
                                         Motions joints_of, std::uint64_t seed)
    : pose_(none),
      clip_(none),
      motions_(motions),
      joints_of_(std::move(joints_of)),
      mean_(detail::mean_pose(variant, motions, joints_of_)),
      draws_(Philox{.seed = seed}.split("random clips")) {}

MOTIONLANG_BODY void BlindErrors::add(const JointFrames& truth, Index own) {
  JointFrames standing;
  while (standing.size() < truth.size()) standing.insert(standing.end(), mean_.begin(), mean_.end());
  pose_.add(standing, truth);
  JointFrames other;  // one that is long enough, if there is one among a hundred
  for (int tries = 0; tries < 100 && other.size() < truth.size(); ++tries) {
    const Index any = draws_.below(static_cast<std::uint32_t>(motions_));
    if (any != own || motions_ == 1) other = joints_of_(any);
  }
  clip_.add(other, truth);
}

MOTIONLANG_BODY std::vector<NamedErrors> named_errors(const SampledErrors& errors) {
  std::vector<NamedErrors> out{{"one sample", errors.first()}};
  if (errors.samples() == 1) return out;
  const std::string samples = " of " + counted(errors.samples(), "sample");
  out.push_back({"mean" + samples, errors.mean()});
  out.push_back({"best" + samples, errors.best()});
  out.push_back({"worst" + samples, errors.worst()});
  return out;
}

MOTIONLANG_BODY std::string best_of_table(const SampledErrors& errors) {
  std::string counts = formatted("  %-22s", "samples"), values = formatted("  %-22s", "APE root of the best");
  for (Index k = 1; k <= errors.samples(); ++k) {
    counts += formatted("  %9td", k);
    values += formatted("  %9.4f", errors.best_of(k).ape.root);
  }
  return counts + "\n" + values + "\n";
}

MOTIONLANG_BODY std::vector<NamedErrors> named_errors(const BlindErrors& errors) {
  return {{"mean pose", errors.mean_pose()}, {"random clip", errors.random_clip()}};
}

MOTIONLANG_BODY std::string errors_table(std::span<const NamedErrors> rows) {
  std::string out = formatted("  %-22s   %-31s   %s\n  %22s      root   traj.   local  global      root   traj.   ", "",
                              "APE (m)", "AVE (m^2)", "");
  out += "local  global\n";
  for (const auto& [name, errors] : rows) {
    out += formatted("  %-22s", name.c_str());
    for (const PositionErrors* p : {&errors.ape, &errors.ave})
      out += formatted("   %7.3f %7.3f %7.3f %7.3f", p->root, p->trajectory, p->mean_local(), p->mean_joints());
    out += "\n";
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
