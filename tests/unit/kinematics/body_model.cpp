// Skinning by hand: a bar of three vertices and two joints. The published models are golden cases.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/body_model.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
using ml::Index;
using Matrix = ml::Tensor<B, 2>;
using Poses = ml::Tensor<B, 3>;
using tensors::distance;
using tensors::same_bits;

namespace {

/// Vertices at x = 0, 1, 2; joints at 0 and 1; the last vertex follows the second joint, the middle one both by half.
/// The one shape direction stretches the bar.
ml::BodyModel<B> bar() {
  const auto template_ = Matrix::from({0, 0, 0, 1, 0, 0, 2, 0, 0}, {3, 3});
  return {template_,
          ml::reshape<2>(template_, {9, 1}),
          Matrix::zeros({9, 9}),
          Matrix::from({1, 0, 0, 0, 1, 0}, {2, 3}),
          Matrix::from({1, 0, 0.5, 0.5, 0, 1}, {3, 2}),
          {-1, 0},
          {2}};
}

/// One pose: rotations of both joints about z, by the angle in radians.
Poses pose(double root, double second) {
  std::vector<double> numbers;
  for (double angle : {root, second}) {
    const auto m = ml::to_matrix(ml::from_axis_angle(ml::Vec3{0.0, 0.0, 1.0}, angle)).m;
    numbers.insert(numbers.end(), m.begin(), m.end());
  }
  return Poses::from(numbers, {1, 2, 9});
}

const auto no_shape = Matrix::zeros({1, 1}), nowhere = Matrix::zeros({1, 3});
constexpr double quarter = 1.5707963267948966;

Poses points(const std::vector<double>& xyz) { return Poses::from(xyz, {1, std::ssize(xyz) / 3, 3}); }

}  // namespace

TEST_CASE("the rest pose is the template, stretched and moved as told") {
  const auto model = bar();
  model.validate();
  const auto rest = model(no_shape, pose(0, 0), nowhere);
  CHECK(distance(rest.vertices, points({0, 0, 0, 1, 0, 0, 2, 0, 0})) < 1e-15);
  CHECK(distance(rest.joints, points({0, 0, 0, 1, 0, 0})) < 1e-15);
  CHECK(distance(rest.extra, points({2, 0, 0})) < 1e-15);
  const auto longer = model(Matrix::full({1, 1}, 0.5), pose(0, 0), Matrix::from({0, 0, 7}, {1, 3}));
  CHECK(distance(longer.vertices, points({0, 0, 7, 1.5, 0, 7, 3, 0, 7})) < 1e-15);
  CHECK(distance(longer.joints, points({0, 0, 7, 1.5, 0, 7})) < 1e-15);
}

TEST_CASE("joints turn what follows them; a vertex between two joints is the mean of both transforms") {
  const auto model = bar();
  const auto bent = model(no_shape, pose(0, quarter), nowhere);
  CHECK(distance(bent.vertices, points({0, 0, 0, 1, 0, 0, 1, 1, 0})) < 1e-15);
  const auto turned = model(no_shape, pose(quarter, quarter), nowhere);
  CHECK(distance(turned.vertices, points({0, 0, 0, 0, 1, 0, -1, 1, 0})) < 1e-15);
  CHECK(distance(turned.joints, model.posed_joints(no_shape, pose(quarter, quarter), nowhere)) < 1e-15);
}

TEST_CASE("poses of a batch do not meet") {
  const auto model = bar();
  const auto both = model(Matrix::zeros({2, 1}), ml::concat(0, pose(0.3, 1), pose(-1, 0.5)), Matrix::zeros({2, 3}));
  CHECK(distance(ml::slice(both.vertices, 0, 1, 2), model(no_shape, pose(-1, 0.5), nowhere).vertices) < 1e-15);
}

TEST_CASE_TEMPLATE("a pose gets the same bits in any batch, on any number of threads, prepared or not", S, float,
                   double) {
  using F = ml::EigenBackend<S>;
  using F2 = ml::Tensor<F, 2>;
  using F3 = ml::Tensor<F, 3>;
  constexpr Index vertices = 131, most = 300;  // no multiple of four, or of a block
  for (const auto& [joints, shapes, posed] :
       std::vector<std::tuple<Index, Index, bool>>{{3, 2, true}, {3, 0, true}, {1, 2, false}}) {
    ml::Philox rng{.seed = 2};
    ml::BodyModel<F> model{.v_template = F2::randn({vertices, 3}, rng),
                           .shapedirs = F2::randn({3 * vertices, shapes}, rng),
                           .posedirs = F2::randn({3 * vertices, posed ? 9 * (joints - 1) : 0}, rng),
                           .J_regressor = F2::full({joints, vertices}, 1.0 / vertices),
                           .weights = ml::softmax(F2::randn({vertices, joints}, rng)),
                           .parents = {},
                           .extra = {5}};
    for (int j = 0; j < joints; ++j) model.parents.push_back(j - 1);
    const auto betas = F2::randn({most, shapes}, rng), tau = F2::randn({most, 3}, rng);
    const auto rotations = ml::rotation_rows(F3::randn({most, joints, 3}, rng));
    const auto first = [&](Index n) {
      return model(ml::slice(betas, 0, 0, n), ml::slice(rotations, 0, 0, n), ml::slice(tau, 0, 0, n));
    };
    const auto all = first(most);
    const auto check = [&](Index n) {
      const auto some = first(n);
      CHECK(same_bits(some.vertices, ml::slice(all.vertices, 0, 0, n)));
      CHECK(same_bits(some.joints, ml::slice(all.joints, 0, 0, n)));
      CHECK(same_bits(some.extra, ml::slice(all.extra, 0, 0, n)));
    };
    for (const Index n : {0, 1, 2, 4, 5, 15, 16, 17, 257}) check(n);
    for (const int threads : {1, 3}) {
      const Threads now(threads);
      check(most);
    }
    ml::prepare(model);
    for (const Index n : {0, 1, 17, 300}) check(n);
    CHECK(same_bits(model.posed_joints(betas, rotations, tau), all.joints));
  }
}

TEST_CASE("a body of many vertices is made in blocks, prepared or not, and is that of one with a tape") {
  using A = ml::Autodiff<B>;
  ml::Philox rng{.seed = 1};
  constexpr Index joints = 3, poses = 300;
  for (const auto& [vertices, shapes, posed] :
       std::vector<std::tuple<Index, Index, bool>>{{512, 0, false}, {600, 0, true}, {512, 4, false}, {600, 4, true}}) {
    for (const bool with_extra : {false, true}) {
      ml::BodyModel<B> model{.v_template = Matrix::randn({vertices, 3}, rng),
                             .shapedirs = Matrix::randn({3 * vertices, shapes}, rng),
                             .posedirs = Matrix::randn({3 * vertices, posed ? 9 * (joints - 1) : 0}, rng),
                             .J_regressor = Matrix::full({joints, vertices}, 1.0 / static_cast<double>(vertices)),
                             .weights = ml::softmax(Matrix::randn({vertices, joints}, rng)),
                             .parents = {-1, 0, 1},
                             .extra = {}};
      if (with_extra) model.extra = {vertices - 1};
      model.validate();
      const auto betas = Matrix::randn({poses, shapes}, rng), tau = Matrix::randn({poses, 3}, rng);
      const auto rotations = ml::rotation_rows(Poses::randn({poses, joints, 3}, rng));
      const auto plain = model(betas, rotations, tau);
      const auto taped = ml::convert<A>(model)(ml::Tensor<A, 2>::from(betas.span(), betas.shape()),
                                               ml::Tensor<A, 3>::from(rotations.span(), rotations.shape()),
                                               ml::Tensor<A, 2>::from(tau.span(), tau.shape()));
      ml::prepare(model);
      const auto prepared = model(betas, rotations, tau);
      CHECK(distance(prepared.vertices, plain.vertices) < 1e-12);
      CHECK(distance(Poses::from(taped.vertices.span(), plain.vertices.shape()), plain.vertices) < 1e-12);
      CHECK(distance(Poses::from(taped.joints.span(), plain.joints.shape()), plain.joints) < 1e-12);
    }
  }
}

TEST_CASE("arrays that do not fit together are refused") {
  CHECK_ERROR(bar()(Matrix::zeros({1, 2}), pose(0, 0), nowhere), "[motionlang.shape.204] BodyModel");
  CHECK_ERROR(bar()(no_shape, Poses::zeros({1, 3, 9}), nowhere), "[motionlang.shape.204]");
  CHECK_ERROR(bar()(no_shape, pose(0, 0), Matrix::zeros({2, 3})), "[motionlang.shape.204]");
  auto model = bar();
  model.weights = Matrix::zeros({3, 3});
  CHECK_ERROR(model.validate(), "[motionlang.shape.204] BodyModel: 3 vertices, 2 joints");
  model = bar();
  model.parents = {-1, 1};
  CHECK_ERROR(model.validate(), "[motionlang.config.106] BodyModel: joint 1 has parent 1");
  model = bar();
  model.extra = {3};
  CHECK_ERROR(model.validate(), "[motionlang.config.101] BodyModel: extra joint at vertex 3 of 3");
}
