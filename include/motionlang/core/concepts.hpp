// SPDX-License-Identifier: MIT
/// The basic concepts. Each one states its idea, what a model must provide, the laws (run on every model in
/// tests/laws), and the models.
#pragma once

#include <concepts>     // same_as, semiregular
#include <cstdint>      // uint64_t
#include <span>         // views of values and rows
#include <string_view>  // names of random streams

#include <motionlang/core/precision.hpp>
#include <motionlang/core/scalar_math.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A number that memory holds: float or double.
template <class S>
concept Scalar = std::same_as<S, float> || std::same_as<S, double>;

/// A type that calculates like a number. Geometry needs nothing more.
/// Laws     those of a field, up to rounding; where_less(a, b, x, y) is x where a < b, else y
/// Models   float, double, Dual<S>, Lane<S> (a SIMD register), Tensor<B, Rank> (element by element)
template <class S>
concept ScalarLike = std::copyable<S> && requires(const S& a, const S& b) {
  S(0.5);
  { a + b } -> std::convertible_to<S>;
  { a - b } -> std::convertible_to<S>;
  { a* b } -> std::convertible_to<S>;
  { a / b } -> std::convertible_to<S>;
  { -a } -> std::convertible_to<S>;
  { sqrt(a) } -> std::convertible_to<S>;
  { sin(a) } -> std::convertible_to<S>;
  { cos(a) } -> std::convertible_to<S>;
  { atan2(a, b) } -> std::convertible_to<S>;
  { where_less(a, b, a, b) } -> std::convertible_to<S>;
};

/// The place and the arithmetic of tensors: a scalar, a dense tensor type and 28 static operations.
///
/// `tensor` is a cheap handle with value semantics and dynamic rank. Operands are taken by value, so that an operation
/// may reuse memory that nobody else holds. The caller has checked shapes (tensor/ops.hpp): a backend only computes.
/// Everything else (softmax, attention, ...) has a default in these primitives. A backend may add its own version under
/// the same name (see tensor/fused.hpp).
///
/// tensor    can be default-constructed, copied and moved. A default-constructed tensor has the shape (0), and to_span
///           gives nothing; a moved-from one is the same. Tensor<B, Rank> refuses such a tensor before an operation of
///           the backend sees it. A list of no values has the shape (0), too. If the tensor has `bool defined() const`,
///           that tells one from the other
/// Minimum   data      full, from_span, to_span, shape
///           elements  add sub mul div maximum atan2 (broadcasting), exp log sqrt tanh erf sin cos, where_less
///           reduce    sum max (one axis, which disappears)
///           product   matmul(a, b, transpose_a, transpose_b), equal leading axes
///           movement  reshape permute broadcast slice concat gather scatter_add
/// Left out  devices, threads, in-place operations, scalars other than float and double, views of foreign memory
/// Laws      Every operation equals that of ReferenceBackend (tests/ops). Operands never change visibly. The algebra of
///           tests/laws holds. examples/11_own_backend has a backend of your own, and runs the laws on it
/// Models    ReferenceBackend<S>, EigenBackend<S>, XtensorBackend<S>, Autodiff<B>
template <class B>
concept Backend = Scalar<typename B::scalar> && std::semiregular<typename B::tensor> &&
    requires(const typename B::tensor a, const Shape s, int axis, Index n, std::span<const typename B::scalar> values,
             std::span<const Index> rows, std::span<const int> axes, std::span<const typename B::tensor> list) {
  { B::full(s, typename B::scalar{}) } -> std::same_as<typename B::tensor>;
  { B::from_span(values, s) } -> std::same_as<typename B::tensor>;
  { B::to_span(a) } -> std::convertible_to<std::span<const typename B::scalar>>;
  { B::shape(a) } -> std::convertible_to<Shape>;
  { B::add(a, a) } -> std::same_as<typename B::tensor>;
  { B::sub(a, a) } -> std::same_as<typename B::tensor>;
  { B::mul(a, a) } -> std::same_as<typename B::tensor>;
  { B::div(a, a) } -> std::same_as<typename B::tensor>;
  { B::maximum(a, a) } -> std::same_as<typename B::tensor>;
  { B::atan2(a, a) } -> std::same_as<typename B::tensor>;
  { B::exp(a) } -> std::same_as<typename B::tensor>;
  { B::log(a) } -> std::same_as<typename B::tensor>;
  { B::sqrt(a) } -> std::same_as<typename B::tensor>;
  { B::tanh(a) } -> std::same_as<typename B::tensor>;
  { B::erf(a) } -> std::same_as<typename B::tensor>;
  { B::sin(a) } -> std::same_as<typename B::tensor>;
  { B::cos(a) } -> std::same_as<typename B::tensor>;
  { B::where_less(a, a, a, a) } -> std::same_as<typename B::tensor>;
  { B::sum(a, axis) } -> std::same_as<typename B::tensor>;
  { B::max(a, axis) } -> std::same_as<typename B::tensor>;
  { B::matmul(a, a, true, false) } -> std::same_as<typename B::tensor>;
  { B::reshape(a, s) } -> std::same_as<typename B::tensor>;
  { B::permute(a, axes) } -> std::same_as<typename B::tensor>;
  { B::broadcast(a, s) } -> std::same_as<typename B::tensor>;
  { B::slice(a, axis, n, n) } -> std::same_as<typename B::tensor>;
  { B::concat(list, axis) } -> std::same_as<typename B::tensor>;
  { B::gather(a, rows) } -> std::same_as<typename B::tensor>;
  { B::scatter_add(a, rows, n) } -> std::same_as<typename B::tensor>;
};

/// A backend whose tensors remember how they were made, so that `backward` can differentiate.
/// Laws     values equal those of `B::inner`; gradients equal central differences (tests/ops)
/// Models   Autodiff<B>
template <class B>
concept AutodiffBackend = Backend<B> && Backend<typename B::inner> && requires(const typename B::tensor a) {
  { B::value(a) } -> std::convertible_to<typename B::inner::tensor>;
  { B::variable(B::value(a)) } -> std::same_as<typename B::tensor>;
};

/// A backend with a layout of its own for the weights of linear layers, (out, in), and of convolutions, (out, in,
/// taps). prepare(weight, precision) keeps this layout beside the tensor, which must not change afterwards. It returns
/// true if all values are finite, which it checks while it reads them. precision_of(weight) is that of its products.
/// Laws     `linear` and `conv1d` of a prepared weight give the same bits (tests/unit/tensor/module.cpp)
/// Models   EigenBackend<S>, XtensorBackend<S>
template <class B>
concept PackingBackend = Backend<B> && requires(const typename B::tensor weight, Precision precision) {
  { B::prepare(weight, precision) } -> std::same_as<bool>;
  { B::precision_of(weight) } -> std::same_as<Precision>;
};

/// A type with parameters: `fields()` lists pairs (name, pointer to member); names are the official state-dict keys.
/// Saving, loading, optimising, counting and conversion between backends all follow from it (core/fields.hpp).
/// Laws     names are unique; visiting twice gives the same paths in the same order
template <class M>
concept Module = requires {
  M::fields();
};

/// A source of random numbers. It is passed to functions and never global.
/// Laws     equal seeds give equal numbers; split(name) depends on the seed and the name only, not on what was drawn
/// Models   Philox
template <class G>
concept Rng = std::copyable<G> &&
    requires(G g, const G& c, std::span<float> out, std::string_view name, std::uint64_t number) {
  g.normal(out);
  g.uniform(out);
  { c.split(name) } -> std::same_as<G>;
  { c.split(number) } -> std::same_as<G>;
};

MOTIONLANG_NAMESPACE_END
