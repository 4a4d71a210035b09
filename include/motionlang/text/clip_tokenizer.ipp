// SPDX-License-Identifier: MIT
// Bodies of clip_tokenizer.hpp.
#pragma once

#include <algorithm>  // all_of, find
#include <mutex>      // the memory of words

#include <motionlang/text/clip_tokenizer.hpp>
#include <motionlang/text/detail/byte_pairs.hpp>
#include <motionlang/text/text_repair.hpp>
#include <motionlang/text/unicode.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY ClipTokenizer::ClipTokenizer(const BytePairMerges& merges, const ClipTokenizerOptions& options,
                                             std::string_view source)
    : ClipTokenizer(openai_pieces(merges, options), merges, options, source) {}

MOTIONLANG_BODY ClipTokenizer::ClipTokenizer(std::vector<std::string> pieces, const BytePairMerges& merges,
                                             ClipTokenizerOptions options, std::string_view source,
                                             const std::vector<AddedToken>& added)
    : options_(std::move(options)) {
  const auto id_of = [&](const std::string& piece) {
    return static_cast<Index>(std::find(pieces.begin(), pieces.end(), piece) - pieces.begin());
  };
  const Index count = static_cast<Index>(pieces.size());
  begin_ = id_of(options_.begin), end_ = id_of(options_.end);
  for (const Index id : {begin_, end_}) {
    if (id == count)
      raise<config_error>(107, source, ": ", count, " pieces lack '", id == begin_ ? options_.begin : options_.end,
                          "'");
  }
  const Index unknown = options_.unknown.empty() ? count : id_of(options_.unknown);
  pairs_ = std::make_shared<const detail::BytePairs>(pieces, merges, options_.word_end,
                                                     unknown == count ? Index{-1} : unknown, source);
  pieces_ = std::make_shared<const std::vector<std::string>>(std::move(pieces));
  cache_ = std::make_shared<detail::WordCache>(options_.cached_words);
  std::vector<AddedToken> before, after;
  for (AddedToken t : added) {
    if (t.id < 0 || t.id >= count) raise<config_error>(107, source, ": id ", t.id, " among ", count, " pieces");
    if (t.normalized) t.content = cleaned(t.content);
    (t.normalized ? after : before).push_back(std::move(t));
  }
  raw_ = detail::AddedTokenSearch(std::move(before));
  cleaned_ = detail::AddedTokenSearch(std::move(after));
  using enum FramePart::Kind;
  set_frames({{token, begin_}, {text_a}, {token, end_}},
             {{token, begin_}, {text_a}, {token, end_}, {token, end_}, {text_b}, {token, end_}}, source);
}

MOTIONLANG_BODY void ClipTokenizer::set_frames(std::vector<FramePart> single, std::vector<FramePart> pair,
                                               std::string_view source) {
  for (const auto* frame : {&single, &pair}) {
    for (const FramePart& part : *frame) {
      if (part.kind == FramePart::token && (part.id < 0 || part.id >= size()))
        raise<config_error>(107, source, ": id ", part.id, " among ", size(), " pieces");
    }
    if (options_.longest < static_cast<Index>(detail::frame_size(*frame)))
      raise<config_error>(101, source, ": at most ", options_.longest, " ids, the frame has ",
                          detail::frame_size(*frame));
  }
  single_ = std::move(single), pair_ = std::move(pair);
}

MOTIONLANG_BODY std::vector<Index> ClipTokenizer::encode(std::string_view text) const {
  return detail::framed_text("ClipTokenizer", single_, encode_words(text), options_.longest, options_.truncate);
}

MOTIONLANG_BODY TokenPair ClipTokenizer::encode_pair(std::string_view a, std::string_view b) const {
  return detail::framed_pair("ClipTokenizer", pair_, encode_words(a), encode_words(b), options_.longest);
}

MOTIONLANG_BODY std::vector<Index> ClipTokenizer::encode_words(std::string_view text) const {
  std::vector<Index> ids;
  const std::unique_lock lock(cache_->mutex, std::try_to_lock);  // a second thread works without the cache
  detail::WordCache* cache = lock.owns_lock() ? cache_.get() : nullptr;
  const auto special = [&](Index id) { ids.push_back(id); };
  raw_.split(
      text,
      [&](std::string_view part) {
        const std::string clean = cleaned(part);
        cleaned_.split(
            clean, [&](std::string_view words) { append_words(ids, words, cache); }, special);
      },
      special);
  return ids;
}

MOTIONLANG_BODY std::string ClipTokenizer::decode(std::span<const Index> ids) const {
  std::string out;
  for (const Index id : ids) {
    if (id < 0 || id >= size()) raise<shape_error>(203, "ClipTokenizer: id ", id, " of ", size());
    if (id == begin_ || id == end_ || raw_.has(id) || cleaned_.has(id)) continue;
    std::string_view piece = (*pieces_)[static_cast<std::size_t>(id)];
    const bool last = !options_.word_end.empty() && piece.ends_with(options_.word_end);
    if (last) piece.remove_suffix(options_.word_end.size());
    for (std::size_t at = 0; at < piece.size();) {
      const auto byte = detail::ByteSymbols::get().byte.find(decode_utf8(piece, at));
      if (byte != detail::ByteSymbols::get().byte.end()) out += static_cast<char>(byte->second);
    }
    if (last) out += ' ';
  }
  if (out.ends_with(' ')) out.pop_back();
  return out;
}

MOTIONLANG_BODY std::string ClipTokenizer::cleaned(std::string_view text) const {
  std::string kept;
  if (options_.cleaning == ClipCleaning::original) {
    kept = repair_text(text);
    if (kept.find('&') != kept.npos) kept = html_unescape(html_unescape(kept));
    text = kept;
  }
  const bool ascii = std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  std::string out;
  out.reserve(text.size());
  if (ascii) {
    for (const char c : text) {
      const bool white = (char_class(static_cast<unsigned char>(c)) & CharClass::white_space) != 0;
      if (!white)
        out += static_cast<char>(lower_case(char32_t{static_cast<unsigned char>(c)}));
      else if (!out.empty() && out.back() != ' ')
        out += ' ';
    }
    if (out.ends_with(' ')) out.pop_back();
    return out;
  }
  std::u32string single;
  const bool original = options_.cleaning == ClipCleaning::original;
  const std::u32string all = to_utf32(text);
  for (const char32_t c : original ? all : nfc(all)) {
    if ((char_class(c) & CharClass::white_space) == 0)
      single += c;
    else if (!single.empty() && single.back() != U' ')
      single += U' ';
  }
  if (single.ends_with(U' ')) single.pop_back();
  return to_utf8(lower_case(single, original));
}

MOTIONLANG_BODY std::vector<std::string> ClipTokenizer::openai_pieces(const BytePairMerges& merges,
                                                                      const ClipTokenizerOptions& options) {
  const detail::ByteSymbols& symbols = detail::ByteSymbols::get();
  std::vector<std::string> pieces;
  for (const char* end : {"", options.word_end.c_str()}) {
    for (const unsigned char b : symbols.in_order) pieces.push_back(symbols.symbol[b] + end);
  }
  for (const auto& [left, right] : merges) pieces.push_back(left + right);
  pieces.insert(pieces.end(), {options.begin, options.end});
  return pieces;
}

MOTIONLANG_BODY std::size_t ClipTokenizer::literal_at(std::string_view text) const {
  if (text.front() != '<' && text.front() != '\'') return 0;
  for (const std::string_view literal :
       {"<|startoftext|>", "<|endoftext|>", "'s", "'t", "'re", "'ve", "'m", "'ll", "'d"}) {
    if (const std::size_t size = folded_prefix(text, literal); size != 0) return size;
  }
  return 0;
}

MOTIONLANG_BODY std::size_t ClipTokenizer::folded_prefix(std::string_view text, std::string_view literal) const {
  std::size_t at = 0;
  for (const char c : literal) {
    if (at < text.size() && text[at] == c)
      ++at;
    else if (c == 's' && options_.cleaning == ClipCleaning::original && text.substr(at).starts_with("\xC5\xBF"))
      at += 2;
    else
      return 0;
  }
  return at;
}

MOTIONLANG_BODY void ClipTokenizer::append_words(std::vector<Index>& ids, std::string_view text,
                                                 detail::WordCache* cache) const {
  const auto kind_of = [&](char32_t c) {
    if (c == 0x345 && options_.cleaning == ClipCleaning::original) return CharClass::white_space;
    return char_class(c) & (CharClass::letter | CharClass::number | CharClass::white_space);
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = at;
    if (const std::size_t size = literal_at(text.substr(at)); size != 0) {
      at += size;
    } else {
      const unsigned kind = kind_of(decode_utf8(text, at));
      if (kind == CharClass::white_space) continue;
      for (std::size_t next = at; kind != CharClass::number && at < text.size(); at = next) {
        if (kind_of(decode_utf8(text, next)) != kind) break;
      }
    }
    append_word(ids, text.substr(begin, at - begin), cache);
  }
}

MOTIONLANG_BODY void ClipTokenizer::append_word(std::vector<Index>& ids, std::string_view word,
                                                detail::WordCache* cache) const {
  const bool marks = raw_.empty() && cleaned_.empty();  // added tokens have been taken out already
  if (marks && (word == options_.begin || word == options_.end)) {
    ids.push_back(word == options_.begin ? begin_ : end_);
    return;
  }
  if (const auto* known = cache != nullptr ? cache->find(word) : nullptr; known != nullptr) {
    ids.insert(ids.end(), known->begin(), known->end());
    return;
  }
  const std::size_t before = ids.size();
  pairs_->append(ids, word);
  if (cache != nullptr) cache->keep(word, std::span(ids).subspan(before));
}

MOTIONLANG_NAMESPACE_END
