// GLB: what is written obeys glTF and comes back; rigs of other programs; files that must be refused.
#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/formats/detail/figure_mesh.hpp>
#include <motionlang/formats/detail/gltf_document.hpp>
#include <motionlang/formats/glb.hpp>

#include "../../support/gltf_builder.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using gltf::Builder;
using nlohmann::json;

namespace {

/// A file of another program, 2056 bytes: joints pelvis and spine1 (rest at y = 0.5), one triangle, an animation with
/// times 0, 0.05, 0.1 in which the pelvis rises to 0.2 and spine1 turns by 90 degrees about z. A zlib stream in base64.
constexpr std::string_view other_program =
    "eNqlVMFu2kAQNVFV5Qd6j/ZsRV7bkICUpElEGyICVUHpIaLVAgtsY68te0kaIUuR+iv9jx56Jd/SQ3+gs2tjjE0QaY0Qntn35s2+GTF2uu92"
    "NE3b3dW0H6817bLTbs0QCUMqUG2G7mgQMo+jGjL3DaSjMeU0IMILICNoKFCko3AASVQzkrcQ1W5miHtD9WboZi/q6WkMJ8QFNPKpc8dCKDmY"
    "MGcYUNC4wQAUAeGhQ4RSBTp8epGe0kKfcYrRGtx+eRXZ94YPgHNpOImbu2WANGQzMpd04wfMZYLdJSERImD9qZDhDH1odxrdRrul+JftRqvb"
    "+WKgGtbRp3rj/UUcmWAB40M2kBwrUreVWnHBrx7jIjZC3o5x6Sg9A8IVASlFsiWBOlR4iwYJZ6662opl98S5hRuFxPUdqKKOGPenMKmyjryp"
    "UK8HUkXQwPcW7qBmo1U//YikOUV85Xl8T06HcE6dWCxRVnYIEozjHZGjVSmfiInci8xkIqmZ0nCRhlNa4IkFR3lIBmBO6CX37E9HIxpcM3qv"
    "pAae63ucctF98KFKGZsVmZxyKG2Bisqi6/q5JVeALVcJIvJNRrAuOFmYbG28rjZeX9tGebb5gs6KbGsd21rD7pyfNpN5Zvn2ZnUz5V+ddovq"
    "5W17T9RTXzOeYiN+sF01MK5gs+Bv5b8cOnjR5OUWLdnZPVI71H8QtD0aqX+6JGxSPpbLaFWWm2rZ1Yq5bKRAldgsF5vbc+3DVa6Mt+VWc7q5"
    "lq0NVGzY+Z4PN8BNy8zDN6FtO3+pTeiqmbd+ObZkZNlTaLQX7e3tXZQ07azR0nLPyWr4GMclLfPzFnKPxwXMs3FJ21mbf2nun/g/s7mnefPo"
    "aT4/eg7/5vev48/fnTT+86p8Ir95hWwNqKm8+AuAxT4P";

std::vector<std::byte> other_program_bytes() {
  const auto zlib = ml::detail::from_base64(other_program);
  return ml::detail::inflate(std::span(zlib).subspan(2), 10'000, "zlib").data;  // after the two bytes of zlib's header
}

/// Two joints, the second one metre above the first; it turns by 90 degrees about z within one second.
Builder two_joints() {
  Builder b;
  b.node({{"name", "a"}, {"children", {1}}});
  b.node({{"name", "b"}, {"translation", {0, 1, 0}}});
  b.skin({0, 1});
  const int times = b.floats({0, 1}, "SCALAR");  // accessor 0, rotations are accessor 1
  b.animate(1, "rotation", times, b.floats({0, 0, 0, 1, 0, 0, std::sqrt(0.5f), std::sqrt(0.5f)}, "VEC4"));
  return b;
}

}  // namespace

TEST_CASE("long motions come back with their last frame, although times are single precision") {
  const auto skeleton = ml::Skeleton::from_joints({{"a", "", {0, 0, 0}}, {"b", "a", {0, 1, 0}}});
  for (const int frames : {2000, 4000, 6000, 8000}) {
    for (const double fps : {30.0, 100.0, 119.9}) {
      CAPTURE(frames);
      CAPTURE(fps);
      ml::Motion motion{skeleton, fps, {}, {}, "long"};
      motion.root.resize(static_cast<std::size_t>(frames));
      motion.local.assign(2 * static_cast<std::size_t>(frames), ml::Quaternion<double>::identity());
      CHECK(ml::GlbFile(ml::glb_bytes(std::span(&motion, 1)), "long.glb").motion(0, fps).frames() == frames);
    }
  }
}

TEST_CASE(
    "the frame rate of half an hour is found, although late times are rounded to more than a hundredth of a frame") {
  const auto skeleton = ml::Skeleton::from_joints({{"a", "", {0, 0, 0}}, {"b", "a", {0, 1, 0}}});
  constexpr std::size_t frames = 252000;
  ml::Motion motion{skeleton, 120, std::vector<ml::Vec3<double>>(frames), {}, "long"};
  motion.local.assign(2 * frames, ml::Quaternion<double>::identity());
  const ml::Motion back = ml::GlbFile(ml::glb_bytes(std::span(&motion, 1)), "long.glb").motion(0);
  CHECK(back.fps == 120);
  CHECK(back.frames() == frames);
}

TEST_CASE("a motion comes back") {
  const TemporaryFolder folder;
  for (const int frames : {1, 50}) {
    const ml::Motion motion = synthetic::walk({.frames = frames, .turn = 0.5});
    ml::write_glb(folder / "walk.glb", motion);
    const ml::Motion back = ml::read_glb(folder / "walk.glb");
    if (frames > 1) CHECK(back.fps == 20);
    CHECK(back.name == "walk");
    CHECK(back.frames() == frames);
    CHECK(back.skeleton.names == motion.skeleton.names);
    CHECK(back.skeleton.parents == motion.skeleton.parents);
    CHECK(synthetic::largest_distance(motion, back) < 1e-5);
  }
}

TEST_CASE("the frame rate is that of the keys, where they are at frames") {
  for (const double fps : {12.5, 20.0, 24000 / 1001.0, 30.0, 120.0}) {
    ml::Motion motion = synthetic::walk({.frames = 700});
    motion.fps = fps;
    const ml::GlbFile file(ml::glb_bytes(std::span(&motion, 1)), "memory");
    CHECK(file.rate(0) == doctest::Approx(fps).epsilon(1e-6));
    CHECK(file.motion(0).frames() == 700);
  }
  struct Keys {
    std::vector<float> times, others;  // of the arm, of its hand
    double rate;
  };
  for (const auto& keys : {Keys{{0, 0.05F, 0.1F, 0.15F}, {0, 0.15F}, 20},
                           {{0, 0.05F, 0.1F, 0.15F}, {0.07F}, 20},  // a pose that is held
                           {{0, 0.05F, 0.1F}, {0.15F}, 20},
                           {{0, 0.05F, 0.15F}, {0}, 20},  // a key that was left out
                           {{0, 0.5F, 1}, {0}, 30},
                           {{0, 1e-4F}, {0}, 30},
                           {{0.05F, 0.1F, 0.15F}, {0.15F}, 20},  // not from 0 on
                           {{0}, {0}, 30}}) {
    Builder b = two_joints();
    b.document.erase("animations");
    const auto animate = [&](int node, const std::vector<float>& times) {
      std::vector<float> values;
      for (std::size_t k = 0; k < times.size(); ++k) values.insert(values.end(), {0, 0, 0, 1});
      b.animate(node, "rotation", b.floats(times, "SCALAR"), b.floats(values, "VEC4"));
    };
    animate(0, keys.times), animate(1, keys.others);
    CHECK(b.file().rate(0) == keys.rate);
  }
  CHECK_THROWS_WITH_AS(two_joints().file().rate(1), doctest::Contains("103"), ml::config_error);
}

TEST_CASE("several motions, by name and by number; other frame rates keep the speed") {
  std::vector<ml::Motion> motions{synthetic::walk({.frames = 3}), synthetic::walk({.frames = 41, .turn = 1})};
  motions[1].name = "turn";
  const ml::GlbFile file(ml::glb_bytes(motions), "memory");
  CHECK(file.animation_names() == std::vector<std::string>{"walk", "turn"});
  CHECK(file.motion(0, 20).frames() == 3);
  const ml::Motion turn = file.motion("turn", 60);
  CHECK(turn.frames() == 121);
  CHECK(ml::norm(turn.root_at(120) - motions[1].root_at(40)) < 1e-5);
  CHECK_THROWS_WITH_AS(file.motion("run"), doctest::Contains("103"), ml::config_error);
  CHECK_THROWS_WITH_AS(file.motion(2), doctest::Contains("103"), ml::config_error);
  CHECK_THROWS_WITH_AS(file.motion(0, 0), doctest::Contains("101"), ml::config_error);
}

TEST_CASE("all skeletons can be written, also one joint and names that are not UTF-8") {
  auto standing = [](const ml::Skeleton& s) {
    return ml::Motion{s, 20, {s.offset(0)}, std::vector(s.parents.size(), ml::Quaternion<double>::identity()), ""};
  };
  for (const auto& s : {ml::kit21_skeleton(), ml::Skeleton::from_joints({{"only", "", {0, 1, 0}}}),
                        ml::Skeleton::from_joints({{"a\xFF", "", {}}, {"b", "a\xFF", {0, 1, 0}}})}) {
    const ml::Motion motion = standing(s);
    const ml::Motion back = ml::GlbFile(ml::glb_bytes(std::span(&motion, 1)), "memory").motion("motion");
    CHECK(back.skeleton.size() == s.size());
    CHECK(synthetic::largest_distance(motion, back) < 1e-6);
  }
}

TEST_CASE("the file obeys the rules of glTF") {
  const ml::Motion motion = synthetic::walk({.frames = 30});
  const auto bytes = ml::glb_bytes(std::span(&motion, 1));
  CHECK(bytes.size() % 4 == 0);
  CHECK(ml::detail::load<std::uint32_t>(bytes, 8, "", "") == bytes.size());
  const auto chunks = ml::detail::parse_glb_chunks(bytes, "memory");
  const json& d = chunks.document;
  CHECK(d["buffers"][0]["byteLength"] == chunks.binary.size());
  const ml::detail::GltfDocument document(bytes, "memory");
  auto values = [&](const json& accessor) {
    const std::string type = d["accessors"][accessor.get<std::size_t>()]["type"];
    return document.values(accessor.get<ml::Index>(), type == "SCALAR" ? 1u
                                                      : type == "VEC3" ? 3u
                                                      : type == "VEC4" ? 4u
                                                                       : 16u);
  };

  for (const json& view : d["bufferViews"]) CHECK(view["byteOffset"].get<int>() % 4 == 0);
  for (std::size_t i = 0; i < d["accessors"].size(); ++i) {
    const json& a = d["accessors"][i];
    const auto v = values(i);  // throws if the accessor does not lie inside its view
    if (!a.contains("min")) continue;
    const std::size_t n = a["min"].size();
    for (std::size_t c = 0; c < n; ++c) {
      double low = v[c], high = v[c];
      for (std::size_t k = c; k < v.size(); k += n) low = std::min(low, v[k]), high = std::max(high, v[k]);
      CHECK(a["min"][c].get<double>() == low);
      CHECK(a["max"][c].get<double>() == high);
    }
  }
  const json& primitive = d["meshes"][0]["primitives"][0];
  const auto joints = values(primitive["attributes"]["JOINTS_0"]),
             weights = values(primitive["attributes"]["WEIGHTS_0"]);
  for (std::size_t i = 0; i < weights.size(); i += 4) {
    CHECK(weights[i] + weights[i + 1] + weights[i + 2] + weights[i + 3] == 1);
    CHECK(joints[i] < motion.skeleton.size());
  }
  const auto positions = values(primitive["attributes"]["POSITION"]),
             normals = values(primitive["attributes"]["NORMAL"]);
  for (const double index : values(primitive["indices"])) CHECK(3 * index + 2 < static_cast<double>(positions.size()));
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    CHECK(std::hypot(normals[i], normals[i + 1], normals[i + 2]) == doctest::Approx(1).epsilon(1e-6));
  }
  const auto inverse_bind = values(d["skins"][0]["inverseBindMatrices"]);
  const auto rest = motion.skeleton.rest_positions();
  for (std::size_t j = 0; j < rest.size(); ++j) {
    const double* m = inverse_bind.data() + 16 * j;
    CHECK(ml::norm(rest[j] + ml::Vec3{m[12], m[13], m[14]}) < 1e-6);
    CHECK(m[0] + m[5] + m[10] + m[15] == 4);
  }
  for (const json& sampler : d["animations"][0]["samplers"]) {
    const auto v = values(sampler["output"]);
    if (d["accessors"][sampler["output"].get<std::size_t>()]["type"] != "VEC4") continue;
    for (std::size_t i = 0; i < v.size(); i += 4) {
      CHECK(std::sqrt(v[i] * v[i] + v[i + 1] * v[i + 1] + v[i + 2] * v[i + 2] + v[i + 3] * v[i + 3]) ==
            doctest::Approx(1).epsilon(1e-6));
      if (i > 0) CHECK(v[i] * v[i - 4] + v[i + 1] * v[i - 3] + v[i + 2] * v[i - 2] + v[i + 3] * v[i - 1] >= 0);
    }
  }
}

TEST_CASE("triangles of the figure face outwards") {
  const auto& s = ml::smpl24_skeleton();
  const auto mesh = ml::detail::make_mesh(ml::make_figure(s), s);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const auto a = mesh.triangles[i], b = mesh.triangles[i + 1], c = mesh.triangles[i + 2];
    const auto face = ml::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    CHECK(ml::dot(face, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) > 0);
  }
}

TEST_CASE("a file of another program") {
  const auto bytes = other_program_bytes();
  REQUIRE(bytes.size() == 2056);
  const ml::GlbFile file(bytes, "other.glb");
  CHECK(file.skeleton().names == std::vector<std::string>{"pelvis", "spine1"});
  REQUIRE(file.animation_names().size() == 1);
  const ml::Motion motion = file.motion(0, 20);
  REQUIRE(motion.frames() == 3);
  CHECK(motion.root_at(1).y == doctest::Approx(0.1));

  ml::JointTransforms<double> world;
  motion.world(2, world);
  const auto rest = motion.skeleton.rest_positions();
  auto skinned = [&](const ml::Vec3<double>& v, double pelvis, double spine) {  // linear blend skinning
    return pelvis * (world.position[0] + world.rotation[0] * (v - rest[0])) +
           spine * (world.position[1] + world.rotation[1] * (v - rest[1]));
  };
  CHECK(ml::norm(skinned({0, 1, 0}, 0, 1) - ml::Vec3{-0.5, 0.7, 0.0}) < 1e-6);
  CHECK(ml::norm(skinned({0, 0, 0}, 0.75, 0.25) - ml::Vec3{0.125, 0.325, 0.0}) < 1e-6);
}

TEST_CASE("interpolation: linear, step, cubic; before the first and after the last key") {
  const double quarter = std::numbers::pi / 2;
  auto angle = [](const ml::Motion& m, ml::Index frame) { return ml::to_axis_angle(m.rotations(frame)[1]).v.z; };
  CHECK(angle(two_joints().file().motion(0, 4), 1) == doctest::Approx(quarter / 4));

  Builder step = two_joints();
  step.document["animations"][0]["samplers"][0]["interpolation"] = "STEP";
  CHECK(angle(step.file().motion(0, 4), 3) == doctest::Approx(0));
  CHECK(angle(step.file().motion(0, 4), 4) == doctest::Approx(quarter));

  Builder cubic;
  cubic.node({{"name", "a"}});
  cubic.skin({0});
  // from 0 to 1 within two seconds, with slopes 1 and 0: p(u = 1/2) = 1/2 + 2 * 1/8
  cubic.animate(0, "translation", cubic.floats({1, 3}, "SCALAR"),
                cubic.floats({0, 0, 0, 0, 0, 0, 1, 0, 0, /**/ 0, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3"), "CUBICSPLINE");
  const ml::Motion motion = cubic.file().motion(0, 1);
  REQUIRE(motion.frames() == 4);
  CHECK(motion.root_at(0).x == 0);  // before the first key
  CHECK(motion.root_at(2).x == doctest::Approx(0.75));
  CHECK(motion.root_at(3).x == 1);
}

TEST_CASE("rest rotations and what stands above the root are taken into the skeleton") {
  // An armature with Z up in centimetres; its bones point along their own y axis, as Blender writes them.
  Builder b;
  const double r = std::sqrt(0.5);
  b.node({{"name", "armature"}, {"rotation", {-r, 0, 0, r}}, {"scale", {0.01, 0.01, 0.01}}, {"children", {1}}});
  b.node({{"name", "hips"}, {"translation", {0, 0, 90}}, {"rotation", {r, 0, 0, r}}, {"children", {2}}});
  b.node({{"name", "arm"}, {"translation", {0, 50, 0}}, {"rotation", {0, 0, -r, r}}, {"children", {3}}});
  b.node({{"name", "hand"}, {"translation", {0, 30, 0}}});
  b.skin({1, 2, 3});
  b.animate(2, "rotation", b.floats({0}, "SCALAR"), b.floats({0, 0, 0, 1}, "VEC4"));
  const ml::Motion motion = b.file().motion(0);
  const auto rest = motion.skeleton.rest_positions();
  CHECK(ml::norm(rest[0] - ml::Vec3{0.0, 0.9, 0.0}) < 1e-12);
  CHECK(ml::norm(rest[1] - ml::Vec3{0.0, 1.4, 0.0}) < 1e-12);
  CHECK(ml::norm(rest[2] - ml::Vec3{0.3, 1.4, 0.0}) < 1e-12);  // the arm points to +x
  const auto posed = motion.positions();                       // its rotation is taken away: it points up
  CHECK(ml::norm(posed[2] - ml::Vec3{0.0, 1.7, 0.0}) < 1e-12);
  CHECK(ml::distance(motion.rotations(0)[0], ml::Quaternion<double>::identity()) < 1e-12);
}

TEST_CASE("hips that move below a root on the floor become the root; control bones without a skin are left out") {
  Builder b;
  b.node({{"name", "root"}, {"children", {1, 3}}});
  b.node({{"name", "hips"}, {"translation", {0, 1, 0}}, {"children", {2}}});
  b.node({{"name", "spine"}, {"translation", {0, 0.5, 0}}});
  b.node({{"name", "ik_target"}, {"translation", {1, 0, 0}}});
  b.skin({0, 1, 2, 3});
  const int weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"), joints = b.floats({1, 0, 0, 0, 2, 0, 0, 0}, "VEC4");
  b.document["meshes"] =
      json::array({{{"primitives", json::array({{{"attributes", {{"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}}})}}});
  b.node({{"name", "mesh"}, {"mesh", 0}, {"skin", 0}});
  const int times = b.floats({0, 1}, "SCALAR");
  b.animate(0, "translation", times, b.floats({0, 0, 0, 0, 0, 2}, "VEC3"));
  b.animate(1, "translation", times, b.floats({0, 1, 0, 0, 0.8f, 0}, "VEC3"));
  const ml::Motion motion = b.file().motion(0, 1);
  CHECK(motion.skeleton.names == std::vector<std::string>{"hips", "spine"});
  CHECK(ml::norm(motion.root_at(1) - ml::Vec3{0.0, 0.8, 2.0}) < 1e-6);
}

TEST_CASE("joints below the root that move along their bones are reported") {
  Builder b = two_joints();
  b.document["nodes"][1]["children"] = {2};
  b.node({{"name", "c"}, {"translation", {0, 1, 0}}});
  b.skin({0, 1, 2});
  b.document["skins"].erase(0);
  const int times = b.floats({0, 1}, "SCALAR");
  b.animate(0, "translation", times, b.floats({0, 0, 0, 0, 0, 2}, "VEC3"));
  CHECK(b.file().stretched_joints(0).empty());
  b.animate(2, "translation", times, b.floats({0, 1, 0, 0, 1.005f, 0}, "VEC3"));  // noise
  CHECK(b.file().stretched_joints(0).empty());
  b.document["animations"][0]["samplers"][2]["output"] = b.floats({0, 1, 0, 0, 1.5f, 0}, "VEC3");
  CHECK(b.file().stretched_joints(0) == std::vector<std::string>{"c"});
  b.document["animations"][0]["channels"][2]["target"] = {{"node", 0}, {"path", "scale"}};  // what a carries
  CHECK(b.file().stretched_joints(0) == std::vector<std::string>{"b"});
  CHECK(b.file().motion(0).skeleton.offset(2) == ml::Vec3{0.0, 1.0, 0.0});
  CHECK_THROWS_WITH_AS(b.file().stretched_joints(1), doctest::Contains("animation 1 of 1"), ml::config_error);
}

TEST_CASE("skins with several roots, repeated and missing names, no skin at all") {
  Builder b = two_joints();
  b.document["nodes"][1]["name"] = "a";
  b.node({{"translation", {2, 0, 0}}});
  b.node({{"name", ""}});
  b.document["skins"][0]["joints"] = {0, 1, 2, 3};
  const ml::Skeleton s = b.file().skeleton();
  CHECK(s.names == std::vector<std::string>{"root", "a", "a_2", "node_2", "node_3"});
  CHECK(s.parents == std::vector<int>{-1, 0, 1, 0, 0});
  b.document.erase("skins");  // only node 1 is animated then
  CHECK(b.file().skeleton().names == std::vector<std::string>{"a"});
}

TEST_CASE("integers that stand for real numbers") {
  Builder b = two_joints();
  const std::int16_t values[] = {0, 0, 0, 32767, 0, 0, 23170, 23170};
  b.document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", b.binary.size()}, {"byteLength", sizeof values}});
  ml::detail::append_bytes(b.binary, std::as_bytes(std::span(values)));
  b.document["accessors"].push_back(
      {{"bufferView", 2}, {"componentType", 5122}, {"normalized", true}, {"count", 2}, {"type", "VEC4"}});
  b.document["animations"][0]["samplers"][0]["output"] = 2;
  CHECK(ml::to_axis_angle(b.file().motion(0, 1).rotations(1)[1]).v.z == doctest::Approx(std::numbers::pi / 2));
}

TEST_CASE("what cannot be written is an error") {
  std::vector<ml::Motion> motions;
  CHECK_THROWS_WITH_AS(ml::glb_bytes(motions), doctest::Contains("101"), ml::config_error);
  motions.push_back(synthetic::walk({.frames = 2}));
  motions.push_back(synthetic::walk({.frames = 2}, ml::humanml3d22_skeleton()));
  CHECK_THROWS_WITH_AS(ml::glb_bytes(motions), doctest::Contains("102"), ml::config_error);
  motions.resize(1);
  motions[0].fps = 1e300;
  CHECK_THROWS_WITH_AS(ml::glb_bytes(motions), doctest::Contains("101"), ml::config_error);
  motions[0].root.clear();
  motions[0].local.clear();
  CHECK_THROWS_WITH_AS(ml::glb_bytes(motions), doctest::Contains("101"), ml::config_error);
  motions[0] = synthetic::walk({.frames = 2});
  motions[0].root[1].x = 1e300;
  CHECK_THROWS_WITH_AS(ml::glb_bytes(motions), doctest::Contains("301"), ml::numeric_error);
}

TEST_CASE("other versions of glTF and packed data are refused by name") {
  Builder b = two_joints();
  b.document["asset"]["version"] = "1.0";
  CHECK_THROWS_WITH_AS(b.file(), doctest::Contains("glTF of version 1.0"), ml::io_error);
  b = two_joints();
  b.document["extensionsRequired"] = {"KHR_texture_basisu"};  // of pictures
  CHECK(b.file().motion(0).frames() > 1);
  b.document["bufferViews"][1]["extensions"]["EXT_meshopt_compression"] = json::object();
  CHECK_THROWS_WITH_AS(b.file().motion(0), doctest::Contains("packed by EXT_meshopt_compression"), ml::io_error);
}

namespace {

/// Gives the rotations of two_joints() one more accessor: that of `base` where it has them, else zeros, with element
/// `place` replaced by half a turn about z.
void replace_rotation(Builder& b, int place, bool has_base) {
  const std::array<std::uint16_t, 2> index{static_cast<std::uint16_t>(place), 0};
  b.document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", b.binary.size()}, {"byteLength", 2}});
  ml::detail::append_bytes(b.binary, std::as_bytes(std::span(index)));
  const int values = b.floats({0, 0, 1, 0}, "VEC4");
  json& accessors = b.document["accessors"];
  json sparse = accessors[1];
  if (!has_base) sparse.erase("bufferView");
  sparse["sparse"] = {{"count", 1},
                      {"indices", {{"bufferView", 2}, {"componentType", 5123}}},
                      {"values", {{"bufferView", accessors[static_cast<std::size_t>(values)]["bufferView"]}}}};
  accessors.push_back(std::move(sparse));
  b.document["animations"][0]["samplers"][0]["output"] = accessors.size() - 1;
}

}  // namespace

TEST_CASE("sparse accessors: some values are replaced, those that are not in the file are 0") {
  auto angle = [](const Builder& b, ml::Index frame) {
    return ml::to_axis_angle(b.file().motion(0, 1).rotations(frame)[1]).v.z;
  };
  Builder b = two_joints();
  replace_rotation(b, 0, true);
  CHECK(angle(b, 0) == doctest::Approx(std::numbers::pi));
  CHECK(angle(b, 1) == doctest::Approx(std::numbers::pi / 2));

  b = two_joints();
  b.document["nodes"][1]["rotation"] = {0.6, 0, 0, 0.8};  // at rest; for a quaternion of zeros
  replace_rotation(b, 1, false);
  const ml::Motion motion = b.file().motion(0, 1);
  CHECK(ml::distance(motion.rotations(0)[1], ml::Quaternion<double>::identity()) < 1e-9);
  CHECK(ml::distance(motion.rotations(1)[1],
                     ml::Quaternion<double>{0, 0, 0, 1} * ml::Quaternion<double>{0.8, -0.6, 0, 0}) < 1e-9);

  auto refused = [](auto change, const char* text) {
    Builder damaged = two_joints();
    replace_rotation(damaged, 1, true);
    change(damaged.document["accessors"].back()["sparse"]);
    INFO(damaged.document.dump());
    CHECK_THROWS_WITH_AS(damaged.file(), doctest::Contains(text), ml::error);
  };
  refused([](json& s) { s["indices"]["byteOffset"] = 1; }, "1 element does not fit into 2 bytes");
  refused([](json& s) { s["indices"]["componentType"] = 5126; }, "componentType 5126");
  refused([](json& s) { s["indices"]["componentType"] = 5125; }, "402");
  refused([](json& s) { s["count"] = 2; }, "402");
  refused([](json& s) { s["count"] = 1'000'000'000'000; }, "402");
  refused([](json& s) { s["values"]["bufferView"] = 99; }, "107");
  refused([](json& s) { s.erase("values"); }, "107");
  Builder beyond = two_joints();
  replace_rotation(beyond, 2, true);
  CHECK_THROWS_WITH_AS(beyond.file(), doctest::Contains("index 0 is 2, expected one from 0 on and below 2"),
                       ml::io_error);
  Builder twice = two_joints();
  replace_rotation(twice, 1, true);
  json& sparse = twice.document["accessors"].back()["sparse"];
  sparse["count"] = 2, sparse["indices"] = {{"bufferView", 2}, {"componentType", 5121}};  // 1, 0
  twice.document["bufferViews"][3] = twice.document["bufferViews"][1];
  CHECK_THROWS_WITH_AS(twice.file(), doctest::Contains("index 1 is 0, expected one from 2 on and below 2"),
                       ml::io_error);
}

TEST_CASE("data in base64, in a GLB file and in the document alone, which is a .gltf file") {
  Builder b = two_joints();
  const ml::Motion want = b.file().motion(0);
  const auto uri = [](std::span<const std::byte> bytes) {
    return "data:application/octet-stream;base64," + ml::detail::to_base64(bytes);
  };
  b.document["buffers"] = json::array({{{"byteLength", b.binary.size()}, {"uri", uri(b.binary)}}});
  for (const auto& bytes :
       {ml::detail::glb_file(b.document.dump(), {}), ml::detail::glb_file(b.document.dump(), {9, std::byte{7}})})
    CHECK(synthetic::largest_distance(ml::GlbFile(bytes, "embedded.glb").motion(0), want) == 0);
  const std::string text = "\n " + b.document.dump(1);
  const auto bytes = std::as_bytes(std::span(text));
  CHECK(synthetic::largest_distance(ml::GlbFile(bytes, "embedded.gltf").motion(0), want) == 0);

  Builder two = two_joints();  // times in the chunk, rotations in a second buffer
  const auto rotations = std::span(two.binary).subspan(8);
  two.document["bufferViews"][1] = {{"buffer", 1}, {"byteLength", 32}};
  two.document["buffers"].push_back({{"byteLength", 32}, {"uri", uri(rotations)}});
  two.binary.resize(8);
  CHECK(synthetic::largest_distance(two.file().motion(0), want) == 0);

  for (std::size_t n = 0; n < bytes.size(); ++n) CHECK_THROWS_AS(ml::GlbFile(bytes.first(n), "cut"), ml::error);
}

TEST_CASE("what glTF does not allow but its meaning is clear is read, and sentences say how") {
  const auto read = [](auto change) {
    Builder b = two_joints();
    change(b.document);
    return b.file();
  };
  const ml::Motion right = two_joints().file().motion(0, 10);
  const auto same = [&](const ml::GlbFile& file) { return file.motion(0, 10).local == right.local; };
  using Sentences = std::vector<std::string>;

  const auto zeros = read([](json& d) { d["nodes"][0]["rotation"] = {0, 0, 0, 0}; });
  CHECK(zeros.repairs() == Sentences{"node 'a' has a rotation of zeros: it is read as no rotation"});
  CHECK(same(zeros));
  const auto twice = read([](json& d) {
    json& a = d["animations"][0];
    a["channels"].push_back(json(a["channels"][0]));
    a["samplers"].push_back({{"input", 0}, {"output", 1}, {"interpolation", "STEP"}});
    a["channels"][1]["sampler"] = 1;
  });
  CHECK(twice.repairs() ==
        Sentences{"animation 'clip' has several channels for the rotation of 'b': the first of them counts"});
  CHECK(same(twice));
  const auto fewer = read([](json& d) { d["accessors"][1]["count"] = 1; });
  CHECK(fewer.repairs() == Sentences{"animation 'clip' has 2 times for 1 key: the first of them count"});
  CHECK(fewer.motion(0).frames() == 1);
  const auto more = read([](json& d) { d["accessors"][0]["count"] = 1; });
  CHECK(more.repairs() == Sentences{"animation 'clip' has 1 time for 2 keys: the first of them count"});
  CHECK(more.motion(0).local == fewer.motion(0).local);

  Builder b = two_joints();
  json d = b.document;
  d["buffers"][0].erase("byteLength");
  CHECK(same(ml::GlbFile(ml::detail::glb_file(d.dump(), b.binary), "no length")));
  d["buffers"][0]["uri"] = "data:;base64," + ml::detail::to_base64(b.binary);
  const std::string text = d.dump(), marked = "\xEF\xBB\xBF" + text;
  CHECK(same(ml::GlbFile(std::as_bytes(std::span(text)), "no length in base64")));
  CHECK(same(ml::GlbFile(std::as_bytes(std::span(marked)), "byte order mark")));
}

TEST_CASE("hostile documents") {
  auto refused = [](auto change, const char* text) {
    Builder b = two_joints();
    change(b.document);
    INFO(b.document.dump());
    CHECK_THROWS_WITH_AS(b.file().motion(0), doctest::Contains(text), ml::error);
  };
  refused([](json& d) { d["nodes"][1]["children"] = {0}; }, "cycle");
  refused([](json& d) { d["nodes"][0]["children"] = {0}; }, "cycle");
  refused([](json& d) { d["nodes"][0]["children"] = {1, 1}; }, "two parents");
  refused([](json& d) { d["nodes"][0]["children"] = {7}; }, "403");
  refused([](json& d) { d["nodes"][0]["children"] = {-1}; }, "403");
  refused([](json& d) { d["nodes"][0]["children"] = "1"; }, "107");
  refused([](json& d) { d["nodes"][0]["rotation"] = {0, 0, 0, 1e-9}; }, "403");
  refused([](json& d) { d["nodes"][0]["translation"] = {0, 0}; }, "403");
  refused([](json& d) { d["nodes"][0]["scale"] = {1e300, 1, 1}, d["nodes"][1]["scale"] = {1e300, 1, 1}; }, "403");
  refused([](json& d) { d["skins"][0]["joints"] = {0, 99}; }, "403");
  refused([](json& d) { d["accessors"][1]["count"] = 1'000'000'000'000; }, "402");
  refused([](json& d) { d["accessors"][1]["count"] = 3; }, "402");
  refused([](json& d) { d["accessors"][1]["count"] = -2; }, "107");
  refused([](json& d) { d["accessors"][1]["count"] = 0; }, "403");
  refused([](json& d) { d["accessors"][1]["byteOffset"] = 18446744073709551615ull; }, "402");
  refused([](json& d) { d["accessors"][1]["componentType"] = 1; }, "403");
  refused([](json& d) { d["accessors"][1]["type"] = "VEC3"; }, "403");
  refused([](json& d) { d["accessors"][1]["sparse"] = json::object(); }, "no member 'indices'");
  refused([](json& d) { d["accessors"][1].erase("bufferView"), d["accessors"][1]["count"] = 1'000'000'000'000; },
          "405");
  refused([](json& d) { d["bufferViews"][1]["byteLength"] = 1u << 30; }, "402");
  refused([](json& d) { d["bufferViews"][1]["byteOffset"] = 18446744073709551600ull; }, "402");
  refused([](json& d) { d["bufferViews"][1]["byteStride"] = 4; }, "403");
  refused([](json& d) { d["bufferViews"][1]["buffer"] = 1; }, "no element 1 among 1");
  refused(
      [](json& d) {
        d["bufferViews"][1]["buffer"] = 1, d["buffers"].push_back({{"byteLength", 40}});
      },
      "buffers[1]: the buffer is not in this file");
  refused([](json& d) { d["buffers"][0]["uri"] = "http://example.org/"; }, "404");
  refused([](json& d) { d["buffers"][0]["uri"] = "data:application/octet-stream,AAAA"; }, "404");
  refused([](json& d) { d["buffers"][0]["uri"] = "data:;base64,AA*A"; }, "buffers[0]: character 2 is not of base64");
  refused([](json& d) { d["buffers"][0]["uri"] = "data:;base64,AAAA", d["buffers"][0]["byteLength"] = 40; },
          "needs 40 bytes at byte 0, the file has 3");
  refused([](json& d) { d["buffers"][0]["byteLength"] = 39; }, "buffer view needs 32 bytes at byte 8, the file has 39");
  refused([](json& d) { d["animations"][0]["channels"][0]["target"]["node"] = 5; }, "403");
  refused([](json& d) { d["animations"][0]["samplers"][0]["input"] = 99; }, "107");
  refused([](json& d) { d["animations"][0]["samplers"][0]["interpolation"] = "MAGIC"; }, "404");
  refused([](json& d) { d.erase("skins"), d["animations"][0]["channels"].clear(); }, "404");
  refused([](json& d) { d.erase("animations"); }, "103");

  Builder times = two_joints();
  times.document["animations"][0]["samplers"][0]["input"] = times.floats({0, std::nanf("")}, "SCALAR");
  CHECK_THROWS_WITH_AS(times.file(), doctest::Contains("not finite"), ml::io_error);
  times.document["animations"][0]["samplers"][0]["input"] = times.floats({0, 1e30f}, "SCALAR");
  CHECK_THROWS_WITH_AS(times.file().motion(0), doctest::Contains("405"), ml::io_error);

  Builder amplified;  // many animations over the same bytes
  amplified.node({{"name", "a"}});
  amplified.skin({0});
  std::vector<float> keys(10'000), rotations(40'000, 0.5f);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = static_cast<float>(i);
  const int input = amplified.floats(keys, "SCALAR");
  amplified.animate(0, "rotation", input, amplified.floats(rotations, "VEC4"));
  CHECK(amplified.file().motion(0, 1).frames() == 10'000);
  for (int i = 0; i < 300; ++i) amplified.document["animations"].push_back(amplified.document["animations"][0]);
  CHECK_THROWS_WITH_AS(amplified.file(), doctest::Contains("405"), ml::io_error);

  Builder chain = two_joints();  // far more joints than anybody has
  for (int i = 2; i < 5000; ++i) {
    chain.document["nodes"].back()["children"] = {i};
    chain.node(json::object());
    chain.document["skins"][0]["joints"].push_back(i);
  }
  CHECK_THROWS_WITH_AS(chain.file(), doctest::Contains("405"), ml::io_error);
}

TEST_CASE("a small file cannot ask for much memory: keys that are years apart, many animations") {
  const auto with_times = [](std::vector<float> times) {
    Builder b = two_joints();
    b.document["animations"][0]["samplers"][0]["input"] = b.floats(std::move(times), "SCALAR");
    return b;
  };
  CHECK_THROWS_WITH_AS(
      with_times({0, 1.6e6f}).file().motion(0),
      doctest::Contains("[motionlang.io.405] test.glb: animation 'clip' of 1600000 s at 30 per second: 96000012 "
                        "rotations (frames x joints), at most 10000000 of 2 keys"),
      ml::io_error);
  Builder six = with_times({0, 3e4f});
  CHECK(six.file().motions(1).front().frames() == 30'001);
  for (int i = 1; i < 6; ++i) six.document["animations"].push_back(six.document["animations"][0]);
  CHECK(six.file().motion(5, 30).frames() == 900'001);
  CHECK_THROWS_WITH_AS(six.file().motions(), doctest::Contains("6 animations: 10800012 rotations"), ml::io_error);

  Builder poses;  // many animations of one key, whose skeletons take more memory than their rotations
  json all = json::array();
  for (int i = 0; i < 400; ++i) {
    poses.node({{"name", "a joint with a name of 32 letters"}});
    if (i > 0) poses.document["nodes"][static_cast<std::size_t>(i) - 1]["children"] = {i};
    all.push_back(i);
  }
  poses.skin(std::move(all));
  poses.animate(0, "rotation", poses.floats({0}, "SCALAR"), poses.floats({0, 0, 0, 1}, "VEC4"));
  const auto with_animations = [&](std::size_t count) {
    poses.document["animations"].get_ref<json::array_t&>().resize(count, poses.document["animations"][0]);
    return poses.file();
  };
  CHECK(with_animations(5'000).motions().size() == 5'000);
  CHECK_THROWS_WITH_AS(with_animations(20'000).motions(),
                       doctest::Contains("[motionlang.io.405] test.glb: 20000 animations: 8000000 rotations (frames x "
                                         "joints) and skeletons that take the memory of 24181250, at most 10000000 of "
                                         "20000 keys"),
                       ml::io_error);
  CHECK(poses.file().motion(19'999).frames() == 1);

  Builder recording = two_joints();  // every key allows for sixteen
  std::vector<float> times(700'000), rotations(4 * times.size(), 0.5f);
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<float>(i) / 30;
  recording.document.erase("animations");
  recording.animate(1, "rotation", recording.floats(times, "SCALAR"), recording.floats(rotations, "VEC4"));
  CHECK(recording.file().motions().front().frames() == 700'000);
  CHECK_THROWS_WITH_AS(recording.file().motions(300), doctest::Contains("at most 11200000 of 700000 keys"),
                       ml::io_error);
}

TEST_CASE("damaged containers") {
  const auto good = two_joints().bytes();
  auto refused = [](std::vector<std::byte> bytes, const char* text) {
    CHECK_THROWS_WITH_AS(ml::GlbFile(bytes, "bad.glb"), doctest::Contains(text), ml::io_error);
  };
  auto patched = [&](std::size_t at, std::uint32_t value) {
    auto bytes = good;
    std::memcpy(bytes.data() + at, &value, 4);
    return bytes;
  };
  refused(patched(0, 0), "not a GLB file");
  refused(patched(4, 1), "404");
  refused(patched(8, 0xFFFFFFFF), "402");
  refused(patched(8, 12), "402");
  refused(patched(12, 0xFFFFFFF0), "402");
  refused(patched(16, 0), "not JSON");
  refused(patched(20, 0), "403");
  for (std::size_t n = 0; n < good.size(); ++n) {
    CHECK_THROWS_AS(ml::GlbFile(std::span(good).first(n), "cut"), ml::io_error);
  }
  // any single damaged byte is either refused or read as some other motion
  for (std::size_t at = 0; at < good.size(); ++at) {
    auto bytes = good;
    bytes[at] ^= std::byte{0x15};
    try {
      const ml::GlbFile file(bytes, "damaged");
      if (!file.animation_names().empty()) CHECK(file.motion(0).frames() >= 1);
    } catch (const ml::error& e) {
      CHECK(e.id() >= 101);
    }
  }
}
