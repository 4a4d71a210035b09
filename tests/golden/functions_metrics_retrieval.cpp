// Golden functions: retrieval, and matching in the space of Guo's networks.
#include <motionlang/generate/text_latents.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/metrics/retrieval.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;
using ml::Index;

ml::RetrievalTable rounded_as_asked(const ml::RetrievalTable& table, const ml::JsonView& config) {
  const int digits = config.value_or("rounding", -1);
  return digits < 0 ? table : ml::rounded(table, digits);
}

template <class S>
void retrieval_metrics(Case& c) {
  const auto sims = c.values<S>("in/sims");
  const ml::Rows similarities(sims, c.shape("in/sims")[1]);
  std::vector<std::uint8_t> alike;
  if (const double threshold = c.config().value_or("threshold", -1.0); threshold >= 0) {
    const auto sentences = c.values<S>("in/sent_emb");
    alike = ml::texts_alike(ml::Rows(sentences, c.shape("in/sent_emb")[1]), threshold);
  }
  for (const auto& [name, value] : named(rounded_as_asked(ml::retrieval_table(similarities, alike), c.config())))
    c.out_scalar(name, value);
  using enum ml::RetrievalDirection;
  c.out("t2m/ranks", ml::retrieval_ranks(similarities, text_to_motion, alike));
  c.out("m2t/ranks", ml::retrieval_ranks(similarities, motion_to_text, alike));
}

ml::RetrievalProtocol protocol_of(const std::string& name) {
  using enum ml::RetrievalProtocol;
  return name == "normal" ? normal : name == "threshold" ? threshold : name == "nsim" ? nsim : guo;
}

std::vector<std::string> strings_of(const ml::JsonView& text, const std::string& name) {
  return text.contains(name) ? text[name].as<std::vector<std::string>>() : std::vector<std::string>{};
}

template <class S>
void retrieval_protocols(Case& c) {
  const auto x = c.values<S>("in/text_latents"), y = c.values<S>("in/motion_latents");
  const auto e = c.has("in/sent_emb") ? c.values<S>("in/sent_emb") : std::vector<S>{};
  const ml::Rows texts(x, c.shape("in/text_latents")[1]), motions(y, c.shape("in/motion_latents")[1]),
      sentences(e, c.has("in/sent_emb") ? c.shape("in/sent_emb")[1] : 1);
  const ml::RetrievalOptions options{.threshold = c.config().value_or("threshold", 0.95),
                                     .batch = c.config().value_or("batch", Index{32}),
                                     .ids = strings_of(c.text(), "keyids"),
                                     .nsim_ids = strings_of(c.text(), "nsim_keyids")};
  for (const auto& protocol : c.config()["protocols"].as<std::vector<std::string>>()) {
    const auto table = ml::retrieve(protocol_of(protocol), texts, motions, sentences, options);
    for (const auto& [name, value] : named(ml::rounded(table))) c.out_scalar(protocol + "/" + name, value);
  }
}

void guo_batches(Case& c) {
  const Index batch = c.config()["batch"].as<Index>();
  const auto batches = ml::guo_batches(c.config()["n"].as<Index>(), batch);
  std::vector<Index> flat;
  for (const auto& b : batches) flat.insert(flat.end(), b.begin(), b.end());
  c.out("batches", {std::ssize(batches), batch}, flat);
}

template <class S>
void r_precision(Case& c) {
  const auto text = c.values<S>("in/text"), motion = c.values<S>("in/motion");
  const auto shape = c.shape("in/text");
  const ml::Rows all_texts(text, shape[2]), all_motions(motion, shape[2]);
  const bool by_text = c.config()["rows"].as<std::string>() == "texts";
  ml::MatchingMetric metric;
  for (Index b = 0; b < shape[0]; ++b) {
    auto queries = all_texts.slice(b * shape[1], shape[1]), answers = all_motions.slice(b * shape[1], shape[1]);
    if (!by_text) std::swap(queries, answers);
    metric.add(queries, answers);
    if (b > 0) continue;
    const auto table = ml::distances(queries, answers);
    c.out("distance_first_batch", {shape[1], shape[1]}, table);
    const auto order = ml::nearest_first(ml::Rows(table, shape[1]));
    c.out("ranking_first_batch", {shape[1], shape[1]}, order);
    std::vector<std::uint8_t> found;  // the own answer among the first 1, 2, 3
    for (Index i = 0; i < shape[1]; ++i) {
      const auto row = order.begin() + i * shape[1];
      for (Index k = 1; k <= 3; ++k) found.push_back(std::find(row, row + k, i) != row + k ? 1 : 0);
    }
    c.out("top_k_first_batch", {shape[1], 3}, found);
  }
  c.out_scalar("matching_score", metric.matching_score());
  c.out("r_precision", std::vector<double>{metric.r_precision(1), metric.r_precision(2), metric.r_precision(3)});
}

template <class S>
void multimodal_distance(Case& c) {
  const auto text = c.values<S>("in/text"), motion = c.values<S>("in/motion");
  const ml::Rows texts(text, c.shape("in/text")[1]), motions(motion, c.shape("in/motion")[1]);
  ml::MatchingMetric metric;
  metric.add(texts, motions);
  c.out("per_pair", ml::paired_distances(texts, motions));
  c.out_scalar("sum", metric.matching_score() * static_cast<double>(metric.queries()));
  c.out("top_k_hits", std::vector<Index>{metric.hits(1), metric.hits(2), metric.hits(3)});
}

const Registration ranks64{"tmr retrieval metrics", "double", retrieval_metrics<double>};
const Registration ranks32{"tmr retrieval metrics", "float", retrieval_metrics<float>};
const Registration protocols64{"tmr retrieval protocols", "double", retrieval_protocols<double>};
const Registration protocols32{"tmr retrieval protocols", "float", retrieval_protocols<float>};
const Registration batches{"tmr guo batches", "double", guo_batches};
const Registration precision64{"guo r-precision and matching score", "double", r_precision<double>};
const Registration precision32{"guo r-precision and matching score", "float", r_precision<float>};
const Registration distance64{"guo multimodal distance", "double", multimodal_distance<double>};
const Registration distance32{"guo multimodal distance", "float", multimodal_distance<float>};

}  // namespace
