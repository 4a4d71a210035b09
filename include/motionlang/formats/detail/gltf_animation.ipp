// SPDX-License-Identifier: MIT
// Bodies of gltf_animation.hpp.
#pragma once

#include <algorithm>  // all_of, clamp, sort
#include <cmath>      // round
#include <limits>     // precision of a float
#include <numeric>    // iota
#include <set>        // lists of times

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

MOTIONLANG_BODY std::optional<Vec3<double>> GltfChannel::constant() const {
  const auto vector = [](const Value& v) { return Vec3<double>{v[0], v[1], v[2]}; };
  const Vec3<double> first = vector(key(0));
  const double tolerance = 1e-3 * std::max(norm(first), 1e-3);
  for (std::size_t k = 0; k < times->size(); ++k) {
    if (!(norm(vector(key(k)) - first) <= tolerance)) return std::nullopt;
    for (const int tangent : {0, 2}) {
      if (mode == cubic && norm(vector(key(k, tangent))) > tolerance) return std::nullopt;
    }
  }
  return first;
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
    if (!place.emplace(node, channel(keys, sampler, path == "rotation" ? 4 : 3)).second)
      repair(concat_text("has several channels for the ", path, " of '", document.node(node).name,
                         "': the first of them counts"));
  }
  begin_at_0();
}

/// Finds the frame rate of keys.
class KeyGrid {
 public:
  using Times = const std::vector<double>*;

  explicit KeyGrid(std::vector<Times> lists) : lists_(std::move(lists)) {
    for (const Times t : lists_) {
      if (most_ == nullptr || t->size() > most_->size()) most_ = t;
      first_ = std::min(first_, t->front());
      last_ = std::max(last_, t->back());
    }
  }

  /// Seconds of a frame if the list with most keys has one in each.
  std::optional<double> dense_step() const {
    if (most_->size() < 2) return std::nullopt;
    const double step = (most_->back() - most_->front()) / static_cast<double>(most_->size() - 1);
    return fits(step) ? std::optional(step) : std::nullopt;
  }
  /// Seconds of a frame if no list has a key in each: the shortest time between two keys is one or a few frames.
  std::optional<double> sparse_step() const {
    std::vector<double> all;
    for (const Times t : lists_) all.insert(all.end(), t->begin(), t->end());
    std::sort(all.begin(), all.end());
    double shortest = last_ - first_;
    for (std::size_t i = 1; i < all.size(); ++i) {
      const double gap = all[i] - all[i - 1];
      if (gap > std::max(1e-4, 8 * rounding * all[i])) shortest = std::min(shortest, gap);
    }
    for (int frames = 1; frames <= 8 && shortest / frames > 1e-3; ++frames) {
      double step = shortest / frames;
      for (const double t : all) {  // later keys give the length of a frame more exactly
        const double n = std::round((t - first_) / step);
        if (n > 0 && std::abs(t - first_ - n * step) < 0.25 * step) step = (t - first_) / n;
      }
      if (fits(step)) return step;
    }
    return std::nullopt;
  }
  /// Keys per second without the rounding of times, which are floats.
  double rate(double step) const {
    const double rate = 1 / step, round = std::round(1000 * rate) / 1000;
    return std::abs(rate - round) <= rounding * rate * last_ / (last_ - first_) ? round : rate;
  }
  /// The median time between two keys of the longest list.
  double usual() const {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < most_->size(); ++i) {
      if ((*most_)[i] > (*most_)[i - 1]) gaps.push_back((*most_)[i] - (*most_)[i - 1]);
    }
    if (gaps.empty()) return 0;
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), middle, gaps.end());
    return *middle;
  }
  double first() const { return first_; }
  double last() const { return last_; }

 private:
  static constexpr double rounding = std::numeric_limits<float>::epsilon();

  bool fits(double step) const {
    if (!(step > 0)) return false;
    const auto is_frame = [&](double t) {  // late times are rounded by more than a hundredth of a frame
      const double frame = (t - first_) / step;
      return std::abs(frame - std::round(frame)) < std::clamp(rounding * t / step, 0.01, 0.25);
    };
    return std::all_of(lists_.begin(), lists_.end(),
                       [&](Times times) { return std::all_of(times->begin(), times->end(), is_frame); });
  }

  std::vector<Times> lists_;
  Times most_ = nullptr;
  double first_ = std::numeric_limits<double>::infinity(), last_ = 0;
};

MOTIONLANG_BODY GltfTiming GltfAnimation::timing(std::span<const int> nodes) const {
  GltfTiming out;
  std::set<const std::vector<double>*> moving, all;  // channels may share them: count each once
  for (const Channels* channels : {&translations_, &rotations_, &scales_}) {
    for (const auto& [node, c] : *channels) {
      if (!std::binary_search(nodes.begin(), nodes.end(), node)) continue;
      out.keys += c.times->size();
      all.insert(c.times.get());
      if (c.times->size() > 2 || !c.constant()) moving.insert(c.times.get());  // a constant pose has any two times
      if (c.mode == GltfChannel::cubic && !c.constant()) out.cubic = true;
    }
  }
  if (all.empty()) return out;
  const KeyGrid every({all.begin(), all.end()}),
      grid(moving.empty() ? std::vector(all.begin(), all.end()) : std::vector(moving.begin(), moving.end()));
  out.first = every.first();
  out.last = every.last();
  out.usual = grid.usual();
  auto step = grid.dense_step();
  out.dense = step.has_value();
  if (!step) step = grid.sparse_step();
  if (step) out.rate = grid.rate(*step);
  return out;
}

MOTIONLANG_BODY bool GltfAnimation::moves(int node, const GltfTransform& rest) const {
  if (moves_away(node, rest.translation) || grows(node, rest.scale)) return true;
  const auto c = rotations_.find(node);
  if (c == rotations_.end()) return false;
  constexpr double half_a_degree = 0.9999905;  // cosine of a quarter of a degree: of half the angle
  return std::any_of(c->second.times->begin(), c->second.times->end(), [&](double t) {
    return std::abs(dot(at(node, rest, t).rotation, rest.rotation)) < half_a_degree;
  });
}

MOTIONLANG_BODY GltfTransform GltfAnimation::at(int node, const GltfTransform& rest, double time) const {
  GltfTransform out = rest;
  if (const auto c = translations_.find(node); c != translations_.end()) {
    const auto v = c->second.at(time);
    out.translation = {v[0], v[1], v[2]};
  }
  if (const auto c = rotations_.find(node); c != rotations_.end()) {
    const auto v = c->second.at(time);
    const Quaternion<double> q{v[3], v[0], v[1], v[2]};
    if (const double squared = dot(q, q); squared > 1e-12 && squared < 1e100) out.rotation = normalized(q);
    out.sheared.reset();
  }
  if (const auto c = scales_.find(node); c != scales_.end()) {
    const auto v = c->second.at(time);
    out.scale = {v[0], v[1], v[2]};
    out.sheared.reset();
  }
  return out;
}

MOTIONLANG_BODY GltfTransform GltfAnimation::rest(int node, GltfTransform rest) const {
  const auto keep = [&](const Channels& channels, Vec3<double>& value) {
    const auto c = channels.find(node);
    if (c == channels.end()) return;
    const auto all_the_time = c->second.constant();
    if (all_the_time && differs(*all_the_time, value)) value = *all_the_time;
  };
  keep(translations_, rest.translation);
  keep(scales_, rest.scale);
  if (scales_.contains(node) || rotations_.contains(node)) rest.sheared.reset();
  return rest;
}

MOTIONLANG_BODY bool GltfAnimation::differs(const Vec3<double>& v, const Vec3<double>& rest) {
  return norm(v - rest) > 1e-2 * std::max(norm(rest), 1e-3);
}

MOTIONLANG_BODY bool GltfAnimation::leaves(const Channels& channels, int node, const Vec3<double>& rest) {
  const auto c = channels.find(node);
  if (c == channels.end()) return false;
  return std::any_of(c->second.times->begin(), c->second.times->end(), [&](double t) {
    const auto v = c->second.at(t);
    return differs({v[0], v[1], v[2]}, rest);
  });
}

MOTIONLANG_BODY void GltfAnimation::repair(const std::string& sentence) {
  if (std::find(repairs_.begin(), repairs_.end(), sentence) == repairs_.end()) repairs_.push_back(sentence);
}

MOTIONLANG_BODY void GltfAnimation::sort_keys(GltfChannel& c) {
  const std::size_t width = c.components * (c.mode == GltfChannel::cubic ? 3 : 1);
  std::vector<std::size_t> order(c.times->size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return (*c.times)[a] < (*c.times)[b]; });
  std::vector<double> times, values;
  for (const std::size_t k : order) {
    times.push_back((*c.times)[k]);
    const auto from = c.values->begin() + static_cast<std::ptrdiff_t>(k * width);
    values.insert(values.end(), from, from + static_cast<std::ptrdiff_t>(width));
  }
  c.times = std::make_shared<const std::vector<double>>(std::move(times));
  c.values = std::make_shared<const std::vector<double>>(std::move(values));
}

MOTIONLANG_BODY void GltfAnimation::begin_at_0() {
  double first = 0;
  for (const Channels* channels : {&translations_, &rotations_, &scales_}) {
    for (const auto& [node, c] : *channels) first = std::min(first, c.times->front());
  }
  if (first >= 0) return;
  repair(
      concat_text("begins at ", std::round(1e6 * first) / 1e6, " s: all its keys are moved so that it begins at 0 s"));
  std::map<const std::vector<double>*, GltfChannel::Values> moved;
  for (Channels* channels : {&translations_, &rotations_, &scales_}) {
    for (auto& [node, c] : *channels) {
      GltfChannel::Values& times = moved[c.times.get()];
      if (times == nullptr) {
        std::vector<double> later = *c.times;
        for (double& t : later) t -= first;
        times = std::make_shared<const std::vector<double>>(std::move(later));
      }
    }
  }
  for (Channels* channels : {&translations_, &rotations_, &scales_}) {
    for (auto& [node, c] : *channels) c.times = moved[c.times.get()];
  }
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
  const std::size_t width = components * (c.mode == GltfChannel::cubic ? 3 : 1), expected = c.times->size() * width,
                    whole = std::min(c.times->size(), c.values->size() / width);
  if (whole == 0)
    raise<io_error>(403, sampler.path(), ": ", counted(c.times->size(), "time"), " and ",
                    counted(c.values->size(), "number"), ", expected ", expected);
  if (c.values->size() != expected) {
    repair(concat_text("has ", counted(c.times->size(), "time"), " for ", counted(c.values->size() / width, "key"),
                       ": the first of them count"));
    c.times = std::make_shared<const std::vector<double>>(c.times->begin(),
                                                          c.times->begin() + static_cast<std::ptrdiff_t>(whole));
  }
  const std::vector<double>& t = *c.times;
  bool equal = false, sorted = true;
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (t[i] == t[i - 1]) equal = true;
    if (t[i] < t[i - 1]) sorted = false;
  }
  if (equal) repair("has several keys at one time: the last of them counts");
  if (!sorted) {
    repair("has keys that are not in the order of their times: they are sorted");
    sort_keys(c);
  }
  return c;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
