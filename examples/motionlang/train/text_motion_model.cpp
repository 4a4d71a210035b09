#include "text_motion_model.hpp"

namespace program {

TextMotionFile read_text_motion_config(const std::filesystem::path& folder) {
  if (ml::RunFolder run = ml::find_run(folder); run.system == "tmr") {
    const auto config = tmr_preset("tmr-published");
    return {"tmr", ml::motion_features(config.features).fps, config, {}, std::move(run)};
  }
  const auto path = (folder / "config.json").string();
  const auto model = ml::read_model_folder(folder);
  if (model.system != "tmr" && model.system != "temos")
    ml::raise<ml::config_error>(103, path, ": system '", model.system, "' is not tmr or temos");
  return text_model_file<TextMotionConfig>(model, path);
}

}  // namespace program
