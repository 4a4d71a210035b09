// SPDX-License-Identifier: MIT
// Bodies of caption_encoder_file.hpp.
#pragma once

#include <motionlang/weights/caption_encoder_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string metadata_text(const Metadata& metadata, const std::string& key,
                                          const std::string& otherwise) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? otherwise : found->second;
}

MOTIONLANG_BODY Index metadata_size(const Metadata& metadata, const std::string& key, Index largest,
                                    const std::string& file, Index smallest) {
  const auto n = metadata_number<Index>(metadata, key, file);
  if (n < smallest || n > largest)
    raise<config_error>(101, file, ": metadata '", key, "' = ", n, " is not in ", smallest, " ... ", largest);
  return n;
}

MOTIONLANG_BODY Index metadata_heads(const Metadata& metadata, const std::string& key, Index width,
                                     const std::string& file) {
  const Index n = metadata_size(metadata, key, 256, file);
  if (width % n != 0 || width % 2 != 0)
    raise<config_error>(101, file, ": ", key, " = ", n, " does not divide the even width ", width);
  return n;
}

MOTIONLANG_BODY WordPiece metadata_vocabulary(const Metadata& metadata, const std::string& file) {
  const auto found = metadata.find("text.vocabulary");
  if (found == metadata.end()) raise<config_error>(107, file, ": metadata 'text.vocabulary' is missing");
  std::vector<std::string> pieces;
  for (std::size_t at = 0; at <= found->second.size();) {
    const std::size_t end = std::min(found->second.find('\n', at), found->second.size());
    pieces.push_back(found->second.substr(at, end - at));
    at = end + 1;
  }
  return WordPiece(std::move(pieces), file + ": metadata 'text.vocabulary'");
}

MOTIONLANG_BODY void check_shape(const SafetensorsFile& file, const std::string& name, const Shape& shape) {
  if (const FileShape& found = file.tensor(name).shape; found != shape)
    raise<io_error>(407, file.name(), ": tensor '", name, "' is ", found, ", the metadata say ", shape);
}

MOTIONLANG_BODY void check_layers(const SafetensorsFile& file, const std::string& prefix, Index layers, Index width,
                                  Index d_ff) {
  for (Index i = 0; i < layers; ++i) {
    const std::string layer = concat_text(prefix, ".layers.", i);
    check_shape(file, layer + ".self_attn.in_proj_weight", {3 * width, width});
    check_shape(file, layer + ".linear1.weight", {d_ff, width});
  }
}

}  // namespace detail

MOTIONLANG_BODY void require_stmc_file(const SafetensorsFile& file) {
  const auto& m = file.metadata();
  if (detail::metadata_text(m, "model", "") != "stmc" || detail::metadata_text(m, "format", "") != "1")
    raise<config_error>(103, file.name(), ": not an STMC model of format 1 (metadata 'model' and 'format')");
}

MOTIONLANG_BODY CaptionEncoderConfig caption_encoder_config(const SafetensorsFile& file) {
  const auto& m = file.metadata();
  const auto size = [&](const char* key, Index largest) { return detail::metadata_size(m, key, largest, file.name()); };
  CaptionEncoderConfig c;
  c.width = size("text.width", 8192);
  c.heads = detail::metadata_heads(m, "text.heads", c.width, file.name());
  c.d_ff = size("text.d_ff", 32768);
  c.layers = size("text.layers", 256);
  c.out = size("text.out", 8192);
  if (m.contains("text.longest")) c.longest = size("text.longest", 8192);
  return c;
}

MOTIONLANG_BODY void check_sizes(const SafetensorsFile& file, const CaptionEncoderConfig& c, Index vocabulary,
                                 Index vector_width) {
  detail::check_shape(file, "text_encoder.embedding.weight", {vocabulary, c.width});
  detail::check_shape(file, "text_encoder.projection.weight", {c.out, c.width});
  if (vector_width > 0) detail::check_shape(file, "text_encoder.vector_projection.weight", {c.width, vector_width});
  detail::check_layers(file, "text_encoder.encoder", c.layers, c.width, c.d_ff);
}

MOTIONLANG_NAMESPACE_END
