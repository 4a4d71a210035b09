// The precision of products: a prepared model keeps its own, beside models of another, whatever the process says later.
#include <doctest/doctest.h>

#include <limits>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/kernel_ops.hpp>
#include <motionlang/backend/precision.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/conv1d.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/nn/multihead_attention.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

#include "../../support/kernel_sets.hpp"
#include "../../support/tensors.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using kernel_sets::InPrecision;
using ml::Precision;

namespace {

template <class C = B>
ml::TransformerEncoder<C> encoder() {
  ml::Philox rng{.seed = 3};
  return {{.d_model = 64, .heads = 4, .d_ff = 96, .layers = 2}, rng};
}
ml::Sequences<B> input() {
  const ml::Offsets offsets{40, 7, 90};
  return {tensors::normal<B, 2>({offsets.rows(), 64}, 5), offsets};
}

}  // namespace

TEST_CASE("models of two precisions stand beside each other, and a later setting of the process changes neither") {
  auto exact = encoder(), rounded = encoder();
  ml::prepare(exact);
  ml::prepare(rounded, Precision::bf16);
  CHECK(ml::precision_of(exact) == Precision::fp32);
  CHECK(ml::precision_of(rounded) == Precision::bf16);
  const auto x = input();
  const auto in_fp32 = exact(x).rows, in_bf16 = rounded(x).rows;
  CHECK_FALSE(tensors::same_bits(in_fp32, in_bf16));

  const InPrecision later(Precision::bf16);
  CHECK(tensors::same_bits(exact(x).rows, in_fp32));
  const auto unprepared = encoder();
  CHECK(ml::precision_of(unprepared) == Precision::bf16);  // that of the process
  CHECK(tensors::same_bits(unprepared(x).rows, in_bf16));  // attention rounds as well
  const Threads two(2);
  CHECK(tensors::same_bits(rounded(x).rows, in_bf16));
  CHECK(tensors::same_bits(exact(x).rows, in_fp32));
}

TEST_CASE("attention takes the precision of its weights, and an explicit one of its options") {
  ml::Philox rng{.seed = 4};
  ml::MultiheadAttention<B> layer(64, 4, 0.0, rng);
  const auto x = input();
  const auto qkv = layer.project(x.rows);
  const auto in_fp32 = layer.attend(qkv, x.offsets, {});
  ml::prepare(layer, Precision::bf16);
  const auto in_bf16 = layer.attend(qkv, x.offsets, {});
  CHECK_FALSE(tensors::same_bits(in_fp32, in_bf16));
  const auto read = [&](Precision p) { return ml::self_attention(qkv, x.offsets, {.heads = 4, .precision = p}); };
  CHECK(tensors::same_bits(layer.out_proj(read(Precision::bf16)), in_bf16));
  CHECK_FALSE(tensors::same_bits(layer.out_proj(read(Precision::fp32)), in_bf16));
}

TEST_CASE("doubles, and backends without kernels, calculate as they are") {
  ml::Philox rng{.seed = 6};
  ml::Linear<ml::EigenBackend<double>> doubles(8, 8, rng);
  ml::prepare(doubles, Precision::bf16);
  CHECK(ml::precision_of(doubles) == Precision::fp32);
  ml::Linear<ml::ReferenceBackend<float>> plain(8, 8, rng);
  const auto x = tensors::normal<ml::ReferenceBackend<float>, 2>({3, 8}, 7);
  const auto before = plain(x);
  ml::prepare(plain, Precision::bf16);
  CHECK(tensors::same_bits(plain(x), before));
}

TEST_CASE("a weight that other kernels have packed keeps its precision") {
  const auto layers = [] {
    ml::Philox rng{.seed = 8};
    return std::pair(ml::Linear<B>(64, 48, rng), ml::Conv1d<B>(64, 48, 3, {.padding = 1}, rng));
  };
  auto [linear, convolution] = layers();
  ml::prepare(linear);
  ml::prepare(convolution);
  const auto x = input(), few = ml::Sequences<B>{tensors::normal<B, 2>({3, 64}, 9), ml::Offsets{3}};
  kernel_sets::with_every_kernel<float>([&] {
    if (ml::product_precision() != Precision::fp32) return;
    auto [fresh, fresh_convolution] = layers();
    ml::prepare(fresh);
    ml::prepare(fresh_convolution);
    const InPrecision process(Precision::bf16);
    CHECK(ml::precision_of(linear) == Precision::fp32);
    for (const auto& rows : {x, few}) {
      CHECK(tensors::same_bits(linear(rows.rows), fresh(rows.rows)));
      CHECK(tensors::same_bits(convolution(rows).rows, fresh_convolution(rows).rows));
    }
  });
}

TEST_CASE("a weight is packed with a check that its values are finite, and is still what it was") {
  using Kernels = ml::KernelOps<float>;
  std::vector<float> values(6 * 4, 0.5f);
  const auto good = ml::Tensor<B, 2>::from(values, {6, 4});
  CHECK(Kernels::precision_of(good.data()) == ml::product_precision());
  CHECK(Kernels::prepare(good.data(), Precision::bf16));
  CHECK(Kernels::precision_of(good.data()) == Precision::bf16);
  CHECK(good.to_vector() == values);
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    values[13] = wrong;
    CHECK_FALSE(Kernels::prepare(ml::Tensor<B, 2>::from(values, {6, 4}).data(), Precision::fp32));
  }
}
