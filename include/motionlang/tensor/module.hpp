// SPDX-License-Identifier: MIT
/// What every module can do because it lists its fields: visit tensors, count parameters, move to another backend.
#pragma once

#include <motionlang/core/fields.hpp>
#include <motionlang/tensor/tensor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Statistics and tables (`static constexpr bool trainable = false`) are saved and loaded, but get no gradient.
template <class M>
inline constexpr bool is_trainable = [] {
  if constexpr (requires { M::trainable; })
    return M::trainable;
  else
    return true;
}();

namespace detail {

/// Passes the tensors among the leaves on to f. A type of its own: inside visit_tensors it would be another one for
/// every module, and all that lies below would be compiled again.
template <class F>
struct TensorsOnly {
  F& f;
  template <class T>
  void operator()(const std::string& path, T& leaf) const {
    if constexpr (is_tensor<std::remove_const_t<T>>) f(path, leaf);
  }
};

}  // namespace detail

/// Calls f(path, tensor) for all tensors of a module; other fields (sizes, options) are passed over.
template <class M, class F>
void visit_tensors(M& module, F f) {
  visit(module, detail::TensorsOnly<F>{f});
}

/// Numbers in all tensors of a module.
template <Module M>
Index parameter_count(const M& module) {
  Index n = 0;
  visit_tensors(module, [&](const std::string&, const auto& t) { n += t.count(); });
  return n;
}

namespace detail {

template <class To, class From>
void convert_module(To& to, const From& from);

template <bool trainable, class To, class From>
void convert_member(To& to, const From& from) {
  if constexpr (is_tensor<To>) {
    using B = typename To::backend;
    const std::vector<typename B::scalar> values(from.span().begin(), from.span().end());
    to = To::from(values, from.shape());
    if constexpr (AutodiffBackend<B> && trainable) to = To(B::variable(B::value(to.data())));
  } else if constexpr (Module<To>) {
    convert_module(to, from);
  } else if constexpr (is_vector<To>) {
    to.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) convert_member<trainable>(to[i], from[i]);
  } else if constexpr (is_optional<To>) {
    to.reset();
    if (from) convert_member<trainable>(to.emplace(), *from);
  } else if constexpr (std::is_same_v<To, From>) {
    to = from;
  } else {
    to = To(from);  // tables that are computed, not stored
  }
}

template <class To, class From>
void convert_module(To& to, const From& from) {
  auto member = [](const char*, auto& t, const auto& f) { convert_member<is_trainable<To>>(t, f); };
  each_field(member, walk(to), walk(from));
}

}  // namespace detail

/// The same model over another backend, with copies of all numbers. On an Autodiff backend every trainable tensor
/// becomes a variable.
template <Backend To, template <class> class M, class From>
M<To> convert(const M<From>& model) {
  M<To> out;
  detail::convert_module(out, model);
  return out;
}
/// From training to use: the model without a tape.
template <template <class> class M, AutodiffBackend A>
M<typename A::inner> to_inner(const M<A>& model) {
  return convert<typename A::inner>(model);
}

namespace detail {

/// Matrices, and what has the axes of a convolution's weight: (out, in, taps), (out, in, taps, 1).
template <class B, int R>
inline constexpr bool has_panels = PackingBackend<B>&& R >= 2 && R <= 4;

/// Whether all numbers of the weight are finite.
template <Backend B, int R>
requires has_panels<B, R>
bool pack_weight(const Tensor<B, R>& w) {
  if constexpr (R == 4)
    return B::prepare(B::reshape(w.data(), Shape{w.size(0), w.size(1), w.size(2) * w.size(3)}));
  else
    return B::prepare(w.data());
}

struct PrepareWeights {
  template <Backend B, int R>
  void operator()(const std::string&, Tensor<B, R>& t) const {
    if constexpr (has_panels<B, R>) pack_weight(t);
  }
};

}  // namespace detail

/// Makes a model ready for inference: weights of linear layers and convolutions are packed for the backend's kernels
/// (and whatever else has two to four axes). The model must not
/// be changed afterwards. Nothing happens on backends without such a layout.
template <Module M>
void prepare(M& model) {
  visit_tensors(model, detail::PrepareWeights{});
}

MOTIONLANG_NAMESPACE_END
