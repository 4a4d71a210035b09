// SPDX-License-Identifier: MIT
/// The text encoder of an STMC file (weights/stmc_file.hpp), and the captions that it learned from, without the rest of
/// the model.
///
///     const auto captions = load_known_captions<B>("examples/models/stmc_free.safetensors");
///     for (const NearText& near : captions.nearest("have a seat", 3)) use(near.text);
#pragma once

#include <motionlang/text/caption_encoder.hpp>
#include <motionlang/weights/known_caption_file.hpp>
#include <motionlang/weights/metadata_number.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/word_vector_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

std::string metadata_text(const Metadata& metadata, const std::string& key, const std::string& otherwise);
/// A size from a file. It is limited, so that a hostile file cannot make us allocate too much memory.
Index metadata_size(const Metadata& metadata, const std::string& key, Index largest, const std::string& file,
                    Index smallest = 1);
/// The number of heads of a transformer of this width. Throws config_error 101 unless it divides an even width.
Index metadata_heads(const Metadata& metadata, const std::string& key, Index width, const std::string& file);

WordPiece metadata_vocabulary(const Metadata& metadata, const std::string& file);
/// Throws io_error 407 if a tensor has another shape than the sizes of the model say.
void check_shape(const SafetensorsFile& file, const std::string& name, const Shape& shape);
/// The same for the layers of a transformer.
void check_layers(const SafetensorsFile& file, const std::string& prefix, Index layers, Index width, Index d_ff);

/// The names of the tensors of the text encoder, and of its word vectors, begin like this. The latter are constants.
inline constexpr const char *encoder_tensors = "text_encoder.", *vector_tensors = "text_encoder.vectors.";

}  // namespace detail

/// The sizes of the text encoder that a file declares. Throws config_error 101, 107.
CaptionEncoderConfig caption_encoder_config(const SafetensorsFile& file);

/// Compares the tensors that decide the size of the text encoder with its declared sizes, before memory is allocated
/// for them. Throws io_error 406, 407.
void check_sizes(const SafetensorsFile& file, const CaptionEncoderConfig& c, Index vocabulary, Index vector_width = 0);

/// Throws config_error 103 unless it is an STMC file of format 1.
void require_stmc_file(const SafetensorsFile& file);

/// Reads the text encoder alone. Throws io_error 403 ... 407, config_error 101, 103, 107, numeric_error 301.
template <Backend B>
CaptionEncoder<B> load_caption_encoder(const SafetensorsFile& file) {
  require_stmc_file(file);
  const CaptionEncoderConfig c = caption_encoder_config(file);
  WordPiece tokenizer = detail::metadata_vocabulary(file.metadata(), file.name());
  WordVectors vectors = stored_word_vectors(file, detail::vector_tensors);
  check_sizes(file, c, tokenizer.size(), vectors.width());
  NoInit zeros;
  CaptionEncoder<B> encoder(c, std::move(tokenizer), zeros, std::move(vectors));
  KeyReport report = load_module_partly(encoder, file, detail::encoder_tensors, LoadFor::inference);
  std::erase_if(report.unexpected, [](const std::string& name) { return name.starts_with(detail::vector_tensors); });
  if (!report.missing.empty() || !report.unexpected.empty()) detail::raise_key_mismatch(file.name(), report);
  return encoder;
}

/// The captions of an STMC file, encoded by its text encoder. None if the file lists no captions. Throws what
/// load_caption_encoder and stored_known_captions throw.
template <Backend B>
KnownCaptions load_known_captions(const SafetensorsFile& file) {
  auto encoder = load_caption_encoder<B>(file);
  const WordVectors words = encoder.vectors;
  return stored_known_captions(file, text_vectors(std::move(encoder)), words);
}
/// The same from a file. Throws io_error 401, too.
template <Backend B>
KnownCaptions load_known_captions(const FilePath& path) {
  return load_known_captions<B>(SafetensorsFile::open(path));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/caption_encoder_file.ipp>
#endif
