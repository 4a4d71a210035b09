// SPDX-License-Identifier: MIT
// Bodies of print.hpp.
#pragma once

#include <motionlang/tensor/print.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// Writes numbers axis by axis.
struct ArrayWriter {
  const Shape& shape;
  const void* numbers;
  std::string (*number)(const void*, Index);
  std::string indent;  // of the lines after the first
  bool all;            // nothing is left out
  std::string out{};

  /// The part of the axes axis, axis + 1, ... that begins with value `first`.
  void write(int axis, Index first) {
    if (axis == shape.rank()) {
      out += number(numbers, first);
      return;
    }
    constexpr Index at_ends = 3;
    const Index n = shape[axis], each = shape.count(axis + 1, shape.rank());
    const bool short_axis = all || n <= 2 * at_ends;
    out += '[';
    for (Index i = 0; i < n; ++i) {
      if (i > 0) separate(axis);
      if (!short_axis && i == at_ends) {
        out += "...";
        separate(axis);
        i = n - at_ends;
      }
      write(axis + 1, first + i * each);
    }
    out += ']';
  }
  /// Between two parts of an axis: a blank within a line, else as many line ends as there are axes inside.
  void separate(int axis) {
    const int inside = shape.rank() - 1 - axis;
    out += inside == 0 ? ", " : ",";
    if (inside == 0) return;
    out.append(static_cast<std::size_t>(inside), '\n');
    out += indent;
    out.append(static_cast<std::size_t>(axis) + 1, ' ');
  }
};

MOTIONLANG_BODY std::string array_text(const Shape& shape, const void* numbers,
                                       std::string (*number)(const void*, Index)) {
  std::string out = to_string(shape) + " ";
  ArrayWriter writer{.shape = shape,
                     .numbers = numbers,
                     .number = number,
                     .indent = std::string(out.size(), ' '),
                     .all = shape.count() <= 1000};
  writer.write(0, 0);
  return out + writer.out;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
