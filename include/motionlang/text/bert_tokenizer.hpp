// SPDX-License-Identifier: MIT
/// The WordPiece tokenizer of BERT, DistilBERT and MiniLM, and its MPNet variant: ids as the fast tokenizers of Hugging
/// Face give them. Vocabularies are read by weights/tokenizer_files.hpp.
///
///     const BertTokenizer bert(read_vocabulary("vocab.txt"));
///     bert.encode("a person walks.");   // [CLS] a person walks . [SEP]
///
/// Source   Devlin et al. (2019), the published tokenizer; spec text-encoders.md 7 and 8
/// Differs  the tables are those of Unicode 15, in the fast tokenizers of Unicode 8: newer punctuation and newer
///          combining marks are known here
#pragma once

#include <memory>         // pieces that keep their place
#include <optional>       // strip_accents
#include <unordered_map>  // piece -> id

#include <motionlang/text/tokenizer.hpp>
#include <motionlang/text/unicode.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct BertTokenizerOptions {
  bool clean_text = true;  // drops control characters, any white space is a blank
  bool split_cjk = true;   // every ideograph is a word
  bool lower_case = true;
  std::optional<bool> strip_accents;  // unless set: as lower_case
  std::string begin = "[CLS]", end = "[SEP]", unknown = "[UNK]", pad = "[PAD]";
  std::string continuation = "##";  // in front of a piece that continues a word
  Index longest_word = 100;         // code points; a longer word is unknown
  /// Strings that are their own ids, in the order of preference; those that the vocabulary lacks are left out.
  std::vector<std::string> special{"[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]"};
  bool pair_has_types = true;      // the second text of a pair has token type 1
  bool pair_has_two_ends = false;  // between the texts of a pair stands the end twice
  Index longest = 512;             // ids of a text with its frame, as many as the network has positions
  bool truncate = false;           // a longer text is cut, else refused

  /// Of all-mpnet-base-v2.
  static BertTokenizerOptions mpnet() {
    BertTokenizerOptions o;
    o.begin = "<s>", o.end = "</s>", o.pad = "<pad>";
    o.special = {"<s>", "<pad>", "</s>", "<unk>", "[UNK]", "<mask>"};
    o.pair_has_types = false, o.pair_has_two_ends = true;
    return o;
  }
};

/// The vocabulary of MPNet from that of BERT: four marks before it, one behind it.
inline std::vector<std::string> mpnet_vocabulary(std::span<const std::string> bert) {
  std::vector<std::string> out{"<s>", "<pad>", "</s>", "<unk>"};
  out.insert(out.end(), bert.begin(), bert.end());
  out.emplace_back("<mask>");
  return out;
}

class BertTokenizer {
 public:
  /// vocabulary   the piece of every id
  /// added        instead of options.special, as a tokenizer.json lists them
  /// Throws       config_error 107, naming `source`: a piece stands twice, is empty or not UTF-8, or begin, end or
  ///              unknown is no piece; 101 if options.longest leaves no room for a text
  explicit BertTokenizer(std::vector<std::string> vocabulary, BertTokenizerOptions options = {},
                         std::string_view source = "BertTokenizer", std::optional<std::vector<AddedToken>> added = {})
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

  const BertTokenizerOptions& options() const { return options_; }
  const std::vector<std::string>& vocabulary() const { return *pieces_; }
  Index size() const { return static_cast<Index>(pieces_->size()); }
  /// The id of a piece as the vocabulary writes it ("walk", "##ing"); none if there is no such piece.
  std::optional<Index> id(std::string_view piece) const {
    const bool continues = !options_.continuation.empty() && piece.starts_with(options_.continuation);
    if (continues) piece.remove_prefix(options_.continuation.size());
    const Index found = find(piece, !continues);
    return found < 0 ? std::nullopt : std::optional(found);
  }
  /// Throws config_error 103 if the vocabulary has no piece for padding.
  Index pad_id() const {
    if (const auto found = id(options_.pad)) return *found;
    raise<config_error>(103, "BertTokenizer: the vocabulary has no piece '", options_.pad, "' for padding");
  }

  /// Other frames than the options make. Throws config_error 107 for ids that are no pieces, 101 as the constructor.
  void set_frames(std::vector<FramePart> single, std::vector<FramePart> pair, std::string_view source) {
    for (const auto* frame : {&single, &pair}) {
      for (const FramePart& part : *frame) {
        if (part.kind == FramePart::token) require_id(part.id, source);
      }
    }
    require_room(single, pair, source);
    single_ = std::move(single), pair_ = std::move(pair);
  }

  /// The framed ids of a text. Throws config_error 101 if they are more than options().longest and may not be cut.
  std::vector<Index> encode(std::string_view text) const {
    return detail::framed_text("BertTokenizer", single_, encode_words(text), options_.longest, options_.truncate);
  }
  /// Two texts in one frame; never cut.
  TokenPair encode_pair(std::string_view a, std::string_view b) const {
    return detail::framed_pair("BertTokenizer", pair_, encode_words(a), encode_words(b), options_.longest);
  }
  /// Without a frame, of any length.
  std::vector<Index> encode_words(std::string_view text) const {
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

  /// The words that ids spell, separated by blanks; special tokens are left out. Throws shape_error 203 for an id that
  /// is none.
  std::string decode(std::span<const Index> ids) const {
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

  /// The text of which words are taken: cleaned, ideographs apart, without accents, in lower case, as the options say.
  std::string normalized(std::string_view text) const {
    std::string out;
    out.reserve(text.size());
    for (const char byte : text) {
      const auto c = static_cast<unsigned char>(byte);
      if (c >= 0x80) return normalized_unicode(text);
      const unsigned k = detail::first_classes[c];
      if (options_.clean_text && (k & (CharClass::other | CharClass::white_space)) != 0) {
        if (is_blank(c, k)) out += ' ';
        continue;
      }
      out += options_.lower_case ? static_cast<char>(lower_case(char32_t{c})) : byte;
    }
    return out;
  }

 private:
  /// Of a character that is white space or belongs to Other: whether it separates words. The others vanish.
  static bool is_blank(char32_t c, unsigned k) {
    return c == '\t' || c == '\n' || c == '\r' || (k & CharClass::other) == 0;
  }
  static bool is_cjk(char32_t c) {
    constexpr char32_t ranges[][2] = {{0x3400, 0x4DBF},   {0x4E00, 0x9FFF},   {0xF900, 0xFAFF},   {0x20000, 0x2A6DF},
                                      {0x2A700, 0x2B73F}, {0x2B740, 0x2B81F}, {0x2B920, 0x2CEAF}, {0x2F800, 0x2FA1F}};
    return std::any_of(std::begin(ranges), std::end(ranges), [&](const auto& r) { return c >= r[0] && c <= r[1]; });
  }
  /// ASCII symbols count as punctuation.
  static bool is_punctuation(char32_t c, unsigned k) {
    if (c < 0x80) return c > 0x20 && c < 0x7F && (k & (CharClass::letter | CharClass::number)) == 0;
    return (k & CharClass::punctuation) != 0;
  }

  std::string normalized_unicode(std::string_view text) const {
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

  void append_words(std::vector<Index>& ids, std::string_view text) const {
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

  Index find(std::string_view part, bool first) const {
    const auto& ids = first ? starts_ : continuations_;
    const auto found = ids.find(part);
    return found == ids.end() ? Index{-1} : found->second;
  }

  void index_pieces(std::string_view source) {
    for (std::size_t i = 0; i < pieces_->size(); ++i) {
      std::string_view piece = (*pieces_)[i];
      if (piece.empty() || !is_utf8(piece))
        raise<config_error>(107, source, ": piece ", i, piece.empty() ? " is empty" : " is not UTF-8");
      const bool continues = !options_.continuation.empty() && piece.starts_with(options_.continuation);
      if (continues) piece.remove_prefix(options_.continuation.size());
      if (!(continues ? continuations_ : starts_).emplace(piece, static_cast<Index>(i)).second)
        raise<config_error>(107, source, ": piece '", (*pieces_)[i], "' stands twice, the second time as id ", i);
      longest_ = std::max(longest_, piece.size());
    }
  }
  Index required(const std::string& piece, std::string_view source) const {
    if (const auto found = id(piece)) return *found;
    raise<config_error>(107, source, ": a vocabulary of ", size(), " pieces lacks '", piece, "'");
  }
  void require_id(Index id, std::string_view source) const {
    if (id < 0 || id >= size()) raise<config_error>(107, source, ": id ", id, " among ", size(), " pieces");
  }
  void require_room(std::span<const FramePart> single, std::span<const FramePart> pair, std::string_view source) const {
    const std::size_t frame = std::max(detail::frame_size(single), detail::frame_size(pair));
    if (options_.longest < static_cast<Index>(frame))
      raise<config_error>(101, source, ": at most ", options_.longest, " ids, the frame has ", frame);
  }
  std::vector<AddedToken> specials() const {
    std::vector<AddedToken> out;
    for (const std::string& piece : options_.special) {
      if (const auto found = id(piece)) out.push_back({piece, *found});
    }
    return out;
  }
  void set_added(std::vector<AddedToken> tokens, std::string_view source) {
    std::vector<AddedToken> before, after;
    for (AddedToken& t : tokens) {
      require_id(t.id, source);
      if (t.normalized) t.content = normalized(t.content);
      (t.normalized ? after : before).push_back(std::move(t));
    }
    raw_ = detail::AddedTokenSearch(std::move(before));
    normalized_ = detail::AddedTokenSearch(std::move(after));
  }

  BertTokenizerOptions options_;
  std::shared_ptr<const std::vector<std::string>> pieces_;
  std::unordered_map<std::string_view, Index> starts_, continuations_;  // views into *pieces_
  std::size_t longest_ = 0;                                             // bytes of a piece
  Index begin_ = 0, end_ = 0, unknown_ = 0;
  std::vector<FramePart> single_, pair_;
  detail::AddedTokenSearch raw_, normalized_;
};

static_assert(Tokenizer<BertTokenizer>);

MOTIONLANG_NAMESPACE_END
