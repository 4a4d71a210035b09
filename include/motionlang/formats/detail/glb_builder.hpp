// SPDX-License-Identifier: MIT
/// A GLB file during writing: document, binary data, and the animations in them.
#pragma once

#include <algorithm>    // all_of, min, max
#include <cmath>        // isfinite
#include <concepts>     // types of components
#include <cstdint>      // types of components
#include <span>         // values
#include <string_view>  // types of accessors
#include <vector>       // data

#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/formats/detail/glb_container.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Builds the document and the binary chunk side by side. Every accessor has a view of its own, aligned to four bytes.
class GlbBuilder {
 public:
  nlohmann::ordered_json document{{"asset", {{"version", "2.0"}, {"generator", "motionlang " MOTIONLANG_VERSION}}},
                                  {"scene", 0},
                                  {"scenes", nlohmann::ordered_json::array()},
                                  {"nodes", nlohmann::ordered_json::array()},
                                  {"meshes", nlohmann::ordered_json::array()},
                                  {"materials", nlohmann::ordered_json::array()},
                                  {"skins", nlohmann::ordered_json::array()},
                                  {"animations", nlohmann::ordered_json::array()},
                                  {"accessors", nlohmann::ordered_json::array()},
                                  {"bufferViews", nlohmann::ordered_json::array()}};

  GlbBuilder() = default;
  /// Continues an existing file: its document, whose first buffer is the only one in the file, and its binary data.
  GlbBuilder(nlohmann::ordered_json file, std::span<const std::byte> binary)
      : document(std::move(file)), binary_(binary.begin(), binary.end()) {}

  enum Target { none = 0, attributes = 34962, indices = 34963 };
  template <class T>
  static constexpr int component_type = std::same_as<T, float>           ? 5126
                                        : std::same_as<T, std::uint32_t> ? 5125
                                        : std::same_as<T, std::uint16_t> ? 5123
                                                                         : 5121;

  /// Stores values and returns the number of their accessor. `with_range`: also store the smallest and largest of every
  /// component. Throws numeric_error 301 for a value that single precision cannot hold.
  template <class T>
  std::size_t add(std::span<const T> values, const char* type, Target target, bool with_range = false) {
    const std::size_t components = std::string_view(type) == "SCALAR" ? 1
                                   : std::string_view(type) == "VEC3" ? 3
                                   : std::string_view(type) == "VEC4" ? 4
                                                                      : 16;
    if constexpr (std::same_as<T, float>) {
      if (!std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); }))
        raise<numeric_error>(301, "GLB: a number is too large for single precision");
    }
    binary_.resize((binary_.size() + 3) / 4 * 4);
    nlohmann::ordered_json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", values.size_bytes()}};
    if (target != none) view["target"] = static_cast<int>(target);
    append_bytes(binary_, std::as_bytes(values));
    nlohmann::ordered_json accessor{{"bufferView", document["bufferViews"].size()},
                                    {"componentType", component_type<T>},
                                    {"count", values.size() / components},
                                    {"type", type}};
    for (std::size_t c = 0; with_range && c < components; ++c) {
      T low = values[c], high = values[c];
      for (std::size_t i = c; i < values.size(); i += components) {
        low = std::min(low, values[i]);
        high = std::max(high, values[i]);
      }
      accessor["min"].push_back(low);
      accessor["max"].push_back(high);
    }
    document["bufferViews"].push_back(std::move(view));
    document["accessors"].push_back(std::move(accessor));
    return document["accessors"].size() - 1;
  }
  std::size_t add(std::span<const Vec3<float>> values, Target target, bool with_range = false) {
    static_assert(sizeof(Vec3<float>) == 3 * sizeof(float));
    std::vector<float> flat;
    for (const Vec3<float>& v : values) flat.insert(flat.end(), {v.x, v.y, v.z});
    return add(std::span<const float>(flat), "VEC3", target, with_range);
  }

  /// Removes the binary data from byte `size` on.
  void cut(std::size_t size) { binary_.resize(std::min(size, binary_.size())); }

  std::vector<std::byte> finish() {
    if (document["buffers"].empty()) document["buffers"].push_back(nlohmann::ordered_json::object());
    document["buffers"][0]["byteLength"] = binary_.size();
    return glb_file(json_text(document), std::move(binary_));
  }

 private:
  std::vector<std::byte> binary_;
};

inline nlohmann::ordered_json to_json(const Vec3<double>& v) { return nlohmann::ordered_json::array({v.x, v.y, v.z}); }

/// Rotation of one joint over time as x, y, z, w: unit quaternions, each with the sign closest to the one before.
inline std::vector<float> rotation_track(const Motion& motion, std::size_t joint) {
  std::vector<float> out;
  Quaternion<double> before = Quaternion<double>::identity();
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    Quaternion<double> q = normalized(motion.rotations(frame)[joint]);
    if (dot(before, q) < 0) q = -q;
    before = q;
    for (const double x : {q.x, q.y, q.z, q.w}) out.push_back(static_cast<float>(x));
  }
  return out;
}

/// nodes   the node of every joint, -1 for a joint without a channel; rotations are relative to the node's parent
/// Throws  config_error 101 if two frames fall on the same time in single precision
inline void add_animation(GlbBuilder& glb, const Motion& motion, std::span<const int> nodes) {
  std::vector<float> times;
  for (Index frame = 0; frame < motion.frames(); ++frame) {
    times.push_back(static_cast<float>(static_cast<double>(frame) / motion.fps));
    if (frame > 0 && !(times.back() > times[times.size() - 2])) {
      raise<config_error>(101, "GLB: frames ", frame - 1, " and ", frame, " of '", motion.name,
                          "' have the same time at ", motion.fps, " frames per second");
    }
  }
  const std::size_t input = glb.add(std::span<const float>(times), "SCALAR", GlbBuilder::none, true);
  nlohmann::ordered_json animation{{"name", motion.name.empty() ? "motion" : motion.name},
                                   {"channels", nlohmann::ordered_json::array()},
                                   {"samplers", nlohmann::ordered_json::array()}};
  auto add_channel = [&](int node, const char* path, std::size_t output) {
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    animation["samplers"].push_back({{"input", input}, {"interpolation", "LINEAR"}, {"output", output}});
  };
  std::vector<Vec3<float>> root;
  for (const Vec3<double>& p : motion.root) root.push_back(vec_cast<float>(p));
  add_channel(nodes[0], "translation", glb.add(root, GlbBuilder::none));
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    if (nodes[j] < 0) continue;
    const std::vector<float> track = rotation_track(motion, j);
    add_channel(nodes[j], "rotation", glb.add(std::span<const float>(track), "VEC4", GlbBuilder::none));
  }
  glb.document["animations"].push_back(std::move(animation));
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
