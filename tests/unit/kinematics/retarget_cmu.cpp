// CMU trials that exist in three skeletons, retargeted to SMPL's: joints must be at the same place. The data are not
// part of the repository: the test runs where the environment variable MOTIONLANG_DATA names a folder with cmu-daz,
// cmu-motionbuilder and cmu-asf-amc, or one with these in motion/free, unpacked.
//
// The test aligns each pair of clips once. Time: the shift of -4 to 4 frames that fits best, because original files
// have twice the frame rate and no lead-in. Place. Length of the path: one factor on the root's x and z, because the
// Daz files share one figure and the path of a subject is 2 to 6 % off. No pose is turned or scaled.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>

#include <motionlang/formats/amc.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/retarget.hpp>

namespace ml = motionlang;

namespace {

constexpr ml::Index lead_in = 6;  // frames of the BVH files that begin in a T-pose

std::filesystem::path data() {
  const char* named = std::getenv("MOTIONLANG_DATA");
  const std::filesystem::path folder = named ? named : "";
  return std::filesystem::exists(folder / "cmu-daz") ? folder : folder / "motion" / "free";
}

std::optional<ml::Motion> bvh(const char* flavour, const std::string& trial) {
  const auto file = data() / flavour / (trial + ".bvh");
  if (!std::filesystem::exists(file)) return std::nullopt;
  return ml::retarget(ml::read_bvh_motion(file));
}
std::optional<ml::Motion> amc(const std::string& trial) {
  const auto folder = data() / "cmu-asf-amc";
  const auto file = folder / (trial + ".amc");
  if (!std::filesystem::exists(file)) return std::nullopt;
  return ml::retarget(ml::read_amc(file, ml::read_asf(folder / (trial.substr(0, 2) + ".asf"))));
}

/// Frame f of `a` against frame step f + shift of `b`: pairs of which neither is in the lead-in.
std::vector<std::pair<ml::Index, ml::Index>> common(const ml::Motion& a, const ml::Motion& b, ml::Index step,
                                                    ml::Index shift) {
  std::vector<std::pair<ml::Index, ml::Index>> out;
  for (ml::Index f = lead_in; f < a.frames(); ++f) {
    if (const ml::Index g = step * f + shift; g >= lead_in && g < b.frames()) out.emplace_back(f, g);
  }
  return out;
}

/// Mean distance of joints, metres, after the alignment of place and path.
double distance(const ml::Motion& a, const ml::Motion& b, ml::Index step, ml::Index shift) {
  const auto frames = common(a, b, step, shift);
  if (frames.size() < 30) return std::numeric_limits<double>::infinity();
  ml::Vec3<double> start_a{}, start_b{};  // means of the paths
  for (const auto& [f, g] : frames) start_a = start_a + a.root_at(f), start_b = start_b + b.root_at(g);
  start_a = (1.0 / static_cast<double>(frames.size())) * start_a;
  start_b = (1.0 / static_cast<double>(frames.size())) * start_b;
  const auto on_path = [](const ml::Motion& m, ml::Index f, const ml::Vec3<double>& start) {
    return ml::Vec3<double>{m.root_at(f).x - start.x, 0, m.root_at(f).z - start.z};
  };
  double together = 0, alone = 0;
  for (const auto& [f, g] : frames) {
    together += dot(on_path(a, f, start_a), on_path(b, g, start_b));
    alone += dot(on_path(a, f, start_a), on_path(a, f, start_a));
  }
  const double scale = together / alone;

  const auto p = a.positions(), q = b.positions();
  const auto joints = static_cast<std::size_t>(a.skeleton.size());
  double sum = 0;
  for (const auto& [f, g] : frames) {
    const auto move = start_b - start_a + (scale - 1) * on_path(a, f, start_a);
    for (std::size_t j = 0; j < joints; ++j) {
      sum += norm(p[static_cast<std::size_t>(f) * joints + j] + move - q[static_cast<std::size_t>(g) * joints + j]);
    }
  }
  return sum / static_cast<double>(frames.size() * joints);
}
double best_distance(const ml::Motion& a, const ml::Motion& b) {
  const ml::Index step = b.fps > 1.5 * a.fps ? 2 : 1;
  double best = std::numeric_limits<double>::infinity();
  for (ml::Index shift = -4; shift <= 4; ++shift) best = std::min(best, distance(a, b, step, shift));
  return best;
}

}  // namespace

TEST_CASE("CMU in three skeletons: the same joints to 3 cm") {
  if (!std::filesystem::exists(data() / "cmu-daz")) {
    MESSAGE("skipped: MOTIONLANG_DATA names no folder with cmu-daz");
    return;
  }
  struct Pair {
    std::string name;
    std::vector<double> distances{};  // of the trials
    void add(const std::optional<ml::Motion>& a, const std::optional<ml::Motion>& b) {
      if (a && b) distances.push_back(best_distance(*a, *b));
    }
  };
  Pair all{"all trials, MotionBuilder - Daz"};  // 07_12 is 25 cm: the Daz file itself drops by 25 cm in every step
  Pair three[] = {{"MotionBuilder - Daz"}, {"MotionBuilder - ASF"}, {"Daz - ASF"}};
  for (const auto& entry : std::filesystem::directory_iterator(data() / "cmu-daz")) {
    const std::string trial = entry.path().stem().string();
    const auto daz = bvh("cmu-daz", trial), builder = bvh("cmu-motionbuilder", trial), original = amc(trial);
    all.add(builder, daz);
    if (!builder || !daz || !original) continue;
    three[0].add(builder, daz);
    three[1].add(builder, original);
    three[2].add(daz, original);
  }
  for (Pair& p : {std::ref(all), std::ref(three[0]), std::ref(three[1]), std::ref(three[2])}) {
    REQUIRE(!p.distances.empty());
    std::sort(p.distances.begin(), p.distances.end());
    double mean = 0;
    for (const double d : p.distances) mean += d / static_cast<double>(p.distances.size());
    MESSAGE(p.name, ": ", p.distances.size(), " trials, mean ", 100 * mean, " cm, median ",
            100 * p.distances[p.distances.size() / 2], " cm, worst ", 100 * p.distances.back(), " cm");
    CHECK(mean < 0.03);
  }
}
