// Training of the bundled model: denoiser and caption encoder together.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <motionlang/weights/stmc_file.hpp>

#include "trainer.hpp"
#include "training_data.hpp"

namespace program {

struct StmcTrainingConfig {
  ml::StmcModelConfig model{
      .denoiser = {.latent_dim = 256, .ff_size = 768, .num_layers = 6, .num_heads = 4, .dropout = 0.05},
      .sampling_steps = 20,  // the judge finds most done so, and it takes a fifth of the time of all steps
      .guidance = 2};        // and more with 2 than with 3
  ml::Index vocabulary = 800;
  ml::Index steps = 16000;
  ml::Index batch = 32;
  double lr = 4e-4;
  ml::Index warmup = 500;
  double weight_decay = 0.01;
  double clip_norm = 1;
  double ema = 0.999;
  double velocity_weight = 1;   // of the loss on differences between neighbouring frames
  double noise_focus = 0.5;     // share of the samples that come from the noisiest fifth of the diffusion
  double root_weight = 8;       // of the four numbers that move the figure, against 1 for each of the others
  double foot_weight = 0.2;     // of the loss on the velocity of the feet, (m/s)^2
  double text_weight = 0.2;     // of the loss that asks a caption's vector for a summary of the motion
  ml::Index text_steps = 3000;  // of the text encoder alone, before the denoiser is trained
  std::uint64_t seed = 1;
  SampleOptions samples{};
};

/// All state of the training but the losses: what a Trainer trains.
class StmcTask {
 public:
  using B = TrainingBackend;
  using A = TrainingTape;

  /// For a fresh run: learns the vocabulary, measures mean and deviation of the features, draws the weights.
  StmcTask(StmcTrainingConfig config, const TrainingSet& data);

  /// Teaches the text encoder alone what captions mean: the mean of every feature of their motions over each quarter of
  /// the time, and its deviation. Without it the denoiser learns to move long before it learns to listen. For a fresh
  /// run, before the first step. Returns the last loss.
  double learn_texts(ml::Progress progress = {});
  /// Takes denoiser and normaliser of a trained model, so that only texts are learnt anew. For a fresh run.
  void take_denoiser(const std::filesystem::path& model);
  /// The averaged weights, in half precision.
  void export_model(const std::filesystem::path& path, const std::map<std::string, std::string>& about) const;

  std::uint64_t seed() const { return config_.seed; }
  ml::Index steps() const { return config_.steps; }
  std::map<std::string, std::string> settings() const;
  ml::LossTerms<A> loss(ml::Philox rng, ml::Index step, const ml::Context& context) const;
  void update(const ml::Gradients<A>& gradients, ml::Index step);
  void add_to(ml::TensorStore& store) const;
  void load(const ml::SafetensorsFile& file, ml::Index steps);

 private:
  StmcTrainingConfig config_;
  const TrainingSet* data_;
  ml::GaussianDiffusion diffusion_;
  Learner<ml::Stmc<A>, ml::Stmc<B>> learner_;
  ml::Linear<A> summary_;  // from a caption's vector to the summary of its motion; not part of the model
  ml::AdamW<A> adam_summary_;
};

}  // namespace program
