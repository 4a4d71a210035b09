// SPDX-License-Identifier: MIT
// Bodies of the headers in search/ that need nlohmann_json, themselves or through others, compiled once.
#include <motionlang/search/index_folder.ipp>
#include <motionlang/search/index_shards.ipp>
#include <motionlang/search/kept_index.ipp>
#include <motionlang/search/motion_index_file.ipp>
#include <motionlang/search/query_bench.ipp>
#include <motionlang/search/search.ipp>
#include <motionlang/search/searched_folder.ipp>
#include <motionlang/search/text_answer.ipp>
#include <motionlang/search/vector_graph.ipp>
