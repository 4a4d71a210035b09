// SPDX-License-Identifier: MIT
// Bodies of tensor_memory.hpp.
#pragma once

#include <motionlang/file/tensor_memory.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void TensorMemory::spend(std::uint64_t bytes) {
  if (bytes > left_) {
    raise<io_error>(405, name_, ": needs ", counted(bytes, "byte"), " more than a file of its size justifies");
  }
  left_ -= bytes;
}

MOTIONLANG_NAMESPACE_END
