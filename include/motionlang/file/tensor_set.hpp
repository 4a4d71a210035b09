// SPDX-License-Identifier: MIT
/// Named tensors of a file: what every reader of weights gives, and what modules are filled from.
#pragma once

#include <algorithm>  // lower_bound
#include <memory>     // owner of the bytes

#include <motionlang/file/key_report.hpp>
#include <motionlang/file/tensor_view.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class TensorSet {
 public:
  /// Of the file, for messages.
  const std::string& name() const { return name_; }
  /// Keeps the bytes of all tensors alive.
  const std::shared_ptr<const void>& owner() const { return owner_; }

  /// All tensors, sorted by name.
  std::span<const TensorView> tensors() const { return tensors_; }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const TensorView& t : tensors_) out.push_back(t.name);
    return out;
  }
  /// Null if there is none of that name.
  const TensorView* find(std::string_view tensor) const {
    const auto t = std::lower_bound(tensors_.begin(), tensors_.end(), tensor,
                                    [](const TensorView& a, std::string_view b) { return a.name < b; });
    return t != tensors_.end() && t->name == tensor ? &*t : nullptr;
  }
  /// Throws io_error 406 if there is none of that name, with the most similar one.
  const TensorView& tensor(std::string_view tensor) const {
    const TensorView* t = find(tensor);
    if (t != nullptr) return *t;
    const std::string like = nearest_name(tensor, names());
    raise<io_error>(406, name_, ": no tensor '", tensor, "' among ", tensors_.size(),
                    like.empty() ? "" : concat_text("; the file has '", like, "'"));
  }

 protected:
  TensorSet(std::string name, std::shared_ptr<const void> owner) : name_(std::move(name)), owner_(std::move(owner)) {}

  std::string name_;
  std::shared_ptr<const void> owner_;
  std::vector<TensorView> tensors_;
};

MOTIONLANG_NAMESPACE_END
