// SPDX-License-Identifier: MIT
// Bodies of ranked_queries.hpp.
#pragma once

#include <algorithm>  // sort, min
#include <numeric>    // iota

#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/train/ranked_queries.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<RankedQuery> ranked_queries(const LatentTable& table, const Rows<float>& sentences,
                                                        const std::vector<DescribedMotion>& part,
                                                        const RankedQueryOptions& options) {
  const Rows<float> texts(table.text, table.width), motions(table.motion, table.width);
  const Index n = texts.size();
  detail::require_same_count("ranked_queries: sentences", sentences.size(), n);
  detail::require_same_count("ranked_queries: motions", std::ssize(part), n);
  const auto similarity = cosine_similarities(texts, motions);
  const auto ranks = retrieval_ranks(Rows<double>(similarity, n), RetrievalDirection::text_to_motion);
  const auto score = [](double cosine) { return (1 + cosine) / 2; };
  std::vector<RankedQuery> out;
  const Index count = std::min(options.queries, n);
  for (Index k = 0; k < count; ++k) {
    const Index query = k * n / count;
    const auto row = std::span(similarity).subspan(static_cast<std::size_t>(query * n), static_cast<std::size_t>(n));
    std::vector<Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
      return row[static_cast<std::size_t>(a)] > row[static_cast<std::size_t>(b)];
    });
    RankedQuery q{table.texts[static_cast<std::size_t>(query)], 1 + ranks[static_cast<std::size_t>(query)]};
    for (Index place = 0; place < std::min(options.motions, n); ++place) {
      const auto i = static_cast<std::size_t>(order[static_cast<std::size_t>(place)]);
      const auto one = sentences[query], other = sentences[static_cast<Index>(i)];
      double product = 0;
      for (std::size_t c = 0; c < one.size(); ++c)
        product += static_cast<double>(one[c]) * static_cast<double>(other[c]);
      q.motions.push_back({static_cast<Index>(i), part[i].id, table.texts[i], score(row[i]), score(product),
                           static_cast<Index>(i) == query});
    }
    out.push_back(std::move(q));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
