// SPDX-License-Identifier: MIT
// Bodies of amass_releases.hpp.
#pragma once

#include <algorithm>  // min
#include <cstddef>    // places
#include <utility>    // move

#include <motionlang/datasets/amass_releases.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double corrected_amass_fps(std::string_view path, double fps) {
  for (const AmassRate& known : amass_rates) {
    if (path.find(known.path) != path.npos) return known.fps;
  }
  return fps;
}

MOTIONLANG_BODY std::vector<std::string> amass_paths(std::string_view path) {
  auto renamed = [&](std::string_view AmassRename::*from, std::string_view AmassRename::*to) {
    std::string out;
    for (std::size_t at = 0; at <= path.size();) {
      const std::size_t end = std::min(path.find('/', at), path.size());
      std::string_view folder = path.substr(at, end - at);
      for (const AmassRename& r : amass_renames) {
        if (folder == r.*from) {
          folder = r.*to;
          break;
        }
      }
      out += folder;
      if (end < path.size()) out += '/';
      at = end + 1;
    }
    return out;
  };
  std::vector<std::string> out{std::string(path)};
  for (std::string other :
       {renamed(&AmassRename::today, &AmassRename::before), renamed(&AmassRename::before, &AmassRename::today)}) {
    if (other != path) out.push_back(std::move(other));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
