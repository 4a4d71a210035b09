// Options of training runs in every form: any text is read or refused with an error of the library; values are found by
// their paths, references end, and what is read is not much more than the text.
#include <algorithm>
#include <cstdint>
#include <span>

#include <motionlang/file/options_file.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

void read(std::string_view text) {
  const auto values = ml::parse_options(text, "fuzz");
  check(values.size() <= text.size(), "no more values than characters");
  for (const ml::FileValue& v : std::span(values).first(std::min<std::size_t>(values.size(), 50))) {
    check(ml::find_value(values, v.path) != nullptr, "a value is found by its path");
    ml::find_option(values, v.path);
    to_string(v);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  refusing([&] { read(text); });
  refusing([&] { read("---- Options\n" + text); });
  return 0;
}
