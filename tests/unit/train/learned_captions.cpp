// The captions of a training set, with the actions that they name.
#include <motionlang/train/learned_captions.hpp>

#include <doctest/doctest.h>

#include <set>

#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/training_set.hpp"
#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;

namespace {

/// A figure that stands, with one arm up to this share of the way at the end, in `frames` frames.
ml::Motion raising(int frames, double from, double to) {
  ml::Motion m = synthetic::walk({.frames = 1});
  m.fps = 20;
  const ml::Motion stand = m;
  for (int i = 1; i < frames; ++i) {
    m.root.push_back(stand.root[0]);
    m.local.insert(m.local.end(), stand.local.begin(), stand.local.end());
  }
  for (int i = 0; i < frames; ++i) {
    const double t = std::min(1.0, 2.0 * i / frames);  // the second half is still
    m.rotations(i)[17] = synthetic::about_z(2.6 * (from + (to - from) * t)) * m.rotations(i)[17];
  }
  return m;
}

ml::CaptionedSegment segment(ml::Motion motion, std::vector<std::string> captions) {
  const auto frames = motion.frames();
  return {.clip = "clip",
          .motion = std::move(motion),
          .parts = ml::BodyParts::all(),
          .captions = std::move(captions),
          .loop = {},
          .action = frames};
}

}  // namespace

TEST_CASE("an action that comes to rest ends, and the still segment like its last pose follows") {
  auto cycle = segment(raising(40, 0, 1), {"raise again and again"});
  cycle.loop = ml::Loop{0, 39};
  auto held = segment(synthetic::walk({.frames = 40}), {"walk and stop"});
  held.rest = ml::Loop{20, 39}, held.action = 20;
  const auto actions = ml::segment_actions(
      {segment(raising(40, 0, 0), {"standing", "nod", "stand quietly for long", "stand"}),
       segment(raising(40, 1, 1), {"keep the arm up"}), segment(raising(40, 0, 1), {"raise the arm"}),
       segment(raising(40, 1, 0), {"lower the arm"}), segment(synthetic::walk({.frames = 40}), {"walk"}), cycle, held});
  REQUIRE(actions.size() == 7);
  CHECK(actions[0].repeats);  // still all the time
  CHECK(actions[1].repeats);
  CHECK_FALSE(actions[2].repeats);
  CHECK(actions[2].then == "keep the arm up");
  CHECK(actions[2].seconds == 2);
  CHECK_FALSE(actions[3].repeats);
  CHECK(actions[3].then == "stand");  // the shortest command of a pose
  CHECK(actions[4].repeats);          // cut out of a longer walk
  CHECK(actions[5].repeats);
  CHECK_FALSE(actions[6].repeats);  // the table lets something follow
  CHECK(actions[6].seconds == 1);
  CHECK(ml::segment_actions({segment(raising(40, 0, 1), {"raise the arm"})})[0].then == "stand still");
}

TEST_CASE("a walk is also known backwards and along curves") {
  auto walk = segment(synthetic::walk({.frames = 40}), {"walk forward", "go for a walk"});
  CHECK(ml::sampled_captions(walk) == std::vector<std::string>{"go for a walk", "walk forward"});
  walk.loop = ml::Loop{0, 39};
  CHECK(ml::sampled_captions(walk) == std::vector<std::string>{"go for a walk", "walk backwards", "walk forward",
                                                               "walk in a circle", "walk in a curve to the left",
                                                               "walk in a half circle to the left",
                                                               "walk to the left"});
  walk.grounded = false;
  CHECK(ml::sampled_captions(walk).size() == 6);
}

TEST_CASE("the captions of a training set") {
  const ml::TrainingSet& data = captioned::training_set();
  const auto learned = ml::learned_captions(data, counted::vectors);
  std::set<std::string> sampled;
  for (const auto& segment : data.segments()) {
    for (const std::string& caption : ml::sampled_captions(segment)) sampled.insert(caption);
  }
  CHECK(learned.table().texts() == std::vector<std::string>(sampled.begin(), sampled.end()));
  for (const char* caption : {"a person swings the arms slowly", "a person walks forward", "someone walks"})
    CHECK_MESSAGE(sampled.contains(caption), caption);
  for (const char* caption : {"a person walks forward", "someone walks"})
    CHECK_MESSAGE(learned.knows(caption), caption);
  CHECK_FALSE(learned.knows("blorp the fnord"));
  for (std::size_t i = 0; i < learned.actions().size(); ++i) {
    CAPTURE(learned.table().texts()[i]);
    CHECK(learned.actions()[i].repeats);
  }
  const auto walk = static_cast<std::size_t>(std::distance(sampled.begin(), sampled.find("a person walks forward")));
  CHECK(learned.actions()[walk].seconds == doctest::Approx(data.segments()[0].seconds()));
  const auto again = ml::learned_captions(data, counted::vectors);
  CHECK(again.nearness() == learned.nearness());
}
