// Clips and frames of Guo's loader.
#include <set>

#include <motionlang/datasets/guo_clip.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index;

TEST_CASE("guo_kept_clips: inside the limits, the shortest first") {
  const std::vector<Index> lengths{60, 39, 40, 200, 199, 40, 24};
  CHECK(ml::guo_kept_clips(lengths) == std::vector<Index>{2, 5, 0, 4});
  CHECK(ml::guo_kept_clips(lengths, ml::guo_clip_limits(true)) == std::vector<Index>{6, 1, 2, 5, 0, 4});
}

TEST_CASE("guo_item: whole units, at any start that fits") {
  CHECK(ml::guo_item_frames(43, false) == 40);
  CHECK(ml::guo_item_frames(43, true) == 36);
  CHECK(ml::guo_item_frames(199, false) == 196);
  ml::NumpyRandom coin(0);
  ml::PythonRandom start(0);
  std::set<Index> firsts;
  int shorter = 0;
  for (int i = 0; i < 300; ++i) {
    const auto slice = ml::guo_item(43, coin, start);
    CHECK(slice.first + slice.length <= 43);
    shorter += slice.length == 36 ? 1 : 0;
    if (slice.length == 40) firsts.insert(slice.first);
  }
  CHECK(firsts == std::set<Index>{0, 1, 2, 3});
  CHECK(shorter > 70);
  CHECK(shorter < 130);  // one in three
  CHECK_ERROR(ml::guo_item_frames(7, true), "[motionlang.config.101]");
  CHECK_ERROR(ml::guo_item_frames(7, false, 0), "[motionlang.config.101]");
}
