// SPDX-License-Identifier: MIT
/// The WordPiece tokenizer of BERT, DistilBERT and MiniLM, and its MPNet variant: ids as the fast tokenizers of Hugging
/// Face give them. Vocabularies are read by weights/tokenizer_files.hpp.
///
///     const BertTokenizer bert(read_vocabulary("vocab.txt"));
///     bert.encode("a person walks.");   // [CLS] a person walks . [SEP]
///
/// Source   Devlin et al. (2019), google-research/bert tokenization.py; MPNet's: huggingface/transformers,
///          tokenization_mpnet.py
/// Differs  the tables are those of Unicode 15, in the fast tokenizers of Unicode 8: newer punctuation and newer
///          combining marks are known here
#pragma once

#include <memory>         // pieces that keep their place
#include <optional>       // strip_accents
#include <unordered_map>  // piece -> id

#include <motionlang/text/tokenizer.hpp>

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

  /// The options of all-mpnet-base-v2.
  static BertTokenizerOptions mpnet();
};

/// The vocabulary of MPNet from that of BERT: four marks before it, one behind it.
std::vector<std::string> mpnet_vocabulary(std::span<const std::string> bert);

class BertTokenizer {
 public:
  /// vocabulary   the piece of every id
  /// added        instead of options.special, as a tokenizer.json lists them
  /// Throws       config_error 107, naming `source`: a piece is duplicated, is empty or not UTF-8, or begin, end or
  ///              unknown is not a piece; 101 if options.longest leaves no room for a text
  explicit BertTokenizer(std::vector<std::string> vocabulary, BertTokenizerOptions options = {},
                         std::string_view source = "BertTokenizer", std::optional<std::vector<AddedToken>> added = {});

  const BertTokenizerOptions& options() const { return options_; }
  const std::vector<std::string>& vocabulary() const { return *pieces_; }
  Index size() const { return static_cast<Index>(pieces_->size()); }
  /// The id of a piece as the vocabulary writes it ("walk", "##ing"); none if there is no such piece.
  std::optional<Index> id(std::string_view piece) const;
  /// Throws config_error 103 if the vocabulary has no piece for padding.
  Index pad_id() const;

  /// Other frames than the options make. Throws config_error 107 for ids that are not pieces, 101 as the constructor.
  void set_frames(std::vector<FramePart> single, std::vector<FramePart> pair, std::string_view source);

  /// The framed ids of a text. Throws config_error 101 if they are more than options().longest and may not be cut.
  std::vector<Index> encode(std::string_view text) const;
  /// Two texts in one frame; never cut.
  TokenPair encode_pair(std::string_view a, std::string_view b) const;
  /// Without a frame, of any length.
  std::vector<Index> encode_words(std::string_view text) const;

  /// The words that ids spell, separated by blanks; special tokens are left out. Throws shape_error 203 for an id that
  /// is not one of the vocabulary.
  std::string decode(std::span<const Index> ids) const;

  /// The text of which words are taken: cleaned, ideographs apart, without accents, in lower case, as the options say.
  std::string normalized(std::string_view text) const;

 private:
  /// For a character that is white space or belongs to Other: true if it separates words. The others vanish.
  static bool is_blank(char32_t c, unsigned k);
  static bool is_cjk(char32_t c);
  /// ASCII symbols count as punctuation.
  static bool is_punctuation(char32_t c, unsigned k);

  std::string normalized_unicode(std::string_view text) const;

  void append_words(std::vector<Index>& ids, std::string_view text) const;

  Index find(std::string_view part, bool first) const;

  void index_pieces(std::string_view source);
  Index required(const std::string& piece, std::string_view source) const;
  void require_id(Index id, std::string_view source) const;
  void require_room(std::span<const FramePart> single, std::span<const FramePart> pair, std::string_view source) const;
  std::vector<AddedToken> specials() const;
  void set_added(std::vector<AddedToken> tokens, std::string_view source);

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

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/bert_tokenizer.ipp>
#endif
