// Memory for large tables: all of it can be used, and it begins where vectors want it to.
#include <doctest/doctest.h>

#include <cstdint>
#include <numeric>

#include <motionlang/core/large_table.hpp>

namespace ml = motionlang;

TEST_CASE("large_table: every number can be written and read, for small and large tables, borders of pages included") {
  constexpr std::size_t page = std::size_t{2} << 20;
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, std::size_t{1000}, page / 2 - 1, page / 2, 3 * page / 2 + 5}) {
    const auto table = ml::large_table<std::uint16_t>(count);
    CHECK(reinterpret_cast<std::uintptr_t>(table.get()) % (2 * count < page ? 64 : page) == 0);
    std::iota(table.get(), table.get() + count, std::uint16_t{7});
    bool same = true;
    for (std::size_t i = 0; i < count; ++i)
      same = same && table[static_cast<std::ptrdiff_t>(i)] == static_cast<std::uint16_t>(i + 7);
    CHECK(same);
  }
}
