// SPDX-License-Identifier: MIT
// Bodies of gltf_skeleton.hpp.
#pragma once

#include <algorithm>   // min, sort
#include <functional>  // greater
#include <numbers>     // pi
#include <numeric>     // accumulate
#include <queue>       // joints whose parent is done

#include <motionlang/formats/detail/gltf_document.hpp>
#include <motionlang/formats/detail/gltf_skeleton.hpp>
#include <motionlang/kinematics/body_root.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<int> GltfSkeleton::moving_nodes() const {
  std::vector<int> out = above;
  for (const int n : nodes) {
    if (n >= 0) out.push_back(n);
  }
  std::sort(out.begin(), out.end());
  return out;
}

MOTIONLANG_BODY Quaternion<double> turn_between(const GltfPlace& rest, const Quaternion<double>& lean,
                                                const GltfPlace& now) {
  if (!rest.even || !now.even) {
    const Matrix3<double> turn = now.axes() * transpose(to_matrix(lean) * rest.axes());
    if (determinant(turn) > 0) return normalized(to_quaternion(turn));
  }
  return normalized(now.turn * inverse(lean * rest.turn));
}

MOTIONLANG_BODY std::vector<Vec3<double>> leaning_offsets(const GltfSkeleton& figure, std::span<const GltfPlace> rest) {
  std::vector<Vec3<double>> out;
  for (std::size_t j = 0; j < rest.size(); ++j) {
    const auto parent = static_cast<std::size_t>(std::max(figure.skeleton.parents[j], 0));
    out.push_back(j == 0 ? rest[0].place : rotate(figure.lean[parent], rest[j].place - rest[parent].place));
  }
  return out;
}

MOTIONLANG_BODY GltfFigures::GltfFigures(const GltfDocument& document, std::span<const GltfAnimation> animations,
                                         std::optional<Index> skin, const FindTable& find_table)
    : document_(document), world_(world_at_rest(document)) {
  const auto& nodes = document.nodes();
  std::vector<int> declared(nodes.size(), nowhere);
  int place = 0;
  const auto add = [&](int n) {
    if (declared[slot(n)] == nowhere) declared[slot(n)] = place++;
  };
  for (Index s = 0; s < document.count("skins"); ++s) {
    if (skin && s != *skin) continue;
    for (const int n : joints_of_skin(s)) add(n);
  }
  for (const int n : document.depth_first()) {
    if (!skin && nodes[slot(n)].is_bone) add(n);
  }
  if (place > 0) find_known(declared, find_table);
  if (!skin && figures.empty()) {  // joints that move no vertex may be in no skin; objects are rarely joints
    const auto animated = [&](int n) {
      return std::any_of(animations.begin(), animations.end(), [n](const auto& a) { return a.animates(n); });
    };
    std::vector<int> all(nodes.size(), nowhere);
    std::vector<bool> thing(nodes.size(), false);
    const auto& order = document.depth_first();
    for (auto n = order.rbegin(); n != order.rend(); ++n) {  // NOLINT(modernize-loop-convert): needs reverse_view
      const auto& node = nodes[slot(*n)];
      thing[slot(*n)] = node.is_thing && !animated(*n) &&
                        std::all_of(node.children.begin(), node.children.end(), [&](int c) { return thing[slot(c)]; });
    }
    for (const bool things : {false, true}) {
      for (const int n : order) all[slot(n)] = thing[slot(n)] && !things ? nowhere : n;
      if (figures.empty()) find_known(all, find_table);
    }
  }
  for (GltfSkeleton& figure : figures) {
    choose_rest(figure, skin);
    if (auto table = find_table(figure.skeleton)) figure.table = std::move(table);  // the table for its present pose
  }
  if (figures.empty()) find_unknown(animations, skin);
}

MOTIONLANG_BODY std::vector<int> GltfFigures::joints_of_skin(Index skin) const {
  const JsonView joints = document_.element("skins", skin)["joints"];
  std::vector<int> out;
  for (Index i = 0; i < joints.size(); ++i) out.push_back(document_.node_number(joints[i]));
  return out;
}

MOTIONLANG_BODY GltfFigures::Marks GltfFigures::marks_of(const std::vector<int>& own_place) const {
  Marks marks{own_place, std::vector<int>(own_place.size(), 0)};
  const auto& order = document_.depth_first();
  for (auto n = order.rbegin(); n != order.rend(); ++n) {  // NOLINT(modernize-loop-convert): needs reverse_view
    if (own_place[slot(*n)] != nowhere) ++marks.below[slot(*n)];
    const int p = document_.node(*n).parent;
    if (p < 0) {
      marks.total += marks.below[slot(*n)];
      continue;
    }
    if (own_place[slot(p)] == nowhere) marks.place[slot(p)] = std::min(marks.place[slot(p)], marks.place[slot(*n)]);
    marks.below[slot(p)] += marks.below[slot(*n)];
  }
  return marks;
}

MOTIONLANG_BODY void GltfFigures::find_known(std::vector<int> own_place, const FindTable& find_table) {
  std::vector<int> open;
  for (const int n : document_.depth_first()) {
    if (document_.node(n).parent < 0) open.push_back(n);
  }
  std::vector<std::pair<int, GltfSkeleton>> found;
  constexpr int most_tries = 64;  // each looks at all joints
  Marks marks = marks_of(own_place);
  for (int tries = 0; !open.empty() && tries < most_tries; ++tries) {
    while (!open.empty() && marks.below[slot(open.back())] == 0) open.pop_back();
    if (open.empty()) break;
    const int top = open.back();
    open.pop_back();
    GltfSkeleton all;
    if (marks.below[slot(top)] <= static_cast<int>(max_joints) / 2) all = build(marks, top);
    if (all.nodes.empty()) {  // a crowd: the children of the node, one by one
      for (const int c : document_.node(top).children) open.push_back(c);
      continue;
    }
    std::optional<SkeletonTable> table = find_table(all.skeleton);
    const int root = table ? body_root(all.skeleton, *table) : -1;
    if (root < 0) continue;
    GltfSkeleton figure = part(all, root);
    for (const int n : figure.nodes) own_place[slot(n)] = nowhere;
    figure.table = std::move(table);
    found.emplace_back(marks.place[slot(figure.nodes.front())], std::move(figure));
    marks = marks_of(own_place);
    open.push_back(top);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [place, figure] : found) figures.push_back(std::move(figure));
}

MOTIONLANG_BODY void GltfFigures::find_unknown(std::span<const GltfAnimation> animations, std::optional<Index> skin) {
  const Index skins = document_.count("skins");
  std::vector<int> none(document_.nodes().size(), nowhere);
  const auto add = [&](const std::vector<int>& own_place, const std::vector<bool>& weighted) {
    const Marks marks = marks_of(own_place);
    const int common = common_root(marks);
    const int hips = common < 0 ? -1 : moving_hips(marks, common, weighted, animations);
    figures.push_back(build(marks, hips >= 0 ? hips : common));
    finish(figures.back());
  };
  if (skins == 0) {
    std::vector<int> own_place = none;
    for (const int n : document_.depth_first()) {  // the animated nodes and everything below them
      const int p = document_.node(n).parent;
      const bool animated =
          std::any_of(animations.begin(), animations.end(), [n](const auto& a) { return a.animates(n); });
      if (animated || (p >= 0 && own_place[slot(p)] != nowhere && !document_.node(n).is_thing)) own_place[slot(n)] = n;
    }
    if (own_place == none) raise<io_error>(404, document_.file(), ": no skin and no animated node");
    add(own_place, std::vector<bool>(none.size(), true));
    return;
  }
  if (skin && (*skin < 0 || *skin >= skins))
    raise<config_error>(103, document_.file(), ": skin ", *skin, " of ", skins);
  std::vector<std::pair<std::size_t, Index>> sizes;
  for (Index s = 0; s < skins; ++s) {
    if (!skin || s == *skin) sizes.emplace_back(document_.element("skins", s)["joints"].size(), s);
  }
  std::stable_sort(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  constexpr std::size_t most_figures = 16, most_skins = 256;
  if (sizes.size() > most_skins) sizes.resize(most_skins);
  std::vector<bool> used(none.size(), false);
  for (const auto& [size, s] : sizes) {
    const std::vector<int> joints = joints_of_skin(s);
    if (joints.empty() || figures.size() == most_figures ||
        std::any_of(joints.begin(), joints.end(), [&](int n) { return used[slot(n)]; })) {
      continue;
    }
    std::vector<int> own_place = none;
    for (std::size_t i = joints.size(); i-- > 0;) own_place[slot(joints[i])] = static_cast<int>(i);
    add(own_place, animations.empty() ? std::vector<bool>(none.size(), true) : weighted(joints, s));
    for (const int n : joints) used[slot(n)] = true;
    for (const int n : figures.back().moving_nodes()) used[slot(n)] = true;
  }
  if (figures.empty()) raise<io_error>(404, document_.file(), ": no skin has a joint");
}

MOTIONLANG_BODY std::vector<bool> GltfFigures::weighted(const std::vector<int>& joints, Index skin) const {
  std::vector<bool> out(document_.nodes().size(), false);
  SharedAccessors accessors(document_);
  for (Index n = 0; n < document_.count("nodes"); ++n) {
    const JsonView node = document_.element("nodes", n);
    if (!node.contains("mesh") || !node.contains("skin") || node["skin"].as<Index>() != skin) continue;
    const JsonView primitives = document_.element("meshes", node["mesh"].as<Index>())["primitives"];
    for (Index p = 0; p < primitives.size(); ++p) {
      const JsonView attributes = primitives[p]["attributes"];
      if (!attributes.contains("JOINTS_0") || !attributes.contains("WEIGHTS_0")) continue;
      const auto index = attributes["JOINTS_0"].as<Index>(), weight = attributes["WEIGHTS_0"].as<Index>();
      if (is_packed(primitives[p], {"KHR_draco_mesh_compression"}) || !document_.has_data(index) ||
          !document_.has_data(weight)) {
        for (const int joint : joints) out[slot(joint)] = true;
        continue;
      }
      const auto index_values = accessors.values(index, 4), weight_values = accessors.values(weight, 4);
      for (std::size_t i = 0; i < std::min(index_values->size(), weight_values->size()); ++i) {
        const double joint = (*index_values)[i];
        if ((*weight_values)[i] > 0 && joint >= 0 && joint < static_cast<double>(joints.size()))
          out[slot(joints[static_cast<std::size_t>(joint)])] = true;
      }
    }
  }
  return out;
}

MOTIONLANG_BODY int GltfFigures::common_root(const Marks& marks) const {
  int root = -1;
  for (const int n : document_.depth_first()) {
    if (marks.below[slot(n)] == marks.total) root = n;
  }
  return root;
}

MOTIONLANG_BODY int GltfFigures::moving_hips(const Marks& marks, int root, std::vector<bool> weighted,
                                             std::span<const GltfAnimation> animations) const {
  const auto& order = document_.depth_first();
  for (auto n = order.rbegin(); n != order.rend(); ++n) {  // NOLINT(modernize-loop-convert): needs reverse_view
    const int p = document_.node(*n).parent;
    if (p >= 0 && weighted[slot(*n)]) weighted[slot(p)] = true;
  }
  int hips = -1;
  for (const int n : document_.node(root).children) {
    if (marks.below[slot(n)] == 0) continue;
    const bool matters = weighted[slot(n)] || !weighted[slot(root)];
    if (matters && hips >= 0) return -1;
    if (matters) hips = n;
  }
  for (const GltfAnimation& a : animations) {
    if (hips >= 0 && a.moves_away(hips, document_.node(hips).rest.translation)) return hips;
  }
  return -1;
}

MOTIONLANG_BODY GltfSkeleton GltfFigures::build(const Marks& marks, int root) const {
  GltfSkeleton out;
  std::unordered_map<std::string, int> copies;  // the number of copies of each name
  std::unordered_set<std::string> taken;
  const auto add = [&](int node, int parent, const std::string& name, const Vec3<double>& offset) {
    std::string unique = name;
    for (int& i = copies[name]; !taken.insert(unique).second;) unique = concat_text(name, "_", ++i + 1);
    out.nodes.push_back(node);
    out.skeleton.names.push_back(std::move(unique));
    out.skeleton.parents.push_back(parent);
    out.skeleton.offsets.push_back(offset);
  };
  struct Open {
    int place, node, parent;  // in the skin, in the document, in the skeleton
    bool operator>(const Open& other) const { return place > other.place; }
  };
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  if (root >= 0) open.push({0, root, -1});
  if (root < 0) {
    add(-1, -1, "root", {});
    for (const int n : document_.depth_first()) {
      if (document_.node(n).parent < 0 && marks.below[slot(n)] > 0) open.push({marks.place[slot(n)], n, 0});
    }
  }
  while (!open.empty()) {
    const auto [place, n, parent] = open.top();
    open.pop();
    if (out.nodes.size() == max_joints) raise<io_error>(405, document_.file(), ": more than ", max_joints, " joints");
    const GltfNode& node = document_.node(n);
    const Vec3<double> origin = parent < 0 || node.parent < 0 ? Vec3<double>{} : world_[slot(node.parent)].place;
    const int joint = static_cast<int>(out.nodes.size());
    add(n, parent, node.name, world_[slot(n)].place - origin);
    for (const int c : node.children) {
      if (marks.below[slot(c)] > 0) open.push({marks.place[slot(c)], c, joint});
    }
  }
  return out;
}

MOTIONLANG_BODY GltfSkeleton GltfFigures::part(const GltfSkeleton& all, int joint) const {
  GltfSkeleton out;
  for (const int j : joints_from(all.skeleton, joint)) out.nodes.push_back(all.nodes[slot(j)]);
  out.skeleton = skeleton_from(all.skeleton, joint);
  finish(out);
  return out;
}

MOTIONLANG_BODY void GltfFigures::finish(GltfSkeleton& figure) const {
  figure.skeleton.validate();
  figure.lean.assign(figure.nodes.size(), Quaternion<double>::identity());
  figure.above.clear();
  if (figure.nodes.front() < 0) return;
  for (int n = document_.node(figure.nodes.front()).parent; n >= 0; n = document_.node(n).parent)
    figure.above.insert(figure.above.begin(), n);
}

/// The mean angle between trunk, arms and legs and a T-pose, radians. Nothing for a skeleton without them.
inline std::optional<double> distance_from_t_pose(std::span<const Vec3<double>> joints, const Skeleton& skeleton,
                                                  const SkeletonTable& table) {
  const auto between = [&](std::string_view from, std::string_view to) {
    const MappedJoint *a = table.find(from), *b = table.find(to);
    const int i = a == nullptr ? -1 : find_joint(skeleton, a->source),
              j = b == nullptr ? -1 : find_joint(skeleton, b->source);
    return i < 0 || j < 0 ? Vec3<double>{} : joints[static_cast<std::size_t>(j)] - joints[static_cast<std::size_t>(i)];
  };
  const auto angle = [](const Vec3<double>& a, const Vec3<double>& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b));
  };
  const Vec3<double> up{0, 1, 0}, left = between("right_hip", "left_hip");
  double sum = 0;
  int bones = 0;
  const auto add = [&](const Vec3<double>& bone, const Vec3<double>& wanted) {
    if (norm(bone) > 0 && norm(wanted) > 0) sum += angle(bone, wanted), ++bones;
  };
  add(between("pelvis", "neck"), up);
  add(between("neck", "head"), up);
  for (const bool is_left : {true, false}) {
    const std::string side = is_left ? "left_" : "right_";
    const Vec3<double> out = is_left ? left : -left;
    add(between(side + "hip", side + "knee"), -up);
    add(between(side + "knee", side + "ankle"), -up);
    add(between(side + "shoulder", side + "elbow"), out);
    add(between(side + "elbow", side + "wrist"), out);
  }
  return bones < 4 ? std::nullopt : std::optional(sum / bones);
}

MOTIONLANG_BODY void GltfFigures::choose_rest(GltfSkeleton& figure, std::optional<Index> skin) const {
  const std::size_t joints = figure.nodes.size();
  std::unordered_map<int, std::size_t> number;  // of a node among the joints
  for (std::size_t j = 0; j < joints; ++j) number.emplace(figure.nodes[j], j);
  // the skin with the most joints of the figure
  Index best = -1;
  std::size_t most = 0;
  constexpr Index most_skins = 256;
  std::vector<double> values;
  const auto find_matrices = [&] {
    for (Index s = 0; s < std::min(document_.count("skins"), most_skins); ++s) {
      if (skin && s != *skin) continue;
      const JsonView view = document_.element("skins", s);
      if (!view.contains("inverseBindMatrices") || !document_.has_data(view["inverseBindMatrices"].as<Index>()))
        continue;
      std::size_t here = 0;
      for (const int n : joints_of_skin(s)) here += number.count(n);
      if (here > most) most = here, best = s;
    }
    if (best >= 0) values = document_.values(document_.element("skins", best)["inverseBindMatrices"].as<Index>(), 16);
  };
  // The matrices are optional: if they are damaged, the nodes give the rest pose.
  if (!guard<error>(find_matrices, [](const error&) { return true; }) || best < 0) return;
  const std::vector<int> bound = joints_of_skin(best);
  std::vector<std::optional<GltfPlace>> bind(joints);  // in the space of the mesh
  for (std::size_t i = 0; i < bound.size() && 16 * (i + 1) <= values.size(); ++i) {
    const auto joint = number.find(bound[i]);
    if (joint == number.end()) continue;
    const double* m = values.data() + 16 * i;  // column by column
    const auto linear = Matrix3<double>::from_columns({m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]});
    if (!nearest_orthogonal(linear)) return;
    GltfPlace place;
    place.linear = transpose(inverse_transposed(linear));
    place.place = -(place.linear * Vec3<double>{m[12], m[13], m[14]});
    place.even = false;
    bind[joint->second] = place;
  }
  if (!bind.front()) return;

  std::vector<GltfPlace> rest;
  figure.place([&](int n) { return document_.node(n).rest; }, rest);
  // Bones must be as long as at rest, in some unit.
  std::vector<double> ratios;
  for (std::size_t j = 1; j < joints; ++j) {
    const auto p = static_cast<std::size_t>(figure.skeleton.parents[j]);
    const double length = norm(rest[j].place - rest[p].place);
    if (bind[j] && bind[p] && length > 1e-6) ratios.push_back(norm(bind[j]->place - bind[p]->place) / length);
  }
  if (ratios.size() < 8) return;
  std::sort(ratios.begin(), ratios.end());
  const double unit = ratios[ratios.size() / 2];
  const auto fits = [unit](double r) { return std::abs(r - unit) < 0.05 * unit; };
  if (!(unit > 0) || 10 * std::count_if(ratios.begin(), ratios.end(), fits) < 9 * std::ssize(ratios)) return;

  // From the space of the mesh to the world: with the armature's turn, the mesh's, none, or one that keeps the root.
  std::vector<Matrix3<double>> turns;
  if (!figure.above.empty()) turns.push_back(world_[slot(figure.above.back())].axes());
  for (Index n = 0; n < document_.count("nodes"); ++n) {
    const JsonView node = document_.element("nodes", n);
    if (!node.contains("skin") || node["skin"].as<Index>() != best) continue;
    turns.push_back(world_[static_cast<std::size_t>(n)].axes());
    break;
  }
  turns.push_back(Matrix3<double>::identity());
  turns.push_back(rest.front().axes() * transpose(bind.front()->axes()));

  const auto places = [](const Skeleton& s) { return s.rest_positions(); };
  constexpr double clearly = 0.5 * std::numbers::pi / 180;
  auto least = distance_from_t_pose(places(figure.skeleton), figure.skeleton, *figure.table);
  for (const Matrix3<double>& turn : turns) {
    GltfSkeleton other = figure;
    bool proper = true;
    for (std::size_t j = 0; j < joints; ++j) {
      const auto p = static_cast<std::size_t>(std::max(figure.skeleton.parents[j], 0));
      if (!bind[j]) {
        other.lean[j] = other.lean[p];
        continue;
      }
      const Matrix3<double> lean = turn * bind[j]->axes() * transpose(rest[j].axes());
      proper = proper && determinant(lean) > 0;
      other.lean[j] = normalized(to_quaternion(lean));
    }
    if (!proper) continue;
    other.skeleton.offsets = leaning_offsets(other, rest);
    const auto distance = distance_from_t_pose(places(other.skeleton), other.skeleton, *other.table);
    if (distance && least && *distance < *least - clearly) {
      least = distance;
      figure.lean = other.lean;
      figure.skeleton.offsets = other.skeleton.offsets;
    }
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
