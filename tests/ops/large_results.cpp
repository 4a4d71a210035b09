// Products whose result is larger than the nearer caches, which walk over it in another order (float) or write it past
// the caches (bfloat16): the same bits as a few rows at a time.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/fused.hpp>

#include <doctest/doctest.h>
#include <algorithm>

#include "../support/kernel_sets.hpp"
#include "../support/tensors.hpp"
#include "../support/threads.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

/// m rows of n columns; `few` at a time are smaller than any cache.
template <class S>
void check_large(Index m, Index n, Index k = 5) {
  using B = ml::EigenBackend<S>;
  const Index few = 200;
  const auto x = tensors::normal<B, 2>({m, k}, 1), weight = tensors::normal<B, 2>({n, k}, 2),
             residual = tensors::normal<B, 2>({m, n}, 3);
  const auto bias = tensors::normal<B, 1>({n}, 4);
  const auto turned = ml::transpose(x);
  const ml::Tensor<B, 1>* const no_bias = nullptr;
  for (int threads : {1, 2}) {
    const Threads set(threads);
    const auto whole = ml::linear(x, weight, &bias, ml::Activation::relu, &residual),
               plain = ml::linear(x, weight, no_bias),
               added = ml::linear(x, weight, no_bias, ml::Activation::none, &residual);
    CHECK(tensors::same_bits(ml::matmul(turned, weight, {.transpose_a = true, .transpose_b = true}), plain));
    for (Index top = 0; top < m; top += few) {
      const Index end = std::min(m, top + few);
      const auto rows = ml::slice(x, 0, top, end), rest = ml::slice(residual, 0, top, end);
      CHECK(tensors::same_bits(ml::slice(whole, 0, top, end),
                               ml::linear(rows, weight, &bias, ml::Activation::relu, &rest)));
      CHECK(tensors::same_bits(ml::slice(plain, 0, top, end), ml::linear(rows, weight, no_bias)));
      CHECK(tensors::same_bits(ml::slice(added, 0, top, end),
                               ml::linear(rows, weight, no_bias, ml::Activation::none, &rest)));
    }
  }
}

}  // namespace

TEST_CASE_TEMPLATE("every instruction set", S, float, double) {
  kernel_sets::with_every_kernel<S>([] {
    check_large<S>(8203, 512);
    check_large<S>(8203, 520);        // the last panel is not whole
    check_large<S>(1030, 1024);       // rows a multiple of the page size apart
    check_large<S>(1200, 1024, 130);  // the whole and its parts, of 200 rows each, large enough for tiles of floats
    check_large<S>(8200, 520, 260);
    check_large<S>(2200, 520, 1024);   // rows that are copied, a few panels at a time
    check_large<S>(1200, 1000, 1100);  // k in blocks
    check_large<S>(1200, 1000, 2048);
  });
}

TEST_CASE("in bfloat16") {
  kernel_sets::with_every_bf16_kernel([] {
    check_large<float>(8203, 512);
    check_large<float>(8203, 520);
    check_large<float>(1030, 1024);
    check_large<float>(1030, 1024, 600);  // k in pieces
  });
}
