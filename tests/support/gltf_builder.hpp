/// glTF documents for tests, node by node.
#pragma once

#include <string_view>  // types of accessors
#include <vector>       // bytes

#include <motionlang/formats/detail/glb_container.hpp>
#include <motionlang/formats/glb_reader.hpp>

namespace gltf {

namespace ml = motionlang;
using nlohmann::json;

/// A document under construction: floats go to the binary chunk, one accessor each.
struct Builder {
  json document{{"asset", {{"version", "2.0"}}}, {"buffers", json::array({json::object()})}};
  std::vector<std::byte> binary{};

  int floats(std::vector<float> values, std::string_view type) {
    const int components = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
    document["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", 4 * values.size()}});
    document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                     {"componentType", 5126},
                                     {"count", static_cast<int>(values.size()) / components},
                                     {"type", type}});
    ml::detail::append_bytes(binary, std::as_bytes(std::span(values)));
    return static_cast<int>(document["accessors"].size()) - 1;
  }
  int node(json n) {
    document["nodes"].push_back(std::move(n));
    return static_cast<int>(document["nodes"].size()) - 1;
  }
  void child(int parent, int node) { document["nodes"][static_cast<std::size_t>(parent)]["children"].push_back(node); }
  void skin(json joints) { document["skins"].push_back({{"joints", std::move(joints)}}); }
  void animate(int node, const char* path, int input, int output, const char* mode = "LINEAR") {
    if (!document.contains("animations")) {
      document["animations"].push_back({{"name", "clip"}, {"channels", json::array()}, {"samplers", json::array()}});
    }
    json& a = document["animations"][0];
    a["channels"].push_back({{"sampler", a["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    a["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", mode}});
  }
  std::vector<std::byte> bytes() const {
    json d = document;
    if (!d["buffers"][0].contains("byteLength")) d["buffers"][0]["byteLength"] = binary.size();
    return ml::detail::glb_file(d.dump(), binary);
  }
  ml::GlbFile file() const { return ml::GlbFile(bytes(), "test.glb"); }
};

}  // namespace gltf
