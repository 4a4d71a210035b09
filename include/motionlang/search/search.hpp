// SPDX-License-Identifier: MIT
/// One call for a search: the clips, moments or captions of an index that are nearest to a vector.
///
///     const MotionIndexFile index = MotionIndexFile::open("moves.index");
///     for (const MotionHit& hit : search(index, tmr.encode_text("a person jumps"), {.top = 10}))
///       use(clip_of(index.index(), hit).path, hit.start, hit.end);
///
/// For many queries, open the search once with open_motion_search (search/vector_graph.hpp).
#pragma once

#include <motionlang/search/vector_graph.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The vectors that are compared with the query.
enum class SearchFor {
  clips,    // whole clips
  moments,  // windows of clips
  captions  // the captions of clips, not their motion
};

struct SearchOptions {
  Index top = 10;  // number of results
  SearchFor what = SearchFor::clips;
  double most_overlap = 0.3;  // intersection over union above which two moments of one clip are one hit
  bool exact = false;         // compare with all vectors, even if the index has a graph
  ScanStorage storage = ScanStorage::float32;  // for a comparison with all vectors; does not affect the answers
};

/// Best first. Throws config_error 101 for top < 0, 102 for moments of an index without any, numeric_error 301, 302 for
/// a query that is not finite or of length 0, shape_error 205 for one of another width.
std::vector<MotionHit> search(const MotionSearch& index, std::span<const float> query,
                              const SearchOptions& options = {});
/// Opens the search of an index for one query. Also throws io_error 401, 402, 403.
std::vector<MotionHit> search(const MotionIndexFile& index, std::span<const float> query,
                              const SearchOptions& options = {});

/// The clip of a hit.
inline const IndexedClip& clip_of(const MotionIndex& index, const MotionHit& hit) {
  return index.clips()[static_cast<std::size_t>(hit.clip)];
}
/// The cosine of a hit as a score from 0 to 1.
inline double score_of(const MotionHit& hit) { return (static_cast<double>(hit.score) + 1) / 2; }
/// The number of clips, moments or captions that are compared with a query.
Index gallery_size(const IndexTables& index, SearchFor what);
inline Index gallery_size(const MotionIndex& index, SearchFor what) { return gallery_size(TablesOfIndex(index), what); }

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/search.ipp>
#endif
