// SPDX-License-Identifier: MIT
/// The number of useful threads: the processors on which this process may run, limited by the processor time of its
/// control group (containers, batch systems). More threads would waste the group's time by waiting for each other, and
/// the system would then stop all of them.
#pragma once

#include <string>  // paths

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Linux' control groups, version 2, and version 1 where it does the counting. The file `processes` names the group of
/// this process, and the folders of `root` hold its limits. A file that cannot be read sets no limit.
struct ControlGroups {
  std::string root = "/sys/fs/cgroup", processes = "/proc/self/cgroup";

  /// The smallest limit of the groups that this process is in, in processors, rounded up; at most `all`.
  int processors(int all) const;

 private:
  template <class F>
  static void for_lines(const std::string& path, const F& f);
  /// "quota period", both in microseconds, in one file or in two. A quota of "max" or -1 is unlimited.
  static int limit(const std::string& quota_file, const std::string& period_file, int all);
};

}  // namespace detail

/// The number of useful threads, at least 1.
int processor_count();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/processors.ipp>
#endif
