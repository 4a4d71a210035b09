// Official run folders of the diffusion models: what they load as, what generation makes of it, and the errors when
// something is missing or does not fit.
#include <motionlang/weights/diffusion_folder.hpp>

#include "../support/check_error.hpp"
#include "../support/official_folders.hpp"
#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using ml::Index;
using official::B, official::Sizes;

namespace {

void write(const std::string& system, const fs::path& folder, const Sizes& sizes) {
  if (system == "stmc") official::write_stmc_run(folder, sizes);
  if (system == "mdm") official::write_mdm_run(folder, sizes);
  if (system == "motiondiffuse") official::write_motiondiffuse_run(folder, sizes);
}

/// Loads it and compares what it generates, bit for bit, with the model made of the same parts.
ml::PublishedStmc<B> check_generates(const std::string& system, const fs::path& folder, const Sizes& sizes) {
  const auto loaded = ml::load_diffusion_run<B>(folder);
  auto wanted = official::expected(system, sizes);
  ml::prepare(wanted.denoiser);
  for (const ml::Timeline& timeline : {small::one_text(20), small::several_tracks()}) {
    const auto a = loaded.generate(timeline, ml::Philox{.seed = 5}),
               b = wanted.generate(timeline, ml::Philox{.seed = 5});
    CHECK(a.shape() == ml::Shape{timeline.end(), loaded.layout.size});
    CHECK(small::is_finite(a));
    CHECK_MESSAGE(small::numbers(a) == small::numbers(b), system);
  }
  return loaded;
}

}  // namespace

TEST_CASE("STMC: config.json, logs/checkpoints/last.ckpt, motion_stats, text_stats") {
  const TemporaryFolder folder;
  const Sizes sizes = official::small();
  write("stmc", folder.path, sizes);
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "[motionlang.io.401]");
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "ViT-B-32.pt with bpe_simple_vocab_16e6.txt.gz");
  official::write_clip(folder / "clip", sizes);
  const auto loaded = check_generates("stmc", folder.path, sizes);
  CHECK(loaded.fps == 20);
  CHECK(loaded.diffusion.steps() == sizes.stmc_steps);

  const TemporaryFolder elsewhere;
  official::write_clip(elsewhere.path, sizes);
  fs::remove_all(folder / "clip");
  CHECK(ml::load_diffusion_run<B>(folder.path, {.text_encoder = elsewhere.path}).text_encoder.network.is_clip());
  CHECK(ml::load_diffusion_run<B>(folder.path, {.text_encoder = elsewhere / "ViT-B-32.pt"})
            .text_encoder.network.is_clip());
  fs::remove(elsewhere / "bpe_simple_vocab_16e6.txt");
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path, {.text_encoder = elsewhere.path}),
              "no tokenizer of the text encoder: put");
}

TEST_CASE("STMC without registers: the checkpoint has no tensor of them, and the options say so") {
  const TemporaryFolder folder;
  Sizes sizes = official::small();
  sizes.mdm_smpl.nb_registers = 0;
  write("stmc", folder / "run", sizes);
  official::write_clip(folder / "clip", sizes);
  CHECK(check_generates("stmc", folder / "run", sizes).denoiser.mdm_smpl->register_count() == 0);
  ml::pack_diffusion_run<B>(ml::find_run(folder / "run"), folder / "packed",
                            {.license = "none", .provenance = "drawn"});
  check_generates("stmc", folder / "packed", sizes);

  std::string config = ml::read_file(folder / "run/config.json");
  const std::size_t at = config.find("\"nb_registers\": 0");
  REQUIRE(at != std::string::npos);
  official::write_text(folder / "run/config.json", config.replace(at, 17, "\"registers\": 0"));  // no option states it
  CHECK_ERROR(ml::load_diffusion_run<B>(folder / "run"), "no tensor 'denoiser.registers'");
  sizes.mdm_smpl.nb_registers = 2;
  write("stmc", folder / "with", sizes);
  config = ml::read_file(folder / "with/config.json");
  official::write_text(folder / "with/config.json",
                       config.replace(config.find("\"nb_registers\": 2"), 17, "\"nb_registers\": 0"));
  CHECK_ERROR(ml::load_diffusion_run<B>(folder / "with"),
              "diffusion/denoiser/nb_registers is 0, tensor 'denoiser.registers'");
}

TEST_CASE("MDM: args.json, the last model, statistics of the data set; both transformers") {
  const TemporaryFolder folder;
  Sizes sizes = official::small();
  for (const bool decoder : {false, true}) {
    sizes.mdm.arch = decoder ? ml::MdmArch::trans_dec : ml::MdmArch::trans_enc;
    sizes.mdm.class_token = decoder ? ml::MdmClassToken::time_plus_text : ml::MdmClassToken::none;
    const auto run = folder / (decoder ? "humanml_trans_dec_512" : "humanml_trans_enc_512");
    write("mdm", run, sizes);
    official::write_clip(run / "clip", sizes);
    CHECK(check_generates("mdm", run, sizes).fps == 20);
  }
  const auto run = folder / "humanml_trans_enc_512";
  const std::string args = ml::read_file(run / "args.json");
  official::write_text(run / "args.json", "{\"context_len\": 20}");
  CHECK_ERROR(ml::load_diffusion_run<B>(run), "context_len: models that continue a motion (DiP) are not supported");
  official::write_text(run / "args.json", args);
  fs::create_directories(folder / "stats");
  fs::rename(run / "Mean.npy", folder / "stats/Mean.npy");
  fs::rename(run / "Std.npy", folder / "stats/Std.npy");
  CHECK_ERROR(ml::load_diffusion_run<B>(run), "put mean and std of the data set there (Mean.npy and Std.npy");
  CHECK(ml::load_diffusion_run<B>(run, {.statistics = folder / "stats"}).layout.size == 263);

  // With the vocabulary in Hugging Face's files texts are still cleaned as by OpenAI.
  fs::rename(folder / "stats/Mean.npy", run / "Mean.npy");
  fs::rename(folder / "stats/Std.npy", run / "Std.npy");
  fs::rename(run / "clip/bpe_simple_vocab_16e6.txt", run / "clip/merges.txt");
  nlohmann::json ids;
  const ml::ClipTokenizer openai(ml::parse_merges(official::bpe_vocabulary));
  for (const auto& piece : openai.vocabulary()) ids[piece] = ids.size();
  official::write_text(run / "clip/vocab.json", ids.dump());
  sizes.mdm.arch = ml::MdmArch::trans_enc, sizes.mdm.class_token = ml::MdmClassToken::none;
  CHECK(check_generates("mdm", run, sizes).text_encoder.tokenizer.clip()->options().cleaning ==
        ml::ClipCleaning::original);
}

TEST_CASE("MDM: the moving average where args.json says so; KIT-ML; models without texts") {
  const TemporaryFolder folder;
  Sizes sizes = official::small();
  write("mdm", folder.path, sizes);
  official::write_clip(folder / "clip", sizes);
  const auto model = folder / "model000475000.pt";
  TorchArchive both;
  both.begin("model");
  official::add_zeros(both, "nothing", {1});
  both.end();
  both.begin("model_avg");
  official::add_module(both, official::mdm(sizes));
  both.end();
  official::write_bytes(model, both.finish());
  const std::string args = ml::read_file(folder / "args.json");
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "[motionlang.io.406]");
  official::write_text(folder / "args.json", args.substr(0, args.size() - 1) + ", \"use_ema\": true}");
  check_generates("mdm", folder.path, sizes);

  sizes.mdm.nfeats = 251;
  const TemporaryFolder kit;
  write("mdm", kit.path, sizes);
  official::write_clip(kit / "clip", sizes);
  const auto loaded = ml::load_diffusion_run<B>(kit.path);
  CHECK((loaded.fps == 12.5 && loaded.layout.size == 251));
  CHECK(loaded.generate(small::one_text(20), ml::Philox{}).shape() == ml::Shape{20, 251});

  sizes.mdm.condition = ml::MdmCondition::action;
  write("mdm", kit.path, sizes);
  CHECK_ERROR(ml::load_diffusion_run<B>(kit.path), "a model without texts");
  sizes.mdm.nfeats = 150;
  write("mdm", kit.path, sizes);
  CHECK_ERROR(ml::load_diffusion_run<B>(kit.path), "motions of 150 numbers a frame");
}

TEST_CASE("MotionDiffuse: opt.txt, model/latest.tar with CLIP inside, meta") {
  const TemporaryFolder folder;
  const Sizes sizes = official::small();
  write("motiondiffuse", folder.path, sizes);
  const auto loaded = check_generates("motiondiffuse", folder.path, sizes);
  CHECK(loaded.guidance == 1);
  fs::remove(folder / "bpe_simple_vocab_16e6.txt");
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "CLIP is in the checkpoint, its vocabulary is not");
}

TEST_CASE("options that contradict the tensors, names that do not match") {
  const TemporaryFolder folder;
  const Sizes sizes = official::small();
  write("stmc", folder.path, sizes);
  official::write_clip(folder / "clip", sizes);
  const std::string config = ml::read_file(folder / "config.json");
  const auto refused = [&](const std::string& from, const std::string& to, const char* message) {
    std::string changed = config;
    REQUIRE(changed.find(from) != std::string::npos);
    changed.replace(changed.find(from), from.size(), to);
    official::write_text(folder / "config.json", changed);
    CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), message);
    CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), (folder / "config.json").c_str());
  };
  refused("\"latent_dim\": 32", "\"latent_dim\": 64",
          "diffusion/denoiser/latent_dim is 64, tensor 'denoiser.skel_embedding.weight'");
  refused("\"num_layers\": 2", "\"num_layers\": 3", "diffusion/denoiser/num_layers is 3");
  refused("\"num_layers\": 2", "\"num_layers\": \"two\"", "diffusion/denoiser/num_layers is 'two', not a whole number");
  refused("\"timesteps\": 5", "\"timesteps\": 0", "diffusion/timesteps is 0, not 1 ... 10000");
  refused("\"prediction\": \"x\"", "\"prediction\": \"eps\"", "diffusion/prediction is 'eps', expected x");
  official::write_text(folder / "config.json", config);

  TorchArchive archive;
  archive.begin("state_dict");
  ml::TensorStore store;
  store.add_module(official::mdm_smpl(sizes), "denoiser.");
  for (ml::TensorView t : store.views()) {
    if (t.name == "denoiser.to_skel_layer.bias") t.name = "denoiser.to_skel_layer.bais";
    archive.tensor(t.name, t);
  }
  archive.end();
  official::write_bytes(folder / "logs/checkpoints/last.ckpt", archive.finish());
  fs::remove(folder / "text_stats/mean.pt");
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "text_stats/mean.pt and std.pt are missing");
  official::write_bytes(folder / "text_stats/mean.pt",
                        TorchArchive::of_tensor(official::view_of(official::statistics(12, 2).mean)));
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path),
              "missing    denoiser.to_skel_layer.bias  (the file has denoiser.to_skel_layer.bais)");
  official::write_bytes(folder / "motion_stats/std.pt",
                        TorchArchive::of_tensor(official::view_of(official::statistics(12, 2).mean)));
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "tensor 'motion_stats.std' is (12), the model has 205 features");
}

TEST_CASE("packed as folders of ours they generate the same, with and without their text encoder") {
  const TemporaryFolder folder;
  const Sizes sizes = official::small();
  for (const std::string system : {"stmc", "mdm", "motiondiffuse"}) {
    const auto run = folder / system;
    write(system, run, sizes);
    official::write_clip(run / "clip", sizes);
    const ml::PackOptions options{.license = "none", .provenance = "drawn", .sources = {}, .text_encoder = true};
    const auto packed = folder / (system + "_packed");
    ml::pack_diffusion_run<B>(ml::find_run(run), packed, options);
    check_generates(system, packed, sizes);
    const ml::ModelFolder model = ml::read_model_folder(packed);
    CHECK((model.system == system && model.license == "none" && model.text_encoder == "clip"));
    CHECK(ml::open_weights(packed / "weights.safetensors").find("clip.visual.proj") == nullptr);
    const auto again = folder / (system + "_again");  // from a folder of ours, whose text encoder stays where it is
    ml::pack_diffusion_run<B>(ml::find_run(packed), again, {.license = "none", .provenance = "drawn"});
    CHECK(!fs::exists(again / "text_encoder"));
    CHECK(ml::read_file(again / "weights.safetensors") == ml::read_file(packed / "weights.safetensors"));
    CHECK_ERROR(ml::pack_diffusion_run<B>(ml::find_run(run), folder / "x", {.license = "", .provenance = "drawn"}),
                "license is empty");
  }
}

TEST_CASE("folders that hold no diffusion model") {
  const TemporaryFolder folder;
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "[motionlang.io.404]");
  official::write_text(folder / "opt.yaml", "modeltype: cvae\n");
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path),
              "of actor; diffusion models are those of stmc, mdm and motiondiffuse");
  fs::remove(folder / "opt.yaml");
  official::write_text(folder / "args.json", "{}");
  CHECK_ERROR(ml::load_diffusion_run<B>(folder.path), "no checkpoint of mdm");
}

// By hand, with --no-skip: writes, loads and runs every system at its published size.
TEST_CASE("published sizes" * doctest::skip()) {
  const TemporaryFolder folder;
  const Sizes sizes = official::published();
  for (const std::string system : {"stmc", "mdm", "motiondiffuse"}) {
    const auto run = folder / system;
    write(system, run, sizes);
    if (system != "motiondiffuse") official::write_clip(run / "clip", sizes);
    const auto loaded = ml::load_diffusion_run<B>(run);
    const auto motion = loaded.generate(small::one_text(100), ml::Philox{}, {.steps = 10});
    CHECK(small::is_finite(motion));
    MESSAGE(system, ": ", ml::parameter_count(loaded.denoiser), " parameters");
  }
}
