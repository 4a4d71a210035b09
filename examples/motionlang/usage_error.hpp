// The error for a command line that this program or this model cannot execute.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <motionlang/core/option_error.hpp>

namespace program {

/// Exit code 2, as for a command line that cannot be read.
using usage_error = motionlang::option_error;

/// A message of the library in the words of the command line: `text_encoder`, a field of some options, becomes
/// --text-encoder.
inline std::string with_options(std::string message) {
  constexpr std::pair<std::string_view, std::string_view> others[] = {{"validation", "babel-validation"},
                                                                      {"regressor", "joint-regressor"},
                                                                      {"layers", "bert-layer"},
                                                                      {"noise_scale", "noise-factor"}};
  for (std::size_t at = 0; (at = message.find('`', at)) != message.npos;) {
    const std::size_t end = message.find('`', at + 1);
    if (end == message.npos) break;
    std::string name = message.substr(at + 1, end - at - 1);
    for (const auto& [field, option] : others) {
      if (name == field) name = option;
    }
    for (char& c : name) c = c == '_' ? '-' : c;
    message.replace(at, end + 1 - at, "--" + name);
    at += name.size() + 2;
  }
  return message;
}

/// Calls f. A config_error of the library becomes one about the command line.
template <class F>
auto as_usage(F f) {
  try {
    return f();
  } catch (const motionlang::config_error& e) {
    throw usage_error(e.id(), e.what());
  }
}
/// Calls f. A config_error of the library becomes one about an option: its message starts with `begin`, such as
/// "--temos ".
/// Error  the type to throw: usage_error has another exit code
template <class Error = motionlang::config_error, class F>
auto of_option(const std::string& begin, F f) {
  try {
    return f();
  } catch (const motionlang::config_error& e) {
    const std::string_view message = e.what();
    motionlang::raise<Error>(e.id(), begin, message.substr(message.find("] ") + 2));
  }
}
/// The preset with this name.
template <class F>
auto named_preset(F preset) {
  return of_option<usage_error>("--", preset);
}

}  // namespace program
