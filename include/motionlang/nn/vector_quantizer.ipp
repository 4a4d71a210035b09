// SPDX-License-Identifier: MIT
// Bodies of vector_quantizer.hpp.
#pragma once

#include <cmath>  // exp, log

#include <motionlang/nn/vector_quantizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double code_perplexity(std::span<const Index> codes, Index codebook) {
  std::vector<double> count(static_cast<std::size_t>(codebook));
  for (Index k : codes) count.at(static_cast<std::size_t>(k)) += 1;
  double entropy = 0;
  for (double n : count) {
    const double p = n / static_cast<double>(std::max<std::size_t>(1, codes.size()));
    entropy -= p * std::log(p + 1e-10);
  }
  return std::exp(entropy);
}

MOTIONLANG_NAMESPACE_END
