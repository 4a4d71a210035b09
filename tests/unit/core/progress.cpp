// Progress callbacks, and masks of dropout.
#include <doctest/doctest.h>

#include <cmath>

#include <motionlang/core/dropout.hpp>
#include <motionlang/core/progress.hpp>

namespace ml = motionlang;

namespace {
bool half_way(ml::Index done, ml::Index total) { return 2 * done < total; }
}  // namespace

TEST_CASE("a function is a callback as well") {
  const ml::Progress progress(half_way);
  progress(1, 4);
  CHECK_THROWS_AS(progress(2, 4), ml::cancelled);
}

TEST_CASE("an empty progress does nothing; a callback that answers false cancels") {
  ml::Progress{}(1, 2);
  ml::Index last = 0;
  const auto callback = [&](ml::Index done, ml::Index total) { return (last = done) < total; };
  const ml::Progress progress(callback);
  progress(1, 3);
  const ml::Progress copy = progress;
  copy(2, 3);
  CHECK(last == 2);
  static_assert(!std::is_constructible_v<ml::Progress, decltype([](ml::Index, ml::Index) { return true; })>,
                "a temporary would be gone when it is called");
  CHECK_THROWS_AS(copy(3, 3), ml::cancelled);
}

TEST_CASE("a mask is a function of key and position, and keeps the expected share at every p") {
  for (double p : {0.01, 0.1, 0.5, 0.9}) {
    const ml::Dropout d{.p = p, .key = 42};
    int kept = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      CHECK((d.factor(i) == 0 || d.factor(i) == 1 / (1 - p)));
      kept += d.factor(i) != 0;
    }
    CHECK(std::abs(kept - 20000 * (1 - p)) < 4 * std::sqrt(20000 * p * (1 - p)));
  }
  CHECK(ml::Dropout{}.factor(7) == 1);
  int different = 0;
  for (std::uint64_t i = 0; i < 1000; ++i)
    different += ml::Dropout::bits(1, i) != ml::Dropout::bits(std::uint64_t{1} << 40, i);
  CHECK(different > 990);  // all bits of the key count
}
