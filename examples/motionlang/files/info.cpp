// motionlang info: shows the contents of weights, motions, timelines and captions, and the meaning of features.
#include <cstdio>
#include <filesystem>

#include <motionlang/compose/describe_plan.hpp>
#include <motionlang/datasets/caption_card.hpp>
#include <motionlang/features/describe_features.hpp>
#include <motionlang/view/describe_motion.hpp>
#include <motionlang/weights/describe_weights.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../generate/timelines.hpp"
#include "../option_checks.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

void timelines(const std::string& path) {
  constexpr double fps = 20;
  for (const ml::Timeline& t : read_timelines(path, fps)) print(ml::describe_timeline(t, fps));
}

void captions(const std::string& path) {
  const auto card = ml::caption_card(ml::read_captions(path, std::filesystem::path(path).parent_path()));
  std::printf("%s: captions\n%s", ml::printable(path).c_str(), ml::describe_card(card).c_str());
}

void features(const std::string& name) {
  if (name != "list") return print(ml::describe_features(ml::motion_features(name)));
  for (const ml::MotionFeatures& each : ml::all_motion_features) print(ml::line_about_features(each));
}

void run(const std::string& path) {
  if (path == standard_input) return timelines(path);
  if (ml::holds_motions(path)) return print(ml::describe_motion_file(path));
  const std::string kind = kind_of(path);
  for (const char* drawn : {".html", ".svg", ".png", ".obj", ".asf"}) {
    if (kind == drawn)
      ml::raise<ml::config_error>(103, path, ": info shows weights, motions, timelines and captions, not '", kind, "'");
  }
  if (kind == ".tsv") return captions(path);
  ml::holds_weights(path) ? print(ml::describe_weights(path)) : timelines(path);
}

/// CLI::ExistingPath, or standard input.
std::string readable(const std::string& path) { return path == standard_input ? "" : CLI::ExistingPath(path); }

}  // namespace

void add_info(CLI::App& app) {
  const auto path = std::make_shared<std::string>(), name = std::make_shared<std::string>();
  CLI::App* c = app.add_subcommand(
      "info",
      "Shows what a file holds: weights (safetensors, PyTorch, NumPy, pickles, run folders), a motion (.bvh, .amc, "
      ".glb, .npz, .npy), a timeline or captions (.tsv). With --features, explains the values of features");
  c->add_option("file", *path, "File to show; - reads a timeline from standard input")
      ->check(readable, "PATH(existing)");
  const CLI::Option* of_features = c->add_option("--features", *name,
                                                 "Explain features, named as in convert --features: meaning, unit and "
                                                 "body part of each value. 'list' prints all names")
                                       ->check(features_name("list"));
  c->require_option(1);
  c->callback([path, name, of_features] { of_features->count() > 0 ? features(*name) : run(*path); });
}

}  // namespace program
