// SPDX-License-Identifier: MIT
/// The nonlinearities of networks, by name.
#pragma once

#include <string_view>  // names in configuration files

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     relu(x) = max(x, 0),   gelu(x) = x (1 + erf(x / sqrt 2)) / 2 (the exact form),   silu(x) = x / (1 + exp(-x)),
///     tanh(x),   quick_gelu(x) = x / (1 + exp(-1.702 x)),   gelu_new(x) = x (1 + tanh(sqrt(2 / pi) (x + 0.044715
///                x^3))) / 2,
///     sigmoid(x) = 1 / (1 + exp(-x))
enum class Activation { none, relu, gelu, silu, tanh, quick_gelu, gelu_new, sigmoid };

/// Throws config_error 103.
inline Activation parse_activation(std::string_view name) {
  if (name == "none" || name == "identity") return Activation::none;
  if (name == "relu") return Activation::relu;
  if (name == "gelu") return Activation::gelu;
  if (name == "silu") return Activation::silu;
  if (name == "tanh") return Activation::tanh;
  if (name == "quick_gelu") return Activation::quick_gelu;
  if (name == "gelu_new") return Activation::gelu_new;
  if (name == "sigmoid") return Activation::sigmoid;
  raise<config_error>(103, "activation '", name,
                      "' is not one of none, relu, gelu, silu, tanh, quick_gelu, gelu_new, sigmoid");
}

constexpr std::string_view to_string(Activation a) {
  constexpr std::string_view names[] = {"none", "relu", "gelu", "silu", "tanh", "quick_gelu", "gelu_new", "sigmoid"};
  return names[static_cast<int>(a)];
}

MOTIONLANG_NAMESPACE_END
