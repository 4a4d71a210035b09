// Converts texts of motions from one file into another.
#include "texts.hpp"

#include <motionlang/datasets/annotated_texts.hpp>

#include "../formatted.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

void write_texts(const std::filesystem::path& folder, const std::vector<ml::AnnotatedMotion>& motions) {
  const auto files = ml::caption_files(motions, folder.string());
  make_output_folder("output", folder / "texts");
  for (const auto& [name, text] : files) ml::write_file(folder / "texts" / name, text);
}

}  // namespace

bool is_texts(const std::filesystem::path& path) { return kind_of(path) == ".json"; }

std::string convert_texts(const std::filesystem::path& in, const std::filesystem::path& out) {
  const bool folder = !out.has_extension();
  if (!folder && !is_texts(out))
    ml::raise<ml::config_error>(103, out.string(),
                                ": texts of motions are written to .json, or into a folder as caption files, not '",
                                kind_of(out), "'");
  ml::InputFiles{in}.refuse(out);
  auto motions = ml::read_annotated_texts(in);
  std::string told;
  if (folder) {
    std::size_t momentary = 0;
    for (ml::AnnotatedMotion& m : motions) momentary += ml::drop_momentary_texts(m);
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
