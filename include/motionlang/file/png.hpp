// SPDX-License-Identifier: MIT
/// Writes pictures as PNG files (ISO/IEC 15948) in 8-bit RGB.
#pragma once

#include <cstdint>  // colours
#include <string>   // file
#include <vector>   // colours

#include <motionlang/core/shape.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Rows from top to bottom, red, green, blue.
struct Picture {
  Index width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

namespace detail {

/// Most significant byte first.
std::string big_endian(std::uint32_t v);

}  // namespace detail

/// Stores each row as differences to the row above. Throws shape_error 205 if the number of values is not width x
/// height x 3, and config_error 101 for a picture without pixels or with more than 2^31 of them in a row.
std::string encode_png(const Picture& picture);

/// Throws io_error 401, and as encode_png.
void write_png(const FilePath& path, const Picture& picture);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/png.ipp>
#endif
