// SPDX-License-Identifier: MIT
// Bodies of describe_skeleton.hpp.
#pragma once

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/kinematics/describe_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string describe_skeleton(const Skeleton& skeleton) {
  std::string out;
  for (int j = 0; j < skeleton.size(); ++j)
    out += formatted("  %3d %-24s %s\n", j, printable(skeleton.name(j)).c_str(),
                     j == 0 ? "" : printable(skeleton.name(skeleton.parent(j))).c_str());
  return out;
}

MOTIONLANG_NAMESPACE_END
