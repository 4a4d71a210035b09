// SPDX-License-Identifier: MIT
// Bodies of vector_graph.hpp.
#pragma once

#include <algorithm>  // equal
#include <cmath>      // log
#include <cstring>    // memcpy

#include <motionlang/core/parallel.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/system_file.hpp>
#include <motionlang/search/unit_rows.hpp>
#include <motionlang/search/vector_graph.hpp>

#if MOTIONLANG_HAS_HNSWLIB
#ifndef NO_MANUAL_VECTORIZATION
// Distances are ours: those of hnswlib bring functions that two translation units must not both define.
#define NO_MANUAL_VECTORIZATION
#endif
#include <hnswlib/hnswlib.h>
#endif

MOTIONLANG_NAMESPACE_BEGIN

#if MOTIONLANG_HAS_HNSWLIB

namespace detail {

/// A vector in the form of hnswlib: the number of a row, or -1 and the vector of a query.
struct GraphPoint {
  std::int64_t row = -1;
  const float* vector = nullptr;
};

/// 1 - cosine between points. hnswlib keeps a pointer to this object.
class GraphSpace : public hnswlib::SpaceInterface<float> {
 public:
  GraphSpace(const float* rows, Index width) : rows_(rows), width_(width), dot_(RowScan<float>::dot_function()) {}
  GraphSpace(const GraphSpace&) = delete;
  GraphSpace& operator=(const GraphSpace&) = delete;

  std::size_t get_data_size() override { return sizeof(std::int64_t); }
  hnswlib::DISTFUNC<float> get_dist_func() override { return &distance; }
  void* get_dist_func_param() override { return this; }

 private:
  const float* vector_of(const void* point) const {
    std::int64_t row;
    std::memcpy(&row, point, sizeof row);
    return row >= 0 ? rows_ + row * width_ : static_cast<const GraphPoint*>(point)->vector;
  }
  static float distance(const void* a, const void* b, const void* space) {
    const auto& self = *static_cast<const GraphSpace*>(space);
    float cosine = 0;
    self.dot_(self.vector_of(a), 1, self.width_, self.vector_of(b), &cosine);
    return 1 - cosine;
  }

  const float* rows_;
  Index width_;
  decltype(RowScan<float>::dot_function()) dot_;
};

class HnswGraph : public hnswlib::HierarchicalNSW<float> {
 public:
  using hnswlib::HierarchicalNSW<float>::HierarchicalNSW;
};

/// Checks every link of a saved graph, so that hnswlib can follow it without checks. Throws io_error 402, 403.
inline void check_graph(std::span<const std::byte> bytes, Index vectors, const std::string& name) {
  struct Header {
    std::uint64_t offset_level0, capacity, count, element, label_offset, data_offset;
    std::int32_t top;
    std::uint32_t entry;
    std::uint64_t links, links0, m;
    double mult;
    std::uint64_t effort;
  };
  const auto wrong = [&](const char* what) { raise<io_error>(403, name, ": a graph with ", what); };
  const auto h = load<Header>(bytes, 0, name, "the header of a graph");
  constexpr std::uint64_t id = sizeof(std::uint32_t), most_links = 10000;
  const auto n = static_cast<std::uint64_t>(vectors);
  if (h.count != n || h.capacity != n) wrong("another number of vectors");
  if (h.links < 1 || h.links > most_links || h.links0 != 2 * h.links || h.m != h.links) wrong("wrong numbers of links");
  const std::uint64_t lowest = id + h.links0 * id, upper = id + h.links * id;
  if (h.effort < h.m || !(std::abs(h.mult * std::log(static_cast<double>(h.m)) - 1) < 1e-6)) wrong("a wrong effort");
  if (h.offset_level0 != 0 || h.data_offset != lowest || h.label_offset != lowest + 8 || h.element != lowest + 16)
    wrong("wrong sizes");
  const std::size_t base = sizeof(Header);
  slice(bytes, base, static_cast<std::size_t>(n * h.element), name, "a graph");
  std::vector<std::size_t> place;    // of the upper levels of each vector
  std::vector<std::uint64_t> level;  // of each vector
  std::size_t at = base + static_cast<std::size_t>(n * h.element);
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto size = load<std::uint32_t>(bytes, at, name, "a graph");
    place.push_back(at + id), level.push_back(size / upper);
    if (size % upper != 0 || level.back() > 1000) wrong("a list of links of a wrong size");
    slice(bytes, at + id, size, name, "a graph");
    at += id + size;
  }
  if (at != bytes.size()) wrong("something behind its end");
  if (n > 0 && (h.entry >= n || h.top < 0 || level[h.entry] != static_cast<std::uint64_t>(h.top)))
    wrong("a wrong beginning");
  const auto check_links = [&](std::size_t list, std::uint64_t most, std::uint64_t on_level) {
    const auto count = load<std::uint32_t>(bytes, list, name, "a graph");
    if (count > most) wrong("too many links");
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto to = load<std::uint32_t>(bytes, list + id + k * id, name, "a graph");
      if (to >= n || level[to] < on_level) wrong("a link to nowhere");
    }
  };
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto element = base + static_cast<std::size_t>(i * h.element);
    check_links(element, h.links0, 0);
    const auto row = load<std::int64_t>(bytes, element + static_cast<std::size_t>(h.data_offset), name, "a graph");
    const auto label = load<std::int64_t>(bytes, element + static_cast<std::size_t>(h.label_offset), name, "a graph");
    if (row < 0 || row >= vectors || label != row) wrong("an unknown vector");
    for (std::uint64_t l = 0; l < level[i]; ++l)
      check_links(place[i] + static_cast<std::size_t>(l * upper), h.links, l + 1);
  }
}

/// A file that only we see, for a library that only reads and writes files.
class ScratchFile {
 public:
  ScratchFile() {
    const int file = system::create_temporary(path_);
    if (file < 0) raise<io_error>(401, "cannot make ", path_, ": ", std::strerror(errno));
    ::close(file);
  }
  ~ScratchFile() { std::remove(path_.c_str()); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace detail

MOTIONLANG_BODY VectorGraph VectorGraph::build(std::span<const float> rows, Index width,
                                               const VectorGraphOptions& options, Progress progress,
                                               std::shared_ptr<const void> owner) {
  VectorGraph g(rows, width, std::move(owner));
  g.graph_ = std::make_unique<detail::HnswGraph>(
      g.space_.get(), static_cast<std::size_t>(std::max<Index>(1, g.count())), static_cast<std::size_t>(options.links),
      static_cast<std::size_t>(options.effort));
  g.add_from(0, progress);
  return g;
}

MOTIONLANG_BODY VectorGraph VectorGraph::from_bytes(std::span<const std::byte> bytes, std::span<const float> rows,
                                                    Index width, const std::string& name,
                                                    std::shared_ptr<const void> owner) {
  return extended(bytes, detail::whole_rows("VectorGraph", rows.size(), width), rows, width, {}, name,
                  std::move(owner));
}

MOTIONLANG_BODY VectorGraph VectorGraph::extended(std::span<const std::byte> bytes, Index known,
                                                  std::span<const float> rows, Index width, Progress progress,
                                                  const std::string& name, std::shared_ptr<const void> owner) {
  VectorGraph g(rows, width, std::move(owner));
  if (known > g.count()) raise<config_error>(101, name, ": a graph of ", counted(known, "vector"), " for ", g.count());
  detail::check_graph(bytes, known, name);
  const detail::ScratchFile file;
  write_file(file.path(), bytes);
  detail::guard<std::exception>(
      [&] {
        g.graph_ = std::make_unique<detail::HnswGraph>(g.space_.get(), file.path(), false,
                                                       static_cast<std::size_t>(g.count()));
      },
      [&](const std::exception& e) -> bool { raise<io_error>(403, name, ": ", e.what()); });
  g.graph_->num_deleted_ = 0;  // hnswlib does not set it
  // otherwise every addition draws the same levels
  g.graph_->level_generator_.seed(static_cast<std::uint32_t>(known + 1));
  g.add_from(known, progress);
  return g;
}

MOTIONLANG_BODY VectorGraph::VectorGraph(VectorGraph&&) noexcept = default;
MOTIONLANG_BODY VectorGraph& VectorGraph::operator=(VectorGraph&&) noexcept = default;
MOTIONLANG_BODY VectorGraph::~VectorGraph() = default;

MOTIONLANG_BODY std::vector<std::byte> VectorGraph::bytes() const {
  const detail::ScratchFile file;
  graph_->saveIndex(file.path());
  const auto mapped = MappedFile::open(file.path());
  return {mapped->bytes().begin(), mapped->bytes().end()};
}

MOTIONLANG_BODY std::vector<std::vector<Neighbour>> VectorGraph::search(std::span<const float> queries, Index k) const {
  if (k < 0) raise<config_error>(101, "VectorGraph: the ", k, " nearest");
  const Index n = detail::whole_rows("VectorGraph: queries", queries.size(), width_);
  const std::vector<float> units = unit_rows(queries, width_);
  std::vector<std::vector<Neighbour>> out(static_cast<std::size_t>(n));
  k = std::min(k, count());
  if (k == 0) return out;
  // hnswlib follows as many candidates as wanted.
  const auto candidates = static_cast<std::size_t>(std::max<Index>(100, 2 * k));
  parallel_for(n, [&](Index q) {
    const float* query = units.data() + q * width_;
    const detail::GraphPoint point{-1, query};
    NearestK best(k);
    for (auto found = graph_->searchKnn(&point, candidates); !found.empty(); found.pop()) {
      const auto row = static_cast<Index>(found.top().second);
      best.offer({row, exact_cosine(query, rows_.data() + row * width_, width_)});
    }
    out[static_cast<std::size_t>(q)] = best.take();
  });
  return out;
}

MOTIONLANG_BODY VectorGraph::VectorGraph(std::span<const float> rows, Index width, std::shared_ptr<const void> owner)
    : rows_(rows), width_(width), owner_(std::move(owner)) {
  require_unit_rows("VectorGraph", rows, width);
  space_ = std::make_unique<detail::GraphSpace>(rows.data(), width);
}

MOTIONLANG_BODY void VectorGraph::add_from(Index first, Progress progress) {
  for (Index i = first; i < count(); ++i) {
    if ((i - first) % 256 == 0) progress(i, count());
    const detail::GraphPoint point{i};
    graph_->addPoint(&point, static_cast<hnswlib::labeltype>(i));
  }
  progress(count(), count());
}

#endif

MOTIONLANG_BODY std::vector<detail::GraphRows> detail::graph_rows(const MotionIndex& index, Index least) {
  std::vector<GraphRows> out;
  for (const GraphRows& g : {GraphRows{"graph_clips", index.clip_rows()}, {"graph_moments", index.moment_rows()}})
    if (std::ssize(g.rows) / index.model().width >= std::max<Index>(1, least)) out.push_back(g);
  return out;
}

MOTIONLANG_BODY bool has_graphs(const MotionIndexFile& file, Index least) {
  const auto wanted = detail::graph_rows(file.index(), least);
  return std::all_of(wanted.begin(), wanted.end(), [&](const auto& g) { return !file.extra(g.name).empty(); });
}

MOTIONLANG_BODY IndexExtras motion_graphs([[maybe_unused]] const MotionIndex& index, [[maybe_unused]] Index least,
                                          [[maybe_unused]] Progress progress,
                                          [[maybe_unused]] const MotionIndexFile* before) {
  IndexExtras out;
#if MOTIONLANG_HAS_HNSWLIB
  const Index width = index.model().width;
  for (const auto& [name, rows] : detail::graph_rows(index, least)) {
    const auto graph = before != nullptr ? before->extra(name) : std::span<const std::byte>{};
    std::span<const float> known;
    if (!graph.empty()) {
      for (const auto& old : detail::graph_rows(before->index(), 1))
        if (std::string_view(old.name) == name) known = old.rows;
    }
    const bool only_added =
        !known.empty() && known.size() <= rows.size() && std::equal(known.begin(), known.end(), rows.begin());
    out[name] = (only_added ? VectorGraph::extended(graph, std::ssize(known) / width, rows, width, progress,
                                                    before->name() + ": " + name)
                            : VectorGraph::build(rows, width, {}, progress))
                    .bytes();
  }
#endif
  return out;
}

MOTIONLANG_BODY MotionSearch open_motion_search(const MotionIndexFile& file, [[maybe_unused]] bool exact,
                                                ScanStorage storage) {
  std::shared_ptr<const VectorSearch> clips, moments;
#if MOTIONLANG_HAS_HNSWLIB
  const auto graph = [&](const char* name, std::span<const float> rows) -> std::shared_ptr<const VectorSearch> {
    const auto bytes = file.extra(name);
    if (exact || bytes.empty()) return {};
    return std::make_shared<VectorGraph>(
        VectorGraph::from_bytes(bytes, rows, file.index().model().width, file.name() + ": " + name));
  };
  clips = graph("graph_clips", file.index().clip_rows());
  moments = graph("graph_moments", file.index().moment_rows());
#endif
  return MotionSearch(file.index(), std::move(clips), std::move(moments), storage);
}

MOTIONLANG_NAMESPACE_END
