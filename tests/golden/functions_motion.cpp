// Golden functions: the 205-vector, preparation of AMASS, smoothing of joints.
#include <motionlang/datasets/amass_resample.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;

template <class S>
std::vector<S> flat(const std::vector<ml::Vec3<S>>& list) {
  std::vector<S> out;
  for (const auto& v : list) out.insert(out.end(), {v.x, v.y, v.z});
  return out;
}
template <class S>
std::vector<S> flat(const std::vector<ml::Matrix3<S>>& list) {
  std::vector<S> out;
  for (const auto& m : list) out.insert(out.end(), m.m.begin(), m.m.end());
  return out;
}

template <class S>
void smplrifke_forward(Case& c) {
  const auto poses = c.values<S>("in/poses"), joints = c.values<S>("in/joints");
  const auto features = ml::smplrifke_from_poses(std::span<const S>(poses), std::span<const S>(joints));
  c.out("features", {c.shape("in/poses")[0], ml::smplrifke_size}, features);
}

template <class S>
void smplrifke_inverse(Case& c) {
  const auto features = c.values<S>("in/features");
  const ml::Index T = c.shape("in/features")[0];
  const auto angles = c.config()["first_angles"].as<std::vector<double>>();
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const auto motion = ml::smplrifke_inverse(std::span<const S>(features), {.first_angle = angles[i]});
    const std::string suffix = "_" + std::to_string(i);
    c.out("joints" + suffix, {T, 24, 3}, flat(motion.joints));
    c.out("trans" + suffix, {T, 3}, flat(motion.trans));
    c.out("rotations" + suffix, {T, 22, 3, 3}, flat(motion.rotations));
    c.out("poses" + suffix, {T, 66}, motion.poses());
  }
}

template <class S>
void out_poses(Case& c, const ml::AmassPoses<S>& result) {
  const ml::Index T = std::ssize(result.trans) / 3;
  c.out("poses", {T, c.shape("in/poses")[1]}, result.poses);
  c.out("trans", {T, 3}, result.trans);
}

/// TEACH's choice of frames.
void amass_frame_indices(Case& c) {
  const auto fps = c.values<double>("in/fps");
  const auto frames = c.values<ml::Index>("in/frames");
  for (std::size_t k = 0; k < fps.size(); ++k) {
    c.out("ids" + std::to_string(k), ml::spread_frames(frames[k], fps[k], c.config()["out_fps"].as<double>()));
  }
}

/// STMC's poses between the frames. TEACH has another function of this name.
template <class S>
void amass_resampling(Case& c) {
  if (c.has("in/frames")) return amass_frame_indices(c);
  const auto poses = c.values<S>("in/poses"), trans = c.values<S>("in/trans");
  out_poses(c, ml::amass_resample(std::span<const S>(poses), std::span<const S>(trans),
                                  c.config()["old_fps"].as<double>(), c.config()["new_fps"].as<double>()));
}

template <class S>
void amass_mirroring(Case& c) {
  const auto poses = c.values<S>("in/poses"), trans = c.values<S>("in/trans");
  out_poses(c, ml::amass_mirror(std::span<const S>(poses), std::span<const S>(trans)));
}

template <class S>
void joint_smoothing(Case& c) {
  const auto joints = c.values<S>("in/joints");
  const ml::Shape& shape = c.shape("in/joints");
  c.out(
      "smoothed", shape,
      ml::gaussian_smooth(std::span<const S>(joints), shape.count(1, shape.rank()), c.config()["sigma"].as<double>()));
}

const Registration registrations[] = {
    {"smplrifke forward", "double", smplrifke_forward<double>},
    {"smplrifke forward", "float", smplrifke_forward<float>},
    {"smplrifke inverse", "double", smplrifke_inverse<double>},
    {"smplrifke inverse", "float", smplrifke_inverse<float>},
    {"amass resampling", "double", amass_resampling<double>},
    {"amass resampling", "float", amass_resampling<float>},
    {"amass mirroring", "double", amass_mirroring<double>},
    {"amass mirroring", "float", amass_mirroring<float>},
    {"motiondiffuse joint smoothing", "double", joint_smoothing<double>},
    {"motiondiffuse joint smoothing", "float", joint_smoothing<float>},
};

}  // namespace
