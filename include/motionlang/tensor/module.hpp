// SPDX-License-Identifier: MIT
/// Operations of every module that lists its fields: visit tensors, count parameters, move to another backend.
#pragma once

#include <type_traits>  // options
#include <utility>      // exchange, move

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

/// True if a type that fields() may list has nothing to save or train: numbers, enumerations, texts, and types that say
/// so (`static constexpr bool is_option = true`, or a specialisation of this variable), such as sizes and computed
/// tables. Other types need fields() of their own. Without them their tensors would be skipped, so this is a compile
/// error.
template <class T>
inline constexpr bool is_option = [] {
  if constexpr (requires { T::is_option; })
    return static_cast<bool>(T::is_option);
  else
    return std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>;
}();

/// A tensor of a module, of any rank: its path, and its data to read or replace. (In a const module it is const.)
template <Backend B, class Data = typename B::tensor>
struct ModuleTensor {
  std::string path;
  int rank = 0;
  void* tensor = nullptr;  // Tensor<B, rank>
  Data* data = nullptr;
  bool trainable = true;  // is_trainable of the module that lists it

  Shape shape() const { return B::shape(*data); }
  /// The values, row-major.
  std::span<const typename B::scalar> span() const { return B::to_span(*data); }
};

namespace detail {

/// The common properties of the tensors below a type: their backend (void: there are none), and their ranks, one bit
/// for each.
template <class T>
struct TensorsBelow {
  static_assert(is_option<T>,
                "motionlang: fields() of a module lists a member whose type has no fields(). Write `static constexpr "
                "auto fields()` in that type (core/fields.hpp), or `static constexpr bool is_option = true` if it has "
                "nothing to save or train");
  using backend = void;
  static constexpr unsigned ranks = 0;
};
template <>
struct TensorsBelow<NoFields> {
  using backend = void;
  static constexpr unsigned ranks = 0;
};
template <class B, int R>
struct TensorsBelow<Tensor<B, R>> {
  using backend = B;
  static constexpr unsigned ranks = 1U << R;
};
template <class T>
struct TensorsBelow<std::vector<T>> : TensorsBelow<T> {};
template <class T>
struct TensorsBelow<std::optional<T>> : TensorsBelow<T> {};
template <class M, class T, class Rest>
struct TensorsBelow<FieldList<Field<M, T>, Rest>> {
  using first = TensorsBelow<T>;
  using others = TensorsBelow<Rest>;
  using backend = std::conditional_t<first::ranks != 0, typename first::backend, typename others::backend>;
  static constexpr unsigned ranks = first::ranks | others::ranks;
};
template <Module M>
struct TensorsBelow<M> : TensorsBelow<decltype(M::fields())> {};

/// Lists tensors. It is one function for every type of module and every use of the tensors. Models are large, and
/// otherwise each of their modules would be compiled again for every use.
template <Backend B>
class TensorLister {
 public:
  template <Module M>
  void list(M& module) {
    check_names<M>();
    const bool outer = std::exchange(trainable_, is_trainable<M>);
    list_fields(M::fields(), module);
    trainable_ = outer;
  }
  std::vector<ModuleTensor<B>> tensors;

 private:
  template <class Fields, class M>
  [[gnu::always_inline]] void list_fields(const Fields& fields, M& module) {
    if constexpr (!std::is_same_v<Fields, NoFields>) {
      list_member(fields.first.name, module.*(fields.first.member));
      list_fields(fields.rest, module);
    }
  }
  template <class T>
  [[gnu::always_inline]] void list_member(const char* name, T& member) {
    if constexpr (TensorsBelow<T>::ranks != 0) {
      const std::size_t length = open(name);
      if constexpr (is_tensor<T>) {
        add(T::rank, &member, member.mutable_data());
      } else if constexpr (is_vector<T>) {
        for (std::size_t i = 0; i < member.size(); ++i) list_member(std::to_string(i).c_str(), member[i]);
      } else if constexpr (is_optional<T>) {
        if (member) list_member("", *member);
      } else {
        list(member);
      }
      path_.resize(length);
    }
  }
  std::size_t open(std::string_view name) {
    const std::size_t length = path_.size();
    if (length != 0 && !name.empty()) path_ += '.';
    path_ += name;
    return length;
  }
  void add(int rank, void* tensor, typename B::tensor& data) {
    tensors.push_back({path_, rank, tensor, &data, trainable_});
  }

  std::string path_;
  bool trainable_ = true;
};

/// Calls f(path, tensor) with the tensor's rank as a type.
template <class M, unsigned ranks, Backend B, class F, int R = 0>
void with_rank(const ModuleTensor<B>& t, F& f) {
  if constexpr ((ranks >> R & 1) != 0) {
    using T = std::conditional_t<std::is_const_v<M>, const Tensor<B, R>, Tensor<B, R>>;
    if (t.rank == R) return f(t.path, *static_cast<T*>(t.tensor));
  }
  if constexpr (ranks >> R > 1) with_rank<M, ranks, B, F, R + 1>(t, f);
}

}  // namespace detail

/// The backend of a module's tensors.
template <Module M>
using module_backend = typename detail::TensorsBelow<M>::backend;

/// All tensors of a module in the order of its fields; other fields (sizes, options) are skipped.
template <Module M>
std::vector<ModuleTensor<module_backend<M>>> tensors_of(M& module) {
  detail::TensorLister<module_backend<M>> lister;
  lister.list(module);
  return std::move(lister.tensors);
}
template <Module M>
auto tensors_of(const M& module) {
  using B = module_backend<M>;
  std::vector<ModuleTensor<B, const typename B::tensor>> out;
  for (auto& t : tensors_of(const_cast<M&>(module)))
    out.push_back({std::move(t.path), t.rank, t.tensor, t.data, t.trainable});
  return out;
}

/// Calls f(path, tensor) for all tensors of a module.
template <class M, class F>
requires Module<std::remove_const_t<M>>
void visit_tensors(M& module, F f) {
  using Plain = std::remove_const_t<M>;
  if constexpr (constexpr unsigned ranks = detail::TensorsBelow<Plain>::ranks; ranks != 0) {
    for (const auto& t : tensors_of(const_cast<Plain&>(module))) detail::with_rank<M, ranks>(t, f);
  }
}

/// Calls f(tensor of a, tensor of b), both `ModuleTensor`, for two modules of the same structure, possibly over
/// different backends. Throws shape_error 204 if the structures differ.
template <class M, class N, class F>
void zip_tensors(M& a, N& b, F f) {
  const auto first = tensors_of(a);
  const auto second = tensors_of(b);
  if (first.size() != second.size())
    raise<shape_error>(204, "zip_tensors: ", Index(first.size()), " and ", Index(second.size()), " tensors");
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].path != second[i].path)
      raise<shape_error>(204, "zip_tensors: '", first[i].path, "' beside '", second[i].path, "'");
    f(first[i], second[i]);
  }
}

/// The number of values in all tensors of a module.
template <Module M>
Index parameter_count(const M& module) {
  Index n = 0;
  for (const auto& t : tensors_of(module)) n += t.shape().count();
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
    to = To(from);  // computed tables, not stored
  }
}

template <class To, class From>
void convert_module(To& to, const From& from) {
  auto member = [](const char*, auto& t, const auto& f) { convert_member<is_trainable<To>>(t, f); };
  each_field(member, walk(to), walk(from));
}

}  // namespace detail

/// The same model over another backend, with copies of all values. On an Autodiff backend every trainable tensor
/// becomes a variable.
template <Backend To, template <class> class M, class From>
M<To> convert(const M<From>& model) {
  M<To> out;
  detail::convert_module(out, model);
  return out;
}
/// The model without a tape, after training.
template <template <class> class M, AutodiffBackend A>
M<typename A::inner> to_inner(const M<A>& model) {
  return convert<typename A::inner>(model);
}

namespace detail {

/// True for the ranks of matrices and of a convolution's weight: (out, in, taps), (out, in, taps, 1).
template <class B>
bool has_panels(int rank) {
  return PackingBackend<B> && rank >= 2 && rank <= 4;
}

/// Packs a weight; returns true if all its values are finite.
template <PackingBackend B>
bool pack_weight(const typename B::tensor& weight, Precision precision = product_precision()) {
  const Shape shape = B::shape(weight);
  if (shape.rank() < 4) return B::prepare(weight, precision);
  return B::prepare(B::reshape(weight, Shape{shape[0], shape[1], shape[2] * shape[3]}), precision);
}

template <Module M>
void prepare_in(M& model, Precision precision) {
  using B = module_backend<M>;
  if constexpr (PackingBackend<B>) {
    for (const auto& t : tensors_of(model)) {
      if (has_panels<B>(t.rank)) pack_weight<B>(*t.data, precision);
    }
  }
}

}  // namespace detail

/// Prepares a model for inference: packs the weights of linear layers and convolutions for the backend's kernels (and
/// other tensors with two to four axes). It uses the precision of the process; backend/precision.hpp offers others. The
/// model must not change afterwards. Does nothing on backends without such a layout.
template <Module M>
void prepare(M& model) {
  detail::prepare_in(model, product_precision());
}

/// The precision of products with the first weight of a model.
template <Module M>
Precision precision_of(const M& model) {
  using B = module_backend<M>;
  if constexpr (PackingBackend<B>) {
    for (const auto& t : tensors_of(model)) {
      if (detail::has_panels<B>(t.rank)) return B::precision_of(*t.data);
    }
  }
  return product_precision();
}

MOTIONLANG_NAMESPACE_END
