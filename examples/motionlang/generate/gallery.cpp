// motionlang gallery: a page and a picture of all verbs that a model knows.
#include <cstdio>

#include <motionlang/file/input_files.hpp>
#include <motionlang/file/output_folder.hpp>
#include <motionlang/generate/gallery_prompts.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "generation.hpp"
#include "timelines.hpp"

namespace program {

namespace {

struct GalleryCommand {
  std::string prompts, captions, model = default_model().string(), out = "gallery", backend = "eigen";
  std::size_t least = 1;
  bool list = false, all = false;
  int columns = 8, poses = 2;
  std::size_t pictured = 64;
  ml::ModelSources sources;
  ml::GenerateOptions settings;
  MachineOptions machine;
};

std::vector<ml::GalleryPrompt> prompts_of(const GalleryCommand& o, const ml::MotionModel& generator) {
  if (!o.captions.empty()) {
    const auto captions = ml::read_captions(o.captions, std::filesystem::path(o.captions).parent_path());
    return ml::gallery_prompts(captions, o.least);
  }
  std::string file = o.prompts.empty() ? ml::gallery_list_beside(o.model).string() : o.prompts;
  if (file.empty() && !generator.captions().empty()) return ml::gallery_prompts(generator.captions(), o.least);
  if (file.empty()) file = default_gallery_prompts().string();
  return ml::parse_gallery_prompts(read_timeline_text(file), timeline_source(file));
}

void run(const GalleryCommand& o) {
  o.machine.apply();
  const auto generator = load_generator(o.backend, o.model, o.sources);
  auto prompts = prompts_of(o, *generator);
  if (o.list) return print(ml::write_gallery_prompts(prompts));
  const ml::OutputFolder out("--out", o.out);
  const std::filesystem::path page = std::filesystem::path(o.out) / ml::gallery_page_name,
                              sheet = std::filesystem::path(o.out) / ml::gallery_picture_name;
  for (const auto& file : {page, sheet}) ml::InputFiles{o.prompts, o.captions}.refuse(file);
  ml::check_options(*generator, o.settings);
  const auto unknown = o.all ? std::vector<ml::GalleryPrompt>() : ml::take_unknown_prompts(prompts, *generator);
  if (prompts.empty()) ml::raise<ml::config_error>(101, "gallery: the model knows no prompt");

  ProgressBar bar("generating");
  ml::GenerateOptions settings = o.settings;
  settings.progress = bar;
  const auto motions = ml::gallery_motions(*generator, prompts, settings);
  bar.finish();
  const std::string info = formatted("model %s, seed %llu", std::filesystem::path(o.model).filename().string().c_str(),
                                     static_cast<unsigned long long>(settings.seed));
  const std::string title =
      o.prompts.empty() ? "Every verb that the model knows" : "Prompts of " + timeline_source(o.prompts);
  ml::write_gallery(o.out, motions, prompts,
                    {.title = title, .info = info, .pictured = o.pictured, .columns = o.columns, .poses = o.poses});
  std::printf("%s, %s left out because the model does not know them\n  page     %s\n  picture  %s\n",
              counted(motions.size(), "motion").c_str(), counted(unknown.size(), "prompt").c_str(),
              page.string().c_str(), sheet.string().c_str());
}

}  // namespace

void add_gallery(CLI::App& app) {
  const auto o = std::make_shared<GalleryCommand>();
  CLI::App* c = app.add_subcommand("gallery",
                                   "Makes a motion for each verb that a model knows. Writes gallery.html, a page of "
                                   "small moving figures, and gallery.svg, a picture of them");
  const auto prompts = file_option(
      *c, "--prompts", o->prompts,
      "File with a line for each prompt: 'text # seconds'. For models of actions, the text names one. "
      "The default is gallery.txt beside the weights, then the captions that the model remembers, then the list "
      "of the bundled model, which has a prompt for each verb of its captions");
  file_option(*c, "--captions", o->captions,
              "File of captions, as `train` reads it: a prompt for each verb with which its captions begin")
      ->excludes(prompts);
  checked_option(*c, "--least", o->least, in_range(1, 1000000),
                 "Without a list: leave out verbs that fewer segments show, or captions say");
  c->add_flag("--list", o->list, "Print the prompts, as --prompts reads them, and stop");
  c->add_flag("--all", o->all, "Keep prompts that the model does not know by their words or by their meaning");
  c->add_option("--model", o->model,
                "Weights, as `generate` takes them. The default is the bundled model, or what MOTIONLANG_MODEL names");
  path_option(*c, "--text-encoder", o->sources.text_encoder,
              "Text encoder of a published model that contains none, as `generate` takes it");
  checked_option(*c, "--out", o->out, not_empty(), "Folder for the page and the picture");
  checked_option(*c, "--pictured", o->pictured, in_range(1, 1000000),
                 "The picture shows at most this many motions, the first ones");
  checked_option(*c, "--columns", o->columns, in_range(1, 20), "Columns of the picture");
  checked_option(*c, "--poses", o->poses, in_range(1, 6), "Poses of each motion in the picture");
  checked_option(*c, "--seed", o->settings.seed, seed_number(),
                 "Seed of the noise. `generate --text` makes the same motions with the same seed");
  checked_option(*c, "--backend", o->backend, CLI::IsMember({"eigen", "xtensor", "reference"}),
                 "Backend for the computation");
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
