// SPDX-License-Identifier: MIT
// Bodies of annotated_texts.hpp.
#pragma once

#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/annotated_texts.hpp>
#include <motionlang/datasets/babel.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/file/output_folder.hpp>
#include <motionlang/formats/motion_file.hpp>

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

MOTIONLANG_BODY std::string convert_texts(const std::filesystem::path& in, const std::filesystem::path& out) {
  const bool folder = !out.has_extension();
  if (!folder && file_kind(out) != ".json")
    raise<config_error>(103, out.string(),
                        ": texts of motions are written to .json, or into a folder as caption files, not '",
                        file_kind(out), "'");
  InputFiles{in}.refuse(out);
  auto motions = read_annotated_texts(in);
  std::string notes;
  if (folder) {
    std::size_t momentary = 0;
    for (AnnotatedMotion& m : motions) momentary += drop_momentary_texts(m);
    if (momentary > 0)
      notes = concat_text(in.string(), ": ", counted(momentary, "text of no duration is", "texts of no duration are"),
                          " left out\n");
    const auto files = caption_files(motions, out.string());
    make_output_folder("output", out / "texts");
    for (const auto& [name, text] : files) write_file(out / "texts" / name, text);
  } else {
    write_annotations(out, motions);
  }
  std::size_t texts = 0;
  for (const AnnotatedMotion& m : motions) texts += m.annotations.size();
  return concat_text(notes, (folder ? out / "texts" : out).string(), ": ", counted(texts, "text"), " of ",
                     counted(motions.size(), "motion"), "\n");
}

MOTIONLANG_NAMESPACE_END
