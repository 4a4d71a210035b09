// SPDX-License-Identifier: MIT
/// The memory layout of two operands of a broadcasting operation, reduced to the cases that a vectorised loop can
/// handle.
#pragma once

#include <optional>  // no simple pattern

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The result as a matrix (outer, inner); in each operand an axis is either walked along or repeated.
struct BroadcastPattern {
  struct Operand {
    bool outer = true, inner = true;  // false: repeated
  };
  Index outer = 1, inner = 1;
  Operand a, b;
};

/// The pattern of a and b in the result shape s. Nothing if walked and repeated axes alternate more than once.
inline std::optional<BroadcastPattern> broadcast_pattern(const Shape& a, const Shape& b, const Shape& s) {
  BroadcastPattern p;
  int group = 0;  // 0: inner, 1: outer; from the last axis backwards
  bool started[2] = {false, false};
  for (int i = s.rank() - 1; i >= 0; --i) {
    if (s[i] == 1) continue;
    const int ia = i - (s.rank() - a.rank()), ib = i - (s.rank() - b.rank());
    const bool wa = ia >= 0 && a[ia] != 1, wb = ib >= 0 && b[ib] != 1;
    if (started[group] && (group == 0 ? p.a.inner != wa || p.b.inner != wb : p.a.outer != wa || p.b.outer != wb)) {
      if (++group == 2) return std::nullopt;
    }
    started[group] = true;
    if (group == 0)
      p.a.inner = wa, p.b.inner = wb, p.inner *= s[i];
    else
      p.a.outer = wa, p.b.outer = wb, p.outer *= s[i];
  }
  return p;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
