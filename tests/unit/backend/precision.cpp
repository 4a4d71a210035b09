// The precision of products: a prepared model keeps its own, beside models of another, whatever the process says later.
#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/precision.hpp>
#include <motionlang/backend/reference.hpp>
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
