// SPDX-License-Identifier: MIT
// Bodies of glove.hpp.
#pragma once

#include <algorithm>  // find
#include <array>      // tags

#include <motionlang/text/glove.hpp>
#include <motionlang/text/word_forms.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SpeechTag speech_tag(std::string_view name) {
  constexpr std::array<std::string_view, 15> names{"VERB",     "NOUN",    "DET",     "ADP",      "NUM",
                                                   "AUX",      "PRON",    "ADJ",     "ADV",      "Loc_VIP",
                                                   "Body_VIP", "Obj_VIP", "Act_VIP", "Desc_VIP", "OTHER"};
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? SpeechTag::other : static_cast<SpeechTag>(found - names.begin());
}

MOTIONLANG_BODY std::optional<SpeechTag> motion_tag(std::string_view word) {
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

MOTIONLANG_BODY GloVe::GloVe(const std::vector<std::string>& words, std::vector<float> vectors, Index width)
    : vectors_(std::move(vectors)), width_(width) {
  if (width < 1 || vectors_.size() != words.size() * static_cast<std::size_t>(width))
    raise<shape_error>(205, "GloVe: ", counted(vectors_.size(), "number"), " for ", counted(words.size(), "word"),
                       " of ", width);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!row_.emplace(words[i], i).second) raise<config_error>(103, "GloVe: the word '", words[i], "' is duplicated");
  }
  for (const char* mark : {"sos", "eos", "unk"}) {
    if (!row_.contains(mark)) raise<config_error>(103, "GloVe: no word '", mark, "'");
  }
}

MOTIONLANG_BODY Index GloVe::id(const std::string& word) const {
  const auto found = row_.find(word);
  return static_cast<Index>(found == row_.end() ? row_.at("unk") : found->second);
}

MOTIONLANG_BODY std::string GloVe::word(Index id) const {
  if (id == size()) return "pad";
  for (const auto& [word, row] : row_) {
    if (static_cast<Index>(row) == id) return word;
  }
  raise<shape_error>(203, "GloVe: word ", id, " of ", size());
}

MOTIONLANG_BODY std::vector<std::string> GloVe::words() const {
  std::vector<std::string> out(row_.size());
  for (const auto& [word, row] : row_) out[row] = word;
  return out;
}

MOTIONLANG_BODY std::span<const float> GloVe::vector(const std::string& word) const {
  return std::span(vectors_).subspan(static_cast<std::size_t>(id(word) * width_), static_cast<std::size_t>(width_));
}

MOTIONLANG_BODY SpeechTag GloVe::tag(const TaggedWord& w) const {
  return contains(w.word) ? motion_tag(w.word).value_or(speech_tag(w.tag)) : SpeechTag::other;
}

MOTIONLANG_BODY std::vector<TaggedWord> GloVe::framed(std::span<const TaggedWord> words, Index longest) {
  if (longest < 0) raise<config_error>(101, "GloVe: at most ", longest, " words");
  std::vector<TaggedWord> out{{"sos", "OTHER"}};
  const auto count = std::min<std::size_t>(words.size(), static_cast<std::size_t>(longest));
  out.insert(out.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(count));
  out.push_back({"eos", "OTHER"});
  return out;
}

MOTIONLANG_BODY std::vector<TaggedWord> GloVe::tokens(std::string_view text) const {
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

MOTIONLANG_BODY std::vector<TaggedWord> GloVe::caption_tokens(std::string_view text) const {
  std::string joined(text);
  std::erase(joined, '-');
  const auto has_row = [this](const std::string& word) { return contains(word); };
  std::vector<TaggedWord> out;
  for (const std::string& word : WordPiece::words(joined)) {
    if (word.find_first_of("0123456789") == word.npos) out.push_back({known_form(word, has_row), "OTHER"});
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
