// Shapes: sizes, axes, broadcasting.
#include <doctest/doctest.h>

#include <vector>

#include <motionlang/core/activation.hpp>
#include <motionlang/core/shape.hpp>

namespace ml = motionlang;
using ml::Shape;

TEST_CASE("a shape knows its sizes and counts") {
  const Shape s{2, 60, 512};
  CHECK(s.rank() == 3);
  CHECK(s[1] == 60);
  CHECK(s.back() == 512);
  CHECK(s.count() == 2 * 60 * 512);
  CHECK(s.count(1, 2) == 60);
  CHECK(s.count(1, 1) == 1);
  CHECK(Shape{}.count() == 1);
  CHECK(Shape{3, 0, 2}.count() == 0);
  CHECK(s.without(1) == Shape{2, 512});
  CHECK(to_string(s) == "(2, 60, 512)");
  CHECK(to_string(Shape{}) == "()");
}

TEST_CASE("shapes are equal when rank and sizes are") {
  CHECK(Shape{1, 2} == Shape{1, 2});
  CHECK(Shape{1, 2} != Shape{2, 1});
  CHECK(Shape{} != Shape{1});
  CHECK(Shape{2} != Shape{2, 1});
  Shape longer{2, 3};
  const Shape shorter = longer.without(1);  // a stale size behind the rank must not count
  CHECK(shorter == Shape{2});
}

TEST_CASE("shapes that cannot be are refused") {
  CHECK_NOTHROW(Shape{1, 1, 1, 1, 1, 1});
  CHECK_THROWS_WITH_AS((Shape{1, 1, 1, 1, 1, 1, 1}), doctest::Contains("[motionlang.shape.206]"), ml::shape_error);
  const std::vector<ml::Index> seven(7, 1);
  CHECK_THROWS_WITH_AS(Shape(std::span<const ml::Index>(seven)), doctest::Contains("206"), ml::shape_error);
  CHECK_THROWS_WITH_AS((Shape{2, -1}), doctest::Contains("[motionlang.shape.205]"), ml::shape_error);
  Shape full{1, 1, 1, 1, 1, 1};
  CHECK_THROWS_WITH_AS(full.push_back(1), doctest::Contains("206"), ml::shape_error);
}

TEST_CASE("axes count from the end when negative") {
  CHECK(ml::normalize_axis(0, 3, "sum") == 0);
  CHECK(ml::normalize_axis(-1, 3, "sum") == 2);
  CHECK(ml::normalize_axis(-3, 3, "sum") == 0);
  CHECK_THROWS_WITH_AS(ml::normalize_axis(3, 3, "sum"),
                       doctest::Contains("[motionlang.shape.203] sum: axis 3 of a tensor of rank 3"), ml::shape_error);
  CHECK_THROWS_AS(ml::normalize_axis(-4, 3, "sum"), ml::shape_error);
  CHECK_THROWS_AS(ml::normalize_axis(0, 0, "sum"), ml::shape_error);
}

TEST_CASE("broadcasting is NumPy's") {
  const auto both_ways = [](const Shape& a, const Shape& b) {
    CHECK(ml::broadcast_shapes(a, b, "add") == ml::broadcast_shapes(b, a, "add"));
    return ml::broadcast_shapes(a, b, "add");
  };
  CHECK(both_ways({2, 3}, {2, 3}) == Shape{2, 3});
  CHECK(both_ways({2, 3}, {3}) == Shape{2, 3});
  CHECK(both_ways({2, 1, 4}, {3, 1}) == Shape{2, 3, 4});
  CHECK(both_ways({}, {5}) == Shape{5});
  CHECK(both_ways({}, {}) == Shape{});
  CHECK(both_ways({1}, {0}) == Shape{0});
  CHECK(both_ways({4, 0}, {1, 1}) == Shape{4, 0});
  CHECK_THROWS_WITH_AS(ml::broadcast_shapes({2, 3}, {2}, "mul"),
                       doctest::Contains("[motionlang.shape.202] mul: shapes do not broadcast: lhs (2, 3), rhs (2)"),
                       ml::shape_error);
  CHECK_THROWS_AS(ml::broadcast_shapes({0}, {2}, "mul"), ml::shape_error);
}
