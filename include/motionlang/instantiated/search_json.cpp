// SPDX-License-Identifier: MIT
// Bodies of the headers in search/ that need nlohmann_json, or others that do, compiled once for motionlang::instantiated.
#include <motionlang/search/motion_index_file.ipp>
#include <motionlang/search/vector_graph.ipp>
