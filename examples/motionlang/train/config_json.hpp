// Structs that list their fields (core/fields.hpp), from and to JSON: the hyperparameters of a training run.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <motionlang/core/fields.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/file/key_report.hpp>

#include "../usage_error.hpp"

namespace program {

namespace ml = motionlang;

namespace detail {

struct ConfigWriter {
  nlohmann::ordered_json& out;
  template <class T>
  void operator()(const char* name, const T& member) const;
};
struct ConfigReader {
  const ml::JsonView& view;
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

}  // namespace detail

/// Members in the order of the fields.
template <ml::Module C>
nlohmann::ordered_json config_json(const C& config) {
  auto out = nlohmann::ordered_json::object();
  detail::ConfigWriter write{out};
  ml::detail::each_field(write, ml::detail::walk(config));
  return out;
}

/// Throws config_error 101 unless `good`: "lr is -1, expected 0 or more".
template <class T>
void require_value(const char* name, T value, bool good, const char* expected) {
  if (!good) ml::raise<ml::config_error>(101, name, " is ", value, ", expected ", expected);
}
/// The sizes that every network has.
template <class Network>
void require_sizes(const Network& n) {
  for (const auto& [name, size] :
       {std::pair("latent_dim", n.latent_dim), {"ff_size", n.ff_size}, {"num_heads", n.num_heads}})
    require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
  require_value("num_layers", n.num_layers, n.num_layers >= 1 && n.num_layers <= 256, "1 to 256");
  require_value("dropout", n.dropout, n.dropout >= 0 && n.dropout < 1, "0 or more, and less than 1");
}

/// Throws what config.require_sound() throws, with the place in front.
template <class C>
void require_sound(const C& config, const std::string& place) {
  try {
    config.require_sound();
  } catch (const ml::config_error& e) {
    const std::string_view message = e.what();
    ml::raise<ml::config_error>(e.id(), place, ": ", message.substr(message.find("] ") + 2));
  }
}

/// Members that the document has replace those of `config`; others stay. Throws config_error 103 for a name that is no
/// member, with the one that is most like it; 107 for a value of the wrong kind; 101 for a number that means nothing.
template <ml::Module C>
void read_config(C& config, const ml::JsonView& view) {
  std::vector<std::string> known;
  detail::NameCollector collect{known};
  ml::detail::each_field(collect, ml::detail::walk(config));
  for (const std::string& name : view.keys()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string like = ml::nearest_name(name, known);
    ml::raise<ml::config_error>(103, view.path(), ": has no member '", name, "'; ",
                                like.empty() ? "there are " + ml::join_text(known) : "did you mean '" + like + "'?");
  }
  detail::ConfigReader read{view};
  ml::detail::each_field(read, ml::detail::walk(config));
  if constexpr (requires { config.require_sound(); }) require_sound(config, view.path());
}

namespace detail {

template <class T>
void ConfigWriter::operator()(const char* name, const T& member) const {
  if constexpr (ml::Module<T>)
    out[name] = config_json(member);
  else
    out[name] = member;
}
template <class T>
void ConfigReader::operator()(const char* name, T& member) const {
  if (!view.contains(name)) return;
  if constexpr (ml::Module<T>)
    read_config(member, view[name]);
  else
    member = view[name].template as<T>();
}

}  // namespace detail

/// `assignments` are "losses.kl=1e-4", "features=rifke", ...: JSON values, or texts where they are none.
template <ml::Module C>
void set_config(C& config, const std::vector<std::string>& assignments) {
  for (const std::string& a : assignments) {
    const std::size_t equals = a.find('=');
    if (equals == a.npos) ml::raise<usage_error>(103, "--set ", a, ": expected name=value");
    nlohmann::json value = nlohmann::json::parse(a.substr(equals + 1), nullptr, /*allow_exceptions=*/false);
    if (value.is_discarded()) value = a.substr(equals + 1);
    std::string path = a.substr(0, equals);
    for (std::size_t dot; (dot = path.rfind('.')) != path.npos; path.resize(dot))
      value = nlohmann::json::object({{path.substr(dot + 1), value}});
    const nlohmann::json document = nlohmann::json::object({{path, value}});
    read_config(config, ml::JsonView(document, "--set " + a));
  }
}

/// Every leaf as a text, "losses.kl" -> "1e-05": what a checkpoint keeps, to be compared when it is resumed.
template <ml::Module C>
std::map<std::string, std::string> config_texts(const C& config) {
  std::map<std::string, std::string> out;
  const auto flat = nlohmann::json(config_json(config)).flatten();
  for (const auto& [pointer, value] : flat.items()) {
    std::string name = pointer.substr(1);
    std::replace(name.begin(), name.end(), '/', '.');
    out[name] = value.is_string() ? value.template get<std::string>() : value.dump();
  }
  return out;
}

}  // namespace program
