// SPDX-License-Identifier: MIT
// Bodies of parallel.hpp.
#pragma once

#include <algorithm>           // min
#include <atomic>              // task counters
#include <condition_variable>  // sleeping workers
#include <exception>           // exception_ptr: errors in tasks reach the caller
#include <memory>              // the workers
#include <mutex>               // sleeping workers
#include <system_error>        // no more threads
#include <thread>              // workers
#include <utility>             // exchange

#include <motionlang/core/error.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/processors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

class ThreadPool {
 public:
  static ThreadPool& instance() {
    static ThreadPool pool;
    return pool;
  }

  int size() const { return workers_ + 1; }
  /// The number of threads that `run` uses here: inside a task it is 1.
  int width() const { return inside_ ? 1 : size(); }
  /// 0 for a thread that called `run`, 1 ... size-1 for the workers.
  static int number() { return number_; }

  void resize(int threads) {
    stop();
    shares_ = std::make_unique<Share[]>(static_cast<std::size_t>(threads));
    threads_ = std::make_unique<std::thread[]>(static_cast<std::size_t>(threads - 1));
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

  /// The tasks that a thread takes first; a thread without tasks helps the others. If consecutive regions split the
  /// same rows alike, each thread finds its rows in its caches.
  struct alignas(64) Share {
    std::atomic<Index> next{0};
    Index end = 0;
  };

  Share& share(int thread) { return shares_[static_cast<std::size_t>(thread)]; }

  ThreadPool() {
    const auto start = [&] { resize(std::min(processor_count(), 256)); };
    const auto no_more = [](const std::system_error&) { return true; };  // the threads that began are enough
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

  /// The work of a thread. It is a function, because std::thread takes its address. The code of a lambda would be a
  /// part of std::thread's. A program and a shared library share that code, but each has its own copy of this pool and
  /// of `inside_`.
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

MOTIONLANG_BODY void run_tasks(Index count, void (*task)(const void*, Index), const void* context) {
  ThreadPool::instance().run(count, task, context);
}

}  // namespace detail

MOTIONLANG_BODY int thread_count() { return detail::ThreadPool::instance().size(); }

MOTIONLANG_BODY int parallel_width() { return detail::ThreadPool::instance().width(); }

MOTIONLANG_BODY int thread_number() { return detail::ThreadPool::number(); }

MOTIONLANG_BODY void set_thread_count(int threads) {
  if (threads < 1 || threads > 1024) raise<config_error>(101, "set_thread_count: ", threads, " is not in 1 ... 1024");
  detail::ThreadPool::instance().resize(threads);
}

MOTIONLANG_NAMESPACE_END
