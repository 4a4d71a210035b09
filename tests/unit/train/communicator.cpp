// Processes that train together: messages, answers of the first, and the sum of parts in a fixed tree.
#include <motionlang/train/communicator.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <motionlang/backend/usual.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/compared_parts.hpp>
#include <motionlang/train/mpi.hpp>

#include "../../support/check_error.hpp"
#include "../../support/thread_processes.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<B>;
using ml::Index;

TEST_CASE("one process has nobody to send to, and answers itself") {
  const ml::AnyCommunicator alone;
  CHECK((alone.rank() == 0 && alone.size() == 1));
  CHECK(ml::text_of_first(alone, "text") == "text");
  CHECK(ml::answer_of_first(alone, true));
  CHECK_FALSE(ml::answer_of_first(alone, false));
  CHECK(ml::first_other_text(alone, "text") == -1);
  CHECK_NOTHROW(alone.barrier());
  std::byte message[1]{};
  CHECK_ERROR(alone.send(message, 1), "[motionlang.config.101] OneProcess: there is no rank 1");
  CHECK_ERROR(alone.receive(message, 2), "there is no rank 2");
  CHECK_ERROR(alone.exchange(message, message, 3), "there is no rank 3");
  CHECK_FALSE(alone.arrived(1));
}

TEST_CASE("a message has arrived once it is sent, until it is received") {
  run_processes(2, [&](const ThreadProcess& process) {
    const ml::AnyCommunicator c(process);
    std::byte message[3]{};
    CHECK_FALSE(c.arrived(1 - c.rank()));
    c.barrier();
    if (c.rank() == 1) c.send(message, 0);
    c.barrier();  // behind the message
    if (c.rank() == 1) return;
    CHECK(c.arrived(1));
    CHECK(c.arrived(1));
    c.receive(message, 1);
    CHECK_FALSE(c.arrived(1));
  });
}

TEST_CASE("all have the text and the answer of the first, and find the first who differs") {
  for (const Index size : {2, 4}) {
    std::vector<std::string> texts(4);
    std::vector<int> answers(4), same(4), different(4);
    std::vector<std::vector<std::string>> lines(4);
    run_processes(size, [&](const ThreadProcess& process) {
      const ml::AnyCommunicator c(process);
      const auto r = static_cast<std::size_t>(c.rank());
      texts[r] = ml::text_of_first(c, r == 0 ? "long text" : std::string(r, 'x'));
      lines[r] = ml::lines_of_first(c, r == 0 ? std::vector<std::string>{"a b", "c"} : std::vector<std::string>{});
      answers[r] = ml::answer_of_first(c, r == 0) && !ml::answer_of_first(c, r != 0);
      same[r] = static_cast<int>(ml::first_other_text(c, "equal"));
      different[r] = static_cast<int>(ml::first_other_text(c, r + 1 == static_cast<std::size_t>(size) ? "x" : "equal"));
    });
    for (std::size_t r = 0; r < static_cast<std::size_t>(size); ++r) {
      CHECK(texts[r] == "long text");
      CHECK(lines[r] == std::vector<std::string>{"a b", "c"});
      CHECK(answers[r] == 1);
      CHECK(same[r] == -1);
      CHECK(different[r] == size - 1);
    }
  }
}

TEST_CASE("parts have equal sizes but the last, and each belongs to one rank") {
  CHECK(ml::part_count(10, 4) == 3);
  CHECK(ml::batch_part(2, 10, 4).first == 8);
  CHECK(ml::batch_part(2, 10, 4).last == 10);
  CHECK(ml::batch_part(2, 10, 4).share(10) == 0.2);
  const std::vector<Index> frames{1, 1, 2, 4};
  CHECK(ml::BatchPart{2, 4}.share(std::span<const Index>(frames)) == 0.75);
  CHECK(ml::BatchPart{0, 4}.share(std::span<const Index>(frames)) == 1);
  for (Index parts = 1; parts < 12; ++parts) {
    for (Index ranks = 1; ranks < 9; ++ranks) {
      std::vector<Index> counts(static_cast<std::size_t>(ranks));
      Index before = 0;
      for (Index i = 0; i < parts; ++i) {
        const Index rank = ml::rank_of_part(i, parts, ranks);
        CHECK((rank >= before && rank < ranks));
        ++counts[static_cast<std::size_t>(before = rank)];
      }
      CHECK(ml::rank_of_part(0, parts, ranks) == 0);
      const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
      CHECK(*most - *least <= 1);
    }
  }
}

namespace {

/// Numbers whose sum depends on the order.
std::vector<float> part(Index i) {
  ml::Philox rng = ml::Philox{.seed = 3}.split(static_cast<std::uint64_t>(i));
  std::vector<float> out(501);
  rng.normal(std::span(out));
  for (float& x : out) x *= std::pow(10.0f, static_cast<float>(i % 5));
  return out;
}

}  // namespace

TEST_CASE("the sum of parts is that of a fixed tree, with the same bits in any number of processes") {
  std::vector<float> tree = part(0);  // ((0 + 1) + (2 + 3)) + ((4 + 5) + 6)
  for (std::size_t k = 0; k < tree.size(); ++k) {
    const auto p = [&](Index i) { return part(i)[k]; };
    tree[k] = ((p(0) + p(1)) + (p(2) + p(3))) + ((p(4) + p(5)) + p(6));
  }
  std::vector<float> in_order = part(0);
  for (Index i = 1; i < 7; ++i) {
    for (std::size_t k = 0; k < in_order.size(); ++k) in_order[k] += part(i)[k];
  }
  CHECK(in_order != tree);  // so this test can fail
  for (const Index ranks : {1, 2, 3, 4, 5, 7, 9}) {
    CAPTURE(ranks);
    std::vector<float> sum;
    std::vector<Index> computed(static_cast<std::size_t>(ranks));
    run_processes(ranks, [&](const ThreadProcess& process) {
      auto own = ml::sum_of_parts<float>(ml::AnyCommunicator(process), 7, [&](Index i) {
        ++computed[static_cast<std::size_t>(process.rank())];
        return part(i);
      });
      if (process.rank() == 0) sum = std::move(own);
    });
    CHECK(sum == tree);
    CHECK(std::accumulate(computed.begin(), computed.end(), Index{0}) == 7);
  }
}

TEST_CASE("four ranks with eight parts send one sum each") {
  std::vector<Index> messages(4);
  run_processes(4, [&](const ThreadProcess& process) {
    ml::sum_of_parts<float>(ml::AnyCommunicator(process), 8, [](Index) { return std::vector<float>(3, 1.0f); });
    messages[static_cast<std::size_t>(process.rank())] = process.messages();
  });
  CHECK(messages == std::vector<Index>{0, 1, 1, 1});
  CHECK_ERROR(
      ml::sum_of_parts<float>({}, 2, [](Index i) { return std::vector<float>(static_cast<std::size_t>(i + 1)); }),
      "[motionlang.shape.204]");
}

TEST_CASE("sums of other sizes in another process are refused, longer and shorter ones, in both ways of adding") {
  for (const Index parts : {3, 4}) {  // without powers of two, and with
    for (const Index more : {-1, 0, 1}) {
      CAPTURE(parts);
      CAPTURE(more);
      const auto sum = [&](const auto& add) {
        run_processes(2, [&](const ThreadProcess& process) {
          const std::vector<float> own(static_cast<std::size_t>(process.rank() == 1 ? 5 + more : 5), 1.0f);
          add(ml::AnyCommunicator(process), [&](Index) { return own; });
        });
      };
      const auto parts_only = [&](const ml::AnyCommunicator& c, const auto& f) {
        ml::sum_of_parts<float>(c, parts, f);
      };
      const auto for_all = [&](const ml::AnyCommunicator& c, const auto& f) { ml::sum_for_all<float>(c, parts, f); };
      if (more == 0) {
        CHECK_NOTHROW(sum(parts_only));
        CHECK_NOTHROW(sum(for_all));
      } else {
        CHECK_ERROR(sum(parts_only), "[motionlang.shape.204]");
        CHECK_ERROR(sum(for_all), "[motionlang.shape.204]");
      }
    }
  }
}

TEST_CASE("all processes have the sum of parts, with the bits of one process") {
  for (const Index parts : {1, 4, 7, 8, 16}) {
    const auto alone = ml::sum_of_parts<float>({}, parts, part);
    for (const Index ranks : {1, 2, 3, 4, 8, 9}) {
      CAPTURE(parts);
      CAPTURE(ranks);
      run_processes(ranks, [&](const ThreadProcess& process) {
        CHECK(ml::sum_for_all<float>(ml::AnyCommunicator(process), parts, part) == alone);
      });
    }
  }
}

TEST_CASE("with powers of two, each process sends half of the sum, a quarter, and so on, twice") {
  std::vector<Index> messages(8), bytes(8);
  run_processes(8, [&](const ThreadProcess& process) {
    ml::sum_for_all<float>(ml::AnyCommunicator(process), 8, [](Index) { return std::vector<float>(800, 1.0f); });
    messages[static_cast<std::size_t>(process.rank())] = process.messages();
    bytes[static_cast<std::size_t>(process.rank())] = process.bytes();
  });
  CHECK(messages == std::vector<Index>(8, 6));
  CHECK(bytes == std::vector<Index>(8, 2 * 4 * (400 + 200 + 100)));
}

TEST_CASE(
    "sums as bfloat16: all processes have the same, near the exact ones, in half the bytes; the first are exact") {
  for (const Index parts : {7, 8}) {  // with powers of two, and without
    const auto exact = ml::sum_of_parts<float>({}, parts, part);
    for (const Index ranks : {2, 4}) {
      CAPTURE(parts);
      CAPTURE(ranks);
      std::vector<std::vector<float>> sums(static_cast<std::size_t>(ranks));
      run_processes(ranks, [&](const ThreadProcess& process) {
        ml::SumMessages how{.bf16 = true};
        const auto compute = [&](Index i) {
          how.exact = 21;
          return part(i);
        };
        sums[static_cast<std::size_t>(process.rank())] =
            ml::sum_for_all<float>(ml::AnyCommunicator(process), parts, compute, how);
      });
      for (const auto& sum : sums) CHECK(sum == sums.front());
      REQUIRE(sums.front().size() == exact.size());
      double error = 0, size = 0;
      for (std::size_t i = 0; i < exact.size(); ++i) {
        if (i < 21) CHECK(sums.front()[i] == exact[i]);
        error += std::abs(static_cast<double>(sums.front()[i]) - static_cast<double>(exact[i]));
        size += std::abs(static_cast<double>(exact[i]));
      }
      CHECK(error > 0);
      CHECK(error < 0.01 * size);
    }
  }
  std::vector<Index> bytes(2);
  run_processes(2, [&](const ThreadProcess& process) {
    ml::sum_for_all<float>(ml::AnyCommunicator(process), 2, part, {.bf16 = true});
    bytes[static_cast<std::size_t>(process.rank())] = process.bytes();
  });
  CHECK(bytes == std::vector<Index>{2 * 501, 2 * 501});
}

TEST_CASE("rows of a part are those that the whole batch draws") {
  for (const Index width : {1, 3, 8}) {
    auto rng = ml::Philox{.seed = 9};
    const auto whole = ml::Tensor<B, 2>::randn({11, width}, rng).to_vector();
    for (Index first = 0; first < 11; ++first) {
      const Index rows = std::min<Index>(3, 11 - first);
      const auto part = ml::normal_rows<B>(first, rows, width, ml::Philox{.seed = 9}).to_vector();
      CHECK(part == std::vector<float>(whole.begin() + first * width, whole.begin() + (first + rows) * width));
    }
  }
}

TEST_CASE("gradients become a list and return from it; parameters that no loss reaches have none") {
  ml::Philox rng{.seed = 1};
  auto used = ml::convert<A>(ml::Linear<B>(2, 3, rng)), unused = ml::convert<A>(ml::Linear<B>(2, 1, rng));
  auto parameters = ml::tensors_of(used);
  for (auto& t : ml::tensors_of(unused)) parameters.push_back(t);
  const auto x = ml::Tensor<A, 2>::randn({4, 2}, rng);
  const auto gradients = ml::backward(ml::mean(ml::square(used(x))));
  std::vector<float> list;
  ml::append_gradients<A>(list, parameters, gradients);
  CHECK(list.size() == ml::gradient_list_size<A>(parameters));
  CHECK(std::vector<float>(list.begin(), list.begin() + 4) == std::vector<float>{1, 1, 0, 0});
  const auto back = ml::listed_gradients<A>(std::span<const float>(list), parameters);
  CHECK(back[used.weight].to_vector() == gradients[used.weight].to_vector());
  CHECK(back.find(unused.weight.data()) == nullptr);
  CHECK_ERROR(ml::listed_gradients<A>(std::span<const float>(list).first(5), parameters), "[motionlang.shape.205]");
}

TEST_CASE("gradients are added to a list, and a loss gets other weights") {
  ml::Philox rng{.seed = 2};
  auto model = ml::convert<A>(ml::Linear<B>(2, 1, rng));
  const auto parameters = ml::tensors_of(model);
  const auto x = ml::Tensor<A, 2>::from({1, 2, 3, 4}, {2, 2});
  const auto gradients = ml::backward(ml::sum(model(x)));
  std::vector<float> list, twice;
  ml::append_gradients<A>(list, parameters, gradients);
  twice = list;
  ml::add_gradients<A>(twice, parameters, gradients);
  for (std::size_t i = 0; i < list.size(); ++i) CHECK(twice[i] == 2 * list[i]);
  ml::LossTerms<B> terms;
  terms.add("a", 3, ml::Tensor<B, 0>(2.0));
  CHECK(ml::weighted(terms, 0.5).total().item() == 3);
}

TEST_CASE("all have the numbers of the first, however many there are") {
  run_processes(3, [](const ThreadProcess& process) {
    std::vector<float> numbers(static_cast<std::size_t>(3 - process.rank()), static_cast<float>(process.rank()));
    ml::numbers_of_first(ml::AnyCommunicator(process), numbers);
    CHECK(numbers == std::vector<float>{0, 0, 0});
  });
}

TEST_CASE("rows of all parts are compared, and a part gets the gradient that passes through its own") {
  // The loss is the square of the sum of all rows, so that each row gets twice that sum.
  const auto part = [](std::vector<float> values, Index first) {
    const Index rows = std::ssize(values) / 2;
    ml::ComparedPart<A> out;
    out.compared.push_back({ml::variable<A>(ml::Tensor<B, 2>::from(values, {rows, 2})), 2, first, 3});
    out.compared.push_back({{}, 1, 0, 1});  // another part has this row
    return out;
  };
  const auto one = part({1, 2, 3, 4}, 0), two = part({5, 6}, 2);
  const auto first = ml::rows_in_place(one), second = ml::rows_in_place(two);
  CHECK(first == std::vector<float>{1, 2, 3, 4, 0, 0, 0});
  CHECK(second == std::vector<float>{0, 0, 0, 0, 5, 6, 0});
  std::vector<float> all;
  for (std::size_t i = 0; i < first.size(); ++i) all.push_back(first[i] + second[i]);
  const auto rows = ml::compared_variables<A>(all, one);
  CHECK((rows.size() == 2 && rows[0].shape() == ml::Shape{3, 2} && rows[1].shape() == ml::Shape{1, 1}));
  const auto gradients = ml::backward(ml::square(ml::sum(rows[0])));
  const auto through = ml::backward(ml::through_rows(two, rows, gradients));
  CHECK(through[two.compared[0].rows].to_vector() == std::vector<float>{42, 42});
  CHECK_ERROR(ml::compared_variables<A>(std::span(all).first(6), one),
              "[motionlang.shape.205] compared_variables: 6 numbers, the rows of a batch are 7");
}

TEST_CASE("the environment has the number of processes that were started together") {
  const std::array names{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"};
  for (const char* name : names) ::unsetenv(name);
  CHECK(ml::started_processes() == 1);
  ::setenv("SLURM_STEP_NUM_TASKS", "2", 1);
  CHECK(ml::started_processes() == 2);
  ::setenv("OMPI_COMM_WORLD_SIZE", "8", 1);  // mpirun, which Slurm started
  CHECK(ml::started_processes() == 8);
  ::setenv("OMPI_COMM_WORLD_SIZE", "none", 1);
  CHECK(ml::started_processes() == 1);
  for (const char* name : names) ::unsetenv(name);
}

TEST_CASE("the kernels of this process have a name") {
  const std::vector<std::string> names{"portable", "avx2", "avx512", "avx512_bf16", "amx"};
  CHECK(std::find(names.begin(), names.end(), ml::kernels_in_use()) != names.end());
}
