// SPDX-License-Identifier: MIT
// Bodies of buffer_pool.hpp.
#pragma once

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/large_memory.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void BufferPool::trim() {
  for (auto& head : free_) {
    while (head != nullptr) release(std::exchange(head, head->next));
  }
}

MOTIONLANG_BODY void BufferPool::release(detail::Buffer* b) {
  const int bucket = b->bucket;
  if constexpr (detail::address_sanitizer) detail::allow_access(b->data, bucket_bytes(bucket));
  b->~Buffer();
  give_memory(b, sizeof(detail::Buffer) + bucket_bytes(bucket));
}

MOTIONLANG_BODY BufferPool::~BufferPool() {
  gone_ = true;
  trim();
}

MOTIONLANG_BODY detail::Buffer* BufferPool::make(int bucket, std::size_t bytes, std::uint32_t pool) {
  void* memory = take_memory(sizeof(detail::Buffer) + bucket_bytes(bucket), sizeof(detail::Buffer) + bytes);
  auto* b = new (memory) detail::Buffer;
  b->data = static_cast<std::byte*>(memory) + sizeof(detail::Buffer);
  b->bucket = bucket;
  b->pool = pool;
  return b;
}

MOTIONLANG_NAMESPACE_END
