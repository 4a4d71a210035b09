// SPDX-License-Identifier: MIT
/// The nearest motions of some texts of a table, for a page of ranked galleries (view/retrieval_page.hpp).
///
///     const auto queries = ranked_queries(table, sentences, data.test, {.queries = 20, .motions = 5});
///
/// Source  thesis figures 5.3 to 5.7
#pragma once

#include <vector>  // queries

#include <motionlang/metrics/rows.hpp>
#include <motionlang/train/text_motion_batch.hpp>
#include <motionlang/view/retrieval_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct RankedQueryOptions {
  Index queries = 20;  // texts, spread evenly over the table
  Index motions = 5;   // nearest motions of each
};
/// sentences  (texts, d) unit rows, whose similarity is that of the texts
/// part       the motions of the table, in its order
/// Throws     shape_error 204 for other counts
std::vector<RankedQuery> ranked_queries(const LatentTable& table, const Rows<float>& sentences,
                                        const std::vector<DescribedMotion>& part,
                                        const RankedQueryOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/ranked_queries.ipp>
#endif
