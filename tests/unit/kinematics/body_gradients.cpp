// Numbers of smplx in double precision for the body of tests/support/synthetic_body.hpp: forward pass, joints, and
// gradients by shape and rotation vectors.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/geometry/so3.hpp>

#include "../../support/synthetic_body.hpp"
#include "../../support/tensors.hpp"

#include <doctest/doctest.h>

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using tensors::distance;

namespace {

constexpr double printed = 6e-9;  // eight decimals were printed

template <int R>
ml::Tensor<B, R> tensor(const std::vector<double>& values, const ml::Shape& shape) {
  return ml::Tensor<B, R>::from(values, shape);
}
template <int R>
double worst(const ml::Tensor<B, R>& got, const std::vector<double>& wanted) {
  return got.count() == std::ssize(wanted) ? distance(got, tensor<R>(wanted, got.shape())) : 1e9;
}

const auto betas = tensor<2>({0.7, -1.2}, {1, 2});
const auto pose = tensor<3>({0.1, -0.2, 0.3, 0.5, 0.4, -0.6, 0, 0, 0, -1.1, 0.9, 0.2}, {1, 4, 3});
const auto tau = tensor<2>({0.25, -0.5, 1.5}, {1, 3}), nowhere = ml::Tensor<B, 2>::zeros({1, 3});
const auto no_shape = ml::Tensor<B, 2>::zeros({1, 2});
const auto no_turn = ml::rotation_rows(ml::Tensor<B, 3>::zeros({1, 4, 3}));

/// sum(vertices * s(5)) + sum(joints * s(6))
template <ml::Backend X>
ml::Tensor<X, 0> loss(const ml::BodyModel<X>& model, const ml::Tensor<X, 2>& shape, const ml::Tensor<X, 3>& axis_angles,
                      const ml::Tensor<X, 2>& translation) {
  const auto posed = model(shape, ml::rotation_rows(axis_angles), translation);
  return ml::sum(posed.vertices * ml::Tensor<X, 3>::from(synthetic::wave(5, 15), {1, 5, 3})) +
         ml::sum(posed.joints * ml::Tensor<X, 3>::from(synthetic::wave(6, 12), {1, 4, 3}));
}

}  // namespace

TEST_CASE("the tiny body: forward pass") {
  const auto model = synthetic::body<B>();
  model.validate();
  CHECK(worst(model(betas, no_turn, nowhere).vertices,
              {-0.17147317, 0.94372122, 0.14975905, 0.37978999, 1.49366835, 0.37852485, 0.10362983, 0.92847348,
               0.00988467, 0.09923233, 0.83754289, -0.53103147, -0.37079238, 1.09752595, 0.04067955}) < printed);
  CHECK(worst(model.rest_joints(betas), {0.00653226, 1.10695049, 0.12694635, 0.0463721, 1.06323954, 0.00594164,
                                         0.00530353, 1.02884853, -0.07638043, -0.02988772, 0.99698726, -0.08638118}) <
        printed);
  const auto rotations = ml::rotation_rows(pose);
  CHECK(worst(ml::slice(rotations, 1, 1, 2), {0.75626097, 0.61965651, 0.20998848, -0.43216495, 0.71407536, -0.55075388,
                                              -0.49122583, 0.325764, 0.80782115}) < printed);
  const auto posed = model(betas, rotations, tau);
  CHECK(worst(posed.vertices,
              {0.39408069, 0.04068567, 1.17517253, 0.67585068, 0.47502815, 1.51829971, 0.08600855, 0.84886045,
               1.52032372, 0.48577741, -0.12630197, 0.28413713, -0.11322719, 0.5604682, 1.53812443}) < printed);
  CHECK(worst(posed.joints, {0.25653226, 0.60695049, 1.62694635, 0.32890026, 0.59208904, 1.51433192, 0.26243415,
                             0.61631631, 1.44620272, 0.21791833, 0.60080977, 1.43473677}) < printed);
}

TEST_CASE("the tiny body: loss and gradients") {
  const auto model = ml::convert<A>(synthetic::body<B>());
  const auto shape = ml::variable<A>(betas), translation = ml::variable<A>(nowhere);
  const auto axis_angles = ml::variable<A>(pose);
  const auto l = loss(model, shape, axis_angles, translation);
  CHECK(std::abs(l.item() + 0.82717834) < printed);
  const auto g = ml::backward(l);
  CHECK(worst(g[shape], {-0.07747985, -0.00918416}) < printed);
  CHECK(worst(g[axis_angles], {0.29542904, -0.23778607, -0.03422823, 0.12231461, -0.15426465, -0.06509494, 0.15055692,
                               0.04611996, -0.01802928, -0.13372011, -0.16627555, 0.08650192}) < printed);
  double sums[3] = {};
  for (const auto& weights : {synthetic::wave(5, 15), synthetic::wave(6, 12)}) {
    for (std::size_t i = 0; i < weights.size(); ++i) sums[i % 3] += weights[i];
  }
  CHECK(worst(g[translation], {sums[0], sums[1], sums[2]}) < 1e-14);
}

TEST_CASE("gradients are slopes") {
  const auto model = synthetic::body<B>();
  const auto shape = ml::variable<A>(betas), translation = ml::variable<A>(tau);
  const auto axis_angles = ml::variable<A>(pose);
  const auto g = ml::backward(loss(ml::convert<A>(model), shape, axis_angles, translation));
  constexpr double h = 1e-5;
  for (int k = 10; k < 14; ++k) {  // along a few directions
    const auto db = tensor<2>(synthetic::wave(k, 2), {1, 2}), dt = tensor<2>(synthetic::wave(k + 1, 3), {1, 3});
    const auto dw = tensor<3>(synthetic::wave(k + 2, 12), {1, 4, 3});
    const double slope = (loss(model, betas + db * h, pose + dw * h, tau + dt * h).item() -
                          loss(model, betas - db * h, pose - dw * h, tau - dt * h).item()) /
                         (2 * h);
    const double expected =
        ml::sum(g[shape] * db).item() + ml::sum(g[axis_angles] * dw).item() + ml::sum(g[translation] * dt).item();
    CHECK(std::abs(slope - expected) < 1e-6 * std::abs(expected));
  }
}

TEST_CASE("with a tape and without it bodies are the same") {
  const auto model = synthetic::body<B>();
  const auto many = tensors::normal<B, 3>({70, 4, 3}, 1);  // more than one block of the kernels
  const auto shapes = tensors::normal<B, 2>({70, 2}, 2), places = tensors::normal<B, 2>({70, 3}, 3);
  const auto bare = model(shapes, ml::rotation_rows(many), places);
  auto taped = [](const auto& t) { return ml::variable<A>(t); };
  const auto tape = ml::convert<A>(model)(taped(shapes), ml::rotation_rows(taped(many)), taped(places));
  CHECK(distance(bare.vertices, tape.vertices) < 1e-14);
  CHECK(distance(bare.joints, tape.joints) < 1e-14);
  CHECK(distance(model.posed_joints(shapes, ml::rotation_rows(many), places), bare.joints) < 1e-12);
}

TEST_CASE("properties of every body") {
  const auto model = synthetic::body<B>();
  const auto points = ml::reshape<3>(model.v_template, {1, 5, 3});
  const auto rest = model(no_shape, no_turn, nowhere);
  CHECK(distance(rest.vertices, points) < 1e-15);
  CHECK(distance(rest.joints, ml::reshape<3>(ml::matmul(model.J_regressor, model.v_template), {1, 4, 3})) < 1e-15);

  // A root-only rotation Q maps v to Q (v - J_0) + J_0.
  const auto only_root = tensor<3>({0.4, -0.9, 1.3, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {1, 4, 3});
  const auto q = ml::reshape<2>(ml::slice(ml::rotation_rows(only_root), 1, 0, 1), {3, 3});
  const auto pelvis = ml::reshape<2>(ml::slice(rest.joints, 1, 0, 1), {1, 3});
  const auto turned = ml::matmul(model.v_template - pelvis, q, {.transpose_b = true}) + pelvis;
  CHECK(distance(model(no_shape, ml::rotation_rows(only_root), nowhere).vertices, ml::reshape<3>(turned, {1, 5, 3})) <
        1e-14);

  // Translation moves everything alike.
  const auto here = model(betas, ml::rotation_rows(pose), nowhere), there = model(betas, ml::rotation_rows(pose), tau);
  const auto shift = ml::reshape<3>(tau, {1, 1, 3});
  CHECK(distance(there.vertices, here.vertices + shift) < 1e-15);
  CHECK(distance(there.joints, here.joints + shift) < 1e-15);

  // A leaf joint turns vertices, no joints.
  const auto leaf = tensor<3>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0.3, -1, 0.5}, {1, 4, 3});
  const auto moved = model(no_shape, ml::rotation_rows(leaf), nowhere);
  CHECK(distance(moved.joints, rest.joints) < 1e-15);
  CHECK(distance(moved.vertices, rest.vertices) > 0.01);
}

TEST_CASE("a mirrored pose of a symmetric body gives mirrored vertices") {
  const ml::BodyModel<B> model{tensor<2>({0.2, 0, 0.1, -0.2, 0, 0.1, 0.5, 1, -0.1, -0.5, 1, -0.1}, {4, 3}),
                               ml::Tensor<B, 2>::zeros({12, 0}),
                               ml::Tensor<B, 2>::zeros({12, 0}),
                               tensor<2>({0.25, 0.25, 0.25, 0.25, 0.5, 0, 0.5, 0, 0, 0.5, 0, 0.5}, {3, 4}),
                               tensor<2>({0.4, 0.5, 0.1, 0.4, 0.1, 0.5, 0, 1, 0, 0, 0, 1}, {4, 3}),
                               {-1, 0, 0},
                               {}};
  model.validate();
  auto posed = [&](const std::vector<double>& axis_angles, double x) {
    const auto turns = ml::rotation_rows(tensor<3>(axis_angles, {1, 3, 3}));
    return model(ml::Tensor<B, 2>::zeros({1, 0}), turns, tensor<2>({x, 0.3, 0.6}, {1, 3})).vertices.to_vector();
  };
  // Left and right change places; rotations about y and z, and x itself, change sign.
  const auto one = posed({0.3, -0.8, 0.5, 1.1, 0.2, -0.4, -0.6, 0.9, 0.1}, 0.7);
  const auto other = posed({0.3, 0.8, -0.5, -0.6, -0.9, -0.1, 1.1, -0.2, 0.4}, -0.7);
  double worst = 0;
  for (std::size_t v = 0; v < 4; ++v) {
    const std::size_t partner = v % 2 == 0 ? v + 1 : v - 1;
    for (std::size_t c = 0; c < 3; ++c) {
      worst = std::max(worst, std::abs(one[3 * v + c] - (c == 0 ? -1 : 1) * other[3 * partner + c]));
    }
  }
  CHECK(worst < 1e-15);
}
