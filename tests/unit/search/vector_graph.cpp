// Approximate search: most of the nearest, exact scores, the graph in the index file, and graphs that are damaged.
#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/search/vector_graph.hpp>

#include "../../support/check_error.hpp"
#include "../../support/indexed_motions.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
using ml::Index;

#if MOTIONLANG_HAS_HNSWLIB

namespace {

std::vector<float> random_rows(Index count, Index width, std::uint64_t seed) {
  std::vector<float> out(static_cast<std::size_t>(count * width));
  ml::Philox{.seed = seed}.normal(std::span(out));
  return ml::unit_rows(out, width);
}

}  // namespace

TEST_CASE(
    "VectorGraph: nearly all of the ten nearest, with the scores of an exact search; the same on one thread and on "
    "more") {
  constexpr Index width = 24, count = 3000;
  const auto rows = random_rows(count, width, 1), queries = random_rows(100, width, 2);
  const auto graph = ml::VectorGraph::build(rows, width);
  const auto found = graph.search(queries, 10), wanted = ml::VectorScan(rows, width).search(queries, 10);
  Index same = 0;
  for (std::size_t q = 0; q < found.size(); ++q) {
    REQUIRE(found[q].size() == 10);
    CHECK(std::is_sorted(found[q].begin(), found[q].end(), ml::is_nearer));
    for (const auto& n : found[q]) same += std::count(wanted[q].begin(), wanted[q].end(), n);
  }
  CHECK(same >= 950);
  const auto again = ml::VectorGraph::from_bytes(graph.bytes(), rows, width);
  for (const int threads : {1, 3}) {
    const Threads set(threads);
    CHECK(again.search(queries, 10) == found);
  }
  CHECK(ml::VectorGraph::build(rows, width).bytes() == graph.bytes());
  CHECK(graph.search(queries, 0)[0].empty());
  CHECK_ERROR(graph.search(std::span(queries).first(5), 1), "[motionlang.shape.205]");
}

TEST_CASE("VectorGraph: a graph that gets more vectors finds as many as one that is built at once") {
  constexpr Index width = 24, count = 3000;
  const auto rows = random_rows(count, width, 1), queries = random_rows(100, width, 2);
  const auto wanted = ml::VectorScan(rows, width).search(queries, 10);
  auto graph = ml::VectorGraph::build(std::span(rows).first(width), width);
  for (const Index have : {Index{40}, Index{41}, Index{2500}, count})
    graph = ml::VectorGraph::extended(graph.bytes(), graph.count(),
                                      std::span(rows).first(static_cast<std::size_t>(have * width)), width);
  const auto found = graph.search(queries, 10);
  Index same = 0;
  for (std::size_t q = 0; q < found.size(); ++q) {
    for (const auto& n : found[q]) same += std::count(wanted[q].begin(), wanted[q].end(), n);
  }
  CHECK(same >= 950);
  CHECK(ml::VectorGraph::from_bytes(graph.bytes(), rows, width).search(queries, 10) == found);
  CHECK_ERROR(ml::VectorGraph::extended(graph.bytes(), count - 1, rows, width), "another number of vectors");
  CHECK_ERROR(ml::VectorGraph::extended(graph.bytes(), count, std::span(rows).first(width), width),
              "[motionlang.config.101] graph: a graph of 3000 vectors for 1");
}

TEST_CASE("VectorGraph: a graph that is cut off, changed, or of other vectors is refused or harmless") {
  constexpr Index width = 8, count = 60;
  const auto rows = random_rows(count, width, 3);
  const auto bytes = ml::VectorGraph::build(rows, width).bytes();
  for (std::size_t n = 0; n < bytes.size(); n += 7)
    CHECK_ERROR(ml::VectorGraph::from_bytes(std::span(bytes).first(n), rows, width), "[motionlang.io.40");
  CHECK_ERROR(ml::VectorGraph::from_bytes(bytes, std::span(rows).first(30 * width), width),
              "another number of vectors");
  const auto query = random_rows(1, width, 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    auto other = bytes;
    other[i] ^= std::byte{0x55};
    try {
      ml::VectorGraph::from_bytes(other, rows, width).search(query, 5);
    } catch (const ml::io_error&) {}
  }
}

TEST_CASE("index files with graphs: from so many vectors on, and the same answers") {
  const TemporaryFolder folder;
  ml::MotionIndex index(synthetic::action_model({20}, 5));
  for (Index i = 0; i < 12; ++i)
    index.add(
        synthetic::acted_clip(std::to_string(i) + ".bvh", {{i % 8, 30 + i}, {(i * 3 + 1) % 8, 20}}, index.model()));
  const auto graphs = ml::motion_graphs(index, 50);
  CHECK(!graphs.contains("graph_clips"));
  CHECK(graphs.contains("graph_moments"));
  CHECK(ml::motion_graphs(index, 100'000).empty());
  ml::write_motion_index(folder / "index", index, ml::motion_graphs(index, 1));
  const auto file = ml::MotionIndexFile::open(folder / "index");
  CHECK(ml::has_graphs(file, 1));
  const auto with_graphs = ml::open_motion_search(file), exact = ml::open_motion_search(file, true);
  for (Index a = 0; a < 8; ++a) {
    CHECK(with_graphs.clips(synthetic::action_vector(a), 12) == exact.clips(synthetic::action_vector(a), 12));
    CHECK(with_graphs.moments(synthetic::action_vector(a), 3) == exact.moments(synthetic::action_vector(a), 3));
  }

  CHECK(ml::motion_graphs(index, 1, {}, &file) == ml::motion_graphs(index, 1));  // nothing new: the graphs as they are
  index.add(synthetic::acted_clip("new.bvh", {{2, 40}}, index.model()));
  Index least = 1000, most = 0;  // of the vectors that are there when one is put in
  auto watch = [&](Index done, Index total) {
    least = std::min(least, done), most = std::max(most, total);
    return true;
  };
  const auto longer = ml::motion_graphs(index, 1, watch, &file);
  CHECK(least == 12);
  CHECK(most == std::ssize(index.moments()));
  ml::write_motion_index(folder / "longer", index, longer);
  const auto added = ml::MotionIndexFile::open(folder / "longer");
  CHECK(ml::open_motion_search(added).clips(synthetic::action_vector(2), 13) ==
        ml::open_motion_search(added, true).clips(synthetic::action_vector(2), 13));
  index.remove_if([](const auto& c) { return c.path == "0.bvh"; });
  least = 1000;
  ml::motion_graphs(index, 1, watch, &added);
  CHECK(least == 0);  // made anew
}

#endif
