// Writes the files that tests/browser/run_glb.sh opens: browser_glb <folder>
// walk.glb as the library writes it, character.glb with the same walk on a rig, and expected.json: where their joints
// are, by forward kinematics, at some frames.
#include <filesystem>

#include <motionlang/formats/glb_rig.hpp>

#include "../support/rigs.hpp"

namespace ml = motionlang;
using nlohmann::json;

namespace {

json expectation(const std::string& file, const ml::Motion& motion) {
  json samples = json::array();
  const auto positions = motion.positions();
  const auto joints = motion.skeleton.names.size();
  for (const std::size_t frame : {0u, 7u, 20u, 33u, 40u}) {
    json at = json::object();
    for (std::size_t j = 0; j < joints; ++j) {
      const auto& p = positions[frame * joints + j];
      at[motion.skeleton.names[j]] = {p.x, p.y, p.z};
    }
    samples.push_back({{"time", static_cast<double>(frame) / motion.fps}, {"joints", at}});
  }
  return {{"file", file}, {"animation", motion.name}, {"samples", samples}};
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const std::filesystem::path folder = arguments[1];
  const ml::Motion walk = synthetic::walk({.frames = 41, .fps = 20, .turn = 0.7});
  ml::write_glb(folder / "walk.glb", walk);

  const auto skeleton = rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:");
  const ml::GlbRig rig(rigs::glb_of(skeleton), "rig.glb");
  ml::write_glb(folder / "character.glb", rig, std::span(&walk, 1));

  const json expected{expectation("walk.glb", walk), expectation("character.glb", ml::retarget(walk, rig.skeleton()))};
  ml::write_file(folder / "expected.json", std::string_view(expected.dump()));
}
