// Packed sequences of symbols, and the largest number of a row.
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/arg_max.hpp>
#include <motionlang/tensor/id_sequences.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::ReferenceBackend<double>;

TEST_CASE("IdSequences: padding is left out, ends are taken off") {
  const std::vector<Index> padded{5, 1, 2, 9, 7, 9, 9, 9};
  const auto x = ml::IdSequences::from_padded(padded, 4, 9);
  CHECK(x.offsets == Offsets{3, 1});
  CHECK(x.ids == std::vector<Index>{5, 1, 2, 7});
  const auto inner = x.without_ends(1, 0);
  CHECK(inner.ids == std::vector<Index>{1, 2});
  CHECK(inner.offsets == Offsets{2, 0});
  CHECK(x.without_ends(0, 1).ids == std::vector<Index>{5, 1});
  CHECK_ERROR(x.without_ends(1, 1), "[motionlang.shape.207]");
  CHECK_ERROR(ml::IdSequences::from_padded(padded, 3, 9), "[motionlang.shape.205]");
  CHECK_ERROR(ml::IdSequences({1, 2}, Offsets{1}), "[motionlang.shape.207]");
  CHECK(ml::IdSequences().count() == 0);
}

TEST_CASE("arg_max: of equals the first") {
  CHECK(ml::arg_max(ml::Tensor<B, 2>::from({1, 3, 3, -1, -2, -1}, {2, 3})) == std::vector<Index>{1, 0});
  CHECK_ERROR(ml::arg_max(ml::Tensor<B, 2>::zeros({2, 0})), "[motionlang.shape.205]");
}
