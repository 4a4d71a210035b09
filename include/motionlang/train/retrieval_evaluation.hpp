// SPDX-License-Identifier: MIT
/// Evaluates TMR: retrieval by the protocols of its paper, beside the results of chance.
///
///     const LatentTable table = latents_of(model, data.test, nullptr);
///     const auto e = sentences.encode<B>(table.texts).tokens.rows;
///     for (const RetrievalResult& r : retrieval_results(table, nullptr, Rows(e.span(), e.size(1)), options))
///       use(r.protocol, r.recorded, r.chance);
///
/// Source   TMR (Petrovich, Black, Varol, ICCV 2023), tables 1 and 2; thesis 5.3.1
#pragma once

#include <optional>  // motions that were made
#include <span>      // results
#include <string>    // the table
#include <vector>    // protocols

#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/train/text_motion_batch.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct RetrievalResult {
  RetrievalProtocol protocol{};
  RetrievalTable recorded;
  std::optional<RetrievalTable> made{};  // of motions generated for the texts
  RetrievalTable chance;                 // the mean of ten tables of random latents
};

/// The protocols normal, threshold, nsim and guo; nsim only with ids, guo only with enough motions for a batch.
/// made       latents of motions for the same texts; null: none
/// sentences  (texts, d) unit rows
/// options    with the ids of the motions. Without ids of dissimilar texts, it chooses up to a hundred.
std::vector<RetrievalResult> retrieval_results(const LatentTable& table, const LatentTable* made,
                                               const Rows<float>& sentences, RetrievalOptions options);

/// The results below a header, in both directions: recorded motions, generated ones if there are any, and chance.
std::string retrieval_results_table(std::span<const RetrievalResult> results);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/retrieval_evaluation.ipp>
#endif
