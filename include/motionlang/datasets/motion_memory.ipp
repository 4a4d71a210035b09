// SPDX-License-Identifier: MIT
// Bodies of motion_memory.hpp.
#pragma once

#include <algorithm>  // clamp, lower_bound, sort
#include <array>      // checksums
#include <numbers>    // pi
#include <set>        // captions
#include <utility>    // move

#include <motionlang/datasets/motion_memory.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY MotionMemory::MotionMemory(KnownCaptions captions, std::vector<Motion> motions,
                                           std::vector<RememberedMotion> of, std::string_view source)
    : captions_(std::move(captions)), motions_(std::move(motions)), of_(std::move(of)) {
  const Index joints = smpl24_skeleton().size(), texts = std::ssize(captions_.actions());
  for (const Motion& m : motions_) {
    const Index place = &m - motions_.data();
    m.validate();
    if (m.frames() == 0) raise<shape_error>(203, source, ": motion ", place, " has no frame");
    if (m.skeleton.size() != joints)
      raise<config_error>(102, source, ": motion ", place, " has ", counted(m.skeleton.size(), "joint"), ", not ",
                          joints);
    if (m.skeleton.names != smpl24_skeleton().names || m.skeleton.parents != smpl24_skeleton().parents)
      raise<config_error>(102, source, ": motion ", place, " has other joints than SMPL");
    if (m.fps != motions_.front().fps)
      raise<config_error>(102, source, ": motion ", place, " has ", m.fps, " frames per second, the first one ",
                          motions_.front().fps);
  }
  for (const RememberedMotion& r : of_) {
    if (r.caption < 0 || r.caption >= texts)
      raise<shape_error>(203, source, ": caption ", r.caption, " of ", counted(texts, "caption"), " has a motion");
    if (r.motion < 0 || r.motion >= std::ssize(motions_))
      raise<shape_error>(203, source, ": caption ", r.caption, " has motion ", r.motion, " of ", motions_.size());
  }
  const auto before = [](const RememberedMotion& a, const RememberedMotion& b) {
    return std::pair(a.caption, a.motion) < std::pair(b.caption, b.motion);
  };
  std::sort(of_.begin(), of_.end(), before);
}

namespace detail {

/// The whole motion in `frames` frames, at most 1.5 times as fast, and not slower than `slowest`; then its last pose.
inline Motion played_once(const Motion& motion, Index frames, double slowest) {
  constexpr double fastest = 1.5;
  const Index own = motion.frames();
  const double speed = frames < 2 || own < 2 ? 1.0 : static_cast<double>(own - 1) / static_cast<double>(frames - 1);
  // A little slower, so that rounding does not lose the last frame.
  const Motion played = speed == 1 ? motion : change_speed(motion, std::clamp(speed, slowest, fastest) * (1 - 1e-9));
  Motion out = crop(played, 0, std::min(frames, played.frames()));
  const Index last = out.frames() - 1;
  const std::vector<Quaternion<double>> pose(out.rotations(last).begin(), out.rotations(last).end());
  while (out.frames() < frames) {
    out.root.push_back(out.root_at(last));
    out.local.insert(out.local.end(), pose.begin(), pose.end());
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY Motion played_in(const Motion& motion, Index frames, PlayedAgain again) {
  const Index own = motion.frames();
  if (own < 1 || frames < 1)
    raise<shape_error>(203, "played_in: ", counted(own, "frame"), " to be played in ", counted(frames, "frame"));
  constexpr Index blended = 4;
  const double slowest = again == PlayedAgain::no ? 1 : 2.0 / 3;
  Motion out;
  if (again == PlayedAgain::as_it_is && own > 1) {
    const Index shared = std::min(blended, own / 2);
    for (out = motion; out.frames() < frames;)
      out = shared == 0 ? concatenate(out, motion) : blend_into(out, motion, shared);
    return crop(out, 0, frames);
  }
  const Index times = again == PlayedAgain::to_fit ? std::max<Index>(1, (frames + own / 2) / own) : 1;
  const Index shared = times == 1 ? 0 : std::min({blended, own, frames / times});  // frames of two rounds
  const Index all = frames + shared * (times - 1);
  for (Index k = 0; k < times; ++k) {
    Motion round = detail::played_once(motion, all * (k + 1) / times - all * k / times, slowest);
    out = k == 0 ? std::move(round) : shared == 0 ? concatenate(out, round) : blend_into(out, round, shared);
  }
  return out;
}

MOTIONLANG_BODY bool comes_back(const Motion& motion) {
  constexpr double near = std::numbers::pi / 6;
  if (motion.frames() == 0) return true;
  const auto first = motion.rotations(0), last = motion.rotations(motion.frames() - 1);
  for (std::size_t j = 0; j < first.size(); ++j) {
    if (distance(first[j], last[j]) > near) return false;
  }
  return true;
}

MOTIONLANG_BODY std::optional<Motion> MotionMemory::motion(const std::string& text, Index frames, double choice) const {
  if (of_.empty() || frames < 2) return std::nullopt;
  constexpr Index asked = 8;
  const auto before = [](const RememberedMotion& r, Index caption) { return r.caption < caption; };
  for (const NearCaption& near : captions_.meant(text, asked)) {
    const auto first = std::lower_bound(of_.begin(), of_.end(), near.row, before);
    const auto last = std::lower_bound(first, of_.end(), near.row + 1, before);
    if (first == last) continue;
    const auto count = static_cast<double>(last - first);
    const double place = std::clamp(choice >= 0 ? choice * count : 0.0, 0.0, count - 1);  // NaN is 0
    const auto which = static_cast<Index>(place);
    const Motion& motion = motions_[static_cast<std::size_t>((first + which)->motion)];
    const bool goes_on = captions_.actions()[static_cast<std::size_t>(near.row)].repeats;
    const PlayedAgain again = goes_on              ? PlayedAgain::as_it_is
                              : comes_back(motion) ? PlayedAgain::to_fit
                                                   : PlayedAgain::no;
    return played_in(near.mirrored ? mirror(motion) : motion, frames, again);
  }
  return std::nullopt;
}

MOTIONLANG_BODY Index MotionMemory::captions_with_motions() const {
  std::set<Index> rows;
  for (const RememberedMotion& r : of_) rows.insert(r.caption);
  return std::ssize(rows);
}

MOTIONLANG_BODY std::vector<double> MotionMemory::features(const std::string& text, Index frames, double choice) const {
  const auto found = motion(text, frames, choice);
  return found ? smplrifke_from_motion(*found) : std::vector<double>();
}

MOTIONLANG_BODY std::string MotionMemory::fingerprint() const {
  std::uint64_t hash = 0;
  const auto add = [&](const auto& list) { hash = detail::content_hash(std::as_bytes(std::span(list)), hash); };
  // The motion of a text also depends on the captions without one, which may be nearer, and on what goes on.
  add(captions_.table().codes()), add(captions_.table().mean()), add(std::array{captions_.nearness()});
  for (const std::string& text : captions_.table().texts()) add(text);
  for (const KnownAction& action : captions_.actions()) add(std::array{action.repeats});
  for (const Motion& m : motions_) add(m.root), add(m.local);
  for (const RememberedMotion& r : of_) add(std::array{r.caption, r.motion});
  return detail::hexadecimal(hash);
}

MOTIONLANG_NAMESPACE_END
