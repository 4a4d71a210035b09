// Clips from arrays of features and of joint positions.
#include <doctest/doctest.h>

#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/motion_npy.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using Joints = std::vector<ml::Vec3<double>>;

namespace {

ml::NpyArray array_of(const Joints& joints, ml::Index count) {
  std::vector<double> values;
  for (const auto& p : joints) values.insert(values.end(), {p.x, p.y, p.z});
  return ml::NpyArray::of(std::span<const double>(values), {std::ssize(joints) / count, count, 3});
}
ml::NpyArray rows_of(const std::vector<double>& values, ml::Index width) {
  return ml::NpyArray::of(std::span<const double>(values), {std::ssize(values) / width, width});
}
/// The first `count` of `joints` joints in every frame.
Joints first(const Joints& all, std::size_t joints, std::size_t count) {
  Joints out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % joints < count) out.push_back(all[i]);
  }
  return out;
}

}  // namespace

TEST_CASE("joint positions become clips, whatever is up") {
  const ml::Motion walk = synthetic::walk({.frames = 30, .turn = 0.3});
  const Joints joints = walk.positions();
  Joints z_up;
  for (const auto& p : joints) z_up.push_back({p.x, -p.z, p.y});
  for (const Joints* given : {&std::as_const(joints), &std::as_const(z_up)}) {
    const ml::Motion m = ml::motion_from_array(array_of(*given, 24));
    CHECK(m.fps == 20);
    CHECK(m.skeleton.names == ml::smpl24_skeleton().names);
    CHECK(lists::largest_distance(m.positions(), joints) < 1e-4);
  }
  const ml::Motion turned = ml::motion_from_array(array_of(z_up, 24), {.fps = 30, .up = ml::UpAxis::y});
  CHECK(turned.fps == 30);
  CHECK(lists::largest_distance(turned.positions(), z_up) < 1e-4);
  const ml::Motion fewer = ml::motion_from_array(array_of(first(joints, 24, 22), 22));
  CHECK(lists::largest_distance(first(fewer.positions(), 24, 22), first(joints, 24, 22)) < 1e-4);
}

TEST_CASE("features of the published systems become clips") {
  const ml::Motion walk = synthetic::walk({.frames = 30});
  for (const ml::MotionFeatures& f : ml::all_motion_features) {
    CAPTURE(f.name);
    const auto rows = f.from_motion(walk);
    const ml::Motion m = ml::motion_from_array(rows_of(rows, f.width));
    CHECK(m.fps == f.fps);
    const auto n = static_cast<std::size_t>(f.joints);
    const Joints wanted = f.joints_of(rows);
    CHECK(lists::largest_distance(first(m.positions(), static_cast<std::size_t>(m.skeleton.size()), n), wanted) < 2e-3);
  }
}

TEST_CASE("KIT: units, reflection, and left is left") {
  // a figure that raises its left arm, as KIT has it: reflected, 640 units per metre
  ml::Motion m{ml::kit21_skeleton(), 12.5, {}, {}, ""};
  for (int f = 0; f < 8; ++f) {
    m.root.push_back({0, 0.95, 0.1 * f});
    for (int j = 0; j < 21; ++j) {
      const double angle = j == m.skeleton["LS"] ? 0.2 * f : j == m.skeleton["RS"] ? 0.3 : 0.0;
      m.local.push_back(ml::from_axis_angle(ml::Vec3<double>{0, 0, 1}, angle));
    }
  }
  const Joints joints = m.positions();
  Joints stored, metres, lying;
  for (const auto& p : joints) {
    stored.push_back({-640 * p.x, 640 * p.y, 640 * p.z});
    metres.push_back({-p.x, p.y, p.z});
    lying.push_back({p.x, -p.z, p.y});
  }
  for (const Joints* given : {&stored, &metres, &lying}) {
    const ml::Motion read = ml::motion_from_array(array_of(*given, 21));
    CHECK(read.fps == 12.5);
    CHECK(lists::largest_distance(read.positions(), joints) < 1e-4);
  }
  const std::span<const ml::Vec3<double>> clip(stored);
  const auto lengths = ml::bone_lengths(ml::kit_chains(), clip.first(21));
  const auto rows = ml::guoh3d_features(ml::kit_chains(), clip, std::span<const double>(lengths));
  const ml::Motion read = ml::motion_from_array(rows_of(rows, 251));
  CHECK(read.frames() == 7);
  const ml::Motion smpl = ml::retarget(read);
  const auto last = first(smpl.positions(), 24, 24);
  const auto at = [&](const char* joint) {
    return last[last.size() - 24 + static_cast<std::size_t>(smpl.skeleton[joint])];
  };
  CHECK(at("left_wrist").y > at("right_wrist").y + 0.3);
}

TEST_CASE("arrays from files; what is refused") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 5});
  ml::write_joints_npy(folder / "walk.npy", walk);
  CHECK(lists::largest_distance(ml::read_motion_npy(folder / "walk.npy").positions(), walk.positions()) < 1e-4);
  const std::vector<double> numbers(60);
  ml::write_npy(folder / "odd.npy", rows_of(numbers, 20));
  CHECK_ERROR(ml::read_motion_npy(folder / "odd.npy"), "odd.npy: rows of 20 numbers are not known motion features");
  CHECK_ERROR(ml::motion_from_array(ml::NpyArray::of(std::span<const double>(numbers), {1, 20, 3})),
              "[motionlang.io.407] array: neither (frames, numbers)");
  ml::write_npy(folder / "words.npy", ml::NpyArray{'U', 4, {1, 2}, std::vector<std::byte>(8)});
  CHECK_ERROR(ml::read_motion_npy(folder / "words.npy"), "words.npy: neither (frames, numbers)");
  CHECK_ERROR(ml::read_motion_npy(folder / "none.npy"), "[motionlang.io.401]");
  for (const double fps : {-5.0, std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK_ERROR(ml::motion_from_array(ml::NpyArray::of(std::span<const double>(numbers), {1, 20, 3}), {.fps = fps}),
                "[motionlang.config.101]");
  Joints broken = walk.positions();
  broken[2 * 24 + 3].x = std::nan("");
  ml::write_npy(folder / "broken.npy", array_of(broken, 24));
  CHECK_ERROR(ml::read_motion_npy(folder / "broken.npy"), "broken.npy: number 9 of frame 2 is not finite");
  for (const ml::Index width : {263, 251, 135, 67}) {
    CAPTURE(width);
    std::vector<double> features(static_cast<std::size_t>(4 * width));
    features.back() = std::numeric_limits<double>::infinity();
    const std::string place =
        ml::concat_text("[motionlang.numeric.301] array: number ", width - 1, " of frame 3 is not finite");
    CHECK_ERROR(ml::motion_from_array(rows_of(features, width)), place.c_str());
  }
}
