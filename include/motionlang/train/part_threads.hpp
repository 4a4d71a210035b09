// SPDX-License-Identifier: MIT
/// Threads that take turns: either the caller runs or one of them. So they share what belongs to one thread, and each
/// can wait in the middle of its work until the caller lets it go on.
///
///     PartThreads threads;
///     threads.begin(2, [&](Index k) { first_half(k), threads.pause(k), second_half(k); });
///     for (const Index k : {0, 1}) threads.resume(k);  // the first halves, one after the other
///     for (const Index k : {0, 1}) threads.resume(k);
#pragma once

#include <functional>  // work
#include <memory>      // threads
#include <vector>      // threads

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The threads stay for the next work, with the memory that they have freed. Do not use it inside a task of
/// parallel_for: the threads share its pool with the caller.
class PartThreads {
 public:
  PartThreads();
  PartThreads(PartThreads&&) noexcept;
  PartThreads& operator=(PartThreads&&) noexcept;
  ~PartThreads();

  /// Makes work(k) ready in the threads k = 0 ... count - 1, and runs nothing yet. Stops earlier work.
  void begin(Index count, const std::function<void(Index)>& work);
  /// Runs thread k until it pauses, which returns true, or its work ends. Throws what the work throws.
  bool resume(Index k);
  /// For the work of thread k: the caller of resume goes on, and this thread waits for the next one.
  void pause(Index k);
  /// Ends work that waits: its `pause` throws.
  void stop();

 private:
  struct Thread;
  std::vector<std::unique_ptr<Thread>> threads_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/part_threads.ipp>
#endif
