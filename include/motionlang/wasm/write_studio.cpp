// SPDX-License-Identifier: MIT
// Writes the page of the studio, and its model:
//     motionlang_write_studio int8 <weights.safetensors> <model.safetensors>
//     motionlang_write_studio page <module.js> <code.wasm.gz> <model.gz> <search config.gz> <search weights.gz>
//                             <prompts> <studio.html>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>

#include <motionlang/file/file.hpp>
#include <motionlang/generate/gallery_prompts.hpp>
#include <motionlang/view/studio_page.hpp>
#include <motionlang/weights/safetensors_copy.hpp>

namespace ml = motionlang;

int main(int count, char** arguments) {
  const std::string_view task = count > 1 ? arguments[1] : "";
  if (!(task == "int8" && count == 4) && !(task == "page" && count == 9)) {
    std::cerr << "motionlang_write_studio int8 <weights> <model>\n"
                 "motionlang_write_studio page <module.js> <code.wasm.gz> <model.gz> <search config.gz> "
                 "<search weights.gz> <prompts> <studio.html>\n";
    return 2;
  }
  try {
    if (task == "int8") {
      ml::write_safetensors_copy(arguments[3], ml::open_weights(arguments[2]), ml::DType::I8);
      return 0;
    }
    const auto code = ml::MappedFile::open(arguments[3]), model = ml::MappedFile::open(arguments[4]);
    const auto config = ml::MappedFile::open(arguments[5]), weights = ml::MappedFile::open(arguments[6]);
    ml::StudioParts parts{.program = ml::read_file(arguments[2]),
                          .code = code->bytes(),
                          .model = model->bytes(),
                          .search_config = config->bytes(),
                          .search_weights = weights->bytes()};
    for (const ml::GalleryPrompt& p : ml::parse_gallery_prompts(ml::read_file(arguments[7]), arguments[7]))
      parts.prompts.push_back({p.text, p.seconds});
    ml::write_file(arguments[8], ml::studio_html(parts));
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
  return 0;
}
