/// Where the nodes of a glTF document are, by 4 x 4 matrices: an independent calculation, with which the reader of GLB
/// files is compared.
#pragma once

#include <array>    // matrices
#include <cmath>    // sin
#include <cstring>  // memcpy
#include <string>   // names
#include <vector>   // keys

#include <motionlang/formats/detail/glb_container.hpp>
#include <motionlang/geometry/vec.hpp>

namespace gltf {

namespace ml = motionlang;

class World {
 public:
  using Matrix = std::array<double, 16>;  // row by row

  explicit World(std::span<const std::byte> glb) {
    const auto chunks = ml::detail::parse_glb_chunks(glb, "world");
    d_ = nlohmann::json::parse(chunks.text);
    binary_.assign(chunks.binary.begin(), chunks.binary.end());
    parents_.assign(d_["nodes"].size(), -1);
    for (std::size_t n = 0; n < parents_.size(); ++n) {
      for (const auto& c : d_["nodes"][n].value("children", nlohmann::json::array()))
        parents_[c.get<std::size_t>()] = static_cast<int>(n);
    }
  }

  int find(const std::string& name) const {
    for (std::size_t n = 0; n < parents_.size(); ++n) {
      if (d_["nodes"][n].value("name", "") == name) return static_cast<int>(n);
    }
    return -1;
  }
  /// The place of a node `seconds` into an animation; a negative number is none: at rest.
  ml::Vec3<double> position(int node, double seconds, int animation = 0) const {
    const Matrix m = matrix(node, seconds, animation);
    return {m[3], m[7], m[11]};
  }
  Matrix matrix(int node, double seconds, int animation = 0) const {
    Matrix m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    for (int n = node; n >= 0; n = parents_[static_cast<std::size_t>(n)]) m = product(local(n, seconds, animation), m);
    return m;
  }
  std::vector<double> floats(int accessor) const {
    const auto& a = d_["accessors"][static_cast<std::size_t>(accessor)];
    const auto& v = d_["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::string type = a["type"];
    const std::size_t width = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
    std::vector<float> f(a["count"].get<std::size_t>() * width);
    std::memcpy(f.data(), binary_.data() + v.value("byteOffset", 0) + a.value("byteOffset", 0), 4 * f.size());
    return {f.begin(), f.end()};
  }

 private:
  static Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t k = 0; k < 4; ++k) c[4 * i + j] += a[4 * i + k] * b[4 * k + j];
      }
    }
    return c;
  }
  Matrix local(int node, double seconds, int animation) const {
    const auto& n = d_["nodes"][static_cast<std::size_t>(node)];
    if (n.contains("matrix")) {
      Matrix m;
      for (std::size_t i = 0; i < 16; ++i) m[4 * (i % 4) + i / 4] = n["matrix"][i];
      return m;
    }
    auto t = n.value("translation", std::vector<double>{0, 0, 0}),
         q = n.value("rotation", std::vector<double>{0, 0, 0, 1}), s = n.value("scale", std::vector<double>{1, 1, 1});
    if (seconds >= 0) {
      const auto& a = d_["animations"][static_cast<std::size_t>(animation)];
      for (const auto& channel : a["channels"]) {
        if (channel["target"].value("node", -1) != node) continue;
        const std::string path = channel["target"]["path"];
        const auto v = value(a["samplers"][channel["sampler"].get<std::size_t>()], path == "rotation" ? 4 : 3, seconds);
        (path == "rotation" ? q : path == "scale" ? s : t) = v;
      }
    }
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
    const std::array<double, 9> r{1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                                  2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                                  2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    return {r[0] * s[0], r[1] * s[1], r[2] * s[2], t[0], r[3] * s[0], r[4] * s[1], r[5] * s[2], t[1],
            r[6] * s[0], r[7] * s[1], r[8] * s[2], t[2], 0,           0,           0,           1};
  }
  std::vector<double> value(const nlohmann::json& sampler, std::size_t width, double seconds) const {
    const auto times = floats(sampler["input"]), all = floats(sampler["output"]);
    const std::string mode = sampler.value("interpolation", "LINEAR");
    const bool cubic = mode == "CUBICSPLINE";
    const auto key = [&](std::size_t k, std::size_t part = 1) {
      const std::size_t at = (cubic ? 3 * k + part : k) * width;
      return std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(at),
                                 all.begin() + static_cast<std::ptrdiff_t>(at + width));
    };
    std::size_t next = 0;
    while (next < times.size() && times[next] <= seconds) ++next;
    if (next == 0) return key(0);
    if (next == times.size() || mode == "STEP") return key(next - 1);
    const double span = times[next] - times[next - 1], u = (seconds - times[next - 1]) / span;
    auto a = key(next - 1), b = key(next);
    double wa = 1 - u, wb = u;
    if (cubic) {
      const auto out = key(next - 1, 2), in = key(next, 0);
      for (std::size_t c = 0; c < width; ++c) {
        const double u2 = u * u, u3 = u2 * u;
        a[c] = (2 * u3 - 3 * u2 + 1) * a[c] + span * (u3 - 2 * u2 + u) * out[c] + (3 * u2 - 2 * u3) * b[c] +
               span * (u3 - u2) * in[c];
      }
      return a;
    }
    if (width == 4) {
      double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
      if (cosine < 0) {
        cosine = -cosine;
        for (double& x : b) x = -x;
      }
      const double angle = std::acos(std::min(cosine, 1.0));
      if (angle > 1e-6) wa = std::sin((1 - u) * angle) / std::sin(angle), wb = std::sin(u * angle) / std::sin(angle);
    }
    for (std::size_t c = 0; c < width; ++c) a[c] = wa * a[c] + wb * b[c];
    return a;
  }

  nlohmann::json d_;
  std::vector<std::byte> binary_;
  std::vector<int> parents_;
};

/// The largest distance between a joint of a motion and the node of its name. The first frame is at `begin` seconds.
inline double farthest(const ml::Motion& motion, const World& world, double begin = 0, int animation = 0) {
  double worst = 0;
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  const auto positions = motion.positions();
  for (std::size_t j = 0; j < joints; ++j) {
    const int node = world.find(motion.skeleton.names[j]);
    for (ml::Index f = 0; f < motion.frames(); ++f) {
      const double t = begin + static_cast<double>(f) / motion.fps;
      const auto want = world.position(node, t, animation);
      worst = std::max(worst, norm(positions[static_cast<std::size_t>(f) * joints + j] - want));
    }
  }
  return worst;
}

}  // namespace gltf
