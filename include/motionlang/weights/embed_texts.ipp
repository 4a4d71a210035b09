// SPDX-License-Identifier: MIT
// Bodies of embed_texts.hpp.
#pragma once

#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/weights/embed_texts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> texts_to_embed(const std::filesystem::path& file) {
  std::vector<std::string> texts;
  if (file.extension() == ".json") {
    const auto annotations = AnnotationFile::open(file);
    for (const std::string& id : annotations.ids()) {
      for (const Annotation& a : annotations.load(id).annotations) texts.push_back(a.text);
    }
    return texts;
  }
  const std::string contents = read_file(file);
  detail::for_each_line(contents, [&](std::string_view line, Index) {
    if (!detail::trim(line).empty()) texts.emplace_back(line);
  });
  return texts;
}

MOTIONLANG_NAMESPACE_END
