// Limits on the memory that reading a file may take.
#include <doctest/doctest.h>

#include <motionlang/file/tensor_memory.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("a file may cost as much as it is large, and 12 MiB") {
  constexpr std::uint64_t extra = std::uint64_t{12} << 20;
  ml::TensorMemory memory(nullptr, 100, "small.pt");
  CHECK(memory.left() == extra + 100);
  memory.spend(extra);
  CHECK(memory.left() == 100);
  CHECK_ERROR(memory.spend(101), "[motionlang.io.405] small.pt");
  memory.allow(50);
  memory.spend(150);
  CHECK(memory.left() == 0);
}

TEST_CASE("what is kept stays where it is") {
  ml::TensorMemory memory(nullptr, 0, "a");
  const std::string& first = memory.keep(std::string("first"));
  for (int i = 0; i < 100; ++i) memory.keep(std::vector<int>(100, i));
  CHECK(first == "first");
}
