// parallel_for and its like: every index once, exceptions, nesting, several callers.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "../../support/threads.hpp"

namespace ml = motionlang;

namespace {

bool each_once(ml::Index count) {
  std::vector<std::atomic<int>> seen(static_cast<std::size_t>(count));
  ml::parallel_for(count, [&](ml::Index i) { ++seen[static_cast<std::size_t>(i)]; });
  for (const auto& s : seen) {
    if (s != 1) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("every index is visited once, whatever the numbers of threads and tasks") {
  for (int threads : {1, 2, 3, 8}) {
    const Threads set(threads);
    CHECK(ml::thread_count() == threads);
    for (ml::Index count : {1, 2, 3, 7, 100, 1000}) CHECK(each_once(count));
    ml::parallel_for(0, [](ml::Index) { FAIL("called for 0 tasks"); });
    ml::parallel_for(-3, [](ml::Index) { FAIL("called for fewer than 0 tasks"); });
  }
}

TEST_CASE("pieces: everything once, as many rows for each thread, single numbers in the same places for all") {
  using Piece = std::pair<ml::Index, ml::Index>;
  const auto pieces_of = [](ml::Index count, ml::Index cost) {
    std::vector<Piece> out;
    std::mutex one_at_a_time;
    ml::parallel_ranges(count, cost, [&](ml::Index first, ml::Index last) {
      const std::scoped_lock lock(one_at_a_time);
      out.emplace_back(first, last);
    });
    std::sort(out.begin(), out.end());
    return out;
  };
  for (int threads : {1, 2, 3, 16}) {
    const Threads set(threads);
    CHECK(pieces_of(0, 1000).empty());
    CHECK(pieces_of(31, 512).size() == 1);  // not worth two threads
    for (ml::Index count : {1, 5, 33, 408, 20'000}) {
      for (ml::Index cost : {0, 1, 63, 64, 512, 1'000'000}) {
        CAPTURE(threads);
        CAPTURE(count);
        CAPTURE(cost);
        const auto pieces = pieces_of(count, cost);
        ml::Index at = 0, least = count, most = 0;
        for (const auto& [first, last] : pieces) {
          CHECK(first == at);
          CHECK(last > first);
          least = std::min(least, last - first), most = std::max(most, last - first);
          at = last;
        }
        CHECK(at == count);
        if (cost < 64) {
          const Threads alone(1);
          CHECK(pieces == pieces_of(count, cost));
        } else if (pieces.size() > 1 && count >= threads) {
          CHECK((std::ssize(pieces) % threads == 0 || std::ssize(pieces) == count));
          CHECK((threads == 1 || most - least <= 1));
        }
      }
    }
    std::atomic<ml::Index> inside{0};
    ml::parallel_for(5, [&](ml::Index) {
      ml::parallel_ranges(1000, 512, [&](ml::Index first, ml::Index last) { inside += last - first; });
    });
    CHECK(inside == 5 * 1000);
  }
}

TEST_CASE("many short regions after each other, and after the workers have fallen asleep") {
  const Threads set(3);
  for (int i = 0; i < 3000; ++i) REQUIRE(each_once(4));
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  CHECK(each_once(4));
}

TEST_CASE("every thread begins with its own part of the tasks") {
  const Threads set(2);
  std::atomic<int> begun{0};
  std::array<std::atomic<ml::Index>, 2> first{-1, -1};
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  ml::parallel_for(8, [&](ml::Index i) {
    auto& mine = first[static_cast<std::size_t>(ml::thread_number())];
    if (mine < 0) mine = i, ++begun;
    while (begun < 2 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
  });
  CHECK(first[0] == 0);
  CHECK(first[1] == 4);
}

TEST_CASE("a thread that has done its part helps the others") {
  const Threads set(2);
  std::atomic<int> others{0};
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  ml::parallel_for(8, [&](ml::Index i) {
    if (i > 0) {
      ++others;
    } else {  // the first half is the caller's: it is stuck here
      while (others < 7 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
    }
  });
  CHECK(others == 7);
  CHECK(std::chrono::steady_clock::now() < until);
}

TEST_CASE("an exception in a task reaches the caller, and the pool works on") {
  for (int threads : {1, 4}) {
    const Threads set(threads);
    for (int round = 0; round < 20; ++round) {
      CHECK_THROWS_WITH_AS(ml::parallel_for(50,
                                            [](ml::Index i) {
                                              if (i % 7 == 3) throw std::runtime_error("task");
                                            }),
                           "task", std::runtime_error);
      CHECK(each_once(50));
    }
  }
}

TEST_CASE("inside a task everything runs serially") {
  const Threads set(4);
  CHECK(ml::parallel_width() == 4);
  std::atomic<int> total{0};
  std::atomic<bool> moved{false};
  ml::parallel_for(8, [&](ml::Index) {
    const auto here = std::this_thread::get_id();
    if (ml::parallel_width() != 1) moved = true;
    ml::parallel_for(8, [&](ml::Index) {
      if (std::this_thread::get_id() != here) moved = true;
      ++total;
    });
  });
  CHECK(total == 64);
  CHECK_FALSE(moved);
}

TEST_CASE("several threads may call at the same time") {
  const Threads set(3);
  std::atomic<bool> ok{true};
  std::vector<std::thread> callers;
  for (int c = 0; c < 4; ++c) {
    callers.emplace_back([&] {
      for (int i = 0; i < 100; ++i) {
        if (!each_once(9)) ok = false;
      }
    });
  }
  for (auto& c : callers) c.join();
  CHECK(ok);
}

TEST_CASE("a number of threads that cannot be is refused") {
  CHECK_THROWS_WITH_AS(ml::set_thread_count(0), doctest::Contains("[motionlang.config.101]"), ml::config_error);
  CHECK_THROWS_AS(ml::set_thread_count(1025), ml::config_error);
}
