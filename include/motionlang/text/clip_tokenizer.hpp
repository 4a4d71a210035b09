// SPDX-License-Identifier: MIT
/// The tokenizer of CLIP: byte-level pair encoding with a mark at the end of words. weights/tokenizer_files.hpp reads
/// vocabularies.
///
///     const ClipTokenizer clip = read_clip_tokenizer("bpe_simple_vocab_16e6.txt.gz");
///     clip.encode("a person walks");                     // 49406 320 2533 8192 49407
///     tokenize(clip, texts).padded(clip.pad_id(), 77);   // what the published network takes
///
/// Source   Radford et al. (2021), openai/CLIP clip/simple_tokenizer.py; Sennrich et al. (2016)
/// Differs  mojibake is not repaired (text_repair.hpp)
#pragma once

#include <memory>   // shared tables
#include <string>   // pieces
#include <utility>  // merges
#include <vector>   // pieces

#include <motionlang/text/tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The cleaning of a text before it is split into words.
enum class ClipCleaning {
  original,     // OpenAI's: repair_text, HTML entities twice, white space, lower case with final sigma
  hugging_face  // NFC, white space, lower case without context, as in its tokenizer.json
};

struct ClipTokenizerOptions {
  ClipCleaning cleaning = ClipCleaning::original;
  Index longest = 77;                // ids of a text with its frame; 22 in MDM for HumanML3D and KIT-ML
  bool truncate = true;              // cut a longer text, else refuse it
  std::size_t cached_words = 16384;  // words with cached ids
  std::string begin = "<|startoftext|>", end = "<|endoftext|>", unknown = "<|endoftext|>", word_end = "</w>";
};

using BytePairMerges = std::vector<std::pair<std::string, std::string>>;

namespace detail {

class BytePairs;
class WordCache;

}  // namespace detail

class ClipTokenizer {
 public:
  /// OpenAI's ids: 256 symbols of bytes, the same at the end of words, the merges, begin, end.
  explicit ClipTokenizer(const BytePairMerges& merges, const ClipTokenizerOptions& options = {},
                         std::string_view source = "ClipTokenizer");
  /// Any ids. `added` replaces begin and end, as listed in a tokenizer.json; these strings are found before words.
  /// Throws config_error 107, naming `source`, if begin or end is not a piece, a piece is duplicated or a merge needs
  /// an unknown piece; 101 if options.longest leaves no room for the frame
  ClipTokenizer(std::vector<std::string> pieces, const BytePairMerges& merges, ClipTokenizerOptions options = {},
                std::string_view source = "ClipTokenizer", const std::vector<AddedToken>& added = {});

  const ClipTokenizerOptions& options() const { return options_; }
  const std::vector<std::string>& vocabulary() const { return *pieces_; }
  Index size() const { return static_cast<Index>(pieces_->size()); }
  Index begin_id() const { return begin_; }
  Index end_id() const { return end_; }
  /// OpenAI pads with 0, Hugging Face with the end.
  Index pad_id() const { return options_.cleaning == ClipCleaning::original ? 0 : end_; }

  /// Sets other frames than begin, text, end. Throws config_error 107 for ids that are not pieces, 101 as the
  /// constructor.
  void set_frames(std::vector<FramePart> single, std::vector<FramePart> pair, std::string_view source);

  /// The framed ids of a text, at most options().longest. A longer text loses its last words, or throws config_error
  /// 101.
  std::vector<Index> encode(std::string_view text) const;
  /// Two texts in one frame, which is never cut.
  TokenPair encode_pair(std::string_view a, std::string_view b) const;
  /// The ids without a frame, in any number.
  std::vector<Index> encode_words(std::string_view text) const;

  /// The text for these ids, in lower case with a blank after every word, without start and end. Throws shape_error 203
  /// for an unknown id.
  std::string decode(std::span<const Index> ids) const;

  /// The text before it is split into words.
  std::string cleaned(std::string_view text) const;

 private:
  static std::vector<std::string> openai_pieces(const BytePairMerges& merges, const ClipTokenizerOptions& options);

  /// The literal at the beginning of a text, in the order of the original. The comparison ignores case as the original
  /// does, so the long s is an s.
  std::size_t literal_at(std::string_view text) const;
  std::size_t folded_prefix(std::string_view text, std::string_view literal) const;

  /// Words: the literals, runs of letters, single numbers, and runs of other characters except white space. The
  /// original loses U+0345. It is not a letter, but without case it is the letter iota, so neither kind of run takes
  /// it.
  void append_words(std::vector<Index>& ids, std::string_view text, detail::WordCache* cache) const;
  void append_word(std::vector<Index>& ids, std::string_view word, detail::WordCache* cache) const;

  ClipTokenizerOptions options_;
  std::shared_ptr<const std::vector<std::string>> pieces_;
  std::shared_ptr<const detail::BytePairs> pairs_;
  std::shared_ptr<detail::WordCache> cache_;
  detail::AddedTokenSearch raw_, cleaned_;
  Index begin_ = 0, end_ = 0;
  std::vector<FramePart> single_, pair_;
};

static_assert(Tokenizer<ClipTokenizer>);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/clip_tokenizer.ipp>
#endif
