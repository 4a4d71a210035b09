// Matrix products with packed weights at the shapes of transformers (rows x inner x columns), with nothing and with bias + GELU behind
// them, and the batched products of attention. Built twice: bench_products chooses its kernels at run time, as every program does;
// bench_products_native is compiled for this very machine (-march=native) and is its peer.
//
// usage: bench_products [THREADS] [--bf16] [product product_gelu product_batched ...]
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/fused.hpp>

#include "bench.hpp"

namespace {

using namespace bench;
using ml::Index;
using B = ml::EigenBackend<float>;

struct Size {
  Index rows, inner, columns, count = 1;

  double gflop() const { return 2e-9 * static_cast<double>(rows * inner * columns * count); }
  std::string name() const {
    auto text = std::to_string(rows) + "x" + std::to_string(inner) + "x" + std::to_string(columns);
    return count == 1 ? text : text + " x" + std::to_string(count);
  }
};
// Denoiser, autoencoders, DistilBERT, CLIP; frames into the model; one token.
constexpr Size layers[] = {{204, 512, 512},   {408, 512, 1536},  {408, 512, 1024}, {408, 1024, 512},
                           {1632, 512, 1536}, {3264, 1024, 512}, {202, 256, 256},  {202, 1024, 256},
                           {6464, 256, 1024}, {32, 768, 3072},   {32, 3072, 768},  {1024, 768, 3072},
                           {77, 512, 2048},   {77, 2048, 512},   {200, 205, 512},  {1, 512, 2048}};
constexpr Size heads[] = {{204, 128, 204, 4}, {204, 204, 128, 4}, {202, 64, 202, 128}, {202, 202, 64, 128}};

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
