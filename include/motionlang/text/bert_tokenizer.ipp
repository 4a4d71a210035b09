// SPDX-License-Identifier: MIT
// Bodies of bert_tokenizer.hpp.
#pragma once

#include <algorithm>  // any_of, max

#include <motionlang/text/bert_tokenizer.hpp>
#include <motionlang/text/detail/longest_pieces.hpp>
#include <motionlang/text/unicode.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY BertTokenizerOptions BertTokenizerOptions::mpnet() {
  BertTokenizerOptions o;
  o.begin = "<s>", o.end = "</s>", o.pad = "<pad>";
  o.special = {"<s>", "<pad>", "</s>", "<unk>", "[UNK]", "<mask>"};
  o.pair_has_types = false, o.pair_has_two_ends = true;
  return o;
}

MOTIONLANG_BODY std::vector<std::string> mpnet_vocabulary(std::span<const std::string> bert) {
  std::vector<std::string> out{"<s>", "<pad>", "</s>", "<unk>"};
  out.insert(out.end(), bert.begin(), bert.end());
  out.emplace_back("<mask>");
  return out;
}

MOTIONLANG_BODY BertTokenizer::BertTokenizer(std::vector<std::string> vocabulary, BertTokenizerOptions options,
                                             std::string_view source, std::optional<std::vector<AddedToken>> added)
    : options_(std::move(options)), pieces_(std::make_shared<const std::vector<std::string>>(std::move(vocabulary))) {
  index_pieces(source);
  begin_ = required(options_.begin, source), end_ = required(options_.end, source);
  unknown_ = required(options_.unknown, source);
  using enum FramePart::Kind;
  const Index second = options_.pair_has_types ? 1 : 0;
  single_ = {{token, begin_, 0}, {text_a}, {token, end_, 0}};
  pair_ = {{token, begin_, 0}, {text_a}, {token, end_, 0}};
  if (options_.pair_has_two_ends) pair_.push_back({token, end_, 0});
  pair_.insert(pair_.end(), {{text_b, 0, second}, {token, end_, second}});
  set_added(added ? std::move(*added) : specials(), source);
  require_room(single_, pair_, source);
}

MOTIONLANG_BODY std::optional<Index> BertTokenizer::id(std::string_view piece) const {
  const bool continues = !options_.continuation.empty() && piece.starts_with(options_.continuation);
  if (continues) piece.remove_prefix(options_.continuation.size());
  const Index found = find(piece, !continues);
  return found < 0 ? std::nullopt : std::optional(found);
}

MOTIONLANG_BODY Index BertTokenizer::pad_id() const {
  if (const auto found = id(options_.pad)) return *found;
  raise<config_error>(103, "BertTokenizer: the vocabulary has no piece '", options_.pad, "' for padding");
}

MOTIONLANG_BODY void BertTokenizer::set_frames(std::vector<FramePart> single, std::vector<FramePart> pair,
                                               std::string_view source) {
  for (const auto* frame : {&single, &pair}) {
    for (const FramePart& part : *frame) {
      if (part.kind == FramePart::token) require_id(part.id, source);
    }
  }
  require_room(single, pair, source);
  single_ = std::move(single), pair_ = std::move(pair);
}

MOTIONLANG_BODY std::vector<Index> BertTokenizer::encode(std::string_view text) const {
  return detail::framed_text("BertTokenizer", single_, encode_words(text), options_.longest, options_.truncate);
}

MOTIONLANG_BODY TokenPair BertTokenizer::encode_pair(std::string_view a, std::string_view b) const {
  return detail::framed_pair("BertTokenizer", pair_, encode_words(a), encode_words(b), options_.longest);
}

MOTIONLANG_BODY std::vector<Index> BertTokenizer::encode_words(std::string_view text) const {
  std::vector<Index> ids;
  const auto special = [&](Index id) { ids.push_back(id); };
  raw_.split(
      text,
      [&](std::string_view part) {
        const std::string clean = normalized(part);
        if (normalized_.empty()) return append_words(ids, clean);
        normalized_.split(
            clean, [&](std::string_view words) { append_words(ids, words); }, special);
      },
      special);
  return ids;
}

MOTIONLANG_BODY std::string BertTokenizer::decode(std::span<const Index> ids) const {
  std::string out;
  for (const Index id : ids) {
    if (id < 0 || id >= size()) raise<shape_error>(203, "BertTokenizer: id ", id, " of ", size());
    if (raw_.has(id) || normalized_.has(id) || id == begin_ || id == end_) continue;
    std::string_view piece = (*pieces_)[static_cast<std::size_t>(id)];
    if (!options_.continuation.empty() && piece.starts_with(options_.continuation) && !out.empty())
      piece.remove_prefix(options_.continuation.size());
    else if (!out.empty())
      out += ' ';
    out += piece;
  }
  return out;
}

MOTIONLANG_BODY std::string BertTokenizer::normalized(std::string_view text) const {
  std::string out;
  out.reserve(text.size());
  for (const char byte : text) {
    const auto c = static_cast<unsigned char>(byte);
    if (c >= 0x80) return normalized_unicode(text);
    const unsigned k = char_class(c);
    if (options_.clean_text && (k & (CharClass::other | CharClass::white_space)) != 0) {
      if (is_blank(c, k)) out += ' ';
      continue;
    }
    out += options_.lower_case ? static_cast<char>(lower_case(char32_t{c})) : byte;
  }
  return out;
}

MOTIONLANG_BODY bool BertTokenizer::is_blank(char32_t c, unsigned k) {
  return c == '\t' || c == '\n' || c == '\r' || (k & CharClass::other) == 0;
}

MOTIONLANG_BODY bool BertTokenizer::is_cjk(char32_t c) {
  constexpr char32_t ranges[][2] = {{0x3400, 0x4DBF},   {0x4E00, 0x9FFF},   {0xF900, 0xFAFF},   {0x20000, 0x2A6DF},
                                    {0x2A700, 0x2B73F}, {0x2B740, 0x2B81F}, {0x2B920, 0x2CEAF}, {0x2F800, 0x2FA1F}};
  return std::any_of(std::begin(ranges), std::end(ranges), [&](const auto& r) { return c >= r[0] && c <= r[1]; });
}

MOTIONLANG_BODY bool BertTokenizer::is_punctuation(char32_t c, unsigned k) {
  if (c < 0x80) return c > 0x20 && c < 0x7F && (k & (CharClass::letter | CharClass::number)) == 0;
  return (k & CharClass::punctuation) != 0;
}

MOTIONLANG_BODY std::string BertTokenizer::normalized_unicode(std::string_view text) const {
  std::u32string clean;
  for (const char32_t c : to_utf32(text)) {
    const unsigned k = char_class(c);
    if (options_.clean_text && (c == 0xFFFD || (k & (CharClass::other | CharClass::white_space)) != 0)) {
      if (c != 0xFFFD && is_blank(c, k)) clean += U' ';
    } else if (options_.split_cjk && is_cjk(c)) {
      clean += {U' ', c, U' '};
    } else {
      clean += c;
    }
  }
  if (options_.strip_accents.value_or(options_.lower_case)) {
    clean = nfd(clean);
    std::erase_if(clean, [](char32_t c) { return (char_class(c) & CharClass::nonspacing_mark) != 0; });
  }
  return to_utf8(options_.lower_case ? lower_case(clean, false) : clean);
}

MOTIONLANG_BODY void BertTokenizer::append_words(std::vector<Index>& ids, std::string_view text) const {
  std::size_t begin = 0;
  Index letters = 0;  // of the word that begins there, in code points
  const auto flush = [&](std::size_t end) {
    if (letters > options_.longest_word) {
      ids.push_back(unknown_);
    } else if (letters > 0) {
      detail::append_longest_pieces(ids, text.substr(begin, end - begin), longest_, unknown_,
                                    [&](std::string_view part, bool first) { return find(part, first); });
    }
    letters = 0;
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t start = at;
    const char32_t c = decode_utf8(text, at);
    const unsigned k = char_class(c);
    const bool alone = is_punctuation(c, k);
    if (!alone && (k & CharClass::white_space) == 0) {
      if (letters++ == 0) begin = start;
      continue;
    }
    flush(start);
    if (!alone) continue;
    begin = start, letters = 1;
    flush(at);
  }
  flush(text.size());
}

MOTIONLANG_BODY Index BertTokenizer::find(std::string_view part, bool first) const {
  const auto& ids = first ? starts_ : continuations_;
  const auto found = ids.find(part);
  return found == ids.end() ? Index{-1} : found->second;
}

MOTIONLANG_BODY void BertTokenizer::index_pieces(std::string_view source) {
  for (std::size_t i = 0; i < pieces_->size(); ++i) {
    std::string_view piece = (*pieces_)[i];
    if (piece.empty() || !is_utf8(piece))
      raise<config_error>(107, source, ": piece ", i, piece.empty() ? " is empty" : " is not UTF-8");
    const bool continues = !options_.continuation.empty() && piece.starts_with(options_.continuation);
    if (continues) piece.remove_prefix(options_.continuation.size());
    if (!(continues ? continuations_ : starts_).emplace(piece, static_cast<Index>(i)).second)
      raise<config_error>(107, source, ": piece '", (*pieces_)[i], "' is duplicated, the second time as id ", i);
    longest_ = std::max(longest_, piece.size());
  }
}

MOTIONLANG_BODY Index BertTokenizer::required(const std::string& piece, std::string_view source) const {
  if (const auto found = id(piece)) return *found;
  raise<config_error>(107, source, ": a vocabulary of ", size(), " pieces lacks '", piece, "'");
}

MOTIONLANG_BODY void BertTokenizer::require_id(Index id, std::string_view source) const {
  if (id < 0 || id >= size()) raise<config_error>(107, source, ": id ", id, " among ", size(), " pieces");
}

MOTIONLANG_BODY void BertTokenizer::require_room(std::span<const FramePart> single, std::span<const FramePart> pair,
                                                 std::string_view source) const {
  const std::size_t frame = std::max(detail::frame_size(single), detail::frame_size(pair));
  if (options_.longest < static_cast<Index>(frame))
    raise<config_error>(101, source, ": at most ", options_.longest, " ids, the frame has ", frame);
}

MOTIONLANG_BODY std::vector<AddedToken> BertTokenizer::specials() const {
  std::vector<AddedToken> out;
  for (const std::string& piece : options_.special) {
    if (const auto found = id(piece)) out.push_back({piece, *found});
  }
  return out;
}

MOTIONLANG_BODY void BertTokenizer::set_added(std::vector<AddedToken> tokens, std::string_view source) {
  std::vector<AddedToken> before, after;
  for (AddedToken& t : tokens) {
    require_id(t.id, source);
    if (t.normalized) t.content = normalized(t.content);
    (t.normalized ? after : before).push_back(std::move(t));
  }
  raw_ = detail::AddedTokenSearch(std::move(before));
  normalized_ = detail::AddedTokenSearch(std::move(after));
}

MOTIONLANG_NAMESPACE_END
