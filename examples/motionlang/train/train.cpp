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
#include "processes.hpp"
#include "training_display.hpp"

namespace program {

namespace {

struct TrainOptions {
  std::string data, captions;
  ml::StmcTrainingConfig config;
  ml::TrainingOptions run;
  std::string license, provenance, commit, start, vectors;
  MachineOptions machine;
};

void run(const TrainOptions& o) {
  ml::TrainingOptions options = o.run;
  options.communicator = training_processes(o.run);
  o.machine.apply();
  make_output_folder("--out", o.run.out);
  auto data = [&] {
    ProgressBar bar("reading motions");
    return ml::TrainingSet(o.captions, o.data, bar);
  }();
  if (!o.config.practised.empty()) data.practise(o.config.practised, o.config.practice);
  std::printf("%s, %.1f minutes\n", ml::counted(data.segments().size(), "segment").c_str(), data.seconds() / 60);
  ml::Trainer trainer(ml::StmcTraining<ml::Autodiff<ml::EigenBackend<float>>>(
      o.config, data, o.vectors.empty() ? ml::WordVectors() : ml::read_word_vectors(o.vectors)));
  TrainingDisplay display;
  trainer.run(options, display.callbacks([&] {
    if (!o.start.empty()) trainer.task().start_from(o.start);
    if (o.config.text_steps > 0) {
      ProgressBar bar("learning texts");
      trainer.task().learn_texts(bar);
    }
  }));
  if (options.communicator.rank() > 0) return;  // the first process writes the model
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
  folder_option(*c, "--data", o->data, "Folder with the clips that the captions name")->required();
  file_option(*c, "--captions", o->captions,
              "Table of clips, with columns clip, start, end, body parts, captions; or clip, captions for whole clips")
      ->required();
  c->add_option("--out", o->run.out, "Folder for checkpoint, weights and loss curve")->capture_default_str();
  checked_option(*c, "--steps", o->config.steps, positive(), "Optimiser steps");
  checked_option(*c, "--batch", o->config.batch, positive(), "Sequences per step");
  checked_option(*c, "--lr", o->config.lr, positive(), "Peak learning rate");
  checked_option(*c, "--width", o->config.model.denoiser.latent_dim, positive(), "Width of the denoiser");
  checked_option(*c, "--feed-forward", o->config.model.denoiser.ff_size, positive(),
                 "Width of its feed-forward layers");
  checked_option(*c, "--layers", o->config.model.denoiser.num_layers, in_range(1, 256), "Layers of the denoiser");
  checked_option(*c, "--vocabulary", o->config.vocabulary, positive(), "Word pieces to learn");
  file_option(*c, "--word-vectors", o->vectors,
              "Vectors of words beyond those of the captions, from `motionlang word-vectors`. Every word that the "
              "captions say twice then is one piece");
  checked_option(*c, "--dropout", o->config.model.denoiser.dropout, in_range(0, 0.9), "Dropout of the denoiser");
  checked_option(*c, "--velocity-weight", o->config.velocity_weight, not_negative(),
                 "Weight of the loss on frame differences");
  checked_option(*c, "--root-weight", o->config.root_weight, not_negative(),
                 "Weight of the features that move the root");
  checked_option(*c, "--foot-weight", o->config.foot_weight, not_negative(),
                 "Weight of the loss on the velocity of the feet");
  checked_option(*c, "--text-weight", o->config.text_weight, not_negative(),
                 "Weight of the loss that predicts from a caption what happens: a summary of the motion, and its verb");
  checked_option(*c, "--verb-weight", o->config.verb_weight, not_negative(),
                 "Within it, the weight of the verb, against 1 for the summary");
  checked_option(*c, "--text-steps", o->config.text_steps, not_negative(),
                 "Number of first steps that train the text encoder alone. A training that is stopped during these "
                 "starts them over. With --start, the default is 0");
  file_option(*c, "--start", o->start,
              "Start with the weights of this model, which has the same sizes. Its words and features may differ");
  c->add_option("--practise", o->config.practised,
                "Words whose segments are drawn more often, for example \"march,look around\": what `motionlang judge` "
                "still sees fail")
      ->delimiter(',');
  checked_option(*c, "--practice", o->config.practice, positive(), "This many times as often")->needs("--practise");
  checked_option(*c, "--seed", o->config.seed, seed_number(),
                 "Seed. The same seed gives the same weights, also after a stop");
  c->add_option("--license", o->license, "Licence of the weights, for their metadata; the data must allow it");
  c->add_option("--provenance", o->provenance, "Origin of the data, for the metadata");
  c->add_option("--commit", o->commit, "Commit of the program, for the metadata");
  checked_option(*c, "--save-minutes", o->run.save_minutes, not_negative(), "Minutes between checkpoints");
  c->add_flag("--other-settings", o->run.other_settings,
              "Continue a checkpoint that began with other values (batch, rates, weights of losses, samples). The "
              "result then differs from that of a single command");
  checked_option(*c, "--noise-focus", o->config.noise_focus, in_range(0, 1),
                 "Share of the samples that come from the noisiest fifth");
  checked_option(*c, "--snr-cap", o->config.snr_cap, in_range(1, 1000),
                 "Largest weight of a sample that shows its motion clearly. 1: all samples weigh the same");
  c->add_flag("--fresh", o->run.fresh, "Start over even if there is a checkpoint");
  c->add_flag("--recompute", o->run.recompute, about_recompute);
  add_micro_batch_option(*c, o->run);
  o->machine.add_to(*c);
  c->callback([o, c] {
    if (!o->start.empty() && c->count("--text-steps") == 0) o->config.text_steps = 0;
    run(*o);
  });
}

}  // namespace program
