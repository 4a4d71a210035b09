// SPDX-License-Identifier: MIT
// Bodies of text_repair.hpp.
#pragma once

#include <algorithm>      // all_of, min
#include <optional>       // no references
#include <unordered_map>  // entities
#include <utility>        // exchange

#include <motionlang/text/detail/html_entities.hpp>
#include <motionlang/text/detail/unicode_tables.hpp>
#include <motionlang/text/text_repair.hpp>
#include <motionlang/text/unicode.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The characters of Windows-1252 for the bytes 0x80 ... 0x9F; five of them are undefined and stay.
constexpr char32_t from_windows_1252(char32_t c) {
  constexpr char16_t shown[] = {0x20AC, 0x81,   0x201A, 0x192,  0x201E, 0x2026, 0x2020, 0x2021, 0x2C6,  0x2030, 0x160,
                                0x2039, 0x152,  0x8D,   0x17D,  0x8F,   0x90,   0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
                                0x2013, 0x2014, 0x2DC,  0x2122, 0x161,  0x203A, 0x153,  0x9D,   0x17E,  0x178};
  return c >= 0x80 && c < 0xA0 ? shown[c - 0x80] : c;
}

struct HtmlEntity {
  std::string text;             // UTF-8
  bool bare = false;            // its semicolon may be missing
  bool only_in_repair = false;  // a name in capitals that HTML does not know
};

inline const std::unordered_map<std::string_view, HtmlEntity>& html_entity_table() {
  static const auto table = [] {
    std::unordered_map<std::string_view, HtmlEntity> out;
    for (std::string_view rest = html_entities; !rest.empty();) {
      std::string_view name = rest.substr(0, rest.find(' '));
      std::string_view points = rest.substr(name.size() + 1, rest.find(',') - name.size() - 1);
      rest.remove_prefix(rest.find(',') + 1);
      HtmlEntity e;
      e.bare = name.ends_with('?'), e.only_in_repair = name.starts_with('^');
      name = name.substr(e.only_in_repair, name.size() - e.bare - e.only_in_repair);
      char32_t c = 0;
      for (const char digit : points) {
        if (digit == '+')
          append_utf8(e.text, std::exchange(c, 0));
        else
          c = c * 16 + static_cast<char32_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
      }
      append_utf8(e.text, c);
      out.emplace(name, std::move(e));
    }
    return out;
  }();
  return table;
}

/// A numeric character reference at text[at] == '&': its text, and the place after it. Nothing if there is no digit.
struct Reference {
  std::string text;
  std::size_t end = 0;
};

inline std::optional<Reference> numeric_reference(std::string_view text, std::size_t at) {
  if (at + 2 >= text.size() || text[at + 1] != '#') return std::nullopt;
  const bool hexadecimal = (text[at + 2] | 0x20) == 'x';
  const std::size_t first = at + (hexadecimal ? 3 : 2);
  std::size_t end = first;
  char32_t c = 0;
  for (; end < text.size(); ++end) {
    const char lower = static_cast<char>(text[end] | 0x20), plain = text[end];
    const bool digit = plain >= '0' && plain <= '9';
    if (!digit && !(hexadecimal && lower >= 'a' && lower <= 'f')) break;
    c = c * (hexadecimal ? 16 : 10) + static_cast<char32_t>(digit ? plain - '0' : lower - 'a' + 10);
    c = std::min<char32_t>(c, 0x110000);
  }
  if (end == first) return std::nullopt;
  Reference out{{}, end + (end < text.size() && text[end] == ';')};
  c = from_windows_1252(c);
  const bool refused = (c >= 1 && c <= 8) || c == 0xB || (c >= 0xE && c <= 0x1F) || c == 0x7F ||
                       (c >= 0xFDD0 && c <= 0xFDEF) || (c & 0xFFFE) == 0xFFFE;
  if (c == 0 || (c >= 0xD800 && c <= 0xDFFF) || c > 0x10FFFF)
    append_utf8(out.text, 0xFFFD);
  else if (!refused)
    append_utf8(out.text, c);
  return out;
}

constexpr bool is_ascii_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z');
}

/// Replaces what `reference(text, at)` reads at every '&'.
template <class F>
std::string replace_references(std::string_view text, F reference) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t next = std::min(text.find('&', at), text.size());
    out += text.substr(at, next - at);
    at = next;
    if (at == text.size()) break;
    if (const std::optional<Reference> r = reference(text, at)) {
      out += r->text;
      at = r->end;
    } else {
      out += text[at++];
    }
  }
  return out;
}

/// The stricter reading of entities in the repair: they end in ';', and a numeric one has only digits.
inline std::string unescape_closed_references(std::string_view text) {
  return replace_references(text, [](std::string_view t, std::size_t at) -> std::optional<Reference> {
    const bool numeric = t.substr(at + 1).starts_with('#');
    const std::size_t first = at + 1 + numeric;
    std::size_t end = first;
    while (end < t.size() && is_ascii_alphanumeric(t[end])) ++end;
    if (end == first || end - first > 24 || end == t.size() || t[end] != ';') return std::nullopt;
    if (numeric) {
      auto r = numeric_reference(t, at);
      return r && r->end == end + 1 && r->text != ";" ? r : std::nullopt;
    }
    const auto found = html_entity_table().find(t.substr(first, end - first));
    return found == html_entity_table().end() ? std::nullopt : std::optional(Reference{found->second.text, end + 1});
  });
}

/// Letters of ligatures and digraphs; empty for any other character.
constexpr std::u32string_view ligature_letters(char32_t c) {
  switch (c) {
    case 0x132:
      return U"IJ";
    case 0x133:
      return U"ij";
    case 0x149:
      return U"\u02BCn";
    case 0x1C4:
      return U"D\u017D";
    case 0x1C5:
      return U"D\u017E";
    case 0x1C6:
      return U"d\u017E";
    case 0x1C7:
      return U"LJ";
    case 0x1C8:
      return U"Lj";
    case 0x1C9:
      return U"lj";
    case 0x1CA:
      return U"NJ";
    case 0x1CB:
      return U"Nj";
    case 0x1CC:
      return U"nj";
    case 0x1F1:
      return U"DZ";
    case 0x1F2:
      return U"Dz";
    case 0x1F3:
      return U"dz";
    case 0xFB00:
      return U"ff";
    case 0xFB01:
      return U"fi";
    case 0xFB02:
      return U"fl";
    case 0xFB03:
      return U"ffi";
    case 0xFB04:
      return U"ffl";
    case 0xFB05:
      return U"\u017Ft";
    case 0xFB06:
      return U"st";
    default:
      return {};
  }
}

/// NFKC of U+3000 and U+FF01 ... U+FFEF; U+FFE3 becomes two characters, of which this is the second.
constexpr char32_t narrow_form(char32_t c) {
  if (c == 0x3000) return U' ';
  if (c >= 0xFF01 && c <= 0xFF5E) return c - 0xFEE0;
  if (c == 0xFFE3) return 0x304;
  return c >= 0xFF5F && c <= 0xFFEF ? narrow_forms[c - 0xFF5F] : c;
}

constexpr char32_t straight_quote(char32_t c) {
  if (c == 0x2BC || (c >= 0x2018 && c <= 0x201B)) return U'\'';
  return c >= 0x201C && c <= 0x201F ? U'"' : c;
}

constexpr bool is_removed_control(char32_t c) {
  return c <= 8 || c == 0xB || (c >= 0xE && c <= 0x1F) || c == 0x7F || (c >= 0x206A && c <= 0x206F) || c == 0xFEFF ||
         (c >= 0xFFF9 && c <= 0xFFFC);
}

/// The place after a terminal escape (ESC [ digits and semicolons, a letter) at text[at]; `at` if there is none.
inline std::size_t escape_end(std::u32string_view text, std::size_t at) {
  if (text[at] != 0x1B || at + 1 >= text.size() || text[at + 1] != U'[') return at;
  std::size_t end = at + 2;
  while (end < text.size() && ((text[end] >= U'0' && text[end] <= U'9') || text[end] == U';')) ++end;
  const bool letter = end < text.size() && text[end] < 0x80 && (char_class(text[end]) & CharClass::letter) != 0;
  return letter ? end + 1 : at;
}

/// The steps of ftfy's fix_text that follow the HTML entities, once.
inline std::u32string repaired_once(std::u32string_view text) {
  std::u32string plain;
  for (const char32_t c : text) {
    if (const auto letters = ligature_letters(c); !letters.empty()) {
      for (const char32_t l : letters) plain += straight_quote(l);
      continue;
    }
    if (c == 0xFFE3) plain += U' ';
    plain += straight_quote(narrow_form(from_windows_1252(c)));
  }
  std::u32string out;
  for (std::size_t at = 0; at < plain.size();) {
    if (const std::size_t end = escape_end(plain, at); end > at) {
      at = end;
      continue;
    }
    const char32_t c = plain[at++];
    if (c == U'\r' && at < plain.size() && plain[at] == U'\n') continue;
    if (c == U'\r' || c == 0x2028 || c == 0x2029 || c == 0x85)
      out += U'\n';
    else if (!is_removed_control(c))
      out += c;
  }
  return nfc(out);
}

}  // namespace detail

MOTIONLANG_BODY std::string html_unescape(std::string_view text) {
  return detail::replace_references(text, [](std::string_view t, std::size_t at) -> std::optional<detail::Reference> {
    if (auto numeric = detail::numeric_reference(t, at)) return numeric;
    const std::size_t first = at + 1;
    std::size_t end = first;
    while (end < t.size() && end - first < 32 && detail::is_ascii_alphanumeric(t[end])) ++end;
    const bool closed = end < t.size() && t[end] == ';';
    const auto& table = detail::html_entity_table();
    for (std::size_t length = end - first; length > 1; --length) {
      const auto found = table.find(t.substr(first, length));
      if (found == table.end() || found->second.only_in_repair) continue;
      const bool with_semicolon = closed && first + length == end;
      if (with_semicolon || found->second.bare)
        return detail::Reference{found->second.text, first + length + with_semicolon};
    }
    return std::nullopt;
  });
}

MOTIONLANG_BODY std::string repair_text(std::string_view text) {
  const auto plain = [](char c) { return (c >= ' ' && c <= '~' && c != '&') || c == '\n' || c == '\t'; };
  if (std::all_of(text.begin(), text.end(), plain)) return std::string(text);
  std::string out;
  bool markup = false;
  while (!text.empty()) {
    const std::size_t size = std::min(text.find('\n'), text.size() - 1) + 1;
    std::string line = to_utf8(to_utf32(text.substr(0, size)));
    text.remove_prefix(size);
    markup = markup || line.find('<') != line.npos;
    for (int round = 0; round < 100; ++round) {
      std::string next =
          to_utf8(detail::repaired_once(to_utf32(markup ? line : detail::unescape_closed_references(line))));
      if (next == line) break;
      line = std::move(next);
    }
    out += line;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
