// SPDX-License-Identifier: MIT
/// Member lists: the parts of a module, and walks over them.
///
///     struct Model {
///       Tensor<B, 2> weight;
///       Tensor<B, 1> bias;
///       static constexpr auto fields() { return motionlang::fields("weight", &Model::weight, "bias", &Model::bias); }
///     };
///     Model model;
///     visit(model, [](const std::string& path, auto& tensor) { use(path, tensor); });   // "layers.0.linear1.weight"
///
/// A member may be a leaf (a tensor), a module, or a vector or optional of either. Vector elements are numbered. A name
/// may contain dots ("tx_embedding.0") where the official key has a level that is not a module here. It may be empty
/// where the fields of a member have no level of their own (the statistics of a BatchNorm). Two members of one name are
/// a compile error, unless both are optional. A member with nothing to save is an option: a number, an enumeration, a
/// text, or a type that says so (is_option, tensor/module.hpp).
#pragma once

#include <optional>     // members that a model may lack
#include <string>       // paths
#include <string_view>  // names
#include <type_traits>  // bool_constant
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

/// True if a list has a member of this name. Two optional members may share a name if only one is there.
template <bool optional, class M, class T, class Rest>
constexpr bool has_name(const FieldList<Field<M, T>, Rest>& list, std::string_view name);
template <bool optional>
constexpr bool has_name(const NoFields&, std::string_view) {
  return false;
}
template <bool optional, class M, class T, class Rest>
constexpr bool has_name(const FieldList<Field<M, T>, Rest>& list, std::string_view name) {
  return (list.first.name == name && !(optional && is_optional<T>)) || has_name<optional>(list.rest, name);
}
/// The first name that occurs twice, "" if there is none. (Several members may have no level of their own.)
constexpr std::string_view repeated_name(const NoFields&) { return {}; }
template <class M, class T, class Rest>
constexpr std::string_view repeated_name(const FieldList<Field<M, T>, Rest>& list) {
  const std::string_view name = list.first.name;
  return !name.empty() && has_name<is_optional<T>>(list.rest, name) ? name : repeated_name(list.rest);
}
/// True if the compiler can look at the names of a module.
template <class M>
concept ConstantFields = requires {
  typename std::bool_constant<(static_cast<void>(M::fields()), true)>;
};
/// Two members of one name would share what is stored by name: a place in a file, the moments of an optimiser. This is
/// a compile error where fields() is constexpr, else config_error 102.
template <Module M>
void check_names() {
  if constexpr (ConstantFields<M>) {
    static_assert(repeated_name(M::fields()).empty(),
                  "motionlang: fields() of a module lists two members by the same name");
  } else if (const std::string_view name = repeated_name(M::fields()); !name.empty()) {
    raise<config_error>(102, "fields() of a module lists two members by the name '", name, "'");
  }
}

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

/// An object and its remaining fields.
template <class List, class Object>
struct Walk {
  List list;
  Object& object;
  auto& member() const { return object.*(list.first.member); }
  auto rest() const { return Walk<decltype(list.rest), Object>{list.rest, object}; }
};
template <class Object>
auto walk(Object& object) {
  check_names<std::remove_const_t<Object>>();
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

namespace detail {

/// A variable whose address differs for every type.
template <class M>
inline constexpr char type_place = 0;

/// True if one module is inside another, and its path from there.
template <Module M>
bool find_module(const M& around, const void* module, const void* type, std::string& path);
template <class T>
bool find_module_in(const T& member, const std::string& name, const void* module, const void* type, std::string& path) {
  if constexpr (Module<T>) {
    if (&member == module && &type_place<T> == type) {
      path = name;
      return true;
    }
    if (!find_module(member, module, type, path)) return false;
    path = join_path(name, path);
    return true;
  } else if constexpr (is_vector<T>) {
    for (std::size_t i = 0; i < member.size(); ++i) {
      if (find_module_in(member[i], join_path(name, std::to_string(i)), module, type, path)) return true;
    }
  } else if constexpr (is_optional<T>) {
    return member && find_module_in(*member, name, module, type, path);
  }
  return false;
}
template <Module M>
bool find_module(const M& around, const void* module, const void* type, std::string& path) {
  bool found = false;
  auto look = [&](const char* name, const auto& member) {
    found = found || find_module_in(member, name, module, type, path);
  };
  each_field(look, walk(around));
  return found;
}

template <class M>
struct StepInto {
  static ModuleStep step(const M& module) {
    return {.name = {}, .module = &module, .type = &type_place<M>, .path_to = &path_to};
  }
  static std::string path_to(const void* around, const void* module, const void* type) {
    std::string path;
    find_module(*static_cast<const M*>(around), module, type, path);
    return path;
  }
};

}  // namespace detail

/// Number of leaves.
template <Module M>
Index count_leaves(const M& module) {
  Index n = 0;
  visit(module, [&](const std::string&, const auto&) { ++n; });
  return n;
}

MOTIONLANG_NAMESPACE_END
