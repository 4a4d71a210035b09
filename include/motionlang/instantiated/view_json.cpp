// SPDX-License-Identifier: MIT
// Bodies of the headers in view/ that need nlohmann/json.hpp, compiled once for motionlang::instantiated.
#include <motionlang/view/view_file.ipp>
#include <motionlang/view/viewer.ipp>
