// SPDX-License-Identifier: MIT
// Bodies of describe_files.hpp.
#pragma once

#include <map>  // clips

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/option_error.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/generate/describe_files.hpp>
#include <motionlang/kinematics/body_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<FileToDescribe> files_to_describe(std::span<const std::string> inputs, std::string* notes) {
  std::vector<FileToDescribe> out;
  for (const std::filesystem::path input : inputs) {
    if (!std::filesystem::is_directory(input)) {
      out.push_back({input, input.filename().string()});
      continue;
    }
    for (const auto& file : motion_files_below(input, "", notes))
      out.push_back({file, file.lexically_relative(input).generic_string(), true});
  }
  const auto stem_of = [](const std::string& clip) {
    return std::filesystem::path(clip).replace_extension().generic_string();
  };
  std::map<std::string, int> named;
  for (const FileToDescribe& f : out) ++named[stem_of(f.clip)];
  for (FileToDescribe& f : out) {
    if (std::string stem = stem_of(f.clip); named[stem] == 1) f.clip = std::move(stem);
  }
  return out;
}

MOTIONLANG_BODY void require_different_clips(std::span<const FileToDescribe> files) {
  std::map<std::string, std::filesystem::path> of_clip;
  for (const FileToDescribe& f : files) {
    const auto [other, is_new] = of_clip.emplace(f.clip, f.path);
    if (!is_new)
      raise<option_error>(102, "`out`: ", other->second.string(), " and ", f.path.string(), " would both be '", f.clip,
                          "' in the table");
  }
}

MOTIONLANG_BODY std::string caption_table(std::span<const DescribedMotionPart> described, const std::string& by,
                                          std::vector<std::string>& problems) {
  const std::string parts = join_text(body_part_names);
  std::string table = concat_text("# clip\tstart\tend\tparts\tcaptions, by ", by, "\n");
  for (const DescribedMotionPart& d : described) {
    std::vector<std::string> said;
    for (const Description& text : d.texts) {
      if (!text.text.empty()) said.push_back(text.text);
    }
    const std::string captions = join_text(said, " | ");
    if (captions.empty() || !d.name.empty())
      problems.push_back(concat_text(d.file.path.string(),
                                     captions.empty() ? ": no words" : " (" + d.name + "): one of several motions",
                                     ", not in the table"));
    else
      table += concat_text(d.file.clip, "\t", d.start, "\t", d.end, "\t", parts, "\t", captions, "\n");
  }
  return table;
}

MOTIONLANG_BODY std::string described_text(std::span<const DescribedMotionPart> described) {
  std::string out;
  for (const DescribedMotionPart& d : described) {
    out += formatted("%7.2f %7.2f s  ", d.start, d.end) + printable(d.file.path.string());
    out += (d.name.empty() ? "" : " (" + printable(d.name) + ")") + "\n";
    for (const Description& text : d.texts)
      out += formatted("%9.2f  ", text.log_probability) + "\"" + printable(text.text) + "\"\n";
  }
  return out;
}

MOTIONLANG_BODY std::string described_json(std::span<const DescribedMotionPart> described) {
  auto out = nlohmann::ordered_json::array();
  for (const DescribedMotionPart& d : described) {
    auto texts = nlohmann::ordered_json::array();
    for (const Description& text : d.texts)
      texts.push_back({{"text", text.text}, {"log_probability", text.log_probability}});
    out.push_back({{"path", d.file.path.string()},
                   {"name", d.name},
                   {"start", d.start},
                   {"end", d.end},
                   {"descriptions", std::move(texts)}});
  }
  return detail::json_text(out, 2) + "\n";
}

MOTIONLANG_NAMESPACE_END
