// The trainer on a task of two numbers: callbacks, checkpoints, validation, early stop.
#include <doctest/doctest.h>

#include <motionlang/backend/usual.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/train/actor_training.hpp>
#include <motionlang/train/classifier_training.hpp>
#include <motionlang/train/learner.hpp>
#include <motionlang/train/sinc_training.hpp>
#include <motionlang/train/teach_training.hpp>
#include <motionlang/train/temos_training.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>
#include <motionlang/train/tm2t_writer_training.hpp>
#include <motionlang/train/tmr_training.hpp>
#include <motionlang/train/trainer.hpp>
#include <motionlang/train/training_record.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

/// Learns y = 2 x from random numbers. Every second validation is worse than the one before.
struct Doubling {
  using B = ml::EigenBackend<float>;
  using A = ml::Autodiff<B>;

  ml::Index last = 6;
  ml::ValidationPlan plan{};
  double lr = 0.1;
  ml::Learner<ml::Linear<A>, ml::Linear<B>> learner{};
  ml::Index validations = 0, kept = 0;

  explicit Doubling(ml::Index steps = 6, ml::ValidationPlan p = {}) : last(steps), plan(p) {
    ml::Philox rng{.seed = 1};
    learner.average = ml::Linear<B>(1, 1, rng);
    learner.model = ml::convert<A>(learner.average);
  }
  ml::LossTerms<A> loss(ml::Philox rng, ml::Index, const ml::Context&) const {
    const auto x = ml::Tensor<A, 2>::randn({4, 1}, rng);
    ml::LossTerms<A> out;
    out.add("error", 1, ml::mse(learner.model(x), x * 2.0));
    return out;
  }
  void update(const ml::Gradients<A>& gradients, ml::Index step) { learner.update(gradients, lr, step); }
  std::uint64_t seed() const { return 3; }
  ml::Index steps() const { return last; }
  std::map<std::string, std::string> settings() const {
    return {{"model", "doubling"}, {"training.lr", ml::concat_text(lr)}};
  }
  void add_to(ml::TensorStore& store) const { learner.add_to(store); }
  void load(const ml::SafetensorsFile& file, ml::Index steps_done) { learner.load(file, steps_done); }
  std::vector<ml::Measure> validate() { return {{"loss", static_cast<double>(++validations)}}; }
  ml::ValidationPlan validation() const { return plan; }
  void keep_best() { ++kept; }
};
static_assert(ml::ValidatedTask<Doubling>);

}  // namespace

TEST_CASE("a run reports its start, every step and its end") {
  const TemporaryFolder folder;
  ml::Trainer trainer{Doubling()};
  std::vector<ml::Index> steps;
  std::string order;
  const auto done =
      trainer.run({.out = folder / "out"}, {.prepare = [&] { order += "prepare "; },
                                            .start =
                                                [&](const ml::TrainingStart& s) {
                                                  order += "start ";
                                                  CHECK((s.step == 0 && s.steps == 6 && !s.resumed));
                                                },
                                            .progress =
                                                [&](const ml::TrainingProgress& p) {
                                                  steps.push_back(p.step);
                                                  CHECK(p.record.steps() == p.step);
                                                  return true;
                                                },
                                            .stop = [&](ml::Index, const std::filesystem::path&) { order += "stop "; },
                                            .finish = [&](const ml::TrainingSummary&) { order += "finish"; }});
  CHECK(order == "prepare start finish");
  CHECK(steps == std::vector<ml::Index>{1, 2, 3, 4, 5, 6});
  CHECK((done.steps == 6 && done.last_step == 6 && !done.stopped_early));
  CHECK(trainer.record().losses.front() > trainer.record().losses.back());
  CHECK(std::filesystem::exists(folder / "out/checkpoint.safetensors"));
  CHECK(std::filesystem::exists(folder / "out/loss.svg"));
}

TEST_CASE("a run that is stopped goes on with the same numbers") {
  const TemporaryFolder folder;
  ml::Trainer whole{Doubling()};
  whole.run({.out = folder / "whole"});
  ml::Index stopped = 0;
  ml::Trainer first{Doubling()};
  CHECK_THROWS_AS(first.run({.out = folder / "parts"},
                            {.progress = [](const ml::TrainingProgress& p) { return p.step < 2; },
                             .stop = [&](ml::Index step, const std::filesystem::path&) { stopped = step; }}),
                  ml::cancelled);
  CHECK(stopped == 2);
  ml::Trainer second{Doubling()};
  bool resumed = false, prepared = false;
  const auto done = second.run({.out = folder / "parts"},
                               {.prepare = [&] { prepared = true; },
                                .start = [&](const ml::TrainingStart& s) { resumed = s.resumed && s.step == 2; }});
  CHECK(resumed);
  CHECK_FALSE(prepared);
  CHECK(done.steps == 4);
  CHECK(second.record().losses == whole.record().losses);
  CHECK(ml::read_file(folder / "parts/checkpoint.safetensors") ==
        ml::read_file(folder / "whole/checkpoint.safetensors"));
  ml::Trainer anew{Doubling()};
  CHECK(anew.run({.out = folder / "parts", .fresh = true}).steps == 6);
}

TEST_CASE("a checkpoint of other settings or of more steps is refused") {
  const TemporaryFolder folder;
  ml::Trainer trainer{Doubling()};
  trainer.run({.out = folder.path});
  CHECK_ERROR(ml::Trainer{Doubling(4)}.run({.out = folder.path}), "[motionlang.config.102] ");
  Doubling other(8);
  other.lr = 0.2;
  CHECK_ERROR(ml::Trainer{other}.run({.out = folder.path}), "this run began with another training.lr (0.1, not 0.2)");
  CHECK(ml::Trainer{other}.run({.out = folder.path, .other_settings = true}).steps == 2);
}

TEST_CASE("training stops early when the validation no longer gets better, and keeps the best weights") {
  const TemporaryFolder folder;
  ml::Trainer trainer{Doubling(20, {.every = 2, .patience = 3, .keep_best = true})};
  const auto done = trainer.run({.out = folder.path});
  CHECK(done.stopped_early);
  CHECK(done.last_step == 8);  // the first validation was the best, three more were not
  CHECK(trainer.record().validations.size() == 4);
  CHECK(trainer.record().best() == 0);
  CHECK(trainer.task().kept == 1);
}

TEST_CASE("a training that needs its whole batch has no parts") {
  const TemporaryFolder folder;
  static_assert(!ml::DividedTask<Doubling> && ml::DividedTask<ml::ActorTraining<Doubling::A>>);
  CHECK_ERROR(ml::Trainer{Doubling()}.run({.out = folder / "out", .micro_batch = 2}),
              "[motionlang.config.102] this training needs its whole batch at once");
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
}
