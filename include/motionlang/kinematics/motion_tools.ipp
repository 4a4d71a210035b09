// SPDX-License-Identifier: MIT
// Bodies of motion_tools.hpp.
#pragma once

#include <algorithm>  // equal, min

#include <motionlang/core/quantile.hpp>
#include <motionlang/geometry/degree.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/joint_sides.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion crop(const Motion& motion, Index first, Index last) {
  if (first < 0 || last < first || last > motion.frames()) {
    raise<shape_error>(203, "crop: frames ", first, " to ", last, " of a clip of ", motion.frames());
  }
  const Index joints = motion.skeleton.size();
  return {motion.skeleton, motion.fps,
          std::vector<Vec3<double>>(motion.root.begin() + first, motion.root.begin() + last),
          std::vector<Quaternion<double>>(motion.local.begin() + first * joints, motion.local.begin() + last * joints),
          motion.name};
}

MOTIONLANG_BODY Motion resample(const Motion& motion, double fps) {
  if (!(fps > 0) || !std::isfinite(fps)) raise<config_error>(101, "resample: frame rate ", fps);
  Motion out{motion.skeleton, fps, {}, {}, motion.name};
  if (motion.frames() == 0) return out;
  const double step = motion.fps / fps, rounding = 1e-6;  // frame times are not exact in decimal files
  const auto last = static_cast<double>(motion.frames() - 1);
  const double whole_frames = std::floor(last / step + rounding) + 1;
  if (!(whole_frames * motion.skeleton.size() <= max_rotations)) {
    raise<config_error>(101, "resample: '", motion.name, "' of ", motion.seconds(), " s at ", fps,
                        " frames per second has ", whole_frames, " frames of ",
                        counted(motion.skeleton.size(), "joint"), ", more than ", max_rotations, " rotations");
  }
  const auto frames = static_cast<Index>(whole_frames);
  out.root.reserve(static_cast<std::size_t>(frames));
  out.local.reserve(static_cast<std::size_t>(frames * motion.skeleton.size()));
  for (Index i = 0; i < frames; ++i) {
    const double moment = std::min(static_cast<double>(i) * step, last), whole = std::floor(moment + rounding);
    const auto a = static_cast<Index>(whole), b = std::min(a + 1, motion.frames() - 1);
    const double t = moment - whole < rounding ? 0 : moment - whole;
    out.root.push_back((1 - t) * motion.root_at(a) + t * motion.root_at(b));
    const auto from = motion.rotations(a), to = motion.rotations(b);
    for (std::size_t j = 0; j < from.size(); ++j) out.local.push_back(t == 0 ? from[j] : slerp(from[j], to[j], t));
  }
  return out;
}

MOTIONLANG_BODY Motion change_speed(const Motion& motion, double factor) {
  if (!(factor > 0) || !std::isfinite(factor)) raise<config_error>(101, "change_speed: factor ", factor);
  Motion out = resample(motion, motion.fps / factor);
  out.fps = motion.fps;
  return out;
}

namespace detail {

MOTIONLANG_BODY void require_same_kind(std::string_view function, const Motion& first, const Motion& second) {
  if (first.skeleton != second.skeleton || first.fps != second.fps) {
    raise<config_error>(102, function, ": '", first.name, "' has ", counted(first.skeleton.size(), "joint"), " at ",
                        first.fps, " frames per second, '", second.name, "' ", second.skeleton.size(), " at ",
                        second.fps);
  }
}

}  // namespace detail

MOTIONLANG_BODY Motion concatenate(const Motion& first, const Motion& second) {
  detail::require_same_kind("concatenate", first, second);
  Motion out = first;
  out.root.insert(out.root.end(), second.root.begin(), second.root.end());
  out.local.insert(out.local.end(), second.local.begin(), second.local.end());
  return out;
}

MOTIONLANG_BODY std::vector<int> mirror_partners(const Skeleton& skeleton) {
  std::vector<int> partners;
  for (int j = 0; j < skeleton.size(); ++j) {
    const std::string& name = skeleton.name(j);
    int partner = -1;
    for (const std::string& candidate : detail::other_side(name)) {
      if (partner < 0) partner = skeleton.find(candidate);
    }
    if (partner < 0 && detail::has_side_word(name))
      raise<config_error>(103, "mirror_partners: '", name, "' has no partner");
    partners.push_back(partner < 0 ? j : partner);
  }
  return partners;
}

MOTIONLANG_BODY Motion mirror(const Motion& motion, std::span<const int> partners) {
  const Skeleton& skeleton = motion.skeleton;
  const auto joints = static_cast<std::size_t>(skeleton.size());
  if (partners.size() != joints) {
    raise<config_error>(102, "mirror: ", partners.size(), " partners for ", counted(joints, "joint"));
  }
  Motion out = motion;
  for (std::size_t j = 0; j < joints; ++j) {
    const int p = partners[j], parent = skeleton.parents[j];
    const bool paired = p >= 0 && p < skeleton.size() && partners[static_cast<std::size_t>(p)] == static_cast<int>(j);
    if (!paired || skeleton.parent(p) != (parent < 0 ? -1 : partners[static_cast<std::size_t>(parent)])) {
      raise<config_error>(102, "mirror: joint '", skeleton.names[j], "' and its partner are not mirror images");
    }
    const auto mirrored = [](const Vec3<double>& v) { return Vec3<double>{-v.x, v.y, v.z}; };
    out.skeleton.offsets[static_cast<std::size_t>(p)] = mirrored(skeleton.offsets[j]);
    if (!skeleton.ends.empty()) out.skeleton.ends[static_cast<std::size_t>(p)] = mirrored(skeleton.ends[j]);
  }
  for (Vec3<double>& r : out.root) r.x = -r.x;
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto from = motion.rotations(f);
    const auto to = out.rotations(f);
    for (std::size_t j = 0; j < joints; ++j) {
      to[static_cast<std::size_t>(partners[j])] = {from[j].w, from[j].x, -from[j].y, -from[j].z};
    }
  }
  return out;
}

MOTIONLANG_BODY Index detect_t_pose_lead_in(const Motion& motion) {
  const auto same = [&](Index f) {
    return std::equal(motion.rotations(f).begin(), motion.rotations(f).end(), motion.rotations(0).begin(),
                      [](const auto& p, const auto& q) { return distance(p, q) < 1e-6; });
  };
  Index held = 0;  // the last frame of the first pose
  while (held + 1 < motion.frames() && same(held + 1)) ++held;
  constexpr double zero_pose = 5 * degree, fastest = 0.5 * degree;
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  const Index left = motion.frames() - held;
  const auto frames = static_cast<double>(left);  // a rate may be larger than any Index
  const auto longest = static_cast<Index>(std::min(std::ceil(0.1 * motion.fps), frames));  // of a blend, frames
  const Index seen = std::min(left - 1, longest + static_cast<Index>(std::min(motion.fps, frames)));
  if (seen < 2 || joints < 2) return 0;
  double from_zero = 0;
  for (const auto& q : motion.rotations(0).subspan(1)) from_zero += distance(q, Quaternion<double>::identity());
  if (from_zero / static_cast<double>(joints - 1) > zero_pose) return 0;

  std::vector<double> step(static_cast<std::size_t>(seen));  // mean turn of a joint from frame held + f to the next
  for (Index f = 0; f < seen; ++f) {
    const auto a = motion.rotations(held + f), b = motion.rotations(held + f + 1);
    double& turn = step[static_cast<std::size_t>(f)];
    for (std::size_t j = 1; j < joints; ++j) turn += distance(a[j], b[j]) / static_cast<double>(joints - 1);
  }
  const double usual = nth_smallest(std::vector<double>(step.begin() + 1, step.end()), (step.size() - 1) / 2);
  auto inserted = [&](Index f) {
    const double turn = step[static_cast<std::size_t>(f)];
    const double before = f == 0 ? turn : step[static_cast<std::size_t>(f - 1)];
    return turn > 3 * usual && turn > fastest && turn > 0.65 * before;  // a blend slows down gradually
  };
  Index blend = 0;
  while (blend < std::min(longest, seen) && inserted(blend)) ++blend;
  if (blend == 0) return 0;
  return held + (blend < 2 ? blend : std::min(2 * blend, left - 1));
}

MOTIONLANG_NAMESPACE_END
