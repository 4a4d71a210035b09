// motionlang judge: measures if a model follows its prompts. Each prompt is generated with several seeds.
//
// Each verb has a rule in numbers for "done" (motionlang/generate/judged_verbs.hpp). So the percentages of models can
// be compared, and with --compare those of numbers of steps. --clips measures recorded motions in the same way.
#include <cstdio>

#include <motionlang/file/file.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/generate/judgement_report.hpp>
#include <motionlang/weights/known_caption_file.hpp>
#include <motionlang/weights/run_folder.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "../train/processes.hpp"
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
  std::string bench = "own";
  std::vector<double> seconds;  // of each prompt; none: its default
  std::string clips, captions, strips, prompts;
  bool remember = false;
  std::vector<Index> compare;  // numbers of steps
  MachineOptions machine;
};

/// A table in Markdown: the loss with fewer steps. The first number of steps is the reference.
void compare(const ml::MotionModel& generator, const JudgeOptions& o) {
  ml::check_options(generator, {.steps = std::ranges::max(o.compare)});
  print(ml::steps_cost_header());
  std::string scale;
  for (const std::string_view name : ml::sampler_names) {
    const std::string sampler(name);
    ml::GenerateOptions settings = o.settings;
    settings.sampler = ml::parse_sampler(sampler);
    ProgressBar bar(sampler);
    settings.progress = bar;
    const auto on_row = [&](const ml::StepsCost& row) {
      bar.finish();
      print(ml::steps_cost_row(sampler, row));
      std::fflush(stdout);
    };
    const auto rows = ml::steps_costs(generator, ml::own_prompts(), settings, o.compare, o.seeds, on_row);
    if (o.seeds > 1) scale += formatted(" %s %.0f", sampler.c_str(), 1000 * rows.front().seeds_apart);
  }
  std::printf("%s of %zu prompts. Joints: mean distance to the result of the same seed with %s",
              ml::counted(o.seeds, "seed").c_str(), ml::own_prompts().size(),
              ml::counted(o.compare.front(), "step").c_str());
  std::printf(scale.empty() ? "\n" : "; between two seeds:%s mm\n", scale.c_str());
}

std::vector<ml::JudgedBench> benches_of(const JudgeOptions& o) {
  if (!o.prompts.empty()) {
    const std::string text = ml::read_file(o.prompts);
    const auto prompts = [=](double seconds) { return ml::parse_judged_prompts(text, seconds, o.prompts); };
    return {{"prompts", "prompts of " + o.prompts, prompts, 0}};
  }
  std::vector<ml::JudgedBench> out;
  for (const ml::JudgedBench& bench : ml::judged_benches()) {
    if (o.bench == "all" || o.bench == bench.name) out.push_back(bench);
  }
  return out;
}

ml::Judgement judged(const ml::MotionModel& generator, const JudgeOptions& o, const ml::JudgedBench& bench,
                     double seconds) {
  ProgressBar bar("judging " + bench.name);
  ml::GenerateOptions settings = o.settings;
  if (!o.sampler.empty()) settings.sampler = ml::parse_sampler(o.sampler);
  settings.progress = bar;
  return ml::judge(generator, bench.prompts(seconds), settings, o.seeds, !o.strips.empty(), processes());
}

void print_warnings(const ml::MotionModel& model, const ml::Judgement& j) {
  if (model.captions().empty()) return;
  const ml::WarningShares w = ml::warning_shares(model, j);
  std::printf("warnings about meaning: %.0f %% of %s have none, %.0f %% of %zu successes have one\n",
              100 * w.silent_failures, ml::counted(w.failures, "failure").c_str(), 100 * w.warned_successes,
              w.successes);
}

void judge_clips(const JudgeOptions& o) {
  const ml::RecordedFigures figures = [&] {
    ProgressBar bar("reading clips");
    const ml::TrainingSet set(o.captions, o.clips, bar);
    bar.finish();
    return ml::judge_recordings(set.segments());
  }();
  print(ml::describe_recordings(figures, o.details));
}

/// Writes into the weights which texts were tried and how many motions did what they say.
void remember(const ml::MotionModel& generator, const JudgeOptions& o, const std::vector<ml::Judgement>& judgements) {
  const auto captions = ml::with_judged(generator.captions(), judgements);
  ml::replace_known_captions(ml::stmc_model_file(o.model), captions);
  std::printf("%s know %s that were tried\n", ml::stmc_model_file(o.model).string().c_str(),
              ml::counted(captions.done().size(), "text").c_str());
}

void run(const JudgeOptions& o) {
  o.machine.apply();
  const bool first = processes().rank() == 0;
  if (!o.clips.empty() || !o.compare.empty())
    require_one_process(o.clips.empty() ? "judge --compare" : "judge --clips");
  if (!o.clips.empty()) return judge_clips(o);
  const auto generator = load_generator(o.backend, o.model);
  if (o.remember && generator->captions().empty())
    ml::raise<usage_error>(102, o.model, ": --remember is for weights with their captions, which train writes");
  if (!o.compare.empty()) return compare(*generator, o);
  std::string summary;
  std::vector<ml::Judgement> judgements;
  for (const ml::JudgedBench& bench : benches_of(o)) {
    for (const double seconds : o.seconds.empty() ? std::vector<double>{bench.seconds} : o.seconds) {
      const ml::Judgement& j = judgements.emplace_back(judged(*generator, o, bench, seconds));
      if (first && !o.strips.empty()) ml::write_judged_strips(o.strips, ml::concat_text(bench.name, "_", seconds), j);
      summary += ml::judgement_row(j, bench.about, seconds);
      if (seconds > 0)
        std::printf(o.prompts.empty() ? "%s, %g s each\n" : "%s, %g s where a line names none\n", bench.about.c_str(),
                    seconds);
      print(ml::describe_judgement(j, o.details));
      print_warnings(*generator, j);
      std::fflush(stdout);
    }
  }
  if (o.bench == "all" || o.seconds.size() > 1) print(ml::judgement_header() + summary);
  if (first && o.remember) remember(*generator, o, judgements);
  if (!ml::find_motion_model(o.model).system.empty()) return;  // only weights of train have figures of recordings
  const auto file = ml::SafetensorsFile::open(ml::stmc_model_file(o.model));
  print(ml::recordings_line(file.metadata(), file.name()));
}

}  // namespace

void add_judge(CLI::App& app) {
  const auto o = std::make_shared<JudgeOptions>();
  CLI::App* c = app.add_subcommand(
      "judge", "Generates prompts with several seeds, measures the motions, and prints how many succeed");
  c->add_option("--model", o->model,
                "Weights to judge. The default is the bundled model, or what MOTIONLANG_MODEL names");
  const auto compare = c->add_option("--compare", o->compare,
                                     "Numbers of steps. Prints a table of cost and quality for each sampler, compared "
                                     "with the first number (100 20 10 8 5)")
                           ->check(positive());
  checked_option(*c, "--seeds", o->seeds, positive(), "Number of motions for each prompt");
  c->add_option("--guidance", o->settings.guidance,
                "Weight of the text; 1 means no guidance. The default is the model's own")
      ->check(in_range(0, 100));
  c->add_option("--recall", o->settings.recall, recall_help)->check(in_range(0, 1));
  c->add_option("--steps", o->settings.steps,
                "Number of denoising steps; 0 takes all. The default is what the weights ask for")
      ->check(not_negative())
      ->excludes(compare);
  sampler_option(*c, o->sampler)->excludes(compare);
  c->add_flag("--smooth,!--no-smooth", o->settings.smooth, "Remove jitter. The default is on");
  c->add_flag("--fix-feet,!--no-fix-feet", o->settings.fix_feet, "Keep standing feet from sliding. The default is on")
      ->capture_default_str();
  c->add_flag("--fix-floor,!--no-fix-floor", o->settings.fix_floor,
              "Keep the body on the floor: it does not hover or sink, and jumps follow arcs")
      ->capture_default_str();
  c->add_flag("--overlay-arms,!--no-overlay-arms", o->settings.overlay_arms,
              "If an arm does not do what its text says, replace it by the arm of a motion from that text alone. This "
              "takes a second pass")
      ->capture_default_str();
  checked_option(*c, "--backend", o->backend, CLI::IsMember({"eigen", "xtensor", "reference"}),
                 "Backend for the computation");
  c->add_flag("--details", o->details, "Print for every motion why it fails");
  c->add_option("--bench", o->bench,
                "own: twelve prompts that the bundled model knows; newcomers: 56 that newcomers type; arms, trunk: "
                "arms, or head and "
                "spine over ten base movements; paraphrases; or all")
      ->check(CLI::IsMember({"own", "newcomers", "arms", "trunk", "paraphrases", "all"}))
      ->excludes(compare)
      ->capture_default_str();
  file_option(
      *c, "--prompts", o->prompts,
      "Prompts of your own instead: a file with lines 'text # verb # seconds'. The verb has the rule. An unknown "
      "verb is an error that lists all of them")
      ->excludes(compare)
      ->excludes("--bench");
  c->add_option("--seconds", o->seconds,
                "Lengths of the motions, as in 2,4,8. The default is 4; own prompts have lengths of their own")
      ->delimiter(',')
      ->check(in_range(0.5, 3600))
      ->excludes(compare);
  const auto clips =
      folder_option(*c, "--clips", o->clips, "Folder of recorded clips to judge instead of generated motions");
  const auto captions =
      file_option(*c, "--captions", o->captions, "File of captions of these clips, as `train` reads it")->needs(clips);
  clips->needs(captions);
  checked_option(*c, "--first-seed", o->settings.seed, seed_number(), "First seed; the others follow it");
  c->add_flag("--remember", o->remember,
              "Write into the weights which texts were tried and how often they succeeded. generate then warns about "
              "texts like those that mostly fail. Judge with another --first-seed afterwards")
      ->excludes(compare);
  c->add_option("--strips", o->strips, "Folder for a film strip of every motion (PNG)")->check(not_empty());
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
