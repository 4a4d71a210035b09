// SPDX-License-Identifier: MIT
/// Processes that train together, played by threads of one process.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <motionlang/train/communicator.hpp>

/// The messages on their way.
class ThreadPost {
 public:
  void put(motionlang::Index from, motionlang::Index to, std::vector<std::byte> message) {
    const std::scoped_lock lock(mutex_);
    boxes_[{from, to}].push_back(std::move(message));
    changed_.notify_all();
  }
  std::vector<std::byte> take(motionlang::Index from, motionlang::Index to) {
    std::unique_lock lock(mutex_);
    auto& box = boxes_[{from, to}];
    changed_.wait(lock, [&] { return closed_ || !box.empty(); });
    if (box.empty()) throw std::runtime_error("another rank has failed");
    auto out = std::move(box.front());
    box.pop_front();
    return out;
  }
  /// A rank has failed, so that others do not wait for it.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::pair<motionlang::Index, motionlang::Index>, std::deque<std::vector<std::byte>>> boxes_;
  bool closed_ = false;
};

/// One of them. It counts the bytes that it sends to others.
class ThreadProcess {
 public:
  ThreadProcess(ThreadPost& post, motionlang::Index rank, motionlang::Index size)
      : post_(&post), rank_(rank), size_(size) {}

  motionlang::Index rank() const { return rank_; }
  motionlang::Index size() const { return size_; }
  void send(std::span<const std::byte> bytes, motionlang::Index to) const {
    ++messages_, bytes_ += std::ssize(bytes);
    post_->put(rank_, to, {bytes.begin(), bytes.end()});
  }
  void receive(std::span<std::byte> bytes, motionlang::Index from) const {
    const auto message = post_->take(from, rank_);
    if (message.size() != bytes.size())
      motionlang::raise<motionlang::shape_error>(204, "a message of ", message.size(), " bytes from rank ", from,
                                                 " where ", bytes.size(), " are wanted");
    std::copy(message.begin(), message.end(), bytes.begin());
  }
  void exchange(std::span<const std::byte> given, std::span<std::byte> taken, motionlang::Index with) const {
    send(given, with);  // does not wait
    receive(taken, with);
  }
  void broadcast(std::span<std::byte> bytes, motionlang::Index root) const {
    if (rank_ != root) return receive(bytes, root);
    for (motionlang::Index r = 0; r < size_; ++r) {
      if (r != root) send(bytes, r);
    }
  }
  void barrier() const {
    for (motionlang::Index r = 1; rank_ == 0 && r < size_; ++r) receive({}, r);
    if (rank_ > 0) send({}, 0);
    broadcast({}, 0);
  }
  motionlang::Index messages() const { return messages_; }
  motionlang::Index bytes() const { return bytes_; }

 private:
  ThreadPost* post_;
  motionlang::Index rank_, size_;
  mutable motionlang::Index messages_ = 0, bytes_ = 0;
};
static_assert(motionlang::Communicator<ThreadProcess>);

/// Calls f(process) for each rank, in a thread of its own. Throws what the first rank that failed by itself threw.
template <class F>
void run_processes(motionlang::Index size, const F& f) {
  ThreadPost post;
  std::mutex mutex;
  std::exception_ptr failure;
  std::vector<std::thread> threads;
  for (motionlang::Index rank = 0; rank < size; ++rank) {
    threads.emplace_back([&, rank] {
      const ThreadProcess process(post, rank, size);
      try {
        f(process);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!failure) failure = std::current_exception();
        post.close();
      }
    });
  }
  for (std::thread& t : threads) t.join();
  if (failure) std::rethrow_exception(failure);
}
