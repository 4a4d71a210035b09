#include "text_motion_model.hpp"

#include <motionlang/weights/diffusion_folder.hpp>

namespace program {

LanguageModelFiles read_language_model_files(const std::filesystem::path& folder) {
  const auto config = folder / "config.json";
  const auto document = ml::read_json(config);
  LanguageModelFiles out{folder, ml::bert_config(ml::JsonView(document, config.string()), "distilbert"),
                         std::make_shared<const ml::AnyTokenizer>(ml::read_tokenizer(folder))};
  if (out.tokenizer->size() > out.sizes.vocabulary)
    ml::raise<ml::config_error>(102, folder.string(), ": a tokenizer of ", ml::counted(out.tokenizer->size(), "piece"),
                                ", the network knows ", out.sizes.vocabulary);
  return out;
}

void write_language_model_files(const std::filesystem::path& folder, const LanguageModelFiles& files) {
  std::filesystem::create_directories(folder);
  for (const auto& from : ml::detail::text_encoder_files(files.folder, /*weights=*/false))
    ml::write_file(folder / from.filename(), std::string_view(ml::read_file(from)));
}

TextMotionFile read_text_motion_config(const std::filesystem::path& folder) {
  if (ml::RunFolder run = ml::find_run(folder); run.system == "tmr") {
    const auto config = tmr_preset("tmr-published");
    return {"tmr", ml::motion_features(config.features).fps, config, {}, {}, std::move(run)};
  }
  const auto path = (folder / "config.json").string();
  const auto model = ml::read_model_folder(folder);
  if (model.system != "tmr" && model.system != "temos")
    ml::raise<ml::config_error>(103, path, ": system '", model.system, "' is not tmr or temos");
  auto file = text_model_file<TextMotionConfig>(model, path);
  if (file.config.text.finetune) file.language = read_language_model_files(folder / "text_encoder");
  return file;
}

}  // namespace program
