// The trainings of MDM-SMPL, MDM and MotionDiffuse: configurations, samples, losses, first weights, checkpoints, and
// the folder of a model.
#include <doctest/doctest.h>

#include <algorithm>

#include <motionlang/backend/usual.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/train/diffusion_items.hpp>
#include <motionlang/train/diffusion_losses.hpp>
#include <motionlang/train/diffusion_presets.hpp>
#include <motionlang/train/diffusion_systems.hpp>
#include <motionlang/train/diffusion_task.hpp>
#include <motionlang/train/diffusion_texts.hpp>
#include <motionlang/train/diffusion_training.hpp>
#include <motionlang/train/mdm_action_training.hpp>
#include <motionlang/weights/diffusion_training_config.hpp>
#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/own_text_encoder.hpp>

#include "../../support/check_error.hpp"
#include "../../support/motions_of_noise.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;
using ml::Index;

namespace {

/// Six motions of 45 random frames with two texts each, and two for validation.
ml::DescribedMotions random_motions(Index width) {
  return motions_of_noise(
      width, 6, 8, [](int) { return Index{45}; },
      [](int i, Index) {
        return std::vector<ml::DescribedText>{{i % 2 == 0 ? "a person walks." : "a person turns left.", {0, 45}},
                                              {"someone moves", {5, 30}}};
      });
}

/// Networks of a few numbers, four steps.
template <class Config>
Config tiny(Config c) {
  c.network.latent_dim = 8, c.network.ff_size = 8, c.network.num_layers = 2, c.network.num_heads = 2;
  c.text.width = 8, c.text.ff_size = 8, c.text.num_layers = 1, c.text.num_heads = 2, c.text.vocabulary = 40;
  c.optimiser.batch = 3, c.optimiser.epochs = 2, c.optimiser.schedule = "constant", c.optimiser.lr = 0.01;
  c.validation.every = 1;
  return c;
}
ml::MdmSmplTrainingConfig tiny_mdm_smpl() { return tiny(ml::mdm_smpl_preset("small")); }
ml::MdmTrainingConfig tiny_mdm() { return tiny(ml::mdm_preset("small")); }
ml::MotionDiffuseTrainingConfig tiny_motiondiffuse() {
  auto c = tiny(ml::motiondiffuse_preset("small"));
  c.network.text_latent_dim = 8, c.network.text_ff_size = 8, c.network.text_num_heads = 2;
  return c;
}

template <class Config>
void check_config(const Config& config) {
  const nlohmann::json document = ml::config_json(config);
  Config read;
  CHECK_NOTHROW(ml::read_config(read, ml::JsonView(document, "preset")));
  CHECK(nlohmann::json(ml::config_json(read)) == document);
  CHECK_NOTHROW(read.require_consistent());
}

/// Trains in one go, and in two parts from a checkpoint. Returns the folder of the model.
template <class Training, class... Arguments>
std::filesystem::path check_run(const TemporaryFolder& folder, const Arguments&... of) {
  ml::Trainer<Training> whole{Training(of...)}, first{Training(of...)}, second{Training(of...)};
  whole.run({.out = folder / "whole"});
  CHECK_THROWS_AS(
      first.run({.out = folder / "parts"}, {.prepare = {},
                                            .start = {},
                                            .progress = [](const ml::TrainingProgress& p) { return p.step < 2; },
                                            .stop = {},
                                            .finish = {}}),
      ml::cancelled);
  CHECK(second.run({.out = folder / "parts"}).steps == 2);
  CHECK(whole.record().losses.size() == 4);
  CHECK(whole.record().validations.size() == 2);
  CHECK(second.record().losses == whole.record().losses);
  CHECK(ml::read_file(folder / "parts/checkpoint.safetensors") ==
        ml::read_file(folder / "whole/checkpoint.safetensors"));
  whole.task().save(folder / "model", {{"license", "MIT"}, {"provenance", "a test"}});
  return folder / "model";
}

/// The reader of published models gives the texts and the network that were trained.
template <class Training>
void check_model(Training& task, const std::filesystem::path& folder) {
  const auto read = ml::load_diffusion_run<B>(folder);
  const auto& trained = task.result();
  const std::vector<std::string> texts{"a person turns left.", "", "someone WALKS"};
  auto said = (*trained.text_encoder)(texts);
  const auto heard = read.text_encoder.template encode<B>(texts);
  const auto close = [](const ml::Tensor<B, 2>& a, const ml::Tensor<B, 2>& b) {
    REQUIRE(a.shape() == b.shape());
    for (std::size_t i = 0; i < a.span().size(); ++i) CHECK(a.span()[i] == doctest::Approx(b.span()[i]).epsilon(1e-4));
  };
  close(heard.tokens.rows, said.tokens.rows);
  auto rng = ml::Philox{.seed = 1};
  const Index width = read.motion_normalizer.mean.size(0);
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({3 * 8, width}, rng), ml::Offsets::equal(3, 8));
  const std::vector<Index> t{0, 3, 9};
  close(read.denoiser(x, t, heard).rows, trained.denoiser(x, t, said).rows);
  CHECK(read.motion_normalizer.std.to_vector() == trained.motion_normalizer.std.to_vector());
  CHECK(read.diffusion.steps() == task.config().diffusion.steps);
}

}  // namespace

TEST_CASE("presets have the published numbers, and are the same after they were written and read") {
  const auto smpl = ml::mdm_smpl_preset("mdm-smpl-published");
  CHECK((smpl.optimiser.batch == 128 && smpl.optimiser.epochs == 10'000 && smpl.optimiser.weight_decay == 0.01));
  CHECK(ml::mdm_smpl_preset("mdm-smpl-paper").diffusion.schedule == "chen");
  const auto mdm = ml::mdm_preset("mdm-published"), mdm50 = ml::mdm_preset("mdm50-published");
  CHECK((mdm.updates == 600'000 && mdm.diffusion.steps == 1000 && mdm.optimiser.ema == 0));
  CHECK((mdm50.diffusion.steps == 50 && mdm50.optimiser.ema == 0.9999 && mdm50.network.mask_frames));
  CHECK(ml::mdm_preset("mdm50-published-bert").network.arch == "trans_dec");
  const auto diffuse = ml::motiondiffuse_preset("motiondiffuse-published");
  CHECK((diffuse.optimiser.clip_norm == 0.5 && diffuse.optimiser.lr == 2e-4 && diffuse.text.drop == 0));
  CHECK(ml::mdm_action_preset("mdm-actions-published").losses.fc == 1);
  for (const char* name : {"mdm-smpl-published", "mdm-smpl-paper", "small"}) check_config(ml::mdm_smpl_preset(name));
  for (const char* name : {"mdm-published", "mdm-published-kit", "mdm50-published", "mdm50-published-bert", "small"})
    check_config(ml::mdm_preset(name));
  for (const char* name : {"motiondiffuse-published", "motiondiffuse-paper", "small"})
    check_config(ml::motiondiffuse_preset(name));
  for (const char* name : {"mdm-actions-published", "small"}) check_config(ml::mdm_action_preset(name));
  CHECK_ERROR(ml::mdm_smpl_preset("x"), "[motionlang.config.103] preset 'x' is not mdm-smpl-published, ");
  CHECK_ERROR(ml::mdm_preset("x"), "preset 'x' is not mdm-published, ");
  CHECK_ERROR(ml::motiondiffuse_preset("x"), "preset 'x' is not motiondiffuse-published, ");
  CHECK_ERROR(ml::mdm_action_preset("x"), "preset 'x' is not mdm-actions-published or small");
}

TEST_CASE("settings that contradict each other are refused with their names") {
  auto smpl = ml::mdm_smpl_preset("small");
  smpl.diffusion.schedule = "linear";
  CHECK_ERROR(smpl.require_consistent(), "[motionlang.config.102] diffusion.schedule = linear");
  auto mdm = ml::mdm_preset("small");
  mdm.text.encoder = "distilbert";
  CHECK_ERROR(mdm.require_consistent(), "text.encoder = distilbert is for MDM with network.arch = trans_dec");
  mdm.network.arch = "trans_dec";
  CHECK_NOTHROW(mdm.require_consistent());
  CHECK_ERROR(ml::set_config(mdm, "network.arch=lstm"), "network: arch 'lstm' is not trans_enc, trans_dec or gru");
  CHECK_ERROR(ml::set_config(mdm, "text.drop=2"), "text: drop is 2, expected 0 or more, and less than 1");
  auto diffuse = ml::motiondiffuse_preset("small");
  diffuse.text.drop = 0.1;
  CHECK_ERROR(diffuse.require_consistent(), "[motionlang.config.101] text.drop is 0.1");
  auto actions = ml::mdm_action_preset("small");
  actions.clips.camera = false;
  CHECK_ERROR(actions.require_consistent(), "clips.camera = true");
  CHECK_ERROR(ml::require_text_source(ml::mdm_smpl_preset("mdm-smpl-published").text, "", false),
              "[motionlang.config.102] text.encoder = clip needs `text_encoder`");
  CHECK_ERROR(ml::require_text_source(ml::mdm_smpl_preset("small").text, "ViT-B-32.pt", false),
              "`text_encoder` is for text.encoder = clip or distilbert");
}

TEST_CASE("MDM-SMPL: a tenth of the samples has no text, and half of these is any short part of the motion") {
  const auto data = random_motions(1);
  const auto& m = data.training[0];
  int dropped = 0, parts = 0, cuts = 0;
  constexpr int count = 20'000;
  for (int i = 0; i < count; ++i) {
    const auto item = ml::mdm_smpl_item(m, 45, {}, 0.1, ml::Philox{.seed = 3}.split(static_cast<std::uint64_t>(i)));
    const auto& f = item.frames;
    CHECK((f.first >= 0 && f.length >= 10 && f.first + f.length <= 45));
    const bool of_first = f.first + f.length <= 45 && f.length >= 41, of_second = f.first >= 5 && f.length >= 27;
    if (item.text.empty()) {
      ++dropped;
      parts += f.length < 27;
    } else {
      CHECK((item.text == "someone moves" ? of_second && f.first + f.length <= 35 : of_first));
      cuts += f.length != 45 && f.length != 30;
    }
  }
  CHECK(std::abs(dropped - count * 0.1) < 3 * std::sqrt(count * 0.09));
  // 17 of the 36 lengths of short parts are below 27
  CHECK(parts == doctest::Approx(dropped * 0.5 * 17 / 36).epsilon(0.15));
  CHECK(cuts > count / 2);
}

TEST_CASE("MDM: whole units of four frames, in a third of the samples one less; MotionDiffuse: all frames") {
  const auto data = random_motions(1);
  const auto& m = data.training[0];
  std::map<Index, int> lengths;
  for (int i = 0; i < 9000; ++i) {
    const auto item = ml::mdm_item(m, ml::Philox{.seed = 3}.split(static_cast<std::uint64_t>(i)));
    ++lengths[item.frames.length];
    CHECK(item.frames.first + item.frames.length <= (item.text == "someone moves" ? 35 : 45));
  }
  CHECK(lengths.size() == 4);  // 44 and 40, 28 and 24
  CHECK(std::abs(lengths[40] + lengths[24] - 3000) < 3 * std::sqrt(2000));
  CHECK(ml::mdm_item(m, ml::Philox{.seed = 3}, 4, 20).frames.length == 20);
  CHECK(ml::motiondiffuse_item(m, ml::Philox{.seed = 3}, 20).frames.length == 20);
  CHECK(ml::first_item(m) == ml::DiffusionItem{"a person walks.", {0, 45}});
  CHECK(ml::first_item(m, 30).frames.length == 30);
}

TEST_CASE("the loss of MDM-SMPL counts padding, that of MDM weighs motions alike, that of MotionDiffuse frames") {
  const std::vector<Index> lengths{1, 3};
  const ml::Sequences<B> x(ml::Tensor<B, 2>::from(std::vector<float>{2, 0, 0, 0}, {4, 1}), ml::Offsets(lengths));
  const auto zeros = ml::Tensor<B, 2>::zeros({4, 1});
  CHECK(ml::padded_mse(x, zeros).item() == doctest::Approx(4.0 / 6));
  CHECK(ml::mean(ml::mse_per_sequence(x, zeros)).item() == doctest::Approx(4.0 / 2));
  CHECK(ml::mse(x.rows, zeros).item() == doctest::Approx(4.0 / 4));
  const ml::Sequences<B> padded(ml::Tensor<B, 2>::from(std::vector<float>{1, 9, 9, 2, 3, 4}, {6, 1}),
                                ml::Offsets{3, 3});
  CHECK(ml::without_padding(padded, lengths).rows.to_vector() == std::vector<float>{1, 2, 3, 4});
  CHECK_ERROR(ml::without_padding(padded, std::vector<Index>{4, 1}), "[motionlang.shape.203]");
  CHECK_ERROR(ml::without_padding(padded, std::vector<Index>{1}), "[motionlang.shape.204]");
}

TEST_CASE("the geometric terms of MDM: joints, steps of rotations, feet that stand") {
  const auto rows = [](Index frames, Index width, float value) {
    return ml::Sequences<B>(ml::Tensor<B, 2>::full({frames, width}, value), ml::Offsets{frames});
  };
  const auto x0 = rows(3, 8, 0), said = rows(3, 8, 1);
  std::vector<float> still(3 * 72), moving(3 * 72);
  for (std::size_t f = 0; f < 3; ++f) {
    moving[f * 72 + 3 * 7] = 0.5f * static_cast<float>(f);  // an ankle
    moving[f * 72 + 3 * 1] = 7;                             // no foot
  }
  const auto joints = rows(3, 72, 0);
  const ml::Sequences<B> said_joints(ml::Tensor<B, 2>::from(moving, {3, 72}), ml::Offsets{3});
  const auto terms = ml::mdm_action_losses(x0, said, joints, said_joints, 6).terms;
  REQUIRE(terms.size() == 4);
  CHECK(terms[0].value.item() == doctest::Approx(1));
  CHECK(terms[1].value.item() == doctest::Approx((0.25 + 1 + 3 * 49) / (3 * 72)));
  CHECK(terms[2].value.item() == doctest::Approx(0));
  CHECK(terms[3].value.item() == doctest::Approx(2 * 0.25 / (2 * 12)));
  // An ankle that moves in truth, too, does not stand.
  CHECK(ml::mdm_action_losses(x0, said, said_joints, said_joints, 6).terms[3].value.item() == 0);
  CHECK(ml::mdm_action_losses(x0, said, joints, said_joints, 6, {.rcxyz = 0, .vel = 0, .fc = 0}).terms.size() == 1);
}

TEST_CASE("all layers begin alike, and MotionDiffuse begins by predicting no noise") {
  const auto smpl = ml::MdmSmplSystem::make<B>(tiny_mdm_smpl(), 205, 8, ml::Philox{.seed = 1});
  const auto& layers = smpl.seqTransEncoder.layers;
  CHECK(layers[0].linear1.weight.to_vector() == layers[1].linear1.weight.to_vector());
  CHECK(layers[0].linear1.weight.to_vector() != layers[0].linear2.weight.to_vector());
  const auto diffuse = ml::MotionDiffuseSystem::make<B>(tiny_motiondiffuse(), 263, 8, ml::Philox{.seed = 1});
  auto rng = ml::Philox{.seed = 2};
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({9, 263}, rng), ml::Offsets{4, 5});
  const ml::TextFeatures<B> text{{ml::Tensor<B, 2>::randn({6, 8}, rng), ml::Offsets{3, 3}}, {2, 2}};
  const auto noise = diffuse(x, std::vector<Index>{1, 2}, text).rows.to_vector();
  CHECK(noise == std::vector<float>(noise.size()));
}

TEST_CASE("MDM-SMPL is trained, resumed with the same bits, and read like the published model") {
  const TemporaryFolder folder;
  const auto data = random_motions(205);
  auto config = tiny_mdm_smpl();
  const auto model = check_run<ml::MdmSmplTraining<A>>(folder, config, data);
  ml::Trainer trained{ml::MdmSmplTraining<A>(config, data)};
  trained.resume(folder / "whole/checkpoint.safetensors");
  check_model(trained.task(), model);
  config.features = "guoh3d";
  CHECK_ERROR(ml::MdmSmplTraining<A>(config, data), "features 'guoh3d' are not smplrifke");
  config = tiny_mdm_smpl();
  config.diffusion = {.steps = 30, .schedule = "chen"};
  ml::MdmSmplTraining<A>(config, data).save(folder / "chen", {{"license", "MIT"}, {"provenance", "a test"}});
  const auto chen = ml::load_diffusion_run<B>(folder / "chen");
  CHECK(chen.diffusion.beta(7) == ml::GaussianDiffusion(ml::ChenCosineSchedule{.steps = 30}).beta(7));
}

TEST_CASE("vectors of texts may come from an encoder that is not trained; MDM-SMPL normalises them") {
  const auto data = random_motions(205);
  auto config = tiny_mdm_smpl();
  config.text.encoder = "clip";
  CHECK_ERROR(ml::MdmSmplTraining<A>(config, data), "text.encoder = clip needs vectors of the texts");
  const TemporaryFolder folder;
  ml::EmbeddingCache cache(2);
  const std::vector<std::pair<std::string, std::vector<float>>> vectors{
      {"", {0, 0}}, {"a person walks.", {1, 5}}, {"a person turns left.", {3, 5}}, {"someone moves", {9, 9}}};
  for (const auto& [text, values] : vectors) cache.add(text, values);
  cache.write(folder.path, "own");
  const auto texts = ml::diffusion_texts<B>("stmc", config.text, false, folder / "own.npy", data);
  CHECK(texts.width == 2);
  ml::MdmSmplTraining<A> task(config, data, texts);
  const auto normalizer = task.result().text_normalizer;  // of the first texts of six motions
  CHECK(normalizer->mean.to_vector() == std::vector<float>{2, 5});
  CHECK(normalizer->std.to_vector()[0] == doctest::Approx(std::sqrt(6.0 / 5)));
  CHECK(normalizer->std.to_vector()[1] == 1);
  ml::Trainer trainer(std::move(task));
  CHECK(trainer.step() > 0);
  CHECK_ERROR(ml::diffusion_texts<B>("motiondiffuse", config.text, true, folder / "own.npy", data),
              "a cache does not say where texts end");
}

TEST_CASE("MDM is trained in each architecture, resumed with the same bits, and read like the published model") {
  const auto data = random_motions(263);
  for (const char* arch : {"trans_enc", "trans_dec", "gru"}) {
    CAPTURE(arch);
    const TemporaryFolder folder;
    auto config = tiny_mdm();
    config.network.arch = arch;
    config.network.mask_frames = config.network.arch == "trans_enc";
    const auto model = check_run<ml::MdmTraining<A>>(folder, config, data);
    ml::Trainer trained{ml::MdmTraining<A>(config, data)};
    trained.resume(folder / "whole/checkpoint.safetensors");
    check_model(trained.task(), model);
  }
}

TEST_CASE("MDM's average starts as the initial weights, and its runs are whole epochs") {
  const TemporaryFolder folder;
  const auto data = random_motions(263);
  auto config = tiny_mdm();
  config.ema_warmup = false, config.optimiser.ema = 0.9999, config.updates = 5, config.optimiser.batch = 4;
  ml::Trainer trainer{ml::MdmTraining<A>(config, data)};
  CHECK(trainer.task().steps() == 6);  // one batch of four of six motions in an epoch
  const std::string name = "average.denoiser.output_process.poseFinal.weight";
  const auto values = [&](const std::string& of) {
    trainer.save(folder / "checkpoint.safetensors");
    return ml::values_of<double>(ml::SafetensorsFile::open(folder / "checkpoint.safetensors").tensor(of));
  };
  auto expected = values(name);
  for (int step = 0; step < 3; ++step) {
    trainer.step();
    const auto now = values("model.denoiser.output_process.poseFinal.weight");
    for (std::size_t i = 0; i < now.size(); ++i) expected[i] = 0.9999 * expected[i] + 0.0001 * now[i];
  }
  const auto average = values(name);
  for (std::size_t i = 0; i < average.size(); ++i) CHECK(std::abs(average[i] - expected[i]) < 1e-7);
}

TEST_CASE("MotionDiffuse is trained, resumed with the same bits, and read like the published model") {
  const TemporaryFolder folder;
  const auto data = random_motions(263);
  const auto model = check_run<ml::MotionDiffuseTraining<A>>(folder, tiny_motiondiffuse(), data);
  ml::Trainer trained{ml::MotionDiffuseTraining<A>(tiny_motiondiffuse(), data)};
  trained.resume(folder / "whole/checkpoint.safetensors");
  check_model(trained.task(), model);
  // The deviations of root and contacts are divided by feat_bias.
  const auto plain = ml::statistics_of<B>(data.training, 263).std.to_vector();
  const auto biased = trained.task().result().motion_normalizer.std.to_vector();
  CHECK(biased[3] == doctest::Approx(plain[3] / 5));
  CHECK(biased[4] == plain[4]);
  CHECK(biased[262] == doctest::Approx(plain[262] / 5));
  auto all = tiny_motiondiffuse();
  all.network.no_eff = true;
  ml::Trainer padded{ml::MotionDiffuseTraining<A>(all, data)};
  CHECK(padded.step() > 0);
}

TEST_CASE("MDM of actions is trained, resumed with the same bits, and read like the published model") {
  const TemporaryFolder folder;
  auto config = ml::mdm_action_preset("small");
  config.clips.num_frames = 12;
  config.network.latent_dim = 8, config.network.ff_size = 8, config.network.num_layers = 1;
  config.network.num_heads = 2;
  config.optimiser.batch = 3, config.optimiser.epochs = 2, config.validation.every = 1;
  auto data = random_motions(config.clips.width());
  int number = 0;
  for (auto* part : {&data.training, &data.validation}) {
    for (auto& m : *part) m.texts = {{number++ % 2 == 0 ? "walk" : "turn", {0, 45}}};
  }
  const auto model = check_run<ml::MdmActionTraining<A>>(folder, config, data);
  const auto run = ml::find_run(model);
  CHECK(ml::is_mdm_action_run(run));
  const auto read = ml::load_mdm_action_run<B>(run);
  CHECK(read.labels == std::vector<std::string>{"turn", "walk"});
  CHECK(read.fps == 15);
  CHECK(read.model.guidance == 1);
  CHECK(read.model.generate(std::vector<Index>{1}, ml::Philox{.seed = 1}, {.steps = 2}).rows.shape() ==
        ml::Shape{12, 150});
  config.unconstrained = true;
  ml::MdmActionTraining<A>(config, data).save(folder / "any", {{"license", "MIT"}, {"provenance", "a test"}});
  CHECK(ml::load_mdm_action_run<B>(ml::find_run(folder / "any")).labels == std::vector<std::string>{"any"});
}

TEST_CASE("the draws of a part are those that its motions have in the whole batch") {
  const ml::Philox rng{.seed = 3};
  const auto all = ml::detail::diffusion_draws(rng, 0, 40, 50, 0.5),
             last = ml::detail::diffusion_draws(rng, 30, 10, 50, 0.5);
  CHECK(std::vector<Index>(all.t.begin() + 30, all.t.end()) == last.t);
  CHECK(std::vector<bool>(all.kept.begin() + 30, all.kept.end()) == last.kept);
  CHECK(*std::ranges::max_element(all.t) > 25);
  CHECK(*std::ranges::max_element(all.t) < 50);
  const auto kept = std::ranges::count(all.kept, true);
  CHECK(kept > 8);
  CHECK(kept < 32);
  CHECK(std::ranges::count(ml::detail::diffusion_draws(rng, 0, 40, 50, 0).kept, true) == 40);
}
