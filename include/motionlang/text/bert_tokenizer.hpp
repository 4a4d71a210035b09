// SPDX-License-Identifier: MIT
/// The WordPiece tokenizer of BERT, DistilBERT and MiniLM, and its MPNet variant. Its ids are those of Hugging Face's
/// fast tokenizers. weights/tokenizer_files.hpp reads vocabularies.
///
///     const BertTokenizer bert(read_vocabulary("vocab.txt"));
///     bert.encode("a person walks.");   // [CLS] a person walks . [SEP]
///
/// Source   Devlin et al. (2019), google-research/bert tokenization.py; MPNet's: huggingface/transformers,
///          tokenization_mpnet.py
/// Differs  The tables are those of Unicode 15; the fast tokenizers have Unicode 8. So newer punctuation and combining
///          marks are known here
#pragma once

#include <memory>         // pieces that keep their place
#include <optional>       // strip_accents
#include <unordered_map>  // piece -> id

#include <motionlang/text/tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct BertTokenizerOptions {
  bool clean_text = true;  // drops control characters, and turns any white space into a blank
  bool split_cjk = true;   // every ideograph is a word
  bool lower_case = true;
  std::optional<bool> strip_accents;  // unless set: the same as lower_case
  std::string begin = "[CLS]", end = "[SEP]", unknown = "[UNK]", pad = "[PAD]";
  std::string continuation = "##";  // before a piece that continues a word
  Index longest_word = 100;         // code points; a longer word is unknown
  /// Strings with ids of their own, in the order of preference. Those that the vocabulary lacks are left out.
  std::vector<std::string> special{"[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]"};
  bool pair_has_types = true;      // the second text of a pair has token type 1
  bool pair_has_two_ends = false;  // two end marks separate the texts of a pair
  Index longest = 512;             // ids of a text with its frame; the number of positions of the network
  bool truncate = false;           // cut a longer text, else refuse it

  /// The options of all-mpnet-base-v2.
  static BertTokenizerOptions mpnet();
};

/// The vocabulary of MPNet from that of BERT: four marks before it, one after it.
std::vector<std::string> mpnet_vocabulary(std::span<const std::string> bert);

class BertTokenizer {
 public:
  /// vocabulary   the piece of every id
  /// added        replaces options.special, as listed in a tokenizer.json
  /// Throws       config_error 107, naming `source`, if a piece is duplicated, empty or not UTF-8, or begin, end or
  ///              unknown is not a piece; 101 if options.longest leaves no room for a text
  explicit BertTokenizer(std::vector<std::string> vocabulary, BertTokenizerOptions options = {},
                         std::string_view source = "BertTokenizer", std::optional<std::vector<AddedToken>> added = {});

  const BertTokenizerOptions& options() const { return options_; }
  const std::vector<std::string>& vocabulary() const { return *pieces_; }
  Index size() const { return static_cast<Index>(pieces_->size()); }
  /// The id of a piece in the form of the vocabulary ("walk", "##ing"); none if there is no such piece.
  std::optional<Index> id(std::string_view piece) const;
  /// Throws config_error 103 if the vocabulary has no piece for padding.
  Index pad_id() const;

  /// Sets other frames than those of the options. Throws config_error 107 for ids that are not pieces, 101 as the
  /// constructor.
  void set_frames(std::vector<FramePart> single, std::vector<FramePart> pair, std::string_view source);

  /// The framed ids of a text. Throws config_error 101 if there are more than options().longest and they may not be
  /// cut.
  std::vector<Index> encode(std::string_view text) const;
  /// Two texts in one frame, which is never cut.
  TokenPair encode_pair(std::string_view a, std::string_view b) const;
  /// The ids without a frame, in any number.
  std::vector<Index> encode_words(std::string_view text) const;

  /// The words for these ids, separated by blanks, without special tokens. Throws shape_error 203 for an unknown id.
  std::string decode(std::span<const Index> ids) const;

  /// The text before it is split into words: cleaned, ideographs separated, without accents, in lower case, by the
  /// options.
  std::string normalized(std::string_view text) const;

 private:
  /// For white space, or a character of the class Other: true if it separates words. The others are dropped.
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
