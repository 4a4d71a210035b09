// SPDX-License-Identifier: MIT
/// The captions of a training in the file of its weights (text/known_captions.hpp).
///
///     const auto stmc = load_stmc<B>(path);
///     const KnownCaptions captions = load_known_captions(path, stmc.text_encoder);
///
/// Tensors    captions.codes (captions, width) I8, captions.mean (width) F32, captions.seconds (captions) F32,
///            captions.then (captions) I16: -1 for an action that repeats, else a line of captions.then; if texts were
///            tried, captions.done (texts) F32, and codes has their rows behind those of the captions
/// Metadata   captions: one on each line, and texts that were tried; captions.then: texts for what follows, one on each
///            line; captions.nearness
#pragma once

#include <motionlang/file/safetensors.hpp>
#include <motionlang/text/known_captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The prefix of the names of their tensors, which are constants.
inline constexpr const char* caption_tensors = "captions.";
/// That of the motions of captions (weights/motion_memory_file.hpp), which name captions by their lines.
inline constexpr const char* memory_tensors = "memory.";

/// None if the file lists no captions. encode: by the text encoder of the file; words: its vectors of words. Throws
/// io_error 406, 407, config_error 107.
KnownCaptions stored_known_captions(const SafetensorsFile& file, TextVectors encode, const WordVectors& words = {});

/// Known captions as tensors and metadata, for a file that is about to be written. Views point into it.
class StoredCaptions {
 public:
  /// Throws config_error 101 for more than 32,767 different texts of what follows, and for a text that is not a line.
  explicit StoredCaptions(KnownCaptions captions);
  void add_to(std::vector<TensorView>& tensors, std::map<std::string, std::string>& metadata) const;

 private:
  KnownCaptions captions_;
  std::vector<float> seconds_{};
  std::vector<std::int16_t> then_{};
  std::vector<float> done_{};
  std::vector<std::string> following_{};
};

namespace detail {

/// The tensors and the metadata of a file without its captions.
struct FileWithoutCaptions {
  explicit FileWithoutCaptions(const SafetensorsFile& file);

  std::vector<TensorView> tensors;
  std::map<std::string, std::string> metadata;
};

}  // namespace detail

/// Writes the file again with these captions instead of its own. Texts that were tried may differ. Throws io_error 401,
/// and config_error 102 for other captions if the file has motions for its own.
void replace_known_captions(const FilePath& path, const KnownCaptions& captions);

/// The captions of a file of ours. encoder: of the same file, with its vectors of words.
template <class Encoder>
KnownCaptions load_known_captions(const FilePath& path, const Encoder& encoder) {
  return stored_known_captions(SafetensorsFile::open(path), text_vectors(encoder), encoder.vectors);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/known_caption_file.ipp>
#endif
