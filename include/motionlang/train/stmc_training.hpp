// SPDX-License-Identifier: MIT
/// The training of the bundled model: denoiser and caption encoder together. `motionlang train` and
/// `motionlang train-mdm-smpl --preset bundled` call it.
///
///     TrainingSet data("captions.tsv", "clips", {});
///     const auto model = train_stmc<A>({}, data, {}, {.out = "run"}, {{"license", "MIT"}});
#pragma once

#include <algorithm>   // fill_n, max
#include <array>       // a generator
#include <cmath>       // pow, sqrt
#include <filesystem>  // the model
#include <map>         // settings
#include <optional>    // batches
#include <string>      // captions
#include <utility>     // move
#include <vector>      // samples

#include <motionlang/datasets/training_set.hpp>
#include <motionlang/diffusion/gaussian.hpp>
#include <motionlang/diffusion/schedule.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/loss/foot_velocity.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/optim/lr_schedule.hpp>
#include <motionlang/train/epoch_batches.hpp>
#include <motionlang/train/learned_captions.hpp>
#include <motionlang/train/learner.hpp>
#include <motionlang/train/stmc_start.hpp>
#include <motionlang/train/stmc_training_config.hpp>
#include <motionlang/train/stmc_training_notes.hpp>
#include <motionlang/train/trainer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Samples, each with a generator of its own, on several threads.
std::vector<TrainingSample> draw_batch(const TrainingSet& data, const StmcTrainingConfig& config, Philox rng,
                                       Index count);

inline constexpr Index root_features = 4;  // the first ones: they move the figure, and the others pose it

/// Mean and deviation of every feature over samples as training sees them. A feature that never changes gets deviation
/// 1. A feature of the pose gets at least `least`: a joint that moves in a few clips only would otherwise weigh as much
/// as a knee. Deviations of the pose are multiplied by config.pose_scale.
template <Backend B>
Normalizer<B> measure(const TrainingSet& data, const StmcTrainingConfig& config) {
  constexpr double least = 0.03;
  FeatureStatistics statistics;
  for (const TrainingSample& s :
       draw_batch(data, config, Philox{.seed = config.optimiser.seed}.split("statistics"), 2000)) {
    const std::vector<double> values(s.features.begin(), s.features.end());
    statistics.add(std::span<const double>(values), smplrifke_size);
  }
  std::vector<float> mean, std;
  for (double m : statistics.mean()) mean.push_back(static_cast<float>(m));
  for (const double d : statistics.standard_deviation()) {
    const bool pose = std::ssize(std) >= root_features;
    const double at_least = std::max(d, pose ? least : 0);
    std.push_back(d < 1e-4 ? 1.0f : static_cast<float>(pose ? config.pose_scale * at_least : at_least));
  }
  return {Tensor<B, 1>::from(mean, {std::ssize(mean)}), Tensor<B, 1>::from(std, {std::ssize(std)})};
}

inline constexpr Index summary_parts = 4, summary_size = (summary_parts + 1) * smplrifke_size;
/// Appends what a caption should tell about rows (frames, 205) of normalised features: the mean of every feature over
/// each quarter of the time ("sit down" is not "sit"), and its deviation over all frames.
void append_summary(std::vector<float>& out, std::span<const float> rows);

/// The weights of the features, (205). Four features move the figure and 201 pose it: the four weigh more. The mean of
/// the squared weights is about 1.
template <Backend B>
Tensor<B, 1> feature_weights(double root_weight) {
  std::vector<typename B::scalar> weights(smplrifke_size, 1);
  std::fill_n(weights.begin(), root_features, static_cast<typename B::scalar>(std::sqrt(root_weight)));
  return Tensor<B, 1>::from(weights, {smplrifke_size});
}

/// The diffusion step of a sample. What all frames have in common (where the figure goes, when it sits down) is visible
/// through much more noise than any single frame: with 60 frames and features that move together, its signal is still
/// as strong as the noise when alpha_bar is about 1e-3. The first few of a hundred steps decide it. So the share
/// `focus` of the samples comes from the noisiest fifth, with more samples the noisier the step.
Index draw_t(Philox& rng, Index steps, double focus);

/// The weight of the squared error of a sample: its ratio of signal to noise, abar / (1 - abar), but at least 1
/// (Salimans and Ho 2022, "truncated SNR weighting") and at most `cap` (Hang et al. 2023). With the weight 1
/// everywhere, samples with little noise have nearly no share of the loss. Then the network does not learn to keep fast
/// movements, such as a waving hand, when it sees them.
double snr_weight(double abar, double cap);

/// The captions without their mirror images, and twice the words that samples add, for WordPiece::of_words.
std::vector<std::string> said_texts(const TrainingSet& data);

}  // namespace detail

/// The complete state of the training except the losses.
template <AutodiffBackend Tape>
class StmcTraining {
 public:
  using A = Tape;
  using B = typename A::inner;

  /// For a new run: learns the vocabulary, measures mean and deviation of the features, draws the weights. `data` must
  /// outlive the training. With word vectors, each word that occurs at least twice in captions gets its own embedding,
  /// and `config.vocabulary` is ignored.
  StmcTraining(StmcTrainingConfig config, const TrainingSet& data, const WordVectors& vectors = {});

  /// Teaches the text encoder alone what captions mean: the mean of every feature of their motions over each quarter of
  /// the time, and its deviation; and which action they are about. (Waving and nodding have nearly the same means.)
  /// Otherwise the denoiser learns to move long before it learns to follow the text. For a new run, before the first
  /// step. Returns the last loss.
  double learn_texts(Progress progress = {});
  /// Starts with what a model of the same sizes knows (train/stmc_start.hpp). For a new run, before learn_texts or
  /// instead of it.
  void start_from(const std::filesystem::path& model);
  /// Writes the averaged weights in half precision, and the captions.
  void export_model(const std::filesystem::path& path, const std::map<std::string, std::string>& about) const;

  std::uint64_t seed() const { return config_.optimiser.seed; }
  Index steps() const {
    if (config_.updates > 0) return config_.updates;
    return config_.optimiser.epochs * EpochBatches(std::ssize(data_->segments()), config_.optimiser.batch).per_epoch();
  }
  /// Everything that decides what a step computes, except the number of steps: a run may be extended, and its learning
  /// rate then follows the new number.
  std::map<std::string, std::string> settings() const;
  LossTerms<A> loss(Philox rng, Index step, const Context& context) {
    return part_loss(rng, step, {0, config_.optimiser.batch}, context);
  }
  Index samples(Index) const { return config_.optimiser.batch; }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context);
  void update(const Gradients<A>& gradients, Index step);
  std::vector<ModuleTensor<A>> parameters();
  void add_to(TensorStore& store) const;
  void load(const SafetensorsFile& file, Index steps);

 private:
  /// The loss of caption vectors (samples, text.out): what they tell about the summaries (samples, summary_size), plus
  /// losses.verb times the cross-entropy of their verbs. A sample without a verb adds nothing to that.
  Tensor<A, 0> text_loss(const Tensor<A, 2>& texts, const std::vector<float>& summaries,
                         const std::vector<Index>& verbs) const;

  StmcTrainingConfig config_;
  const TrainingSet* data_;
  GaussianDiffusion diffusion_;
  Learner<Stmc<A>, Stmc<B>> learner_;
  /// These read a caption's vector during training; they are not part of the model.
  struct Heads {
    Linear<A> summary;  // of its motion
    Linear<A> verbs;    // the logits of TrainingSet::verbs()

    static constexpr auto fields() { return motionlang::fields("summary", &Heads::summary, "verbs", &Heads::verbs); }
  };
  Heads heads_;
  AdamW<A> adam_heads_;
  std::optional<std::array<std::uint64_t, 2>> drawn_{};  // seed and stream of the batch that was drawn last
  std::vector<TrainingSample> batch_{};
};

template <AutodiffBackend A>
StmcTraining<A>::StmcTraining(StmcTrainingConfig config, const TrainingSet& data, const WordVectors& vectors)
    : config_(std::move(config)), data_(&data), diffusion_(CosineSchedule{.steps = config_.diffusion.steps}) {
  config_.require_consistent();
  const auto captions = data.all_captions();
  learner_.average = make_stmc<B>(
      config_.model(),
      vectors.empty() ? WordPiece::learn(captions, config_.vocabulary) : WordPiece::of_words(detail::said_texts(data)),
      Philox{.seed = config_.optimiser.seed}.split("init"), vectors);
  learner_.average.motion_normalizer = detail::measure<B>(data, config_);
  learner_.model = convert_stmc<A>(learner_.average);
  learner_.ema = config_.optimiser.ema;
  learner_.clip_norm = config_.optimiser.clip_norm;
  auto rng = Philox{.seed = config_.optimiser.seed}.split("summary");
  heads_.summary = convert<A>(Linear<B>(config_.text.out, detail::summary_size, rng));
  heads_.verbs = convert<A>(Linear<B>(config_.text.out, std::max<Index>(1, std::ssize(data.verbs())), rng));
  learner_.adam.config = adam_heads_.config = config_.optimiser.adamw();
}

template <AutodiffBackend A>
Tensor<A, 0> StmcTraining<A>::text_loss(const Tensor<A, 2>& texts, const std::vector<float>& summaries,
                                        const std::vector<Index>& verbs) const {
  const auto said = heads_.summary(texts);
  const auto loss = mse(said, Tensor<A, 2>::from(summaries, said.shape()));
  std::vector<Index> with_verb, labels;
  for (Index i = 0; i < std::ssize(verbs); ++i) {
    const Index verb = verbs[static_cast<std::size_t>(i)];
    if (verb >= 0) with_verb.push_back(i), labels.push_back(verb);
  }
  if (labels.empty() || config_.losses.verb == 0) return loss;
  const auto named = sum(cross_entropies(heads_.verbs(gather(texts, with_verb)), labels));
  return loss + named * (config_.losses.verb / static_cast<double>(verbs.size()));
}

template <AutodiffBackend A>
double StmcTraining<A>::learn_texts(Progress progress) {
  const auto rng = Philox{.seed = config_.optimiser.seed}.split("texts");
  const auto samples =
      detail::draw_batch(*data_, config_, rng.split("samples"), std::min<Index>(20000, 8 * config_.text_steps));
  std::vector<float> summaries;
  for (const TrainingSample& s : samples) {
    const auto rows =
        learner_.average.motion_normalizer.normalize(Tensor<B, 2>::from(s.features, {s.frames, smplrifke_size}));
    detail::append_summary(summaries, rows.span());
  }
  AdamW<A> adam_text{config_.optimiser.adamw()}, adam_heads = adam_text;
  double value = 0;
  for (Index k = 0; k < config_.text_steps; ++k) {
    auto pick = rng.split("batch").split(static_cast<std::uint64_t>(k));
    std::vector<std::string> captions;
    std::vector<float> wanted;
    std::vector<Index> verbs;
    for (int i = 0; i < 128; ++i) {
      const auto n = static_cast<std::ptrdiff_t>(pick.below(static_cast<std::uint32_t>(samples.size())));
      captions.push_back(samples[static_cast<std::size_t>(n)].caption);
      verbs.push_back(samples[static_cast<std::size_t>(n)].verb);
      wanted.insert(wanted.end(), summaries.begin() + n * detail::summary_size,
                    summaries.begin() + (n + 1) * detail::summary_size);
    }
    const Context context{.dropout = pick.split("dropout")};
    const auto loss = text_loss(learner_.model.text_encoder(captions, context), wanted, verbs);
    const auto gradients = backward(loss);
    adam_text.config.lr = adam_heads.config.lr =
        WarmupCosine{.peak = 1e-3, .floor = 5e-5, .warmup = 100, .total = config_.text_steps}(k);
    adam_text.step(learner_.model.text_encoder, gradients);
    adam_heads.step(heads_, gradients);
    value = k == 0 ? static_cast<double>(loss.item()) : 0.98 * value + 0.02 * static_cast<double>(loss.item());
    progress(k + 1, config_.text_steps);
  }
  learner_.average.text_encoder = to_inner(learner_.model.text_encoder);
  return value;
}

template <AutodiffBackend A>
void StmcTraining<A>::start_from(const std::filesystem::path& model) {
  motionlang::start_from(learner_.average, SafetensorsFile::open(model));
  learner_.model = convert_stmc<A>(learner_.average);
}

template <AutodiffBackend A>
LossTerms<A> StmcTraining<A>::part_loss(Philox rng, Index, const BatchPart& part, const Context& context) {
  const std::array<std::uint64_t, 2> generator{rng.seed, rng.stream};
  if (drawn_ != generator) batch_ = detail::draw_batch(*data_, config_, rng.split("samples"), config_.optimiser.batch);
  drawn_ = generator;

  // The clean frames x0 of the part, packed; one t for each sequence; the noise.
  std::vector<float> values;
  std::vector<Index> lengths, all_lengths, all_steps, t, t_of_row, verbs;
  std::vector<std::string> captions;
  auto t_rng = rng.split("t");
  Index rows_before = 0;
  for (Index i = 0; i < config_.optimiser.batch; ++i) {
    const TrainingSample& s = batch_[static_cast<std::size_t>(i)];
    const Index t_of_sample = detail::draw_t(t_rng, diffusion_.steps(), config_.noise_focus);
    all_lengths.push_back(s.frames);
    all_steps.push_back(s.frames - 1);
    if (i < part.first) rows_before += s.frames;
    if (i < part.first || i >= part.last) continue;
    values.insert(values.end(), s.features.begin(), s.features.end());
    lengths.push_back(s.frames);
    captions.push_back(s.caption);
    verbs.push_back(s.verb);
    t.push_back(t_of_sample);
    t_of_row.insert(t_of_row.end(), static_cast<std::size_t>(s.frames), t_of_sample);
  }
  const double of_samples = part.share(config_.optimiser.batch),
               of_frames = part.share(std::span<const Index>(all_lengths)),
               of_steps = part.share(std::span<const Index>(all_steps));
  const Offsets offsets(lengths);
  const auto x0 =
      learner_.model.motion_normalizer.normalize(Tensor<A, 2>::from(values, {offsets.rows(), smplrifke_size}));
  const auto eps = normal_rows<A>(rows_before, offsets.rows(), smplrifke_size, rng.split("noise"));

  const auto text = TextFeatures<A>::pooled(learner_.model.text_encoder(captions, context));
  const auto out =
      learner_.model.denoiser(Sequences<A>(q_sample(diffusion_, x0, t_of_row, eps), offsets), t, text, context).rows;
  const auto weights_of_rows = coefficients<A, 2>(
      t_of_row, [&](Index k) { return std::sqrt(detail::snr_weight(diffusion_.abar(k), config_.losses.snr_cap)); });
  const auto error = (out - x0) * weights_of_rows * detail::feature_weights<A>(config_.losses.root);
  LossTerms<A> loss;
  loss.add("features", of_frames, mean(square(error)));
  if (config_.losses.velocity > 0) {  // differences between neighbouring frames of a sequence
    std::vector<Index> now, next;
    for (Index s = 0; s < offsets.count(); ++s) {
      for (Index r = offsets.begin(s); r + 1 < offsets.end(s); ++r) now.push_back(r), next.push_back(r + 1);
    }
    loss.add("velocities", config_.losses.velocity * of_steps, mean(square(gather(error, next) - gather(error, now))));
  }
  if (config_.losses.foot > 0) {
    const auto truth = Tensor<B, 2>::from(values, {offsets.rows(), smplrifke_size});
    loss.add("feet", config_.losses.foot * of_steps,
             foot_velocity_loss<A>(learner_.model.motion_normalizer.denormalize(out), truth, offsets, training_fps));
  }
  if (config_.losses.text > 0) {
    std::vector<float> wanted;
    const auto width = static_cast<std::size_t>(smplrifke_size);
    for (Index s = 0; s < offsets.count(); ++s)
      detail::append_summary(wanted, x0.span().subspan(static_cast<std::size_t>(offsets.begin(s)) * width,
                                                       static_cast<std::size_t>(offsets.length(s)) * width));
    loss.add("text", config_.losses.text * of_samples, text_loss(text.tokens.rows, wanted, verbs));
  }
  return loss;
}

template <AutodiffBackend A>
std::vector<ModuleTensor<A>> StmcTraining<A>::parameters() {
  auto out = tensors_of(learner_.model);
  for (auto& t : tensors_of(heads_)) out.push_back(std::move(t));
  return out;
}

template <AutodiffBackend A>
void StmcTraining<A>::update(const Gradients<A>& gradients, Index step) {
  const double lr = config_.optimiser.rate(step, steps());
  learner_.update(gradients, lr, step);
  learner_.follow();
  adam_heads_.config.lr = lr;
  adam_heads_.step(heads_, gradients);
}

template <AutodiffBackend A>
std::map<std::string, std::string> StmcTraining<A>::settings() const {
  auto out = stmc_metadata(config_.model(), learner_.average.text_encoder.tokenizer);
  out["model"] = "stmc training";
  for (const char* name : {"sampling", "guidance"}) out.erase(name);  // they do not change a training step
  if (const WordVectors& vectors = learner_.average.text_encoder.vectors; !vectors.empty())
    out["word_vectors"] = concat_text(vectors.checksum(), ", hidden ", config_.text.hidden_words);
  out.merge(detail::stmc_settings(config_, data_->fingerprint()));
  return out;
}

template <AutodiffBackend A>
void StmcTraining<A>::add_to(TensorStore& store) const {
  learner_.add_to(store);
  store.add_module(heads_, "heads.");
  add_moments(store, "adam_heads.", adam_heads_);
}

template <AutodiffBackend A>
void StmcTraining<A>::load(const SafetensorsFile& file, Index steps) {
  learner_.load(file, steps);
  load_module(heads_, file, "heads.");
  restore_moments(adam_heads_, heads_, file, "adam_heads.", steps);
}

template <AutodiffBackend A>
void StmcTraining<A>::export_model(const std::filesystem::path& path,
                                   const std::map<std::string, std::string>& about) const {
  const CaptionEncoder<B>& encoder = learner_.average.text_encoder;
  save_stmc(path, learner_.average, config_.model(), about, DType::F16,
            learned_captions(*data_, text_vectors(encoder), encoder.vectors));
}

/// The knowledge of a new training before its first step.
struct StmcStart {
  std::filesystem::path model{};  // of the same sizes, best with config.text_steps = 0; empty: random weights
  WordVectors vectors{};          // of words beyond those of the captions
};

/// The whole training: practises, starts, learns texts, trains, and writes options.out / "stmc.safetensors", whose path
/// it returns. Only the first of several processes writes. A stopped run continues from its checkpoint.
/// about      license, provenance, command, ..., for the metadata beside stmc_training_notes
/// callbacks  `prepare` is called before texts are learnt
/// texts      the progress of learning texts
/// Throws     config_error 101, 102, 103 for an invalid configuration; as TrainingSet::practise, start_from and
///            Trainer::run
template <AutodiffBackend A>
std::filesystem::path train_stmc(const StmcTrainingConfig& config, TrainingSet& data, const StmcStart& start,
                                 const TrainingOptions& options, std::map<std::string, std::string> about,
                                 TrainingCallbacks callbacks = {}, Progress texts = {}) {
  if (!config.practised.empty()) data.practise(config.practised, config.practice);
  Trainer<StmcTraining<A>> trainer(StmcTraining<A>(config, data, start.vectors));
  StmcTraining<A>& task = trainer.task();
  callbacks.prepare = [&, before = std::move(callbacks.prepare)] {
    if (before) before();
    if (!start.model.empty()) task.start_from(start.model);
    if (config.text_steps > 0) task.learn_texts(texts);
  };
  trainer.run(options, callbacks);
  std::filesystem::path model = options.out / "stmc.safetensors";
  if (options.communicator.rank() > 0) return model;
  about.merge(stmc_training_notes(data));
  task.export_model(model, about);
  return model;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/stmc_training.ipp>
#endif
#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::StmcTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>;
extern template class motionlang::Trainer<
    motionlang::StmcTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>>>;
#endif
