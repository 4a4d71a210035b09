// Checks of the values of options. CLI11's own checks accept "nan", and their message for "above 0" is "not in range
// 0.000000 to 17976931348623157081...".
#pragma once

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <motionlang/core/utf8.hpp>
#include <motionlang/features/motion_features.hpp>

#include "formatted.hpp"

namespace program {

/// A finite number for which `fits` holds.
/// kind    the description of the option in --help
/// wanted  the end of the message: "'-1' is not <wanted>"
template <class Fits>
CLI::Validator number_that(const std::string& kind, const std::string& wanted, Fits fits) {
  return CLI::Validator(
      [wanted, fits](const std::string& text) {
        double x = 0;
        const char* const end = text.data() + text.size();
        const auto [last, status] = std::from_chars(text.data(), end, x);
        const bool good = status == std::errc{} && last == end && std::isfinite(x) && fits(x);
        return good ? std::string() : "'" + text + "' is not " + wanted;
      },
      kind);
}

inline CLI::Validator positive() {
  return number_that("above 0", "a number above 0", [](double x) { return x > 0; });
}
inline CLI::Validator not_negative() {
  return number_that("0 or more", "0 or a number above it", [](double x) { return x >= 0; });
}
inline CLI::Validator in_range(double low, double high) {
  return number_that(formatted("%.9g to %.9g", low, high), formatted("a number from %.9g to %.9g", low, high),
                     [low, high](double x) { return low <= x && x <= high; });
}

/// CLI11 reads -1 as the largest number.
inline CLI::Validator seed_number() {
  return CLI::Validator(
      [](const std::string& text) {
        std::uint64_t x = 0;
        const char* const end = text.data() + text.size();
        const auto [last, status] = std::from_chars(text.data(), end, x);
        const bool good = status == std::errc{} && last == end;
        return good ? std::string() : "'" + text + "' is not a whole number from 0 to 18446744073709551615";
      },
      "");
}

inline CLI::Validator utf8() {
  return CLI::Validator(
      [](const std::string& text) { return std::string(motionlang::is_utf8(text) ? "" : "is not UTF-8"); }, "");
}

/// Refuses a missing text, for instance "$TEXT" of a shell without that variable.
inline CLI::Validator not_empty() {
  return CLI::Validator([](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); }, "");
}

/// Options with the path of an existing file, of an existing folder, or of either.
template <class T>
CLI::Option* file_option(CLI::App& c, const std::string& name, T& value, const std::string& about) {
  return c.add_option(name, value, about)->check(CLI::ExistingFile);
}
template <class T>
CLI::Option* folder_option(CLI::App& c, const std::string& name, T& value, const std::string& about) {
  return c.add_option(name, value, about)->check(CLI::ExistingDirectory);
}
template <class T>
CLI::Option* path_option(CLI::App& c, const std::string& name, T& value, const std::string& about) {
  return c.add_option(name, value, about)->check(CLI::ExistingPath);
}
/// An option whose value is checked. --help prints its default.
template <class T>
CLI::Option* checked_option(CLI::App& c, const std::string& name, T& value, const CLI::Validator& check,
                            const std::string& about) {
  return c.add_option(name, value, about)->check(check)->capture_default_str();
}

/// A name of motion_features.hpp, or `other`.
inline CLI::Validator features_name(const std::string& other = "") {
  std::vector<std::string> known;
  for (const auto& f : motionlang::all_motion_features) known.emplace_back(f.name);
  if (!other.empty()) known.push_back(other);
  return CLI::IsMember(known);
}

}  // namespace program
