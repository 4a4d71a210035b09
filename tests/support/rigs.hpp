// SPDX-License-Identifier: MIT
/// Characters of other programs for tests: their skeletons, and GLB files with a skin as Blender writes them.
#pragma once

#include <algorithm>  // any_of
#include <map>        // joints by role

#include <motionlang/formats/detail/glb_builder.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>

#include "synthetic_motion.hpp"

namespace rigs {

namespace ml = motionlang;

using Turns = std::map<std::string, ml::Quaternion<double>>;

/// SMPL's figure as another program has it: names of a table (one joint for each role), facing elsewhere, in units of
/// its own, and with limbs in another rest pose (`turns`, of whole limbs, by role). Local axes are the world's.
inline ml::Skeleton skeleton_of(const ml::SkeletonTable& table, double facing = 0, double unit = 1,
                                const Turns& turns = {}, const std::string& prefix = {}) {
  const ml::Skeleton& smpl = ml::smpl24_skeleton();
  std::vector<ml::Joint> joints{{"root_on_floor", "", {0, 0, 0}}};
  std::map<std::string, std::string> name_of;
  std::vector<ml::Quaternion<double>> turn(24, ml::Quaternion<double>::identity());
  for (int j = 0; j < 24; ++j) {
    const auto* row = table.find(smpl.name(j));
    int p = smpl.parent(j);
    if (p >= 0) turn[static_cast<std::size_t>(j)] = turn[static_cast<std::size_t>(p)];
    const auto known = turns.find(smpl.name(j));
    if (known != turns.end()) turn[static_cast<std::size_t>(j)] = known->second;
    if (row == nullptr) continue;
    const bool taken =
        std::any_of(joints.begin(), joints.end(), [&](auto& k) { return k.name == prefix + row->source; });
    if (taken) continue;
    ml::Vec3<double> offset = p < 0 ? smpl.offset(j) : rotate(turn[static_cast<std::size_t>(p)], smpl.offset(j));
    for (; p >= 0 && !name_of.contains(smpl.name(p)); p = smpl.parent(p)) offset = offset + smpl.offset(p);
    name_of[smpl.name(j)] = prefix + row->source;
    joints.push_back({prefix + row->source, p < 0 ? "root_on_floor" : name_of[smpl.name(p)],
                      unit * rotate(synthetic::about_y(facing), offset)});
    const bool two = !row->second.empty() && row->target == "neck";  // a second joint at the same place
    if (two) joints.push_back({prefix + row->second, prefix + row->source, {0, 0, 0}});
  }
  joints.push_back({"left_thumb", name_of["left_wrist"], {0, 0, 0.02 * unit}});  // of which no table knows
  return ml::Skeleton::from_joints(joints);
}

/// A GLB file: the skeleton under an armature with Z up and in centimetres, joints with axes of their own, a skin, a
/// mesh with a small triangle at each joint, and an animation "idle" that turns the second joint.
inline std::vector<std::byte> glb_of(const ml::Skeleton& skeleton) {
  using nlohmann::ordered_json;
  const double scale = 0.01;
  const auto armature = synthetic::about_x(-std::numbers::pi / 2);
  const auto rest = skeleton.rest_positions();
  const auto joints = rest.size();
  auto list = [](const ml::Quaternion<double>& q) { return ordered_json::array({q.x, q.y, q.z, q.w}); };

  ml::detail::GlbBuilder glb;
  ordered_json& d = glb.document;
  d["extras"] = {{"author", "a test"}};
  d["nodes"].push_back({{"name", "Armature"},
                        {"rotation", list(armature)},
                        {"scale", {scale, scale, scale}},
                        {"children", ordered_json::array({1})}});
  std::vector<ml::Quaternion<double>> world;
  std::vector<float> inverse_bind, positions, weights;
  std::vector<std::uint16_t> bound;
  for (std::size_t j = 0; j < joints; ++j) {
    const int p = skeleton.parents[j];
    const auto parent = p < 0 ? armature : world[static_cast<std::size_t>(p)];
    const auto n = static_cast<double>(j);
    world.push_back(synthetic::about_z(0.3 * n) * synthetic::about_x(0.7 * n));
    const auto from_parent = rotate(inverse(parent), (1 / scale) * skeleton.offsets[j]);
    ordered_json node{{"name", skeleton.names[j]},
                      {"translation", ml::detail::to_json(from_parent)},
                      {"rotation", list(inverse(parent) * world[j])}};
    for (const int c : skeleton.children(static_cast<int>(j))) node["children"].push_back(c + 1);
    d["nodes"].push_back(std::move(node));
    const auto turn = inverse(world[j]);  // the inverse of T(rest) R(world) S(scale), column by column
    for (const ml::Vec3<double>& axis : {ml::Vec3<double>{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, -rest[j]}) {
      const auto c = (1 / scale) * rotate(turn, axis);
      inverse_bind.insert(inverse_bind.end(), {static_cast<float>(c.x), static_cast<float>(c.y),
                                               static_cast<float>(c.z), inverse_bind.size() % 16 == 12 ? 1.0f : 0.0f});
    }
    for (const double x : {-0.04, 0.04, 0.0}) {
      const auto corner = rest[j] + ml::Vec3<double>{x, x == 0 ? 0.06 : 0, 0};
      positions.insert(positions.end(),
                       {static_cast<float>(corner.x), static_cast<float>(corner.y), static_cast<float>(corner.z)});
      bound.insert(bound.end(), {static_cast<std::uint16_t>(j), 0, 0, 0});
      weights.insert(weights.end(), {1, 0, 0, 0});
    }
  }
  using Builder = ml::detail::GlbBuilder;
  ordered_json skin{{"inverseBindMatrices", glb.add(std::span<const float>(inverse_bind), "MAT4", Builder::none)}};
  for (std::size_t j = 0; j < joints; ++j) skin["joints"].push_back(j + 1);
  d["skins"].push_back(skin);
  d["materials"].push_back({{"name", "skin"}, {"doubleSided", true}});
  const ordered_json primitive{
      {"attributes",
       {{"POSITION", glb.add(std::span<const float>(positions), "VEC3", Builder::attributes, true)},
        {"JOINTS_0", glb.add(std::span<const std::uint16_t>(bound), "VEC4", Builder::attributes)},
        {"WEIGHTS_0", glb.add(std::span<const float>(weights), "VEC4", Builder::attributes)}}},
      {"material", 0}};
  d["meshes"].push_back({{"primitives", ordered_json::array({primitive})}});
  d["nodes"].push_back({{"name", "body"}, {"mesh", 0}, {"skin", 0}});
  d["scenes"].push_back({{"nodes", ordered_json::array({0, joints + 1})}});
  const std::vector<float> times{0, 1}, turned{0, 0, 0, 1, 0.6f, 0, 0, 0.8f};
  d["animations"].push_back(
      {{"name", "idle"},
       {"channels", ordered_json::array({{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}})},
       {"samplers",
        ordered_json::array({{{"input", glb.add(std::span<const float>(times), "SCALAR", Builder::none, true)},
                              {"output", glb.add(std::span<const float>(turned), "VEC4", Builder::none)}}})}});
  return glb.finish();
}

/// The same file as .gltf: the document alone, with the data in base64.
inline std::string gltf_of(std::span<const std::byte> glb) {
  const auto chunks = ml::detail::parse_glb_chunks(glb, "GLB");
  auto document = nlohmann::ordered_json::parse(chunks.text);
  auto& buffer = document["buffers"][0];
  buffer["uri"] = "data:application/gltf-buffer;base64," +
                  ml::detail::to_base64(chunks.binary.first(buffer["byteLength"].get<std::size_t>()));
  return document.dump();
}

}  // namespace rigs
