// Which contour of a face is seen, and where its landmarks are.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/kinematics/face_landmarks.hpp>
#include <motionlang/kinematics/surface_points.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_body.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<double>;

namespace {

ml::Matrix3<double> about(const ml::Vec3<double>& axis, double degrees) {
  return ml::to_matrix(ml::AxisAngle{(degrees * ml::degree) * axis});
}

/// The tiny body, on whose triangles are two landmarks; contour k of 79 is the corner k % 3 of triangle k / 3 % 3.
template <ml::Backend T>
ml::Body<T> body() {
  ml::Body<T> out;
  out.model = synthetic::body<T>();
  out.faces = synthetic::faces;
  out.landmarks = {{synthetic::faces[2], synthetic::faces[0]}, {{0.5, 0.25, 0.25}, {0, 0, 1}}};
  for (std::size_t k = 0; k < 79; ++k) {
    std::array<double, 3> weights{};
    weights[k % 3] = 1;
    out.contours.push_back({{synthetic::faces[k / 3 % 3]}, {weights}});
  }
  return out;
}
constexpr ml::Vec3<double> x{1, 0, 0}, y{0, 1, 0};

}  // namespace

TEST_CASE("the contour follows the turn of the neck: right is 0 to 39, left 40 to 78") {
  const auto row = [](double degrees) { return ml::contour_row(about(y, degrees), 79); };
  CHECK(row(0) == 0);
  CHECK(row(-0.4) == 0);
  CHECK(row(-20.4) == 20);
  CHECK(row(-38.9) == 39);
  CHECK(row(-70) == 39);
  CHECK(row(0.4) == 0);
  CHECK(row(0.6) == 40);
  CHECK(row(20.6) == 60);
  CHECK(row(39.2) == 78);
  CHECK(row(80) == 78);
  CHECK(ml::contour_row(about(y, 30) * about(x, 25), 79) == 69);  // a nod before the turn leaves it as it is
  CHECK(ml::contour_row(about(y, 30), 21) == 20);
}

TEST_CASE("landmarks of each pose: those of the face, then its own contour; turns along the chain add up") {
  const auto b = body<B>();
  const ml::Matrix3<double> turned[] = {about(y, 10), about(y, 10.6), about(y, -100),
                                        about(y, 50)};  // joint 2 hangs on 1 on 0
  std::vector<double> rotations;
  const auto add = [&](const ml::Matrix3<double>& m) { rotations.insert(rotations.end(), m.m.begin(), m.m.end()); };
  for (int j = 0; j < 4; ++j) add(ml::Matrix3<double>::identity());
  add(turned[0]), add(about(y, 0)), add(turned[1]), add(turned[2]);
  const auto r = ml::Tensor<B, 3>::from(rotations, {2, 4, 9});
  const auto v = ml::Tensor<B, 3>::from(synthetic::wave(9, 30), {2, 5, 3});
  const auto got = ml::face_landmarks(b, v, r, 2);
  REQUIRE(got.shape() == ml::Shape{2, 3, 3});
  const auto fixed = ml::surface_points(v, b.landmarks);
  CHECK(tensors::distance(ml::slice(got, 1, 0, 2), fixed) == 0);
  const auto at = [&](std::size_t pose, Index vertex, std::size_t c) {
    return v.span()[15 * pose + 3 * static_cast<std::size_t>(vertex) + c];
  };
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(got.span()[6 + c] == at(0, 0, c));      // row 0: corner 0 of triangle 0
    CHECK(got.span()[9 + 6 + c] == at(1, 2, c));  // row 60: corner 0 of triangle 20 % 3
  }
  CHECK_ERROR(ml::face_landmarks(b, v, ml::slice(r, 0, 0, 1), 2), "[motionlang.shape.204]");
  CHECK_ERROR(ml::face_landmarks(b, v, r, 12), "[motionlang.config.101]");
  auto plain = b;
  plain.contours.clear();
  CHECK(tensors::distance(ml::face_landmarks(plain, v, r, 2), fixed) == 0);
}

TEST_CASE("landmarks pull on the vertices of their triangles") {
  using A = ml::Autodiff<B>;
  const auto b = body<A>();
  const auto v = ml::variable<A>(ml::Tensor<B, 3>::from(synthetic::wave(9, 15), {1, 5, 3}));
  const auto r = ml::rotation_rows(ml::Tensor<A, 3>::zeros({1, 4, 3}));
  const auto gradient = ml::backward(ml::sum(ml::face_landmarks(b, v, r, 2)))[v];
  const double wanted[] = {1, 0, 1.5, 0.25, 0.25};  // contour 0 on vertex 0; landmarks on (2, 3, 4) and on 2
  for (std::size_t i = 0; i < 15; ++i) CHECK(gradient.span()[i] == doctest::Approx(wanted[i / 3]));
}
