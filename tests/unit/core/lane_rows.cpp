// Lanes back into rows.
#include <doctest/doctest.h>

#include <motionlang/core/lane_rows.hpp>

#include <vector>

namespace ml = motionlang;

TEST_CASE_TEMPLATE("lanes back into rows, whole and in part", S, float, double) {
  constexpr int lanes = ml::Lane<S>::size;
  constexpr auto rows_of_lanes = static_cast<std::size_t>(lanes);
  for (const std::size_t width : {1u, 3u, 4u, 9u, 16u}) {
    std::vector<ml::Lane<S>> numbers(width);
    for (std::size_t k = 0; k < width; ++k) {
      for (int i = 0; i < lanes; ++i) numbers[k][i] = static_cast<S>(100 * i) + static_cast<S>(k);
    }
    for (int count = 0; count <= lanes; ++count) {
      std::vector<S> rows(rows_of_lanes * width, S(-1));
      ml::store_rows(std::span<const ml::Lane<S>>(numbers), count, rows.data());
      for (std::size_t at = 0; at < rows.size(); ++at) {
        const int i = static_cast<int>(at / width);
        const S wanted = i < count ? static_cast<S>(100 * i) + static_cast<S>(at % width) : S(-1);
        REQUIRE(rows[at] == wanted);
      }
    }
  }
}
