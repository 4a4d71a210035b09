#include <motionlang/generate/detail/kept_clip.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using Ranges = std::vector<ml::IndexRange>;

TEST_CASE("the frames that are kept of a clip in a timeline") {
  ml::KeptClip keep;
  CHECK(ml::detail::kept_frames(keep, 30, 40, 20) == Ranges{{0, 30}});
  CHECK(ml::detail::kept_frames(keep, 50, 40, 20) == Ranges{{0, 40}});
  keep.seconds = {{1, 1.5}, {0, 0.25}};
  CHECK(ml::detail::kept_frames(keep, 30, 40, 20) == Ranges{{20, 30}, {0, 5}});
  CHECK_ERROR(ml::detail::kept_frames(keep, 29, 40, 20), "[motionlang.config.101] keep: 1-1.5 is frames 20:30 at 20");
  CHECK_ERROR(ml::detail::kept_frames(keep, 30, 29, 20), "the motion to keep has 30, the timeline 29");
  keep.seconds = {{0.5, 0.5}};
  CHECK_ERROR(ml::detail::kept_frames(keep, 30, 40, 20), "is frames 10:10");
}

TEST_CASE("a motion comes to where the kept clip is, and says how far its kept frames are") {
  const ml::Motion clip = synthetic::walk({.frames = 30, .turn = 0.3});
  ml::Motion moved = clip;
  for (auto& p : moved.root) p.x += 3, p.z -= 1;
  ml::GenerateOptions options{.smooth = false, .keep = ml::KeptClip{clip, {{0.5, 1}}}};
  CHECK(std::abs(ml::detail::farthest_from(moved, clip, 30, *options.keep) - std::hypot(3, 1)) < 1e-12);
  const ml::Motion back = ml::detail::in_its_place(moved, clip, 30, options);
  CHECK(synthetic::largest_distance(back, clip) < 1e-9);
  CHECK(ml::detail::farthest_from(back, clip, 30, *options.keep) < 1e-9);
  options.keep->parts = ml::BodyParts{}.with(ml::BodyPart::head);  // the way is not kept
  CHECK(synthetic::largest_distance(ml::detail::in_its_place(moved, clip, 30, options), moved) == 0);
  CHECK(ml::detail::farthest_from(moved, clip, 30, *options.keep) == 0);
}

TEST_CASE("made frames lead from kept ones to kept ones; these stay") {
  ml::Motion motion = synthetic::walk({.frames = 30});
  for (ml::Index f = 10; f < 20; ++f) motion.root[static_cast<std::size_t>(f)].y += 0.5;  // made: a jump at both ends
  const Ranges kept{{0, 10}, {20, 30}};
  const ml::Motion out = ml::detail::without_jumps(motion, kept, 4);
  for (const ml::Index f : {0, 9, 20, 29}) CHECK(out.root_at(f).y == motion.root_at(f).y);
  CHECK(std::abs(out.root_at(10).y - out.root_at(9).y) < 0.1);
  CHECK(std::abs(out.root_at(20).y - out.root_at(19).y) < 0.1);
  CHECK(std::abs(motion.root_at(10).y - motion.root_at(9).y) > 0.4);
}
