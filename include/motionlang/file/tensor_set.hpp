// SPDX-License-Identifier: MIT
/// Named tensors of a file: the result of every reader of weights, and the source from which modules are filled.
#pragma once

#include <memory>  // owner of the bytes

#include <motionlang/file/key_report.hpp>
#include <motionlang/file/tensor_view.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class TensorSet {
 public:
  /// The name of the file, for messages.
  const std::string& name() const { return name_; }
  /// Keeps the bytes of all tensors alive.
  const std::shared_ptr<const void>& owner() const { return owner_; }

  /// All tensors, sorted by name.
  std::span<const TensorView> tensors() const { return tensors_; }
  std::vector<std::string> names() const;
  /// Null if no tensor has that name.
  const TensorView* find(std::string_view tensor) const;
  /// Throws io_error 406, with the most similar name, if no tensor has that name.
  const TensorView& tensor(std::string_view tensor) const;

 protected:
  TensorSet(std::string name, std::shared_ptr<const void> owner) : name_(std::move(name)), owner_(std::move(owner)) {}

  std::string name_;
  std::shared_ptr<const void> owner_;
  std::vector<TensorView> tensors_;
};

/// A checksum of names, types, shapes and bytes of tensors in any order, in hexadecimal. Equal weights have equal
/// checksums.
std::string tensors_checksum(std::span<const TensorView> tensors);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/tensor_set.ipp>
#endif
