// SPDX-License-Identifier: MIT
// Bodies of word_vector_file.hpp.
#pragma once

#include <motionlang/core/text_lines.hpp>
#include <motionlang/weights/word_vector_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY WordVectors listed_word_vectors(const TensorSet& file, std::string_view list,
                                                const std::string& prefix) {
  const TensorView &codes = file.tensor(prefix + "codes"), &scales = file.tensor(prefix + "scales");
  std::vector<std::string> words;
  detail::for_each_line(list, [&](std::string_view word, Index) { words.emplace_back(word); });
  if (scales.shape.rank() != 1 || codes.dtype != DType::I8 ||
      codes.shape != FileShape{std::ssize(words), scales.shape[0]})
    raise<io_error>(407, file.name(), ": tensors '", codes.name, "' (", codes.dtype, ", ", codes.shape, ") and '",
                    scales.name, "' ", scales.shape, " are not vectors of ", counted(words.size(), "word"));
  return {std::move(words), values_of<std::int8_t>(codes), values_of<float>(scales), file.name()};
}

MOTIONLANG_BODY WordVectors stored_word_vectors(const SafetensorsFile& file, const std::string& prefix) {
  const auto found = file.metadata().find(vector_words_entry);
  return found == file.metadata().end() ? WordVectors() : listed_word_vectors(file, found->second, prefix);
}

MOTIONLANG_BODY void store_word_vectors(std::vector<TensorView>& tensors, std::map<std::string, std::string>& metadata,
                                        const WordVectors& vectors, const std::string& prefix) {
  if (vectors.empty()) return;
  metadata[vector_words_entry] = join_text(vectors.words(), "\n");
  tensors.push_back(tensor_view(prefix + "codes", {vectors.size(), vectors.width()}, vectors.codes()));
  tensors.push_back(tensor_view(prefix + "scales", {vectors.width()}, vectors.scales()));
}

MOTIONLANG_BODY WordVectors read_word_vectors(const FilePath& path) {
  const auto file = SafetensorsFile::open(path);
  WordVectors out = stored_word_vectors(file);
  if (out.empty()) raise<config_error>(103, file.name(), ": metadata '", vector_words_entry, "' is missing");
  return out;
}

MOTIONLANG_BODY void write_word_vectors(const FilePath& path, const WordVectors& vectors,
                                        const std::map<std::string, std::string>& about) {
  std::vector<TensorView> tensors;
  auto metadata = about;
  store_word_vectors(tensors, metadata, vectors);
  write_safetensors(path, tensors, metadata);
}

MOTIONLANG_NAMESPACE_END
