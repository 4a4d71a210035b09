// SPDX-License-Identifier: MIT
/// A row of a timeline as pictures show it: a text, when it holds, and for which parts of the body.
#pragma once

#include <string>  // text
#include <vector>  // parts

#include <motionlang/version.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

struct Track {
  std::string text;
  double start = 0, end = 0;         // seconds
  std::vector<std::string> parts{};  // names as in body_part_names; empty: the whole body
};

}  // namespace motionlang::inline MOTIONLANG_ABI
