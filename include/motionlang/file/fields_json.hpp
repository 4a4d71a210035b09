// SPDX-License-Identifier: MIT
/// Converts structs that list their fields (core/fields.hpp) to JSON and back: the hyperparameters of a training.
///
///     struct Rate {
///       double lr = 1e-4;
///       static constexpr auto fields() { return motionlang::fields("lr", &Rate::lr); }
///     };
///     Rate rate;
///     set_config(rate, "lr=3e-4");                       // or read_config(rate, JsonView(document, "config.json"))
///     const auto document = config_json(rate);           // {"lr":0.0003}
///
/// Every error gives the path of the field.
#pragma once

#include <algorithm>  // find
#include <map>        // leaves
#include <string>     // names
#include <vector>     // names

#include <motionlang/core/fields.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/file/key_report.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

struct ConfigWriter {
  nlohmann::ordered_json& out;
  template <class T>
  void operator()(const char* name, const T& member) const;
};
struct ConfigReader {
  const JsonView& view;
  template <class T>
  void operator()(const char* name, T& member) const;
};
struct NameCollector {
  std::vector<std::string>& names;
  template <class T>
  void operator()(const char* name, const T&) const {
    names.emplace_back(name);
  }
};

/// Throws config_error 103 for a member of the document whose name is not in `known`, with the most similar name.
void require_known_members(const JsonView& view, const std::vector<std::string>& known);

/// Throws what config.require_sound() throws, with the place in front.
template <class C>
void require_sound_at(const C& config, const std::string& place) {
  guard<config_error>([&] { config.require_sound(); },
                      [&](const config_error& e) -> bool {
                        const std::string_view message = e.what();
                        raise<config_error>(e.id(), place, ": ", message.substr(message.find("] ") + 2));
                      });
}

/// "losses.kl=1e-4" as the document {"losses": {"kl": 1e-4}}. Messages contain `name`. Throws config_error 103 without
/// "=".
nlohmann::json assignment_json(const std::string& assignment, const std::string& name);

/// All leaves of a document, by their paths.
std::map<std::string, std::string> leaf_texts(const nlohmann::ordered_json& document);

}  // namespace detail

/// Members in the order of the fields.
template <Module C>
nlohmann::ordered_json config_json(const C& config) {
  auto out = nlohmann::ordered_json::object();
  detail::ConfigWriter write{out};
  detail::each_field(write, detail::walk(config));
  return out;
}

/// Members of the document replace those of `config`; the others stay.
/// Throws  config_error 103 for a name that is not a member, with the most similar one; 107 for a value of the wrong
///         kind; what config.require_sound() throws, if there is such a function. All begin with the path.
template <Module C>
void read_config(C& config, const JsonView& view) {
  std::vector<std::string> known;
  detail::NameCollector collect{known};
  detail::each_field(collect, detail::walk(config));
  detail::require_known_members(view, known);
  detail::ConfigReader read{view};
  detail::each_field(read, detail::walk(config));
  if constexpr (requires { config.require_sound(); }) detail::require_sound_at(config, view.path());
}

/// Sets one field: "losses.kl=1e-4" or "features=rifke". The value is JSON, or otherwise a text. Messages contain
/// `name`. Throws config_error 103 without "=", and as read_config.
template <Module C>
void set_config(C& config, const std::string& assignment, const std::string& name) {
  const nlohmann::json document = detail::assignment_json(assignment, name);
  read_config(config, JsonView(document, name));
}
template <Module C>
void set_config(C& config, const std::string& assignment) {
  set_config(config, assignment, assignment);
}

/// All leaves as texts, "losses.kl" -> "1e-05". A checkpoint stores them to compare them when it is resumed.
template <Module C>
std::map<std::string, std::string> config_texts(const C& config) {
  return detail::leaf_texts(config_json(config));
}

namespace detail {

template <class T>
void ConfigWriter::operator()(const char* name, const T& member) const {
  if constexpr (Module<T>)
    out[name] = config_json(member);
  else
    out[name] = member;
}
template <class T>
void ConfigReader::operator()(const char* name, T& member) const {
  if (!view.contains(name)) return;
  if constexpr (Module<T>)
    read_config(member, view[name]);
  else
    member = view[name].template as<T>();
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/fields_json.ipp>
#endif
