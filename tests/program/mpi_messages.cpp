// The communicator of MPI in several processes, as CTest starts them with mpirun: messages that arrive. Messages of
// another size are refused in every process that takes them, without a wait.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/meeting_parts.hpp>
#include <motionlang/train/mpi.hpp>

#include "../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

/// All processes. MPI begins once in the life of a program.
const ml::MpiCommunicator& all() {
  static const ml::MpiCommunicator mpi;
  return mpi;
}

std::vector<std::byte> message(std::size_t size) {
  std::vector<std::byte> out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::byte>(i % 251);
  return out;
}

// A short message leaves at once. MPI sends a long one only when it is taken.
constexpr std::size_t sizes[] = {16, std::size_t{4} << 20};

}  // namespace

TEST_CASE("a message has arrived once it is sent, until it is received") {
  const auto& c = all();
  REQUIRE(c.size() > 1);
  c.barrier();
  if (c.rank() == 0) CHECK_FALSE(c.arrived(1));
  c.barrier();
  if (c.rank() == 1) c.send(message(16), 0);
  if (c.rank() == 0) {
    while (!c.arrived(1)) {}
    std::vector<std::byte> taken(16);
    c.receive(taken, 1);
    CHECK(taken == message(16));
    CHECK_FALSE(c.arrived(1));
  }
  c.barrier();
}

TEST_CASE("the receiver refuses a message of another size, the sender goes on, and so does the next message") {
  const auto& c = all();
  for (const std::size_t size : sizes) {
    for (const std::size_t wanted : {size - 1, size + 1, std::size_t{0}}) {
      CAPTURE(size);
      CAPTURE(wanted);
      if (c.rank() == 1) {
        c.send(message(size), 0);
        c.send(message(size), 0);
      }
      if (c.rank() == 0) {
        std::vector<std::byte> taken(wanted, std::byte{7});
        const std::string why = ml::concat_text("[motionlang.shape.204] a message of ", size,
                                                " bytes from rank 1 where ", wanted, " are wanted");
        CHECK_ERROR(c.receive(taken, 1), why.c_str());
        CHECK(taken == std::vector<std::byte>(wanted, std::byte{7}));
        taken.resize(size);
        c.receive(taken, 1);
        CHECK(taken == message(size));
      }
    }
  }
  c.barrier();
}

TEST_CASE("both ranks of an exchange refuse messages of another size, and exchange the next ones") {
  const auto& c = all();
  for (const std::size_t size : sizes) {
    CAPTURE(size);
    if (c.rank() > 1) continue;
    const Index with = 1 - c.rank();
    const std::size_t given = size + static_cast<std::size_t>(c.rank());
    std::vector<std::byte> taken(given);
    const std::string why = ml::concat_text("[motionlang.shape.204] a message of ", c.rank() == 0 ? size + 1 : size,
                                            " bytes from rank ", with, " where ", given, " are wanted");
    CHECK_ERROR(c.exchange(message(given), taken, with), why.c_str());
    taken.resize(size);
    c.exchange(message(size), taken, with);
    CHECK(taken == message(size));
  }
  c.barrier();
}

TEST_CASE("sums of parts of another size are refused in all processes, if their numbers are powers of two") {
  const ml::AnyCommunicator c(all());
  if (c.size() != 2) return;
  const auto sum = [&](Index of_rank_1) {
    return ml::sum_for_all<float>(c, 4, [&](Index i) {
      return std::vector<float>(static_cast<std::size_t>(c.rank() == 1 ? of_rank_1 : 1000), static_cast<float>(i));
    });
  };
  CHECK(sum(1000) == std::vector<float>(1000, 6.0f));
  for (const Index other : {998, 1002}) {
    CAPTURE(other);
    CHECK_ERROR(sum(other), "[motionlang.shape.204] a message of ");
    CHECK(sum(1000) == std::vector<float>(1000, 6.0f));
  }
}

TEST_CASE("parts that meet have the sums of one process, also where ranks have no part") {
  for (const Index parts : {1, 2, 3, 8}) {
    CAPTURE(parts);
    const auto of_part = [](Index i, const ml::BatchSums& sums) {
      std::vector<double> numbers{0.1 * static_cast<double>(i + 1), 1 / static_cast<double>(i + 3)};
      for (int meeting = 0; meeting < 50; ++meeting) {
        sums.add(numbers);
        for (double& x : numbers) x = std::sin(x + static_cast<double>(i));
      }
      return numbers;
    };
    ml::PartThreads threads;
    const auto alone = ml::sum_of_meeting_parts<double>({}, parts, threads, of_part);
    CHECK(ml::sum_of_meeting_parts<double>(ml::AnyCommunicator(all()), parts, threads, of_part) == alone);
  }
}

TEST_CASE("where one rank adds, it refuses, and its abort ends the others, which wait for the sum" *
          doctest::skip(true)) {
  const ml::AnyCommunicator c(all());
  try {
    ml::sum_for_all<float>(c, 3, [&](Index i) { return std::vector<float>(static_cast<std::size_t>(10 + i)); });
  } catch (const ml::shape_error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    all().abort(3);
  }
}
