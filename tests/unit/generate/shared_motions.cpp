// Motions that several processes make together: the bits of one process. tests/systems/generate_motion.cpp has STMC.
#include <motionlang/generate/shared_motions.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

#include <motionlang/generate/samples.hpp>

#include "../../support/check_error.hpp"
#include "../../support/thread_processes.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

std::vector<ml::Timeline> turns(int count) {
  std::vector<ml::Timeline> out;
  for (int i = 0; i < count; ++i) out.push_back(ml::whole_body_timeline(std::to_string(0.1 * i), 30));
  return out;
}
bool same(const ml::Motion& a, const ml::Motion& b) {
  return a.local == b.local && a.root == b.root && a.fps == b.fps && a.skeleton == b.skeleton && a.name == b.name;
}

}  // namespace

TEST_CASE("a part of a list has the motions that it has in the list") {
  const fake::Latent model;
  const auto timelines = turns(5);
  const auto whole = ml::generate_motions(model, timelines, {.seed = 5});
  for (std::size_t first = 0; first < timelines.size(); ++first) {
    const auto part = std::span(timelines).subspan(first);
    const auto made = ml::generate_motions(model, part, {.seed = 5, .before = std::span(timelines).first(first)});
    for (std::size_t i = 0; i < made.size(); ++i) CHECK(same(made[i], whole[first + i]));
    if (first > 0) CHECK_FALSE(same(ml::generate_motion(model, part.front(), {.seed = 5}), whole[first]));
  }
}

TEST_CASE("several processes make the motions of one, and the first one counts those of all") {
  const fake::Latent model;
  const auto timelines = turns(5);
  const auto alone = ml::generate_samples(model, timelines, 2, {.seed = 5});
  for (const Index processes : {2, 3, 12}) {
    run_processes(processes, [&](const ThreadProcess& process) {
      std::vector<Index> done;
      auto progress = [&](Index d, Index total) {
        CHECK(total == 2 * 5 * 30 * 1000);  // thousandths of frames
        done.push_back(d);
        return true;
      };
      const auto made = ml::generate_samples(
          model, timelines, 2, {.seed = 5, .progress = progress, .communicator = ml::AnyCommunicator(process)});
      for (std::size_t t = 0; t < timelines.size(); ++t) {
        for (std::size_t s = 0; s < 2; ++s) CHECK(same(made[t][s], alone[t][s]));
      }
      if (process.rank() > 0) return;
      CHECK(std::is_sorted(done.begin(), done.end()));
      CHECK(done.back() == 2 * 5 * 30 * 1000);
    });
  }
}

TEST_CASE("processes with other timelines, and files of a whole list, are refused") {
  const fake::Latent model;
  const auto timelines = turns(4);
  const auto generate = [&](Index other) {
    run_processes(3, [&](const ThreadProcess& process) {
      const bool differs = process.rank() == other;
      ml::generate_motions(model, std::span(timelines).subspan(differs ? 1 : 0),
                           {.seed = 5, .communicator = ml::AnyCommunicator(process)});
    });
  };
  generate(-1);
  CHECK_ERROR(generate(1), "[motionlang.config.102] rank 1 of 3 has other timelines, options or kernels than rank 0");
  const auto with = [&](ml::GenerateOptions options) {
    fake::Model diffusion;
    diffusion.timelines = true;
    run_processes(2, [&](const ThreadProcess& process) {
      options.communicator = ml::AnyCommunicator(process);
      ml::generate_motions(diffusion, timelines, options);
    });
  };
  CHECK_ERROR(with({.noise = "n"}), "[motionlang.config.102] `noise` is a file of all timelines");
  CHECK_ERROR(with({.record = "r"}), "`record` is a file of all timelines, which one process makes, not 2");
  CHECK_ERROR(with({.reuse = "r"}), "`reuse` is a file");
}

TEST_CASE("processes that differ in a body part, a body, the timelines before or an option are refused") {
  fake::Model model;
  model.diffusion_steps = 10, model.timelines = true;
  struct Input {
    std::vector<ml::Timeline> timelines = turns(4), before{};
    ml::GenerateOptions options{.seed = 5, .keep = ml::KeptClip{synthetic::walk({.frames = 5}), {{0, 0.1}}}};
  };
  const auto generate = [&](const auto& change) {
    run_processes(2, [&](const ThreadProcess& process) {
      Input own;
      if (process.rank() == 1) change(own);
      own.options.before = own.before, own.options.communicator = ml::AnyCommunicator(process);
      ml::generate_motions(model, own.timelines, own.options);
    });
  };
  CHECK_NOTHROW(generate([](Input&) {}));
  const ml::BodyPartition body({.names = {"a", "b"}, .path = "a"});
  const std::function<void(Input&)> changes[] = {
      [](Input& i) { i.timelines[2].intervals[0].parts = ml::BodyParts{}.with(ml::BodyPart::head); },
      [&](Input& i) { i.timelines[3].body = body; },
      [](Input& i) { i.before = turns(1); },
      [](Input& i) { i.options.mode = ml::StmcMode::one_text, i.options.keep.reset(); },
      [](Input& i) { i.options.steps = 9; },
      [](Input& i) { i.options.steps = 0; },
      [](Input& i) { i.options.sampler = ml::SamplingOptions::Sampler::ddpm; },
      [](Input& i) { i.options.noise_scale = ml::NoiseScale::posterior_std; },
      [](Input& i) { i.options.guidance = 2; },
      [](Input& i) { i.options.overlap = 0.4; },
      [](Input& i) { i.options.cut_texts = false; },
      [](Input& i) { i.options.smooth = false; },
      [](Input& i) { i.options.fix_feet = false; },
      [](Input& i) { i.options.fix_floor = false; },
      [](Input& i) { i.options.overlay_arms = true; },
      [](Input& i) { i.options.keep.reset(); },
      [](Input& i) { i.options.keep->seconds[0].second = 0.2; },
      [](Input& i) { i.options.keep->parts = ml::BodyParts{}.with(ml::BodyPart::head); },
      [](Input& i) { i.options.keep->motion.root[1].x += 0.5; },
  };
  for (const auto& change : changes)
    CHECK_ERROR(generate(change), "[motionlang.config.102] rank 1 of 2 has other timelines, options or kernels");
}

TEST_CASE("parts follow each other and have about as much to make") {
  CHECK(ml::parts_of_timelines(turns(4), 2) == std::vector<Index>{0, 2, 4});
  CHECK(ml::parts_of_timelines(turns(1), 3) == std::vector<Index>{0, 0, 1, 1});
  CHECK(ml::parts_of_timelines({}, 2) == std::vector<Index>{0, 0, 0});
  auto uneven = turns(5);
  uneven[0].intervals[0].end = 120;  // as long as the others together
  CHECK(ml::parts_of_timelines(uneven, 2) == std::vector<Index>{0, 1, 5});
  for (Index ranks = 1; ranks < 9; ++ranks) {
    const auto parts = ml::parts_of_timelines(turns(7), ranks);
    CHECK(std::ssize(parts) == ranks + 1);
    CHECK((parts.front() == 0 && parts.back() == 7 && std::is_sorted(parts.begin(), parts.end())));
  }
}

TEST_CASE("a motion as a message") {
  ml::Motion motion = synthetic::walk({.frames = 5, .turn = 0.3});
  motion.name = "a walk";
  ml::MessageWriter out;
  ml::put_motion(out, motion);
  ml::MessageReader in(out.bytes());
  CHECK(same(ml::take_motion(in), motion));
  CHECK(in.at_end());
}
