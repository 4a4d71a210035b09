// motionlang generate: a timeline in, motions out in every format, and a page to look at.
#include <cstdio>

#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/io/amass.hpp>
#include <motionlang/io/bvh.hpp>
#include <motionlang/io/film_strip.hpp>
#include <motionlang/io/glb_writer.hpp>
#include <motionlang/io/viewer.hpp>

#include "generation.hpp"
#include "motion_files.hpp"
#include "progress_bar.hpp"
#include "timelines.hpp"

namespace program {

namespace {

struct Options {
  std::string timeline, model = default_model().string(), out = "out", backend = "eigen";
  GenerationSettings settings;
  RigOptions rig;
  int threads = 0;  // as many as the machine has
};

std::vector<ml::Track> tracks_of(const ml::Timeline& timeline, double fps) {
  std::vector<ml::Track> tracks;
  for (const auto& i : timeline.intervals) {
    ml::Track track{i.text, static_cast<double>(i.start) / fps, static_cast<double>(i.end) / fps, {}};
    for (int p = 0; p < ml::body_part_count; ++p) {
      if (i.parts.has(static_cast<ml::BodyPart>(p)))
        track.parts.emplace_back(ml::body_part_names[static_cast<std::size_t>(p)]);
    }
    tracks.push_back(std::move(track));
  }
  return tracks;
}

void run(const Options& o) {
  if (o.threads > 0) ml::set_thread_count(o.threads);
  const RigWriter write_on_rig = o.rig.file.empty() ? RigWriter() : rig_writer(o.rig);
  const auto generator = load_generator(o.backend, model_file(o.model));
  const auto timelines = read_timelines(o.timeline, generator->fps());
  const GenerationSettings& settings = o.settings;

  std::vector<ml::Motion> motions;
  {
    ProgressBar bar("generating");
    motions = generator->run(timelines, settings, bar);
  }
  std::filesystem::create_directories(o.out);
  const std::string name = std::filesystem::path(o.timeline).stem().string();
  const std::string info = "seed " + std::to_string(settings.seed) + ", model " + model_file(o.model).stem().string();
  std::vector<ml::ViewerMotion> pages;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    motions[m].name = motions.size() == 1 ? name : name + "_" + std::to_string(m);
    const auto base = std::filesystem::path(o.out) / motions[m].name;
    const auto tracks = tracks_of(timelines[m], generator->fps());
    ml::write_bvh(base.string() + ".bvh", motions[m]);
    if (write_on_rig)
      write_on_rig(base.string() + ".glb", std::span(&motions[m], 1));
    else
      ml::write_glb(base.string() + ".glb", motions[m]);
    ml::write_amass(base.string() + ".npz", motions[m]);
    ml::write_joints_npy(base.string() + ".npy", motions[m]);
    ml::write_film_strip(base.string() + ".svg", motions[m], tracks);
    pages.push_back({motions[m], tracks});
    std::printf(
        "%s: %.2f s, %td frames\n  motion      %s.bvh  .glb  .npz (AMASS)  .npy (joints)\n  film strip  %s.svg\n",
        motions[m].name.c_str(), motions[m].seconds(), motions[m].frames(), base.c_str(), base.c_str());
  }
  const auto page = std::filesystem::path(o.out) / (name + ".html");
  ml::write_viewer(page, pages, {.title = name, .info = info});
  std::printf("Open %s in a browser to watch it.\n", std::filesystem::absolute(page).c_str());
}

}  // namespace

void add_generate(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c =
      app.add_subcommand("generate", "Motion from a timeline of texts: BVH, GLB, NPZ, NPY, film strip, HTML page");
  c->add_option("--timeline", o->timeline,
                "File of lines 'text # start # end # body part # ...' (seconds), or 'text # duration'")
      ->required();
  c->add_option("--model", o->model, "Weights: a .safetensors file or a folder with one")->capture_default_str();
  c->add_option("--out", o->out, "Folder for the results")->capture_default_str();
  c->add_option("--rig", o->rig.file, "Character (.glb with a skin): the GLB result is this file with the motion added")
      ->check(CLI::ExistingFile);
  c->add_flag("--drop-animations", o->rig.drop_animations, "Without the animations that the character has already");
  c->add_option("--seed", o->settings.seed, "Same seed, same motion, on any number of threads")->capture_default_str();
  c->add_option("--steps", o->settings.steps, "Denoising steps, evenly kept of the model's; 0: all")
      ->capture_default_str();
  c->add_option("--sampler", o->settings.sampler, "How to sample")
      ->check(CLI::IsMember({"ddpm", "ddim"}))
      ->capture_default_str();
  c->add_option("--guidance", o->settings.guidance, "Weight of the text, 1 is none; the model's own unless given")
      ->check(CLI::Range(0.0, 100.0));
  c->add_option("--overlap", o->settings.overlap, "Seconds that neighbouring texts share around a cut")
      ->capture_default_str();
  c->add_option("--noise", o->settings.noise_file,
                "safetensors file with noise/000 (initial), noise/001, ... instead of the seed");
  c->add_flag("--cut-texts,!--no-cut-texts", o->settings.cut_texts,
              "A text is cut where another takes body parts from it or gives them back; without, one crop as published")
      ->capture_default_str();
  c->add_flag("--smooth,!--no-smooth", o->settings.smooth, "Takes trembling away, and jerks where texts meet")
      ->capture_default_str();
  c->add_flag("--fix-feet,!--no-fix-feet", o->settings.fix_feet,
              "Feet that stand do not slide; with --no-cut-texts --no-smooth --no-fix-feet the motion is the "
              "model's own, as other programs make it from --noise")
      ->capture_default_str();
  c->add_option("--backend", o->backend, "What to calculate with")
      ->check(CLI::IsMember({"eigen", "xtensor", "reference"}))
      ->capture_default_str();
  c->add_option("--threads", o->threads, "Threads; as many as the machine has unless given")
      ->check(CLI::Range(1, 1024));
  c->callback([o] { run(*o); });
}

}  // namespace program
