// The exact search against the definition: a plain loop in double over all vectors, sorted.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <motionlang/core/rng.hpp>
#include <motionlang/search/detail/scan_kernels.hpp>
#include <motionlang/search/nearest.hpp>
#include <motionlang/search/vector_scan.hpp>

#include "../../support/check_error.hpp"
#include "../../support/kernel_sets.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

std::vector<float> random_rows(Index count, Index width, std::uint64_t seed) {
  std::vector<float> out(static_cast<std::size_t>(count * width));
  ml::Philox{.seed = seed}.normal(std::span(out));
  return out;
}

/// The definition. Sums in one order that is not the library's: scores may differ by the rounding of double, which
/// float does not see (except for one number in a hundred million).
std::vector<ml::Neighbour> sorted_by_cosine(std::span<const float> rows, std::span<const float> query, Index k) {
  const auto width = query.size();
  const std::vector<float> unit = ml::unit_rows(query, static_cast<Index>(width));
  std::vector<ml::Neighbour> all;
  for (std::size_t r = 0; r < rows.size() / width; ++r) {
    double sum = 0;
    for (std::size_t i = 0; i < width; ++i)
      sum += static_cast<double>(rows[r * width + i]) * static_cast<double>(unit[i]);
    all.push_back({static_cast<Index>(r), static_cast<float>(sum)});
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  all.resize(static_cast<std::size_t>(std::min<Index>(k, std::ssize(all))));
  return all;
}

void check_search(const ml::VectorSearch& search, std::span<const float> rows, std::span<const float> queries,
                  Index k) {
  const auto found = search.search(queries, k);
  const auto width = static_cast<std::size_t>(search.width());
  REQUIRE(found.size() == queries.size() / width);
  for (std::size_t q = 0; q < found.size(); ++q)
    CHECK(found[q] == sorted_by_cosine(rows, queries.subspan(q * width, width), k));
}

/// Runs f with every set of kernels that this processor has.
template <class F>
void with_every_kernel(F f) {
  using ml::detail::Isa;
  for (const auto isa : {Isa::portable, Isa::avx2, Isa::avx512, Isa::avx512_bf16, Isa::amx}) {
    const auto* kernels = ml::detail::kernels_for<float>(isa);
    const auto* of_halves = ml::detail::bf16_kernels_for(isa);
    if (kernels == nullptr || of_halves == nullptr) continue;
    const kernel_sets::Instead floats(ml::detail::current_kernels<float>(), kernels);
    const kernel_sets::Instead halves(ml::detail::current_bf16_kernels(), of_halves);
    f();
  }
}

}  // namespace

TEST_CASE("VectorScan: the k nearest, for many sizes, few and many queries, both storages, every kernel") {
  with_every_kernel([] {
    for (const Index width : {1, 3, 16, 31, 64, 100, 256, 300}) {
      for (const Index count : {1, 2, 13, 113, 700}) {
        const auto rows = ml::unit_rows(random_rows(count, width, 1), width);
        for (const auto storage : {ml::ScanStorage::float32, ml::ScanStorage::bfloat16}) {
          const ml::VectorScan scan(rows, width, {}, storage);
          for (const Index queries : {1, 8, 9, 40}) {
            const auto q = random_rows(queries, width, 2);
            for (const Index k : {1, 5, 200}) check_search(scan, rows, q, k);
          }
        }
      }
    }
  });
}

TEST_CASE("RowScan: codes of eight bits bound the cosines, and find the k nearest of the rows with every kernel") {
  with_every_kernel([] {
    for (const Index width : {1, 3, 16, 31, 64, 100, 256, 300}) {
      for (const Index count : {1, 13, 113, 700}) {
        auto values = random_rows(count, width, 1);
        for (std::size_t i = 0; i < values.size(); i += 7) values[i] *= 20;  // peaks, which make large units
        const auto rows = ml::unit_rows(values, width);
        std::vector<std::int8_t> codes(rows.size());
        std::vector<float> bounds(2 * static_cast<std::size_t>(count));
        ml::detail::RowScan<float>::to_codes(rows, width, codes.data(), bounds.data());
        for (Index r = 0; r < count; ++r) {
          double square = 0;
          for (auto i = static_cast<std::size_t>(r * width); i < static_cast<std::size_t>((r + 1) * width); ++i)
            square +=
                std::pow(static_cast<double>(rows[i]) - static_cast<double>(bounds[static_cast<std::size_t>(2 * r)]) *
                                                            static_cast<double>(codes[i]),
                         2);
          const double allowed = static_cast<double>(bounds[static_cast<std::size_t>(2 * r + 1)]);
          CHECK(std::sqrt(square) <= allowed);
          CHECK(allowed <= 0.004 * std::sqrt(static_cast<double>(width)));
        }
        const ml::detail::RowScan<float> scan{
            .rows = rows, .halves = {}, .count = count, .width = width, .codes = codes, .bounds = bounds, .name = "x"};
        for (const Index queries : {1, 8, 9, 40}) {
          const auto q = random_rows(queries, width, 2);
          for (const Index k : {1, 5, 200}) {
            const auto found = scan.nearest(ml::unit_rows(q, width), k);
            for (Index i = 0; i < queries; ++i)
              CHECK(found[static_cast<std::size_t>(i)] ==
                    sorted_by_cosine(
                        rows,
                        std::span(q).subspan(static_cast<std::size_t>(i * width), static_cast<std::size_t>(width)), k));
          }
        }
      }
    }
  });
}

TEST_CASE("RowScan: a bound that a row exceeds is damage, and vectors below a wanted score are left out") {
  constexpr Index width = 64, count = 500;
  const auto rows = ml::unit_rows(random_rows(count, width, 1), width),
             q = ml::unit_rows(random_rows(1, width, 2), width);
  std::vector<std::int8_t> codes(rows.size());
  std::vector<float> bounds(2 * static_cast<std::size_t>(count));
  ml::detail::RowScan<float>::to_codes(rows, width, codes.data(), bounds.data());
  ml::detail::RowScan<float> scan{
      .rows = rows, .halves = {}, .count = count, .width = width, .codes = codes, .bounds = bounds, .name = "a shard"};
  const auto all = scan.nearest(q, count)[0];
  const std::vector<float> least{all[20].score};
  const auto above = scan.nearest(q, 50, least)[0];
  REQUIRE(above.size() >= 21);
  CHECK(above.size() < 50);
  CHECK(std::equal(above.begin(), above.end(), all.begin()));
  bounds[static_cast<std::size_t>(2 * all[0].index)] *= 0.5f;
  CHECK_ERROR(scan.nearest(q, count), "[motionlang.io.403] a shard: damaged: a cosine of ");
}

TEST_CASE("VectorScan: of equal vectors the one that stands first, and equal vectors have equal scores") {
  constexpr Index width = 24, different = 20, copies = 40;
  const auto base = ml::unit_rows(random_rows(different, width, 3), width);
  std::vector<float> rows;
  for (Index c = 0; c < copies; ++c) rows.insert(rows.end(), base.begin(), base.end());
  const auto q = random_rows(30, width, 4);
  for (const auto storage : {ml::ScanStorage::float32, ml::ScanStorage::bfloat16}) {
    const ml::VectorScan scan(rows, width, {}, storage);
    for (const Index k : {7, 50, 800}) {
      check_search(scan, rows, q, k);
      check_search(scan, rows, std::span(q).first(width), k);
    }
    const auto found = scan.search(q, 50)[0];
    for (std::size_t i = 0; i < copies; ++i) {
      CHECK(found[i].index == found[0].index + static_cast<Index>(i) * different);
      CHECK(found[i].score == found[0].score);
    }
  }
}

TEST_CASE("VectorScan: vectors that hardly differ") {  // apart by less than the error of fast scores
  constexpr Index width = 64, count = 900;
  const auto centre = random_rows(1, width, 5), noise = random_rows(count, width, 6);
  std::vector<float> rows;
  for (std::size_t i = 0; i < noise.size(); ++i) rows.push_back(centre[i % width] + 1e-5f * noise[i]);
  rows = ml::unit_rows(rows, width);
  for (const auto storage : {ml::ScanStorage::float32, ml::ScanStorage::bfloat16}) {
    const ml::VectorScan scan(rows, width, {}, storage);
    check_search(scan, rows, centre, 10);
    check_search(scan, rows, std::span(rows).first(20 * width), 10);
  }
}

TEST_CASE("VectorScan: vectors that differ by less than bfloat16 shows, so that rounding alone would choose others") {
  constexpr Index width = 32, count = 2000;
  const auto centre = random_rows(1, width, 13), noise = random_rows(count, width, 14);
  std::vector<float> rows;
  for (std::size_t i = 0; i < noise.size(); ++i) rows.push_back(centre[i % width] * (1 + 2e-3f * noise[i]));
  rows = ml::unit_rows(rows, width);
  const auto queries = std::span(rows).first(40 * width);
  const ml::VectorScan scan(rows, width, {}, ml::ScanStorage::bfloat16);
  check_search(scan, rows, queries, 5);
  std::vector<float> rounded;  // what a search over rounded numbers on both sides would say
  for (const float x : rows) rounded.push_back(ml::bfloat16_to_float(ml::float_to_bfloat16(x)));
  Index different = 0;
  for (Index q = 0; q < 40; ++q) {
    const auto at = static_cast<std::size_t>(q * width);
    different += sorted_by_cosine(rounded, std::span(rounded).subspan(at, width), 5) !=
                 sorted_by_cosine(rows, queries.subspan(at, width), 5);
  }
  CHECK(different > 20);
}

TEST_CASE("VectorScan: the same answer alone, among others, on one thread and on more") {
  constexpr Index width = 256, count = 3000, queries = 1100;  // more than one group of queries
  const auto rows = ml::unit_rows(random_rows(count, width, 7), width), q = random_rows(queries, width, 8);
  const ml::VectorScan scan(rows, width), halves(rows, width, {}, ml::ScanStorage::bfloat16);
  const auto all = scan.search(q, 10);
  for (const int threads : {1, 2, 5}) {
    const Threads set(threads);
    CHECK(scan.search(q, 10) == all);
    CHECK(halves.search(q, 10) == all);
    for (const Index i : {Index{0}, Index{517}, queries - 1}) {
      CHECK(scan.search(std::span(q).subspan(static_cast<std::size_t>(i * width), width), 10)[0] ==
            all[static_cast<std::size_t>(i)]);
    }
  }
}

TEST_CASE("VectorScan: a vector is its own nearest, whatever the length of the query") {
  constexpr Index width = 128;
  const auto rows = ml::unit_rows(random_rows(50, width, 9), width);
  std::vector<float> queries(rows);
  for (float& x : queries) x *= 1000;
  const auto found = ml::VectorScan(rows, width).search(queries, 1);
  for (Index i = 0; i < 50; ++i) {
    CHECK(found[static_cast<std::size_t>(i)][0].index == i);
    CHECK(found[static_cast<std::size_t>(i)][0].score == doctest::Approx(1).epsilon(1e-6));
  }
}

TEST_CASE("VectorScan: nothing to search, nothing to find, nobody who asks") {
  const ml::VectorScan empty({}, 8);
  const auto q = random_rows(2, 8, 10);
  CHECK(empty.count() == 0);
  CHECK(empty.search(q, 3) == std::vector<std::vector<ml::Neighbour>>(2));
  const auto rows = ml::unit_rows(random_rows(5, 8, 11), 8);
  const ml::VectorScan scan(rows, 8);
  CHECK(scan.search(q, 0) == std::vector<std::vector<ml::Neighbour>>(2));
  CHECK(scan.search({}, 3).empty());
  CHECK(scan.search(q, 100)[1].size() == 5);
}

TEST_CASE("VectorScan: what is refused") {
  const auto rows = ml::unit_rows(random_rows(5, 8, 12), 8);
  const ml::VectorScan scan(rows, 8);
  CHECK_ERROR(scan.search(rows, -1), "[motionlang.config.101] VectorScan: the -1 nearest");
  CHECK_ERROR(scan.search(std::span(rows).first(9), 1),
              "[motionlang.shape.205] VectorScan: queries: 9 values are not rows of 8");
  CHECK_ERROR(scan.search(std::vector<float>(8), 1), "[motionlang.numeric.302] unit_rows: row 0 of 1 has length 0");
  CHECK_ERROR(scan.search(std::vector<float>(8, NAN), 1),
              "[motionlang.numeric.301] unit_rows: row 0 of 1 is not finite");
  CHECK_ERROR(ml::VectorScan(rows, 0), "[motionlang.config.101]");
  CHECK_ERROR(ml::VectorScan(rows, 7), "[motionlang.shape.205]");
  auto longer = rows;
  longer[35] += 0.1f;
  CHECK_ERROR(ml::VectorScan(longer, 8), "[motionlang.numeric.302] VectorScan: vector 4 of 5 is not of length 1");
  longer[35] = NAN;
  CHECK_ERROR(ml::VectorScan(longer, 8), "vector 4 of 5");
}
