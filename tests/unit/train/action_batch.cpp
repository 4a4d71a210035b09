#include <motionlang/train/action_batch.hpp>

#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using ml::Index;

TEST_CASE("another motion of the same class, or the motion itself where there is none") {
  const std::vector<Index> classes{0, 1, 0, 2, 0}, which{0, 1, 2, 3};
  ml::Philox rng{.seed = 1};
  std::set<Index> seen;
  for (int i = 0; i < 40; ++i) {
    const auto others = ml::others_of_class(which, classes, rng);
    REQUIRE(others.size() == 4);
    CHECK((others[0] == 2 || others[0] == 4));
    CHECK(others[1] == 1);
    CHECK((others[2] == 0 || others[2] == 4));
    CHECK(others[3] == 3);
    seen.insert(others[0]);
  }
  CHECK(seen.size() == 2);
}

TEST_CASE("a batch has the windows and classes of the motions that are asked for, in their order") {
  const ml::ActorClipsConfig clips{.pose = "xyz", .num_frames = 2};
  std::vector<ml::DescribedMotion> motions(3);
  for (std::size_t m = 0; m < 3; ++m) {
    motions[m].rows.assign(static_cast<std::size_t>(5 * clips.width()), static_cast<float>(m));
    motions[m].texts = {{.text = "", .frames = {0, 5}}};
  }
  const std::vector<Index> classes{4, 5, 6}, which{2, 0, 2};
  const auto batch = ml::action_batch<B>(motions, classes, which, clips, ml::Philox{.seed = 3});
  CHECK(batch.classes == std::vector<Index>{6, 4, 6});
  CHECK(batch.x.offsets == ml::Offsets{2, 2, 2});
  CHECK(batch.x.width() == clips.width());
  const auto again = ml::action_batch<B>(motions, classes, which, clips, ml::Philox{.seed = 3});
  CHECK(batch.x.rows.to_vector() == again.x.rows.to_vector());
}
