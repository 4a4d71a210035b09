// The clips of ACTOR: their sizes, windows, labels and joints.
#include <motionlang/datasets/actor_clips.hpp>

#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
using ml::Index;

TEST_CASE("the rows of a frame follow from the settings") {
  CHECK(ml::ActorClipsConfig{}.width() == 25 * 6);
  CHECK(ml::ActorClipsConfig{.translation = false}.width() == 24 * 6);
  CHECK(ml::ActorClipsConfig{.global = false}.width() == 24 * 6);
  CHECK(ml::ActorClipsConfig{.pose = "xyz"}.width() == 24 * 3);
  CHECK(ml::ActorClipsConfig{.pose = "rotquat"}.width() == 25 * 4);
  CHECK(ml::ActorClipsConfig{.pose = "rotmat", .translation = false}.way() == 24 * 9);
  CHECK_ERROR(ml::actor_row_maker({.pose = "euler"}), "[motionlang.config.103]");
}

TEST_CASE("clips of published models: rotations or positions, in the world of a camera, and back") {
  const auto positions = ml::published_actor_clips({});
  CHECK(positions.is_xyz());
  const auto rotations = ml::published_actor_clips(
      ml::ActorFeatureOptions{.rotations = ml::PoseRepresentation::rotquat, .translation = false});
  CHECK(rotations.pose == "rotquat");
  CHECK_FALSE(rotations.translation);
  CHECK((rotations.camera && !rotations.turned_ahead && rotations.fps == 20));
  const ml::Motion walk = ml::retarget(synthetic::walk({.frames = 12, .fps = 20, .turn = 0.4}));
  const auto rows = ml::actor_row_maker(positions).rows(walk);
  REQUIRE(rows.size() == 12 * 72);
  CHECK(rows[0] == 0);                // they begin at the root
  CHECK(rows[15 * 3 + 1] < rows[1]);  // the head is below the pelvis: figures are upside down
  const ml::Motion back = ml::actor_motion(std::vector<float>(rows.begin(), rows.end()), positions);
  const auto there = back.positions(), here = walk.positions();
  REQUIRE(there.size() == here.size());
  double worst = 0;
  for (std::size_t i = 0; i < here.size(); ++i)
    worst = std::max(worst, ml::norm(there[i] - (here[i] - walk.root_at(0))));
  CHECK(worst < 0.02);
}

TEST_CASE("labels are sorted, and a class is the place of its label") {
  const auto with = [](const char* label) {
    ml::DescribedMotion m;
    m.texts = {{.text = label, .frames = {0, 1}}};
    return m;
  };
  ml::DescribedMotions data;
  data.training = {with("walk"), with("jump"), with("walk")};
  data.test = {with("run")};
  const auto labels = ml::labels_of(data);
  CHECK(labels == std::vector<std::string>{"jump", "run", "walk"});
  CHECK(ml::classes_of(data.training, labels) == std::vector<Index>{2, 0, 2});
  CHECK_ERROR(ml::classes_of(data.test, std::vector<std::string>{"jump"}), "[motionlang.config.103]");
}

TEST_CASE("a window counts its way from its first frame, and has the joints of the clip") {
  const ml::Motion walk = synthetic::walk({.frames = 40, .fps = 30});
  const auto motion_of = [&](const ml::ActorClipsConfig& c) {
    const auto rows = ml::actor_row_maker(c).rows(walk);
    ml::DescribedMotion m;
    m.rows.assign(rows.begin(), rows.end());
    m.texts = {{.text = "walk", .frames = {0, 40}}};
    return m;
  };
  const ml::ActorClipsConfig turned{.num_frames = 16};
  ml::PythonRandom random(std::uint64_t{1});
  const auto window = ml::actor_window(motion_of(turned), turned, random);
  REQUIRE(std::ssize(window) == 16 * turned.width());
  for (Index i = 0; i < 3; ++i) CHECK(window[static_cast<std::size_t>(turned.way() + i)] == 0);

  const ml::ActorClipsConfig all{.num_frames = -1};
  CHECK(std::ssize(ml::actor_window(motion_of(all), all, random)) == 40 * all.width());

  // The joints of rows are those of the motion that the rows become.
  const std::vector<double> values(window.begin(), window.end());
  const ml::Sequences<B> x(ml::Tensor<B, 2>::from(values, {16, turned.width()}), ml::Offsets{16});
  const auto points = ml::joint_points(x, turned);
  const auto positions = ml::actor_motion(window, turned).positions();
  REQUIRE(points.rows.count() == 3 * std::ssize(positions));
  const auto first = positions.front();
  double worst = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double* p = points.rows.span().data() + 3 * i;
    const double* o = points.rows.span().data();
    worst = std::max(worst, ml::norm((positions[i] - first) - ml::Vec3<double>{p[0] - o[0], p[1] - o[1], p[2] - o[2]}));
  }
  CHECK(worst < 1e-4);
}
