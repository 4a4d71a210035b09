// SPDX-License-Identifier: MIT
// Bodies of captions.hpp.
#pragma once

#include <algorithm>      // min, max
#include <cmath>          // exp, log, pow
#include <map>            // counts
#include <numeric>        // accumulate
#include <unordered_map>  // in how many motions

#include <motionlang/core/text_lines.hpp>
#include <motionlang/metrics/captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string lemmas(std::span<const TaggedWord> words) {
  std::string out;
  for (const TaggedWord& w : words) out += (out.empty() ? "" : " ") + w.word;
  return out;
}

MOTIONLANG_BODY std::vector<std::string> three_references(std::vector<std::string> references) {
  if (references.empty()) raise<numeric_error>(302, "three_references: no reference");
  references.resize(3, references.front());
  return references;
}

namespace detail {

/// Words between blanks of any kind.
inline std::vector<std::string> blank_words(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  std::vector<std::string> out;
  for (std::size_t at = 0; (at = text.find_first_not_of(blanks, at)) != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
    out.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return out;
}

/// Pieces between single blanks, some of them empty; at least one.
inline std::vector<std::string> blank_pieces(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    out.emplace_back(text.substr(at, end - at));
    if (end == text.size()) return out;
    at = end + 1;
  }
}

using NGrams = std::map<std::string, Index>;

/// The number of times that each run of n words occurs.
inline NGrams n_grams(std::span<const std::string> words, std::size_t n) {
  NGrams out;
  for (std::size_t first = 0; first + n <= words.size(); ++first) {
    std::string gram = words[first];
    for (std::size_t i = 1; i < n; ++i) gram += ' ' + words[first + i];
    ++out[gram];
  }
  return out;
}

inline void require_captions(const char* function, std::span<const CaptionPair> pairs) {
  if (pairs.empty()) raise<numeric_error>(302, function, ": no captions");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].references.empty()) raise<numeric_error>(302, function, ": caption ", i, " has no reference");
  }
}

}  // namespace detail

MOTIONLANG_BODY BleuCounts& BleuCounts::operator+=(const BleuCounts& other) {
  for (std::size_t k = 0; k < 4; ++k) correct[k] += other.correct[k], guess[k] += other.guess[k];
  length += other.length, reference_length += other.reference_length;
  return *this;
}

MOTIONLANG_BODY BleuCounts bleu_counts(const CaptionPair& pair) {
  detail::require_captions("bleu_counts", std::span(&pair, 1));
  const auto words = detail::blank_words(pair.candidate);
  BleuCounts out{.length = std::ssize(words)};
  std::vector<std::vector<std::string>> references;
  for (const std::string& r : pair.references) references.push_back(detail::blank_words(r));
  auto off = [&](Index length) { return length < out.length ? out.length - length : length - out.length; };
  out.reference_length = std::ssize(references.front());
  for (const auto& r : references) {
    const Index length = std::ssize(r), best = out.reference_length;
    if (off(length) < off(best) || (off(length) == off(best) && length < best)) out.reference_length = length;
  }
  for (std::size_t k = 1; k <= 4; ++k) {
    detail::NGrams most;
    for (const auto& r : references) {
      for (const auto& [gram, count] : detail::n_grams(r, k)) most[gram] = std::max(most[gram], count);
    }
    for (const auto& [gram, count] : detail::n_grams(words, k)) {
      if (const auto found = most.find(gram); found != most.end()) out.correct[k - 1] += std::min(count, found->second);
    }
    out.guess[k - 1] = std::max<Index>(0, out.length - static_cast<Index>(k) + 1);
  }
  return out;
}

MOTIONLANG_BODY BleuCounts corpus_counts(std::span<const CaptionPair> pairs) {
  detail::require_captions("corpus_counts", pairs);
  BleuCounts out;
  for (const CaptionPair& p : pairs) out += bleu_counts(p);
  return out;
}

MOTIONLANG_BODY std::array<double, 4> bleu(const BleuCounts& counts) {
  const double ratio =
      (static_cast<double>(counts.length) + 1e-15) / (static_cast<double>(counts.reference_length) + 1e-9);
  const double brevity = ratio < 1 ? std::exp(1 - 1 / ratio) : 1;
  std::array<double, 4> out{};
  double product = 1;
  for (std::size_t k = 0; k < 4; ++k) {
    product *= (static_cast<double>(counts.correct[k]) + 1e-15) / (static_cast<double>(counts.guess[k]) + 1e-9);
    out[k] = brevity * std::pow(product, 1 / static_cast<double>(k + 1));
  }
  return out;
}

MOTIONLANG_BODY double rouge_l(const CaptionPair& pair, double beta) {
  detail::require_captions("rouge_l", std::span(&pair, 1));
  const auto words = detail::blank_pieces(detail::trim(pair.candidate));
  double precision = 0, recall = 0;
  for (const std::string& reference : pair.references) {
    const auto other = detail::blank_pieces(detail::trim(reference));
    std::vector<Index> longest(other.size() + 1, 0);  // for the candidate up to this word
    for (const std::string& word : words) {
      Index diagonal = 0;
      for (std::size_t j = 0; j < other.size(); ++j) {
        const Index above = longest[j + 1];
        longest[j + 1] = word == other[j] ? diagonal + 1 : std::max(above, longest[j]);
        diagonal = above;
      }
    }
    const auto common = static_cast<double>(longest.back());
    precision = std::max(precision, common / static_cast<double>(words.size()));
    recall = std::max(recall, common / static_cast<double>(other.size()));
  }
  if (precision == 0 || recall == 0) return 0;
  return (1 + beta * beta) * precision * recall / (recall + beta * beta * precision);
}

MOTIONLANG_BODY double rouge_l(std::span<const CaptionPair> pairs, double beta) {
  detail::require_captions("rouge_l", pairs);
  double sum = 0;
  for (const CaptionPair& p : pairs) sum += rouge_l(p, beta);
  return sum / static_cast<double>(pairs.size());
}

namespace detail {

/// A sentence for CIDEr: each run of words with its weight, n = 1 ... 4.
struct WeightedGrams {
  std::array<std::map<std::string, double>, 4> weights;
  std::array<double, 4> norm{};
  Index bigrams = 0;
};

}  // namespace detail

MOTIONLANG_BODY std::vector<double> cider_of_each(std::span<const CaptionPair> pairs, double sigma) {
  detail::require_captions("cider", pairs);
  using Words = std::vector<std::string>;
  std::vector<std::vector<Words>> references;
  std::array<std::unordered_map<std::string, Index>, 4> motions_with;
  for (const CaptionPair& p : pairs) {
    references.emplace_back();
    std::array<detail::NGrams, 4> any;
    for (const std::string& r : p.references) {
      references.back().push_back(detail::blank_words(r));
      for (std::size_t n = 0; n < 4; ++n) any[n].merge(detail::n_grams(references.back().back(), n + 1));
    }
    for (std::size_t n = 0; n < 4; ++n) {
      for (const auto& entry : any[n]) ++motions_with[n][entry.first];
    }
  }
  const double log_motions = std::log(static_cast<double>(pairs.size()));
  auto weighted = [&](const Words& words) {
    detail::WeightedGrams out;
    for (std::size_t n = 0; n < 4; ++n) {
      for (const auto& [gram, count] : detail::n_grams(words, n + 1)) {
        const auto found = motions_with[n].find(gram);
        const double df = found == motions_with[n].end() ? 1 : static_cast<double>(found->second);
        const double weight = static_cast<double>(count) * (log_motions - std::log(df));
        out.weights[n].emplace(gram, weight);
        out.norm[n] += weight * weight;
        if (n == 1) out.bigrams += count;
      }
      out.norm[n] = std::sqrt(out.norm[n]);
    }
    return out;
  };
  std::vector<double> scores;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto c = weighted(detail::blank_words(pairs[i].candidate));
    double sum = 0;
    for (const Words& words : references[i]) {
      const auto r = weighted(words);
      const auto apart = static_cast<double>(c.bigrams - r.bigrams);
      const double penalty = std::exp(-apart * apart / (2 * sigma * sigma));
      for (std::size_t n = 0; n < 4; ++n) {
        double common = 0;
        for (const auto& [gram, weight] : c.weights[n]) {
          const auto found = r.weights[n].find(gram);
          if (found != r.weights[n].end()) common += std::min(weight, found->second) * found->second;
        }
        if (c.norm[n] != 0 && r.norm[n] != 0) common /= c.norm[n] * r.norm[n];
        sum += common * penalty;
      }
    }
    scores.push_back(10 * sum / 4 / static_cast<double>(references[i].size()));
  }
  return scores;
}

MOTIONLANG_BODY double cider(std::span<const CaptionPair> pairs, double sigma) {
  const auto scores = cider_of_each(pairs, sigma);
  return std::accumulate(scores.begin(), scores.end(), 0.0) / static_cast<double>(scores.size());
}

MOTIONLANG_NAMESPACE_END
