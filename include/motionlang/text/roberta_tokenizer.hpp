// SPDX-License-Identifier: MIT
/// The tokenizer of RoBERTa, which is that of GPT-2 with other marks: byte-level pair encoding of words that keep the
/// blank before them. Case and white space matter. weights/tokenizer_json.hpp reads its files.
///
///     const RobertaTokenizer roberta(read_vocabulary_json("vocab.json"), read_merges("merges.txt"));
///     roberta.encode("a person walks.");   // <s> a Ġperson Ġwalks . </s>, where Ġ is the blank
///
/// Words are the endings 's 't 're 've 'm 'll 'd, runs of letters, of numbers, and of other characters, each with one
/// blank before it if there is one. White space beyond that is a word of its own.
/// Source   Liu et al., "RoBERTa" (2019); Radford et al. (2019), openai/gpt-2 src/encoder.py; huggingface/transformers,
///          tokenization_roberta.py
/// Differs  white space before <mask> stays
#pragma once

#include <memory>       // shared tables
#include <string>       // pieces
#include <string_view>  // texts
#include <utility>      // merges
#include <vector>       // ids

#include <motionlang/text/tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct RobertaTokenizerOptions {
  std::string begin = "<s>", end = "</s>", pad = "<pad>", unknown = "<unk>";
  std::vector<std::string> special{"<s>", "<pad>", "</s>", "<unk>",
                                   "<mask>"};  // found before words, if they are pieces
  Index longest = 512;                         // ids of a text with its frame; the number of positions of the network
  bool truncate = false;                       // cut a longer text, else refuse it
  std::size_t cached_words = 16384;            // words with cached ids
};

namespace detail {

class BytePairs;
class WordCache;

}  // namespace detail

class RobertaTokenizer {
 public:
  using Merges = std::vector<std::pair<std::string, std::string>>;

  /// pieces  the piece of every id
  /// Throws  config_error 107, naming `source`, if begin, end or pad is not a piece, a piece is duplicated, a byte has
  ///         none or a merge needs an unknown piece; 101 if options.longest leaves no room for the frame
  RobertaTokenizer(std::vector<std::string> pieces, const Merges& merges, RobertaTokenizerOptions options = {},
                   std::string_view source = "RobertaTokenizer");

  const RobertaTokenizerOptions& options() const { return options_; }
  const std::vector<std::string>& vocabulary() const { return *pieces_; }
  Index size() const { return static_cast<Index>(pieces_->size()); }
  Index pad_id() const { return pad_; }

  /// The framed ids of a text. Throws config_error 101 if there are more than options().longest and they may not be
  /// cut.
  std::vector<Index> encode(std::string_view text) const;
  /// Two texts in one frame, <s> A </s></s> B </s>, which is never cut.
  TokenPair encode_pair(std::string_view a, std::string_view b) const;
  /// The ids without a frame, in any number.
  std::vector<Index> encode_words(std::string_view text) const;
  /// The text for these ids, without special tokens. Throws shape_error 203 for an unknown id.
  std::string decode(std::span<const Index> ids) const;

 private:
  void append_words(std::vector<Index>& ids, std::string_view text, detail::WordCache* cache) const;

  RobertaTokenizerOptions options_;
  std::shared_ptr<const std::vector<std::string>> pieces_;
  std::shared_ptr<const detail::BytePairs> pairs_;
  std::shared_ptr<detail::WordCache> cache_;
  detail::AddedTokenSearch special_;
  Index pad_ = 0;
  std::vector<FramePart> single_, pair_;
};

static_assert(Tokenizer<RobertaTokenizer>);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/roberta_tokenizer.ipp>
#endif
