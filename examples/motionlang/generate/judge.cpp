// motionlang judge: measures if a model follows its prompts. Each prompt is generated with several seeds.
//
// Each verb has a rule in numbers for "done" (motionlang/generate/judged_verbs.hpp). So the percentages of models can
// be compared, and with --compare those of numbers of steps. --clips measures recorded motions in the same way.
#include <cstdio>

#include <motionlang/core/quantile.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/generate/judged_clips.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/weights/known_caption_file.hpp>
#include <motionlang/weights/run_folder.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
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
  std::printf(
      "| sampler | steps | prompts done | foot skate m/s | jitter m/s^3 | bone lengths +- %% | joints, mm away | "
      "processor s per s of motion |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  std::string scale;
  for (const std::string sampler : {"ddpm", "ddim"}) {
    ml::GenerateOptions settings = o.settings;
    settings.sampler = ml::parse_sampler(sampler);
    ProgressBar bar(sampler);
    settings.progress = bar;
    const auto print = [&](const ml::StepsCost& row) {
      bar.finish();
      std::printf("| %s | %td | %.0f %% | %.3f | %.1f | %.1f | %.0f | %.2f |\n", sampler.c_str(), row.steps,
                  100 * row.done, row.skate, row.jitter, 100 * row.bones, 1000 * row.away, row.seconds);
      std::fflush(stdout);
    };
    const auto rows = ml::steps_costs(generator, ml::own_prompts(), settings, o.compare, o.seeds, print);
    if (o.seeds > 1) scale += formatted(" %s %.0f", sampler.c_str(), 1000 * rows.front().seeds_apart);
  }
  std::printf("%s of %zu prompts. Joints: mean distance to the result of the same seed with %s",
              ml::counted(o.seeds, "seed").c_str(), ml::own_prompts().size(),
              ml::counted(o.compare.front(), "step").c_str());
  std::printf(scale.empty() ? "\n" : "; between two seeds:%s mm\n", scale.c_str());
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

std::vector<ml::JudgedBench> benches_of(const JudgeOptions& o) {
  if (!o.prompts.empty()) {
    const std::string text = ml::read_file(o.prompts);
    const auto prompts = [=](double seconds) { return ml::parse_judged_prompts(text, seconds, o.prompts); };
    return {{"prompts", "prompts of " + o.prompts, prompts}};
  }
  std::vector<ml::JudgedBench> out;
  for (const ml::JudgedBench& bench : ml::judged_benches()) {
    if (o.bench == "all" || o.bench == bench.name) out.push_back(bench);
  }
  return out;
}

std::vector<double> seconds_of(const JudgeOptions& o, const ml::JudgedBench& bench) {
  if (!o.seconds.empty()) return o.seconds;
  return {bench.name == "own" ? 0.0 : 4.0};
}

ml::Judgement judged(const ml::MotionModel& generator, const JudgeOptions& o, const ml::JudgedBench& bench,
                     double seconds) {
  ProgressBar bar("judging " + bench.name);
  ml::GenerateOptions settings = o.settings;
  if (!o.sampler.empty()) settings.sampler = ml::parse_sampler(o.sampler);
  settings.progress = bar;
  return ml::judge(generator, bench.prompts(seconds), settings, o.seeds, !o.strips.empty());
}

/// Writes a picture of every motion. Its title is the verdict.
void write_strips(const ml::Judgement& j, const std::string& folder, const std::string& name) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < j.made.size(); ++i) {
    const std::size_t prompt = i % j.prompts.size(), seed = i / j.prompts.size();
    const auto& why = j.verdicts[prompt][seed].why_not;
    const std::string title = j.prompts[prompt].name() + ": " + (why.empty() ? "done" : why);
    const auto file = name + "_" + std::to_string(prompt) + "_" + std::to_string(seed) + ".png";
    ml::write_png(std::filesystem::path(folder) / file,
                  ml::film_strip_picture(j.made[i], {}, {.width = 1000, .title = title, .resolution = 1}));
  }
}

void print_prompts(const ml::Judgement& j, bool details) {
  std::printf("%-44s %-8s %s\n", "prompt", "done", "what counts");
  for (std::size_t i = 0; i < j.prompts.size(); ++i) {
    std::printf("%-44s %zu/%-6zu %s\n", j.prompts[i].name().c_str(), j.done(i), j.verdicts[i].size(),
                j.prompts[i].rule().c_str());
    for (std::size_t seed = 0; details && seed < j.verdicts[i].size(); ++seed) {
      const ml::Verdict& v = j.verdicts[i][seed];
      std::printf("    seed %zu: %s (ahead %.2f m/s, air %.2f s, turned %.0f)\n", seed,
                  v.why_not.empty() ? "done" : v.why_not.c_str(), v.speed, v.air, v.turned);
    }
  }
  std::printf("%-44s %zu/%zu = %.0f %%\n", "all", j.done(), j.motions(), percent(j.done(), j.motions()));
}
void print_shares(double hovering, double sinking, double statues) {
  std::printf("hovering %.1f %%, sinking %.1f %%, statues %.1f %%\n", 100 * hovering, 100 * sinking, 100 * statues);
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
  std::printf("recordings: %zu segments on the floor, %zu elsewhere left out\n", figures.segments, figures.elsewhere);
  print_shares(figures.hovering, figures.sinking, figures.statues);
  std::printf("%-36s %8s %8s %8s %8s %8s\n", "", "median", "90 %", "95 %", "99 %", "largest");
  for (const ml::RecordedMeasure& m : figures.measures) {
    std::printf("%-36s", m.name.c_str());
    for (const double share : {0.5, 0.9, 0.95, 0.99, 1.0}) std::printf(" %8.3f", ml::quantile(m.values, share));
    std::printf("\n");
  }
  std::printf("%-24s %-10s %-24s %-24s %s\n", "caption says", "done", "ahead m/s, 5 50 95 %", "air s",
              "turned, degrees");
  for (const ml::RecordedVerb& v : figures.verbs) {
    if (v.segments == 0) continue;
    std::printf("%-24s %3zu/%-6zu", v.name.c_str(), v.done, v.segments);
    for (const auto* values : {&v.speed, &v.air, &v.turned})
      std::printf("  %6.2f %6.2f %6.2f  ", ml::quantile(*values, 0.05), ml::quantile(*values, 0.5),
                  ml::quantile(*values, 0.95));
    std::printf("\n");
    for (std::size_t i = 0; o.details && i < v.why_not.size(); ++i) std::printf("    %s\n", v.why_not[i].c_str());
  }
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
  if (!o.clips.empty()) return judge_clips(o);
  const auto generator = load_generator(o.backend, ml::stmc_model_file(o.model));
  if (o.remember && generator->captions().empty())
    ml::raise<usage_error>(102, o.model, ": --remember is for weights with their captions, which train writes");
  if (!o.compare.empty()) return compare(*generator, o);
  std::string summary;
  std::vector<ml::Judgement> judgements;
  for (const ml::JudgedBench& bench : benches_of(o)) {
    for (const double seconds : seconds_of(o, bench)) {
      const ml::Judgement& j = judgements.emplace_back(judged(*generator, o, bench, seconds));
      if (!o.strips.empty()) write_strips(j, o.strips, bench.name + "_" + std::to_string(static_cast<int>(seconds)));
      summary += formatted("| %s | %s | %.0f %% | %.1f / %.1f / %.1f %% | %.3f | %.0f |\n", bench.about.c_str(),
                           seconds > 0 ? formatted("%d s", static_cast<int>(seconds)).c_str() : "own",
                           percent(j.done(), j.motions()), 100 * j.hovering(), 100 * j.sinking(), 100 * j.statues(),
                           j.skate, j.jitter);
      if (seconds > 0) std::printf("%s, %g s each\n", bench.about.c_str(), seconds);
      print_prompts(j, o.details);
      std::printf("foot skate %.3f m/s, jitter %.1f m/s^3 (means over all motions)\n", j.skate, j.jitter);
      print_shares(j.hovering(), j.sinking(), j.statues());
      print_warnings(*generator, j);
      std::fflush(stdout);
    }
  }
  if (o.bench == "all" || o.seconds.size() > 1)
    std::printf(
        "| prompts | length | done | hovering / sinking / statues | foot skate m/s | jitter m/s^3 "
        "|\n|---|---|---|---|---|---|\n%s",
        summary.c_str());
  if (o.remember) remember(*generator, o, judgements);
  const auto about = ml::SafetensorsFile::open(ml::stmc_model_file(o.model)).metadata();
  if (about.contains("real.skate") && about.contains("real.jitter"))
    std::printf("recordings: foot skate %.3f m/s, jitter %.1f m/s^3\n", std::stod(about.at("real.skate")),
                std::stod(about.at("real.jitter")));
}

}  // namespace

void add_judge(CLI::App& app) {
  const auto o = std::make_shared<JudgeOptions>();
  CLI::App* c = app.add_subcommand(
      "judge", "Generates prompts with several seeds, measures the motions, and prints how many succeed");
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
  c->add_flag("--fix-floor,!--no-fix-floor", o->settings.fix_floor,
              "Keep the body on the floor: it does not hover or sink, and jumps follow arcs")
      ->capture_default_str();
  c->add_flag("--overlay-arms,!--no-overlay-arms", o->settings.overlay_arms,
              "If an arm does not do what its text says, replace it by the arm of a motion from that text alone. This "
              "takes a second pass")
      ->capture_default_str();
  c->add_option("--backend", o->backend, "Backend for the computation")
      ->check(CLI::IsMember({"eigen", "xtensor", "reference"}))
      ->capture_default_str();
  c->add_flag("--details", o->details, "Print for every motion why it fails");
  c->add_option("--bench", o->bench,
                "own: twelve prompts that the bundled model knows; newcomers: 56 that newcomers type; arms, trunk: "
                "arms, or head and "
                "spine over ten base movements; paraphrases; or all")
      ->check(CLI::IsMember({"own", "newcomers", "arms", "trunk", "paraphrases", "all"}))
      ->excludes(compare)
      ->capture_default_str();
  c->add_option(
       "--prompts", o->prompts,
       "Prompts of your own instead: a file with lines 'text # verb # seconds'. The verb has the rule. An unknown "
       "verb is an error that lists all of them")
      ->check(CLI::ExistingFile)
      ->excludes(compare)
      ->excludes("--bench");
  c->add_option("--seconds", o->seconds,
                "Lengths of the motions, as in 2,4,8. The default is 4; own prompts have lengths of their own")
      ->delimiter(',')
      ->check(in_range(0.5, 3600))
      ->excludes(compare);
  const auto clips =
      c->add_option("--clips", o->clips, "Folder of recorded clips to judge instead of generated motions")
          ->check(CLI::ExistingDirectory);
  const auto captions = c->add_option("--captions", o->captions, "File of captions of these clips, as `train` reads it")
                            ->check(CLI::ExistingFile)
                            ->needs(clips);
  clips->needs(captions);
  c->add_option("--first-seed", o->settings.seed, "First seed; the others follow it")
      ->check(seed_number())
      ->capture_default_str();
  c->add_flag("--remember", o->remember,
              "Write into the weights which texts were tried and how often they succeeded. generate then warns about "
              "texts like those that mostly fail. Judge with another --first-seed afterwards")
      ->excludes(compare);
  c->add_option("--strips", o->strips, "Folder for a film strip of every motion (PNG)")->check(not_empty());
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
