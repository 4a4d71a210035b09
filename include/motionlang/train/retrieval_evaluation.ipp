// SPDX-License-Identifier: MIT
// Bodies of retrieval_evaluation.hpp.
#pragma once

#include <algorithm>  // min
#include <set>        // texts

#include <motionlang/core/rng.hpp>
#include <motionlang/train/retrieval_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The mean of tables of random latents.
inline RetrievalTable chance_table(RetrievalProtocol protocol, std::size_t texts, const Rows<float>& sentences,
                                   const RetrievalOptions& options) {
  constexpr Index width = 8;
  std::vector<RetrievalTable> tables;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    auto rng = Philox{.seed = seed}.split("chance");
    std::vector<float> of_texts(texts * width), of_motions(of_texts.size());
    rng.normal(std::span<float>(of_texts));
    rng.normal(std::span<float>(of_motions));
    tables.push_back(retrieve(protocol, Rows(std::span<const float>(of_texts), width),
                              Rows(std::span<const float>(of_motions), width), sentences, options));
  }
  return mean_table(tables);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<RetrievalResult> retrieval_results(const LatentTable& table, const LatentTable* made,
                                                               const Rows<float>& sentences, RetrievalOptions options) {
  if (options.nsim_ids.empty()) {
    const std::set<std::string> different(table.texts.begin(), table.texts.end());
    const auto count = std::min<Index>(100, std::ssize(different));
    if (count >= 2) {
      for (const Index i : dissimilar_subset(sentences, options.ids, count))
        options.nsim_ids.push_back(options.ids[static_cast<std::size_t>(i)]);
    }
  }
  const Rows texts(std::span(table.text), table.width), motions(std::span(table.motion), table.width);
  std::vector<RetrievalResult> out;
  using enum RetrievalProtocol;
  for (const RetrievalProtocol protocol : {normal, threshold, nsim, guo}) {
    if (protocol == guo && std::ssize(table.texts) < options.batch) continue;
    if (protocol == nsim && options.nsim_ids.empty()) continue;
    RetrievalResult& r = out.emplace_back();
    r.protocol = protocol;
    r.recorded = retrieve(protocol, texts, motions, sentences, options);
    if (made != nullptr)
      r.made = retrieve(protocol, texts, Rows(std::span<const float>(made->motion), made->width), sentences, options);
    r.chance = detail::chance_table(protocol, table.texts.size(), sentences, options);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
