// Golden functions: metrics of sets of motions in a space of features, and their summaries.
#include <motionlang/metrics/accuracy.hpp>
#include <motionlang/metrics/diversity.hpp>
#include <motionlang/metrics/frechet.hpp>
#include <motionlang/metrics/summary.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;
using ml::Index;

template <class S>
ml::GaussianStatistics statistics(Case& c, const std::string& set) {
  const auto values = c.values<S>("in/" + set);
  const Index d = c.shape("in/" + set)[1];
  auto out = ml::gaussian_statistics(ml::Rows(values, d));
  c.out("mean_" + set, out.mean);
  c.out("cov_" + set, {d, d}, out.covariance);
  return out;
}

template <class S>
void actor_fid(Case& c) {
  const auto real = statistics<S>(c, "real"), other = statistics<S>(c, "other");
  c.out_scalar("fid", ml::frechet_distance(real, other));
  c.out_scalar("fid_self", ml::frechet_distance(real, real));
}
template <class S>
void guo_fid(Case& c) {
  const auto a = statistics<S>(c, "a"), b = statistics<S>(c, "b");
  c.out_scalar("fid", ml::frechet_distance(a, b));
}

template <class S>
void actor_accuracy(Case& c) {
  const auto logits = c.values<S>("in/logits");
  const Index classes = c.config()["num_classes"].as<Index>();
  const auto confusion = ml::confusion_matrix(ml::Rows(logits, classes), c.values<Index>("in/y"));
  c.out("confusion", {classes, classes}, confusion);
  c.out_scalar("accuracy", ml::accuracy(confusion));
}

/// Draws are made again from the seed; the case's own are their check.
template <class S>
void actor_diversity(Case& c) {
  const auto values = c.values<S>("in/features");
  const ml::Rows features(values, c.shape("in/features")[1]);
  const auto config = c.config();
  ml::NumpyRandom rng(config["seed"].as<std::uint32_t>());
  const auto pairs = ml::random_pairs(features.size(), config["diversity_times"].as<Index>(), rng);
  if (pairs.first != c.values<Index>("noise/diversity_first") ||
      pairs.second != c.values<Index>("noise/diversity_second"))
    ml::raise<ml::numeric_error>(302, c.name(), ": other pairs were drawn");
  c.out_scalar("diversity", ml::mean_pair_distance(features, pairs));
  const auto within = ml::pairs_within_classes(c.values<Index>("in/y"), config["num_classes"].as<Index>(),
                                               config["multimodality_times"].as<Index>(), rng);
  c.out("multimodality_first", within.first);
  c.out("multimodality_second", within.second);
  c.out_scalar("multimodality", ml::mean_pair_distance(features, within));
}

ml::IndexPairs given_pairs(const Case& c) { return {c.values<Index>("noise/first"), c.values<Index>("noise/second")}; }

template <class S>
void guo_diversity(Case& c) {
  const auto values = c.values<S>("in/activations");
  c.out_scalar("diversity", ml::mean_pair_distance(ml::Rows(values, c.shape("in/activations")[1]), given_pairs(c)));
}
template <class S>
void guo_multimodality(Case& c) {
  const auto values = c.values<S>("in/activations");
  const auto shape = c.shape("in/activations");
  c.out_scalar("multimodality", ml::multimodality(ml::Rows(values, shape[2]), shape[1], given_pairs(c)));
}

void actor_summary(Case& c) {
  const auto s = ml::actor_summary(c.config()["metric"].as<std::string>(), c.values<double>("in/values"));
  c.out_scalar("mean", s.mean);
  c.out_scalar("interval", s.half_width);
}
void guo_replications(Case& c) {
  const auto s = ml::replication_interval(c.values<double>("in/values"));
  c.out_scalar("mean", s.mean);
  c.out_scalar("half_width", s.half_width);
}

const Registration actor_fid64{"actor fid", "double", actor_fid<double>};
const Registration actor_fid32{"actor fid", "float", actor_fid<float>};
const Registration guo_fid64{"guo fid", "double", guo_fid<double>};
const Registration guo_fid32{"guo fid", "float", guo_fid<float>};
const Registration accuracy64{"actor accuracy", "double", actor_accuracy<double>};
const Registration accuracy32{"actor accuracy", "float", actor_accuracy<float>};
const Registration diversity64{"actor diversity and multimodality", "double", actor_diversity<double>};
const Registration diversity32{"actor diversity and multimodality", "float", actor_diversity<float>};
const Registration guo_diversity64{"guo diversity", "double", guo_diversity<double>};
const Registration guo_diversity32{"guo diversity", "float", guo_diversity<float>};
const Registration guo_multimodality64{"guo multimodality", "double", guo_multimodality<double>};
const Registration guo_multimodality32{"guo multimodality", "float", guo_multimodality<float>};
const Registration summary{"actor metric summary", "double", actor_summary};
const Registration replications{"guo replication statistics", "double", guo_replications};

}  // namespace
