// SPDX-License-Identifier: MIT
// Bodies of described_motions.hpp.
#pragma once

#include <algorithm>  // find
#include <cmath>      // isfinite
#include <cstdio>     // seconds as %g
#include <iterator>   // back_inserter
#include <map>        // clips
#include <mutex>      // progress of several threads
#include <optional>   // motions that go on
#include <set>        // texts
#include <tuple>      // segments

#include <motionlang/core/parallel.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/datasets/action_recordings.hpp>
#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/datasets/clip_split.hpp>
#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/datasets/kit_recordings.hpp>
#include <motionlang/datasets/segment_motion.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/text/mirror_caption.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr Index fewest_rows = 4;

inline std::vector<float> made_rows(const RowMaker& maker, const Motion& motion) {
  const auto values = maker.rows(motion);
  return {values.begin(), values.end()};
}

/// The published ready-made features have clips with NaN, which cannot be used for training.
inline bool all_finite(std::span<const float> rows) {
  return std::all_of(rows.begin(), rows.end(), [](float x) { return std::isfinite(x); });
}

/// The key by which a line is split: an id if there are lists, else the clip, mirrored or not.
inline std::string split_key(const DataSources& sources, const std::string& id, const std::string& clip) {
  if (!sources.splits.empty()) return id;
  return clip.starts_with("M/") ? clip.substr(2) : clip;
}

// The reason for leaving something out.
inline constexpr const char* why_not_finite = "with numbers that are not finite";
inline constexpr const char* why_few_frames = "of too few frames";
inline std::string why_other_length(const DataConfig& c) {
  char text[100];
  std::snprintf(text, sizeof text, "shorter than %g s or longer than %g s", c.min_seconds, c.max_seconds);
  return text;
}

/// Keeps lines with one of the wanted labels; if all are wanted, lines with one label.
inline void keep_actions(std::vector<ClipLine>& lines, const std::vector<std::string>& actions, LeftOut& left_out) {
  for (ClipLine& line : lines) {
    std::erase_if(line.texts, [&](const std::string& label) {
      return !actions.empty() && std::find(actions.begin(), actions.end(), label) == actions.end();
    });
  }
  std::erase_if(lines, [&](const ClipLine& line) {
    if (line.texts.size() == 1) return false;
    left_out.add("without one of the labels, or with several", line.id);
    return true;
  });
}

/// False for features with values that are not finite. A missing clip is reported by its reader.
inline bool is_readable_clip(const ClipLine& line) {
  return file_kind(line.file) != ".npy" || all_finite(read_npy(line.file).to<float>());
}

/// Several lines with captions of one segment, such as those of different body parts, become one motion.
inline std::vector<ClipLine> one_per_segment(std::vector<ClipLine> lines) {
  std::vector<ClipLine> out;
  std::map<std::tuple<std::string, double, double>, std::size_t> place;
  for (ClipLine& line : lines) {
    const auto [known, is_new] = place.emplace(std::tuple(line.clip, line.start, line.end), out.size());
    if (is_new)
      out.push_back(std::move(line));
    else
      std::move(line.texts.begin(), line.texts.end(), std::back_inserter(out[known->second].texts));
  }
  return out;
}

/// "clip@start-end", which distinguishes segments of one clip; "clip" for the whole clip.
inline std::string segment_id(const ClipLine& line) {
  return std::isinf(line.end) ? line.id : concat_text(line.id, "@", line.start, "-", line.end);
}

/// The motion of a line whose table says how it goes on, half a second longer than the least that is wanted; none of
/// other lines.
inline std::optional<Motion> longer_motion(const DataSources& sources, const DataConfig& config, const RowMaker& maker,
                                           const ClipLine& line) {
  if (!line.repeat && !line.hold && line.then.empty()) return std::nullopt;
  const auto clip_of = [&](const ClipLine& of) { return resample(read_clip(sources.data, of), maker.fps); };
  const auto frames = static_cast<Index>((config.min_seconds + 0.5) * maker.fps);
  return lasting(segment_motion(line, clip_of, fewest_rows + 1), frames);
}

/// Clips of lines, each read once, on several threads.
inline void add_clip_lines(DescribedMotions& out, std::vector<ClipLine> lines, const DataSources& sources,
                           const DataConfig& config, const RowMaker& maker, Progress progress) {
  const bool labels = sources.labelled();
  if (labels) keep_actions(lines, config.actions, out.left_out);
  std::vector<std::string> clips, keys;
  std::map<std::string, std::vector<std::size_t>> lines_of;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines_of[lines[i].clip].empty()) clips.push_back(lines[i].clip);
    lines_of[lines[i].clip].push_back(i);
    keys.push_back(split_key(sources, lines[i].id, lines[i].clip));
  }
  const ClipSplit split(sources.splits, config, keys);
  std::vector<std::vector<DescribedMotion>> found(lines.size());
  std::vector<std::string> why(lines.size(), why_not_finite);  // the reason for leaving a line out
  std::mutex mutex;
  Index done = 0;
  parallel_for(std::ssize(clips), [&](Index c) {
    const auto& mine = lines_of.at(clips[static_cast<std::size_t>(c)]);
    const auto unused = [&](std::size_t i) { return split.of(keys[i]) < 0; };
    if (!std::all_of(mine.begin(), mine.end(), unused) && is_readable_clip(lines[mine.front()])) {
      const auto clip = resample(read_clip(sources.data, lines[mine.front()]), maker.fps);
      for (const std::size_t i : mine) {
        const int part = split.of(keys[i]);
        if (part < 0) continue;
        ClipLine& line = lines[i];
        const std::string id = segment_id(line);
        if (std::isinf(line.end)) line.end = clip.seconds();
        const auto longer = longer_motion(sources, config, maker, line);
        const double seconds = longer ? longer->seconds() : line.end - line.start;
        if (part < 2 && (seconds < config.min_seconds || seconds > config.max_seconds)) {
          why[i] = why_other_length(config);
          continue;
        }
        if (!sources.annotations.empty() && frames_of(clip, line).length <= fewest_rows) {
          why[i] = why_few_frames;
          continue;
        }
        const auto motion = longer ? *longer : segment_of(clip, line, fewest_rows + 1);
        auto add = [&](const Motion& m, bool mirrored) {
          DescribedMotion d{(mirrored ? "M" : "") + id, line.clip, made_rows(maker, m), {}};
          const Index frames = std::ssize(d.rows) / maker.width;
          for (const std::string& t : line.texts) d.texts.push_back({mirrored ? mirror_caption(t) : t, {0, frames}});
          found[i].push_back(std::move(d));
        };
        add(motion, false);
        if (config.mirror && part == 0 && !labels) add(mirror(motion), true);
      }
    }
    const std::lock_guard lock(mutex);
    progress(++done, std::ssize(clips));
  });
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int part = split.of(keys[i]);
    if (part < 0) continue;
    if (found[i].empty()) out.left_out.add(why[i], lines[i].id);
    for (DescribedMotion& d : found[i]) out.numbered_part(part).push_back(std::move(d));
  }
}

/// The form of ready-made rows.
inline const HumanMl3dForm& ready_made_form(const RowMaker& maker, const std::filesystem::path& where) {
  const DataSetForm* found = find_data_set_form(maker.name);
  if (found == nullptr)
    raise<config_error>(102, where.string(), " holds ready-made features, which are ", known_data_sets(),
                        "; the configuration wants '", maker.name, "' (", maker.width, ")");
  return found->form;
}

inline void add_humanml3d(DescribedMotions& out, const DataSources& sources, const RowMaker& maker, Progress progress) {
  const HumanMl3dForm& form = ready_made_form(maker, sources.data);
  const HumanMl3dFolder folder(sources.data, form);
  std::vector<std::pair<std::string, int>> ids;
  for (const int part : {0, 1, 2}) {
    const char* name = std::array{"train", "val", "test"}[static_cast<std::size_t>(part)];
    if (part != 0 && !std::filesystem::exists(sources.data / (name + std::string(".txt")))) continue;
    for (const std::string& id : folder.ids(name)) ids.emplace_back(id, part);
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    progress(static_cast<Index>(i), std::ssize(ids));
    const auto& [id, part] = ids[i];
    const auto rows = folder.features(id);
    const auto captions = folder.captions(id);
    if (!all_finite(rows)) {
      out.left_out.add(why_not_finite, id);
      continue;
    }
    Index number = 0;
    const auto items = humanml3d_items(captions, std::ssize(rows) / maker.width, form);
    if (items.empty()) out.left_out.add("without a caption of a length that is kept", id);
    for (const auto& item : items) {
      DescribedMotion d{concat_text(id, "_", number++), id, {}, {}};
      d.rows.assign(rows.begin() + item.frames.first * maker.width,
                    rows.begin() + (item.frames.first + item.frames.length) * maker.width);
      for (const std::size_t c : item.captions)
        d.texts.push_back({captions[c].text, {0, item.frames.length}, captions[c].words});
      out.numbered_part(part).push_back(std::move(d));
    }
  }
}

inline std::shared_ptr<const AnnotationFile> annotation_file(const DataSources& sources) {
  if (sources.opened) return sources.opened;
  return std::make_shared<const AnnotationFile>(AnnotationFile::open(sources.annotations));
}

/// Ready-made features of a motion of the annotation file, if there are any.
inline std::filesystem::path features_file(const DataSources& sources, const AnnotatedMotion& motion) {
  if (!detail::is_clip_id(motion.path))
    raise<io_error>(403, sources.annotations.string(), ": ", motion.id, ": '", motion.path,
                    "' is not a path of a clip");
  return sources.data / (motion.path + ".npy");
}
/// True for the features of STMC, whose data are of AMASS alone, with ready-made rows of its own program.
inline bool is_stmc(const RowMaker& maker) { return maker.name == "smplrifke"; }
/// The rows of a motion of the annotation file: features as they are, or a clip.
inline std::vector<float> annotated_rows(const DataSources& sources, ClipFolder& clips, const RowMaker& maker,
                                         const AnnotatedMotion& motion) {
  const auto npy = features_file(sources, motion);
  if (std::filesystem::exists(npy))
    return detail::read_rows(npy, {is_stmc(maker) ? maker.width : ready_made_form(maker, npy).width()},
                             /*any_number=*/true);
  ClipLine line{sources.annotations.string() + ": " + motion.id, motion.id, motion.path, 0, 0, {}, {}};
  clips.find(line);
  return made_rows(maker, resample(read_clip(sources.data, line), maker.fps));
}

inline void add_annotations(DescribedMotions& out, const DataSources& sources, const DataConfig& config,
                            const RowMaker& maker, Progress progress) {
  const auto opened = annotation_file(sources);
  const AnnotationFile& file = *opened;
  std::vector<std::string> keys;
  for (const std::string& id : file.ids())
    keys.push_back(split_key(sources, id, sources.splits.empty() ? file.load(id).path : id));
  const ClipSplit split(sources.splits, config, keys);
  ClipFolder clips(sources.data);
  for (std::size_t i = 0; i < file.ids().size(); ++i) {
    progress(static_cast<Index>(i), std::ssize(file.ids()));
    const std::string& id = file.ids()[i];
    const int part = split.of(keys[i]);
    if (part < 0) continue;
    const auto motion = file.load(id);
    const auto texts =
        training_annotations(motion, part == 2 ? "test" : "train", config.min_seconds, config.max_seconds);
    out.left_out.add(why_other_length(config), id, std::ssize(motion.annotations) - std::ssize(texts));
    if (texts.empty()) continue;
    if (is_stmc(maker) && motion.path.find("humanact12") != std::string::npos) {
      out.left_out.add("of HumanAct12, which has no poses of SMPL", id, std::ssize(texts));
      continue;
    }
    DescribedMotion d{id, motion.path, annotated_rows(sources, clips, maker, motion), {}};
    if (!all_finite(d.rows)) {
      out.left_out.add(why_not_finite, id, std::ssize(texts));
      continue;
    }
    for (const auto& a : texts) {
      const auto frames = annotated_frames(a, maker.fps, std::ssize(d.rows) / maker.width);
      if (frames.length >= fewest_rows)
        d.texts.push_back({a.text, frames});
      else
        out.left_out.add(why_few_frames, id);
    }
    if (!d.texts.empty()) out.numbered_part(part).push_back(std::move(d));
  }
}

/// The rows of a raw recording of KIT-ML: every 8th frame at 12.5 frames per second, as published.
inline std::vector<float> kit_rows(const KitRecording& recording, const RowMaker& maker) {
  std::vector<Vec3<double>> joints;
  for (const Index f : every_nth_frame(recording.frames(), KitRecording::fps, maker.fps)) {
    constexpr std::ptrdiff_t count = KitRecording::joint_count;
    const auto first = recording.joints.begin() + f * count;
    joints.insert(joints.end(), first, first + count);
  }
  const auto rows = rifke_features(temos_rifke(), std::span<const Vec3<double>>(joints)).features;
  return {rows.begin(), rows.end()};
}

/// Raw KIT-ML: its own positions as rifke64. Other features are those of its motions in AMASS, which a folder amass and
/// kitml_amass_path.json beside the recordings name.
inline void add_kit_recordings(DescribedMotions& out, const DataSources& sources, const DataConfig& config,
                               const RowMaker& maker, Progress progress) {
  const KitRecordings recordings(sources.data);
  const auto ids = recordings.ids();
  const ClipSplit split(sources.splits, config, ids);
  const auto list = sources.data / "kitml_amass_path.json", amass = sources.data / "amass";
  std::optional<KitAmassPaths> paths;
  if (maker.name != "rifke64") {
    if (!std::filesystem::exists(list) || !std::filesystem::exists(amass))
      raise<config_error>(102, sources.data.string(), " has positions of MMM's joints, which become rifke64. For '",
                          maker.name, "' it needs ", list.string(), " of TEMOS, and AMASS as ", amass.string());
    paths.emplace(FilePath(list));
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    progress(static_cast<Index>(i) + 1, std::ssize(ids));
    const std::string& id = ids[i];
    const int part = split.of(id);
    if (part < 0) continue;
    const auto texts = recordings.annotations(id);
    if (texts.empty()) {
      out.left_out.add("without a text", id);
      continue;
    }
    DescribedMotion d{id, id, {}, {}};
    double seconds = 0;
    if (paths) {
      const auto file = paths->file(id, amass);
      if (file.empty()) {
        out.left_out.add(paths->has(id) ? "without a file in AMASS" : "that the list of AMASS lacks", id);
        continue;
      }
      const Motion motion = on_smpl(read_amass(file).motion);
      seconds = motion.seconds();
      d.rows = made_rows(maker, resample(motion, maker.fps));
    } else {
      constexpr Index step = 8;  // lengths count at 12.5 frames per second, whatever the rate of the rows
      const KitRecording recording = recordings.load(id);
      const Index steps = (recording.frames() + step - 1) / step;
      seconds = static_cast<double>(steps * step) / KitRecording::fps;
      if (recording.frames() > fewest_rows * step) d.rows = kit_rows(recording, maker);
    }
    const Index frames = std::ssize(d.rows) / maker.width;
    if (part < 2 && (seconds < config.min_seconds || seconds > config.max_seconds)) {
      out.left_out.add(why_other_length(config), id);
      continue;
    }
    if (frames < fewest_rows) {
      out.left_out.add(why_few_frames, id);
      continue;
    }
    for (const std::string& text : texts) d.texts.push_back({text, {0, frames}});
    out.numbered_part(part).push_back(std::move(d));
  }
}

/// Motions keep their frames, whatever their rate was. Lengths are for training only, as published.
inline void add_action_recordings(DescribedMotions& out, const std::string& dataset, const std::filesystem::path& data,
                                  const DataConfig& config, const RowMaker& maker, Progress progress) {
  const auto use = [&](const ActionRecording& r) {
    if (!config.actions.empty() &&
        std::find(config.actions.begin(), config.actions.end(), r.action) == config.actions.end()) {
      out.left_out.add("of other actions", r.id);
      return;
    }
    DescribedMotion d{r.id, r.id, made_rows(maker, r.motion), {}};
    d.texts.push_back({r.action, {0, r.motion.frames()}});
    const double seconds = r.motion.seconds();
    const bool fits = seconds >= config.min_seconds && seconds <= config.max_seconds;
    if (r.training && !fits) out.left_out.add(why_other_length(config), r.id);
    if (r.test) out.test.push_back(d);
    if (r.training && fits) out.training.push_back(std::move(d));
  };
  out.left_out.add(read_action_recordings(dataset, data.string(), maker.fps, use, progress));
}

}  // namespace detail

MOTIONLANG_BODY RowMaker row_maker(const std::string& features) {
  const MotionFeatures& f = motion_features(features);
  return {std::string(f.name), f.width, f.fps, f.from_motion};
}

MOTIONLANG_BODY const std::vector<DescribedMotion>& DescribedMotions::part(const std::string& name) const {
  if (name == "training") return training;
  if (name == "validation") return validation;
  if (name == "test") return test;
  raise<config_error>(103, "'", name, "' is not training, validation or test");
}

MOTIONLANG_BODY void DataSources::require_sound() const {
  if (!captions.empty() && !(annotations.empty() && labels.empty()))
    raise<config_error>(102, "one of `captions`, `labels` and `annotations`, not several");
}

MOTIONLANG_BODY std::string ready_made_features(DataSources& sources) {
  if (sources.data.empty() || !sources.captions.empty() || !sources.labels.empty()) return "";
  std::filesystem::path first;
  if (!sources.annotations.empty()) {
    sources.opened = detail::annotation_file(sources);
    const AnnotationFile& file = *sources.opened;
    for (std::size_t i = 0; i < file.ids().size() && first.empty(); ++i) {
      const auto npy = detail::features_file(sources, file.load(file.ids()[i]));
      if (std::filesystem::exists(npy)) first = npy;
    }
  } else if (is_data_set(sources.data)) {
    const auto ids = HumanMl3dFolder(sources.data).ids("train");
    if (!ids.empty()) first = rows_file(sources.data, ids.front());
  }
  return first.empty() ? "" : std::string(data_set_form_of(first).features);
}

MOTIONLANG_BODY DescribedMotions read_described_motions(const DataSources& sources, const DataConfig& config,
                                                        const RowMaker& rows, Progress progress) {
  DescribedMotions out{rows.width, rows.fps, {}, {}, {}};
  const bool captions = !sources.captions.empty(), annotations = !sources.annotations.empty();
  sources.require_sound();
  const bool own_labels = sources.actions && !annotations && sources.labels.empty();
  const std::string dataset = own_labels ? action_data_set(sources.data) : "";
  if (own_labels && dataset.empty())
    raise<config_error>(102,
                        "actions need labels: `labels` names a table of them, `annotations` a file that has some; or "
                        "`data` has the files of HumanAct12, UESTC or NTU-13");
  if (!dataset.empty() && !sources.splits.empty())
    raise<config_error>(102, sources.data.string(), ": ", dataset, " has parts of its own: no `splits` with it");
  if (!config.actions.empty() && !sources.labelled())
    raise<config_error>(102, "data.actions selects labels, but this training learns texts");
  DataSources listed = sources;  // a data set has its own lists
  if (listed.splits.empty() && is_data_set(sources.data) && std::filesystem::exists(sources.data / "train.txt"))
    listed.splits = sources.data;
  if (!dataset.empty())
    detail::add_action_recordings(out, dataset, sources.data, config, rows, progress);
  else if (captions)
    detail::add_clip_lines(out, detail::one_per_segment(read_captions(sources.captions, sources.data)), listed, config,
                           rows, progress);
  else if (annotations && sources.labelled())
    detail::add_clip_lines(out, read_labelled_annotations(sources.annotations, sources.data, sources.labels), sources,
                           config, rows, progress);
  else if (!sources.labels.empty())
    detail::add_clip_lines(out, read_labels(sources.labels, sources.data), listed, config, rows, progress);
  else if (annotations)
    detail::add_annotations(out, sources, config, rows, progress);
  else if (is_data_set(sources.data))
    detail::add_humanml3d(out, sources, rows, progress);
  else if (is_kit_recordings(sources.data))
    detail::add_kit_recordings(out, sources, config, rows, progress);
  else
    raise<config_error>(
        102, sources.data.string(),
        " has no new_joint_vecs and no _meta.json; clips need a table of captions or labels, or an annotation file");
  if (out.training.empty())
    raise<io_error>(403, sources.data.string(), ": nothing to train on (", out.left_out.text(), ")");
  return out;
}

MOTIONLANG_BODY std::vector<std::string> all_texts(const DescribedMotions& data) {
  std::set<std::string> texts;
  for (const auto* part : data.parts()) {
    for (const DescribedMotion& m : *part) {
      for (const DescribedText& t : m.texts) texts.insert(t.text);
    }
  }
  return {texts.begin(), texts.end()};
}

MOTIONLANG_NAMESPACE_END
