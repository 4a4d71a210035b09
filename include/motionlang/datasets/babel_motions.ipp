// SPDX-License-Identifier: MIT
// Bodies of babel_motions.hpp.
#pragma once

#include <algorithm>  // find
#include <map>        // spellings
#include <mutex>      // progress of several threads

#include <motionlang/core/parallel.hpp>
#include <motionlang/datasets/amass_releases.hpp>
#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/datasets/clip_split.hpp>
#include <motionlang/datasets/simultaneous_segments.hpp>
#include <motionlang/datasets/teach_pairs.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr double least_seconds = 0.5;  // of a sequence

/// Converts to the rate of both systems, with original frames of the clip; `fps`: its own rate.
inline Motion at_babel_rate(const Motion& clip, double fps) {
  Motion out{clip.skeleton, babel_fps, {}, {}, clip.name};
  for (const Index f : spread_frames(clip.frames(), fps, babel_fps)) {
    const auto pose = clip.rotations(f);
    out.root.push_back(clip.root_at(f));
    out.local.insert(out.local.end(), pose.begin(), pose.end());
  }
  return out;
}

/// A sequence, with its part (training, validation, test).
struct BabelEntry {
  BabelSequence sequence;
  ClipLine clip;  // the whole clip
  int part = 0;
};
inline void add_babel_entries(std::vector<BabelEntry>& out, const BabelSources& sources,
                              const std::filesystem::path& path, int part) {
  const auto members = JsonMembers::open(path);
  const BabelFile file(members);
  ClipFolder clips(sources.data);
  for (const std::string& id : file.ids()) {
    const std::string place = members.place(id);
    BabelEntry e{file.load(id), {place, id, "", 0, 0, {}, {}}, part};
    e.clip.clip = babel_clip(clips, e.sequence.feat_p, place);
    if (!detail::is_clip_id(e.clip.clip)) raise<io_error>(403, place, ": '", e.clip.clip, "' is not a path of a clip");
    clips.find(e.clip);
    out.push_back(std::move(e));
  }
}
inline std::vector<BabelEntry> babel_entries(const BabelSources& sources, const DataConfig& shares) {
  std::vector<BabelEntry> out;
  add_babel_entries(out, sources, sources.babel, 0);
  if (!sources.validation.empty()) {
    add_babel_entries(out, sources, sources.validation, 1);
    return out;
  }
  const auto key = [&](const BabelEntry& e) { return sources.splits.empty() ? e.clip.clip : e.sequence.id; };
  std::vector<std::string> keys;
  keys.reserve(out.size());
  for (const BabelEntry& e : out) keys.push_back(key(e));
  const ClipSplit split(sources.splits, shares, std::move(keys));
  for (BabelEntry& e : out) e.part = split.of(key(e));
  std::erase_if(out, [](const BabelEntry& e) { return e.part < 0; });
  return out;
}

MOTIONLANG_BODY SpellingTable read_spelling(const std::filesystem::path& path) {
  if (path.empty()) return {};
  const auto document = read_json(path);
  const auto words = JsonView(document, path.string()).as<std::map<std::string, std::string>>();
  return {words.begin(), words.end()};
}

/// Collects the chosen items. They are counted as the published programs number their keys: before any is left out.
class NumberedItems {
 public:
  /// why_not: a description of the items that are not chosen.
  NumberedItems(BabelItems& out, const std::string& type, const std::string& id,
                std::string why_not = "too short or too long")
      : out_(&out), prefix_(type + "-" + id + "-"), why_not_(std::move(why_not)) {}

  void add(bool taken, FrameSlice frames, std::vector<DescribedText> texts) {
    const std::string key = prefix_ + std::to_string(number_++);
    if (taken)
      out_->items.push_back({key, frames, std::move(texts)});
    else
      out_->left_out.add(why_not_, key);
  }

 private:
  BabelItems* out_;
  std::string prefix_, why_not_;
  Index number_ = 0;
};

/// The stretches of all annotators.
template <class F>
void for_each_annotation(const BabelSequence& s, Index frames, const SpellingTable& spelling, F f) {
  for (const BabelAnnotation& a : s.frame_annotations) f(babel_intervals(a.labels, babel_fps, frames, spelling));
}

/// The pairs of all annotators: f(texts, frames).
template <class F>
void for_each_pair(const BabelSequence& s, Index frames, const SpellingTable& spelling, F f) {
  for_each_annotation(s, frames, spelling, [&](const std::vector<BabelSegment>& segments) {
    for (const ActionPair& pair : teach_pairs(segments)) f(pair, pair.frames());
  });
}

}  // namespace detail

MOTIONLANG_BODY void BabelSources::require_sound() const {
  if (babel.empty()) raise<config_error>(102, "`babel` is required");
  if (!validation.empty() && !splits.empty()) raise<config_error>(102, "`validation` or `splits`, not both");
}

MOTIONLANG_BODY BabelReader sinc_reader(const SincDataConfig& config) {
  std::vector<std::string> types;
  for (std::size_t at = 0; at <= config.types.size();) {
    const std::size_t end = std::min(config.types.find('+', at), config.types.size());
    types.push_back(config.types.substr(at, end - at));
    at = end + 1;
    const std::string& type = types.back();
    if (type != "seg" && type != "seq" && type != "spatial_pairs" && type != "separate_pairs")
      raise<config_error>(103, "data.types: '", type, "' is not seg, seq, spatial_pairs or separate_pairs");
  }
  return [config, types](const BabelSequence& s, Index frames, const SpellingTable& spelling, bool training) {
    const SincWindow window{
        .request = training ? config.window : 0, .shortest = config.shortest, .longest = config.longest};
    BabelItems out;
    for (const std::string& type : types) {
      detail::NumberedItems numbered(out, type, s.id);
      const auto add = [&](Index first, Index last, const std::vector<std::string>& labels) {
        std::vector<DescribedText> texts;
        texts.reserve(labels.size());
        for (const std::string& label : labels) texts.push_back({label, {0, last - first}});
        numbered.add(window.accepts(last - first), {first, last - first}, std::move(texts));
      };
      if (type == "seq") {
        if (!s.frame_annotations.empty() || s.sequence_annotations.empty()) continue;
        const auto& labels = s.sequence_annotations.front().labels;
        const std::string label = labels.empty() ? "" : clean_babel_label(labels.front().proc_label, spelling);
        if (!label.empty()) add(0, frames, {label});
      } else if (type == "separate_pairs") {
        detail::for_each_pair(s, frames, spelling, [&](const ActionPair& pair, const PairFrames& f) {
          if (f.all().size() > 0) add(f.all().start, f.all().end, {pair.first.text, pair.second.text});
        });
      } else {
        detail::for_each_annotation(s, frames, spelling, [&](std::vector<BabelSegment> all) {
          const auto segments = sinc_segments(std::move(all));
          if (type == "seg") {
            for (const BabelSegment& g : segments) {
              if (!g.text.empty()) add(g.start, g.end, {g.text});
            }
            return;
          }
          for (const SimultaneousSegment& g : simultaneous_segments(segments, config.simultaneous_max)) {
            if (std::find(g.texts.begin(), g.texts.end(), "") == g.texts.end()) add(g.start, g.end, g.texts);
          }
        });
      }
    }
    return out;
  };
}

MOTIONLANG_BODY BabelReader teach_reader(const TeachDataConfig& config) {
  return [config](const BabelSequence& s, Index frames, const SpellingTable& spelling, bool training) {
    const TeachLengths lengths{config.shortest, training ? config.longest : std::max<Index>(config.longest, 100'000)};
    BabelItems out;
    detail::NumberedItems numbered(out, "separate_pairs", s.id,
                                   "too short, too long, without words or beyond the clip");
    detail::for_each_pair(s, frames, spelling, [&](const ActionPair& pair, const PairFrames& f) {
      const Index first = f.first.start;
      const bool sound = f.second.size() > 0 && f.second.end <= frames && is_teach_length(f, lengths) &&
                         !pair.first.text.empty() && !pair.second.text.empty();
      numbered.add(
          sound, {first, f.all().size()},
          {{pair.first.text, {0, f.first.size()}}, {pair.second.text, {f.second.start - first, f.second.size()}}});
    });
    return out;
  };
}

MOTIONLANG_BODY DescribedMotions read_babel_motions(const BabelSources& sources, const std::string& features,
                                                    const DataConfig& shares, const BabelReader& reader,
                                                    Progress progress) {
  const MotionFeatures& maker = motion_features(features);
  const auto spelling = detail::read_spelling(sources.spelling);
  const auto entries = detail::babel_entries(sources, shares);
  DescribedMotions out{maker.width, babel_fps, {}, {}, {}};
  std::vector<std::vector<DescribedMotion>> found(entries.size());
  std::vector<LeftOut> left_out(entries.size());
  std::mutex mutex;
  Index done = 0;
  parallel_for(std::ssize(entries), [&](Index i) {
    const detail::BabelEntry& e = entries[static_cast<std::size_t>(i)];
    const auto clip = read_clip(sources.data, e.clip);
    const auto motion = detail::at_babel_rate(clip, corrected_amass_fps(e.clip.clip, clip.fps));
    BabelItems items;
    if (clip.seconds() >= detail::least_seconds) items = reader(e.sequence, motion.frames(), spelling, e.part == 0);
    for (BabelItem& item : items.items) {
      const auto rows = maker.from_motion(crop(motion, item.frames.first, item.frames.first + item.frames.length));
      found[static_cast<std::size_t>(i)].push_back(
          {item.key, e.clip.clip, {rows.begin(), rows.end()}, std::move(item.texts)});
    }
    left_out[static_cast<std::size_t>(i)] = std::move(items.left_out);
    const std::lock_guard lock(mutex);
    progress(++done, std::ssize(entries));
  });
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for (DescribedMotion& m : found[i]) out.numbered_part(entries[i].part).push_back(std::move(m));
    out.left_out.add(left_out[i]);
  }
  if (out.training.empty())
    raise<io_error>(403, sources.babel.string(), ": nothing to train on (", out.left_out.text(), ")");
  return out;
}

MOTIONLANG_BODY std::vector<DescribedMotion> read_babel_sequences(const BabelSources& sources, const RowMaker& maker,
                                                                  const DataConfig& shares, int part,
                                                                  Progress progress) {
  const auto spelling = detail::read_spelling(sources.spelling);
  const auto entries = detail::babel_entries(sources, shares);
  std::vector<DescribedMotion> found(entries.size());
  std::mutex mutex;
  Index done = 0;
  parallel_for(std::ssize(entries), [&](Index i) {
    const detail::BabelEntry& e = entries[static_cast<std::size_t>(i)];
    if ((part < 0 || e.part == part) && !e.sequence.frame_annotations.empty()) {
      auto clip = read_clip(sources.data, e.clip);
      clip.fps = corrected_amass_fps(e.clip.clip, clip.fps);
      DescribedMotion& m = found[static_cast<std::size_t>(i)];
      if (clip.seconds() >= detail::least_seconds) {
        const auto rows = maker.rows(resample(clip, maker.fps));
        m = {e.sequence.id, e.clip.clip, {rows.begin(), rows.end()}, {}};
      }
      const Index frames = std::ssize(m.rows) / maker.width;
      for (const BabelAnnotation& a : e.sequence.frame_annotations) {
        for (const BabelSegment& s : babel_segments(a.labels, maker.fps, frames, spelling))
          m.texts.push_back({s.text, {s.start, s.end - s.start}});
      }
    }
    const std::lock_guard lock(mutex);
    progress(++done, std::ssize(entries));
  });
  std::erase_if(found, [](const DescribedMotion& m) { return m.texts.empty(); });
  if (found.empty()) raise<io_error>(403, sources.babel.string(), ": no sequence with segments");
  return found;
}

MOTIONLANG_NAMESPACE_END
