// SPDX-License-Identifier: MIT
// Bodies of safetensors_copy.hpp.
#pragma once

#include <list>  // matrices, which views point to
#include <map>   // metadata

#include <motionlang/core/utf8.hpp>
#include <motionlang/weights/int8_matrix.hpp>
#include <motionlang/weights/known_caption_file.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/motion_memory_file.hpp>
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
  std::list<Int8Matrix> matrices;
  for (const TensorView& t : weights.tensors()) {
    const bool real = t.dtype >= DType::F16 && t.dtype <= DType::F64;
    if (t.name.starts_with(caption_tensors) || t.name.starts_with(memory_tensors)) {
      tensors.push_back(t);  // tables of the model, which have types of their own
      continue;
    }
    const TensorView* const scales = int8_scales_of(weights, t);
    const bool scaled = scales != nullptr || is_int8_scales(weights, t);
    if (scaled && stored && stored != DType::I8) {
      if (scales == nullptr) continue;  // the matrix of these scales takes them up
      std::vector<double> values(static_cast<std::size_t>(t.shape.count()));
      copy_int8_values(t, *scales, std::span<double>(values));
      store.add(t.name, t.shape, std::span<const double>(values), *stored);
    } else if (stored == DType::I8) {
      if (scaled || !real || t.shape.rank() != 2 || t.shape.count() < int8_matrix_least) {
        tensors.push_back(t);
        continue;
      }
      const Int8Matrix& m = matrices.emplace_back(int8_matrix(values_of<float>(t), t.shape[0], t.shape[1], t.name));
      tensors.push_back(tensor_view(t.name, t.shape, std::span<const std::int8_t>(m.codes)));
      tensors.push_back(
          {t.name + int8_scales, DType::F16, {m.rows, int8_groups(m.columns)}, std::as_bytes(std::span(m.scales))});
    } else if (stored && real) {
      store.add(t.name, t.shape, std::span<const double>(values_of<double>(t)), *stored);
    } else {
      tensors.push_back(t);
    }
  }
  const auto rounded = store.views();
  tensors.insert(tensors.end(), rounded.begin(), rounded.end());
  write_safetensors(path, tensors, metadata);
}

MOTIONLANG_NAMESPACE_END
