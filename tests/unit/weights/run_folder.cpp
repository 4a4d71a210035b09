// Folders of training runs: which system it is, which of several checkpoints counts, weights in shards.
#include <fstream>

#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/tests_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

const fs::path golden = fs::path(tests_folder()) / "golden/cases/containers";

/// Files of no content are enough to be found.
struct Folder : TemporaryFolder {
  void add(const std::string& name, const std::string& text = "") const {
    fs::create_directories((path / name).parent_path());
    std::ofstream(path / name) << text;
  }
  ml::RunFolder run() const { return ml::find_run(path); }
  std::string weights() const { return fs::relative(run().weights, path).string(); }
};

std::vector<std::string> part_names(const ml::RunFolder& run) {
  std::vector<std::string> out;
  for (const auto& [name, file] : run.parts) out.push_back(name);
  return out;
}

void write_tensors(const fs::path& path, const std::vector<std::pair<std::string, float>>& values) {
  ml::TensorStore store;
  for (const auto& [name, value] : values) store.add(name, {1}, std::span<const float>(&value, 1), ml::DType::F32);
  ml::write_safetensors(path, store.views(), {});
}
float number(const ml::WeightFile& file, const std::string& name) {
  return ml::values_of<float>(file.tensor(name)).front();
}

}  // namespace

TEST_CASE("names are in the order of their numbers") {
  const auto before = ml::detail::before_by_number;
  CHECK(before("latest-epoch=99.ckpt", "latest-epoch=100.ckpt"));
  CHECK(!before("latest-epoch=100.ckpt", "latest-epoch=99.ckpt"));
  CHECK(before("model000475000.pt", "model1000000.pt"));
  CHECK((before("a", "b") && before("a", "a1") && before("a2b1", "a2b10") && !before("a", "a")));
  CHECK(before("x99999999999999999999999", "x100000000000000000000000"));
}

TEST_CASE("ACTOR: the checkpoint with the largest number, also beside .pt files and without opt.yaml") {
  const Folder f;
  for (const char* name :
       {"checkpoint_0900.pth.tar", "checkpoint_5000.pth.tar", "checkpoint_10000.pth.tar", "other.pt"})
    f.add(name);
  CHECK(f.run().system == "actor");
  CHECK(f.weights() == "checkpoint_10000.pth.tar");
  f.add("opt.yaml", "modeltype: cvae\nlatent_dim: 256\n");
  CHECK(std::get<std::int64_t>(f.run().option("latent_dim")->value) == 256);
  CHECK(f.run().parts.empty());
}

TEST_CASE("MDM: args.json and the last model, not its optimiser") {
  const Folder f;
  f.add("args.json", R"({"arch": "trans_enc", "diffusion_steps": 50})");
  for (const char* name : {"model000050000.pt", "model000475000.pt", "opt000475000.pt", "Mean.npy", "Std.npy"})
    f.add(name);
  CHECK(f.run().system == "mdm");
  CHECK(f.weights() == "model000475000.pt");
  CHECK(part_names(f.run()) == std::vector<std::string>{"mean", "std"});
}

TEST_CASE("Lightning: last.ckpt, else the latest epoch") {
  const Folder f;
  f.add("config.json", R"({"diffusion": {"denoiser": {"latent_dim": 32}}, "data": {}})");
  f.add("logs/checkpoints/latest-epoch=99.ckpt");
  f.add("logs/checkpoints/latest-epoch=1000.ckpt");
  f.add("motion_stats/mean.pt");
  f.add("motion_stats/std.pt");
  f.add("text_stats/mean.pt");
  CHECK(f.run().system == "stmc");
  CHECK(f.weights() == "logs/checkpoints/latest-epoch=1000.ckpt");
  CHECK(part_names(f.run()) == std::vector<std::string>{"motion_stats.mean", "motion_stats.std", "text_stats.mean"});
  f.add("logs/checkpoints/last.ckpt");
  CHECK(f.weights() == "logs/checkpoints/last.ckpt");

  const Folder temos;
  temos.add(".hydra/config.yaml", "model:\n  latent_dim: 256\n  ff_size: ${model.latent_dim}\n");
  temos.add("checkpoints/last.ckpt");
  CHECK(temos.run().system == "temos");
  CHECK(temos.weights() == "checkpoints/last.ckpt");
  CHECK(std::get<std::int64_t>(temos.run().option("model/ff_size")->value) == 256);
}

TEST_CASE("MotionDiffuse and TM2T: opt.txt says which") {
  const Folder f;
  f.add("opt.txt", "---- Options\ndiffusion_steps: 1000\nlatent_dim: 512\n---- End\n");
  f.add("model/ckpt_e009.tar");
  f.add("model/ckpt_e010.tar");
  f.add("meta/mean.npy");
  CHECK(f.run().system == "motiondiffuse");
  CHECK(f.weights() == "model/ckpt_e010.tar");
  CHECK(part_names(f.run()) == std::vector<std::string>{"meta.mean"});
  f.add("model/latest.tar");
  CHECK(f.weights() == "model/latest.tar");
  f.add("opt.txt", "---- Options\nd_model: 512\n---- End\n");
  CHECK(f.run().system == "tm2t");
  f.add("model/finest.tar");
  CHECK(f.weights() == "model/finest.tar");
}

TEST_CASE("TMR: one file for each module, last_weights before others") {
  const auto run = ml::find_run(golden / "tmr_run");
  CHECK(run.system == "tmr");
  CHECK(part_names(run) ==
        std::vector<std::string>{"motion_decoder", "motion_encoder", "stats.mean", "stats.std", "text_encoder"});
  CHECK(std::get<std::int64_t>(run.option("model/motion_encoder/latent_dim")->value) == 4);
  const auto file = ml::open_weights(golden / "tmr_run");
  CHECK(file.format() == "TMR run folder");
  CHECK(file.find("motion_encoder.tokens") != nullptr);
  CHECK(file.find("stats.std") != nullptr);

  const TemporaryFolder copy;  // a file that lies beside the modules is not one of them
  std::filesystem::copy(golden / "tmr_run", copy / "run", std::filesystem::copy_options::recursive);
  std::filesystem::copy_file(run.parts.at("motion_encoder"), std::filesystem::path(copy / "run") / "other.pt");
  CHECK(part_names(ml::find_run(copy / "run")) == part_names(run));
}

TEST_CASE("Hugging Face: whole, or in shards with an index") {
  const Folder f;
  f.add("config.json", R"({"model_type": "distilbert"})");
  write_tensors(f / "model-1.safetensors", {{"a", 1.0F}, {"b", 2.0F}});
  write_tensors(f / "model-2.safetensors", {{"c", 3.0F}, {"b", 9.0F}});
  const std::string index = "model.safetensors.index.json";
  f.add(index, R"({"metadata": {"total_size": 12}, "weight_map":
                  {"a": "model-1.safetensors", "b": "model-1.safetensors", "c": "model-2.safetensors"}})");
  CHECK(f.run().system == "hugging face");
  CHECK(f.weights() == index);
  const auto file = ml::open_weights(f.path);
  CHECK(file.format() == "shards");
  CHECK(file.names() == std::vector<std::string>{"a", "b", "c"});
  CHECK(number(file, "b") == 2);  // the other shard's b is not asked for
  CHECK(number(file, "c") == 3);

  const auto refused = [&](const char* text, const char* message) {
    f.add("bad.index.json", text);
    CHECK_ERROR(ml::open_weights(f / "bad.index.json"), message);
  };
  refused(R"({"weight_map": {"z": "model-1.safetensors"}})", "[motionlang.io.406]");
  refused(R"({"weight_map": {"a": "../model-1.safetensors"}})", "'../model-1.safetensors' is not a name of a file");
  refused(R"({"weight_map": {"a": ".."}})", "[motionlang.io.403]");
  refused(R"({"weight_map": {"a": "nothing.bin"}})", "[motionlang.io.401]");
  refused(R"({"weight_map": {"a": 3}})", "[motionlang.config.107]");
  refused(R"({"weight_map": {}})", "[motionlang.io.406]");
  refused(R"({})", "has no member 'weight_map'");
  write_tensors(f / "model.safetensors", {{"whole", 1.0F}});
  CHECK(ml::open_weights(f.path).names() == std::vector<std::string>{"whole"});
}

TEST_CASE("folders without a run, and options that cannot be read") {
  const Folder f;
  CHECK(f.run().system.empty());
  CHECK_ERROR(ml::open_weights(f.path), "[motionlang.io.404]");
  CHECK_ERROR(ml::find_run(f / "nowhere"), "[motionlang.io.401]");
  f.add("args.json", "{\"a\": ");
  CHECK_ERROR(f.run(), "[motionlang.io.403]");
}
