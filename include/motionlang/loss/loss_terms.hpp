// SPDX-License-Identifier: MIT
/// A loss of several named and weighted terms.
#pragma once

#include <string>       // names
#include <string_view>  // beginnings of names
#include <vector>       // terms

#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct LossTerms {
  struct Term {
    std::string name;
    double weight = 1;
    Tensor<B, 0> value;  // without the weight
  };
  std::vector<Term> terms;

  void add(std::string name, double weight, Tensor<B, 0> value) {
    terms.push_back({std::move(name), weight, std::move(value)});
  }
  /// Adds the terms of another loss, with a suffix on their names.
  void append(LossTerms other, const std::string& suffix = "") {
    for (Term& t : other.terms) add(t.name + suffix, t.weight, std::move(t.value));
  }
  ///     sum of weight value
  Tensor<B, 0> total() const {
    Tensor<B, 0> sum(0.0);
    for (const Term& t : terms) sum = sum + t.value * t.weight;
    return sum;
  }
  /// The terms whose names begin with a prefix, without their weights.
  Tensor<B, 0> sum_of(std::string_view beginning) const {
    Tensor<B, 0> sum(0.0);
    for (const Term& t : terms) {
      if (t.name.starts_with(beginning)) sum = sum + t.value;
    }
    return sum;
  }
};

MOTIONLANG_NAMESPACE_END
