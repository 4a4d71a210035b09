// SPDX-License-Identifier: MIT
// Bodies of init.hpp.
#pragma once

#include <utility>  // exchange

#include <motionlang/core/thread_object.hpp>
#include <motionlang/nn/init.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY ParameterRoom::ParameterRoom(std::string file, Index numbers)
    : file_(std::move(file)), numbers_(numbers), before_(std::exchange(innermost(), this)) {}
MOTIONLANG_BODY ParameterRoom::~ParameterRoom() { innermost() = before_; }

MOTIONLANG_BODY void ParameterRoom::take(const Shape& shape) {
  if (innermost() != nullptr) innermost()->take_numbers(shape);
}

MOTIONLANG_BODY ParameterRoom*& ParameterRoom::innermost() {
  struct Innermost {
    ParameterRoom* room = nullptr;
  };
  return thread_object<Innermost, ParameterRoom>().room;
}

MOTIONLANG_BODY void ParameterRoom::take_numbers(const Shape& shape) {
  double count = 1;  // may be too large for Index
  for (const Index n : shape.sizes()) count *= static_cast<double>(n);
  taken_ += count;
  if (taken_ > 2 * static_cast<double>(numbers_) + (1 << 24))
    raise<config_error>(102, file_, ": ", counted(numbers_, "number"), ", a network of its sizes has at least ", taken_,
                        ", with a tensor ", shape);
}

MOTIONLANG_NAMESPACE_END
