// Golden functions that need no tensors: masks, statistics.
#include <motionlang/features/statistics.hpp>
#include <motionlang/tensor/sequences.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;

void lengths_to_mask(Case& c) {
  const auto lengths = c.values<ml::Index>("in/lengths");
  const auto mask = ml::lengths_to_mask(lengths);
  const ml::Index count = std::ssize(lengths);
  c.out("mask", {count, count == 0 ? 0 : std::ssize(mask) / count}, mask);
}

void feature_statistics(Case& c) {
  ml::FeatureStatistics statistics;
  for (const std::string& clip : c.names("in/")) {
    const auto values = c.values<double>("in/" + clip);
    statistics.add(std::span<const double>(values), c.shape("in/" + clip)[1]);
  }
  c.out("mean", statistics.mean());
  c.out("std", statistics.standard_deviation());
}

const Registration registrations[] = {{"lengths to mask", "integers", lengths_to_mask},
                                      {"concatenated feature statistics", "double", feature_statistics}};

}  // namespace
