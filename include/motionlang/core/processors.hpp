// SPDX-License-Identifier: MIT
/// How many threads pay for this process: the processors that it may run on, and no more than the processor time that
/// its control group is given (containers, batch systems). More would spend the group's time with waiting for each
/// other, and then all are stopped.
#pragma once

#include <string>  // paths

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Linux' control groups, version 2 and, where they are counted there, 1: `processes` says which group this process
/// belongs to, the folders of `root` what it is given. What cannot be read is not a limit.
struct ControlGroups {
  std::string root = "/sys/fs/cgroup", processes = "/proc/self/cgroup";

  /// The smallest limit of the groups that this process is in, in processors, rounded up; at most `all`.
  int processors(int all) const;

 private:
  template <class F>
  static void for_lines(const std::string& path, const F& f);
  /// "quota period", both in microseconds, in one file or in two. A quota of "max" or -1 is none.
  static int limit(const std::string& quota_file, const std::string& period_file, int all);
};

}  // namespace detail

/// At least 1.
int processor_count();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/processors.ipp>
#endif
