// Real motions are written and read again as BVH, GLB, AMASS and joint positions. They are all .bvh and .amc files and
// all animations of .glb files below the folder that the environment variable MOTIONLANG_MOTIONS names. The motions are
// not part of the repository.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <numeric>

#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/amc.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../../support/lists.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

/// The difference of two motions: joint order[k] of `a` is joint k of `b`. Infinite if they differ in size.
struct Difference {
  double degrees = 0, metres = 0;  // of local rotations; of root positions and bones

  void add(const Difference& other) {
    degrees = std::max(degrees, other.degrees);
    metres = std::max(metres, other.metres);
  }
};
Difference difference(const ml::Motion& a, const ml::Motion& b, const std::vector<int>& order) {
  constexpr double never = std::numeric_limits<double>::infinity();
  if (a.frames() != b.frames() || a.skeleton.size() != b.skeleton.size()) return {never, never};
  Difference worst{0, lists::largest_distance(a.root, b.root)};
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto j = static_cast<std::size_t>(order[k]);
    if (j != 0) worst.metres = std::max(worst.metres, ml::norm(a.skeleton.offsets[j] - b.skeleton.offsets[k]));
    for (ml::Index f = 0; f < a.frames(); ++f) {
      const auto turn = ml::inverse(a.rotations(f)[j]) * b.rotations(f)[k];
      const double angle = 2 * std::atan2(ml::norm(turn.vec()), std::abs(turn.w));
      worst.degrees = std::max(worst.degrees, angle * 180 / std::numbers::pi);
    }
  }
  return worst;
}

/// The joints that an AMASS file keeps: those of SMPL without the hands.
std::vector<int> body_joints() {
  std::vector<int> order(ml::detail::amass_joints);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

/// Largest difference of a number of the file from itself after writing; infinity if the tables differ in size.
double table_difference(const fs::path& path) {
  const ml::Bvh file = ml::read_bvh(path), again = ml::parse_bvh(ml::format_bvh(file));
  double worst = lists::largest_difference(file.values, again.values);
  for (std::size_t n = 0; n < file.nodes.size(); ++n)
    worst = std::max(worst, ml::norm(file.nodes[n].offset - again.nodes[n].offset));
  return again.nodes.size() == file.nodes.size() ? worst : std::numeric_limits<double>::infinity();
}

/// The motions of a file: none of other files, of .amc without the .asf of their subject and of a character without
/// animations.
std::vector<ml::Motion> read(const fs::path& path) {
  std::vector<ml::Motion> motions;
  const std::string stem = path.stem().string();
  const auto asf = path.parent_path() / (stem.substr(0, stem.find('_')) + ".asf");
  if (path.extension() == ".bvh") motions.push_back(ml::read_bvh_motion(path));
  if (path.extension() == ".amc" && fs::exists(asf)) motions.push_back(ml::read_amc(path, ml::read_asf(asf)));
  if (path.extension() == ".glb") {
    const auto file = ml::GlbFile::open(path);
    for (ml::Index i = 0; i < std::ssize(file.animation_names()); ++i) motions.push_back(file.motion(i));
  }
  return motions;
}

/// Everything that was written and read.
struct RoundTrips {
  int files = 0, motions = 0;
  double table = 0, joints = 0;
  Difference bvh, glb, amass;

  void add(const ml::Motion& motion, const TemporaryFolder& temporary) {
    ++motions;
    ml::write_bvh(temporary / "m.bvh", motion);
    const ml::Motion from_bvh = ml::read_bvh_motion(temporary / "m.bvh");
    CHECK(from_bvh.fps == doctest::Approx(motion.fps).epsilon(1e-6));
    bvh.add(difference(motion, from_bvh, ml::detail::depth_first_order(motion.skeleton)));

    ml::write_glb(temporary / "m.glb", motion);
    const ml::Motion from_glb = ml::read_glb(temporary / "m.glb", {.fps = motion.fps});
    std::vector<int> order;
    for (const std::string& name : from_glb.skeleton.names) order.push_back(motion.skeleton[name]);
    glb.add(difference(motion, from_glb, order));

    const ml::Motion body = ml::retarget(motion);
    ml::write_amass(temporary / "m.npz", body);
    amass.add(difference(body, ml::read_amass(temporary / "m.npz").motion, body_joints()));

    ml::write_joints_npy(temporary / "m.npy", motion);
    joints = std::max(joints,
                      lists::largest_distance(motion.positions(), ml::read_joints_npy(temporary / "m.npy").positions));
  }
};

}  // namespace

TEST_CASE("round trips: every motion of a folder") {
  const char* folder = std::getenv("MOTIONLANG_MOTIONS");
  if (folder == nullptr) {
    MESSAGE("skipped: MOTIONLANG_MOTIONS names no folder of motions");
    return;
  }
  const TemporaryFolder temporary;
  RoundTrips r;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    CAPTURE(entry.path().string());
    const auto motions = read(entry.path());
    r.files += motions.empty() ? 0 : 1;
    for (const ml::Motion& motion : motions) {
      CAPTURE(motion.name);
      r.add(motion, temporary);
    }
    if (entry.path().extension() == ".bvh") r.table = std::max(r.table, table_difference(entry.path()));
  }
  MESSAGE(r.motions, " motions of ", r.files, " files; BVH tables: ", r.table,
          " units or degrees; BVH motions: ", r.bvh.degrees, " degrees, ", 100 * r.bvh.metres,
          " units; GLB: ", r.glb.degrees, " degrees, ", r.glb.metres, " m; AMASS: ", r.amass.degrees, " degrees, ",
          r.amass.metres, " m; joints: ", r.joints, " m");
  CHECK(r.files > 0);
  CHECK(r.table <= 1e-6);  // six decimals
  CHECK(r.bvh.degrees < 1e-4);
  CHECK(100 * r.bvh.metres < 1e-4);  // centimetres
  CHECK(r.glb.degrees < 0.05);       // times of keys are float32: after half a minute a microsecond of what turns fast
  CHECK(r.glb.metres < 1e-4);
  CHECK(r.amass.degrees < 1e-6);
  CHECK(r.amass.metres < 1e-9);
  CHECK(r.joints < 1e-5);  // float32
}
