// SPDX-License-Identifier: MIT
// Bodies of retrieval_evaluation.hpp.
#pragma once

#include <algorithm>  // min
#include <set>        // texts

#include <motionlang/core/formatted.hpp>
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

inline std::string retrieval_line(const char* name, const RetrievalTable& table) {
  const auto cells = [](const RetrievalMetrics& m) {
    std::string out;
    for (const double share : m.recall) out += formatted("%7.2f", share);
    return out + formatted("%8.2f", m.median_rank);
  };
  return formatted("  %-22s %s   %s\n", name, cells(table.text_to_motion).c_str(), cells(table.motion_to_text).c_str());
}
inline const char* protocol_name(RetrievalProtocol protocol) {
  switch (protocol) {
    case RetrievalProtocol::threshold:
      return "all, texts alike";
    case RetrievalProtocol::nsim:
      return "dissimilar";
    case RetrievalProtocol::guo:
      return "batches of 32";
    case RetrievalProtocol::normal:
      break;
  }
  return "all";
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

MOTIONLANG_BODY std::string retrieval_results_table(std::span<const RetrievalResult> results) {
  const char* const columns = "    R@1    R@2    R@3    R@5   R@10    MedR";
  std::string out =
      formatted("%-25s %-44s %s\n%25s%s   %s\n", "", "text to motion", "motion to text", "", columns, columns);
  for (const RetrievalResult& r : results) {
    out += detail::retrieval_line(detail::protocol_name(r.protocol), r.recorded);
    if (r.made) out += detail::retrieval_line("  generated", *r.made);
    out += detail::retrieval_line("  by chance", r.chance);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
