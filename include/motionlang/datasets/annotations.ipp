// SPDX-License-Identifier: MIT
// Bodies of annotations.hpp.
#pragma once

#include <algorithm>      // copy_if
#include <iterator>       // back_inserter
#include <unordered_set>  // repeated ids

#include <motionlang/core/utf8.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/detail/annotated_times.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/text/mirror_caption.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY AnnotationFile AnnotationFile::open(const FilePath& path) {
  return AnnotationFile(JsonMembers::open(path));
}

MOTIONLANG_BODY AnnotationFile AnnotationFile::from_text(std::string text, std::string name) {
  return AnnotationFile(JsonMembers::from_text(std::move(text), std::move(name)));
}

MOTIONLANG_BODY AnnotatedMotion AnnotationFile::load(const std::string& id) const {
  const nlohmann::json document = members_.load(id);
  return parse(id, JsonView(document, members_.place(id)));
}

MOTIONLANG_BODY AnnotatedMotion AnnotationFile::parse(const std::string& id, const JsonView& view) {
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

MOTIONLANG_BODY std::vector<std::string> AnnotationFile::select(std::span<const std::string> split) const {
  std::vector<std::string> out;
  std::copy_if(split.begin(), split.end(), std::back_inserter(out), [&](const std::string& id) { return has(id); });
  return out;
}

MOTIONLANG_BODY std::vector<Annotation> training_annotations(const AnnotatedMotion& motion, std::string_view split,
                                                             double least, double most) {
  if (split.find("test") != split.npos) return motion.annotations;
  std::vector<Annotation> out;
  for (const Annotation& a : motion.annotations) {
    if (a.end - a.start >= least && a.end - a.start <= most) out.push_back(a);
  }
  return out;
}

MOTIONLANG_BODY FrameSlice annotated_frames(const Annotation& a, double fps, Index frames) {
  return slice_of_seconds(a.start, a.end, fps, frames);
}

MOTIONLANG_BODY AnnotatedMotion mirrored(AnnotatedMotion motion) {
  motion.id = mirrored_id(motion.id);
  motion.path = concat_text("M/", motion.path);
  for (Annotation& a : motion.annotations) {
    a.seg_id = mirrored_id(a.seg_id);
    a.text = mirror_caption(a.text);
  }
  return motion;
}

MOTIONLANG_BODY std::string annotations_json(std::span<const AnnotatedMotion> motions) {
  std::string out = "{";
  std::unordered_set<std::string_view> seen;
  for (const AnnotatedMotion& m : motions) {
    const std::string place = "annotations: " + m.id;
    auto checked = [&](const std::string& text) {
      if (!is_utf8(text)) raise<io_error>(403, place, ": a text is not UTF-8");
      return text;
    };
    if (!seen.insert(m.id).second) raise<io_error>(403, place, ": the id is repeated");
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

MOTIONLANG_BODY void write_annotations(const FilePath& path, std::span<const AnnotatedMotion> motions) {
  write_file(path, annotations_json(motions));
}

MOTIONLANG_NAMESPACE_END
