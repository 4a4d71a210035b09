// SPDX-License-Identifier: MIT
/// Animations of a glTF document: the transform of any node at any time. Source: glTF 2.0, 3.11 and appendix C.
#pragma once

#include <array>     // values
#include <cstddef>   // sizes
#include <map>       // channels by node
#include <memory>    // values that channels share
#include <optional>  // rate
#include <span>      // nodes
#include <string>    // name
#include <vector>    // values

#include <motionlang/core/shape.hpp>
#include <motionlang/formats/detail/gltf_node.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Keys of one property of one node over time.
struct GltfChannel {
  using Values = std::shared_ptr<const std::vector<double>>;
  enum Mode { step, linear, cubic };
  Values times, values;  // times do not descend; the last of several keys at one time counts
  Mode mode = linear;
  std::size_t components = 3;

  /// The value at `time`. Before the first and after the last key it is constant. Rotations are x, y, z, w and not
  /// normalised.
  std::array<double, 4> at(double time) const;
  /// The value, if all keys have it to a thousandth and no curve leaves it.
  std::optional<Vec3<double>> constant() const;

 private:
  using Value = std::array<double, 4>;

  /// Key k. A cubic one has an in-tangent before it and an out-tangent after it.
  Value key(std::size_t k, int part = 1) const;
  static Value combine(double s, const Value& a, double t, const Value& b);
  /// p(u) = (2u^3 - 3u^2 + 1) a + span (u^3 - 2u^2 + u) a' + (3u^2 - 2u^3) b + span (u^3 - u^2) b'
  Value hermite(std::size_t k, const Value& a, const Value& b, double span, double u) const;
};

/// The times of the keys of some nodes.
struct GltfTiming {
  double first = 0, last = 0;    // key, seconds
  std::size_t keys = 0;          // of all channels; keys that channels share count for each
  std::optional<double> rate{};  // keys per second, if all are at whole frames of one rate from the first on
  bool dense = false;            // some channel has a key at every frame of this rate
  bool cubic = false;            // a channel is a curve between its keys
  double usual = 0;  // seconds between keys of the channel with the most keys: their median; 0 with fewer than two keys
};

class GltfAnimation {
 public:
  /// Throws  io_error 402 to 405, config_error 107
  GltfAnimation(SharedAccessors& keys, Index number);

  const std::string& name() const { return name_; }
  /// Deviations of the keys from what glTF allows: sentences that follow the name of the animation.
  const std::vector<std::string>& repairs() const { return repairs_; }
  /// The timing of the channels of these nodes, which must ascend. All values are 0 if there are none.
  GltfTiming timing(std::span<const int> nodes) const;

  bool animates(int node) const {
    return translations_.contains(node) || rotations_.contains(node) || scales_.contains(node);
  }
  /// True if a node ever leaves its transform at rest: by more than a hundredth of its distance to the parent or of its
  /// scale, or by half a degree.
  bool moves(int node, const GltfTransform& rest) const;

  /// Transform of a node, from its transform at rest.
  GltfTransform at(int node, const GltfTransform& rest, double time) const;
  /// Its transform at rest, in which a constant translation or scale of the animation replaces the node's own.
  GltfTransform rest(int node, GltfTransform rest) const;
  /// True if the node ever leaves its place at rest by more than a hundredth of its distance to the parent.
  bool moves_away(int node, const Vec3<double>& rest) const { return leaves(translations_, node, rest); }
  /// True if its scale ever differs from that at rest by more than a hundredth.
  bool grows(int node, const Vec3<double>& rest) const { return leaves(scales_, node, rest); }

 private:
  using Channels = std::map<int, GltfChannel>;

  static bool leaves(const Channels& channels, int node, const Vec3<double>& rest);
  static bool differs(const Vec3<double>& v, const Vec3<double>& rest);
  GltfChannel channel(SharedAccessors& keys, const JsonView& sampler, std::size_t components);
  /// Puts keys in the order of their times.
  static void sort_keys(GltfChannel& channel);
  void repair(const std::string& sentence);
  /// Moves all keys so that the first is at 0, if it is before 0.
  void begin_at_0();

  std::string name_;
  std::vector<std::string> repairs_;
  Channels translations_, rotations_, scales_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/detail/gltf_animation.ipp>
#endif
