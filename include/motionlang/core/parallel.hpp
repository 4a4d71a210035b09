// SPDX-License-Identifier: MIT
/// A small pool of threads and `parallel_for`.
///
/// Work is split into tasks that never share a sum, and the result of a task does not depend on who runs it: one thread
/// and many give the same bits. Workers spin after a task (20,000 pauses: 0.2 to 1 millisecond, by the processor) and
/// then sleep, so that the many short regions of a transformer layer cost well below a microsecond each (on few cores)
/// while an idle program costs nothing.
#pragma once

#include <algorithm>           // clamp
#include <atomic>              // task counters
#include <condition_variable>  // sleeping workers
#include <exception>           // exception_ptr: errors in tasks reach the caller
#include <memory>              // the workers
#include <mutex>               // sleeping workers
#include <system_error>        // no more threads
#include <thread>              // workers
#include <utility>             // exchange

#include <motionlang/core/error.hpp>
#include <motionlang/core/processors.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

class ThreadPool {
 public:
  static ThreadPool& instance() {
    static ThreadPool pool;
    return pool;
  }

  int size() const { return workers_ + 1; }
  /// Threads that `run` uses when it is called here: a task runs its own tasks alone.
  int width() const { return inside_ ? 1 : size(); }
  /// 0 for a thread that called `run`, 1 ... size-1 for the workers.
  static int number() { return number_; }

  void resize(int threads) {
    stop();
    shares_.reset(new Share[static_cast<std::size_t>(threads)]);
    threads_.reset(new std::thread[static_cast<std::size_t>(threads - 1)]);
    stopping_ = false;
    for (int i = 1; i < threads; ++i) {
      threads_[static_cast<std::size_t>(workers_)] = std::thread(start, this, i, round_.load());
      ++workers_;
    }
  }

  /// Runs task(context, i) for i = 0 ... count-1 on all threads and returns when all are done.
  void run(Index count, void (*task)(const void*, Index), const void* context) {
    if (count == 1 || workers_ == 0 || inside_) {
      for (Index i = 0; i < count; ++i) task(context, i);
      return;
    }
    std::scoped_lock only_one_caller(caller_);
    task_ = task;
    context_ = context;
    for (int t = 0; t < size(); ++t) {
      share(t).next.store(count * t / size(), std::memory_order_relaxed);
      share(t).end = count * (t + 1) / size();
    }
    pending_.store(workers_, std::memory_order_relaxed);
    {
      std::scoped_lock lock(sleep_);
      round_.fetch_add(1, std::memory_order_release);
    }
    if (asleep_.load() > 0) wake_.notify_all();
    take_tasks();
    for (int spins = 0; pending_.load(std::memory_order_acquire) != 0; ++spins) pause(spins);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

 private:
  static constexpr int spins_before_sleep = 20000;

  /// Tasks that a thread takes first; whoever has none left helps the others. Regions that split the same rows alike,
  /// one after the other, find them in the caches of the same thread.
  struct alignas(64) Share {
    std::atomic<Index> next{0};
    Index end = 0;
  };

  Share& share(int thread) { return shares_[static_cast<std::size_t>(thread)]; }

  ThreadPool() {
    const auto start = [&] { resize(std::min(processor_count(), 256)); };
    const auto no_more = [](const std::system_error&) { return true; };  // those threads that began will do
    guard<std::system_error>(start, no_more);
  }
  ~ThreadPool() { stop(); }

  static void pause(int spins) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
    if (spins % 1024 == 1023) std::this_thread::yield();  // more threads than cores: let the others finish
  }

  void stop() {
    {
      std::scoped_lock lock(sleep_);
      stopping_ = true;
      round_.fetch_add(1);
    }
    wake_.notify_all();
    for (; workers_ > 0; --workers_) threads_[static_cast<std::size_t>(workers_ - 1)].join();
  }

  /// What a worker does. A function that std::thread is given the address of: the code of a lambda would be a part of
  /// std::thread's, which a program and a shared library, each with its own copy of this pool and of `inside_`, have in
  /// common.
  static void start(ThreadPool* pool, int number, unsigned seen) {
    number_ = number;
    pool->work(seen);
  }
  void work(unsigned seen) {
    inside_ = true;
    for (;;) {
      int spins = 0;
      while (round_.load(std::memory_order_acquire) == seen && ++spins < spins_before_sleep) pause(spins);
      if (round_.load(std::memory_order_acquire) == seen) {
        std::unique_lock lock(sleep_);
        ++asleep_;
        wake_.wait(lock, [&] { return round_.load() != seen; });
        --asleep_;
      }
      ++seen;
      if (stopping_) return;
      take_tasks();
      pending_.fetch_sub(1, std::memory_order_release);
    }
  }

  void take_tasks() {
    const bool outer = std::exchange(inside_, true);
    for (int t = 0; t < size(); ++t) take_tasks(share((number_ + t) % size()));
    inside_ = outer;
  }
  void take_tasks(Share& from) {
    const auto stop_with_it = [&] {
      std::scoped_lock lock(sleep_);
      if (!failure_) failure_ = std::current_exception();
      for (int t = 0; t < size(); ++t) share(t).next.store(share(t).end, std::memory_order_relaxed);
      return true;
    };
    while (from.next.load(std::memory_order_relaxed) < from.end) {
      const Index i = from.next.fetch_add(1, std::memory_order_relaxed);
      if (i >= from.end) return;
      guard_all([&] { task_(context_, i); }, stop_with_it);
    }
  }

  inline static thread_local int number_ = 0;
  inline static thread_local bool inside_ = false;  // a task that calls parallel_for runs it alone
  std::unique_ptr<Share[]> shares_;                 // one for every thread
  std::unique_ptr<std::thread[]> threads_;
  int workers_ = 0;  // threads that run
  std::mutex caller_, sleep_;
  std::condition_variable wake_;
  std::atomic<unsigned> round_{0};
  std::atomic<int> pending_{0}, asleep_{0};
  std::atomic<bool> stopping_{false};
  void (*task_)(const void*, Index) = nullptr;
  const void* context_ = nullptr;
  std::exception_ptr failure_;
};

}  // namespace detail

/// Threads that `parallel_for` uses, the caller included: processor_count(), at most 256, unless set.
inline int thread_count() { return detail::ThreadPool::instance().size(); }

/// Threads that `parallel_for` uses here: one inside a task.
inline int parallel_width() { return detail::ThreadPool::instance().width(); }

/// Number of the thread that runs a task of `parallel_for`: 0 ... thread_count()-1, different for those that run at
/// once.
inline int thread_number() { return detail::ThreadPool::number(); }

/// Changes the number of threads for the whole process. Not while work is running. Throws config_error 101.
inline void set_thread_count(int threads) {
  if (threads < 1 || threads > 1024) raise<config_error>(101, "set_thread_count: ", threads, " is not in 1 ... 1024");
  detail::ThreadPool::instance().resize(threads);
}

/// Calls f(i) for i = 0 ... count-1, in any order, on all threads. f must not depend on the order. Exceptions reach the
/// caller (the first one). Inside a task it runs serially.
template <class F>
void parallel_for(Index count, const F& f) {
  if (count <= 0) return;
  detail::ThreadPool::instance().run(
      count, [](const void* g, Index i) { (*static_cast<const F*>(g))(i); }, &f);
}

namespace detail {
inline constexpr Index worth_a_thread = 16384;  // numbers
}

/// Calls f(first, last) for pieces of 0 ... count-1, in one piece what is not worth two threads (`cost` numbers per
/// element). Of elements of many numbers, such as rows, every thread has as many: in the next region it finds what it
/// wrote in its cache. Pieces of single numbers begin at the same places for any number of threads: vectors and what is
/// left beside them are the same.
template <class F>
void parallel_ranges(Index count, Index cost, const F& f) {
  const Index grain = std::max<Index>(1, detail::worth_a_thread / std::max<Index>(1, cost));
  const Index pieces = (count + grain - 1) / grain, threads = parallel_width();
  if (cost < 64 || pieces <= 1 || threads == 1)
    return parallel_for(pieces, [&](Index i) { f(i * grain, std::min(count, (i + 1) * grain)); });
  const Index equal = std::min(count, (pieces + threads - 1) / threads * threads);
  parallel_for(equal, [&](Index i) { f(count * i / equal, count * (i + 1) / equal); });
}

/// Calls f(first, last) for pieces of the columns 0 ... width-1 of a matrix of so many rows: for what goes through the
/// rows in their order. Pieces begin at multiples of 16, so that whole vectors are the same for any number of threads.
template <class F>
void parallel_columns(Index rows, Index width, const F& f) {
  const Index pieces = rows * width < detail::worth_a_thread ? 1 : std::clamp<Index>(width / 64, 1, parallel_width());
  const auto begin = [&](Index i) { return i == pieces ? width : width * i / pieces / 16 * 16; };
  parallel_for(pieces, [&](Index i) { f(begin(i), begin(i + 1)); });
}

MOTIONLANG_NAMESPACE_END
