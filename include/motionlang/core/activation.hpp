// SPDX-License-Identifier: MIT
/// The nonlinearities of transformer blocks, by name.
#pragma once

#include <string_view>  // names in configuration files

#include <motionlang/core/error.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

///     relu(x) = max(x, 0),   gelu(x) = x (1 + erf(x / sqrt 2)) / 2 (the exact form),   silu(x) = x / (1 + exp(-x)),
///     tanh(x)
enum class Activation { none, relu, gelu, silu, tanh };

/// Throws config_error 103.
inline Activation parse_activation(std::string_view name) {
  if (name == "none" || name == "identity") return Activation::none;
  if (name == "relu") return Activation::relu;
  if (name == "gelu") return Activation::gelu;
  if (name == "silu") return Activation::silu;
  if (name == "tanh") return Activation::tanh;
  raise<config_error>(103, "activation '", name, "' is none of none, relu, gelu, silu, tanh");
}

constexpr std::string_view to_string(Activation a) {
  constexpr std::string_view names[] = {"none", "relu", "gelu", "silu", "tanh"};
  return names[static_cast<int>(a)];
}

}  // namespace motionlang::inline MOTIONLANG_ABI
