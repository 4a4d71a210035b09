// SPDX-License-Identifier: MIT
/// One call for a search: the clips, moments or captions of an index that are nearest to a vector.
///
///     const MotionIndexFile index = MotionIndexFile::open("moves.index");
///     for (const MotionHit& hit : search(index, tmr.encode_text("a person jumps"), {.top = 10}))
///       use(clip_of(index.index(), hit).path, hit.start, hit.end);
///
/// For many queries, open_motion_search (search/vector_graph.hpp) is opened once.
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
  Index top = 10;  // how many
  SearchFor what = SearchFor::clips;
  double most_overlap = 0.3;                   // of two moments of one clip, intersection over union: more is one hit
  bool exact = false;                          // compare with all vectors, even where the index has a graph
  ScanStorage storage = ScanStorage::float32;  // of vectors that are all compared; has no influence on the answers
};

/// Best first. Throws config_error 101 for top < 0, 102 for moments of an index without any, numeric_error 301, 302 for
/// a query that is not finite or of length 0, shape_error 205 for one of another width.
std::vector<MotionHit> search(const MotionSearch& index, std::span<const float> query,
                              const SearchOptions& options = {});
/// Opens the search of an index for one query. Throws io_error 401, 402, 403 besides.
std::vector<MotionHit> search(const MotionIndexFile& index, std::span<const float> query,
                              const SearchOptions& options = {});

/// The clip of a hit.
inline const IndexedClip& clip_of(const MotionIndex& index, const MotionHit& hit) {
  return index.clips()[static_cast<std::size_t>(hit.clip)];
}
/// The cosine of a hit as a score from 0 to 1.
inline double score_of(const MotionHit& hit) { return (static_cast<double>(hit.score) + 1) / 2; }
/// How many of its clips, moments or captions an index compares with a query.
Index gallery_size(const MotionIndex& index, SearchFor what);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/search.ipp>
#endif
