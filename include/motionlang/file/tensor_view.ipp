// SPDX-License-Identifier: MIT
// Bodies of tensor_view.hpp.
#pragma once

#include <algorithm>  // find

#include <motionlang/file/tensor_view.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string to_string(DType t) { return std::string(info(t).name); }

MOTIONLANG_BODY FileShape::FileShape(const Shape& shape) {
  for (int i = 0; i < shape.rank(); ++i) push_back(shape[i]);
}

MOTIONLANG_BODY FileShape::FileShape(std::span<const Index> sizes) {
  for (const Index n : sizes) push_back(n);
}

MOTIONLANG_BODY Index FileShape::count() const {
  // If one size is 0, the others may have any value.
  if (std::find(sizes_.begin(), sizes_.end(), 0) != sizes_.end()) return 0;
  Index n = 1;
  for (const Index size : sizes_) n *= size;
  return n;
}

MOTIONLANG_BODY void FileShape::push_back(Index n) {
  if (n < 0) raise<shape_error>(205, "FileShape: negative size ", n);
  if (rank() == max_rank) raise<shape_error>(206, "FileShape: more than ", max_rank, " axes");
  sizes_.push_back(n);
}

MOTIONLANG_BODY std::string to_string(const FileShape& s) { return detail::shape_text(s.sizes()); }

MOTIONLANG_NAMESPACE_END
