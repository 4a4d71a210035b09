// Parts of a batch that meet: threads that take turns, sums over all parts, and batch norm of a divided batch.
#include <motionlang/train/meeting_parts.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <motionlang/backend/usual.hpp>
#include <motionlang/core/batch_sums.hpp>
#include <motionlang/nn/batch_norm.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/tensor/sum_over_parts.hpp>
#include <motionlang/train/part_threads.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"
#include "../../support/thread_processes.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using ml::Index;

TEST_CASE("threads take turns, stay for the next work, and stop") {
  ml::PartThreads threads;
  std::string said;
  for (const Index count : {2, 3, 1}) {
    said.clear();
    threads.begin(count, [&](Index k) {
      said += "a" + std::to_string(k) + " ";
      threads.pause(k);
      said += "b" + std::to_string(k) + " ";
    });
    CHECK(said.empty());
    for (Index k = count; k-- > 0;) CHECK(threads.resume(k));
    for (Index k = 0; k < count; ++k) CHECK_FALSE(threads.resume(k));
    CHECK(said == (count == 1 ? "a0 b0 " : count == 2 ? "a1 a0 b0 b1 " : "a2 a1 a0 b0 b1 b2 "));
    CHECK_ERROR(threads.resume(0), "[motionlang.config.101] PartThreads: the work of thread 0 has ended");
  }
  // Work that waits is left, with its objects, when other work begins, and when the threads end.
  struct Left {
    int& count;
    ~Left() { ++count; }
  };
  int left = 0;
  const auto wait = [&](Index k) {
    const Left object{left};
    threads.pause(k);
    FAIL("this thread was stopped");
  };
  threads.begin(3, wait);
  CHECK((threads.resume(0) && threads.resume(2)));
  threads.begin(3, wait);
  CHECK(left == 2);
  CHECK(threads.resume(1));
  ml::PartThreads moved = std::move(threads);
  threads = ml::PartThreads();
  moved.stop();
  CHECK(left == 3);
}

TEST_CASE("an error in a thread reaches the caller, and the thread can work again") {
  ml::PartThreads threads;
  for (int again = 0; again < 2; ++again) {
    threads.begin(1, [&](Index k) {
      threads.pause(k);
      throw std::runtime_error("failed");
    });
    CHECK(threads.resume(0));
    CHECK_THROWS_WITH_AS(threads.resume(0), "failed", std::runtime_error);
  }
}

namespace {

/// Two norms with a product between them, so that the second one is behind the first in both passes.
template <ml::Backend T>
struct Norms {
  ml::BatchNorm<T> first{3}, second{4};
  ml::Linear<T> between;

  static constexpr auto fields() {
    return ml::fields("first", &Norms::first, "second", &Norms::second, "between", &Norms::between);
  }
  Norms() = default;
  explicit Norms(ml::Philox rng) : between(3, 4, rng) {}

  ml::Tensor<T, 2> train(const ml::Tensor<T, 2>& x, const ml::Context& context = {}) {
    return second.train(ml::square(between(first.train(x, context))), context);
  }
};

constexpr Index rows = 11;

/// The loss of some rows of a batch, its gradients by the weights, and those by the rows in their places.
std::vector<double> loss_and_gradients(Norms<A>& net, const ml::BatchPart& part, const ml::Context& context = {}) {
  ml::Philox rng{.seed = 5};
  auto whole = ml::Tensor<B, 2>::randn({rows, 3}, rng) * 2.0 + 1000.0;  // far from zero
  const auto weights = ml::Tensor<A, 2>::randn({rows, 4}, rng);
  const auto x = ml::variable<A>(ml::slice(whole, 0, part.first, part.last));
  const auto y = net.train(x, context);
  const auto loss = ml::sum(ml::square(y) * ml::slice(weights, 0, part.first, part.last) + y * y * y);
  const auto gradients = ml::backward(loss);
  std::vector<double> out{loss.item()}, by_rows(rows * 3);
  ml::append_gradients<A>(out, ml::tensors_of(net), gradients);
  const auto own = gradients[x].to_vector();
  std::copy(own.begin(), own.end(), by_rows.begin() + part.first * 3);
  out.insert(out.end(), by_rows.begin(), by_rows.end());
  return out;
}
std::vector<double> statistics_of(Norms<A>& net) {
  std::vector<double> out;
  for (const auto& t : ml::untrained<A>(ml::tensors_of(net))) out.insert(out.end(), t.span().begin(), t.span().end());
  return out;
}
Norms<A> norms() { return ml::convert<A>(Norms<B>(ml::Philox{.seed = 4})); }

double worst(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, std::abs(a[i] - b[i]) / (1 + std::abs(b[i])));
  return out;
}

}  // namespace

TEST_CASE("batch norm of a divided batch: statistics, loss and gradients are those of the whole batch") {
  auto whole = norms();
  const auto expected = loss_and_gradients(whole, {0, rows});
  for (const Index size : {1, 2, 4, 5, 11}) {  // of parts, the last of which is smaller
    CAPTURE(size);
    const Index parts = ml::part_count(rows, size);
    std::vector<double> alone, alone_statistics;
    for (const Index ranks : {1, 2, 3, 4}) {
      CAPTURE(ranks);
      run_processes(ranks, [&](const ThreadProcess& process) {
        const ml::AnyCommunicator c(process);
        ml::PartThreads threads;
        auto net = norms();
        const auto sum = ml::sum_of_meeting_parts<double>(c, parts, threads, [&](Index i, const ml::BatchSums& sums) {
          return loss_and_gradients(net, ml::batch_part(i, rows, size), {.sums = &sums});
        });
        ml::tensors_of_first<A>(c, ml::untrained<A>(ml::tensors_of(net)));
        const auto statistics = statistics_of(net);
        if (ranks == 1) alone = sum, alone_statistics = statistics;
        CHECK(sum == alone);  // the same bits in all processes
        CHECK(statistics == alone_statistics);
      });
    }
    // The gradients' marks are sums of one for each part.
    const std::size_t reached = 1 + 6;
    CHECK(std::all_of(alone.begin() + 1, alone.begin() + reached,
                      [&](double n) { return n == static_cast<double>(parts); }));
    std::fill(alone.begin() + 1, alone.begin() + reached, 1.0);
    CHECK(worst(alone, expected) < 1e-9);
    CHECK(worst(alone_statistics, statistics_of(whole)) < 1e-12);
    if (size == rows) CHECK(alone == expected);
  }
}

TEST_CASE("without sums, statistics of parts are those of the parts") {
  auto whole = norms(), apart = norms();
  const auto expected = loss_and_gradients(whole, {0, rows});
  const auto first = loss_and_gradients(apart, {0, 5}), second = loss_and_gradients(apart, {5, rows});
  CHECK(std::abs(first[0] + second[0] - expected[0]) > 0.01);  // so this test can fail
}

TEST_CASE("a sum over parts is differentiated over parts, and counts") {
  for (const Index ranks : {1, 2, 3}) {
    run_processes(ranks, [&](const ThreadProcess& process) {
      ml::PartThreads threads;
      // L_k = (k + 1) (s_1 + s_2)^2 with s = (1, 2): each s has the derivative 2 (1 + 2) 3.
      const auto of_part = [&](Index k, const ml::BatchSums& sums) {
        const auto s = ml::variable<A>(ml::Tensor<B, 1>::full({1}, static_cast<double>(k + 1)));
        double count = 5;
        const auto all = ml::sum_over_parts(s, sums, &count);
        CHECK(all.at(0) == 3);
        CHECK(count == 10);
        CHECK(ml::sum_over_parts(ml::value_of(s), sums).at(0) == 3);
        const auto gradients = ml::backward(ml::sum(ml::square(all)) * static_cast<double>(k + 1));
        CHECK(gradients[s].at(0) == 18);
        return std::vector<double>{1};
      };
      const auto sum = ml::sum_of_meeting_parts<double>(ml::AnyCommunicator(process), 2, threads, of_part);
      CHECK(sum == std::vector<double>{2});
    });
  }
}

TEST_CASE("parts that never meet are added, and one part of a process keeps what its parts share") {
  for (const Index ranks : {1, 2, 4, 6}) {
    CAPTURE(ranks);
    run_processes(ranks, [&](const ThreadProcess& process) {
      ml::PartThreads threads;
      Index keep = 0;
      const auto sum = ml::sum_of_meeting_parts<float>(ml::AnyCommunicator(process), 5, threads,
                                                       [&](Index i, const ml::BatchSums& sums) {
                                                         keep += sums.keeps_statistics() ? 1 : 0;
                                                         return std::vector<float>{static_cast<float>(i), 1};
                                                       });
      CHECK(sum == std::vector<float>{10, 5});
      CHECK(keep == (ranks == 6 && process.rank() == 5 ? 0 : 1));
    });
  }
}

TEST_CASE("an error in a part, unequal meetings and sums of other sizes end all parts") {
  struct Alive {
    Index& count;
    explicit Alive(Index& n) : count(n) { ++count; }
    ~Alive() { --count; }
  };
  ml::PartThreads threads;
  Index alive = 0;
  /// Part i meets meetings[i] times with sizes[i] numbers, and then fails if `failing` is its number.
  const auto run = [&](const std::vector<int>& meetings, const std::vector<std::size_t>& sizes, Index failing = -1) {
    const auto of_part = [&](Index i, const ml::BatchSums& sums) {
      const Alive object(alive);
      std::vector<double> numbers(sizes[static_cast<std::size_t>(i)], 1.0);
      for (int m = 0; m < meetings[static_cast<std::size_t>(i)]; ++m) sums.add(numbers);
      if (i == failing) throw std::runtime_error("part " + std::to_string(i));
      return numbers;
    };
    return ml::sum_of_meeting_parts<double>({}, std::ssize(meetings), threads, of_part);
  };
  for (const Index failing : {0, 1, 2}) {
    CHECK_THROWS_WITH_AS(run({2, 2, 2}, {1, 1, 1}, failing), ("part " + std::to_string(failing)).c_str(),
                         std::runtime_error);
    CHECK(alive == 0);
  }
  const char* waits = "[motionlang.config.102] a part of a batch waits for sums of parts that have ended";
  CHECK_ERROR(run({1, 2, 1}, {1, 1, 1}), waits);
  CHECK_ERROR(run({2, 2, 1}, {1, 1, 1}), waits);
  CHECK_ERROR(run({1, 1, 1}, {1, 1, 2}), "[motionlang.shape.204]");
  CHECK(alive == 0);
  CHECK(run({1, 1, 1}, {1, 1, 1}) == std::vector<double>{9});  // the threads work again
}

TEST_CASE("when a part of another process fails, the parts of this one end, too") {
  for (const Index failing : {0, 3}) {
    std::vector<int> left(2);
    const auto run = [&] {
      run_processes(2, [&](const ThreadProcess& process) {
        ml::PartThreads threads;
        struct Left {
          int& count;
          ~Left() { ++count; }
        };
        const auto of_part = [&](Index i, const ml::BatchSums& sums) {
          const Left object{left[static_cast<std::size_t>(process.rank())]};
          std::vector<double> numbers{1};
          sums.add(numbers);
          if (i == failing) throw std::runtime_error("a part");
          sums.add(numbers);
          return numbers;
        };
        ml::sum_of_meeting_parts<double>(ml::AnyCommunicator(process), 4, threads, of_part);
      });
    };
    CHECK_THROWS_WITH_AS(run(), "a part", std::runtime_error);
    CHECK(left == std::vector<int>{2, 2});
  }
}
