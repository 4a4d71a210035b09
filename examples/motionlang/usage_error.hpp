// A command line that asks for what this program or this model cannot do.
#pragma once

#include <string>
#include <string_view>

#include <motionlang/core/error.hpp>

namespace program {

/// Exit code 2, as for a command line that cannot be read.
struct usage_error : motionlang::config_error {
  using config_error::config_error;
};

/// Calls f. A config_error of the library is about the command line here.
template <class F>
auto as_usage(F f) {
  try {
    return f();
  } catch (const motionlang::config_error& e) {
    throw usage_error(e.id(), e.what());
  }
}
/// The preset of a name: an error says which option was wrong.
template <class F>
auto named_preset(F preset) {
  try {
    return preset();
  } catch (const motionlang::config_error& e) {
    const std::string_view message = e.what();
    motionlang::raise<usage_error>(e.id(), "--", message.substr(message.find("] ") + 2));
  }
}

}  // namespace program
