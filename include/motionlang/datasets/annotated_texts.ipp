// SPDX-License-Identifier: MIT
// Bodies of annotated_texts.hpp.
#pragma once

#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/annotated_texts.hpp>
#include <motionlang/datasets/babel.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<AnnotatedMotion> read_annotated_texts(const FilePath& path) {
  std::vector<AnnotatedMotion> motions;
  const auto members = JsonMembers::open(path);
  for (const std::string& id : members.keys()) {
    const nlohmann::json document = members.load(id);
    const JsonView entry(document, members.place(id));
    const bool babel = BabelFile::is_entry(entry);
    motions.push_back(babel ? annotated_motion(BabelFile::parse(id, entry)) : AnnotationFile::parse(id, entry));
    if (babel && motions.back().annotations.empty()) motions.pop_back();
  }
  if (motions.empty()) raise<config_error>(101, path.string(), ": no texts");
  return motions;
}

MOTIONLANG_BODY std::vector<MotionCaption> captions_of(const AnnotatedMotion& m) {
  std::vector<MotionCaption> captions;
  for (const Annotation& a : m.annotations) {
    const bool whole = a.start == 0 && a.end >= m.duration;
    captions.push_back({std::string(detail::trim(a.text)), {}, whole ? 0 : a.start, whole ? 0 : a.end});
  }
  return captions;
}

MOTIONLANG_BODY std::size_t drop_momentary_texts(AnnotatedMotion& m) {
  return std::erase_if(m.annotations, [](const Annotation& a) { return a.start == a.end; });
}

MOTIONLANG_BODY std::map<std::string, std::string> caption_files(const std::vector<AnnotatedMotion>& motions,
                                                                 const std::string& folder) {
  std::map<std::string, std::string> files;  // all files before the first is written, because one may be refused
  std::map<std::string, std::string> ids;
  for (const AnnotatedMotion& m : motions) {
    const std::string name = safe_file_name(m.id) + ".txt";
    if (const auto [other, is_new] = ids.emplace(name, m.id); !is_new)
      raise<config_error>(102, folder, ": '", other->second, "' and '", m.id, "' would both be the file ", name);
    files[name] = format_captions(captions_of(m), name);
  }
  return files;
}

MOTIONLANG_NAMESPACE_END
