// SPDX-License-Identifier: MIT
/// Deflate (RFC 1951) in its simplest form: one table of three bytes finds matches, and the codes are the fixed ones of
/// the standard. This is enough for pictures of a few flat colours, and needs no link with zlib. Unpacking is in
/// inflate.hpp.
#pragma once

#include <cstddef>  // byte
#include <span>     // input
#include <string>   // output

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

std::string deflate(std::span<const std::byte> bytes);

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/detail/deflate.ipp>
#endif
