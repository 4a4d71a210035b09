// Trainings whose batches are divided: the parts add up to the batch, and one, two, three and four processes with any
// number of threads make the same bits, also after a resume with another number.
#include <doctest/doctest.h>

#include <cmath>

#include <motionlang/backend/usual.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/train/actor_training.hpp>
#include <motionlang/train/diffusion_training.hpp>
#include <motionlang/train/mdm_action_training.hpp>
#include <motionlang/train/stmc_training.hpp>

#include "../support/check_error.hpp"
#include "../support/motions_of_noise.hpp"
#include "../support/small_stmc_training.hpp"
#include "../support/temporary_folder.hpp"
#include "../support/thread_processes.hpp"
#include "../support/threads.hpp"
#include "../support/training_set.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;
using ml::Index;

namespace {

/// Seven motions of 45 and more random frames, and two for validation. Their texts are labels, too.
ml::DescribedMotions random_motions(Index width) {
  return motions_of_noise(
      width, 7, 9, [](int i) { return Index{45 + 3 * i}; },
      [](int i, Index frames) {
        return std::vector<ml::DescribedText>{{i % 2 == 0 ? "walk" : "turn", {0, frames}}};
      });
}

/// Networks of a few numbers, batches of five, and four epochs.
template <class Config>
Config tiny(Config c) {
  c.network.latent_dim = 10, c.network.ff_size = 8, c.network.num_layers = 1, c.network.num_heads = 2;
  c.optimiser.batch = 5, c.optimiser.epochs = 4, c.optimiser.schedule = "constant", c.optimiser.lr = 0.01;
  c.validation.every = 2;
  return c;
}
template <class Config>
Config tiny_with_texts(Config c) {
  c = tiny(c);
  c.text.width = 8, c.text.ff_size = 8, c.text.num_layers = 1, c.text.num_heads = 2, c.text.vocabulary = 40;
  return c;
}

/// Every loss, and every gradient, of a batch is the sum over its parts.
template <class Task>
void check_parts(Task task) {
  for (const Index step : {0, 1}) {
    const auto rng = ml::Philox{.seed = 11}.split(static_cast<std::uint64_t>(step));
    const auto parameters = task.parameters();
    const Index samples = task.samples(step);
    const auto whole = task.loss(rng, step, {});
    std::vector<float> expected;
    ml::append_gradients<A>(expected, parameters, ml::backward(whole.total()));
    std::vector<double> terms(whole.terms.size());
    std::vector<double> sum(expected.size());
    for (Index i = 0; i < ml::part_count(samples, 2); ++i) {
      const auto part = task.part_loss(rng, step, ml::batch_part(i, samples, 2), {});
      REQUIRE(part.terms.size() == terms.size());
      for (std::size_t t = 0; t < terms.size(); ++t)
        terms[t] += part.terms[t].weight * static_cast<double>(part.terms[t].value.item());
      std::vector<float> list;
      ml::append_gradients<A>(list, parameters, ml::backward(part.total()));
      for (std::size_t k = 0; k < list.size(); ++k) sum[k] += static_cast<double>(list[k]);
    }
    for (std::size_t t = 0; t < terms.size(); ++t) {
      CAPTURE(whole.terms[t].name);
      CHECK(terms[t] == doctest::Approx(whole.terms[t].weight * static_cast<double>(whole.terms[t].value.item())));
    }
    double largest = 0, error = 0;
    const auto reached = static_cast<std::size_t>(
        std::count_if(parameters.begin(), parameters.end(), [](const auto& t) { return t.data->node != nullptr; }));
    for (std::size_t k = reached; k < sum.size(); ++k) {
      largest = std::max(largest, std::abs(static_cast<double>(expected[k])));
      error = std::max(error, std::abs(sum[k] - static_cast<double>(expected[k])));
    }
    CHECK(largest > 0);
    CHECK(error < 1e-5 * largest);
  }
}

/// Trains with so many processes, and returns the bytes of the checkpoint. stop: a step after which the run stops.
template <class Make>
std::string trained(const Make& make, const std::filesystem::path& out, Index processes, Index micro_batch = 2,
                    Index stop = 0) {
  std::vector<std::vector<float>> losses(static_cast<std::size_t>(processes));
  const auto run = [&] {
    run_processes(processes, [&](const ThreadProcess& process) {
      ml::Trainer trainer{make()};
      const ml::TrainingOptions options{
          .out = out, .micro_batch = micro_batch, .communicator = ml::AnyCommunicator(process)};
      ml::TrainingCallbacks callbacks;
      callbacks.progress = [&](const ml::TrainingProgress& p) {
        CHECK(process.rank() == 0);
        return p.step != stop;
      };
      trainer.run(options, callbacks);
      losses[static_cast<std::size_t>(process.rank())] = trainer.record().losses;
    });
  };
  if (stop > 0) {
    CHECK_THROWS_AS(run(), ml::cancelled);
  } else {
    run();
    for (const auto& l : losses) CHECK(l == losses.front());
  }
  return ml::read_file(out / "checkpoint.safetensors");
}

template <class Make>
void check_processes(const Make& make) {
  const TemporaryFolder folder;
  std::string one;
  {
    const Threads single(1);
    one = trained(make, folder / "1", 1);
  }
  for (const Index processes : {1, 2, 3, 4}) {
    CAPTURE(processes);
    const Threads two(2);
    CHECK(trained(make, folder / ("of" + std::to_string(processes)), processes) == one);
  }
  CHECK(trained(make, folder / "single samples", 2, 1) != one);  // another setting
  // Four processes, then one, then two.
  CHECK(trained(make, folder / "parts", 4, 2, 1) != one);
  CHECK(trained(make, folder / "parts", 1, 2, 3) != one);
  CHECK(trained(make, folder / "parts", 2) == one);
}

}  // namespace

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
}

TEST_CASE("the bundled model, with the summary of motions that belongs to its training only") {
  ml::StmcTrainingConfig config = small::stmc_training();
  config.steps = 6, config.batch = 5;
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
