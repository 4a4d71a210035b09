// motionlang info: shows the contents of weights, motions, timelines and captions, and the meaning of features.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <motionlang/datasets/caption_card.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/mdm_results.hpp>
#include <motionlang/geometry/box.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../generate/timelines.hpp"
#include "../option_checks.hpp"
#include "motion_files.hpp"
#include "weights.hpp"

namespace program {

namespace {

/// The number, name and parent of each joint.
void joints_of(const ml::Skeleton& s) {
  for (int j = 0; j < s.size(); ++j)
    std::printf("  %3d %-24s %s\n", j, ml::printable(s.name(j)).c_str(),
                j == 0 ? "" : ml::printable(s.name(s.parent(j))).c_str());
}

/// The smallest box around the positions, as text. Needs at least one position.
std::string extent_of(std::span<const ml::Vec3<double>> positions) {
  const auto [low, high] = ml::box_of(positions);
  return formatted("x %.2f ... %.2f, y %.2f ... %.2f, z %.2f ... %.2f m", low.x, high.x, low.y, high.y, low.z, high.z);
}

void motion(const std::string& path, const ml::Motion& m) {
  std::printf("%s: %s, %g frames per second, %.2f s, %s\n", ml::printable(path).c_str(),
              counted(m.frames(), "frame").c_str(), m.fps, m.seconds(), counted(m.skeleton.size(), "joint").c_str());
  if (m.frames() == 0) return;
  std::printf("  root moves within %s\n", extent_of(m.root).c_str());
  if (std::ranges::is_permutation(m.skeleton.names, ml::smpl24_skeleton().names)) {  // BVH has them depth first
    const auto q = ml::motion_quality(on_smpl(m));
    std::printf(
        "  feet on the floor %.0f %% of the time, sliding at %.2f m/s; jitter %.0f m/s^3; "
        "%.1f cm below the floor\n",
        100 * q.feet.contact, q.feet.speed, q.jitter, 100 * q.below_floor.mean);
  }
  joints_of(m.skeleton);
}

void joints(const std::string& path) {
  const auto j = ml::read_joints_npy(path);
  std::printf("%s: joint positions, %s of %s\n", path.c_str(), counted(j.frames, "frame").c_str(),
              counted(j.joints, "joint").c_str());
  if (!j.positions.empty())
    std::printf("  read as Z up and turned to Y up, joints are within %s\n", extent_of(j.positions).c_str());
}

void timelines(const std::string& path) {
  for (const auto& t : read_timelines(path, 20)) {
    std::printf("timeline: %s, %.2f s\n", counted(std::ssize(t.intervals), "text").c_str(),
                static_cast<double>(t.end()) / 20);
    for (const auto& i : t.intervals)
      std::printf("  %6.2f - %6.2f s  %s\n", static_cast<double>(i.start) / 20, static_cast<double>(i.end) / 20,
                  ml::printable(i.text).c_str());
  }
}

/// The card of a table of captions.
void captions(const std::string& path) {
  const ml::CaptionCard card = ml::caption_card(ml::read_captions(path, std::filesystem::path(path).parent_path()));
  const auto row = [](const std::string& name, const ml::CaptionCard::Folder& f) {
    std::printf("  %-52s %5zu clips %6zu segments %7.1f min %7.1f min without overlaps %7zu captions\n",
                ml::printable(name).c_str(), f.clips.size(), f.segments, f.seconds / 60, f.without_overlap / 60,
                f.captions);
  };
  std::printf("%s: captions\n", ml::printable(path).c_str());
  for (const auto& [name, folder] : card.folders) row(name, folder);
  row("all", card.all);
  std::printf("%zu different captions, %zu different words, %zu verbs with the segments that show them:\n",
              card.captions.size(), card.words.size(), card.verbs.size());
  std::vector<std::pair<std::size_t, std::string>> verbs;
  for (const auto& [verb, segments] : card.verbs) verbs.emplace_back(segments, verb);
  std::ranges::sort(verbs, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string line;
  for (const auto& [segments, verb] : verbs) {
    const std::string next = " " + ml::printable(verb) + " " + std::to_string(segments);
    if (line.size() + next.size() > 118) std::printf(" %s\n", std::exchange(line, "").c_str());
    line += next;
  }
  std::printf(" %s\n", line.c_str());
}

void features_line(const ml::MotionFeatures& f) {
  const std::string name(f.name);
  std::printf("%s: %td numbers in a frame, %g frames per second, skeleton of %d joints\n", name.c_str(), f.width, f.fps,
              f.skeleton().size());
}

/// "4-66", or "0" for a single value.
std::string from_to(const ml::IndexRange& r) {
  return r.size() == 1 ? formatted("%td", r.begin) : formatted("%td-%td", r.begin, r.end - 1);
}

void features(const std::string& name) {
  if (name == "list") {
    for (const ml::MotionFeatures& each : ml::all_motion_features) features_line(each);
    return;
  }
  const ml::MotionFeatures& f = ml::motion_features(name);
  features_line(f);
  std::printf("values, from 0 on; their units; their meaning\n");
  for (const ml::FeatureRange& r : f.ranges) {
    const std::string meaning(r.meaning), unit(r.unit), numbers = from_to(r.numbers);
    const ml::Index joints = r.joints.size();
    const std::string of = joints == 0 ? "" : (joints == 1 ? "joint " : "each of joints ") + from_to(r.joints) + ": ";
    std::printf("  %-8s %-12s %s%s\n", numbers.c_str(), unit.c_str(), of.c_str(), meaning.c_str());
  }
  std::printf("values of the body parts\n");
  const ml::FeatureLayout layout = f.layout();
  for (const std::string_view part : ml::body_part_names) {
    const std::string numbers = ml::join_text(layout.ranges(*ml::parse_body_part(part)), ", ", from_to);
    std::printf("  %-10s %s\n", std::string(part).c_str(), numbers.c_str());
  }
  std::printf("joints and their parents\n");
  joints_of(f.skeleton());
}

void run(const std::string& path) {
  if (path == standard_input) return timelines(path);
  const std::string kind = kind_of(path);
  if (kind == ".npy" && holds_joints(path)) return joints(path);
  const bool arrays = (kind == ".npz" && holds_motion(path)) || (kind == ".npy" && ml::may_be_mdm_motions(path));
  if (kind == ".bvh" || kind == ".amc" || is_gltf(path) || arrays) {
    std::string told;
    const auto motions = read_motions(path, {}, &told);
    std::printf("%s", ml::printable(told, "\n").c_str());
    if (motions.size() > 1) {
      std::printf("%zu %s\n", motions.size(), is_gltf(path) ? "animations" : kind == ".bvh" ? "roots" : "motions");
      for (std::size_t i = 0; i < motions.size(); ++i)
        std::printf("  %zu %s, %.2f s\n", i, ml::printable(motions[i].name).c_str(), motions[i].seconds());
    }
    return motion(motions.size() == 1 ? path : path + ", 0 " + motions.front().name, motions.front());
  }
  for (const char* drawn : {".html", ".svg", ".png", ".obj", ".asf"}) {
    if (kind == drawn)
      ml::raise<ml::config_error>(103, path, ": info shows weights, motions, timelines and captions, not '", kind, "'");
  }
  if (kind == ".tsv") return captions(path);
  is_weights(path) ? show_weights(path) : timelines(path);
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
