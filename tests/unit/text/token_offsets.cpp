#include <motionlang/text/token_offsets.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("offsets of tokens are those of the lengths, which have to be those of the ids") {
  const ml::Offsets offsets = ml::token_offsets({.ids = {7, 8, 9, 7, 9}, .lengths = {3, 0, 2}});
  CHECK(offsets == ml::Offsets{3, 0, 2});
  CHECK(ml::token_offsets({}).count() == 0);
  CHECK_ERROR(ml::token_offsets({.ids = {7, 8}, .lengths = {3}}),
              "[motionlang.shape.207] TokenBatch: lengths of 3 ids");
}
