// Motions that MDM has generated: the dictionary of its results.npy, the array alone, and what is refused.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include <motionlang/formats/mdm_results.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"
#include "../../support/mdm_results.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

constexpr ml::Index joints = 22, frames = 6;

/// Three walks that turn more and more.
std::vector<ml::Vec3<double>> positions_of(ml::Index motion, ml::Index length) {
  const auto all =
      synthetic::walk({.frames = static_cast<int>(frames), .turn = 0.2 * static_cast<double>(motion)}).positions();
  std::vector<ml::Vec3<double>> out;
  for (ml::Index f = 0; f < length; ++f) {
    for (ml::Index j = 0; j < joints; ++j) out.push_back(all[static_cast<std::size_t>(f * 24 + j)]);
  }
  return out;
}
ml::NpyArray three_motions() {
  std::vector<float> values(static_cast<std::size_t>(3 * joints * 3 * frames));
  for (ml::Index i = 0; i < 3; ++i) {
    const auto positions = positions_of(i, frames);
    for (ml::Index at = 0; at < frames * joints; ++at) {
      const ml::Index f = at / joints, j = at % joints, first = (i * joints + j) * 3 * frames + f;
      const auto& p = positions[static_cast<std::size_t>(at)];
      const auto put = [&](ml::Index axis, double x) {
        values[static_cast<std::size_t>(first + axis * frames)] = static_cast<float>(x);
      };
      put(0, p.x), put(1, p.y), put(2, p.z);
    }
  }
  return ml::NpyArray::of(std::span<const float>(values), {3, joints, 3, frames});
}
double distance_from(const ml::Motion& m, ml::Index motion, ml::Index length) {
  std::vector<ml::Vec3<double>> seen;
  const auto all = m.positions();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % 24 < joints) seen.push_back(all[i]);
  }
  return lists::largest_distance(seen, positions_of(motion, length));
}

struct Results : TemporaryFolder {
  std::vector<ml::Motion> read(const std::string& bytes, const ml::MotionArrayOptions& options = {}) const {
    ml::write_file(*this / "results.npy", bytes);
    return ml::read_motions_npy(*this / "results.npy", options);
  }
};

}  // namespace

TEST_CASE("results of MDM: each motion with its length and its text") {
  const Results r;
  const std::string long_text(159, 'a');
  const auto motions =
      r.read(mdm::results(three_motions(), {"a person walks", "", long_text + "\u00e9t\u00e9"}, {6, 2, 100}));
  REQUIRE(motions.size() == 3);
  const ml::Index lengths[] = {6, 2, 6};  // 100: no more than there are
  for (ml::Index i = 0; i < 3; ++i) {
    const ml::Motion& m = motions[static_cast<std::size_t>(i)];
    CHECK(m.fps == 20);
    CHECK(m.skeleton.names == ml::smpl24_skeleton().names);
    REQUIRE(m.frames() == lengths[i]);
    CHECK(distance_from(m, i, lengths[i]) < 1e-4);
  }
  CHECK(motions[0].name == "a person walks");
  CHECK(motions[1].name == "1");
  CHECK(motions[2].name == long_text);  // a character of two bytes is not cut in two
  CHECK(ml::may_be_mdm_motions(r / "results.npy"));
  CHECK(r.read(mdm::results(three_motions(), {"a", "b", "c"}, {6, 6, 6}), {.fps = 30})[2].fps == 30);
}

TEST_CASE("the positions of MDM alone, and files with one motion") {
  const TemporaryFolder folder;
  ml::write_npy(folder / "a.npy", three_motions());
  CHECK(ml::may_be_mdm_motions(folder / "a.npy"));
  const auto motions = ml::read_motions_npy(folder / "a.npy");
  REQUIRE(motions.size() == 3);
  for (ml::Index i = 0; i < 3; ++i) {
    CHECK(distance_from(motions[static_cast<std::size_t>(i)], i, frames) < 1e-4);
    CHECK(motions[static_cast<std::size_t>(i)].name == std::to_string(i));
  }
  // as if Z were up
  const auto turned = ml::read_motions_npy(folder / "a.npy", {.up = ml::UpAxis::z});
  CHECK(distance_from(turned[0], 0, frames) > 0.5);

  const std::vector<float> one(static_cast<std::size_t>(frames * 24 * 3), 1);
  ml::write_npy(folder / "one.npy", ml::NpyArray::of(std::span<const float>(one), {frames, 24, 3}));
  CHECK_FALSE(ml::may_be_mdm_motions(folder / "one.npy"));
  const auto only = ml::read_motions_npy(folder / "one.npy");
  CHECK((only.size() == 1 && only[0].frames() == frames && only[0].name.empty()));
}

TEST_CASE("results of MDM that are refused") {
  const Results r;
  const auto motion = three_motions();
  const std::string good = mdm::results(motion, {"a", "b", "c"}, {6, 6, 6});
  CHECK_ERROR(r.read(mdm::results(motion, {"a", "b"}, {6, 6, 6})),
              "results.npy: 3 motions, 3 lengths and 2 texts at byte ");
  CHECK_ERROR(r.read(mdm::results(motion, {"a", "b", "c"}, {6, 6})), "3 motions, 2 lengths and 3 texts at byte ");
  CHECK_ERROR(r.read(mdm::results(motion, {"a", "b", "c"}, {6, 0, 6})), "results.npy: motion 1 has 0 of 6 frames");
  CHECK_ERROR(r.read(good + "x"), "results.npy: 1 byte behind the object");
  CHECK_ERROR(r.read(good.substr(0, good.size() - 1)), "[motionlang.io.402]");
  std::string other = good;
  other.replace(other.find("motion"), 6, "motive");
  CHECK_ERROR(r.read(other), "results.npy: no entry 'motion'");

  // Nothing of a file is run, and 2^31 - 1 motions without frames take no memory.
  std::string attack = good;
  attack.replace(attack.find("cnumpy\nndarray"), 14, "cos\nsystem\ncxx");
  CHECK_ERROR(r.read(attack), "[motionlang.io.404]");
  ml::NpyArray empty{'f', 4, {INT32_MAX, joints, 3, 0}, {}};
  CHECK_ERROR(r.read(mdm::results(empty, {}, {})), "motions, 0 lengths and 0 texts");
  ml::write_npy(r / "bare.npy", empty);
  CHECK_ERROR(ml::read_motions_npy(r / "bare.npy"),
              "bare.npy: motions (2147483647, 22, 3, 0) of type <f4, expected numbers (motions,");
  ml::write_npy(r / "bare.npy", ml::NpyArray{'f', 4, {1, 20, 3, 1}, std::vector<std::byte>(240)});
  CHECK_FALSE(ml::may_be_mdm_motions(r / "bare.npy"));
  CHECK_ERROR(ml::read_motions_npy(r / "bare.npy"), "bare.npy: motions (1, 20, 3, 1) of type <f4");
  auto broken = motion;
  const float nan = std::nanf("");
  std::memcpy(broken.data.data() + 4 * (joints * 3 * frames + frames + 2), &nan, 4);  // motion 1, joint 0, y, frame 2
  CHECK_ERROR(r.read(mdm::results(broken, {"a", "b", "c"}, {6, 6, 6})),
              "results.npy: motion 1: number 1 of frame 2 is not finite");
  CHECK(r.read(mdm::results(broken, {"a", "b", "c"}, {6, 2, 6})).size() == 3);  // behind its end
}
