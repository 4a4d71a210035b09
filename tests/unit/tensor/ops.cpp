// Operations of tensors: broadcasting, axes, what is refused. Their numbers are checked by tests/ops and tests/laws.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
template <int R>
using Tensor = ml::Tensor<B, R>;
using Values = std::vector<double>;

TEST_CASE("binary operations broadcast, and the larger rank wins") {
  const auto matrix = Tensor<2>::from({1, 2, 3, 4}, {2, 2});
  const auto row = Tensor<1>::from({10, 20}, {2});
  CHECK((matrix + row).to_vector() == Values{11, 22, 13, 24});
  CHECK((row - matrix).to_vector() == Values{9, 18, 7, 16});
  static_assert(std::is_same_v<decltype(row * matrix), Tensor<2>>);
  CHECK((2.0 / row).to_vector() == Values{0.2, 0.1});
  CHECK((1.0 - row).to_vector() == Values{-9, -19});
  CHECK((-row).to_vector() == Values{-10, -20});
  CHECK(ml::abs(1.0 - row).to_vector() == Values{9, 19});
  CHECK_ERROR(matrix + Tensor<1>::zeros({3}), "[motionlang.shape.202] operator+: shapes do not broadcast: lhs (2, 2)");
  CHECK_ERROR(ml::where_less(matrix, matrix, matrix, Tensor<2>::zeros({3, 2})), "[motionlang.shape.202] where_less");
}

TEST_CASE("arithmetic on many numbers, which several threads share") {
  constexpr ml::Index rows = 301, width = 203;
  Values m(rows * width), r(width), c(rows);
  for (std::size_t i = 0; i < m.size(); ++i) m[i] = static_cast<double>(i % 1013) - 500;
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = static_cast<double>(i) + 0.25;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = 0.5 - static_cast<double>(i);
  const auto matrix = Tensor<2>::from(m, {rows, width}), column = Tensor<2>::from(c, {rows, 1});
  const auto row = Tensor<1>::from(r, {width});
  Values expected[6];
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double of_row = r[i % width], of_column = c[i / width];
    const double values[] = {m[i] - m[m.size() - 1 - i], m[i] * of_row,      of_column - m[i],
                             3 / (m[i] + 0.5),           of_column + of_row, m[i] < of_row ? m[i] : of_column};
    for (std::size_t k = 0; k < 6; ++k) expected[k].push_back(values[k]);
  }
  const auto turned = Tensor<2>::from(Values(m.rbegin(), m.rend()), {rows, width});
  CHECK((matrix - turned).to_vector() == expected[0]);
  CHECK((matrix * row).to_vector() == expected[1]);
  CHECK((column - matrix).to_vector() == expected[2]);
  CHECK((3.0 / (matrix + 0.5)).to_vector() == expected[3]);
  CHECK((column + row).to_vector() == expected[4]);
  CHECK(ml::where_less(matrix, ml::broadcast_to<2>(row, {rows, width}), matrix, column).to_vector() == expected[5]);
}

TEST_CASE("axes count from either end") {
  const auto t = Tensor<2>::from({1, 2, 3, 4, 5, 6}, {2, 3});
  CHECK(ml::sum(t, 0).to_vector() == Values{5, 7, 9});
  CHECK(ml::sum(t, -1).to_vector() == Values{6, 15});
  CHECK(ml::max(t, -2).to_vector() == Values{4, 5, 6});
  CHECK(ml::mean(t, 1).to_vector() == Values{2, 5});
  CHECK(ml::sum(t).item() == 21);
  CHECK(ml::mean(t).item() == 3.5);
  CHECK_ERROR(ml::sum(t, 2), "[motionlang.shape.203] sum: axis 2 of a tensor of rank 2");
  CHECK_ERROR(ml::max(t, -3), "[motionlang.shape.203]");
}

TEST_CASE("empty tensors: a sum is 0, a maximum is minus infinity, a product over nothing is 0") {
  const auto empty = Tensor<2>::zeros({2, 0});
  CHECK(ml::sum(empty, 1).to_vector() == Values{0, 0});
  CHECK(ml::max(empty, 1).to_vector() == Values(2, -HUGE_VAL));
  CHECK(ml::sum(empty).item() == 0);
  CHECK(ml::matmul(empty, Tensor<2>::zeros({0, 3})).to_vector() == Values(6, 0));
  CHECK((empty + 1.0).count() == 0);
}

TEST_CASE("products are refused with both shapes") {
  const auto a = Tensor<3>::zeros({2, 3, 4});
  CHECK_ERROR(ml::matmul(a, Tensor<3>::zeros({2, 5, 6})),
              "[motionlang.shape.201] matmul: inner sizes differ: lhs (2, 3, 4), rhs (2, 5, 6)");
  CHECK_ERROR(ml::matmul(a, Tensor<3>::zeros({2, 4, 6}), {.transpose_b = true}),
              "lhs (2, 3, 4), rhs (2, 4, 6) transposed");
  CHECK_ERROR(ml::matmul(a, Tensor<3>::zeros({1, 4, 6})), "[motionlang.shape.204] matmul: leading sizes differ");
}

TEST_CASE("reshape computes one size") {
  const auto t = Tensor<1>::zeros({12});
  CHECK(ml::reshape<2>(t, {3, -1}).shape() == ml::Shape{3, 4});
  CHECK(ml::reshape<3>(t, {-1, 2, 3}).shape() == ml::Shape{2, 2, 3});
  CHECK(ml::reshape<2>(Tensor<1>::zeros({0}), {0, -1}).shape() == ml::Shape{0, 0});
  CHECK_ERROR(ml::reshape<2>(t, {5, -1}), "[motionlang.shape.205] reshape: shape (12) cannot become (5, 2)");
  CHECK_ERROR(ml::reshape<1>(t, {11}), "[motionlang.shape.205]");
}

TEST_CASE("numbers are moved where they belong, and nowhere else") {
  const auto t = Tensor<2>::from({0, 1, 2, 10, 11, 12}, {2, 3});
  CHECK(ml::transpose(t).to_vector() == Values{0, 10, 1, 11, 2, 12});
  CHECK(ml::slice(t, -1, 1, 3).to_vector() == Values{1, 2, 11, 12});
  CHECK(ml::slice(t, 0, 1, 1).shape() == ml::Shape{0, 3});
  const auto all = ml::slice(t, 1, 0, 3);
  CHECK(all.span().data() == t.span().data());  // all of an axis: no copy
  CHECK(ml::concat(1, t, t).shape() == ml::Shape{2, 6});
  const std::vector<ml::Index> rows{1, 1, 0};
  CHECK(ml::gather(t, rows).to_vector() == Values{10, 11, 12, 10, 11, 12, 0, 1, 2});
  CHECK(ml::scatter_add(Tensor<1>::from({1, 2, 4}, {3}), rows, 4).to_vector() == Values{4, 3, 0, 0});
  CHECK(ml::broadcast_to<2>(Tensor<1>::from({1, 2}, {2}), {2, 2}).to_vector() == Values{1, 2, 1, 2});

  const std::vector<ml::Index> beyond{2};
  CHECK_ERROR(ml::gather(t, beyond), "[motionlang.shape.203] gather: row 2 of 2");
  CHECK_ERROR(ml::scatter_add(t, beyond, 2), "[motionlang.shape.204] scatter_add: 1 rows for shape (2, 3)");
  CHECK_ERROR(ml::scatter_add(ml::slice(t, 0, 0, 1), beyond, 2), "[motionlang.shape.203] scatter_add");
  CHECK_ERROR(ml::slice(t, 1, 2, 1), "[motionlang.shape.203] slice: 2 ... 1 of axis 1 of (2, 3)");
  CHECK_ERROR(ml::slice(t, 1, 0, 4), "[motionlang.shape.203]");
  CHECK_ERROR(ml::slice(t, 2, 0, 1), "[motionlang.shape.203]");
  CHECK(ml::permute(t, {0, -1}).to_vector() == t.to_vector());
  CHECK(ml::permute(t, {-1, 0}).to_vector() == ml::transpose(t).to_vector());
  CHECK_ERROR(ml::permute(t, {0, 0}), "[motionlang.shape.203] permute: every axis must occur once");
  CHECK_ERROR(ml::concat(0, t, Tensor<2>::zeros({2, 2})), "[motionlang.shape.204] concat along axis 0");
  CHECK_ERROR(ml::concat(std::span<const Tensor<2>>(), 0), "[motionlang.shape.205]");
  CHECK_ERROR(ml::broadcast_to<2>(t, {2, 1}), "[motionlang.shape.202]");
}
