// SPDX-License-Identifier: MIT
// Bodies of glb_writer.hpp.
#pragma once

#include <numeric>  // iota

#include <motionlang/file/file.hpp>
#include <motionlang/formats/detail/figure_mesh.hpp>
#include <motionlang/formats/detail/glb_builder.hpp>
#include <motionlang/formats/glb_writer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Node j is joint j; rest rotations are the identity.
inline void add_joints(GlbBuilder& glb, const Skeleton& skeleton) {
  for (int j = 0; j < skeleton.size(); ++j) {
    nlohmann::ordered_json node{{"name", skeleton.name(j)}, {"translation", to_json(skeleton.offset(j))}};
    for (const int child : skeleton.children(j)) node["children"].push_back(child);
    glb.document["nodes"].push_back(std::move(node));
  }
}

/// The figure of a skeleton: every vertex moves with one joint.
inline SkinnedMesh<std::uint8_t> figure_skin(const Skeleton& skeleton) {
  FigureMesh mesh = make_mesh(make_figure(skeleton), skeleton);
  SkinnedMesh<std::uint8_t> out{std::move(mesh.positions), std::move(mesh.normals), {}, {}, std::move(mesh.triangles)};
  for (const std::uint16_t j : mesh.joints) {
    out.joints.insert(out.joints.end(), {j, 0, 0, 0});
    out.weights.insert(out.weights.end(), {255, 0, 0, 0});
  }
  return out;
}

/// A mesh bound to the joints, in a node of its own at the root of the scene.
template <class W>
void add_mesh(GlbBuilder& glb, const Skeleton& skeleton, const SkinnedMesh<W>& mesh, const char* name,
              const GlbWriteOptions& options) {
  const std::size_t weights_accessor = glb.add(std::span<const W>(mesh.weights), "VEC4", GlbBuilder::attributes);
  glb.document["accessors"][weights_accessor]["normalized"] = true;
  const nlohmann::ordered_json primitive{
      {"attributes",
       {{"POSITION", glb.add(mesh.positions, GlbBuilder::attributes, true)},
        {"NORMAL", glb.add(mesh.normals, GlbBuilder::attributes)},
        {"JOINTS_0", glb.add(std::span<const std::uint16_t>(mesh.joints), "VEC4", GlbBuilder::attributes)},
        {"WEIGHTS_0", weights_accessor}}},
      {"indices", glb.add(std::span<const std::uint32_t>(mesh.triangles), "SCALAR", GlbBuilder::indices)},
      {"material", 0}};

  std::vector<float> inverse_bind;
  for (const Vec3<double>& p : skeleton.rest_positions()) {  // column by column: the translation by -p
    const Vec3<float> t = vec_cast<float>(-p);
    inverse_bind.insert(inverse_bind.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, t.x, t.y, t.z, 1});
  }
  nlohmann::ordered_json skin{
      {"inverseBindMatrices", glb.add(std::span<const float>(inverse_bind), "MAT4", GlbBuilder::none)},
      {"skeleton", 0}};
  for (int j = 0; j < skeleton.size(); ++j) skin["joints"].push_back(j);

  nlohmann::ordered_json& document = glb.document;
  document["materials"].push_back(
      {{"name", "body"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor",
          nlohmann::ordered_json::array({options.colour.x, options.colour.y, options.colour.z, 1.0})},
         {"metallicFactor", 0.0},
         {"roughnessFactor", options.roughness}}}});
  document["meshes"].push_back({{"name", name}, {"primitives", nlohmann::ordered_json::array({primitive})}});
  document["skins"].push_back(std::move(skin));
  document["nodes"].push_back({{"name", name}, {"mesh", 0}, {"skin", 0}});
  document["scenes"].push_back({{"nodes", nlohmann::ordered_json::array({0, skeleton.size()})}});
}

MOTIONLANG_BODY void require_glb_motions(std::span<const Motion> motions) {
  if (motions.empty()) raise<config_error>(101, "GLB: no motion to write");
  const Skeleton& skeleton = motions.front().skeleton;
  for (const Motion& motion : motions) {
    motion.validate();
    if (motion.frames() == 0) raise<config_error>(101, "GLB: motion '", motion.name, "' has no frames");
    if (motion.skeleton != skeleton) {
      raise<config_error>(102, "GLB: motions '", motions.front().name, "' and '", motion.name,
                          "' have different skeletons");
    }
  }
  if (skeleton.size() > 65535) raise<config_error>(101, "GLB: ", counted(skeleton.size(), "joint"));
}

template <class W>
std::vector<std::byte> glb_of_mesh(std::span<const Motion> motions, const SkinnedMesh<W>& mesh, const char* name,
                                   const GlbWriteOptions& options) {
  const Skeleton& skeleton = motions.front().skeleton;
  GlbBuilder glb;
  add_joints(glb, skeleton);
  add_mesh(glb, skeleton, mesh, name, options);
  std::vector<int> nodes(skeleton.parents.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  for (const Motion& motion : motions) add_animation(glb, motion, nodes);
  return glb.finish();
}

MOTIONLANG_BODY std::vector<std::byte> skinned_glb(std::span<const Motion> motions,
                                                   const SkinnedMesh<std::uint8_t>& mesh, const char* name,
                                                   const GlbWriteOptions& options) {
  return glb_of_mesh(motions, mesh, name, options);
}

MOTIONLANG_BODY std::vector<std::byte> skinned_glb(std::span<const Motion> motions,
                                                   const SkinnedMesh<std::uint16_t>& mesh, const char* name,
                                                   const GlbWriteOptions& options) {
  return glb_of_mesh(motions, mesh, name, options);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::byte> glb_bytes(std::span<const Motion> motions, const GlbWriteOptions& options) {
  detail::require_glb_motions(motions);
  return detail::skinned_glb(motions, detail::figure_skin(motions.front().skeleton), "figure", options);
}

MOTIONLANG_BODY void write_glb(const FilePath& path, std::span<const Motion> motions, const GlbWriteOptions& options) {
  write_file(path, glb_bytes(motions, options));
}

MOTIONLANG_BODY void write_glb(const FilePath& path, const Motion& motion, const GlbWriteOptions& options) {
  write_glb(path, std::span(&motion, 1), options);
}

MOTIONLANG_NAMESPACE_END
