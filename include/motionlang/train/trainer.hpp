// SPDX-License-Identifier: MIT
/// One training run of any system: steps, validation, early stop, curves, and checkpoints. A run that continues from a
/// checkpoint gives the same results.
///
///     Trainer trainer(TmrTraining<A>(config, data));
///     trainer.run({.out = "run"}, {.progress = [](const TrainingProgress& p) { return !asked_to_stop; }});
///
/// The folder `out` gets checkpoint.safetensors and loss.svg. A stopped run continues from there.
///
/// A batch is cut into parts of `micro_batch` samples if that is not 0. Several processes may share the parts
/// (train/communicator.hpp), and any number of processes and threads gives the same bits. So a run may be resumed with
/// another number. The results differ from those of whole batches by rounding and by the masks of dropout. Only with
/// `wire` bf16 do they depend on the number of processes.
///
/// Messages begin when the last part of a rank is computed, and do not overlap with computing. A rank adds the
/// gradients of its own parts, so it sends nothing between them. The gradients of the last part are ready layer by
/// layer, while its backward pass goes on, and so at most that pass could hide the first half of the messages. For TMR
/// in 8 processes and 10 Gbit/s these are 0.06 s of a step of 1.2 s (examples/training/MACHINES.md).
#pragma once

#include <algorithm>    // count_if, find_if
#include <chrono>       // minutes between checkpoints
#include <cmath>        // isfinite
#include <concepts>     // tasks
#include <filesystem>   // folders
#include <functional>   // callbacks
#include <map>          // settings
#include <optional>     // parts of other processes
#include <string>       // names
#include <type_traits>  // tasks
#include <utility>      // exchange
#include <vector>       // measures

#include <motionlang/core/context.hpp>
#include <motionlang/core/option_error.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/communicator.hpp>
#include <motionlang/train/compared_parts.hpp>
#include <motionlang/train/meeting_parts.hpp>
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
/// Trainings whose loss is a sum over the samples of a batch, so that parts of a batch can be computed apart.
/// Contrastive losses are not such sums: see ComparingTask.
///   samples     of the batch of a step
///   part_loss   the terms of some of these samples
///   parameters  the tensors that `update` changes
/// Laws    the terms of all parts of a batch, with their weights, add up to those of `loss`, up to rounding and the
///         masks of dropout; all parts have the same terms
/// Models  DiffusionTraining, MdmActionTraining, ActorTraining, StmcTraining, TemosTraining, SincTraining,
///         TeachTraining, ClassifierTraining, Tm2t...Training, GuoMovementTraining
template <class T>
concept DividedTask = TrainingTask<T> &&
    requires(T& task, Philox rng, const Context& context, const BatchPart& part, Index step) {
  { task.samples(step) } -> std::convertible_to<Index>;
  { task.part_loss(rng, step, part, context) } -> std::same_as<LossTerms<typename T::A>>;
  { task.parameters() } -> std::same_as<std::vector<ModuleTensor<typename T::A>>>;
};
/// Divided trainings whose parts meet, because a network normalises by the statistics of the whole batch
/// (train/meeting_parts.hpp). The context has `sums` for them.
///   parts_meet        false for steps whose parts need not meet
///   batch_statistics  the tensors that part_loss changes
/// Models  ClassifierTraining, Tm2tTokenizerTraining
template <class T>
concept MeetingTask = DividedTask<T> && requires(T& task, const T& same, Index step) {
  { same.parts_meet(step) } -> std::convertible_to<bool>;
  { task.batch_statistics() } -> std::same_as<std::vector<ModuleTensor<typename T::A>>>;
};
/// Trainings that make several updates in a step, each with a loss of its own by the weights that the one before has
/// changed. `loss` makes all but the last one itself.
///   updates    the number in a step
///   part_loss  the terms of some samples for one of these updates
/// Laws    those of DividedTask, for each update
/// Models  Tm2tWriterTraining, Tm2tTokenizerTraining
template <class T>
concept SeveralUpdatesTask = DividedTask<T> && requires(T& task, const T& same, Philox rng, const Context& context,
                                                        const BatchPart& part, Index step, Index update) {
  { same.updates(step) } -> std::convertible_to<Index>;
  { task.part_loss(rng, step, part, context, update) } -> std::same_as<LossTerms<typename T::A>>;
};
/// Trainings with a discriminator, which judges what the model makes. It may have the first of several updates in a
/// step. The record leaves out the loss of that update.
///   judges            true if a step has an update of the discriminator
///   judge_parameters  the tensors that update_judge changes
/// Models  Tm2tTokenizerTraining
template <class T>
concept AdversarialTask = SeveralUpdatesTask<T> &&
    requires(T& task, const T& same, const Gradients<typename T::A>& gradients, Index step) {
  { same.judges(step) } -> std::convertible_to<bool>;
  { task.judge_parameters() } -> std::same_as<std::vector<ModuleTensor<typename T::A>>>;
  task.update_judge(gradients, step);
};
/// Trainings whose loss compares all samples of a batch (train/compared_parts.hpp).
///   compared_part  the terms of some samples, and their rows that the others see
///   compared_loss  the terms of the rows of all parts
/// Laws    the terms of all parts, with their weights, and those of compared_loss add up to those of `loss`; all parts
///         have the same terms, and equally many lists of rows
/// Models  TmrTraining, GuoMatchingTraining
template <class T>
concept ComparingTask = TrainingTask<T> && requires(T& task, Philox rng, const Context& context, const BatchPart& part,
                                                    Index step, const std::vector<Tensor<typename T::A, 2>>& rows) {
  { task.samples(step) } -> std::convertible_to<Index>;
  { task.compared_part(rng, step, part, context) } -> std::same_as<ComparedPart<typename T::A>>;
  { task.compared_loss(rng, step, rows) } -> std::same_as<LossTerms<typename T::A>>;
  { task.parameters() } -> std::same_as<std::vector<ModuleTensor<typename T::A>>>;
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

/// How gradients travel between processes. bf16 rounds them to bfloat16: half the bytes, but the results are no longer
/// those of one process.
enum class GradientWire { exact, bf16 };
/// "exact" or "bf16".
inline const char* to_string(GradientWire wire) { return wire == GradientWire::bf16 ? "bf16" : "exact"; }

struct TrainingOptions {
  std::filesystem::path out = "training";  // folder of checkpoint and curves
  double save_minutes = 5;                 // between checkpoints
  bool fresh = false;                      // begin a new run even if there is a checkpoint
  bool other_settings = false;             // continue even if the checkpoint has other settings
  bool recompute = false;          // layers are recomputed instead of kept: the same results, less memory, more time
  Index micro_batch = 0;           // samples of a part of a batch; 0: batches are not divided
  AnyCommunicator communicator{};  // the processes that share the parts
  GradientWire wire = GradientWire::exact;
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
///   prepare   for a new run, before its first checkpoint: in all processes; rank 0 alone makes the other calls
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

  /// For `step`: batches are computed in parts of `micro_batch` samples (0: as one), which these processes share. Call
  /// it before the first step; `run` calls it with its options. Throws option_error 101 for a negative number, 102 for
  /// several processes or rounded gradients without parts, and for parts of a training that needs its whole batch.
  void divide(Index micro_batch, const AnyCommunicator& communicator = {}, GradientWire wire = GradientWire::exact);
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

  /// All steps, from the checkpoint in the folder if there is one. Saves regularly, and at the end. Of several
  /// processes rank 0 alone saves and decides when to stop; all must see the same data and the folder `out`.
  /// Throws  cancelled if `progress` returns false, after saving; config_error 102 for a checkpoint with other settings
  ///         or more steps, and if processes differ; what divide, step, save and resume throw
  TrainingSummary run(const TrainingOptions& options, const TrainingCallbacks& callbacks = {});

 private:
  using Number = typename Task::A::scalar;

  static constexpr bool divisible = DividedTask<Task> || ComparingTask<Task>;

  /// A step of a divided batch.
  double divided_step(const Philox& rng, Index k);
  double keep_loss(double value, const std::vector<std::string>& names, std::span<const float> values);
  void validate();
  /// Those of the task, the size of the parts if there are any, and the wire if it rounds; also if `before` has them.
  std::map<std::string, std::string> settings(const SafetensorsFile* before = nullptr) const;
  /// Throws config_error 102, in all processes, if their settings, states or kernels differ.
  void require_same_everywhere(const char* when) const;
  void require_finite(double loss, Index k) const {
    if (!std::isfinite(loss)) raise<numeric_error>(301, "training: the loss of step ", k, " is ", loss);
  }

  Task task_;
  TrainingRecord record_;
  bool recompute_ = false;
  Index micro_batch_ = 0;
  AnyCommunicator communicator_;
  GradientWire wire_ = GradientWire::exact;
  PartThreads threads_;  // of parts that meet
};

/// A complete training: the run, then the folder of the model, out/model. `about`: license and provenance, which are
/// required, data, command, ... for its config.json. Of several processes, rank 0 writes the folder. Throws what
/// Trainer::run and the task's save throw.
template <TrainingTask Task>
TrainingSummary train(Task task, const TrainingOptions& options, const std::map<std::string, std::string>& about,
                      const TrainingCallbacks& callbacks = {}) {
  Trainer<Task> trainer(std::move(task));
  const TrainingSummary summary = trainer.run(options, callbacks);
  if (options.communicator.rank() == 0) trainer.task().save(options.out / "model", about);
  return summary;
}

namespace detail {

inline constexpr const char* micro_batch_setting = "training.micro_batch";
inline constexpr const char* wire_setting = "training.wire";

}  // namespace detail

template <TrainingTask Task>
void Trainer<Task>::divide(Index micro_batch, const AnyCommunicator& communicator, GradientWire wire) {
  if (micro_batch < 0) raise<option_error>(101, "`micro_batch` is ", micro_batch, ", expected 0 or more");
  if constexpr (!divisible) {
    if (micro_batch > 0 || communicator.size() > 1)
      raise<option_error>(102,
                          "this training needs its whole batch at once: it has no `micro_batch` and runs in one "
                          "process, not in ",
                          communicator.size());
  } else if (micro_batch == 0 && communicator.size() > 1) {
    raise<option_error>(102, communicator.size(), " processes share the parts of a batch: `micro_batch` is missing");
  }
  if (wire == GradientWire::bf16 && micro_batch == 0)
    raise<option_error>(102,
                        "`wire` bf16 rounds the gradients that processes send each other: `micro_batch` is missing");
  micro_batch_ = micro_batch;
  communicator_ = communicator;
  wire_ = wire;
}

template <TrainingTask Task>
double Trainer<Task>::step() {
  const Index k = steps_done();
  const auto rng = Philox{.seed = task_.seed()}.split("step").split(static_cast<std::uint64_t>(k));
  if constexpr (divisible) {
    if (micro_batch_ > 0) return divided_step(rng, k);
  }
  const auto terms = task_.loss(rng, k, {.dropout = rng.split("dropout"), .recompute = recompute_});
  const auto loss = terms.total();
  const double value = static_cast<double>(loss.item());
  require_finite(value, k);
  task_.update(backward(loss), k);
  std::vector<std::string> names;
  std::vector<float> values;
  for (const auto& t : terms.terms) {
    names.push_back(t.name);
    values.push_back(static_cast<float>(t.weight * static_cast<double>(t.value.item())));
  }
  return keep_loss(value, names, values);
}

namespace detail {

/// True if an update of a step trains the discriminator.
template <class Task>
bool is_of_judge([[maybe_unused]] const Task& task, [[maybe_unused]] Index step, [[maybe_unused]] Index update) {
  if constexpr (AdversarialTask<Task>)
    return update == 0 && task.judges(step);
  else
    return false;
}
/// The tensors that an update changes.
template <class Task>
std::vector<ModuleTensor<typename Task::A>> parameters_of(Task& task, [[maybe_unused]] Index step,
                                                          [[maybe_unused]] Index update) {
  if constexpr (AdversarialTask<Task>) {
    if (is_of_judge(task, step, update)) return task.judge_parameters();
  }
  return task.parameters();
}

/// The parts of the batch of a step. A list of numbers is summed over them: the loss, its terms, the gradients.
template <class Task>
struct StepParts {
  using A = typename Task::A;
  using Number = typename A::scalar;
  Task& task;
  const AnyCommunicator& communicator;
  PartThreads& threads;
  const Philox& rng;
  Index step, micro_batch;
  bool recompute;
  Index update = 0;        // of the step
  SumMessages messages{};  // of the gradients
  Index samples = task.samples(step), parts = part_count(samples, micro_batch);
  std::vector<ModuleTensor<A>> parameters = parameters_of(task, step, update);
  std::optional<Philox> dropout = rng.split("dropout");
  std::vector<std::string> names{};  // of the terms; empty in a process without parts

  BatchPart part(Index i) const { return batch_part(i, samples, micro_batch); }
  Context context(Index i, const BatchSums* sums = nullptr) const {
    Context out{.recompute = recompute, .sums = sums};
    if (dropout) out.dropout = dropout->split(static_cast<std::uint64_t>(i));
    return out;
  }
  /// Begins a list with the loss and its terms.
  std::vector<Number> heads(const LossTerms<A>& terms) {
    std::vector<Number> out{terms.total().item()};
    names.clear();
    for (const auto& t : terms.terms) {
      names.push_back(t.name);
      out.push_back(static_cast<Number>(t.weight * static_cast<double>(t.value.item())));
    }
    const auto reached = std::count_if(parameters.begin(), parameters.end(), is_variable<A>);
    messages.exact = out.size() + static_cast<std::size_t>(reached);
    return out;
  }
  LossTerms<A> loss_of(Index i, const Context& context) {
    if constexpr (SeveralUpdatesTask<Task>)
      return task.part_loss(rng, step, part(i), context, update);
    else
      return task.part_loss(rng, step, part(i), context);
  }
  std::vector<Number> sum() requires DividedTask<Task> {
    const auto of_part = [&](Index i, const BatchSums* sums) {
      const LossTerms<A> terms = loss_of(i, context(i, sums));
      auto out = heads(terms);
      append_gradients<A>(out, parameters, backward(terms.total()));
      return out;
    };
    if constexpr (MeetingTask<Task>) {
      if (task.parts_meet(step)) {
        auto out = sum_of_meeting_parts<Number>(
            communicator, parts, threads, [&](Index i, const BatchSums& sums) { return of_part(i, &sums); }, messages);
        if (parts < communicator.size()) tensors_of_first<A>(communicator, task.batch_statistics());
        return out;
      }
    }
    return sum_for_all<Number>(
        communicator, parts, [&](Index i) { return of_part(i, nullptr); }, messages);
  }
  /// The terms of the rows of all parts are added to part 0, and the gradients that do not pass through the rows.
  std::vector<Number> sum() requires ComparingTask<Task> {
    std::vector<std::optional<ComparedPart<A>>> own(static_cast<std::size_t>(parts));
    const auto all = sum_for_all<Number>(communicator, parts, [&](Index i) {
      return rows_in_place(
          own[static_cast<std::size_t>(i)].emplace(task.compared_part(rng, step, part(i), context(i))));
    });
    const auto any = std::find_if(own.begin(), own.end(), [](const auto& p) { return p.has_value(); });
    std::vector<Tensor<A, 2>> rows;
    LossTerms<A> of_all;
    if (any != own.end()) {
      rows = compared_variables<A>(all, **any);
      of_all = task.compared_loss(rng, step, rows);
    }
    const Gradients<A> gradients = backward(of_all.total());
    const auto of_part = [&](Index i) {
      const ComparedPart<A> one = *std::exchange(own[static_cast<std::size_t>(i)], {});
      LossTerms<A> terms = one.terms;
      terms.append(i == 0 ? of_all : weighted(of_all, 0));
      auto out = heads(terms);
      const std::size_t before = out.size();
      append_gradients<A>(out, parameters, backward(one.terms.total() + through_rows(one, rows, gradients)));
      if (i == 0) add_gradients<A>(std::span(out).subspan(before), parameters, gradients);
      return out;
    };
    return sum_for_all<Number>(communicator, parts, of_part, messages);
  }
};

}  // namespace detail

template <TrainingTask Task>
double Trainer<Task>::divided_step(const Philox& rng, Index k) {
  if constexpr (divisible) {
    using A = typename Task::A;
    double value = 0;
    std::vector<std::string> names;
    std::vector<float> values;
    Index updates = 1;
    if constexpr (SeveralUpdatesTask<Task>) updates = task_.updates(k);
    for (Index update = 0; update < updates; ++update) {
      detail::StepParts<Task> parts{.task = task_,
                                    .communicator = communicator_,
                                    .threads = threads_,
                                    .rng = rng,
                                    .step = k,
                                    .micro_batch = micro_batch_,
                                    .recompute = recompute_,
                                    .update = update,
                                    .messages = {.bf16 = wire_ == GradientWire::bf16}};
      const auto sum = parts.sum();
      // A rank without parts does not know the terms.
      const auto own = lines_of_first(communicator_, parts.names);
      const auto heads = static_cast<Index>(1 + own.size());
      require_finite(static_cast<double>(sum.front()), k);
      const auto gradients =
          listed_gradients<A>(std::span<const Number>(sum).subspan(static_cast<std::size_t>(heads)), parts.parameters);
      if constexpr (AdversarialTask<Task>) {
        if (detail::is_of_judge(task_, k, update)) {
          task_.update_judge(gradients, k);
          continue;
        }
      }
      task_.update(gradients, k);
      value += static_cast<double>(sum.front());
      names.insert(names.end(), own.begin(), own.end());
      values.insert(values.end(), sum.begin() + 1, sum.begin() + heads);
    }
    return keep_loss(value, names, values);
  } else {
    return 0;  // `divide` has refused it
  }
}

template <TrainingTask Task>
double Trainer<Task>::keep_loss(double value, const std::vector<std::string>& names, std::span<const float> values) {
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
  auto metadata = settings();
  task_.add_to(store);
  record_.add_to(store, metadata);
  write_safetensors(checkpoint, store.views(), metadata);
}

template <TrainingTask Task>
std::map<std::string, std::string> Trainer<Task>::settings(const SafetensorsFile* before) const {
  auto out = task_.settings();
  const auto had = [&](const char* name) { return before != nullptr && before->metadata().contains(name); };
  if (micro_batch_ > 0 || had(detail::micro_batch_setting))
    out[detail::micro_batch_setting] = std::to_string(micro_batch_);
  if (wire_ == GradientWire::bf16 || had(detail::wire_setting)) out[detail::wire_setting] = to_string(wire_);
  return out;
}

template <TrainingTask Task>
void Trainer<Task>::require_same_everywhere(const char* when) const {
  if (communicator_.size() == 1) return;
  TensorStore store;
  auto texts = settings();
  task_.add_to(store);
  record_.add_to(store, texts);
  std::string text = kernels_in_use() + "\n" + tensors_checksum(store.views());
  for (const auto& [name, value] : texts) text += "\n" + name + " " + value;
  if (const Index other = first_other_text(communicator_, text); other > 0)
    raise<config_error>(102, "rank ", other, " of ", communicator_.size(), " differs from rank 0 ", when,
                        ": all processes need the same data, options and kind of processor");
}

template <TrainingTask Task>
void Trainer<Task>::resume(const std::filesystem::path& checkpoint, bool with_other_settings) {
  const auto file = SafetensorsFile::open(checkpoint);
  require_same_settings(file, settings(&file), with_other_settings);
  record_.load(file);
  task_.load(file, steps_done());
}

template <TrainingTask Task>
TrainingSummary Trainer<Task>::run(const TrainingOptions& o, const TrainingCallbacks& callbacks) {
  divide(o.micro_batch, o.communicator, o.wire);
  recompute_ = o.recompute;
  const bool is_first = communicator_.rank() == 0;
  if (is_first) std::filesystem::create_directories(o.out);
  const auto checkpoint = o.out / "checkpoint.safetensors";
  auto keep = [&] {
    if (!is_first) return;
    save(checkpoint);
    if (steps_done() > 0) write_file(o.out / "loss.svg", std::string_view(record_.curves()));
  };
  const bool resumed = answer_of_first(communicator_, is_first && !o.fresh && std::filesystem::exists(checkpoint));
  if (resumed) {
    resume(checkpoint, o.other_settings);
    if (steps_done() > task_.steps())
      raise<config_error>(102, checkpoint.string(), " has ", counted(steps_done(), "step"), ", ", task_.steps(),
                          " are asked for: `fresh` starts anew, another `out` keeps both");
  } else if (callbacks.prepare) {
    callbacks.prepare();
  }
  require_same_everywhere("before the first step");
  if (!resumed) keep();
  const Index first = steps_done();
  if (is_first && callbacks.start) callbacks.start({first, task_.steps(), resumed});
  const auto began = std::chrono::steady_clock::now();
  auto saved = began;
  double smoothed = 0;
  while (!finished()) {
    const double loss = step();
    smoothed = smoothed == 0 ? loss : 0.98 * smoothed + 0.02 * loss;
    const bool go_on =
        answer_of_first(communicator_, !is_first || !callbacks.progress ||
                                           callbacks.progress({steps_done(), task_.steps(), smoothed, record_}));
    const auto now = std::chrono::steady_clock::now();
    if (!go_on || now - saved > std::chrono::duration<double>(60 * o.save_minutes)) {
      keep();
      saved = now;
    }
    if (!go_on) {
      if (is_first && callbacks.stop) callbacks.stop(steps_done(), checkpoint);
      communicator_.barrier();  // until rank 0 has saved
      detail::throw_exception(cancelled());
    }
  }
  require_same_everywhere("after the last step");
  keep();
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - began;
  const TrainingSummary summary{steps_done() - first, steps_done(), time.count(), steps_done() < task_.steps()};
  if (is_first && callbacks.finish) callbacks.finish(summary);
  return summary;
}

MOTIONLANG_NAMESPACE_END
