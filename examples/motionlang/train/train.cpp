// motionlang train: from BVH files and captions to the weights of a model.
#include <cstdio>
#include <filesystem>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/train/stmc_training.hpp>
#include <motionlang/train/stmc_training_notes.hpp>
#include <motionlang/weights/word_vector_file.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "training_display.hpp"

namespace program {

namespace {

struct TrainOptions {
  std::string data, captions;
  ml::StmcTrainingConfig config;
  ml::TrainingOptions run;
  std::string license, provenance, commit, denoiser, vectors;
  MachineOptions machine;
};

void run(const TrainOptions& o) {
  o.machine.apply();
  make_output_folder("--out", o.run.out);
  const auto data = [&] {
    ProgressBar bar("reading motions");
    return ml::TrainingSet(o.captions, o.data, bar);
  }();
  std::printf("%s, %.1f minutes\n", ml::counted(data.segments().size(), "segment").c_str(), data.seconds() / 60);
  ml::Trainer trainer(ml::StmcTraining<ml::Autodiff<ml::EigenBackend<float>>>(
      o.config, data, o.vectors.empty() ? ml::WordVectors() : ml::read_word_vectors(o.vectors)));
  TrainingDisplay display;
  trainer.run(o.run, display.callbacks([&] {
    if (!o.denoiser.empty()) trainer.task().take_denoiser(o.denoiser);
    if (o.config.text_steps > 0) {
      ProgressBar bar("learning texts");
      trainer.task().learn_texts(bar);
    }
  }));
  if (o.license.empty())
    std::printf("--license is missing: the metadata of the weights will not say who may use them\n");
  const auto weights = o.run.out / "stmc.safetensors", curve = o.run.out / "loss.svg";
  auto about = ml::stmc_training_notes(data);
  about.insert({{"license", o.license}, {"provenance", o.provenance}, {"command", command_line}, {"commit", o.commit}});
  trainer.task().export_model(weights, about);
  std::printf("weights  %s\nloss     %s\nTry them: motionlang generate --model %s --timeline FILE\n",
              weights.string().c_str(), curve.string().c_str(), weights.string().c_str());
}

}  // namespace

void add_train(CLI::App& app) {
  const auto o = std::make_shared<TrainOptions>();
  CLI::App* c = app.add_subcommand(
      "train",
      "Trains a text-to-motion model on captioned BVH, AMASS and AMC files. Ctrl-C saves; the same command continues");
  c->add_option("--data", o->data, "Folder with the clips that the captions name")
      ->required()
      ->check(CLI::ExistingDirectory);
  c->add_option(
       "--captions", o->captions,
       "Table of clips, with columns clip, start, end, body parts, captions; or clip, captions for whole clips")
      ->required()
      ->check(CLI::ExistingFile);
  c->add_option("--out", o->run.out, "Folder for checkpoint, weights and loss curve")->capture_default_str();
  c->add_option("--steps", o->config.steps, "Optimiser steps")->check(positive())->capture_default_str();
  c->add_option("--batch", o->config.batch, "Sequences per step")->check(positive())->capture_default_str();
  c->add_option("--lr", o->config.lr, "Peak learning rate")->check(positive())->capture_default_str();
  c->add_option("--width", o->config.model.denoiser.latent_dim, "Width of the denoiser")
      ->check(positive())
      ->capture_default_str();
  c->add_option("--feed-forward", o->config.model.denoiser.ff_size, "Width of its feed-forward layers")
      ->check(positive())
      ->capture_default_str();
  c->add_option("--layers", o->config.model.denoiser.num_layers, "Layers of the denoiser")
      ->check(in_range(1, 256))
      ->capture_default_str();
  c->add_option("--vocabulary", o->config.vocabulary, "Word pieces to learn")->check(positive())->capture_default_str();
  c->add_option("--word-vectors", o->vectors,
                "Vectors of words beyond those of the captions, from `motionlang word-vectors`. Every word that the "
                "captions say twice then is one piece")
      ->check(CLI::ExistingFile);
  c->add_option("--dropout", o->config.model.denoiser.dropout, "Dropout of the denoiser")
      ->check(in_range(0, 0.9))
      ->capture_default_str();
  c->add_option("--velocity-weight", o->config.velocity_weight, "Weight of the loss on frame differences")
      ->check(not_negative())
      ->capture_default_str();
  c->add_option("--root-weight", o->config.root_weight, "Weight of the features that move the root")
      ->check(not_negative())
      ->capture_default_str();
  c->add_option("--foot-weight", o->config.foot_weight, "Weight of the loss on the velocity of the feet")
      ->check(not_negative())
      ->capture_default_str();
  c->add_option("--text-weight", o->config.text_weight,
                "Weight of the loss that predicts a summary of the motion from its caption")
      ->check(not_negative())
      ->capture_default_str();
  c->add_option("--text-steps", o->config.text_steps,
                "Number of first steps that train the text encoder alone. A training that is stopped during these "
                "starts them over")
      ->check(not_negative())
      ->capture_default_str();
  c->add_option("--denoiser", o->denoiser, "Start with the denoiser of this model and train only the texts")
      ->check(CLI::ExistingFile);
  c->add_option("--seed", o->config.seed, "Seed. The same seed gives the same weights, also after a stop")
      ->check(seed_number())
      ->capture_default_str();
  c->add_option("--license", o->license, "Licence of the weights, for their metadata; the data must allow it");
  c->add_option("--provenance", o->provenance, "Origin of the data, for the metadata");
  c->add_option("--commit", o->commit, "Commit of the program, for the metadata");
  c->add_option("--save-minutes", o->run.save_minutes, "Minutes between checkpoints")
      ->check(not_negative())
      ->capture_default_str();
  c->add_flag("--other-settings", o->run.other_settings,
              "Continue a checkpoint that began with other values (batch, rates, weights of losses, samples). The "
              "result then differs from that of a single command");
  c->add_option("--noise-focus", o->config.noise_focus, "Share of the samples that come from the noisiest fifth")
      ->check(in_range(0, 1))
      ->capture_default_str();
  c->add_flag("--fresh", o->run.fresh, "Start over even if there is a checkpoint");
  c->add_flag("--recompute", o->run.recompute, about_recompute);
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
