#include <motionlang/generate/motion_model_place.hpp>

#include <doctest/doctest.h>

#include <fstream>

#include <motionlang/weights/run_folder.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

void write(const fs::path& file, const char* text = "{}") {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

}  // namespace

TEST_CASE("where a model is, and of which system") {
  const TemporaryFolder folder;
  write(folder / "ours/model.safetensors");
  write(folder / "mdm/args.json", R"({"dataset": "humanml"})");
  write(folder / "trained/model/config.json", R"({"format": "motionlang", "config": {}, "system": "actor"})");
  for (const fs::path& ours : {folder / "ours", folder / "ours/model.safetensors"}) {
    const auto place = ml::find_motion_model(ours);
    CHECK(place.path == ours);
    CHECK(place.system.empty());
    CHECK((place.is_diffusion() && !place.is_trained()));
  }
  const auto mdm = ml::find_motion_model(folder / "mdm");
  CHECK(mdm.system == "mdm");
  CHECK(mdm.is_diffusion());
  const auto trained = ml::find_motion_model(folder / "trained");
  CHECK(trained.path == folder / "trained/model");
  CHECK(trained.system == "trained actor");
  CHECK((trained.is_trained() && !trained.is_diffusion()));
  for (const char* system : {"actor", "temos", "teach", "sinc", "tm2t", "mdm of actions"})
    CHECK_FALSE(ml::MotionModelPlace{{}, system}.is_diffusion());
  CHECK(ml::MotionModelPlace{{}, "tmr"}.is_trained());

  CHECK_NOTHROW(ml::require_no_sources(mdm, {}));
  CHECK_ERROR(ml::require_no_sources({"model", ""}, {.statistics = "."}),
              "[motionlang.config.102] model: `text_encoder`");
}

TEST_CASE("the file of a folder") {
  const TemporaryFolder folder;
  CHECK_ERROR(ml::stmc_model_file(folder.path), "[motionlang.io.401]");
  write(folder / "a.safetensors");
  write(folder / "checkpoint.safetensors");  // of the training
  CHECK(ml::stmc_model_file(folder.path) == folder / "a.safetensors");
  CHECK(ml::stmc_model_file(folder / "a.safetensors") == folder / "a.safetensors");
  write(folder / "b.safetensors");
  CHECK_ERROR(ml::stmc_model_file(folder.path), "2 .safetensors files where one is expected");
}
