// Files of motions as lines.
#include <doctest/doctest.h>

#include <motionlang/core/formatted.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/metrics/motion_quality.hpp>
#include <motionlang/view/describe_motion.hpp>

#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a motion is described by its frames, its place and its joints, SMPL's also by its feet") {
  ml::Motion walk = synthetic::walk({.frames = 40});
  const std::string text = ml::describe_motion("walk\a.bvh", walk);
  CHECK(text.starts_with("walk?.bvh: 40 frames, 20 frames per second, 2.00 s, 24 joints\n  root moves within x "));
  const auto quality = ml::motion_quality(walk);
  CHECK(text.find(ml::formatted("\n  feet on the floor %.0f %% of the time, sliding at %.2f m/s; jitter %.0f m/s^3; ",
                                100 * quality.feet.contact, quality.feet.speed, quality.jitter)) != std::string::npos);
  CHECK(text.find("\n    0 pelvis                   \n    1 ") != std::string::npos);
  walk.skeleton.names[5] = "other";
  CHECK(ml::describe_motion("walk", walk).find("feet on the floor") == std::string::npos);
  walk.root.clear(), walk.local.clear();
  CHECK(ml::describe_motion("none", walk) == "none: 0 frames, 20 frames per second, 0.00 s, 24 joints\n");
}

TEST_CASE("files of one motion, of several, of positions, and of none") {
  const TemporaryFolder folder;
  std::vector<ml::Motion> two{synthetic::walk({.frames = 10}), synthetic::walk({.frames = 20, .turn = 1})};
  two[1].name = "turn";
  ml::write_bvh(folder / "walk.bvh", two[0]);
  ml::write_glb(folder / "two.glb", two);
  ml::write_joints_npy(folder / "joints.npy", two[0]);
  const std::vector<float> one{1};
  const std::vector<ml::NamedArray> arrays{{"weight", ml::NpyArray::of(std::span<const float>(one), {1})}};
  ml::write_npz(folder / "weights.npz", arrays);
  ml::write_amass(folder / "amass.npz", two[0]);

  for (const char* name : {"walk.bvh", "two.glb", "joints.npy", "amass.npz"})
    CHECK_MESSAGE(ml::holds_motions(folder / name), name);
  CHECK(!ml::holds_motions(folder / "weights.npz"));
  CHECK(!ml::holds_motions("notes.txt"));

  const auto described = [&](const char* name) { return ml::describe_motion_file(folder / name); };
  CHECK(described("walk.bvh").find("walk.bvh: 10 frames, 20 frames per second, 0.50 s, 24 joints\n") !=
        std::string::npos);
  const std::string several = described("two.glb");
  CHECK(several.find("2 animations\n  0 walk, 0.50 s\n  1 turn, 1.00 s\n") != std::string::npos);
  CHECK(several.find("two.glb, 0 walk: 10 frames") != std::string::npos);
  CHECK(described("joints.npy").find("joints.npy: joint positions, 10 frames of 24 joints\n  read as Z up") !=
        std::string::npos);
}
