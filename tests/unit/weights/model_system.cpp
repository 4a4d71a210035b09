// The system of a folder or file.
#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/model_system.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a file and a folder with nothing but weights are STMC of ours; config.json names others") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "bare");
  ml::write_file(folder / "bare/stmc.safetensors", std::string_view("x"));
  for (const auto& path : {folder / "bare", folder / "bare/stmc.safetensors"}) {
    const ml::ModelSystem system = ml::model_system(path);
    CHECK(system.name == "stmc");
    CHECK(system.ours);
    CHECK(system.is_diffusion());
  }
  ml::ModelFolder tmr;
  tmr.system = "tmr", tmr.license = "MIT", tmr.provenance = "a test";
  ml::write_model_folder(folder / "tmr", tmr, {});
  CHECK(ml::model_system(folder / "tmr").name == "tmr");
  CHECK(ml::model_system(folder / "tmr").ours);
  CHECK(!ml::model_system(folder / "tmr").is_diffusion());

  std::filesystem::create_directories(folder / "mdm");
  ml::write_file(folder / "mdm/args.json", std::string_view("{}"));
  CHECK(ml::model_system(folder / "mdm").name == "mdm");
  CHECK(!ml::model_system(folder / "mdm").ours);
  std::filesystem::create_directories(folder / "empty");
  CHECK_ERROR(ml::model_system(folder / "empty"), "[motionlang.io.401]");
}
