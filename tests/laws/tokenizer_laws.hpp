// SPDX-License-Identifier: MIT
/// Laws of Tokenizer:
///
///     range     every id is at least 0 and below size()
///     same      a text has the same ids whenever it is asked for, of a copy as well
///     frame     the ids of "" are the frame; those of any text begin and end as they do
///     batch     the ids of several texts are those of each, one text after the other
///     bytes     any bytes are a text: what is not UTF-8 counts as U+FFFD
///     length    a text is cut to any length that has room for the frames of one text and of two, and keeps its frame;
///               a length without that room is refused
///     decoding  the ids of a decoded text are those it was decoded from
#pragma once

#include <doctest/doctest.h>

#include <motionlang/core/utf8.hpp>
#include <motionlang/text/tokenizer.hpp>

#include "../support/check_error.hpp"

namespace laws {

namespace ml = motionlang;
using Ids = std::vector<ml::Index>;

/// The text with U+FFFD for every byte that is not UTF-8.
inline std::string valid_utf8(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = ml::decode_utf8(text, at);
    ml::append_utf8(out, c == ml::invalid_code_point ? 0xFFFD : c);
  }
  return out;
}

template <ml::Tokenizer T>
void tokenizer_laws(const T& tokenizer) {
  using namespace std::string_literals;
  // clang-format off
  const std::vector<std::string> texts{"walk forward", "", " \t\r\n ", "Sit down, and raise both arms!", "walk forward",
                                       "person's 12 jumps", "caf\u00e9 \u8d70\u8def \U0001F3C3 na\u0131ve",
                                       "an-unheard_of/word", "\xFF", "walk\xC3", "wa\xFFlk \xE2\x82 forward",
                                       "\xED\xA0\x80 \xF5\x80\x80\x80 \xC0\xAF", "a\0b"s, std::string(300, 'x')};
  // clang-format on
  const Ids frame = tokenizer.encode("");
  REQUIRE(frame.size() >= 2);
  const T copy = tokenizer;
  std::vector<Ids> alone;
  for (const std::string& text : texts) {
    CAPTURE(text);
    const Ids ids = tokenizer.encode(text);
    REQUIRE(ids.size() >= frame.size());
    CHECK(ids.front() == frame.front());
    CHECK(ids.back() == frame.back());
    for (const ml::Index id : ids) CHECK((id >= 0 && id < tokenizer.size()));
    CHECK(tokenizer.encode(text) == ids);
    CHECK(copy.encode(text) == ids);
    CHECK(tokenizer.encode(valid_utf8(text)) == ids);
    alone.push_back(ids);
  }
  CHECK(alone.front() == alone[4]);
  CHECK(alone.front() != frame);
  CHECK(alone[2] == frame);  // white space

  const ml::TokenBatch batch = ml::tokenize(tokenizer, texts);
  REQUIRE(batch.count() == std::ssize(texts));
  const ml::Index pad = tokenizer.size();  // as no text has it
  const Ids padded = batch.padded(pad);
  auto at = batch.ids.begin();
  for (std::size_t i = 0; i < texts.size(); ++i) {
    CHECK(batch.lengths[i] == std::ssize(alone[i]));
    CHECK(Ids(at, at + batch.lengths[i]) == alone[i]);
    at += batch.lengths[i];
    Ids row = alone[i];
    row.resize(static_cast<std::size_t>(batch.longest()), pad);
    CHECK(std::equal(row.begin(), row.end(), padded.begin() + static_cast<std::ptrdiff_t>(i) * batch.longest()));
  }
  CHECK(at == batch.ids.end());
  CHECK(ml::tokenize(tokenizer, std::span<const std::string>()).count() == 0);
}

/// encode(text, longest): the ids of a text that may be cut. The frame of one text has two ids, the larger one `least`;
/// lengths without room for it are refused.
template <class Encode>
void length_law(std::string_view text, std::size_t least, Encode encode) {
  const Ids whole = encode(text, 1000);
  REQUIRE(whole.size() > 4);
  for (std::size_t longest = least; longest < whole.size() + 2; ++longest) {
    Ids expected = whole;
    if (longest < whole.size())
      expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(longest) - 1, expected.end() - 1);
    CHECK(encode(text, static_cast<ml::Index>(longest)) == expected);
  }
  CHECK(encode("", static_cast<ml::Index>(least)).size() == 2);
  for (ml::Index longest = static_cast<ml::Index>(least) - 1; longest > -3; --longest)
    CHECK_ERROR(encode(text, longest), "[motionlang.config.101]");
}

/// `text` is spelt as decode spells.
template <ml::Tokenizer T>
void decoding_law(const T& tokenizer, std::string_view text) {
  const Ids ids = tokenizer.encode(text);
  CHECK(tokenizer.decode(ids) == text);
  CHECK(tokenizer.decode(tokenizer.encode("")).empty());
  CHECK(tokenizer.encode(tokenizer.decode(ids)) == ids);
}

}  // namespace laws
