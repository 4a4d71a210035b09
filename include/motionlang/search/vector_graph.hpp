// SPDX-License-Identifier: MIT
/// Approximate search over many vectors with hnswlib, if its header is installed (Debian: libhnswlib-dev). It finds
/// most of the nearest, in time that grows with the logarithm of the gallery. Without hnswlib, which needs exceptions,
/// every search is exact.
///
///     auto graphs = motion_graphs(index, 100'000);                       // for galleries of this many vectors or more
///     write_motion_index("moves.index", index, graphs);
///     const MotionIndexFile file = MotionIndexFile::open("moves.index");
///     const MotionSearch search = open_motion_search(file);              // with the graphs that the file has
///     // The graphs again, extended by the added vectors.
///     graphs = motion_graphs(more, 100'000, {}, &file);
///
/// The graph holds numbers of vectors, not the vectors. These are read from the index file.
///
/// Source  Malkov and Yashunin, "Efficient and robust approximate nearest neighbor search using hierarchical navigable
///         small world graphs" (TPAMI 2020)
#pragma once

#include <motionlang/core/progress.hpp>
#include <motionlang/search/motion_index_file.hpp>
#include <motionlang/search/motion_search.hpp>

#if __has_include(<hnswlib/hnswlib.h>) && defined(__cpp_exceptions)
#define MOTIONLANG_HAS_HNSWLIB 1
#else
#define MOTIONLANG_HAS_HNSWLIB 0
#endif

MOTIONLANG_NAMESPACE_BEGIN

#if MOTIONLANG_HAS_HNSWLIB

struct VectorGraphOptions {
  Index links = 16;    // of a vector, on all levels above the lowest
  Index effort = 200;  // candidates to consider when a vector is added
};

namespace detail {
class GraphSpace;
class HnswGraph;
}  // namespace detail

class VectorGraph : public VectorSearch {
 public:
  /// rows      (count, width) of length 1, which must outlive the object unless an owner keeps them
  /// progress  is called with the number of vectors in the graph
  /// Vectors are added one after the other, so that the same rows always give the same graph.
  static VectorGraph build(std::span<const float> rows, Index width, const VectorGraphOptions& options = {},
                           Progress progress = {}, std::shared_ptr<const void> owner = {});
  /// A graph that was built for these rows. Throws io_error 401, 402, 403, config_error 101.
  static VectorGraph from_bytes(std::span<const std::byte> bytes, std::span<const float> rows, Index width,
                                const std::string& name = "graph", std::shared_ptr<const void> owner = {});
  /// A graph that was built for the first `known` of these rows, extended by the others. It differs from the graph that
  /// build() makes of all, but finds as many. Throws io_error 401, 402, 403, config_error 101.
  static VectorGraph extended(std::span<const std::byte> bytes, Index known, std::span<const float> rows, Index width,
                              Progress progress = {}, const std::string& name = "graph",
                              std::shared_ptr<const void> owner = {});
  VectorGraph(VectorGraph&&) noexcept;
  VectorGraph& operator=(VectorGraph&&) noexcept;
  ~VectorGraph() override;
  std::vector<std::byte> bytes() const;

  Index count() const override { return std::ssize(rows_) / width_; }
  Index width() const override { return width_; }
  std::vector<std::vector<Neighbour>> search(std::span<const float> queries, Index k) const override;

 private:
  VectorGraph(std::span<const float> rows, Index width, std::shared_ptr<const void> owner);
  void add_from(Index first, Progress progress);

  std::span<const float> rows_;
  Index width_;
  std::shared_ptr<const void> owner_;
  std::unique_ptr<detail::GraphSpace> space_;
  std::unique_ptr<detail::HnswGraph> graph_;
};

#endif

namespace detail {

/// Rows of an index that can have a graph, and its name in the file.
struct GraphRows {
  const char* name;
  std::span<const float> rows;
};
/// Those with `least` rows or more.
std::vector<GraphRows> graph_rows(const MotionIndex& index, Index least);

}  // namespace detail

/// True if the file has the graphs that motion_graphs would make.
bool has_graphs(const MotionIndexFile& file, Index least);

/// Graphs for the clips and the moments of an index, if there are at least `least` of them; none without hnswlib. If
/// the rows of `before` are the first of these, its graph is extended by the others. Throws io_error 401, 402, 403.
IndexExtras motion_graphs(const MotionIndex& index, Index least, Progress progress = {},
                          const MotionIndexFile* before = nullptr);

/// Searches with the graphs in the file. Without graphs it scans with `storage`. The file must outlive it. Throws
/// io_error 401, 402, 403.
MotionSearch open_motion_search(const MotionIndexFile& file, bool exact = false,
                                ScanStorage storage = ScanStorage::float32);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/vector_graph.ipp>
#endif
