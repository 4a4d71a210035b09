// SPDX-License-Identifier: MIT
/// One training run of any system: steps, validation, early stop, curves, and checkpoints. A run that continues from a
/// checkpoint gives the same results.
///
///     Trainer trainer(TmrTraining<A>(config, data));
///     trainer.run({.out = "run"}, {.progress = [](const TrainingProgress& p) { return !asked_to_stop; }});
///
/// The folder `out` gets checkpoint.safetensors and loss.svg. A stopped run continues from there.
#pragma once

#include <chrono>       // minutes between checkpoints
#include <cmath>        // isfinite
#include <concepts>     // tasks
#include <filesystem>   // folders
#include <functional>   // callbacks
#include <map>          // settings
#include <string>       // names
#include <type_traits>  // tasks
#include <vector>       // measures

#include <motionlang/core/context.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/train/training_record.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A training that a Trainer can run.
///   A             the tape
///   loss          the terms of a step; the context brings the dropout of the step
///   update        one step of the optimisers
///   settings      everything that decides what a step computes, except the number of steps
///   add_to, load  the state
/// Laws    loss depends only on its generator, the step and the state; load takes what add_to gave
/// Models  TmrTraining, TemosTraining, SincTraining, TeachTraining, ActorTraining, ClassifierTraining, Tm2t...Training,
///         StmcTraining
template <class T>
concept TrainingTask = requires(T& task, const T& same, Philox rng, const Context& context,
                                const Gradients<typename T::A>& gradients, TensorStore& store,
                                const SafetensorsFile& file, Index step) {
  { task.loss(rng, step, context) } -> std::same_as<LossTerms<typename T::A>>;
  task.update(gradients, step);
  { same.seed() } -> std::convertible_to<std::uint64_t>;
  { same.steps() } -> std::convertible_to<Index>;
  { same.settings() } -> std::same_as<std::map<std::string, std::string>>;
  same.add_to(store);
  task.load(file, step);
};
/// Tasks that can measure how good they are.
///   validate    its first measure decides which weights are best
///   validation  when to validate
///   keep_best   remembers the current weights
template <class T>
concept ValidatedTask = TrainingTask<T> && requires(T& task, const T& same) {
  { task.validate() } -> std::same_as<std::vector<Measure>>;
  { same.validation() } -> std::convertible_to<ValidationPlan>;
  task.keep_best();
};

struct TrainingOptions {
  std::filesystem::path out = "training";  // folder of checkpoint and curves
  double save_minutes = 5;                 // between checkpoints
  bool fresh = false;                      // begin a new run even if there is a checkpoint
  bool other_settings = false;             // continue even if the checkpoint has other settings
  bool recompute = false;  // layers are recomputed instead of kept: the same results, less memory, more time
};

/// The start of a run.
struct TrainingStart {
  Index step = 0, steps = 0;  // the steps done, and all steps
  bool resumed = false;       // from a checkpoint
};
/// The state after a step.
struct TrainingProgress {
  Index step = 0, steps = 0;  // the steps done, and all steps
  double loss = 0;            // smoothed
  const TrainingRecord& record;
};
/// The result of a run.
struct TrainingSummary {
  Index steps = 0;  // of this run, without those before a checkpoint
  Index last_step = 0;
  double seconds = 0;
  bool stopped_early = false;  // because the validation no longer improved
};
/// The reports of a run; any of them may be empty.
///   prepare   for a new run, before its first checkpoint
///   start     before the first step
///   progress  after every step; false: the run is saved and ends with `cancelled`
///   stop      the run was saved because `progress` returned false
///   finish    after the last step, when the run is saved
struct TrainingCallbacks {
  std::function<void()> prepare{};
  std::function<void(const TrainingStart&)> start{};
  std::function<bool(const TrainingProgress&)> progress{};
  std::function<void(Index step, const std::filesystem::path& checkpoint)> stop{};
  std::function<void(const TrainingSummary&)> finish{};
};

/// Every step depends on the state and the step's number only. So a run that was stopped and resumed gives the same
/// results as one that was not.
template <TrainingTask Task>
class Trainer {
 public:
  explicit Trainer(Task task) : task_(std::move(task)) {}

  Task& task() { return task_; }
  const Task& task() const { return task_; }
  const TrainingRecord& record() const { return record_; }
  Index steps_done() const { return record_.steps(); }

  /// One optimiser step; returns the loss. Throws numeric_error 301 if it is not finite.
  double step();
  bool finished() const {
    if (steps_done() >= task_.steps()) return true;
    if constexpr (ValidatedTask<Task>) return record_.gives_up(task_.validation());
    return false;
  }

  /// Everything that is needed to continue, in float32. The file appears once it is complete.
  void save(const std::filesystem::path& checkpoint) const;
  /// Continues where `checkpoint` stopped. Throws config_error 102 if that run had other settings, data or sizes
  /// (`with_other_settings`: other sizes or data), io_error 406, 407 if tensors are missing or wrong.
  void resume(const std::filesystem::path& checkpoint, bool with_other_settings = false);

  /// All steps, from the checkpoint in the folder if there is one. Saves regularly, and at the end.
  /// Throws  cancelled if `progress` returns false, after saving; config_error 102 for a checkpoint with other settings
  ///         or more steps; what step, save and resume throw
  TrainingSummary run(const TrainingOptions& options, const TrainingCallbacks& callbacks = {});

 private:
  void validate();

  Task task_;
  TrainingRecord record_;
  bool recompute_ = false;
};

/// A complete training: the run, then the folder of the model, out/model. `about`: license and provenance, which are
/// required, data, command, ... for its config.json. Throws what Trainer::run and the task's save throw.
template <TrainingTask Task>
TrainingSummary train(Task task, const TrainingOptions& options, const std::map<std::string, std::string>& about,
                      const TrainingCallbacks& callbacks = {}) {
  Trainer<Task> trainer(std::move(task));
  const TrainingSummary summary = trainer.run(options, callbacks);
  trainer.task().save(options.out / "model", about);
  return summary;
}

template <TrainingTask Task>
double Trainer<Task>::step() {
  const Index k = steps_done();
  const auto rng = Philox{.seed = task_.seed()}.split("step").split(static_cast<std::uint64_t>(k));
  const auto terms = task_.loss(rng, k, {.dropout = rng.split("dropout"), .recompute = recompute_});
  const auto loss = terms.total();
  const double value = static_cast<double>(loss.item());
  if (!std::isfinite(value)) raise<numeric_error>(301, "training: the loss of step ", k, " is ", value);
  task_.update(backward(loss), k);
  std::vector<std::string> names;
  std::vector<float> values;
  for (const auto& t : terms.terms) {
    names.push_back(t.name);
    values.push_back(static_cast<float>(t.weight * static_cast<double>(t.value.item())));
  }
  record_.add(static_cast<float>(value), names, values);
  validate();
  return value;
}

template <TrainingTask Task>
void Trainer<Task>::validate() {
  if constexpr (ValidatedTask<Task>) {
    const ValidationPlan plan = task_.validation();
    if (plan.every == 0 || (steps_done() % plan.every != 0 && steps_done() != task_.steps())) return;
    record_.validations.push_back({steps_done(), task_.validate()});
    if (plan.keep_best && record_.best() + 1 == std::ssize(record_.validations)) task_.keep_best();
  }
}

template <TrainingTask Task>
void Trainer<Task>::save(const std::filesystem::path& checkpoint) const {
  TensorStore store;
  auto metadata = task_.settings();
  task_.add_to(store);
  record_.add_to(store, metadata);
  write_safetensors(checkpoint, store.views(), metadata);
}

template <TrainingTask Task>
void Trainer<Task>::resume(const std::filesystem::path& checkpoint, bool with_other_settings) {
  const auto file = SafetensorsFile::open(checkpoint);
  require_same_settings(file, task_.settings(), with_other_settings);
  record_.load(file);
  task_.load(file, steps_done());
}

template <TrainingTask Task>
TrainingSummary Trainer<Task>::run(const TrainingOptions& o, const TrainingCallbacks& callbacks) {
  recompute_ = o.recompute;
  std::filesystem::create_directories(o.out);
  const auto checkpoint = o.out / "checkpoint.safetensors";
  auto keep = [&] {
    save(checkpoint);
    if (steps_done() > 0) write_file(o.out / "loss.svg", std::string_view(record_.curves()));
  };
  const bool resumed = !o.fresh && std::filesystem::exists(checkpoint);
  if (resumed) {
    resume(checkpoint, o.other_settings);
    if (steps_done() > task_.steps())
      raise<config_error>(102, checkpoint.string(), " has ", counted(steps_done(), "step"), ", ", task_.steps(),
                          " are asked for: `fresh` starts anew, another `out` keeps both");
  } else {
    if (callbacks.prepare) callbacks.prepare();
    keep();
  }
  const Index first = steps_done();
  if (callbacks.start) callbacks.start({first, task_.steps(), resumed});
  const auto began = std::chrono::steady_clock::now();
  auto saved = began;
  double smoothed = 0;
  while (!finished()) {
    const double loss = step();
    smoothed = smoothed == 0 ? loss : 0.98 * smoothed + 0.02 * loss;
    const bool go_on = !callbacks.progress || callbacks.progress({steps_done(), task_.steps(), smoothed, record_});
    const auto now = std::chrono::steady_clock::now();
    if (!go_on || now - saved > std::chrono::duration<double>(60 * o.save_minutes)) {
      keep();
      saved = now;
    }
    if (!go_on) {
      if (callbacks.stop) callbacks.stop(steps_done(), checkpoint);
      detail::throw_exception(cancelled());
    }
  }
  keep();
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - began;
  const TrainingSummary summary{steps_done() - first, steps_done(), time.count(), steps_done() < task_.steps()};
  if (callbacks.finish) callbacks.finish(summary);
  return summary;
}

MOTIONLANG_NAMESPACE_END
