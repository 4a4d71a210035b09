// HumanML3D's 263 numbers from joints: clips of several lengths, one thread. Peer: peer_numpy.py.
#include <cmath>
#include <numeric>

#include <motionlang/features/guoh3d_extraction.hpp>

#include "bench.hpp"

namespace ml = motionlang;

/// The figure of peer_numpy.py: its zero pose with waving bones.
std::vector<ml::Vec3<float>> joints(int frames) {
  const auto& skeleton = ml::humanml3d_chains();
  std::vector<ml::Vec3<float>> out;
  for (int t = 0; t < frames; ++t) {
    std::vector<ml::Vec3<double>> p(skeleton.size());
    p[0] = {0.01 * std::sin(0.02 * t), 1.0, 0.02 * t};
    for (const auto& b : skeleton.bones()) {
      const double wave = 0.3 * std::sin(0.1 * t + static_cast<double>(b.joint));
      p[b.joint] = p[b.parent] + 0.3 * (skeleton.directions[b.joint] + ml::Vec3<double>{wave, 0.2, wave});
    }
    for (const auto& v : p) out.push_back(ml::vec_cast<float>(v));
  }
  return out;
}

int main() {
  for (const int frames : {60, 200, 1000}) {
    const auto clip = joints(frames);
    const std::span<const ml::Vec3<float>> view = clip;
    double sum = 0;  // the same on both sides
    for (const float x : ml::guoh3d_features(ml::humanml3d_chains(), view)) sum += std::abs(x);
    const std::string config = std::to_string(frames) + " frames sum " + std::to_string(sum);
    bench::report("humanml3d", config, 0, [&] { ml::guoh3d_features(ml::humanml3d_chains(), view); });
  }
}
