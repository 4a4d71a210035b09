// Model folders of ours: what is written comes back, nothing half written stays, wrong entries are reported with
// both values.
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

ml::ModelFolder sample() {
  ml::ModelFolder m;
  m.system = "stmc", m.license = "MIT", m.provenance = "drawn at random", m.features = "smplrifke",
  m.text_encoder = "clip";
  m.fps = 12.5;
  m.config["diffusion"]["denoiser"]["latent_dim"] = 32;
  m.others["commit"] = "abc";
  return m;
}
ml::TensorStore tensors() {
  ml::TensorStore store;
  const std::vector<float> values{1, 2, 3};
  store.add("denoiser.w", {3}, std::span<const float>(values), ml::DType::F32);
  return store;
}
std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("a folder comes back as it was written, and is known as a run") {
  const TemporaryFolder folder;
  ml::write_file(folder / "vocab.txt", std::string_view("a\n"));
  const std::vector<fs::path> files{folder / "vocab.txt"};
  const auto path = folder / "model";
  ml::write_model_folder(path, sample(), tensors().views(), files);
  const ml::ModelFolder m = ml::read_model_folder(path);
  CHECK((m.system == "stmc" && m.license == "MIT" && m.provenance == "drawn at random"));
  CHECK((m.features == "smplrifke" && m.text_encoder == "clip" && m.fps == 12.5));
  CHECK(m.config == sample().config);
  CHECK(m.others == sample().others);
  CHECK(fs::exists(path / "text_encoder/vocab.txt"));
  CHECK(ml::open_weights(path).tensor("denoiser.w").shape == ml::Shape{3});
  const auto run = ml::find_run(path);
  CHECK(run.system == "motionlang");
  CHECK(std::get<std::int64_t>(run.option("config/diffusion/denoiser/latent_dim")->value) == 32);
  CHECK(entries(folder.path) == 2);
}

TEST_CASE("nothing is overwritten, and nothing half written stays") {
  const TemporaryFolder folder;
  const auto path = folder / "model";
  const std::vector<fs::path> missing{folder / "nothing"};
  CHECK_ERROR(ml::write_model_folder(path, sample(), tensors().views(), missing), "cannot copy the text encoder");
  CHECK(entries(folder.path) == 0);
  const ml::TensorStore store = tensors();
  const std::vector<ml::TensorView> twice(2, store.views().front());
  CHECK_THROWS(ml::write_model_folder(path, sample(), twice));
  CHECK(entries(folder.path) == 0);
  ml::write_model_folder(path.string() + "/", sample(), tensors().views());
  CHECK_ERROR(ml::write_model_folder(path, sample(), tensors().views()), "exists already");
  CHECK(entries(folder.path) == 1);
}

TEST_CASE("who gets a model has to know its licence and where it comes from") {
  const TemporaryFolder folder;
  for (std::string ml::ModelFolder::*member :
       {&ml::ModelFolder::license, &ml::ModelFolder::provenance, &ml::ModelFolder::system}) {
    ml::ModelFolder m = sample();
    m.*member = "";
    CHECK_ERROR(ml::write_model_folder(folder / "model", m, tensors().views()), "is empty");
  }
  ml::ModelFolder m = sample();
  m.license = "\xFF";
  CHECK_ERROR(ml::write_model_folder(folder / "model", m, tensors().views()), "config.json: license is not UTF-8");
  m = sample();
  m.others["license"] = "other";
  CHECK_ERROR(ml::write_model_folder(folder / "model", m, tensors().views()), "[motionlang.config.102]");
  CHECK(entries(folder.path) == 0);
}

TEST_CASE("wrong entries are reported with file, key and both values") {
  const auto refused = [](const std::string& text, const char* message) {
    CHECK_ERROR(ml::parse_model_config(text, "m/config.json"), message);
  };
  refused("{", "[motionlang.io.403] m/config.json:1:2");
  refused("{}", "[motionlang.config.107] m/config.json: has no member 'format'");
  refused(R"({"format": "other"})", "m/config.json: format is 'other', expected 'motionlang'");
  refused(R"({"format": "motionlang", "version": 2})", "[motionlang.io.404] m/config.json: version is 2, expected 1");
  refused(R"({"format": "motionlang"})", "has no member 'system'");
  refused(R"({"format": "motionlang", "system": 3})", "m/config.json: system: expected a string, found number");
  refused(R"({"format": "motionlang", "system": "stmc"})", "has no member 'config'");
  refused(R"({"format": "motionlang", "system": "stmc", "config": []})", "config: expected an object");
  refused(R"({"format": "motionlang", "system": "stmc", "fps": 0, "config": {}})",
          "m/config.json: fps is 0, not in (0, 1000]");
  refused(R"({"format": "motionlang", "system": "stmc", "fps": "20", "config": {}})",
          "fps: expected a number, found string");
  const TemporaryFolder folder;
  CHECK_ERROR(ml::read_model_folder(folder.path), "[motionlang.io.401]");
}
