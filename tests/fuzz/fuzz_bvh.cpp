// BVH: any text is read or refused with an error of the library; what was read survives writing, and a motion made of
// it survives becoming a file again.
#include <cmath>
#include <cstdint>

#include <motionlang/formats/bvh.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

/// Six decimals are printed: numbers come back to 1e-6, or as close as their size allows.
bool close(double a, double b) { return std::abs(a - b) <= 1e-6 + 1e-12 * std::abs(a); }
bool close(const ml::Vec3<double>& a, const ml::Vec3<double>& b) {
  return close(a.x, b.x) && close(a.y, b.y) && close(a.z, b.z);
}

void check_round_trip(const ml::Bvh& file) {
  if (file.frame_time < 1e-8) return;  // printed as 0
  const ml::Bvh again = ml::parse_bvh(ml::format_bvh(file));
  check(again.frames == file.frames && again.values.size() == file.values.size(), "size of the table");
  for (std::size_t i = 0; i < file.values.size(); ++i) check(close(file.values[i], again.values[i]), "values");
  check(again.nodes.size() == file.nodes.size(), "number of nodes");
  for (std::size_t n = 0; n < file.nodes.size(); ++n) {
    check(again.nodes[n].parent == file.nodes[n].parent && again.nodes[n].channels == file.nodes[n].channels, "nodes");
    check(close(file.nodes[n].offset, again.nodes[n].offset), "offsets");
  }
}

void check_motion(const ml::Bvh& file) {
  const ml::Motion motion = ml::to_motion(file, {.scale = 1});
  check(motion.frames() == file.frames, "frames");
  const auto beside = ml::joints_beside_body(file).size(), stretched = ml::stretched_joints(file).size();
  check(beside + stretched + static_cast<std::size_t>(motion.skeleton.size()) <= 2 * file.nodes.size(), "joints");
  check(ml::bvh_names(motion.skeleton).size() == motion.skeleton.names.size(), "names");
  for (const auto& q : motion.local) check(std::abs(dot(q, q) - 1) < 1e-9, "unit quaternions");
  const ml::Motion again = ml::to_motion(ml::to_bvh(motion, {.scale = 1}), {.scale = 1});
  check(again.skeleton.size() == motion.skeleton.size() && again.frames() == motion.frames(), "the motion again");
  for (std::size_t f = 0; f < motion.root.size(); ++f) check(again.root[f] == motion.root[f], "root positions");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const ml::Bvh file = ml::parse_bvh({reinterpret_cast<const char*>(data), size});
    check_round_trip(file);
    check_motion(file);
  } catch (const ml::error&) {}
  return 0;
}
