// SPDX-License-Identifier: MIT
// Bodies of roberta_tokenizer.hpp.
#pragma once

#include <algorithm>  // find, all_of
#include <mutex>      // the memory of words

#include <motionlang/text/detail/byte_pairs.hpp>
#include <motionlang/text/roberta_tokenizer.hpp>
#include <motionlang/text/unicode.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY RobertaTokenizer::RobertaTokenizer(std::vector<std::string> pieces, const Merges& merges,
                                                   RobertaTokenizerOptions options, std::string_view source)
    : options_(std::move(options)) {
  const auto find = [&](const std::string& piece) -> Index {
    const auto found = std::find(pieces.begin(), pieces.end(), piece);
    return found == pieces.end() ? Index{-1} : static_cast<Index>(found - pieces.begin());
  };
  const auto required = [&](const std::string& piece) {
    const Index id = find(piece);
    if (id < 0) raise<config_error>(107, source, ": ", pieces.size(), " pieces lack '", piece, "'");
    return id;
  };
  const Index begin = required(options_.begin), end = required(options_.end);
  pad_ = required(options_.pad);
  std::vector<AddedToken> special;
  for (const std::string& token : options_.special) {
    if (const Index id = find(token); id >= 0) special.push_back({token, id});
  }
  special_ = detail::AddedTokenSearch(std::move(special));
  pairs_ = std::make_shared<const detail::BytePairs>(pieces, merges, "", find(options_.unknown), source);
  cache_ = std::make_shared<detail::WordCache>(options_.cached_words);
  pieces_ = std::make_shared<const std::vector<std::string>>(std::move(pieces));
  using enum FramePart::Kind;
  single_ = {{token, begin}, {text_a}, {token, end}};
  pair_ = {{token, begin}, {text_a}, {token, end}, {token, end}, {text_b}, {token, end}};
  if (const auto frame = static_cast<Index>(detail::frame_size(pair_)); options_.longest < frame)
    raise<config_error>(101, source, ": at most ", options_.longest, " ids, the frame has ", frame);
}

MOTIONLANG_BODY std::vector<Index> RobertaTokenizer::encode(std::string_view text) const {
  return detail::framed_text("RobertaTokenizer", single_, encode_words(text), options_.longest, options_.truncate);
}

MOTIONLANG_BODY TokenPair RobertaTokenizer::encode_pair(std::string_view a, std::string_view b) const {
  return detail::framed_pair("RobertaTokenizer", pair_, encode_words(a), encode_words(b), options_.longest);
}

MOTIONLANG_BODY std::vector<Index> RobertaTokenizer::encode_words(std::string_view text) const {
  std::vector<Index> ids;
  const std::unique_lock lock(cache_->mutex, std::try_to_lock);  // a second thread works without the cache
  detail::WordCache* cache = lock.owns_lock() ? cache_.get() : nullptr;
  special_.split(
      text, [&](std::string_view part) { append_words(ids, is_utf8(part) ? part : to_utf8(to_utf32(part)), cache); },
      [&](Index id) { ids.push_back(id); });
  return ids;
}

MOTIONLANG_BODY std::string RobertaTokenizer::decode(std::span<const Index> ids) const {
  std::string out;
  for (const Index id : ids) {
    if (id < 0 || id >= size()) raise<shape_error>(203, "RobertaTokenizer: id ", id, " of ", size());
    if (special_.has(id) || id == pad_ || id == single_.front().id || id == single_.back().id) continue;
    const std::string_view piece = (*pieces_)[static_cast<std::size_t>(id)];
    for (std::size_t at = 0; at < piece.size();) {
      const auto byte = detail::ByteSymbols::get().byte.find(decode_utf8(piece, at));
      if (byte != detail::ByteSymbols::get().byte.end()) out += static_cast<char>(byte->second);
    }
  }
  return out;
}

namespace detail {

/// The kind of the character at `at`, which moves behind it: a letter, a number, white space or another one.
inline unsigned word_kind(std::string_view text, std::size_t& at) {
  return char_class(decode_utf8(text, at)) & (CharClass::letter | CharClass::number | CharClass::white_space);
}

/// The end of the run of one kind that starts at `at`.
inline std::size_t end_of_run(std::string_view text, std::size_t at) {
  const unsigned kind = word_kind(text, at);
  for (std::size_t next = at; at < text.size(); at = next) {
    if (word_kind(text, next) != kind) break;
  }
  return at;
}

/// The end of the word of GPT-2 that starts at `at`:
///     's|'t|'re|'ve|'m|'ll|'d| ?\p{L}+| ?\p{N}+| ?[^\s\p{L}\p{N}]+|\s+(?!\S)|\s+
inline std::size_t end_of_word(std::string_view text, std::size_t at) {
  for (const std::string_view ending : {"'s", "'t", "'re", "'ve", "'m", "'ll", "'d"}) {
    if (text.substr(at).starts_with(ending)) return at + ending.size();
  }
  const auto is_white = [&](std::size_t place) { return word_kind(text, place) == CharClass::white_space; };
  if (!is_white(at)) return end_of_run(text, at);
  if (text[at] == ' ' && at + 1 < text.size() && !is_white(at + 1)) return end_of_run(text, at + 1);
  const std::size_t end = end_of_run(text, at);
  if (end == text.size()) return end;
  std::size_t last = at;  // the last character of the white space goes with the next word
  for (std::size_t next = at; next < end;) {
    last = next;
    word_kind(text, next);
  }
  return last > at ? last : end;
}

}  // namespace detail

MOTIONLANG_BODY void RobertaTokenizer::append_words(std::vector<Index>& ids, std::string_view text,
                                                    detail::WordCache* cache) const {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = detail::end_of_word(text, at);
    const std::string_view word = text.substr(at, end - at);
    at = end;
    if (const auto* known = cache != nullptr ? cache->find(word) : nullptr; known != nullptr) {
      ids.insert(ids.end(), known->begin(), known->end());
      continue;
    }
    const std::size_t before = ids.size();
    pairs_->append(ids, word);
    if (cache != nullptr) cache->keep(word, std::span(ids).subspan(before));
  }
}

MOTIONLANG_NAMESPACE_END
