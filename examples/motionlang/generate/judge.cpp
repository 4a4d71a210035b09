// motionlang judge: does the model do what prompts say? Each prompt is generated with several seeds and measured.
//
// What counts as done is stated in numbers for each prompt (motionlang/generate/judged_prompts.hpp), so that a table of
// percentages can be compared between models, and with --compare between numbers of steps.
#include <cstdio>

#include <motionlang/file/safetensors.hpp>
#include <motionlang/generate/judged_prompts.hpp>
#include <motionlang/weights/run_folder.hpp>

#include "../commands.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "generation.hpp"

namespace program {

namespace {

using ml::Index;

struct JudgeOptions {
  std::string model = default_model().string(), backend = "eigen";
  ml::GenerateOptions settings;
  std::string sampler;  // "": the model's own
  int seeds = 10;
  bool details = false;
  std::vector<Index> compare;  // numbers of steps
  MachineOptions machine;
};

/// A table in Markdown: what fewer steps cost. The first number of steps is what the others are compared with.
void compare(const ml::MotionModel& generator, const JudgeOptions& o) {
  ml::check_options(generator, {.steps = std::ranges::max(o.compare)});
  std::printf(
      "| sampler | steps | prompts done | foot skate m/s | jitter m/s^3 | bone lengths +- %% | joints, mm away | "
      "processor s per s of motion |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  std::string scale;
  for (const std::string sampler : {"ddpm", "ddim"}) {
    ml::Judgement first;
    for (const Index steps : o.compare) {
      ml::GenerateOptions settings = o.settings;
      settings.sampler = ml::parse_sampler(sampler);
      settings.steps = steps;
      ProgressBar bar(sampler + " " + std::to_string(steps));
      settings.progress = bar;
      ml::Judgement j = ml::judge(generator, settings, o.seeds);
      bar.finish();
      if (first.motions() == 0) {
        first = j;
        if (o.seeds > 1) {
          char text[100];
          std::snprintf(text, sizeof text, " %s %.0f", sampler.c_str(),
                        1000 * ml::mean_distance(first, first, ml::judged_prompts().size()));
          scale += text;
        }
      }
      std::printf("| %s | %td | %.0f %% | %.3f | %.1f | %.1f | %.0f | %.2f |\n", sampler.c_str(), steps,
                  100.0 * static_cast<double>(j.done()) / static_cast<double>(j.motions()), j.skate, j.jitter,
                  100 * j.bones, 1000 * ml::mean_distance(first, j), j.seconds);
      std::fflush(stdout);
    }
  }
  std::printf("%s of %zu prompts. Joints: mean distance to the result of the same seed with %s",
              ml::counted(o.seeds, "seed").c_str(), ml::judged_prompts().size(),
              ml::counted(o.compare.front(), "step").c_str());
  std::printf(scale.empty() ? "\n" : "; between two seeds:%s mm\n", scale.c_str());
}

void run(const JudgeOptions& o) {
  o.machine.apply();
  const auto generator = load_generator(o.backend, ml::stmc_model_file(o.model));
  if (!o.compare.empty()) return compare(*generator, o);
  const ml::Judgement j = [&] {
    ProgressBar bar("judging");
    ml::GenerateOptions settings = o.settings;
    if (!o.sampler.empty()) settings.sampler = ml::parse_sampler(o.sampler);
    settings.progress = bar;
    return ml::judge(*generator, settings, o.seeds);
  }();
  std::printf("%-28s %-8s %s\n", "prompt", "done", "what counts");
  const auto& prompts = ml::judged_prompts();
  for (std::size_t i = 0; i < prompts.size(); ++i) {
    std::printf("%-28s %zu/%-6zu %s\n", prompts[i].text.c_str(), j.done(i), j.results[i].size(),
                prompts[i].rule.c_str());
    if (o.details) {
      for (const ml::PromptMeasures& m : j.results[i]) {
        std::printf(
            "    speed %.2f forward %+.2f turned %+4.0f pelvis %.2f>%.2f low %.2f hands L %+.2f R %+.2f both %+.2f "
            "speed %.1f head %.2f>%.2f feet %.2f %.2f both %.2f\n",
            m.speed, m.forward, m.turned, m.first_pelvis, m.last_pelvis, m.lowest_pelvis, m.left_hand, m.right_hand,
            m.both_hands, std::max(m.left_hand_speed, m.right_hand_speed), m.first_head, m.lowest_head, m.left_foot,
            m.right_foot, m.both_feet);
      }
    }
  }
  std::printf("%-28s %zu/%zu = %.0f %%\n", "all", j.done(), j.motions(),
              100.0 * static_cast<double>(j.done()) / static_cast<double>(j.motions()));
  std::printf("foot skate %.3f m/s, jitter %.1f m/s^3 (means over all motions)\n", j.skate, j.jitter);
  const auto about = ml::SafetensorsFile::open(ml::stmc_model_file(o.model)).metadata();
  if (about.contains("real.skate") && about.contains("real.jitter")) {
    const double real_skate = std::stod(about.at("real.skate")), real_jitter = std::stod(about.at("real.jitter"));
    std::printf("recordings: %.3f m/s, %.1f m/s^3; ratio %.2f and %.2f\n", real_skate, real_jitter,
                j.skate / real_skate, j.jitter / real_jitter);
  }
}

}  // namespace

void add_judge(CLI::App& app) {
  const auto o = std::make_shared<JudgeOptions>();
  CLI::App* c = app.add_subcommand(
      "judge", "Generates twelve prompts with several seeds, measures the motions, and prints how many succeed");
  c->add_option("--model", o->model,
                "Weights to judge. The default is the bundled model, or what MOTIONLANG_MODEL names");
  const auto compare = c->add_option("--compare", o->compare,
                                     "Numbers of steps. Prints a table of cost and quality for both samplers, compared "
                                     "with the first number (100 20 10 8 5)")
                           ->check(positive());
  c->add_option("--seeds", o->seeds, "Number of motions for each prompt")->check(positive())->capture_default_str();
  c->add_option("--guidance", o->settings.guidance,
                "Weight of the text; 1 means no guidance. The default is the model's own")
      ->check(in_range(0, 100));
  c->add_option("--steps", o->settings.steps,
                "Number of denoising steps; 0 takes all. The default is what the weights ask for")
      ->check(not_negative())
      ->excludes(compare);
  c->add_option("--sampler", o->sampler, "Sampler. The default is what the weights ask for")
      ->check(CLI::IsMember({"ddpm", "ddim"}))
      ->excludes(compare);
  c->add_flag("--smooth,!--no-smooth", o->settings.smooth, "Remove jitter. The default is on");
  c->add_flag("--fix-feet,!--no-fix-feet", o->settings.fix_feet, "Keep standing feet from sliding. The default is on")
      ->capture_default_str();
  c->add_option("--backend", o->backend, "Backend that computes")
      ->check(CLI::IsMember({"eigen", "xtensor", "reference"}))
      ->capture_default_str();
  c->add_flag("--details", o->details, "Print the measurements of every motion");
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
