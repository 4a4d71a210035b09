// SPDX-License-Identifier: MIT
// Bodies of png.hpp.
#pragma once

#include <motionlang/file/detail/deflate.hpp>
#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/png.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string big_endian(std::uint32_t v) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(v >> shift & 255u);
  return out;
}

inline std::string png_chunk(std::string_view type, std::string_view data) {
  const std::string body = concat_text(type, data);
  return concat_text(big_endian(static_cast<std::uint32_t>(data.size())), body,
                     big_endian(crc32(std::as_bytes(std::span(body)))));
}

}  // namespace detail

MOTIONLANG_BODY std::string encode_png(const Picture& picture) {
  const auto fits = [](Index n) { return n > 0 && n <= 0x7fffffff / 3; };
  if (!fits(picture.width) || !fits(picture.height)) {
    raise<config_error>(101, "encode_png: ", picture.width, " x ", picture.height, " pixels");
  }
  const auto row = static_cast<std::size_t>(3 * picture.width), rows = static_cast<std::size_t>(picture.height);
  if (picture.rgb.size() / row != rows || picture.rgb.size() % row != 0) {
    raise<shape_error>(205, "encode_png: ", counted(picture.rgb.size(), "number"), " for ", picture.width, " x ",
                       picture.height);
  }
  constexpr std::byte up{2};
  std::vector<std::byte> filtered;
  filtered.reserve((row + 1) * rows);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
    if (i % row == 0) filtered.push_back(up);
    const int above = i >= row ? picture.rgb[i - row] : 0;
    filtered.push_back(static_cast<std::byte>((picture.rgb[i] - above) & 255));
  }
  const std::string header = concat_text(detail::big_endian(static_cast<std::uint32_t>(picture.width)),
                                         detail::big_endian(static_cast<std::uint32_t>(picture.height)),
                                         std::string_view("\x08\x02\x00\x00\x00", 5));
  const std::string data = concat_text(std::string_view("\x78\x01"), detail::deflate(filtered),
                                       detail::big_endian(detail::adler32(filtered)));
  return concat_text(std::string_view("\x89PNG\r\n\x1a\n"), detail::png_chunk("IHDR", header),
                     detail::png_chunk("IDAT", data), detail::png_chunk("IEND", {}));
}

MOTIONLANG_BODY void write_png(const FilePath& path, const Picture& picture) { write_file(path, encode_png(picture)); }

MOTIONLANG_NAMESPACE_END
