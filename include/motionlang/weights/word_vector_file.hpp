// SPDX-License-Identifier: MIT
/// Word vectors in safetensors files: alone, or beside the weights of a text encoder.
///
///     write_word_vectors("words.safetensors", table, {{"license", "PDDL 1.0"}});
///     const WordVectors vectors = read_word_vectors("words.safetensors");
///
/// Tensors    codes (words, width) I8, scales (width) F32, behind a prefix
/// Metadata   vector_words: a word on each line, sorted; for people: license, provenance
#pragma once

#include <motionlang/file/safetensors.hpp>
#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The entry of the words in the metadata.
inline constexpr const char* vector_words_entry = "vector_words";

/// The vectors of a file whose tensors begin with `prefix`; none if it has no list of words. Throws io_error 406, 407,
/// config_error 107.
WordVectors stored_word_vectors(const SafetensorsFile& file, const std::string& prefix = "");
/// The same from any file of weights. `list`: the entry vector_words of its metadata.
WordVectors listed_word_vectors(const TensorSet& file, std::string_view list, const std::string& prefix = "");
/// Adds them to what is about to be written. The views are of `vectors`, which has to outlive them.
void store_word_vectors(std::vector<TensorView>& tensors, std::map<std::string, std::string>& metadata,
                        const WordVectors& vectors, const std::string& prefix = "");

/// Throws config_error 103 if the file has no word vectors, and what stored_word_vectors throws.
WordVectors read_word_vectors(const FilePath& path);
/// Throws io_error 401.
void write_word_vectors(const FilePath& path, const WordVectors& vectors,
                        const std::map<std::string, std::string>& about = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/word_vector_file.ipp>
#endif
