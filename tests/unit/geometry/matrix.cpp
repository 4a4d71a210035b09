#include <motionlang/geometry/matrix.hpp>

#include <doctest/doctest.h>

namespace ml = motionlang;
using M = ml::Matrix3<double>;
using V = ml::Vec3<double>;

namespace {

const M a = M::from_rows({1, 2, 3}, {4, 5, 6}, {7, 8, 10});
const M b = M::from_rows({0, 1, 0}, {2, 0, 1}, {1, 1, 1});
const M quarter = M::from_columns({0, 1, 0}, {-1, 0, 0}, {0, 0, 1});  // about z

}  // namespace

TEST_CASE("rows, columns and single numbers are the same matrix") {
  CHECK(a(0, 2) == 3);
  CHECK(a(2, 0) == 7);
  CHECK(a.row(1) == V{4, 5, 6});
  CHECK(a.column(1) == V{2, 5, 8});
  CHECK(M::from_columns(a.row(0), a.row(1), a.row(2)).m == ml::transpose(a).m);
  CHECK(ml::transpose(ml::transpose(a)).m == a.m);
  M c = M::identity();
  c(1, 2) = 5;
  CHECK(c.row(1) == V{0, 1, 5});
}

TEST_CASE("products by hand, and with vectors") {
  CHECK((a * b).m == M::from_rows({7, 4, 5}, {16, 10, 11}, {26, 17, 18}).m);
  CHECK((b * a).m != (a * b).m);
  CHECK((a * M::identity()).m == a.m);
  CHECK(a * V{1, 0, -1} == V{-2, -2, -3});
  CHECK((a * b) * V{1, 2, 3} == a * (b * V{1, 2, 3}));
  CHECK(ml::transpose(a * b).m == (ml::transpose(b) * ml::transpose(a)).m);
}

TEST_CASE("the inverse of a rotation turns back") {
  CHECK(quarter * V{1, 0, 0} == V{0, 1, 0});
  CHECK((ml::inverse(quarter) * quarter).m == M::identity().m);
  CHECK(ml::inverse(quarter) * V{0, 1, 0} == V{1, 0, 0});
  CHECK(ml::matrix_cast<float>(a).m == ml::Matrix3<float>::from_rows({1, 2, 3}, {4, 5, 6}, {7, 8, 10}).m);
}
