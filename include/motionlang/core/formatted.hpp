// SPDX-License-Identifier: MIT
/// std::printf into a string, for lines in columns that people read. Error messages use concat_text of core/error.hpp,
/// which does not depend on the locale.
#pragma once

#include <cstdarg>  // values
#include <cstdio>   // vsnprintf
#include <string>   // string

#include <motionlang/version.hpp>

#if defined(__MINGW_PRINTF_FORMAT)
#define MOTIONLANG_PRINTF_FORMAT \
  __MINGW_PRINTF_FORMAT  // of the printf that MinGW has chosen, its own or that of Windows
#else
#define MOTIONLANG_PRINTF_FORMAT printf
#endif

MOTIONLANG_NAMESPACE_BEGIN
// A template would lose the check of the format by the compiler. NOLINTNEXTLINE(cert-dcl50-cpp)
__attribute__((format(MOTIONLANG_PRINTF_FORMAT, 1, 2))) inline std::string formatted(const char* form, ...) {
  std::va_list values, again;
  va_start(values, form);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, form, values)), ' ');
  std::vsnprintf(text.data(), text.size() + 1, form, again);
  va_end(again);
  va_end(values);
  return text;
}

MOTIONLANG_NAMESPACE_END

#undef MOTIONLANG_PRINTF_FORMAT
