// SPDX-License-Identifier: MIT
/// The two chunks of a GLB file: a JSON document and binary data. A .gltf file is the document alone. Source: glTF 2.0,
/// section 4.
#pragma once

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::uint32_t glb_magic = 0x46546C67u, glb_json = 0x4E4F534Au, glb_binary = 0x004E4942u;

// NOLINTNEXTLINE(bugprone-exception-escape): a document moves without throwing
struct GlbChunks {
  std::string_view text;  // of the document, in the parsed bytes
  nlohmann::json document;
  std::span<const std::byte> binary;  // of the parsed bytes
};

/// Throws  io_error 402 if the file ends too early, 403 if it is malformed, 404 for another version
inline GlbChunks parse_glb_chunks(std::span<const std::byte> bytes, std::string_view file) {
  std::string_view all = as_text(bytes);
  if (all.starts_with("\xEF\xBB\xBF")) all.remove_prefix(3);  // byte order mark
  if (all.substr(0, all.find_first_not_of(" \t\r\n") + 1).ends_with('{')) return {all, parse_json(all, file), {}};
  const auto number = [&](std::uint64_t at) { return load<std::uint32_t>(bytes, at, file, "GLB header"); };
  if (number(0) != glb_magic) raise<io_error>(403, file, ": not a GLB file (byte 0)");
  if (number(4) != 2) raise<io_error>(404, file, ": glTF version ", number(4), " at byte 4");
  if (number(8) > bytes.size()) {
    raise<io_error>(402, file, ": ", counted(number(8), "byte"), " announced at byte 8, the file has ", bytes.size());
  }
  bytes = bytes.first(number(8));

  GlbChunks chunks;
  std::uint64_t at = 12;
  for (int i = 0; at < bytes.size(); ++i) {
    const auto chunk = slice(bytes, at + 8, number(at), file, "GLB chunk");
    const std::uint32_t kind = number(at + 4);
    if (i == 0 && kind != glb_json) raise<io_error>(403, file, ": the first chunk at byte ", at, " is not JSON");
    if (i == 0) chunks.text = as_text(chunk), chunks.document = parse_json(chunks.text, file);
    if (i == 1 && kind == glb_binary) chunks.binary = chunk;
    at += 8 + chunk.size();
  }
  if (chunks.document.is_null()) raise<io_error>(402, file, ": no JSON chunk");
  return chunks;
}

/// Chunks are padded to multiples of four: text with spaces, data with zeros. Throws io_error 405 from 4 GiB on.
inline std::vector<std::byte> glb_file(std::string document, std::vector<std::byte> binary) {
  document.append((4 - document.size() % 4) % 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4);
  const std::uint64_t total = 12 + 8 + document.size() + 8 + binary.size();
  if (total > 0xFFFFFFFFu) raise<io_error>(405, "GLB: ", counted(total, "byte"), " do not fit into one file");
  std::vector<std::byte> out;
  out.reserve(total);
  for (const std::uint32_t n :
       {glb_magic, 2u, static_cast<std::uint32_t>(total), static_cast<std::uint32_t>(document.size()), glb_json}) {
    append_value(out, n);
  }
  append_text(out, document);
  append_value(out, static_cast<std::uint32_t>(binary.size()));
  append_value(out, glb_binary);
  append_bytes(out, binary);
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
