// SPDX-License-Identifier: MIT
// Bodies of gltf_animation.hpp.
#pragma once

#include <algorithm>  // all_of, clamp, max_element
#include <cmath>      // round
#include <limits>     // precision of a float

#include <motionlang/formats/detail/gltf_animation.hpp>
#include <motionlang/formats/detail/gltf_document.hpp>
#include <motionlang/geometry/slerp.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::array<double, 4> GltfChannel::at(double time) const {
  const auto& t = *times;
  const auto next = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), time) - t.begin());
  if (next == 0) return key(0);
  if (next == t.size() || mode == step) return key(next - 1);
  const double span = t[next] - t[next - 1], u = (time - t[next - 1]) / span;
  const auto a = key(next - 1), b = key(next);
  if (mode == cubic) return hermite(next - 1, a, b, span, u);
  if (components == 4) {
    const auto q = slerp(Quaternion<double>{a[3], a[0], a[1], a[2]}, Quaternion<double>{b[3], b[0], b[1], b[2]}, u);
    return {q.x, q.y, q.z, q.w};
  }
  return combine(1 - u, a, u, b);
}

MOTIONLANG_BODY GltfChannel::Value GltfChannel::key(std::size_t k, int part) const {
  const std::size_t at = mode == cubic ? 3 * k + static_cast<std::size_t>(part) : k;
  Value v{};
  std::copy_n(values->begin() + static_cast<std::ptrdiff_t>(at * components), components, v.begin());
  return v;
}

MOTIONLANG_BODY GltfChannel::Value GltfChannel::combine(double s, const Value& a, double t, const Value& b) {
  Value v{};
  for (std::size_t c = 0; c < 4; ++c) v[c] = s * a[c] + t * b[c];
  return v;
}

MOTIONLANG_BODY GltfChannel::Value GltfChannel::hermite(std::size_t k, const Value& a, const Value& b, double span,
                                                        double u) const {
  const double u2 = u * u, u3 = u2 * u;
  const Value tangents = combine(span * (u3 - 2 * u2 + u), key(k, 2), span * (u3 - u2), key(k + 1, 0));
  return combine(1, combine(2 * u3 - 3 * u2 + 1, a, 3 * u2 - 2 * u3, b), 1, tangents);
}

MOTIONLANG_BODY GltfAnimation::GltfAnimation(SharedAccessors& keys, Index number) {
  const GltfDocument& document = keys.document();
  const JsonView animation = document.element("animations", number);
  name_ = animation.value_or("name", concat_text("animation_", number));
  const JsonView samplers = animation["samplers"], channels = animation["channels"];
  for (Index i = 0; i < channels.size(); ++i) {
    const JsonView target = channels[i]["target"];
    if (!target.contains("node")) continue;
    const std::string path = target["path"].as<std::string>();
    const int node = document.node_number(target["node"]);
    if (path != "translation" && path != "rotation" && path != "scale") continue;  // weights: not of a skeleton
    auto& place = path == "rotation" ? rotations_ : path == "scale" ? scales_ : translations_;
    const JsonView sampler = samplers[channels[i]["sampler"].as<Index>()];
    if (!place.emplace(node, channel(keys, sampler, path == "rotation" ? 4 : 3)).second) {
      raise<io_error>(403, target.path(), ": a second channel for the ", path, " of node ", node);
    }
  }
}

MOTIONLANG_BODY std::optional<double> GltfAnimation::rate() const {
  const auto all = lists_of_times();
  if (all.empty()) return std::nullopt;
  const auto fewer = [](const auto* a, const auto* b) { return a->size() < b->size(); };
  const auto most = std::max_element(all.begin(), all.end(), fewer);
  if ((*most)->size() < 2) return std::nullopt;
  const double step = duration_ / static_cast<double>((*most)->size() - 1);
  const auto is_frame =
      [step](double t) {  // times are floats, which late ones round by more than a hundredth of a frame
        constexpr double rounding = std::numeric_limits<float>::epsilon();
        return std::abs(t / step - std::round(t / step)) < std::clamp(rounding * t / step, 0.01, 0.25);
      };
  for (const auto* times : all) {
    if (!std::all_of(times->begin(), times->end(), is_frame)) return std::nullopt;
  }
  const double rate = 1 / step, round = std::round(1000 * rate) / 1000;  // times are floats
  return std::abs(rate - round) <= std::numeric_limits<float>::epsilon() * rate ? round : rate;
}

MOTIONLANG_BODY std::size_t GltfAnimation::keys() const {
  std::size_t sum = 0;
  for (const auto* channels : {&translations_, &rotations_, &scales_}) {
    for (const auto& [node, c] : *channels) sum += c.times->size();
  }
  return sum;
}

MOTIONLANG_BODY GltfTransform GltfAnimation::at(int node, GltfTransform transform, double time) const {
  if (const auto c = translations_.find(node); c != translations_.end()) {
    const auto v = c->second.at(time);
    transform.translation = {v[0], v[1], v[2]};
  }
  if (const auto c = rotations_.find(node); c != rotations_.end()) {
    const auto v = c->second.at(time);
    const Quaternion<double> q{v[3], v[0], v[1], v[2]};
    if (dot(q, q) > 1e-12) transform.rotation = normalized(q);
  }
  return transform;
}

MOTIONLANG_BODY std::set<const std::vector<double>*> GltfAnimation::lists_of_times() const {
  std::set<const std::vector<double>*> out;
  for (const auto* channels : {&translations_, &rotations_, &scales_}) {
    for (const auto& [node, c] : *channels) out.insert(c.times.get());
  }
  return out;
}

MOTIONLANG_BODY bool GltfAnimation::leaves(const std::map<int, GltfChannel>& channels, int node,
                                           const Vec3<double>& rest) {
  const auto c = channels.find(node);
  if (c == channels.end()) return false;
  return std::any_of(c->second.times->begin(), c->second.times->end(), [&](double t) {
    const auto v = c->second.at(t);
    return norm(Vec3<double>{v[0], v[1], v[2]} - rest) > 1e-2 * std::max(norm(rest), 1e-3);
  });
}

MOTIONLANG_BODY GltfChannel GltfAnimation::channel(SharedAccessors& keys, const JsonView& sampler,
                                                   std::size_t components) {
  const std::string mode = sampler.value_or("interpolation", "LINEAR");
  GltfChannel c;
  c.components = components;
  c.mode = mode == "LINEAR" ? GltfChannel::linear : mode == "STEP" ? GltfChannel::step : GltfChannel::cubic;
  if (c.mode == GltfChannel::cubic && mode != "CUBICSPLINE") {
    raise<io_error>(404, sampler.path(), ": interpolation '", mode, "'");
  }
  c.times = keys.values(sampler["input"].as<Index>(), 1);
  c.values = keys.values(sampler["output"].as<Index>(), components);
  const std::vector<double>& t = *c.times;
  const std::size_t expected = t.size() * components * (c.mode == GltfChannel::cubic ? 3 : 1);
  if (t.empty() || c.values->size() != expected) {
    raise<io_error>(403, sampler.path(), ": ", counted(t.size(), "time"), " and ", counted(c.values->size(), "number"),
                    ", expected ", expected);
  }
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (!(t[i] > t[i - 1])) raise<io_error>(403, sampler.path(), ": time ", i, " is not after the one before");
  }
  if (t.front() < 0) raise<io_error>(403, sampler.path(), ": negative time ", t.front());
  duration_ = std::max(duration_, t.back());
  return c;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
