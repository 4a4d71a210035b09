// The motions that a model remembers: which text recalls which, in how many frames, and what is refused.
#include <motionlang/datasets/motion_memory.hpp>

#include <doctest/doctest.h>

#include <algorithm>  // max
#include <limits>     // NaN

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

ml::KnownCaptions known() {
  const std::vector<std::string> texts{"walk", "raise the right arm", "kick"};
  return {ml::TextTable::encoded(texts, counted::vectors), std::vector<ml::KnownAction>(3, {1, false, "sit"}), 0.5};
}
ml::Motion clip(int frames, double turn = 0) { return synthetic::walk({.frames = frames, .turn = turn}); }
ml::MotionMemory memory() { return {known(), {clip(20), clip(30, 0.5), clip(24, 1)}, {{2, 1}, {1, 2}, {2, 0}}}; }

double apart(const ml::Motion& a, const ml::Motion& b, Index frame_a, Index frame_b, std::size_t first_joint = 0) {
  double most = 0;
  for (std::size_t j = first_joint; j < 24; ++j) {
    const auto x = ml::to_matrix(a.rotations(frame_a)[j]), y = ml::to_matrix(b.rotations(frame_b)[j]);
    for (int r = 0; r < 3; ++r) most = std::max(most, ml::norm(x.row(r) - y.row(r)));
  }
  return most;
}

}  // namespace

TEST_CASE("the caption nearest to a text decides, and the choice among its motions") {
  const auto m = memory();
  CHECK(m.captions_with_motions() == 2);
  CHECK(m.known() == &m.captions());
  REQUIRE(m.motion("kick", 20, 0.1));
  CHECK(apart(*m.motion("kick", 20, 0.1), clip(20), 7, 7) < 1e-9);
  CHECK(apart(*m.motion("kick hard", 30, 0.9), clip(30, 0.5), 17, 17) < 1e-9);
  CHECK(apart(*m.motion("kick", 20, 1), *m.motion("kick", 20, 0.6), 9, 9) == 0);
  CHECK_FALSE(m.motion("walk", 20, 0.5));      // known, without a motion
  CHECK_FALSE(m.motion("moonwalk", 20, 0.5));  // unknown
  CHECK_FALSE(m.motion("kick", 1, 0.5));       // a frame has no speed
  CHECK(m.features("moonwalk", 20, 0).empty());
  CHECK(m.features("kick", 26, 0) == ml::smplrifke_from_motion(*m.motion("kick", 26, 0)));
}

TEST_CASE("the mirror image of a caption recalls the mirror image of its motion") {
  const auto right = memory().motion("raise the right arm", 24, 0), left = memory().motion("raise the left arm", 24, 0);
  REQUIRE((right && left));
  CHECK(apart(*left, ml::mirror(*right), 11, 11) < 1e-9);
  CHECK(apart(*left, *right, 11, 11) > 0.1);
}

TEST_CASE("a motion takes the time that it is given") {
  const ml::Motion own = clip(20);
  for (const Index frames : {1, 2, 7, 13, 14, 19, 20, 21, 29, 30, 41, 64, 200}) {
    const ml::Motion played = ml::played_in(own, frames);
    CHECK(played.frames() == frames);
    CHECK(apart(played, own, 0, 0) < 1e-9);
    if (frames >= 14) CHECK(apart(played, own, frames - 1, 19, 1) < 0.05);  // it comes to its end
  }
  CHECK(apart(ml::played_in(own, 10), own, 8, 12) < 1e-9);  // 1.5 times as fast, and cut
  const ml::Motion twice = ml::played_in(own, 41);          // a round goes on where the one before it ends
  for (Index f = 1; f < 41; ++f) CHECK(ml::norm(twice.root_at(f) - twice.root_at(f - 1)) < 0.12);
  CHECK(ml::played_in(clip(1), 5).frames() == 5);
  const ml::Motion rounds = ml::played_in(own, 50, ml::PlayedAgain::as_it_is);
  CHECK(rounds.frames() == 50);
  CHECK(apart(rounds, own, 15, 15) < 1e-9);
  CHECK(apart(rounds, own, 16 + 10, 10, 1) < 1e-9);  // the second round, which goes on in its direction
  CHECK(apart(ml::played_in(own, 9, ml::PlayedAgain::as_it_is), own, 8, 8) < 1e-9);
  const ml::Motion held = ml::played_in(own, 41, ml::PlayedAgain::no);
  CHECK(held.frames() == 41);
  CHECK(apart(held, own, 12, 12) < 1e-9);  // as fast as it is, then its last pose
  CHECK(apart(held, own, 19, 19) < 1e-9);
  CHECK(apart(held, own, 40, 19) < 1e-9);
  CHECK_ERROR(ml::played_in(own, 0), "[motionlang.shape.203] played_in: 20 frames to be played in 0 frames");
}

TEST_CASE("a motion that does not come back is held, unless it goes on") {
  const ml::Motion own = clip(20, 1.5), round = clip(1);
  CHECK_FALSE(ml::comes_back(own));
  CHECK(ml::comes_back(round));
  for (const bool repeats : {false, true}) {
    const auto captions = known().with_captions({"walk"}, {{1, repeats, "sit"}});
    const auto played = ml::MotionMemory(captions, {own}, {{0, 0}}).motion("walk", 60, 0);
    REQUIRE(played);
    CHECK((apart(*played, own, 59, 19) < 1e-9) == !repeats);
    CHECK((apart(*played, *played, 59, 40) < 1e-9) == !repeats);
  }
}

TEST_CASE("the fingerprint changes with motions and with their captions") {
  const auto print = memory().fingerprint();
  CHECK(print.size() == 16);
  CHECK(memory().fingerprint() == print);
  CHECK(ml::MotionMemory(known(), {clip(20), clip(30, 0.5), clip(24, 1)}, {{2, 1}, {0, 2}, {2, 0}}).fingerprint() !=
        print);
  const auto with = [](const ml::KnownCaptions& captions) {
    return ml::MotionMemory(captions, {clip(20), clip(30, 0.5), clip(24, 1)}, {{2, 1}, {1, 2}, {2, 0}}).fingerprint();
  };
  CHECK(with(known()) == print);
  CHECK(with(known().with_captions({"kick"}, {{1, true, ""}})) != print);     // it goes on
  CHECK(with(known().with_captions({"sit"}, {{1, false, "sit"}})) != print);  // may be nearer to a text
  CHECK(ml::MotionMemory(known(), {clip(20), clip(30, 0.6), clip(24, 1)}, {{2, 1}, {1, 2}, {2, 0}}).fingerprint() !=
        print);
}

TEST_CASE("motions and captions that do not fit are refused") {
  const auto made = [](std::vector<ml::Motion> motions, std::vector<ml::RememberedMotion> of) {
    return ml::MotionMemory(known(), std::move(motions), std::move(of), "file");
  };
  CHECK_ERROR(made({clip(20)}, {{3, 0}}), "[motionlang.shape.203] file: caption 3 of 3 captions has a motion");
  CHECK_ERROR(made({clip(20)}, {{0, 1}}), "[motionlang.shape.203] file: caption 0 has motion 1 of 1");
  CHECK_ERROR(made({clip(20), ml::crop(clip(9), 0, 0)}, {}), "[motionlang.shape.203] file: motion 1 has no frame");
  ml::Motion fast = clip(20);
  fast.fps *= 2;
  CHECK_ERROR(made({clip(20), fast}, {}), "frames per second, the first one");
  const ml::Motion few{
      ml::humanml3d22_skeleton(), 20, {{0, 1, 0}}, std::vector(22, ml::Quaternion<double>::identity())};
  CHECK_ERROR(made({few}, {}), "[motionlang.config.102] file: motion 0 has 22 joints, not 24");
  ml::Motion renamed = clip(20);
  renamed.skeleton.names[3] = "spine";
  CHECK_ERROR(made({renamed}, {}), "[motionlang.config.102] file: motion 0 has other joints than SMPL");
  ml::Motion broken = clip(20);
  broken.root[3].x = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(made({broken}, {}), ml::numeric_error);
}
