// The README's promises about the bundled weights, for the timeline in the README.
#include <doctest/doctest.h>

#include <array>
#include <vector>

#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

namespace {

const std::filesystem::path examples = MOTIONLANG_EXAMPLES;

/// Lower of the two wrists over the head at a time, in metres.
double hands_over_head(const std::vector<ml::Vec3<double>>& positions, double seconds) {
  const auto* frame = &positions[24 * static_cast<std::size_t>(seconds * 20)];
  return std::min(frame[20].y, frame[21].y) - frame[15].y;
}

}  // namespace

TEST_CASE("walks, raises both arms from 2 s to 5 s; bones keep their lengths, feet do not slide, nothing trembles") {
  const TemporaryFolder folder;
  const auto recorded = ml::SafetensorsFile::open(examples / "models/stmc_free.safetensors").metadata();
  for (const char* seed : {"0", "1", "2"}) {
    CAPTURE(seed);
    const auto out = run({"generate", "--timeline", (examples / "timelines/walk_and_raise_arms.txt").string(), "--out",
                          seed, "--seed", seed},
                         folder.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    CHECK_MESSAGE(out.text.find("never learned") == out.text.npos, out.text);
    const auto motion = ml::read_amass(folder / seed / "walk_and_raise_arms.npz").motion;
    REQUIRE(motion.frames() == 120);
    const auto positions = motion.positions();
    const auto quality = ml::motion_quality(motion);
    CHECK(quality.feet.speed < 1.5 * std::stod(recorded.at("real.skate")));
    CHECK(quality.jitter < 1.5 * std::stod(recorded.at("real.jitter")));
    const auto joints = ml::read_joints_npy((folder / seed / "walk_and_raise_arms.npy").string());
    CHECK(ml::bone_length_deviation({joints.positions, joints.joints, 20}, motion.skeleton.parents) < 1e-4);

    const auto way = motion.root_at(119) - motion.root_at(0);
    CHECK(std::hypot(way.x, way.z) > 3);
    CHECK(hands_over_head(positions, 3.5) > 0);
    CHECK(hands_over_head(positions, 1) < -0.3);
    CHECK(hands_over_head(positions, 5.9) < -0.3);
  }
}

TEST_CASE("a text that no caption of the training is near to is reported") {
  const TemporaryFolder folder;
  const auto out = run({"generate", "--text", "A person does photosynthesis", "--seconds", "1", "--preset", "fast",
                        "--model", (examples / "models/stmc_free.safetensors").string()},
                       folder.path);
  REQUIRE_MESSAGE(out.code == 0, out.text);
  const bool has_captions =
      ml::SafetensorsFile::open(examples / "models/stmc_free.safetensors").metadata().contains("captions");
  const std::string line = has_captions ? "'A person does photosynthesis' is far from all that the model learned"
                                        : ": the model never learned the word 'photosynthesis'\n";
  CHECK_MESSAGE(out.text.find(line) != out.text.npos, out.text);
}

TEST_CASE("motions are found by words without a model of one's own") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "clips");
  const std::vector<std::array<std::string, 3>> moves{{"walk forward", "walk_forward", "a person is walking"},
                                                      {"raise both arms", "raise_both_arms", "lifts the arms"},
                                                      {"sit down", "sit_down", "somebody sits down"},
                                                      {"jump", "jump", "jumping up"},
                                                      {"run forward", "run_forward", "a person runs"}};
  for (const auto& [text, name, query] : moves) {
    const auto made =
        run({"generate", "--text", text, "--seconds", "3", "--preset", "fast", "--out", "made"}, folder.path);
    REQUIRE_MESSAGE(made.code == 0, made.text);
    std::filesystem::copy(folder / ("made/" + name + ".bvh"), folder / "clips");
  }
  const auto index = run({"index", "clips", "-o", "moves.index", "--no-moments"}, folder.path);
  REQUIRE_MESSAGE(index.code == 0, index.text);
  for (const auto& [text, name, query] : moves) {
    const auto found = run({"search", "moves.index", query, "--top", "1"}, folder.path);
    CHECK_MESSAGE(found.text.find(name + ".bvh") != found.text.npos, query, ": ", found.text);
  }
}
