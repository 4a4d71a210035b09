// SPDX-License-Identifier: MIT
// Bodies of safetensors_copy.hpp.
#pragma once

#include <map>  // metadata

#include <motionlang/core/utf8.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/safetensors_copy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void write_safetensors_copy(const FilePath& path, const WeightFile& weights,
                                            std::optional<DType> stored) {
  std::map<std::string, std::string> metadata;
  for (const FileValue& v : weights.values()) {
    if (is_utf8(v.path)) metadata[v.path] = to_string(v);
  }
  metadata.try_emplace("format", "pt");
  TensorStore store;
  std::vector<TensorView> tensors;
  for (const TensorView& t : weights.tensors()) {
    if (stored && t.dtype >= DType::F16 && t.dtype <= DType::F64)
      store.add(t.name, t.shape, std::span<const double>(values_of<double>(t)), *stored);
    else
      tensors.push_back(t);
  }
  const auto rounded = store.views();
  tensors.insert(tensors.end(), rounded.begin(), rounded.end());
  write_safetensors(path, tensors, metadata);
}

MOTIONLANG_NAMESPACE_END
