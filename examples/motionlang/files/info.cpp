// motionlang info: what is in a file of weights, a motion, or a timeline.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <motionlang/io/amass.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "../commands.hpp"
#include "motion_files.hpp"
#include "../generate/timelines.hpp"
#include "weights.hpp"

namespace program {

namespace {

void motion(const std::string& path, const ml::Motion& m) {
  std::printf("%s: %td frames, %g frames per second, %.2f s, %d joints\n", path.c_str(), m.frames(), m.fps, m.seconds(),
              m.skeleton.size());
  if (m.frames() == 0) return;
  ml::Vec3<double> low = m.root_at(0), high = low;
  for (const auto& p : m.root) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  std::printf("  root moves within x %.2f ... %.2f, y %.2f ... %.2f, z %.2f ... %.2f m\n", low.x, high.x, low.y, high.y,
              low.z, high.z);
  if (std::ranges::is_permutation(m.skeleton.names, ml::smpl24_skeleton().names)) {  // BVH has them depth first
    const auto q = ml::motion_quality(on_smpl(m));
    std::printf(
        "  feet on the floor %.0f %% of the time, sliding at %.2f m/s; jitter %.0f m/s^3; "
        "%.1f cm below the floor\n",
        100 * q.feet.contact, q.feet.speed, q.jitter, 100 * q.below_floor.mean);
  }
  for (int j = 0; j < m.skeleton.size(); ++j) {
    std::printf("  %3d %-24s %s\n", j, m.skeleton.name(j).c_str(),
                j == 0 ? "" : m.skeleton.name(m.skeleton.parent(j)).c_str());
  }
}

void joints(const std::string& path) {
  const auto j = ml::read_joints_npy(path);
  std::printf("%s: joint positions, %td frames x %td joints\n", path.c_str(), j.frames, j.joints);
}

void timelines(const std::string& path) {
  for (const auto& t : read_timelines(path, 20)) {
    const auto texts = std::ssize(t.intervals);
    std::printf("timeline: %td %s, %.2f s\n", texts, texts == 1 ? "text" : "texts", static_cast<double>(t.end()) / 20);
    for (const auto& i : t.intervals)
      std::printf("  %6.2f - %6.2f s  %s\n", static_cast<double>(i.start) / 20, static_cast<double>(i.end) / 20,
                  i.text.c_str());
  }
}

void run(const std::string& path) {
  if (path == standard_input) return timelines(path);
  const std::string kind = kind_of(path);
  if (kind == ".npy" && holds_joints(path)) return joints(path);
  const bool motion_file = kind == ".npz" && holds_motion(path);
  if (!motion_file && !is_gltf(path) && is_weights(path)) return show_weights(path);
  if (kind == ".bvh" || motion_file || is_gltf(path) || kind == ".amc") {
    const auto motions = read_motions(path);
    if (motions.size() > 1) {
      std::printf("%zu animations\n", motions.size());
      for (std::size_t i = 0; i < motions.size(); ++i)
        std::printf("  %zu %s, %.2f s\n", i, motions[i].name.c_str(), motions[i].seconds());
    }
    return motion(motions.size() == 1 ? path : path + ", 0 " + motions.front().name, motions.front());
  }
  for (const char* drawn : {".html", ".svg", ".png", ".obj", ".asf"}) {
    if (kind == drawn)
      ml::raise<ml::config_error>(103, path, ": shown are weights, motions and timelines, not '", kind, "'");
  }
  timelines(path);
}

/// CLI::ExistingPath, or standard input.
std::string readable(const std::string& path) { return path == standard_input ? "" : CLI::ExistingPath(path); }

}  // namespace

void add_info(CLI::App& app) {
  const auto path = std::make_shared<std::string>();
  CLI::App* c = app.add_subcommand(
      "info", "Shows what a file holds: weights (safetensors, PyTorch, NumPy, pickles, run folders), motion (.bvh .amc .glb "
      ".npz .npy), or a timeline");
  c->add_option("file", *path, "The file; - for a timeline from standard input")
      ->required()
      ->check(readable, "PATH(existing)");
  c->callback([path] { run(*path); });
}

}  // namespace program
