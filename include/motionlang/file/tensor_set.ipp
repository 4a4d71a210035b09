// SPDX-License-Identifier: MIT
// Bodies of tensor_set.hpp.
#pragma once

#include <algorithm>  // lower_bound, sort

#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/file/tensor_set.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> TensorSet::names() const {
  std::vector<std::string> out;
  for (const TensorView& t : tensors_) out.push_back(t.name);
  return out;
}

MOTIONLANG_BODY const TensorView* TensorSet::find(std::string_view tensor) const {
  const auto t = std::lower_bound(tensors_.begin(), tensors_.end(), tensor,
                                  [](const TensorView& a, std::string_view b) { return a.name < b; });
  return t != tensors_.end() && t->name == tensor ? &*t : nullptr;
}

MOTIONLANG_BODY const TensorView& TensorSet::tensor(std::string_view tensor) const {
  const TensorView* t = find(tensor);
  if (t != nullptr) return *t;
  const std::string like = nearest_name(tensor, names());
  raise<io_error>(406, name_, ": no tensor '", tensor, "' among ", tensors_.size(),
                  like.empty() ? "" : concat_text("; the file has '", like, "'"));
}

MOTIONLANG_BODY std::string tensors_checksum(std::span<const TensorView> tensors) {
  std::vector<const TensorView*> sorted;
  for (const TensorView& t : tensors) sorted.push_back(&t);
  std::sort(sorted.begin(), sorted.end(), [](const TensorView* a, const TensorView* b) { return a->name < b->name; });
  std::uint64_t hash = 1;
  for (const TensorView* t : sorted) {
    const std::string about = concat_text(t->name, " ", t->dtype, " ", t->shape);
    hash = detail::content_hash(t->bytes, detail::content_hash(std::as_bytes(std::span(about)), hash));
  }
  return detail::hexadecimal(hash);
}

MOTIONLANG_NAMESPACE_END
