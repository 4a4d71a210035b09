// Matrix products with packed weights at the shapes of transformers (rows x inner x columns), with nothing and with
// bias + GELU behind them, and the batched products of attention. Built twice: bench_products chooses its kernels at
// run time, as every program does; bench_products_native is compiled for this very machine (-march=native) and is its
// peer.
//
// usage: bench_products [THREADS] [--bf16] [product product_gelu product_batched ...]
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/fused.hpp>

#include "bench.hpp"
#include "product_shapes.hpp"

namespace {

using namespace bench;
using B = ml::EigenBackend<float>;

void layer(const std::string& work, const Size& s, ml::Activation act) {
  ml::Philox rng{.seed = 1};
  const auto x = ml::Tensor<B, 2>::randn({s.rows, s.inner}, rng);
  auto weight = ml::Tensor<B, 2>::randn({s.columns, s.inner}, rng) * 0.05;
  const auto bias = ml::Tensor<B, 1>::randn({s.columns}, rng);
  B::prepare(weight.data());
  const ml::Tensor<B, 1>* used = act == ml::Activation::none ? nullptr : &bias;
  report(work, s.name(), s.gflop(), [&] { ml::linear(x, weight, used, act); }, {.seconds = 0.3});
}
void batched(const Size& s) {
  ml::Philox rng{.seed = 1};
  const bool scores = s.rows == s.columns;  // q k^T, else weights v
  const auto a = ml::Tensor<B, 3>::randn({s.count, s.rows, s.inner}, rng);
  const ml::Shape shape = scores ? ml::Shape{s.count, s.columns, s.inner} : ml::Shape{s.count, s.inner, s.columns};
  const auto b = ml::Tensor<B, 3>::randn(shape, rng);
  report("product_batched", s.name(), s.gflop(), [&] { ml::matmul(a, b, {.transpose_b = scores}); }, {.seconds = 0.3});
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments asked_for(argc, argv);
  for (const Size& s : layers) {
    if (asked_for.asked("product")) layer("product", s, ml::Activation::none);
    if (asked_for.asked("product_gelu")) layer("product_gelu", s, ml::Activation::gelu);
  }
  if (asked_for.asked("product_batched")) {
    for (const Size& s : heads) batched(s);
  }
}
