// SPDX-License-Identifier: MIT
// Bodies of gltf_skeleton.hpp.
#pragma once

#include <algorithm>   // min
#include <functional>  // greater
#include <numeric>     // accumulate
#include <queue>       // joints whose parent is done

#include <motionlang/formats/detail/gltf_document.hpp>
#include <motionlang/formats/detail/gltf_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY GltfSkeleton::GltfSkeleton(const GltfDocument& document, std::span<const GltfAnimation> animations,
                                           Index skin)
    : below_(document.nodes().size(), 0),
      weighted_(document.nodes().size(), false),
      place_(document.nodes().size(), nowhere) {
  mark_joints(document, animations, skin);
  const int common = common_root(document);
  const int hips = common < 0 ? -1 : moving_hips(document, common, animations);
  build(document, hips >= 0 ? hips : common);
}

MOTIONLANG_BODY void GltfSkeleton::mark_joints(const GltfDocument& document, std::span<const GltfAnimation> animations,
                                               Index skin) {
  if (document.count("skins") > 0) {
    const JsonView joints = document.element("skins", skin)["joints"];
    std::vector<int> numbers;
    for (Index i = 0; i < joints.size(); ++i) numbers.push_back(document.node_number(joints[i]));
    for (std::size_t i = numbers.size(); i-- > 0;) {
      below_[slot(numbers[i])] = 1;
      place_[slot(numbers[i])] = static_cast<int>(i);
    }
    if (!animations.empty()) mark_weighted(document, numbers, skin);  // only moving_hips asks for it
  } else {  // no skin: all nodes that an animation turns or moves
    for (const GltfAnimation& a : animations) {
      for (const int n : document.depth_first()) {
        if (a.animates(n)) below_[slot(n)] = 1, weighted_[slot(n)] = true, place_[slot(n)] = n;
      }
    }
  }
  const std::vector<int> own_place = place_;
  const auto& order = document.depth_first();
  for (auto n = order.rbegin(); n != order.rend(); ++n) {  // NOLINT(modernize-loop-convert): needs reverse_view
    const int p = document.node(*n).parent;
    if (p < 0) continue;
    if (own_place[slot(p)] == nowhere) place_[slot(p)] = std::min(place_[slot(p)], place_[slot(*n)]);
    below_[slot(p)] += below_[slot(*n)];
    if (weighted_[slot(*n)]) weighted_[slot(p)] = true;
  }
  total_ = std::accumulate(order.begin(), order.end(), 0,
                           [&](int sum, int n) { return sum + (document.node(n).parent < 0 ? below_[slot(n)] : 0); });
  if (total_ == 0) raise<io_error>(404, document.file(), ": no skin and no animated node");
}

MOTIONLANG_BODY void GltfSkeleton::mark_weighted(const GltfDocument& document, const std::vector<int>& joints,
                                                 Index skin) {
  SharedAccessors accessors(document);
  for (Index n = 0; n < document.count("nodes"); ++n) {
    const JsonView node = document.element("nodes", n);
    if (!node.contains("mesh") || !node.contains("skin") || node["skin"].as<Index>() != skin) continue;
    const JsonView primitives = document.element("meshes", node["mesh"].as<Index>())["primitives"];
    for (Index p = 0; p < primitives.size(); ++p) {
      refuse_packed(primitives[p], {"KHR_draco_mesh_compression"});
      const JsonView attributes = primitives[p]["attributes"];
      if (!attributes.contains("JOINTS_0") || !attributes.contains("WEIGHTS_0")) continue;
      const auto index_values = accessors.values(attributes["JOINTS_0"].as<Index>(), 4);
      const auto weight_values = accessors.values(attributes["WEIGHTS_0"].as<Index>(), 4);
      const std::vector<double>&index = *index_values, &weight = *weight_values;
      for (std::size_t i = 0; i < std::min(index.size(), weight.size()); ++i) {
        if (weight[i] > 0 && index[i] >= 0 && index[i] < static_cast<double>(joints.size())) {
          weighted_[slot(joints[static_cast<std::size_t>(index[i])])] = true;
        }
      }
    }
  }
}

MOTIONLANG_BODY int GltfSkeleton::common_root(const GltfDocument& document) const {
  int root = -1;
  for (const int n : document.depth_first()) {
    if (below_[slot(n)] == total_) root = n;
  }
  return root;
}

MOTIONLANG_BODY int GltfSkeleton::moving_hips(const GltfDocument& document, int root,
                                              std::span<const GltfAnimation> animations) const {
  int hips = -1;
  for (const int n : document.depth_first()) {
    if (document.node(n).parent != root || below_[slot(n)] == 0) continue;
    const bool matters = weighted_[slot(n)] || !weighted_[slot(root)];
    if (matters && hips >= 0) return -1;
    if (matters) hips = n;
  }
  for (const GltfAnimation& a : animations) {
    if (hips >= 0 && a.moves_away(hips, document.node(hips).rest.translation)) return hips;
  }
  return -1;
}

MOTIONLANG_BODY void GltfSkeleton::build(const GltfDocument& document, int root) {
  const std::vector<GltfTransform> world = world_at_rest(document);
  struct Open {
    int place, node, parent;  // in the skin, in the document, in the skeleton
    bool operator>(const Open& other) const { return place > other.place; }
  };
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  if (root >= 0) open.push({0, root, -1});
  if (root < 0) {
    add_joint(-1, -1, "root", {}, Quaternion<double>::identity());
    for (const int n : document.depth_first()) {
      if (document.node(n).parent < 0 && below_[slot(n)] > 0) open.push({place_[slot(n)], n, 0});
    }
  }
  while (!open.empty()) {
    const auto [place, n, parent] = open.top();
    open.pop();
    if (nodes.size() == max_joints) raise<io_error>(405, document.file(), ": more than ", max_joints, " joints");
    const GltfNode& node = document.node(n);
    const Vec3<double> origin = parent < 0 || node.parent < 0 ? Vec3<double>{} : world[slot(node.parent)].translation;
    const int joint = static_cast<int>(nodes.size());
    add_joint(n, parent, node.name, world[slot(n)].translation - origin, world[slot(n)].rotation);
    for (const int c : node.children) {
      if (below_[slot(c)] > 0) open.push({place_[slot(c)], c, joint});
    }
  }
  skeleton.validate();
}

MOTIONLANG_BODY void GltfSkeleton::add_joint(int node, int parent, const std::string& name, const Vec3<double>& offset,
                                             const Quaternion<double>& q) {
  std::string unique = name;
  for (int& i = copies_[name]; !taken_.insert(unique).second;) unique = concat_text(name, "_", ++i + 1);
  nodes.push_back(node);
  skeleton.names.push_back(std::move(unique));
  skeleton.parents.push_back(parent);
  skeleton.offsets.push_back(offset);
  rest_rotations.push_back(q);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
