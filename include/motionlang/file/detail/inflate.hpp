// SPDX-License-Identifier: MIT
/// Inflate (RFC 1951): unpacks deflated data of zip members, gzip and zlib streams. Also the checksums of zip, gzip and
/// zlib. Nothing here compresses. zlib would do the same, but programs would have to link it. This library needs only
/// its headers to read .npz, .pt and .gz. tests/unit/file compares with data that zlib packed.
#pragma once

#include <limits>  // no end before the stream's

#include <motionlang/file/detail/bytes.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// CRC-32 as in zip, gzip and PNG: reflected polynomial 0xEDB88320.
std::uint32_t crc32(std::span<const std::byte> bytes);

/// The checksum of zlib streams: two sums modulo 65521.
std::uint32_t adler32(std::span<const std::byte> bytes);

/// The result of inflate: the data, and the number of bytes that it took from the stream.
struct Inflated {
  std::vector<std::byte> data;
  std::size_t consumed = 0;
};

/// Counts unpacked bytes instead of storing them.
struct ByteCount {
  std::size_t bytes = 0;
  std::size_t size() const { return bytes; }
  void push_back(std::byte) { ++bytes; }
};

/// Unpacks one deflate stream to at most `limit` bytes. Returns the number of bytes that it took from the stream. It
/// stops early if there are `enough`.
/// Throws  io_error 402 if the stream ends too early, 403 if it is malformed, 405 beyond the limit
std::size_t inflate_to(std::vector<std::byte>& out, std::span<const std::byte> stream, std::size_t limit,
                       std::string_view file, std::size_t enough = std::numeric_limits<std::size_t>::max());
std::size_t inflate_to(ByteCount& out, std::span<const std::byte> stream, std::size_t limit, std::string_view file,
                       std::size_t enough = std::numeric_limits<std::size_t>::max());

/// The same into memory that is reserved for `expected` bytes.
Inflated inflate(std::span<const std::byte> stream, std::size_t limit, std::string_view file, std::size_t expected = 0);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/detail/inflate.ipp>
#endif
