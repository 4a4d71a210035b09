// Trainings whose batches are divided: the parts add up to the batch, and one, two, three and four processes with any
// number of threads make the same bits, also after a resume with another number.
#include <doctest/doctest.h>

#include <motionlang/train/actor_training.hpp>
#include <motionlang/train/diffusion_training.hpp>
#include <motionlang/train/mdm_action_training.hpp>
#include <motionlang/train/stmc_training.hpp>

#include "../support/check_error.hpp"
#include "../support/divided_training.hpp"
#include "../support/small_stmc_training.hpp"
#include "../support/training_set.hpp"

using namespace divided;

TEST_CASE("MDM-SMPL") {
  const auto data = random_motions(205);
  const auto make = [&] { return ml::MdmSmplTraining<A>(tiny_with_texts(ml::mdm_smpl_preset("small")), data); };
  check_parts(make());
  check_processes(make);
}

TEST_CASE("MDM, with frames of its own and padded") {
  const auto data = random_motions(263);
  auto config = tiny_with_texts(ml::mdm_preset("small"));
  for (const bool mask : {true, false}) {
    config.network.mask_frames = mask;
    const auto make = [&] { return ml::MdmTraining<A>(config, data); };
    check_parts(make());
    if (mask) check_processes(make);
  }
}

TEST_CASE("MotionDiffuse, with frames of its own and padded") {
  const auto data = random_motions(263);
  auto config = tiny_with_texts(ml::motiondiffuse_preset("small"));
  config.network.text_latent_dim = 8, config.network.text_ff_size = 8, config.network.text_num_heads = 2;
  for (const bool padded : {false, true}) {
    config.network.no_eff = padded;
    const auto make = [&] { return ml::MotionDiffuseTraining<A>(config, data); };
    check_parts(make());
    if (!padded) check_processes(make);
  }
}

TEST_CASE("MDM of actions") {
  auto config = tiny(ml::mdm_action_preset("small"));
  config.clips.num_frames = 12;
  const auto data = random_motions(config.clips.width());
  const auto make = [&] { return ml::MdmActionTraining<A>(config, data); };
  check_parts(make());
  check_processes(make);
}

TEST_CASE("ACTOR, with windows of any length") {
  auto config = tiny(ml::actor_preset("small"));
  config.clips.num_frames = -2;
  config.losses.vel = 0.5, config.losses.velxyz = 0.5;
  const auto data = random_motions(config.clips.width());
  const auto make = [&] { return ml::ActorTraining<A>(config, data); };
  check_parts(make());
  check_processes(make);
  config.network.encoder = config.network.decoder = "frames";  // with noise for each frame
  check_parts(make());
}

TEST_CASE("the bundled model, with the summary of motions that belongs to its training only") {
  ml::StmcTrainingConfig config = small::stmc_training();
  config.updates = 6, config.optimiser.batch = 5;
  const auto make = [&] { return ml::StmcTraining<A>(config, captioned::training_set()); };
  check_parts(make());
  check_processes(make);
}

TEST_CASE("processes without parts, with other settings, and runs with other parts are refused") {
  const TemporaryFolder folder;
  const auto data = random_motions(205);
  auto config = tiny_with_texts(ml::mdm_smpl_preset("small"));
  const auto make = [&] { return ml::MdmSmplTraining<A>(config, data); };
  CHECK_ERROR(trained(make, folder / "out", 2, 0),
              "[motionlang.config.102] 2 processes share the parts of a batch: `micro_batch` is missing");
  CHECK_ERROR(trained(make, folder / "out", 1, -1), "[motionlang.config.101] `micro_batch` is -1");
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
  const auto seeds = [&] {
    run_processes(3, [&](const ThreadProcess& process) {
      auto own = config;
      own.optimiser.seed = process.rank() == 2 ? 2 : 1;
      ml::Trainer trainer{ml::MdmSmplTraining<A>(own, data)};
      trainer.run({.out = folder / "seeds", .micro_batch = 2, .communicator = ml::AnyCommunicator(process)});
    });
  };
  CHECK_ERROR(seeds(), "[motionlang.config.102] rank 2 of 3 differs from rank 0 before the first step");
  CHECK_FALSE(std::filesystem::exists(folder / "seeds/checkpoint.safetensors"));
  trained(make, folder / "out", 1, 2, 1);
  CHECK_ERROR(trained(make, folder / "out", 1, 1), "this run began with another training.micro_batch (2, not 1)");
  CHECK_ERROR(trained(make, folder / "out", 1, 0), "this run began with another training.micro_batch (2, not 0)");
}

TEST_CASE("rounded gradients: near those of one process, the same in all processes, and said in the checkpoint") {
  const TemporaryFolder folder;
  const auto data = random_motions(205);
  auto config = tiny_with_texts(ml::mdm_smpl_preset("small"));
  config.optimiser.batch = 4;
  const auto make = [&] { return ml::MdmSmplTraining<A>(config, data); };
  const auto bf16 = ml::GradientWire::bf16;
  const auto losses = [&](const char* out) {
    return ml::values_of<float>(ml::SafetensorsFile::open(folder / out / "checkpoint.safetensors").tensor("losses"));
  };
  trained(make, folder / "exact", 2, 1);
  trained(make, folder / "alone", 1, 1, 0, bf16);  // it sends nothing
  CHECK(losses("alone") == losses("exact"));
  for (const Index processes : {2, 3, 4}) {  // trained() compares the losses of all processes
    trained(make, folder / "bf16", processes, 1, 1, bf16);
    CHECK(trained(make, folder / "bf16", processes, 1, 0, bf16) !=
          ml::read_file(folder / "exact/checkpoint.safetensors"));
    const auto rounded = losses("bf16"), exact = losses("exact");
    REQUIRE(rounded.size() == exact.size());
    CHECK(rounded[0] == exact[0]);
    CHECK(rounded != exact);
    for (std::size_t i = 0; i < exact.size(); ++i) CHECK(rounded[i] == doctest::Approx(exact[i]).epsilon(0.05));
    const auto file = ml::SafetensorsFile::open(folder / "bf16/checkpoint.safetensors");
    CHECK(file.metadata().at("training.wire") == "bf16");
    if (processes < 4) std::filesystem::remove_all(folder / "bf16");
  }
  config.optimiser.epochs = 6;
  CHECK_ERROR(trained(make, folder / "bf16", 2, 1), "this run began with another training.wire (bf16, not exact)");
  CHECK_ERROR(trained(make, folder / "exact", 2, 1, 0, bf16),
              "this run began with another training.wire (nothing, not bf16)");
  CHECK_ERROR(trained(make, folder / "none", 1, 0, 0, bf16),
              "[motionlang.config.102] `wire` bf16 rounds the gradients");
}
