#include "text_motion_model.hpp"

#include <motionlang/io/diffusion_folder.hpp>

#include "model_description.hpp"

namespace program {

LanguageModelFiles read_language_model_files(const std::filesystem::path& folder) {
  const auto config = folder / "config.json";
  const auto document = ml::read_json(config);
  LanguageModelFiles out{folder, ml::bert_config(ml::JsonView(document, config.string()), "distilbert"),
                         std::make_shared<const ml::AnyTokenizer>(ml::read_tokenizer(folder))};
  if (out.tokenizer->size() > out.sizes.vocabulary)
    ml::raise<ml::config_error>(102, folder.string(), ": a tokenizer of ", out.tokenizer->size(),
                                " pieces, the network knows ", out.sizes.vocabulary);
  return out;
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
  TextMotionFile file{model.system, model.fps, {}, {}};
  const nlohmann::json config = model.config, others = model.others;
  read_config(file.config, ml::JsonView(config, path + ": config"));
  if (others.contains("vocabulary")) {
    const ml::JsonView view(others, path);
    file.pieces = ml::WordPiece(view["vocabulary"].as<std::vector<std::string>>(), path + ": vocabulary");
  }
  if (file.config.text.finetune) file.language = read_language_model_files(folder / "text_encoder");
  return file;
}

void write_text_motion(const std::filesystem::path& folder, const TextMotionFile& file,
                       const std::map<std::string, std::string>& about, const ml::TensorStore& weights) {
  auto model = described_model(file.system, about);
  model.features = file.config.features;
  model.fps = file.fps;
  model.text_encoder = file.config.text.encoder;
  model.config = config_json(file.config);
  if (file.pieces) model.others["vocabulary"] = file.pieces->vocabulary();
  if (file.language) {
    std::filesystem::create_directories(folder / "text_encoder");
    for (const auto& from : ml::detail::text_encoder_files(file.language->folder, /*weights=*/false))
      ml::write_file(folder / "text_encoder" / from.filename(), std::string_view(ml::read_file(from)));
  }
  overwrite_model(folder, model, weights);
}

}  // namespace program
