// SPDX-License-Identifier: MIT
/// Reads words, numbers and lines of a text, and reports the place of an error. It is for formats made of words between
/// blanks (BVH, ASF, AMC), and knows no format itself.
#pragma once

#include <cmath>        // isfinite
#include <concepts>     // integral
#include <cstdint>      // uint64_t
#include <optional>     // decimal commas
#include <string>       // messages
#include <string_view>  // the text

#include <motionlang/core/error.hpp>
#include <motionlang/core/standard_library.hpp>  // from_chars: numbers without the locale
#include <motionlang/core/text_encoding.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// More joints than any real file has. It keeps searches for names short in a hostile one.
inline constexpr std::size_t max_text_joints = 4096;
/// The largest number of rotations (32 bytes each) for a text of this many bytes. Real files have several bytes for
/// each. Without this limit, joints that a frame does not mention could turn a small file into a large motion.
constexpr std::size_t max_text_rotations(std::size_t bytes) { return 1'000'000 + 16 * bytes; }

constexpr bool same_word(std::string_view a, std::string_view lower_case) {
  if (a.size() != lower_case.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (lower(a[i]) != lower_case[i]) return false;
  }
  return true;
}

/// A position in a text in UTF-8, UTF-16 or UTF-32. Every character up to and including the space is blank, so CR, LF
/// and CRLF all end lines. Throws io_error 402 if the text ends too early, and 403 if it is malformed. Messages begin
/// "name:line:column: ".
class TextScanner {
 public:
  TextScanner(std::string_view text, std::string_view name)
      : converted_(from_wide_text(text)), text_(converted_ ? *converted_ : text), name_(name) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // byte order mark
  }
  TextScanner(const TextScanner&) = delete;
  TextScanner& operator=(const TextScanner&) = delete;

  bool at_end() {
    skip_blanks();
    return at_ == text_.size();
  }
  std::size_t bytes_left() const { return text_.size() - at_; }

  /// The next word without moving; empty at the end of the text. A brace is a word of its own.
  std::string_view peek() {
    skip_blanks();
    std::size_t end = at_;
    if (end < text_.size() && is_brace(text_[end])) return text_.substr(at_, 1);
    while (end < text_.size() && !is_blank(text_[end]) && !is_brace(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }
  /// The next word. Throws io_error 402 at the end of the text.
  std::string_view word(std::string_view wanted) {
    const std::string_view w = peek();
    if (w.empty()) fail(402, "the text ends where ", wanted, " should be");
    last_ = at_;
    at_ += w.size();
    return w;
  }
  /// Skips these characters (no blanks among them), such as "Frames:" of "Frames:12", and leading blanks.
  bool skip_prefix(std::string_view lower_case) {
    skip_blanks();
    if (!same_word(text_.substr(at_, lower_case.size()), lower_case)) return false;
    last_ = at_;
    at_ += lower_case.size();
    return true;
  }
  void expect(std::string_view lower_case) {
    const std::string_view w = word(lower_case);
    if (!same_word(w, lower_case)) fail(403, "expected '", lower_case, "', found '", shortened(w), "'");
  }

  /// A finite number. A leading plus sign and a decimal comma are accepted. A value too small for a double is 0.
  double number(std::string_view wanted) {
    double value = 0;
    if (plain_decimal(value)) return value;
    const std::string_view w = word(wanted);
    const auto [end, problem] = from_digits(w, value);
    const bool whole = end == w.data() + w.size();
    if (whole && problem == std::errc::result_out_of_range && (w.find("e-") != w.npos || w.find("E-") != w.npos))
      return 0;
    if (problem != std::errc{} || !whole || !std::isfinite(value)) {
      if (const auto comma = with_decimal_comma(w)) return *comma;
      fail(403, "expected ", wanted, ", found '", shortened(w), "'",
           w.find(',') == w.npos ? "" : "; a number has one decimal point or comma, and nothing between thousands");
    }
    return value;
  }
  /// The first number that had a decimal comma; empty if none had.
  const std::string& decimal_comma() const { return decimal_comma_; }
  /// A whole number that is not negative.
  template <std::integral I>
  I count(std::string_view wanted) {
    const std::string_view w = word(wanted);
    I value = 0;
    const auto [end, problem] = from_digits(w, value);
    if (problem != std::errc{} || end != w.data() + w.size() || value < 0) {
      fail(403, "expected ", wanted, ", found '", shortened(w), "'");
    }
    return value;
  }

  /// True if only blanks precede the last word on its line.
  bool began_line() const {
    std::size_t at = last_;
    while (at > 0 && is_blank(text_[at - 1]) && !is_line_end(text_[at - 1])) --at;
    return at == 0 || is_line_end(text_[at - 1]);
  }
  /// The next word of this line; empty at the end of the line.
  std::string_view word_on_line() {
    while (at_ < text_.size() && is_blank(text_[at_]) && !is_line_end(text_[at_])) ++at_;
    if (at_ == text_.size() || is_blank(text_[at_])) return {};
    return word("");
  }
  /// The rest of the line, without the blanks around it; moves to the line's end.
  std::string_view rest_of_line() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end;
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line;
  }

  /// Throws with the place of the last word that was read.
  template <class... T>
  [[noreturn]] void fail(int id, const T&... parts) const {
    const auto [line, column] = place(id == 402 ? text_.size() : last_);
    raise<io_error>(id, name_, ":", line, ":", column, ": ", parts...);
  }

  /// A word for a message: cut after 40 bytes.
  static std::string shortened(std::string_view w) {
    return std::string(utf8_head(w, 40)) + (w.size() > 40 ? "..." : "");
  }

 private:
  struct Place {
    std::size_t line, column;
  };
  static bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }
  /// Reads a number in the usual form in one pass: up to 15 digits with at most one point, before a blank. Digits and
  /// power of ten are then exact doubles, so their quotient is the double nearest to the text.
  bool plain_decimal(double& value) {
    static constexpr double powers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                        1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    skip_blanks();
    const char* const end = text_.data() + text_.size();
    const char* p = text_.data() + at_;
    const bool negative = p != end && *p == '-';
    const char* const first = p += negative;
    const char* behind_point = nullptr;
    std::uint64_t digits = 0;
    for (; p != end; ++p) {
      const unsigned digit = static_cast<unsigned char>(*p) - unsigned{'0'};
      if (digit < 10)
        digits = 10 * digits + digit;
      else if (*p == '.' && behind_point == nullptr)
        behind_point = p + 1;
      else
        break;
    }
    const auto count = p - first - (behind_point != nullptr);
    if (count < 1 || count > 15 || (p != end && !is_blank(*p))) return false;
    const double size = static_cast<double>(digits) / powers[behind_point == nullptr ? 0 : p - behind_point];
    value = negative ? -size : size;
    last_ = at_;
    at_ = static_cast<std::size_t>(p - text_.data());
    return true;
  }
  /// "0,5" as 0.5, which programs write in some locales.
  std::optional<double> with_decimal_comma(std::string_view w) {
    constexpr std::size_t longest = 400;
    const std::size_t comma = w.find(',');
    if (comma == w.npos || w.size() > longest || w.find('.') != w.npos) return std::nullopt;
    std::string with_point(w);
    with_point[comma] = '.';
    double value = 0;
    const auto [end, problem] = from_digits(std::string_view(with_point), value);
    if (problem != std::errc{} || end != with_point.data() + with_point.size() || !std::isfinite(value))
      return std::nullopt;
    if (decimal_comma_.empty()) decimal_comma_ = shortened(w);
    return value;
  }
  template <class N>
  static std::from_chars_result from_digits(std::string_view w, N& value) {
    if (w.size() > 1 && w[0] == '+' && w[1] != '-') w.remove_prefix(1);
    return detail::from_chars(w.data(), w.data() + w.size(), value);
  }
  Place place(std::size_t offset) const {
    std::size_t line = 1, start = 0;
    for (std::size_t i = 0; i < offset; ++i) {
      if (text_[i] == '\n' || (text_[i] == '\r' && (i + 1 == text_.size() || text_[i + 1] != '\n'))) {
        ++line;
        start = i + 1;
      }
    }
    return {line, offset - start + 1};
  }

  std::optional<std::string> converted_;  // a text in another encoding
  std::string_view text_;
  std::string name_;
  std::string decimal_comma_{};
  std::size_t at_ = 0;
  std::size_t last_ = 0;  // begin of the last word
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
