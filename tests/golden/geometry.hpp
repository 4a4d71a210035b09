// Tensors of golden cases as lists of vectors, quaternions and matrices, and back.
#pragma once

#include <motionlang/geometry/quaternion.hpp>
#include <motionlang/geometry/rotation6d.hpp>

#include "../support/lists.hpp"
#include "golden.hpp"

namespace golden {

using lists::view;

template <class S>
using Vectors = std::vector<ml::Vec3<S>>;
template <class S>
using Quaternions = std::vector<ml::Quaternion<S>>;

// Tensors as lists of vectors and quaternions, and back.
template <class S>
Vectors<S> vectors(const Case& c, const std::string& name) {
  const auto values = c.values<S>("in/" + name);
  Vectors<S> out;
  for (std::size_t i = 0; i < values.size(); i += 3) out.push_back({values[i], values[i + 1], values[i + 2]});
  return out;
}
template <class S>
Quaternions<S> quaternions(const Case& c, const std::string& name) {
  const auto values = c.values<S>("in/" + name);
  Quaternions<S> out;
  for (std::size_t i = 0; i < values.size(); i += 4) {
    out.push_back({values[i], values[i + 1], values[i + 2], values[i + 3]});
  }
  return out;
}
template <class S>
std::vector<ml::Matrix3<S>> matrices(const Case& c, const std::string& name) {
  const auto values = c.values<S>("in/" + name);
  std::vector<ml::Matrix3<S>> out(values.size() / 9);
  for (std::size_t i = 0; i < values.size(); ++i) out[i / 9].m[i % 9] = values[i];
  return out;
}

template <class S>
void append(std::vector<S>& out, const ml::Vec3<S>& v) {
  out.insert(out.end(), {v.x, v.y, v.z});
}
template <class S>
void append(std::vector<S>& out, const ml::Quaternion<S>& q) {
  out.insert(out.end(), {q.w, q.x, q.y, q.z});
}
template <class S>
void append(std::vector<S>& out, const ml::Matrix3<S>& m) {
  out.insert(out.end(), m.m.begin(), m.m.end());
}
template <class S>
void append(std::vector<S>& out, const ml::Rotation6dColumns<S>& r) {
  append(out, r.a), append(out, r.b);
}
template <class S>
void append(std::vector<S>& out, const ml::Rotation6dRows<S>& r) {
  append(out, r.a), append(out, r.b);
}
/// Hands over f(0), f(1), ..., f(count - 1) in the shape that the case has.
template <class S, class F>
void out_each(Case& c, const std::string& name, std::size_t count, F f) {
  if (!c.wants(name)) return;
  std::vector<S> flat;
  for (std::size_t i = 0; i < count; ++i) append(flat, f(i));
  c.out(name, c.shape("out/" + name), flat);
}
template <class S, class T>
void out_list(Case& c, const std::string& name, const std::vector<T>& list) {
  out_each<S>(c, name, list.size(), [&](std::size_t i) { return list[i]; });
}

}  // namespace golden
