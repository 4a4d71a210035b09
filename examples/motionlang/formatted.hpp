// The output of the commands.
#pragma once

#include <cstdio>
#include <string>

#include <motionlang/core/error.hpp>
#include <motionlang/core/formatted.hpp>

namespace program {

using motionlang::counted;  // "1 frame", "2 frames"
using motionlang::formatted;

/// Prints lines to standard output.
inline void print(const std::string& lines) { std::fputs(lines.c_str(), stdout); }

}  // namespace program
