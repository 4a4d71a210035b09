// SPDX-License-Identifier: MIT
// Bodies of kept_clip.hpp.
#pragma once

#include <algorithm>  // any_of, min_element
#include <cmath>      // hypot

#include <motionlang/compose/timeline.hpp>
#include <motionlang/generate/detail/kept_clip.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/root_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_steps(const GenerateOptions& options, Index steps) {
  if (options.steps.value_or(0) > steps)
    raise<option_error>(105, counted(*options.steps, "step is", "steps are"), " asked for, this model has ", steps);
}

MOTIONLANG_BODY void require_one_source(const GenerateOptions& o) {
  const bool noise = !o.noise.string().empty(), record = !o.record.string().empty(), reuse = !o.reuse.string().empty();
  if (o.keep && (noise || record || reuse)) raise<option_error>(102, "keep excludes noise, record and reuse");
  if (noise && (record || reuse)) raise<option_error>(102, "noise excludes record and reuse");
  if (o.mode != StmcMode::stmc && (o.keep || record || reuse || o.overlay_arms))
    raise<option_error>(102, "`mode` ", to_string(o.mode), " excludes `keep`, `record`, `reuse` and `overlay_arms`");
  if (o.keep_beyond && !reuse) raise<option_error>(102, "keep_beyond needs reuse");
  if (!o.before.empty()) require_no_list_files(o);
}

MOTIONLANG_BODY void require_no_list_files(const GenerateOptions& o) {
  const std::pair<const FilePath*, const char*> files[] = {
      {&o.noise, "`noise`"}, {&o.record, "`record`"}, {&o.reuse, "`reuse`"}};
  for (const auto& [file, name] : files) {
    if (file->string().empty()) continue;
    if (o.communicator.size() > 1)
      raise<option_error>(102, name, " is a file of all timelines, which one process makes, not ",
                          o.communicator.size());
    raise<option_error>(102, name, " is a file of all timelines; with `before`, these are only a part of them");
  }
}

MOTIONLANG_BODY std::vector<IndexRange> kept_frames(const KeptClip& keep, Index frames, Index wanted, double fps) {
  const Index common = std::min(frames, wanted);
  if (keep.seconds.empty()) return {{0, common}};
  std::vector<IndexRange> out;
  for (const auto& [from, to] : keep.seconds) {
    const IndexRange range{frame_at(from, fps), frame_at(to, fps)};
    if (range.begin < 0 || range.size() < 1 || range.end > common)
      raise<option_error>(101, "keep: ", from, "-", to, " is frames ", range.begin, ":", range.end, " at ", fps,
                          " per second; the motion to keep has ", frames, ", the timeline ", wanted);
    out.push_back(range);
  }
  return out;
}

MOTIONLANG_BODY Motion without_jumps(Motion motion, std::span<const IndexRange> kept, Index frames) {
  const auto is_kept = [&](Index f) {
    return std::any_of(kept.begin(), kept.end(), [f](const IndexRange& r) { return r.begin <= f && f < r.end; });
  };
  for (Index begin = 0, end = 0; begin < motion.frames(); begin = end) {
    for (end = begin + 1; end < motion.frames() && is_kept(end) == is_kept(begin);) ++end;
    if (is_kept(begin)) continue;
    const Index reach = std::min(frames, end - begin);
    if (begin > 0) motion = without_jump(motion, begin, begin + reach);
    if (end < motion.frames()) motion = without_jump(motion, end - 1, end - 1 - reach);
  }
  return motion;
}

MOTIONLANG_BODY Motion in_its_place(Motion motion, const Motion& other, Index clip_frames,
                                    const GenerateOptions& options) {
  const KeptClip& keep = *options.keep;
  const auto ranges = kept_frames(keep, clip_frames, motion.frames(), motion.fps);
  const Index overlap = frame_at(options.overlap, motion.fps);
  if (options.smooth) motion = without_jumps(std::move(motion), ranges, overlap);
  if (!keep.parts.has(BodyPart::legs)) return motion;
  Index first = ranges.front().begin;
  for (const IndexRange& r : ranges) first = std::min(first, r.begin);
  return placed(motion, placement_between(motion, first, other, first));
}

MOTIONLANG_BODY double farthest_from(const Motion& motion, const Motion& clip, Index clip_frames,
                                     const KeptClip& keep) {
  double out = 0;
  if (!keep.parts.has(BodyPart::legs)) return out;
  for (const IndexRange& r : kept_frames(keep, clip_frames, motion.frames(), motion.fps)) {
    for (Index f = r.begin; f < r.end; ++f) {
      const auto d = motion.root_at(f) - clip.root_at(f);
      out = std::max(out, std::hypot(d.x, d.z));
    }
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
