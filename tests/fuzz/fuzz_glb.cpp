// GLB: any bytes are read or refused with an error of the library; what was read are motions of unit quaternions, and a
// file whose skeleton is known takes another animation.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <motionlang/formats/glb_rig.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

constexpr ml::Index most_frames = 1000;  // of an animation: long ones are slow, not different

void check_motions(std::span<const std::byte> bytes) {
  const ml::GlbFile file(bytes, "fuzz.glb");
  for (ml::Index figure = 0; figure < file.figures(); ++figure) {
    file.skeleton(figure).validate();
  }
  file.moving_others();
  const auto names = file.animation_names();
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 3); ++i) {
    const auto number = static_cast<ml::Index>(i);
    if (file.duration(number) > 190) continue;
    for (ml::Index figure = 0; figure < std::min<ml::Index>(file.figures(), 3); ++figure) {
      ml::GlbLoss loss;
      const ml::Motion motion = file.motion(number, 5, figure, &loss);
      const auto& joints = file.skeleton(figure).names;
      for (const std::string& name : file.stretched_joints(number, figure))
        check(std::ranges::find(joints, name) != joints.end(), "a stretched joint is one of the skeleton");
      check(loss.joint.empty() || std::ranges::find(joints, loss.joint) != joints.end(), "whose loss it is");
      check(motion.frames() >= 1 && motion.frames() <= most_frames, "frames");
      check(motion.local.size() == motion.root.size() * joints.size(), "size of the table");
      for (const auto& q : motion.local) check(std::abs(dot(q, q) - 1) < 1e-9, "unit quaternions");
      check(file.rate(number, figure) >= 1 && file.rate(number, figure) <= 1e4, "a rate");
    }
  }
}

void check_mesh(const ml::GlbRig& rig) {
  const auto mesh = rig.mesh();
  const std::size_t vertices = mesh.positions.size();
  check(mesh.normals.size() == vertices && mesh.joints.size() == 4 * vertices && mesh.weights.size() == 4 * vertices,
        "size of the surface");
  for (const auto joint : mesh.joints) check(joint < rig.skeleton().size(), "joints of vertices");
  for (const auto v : mesh.triangles) check(v < vertices, "corners of triangles");
  for (std::size_t v = 0; v < vertices; ++v) {
    int sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += mesh.weights[4 * v + k];
    check(sum == 65535, "weights of a vertex");
  }
}

void check_rig(std::span<const std::byte> bytes) {
  const ml::GlbRig rig(bytes, "fuzz.glb");
  refusing([&] { check_mesh(rig); });
  ml::Motion still{rig.skeleton(), 20, {rig.skeleton().offset(0)}, {}, "still"};
  still.local.assign(rig.skeleton().names.size(), ml::Quaternion<double>::identity());
  for (const bool keep : {true, false}) {
    const auto made = rig.with(std::span(&still, 1), {.keep_animations = keep});
    const ml::GlbFile again(made, "again.glb");
    check(keep || again.animation_names().size() == 1, "the other animations are gone");
    check(again.motion(std::ssize(again.animation_names()) - 1, 20).frames() == 1, "the animation that was added");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  refusing([&] { check_motions(bytes); });
  refusing([&] { check_rig(bytes); });
  return 0;
}
