// SPDX-License-Identifier: MIT
// Bodies of processors.hpp.
#pragma once

#include <algorithm>  // clamp
#include <cmath>      // ceil
#include <cstddef>    // size_t
#include <cstdio>     // fopen
#include <thread>     // hardware_concurrency

#include <motionlang/core/processors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <class F>
void ControlGroups::for_lines(const std::string& path, const F& f) {
  std::FILE* const file = std::fopen(path.c_str(), "r");  // NOLINT(android-cloexec-fopen): C has no mode "e"
  if (file == nullptr) return;
  char text[4096];
  while (std::fgets(text, sizeof text, file) != nullptr) {
    std::string line(text);
    if (line.ends_with('\n')) line.pop_back();
    f(line);
  }
  std::fclose(file);
}

MOTIONLANG_BODY int ControlGroups::processors(int all) const {
  int least = all;
  for_lines(processes, [&](const std::string& line) {  // number:controllers:path
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) return;
    std::string controllers = line.substr(first, second - first + 1);
    controllers.front() = controllers.back() = ',';
    const bool second_version = controllers == ",,";
    if (!second_version && controllers.find(",cpu,") == std::string::npos) return;
    // The group and its parents.
    for (std::string path = line.substr(second + 1);; path.resize(path.rfind('/'))) {
      if (path.ends_with('/')) path.pop_back();
      const std::string folder = root + (second_version ? "" : "/cpu") + path;
      least = std::min(least, second_version ? limit(folder + "/cpu.max", "", all)
                                             : limit(folder + "/cpu.cfs_quota_us", folder + "/cpu.cfs_period_us", all));
      if (path.find('/') == std::string::npos) break;
    }
  });
  return least;
}

MOTIONLANG_BODY int ControlGroups::limit(const std::string& quota_file, const std::string& period_file, int all) {
  double quota = 0, period = 0;
  // NOLINTBEGIN(cert-err34-c): what is not a number stays 0, which is not a limit
  for_lines(quota_file, [&](const std::string& line) { std::sscanf(line.c_str(), "%lf %lf", &quota, &period); });
  if (!period_file.empty())
    for_lines(period_file, [&](const std::string& line) { std::sscanf(line.c_str(), "%lf", &period); });
  // NOLINTEND(cert-err34-c)
  return quota > 0 && period > 0 ? static_cast<int>(std::clamp(std::ceil(quota / period), 1.0, 1.0 * all)) : all;
}

}  // namespace detail

MOTIONLANG_BODY int processor_count() {
  const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
#if defined(__linux__)
  return detail::ControlGroups().processors(all);
#else
  return all;
#endif
}

MOTIONLANG_NAMESPACE_END
