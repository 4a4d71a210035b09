// SPDX-License-Identifier: MIT
/// Removes animations from a glTF document that is being built, with everything that only they use.
#pragma once

#include <algorithm>         // for_each, max
#include <initializer_list>  // names
#include <set>               // numbers of accessors and views

#include <motionlang/formats/detail/glb_builder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Calls f(object) for every object in a document.
template <class F>
void for_each_object(const nlohmann::ordered_json& document, const F& f) {
  if (document.is_object()) f(document);
  for (const nlohmann::ordered_json& inner : document) {
    if (inner.is_structured()) for_each_object(inner, f);
  }
}

/// All values in members of that name, at any depth: indices of accessors or of views.
inline std::set<double> numbers_under(const nlohmann::ordered_json& document,
                                      std::initializer_list<const char*> names) {
  std::set<double> out;
  const auto add = [&](const nlohmann::ordered_json& value) {
    if (value.is_number()) out.insert(value.get<double>());
  };
  for_each_object(document, [&](const nlohmann::ordered_json& object) {
    for (const char* name : names) {
      if (!object.contains(name)) continue;
      const nlohmann::ordered_json& member = object[name];
      add(member);
      for_each_object(member,
                      [&](const nlohmann::ordered_json& inner) { std::for_each(inner.begin(), inner.end(), add); });
    }
  });
  return out;
}

/// Removes the animations. Also removes their accessors, views and bytes if nothing else uses them and they are the
/// last ones. Everything else keeps its number and its place, because extensions may refer to them. Blender writes
/// animations last.
inline void drop_animations(GlbBuilder& glb) {
  nlohmann::ordered_json& d = glb.document;
  const auto drop_last = [](nlohmann::ordered_json& array, const std::set<double>& dropped,
                            const std::set<double>& used) {
    auto last = [&] { return static_cast<double>(array.size()) - 1; };
    while (!array.empty() && dropped.contains(last()) && !used.contains(last())) array.erase(array.size() - 1);
  };
  const auto of_animations = numbers_under(d["animations"], {"input", "output"});
  d["animations"].clear();
  nlohmann::ordered_json& accessors = d["accessors"];
  const auto views_before = numbers_under(accessors, {"bufferView"});
  drop_last(accessors, of_animations, numbers_under(d, {"attributes", "targets", "indices", "inverseBindMatrices"}));
  drop_last(d["bufferViews"], views_before, numbers_under(d, {"bufferView"}));

  double end = 0;  // of the bytes that something refers to
  for_each_object(d, [&](const nlohmann::ordered_json& object) {
    const auto number = [&](const char* name) {
      return object.contains(name) && object[name].is_number() ? object[name].get<double>() : 0;
    };
    if (object.contains("buffer") && number("buffer") == 0)
      end = std::max(end, number("byteOffset") + number("byteLength"));
  });
  if (end < 0x1p53) glb.cut(static_cast<std::size_t>(end));
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
