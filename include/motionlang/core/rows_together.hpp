// SPDX-License-Identifier: MIT
/// How many rows belong together that are multiplied a few at a time.
#pragma once

#include <motionlang/core/shape.hpp>
#include <motionlang/core/thread_object.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// While it lives, products of this thread count as parts of one of this many rows (0: each as what it is), unless
/// another lives already. In bf16x3 the instructions depend on the number of rows, and with them the last digit: where
/// that must not depend on how rows are shared by threads, or on what else is in a batch, say so by this. As `many`, a
/// product of a few rows takes up to four times as long. Threads that help need one of
/// their own (for_products, in_groups).
class RowsTogether {
 public:
  static constexpr Index few = 1, many = 1 << 20;

  explicit RowsTogether(Index rows) : before_(counted()) {
    if (before_ == 0) counted() = rows;
  }
  ~RowsTogether() { counted() = before_; }
  RowsTogether(const RowsTogether&) = delete;
  RowsTogether& operator=(const RowsTogether&) = delete;

  /// 0: none lives.
  static Index count() { return counted(); }

 private:
  struct Count {
    Index rows = 0;
  };
  static Index& counted() { return thread_object<Count, RowsTogether>().rows; }

  Index before_;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
