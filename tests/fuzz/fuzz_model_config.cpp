// config.json of model folders and index.json of weights in shards: any text is read or refused with an error of the
// library; what is read survives being written.
#include <cstdint>

#include <motionlang/weights/model_folder.hpp>

#include "check.hpp"

namespace ml = motionlang;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  refusing([&] {
    ml::ModelFolder model = ml::parse_model_config(text, "config.json");
    if (model.system.empty()) model.system = "x";
    if (model.license.empty()) model.license = "x";
    if (model.provenance.empty()) model.provenance = "x";
    const std::string written = ml::model_config_text(model);
    const ml::ModelFolder again = ml::parse_model_config(written, "again");
    check(again.system == model.system && again.license == model.license && again.provenance == model.provenance,
          "texts survive");
    check(again.fps == model.fps && again.features == model.features && again.config == model.config, "values survive");
    check(again.others == model.others && ml::model_config_text(again) == written, "other members survive");
  });
  return 0;
}
