// SPDX-License-Identifier: MIT
/// Member lists: what a module is made of, and how to walk over it.
///
///     struct Linear {
///       Tensor<B, 2> weight;
///       Tensor<B, 1> bias;
///       static constexpr auto fields() { return motionlang::fields("weight", &Linear::weight, "bias", &Linear::bias);
///       }
///     };
///     visit(model, [](const std::string& path, auto& tensor) { ... });   // "layers.0.linear1.weight"
///
/// A member may be a leaf (a tensor), a module, or a vector or optional of either. Vector elements are numbered. A name
/// may contain dots ("tx_embedding.0") where the official key has a level that is no module here, and be empty where
/// the fields of a member have no level of their own (the statistics of a BatchNorm).
#pragma once

#include <optional>     // members that a model may lack
#include <string>       // paths
#include <string_view>  // names
#include <vector>       // repeated members

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <class M, class T>
struct Field {
  const char* name;
  T M::*member;
};

/// The fields of a module, first and rest; `NoFields` ends the list. (A std::tuple compiles several times slower.)
struct NoFields {};
template <class First, class Rest>
struct FieldList {
  First first;
  Rest rest;
};

/// Pairs (name, pointer to member) to a list of `Field`.
constexpr NoFields fields() { return {}; }
template <class M, class T, class... Others>
constexpr auto fields(const char* name, T M::*member, Others... others) {
  return FieldList<Field<M, T>, decltype(fields(others...))>{{name, member}, fields(others...)};
}

namespace detail {

template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

inline std::string join_path(const std::string& prefix, std::string_view name) {
  std::string path = prefix;
  if (!path.empty() && !name.empty()) path += '.';
  return path += name;
}

template <class F, class... Objects>
void visit_fields(const std::string& prefix, F& f, Objects&... objects);

/// Walks over one member, or over the same member of several objects of the same structure.
template <class F, class First, class... Others>
void visit_member(const std::string& path, F& f, First& first, Others&... others) {
  using T = std::remove_const_t<First>;
  if constexpr (Module<T>) {
    visit_fields(path, f, first, others...);
  } else if constexpr (is_vector<T>) {
    if (((others.size() != first.size()) || ...)) {
      raise<shape_error>(204, "zip: numbers of ", path, " differ: ", Index(first.size()), ", ",
                         Index(others.size())...);
    }
    for (std::size_t i = 0; i < first.size(); ++i)
      visit_member(join_path(path, std::to_string(i)), f, first[i], others[i]...);
  } else if constexpr (is_optional<T>) {
    if (((others.has_value() != first.has_value()) || ...)) raise<shape_error>(204, "zip: only one side has ", path);
    if (first) visit_member(path, f, *first, (*others)...);
  } else {
    f(path, first, others...);
  }
}

/// An object and those of its fields that are still to be walked over.
template <class List, class Object>
struct Walk {
  List list;
  Object& object;
  auto& member() const { return object.*(list.first.member); }
  auto rest() const { return Walk<decltype(list.rest), Object>{list.rest, object}; }
};
template <class Object>
auto walk(Object& object) {
  return Walk<decltype(Object::fields()), Object>{Object::fields(), object};
}

/// Calls f(name, member of first, members of others...) for all fields. The others may be the same template over
/// another backend: fields are matched by position.
template <class F, class First, class... Walks>
void each_field(F& f, const First& first, const Walks&... others) {
  if constexpr (!std::is_same_v<decltype(first.list), NoFields>) {
    f(first.list.first.name, first.member(), others.member()...);
    each_field(f, first.rest(), others.rest()...);
  }
}

template <class F, class First, class... Walks>
void visit_walks(const std::string& prefix, F& f, const First& first, const Walks&... others) {
  if constexpr (!std::is_same_v<decltype(first.list), NoFields>) {
    visit_member(join_path(prefix, first.list.first.name), f, first.member(), others.member()...);
    visit_walks(prefix, f, first.rest(), others.rest()...);
  }
}
template <class F, class... Objects>
void visit_fields(const std::string& prefix, F& f, Objects&... objects) {
  visit_walks(prefix, f, walk(objects)...);
}

}  // namespace detail

/// Calls f(path, leaf) for every leaf below the module, in the order of the fields.
template <class M, class F>
requires Module<std::remove_const_t<M>>
void visit(M& module, F f) { detail::visit_fields("", f, module); }

/// Calls f(path, leaf of a, leaf of b) for two modules of the same structure, perhaps over different backends.
template <class M, class N, class F>
requires Module<std::remove_const_t<M>> && Module<std::remove_const_t<N>>
void zip(M& a, N& b, F f) { detail::visit_fields("", f, a, b); }

/// Number of leaves.
template <Module M>
Index count_leaves(const M& module) {
  Index n = 0;
  visit(module, [&](const std::string&, const auto&) { ++n; });
  return n;
}

MOTIONLANG_NAMESPACE_END
