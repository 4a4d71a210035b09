// SPDX-License-Identifier: MIT
/// Processes that train together, played by threads of one process.
#pragma once

#include <algorithm>
#include <compare>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <motionlang/train/communicator.hpp>

/// The way of a message: from a rank to a rank, for one or in a broadcast.
struct ThreadRoute {
  motionlang::Index from, to;
  bool broadcast = false;
  auto operator<=>(const ThreadRoute&) const = default;
};

/// The messages on their way.
class ThreadPost {
 public:
  void put(const ThreadRoute& route, std::vector<std::byte> message) {
    const std::scoped_lock lock(mutex_);
    boxes_[route].push_back(std::move(message));
    changed_.notify_all();
  }
  std::vector<std::byte> take(const ThreadRoute& route) {
    std::unique_lock lock(mutex_);
    auto& box = boxes_[route];
    changed_.wait(lock, [&] { return closed_ || !box.empty(); });
    if (box.empty()) throw std::runtime_error("another rank has failed");
    auto out = std::move(box.front());
    box.pop_front();
    return out;
  }
  bool has(const ThreadRoute& route) {
    const std::scoped_lock lock(mutex_);
    return !boxes_[route].empty();
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
  std::map<ThreadRoute, std::deque<std::vector<std::byte>>> boxes_;
  bool closed_ = false;
};

/// One of them. It counts the bytes that it sends to others.
class ThreadProcess {
 public:
  ThreadProcess(ThreadPost& post, motionlang::Index rank, motionlang::Index size)
      : post_(&post), rank_(rank), size_(size) {}

  motionlang::Index rank() const { return rank_; }
  motionlang::Index size() const { return size_; }
  void send(std::span<const std::byte> bytes, motionlang::Index to) const { put(bytes, {rank_, to}); }
  void receive(std::span<std::byte> bytes, motionlang::Index from) const { take(bytes, {from, rank_}); }
  void exchange(std::span<const std::byte> given, std::span<std::byte> taken, motionlang::Index with) const {
    send(given, with);  // does not wait
    receive(taken, with);
  }
  bool arrived(motionlang::Index from) const { return post_->has({from, rank_}); }
  void broadcast(std::span<std::byte> bytes, motionlang::Index root) const {
    if (rank_ != root) return take(bytes, {root, rank_, true});
    for (motionlang::Index r = 0; r < size_; ++r) {
      if (r != root) put(bytes, {rank_, r, true});
    }
  }
  void barrier() const {
    for (motionlang::Index r = 1; rank_ == 0 && r < size_; ++r) take({}, {r, 0, true});
    if (rank_ > 0) put({}, {rank_, 0, true});
    broadcast({}, 0);
  }
  motionlang::Index messages() const { return messages_; }
  motionlang::Index bytes() const { return bytes_; }

 private:
  void put(std::span<const std::byte> bytes, const ThreadRoute& route) const {
    ++messages_, bytes_ += std::ssize(bytes);
    post_->put(route, {bytes.begin(), bytes.end()});
  }
  void take(std::span<std::byte> bytes, const ThreadRoute& route) const {
    const auto message = post_->take(route);
    if (message.size() != bytes.size())
      motionlang::raise<motionlang::shape_error>(204, "a message of ", message.size(), " bytes from rank ", route.from,
                                                 " where ", bytes.size(), " are wanted");
    std::copy(message.begin(), message.end(), bytes.begin());
  }

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
