// Large memory: all of it can be used, it begins where vectors want it to, and what is not used is not taken.
#include <doctest/doctest.h>

#include <cstdint>
#include <fstream>
#include <numeric>
#include <string>

#include <motionlang/core/large_memory.hpp>

namespace ml = motionlang;

namespace {

constexpr std::size_t page = std::size_t{2} << 20;
#if defined(__linux__)
constexpr std::size_t large_alignment = page;

/// Bytes of this program that lie in memory.
std::size_t resident() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, pages = 0;
  file >> all >> pages;
  return pages * 4096;
}
#else
constexpr std::size_t large_alignment = 64;
#endif

}  // namespace

TEST_CASE("large_table: every number can be written and read, for small and large tables, borders of pages included") {
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, std::size_t{1000}, page / 2 - 1, page / 2, 3 * page / 2 + 5}) {
    const auto table = ml::large_table<std::uint16_t>(count);
    CHECK(reinterpret_cast<std::uintptr_t>(table.get()) % (2 * count < page ? 64 : large_alignment) == 0);
    std::iota(table.get(), table.get() + count, std::uint16_t{7});
    bool same = true;
    for (std::size_t i = 0; i < count; ++i)
      same = same && table[static_cast<std::ptrdiff_t>(i)] == static_cast<std::uint16_t>(i + 7);
    CHECK(same);
  }
}

#if defined(__linux__)
TEST_CASE("take_memory: what is not used is not taken; given back, nothing is left") {
  const std::size_t before = resident(), bytes = 64 * page, used = 10 * page + page / 2;
  auto* memory = static_cast<std::byte*>(ml::take_memory(bytes, used));
  for (std::size_t i = 0; i < used; ++i) memory[i] = std::byte{1};
  CHECK(resident() - before >= used);
  CHECK(resident() - before < used + page / 4);
  ml::give_memory(memory, bytes);
  CHECK(resident() < before + page / 4);
}
#endif
