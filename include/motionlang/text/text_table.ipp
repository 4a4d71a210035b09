// SPDX-License-Identifier: MIT
// Bodies of text_table.hpp.
#pragma once

#include <algorithm>  // partial_sort, max
#include <cmath>      // isfinite, log, round, sqrt
#include <map>        // words
#include <numeric>    // iota
#include <set>        // words of a text, each once

#include <motionlang/file/key_report.hpp>
#include <motionlang/text/text_table.hpp>
#include <motionlang/text/word_forms.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY const std::set<std::string>& function_words() {
  static const std::set<std::string> words{
      "a",      "an",      "and",        "are",      "as",    "at",      "be",       "been",       "being",   "both",
      "by",     "can",     "do",         "does",     "doing", "for",     "from",     "he",         "her",     "hers",
      "him",    "his",     "i",          "in",       "is",    "it",      "its",      "just",       "like",    "man",
      "me",     "my",      "of",         "on",       "or",    "our",     "ourself",  "person",     "please",  "she",
      "so",     "some",    "that",       "the",      "their", "them",    "there",    "these",      "they",    "this",
      "those",  "to",      "us",         "very",     "was",   "we",      "were",     "while",      "who",     "with",
      "woman",  "you",     "your",       "yourself", "human", "figure",  "someone",  "somebody",   "himself", "herself",
      "itself", "subject", "individual", "people",   "guy",   "perform", "performs", "performing", "make",    "makes",
      "making", "motion",  "movement",   "movements"};
  return words;
}

}  // namespace detail

/// The words of the texts by number.
struct TextTable::Words {
  std::vector<std::string> words{};            // in alphabetical order
  std::vector<double> rarity{};                // of each
  std::vector<std::vector<float>> vectors{};   // of each; empty: it has none
  std::vector<std::uint32_t> said{}, first{};  // word numbers of all texts; where each text begins
  double rarest = 0;                           // of a word that no text says

  std::optional<std::size_t> find(const std::string& word) const {
    const auto exact = [&](const std::string& w) { return std::binary_search(words.begin(), words.end(), w); };
    const std::string form = known_form(word, exact);
    const auto found = std::lower_bound(words.begin(), words.end(), form);
    if (found == words.end() || *found != form) return std::nullopt;
    return static_cast<std::size_t>(found - words.begin());
  }
};

MOTIONLANG_BODY TextTable::TextTable(std::vector<std::string> texts, std::vector<std::int8_t> codes,
                                     std::vector<float> mean, TextVectors encode, WordVectors words,
                                     std::string_view source) {
  if (codes.size() != texts.size() * mean.size())
    raise<shape_error>(205, source, ": ", counted(codes.size(), "number"), " for ", counted(texts.size(), "text"),
                       " of ", mean.size());
  auto said = std::make_shared<Words>();
  std::map<std::string, double> texts_with;
  std::vector<std::vector<std::string>> words_of;
  for (const std::string& text : texts) {
    words_of.push_back(WordPiece::words(text));
    std::erase_if(words_of.back(), detail::is_function_word);
    for (const std::string& word : std::set<std::string>(words_of.back().begin(), words_of.back().end()))
      ++texts_with[word];
  }
  const double all = 1 + static_cast<double>(texts.size());
  for (const auto& [word, count] : texts_with) {
    said->words.push_back(word);
    said->rarity.push_back(std::log(all / (1 + count)));
    const auto row = words.find(word);
    said->vectors.push_back(row ? words.vector(*row) : std::vector<float>());
  }
  said->rarest = std::log(all);
  for (const auto& list : words_of) {
    said->first.push_back(static_cast<std::uint32_t>(said->said.size()));
    for (const std::string& word : list)
      said->said.push_back(static_cast<std::uint32_t>(std::lower_bound(said->words.begin(), said->words.end(), word) -
                                                      said->words.begin()));
  }
  said->first.push_back(static_cast<std::uint32_t>(said->said.size()));
  table_ = std::make_shared<const Table>(
      Table{std::move(texts), std::move(codes), std::move(mean), std::move(encode), std::move(words), std::move(said)});
}

namespace detail {

/// The vectors of texts, some at a time. width: of a vector; 0: that of the first one.
inline std::vector<float> vectors_in_parts(std::span<const std::string> texts, const TextVectors& encode,
                                           std::size_t width = 0) {
  constexpr std::size_t at_once = 256;
  std::vector<float> out;
  for (std::size_t first = 0; first < texts.size(); first += at_once) {
    const auto part = texts.subspan(first, std::min(at_once, texts.size() - first));
    const auto some = encode(part);
    if (width == 0) width = std::max<std::size_t>(1, some.size() / part.size());
    if (some.size() != part.size() * width)
      raise<shape_error>(205, "TextTable: the encoder gives ", counted(some.size(), "number"), " for ",
                         counted(part.size(), "text"), " of ", width);
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (!std::isfinite(some[i]))
        raise<numeric_error>(301, "TextTable: the encoder gives ", some[i], " for '", part[i / width], "'");
    }
    out.insert(out.end(), some.begin(), some.end());
  }
  return out;
}

/// The directions of vectors from a mean, in 8 bits a number.
inline std::vector<std::int8_t> direction_codes(std::span<const float> vectors, std::span<const float> mean) {
  std::vector<std::int8_t> codes;
  for (std::size_t first = 0; first < vectors.size(); first += mean.size()) {
    float largest = 0;
    for (std::size_t k = 0; k < mean.size(); ++k) largest = std::max(largest, std::abs(vectors[first + k] - mean[k]));
    for (std::size_t k = 0; k < mean.size(); ++k)
      codes.push_back(
          static_cast<std::int8_t>(largest > 0 ? std::round((vectors[first + k] - mean[k]) / largest * 127) : 0));
  }
  return codes;
}

}  // namespace detail

MOTIONLANG_BODY TextTable TextTable::encoded(std::vector<std::string> texts, TextVectors encode, WordVectors words) {
  const auto vectors = detail::vectors_in_parts(texts, encode);
  std::vector<double> sum(texts.empty() ? 0 : vectors.size() / texts.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) sum[i % sum.size()] += static_cast<double>(vectors[i]);
  std::vector<float> mean;
  mean.reserve(sum.size());
  for (const double s : sum) mean.push_back(static_cast<float>(s / static_cast<double>(texts.size())));
  auto codes = detail::direction_codes(vectors, mean);
  return {std::move(texts), std::move(codes), std::move(mean), std::move(encode), std::move(words)};
}

MOTIONLANG_BODY TextTable TextTable::encoded_again(std::vector<std::string> texts) const {
  if (empty()) return {};
  return encoded(std::move(texts), table().encode, table().words);
}

MOTIONLANG_BODY TextTable TextTable::with(const std::vector<std::string>& more) const {
  if (empty()) return {};
  Table all = table();
  all.texts.insert(all.texts.end(), more.begin(), more.end());
  const auto codes = detail::direction_codes(detail::vectors_in_parts(more, all.encode, all.mean.size()), all.mean);
  all.codes.insert(all.codes.end(), codes.begin(), codes.end());
  return {std::move(all.texts), std::move(all.codes), std::move(all.mean), std::move(all.encode), std::move(all.words)};
}

MOTIONLANG_BODY TextTable TextTable::first(Index count) const {
  if (count < 0 || count > size()) raise<shape_error>(203, "TextTable: the first ", count, " of ", size());
  if (empty()) return {};
  Table some = table();
  some.texts.resize(static_cast<std::size_t>(count));
  some.codes.resize(static_cast<std::size_t>(count) * some.mean.size());
  return {std::move(some.texts), std::move(some.codes), std::move(some.mean), std::move(some.encode),
          std::move(some.words)};
}

MOTIONLANG_BODY const TextTable::Table& TextTable::table() const {
  static const Table none{.said = std::make_shared<const Words>()};
  return table_ ? *table_ : none;
}

MOTIONLANG_BODY const std::vector<std::string>& TextTable::said_words() const { return table().said->words; }

MOTIONLANG_BODY std::string TextTable::mended(const std::string& word) const {
  const Table& t = table();
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  if (t.words.empty() || word.size() < 3 || !std::all_of(word.begin(), word.end(), is_letter) ||
      detail::is_function_word(word) || t.said->find(word) || t.words.find(word))
    return "";
  std::size_t most = word.size() > 7 ? 3 : 2;  // steps, which are too many
  std::string out;
  const auto try_all = [&](const auto& candidates) {
    for (const std::string& candidate : candidates) {
      if (candidate.front() != word.front()) continue;
      if (const auto steps = edit_distance(word, candidate, most); steps < most) most = steps, out = candidate;
    }
  };
  try_all(t.said->words);
  try_all(detail::function_words());
  return out;
}

MOTIONLANG_BODY std::vector<TextTable::Likeness> TextTable::likeness(const std::string& text,
                                                                     std::span<const float> vector) const {
  const Table& t = table();
  const std::size_t width = t.mean.size();
  // How alike each word of the text is to each word of the table, with the rarity as its weight.
  const Words& said = *t.said;
  std::vector<std::vector<double>> alike;
  std::vector<double> said_now(said.words.size());  // how alike each word of the table is to one of the text
  double weights = 0;
  std::set<std::string> seen;
  for (const std::string& word : WordPiece::words(text)) {
    if (detail::is_function_word(word) || !seen.insert(word).second) continue;
    const auto same = said.find(word);
    const auto row = t.words.find(word);
    const auto of_word = row ? t.words.vector(*row) : std::vector<float>();
    const double weight = same ? said.rarity[*same] : said.rarest;
    auto& list = alike.emplace_back(said.words.size());
    for (std::size_t v = 0; v < said.words.size() && row; ++v) {
      if (said.vectors[v].empty()) continue;
      const double like = std::max(0.0, word_likeness(of_word, said.vectors[v]));
      list[v] = weight * like;
      said_now[v] = std::max(said_now[v], like);
    }
    if (same) list[*same] = weight, said_now[*same] = 1;
    weights += weight;
  }
  std::vector<Likeness> out(t.texts.size());
  double own = 0;
  for (std::size_t k = 0; k < width; ++k) own += std::pow(static_cast<double>(vector[k] - t.mean[k]), 2);
  for (std::size_t i = 0; i < out.size(); ++i) {
    double product = 0, length = 0, words = 0;
    for (std::size_t k = 0; k < width; ++k) {
      const double code = t.codes[i * width + k];
      product += code * static_cast<double>(vector[k] - t.mean[k]), length += code * code;
    }
    if (!(product > 0)) continue;  // nor if it is not a number
    for (const auto& list : alike) {
      double best = 0;
      for (std::uint32_t w = said.first[i]; w < said.first[i + 1]; ++w) best = std::max(best, list[said.said[w]]);
      words += best;
    }
    double of_own = 0, all_own = 0;
    for (std::uint32_t w = said.first[i]; w < said.first[i + 1]; ++w) {
      const std::uint32_t word = said.said[w];
      of_own += said.rarity[word] * said_now[word], all_own += said.rarity[word];
    }
    out[i] = {product / std::sqrt(own * length) * (0.01 + 0.99 * (weights > 0 ? words / weights : 1)),
              all_own > 0 ? of_own / all_own : 1};
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::vector<NearText>> TextTable::nearest(
    std::span<const std::string> texts, Index count, const std::function<bool(Index, Index)>& wanted) const {
  std::vector<std::vector<NearText>> out(texts.size());
  if (empty() || texts.empty()) return out;
  const auto vectors = table().encode(texts);
  if (vectors.size() != texts.size() * mean().size())
    raise<shape_error>(205, "TextTable: the encoder gives ", counted(vectors.size(), "number"), " for ",
                       counted(texts.size(), "text"), ", those of the table have ", mean().size());
  for (std::size_t t = 0; t < texts.size(); ++t) {
    const auto all = likeness(texts[t], std::span(vectors).subspan(t * mean().size(), mean().size()));
    std::vector<Index> rows;
    for (Index row = 0; row < size(); ++row) {
      if (!wanted || wanted(static_cast<Index>(t), row)) rows.push_back(row);
    }
    const auto of = [&](Index row) { return all[static_cast<std::size_t>(row)].likeness; };
    const auto most = std::clamp<Index>(count, 0, std::ssize(rows));
    std::partial_sort(rows.begin(), rows.begin() + most, rows.end(),
                      [&](Index a, Index b) { return of(a) > of(b) || (of(a) == of(b) && a < b); });
    for (Index i = 0; i < most; ++i) {
      const Index row = rows[static_cast<std::size_t>(i)];
      const auto at = static_cast<std::size_t>(row);
      out[t].push_back({row, this->texts()[at], all[at].likeness, all[at].said});
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<NearText> TextTable::nearest(const std::string& text, Index count,
                                                         const std::function<bool(Index)>& wanted) const {
  if (!wanted) return nearest(std::span(&text, 1), count).front();
  return nearest(std::span(&text, 1), count, [&](Index, Index row) { return wanted(row); }).front();
}

MOTIONLANG_NAMESPACE_END
