// motionlang check: shows what a timeline says, when each text moves which part, and what is wrong.
#include <cstdio>
#include <vector>

#include <motionlang/compose/describe_plan.hpp>
#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/stmc_file.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../option_checks.hpp"
#include "timelines.hpp"

namespace program {

namespace {

void run(const std::string& path, double fps, double overlap, const std::string& model, bool cut, bool in_turn,
         const MissingParts& missing) {
  ml::Index longest = 0;
  if (!model.empty()) {
    const auto config = ml::stmc_config(ml::SafetensorsFile::open(ml::stmc_model_file(model)));
    fps = config.fps;
    longest = config.denoiser.longest_crop();
  }
  const std::string text = read_timeline_text(path);
  auto written = ml::timelines_of_text(text, {.fps = fps, .name = timeline_source(path)});
  missing.fill(written, text);
  if (in_turn) make_in_turn(written, fps);
  const std::string source = timeline_source(path);
  warn(ml::whole_body_warnings(written, {.source = source}));
  warn(ml::hidden_text_warnings(written, {.source = source}));
  auto timelines = written;
  for (ml::Timeline& t : timelines) {
    if (cut) t = ml::cut_texts(t, fps);
  }
  for (std::size_t m = 0; m < timelines.size(); ++m) {
    const auto plan = ml::plan_timeline(
        timelines[m],
        {.overlap = ml::frame_at(overlap, fps), .hidden = ml::HiddenTexts::ignore, .longest_crop = longest});
    const auto texts = written[m].intervals.size(), pieces = timelines[m].intervals.size();
    std::printf("timeline %zu: %s, %.2f s, %s", m, counted(plan.frames, "frame").c_str(),
                static_cast<double>(plan.frames) / fps, counted(texts, "text").c_str());
    if (pieces != texts) std::printf(" cut into %zu", pieces);
    std::printf("\n");
    print(ml::describe_plan(plan, fps));
  }
  std::printf("%s is a valid timeline file.\n", timeline_source(path).c_str());
}

}  // namespace

void add_check(CLI::App& app) {
  struct Options {
    std::string path, model;
    double fps = 20, overlap = 0.5;
    bool cut = true, in_turn = false;
    MissingParts missing;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand(
      "check",
      "Reads a timeline and shows which text moves which body part at which time. Errors name line and column");
  c->add_option("timeline", o->path, "Timeline file; - reads standard input")->required();
  checked_option(*c, "--fps", o->fps, positive(), "Frames per second of the model");
  checked_option(*c, "--overlap", o->overlap, not_negative(), "Seconds that neighbouring texts share around a cut");
  c->add_option("--model", o->model, "Weights whose frame rate and longest text are checked as well");
  c->add_flag("--cut-texts,!--no-cut-texts", o->cut,
              "Cut texts as generate does: where others borrow their body parts, and where they are too long");
  c->add_flag("--in-turn", o->in_turn, in_turn_help);
  o->missing.add_to(*c);
  c->callback([o] { run(o->path, o->fps, o->overlap, o->model, o->cut, o->in_turn, o->missing); });
}

}  // namespace program
