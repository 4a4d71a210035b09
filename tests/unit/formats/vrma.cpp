// VRM animations: what is written is read back, stands in a T-pose and moves an avatar; thumbs of both versions.
#include <doctest/doctest.h>

#include <motionlang/formats/glb_rig.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/formats/vrma.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../../support/check_error.hpp"
#include "../../support/gltf_world.hpp"
#include "../../support/rigs.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using nlohmann::ordered_json;

namespace {

ordered_json document_of(std::span<const std::byte> bytes) {
  return ordered_json::parse(ml::detail::parse_glb_chunks(bytes, "test").text);
}

}  // namespace

TEST_CASE("a motion on SMPL's joints becomes one of VRM's bones in a T-pose") {
  const ml::Motion walk = synthetic::walk({.frames = 31, .fps = 30, .turn = 0.3});
  const auto bytes = ml::vrma_bytes(walk);
  const ordered_json d = document_of(bytes);
  const auto& extension = d["extensions"]["VRMC_vrm_animation"];
  CHECK(extension["specVersion"] == "1.0");
  CHECK(d["extensionsUsed"] == ordered_json{"VRMC_vrm_animation"});
  const auto& bones = extension["humanoid"]["humanBones"];
  for (const char* required :
       {"hips", "spine", "head", "leftUpperLeg", "leftLowerLeg", "leftFoot", "rightUpperLeg", "rightLowerLeg",
        "rightFoot", "leftUpperArm", "leftLowerArm", "leftHand", "rightUpperArm", "rightLowerArm", "rightHand"})
    CHECK(bones.contains(required));
  for (const auto& [key, value] : d.items()) CHECK_MESSAGE(!value.empty(), key);  // glTF forbids empty arrays

  // the T-pose: soles on the floor, arms to the sides, legs down
  const gltf::World world(bytes);
  const auto at = [&](const char* bone) { return world.position(bones[bone]["node"].get<int>(), -1); };
  CHECK(std::min(at("leftToes").y, at("rightToes").y) == doctest::Approx(0).epsilon(1e-6));
  CHECK(at("hips").y > 0.8);
  CHECK(norm(at("leftHand") - at("leftUpperArm") - ml::Vec3{norm(at("leftHand") - at("leftUpperArm")), 0.0, 0.0}) <
        1e-6);
  CHECK(at("rightHand").x < at("rightUpperArm").x);
  CHECK(norm(at("leftFoot") - at("leftUpperLeg") + ml::Vec3{0.0, norm(at("leftFoot") - at("leftUpperLeg")), 0.0}) <
        1e-6);

  const auto back = ml::parse_motions(bytes, "walk.vrma").front();
  CHECK(back.fps == 30);
  CHECK(back.skeleton == ml::GlbFile(bytes, "walk.vrma").skeleton());
  CHECK(back.skeleton.names.front() == "hips");
  CHECK(gltf::farthest(back, world) < 1e-5);
  const auto want = ml::retarget(walk, ml::vrm_skeleton(walk.skeleton));
  CHECK(synthetic::largest_distance(back, want) < 1e-5);
  // and it comes back: every limb in the direction that it had
  const ml::Motion again = ml::on_smpl(back);
  ml::JointTransforms<double> p, q;
  for (ml::Index f = 0; f < walk.frames(); ++f) {
    walk.world(f, p);
    again.world(f, q);
    for (const auto& [from, to] : {std::pair{"left_hip", "left_knee"}, std::pair{"right_elbow", "right_wrist"}}) {
      const auto i = static_cast<std::size_t>(walk.skeleton[from]), j = static_cast<std::size_t>(walk.skeleton[to]);
      const auto a = ml::normalized(p.position[j] - p.position[i]), b = ml::normalized(q.position[j] - q.position[i]);
      CHECK(norm(a - b) < 1e-5);
    }
  }
}

TEST_CASE("what is on VRM's bones in a T-pose already is written as it is") {
  const auto once = ml::parse_motions(ml::vrma_bytes(synthetic::walk({.frames = 9})), "a.vrma").front();
  const auto twice = ml::parse_motions(ml::vrma_bytes(once), "a.vrma").front();
  CHECK(twice.skeleton.names == once.skeleton.names);
  CHECK(synthetic::largest_distance(once, twice) < 1e-6);
}

TEST_CASE("a VRM animation moves an avatar, whatever version") {
  const TemporaryFolder folder;
  ml::write_motion(folder / "walk.vrma", synthetic::walk({.frames = 9}));
  const ml::Motion walk = ml::read_motion(folder / "walk.vrma");
  const auto skeleton = rigs::skeleton_of(ml::skeleton_table("VRM"));
  const auto bytes = rigs::glb_of(skeleton);
  const auto binary = ml::detail::parse_glb_chunks(bytes, "avatar").binary;
  auto document = document_of(bytes);
  for (std::size_t j = 1; j + 1 < skeleton.names.size(); ++j)
    document["extensions"]["VRM"]["humanoid"]["humanBones"].push_back({{"bone", skeleton.names[j]}, {"node", j + 1}});
  const ml::GlbRig rig(ml::detail::glb_file(document.dump(), {binary.begin(), binary.end()}), "avatar.vrm");
  const auto made = rig.with(std::span(&walk, 1));
  const auto moved = ml::GlbFile(made, "moved.vrm").motion("walk", walk.fps);
  const auto want = ml::retarget(walk, rig.skeleton());
  CHECK(synthetic::largest_distance(moved, want) < 1e-5);
}

TEST_CASE("bones of thumbs are called as in VRM 1.0, and fingers go along") {
  ml::Skeleton hands = ml::smpl24_skeleton();
  hands.names[22] = "left_hand", hands.names[23] = "right_hand";
  for (const char* side : {"left", "right"}) {
    int before = hands[std::string(side) + "_wrist"];
    for (int k = 1; k <= 3; ++k) {
      hands.names.push_back(ml::concat_text(side, "_thumb", k));
      hands.parents.push_back(before);
      hands.offsets.push_back({side[0] == 'l' ? 0.03 : -0.03, 0, 0.01});
      before = hands.size() - 1;
    }
  }
  const ml::Skeleton bones = ml::vrm_skeleton(hands);
  for (const char* bone : {"leftThumbMetacarpal", "leftThumbProximal", "leftThumbDistal", "rightThumbDistal"})
    CHECK(bones.find(bone) >= 0);
  CHECK(bones.name(bones.parent(bones["leftThumbMetacarpal"])) == "leftHand");
  ml::Motion wave{hands, 20, {{0, 1, 0}}, {}, "wave"};
  wave.local.assign(hands.names.size(), ml::Quaternion<double>::identity());
  wave.local[static_cast<std::size_t>(hands["left_thumb2"])] = synthetic::about_y(0.5);
  const auto back = ml::parse_motions(ml::vrma_bytes(wave), "wave.vrma").front();
  CHECK(ml::distance(back.rotations(0)[static_cast<std::size_t>(back.skeleton["leftThumbProximal"])],
                     synthetic::about_y(0.5)) < 1e-5);

  // VRM 0.x: ThumbProximal, ThumbIntermediate and ThumbDistal are 1.0's Metacarpal, Proximal and Distal
  ordered_json old{{"asset", {{"version", "2.0"}}}};
  const char* thumb[] = {"leftThumbProximal", "leftThumbIntermediate", "leftThumbDistal"};
  for (int k = 0; k < 3; ++k) {
    old["nodes"].push_back({{"name", "n"}});
    if (k > 0) old["nodes"][static_cast<std::size_t>(k) - 1]["children"] = {k};
    old["extensions"]["VRM"]["humanoid"]["humanBones"].push_back({{"bone", thumb[k]}, {"node", k}});
  }
  old["skins"].push_back({{"joints", {0, 1, 2}}});
  CHECK(ml::GlbFile(ml::detail::glb_file(old.dump(), {}), "old.vrm").skeleton().names ==
        std::vector<std::string>{"leftThumbMetacarpal", "leftThumbProximal", "leftThumbDistal"});
}

TEST_CASE("what VRM has no bones for is an error") {
  CHECK_ERROR(ml::vrma_bytes(synthetic::walk({.frames = 0})), "has no frames");
  ml::Motion stick{ml::Skeleton::from_joints({{"a", "", {0, 0, 0}}}), 20, {{0, 0, 0}}, {{1, 0, 0, 0}}, "stick"};
  CHECK_ERROR(ml::vrma_bytes(stick), "[motionlang.config.103]");
}
