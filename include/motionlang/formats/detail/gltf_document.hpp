// SPDX-License-Identifier: MIT
/// Accessors and nodes of a glTF document with its data in the file: in the binary chunk of GLB, or in base64. Every
/// value of the file is checked before it is used.
#pragma once

#include <algorithm>         // max
#include <initializer_list>  // extensions
#include <map>               // accessors by number, bones
#include <memory>            // shared accessors
#include <numeric>           // accumulate
#include <set>               // names of bones

#include <motionlang/formats/detail/glb_container.hpp>
#include <motionlang/formats/detail/gltf_node.hpp>
#include <motionlang/geometry/so3.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The extension among these that packs the data of an object of the file; null if there is none.
inline const char* is_packed(const JsonView& object, std::initializer_list<const char*> extensions) {
  for (const char* packed : extensions) {
    if (object.contains("extensions") && object["extensions"].contains(packed)) return packed;
  }
  return nullptr;
}

/// The JSON of a buffer may lack its length. It is then the size of its data in the file.
/// Only required extensions that pack data that is read here matter. Others concern meshes and materials.
class GltfDocument {
 public:
  /// Throws  io_error 402 to 404; config_error 107 if JSON has a value of the wrong kind
  GltfDocument(std::span<const std::byte> bytes, std::string file)
      : file_(std::move(file)), size_(bytes.size()), chunks_(parse_glb_chunks(bytes, file_)) {
    const std::string version = root()["asset"]["version"].as<std::string>();
    if (!version.starts_with("2.")) raise<io_error>(404, file_, ": glTF of version ", version, ", expected 2");
    decode_buffers();
    read_nodes();
    name_humanoid();
  }

  const std::string& file() const { return file_; }
  /// Bytes of the file.
  std::size_t size() const { return size_; }
  JsonView root() const { return JsonView(chunks_.document, file_); }
  /// The data of a buffer: the binary chunk without its padding, or the base64 data in the document. Throws io_error
  /// 402, and 404 if they are not in this file.
  std::span<const std::byte> buffer(Index i) const {
    const JsonView b = element("buffers", i);
    const bool decoded = b.contains("uri");
    if (decoded ? !is_data(b["uri"].as<std::string>()) : i != 0) {
      raise<io_error>(404, b.path(),
                      ": the buffer is not in this file: pack everything into one .glb file, for instance with "
                      "gltf-transform");
    }
    const std::span<const std::byte> data = decoded ? std::span(decoded_[static_cast<std::size_t>(i)]) : chunks_.binary;
    return slice(data, 0, b.value_or("byteLength", std::uint64_t{data.size()}), b.path(), "buffer");
  }
  /// The elements of a top-level array; none if it is missing.
  Index count(const std::string& array) const { return root().contains(array) ? root()[array].size() : 0; }
  JsonView element(const std::string& array, Index i) const { return root()[array][i]; }
  /// Sentences about what glTF does not allow in the nodes, and how it is read.
  const std::vector<std::string>& repairs() const { return repairs_; }

  const std::vector<GltfNode>& nodes() const { return nodes_; }
  const GltfNode& node(int i) const { return nodes_[static_cast<std::size_t>(i)]; }
  /// All nodes, every parent before its children, depth first.
  const std::vector<int>& depth_first() const { return order_; }

  /// The value of `reference`, which must be the number of a node. Throws io_error 403.
  int node_number(const JsonView& reference) const {
    const auto i = reference.as<std::int64_t>();
    if (i < 0 || i >= static_cast<std::int64_t>(nodes_.size())) {
      raise<io_error>(403, reference.path(), ": node ", i, " of ", nodes_.size());
    }
    return static_cast<int>(i);
  }

  /// True if the values of an accessor are in this file, and not packed.
  bool has_data(Index accessor) const {
    const JsonView a = element("accessors", accessor);
    if (!a.contains("bufferView")) return true;
    const JsonView view = element("bufferViews", a["bufferView"].as<Index>());
    const auto buffer = view["buffer"].as<Index>();
    const JsonView b = element("buffers", buffer);
    const bool is_here = b.contains("uri") ? is_data(b["uri"].as<std::string>()) : buffer == 0;
    return is_here && is_packed(view, packed_views) == nullptr;
  }

  /// The values of an accessor, `components` per element. Integers that are marked as normalised become real numbers.
  /// Values that the file does not have are 0, and a sparse accessor replaces some.
  /// Source  glTF 2.0, 3.6.2
  /// Throws  io_error 402 if they are outside of the file, 403, 404 for data in other files, 405 if the file does not
  ///         have them and is too small for that many
  std::vector<double> values(Index accessor, std::size_t components) const {
    const JsonView a = element("accessors", accessor);
    const std::size_t kinds = components_of(a["type"].as<std::string>());
    if (kinds != components)
      raise<io_error>(403, a.path(), ": ", counted(kinds, "component"), ", expected ", components);
    const int type = a["componentType"].as<int>();
    const std::size_t size = size_of(type, a);
    const auto count = a["count"].as<std::uint64_t>();
    const bool normalised = a.value_or("normalized", false);

    std::vector<double> out;
    auto read = [&](const Elements& from, std::uint64_t i, std::uint64_t to) {
      for (std::size_t c = 0; c < components; ++c) {
        double& value = out[to * components + c];
        value = number(from.at(i) + c * size, type, normalised);
        if (!std::isfinite(value)) raise<io_error>(403, a.path(), ": element ", to, " is not finite");
      }
    };
    if (a.contains("bufferView")) {
      const Elements stored = elements(a, count, size * components);
      out.resize(count * components);
      for (std::uint64_t i = 0; i < count; ++i) read(stored, i, i);
    } else {
      if (count > (size_ / 4 + most_made_up) / components)
        raise<io_error>(405, a.path(), ": ", counted(count, "element"), " that are not in the file, which has ",
                        counted(size_, "byte"));
      out.resize(count * components);
    }
    if (a.contains("sparse")) replace_some(a["sparse"], count, size * components, read);
    return out;
  }

 private:
  static constexpr std::initializer_list<const char*> packed_views{"EXT_meshopt_compression",
                                                                   "KHR_meshopt_compression"};
  static constexpr std::size_t most_made_up = 1 << 20;  // values that a small file may leave out

  static std::size_t components_of(std::string_view type) {
    return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : type == "MAT4" ? 16 : 0;
  }
  static std::size_t size_of(int component_type, const JsonView& accessor) {
    switch (component_type) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        raise<io_error>(403, accessor.path(), ": componentType ", component_type);
    }
  }
  /// Source  glTF 2.0, 3.11 for normalised integers
  static double number(const std::byte* at, int component_type, bool normalised) {
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, at, sizeof value);
      if constexpr (std::integral<T>) {
        if (normalised) return std::max(static_cast<double>(value) / std::numeric_limits<T>::max(), -1.0);
      }
      return static_cast<double>(value);
    };
    switch (component_type) {
      case 5120:
        return as(std::int8_t{});
      case 5121:
        return as(std::uint8_t{});
      case 5122:
        return as(std::int16_t{});
      case 5123:
        return as(std::uint16_t{});
      case 5125:
        return as(std::uint32_t{});
      default:
        return as(float{});
    }
  }

  static constexpr std::string_view base64_mark = ";base64,";
  static bool is_data(std::string_view uri) { return uri.starts_with("data:") && uri.find(base64_mark) != uri.npos; }
  void decode_buffers() {
    for (Index i = 0; i < count("buffers"); ++i) {
      const JsonView b = element("buffers", i);
      const std::string uri = b.value_or("uri", "");
      decoded_.emplace_back();
      const std::size_t begin = uri.find(base64_mark) + base64_mark.size();
      if (is_data(uri)) decoded_.back() = from_base64(std::string_view(uri).substr(begin), b.path());
    }
  }

  /// Elements of an accessor, or of a part of a sparse one, in a buffer.
  struct Elements {
    const std::byte* first;
    std::uint64_t stride;  // bytes
    const std::byte* at(std::uint64_t i) const { return first + i * stride; }
  };
  /// `count` elements of `item` bytes each, at the object's bufferView and byteOffset.
  Elements elements(const JsonView& object, std::uint64_t count, std::uint64_t item) const {
    const JsonView view = element("bufferViews", object["bufferView"].as<Index>());
    if (const char* packed = is_packed(view, packed_views))
      raise<io_error>(404, view.path(), ": packed by ", packed,
                      ": unpack the file first, for instance with gltf-transform");
    const auto data = slice(buffer(view["buffer"].as<Index>()), view.value_or("byteOffset", std::uint64_t{0}),
                            view["byteLength"].as<std::uint64_t>(), view.path(), "buffer view");
    const auto start = object.value_or("byteOffset", std::uint64_t{0}), stride = view.value_or("byteStride", item);
    if (stride < item)
      raise<io_error>(403, view.path(), ": byteStride ", stride, " for elements of ", counted(item, "byte"));
    const bool fits = count == 0 || (start <= data.size() && item <= data.size() - start &&
                                     (count - 1) <= (data.size() - start - item) / stride);
    if (!fits)
      raise<io_error>(402, object.path(), ": ", counted(count, "element does not fit", "elements do not fit"), " into ",
                      counted(data.size(), "byte"));
    return {count == 0 ? data.data() : data.data() + start, stride};
  }
  /// Calls read(values, i, place) for every element of a sparse accessor. Their places among `count` elements ascend.
  template <class F>
  void replace_some(const JsonView& sparse, std::uint64_t count, std::uint64_t item, F read) const {
    const JsonView indices = sparse["indices"];
    const int type = indices["componentType"].as<int>();
    if (type != 5121 && type != 5123 && type != 5125) raise<io_error>(403, indices.path(), ": componentType ", type);
    const auto some = sparse["count"].as<std::uint64_t>();
    const Elements places = elements(indices, some, size_of(type, indices));
    const Elements values = elements(sparse["values"], some, item);
    std::uint64_t next = 0;  // the smallest place that may follow
    for (std::uint64_t i = 0; i < some; ++i) {
      const auto place = static_cast<std::uint64_t>(number(places.at(i), type, false));
      if (place < next || place >= count)
        raise<io_error>(403, indices.path(), ": index ", i, " is ", place, ", expected one from ", next,
                        " on and below ", count);
      read(values, i, place);
      next = place + 1;
    }
  }

  Vec3<double> vector(const JsonView& node, const std::string& key, const Vec3<double>& otherwise) const {
    const auto v = node.value_or(key, std::vector<double>{otherwise.x, otherwise.y, otherwise.z});
    if (v.size() != 3 || !std::isfinite(v[0] + v[1] + v[2])) raise<io_error>(403, node.path(), ": ", key);
    return {v[0], v[1], v[2]};
  }
  Quaternion<double> quaternion(const JsonView& node, const std::string& name) {
    const auto v = node.value_or("rotation", std::vector<double>{0, 0, 0, 1});
    const double squared = std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
    if (v.size() == 4 && squared == 0) {
      if (repairs_.empty())
        repairs_.push_back(concat_text("node '", name, "' has a rotation of zeros: it is read as no rotation"));
      return Quaternion<double>::identity();
    }
    if (v.size() != 4 || !(squared > 1e-6 && squared < 1e6)) raise<io_error>(403, node.path(), ": rotation");
    return normalized(Quaternion<double>{v[3], v[0], v[1], v[2]});
  }
  /// A matrix as translation, rotation and scale, if it is such a product. A reflection is a negative scale along x.
  GltfTransform decomposed(const JsonView& node) const {
    const auto m = node["matrix"].as<std::vector<double>>();
    const double sum = std::accumulate(m.begin(), m.end(), 0.0);
    if (m.size() != 16 || !std::isfinite(sum)) raise<io_error>(403, node.path(), ": matrix");
    const Vec3<double> x{m[0], m[1], m[2]}, y{m[4], m[5], m[6]}, z{m[8], m[9], m[10]};
    const auto linear = Matrix3<double>::from_columns(x, y, z);
    const double sign = determinant(linear) < 0 ? -1 : 1;
    GltfTransform out{{m[12], m[13], m[14]}, Quaternion<double>::identity(), {sign * norm(x), norm(y), norm(z)}};
    if (auto turn = nearest_orthogonal(linear)) {
      for (int row = 0; row < 3; ++row) (*turn)(row, 0) *= sign;
      out.rotation = normalized(to_quaternion(*turn));
    }
    const double sizes = norm(x) * norm(y) * norm(z);
    if (!(sizes > 0 && std::abs(determinant(linear)) > (1 - 1e-6) * sizes)) out.sheared = linear;
    return out;
  }

  void read_nodes() {
    nodes_.resize(static_cast<std::size_t>(count("nodes")));
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const JsonView n = element("nodes", static_cast<Index>(i));
      nodes_[i].name = n.value_or("name", "");
      if (nodes_[i].name.empty()) nodes_[i].name = concat_text("node_", i);
      nodes_[i].rest = n.contains("matrix") ? decomposed(n)
                                            : GltfTransform{vector(n, "translation", {}), quaternion(n, nodes_[i].name),
                                                            vector(n, "scale", {1, 1, 1})};
      nodes_[i].is_thing = n.contains("mesh") || n.contains("camera") ||
                           (n.contains("extensions") && n["extensions"].contains("KHR_lights_punctual"));
      for (Index c = 0; n.contains("children") && c < n["children"].size(); ++c) {
        const int child = node_number(n["children"][c]);
        GltfNode& target = nodes_[static_cast<std::size_t>(child)];
        if (target.parent >= 0) raise<io_error>(403, n.path(), ": child ", child, " has two parents");
        target.parent = static_cast<int>(i);
        nodes_[i].children.push_back(child);
      }
    }
    std::vector<int> open;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (nodes_[i].parent < 0) open.push_back(static_cast<int>(i));
    }
    while (!open.empty()) {
      const int i = open.back();
      open.pop_back();
      order_.push_back(i);
      const auto& c = node(i).children;
      open.insert(open.end(), c.rbegin(), c.rend());
    }
    if (order_.size() != nodes_.size()) raise<io_error>(403, file_, ": the tree of nodes has a cycle");
  }

  /// VRM 1.0's name of a bone of VRM 0.x, which has other names for the joints of thumbs.
  static std::string name_of_1_0(const std::string& bone) {
    const std::size_t thumb = bone.find("ThumbIntermediate");
    if (thumb != bone.npos) return bone.substr(0, thumb) + "ThumbProximal";
    return bone.ends_with("ThumbProximal") ? bone.substr(0, bone.size() - 8) + "Metacarpal" : bone;
  }

  /// Avatars list the nodes that are the bones of a humanoid, whatever the names of the nodes. -1: a bone without a
  /// node.
  /// Source  VRM 0.x: VRM; 1.0: VRMC_vrm, VRMC_vrm_animation
  void name_humanoid() {
    if (!root().contains("extensions")) return;
    const JsonView extensions = root()["extensions"];
    std::map<int, std::string> bones;
    auto add = [&](const std::string& bone, const JsonView& node) {
      if (node.as<std::int64_t>() != -1) bones[node_number(node)] = bone;
    };
    for (const char* name : {"VRMC_vrm", "VRMC_vrm_animation"}) {
      if (!extensions.contains(name)) continue;
      const JsonView all = extensions[name]["humanoid"]["humanBones"];
      for (const std::string& bone : all.keys()) add(bone, all[bone]["node"]);
    }
    if (extensions.contains("VRM")) {
      const JsonView all = extensions["VRM"]["humanoid"]["humanBones"];
      for (Index i = 0; i < all.size(); ++i) add(name_of_1_0(all[i]["bone"].as<std::string>()), all[i]["node"]);
    }
    std::set<std::string> names;
    for (const auto& [node, bone] : bones) names.insert(bone);
    for (GltfNode& node : nodes_) {
      if (names.contains(node.name)) node.name += " (no bone)";
    }
    for (const auto& [node, bone] : bones) {
      nodes_[static_cast<std::size_t>(node)].name = bone;
      nodes_[static_cast<std::size_t>(node)].is_bone = true;
    }
  }

  std::string file_;
  std::size_t size_;
  GlbChunks chunks_;
  std::vector<std::vector<std::byte>> decoded_;  // of the buffers in base64
  std::vector<GltfNode> nodes_;
  std::vector<int> order_;
  std::vector<std::string> repairs_;
};

/// All nodes in the world at rest. Throws io_error 403 for an infinitely distant node.
inline std::vector<GltfPlace> world_at_rest(const GltfDocument& document) {
  std::vector<GltfPlace> world(document.nodes().size());
  for (const int n : document.depth_first()) {
    const GltfNode& node = document.node(n);
    GltfPlace& w = world[static_cast<std::size_t>(n)];
    w = (node.parent < 0 ? GltfPlace{} : world[static_cast<std::size_t>(node.parent)]) * node.rest;
    const double sum = std::accumulate(w.linear.m.begin(), w.linear.m.end(), norm(w.place));
    if (!std::isfinite(sum))
      raise<io_error>(403, document.file(), ": node ", n, " '", node.name, "' is infinitely far away");
  }
  return world;
}

/// Accessors that are used several times (the times of an animation), each read once. A small file whose objects all
/// point to one place could require far more work than it has bytes. Such a file is refused.
class SharedAccessors {
 public:
  using Values = std::shared_ptr<const std::vector<double>>;

  explicit SharedAccessors(const GltfDocument& document) : document_(document), left_(16 * document.size()) {}

  const GltfDocument& document() const { return document_; }
  /// Throws io_error 402 to 405.
  Values values(Index accessor, std::size_t components) {
    auto& known = known_[{accessor, components}];
    if (known == nullptr) known = std::make_shared<const std::vector<double>>(document_.values(accessor, components));
    if (known->size() > left_)
      raise<io_error>(405, document_.file(), ": repeats its data more often than a valid file does");
    left_ -= known->size();
    return known;
  }

 private:
  const GltfDocument& document_;
  std::map<std::pair<Index, std::size_t>, Values> known_;
  std::size_t left_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
