// SPDX-License-Identifier: MIT
/// Laws of Backend: algebra that holds whatever the numbers are. Parity with the reference and derivatives are in
/// tests/ops. A, B, C are matrices, x, y tensors of any shape, <x, y> = sum(x y):
///
///     handles      what is made without anything, and what was moved from, has the shape (0) and no numbers; it can be
///                  assigned to again, and operations refuse it
///     movement     permute, reshape, transpose, slice with concat, gather with its inverse: there and back, bit by bit
///     sharing      an operation on a temporary never shows through another handle or a view of the same memory
///     reduction    sums over axes in any order are equal; max(x) is in x and at least every x; of nothing 0 and
///                  -infinity
///     product      (A B) C = A (B C),   (A B)^T = B^T A^T,   A I = A,   A (B + C) = A B + A C
///     adjoint      <broadcast x, y> = <x, sum y>,   <gather x, y> = <x, scatter_add y>,   <A x, y> = <x, A^T y>
///     softmax      rows sum to 1; softmax(x + c) = softmax(x) for one c per row
///     layer norm   rows have mean 0 and variance 1; layer_norm(a x + c) = layer_norm(x) for a > 0
///     attention    one key: its value; equal keys: the mean of the values; the order of keys and a shift of all keys
///                  do not matter; heads are independent; a causal row does not see later ones
///     batch        the rows of a sequence have the same bits alone, in a batch, on any number of threads
#pragma once

#include <doctest/doctest.h>
#include <limits>

#include <motionlang/tensor/fused.hpp>

#include "../support/check_error.hpp"
#include "../support/tensors.hpp"
#include "../support/threads.hpp"

namespace laws {

namespace ml = motionlang;
using ml::Index;
using tensors::distance, tensors::normal, tensors::same_bits;

/// Rounding of a sum of some dozen terms.
template <ml::Backend B>
inline constexpr double sum_tolerance = 8 * tensors::tolerance<typename B::scalar>;

template <ml::Backend B>
void handle_laws() {
  const typename B::tensor nothing{};
  CHECK(ml::Shape(B::shape(nothing)) == ml::Shape{0});
  CHECK(std::span<const typename B::scalar>(B::to_span(nothing)).empty());
  auto x = normal<B, 2>({3, 4}, 1);
  const auto values = x.to_vector();
  auto y = std::move(x);
  for (int again = 0; again < 2; ++again) {
    CHECK(y.to_vector() == values);
    CHECK(x.shape() == ml::Shape{0});  // NOLINT: what is left after a move is what is tested
    CHECK_FALSE(x.defined());
    CHECK(x.to_vector().empty());
    CHECK_ERROR(ml::exp(x), "[motionlang.shape.206]");
    CHECK_ERROR(x + x, "[motionlang.shape.206]");
    CHECK_ERROR(x.at(0, 0), "[motionlang.shape.206]");
    x = y;
    CHECK(x.to_vector() == values);
    y = std::move(x);
  }
}

template <ml::Backend B>
void movement_laws() {
  const auto x = normal<B, 3>({3, 4, 5}, 1);
  CHECK(same_bits(ml::permute(ml::permute(x, {2, 0, 1}), {1, 2, 0}), x));
  CHECK(same_bits(ml::reshape<3>(ml::reshape<1>(x, {60}), {3, 4, 5}), x));
  CHECK(same_bits(ml::broadcast_to<3>(x, x.shape()), x));
  for (int axis = 0; axis < 3; ++axis) {
    const Index n = x.size(axis);
    CHECK(same_bits(ml::concat(axis, ml::slice(x, axis, 0, 1), ml::slice(x, axis, 1, n), ml::slice(x, axis, n, n)), x));
  }
  const auto a = normal<B, 2>({4, 3}, 2);
  CHECK(same_bits(ml::transpose(ml::transpose(a)), a));
  const std::vector<Index> order{2, 0, 3, 1}, inverse{1, 3, 0, 2};
  CHECK(same_bits(ml::gather(ml::gather(a, order), inverse), a));
  CHECK(same_bits(ml::scatter_add(ml::gather(a, order), order, 4), a));
}

/// f(x) for a temporary x while another handle, and one of a part of its memory, are alive.
template <ml::Backend B, class F>
void sharing_law(F f) {
  const auto original = normal<B, 2>({6, 7}, 3);
  const auto values = original.to_vector();
  auto handle = original;
  f(std::move(handle));
  f(ml::slice(original, 0, 1, 4));
  f(ml::reshape<2>(original, {7, 6}));
  CHECK(original.to_vector() == values);
}
template <ml::Backend B>
void sharing_laws() {
  using T = ml::Tensor<B, 2>;
  sharing_law<B>([](T x) { return std::move(x) + T(1.0); });
  sharing_law<B>([](T x) { return T(1.0) - std::move(x); });
  sharing_law<B>([](T x) { return std::move(x) * T(2.0); });
  sharing_law<B>([](T x) { return std::move(x) / T(2.0); });
  sharing_law<B>([](T x) { return ml::maximum(std::move(x), T(0.0)); });
  sharing_law<B>([](T x) { return ml::exp(std::move(x)); });
  sharing_law<B>([](T x) { return ml::sqrt(std::move(x)); });
  sharing_law<B>([](T x) { return ml::tanh(std::move(x)); });
  sharing_law<B>([](T x) { return ml::softmax(x); });
  sharing_law<B>([](T x) { return ml::activate(x, ml::Activation::gelu); });
}

template <ml::Backend B>
void reduction_laws() {
  const auto x = normal<B, 3>({3, 4, 5}, 4);
  const auto all = ml::sum(x);
  CHECK(distance(ml::sum(ml::sum(ml::sum(x, 0), 0), 0), all) < sum_tolerance<B>);
  CHECK(distance(ml::sum(ml::sum(ml::sum(x, 2), 1), 0), all) < sum_tolerance<B>);
  CHECK(distance(ml::sum(ml::permute(x, {2, 1, 0}), 0), ml::transpose(ml::sum(x, 2))) < sum_tolerance<B>);
  for (int axis = 0; axis < 3; ++axis) {
    const auto largest = ml::max(x, axis);
    ml::Shape kept = x.shape();
    kept[axis] = 1;
    const auto again = ml::reshape<3>(largest, {kept[0], kept[1], kept[2]});
    CHECK(same_bits(ml::maximum(x, again), ml::broadcast_to<3>(again, x.shape())));  // at least every x
    CHECK(same_bits(ml::max(ml::maximum(x, again), axis), largest));
    CHECK(same_bits(ml::max(again, axis), largest));
  }
  // of nothing: 0, and less than every number
  for (int axis = 0; axis < 3; ++axis) {
    ml::Shape none{3, 4, 5};
    none[axis] = 0;
    const auto nothing = ml::Tensor<B, 3>::zeros({none[0], none[1], none[2]});
    const auto total = ml::sum(nothing, axis), largest = ml::max(nothing, axis);
    CHECK(total.shape() == none.without(axis));
    for (const auto s : total.span()) CHECK(s == 0);
    for (const auto s : largest.span()) CHECK(s == -std::numeric_limits<typename B::scalar>::infinity());
    const int other = axis == 0 ? 1 : 0;  // nothing is left
    CHECK(ml::sum(nothing, other).shape() == none.without(other));
    CHECK(ml::max(nothing, other).to_vector().empty());
  }
}

template <ml::Backend B>
void product_laws() {
  using T = ml::Tensor<B, 2>;
  const auto a = normal<B, 2>({5, 7}, 5), b = normal<B, 2>({7, 4}, 6), c = normal<B, 2>({7, 4}, 7),
             d = normal<B, 2>({4, 9}, 8);
  const auto ab = ml::matmul(a, b);
  CHECK(distance(ml::matmul(ab, d), ml::matmul(a, ml::matmul(b, d))) < 4 * sum_tolerance<B>);
  CHECK(distance(ml::transpose(ab), ml::matmul(b, a, {.transpose_a = true, .transpose_b = true})) < sum_tolerance<B>);
  CHECK(distance(ml::matmul(a, ml::transpose(b), {.transpose_b = true}), ab) < sum_tolerance<B>);
  CHECK(distance(ml::matmul(ml::transpose(a), b, {.transpose_a = true}), ab) < sum_tolerance<B>);
  CHECK(distance(ml::matmul(a, b + c), ab + ml::matmul(a, c)) < sum_tolerance<B>);
  std::vector<typename B::scalar> ones(49);
  for (std::size_t i = 0; i < 7; ++i) ones[8 * i] = 1;
  CHECK(same_bits(ml::matmul(a, T::from(ones, {7, 7})), a));

  const auto batch = normal<B, 3>({2, 5, 7}, 9), right = normal<B, 3>({2, 7, 4}, 10);
  const auto product = ml::matmul(batch, right);
  for (Index i = 0; i < 2; ++i) {
    const auto of = [i](const ml::Tensor<B, 3>& t) {
      return ml::reshape<2>(ml::slice(t, 0, i, i + 1), {t.size(1), t.size(2)});
    };
    CHECK(same_bits(of(product), ml::matmul(of(batch), of(right))));
  }
}

template <ml::Backend B>
void adjoint_laws() {
  const auto inner = [](const auto& x, const auto& y) { return ml::sum(x * y); };
  const auto x = normal<B, 2>({4, 1}, 11);
  const auto y = normal<B, 3>({2, 4, 3}, 12);
  const auto summed = ml::reshape<2>(ml::sum(ml::sum(y, 0), 1), {4, 1});
  CHECK(distance(inner(ml::broadcast_to<3>(x, y.shape()), y), inner(x, summed)) < sum_tolerance<B>);
  CHECK(distance(ml::sum(x * y), inner(x, summed)) < sum_tolerance<B>);  // broadcasting inside an operation

  const std::vector<Index> rows{3, 0, 3, 1, 1, 3};
  const auto u = normal<B, 2>({4, 5}, 13), v = normal<B, 2>({6, 5}, 14);
  CHECK(distance(inner(ml::gather(u, rows), v), inner(u, ml::scatter_add(v, rows, 4))) < sum_tolerance<B>);

  const auto a = normal<B, 2>({6, 4}, 15);
  CHECK(distance(inner(ml::matmul(a, u), v), inner(u, ml::matmul(a, v, {.transpose_a = true}))) < sum_tolerance<B>);
}

template <ml::Backend B>
void normalisation_laws() {
  using T = ml::Tensor<B, 2>;
  const auto x = normal<B, 2>({5, 37}, 16), shift = normal<B, 2>({5, 1}, 17);
  const auto p = ml::softmax(x);
  CHECK(distance(ml::sum(p, 1), ml::Tensor<B, 1>::full({5}, 1)) < sum_tolerance<B>);
  CHECK(distance(ml::softmax(x + shift), p) < sum_tolerance<B>);
  CHECK(distance(ml::softmax(x + T(1e4)), p) < 1e4 * sum_tolerance<B>);  // and no overflow

  const auto one = ml::Tensor<B, 1>::full({37}, 1), zero = ml::Tensor<B, 1>::zeros({37});
  const auto y = ml::layer_norm(x, one, zero, 0);
  CHECK(distance(ml::mean(y, 1), ml::Tensor<B, 1>::zeros({5})) < sum_tolerance<B>);
  CHECK(distance(ml::mean(ml::square(y), 1), ml::Tensor<B, 1>::full({5}, 1)) < sum_tolerance<B>);
  CHECK(distance(ml::layer_norm(x * 3.0 + shift, one, zero, 0), y) < sum_tolerance<B>);
  CHECK(distance(ml::add_layer_norm(x, -x + T(0.0), one, zero), T::zeros({5, 37})) == 0);
}

template <ml::Backend B>
void attention_laws() {
  using T = ml::Tensor<B, 2>;
  const ml::AttentionOptions heads{.heads = 3};
  const ml::Offsets queries{2, 4}, keys{1, 5};
  const auto q = normal<B, 2>({6, 12}, 18), k = normal<B, 2>({6, 12}, 19), v = normal<B, 2>({6, 12}, 20);
  const auto y = ml::attention(q, k, v, queries, keys, heads);

  const auto value = ml::slice(v, 0, 0, 1);
  CHECK(distance(ml::slice(y, 0, 0, 2), ml::concat(0, value, value)) < sum_tolerance<B>);  // the only key

  const std::vector<Index> equal(6, 2), order{0, 4, 2, 5, 1, 3};
  const auto mean = ml::reshape<2>(ml::mean(ml::slice(v, 0, 1, 6), 0), {1, 12});
  const auto same_keys = ml::attention(q, ml::gather(k, equal), v, queries, keys, heads);
  CHECK(distance(ml::slice(same_keys, 0, 2, 6), ml::broadcast_to<2>(mean, {4, 12})) < sum_tolerance<B>);
  CHECK(distance(ml::attention(q, ml::gather(k, order), ml::gather(v, order), queries, keys, heads), y) <
        sum_tolerance<B>);
  CHECK(distance(ml::attention(q, k + normal<B, 2>({1, 12}, 21), v, queries, keys, heads), y) < 8 * sum_tolerance<B>);

  std::vector<T> each;
  for (Index h = 0; h < 3; ++h) {
    const auto part = [h](const T& t) { return ml::slice(t, 1, 4 * h, 4 * h + 4); };
    each.push_back(ml::attention(part(q), part(k), part(v), queries, keys, {.heads = 1}));
  }
  CHECK(distance(ml::concat(std::span<const T>(each), 1), y) < sum_tolerance<B>);

  const auto qkv = ml::concat(1, q, k, v);
  CHECK(distance(ml::self_attention(qkv, keys, heads), ml::attention(q, k, v, keys, keys, heads)) < sum_tolerance<B>);
  const ml::AttentionOptions causal{.heads = 3, .causal = true};
  const auto seen = ml::self_attention(qkv, ml::Offsets{6}, causal);
  const auto other = ml::concat(0, ml::slice(qkv, 0, 0, 4), normal<B, 2>({2, 36}, 22));
  CHECK(same_bits(ml::slice(ml::self_attention(other, ml::Offsets{6}, causal), 0, 0, 4), ml::slice(seen, 0, 0, 4)));
  CHECK(distance(ml::slice(seen, 0, 0, 1), value) < sum_tolerance<B>);
}

/// f(sequences) -> as many rows. Lengths around the widths of tiles and vectors.
template <ml::Backend B, class F>
void batch_law(Index width, F f) {
  const std::vector<Index> lengths{1, 19, 5, 70, 14, 33};
  const ml::Sequences<B> x(normal<B, 2>({ml::Offsets(lengths).rows(), width}, 23), ml::Offsets(lengths));
  const ml::Tensor<B, 2> together = f(x);
  const Threads one(1);
  CHECK(same_bits(f(x), together));
  for (int threads : {1, 2, 9}) {
    const Threads set(threads);
    CHECK(same_bits(f(x), together));
    for (Index s = 0; s < x.count(); ++s) {
      const ml::Sequences<B> alone(x[s], ml::Offsets{x.offsets.length(s)});
      CHECK(same_bits(f(alone), ml::slice(together, 0, x.offsets.begin(s), x.offsets.end(s))));
    }
  }
}
template <ml::Backend B>
void batch_laws() {
  using S = ml::Sequences<B>;
  const auto weight = normal<B, 2>({37, 40}, 24);
  const auto bias = normal<B, 1>({37}, 25), gain = normal<B, 1>({40}, 26), offset = normal<B, 1>({40}, 27);
  batch_law<B>(40, [&](const S& x) { return ml::linear(x.rows, weight, &bias, ml::Activation::gelu); });
  const auto square = normal<B, 2>({40, 40}, 29);
  batch_law<B>(40, [&](const S& x) { return ml::linear(x.rows, square, &gain, ml::Activation::none, &x.rows); });
  batch_law<B>(40, [&](const S& x) { return ml::matmul(x.rows, weight, {.transpose_b = true}); });
  batch_law<B>(40, [&](const S& x) { return ml::layer_norm(x.rows, gain, offset); });
  batch_law<B>(40, [&](const S& x) { return ml::add_layer_norm(x.rows, x.rows, gain, offset); });
  batch_law<B>(41, [&](const S& x) { return ml::softmax(x.rows); });
  batch_law<B>(41, [&](const S& x) { return ml::activate(x.rows, ml::Activation::silu); });
  const auto relative = normal<B, 2>({3, 2 * 70 + 1}, 30);
  batch_law<B>(36, [&](const S& x) {
    return ml::attention(x.rows, x.rows, x.rows, x.offsets, x.offsets, {.heads = 3}, &relative);
  });
  for (bool causal : {false, true}) {
    batch_law<B>(36, [&](const S& x) { return ml::self_attention(x.rows, x.offsets, {.heads = 3, .causal = causal}); });
  }
}

template <ml::Backend B>
void backend_laws() {
  handle_laws<B>();
  movement_laws<B>();
  sharing_laws<B>();
  reduction_laws<B>();
  product_laws<B>();
  adjoint_laws<B>();
  normalisation_laws<B>();
  attention_laws<B>();
  batch_laws<B>();
}

}  // namespace laws
