// printf into a string of the right length.
#include <doctest/doctest.h>

#include <motionlang/core/formatted.hpp>

namespace ml = motionlang;

TEST_CASE("formatted text has the length that its values need") {
  CHECK(ml::formatted("nothing to fill in") == "nothing to fill in");
  CHECK(ml::formatted("%-6s|%5.2f|%3d %%", "ab", 1.005, 7) == "ab    | 1.00|  7 %");
  const std::string longer(5000, 'x');
  CHECK(ml::formatted("%s.", longer.c_str()) == longer + ".");
  CHECK(ml::formatted("%s", "").empty());
}
