// Motions of another program: their files, rows, errors, and the makers of the evaluations.
#include <motionlang/train/made_motions.hpp>

#include <doctest/doctest.h>

#include <limits>

#include <motionlang/backend/usual.hpp>
#include <motionlang/datasets/actor_clips.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/formats/bvh.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

const ml::MotionFeatures& features() { return ml::motion_features("smplvelp"); }

/// A walk of a part, as rows of smplvelp.
ml::DescribedMotion walk(const std::string& id, double turn) {
  const auto motion = synthetic::walk({.frames = 40, .fps = 12.5, .turn = turn});
  const auto rows = features().from_motion(motion);
  ml::DescribedMotion out{id, id.substr(0, id.find('@')), {rows.begin(), rows.end()}, {}};
  out.texts.push_back({"a person walks", {0, std::ssize(rows) / features().width}});
  return out;
}
void write_rows(const std::filesystem::path& path, const ml::DescribedMotion& motion) {
  ml::write_npy(path, ml::NpyArray::of(std::span<const float>(motion.rows),
                                       {std::ssize(motion.rows) / features().width, features().width}));
}

}  // namespace

TEST_CASE("files have the id of the motion or of its clip, and several samples have numbers") {
  const TemporaryFolder folder;
  const std::vector<ml::DescribedMotion> part{walk("a@0-2", 0), walk("b", 0.4)};
  const ml::MadeMotions made(folder.path);
  CHECK_ERROR(made.samples(part), "a file is needed for each of 2 motions; 2 left out: 2 without a file (a@0-2, b)");
  CHECK_ERROR(made.files(part[0]), "has no a@0-2.npy, .npz, .bvh, .glb or .vrma, also not as a");
  ml::write_bvh(folder / "a.bvh", synthetic::walk({.frames = 30}));
  for (int k = 0; k < 3; ++k) write_rows(folder / ("b_" + std::to_string(k) + ".npy"), part[1]);
  CHECK(made.samples(part) == 1);
  CHECK(made.files(part[0]) == std::vector<std::filesystem::path>{folder / "a.bvh"});
  CHECK(made.files(part[1]).size() == 3);
  write_rows(folder / "a@0-2_0.npy", part[0]);
  write_rows(folder / "a@0-2_1.npy", part[0]);
  CHECK(made.samples(part) == 2);

  // features in a file keep their rate, motions get the one that is asked for
  const auto ready = made.rows(folder / "b_0.npy", features(), 100), read = made.rows(folder / "a.bvh", features(), 50);
  CHECK((ready.fps == 12.5 && ready.rows == part[1].rows));
  CHECK(read.fps == 50);
  const Index frames = std::ssize(read.rows) / features().width;
  CHECK(std::abs(static_cast<double>(frames) - 50 * synthetic::walk({.frames = 30}).seconds()) < 3);
}

TEST_CASE("features without rows, or with numbers that are not finite, are refused") {
  const TemporaryFolder folder;
  const ml::MadeMotions made(folder.path);
  auto broken = walk("a", 0);
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    broken.rows.back() = value;
    write_rows(folder / "a.npy", broken);
    CHECK_ERROR(made.rows(folder / "a.npy", features(), 20), "[motionlang.io.403]");
    CHECK_ERROR(made.rows(folder / "a.npy", features(), 20), "a.npy: a number that is not finite");
  }
  broken.rows.clear();
  write_rows(folder / "a.npy", broken);
  CHECK_ERROR(made.rows(folder / "a.npy", features(), 20), "[motionlang.io.403]");
  CHECK_ERROR(made.rows(folder / "a.npy", features(), 20), "a.npy: no rows");
}

TEST_CASE("errors of the same motions are 0, and those of others are not") {
  const TemporaryFolder folder;
  ml::DescribedMotions data{features().width, 12.5, {}, {}, {}};
  data.test = {walk("a", 0), walk("b", 0.6)};
  const ml::TemosJoints joints(features());
  for (const auto& motion : data.test) write_rows(folder / (motion.id + ".npy"), motion);
  for (const double rate : {0.0, 100.0}) {
    const auto same = ml::made_errors(ml::MadeMotions(folder.path), features(), data, data.test, joints, rate);
    CHECK(same.name == folder.path.filename().string());
    CHECK(same.errors.ape.root == 0);
  }
  write_rows(folder / "a.npy", data.test[1]);
  const auto other = ml::made_errors(ml::MadeMotions(folder.path), features(), data, data.test, joints, 100);
  CHECK(other.errors.ape.root > 0.01);
  // the recorded motions at the rate, if they are there
  auto shorter = data.test;
  for (auto& motion : shorter) {
    motion.rows.resize(static_cast<std::size_t>(10 * features().width));
    motion.texts.front().frames.length = 10;
  }
  const auto beside = ml::made_errors(ml::MadeMotions(folder.path), features(), data, data.test, joints, 100, shorter);
  CHECK(beside.errors.ape.root != other.errors.ape.root);
}

TEST_CASE("motions of actions lie in folders of their labels") {
  const TemporaryFolder folder;
  for (const char* label : {"walk", "turn"}) std::filesystem::create_directories(folder / label);
  ml::write_bvh(folder / "walk/1.bvh", synthetic::walk({.frames = 30}));
  ml::write_bvh(folder / "walk/0.bvh", synthetic::walk({.frames = 20}));
  const ml::ActorClipsConfig clips{.fps = 15};
  const std::vector<std::string> labels{"turn", "walk"};
  const ml::MadeMotions made(folder.path);
  CHECK_ERROR(made.of_actions(labels, ml::actor_row_maker(clips)), "no motions of 'turn'");
  ml::write_bvh(folder / "turn/0.bvh", synthetic::walk({.frames = 20, .turn = 1}));
  const auto all = made.of_actions(labels, ml::actor_row_maker(clips));
  REQUIRE(all.size() == 3);
  CHECK((all[0].texts.front().text == "turn" && all[1].id == "0" && all[2].id == "1"));
  CHECK(all[1].rows.size() < all[2].rows.size());
  CHECK(ml::classes_of(all, labels) == std::vector<Index>{0, 1, 1});
}

TEST_CASE("the evaluator of Guo et al. gets a sample of the wanted motion, of at most 196 frames") {
  const TemporaryFolder folder;
  const auto& guo = ml::motion_features("guoh3d");
  const auto write = [&](const std::string& name, Index frames, float value) {
    const std::vector<float> rows(static_cast<std::size_t>(frames * guo.width), value);
    ml::write_npy(folder / name, ml::NpyArray::of(std::span<const float>(rows), {frames, guo.width}));
  };
  write("a_0.npy", 40, 1);
  write("a_1.npy", 40, 2);
  write("b.npy", 230, 3);
  const std::vector<ml::DescribedMotion> part{walk("a", 0), walk("b", 0)};
  const ml::MadeMotions made(folder.path);
  const auto make = ml::made_maker<B>(made, guo.width);
  std::vector<ml::GuoWanted> wanted{{"x", "x", 40, &part[0]}, {"y", "y", 60, &part[1]}};
  std::set<float> seen;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto motions = make(wanted, ml::Philox{.seed = seed});
    REQUIRE(motions.count() == 2);
    CHECK((motions.offsets.length(0) == 40 && motions.offsets.length(1) == 196));
    seen.insert(motions.rows.span().front());
    CHECK(motions.rows.span().back() == 3);
  }
  CHECK(seen == std::set<float>{1, 2});
  wanted[0].motion = nullptr;
  CHECK_ERROR(make(wanted, ml::Philox{}), "[motionlang.config.102]");
}
