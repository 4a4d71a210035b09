// SPDX-License-Identifier: MIT
// Bodies of latent_motion_model.hpp.
#pragma once

#include <algorithm>  // min, max
#include <cmath>      // atan2

#include <motionlang/generate/finish_motion.hpp>
#include <motionlang/generate/latent_motion_model.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The transform that moves a whole clip over another: the mean turn between their roots, then the mean distance over
/// the floor.
inline Placement placement_over(const Motion& clip, const Motion& other) {
  const Index frames = std::min(clip.frames(), other.frames());
  double sine = 0, cosine = 0;
  for (Index f = 0; f < frames; ++f) {
    const double turn = turn_between(clip.rotations(f)[0], other.rotations(f)[0]);
    sine += std::sin(turn), cosine += std::cos(turn);
  }
  Placement p{std::atan2(sine, cosine), {}};
  Vec3<double> way{};
  for (Index f = 0; f < frames; ++f) way = way + other.root_at(f) - p(clip.root_at(f));
  p.shift = {way.x / static_cast<double>(frames), 0, way.z / static_cast<double>(frames)};
  return p;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<Motion> LatentMotionModel::between(const Timeline& from, const Timeline& to, Index count,
                                                               const GenerateOptions& options) const {
  check_options(*this, options);
  if (count < 2)
    raise<option_error>(101, counted(count, "motion"),
                        " from one text or action towards another; two or more are needed for both ends");
  auto motions = line(from, to, count, noise_of(options, 0), options.fact.value_or(1));
  for (Motion& m : motions) m = finish_motion(std::move(m), options);
  return motions;
}

MOTIONLANG_BODY Motion LatentMotionModel::denoised(const Motion& motion, const std::string& action) const {
  const Motion seen = resample(on_its_joints(motion), fps());
  const Index frames = seen.frames(), most = longest();
  const Index shared = std::min(std::max<Index>(2, most / 4), most - 1);
  const auto part = [&](Index first) { return decoded(crop(seen, first, std::min(frames, first + most)), action); };
  Motion out = part(0);
  for (Index end = most; end < frames;) {
    const Index first = std::min(end - shared, frames - most);
    Motion next = part(first);
    next.skeleton = out.skeleton;  // bones found from positions differ a little from part to part
    out = blend_into(out, next, out.frames() - first);
    end = first + most;
  }
  out = resample(placed(out, detail::placement_over(out, seen)), motion.fps);
  out.name = motion.name;
  return out;
}

MOTIONLANG_NAMESPACE_END
