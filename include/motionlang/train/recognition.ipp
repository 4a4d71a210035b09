// SPDX-License-Identifier: MIT
// Bodies of recognition.hpp.
#pragma once

#include <motionlang/train/recognition.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::pair<std::vector<Index>, Index> present_classes(std::span<const Index> classes, Index kinds) {
  std::vector<Index> numbered, number(static_cast<std::size_t>(kinds), -1);
  Index present = 0;
  for (const Index y : classes) {
    Index& n = number[static_cast<std::size_t>(y)];
    if (n < 0) n = present++;
    numbered.push_back(n);
  }
  return {numbered, present};
}

MOTIONLANG_NAMESPACE_END
