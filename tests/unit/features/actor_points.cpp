// ACTOR's motions on a body: gradients of all representations, packed as alone, the way of the root, what is refused.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/features/actor_points.hpp>
#include <motionlang/features/smplh_joints.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_body.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::ActorPointOptions, ml::ActorPoints, ml::Index, ml::Offsets, ml::PoseRepresentation;
using B = ml::ReferenceBackend<double>;
using A = ml::Autodiff<B>;
using tensors::distance, tensors::normal;

namespace {

ml::Tensor<B, 2> no_regressor() { return ml::Tensor<B, 2>::zeros({9, 5}); }

}  // namespace

TEST_CASE("actor points: gradients are central differences, whatever the representation") {
  const auto body = ml::convert<A>(synthetic::body<B>());
  const Offsets offsets{2, 1};
  for (const auto form : {PoseRepresentation::rotvec, PoseRepresentation::rotquat, PoseRepresentation::rotmat,
                          PoseRepresentation::rot6d}) {
    for (const bool global : {true, false}) {
      CAPTURE(static_cast<int>(form));
      CAPTURE(global);
      const ActorPointOptions o{.features = {.rotations = form, .global = global}, .second_beta = 0.5};
      const Index width = (global ? 5 : 4) * ml::size(form);
      const auto start = normal<B, 2>({3, width}, 1), weights = normal<B, 2>({3, 15}, 2);
      auto loss = [&](const ml::Tensor<A, 2>& x) {
        const auto points = ml::actor_points(ml::Sequences<A>(x, offsets), body, {}, ActorPoints::vertices, o).rows;
        return ml::sum(points * ml::Tensor<A, 2>::from(weights.to_vector(), {3, 15}));
      };
      const auto x = ml::variable<A>(start);
      const auto gradient = ml::backward(loss(x))[x];
      for (std::size_t i = 0; i < start.span().size(); i += 3) {
        auto moved = [&](double h) {
          auto v = start.to_vector();
          v[i] += h;
          return loss(ml::Tensor<A, 2>::from(v, start.shape())).item();
        };
        CHECK(gradient.span()[i] == doctest::Approx((moved(1e-6) - moved(-1e-6)) / 2e-6).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("actor points: a motion in a batch as if it were alone; the way counts from its first frame") {
  const auto body = synthetic::body<B>();
  const ml::Sequences<B> x(normal<B, 2>({7, 30}, 3), Offsets{3, 4});
  const auto together = ml::actor_points<B>(x, body, nullptr, ActorPoints::smpl);
  const auto still = ml::actor_points<B>(x, body, nullptr, ActorPoints::smpl, {.translate = false});
  CHECK(together.width() == 12);
  for (Index s : {0, 1}) {
    const ml::Sequences<B> one(x[s], Offsets{x.offsets.length(s)});
    CHECK(distance(ml::actor_points<B>(one, body, nullptr, ActorPoints::smpl).rows, together[s]) == 0);
    const auto way = ml::slice(x[s], 1, 24, 27) - ml::slice(ml::slice(x[s], 1, 24, 27), 0, 0, 1);
    CHECK(distance(ml::slice(together[s], 1, 0, 3), way) < 1e-14);  // the root itself
    CHECK(distance(ml::slice(together[s] - still[s], 1, 9, 12), way) < 1e-14);
    CHECK(ml::slice(still[s], 1, 0, 3).to_vector() ==
          std::vector<double>(static_cast<std::size_t>(3 * one.offsets.rows())));
  }
}

TEST_CASE("actor points: what does not fit is refused") {
  const auto body = synthetic::body<B>();
  const ml::Sequences<B> x(normal<B, 2>({2, 30}, 4), Offsets{2}), narrow(normal<B, 2>({2, 29}, 4), Offsets{2});
  const auto regressor = no_regressor();
  CHECK_ERROR(ml::actor_points<B>(narrow, body, nullptr, ActorPoints::smpl), "[motionlang.shape.204]");
  CHECK_ERROR(ml::actor_points<B>(x, body, nullptr, ActorPoints::a2m), "[motionlang.shape.204]");
  CHECK_ERROR(ml::actor_points<B>(x, body, &regressor, ActorPoints::a2m), "[motionlang.shape.204]");  // 4 joints
  auto one_coefficient = body;
  one_coefficient.shapedirs = ml::slice(body.shapedirs, 1, 0, 1);
  CHECK_ERROR(ml::actor_points<B>(x, one_coefficient, nullptr, ActorPoints::smpl, {.second_beta = 1}),
              "[motionlang.config.101]");
  CHECK_ERROR(ml::parse_actor_points("coco"), "[motionlang.config.103]");
  CHECK(ml::actor_point_numbers(ml::parse_actor_points("vibe")).size() == 49);
  CHECK(ml::actor_point_numbers(ActorPoints::a2mpl).size() == 28);
}

TEST_CASE("mean hands stand in for rotations that a motion lacks") {
  ml::Body<B> body;
  body.model = synthetic::body<B>();
  const auto rotations = ml::Tensor<B, 3>::zeros({2, 3, 9});
  CHECK_ERROR(ml::with_mean_hands(body, rotations), "[motionlang.config.106]");
  CHECK(ml::with_mean_hands(body, ml::Tensor<B, 3>::zeros({2, 4, 9})).size(1) == 4);
  body.left_hand = body.right_hand =
      ml::HandPoses<B>{ml::Tensor<B, 2>::zeros({0, 45}), ml::Tensor<B, 1>::full({45}, 0.1)};
  CHECK_ERROR(ml::with_mean_hands(body, rotations), "[motionlang.shape.204]");
}
