#include "stmc_training.hpp"

#include <motionlang/core/parallel.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/optim/lr_schedule.hpp>

#include "foot_loss.hpp"

namespace program {

using ml::Index;

namespace {

std::vector<Sample> draw_batch(const TrainingSet& data, const StmcTrainingConfig& config, ml::Philox rng, Index count) {
  std::vector<Sample> batch(static_cast<std::size_t>(count));
  ml::parallel_for(count, [&](Index i) {
    batch[static_cast<std::size_t>(i)] = data.draw(rng.split(static_cast<std::uint64_t>(i)), config.samples);
  });
  return batch;
}

/// Mean and deviation of every feature over samples as training sees them. A feature that never changes gets deviation
/// 1.
template <ml::Backend B>
ml::Normalizer<B> measure(const TrainingSet& data, const StmcTrainingConfig& config) {
  ml::FeatureStatistics statistics;
  for (const Sample& s : draw_batch(data, config, ml::Philox{.seed = config.seed}.split("statistics"), 2000)) {
    const std::vector<double> values(s.features.begin(), s.features.end());
    statistics.add(std::span<const double>(values), ml::smplrifke_size);
  }
  std::vector<float> mean, std;
  for (double m : statistics.mean()) mean.push_back(static_cast<float>(m));
  for (double d : statistics.standard_deviation()) std.push_back(d < 1e-4 ? 1.0f : static_cast<float>(d));
  return {ml::Tensor<B, 1>::from(mean, {std::ssize(mean)}), ml::Tensor<B, 1>::from(std, {std::ssize(std)})};
}

constexpr Index summary_parts = 4, summary_size = (summary_parts + 1) * ml::smplrifke_size;

/// What a caption should tell about rows (frames, 205) of normalised features: the mean of every feature over each
/// quarter of the time ("sit down" is not "sit"), and its deviation over all of it.
void append_summary(std::vector<float>& out, std::span<const float> rows) {
  const Index frames = std::ssize(rows) / ml::smplrifke_size;
  ml::FeatureStatistics all;
  for (Index k = 0; k < summary_parts; ++k) {
    const Index first = frames * k / summary_parts, last = std::max(first + 1, frames * (k + 1) / summary_parts);
    const auto quarter = rows.subspan(static_cast<std::size_t>(first * ml::smplrifke_size),
                                      static_cast<std::size_t>((last - first) * ml::smplrifke_size));
    ml::FeatureStatistics part;
    part.add(quarter, ml::smplrifke_size);
    for (double mean : part.mean()) out.push_back(static_cast<float>(mean));
  }
  all.add(rows, ml::smplrifke_size);
  const auto n = static_cast<double>(all.count());
  for (double unbiased : all.standard_deviation()) out.push_back(static_cast<float>(unbiased * std::sqrt((n - 1) / n)));
}

/// Four numbers say where the figure goes, 201 how it holds itself: the four count more. (205), mean of the squares
/// about 1.
template <ml::Backend B>
ml::Tensor<B, 1> feature_weights(double root_weight) {
  std::vector<typename B::scalar> weights(ml::smplrifke_size, 1);
  std::fill_n(weights.begin(), 4, static_cast<typename B::scalar>(std::sqrt(root_weight)));
  return ml::Tensor<B, 1>::from(weights, {ml::smplrifke_size});
}

/// The diffusion step of a sample. Over all frames together, what a motion will be (where it goes, when it sits down)
/// shows through much more noise than any single frame: with 60 frames and features that move together, the signal of
/// such a whole is as strong as the noise when alpha_bar is still about 1e-3. It is decided in the first few of a
/// hundred steps, so `focus` of the samples come from the noisiest fifth, the noisier the more.
Index draw_t(ml::Philox& rng, Index steps, double focus) {
  if (rng.uniform() >= focus) return static_cast<Index>(rng.below(static_cast<std::uint32_t>(steps)));
  const double from_the_end = 0.2 * static_cast<double>(steps) * std::pow(rng.uniform(), 1.5);
  return std::max<Index>(0, steps - 1 - static_cast<Index>(from_the_end));
}

ml::StmcModelConfig completed(const StmcTrainingConfig& c) {
  auto model = c.model;
  model.denoiser.tx_dim = model.text.out;
  return model;
}

}  // namespace

StmcTask::StmcTask(StmcTrainingConfig config, const TrainingSet& data)
    : config_(std::move(config)), data_(&data), diffusion_(ml::CosineSchedule{.steps = config_.model.diffusion_steps}) {
  config_.model = completed(config_);
  const auto captions = data.all_captions();
  learner_.average = ml::make_stmc<B>(config_.model, ml::WordPiece::learn(captions, config_.vocabulary),
                                      ml::Philox{.seed = config_.seed}.split("init"));
  learner_.average.motion_normalizer = measure<B>(data, config_);
  learner_.model = ml::convert_stmc<A>(learner_.average);
  learner_.ema = config_.ema;
  learner_.clip_norm = config_.clip_norm;
  auto rng = ml::Philox{.seed = config_.seed}.split("summary");
  summary_ = ml::convert<A>(ml::Linear<B>(config_.model.text.out, summary_size, rng));
  learner_.adam.config.weight_decay = adam_summary_.config.weight_decay = config_.weight_decay;
}

double StmcTask::learn_texts(ml::Progress progress) {
  const auto rng = ml::Philox{.seed = config_.seed}.split("texts");
  const auto samples =
      draw_batch(*data_, config_, rng.split("samples"), std::min<Index>(20000, 8 * config_.text_steps));
  std::vector<float> summaries;
  for (const Sample& s : samples) {
    const auto rows = learner_.average.motion_normalizer.normalize(
        ml::Tensor<B, 2>::from(s.features, {s.frames, ml::smplrifke_size}));
    append_summary(summaries, rows.span());
  }
  ml::AdamW<A> adam_text{{.weight_decay = config_.weight_decay}}, adam_summary = adam_text;
  double value = 0;
  for (Index k = 0; k < config_.text_steps; ++k) {
    auto pick = rng.split("batch").split(static_cast<std::uint64_t>(k));
    std::vector<std::string> captions;
    std::vector<float> wanted;
    for (int i = 0; i < 128; ++i) {
      const auto n = static_cast<std::ptrdiff_t>(pick.below(static_cast<std::uint32_t>(samples.size())));
      captions.push_back(samples[static_cast<std::size_t>(n)].caption);
      wanted.insert(wanted.end(), summaries.begin() + n * summary_size, summaries.begin() + (n + 1) * summary_size);
    }
    const ml::Context context{.dropout = pick.split("dropout")};
    const auto told = summary_(learner_.model.text_encoder(captions, context));
    const auto loss = ml::mse(told, ml::Tensor<A, 2>::from(wanted, told.shape()));
    const auto gradients = ml::backward(loss);
    adam_text.config.lr = adam_summary.config.lr =
        ml::WarmupCosine{.peak = 1e-3, .floor = 5e-5, .warmup = 100, .total = config_.text_steps}(k);
    adam_text.step(learner_.model.text_encoder, gradients);
    adam_summary.step(summary_, gradients);
    value = k == 0 ? static_cast<double>(loss.item()) : 0.98 * value + 0.02 * static_cast<double>(loss.item());
    progress(k + 1, config_.text_steps);
  }
  learner_.average.text_encoder = ml::to_inner(learner_.model.text_encoder);
  return value;
}

void StmcTask::take_denoiser(const std::filesystem::path& model) {
  const auto trained = ml::load_stmc<B>(model);
  learner_.average.denoiser = ml::convert<B>(trained.denoiser);
  learner_.average.motion_normalizer = trained.motion_normalizer;
  learner_.model.denoiser = ml::convert<A>(learner_.average.denoiser);
  learner_.model.motion_normalizer = ml::convert<A>(learner_.average.motion_normalizer);
}

ml::LossTerms<StmcTask::A> StmcTask::loss(ml::Philox rng, Index, const ml::Context& context) const {
  const auto batch = draw_batch(*data_, config_, rng.split("samples"), config_.batch);

  // x0, packed; one t per sequence; noise
  std::vector<float> values;
  std::vector<Index> lengths, t, t_of_row;
  std::vector<std::string> captions;
  auto t_rng = rng.split("t");
  for (const Sample& s : batch) {
    values.insert(values.end(), s.features.begin(), s.features.end());
    lengths.push_back(s.frames);
    captions.push_back(s.caption);
    t.push_back(draw_t(t_rng, diffusion_.steps(), config_.noise_focus));
    t_of_row.insert(t_of_row.end(), static_cast<std::size_t>(s.frames), t.back());
  }
  const ml::Offsets offsets(lengths);
  const auto x0 =
      learner_.model.motion_normalizer.normalize(ml::Tensor<A, 2>::from(values, {offsets.rows(), ml::smplrifke_size}));
  auto noise_rng = rng.split("noise");
  const auto eps = ml::Tensor<A, 2>::randn(x0.shape(), noise_rng);

  const auto text = ml::TextFeatures<A>::pooled(learner_.model.text_encoder(captions, context));
  const auto out =
      learner_.model.denoiser(ml::Sequences<A>(ml::q_sample(diffusion_, x0, t_of_row, eps), offsets), t, text, context)
          .rows;
  const auto error = (out - x0) * feature_weights<A>(config_.root_weight);
  ml::LossTerms<A> loss;
  loss.add("features", 1, ml::mean(ml::square(error)));
  if (config_.velocity_weight > 0) {  // differences between frames that follow each other in a sequence
    std::vector<Index> now, next;
    for (Index s = 0; s < offsets.count(); ++s) {
      for (Index r = offsets.begin(s); r + 1 < offsets.end(s); ++r) now.push_back(r), next.push_back(r + 1);
    }
    loss.add("velocities", config_.velocity_weight,
             ml::mean(ml::square(ml::gather(error, next) - ml::gather(error, now))));
  }
  if (config_.foot_weight > 0) {
    const auto truth = ml::Tensor<B, 2>::from(values, {offsets.rows(), ml::smplrifke_size});
    loss.add("feet", config_.foot_weight,
             foot_velocity_loss<A>(learner_.model.motion_normalizer.denormalize(out), truth, offsets, training_fps));
  }
  if (config_.text_weight > 0) {
    std::vector<float> wanted;
    const auto width = static_cast<std::size_t>(ml::smplrifke_size);
    for (Index s = 0; s < offsets.count(); ++s)
      append_summary(wanted, x0.span().subspan(static_cast<std::size_t>(offsets.begin(s)) * width,
                                               static_cast<std::size_t>(offsets.length(s)) * width));
    const auto told = summary_(text.tokens.rows);
    loss.add("text", config_.text_weight, ml::mse(told, ml::Tensor<A, 2>::from(wanted, told.shape())));
  }
  return loss;
}

void StmcTask::update(const ml::Gradients<A>& gradients, Index step) {
  const ml::WarmupCosine rate{
      .peak = config_.lr, .floor = config_.lr * 0.02, .warmup = config_.warmup, .total = config_.steps};
  learner_.update(gradients, rate(step), step);
  adam_summary_.config.lr = rate(step);
  adam_summary_.step(summary_, gradients);
}

/// Everything that decides what a step computes, except the number of steps: a run may be made longer, and its learning
/// rate then follows the new number.
std::map<std::string, std::string> StmcTask::settings() const {
  auto out = ml::stmc_metadata(config_.model, learner_.average.text_encoder.tokenizer);
  out["model"] = "stmc training";
  out.erase("sampling");  // decides nothing here
  auto add = [&](const std::string& name, auto value) { out["training." + name] = ml::concat_text(value); };
  add("data", data_->fingerprint());
  add("batch", config_.batch);
  add("lr", config_.lr);
  add("warmup", config_.warmup);
  add("weight_decay", config_.weight_decay);
  add("clip_norm", config_.clip_norm);
  add("ema", config_.ema);
  add("velocity_weight", config_.velocity_weight);
  add("noise_focus", config_.noise_focus);
  add("root_weight", config_.root_weight);
  add("foot_weight", config_.foot_weight);
  add("text_weight", config_.text_weight);
  add("text_steps", config_.text_steps);
  add("dropout", config_.model.denoiser.dropout);
  add("text_dropout", config_.model.text.dropout);
  add("seed", config_.seed);
  add("samples", ml::concat_text(config_.samples.shortest, " to ", ml::counted(config_.samples.longest, "frame"),
                                 ", no text ", config_.samples.no_text, ", composed ", config_.samples.compose,
                                 ", mirrored ", config_.samples.mirror, ", speed ", config_.samples.speed,
                                 ", stretched ", config_.samples.stretch, ", tempo ", config_.samples.tempo,
                                 ", reversed ", config_.samples.reverse));
  return out;
}

void StmcTask::add_to(ml::TensorStore& store) const {
  learner_.add_to(store);
  store.add_module(summary_, "summary.");
  add_moments(store, "adam_summary.", adam_summary_);
}

void StmcTask::load(const ml::SafetensorsFile& file, Index steps) {
  learner_.load(file, steps);
  ml::load_module(summary_, file, "summary.");
  restore_moments(adam_summary_, summary_, file, "adam_summary.", steps);
}

void StmcTask::export_model(const std::filesystem::path& path, const std::map<std::string, std::string>& about) const {
  ml::save_stmc(path, learner_.average, config_.model, about);
}

}  // namespace program
