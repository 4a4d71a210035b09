// One training run of whatever can be trained: steps, validation, early stop, checkpoints from which it goes on with
// the same numbers, curves.
#pragma once

#include <chrono>
#include <concepts>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <motionlang/core/context.hpp>
#include <motionlang/loss/loss_terms.hpp>

#include "../formatted.hpp"
#include "../progress_bar.hpp"
#include "learner.hpp"

namespace program {

struct RunOptions {
  std::filesystem::path out = "training";  // folder of checkpoint and curves
  double save_minutes = 5;
  bool fresh = false;           // whatever checkpoint there is
  bool other_settings = false;  // go on although the checkpoint began with other numbers
  bool recompute = false;       // layers are calculated again instead of kept: the same numbers, less memory, more time
};

inline constexpr const char* about_recompute =
    "Calculate layers again instead of keeping what is inside them: the same numbers from a third to a half of the "
    "memory, in about half as much time again";

/// What a validation found.
struct Measure {
  std::string name;
  double value = 0;
  bool larger_is_better = false;
};
struct Validation {
  ml::Index step = 0;
  std::vector<Measure> measures;  // the first decides which weights are the best
};

/// When to validate, and when to stop because of it.
struct ValidationPlan {
  ml::Index every = 0;     // steps; 0: never
  ml::Index patience = 0;  // validations without a better one before training stops; 0: never
  bool keep_best = false;  // export the weights of the best validation, not the last
};

/// What a run has seen so far.
struct TrainingRecord {
  std::vector<float> losses;       // of every step
  std::vector<std::string> terms;  // of the loss, those of the last step
  std::vector<float> term_values;  // with their weights, (steps, terms): of the last steps that had these terms
  std::vector<Validation> validations;

  ml::Index steps() const { return std::ssize(losses); }
  /// The number of the best validation, -1 without one.
  ml::Index best() const;
  bool gives_up(const ValidationPlan& plan) const;
  void add(float loss, const std::vector<std::string>& names, std::span<const float> values);
  void add_to(ml::TensorStore& store, std::map<std::string, std::string>& metadata) const;
  void load(const ml::SafetensorsFile& file);
  /// Loss of training and validation, its terms and the other measures below it.
  std::string curves() const;
};

/// Throws config_error 102 for the first setting in which a checkpoint differs; "training.*" may, where that is wanted.
void require_same_settings(const ml::SafetensorsFile& checkpoint, const std::map<std::string, std::string>& settings,
                           bool with_other_settings);

/// What can be trained.
/// loss       the terms of a step, from the step's own generator: it may depend on nothing but that, the step and the
///            state; the context brings the dropout of the step
/// update     one step of the optimisers
/// settings   everything that decides what a step computes, except the number of steps
/// add_to, load   the state
template <class T>
concept TrainingTask = requires(T& task, const T& same, ml::Philox rng, const ml::Context& context,
                                const ml::Gradients<TrainingTape>& gradients, ml::TensorStore& store,
                                const ml::SafetensorsFile& file, ml::Index step) {
  { task.loss(rng, step, context) } -> std::same_as<ml::LossTerms<TrainingTape>>;
  task.update(gradients, step);
  { same.seed() } -> std::convertible_to<std::uint64_t>;
  { same.steps() } -> std::convertible_to<ml::Index>;
  { same.settings() } -> std::same_as<std::map<std::string, std::string>>;
  same.add_to(store);
  task.load(file, step);
};
/// Tasks that can tell how good they are.
/// validate    its first measure is watched
/// keep_best   remembers the weights as they are
template <class T>
concept ValidatedTask = TrainingTask<T> && requires(T& task, const T& same) {
  { task.validate() } -> std::same_as<std::vector<Measure>>;
  { same.validation() } -> std::convertible_to<ValidationPlan>;
  task.keep_best();
};

/// Every step depends on the state and the step's number only, so that a run which is stopped and resumed gives the
/// numbers of one that was not.
template <TrainingTask Task>
class Trainer {
 public:
  explicit Trainer(Task task) : task_(std::move(task)) {}

  Task& task() { return task_; }
  const Task& task() const { return task_; }
  const TrainingRecord& record() const { return record_; }
  ml::Index steps_done() const { return record_.steps(); }

  /// One optimiser step; returns the loss. Throws numeric_error 301 if it is not finite.
  double step() {
    const ml::Index k = steps_done();
    const auto rng = ml::Philox{.seed = task_.seed()}.split("step").split(static_cast<std::uint64_t>(k));
    const auto terms = task_.loss(rng, k, {.dropout = rng.split("dropout"), .recompute = recompute_});
    const auto loss = terms.total();
    const double value = static_cast<double>(loss.item());
    if (!std::isfinite(value)) ml::raise<ml::numeric_error>(301, "training: the loss of step ", k, " is ", value);
    task_.update(ml::backward(loss), k);
    std::vector<std::string> names;
    std::vector<float> values;
    for (const auto& t : terms.terms) {
      names.push_back(t.name);
      values.push_back(static_cast<float>(t.weight * static_cast<double>(t.value.item())));
    }
    record_.add(static_cast<float>(value), names, values);
    if constexpr (ValidatedTask<Task>) {
      const ValidationPlan plan = task_.validation();
      if (plan.every > 0 && (steps_done() % plan.every == 0 || steps_done() == task_.steps())) {
        record_.validations.push_back({steps_done(), task_.validate()});
        if (plan.keep_best && record_.best() + 1 == std::ssize(record_.validations)) task_.keep_best();
      }
    }
    return value;
  }
  bool finished() const {
    if (steps_done() >= task_.steps()) return true;
    if constexpr (ValidatedTask<Task>) return record_.gives_up(task_.validation());
    return false;
  }

  /// Everything that is needed to go on, in float32.
  void save(const std::filesystem::path& checkpoint) const {
    ml::TensorStore store;
    auto metadata = task_.settings();
    task_.add_to(store);
    record_.add_to(store, metadata);
    ml::write_safetensors(checkpoint, store.views(), metadata);
  }
  /// Goes on where `checkpoint` stopped. Throws config_error 102 if that run had other settings, data or sizes
  /// (`with_other_settings`: other sizes or data), io_error 406, 407 if tensors are missing or wrong.
  void resume(const std::filesystem::path& checkpoint, bool with_other_settings = false) {
    const auto file = ml::SafetensorsFile::open(checkpoint);
    require_same_settings(file, task_.settings(), with_other_settings);
    record_.load(file);
    task_.load(file, steps_done());
  }

  /// All steps, from the checkpoint in the folder if there is one; `begin` prepares a run that starts anew. Saves now
  /// and then, when it is done, and on Ctrl-C, which ends it with `cancelled`.
  template <class Begin>
  void run(const RunOptions& o, Begin begin) {
    recompute_ = o.recompute;
    std::filesystem::create_directories(o.out);
    const auto checkpoint = o.out / "checkpoint.safetensors";
    auto keep = [&] {
      save(checkpoint);
      if (steps_done() > 0) ml::write_file(o.out / "loss.svg", record_.curves());
    };
    if (!o.fresh && std::filesystem::exists(checkpoint)) {
      resume(checkpoint, o.other_settings);
      if (steps_done() > task_.steps())
        ml::raise<ml::config_error>(102, checkpoint.string(), " has ", ml::counted(steps_done(), "step"), ", ",
                                    task_.steps(), " are asked for: --fresh starts anew, another --out keeps both");
      std::printf("going on at step %td of %td\n", steps_done(), task_.steps());
    } else {
      begin();
      keep();
    }
    ProgressBar bar("training", steps_done());
    const ml::Index first = steps_done();
    const auto began = std::chrono::steady_clock::now();
    auto saved = began;
    double shown = 0;
    while (!finished()) {
      const double loss = step();
      shown = shown == 0 ? loss : 0.98 * shown + 0.02 * loss;
      bar.note(formatted("loss %.4g", shown) + validation_note());
      const bool go_on = bar(steps_done(), task_.steps());
      const auto now = std::chrono::steady_clock::now();
      if (!go_on || now - saved > std::chrono::duration<double>(60 * o.save_minutes)) {
        keep();
        saved = now;
      }
      if (!go_on) {
        bar.finish();
        std::fprintf(stderr, "stopped at step %td; the same command goes on from %s\n", steps_done(),
                     checkpoint.string().c_str());
        throw ml::cancelled();
      }
    }
    bar.finish();
    if (steps_done() < task_.steps())
      std::printf("stopped early at step %td: the validation no longer gets better\n", steps_done());
    keep();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - began;
    std::printf("trained  %s in %s\n", ml::counted(steps_done() - first, "step").c_str(),
                ProgressBar::clock(time.count()).c_str());
  }

 private:
  std::string validation_note() const {
    if (record_.validations.empty()) return "";
    std::string text = "  validation";
    for (const Measure& m : record_.validations.back().measures) text += formatted(" %s %.4g", m.name.c_str(), m.value);
    return text;
  }

  Task task_;
  TrainingRecord record_;
  bool recompute_ = false;
};

}  // namespace program
