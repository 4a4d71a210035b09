// SPDX-License-Identifier: MIT
/// Differentiation for user code: variables, `backward`, and gradients as a value.
#pragma once

#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The result of `backward`: the gradient of every variable, on the inner backend.
template <AutodiffBackend A>
class Gradients {
 public:
  explicit Gradients(typename A::GradientMap map) : map_(std::move(map)) {}

  /// Gradient of a variable; zeros if the loss does not depend on it. Throws config_error 102 for a constant and for
  /// the result of an operation: only variables have gradients.
  template <int R>
  Tensor<typename A::inner, R> operator[](const Tensor<A, R>& variable) const {
    const auto& node = variable.data().node;
    if (node == nullptr || !node->variable) {
      raise<config_error>(102, "Gradients: a tensor ", variable.shape(), " is ",
                          node == nullptr ? "a constant" : "the result of an operation", ", not a variable");
    }
    const auto* g = find(variable.data());
    return g != nullptr ? Tensor<typename A::inner, R>(*g) : Tensor<typename A::inner, R>::zeros(variable.shape());
  }
  /// Null if the loss does not depend on it, or if it is a constant.
  const typename A::Value* find(const typename A::tensor& variable) const {
    const auto it = map_.find(variable.node.get());
    return it == map_.end() ? nullptr : &it->second;
  }

 private:
  typename A::GradientMap map_;
};

/// Gradients of a scalar with respect to all variables behind it. It needs an Autodiff backend.
template <Backend A>
auto backward(const Tensor<A, 0>& loss) {
  static_assert(AutodiffBackend<A>,
                "motionlang::backward(loss) requires a loss computed on Autodiff<B>; this backend keeps no graph");
  return Gradients<A>(A::gradients(loss.data()));
}

/// Returns y, but the graph keeps only `inputs` and not the path from them to y. The backward pass calls
/// again(inputs...), which must compute y again. Training then needs the memory of one such piece instead of all, and a
/// second forward pass.
/// Source   Chen, Xu, Zhang, Guestrin: "Training deep nets with sublinear memory cost" (2016), section 4.1
/// Caution  `again` is copied and called by `backward`. It may hold parameters and constants, but every computed tensor
///          must be an input (config_error 102). Gradients have the same bits as without it
template <AutodiffBackend A, int R, class F, int... Q>
Tensor<A, R> keep_inputs(const Tensor<A, R>& y, F again, const Tensor<A, Q>&... inputs) {
  return Tensor<A, R>(A::checkpoint(
      y.data(), [again = std::move(again)](const auto&... values) { return again(Tensor<A, Q>(values)...).data(); },
      inputs.data()...));
}
/// f(inputs...), but the graph keeps only the inputs.
template <class F, AutodiffBackend A, int... Q>
auto checkpoint(const F& f, const Tensor<A, Q>&... inputs) {
  return keep_inputs(f(inputs...), f, inputs...);
}

/// A leaf for which gradients are computed.
template <AutodiffBackend A, int R>
Tensor<A, R> variable(const Tensor<typename A::inner, R>& value) {
  return Tensor<A, R>(A::variable(value.data()));
}
/// The plain value of a differentiable tensor.
template <AutodiffBackend A, int R>
Tensor<typename A::inner, R> value_of(const Tensor<A, R>& t) {
  return Tensor<typename A::inner, R>(A::value(t.data()));
}
/// The same value as a constant: gradients stop here. On a backend without gradients it is the tensor itself.
template <Backend B, int R>
Tensor<B, R> stop_gradient(const Tensor<B, R>& t) {
  if constexpr (AutodiffBackend<B>)
    return Tensor<B, R>(typename B::tensor{B::value(t.data()), nullptr});
  else
    return t;
}

MOTIONLANG_NAMESPACE_END
