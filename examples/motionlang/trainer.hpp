// Training of the bundled model: denoiser and caption encoder together.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/io/stmc_file.hpp>
#include <motionlang/optim/adamw.hpp>

#include "training_data.hpp"

namespace program {

struct TrainingConfig {
  ml::StmcModelConfig model{
      .denoiser = {.latent_dim = 256, .ff_size = 768, .num_layers = 6, .num_heads = 4, .dropout = 0.05},
      .guidance = 2};  // the judge finds more done with 2 than with 3
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

/// All state of a training run. Every step depends on the state and the step's number only, so that a run which is
/// stopped and resumed gives the numbers of one that was not.
class Trainer {
 public:
  using B = ml::EigenBackend<float>;
  using A = ml::Autodiff<B>;

  /// A fresh run: learns the vocabulary, measures mean and deviation of the features, draws the weights.
  Trainer(TrainingConfig config, const TrainingSet& data);

  ml::Index steps_done() const { return steps_; }
  /// Teaches the text encoder alone what captions mean: the mean of every feature of their motions over each quarter of
  /// the time, and its deviation. Without it the denoiser learns to move long before it learns to listen. For a fresh
  /// run, before the first step. Returns the last loss.
  double learn_texts(ml::Progress progress = {});
  /// Takes denoiser and normaliser of a trained model, so that only texts are learnt anew. For a fresh run.
  void take_denoiser(const std::filesystem::path& model);
  /// One optimiser step; returns the loss.
  double step();
  const std::vector<float>& losses() const { return losses_; }

  /// Everything that is needed to go on, in float32.
  void save(const std::filesystem::path& checkpoint) const;
  /// Goes on where `checkpoint` stopped. Throws config_error 102 if that run had other settings, captions or sizes
  /// (`with_other_settings`: other sizes or captions), io_error 406, 407 if tensors are missing or wrong.
  void resume(const std::filesystem::path& checkpoint, bool with_other_settings = false);
  /// The averaged weights, in half precision.
  void export_model(const std::filesystem::path& path, const std::map<std::string, std::string>& about) const;

 private:
  std::map<std::string, std::string> settings() const;

  TrainingConfig config_;
  const TrainingSet* data_;
  ml::GaussianDiffusion diffusion_;
  ml::Stmc<A> model_;
  ml::Stmc<B> average_;
  ml::Linear<A> summary_;  // from a caption's vector to the summary of its motion; not part of the model
  ml::AdamW<A> adam_, adam_summary_;
  ml::Index steps_ = 0;
  std::vector<float> losses_;
};

}  // namespace program
