// SPDX-License-Identifier: MIT
/// The annotation JSON of TMR and STMC: which texts describe which seconds of which AMASS sequence. Read entry by
/// entry, written in the published layout.
///
///     {"000000": {"path": "KIT/3/kick_high_left02_poses", "duration": 5.82, "annotations": [
///         {"seg_id": "000000_0", "text": "a man kicks.", "start": 0.0, "end": 5.82}, ...]}, ...}
///
///     const auto file = AnnotationFile::open("annotations.json");
///     for (const std::string& id : file.select(read_ids("splits/train.txt"))) {
///       for (const Annotation& a : training_annotations(file.load(id), "train")) ...
///     }
///
/// Source  AMASS-Annotation-Unifier; TMR (Petrovich et al. 2023), src/data/text_motion.py; spec exchange-formats.md 5.1
#pragma once

#include <algorithm>      // copy_if
#include <iterator>       // back_inserter
#include <unordered_set>  // repeated ids

#include <motionlang/core/utf8.hpp>
#include <motionlang/datasets/detail/annotated_times.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/json_members.hpp>
#include <motionlang/text/mirror_caption.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct Annotation {
  std::string seg_id;  // "<id>_<number>"
  std::string text;
  double start = 0, end = 0;  // seconds
  std::string babel_id{};     // of a label of BABEL: its seg_id there
  bool operator==(const Annotation&) const = default;
};

struct AnnotatedMotion {
  std::string id;
  std::string path;  // AMASS-relative, without extension; "M/..." of mirrored motions, "humanact12/..." of HumanAct12
  double duration = 0;  // seconds
  std::vector<Annotation> annotations;
  bool operator==(const AnnotatedMotion&) const = default;
};

/// An annotation file that is being read. Entries are parsed when they are asked for.
class AnnotationFile {
 public:
  /// What is open already.
  explicit AnnotationFile(JsonMembers members) : members_(std::move(members)) {}
  /// Throws io_error 401, 403 (JsonMembers).
  static AnnotationFile open(const FilePath& path) { return AnnotationFile(JsonMembers::open(path)); }
  static AnnotationFile from_text(std::string text, std::string name = "annotations") {
    return AnnotationFile(JsonMembers::from_text(std::move(text), std::move(name)));
  }

  /// In the order of the file.
  const std::vector<std::string>& ids() const { return members_.keys(); }
  bool has(const std::string& id) const { return members_.has(id); }

  /// Throws config_error 103 for an unknown id, 107 for a value of the wrong kind (with its path), io_error 403 for
  /// malformed JSON (with line and column) and for times that are none.
  AnnotatedMotion load(const std::string& id) const {
    const nlohmann::json document = members_.load(id);
    return parse(id, JsonView(document, members_.place(id)));
  }
  /// The motion of an entry. Throws what load throws for its values.
  static AnnotatedMotion parse(const std::string& id, const JsonView& view) {
    AnnotatedMotion motion{id, view["path"].as<std::string>(), view["duration"].as<double>(), {}};
    detail::require_times(view["duration"].path(), 0, motion.duration);
    const JsonView list = view["annotations"];
    for (Index i = 0; i < list.size(); ++i) {
      const JsonView a = list[i];
      motion.annotations.push_back({a["seg_id"].as<std::string>(), a["text"].as<std::string>(), a["start"].as<double>(),
                                    a["end"].as<double>(), a.value_or("babel_id", "")});
      detail::require_times(a.path(), motion.annotations.back().start, motion.annotations.back().end);
    }
    return motion;
  }

  /// The ids of a split that have an entry, in the order of the split. Others are left out silently, as published.
  std::vector<std::string> select(std::span<const std::string> split) const {
    std::vector<std::string> out;
    std::copy_if(split.begin(), split.end(), std::back_inserter(out), [&](const std::string& id) { return has(id); });
    return out;
  }

 private:
  JsonMembers members_;
};

/// What TMR trains on: texts of 2 to 10 seconds. A split whose name contains "test" keeps all. Motions without any are
/// left out of the split. Evaluation takes the first text.
inline std::vector<Annotation> training_annotations(const AnnotatedMotion& motion, std::string_view split,
                                                    double least = 2, double most = 10) {
  if (split.find("test") != split.npos) return motion.annotations;
  std::vector<Annotation> out;
  for (const Annotation& a : motion.annotations) {
    if (a.end - a.start >= least && a.end - a.start <= most) out.push_back(a);
  }
  return out;
}

/// The frames of a text: int(start fps) up to int(end fps), as far as the motion goes.
inline FrameSlice annotated_frames(const Annotation& a, double fps, Index frames) {
  return slice_of_seconds(a.start, a.end, fps, frames);
}

/// The entry of the mirrored motion: "M" in front of id, seg_id and path, and captions of the other side.
inline AnnotatedMotion mirrored(AnnotatedMotion motion) {
  motion.id = mirrored_id(motion.id);
  motion.path = concat_text("M/", motion.path);
  for (Annotation& a : motion.annotations) {
    a.seg_id = mirrored_id(a.seg_id);
    a.text = mirror_caption(a.text);
  }
  return motion;
}

/// The text of an annotation file, laid out as the published ones.
/// Laws    AnnotationFile::from_text(annotations_json(x)) loads x
/// Throws  io_error 403 for an id that stands twice, a text that is not UTF-8, and times that are none
inline std::string annotations_json(std::span<const AnnotatedMotion> motions) {
  std::string out = "{";
  std::unordered_set<std::string_view> seen;
  for (const AnnotatedMotion& m : motions) {
    const std::string place = "annotations: " + m.id;
    auto checked = [&](const std::string& text) {
      if (!is_utf8(text)) raise<io_error>(403, place, ": a text is not UTF-8");
      return text;
    };
    if (!seen.insert(m.id).second) raise<io_error>(403, place, ": the id stands twice");
    detail::require_times(place, 0, m.duration);
    auto list = nlohmann::ordered_json::array();
    for (const Annotation& a : m.annotations) {
      detail::require_times(place, a.start, a.end);
      list.push_back({{"seg_id", checked(a.seg_id)}, {"text", checked(a.text)}, {"start", a.start}, {"end", a.end}});
      if (!a.babel_id.empty()) list.back()["babel_id"] = checked(a.babel_id);
    }
    const nlohmann::ordered_json entry{
        {"path", checked(m.path)}, {"duration", m.duration}, {"annotations", std::move(list)}};
    out += (out.size() == 1 ? "\n  " : ",\n  ") + nlohmann::json(checked(m.id)).dump(-1, ' ', true) + ": ";
    for (const char c : entry.dump(2, ' ', true)) {
      out += c;
      if (c == '\n') out += "  ";
    }
  }
  return out + (motions.empty() ? "}" : "\n}");
}
/// Throws io_error 401 and as annotations_json.
inline void write_annotations(const FilePath& path, std::span<const AnnotatedMotion> motions) {
  write_file(path, annotations_json(motions));
}

MOTIONLANG_NAMESPACE_END
