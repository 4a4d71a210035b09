// SPDX-License-Identifier: MIT
/// Word vectors with a part of speech: the text side of TM2T and of the HumanML3D evaluators.
///
///     const GloVe words = read_glove("glove/our_vab");                                       // weights/glove_file.hpp
///     const TextFeatures<B> text = words.encode<B>(texts);                  // texts: "a/DET man/NOUN walk/VERB"
///
/// A row is the vector of a word, followed by a one among the 15 tags. Texts are lists of word/tag, the second field of
/// the caption files of HumanML3D. A caption without tags is tagged approximately, see `caption_tokens`.
/// Source  Guo et al. (CVPR 2022), TM2T utils/word_vectorizer.py WordVectorizerV2
#pragma once

#include <optional>       // rows of words
#include <string>         // words
#include <string_view>    // words
#include <unordered_map>  // rows of words
#include <vector>         // rows

#include <motionlang/text/tagged_word.hpp>
#include <motionlang/text/text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class SpeechTag { verb, noun, det, adp, num, aux, pron, adj, adv, loc, body, obj, act, desc, other };
inline constexpr Index speech_tags = 15;

/// The tag with this name in the caption files; SpeechTag::other if there is none.
SpeechTag speech_tag(std::string_view name);

/// Words that matter to motions have tags of their own: that of the first list with the word. Nothing for other words.
std::optional<SpeechTag> motion_tag(std::string_view word);

/// Vectors of words, with "sos", "eos" and "unk" among them.
class GloVe {
 public:
  /// `vectors` has a row of `width` values for each word. Throws shape_error 205 for another size, config_error 103 if
  /// sos, eos or unk is missing or a word is duplicated.
  GloVe(const std::vector<std::string>& words, std::vector<float> vectors, Index width);

  Index size() const { return static_cast<Index>(row_.size()); }
  Index width() const { return width_; }
  bool contains(const std::string& word) const { return row_.contains(word); }
  /// The row of a word; for an unknown word that of "unk". This is the number of the word in TM2T.
  Index id(const std::string& word) const;
  /// The word of a row; "pad" after the last row. Throws shape_error 203 for other numbers.
  std::string word(Index id) const;
  /// All words in the order of their rows.
  std::vector<std::string> words() const;
  std::span<const float> vector(const std::string& word) const;
  /// The tag to use: `other` for an unknown word, otherwise that of the word's list, otherwise the given one.
  SpeechTag tag(const TaggedWord& w) const;

  /// sos, at most `longest` words, eos. Throws config_error 101 if `longest` is negative.
  static std::vector<TaggedWord> framed(std::span<const TaggedWord> words, Index longest);

  /// "word/tag word/tag" if every word has a slash. Other texts are captions, in which a slash is an ordinary mark
  /// ("walks and/or runs"). Throws config_error 107 for a word with no tag or several beside a word with a tag of the
  /// table.
  std::vector<TaggedWord> tokens(std::string_view text) const;
  /// An approximation of the original processing with spaCy. Hyphens are deleted, words are lower-cased, and those with
  /// digits are skipped. Unknown words become a known form (text/word_forms.hpp). Tags come only from the lists of
  /// `motion_tag`.
  std::vector<TaggedWord> caption_tokens(std::string_view text) const;

  /// Rows of width + 15 values: sos, the words, eos.
  template <Backend B>
  TextFeatures<B> encode(std::span<const std::string> texts, Index longest = 20) const {
    std::vector<typename B::scalar> values;
    std::vector<Index> lengths;
    for (const std::string& text : texts) {
      const auto words = framed(tokens(text), longest);
      for (const TaggedWord& w : words) {
        const auto v = vector(w.word);
        values.insert(values.end(), v.begin(), v.end());
        values.resize(values.size() + speech_tags, 0);
        values[values.size() - speech_tags + static_cast<std::size_t>(tag(w))] = 1;
      }
      lengths.push_back(std::ssize(words));
    }
    const Offsets offsets(lengths);
    return {{Tensor<B, 2>::from(values, {offsets.rows(), width_ + speech_tags}), offsets}};
  }

 private:
  std::vector<float> vectors_;
  Index width_;
  std::unordered_map<std::string, std::size_t> row_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/glove.ipp>
#endif
