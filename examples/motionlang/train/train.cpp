// motionlang train: from BVH files and captions to the weights of a model.
#include <cstdio>
#include <memory>
#include <string>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "processes.hpp"
#include "stmc_run.hpp"
#include "training_display.hpp"

namespace program {

namespace {

struct TrainOptions : StmcRun {
  std::string license, provenance, commit;
  MachineOptions machine;
};

void run(TrainOptions o) {
  o.run.communicator = training_processes(o.run);
  o.machine.apply();
  make_output_folder("--out", o.run.out);
  if (o.license.empty() && o.run.communicator.rank() == 0)
    std::printf("--license is missing: the metadata of the weights will not say who may use them\n");
  o.about = {{"license", o.license}, {"provenance", o.provenance}, {"commit", o.commit}};
  run_stmc(o);
}

}  // namespace

void add_train(CLI::App& app) {
  const auto o = std::make_shared<TrainOptions>();
  CLI::App* c = app.add_subcommand(
      "train",
      "Trains a text-to-motion model on captioned BVH, AMASS and AMC files, as train-mdm-smpl --preset bundled does. "
      "Ctrl-C saves; the same command continues");
  folder_option(*c, "--data", o->data, "Folder with the clips that the captions name")->required();
  file_option(*c, "--captions", o->captions,
              "Table of clips, with columns clip, start, end, body parts, captions; or clip, captions for whole clips")
      ->required();
  c->add_option("--out", o->run.out, "Folder for checkpoint, weights and loss curve")->capture_default_str();
  checked_option(*c, "--steps", o->config.updates, positive(), "Optimiser steps");
  checked_option(*c, "--batch", o->config.optimiser.batch, positive(), "Sequences per step");
  checked_option(*c, "--lr", o->config.optimiser.lr, positive(), "Peak learning rate");
  checked_option(*c, "--width", o->config.network.latent_dim, positive(), "Width of the denoiser");
  checked_option(*c, "--feed-forward", o->config.network.ff_size, positive(), "Width of its feed-forward layers");
  checked_option(*c, "--layers", o->config.network.num_layers, in_range(1, 256), "Layers of the denoiser");
  checked_option(*c, "--vocabulary", o->config.vocabulary, positive(), "Word pieces to learn");
  add_start_options(*c, *o);
  checked_option(*c, "--dropout", o->config.network.dropout, in_range(0, 0.9), "Dropout of the denoiser");
  checked_option(*c, "--velocity-weight", o->config.losses.velocity, not_negative(),
                 "Weight of the loss on frame differences");
  checked_option(*c, "--root-weight", o->config.losses.root, not_negative(),
                 "Weight of the features that move the root");
  checked_option(*c, "--foot-weight", o->config.losses.foot, not_negative(),
                 "Weight of the loss on the velocity of the feet");
  checked_option(*c, "--text-weight", o->config.losses.text, not_negative(),
                 "Weight of the loss that predicts from a caption what happens: a summary of the motion, and its verb");
  checked_option(*c, "--verb-weight", o->config.losses.verb, not_negative(),
                 "Within it, the weight of the verb, against 1 for the summary");
  checked_option(*c, "--text-steps", o->config.text_steps, not_negative(),
                 "Number of first steps that train the text encoder alone. A training that is stopped during these "
                 "starts them over. With --start, the default is 0");
  c->add_option("--practise", o->config.practised,
                "Words whose segments are drawn more often, for example \"march,look around\": what `motionlang judge` "
                "still sees fail")
      ->delimiter(',');
  checked_option(*c, "--practice", o->config.practice, positive(), "This many times as often")->needs("--practise");
  checked_option(*c, "--seed", o->config.optimiser.seed, seed_number(),
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
  checked_option(*c, "--snr-cap", o->config.losses.snr_cap, in_range(1, 1000),
                 "Largest weight of a sample that shows its motion clearly. 1: all samples weigh the same");
  c->add_flag("--fresh", o->run.fresh, "Start over even if there is a checkpoint");
  c->add_flag("--recompute", o->run.recompute, about_recompute);
  add_micro_batch_option(*c, o->run);
  o->machine.add_to(*c);
  c->callback([o, c] {
    if (c->count("--text-steps") == 0) skip_texts_of(*o);
    run(*o);
  });
}

}  // namespace program
