// SPDX-License-Identifier: MIT
// Bodies of unicode.hpp.
#pragma once

#include <algorithm>  // upper_bound, stable_sort
#include <array>      // the first 256
#include <span>       // tables

#include <motionlang/text/detail/unicode_tables.hpp>
#include <motionlang/text/unicode.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The row of a table of disjoint stretches, ordered by `first`, that holds c; null if none does.
template <class Run>
const Run* find_run(std::span<const Run> table, char32_t c) {
  const auto after =
      std::upper_bound(table.begin(), table.end(), c, [](char32_t x, const Run& run) { return x < run.first; });
  return after != table.begin() && c <= (after - 1)->last ? &*(after - 1) : nullptr;
}

inline unsigned searched_class(char32_t c) {
  const std::span<const std::uint32_t> runs(class_runs);
  return *(std::upper_bound(runs.begin(), runs.end(), c << 8 | 255u) - 1) & 255u;
}

inline constexpr auto first_classes = [] {
  std::array<std::uint8_t, 256> classes{};
  const std::span<const std::uint32_t> runs(class_runs);
  for (std::size_t i = 0, c = 0; c < classes.size(); ++c) {
    while (i + 1 < runs.size() && runs[i + 1] >> 8 <= c) ++i;
    classes[c] = static_cast<std::uint8_t>(runs[i]);
  }
  return classes;
}();

}  // namespace detail

MOTIONLANG_BODY unsigned char_class(char32_t c) {
  return c < 256 ? detail::first_classes[c] : c <= 0x10FFFF ? detail::searched_class(c) : 0u;
}

MOTIONLANG_BODY char32_t lower_case(char32_t c) {
  if (c < 0x80) return c >= 'A' && c <= 'Z' ? c + 32 : c;
  const auto* run = detail::find_run<detail::LowerRun>(detail::lower_runs, c);
  if (run == nullptr || (c - run->first) % run->step != 0) return c;
  return static_cast<char32_t>(static_cast<std::int32_t>(c) + run->difference);
}

MOTIONLANG_BODY unsigned combining_class(char32_t c) {
  const auto* run = c < 0x300 ? nullptr : detail::find_run<detail::CombiningRun>(detail::combining_runs, c);
  return run == nullptr ? 0 : run->combining;
}

MOTIONLANG_BODY std::u32string to_utf32(std::string_view text) {
  std::u32string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = decode_utf8(text, at);
    out += c == invalid_code_point ? U'\uFFFD' : c;
  }
  return out;
}

MOTIONLANG_BODY std::string to_utf8(std::u32string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char32_t c : text) append_utf8(out, c);
  return out;
}

namespace detail {

inline constexpr char32_t hangul = 0xAC00, jamo_l = 0x1100, jamo_v = 0x1161, jamo_t = 0x11A7;

inline constexpr char32_t jamo_v_count = 21, jamo_t_count = 28, hangul_count = 19 * jamo_v_count * jamo_t_count;

inline void append_decomposed(std::u32string& out, char32_t c) {
  if (c < 0xC0) {
    out += c;
  } else if (c - hangul < hangul_count) {
    const char32_t s = c - hangul, t = s % jamo_t_count;
    const char32_t v = s / jamo_t_count % jamo_v_count, l = s / (jamo_v_count * jamo_t_count);
    out += jamo_l + l;
    out += jamo_v + v;
    if (t != 0) out += jamo_t + t;
  } else {
    const std::span<const Decomposition> table(decompositions);
    const auto found = std::lower_bound(table.begin(), table.end(), c,
                                        [](const Decomposition& d, char32_t x) { return d.composed < x; });
    if (found == table.end() || found->composed != c) {
      out += c;
      return;
    }
    append_decomposed(out, found->first);
    if (found->second != 0) append_decomposed(out, found->second);
  }
}

/// The composition of two code points, 0 if there is none.
inline char32_t composed(char32_t first, char32_t second) {
  if (second < 0x300) return 0;  // marks begin there
  if (first - jamo_l < 19 && second - jamo_v < jamo_v_count)
    return hangul + ((first - jamo_l) * jamo_v_count + (second - jamo_v)) * jamo_t_count;
  if (first - hangul < hangul_count && (first - hangul) % jamo_t_count == 0 && second - jamo_t - 1 < jamo_t_count - 1)
    return first + (second - jamo_t);
  const std::span<const std::uint16_t> table(compositions);
  const auto before = [&](std::uint16_t i, char32_t) {
    const Decomposition& d = decompositions[i];
    return d.first < first || (d.first == first && d.second < second);
  };
  const auto found = std::lower_bound(table.begin(), table.end(), first, before);
  if (found == table.end()) return 0;
  const Decomposition& d = decompositions[*found];
  return d.first == first && d.second == second ? d.composed : 0;
}

}  // namespace detail

MOTIONLANG_BODY std::u32string nfd(std::u32string_view text) {
  if (std::all_of(text.begin(), text.end(), [](char32_t c) { return c < 0xC0; })) return std::u32string(text);
  std::u32string out;
  out.reserve(text.size());
  for (const char32_t c : text) detail::append_decomposed(out, c);
  for (std::size_t at = 0; at < out.size();) {
    std::size_t end = at;
    while (end < out.size() && combining_class(out[end]) != 0) ++end;
    std::stable_sort(out.begin() + static_cast<std::ptrdiff_t>(at), out.begin() + static_cast<std::ptrdiff_t>(end),
                     [](char32_t a, char32_t b) { return combining_class(a) < combining_class(b); });
    at = end + 1;
  }
  return out;
}

MOTIONLANG_BODY std::u32string nfc(std::u32string_view text) {
  if (std::all_of(text.begin(), text.end(), [](char32_t c) { return c < 0x300; })) return std::u32string(text);
  std::u32string out = nfd(text);
  std::size_t size = 0, starter = 0;
  bool has_starter = false;
  unsigned last = 0;  // class of the last character kept behind the starter; 0: none, or another starter
  for (const char32_t c : out) {
    const unsigned combining = combining_class(c);
    // c can be reached from the starter if no character between them has its class or is a starter itself.
    const bool adjacent = size == starter + 1;
    if (has_starter && (adjacent || (last != 0 && last < combining))) {
      if (const char32_t both = detail::composed(out[starter], c); both != 0) {
        out[starter] = both;
        continue;
      }
    }
    if (combining == 0) starter = size, has_starter = true;
    last = combining;
    out[size++] = c;
  }
  out.resize(size);
  return out;
}

MOTIONLANG_BODY std::u32string lower_case(std::u32string_view text, bool final_sigma) {
  std::u32string out;
  out.reserve(text.size());
  bool after_cased = false;  // the last character that is not case-ignorable is cased
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char32_t c = text[i];
    if (c == 0x130) {
      out += U"i\u0307";
    } else if (c == 0x3A3 && final_sigma && after_cased) {
      std::size_t next = i + 1;
      while (next < text.size() && (char_class(text[next]) & CharClass::case_ignorable) != 0) ++next;
      const bool inside = next < text.size() && (char_class(text[next]) & CharClass::cased) != 0;
      out += inside ? U'\u03C3' : U'\u03C2';
    } else {
      out += lower_case(c);
    }
    if (const unsigned k = char_class(c); (k & CharClass::case_ignorable) == 0)
      after_cased = (k & CharClass::cased) != 0;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
