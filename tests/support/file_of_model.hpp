// SPDX-License-Identifier: MIT
/// The weights of a model as a file in memory.
#pragma once

#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include <motionlang/weights/module_file.hpp>

namespace models {

namespace ml = motionlang;

/// A file in memory: all tensors of a model, and others.
template <ml::Module M>
ml::SafetensorsFile file_of(const M& model, std::initializer_list<const char*> others = {}) {
  ml::TensorStore store;
  store.add_module(model);
  const std::vector<float> numbers(4);
  for (const char* name : others) store.add<float>(name, {4}, numbers, ml::DType::F32);
  const auto bytes = std::make_shared<std::vector<std::byte>>(ml::safetensors_bytes(store.views()));
  return ml::SafetensorsFile::from_bytes(*bytes, "model.ckpt", bytes);
}

/// A file in memory of tensors of these shapes, all zeros.
inline ml::SafetensorsFile file_of_shapes(std::initializer_list<std::pair<const char*, ml::FileShape>> tensors) {
  ml::TensorStore store;
  for (const auto& [name, shape] : tensors)
    store.add<float>(name, shape, std::vector<float>(static_cast<std::size_t>(shape.count())), ml::DType::F32);
  const auto bytes = std::make_shared<std::vector<std::byte>>(ml::safetensors_bytes(store.views()));
  return ml::SafetensorsFile::from_bytes(*bytes, "model.ckpt", bytes);
}

}  // namespace models
