// SPDX-License-Identifier: MIT
/// Dense row-major storage: the tensor type of the reference, Eigen and xtensor backends.
///
/// A handle to a shared buffer plus a shape. Copying shares memory; check `unique()` before writing.
/// Always contiguous: reshaping and taking leading rows give views, everything else copies.
#pragma once

#include <algorithm>  // copy, fill
#include <span>       // values
#include <utility>    // exchange

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
class Dense {
 public:
  /// No tensor yet: the shape (0).
  Dense() = default;
  /// Uninitialised.
  explicit Dense(const Shape& shape) : buffer_(static_cast<std::size_t>(shape.count()) * sizeof(S)), shape_(shape) {}
  /// Values that somebody else owns and that do not change (a mapped file).
  Dense(const S* values, const Shape& shape, std::shared_ptr<const void> owner)
      : buffer_(values, std::move(owner)), shape_(shape) {}

  Dense(const Dense&) = default;
  Dense& operator=(const Dense&) = default;
  /// A moved-from tensor holds nothing.
  Dense(Dense&& o) noexcept
      : buffer_(std::move(o.buffer_)), shape_(std::exchange(o.shape_, nothing)), offset_(std::exchange(o.offset_, 0)) {}
  Dense& operator=(Dense&& o) noexcept {
    buffer_ = std::move(o.buffer_);
    shape_ = std::exchange(o.shape_, nothing);
    offset_ = std::exchange(o.offset_, 0);
    return *this;
  }
  ~Dense() = default;

  static Dense full(const Shape& shape, S value) {
    Dense d(shape);
    std::fill_n(d.data(), d.count(), value);
    return d;
  }
  static Dense from_span(std::span<const S> values, const Shape& shape) {
    Dense d(shape);
    std::copy(values.begin(), values.end(), d.data());
    return d;
  }

  const Shape& shape() const MOTIONLANG_LIFETIMEBOUND { return shape_; }
  Index count() const { return shape_.count(); }
  const S* data() const MOTIONLANG_LIFETIMEBOUND { return static_cast<const S*>(buffer_.data()) + offset_; }
  /// For writing, only right after construction or if `unique()`.
  S* data() MOTIONLANG_LIFETIMEBOUND { return static_cast<S*>(buffer_.data()) + offset_; }
  std::span<const S> span() const MOTIONLANG_LIFETIMEBOUND { return {data(), static_cast<std::size_t>(count())}; }
  /// True if there is a tensor, perhaps an empty one. False before it is made, and after a move.
  bool defined() const { return static_cast<bool>(buffer_); }

  /// True if no other handle sees the values, so that an operation may overwrite them.
  bool unique() const { return buffer_.unique() && !buffer_.packed(); }

  /// The same values in another shape of the same count.
  Dense reshaped(const Shape& shape) const {
    Dense d(*this);
    d.shape_ = shape;
    return d;
  }
  /// The leading indices first ... last-1, without copying.
  Dense rows(Index first, Index last) const {
    Dense d(*this);
    d.offset_ += first * shape_.count(1, shape_.rank());
    d.shape_[0] = last - first;
    return d;
  }

  /// Attaches the same values in the layout of a kernel. They live as long as the buffer.
  void attach(std::shared_ptr<const void> packed) const { buffer_.packed() = std::move(packed); }
  const void* attached() const { return buffer_ && offset_ == 0 ? buffer_.packed().get() : nullptr; }

 private:
  static constexpr Shape nothing{0};

  detail::BufferHandle buffer_;
  Shape shape_ = nothing;
  Index offset_ = 0;
};

MOTIONLANG_NAMESPACE_END
