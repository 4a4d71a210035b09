// SPDX-License-Identifier: MIT
/// Keeps the bytes of tensors alive, and limits the memory that a file may use: readers of weights ask here before they
/// allocate.
#pragma once

#include <cstdint>  // sizes
#include <deque>    // unpacked bytes: views to them stay valid
#include <memory>   // the file
#include <string>   // name
#include <utility>  // move
#include <vector>   // unpacked bytes

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The file that holds most tensors, and the bytes of tensors that had to be unpacked or reordered.
class TensorMemory {
 public:
  /// file_size   tensors may use this many bytes besides the file itself, plus 12 MiB
  TensorMemory(std::shared_ptr<const void> file, std::uint64_t file_size, std::string name)
      : file_(std::move(file)), name_(std::move(name)), left_(file_size + (std::uint64_t{12} << 20)) {}

  /// Throws io_error 405 if the file has used too much already.
  void spend(std::uint64_t bytes);
  void allow(std::uint64_t more) { left_ += more; }
  /// The bytes that may still be used.
  std::uint64_t left() const { return left_; }

  /// Stores bytes that live as long as this object. They must have been paid for with `spend`.
  template <class T>
  const T& keep(T value) {
    auto kept = std::make_shared<const T>(std::move(value));
    const T& result = *kept;
    kept_.push_back(std::move(kept));
    return result;
  }

 private:
  std::shared_ptr<const void> file_;
  std::string name_;
  std::uint64_t left_;
  std::deque<std::shared_ptr<const void>> kept_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/tensor_memory.ipp>
#endif
