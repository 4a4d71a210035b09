// Forward kinematics: 100,000 frames of 24 joints from 6D rotations.

#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/forward_batch.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

#include "bench.hpp"

namespace ml = motionlang;

int main(int argc, char** argv) {
  const bench::Arguments read(argc, argv);
  constexpr ml::Index frames = 100'000;
  std::vector<float> rot6d(frames * 144), root(frames * 3), joints(frames * 72);
  ml::Philox rng{.seed = 1};
  rng.normal(std::span<float>(rot6d));
  bench::report("fk", "100000 frames 24 joints 6D", frames * 24 * 120e-9,
                [&] { ml::forward_kinematics<float>(ml::smpl24_skeleton(), rot6d, root, std::span<float>(joints)); });
}
