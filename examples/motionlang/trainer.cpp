#include "trainer.hpp"

#include <motionlang/core/parallel.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/optim/ema.hpp>
#include <motionlang/optim/lr_schedule.hpp>

namespace program {

using ml::Index;

namespace {

std::vector<Sample> draw_batch(const TrainingSet& data, const TrainingConfig& config, ml::Philox rng, Index count) {
  std::vector<Sample> batch(static_cast<std::size_t>(count));
  ml::parallel_for(count, [&](Index i) {
    batch[static_cast<std::size_t>(i)] = data.draw(rng.split(static_cast<std::uint64_t>(i)), config.samples);
  });
  return batch;
}

/// Mean and deviation of every feature over samples as training sees them. A feature that never changes gets deviation 1.
template <ml::Backend B>
ml::Normalizer<B> measure(const TrainingSet& data, const TrainingConfig& config) {
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

ml::StmcModelConfig completed(const TrainingConfig& c) {
  auto model = c.model;
  model.denoiser.tx_dim = model.text.out;
  return model;
}

}  // namespace

Trainer::Trainer(TrainingConfig config, const TrainingSet& data)
    : config_(std::move(config)),
      data_(&data),
      diffusion_(ml::CosineSchedule{.steps = config_.model.diffusion_steps}),
      adam_() {
  config_.model = completed(config_);
  const auto captions = data.all_captions();
  average_ = ml::make_stmc<B>(config_.model, ml::WordPiece::learn(captions, config_.vocabulary),
                              ml::Philox{.seed = config_.seed}.split("init"));
  average_.motion_normalizer = measure<B>(data, config_);
  model_ = ml::convert_stmc<A>(average_);
  adam_.config.weight_decay = config_.weight_decay;
}

double Trainer::step() {
  const auto rng = ml::Philox{.seed = config_.seed}.split("step").split(static_cast<std::uint64_t>(steps_));
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
    t.push_back(static_cast<Index>(t_rng.below(static_cast<std::uint32_t>(diffusion_.steps()))));
    t_of_row.insert(t_of_row.end(), static_cast<std::size_t>(s.frames), t.back());
  }
  const ml::Offsets offsets(lengths);
  const auto x0 =
      model_.motion_normalizer.normalize(ml::Tensor<A, 2>::from(values, {offsets.rows(), ml::smplrifke_size}));
  auto noise_rng = rng.split("noise");
  const auto eps = ml::Tensor<A, 2>::randn(x0.shape(), noise_rng);

  const ml::Context context{.dropout = rng.split("dropout")};
  const auto text = ml::TextFeatures<A>::pooled(model_.text_encoder(captions, context));
  const auto out =
      model_.denoiser(ml::Sequences<A>(ml::q_sample(diffusion_, x0, t_of_row, eps), offsets), t, text, context).rows;
  auto loss = ml::mse(out, x0);
  if (config_.velocity_weight > 0) {  // differences between frames that follow each other in a sequence
    std::vector<Index> now, next;
    for (Index s = 0; s < offsets.count(); ++s) {
      for (Index r = offsets.begin(s); r + 1 < offsets.end(s); ++r) now.push_back(r), next.push_back(r + 1);
    }
    const auto error = out - x0;
    loss = loss + ml::mean(ml::square(ml::gather(error, next) - ml::gather(error, now))) * config_.velocity_weight;
  }
  const double value = static_cast<double>(loss.item());
  if (!std::isfinite(value)) ml::raise<ml::numeric_error>(301, "training: the loss of step ", steps_, " is ", value);

  const auto gradients = ml::backward(loss);
  adam_.config.lr = ml::WarmupCosine{
      .peak = config_.lr, .floor = config_.lr * 0.02, .warmup = config_.warmup, .total = config_.steps}(steps_);
  adam_.step(model_, gradients, ml::clip_scale(ml::gradient_norm<A>(model_, gradients), config_.clip_norm));
  ml::update_ema(average_, model_, config_.ema, steps_);
  losses_.push_back(static_cast<float>(value));
  ++steps_;
  return value;
}

/// Everything that decides what a step computes, except the number of steps: a run may be made longer, and its learning rate then
/// follows the new number.
std::map<std::string, std::string> Trainer::settings() const {
  auto out = ml::stmc_metadata(config_.model, average_.text_encoder.tokenizer);
  out["model"] = "stmc training";
  auto add = [&](const std::string& name, auto value) { out["training." + name] = ml::concat_text(value); };
  add("batch", config_.batch);
  add("lr", config_.lr);
  add("warmup", config_.warmup);
  add("weight_decay", config_.weight_decay);
  add("clip_norm", config_.clip_norm);
  add("ema", config_.ema);
  add("velocity_weight", config_.velocity_weight);
  add("dropout", config_.model.denoiser.dropout);
  add("text_dropout", config_.model.text.dropout);
  add("seed", config_.seed);
  add("samples", ml::concat_text(config_.samples.shortest, " to ", config_.samples.longest, " frames, no text ",
                                 config_.samples.no_text, ", composed ", config_.samples.compose, ", mirrored ",
                                 config_.samples.mirror, ", speed ", config_.samples.speed));
  return out;
}

void Trainer::save(const std::filesystem::path& checkpoint) const {
  ml::TensorStore store;
  store.add_module(model_, "model.");
  store.add_module(average_, "average.");
  for (const auto& [path, s] : adam_.state()) {
    store.add("adam.m." + path, B::shape(s.m), B::to_span(s.m), ml::DType::F32);
    store.add("adam.v." + path, B::shape(s.v), B::to_span(s.v), ml::DType::F32);
  }
  store.add<float>("losses", {std::ssize(losses_)}, losses_, ml::DType::F32);
  auto metadata = settings();
  metadata["training.steps_done"] = std::to_string(steps_);
  ml::write_safetensors(checkpoint, store.views(), metadata);
}

void Trainer::resume(const std::filesystem::path& checkpoint) {
  const auto file = ml::SafetensorsFile::open(checkpoint);
  for (const auto& [name, value] : settings()) {
    const std::string before = ml::detail::metadata_text(file.metadata(), name, "nothing");
    if (value == before) continue;
    const bool is_long = value.size() + before.size() > 100;  // the vocabulary
    ml::raise<ml::config_error>(102, checkpoint.string(), ": this run began with another ", name,
                                is_long ? "" : " (" + before + ", not " + value + ")", "; start a new one");
  }
  const auto steps = ml::detail::metadata_number<Index>(file.metadata(), "training.steps_done", file.name());
  ml::load_module(model_, file, "model.");
  ml::load_module(average_, file, "average.");
  std::map<std::string, ml::AdamW<A>::Moments> moments;
  ml::visit_tensors(model_, [&](const std::string& path, const auto& t) {
    const auto *m = file.find("adam.m." + path), *v = file.find("adam.v." + path);
    if (m == nullptr || v == nullptr) return;
    auto load = [&](const ml::TensorView& view) {
      if (view.shape != t.shape())
        ml::raise<ml::io_error>(407, file.name(), ": ", view.name, " is ", view.shape, ", not ", t.shape());
      const auto numbers = ml::values_of<float>(view);
      return B::from_span(std::span<const float>(numbers), view.shape);
    };
    moments.emplace(path, ml::AdamW<A>::Moments{load(*m), load(*v)});
  });
  adam_.restore(steps, std::move(moments));
  losses_ = ml::values_of<float>(file.tensor("losses"));
  steps_ = steps;
}

void Trainer::export_model(const std::filesystem::path& path, const std::map<std::string, std::string>& about) const {
  ml::save_stmc(path, average_, config_.model, about);
}

}  // namespace program
