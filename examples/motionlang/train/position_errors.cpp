#include "position_errors.hpp"

#include <cstdio>

namespace program {

using ml::Index;

namespace {

Joints mean_pose(const ml::RifkeVariant& variant, Index motions, const std::function<Joints(Index)>& joints_of) {
  const auto n = static_cast<std::size_t>(variant.joints);
  Joints sum(n);
  double frames = 0;
  for (Index i = 0; i < motions; ++i) {
    const Joints joints = joints_of(i);
    const auto c = ml::canonical_motion(variant, std::span<const ml::Vec3<double>>(joints));
    for (Index t = 0; t < c.frames(); ++t, ++frames) {
      const auto frame = static_cast<std::size_t>(t);
      const ml::Vec3<double>& root = c.root[frame];
      sum[0] = sum[0] + (variant.z_up ? ml::Vec3<double>{0, 0, root.z} : ml::Vec3<double>{0, root.y, 0});
      for (std::size_t j = 1; j < n; ++j) sum[j] = sum[j] + c.local[frame * (n - 1) + j - 1];
    }
  }
  for (auto& p : sum) p = (1 / frames) * p;
  return sum;
}

}  // namespace

void print_error_heads() {
  std::printf("  %-22s   %-31s   %s\n  %22s      root   traj.   local  global      root   traj.   local  global\n", "",
              "APE (m)", "AVE (m^2)", "");
}

void print_errors(const std::string& what, const ml::ApeAve& errors) {
  std::printf("  %-22s", what.c_str());
  for (const ml::PositionErrors* p : {&errors.ape, &errors.ave})
    std::printf("   %7.3f %7.3f %7.3f %7.3f", p->root, p->trajectory, p->mean_local(), p->mean_joints());
  std::printf("\n");
}

void SampledErrors::add(const std::vector<Joints>& samples, const Joints& truth) {
  const std::vector<JointErrors::Joints> all(samples.begin(), samples.end());
  for (std::size_t k = 0; k < of_sample_.size(); ++k) of_sample_[k].add(all[k], truth);
  best_.add_best(all, truth);
  worst_.add_worst(all, truth);
}

void SampledErrors::print() const {
  std::vector<ml::ApeAve> results;
  for (const JointErrors& e : of_sample_) results.push_back(e.result());
  print_errors("one sample", results.front());
  const std::size_t n = results.size();
  if (n == 1) return;
  print_errors(ml::concat_text("mean of ", ml::counted(n, "sample")), ml::mean_errors(results));
  print_errors(ml::concat_text("best of ", ml::counted(n, "sample")), best_.result());
  print_errors(ml::concat_text("worst of ", ml::counted(n, "sample")), worst_.result());
}

BlindErrors::BlindErrors(const ml::RifkeVariant& variant, const JointErrors& none, Index motions,
                         std::function<Joints(Index)> joints_of, std::uint64_t seed)
    : pose_(none),
      clip_(none),
      motions_(motions),
      joints_of_(std::move(joints_of)),
      mean_(mean_pose(variant, motions, joints_of_)),
      lot_(ml::Philox{.seed = seed}.split("random clips")) {}

void BlindErrors::add(const Joints& truth, Index own) {
  Joints standing;
  while (standing.size() < truth.size()) standing.insert(standing.end(), mean_.begin(), mean_.end());
  pose_.add(standing, truth);
  Joints other;  // that is long enough, if one of a hundred is
  for (int tries = 0; tries < 100 && other.size() < truth.size(); ++tries) {
    const Index any = lot_.below(static_cast<std::uint32_t>(motions_));
    if (any != own || motions_ == 1) other = joints_of_(any);
  }
  clip_.add(other, truth);
}

void BlindErrors::print() const {
  print_errors("mean pose", pose_.result());
  print_errors("random clip", clip_.result());
}

}  // namespace program
