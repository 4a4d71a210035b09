// Bodies: SMPL's forward pass (6,890 vertices, 24 joints, 10 coefficients, four weights a vertex; random numbers) for
// 200 poses, and its joints alone for many.
//
// usage: bench_body [THREADS]
#include <motionlang/backend/eigen.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/body_model.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

#include "bench.hpp"

namespace {

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;
constexpr Index vertices = 6890, joints = 24, shapes = 10;

ml::BodyModel<B> random_body(ml::Philox& rng) {
  std::vector<float> weights(vertices * joints, 0.0f);
  ml::BodyModel<B> m;
  m.v_template = ml::Tensor<B, 2>::randn({vertices, 3}, rng);
  m.shapedirs = ml::Tensor<B, 2>::randn({3 * vertices, shapes}, rng) * 0.01;
  m.posedirs = ml::Tensor<B, 2>::randn({3 * vertices, 9 * (joints - 1)}, rng) * 0.01;
  m.J_regressor = ml::Tensor<B, 2>::full({joints, vertices}, 1.0 / vertices);
  for (Index v = 0; v < vertices; ++v) {
    for (Index k = 0; k < 4; ++k) weights[static_cast<std::size_t>(v * joints + (7 * v + 5 * k) % joints)] = 0.25f;
  }
  m.weights = ml::Tensor<B, 2>::from(weights, {vertices, joints});
  m.parents = ml::smpl24_skeleton().parents;
  m.validate();
  ml::prepare(m);
  return m;
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Arguments read(argc, argv);
  ml::Philox rng{.seed = 1};
  const auto body = random_body(rng);
  // the dense count of the formulas: shape, joints, pose, skinning
  constexpr double flop = 2.0 * vertices * (30 + 24 * 3 + 207 * 3 + 24 * 16 + 16);
  auto run = [&](const char* work, Index poses, double gflop, auto f) {
    const auto betas = ml::Tensor<B, 2>::randn({poses, shapes}, rng), tau = ml::Tensor<B, 2>::randn({poses, 3}, rng);
    const auto pose = ml::Tensor<B, 3>::randn({poses, joints, 3}, rng) * 0.3;
    const std::string config = ml::concat_text("B=", poses);
    const double seconds = bench::report(work, config, gflop, [&] { f(betas, ml::rotation_rows(pose), tau); });
    std::fprintf(stderr, "%s %s: %.0f poses/s\n", work, config.c_str(), static_cast<double>(poses) / seconds);
  };
  run("smpl", 200, 200 * flop * 1e-9, [&](const auto&... a) { return body(a...); });
  run("smpl", 1, flop * 1e-9, [&](const auto&... a) { return body(a...); });
  run("smpl_joints", 10'000, 0, [&](const auto&... a) { return body.posed_joints(a...); });
}
