// SPDX-License-Identifier: MIT
// Bodies of the headers in search/, compiled once for motionlang::instantiated.
#include <motionlang/search/motion_index.ipp>
#include <motionlang/search/motion_search.ipp>
#include <motionlang/search/search_encoder.ipp>
#include <motionlang/search/text_similarity.ipp>
#include <motionlang/search/unit_rows.ipp>
#include <motionlang/search/vector_scan.ipp>
