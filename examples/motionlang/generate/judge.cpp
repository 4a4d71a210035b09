// motionlang judge: does the model do what prompts say? Each prompt is generated with several seeds and measured.
//
// What counts as done is stated in numbers per prompt (speed of the root, heights of hands and pelvis, turning;
// prompts.cpp), so that a table of percentages can be compared between models, and with --compare between numbers of
// steps.
#include <cstdio>
#include <ctime>

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "../commands.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "generation.hpp"
#include "prompts.hpp"

namespace program {

namespace {

using ml::Index;
using Positions = std::vector<ml::Vec3<double>>;  // (frames, joints), world

struct JudgeOptions {
  std::string model = default_model().string(), backend = "eigen";
  GenerationSettings settings;
  int seeds = 10;
  bool details = false;
  std::vector<Index> compare;  // numbers of steps
  MachineOptions machine;
};

/// Everything that is measured of all prompts with all seeds. Means over the motions.
struct Judgement {
  std::vector<std::vector<Measures>> results{std::vector<std::vector<Measures>>(prompts().size())};
  std::vector<Positions> positions;  // seed by seed, prompt by prompt
  double skate = 0, shake = 0;       // m/s, m/s^3
  double bones = 0;    // largest change of the length of a bone between predicted positions, as a share of it
  double seconds = 0;  // of the processor per second of motion

  std::size_t done(std::size_t prompt) const {
    return static_cast<std::size_t>(
        std::count_if(results[prompt].begin(), results[prompt].end(), prompts()[prompt].done));
  }
  std::size_t done() const {
    std::size_t n = 0;
    for (std::size_t i = 0; i < prompts().size(); ++i) n += done(i);
    return n;
  }
  std::size_t motions() const { return positions.size(); }
};

/// Positions of joints that the features say, as they are, instead of the rotations: bones may change their lengths.
double bone_change(const std::vector<double>& features) {
  Positions positions;
  for (std::size_t at = 0; at < features.size(); at += ml::smplrifke_size) {
    positions.push_back({});
    for (std::size_t j = at + 136; j < at + 205; j += 3)
      positions.push_back({features[j], features[j + 1], features[j + 2]});
  }
  return ml::bone_length_deviation({positions, ml::smplrifke_joints}, ml::smpl24_skeleton().parents);
}

template <class Progress>
Judgement judge(const Generator& generator, GenerationSettings settings, int seeds, Progress&& progress) {
  Judgement out;
  std::vector<ml::Timeline> timelines;
  double length = 0;
  for (const Prompt& p : prompts()) {
    timelines.push_back({{{p.text, 0, ml::frame_at(p.seconds, generator.fps()), ml::BodyParts::all()}}});
    length += p.seconds;
  }
  GenerationNotes notes;
  settings.notes = &notes;
  for (int seed = 0; seed < seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    auto steps = [&](Index done, Index total) { return progress(seed * total + done, seeds * total); };
    const std::clock_t start = std::clock();
    const auto motions = generator.run(timelines, settings, steps);
    out.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / (length * seeds);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      out.results[i].push_back(measure(motions[i]));
      out.positions.push_back(motions[i].positions());
      const auto quality = ml::motion_quality(motions[i]);
      out.skate += quality.feet.speed;
      out.shake += quality.jitter;
      if (notes.layout == "smplrifke") out.bones += bone_change(notes.features[i]);
    }
  }
  for (double* sum : {&out.skate, &out.shake, &out.bones})
    *sum /= static_cast<double>(std::max<std::size_t>(1, out.motions()));
  return out;
}

/// Mean distance of joints, metres; `shift` motions further on in the second.
double distance(const Judgement& a, const Judgement& b, std::size_t shift = 0) {
  double sum = 0;
  std::size_t joints = 0;
  for (std::size_t i = 0; i + shift < a.motions(); ++i) {
    const Positions &p = a.positions[i], &q = b.positions[i + shift];
    for (std::size_t j = 0; j < p.size(); ++j) sum += ml::norm(p[j] - q[j]);
    joints += p.size();
  }
  return joints == 0 ? 0 : sum / static_cast<double>(joints);
}

/// A table in Markdown: what fewer steps cost. The first number of steps is what the others are compared with.
void compare(const Generator& generator, const JudgeOptions& o) {
  require_steps({.steps = std::ranges::max(o.compare)}, generator);
  std::printf(
      "| sampler | steps | prompts done | foot skate m/s | jitter m/s^3 | bone lengths +- %% | joints, mm away | "
      "processor s per s of motion |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  std::string scale;
  for (const char* sampler : {"ddpm", "ddim"}) {
    Judgement first;
    for (const Index steps : o.compare) {
      GenerationSettings settings = o.settings;
      settings.sampler = sampler;
      settings.steps = steps;
      ProgressBar bar(std::string(sampler) + " " + std::to_string(steps));
      Judgement j = judge(generator, settings, o.seeds, bar);
      bar.finish();
      if (first.motions() == 0) {
        first = j;
        if (o.seeds > 1) {
          char text[100];
          std::snprintf(text, sizeof text, " %s %.0f", sampler, 1000 * distance(first, first, prompts().size()));
          scale += text;
        }
      }
      std::printf("| %s | %td | %.0f %% | %.3f | %.1f | %.1f | %.0f | %.2f |\n", sampler, steps,
                  100.0 * static_cast<double>(j.done()) / static_cast<double>(j.motions()), j.skate, j.shake,
                  100 * j.bones, 1000 * distance(first, j), j.seconds);
      std::fflush(stdout);
    }
  }
  std::printf("%s of %zu prompts. Joints: mean distance to the result of the same seed with %s",
              ml::counted(o.seeds, "seed").c_str(), prompts().size(), ml::counted(o.compare.front(), "step").c_str());
  std::printf(scale.empty() ? "\n" : "; between two seeds:%s mm\n", scale.c_str());
}

void run(const JudgeOptions& o) {
  o.machine.apply();
  const auto generator = load_generator(o.backend, model_file(o.model));
  if (!o.compare.empty()) return compare(*generator, o);
  const Judgement j = [&] {
    ProgressBar bar("judging");
    return judge(*generator, o.settings, o.seeds, bar);
  }();
  std::printf("%-28s %-8s %s\n", "prompt", "done", "what counts");
  for (std::size_t i = 0; i < prompts().size(); ++i) {
    std::printf("%-28s %zu/%-6zu %s\n", prompts()[i].text.c_str(), j.done(i), j.results[i].size(),
                prompts()[i].rule.c_str());
    if (o.details) {
      for (const Measures& m : j.results[i]) {
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
  std::printf("foot skate %.3f m/s, jitter %.1f m/s^3 (means over all motions)\n", j.skate, j.shake);
  const auto about = ml::SafetensorsFile::open(model_file(o.model)).metadata();
  if (about.contains("real.skate") && about.contains("real.jitter")) {
    const double real_skate = std::stod(about.at("real.skate")), real_jitter = std::stod(about.at("real.jitter"));
    std::printf("recordings: %.3f m/s, %.1f m/s^3; ratio %.2f and %.2f\n", real_skate, real_jitter,
                j.skate / real_skate, j.shake / real_jitter);
  }
}

}  // namespace

void add_judge(CLI::App& app) {
  const auto o = std::make_shared<JudgeOptions>();
  CLI::App* c = app.add_subcommand(
      "judge",
      "Generates twelve prompts with several seeds, measures the motions, prints how many do what they should");
  c->add_option("--model", o->model, "Weights")->capture_default_str();
  const auto compare =
      c->add_option(
           "--compare", o->compare,
           "Numbers of steps: a table of what they cost, with both samplers, against the first of them (100 20 10 8 5)")
          ->check(positive());
  c->add_option("--seeds", o->seeds, "Motions per prompt")->check(positive())->capture_default_str();
  c->add_option("--guidance", o->settings.guidance, "Weight of the text, 1 is none; the model's own unless given")
      ->check(in_range(0, 100));
  c->add_option("--steps", o->settings.steps, "Denoising steps, 0: all; as the weights ask unless given")
      ->check(not_negative())
      ->excludes(compare);
  c->add_option("--sampler", o->settings.sampler, "ddpm or ddim; as the weights ask unless given")
      ->check(CLI::IsMember({"ddpm", "ddim"}))
      ->excludes(compare);
  c->add_flag("--smooth,!--no-smooth", o->settings.smooth, "Takes trembling away; on unless switched off");
  c->add_flag("--fix-feet,!--no-fix-feet", o->settings.fix_feet, "Feet that stand do not slide; on unless switched off")
      ->capture_default_str();
  c->add_option("--backend", o->backend, "eigen, xtensor or reference")
      ->check(CLI::IsMember({"eigen", "xtensor", "reference"}))
      ->capture_default_str();
  c->add_flag("--details", o->details, "Print the measurements of every motion");
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
