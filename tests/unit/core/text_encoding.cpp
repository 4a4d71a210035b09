// Texts in UTF-16, UTF-32 and ISO 8859-1.
#include <doctest/doctest.h>

#include <string>

#include <motionlang/core/text_encoding.hpp>
#include <motionlang/core/utf8.hpp>

namespace ml = motionlang;
using namespace std::string_literals;

namespace {

std::string stored(const std::u32string& text, std::size_t width, bool big_endian) {
  std::string out;
  const auto put = [&](char32_t unit) {
    for (std::size_t i = 0; i < width; ++i)
      out += static_cast<char>(unit >> 8 * (big_endian ? width - 1 - i : i) & 0xFF);
  };
  for (const char32_t c : text) {
    if (width == 4 || c < 0x10000) {
      put(c);
    } else {
      put(0xD800 + ((c - 0x10000) >> 10)), put(0xDC00 + ((c - 0x10000) & 0x3FF));
    }
  }
  return out;
}

}  // namespace

TEST_CASE("wide texts are known by their mark, and without one by the zeros of their letters") {
  const std::u32string text = U"HIERARCHY\nROOT \u30BB\u30F3\u30BF\u30FC \U0001F3C3 \u00E9\n";
  std::string wanted;
  for (const char32_t c : text) ml::append_utf8(wanted, c);
  for (const std::size_t width : {2U, 4U}) {
    for (const bool big : {false, true}) {
      CHECK(ml::from_wide_text(stored(U"\uFEFF" + text, width, big)) == wanted);
      if (width == 2) CHECK(ml::from_wide_text(stored(text, width, big)) == wanted);
    }
  }
  for (const std::string& narrow : {wanted, ""s, "a"s, "HIER"s, "\xEF\xBB\xBFHIER"s})
    CHECK(!ml::from_wide_text(narrow));
}

TEST_CASE("a unit without a character becomes one that says so, and nothing is read behind the end") {
  CHECK(ml::from_wide_text("\xFF\xFE"s) == "");
  CHECK(ml::from_wide_text("\xFF\xFE\x41"s) == "\uFFFD");
  CHECK(ml::from_wide_text("\xFF\xFE\x00\xD8\x41\x00"s) == "\uFFFDA");
  CHECK(ml::from_wide_text("\xFF\xFE\x00\xDC\x00\xD8"s) == "\uFFFD\uFFFD");
  CHECK(ml::from_wide_text("\xFF\xFE\0\0\x00\x00\x11\x00"s) == "\uFFFD");
}

TEST_CASE("ISO 8859-1: each byte is a character") {
  CHECK(ml::from_latin1("H\xFC"
                        "fte") == "H\u00FCfte");
  CHECK(ml::is_utf8(ml::from_latin1("\x80\xFF\xC3")));
}
