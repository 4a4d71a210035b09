// SPDX-License-Identifier: MIT
// Bodies of shared_motions.hpp.
#pragma once

#include <algorithm>  // max
#include <cstdint>    // sizes of lists
#include <utility>    // move

#include <motionlang/generate/detail/kept_clip.hpp>
#include <motionlang/generate/shared_motions.hpp>
#include <motionlang/train/shared_progress.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Frames of all texts.
inline Index work_of(std::span<const Timeline> timelines) {
  Index out = 0;
  for (const Timeline& t : timelines) {
    for (const Interval& i : t.intervals) out += std::max<Index>(1, i.end - i.start);
  }
  return out;
}

/// All that decides the bits of the motions, apart from the model.
inline std::string shared_input(std::span<const Timeline> timelines, const GenerateOptions& o) {
  MessageWriter out;
  const auto optional = [&](const auto& v) {
    out.value(v.has_value());
    if (v) out.value(*v);
  };
  out.text(kernels_in_use());
  out.value(o.seed), out.value(o.mode), out.value(o.overlap);
  for (const bool b : {o.cut_texts, o.smooth, o.fix_feet, o.fix_floor, o.overlay_arms}) out.value(b);
  optional(o.steps), optional(o.sampler), optional(o.noise_scale), optional(o.guidance), optional(o.recall);
  optional(o.fact);
  out.value(o.keep.has_value());
  if (o.keep) {
    put_motion(out, o.keep->motion);
    out.value(o.keep->parts.bits), out.value(std::uint64_t{o.keep->seconds.size()});
    for (const auto& [from, to] : o.keep->seconds) out.value(from), out.value(to);
  }
  for (const std::span<const Timeline> list : {o.before, timelines}) {
    out.value(std::uint64_t{list.size()});
    for (const Timeline& t : list) {
      out.text(to_string(t.body)), out.value(std::uint64_t{t.intervals.size()});
      for (const Interval& i : t.intervals)
        out.text(i.text), out.value(i.start), out.value(i.end), out.value(i.parts.bits);
    }
  }
  return out.bytes();
}

}  // namespace detail

MOTIONLANG_BODY std::vector<Index> parts_of_timelines(std::span<const Timeline> timelines, Index ranks) {
  const Index all = detail::work_of(timelines);
  std::vector<Index> out{0};
  Index next = 0, before = 0;  // timelines, and their work
  for (Index r = 1; r < ranks; ++r) {
    while (next < std::ssize(timelines)) {
      const Index own = detail::work_of(timelines.subspan(static_cast<std::size_t>(next), 1));
      if (2 * before + own > 2 * all * r / ranks) break;  // more than half of it would be beyond the share
      before += own, ++next;
    }
    out.push_back(next);
  }
  out.push_back(std::ssize(timelines));
  return out;
}

MOTIONLANG_BODY void put_motion(MessageWriter& out, const Motion& m) {
  out.text(m.name), out.value(m.fps);
  out.value(std::uint64_t{m.skeleton.names.size()});
  for (const std::string& name : m.skeleton.names) out.text(name);
  out.list(std::span<const int>(m.skeleton.parents));
  out.list(std::span<const Vec3<double>>(m.skeleton.offsets)), out.list(std::span<const Vec3<double>>(m.skeleton.ends));
  out.list(std::span<const Vec3<double>>(m.root)), out.list(std::span<const Quaternion<double>>(m.local));
}
MOTIONLANG_BODY Motion take_motion(MessageReader& in) {
  Motion m;
  m.name = in.text(), m.fps = in.value<double>();
  for (auto joints = in.value<std::uint64_t>(); joints > 0; --joints) m.skeleton.names.push_back(in.text());
  m.skeleton.parents = in.list<int>();
  m.skeleton.offsets = in.list<Vec3<double>>(), m.skeleton.ends = in.list<Vec3<double>>();
  m.root = in.list<Vec3<double>>(), m.local = in.list<Quaternion<double>>();
  return m;
}

MOTIONLANG_BODY std::vector<Motion> shared_motions(std::span<const Timeline> timelines, const GenerateOptions& options,
                                                   const MotionMaker& make, const std::function<void()>& check) {
  const AnyCommunicator& all = options.communicator;
  detail::require_no_list_files(options);
  if (const Index other = first_other_text(all, detail::shared_input(timelines, options)); other > 0)
    raise<config_error>(102, "rank ", other, " of ", all.size(),
                        " has other timelines, options or kernels than rank 0, so that motions would differ from those "
                        "of one process");
  if (check) check();
  const std::vector<Index> begins = parts_of_timelines(timelines, all.size());
  const auto part_of = [&](Index rank) {
    const auto r = static_cast<std::size_t>(rank);
    return timelines.subspan(static_cast<std::size_t>(begins[r]), static_cast<std::size_t>(begins[r + 1] - begins[r]));
  };
  std::vector<Index> work;
  for (Index r = 0; r < all.size(); ++r) work.push_back(detail::work_of(part_of(r)));
  SharedProgress progress(all, work, options.progress);

  const std::span<const Timeline> own = part_of(all.rank());
  std::vector<Timeline> before(options.before.begin(), options.before.end());
  before.insert(before.end(), timelines.data(), own.data());
  GenerateNotes notes;
  GenerateOptions how = options;
  how.communicator = AnyCommunicator();
  how.before = before;
  how.progress = progress;
  how.notes = options.notes == nullptr ? nullptr : &notes;
  std::vector<Motion> motions;
  if (!own.empty() || timelines.empty()) motions = make(own, how);
  progress.finish();

  MessageWriter mine;
  mine.value(std::uint64_t{motions.size()});
  for (const Motion& m : motions) put_motion(mine, m);
  mine.text(notes.layout), mine.value(notes.kept_moved);
  mine.value(std::uint64_t{notes.features.size()});
  for (const auto& rows : notes.features) mine.list(std::span<const double>(rows));
  motions.clear();
  notes = {};
  for (const std::string& message : messages_of_all(all, mine.bytes())) {
    MessageReader in(message);
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) motions.push_back(take_motion(in));
    if (std::string layout = in.text(); !layout.empty()) notes.layout = std::move(layout);
    notes.kept_moved = std::max(notes.kept_moved, in.value<double>());
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) notes.features.push_back(in.list<double>());
  }
  if (options.notes != nullptr) *options.notes = std::move(notes);
  return motions;
}

MOTIONLANG_NAMESPACE_END
