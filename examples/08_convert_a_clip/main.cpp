// A clip through every file format and back: shows what is lost.   usage: 08_convert_a_clip [folder]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/geometry/axis_angle.hpp>

namespace ml = motionlang;

/// A figure that walks straight ahead while its left arm swings.
ml::Motion swinging() {
  ml::Motion m{ml::smpl24_skeleton(), 20, {}, {}, "swinging"};
  const auto shoulder = static_cast<std::size_t>(m.skeleton["left_shoulder"]);
  for (int f = 0; f < 40; ++f) {
    const auto rest = ml::Pose<double>::rest(m.skeleton);
    m.root.push_back({0, 0.95, 0.05 * f});
    m.local.insert(m.local.end(), rest.local.begin(), rest.local.end());
    m.rotations(f)[shoulder] = ml::from_axis_angle(ml::Vec3<double>{0, 1, 0}, std::sin(0.3 * f));
  }
  return m;
}

/// The largest distance between joints of the same name, metres, after both clips are moved to the same start. Files
/// may order joints differently (BVH writes a limb to its end before the next begins).
double difference(const ml::Motion& a, const ml::Motion& b) {
  if (a.frames() != b.frames()) return INFINITY;
  ml::JointTransforms<double> p, q;
  double worst = 0;
  for (ml::Index f = 0; f < a.frames(); ++f) {
    a.world(f, p);
    b.world(f, q);
    const auto shift = a.root_at(0) - b.root_at(0);
    for (int j = 0; j < a.skeleton.size(); ++j) {
      const auto other = static_cast<std::size_t>(b.skeleton[a.skeleton.name(j)]);
      worst = std::max(worst, ml::norm(p.position[static_cast<std::size_t>(j)] - q.position[other] - shift));
    }
  }
  return worst;
}

int main(int argc, char** argv) try {
  const std::string base = (argc > 1 ? std::string(argv[1]) : std::string(".")) + "/swinging";
  const auto clip = swinging();
  ml::write_bvh(base + ".bvh", clip);
  ml::write_glb(base + ".glb", clip);
  ml::write_amass(base + ".npz", clip);
  const auto features = ml::smplrifke_from_motion(clip);  // (frames, 205)
  auto report = [&](const char* format, const ml::Motion& back, double limit) {
    std::printf("%-12s the same to %g m: %s\n", format, limit, difference(clip, back) < limit ? "yes" : "no");
  };
  report("BVH", ml::read_bvh_motion(base + ".bvh"), 1e-5);
  report("GLB", ml::read_glb(base + ".glb", {.fps = 20}), 1e-4);
  report("AMASS npz", ml::read_amass(base + ".npz").motion, 1e-4);
  report("205-vector", ml::smplrifke_to_motion<double>(features), 1e-4);
} catch (const ml::error& e) {  // a missing file, ...
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
