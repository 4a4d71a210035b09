// SPDX-License-Identifier: MIT
/// Unpacks gzip files of one member (RFC 1952). Nothing here compresses.
#pragma once

#include <cstddef>      // byte
#include <span>         // input
#include <string>       // output
#include <string_view>  // names
#include <vector>       // output

#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

bool is_gzip(std::span<const std::byte> bytes);

/// The unpacked contents. Allocates at most what deflate can pack into the given bytes.
/// Throws  io_error 402 if the stream ends too early, 403 if it is malformed or its checksum is wrong, 404 for an
///         unknown method, 405 if it unpacks to more than it declares or declares more than it can hold
std::vector<std::byte> gunzip_bytes(std::span<const std::byte> bytes, std::string_view name = "gzip");
/// The same as a text.
std::string gunzip(std::span<const std::byte> bytes, std::string_view name = "gzip");

/// Reads a text file, packed with gzip or not. Throws io_error 401 and as gunzip.
std::string read_text(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/gzip.ipp>
#endif
