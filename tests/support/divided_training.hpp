// SPDX-License-Identifier: MIT
/// Trainings whose batches are divided: checks that the parts add up to the batch, and that any number of processes and
/// threads makes the same bits.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <motionlang/backend/usual.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/train/trainer.hpp>

#include "motions_of_noise.hpp"
#include "temporary_folder.hpp"
#include "thread_processes.hpp"
#include "threads.hpp"

namespace divided {

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;
using ml::Index;

/// Seven motions of 45 and more random frames, and two for validation. Their texts are labels, too.
inline ml::DescribedMotions random_motions(Index width) {
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
  c.text.width = 8, c.text.vocabulary = 40;
  if constexpr (requires { c.text.num_layers; })  // a text encoder of its own
    c.text.ff_size = 8, c.text.num_layers = 1, c.text.num_heads = 2;
  return c;
}

/// Every term of the loss, and every gradient, of a batch is the sum over its parts.
/// update  of a step that has several
/// bound   of the difference, in shares of the largest derivative
template <class Task>
void check_parts(Task task, Index update = 0, double bound = 1e-5) {
  for (const Index step : {0, 1}) {
    const auto rng = ml::Philox{.seed = 11}.split(static_cast<std::uint64_t>(step));
    const auto parameters = ml::detail::parameters_of(task, step, update);
    const auto whole = [&] {
      if constexpr (ml::SeveralUpdatesTask<Task>)
        return task.part_loss(rng, step, {0, task.samples(step)}, {}, update);
      else
        return task.loss(rng, step, {});
    }();
    std::vector<float> expected;
    ml::append_gradients<A>(expected, parameters, ml::backward(whole.total()));
    const ml::AnyCommunicator alone;
    ml::PartThreads threads;
    ml::detail::StepParts<Task> parts{.task = task,
                                      .communicator = alone,
                                      .threads = threads,
                                      .rng = rng,
                                      .step = step,
                                      .micro_batch = 2,
                                      .recompute = false,
                                      .update = update};
    parts.dropout.reset();
    if (step == 0) REQUIRE(parts.parts > 1);
    const std::vector<float> sum = parts.sum();
    REQUIRE(parts.names.size() == whole.terms.size());
    for (std::size_t t = 0; t < whole.terms.size(); ++t) {
      CAPTURE(whole.terms[t].name);
      CHECK(parts.names[t] == whole.terms[t].name);
      CHECK(sum[1 + t] ==
            doctest::Approx(whole.terms[t].weight * static_cast<double>(whole.terms[t].value.item())).epsilon(1e-5));
    }
    CHECK(sum[0] == doctest::Approx(whole.total().item()).epsilon(1e-5));
    const auto got = std::span(sum).subspan(1 + whole.terms.size());
    REQUIRE(got.size() == expected.size());
    double largest = 0, error = 0;
    const auto reached = static_cast<std::size_t>(
        std::count_if(parameters.begin(), parameters.end(), [](const auto& t) { return t.data->node != nullptr; }));
    for (std::size_t k = reached; k < got.size(); ++k) {
      largest = std::max(largest, std::abs(static_cast<double>(expected[k])));
      error = std::max(error, std::abs(static_cast<double>(got[k]) - static_cast<double>(expected[k])));
    }
    CHECK(largest > 0);
    CHECK(error < bound * largest);
    for (std::size_t k = 0; k < reached; ++k) CHECK((got[k] > 0) == (expected[k] > 0));
  }
}

/// Trains with so many processes, and returns the bytes of the checkpoint. stop: a step after which the run stops.
template <class Make>
std::string trained(const Make& make, const std::filesystem::path& out, Index processes, Index micro_batch = 2,
                    Index stop = 0, ml::GradientWire wire = ml::GradientWire::exact) {
  std::vector<std::vector<float>> losses(static_cast<std::size_t>(processes));
  const auto run = [&] {
    run_processes(processes, [&](const ThreadProcess& process) {
      ml::Trainer trainer{make()};
      const ml::TrainingOptions options{
          .out = out, .micro_batch = micro_batch, .communicator = ml::AnyCommunicator(process), .wire = wire};
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

/// One part with the whole batch makes all updates of an undivided step, with the same bits.
template <class Make>
void check_one_part(const Make& make) {
  const TemporaryFolder folder;
  const auto checkpoint = [&](const char* out, Index micro_batch) {
    trained(make, folder / out, 1, micro_batch);
    return ml::SafetensorsFile::open(folder / out / "checkpoint.safetensors");
  };
  const auto whole = checkpoint("whole", 0), part = checkpoint("part", 5);
  CHECK(part.tensors().size() == whole.tensors().size());
  for (const ml::TensorView& t : whole.tensors())
    CHECK_MESSAGE(ml::values_of<float>(part.tensor(t.name)) == ml::values_of<float>(t), t.name);
  CHECK(part.metadata().at("training.terms") == whole.metadata().at("training.terms"));
}

}  // namespace divided
