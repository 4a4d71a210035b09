// Exact search over 1,000,000 vectors of 256 numbers, ten nearest: one query and a thousand. search_bf16 scans a copy
// in bfloat16 and compares the best ones exactly: the same answer.
//
// usage: bench_search [THREADS] [search search_bf16 ...]
#include <motionlang/core/rng.hpp>
#include <motionlang/search/vector_scan.hpp>

#include "bench.hpp"

namespace ml = motionlang;
using ml::Index;

int main(int argc, char** argv) {
  const bench::Arguments asked_for(argc, argv);
  constexpr Index count = 1'000'000, width = 256, nearest = 10;
  std::vector<float> rows(count * width), queries(1000 * width);
  ml::parallel_for(count / 1000, [&](Index i) {
    ml::Philox{.seed = 1}
        .split(static_cast<std::uint64_t>(i))
        .normal(std::span(rows).subspan(static_cast<std::size_t>(i) * 1000 * width, 1000 * width));
  });
  ml::Philox{.seed = 2}.normal(std::span(queries));
  rows = ml::unit_rows(rows, width);
  for (const auto storage : {ml::ScanStorage::float32, ml::ScanStorage::bfloat16}) {
    const char* work = storage == ml::ScanStorage::bfloat16 ? "search_bf16" : "search";
    if (!asked_for.asked(work)) continue;
    const ml::VectorScan gallery(rows, width, {}, storage);
    for (const Index n : {1, 1000}) {
      const auto some = std::span(queries).first(static_cast<std::size_t>(n * width));
      bench::report(work, n == 1 ? "1 query 1e6x256" : "1000 queries 1e6x256",
                    2e-9 * static_cast<double>(n * count * width), [&] { gallery.search(some, nearest); },
                    {.least = 3});
    }
  }
}
