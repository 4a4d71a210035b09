// SPDX-License-Identifier: MIT
// Bodies of conv1d.hpp.
#pragma once

#include <motionlang/nn/conv1d.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Index conv1d_length(Index n, Index kernel, const Conv1dOptions& o) {
  if (kernel < 1 || o.stride < 1 || o.padding < 0 || o.dilation < 1) {
    raise<config_error>(101, "conv1d: kernel ", kernel, ", stride ", o.stride, ", padding ", o.padding, ", dilation ",
                        o.dilation);
  }
  const Index last = n + 2 * o.padding - o.dilation * (kernel - 1) - 1;
  if (last < 0) {
    raise<shape_error>(205, "conv1d: a sequence of ", n, " rows with padding ", o.padding, " is shorter than kernel ",
                       kernel, " with dilation ", o.dilation);
  }
  return last / o.stride + 1;
}

MOTIONLANG_NAMESPACE_END
