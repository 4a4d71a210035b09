// motionlang generate: a timeline in, motions out in every format, and a page to look at.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/text_timeline.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/generate/joined_timeline.hpp>
#include <motionlang/generate/kept_clip_text.hpp>
#include <motionlang/generate/reuse_notes.hpp>
#include <motionlang/generate/samples.hpp>
#include <motionlang/generate/timeline_tracks.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/viewer.hpp>
#include <motionlang/weights/model_system.hpp>

#include "../commands.hpp"
#include "../conjunctions.hpp"
#include "../files/motion_files.hpp"
#include "../formatted.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "../train/processes.hpp"
#include "generation.hpp"
#include "timelines.hpp"

namespace program {

namespace {

struct GenerateCommand {
  std::string timeline, text, towards, model = default_model().string(), out = "out", backend = "eigen";
  bool action = false;                         // true if the text names one
  bool in_turn = false;                        // the actions of a text follow each other
  MissingParts missing;                        // of texts of a timeline
  std::optional<ml::Conjunction> conjunction;  // of the texts of SINC; default: its own
  std::filesystem::path tags;                  // of their sentences
  std::optional<double> seconds;               // of the text; default: what its action takes
  std::optional<ml::Index> samples;            // of each timeline; default 1, with `towards` 5
  ml::ModelSources sources;
  ml::GenerateOptions settings;
  std::string sampler, noise;  // "": the model's own, the seed's
  std::string mode = "stmc", noise_factor;
  std::string preset = "model";
  std::string reuse;  // a folder or a file
  bool record = false;
  std::string keep;  // a motion to keep in part
  std::vector<std::string> keep_seconds, keep_parts;
  ml::RigOptions rig;
  MachineOptions machine;
};

/// One text or action for all the time.
ml::Timeline timeline_of(const std::string& text, const GenerateCommand& o, double fps) {
  return ml::whole_body_timeline(text, ml::frame_at(o.seconds.value_or(ml::text_seconds), fps));
}
/// The timelines of the user, or one text. They are checked at once; `of` makes them when the model is known.
class WantedTimelines {
 public:
  explicit WantedTimelines(const GenerateCommand& o) : o_(o), source_(timeline_source(o.timeline)) {
    if (!o.text.empty()) return;
    // mpirun gives standard input to the first process alone.
    text_ = processes().rank() == 0 ? read_timeline_text(o.timeline) : "";
    text_ = ml::text_of_first(processes(), std::move(text_));
    count_ = ml::timelines_of_text(text_, {.fps = 1, .as_published = true, .name = source_}).size();
  }
  std::size_t count() const { return count_; }
  std::vector<ml::Timeline> of(const ml::MotionModel& model, const ml::GenerateOptions& settings) const {
    if (o_.text.empty()) {
      auto timelines = ml::timelines_of_text(text_, {.fps = model.fps(), .name = source_});
      o_.missing.fill(timelines, text_);
      if (o_.in_turn) make_in_turn(timelines, model.fps());
      if (o_.conjunction) {
        const ml::LabelSentences sentences(*o_.conjunction, o_.tags);
        for (ml::Timeline& t : timelines) t = ml::joined_timeline(t, sentences);
      }
      return timelines;
    }
    if (!model.takes_timelines()) return {timeline_of(o_.text, o_, model.fps())};
    ml::Timeline timeline = ml::text_timeline(
        o_.text, model.captions(),
        {.seconds = o_.seconds, .fps = model.fps(), .end_actions = ml::ends_actions(settings), .in_turn = o_.in_turn});
    warn(ml::divided_text_notes(o_.text, timeline, model.fps()));
    return {std::move(timeline)};
  }

 private:
  const GenerateCommand& o_;
  std::string source_, text_;
  std::size_t count_ = 1;
};
std::string wanted_name(const GenerateCommand& o) {
  if (o.timeline == standard_input) return "timeline";
  if (o.text.empty()) return std::filesystem::path(o.timeline).stem().string();
  return o.towards.empty() ? ml::result_name(o.text) : ml::result_name(o.text) + "_to_" + ml::result_name(o.towards);
}

/// The files of a motion: these extensions after its name, that of the page after the common name.
constexpr std::array motion_extensions{".bvh", ".glb", ".npz", ".npy", ".svg"};
constexpr const char* page_extension = ".html";

/// Throws usage_error 102 if one of the files is also an input: before long work, not after it.
void require_other_files(const GenerateCommand& o, const std::string& name, const std::vector<std::string>& motions) {
  const ml::InputFiles inputs{o.keep, o.timeline, o.rig.file, o.noise};
  for (const std::string& motion : motions) {
    for (const char* extension : motion_extensions) inputs.refuse(std::filesystem::path(o.out) / (motion + extension));
  }
  inputs.refuse(std::filesystem::path(o.out) / (name + page_extension));
}

/// `samples` motions of each timeline, in the order of timelines. The first equals that of a run with one sample.
std::vector<ml::ViewerMotion> samples_of(const std::vector<ml::Timeline>& timelines, ml::Index samples,
                                         const std::vector<std::string>& names, const ml::MotionModel& generator,
                                         ml::GenerateOptions settings) {
  ProgressBar bar("generating");
  settings.progress = bar;
  auto motions = ml::generate_samples(generator, timelines, samples, settings);
  std::vector<ml::ViewerMotion> out;
  for (std::size_t t = 0; t < timelines.size(); ++t) {
    for (ml::Motion& m : motions[t]) {
      m.name = names[out.size()];
      out.push_back({std::move(m), ml::timeline_tracks(timelines[t], generator.fps())});
    }
  }
  return out;
}

/// Motions from one text or action to the other.
std::vector<ml::ViewerMotion> line_of(const GenerateCommand& o, const std::vector<std::string>& names,
                                      const ml::MotionModel& generator, const ml::GenerateOptions& settings) {
  const double fps = generator.fps();
  std::vector<ml::ViewerMotion> out;
  for (auto& [m, shown] :
       ml::generate_between(require_latent(generator, "--towards", o.model), timeline_of(o.text, o, fps),
                            timeline_of(o.towards, o, fps), std::ssize(names), settings)) {
    m.name = names[out.size()];
    out.push_back({std::move(m), ml::timeline_tracks(shown, fps)});
  }
  return out;
}

/// Writes every format, and returns the lines with the names of the files.
std::string written(const ml::ViewerMotion& made, const std::string& folder, const ml::RigWriter& write_on_rig) {
  const ml::Motion& motion = made.motion;
  std::string lines;
  const std::string base = (std::filesystem::path(folder) / motion.name).string();
  ml::write_bvh(base + ".bvh", motion);
  if (write_on_rig)
    lines = write_on_rig(base + ".glb", std::span(&motion, 1));
  else
    ml::write_glb(base + ".glb", motion);
  ml::write_amass(base + ".npz", on_smpl(motion));
  ml::write_joints_npy(base + ".npy", motion);
  ml::write_film_strip(base + ".svg", motion, made.tracks);
  return lines +
         formatted("%s: %.2f s, %s\n  motion      %s.bvh  .glb  .npz (AMASS)  .npy (joints)\n  film strip  %s.svg\n",
                   motion.name.c_str(), motion.seconds(), counted(motion.frames(), "frame").c_str(), base.c_str(),
                   base.c_str());
}

/// Writes the motions, which the processes share, and prints what was written in their order.
void write(const std::vector<ml::ViewerMotion>& made, const std::string& folder, const ml::RigWriter& write_on_rig) {
  const bool alone = processes().size() == 1;
  const auto write_one = [&](ml::Index i, const ml::Progress&) {
    const std::string lines = written(made[static_cast<std::size_t>(i)], folder, write_on_rig);
    if (alone) print(lines);
    return lines;
  };
  for (const std::string& lines : ml::shared_items(processes(), std::ssize(made), write_one)) {
    if (!alone) print(lines);
  }
}

/// Prints a line for each text with words that the model never learned, each text that is too long, and each that the
/// model may not follow.
void warn_of_texts(const GenerateCommand& o, const std::vector<ml::Timeline>& timelines,
                   const ml::MotionModel& generator) {
  std::set<std::string> texts{o.text, o.towards};
  for (const ml::Timeline& t : timelines) {
    for (const ml::Interval& i : t.intervals) texts.insert(i.text);
  }
  for (const std::string& text : texts) warn(ml::text_warnings(generator, text));
  const std::string source = timeline_source(o.timeline);
  warn(ml::timeline_warnings(generator, timelines, o.settings, o.in_turn, {.source = source, .in_turn = "--in-turn"}));
}

/// None without --keep. Throws usage_error 101, 103 for a wrong stretch of time or body part.
std::optional<ml::KeptClip> kept_clip(const GenerateCommand& o) {
  if (o.keep.empty()) return std::nullopt;
  ml::KeptClip out{.motion = read_only_performed_motion(o.keep)};
  for (const std::string& range : o.keep_seconds) out.seconds.push_back(ml::parse_kept_range(range));
  if (!o.keep_parts.empty()) out.parts = ml::parse_kept_parts(ml::join_text(o.keep_parts, ","));
  return out;
}

/// The options of the run from the command line. The run fills `notes`.
ml::GenerateOptions settings_of(const GenerateCommand& o, const std::string& name, ml::GenerateNotes& notes) {
  ml::GenerateOptions settings = o.settings;
  settings.notes = &notes;
  settings.communicator = processes();
  settings.keep = kept_clip(o);
  settings.noise = o.noise;
  settings.mode = ml::parse_stmc_mode(o.mode);
  if (!o.sampler.empty()) settings.sampler = ml::parse_sampler(o.sampler);
  if (!o.noise_factor.empty()) settings.noise_scale = ml::parse_noise_scale(o.noise_factor);
  if (o.preset == "fast") ml::use_fast_preset(settings);
  if (o.preset == "full") ml::use_full_preset(settings);
  if (!o.reuse.empty()) settings.reuse = ml::find_record(o.reuse);
  if (o.record || !o.reuse.empty()) settings.record = std::filesystem::path(o.out) / (name + ml::record_extension);
  return settings;
}

/// Throws usage_error 102 for options that the model does not take.
void require_fitting(const GenerateCommand& o, const ml::MotionModel& generator) {
  if (o.action && !generator.takes_actions())
    ml::raise<usage_error>(102, "--action is for models of actions (ACTOR, MDM); this one takes --text");
  if (o.conjunction && ml::model_system(ml::FilePath(o.model)).name != "sinc")
    ml::raise<usage_error>(102, o.model, ": --conjunction joins the texts of SINC");
  if (o.in_turn && generator.steps() == 0)
    ml::raise<usage_error>(102, o.model, ": --in-turn is for models of timelines (STMC); this is ", generator.system());
}

/// Prints how much was reused, and warns if kept frames moved over the floor.
void say(const ml::GenerateNotes& notes, const ml::GenerateOptions& settings) {
  if (notes.reuse) print(with_options(ml::reuse_notes(*notes.reuse, settings.keep_beyond)));
  constexpr double noticeable = 0.1;  // metres
  if (notes.kept_moved > noticeable && processes().rank() == 0)
    std::fprintf(stderr,
                 "--keep: kept frames are up to %.2f m over the floor from where they were. Made frames before them, "
                 "smoothing and feet that are fixed lead them there\n",
                 std::ceil(100 * notes.kept_moved) / 100);
}

void run(const GenerateCommand& o) {
  o.machine.apply();
  if (!o.towards.empty()) require_one_process("generate --towards");
  const ml::OutputFolder out("--out", o.out);
  const std::string name = wanted_name(o);
  const WantedTimelines wanted(o);
  const ml::Index samples = o.samples.value_or(o.towards.empty() ? 1 : 5);
  const auto names = ml::sample_names(name, wanted.count(), samples);
  require_other_files(o, name, names);
  ml::GenerateNotes notes;
  const ml::GenerateOptions settings = settings_of(o, name, notes);
  const ml::RigWriter write_on_rig = ml::rig_writer(o.rig);
  const auto generator = load_generator(o.backend, o.model, o.sources);
  require_fitting(o, *generator);

  const auto timelines = o.towards.empty() ? wanted.of(*generator, settings) : std::vector<ml::Timeline>();
  warn_of_texts(o, timelines, *generator);
  if (!o.towards.empty()) require_latent(*generator, "--towards", o.model);
  ml::check_options(*generator, settings);
  const auto made = o.towards.empty() ? samples_of(timelines, samples, names, *generator, settings)
                                      : line_of(o, names, *generator, settings);
  say(notes, settings);
  write(made, o.out, write_on_rig);
  if (processes().rank() > 0) return;
  const auto model =
      std::filesystem::is_directory(o.model) ? std::filesystem::path(o.model) : std::filesystem::path(o.model).stem();
  const std::string drawn = o.noise.empty() ? "seed " + std::to_string(notes.seed.value_or(settings.seed))
                                            : "noise " + std::filesystem::path(o.noise).filename().string();
  const auto page = std::filesystem::path(o.out) / (name + page_extension);
  ml::write_viewer(page, made, {.title = name, .info = drawn + ", model " + model.filename().string()});
  std::printf("Open %s in a browser to watch it.\n", std::filesystem::absolute(page).string().c_str());
}

}  // namespace

void add_generate(CLI::App& app) {
  const auto o = std::make_shared<GenerateCommand>();
  CLI::App* c = app.add_subcommand(
      "generate",
      "Makes a motion from a timeline of texts and writes BVH, GLB, NPZ, NPY, a film strip and an HTML page");
  const auto what = c->add_option_group("what", "What to generate (exactly one of these)");
  const auto timeline = what->add_option("--timeline", o->timeline,
                                         "File with a line for each text: 'text # start # end # body part # ...', in "
                                         "seconds. A blank line begins another timeline. With lines 'text # duration', "
                                         "each line becomes a motion of its own. - reads standard input")
                            ->check(not_empty());
  what->add_option("--text", o->text, "One text for the whole body")->check(not_empty())->check(utf8());
  const CLI::Option* action =
      what->add_option(
              "--action", o->text,
              "Name or number of an action, for models of actions (ACTOR, MDM). 'any' is for an unconstrained MDM")
          ->check(not_empty());
  what->require_option(1);
  c->add_option("--seconds", o->seconds,
                "Duration of the text or action. The default for a text is the time that its action usually takes, as "
                "far as the model knows that, and 5 otherwise. In a longer time an action that ends is made once, and "
                "what follows it is added; --no-cut-texts prevents that. TM2T chooses its own duration")
      ->excludes(timeline)
      ->check(in_range(0.05, 3600));
  c->add_option("--samples", o->samples,
                "Number of motions to make for each timeline, text or action, named NAME_1 to NAME_N. The default is "
                "1, or 5 with --towards")
      ->check(in_range(1, 1000));
  c->add_option("--towards", o->towards,
                "Another text or action. The samples lie on the straight line between the two latents: the first "
                "sample is the motion of the first text, the last that of this one. For ACTOR, TEMOS, TMR and SINC")
      ->excludes(timeline)
      ->check(not_empty())
      ->check(utf8());
  c->add_option("--model", o->model,
                "Weights: a .safetensors file, a folder with one, or a folder that a train command wrote. A published "
                "folder of STMC, MDM, MotionDiffuse, ACTOR, TEMOS, TMR, TEACH, SINC or TM2T works as well. The default "
                "is the bundled model, or what MOTIONLANG_MODEL names");
  path_option(*c, "--text-encoder", o->sources.text_encoder,
              "Text encoder of a published model that contains none. CLIP: OpenAI's ViT-B-32.pt with "
              "bpe_simple_vocab_16e6.txt.gz beside it, or a folder of Hugging Face. TEMOS, TEACH, SINC: "
              "distilbert-base-uncased. TM2T: the folder of its word vectors (our_vab_data.npy). The default is to "
              "look beside the model");
  folder_option(
      *c, "--statistics", o->sources.statistics,
      "Folder with mean and std of the features (.npy or .pt), for a published model whose own folder lacks them");
  folder_option(*c, "--tokenizer", o->sources.tokenizer,
                "TM2T: folder of the motion tokenizer. The default is to look beside the model");
  checked_option(*c, "--out", o->out, not_empty(), "Folder for the results");
  const auto rig = file_option(*c, "--rig", o->rig.file,
                               "Character (.glb with a skin). The GLB result is this file with the motion added");
  c->add_flag("--drop-animations", o->rig.drop_animations, "Leave out the animations that the character already has")
      ->needs(rig);
  c->add_option("--joints", o->rig.joints, joints_help)->needs(rig)->check(CLI::ExistingFile);
  const auto seed = checked_option(*c, "--seed", o->settings.seed, seed_number(),
                                   "Seed of the noise. The same seed gives the same motion on any number of threads");
  const auto steps = c->add_option("--steps", o->settings.steps,
                                   "Number of denoising steps, spread evenly over those of the model; 0 takes all. The "
                                   "default is what the weights ask for")
                         ->check(not_negative());
  const auto sampler = sampler_option(*c, o->sampler);
  const auto preset =
      c->add_option("--preset", o->preset,
                    "Sampler and steps. model: those that the weights ask for; full: all steps of ddpm; fast: " +
                        std::to_string(ml::fast_steps) +
                        " steps of ddim. motionlang judge --compare prints what they cost")
          ->check(CLI::IsMember({"model", "full", "fast"}))
          ->excludes(steps)
          ->excludes(sampler)
          ->capture_default_str();
  const auto noise_factor =
      c->add_option("--noise-factor", o->noise_factor,
                    "Factor of the noise in a step of ddpm. paper: the standard deviation, square root of Sigma; "
                    "published: Sigma itself, as STMC's released program has it. The default is what the weights ask "
                    "for")
          ->check(CLI::IsMember({"paper", "published"}));
  const auto guidance = c->add_option("--guidance", o->settings.guidance,
                                      "Weight of the text; 1 means no guidance. The default is the model's own")
                            ->check(in_range(0, 100));
  const auto recall = c->add_option("--recall", o->settings.recall, recall_help)->check(in_range(0, 1));
  c->add_option("--fact", o->settings.fact,
                "Scale of the latent noise, for ACTOR, TEMOS, TMR, SINC and TEACH: above 1 for more variety, 0 for the "
                "mean motion. The default is 1, as in training")
      ->check(in_range(0, 100));
  const auto mode = checked_option(
      *c, "--mode", o->mode, CLI::IsMember({"stmc", "sinc", "sinc-lerp", "single-track", "one-text"}),
      "STMC, or a baseline of its paper, for diffusion models of texts. sinc: each text is sampled "
      "alone, and body parts are stitched once, with hard cuts; sinc-lerp: the same, interpolated around "
      "cuts; single-track: the texts of each moment in one sentence (DiffCollage); one-text: all in one "
      "sentence. Baselines do not cut texts");
  const auto overlap =
      checked_option(*c, "--overlap", o->settings.overlap, not_negative(),
                     "Seconds that neighbouring texts share around a cut, or that sinc-lerp interpolates");
  const auto noise =
      c->add_option("--noise", o->noise,
                    "A safetensors file with noise/000 (initial), noise/001 and so on, which replaces the seed")
          ->excludes(seed);
  c->add_flag("--record", o->record,
              std::string("Also write NAME") + ml::record_extension +
                  " for --reuse after an edit. It has 820 bytes per frame and step (20 MB for 12 s and 100 steps)")
      ->excludes(noise);
  const auto reuse = path_option(
      *c, "--reuse", o->reuse,
      "Folder or file of a run with --record. Only what the edited timeline changes is computed; seed, steps, "
      "sampler, guidance, recall, overlap and cuts are those of that run. The program prints what was reused");
  for (CLI::Option* option : {seed, steps, sampler, preset, guidance, recall, noise_factor, mode, overlap, noise})
    reuse->excludes(option);
  c->add_option("--keep-beyond", o->settings.keep_beyond,
                "Keep frames that are further than this many seconds from an edit. This is an approximation, since the "
                "model would change them")
      ->check(in_range(0, 3600))
      ->needs(reuse);
  CLI::Option* keep = file_option(
      *c, "--keep", o->keep,
      "Motion file, as for convert. It starts with the timeline; parts of it are kept, and the texts make the "
      "rest. For diffusion models of texts. A T-pose in front is left out. Smoothing and foot fixing may "
      "still move the kept part a little; --no-smooth and --no-fix-feet prevent that");
  c->add_option("--keep-seconds", o->keep_seconds,
                "Time ranges in which the whole pose is kept. 0-0.5 fixes the beginning; 0-1,4-5 leaves the frames "
                "between to the model")
      ->delimiter(',')
      ->needs(keep);
  c->add_option("--keep-parts", o->keep_parts,
                "Body parts that are kept, for the whole motion or during --keep-seconds. The legs carry the path over "
                "the floor")
      ->delimiter(',')
      ->needs(keep);
  for (CLI::Option* option : {noise, reuse}) keep->excludes(option);
  c->add_flag("--in-turn", o->in_turn, in_turn_help);
  CLI::Option* conjunction =
      c->add_option(
           "--conjunction", o->conjunction,
           "SINC: how the texts of a timeline become a sentence. The default is same_time, as in the published "
           "program; the paper says while")
          ->transform(conjunction_names())
          ->needs(timeline);
  file_option(*c, "--tags", o->tags, about_tags)->needs(conjunction);
  o->missing.add_to(*c);
  const auto cut_texts =
      c->add_flag("--cut-texts,!--no-cut-texts", o->settings.cut_texts,
                  "Cut a text where another text takes body parts from it or gives them back, and where it lasts "
                  "longer than 8 s. Without this, each text is one crop, as published")
          ->capture_default_str();
  reuse->excludes(cut_texts);
  c->add_flag("--smooth,!--no-smooth", o->settings.smooth, "Remove jitter, and jerks where texts meet")
      ->capture_default_str();
  c->add_flag("--fix-feet,!--no-fix-feet", o->settings.fix_feet,
              "Keep standing feet from sliding. With --no-cut-texts --no-smooth --no-fix-feet the motion is what other "
              "programs compute from the same --noise")
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
  o->machine.add_to(*c);
  c->callback([o, action] {
    o->action = action->count() > 0;
    if (!o->keep.empty() && o->keep_seconds.empty() && o->keep_parts.empty())
      throw CLI::ValidationError("--keep", "needs --keep-seconds or --keep-parts");
    if (!o->keep.empty() && (o->record || !o->towards.empty()))
      throw CLI::ExcludesError("--keep", o->record ? "--record" : "--towards");
    run(*o);
  });
}

}  // namespace program
