// SPDX-License-Identifier: MIT
/// Names and shapes of a model's tensors, and the means to write down those of a published checkpoint.
#pragma once

#include <map>     // shapes
#include <string>  // names

#include <motionlang/tensor/module.hpp>

#include <doctest/doctest.h>

namespace keys {

namespace ml = motionlang;
using ml::Index, ml::Shape;

/// Shapes of tensors by name; "{8}" in a name stands for 0 ... 7.
struct Keys {
  std::map<std::string, std::string> shapes{};

  void add(const std::string& name, const Shape& shape) {
    const auto brace = name.find('{');
    if (brace == name.npos) {
      CHECK_MESSAGE(shapes.emplace(name, to_string(shape)).second, name);
      return;
    }
    for (int i = 0; i < name[brace + 1] - '0'; ++i)
      add(name.substr(0, brace) + std::to_string(i) + name.substr(brace + 3), shape);
  }
  void linear(const std::string& name, Index out, Index in) {
    add(name + ".weight", {out, in});
    add(name + ".bias", {out});
  }
  void norm(const std::string& name, Index width) {
    add(name + ".weight", {width});
    add(name + ".bias", {width});
  }
  void attention(const std::string& name, Index width) {
    add(name + ".in_proj_weight", {3 * width, width});
    add(name + ".in_proj_bias", {3 * width});
    linear(name + ".out_proj", width, width);
  }
  void transformer(const std::string& layers, Index width, Index d_ff) {
    attention(layers + ".self_attn", width);
    linear(layers + ".linear1", d_ff, width);
    linear(layers + ".linear2", width, d_ff);
    norm(layers + ".norm1", width);
    norm(layers + ".norm2", width);
  }
  void transformer_decoder(const std::string& layers, Index width, Index d_ff) {
    transformer(layers, width, d_ff);
    attention(layers + ".multihead_attn", width);
    norm(layers + ".norm3", width);
  }
};

template <class M>
Keys keys_of(const M& model) {
  Keys keys;
  ml::visit_tensors(model, [&](std::string path, const auto& t) {
    if constexpr (requires { M::official_key(path); }) path = M::official_key(path);
    keys.add(path, t.shape());
  });
  return keys;
}

}  // namespace keys
