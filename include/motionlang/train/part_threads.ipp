// SPDX-License-Identifier: MIT
// Bodies of part_threads.hpp.
#pragma once

#include <condition_variable>  // turns
#include <exception>           // errors in the work
#include <mutex>               // turns
#include <thread>              // threads
#include <utility>             // exchange, move

#include <motionlang/core/error.hpp>
#include <motionlang/train/part_threads.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Leaves the work of a thread. The work cannot take it for an error of its own: it has no base std::exception.
struct WorkStopped {
  static const char* what() { return "the work of a thread was stopped"; }
};

}  // namespace detail

struct PartThreads::Thread {
  std::function<void(Index)> work{};
  enum class Work { none, ready, begun } state = Work::none;
  std::exception_ptr failure{};  // of the work that has ended

  explicit Thread(Index number) : thread_([this, number] { live(number); }) {}
  ~Thread() {
    stop();
    leaving_ = true;
    give_turn(true);
    thread_.join();
  }
  Thread(const Thread&) = delete;
  Thread& operator=(const Thread&) = delete;

  /// Lets the thread run until it hands back.
  void run() {
    give_turn(true);
    wait_for_turn(false);
  }
  /// In the thread.
  void pause() {
    give_turn(false);
    wait_for_turn(true);
    if (stopping_) detail::throw_exception(detail::WorkStopped());
  }
  void stop() {
    stopping_ = true;
    while (state == Work::begun) run();
    stopping_ = false;
    state = Work::none;
    failure = nullptr;
  }

 private:
  void live(Index number) {
    for (;;) {
      wait_for_turn(true);
      if (leaving_) return;
      state = Work::begun;
      detail::guard_all([&] { work(number); },
                        [&] {
                          failure = std::current_exception();
                          return true;
                        });
      state = Work::none;
      give_turn(false);
    }
  }
  void give_turn(bool to_thread) {
    const std::scoped_lock lock(mutex_);
    turn_of_thread_ = to_thread;
    changed_.notify_one();  // the other side; nobody else waits
  }
  void wait_for_turn(bool of_thread) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return turn_of_thread_ == of_thread; });
  }

  // Only the side that has the turn uses these.
  bool stopping_ = false, leaving_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool turn_of_thread_ = false;
  std::thread thread_;  // the last member: it begins when the others are there
};

MOTIONLANG_BODY PartThreads::PartThreads() = default;
MOTIONLANG_BODY PartThreads::PartThreads(PartThreads&&) noexcept = default;
MOTIONLANG_BODY PartThreads& PartThreads::operator=(PartThreads&&) noexcept = default;
MOTIONLANG_BODY PartThreads::~PartThreads() = default;

MOTIONLANG_BODY void PartThreads::begin(Index count, const std::function<void(Index)>& work) {
  stop();
  while (std::ssize(threads_) < count) threads_.push_back(std::make_unique<Thread>(std::ssize(threads_)));
  for (Index k = 0; k < count; ++k) {
    Thread& t = *threads_[static_cast<std::size_t>(k)];
    t.work = work;
    t.state = Thread::Work::ready;
  }
}

MOTIONLANG_BODY bool PartThreads::resume(Index k) {
  Thread& t = *threads_[static_cast<std::size_t>(k)];
  if (t.state == Thread::Work::none) raise<config_error>(101, "PartThreads: the work of thread ", k, " has ended");
  t.run();
  if (t.failure) std::rethrow_exception(std::exchange(t.failure, nullptr));
  return t.state == Thread::Work::begun;
}

MOTIONLANG_BODY void PartThreads::pause(Index k) { threads_[static_cast<std::size_t>(k)]->pause(); }

MOTIONLANG_BODY void PartThreads::stop() {
  for (const auto& t : threads_) t->stop();
}

MOTIONLANG_NAMESPACE_END
