// SPDX-License-Identifier: MIT
// Bodies of gzip.hpp.
#pragma once

#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/gzip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool is_gzip(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{0x1F} && bytes[1] == std::byte{0x8B};
}

MOTIONLANG_BODY std::vector<std::byte> gunzip_bytes(std::span<const std::byte> bytes, std::string_view name) {
  constexpr std::uint8_t has_checksum = 2, has_extra = 4, has_name = 8, has_comment = 16, reserved = 0xE0;
  if (!is_gzip(bytes)) raise<io_error>(403, name, ": does not begin as a gzip file");
  if (const auto method = detail::load<std::uint8_t>(bytes, 2, name, "the method"); method != 8)
    raise<io_error>(404, name, ": gzip method ", int{method}, ", only 8 (deflate) is known");
  const auto flags = detail::load<std::uint8_t>(bytes, 3, name, "the flags");
  if ((flags & reserved) != 0) raise<io_error>(404, name, ": gzip flags ", int{flags});
  std::uint64_t at = 10;
  if ((flags & has_extra) != 0) at += 2u + detail::load<std::uint16_t>(bytes, at, name, "the extra field");
  for (const auto text : {has_name, has_comment}) {
    if ((flags & text) == 0) continue;
    while (detail::load<char>(bytes, at, name, "a text of the header") != '\0') ++at;
    ++at;
  }
  if ((flags & has_checksum) != 0) at += 2;
  if (at > bytes.size() || bytes.size() - at < 8) raise<io_error>(402, name, ": ends inside the header or the trailer");
  const std::uint64_t trailer = bytes.size() - 8;
  const auto crc = detail::load<std::uint32_t>(bytes, trailer, name, "the checksum");
  const auto size = detail::load<std::uint32_t>(bytes, trailer + 4, name, "the size");
  const auto stream = bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(trailer - at));
  constexpr std::uint64_t largest_ratio = 1032;
  if (size > largest_ratio * stream.size())
    raise<io_error>(405, name, ": declares ", counted(size, "byte"), ", packed in ", stream.size());
  detail::Inflated out = detail::inflate(stream, size, name, size);
  if (out.consumed != stream.size())
    raise<io_error>(403, name, ": ", counted(stream.size() - out.consumed, "byte"),
                    " between the data and the trailer");
  if (out.data.size() != size)
    raise<io_error>(403, name, ": declares ", counted(size, "byte"), ", holds ", out.data.size());
  if (detail::crc32(out.data) != crc) raise<io_error>(403, name, ": wrong checksum");
  return std::move(out.data);
}

MOTIONLANG_BODY std::string gunzip(std::span<const std::byte> bytes, std::string_view name) {
  return std::string(detail::as_text(gunzip_bytes(bytes, name)));
}

MOTIONLANG_BODY std::string read_text(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return is_gzip(file->bytes()) ? gunzip(file->bytes(), path.string()) : std::string(detail::as_text(file->bytes()));
}

MOTIONLANG_NAMESPACE_END
