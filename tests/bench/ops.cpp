// Time of every operation in the table of tests/ops, for the three backends in float, side by side.
//   usage: bench_ops [factor]      sizes above 1 are multiplied by the factor (8), where the operation allows it
#include <cstdio>
#include <cstdlib>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "../ops/table.hpp"
#include "bench.hpp"

namespace {

namespace ml = motionlang;
using ml::Index;

/// Microseconds of row i, median of at least five runs.
template <ml::Backend B>
double microseconds(const table::Row<B>& row, std::size_t i, Index factor) {
  auto shapes = row.inputs;
  for (ml::Shape& s : shapes) {
    for (int axis = 0; row.grows && axis < s.rank(); ++axis) s[axis] *= s[axis] > 1 ? factor : 1;
  }
  const auto inputs = table::tensors<B>(table::draw(shapes, row.domain, i + 1), shapes);
  row.run(inputs);
  const auto times = bench::times_of([&] { row.run(inputs); }, 0.05, 5, 1000);
  return times[times.size() / 2] * 1e6;
}

}  // namespace

int main(int argc, char** argv) {
  const Index factor = argc > 1 ? std::max(1, std::atoi(argv[1])) : 8;
  const auto eigen = table::rows<ml::EigenBackend<float>>();
  const auto xtensor = table::rows<ml::XtensorBackend<float>>();
  const auto reference = table::rows<ml::ReferenceBackend<float>>();
  std::printf("sizes x %td, %d threads, microseconds; reference / eigen\n", factor, ml::thread_count());
  std::printf("%-40s %10s %10s %10s %8s\n", "operation", "eigen", "xtensor", "reference", "ratio");
  for (std::size_t i = 0; i < eigen.size(); ++i) {
    const double e = microseconds(eigen[i], i, factor), x = microseconds(xtensor[i], i, factor),
                 r = microseconds(reference[i], i, factor);
    std::printf("%-40s %10.1f %10.1f %10.1f %8.1f\n", eigen[i].name.c_str(), e, x, r, r / e);
    std::fflush(stdout);
  }
}
