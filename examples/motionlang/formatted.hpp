// std::printf into a string, and counts in words.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

#include <motionlang/core/error.hpp>

namespace program {

#if defined(__MINGW_PRINTF_FORMAT)
#define PROGRAM_PRINTF_FORMAT __MINGW_PRINTF_FORMAT  // of the printf that MinGW has chosen, its own or that of Windows
#else
#define PROGRAM_PRINTF_FORMAT printf
#endif

__attribute__((format(PROGRAM_PRINTF_FORMAT, 1, 2))) inline std::string formatted(const char* form, ...) {
  std::va_list values, again;
  va_start(values, form);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, form, values)), ' ');
  std::vsnprintf(text.data(), text.size() + 1, form, again);
  va_end(again);
  va_end(values);
  return text;
}

using motionlang::counted;  // "1 frame", "2 frames"

}  // namespace program
