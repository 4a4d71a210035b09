// SPDX-License-Identifier: MIT
/// The sum of a vector over the parts of a batch, which can be differentiated.
#pragma once

#include <utility>  // move
#include <vector>   // numbers

#include <motionlang/core/batch_sums.hpp>
#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <Backend B>
typename B::tensor sum_over_parts(const typename B::tensor& own, const BatchSums& sums, double* count = nullptr) {
  const auto values = B::to_span(own);
  std::vector<double> numbers(values.begin(), values.end());
  if (count != nullptr) numbers.push_back(*count);
  sums.add(numbers);
  if (count != nullptr) *count = numbers.back();
  std::vector<typename B::scalar> out(values.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<typename B::scalar>(numbers[i]);
  return B::from_span(out, B::shape(own));
}

}  // namespace detail

///     S = s_1 + ... + s_n,   dL/ds_k = dL_1/dS + ... + dL_n/dS   with L = L_1 + ... + L_n
/// own    s_k, the vector of this part;   L_k: the loss of this part
/// sums   must live until the backward pass, in which the parts meet again
/// count  a number without derivatives that is replaced by its sum, too
template <Backend B>
Tensor<B, 1> sum_over_parts(const Tensor<B, 1>& own, const BatchSums& sums, double* count = nullptr) {
  if constexpr (AutodiffBackend<B>)
    return Tensor<B, 1>(B::sum_over_parts(own.data(), sums, count));
  else
    return Tensor<B, 1>(detail::sum_over_parts<B>(own.data(), sums, count));
}

MOTIONLANG_NAMESPACE_END
