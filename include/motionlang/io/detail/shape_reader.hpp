// SPDX-License-Identifier: MIT
/// Models from published checkpoints: sizes from the shapes of tensors, and loading where a file holds more than the model.
#pragma once

#include <motionlang/io/module_file.hpp>

namespace motionlang::inline MOTIONLANG_ABI::detail {

/// What shapes say about a model of transformers.
class ShapeReader {
 public:
  explicit ShapeReader(const TensorSet& file) : file_(&file) {}

  bool has(const std::string& name) const { return file_->find(name) != nullptr; }
  /// Size of a matrix along an axis.
  Index size(const std::string& name, int axis) const {
    const TensorView& t = file_->tensor(name);
    if (t.shape.rank() != 2 || t.shape.count() == 0)
      raise<io_error>(407, file_->name(), ": tensor '", name, "' is ", t.shape, ", not a matrix");
    return t.shape[axis];
  }
  Index layers(const std::string& stack) const { return count(stack + ".layers.", ".linear1.weight"); }
  /// Tensors whose names have 0, 1, 2, ... between these parts.
  Index count(const std::string& before, const std::string& behind = "") const {
    Index n = 0;
    while (has(before + std::to_string(n) + behind)) ++n;
    return n;
  }

 private:
  const TensorSet* file_;
};

/// Fills a module; names for which `beside` holds may be there.
template <Module M, class F>
void load_with_company(M& module, const TensorSet& file, F beside) {
  KeyReport report = load_module_partly(module, file);
  std::erase_if(report.unexpected, beside);
  if (!report.missing.empty() || !report.unexpected.empty()) raise_key_mismatch(file.name(), report);
}

}  // namespace motionlang::inline MOTIONLANG_ABI::detail
