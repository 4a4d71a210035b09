// motionlang train: from BVH files and captions to the weights of a model.
#include <cstdio>
#include <filesystem>

#include <motionlang/core/parallel.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "progress_bar.hpp"
#include "trainer.hpp"

namespace program {

namespace {

struct Options {
  std::string data, captions, out = "training";
  TrainingConfig config;
  double save_minutes = 5;
  std::string license = "MIT", provenance, commit, denoiser;
  bool fresh = false, other_settings = false;
  int threads = 0;
};

/// Loss over steps as a picture: mean of groups of steps, logarithmic height.
std::string loss_curve_svg(const std::vector<float>& losses) {
  constexpr int width = 800, height = 360, left = 60, bottom = 40;
  const std::size_t groups = std::min<std::size_t>(200, losses.size());
  std::vector<double> mean;
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t a = losses.size() * g / groups, b = losses.size() * (g + 1) / groups;
    double total = 0;
    for (std::size_t i = a; i < b; ++i) total += static_cast<double>(losses[i]);
    mean.push_back(std::log10(total / static_cast<double>(b - a)));
  }
  const auto [low, high] = std::minmax_element(mean.begin(), mean.end());
  std::string points;
  for (std::size_t g = 0; g < groups; ++g) {
    const double x = left + (width - left - 20) * (static_cast<double>(g) + 0.5) / static_cast<double>(groups);
    const double y = 20 + (height - bottom - 20) * (*high - mean[g]) / std::max(1e-6, *high - *low);
    points += ml::concat_text(x, ",", y, " ");
  }
  auto label = [](double x, double y, const std::string& text) {
    return ml::concat_text("<text x='", x, "' y='", y, "' font-family='sans-serif' font-size='13' fill='#555'>", text,
                           "</text>");
  };
  return ml::concat_text("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 ", width, " ", height,
                         "'><rect width='100%' height='100%' fill='white'/>", "<polyline points='", points,
                         "' fill='none' stroke='#2676ba' stroke-width='2'/>",
                         label(8, 26, ml::concat_text(std::pow(10, *high)).substr(0, 6)),
                         label(8, height - bottom, ml::concat_text(std::pow(10, *low)).substr(0, 6)),
                         label(left, height - 12, "training loss over "),
                         label(left + 130, height - 12, std::to_string(losses.size()) + " steps"), "</svg>\n");
}

/// How the recordings themselves skate and shake: what generated motions are compared with (motionlang judge).
std::map<std::string, std::string> quality_of(const TrainingSet& data) {
  double skate = 0, jitter = 0;
  for (const Segment& s : data.segments()) {
    const auto q = ml::motion_quality(s.motion);
    skate += q.feet.speed;
    jitter += q.jitter;
  }
  const auto n = static_cast<double>(data.segments().size());
  return {{"real.skate", ml::concat_text(skate / n)}, {"real.jitter", ml::concat_text(jitter / n)}};
}

void run(const Options& o) {
  if (o.threads > 0) ml::set_thread_count(o.threads);
  std::filesystem::create_directories(o.out);
  const auto checkpoint = std::filesystem::path(o.out) / "checkpoint.safetensors";
  const auto data = [&] {
    ProgressBar bar("reading motions");
    return TrainingSet(o.captions, o.data, bar);
  }();
  std::printf("%zu segments, %.1f minutes\n", data.segments().size(), data.seconds() / 60);
  Trainer trainer(o.config, data);
  if (!o.fresh && std::filesystem::exists(checkpoint)) {
    trainer.resume(checkpoint, o.other_settings);
    std::printf("going on at step %td of %td\n", trainer.steps_done(), o.config.steps);
  } else {
    if (!o.denoiser.empty()) trainer.take_denoiser(o.denoiser);
    if (o.config.text_steps > 0) {
      ProgressBar bar("learning texts");
      trainer.learn_texts(bar);
    }
    trainer.save(checkpoint);
  }
  {
    ProgressBar bar("training", trainer.steps_done());
    auto saved = std::chrono::steady_clock::now();
    double shown = 0;
    while (trainer.steps_done() < o.config.steps) {
      const double loss = trainer.step();
      shown = shown == 0 ? loss : 0.98 * shown + 0.02 * loss;
      bar.note("loss " + ml::concat_text(shown).substr(0, 6));
      const bool go_on = bar(trainer.steps_done(), o.config.steps);
      const auto now = std::chrono::steady_clock::now();
      if (!go_on || now - saved > std::chrono::duration<double>(60 * o.save_minutes)) {
        trainer.save(checkpoint);
        saved = now;
      }
      if (!go_on) {
        bar.finish();
        std::fprintf(stderr, "stopped at step %td; the same command goes on from %s\n", trainer.steps_done(),
                     checkpoint.c_str());
        throw ml::cancelled();
      }
    }
  }
  trainer.save(checkpoint);
  const auto weights = std::filesystem::path(o.out) / "stmc.safetensors",
             curve = std::filesystem::path(o.out) / "loss.svg";
  auto about = quality_of(data);
  about.insert({{"license", o.license},
                {"provenance", o.provenance},
                {"data", std::to_string(data.segments().size()) + " captioned segments, " +
                             ml::concat_text(std::floor(data.seconds() / 6) / 10) + " minutes"},
                {"command", command_line},
                {"commit", o.commit},
                {"version", MOTIONLANG_VERSION}});
  trainer.export_model(weights, about);
  ml::write_file(curve, loss_curve_svg(trainer.losses()));
  std::printf("weights  %s\nloss     %s\nTry them: motionlang generate --model %s --timeline FILE\n", weights.c_str(),
              curve.c_str(), weights.c_str());
}

}  // namespace

void add_train(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand(
      "train", "Trains a model on captioned BVH and AMC files; Ctrl-C saves, the same command goes on");
  c->add_option("--data", o->data, "Folder with the clips that the captions name")
      ->required()
      ->check(CLI::ExistingDirectory);
  c->add_option("--captions", o->captions, "captions.tsv: clip, start, end, body parts, captions")
      ->required()
      ->check(CLI::ExistingFile);
  c->add_option("--out", o->out, "Folder for checkpoint, weights and loss curve")->capture_default_str();
  c->add_option("--steps", o->config.steps, "Optimiser steps")->capture_default_str();
  c->add_option("--batch", o->config.batch, "Sequences per step")->capture_default_str();
  c->add_option("--lr", o->config.lr, "Peak learning rate")->capture_default_str();
  c->add_option("--width", o->config.model.denoiser.latent_dim, "Width of the denoiser")->capture_default_str();
  c->add_option("--feed-forward", o->config.model.denoiser.ff_size, "Width of its feed-forward layers")
      ->capture_default_str();
  c->add_option("--layers", o->config.model.denoiser.num_layers, "Layers of the denoiser")->capture_default_str();
  c->add_option("--vocabulary", o->config.vocabulary, "Word pieces to learn")->capture_default_str();
  c->add_option("--dropout", o->config.model.denoiser.dropout, "Dropout of the denoiser")->capture_default_str();
  c->add_option("--velocity-weight", o->config.velocity_weight, "Weight of the loss on frame differences")
      ->capture_default_str();
  c->add_option("--root-weight", o->config.root_weight, "Weight of the features that move the root")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  c->add_option("--foot-weight", o->config.foot_weight, "Weight of the loss on the velocity of the feet")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  c->add_option("--text-weight", o->config.text_weight,
                "Weight of the loss that asks captions for a summary of their motion")
      ->capture_default_str();
  c->add_option("--text-steps", o->config.text_steps, "Steps of the text encoder alone, at the beginning")
      ->capture_default_str();
  c->add_option("--denoiser", o->denoiser, "Begin with the denoiser of this model; only texts are learnt anew")
      ->check(CLI::ExistingFile);
  c->add_option("--seed", o->config.seed, "Same seed, same weights, stopped and resumed or not")->capture_default_str();
  c->add_option("--license", o->license, "Licence of the weights, for their metadata")->capture_default_str();
  c->add_option("--provenance", o->provenance, "Where the data come from, for the metadata");
  c->add_option("--commit", o->commit, "Commit of the program, for the metadata");
  c->add_option("--save-minutes", o->save_minutes, "Minutes between checkpoints")->capture_default_str();
  c->add_flag("--other-settings", o->other_settings,
              "Go on with a checkpoint that began with other numbers (batch, rates, weights of losses, samples); the "
              "result is then no longer that of one "
              "command");
  c->add_option("--noise-focus", o->config.noise_focus, "Share of the samples that come from the noisiest fifth")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  c->add_flag("--fresh", o->fresh, "Start anew even if there is a checkpoint");
  c->add_option("--threads", o->threads, "Threads; as many as the machine has unless given")
      ->check(CLI::Range(1, 1024));
  c->callback([o] { run(*o); });
}

}  // namespace program
