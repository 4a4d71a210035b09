// motionlang check: shows what a timeline says, when each text moves which part, and what is wrong.
#include <cstdio>

#include <motionlang/compose/describe_plan.hpp>
#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/stmc_file.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../option_checks.hpp"
#include "timelines.hpp"

namespace program {

namespace {

struct CheckOptions {
  std::string path, model;
  ml::PlanReportOptions plan;
  bool in_turn = false;
  MissingParts missing;
};

void run(const CheckOptions& o) {
  ml::PlanReportOptions how = o.plan;
  if (!o.model.empty()) {
    const auto config = ml::stmc_config(ml::SafetensorsFile::open(ml::stmc_model_file(o.model)));
    how.fps = config.fps;
    how.longest_crop = config.denoiser.longest_crop();
  }
  const std::string text = read_timeline_text(o.path), source = timeline_source(o.path);
  auto timelines = ml::timelines_of_text(text, {.fps = how.fps, .name = source});
  o.missing.fill(timelines, text);
  if (o.in_turn) make_in_turn(timelines, how.fps);
  warn(ml::whole_body_warnings(timelines, {.source = source}));
  warn(ml::hidden_text_warnings(timelines, {.source = source}));
  print(ml::describe_plans(timelines, how));
  std::printf("%s is a valid timeline file.\n", source.c_str());
}

}  // namespace

void add_check(CLI::App& app) {
  const auto o = std::make_shared<CheckOptions>();
  CLI::App* c = app.add_subcommand(
      "check",
      "Reads a timeline and shows which text moves which body part at which time. Errors name line and column");
  c->add_option("timeline", o->path, "Timeline file; - reads standard input")->required();
  checked_option(*c, "--fps", o->plan.fps, positive(), "Frames per second of the model");
  checked_option(*c, "--overlap", o->plan.overlap, not_negative(),
                 "Seconds that neighbouring texts share around a cut");
  c->add_option("--model", o->model, "Weights whose frame rate and longest text are checked as well");
  c->add_flag("--cut-texts,!--no-cut-texts", o->plan.cut_texts,
              "Cut texts as generate does: where others borrow their body parts, and where they are too long");
  c->add_flag("--in-turn", o->in_turn, in_turn_help);
  o->missing.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
