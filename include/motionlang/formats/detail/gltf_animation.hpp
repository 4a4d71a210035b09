// SPDX-License-Identifier: MIT
/// Animations of a glTF document: the transform of any node at any time. Source: glTF 2.0, 3.11 and appendix C.
#pragma once

#include <array>     // values
#include <cstddef>   // sizes
#include <map>       // channels by node
#include <memory>    // values that channels share
#include <optional>  // rate
#include <set>       // lists of times
#include <string>    // name
#include <vector>    // values

#include <motionlang/core/shape.hpp>
#include <motionlang/formats/detail/gltf_node.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Keys of one property of one node over time.
struct GltfChannel {
  enum Mode { step, linear, cubic };
  std::shared_ptr<const std::vector<double>> times, values;
  Mode mode = linear;
  std::size_t components = 3;

  /// The value at `time`; before the first and after the last key theirs. Rotations are x, y, z, w and not normalised.
  std::array<double, 4> at(double time) const;

 private:
  using Value = std::array<double, 4>;

  /// Key k; a cubic one has an in-tangent before it and an out-tangent behind it.
  Value key(std::size_t k, int part = 1) const;
  static Value combine(double s, const Value& a, double t, const Value& b);
  /// p(u) = (2u^3 - 3u^2 + 1) a + span (u^3 - 2u^2 + u) a' + (3u^2 - 2u^3) b + span (u^3 - u^2) b'
  Value hermite(std::size_t k, const Value& a, const Value& b, double span, double u) const;
};

class GltfAnimation {
 public:
  /// Throws  io_error 402 to 405, config_error 107
  GltfAnimation(SharedAccessors& keys, Index number);

  const std::string& name() const { return name_; }
  /// Time of the last key, seconds.
  double duration() const { return duration_; }
  /// Keys per second, where all keys are at whole frames of one rate: those of the channel that has most, the first at
  /// 0.
  std::optional<double> rate() const;
  /// Keys of all channels; those that channels share count for each.
  std::size_t keys() const;
  bool animates(int node) const { return translations_.contains(node) || rotations_.contains(node); }

  /// Transform of a node, from its transform at rest; the scale stays.
  GltfTransform at(int node, GltfTransform transform, double time) const;
  /// True if the node ever leaves its place at rest by more than a hundredth of its distance to the parent.
  bool moves_away(int node, const Vec3<double>& rest) const { return leaves(translations_, node, rest); }
  /// True if its scale ever is another than at rest, by more than a hundredth.
  bool grows(int node, const Vec3<double>& rest) const { return leaves(scales_, node, rest); }

 private:
  /// Channels may share them: each once.
  std::set<const std::vector<double>*> lists_of_times() const;
  static bool leaves(const std::map<int, GltfChannel>& channels, int node, const Vec3<double>& rest);
  GltfChannel channel(SharedAccessors& keys, const JsonView& sampler, std::size_t components);

  std::string name_;
  std::map<int, GltfChannel> translations_, rotations_, scales_;
  double duration_ = 0;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/detail/gltf_animation.ipp>
#endif
