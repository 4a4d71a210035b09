// SPDX-License-Identifier: MIT
// Bodies of glb_rig.hpp.
#pragma once

#include <algorithm>  // max, max_element, min
#include <array>      // four weights
#include <cmath>      // lround
#include <memory>     // accessors
#include <optional>   // tables
#include <set>        // names of animations

#include <motionlang/file/file.hpp>
#include <motionlang/formats/detail/drop_animations.hpp>
#include <motionlang/formats/detail/gltf_document.hpp>
#include <motionlang/formats/glb_rig.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GlbRig GlbRig::open(const FilePath& path, const FindTable& find_table) {
  return GlbRig(MappedFile::open(path)->bytes(), path.string(), find_table);
}

MOTIONLANG_BODY GlbRig::GlbRig(std::span<const std::byte> bytes, std::string name, const FindTable& find_table)
    : bytes_(std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end())),
      document_(std::make_shared<const detail::GltfDocument>(*bytes_, std::move(name))) {
  const auto find = [&](const Skeleton& s) {
    std::optional<SkeletonTable> table;
    const auto not_it = [](const config_error& e) { return e.id() == 103; };
    detail::guard<config_error>([&] { table = find_table(s); }, not_it);
    return table;
  };
  std::vector<detail::GltfAnimation> animations;
  detail::SharedAccessors keys(*document_);
  if (document_->count("skins") == 0) {  // then joints may be the nodes that move
    for (Index i = 0; i < document_->count("animations"); ++i) animations.emplace_back(keys, i);
  }
  const detail::GltfSkeleton figure = detail::GltfFigures(*document_, animations, {}, find).figures.front();
  if (!figure.table) refuse(find_table);
  table_ = *figure.table;
  skeleton_ = figure.skeleton;
  nodes_ = figure.nodes;
  lean_ = figure.lean;
  std::vector<detail::GltfPlace> rest;
  above_ = figure.place([&](int n) { return document_->node(n).rest; }, rest);
  for (std::size_t j = 0; j < rest.size(); ++j) axes_.push_back(to_matrix(figure.lean[j]) * rest[j].axes());
  if (!detail::nearest_orthogonal(above_.linear))
    raise<io_error>(404, file(), ": a scale above '", skeleton_.name(0), "' is 0");
}

MOTIONLANG_BODY void GlbRig::refuse(const FindTable& find_table) const {
  const Index skins = document_->count("skins");
  std::vector<detail::GltfAnimation> animations;
  detail::SharedAccessors keys(*document_);
  for (Index i = 0; skins == 0 && i < document_->count("animations"); ++i) animations.emplace_back(keys, i);
  const auto joints_of = [&](std::optional<Index> skin) {
    const detail::GltfFigures all(*document_, animations, skin, [](const Skeleton&) { return std::nullopt; });
    return all.figures.front().skeleton;
  };
  constexpr Index most_reasons = 8;
  std::string reasons;
  for (Index skin = 0; skin < std::min(skins, most_reasons); ++skin) {
    const auto why = [&](const config_error& e) {
      const std::string_view what = e.what();
      reasons += concat_text("; skin ", skin, ": ", what.substr(what.find("] ") + 2));
      return skins > 1 && e.id() == 103;
    };
    detail::guard<config_error>([&] { find_table(joints_of(skin)); }, why);
  }
  if (skins == 0) find_table(joints_of({}));
  if (reasons.empty()) raise<config_error>(103, file(), ": no node is the root of all joints of the body");
  raise<config_error>(103, file(), ": none of ", counted(skins, "skin"), " is a body that is known", reasons);
}

MOTIONLANG_BODY const std::string& GlbRig::file() const { return document_->file(); }

MOTIONLANG_BODY SkeletonMap GlbRig::map_from(const Skeleton& source) const {
  return SkeletonMap(source, detect_skeleton_table(source), skeleton_, table_);
}

MOTIONLANG_BODY std::vector<std::byte> GlbRig::with(std::span<const Motion> motions,
                                                    const GlbRigOptions& options) const {
  if (motions.empty()) raise<config_error>(101, file(), ": no motion to add");
  for (const char* grows : {"accessors", "bufferViews", "animations"}) document_->count(grows);  // they must be arrays
  const detail::GlbChunks chunks = detail::parse_glb_chunks(*bytes_, file());
  detail::GlbBuilder glb(nlohmann::ordered_json::parse(chunks.text),
                         document_->count("buffers") > 0 ? document_->buffer(0) : std::span<const std::byte>());
  if (document_->count("buffers") > 0) glb.document["buffers"][0].erase("uri");
  if (!options.keep_animations) detail::drop_animations(glb);
  std::set<std::string> taken;
  for (Index i = 0; options.keep_animations && i < document_->count("animations"); ++i) {
    taken.insert(document_->element("animations", i).value_or("name", ""));
  }
  for (const Motion& motion : motions) {
    motion.validate();
    if (motion.frames() == 0) raise<config_error>(101, "GLB: motion '", motion.name, "' has no frames");
    Motion added = in_nodes(motion.skeleton == skeleton_ ? motion : retarget(motion, map_from(motion.skeleton)));
    const std::string name = motion.name.empty() ? "motion" : motion.name;
    added.name = name;
    for (int k = 2; !taken.insert(added.name).second; ++k) added.name = concat_text(name, "_", k);
    detail::add_animation(glb, added, moved_nodes(added));
  }
  return glb.finish();
}

MOTIONLANG_BODY Motion GlbRig::in_nodes(Motion motion) const {
  const Matrix3<double> up = above_.axes(), undo = transpose(detail::inverse_transposed(above_.linear));
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto local = motion.rotations(f);
    for (std::size_t j = 0; j < local.size(); ++j) {
      const int parent = skeleton_.parents[j];
      const Matrix3<double>& before = parent < 0 ? up : axes_[static_cast<std::size_t>(parent)];
      local[j] = normalized(to_quaternion(transpose(before) * to_matrix(local[j]) * axes_[j]));
    }
    Vec3<double>& root = motion.root[static_cast<std::size_t>(f)];
    root = undo * (root - above_.place);
  }
  return motion;
}

MOTIONLANG_BODY std::vector<int> GlbRig::moved_nodes(const Motion& motion) const {
  std::vector<int> nodes = nodes_;
  for (std::size_t j = 1; j < nodes.size(); ++j) {
    const auto& rest = document_->node(nodes_[j]).rest.rotation;
    bool moves = false;
    for (Index f = 0; f < motion.frames() && !moves; ++f) moves = distance(motion.rotations(f)[j], rest) > 1e-6;
    if (!moves) nodes[j] = -1;
  }
  return nodes;
}

namespace detail {

/// Collects the surface of a character.
class RigSurface {
 public:
  RigSurface(const GltfDocument& document, const Skeleton& skeleton, const std::vector<int>& nodes,
             const std::vector<Quaternion<double>>& lean)
      : document_(document), accessors_(document), lean_(lean), world_(world_at_rest(document)) {
    places_ = skeleton.rest_positions();
    joint_of_.assign(document.nodes().size(), -1);
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      if (nodes[j] >= 0) joint_of_[static_cast<std::size_t>(nodes[j])] = static_cast<int>(j);
    }
    for (const int n : document.depth_first()) {  // what hangs on a joint moves with it
      const int parent = document.node(n).parent;
      int& joint = joint_of_[static_cast<std::size_t>(n)];
      if (joint < 0 && parent >= 0) joint = joint_of_[static_cast<std::size_t>(parent)];
    }
    nodes_ = nodes;
  }

  void add(Index number) {
    const JsonView node = document_.element("nodes", number);
    if (!node.contains("mesh")) return;
    const bool skinned = node.contains("skin");
    const int fixed = joint_of_[static_cast<std::size_t>(number)];
    if (!skinned && fixed < 0) return;  // part of the scene
    if (skinned && !bind(node["skin"].as<Index>())) return;
    const JsonView primitives = document_.element("meshes", node["mesh"].as<Index>())["primitives"];
    for (Index p = 0; p < primitives.size(); ++p) {
      constexpr int triangles = 4;
      if (primitives[p].value_or("mode", triangles) != triangles) continue;
      const JsonView attributes = primitives[p]["attributes"];
      if (!is_readable(primitives[p])) {
        packed_ = true;
        continue;
      }
      const std::size_t first = mesh_.positions.size();
      const auto points = accessors_.values(attributes["POSITION"].as<Index>(), 3);
      if (skinned && attributes.contains("JOINTS_0") && attributes.contains("WEIGHTS_0")) {
        skin(*points, *accessors_.values(attributes["JOINTS_0"].as<Index>(), 4),
             *accessors_.values(attributes["WEIGHTS_0"].as<Index>(), 4), attributes["JOINTS_0"]);
      } else {
        if (fixed < 0) continue;
        const GltfPlace& place = world_[static_cast<std::size_t>(number)];
        for (std::size_t v = 0; v + 2 < points->size(); v += 3)
          vertex(leaning(fixed, place.place + place.linear * at(*points, v)),
                 {static_cast<std::uint16_t>(fixed), 0, 0, 0}, {65535, 0, 0, 0});
      }
      faces(primitives[p], first);
    }
  }
  SkinnedMesh<std::uint16_t> finish() && {
    if (mesh_.triangles.empty())
      raise<io_error>(404, document_.file(),
                      packed_ ? ": its meshes are packed: unpack the file first, for instance "
                                "with gltf-transform"
                              : ": no mesh moves with the joints");
    std::vector<Vec3<double>> normals(mesh_.positions.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); t += 3) {
      const auto corner = [&](std::size_t k) { return vec_cast<double>(mesh_.positions[mesh_.triangles[t + k]]); };
      const Vec3<double> area = cross(corner(1) - corner(0), corner(2) - corner(0));
      for (std::size_t k = 0; k < 3; ++k) normals[mesh_.triangles[t + k]] = normals[mesh_.triangles[t + k]] + area;
    }
    for (const Vec3<double>& n : normals)
      mesh_.normals.push_back(vec_cast<float>(norm(n) > 0 ? normalized(n) : Vec3<double>{0, 1, 0}));
    return std::move(mesh_);
  }

 private:
  using Four = std::array<std::uint16_t, 4>;
  static constexpr std::size_t most_vertices = 4'000'000;

  static Vec3<double> at(const std::vector<double>& values, std::size_t i) {
    return {values[i], values[i + 1], values[i + 2]};
  }
  bool is_readable(const JsonView& primitive) const {
    if (is_packed(primitive, {"KHR_draco_mesh_compression"}) != nullptr) return false;
    const JsonView attributes = primitive["attributes"];
    for (const char* name : {"POSITION", "JOINTS_0", "WEIGHTS_0"}) {
      if (attributes.contains(name) && !document_.has_data(attributes[name].as<Index>())) return false;
    }
    return attributes.contains("POSITION") &&
           (!primitive.contains("indices") || document_.has_data(primitive["indices"].as<Index>()));
  }
  /// The matrices of the joints of a skin, from a vertex to the world at rest. False if the skin is of another figure.
  bool bind(Index number) {
    const JsonView skin = document_.element("skins", number), joints = skin["joints"];
    std::shared_ptr<const std::vector<double>> inverse;
    if (skin.contains("inverseBindMatrices")) {
      const auto accessor = skin["inverseBindMatrices"].as<Index>();
      if (!document_.has_data(accessor)) {
        packed_ = true;
        return false;
      }
      inverse = accessors_.values(accessor, 16);
    }
    skin_joints_.clear(), linear_.clear(), offset_.clear();
    bool mine = false;
    for (Index i = 0; i < joints.size(); ++i) {
      const int node = document_.node_number(joints[i]), joint = joint_of_[static_cast<std::size_t>(node)];
      mine = mine || joint >= 0;
      skin_joints_.push_back(std::max(joint, 0));  // what is above the body goes with its root
      const GltfPlace& place = world_[static_cast<std::size_t>(node)];
      auto linear = place.linear;
      Vec3<double> offset = place.place;
      if (const auto m = static_cast<std::size_t>(16 * i); inverse != nullptr && m + 16 <= inverse->size()) {
        linear =
            place.linear * Matrix3<double>::from_columns(at(*inverse, m), at(*inverse, m + 4), at(*inverse, m + 8));
        offset = place.place + place.linear * at(*inverse, m + 12);
      }
      linear_.push_back(linear), offset_.push_back(offset);
    }
    return mine;
  }
  /// From the rest of the nodes to that of the skeleton.
  Vec3<double> leaning(int joint, const Vec3<double>& v) const {
    const auto j = static_cast<std::size_t>(joint);
    const Vec3<double>& from = nodes_[j] < 0 ? places_[j] : world_[static_cast<std::size_t>(nodes_[j])].place;
    return places_[j] + rotate(lean_[j], v - from);
  }
  void skin(const std::vector<double>& points, const std::vector<double>& joints, const std::vector<double>& weights,
            const JsonView& where) {
    if (4 * (points.size() / 3) != joints.size() || joints.size() != weights.size())
      raise<io_error>(403, where.path(), ": ", counted(points.size() / 3, "vertex", "vertices"), " and ",
                      counted(joints.size() / 4, "row"), " of joints");
    for (std::size_t v = 0; v < points.size() / 3; ++v) {
      std::array<double, 4> share{};
      double sum = 0;
      for (std::size_t k = 0; k < 4; ++k) sum += share[k] = std::max(weights[4 * v + k], 0.0);
      if (!(sum > 0)) share = {1, 0, 0, 0}, sum = 1;
      Vec3<double> place{};
      Four of{}, parts{};
      int left = 65535;
      for (std::size_t k = 0; k < 4; ++k) {
        if (share[k] == 0) continue;
        const double number = joints[4 * v + k];
        if (!(number >= 0 && number < static_cast<double>(skin_joints_.size())))
          raise<io_error>(403, where.path(), ": joint ", number, " of ", skin_joints_.size());
        const auto j = static_cast<std::size_t>(number);
        const Vec3<double> here = offset_[j] + linear_[j] * at(points, 3 * v);
        place = place + (share[k] / sum) * leaning(skin_joints_[j], here);
        of[k] = static_cast<std::uint16_t>(skin_joints_[j]);
        const int part = std::min(left, static_cast<int>(std::lround(65535 * share[k] / sum)));
        parts[k] = static_cast<std::uint16_t>(part);
        left -= part;
      }
      const auto largest = std::max_element(parts.begin(), parts.end());
      *largest = static_cast<std::uint16_t>(*largest + left);  // shares are rounded
      vertex(place, of, parts);
    }
  }
  void vertex(const Vec3<double>& place, const Four& joints, const Four& weights) {
    constexpr double far = 1e6;  // metres
    if (!(norm(place) < far)) raise<io_error>(403, document_.file(), ": a vertex is ", norm(place), " m away");
    if (mesh_.positions.size() == most_vertices)
      raise<io_error>(405, document_.file(), ": more than ", most_vertices, " vertices");
    mesh_.positions.push_back(vec_cast<float>(place));
    mesh_.joints.insert(mesh_.joints.end(), joints.begin(), joints.end());
    mesh_.weights.insert(mesh_.weights.end(), weights.begin(), weights.end());
  }
  void faces(const JsonView& primitive, std::size_t first) {
    const std::size_t count = mesh_.positions.size() - first;
    const auto corner = [&](double v) {
      if (!(v >= 0 && v < static_cast<double>(count)))
        raise<io_error>(403, primitive.path(), ": vertex ", v, " of ", count);
      mesh_.triangles.push_back(static_cast<std::uint32_t>(first + static_cast<std::size_t>(v)));
    };
    if (!primitive.contains("indices")) {
      for (std::size_t v = 0; v + 3 <= count; v += 3)
        corner(static_cast<double>(v)), corner(static_cast<double>(v + 1)), corner(static_cast<double>(v + 2));
      return;
    }
    const auto indices = accessors_.values(primitive["indices"].as<Index>(), 1);
    for (std::size_t i = 0; i + 3 <= indices->size(); i += 3)
      corner((*indices)[i]), corner((*indices)[i + 1]), corner((*indices)[i + 2]);
  }

  const GltfDocument& document_;
  SharedAccessors accessors_;
  const std::vector<Quaternion<double>>& lean_;
  std::vector<GltfPlace> world_;      // of the nodes at rest
  std::vector<Vec3<double>> places_;  // of the joints of the skeleton
  std::vector<int> nodes_;            // of the joints
  std::vector<int> joint_of_;         // of every node: its own, or that on which it hangs; -1 for none
  std::vector<int> skin_joints_{};    // of the skin at hand
  std::vector<Matrix3<double>> linear_{};
  std::vector<Vec3<double>> offset_{};
  SkinnedMesh<std::uint16_t> mesh_{};
  bool packed_ = false;
};

}  // namespace detail

MOTIONLANG_BODY detail::SkinnedMesh<std::uint16_t> GlbRig::mesh() const {
  detail::RigSurface surface(*document_, skeleton_, nodes_, lean_);
  for (Index n = 0; n < document_->count("nodes"); ++n) surface.add(n);
  return std::move(surface).finish();
}

MOTIONLANG_BODY void write_glb(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
                               const GlbRigOptions& options) {
  write_file(path, rig.with(motions, options));
}

MOTIONLANG_BODY MotionsOnRig motions_on_rig(const GlbRig& rig, std::span<const Motion> motions) {
  MotionsOnRig out;
  std::optional<SkeletonMap> map;  // from the first motion's skeleton, unless it is the character's own
  if (!motions.empty() && motions.front().skeleton != rig.skeleton()) {
    map.emplace(rig.map_from(motions.front().skeleton));
    out.report = map->report();
  }
  for (const Motion& m : motions) {
    out.motions.push_back(m.skeleton == rig.skeleton()         ? m
                          : map && m.skeleton == map->source() ? retarget(m, *map)
                                                               : retarget(m, rig.map_from(m.skeleton)));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
