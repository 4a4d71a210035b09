// Classes of characters, lower case, NFD and NFC: single cases, and with utf8proc every code point and random
// sequences.
#include <motionlang/text/detail/unicode_tables.hpp>
#include <motionlang/text/unicode.hpp>

#include <doctest/doctest.h>

#ifdef MOTIONLANG_TEST_UTF8PROC
#include <utf8proc.h>

#include <cstdlib>
#include <random>
#endif

namespace ml = motionlang;
namespace cc = motionlang::CharClass;

TEST_CASE("char_class: a few of every kind") {
  CHECK(ml::char_class(U'a') == (cc::letter | cc::cased));
  CHECK(ml::char_class(U'7') == cc::number);
  CHECK(ml::char_class(U'!') == cc::punctuation);
  CHECK(ml::char_class(U'+') == 0);
  CHECK(ml::char_class(U' ') == cc::white_space);
  CHECK(ml::char_class(U'\n') == (cc::other | cc::white_space));
  CHECK(ml::char_class(0x301) == (cc::nonspacing_mark | cc::case_ignorable));
  CHECK(ml::char_class(0x200B) == (cc::other | cc::case_ignorable));
  CHECK(ml::char_class(0x3000) == cc::white_space);
  CHECK(ml::char_class(0x8D70) == cc::letter);
  CHECK(ml::char_class(0x2167) == (cc::number | cc::cased));
  CHECK(ml::char_class(0x378) == 0);  // unassigned
  CHECK(ml::char_class(0xE000) == cc::other);
  CHECK(ml::char_class(0x10FFFD) == cc::other);
  CHECK(ml::char_class(0x110000) == 0);
}

TEST_CASE("normal forms: examples of the standard") {
  CHECK(ml::nfd(U"\u00C5\u1E69") == U"A\u030As\u0323\u0307");
  CHECK(ml::nfd(U"q\u0307\u0323") == U"q\u0323\u0307");
  CHECK(ml::nfc(U"q\u0307\u0323") == U"q\u0323\u0307");
  CHECK(ml::nfc(U"s\u0307\u0323") == U"\u1E69");
  CHECK(ml::nfc(U"\u0344") == U"\u0308\u0301");        // excluded from composition
  CHECK(ml::nfc(U"\u212B") == U"\u00C5");              // a single one
  CHECK(ml::nfd(U"\uAC01") == U"\u1100\u1161\u11A8");  // Hangul
  CHECK(ml::nfc(U"\u1100\u1161\u11A8") == U"\uAC01");
  CHECK(ml::nfc(U"a\u0301\u0300") == U"\u00E1\u0300");
  CHECK(ml::nfc(U"a\u0327\u0301") == U"\u00E1\u0327");  // the acute passes the cedilla
  CHECK(ml::nfc(U"a\u0345\u0300b\u0301") == U"\u00E0\u0345b\u0301");
  CHECK(ml::nfc(U"\u0301a") == U"\u0301a");
  CHECK(ml::nfc(U"").empty());
}

TEST_CASE("lower case: single characters, U+0130, the final sigma") {
  CHECK(ml::lower_case(U'Z') == U'z');
  CHECK(ml::lower_case(char32_t{0x178}) == 0xFF);
  CHECK(ml::lower_case(char32_t{0x101}) == 0x101);
  CHECK(ml::lower_case(char32_t{0x10400}) == 0x10428);
  CHECK(ml::lower_case(U"\u0130I") == U"i\u0307i");
  CHECK(ml::lower_case(U"\u039F\u03A3") == U"\u03BF\u03C2");
  CHECK(ml::lower_case(U"\u039F\u03A3", false) == U"\u03BF\u03C3");
  CHECK(ml::lower_case(U"\u039F\u03A3\u039F") == U"\u03BF\u03C3\u03BF");
  CHECK(ml::lower_case(U"\u03A3 \u039F\u03A3.\u039F \u039F.\u03A3'!") == U"\u03C3 \u03BF\u03C3.\u03BF \u03BF.\u03C2'!");
}

TEST_CASE("UTF-8 and UTF-32: what is not UTF-8 becomes U+FFFD") {
  CHECK(ml::to_utf32("a\xC3\xA9\xF0\x9F\x8F\x83") == U"a\u00E9\U0001F3C3");
  CHECK(ml::to_utf32("a\xC3(\xED\xA0\x80") == U"a\uFFFD(\uFFFD\uFFFD\uFFFD");
  CHECK(ml::to_utf8(U"a\u00E9\U0001F3C3") == "a\xC3\xA9\xF0\x9F\x8F\x83");
}

TEST_CASE("unicode: every code point as utf8proc has it") {
#ifndef MOTIONLANG_TEST_UTF8PROC
  MESSAGE("skipped: utf8proc is not installed (Debian: libutf8proc-dev)");
#else
  if (std::string_view(utf8proc_unicode_version()) != ml::detail::unicode_version) {
    MESSAGE("skipped: utf8proc has Unicode ", utf8proc_unicode_version(), ", the tables ", ml::detail::unicode_version);
    return;
  }
  const auto normal = [](std::u32string_view text, utf8proc_option_t form) {
    const std::string bytes = ml::to_utf8(text);
    utf8proc_uint8_t* out = nullptr;
    const auto size = utf8proc_map(reinterpret_cast<const utf8proc_uint8_t*>(bytes.data()),
                                   static_cast<utf8proc_ssize_t>(bytes.size()), &out,
                                   static_cast<utf8proc_option_t>(UTF8PROC_STABLE | form));
    REQUIRE(size >= 0);
    const auto result = ml::to_utf32({reinterpret_cast<const char*>(out), static_cast<std::size_t>(size)});
    std::free(out);
    return result;
  };
  int wrong = 0;
  std::u32string marks;  // what changes or combines, for the sequences below
  for (char32_t c = 0; c <= 0x10FFFF; ++c) {
    const auto code = static_cast<utf8proc_int32_t>(c);
    const std::string_view category = utf8proc_category_string(code);
    unsigned want = 0;
    if (category[0] == 'L') want |= cc::letter;
    if (category[0] == 'N') want |= cc::number;
    if (category[0] == 'P') want |= cc::punctuation;
    if (category == "Mn") want |= cc::nonspacing_mark;
    if (category[0] == 'C' && category != "Cn") want |= cc::other;
    constexpr unsigned compared = cc::letter | cc::number | cc::punctuation | cc::nonspacing_mark | cc::other;
    const bool separator = category[0] == 'Z' || (c >= 9 && c <= 13) || c == 0x85;
    wrong += (ml::char_class(c) & compared) != want;
    wrong += ((ml::char_class(c) & cc::white_space) != 0) != separator;
    wrong += ml::lower_case(c) != static_cast<char32_t>(utf8proc_tolower(code));
    const auto combining = static_cast<unsigned>(utf8proc_get_property(code)->combining_class);
    wrong += ml::combining_class(c) != combining;
    if (c >= 0xD800 && c <= 0xDFFF) continue;
    const std::u32string one(1, c);
    const auto apart = normal(one, UTF8PROC_DECOMPOSE), together = normal(one, UTF8PROC_COMPOSE);
    wrong += ml::nfd(one) != apart;
    wrong += ml::nfc(one) != together;
    if (combining != 0 || apart != one) marks += c;
  }
  CHECK(wrong == 0);
  REQUIRE(marks.size() > 10000);

  std::mt19937 rng(1);
  for (int i = 0; i < 100000; ++i) {
    std::u32string text;
    for (int k = 0; k < 8; ++k)
      text +=
          rng() % 3 == 0 ? U"aeiouAEIOU\u0300\u0301\u0323\u1100\u1161\u11A8"[rng() % 16] : marks[rng() % marks.size()];
    const std::u32string apart = ml::nfd(text);
    wrong += apart != normal(text, UTF8PROC_DECOMPOSE);
    wrong += ml::nfc(text) != normal(text, UTF8PROC_COMPOSE);
    wrong += ml::nfc(apart) != ml::nfc(text);
  }
  CHECK(wrong == 0);
#endif
}
