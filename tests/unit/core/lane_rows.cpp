// Rows into lanes, and lanes back into rows.
#include <doctest/doctest.h>

#include <motionlang/core/lane_rows.hpp>

#include <vector>

namespace ml = motionlang;

namespace {

constexpr std::size_t widths[] = {1, 3, 4, 9, 16};

/// The value in lane i of number k.
template <class S>
S value(std::size_t i, std::size_t k) {
  return static_cast<S>(100 * i + k);
}

template <class L>
using ScalarOf = std::remove_cvref_t<decltype(std::declval<const L&>()[0])>;

template <class L>
void check_store() {
  using S = ScalarOf<L>;
  constexpr auto lanes = static_cast<std::size_t>(L::size);
  for (const std::size_t width : widths) {
    std::vector<L> numbers(width);
    for (std::size_t k = 0; k < width; ++k) {
      for (std::size_t i = 0; i < lanes; ++i) numbers[k][static_cast<int>(i)] = value<S>(i, k);
    }
    for (const std::size_t step : {width, width + 1, width + 5}) {
      for (std::size_t count = 0; count <= lanes; ++count) {
        std::vector<S> rows(lanes * step, S(-1));
        ml::store_rows(std::span<const L>(numbers), step, static_cast<int>(count), rows.data());
        for (std::size_t at = 0; at < rows.size(); ++at) {
          const std::size_t i = at / step, k = at % step;
          REQUIRE(rows[at] == (i < count && k < width ? value<S>(i, k) : S(-1)));
        }
      }
    }
  }
}

template <class L>
void check_load() {
  using S = ScalarOf<L>;
  for (const std::size_t width : widths) {
    for (const std::size_t step : {width, width + 1, width + 5}) {
      for (int count = 1; count <= L::size; ++count) {
        std::vector<S> rows;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
          for (std::size_t k = 0; k < step; ++k) rows.push_back(k < width ? value<S>(i, k) : S(-1));
        }
        rows.resize(rows.size() - (step - width));  // no more than are read
        rows.shrink_to_fit();
        std::vector<L> numbers(width);
        ml::load_rows(rows.data(), step, count, std::span<L>(numbers));
        for (std::size_t k = 0; k < width; ++k) {
          for (int i = 0; i < L::size; ++i)
            REQUIRE(numbers[k][i] == value<S>(static_cast<std::size_t>(std::min(i, count - 1)), k));
        }
      }
    }
  }
}

template <class... L>
struct All {
  static void check() { (check_store<L>(), ...), (check_load<L>(), ...); }
};

}  // namespace

TEST_CASE("rows into lanes and lanes into rows, whole and in part, in registers of every width") {
  All<ml::Lane<float, 16>, ml::Lane<float>, ml::Lane<float, 64>, ml::Lane<double, 16>, ml::Lane<double>,
      ml::Lane<double, 64>>::check();
}
