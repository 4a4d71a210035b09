// std::printf into a string.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace program {

__attribute__((format(printf, 1, 2))) inline std::string formatted(const char* form, ...) {
  std::va_list values, again;
  va_start(values, form);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, form, values)), ' ');
  std::vsnprintf(text.data(), text.size() + 1, form, again);
  va_end(again);
  va_end(values);
  return text;
}

}  // namespace program
