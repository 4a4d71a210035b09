// SPDX-License-Identifier: MIT
// Bodies of clip_lines.hpp.
#pragma once

#include <algorithm>  // clamp, sort
#include <limits>     // the end of a clip
#include <map>        // labels
#include <optional>   // a table

#include <motionlang/compose/detail/seconds_text.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/amass_releases.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/babel.hpp>
#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/amc.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/formats/motion_npy.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::vector<std::string> split_fields(std::string_view line, std::string_view separator) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    std::string_view field = line.substr(at, end - at);
    while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
    while (!field.empty() && (field.back() == ' ' || field.back() == '\r')) field.remove_suffix(1);
    out.emplace_back(field);
    at = end + separator.size();
  }
  return out;
}

[[noreturn]] MOTIONLANG_BODY void raise_clip_line(const ClipLine& line, const std::string& what) {
  raise<io_error>(403, line.place, ": ", what);
}

/// The lines of a table; read(line, fields) receives the columns of a row, and true if it has the expected number.
template <class Read>
std::vector<ClipLine> read_table(const std::filesystem::path& path, const char* expected, Read read) {
  std::vector<ClipLine> lines;
  const std::string text = read_file(path);
  detail::for_each_line(text, [&](std::string_view row, Index number) {
    const auto fields = split_fields(row, "\t");
    if (fields[0].starts_with('#') || (fields.size() == 1 && fields[0].empty())) return;
    ClipLine line{concat_text(path.string(), ":", number), fields[0], fields[0], 0, 0, {}, {}};
    if (!read(line, fields))
      raise_clip_line(line, concat_text("expected ", expected, ", separated by tabs; columns here: ", fields.size()));
    for (const std::string& t : line.texts) {
      if (t.empty()) raise_clip_line(line, "an empty text");
    }
    lines.push_back(std::move(line));
  });
  if (lines.empty()) raise<io_error>(403, path.string(), ": no line with ", expected);
  return lines;
}

/// The end of a row with two columns, which covers the whole clip.
inline constexpr double to_the_end = std::numeric_limits<double>::infinity();

inline std::vector<ClipLine> with_clip_files(std::vector<ClipLine> lines, const std::filesystem::path& data) {
  ClipFolder clips(data);
  for (ClipLine& line : lines) clips.find(line);
  return lines;
}

/// Columns 1 and 2 of a row.
inline void read_clip_times(ClipLine& line, const std::vector<std::string>& fields) {
  const auto seconds = [&](const std::string& field) {
    const auto value = detail::parse_seconds(field);
    if (!value) raise_clip_line(line, "'" + field + "' is not a time");
    return *value;
  };
  line.start = seconds(fields[1]);
  line.end = seconds(fields[2]);
  if (!(line.end > line.start)) raise_clip_line(line, "the segment is empty");
}

/// Column 5 of a row with captions: how its segment goes on.
inline void read_continuation(ClipLine& line, const std::string& field) {
  for (const std::string& word : split_fields(field, ",")) {
    if (word == "repeat")
      line.repeat = true;
    else if (word == "hold")
      line.hold = true;
    else if (word == "seated")
      line.seated = true;
    else if (word.starts_with("then ") && line.then.empty())
      line.then.push_back(
          {.place = line.place, .id = word.substr(5), .clip = word.substr(5), .end = to_the_end, .texts = {}});
    else
      raise_clip_line(line, "'" + word + "' is not 'repeat', 'hold', 'seated' or one 'then CLIP'");
  }
  if (static_cast<int>(line.repeat) + static_cast<int>(line.hold) + static_cast<int>(!line.then.empty()) > 1)
    raise_clip_line(line, "'repeat', 'hold' and 'then CLIP' exclude each other");
}

/// The labels in a table with two columns: of a stretch, of its motion or of its text, in this order.
class LabelTable {
 public:
  explicit LabelTable(const std::filesystem::path& path) {
    const auto read = [](ClipLine& line, const std::vector<std::string>& fields) {
      if (fields.size() == 2) line.texts = {fields[1]};
      return fields.size() == 2;
    };
    for (const ClipLine& line :
         read_table(path, "the id of a stretch or of a motion, or a text, and its label", read)) {
      if (!labels_.emplace(line.id, line.texts).second) raise_clip_line(line, "'" + line.id + "' has a label already");
    }
  }
  std::vector<std::string> of(const std::string& segment, const std::string& motion, const std::string& text) const {
    for (const std::string* name : {&segment, &motion, &text}) {
      if (const auto found = labels_.find(*name); found != labels_.end()) return found->second;
    }
    return {};
  }

 private:
  std::map<std::string, std::vector<std::string>> labels_;
};

}  // namespace detail

MOTIONLANG_BODY ClipFolder::ClipFolder(std::filesystem::path folder) : places_{std::move(folder)} {
  if (is_data_set(places_.front())) places_.push_back(rows_file(places_.front(), "").parent_path());
}

MOTIONLANG_BODY const ClipFolder::Stems& ClipFolder::listed(const std::filesystem::path& folder) {
  const auto [entry, is_new] = listed_.try_emplace(folder);
  Stems& stems = entry->second;
  std::error_code problem, unknown;
  for (std::filesystem::directory_iterator at(folder.empty() ? "." : folder, problem), end;
       is_new && !problem && at != end; at.increment(problem)) {
    const auto& path = at->path();
    if (is_motion_file(path) && at->is_regular_file(unknown))
      stems.emplace(path.stem().string(), folder / path.filename());
  }
  return stems;
}

MOTIONLANG_BODY std::vector<std::filesystem::path> ClipFolder::namesakes(const std::filesystem::path& name) {
  std::vector<std::filesystem::path> out;
  for (const auto& place : places_) {
    const auto path = (place / name).lexically_normal();
    const auto [first, last] = listed(path.parent_path()).equal_range(path.filename().string());
    for (auto found = first; found != last; ++found) out.push_back(found->second);
  }
  if (out.size() > 1)
    std::erase_if(out, [](const auto& file) { return file_kind(file) == ".npy" && !may_hold_frames(file); });
  std::sort(out.begin(), out.end());
  return out;
}

MOTIONLANG_BODY std::filesystem::path ClipFolder::file(const std::string& clip, const std::string& place) {
  for (const std::filesystem::path name : amass_paths(clip)) {
    std::vector<std::filesystem::path> found;
    if (is_motion_file(name)) {
      found = namesakes(std::filesystem::path(name).replace_extension());
      std::erase_if(found, [&](const auto& file) { return file.extension() != name.extension(); });
    }
    if (found.empty()) found = namesakes(name);
    if (found.size() > 1)
      raise<io_error>(403, place, ": '", clip, "' may be ", found[0].string(), " or ", found[1].string(),
                      ": add its extension");
    if (!found.empty()) return found.front();
  }
  return {};
}

MOTIONLANG_BODY void ClipFolder::find(ClipLine& line) {
  for (ClipLine& next : line.then) find(next);
  line.file = file(line.clip, line.place);
  if (const auto mark = line.clip.rfind('#'); line.file.empty() && mark != line.clip.npos) {
    const auto whole = file(line.clip.substr(0, mark), line.place);
    if (is_gltf(whole)) line.file = whole, line.animation = line.clip.substr(mark + 1);
    return;
  }
  const std::filesystem::path name = line.clip;
  if (line.file.empty() || line.file.extension() != name.extension() || line.file.stem() != name.stem()) return;
  const auto stem = std::filesystem::path(name).replace_extension();
  if (namesakes(stem).size() > 1) return;
  if (line.id == line.clip) line.id = stem.generic_string();
  line.clip = stem.generic_string();
}

MOTIONLANG_BODY std::vector<ClipLine> read_captions(const std::filesystem::path& path,
                                                    const std::filesystem::path& data) {
  return detail::with_clip_files(
      detail::read_table(path, "clip, start, end, parts, captions[, how it goes on], or clip, captions",
                         [](ClipLine& line, const std::vector<std::string>& fields) {
                           if (fields.size() != 2 && fields.size() != 5 && fields.size() != 6) return false;
                           line.texts = detail::split_fields(fields[fields.size() == 2 ? 1 : 4], "|");
                           if (fields.size() == 6) detail::read_continuation(line, fields[5]);
                           if (fields.size() == 2) {
                             line.end = detail::to_the_end;
                             line.parts = BodyParts::all();
                             return true;
                           }
                           detail::read_clip_times(line, fields);
                           for (const std::string& name : detail::split_fields(fields[3], ",")) {
                             const auto part = parse_body_part(name);
                             if (!part) detail::raise_clip_line(line, "'" + name + "' is not a body part");
                             line.parts = line.parts.with(*part);
                           }
                           return true;
                         }),
      data);
}

MOTIONLANG_BODY std::vector<ClipLine> read_labels(const std::filesystem::path& path,
                                                  const std::filesystem::path& data) {
  return detail::with_clip_files(detail::read_table(path, "clip, start, end, label, or clip, label",
                                                    [](ClipLine& line, const std::vector<std::string>& fields) {
                                                      if (fields.size() != 2 && fields.size() != 4) return false;
                                                      line.texts = {fields.back()};
                                                      if (fields.size() == 4)
                                                        detail::read_clip_times(line, fields);
                                                      else
                                                        line.end = detail::to_the_end;
                                                      return true;
                                                    }),
                                 data);
}

MOTIONLANG_BODY std::vector<ClipLine> read_labelled_annotations(const std::filesystem::path& annotations,
                                                                const std::filesystem::path& data,
                                                                const std::filesystem::path& labels) {
  std::optional<detail::LabelTable> table;
  if (!labels.empty()) table.emplace(labels);
  ClipFolder clips(data);
  std::vector<ClipLine> lines;
  bool any = false;
  const auto add = [&](const std::string& place, const std::string& id, const std::string& clip, double start,
                       double end, std::vector<std::string> own) {
    if (!detail::is_clip_id(clip)) raise<io_error>(403, place, ": '", clip, "' is not a path of a clip");
    any = any || !own.empty();
    lines.push_back({place, id, clip, start, end, {}, std::move(own)});
    clips.find(lines.back());
  };
  const auto members = JsonMembers::open(annotations);
  for (const std::string& id : members.keys()) {
    const nlohmann::json document = members.load(id);
    const JsonView view(document, members.place(id));
    if (BabelFile::is_entry(view)) {
      const BabelSequence s = BabelFile::parse(id, view);
      const std::string clip = babel_clip(clips, s.feat_p, view.path());
      for (const BabelAnnotation& a : s.frame_annotations.empty() ? s.sequence_annotations : s.frame_annotations) {
        for (const BabelLabel& l : a.labels)
          add(view.path(), id, clip, l.start, l.end, table ? table->of(l.seg_id, id, l.proc_label) : l.act_cat);
      }
      continue;
    }
    const AnnotatedMotion motion = AnnotationFile::parse(id, view);
    const JsonView list = view["annotations"];
    for (Index i = 0; i < list.size(); ++i) {
      const Annotation& a = motion.annotations[static_cast<std::size_t>(i)];
      auto own = list[i].value_or("act_cat", std::vector<std::string>{});
      if (const std::string label = list[i].value_or("label", ""); !label.empty()) own = {label};
      add(list[i].path(), id, motion.path, a.start, a.end, table ? table->of(a.seg_id, id, a.text) : std::move(own));
    }
  }
  if (!any && table)
    raise<io_error>(403, annotations.string(), ": ", labels.string(),
                    " has no label for any of its segments, motions or texts");
  if (!any)
    raise<io_error>(403, annotations.string(),
                    ": no annotation has a label or act_cat; `labels` names a table with "
                    "what a stretch, a motion or a text is labelled");
  return lines;
}

MOTIONLANG_BODY std::string babel_clip(ClipFolder& clips, const std::string& feat_p, const std::string& place) {
  std::string twice = feat_p.ends_with(".npz") ? feat_p.substr(0, feat_p.size() - 4) : feat_p;
  const std::string first = twice.substr(0, twice.find('/') + 1), once = twice.substr(first.size());
  return once.starts_with(first) && clips.file(twice, place).empty() ? once : twice;
}

MOTIONLANG_BODY Motion read_clip(const std::filesystem::path& data, const ClipLine& line) {
  const std::filesystem::path& file = line.file;
  const std::string kind = file_kind(file);
  if (file.empty())
    raise<io_error>(401, line.place, ": there is no ", (data / line.clip).string(),
                    is_motion_file(line.clip) ? "" : ".bvh, no .npz, no .amc and no .npy");
  if (kind == ".bvh") return retarget(read_bvh_motion(file));
  if (kind == ".npz") return on_smpl(read_amass(file).motion);
  if (kind == ".npy") return on_smpl(read_motion_npy(file));
  if (is_gltf(file))
    return on_smpl(line.animation.empty() ? read_motion(file) : GlbFile::open(file).motion(line.animation));
  if (kind != ".amc")
    raise<io_error>(404, line.place, ": ", file.string(),
                    ": clips are .bvh, .npz, .amc, .npy, .glb and .vrma files; convert makes them");
  std::filesystem::path asf = asf_beside(file).string();
  if (!std::filesystem::exists(asf))
    asf = data / "cmu-asf-amc" / "01.asf";  // the angles of another figure with the same hierarchy
  return retarget(read_amc(file, read_asf(asf)));
}

MOTIONLANG_BODY FrameSlice frames_of(const Motion& clip, const ClipLine& line) {
  const auto frame = [&](double seconds) {
    return static_cast<Index>(std::clamp(seconds * clip.fps + 0.5, 0.0, static_cast<double>(clip.frames())));
  };
  const Index first = frame(line.start), last = std::max(first, frame(line.end));
  return {first, last - first};
}

MOTIONLANG_BODY Motion segment_of(const Motion& clip, const ClipLine& line, Index least) {
  const auto [first, frames] = frames_of(clip, line);
  if (frames < least)
    detail::raise_clip_line(
        line, concat_text(line.clip, " ", line.start, " to ", std::min(line.end, clip.seconds()), " s holds ",
                          counted(frames, "frame"), ", at least ", least, " are wanted"));
  return crop(clip, first, first + frames);
}

MOTIONLANG_NAMESPACE_END
