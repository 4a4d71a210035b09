// Items and progress that several processes share.
#include <motionlang/train/shared_items.hpp>
#include <motionlang/train/shared_progress.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <future>

#include "../../support/check_error.hpp"
#include "../../support/thread_processes.hpp"

namespace ml = motionlang;
using ml::Index;

TEST_CASE("each item is computed once, and all processes have all of them in their order") {
  for (const Index processes : {1, 2, 3, 9}) {
    CAPTURE(processes);
    std::vector<std::vector<Index>> computed(static_cast<std::size_t>(processes));
    run_processes(processes, [&](const ThreadProcess& process) {
      auto& own = computed[static_cast<std::size_t>(process.rank())];
      std::vector<Index> seen;
      auto progress = [&](Index done, Index total) {
        CHECK((process.rank() == 0 && total == 7000));
        seen.push_back(done);
        return true;
      };
      const auto compute = [&](Index i, const ml::Progress& of_item) {
        own.push_back(i);
        of_item(1, 2);
        return std::string(static_cast<std::size_t>(i), 'x');
      };
      const auto items = ml::shared_items(ml::AnyCommunicator(process), 7, compute, progress);
      REQUIRE(items.size() == 7);
      for (std::size_t i = 0; i < 7; ++i) CHECK(items[i] == std::string(i, 'x'));
      if (process.rank() > 0) return;
      CHECK(std::is_sorted(seen.begin(), seen.end()));
      CHECK(seen.back() == 7000);
      CHECK(seen.front() >= 500);  // others may have done more by then
    });
    for (std::size_t r = 0; r < computed.size(); ++r) {
      std::vector<Index> expected;
      for (Index i = static_cast<Index>(r); i < 7; i += processes) expected.push_back(i);
      CHECK(computed[r] == expected);
    }
  }
  CHECK(ml::shared_items({}, 0, [](Index, const ml::Progress&) { return std::string(); }).empty());
}

TEST_CASE("numbers with names are added to the lists of their names") {
  std::map<std::string, std::vector<double>> lists{{"a", {1}}};
  ml::add_named_numbers(lists, ml::named_numbers({{"a", 0.1}, {"b c", -2}}));
  CHECK(lists == std::map<std::string, std::vector<double>>{{"a", {1, 0.1}}, {"b c", {-2}}});
}

TEST_CASE("rank 0 counts the work of all, and does not wait for the others before the end") {
  std::vector<Index> seen;
  std::promise<void> all_reported, half_sent;
  run_processes(3, [&](const ThreadProcess& process) {
    auto caller = [&](Index done, Index total) {
      CHECK(total == 6000);
      seen.push_back(done);
      return true;
    };
    ml::SharedProgress progress(ml::AnyCommunicator(process), {2, 4, 0}, caller);
    const auto in_time = [](std::promise<void>& of) {
      return of.get_future().wait_for(std::chrono::seconds(30)) == std::future_status::ready;
    };
    if (process.rank() == 0) {
      for (const Index i : {1, 2, 3}) progress(i, 4);  // nothing has arrived
      all_reported.set_value();
      CHECK(in_time(half_sent));
      progress(4, 4);
    }
    if (process.rank() == 1) {
      CHECK(in_time(all_reported));
      progress(1, 2);
      half_sent.set_value();
      progress(2, 2);
    }
    progress.finish();
  });
  REQUIRE(seen.size() >= 4);
  CHECK(std::vector<Index>(seen.begin(), seen.begin() + 3) == std::vector<Index>{500, 1000, 1500});
  CHECK(seen[3] >= 2000 + 2000);  // with what the other one has done by then
  CHECK(std::is_sorted(seen.begin(), seen.end()));
  CHECK(seen.back() == 6000);
}

TEST_CASE("the caller of rank 0 may stop the work, and one process reports its own counts") {
  auto stop = [](Index, Index) { return false; };
  CHECK_THROWS_AS(run_processes(2,
                                [&](const ThreadProcess& process) {
                                  ml::SharedProgress progress(ml::AnyCommunicator(process), {1, 1}, stop);
                                  progress(1, 1);
                                  progress.finish();
                                }),
                  ml::cancelled);
  std::vector<Index> seen;
  auto caller = [&](Index done, Index total) { return seen.insert(seen.end(), {done, total}), true; };
  ml::SharedProgress alone({}, {5}, caller);
  alone(2, 3);
  alone.finish();
  CHECK(seen == std::vector<Index>{2, 3});
  CHECK_ERROR(ml::SharedProgress({}, {1, 2}, caller), "[motionlang.config.102] SharedProgress: the work of 2 ranks");
}
