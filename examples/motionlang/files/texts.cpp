// Texts of motions from one file into another.
#include "texts.hpp"

#include <map>
#include <vector>  // erase_if

#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/babel.hpp>
#include <motionlang/datasets/humanml3d_texts.hpp>

#include "../formatted.hpp"
#include "input_files.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

/// Of BABEL's entries those with texts, of which the file of the test has none.
std::vector<ml::AnnotatedMotion> read_annotated(const std::filesystem::path& path) {
  std::vector<ml::AnnotatedMotion> motions;
  const auto members = ml::JsonMembers::open(path);
  for (const std::string& id : members.keys()) {
    const nlohmann::json document = members.load(id);
    const ml::JsonView entry(document, members.place(id));
    const bool babel = ml::BabelFile::is_entry(entry);
    motions.push_back(babel ? ml::annotated_motion(ml::BabelFile::parse(id, entry))
                            : ml::AnnotationFile::parse(id, entry));
    if (babel && motions.back().annotations.empty()) motions.pop_back();
  }
  if (motions.empty()) ml::raise<ml::config_error>(101, path.string(), ": no texts");
  return motions;
}

/// Words have no tags, which only T2M's evaluator asks for. Times of a text for the whole motion are 0 and 0.
std::vector<ml::MotionCaption> captions_of(const ml::AnnotatedMotion& m) {
  std::vector<ml::MotionCaption> captions;
  for (const ml::Annotation& a : m.annotations) {
    const bool whole = a.start == 0 && a.end >= m.duration;
    captions.push_back({std::string(ml::detail::trim(a.text)), {}, whole ? 0 : a.start, whole ? 0 : a.end});
  }
  return captions;
}

/// Files of captions cannot tell a text from 0 to 0 seconds from one for the whole motion. How many were left out.
std::size_t without_momentary(ml::AnnotatedMotion& m) {
  return std::erase_if(m.annotations, [](const ml::Annotation& a) { return a.start == a.end; });
}

void write_texts(const std::filesystem::path& folder, const std::vector<ml::AnnotatedMotion>& motions) {
  std::map<std::string, std::string> files;  // all of them before the first is written: one may be refused
  std::map<std::string, std::string> ids;
  for (const ml::AnnotatedMotion& m : motions) {
    const std::string name = file_name(m.id) + ".txt";
    if (const auto [other, is_new] = ids.emplace(name, m.id); !is_new)
      ml::raise<ml::config_error>(102, folder.string(), ": '", other->second, "' and '", m.id,
                                  "' would both be the file ", name);
    files[name] = ml::format_captions(captions_of(m), name);
  }
  make_output_folder("output", folder / "texts");
  for (const auto& [name, text] : files) ml::write_file(folder / "texts" / name, text);
}

}  // namespace

bool is_texts(const std::filesystem::path& path) { return kind_of(path) == ".json"; }

std::string convert_texts(const std::filesystem::path& in, const std::filesystem::path& out) {
  const bool folder = !out.has_extension();
  if (!folder && !is_texts(out))
    ml::raise<ml::config_error>(
        103, out.string(), ": texts of motions are written to .json or, as files of captions, into a folder, not '",
        kind_of(out), "'");
  InputFiles{in}.refuse(out);
  auto motions = read_annotated(in);
  std::string told;
  if (folder) {
    std::size_t momentary = 0;
    for (ml::AnnotatedMotion& m : motions) momentary += without_momentary(m);
    if (momentary > 0)
      told = ml::concat_text(in.string(), ": ",
                             counted(momentary, "text of no duration is", "texts of no duration are"), " left out\n");
    write_texts(out, motions);
  } else {
    ml::write_annotations(out, motions);
  }
  std::size_t texts = 0;
  for (const ml::AnnotatedMotion& m : motions) texts += m.annotations.size();
  return told + ml::concat_text((folder ? out / "texts" : out).string(), ": ", counted(texts, "text"), " of ",
                                counted(motions.size(), "motion"), "\n");
}

}  // namespace program
