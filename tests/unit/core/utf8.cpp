// UTF-8: every code point there and back; what is not UTF-8.
#include <doctest/doctest.h>

#include <motionlang/core/utf8.hpp>

namespace ml = motionlang;

TEST_CASE("every code point survives") {
  std::string all;
  int wrong = 0;
  for (char32_t c = 0; c <= 0x10FFFF; ++c) {
    if (c == 0xD800) c = 0xE000;
    std::string one;
    ml::append_utf8(one, c);
    std::size_t at = 0;
    wrong += ml::decode_utf8(one, at) != c || at != one.size();
    if (c % 997 == 0) all += one;
  }
  CHECK(wrong == 0);
  CHECK(ml::is_utf8(all));
  CHECK(ml::is_utf8(""));
}

TEST_CASE("bytes that are not UTF-8 are stepped over one by one") {
  using namespace std::string_view_literals;
  for (std::string_view bad : {"\x80"sv, "\xBF"sv, "\xC0\x80"sv, "\xC1\xBF"sv, "\xC3"sv, "\xC3("sv, "\xE0\x9F\xBF"sv,
                               "\xE2\x82"sv, "\xED\xA0\x80"sv, "\xED\xBF\xBF"sv, "\xF0\x8F\xBF\xBF"sv,
                               "\xF4\x90\x80\x80"sv, "\xF5\x80\x80\x80"sv, "\xFF"sv}) {
    std::size_t at = 0;
    CHECK(ml::decode_utf8(bad, at) == ml::invalid_code_point);
    CHECK(at == 1);
    CHECK_FALSE(ml::is_utf8(std::string("fine ") + std::string(bad)));
  }
}

TEST_CASE("a text is cut between two characters") {
  const std::string text = "a\xC3\xA4\xE6\xAD\xA9\xF0\x9F\x9A\xB6z";  // of 1, 2, 3, 4 and 1 bytes
  const std::size_t fits[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 11, 11};
  for (std::size_t bytes = 0; bytes < std::size(fits); ++bytes) CHECK(ml::utf8_head(text, bytes).size() == fits[bytes]);
  CHECK(ml::utf8_head("\x80\x80\x80\x80", 2).size() == 2);  // no characters: bytes
  CHECK(ml::utf8_head("\xE6\xAD", 1).size() == 1);
}

TEST_CASE("printable: no control characters, and UTF-8") {
  CHECK(ml::printable("w\xC3\xA4lk, \xE6\xAD\xA9~") == "w\xC3\xA4lk, \xE6\xAD\xA9~");
  CHECK(ml::printable("\x1B[31m\n\t\x7F") == "?[31m???");
  CHECK(ml::printable("a\nb\t", "\n") == "a\nb?");
  CHECK(ml::printable("\xC2\x9B\xC2\x80\xC2\xA0") == "??\xC2\xA0");  // U+009B begins commands of terminals, too
  CHECK(ml::printable("\xFFz\xC3") == "?z?");
  CHECK(ml::printable(std::string(1, '\0')) == "?");
}
