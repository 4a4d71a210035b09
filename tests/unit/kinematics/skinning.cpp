// Skinning of several poses at a time, beside the formula.
#include <doctest/doctest.h>

#include <motionlang/core/lane.hpp>
#include <motionlang/kinematics/skinning.hpp>

namespace ml = motionlang;

TEST_CASE("a vertex is the weighted sum of what its joints make of it, in every pose") {
  using L = ml::Lane<float, 16>;
  constexpr int poses = 2, joints = 3, vertices = 6;  // more than the four that are calculated together
  std::vector<float> dense(vertices * joints), posed(poses * vertices * 3), transforms(poses * joints * 12);
  for (int v = 0; v < vertices; ++v) {  // of two joints; the first vertex follows one alone
    dense[static_cast<std::size_t>(v * joints + v % joints)] = v == 0 ? 1.0f : 0.75f;
    if (v > 0) dense[static_cast<std::size_t>(v * joints + (v + 1) % joints)] = 0.25f;
  }
  for (std::size_t i = 0; i < posed.size(); ++i) posed[i] = static_cast<float>(i % 7) - 2;
  for (std::size_t i = 0; i < transforms.size(); ++i) transforms[i] = static_cast<float>(i % 5) * 0.5f - 1;

  const ml::SkinWeights<float> weights(dense, joints);
  REQUIRE(weights.vertices() == vertices);
  CHECK(weights.of(0).size() == 1);
  CHECK(weights.of(1).size() == 2);
  std::vector<L> lanes(joints * 12);
  for (std::size_t k = 0; k < lanes.size(); ++k) {
    for (int p = 0; p < poses; ++p) lanes[k].v[p] = transforms[static_cast<std::size_t>(p) * joints * 12 + k];
  }
  std::vector<float> made(poses * vertices * 3);
  ml::skin_vertices(weights, 0, vertices, posed.data(), lanes.data(), poses, made.data());
  for (int p = 0; p < poses; ++p) {
    for (int v = 0; v < vertices; ++v) {
      const float* x = &posed[static_cast<std::size_t>(3 * (p * vertices + v))];
      for (int row = 0; row < 3; ++row) {
        float wanted = 0;
        for (int j = 0; j < joints; ++j) {
          const float* m = &transforms[static_cast<std::size_t>((p * joints + j) * 12 + 4 * row)];
          wanted += dense[static_cast<std::size_t>(v * joints + j)] * (m[0] * x[0] + m[1] * x[1] + m[2] * x[2] + m[3]);
        }
        CHECK(made[static_cast<std::size_t>(3 * (p * vertices + v) + row)] == doctest::Approx(wanted));
      }
    }
  }
}

TEST_CASE("room for transforms is whole registers of any width") {
  CHECK(ml::skin_transform_bytes<float>(1, 2) == 16 * 2 * 12 * 4);
  CHECK(ml::skin_transform_bytes<float>(17, 2) == 32 * 2 * 12 * 4);
  CHECK(ml::skin_transform_bytes<double>(8, 1) == 8 * 12 * 8);
}
