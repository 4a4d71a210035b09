// SPDX-License-Identifier: MIT
// Bodies of search.hpp.
#pragma once

#include <motionlang/search/search.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<MotionHit> search(const MotionSearch& index, std::span<const float> query,
                                              const SearchOptions& options) {
  switch (options.what) {
    case SearchFor::moments:
      return index.moments(query, options.top, options.most_overlap);
    case SearchFor::captions:
      return index.captions(query, options.top);
    case SearchFor::clips:
      break;
  }
  return index.clips(query, options.top);
}

MOTIONLANG_BODY std::vector<MotionHit> search(const MotionIndexFile& index, std::span<const float> query,
                                              const SearchOptions& options) {
  return search(open_motion_search(index, options.exact, options.storage), query, options);
}

MOTIONLANG_BODY Index gallery_size(const IndexTables& index, SearchFor what) {
  switch (what) {
    case SearchFor::moments:
      return index.moment_count();
    case SearchFor::captions:
      return index.caption_count();
    case SearchFor::clips:
      break;
  }
  return index.clip_count();
}

MOTIONLANG_NAMESPACE_END
