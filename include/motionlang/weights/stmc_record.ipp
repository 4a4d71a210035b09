// SPDX-License-Identifier: MIT
// Bodies of stmc_record.hpp.
#pragma once

#include <motionlang/weights/stmc_record.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string metadata_real_text(double x) {
  std::string out;
  append_python_float(out, x);
  return out;
}

MOTIONLANG_BODY std::string numbered_name(const char* what, std::size_t i) {
  const std::string digits = std::to_string(i);
  return concat_text(what, '/', digits.size() < 3 ? std::string(3 - digits.size(), '0') : "", digits);
}

MOTIONLANG_BODY Timeline record_timeline(const SafetensorsFile& file, std::size_t m, Index rows) {
  const TensorView& view = file.tensor(numbered_name("timeline", m));
  if (view.shape.rank() != 2 || view.shape[1] != 3)
    raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", not (texts, 3)");
  const auto numbers = values_of<double>(view);
  Timeline out;
  for (std::size_t i = 0; 3 * i < numbers.size(); ++i) {
    const auto number = [&](std::size_t column, Index largest) {
      const double x = numbers[3 * i + column];
      if (!(x >= 0 && x <= static_cast<double>(largest)))
        raise<config_error>(101, file.name(), ": ", x, " in tensor '", view.name, "' is not in 0 ... ", largest);
      return static_cast<Index>(x);
    };
    const auto text = file.metadata().find(concat_text("text/", m, '/', i));
    if (text == file.metadata().end())
      raise<config_error>(107, file.name(), ": metadata 'text/", m, "/", i, "' is missing");
    out.intervals.push_back(
        {text->second, number(0, rows), number(1, rows), {static_cast<unsigned>(number(2, BodyParts::all().bits))}});
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
