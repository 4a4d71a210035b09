// SPDX-License-Identifier: MIT
/// Memory of tensors: counted buffers, which are kept for reuse after their last user.
///
/// Fresh pages cost more than the arithmetic that fills them (64 MiB: 26 ms). A loop that repeats the same computation
/// finds all its buffers in the pool from the second round on and takes nothing from the system.
#pragma once

#include <array>        // free lists
#include <atomic>       // reference counts
#include <bit>          // bit_width
#include <cstddef>      // byte
#include <cstdint>      // sizes
#include <cstring>      // memcpy
#include <memory>       // owner of foreign memory
#include <new>          // objects in memory that is there
#include <type_traits>  // is_trivially_copyable
#include <utility>      // exchange

#include <motionlang/core/error.hpp>
#include <motionlang/core/lifetime.hpp>
#include <motionlang/core/thread_object.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Header of a buffer. The data follow it, 64 bytes aligned, or lie elsewhere (memory-mapped weights).
struct alignas(64) Buffer {
  std::atomic<std::int64_t> references{1};
  void* data = nullptr;
  int bucket = -1;                     // -1: not from a pool
  std::uint32_t pool = 0;              // number of the pool that made it
  Buffer* next = nullptr;              // in a free list
  std::shared_ptr<const void> owner;   // keeps foreign memory alive
  std::shared_ptr<const void> packed;  // the same numbers in the layout of a kernel (see Dense::attach)
};

}  // namespace detail

/// Free buffers of this thread, in buckets of four sizes per power of two. A pool keeps only buffers that it made
/// itself, so buffers that one thread makes and another frees do not pile up. After the pool of an ending thread is
/// gone, memory comes from the system and returns to it. The address sanitizer reports uses of a free buffer.
class BufferPool {
 public:
  static BufferPool& local() { return thread_object<BufferPool>(); }

  /// A buffer of at least this many bytes for the calling thread, and the return of one.
  static detail::Buffer* take(std::size_t bytes) {
    const int bucket = bucket_of(bytes);
    return gone_ ? make(bucket, bytes, 0) : local().reuse(bucket, bytes);
  }
  static void give_back(detail::Buffer* b) {
    if (gone_ || b->pool != local().number_) return release(b);
    b->packed.reset();
    if constexpr (detail::address_sanitizer) detail::forbid_access(b->data, bucket_bytes(b->bucket));
    b->next = std::exchange(local().free_[static_cast<std::size_t>(b->bucket)], b);
  }

  /// Returns all free buffers to the system.
  void trim();

  /// The number of requests of this pool to the system. It stays constant in a loop that has settled.
  std::int64_t system_allocations() const { return system_allocations_; }

  static void release(detail::Buffer* b);

  BufferPool(const BufferPool&) = delete;
  BufferPool& operator=(const BufferPool&) = delete;

 private:
  template <class T, class Tag>
  friend T& thread_object();
  BufferPool() = default;
  ~BufferPool();

  detail::Buffer* reuse(int bucket, std::size_t bytes) {
    detail::Buffer*& head = free_[static_cast<std::size_t>(bucket)];
    if (head != nullptr) {
      detail::Buffer* b = std::exchange(head, head->next);
      b->references.store(1, std::memory_order_relaxed);
      if constexpr (detail::address_sanitizer) detail::allow_access(b->data, bucket_bytes(bucket));
      return b;
    }
    ++system_allocations_;
    return make(bucket, bytes, number_);
  }
  static detail::Buffer* make(int bucket, std::size_t bytes, std::uint32_t pool);

  // Sizes 64 * {4, 5, 6, 7} * 2^k: at most a quarter of a buffer is unused.
  static int bucket_of(std::size_t bytes) {
    const std::size_t units = (bytes + 63) / 64 < 4 ? 4 : (bytes + 63) / 64;
    const int shift = static_cast<int>(std::bit_width(units)) - 3;
    const std::size_t quarter = (units + (std::size_t{1} << shift) - 1) >> shift;  // 4 ... 8
    return shift * 4 + static_cast<int>(quarter) - 4;
  }
  static std::size_t bucket_bytes(int bucket) {
    return static_cast<std::size_t>(64 * (4 + bucket % 4)) << static_cast<unsigned>(bucket / 4);
  }

  std::array<detail::Buffer*, 4 * 62> free_{};
  std::int64_t system_allocations_ = 0;
  std::uint32_t number_ = ++pools_;

  inline static std::atomic<std::uint32_t> pools_{0};
  inline static thread_local bool gone_ = false;  // a static model may be destroyed after the pool of main's thread
};

namespace detail {

/// Shared handle of a buffer.
class BufferHandle {
 public:
  BufferHandle() = default;
  explicit BufferHandle(std::size_t bytes) : buffer_(BufferPool::take(bytes)) {}
  /// Memory that belongs to somebody else and is only read.
  BufferHandle(const void* data, std::shared_ptr<const void> owner) : buffer_(new (std::align_val_t{64}) Buffer) {
    buffer_->data = const_cast<void*>(data);
    buffer_->owner = std::move(owner);
  }
  BufferHandle(const BufferHandle& o) noexcept : buffer_(o.buffer_) {
    if (buffer_ != nullptr) buffer_->references.fetch_add(1, std::memory_order_relaxed);
  }
  BufferHandle(BufferHandle&& o) noexcept : buffer_(std::exchange(o.buffer_, nullptr)) {}
  BufferHandle& operator=(BufferHandle o) noexcept {
    std::swap(buffer_, o.buffer_);
    return *this;
  }
  ~BufferHandle() {
    if (buffer_ == nullptr || buffer_->references.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    if (buffer_->bucket >= 0)
      BufferPool::give_back(buffer_);
    else
      ::operator delete (destroyed(buffer_), std::align_val_t{64});
  }

  void* data() const MOTIONLANG_LIFETIMEBOUND { return buffer_ == nullptr ? nullptr : buffer_->data; }
  /// True if no other handle sees this memory and it may be written.
  bool unique() const {
    return buffer_ != nullptr && buffer_->bucket >= 0 && buffer_->references.load(std::memory_order_acquire) == 1;
  }
  std::shared_ptr<const void>& packed() const { return buffer_->packed; }
  explicit operator bool() const { return buffer_ != nullptr; }

 private:
  static void* destroyed(Buffer* b) {
    b->~Buffer();
    return b;
  }
  Buffer* buffer_ = nullptr;
};

}  // namespace detail

/// A list of values in memory of the pool, cheap to make again and again in a loop. It does only what such lists need:
/// a std::vector with an allocator would compile sixty functions for every type.
template <class T>
class PoolVector {
  static_assert(std::is_nothrow_move_constructible_v<T> && alignof(T) <= 64,
                "motionlang::PoolVector: values that move without fail, in memory aligned to 64 bytes");

 public:
  using value_type = T;

  PoolVector() = default;
  explicit PoolVector(std::size_t size, const T& value = T{}) {
    reserve(size);
    for (; size_ < size; ++size_) ::new (static_cast<void*>(data_ + size_)) T(value);
  }
  PoolVector(PoolVector&& o) noexcept
      : memory_(std::move(o.memory_)),
        data_(std::exchange(o.data_, nullptr)),
        size_(std::exchange(o.size_, 0)),
        capacity_(std::exchange(o.capacity_, 0)) {}
  PoolVector& operator=(PoolVector&&) = delete;
  ~PoolVector() {
    for (std::size_t i = 0; i < size_; ++i) data_[i].~T();
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  const T* begin() const { return data_; }
  T* end() { return data_ + size_; }
  const T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

  void reserve(std::size_t capacity) {
    if (capacity <= capacity_) return;
    if (capacity > SIZE_MAX / 2 / sizeof(T)) detail::raise_bad_alloc();
    detail::BufferHandle larger(capacity * sizeof(T));
    T* to = static_cast<T*>(larger.data());
    for (std::size_t i = 0; i < size_; ++i) {
      ::new (static_cast<void*>(to + i)) T(std::move(data_[i]));
      data_[i].~T();
    }
    memory_ = std::move(larger);
    data_ = to;
    capacity_ = capacity;
  }
  void push_back(T value) {
    if (size_ == capacity_) reserve(size_ < 32 ? 64 : 2 * size_);
    ::new (static_cast<void*>(data_ + size_++)) T(std::move(value));
  }

 private:
  detail::BufferHandle memory_;
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/buffer_pool.ipp>
#endif
