// SPDX-License-Identifier: MIT
// Bodies of vrma.hpp.
#pragma once

#include <algorithm>  // min
#include <numeric>    // iota
#include <string>     // names

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/formats/detail/glb_builder.hpp>
#include <motionlang/formats/vrma.hpp>
#include <motionlang/kinematics/finger_names.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A bone of VRM's humanoid: the joint of SMPL with the same part, and its parent.
struct VrmBone {
  std::string_view name, parent, role;
  bool required = false;
};

inline constexpr VrmBone vrm_bones[] = {
    {"hips", "", "pelvis", true},
    {"spine", "hips", "spine1", true},
    {"chest", "spine", "spine2"},
    {"upperChest", "chest", "spine3"},
    {"neck", "upperChest", "neck"},
    {"head", "neck", "head", true},
    {"leftShoulder", "upperChest", "left_collar"},
    {"leftUpperArm", "leftShoulder", "left_shoulder", true},
    {"leftLowerArm", "leftUpperArm", "left_elbow", true},
    {"leftHand", "leftLowerArm", "left_wrist", true},
    {"rightShoulder", "upperChest", "right_collar"},
    {"rightUpperArm", "rightShoulder", "right_shoulder", true},
    {"rightLowerArm", "rightUpperArm", "right_elbow", true},
    {"rightHand", "rightLowerArm", "right_wrist", true},
    {"leftUpperLeg", "hips", "left_hip", true},
    {"leftLowerLeg", "leftUpperLeg", "left_knee", true},
    {"leftFoot", "leftLowerLeg", "left_ankle", true},
    {"leftToes", "leftFoot", "left_foot"},
    {"rightUpperLeg", "hips", "right_hip", true},
    {"rightLowerLeg", "rightUpperLeg", "right_knee", true},
    {"rightFoot", "rightLowerLeg", "right_ankle", true},
    {"rightToes", "rightFoot", "right_foot"},
};

/// VRM's name of a joint of a finger, by SMPL-H's: "left_thumb1" is leftThumbMetacarpal. "" for ""
inline std::string vrm_finger(const std::string& finger) {
  const std::size_t split = finger.find('_');
  if (split == finger.npos) return "";
  const int number = finger.back() - '0';
  std::string name = finger.substr(split + 1, finger.size() - split - 2);
  constexpr std::string_view thumb[]{"Metacarpal", "Proximal", "Distal"}, other[]{"Proximal", "Intermediate", "Distal"};
  const bool is_thumb = name == "thumb";
  if (name == "pinky") name = "little";
  name.front() = static_cast<char>(name.front() - 'a' + 'A');
  return concat_text(finger.substr(0, split), name, (is_thumb ? thumb : other)[number - 1]);
}

/// The positions of the joints in the skeleton's T-pose. Bent limbs stay bent.
inline std::vector<Vec3<double>> standing_positions(const StandingSkeleton& s) {
  std::vector<Vec3<double>> out(s.rotation.size());
  for (std::size_t j = 1; j < out.size(); ++j) {
    const auto parent = static_cast<std::size_t>(s.skeleton.parents[j]);
    out[j] = out[parent] + rotate(s.rotation[parent], s.skeleton.offsets[j]);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY Skeleton vrm_skeleton(const Skeleton& skeleton) {
  const auto from = detail::StandingSkeleton::of(skeleton, detect_skeleton_table(skeleton));
  const std::vector<Vec3<double>> places = detail::standing_positions(from);
  const auto place = [&](int joint) { return places[static_cast<std::size_t>(joint)]; };
  Skeleton out;
  std::vector<int> sources;  // of every bone
  const auto add = [&](std::string name, int parent, int source, const Vec3<double>& offset) {
    out.names.push_back(std::move(name));
    out.parents.push_back(parent);
    out.offsets.push_back(offset);
    sources.push_back(source);
  };
  for (const detail::VrmBone& bone : detail::vrm_bones) {
    const int source = from.joint(bone.role);
    const bool shared = std::find(sources.begin(), sources.end(), source) != sources.end();
    if (source < 0 || shared) {
      if (bone.required)
        raise<config_error>(103, "VRM requires a bone '", bone.name, "', which a skeleton of kind ", from.table.name,
                            " lacks: retarget the motion to SMPL's joints first");
      continue;
    }
    int parent = -1;
    for (std::string_view above = bone.parent; !above.empty() && parent < 0;) {
      parent = out.find(above);
      const auto* row = std::find_if(std::begin(detail::vrm_bones), std::end(detail::vrm_bones),
                                     [&](const auto& b) { return b.name == above; });
      above = row->parent;
    }
    Vec3<double> offset =
        parent < 0 ? Vec3<double>{} : place(source) - place(sources[static_cast<std::size_t>(parent)]);
    const bool arm = bone.name.ends_with("LowerArm") || bone.name.ends_with("Hand"),
               leg = bone.name.ends_with("LowerLeg") || bone.name.ends_with("Foot");
    if (arm) offset = {bone.name.starts_with("left") ? norm(offset) : -norm(offset), 0, 0};
    if (leg) offset = {0, -norm(offset), 0};
    add(std::string(bone.name), parent, source, offset);
  }
  for (int j = 0; j < skeleton.size(); ++j) {  // fingers point as the arms do
    const std::string name = detail::vrm_finger(finger_of(bare_joint_name(skeleton.name(j))));
    if (name.empty() || out.find(name) >= 0) continue;
    int above = skeleton.parent(j);
    const auto bone = [&] {
      const auto at = std::find(sources.begin(), sources.end(), above);
      return at == sources.end() ? -1 : static_cast<int>(at - sources.begin());
    };
    while (above >= 0 && bone() < 0) above = skeleton.parent(above);
    if (above >= 0) add(name, bone(), j, place(j) - place(above));
  }
  const auto rest = out.rest_positions();
  double lowest = 0;
  for (const Vec3<double>& p : rest) lowest = std::min(lowest, p.y);
  out.offsets.front() = {0, -lowest, 0};
  out.validate();
  return out;
}

MOTIONLANG_BODY std::vector<std::byte> vrma_bytes(const Motion& motion) {
  motion.validate();
  if (motion.frames() == 0) raise<config_error>(101, "VRM animation: motion '", motion.name, "' has no frames");
  const Skeleton bones = vrm_skeleton(motion.skeleton);
  const auto is_there = [&] {  // on VRM's bones in a T-pose already
    if (bones.names != motion.skeleton.names || bones.parents != motion.skeleton.parents) return false;
    for (std::size_t j = 1; j < bones.offsets.size(); ++j) {
      if (norm(bones.offsets[j] - motion.skeleton.offsets[j]) > 1e-6) return false;
    }
    return true;
  };
  const Motion posed = is_there() ? motion : retarget(motion, SkeletonMap(motion.skeleton, bones));
  detail::GlbBuilder glb;
  auto& d = glb.document;
  d["scenes"].push_back({{"nodes", nlohmann::ordered_json::array({0})}});
  d["nodes"].push_back({{"name", "root"}, {"children", nlohmann::ordered_json::array({1})}});
  nlohmann::ordered_json named;
  std::vector<int> nodes(bones.names.size());
  std::iota(nodes.begin(), nodes.end(), 1);
  for (int j = 0; j < bones.size(); ++j) {
    nlohmann::ordered_json node{{"name", bones.name(j)}, {"translation", detail::to_json(bones.offset(j))}};
    for (const int child : bones.children(j)) node["children"].push_back(child + 1);
    d["nodes"].push_back(std::move(node));
    named[bones.name(j)] = {{"node", j + 1}};
  }
  d["extensionsUsed"] = {"VRMC_vrm_animation"};
  d["extensions"]["VRMC_vrm_animation"] = {{"specVersion", "1.0"}, {"humanoid", {{"humanBones", std::move(named)}}}};
  detail::add_animation(glb, posed, nodes);
  for (const char* empty : {"meshes", "materials", "skins"}) d.erase(empty);
  return glb.finish();
}

MOTIONLANG_BODY void write_vrma(const FilePath& path, const Motion& motion) { write_file(path, vrma_bytes(motion)); }

MOTIONLANG_NAMESPACE_END
