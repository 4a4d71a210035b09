// Forward kinematics of batches: registers against one pose at a time, tensors against registers, gradients against
// differences.
#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/forward_batch.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

#include "../../support/threads.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

template <class S>
std::vector<S> normals(Index n, std::uint64_t seed) {
  std::vector<S> v(static_cast<std::size_t>(n));
  ml::Philox{.seed = seed}.normal(std::span<S>(v));
  return v;
}

}  // namespace

TEST_CASE_TEMPLATE("several poses at a time are the same poses", S, float, double) {
  const auto& skeleton = ml::smpl24_skeleton();
  for (Index poses : {1, 7, 8, 9, 1500}) {
    const auto rot6d = normals<S>(poses * 24 * 6, 1), root = normals<S>(poses * 3, 2);
    std::vector<S> joints(static_cast<std::size_t>(poses * 72));
    ml::forward_kinematics<S>(skeleton, rot6d, root, std::span<S>(joints));
    double worst = 0;
    for (Index p = 0; p < poses; p += 1 + poses / 20) {
      std::vector<ml::Rotation6dRows<double>> local;
      const S* r = &rot6d[static_cast<std::size_t>(p * 144)];
      for (int j = 0; j < 24; ++j, r += 6) local.push_back({{r[0], r[1], r[2]}, {r[3], r[4], r[5]}});
      const S* t = &root[static_cast<std::size_t>(3 * p)];
      const auto world = ml::forward_kinematics(skeleton, std::span<const ml::Rotation6dRows<double>>(local),
                                                ml::Vec3<double>{t[0], t[1], t[2]});
      for (std::size_t j = 0; j < 24; ++j) {
        const S* got = &joints[static_cast<std::size_t>(p * 72) + 3 * j];
        worst = std::max(worst, ml::norm(world.position[j] - ml::Vec3<double>{got[0], got[1], got[2]}));
      }
    }
    CHECK(worst < (sizeof(S) == 4 ? 5e-6 : 1e-13));
  }
}

TEST_CASE("registers of every width give the same joints") {
  constexpr Index poses = 37;
  // pairs of joints, and one that is alone
  for (const auto* skeleton : {&ml::smpl24_skeleton(), &ml::kit21_skeleton()}) {
    const Index n = skeleton->size();
    const auto rot6d = normals<float>(poses * n * 6, 1), root = normals<float>(poses * 3, 2);
    const auto joints_of = [&]<class L>() {
      std::vector<float> joints(static_cast<std::size_t>(poses * n * 3));
      ml::detail::PoseArrays<float>(*skeleton, rot6d.data(), root.data(), poses, joints.data())
          .template place<L>(0, poses);
      return joints;
    };
    const auto narrow = joints_of.operator()<ml::Lane<float, 16>>();
    CHECK(joints_of.operator()<ml::Lane<float, 32>>() == narrow);
    CHECK(joints_of.operator()<ml::Lane<float, 64>>() == narrow);
    std::vector<float> joints(narrow.size());
    ml::forward_kinematics<float>(*skeleton, rot6d, root, std::span<float>(joints));
    for (std::size_t i = 0; i < joints.size(); ++i) REQUIRE(joints[i] == doctest::Approx(narrow[i]).epsilon(1e-5));
  }
}

TEST_CASE_TEMPLATE("a pose gets the same bits in any batch, on any number of threads", S, float, double) {
  const auto one_joint = ml::Skeleton::from_joints({{"root", "", {1, 2, 3}}});
  for (const auto* skeleton : {&ml::smpl24_skeleton(), &one_joint}) {
    const Index n = skeleton->size(), most = 1100;
    const auto rot6d = normals<S>(most * n * 6, 1), root = normals<S>(most * 3, 2);
    const auto joints_of = [&](Index poses) {
      std::vector<S> joints(static_cast<std::size_t>(poses * n * 3));
      ml::forward_kinematics<S>(*skeleton, std::span(rot6d).first(static_cast<std::size_t>(poses * n * 6)),
                                std::span(root).first(static_cast<std::size_t>(poses * 3)), joints);
      return joints;
    };
    const auto all = joints_of(most);
    for (const Index poses : {0, 1, 3, 16, 17, 511, 512, 513}) {
      const auto some = joints_of(poses);
      CHECK(std::equal(some.begin(), some.end(), all.begin()));
    }
    for (const int threads : {1, 3}) {
      const Threads now(threads);
      CHECK(joints_of(most) == all);
    }
  }
}

TEST_CASE("the same call on a tape gives the same joints and right gradients") {
  using B = ml::EigenBackend<double>;
  using A = ml::Autodiff<B>;
  const auto& skeleton = ml::humanml3d22_skeleton();
  const auto rot6d = ml::Tensor<B, 4>::from(normals<double>(2 * 3 * 22 * 6, 3), {2, 3, 22, 6});
  const auto root = ml::Tensor<B, 3>::from(normals<double>(2 * 3 * 3, 4), {2, 3, 3});
  const auto weight = ml::Tensor<B, 4>::from(normals<double>(2 * 3 * 22 * 3, 5), {2, 3, 22, 3});
  auto loss = [&](const ml::Tensor<B, 4>& r) {
    return ml::sum(ml::forward_kinematics(skeleton, ml::lanes(r, root)) * weight).item();
  };

  const auto variable = ml::variable<A>(rot6d);
  const auto joints =
      ml::forward_kinematics(skeleton, ml::lanes(variable, ml::Tensor<A, 3>::from(root.to_vector(), root.shape())));
  const auto taped = ml::sum(joints * ml::Tensor<A, 4>::from(weight.to_vector(), weight.shape()));
  CHECK(taped.item() == doctest::Approx(loss(rot6d)).epsilon(1e-12));
  const auto gradient = ml::backward(taped)[variable];
  auto values = rot6d.to_vector();
  for (std::size_t i = 0; i < values.size(); i += 37) {
    const double x = values[i], h = 1e-6;
    values[i] = x + h;
    const double up = loss(ml::Tensor<B, 4>::from(values, rot6d.shape()));
    values[i] = x - h;
    const double down = loss(ml::Tensor<B, 4>::from(values, rot6d.shape()));
    values[i] = x;
    CHECK(gradient.span()[i] == doctest::Approx((up - down) / (2 * h)).epsilon(1e-6));
  }
}

TEST_CASE("wrong sizes are refused") {
  using B = ml::ReferenceBackend<double>;
  CHECK_THROWS_WITH_AS(ml::lanes(ml::Tensor<B, 4>::zeros({1, 2, 24, 5}), ml::Tensor<B, 3>::zeros({1, 2, 3})),
                       doctest::Contains("[motionlang.shape.204]"), ml::shape_error);
  const auto poses = ml::lanes(ml::Tensor<B, 4>::full({1, 2, 20, 6}, 1), ml::Tensor<B, 3>::zeros({1, 2, 3}));
  CHECK_THROWS_AS(ml::forward_kinematics(ml::smpl24_skeleton(), poses), ml::shape_error);
}
