// A character's GLB file with motions added: what was there stays, and the figure moves as the motion says.
#include <doctest/doctest.h>

#include <motionlang/formats/glb_rig.hpp>

#include "../../support/check_error.hpp"
#include "../../support/rigs.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using nlohmann::ordered_json;

namespace {

const ml::Skeleton& mixamo() {
  static const ml::Skeleton skeleton = rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:");
  return skeleton;
}
ml::GlbRig rig_of(const std::vector<std::byte>& bytes) { return {bytes, "rig.glb"}; }
ordered_json document_of(std::span<const std::byte> bytes) {
  return ordered_json::parse(ml::detail::parse_glb_chunks(bytes, "test").text);
}

}  // namespace

TEST_CASE("the file that is written moves as the retargeted motion does") {
  const auto bytes = rigs::glb_of(mixamo());
  const auto rig = rig_of(bytes);
  CHECK(rig.table().name == "Mixamo");
  CHECK(rig.skeleton().names.front() == "mixamorig:Hips");  // not what is above it
  CHECK(norm(rig.skeleton().offset(0) - ml::Vec3{0.0, 0.95, 0.0}) < 1e-9);

  const auto walk = synthetic::walk({.frames = 31, .turn = 0.4});
  const auto want = ml::retarget(walk, rig.skeleton());
  const auto made = rig.with(std::span(&walk, 1));
  const ml::GlbFile file(made, "made");
  CHECK(file.animation_names() == std::vector<std::string>{"idle", "walk"});
  const auto got = file.motion("walk", walk.fps);
  REQUIRE(got.frames() == walk.frames());
  const auto p = want.positions(), q = got.positions();
  double worst = 0;
  for (int j = 0; j < want.skeleton.size(); ++j) {
    const int k = got.skeleton[want.skeleton.name(j)];
    for (ml::Index f = 0; f < want.frames(); ++f) {
      worst = std::max(worst, norm(p[static_cast<std::size_t>(f * want.skeleton.size() + j)] -
                                   q[static_cast<std::size_t>(f * got.skeleton.size() + k)]));
    }
  }
  CHECK(worst < 1e-5);
  // A motion that is on the rig's skeleton already is not changed on the way.
  const auto again = ml::GlbFile(rig.with(std::span(&want, 1)), "again").motion("walk", walk.fps);
  CHECK(synthetic::largest_distance(got, again) < 1e-5);
}

TEST_CASE("the surface of a character stands as its skeleton does, whatever pose the nodes have") {
  const auto bytes = rigs::glb_of(mixamo());
  const auto rest = mixamo().rest_positions();
  const auto chunks = ml::detail::parse_glb_chunks(bytes, "rig");
  const auto changed = [&](auto change) {
    ordered_json d = document_of(bytes);
    change(d);
    return ml::detail::glb_file(d.dump(), {chunks.binary.begin(), chunks.binary.end()});
  };
  const auto node_of = [](ordered_json& d, const std::string& name) -> ordered_json& {
    for (ordered_json& node : d["nodes"]) {
      if (node["name"] == "mixamorig:" + name) return node;
    }
    throw name;
  };
  const auto bent = changed([&](ordered_json& d) {  // arms hang and the trunk leans; the binds keep the T-pose
    for (const char* name : {"LeftArm", "RightArm", "Spine"}) {
      ordered_json& r = node_of(d, name)["rotation"];
      const ml::Quaternion<double> q{r[3].get<double>(), r[0].get<double>(), r[1].get<double>(), r[2].get<double>()};
      const auto turned = q * synthetic::about_x(name[0] == 'S' ? 0.3 : 1.2);
      r = {turned.x, turned.y, turned.z, turned.w};
    }
  });
  for (const auto* file : {&bytes, &bent}) {
    const ml::GlbRig rig = rig_of(*file);
    const auto mesh = rig.mesh();
    REQUIRE(mesh.positions.size() == 3 * rest.size());
    CHECK(mesh.normals.size() == mesh.positions.size());
    CHECK(mesh.triangles.size() == mesh.positions.size());
    for (std::size_t j = 0; j < rest.size(); ++j) {
      const int own = rig.skeleton().find(mixamo().names[j]);
      CHECK(mesh.joints[12 * j] == std::max(own, 0));  // the root on the floor goes with the hips
      CHECK(mesh.weights[12 * j] == 65535);
      const ml::Vec3<double> seen = ml::vec_cast<double>(mesh.positions[3 * j]);
      if (own >= 0) CHECK(norm(seen - (rest[j] + ml::Vec3{-0.04, 0.0, 0.0})) < 2e-5);
    }
  }
  const auto armed = changed([&](ordered_json& d) {  // a sword in the hand, of the same mesh, and a house
    const auto sword = d["nodes"].size();
    d["nodes"].push_back({{"name", "sword"}, {"mesh", 0}, {"scale", {0.01, 0.01, 0.01}}});
    d["nodes"].push_back({{"name", "house"}, {"mesh", 0}});
    node_of(d, "RightHand")["children"].push_back(sword);
  });
  const ml::GlbRig rig = rig_of(armed);
  const auto mesh = rig.mesh();
  REQUIRE(mesh.positions.size() == 6 * rest.size());
  const auto first = 3 * rest.size();
  for (std::size_t v = first; v < mesh.positions.size(); ++v)
    CHECK(mesh.joints[4 * v] == rig.skeleton()["mixamorig:RightHand"]);
  const double size = norm(ml::vec_cast<double>(mesh.positions[first] - mesh.positions[first + 1]));
  CHECK(size == doctest::Approx(0.08 * 1e-4));  // under the armature, which is in centimetres

  CHECK_THROWS_WITH_AS(rig_of(changed([](ordered_json& d) {
                         d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 0;
                       })).mesh(),
                       doctest::Contains("its meshes are packed"), ml::io_error);
  CHECK_THROWS_WITH_AS(rig_of(changed([](ordered_json& d) { d["nodes"].back().erase("mesh"); })).mesh(),
                       doctest::Contains("no mesh moves with the joints"), ml::io_error);
  CHECK_THROWS_WITH_AS(rig_of(changed([](ordered_json& d) { d["skins"][0]["joints"] = {2}; })).mesh(),
                       doctest::Contains(" of 1"), ml::io_error);
}

TEST_CASE("all that was in the file stays") {
  const auto bytes = rigs::glb_of(mixamo());
  const auto rig = rig_of(bytes);
  std::vector<ml::Motion> walks(2, synthetic::walk({.frames = 5}));
  const auto made = rig.with(walks);
  const auto before = ml::detail::parse_glb_chunks(bytes, "before").binary,
             after = ml::detail::parse_glb_chunks(made, "after").binary;
  REQUIRE(after.size() > before.size());
  CHECK(std::equal(before.begin(), before.end(), after.begin()));
  const ordered_json old = document_of(bytes), now = document_of(made);
  for (const auto& item : old.items()) {
    const std::string& key = item.key();
    const ordered_json& value = item.value();
    CAPTURE(key);
    if (key == "buffers") continue;
    if (key != "animations" && key != "accessors" && key != "bufferViews") CHECK(now.at(key) == value);
    for (std::size_t i = 0; value.is_array() && i < value.size(); ++i) CHECK(now.at(key).at(i) == value[i]);
  }
  CHECK(now["buffers"][0]["byteLength"] == after.size());
  CHECK(ml::GlbFile(made, "made").animation_names() == std::vector<std::string>{"idle", "walk", "walk_2"});
  // Joints of which no table knows (root, thumb) get no keys.
  for (const auto& channel : now["animations"][1]["channels"]) {
    const std::string name = now["nodes"][channel["target"]["node"].get<std::size_t>()]["name"];
    CHECK(name.starts_with("mixamorig:"));
  }
  const auto only = rig.with(walks, {.keep_animations = false});
  CHECK(ml::GlbFile(only, "only").animation_names() == std::vector<std::string>{"walk", "walk_2"});
  const auto no_walk = rig_of(only).with(std::span(walks).first(1));  // and the result is a rig again
  CHECK(ml::GlbFile(no_walk, "third").animation_names() == std::vector<std::string>{"walk", "walk_2", "walk_3"});
}

TEST_CASE("animations that are dropped take their data with them, if these are the last and nothing else uses them") {
  const auto bytes = rigs::glb_of(mixamo());  // the animation is the last that is written
  const ordered_json old = document_of(bytes);
  const auto walk = synthetic::walk({.frames = 5});
  const auto made = [&](const ordered_json& document, bool keep) {
    const auto chunk = ml::detail::parse_glb_chunks(bytes, "rig").binary;
    const auto file = ml::detail::glb_file(document.dump(), {chunk.begin(), chunk.end()});
    auto out = rig_of(file).with(std::span(&walk, 1), {.keep_animations = keep});
    CHECK(ml::GlbFile(out, "made").motion("walk", walk.fps).frames() == walk.frames());
    return out;
  };
  const auto all = made(old, true), only = made(old, false);
  const auto idle = (2 + 8) * sizeof(float);  // two times and rotations
  const auto binary_of = [](const auto& file) { return ml::detail::parse_glb_chunks(file, "made").binary; };
  CHECK(binary_of(only).size() == binary_of(all).size() - idle);
  const auto& view = old["bufferViews"][old["bufferViews"].size() - 2];
  const auto kept = binary_of(bytes).first(view["byteOffset"].get<std::size_t>());  // mesh and skin
  CHECK(std::equal(kept.begin(), kept.end(), binary_of(only).begin()));
  const auto number = [](const std::vector<std::byte>& file, const char* array) {
    return document_of(file)[array].size();
  };
  CHECK(number(only, "accessors") == number(all, "accessors") - 2);
  CHECK(number(only, "bufferViews") == number(all, "bufferViews") - 2);

  ordered_json shared = old;  // the rotations are an attribute as well
  shared["meshes"][0]["primitives"][0]["attributes"]["_TURN"] = old["accessors"].size() - 1;
  CHECK(binary_of(made(shared, false)).size() == binary_of(all).size());
  CHECK(number(made(shared, false), "accessors") == number(all, "accessors"));
  ordered_json behind = old;  // something stands behind them
  behind["images"].push_back({{"bufferView", old["bufferViews"].size()}, {"mimeType", "image/png"}});
  behind["bufferViews"].push_back(old["bufferViews"].back());
  CHECK(number(made(behind, false), "accessors") == number(all, "accessors") - 2);
  CHECK(number(made(behind, false), "bufferViews") == number(all, "bufferViews") + 1);
  CHECK(binary_of(made(behind, false)).size() == binary_of(all).size());
}

TEST_CASE("a character whose data stand in the document in base64 becomes a file with binary data") {
  const auto bytes = rigs::glb_of(mixamo());
  const std::string text = rigs::gltf_of(bytes);
  const auto walk = synthetic::walk({.frames = 5});
  const auto embedded = ml::GlbRig(std::as_bytes(std::span(text)), "rig.gltf").with(std::span(&walk, 1));
  CHECK(embedded == rig_of(bytes).with(std::span(&walk, 1)));
}

TEST_CASE("the bones of a VRM avatar are those that the file names, not its nodes") {
  const auto skeleton = rigs::skeleton_of(ml::skeleton_table("VRM"));
  auto odd = skeleton;
  for (std::size_t j = 0; j < odd.names.size(); ++j) odd.names[j] = ml::concat_text("Bone.", j);
  odd.names.back() = "head";  // the thumb
  const auto bytes = rigs::glb_of(odd);
  const auto binary = ml::detail::parse_glb_chunks(bytes, "odd").binary;
  CHECK_ERROR(rig_of(bytes), "[motionlang.config.103]");
  auto one = document_of(bytes), zero = one;
  for (std::size_t j = 1; j + 1 < odd.names.size(); ++j) {  // not the root on the floor; node 0 is the armature
    one["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"][skeleton.names[j]]["node"] = j + 1;
    zero["extensions"]["VRM"]["humanoid"]["humanBones"].push_back({{"bone", skeleton.names[j]}, {"node", j + 1}});
  }
  zero["extensions"]["VRM"]["humanoid"]["humanBones"].push_back({{"bone", "jaw"}, {"node", -1}});
  const auto walk = synthetic::walk({.frames = 11});
  const auto plain =
      ml::GlbFile(rig_of(rigs::glb_of(skeleton)).with(std::span(&walk, 1)), "plain").motion("walk", walk.fps);
  for (const auto& document : {one, zero}) {
    const auto rig = rig_of(ml::detail::glb_file(document.dump(), {binary.begin(), binary.end()}));
    CHECK(rig.table().name == "VRM");
    CHECK(rig.skeleton().names.front() == "hips");
    CHECK(rig.skeleton().find("head (no bone)") >= 0);
    const auto made = rig.with(std::span(&walk, 1));
    CHECK(document_of(made)["nodes"] == document["nodes"]);  // names in the file stay
    const auto moved = ml::GlbFile(made, "made").motion("walk", walk.fps);
    CHECK(synthetic::largest_distance(moved, plain) < 1e-9);
  }
  one["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]["hips"]["node"] = 999;
  CHECK_ERROR(rig_of(ml::detail::glb_file(one.dump(), {binary.begin(), binary.end()})),
              "humanBones.hips.node: node 999 of ");
}

TEST_CASE("several skins: the one with a body is taken") {
  const auto bytes = rigs::glb_of(mixamo());
  const auto chunks = ml::detail::parse_glb_chunks(bytes, "rig");
  auto document = document_of(bytes);
  ordered_json hair = document["skins"][0];
  hair["joints"] = ordered_json::array({document["nodes"].size() - 2});
  hair.erase("inverseBindMatrices");
  document["skins"].insert(document["skins"].begin(), hair);
  document["nodes"].back()["skin"] = 1;
  const auto two = ml::detail::glb_file(document.dump(), {chunks.binary.begin(), chunks.binary.end()});
  CHECK(rig_of(two).table().name == "Mixamo");
  document["skins"][1] = document["skins"][0];  // hair twice: the body is in no skin
  const auto bare = ml::detail::glb_file(document.dump(), {chunks.binary.begin(), chunks.binary.end()});
  CHECK(rig_of(bare).table().name == "Mixamo");
  CHECK(rig_of(bare).skeleton().names.front() == "mixamorig:Hips");
  for (auto& node : document["nodes"]) node.erase("name");
  const auto none = ml::detail::glb_file(document.dump(), {chunks.binary.begin(), chunks.binary.end()});
  CHECK_ERROR(rig_of(none), "none of 2 skins is a body that is known; skin 0: detect_skeleton_table: ");
  CHECK_ERROR(rig_of(none), "; skin 1: detect_skeleton_table: ");

  ordered_json crowd = {{"asset", {{"version", "2.0"}}}};  // of which the first are tried
  for (int i = 0; i < 8000; ++i) {
    crowd["nodes"].push_back(ordered_json::object());
    crowd["skins"].push_back({{"joints", {i}}});
  }
  CHECK_ERROR(rig_of(ml::detail::glb_file(crowd.dump(), {})), "none of 8000 skins is a body that is known; skin 0: ");
}

TEST_CASE("what cannot be done is an error, and nothing is written") {
  const auto rig = rig_of(rigs::glb_of(mixamo()));
  const TemporaryFolder folder;
  std::vector<ml::Motion> motions;
  CHECK_ERROR(ml::write_glb(folder / "out.glb", rig, motions), "no motion to add");
  motions.push_back(synthetic::walk({.frames = 2}));
  motions[0].root[1].x = std::nan("");
  CHECK_ERROR(ml::write_glb(folder / "out.glb", rig, motions), "[motionlang.numeric.301]");
  motions[0] = synthetic::walk({.frames = 0});
  CHECK_ERROR(ml::write_glb(folder / "out.glb", rig, motions), "has no frames");
  motions[0] = synthetic::walk({.frames = 2});
  motions[0].skeleton.names[4] = "kneecap";
  CHECK_ERROR(ml::write_glb(folder / "out.glb", rig, motions), "needs a joint 'left_knee'");
  CHECK(std::filesystem::is_empty(folder.path));

  auto names = mixamo();
  names.names[2] = "Tail";
  CHECK_ERROR(rig_of(rigs::glb_of(names)), "no table fits a skeleton");
}

TEST_CASE("documents that are JSON but no glTF are refused, and a pelvis that no node is") {
  auto changed = [](const ml::Skeleton& skeleton, auto change) {
    const auto bytes = rigs::glb_of(skeleton);
    const auto binary = ml::detail::parse_glb_chunks(bytes, "rig").binary;
    ordered_json document = document_of(bytes);
    change(document);
    return ml::detail::glb_file(document.dump(), {binary.begin(), binary.end()});
  };
  const std::vector<ml::Motion> walks(1, synthetic::walk({.frames = 2}));
  const auto number = changed(mixamo(), [](ordered_json& d) { d["animations"][0]["name"] = 7; });
  CHECK_ERROR(rig_of(number).with(walks), "[motionlang.config.107]");
  CHECK(ml::GlbFile(rig_of(number).with(walks, {.keep_animations = false}), "only").animation_names() ==
        std::vector<std::string>{"walk"});
  const auto object = changed(mixamo(), [](ordered_json& d) { d["animations"] = ordered_json::object(); });
  CHECK_ERROR(rig_of(object).with(walks), "[motionlang.config.107]");

  // Thighs and spine stand side by side: the "root" over them is made up, and ASF's pelvis has that name.
  const auto trees = changed(rigs::skeleton_of(ml::skeleton_table("CMU ASF")), [](ordered_json& d) {
    for (const int above : {0, 1, 2}) d["nodes"][static_cast<std::size_t>(above)].erase("children");
    d["skins"][0]["joints"].erase(0);
    d["skins"][0]["joints"].erase(0);
  });
  CHECK_ERROR(rig_of(trees), "no node is the root of all joints of the body");
}
