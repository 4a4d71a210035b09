// SPDX-License-Identifier: MIT
// Writes the page of the studio:
//     motionlang_write_studio <motionlang_wasm.js> <motionlang_wasm.wasm.gz> <weights.gz> <prompts> <studio.html>
#include <iostream>
#include <span>
#include <string>

#include <motionlang/file/file.hpp>
#include <motionlang/generate/gallery_prompts.hpp>
#include <motionlang/view/studio_page.hpp>

namespace ml = motionlang;

int main(int count, char** arguments) {
  if (count != 6) {
    std::cerr << "motionlang_write_studio <module.js> <code.wasm.gz> <weights.gz> <prompts> <studio.html>\n";
    return 2;
  }
  try {
    const auto code = ml::MappedFile::open(arguments[2]), model = ml::MappedFile::open(arguments[3]);
    ml::StudioParts parts{.program = ml::read_file(arguments[1]), .code = code->bytes(), .model = model->bytes()};
    for (const ml::GalleryPrompt& p : ml::parse_gallery_prompts(ml::read_file(arguments[4]), arguments[4]))
      parts.prompts.push_back({p.text, p.seconds});
    ml::write_file(arguments[5], ml::studio_html(parts));
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
  return 0;
}
