// SPDX-License-Identifier: MIT
/// Deflate (RFC 1951) in its plainest form: matches found by one table of three bytes, the codes that the standard
/// fixes. For pictures of a few flat colours, where nothing better is needed, and not zlib, which would have to be
/// linked. Unpacking is in inflate.hpp.
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
