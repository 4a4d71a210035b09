// SPDX-License-Identifier: MIT
/// Descriptions of motions against reference descriptions: BLEU, ROUGE-L and CIDEr, word by word. BERTScore, which
/// needs a language model, is in bert_score.hpp.
///
///     const std::vector<CaptionPair> all{{"a man walk forward", three_references({"a man walk", "someone walk"})}};
///     use(bleu(corpus_counts(all))[3], rouge_l(all), cider(all));               // published tables: times 100
///
/// A candidate is the words of the model, joined by blanks. References are the lemmas of the annotation, three for each
/// motion. Nothing is lower-cased, and punctuation stays.
/// Source  nlg-eval (pycocoevalcap), as called by TM2T (Guo et al., ECCV 2022, section 4.2 and appendix B)
#pragma once

#include <array>   // n-gram lengths
#include <span>    // corpora
#include <string>  // sentences
#include <vector>  // words

#include <motionlang/core/shape.hpp>
#include <motionlang/text/tagged_word.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct CaptionPair {
  std::string candidate;
  std::vector<std::string> references;
};

/// The words before the tags, joined by blanks.
std::string lemmas(std::span<const TaggedWord> words);
/// The first three. Of two, the first is repeated; one is taken three times. Throws numeric_error 302 without
/// references.
std::vector<std::string> three_references(std::vector<std::string> references);

// ---- BLEU
// -------------------------------------------------------------------------------------------------------------

/// The counts of BLEU. The counts of several sentences can be added. Entry k - 1 counts runs of k words.
struct BleuCounts {
  std::array<Index, 4> correct{}, guess{};
  Index length = 0, reference_length = 0;

  BleuCounts& operator+=(const BleuCounts& other);
};

///     correct_k = sum_g min(count of g in the candidate, largest count of g in a reference),   g: runs of k words
///     guess_k   = max(0, length - k + 1)
/// The reference length is the one closest to the candidate's; of two equally close ones, the shorter.
/// Source  Papineni et al., "BLEU: a method for automatic evaluation of machine translation" (ACL 2002)
/// Throws  numeric_error 302 without a reference
BleuCounts bleu_counts(const CaptionPair& pair);
/// The sums over a corpus. Throws numeric_error 302.
BleuCounts corpus_counts(std::span<const CaptionPair> pairs);

///     B_k = min(1, exp(1 - 1 / r)) (prod_{i<=k} (correct_i + 1e-15) / (guess_i + 1e-9))^(1/k),   BLEU-1 ... BLEU-4
///     r   = (length + 1e-15) / (reference length + 1e-9)
std::array<double, 4> bleu(const BleuCounts& counts);

// ---- ROUGE-L
// ----------------------------------------------------------------------------------------------------------

/// With l = the longest common subsequence of the candidate c and a reference r:
///     P = max_r l / |c|,   R = max_r l / |r|,   score = (1 + beta^2) P R / (R + beta^2 P); 0 if P or R is
/// Source  Lin, "ROUGE: a package for automatic evaluation of summaries" (2004)
/// Differs from the paper: P and R may come from different references. As published, words are separated by single
/// blanks, so two blanks in a row have an empty word between them. Throws numeric_error 302
double rouge_l(const CaptionPair& pair, double beta = 1.2);
/// The mean over a corpus. Throws numeric_error 302.
double rouge_l(std::span<const CaptionPair> pairs, double beta = 1.2);

// ---- CIDEr
// ------------------------------------------------------------------------------------------------------------

/// The score of each sentence. The references of all motions determine which words are common.
///     v_n[g] = count of g * (log N - log max(1, df(g))),   df(g) = motions with g in a reference, N = motions
///     s_n    = sum_g min(c[g], r[g]) r[g] / (|c_n| |r_n|) * exp(-(b_c - b_r)^2 / (2 sigma^2)),   b = number of bigrams
///     score  = 10 mean_n mean_r s_n
/// Source  Vedantam et al., "CIDEr: consensus-based image description evaluation" (CVPR 2015): the form of section 5.3,
///         CIDEr-D, with clipped counts and a penalty for other lengths
/// Differs from the paper: the lengths are those in bigrams, as published. For a single motion all scores are 0.
/// Throws  numeric_error 302
std::vector<double> cider_of_each(std::span<const CaptionPair> pairs, double sigma = 6);
/// The mean over a corpus. Throws numeric_error 302.
double cider(std::span<const CaptionPair> pairs, double sigma = 6);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/captions.ipp>
#endif
