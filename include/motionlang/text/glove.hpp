// SPDX-License-Identifier: MIT
/// Word vectors with a part of speech: the text side of TM2T and of the HumanML3D evaluators.
///
///     const GloVe words = read_glove("glove/our_vab");                                       // weights/glove_file.hpp
///     const TextFeatures<B> text = words.encode<B>(texts);                  // texts: "a/DET man/NOUN walk/VERB"
///
/// A row is the vector of a word and, behind it, a one among the 15 tags. Texts are lists of word/tag, the second field
/// of the caption files of HumanML3D. A caption without tags is read by approximation, see `caption_tokens`.
/// Source  Guo et al. (CVPR 2022), word_vectorizer.py; spec text-encoders.md, section 6
#pragma once

#include <algorithm>      // find
#include <array>          // tags
#include <optional>       // rows of words
#include <string_view>    // words
#include <unordered_map>  // rows of words

#include <motionlang/text/tagged_word.hpp>
#include <motionlang/text/text_encoder.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class SpeechTag { verb, noun, det, adp, num, aux, pron, adj, adv, loc, body, obj, act, desc, other };
inline constexpr Index speech_tags = 15;

/// By the name in the caption files; SpeechTag::other if there is none.
inline SpeechTag speech_tag(std::string_view name) {
  constexpr std::array<std::string_view, 15> names{"VERB",     "NOUN",    "DET",     "ADP",      "NUM",
                                                   "AUX",      "PRON",    "ADJ",     "ADV",      "Loc_VIP",
                                                   "Body_VIP", "Obj_VIP", "Act_VIP", "Desc_VIP", "OTHER"};
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? SpeechTag::other : static_cast<SpeechTag>(found - names.begin());
}

/// The words that matter to motions have tags of their own: the first list that has the word. Nothing for other words.
inline std::optional<SpeechTag> motion_tag(std::string_view word) {
  constexpr std::array<std::pair<SpeechTag, std::string_view>, 5> lists{
      {{SpeechTag::loc,
        " left right clockwise counterclockwise anticlockwise forward back backward up down straight curve "},
       {SpeechTag::body, " arm chin foot feet face hand mouth leg waist eye knee shoulder thigh "},
       {SpeechTag::obj, " stair dumbbell chair window floor car ball handrail baseball basketball "},
       {SpeechTag::act,
        " walk run swing pick bring kick put squat throw hop dance jump turn stumble stop sit lift lower raise wash "
        "stand kneel "
        "stroll rub bend balance flap jog shuffle lean rotate spin spread climb "},
       {SpeechTag::desc, " slowly carefully fast careful slow quickly happy angry sad happily angrily sadly "}}};
  const std::string whole = concat_text(" ", word, " ");
  for (const auto& [tag, list] : lists) {
    if (list.find(whole) != list.npos) return tag;
  }
  return std::nullopt;
}

/// Vectors of words, with "sos", "eos" and "unk" among them.
class GloVe {
 public:
  /// vectors has a row of `width` numbers for each word. Throws shape_error 205 if it has not, config_error 103 if sos,
  /// eos or unk is missing or a word stands twice.
  GloVe(const std::vector<std::string>& words, std::vector<float> vectors, Index width)
      : vectors_(std::move(vectors)), width_(width) {
    if (width < 1 || vectors_.size() != words.size() * static_cast<std::size_t>(width))
      raise<shape_error>(205, "GloVe: ", vectors_.size(), " numbers for ", words.size(), " words of ", width);
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (!row_.emplace(words[i], i).second) raise<config_error>(103, "GloVe: the word '", words[i], "' stands twice");
    }
    for (const char* mark : {"sos", "eos", "unk"}) {
      if (!row_.contains(mark)) raise<config_error>(103, "GloVe: no word '", mark, "'");
    }
  }

  Index size() const { return static_cast<Index>(row_.size()); }
  Index width() const { return width_; }
  bool contains(const std::string& word) const { return row_.contains(word); }
  /// Its row; of an unknown word that of "unk". This is the number of the word in TM2T.
  Index id(const std::string& word) const {
    const auto found = row_.find(word);
    return static_cast<Index>(found == row_.end() ? row_.at("unk") : found->second);
  }
  /// The word of a row; behind the last row "pad". Throws shape_error 203 for other numbers.
  std::string word(Index id) const {
    if (id == size()) return "pad";
    for (const auto& [word, row] : row_) {
      if (static_cast<Index>(row) == id) return word;
    }
    raise<shape_error>(203, "GloVe: word ", id, " of ", size());
  }
  /// All of them in the order of their rows.
  std::vector<std::string> words() const {
    std::vector<std::string> out(row_.size());
    for (const auto& [word, row] : row_) out[row] = word;
    return out;
  }
  std::span<const float> vector(const std::string& word) const {
    return std::span(vectors_).subspan(static_cast<std::size_t>(id(word) * width_), static_cast<std::size_t>(width_));
  }
  /// The tag that counts: of an unknown word `other`, else the one of the word's list, else the given one.
  SpeechTag tag(const TaggedWord& w) const {
    return contains(w.word) ? motion_tag(w.word).value_or(speech_tag(w.tag)) : SpeechTag::other;
  }

  /// sos, at most `longest` words, eos. Throws config_error 101 if `longest` is negative.
  static std::vector<TaggedWord> framed(std::span<const TaggedWord> words, Index longest) {
    if (longest < 0) raise<config_error>(101, "GloVe: at most ", longest, " words");
    std::vector<TaggedWord> out{{"sos", "OTHER"}};
    const auto count = std::min<std::size_t>(words.size(), static_cast<std::size_t>(longest));
    out.insert(out.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(count));
    out.push_back({"eos", "OTHER"});
    return out;
  }

  /// "word/tag word/tag" where every word has a slash; other texts are captions, in which a slash is a mark like any
  /// other ("walks and/or runs"). Throws config_error 107 for a word with no tag or several beside one with a tag of
  /// the table.
  std::vector<TaggedWord> tokens(std::string_view text) const {
    std::vector<TaggedWord> out;
    std::string_view wrong;
    bool tagged = false;
    for (std::size_t at = 0; (at = text.find_first_not_of(' ', at)) != text.npos;) {
      const std::size_t end = std::min(text.find(' ', at), text.size());
      const std::string_view token = text.substr(at, end - at);
      at = end;
      const std::size_t slash = token.find('/');
      if (slash == token.npos || token.find('/', slash + 1) != token.npos) {
        if (wrong.empty()) wrong = token;
        continue;
      }
      out.push_back({std::string(token.substr(0, slash)), std::string(token.substr(slash + 1))});
      tagged = tagged || speech_tag(out.back().tag) != SpeechTag::other;
    }
    if (wrong.empty()) return out;
    if (tagged) raise<config_error>(107, "GloVe: '", wrong, "' is not word/tag");
    return caption_tokens(text);
  }
  /// An approximation to what was done with spaCy: hyphens are deleted, words are lowered, those with digits are passed
  /// over; -s, -es, -ed and -ing are taken away where the word is unknown and the rest is known. Tags come from the
  /// lists of `motion_tag` only.
  std::vector<TaggedWord> caption_tokens(std::string_view text) const {
    std::string joined(text);
    std::erase(joined, '-');
    std::vector<TaggedWord> out;
    for (const std::string& word : WordPiece::words(joined)) {
      if (word.find_first_of("0123456789") == word.npos) out.push_back({known_form(word), "OTHER"});
    }
    return out;
  }

  /// Rows of width + 15 numbers: sos, the words, eos.
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
  std::string known_form(const std::string& word) const {
    if (contains(word)) return word;
    for (const std::string_view end : {"ing", "ed", "es", "s"}) {
      if (!word.ends_with(end) || word.size() < end.size() + 2) continue;
      const std::string stem = word.substr(0, word.size() - end.size());
      if (contains(stem)) return stem;
      if (contains(stem + "e")) return stem + "e";
      if (stem.back() == stem[stem.size() - 2] && contains(stem.substr(0, stem.size() - 1)))
        return stem.substr(0, stem.size() - 1);
    }
    return word;
  }

  std::vector<float> vectors_;
  Index width_;
  std::unordered_map<std::string, std::size_t> row_;
};

MOTIONLANG_NAMESPACE_END
