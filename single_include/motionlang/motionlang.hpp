// SPDX-License-Identifier: MIT
/// motionlang 0.1.0, generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.
#pragma once

#ifndef MOTIONLANG_HAS_MOTIONLANG_HPP  // <motionlang/motionlang.hpp>
#define MOTIONLANG_HAS_MOTIONLANG_HPP
/// The whole library but for what needs a third-party package: add the backends that you use, and the files.
///
///     #include <motionlang/motionlang.hpp>
///     #include <motionlang/backend/eigen.hpp>    // or backend/xtensor.hpp
///     #include <motionlang/io/bvh.hpp>           // and whichever of io/

#ifndef MOTIONLANG_HAS_FWD_HPP  // <motionlang/fwd.hpp>
#define MOTIONLANG_HAS_FWD_HPP
/// Declarations of the types that interfaces mention, at the cost of the concepts and no third-party header.
///
///     #include <motionlang/fwd.hpp>
///     void play(const motionlang::Motion& motion, const motionlang::Timeline& timeline);
///     template <motionlang::Backend B> void train(motionlang::Linear<B>& layer);
///
/// A backend has to be complete before anything is made of it: Tensor<EigenBackend<float>, 2> needs its header. Stmc is
/// not here because its parameters are constrained by the denoiser.

#ifndef MOTIONLANG_HAS_CORE_CONCEPTS_HPP  // <motionlang/core/concepts.hpp>
#define MOTIONLANG_HAS_CORE_CONCEPTS_HPP
/// The concepts on which everything rests. Each one states: idea, what a model must provide, the laws (run on every
/// model in tests/laws), and the models.

#include <concepts>     // same_as, convertible_to
#include <cstdint>      // uint64_t
#include <span>         // views of values and rows
#include <string_view>  // names of random streams

#ifndef MOTIONLANG_HAS_CORE_SCALAR_MATH_HPP  // <motionlang/core/scalar_math.hpp>
#define MOTIONLANG_HAS_CORE_SCALAR_MATH_HPP
/// The elementary functions of `ScalarLike` types, for the built-in ones.
///
/// Geometry is written once for float, double, dual numbers, SIMD lanes and tensors. Name lookup by argument finds
/// `sqrt(Tensor)`, but not `std::sqrt` for a built-in number: hence these overloads, which must be visible first.

#include <cmath>  // the functions themselves

#ifndef MOTIONLANG_HAS_VERSION_HPP  // <motionlang/version.hpp>
#define MOTIONLANG_HAS_VERSION_HPP
/// Version of the library and the inline namespace that carries it.

#define MOTIONLANG_VERSION_MAJOR 0
#define MOTIONLANG_VERSION_MINOR 1
#define MOTIONLANG_VERSION_PATCH 0
#define MOTIONLANG_VERSION "0.1.0"

/// Every public name lives in `motionlang`, inside this inline namespace. The tag changes with options that change
/// layouts, so that object files built with different options do not link silently against each other.
#ifdef MOTIONLANG_DIAGNOSTICS
#define MOTIONLANG_ABI v0_diag
#else
#define MOTIONLANG_ABI v0
#endif
#endif

namespace motionlang::inline MOTIONLANG_ABI {

inline double sqrt(double x) { return std::sqrt(x); }
inline double exp(double x) { return std::exp(x); }
inline double log(double x) { return std::log(x); }
inline double sin(double x) { return std::sin(x); }
inline double cos(double x) { return std::cos(x); }
inline double atan2(double y, double x) { return std::atan2(y, x); }
inline float sqrt(float x) { return std::sqrt(x); }
inline float exp(float x) { return std::exp(x); }
inline float log(float x) { return std::log(x); }
inline float sin(float x) { return std::sin(x); }
inline float cos(float x) { return std::cos(x); }
inline float atan2(float y, float x) { return std::atan2(y, x); }

/// `a < b ? x : y`. The one branch that also works element by element: both x and y are always computed, so neither may
/// be NaN where it is not taken if the result is to be differentiated.
constexpr double where_less(double a, double b, double x, double y) { return a < b ? x : y; }
constexpr float where_less(float a, float b, float x, float y) { return a < b ? x : y; }

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_SHAPE_HPP  // <motionlang/core/shape.hpp>
#define MOTIONLANG_HAS_CORE_SHAPE_HPP
/// Sizes of a tensor, stored inline, and the broadcasting rule.

#include <array>             // storage
#include <cstddef>           // ptrdiff_t
#include <initializer_list>  // Shape{2, 3}
#include <string>            // to_string

#ifndef MOTIONLANG_HAS_CORE_ERROR_HPP  // <motionlang/core/error.hpp>
#define MOTIONLANG_HAS_CORE_ERROR_HPP
/// Errors: one hierarchy, one id for each kind of failure, one place that throws.
///
/// A message reads `[motionlang.shape.201] matmul: inner sizes differ: lhs (2, 60, 512), rhs (256, 1024); at
/// layers.3.linear1`: family and id, the operation, what is wrong with both values, and (with MOTIONLANG_DIAGNOSTICS)
/// the module path. The list of ids is `error_ids` below; every one has a test.

#include <charconv>          // to_chars: messages without streams and without the locale
#include <cstdlib>           // abort
#include <stdexcept>         // runtime_error
#include <vector>            // diagnostics path

namespace motionlang::inline MOTIONLANG_ABI {

/// Base of every exception of the library. `id()` is stable between versions; the text is not.
class error : public std::runtime_error {
 public:
  error(int id, const std::string& message) : std::runtime_error(message), id_(id) {}
  int id() const noexcept { return id_; }

 private:
  int id_;
};

struct config_error : error {
  using error::error;
  static constexpr std::string_view family = "config";
};  // 1xx
struct shape_error : error {
  using error::error;
  static constexpr std::string_view family = "shape";
};  // 2xx
struct numeric_error : error {
  using error::error;
  static constexpr std::string_view family = "numeric";
};  // 3xx
struct io_error : error {
  using error::error;
  static constexpr std::string_view family = "io";
};  // 4xx
struct timeline_error : error {
  using error::error;
  static constexpr std::string_view family = "timeline";
};  // 5xx

/// Thrown when a progress callback asks to stop. Not a failure, hence not an `error`.
struct cancelled : std::runtime_error {
  cancelled() : std::runtime_error("cancelled by the caller") {}
};

struct ErrorId {
  int id;
  std::string_view meaning;
};

// clang-format off
/// Every id with its meaning.
inline constexpr ErrorId error_ids[] = {
    // config: a value that cannot work, whatever the data
    {101, "a size or an option is out of its range"},
    {102, "two options contradict each other"},
    {103, "a name is unknown (joint, body part, option, backend)"},
    {104, "a diffusion schedule has a beta outside (0, 1]"},
    {105, "a respacing specification cannot be satisfied"},
    {106, "a skeleton is malformed (order of parents, number of roots, repeated names)"},
    {107, "a configuration file has a value of the wrong kind"},
    // shape: sizes of tensors
    {201, "inner sizes of a product differ"},
    {202, "shapes cannot be broadcast together"},
    {203, "an axis or an index is out of range"},
    {204, "two operands must have the same size along an axis"},
    {205, "the number of values does not fit the shape"},
    {206, "the rank is not the one that the type states"},
    {207, "sequence offsets do not fit the rows"},
    // numeric: values
    {301, "a value is NaN or infinite"},
    {302, "a value lies outside the domain of the function"},
    // io: files
    {401, "a file cannot be opened, read or written"},
    {402, "a file ends too early"},
    {403, "a file is malformed"},
    {404, "a file asks for a feature that is not supported"},
    {405, "a file declares a size that it cannot have"},
    {406, "tensor names are missing or unexpected"},
    {407, "a tensor has another shape or type than expected"},
    // timeline: texts over time
    {501, "a line has too few or too many fields"},
    {502, "a time is not a number"},
    {503, "a body part is unknown"},
    {504, "an interval is empty or ends before it starts"},
    {505, "no text covers a stretch of the timeline"},
    {506, "a text owns no body part at its own start or end"},
    {507, "the timeline has no line"},
    {508, "a crop is longer than the denoiser accepts"},
    {509, "several timelines where one is expected"},
    {510, "a text cannot be written on a line"},
};
// clang-format on

namespace detail {

inline void append(std::string& out, std::string_view s) { out += s; }
inline void append(std::string& out, char c) { out += c; }
template <std::same_as<bool> T>  // a template, or string literals would convert to bool
void append(std::string& out, T b) {
  out += b ? "true" : "false";
}
template <class N>
requires((std::integral<N> || std::floating_point<N>)&&!std::same_as<N, bool> &&
         !std::same_as<N, char>) void append(std::string& out, N n) {
  char digits[64];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, n).ptr);
}
/// Anything with a `to_string` found by name lookup (shapes, enumerations).
template <class T>
requires requires(const T& t) {
  { to_string(t) } -> std::convertible_to<std::string>;
}
void append(std::string& out, const T& t) { out += to_string(t); }

/// A value on its way into a message: where it stands and how it is written. One type for all values and one for literals of
/// all lengths, because messages are many and each would be compiled for its own list of types.
struct TextPart {
  const void* value;
  void (*append)(std::string& out, const void* value);
};
inline TextPart text_part(const char* literal) {
  return {literal, [](std::string& out, const void* value) { out += static_cast<const char*>(value); }};
}
template <class T>
TextPart text_part(const T& value) {
  return {&value, [](std::string& out, const void* v) { detail::append(out, *static_cast<const T*>(v)); }};
}
inline std::string concat_parts(std::initializer_list<TextPart> parts) {
  std::string out;
  for (const TextPart& p : parts) p.append(out, p.value);
  return out;
}

/// The modules that are being evaluated, outermost first. Only kept when MOTIONLANG_DIAGNOSTICS is defined.
struct ModulePath {
  static std::vector<std::string>& names() {
    thread_local std::vector<std::string> path;
    return path;
  }
};

}  // namespace detail

/// Text of all arguments, one after the other; numbers as `std::to_chars` writes them.
template <class... T>
std::string concat_text(const T&... parts) {
  return detail::concat_parts({detail::text_part(parts)...});
}

/// Names the module that is evaluated as long as the object lives. Costs nothing unless MOTIONLANG_DIAGNOSTICS is set.
struct ModuleScope {
#ifdef MOTIONLANG_DIAGNOSTICS
  template <class... T>
  explicit ModuleScope(const T&... name) {
    detail::ModulePath::names().push_back(concat_text(name...));
  }
  ~ModuleScope() { detail::ModulePath::names().pop_back(); }
#else
  template <class... T>
  explicit ModuleScope(const T&...) {}
  ~ModuleScope() {}
#endif
  ModuleScope(const ModuleScope&) = delete;
  ModuleScope& operator=(const ModuleScope&) = delete;
};

namespace detail {

/// The one place that throws an `error`. Define MOTIONLANG_THROW(exception) to replace it where exceptions are disabled.
template <class E>
[[noreturn]] void raise_parts(int id, std::initializer_list<TextPart> parts) {
  std::string text = concat_text("[motionlang.", E::family, ".", id, "] ") + concat_parts(parts);
#ifdef MOTIONLANG_DIAGNOSTICS
  const auto& path = ModulePath::names();
  for (std::size_t i = 0; i < path.size(); ++i) text += (i == 0 ? "; at " : ".") + path[i];
#endif
#ifdef MOTIONLANG_THROW
  MOTIONLANG_THROW(E(id, text));
  std::abort();
#else
  throw E(id, text);
#endif
}

}  // namespace detail

/// Throws E with this id and the text of all parts.
template <class E, class... T>
[[noreturn]] void raise(int id, const T&... parts) {
  detail::raise_parts<E>(id, {detail::text_part(parts)...});
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Sizes, positions and counts. Signed, so that differences are what they look like.
using Index = std::ptrdiff_t;

/// Up to six sizes, slowest axis first. A shape without axes is a scalar and has one element.
class Shape {
 public:
  static constexpr int max_rank = 6;

  constexpr Shape() = default;
  constexpr Shape(std::initializer_list<Index> sizes) : Shape(std::span<const Index>(sizes.begin(), sizes.size())) {}
  constexpr explicit Shape(std::span<const Index> sizes) {
    if (sizes.size() > max_rank) raise<shape_error>(206, "Shape: more than ", max_rank, " axes: ", Index(sizes.size()));
    for (Index n : sizes) push_back(n);
  }

  constexpr int rank() const { return rank_; }
  constexpr Index operator[](int axis) const { return size_[static_cast<std::size_t>(axis)]; }
  constexpr Index& operator[](int axis) { return size_[static_cast<std::size_t>(axis)]; }
  constexpr Index back() const { return size_[static_cast<std::size_t>(rank_ - 1)]; }

  /// Number of elements.
  constexpr Index count() const { return count(0, rank_); }
  /// Product of the sizes of the axes first ... last-1.
  constexpr Index count(int first, int last) const {
    Index n = 1;
    for (int i = first; i < last; ++i) n *= (*this)[i];
    return n;
  }
  constexpr void push_back(Index n) {
    if (n < 0) raise<shape_error>(205, "Shape: negative size ", n);
    if (rank_ == max_rank) raise<shape_error>(206, "Shape: more than ", max_rank, " axes");
    size_[static_cast<std::size_t>(rank_++)] = n;
  }
  /// The same sizes without one axis.
  constexpr Shape without(int axis) const {
    Shape s;
    for (int i = 0; i < rank_; ++i) {
      if (i != axis) s.push_back((*this)[i]);
    }
    return s;
  }
  constexpr bool operator==(const Shape& o) const {
    if (rank_ != o.rank_) return false;
    for (int i = 0; i < rank_; ++i) {
      if ((*this)[i] != o[i]) return false;
    }
    return true;
  }

 private:
  std::array<Index, max_rank> size_{};
  int rank_ = 0;
};

/// "(2, 60, 512)"
inline std::string to_string(const Shape& s) {
  std::string out = "(";
  for (int i = 0; i < s.rank(); ++i) detail::append(out, i ? ", " : ""), detail::append(out, s[i]);
  return out + ")";
}

/// Axis counted from the end when negative; an error when out of range.
constexpr int normalize_axis(int axis, int rank, const char* op) {
  const int a = axis < 0 ? axis + rank : axis;
  if (a < 0 || a >= rank) raise<shape_error>(203, op, ": axis ", axis, " of a tensor of rank ", rank);
  return a;
}

/// NumPy's rule: align at the last axis; sizes must be equal or one of them 1.
constexpr Shape broadcast_shapes(const Shape& a, const Shape& b, const char* op) {
  const int rank = a.rank() > b.rank() ? a.rank() : b.rank();
  Shape out;
  for (int i = 0; i < rank; ++i) {
    const int ia = i - (rank - a.rank()), ib = i - (rank - b.rank());
    const Index na = ia < 0 ? 1 : a[ia], nb = ib < 0 ? 1 : b[ib];
    if (na != nb && na != 1 && nb != 1) {
      raise<shape_error>(202, op, ": shapes do not broadcast: lhs ", a, ", rhs ", b);
    }
    out.push_back(na == 1 ? nb : na);
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// A number that memory holds: float or double.
template <class S>
concept Scalar = std::same_as<S, float> || std::same_as<S, double>;

/// Something that calculates like a number: geometry needs nothing more.
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

/// Where tensors live and how they are calculated with: a scalar, a dense tensor type and 28 static operations.
///
/// `tensor` is a cheap handle with value semantics and dynamic rank; operands are taken by value, so that an operation
/// may reuse the memory of one that nobody else holds. Shapes have been checked by the caller (tensor/ops.hpp): a
/// backend only computes. Everything else (softmax, attention, ...) has a default in these primitives; a backend may
/// add its own version under the same name (see tensor/fused.hpp).
///
/// Minimum   data      full, from_span, to_span, shape
///           elements  add sub mul div maximum atan2 (broadcasting), exp log sqrt tanh erf sin cos, where_less
///           reduce    sum max (one axis, which disappears)
///           product   matmul(a, b, transpose_a, transpose_b), equal leading axes
///           movement  reshape permute broadcast slice concat gather scatter_add
/// Laws      every operation equals the one of ReferenceBackend (tests/ops); operands are never changed visibly
/// Models    ReferenceBackend<S>, EigenBackend<S>, XtensorBackend<S>, Autodiff<B>
template <class B>
concept Backend = Scalar<typename B::scalar> && std::copyable<typename B::tensor> &&
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

/// A type with parameters: `fields()` lists pairs (name, pointer to member); names are the official state-dict keys.
/// Saving, loading, optimising, counting and conversion between backends all follow from it (core/fields.hpp).
/// Laws     names are unique; visiting twice gives the same paths in the same order
template <class M>
concept Module = requires {
  M::fields();
};

/// A source of random numbers that is passed, never global.
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

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

// core
class error;
class Offsets;
class Progress;
struct Context;
struct Philox;
template <Scalar S>
struct Dual;
template <Scalar S>
struct Lane;

// tensor
template <Backend B, int Rank>
class Tensor;
template <Backend B>
struct Sequences;
template <AutodiffBackend A>
class Gradients;

// backend
template <Scalar S>
struct ReferenceBackend;
template <Scalar S>
struct EigenBackend;
template <Scalar S>
struct XtensorBackend;
template <Backend B>
struct Autodiff;

// geometry
template <class S>
struct Vec3;
template <class S>
struct Quaternion;
template <class S>
struct Matrix3;
template <class S>
struct AxisAngle;
template <class S>
struct EulerAngles;
template <class S>
struct Rigid;

// kinematics
struct BodyParts;
struct Motion;
struct Skeleton;
template <ScalarLike S>
struct Pose;

// features
struct FeatureLayout;
template <Backend B>
struct Normalizer;

// nn, text
template <Backend B>
struct Embedding;
template <Backend B>
struct LayerNorm;
template <Backend B>
struct Linear;
template <Backend B>
struct MultiheadAttention;
template <Backend B>
struct TransformerDecoder;
template <Backend B>
struct TransformerEncoder;
template <Backend B>
struct TextFeatures;
template <Backend B>
struct CaptionEncoder;
class WordPiece;

// diffusion, optim
class GaussianDiffusion;
template <Backend B>
struct MdmDenoiser;
template <Backend B>
struct MdmSmplDenoiser;
template <Backend B>
struct MotionDiffuseDenoiser;
template <AutodiffBackend A>
class AdamW;

// compose
template <class T>
struct BasicInterval;
template <class T>
struct BasicTimeline;
using Interval = BasicInterval<Index>;
using Timeline = BasicTimeline<Index>;
using IntervalInSeconds = BasicInterval<double>;
using TimelineInSeconds = BasicTimeline<double>;
struct StmcOptions;

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_ACTIVATION_HPP  // <motionlang/core/activation.hpp>
#define MOTIONLANG_HAS_CORE_ACTIVATION_HPP
/// The nonlinearities of transformer blocks, by name.

namespace motionlang::inline MOTIONLANG_ABI {

///     relu(x) = max(x, 0),   gelu(x) = x (1 + erf(x / sqrt 2)) / 2 (the exact form),   silu(x) = x / (1 + exp(-x)),
///     tanh(x),   quick_gelu(x) = x / (1 + exp(-1.702 x)),   gelu_new(x) = x (1 + tanh(sqrt(2 / pi) (x + 0.044715 x^3))) / 2
enum class Activation { none, relu, gelu, silu, tanh, quick_gelu, gelu_new };

/// Throws config_error 103.
inline Activation parse_activation(std::string_view name) {
  if (name == "none" || name == "identity") return Activation::none;
  if (name == "relu") return Activation::relu;
  if (name == "gelu") return Activation::gelu;
  if (name == "silu") return Activation::silu;
  if (name == "tanh") return Activation::tanh;
  if (name == "quick_gelu") return Activation::quick_gelu;
  if (name == "gelu_new") return Activation::gelu_new;
  raise<config_error>(103, "activation '", name, "' is none of none, relu, gelu, silu, tanh, quick_gelu, gelu_new");
}

constexpr std::string_view to_string(Activation a) {
  constexpr std::string_view names[] = {"none", "relu", "gelu", "silu", "tanh", "quick_gelu", "gelu_new"};
  return names[static_cast<int>(a)];
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_BUFFER_POOL_HPP  // <motionlang/core/buffer_pool.hpp>
#define MOTIONLANG_HAS_CORE_BUFFER_POOL_HPP
/// Memory of tensors: counted buffers that are kept for reuse when nobody needs them any more.
///
/// Fresh pages cost more than the arithmetic that fills them (64 MiB: 26 ms). A loop that repeats the same computation
/// finds all its buffers in the pool from the second round on and takes nothing from the system.

#include <atomic>       // reference counts
#include <bit>          // bit_width
#include <cstring>      // memcpy
#include <memory>       // owner of foreign memory
#include <new>          // bad_alloc
#include <type_traits>  // is_trivially_copyable
#include <utility>      // exchange

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Header of a buffer. The data follow it, 64 bytes aligned, or lie elsewhere (memory-mapped weights).
struct alignas(64) Buffer {
  std::atomic<std::int64_t> references{1};
  void* data = nullptr;
  int bucket = -1;                     // -1: not from a pool
  std::uint32_t pool = 0;              // number of the pool that made it
  Buffer* next = nullptr;              // in a free list
  std::shared_ptr<const void> owner;   // keeps foreign memory alive
  std::shared_ptr<const void> packed;  // the same numbers in the layout of a kernel (see Dense::attach)
};

}  // namespace detail

/// Free buffers of this thread, in buckets of four sizes per power of two. A pool keeps only what it made itself:
/// buffers that one thread makes and another frees do not pile up. Once the pool of an ending thread is gone, memory
/// comes from the system and returns to it.
class BufferPool {
 public:
  static BufferPool& local() {
    thread_local BufferPool pool;
    return pool;
  }

  /// A buffer of at least so many bytes, and its way back, for the calling thread.
  static detail::Buffer* take(std::size_t bytes) {
    const int bucket = bucket_of(bytes);
    return gone_ ? make(bucket, 0) : local().reuse(bucket);
  }
  static void give_back(detail::Buffer* b) {
    if (gone_ || b->pool != local().number_) return release(b);
    b->packed.reset();
    b->next = std::exchange(local().free_[static_cast<std::size_t>(b->bucket)], b);
  }

  /// Returns all free buffers to the system.
  void trim() {
    for (auto& head : free_) {
      while (head != nullptr) release(std::exchange(head, head->next));
    }
  }

  /// How often this pool had to ask the system. Stands still in a loop that has settled.
  std::int64_t system_allocations() const { return system_allocations_; }

  static void release(detail::Buffer* b) {
    b->~Buffer();
    std::free(b);
  }

  BufferPool(const BufferPool&) = delete;
  BufferPool& operator=(const BufferPool&) = delete;

 private:
  BufferPool() = default;
  ~BufferPool() {
    gone_ = true;
    trim();
  }

  detail::Buffer* reuse(int bucket) {
    detail::Buffer*& head = free_[static_cast<std::size_t>(bucket)];
    if (head != nullptr) {
      detail::Buffer* b = std::exchange(head, head->next);
      b->references.store(1, std::memory_order_relaxed);
      return b;
    }
    ++system_allocations_;
    return make(bucket, number_);
  }
  static detail::Buffer* make(int bucket, std::uint32_t pool) {
    void* memory = std::aligned_alloc(64, sizeof(detail::Buffer) + bucket_bytes(bucket));
    if (memory == nullptr) throw std::bad_alloc();
    auto* b = new (memory) detail::Buffer;
    b->data = static_cast<std::byte*>(memory) + sizeof(detail::Buffer);
    b->bucket = bucket;
    b->pool = pool;
    return b;
  }

  // Sizes 64 * {4, 5, 6, 7} * 2^k: at most a quarter of a buffer is unused.
  static int bucket_of(std::size_t bytes) {
    const std::size_t units = (bytes + 63) / 64 < 4 ? 4 : (bytes + 63) / 64;
    const int shift = static_cast<int>(std::bit_width(units)) - 3;
    const std::size_t quarter = (units + (std::size_t{1} << shift) - 1) >> shift;  // 4 ... 8
    return shift * 4 + static_cast<int>(quarter) - 4;
  }
  static std::size_t bucket_bytes(int bucket) {
    return static_cast<std::size_t>(64 * (4 + bucket % 4)) << static_cast<unsigned>(bucket / 4);
  }

  std::array<detail::Buffer*, 4 * 62> free_{};
  std::int64_t system_allocations_ = 0;
  std::uint32_t number_ = ++pools_;

  inline static std::atomic<std::uint32_t> pools_{0};
  inline static thread_local bool gone_ = false;  // a static model may be destroyed after the pool of main's thread
};

namespace detail {

/// Shared handle of a buffer.
class BufferHandle {
 public:
  BufferHandle() = default;
  explicit BufferHandle(std::size_t bytes) : buffer_(BufferPool::take(bytes)) {}
  /// Memory that belongs to somebody else and is only read.
  BufferHandle(const void* data, std::shared_ptr<const void> owner) : buffer_(new (std::align_val_t{64}) Buffer) {
    buffer_->data = const_cast<void*>(data);
    buffer_->owner = std::move(owner);
  }
  BufferHandle(const BufferHandle& o) : buffer_(o.buffer_) {
    if (buffer_ != nullptr) buffer_->references.fetch_add(1, std::memory_order_relaxed);
  }
  BufferHandle(BufferHandle&& o) noexcept : buffer_(std::exchange(o.buffer_, nullptr)) {}
  BufferHandle& operator=(BufferHandle o) noexcept {
    std::swap(buffer_, o.buffer_);
    return *this;
  }
  ~BufferHandle() {
    if (buffer_ == nullptr || buffer_->references.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    if (buffer_->bucket >= 0)
      BufferPool::give_back(buffer_);
    else
      ::operator delete (destroyed(buffer_), std::align_val_t{64});
  }

  void* data() const { return buffer_ == nullptr ? nullptr : buffer_->data; }
  /// Nobody else sees this memory, and it may be written.
  bool unique() const {
    return buffer_ != nullptr && buffer_->bucket >= 0 && buffer_->references.load(std::memory_order_acquire) == 1;
  }
  std::shared_ptr<const void>& packed() const { return buffer_->packed; }
  explicit operator bool() const { return buffer_ != nullptr; }

 private:
  static void* destroyed(Buffer* b) {
    b->~Buffer();
    return b;
  }
  Buffer* buffer_ = nullptr;
};

}  // namespace detail

/// A list of values in memory of the pool: cheap to make again and again in a loop. Does what such lists are for and no more (a
/// std::vector over an allocator would be compiled with sixty functions for every type).
template <class T>
class PoolVector {
  static_assert(std::is_nothrow_move_constructible_v<T> && alignof(T) <= 64,
                "motionlang::PoolVector: values that move without fail, in memory aligned to 64 bytes");

 public:
  using value_type = T;

  PoolVector() = default;
  explicit PoolVector(std::size_t size, const T& value = T{}) {
    reserve(size);
    for (; size_ < size; ++size_) ::new (static_cast<void*>(data_ + size_)) T(value);
  }
  PoolVector(PoolVector&& o) noexcept
      : memory_(std::move(o.memory_)),
        data_(std::exchange(o.data_, nullptr)),
        size_(std::exchange(o.size_, 0)),
        capacity_(std::exchange(o.capacity_, 0)) {}
  PoolVector& operator=(PoolVector&&) = delete;
  ~PoolVector() {
    for (std::size_t i = 0; i < size_; ++i) data_[i].~T();
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  const T* begin() const { return data_; }
  T* end() { return data_ + size_; }
  const T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

  void reserve(std::size_t capacity) {
    if (capacity <= capacity_) return;
    detail::BufferHandle larger(capacity * sizeof(T));
    T* to = static_cast<T*>(larger.data());
    for (std::size_t i = 0; i < size_; ++i) {
      ::new (static_cast<void*>(to + i)) T(std::move(data_[i]));
      data_[i].~T();
    }
    memory_ = std::move(larger);
    data_ = to;
    capacity_ = capacity;
  }
  void push_back(T value) {
    if (size_ == capacity_) reserve(size_ < 32 ? 64 : 2 * size_);
    ::new (static_cast<void*>(data_ + size_++)) T(std::move(value));
  }

 private:
  detail::BufferHandle memory_;
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_CONTEXT_HPP  // <motionlang/core/context.hpp>
#define MOTIONLANG_HAS_CORE_CONTEXT_HPP
/// What a call of a model may be given besides its inputs. Nothing by default: then no dropout runs.

#include <optional>  // no generator, no dropout

#ifndef MOTIONLANG_HAS_CORE_RNG_HPP  // <motionlang/core/rng.hpp>
#define MOTIONLANG_HAS_CORE_RNG_HPP
/// Random numbers: a counter-based generator that can be split by name or number.
///
/// Source   Salmon et al., "Parallel random numbers: as easy as 1, 2, 3" (SC 2011): Philox4x32 with 10 rounds.
/// Normals  Box and Muller (1958), computed in double and rounded, because the standard leaves
///          `std::normal_distribution` open and float libraries differ in the last bit.
/// The generators of PyTorch, NumPy and CPython, for parity with published runs, are in torch_random.hpp,
/// numpy_random.hpp and python_random.hpp.

#include <numbers>      // pi

namespace motionlang::inline MOTIONLANG_ABI {

/// Philox4x32-10. `seed` is the key, `stream` and `position` are the counter: any number of any stream can be computed
/// without the ones before it, so results do not depend on batch order or threads.
///
///     Philox rng{.seed = 7};
///     auto step_rng = rng.split("noise").split(step);   // independent of everything drawn elsewhere
struct Philox {
  std::uint64_t seed = 0;
  std::uint64_t stream = 0;
  std::uint64_t position = 0;  // the next block of four 32-bit numbers

  using Block = std::array<std::uint32_t, 4>;

  /// Block `at` of this stream.
  Block block(std::uint64_t at) const {
    Block c{static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at >> 32), static_cast<std::uint32_t>(stream),
            static_cast<std::uint32_t>(stream >> 32)};
    auto k0 = static_cast<std::uint32_t>(seed), k1 = static_cast<std::uint32_t>(seed >> 32);
    for (int round = 0; round < 10; ++round) {
      const std::uint64_t p0 = std::uint64_t{0xD2511F53u} * c[0], p1 = std::uint64_t{0xCD9E8D57u} * c[2];
      c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ k0, static_cast<std::uint32_t>(p1),
           static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ k1, static_cast<std::uint32_t>(p0)};
      k0 += 0x9E3779B9u;
      k1 += 0xBB67AE85u;
    }
    return c;
  }

  /// A generator for a part of the work. Depends on seed, stream and name, not on what has been drawn.
  Philox split(std::string_view name) const {
    std::uint64_t h = 0xCBF29CE484222325u;  // FNV-1a over the name
    for (char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
    return split(h);
  }
  Philox split(std::uint64_t number) const {
    const Block b = Philox{.seed = stream ^ 0x6D6F74696F6E6C61u, .stream = seed}.block(number);
    return {.seed = seed, .stream = (std::uint64_t{b[0]} << 32) | b[1], .position = 0};
  }

  std::uint32_t bits() { return block(position++)[0]; }

  /// Uniform in 0 ... n-1, without bias (Lemire 2019, with rejection).
  std::uint32_t below(std::uint32_t n) {
    if (n == 0) raise<config_error>(101, "Philox::below: n is 0");
    const std::uint32_t reject = static_cast<std::uint32_t>(-n) % n;
    for (;;) {
      const std::uint64_t product = std::uint64_t{bits()} * n;
      if (static_cast<std::uint32_t>(product) >= reject) return static_cast<std::uint32_t>(product >> 32);
    }
  }

  /// Uniform in [0, 1).
  double uniform() { return bits() * 0x1p-32; }

  template <Scalar S>
  void uniform(std::span<S> out) {
    fill(out, [](const Block& b, std::array<double, 4>& v) {
      for (std::size_t i = 0; i < 4; ++i) v[i] = (b[i] >> 8) * 0x1p-24;  // 24 bits: exact in float, never 1
    });
  }
  void uniform(std::span<float> out) { uniform<float>(out); }

  /// Standard normal numbers.
  template <Scalar S>
  void normal(std::span<S> out) {
    fill(out, [](const Block& b, std::array<double, 4>& v) {
      for (std::size_t i = 0; i < 4; i += 2) {
        const double radius = std::sqrt(-2.0 * std::log((b[i] + 0.5) * 0x1p-32));
        const double angle = 2.0 * std::numbers::pi * (b[i + 1] * 0x1p-32);
        v[i] = radius * std::cos(angle);
        v[i + 1] = radius * std::sin(angle);
      }
    });
  }
  void normal(std::span<float> out) { normal<float>(out); }

 private:
  template <Scalar S, class F>
  void fill(std::span<S> out, F values_of) {
    std::array<double, 4> v{};
    for (std::size_t i = 0; i < out.size(); i += 4) {
      values_of(block(position++), v);
      for (std::size_t j = 0; j < 4 && i + j < out.size(); ++j) out[i + j] = static_cast<S>(v[j]);
    }
  }
};
static_assert(Rng<Philox>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Dropout runs only if the context carries a generator: there is no train or eval flag to forget.
///
///     model(x, t, text, {.dropout = rng.split("dropout").split(step)});
struct Context {
  std::optional<Philox> dropout{};
  mutable std::uint64_t drawn = 0;  // masks handed out so far; every mask has its own stream

  /// The generator of the next dropout mask. Only when `dropout` is set.
  Philox next_mask() const { return dropout->split(drawn++); }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_DROPOUT_HPP  // <motionlang/core/dropout.hpp>
#define MOTIONLANG_HAS_CORE_DROPOUT_HPP
/// Dropout masks that are a function of a key and a position: nothing is stored, and any thread computes any part.

namespace motionlang::inline MOTIONLANG_ABI {

/// Inverted dropout (Srivastava et al., JMLR 2014): element i becomes x / (1 - p) if kept, else 0.
/// Nothing happens at p = 0.
struct Dropout {
  double p = 0;
  std::uint64_t key = 0;

  /// 32 bits hashed from the key and the position: two rounds of multiply and xor-shift.
  static constexpr std::uint32_t bits(std::uint64_t key, std::uint64_t i) {
    std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1u + static_cast<std::uint32_t>(key) +
                      static_cast<std::uint32_t>(i >> 32) * 0x27D4EB2Fu;
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu + static_cast<std::uint32_t>(key >> 32);
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    return h ^ (h >> 16);
  }
  constexpr std::uint32_t limit() const { return static_cast<std::uint32_t>(p * 4294967296.0); }
  /// The factor of element i: 1 / (1 - p) or 0.
  constexpr double factor(std::uint64_t i) const { return bits(key, i) >= limit() ? 1.0 / (1.0 - p) : 0.0; }

  /// Position of an attention weight: 65,536 keys at most.
  static constexpr std::uint64_t attention_position(Index query_row, Index heads, Index head, Index key_column) {
    return (static_cast<std::uint64_t>(query_row * heads + head) << 16) + static_cast<std::uint64_t>(key_column);
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_DUAL_HPP  // <motionlang/core/dual.hpp>
#define MOTIONLANG_HAS_CORE_DUAL_HPP
/// Dual numbers: a value and its derivative along one direction. Forward-mode differentiation of everything that is
/// written over `ScalarLike`; use `Autodiff` for gradients with respect to many inputs.
///
///     f(a + b e) = f(a) + f'(a) b e,   e^2 = 0

namespace motionlang::inline MOTIONLANG_ABI {

template <Scalar S>
struct Dual {
  S value{};
  S derivative{};

  Dual() = default;
  explicit constexpr Dual(S v, S d = S(0)) : value(v), derivative(d) {}

  friend Dual operator+(Dual a, Dual b) { return Dual(a.value + b.value, a.derivative + b.derivative); }
  friend Dual operator-(Dual a, Dual b) { return Dual(a.value - b.value, a.derivative - b.derivative); }
  friend Dual operator-(Dual a) { return Dual(-a.value, -a.derivative); }
  friend Dual operator*(Dual a, Dual b) {
    return Dual(a.value * b.value, a.derivative * b.value + a.value * b.derivative);
  }
  friend Dual operator/(Dual a, Dual b) {
    const S q = a.value / b.value;
    return Dual(q, (a.derivative - q * b.derivative) / b.value);
  }
  friend Dual sqrt(Dual a) {
    const S r = std::sqrt(a.value);
    return Dual(r, a.derivative / (S(2) * r));
  }
  friend Dual sin(Dual a) { return Dual(std::sin(a.value), a.derivative * std::cos(a.value)); }
  friend Dual cos(Dual a) { return Dual(std::cos(a.value), -a.derivative * std::sin(a.value)); }
  friend Dual atan2(Dual y, Dual x) {
    const S n = x.value * x.value + y.value * y.value;
    return Dual(std::atan2(y.value, x.value), (x.value * y.derivative - y.value * x.derivative) / n);
  }
  friend Dual where_less(Dual a, Dual b, Dual x, Dual y) { return a.value < b.value ? x : y; }
};
static_assert(ScalarLike<Dual<double>>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_FIELDS_HPP  // <motionlang/core/fields.hpp>
#define MOTIONLANG_HAS_CORE_FIELDS_HPP
/// Member lists: what a module is made of, and how to walk over it.
///
///     struct Linear {
///       Tensor<B, 2> weight;
///       Tensor<B, 1> bias;
///       static constexpr auto fields() { return motionlang::fields("weight", &Linear::weight, "bias", &Linear::bias); }
///     };
///     visit(model, [](const std::string& path, auto& tensor) { ... });   // "layers.0.linear1.weight"
///
/// A member may be a leaf (a tensor), a module, or a vector or optional of either. Vector elements are numbered. A name
/// may contain dots ("tx_embedding.0") where the official key has a level that is no module here.

namespace motionlang::inline MOTIONLANG_ABI {

template <class M, class T>
struct Field {
  const char* name;
  T M::*member;
};

/// The fields of a module, first and rest; `NoFields` ends the list. (A std::tuple compiles several times slower.)
struct NoFields {};
template <class First, class Rest>
struct FieldList {
  First first;
  Rest rest;
};

/// Pairs (name, pointer to member) to a list of `Field`.
constexpr NoFields fields() { return {}; }
template <class M, class T, class... Others>
constexpr auto fields(const char* name, T M::*member, Others... others) {
  return FieldList<Field<M, T>, decltype(fields(others...))>{{name, member}, fields(others...)};
}

namespace detail {

template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

inline std::string join_path(const std::string& prefix, std::string_view name) {
  std::string path = prefix;
  if (!path.empty()) path += '.';
  return path += name;
}

template <class F, class... Objects>
void visit_fields(const std::string& prefix, F& f, Objects&... objects);

/// Walks over one member, or over the same member of several objects of the same structure.
template <class F, class First, class... Others>
void visit_member(const std::string& path, F& f, First& first, Others&... others) {
  using T = std::remove_const_t<First>;
  if constexpr (Module<T>) {
    visit_fields(path, f, first, others...);
  } else if constexpr (is_vector<T>) {
    if (((others.size() != first.size()) || ...)) {
      raise<shape_error>(204, "zip: numbers of ", path, " differ: ", Index(first.size()), ", ",
                         Index(others.size())...);
    }
    for (std::size_t i = 0; i < first.size(); ++i)
      visit_member(join_path(path, std::to_string(i)), f, first[i], others[i]...);
  } else if constexpr (is_optional<T>) {
    if (((others.has_value() != first.has_value()) || ...)) raise<shape_error>(204, "zip: only one side has ", path);
    if (first) visit_member(path, f, *first, (*others)...);
  } else {
    f(path, first, others...);
  }
}

/// An object and those of its fields that are still to be walked over.
template <class List, class Object>
struct Walk {
  List list;
  Object& object;
  auto& member() const { return object.*(list.first.member); }
  auto rest() const { return Walk<decltype(list.rest), Object>{list.rest, object}; }
};
template <class Object>
auto walk(Object& object) {
  return Walk<decltype(Object::fields()), Object>{Object::fields(), object};
}

/// Calls f(name, member of first, members of others...) for all fields. The others may be the same template over another
/// backend: fields are matched by position.
template <class F, class First, class... Walks>
void each_field(F& f, const First& first, const Walks&... others) {
  if constexpr (!std::is_same_v<decltype(first.list), NoFields>) {
    f(first.list.first.name, first.member(), others.member()...);
    each_field(f, first.rest(), others.rest()...);
  }
}

template <class F, class First, class... Walks>
void visit_walks(const std::string& prefix, F& f, const First& first, const Walks&... others) {
  if constexpr (!std::is_same_v<decltype(first.list), NoFields>) {
    visit_member(join_path(prefix, first.list.first.name), f, first.member(), others.member()...);
    visit_walks(prefix, f, first.rest(), others.rest()...);
  }
}
template <class F, class... Objects>
void visit_fields(const std::string& prefix, F& f, Objects&... objects) {
  visit_walks(prefix, f, walk(objects)...);
}

}  // namespace detail

/// Calls f(path, leaf) for every leaf below the module, in the order of the fields.
template <class M, class F>
requires Module<std::remove_const_t<M>>
void visit(M& module, F f) { detail::visit_fields("", f, module); }

/// Calls f(path, leaf of a, leaf of b) for two modules of the same structure, perhaps over different backends.
template <class M, class N, class F>
requires Module<std::remove_const_t<M>> && Module<std::remove_const_t<N>>
void zip(M& a, N& b, F f) { detail::visit_fields("", f, a, b); }

/// Number of leaves.
template <Module M>
Index count_leaves(const M& module) {
  Index n = 0;
  visit(module, [&](const std::string&, const auto&) { ++n; });
  return n;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_HALF_HPP  // <motionlang/core/half.hpp>
#define MOTIONLANG_HAS_CORE_HALF_HPP
/// The two 16-bit floating-point formats in which weights are stored: IEEE half (F16) and bfloat16 (BF16). Conversions
/// only; nothing is calculated in them.

namespace motionlang::inline MOTIONLANG_ABI {

/// Value of a half: 1 sign, 5 exponent, 10 fraction bits. Exact, subnormals and NaN payloads included.
constexpr float half_to_float(std::uint16_t h) {
  const std::uint32_t sign = std::uint32_t{h & 0x8000u} << 16, exponent = h >> 10 & 31u, fraction = h & 1023u;
  if (exponent == 0) {  // zero and subnormals: fraction * 2^-24
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(static_cast<float>(fraction) * 0x1p-24f) | sign);
  }
  const std::uint32_t wide = exponent == 31 ? 255 : exponent + (127 - 15);
  return std::bit_cast<float>(sign | wide << 23 | fraction << 13);
}

/// Nearest half, ties to even; too large becomes infinity.
constexpr std::uint16_t float_to_half(float f) {
  const auto bits = std::bit_cast<std::uint32_t>(f);
  const std::uint32_t sign = bits >> 16 & 0x8000u, size = bits & 0x7FFFFFFFu;
  if (size > 0x7F800000u) return static_cast<std::uint16_t>(sign | 0x7E00u | (size >> 13 & 0x3FFu));  // quiet NaN
  if (size >= 0x477FF000u) return static_cast<std::uint16_t>(sign | 0x7C00u);  // 65520 and above: infinity
  if (size < 0x38800000u) {  // below 2^-14: adding 0.5 leaves multiples of 2^-24, rounded to even, in the low bits
    const float sum = std::bit_cast<float>(size) + 0.5f;
    return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(sum) - 0x3F000000u));
  }
  const std::uint32_t rounded = size + 0xFFFu + (size >> 13 & 1u) - 0x38000000u;
  return static_cast<std::uint16_t>(sign | rounded >> 13);
}

/// Value of a bfloat16: the upper half of a float.
constexpr float bfloat16_to_float(std::uint16_t b) { return std::bit_cast<float>(std::uint32_t{b} << 16); }

/// Nearest bfloat16, ties to even.
constexpr std::uint16_t float_to_bfloat16(float f) {
  const auto bits = std::bit_cast<std::uint32_t>(f);
  if ((bits & 0x7FFFFFFFu) > 0x7F800000u) return static_cast<std::uint16_t>(bits >> 16 | 0x40u);  // quiet NaN
  return static_cast<std::uint16_t>((bits + 0x7FFFu + (bits >> 16 & 1u)) >> 16);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_LANE_HPP  // <motionlang/core/lane.hpp>
#define MOTIONLANG_HAS_CORE_LANE_HPP
/// A handful of numbers that are calculated with at once: one SIMD register as a `ScalarLike`.
///
/// Geometry over `Lane<float>` treats eight poses at a time with the same source text as for one. The compiler's vector
/// types are used, so the code is the same on every processor. Square roots are refined from an estimate (error below 2
/// ulp).

namespace motionlang::inline MOTIONLANG_ABI {

// Everything below is inlined: how such vectors are passed between functions depends on the caller's instruction set.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

template <Scalar S>
struct Lane {
  static constexpr int size = 32 / static_cast<int>(sizeof(S));
  typedef S Register __attribute__((vector_size(32)));
  using Bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  typedef Bits BitRegister __attribute__((vector_size(32)));

  Register v{};

  Lane() = default;
  /// Not trivial on purpose: other functions then return a lane through memory, whatever their caller was compiled for.
  MOTIONLANG_INLINE Lane(const Lane& other) : v(other.v) {}
  Lane& operator=(const Lane&) = default;
  template <class N>
  requires std::is_arithmetic_v<N>
  explicit MOTIONLANG_INLINE Lane(N x) : v(static_cast<S>(x) - Register{}) {}
  static MOTIONLANG_INLINE Lane from(const Register& r) {
    Lane l;
    l.v = r;
    return l;
  }
  MOTIONLANG_INLINE S& operator[](int i) { return reinterpret_cast<S*>(&v)[i]; }
  MOTIONLANG_INLINE S operator[](int i) const { return v[i]; }

  friend MOTIONLANG_INLINE Lane operator+(const Lane& a, const Lane& b) { return from(a.v + b.v); }
  friend MOTIONLANG_INLINE Lane operator-(const Lane& a, const Lane& b) { return from(a.v - b.v); }
  friend MOTIONLANG_INLINE Lane operator*(const Lane& a, const Lane& b) { return from(a.v * b.v); }
  friend MOTIONLANG_INLINE Lane operator/(const Lane& a, const Lane& b) { return from(a.v / b.v); }
  friend MOTIONLANG_INLINE Lane operator-(const Lane& a) { return from(-a.v); }
  friend MOTIONLANG_INLINE Lane where_less(const Lane& a, const Lane& b, const Lane& x, const Lane& y) {
    return from(a.v < b.v ? x.v : y.v);
  }

  /// x / sqrt(x): Newton's iteration for 1/sqrt(x) from the well-known estimate by shifting the exponent. 0 for 0.
  friend MOTIONLANG_INLINE Lane sqrt(const Lane& x) {
    constexpr Bits magic = sizeof(S) == 4 ? static_cast<Bits>(0x5F375A86) : static_cast<Bits>(0x5FE6EB50C7B537A9);
    Register y = (Register)(magic - ((BitRegister)x.v >> 1));
    const Register half = x.v * S(0.5);
    for (int i = 0; i < (sizeof(S) == 4 ? 3 : 5); ++i) y = y * (S(1.5) - half * y * y);
    Register r = x.v * y;
    r = r + S(0.5) * y * (x.v - r * r);  // one correction of the root itself
    return from(r);
  }
  friend MOTIONLANG_INLINE Lane sin(const Lane& a) {
    return each(a, [](S x) { return std::sin(x); });
  }
  friend MOTIONLANG_INLINE Lane cos(const Lane& a) {
    return each(a, [](S x) { return std::cos(x); });
  }
  friend MOTIONLANG_INLINE Lane atan2(const Lane& y, const Lane& x) {
    Lane r;
    for (int i = 0; i < size; ++i) r.v[i] = std::atan2(y.v[i], x.v[i]);
    return r;
  }

 private:
  template <class F>
  static MOTIONLANG_INLINE Lane each(const Lane& a, F f) {
    Lane r;
    for (int i = 0; i < size; ++i) r.v[i] = f(a.v[i]);
    return r;
  }
};
static_assert(ScalarLike<Lane<float>> && ScalarLike<Lane<double>>);

#undef MOTIONLANG_INLINE

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_MT19937_HPP  // <motionlang/core/mt19937.hpp>
#define MOTIONLANG_HAS_CORE_MT19937_HPP
/// The Mersenne Twister, with both of its seedings. Not for new work (see Philox in rng.hpp): the generators of
/// PyTorch, NumPy and CPython are built on it, and published runs can be repeated number by number.
///
/// Source  Matsumoto and Nishimura, "Mersenne Twister" (ACM TOMACS 8, 1998), and the seeding of 2002. `std::mt19937` is
///         the same engine, but it has no init_by_array.

namespace motionlang::inline MOTIONLANG_ABI {

class Mt19937 {
 public:
  /// init_genrand: x_0 = seed, x_i = 1812433253 (x_{i-1} xor (x_{i-1} >> 30)) + i
  explicit Mt19937(std::uint32_t seed) {
    state_[0] = seed;
    for (std::uint32_t i = 1; i < size; ++i) state_[i] = 1812433253u * mixed(i - 1) + i;
  }

  /// init_by_array. An empty key counts as the key {0}.
  explicit Mt19937(std::span<const std::uint32_t> key) : Mt19937(19650218u) {
    static constexpr std::uint32_t zero[] = {0};
    if (key.empty()) key = zero;
    std::size_t i = 1, j = 0;
    auto next = [&] {
      if (++i == size) state_[0] = state_[size - 1], i = 1;
    };
    for (std::size_t n = key.size() > size ? key.size() : size; n > 0; --n) {
      state_[i] = (state_[i] ^ mixed(i - 1) * 1664525u) + key[j] + static_cast<std::uint32_t>(j);
      next();
      if (++j == key.size()) j = 0;
    }
    for (std::size_t n = size - 1; n > 0; --n) {
      state_[i] = (state_[i] ^ mixed(i - 1) * 1566083941u) - static_cast<std::uint32_t>(i);
      next();
    }
    state_[0] = 0x80000000u;
  }

  /// The next 32 bits.
  std::uint32_t operator()() {
    if (at_ == size) twist();
    std::uint32_t y = state_[at_++];
    y ^= y >> 11;
    y ^= (y << 7) & 0x9D2C5680u;
    y ^= (y << 15) & 0xEFC60000u;
    return y ^ (y >> 18);
  }

  /// Uniform in [0, 1) with 53 bits from two words, as NumPy and CPython take them: (27 bits, then 26 bits) / 2^53.
  double uniform53() {
    const std::uint32_t high = (*this)() >> 5, low = (*this)() >> 6;
    return (high * 67108864.0 + low) * 0x1p-53;
  }

 private:
  static constexpr std::size_t size = 624, shift = 397;

  std::uint32_t mixed(std::size_t i) const { return state_[i] ^ (state_[i] >> 30); }

  void twist() {
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint32_t y = (state_[i] & 0x80000000u) | (state_[(i + 1) % size] & 0x7FFFFFFFu);
      state_[i] = state_[(i + shift) % size] ^ (y >> 1) ^ ((y & 1u) != 0 ? 0x9908B0DFu : 0u);
    }
    at_ = 0;
  }

  std::array<std::uint32_t, size> state_{};
  std::size_t at_ = size;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_NUMPY_RANDOM_HPP  // <motionlang/core/numpy_random.hpp>
#define MOTIONLANG_HAS_CORE_NUMPY_RANDOM_HPP
/// NumPy's legacy generator: `numpy.random.seed(seed)` followed by the functions of the module, for parity with
/// published runs (captions, crops for FID, pairs for diversity).
///
/// Source  numpy 1.24, numpy/random/mtrand.pyx, src/distributions (masked rejection), src/legacy (polar method)

#include <numeric>   // iota

namespace motionlang::inline MOTIONLANG_ABI {

class NumpyRandom {
 public:
  explicit NumpyRandom(std::uint32_t seed) : words_(seed) {}

  /// Uniform in low ... high-1. Throws config_error 101 if that is empty.
  std::int64_t randint(std::int64_t low, std::int64_t high) {
    if (high <= low) raise<config_error>(101, "NumpyRandom::randint: from ", low, " to below ", high);
    const std::uint64_t largest = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) - 1;
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + at_most(largest));
  }

  template <class T>
  void shuffle(std::span<T> list) {
    for (std::size_t i = list.size(); i-- > 1;) std::swap(list[i], list[at_most(i)]);
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    shuffle(std::span<T>(list));
  }

  /// 0 ... n-1 in random order. Throws config_error 101 if n is negative.
  std::vector<Index> permutation(Index n) {
    if (n < 0) raise<config_error>(101, "NumpyRandom::permutation: of ", n);
    std::vector<Index> list(static_cast<std::size_t>(n));
    std::iota(list.begin(), list.end(), Index{0});
    shuffle(list);
    return list;
  }

  /// `choice(n, k, replace=False)`: the first k of a permutation. Throws config_error 101 unless 0 <= k <= n.
  std::vector<Index> choice(Index n, Index k) {
    if (k < 0 || k > n) raise<config_error>(101, "NumpyRandom::choice: ", k, " of ", n);
    std::vector<Index> list = permutation(n);
    list.resize(static_cast<std::size_t>(k));
    return list;
  }

  /// Uniform in [0, 1) with 53 bits.
  double rand() { return words_.uniform53(); }

  /// Standard normal number, by the polar method. Two are made at a time; the second is kept for the next call.
  double randn() {
    if (spare_) return *std::exchange(spare_, std::nullopt);
    double x = 0, y = 0, r2 = 0;
    do {
      x = 2.0 * rand() - 1.0;
      y = 2.0 * rand() - 1.0;
      r2 = x * x + y * y;
    } while (r2 >= 1.0 || r2 == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(r2) / r2);
    spare_ = factor * x;
    return factor * y;
  }

 private:
  /// Uniform in 0 ... largest: words cut to the bits of `largest` until one fits. 0 draws nothing.
  std::uint64_t at_most(std::uint64_t largest) {
    if (largest == 0) return 0;
    const std::uint64_t mask = ~std::uint64_t{0} >> (64 - std::bit_width(largest));
    std::uint64_t r = 0;
    do {
      r = words_();
      if (largest >> 32 != 0) r = r << 32 | words_();
      r &= mask;
    } while (r > largest);
    return r;
  }

  Mt19937 words_;
  std::optional<double> spare_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_OFFSETS_HPP  // <motionlang/core/offsets.hpp>
#define MOTIONLANG_HAS_CORE_OFFSETS_HPP
/// Where each sequence of a packed batch begins: an immutable shared list 0 = o_0 <= o_1 <= ... <= o_n = rows.

namespace motionlang::inline MOTIONLANG_ABI {

/// Sequence i has the rows offsets[i] ... offsets[i + 1] - 1. Cheap to copy; whoever keeps a copy keeps the list alive.
class Offsets {
 public:
  Offsets() : Offsets(std::span<const Index>()) {}
  /// From the lengths of the sequences. Throws shape_error 207 on a negative one.
  explicit Offsets(std::span<const Index> lengths)
      : memory_((lengths.size() + 1) * sizeof(Index)), count_(static_cast<Index>(lengths.size())) {
    Index* last = static_cast<Index*>(memory_.data());
    *last = 0;
    for (Index n : lengths) {
      if (n < 0) raise<shape_error>(207, "Offsets: negative length ", n);
      last[1] = *last + n;
      ++last;
    }
  }
  explicit Offsets(const std::vector<Index>& lengths) : Offsets(std::span<const Index>(lengths)) {}
  Offsets(std::initializer_list<Index> lengths) : Offsets(std::span<const Index>(lengths.begin(), lengths.size())) {}
  /// `count` sequences of equal length.
  static Offsets equal(Index count, Index length) {
    return Offsets(std::span<const Index>(PoolVector<Index>(static_cast<std::size_t>(count), length)));
  }

  Index count() const { return count_; }
  Index rows() const { return first()[count_]; }
  Index begin(Index i) const { return first()[i]; }
  Index end(Index i) const { return first()[i + 1]; }
  Index length(Index i) const { return end(i) - begin(i); }
  Index longest() const {
    Index n = 0;
    for (Index i = 0; i < count(); ++i) n = length(i) > n ? length(i) : n;
    return n;
  }
  std::span<const Index> list() const { return {first(), static_cast<std::size_t>(count_) + 1}; }
  bool operator==(const Offsets& o) const {
    return count_ == o.count_ &&
           std::memcmp(first(), o.first(), (static_cast<std::size_t>(count_) + 1) * sizeof(Index)) == 0;
  }

 private:
  const Index* first() const { return static_cast<const Index*>(memory_.data()); }
  detail::BufferHandle memory_;
  Index count_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_PARALLEL_HPP  // <motionlang/core/parallel.hpp>
#define MOTIONLANG_HAS_CORE_PARALLEL_HPP
/// A small pool of threads and `parallel_for`.
///
/// Work is split into tasks that never share a sum, and the result of a task does not depend on who runs it: one thread
/// and many give the same bits. Workers spin after a task (20,000 pauses: 0.2 to 1 millisecond, by the processor) and
/// then sleep, so that the many short regions of a transformer layer cost well below a microsecond each while an idle
/// program costs nothing.

#include <algorithm>           // clamp
#include <condition_variable>  // sleeping workers
#include <exception>           // exception_ptr: errors in tasks reach the caller
#include <mutex>               // sleeping workers
#include <thread>              // workers

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

class ThreadPool {
 public:
  static ThreadPool& instance() {
    static ThreadPool pool;
    return pool;
  }

  int size() const { return workers_ + 1; }
  /// 0 for a thread that called `run`, 1 ... size-1 for the workers.
  static int number() { return number_; }

  void resize(int threads) {
    stop();
    threads_.reset(new std::thread[static_cast<std::size_t>(threads - 1)]);
    stopping_ = false;
    for (int i = 1; i < threads; ++i) {
      threads_[static_cast<std::size_t>(workers_)] = std::thread([this, i, seen = round_.load()] {
        number_ = i;
        work(seen);
      });
      ++workers_;
    }
  }

  /// Runs task(context, i) for i = 0 ... count-1 on all threads and returns when all are done.
  void run(Index count, void (*task)(const void*, Index), const void* context) {
    if (count == 1 || workers_ == 0 || inside_) {
      for (Index i = 0; i < count; ++i) task(context, i);
      return;
    }
    std::scoped_lock only_one_caller(caller_);
    task_ = task;
    context_ = context;
    count_ = count;
    next_.store(0, std::memory_order_relaxed);
    pending_.store(workers_, std::memory_order_relaxed);
    {
      std::scoped_lock lock(sleep_);
      round_.fetch_add(1, std::memory_order_release);
    }
    if (asleep_.load() > 0) wake_.notify_all();
    take_tasks();
    for (int spins = 0; pending_.load(std::memory_order_acquire) != 0; ++spins) pause(spins);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

 private:
  static constexpr int spins_before_sleep = 20000;

  ThreadPool() { resize(std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 256)); }
  ~ThreadPool() { stop(); }

  static void pause(int spins) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
    if (spins % 1024 == 1023) std::this_thread::yield();  // more threads than cores: let the others finish
  }

  void stop() {
    {
      std::scoped_lock lock(sleep_);
      stopping_ = true;
      round_.fetch_add(1);
    }
    wake_.notify_all();
    for (; workers_ > 0; --workers_) threads_[static_cast<std::size_t>(workers_ - 1)].join();
  }

  void work(unsigned seen) {
    inside_ = true;
    for (;;) {
      int spins = 0;
      while (round_.load(std::memory_order_acquire) == seen && ++spins < spins_before_sleep) pause(spins);
      if (round_.load(std::memory_order_acquire) == seen) {
        std::unique_lock lock(sleep_);
        ++asleep_;
        wake_.wait(lock, [&] { return round_.load() != seen; });
        --asleep_;
      }
      ++seen;
      if (stopping_) return;
      take_tasks();
      pending_.fetch_sub(1, std::memory_order_release);
    }
  }

  void take_tasks() {
    const bool outer = std::exchange(inside_, true);
    for (Index i; (i = next_.fetch_add(1, std::memory_order_relaxed)) < count_;) {
      try {
        task_(context_, i);
      } catch (...) {
        std::scoped_lock lock(sleep_);
        if (!failure_) failure_ = std::current_exception();
        next_.store(count_, std::memory_order_relaxed);
      }
    }
    inside_ = outer;
  }

  inline static thread_local int number_ = 0;
  inline static thread_local bool inside_ = false;  // a task that calls parallel_for runs it alone
  std::unique_ptr<std::thread[]> threads_;
  int workers_ = 0;  // threads that run
  std::mutex caller_, sleep_;
  std::condition_variable wake_;
  std::atomic<unsigned> round_{0};
  std::atomic<int> pending_{0}, asleep_{0};
  std::atomic<Index> next_{0};
  std::atomic<bool> stopping_{false};
  void (*task_)(const void*, Index) = nullptr;
  const void* context_ = nullptr;
  Index count_ = 0;
  std::exception_ptr failure_;
};

}  // namespace detail

/// Threads that `parallel_for` uses, the caller included. As many as the machine has unless set.
inline int thread_count() { return detail::ThreadPool::instance().size(); }

/// Number of the thread that runs a task of `parallel_for`: 0 ... thread_count()-1, different for those that run at once.
inline int thread_number() { return detail::ThreadPool::number(); }

/// Changes the number of threads for the whole process. Not while work is running. Throws config_error 101.
inline void set_thread_count(int threads) {
  if (threads < 1 || threads > 1024) raise<config_error>(101, "set_thread_count: ", threads, " is not in 1 ... 1024");
  detail::ThreadPool::instance().resize(threads);
}

/// Calls f(i) for i = 0 ... count-1, in any order, on all threads. f must not depend on the order. Exceptions reach the
/// caller (the first one). Inside a task it runs serially.
template <class F>
void parallel_for(Index count, const F& f) {
  if (count <= 0) return;
  detail::ThreadPool::instance().run(
      count, [](const void* g, Index i) { (*static_cast<const F*>(g))(i); }, &f);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_PROGRESS_HPP  // <motionlang/core/progress.hpp>
#define MOTIONLANG_HAS_CORE_PROGRESS_HPP
/// How long work tells its caller where it is, and how the caller stops it.

namespace motionlang::inline MOTIONLANG_ABI {

/// A reference to a caller's `bool f(Index done, Index total)`; false stops the work with `cancelled`. May be empty.
/// Like a pointer: the callable must outlive it, so a temporary one does not compile.
class Progress {
 public:
  Progress() = default;
  template <class F>
  requires(!std::is_same_v<std::remove_cv_t<F>, Progress> && std::is_invocable_r_v<bool, F&, Index, Index>)
      Progress(F& f)
      : object_(const_cast<void*>(static_cast<const void*>(&f))),
        call_([](void* object, Index done, Index total) -> bool { return (*static_cast<F*>(object))(done, total); }) {}

  /// Throws `cancelled` if the caller answers false.
  void operator()(Index done, Index total) const {
    if (call_ != nullptr && !call_(object_, done, total)) throw cancelled();
  }

 private:
  void* object_ = nullptr;
  bool (*call_)(void*, Index, Index) = nullptr;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_PYTHON_RANDOM_HPP  // <motionlang/core/python_random.hpp>
#define MOTIONLANG_HAS_CORE_PYTHON_RANDOM_HPP
/// CPython's generator: `random.seed(seed)` followed by the functions of the module `random`, for parity with published
/// runs (frame sampling, ties of STMC, the MTT data set).
///
/// Source  CPython 3.11, Lib/random.py and Modules/_randommodule.c

namespace motionlang::inline MOTIONLANG_ABI {

class PythonRandom {
 public:
  /// Of a negative seed the absolute value counts.
  template <std::integral I>
  explicit PythonRandom(I seed)
      : PythonRandom(seed < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(seed)
                              : static_cast<std::uint64_t>(seed)) {}
  explicit PythonRandom(std::uint64_t seed)
      : PythonRandom(std::span<const std::uint32_t>(Words(seed).w, seed >> 32 != 0 ? 2 : 1)) {}
  /// A seed of any size, as 32-bit words, least significant first.
  explicit PythonRandom(std::span<const std::uint32_t> key) : words_(key) {}

  /// Uniform in [0, 1).
  double random() { return words_.uniform53(); }
  double uniform(double a, double b) { return a + (b - a) * random(); }

  /// An integer of `bits` random bits. Throws config_error 101 above 64 bits.
  std::uint64_t getrandbits(int bits) {
    if (bits < 0 || bits > 64) raise<config_error>(101, "PythonRandom::getrandbits: ", bits, " bits");
    if (bits == 0) return 0;
    if (bits <= 32) return words_() >> (32 - bits);
    const std::uint64_t low = words_();
    return low | std::uint64_t{words_() >> (64 - bits)} << 32;
  }

  /// Uniform in 0 ... n-1, by rejection. Throws config_error 101 if n is 0.
  std::uint64_t below(std::uint64_t n) {
    if (n == 0) raise<config_error>(101, "PythonRandom::below: n is 0");
    const int bits = static_cast<int>(std::bit_width(n));
    std::uint64_t r = getrandbits(bits);
    while (r >= n) r = getrandbits(bits);
    return r;
  }

  /// Uniform in a ... b, both included. Throws config_error 101 if b < a.
  std::int64_t randint(std::int64_t a, std::int64_t b) {
    const std::uint64_t width = static_cast<std::uint64_t>(b) - static_cast<std::uint64_t>(a) + 1;
    if (b < a || width == 0) raise<config_error>(101, "PythonRandom::randint: from ", a, " to ", b);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + below(width));
  }

  /// Position of `random.choice` in a list of n. Throws config_error 101 if n is 0.
  Index choice(Index n) { return static_cast<Index>(below(size_of(n, "choice"))); }

  template <class T>
  void shuffle(std::span<T> list) {
    for (std::size_t i = list.size(); i-- > 1;) std::swap(list[i], list[below(i + 1)]);
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    shuffle(std::span<T>(list));
  }

  /// Normal number. Two are made at a time; the second is kept for the next call, whatever is drawn in between.
  double gauss(double mean, double standard_deviation) {
    double z = 0;
    if (spare_) {
      z = *std::exchange(spare_, std::nullopt);
    } else {
      const double angle = 2.0 * std::numbers::pi * random(), radius = std::sqrt(-2.0 * std::log(1.0 - random()));
      z = std::cos(angle) * radius;
      spare_ = std::sin(angle) * radius;
    }
    return mean + z * standard_deviation;
  }

  /// `random.sample(range(n), k)`: k different numbers below n. Throws config_error 101 unless 0 <= k <= n.
  std::vector<Index> sample(Index n, Index k) {
    if (k < 0 || k > n) raise<config_error>(101, "PythonRandom::sample: ", k, " of ", n);
    std::vector<Index> out;
    out.reserve(static_cast<std::size_t>(k));
    if (n <= largest_pool(k)) {
      std::vector<Index> pool(static_cast<std::size_t>(n));
      std::iota(pool.begin(), pool.end(), Index{0});
      while (std::ssize(out) < k) {
        const std::size_t j = below(pool.size());
        out.push_back(std::exchange(pool[j], pool.back()));
        pool.pop_back();
      }
    } else {
      std::vector<Index> taken;  // sorted
      while (std::ssize(out) < k) {
        const Index j = choice(n);
        const auto place = std::lower_bound(taken.begin(), taken.end(), j);
        if (place != taken.end() && *place == j) continue;
        taken.insert(place, j);
        out.push_back(j);
      }
    }
    return out;
  }

  /// `random.sample(range(len(counts)), k, counts=counts)`: element i stands counts[i] times in the list that is drawn
  /// from. Throws config_error 101 if there are fewer than k or a count is negative.
  std::vector<Index> sample_counts(std::span<const Index> counts, Index k) {
    for (Index c : counts) {
      if (c < 0) raise<config_error>(101, "PythonRandom::sample_counts: count ", c);
    }
    std::vector<Index> upto(counts.size());
    std::partial_sum(counts.begin(), counts.end(), upto.begin());
    std::vector<Index> out = sample(upto.empty() ? 0 : upto.back(), k);
    for (Index& i : out) i = std::upper_bound(upto.begin(), upto.end(), i) - upto.begin();
    return out;
  }

 private:
  struct Words {
    explicit Words(std::uint64_t n) : w{static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(n >> 32)} {}
    std::uint32_t w[2];
  };

  static std::uint64_t size_of(Index n, const char* call) {
    if (n <= 0) raise<config_error>(101, "PythonRandom::", call, ": a list of ", n);
    return static_cast<std::uint64_t>(n);
  }
  /// Up to this size a list is copied and drawn from, above it numbers are drawn again until they are new:
  /// 21 + 4^ceil(log_4(3k)) for k > 5, else 21.
  static Index largest_pool(Index k) {
    Index table = 1;
    while (k > 5 && table < 3 * k) table *= 4;
    return k > 5 ? 21 + table : 21;
  }

  Mt19937 words_;
  std::optional<double> spare_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_SORT_HPP  // <motionlang/core/sort.hpp>
#define MOTIONLANG_HAS_CORE_SORT_HPP
/// Sorting of short lists. std::sort is faster on long ones, but every use of it is compiled with some thirty functions.

namespace motionlang::inline MOTIONLANG_ABI::detail {

/// Sorts by `less`, which leaves no two elements equal or does not care for their order. Heap sort: n log n steps whatever
/// the list. `List` is a vector.
template <class List, class Less>
void sort(List& list, Less less) {
  const auto sift_down = [&](std::size_t i, std::size_t size) {
    for (std::size_t child; (child = 2 * i + 1) < size; i = child) {
      if (child + 1 < size && less(list[child], list[child + 1])) ++child;
      if (!less(list[i], list[child])) return;
      std::swap(list[i], list[child]);
    }
  };
  for (std::size_t i = list.size() / 2; i-- > 0;) sift_down(i, list.size());
  for (std::size_t size = list.size(); size-- > 1;) {
    std::swap(list[0], list[size]);
    sift_down(0, size);
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI::detail
#endif

#ifndef MOTIONLANG_HAS_CORE_TEXT_LINES_HPP  // <motionlang/core/text_lines.hpp>
#define MOTIONLANG_HAS_CORE_TEXT_LINES_HPP
/// Texts line by line.

namespace motionlang::inline MOTIONLANG_ABI::detail {

/// Without the blanks at both ends.
constexpr std::string_view trim(std::string_view s) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  const std::size_t first = s.find_first_not_of(blanks);
  return first == s.npos ? s.substr(0, 0) : s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

/// Calls on_line(line, number) for every line, without its end (LF, CRLF, CR); numbers count from 1. A byte order mark
/// is skipped.
template <class F>
void for_each_line(std::string_view text, F on_line) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (Index number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    on_line(text.substr(0, end), number);
    text.remove_prefix(std::min(text.size(), end + (text.substr(end).starts_with("\r\n") ? 2 : 1)));
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI::detail
#endif

#ifndef MOTIONLANG_HAS_CORE_TORCH_RANDOM_HPP  // <motionlang/core/torch_random.hpp>
#define MOTIONLANG_HAS_CORE_TORCH_RANDOM_HPP
/// PyTorch's CPU generator: `torch.manual_seed(seed)` followed by `torch.randn` or `torch.rand`, for parity with
/// published runs. CUDA streams are another generator and not covered.
///
/// Source      torch 1.13, aten/src/ATen/native/cpu/DistributionTemplates.h (normal_fill) and
///             ATen/core/DistributionsHelper.h (small draws)
/// Differs     by less than 1e-6 from torch's vectorised kernels, which approximate log and cos; uniform numbers and
///             the float64 path have no such difference

namespace motionlang::inline MOTIONLANG_ABI {

class TorchRandom {
 public:
  /// The low 32 bits of the seed count, as in PyTorch.
  explicit TorchRandom(std::uint64_t seed = 5489) : words_(static_cast<std::uint32_t>(seed)) {}

  /// `torch.rand`: 24 bits of one word for float, 53 bits of two words for double.
  template <Scalar S>
  void uniform(std::span<S> out) {
    for (S& u : out) u = uniform<S>();
  }
  void uniform(std::span<float> out) { uniform<float>(out); }

  /// `torch.randn` of a whole tensor of out.size() elements. The result depends on how a draw is cut into tensors:
  ///   fewer than 16 elements: one pair of numbers at a time in double, the second kept for the next small draw;
  ///   otherwise all are filled with uniform numbers first and then every block of 16 is transformed (Box-Muller,
  ///   element j with element j + 8); when blocks do not fit, the last 16 elements are drawn again.
  template <Scalar S>
  void normal(std::span<S> out) {
    if (out.size() < block) {
      for (S& z : out) z = static_cast<S>(one_normal());
      return;
    }
    uniform(out);
    const std::size_t rest = out.size() % block;
    for (std::size_t at = 0; at + block <= out.size(); at += block) to_normal(out.subspan(at).template first<block>());
    if (rest != 0) {
      const auto last = out.template last<block>();
      uniform(std::span<S>(last));
      to_normal(last);
    }
  }
  void normal(std::span<float> out) { normal<float>(out); }

 private:
  static constexpr std::size_t block = 16;

  template <Scalar S>
  S uniform() {
    if constexpr (sizeof(S) == 4) return static_cast<S>(words_() & 0xFFFFFFu) * S(0x1p-24);
    const std::uint64_t high = words_(), low = words_();
    return static_cast<S>(static_cast<double>((high << 32 | low) & ((std::uint64_t{1} << 53) - 1)) * 0x1p-53);
  }

  double one_normal() {
    if (spare_) return *std::exchange(spare_, std::nullopt);
    const double u1 = uniform<double>(), u2 = uniform<double>();
    const double radius = std::sqrt(-2.0 * std::log1p(-u2)), angle = 2.0 * std::numbers::pi * u1;
    spare_ = radius * std::sin(angle);
    return radius * std::cos(angle);
  }

  template <Scalar S>
  static void to_normal(std::span<S, block> values) {
    for (std::size_t j = 0; j < block / 2; ++j) {
      const double radius = std::sqrt(-2.0 * std::log(1.0 - static_cast<double>(values[j])));
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(values[j + block / 2]);
      values[j] = static_cast<S>(radius * std::cos(angle));
      values[j + block / 2] = static_cast<S>(radius * std::sin(angle));
    }
  }

  Mt19937 words_;
  std::optional<double> spare_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_CORE_UTF8_HPP  // <motionlang/core/utf8.hpp>
#define MOTIONLANG_HAS_CORE_UTF8_HPP
/// UTF-8: one code point at a time, strictly. Nothing here knows about classes of characters.

namespace motionlang::inline MOTIONLANG_ABI {

/// What `decode_utf8` returns for bytes that are not UTF-8.
inline constexpr char32_t invalid_code_point = 0xFFFFFFFF;

/// The code point that starts at text[at]; moves `at` behind it. Bytes that are not UTF-8 (stray or missing
/// continuation bytes, overlong forms, surrogates, above U+10FFFF) give `invalid_code_point` and `at` moves by one.
/// Needs at < text.size().
constexpr char32_t decode_utf8(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t start = at++;
  const unsigned char first = byte(start);
  if (first < 0x80) return first;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || length > text.size() - start) return invalid_code_point;
  char32_t c = first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(start + i) & 0xC0u) != 0x80u) return invalid_code_point;
    c = c << 6 | (byte(start + i) & 0x3Fu);
  }
  constexpr char32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  if (c < smallest[length] || (c >= 0xD800 && c <= 0xDFFF) || c > 0x10FFFF) return invalid_code_point;
  at = start + length;
  return c;
}

/// Whether the whole text is UTF-8.
constexpr bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    if (decode_utf8(text, at) == invalid_code_point) return false;
  }
  return true;
}

/// Appends the bytes of a code point (up to U+10FFFF).
inline void append_utf8(std::string& out, char32_t c) {
  const auto put = [&](char32_t b) { out += static_cast<char>(static_cast<unsigned char>(b)); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | c >> 6), put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | c >> 12), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | c >> 18), put(0x80 | (c >> 12 & 0x3F)), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TENSOR_FUSED_HPP  // <motionlang/tensor/fused.hpp>
#define MOTIONLANG_HAS_TENSOR_FUSED_HPP
/// Operations that a backend may have as one kernel: each is defined here in primitives, which is what it means.
///
/// `if constexpr (requires { B::linear(...); })` takes the kernel of a backend that has one. `Autodiff<B>` has the
/// operation, with a hand-written derivative, exactly when B has its kernels; otherwise the definition below is
/// differentiated.

#ifndef MOTIONLANG_HAS_TENSOR_OPS_HPP  // <motionlang/tensor/ops.hpp>
#define MOTIONLANG_HAS_TENSOR_OPS_HPP
/// Arithmetic, functions, reductions and products of tensors. Every function checks shapes once and calls the backend.
///
/// Binary operations broadcast like NumPy; the result has the larger rank. Temporaries are passed on, so that a backend
/// may compute in place.

#ifndef MOTIONLANG_HAS_TENSOR_TENSOR_HPP  // <motionlang/tensor/tensor.hpp>
#define MOTIONLANG_HAS_TENSOR_TENSOR_HPP
/// Tensor<B, Rank>: what user code sees. The backend and the rank are types, the sizes are values.
///
/// A handle with value semantics: copying shares memory, writing never shows through another handle. A wrong rank is a
/// compile error; wrong sizes are a `shape_error` from the operation, thrown before any backend runs.

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B, int Rank>
class Tensor {
  static_assert(Rank >= 0 && Rank <= Shape::max_rank, "motionlang::Tensor: rank must be 0 ... 6");

 public:
  using backend = B;
  using scalar = typename B::scalar;
  static constexpr int rank = Rank;

  /// No tensor yet: its shape is (0) whatever the rank, it has no numbers, and operations refuse it.
  Tensor() = default;
  /// Wraps a backend's tensor. Throws shape_error 206 if its rank is another.
  explicit Tensor(typename B::tensor data) : data_(std::move(data)) {
    if (shape().rank() != Rank) raise<shape_error>(206, "Tensor: rank ", Rank, " expected, shape is ", shape());
  }
  /// One number with all sizes 1: broadcasts against anything.
  template <class N>
  requires std::is_arithmetic_v<N>
  explicit Tensor(N value) : data_(B::full(ones(), static_cast<scalar>(value))) {}

  static Tensor full(const Shape& shape, double value) {
    return Tensor(B::full(checked(shape), static_cast<scalar>(value)));
  }
  static Tensor zeros(const Shape& shape) { return full(shape, 0); }
  /// Row-major values. Throws shape_error 205 if their number is not the shape's.
  static Tensor from(std::span<const scalar> values, const Shape& shape) {
    if (static_cast<Index>(values.size()) != shape.count()) {
      raise<shape_error>(205, "Tensor: ", Index(values.size()), " values for shape ", shape);
    }
    return Tensor(B::from_span(values, checked(shape)));
  }
  static Tensor from(const std::vector<scalar>& values, const Shape& shape) {
    return from(std::span<const scalar>(values), shape);
  }
  /// Standard normal numbers.
  static Tensor randn(const Shape& shape, Rng auto& rng) {
    std::vector<scalar> values(static_cast<std::size_t>(shape.count()));
    rng.normal(std::span<scalar>(values));
    return from(values, shape);
  }

  const typename B::tensor& data() const& { return data_; }
  typename B::tensor data() && { return std::move(data_); }
  /// For code that replaces the value in place (optimisers, loaders).
  typename B::tensor& mutable_data() { return data_; }

  Shape shape() const { return B::shape(data_); }
  Index size(int axis) const { return shape()[normalize_axis(axis, Rank, "Tensor::size")]; }
  Index count() const { return shape().count(); }

  /// The numbers, row-major; valid as long as this tensor lives and is not assigned to.
  std::span<const scalar> span() const { return B::to_span(data_); }
  std::vector<scalar> to_vector() const {
    const auto s = span();
    return {s.begin(), s.end()};
  }
  /// The only number of a tensor with one element. Throws shape_error 205.
  scalar item() const {
    if (count() != 1) raise<shape_error>(205, "Tensor::item: shape ", shape(), " has ", count(), " elements");
    return span()[0];
  }

 private:
  static Shape ones() {
    Shape s;
    for (int i = 0; i < Rank; ++i) s.push_back(1);
    return s;
  }
  static const Shape& checked(const Shape& s) {
    if (s.rank() != Rank) raise<shape_error>(206, "Tensor: rank ", Rank, " expected, shape is ", s);
    return s;
  }
  typename B::tensor data_{};
};

template <class T>
inline constexpr bool is_tensor = false;
template <class B, int R>
inline constexpr bool is_tensor<Tensor<B, R>> = true;

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

inline constexpr int larger(int a, int b) { return a > b ? a : b; }

template <class B, int P, int Q, class F>
auto binary(const char* name, Tensor<B, P>&& a, Tensor<B, Q>&& b, F f) {
  if (a.shape() != b.shape()) broadcast_shapes(a.shape(), b.shape(), name);
  return Tensor<B, larger(P, Q)>(f(std::move(a).data(), std::move(b).data()));
}

}  // namespace detail

template <Backend B, int P, int Q>
auto operator+(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator+", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::add(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator-(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator-", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::sub(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator*(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator*", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::mul(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto operator/(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("operator/", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::div(std::move(x), std::move(y)); });
}
template <Backend B, int P, int Q>
auto maximum(Tensor<B, P> a, Tensor<B, Q> b) {
  return detail::binary("maximum", std::move(a), std::move(b),
                        [](auto&& x, auto&& y) { return B::maximum(std::move(x), std::move(y)); });
}
template <Backend B, int R>
Tensor<B, R> atan2(Tensor<B, R> y, Tensor<B, R> x) {
  return detail::binary("atan2", std::move(y), std::move(x),
                        [](auto&& p, auto&& q) { return B::atan2(std::move(p), std::move(q)); });
}

template <Backend B, int R>
Tensor<B, R> operator+(Tensor<B, R> a, double b) {
  return std::move(a) + Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator+(double a, Tensor<B, R> b) {
  return std::move(b) + Tensor<B, R>(a);
}
template <Backend B, int R>
Tensor<B, R> operator-(Tensor<B, R> a, double b) {
  return std::move(a) - Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator-(double a, Tensor<B, R> b) {
  return Tensor<B, R>(a) - std::move(b);
}
template <Backend B, int R>
Tensor<B, R> operator*(Tensor<B, R> a, double b) {
  return std::move(a) * Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator*(double a, Tensor<B, R> b) {
  return std::move(b) * Tensor<B, R>(a);
}
template <Backend B, int R>
Tensor<B, R> operator/(Tensor<B, R> a, double b) {
  return std::move(a) / Tensor<B, R>(b);
}
template <Backend B, int R>
Tensor<B, R> operator/(double a, Tensor<B, R> b) {
  return Tensor<B, R>(a) / std::move(b);
}
template <Backend B, int R>
Tensor<B, R> operator-(Tensor<B, R> a) {
  return std::move(a) * Tensor<B, R>(-1.0);
}

template <Backend B, int R>
Tensor<B, R> exp(Tensor<B, R> a) {
  return Tensor<B, R>(B::exp(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> log(Tensor<B, R> a) {
  return Tensor<B, R>(B::log(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> sqrt(Tensor<B, R> a) {
  return Tensor<B, R>(B::sqrt(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> tanh(Tensor<B, R> a) {
  return Tensor<B, R>(B::tanh(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> erf(Tensor<B, R> a) {
  return Tensor<B, R>(B::erf(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> sin(Tensor<B, R> a) {
  return Tensor<B, R>(B::sin(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> cos(Tensor<B, R> a) {
  return Tensor<B, R>(B::cos(std::move(a).data()));
}
template <Backend B, int R>
Tensor<B, R> square(const Tensor<B, R>& a) {
  return a * a;
}
template <Backend B, int R>
Tensor<B, R> abs(const Tensor<B, R>& a) {
  return maximum(a, -a);
}

/// Element by element: a < b ? x : y.
template <Backend B, int R>
Tensor<B, R> where_less(const Tensor<B, R>& a, const Tensor<B, R>& b, const Tensor<B, R>& x, const Tensor<B, R>& y) {
  broadcast_shapes(broadcast_shapes(a.shape(), b.shape(), "where_less"),
                   broadcast_shapes(x.shape(), y.shape(), "where_less"), "where_less");
  return Tensor<B, R>(B::where_less(a.data(), b.data(), x.data(), y.data()));
}

/// Sum along one axis, which disappears. Negative axes count from the end.
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> sum(const Tensor<B, R>& a, int axis) {
  return Tensor<B, R - 1>(B::sum(a.data(), normalize_axis(axis, R, "sum")));
}
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> max(const Tensor<B, R>& a, int axis) {
  return Tensor<B, R - 1>(B::max(a.data(), normalize_axis(axis, R, "max")));
}
template <Backend B, int R>
requires(R > 0) Tensor<B, R - 1> mean(const Tensor<B, R>& a, int axis) {
  return sum(a, axis) / static_cast<double>(a.size(axis));
}
/// Sum and mean of everything.
template <Backend B, int R>
Tensor<B, 0> sum(const Tensor<B, R>& a) {
  return Tensor<B, 0>(B::sum(B::reshape(a.data(), Shape{a.count()}), 0));
}
template <Backend B, int R>
Tensor<B, 0> mean(const Tensor<B, R>& a) {
  return sum(a) / static_cast<double>(a.count());
}

struct MatmulOptions {
  bool transpose_a = false, transpose_b = false;
};
/// Product of the last two axes; leading axes are equal. Throws shape_error 201 or 204.
template <Backend B, int R>
requires(R >= 2) Tensor<B, R> matmul(const Tensor<B, R>& a, const Tensor<B, R>& b, MatmulOptions options = {}) {
  const Shape sa = a.shape(), sb = b.shape();
  for (int i = 0; i < R - 2; ++i) {
    if (sa[i] != sb[i]) raise<shape_error>(204, "matmul: leading sizes differ: lhs ", sa, ", rhs ", sb);
  }
  if (sa[options.transpose_a ? R - 2 : R - 1] != sb[options.transpose_b ? R - 1 : R - 2]) {
    raise<shape_error>(201, "matmul: inner sizes differ: lhs ", sa, options.transpose_a ? " transposed" : "", ", rhs ",
                       sb, options.transpose_b ? " transposed" : "");
  }
  return Tensor<B, R>(B::matmul(a.data(), b.data(), options.transpose_a, options.transpose_b));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TENSOR_SEQUENCES_HPP  // <motionlang/tensor/sequences.hpp>
#define MOTIONLANG_HAS_TENSOR_SEQUENCES_HPP
/// A batch of sequences without padding: the rows of all sequences one after the other, and where each begins.
///
/// Layers that treat rows alike (linear, norms, nonlinearities, losses) see only rows; attention, positions and pooling
/// take the offsets. Padded tensors and masks exist only at the edge, for loaders and for comparison with other
/// programs.

#ifndef MOTIONLANG_HAS_TENSOR_INDEX_HPP  // <motionlang/tensor/index.hpp>
#define MOTIONLANG_HAS_TENSOR_INDEX_HPP
/// Moving numbers: reshape, permute, slice, concat, gather, scatter.

namespace motionlang::inline MOTIONLANG_ABI {

/// The same numbers in another shape; one size may be -1 and is then computed. Throws shape_error 205.
template <int New, Backend B, int R>
Tensor<B, New> reshape(const Tensor<B, R>& a, const std::array<Index, New>& sizes) {
  Index known = 1;
  int unknown = -1;
  for (int i = 0; i < New; ++i) {
    const Index n = sizes[static_cast<std::size_t>(i)];
    if (n == -1 && unknown < 0)
      unknown = i;
    else
      known *= n;
  }
  Shape s;
  for (int i = 0; i < New; ++i)
    s.push_back(i == unknown ? (known == 0 ? 0 : a.count() / known) : sizes[static_cast<std::size_t>(i)]);
  if (s.count() != a.count()) raise<shape_error>(205, "reshape: shape ", a.shape(), " cannot become ", s);
  return Tensor<B, New>(B::reshape(a.data(), s));
}

/// out[i_axes[0], i_axes[1], ...] = a[i_0, i_1, ...]
template <Backend B, int R>
Tensor<B, R> permute(const Tensor<B, R>& a, const std::array<int, static_cast<std::size_t>(R)>& axes) {
  unsigned seen = 0;
  for (int axis : axes) seen |= 1u << static_cast<unsigned>(normalize_axis(axis, R, "permute"));
  if (seen != (1u << R) - 1) raise<shape_error>(203, "permute: every axis must occur once");
  return Tensor<B, R>(B::permute(a.data(), std::span<const int>(axes)));
}
template <Backend B>
Tensor<B, 2> transpose(const Tensor<B, 2>& a) {
  return permute(a, {1, 0});
}

/// Sizes of 1 and missing leading axes are repeated.
template <int New, Backend B, int R>
requires(New >= R) Tensor<B, New> broadcast_to(const Tensor<B, R>& a, const Shape& s) {
  if (broadcast_shapes(a.shape(), s, "broadcast_to") != s)
    raise<shape_error>(202, "broadcast_to: ", a.shape(), " does not become ", s);
  return Tensor<B, New>(B::broadcast(a.data(), s));
}

/// Indices first ... last-1 along an axis. Throws shape_error 203.
template <Backend B, int R>
Tensor<B, R> slice(const Tensor<B, R>& a, int axis, Index first, Index last) {
  axis = normalize_axis(axis, R, "slice");
  if (first < 0 || last < first || last > a.size(axis)) {
    raise<shape_error>(203, "slice: ", first, " ... ", last, " of axis ", axis, " of ", a.shape());
  }
  return Tensor<B, R>(B::slice(a.data(), axis, first, last));
}

/// Joins along an axis; the other sizes must be equal. Throws shape_error 204.
template <Backend B, int R>
Tensor<B, R> concat(std::span<const Tensor<B, R>> list, int axis) {
  if (list.empty()) raise<shape_error>(205, "concat: nothing to join");
  axis = normalize_axis(axis, R, "concat");
  PoolVector<typename B::tensor> data;
  data.reserve(list.size());
  for (const auto& t : list) {
    if (t.shape().without(axis) != list.front().shape().without(axis)) {
      raise<shape_error>(204, "concat along axis ", axis, ": shapes ", list.front().shape(), " and ", t.shape());
    }
    data.push_back(t.data());
  }
  return Tensor<B, R>(B::concat(std::span<const typename B::tensor>(data), axis));
}
template <Backend B, int R, class... T>
Tensor<B, R> concat(int axis, const Tensor<B, R>& first, const T&... more) {
  axis = normalize_axis(axis, R, "concat");
  const Shape rest = first.shape().without(axis);
  auto check = [&](const Tensor<B, R>& t) {
    if (t.shape().without(axis) != rest) {
      raise<shape_error>(204, "concat along axis ", axis, ": shapes ", first.shape(), " and ", t.shape());
    }
  };
  (check(more), ...);
  const std::array<typename B::tensor, 1 + sizeof...(T)> data{first.data(), more.data()...};
  return Tensor<B, R>(B::concat(std::span<const typename B::tensor>(data), axis));
}

namespace detail {
inline void check_rows(const char* op, std::span<const Index> rows, Index n) {
  for (Index r : rows) {
    if (r < 0 || r >= n) raise<shape_error>(203, op, ": row ", r, " of ", n);
  }
}
}  // namespace detail

/// out[i] = a[rows[i]]: picks along the first axis; rows may repeat. Throws shape_error 203.
template <Backend B, int R>
requires(R > 0) Tensor<B, R> gather(const Tensor<B, R>& a, std::span<const Index> rows) {
  detail::check_rows("gather", rows, a.size(0));
  return Tensor<B, R>(B::gather(a.data(), rows));
}
/// out[rows[i]] += a[i] into n rows of zeros. The adjoint of gather. Throws shape_error 203, 204.
template <Backend B, int R>
requires(R > 0) Tensor<B, R> scatter_add(const Tensor<B, R>& a, std::span<const Index> rows, Index n) {
  if (static_cast<Index>(rows.size()) != a.size(0)) {
    raise<shape_error>(204, "scatter_add: ", Index(rows.size()), " rows for shape ", a.shape());
  }
  detail::check_rows("scatter_add", rows, n);
  return Tensor<B, R>(B::scatter_add(a.data(), rows, n));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B>
struct Sequences {
  Tensor<B, 2> rows;  // (sum of lengths, width)
  Offsets offsets;

  Sequences() = default;
  /// Throws shape_error 207 unless the offsets end at the last row.
  Sequences(Tensor<B, 2> r, Offsets o) : rows(std::move(r)), offsets(std::move(o)) {
    if (rows.size(0) != offsets.rows()) {
      raise<shape_error>(207, "Sequences: offsets for ", offsets.rows(), " rows, tensor is ", rows.shape());
    }
  }
  Index count() const { return offsets.count(); }
  Index width() const { return rows.size(1); }
  /// One sequence, (length, width).
  Tensor<B, 2> operator[](Index i) const { return slice(rows, 0, offsets.begin(i), offsets.end(i)); }
  /// The same structure with other rows.
  Sequences with(Tensor<B, 2> r) const { return {std::move(r), offsets}; }
};

/// For every row the number of its sequence.
inline PoolVector<Index> sequence_of_row(const Offsets& offsets) {
  PoolVector<Index> owner;
  owner.reserve(static_cast<std::size_t>(offsets.rows()));
  for (Index s = 0; s < offsets.count(); ++s) {
    for (Index i = 0; i < offsets.length(s); ++i) owner.push_back(s);
  }
  return owner;
}
/// One row per sequence to one per row of the sequences: (sequences, width) -> (rows, width).
template <Backend B>
Tensor<B, 2> repeat_for_rows(const Tensor<B, 2>& per_sequence, const Offsets& offsets) {
  return gather(per_sequence, sequence_of_row(offsets));
}
/// The same rows for each of `count` sequences.
template <Backend B>
Sequences<B> repeat_sequence(const Tensor<B, 2>& rows, Index count) {
  PoolVector<Index> pick;
  for (Index s = 0; s < count; ++s) {
    for (Index i = 0; i < rows.size(0); ++i) pick.push_back(i);
  }
  return {gather(rows, pick), Offsets::equal(count, rows.size(0))};
}

/// Joins sequence by sequence: the rows of a's sequence i, then of b's, ... Throws shape_error 204 if the counts
/// differ.
template <Backend B, class... T>
Sequences<B> concat_tokens(const Sequences<B>& first, const T&... more) {
  const std::array<const Offsets*, 1 + sizeof...(T)> parts{&first.offsets, &more.offsets...};
  PoolVector<Index> pick, lengths;
  for (Index s = 0; s < first.count(); ++s) {
    Index start = 0, length = 0;  // of the part among all rows; of the joined sequence
    for (const Offsets* part : parts) {
      if (part->count() != first.count()) {
        raise<shape_error>(204, "concat_tokens: ", first.count(), " sequences and ", part->count());
      }
      for (Index r = part->begin(s); r < part->end(s); ++r) pick.push_back(start + r);
      start += part->rows();
      length += part->length(s);
    }
    lengths.push_back(length);
  }
  return {gather(concat(0, first.rows, more.rows...), pick), Offsets(std::span<const Index>(lengths))};
}
/// The last tail.length(i) rows of each sequence. Throws shape_error 204, 207.
template <Backend B>
Sequences<B> last_rows(const Sequences<B>& x, const Offsets& tail) {
  if (tail.count() != x.count()) raise<shape_error>(204, "last_rows: ", x.count(), " sequences and ", tail.count());
  PoolVector<Index> pick;
  for (Index s = 0; s < x.count(); ++s) {
    if (tail.length(s) > x.offsets.length(s)) {
      raise<shape_error>(207, "last_rows: ", tail.length(s), " of ", x.offsets.length(s), " rows of sequence ", s);
    }
    for (Index r = x.offsets.end(s) - tail.length(s); r < x.offsets.end(s); ++r) pick.push_back(r);
  }
  return {gather(x.rows, pick), tail};
}
/// Each sequence without its first n rows.
template <Backend B>
Sequences<B> drop_tokens(const Sequences<B>& x, Index n) {
  PoolVector<Index> lengths;
  for (Index s = 0; s < x.count(); ++s) lengths.push_back(x.offsets.length(s) - n);
  return last_rows(x, Offsets(std::span<const Index>(lengths)));
}

/// true for the first lengths[i] of `longest` frames: (sequences, longest), row-major, 1 = valid.
inline std::vector<unsigned char> lengths_to_mask(std::span<const Index> lengths) {
  Index longest = 0;
  for (Index n : lengths) longest = n > longest ? n : longest;
  std::vector<unsigned char> mask;
  for (Index n : lengths) {
    for (Index i = 0; i < longest; ++i) mask.push_back(i < n ? 1 : 0);
  }
  return mask;
}

/// x (batch, time, width) and mask (batch, time; 0 = padding) to the valid rows. Padding need not be at the end.
template <Backend B>
Sequences<B> from_padded(const Tensor<B, 3>& x, std::span<const unsigned char> mask) {
  const Index batch = x.size(0), time = x.size(1);
  if (static_cast<Index>(mask.size()) != batch * time) {
    raise<shape_error>(205, "from_padded: ", Index(mask.size()), " mask values for shape ", x.shape());
  }
  std::vector<Index> rows, lengths;
  for (Index b = 0; b < batch; ++b) {
    const auto before = static_cast<Index>(rows.size());
    for (Index t = 0; t < time; ++t) {
      if (mask[static_cast<std::size_t>(b * time + t)] != 0) rows.push_back(b * time + t);
    }
    lengths.push_back(static_cast<Index>(rows.size()) - before);
  }
  return {gather(reshape<2>(x, {batch * time, x.size(2)}), rows), Offsets(lengths)};
}
/// The first lengths[i] frames of each. Throws shape_error 204, 205.
template <Backend B>
Sequences<B> from_padded(const Tensor<B, 3>& x, std::span<const Index> lengths) {
  std::vector<unsigned char> mask(static_cast<std::size_t>(x.size(0) * x.size(1)));
  if (static_cast<Index>(lengths.size()) != x.size(0)) {
    raise<shape_error>(204, "from_padded: ", Index(lengths.size()), " lengths for shape ", x.shape());
  }
  for (Index b = 0; b < x.size(0); ++b) {
    const Index length = lengths[static_cast<std::size_t>(b)];
    if (length < 0 || length > x.size(1)) {
      raise<shape_error>(205, "from_padded: length ", length, " of sequence ", b, " for shape ", x.shape());
    }
    for (Index t = 0; t < length; ++t) mask[static_cast<std::size_t>(b * x.size(1) + t)] = 1;
  }
  return from_padded(x, std::span<const unsigned char>(mask));
}
/// All sequences of a (batch, time, width) tensor at full length.
template <Backend B>
Sequences<B> from_equal(const Tensor<B, 3>& x) {
  return {reshape<2>(x, {x.size(0) * x.size(1), x.size(2)}), Offsets::equal(x.size(0), x.size(1))};
}

/// (batch, time, width) with `value` behind the end of each sequence; `time` is the longest length when 0.
template <Backend B>
Tensor<B, 3> to_padded(const Sequences<B>& x, double value = 0, Index time = 0) {
  if (time == 0) time = x.offsets.longest();
  if (time < x.offsets.longest())
    raise<shape_error>(205, "to_padded: ", time, " frames for a sequence of ", x.offsets.longest());
  // a last row of padding, which all padded positions pick
  const auto rows = concat(0, x.rows, Tensor<B, 2>::full({1, x.width()}, value));
  std::vector<Index> pick;
  for (Index i = 0; i < x.count(); ++i) {
    for (Index t = 0; t < time; ++t)
      pick.push_back(t < x.offsets.length(i) ? x.offsets.begin(i) + t : x.offsets.rows());
  }
  return reshape<3>(gather(rows, pick), {x.count(), time, x.width()});
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Applies a nonlinearity element by element (core/activation.hpp has the formulas).
template <Backend B, int R>
Tensor<B, R> activate(const Tensor<B, R>& x, Activation act) {
  if constexpr (requires { B::activate(x.data(), act); }) {
    return Tensor<B, R>(B::activate(x.data(), act));
  } else {
    switch (act) {
      case Activation::none:
        return x;
      case Activation::relu:
        return maximum(x, Tensor<B, R>(0.0));
      case Activation::gelu:
        return x * 0.5 * (erf(x * std::sqrt(0.5)) + 1.0);
      case Activation::silu:
        return x / (exp(-x) + 1.0);
      case Activation::tanh:
        return tanh(x);
      case Activation::quick_gelu:
        return x / (exp(x * -1.702) + 1.0);
      case Activation::gelu_new:
        return x * 0.5 * (tanh((x + x * x * x * 0.044715) * 0.79788456080286536) + 1.0);
    }
    return x;
  }
}

namespace detail {

template <Backend B>
void check_linear(const Tensor<B, 2>& x, const Tensor<B, 2>& weight, const Tensor<B, 1>* bias,
                  const Tensor<B, 2>* residual) {
  if (x.size(1) != weight.size(1)) {
    raise<shape_error>(201, "linear: inner sizes differ: input ", x.shape(), ", weight ", weight.shape());
  }
  if (bias != nullptr && bias->size(0) != weight.size(0)) {
    raise<shape_error>(204, "linear: bias ", bias->shape(), " for weight ", weight.shape());
  }
  if (residual != nullptr && residual->shape() != Shape{x.size(0), weight.size(0)}) {
    raise<shape_error>(204, "linear: residual ", residual->shape(), " for input ", x.shape(), " and weight ",
                       weight.shape());
  }
}

}  // namespace detail

/// y = act(x W^T + bias) + residual.   x (rows, in), weight (out, in), bias (out), residual (rows, out) -> (rows, out)
/// Bias and residual may be null. Throws shape_error 201, 204.
template <Backend B>
Tensor<B, 2> linear(const Tensor<B, 2>& x, const Tensor<B, 2>& weight, const Tensor<B, 1>* bias,
                    Activation act = Activation::none, const Tensor<B, 2>* residual = nullptr) {
  detail::check_linear(x, weight, bias, residual);
  using T = const typename B::tensor*;
  if constexpr (requires { B::linear(x.data(), weight.data(), T{}, act, T{}); }) {
    return Tensor<B, 2>(B::linear(x.data(), weight.data(), bias == nullptr ? nullptr : &bias->data(), act,
                                  residual == nullptr ? nullptr : &residual->data()));
  } else {
    auto y = matmul(x, weight, {.transpose_b = true});
    if (bias != nullptr) y = y + *bias;
    if (act != Activation::none) y = activate(y, act);
    return residual == nullptr ? y : y + *residual;
  }
}

/// Layer normalisation over the last axis (Ba et al. 2016): (x - mean) / sqrt(variance + eps) weight + bias, with the
/// variance divided by n. Throws shape_error 204.
template <Backend B>
Tensor<B, 2> layer_norm(const Tensor<B, 2>& x, const Tensor<B, 1>& weight, const Tensor<B, 1>& bias,
                        double eps = 1e-5) {
  if (weight.size(0) != x.size(1) || bias.size(0) != x.size(1)) {
    raise<shape_error>(204, "layer_norm: weight ", weight.shape(), " and bias ", bias.shape(), " for input ",
                       x.shape());
  }
  if constexpr (requires { B::layer_norm(x.data(), weight.data(), bias.data(), eps); }) {
    return Tensor<B, 2>(B::layer_norm(x.data(), weight.data(), bias.data(), eps));
  } else {
    const Index rows = x.size(0);
    const auto centred = x - reshape<2>(mean(x, 1), {rows, 1});
    const auto variance = reshape<2>(mean(square(centred), 1), {rows, 1});
    return centred / sqrt(variance + eps) * weight + bias;
  }
}
/// layer_norm(x + residual): the second half of a post-norm block.
template <Backend B>
Tensor<B, 2> add_layer_norm(const Tensor<B, 2>& x, const Tensor<B, 2>& residual, const Tensor<B, 1>& weight,
                            const Tensor<B, 1>& bias, double eps = 1e-5) {
  if constexpr (requires { B::add_layer_norm(x.data(), residual.data(), weight.data(), bias.data(), eps); }) {
    if (x.shape() != residual.shape() || weight.size(0) != x.size(1) || bias.size(0) != x.size(1)) {
      raise<shape_error>(204, "add_layer_norm: input ", x.shape(), ", residual ", residual.shape(), ", weight ",
                         weight.shape());
    }
    return Tensor<B, 2>(B::add_layer_norm(x.data(), residual.data(), weight.data(), bias.data(), eps));
  } else {
    return layer_norm(x + residual, weight, bias, eps);
  }
}

/// softmax over the last axis: exp(x - max) / sum.
template <Backend B>
Tensor<B, 2> softmax(const Tensor<B, 2>& x) {
  if constexpr (requires { B::softmax(x.data()); }) {
    return Tensor<B, 2>(B::softmax(x.data()));
  } else {
    const auto e = exp(x - reshape<2>(max(x, 1), {x.size(0), 1}));
    return e / reshape<2>(sum(e, 1), {x.size(0), 1});
  }
}

/// x times the mask of core/dropout.hpp; positions are row-major.
template <Backend B, int R>
Tensor<B, R> dropout(const Tensor<B, R>& x, const Dropout& d) {
  if (d.p == 0) return x;
  if (!(d.p > 0 && d.p < 1)) raise<config_error>(101, "dropout: probability ", d.p, " is not in [0, 1)");
  if constexpr (requires { B::dropout(x.data(), d); }) {
    return Tensor<B, R>(B::dropout(x.data(), d));
  } else {
    std::vector<typename B::scalar> mask(static_cast<std::size_t>(x.count()));
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = static_cast<typename B::scalar>(d.factor(i));
    return x * Tensor<B, R>::from(mask, x.shape());
  }
}

struct AttentionOptions {
  Index heads = 1;
  bool causal = false;  // a query sees the keys up to its own position only
  Dropout dropout{};    // on the attention weights
};

namespace detail {

template <Backend B>
void check_attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, const Offsets& q_offsets,
                     const Offsets& k_offsets, const AttentionOptions& options,
                     const Tensor<B, 2>* relative_scores = nullptr) {
  if (q.size(1) != k.size(1) || k.shape() != v.shape()) {
    raise<shape_error>(204, "attention: q ", q.shape(), ", k ", k.shape(), ", v ", v.shape());
  }
  if (options.heads < 1 || q.size(1) % options.heads != 0) {
    raise<config_error>(101, "attention: ", options.heads, " heads do not divide width ", q.size(1));
  }
  if (q_offsets.rows() != q.size(0) || k_offsets.rows() != k.size(0) || q_offsets.count() != k_offsets.count()) {
    raise<shape_error>(207, "attention: offsets for ", q_offsets.rows(), " and ", k_offsets.rows(), " rows, q ",
                       q.shape(), ", k ", k.shape());
  }
  for (Index s = 0; s < k_offsets.count(); ++s) {
    if (k_offsets.length(s) == 0 && q_offsets.length(s) > 0)
      raise<shape_error>(207, "attention: sequence ", s, " has no keys");
    if (k_offsets.length(s) > 65536) raise<shape_error>(207, "attention: sequence ", s, " has more than 65536 keys");
  }
  if (relative_scores == nullptr) return;
  const Index farthest = std::max(q_offsets.longest(), k_offsets.longest()) - 1;
  if (relative_scores->size(0) != options.heads || relative_scores->size(1) % 2 != 1 ||
      relative_scores->size(1) / 2 < farthest) {
    raise<shape_error>(204, "attention: relative scores ", relative_scores->shape(), " for ", options.heads,
                       " heads and distances up to ", farthest);
  }
}

/// (queries, keys) of one head: element (i, j) is that of distance j - i.
template <Backend B>
Tensor<B, 2> scores_of_distances(const Tensor<B, 2>& relative_scores, Index head, Index tq, Index tk) {
  const Index zero = relative_scores.size(1) / 2;  // the column of distance 0
  PoolVector<Index> columns;
  for (Index i = 0; i < tq; ++i) {
    for (Index j = 0; j < tk; ++j) columns.push_back(zero + j - i);
  }
  return reshape<2>(gather(reshape<1>(slice(relative_scores, 0, head, head + 1), {-1}), columns), {tq, tk});
}

/// softmax(q k^T / sqrt(width) + relative scores) v for one head of one sequence; q (tq, width), k and v (tk, width).
template <Backend B>
Tensor<B, 2> attend(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, Index first_row, Index head,
                    const AttentionOptions& o, const Tensor<B, 2>* relative_scores) {
  const Index tq = q.size(0), tk = k.size(0);
  auto scores = matmul(q, k, {.transpose_b = true}) * (1.0 / std::sqrt(static_cast<double>(q.size(1))));
  if (relative_scores != nullptr) scores = scores + scores_of_distances(*relative_scores, head, tq, tk);
  using S = typename B::scalar;
  std::vector<S> values(static_cast<std::size_t>(tq * tk));
  if (o.causal) {
    for (Index i = 0; i < tq; ++i) {
      for (Index j = i + 1; j < tk; ++j) values[static_cast<std::size_t>(i * tk + j)] = S(-1e30);
    }
    scores = scores + Tensor<B, 2>::from(values, {tq, tk});
  }
  auto weights = softmax(scores);
  if (o.dropout.p > 0) {
    for (Index i = 0; i < tq; ++i) {
      for (Index j = 0; j < tk; ++j) {
        values[static_cast<std::size_t>(i * tk + j)] =
            static_cast<S>(o.dropout.factor(Dropout::attention_position(first_row + i, o.heads, head, j)));
      }
    }
    weights = weights * Tensor<B, 2>::from(values, {tq, tk});
  }
  return matmul(weights, v);
}

}  // namespace detail

/// Multi-head attention over packed sequences (Vaswani et al. 2017, eq. 1); heads are contiguous slices of the width.
///     O_h = softmax(Q_h K_h^T / sqrt(width / heads) + R_h) V_h     within each sequence
/// q (query rows, width), k and v (key rows, width) -> (query rows, width). Padding does not exist here: a key that is
/// masked is simply not in the sequence (see from_padded). R may be null; element (i, j) of R_h is a number of the distance
/// j - i: column j - i + n of relative_scores (heads, 2 n + 1). Throws config_error 101, shape_error 204, 207.
template <Backend B>
Tensor<B, 2> attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, const Offsets& q_offsets,
                       const Offsets& k_offsets, const AttentionOptions& options,
                       const Tensor<B, 2>* relative_scores = nullptr) {
  detail::check_attention(q, k, v, q_offsets, k_offsets, options, relative_scores);
  using T = const typename B::tensor*;
  if constexpr (requires { B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options, T{}); }) {
    return Tensor<B, 2>(B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options,
                                     relative_scores == nullptr ? nullptr : &relative_scores->data()));
  } else {
    if constexpr (requires { B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options); }) {
      if (relative_scores == nullptr)
        return Tensor<B, 2>(B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options));
    }
    const Index width = q.size(1) / options.heads;
    std::vector<Tensor<B, 2>> sequences, heads;
    for (Index s = 0; s < q_offsets.count(); ++s) {
      const auto qs = slice(q, 0, q_offsets.begin(s), q_offsets.end(s));
      const auto ks = slice(k, 0, k_offsets.begin(s), k_offsets.end(s)),
                 vs = slice(v, 0, k_offsets.begin(s), k_offsets.end(s));
      heads.clear();
      for (Index h = 0; h < options.heads; ++h) {
        auto columns = [&](const Tensor<B, 2>& t) { return slice(t, 1, h * width, (h + 1) * width); };
        heads.push_back(
            detail::attend(columns(qs), columns(ks), columns(vs), q_offsets.begin(s), h, options, relative_scores));
      }
      sequences.push_back(concat(std::span<const Tensor<B, 2>>(heads), 1));
    }
    return sequences.empty() ? q : concat(std::span<const Tensor<B, 2>>(sequences), 0);
  }
}

/// The same with q, k and v side by side, as one projection makes them: qkv (rows, 3 width) -> (rows, width).
template <Backend B>
Tensor<B, 2> self_attention(const Tensor<B, 2>& qkv, const Offsets& offsets, const AttentionOptions& options) {
  if (qkv.size(1) % 3 != 0) raise<shape_error>(204, "self_attention: ", qkv.shape(), " is not three parts wide");
  const Index d = qkv.size(1) / 3;
  if constexpr (requires { B::self_attention(qkv.data(), offsets, options); }) {
    if (options.heads < 1 || d % options.heads != 0) {
      raise<config_error>(101, "self_attention: ", options.heads, " heads do not divide width ", d);
    }
    if (offsets.rows() != qkv.size(0))
      raise<shape_error>(207, "self_attention: offsets for ", offsets.rows(), " rows, ", qkv.shape());
    if (offsets.longest() > 65536) raise<shape_error>(207, "self_attention: a sequence has more than 65536 rows");
    return Tensor<B, 2>(B::self_attention(qkv.data(), offsets, options));
  } else {
    return attention(slice(qkv, 1, 0, d), slice(qkv, 1, d, 2 * d), slice(qkv, 1, 2 * d, 3 * d), offsets, offsets,
                     options);
  }
}

/// One step of AdamW on one parameter; optim/adamw.hpp has the formula.
struct AdamwUpdate {
  double lr = 0, beta1 = 0, beta2 = 0, eps = 0, weight_decay = 0, gradient_scale = 1;
  Index step = 1;  // 1 for the first
};

/// Updates the parameter p and the moments m and v with gradient g, all of one shape.
template <Backend B>
void adamw_update(typename B::tensor& p, typename B::tensor& m, typename B::tensor& v, const typename B::tensor& g,
                  const AdamwUpdate& u) {
  if constexpr (requires { B::adamw(p, m, v, g, u); }) {
    B::adamw(p, m, v, g, u);
  } else {
    using T = typename B::tensor;
    auto number = [](double c) { return B::full(Shape{}, static_cast<typename B::scalar>(c)); };
    auto times = [&](const T& a, double c) { return B::mul(a, number(c)); };
    const double k = static_cast<double>(u.step);
    const T scaled = times(g, u.gradient_scale);
    m = B::add(times(m, u.beta1), times(scaled, 1 - u.beta1));
    v = B::add(times(v, u.beta2), times(B::mul(scaled, scaled), 1 - u.beta2));
    const T root = times(B::sqrt(v), 1 / std::sqrt(1 - std::pow(u.beta2, k)));
    const T change = B::div(m, B::add(root, number(u.eps)));
    p = B::sub(times(p, 1 - u.lr * u.weight_decay), times(change, u.lr / (1 - std::pow(u.beta1, k))));
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TENSOR_GRADIENT_HPP  // <motionlang/tensor/gradient.hpp>
#define MOTIONLANG_HAS_TENSOR_GRADIENT_HPP
/// Differentiation as user code sees it: variables, `backward`, and gradients as a value.

namespace motionlang::inline MOTIONLANG_ABI {

/// What `backward` returns: the gradient of every variable, on the inner backend.
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

/// Gradients of a scalar with respect to all variables behind it. Only for Autodiff backends.
template <Backend A>
auto backward(const Tensor<A, 0>& loss) {
  static_assert(AutodiffBackend<A>,
                "motionlang::backward(loss) requires a loss computed on Autodiff<B>; this backend keeps no graph");
  return Gradients<A>(A::gradients(loss.data()));
}

/// A leaf that gradients are wanted for.
template <AutodiffBackend A, int R>
Tensor<A, R> variable(const Tensor<typename A::inner, R>& value) {
  return Tensor<A, R>(A::variable(value.data()));
}
/// The plain value of a differentiable tensor.
template <AutodiffBackend A, int R>
Tensor<typename A::inner, R> value_of(const Tensor<A, R>& t) {
  return Tensor<typename A::inner, R>(A::value(t.data()));
}
/// The same value as a constant: gradients stop here.
template <AutodiffBackend A, int R>
Tensor<A, R> stop_gradient(const Tensor<A, R>& t) {
  return Tensor<A, R>(typename A::tensor{A::value(t.data()), nullptr});
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TENSOR_MODULE_HPP  // <motionlang/tensor/module.hpp>
#define MOTIONLANG_HAS_TENSOR_MODULE_HPP
/// What every module can do because it lists its fields: visit tensors, count parameters, move to another backend.

namespace motionlang::inline MOTIONLANG_ABI {

/// Statistics and tables (`static constexpr bool trainable = false`) are saved and loaded, but get no gradient.
template <class M>
inline constexpr bool is_trainable = [] {
  if constexpr (requires { M::trainable; })
    return M::trainable;
  else
    return true;
}();

namespace detail {

/// Passes the tensors among the leaves on to f. A type of its own: inside visit_tensors it would be another one for every
/// module, and all that lies below would be compiled again.
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

struct PrepareWeights {
  template <Backend B, int R>
  void operator()(const std::string&, Tensor<B, R>& t) const {
    if constexpr (R == 2 && requires { B::prepare(t.data()); }) B::prepare(t.data());
  }
};

}  // namespace detail

/// Makes a model ready for inference: weights of linear layers are packed for the backend's kernels. The model must not
/// be changed afterwards. Nothing happens on backends without such a layout.
template <Module M>
void prepare(M& model) {
  visit_tensors(model, detail::PrepareWeights{});
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TENSOR_NORMALIZE_HPP  // <motionlang/tensor/normalize.hpp>
#define MOTIONLANG_HAS_TENSOR_NORMALIZE_HPP
/// Rows of length 1: what cosine similarity needs, in losses and in encoders.

namespace motionlang::inline MOTIONLANG_ABI {

/// Rows divided by max(norm, 1e-12). The sums are a product with ones, whose order does not depend on the number of rows: a row has the
/// same bits alone and among others.
template <Backend B>
Tensor<B, 2> normalize_rows(const Tensor<B, 2>& x) {
  const auto squared = matmul(square(x), Tensor<B, 2>::full({x.size(1), 1}, 1));
  return x / sqrt(maximum(squared, Tensor<B, 2>(1e-24)));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_AXIS_ANGLE_HPP  // <motionlang/geometry/axis_angle.hpp>
#define MOTIONLANG_HAS_GEOMETRY_AXIS_ANGLE_HPP
/// Rotation vectors: the axis times the angle in radians. Exponential and logarithm of SO(3) in quaternion form.

#ifndef MOTIONLANG_HAS_GEOMETRY_QUATERNION_HPP  // <motionlang/geometry/quaternion.hpp>
#define MOTIONLANG_HAS_GEOMETRY_QUATERNION_HPP
/// Unit quaternions (w, x, y, z), Hamilton product.

#ifndef MOTIONLANG_HAS_GEOMETRY_MATRIX_HPP  // <motionlang/geometry/matrix.hpp>
#define MOTIONLANG_HAS_GEOMETRY_MATRIX_HPP
/// Rotation matrices, and the concept of a rotation.
///
/// Conventions of the whole library: right-handed, active rotations, column vectors (v' = R v).

#ifndef MOTIONLANG_HAS_GEOMETRY_VEC_HPP  // <motionlang/geometry/vec.hpp>
#define MOTIONLANG_HAS_GEOMETRY_VEC_HPP
/// Vectors of three coordinates.

namespace motionlang::inline MOTIONLANG_ABI {

template <class S>
struct Vec3 {
  S x{}, y{}, z{};

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(const S& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend Vec3 operator*(const Vec3& a, const S& s) { return s * a; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};
template <class S>
Vec3(S, S, S) -> Vec3<S>;

template <class S>
S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
S norm(const Vec3<S>& a) {
  return sqrt(dot(a, a));
}

/// a / max(|a|, floor). The published code uses floor = 1e-12: a zero vector stays zero and its derivative stays
/// finite.
template <class S>
Vec3<S> normalized(const Vec3<S>& a, double floor = 1e-12) {
  const S squared = dot(a, a), least = S(floor * floor);
  const S length = sqrt(where_less(squared, least, least, squared));
  return {a.x / length, a.y / length, a.z / length};
}

/// The same vector over another scalar.
template <class S, class T>
Vec3<S> vec_cast(const Vec3<T>& a) {
  return {S(a.x), S(a.y), S(a.z)};
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Three by three numbers, row by row: m[3 * row + column].
template <class S>
struct Matrix3 {
  std::array<S, 9> m{};

  static Matrix3 identity() { return {{S(1), S(0), S(0), S(0), S(1), S(0), S(0), S(0), S(1)}}; }
  static Matrix3 from_rows(const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c) {
    return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}};
  }
  static Matrix3 from_columns(const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c) {
    return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
  }

  const S& operator()(int row, int column) const { return m[static_cast<std::size_t>(3 * row + column)]; }
  S& operator()(int row, int column) { return m[static_cast<std::size_t>(3 * row + column)]; }
  Vec3<S> row(int i) const { return {(*this)(i, 0), (*this)(i, 1), (*this)(i, 2)}; }
  Vec3<S> column(int j) const { return {(*this)(0, j), (*this)(1, j), (*this)(2, j)}; }

  friend Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    Matrix3 c;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) c(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
    }
    return c;
  }
  friend Vec3<S> operator*(const Matrix3& a, const Vec3<S>& v) {
    return {dot(a.row(0), v), dot(a.row(1), v), dot(a.row(2), v)};
  }
};

template <class S>
Matrix3<S> transpose(const Matrix3<S>& a) {
  return Matrix3<S>::from_columns(a.row(0), a.row(1), a.row(2));
}
template <class S>
Matrix3<S> inverse(const Matrix3<S>& rotation) {
  return transpose(rotation);
}
template <class S>
const Matrix3<S>& to_matrix(const Matrix3<S>& a) {
  return a;
}
template <class S, class T>
Matrix3<S> matrix_cast(const Matrix3<T>& a) {
  Matrix3<S> b;
  for (std::size_t i = 0; i < 9; ++i) b.m[i] = S(a.m[i]);
  return b;
}

/// One parameterisation of rotations in three dimensions.
/// Minimum   to_matrix(r)
/// Deduced   to_quaternion, to_axis_angle, compose, inverse, distance, slerp (so3.hpp, slerp.hpp)
/// Laws      to_matrix(r) is orthonormal with determinant 1; converting there and back gives the same matrix
/// Models    Matrix3, Quaternion, AxisAngle, EulerAngles, Rotation6dRows, Rotation6dColumns
template <class R>
concept Rotation = requires(const R& r) {
  to_matrix(r).m;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

template <class S>
struct Quaternion {
  S w{}, x{}, y{}, z{};

  static Quaternion identity() { return {S(1), S(0), S(0), S(0)}; }
  Vec3<S> vec() const { return {x, y, z}; }

  friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend Quaternion operator*(const S& s, const Quaternion& q) { return {s * q.w, s * q.x, s * q.y, s * q.z}; }
  friend Quaternion operator+(const Quaternion& a, const Quaternion& b) {
    return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Quaternion operator-(const Quaternion& q) { return {-q.w, -q.x, -q.y, -q.z}; }
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};
template <class S>
Quaternion(S, S, S, S) -> Quaternion<S>;

template <class S>
S dot(const Quaternion<S>& a, const Quaternion<S>& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
/// The inverse of a unit quaternion.
template <class S>
Quaternion<S> inverse(const Quaternion<S>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
template <class S>
Quaternion<S> normalized(const Quaternion<S>& q) {
  return (S(1) / sqrt(dot(q, q))) * q;
}
/// q v q^-1 = v + 2 (w (u x v) + u x (u x v)), u = (x, y, z). For unit q.
template <class S>
Vec3<S> rotate(const Quaternion<S>& q, const Vec3<S>& v) {
  const Vec3<S> uv = cross(q.vec(), v);
  return v + S(2) * (q.w * uv + cross(q.vec(), uv));
}

/// Matrix of a quaternion; one that is not of unit length is tolerated: factor 2 / (q . q).
template <class S>
Matrix3<S> to_matrix(const Quaternion<S>& q) {
  const S k = S(2) / dot(q, q);
  const S xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const S xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{S(1) - k * (yy + zz), k * (xy - wz), k * (xz + wy),  //
           k * (xy + wz), S(1) - k * (xx + zz), k * (yz - wx),  //
           k * (xz - wy), k * (yz + wx), S(1) - k * (xx + yy)}};
}

/// The quaternion with w >= 0 of a rotation matrix; accurate everywhere, also near half turns.
/// Source  Shepperd (1978): divide by the largest of |w|, |x|, |y|, |z|. All four candidates are computed and one is
///         chosen by where_less, so that SIMD lanes and tensors can do it, too.
template <class S>
Quaternion<S> to_quaternion(const Matrix3<S>& r) {
  const S m00 = r(0, 0), m11 = r(1, 1), m22 = r(2, 2), zero = S(0), tiny = S(1e-12);
  const S sw = S(1) + m00 + m11 + m22, sx = S(1) + m00 - m11 - m22, sy = S(1) - m00 + m11 - m22,
          sz = S(1) - m00 - m11 + m22;
  auto half_root = [&](const S& s) { return S(0.5) * sqrt(where_less(s, tiny, tiny, s)); };
  const S w = half_root(sw), x = half_root(sx), y = half_root(sy), z = half_root(sz);
  const S a = r(2, 1) - r(1, 2), b = r(0, 2) - r(2, 0), c = r(1, 0) - r(0, 1);
  const S d = r(1, 0) + r(0, 1), e = r(0, 2) + r(2, 0), f = r(2, 1) + r(1, 2);
  auto select = [](const S& p, const S& q, const Quaternion<S>& less, const Quaternion<S>& other) {
    return Quaternion<S>{where_less(p, q, less.w, other.w), where_less(p, q, less.x, other.x),
                         where_less(p, q, less.y, other.y), where_less(p, q, less.z, other.z)};
  };
  const S iw = S(0.25) / w, ix = S(0.25) / x, iy = S(0.25) / y, iz = S(0.25) / z;
  const Quaternion<S> by_w{w, a * iw, b * iw, c * iw}, by_x{a * ix, x, d * ix, e * ix};
  const Quaternion<S> by_y{b * iy, d * iy, y, f * iy}, by_z{c * iz, e * iz, f * iz, z};
  const Quaternion<S> wx = select(sw, sx, by_x, by_w), yz = select(sy, sz, by_z, by_y);
  const Quaternion<S> q = select(where_less(sw, sx, sx, sw), where_less(sy, sz, sz, sy), yz, wx);
  return select(q.w, zero, -q, q);
}
template <class S>
const Quaternion<S>& to_quaternion(const Quaternion<S>& q) {
  return q;
}
template <Rotation R>
auto to_quaternion(const R& r) {
  return to_quaternion(to_matrix(r));
}
static_assert(Rotation<Quaternion<double>> && Rotation<Matrix3<float>>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

template <class S>
struct AxisAngle {
  Vec3<S> v{};
};
template <class S>
AxisAngle(Vec3<S>) -> AxisAngle<S>;

/// q = (cos(t/2), sin(t/2)/t v), t = |v|. Below t = 1e-3 the factor is 1/2 - t^2/48 + t^4/3840: smooth at 0.
template <class S>
Quaternion<S> to_quaternion(const AxisAngle<S>& r) {
  const S t2 = dot(r.v, r.v), small = S(1e-6);
  const S t = sqrt(where_less(t2, small, small, t2));  // never 0, so that the branch not taken stays finite
  const S series = S(0.5) - t2 * (S(1.0 / 48) - t2 * S(1.0 / 3840));
  const S factor = where_less(t2, small, series, sin(S(0.5) * t) / t);
  const S w = where_less(t2, small, S(1) - t2 * (S(0.125) - t2 * S(1.0 / 384)), cos(S(0.5) * t));
  return {w, factor * r.v.x, factor * r.v.y, factor * r.v.z};
}
template <class S>
Matrix3<S> to_matrix(const AxisAngle<S>& r) {
  return to_matrix(to_quaternion(r));
}
/// Rotation by `angle` radians about a unit axis.
template <class S>
Quaternion<S> from_axis_angle(const Vec3<S>& axis, const S& angle) {
  return to_quaternion(AxisAngle<S>{angle * axis});
}

/// The shortest rotation vector (length at most pi). Right up to and at pi; smooth at 0.
///     v = 2 atan2(n, |w|) / n (x, y, z) sign(w),   n = |(x, y, z)|
///     for small n the factor is 2/w (1 - n^2 / (3 w^2))
template <class S>
AxisAngle<S> to_axis_angle(const Quaternion<S>& q) {
  const S n2 = dot(q.vec(), q.vec()), small = S(1e-8), zero = S(0);
  const S n = sqrt(where_less(n2, small, small, n2));
  const S w = where_less(q.w, zero, -q.w, q.w), sign = where_less(q.w, zero, S(-1), S(1));
  const S safe_w = where_less(n2, small, w, S(1));
  const S series = S(2) / safe_w * (S(1) - n2 / (S(3) * safe_w * safe_w));
  const S factor = sign * where_less(n2, small, series, S(2) * atan2(n, w) / n);
  return {factor * q.vec()};
}
template <class S>
const AxisAngle<S>& to_axis_angle(const AxisAngle<S>& r) {
  return r;
}
template <Rotation R>
auto to_axis_angle(const R& r) {
  return to_axis_angle(to_quaternion(r));
}
static_assert(Rotation<AxisAngle<double>>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_EULER_HPP  // <motionlang/geometry/euler.hpp>
#define MOTIONLANG_HAS_GEOMETRY_EULER_HPP
/// Euler angles in all twelve orders.
///
/// Intrinsic angles: order "ZXY" means R = Rz(a) Rx(b) Ry(c) on column vectors, the first letter outermost, which is
/// the order of BVH channels and of pytorch3d's conventions.

namespace motionlang::inline MOTIONLANG_ABI {

/// Three axes, 0 = x, 1 = y, 2 = z; neighbours differ.
struct EulerOrder {
  std::array<int, 3> axis{2, 0, 1};

  /// From "XYZ", "ZXZ", ... Throws config_error 103.
  static EulerOrder parse(std::string_view letters) {
    EulerOrder o;
    bool ok = letters.size() == 3;
    for (std::size_t i = 0; ok && i < 3; ++i) {
      const char c = static_cast<char>(letters[i] | 0x20);
      o.axis[i] = c - 'x';
      ok = c >= 'x' && c <= 'z' && (i == 0 || o.axis[i] != o.axis[i - 1]);
    }
    if (!ok) raise<config_error>(103, "EulerOrder: '", letters, "' is not an order of rotation axes");
    return o;
  }
  bool operator==(const EulerOrder&) const = default;
};

/// Radians, in the order of the axes.
template <class S>
struct EulerAngles {
  S a{}, b{}, c{};
  EulerOrder order{};
};

/// Rotation about one coordinate axis (0, 1, 2).
template <class S>
Matrix3<S> axis_rotation(int axis, const S& angle) {
  const S c = cos(angle), s = sin(angle);
  Matrix3<S> m = Matrix3<S>::identity();
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  m(i, i) = c;
  m(j, j) = c;
  m(i, j) = -s;
  m(j, i) = s;
  return m;
}

template <class S>
Matrix3<S> to_matrix(const EulerAngles<S>& e) {
  return axis_rotation(e.order.axis[0], e.a) * axis_rotation(e.order.axis[1], e.b) *
         axis_rotation(e.order.axis[2], e.c);
}

/// The angles of a rotation. The middle one lies in [-pi/2, pi/2] for three different axes, in [0, pi] for a proper
/// order (ZXZ). Arc tangents only, so nothing needs clamping. Where the first and last axis coincide (gimbal lock,
/// within 1e-6) the last angle is `last` and the first takes up the rest.
template <class R>
requires Rotation<R>
auto to_euler(const R& rotation, EulerOrder order, double last = 0.0) {
  const auto& m = to_matrix(rotation);
  using S = std::remove_cvref_t<decltype(m.m[0])>;
  const int i = order.axis[0], j = order.axis[1], k = order.axis[2];
  const bool proper = i == k;
  const int l = proper ? 3 - i - j : k;
  const double sign = (j - i + 3) % 3 == 1 ? 1.0 : -1.0;  // of the permutation (i, j, l)
  const S plus = S(sign), lock = S(1e-6);
  EulerAngles<S> e{.order = order};
  // Product for three axes: m(i, k) = sign sin b, first angle from column k, last from row i. For a proper order: m(i,
  // i) = cos b.
  const S middle = proper ? m(i, i) : plus * m(i, k);
  const S other = proper ? sqrt(m(i, j) * m(i, j) + m(i, l) * m(i, l)) : sqrt(m(i, i) * m(i, i) + m(i, j) * m(i, j));
  e.b = proper ? atan2(other, middle) : atan2(middle, other);
  const S first = proper ? atan2(m(j, i), -(plus * m(l, i))) : atan2(-(plus * m(j, k)), m(k, k));
  const S third = proper ? atan2(m(i, j), plus * m(i, l)) : atan2(-(plus * m(i, j)), m(i, i));
  // Locked: with c given, column j of R Rk(-c) = Ri(a) Rj(b) is that of Ri(a) alone.
  const S c = S(last);
  const Vec3<S> column = m * axis_rotation(k, -c).column(j);
  const std::array<S, 3> turned{column.x, column.y, column.z};
  const S locked_first = atan2(plus * turned[static_cast<std::size_t>(l)], turned[static_cast<std::size_t>(j)]);
  e.a = where_less(other, lock, locked_first, first);
  e.c = where_less(other, lock, c, third);
  return e;
}
static_assert(Rotation<EulerAngles<double>>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_GUO_HPP  // <motionlang/geometry/guo.hpp>
#define MOTIONLANG_HAS_GEOMETRY_GUO_HPP
/// The quaternion formulas of HumanML3D, T2M and TM2T, for parity with their features. What is not here is the same as
/// in quaternion.hpp, rotation6d.hpp, euler.hpp (`to_euler`) and axis_angle.hpp.
///
/// They differ where the general functions are safer: `between` has no answer for opposite vectors, `slerp` takes the
/// long way if the quaternions lie in different hemispheres. Use them to reproduce published numbers, not otherwise.
/// Source  Guo et al. (CVPR 2022), common/quaternion.py; spec humanml3d-features.md 11b

namespace motionlang::inline MOTIONLANG_ABI::guo {

/// The shortest rotation from a to b, of any length:  q ~ (|a||b| + a . b, a x b).  NaN for opposite vectors.
/// lengths = |a||b|, where it is known.
template <class S>
Quaternion<S> between(const Vec3<S>& a, const Vec3<S>& b, const S& lengths) {
  const Vec3<S> c = cross(a, b);
  return normalized(Quaternion<S>{lengths + dot(a, b), c.x, c.y, c.z});
}
template <class S>
Quaternion<S> between(const Vec3<S>& a, const Vec3<S>& b) {
  return between(a, b, sqrt(dot(a, a) * dot(b, b)));
}

/// Signs such that each quaternion and the same joint's in the frame before are no more than a half turn apart.
/// rotations (frames, joints). Throws shape_error 205.
template <Scalar S>
std::vector<Quaternion<S>> continuous(std::span<const Quaternion<S>> rotations, Index joints) {
  if (joints <= 0 || std::ssize(rotations) % joints != 0) {
    raise<shape_error>(205, "continuous: ", rotations.size(), " rotations for frames of ", joints, " joints");
  }
  std::vector<Quaternion<S>> out(rotations.begin(), rotations.end());
  const auto n = static_cast<std::size_t>(joints);
  for (std::size_t i = n; i < out.size(); ++i) {
    if (dot(out[i - n], out[i]) < 0) out[i] = -out[i];
  }
  return out;
}

/// a at t = 0, b at t = 1; both are normalised first, and no sign is changed.
///     d = b a^-1 = (cos h, sin h u);   slerp = (cos(t h), sin(t h) u) a
template <class S>
Quaternion<S> slerp(const Quaternion<S>& a, const Quaternion<S>& b, const S& t) {
  const Quaternion<S> from = normalized(a), d = normalized(normalized(b) * inverse(from));
  const S h = atan2(norm(d.vec()), d.w);
  const Vec3<S> u = sin(t * h) * normalized(d.vec(), 1e-9);
  return Quaternion<S>{cos(t * h), u.x, u.y, u.z} * from;
}

/// The quaternion whose component that the published code divides by is positive; w may be negative.
template <Scalar S>
Quaternion<S> matrix_to_quaternion(const Matrix3<S>& m) {
  const Quaternion<S> q = to_quaternion(m);
  const S x = m(0, 0), y = m(1, 1), divisor = m(2, 2) < 0 ? (x > y ? q.x : q.y) : (x < -y ? q.z : q.w);
  return divisor < 0 ? -q : q;
}

/// From angles about x, y and z in degrees, whatever the order. For the cyclic orders xyz, yzx and zxy the sign of the
/// quaternion is the other one.
template <Scalar S>
Quaternion<S> from_euler_degrees(const Vec3<S>& angles, EulerOrder order) {
  Quaternion<S> q = Quaternion<S>::identity();
  for (const int axis : order.axis) {
    const Vec3<S> about{S(axis == 0), S(axis == 1), S(axis == 2)};
    q = q * from_axis_angle(about, dot(about, angles) * S(std::numbers::pi / 180));
  }
  return (order.axis[1] - order.axis[0] + 3) % 3 == 1 ? -q : q;
}

}  // namespace motionlang::inline MOTIONLANG_ABI::guo
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_PYTORCH3D_HPP  // <motionlang/geometry/pytorch3d.hpp>
#define MOTIONLANG_HAS_GEOMETRY_PYTORCH3D_HPP
/// The rotation formulas that the published systems share (an old version of pytorch3d), for parity with their
/// features.
///
/// They differ from quaternion.hpp and axis_angle.hpp where those are more accurate: matrix_to_quaternion loses half of
/// the digits near 0 and near pi and is wrong at pi for axes of mixed signs; quaternion_to_axis_angle does not take the
/// shorter way round. Use them to reproduce published numbers, not otherwise.

#ifndef MOTIONLANG_HAS_GEOMETRY_ROTATION6D_HPP  // <motionlang/geometry/rotation6d.hpp>
#define MOTIONLANG_HAS_GEOMETRY_ROTATION6D_HPP
/// Six numbers for a rotation: two of the three rows, or two of the three columns, of its matrix.
///
/// Source   Zhou et al., "On the continuity of rotation representations in neural networks" (CVPR 2019), section B.
/// Two conventions are in use and must not be mixed, hence two types: ACTOR, TEMOS, TEACH, SINC and the 205-vector take
/// the first two ROWS, row by row; the 263-vector of HumanML3D takes the first two COLUMNS, column by column.

namespace motionlang::inline MOTIONLANG_ABI {

template <class S>
struct Rotation6dRows {
  Vec3<S> a{}, b{};
};
template <class S>
struct Rotation6dColumns {
  Vec3<S> a{}, b{};
};

/// Gram-Schmidt: b1 = a / |a|, b2 = (b - (b1 . b) b1) normalised, b3 = b1 x b2; norms are floored at 1e-12.
template <class S>
Matrix3<S> to_matrix(const Rotation6dRows<S>& r) {
  const Vec3<S> b1 = normalized(r.a);
  const Vec3<S> b2 = normalized(r.b - dot(b1, r.b) * b1);
  return Matrix3<S>::from_rows(b1, b2, cross(b1, b2));
}
/// By cross products: x = a / |a|, z = x x b normalised, y = z x x. The same as Gram-Schmidt, up to rounding.
template <class S>
Matrix3<S> to_matrix(const Rotation6dColumns<S>& r) {
  const Vec3<S> x = normalized(r.a);
  const Vec3<S> z = normalized(cross(x, r.b));
  return Matrix3<S>::from_columns(x, cross(z, x), z);
}
template <Rotation R>
auto to_rotation6d_rows(const R& r) {
  const auto m = to_matrix(r);
  return Rotation6dRows<std::remove_cvref_t<decltype(m.m[0])>>{m.row(0), m.row(1)};
}
template <Rotation R>
auto to_rotation6d_columns(const R& r) {
  const auto m = to_matrix(r);
  return Rotation6dColumns<std::remove_cvref_t<decltype(m.m[0])>>{m.column(0), m.column(1)};
}
static_assert(Rotation<Rotation6dRows<double>> && Rotation<Rotation6dColumns<double>>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI::pytorch3d {

/// w = sqrt(max(0, 1 + m00 + m11 + m22)) / 2, ...; signs of x, y, z are those of the antisymmetric part (0 counts as
/// +).
template <class S>
Quaternion<S> matrix_to_quaternion(const Matrix3<S>& m) {
  const S zero = S(0), one = S(1);
  auto half_root = [&](const S& s) { return S(0.5) * sqrt(where_less(s, zero, zero, s)); };
  auto with_sign = [&](const S& size, const S& sign) { return where_less(sign, zero, -size, size); };
  return {half_root(one + m(0, 0) + m(1, 1) + m(2, 2)),
          with_sign(half_root(one + m(0, 0) - m(1, 1) - m(2, 2)), m(2, 1) - m(1, 2)),
          with_sign(half_root(one - m(0, 0) + m(1, 1) - m(2, 2)), m(0, 2) - m(2, 0)),
          with_sign(half_root(one - m(0, 0) - m(1, 1) + m(2, 2)), m(1, 0) - m(0, 1))};
}

/// v = (x, y, z) / (sin(h) / 2h), h = atan2(|(x, y, z)|, w); the divisor is 1/2 - (2h)^2/48 for |2h| < 1e-6.
template <class S>
Vec3<S> quaternion_to_axis_angle(const Quaternion<S>& q) {
  const S h = atan2(norm(q.vec()), q.w), angle = S(2) * h, size = where_less(angle, S(0), -angle, angle),
          small = S(1e-6);
  const S safe = where_less(size, small, S(1), angle);
  const S divisor = where_less(size, small, S(0.5) - angle * angle / S(48), sin(h) / safe);
  return {q.x / divisor, q.y / divisor, q.z / divisor};
}
template <class S>
Vec3<S> matrix_to_axis_angle(const Matrix3<S>& m) {
  return quaternion_to_axis_angle(matrix_to_quaternion(m));
}
/// The body models' formula: angle = |v + 1e-8|, axis = v / angle, R = I + sin K + (1 - cos) K^2.
template <class S>
Matrix3<S> rodrigues(const Vec3<S>& v) {
  const S e = S(1e-8), angle = norm(v + Vec3<S>{e, e, e}), s = sin(angle), c = S(1) - cos(angle);
  const Vec3<S> a{v.x / angle, v.y / angle, v.z / angle};
  const Matrix3<S> k{{S(0), -a.z, a.y, a.z, S(0), -a.x, -a.y, a.x, S(0)}}, kk = k * k;
  Matrix3<S> r = Matrix3<S>::identity();
  for (std::size_t i = 0; i < 9; ++i) r.m[i] = r.m[i] + s * k.m[i] + c * kk.m[i];
  return r;
}

}  // namespace motionlang::inline MOTIONLANG_ABI::pytorch3d
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_RIGID_HPP  // <motionlang/geometry/rigid.hpp>
#define MOTIONLANG_HAS_GEOMETRY_RIGID_HPP
/// Rotation and translation together.

namespace motionlang::inline MOTIONLANG_ABI {

/// x -> R x + t.
template <class S>
struct Rigid {
  Matrix3<S> rotation = Matrix3<S>::identity();
  Vec3<S> translation{};

  friend Rigid operator*(const Rigid& a, const Rigid& b) {
    return {a.rotation * b.rotation, a.rotation * b.translation + a.translation};
  }
  friend Vec3<S> operator*(const Rigid& a, const Vec3<S>& x) { return a.rotation * x + a.translation; }
};

template <class S>
Rigid<S> inverse(const Rigid<S>& a) {
  const Matrix3<S> r = transpose(a.rotation);
  return {r, -(r * a.translation)};
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_GEOMETRY_SLERP_HPP  // <motionlang/geometry/slerp.hpp>
#define MOTIONLANG_HAS_GEOMETRY_SLERP_HPP
/// Interpolation between rotations along the shortest arc.

#ifndef MOTIONLANG_HAS_GEOMETRY_SO3_HPP  // <motionlang/geometry/so3.hpp>
#define MOTIONLANG_HAS_GEOMETRY_SO3_HPP
/// What every rotation can do, whatever its representation: the API deduced from `to_matrix`.

namespace motionlang::inline MOTIONLANG_ABI {

/// a after b: the matrix A B.
template <Rotation A, Rotation B>
auto compose(const A& a, const B& b) {
  return to_matrix(a) * to_matrix(b);
}
template <Rotation R>
auto inverse(const R& r) {
  return transpose(to_matrix(r));
}
template <Rotation R, class S>
Vec3<S> rotate(const R& r, const Vec3<S>& v) {
  return to_matrix(r) * v;
}

/// Exponential: rotation vector to matrix (Rodrigues).
///     R = I + (sin t / t) K + ((1 - cos t) / t^2) K^2,   K = hat(v), t = |v|; series below t = 1e-2
template <class S>
Matrix3<S> exp_so3(const Vec3<S>& v) {
  const S t2 = dot(v, v), small = S(1e-4);
  const S safe = where_less(t2, small, small, t2), t = sqrt(safe);
  const S a = where_less(t2, small, S(1) - t2 * (S(1.0 / 6) - t2 * S(1.0 / 120)), sin(t) / t);
  const S b = where_less(t2, small, S(0.5) - t2 * (S(1.0 / 24) - t2 * S(1.0 / 720)), (S(1) - cos(t)) / safe);
  const S xy = b * v.x * v.y, xz = b * v.x * v.z, yz = b * v.y * v.z;
  const S xx = b * v.x * v.x, yy = b * v.y * v.y, zz = b * v.z * v.z;
  return {{S(1) - yy - zz, xy - a * v.z, xz + a * v.y,  //
           xy + a * v.z, S(1) - xx - zz, yz - a * v.x,  //
           xz - a * v.y, yz + a * v.x, S(1) - xx - yy}};
}
/// Logarithm: the shortest rotation vector. The inverse of exp_so3 for |v| <= pi (at pi up to the sign of the axis).
template <Rotation R>
auto log_so3(const R& r) {
  return to_axis_angle(r).v;
}

/// Angle between two rotations, radians in [0, pi].
template <Rotation A, Rotation B>
auto distance(const A& a, const B& b) {
  const auto q = to_quaternion(transpose(to_matrix(a)) * to_matrix(b));
  using S = std::remove_cvref_t<decltype(q.w)>;
  const S n2 = dot(q.vec(), q.vec());
  return S(2) * atan2(sqrt(n2), where_less(q.w, S(0), -q.w, q.w));
}

/// The shortest rotation that turns direction `from` into direction `to`. For opposite directions: half a turn about
/// some orthogonal axis.
template <class S>
Quaternion<S> rotation_between(const Vec3<S>& from, const Vec3<S>& to) {
  const Vec3<S> a = normalized(from), b = normalized(to), c = cross(a, b);
  const S w = S(1) + dot(a, b), ax = where_less(a.x, S(0), -a.x, a.x), limit = S(0.6);
  // an axis orthogonal to a: cross with x or with y, whichever is farther from a
  const Vec3<S> with_x = cross(a, Vec3<S>{S(1), S(0), S(0)}), with_y = cross(a, Vec3<S>{S(0), S(1), S(0)});
  auto pick = [&](const S& near, const S& far) { return where_less(ax, limit, near, far); };
  const Vec3<S> any{pick(with_x.x, with_y.x), pick(with_x.y, with_y.y), pick(with_x.z, with_y.z)};
  const S tiny = S(1e-7);
  return normalized(Quaternion<S>{where_less(w, tiny, S(0), w), where_less(w, tiny, any.x, c.x),
                                  where_less(w, tiny, any.y, c.y), where_less(w, tiny, any.z, c.z)});
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Spherical linear interpolation: a at t = 0, b at t = 1, constant angular velocity in between.
///     slerp = (sin((1-t) h) a + sin(t h) b) / sin h,   h = angle between the quaternions (shorter arc)
/// Source  Shoemake, "Animating rotation with quaternion curves" (SIGGRAPH 1985). Below h = 1e-3 a normalised lerp.
template <class S>
Quaternion<S> slerp(const Quaternion<S>& a, const Quaternion<S>& other, const S& t) {
  const S d = dot(a, other), sign = where_less(d, S(0), S(-1), S(1));
  const Quaternion<S> b = sign * other;
  const Quaternion<S> chord = b + (S(-1)) * a, sum = b + a;
  const S half = atan2(sqrt(dot(chord, chord)), sqrt(dot(sum, sum)));  // exact for small and large angles
  const S h = S(2) * half, limit = S(1e-3), safe = where_less(h, limit, S(1), h);
  const S wa = where_less(h, limit, S(1) - t, sin((S(1) - t) * safe) / sin(safe));
  const S wb = where_less(h, limit, t, sin(t * safe) / sin(safe));
  return normalized(wa * a + wb * b);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_BACKEND_AUTODIFF_HPP  // <motionlang/backend/autodiff.hpp>
#define MOTIONLANG_HAS_BACKEND_AUTODIFF_HPP
/// Autodiff<B>: a backend that computes with B and remembers how, so that `backward` gives gradients (reverse mode).
///
/// Each operation below stands next to its derivative (vjp: vector-Jacobian product): g is the gradient of the result,
/// the answer is the gradient of each operand. The graph hangs off the tensors; there is no global tape. A closure
/// keeps only the tensors that its derivative needs, and `backward` frees them as it goes: a graph can be walked once.
/// Gradients are returned as a value and live on the inner backend.
///
/// Threads may differentiate losses over the same variables at once: a walk writes only to the operations behind its
/// own loss. Losses that share operations belong to one thread.

#include <unordered_map>  // gradients by variable

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B>
struct Autodiff {
  using inner = B;
  using scalar = typename B::scalar;
  using Value = typename B::tensor;

  class Node;
  struct tensor {
    Value value{};
    std::shared_ptr<Node> node{};  // none for constants
  };

  using GradientMap = std::unordered_map<const Node*, Value>;

  /// Collects the gradients of a node's operands.
  class Sink {
   public:
    /// Operands that are constants need no gradient: skip the work.
    bool needs(std::size_t i) const { return node_->inputs[i] != nullptr; }
    void add(std::size_t i, Value g) const {
      if (!needs(i)) return;
      const Node* input = node_->inputs[i].get();
      if (input->variable) {
        const auto [slot, first] = variables_->try_emplace(input);
        slot->second = first ? std::move(g) : B::add(std::move(slot->second), std::move(g));
        return;
      }
      auto& slot = (*gradients_)[static_cast<std::size_t>(input->order)];
      slot.second = slot.first ? B::add(std::move(slot.second), std::move(g)) : std::move(g);
      slot.first = true;
    }

   private:
    friend struct Autodiff;
    const Node* node_ = nullptr;
    std::vector<std::pair<bool, Value>>* gradients_ = nullptr;  // of operations, by their order
    GradientMap* variables_ = nullptr;
  };

  /// One operation of the graph, or a variable (no inputs, no vjp).
  class Node {
   public:
    std::vector<std::shared_ptr<Node>> inputs;
    Index order = -1;  // of an operation: its place in the walk that is going on
    bool variable = true;

    Node() = default;
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;
    virtual ~Node() { release_inputs(); }
    virtual void vjp(const Value&, const Sink&) const {}
    virtual void forget() {}  // drops what the vjp keeps
    virtual bool forgotten() const { return false; }

    /// Without recursion: a chain of two million operations must not overflow the stack.
    void release_inputs() {
      std::vector<std::shared_ptr<Node>> waiting = std::move(inputs);
      while (!waiting.empty()) {
        std::shared_ptr<Node> last = std::move(waiting.back());
        waiting.pop_back();
        if (last != nullptr && last.use_count() == 1) {
          for (auto& i : last->inputs) waiting.push_back(std::move(i));
          last->inputs.clear();
        }
      }
    }
  };

  static tensor variable(Value value) { return {std::move(value), std::make_shared<Node>()}; }
  static const Value& value(const tensor& a) { return a.value; }
  static Value& mutable_value(tensor& a) { return a.value; }  // for optimisers: the variable stays the same leaf

  // Data.

  static tensor full(const Shape& s, scalar v) { return {B::full(s, v), nullptr}; }
  static tensor from_span(std::span<const scalar> values, const Shape& s) { return {B::from_span(values, s), nullptr}; }
  static auto to_span(const tensor& a) { return B::to_span(a.value); }
  static Shape shape(const tensor& a) { return B::shape(a.value); }

  // Elementwise, broadcasting.

  static tensor add(const tensor& a, const tensor& b) {
    return record(
        B::add(a.value, b.value),
        [sa = shape(a), sb = shape(b)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(g, sa));
          if (s.needs(1)) s.add(1, unbroadcast(g, sb));
        },
        a, b);
  }
  static tensor sub(const tensor& a, const tensor& b) {
    return record(
        B::sub(a.value, b.value),
        [sa = shape(a), sb = shape(b)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(g, sa));
          if (s.needs(1)) s.add(1, unbroadcast(times(g, -1), sb));
        },
        a, b);
  }
  static tensor mul(const tensor& a, const tensor& b) {
    return record(
        B::mul(a.value, b.value),
        [x = a.value, y = b.value](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::mul(g, y), B::shape(x)));
          if (s.needs(1)) s.add(1, unbroadcast(B::mul(g, x), B::shape(y)));
        },
        a, b);
  }
  static tensor div(const tensor& a, const tensor& b) {
    Value q = B::div(a.value, b.value);
    return record(
        q,
        [q, y = b.value, sa = shape(a)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::div(g, y), sa));
          if (s.needs(1)) s.add(1, unbroadcast(times(B::div(B::mul(g, q), y), -1), B::shape(y)));
        },
        a, b);
  }
  static tensor maximum(const tensor& a, const tensor& b) {  // at equal values the first takes the gradient
    return record(
        B::maximum(a.value, b.value),
        [x = a.value, y = b.value](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::where_less(x, y, zero_like(g), g), B::shape(x)));
          if (s.needs(1)) s.add(1, unbroadcast(B::where_less(x, y, g, zero_like(g)), B::shape(y)));
        },
        a, b);
  }
  static tensor atan2(const tensor& a, const tensor& b) {  // d atan2(y, x) = (x dy - y dx) / (x^2 + y^2)
    return record(
        B::atan2(a.value, b.value),
        [y = a.value, x = b.value](const Value& g, const Sink& s) {
          const Value h = B::div(g, B::add(B::mul(x, x), B::mul(y, y)));
          if (s.needs(0)) s.add(0, unbroadcast(B::mul(h, x), B::shape(y)));
          if (s.needs(1)) s.add(1, unbroadcast(times(B::mul(h, y), -1), B::shape(x)));
        },
        a, b);
  }
  static tensor exp(const tensor& a) {
    Value y = B::exp(a.value);
    return record(
        y, [y](const Value& g, const Sink& s) { s.add(0, B::mul(g, y)); }, a);
  }
  static tensor log(const tensor& a) {
    return record(
        B::log(a.value), [x = a.value](const Value& g, const Sink& s) { s.add(0, B::div(g, x)); }, a);
  }
  static tensor sqrt(const tensor& a) {
    Value y = B::sqrt(a.value);
    return record(
        y, [y](const Value& g, const Sink& s) { s.add(0, times(B::div(g, y), 0.5)); }, a);
  }
  static tensor tanh(const tensor& a) {
    Value y = B::tanh(a.value);
    return record(
        y, [y](const Value& g, const Sink& s) { s.add(0, B::sub(g, B::mul(g, B::mul(y, y)))); }, a);
  }
  static tensor erf(const tensor& a) {  // 2 / sqrt(pi) exp(-x^2)
    return record(
        B::erf(a.value),
        [x = a.value](const Value& g, const Sink& s) {
          s.add(0, times(B::mul(g, B::exp(times(B::mul(x, x), -1))), 1.1283791670955126));
        },
        a);
  }
  static tensor sin(const tensor& a) {
    return record(
        B::sin(a.value), [x = a.value](const Value& g, const Sink& s) { s.add(0, B::mul(g, B::cos(x))); }, a);
  }
  static tensor cos(const tensor& a) {
    return record(
        B::cos(a.value), [x = a.value](const Value& g, const Sink& s) { s.add(0, times(B::mul(g, B::sin(x)), -1)); },
        a);
  }
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x,
                           const tensor& y) {  // a and b get no gradient
    return record(
        B::where_less(a.value, b.value, x.value, y.value),
        [a = a.value, b = b.value, sx = shape(x), sy = shape(y)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::where_less(a, b, g, zero_like(g)), sx));
          if (s.needs(1)) s.add(1, unbroadcast(B::where_less(a, b, zero_like(g), g), sy));
        },
        x, y);
  }

  // Reductions.

  static tensor sum(const tensor& a, int axis) {
    return record(
        B::sum(a.value, axis), [sa = shape(a), axis](const Value& g, const Sink& s) { s.add(0, along(g, sa, axis)); },
        a);
  }
  static tensor max(const tensor& a, int axis) {  // every element that attains the maximum takes the whole gradient
    Value y = B::max(a.value, axis);
    return record(
        y,
        [x = a.value, y, axis](const Value& g, const Sink& s) {
          s.add(0, B::where_less(x, along(y, B::shape(x), axis), zero_like(x), along(g, B::shape(x), axis)));
        },
        a);
  }

  // Product.

  static tensor matmul(const tensor& a, const tensor& b, bool ta, bool tb) {
    return record(
        B::matmul(a.value, b.value, ta, tb),
        [x = a.value, y = b.value, ta, tb](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, ta ? B::matmul(y, g, tb, true) : B::matmul(g, y, false, !tb));
          if (s.needs(1)) s.add(1, tb ? B::matmul(g, x, true, ta) : B::matmul(x, g, !ta, false));
        },
        a, b);
  }

  // Movement.

  static tensor reshape(const tensor& a, const Shape& to) {
    return record(
        B::reshape(a.value, to), [sa = shape(a)](const Value& g, const Sink& s) { s.add(0, B::reshape(g, sa)); }, a);
  }
  static tensor permute(const tensor& a, std::span<const int> axes) {
    std::vector<int> back(axes.size());
    for (std::size_t i = 0; i < axes.size(); ++i) back[static_cast<std::size_t>(axes[i])] = static_cast<int>(i);
    return record(
        B::permute(a.value, axes),
        [back](const Value& g, const Sink& s) { s.add(0, B::permute(g, std::span<const int>(back))); }, a);
  }
  static tensor broadcast(const tensor& a, const Shape& to) {
    return record(
        B::broadcast(a.value, to), [sa = shape(a)](const Value& g, const Sink& s) { s.add(0, unbroadcast(g, sa)); }, a);
  }
  static tensor slice(const tensor& a, int axis, Index first, Index last) {
    return record(
        B::slice(a.value, axis, first, last),
        [sa = shape(a), axis, first, last](const Value& g, const Sink& s) {
          auto zeros = [&](Index n) {
            Shape z = sa;
            z[axis] = n;
            return B::full(z, scalar(0));
          };
          const std::vector<Value> parts{zeros(first), g, zeros(sa[axis] - last)};
          s.add(0, B::concat(std::span<const Value>(parts), axis));
        },
        a);
  }
  static tensor concat(std::span<const tensor> list, int axis) {
    std::vector<Value> values;
    std::vector<Index> ends{0};
    for (const tensor& t : list) {
      values.push_back(t.value);
      ends.push_back(ends.back() + shape(t)[axis]);
    }
    return record_list(
        B::concat(std::span<const Value>(values), axis),
        [ends, axis](const Value& g, const Sink& s) {
          for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
            if (s.needs(i)) s.add(i, B::slice(g, axis, ends[i], ends[i + 1]));
          }
        },
        list);
  }
  static tensor gather(const tensor& a, std::span<const Index> rows) {
    return record(
        B::gather(a.value, rows),
        [rows = std::vector<Index>(rows.begin(), rows.end()), n = shape(a)[0]](const Value& g, const Sink& s) {
          s.add(0, B::scatter_add(g, rows, n));
        },
        a);
  }
  static tensor scatter_add(const tensor& a, std::span<const Index> rows, Index n) {
    return record(
        B::scatter_add(a.value, rows, n),
        [rows = std::vector<Index>(rows.begin(), rows.end())](const Value& g, const Sink& s) {
          s.add(0, B::gather(g, rows));
        },
        a);
  }

  // Fused operations, where the inner backend has their kernels.

  static tensor activate(const tensor& a, Activation act) requires requires(const Value& v) {
    B::activate_vjp(v, v, act);
  }
  {
    return record(
        B::activate(a.value, act),
        [x = a.value, act](const Value& g, const Sink& s) { s.add(0, B::activate_vjp(x, g, act)); }, a);
  }
  static tensor linear(const tensor& x, const tensor& weight, const tensor* bias, Activation act,
                       const tensor* residual) requires requires(const Value& v) {
    B::linear(v, v, &v, act, &v);
    B::column_sums(v);
  }
  {
    if (act != Activation::none) {  // the nonlinearity needs its own input for the derivative
      const tensor y = activate(linear(x, weight, bias, Activation::none, nullptr), act);
      return residual == nullptr ? y : add(y, *residual);
    }
    const tensor none{};
    return record(
        B::linear(x.value, weight.value, bias == nullptr ? nullptr : &bias->value, act,
                  residual == nullptr ? nullptr : &residual->value),
        [x = x.value, w = weight.value](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, B::matmul(g, w, false, false));
          if (s.needs(1)) s.add(1, B::matmul(g, x, true, false));
          if (s.needs(2)) s.add(2, B::column_sums(g));
          if (s.needs(3)) s.add(3, g);
        },
        x, weight, bias == nullptr ? none : *bias, residual == nullptr ? none : *residual);
  }
  static tensor layer_norm(const tensor& x, const tensor& weight, const tensor& bias, double eps) requires
      requires(const Value& v) {
    B::layer_norm_vjp(v, v, eps, v);
  }
  {
    return record(
        B::layer_norm(x.value, weight.value, bias.value, eps),
        [x = x.value, w = weight.value, eps](const Value& g, const Sink& s) {
          auto [dx, dweight, dbias] = B::layer_norm_vjp(x, w, eps, g);
          s.add(0, std::move(dx));
          s.add(1, std::move(dweight));
          s.add(2, std::move(dbias));
        },
        x, weight, bias);
  }
  static tensor softmax(const tensor& x)  // dx = y (g - sum(g y))
      requires requires(const Value& v) {
    B::softmax(v);
  }
  {
    Value y = B::softmax(x.value);
    return record(
        y,
        [y](const Value& g, const Sink& s) {
          const Value gy = B::mul(g, y);
          s.add(0, B::sub(gy, B::mul(y, along(B::sum(gy, 1), B::shape(y), 1))));
        },
        x);
  }
  static tensor dropout(const tensor& x, const Dropout& d) requires requires(const Value& v) { B::dropout(v, d); }
  {
    return record(
        B::dropout(x.value, d), [d](const Value& g, const Sink& s) { s.add(0, B::dropout(g, d)); }, x);
  }
  static tensor self_attention(const tensor& qkv, const Offsets& offsets, const AttentionOptions& options) requires
      requires(const Value& v) {
    B::self_attention_vjp(v, offsets, options, v);
  }
  {
    return record(
        B::self_attention(qkv.value, offsets, options),
        [x = qkv.value, offsets, options](const Value& g, const Sink& s) {
          s.add(0, B::self_attention_vjp(x, offsets, options, g));
        },
        qkv);
  }
  static tensor attention(const tensor& q, const tensor& k, const tensor& v, const Offsets& q_offsets,
                          const Offsets& k_offsets, const AttentionOptions& options) requires requires(const Value& x) {
    B::attention_vjp(x, x, x, q_offsets, k_offsets, options, x);
  }
  {
    return record(
        B::attention(q.value, k.value, v.value, q_offsets, k_offsets, options),
        [q = q.value, k = k.value, v = v.value, q_offsets, k_offsets, options](const Value& g, const Sink& s) {
          auto [dq, dk, dv] = B::attention_vjp(q, k, v, q_offsets, k_offsets, options, g);
          s.add(0, std::move(dq));
          s.add(1, std::move(dk));
          s.add(2, std::move(dv));
        },
        q, k, v);
  }

  // The walk.

  /// Gradients of a number with respect to all variables that it depends on. Frees the graph behind it. Throws
  /// config_error 102 if the graph has been walked before.
  static GradientMap gradients(const tensor& loss) {
    GradientMap result;
    if (loss.node == nullptr) return result;
    Value one = B::full(B::shape(loss.value), scalar(1));
    if (loss.node->variable) {
      result.emplace(loss.node.get(), std::move(one));
      return result;
    }
    // Operations in an order in which operands come first: depth-first search with an explicit stack.
    std::vector<Node*> sorted;
    std::vector<std::pair<Node*, std::size_t>> path{{loss.node.get(), 0}};
    loss.node->order = -2;  // on the path
    while (!path.empty()) {
      Node* node = path.back().first;
      if (node->forgotten()) {
        for (Node* n : sorted) n->order = -1;
        for (auto& [n, next] : path) n->order = -1;
        raise<config_error>(102, "backward: this graph has been walked already; compute the loss again");
      }
      if (path.back().second < node->inputs.size()) {
        Node* input = node->inputs[path.back().second++].get();
        if (input != nullptr && !input->variable && input->order == -1) {
          input->order = -2;
          path.emplace_back(input, 0);
        }
      } else {
        node->order = static_cast<Index>(sorted.size());
        sorted.push_back(node);
        path.pop_back();
      }
    }
    std::vector<std::pair<bool, Value>> gradient(sorted.size());
    gradient.back() = {true, std::move(one)};
    Sink sink;
    sink.gradients_ = &gradient;
    sink.variables_ = &result;
    for (std::size_t i = sorted.size(); i-- > 0;) {
      Node* node = sorted[i];
      auto [known, g] = std::move(gradient[i]);
      gradient[i] = {};
      sink.node_ = node;
      if (known) node->vjp(g, sink);
      node->forget();
    }
    for (Node* node : sorted) node->order = -1;
    return result;
  }

 private:
  template <class F>
  class Operation final : public Node {
   public:
    explicit Operation(F f) : f_(std::move(f)) { this->variable = false; }
    void vjp(const Value& g, const Sink& s) const override { (*f_)(g, s); }
    void forget() override { f_.reset(); }
    bool forgotten() const override { return !f_.has_value(); }

   private:
    std::optional<F> f_;
  };

  template <class F, class... T>
  static tensor record(Value value, F vjp, const T&... operands) {
    if (((operands.node == nullptr) && ...)) return {std::move(value), nullptr};
    auto node = std::make_shared<Operation<F>>(std::move(vjp));
    node->inputs = {operands.node...};
    return {std::move(value), std::move(node)};
  }
  template <class F>
  static tensor record_list(Value value, F vjp, std::span<const tensor> operands) {
    auto node = std::make_shared<Operation<F>>(std::move(vjp));
    bool any = false;
    for (const tensor& t : operands) {
      node->inputs.push_back(t.node);
      any = any || t.node != nullptr;
    }
    return any ? tensor{std::move(value), std::move(node)} : tensor{std::move(value), nullptr};
  }

  static Value times(const Value& a, double c) { return B::mul(a, B::full(Shape{}, static_cast<scalar>(c))); }
  static Value zero_like(const Value& a) { return B::full(B::shape(a), scalar(0)); }

  /// The adjoint of broadcasting: sums over the axes that were repeated.
  static Value unbroadcast(const Value& g, const Shape& to) {
    if (B::shape(g) == to) return g;
    Value sum = g;
    while (B::shape(sum).rank() > to.rank()) sum = B::sum(sum, 0);
    for (int axis = 0; axis < to.rank(); ++axis) {
      if (to[axis] == 1 && B::shape(sum)[axis] != 1) {
        Shape kept = B::shape(sum);
        kept[axis] = 1;
        sum = B::reshape(B::sum(sum, axis), kept);
      }
    }
    return sum;
  }
  /// The adjoint of a sum: repeats g along the axis that disappeared.
  static Value along(const Value& g, const Shape& to, int axis) {
    Shape kept = to;
    kept[axis] = 1;
    return B::broadcast(B::reshape(g, kept), to);
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_BACKEND_REFERENCE_HPP  // <motionlang/backend/reference.hpp>
#define MOTIONLANG_HAS_BACKEND_REFERENCE_HPP
/// The definition of every primitive, in plain loops. Slow, readable, and what the other backends are tested against.
///
/// Read this file to know what an operation means; read eigen.hpp or detail/kernels.hpp to see how it is made fast.

#include <limits>  // infinity

#ifndef MOTIONLANG_HAS_BACKEND_DENSE_OPS_HPP  // <motionlang/backend/dense_ops.hpp>
#define MOTIONLANG_HAS_BACKEND_DENSE_OPS_HPP
/// What all backends over Dense storage share: making tensors, and moving numbers without calculating.

#ifndef MOTIONLANG_HAS_BACKEND_DENSE_HPP  // <motionlang/backend/dense.hpp>
#define MOTIONLANG_HAS_BACKEND_DENSE_HPP
/// Dense row-major storage: the tensor type of the reference, Eigen and xtensor backends.
///
/// A handle to a shared buffer plus a shape. Copying shares memory; whoever wants to write asks `unique()` first.
/// Always contiguous: reshaping and taking leading rows are views, everything else copies.

namespace motionlang::inline MOTIONLANG_ABI {

template <Scalar S>
class Dense {
 public:
  /// Nothing yet: an empty list.
  Dense() = default;
  /// Uninitialised.
  explicit Dense(const Shape& shape) : buffer_(static_cast<std::size_t>(shape.count()) * sizeof(S)), shape_(shape) {}
  /// Numbers that somebody else owns and nobody writes (a mapped file).
  Dense(const S* values, const Shape& shape, std::shared_ptr<const void> owner)
      : buffer_(values, std::move(owner)), shape_(shape) {}

  static Dense full(const Shape& shape, S value) {
    Dense d(shape);
    std::fill_n(d.data(), d.count(), value);
    return d;
  }
  static Dense from_span(std::span<const S> values, const Shape& shape) {
    Dense d(shape);
    std::copy(values.begin(), values.end(), d.data());
    return d;
  }

  const Shape& shape() const { return shape_; }
  Index count() const { return shape_.count(); }
  const S* data() const { return static_cast<const S*>(buffer_.data()) + offset_; }
  /// For writing: only right after construction or when `unique()`.
  S* data() { return static_cast<S*>(buffer_.data()) + offset_; }
  std::span<const S> span() const { return {data(), static_cast<std::size_t>(count())}; }
  bool defined() const { return static_cast<bool>(buffer_); }

  /// Nobody else can see the numbers, so an operation may overwrite them.
  bool unique() const { return buffer_.unique() && !buffer_.packed(); }

  /// The same numbers in another shape of the same count.
  Dense reshaped(const Shape& shape) const {
    Dense d(*this);
    d.shape_ = shape;
    return d;
  }
  /// Leading indices first ... last-1, without copying.
  Dense rows(Index first, Index last) const {
    Dense d(*this);
    d.offset_ += first * shape_.count(1, shape_.rank());
    d.shape_[0] = last - first;
    return d;
  }

  /// Attaches the same numbers in the layout of a kernel. They live and die with the buffer.
  void attach(std::shared_ptr<const void> packed) const { buffer_.packed() = std::move(packed); }
  const void* attached() const { return buffer_ && offset_ == 0 ? buffer_.packed().get() : nullptr; }

 private:
  detail::BufferHandle buffer_;
  Shape shape_{0};
  Index offset_ = 0;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

template <Scalar S>
struct DenseOps {
  using scalar = S;
  using tensor = Dense<S>;

  static tensor full(const Shape& shape, S value) { return tensor::full(shape, value); }
  static tensor from_span(std::span<const S> values, const Shape& shape) { return tensor::from_span(values, shape); }
  static std::span<const S> to_span(const tensor& a) { return a.span(); }
  static const Shape& shape(const tensor& a) { return a.shape(); }

  static tensor reshape(const tensor& a, const Shape& s) { return a.reshaped(s); }

  // out[i_axes[0], i_axes[1], ...] = a[i_0, i_1, ...]
  static tensor permute(const tensor& a, std::span<const int> axes) {
    Shape s;
    std::array<Index, Shape::max_rank> stride{};
    const auto strides = strides_of(a.shape());
    for (std::size_t i = 0; i < axes.size(); ++i) {
      s.push_back(a.shape()[axes[i]]);
      stride[i] = strides[static_cast<std::size_t>(axes[i])];
    }
    return strided_copy(a, s, stride);
  }
  // sizes of 1 (and missing leading axes) are repeated
  static tensor broadcast(const tensor& a, const Shape& s) {
    return a.shape() == s ? a : strided_copy(a, s, broadcast_strides(a.shape(), s));
  }
  // a[..., first:last, ...]
  static tensor slice(const tensor& a, int axis, Index first, Index last) {
    if (axis == 0) return a.rows(first, last);
    Shape s = a.shape();
    s[axis] = last - first;
    tensor out(s);
    const Index outer = s.count(0, axis), inner = s.count(axis + 1, s.rank()), size = a.shape()[axis];
    for (Index i = 0; i < outer; ++i) {
      copy(a.data() + (i * size + first) * inner, (last - first) * inner, out.data() + i * (last - first) * inner);
    }
    return out;
  }
  static tensor concat(std::span<const tensor> list, int axis) {
    Shape s = list.front().shape();
    s[axis] = 0;
    for (const tensor& t : list) s[axis] += t.shape()[axis];
    tensor out(s);
    const Index outer = s.count(0, axis), inner = s.count(axis + 1, s.rank());
    Index at = 0;
    for (const tensor& t : list) {
      const Index n = t.shape()[axis] * inner;
      for (Index i = 0; i < outer; ++i) copy(t.data() + i * n, n, out.data() + i * s[axis] * inner + at);
      at += n;
    }
    return out;
  }
  // out[i] = a[rows[i]]
  static tensor gather(const tensor& a, std::span<const Index> rows) {
    Shape s = a.shape();
    const Index inner = s.count(1, s.rank());
    s[0] = static_cast<Index>(rows.size());
    tensor out(s);
    for (std::size_t i = 0; i < rows.size(); ++i)
      copy(a.data() + rows[i] * inner, inner, out.data() + static_cast<Index>(i) * inner);
    return out;
  }
  // out[rows[i]] += a[i], starting from n rows of zeros; in the order of i
  static tensor scatter_add(const tensor& a, std::span<const Index> rows, Index n) {
    Shape s = a.shape();
    const Index inner = s.count(1, s.rank());
    s[0] = n;
    tensor out = full(s, S(0));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const S* from = a.data() + static_cast<Index>(i) * inner;
      S* to = out.data() + rows[i] * inner;
      for (Index j = 0; j < inner; ++j) to[j] += from[j];
    }
    return out;
  }

 protected:
  using Strides = std::array<Index, Shape::max_rank>;

  static void copy(const S* from, Index n, S* to) {
    if (n > 0) std::memcpy(to, from, static_cast<std::size_t>(n) * sizeof(S));
  }
  static Strides strides_of(const Shape& s) {
    Strides stride{};
    Index n = 1;
    for (int i = s.rank() - 1; i >= 0; --i) {
      stride[static_cast<std::size_t>(i)] = n;
      n *= s[i];
    }
    return stride;
  }
  /// Strides that read a tensor of shape `from` as if it had shape `to`: 0 along repeated axes.
  static Strides broadcast_strides(const Shape& from, const Shape& to) {
    const Strides own = strides_of(from);
    Strides stride{};
    for (int i = 0; i < to.rank(); ++i) {
      const int j = i - (to.rank() - from.rank());
      if (j >= 0 && from[j] != 1) stride[static_cast<std::size_t>(i)] = own[static_cast<std::size_t>(j)];
    }
    return stride;
  }
  /// Calls f(position in the output, offset in the input) for every element of `s`, the last axis fastest.
  template <class F>
  static void for_each(const Shape& s, const Strides& stride, F f) {
    std::array<Index, Shape::max_rank> at{};
    Index offset = 0;
    for (Index i = 0, n = s.count(); i < n; ++i) {
      f(i, offset);
      for (int axis = s.rank() - 1; axis >= 0; --axis) {
        const auto x = static_cast<std::size_t>(axis);
        offset += stride[x];
        if (++at[x] < s[axis]) break;
        offset -= at[x] * stride[x];
        at[x] = 0;
      }
    }
  }
  static tensor strided_copy(const tensor& a, const Shape& s, const Strides& stride) {
    tensor out(s);
    for_each(s, stride, [&, from = a.data(), to = out.data()](Index i, Index offset) { to[i] = from[offset]; });
    return out;
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

template <Scalar S>
struct ReferenceBackend : DenseOps<S> {
  using tensor = Dense<S>;

  // Binary operations broadcast: out[i] = f(a[i], b[i]), sizes of 1 are repeated.
  static tensor add(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x + y; });
  }
  static tensor sub(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x - y; });
  }
  static tensor mul(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x * y; });
  }
  static tensor div(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x / y; });
  }
  static tensor maximum(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return x < y ? y : x; });
  }
  static tensor atan2(const tensor& a, const tensor& b) {
    return binary(a, b, [](S x, S y) { return std::atan2(x, y); });
  }

  static tensor exp(const tensor& a) {
    return unary(a, [](S x) { return std::exp(x); });
  }
  static tensor log(const tensor& a) {
    return unary(a, [](S x) { return std::log(x); });
  }
  static tensor sqrt(const tensor& a) {
    return unary(a, [](S x) { return std::sqrt(x); });
  }
  static tensor tanh(const tensor& a) {
    return unary(a, [](S x) { return std::tanh(x); });
  }
  static tensor erf(const tensor& a) {
    return unary(a, [](S x) { return std::erf(x); });
  }
  static tensor sin(const tensor& a) {
    return unary(a, [](S x) { return std::sin(x); });
  }
  static tensor cos(const tensor& a) {
    return unary(a, [](S x) { return std::cos(x); });
  }

  // out[i] = a[i] < b[i] ? x[i] : y[i]
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
    Shape s = a.shape();
    for (const tensor* t : {&b, &x, &y}) s = broadcast_shapes(s, t->shape(), "where_less");
    const tensor ba = DenseOps<S>::broadcast(a, s), bb = DenseOps<S>::broadcast(b, s);
    const tensor bx = DenseOps<S>::broadcast(x, s), by = DenseOps<S>::broadcast(y, s);
    tensor out(s);
    S* to = out.data();
    for (Index i = 0; i < s.count(); ++i) to[i] = ba.data()[i] < bb.data()[i] ? bx.data()[i] : by.data()[i];
    return out;
  }

  // a is (outer, n, inner) -> out (outer, inner); summed in order, an empty axis gives 0
  static tensor sum(const tensor& a, int axis) {
    return reduce(a, axis, S(0), [](S total, S x) { return total + x; });
  }
  // the largest along the axis; an empty axis gives -infinity
  static tensor max(const tensor& a, int axis) {
    return reduce(a, axis, -std::numeric_limits<S>::infinity(),
                  [](S largest, S x) { return largest < x ? x : largest; });
  }

  // a is (..., m, k), or (..., k, m) when transpose_a; b is (..., k, n), or (..., n, k) when transpose_b -> (..., m, n)
  static tensor matmul(const tensor& a, const tensor& b, bool transpose_a, bool transpose_b) {
    const int r = a.shape().rank();
    const Index m = a.shape()[r - (transpose_a ? 1 : 2)], k = a.shape()[r - (transpose_a ? 2 : 1)];
    const Index n = b.shape()[r - (transpose_b ? 2 : 1)];
    Shape s = a.shape();
    s[r - 2] = m;
    s[r - 1] = n;
    tensor out(s);
    const S *pa = a.data(), *pb = b.data();
    S* to = out.data();
    for (Index batch = 0; batch < s.count(0, r - 2); ++batch, pa += m * k, pb += k * n, to += m * n) {
      for (Index i = 0; i < m; ++i) {
        for (Index j = 0; j < n; ++j) {
          S total = 0;
          for (Index l = 0; l < k; ++l)
            total += (transpose_a ? pa[l * m + i] : pa[i * k + l]) * (transpose_b ? pb[j * k + l] : pb[l * n + j]);
          to[i * n + j] = total;
        }
      }
    }
    return out;
  }

 private:
  template <class F>
  static tensor unary(const tensor& a, F f) {
    tensor out(a.shape());
    S* to = out.data();
    for (Index i = 0; i < a.count(); ++i) to[i] = f(a.data()[i]);
    return out;
  }
  template <class F>
  static tensor binary(const tensor& a, const tensor& b, F f) {
    const Shape s = broadcast_shapes(a.shape(), b.shape(), "binary operation");
    const tensor left = DenseOps<S>::broadcast(a, s), right = DenseOps<S>::broadcast(b, s);
    tensor out(s);
    S* to = out.data();
    for (Index i = 0; i < s.count(); ++i) to[i] = f(left.data()[i], right.data()[i]);
    return out;
  }
  template <class F>
  static tensor reduce(const tensor& a, int axis, S start, F f) {
    const Index outer = a.shape().count(0, axis), n = a.shape()[axis],
                inner = a.shape().count(axis + 1, a.shape().rank());
    tensor out = tensor::full(a.shape().without(axis), start);
    S* to = out.data();
    for (Index i = 0; i < outer; ++i) {
      for (Index l = 0; l < n; ++l) {
        for (Index j = 0; j < inner; ++j) to[i * inner + j] = f(to[i * inner + j], a.data()[(i * n + l) * inner + j]);
      }
    }
    return out;
  }
};
static_assert(Backend<ReferenceBackend<float>> && Backend<ReferenceBackend<double>>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_BLEND_HPP  // <motionlang/kinematics/blend.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BLEND_HPP
/// Blending clips: one into another, and the end of a clip into its start, so that it can be repeated for ever.
///
///     Motion both = blend_into(walk, run, 10);      // half a second at 20 frames per second
///     Motion cycle = make_loop(in_place(walk), 8).motion;

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_HPP  // <motionlang/kinematics/motion_tools.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_HPP
/// Editing clips: crop, resample, change speed, join, mirror, and take away the T-pose at the start of CMU files. Pure
/// functions; the clip that is passed stays as it is.

#include <iterator>   // begin

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_HPP  // <motionlang/kinematics/motion.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_HPP
/// A clip of motion: a skeleton, a frame rate, and for each frame the root position and all local rotations.
///
/// Inside the library every clip is Y up, right-handed, in metres, and a rest pose faces +Z. Readers and writers
/// convert at the edge (BVH files in centimetres, AMASS with Z up, ...). Double precision: files and features are exact
/// to the last printed digit.

#ifndef MOTIONLANG_HAS_KINEMATICS_FORWARD_HPP  // <motionlang/kinematics/forward.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FORWARD_HPP
/// Forward kinematics: from local rotations to joint positions. One function for a single pose (S = float, double), for
/// derivatives (Dual), for eight poses in a register (Lane) and for a differentiable batch (Tensor; see lanes.hpp).
///
///     R_j = R_parent(j) L_j,   p_j = p_parent(j) + R_parent(j) offset_j,   R_0 = L_0, p_0 = root

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_HPP  // <motionlang/kinematics/skeleton.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_HPP
/// A kinematic tree: names, parents and rest offsets of joints, depth first.
///
/// Established here and relied upon everywhere: parents[0] = -1, 0 <= parents[j] < j, names are unique. Algorithms over
/// a skeleton are therefore one loop over j in which the parent has been visited already.

namespace motionlang::inline MOTIONLANG_ABI {

/// One joint as it is written down: its parent by name ("" for the root) and its rest position relative to the parent,
/// metres.
struct Joint {
  std::string name;
  std::string parent;
  Vec3<double> offset;
};

struct Skeleton {
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<Vec3<double>> offsets;

  /// From joints in an order in which parents come first. Throws config_error 106.
  static Skeleton from_joints(std::span<const Joint> joints) {
    Skeleton s;
    for (const Joint& j : joints) {
      const int parent = j.parent.empty() ? -1 : s.find(j.parent);
      if (!j.parent.empty() && parent < 0) {
        raise<config_error>(106, "Skeleton: parent '", j.parent, "' of '", j.name, "' does not come before it");
      }
      s.names.push_back(j.name);
      s.parents.push_back(parent);
      s.offsets.push_back(j.offset);
    }
    s.validate();
    return s;
  }
  static Skeleton from_joints(std::initializer_list<Joint> joints) {
    return from_joints(std::span<const Joint>(joints.begin(), joints.size()));
  }
  /// From arrays. Throws config_error 106.
  static Skeleton from_arrays(std::vector<std::string> names, std::vector<int> parents,
                              std::vector<Vec3<double>> offsets) {
    Skeleton s{std::move(names), std::move(parents), std::move(offsets)};
    s.validate();
    return s;
  }

  int size() const { return static_cast<int>(parents.size()); }

  /// Number of a joint, or -1.
  int find(std::string_view name) const {
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (names[j] == name) return static_cast<int>(j);
    }
    return -1;
  }
  /// Number of a joint. Throws config_error 103.
  int operator[](std::string_view name) const {
    const int j = find(name);
    if (j < 0)
      raise<config_error>(103, "Skeleton: no joint '", name, "' among ", size(), " joints (root '", names.front(),
                          "')");
    return j;
  }

  int parent(int joint) const { return parents[static_cast<std::size_t>(joint)]; }
  const std::string& name(int joint) const { return names[static_cast<std::size_t>(joint)]; }
  const Vec3<double>& offset(int joint) const { return offsets[static_cast<std::size_t>(joint)]; }

  /// Children of a joint in order.
  std::vector<int> children(int joint) const {
    std::vector<int> out;
    for (int j = joint + 1; j < size(); ++j) {
      if (parent(j) == joint) out.push_back(j);
    }
    return out;
  }
  /// Rest positions relative to the same origin as the root's offset.
  std::vector<Vec3<double>> rest_positions() const {
    std::vector<Vec3<double>> p(offsets);
    for (int j = 1; j < size(); ++j) {
      p[static_cast<std::size_t>(j)] = p[static_cast<std::size_t>(parent(j))] + offset(j);
    }
    return p;
  }

  /// Throws config_error 106 unless the promises above hold.
  void validate() const {
    if (parents.empty()) raise<config_error>(106, "Skeleton: no joints");
    if (names.size() != parents.size() || offsets.size() != parents.size()) {
      raise<config_error>(106, "Skeleton: ", names.size(), " names, ", parents.size(), " parents, ", offsets.size(),
                          " offsets");
    }
    for (int j = 0; j < size(); ++j) {
      if (j == 0 ? parent(j) != -1 : parent(j) < 0 || parent(j) >= j) {
        raise<config_error>(
            106, "Skeleton: joint ", j, " '", name(j), "' has parent ", parent(j),
            j == 0 ? "; the first joint must be the root (-1)" : "; it must be one of the joints before");
      }
      if (find(name(j)) != j) raise<config_error>(106, "Skeleton: two joints are called '", name(j), "'");
    }
  }
  bool operator==(const Skeleton&) const = default;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Local rotations of all joints and the position of the root.
template <ScalarLike S>
struct Pose {
  Vec3<S> root{};
  std::vector<Quaternion<S>> local;

  /// All rotations the identity, the root where the skeleton puts it.
  static Pose rest(const Skeleton& skeleton) {
    return {vec_cast<S>(skeleton.offset(0)),
            std::vector<Quaternion<S>>(static_cast<std::size_t>(skeleton.size()), Quaternion<S>::identity())};
  }
};

/// Positions and rotations of all joints in the world.
template <ScalarLike S>
struct JointTransforms {
  std::vector<Vec3<S>> position;
  std::vector<Matrix3<S>> rotation;
};

/// local     one rotation per joint, in any representation
/// result    resized to the number of joints; pass the same object again to avoid allocations
/// Throws    shape_error 204 if the number of rotations is not the number of joints
template <Rotation R, ScalarLike S>
void forward_kinematics(const Skeleton& skeleton, std::span<const R> local, const Vec3<S>& root,
                        JointTransforms<S>& result) {
  const auto joints = static_cast<std::size_t>(skeleton.size());
  if (local.size() != joints) {
    raise<shape_error>(204, "forward_kinematics: ", local.size(), " rotations for ", joints, " joints");
  }
  result.position.resize(joints);
  result.rotation.resize(joints);
  result.position[0] = root;
  result.rotation[0] = to_matrix(local[0]);
  for (std::size_t j = 1; j < joints; ++j) {
    const auto p = static_cast<std::size_t>(skeleton.parents[j]);
    result.position[j] = result.position[p] + result.rotation[p] * vec_cast<S>(skeleton.offsets[j]);
    result.rotation[j] = result.rotation[p] * to_matrix(local[j]);
  }
}

template <Rotation R, ScalarLike S>
JointTransforms<S> forward_kinematics(const Skeleton& skeleton, std::span<const R> local, const Vec3<S>& root) {
  JointTransforms<S> result;
  forward_kinematics(skeleton, local, root, result);
  return result;
}

template <ScalarLike S>
JointTransforms<S> forward_kinematics(const Skeleton& skeleton, const Pose<S>& pose) {
  return forward_kinematics(skeleton, std::span<const Quaternion<S>>(pose.local), pose.root);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

struct Motion {
  Skeleton skeleton;
  double fps = 20;
  std::vector<Vec3<double>> root;         // (frames)
  std::vector<Quaternion<double>> local;  // (frames, joints), joint fastest
  std::string name{};                     // of the clip, for messages and files

  Index frames() const { return static_cast<Index>(root.size()); }
  double seconds() const { return static_cast<double>(frames()) / fps; }

  std::span<const Quaternion<double>> rotations(Index frame) const {
    const auto joints = static_cast<std::size_t>(skeleton.size());
    return std::span(local).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
  std::span<Quaternion<double>> rotations(Index frame) {
    const auto joints = static_cast<std::size_t>(skeleton.size());
    return std::span(local).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
  const Vec3<double>& root_at(Index frame) const { return root[static_cast<std::size_t>(frame)]; }

  /// Joint positions and rotations of one frame in the world.
  void world(Index frame, JointTransforms<double>& result) const {
    forward_kinematics(skeleton, rotations(frame), root_at(frame), result);
  }
  /// Joint positions of all frames, (frames, joints).
  std::vector<Vec3<double>> positions() const {
    std::vector<Vec3<double>> out;
    out.reserve(local.size());
    JointTransforms<double> t;
    for (Index f = 0; f < frames(); ++f) {
      world(f, t);
      out.insert(out.end(), t.position.begin(), t.position.end());
    }
    return out;
  }
  /// Throws shape_error 205 if the arrays do not fit, config_error 101 for a frame rate that is none, numeric_error 301
  /// on a value that is not finite and on a rotation of length 0.
  void validate() const {
    skeleton.validate();
    if (local.size() != root.size() * static_cast<std::size_t>(skeleton.size())) {
      raise<shape_error>(205, "Motion '", name, "': ", local.size(), " rotations for ", frames(), " frames of ",
                         skeleton.size(), " joints");
    }
    if (!(fps > 0 && std::isfinite(fps))) raise<config_error>(101, "Motion '", name, "': frame rate ", fps);
    for (std::size_t f = 0; f < root.size(); ++f) {
      const auto& r = root[f];
      if (!std::isfinite(r.x + r.y + r.z))
        raise<numeric_error>(301, "Motion '", name, "': root position of frame ", f, " is not finite");
    }
    for (std::size_t i = 0; i < local.size(); ++i) {
      const auto& q = local[i];
      const bool finite = std::isfinite(q.w + q.x + q.y + q.z);
      if (!finite || dot(q, q) < 1e-12) {
        const std::size_t joints = skeleton.parents.size();
        raise<numeric_error>(301, "Motion '", name, "': rotation of joint '", skeleton.names[i % joints], "' in frame ",
                             i / joints, finite ? " has length 0" : " is not finite");
      }
    }
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Frames first ... last - 1. Throws shape_error 203 unless 0 <= first <= last <= frames.
inline Motion crop(const Motion& motion, Index first, Index last) {
  if (first < 0 || last < first || last > motion.frames()) {
    raise<shape_error>(203, "crop: frames ", first, " to ", last, " of a clip of ", motion.frames());
  }
  const Index joints = motion.skeleton.size();
  return {motion.skeleton, motion.fps,
          std::vector<Vec3<double>>(motion.root.begin() + first, motion.root.begin() + last),
          std::vector<Quaternion<double>>(motion.local.begin() + first * joints, motion.local.begin() + last * joints),
          motion.name};
}

/// The clip at another frame rate: frame i shows the moment i / fps, as long as the clip lasts (its last frame stands
/// at (frames - 1) / old fps). Root positions are interpolated linearly, rotations along the shortest arc. Moments that
/// coincide with a frame take it unchanged, so going up by a whole factor and down again gives the same clip.
/// Throws config_error 101 unless fps > 0.
inline Motion resample(const Motion& motion, double fps) {
  if (!(fps > 0) || !std::isfinite(fps)) raise<config_error>(101, "resample: frame rate ", fps);
  Motion out{motion.skeleton, fps, {}, {}, motion.name};
  if (motion.frames() == 0) return out;
  const double step = motion.fps / fps, rounding = 1e-6;  // frame times are not exact in decimal files
  const auto last = static_cast<double>(motion.frames() - 1);
  const auto frames = static_cast<Index>(std::floor(last / step + rounding)) + 1;
  out.root.reserve(static_cast<std::size_t>(frames));
  out.local.reserve(static_cast<std::size_t>(frames * motion.skeleton.size()));
  for (Index i = 0; i < frames; ++i) {
    const double moment = std::min(static_cast<double>(i) * step, last), whole = std::floor(moment + rounding);
    const auto a = static_cast<Index>(whole), b = std::min(a + 1, motion.frames() - 1);
    const double t = moment - whole < rounding ? 0 : moment - whole;
    out.root.push_back((1 - t) * motion.root_at(a) + t * motion.root_at(b));
    const auto from = motion.rotations(a), to = motion.rotations(b);
    for (std::size_t j = 0; j < from.size(); ++j) out.local.push_back(t == 0 ? from[j] : slerp(from[j], to[j], t));
  }
  return out;
}

/// The clip `factor` times as fast at the same frame rate (0.5: slow motion). Throws config_error 101 unless factor >
/// 0.
inline Motion change_speed(const Motion& motion, double factor) {
  if (!(factor > 0) || !std::isfinite(factor)) raise<config_error>(101, "change_speed: factor ", factor);
  Motion out = resample(motion, motion.fps / factor);
  out.fps = motion.fps;
  return out;
}

namespace detail {

/// Throws config_error 102 unless both clips have one skeleton and one frame rate.
inline void require_same_kind(std::string_view function, const Motion& first, const Motion& second) {
  if (first.skeleton != second.skeleton || first.fps != second.fps) {
    raise<config_error>(102, function, ": '", first.name, "' has ", first.skeleton.size(), " joints at ", first.fps,
                        " frames per second, '", second.name, "' ", second.skeleton.size(), " at ", second.fps);
  }
}

}  // namespace detail

/// `second` after `first`, as they stand (no blending, no alignment: see blend.hpp). Throws config_error 102 if
/// skeletons or frame rates differ.
inline Motion concatenate(const Motion& first, const Motion& second) {
  detail::require_same_kind("concatenate", first, second);
  Motion out = first;
  out.root.insert(out.root.end(), second.root.begin(), second.root.end());
  out.local.insert(out.local.end(), second.local.begin(), second.local.end());
  return out;
}

namespace detail {

/// How names mark their side: words anywhere, single letters at either end (lThigh, UpperArm_L, foot.L).
inline constexpr std::string_view side_words[][2] = {{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}};
inline constexpr std::string_view side_letters[][2] = {{"l", "r"}, {"L", "R"}};

inline bool has_side_word(std::string_view name) {
  return std::any_of(std::begin(side_words), std::end(side_words), [&](const auto& pair) {
    return name.find(pair[0]) != name.npos || name.find(pair[1]) != name.npos;
  });
}
/// What the joint on the other side may be called. A letter may be a coincidence ("lowerback"): look the names up.
inline std::vector<std::string> other_side(const std::string& name) {
  std::vector<std::string> candidates;
  auto replaced = [&](std::string_view mark, std::string_view other, std::size_t at) {
    candidates.push_back(std::string(name).replace(at, mark.size(), other));
  };
  for (const int side : {0, 1}) {
    for (const auto& pair : side_words) {
      if (const auto at = name.find(pair[side]); at != name.npos) replaced(pair[side], pair[1 - side], at);
    }
    for (const auto& pair : side_letters) {
      if (name.starts_with(pair[side])) replaced(pair[side], pair[1 - side], 0);
      if (name.ends_with(pair[side])) replaced(pair[side], pair[1 - side], name.size() - 1);
    }
  }
  return candidates;
}

}  // namespace detail

/// For each joint its partner on the other side, found by name; a joint in the middle is its own partner.
/// Throws config_error 103 if a name says "left" or "right" and its partner is missing.
inline std::vector<int> mirror_partners(const Skeleton& skeleton) {
  std::vector<int> partners;
  for (int j = 0; j < skeleton.size(); ++j) {
    const std::string& name = skeleton.name(j);
    int partner = -1;
    for (const std::string& candidate : detail::other_side(name)) {
      if (partner < 0) partner = skeleton.find(candidate);
    }
    if (partner < 0 && detail::has_side_word(name))
      raise<config_error>(103, "mirror_partners: '", name, "' has no partner");
    partners.push_back(partner < 0 ? j : partner);
  }
  return partners;
}

/// The clip in a mirror that stands in the sagittal plane x = 0: left becomes right.
///     p'_partner(j) = (-x, y, z)_j,   q'_partner(j) = (w, x, -y, -z)_j
/// The skeleton is mirrored too, so that positions are exact images whatever its local axes; a symmetric one stays as
/// it is. Throws config_error 102 if the partners do not pair up or their parents are not partners.
inline Motion mirror(const Motion& motion, std::span<const int> partners) {
  const Skeleton& skeleton = motion.skeleton;
  const auto joints = static_cast<std::size_t>(skeleton.size());
  if (partners.size() != joints) {
    raise<config_error>(102, "mirror: ", partners.size(), " partners for ", joints, " joints");
  }
  Motion out = motion;
  for (std::size_t j = 0; j < joints; ++j) {
    const int p = partners[j], parent = skeleton.parents[j];
    const bool paired = p >= 0 && p < skeleton.size() && partners[static_cast<std::size_t>(p)] == static_cast<int>(j);
    if (!paired || skeleton.parent(p) != (parent < 0 ? -1 : partners[static_cast<std::size_t>(parent)])) {
      raise<config_error>(102, "mirror: joint '", skeleton.names[j], "' and its partner are not mirror images");
    }
    const Vec3<double>& offset = skeleton.offsets[j];
    out.skeleton.offsets[static_cast<std::size_t>(p)] = {-offset.x, offset.y, offset.z};
  }
  for (Vec3<double>& r : out.root) r.x = -r.x;
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto from = motion.rotations(f);
    const auto to = out.rotations(f);
    for (std::size_t j = 0; j < joints; ++j) {
      to[static_cast<std::size_t>(partners[j])] = {from[j].w, from[j].x, -from[j].y, -from[j].z};
    }
  }
  return out;
}
/// With the partners that the names of the joints tell.
inline Motion mirror(const Motion& motion) { return mirror(motion, mirror_partners(motion.skeleton)); }

/// How many frames at the start are not performed but an inserted T-pose: exporters put the zero pose in front of CMU
/// trials, and some blend out of it (Daz files, with a spline that swings over for as long again).
///
/// The first pose must be the zero pose (5 degrees in the mean over the joints), and the clip must leave it far faster
/// than it moves afterwards; a performer who really starts in a T-pose is left alone. Returns 0 for skeletons whose
/// zero pose is no T-pose: call it before retargeting.
inline Index detect_t_pose_lead_in(const Motion& motion) {
  constexpr double degrees = std::numbers::pi / 180, zero_pose = 5 * degrees, fastest = 0.5 * degrees;
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  const auto longest = static_cast<Index>(std::ceil(0.1 * motion.fps));  // of a blend, frames
  const Index seen = std::min<Index>(motion.frames() - 1, longest + static_cast<Index>(motion.fps));
  if (seen < 2 || joints < 2) return 0;
  double from_zero = 0;
  for (const auto& q : motion.rotations(0).subspan(1)) from_zero += distance(q, Quaternion<double>::identity());
  if (from_zero / static_cast<double>(joints - 1) > zero_pose) return 0;

  std::vector<double> step(static_cast<std::size_t>(seen));  // mean turn of a joint from frame f to f + 1
  for (Index f = 0; f < seen; ++f) {
    const auto a = motion.rotations(f), b = motion.rotations(f + 1);
    double& turn = step[static_cast<std::size_t>(f)];
    for (std::size_t j = 1; j < joints; ++j) turn += distance(a[j], b[j]) / static_cast<double>(joints - 1);
  }
  std::vector<double> sorted(step.begin() + 1, step.end());
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  auto inserted = [&](Index f) {
    const double turn = step[static_cast<std::size_t>(f)];
    const double before = f == 0 ? turn : step[static_cast<std::size_t>(f - 1)];
    return turn > 3 * usual && turn > fastest && turn > 0.65 * before;  // a blend slows down gradually
  };
  Index blend = 0;
  while (blend < std::min(longest, seen) && inserted(blend)) ++blend;
  return blend < 2 ? blend : std::min(2 * blend, motion.frames() - 1);
}

/// The clip without those frames.
inline Motion drop_lead_in(const Motion& motion) {
  return crop(motion, detect_t_pose_lead_in(motion), motion.frames());
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_ROOT_MOTION_HPP  // <motionlang/kinematics/root_motion.hpp>
#define MOTIONLANG_HAS_KINEMATICS_ROOT_MOTION_HPP
/// Where a clip stands and goes on the floor: moving a whole clip, clips in place, and the path of the root as a track
/// of its own, as game engines want it. Y up, metres, radians; a turn to the left is positive.

namespace motionlang::inline MOTIONLANG_ABI {

/// The turn about the vertical that brings rotation `from` nearest to `to`, in [-pi, pi]. Whatever the local axes of
/// the root are: turn_between(q, Ry(a) q) = a.
///     max over a of |<to, Ry(a) from>|:   a = 2 atan2(d_y, d_w),   d = to from^-1
inline double turn_between(const Quaternion<double>& from, const Quaternion<double>& to) {
  const Quaternion<double> d = to * inverse(from);
  return std::remainder(2 * std::atan2(d.y, d.w), 2 * std::numbers::pi);
}

/// A clip moved over the floor.   p' = Ry(turn) p + shift
struct Placement {
  double turn = 0;
  Vec3<double> shift{};

  Quaternion<double> rotation() const { return from_axis_angle(Vec3<double>{0, 1, 0}, turn); }
  Vec3<double> operator()(const Vec3<double>& p) const { return rotate(rotation(), p) + shift; }
};

/// What brings the root in frame `from` of one clip over the place and heading of the root in frame `to` of another.
/// Heights stay. The frames exist.
inline Placement placement_between(const Motion& clip, Index from, const Motion& other, Index to) {
  Placement p{turn_between(clip.rotations(from)[0], other.rotations(to)[0]), {}};
  const Vec3<double> way = other.root_at(to) - p(clip.root_at(from));
  p.shift = {way.x, 0, way.z};
  return p;
}

/// The whole clip moved.
inline Motion placed(const Motion& motion, const Placement& placement) {
  Motion out = motion;
  for (Vec3<double>& r : out.root) r = placement(r);
  const Quaternion<double> turn = placement.rotation();
  for (Index f = 0; f < out.frames(); ++f) out.rotations(f)[0] = turn * out.rotations(f)[0];
  return out;
}

struct InPlaceOptions {
  bool keep_height = true;  // false: the root stays at the height of the first frame
};
/// The clip with its root over the origin, x = z = 0, in all frames. Rotations stay, headings with them.
inline Motion in_place(const Motion& motion, const InPlaceOptions& options = {}) {
  Motion out = motion;
  for (Vec3<double>& r : out.root) r = {0, options.keep_height ? r.y : motion.root_at(0).y, 0};
  return out;
}

/// The way of a root over the floor.
struct RootMotion {
  double fps = 20;
  std::vector<Vec3<double>> position;  // (frames), y = 0
  std::vector<double> heading;         // (frames), 0 in the first; continuous, so that two turns are 4 pi
};
struct ExtractedRoot {
  RootMotion path;
  Motion pose;  // in place, and always facing where the first frame faces
};

/// Takes the way of the root out of a clip. apply_root_motion puts it back.
///     position = (x, 0, z) of the root,   heading_f = turn_between(q_0, q_f)
///     pose: root (0, y, 0), rotation of the root Ry(-heading_f) q_f, all others as they are
inline ExtractedRoot extract_root_motion(const Motion& motion) {
  ExtractedRoot out{{motion.fps, {}, {}}, in_place(motion)};
  for (Index f = 0; f < motion.frames(); ++f) {
    const Vec3<double>& r = motion.root_at(f);
    const double before = f == 0 ? 0 : out.path.heading.back();
    const double turn = turn_between(motion.rotations(0)[0], motion.rotations(f)[0]);
    const double heading = before + std::remainder(turn - before, 2 * std::numbers::pi);
    out.path.position.push_back({r.x, 0, r.z});
    out.path.heading.push_back(heading);
    out.pose.rotations(f)[0] = Placement{-heading, {}}.rotation() * motion.rotations(f)[0];
  }
  return out;
}

/// A clip carried along a path, frame by frame. Throws shape_error 204 unless both have as many frames.
inline Motion apply_root_motion(const Motion& pose, const RootMotion& path) {
  if (std::ssize(path.position) != pose.frames() || std::ssize(path.heading) != pose.frames()) {
    raise<shape_error>(204, "apply_root_motion: ", pose.frames(), " frames, a path of ", path.position.size(),
                       " positions and ", path.heading.size(), " headings");
  }
  Motion out = pose;
  for (Index f = 0; f < out.frames(); ++f) {
    const auto at = static_cast<std::size_t>(f);
    const Placement p{path.heading[at], path.position[at]};
    out.root[at] = p(pose.root_at(f));
    out.rotations(f)[0] = p.rotation() * pose.rotations(f)[0];
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_SMOOTHING_HPP  // <motionlang/kinematics/smoothing.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SMOOTHING_HPP
/// Smoothing of curves over time.

namespace motionlang::inline MOTIONLANG_ABI {

/// From 0 at 0 to 1 at 1, level at both ends: s^2 (3 - 2 s).
constexpr double smoothstep(double s) { return s * s * (3 - 2 * s); }

/// Gaussian filter along time.
///     y_t = sum_k w_k x_{t+k},   w_k ~ exp(-k^2 / (2 sigma^2)),   |k| <= floor(4 sigma + 1/2),   sum w = 1
/// Beyond the ends the first and last frame go on. The sum is taken in double, as scipy does.
/// Source  scipy.ndimage.gaussian_filter1d, mode "nearest"; MotionDiffuse smooths joints with sigma 1
/// Shapes  values (frames, width) -> the same
/// Throws  config_error 101 (sigma), shape_error 205 (size)
template <Scalar S>
std::vector<S> gaussian_smooth(std::span<const S> values, Index width, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) raise<config_error>(101, "gaussian_smooth: sigma ", sigma);
  if (width <= 0 || std::ssize(values) % width != 0) {
    raise<shape_error>(205, "gaussian_smooth: ", values.size(), " values are not rows of ", width);
  }
  const auto radius = static_cast<Index>(4 * sigma + 0.5);
  std::vector<double> kernel;
  double sum = 0;
  for (Index k = -radius; k <= radius; ++k) {
    kernel.push_back(std::exp(-0.5 * static_cast<double>(k * k) / (sigma * sigma)));
    sum += kernel.back();
  }
  for (double& w : kernel) w /= sum;
  const Index frames = std::ssize(values) / width, size = frames * width;
  std::vector<double> longer, sums(values.size());  // the values with the ends going on
  for (Index t = -radius; frames > 0 && t < frames + radius; ++t) {
    const auto row = values.subspan(static_cast<std::size_t>(std::clamp<Index>(t, 0, frames - 1) * width));
    for (Index c = 0; c < width; ++c) longer.push_back(static_cast<double>(row[static_cast<std::size_t>(c)]));
  }
  const double* from = longer.data();
  for (const double w : kernel) {
    for (Index i = 0; i < size; ++i) sums[static_cast<std::size_t>(i)] += w * from[i];
    from += width;
  }
  return std::vector<S>(sums.begin(), sums.end());
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Adds the mix of two frames to a clip: roots in a line, rotations on the shortest arc.
inline void add_mixed_frame(Motion& out, const Motion& a, Index in_a, const Motion& b, Index in_b, double share_of_b) {
  out.root.push_back((1 - share_of_b) * a.root_at(in_a) + share_of_b * b.root_at(in_b));
  const auto from = a.rotations(in_a), to = b.rotations(in_b);
  for (std::size_t j = 0; j < from.size(); ++j) out.local.push_back(slerp(from[j], to[j], share_of_b));
}
/// Share of the second clip in frame i of n blended frames.
inline double share_of_second(Index i, Index n) {
  return smoothstep(static_cast<double>(i + 1) / static_cast<double>(n + 1));
}

}  // namespace detail

/// `second` after `first`, with `frames` frames in which both play and one gives way to the other. The second clip is
/// turned and moved over the floor so that in the middle of these frames both roots stand over one place and have one
/// heading; heights are only blended. The result has frames(first) + frames(second) - frames frames.
/// Throws config_error 102 if skeletons or frame rates differ, 101 unless 1 <= frames <= those of each clip.
inline Motion blend_into(const Motion& first, const Motion& second, Index frames) {
  detail::require_same_kind("blend_into", first, second);
  if (frames < 1 || frames > std::min(first.frames(), second.frames())) {
    raise<config_error>(101, "blend_into: ", frames, " frames of clips of ", first.frames(), " and ", second.frames());
  }
  const Index start = first.frames() - frames, middle = frames / 2;
  const Motion next = placed(second, placement_between(second, middle, first, start + middle));
  Motion out = crop(first, 0, start);
  for (Index i = 0; i < frames; ++i) {
    detail::add_mixed_frame(out, first, start + i, next, i, detail::share_of_second(i, frames));
  }
  return concatenate(out, crop(next, frames, next.frames()));
}

/// One round of a loop.
struct LoopRound {
  Motion motion;
  Placement next;  // moves the clip of one round to that of the next
};

/// The clip as one round of a loop: its last `frames` frames are blended into its first ones and then cut off, so that
/// after the last frame the first one, moved by `next`, is the natural following one. `next` turns and moves over the
/// floor only; it is what brings the middle of the first frames over the middle of the last. A walk so goes on from
/// round to round; make a clip in place first and `next` is at most a turn.
/// Throws config_error 101 unless 1 <= frames and 2 frames <= those of the clip.
inline LoopRound make_loop(const Motion& motion, Index frames) {
  if (frames < 1 || frames > motion.frames() / 2) {
    raise<config_error>(101, "make_loop: ", frames, " frames to blend in a clip of ", motion.frames());
  }
  const Index last = motion.frames() - frames, middle = frames / 2;
  const Motion end = placed(motion, placement_between(motion, last + middle, motion, middle));
  LoopRound loop{crop(motion, 0, 0), placement_between(motion, middle, motion, last + middle)};
  for (Index i = 0; i < frames; ++i) {
    detail::add_mixed_frame(loop.motion, end, last + i, motion, i, detail::share_of_second(i, frames));
  }
  loop.motion = concatenate(loop.motion, crop(motion, frames, last));
  return loop;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_HPP  // <motionlang/kinematics/body.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_HPP
/// A body: its model, its surface, its hands; and what is public about the SMPL family: sizes, and the vertices that serve as
/// extra joints. Bodies come from the user's own files (io/body_file.hpp) or from any skeleton (io/figure_body.hpp).
///
/// Source  spec body-models.md, sections 2, 4, 5

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_MODEL_HPP  // <motionlang/kinematics/body_model.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_MODEL_HPP
/// Linear blend skinning with shape and pose blend shapes: the forward pass of SMPL, SMPL-H and SMPL-X, over any backend.
///
/// On a bare backend the chain goes pose by pose and vertices through the kernel of skinning.hpp, on all threads (`prepare` the
/// model first: its blend shapes are then packed once). On an Autodiff backend every number of the chain is a tensor over the poses,
/// so that vertices and joints can be differentiated by shape, rotations and translation.
///
/// Source    Loper et al. (2015), eq. 2-12; spec body-models.md 1. The model's arrays come from the user's own file
///           (io/body_file.hpp) or from a skeleton (io/figure_body.hpp).
/// Notation  V vertices, J joints, K shape coefficients, N poses; beta -> betas, R_j -> rotations, tau -> translation
/// Differs   from the smplx package: rest joints come from the regressor folded into template and shape directions, which is
///           the same sum in another order

#ifndef MOTIONLANG_HAS_KINEMATICS_SKINNING_HPP  // <motionlang/kinematics/skinning.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SKINNING_HPP
/// Linear blend skinning of many poses on a processor: the kernel of body models on bare backends.
///
///     vertex_i = sum_j w_ij (R_j v_i + t_j)
///
/// A vertex follows few joints (SMPL: at most four), so only weights that are not 0 are visited. Transforms are columns of four
/// numbers, which fit a register of every processor.
/// Source    Loper et al. (2015), eq. 2

namespace motionlang::inline MOTIONLANG_ABI {

/// The weights that are not 0, vertex by vertex.
template <Scalar S>
class SkinWeights {
 public:
  struct Entry {
    int joint;
    S weight;
  };
  /// From all of them, (vertices, joints).
  SkinWeights(std::span<const S> dense, Index joints) {
    for (std::size_t at = 0; at < dense.size(); at += static_cast<std::size_t>(joints)) {
      for (Index j = 0; j < joints; ++j) {
        if (const S w = dense[at + static_cast<std::size_t>(j)]; w != S(0)) {
          entries_.push_back({static_cast<int>(j), w});
        }
      }
      ends_.push_back(entries_.size());
    }
  }
  Index vertices() const { return static_cast<Index>(ends_.size()) - 1; }
  std::span<const Entry> of(Index vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return std::span(entries_).subspan(ends_[v], ends_[v + 1] - ends_[v]);
  }

 private:
  std::vector<Entry> entries_;
  std::vector<std::size_t> ends_{0};
};

/// Numbers of a joint's transform: three columns of R and t, each with a fourth number that is ignored.
inline constexpr Index skin_transform_size = 16;

/// posed        (poses, vertices, 3): the vertices before they are moved
/// transforms   (poses, joints, 16)
/// vertices     (poses, vertices, 3); may be `posed`
template <Scalar S>
void skin_vertices(const SkinWeights<S>& weights, const S* posed, const S* transforms, Index poses, Index joints,
                   S* vertices) {
  typedef S Four __attribute__((vector_size(4 * sizeof(S)), aligned(alignof(S)), may_alias));
  constexpr Index block = 8;  // poses whose transforms stay in the first cache while the vertices go by
  const Index count = weights.vertices(), row = 3 * count;
  parallel_for((poses + block - 1) / block, [&](Index b) {
    const Index first = b * block, last = std::min(poses, first + block);
    for (Index v = 0; v < count; ++v) {
      const auto entries = weights.of(v);
      for (Index pose = first; pose < last; ++pose) {
        const S* const own = transforms + pose * joints * skin_transform_size;
        Four x{}, y{}, z{}, t{};
        for (const auto& e : entries) {
          const Four* const columns = reinterpret_cast<const Four*>(own + e.joint * skin_transform_size);
          x += e.weight * columns[0];
          y += e.weight * columns[1];
          z += e.weight * columns[2];
          t += e.weight * columns[3];
        }
        const S* const from = posed + pose * row + 3 * v;
        const Four p = x * from[0] + y * from[1] + z * from[2] + t;
        S* const to = vertices + pose * row + 3 * v;
        to[0] = p[0], to[1] = p[1], to[2] = p[2];
      }
    }
  });
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Posed points. vertices (N, V, 3), joints (N, J, 3), extra (N, E, 3): points picked from the vertices.
template <Backend B>
struct PosedBody {
  Tensor<B, 3> vertices, joints, extra;
};

namespace detail {

/// A tensor whose numbers fill(S*) writes.
template <Backend B, int R, class F>
Tensor<B, R> written_tensor(const Shape& shape, F fill) {
  using S = typename B::scalar;
  if constexpr (requires(typename B::tensor t, const Shape& s) {
                  { t.data() } -> std::same_as<S*>;
                  t = typename B::tensor(s);
                }) {
    typename B::tensor t(shape);
    fill(t.data());
    return Tensor<B, R>(std::move(t));
  } else {
    PoolVector<S> values(static_cast<std::size_t>(shape.count()));
    fill(values.data());
    return Tensor<B, R>::from(std::span<const S>(values), shape);
  }
}

/// The kinematic chain, joint after joint. rest(j) and local(j) give a joint's rest position and rotation;
/// put(j, R, p, t) takes its world rotation, its position, and t = p - R rest(j), which skinning needs.
template <class S, class Rest, class Local, class Put>
void walk_chain(std::span<const int> parents, JointTransforms<S>& world, Rest rest, Local local, Put put) {
  world.rotation.resize(parents.size());
  world.position.resize(parents.size());
  for (std::size_t j = 0; j < parents.size(); ++j) {
    const Vec3<S> own = rest(j);
    if (parents[j] < 0) {
      world.rotation[j] = local(j);
      world.position[j] = own;
    } else {
      const auto p = static_cast<std::size_t>(parents[j]);
      world.rotation[j] = world.rotation[p] * local(j);
      world.position[j] = world.position[p] + world.rotation[p] * (own - rest(p));
    }
    put(j, world.rotation[j], world.position[j], world.position[j] - world.rotation[j] * own);
  }
}

}  // namespace detail

/// Rotation vectors (N, J, 3) as the matrices that a body model takes: (N, J, 9), row by row. Differentiable, also at 0.
template <Backend B>
Tensor<B, 3> rotation_rows(const Tensor<B, 3>& axis_angles) {
  const Index n = axis_angles.size(0), j = axis_angles.size(1);
  if constexpr (AutodiffBackend<B>) {
    const auto flat = reshape<2>(axis_angles, {n * j, 3});
    auto component = [&](Index c) { return slice(flat, 1, c, c + 1); };
    const auto m = to_matrix(AxisAngle<Tensor<B, 2>>{{component(0), component(1), component(2)}}).m;
    return reshape<3>(concat(std::span<const Tensor<B, 2>>(m), 1), {n, j, 9});
  } else {
    using S = typename B::scalar;
    const S* const from = axis_angles.span().data();
    return detail::written_tensor<B, 3>({n, j, 9}, [&](S* to) {
      parallel_for(n, [&](Index pose) {
        for (Index i = pose * j; i < (pose + 1) * j; ++i) {
          const auto m = to_matrix(AxisAngle<S>{{from[3 * i], from[3 * i + 1], from[3 * i + 2]}}).m;
          std::copy_n(m.begin(), 9, to + 9 * i);
        }
      });
    });
  }
}

template <Backend B>
struct BodyModel {
  static constexpr bool trainable = false;
  Tensor<B, 2> v_template;   // (V, 3)
  Tensor<B, 2> shapedirs;    // (3 V, K); K may be 0
  Tensor<B, 2> posedirs;     // (3 V, 9 (J - 1)), or (3 V, 0): no pose blend shapes
  Tensor<B, 2> J_regressor;  // (J, V)
  Tensor<B, 2> weights;      // (V, J)
  std::vector<int> parents;  // -1 for the root
  std::vector<Index> extra;  // vertex numbers of the extra joints

  static constexpr auto fields() {
    using M = BodyModel;
    return motionlang::fields("v_template", &M::v_template, "shapedirs", &M::shapedirs, "posedirs", &M::posedirs,
                              "J_regressor", &M::J_regressor, "weights", &M::weights, "parents", &M::parents, "extra",
                              &M::extra);
  }

  Index vertices() const { return v_template.size(0); }
  Index joints() const { return static_cast<Index>(parents.size()); }

  /// Throws shape_error 204 if the arrays do not fit together, config_error 106 if a parent does not come before its child,
  /// 101 for an extra joint at no vertex.
  void validate() const {
    const Index v = vertices(), j = joints();
    const bool blends = posedirs.shape() == Shape{3 * v, 9 * (j - 1)} || posedirs.shape() == Shape{3 * v, 0};
    if (shapedirs.size(0) != 3 * v || !blends ||
        J_regressor.shape() != Shape{j, v} || weights.shape() != Shape{v, j}) {
      raise<shape_error>(204, "BodyModel: ", v, " vertices, ", j, " joints, but shapedirs ", shapedirs.shape(),
                         ", posedirs ", posedirs.shape(), ", J_regressor ", J_regressor.shape(), ", weights ",
                         weights.shape());
    }
    for (std::size_t i = 0; i < parents.size(); ++i) {
      if (i == 0 ? parents[i] != -1 : parents[i] < 0 || parents[i] >= static_cast<int>(i)) {
        raise<config_error>(106, "BodyModel: joint ", i, " has parent ", parents[i]);
      }
    }
    for (Index e : extra) {
      if (e < 0 || e >= v) raise<config_error>(101, "BodyModel: extra joint at vertex ", e, " of ", v);
    }
  }

  /// Rest positions of the joints for a shape: (N, 3 J).
  Tensor<B, 2> rest_joints(const Tensor<B, 2>& betas) const {
    const Index v = vertices(), j = joints(), k = shapedirs.size(1);
    auto regress = [&](const Tensor<B, 2>& t, Index columns) {
      return reshape<2>(matmul(J_regressor, reshape<2>(t, {v, 3 * columns})), {3 * j, columns});
    };
    const auto mean = reshape<2>(regress(reshape<2>(v_template, {3 * v, 1}), 1), {1, 3 * j});
    if (k == 0) return mean + Tensor<B, 2>::zeros({betas.size(0), 1});
    return matmul(betas, regress(shapedirs, k), {.transpose_b = true}) + mean;
  }

  /// betas (N, K), rotations (N, J, 9) local and row by row, translation (N, 3).
  PosedBody<B> operator()(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                          const Tensor<B, 2>& translation) const {
    check(betas, rotations, translation);
    const auto rest = rest_joints(betas);
    const auto before = blended_shapes(betas, rotations);
    PosedBody<B> out;
    if constexpr (AutodiffBackend<B>) {
      const Chain chain = posed_chain(rest, rotations);
      const auto tau = reshape<3>(translation, {translation.size(0), 1, 3});
      out.vertices = skinned(before, chain.transforms) + tau;
      out.joints = chain.positions + tau;
    } else {
      const Chain chain = posed_chain(rest, rotations, translation);
      const Index n = rotations.size(0);
      out.joints = chain.positions;
      out.vertices = detail::written_tensor<B, 3>({n, vertices(), 3}, [&](auto* to) {
        skin_vertices(SkinWeights(weights.span(), joints()), before.span().data(), chain.transforms.span().data(), n,
                      joints(), to);
      });
    }
    if (!extra.empty()) out.extra = permute(gather(permute(out.vertices, {1, 0, 2}), extra), {1, 0, 2});
    return out;
  }

  /// Joints only: no vertex is touched. (N, J, 3)
  Tensor<B, 3> posed_joints(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                            const Tensor<B, 2>& translation) const {
    check(betas, rotations, translation);
    if constexpr (AutodiffBackend<B>) {
      return posed_chain(rest_joints(betas), rotations).positions +
             reshape<3>(translation, {translation.size(0), 1, 3});
    } else {
      return posed_chain(rest_joints(betas), rotations, translation).positions;
    }
  }

 private:
  using S = typename B::scalar;
  struct Chain {
    Tensor<B, 3> positions;   // (N, J, 3)
    Tensor<B, 3> transforms;  // [R | p - R rest]: (N, J, 12) row by row with a tape, else (N, J, 16) for skin_vertices
  };

  void check(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations, const Tensor<B, 2>& translation) const {
    const Index n = rotations.size(0), j = joints();
    if (rotations.shape() != Shape{n, j, 9} || betas.shape() != Shape{n, shapedirs.size(1)} ||
        translation.shape() != Shape{n, 3}) {
      raise<shape_error>(204, "BodyModel: betas ", betas.shape(), ", rotations ", rotations.shape(), ", translation ",
                         translation.shape(), " for ", j, " joints and ", shapedirs.size(1), " shape coefficients");
    }
  }
  static Tensor<B, 1> identity_row() {
    return Tensor<B, 1>::from(std::vector<S>{1, 0, 0, 0, 1, 0, 0, 0, 1}, {9});
  }

  /// The vertices in the rest pose with blend shapes: (N, 3 V).
  Tensor<B, 2> blended_shapes(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations) const {
    const Index n = rotations.size(0), j = joints(), v = vertices();
    const auto mean = reshape<1>(v_template, {3 * v});
    const auto shaped = shapedirs.size(1) == 0 ? reshape<2>(mean, {1, 3 * v}) + Tensor<B, 2>::zeros({n, 1})
                                               : linear(betas, shapedirs, &mean);
    if (posedirs.size(1) == 0) return shaped;
    const auto feature = reshape<2>(slice(rotations, 1, 1, j) - identity_row(), {n, 9 * (j - 1)});
    const Tensor<B, 1>* const no_bias = nullptr;
    return linear(feature, posedirs, no_bias, Activation::none, &shaped);
  }

  /// All poses at once: every number is a tensor (N, 1).
  Chain posed_chain(const Tensor<B, 2>& rest, const Tensor<B, 3>& rotations) const {
    using T = Tensor<B, 2>;
    const Index n = rotations.size(0);
    JointTransforms<T> world;
    std::vector<T> points, transforms;
    detail::walk_chain(
        std::span(parents), world,
        [&](std::size_t j) {
          auto c = [&](Index axis) {
            return slice(rest, 1, 3 * static_cast<Index>(j) + axis, 3 * static_cast<Index>(j) + axis + 1);
          };
          return Vec3<T>{c(0), c(1), c(2)};
        },
        [&](std::size_t j) {
          const auto flat = reshape<2>(slice(rotations, 1, static_cast<Index>(j), static_cast<Index>(j) + 1), {n, 9});
          Matrix3<T> local;
          for (Index i = 0; i < 9; ++i) local.m[static_cast<std::size_t>(i)] = slice(flat, 1, i, i + 1);
          return local;
        },
        [&](std::size_t, const Matrix3<T>& r, const Vec3<T>& p, const Vec3<T>& t) {
          points.insert(points.end(), {p.x, p.y, p.z});
          transforms.insert(transforms.end(), {r.m[0], r.m[1], r.m[2], t.x, r.m[3], r.m[4], r.m[5], t.y, r.m[6], r.m[7],
                                               r.m[8], t.z});
        });
    return {reshape<3>(concat(std::span<const T>(points), 1), {n, joints(), 3}),
            reshape<3>(concat(std::span<const T>(transforms), 1), {n, joints(), 12})};
  }

  /// (N, V, 3) from the vertices before skinning, (N, 3 V), and the joints' transforms, (N, J, 12).
  Tensor<B, 3> skinned(const Tensor<B, 2>& before, const Tensor<B, 3>& transforms) const {
    const Index n = before.size(0), j = joints(), v = vertices();
    const auto posed = reshape<3>(before, {n, v, 3});
    // Transform of every vertex: (V, J) (J, N 12) -> (N, V, 12)
    const auto by_joint = reshape<2>(permute(transforms, {1, 0, 2}), {j, n * 12});
    const auto blended = permute(reshape<3>(matmul(weights, by_joint), {v, n, 12}), {1, 0, 2});
    std::vector<Tensor<B, 3>> axes;
    for (Index row = 0; row < 3; ++row) {
      auto entry = [&](Index column) { return slice(blended, 2, 4 * row + column, 4 * row + column + 1); };
      axes.push_back(entry(0) * slice(posed, 2, 0, 1) + entry(1) * slice(posed, 2, 1, 2) +
                     entry(2) * slice(posed, 2, 2, 3) + entry(3));
    }
    return concat(std::span<const Tensor<B, 3>>(axes), 2);
  }

  /// Pose by pose, moved by the translation.
  Chain posed_chain(const Tensor<B, 2>& rest, const Tensor<B, 3>& rotations, const Tensor<B, 2>& translation) const {
    const Index n = rotations.size(0), j = joints();
    const S *rest_at = rest.span().data(), *rotation_at = rotations.span().data(), *tau_at = translation.span().data();
    Chain chain;
    chain.positions = detail::written_tensor<B, 3>({n, j, 3}, [&](S* positions) {
      chain.transforms = detail::written_tensor<B, 3>({n, j, skin_transform_size}, [&](S* transforms) {
        constexpr Index block = 64;
        parallel_for((n + block - 1) / block, [&](Index b) {
          JointTransforms<S> world;
          for (Index pose = b * block; pose < std::min(n, (b + 1) * block); ++pose) {
            const S *own_rest = rest_at + pose * 3 * j, *own = rotation_at + pose * 9 * j, *tau = tau_at + 3 * pose;
            detail::walk_chain(
                std::span(parents), world,
                [&](std::size_t i) {
                  const S* r = own_rest + 3 * i;
                  return Vec3<S>{r[0], r[1], r[2]};
                },
                [&](std::size_t i) {
                  Matrix3<S> local;
                  std::copy_n(own + 9 * i, 9, local.m.begin());
                  return local;
                },
                [&](std::size_t i, const Matrix3<S>& r, const Vec3<S>& p, const Vec3<S>& t) {
                  const Index at = pose * j + static_cast<Index>(i);
                  const S moved[3] = {p.x + tau[0], p.y + tau[1], p.z + tau[2]};
                  std::copy_n(moved, 3, positions + 3 * at);
                  const S columns[] = {r.m[0], r.m[3], r.m[6], 0, r.m[1], r.m[4], r.m[7], 0, r.m[2], r.m[5],
                                       r.m[8], 0, t.x + tau[0], t.y + tau[1], t.z + tau[2], 0};
                  std::copy_n(columns, skin_transform_size, transforms + skin_transform_size * at);
                });
          }
        });
      });
    });
    return chain;
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// The family of a body: told by its number of joints. `other`: a body of the same form, but not of the family.
enum class BodyKind { smpl, smplh, smplx, other };
enum class BodyGender { neutral, male, female };

struct BodyKindInfo {
  BodyKind kind;
  std::string_view name;
  Index joints, vertices;
  int left_hand, right_hand;  // first finger joint; -1: the model has none
  std::string_view site;      // where its files can be had
};
inline constexpr std::array<BodyKindInfo, 3> body_kinds{{
    {BodyKind::smpl, "SMPL", 24, 6890, -1, -1, "https://smpl.is.tue.mpg.de"},
    {BodyKind::smplh, "SMPL-H", 52, 6890, 22, 37, "https://mano.is.tue.mpg.de"},
    {BodyKind::smplx, "SMPL-X", 55, 10475, 25, 40, "https://smpl-x.is.tue.mpg.de"},
}};
constexpr BodyKind body_kind_of(Index joints) {
  for (const BodyKindInfo& k : body_kinds) {
    if (k.joints == joints) return k.kind;
  }
  return BodyKind::other;
}
inline std::string to_string(BodyKind kind) {
  return kind == BodyKind::other ? "other" : std::string(body_kinds[static_cast<std::size_t>(kind)].name);
}

/// A point of the body: its name and the vertex that it is.
struct BodyPoint {
  std::string_view name;
  Index smpl, smplx;  // vertex of SMPL and SMPL-H, of SMPL-X
};
/// In the order in which they follow the joints.
inline constexpr std::array<BodyPoint, 21> body_points{{
    {"nose", 332, 9120},
    {"right_eye", 6260, 9929},
    {"left_eye", 2800, 9448},
    {"right_ear", 4071, 616},
    {"left_ear", 583, 6},
    {"left_big_toe", 3216, 5770},
    {"left_small_toe", 3226, 5780},
    {"left_heel", 3387, 8846},
    {"right_big_toe", 6617, 8463},
    {"right_small_toe", 6624, 8474},
    {"right_heel", 6787, 8635},
    {"left_thumb", 2746, 5361},
    {"left_index", 2319, 4933},
    {"left_middle", 2445, 5058},
    {"left_ring", 2556, 5169},
    {"left_pinky", 2673, 5286},
    {"right_thumb", 6191, 8079},
    {"right_index", 5782, 7669},
    {"right_middle", 5905, 7794},
    {"right_ring", 6016, 7905},
    {"right_pinky", 6133, 8022},
}};
/// The vertices of `body_points` in a body of this kind; none for other bodies.
inline std::vector<Index> extra_vertices(BodyKind kind) {
  std::vector<Index> out;
  for (const BodyPoint& p : body_points) {
    if (kind != BodyKind::other) out.push_back(kind == BodyKind::smplx ? p.smplx : p.smpl);
  }
  return out;
}

/// The space of poses of one hand: 15 joints as rotation vectors.
template <Backend B>
struct HandPoses {
  static constexpr bool trainable = false;
  Tensor<B, 2> components;  // (n, 45): the most important first
  Tensor<B, 1> mean;        // (45)

  static constexpr auto fields() {
    return motionlang::fields("components", &HandPoses::components, "mean", &HandPoses::mean);
  }
  /// coefficients (N, n) of the first n components -> rotation vectors (N, 15, 3). `flat`: a hand of all zeros is stretched out,
  /// not the mean pose. Throws shape_error 203 if there are fewer components.
  Tensor<B, 3> operator()(const Tensor<B, 2>& coefficients, bool flat = false) const {
    const auto offset = matmul(coefficients, slice(components, 0, 0, coefficients.size(1)));
    return reshape<3>(flat ? offset : offset + reshape<2>(mean, {1, 45}), {coefficients.size(0), 15, 3});
  }
};

/// A body with its surface. Nothing of it is trained.
template <Backend B>
struct Body {
  static constexpr bool trainable = false;
  BodyKind kind = BodyKind::other;
  BodyModel<B> model;
  std::vector<std::array<Index, 3>> faces;  // vertices of every triangle, counter-clockwise from outside
  Index expressions = 0;                    // of the model's coefficients, the last ones
  std::optional<HandPoses<B>> left_hand, right_hand;
};

/// The body in every frame of a motion. The motion's joints are the first ones of the model, which keeps the others (fingers, say) as
/// they are at rest; the root joint is where the motion has it. betas (K): one shape for all frames, none means zeros.
/// Throws  config_error 106 if the joints of the motion are not the first ones of the model, shape_error 204
template <Backend B>
PosedBody<B> pose_body(const BodyModel<B>& model, const Motion& motion,
                       std::span<const typename B::scalar> betas = {}) {
  using S = typename B::scalar;
  const std::vector<int>& own = motion.skeleton.parents;
  if (own.size() > model.parents.size() || !std::equal(own.begin(), own.end(), model.parents.begin())) {
    raise<config_error>(106, "pose_body: the ", own.size(), " joints of motion '", motion.name,
                        "' are not the first ones of a body of ", model.joints());
  }
  const Index frames = motion.frames(), joints = model.joints(), coefficients = model.shapedirs.size(1);
  std::vector<S> shape(betas.begin(), betas.end()), rotations, translation;
  if (shape.empty()) shape.assign(static_cast<std::size_t>(coefficients), S(0));
  if (static_cast<Index>(shape.size()) != coefficients) {
    raise<shape_error>(204, "pose_body: ", shape.size(), " coefficients for a body of ", coefficients);
  }
  const auto one = Tensor<B, 2>::from(shape, {1, coefficients});
  const auto rest = model.rest_joints(one);
  const Vec3<S> pelvis{rest.span()[0], rest.span()[1], rest.span()[2]};
  for (Index f = 0; f < frames; ++f) {
    for (Index j = 0; j < joints; ++j) {
      const auto i = static_cast<std::size_t>(j);
      const Matrix3<double> m = i < own.size() ? to_matrix(motion.rotations(f)[i]) : Matrix3<double>::identity();
      for (const double x : m.m) rotations.push_back(static_cast<S>(x));
    }
    const Vec3<S> t = vec_cast<S>(motion.root_at(f)) - pelvis;
    translation.insert(translation.end(), {t.x, t.y, t.z});
  }
  return model(broadcast_to<2>(one, {frames, coefficients}), Tensor<B, 3>::from(rotations, {frames, joints, 9}),
               Tensor<B, 2>::from(translation, {frames, 3}));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_JOINTS_HPP  // <motionlang/kinematics/body_joints.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_JOINTS_HPP
/// Which joints of a known skeleton are the hips, knees, feet, shoulders and the head. The tables of retargeting say so.

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_HPP  // <motionlang/kinematics/skeleton_tables.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_HPP
/// Which joint of a known skeleton has the part of which joint of SMPL: the tables behind retargeting, and how to
/// recognise one. They are read in both directions: SMPL's 24 joints are what all skeletons have in common.

namespace motionlang::inline MOTIONLANG_ABI {

/// A joint's name without what programs put before it: namespaces ("hero:Hips"), and Mixamo's "mixamorig:", also as
/// "mixamorig1:" and, where colons were lost, "mixamorig".
inline std::string_view bare_joint_name(std::string_view name) {
  name = name.substr(name.rfind(':') + 1);  // npos + 1 = 0
  constexpr std::string_view mixamo = "mixamorig";
  if (!name.starts_with(mixamo)) return name;
  const std::size_t rest = name.find_first_not_of("0123456789_", mixamo.size());
  return rest == name.npos ? name : name.substr(rest);
}
/// The number of a joint by its name or else by its bare name; -1.
inline int find_joint(const Skeleton& skeleton, std::string_view name) {
  int j = skeleton.find(name);
  for (int k = 0; k < skeleton.size() && j < 0; ++k) {
    if (bare_joint_name(skeleton.name(k)) == name) j = k;
  }
  return j;
}

/// One joint of SMPL and the joint of the known skeleton whose orientation it takes.
struct MappedJoint {
  std::string target;  // name in SMPL
  std::string source;
  /// The two local axes of the source joint that point to the left and up while the figure stands in a T-pose. "+x+y"
  /// for files whose rotations are all zero in that pose.
  std::string axes = "+x+y";
  /// How the frame given by `axes` is turned in the T-pose besides: rotation vector in degrees, x left, y up, z forward.
  Vec3<double> turn{};
  /// A second source joint and its share, for chains of different lengths. Its axes are those of its own row, else of
  /// its parent.
  std::string second{};
  double share = 0;
};

/// A kind of skeleton. Hands, toes and collars may be missing; all other joints of the table must be there.
struct SkeletonTable {
  std::string name;
  std::vector<MappedJoint> joints;
  /// Whether limbs are turned so that the source's bones take the directions of the target's; false where the zero pose
  /// (with `turn`) is known to be the T-pose although its bones are not straight.
  bool straighten = true;
  /// Whether the soles are level in the zero pose although the legs stand apart, as in the pose to which a character's
  /// skin is bound. Otherwise feet lean to the side with their shins.
  bool level_soles = false;

  const MappedJoint* find(std::string_view target) const {
    for (const MappedJoint& j : joints) {
      if (j.target == target) return &j;
    }
    return nullptr;
  }
  /// The first joint that the table needs and the skeleton lacks; empty if there is none.
  std::string missing(const Skeleton& source) const {
    for (const MappedJoint& j : joints) {
      const bool optional =
          j.target.ends_with("_hand") || j.target.ends_with("_foot") || j.target.ends_with("_collar");
      if (!optional && find_joint(source, j.source) < 0) return j.source;
      if (!j.second.empty() && find_joint(source, j.second) < 0) return j.second;
    }
    return {};
  }
  /// How many of its joints the skeleton has.
  int found(const Skeleton& source) const {
    int n = 0;
    for (const MappedJoint& j : joints) n += find_joint(source, j.source) >= 0 ? 1 : 0;
    return n;
  }
};

// clang-format off
/// The built-in tables. Shares of the spine follow from the heights of the joints between hips and neck.
inline const std::vector<SkeletonTable>& skeleton_tables() {
  static const std::vector<SkeletonTable> tables{
      {"SMPL",
       {{"pelvis", "pelvis"}, {"spine1", "spine1"}, {"spine2", "spine2"}, {"spine3", "spine3"}, {"neck", "neck"}, {"head", "head"},
        {"left_hip", "left_hip"}, {"left_knee", "left_knee"}, {"left_ankle", "left_ankle"}, {"left_foot", "left_foot"},
        {"right_hip", "right_hip"}, {"right_knee", "right_knee"}, {"right_ankle", "right_ankle"}, {"right_foot", "right_foot"},
        {"left_collar", "left_collar"}, {"left_shoulder", "left_shoulder"}, {"left_elbow", "left_elbow"}, {"left_wrist", "left_wrist"}, {"left_hand", "left_hand"},
        {"right_collar", "right_collar"}, {"right_shoulder", "right_shoulder"}, {"right_elbow", "right_elbow"}, {"right_wrist", "right_wrist"}, {"right_hand", "right_hand"}}},
      // Made from the MotionBuilder files. The turns were measured on the 58 trials that exist as both.
      {"CMU Daz",
       {{"pelvis", "hip"}, {"spine1", "hip", "+x+y", {}, "abdomen", 0.74}, {"spine2", "abdomen", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"},
        {"neck", "neck", "+x+y", {6, 0, 0}}, {"head", "head", "+x+y", {-16, 0, 0}},
        {"left_hip", "lThigh", "+x+y", {-4.7, 0, 0}}, {"left_knee", "lShin", "+x+y", {-4.2, 0, 0}}, {"left_ankle", "lFoot"},
        {"right_hip", "rThigh", "+x+y", {-4.7, 0, 0}}, {"right_knee", "rShin", "+x+y", {-4.2, 0, 0}}, {"right_ankle", "rFoot"},
        {"left_collar", "lCollar"}, {"left_shoulder", "lShldr", "+x+y", {0, 0, 8}}, {"left_elbow", "lForeArm", "+x+y", {0, 0, 8}}, {"left_wrist", "lHand", "+x+y", {0, 0, 8}}, {"left_hand", "lMid1"},
        {"right_collar", "rCollar"}, {"right_shoulder", "rShldr", "+x+y", {0, 0, -8}}, {"right_elbow", "rForeArm", "+x+y", {0, 0, -8}}, {"right_wrist", "rHand", "+x+y", {0, 0, -8}}, {"right_hand", "rMid1"}},
       false},
      {"CMU MotionBuilder",
       {{"pelvis", "Hips"}, {"spine1", "LowerBack"}, {"spine2", "Spine"}, {"spine3", "Spine1"}, {"neck", "Neck", "+x+y", {}, "Neck1", 0.5}, {"head", "Head"},
        {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
        {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
        {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftFingerBase"}, {"left_hand", "LeftHandIndex1"},
        {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightFingerBase"}, {"right_hand", "RightHandIndex1"}}},
      {"CMU ASF",
       {{"pelvis", "root"}, {"spine1", "lowerback"}, {"spine2", "upperback"}, {"spine3", "thorax"}, {"neck", "lowerneck", "+x+y", {}, "upperneck", 0.5}, {"head", "head"},
        {"left_hip", "lfemur"}, {"left_knee", "ltibia"}, {"left_ankle", "lfoot"}, {"left_foot", "ltoes"},
        {"right_hip", "rfemur"}, {"right_knee", "rtibia"}, {"right_ankle", "rfoot"}, {"right_foot", "rtoes"},
        {"left_collar", "lclavicle"}, {"left_shoulder", "lhumerus"}, {"left_elbow", "lradius"}, {"left_wrist", "lhand"}, {"left_hand", "lfingers"},
        {"right_collar", "rclavicle"}, {"right_shoulder", "rhumerus"}, {"right_elbow", "rradius"}, {"right_wrist", "rhand"}, {"right_hand", "rfingers"}}},
      // Local axes of Maya's kind: x runs along the bone (on the right side against it), nothing is zero in a T-pose.
      {"Bandai-Namco",
       {{"pelvis", "Hips", "-y+x"}, {"spine1", "Hips", "-y+x", {}, "Spine", 0.48}, {"spine2", "Spine", "+z+x"}, {"spine3", "Chest", "+z+x"}, {"neck", "Neck", "+z+x"}, {"head", "Head", "+z+x"},
        {"left_hip", "UpperLeg_L", "+y-x"}, {"left_knee", "LowerLeg_L", "+y-x"}, {"left_ankle", "Foot_L", "+y+z", {39.5, 0, 0}}, {"left_foot", "Toes_L", "+y+z", {21, 0, 0}},
        {"right_hip", "UpperLeg_R", "+y+x"}, {"right_knee", "LowerLeg_R", "+y+x"}, {"right_ankle", "Foot_R", "+y-z", {39.5, 0, 0}}, {"right_foot", "Toes_R", "+y-z", {21, 0, 0}},
        {"left_collar", "Shoulder_L", "+x+y"}, {"left_shoulder", "UpperArm_L", "+x+y"}, {"left_elbow", "LowerArm_L", "+x+y"}, {"left_wrist", "Hand_L", "+x+y"},
        {"right_collar", "Shoulder_R", "+x-y"}, {"right_shoulder", "UpperArm_R", "+x-y"}, {"right_elbow", "LowerArm_R", "+x-y"}, {"right_wrist", "Hand_R", "+x-y"}}},
      {"ReactIdle",
       {{"pelvis", "pelvis"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "spine.001", 0.5}, {"spine3", "spine.001"}, {"neck", "neck"}, {"head", "face"},
        {"left_hip", "thigh.L"}, {"left_knee", "shin.L"}, {"left_ankle", "foot.L"},
        {"right_hip", "thigh.R"}, {"right_knee", "shin.R"}, {"right_ankle", "foot.R"},
        {"left_collar", "shoulder.L"}, {"left_shoulder", "upper_arm.L"}, {"left_elbow", "forearm.L"},
        {"right_collar", "shoulder.R"}, {"right_shoulder", "upper_arm.R"}, {"right_elbow", "forearm.R"}}},
      {"ACCAD",
       {{"pelvis", "Hips", "-z+x"}, {"spine1", "ToSpine"}, {"spine2", "Spine", "+z+x"}, {"spine3", "Spine1", "+z+x"}, {"neck", "Neck", "-z+x"}, {"head", "Head", "-y+x"},
        {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
        {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
        {"left_collar", "LeftShoulder", "+z+x"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"},
        {"right_collar", "RightShoulder", "+z+x"}, {"right_shoulder", "RightArm", "-x+y"}, {"right_elbow", "RightForeArm", "-x+y"}, {"right_wrist", "RightHand", "-x+y"}}},
      // The figure of the first BVH files: upright, but with hanging arms when all rotations are zero.
      {"Biovision",
       {{"pelvis", "Hips"}, {"spine1", "Hips", "+x+y", {}, "Chest", 0.5}, {"spine2", "Chest"}, {"spine3", "Chest"}, {"neck", "Neck"}, {"head", "Head"},
        {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLowLeg"}, {"left_ankle", "LeftFoot"},
        {"right_hip", "RightUpLeg"}, {"right_knee", "RightLowLeg"}, {"right_ankle", "RightFoot"},
        {"left_collar", "LeftCollar"}, {"left_shoulder", "LeftUpArm", "-y+x"}, {"left_elbow", "LeftLowArm", "-y+x"}, {"left_wrist", "LeftHand", "-y+x"},
        {"right_collar", "RightCollar"}, {"right_shoulder", "RightUpArm", "+y-x"}, {"right_elbow", "RightLowArm", "+y-x"}, {"right_wrist", "RightHand", "+y-x"}}},
      // SMPL's joints as its add-ons for Blender and engines write them.
      {"SMPL add-on",
       {{"pelvis", "Pelvis"}, {"spine1", "Spine1"}, {"spine2", "Spine2"}, {"spine3", "Spine3"}, {"neck", "Neck"}, {"head", "Head"},
        {"left_hip", "L_Hip"}, {"left_knee", "L_Knee"}, {"left_ankle", "L_Ankle"}, {"left_foot", "L_Foot"},
        {"right_hip", "R_Hip"}, {"right_knee", "R_Knee"}, {"right_ankle", "R_Ankle"}, {"right_foot", "R_Foot"},
        {"left_collar", "L_Collar"}, {"left_shoulder", "L_Shoulder"}, {"left_elbow", "L_Elbow"}, {"left_wrist", "L_Wrist"}, {"left_hand", "L_Hand"},
        {"right_collar", "R_Collar"}, {"right_shoulder", "R_Shoulder"}, {"right_elbow", "R_Elbow"}, {"right_wrist", "R_Wrist"}, {"right_hand", "R_Hand"}},
       true, true},
      // Rigs of game characters: as GLB files hold them, rest rotations are taken out, so that all axes are "+x+y".
      {"Mixamo",
       {{"pelvis", "Hips"}, {"spine1", "Spine"}, {"spine2", "Spine1"}, {"spine3", "Spine2"}, {"neck", "Neck"}, {"head", "Head"},
        {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
        {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
        {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftHandMiddle1"},
        {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightHandMiddle1"}},
       true, true},
      {"KayKit",
       {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "chest", "+x+y", {}, "head", 0.5}, {"head", "head"},
        {"left_hip", "upperleg.l"}, {"left_knee", "lowerleg.l"}, {"left_ankle", "foot.l"}, {"left_foot", "toes.l"},
        {"right_hip", "upperleg.r"}, {"right_knee", "lowerleg.r"}, {"right_ankle", "foot.r"}, {"right_foot", "toes.r"},
        {"left_shoulder", "upperarm.l"}, {"left_elbow", "lowerarm.l"}, {"left_wrist", "wrist.l"}, {"left_hand", "hand.l"},
        {"right_shoulder", "upperarm.r"}, {"right_elbow", "lowerarm.r"}, {"right_wrist", "wrist.r"}, {"right_hand", "hand.r"}},
       true, true},
      {"Quaternius",
       {{"pelvis", "DEF-hips"}, {"spine1", "DEF-spine.001"}, {"spine2", "DEF-spine.002"}, {"spine3", "DEF-spine.003"}, {"neck", "DEF-neck"}, {"head", "DEF-head"},
        {"left_hip", "DEF-thigh.L"}, {"left_knee", "DEF-shin.L"}, {"left_ankle", "DEF-foot.L"}, {"left_foot", "DEF-toe.L"},
        {"right_hip", "DEF-thigh.R"}, {"right_knee", "DEF-shin.R"}, {"right_ankle", "DEF-foot.R"}, {"right_foot", "DEF-toe.R"},
        {"left_collar", "DEF-shoulder.L"}, {"left_shoulder", "DEF-upper_arm.L"}, {"left_elbow", "DEF-forearm.L"}, {"left_wrist", "DEF-hand.L"}, {"left_hand", "DEF-f_middle.01.L"},
        {"right_collar", "DEF-shoulder.R"}, {"right_shoulder", "DEF-upper_arm.R"}, {"right_elbow", "DEF-forearm.R"}, {"right_wrist", "DEF-hand.R"}, {"right_hand", "DEF-f_middle.01.R"}},
       true, true},
      // The mannequins; the fourth has three joints in the spine and one in the neck.
      {"Unreal 5",
       {{"pelvis", "pelvis"}, {"spine1", "spine_01"}, {"spine2", "spine_03"}, {"spine3", "spine_05"}, {"neck", "neck_01", "+x+y", {}, "neck_02", 0.5}, {"head", "head"},
        {"left_hip", "thigh_l"}, {"left_knee", "calf_l"}, {"left_ankle", "foot_l"}, {"left_foot", "ball_l"},
        {"right_hip", "thigh_r"}, {"right_knee", "calf_r"}, {"right_ankle", "foot_r"}, {"right_foot", "ball_r"},
        {"left_collar", "clavicle_l"}, {"left_shoulder", "upperarm_l"}, {"left_elbow", "lowerarm_l"}, {"left_wrist", "hand_l"}, {"left_hand", "middle_01_l"},
        {"right_collar", "clavicle_r"}, {"right_shoulder", "upperarm_r"}, {"right_elbow", "lowerarm_r"}, {"right_wrist", "hand_r"}, {"right_hand", "middle_01_r"}},
       true, true},
      {"Unreal 4",
       {{"pelvis", "pelvis"}, {"spine1", "spine_01"}, {"spine2", "spine_02"}, {"spine3", "spine_03"}, {"neck", "neck_01"}, {"head", "head"},
        {"left_hip", "thigh_l"}, {"left_knee", "calf_l"}, {"left_ankle", "foot_l"}, {"left_foot", "ball_l"},
        {"right_hip", "thigh_r"}, {"right_knee", "calf_r"}, {"right_ankle", "foot_r"}, {"right_foot", "ball_r"},
        {"left_collar", "clavicle_l"}, {"left_shoulder", "upperarm_l"}, {"left_elbow", "lowerarm_l"}, {"left_wrist", "hand_l"}, {"left_hand", "middle_01_l"},
        {"right_collar", "clavicle_r"}, {"right_shoulder", "upperarm_r"}, {"right_elbow", "lowerarm_r"}, {"right_wrist", "hand_r"}, {"right_hand", "middle_01_r"}},
       true, true},
      // The humanoid bones of VRM; the joints of a file have names of their own, VRoid's are below.
      {"VRM",
       {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "chest"}, {"spine3", "upperChest"}, {"neck", "neck"}, {"head", "head"},
        {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
        {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
        {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
        {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
       true, true},
      {"VRM without upper chest",
       {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "neck"}, {"head", "head"},
        {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
        {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
        {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
        {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
       true, true},
      {"VRoid",
       {{"pelvis", "J_Bip_C_Hips"}, {"spine1", "J_Bip_C_Spine"}, {"spine2", "J_Bip_C_Chest"}, {"spine3", "J_Bip_C_UpperChest"}, {"neck", "J_Bip_C_Neck"}, {"head", "J_Bip_C_Head"},
        {"left_hip", "J_Bip_L_UpperLeg"}, {"left_knee", "J_Bip_L_LowerLeg"}, {"left_ankle", "J_Bip_L_Foot"}, {"left_foot", "J_Bip_L_ToeBase"},
        {"right_hip", "J_Bip_R_UpperLeg"}, {"right_knee", "J_Bip_R_LowerLeg"}, {"right_ankle", "J_Bip_R_Foot"}, {"right_foot", "J_Bip_R_ToeBase"},
        {"left_collar", "J_Bip_L_Shoulder"}, {"left_shoulder", "J_Bip_L_UpperArm"}, {"left_elbow", "J_Bip_L_LowerArm"}, {"left_wrist", "J_Bip_L_Hand"}, {"left_hand", "J_Bip_L_Middle1"},
        {"right_collar", "J_Bip_R_Shoulder"}, {"right_shoulder", "J_Bip_R_UpperArm"}, {"right_elbow", "J_Bip_R_LowerArm"}, {"right_wrist", "J_Bip_R_Hand"}, {"right_hand", "J_Bip_R_Middle1"}},
       true, true},
  };
  return tables;
}
// clang-format on

/// The table whose joints the skeleton has; of several the one with the most. Null if none fits.
inline const SkeletonTable* find_skeleton_table(const Skeleton& source) {
  const SkeletonTable* best = nullptr;
  for (const SkeletonTable& table : skeleton_tables()) {
    if (!table.missing(source).empty()) continue;
    if (best == nullptr || table.found(source) > best->found(source)) best = &table;
  }
  return best;
}
/// The same. Throws config_error 103 with the joint that the closest table misses if none fits.
inline const SkeletonTable& detect_skeleton_table(const Skeleton& source) {
  if (const SkeletonTable* fits = find_skeleton_table(source)) return *fits;
  const SkeletonTable* closest = &skeleton_tables().front();
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.found(source) > closest->found(source)) closest = &table;
  }
  raise<config_error>(103, "detect_skeleton_table: no table fits a skeleton of ", source.size(), " joints (root '",
                      source.names.front(), "'); the closest, ", closest->name, ", needs a joint '",
                      closest->missing(source), "'");
}
/// A built-in table by name. Throws config_error 103.
inline const SkeletonTable& skeleton_table(std::string_view name) {
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.name == name) return table;
  }
  raise<config_error>(103, "skeleton_table: no table '", name, "'");
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Numbers of joints; -1 where the skeleton has none.
struct BodyJoints {
  struct Pair {
    int left = -1, right = -1;
    bool known() const { return left >= 0 && right >= 0; }
  };
  int pelvis = -1, head = -1;
  Pair hip, knee, ankle, toe, shoulder;
};

/// Nothing for a skeleton that no table fits.
inline std::optional<BodyJoints> find_body_joints(const Skeleton& skeleton) {
  const SkeletonTable* table = find_skeleton_table(skeleton);
  if (table == nullptr) return std::nullopt;
  auto joint = [&](std::string_view smpl) {
    const MappedJoint* row = table->find(smpl);
    return row == nullptr ? -1 : find_joint(skeleton, row->source);
  };
  auto pair = [&](const std::string& smpl) { return BodyJoints::Pair{joint("left_" + smpl), joint("right_" + smpl)}; };
  return BodyJoints{joint("pelvis"), joint("head"), pair("hip"),     pair("knee"),
                    pair("ankle"),   pair("foot"),  pair("shoulder")};
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_PARTS_HPP  // <motionlang/kinematics/body_parts.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_PARTS_HPP
/// Named body parts: the five of STMC, and the joints of each on a skeleton.

namespace motionlang::inline MOTIONLANG_ABI {

/// The five parts in the order that STMC uses everywhere.
/// Source  STMC (Petrovich et al., CVPR workshops 2024); the thesis says "torso" for `spine`; neck and head are `head`.
enum class BodyPart : int { left_arm, right_arm, legs, head, spine };
inline constexpr int body_part_count = 5;
inline constexpr std::array<std::string_view, body_part_count> body_part_names{"left arm", "right arm", "legs", "head",
                                                                               "spine"};

/// A set of body parts.
struct BodyParts {
  unsigned bits = 0;

  static constexpr BodyParts all() { return {(1u << body_part_count) - 1}; }
  constexpr bool has(BodyPart p) const { return (bits >> static_cast<unsigned>(p) & 1u) != 0; }
  constexpr BodyParts with(BodyPart p) const { return {bits | 1u << static_cast<unsigned>(p)}; }
  constexpr int count() const {
    int n = 0;
    for (unsigned b = bits; b != 0; b &= b - 1) ++n;
    return n;
  }
  constexpr bool empty() const { return bits == 0; }
  constexpr bool operator==(const BodyParts&) const = default;
};

/// Part of a name as it stands in a timeline file; synonyms: torso = spine, neck = head, left hand = left arm, right
/// hand = right arm, left leg = right leg = legs. Case-sensitive, as published. Nothing for an unknown name.
constexpr std::optional<BodyPart> parse_body_part(std::string_view name) {
  for (int p = 0; p < body_part_count; ++p) {
    if (name == body_part_names[static_cast<std::size_t>(p)]) return static_cast<BodyPart>(p);
  }
  if (name == "torso") return BodyPart::spine;
  if (name == "neck") return BodyPart::head;
  if (name == "left hand") return BodyPart::left_arm;
  if (name == "right hand") return BodyPart::right_arm;
  if (name == "left leg" || name == "right leg") return BodyPart::legs;
  return std::nullopt;
}
inline std::string to_string(BodyPart part) { return std::string(body_part_names[static_cast<std::size_t>(part)]); }

/// Part of each SMPL joint (24; the first 22 are HumanML3D's). Collars belong to the arms, the pelvis to the legs.
inline constexpr std::array<BodyPart, 24> smpl_part_of_joint = [] {
  using enum BodyPart;
  return std::array{legs,     legs,      legs,     spine,     legs,     legs,      spine,     legs,
                    legs,     spine,     legs,     legs,      head,     left_arm,  right_arm, head,
                    left_arm, right_arm, left_arm, right_arm, left_arm, right_arm, left_arm,  right_arm};
}();

/// Partner of each SMPL joint under reflection in the sagittal plane.
inline constexpr std::array<int, 24> smpl_mirror_joint{0,  2,  1,  3,  5,  4,  6,  8,  7,  9,  11, 10,
                                                       12, 14, 13, 15, 17, 16, 19, 18, 21, 20, 23, 22};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_CHAIN_KINEMATICS_HPP  // <motionlang/kinematics/chain_kinematics.hpp>
#define MOTIONLANG_HAS_KINEMATICS_CHAIN_KINEMATICS_HPP
/// Rotations from joint positions and back, along chains of bones: the analytic inverse kinematics of HumanML3D.
///
/// The rotation of a joint is that of the bone that ENDS at it; it has no twist; the first rotation of a chain is
/// relative to the root even where the chain begins at another joint. These are not SMPL's rotations.
///
///     g_j = between(direction_j, p_j - p_parent(j)),   g_0 = root,   q_j = g_before(j)^-1 g_j
///     back:  g_j = g_before(j) q_j,   p_j = p_parent(j) + g_j offset_j
/// Source  Guo et al. (CVPR 2022), common/skeleton.py; spec humanml3d-features.md 2, 3, 5
/// Shapes  joints (frames, joints), joint fastest, any unit of length

#ifndef MOTIONLANG_HAS_KINEMATICS_CHAINS_HPP  // <motionlang/kinematics/chains.hpp>
#define MOTIONLANG_HAS_KINEMATICS_CHAINS_HPP
/// A body as chains of joints with one zero direction for every bone: what HumanML3D and KIT need to know of a
/// skeleton.
///
/// Source  Guo et al., "Generating diverse and natural 3D human motions from text" (CVPR 2022), paramUtil.py;
///         spec humanml3d-features.md 1
/// World   Y up, a body faces +Z with its left side at +X (KIT's coordinates are mirrored, see below)

namespace motionlang::inline MOTIONLANG_ABI {

/// The bone that ends at `joint`. `before` is the joint whose rotation goes ahead of it: the one before in its chain,
/// but the root for the first bone of a chain, also where the chain branches off elsewhere.
struct ChainBone {
  std::size_t joint = 0, parent = 0, before = 0;
};

/// Chains are walked one after the other; each begins at the root (joint 0) or at a joint of an earlier chain.
struct ChainSkeleton {
  std::string name;
  std::vector<std::vector<int>> chains;
  std::vector<Vec3<double>> directions;  // unit vector of the bone that ends at each joint; nothing for the root
  std::array<int, 4> face{};             // right hip, left hip, right shoulder, left shoulder: where it looks
  std::array<int, 2> leg{};              // joints at which thigh and shank end: how tall it is
  std::array<int, 2> left_foot{}, right_foot{};  // ankle and toes: where it touches the floor
  double foot_threshold = 0;                     // a foot stands if its squared displacement per frame is smaller
  double fps = 20;
  std::vector<double> lengths{};  // of the bones of the reference skeleton; empty if not published

  std::size_t size() const { return directions.size(); }

  /// All bones in the order of the chains, parents first. Throws config_error 106 unless every joint but the root ends
  /// one bone, chains begin where earlier ones have been, and all joints and directions are there.
  std::vector<ChainBone> bones() const {
    std::vector<ChainBone> out;
    std::vector<bool> placed(size(), false);
    auto known = [&](int joint) { return joint >= 0 && static_cast<std::size_t>(joint) < size(); };
    if (size() == 0) raise<config_error>(106, "ChainSkeleton '", name, "': no joints");
    placed[0] = true;
    for (std::size_t c = 0; c < chains.size(); ++c) {
      for (std::size_t k = 0; k < chains[c].size(); ++k) {
        const int joint = chains[c][k];
        const bool expected = k == 0;
        if (!known(joint) || placed[static_cast<std::size_t>(joint)] != expected) {
          raise<config_error>(106, "ChainSkeleton '", name, "': joint ", joint, " of chain ", c,
                              !known(joint) ? " does not exist"
                              : expected    ? " begins it, but no chain before contains it"
                                            : " has a bone already");
        }
        if (k == 0) continue;
        const auto j = static_cast<std::size_t>(joint), parent = static_cast<std::size_t>(chains[c][k - 1]);
        const double length = norm(directions[j]);
        if (std::abs(length - 1) > 1e-6) {
          raise<config_error>(106, "ChainSkeleton '", name, "': the direction of joint ", j, " has length ", length);
        }
        placed[j] = true;
        out.push_back({j, parent, k == 1 ? 0 : parent});
      }
    }
    if (out.size() + 1 != size()) {
      raise<config_error>(106, "ChainSkeleton '", name, "': bones end at ", out.size(), " of ", size() - 1, " joints");
    }
    for (const int j : {face[0], face[1], face[2], face[3], leg[0], leg[1], left_foot[0], left_foot[1], right_foot[0],
                        right_foot[1]}) {
      if (!known(j)) raise<config_error>(106, "ChainSkeleton '", name, "': no joint ", j, " among ", size());
    }
    return out;
  }
  /// Throws as bones().
  void validate() const { bones(); }
  /// Parent of each joint, -1 for the root.
  std::vector<int> parents() const {
    std::vector<int> out(size(), -1);
    for (const ChainBone& b : bones()) out[b.joint] = static_cast<int>(b.parent);
    return out;
  }
};

/// HumanML3D: the first 22 joints of SMPL, metres, 20 frames per second. Lengths: first frame of its clip 000021.
inline const ChainSkeleton& humanml3d_chains() {
  static const ChainSkeleton skeleton{
      .name = "HumanML3D",
      .chains = {{0, 2, 5, 8, 11}, {0, 1, 4, 7, 10}, {0, 3, 6, 9, 12, 15}, {9, 14, 17, 19, 21}, {9, 13, 16, 18, 20}},
      .directions = {{0, 0, 0},  {1, 0, 0},  {-1, 0, 0}, {0, 1, 0},  {0, -1, 0}, {0, -1, 0}, {0, 1, 0},  {0, -1, 0},
                     {0, -1, 0}, {0, 1, 0},  {0, 0, 1},  {0, 0, 1},  {0, 1, 0},  {1, 0, 0},  {-1, 0, 0}, {0, 0, 1},
                     {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}},
      .face = {2, 1, 17, 16},
      .leg = {5, 8},
      .left_foot = {7, 10},
      .right_foot = {8, 11},
      .foot_threshold = 0.002,
      .fps = 20,
      .lengths = {0,          0.10307397, 0.10988337, 0.13156824, 0.3936232,  0.39018822, 0.14319022, 0.43243307,
                  0.42564335, 0.05736474, 0.14338182, 0.14941907, 0.21936005, 0.13748677, 0.14338283, 0.10303922,
                  0.13161404, 0.12298438, 0.25684,    0.26309174, 0.26601171, 0.2698764}};
  return skeleton;
}

/// KIT Motion-Language: 21 joints of the Master Motor Map, about 640 units per metre, 12.5 frames per second. The names
/// of the data set are mirrored: joints 11 ... 15 and 5 ... 7 ("L") are the right side of the body, and so they are
/// taken. The threshold is published in metres although the data are not, hence contacts are hardly ever on. The
/// lengths of the reference clip 03950 are not published.
inline const ChainSkeleton& kit_chains() {
  static const ChainSkeleton skeleton{
      .name = "KIT",
      .chains = {{0, 11, 12, 13, 14, 15}, {0, 16, 17, 18, 19, 20}, {0, 1, 2, 3, 4}, {3, 5, 6, 7}, {3, 8, 9, 10}},
      .directions = {{0, 0, 0},  {0, 1, 0},  {0, 1, 0},  {0, 1, 0},  {0, 1, 0},  {1, 0, 0},  {0, -1, 0},
                     {0, -1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, -1, 0}, {1, 0, 0},  {0, -1, 0}, {0, -1, 0},
                     {0, 0, 1},  {0, 0, 1},  {-1, 0, 0}, {0, -1, 0}, {0, -1, 0}, {0, 0, 1},  {0, 0, 1}},
      .face = {11, 16, 5, 8},
      .leg = {17, 18},
      .left_foot = {19, 20},
      .right_foot = {14, 15},
      .foot_threshold = 0.05,
      .fps = 12.5};
  return skeleton;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

struct FacingOptions {
  double sigma = 0;            // frames; of the Gaussian filter over time, 0: none
  bool legacy_forward = true;  // as published: hips count left minus right; false: right minus left, as shoulders do
};
struct ChainRotationOptions {
  FacingOptions facing{};
  bool fix_first_frame = false;     // false, as published: the root of frame 0 is the identity, whatever it faces
  bool fix_opposite_bones = false;  // false, as published: NaN for a bone exactly opposite to its zero direction, and
                                    // for a body that faces -Z
};

namespace detail {

/// Number of frames. Throws shape_error 205 if the joints are not whole frames.
template <class T>
std::size_t chain_frames(std::string_view function, const ChainSkeleton& skeleton, std::span<const T> values) {
  const std::size_t frames = values.size() / std::max<std::size_t>(skeleton.size(), 1);
  if (values.size() != frames * skeleton.size()) {
    raise<shape_error>(205, function, ": ", values.size(), " values are no frames of ", skeleton.size(), " joints");
  }
  return frames;
}

/// Throws numeric_error 302 for a bone of length 0, 301 for one that is not finite.
template <Scalar S>
[[noreturn]] void refuse_bone(const ChainSkeleton& skeleton, const ChainBone& bone, std::size_t frame, S length) {
  raise<numeric_error>(length == 0 ? 302 : 301, "'", skeleton.name, "' frame ", frame, ": the bone from joint ",
                       bone.parent, " to ", bone.joint, " has length ", length);
}
/// The vector from a bone's parent to its joint, and its length, which is positive.
template <Scalar S>
struct MeasuredBone {
  Vec3<S> vector;
  S length;
};
template <Scalar S>
MeasuredBone<S> measure_bone(const ChainSkeleton& skeleton, const ChainBone& bone, const Vec3<S>* joints,
                             std::size_t frame) {
  const Vec3<S> v = joints[bone.joint] - joints[bone.parent];
  const S length = norm(v);
  if (!(length > 0 && length < std::numeric_limits<S>::infinity())) refuse_bone(skeleton, bone, frame, length);
  return {v, length};
}

/// The joint that a skeleton names by number.
template <class T>
const T& joint_of(const T* frame, int joint) {
  return frame[static_cast<std::size_t>(joint)];
}

}  // namespace detail

/// Lengths of the bones in one frame, 0 for the root. Throws shape_error 205, numeric_error 301, 302.
template <Scalar S>
std::vector<S> bone_lengths(const ChainSkeleton& skeleton, std::span<const Vec3<S>> frame) {
  if (frame.size() != skeleton.size()) {
    raise<shape_error>(205, "bone_lengths: ", frame.size(), " joints for a skeleton of ", skeleton.size());
  }
  std::vector<S> out(skeleton.size());
  for (const ChainBone& b : skeleton.bones()) {
    out[b.joint] = detail::measure_bone(skeleton, b, frame.data(), 0).length;
  }
  return out;
}

/// Zero direction times length for every joint. Throws shape_error 204 unless there is one length for each joint.
template <Scalar S, Scalar L>
std::vector<Vec3<S>> chain_offsets(const ChainSkeleton& skeleton, std::span<const L> lengths) {
  if (lengths.size() != skeleton.size()) {
    raise<shape_error>(204, "chain_offsets: ", lengths.size(), " lengths for ", skeleton.size(), " joints");
  }
  std::vector<Vec3<S>> out;
  for (std::size_t j = 0; j < lengths.size(); ++j) {
    out.push_back(static_cast<S>(lengths[j]) * vec_cast<S>(skeleton.directions[j]));
  }
  return out;
}

/// Where a body faces in one frame, frame at its first joint: level, not of unit length (shorter if hips and shoulders
/// are not level).
///     a = (hip_r - hip_l) + (shoulder_r - shoulder_l) normalised,   forward = Y x a
/// legacy: the hips are taken the other way round, as the published inverse kinematics does.
template <Scalar S>
Vec3<S> facing(const ChainSkeleton& skeleton, const Vec3<S>* frame, bool legacy) {
  auto across = [&](std::size_t right, std::size_t left) {
    return detail::joint_of(frame, skeleton.face[right]) - detail::joint_of(frame, skeleton.face[left]);
  };
  const Vec3<S> hips = across(0, 1), a = normalized((legacy ? -hips : hips) + across(2, 3));
  return {a.z, S(0), -a.x};
}

/// Where it faces in every frame, unit vectors. Throws shape_error 205, config_error 101 (sigma) and 106.
template <Scalar S>
std::vector<Vec3<S>> facing_directions(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                       const FacingOptions& options = {}) {
  const std::size_t frames = detail::chain_frames("facing_directions", skeleton, joints);
  skeleton.validate();
  std::vector<S> level;  // (frames, 2): x and z
  for (std::size_t t = 0; t < frames; ++t) {
    const Vec3<S> f = facing(skeleton, &joints[t * skeleton.size()], options.legacy_forward);
    level.insert(level.end(), {f.x, f.z});
  }
  if (options.sigma != 0) level = gaussian_smooth(std::span<const S>(level), 2, options.sigma);
  std::vector<Vec3<S>> out;
  for (std::size_t t = 0; t < frames; ++t) out.push_back(normalized(Vec3<S>{level[2 * t], S(0), level[2 * t + 1]}));
  return out;
}

namespace detail {

/// The turn about Y that takes a level direction onto +Z, half a turn for -Z.
template <Scalar S>
Quaternion<S> turn_ahead(const Vec3<S>& level) {
  const S half = std::atan2(level.x, level.z) / 2;
  return {std::cos(half), S(0), -std::sin(half), S(0)};
}

/// Rotations of the root in all frames.
template <Scalar S>
std::vector<Quaternion<S>> chain_roots(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                       const ChainRotationOptions& options) {
  std::vector<Quaternion<S>> out;
  for (const Vec3<S>& forward : facing_directions(skeleton, joints, options.facing)) {
    const Vec3<S> ahead{S(0), S(0), S(1)};
    const bool replaced = out.empty() && !options.fix_first_frame;
    out.push_back(replaced                     ? Quaternion<S>::identity()
                  : options.fix_opposite_bones ? turn_ahead(forward)
                                               : guo::between(forward, ahead));
  }
  return out;
}

/// Rotations of all joints of one frame, or of one frame in each lane.
/// zero    directions of the bones
/// world   workspace (joints)
/// local   result (joints)
/// Returns 0 where all bones have a length.
template <ScalarLike T>
T chain_rotations(std::span<const ChainBone> bones, std::span<const Vec3<T>> zero, const Vec3<T>* joints,
                  const Quaternion<T>& root, bool fix_opposite, Quaternion<T>* world, Quaternion<T>* local) {
  const T none = T(0), one = T(1), infinite = T(std::numeric_limits<float>::max());
  T bad = none;
  world[0] = local[0] = root;
  for (const ChainBone& b : bones) {
    const Vec3<T> v = joints[b.joint] - joints[b.parent];
    const T squared = dot(v, v);
    bad = bad + where_less(none, squared, where_less(squared, infinite, none, one), one);
    world[b.joint] = fix_opposite ? rotation_between(zero[b.joint], v) : guo::between(zero[b.joint], v, sqrt(squared));
    local[b.joint] = inverse(world[b.before]) * world[b.joint];
  }
  return bad;
}

/// Throws numeric_error 301 or 302 for the first bone of a frame that has no direction.
template <Scalar S>
void require_bones(const ChainSkeleton& skeleton, std::span<const ChainBone> bones, const Vec3<S>* joints,
                   std::size_t frame) {
  for (const ChainBone& b : bones) measure_bone(skeleton, b, joints, frame);
}

}  // namespace detail

/// result  (frames, joints); joint 0: the rotation that turns the facing direction onto +Z
/// Throws  shape_error 205, config_error 101 (sigma) and 106, numeric_error 301 and 302 for a bone without direction
template <Scalar S>
std::vector<Quaternion<S>> chain_inverse_kinematics(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                                    const ChainRotationOptions& options = {}) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("chain_inverse_kinematics", skeleton, joints);
  const auto bones = skeleton.bones();
  const auto roots = detail::chain_roots(skeleton, joints, options);
  const auto zero = chain_offsets<S>(skeleton, std::span<const S>(std::vector<S>(n, S(1))));
  std::vector<Quaternion<S>> out(frames * n), world(n);
  for (std::size_t t = 0; t < frames; ++t) {
    const S bad = detail::chain_rotations<S>(bones, zero, &joints[t * n], roots[t], options.fix_opposite_bones,
                                             world.data(), &out[t * n]);
    if (bad > 0) detail::require_bones(skeleton, bones, &joints[t * n], t);
  }
  return out;
}

/// local    (frames, joints), quaternions or matrices
/// root     (frames)
/// offsets  (joints), or (frames, joints) if bones change over time; see chain_offsets
/// result   (frames, joints)
/// Throws   shape_error 204, 205, config_error 106
template <Rotation R, Scalar S>
std::vector<Vec3<S>> chain_forward_kinematics(const ChainSkeleton& skeleton, std::span<const R> local,
                                              std::span<const Vec3<S>> root, std::span<const Vec3<S>> offsets,
                                              bool root_rotation = true) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("chain_forward_kinematics", skeleton, local);
  if (root.size() != frames || (offsets.size() != n && offsets.size() != local.size())) {
    raise<shape_error>(204, "chain_forward_kinematics: ", frames, " frames of ", n, " joints, ", root.size(),
                       " root positions, ", offsets.size(), " offsets");
  }
  const auto bones = skeleton.bones();
  std::vector<Vec3<S>> out(local.size());
  std::vector<R> world(n);
  for (std::size_t t = 0; t < frames; ++t) {
    Vec3<S>* position = &out[t * n];
    const Vec3<S>* offset = &offsets[offsets.size() == n ? 0 : t * n];
    position[0] = root[t];
    world[0] = root_rotation ? local[t * n] : R::identity();
    for (const ChainBone& b : bones) {
      world[b.joint] = world[b.before] * local[t * n + b.joint];
      position[b.joint] = position[b.parent] + rotate(world[b.joint], offset[b.joint]);
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_FOOT_CONTACT_HPP  // <motionlang/kinematics/foot_contact.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FOOT_CONTACT_HPP
/// When feet touch the floor. Y up, metres.

namespace motionlang::inline MOTIONLANG_ABI {

/// A joint that may touch the floor, and the height below which it does.
struct ContactJoint {
  int joint = 0;
  double height = 0.05;  // metres above the floor
};
/// Of SMPL (and HumanML3D). When a foot stands, its ankle is about 7 cm and its toe joint 1 to 2 cm high.
inline constexpr double smpl_ankle_contact = 0.10, smpl_toe_contact = 0.05;
/// Ankles and toes of SMPL (and HumanML3D).
inline constexpr ContactJoint smpl_contact_joints[] = {
    {7, smpl_ankle_contact}, {8, smpl_ankle_contact}, {10, smpl_toe_contact}, {11, smpl_toe_contact}};

namespace detail {

/// The way of a joint over the floor from one frame to the next; `low` if it is below its height in both.
struct Slide {
  bool low = false;
  Vec3<double> step{};
  double length() const { return norm(step); }
};
/// positions (frames, joints); frame + 1 is one of them.
inline Slide slide(std::span<const Vec3<double>> positions, Index joints, Index frame, const ContactJoint& foot,
                   double floor) {
  const auto &a = positions[static_cast<std::size_t>(frame * joints + foot.joint)],
             &b = positions[static_cast<std::size_t>((frame + 1) * joints + foot.joint)];
  return {std::max(a.y, b.y) - floor < foot.height, {b.x - a.x, 0, b.z - a.z}};
}

}  // namespace detail

struct ContactOptions {
  double floor = 0;
  double speed = 0.6;  // m/s over the floor; a joint that is faster is only passing
};

/// (frames, feet): 1 where a foot is below its height and slower than options.speed between a frame and the next (the
/// last frame: the one before). Throws shape_error 203 for a joint out of range.
inline std::vector<std::uint8_t> foot_contacts(const Motion& motion,
                                               std::span<const ContactJoint> feet = smpl_contact_joints,
                                               const ContactOptions& options = {}) {
  const Index joints = motion.skeleton.size(), frames = motion.frames();
  for (const ContactJoint& foot : feet) {
    if (foot.joint < 0 || foot.joint >= joints)
      raise<shape_error>(203, "foot_contacts: joint ", foot.joint, " of ", joints);
  }
  const auto positions = motion.positions();
  std::vector<std::uint8_t> flags;
  for (Index f = 0; f < frames; ++f) {
    const Index from = std::max<Index>(0, std::min(f, frames - 2)), to = std::min(from + 1, frames - 1);
    for (const ContactJoint& foot : feet) {
      auto at = [&](Index frame) { return positions[static_cast<std::size_t>(frame * joints + foot.joint)]; };
      const Vec3<double> step = at(to) - at(from);
      const double speed = norm(Vec3<double>{step.x, 0, step.z}) * motion.fps;
      flags.push_back(at(f).y - options.floor < foot.height && speed < options.speed ? 1 : 0);
    }
  }
  return flags;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_FOOT_LOCK_HPP  // <motionlang/kinematics/foot_lock.hpp>
#define MOTIONLANG_HAS_KINEMATICS_FOOT_LOCK_HPP
/// Feet that stay where they stand. Y up, metres. Generated motions slide a little: the path of the root and the legs
/// are predicted side by side and agree only nearly.
///
///     Motion steady = fix_feet(motion);      // path_from_feet, lock_feet, raise_swings

#ifndef MOTIONLANG_HAS_KINEMATICS_LIMB_IK_HPP  // <motionlang/kinematics/limb_ik.hpp>
#define MOTIONLANG_HAS_KINEMATICS_LIMB_IK_HPP
/// Inverse kinematics of a limb of two bones: hip, knee and ankle, or shoulder, elbow and wrist.

namespace motionlang::inline MOTIONLANG_ABI {

/// Joints of a limb, each the parent of the next.
struct Limb {
  int upper = 0, middle = 0, end = 0;
};

namespace detail {

/// Throws config_error 103 unless each joint of the limb is the parent of the next.
inline void require_limb(std::string_view function, const Skeleton& skeleton, const Limb& limb) {
  auto hangs_on = [&](int joint, int parent) {
    return parent >= 0 && joint >= 0 && joint < skeleton.size() && skeleton.parent(joint) == parent;
  };
  if (!hangs_on(limb.end, limb.middle) || !hangs_on(limb.middle, limb.upper)) {
    raise<config_error>(103, function, ": joints ", limb.upper, ", ", limb.middle, ", ", limb.end,
                        " are no limb of a skeleton of ", skeleton.size());
  }
}

}  // namespace detail

/// Bends and turns a limb so that its end comes to `target`, or as near as its bones reach. The middle joint stays in
/// its plane, and the rotation of the end in the world is kept.
///     cos(middle) = (l1^2 + l2^2 - r^2) / (2 l1 l2),   r = |target - upper|
/// pose        (joints) local rotations of one frame, changed in place
/// world       the same frame by forward kinematics, as it was before; not changed
/// towards     where in the world the middle joint goes if the limb is straight (knees: forward)
/// Throws      config_error 103 if the joints do not hang together, shape_error 205 unless there is one rotation for
///             each joint, numeric_error 302 for a bone that is shorter than 0.1 mm
inline void reach(const Skeleton& skeleton, std::span<Quaternion<double>> pose, const JointTransforms<double>& world,
                  const Limb& limb, const Vec3<double>& target, const Vec3<double>& towards) {
  detail::require_limb("reach", skeleton, limb);
  if (std::ssize(pose) != skeleton.size())
    raise<shape_error>(205, "reach: ", pose.size(), " rotations for ", skeleton.size(), " joints");
  const auto upper = static_cast<std::size_t>(limb.upper), middle = static_cast<std::size_t>(limb.middle),
             end = static_cast<std::size_t>(limb.end);
  const Vec3<double> a = world.position[upper], b = world.position[middle], c = world.position[end];
  const double l1 = norm(b - a), l2 = norm(c - b);
  constexpr double slack = 1e-4;  // a limb never gets quite straight, where its plane would be lost
  if (std::min(l1, l2) < slack) raise<numeric_error>(302, "reach: bones of ", l1, " m and ", l2, " m");
  const double r = std::clamp(norm(target - a), std::abs(l1 - l2) + slack, l1 + l2 - slack);
  auto angle = [](const Vec3<double>& u, const Vec3<double>& v) {
    return std::acos(std::clamp(dot(normalized(u), normalized(v)), -1.0, 1.0));
  };
  auto corner = [](double left, double right, double opposite) {
    return std::acos(std::clamp((left * left + right * right - opposite * opposite) / (2 * left * right), -1.0, 1.0));
  };
  const Vec3<double> plane = cross(c - a, b - a);
  const Vec3<double> axis = norm(plane) > 1e-6 ? normalized(plane) : normalized(cross(c - a, towards));
  const auto at_upper = from_axis_angle(axis, corner(l1, r, l2) - angle(c - a, b - a));
  const auto at_middle = from_axis_angle(axis, corner(l1, l2, r) - angle(a - b, c - b));
  const auto aim = rotation_between(normalized(c - a), normalized(target - a));

  const std::size_t above = skeleton.parents[upper] < 0 ? upper : static_cast<std::size_t>(skeleton.parents[upper]);
  const auto parent =
      skeleton.parents[upper] < 0 ? Quaternion<double>::identity() : to_quaternion(world.rotation[above]);
  const auto upper_now = aim * at_upper * to_quaternion(world.rotation[upper]);
  const auto middle_now = aim * at_upper * at_middle * to_quaternion(world.rotation[middle]);
  pose[upper] = normalized(inverse(parent) * upper_now);
  pose[middle] = normalized(inverse(upper_now) * middle_now);
  pose[end] = normalized(inverse(middle_now) * to_quaternion(world.rotation[end]));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// A leg and its toe.
struct Leg {
  Limb limb;
  int toe = 0;
};
inline constexpr Leg smpl_legs[] = {{{1, 4, 7}, 10}, {{2, 5, 8}, 11}};

struct FootFixOptions {
  double floor = 0;
  double ankle_height = smpl_ankle_contact, toe_height = smpl_toe_contact;  // below: in contact
  double speed = 0.5;       // m/s; lock_feet takes a foot that slides faster to swing
  double path_speed = 2;    // m/s; path_from_feet takes no foot that slides faster to carry the body
  double path_sigma = 1.5;  // frames; smoothness of the correction of the path
  Index blend = 4;          // frames before and after a contact in which the leg comes and goes
  double clearance = 0.03;  // m; toes swing this high above where they stand; in recorded walks mostly 2.7 to 5.5 cm
};

namespace detail {

/// Throws config_error 103 unless the skeleton has these legs.
inline void require_legs(std::string_view function, const Skeleton& skeleton, std::span<const Leg> legs) {
  for (const Leg& leg : legs) {
    require_limb(function, skeleton, leg.limb);
    if (leg.toe < 0 || leg.toe >= skeleton.size())
      raise<config_error>(103, function, ": toe ", leg.toe, " of a skeleton of ", skeleton.size());
  }
}

/// The two joints of a leg that may stand: ankle and toe.
inline std::array<ContactJoint, 2> feet_of(const Leg& leg, const FootFixOptions& options) {
  return {{{leg.limb.end, options.ankle_height}, {leg.toe, options.toe_height}}};
}

}  // namespace detail

/// The clip with its path over the floor corrected so that the foot that stands (of the low ones the slowest) does not
/// slide: where somebody goes is decided by the legs. Rotations and heights stay; in the air the path stays, too.
/// Throws config_error 103 if the skeleton has no such legs, 101 unless path_sigma > 0.
inline Motion path_from_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                             const FootFixOptions& options = {}) {
  detail::require_legs("path_from_feet", motion.skeleton, legs);
  const Index joints = motion.skeleton.size(), steps = motion.frames() - 1;
  if (steps < 1) return motion;
  const auto positions = motion.positions();
  std::vector<double> wanted;  // (steps, 3): x, z, weight
  for (Index f = 0; f < steps; ++f) {
    std::optional<detail::Slide> slowest;
    for (const Leg& leg : legs) {
      for (const ContactJoint& foot : detail::feet_of(leg, options)) {
        const auto s = detail::slide(positions, joints, f, foot, options.floor);
        const bool stands = s.low && s.length() * motion.fps < options.path_speed;
        if (stands && (!slowest || s.length() < slowest->length())) slowest = s;
      }
    }
    if (slowest)
      wanted.insert(wanted.end(), {slowest->step.x, slowest->step.z, 1.0});
    else
      wanted.insert(wanted.end(), {0.0, 0.0, 0.0});
  }
  const auto smooth = gaussian_smooth(std::span<const double>(wanted), 3, options.path_sigma);
  Motion out = motion;
  Vec3<double> moved{};
  for (Index f = 0; f < steps; ++f) {
    const double* s = smooth.data() + 3 * f;
    const double weight = std::max(s[2], 0.25);  // few contacts near: less
    moved = moved - Vec3<double>{s[0] / weight, 0, s[1] / weight};
    auto& root = out.root[static_cast<std::size_t>(f) + 1];
    root = root + moved;
  }
  return out;
}

namespace detail {

/// (frames): how far a foot that stands slides to the next frame, on its toe or its ankle, whichever carries it. Nothing
/// for a foot that swings, and in the last frame.
inline std::vector<std::optional<Vec3<double>>> standing_steps(const Motion& motion,
                                                               std::span<const Vec3<double>> positions, const Leg& leg,
                                                               const FootFixOptions& options) {
  std::vector<std::optional<Vec3<double>>> steps(static_cast<std::size_t>(motion.frames()));
  const auto [ankle_joint, toe_joint] = feet_of(leg, options);
  for (Index f = 0; f + 1 < motion.frames(); ++f) {
    const auto ankle = slide(positions, motion.skeleton.size(), f, ankle_joint, options.floor),
               toe = slide(positions, motion.skeleton.size(), f, toe_joint, options.floor);
    const auto& pivot = toe.low && (!ankle.low || toe.length() < ankle.length()) ? toe : ankle;
    if (pivot.low && pivot.length() * motion.fps < options.speed) steps[static_cast<std::size_t>(f)] = pivot.step;
  }
  return steps;
}

/// Moves the foot of a leg in every frame by its offset.
inline void move_foot(Motion& motion, const Leg& leg, std::span<const Vec3<double>> offset) {
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    const Vec3<double> by = offset[static_cast<std::size_t>(f)];
    if (norm(by) < 1e-6) continue;
    motion.world(f, world);
    const Vec3<double> target = world.position[static_cast<std::size_t>(leg.limb.end)] + by;
    const Vec3<double> forward = world.rotation[static_cast<std::size_t>(leg.limb.upper)] * Vec3<double>{0, 0, 1};
    reach(motion.skeleton, motion.rotations(f), world, leg.limb, target, forward);
  }
}

/// (frames): by how much a foot has to be raised so that its toe swings `clearance` above the lower of the heights where
/// it left the floor and where it comes back. One bump sin^2 for each swing, no higher than that or a tenth of its way: a foot
/// that only trembles is left alone.
inline std::vector<Vec3<double>> swing_lifts(const Motion& motion, std::span<const Vec3<double>> positions,
                                             const Leg& leg, const FootFixOptions& options) {
  const Index frames = motion.frames(), joints = motion.skeleton.size();
  const auto standing = standing_steps(motion, positions, leg, options);
  auto toe = [&](Index f) { return positions[static_cast<std::size_t>(f * joints + leg.toe)]; };
  std::vector<Vec3<double>> lift(static_cast<std::size_t>(frames));
  for (Index first = 0; first + 1 < frames; ++first) {  // first: the last frame in which the foot stands
    if (standing[static_cast<std::size_t>(first)]) continue;
    Index last = first + 1;  // the next frame in which it stands
    while (last + 1 < frames && !standing[static_cast<std::size_t>(last)]) ++last;
    const bool from_floor = first > 0, to_floor = last + 1 < frames;
    auto bump = [&](Index f) {  // at an end of the clip the foot is in mid-swing
      const double t = static_cast<double>(f - first) / static_cast<double>(last - first);
      const double s = std::sin(std::numbers::pi * (from_floor && to_floor ? t : from_floor ? t / 2 : (1 - t) / 2));
      return s * s;
    };
    if (from_floor || to_floor) {
      const double from = toe(first).y, to = toe(last).y;
      const double level = options.clearance + (!to_floor ? from : !from_floor ? to : std::min(from, to));
      double height = 0, way = 0;
      for (Index f = first; f <= last; ++f) {
        if (bump(f) > 0.5) height = std::max(height, (level - toe(f).y) / bump(f));
        if (f > first) way += norm(Vec3<double>{toe(f).x - toe(f - 1).x, 0, toe(f).z - toe(f - 1).z});
      }
      height = std::min({height, options.clearance, way / 10});
      for (Index f = first; f <= last; ++f) lift[static_cast<std::size_t>(f)].y = height * bump(f);
    }
    first = last - 1;
  }
  return lift;
}

/// (frames): by how much a foot has to be moved to stay where it stands. During a contact the offset undoes the slide; its
/// mean is zero, so that the foot stands where it was on average. Between contacts it fades out and in.
inline std::vector<Vec3<double>> foot_offsets(const Motion& motion, std::span<const Vec3<double>> positions,
                                              const Leg& leg, const FootFixOptions& options) {
  const Index frames = motion.frames();
  const auto standing = standing_steps(motion, positions, leg, options);
  std::vector<std::uint8_t> fixed(standing.size(), 0);
  std::vector<Vec3<double>> offset(standing.size());
  for (std::size_t f = 0; f < standing.size(); ++f) {
    if (!standing[f]) continue;
    const std::size_t first = f;
    Vec3<double> sum{};
    for (; standing[f]; ++f) {  // nothing in the last frame
      offset[f + 1] = offset[f] - *standing[f];
      sum = sum + offset[f + 1];
    }
    const Vec3<double> mean = (1.0 / static_cast<double>(f - first + 1)) * sum;
    for (std::size_t i = first; i <= f; ++i) offset[i] = offset[i] - mean, fixed[i] = 1;
  }
  for (Index f = 0; f < frames; ++f) {
    if (fixed[static_cast<std::size_t>(f)] != 0) continue;
    double share = 0;
    auto fade = [&](Index direction) {  // from the nearest contact on one side
      for (Index d = 1; d <= options.blend; ++d) {
        const Index from = f + direction * d;
        if (from < 0 || from >= frames) break;
        if (fixed[static_cast<std::size_t>(from)] == 0) continue;
        const double weight = smoothstep(1 - static_cast<double>(d) / static_cast<double>(options.blend + 1));
        share += weight;
        return weight * offset[static_cast<std::size_t>(from)];
      }
      return Vec3<double>{};
    };
    const Vec3<double> both = fade(-1) + fade(1);
    offset[static_cast<std::size_t>(f)] = (1 / std::max(share, 1.0)) * both;  // contacts that are near: their mean
  }
  return offset;
}

}  // namespace detail

/// The clip with legs bent so that ankles and toes in contact stay in place. Between contacts the correction fades out
/// and in. Throws config_error 103 if the skeleton has no such legs, numeric_error 302 if a leg has no length.
inline Motion lock_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                        const FootFixOptions& options = {}) {
  detail::require_legs("lock_feet", motion.skeleton, legs);
  if (motion.frames() < 2) return motion;
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) detail::move_foot(out, leg, detail::foot_offsets(motion, positions, leg, options));
  return out;
}

/// The clip with legs bent so that a foot swings over the floor, not along it: generated ones pass too low. A foot that
/// stands is not moved. Throws as lock_feet.
inline Motion raise_swings(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                           const FootFixOptions& options = {}) {
  detail::require_legs("raise_swings", motion.skeleton, legs);
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) detail::move_foot(out, leg, detail::swing_lifts(motion, positions, leg, options));
  return out;
}

/// path_from_feet, lock_feet, raise_swings. Throws what they throw.
inline Motion fix_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                       const FootFixOptions& options = {}) {
  return raise_swings(lock_feet(path_from_feet(motion, legs, options), legs, options), legs, options);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_LANES_HPP  // <motionlang/kinematics/lanes.hpp>
#define MOTIONLANG_HAS_KINEMATICS_LANES_HPP
/// Forward kinematics of a whole batch: the function of forward.hpp over many poses at once.
///
///     auto joints = forward_kinematics(skeleton, lanes(rot6d, root));     // (batch, time, joints, 3)
///
/// On a bare backend eight poses at a time go through SIMD registers (Lane), on all threads. On an Autodiff backend every number
/// is a tensor over batch and time, so that the result can be differentiated.

namespace motionlang::inline MOTIONLANG_ABI {

/// Poses of a batch: rotations as their first two rows, and root positions.
template <Backend B>
struct LanePoses {
  Tensor<B, 4> rot6d;  // (batch, time, joints, 6)
  Tensor<B, 3> root;   // (batch, time, 3)
};
/// Throws shape_error 204 if the two do not fit.
template <Backend B>
LanePoses<B> lanes(Tensor<B, 4> rot6d, Tensor<B, 3> root) {
  if (rot6d.size(3) != 6 || root.shape() != Shape{rot6d.size(0), rot6d.size(1), 3}) {
    raise<shape_error>(204, "lanes: rotations ", rot6d.shape(), ", root ", root.shape());
  }
  return {std::move(rot6d), std::move(root)};
}

namespace detail {

/// Lane::size poses from pose `first` on; poses behind `count` repeat the last one and are not stored.
template <Scalar S>
void forward_kinematics_lane(const Skeleton& skeleton, const S* rot6d, const S* root, Index first, Index count,
                             S* joints, std::vector<Rotation6dRows<Lane<S>>>& local, JointTransforms<Lane<S>>& world) {
  const auto n = static_cast<std::size_t>(skeleton.size());
  local.resize(n);
  Vec3<Lane<S>> place;
  auto coordinates = [](auto& v) { return std::array{&v.x, &v.y, &v.z}; };
  for (int i = 0; i < Lane<S>::size; ++i) {
    const Index pose = std::min(first + i, count - 1);
    const S* at = rot6d + pose * static_cast<Index>(6 * n);
    for (std::size_t j = 0; j < n; ++j, at += 6) {
      const auto a = coordinates(local[j].a), b = coordinates(local[j].b);
      for (std::size_t c = 0; c < 3; ++c) (*a[c])[i] = at[c], (*b[c])[i] = at[3 + c];
    }
    const auto p = coordinates(place);
    for (std::size_t c = 0; c < 3; ++c) (*p[c])[i] = root[3 * pose + static_cast<Index>(c)];
  }
  forward_kinematics(skeleton, std::span<const Rotation6dRows<Lane<S>>>(local), place, world);
  for (int i = 0; i < Lane<S>::size && first + i < count; ++i) {
    S* to = joints + (first + i) * static_cast<Index>(3 * n);
    for (std::size_t j = 0; j < n; ++j, to += 3)
      to[0] = world.position[j].x[i], to[1] = world.position[j].y[i], to[2] = world.position[j].z[i];
  }
}

}  // namespace detail

/// Plain arrays: rot6d (poses, joints, 6), root (poses, 3) -> joints (poses, joints, 3). Throws shape_error 205.
template <Scalar S>
void forward_kinematics(const Skeleton& skeleton, std::span<const S> rot6d, std::span<const S> root,
                        std::span<S> joints) {
  const Index n = skeleton.size(), poses = static_cast<Index>(root.size()) / 3;
  if (static_cast<Index>(rot6d.size()) != 6 * n * poses || static_cast<Index>(joints.size()) != 3 * n * poses ||
      root.size() % 3 != 0) {
    raise<shape_error>(205, "forward_kinematics: ", rot6d.size(), " rotation values, ", root.size(), " root values, ",
                       joints.size(), " joint values for ", n, " joints");
  }
  constexpr Index block = 64 * Lane<S>::size;
  parallel_for((poses + block - 1) / block, [&](Index b) {
    std::vector<Rotation6dRows<Lane<S>>> local;
    JointTransforms<Lane<S>> world;
    for (Index first = b * block; first < std::min(poses, (b + 1) * block); first += Lane<S>::size) {
      detail::forward_kinematics_lane(skeleton, rot6d.data(), root.data(), first, poses, joints.data(), local, world);
    }
  });
}

/// -> (batch, time, joints, 3). Throws shape_error 204 if the number of joints is another.
template <Backend B>
Tensor<B, 4> forward_kinematics(const Skeleton& skeleton, const LanePoses<B>& poses) {
  const Index batch = poses.rot6d.size(0), time = poses.rot6d.size(1), n = poses.rot6d.size(2);
  if (n != skeleton.size())
    raise<shape_error>(204, "forward_kinematics: rotations ", poses.rot6d.shape(), " for ", skeleton.size(), " joints");
  if constexpr (AutodiffBackend<B>) {
    using T = Tensor<B, 2>;
    auto number = [&](Index joint, Index c) {
      return reshape<2>(slice(slice(poses.rot6d, 2, joint, joint + 1), 3, c, c + 1), {batch, time});
    };
    auto vector = [&](Index joint, Index c) {
      return Vec3<T>{number(joint, c), number(joint, c + 1), number(joint, c + 2)};
    };
    std::vector<Rotation6dRows<T>> local;
    for (Index j = 0; j < n; ++j) local.push_back({vector(j, 0), vector(j, 3)});
    auto root = [&](Index c) { return reshape<2>(slice(poses.root, 2, c, c + 1), {batch, time}); };
    const auto world =
        forward_kinematics(skeleton, std::span<const Rotation6dRows<T>>(local), Vec3<T>{root(0), root(1), root(2)});
    std::vector<Tensor<B, 3>> numbers;
    for (const auto& p : world.position) {
      for (const T* c : {&p.x, &p.y, &p.z}) numbers.push_back(reshape<3>(*c, {batch, time, 1}));
    }
    return reshape<4>(concat(std::span<const Tensor<B, 3>>(numbers), 2), {batch, time, n, 3});
  } else {
    using S = typename B::scalar;
    PoolVector<S> joints(static_cast<std::size_t>(batch * time * n * 3));
    forward_kinematics<S>(skeleton, poses.rot6d.span(), poses.root.span(), std::span<S>(joints));
    return Tensor<B, 4>::from(std::span<const S>(joints), {batch, time, n, 3});
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_LOOPS_HPP  // <motionlang/kinematics/loops.hpp>
#define MOTIONLANG_HAS_KINEMATICS_LOOPS_HPP
/// Cycles in a clip (steps, waving, breathing) and clips made longer by going round them.

namespace motionlang::inline MOTIONLANG_ABI {

/// Frames first and last look alike, so that after `last - 1` the clip may go on at `first`.
struct Loop {
  Index first = 0, last = 0;
  double cost = 0;  // mean distance of joints, metres, velocities included
};

namespace detail {

/// Rotation about the vertical that a quaternion contains.
inline double heading(const Quaternion<double>& q) { return 2 * std::atan2(q.y, q.w); }
inline Quaternion<double> turn(double angle) { return from_axis_angle(Vec3<double>{0, 1, 0}, angle); }

/// Joint positions with the root's place and heading removed, (frames, joints).
inline std::vector<Vec3<double>> poses_in_place(const Motion& motion) {
  std::vector<Vec3<double>> out;
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    const auto back = turn(-heading(motion.rotations(f)[0]));
    const Vec3<double> place{motion.root_at(f).x, 0, motion.root_at(f).z};
    for (const auto& p : world.position) out.push_back(rotate(back, p - place));
  }
  return out;
}

}  // namespace detail

/// The best cycle of at least `least` frames, if its cost is below `most` metres.
///     cost(a, b) = mean over joints of |p_a - p_b| + 0.1 s |v_a - v_b|
inline std::optional<Loop> find_loop(const Motion& motion, Index least, double most = 0.08) {
  const auto poses = detail::poses_in_place(motion);
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  auto at = [&](Index frame, std::size_t joint) { return poses[static_cast<std::size_t>(frame) * joints + joint]; };
  std::optional<Loop> best;
  for (Index a = 0; a + least + 1 < motion.frames(); ++a) {
    for (Index b = a + least; b + 1 < motion.frames(); ++b) {
      double cost = 0;
      for (std::size_t j = 0; j < joints; ++j) {
        cost +=
            norm(at(a, j) - at(b, j)) + 0.1 * motion.fps * norm((at(a + 1, j) - at(a, j)) - (at(b + 1, j) - at(b, j)));
      }
      cost /= static_cast<double>(joints);
      if (cost < (best ? best->cost : most)) best = Loop{a, b, cost};
    }
  }
  return best;
}

/// The clip up to loop.last, then round the loop until there are `frames` frames. Each round goes on from where the last one was,
/// in its direction; what is left of the difference between the ends fades away over `blend` frames.
inline Motion go_round(const Motion& motion, const Loop& loop, Index frames, Index blend = 8) {
  if (loop.first < 0 || loop.last <= loop.first || loop.last >= motion.frames()) {
    raise<config_error>(101, "go_round: loop ", loop.first, " ... ", loop.last, " in ", motion.frames(), " frames");
  }
  Motion out{motion.skeleton, motion.fps, {}, {}, motion.name};
  Quaternion<double> turned = Quaternion<double>::identity();  // of the present round in the world
  Vec3<double> place{};
  std::vector<Quaternion<double>> difference(static_cast<std::size_t>(motion.skeleton.size()),
                                             Quaternion<double>::identity());
  double height = 0;
  Index since = blend;  // frames since the last seam
  for (Index from = 0; out.frames() < frames; ++from, ++since) {
    if (from == loop.last) {
      // The frame that is due (last, in the present round) and the one that comes instead (first).
      const auto due = motion.rotations(loop.last), comes = motion.rotations(loop.first);
      const Vec3<double> at = place + rotate(turned, motion.root_at(loop.last));
      turned = turned * detail::turn(detail::heading(due[0]) - detail::heading(comes[0]));
      const Vec3<double> start = rotate(turned, motion.root_at(loop.first));
      place = {at.x - start.x, 0, at.z - start.z};
      height = motion.root_at(loop.last).y - motion.root_at(loop.first).y;
      for (std::size_t j = 0; j < difference.size(); ++j) difference[j] = due[j] * inverse(comes[j]);
      const auto spin = detail::turn(detail::heading(due[0]) - detail::heading(comes[0]));  // already in `turned`
      difference[0] = inverse(spin) * due[0] * inverse(comes[0]);
      from = loop.first;
      since = 0;
    }
    const double left =
        since >= blend
            ? 0
            : 0.5 * (1 + std::cos(std::numbers::pi * static_cast<double>(since) / static_cast<double>(blend)));
    Vec3<double> root = place + rotate(turned, motion.root_at(from));
    root.y = motion.root_at(from).y + left * height;
    out.root.push_back(root);
    const auto pose = motion.rotations(from);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const auto faded = slerp(Quaternion<double>::identity(), difference[j], left) * pose[j];
      out.local.push_back(j == 0 ? turned * faded : faded);
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_MIRROR_JOINTS_HPP  // <motionlang/kinematics/mirror_joints.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MIRROR_JOINTS_HPP
/// Joint positions in a mirror that stands in the plane x = 0: how HumanML3D doubles its clips. Of whole motions, with
/// rotations: motion_tools.hpp.
///
/// Source  Guo et al. (CVPR 2022), raw_pose_processing.ipynb swap_left_right; spec humanml3d-features.md 8

namespace motionlang::inline MOTIONLANG_ABI {

/// Partners of the 22 joints of HumanML3D or the 52 of SMPL-H. The published list of the fingers pairs wrong ones (the
/// left index finger with the right little one, ...); `fix_fingers` pairs the right ones.
/// Throws config_error 101 for another number of joints.
inline std::vector<int> humanml3d_mirror_partners(int joints, bool fix_fingers = false) {
  if (joints != 22 && joints != 52) raise<config_error>(101, "humanml3d_mirror_partners: ", joints, " joints");
  std::vector<int> out(smpl_mirror_joint.begin(), smpl_mirror_joint.begin() + 22);
  if (joints == 22) return out;
  // First joints of the fingers of three joints: left index, thumb, middle, ring, little finger, and their partners.
  constexpr std::array<int, 5> left{22, 34, 25, 31, 28}, published{43, 46, 40, 37, 49}, right{37, 49, 40, 46, 43};
  out.resize(52);
  for (std::size_t finger = 0; finger < 5; ++finger) {
    for (int k = 0; k < 3; ++k) {
      const int l = left[finger] + k, r = (fix_fingers ? right : published)[finger] + k;
      out[static_cast<std::size_t>(l)] = r;
      out[static_cast<std::size_t>(r)] = l;
    }
  }
  return out;
}

/// joints (frames, joints) -> the same, p'_partner(j) = (-x, y, z)_j. Throws shape_error 205, config_error 102 if the
/// partners do not pair up.
template <Scalar S>
std::vector<Vec3<S>> mirror_joints(std::span<const Vec3<S>> joints, std::span<const int> partners) {
  const std::size_t n = partners.size();
  if (n == 0 || joints.size() % n != 0) {
    raise<shape_error>(205, "mirror_joints: ", joints.size(), " positions for frames of ", n, " joints");
  }
  for (std::size_t j = 0; j < n; ++j) {
    const auto p = static_cast<std::size_t>(partners[j]);
    if (p >= n || partners[p] != static_cast<int>(j)) {
      raise<config_error>(102, "mirror_joints: the partner of joint ", j, " is ", partners[j],
                          ", which has another partner");
    }
  }
  std::vector<Vec3<S>> out(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Vec3<S>& p = joints[i];
    out[i - i % n + static_cast<std::size_t>(partners[i % n])] = {-p.x, p.y, p.z};
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_OVERLAY_HPP  // <motionlang/kinematics/overlay.hpp>
#define MOTIONLANG_HAS_KINEMATICS_OVERLAY_HPP
/// Two motions in one body: some parts move as in one clip, the rest as in another.

#ifndef MOTIONLANG_HAS_KINEMATICS_STANDARD_HPP  // <motionlang/kinematics/standard.hpp>
#define MOTIONLANG_HAS_KINEMATICS_STANDARD_HPP
/// The skeletons of the field: names, order and parents as published; the bone lengths are those of a neutral figure of
/// our own (1.75 m), so that no licensed body model is needed. Rest pose: standing, arms to the sides, Y up, facing +Z,
/// left at +X, metres.

namespace motionlang::inline MOTIONLANG_ABI {

// clang-format off
/// SMPL, 24 joints. Source: Loper et al. 2015; names as in the smplx package.
inline const Skeleton& smpl24_skeleton() {
  static const Skeleton skeleton = Skeleton::from_joints({
      {"pelvis", "", {0, 0.95, 0}},
      {"left_hip", "pelvis", {0.09, -0.06, 0}},        {"right_hip", "pelvis", {-0.09, -0.06, 0}},
      {"spine1", "pelvis", {0, 0.11, 0}},
      {"left_knee", "left_hip", {0, -0.41, 0}},        {"right_knee", "right_hip", {0, -0.41, 0}},
      {"spine2", "spine1", {0, 0.13, 0}},
      {"left_ankle", "left_knee", {0, -0.41, 0}},      {"right_ankle", "right_knee", {0, -0.41, 0}},
      {"spine3", "spine2", {0, 0.06, 0}},
      {"left_foot", "left_ankle", {0, -0.06, 0.14}},   {"right_foot", "right_ankle", {0, -0.06, 0.14}},
      {"neck", "spine3", {0, 0.22, 0}},
      {"left_collar", "spine3", {0.07, 0.13, 0}},      {"right_collar", "spine3", {-0.07, 0.13, 0}},
      {"head", "neck", {0, 0.10, 0.02}},
      {"left_shoulder", "left_collar", {0.11, 0.03, 0}},  {"right_shoulder", "right_collar", {-0.11, 0.03, 0}},
      {"left_elbow", "left_shoulder", {0.27, 0, 0}},   {"right_elbow", "right_shoulder", {-0.27, 0, 0}},
      {"left_wrist", "left_elbow", {0.25, 0, 0}},      {"right_wrist", "right_elbow", {-0.25, 0, 0}},
      {"left_hand", "left_wrist", {0.08, 0, 0}},       {"right_hand", "right_wrist", {-0.08, 0, 0}},
  });
  return skeleton;
}

/// HumanML3D, 22 joints: SMPL without the hands.
inline const Skeleton& humanml3d22_skeleton() {
  static const Skeleton skeleton = [] {
    Skeleton s = smpl24_skeleton();
    s.names.resize(22), s.parents.resize(22), s.offsets.resize(22);
    return s;
  }();
  return skeleton;
}

/// KIT Motion-Language, 21 joints of the Master Motor Map. Here in metres; the data set's own coordinates are in other units.
inline const Skeleton& kit21_skeleton() {
  static const Skeleton skeleton = Skeleton::from_joints({
      {"root", "", {0, 0.95, 0}},
      {"BP", "root", {0, 0.11, 0}},     {"BT", "BP", {0, 0.19, 0}},     {"BLN", "BT", {0, 0.22, 0}},      {"BUN", "BLN", {0, 0.10, 0}},
      {"LS", "BLN", {0.18, -0.06, 0}},  {"LE", "LS", {0.27, 0, 0}},     {"LW", "LE", {0.25, 0, 0}},
      {"RS", "BLN", {-0.18, -0.06, 0}}, {"RE", "RS", {-0.27, 0, 0}},    {"RW", "RE", {-0.25, 0, 0}},
      {"LH", "root", {0.09, -0.06, 0}}, {"LK", "LH", {0, -0.41, 0}},    {"LA", "LK", {0, -0.41, 0}},
      {"LMrot", "LA", {0, -0.06, 0.04}},{"LF", "LMrot", {0, 0, 0.10}},
      {"RH", "root", {-0.09, -0.06, 0}},{"RK", "RH", {0, -0.41, 0}},    {"RA", "RK", {0, -0.41, 0}},
      {"RMrot", "RA", {0, -0.06, 0.04}},{"RF", "RMrot", {0, 0, 0.10}},
  });
  return skeleton;
}
// clang-format on

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// `base` with the local rotations of `parts` taken from `other`, frame by frame, as long as both last. The path, the height and
/// everything else are the base's. SMPL's joints only, or the first of them (HumanML3D). Throws config_error 103 for
/// another skeleton.
/// Source  the synthetic training data of SINC (Athanasiou et al. 2023), section 4.1, on rotations
inline Motion overlay_parts(const Motion& base, const Motion& other, BodyParts parts) {
  const auto& names = base.skeleton.names;
  const auto& smpl = smpl24_skeleton().names;
  if (names != other.skeleton.names || names.size() > smpl.size() ||
      !std::equal(names.begin(), names.end(), smpl.begin())) {
    raise<config_error>(103, "overlay_parts: '", base.name, "' and '", other.name,
                        "' are not on one skeleton of SMPL's joints");
  }
  Motion out = base;
  const Index frames = std::min(base.frames(), other.frames());
  out.root.resize(static_cast<std::size_t>(frames));
  out.local.resize(static_cast<std::size_t>(frames * base.skeleton.size()));
  for (Index f = 0; f < frames; ++f) {
    const auto from = other.rotations(f);
    const auto to = out.rotations(f);
    for (std::size_t j = 1; j < to.size(); ++j) {
      if (parts.has(smpl_part_of_joint[j])) to[j] = from[j];
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_RETARGET_HPP  // <motionlang/kinematics/retarget.hpp>
#define MOTIONLANG_HAS_KINEMATICS_RETARGET_HPP
/// Retargeting: the same movement on another skeleton, from and to every kind that skeleton_tables.hpp knows.
///
///     G_t(f) = G_s(f) C_s^-1 C_t
/// G_s, G_t: world rotations of a joint s of the source and of the joint t of the target that follows it. C_t: the world
/// rotation of t while the target stands in its T-pose, facing +Z; C_s: that of s while the source stands as the target
/// does then, its limbs along the target's limbs. A source in that pose so gives the target's T-pose, whatever the local
/// axes and the rest poses (T, A, any quarter turn), and chains may have different numbers of joints. Bones keep the
/// target's lengths; the path is scaled by the ratio of the legs.

namespace motionlang::inline MOTIONLANG_ABI {

/// What a map did with the joints of both skeletons.
struct RetargetReport {
  std::string table, target_table;                          // the kinds of source and target
  std::vector<std::pair<std::string, std::string>> mapped;  // joint of the target, joint (or "a + b") of the source
  std::vector<std::string> unmapped;                        // joints of the target that stay at rest
  std::vector<std::string> unused;                          // joints of the source that nothing follows
  double leg_ratio = 1, arm_ratio = 1;  // target / source, 0 without arms; the path is scaled by leg_ratio
};
inline std::string to_string(const RetargetReport& r) {
  auto list = [](const std::vector<std::string>& names) {
    std::string out;
    for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
    return out.empty() ? std::string("none") : out;
  };
  auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
  std::vector<std::string> pairs;
  for (const auto& [to, from] : r.mapped) pairs.push_back(from + " -> " + to);
  return concat_text(r.table, " -> ", r.target_table, ": ", r.mapped.size(), " of ",
                     r.mapped.size() + r.unmapped.size(), " joints follow, legs x ", rounded(r.leg_ratio), ", arms x ",
                     rounded(r.arm_ratio), "\n  mapped: ", list(pairs), "\n  target joints at rest: ", list(r.unmapped),
                     "\n  source joints not used: ", list(r.unused));
}

namespace detail {

/// The limb joints whose bones are turned to the target's direction in the rest pose, with the joint where each ends.
struct LimbBone {
  std::string_view joint, end;
};
inline constexpr std::array<LimbBone, 4> leg_bones{{{"left_hip", "left_knee"},
                                                    {"left_knee", "left_ankle"},
                                                    {"right_hip", "right_knee"},
                                                    {"right_knee", "right_ankle"}}};
inline constexpr std::array<LimbBone, 4> arm_bones{{{"left_shoulder", "left_elbow"},
                                                    {"left_elbow", "left_wrist"},
                                                    {"right_shoulder", "right_elbow"},
                                                    {"right_elbow", "right_wrist"}}};
inline constexpr std::array<LimbBone, 2> hand_bones{{{"left_wrist", "left_hand"}, {"right_wrist", "right_hand"}}};

inline const LimbBone* find_limb_bone(std::string_view joint) {
  for (const std::span<const LimbBone> bones : {std::span<const LimbBone>(leg_bones), {arm_bones}, {hand_bones}}) {
    for (const LimbBone& bone : bones) {
      if (bone.joint == joint) return &bone;
    }
  }
  return nullptr;
}

inline Vec3<double> local_axis(std::string_view signed_letter) {
  const double sign = signed_letter[0] == '-' ? -1 : 1;
  const char c = signed_letter[1];
  return {c == 'x' ? sign : 0, c == 'y' ? sign : 0, c == 'z' ? sign : 0};
}
/// World rotation of a joint in a T-pose, from "+x+y": its local axes that point left and up.
inline Quaternion<double> axes_rotation(const MappedJoint& joint) {
  const std::string_view axes = joint.axes;
  if (axes.size() != 4 || axes[0] >= 'x' || axes[2] >= 'x' || axes.find_first_not_of("+-xyz") != axes.npos ||
      axes[1] == axes[3] || axes[1] < 'x' || axes[3] < 'x') {
    raise<config_error>(103, "SkeletonTable: '", axes, "' of '", joint.source, "' does not name two axes");
  }
  const Vec3<double> left = local_axis(axes.substr(0, 2)), up = local_axis(axes.substr(2, 2));
  const auto frame = to_quaternion(Matrix3<double>::from_rows(left, up, cross(left, up)));
  return to_quaternion(AxisAngle<double>{(std::numbers::pi / 180) * joint.turn}) * frame;
}

/// A skeleton as its table sees it, standing in its T-pose (what limbs do not point to the sides or down is told by
/// `bone`), turned by quarters of a circle about y until its left is nearest to +X.
class StandingSkeleton {
 public:
  Skeleton skeleton;
  SkeletonTable table;
  std::vector<Quaternion<double>> rotation;  // of each joint in the world

  StandingSkeleton(const Skeleton& s, const SkeletonTable& t) : skeleton(s), table(t) {
    const auto joints = static_cast<std::size_t>(skeleton.size());
    rotation.assign(joints, Quaternion<double>::identity());
    position_.assign(joints, {});
    std::vector<bool> given(joints, false);
    for (const MappedJoint& m : table.joints) {
      const int j = find_joint(skeleton, m.source);
      if (j < 0) continue;
      rotation[static_cast<std::size_t>(j)] = axes_rotation(m);
      given[static_cast<std::size_t>(j)] = true;
    }
    for (std::size_t j = 1; j < joints; ++j) {
      const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
      if (!given[j]) rotation[j] = rotation[parent];
      position_[j] = position_[parent] + rotate(rotation[parent], skeleton.offsets[j]);
    }
    face_forward();
  }

  /// The joint with a role, a name of SMPL's; -1 if there is none.
  int joint(std::string_view role) const {
    const MappedJoint* row = table.find(role);
    return row == nullptr ? -1 : find_joint(skeleton, row->source);
  }
  /// The role of a joint: that which it fills with the largest share, of several the last. "" if it has none.
  std::string role(int joint) const {
    std::string best;
    double largest = 0;
    for (const MappedJoint& m : table.joints) {
      const double share = find_joint(skeleton, m.source) == joint                        ? 1 - m.share
                           : !m.second.empty() && find_joint(skeleton, m.second) == joint ? m.share
                                                                                          : 0;
      if (share > 0 && share >= largest) best = m.target, largest = share;
    }
    return best;
  }
  /// A bone of a limb; zero without its joints. Where the table says that the zero pose is the T-pose although bones
  /// are not straight: as in SMPL.
  Vec3<double> bone(const LimbBone& limb) const {
    const int a = joint(limb.joint), b = joint(limb.end);
    if (a < 0 || b < 0) return {};
    if (!table.straighten) return smpl24_skeleton().offset(smpl24_skeleton()[limb.end]);
    return position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)];
  }
  double length(const LimbBone& limb) const {
    const int a = joint(limb.joint), b = joint(limb.end);
    if (a < 0 || b < 0) return 0;
    return norm(position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)]);
  }

 private:
  void face_forward() {
    const int left = joint("left_hip"), right = joint("right_hip");
    if (left < 0 || right < 0) return;
    const auto across = position_[static_cast<std::size_t>(left)] - position_[static_cast<std::size_t>(right)];
    constexpr double quarter = std::numbers::pi / 2;
    const double quarters = std::round(std::atan2(-across.z, across.x) / quarter);
    if (quarters == 0) return;
    const auto back = from_axis_angle(Vec3<double>{0, 1, 0}, -quarters * quarter);
    for (Quaternion<double>& q : rotation) q = back * q;
    for (Vec3<double>& p : position_) p = rotate(back, p);
  }

  std::vector<Vec3<double>> position_;
};

}  // namespace detail

/// How one skeleton follows another; made once, used for every clip.
class SkeletonMap {
 public:
  /// Throws config_error 103 with the name of a joint that the source's table needs and the source lacks (or, for axes
  /// that are none, or hips that a skeleton has not), 101 if the legs of a skeleton have no length.
  SkeletonMap(const Skeleton& source, const SkeletonTable& source_table, const Skeleton& target,
              const SkeletonTable& target_table)
      : source_(source), target_(target) {
    const std::string missing = source_table.missing(source);
    if (!missing.empty())
      raise<config_error>(103, "SkeletonMap: ", source_table.name, " needs a joint '", missing, "'");
    report_.table = source_table.name;
    report_.target_table = target_table.name;
    const detail::StandingSkeleton from(source, source_table), to(target, target_table);
    connect(from, to);
    measure(from, to);
  }
  /// The target has SMPL's names.
  SkeletonMap(const Skeleton& source, const Skeleton& target, const SkeletonTable& source_table)
      : SkeletonMap(source, source_table, target, skeleton_table("SMPL")) {}
  /// With the built-in tables that fit.
  explicit SkeletonMap(const Skeleton& source, const Skeleton& target = smpl24_skeleton())
      : SkeletonMap(source, detect_skeleton_table(source), target, detect_skeleton_table(target)) {}

  const Skeleton& source() const { return source_; }
  const Skeleton& target() const { return target_; }
  const RetargetReport& report() const { return report_; }

  /// One frame: world transforms of the source to root position and local rotations of the target.
  void apply(const JointTransforms<double>& from, Vec3<double>& root, std::span<Quaternion<double>> local) const {
    std::vector<Quaternion<double>> world(links_.size());
    for (std::size_t t = 0; t < links_.size(); ++t) {
      const Link& link = links_[t];
      const int parent = target_.parents[t];
      const auto up = parent < 0 ? Quaternion<double>::identity() : world[static_cast<std::size_t>(parent)];
      world[t] = up * link.at_rest;
      if (link.source >= 0) world[t] = turned(from, link.source, link.undo);
      if (link.second >= 0) world[t] = slerp(world[t], turned(from, link.second, link.undo_second), link.share);
      local[t] = inverse(up) * world[t];
    }
    const Vec3<double> middle = 0.5 * (position(from, left_hip_) + position(from, right_hip_));
    root =
        report_.leg_ratio * middle - 0.5 * (from_root(target_left_hip_, world) + from_root(target_right_hip_, world));
  }

 private:
  struct Link {
    int source = -1, second = -1;
    Quaternion<double> undo{1, 0, 0, 0}, undo_second{1, 0, 0, 0};  // C_s^-1 C_t
    Quaternion<double> at_rest{1, 0, 0, 0};                        // of a joint that follows none, seen from its parent
    double share = 0;
  };

  static Quaternion<double> turned(const JointTransforms<double>& from, int joint, const Quaternion<double>& undo) {
    return to_quaternion(from.rotation[static_cast<std::size_t>(joint)]) * undo;
  }
  static const Vec3<double>& position(const JointTransforms<double>& from, int joint) {
    return from.position[static_cast<std::size_t>(joint)];
  }
  /// A joint of the target seen from its root.
  Vec3<double> from_root(int joint, const std::vector<Quaternion<double>>& world) const {
    Vec3<double> p{};
    for (; target_.parent(joint) >= 0; joint = target_.parent(joint)) {
      p = p + rotate(world[static_cast<std::size_t>(target_.parent(joint))], target_.offset(joint));
    }
    return p;
  }

  void connect(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
    links_.resize(static_cast<std::size_t>(target_.size()));
    std::vector<bool> used(static_cast<std::size_t>(source_.size()), false);
    // of the bones of the source, from its T-pose to the target's
    std::vector<Quaternion<double>> turn(links_.size(), Quaternion<double>::identity());
    for (std::size_t t = 0; t < links_.size(); ++t) {
      Link& link = links_[t];
      const int parent = target_.parents[t];
      const auto up = parent < 0 ? Quaternion<double>::identity() : turn[static_cast<std::size_t>(parent)];
      const std::string role = to.role(static_cast<int>(t));
      turn[t] = bone_turn(role, from, to, up);
      if (parent >= 0) link.at_rest = inverse(to.rotation[static_cast<std::size_t>(parent)]) * to.rotation[t];
      auto follow = [&](int s) {
        used[static_cast<std::size_t>(s)] = true;
        return inverse(turn[t] * from.rotation[static_cast<std::size_t>(s)]) * to.rotation[t];
      };
      const MappedJoint* row = role.empty() ? nullptr : from.table.find(role);
      link.source = row == nullptr ? -1 : find_joint(source_, row->source);
      if (link.source < 0) {
        report_.unmapped.push_back(target_.names[t]);
        continue;
      }
      link.undo = follow(link.source);
      std::string name = source_.name(link.source);
      if (!row->second.empty()) {
        link.second = find_joint(source_, row->second);
        link.undo_second = follow(link.second);
        link.share = row->share;
        name += " + " + source_.name(link.second);
      }
      report_.mapped.emplace_back(target_.names[t], std::move(name));
    }
    for (std::size_t s = 0; s < used.size(); ++s) {
      if (!used[s]) report_.unused.push_back(source_.names[s]);
    }
  }

  /// The rotation that brings a joint of the source from its T-pose to the pose in which it stands like the target.
  /// Limbs are turned along, joint by joint; feet only roll with their shins, unless a table says that they stand level,
  /// so that soles stay level; the trunk is taken as it stands.
  static Quaternion<double> bone_turn(std::string_view role, const detail::StandingSkeleton& from,
                                      const detail::StandingSkeleton& to, const Quaternion<double>& up) {
    if (const detail::LimbBone* limb = detail::find_limb_bone(role)) {
      const Vec3<double> bone = from.bone(*limb), wanted = to.bone(*limb);
      if (norm(bone) < 1e-9 || norm(wanted) < 1e-9) return up;
      return rotation_between(rotate(up, bone), wanted) * up;
    }
    if (role == "left_ankle" || role == "right_ankle") {
      const detail::LimbBone shin{role == "left_ankle" ? "left_knee" : "right_knee", role};
      auto roll = [&](const detail::StandingSkeleton& s) {
        const Vec3<double> bone = s.bone(shin);
        return s.table.level_soles ? 0 : std::atan2(bone.x, -bone.y);
      };
      return from_axis_angle(Vec3<double>{0, 0, 1}, roll(to) - roll(from));
    }
    const bool follows = role.empty() || role.ends_with("_foot") || role.ends_with("_hand");
    return follows ? up : Quaternion<double>::identity();
  }

  /// Lengths of legs and arms, and where the hips are.
  void measure(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
    auto hip = [](const detail::StandingSkeleton& s, std::string_view role) {
      const int j = s.joint(role);
      if (j < 0) raise<config_error>(103, "SkeletonMap: ", s.table.name, " has no '", role, "'");
      return j;
    };
    left_hip_ = hip(from, "left_hip");
    right_hip_ = hip(from, "right_hip");
    target_left_hip_ = hip(to, "left_hip");
    target_right_hip_ = hip(to, "right_hip");
    auto ratio = [&](std::span<const detail::LimbBone> bones) {  // over the bones that both skeletons have
      double here = 0, there = 0;
      for (const detail::LimbBone& bone : bones) {
        const double length = from.length(bone), wanted = to.length(bone);
        if (length > 0 && wanted > 0) here += wanted, there += length;
      }
      return there > 0 ? here / there : 0;
    };
    report_.leg_ratio = ratio(detail::leg_bones);
    report_.arm_ratio = ratio(detail::arm_bones);
    if (!(report_.leg_ratio > 0) || !std::isfinite(report_.leg_ratio)) {
      raise<config_error>(101, "SkeletonMap: legs of no length (target / source = ", report_.leg_ratio, ")");
    }
  }

  Skeleton source_, target_;
  RetargetReport report_;
  std::vector<Link> links_;  // of the target's joints
  int left_hip_ = -1, right_hip_ = -1, target_left_hip_ = -1, target_right_hip_ = -1;
};

/// Moves a clip up or down so that its feet stand on y = 0 as they do in the rest pose: the lowest joint of a frame, in
/// all but the lowest 5 % of the frames, is not below the lowest joint at rest. Returns by how much it was moved.
inline double place_on_floor(Motion& motion) {
  if (motion.frames() == 0) return 0;
  auto lowest = [](std::span<const Vec3<double>> joints) {
    return std::min_element(joints.begin(), joints.end(), [](auto& a, auto& b) { return a.y < b.y; })->y;
  };
  const auto rest = motion.skeleton.rest_positions(), positions = motion.positions();
  std::vector<double> heights;
  for (std::size_t at = 0; at < positions.size(); at += rest.size()) {
    heights.push_back(lowest(std::span(positions).subspan(at, rest.size())));
  }
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 20);
  std::nth_element(heights.begin(), low, heights.end());
  const double shift = lowest(rest) - *low;
  for (Vec3<double>& r : motion.root) r.y += shift;
  return shift;
}

struct RetargetOptions {
  bool floor = true;  // place_on_floor
};

/// The clip on the target of the map. Throws config_error 106 if its skeleton is not the source of the map.
inline Motion retarget(const Motion& motion, const SkeletonMap& map, const RetargetOptions& options = {}) {
  if (motion.skeleton.names != map.source().names || motion.skeleton.parents != map.source().parents) {
    raise<config_error>(106, "retarget: '", motion.name, "' has another skeleton than the map was made for");
  }
  Motion out{map.target(), motion.fps, {}, {}, motion.name};
  out.root.resize(motion.root.size());
  out.local.resize(motion.root.size() * static_cast<std::size_t>(out.skeleton.size()));
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    map.apply(world, out.root[static_cast<std::size_t>(f)], out.rotations(f));
  }
  if (options.floor) place_on_floor(out);
  return out;
}
/// With the built-in tables that fit the clip and the target. Throws config_error 103 with the joint that is missing.
inline Motion retarget(const Motion& motion, const Skeleton& target = smpl24_skeleton(),
                       const RetargetOptions& options = {}) {
  return retarget(motion, SkeletonMap(motion.skeleton, target), options);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_SMOOTH_MOTION_HPP  // <motionlang/kinematics/smooth_motion.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SMOOTH_MOTION_HPP
/// A clip without its trembling. Slow movement, peaks and the ends of the clip stay where they are.

namespace motionlang::inline MOTIONLANG_ABI {

struct SmoothOptions {
  /// Seconds. At 20 frames per second and 0.04 s a movement of 2.5 Hz keeps 98 % of its size, one of 5 Hz 82 %, one of
  /// 10 Hz 35 %. Heels and toes strike the floor at such rates: more makes feet slide.
  double sigma = 0.04;
};

namespace detail {

/// The weights c of x_{first} ... x_{last} (0 is the frame itself) in the value at 0 of the parabola that fits them best,
/// errors weighted by exp(-k^2 / (2 sigma^2)). They sum to 1, and a parabola is its own fit: so peaks are not blunted and
/// ends are not pulled. Fewer than three values: the frame itself.
///     c_k = w_k (1 0 0) M^-1 (1, k, k^2)^T,   M_ab = sum_k w_k k^(a + b)
/// Source  Savitzky and Golay (1964); with Gaussian weights local regression, Cleveland (1979)
inline std::vector<double> parabola_weights(Index first, Index last, double sigma) {
  std::vector<double> c;
  std::array<double, 5> s{};
  for (Index k = first; k <= last; ++k) {
    const auto x = static_cast<double>(k);
    c.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
    double power = c.back();
    for (double& sum : s) sum += power, power *= x;
  }
  const std::array<double, 3> row{s[2] * s[4] - s[3] * s[3], s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] * s[2]};
  const double determinant = s[0] * row[0] + s[1] * row[1] + s[2] * row[2];
  for (Index k = first; k <= last; ++k) {
    const auto x = static_cast<double>(k);
    double& weight = c[static_cast<std::size_t>(k - first)];
    if (last - first < 2)
      weight = k == 0 ? 1 : 0;
    else
      weight *= (row[0] + row[1] * x + row[2] * x * x) / determinant;
  }
  return c;
}

}  // namespace detail

/// The clip with its root positions and local rotations smoothed along time by local parabolas. Rotations are averaged
/// where they are: as rotation vectors seen from the frame itself.
///     p'_f = sum_k c_k p_{f+k},   q'_f = q_f exp(sum_k c_k log(q_f^-1 q_{f+k})),   |k| <= floor(4 sigma fps + 1/2)
/// With fewer than two neighbours on each side within reach nothing changes.
/// Throws config_error 101 unless sigma >= 0.
inline Motion smooth_motion(const Motion& motion, const SmoothOptions& options = {}) {
  const double sigma = options.sigma * motion.fps;  // frames
  if (!(sigma >= 0) || !std::isfinite(sigma)) raise<config_error>(101, "smooth_motion: sigma ", options.sigma, " s");
  const auto radius = static_cast<Index>(std::min(4 * sigma + 0.5, static_cast<double>(motion.frames())));
  if (radius < 2) return motion;
  const auto inner = detail::parabola_weights(-radius, radius, sigma);
  Motion out = motion;
  for (Index f = 0; f < motion.frames(); ++f) {
    const Index first = std::max(-radius, -f), last = std::min(radius, motion.frames() - 1 - f);
    const auto c = last - first == 2 * radius ? inner : detail::parabola_weights(first, last, sigma);
    auto weight = [&](Index k) { return c[static_cast<std::size_t>(k - first)]; };
    Vec3<double> root{};
    for (Index k = first; k <= last; ++k) root = root + weight(k) * motion.root_at(f + k);
    out.root[static_cast<std::size_t>(f)] = root;
    const auto here = motion.rotations(f);
    for (std::size_t j = 0; j < here.size(); ++j) {
      const Quaternion<double> undo = inverse(here[j]);
      Vec3<double> turn{};
      for (Index k = first; k <= last; ++k) {
        if (k != 0) turn = turn + weight(k) * log_so3(undo * motion.rotations(f + k)[j]);
      }
      out.rotations(f)[j] = normalized(here[j] * to_quaternion(AxisAngle<double>{turn}));
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_KINEMATICS_UNIFORM_SKELETON_HPP  // <motionlang/kinematics/uniform_skeleton.hpp>
#define MOTIONLANG_HAS_KINEMATICS_UNIFORM_SKELETON_HPP
/// Joint positions of anybody on a skeleton of given bone lengths: every bone keeps its direction, the path of the root
/// is scaled with the length of the leg.
///
///     scale = (thigh + shank of the target) / (thigh + shank of frame 0)
///     X_0 = scale p_0,   X_j = X_parent(j) + length_j (p_j - p_parent(j)) / |p_j - p_parent(j)|
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb uniform_skeleton; spec humanml3d-features.md 3. The
///         published code goes there and back through rotations, which cancel; its NaN for a bone opposite to its zero
///         direction is not reproduced here.

namespace motionlang::inline MOTIONLANG_ABI {

template <Scalar S>
struct UniformJoints {
  std::vector<Vec3<S>> joints;  // (frames, joints)
  S scale{};                    // of the root's path
};

/// joints   (frames, joints)
/// lengths  (joints), of the target's bones
/// The result stands at its own height; no floor is looked for. Of no frames: nothing, scale 0.
/// Throws   shape_error 204, 205, config_error 106, numeric_error 301 for a bone that is not finite, 302 for one of
///          length 0
template <Scalar S>
UniformJoints<S> uniform_skeleton(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                  std::span<const S> lengths) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("uniform_skeleton", skeleton, joints);
  if (lengths.size() != n) {
    raise<shape_error>(204, "uniform_skeleton: ", lengths.size(), " lengths for ", n, " joints");
  }
  UniformJoints<S> out{std::vector<Vec3<S>>(joints.size()), S(0)};
  if (frames == 0) return out;
  const auto source = bone_lengths(skeleton, joints.first(n));
  auto leg = [&](const auto& of) {
    return detail::joint_of(of.data(), skeleton.leg[0]) + detail::joint_of(of.data(), skeleton.leg[1]);
  };
  out.scale = leg(lengths) / leg(source);
  const auto bones = skeleton.bones();
  for (std::size_t t = 0; t < frames; ++t) {
    Vec3<S>* to = &out.joints[t * n];
    to[0] = out.scale * joints[t * n];
    for (const ChainBone& b : bones) {
      const auto [v, length] = detail::measure_bone(skeleton, b, &joints[t * n], t);
      to[b.joint] = to[b.parent] + (lengths[b.joint] / length) * v;
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_DROPOUT_HPP  // <motionlang/nn/dropout.hpp>
#define MOTIONLANG_HAS_NN_DROPOUT_HPP
/// Dropout that runs only when the call brings a generator.

namespace motionlang::inline MOTIONLANG_ABI {

/// The next mask of a context: probability 0 when there is no generator.
inline Dropout next_dropout(double p, const Context& context) {
  if (!context.dropout || p == 0) return {};
  const Philox g = context.next_mask();
  return {.p = p, .key = g.stream ^ (g.seed * 0x9E3779B97F4A7C15u)};
}
template <Backend B, int R>
Tensor<B, R> dropout(const Tensor<B, R>& x, double p, const Context& context) {
  return dropout(x, next_dropout(p, context));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_EMBEDDING_HPP  // <motionlang/nn/embedding.hpp>
#define MOTIONLANG_HAS_NN_EMBEDDING_HPP
/// A learned row for every symbol.

#ifndef MOTIONLANG_HAS_NN_INIT_HPP  // <motionlang/nn/init.hpp>
#define MOTIONLANG_HAS_NN_INIT_HPP
/// Initial values of parameters, as PyTorch draws them (the distributions, not the same numbers).

namespace motionlang::inline MOTIONLANG_ABI {

/// A generator that gives zeros at no cost: for models whose parameters are about to be loaded.
struct NoInit {
  template <class S>
  void normal(std::span<S> out) {
    std::fill(out.begin(), out.end(), S(0));
  }
  template <class S>
  void uniform(std::span<S> out) {
    std::fill(out.begin(), out.end(), S(0));
  }
  NoInit split(std::string_view) const { return {}; }
  NoInit split(std::uint64_t) const { return {}; }
};
static_assert(Rng<NoInit>);

namespace detail {

/// Zeros that take no memory before somebody reads them, where the backend's tensors can lie in memory of others.
template <Backend B, int R>
Tensor<B, R> untouched_zeros(const Shape& shape) {
  using S = typename B::scalar;
  if constexpr (AutodiffBackend<B>) {
    return Tensor<B, R>(B::variable(untouched_zeros<typename B::inner, R>(shape).data()));
  } else if constexpr (std::is_constructible_v<typename B::tensor, const S*, Shape, std::shared_ptr<const void>>) {
    const std::shared_ptr<void> zeros(std::calloc(static_cast<std::size_t>(shape.count()) + 1, sizeof(S)), std::free);
    if (zeros == nullptr) throw std::bad_alloc();
    return Tensor<B, R>(typename B::tensor(static_cast<const S*>(zeros.get()), shape, zeros));
  } else {
    return Tensor<B, R>::zeros(shape);
  }
}

template <class G>
inline constexpr bool is_no_init = std::is_same_v<std::remove_cvref_t<G>, NoInit>;

}  // namespace detail

/// Uniform in [-bound, bound].
template <Backend B, int R>
Tensor<B, R> uniform_init(const Shape& shape, double bound, Rng auto& rng) {
  if constexpr (detail::is_no_init<decltype(rng)>) return detail::untouched_zeros<B, R>(shape);
  std::vector<typename B::scalar> values(static_cast<std::size_t>(shape.count()));
  rng.uniform(std::span<typename B::scalar>(values));
  for (auto& v : values) v = static_cast<typename B::scalar>((2 * static_cast<double>(v) - 1) * bound);
  Tensor<B, R> t = Tensor<B, R>::from(values, shape);
  if constexpr (AutodiffBackend<B>) t = Tensor<B, R>(B::variable(B::value(t.data())));
  return t;
}
/// Glorot and Bengio (2010): bound sqrt(6 / (fan in + fan out)). shape is (out, in).
template <Backend B>
Tensor<B, 2> xavier_uniform(const Shape& shape, Rng auto& rng) {
  return uniform_init<B, 2>(shape, std::sqrt(6.0 / static_cast<double>(shape[0] + shape[1])), rng);
}
/// Normal with the given standard deviation.
template <Backend B, int R>
Tensor<B, R> normal_init(const Shape& shape, double std, Rng auto& rng) {
  if constexpr (detail::is_no_init<decltype(rng)>) return detail::untouched_zeros<B, R>(shape);
  std::vector<typename B::scalar> values(static_cast<std::size_t>(shape.count()));
  rng.normal(std::span<typename B::scalar>(values));
  for (auto& v : values) v = static_cast<typename B::scalar>(static_cast<double>(v) * std);
  Tensor<B, R> t = Tensor<B, R>::from(values, shape);
  if constexpr (AutodiffBackend<B>) t = Tensor<B, R>(B::variable(B::value(t.data())));
  return t;
}
template <Backend B, int R>
Tensor<B, R> constant_init(const Shape& shape, double value) {
  Tensor<B, R> t = Tensor<B, R>::full(shape, value);
  if constexpr (AutodiffBackend<B>) t = Tensor<B, R>(B::variable(B::value(t.data())));
  return t;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B>
struct Embedding {
  Tensor<B, 2> weight;  // (symbols, width)

  static constexpr auto fields() { return motionlang::fields("weight", &Embedding::weight); }

  Embedding() = default;
  Embedding(Index symbols, Index width, Rng auto& rng, double std = 1)
      : weight(normal_init<B, 2>({symbols, width}, std, rng)) {}

  /// ids -> (ids, width). Throws shape_error 203 for an unknown symbol.
  Tensor<B, 2> operator()(std::span<const Index> ids) const { return gather(weight, ids); }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_GRU_HPP  // <motionlang/nn/gru.hpp>
#define MOTIONLANG_HAS_NN_GRU_HPP
/// Gated recurrent unit, several layers, PyTorch's gates and names.

#ifndef MOTIONLANG_HAS_NN_LINEAR_HPP  // <motionlang/nn/linear.hpp>
#define MOTIONLANG_HAS_NN_LINEAR_HPP
/// Linear layer: y = x W^T + b.

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B>
struct Linear {
  Tensor<B, 2> weight;  // (out, in)
  Tensor<B, 1> bias;    // (out)

  static constexpr auto fields() { return motionlang::fields("weight", &Linear::weight, "bias", &Linear::bias); }

  Linear() = default;
  /// PyTorch's initialisation: weight and bias uniform within 1 / sqrt(in).
  Linear(Index in, Index out, Rng auto& rng)
      : weight(uniform_init<B, 2>({out, in}, 1 / std::sqrt(static_cast<double>(in)), rng)),
        bias(uniform_init<B, 1>({out}, 1 / std::sqrt(static_cast<double>(in)), rng)) {}

  Index in() const { return weight.size(1); }
  Index out() const { return weight.size(0); }

  /// x (rows, in) -> act(x W^T + b) + residual, (rows, out)
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, Activation act = Activation::none,
                          const Tensor<B, 2>* residual = nullptr) const {
    return linear(x, weight, &bias, act, residual);
  }
  Sequences<B> operator()(const Sequences<B>& x, Activation act = Activation::none) const {
    return x.with((*this)(x.rows, act));
  }
  /// Any leading axes: (..., in) -> (..., out)
  template <int R>
  requires(R == 1 || R > 2) Tensor<B, R>
  operator()(const Tensor<B, R>& x, Activation act = Activation::none) const {
    const Shape s = x.shape();
    Shape to = s;
    to[R - 1] = out();
    const Tensor<B, 2> rows(B::reshape(x.data(), Shape{s.count(0, R - 1), s[R - 1]}));
    return Tensor<B, R>(B::reshape((*this)(rows, act).data(), to));
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

///     r = sig(W_ir x + b_ir + W_hr h + b_hr),  z = sig(W_iz x + b_iz + W_hz h + b_hz),
///     n = tanh(W_in x + b_in + r (W_hn h + b_hn)),  h' = (1 - z) n + z h
/// Source  Cho et al. (2014) with PyTorch's placement of r. Rows of the weights: r, z, n.
template <Backend B>
struct GruLayer {
  Tensor<B, 2> weight_ih, weight_hh;  // (3 hidden, in), (3 hidden, hidden)
  Tensor<B, 1> bias_ih, bias_hh;      // (3 hidden)

  static constexpr auto fields() {
    using M = GruLayer;
    return motionlang::fields("weight_ih", &M::weight_ih, "weight_hh", &M::weight_hh, "bias_ih", &M::bias_ih, "bias_hh",
                              &M::bias_hh);
  }
  GruLayer() = default;
  GruLayer(Index in, Index hidden, Rng auto& rng) {
    const double bound = 1 / std::sqrt(static_cast<double>(hidden));
    weight_ih = uniform_init<B, 2>({3 * hidden, in}, bound, rng);
    weight_hh = uniform_init<B, 2>({3 * hidden, hidden}, bound, rng);
    bias_ih = uniform_init<B, 1>({3 * hidden}, bound, rng);
    bias_hh = uniform_init<B, 1>({3 * hidden}, bound, rng);
  }

  Index hidden() const { return weight_hh.size(1); }

  /// x: one (rows, in) per time step; h0 (rows, hidden) -> one (rows, hidden) per step
  std::vector<Tensor<B, 2>> operator()(const std::vector<Tensor<B, 2>>& x, const Tensor<B, 2>& h0) const {
    const Index n = hidden();
    Tensor<B, 2> h = h0;
    std::vector<Tensor<B, 2>> out;
    for (const auto& step : x) {
      const auto i = linear(step, weight_ih, &bias_ih), g = linear(h, weight_hh, &bias_hh);
      auto sigmoid = [](const Tensor<B, 2>& t) { return 1.0 / (exp(-t) + 1.0); };
      const auto r = sigmoid(slice(i, 1, 0, n) + slice(g, 1, 0, n));
      const auto z = sigmoid(slice(i, 1, n, 2 * n) + slice(g, 1, n, 2 * n));
      const auto candidate = tanh(slice(i, 1, 2 * n, 3 * n) + r * slice(g, 1, 2 * n, 3 * n));
      h = (1.0 - z) * candidate + z * h;
      out.push_back(h);
    }
    return out;
  }
};

/// A stack of layers; every layer starts from zeros. Official keys are weight_ih_l0, ...: see `gru_key`.
template <Backend B>
struct Gru {
  std::vector<GruLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &Gru::layers); }

  Gru() = default;
  Gru(Index in, Index hidden, Index count, Rng auto& rng) {
    for (Index i = 0; i < count; ++i) layers.emplace_back(i == 0 ? in : hidden, hidden, rng);
  }
  std::vector<Tensor<B, 2>> operator()(std::vector<Tensor<B, 2>> x) const {
    for (const auto& layer : layers) {
      if (!x.empty()) x = layer(x, Tensor<B, 2>::zeros({x.front().size(0), layer.hidden()}));
    }
    return x;
  }
};

/// "gru.layers.2.weight_ih" -> "gru.weight_ih_l2": PyTorch numbers the parameters instead of nesting them. Other paths
/// stay.
inline std::string gru_key(const std::string& path) {
  constexpr std::string_view nested = "gru.layers.";
  if (!path.starts_with(nested)) return path;
  const auto dot = path.find('.', nested.size());
  return "gru." + path.substr(dot + 1) + "_l" + path.substr(nested.size(), dot - nested.size());
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_LAYER_NORM_HPP  // <motionlang/nn/layer_norm.hpp>
#define MOTIONLANG_HAS_NN_LAYER_NORM_HPP
/// Layer normalisation with gain and bias.

namespace motionlang::inline MOTIONLANG_ABI {

/// Ba, Kiros, Hinton (2016). eps = 1e-5, as everywhere in the published systems.
template <Backend B>
struct LayerNorm {
  Tensor<B, 1> weight, bias;  // (width)
  double eps = 1e-5;

  static constexpr auto fields() {
    return motionlang::fields("weight", &LayerNorm::weight, "bias", &LayerNorm::bias, "eps", &LayerNorm::eps);
  }
  LayerNorm() = default;
  explicit LayerNorm(Index width) : weight(constant_init<B, 1>({width}, 1)), bias(constant_init<B, 1>({width}, 0)) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x) const { return layer_norm(x, weight, bias, eps); }
  /// The norm of x + residual.
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Tensor<B, 2>& residual) const {
    return add_layer_norm(x, residual, weight, bias, eps);
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_LINEAR_ATTENTION_HPP  // <motionlang/nn/linear_attention.hpp>
#define MOTIONLANG_HAS_NN_LINEAR_ATTENTION_HPP
/// Attention whose cost grows linearly with the length (MotionDiffuse's "efficient attention").

namespace motionlang::inline MOTIONLANG_ABI {

/// Per head: softmax of q over its channels, softmax of k over time, A = k^T v, y = q A.
/// Source  Shen et al. (2021), "Efficient attention", as used by MotionDiffuse (Zhang et al. 2022), section 3.3
/// Shapes  q (query rows, width), k and v (key rows, width) -> (query rows, width)
template <Backend B>
Tensor<B, 2> linear_attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v,
                              const Offsets& q_offsets, const Offsets& k_offsets, Index heads) {
  detail::check_attention(q, k, v, q_offsets, k_offsets, {.heads = heads});
  const Index d = q.size(1), width = d / heads;
  const auto channels = reshape<2>(softmax(reshape<2>(q, {q.size(0) * heads, width})), {q.size(0), d});
  PoolVector<Tensor<B, 2>> sequences;
  for (Index s = 0; s < q_offsets.count(); ++s) {
    const auto qs = slice(channels, 0, q_offsets.begin(s), q_offsets.end(s));
    const auto kt = softmax(transpose(slice(k, 0, k_offsets.begin(s), k_offsets.end(s))));  // (width, time)
    const auto vs = slice(v, 0, k_offsets.begin(s), k_offsets.end(s));
    PoolVector<Tensor<B, 2>> parts;
    for (Index h = 0; h < heads; ++h) {
      const auto a = matmul(slice(kt, 0, h * width, (h + 1) * width), slice(vs, 1, h * width, (h + 1) * width));
      parts.push_back(matmul(slice(qs, 1, h * width, (h + 1) * width), a));
    }
    sequences.push_back(concat(std::span<const Tensor<B, 2>>(parts), 1));
  }
  return concat(std::span<const Tensor<B, 2>>(sequences), 0);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_MULTIHEAD_ATTENTION_HPP  // <motionlang/nn/multihead_attention.hpp>
#define MOTIONLANG_HAS_NN_MULTIHEAD_ATTENTION_HPP
/// Multi-head attention with PyTorch's packing of the projections.

namespace motionlang::inline MOTIONLANG_ABI {

/// Throws config_error 101 if the heads do not divide the width. In a constant expression the compiler refuses it.
constexpr void check_heads(Index width, Index heads) {
  if (heads < 1 || width % heads != 0) {
    raise<config_error>(101, "MultiheadAttention: ", heads, " heads do not divide width ", width);
  }
}

/// Vaswani et al. (2017), section 3.2.2. `in_proj_weight` (3 width, width) holds the rows of query, key and value in
/// that order.
template <Backend B>
struct MultiheadAttention {
  Tensor<B, 2> in_proj_weight;
  Tensor<B, 1> in_proj_bias;
  Linear<B> out_proj;
  Index heads = 1;
  double dropout_p = 0.1;  // on the attention weights

  static constexpr auto fields() {
    using M = MultiheadAttention;
    return motionlang::fields("in_proj_weight", &M::in_proj_weight, "in_proj_bias", &M::in_proj_bias, "out_proj",
                              &M::out_proj, "heads", &M::heads, "dropout_p", &M::dropout_p);
  }
  MultiheadAttention() = default;
  /// Throws config_error 101 if the heads do not divide the width.
  MultiheadAttention(Index width, Index heads_, double dropout, Rng auto& rng)
      : in_proj_weight(xavier_uniform<B>({3 * width, width}, rng)),
        in_proj_bias(constant_init<B, 1>({3 * width}, 0)),
        out_proj(width, width, rng),
        heads(heads_),
        dropout_p(dropout) {
    check_heads(width, heads);
    out_proj.bias = constant_init<B, 1>({width}, 0);
  }

  /// x (rows, width) attends to itself within each sequence; the result is projected and `residual` added.
  Tensor<B, 2> self(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context,
                    const Tensor<B, 2>* residual = nullptr, bool causal = false) const {
    const auto qkv = linear(x, in_proj_weight, &in_proj_bias);
    return out_proj(
        self_attention(qkv, offsets, {.heads = heads, .causal = causal, .dropout = next_dropout(dropout_p, context)}),
        Activation::none, residual);
  }
  /// x attends to `memory`. Where every memory has one row, softmax over one key is 1 and the result is that row's
  /// value.
  Tensor<B, 2> cross(const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                     const Context& context) const {
    const Index d = x.size(1);
    auto project = [&](const Tensor<B, 2>& t, Index first, Index last) {
      const auto bias = slice(in_proj_bias, 0, first * d, last * d);
      return linear(t, slice(in_proj_weight, 0, first * d, last * d), &bias);
    };
    const auto q = project(x, 0, 1), k = project(memory.rows, 1, 2), v = project(memory.rows, 2, 3);
    return out_proj(
        attention(q, k, v, offsets, memory.offsets, {.heads = heads, .dropout = next_dropout(dropout_p, context)}));
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_POOLING_HPP  // <motionlang/nn/pooling.hpp>
#define MOTIONLANG_HAS_NN_POOLING_HPP
/// From the vectors of all tokens to one vector for each text.

#ifndef MOTIONLANG_HAS_NN_TEXT_FEATURES_HPP  // <motionlang/nn/text_features.hpp>
#define MOTIONLANG_HAS_NN_TEXT_FEATURES_HPP
/// What a text encoder gives and a denoiser takes: some token vectors for every text.

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B>
struct TextFeatures {
  Sequences<B> tokens;                // one sequence per text; a pooled encoder gives one row each
  std::vector<Index> end_position{};  // of each text: the row of its end token, for models that read it (MotionDiffuse)

  Index count() const { return tokens.count(); }

  /// From one vector per text.
  static TextFeatures pooled(const Tensor<B, 2>& rows) { return {{rows, Offsets::equal(rows.size(0), 1)}}; }
};

/// Texts picked by number, with repetition.
template <Backend B>
TextFeatures<B> gather(const TextFeatures<B>& text, std::span<const Index> which) {
  PoolVector<Index> rows, lengths;
  TextFeatures<B> out;
  for (Index i : which) {
    if (i < 0 || i >= text.count()) raise<shape_error>(203, "gather: text ", i, " of ", text.count());
    lengths.push_back(text.tokens.offsets.length(i));
    for (Index r = text.tokens.offsets.begin(i); r < text.tokens.offsets.end(i); ++r) rows.push_back(r);
    if (!text.end_position.empty()) out.end_position.push_back(text.end_position[static_cast<std::size_t>(i)]);
  }
  out.tokens = {gather(text.tokens.rows, rows), Offsets(std::span<const Index>(lengths))};
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// The mean of each sequence, (sequences, width); zeros for an empty one.
template <Backend B>
Tensor<B, 2> mean_rows(const Sequences<B>& x) {
  std::vector<typename B::scalar> share;
  for (Index i = 0; i < x.count(); ++i)
    share.push_back(static_cast<typename B::scalar>(1 / std::max(1.0, static_cast<double>(x.offsets.length(i)))));
  return scatter_add(x.rows, sequence_of_row(x.offsets), x.count()) * Tensor<B, 2>::from(share, {x.count(), 1});
}

/// One row of each sequence, `at[i]` of sequence i. Throws shape_error 203 if there is no such row, 204 if the counts differ.
template <Backend B>
Tensor<B, 2> pick_rows(const Sequences<B>& x, std::span<const Index> at) {
  if (static_cast<Index>(at.size()) != x.count())
    raise<shape_error>(204, "pick_rows: ", at.size(), " places for ", x.count(), " sequences");
  PoolVector<Index> rows;
  for (Index i = 0; i < x.count(); ++i) {
    const Index row = at[static_cast<std::size_t>(i)];
    if (row < 0 || row >= x.offsets.length(i))
      raise<shape_error>(203, "pick_rows: row ", row, " of ", x.offsets.length(i), " in sequence ", i);
    rows.push_back(x.offsets.begin(i) + row);
  }
  return gather(x.rows, rows);
}

/// What becomes of the tokens of a text: all stay; their mean; the first one ([CLS]); the end token, which is the last one where the
/// network does not say.
enum class Pooling { none, mean, first, end };

/// (texts, width). Throws config_error 101 for Pooling::none, shape_error 203 for a text without tokens.
template <Backend B>
Tensor<B, 2> pool(const TextFeatures<B>& text, Pooling pooling) {
  if (pooling == Pooling::none) raise<config_error>(101, "pool: Pooling::none has no vector for a text");
  if (pooling == Pooling::mean) return mean_rows(text.tokens);
  if (pooling == Pooling::end && !text.end_position.empty()) return pick_rows(text.tokens, text.end_position);
  std::vector<Index> at;
  for (Index i = 0; i < text.count(); ++i)
    at.push_back(pooling == Pooling::first ? 0 : text.tokens.offsets.length(i) - 1);
  return pick_rows(text.tokens, at);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_POSITIONAL_ENCODING_HPP  // <motionlang/nn/positional_encoding.hpp>
#define MOTIONLANG_HAS_NN_POSITIONAL_ENCODING_HPP
/// Sinusoidal positions.

namespace motionlang::inline MOTIONLANG_ABI {

///     pe[p, 2i] = sin(p w_i),   pe[p, 2i + 1] = cos(p w_i),   w_i = exp(-2i ln(10000) / width)
/// Source  Vaswani et al. (2017), section 3.5. Every intermediate is rounded to float, as in the published tables,
///         whose last digits depend on it. Throws config_error 101 for an odd width.
template <Backend B>
Tensor<B, 2> sinusoidal_positions(Index rows, Index width) {
  if (width % 2 != 0) raise<config_error>(101, "sinusoidal_positions: odd width ", width);
  std::vector<typename B::scalar> table(static_cast<std::size_t>(rows * width));
  const auto c = static_cast<float>(-std::log(10000.0) / static_cast<double>(width));
  for (Index i = 0; i < width / 2; ++i) {
    const float w = std::exp(static_cast<float>(2 * i) * c);
    for (Index p = 0; p < rows; ++p) {
      const float angle = static_cast<float>(p) * w;
      auto* at = &table[static_cast<std::size_t>(p * width + 2 * i)];
      at[0] = static_cast<typename B::scalar>(std::sin(angle));
      at[1] = static_cast<typename B::scalar>(std::cos(angle));
    }
  }
  return Tensor<B, 2>::from(table, {rows, width});
}

/// The table of a model: computed from its size, so it is neither saved nor loaded.
template <Backend B>
class PositionTable {
 public:
  PositionTable() = default;
  PositionTable(Index rows, Index width) : rows_(sinusoidal_positions<B>(rows, width)) {}
  template <Backend C>
  explicit PositionTable(const PositionTable<C>& other) : PositionTable(other.rows().size(0), other.rows().size(1)) {}

  const Tensor<B, 2>& rows() const { return rows_; }

 private:
  Tensor<B, 2> rows_;
};

/// Positions of a sequence that are left out, as if padding stood there: `rows` of them before row `before`.
struct PositionGap {
  Index before = 0, rows = 0;
};

/// Adds row i of the table to row i of each sequence; with `gaps`, one for each sequence, later rows move up.
/// Throws shape_error 203 for a sequence longer than the table, 204 for another number of gaps.
template <Backend B>
Sequences<B> add_positions(const Sequences<B>& x, const Tensor<B, 2>& table, std::span<const PositionGap> gaps = {}) {
  if (!gaps.empty() && static_cast<Index>(gaps.size()) != x.count()) {
    raise<shape_error>(204, "add_positions: ", gaps.size(), " gaps for ", x.count(), " sequences");
  }
  PoolVector<Index> rows;
  rows.reserve(static_cast<std::size_t>(x.offsets.rows()));
  for (Index s = 0; s < x.count(); ++s) {
    const PositionGap gap = gaps.empty() ? PositionGap{} : gaps[static_cast<std::size_t>(s)];
    for (Index i = 0; i < x.offsets.length(s); ++i) rows.push_back(i < gap.before ? i : i + gap.rows);
  }
  return x.with(gather(table, rows) + x.rows);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_TIMESTEP_EMBEDDING_HPP  // <motionlang/nn/timestep_embedding.hpp>
#define MOTIONLANG_HAS_NN_TIMESTEP_EMBEDDING_HPP
/// The token that tells a denoiser which diffusion step it is at.

namespace motionlang::inline MOTIONLANG_ABI {

///     e = W2 silu(W1 pe[t])
/// Source  MDM (Tevet et al. 2023), `TimestepEmbedder`; keys time_embed.0 and time_embed.2. The table pe is the one of
///         the positions and belongs to the caller.
template <Backend B>
struct TimestepEmbedding {
  Linear<B> in, out;

  static constexpr auto fields() {
    return motionlang::fields("time_embed.0", &TimestepEmbedding::in, "time_embed.2", &TimestepEmbedding::out);
  }
  TimestepEmbedding() = default;
  TimestepEmbedding(Index width, Rng auto& rng) : in(width, width, rng), out(width, width, rng) {}

  /// t: one step per sequence -> (sequences, width)
  Tensor<B, 2> operator()(const Tensor<B, 2>& table, std::span<const Index> t) const {
    return out(in(gather(table, t), Activation::silu));
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_NN_TRANSFORMER_DECODER_HPP  // <motionlang/nn/transformer_decoder.hpp>
#define MOTIONLANG_HAS_NN_TRANSFORMER_DECODER_HPP
/// Transformer decoder over packed sequences, post-norm (MDM's trans_dec, ACTOR, TEMOS, TMR).

#ifndef MOTIONLANG_HAS_NN_TRANSFORMER_ENCODER_HPP  // <motionlang/nn/transformer_encoder.hpp>
#define MOTIONLANG_HAS_NN_TRANSFORMER_ENCODER_HPP
/// Transformer encoder over packed sequences, post-norm or pre-norm.

namespace motionlang::inline MOTIONLANG_ABI {

struct TransformerConfig {
  Index d_model = 512;
  Index heads = 4;
  Index d_ff = 1024;
  Index layers = 8;
  Activation activation = Activation::gelu;
  bool norm_first = false;
  double dropout = 0.1;
  bool causal = false;

  /// Itself. A constant configuration is checked while compiling:
  ///     constexpr auto config = TransformerConfig{.d_model = 256, .heads = 4}.checked();
  constexpr const TransformerConfig& checked() const {
    check_heads(d_model, heads);
    return *this;
  }
};

///     post-norm   x = LN1(x + SA(x));      x = LN2(x + W2 act(W1 x))
///     pre-norm    x = x + SA(LN1 x);       x = x + W2 act(W1 LN2 x)
/// Source  Vaswani et al. (2017), section 3.1; pre-norm: Xiong et al. (2020). Parameter names of PyTorch. Dropout (only
///         with a context) after both halves, inside the feed-forward part and on the attention weights, as PyTorch has it.
template <Backend B>
struct TransformerEncoderLayer {
  MultiheadAttention<B> self_attn;
  Linear<B> linear1, linear2;
  LayerNorm<B> norm1, norm2;
  Activation activation = Activation::gelu;
  bool norm_first = false, causal = false;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = TransformerEncoderLayer;
    return motionlang::fields("self_attn", &M::self_attn, "linear1", &M::linear1, "linear2", &M::linear2, "norm1",
                              &M::norm1, "norm2", &M::norm2, "activation", &M::activation, "norm_first", &M::norm_first,
                              "causal", &M::causal, "dropout_p", &M::dropout_p);
  }
  TransformerEncoderLayer() = default;
  TransformerEncoderLayer(const TransformerConfig& c, Rng auto& rng)
      : self_attn(c.d_model, c.heads, c.dropout, rng),
        linear1(c.d_model, c.d_ff, rng),
        linear2(c.d_ff, c.d_model, rng),
        norm1(c.d_model),
        norm2(c.d_model),
        activation(c.activation),
        norm_first(c.norm_first),
        causal(c.causal),
        dropout_p(c.dropout) {}

  /// x (rows, width) -> (rows, width)
  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context = {}) const {
    if (context.dropout) return with_dropout(x, offsets, context);
    if (norm_first) {
      const auto y = self_attn.self(norm1(x), offsets, context, &x, causal);
      return linear2(linear1(norm2(y), activation), Activation::none, &y);
    }
    const auto y = norm1(self_attn.self(x, offsets, context, &x, causal));
    return norm2(linear2(linear1(y, activation), Activation::none, &y));
  }

 private:
  Tensor<B, 2> with_dropout(const Tensor<B, 2>& x, const Offsets& offsets, const Context& context) const {
    auto drop = [&](const Tensor<B, 2>& t) { return dropout(t, dropout_p, context); };
    auto attend = [&](const Tensor<B, 2>& t) { return drop(self_attn.self(t, offsets, context, nullptr, causal)); };
    auto feed_forward = [&](const Tensor<B, 2>& t) { return drop(linear2(drop(linear1(t, activation)))); };
    if (norm_first) {
      const auto y = x + attend(norm1(x));
      return y + feed_forward(norm2(y));
    }
    const auto y = norm1(attend(x), x);
    return norm2(feed_forward(y), y);
  }
};

/// A stack of layers. None of the published stacks has a final norm.
template <Backend B>
struct TransformerEncoder {
  std::vector<TransformerEncoderLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &TransformerEncoder::layers); }

  TransformerEncoder() = default;
  TransformerEncoder(const TransformerConfig& c, Rng auto& rng) {
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }

  Sequences<B> operator()(const Sequences<B>& x, const Context& context = {}) const {
    Tensor<B, 2> rows = x.rows;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const ModuleScope scope("layers.", i);
      rows = layers[i](rows, x.offsets, context);
    }
    return x.with(std::move(rows));
  }
  /// (batch, time, width), all of one length.
  Tensor<B, 3> operator()(const Tensor<B, 3>& x, const Context& context = {}) const {
    return reshape<3>((*this)(from_equal(x), context).rows, {x.size(0), x.size(1), x.size(2)});
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

///     x = LN1(x + SA(x));   x = LN2(x + CA(x, memory));   x = LN3(x + W2 act(W1 x))
/// Source  Vaswani et al. (2017), section 3.1, without the causal mask. Parameter names of PyTorch.
template <Backend B>
struct TransformerDecoderLayer {
  MultiheadAttention<B> self_attn, multihead_attn;
  Linear<B> linear1, linear2;
  LayerNorm<B> norm1, norm2, norm3;
  Activation activation = Activation::gelu;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = TransformerDecoderLayer;
    return motionlang::fields("self_attn", &M::self_attn, "multihead_attn", &M::multihead_attn, "linear1", &M::linear1,
                              "linear2", &M::linear2, "norm1", &M::norm1, "norm2", &M::norm2, "norm3", &M::norm3,
                              "activation", &M::activation, "dropout_p", &M::dropout_p);
  }
  TransformerDecoderLayer() = default;
  TransformerDecoderLayer(const TransformerConfig& c, Rng auto& rng)
      : self_attn(c.d_model, c.heads, c.dropout, rng),
        multihead_attn(c.d_model, c.heads, c.dropout, rng),
        linear1(c.d_model, c.d_ff, rng),
        linear2(c.d_ff, c.d_model, rng),
        norm1(c.d_model),
        norm2(c.d_model),
        norm3(c.d_model),
        activation(c.activation),
        dropout_p(c.dropout) {}

  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                          const Context& context = {}) const {
    auto drop = [&](const Tensor<B, 2>& t) { return dropout(t, dropout_p, context); };
    const auto y = norm1(drop(self_attn.self(x, offsets, context)), x);
    const auto z = norm2(drop(multihead_attn.cross(y, offsets, memory, context)), y);
    return norm3(drop(linear2(drop(linear1(z, activation)))), z);
  }
};

template <Backend B>
struct TransformerDecoder {
  std::vector<TransformerDecoderLayer<B>> layers;

  static constexpr auto fields() { return motionlang::fields("layers", &TransformerDecoder::layers); }

  TransformerDecoder() = default;
  TransformerDecoder(const TransformerConfig& c, Rng auto& rng) {
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }
  /// x: queries; memory: as many sequences.
  Sequences<B> operator()(const Sequences<B>& x, const Sequences<B>& memory, const Context& context = {}) const {
    Tensor<B, 2> rows = x.rows;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const ModuleScope scope("layers.", i);
      rows = layers[i](rows, x.offsets, memory, context);
    }
    return x.with(std::move(rows));
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_LOSS_INFO_NCE_HPP  // <motionlang/loss/info_nce.hpp>
#define MOTIONLANG_HAS_LOSS_INFO_NCE_HPP
/// Contrastive loss with filtered negatives (InfoNCE).

namespace motionlang::inline MOTIONLANG_ABI {

///     S_ij = cos(x_i, y_j) / tau,   S_ij = -inf where i != j and <t_i, t_j> > 2 threshold - 1
///     loss = (CE(S) + CE(S^T)) / 2,   CE(S) = mean_i (log sum_j exp(S_ij) - S_ii)
/// Source    TMR (Petrovich, Black, Varol, ICCV 2023), section 3.2
/// Notation  motion -> x, text -> y, sentence -> t (unit rows; constant), temperature -> tau
/// Shapes    x, y (batch, latent); t (batch, d), may be null: nothing is filtered -> ()
/// Differs   from the paper: threshold is given in [0, 1] and mapped to [-1, 1], as the reference code does
/// Throws    shape_error 204 if the batch sizes or the lengths of sentences differ, config_error 101 unless
///           temperature > 0
template <Backend B>
Tensor<B, 0> info_nce(const Tensor<B, 2>& x, const Tensor<B, 2>& y, double temperature,
                      const std::vector<std::vector<double>>* sentences = nullptr, double threshold = 0.8) {
  const Index n = x.size(0);
  if (y.size(0) != n || (sentences != nullptr && static_cast<Index>(sentences->size()) != n)) {
    raise<shape_error>(204, "info_nce: batches of ", x.shape(), ", ", y.shape());
  }
  if (!(temperature > 0)) raise<config_error>(101, "info_nce: temperature ", temperature);
  using S = typename B::scalar;
  std::vector<S> filter(static_cast<std::size_t>(n * n)), diagonal(filter.size());
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const auto at = static_cast<std::size_t>(i * n + j);
      diagonal[at] = i == j ? S(1) : S(0);
      if (i == j || sentences == nullptr) continue;
      const auto &a = (*sentences)[static_cast<std::size_t>(i)], &b = (*sentences)[static_cast<std::size_t>(j)];
      if (a.size() != b.size())
        raise<shape_error>(204, "info_nce: sentences of ", a.size(), " and ", b.size(), " numbers");
      double similarity = 0;
      for (std::size_t k = 0; k < a.size(); ++k) similarity += a[k] * b[k];
      if (similarity > 2 * threshold - 1) filter[at] = S(-1e30);
    }
  }
  const auto s = matmul(normalize_rows(x), normalize_rows(y), {.transpose_b = true}) * (1 / temperature) +
                 Tensor<B, 2>::from(filter, {n, n});
  const auto pick = Tensor<B, 2>::from(diagonal, {n, n});
  auto cross_entropy = [&](const Tensor<B, 2>& t) {  // relative to the largest of each row: nothing overflows
    const auto u = t - reshape<2>(max(t, 1), {n, 1});
    return mean(log(sum(exp(u), 1)) - sum(u * pick, 1));
  };
  return (cross_entropy(s) + cross_entropy(transpose(s))) * 0.5;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_LOSS_KL_HPP  // <motionlang/loss/kl.hpp>
#define MOTIONLANG_HAS_LOSS_KL_HPP
/// Divergence between diagonal Gaussians.

namespace motionlang::inline MOTIONLANG_ABI {

/// KL(N(mu, exp(logvar)) || N(0, 1)), averaged over all elements.
///     (mu^2 + exp(logvar) - 1 - logvar) / 2
/// Source  Kingma and Welling (2014), appendix B.
template <Backend B>
Tensor<B, 0> kl_to_standard_normal(const Tensor<B, 2>& mu, const Tensor<B, 2>& logvar) {
  return mean(square(mu) + exp(logvar) - 1.0 - logvar) * 0.5;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_LOSS_RECONSTRUCTION_HPP  // <motionlang/loss/reconstruction.hpp>
#define MOTIONLANG_HAS_LOSS_RECONSTRUCTION_HPP
/// Losses that compare numbers with numbers.

namespace motionlang::inline MOTIONLANG_ABI {

/// mean((a - b)^2) over all elements.
template <Backend B, int R>
Tensor<B, 0> mse(const Tensor<B, R>& a, const Tensor<B, R>& b) {
  return mean(square(a - b));
}

/// Huber's loss with threshold 1, averaged: d^2 / 2 where |d| < 1, else |d| - 1/2.
template <Backend B, int R>
Tensor<B, 0> smooth_l1(const Tensor<B, R>& a, const Tensor<B, R>& b) {
  const auto d = abs(a - b);
  const Tensor<B, R> one(1.0);
  return mean(where_less(d, one, square(d) * 0.5, d - 0.5));
}

/// Sum of squares over the rows, divided by what a padded batch would have divided by: sequences * longest * width.
///     loss = sum (a - b)^2 / (count * longest * width)
/// Source  STMC training (spec diffusion.md, section 9): padding adds nothing to the sum but counts in the mean.
template <Backend B>
Tensor<B, 0> padded_mse(const Sequences<B>& a, const Tensor<B, 2>& b) {
  const double n = static_cast<double>(a.count() * a.offsets.longest() * a.width());
  return sum(square(a.rows - b)) * (1.0 / n);
}

/// MDM's masked loss, (sequences): for each the sum of squares over its frames and features / (frames * width + 1e-8).
template <Backend B>
Tensor<B, 1> mse_per_sequence(const Sequences<B>& a, const Tensor<B, 2>& b) {
  const auto squares = sum(square(a.rows - b), 1);  // (rows)
  std::vector<Index> owner;
  std::vector<typename B::scalar> weight;
  for (Index s = 0; s < a.count(); ++s) {
    const Index n = a.offsets.length(s);
    owner.insert(owner.end(), static_cast<std::size_t>(n), s);
    weight.push_back(static_cast<typename B::scalar>(1.0 / (static_cast<double>(n * a.width()) + 1e-8)));
  }
  return scatter_add(squares, owner, a.count()) * Tensor<B, 1>::from(weight, {a.count()});
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_OPTIM_ADAMW_HPP  // <motionlang/optim/adamw.hpp>
#define MOTIONLANG_HAS_OPTIM_ADAMW_HPP
/// AdamW, and the norm of all gradients.

#include <map>      // state by parameter

namespace motionlang::inline MOTIONLANG_ABI {

struct AdamWConfig {
  double lr = 1e-4;
  double beta1 = 0.9, beta2 = 0.999;
  double eps = 1e-8;
  double weight_decay = 0.01;
};

/// Square root of the sum of squares of all gradients, in double and in the order of the fields.
template <AutodiffBackend A, Module M>
double gradient_norm(const M& model, const Gradients<A>& gradients) {
  double total = 0;
  visit_tensors(model, [&](const std::string&, const auto& t) {
    if (const auto* g = gradients.find(t.data())) {
      for (auto x : A::inner::to_span(*g)) total += static_cast<double>(x) * static_cast<double>(x);
    }
  });
  return std::sqrt(total);
}
/// The factor that brings a norm down to `max_norm`: min(1, max_norm / (norm + 1e-6)), as PyTorch clips.
inline double clip_scale(double norm, double max_norm) { return std::min(1.0, max_norm / (norm + 1e-6)); }

/// Decoupled weight decay (Loshchilov and Hutter 2019, algorithm 2) with PyTorch's order of operations:
///     p = p (1 - lr wd);   m = b1 m + (1 - b1) g;   v = b2 v + (1 - b2) g^2
///     p = p - lr / (1 - b1^k) m / (sqrt(v / (1 - b2^k)) + eps)
/// All parameters decay, biases and norms too. Parameters that the loss does not reach stay as they are.
/// With weight_decay = 0 this is Adam.
template <AutodiffBackend A>
class AdamW {
 public:
  using B = typename A::inner;
  struct Moments {
    typename B::tensor m, v;
  };

  explicit AdamW(AdamWConfig c = {}) : config(c) {}

  AdamWConfig config;

  /// One update; gradients are multiplied by `scale` first (clip_scale). The model keeps its variables. Throws
  /// shape_error 204 if restored moments are those of another model.
  template <Module M>
  void step(M& model, const Gradients<A>& gradients, double scale = 1) {
    ++steps_;
    visit_tensors(model, [&](const std::string& path, auto& t) {
      const auto* g = gradients.find(t.data());
      if (g == nullptr) return;
      auto found = state_.find(path);
      if (found == state_.end()) {
        const auto zero = B::full(B::shape(*g), 0);
        found = state_.emplace(path, Moments{zero, zero}).first;
      }
      for (const auto* moment : {&found->second.m, &found->second.v}) {
        if (B::shape(*moment) != t.shape()) {
          raise<shape_error>(204, "AdamW: '", path, "' is ", t.shape(), ", its restored moments are ",
                             B::shape(*moment));
        }
      }
      update(A::mutable_value(t.mutable_data()), found->second, *g, scale);
    });
  }

  /// Updates made so far, and the moments by path: what a checkpoint has to keep.
  Index steps() const { return steps_; }
  const std::map<std::string, Moments>& state() const { return state_; }
  void restore(Index steps, std::map<std::string, Moments> state) {
    steps_ = steps;
    state_ = std::move(state);
  }

 private:
  void update(typename B::tensor& p, Moments& s, const typename B::tensor& g, double scale) const {
    const AdamwUpdate u{.lr = config.lr,
                        .beta1 = config.beta1,
                        .beta2 = config.beta2,
                        .eps = config.eps,
                        .weight_decay = config.weight_decay,
                        .gradient_scale = scale,
                        .step = steps_};
    adamw_update<B>(p, s.m, s.v, g, u);
  }

  Index steps_ = 0;
  std::map<std::string, Moments> state_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_OPTIM_EMA_HPP  // <motionlang/optim/ema.hpp>
#define MOTIONLANG_HAS_OPTIM_EMA_HPP
/// Exponential moving average of the parameters: the model that is saved and sampled from.

namespace motionlang::inline MOTIONLANG_ABI {

///     e = rate e + (1 - rate) p
/// `rate` grows from 0 as min(rate, (1 + k) / (10 + k)), so that the first updates are not held back by the initial
/// values. Source  Polyak and Juditsky (1992); the warm-up is the one of common diffusion code.
template <Module Average, Module Model>
void update_ema(Average& average, const Model& model, double rate, Index step) {
  const double k = static_cast<double>(step), r = std::min(rate, (1 + k) / (10 + k));
  zip(average, model, [&](const std::string&, auto& e, const auto& p) {
    using T = std::remove_cvref_t<decltype(e)>;
    if constexpr (is_tensor<T>) {
      using S = typename T::scalar;
      std::vector<S> values = e.to_vector();
      const auto now = p.span();
      for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<S>(r * static_cast<double>(values[i]) + (1 - r) * static_cast<double>(now[i]));
      }
      e = T::from(values, e.shape());
    }
  });
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_OPTIM_LR_SCHEDULE_HPP  // <motionlang/optim/lr_schedule.hpp>
#define MOTIONLANG_HAS_OPTIM_LR_SCHEDULE_HPP
/// Learning rates over the steps of a training.

namespace motionlang::inline MOTIONLANG_ABI {

/// Linear rise over `warmup` steps, then half a cosine from `peak` down to `floor` at step `total` (Loshchilov, Hutter
/// 2017).
struct WarmupCosine {
  double peak = 1e-4;
  double floor = 0;
  Index warmup = 0;
  Index total = 1;

  double operator()(Index step) const {
    if (step < warmup) return peak * static_cast<double>(step + 1) / static_cast<double>(warmup);
    const double progress =
        std::min(1.0, static_cast<double>(step - warmup) / static_cast<double>(std::max<Index>(1, total - warmup)));
    return floor + (peak - floor) * 0.5 * (1 + std::cos(std::numbers::pi * progress));
  }
};

/// The rate divided by `factor` once every `every` steps.
struct StepDecay {
  double rate = 1e-4;
  double factor = 10;
  Index every = 1;

  double operator()(Index step) const { return rate / std::pow(factor, static_cast<double>(step / every)); }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_AMASS_RESAMPLE_HPP  // <motionlang/features/amass_resample.hpp>
#define MOTIONLANG_HAS_FEATURES_AMASS_RESAMPLE_HPP
/// How STMC's training data were prepared from AMASS: another frame rate, and mirrored copies. For parity; for clips of
/// one's own use kinematics/motion_tools.hpp.
///
/// Source  STMC, prepare/amasstools/fix_fps.py and smpl_mirroring.py

namespace motionlang::inline MOTIONLANG_ABI {

/// SMPL poses as AMASS files have them.
template <Scalar S>
struct AmassPoses {
  std::vector<S> poses;  // (frames, 3 joints) rotation vectors
  std::vector<S> trans;  // (frames, 3)
};

namespace detail {

/// Numbers of one pose. Throws shape_error 205 unless both arrays have the same number of frames.
template <Scalar S>
std::size_t amass_width(std::span<const S> poses, std::span<const S> trans, const char* op) {
  const std::size_t frames = trans.size() / 3;
  if (trans.size() % 3 != 0 || (frames == 0 ? !poses.empty() : poses.size() % (3 * frames) != 0)) {
    raise<shape_error>(205, op, ": ", poses.size(), " pose values for ", trans.size(), " translation values");
  }
  return frames == 0 ? 0 : poses.size() / frames;
}

/// Spherical interpolation of vectors that keep their lengths as weights:
///     (sin((1-t) h) a + sin(t h) b) / sin h,   h: the angle between a and b; linear if |cos h| > 0.9995 or one is zero
/// Not a rotation halfway between two rotations, but what the data were made with.
template <Scalar S>
Vec3<S> slerp_of_vectors(const Vec3<S>& a, const Vec3<S>& b, S t) {
  const S lengths = norm(a) * norm(b), cosine = lengths > 0 ? dot(a, b) / lengths : S(1);
  if (std::abs(cosine) > S(0.9995)) return (S(1) - t) * a + t * b;
  const S h = std::acos(cosine), sine = std::sin(h);
  return (std::sin((S(1) - t) * h) / sine) * a + (std::sin(t * h) / sine) * b;
}

}  // namespace detail

/// floor(T new / old) frames; frame i shows the source at (i + 1/2) old / new - 1/2, not before its first frame.
/// Coordinates are float32, as published. Translations linear, poses by slerp of their rotation vectors.
/// Throws shape_error 205, config_error 101 unless both rates are positive.
template <Scalar S>
AmassPoses<S> amass_resample(std::span<const S> poses, std::span<const S> trans, double old_fps, double new_fps) {
  if (!(old_fps > 0 && new_fps > 0)) raise<config_error>(101, "amass_resample: ", old_fps, " to ", new_fps, " fps");
  const std::size_t width = detail::amass_width(poses, trans, "amass_resample"), source = trans.size() / 3;
  const auto frames = static_cast<std::size_t>(std::floor(static_cast<double>(source) * new_fps / old_fps));
  AmassPoses<S> out;
  for (std::size_t i = 0; i < frames; ++i) {
    const auto ratio = static_cast<float>(old_fps / new_fps);
    const float at = std::max((static_cast<float>(i) + 0.5f) * ratio - 0.5f, 0.0f);
    const std::size_t a = std::min(static_cast<std::size_t>(at), source - 1), b = std::min(a + 1, source - 1);
    const S t = static_cast<S>(at - static_cast<float>(a));
    for (std::size_t k = 0; k < 3; ++k) out.trans.push_back((S(1) - t) * trans[3 * a + k] + t * trans[3 * b + k]);
    for (std::size_t k = 0; k < width; k += 3) {
      const S *p = &poses[a * width + k], *q = &poses[b * width + k];
      const auto v = detail::slerp_of_vectors<S>({p[0], p[1], p[2]}, {q[0], q[1], q[2]}, t);
      out.poses.insert(out.poses.end(), {v.x, v.y, v.z});
    }
  }
  return out;
}

/// Left and right exchanged: partners swap their rotation vectors, whose y and z change sign, and the path its x.
/// Exact. Throws shape_error 205 unless poses have the 22 or 24 joints of SMPL.
template <Scalar S>
AmassPoses<S> amass_mirror(std::span<const S> poses, std::span<const S> trans) {
  const std::size_t width = detail::amass_width(poses, trans, "amass_mirror"), frames = trans.size() / 3;
  if (frames != 0 && width != 66 && width != 72) {
    raise<shape_error>(205, "amass_mirror: poses of ", width, " values; expected 66 or 72");
  }
  AmassPoses<S> out{{poses.begin(), poses.end()}, {trans.begin(), trans.end()}};
  for (std::size_t f = 0; f < frames; ++f) {
    out.trans[3 * f] = -trans[3 * f];
    for (std::size_t j = 0; 3 * j < width; ++j) {
      const S* from = &poses[f * width + 3 * static_cast<std::size_t>(smpl_mirror_joint[j])];
      S* to = &out.poses[f * width + 3 * j];
      to[0] = from[0], to[1] = -from[1], to[2] = -from[2];
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_AMASS_SEQUENCE_HPP  // <motionlang/features/amass_sequence.hpp>
#define MOTIONLANG_HAS_FEATURES_AMASS_SEQUENCE_HPP
/// A sequence of AMASS as its file has it: rotation vectors, path and shape of an SMPL body, world Z up.

namespace motionlang::inline MOTIONLANG_ABI {

struct AmassSequence {
  Index frames = 0, columns = 0;  // columns: 66 or more; 156 of SMPL-H, 165 of SMPL-X
  std::vector<double> poses{};    // (frames, columns) rotation vectors: root, 21 body joints, hands or face
  std::vector<double> trans{};    // (frames, 3)
  std::vector<double> betas{};    // shape coefficients, 16 or fewer; none if the file has none
  std::string gender = "neutral";
  double fps = 0;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_FRAME_SAMPLING_HPP  // <motionlang/features/frame_sampling.hpp>
#define MOTIONLANG_HAS_FEATURES_FRAME_SAMPLING_HPP
/// Which frames of a clip the published systems take: other frame rates, parts, windows for training. For parity; to
/// resample clips of one's own use kinematics/motion_tools.hpp.

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

inline void require_rates(const char* function, double from, double to) {
  if (!(from > 0 && to > 0 && std::isfinite(from / to) && std::isfinite(to / from)))
    raise<config_error>(101, function, ": ", from, " to ", to, " frames per second");
}

}  // namespace detail

/// TEMOS: frames 0, s, 2s, ..., s = floor(old / new); 120 frames per second become 13.33 where 12.5 are asked for.
/// Source  TEMOS, spec temos.md 9. Throws config_error 101 unless 0 < new <= old.
inline std::vector<Index> every_nth_frame(Index frames, double old_fps, double new_fps) {
  detail::require_rates("every_nth_frame", old_fps, new_fps);
  const auto step = static_cast<Index>(old_fps / new_fps);
  if (step < 1) raise<config_error>(101, "every_nth_frame: from ", old_fps, " up to ", new_fps, " frames per second");
  std::vector<Index> out;
  for (Index f = 0; f < frames; f += step) out.push_back(f);
  return out;
}

/// TEACH and SINC: floor(new / old frames) frames spread evenly from the first to the last, rounded down.
/// Source  TEACH, spec teach.md 4.1. Throws config_error 101 unless both rates are positive.
inline std::vector<Index> spread_frames(Index frames, double old_fps, double new_fps) {
  detail::require_rates("spread_frames", old_fps, new_fps);
  const auto count = static_cast<Index>(new_fps / old_fps * static_cast<double>(frames));
  const double step = count > 1 ? static_cast<double>(frames - 1) / static_cast<double>(count - 1) : 0;
  std::vector<Index> out;
  for (Index i = 0; i < count; ++i) {
    out.push_back(i > 0 && i == count - 1 ? frames - 1 : static_cast<Index>(static_cast<double>(i) * step));
  }
  return out;
}

/// TEMOS: values between the frames on straight lines, (frames, width) -> ((frames - 1) k + 1, width),
/// k = floor(new / old). In double, as published. Throws config_error 101, shape_error 205.
template <Scalar S>
std::vector<double> upsample_linearly(std::span<const S> values, Index width, double old_fps, double new_fps) {
  detail::require_rates("upsample_linearly", old_fps, new_fps);
  const auto factor = static_cast<Index>(new_fps / old_fps);
  if (factor < 1) raise<config_error>(101, "upsample_linearly: from ", old_fps, " down to ", new_fps);
  if (width < 1 || std::ssize(values) % width != 0) {
    raise<shape_error>(205, "upsample_linearly: ", values.size(), " values are no rows of ", width);
  }
  const auto n = static_cast<std::size_t>(width);
  std::vector<double> out;
  for (std::size_t at = 0; at + n < values.size(); at += n) {
    for (Index j = 0; j < factor; ++j) {
      const double t = static_cast<double>(j) / static_cast<double>(factor);
      for (std::size_t i = at; i < at + n; ++i) {
        out.push_back((1 - t) * static_cast<double>(values[i]) + t * static_cast<double>(values[i + n]));
      }
    }
  }
  out.insert(out.end(), values.end() - std::min<Index>(width, std::ssize(values)), values.end());
  return out;
}

/// Consecutive frames. Of none, `first` is -1.
struct FrameSlice {
  Index first = -1, length = 0;
  bool operator==(const FrameSlice&) const = default;
};
/// TMR: seconds to frames, rounded down, as far as the clip goes. Source  spec tmr.md 4.
/// Throws config_error 101 for a negative time or a rate that is none.
inline FrameSlice slice_of_seconds(double start, double end, double fps, Index frames) {
  if (!(start >= 0 && end >= 0 && fps > 0 && std::isfinite(start * fps) && std::isfinite(end * fps))) {
    raise<config_error>(101, "slice_of_seconds: ", start, " to ", end, " seconds at ", fps, " frames per second");
  }
  const auto index = [&](double seconds) {
    return static_cast<Index>(std::min(seconds * fps, static_cast<double>(frames)));
  };
  const Index first = index(start), last = index(end);
  return last > first ? FrameSlice{first, last - first} : FrameSlice{};
}

struct ActorFrameOptions {
  Index frames = 60;         // to take
  bool random_step = false;  // "random_conseq": the step is drawn, too
  Index step = 1;            // -1: the largest that fits
};

/// ACTOR: the frames of a training item out of `available` ones. Clips that are too short repeat their last frame; of
/// others, every step-th frame from a random start on. The last possible start is never drawn, as published.
/// Source  ACTOR, src/datasets/dataset.py; spec actor.md 6.3
/// Throws  config_error 101 unless 2 frames or more are wanted, of 1 or more
inline std::vector<Index> actor_frames(Index available, const ActorFrameOptions& options, PythonRandom& random) {
  const Index k = options.frames, n = available;
  if (k < 2 || n < 1 || options.step == 0 || options.step < -1) {
    raise<config_error>(101, "actor_frames: ", k, " of ", n, " frames, step ", options.step);
  }
  std::vector<Index> out;
  if (k > n) {
    for (Index i = 0; i < k; ++i) out.push_back(std::min(i, n - 1));
    return out;
  }
  const Index longest = (n - 1) / (k - 1);
  const bool fits = options.step > 0 && options.step * (k - 1) < n;
  const Index step = options.random_step ? static_cast<Index>(random.randint(1, longest))
                     : fits              ? options.step
                                         : longest;
  const Index last = step * (k - 1);
  const auto shift = static_cast<Index>(random.randint(0, std::max<Index>(0, n - last - 2)));
  for (Index i = 0; i < k; ++i) out.push_back(shift + i * step);
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_GUOH3D_HPP  // <motionlang/features/guoh3d.hpp>
#define MOTIONLANG_HAS_FEATURES_GUOH3D_HPP
/// Joint positions from the 263 numbers per frame of HumanML3D ("guoh3dfeats"), or KIT's 251. The other direction:
/// guoh3d_extraction.hpp; which number is what: Guoh3dSlots in layout.hpp.
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb recover_root_rot_pos, recover_from_ric,
///         recover_from_rot; spec humanml3d-features.md 7
/// World   Y up, frame 0 at x = z = 0; units as the features have them (metres; KIT: about 1/640 m), not normalised

#ifndef MOTIONLANG_HAS_FEATURES_LAYOUT_HPP  // <motionlang/features/layout.hpp>
#define MOTIONLANG_HAS_FEATURES_LAYOUT_HPP
/// Which numbers of a feature vector belong to which body part. Composition needs nothing else from a representation.
///
/// Source  STMC (Petrovich et al. 2024), bptools: joint j owns its position, its 6D rotation and its velocity; what
///         belongs to the root, and the foot contacts, go to the legs. The tables are generated from that rule.

namespace motionlang::inline MOTIONLANG_ABI {

/// Half-open range of positions.
struct IndexRange {
  Index begin = 0, end = 0;
  Index size() const { return end - begin; }
  bool operator==(const IndexRange&) const = default;
};

/// A feature vector cut into body parts: every number belongs to exactly one. Own representations are a name, a size
/// and their ranges, or `from_owner`:
///
///     auto layout = FeatureLayout::from_owner("my features", 64, [](Index i) { return i < 40 ? legs : head; });
struct FeatureLayout {
  std::string name;
  Index size = 0;                                              // numbers of one frame
  std::array<std::vector<IndexRange>, body_part_count> parts;  // ascending and separate, in the order of BodyPart

  /// From a function position -> BodyPart.
  template <class F>
  static FeatureLayout from_owner(std::string name, Index size, F owner) {
    FeatureLayout layout{std::move(name), size, {}};
    for (Index i = 0; i < size; ++i) {
      auto& ranges = layout.parts[static_cast<std::size_t>(owner(i))];
      if (ranges.empty() || ranges.back().end != i) ranges.push_back({i, i});
      ranges.back().end = i + 1;
    }
    return layout;
  }

  const std::vector<IndexRange>& ranges(BodyPart part) const { return parts[static_cast<std::size_t>(part)]; }

  /// All positions of a part, ascending.
  std::vector<Index> indices(BodyPart part) const {
    std::vector<Index> out;
    for (const IndexRange& r : ranges(part)) {
      for (Index i = r.begin; i < r.end; ++i) out.push_back(i);
    }
    return out;
  }

  /// Throws config_error 102 unless the ranges cover 0 ... size-1, each position once.
  void validate() const {
    std::vector<int> owners(static_cast<std::size_t>(size), 0);
    for (int p = 0; p < body_part_count; ++p) {
      for (const IndexRange& r : ranges(static_cast<BodyPart>(p))) {
        if (r.begin < 0 || r.end < r.begin || r.end > size) {
          raise<config_error>(102, "FeatureLayout '", name, "': range ", r.begin, ":", r.end, " of ",
                              static_cast<BodyPart>(p), " is not inside 0:", size);
        }
        for (Index i = r.begin; i < r.end; ++i) ++owners[static_cast<std::size_t>(i)];
      }
    }
    for (std::size_t i = 0; i < owners.size(); ++i) {
      if (owners[i] != 1) {
        raise<config_error>(102, "FeatureLayout '", name, "': number ", i, " belongs to ", owners[i], " body parts");
      }
    }
  }
  bool operator==(const FeatureLayout&) const = default;
};

/// smplrifke: 4 root numbers, 6D rotations of `rotations` joints, positions of joints 1 ... J-1: 4 + 6 * 22 + 3 * 23 =
/// 205 for SMPL.
inline FeatureLayout smplrifke_layout(std::span<const BodyPart> part_of_joint = smpl_part_of_joint,
                                      Index rotations = 22) {
  const Index joints = std::ssize(part_of_joint), first_position = 4 + 6 * rotations;
  if (joints < 1 || rotations < 0 || rotations > joints) {
    raise<config_error>(101, "smplrifke_layout: ", rotations, " rotations of ", joints, " joints");
  }
  return FeatureLayout::from_owner("smplrifke", first_position + 3 * (joints - 1), [=](Index i) {
    if (i < 4) return BodyPart::legs;
    const Index joint = i < first_position ? (i - 4) / 6 : 1 + (i - first_position) / 3;
    return part_of_joint[static_cast<std::size_t>(joint)];
  });
}

/// Where things are in the vector of HumanML3D (22 joints: 263 numbers) and of KIT (21: 251); 12 J - 1 in all.
///
///     0              turn of the heading to the next frame: half the angle, radians
///     1:3            velocity of the root along x and z, seen from the body of the next frame
///     3              height of the root
///     positions      joints 1 ... J-1 seen from the body, heights above the floor: 3 each
///     rotations      joints 1 ... J-1: two columns of the matrix, 6 each
///     velocities     joints 0 ... J-1 to the next frame, seen from the body: 3 each
///     contacts       left ankle, left toes, right ankle, right toes: 1 if they stand, else 0
struct Guoh3dSlots {
  Index joints = 22;

  IndexRange positions() const { return {4, 4 + 3 * (joints - 1)}; }
  IndexRange rotations() const { return {positions().end, positions().end + 6 * (joints - 1)}; }
  IndexRange velocities() const { return {rotations().end, rotations().end + 3 * joints}; }
  IndexRange contacts() const { return {velocities().end, velocities().end + 4}; }
  Index size() const { return contacts().end; }
  /// The seven groups whose deviations are published as one number each.
  std::vector<IndexRange> groups() const {
    return {{0, 1}, {1, 3}, {3, 4}, positions(), rotations(), velocities(), contacts()};
  }
};

/// The vector of HumanML3D or, with 21 joints, of KIT: see Guoh3dSlots. The root and the contacts go to the legs.
inline FeatureLayout guoh3dfeats_layout(
    std::span<const BodyPart> part_of_joint = std::span(smpl_part_of_joint).first<22>()) {
  const Guoh3dSlots slots{std::ssize(part_of_joint)};
  if (slots.joints < 1) raise<config_error>(101, "guoh3dfeats_layout: no joints");
  return FeatureLayout::from_owner("guoh3dfeats", slots.size(), [=](Index i) {
    if (i < slots.positions().begin || i >= slots.contacts().begin) return BodyPart::legs;
    const Index joint = i < slots.positions().end   ? 1 + (i - slots.positions().begin) / 3
                        : i < slots.rotations().end ? 1 + (i - slots.rotations().begin) / 6
                                                    : (i - slots.velocities().begin) / 3;
    return part_of_joint[static_cast<std::size_t>(joint)];
  });
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// The path of the root. `turn` takes directions of the world to those seen from the body.
template <Scalar S>
struct Guoh3dRoot {
  std::vector<Quaternion<S>> turn;  // (frames)
  std::vector<Vec3<S>> position;    // (frames)
};

struct Guoh3dRecovery {
  /// Adds the frame behind the last one: as features of T frames of joints are T - 1 rows, this gives all T back. Its
  /// positions are those of the last row moved by the last row's velocities.
  bool last_frame = false;
};

namespace detail {

template <Scalar S>
Vec3<S> vector_at(std::span<const S> values, Index at) {
  const auto i = static_cast<std::size_t>(at);
  return {values[i], values[i + 1], values[i + 2]};
}
/// Rows of the features. Throws shape_error 205 if they are not whole, config_error 101 for a body without joints.
template <Scalar S>
std::size_t guoh3d_rows(std::string_view function, std::span<const S> features, Index joints) {
  const Index width = Guoh3dSlots{joints}.size();
  if (joints < 1) raise<config_error>(101, function, ": ", joints, " joints");
  if (std::ssize(features) % width != 0) {
    raise<shape_error>(205, function, ": ", features.size(), " values are no rows of ", width, " (", joints,
                       " joints)");
  }
  return features.size() / static_cast<std::size_t>(width);
}

}  // namespace detail

/// features (frames, 12 J - 1)
///     a_t = sum_{s<t} f[s, 0],   r_t = (cos a_t, 0, sin a_t, 0)
///     p_t = p_{t-1} + r_t^-1 (f[t-1, 1], 0, f[t-1, 2]),   p_t.y = f[t, 3]
/// Throws shape_error 205, config_error 101
template <Scalar S>
Guoh3dRoot<S> guoh3d_root(std::span<const S> features, Index joints = 22) {
  const std::size_t frames = detail::guoh3d_rows("guoh3d_root", features, joints);
  const auto width = static_cast<std::size_t>(Guoh3dSlots{joints}.size());
  Guoh3dRoot<S> out;
  S angle{};
  Vec3<S> p{};
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * width, width);
    const Quaternion<S> turn{cos(angle), S(0), sin(angle), S(0)};
    if (t > 0) {
      const S* before = row.data() - width;
      p = p + rotate(inverse(turn), Vec3<S>{before[1], S(0), before[2]});
    }
    p.y = row[3];
    out.turn.push_back(turn);
    out.position.push_back(p);
    angle += row[0];
  }
  return out;
}

/// features (frames, 12 J - 1) -> (frames, J), or (frames + 1, J) with `last_frame`, from the positions of the rows.
///     X_{t,j} = r_t^-1 ric_{t,j} + (p_t.x, 0, p_t.z),   X_{t,0} = p_t
/// Throws shape_error 205, config_error 101
template <Scalar S>
std::vector<Vec3<S>> guoh3d_joints(std::span<const S> features, Index joints = 22, const Guoh3dRecovery& options = {}) {
  const auto root = guoh3d_root(features, joints);
  const Guoh3dSlots slots{joints};
  const std::size_t frames = root.turn.size();
  std::vector<Vec3<S>> out;
  out.reserve((frames + 1) * static_cast<std::size_t>(joints));
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * static_cast<std::size_t>(slots.size()));
    const auto back = inverse(root.turn[t]);
    const Vec3<S>& p = root.position[t];
    out.push_back(p);
    for (Index j = 1; j < joints; ++j) {
      out.push_back(rotate(back, detail::vector_at(row, slots.positions().begin + 3 * (j - 1))) +
                    Vec3<S>{p.x, S(0), p.z});
    }
  }
  if (options.last_frame && frames > 0) {
    const auto row = features.last(static_cast<std::size_t>(slots.size()));
    const auto back = inverse(root.turn.back());
    for (Index j = 0; j < joints; ++j) {
      const Vec3<S> before = out[out.size() - static_cast<std::size_t>(joints)];
      out.push_back(before + rotate(back, detail::vector_at(row, slots.velocities().begin + 3 * j)));
    }
  }
  return out;
}

/// The same from the rotations of the rows, on bones of other lengths.
/// offsets  (joints), see chain_offsets
/// Throws   shape_error 204, 205, config_error 101, 106
template <Scalar S>
std::vector<Vec3<S>> guoh3d_joints_from_rotations(const ChainSkeleton& skeleton, std::span<const S> features,
                                                  std::span<const Vec3<S>> offsets) {
  const Guoh3dSlots slots{static_cast<Index>(skeleton.size())};
  const auto root = guoh3d_root(features, slots.joints);
  std::vector<Matrix3<S>> local;
  local.reserve(root.turn.size() * skeleton.size());
  for (std::size_t t = 0; t < root.turn.size(); ++t) {
    const auto row = features.subspan(t * static_cast<std::size_t>(slots.size()));
    local.push_back(to_matrix(root.turn[t]));
    for (Index at = slots.rotations().begin; at < slots.rotations().end; at += 6) {
      local.push_back(to_matrix(Rotation6dColumns<S>{detail::vector_at(row, at), detail::vector_at(row, at + 3)}));
    }
  }
  return chain_forward_kinematics(skeleton, std::span<const Matrix3<S>>(local), std::span<const Vec3<S>>(root.position),
                                  offsets);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_GUOH3D_EXTRACTION_HPP  // <motionlang/features/guoh3d_extraction.hpp>
#define MOTIONLANG_HAS_FEATURES_GUOH3D_EXTRACTION_HPP
/// The 263 numbers per frame of HumanML3D ("guoh3dfeats"), or KIT's 251, from joint positions: onto the reference
/// skeleton, onto the floor, facing +Z, then rotations, velocities and contacts. Back: guoh3d.hpp.
///
///     auto features = guoh3d_features(humanml3d_chains(), joints);     // (frames, 22) -> (frames - 1, 263)
///
/// Another body is another ChainSkeleton. Which number is what: Guoh3dSlots in layout.hpp.
///
/// Source  Guo et al. (CVPR 2022), motion_representation.ipynb process_file, extract_features;
///         spec humanml3d-features.md 3 to 6
/// World   Y up; velocities and turns per frame (20 frames per second, KIT 12.5)

namespace motionlang::inline MOTIONLANG_ABI {

/// As published, unless something is said.
struct Guoh3dOptions {
  ChainRotationOptions rotations{.facing = {.sigma = 20}};
  /// false: where the heading passes 180 degrees, the turn of that frame gets the wrong sign.
  bool fix_yaw_sign = false;
};

/// Without what the published code gets wrong: the heading follows hips and shoulders alike, does not jump behind the
/// first frame, passes 180 degrees, and a bone may be opposite to its zero direction.
inline Guoh3dOptions guoh3d_corrected() {
  return {.rotations = {.facing = {.sigma = 20, .legacy_forward = false},
                        .fix_first_frame = true,
                        .fix_opposite_bones = true},
          .fix_yaw_sign = true};
}

/// Joints on the floor; frame 0 stands at x = z = 0 and faces +Z.
template <Scalar S>
struct GroundedJoints {
  std::vector<Vec3<S>> joints;  // (frames, joints)
  S floor{};                    // height of the lowest joint of the clip, before
  Quaternion<S> turn{};         // that all joints have been turned by, last
};

/// first   how the facing direction of frame 0 is found; as published, from this frame alone. A body that faces -Z is
///         turned by 180 degrees; published: NaN
/// Throws  shape_error 205 if the joints are not whole frames, config_error 101 (sigma) and 106
template <Scalar S>
GroundedJoints<S> ground_joints(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                const FacingOptions& first = {.legacy_forward = false}) {
  detail::chain_frames("ground_joints", skeleton, joints);
  GroundedJoints<S> out{{}, S(0), Quaternion<S>::identity()};
  if (joints.empty()) return out;
  out.floor = joints[0].y;
  for (const Vec3<S>& p : joints) out.floor = std::min(out.floor, p.y);
  const auto facing = facing_directions(skeleton, first.sigma == 0 ? joints.first(skeleton.size()) : joints, first);
  out.turn = detail::turn_ahead(facing[0]);
  const Vec3<S> origin{joints[0].x, out.floor, joints[0].z};
  out.joints.resize(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) out.joints[i] = rotate(out.turn, joints[i] - origin);
  return out;
}

/// 1 while the squared displacement to the next frame is below the threshold, else 0.
template <ScalarLike T>
T guoh3d_contact(const Vec3<T>& now, const Vec3<T>& next, double threshold) {
  const Vec3<T> moved = next - now;
  return where_less(dot(moved, moved), T(threshold), T(1), T(0));
}
/// The same of two joints over time: (frames, joints) -> (frames - 1, 2). Throws shape_error 205, 203 for a joint that
/// does not exist.
template <Scalar S>
std::vector<S> guoh3d_contacts(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               const std::array<int, 2>& foot) {
  const std::size_t frames = detail::chain_frames("guoh3d_contacts", skeleton, joints);
  for (const int j : foot) {
    if (j < 0 || static_cast<std::size_t>(j) >= skeleton.size())
      raise<shape_error>(203, "guoh3d_contacts: joint ", j, " of ", skeleton.size());
  }
  std::vector<S> out;
  for (std::size_t t = 0; t + 1 < frames; ++t) {
    const Vec3<S>*now = &joints[t * skeleton.size()], *next = now + skeleton.size();
    for (const int j : foot) {
      out.push_back(guoh3d_contact(detail::joint_of(now, j), detail::joint_of(next, j), skeleton.foot_threshold));
    }
  }
  return out;
}

/// The rotation from one root rotation to the next; its y is the sine of half the turn.
/// fix_sign: the shorter way round.
template <ScalarLike T>
Quaternion<T> guoh3d_turn(const Quaternion<T>& root, const Quaternion<T>& next, bool fix_sign = false) {
  const Quaternion<T> q = next * inverse(root);
  return fix_sign ? where_less(q.w, T(0), T(-1), T(1)) * q : q;
}
/// The way of the root to the next frame, seen from the body there.
template <ScalarLike T>
Vec3<T> guoh3d_root_velocity(const Quaternion<T>& next, const Vec3<T>& now_position, const Vec3<T>& next_position) {
  return rotate(next, next_position - now_position);
}
/// A joint seen from the body: x and z relative to the body's root, the height above the floor.
template <ScalarLike T>
Vec3<T> guoh3d_position(const Quaternion<T>& root, const Vec3<T>& root_position, const Vec3<T>& joint) {
  return rotate(root, joint - Vec3<T>{root_position.x, T(0), root_position.z});
}

namespace detail {

/// One row, or one in each lane: rotations of the frame, the root's of the next, joints of both. Number 0 is left as
/// the sine of half the turn.
template <ScalarLike T>
void guoh3d_row(const ChainSkeleton& skeleton, bool fix_yaw_sign, std::span<const Quaternion<T>> local,
                const Quaternion<T>& next_root, std::span<const Vec3<T>> now, std::span<const Vec3<T>> next, T* to) {
  auto put = [&](const Vec3<T>& v) { *to++ = v.x, *to++ = v.y, *to++ = v.z; };
  const Quaternion<T>& root = local[0];
  const Vec3<T> speed = guoh3d_root_velocity(next_root, now[0], next[0]);
  *to++ = guoh3d_turn(root, next_root, fix_yaw_sign).y;
  *to++ = speed.x;
  *to++ = speed.z;
  *to++ = now[0].y;
  for (std::size_t j = 1; j < now.size(); ++j) put(guoh3d_position(root, now[0], now[j]));
  for (std::size_t j = 1; j < now.size(); ++j) {
    const auto columns = to_rotation6d_columns(local[j]);
    put(columns.a);
    put(columns.b);
  }
  for (std::size_t j = 0; j < now.size(); ++j) put(rotate(root, next[j] - now[j]));
  for (const auto& foot : {skeleton.left_foot, skeleton.right_foot}) {
    for (const int j : foot) {
      *to++ = guoh3d_contact(joint_of(now.data(), j), joint_of(next.data(), j), skeleton.foot_threshold);
    }
  }
}

}  // namespace detail

/// joints  (frames, joints), grounded
/// result  (frames - 1, 12 J - 1)
/// Throws  shape_error 205 for fewer than two frames or joints that are not whole frames, config_error 101 (sigma) and
///         106, numeric_error 301, 302
template <Scalar S>
std::vector<S> guoh3d_from_grounded(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                                    const Guoh3dOptions& options = {}) {
  const std::size_t n = skeleton.size(), frames = detail::chain_frames("guoh3d_from_grounded", skeleton, joints);
  if (frames < 2) raise<shape_error>(205, "guoh3d_from_grounded: ", frames, " frames; a row is made of two");
  const auto bones = skeleton.bones();
  const auto roots = detail::chain_roots(skeleton, joints, options.rotations);
  const std::size_t rows = frames - 1, width = static_cast<std::size_t>(Guoh3dSlots{static_cast<Index>(n)}.size());
  std::vector<S> out(width * rows);

  using L = Lane<S>;  // eight frames at once
  const auto zero = [&] {
    std::vector<Vec3<L>> directions;
    for (const auto& d : skeleton.directions) directions.push_back({L(d.x), L(d.y), L(d.z)});
    return directions;
  }();
  std::vector<Vec3<L>> now(n), next(n);
  std::vector<Quaternion<L>> world(n), local(n);
  std::vector<L> row(width);
  for (std::size_t first = 0; first < rows; first += L::size) {
    Quaternion<L> root, next_root;
    for (int i = 0; i < L::size; ++i) {
      const std::size_t t = std::min(first + static_cast<std::size_t>(i), rows - 1);
      auto lane = [i](Vec3<L>& to, const Vec3<S>& v) { to.x[i] = v.x, to.y[i] = v.y, to.z[i] = v.z; };
      auto turn = [i](Quaternion<L>& to, const Quaternion<S>& q) {
        to.w[i] = q.w, to.x[i] = q.x, to.y[i] = q.y, to.z[i] = q.z;
      };
      for (std::size_t j = 0; j < n; ++j) lane(now[j], joints[t * n + j]), lane(next[j], joints[(t + 1) * n + j]);
      turn(root, roots[t]), turn(next_root, roots[t + 1]);
    }
    const L bad = detail::chain_rotations<L>(bones, zero, now.data(), root, options.rotations.fix_opposite_bones,
                                             world.data(), local.data());
    detail::guoh3d_row<L>(skeleton, options.fix_yaw_sign, local, next_root, now, next, row.data());
    for (int i = 0; i < L::size && first + static_cast<std::size_t>(i) < rows; ++i) {
      const std::size_t t = first + static_cast<std::size_t>(i);
      if (bad[i] > 0) detail::require_bones(skeleton, bones, &joints[t * n], t);
      S* to = &out[t * width];
      for (std::size_t k = 0; k < width; ++k) to[k] = row[k][i];
      to[0] = std::asin(std::clamp(to[0], S(-1), S(1)));
    }
  }
  detail::require_bones(skeleton, bones, &joints[rows * n], rows);
  return out;
}

/// The whole way.
/// joints   (frames, joints), of anybody, anywhere
/// lengths  (joints), bones of the reference skeleton
/// result   (frames - 1, 12 J - 1)
/// With fix_first_frame the smooth heading of frame 0 is turned onto +Z, so that the identity is right there.
/// Throws   as above; shape_error 204 unless there is one length for each joint
template <Scalar S>
std::vector<S> guoh3d_features(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               std::span<const S> lengths, const Guoh3dOptions& options = {}) {
  const auto uniform = uniform_skeleton(skeleton, joints, lengths);
  const FacingOptions published{.legacy_forward = false}, &smooth = options.rotations.facing;
  const auto grounded = ground_joints(skeleton, std::span<const Vec3<S>>(uniform.joints),
                                      options.rotations.fix_first_frame ? smooth : published);
  return guoh3d_from_grounded(skeleton, std::span<const Vec3<S>>(grounded.joints), options);
}
/// With the lengths of the skeleton itself. Throws config_error 101 if it has none, as KIT's.
template <Scalar S>
std::vector<S> guoh3d_features(const ChainSkeleton& skeleton, std::span<const Vec3<S>> joints,
                               const Guoh3dOptions& options = {}) {
  if (skeleton.lengths.empty()) {
    raise<config_error>(101, "guoh3d_features: '", skeleton.name, "' has 0 bone lengths for ", skeleton.size(),
                        " joints; take those of its reference clip");
  }
  const std::vector<S> lengths(skeleton.lengths.begin(), skeleton.lengths.end());
  return guoh3d_features(skeleton, joints, std::span<const S>(lengths), options);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_HUMANML3D_SOURCE_HPP  // <motionlang/features/humanml3d_source.hpp>
#define MOTIONLANG_HAS_FEATURES_HUMANML3D_SOURCE_HPP
/// From raw AMASS to the joints that HumanML3D begins with: which frames a row of index.csv takes, and the axes. The body
/// is the caller's: a function that poses frames, such as a BodyModel of SMPL-H on the user's own model file.
///
/// Source   Guo et al. (CVPR 2022), raw_pose_processing.ipynb; spec humanml3d-features.md 8
/// World    in: Z up, metres (AMASS); out: Y up, (x, y, z) -> (-x, z, y). HumanAct12 clips come as joints that are Y up and
///          stay as they are, and the index is not applied to them.
///
///     const auto joints = humanml3d_source_joints<double>(row, frames, fps, [&](std::span<const Index> numbers) {
///       return posed_joints(model, sequence, numbers);      // (numbers.size(), J), J >= 22
///     });

namespace motionlang::inline MOTIONLANG_ABI {

/// A row of index.csv: a clip is a part of a sequence.
struct HumanMl3dSource {
  std::string source_path;  // "./pose_data/KIT/3/kick_high_left02_poses.npy"
  Index start_frame = 0;    // at 20 frames per second, behind the lead
  Index end_frame = -1;     // -1: to the end
  std::string new_name;     // "000000.npy"
  bool operator==(const HumanMl3dSource&) const = default;
};

struct HumanMl3dSourceOptions {
  /// The published program slices [start:-1], which leaves the last frame out where "to the end" is meant.
  bool drop_last_frame = false;
};

inline bool is_humanact12(std::string_view source_path) { return source_path.find("humanact12") != source_path.npos; }
/// HumanML3D has two bodies: everybody but "male" is posed with the female one.
inline bool humanml3d_uses_male_body(std::string_view gender) { return gender == "male"; }

/// Frames at 20 per second that are dropped before the index counts: people stand in a T-pose there.
inline Index humanml3d_lead(std::string_view source_path) {
  struct Lead {
    std::string_view data_set;
    Index frames;
  };
  constexpr Lead leads[] = {{"Eyes_Japan_Dataset", 60},
                            {"MPI_HDM05", 60},
                            {"TotalCapture", 20},
                            {"MPI_Limits", 20},
                            {"Transitions_mocap", 10}};
  Index frames = 0;
  for (const Lead& lead : leads) {
    if (source_path.find(lead.data_set) != source_path.npos) frames += lead.frames;
  }
  return frames;
}

/// The frames of a sequence that a row of the index takes: every floor(fps / 20)-th, behind the lead, from start to end.
/// An end behind the last frame is the last frame, as Python slices are. Empty if the sequence is too short.
/// Throws config_error 101 for a rate below 20 frames per second and for frames that are negative (but for end -1).
inline std::vector<Index> humanml3d_source_frames(const HumanMl3dSource& row, Index frames, double fps,
                                                  const HumanMl3dSourceOptions& options = {}) {
  std::vector<Index> picked = every_nth_frame(frames, fps, 20);
  if (is_humanact12(row.source_path)) return picked;
  if (row.start_frame < 0 || row.end_frame < -1) {
    raise<config_error>(101, "humanml3d_source_frames: '", row.new_name, "' from frame ", row.start_frame, " to ",
                        row.end_frame);
  }
  const Index available = std::max<Index>(0, std::ssize(picked) - humanml3d_lead(row.source_path));
  const Index last = row.end_frame == -1 ? available - (options.drop_last_frame ? 1 : 0) : row.end_frame;
  picked.erase(picked.begin(), picked.end() - available);
  picked.resize(static_cast<std::size_t>(std::clamp<Index>(last, 0, available)));
  picked.erase(picked.begin(), picked.begin() + std::min<Index>(row.start_frame, std::ssize(picked)));
  return picked;
}

/// The first 22 joints of the frames of a row, (frames, 22). `pose` takes frame numbers and gives their joints,
/// (frames, J) with J >= 22: of AMASS Z up, of HumanAct12 as its files have them (give 20 as their fps).
/// Throws config_error 101 as humanml3d_source_frames, shape_error 205 if `pose` gives other than whole frames.
template <Scalar S, class Pose>
std::vector<Vec3<S>> humanml3d_source_joints(const HumanMl3dSource& row, Index frames, double fps, Pose&& pose,
                                             const HumanMl3dSourceOptions& options = {}) {
  const std::vector<Index> numbers = humanml3d_source_frames(row, frames, fps, options);
  if (numbers.empty()) return {};
  const std::vector<Vec3<S>> posed = pose(std::span<const Index>(numbers));
  const std::size_t joints = posed.size() / numbers.size();
  if (joints < 22 || posed.size() % numbers.size() != 0) {
    raise<shape_error>(205, "humanml3d_source_joints: ", posed.size(), " joints for ", numbers.size(),
                       " frames; expected 22 or more for each");
  }
  const bool y_up = is_humanact12(row.source_path);
  std::vector<Vec3<S>> out;
  out.reserve(22 * numbers.size());
  for (std::size_t at = 0; at < posed.size(); at += joints) {
    for (std::size_t j = at; j < at + 22; ++j) {
      const Vec3<S>& p = posed[j];
      out.push_back(y_up ? p : Vec3<S>{-p.x, p.z, p.y});
    }
  }
  return out;
}

/// Joints of some frames of a sequence with a body model, (frames, J), in the sequence's own world. The model takes the
/// first rotations and shape coefficients that it has use for: SMPL-H all 52 joints, HumanML3D 10 coefficients.
/// Throws shape_error 205 if the sequence has fewer of them, 203 for a frame that it has not.
template <Backend B>
std::vector<Vec3<typename B::scalar>> posed_joints(const BodyModel<B>& model, const AmassSequence& sequence,
                                                   std::span<const Index> frames) {
  using S = typename B::scalar;
  const Index n = std::ssize(frames), joints = model.joints(), shapes = model.shapedirs.size(1);
  if (sequence.columns < 3 * joints || std::ssize(sequence.betas) < shapes) {
    raise<shape_error>(205, "posed_joints: ", sequence.columns, " pose values and ", sequence.betas.size(),
                       " shape coefficients, the model needs ", 3 * joints, " and ", shapes);
  }
  std::vector<S> betas, rotations, translations;
  for (const Index frame : frames) {
    if (frame < 0 || frame >= sequence.frames) {
      raise<shape_error>(203, "posed_joints: frame ", frame, " of ", sequence.frames);
    }
    for (Index k = 0; k < shapes; ++k) betas.push_back(static_cast<S>(sequence.betas[static_cast<std::size_t>(k)]));
    const auto pose = std::span(sequence.poses).subspan(static_cast<std::size_t>(frame * sequence.columns));
    for (std::size_t j = 0; j < static_cast<std::size_t>(joints); ++j) {
      const auto r = to_matrix(AxisAngle<double>{{pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]}});
      for (const double value : r.m) rotations.push_back(static_cast<S>(value));
    }
    const double* t = sequence.trans.data() + 3 * frame;
    for (int k = 0; k < 3; ++k) translations.push_back(static_cast<S>(t[k]));
  }
  const auto posed =
      model.posed_joints(Tensor<B, 2>::from(betas, {n, shapes}), Tensor<B, 3>::from(rotations, {n, joints, 9}),
                         Tensor<B, 2>::from(translations, {n, 3}));
  const auto values = posed.to_vector();
  std::vector<Vec3<S>> out;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) out.push_back({values[i], values[i + 1], values[i + 2]});
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_JOINT_SETS_HPP  // <motionlang/features/joint_sets.hpp>
#define MOTIONLANG_HAS_FEATURES_JOINT_SETS_HPP
/// The joints that TEMOS, TEACH and SINC compare, out of the 73 points of an SMPL-H body (52 joints, then vertices of
/// the face, feet and hands).
///
///     mmm      21 joints of MMM, 640 units per metre, Y up          smplmmm  21 joints of MMM, metres, Z up
///     mmmns    21 joints of MMM, metres, Y up                       smplnh   22 joints without the hands
///     smplh    all 73
/// Source  TEMOS, rots2joints/smplh.py; spec temos.md 4.3

namespace motionlang::inline MOTIONLANG_ABI {

/// MMM's joints among the 73 points; 59 and 62 are the heels.
inline constexpr std::array<std::size_t, 21> mmm_of_smplh{0, 3, 9, 12, 15, 16, 18, 20, 17, 19, 21,
                                                          1, 4, 7, 59, 10, 2,  5,  8,  62, 11};

/// points  (frames, 73), metres, Z up
/// trans   (frames), where the first root of the result is put, whatever its units and axes: so it is published
/// result  (frames, 21, 22 or 73)
/// Throws  config_error 103 for an unknown name, shape_error 205
template <Scalar S>
std::vector<Vec3<S>> select_joints(std::string_view name, std::span<const Vec3<S>> points,
                                   std::span<const Vec3<S>> trans) {
  const bool scaled = name == "mmm", y_up = scaled || name == "mmmns", mmm = y_up || name == "smplmmm";
  if (!mmm && name != "smplnh" && name != "smplh") {
    raise<config_error>(103, "select_joints: '", name, "' is not mmm, mmmns, smplmmm, smplnh or smplh");
  }
  if (points.size() != 73 * trans.size()) {
    raise<shape_error>(205, "select_joints: ", points.size(), " points for ", trans.size(), " frames of 73");
  }
  const std::size_t joints = mmm ? mmm_of_smplh.size() : name == "smplnh" ? 22 : 73;
  std::vector<Vec3<S>> out;
  out.reserve(trans.size() * joints);
  for (std::size_t t = 0; t < trans.size(); ++t) {
    for (std::size_t j = 0; j < joints; ++j) {
      const Vec3<S> p = (scaled ? S(640) : S(1)) * points[73 * t + (mmm ? mmm_of_smplh[j] : j)];
      out.push_back(y_up ? Vec3<S>{p.y, p.z, -p.x} : p);
    }
  }
  if (out.empty()) return out;
  const Vec3<S> shift = trans[0] - out[0];
  for (Vec3<S>& p : out) p = p + shift;
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_NORMALIZER_HPP  // <motionlang/features/normalizer.hpp>
#define MOTIONLANG_HAS_FEATURES_NORMALIZER_HPP
/// Features to zero mean and unit deviation, and back.

namespace motionlang::inline MOTIONLANG_ABI {

///     x' = (x - mean) / (std + eps),   x = x' (std + eps) + mean
/// Statistics are saved with a model but not trained. eps matters only where std is 0.
template <Backend B>
struct Normalizer {
  static constexpr bool trainable = false;
  Tensor<B, 1> mean, std;  // (features)
  double eps = 1e-12;

  static constexpr auto fields() {
    return motionlang::fields("mean", &Normalizer::mean, "std", &Normalizer::std, "eps", &Normalizer::eps);
  }
  /// Statistics that change nothing.
  static Normalizer identity(Index features) {
    return {Tensor<B, 1>::zeros({features}), Tensor<B, 1>::full({features}, 1)};
  }

  template <int R>
  Tensor<B, R> normalize(const Tensor<B, R>& x) const {
    return (x - mean) / (std + eps);
  }
  template <int R>
  Tensor<B, R> denormalize(const Tensor<B, R>& x) const {
    return x * (std + eps) + mean;
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_POSE_REPRESENTATION_HPP  // <motionlang/features/pose_representation.hpp>
#define MOTIONLANG_HAS_FEATURES_POSE_REPRESENTATION_HPP
/// Rotations as numbers of a feature vector, the way ACTOR, TEMOS, TEACH and SINC write them, and ACTOR's motions made
/// of them.
///
///     rotvec   3   rotation vector, radians
///     rotquat  4   quaternion, w first
///     rotmat   9   matrix, row by row
///     rot6d    6   first two rows of the matrix; what all published models use
///
/// Source  ACTOR (Petrovich et al., ICCV 2021), src/datasets/dataset.py; conversions: geometry/pytorch3d.hpp;
///         spec actor.md 4.1, 4.2

namespace motionlang::inline MOTIONLANG_ABI {

enum class PoseRepresentation : int { rotvec, rotquat, rotmat, rot6d };
inline constexpr std::array<std::string_view, 4> pose_representation_names{"rotvec", "rotquat", "rotmat", "rot6d"};

/// Numbers of one rotation.
constexpr Index size(PoseRepresentation r) {
  constexpr Index sizes[] = {3, 4, 9, 6};
  return sizes[static_cast<int>(r)];
}
/// Throws config_error 103.
inline PoseRepresentation parse_pose_representation(std::string_view name) {
  for (std::size_t i = 0; i < pose_representation_names.size(); ++i) {
    if (name == pose_representation_names[i]) return static_cast<PoseRepresentation>(i);
  }
  raise<config_error>(103, "parse_pose_representation: '", name, "' is not rotvec, rotquat, rotmat or rot6d");
}

namespace detail {

template <Scalar S>
void append_vector(std::vector<S>& out, const Vec3<S>& v) {
  out.insert(out.end(), {v.x, v.y, v.z});
}
template <Scalar S>
void append_quaternion(std::vector<S>& out, const Quaternion<S>& q) {
  out.insert(out.end(), {q.w, q.x, q.y, q.z});
}

}  // namespace detail

/// Appends the numbers of a matrix.
template <Scalar S>
void append_rotation(std::vector<S>& out, PoseRepresentation r, const Matrix3<S>& m) {
  switch (r) {
    case PoseRepresentation::rotvec:
      return detail::append_vector(out, pytorch3d::matrix_to_axis_angle(m));
    case PoseRepresentation::rotquat:
      return detail::append_quaternion(out, pytorch3d::matrix_to_quaternion(m));
    default:
      out.insert(out.end(), m.m.begin(), m.m.begin() + size(r));  // rows
  }
}
/// Appends the numbers of a rotation vector, which rotvec keeps as it is.
template <Scalar S>
void append_rotation(std::vector<S>& out, PoseRepresentation r, const AxisAngle<S>& v) {
  if (r == PoseRepresentation::rotvec) return detail::append_vector(out, v.v);
  if (r == PoseRepresentation::rotquat) return detail::append_quaternion(out, to_quaternion(v));
  append_rotation(out, r, to_matrix(v));
}
/// The matrix of the numbers. Throws shape_error 205.
template <Scalar S>
Matrix3<S> rotation_from(PoseRepresentation r, std::span<const S> n) {
  if (std::ssize(n) != size(r)) {
    raise<shape_error>(205, "rotation_from: ", n.size(), " numbers for '",
                       pose_representation_names[static_cast<std::size_t>(r)], "' of ", size(r));
  }
  switch (r) {
    case PoseRepresentation::rotvec:
      return to_matrix(AxisAngle<S>{{n[0], n[1], n[2]}});
    case PoseRepresentation::rotquat:
      return to_matrix(Quaternion<S>{n[0], n[1], n[2], n[3]});
    case PoseRepresentation::rotmat:
      return {{n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]}};
    default:
      return to_matrix(Rotation6dRows<S>{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
  }
}

struct ActorFeatureOptions {
  PoseRepresentation rotations = PoseRepresentation::rot6d;
  bool translation = true;  // one more row: the root's way since frame 0, filled up with zeros
  bool global = true;       // false: without joint 0
};

/// What ACTOR's networks read.
/// poses    (frames, joints)
/// root     (frames), the pelvis; read if `translation` is on
/// result   (rows, numbers, frames): a row for each joint, then the root's
/// Throws   shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> actor_features(std::span<const AxisAngle<S>> poses, std::span<const Vec3<S>> root, Index joints,
                              const ActorFeatureOptions& options = {}) {
  const Index frames = joints > 0 ? std::ssize(poses) / joints : 0, numbers = size(options.rotations);
  if (joints < 1 || std::ssize(poses) != frames * joints || (options.translation && std::ssize(root) != frames)) {
    raise<shape_error>(205, "actor_features: ", poses.size(), " rotations of ", joints, " joints, ", root.size(),
                       " root positions");
  }
  const Index first = options.global ? 0 : 1, rows = joints - first + (options.translation ? 1 : 0);
  std::vector<S> out(static_cast<std::size_t>(rows * numbers * frames)), row;
  for (Index t = 0; t < frames; ++t) {
    row.clear();
    for (Index j = first; j < joints; ++j) {
      append_rotation(row, options.rotations, poses[static_cast<std::size_t>(t * joints + j)]);
    }
    if (options.translation) detail::append_vector(row, root[static_cast<std::size_t>(t)] - root[0]);
    for (std::size_t i = 0; i < row.size(); ++i)
      out[i * static_cast<std::size_t>(frames) + static_cast<std::size_t>(t)] = row[i];
  }
  return out;
}

/// The same of positions (its representation "xyz"), with the root of frame 0 at the origin.
/// joints (frames, joints) -> (joints, 3, frames). Throws shape_error 205.
template <Scalar S>
std::vector<S> actor_joint_features(std::span<const Vec3<S>> positions, Index joints) {
  if (joints < 1 || std::ssize(positions) % joints != 0) {
    raise<shape_error>(205, "actor_joint_features: ", positions.size(), " positions for frames of ", joints);
  }
  const std::size_t n = static_cast<std::size_t>(joints), frames = positions.size() / n;
  std::vector<S> out(3 * positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3<S> p = positions[i] - positions[0];
    S* to = &out[3 * (i % n) * frames + i / n];
    to[0] = p.x, to[frames] = p.y, to[2 * frames] = p.z;
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_RIFKE_HPP  // <motionlang/features/rifke.hpp>
#define MOTIONLANG_HAS_FEATURES_RIFKE_HPP
/// Rotation invariant forward kinematic encoding of joint positions ("rifke"): TEMOS' 64 numbers of the 21 joints of
/// MMM, SINC's 67 and TMR's 67 or 73 of SMPL's joints. There and back.
///
///     0             height of the root above the floor
///     1:3J-2        joints 1 ... J-1 seen from the body: x', then y and z as the world has them, one of them turned
///     3J-2          turn of the heading, radians per frame
///     3J-1:3J+1     velocity of the root over the ground, seen from the body, per frame
/// World: Y up with x, z level (TEMOS, any unit), or Z up with x, y level (SINC, TMR).
///
/// Source  Holden et al., "A deep learning framework for character motion synthesis and editing" (SIGGRAPH 2016); TEMOS
///         joints2jfeats/rifke.py, SINC, TMR src/rifke.py; specs temos.md 4.1, sinc.md 9, tmr.md 4.1

#ifndef MOTIONLANG_HAS_FEATURES_SMPLRIFKE_HPP  // <motionlang/features/smplrifke.hpp>
#define MOTIONLANG_HAS_FEATURES_SMPLRIFKE_HPP
/// The 205-vector "smplrifke" of MDM-SMPL and STMC: forward, inverse, and from and to `Motion`. Index ranges of body
/// parts are in layout.hpp.
///
///     0        height of the pelvis above the lowest joint of the clip
///     1:3      its velocity x, y, seen from the body
///     3        turn of the heading to the next frame
///     4:136    22 rotations as 6D rows (rotation6d.hpp)
///     136:205  joints 1 ... 23 relative to the pelvis, seen from the body
/// World: Z up, metres, radians; velocities and turns per frame (the models use 20 frames per second).
/// Source   STMC (Petrovich et al. 2024), src/tools/smplrifke_feats.py

namespace motionlang::inline MOTIONLANG_ABI {

inline constexpr Index smplrifke_size = 205, smplrifke_rotations = 22, smplrifke_joints = 24;

struct SmplRifkeOptions {
  double first_angle = 0;  // heading of the first frame; every published generation takes pi
  bool clamp_asin = true;  // false: as published, where rounding beyond [-1, 1] gives NaN
};

/// A clip in the features' own world (Z up).
template <Scalar S>
struct SmplRifkeMotion {
  std::vector<Vec3<S>> joints;        // (frames, 24)
  std::vector<Vec3<S>> trans;         // (frames): the pelvis
  std::vector<Matrix3<S>> rotations;  // (frames, 22), local; joint 0 in the world

  /// Rotation vectors (frames, 66) by the published formulas (geometry/pytorch3d.hpp), noisy near 0 in float.
  std::vector<S> poses() const {
    std::vector<S> out;
    for (const Matrix3<S>& r : rotations) {
      const Vec3<S> v = pytorch3d::matrix_to_axis_angle(r);
      out.insert(out.end(), {v.x, v.y, v.z});
    }
    return out;
  }
};

namespace detail {

/// R = Rz Ry Rx:  z = atan2(m10, m00), y = asin(-m20), x = atan2(m21, m22).
template <Scalar S>
struct EulerZyx {
  S z, y, x;
};
template <Scalar S>
EulerZyx<S> zyx_angles(const Matrix3<S>& m, bool clamp) {
  const S sine = -m(2, 0), limited = clamp ? std::clamp(sine, S(-1), S(1)) : sine;
  return {std::atan2(m(1, 0), m(0, 0)), std::asin(limited), std::atan2(m(2, 1), m(2, 2))};
}
/// The rotation without its heading.
template <Scalar S>
Matrix3<S> level(const EulerZyx<S>& angles) {
  return axis_rotation(1, angles.y) * axis_rotation(0, angles.x);
}
/// x and y turned by `angle` about Z.
template <Scalar S>
Vec3<S> turn_about_z(const Vec3<S>& v, S angle) {
  const S c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}
/// The same angle in [-pi, pi].
template <Scalar S>
S wrapped(S angle) {
  return std::atan2(std::sin(angle), std::cos(angle));
}
/// Differences to the next frame; the last one continues its two predecessors in a line. Of two frames: the same again;
/// of one: zero (the published code fails there).
template <class T, class Difference>
std::vector<T> to_next(std::size_t frames, Difference difference) {
  std::vector<T> d(frames);
  for (std::size_t i = 0; i + 1 < frames; ++i) d[i] = difference(i);
  if (frames >= 3) d[frames - 1] = d[frames - 2] + (d[frames - 2] - d[frames - 3]);
  if (frames == 2) d[1] = d[0];
  return d;
}

}  // namespace detail

/// rotations  (frames, 22), local; joint 0 in the world
/// joints     (frames, 24), world
/// result     (frames, 205)
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> smplrifke_features(std::span<const Matrix3<S>> rotations, std::span<const Vec3<S>> joints) {
  const std::size_t frames = joints.size() / smplrifke_joints;
  if (joints.size() != frames * smplrifke_joints || rotations.size() != frames * smplrifke_rotations) {
    raise<shape_error>(205, "smplrifke_features: ", joints.size(), " joints and ", rotations.size(),
                       " rotations; expected 24 and 22 for every frame");
  }
  auto pelvis = [&](std::size_t f) -> const Vec3<S>& { return joints[f * smplrifke_joints]; };
  S floor = frames == 0 ? S(0) : joints[0].z;
  for (const Vec3<S>& p : joints) floor = std::min(floor, p.z);
  std::vector<detail::EulerZyx<S>> angles(frames);
  for (std::size_t f = 0; f < frames; ++f) angles[f] = detail::zyx_angles(rotations[f * smplrifke_rotations], true);
  const auto velocity = detail::to_next<Vec3<S>>(frames, [&](std::size_t f) { return pelvis(f + 1) - pelvis(f); });
  const auto turn =
      detail::to_next<S>(frames, [&](std::size_t f) { return detail::wrapped(angles[f + 1].z - angles[f].z); });

  std::vector<S> out;
  out.reserve(frames * smplrifke_size);
  auto put = [&](const Vec3<S>& v) { out.insert(out.end(), {v.x, v.y, v.z}); };
  for (std::size_t f = 0; f < frames; ++f) {
    const S heading = angles[f].z;
    const Vec3<S> speed = detail::turn_about_z(velocity[f], -heading);
    out.insert(out.end(), {pelvis(f).z - floor, speed.x, speed.y, detail::wrapped(turn[f])});
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = j == 0 ? detail::level(angles[f]) : rotations[f * smplrifke_rotations + j];
      put(r.row(0));
      put(r.row(1));
    }
    for (std::size_t j = 1; j < smplrifke_joints; ++j) {
      put(detail::turn_about_z(joints[f * smplrifke_joints + j] - pelvis(f), -heading));
    }
  }
  return out;
}

/// The same from rotation vectors (frames, 66) and joints (frames, 72).
template <Scalar S>
std::vector<S> smplrifke_from_poses(std::span<const S> poses, std::span<const S> joints) {
  if (poses.size() % 3 != 0 || joints.size() % 3 != 0) {
    raise<shape_error>(205, "smplrifke_from_poses: ", poses.size(), " and ", joints.size(), " values");
  }
  std::vector<Matrix3<S>> rotations;
  std::vector<Vec3<S>> points;
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    rotations.push_back(to_matrix(AxisAngle<S>{{poses[i], poses[i + 1], poses[i + 2]}}));
  }
  for (std::size_t i = 0; i < joints.size(); i += 3) points.push_back({joints[i], joints[i + 1], joints[i + 2]});
  return smplrifke_features(std::span<const Matrix3<S>>(rotations), std::span<const Vec3<S>>(points));
}

/// features  (frames, 205)
/// The path starts at x = y = 0 with the heading `first_angle`; the velocity and turn of the last frame are not used,
/// nor is what heading the first rotation contains.
/// Throws    shape_error 205 if the size is no multiple of 205
template <Scalar S>
SmplRifkeMotion<S> smplrifke_inverse(std::span<const S> features, const SmplRifkeOptions& options = {}) {
  if (features.size() % smplrifke_size != 0) {
    raise<shape_error>(205, "smplrifke_inverse: ", features.size(), " values are not rows of ", smplrifke_size);
  }
  const std::size_t frames = features.size() / smplrifke_size;
  SmplRifkeMotion<S> out;
  S heading = S(options.first_angle);
  Vec3<S> position{};
  for (std::size_t f = 0; f < frames; ++f) {
    const auto row = features.subspan(f * smplrifke_size, smplrifke_size);
    auto vector = [&](std::size_t at) { return Vec3<S>{row[at], row[at + 1], row[at + 2]}; };
    position.z = row[0];
    out.trans.push_back(position);
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = to_matrix(Rotation6dRows<S>{vector(4 + 6 * j), vector(7 + 6 * j)});
      const auto own =
          j == 0 ? axis_rotation(2, heading) * detail::level(detail::zyx_angles(r, options.clamp_asin)) : r;
      out.rotations.push_back(own);
    }
    out.joints.push_back(position);
    for (std::size_t j = 1; j < smplrifke_joints; ++j) {
      out.joints.push_back(detail::turn_about_z(vector(133 + 3 * j), heading) + position);
    }
    position = position + detail::turn_about_z(Vec3<S>{row[1], row[2], S(0)}, heading);
    heading = heading + row[3];
  }
  return out;
}

/// The features of a clip on SMPL's 24 joints, with the bones that its skeleton has; the hands' own rotations are lost.
/// Resample to the rate of the model first. Throws config_error 103 if the joints are not SMPL's.
inline std::vector<double> smplrifke_from_motion(const Motion& motion) {
  if (motion.skeleton.names != smpl24_skeleton().names || motion.skeleton.parents != smpl24_skeleton().parents) {
    raise<config_error>(103, "smplrifke_from_motion: the ", motion.skeleton.size(), " joints of '", motion.name,
                        "' are not the 24 of SMPL; retarget first");
  }
  const auto z_up = axis_rotation(0, std::numbers::pi / 2);  // (x, y, z) -> (x, -z, y)
  std::vector<Matrix3<double>> rotations;
  std::vector<Vec3<double>> joints;
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    for (const Vec3<double>& p : world.position) joints.push_back({p.x, -p.z, p.y});
    rotations.push_back(z_up * world.rotation[0]);
    for (const auto& q : motion.rotations(f).subspan(1, smplrifke_rotations - 1)) rotations.push_back(to_matrix(q));
  }
  return smplrifke_features(std::span<const Matrix3<double>>(rotations), std::span<const Vec3<double>>(joints));
}

/// The clip that the features describe, Y up, on a skeleton with SMPL's 24 joints: rotations and the path are taken,
/// positions of joints are not, so bones keep their lengths. With first_angle 0 the first frame faces +Z, up to what
/// the pelvis itself turns. Throws shape_error 205, config_error 103 if the joints are not SMPL's.
template <Scalar S>
Motion smplrifke_to_motion(std::span<const S> features, const SmplRifkeOptions& options = {}, double fps = 20,
                           const Skeleton& skeleton = smpl24_skeleton()) {
  if (skeleton.names != smpl24_skeleton().names) {
    raise<config_error>(103, "smplrifke_to_motion: the ", skeleton.size(), " joints are not the 24 of SMPL");
  }
  const auto from = smplrifke_inverse(features, options);
  const auto y_up = axis_rotation(0, -std::numbers::pi / 2);
  Motion out;
  out.skeleton = skeleton;
  out.fps = fps;
  for (std::size_t f = 0; f < from.trans.size(); ++f) {
    const auto p = vec_cast<double>(from.trans[f]);
    out.root.push_back({p.x, p.z, -p.y});
    for (std::size_t j = 0; j < smplrifke_rotations; ++j) {
      const auto r = matrix_cast<double>(from.rotations[f * smplrifke_rotations + j]);
      out.local.push_back(to_quaternion(j == 0 ? y_up * r : r));
    }
    out.local.insert(out.local.end(), 2, Quaternion<double>::identity());  // hands
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// One of the published variants, or one of one's own.
struct RifkeVariant {
  Index joints = 0;
  bool z_up = false;
  std::array<std::array<int, 2>, 2> across{};  // pairs (right, left) whose difference points across the body
  std::vector<int> floor{};                    // the lowest of these gives the floor; none: height 0
  bool wrapped_turns = true;                   // turns in (-pi, pi]; false: they jump where the heading passes pi
  bool swapped_forward = false;      // sine and cosine are (-x, y) of the vector across; false: (-y, x), straight ahead
  bool forward_differences = false;  // turns and velocities to the next frame; false: from the one before
  Index size() const { return 3 * joints + 1; }
};

/// TEMOS and TEACH's metrics. The heading is that of knees and elbows, as published (an index is off by one).
inline RifkeVariant temos_rifke() {
  return {.joints = 21, .across = {{{17, 12}, {9, 6}}}, .floor = {14, 15, 19, 20}, .wrapped_turns = false};
}
/// SINC's metrics, whose heading is swapped as published.
inline RifkeVariant sinc_rifke() {
  return {.joints = 22, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .floor = {7, 10, 8, 11}, .swapped_forward = true};
}
/// TMR's canonical view; 22 or 24 joints of SMPL.
inline RifkeVariant tmr_rifke(Index joints = 22) {
  return {.joints = joints, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .forward_differences = true};
}

template <Scalar S>
struct RifkeFeatures {
  std::vector<S> features;                // (frames, 3 J + 1)
  S floor{};                              // height of the floor
  std::vector<std::array<S, 2>> forward;  // (frames): sine and cosine of the heading
  std::vector<S> angles;                  // (frames): the heading
};

namespace detail {

/// Level coordinates and height of a vector.
template <Scalar S>
struct LevelVector {
  S a{}, b{}, height{};
};
template <Scalar S>
LevelVector<S> leveled(const Vec3<S>& v, bool z_up) {
  return z_up ? LevelVector<S>{v.x, v.y, v.z} : LevelVector<S>{v.x, v.z, v.y};
}
template <Scalar S>
Vec3<S> unleveled(const LevelVector<S>& v, bool z_up) {
  return z_up ? Vec3<S>{v.a, v.b, v.height} : Vec3<S>{v.a, v.height, v.b};
}
/// Into the body's view: a' = a cos - b sin, b' = a sin + b cos. With -sine: back.
template <Scalar S>
LevelVector<S> turned(const LevelVector<S>& v, S sine, S cosine) {
  return {v.a * cosine - v.b * sine, v.a * sine + v.b * cosine, v.height};
}
inline std::size_t rifke_frames(std::string_view function, std::size_t values, Index per_frame) {
  if (per_frame < 2 || static_cast<Index>(values) % per_frame != 0) {
    raise<shape_error>(205, function, ": ", values, " values are no frames of ", per_frame);
  }
  return values / static_cast<std::size_t>(per_frame);
}
/// Throws shape_error 203 for a joint that the variant names but does not have.
inline void require_joints(const RifkeVariant& variant) {
  auto require = [&](int joint) {
    if (joint < 0 || joint >= variant.joints) raise<shape_error>(203, "rifke: joint ", joint, " of ", variant.joints);
  };
  for (const auto& [right, left] : variant.across) require(right), require(left);
  for (const int joint : variant.floor) require(joint);
}
/// Smoothing with sigma 2 and zeros beyond the ends.
template <Scalar S>
void filter_forward(std::vector<std::array<S, 2>>& forward) {
  constexpr std::size_t radius = 8;
  std::vector<S> padded((forward.size() + 2 * radius) * 2);
  for (std::size_t t = 0; t < forward.size(); ++t) std::copy_n(forward[t].begin(), 2, &padded[2 * (t + radius)]);
  const auto smooth = gaussian_smooth(std::span<const S>(padded), 2, 2);
  for (std::size_t t = 0; t < forward.size(); ++t) {
    const Vec3<S> f = normalized(Vec3<S>{smooth[2 * (t + radius)], smooth[2 * (t + radius) + 1], S(0)});
    forward[t] = {f.x, f.y};
  }
}

}  // namespace detail

/// joints          (frames, J)
/// forward_filter  smooths the heading, as an option of TEMOS does
/// The floor is soft: m - ln(1/2 + exp(m - M)) for the lowest (m) and highest (M) of the lowest joint's heights.
/// Throws          shape_error 205, 203 if the variant names a joint that it does not have
template <Scalar S>
RifkeFeatures<S> rifke_features(const RifkeVariant& variant, std::span<const Vec3<S>> joints,
                                bool forward_filter = false) {
  const std::size_t frames = detail::rifke_frames("rifke_features", joints.size(), variant.joints);
  detail::require_joints(variant);
  const auto n = static_cast<std::size_t>(variant.joints);
  auto at = [&](std::size_t t, std::size_t j) { return detail::leveled(joints[t * n + j], variant.z_up); };
  RifkeFeatures<S> out;
  if (!variant.floor.empty() && frames > 0) {
    S lowest = std::numeric_limits<S>::infinity(), highest = -lowest;
    for (std::size_t t = 0; t < frames; ++t) {
      S height = std::numeric_limits<S>::infinity();
      for (const int j : variant.floor) height = std::min(height, at(t, static_cast<std::size_t>(j)).height);
      lowest = std::min(lowest, height), highest = std::max(highest, height);
    }
    out.floor = lowest - std::log(S(0.5) + std::exp(lowest - highest));
  }
  for (std::size_t t = 0; t < frames; ++t) {
    S a{}, b{};
    for (const auto& [right, left] : variant.across) {
      const auto r = at(t, static_cast<std::size_t>(right)), l = at(t, static_cast<std::size_t>(left));
      a += r.a - l.a, b += r.b - l.b;
    }
    const Vec3<S> f = normalized(variant.swapped_forward ? Vec3<S>{-a, b, S(0)} : Vec3<S>{-b, a, S(0)});
    out.forward.push_back({f.x, f.y});
  }
  if (forward_filter) detail::filter_forward(out.forward);
  for (const auto& [sine, cosine] : out.forward) out.angles.push_back(std::atan2(sine, cosine));

  auto turn = [&](std::size_t t) {
    const S d = out.angles[t + 1] - out.angles[t];
    return variant.wrapped_turns ? detail::wrapped(d) : d;
  };
  auto way = [&](std::size_t t) { return joints[(t + 1) * n] - joints[t * n]; };
  std::vector<S> turns(frames);
  std::vector<Vec3<S>> ways(frames);
  if (variant.forward_differences) {
    turns = detail::to_next<S>(frames, turn);
    ways = detail::to_next<Vec3<S>>(frames, way);
    if (variant.wrapped_turns && frames > 0) turns.back() = detail::wrapped(turns.back());
  } else {
    for (std::size_t t = 0; t + 1 < frames; ++t) turns[t + 1] = turn(t), ways[t + 1] = way(t);
  }
  out.features.reserve(frames * static_cast<std::size_t>(variant.size()));
  for (std::size_t t = 0; t < frames; ++t) {
    const auto [sine, cosine] = out.forward[t];
    const auto root = at(t, 0);
    out.features.push_back(root.height - out.floor);
    for (std::size_t j = 1; j < n; ++j) {
      const auto p = at(t, j);
      const detail::LevelVector<S> own{p.a - root.a, p.b - root.b, p.height - out.floor};
      const auto v = detail::unleveled(detail::turned(own, sine, cosine), variant.z_up);
      out.features.insert(out.features.end(), {v.x, v.y, v.z});
    }
    const auto v = detail::turned(detail::leveled(ways[t], variant.z_up), sine, cosine);
    out.features.insert(out.features.end(), {turns[t], v.a, v.b});
  }
  return out;
}

/// features  (frames, 3 J + 1), not normalised
/// result    (frames, J); frame 0 stands at the origin with heading 0, on the floor
/// Throws    shape_error 205
template <Scalar S>
std::vector<Vec3<S>> rifke_joints(const RifkeVariant& variant, std::span<const S> features) {
  const std::size_t frames = detail::rifke_frames("rifke_joints", features.size(), variant.size());
  const auto width = static_cast<std::size_t>(variant.size());
  std::vector<Vec3<S>> out;
  S angle{};
  detail::LevelVector<S> root{};
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * width, width);
    const S turn = row[width - 3];
    const detail::LevelVector<S> velocity{row[width - 2], row[width - 1], S(0)};
    auto step = [&] {
      const auto way = detail::turned(velocity, -std::sin(angle), std::cos(angle));
      root.a += way.a, root.b += way.b;
    };
    if (!variant.forward_differences && t > 0) angle += turn, step();
    root.height = row[0];
    out.push_back(detail::unleveled(root, variant.z_up));
    for (std::size_t at = 1; at + 3 < width; at += 3) {
      const auto own = detail::leveled(Vec3<S>{row[at], row[at + 1], row[at + 2]}, variant.z_up);
      const auto p = detail::turned(own, -std::sin(angle), std::cos(angle));
      out.push_back(detail::unleveled<S>({p.a + root.a, p.b + root.b, p.height}, variant.z_up));
    }
    if (variant.forward_differences) step(), angle += turn;
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_SMPLVELP_HPP  // <motionlang/features/smplvelp.hpp>
#define MOTIONLANG_HAS_FEATURES_SMPLVELP_HPP
/// The 135-vector of TEMOS ("smplvelp"), TEACH and SINC ("Globalvelandy"): height, velocity over the ground, rotations.
///
///     0        height of the translation, as it is
///     1:3      its velocity x, y; 0 in the first frame
///     3:135    22 rotations as two rows of the matrix: the body in the world, then joints 1 ... 21
/// World: Z up, metres; velocities per frame (TEMOS 12.5 frames per second, TEACH and SINC 30).
///
/// Source  TEMOS (Petrovich et al., ECCV 2022), rots2rfeats/smplvelp.py; TEACH (Athanasiou et al., 3DV 2022),
///         globvelandy.py; specs temos.md 4.2, teach.md 1. Normalise with eps 1e-12, SINC with 1e-5 both ways.

namespace motionlang::inline MOTIONLANG_ABI {

struct SmplVelpOptions {
  PoseRepresentation rotations = PoseRepresentation::rot6d;
  /// Turns the clip about Z by what `exact_yaw` says of the first frame (and a quarter, `offset`).
  bool canonicalize = true;
  bool offset = true;
  /// false, as published: the z of the first rotation vector, which is no heading, so that a second pass turns again.
  /// true: the heading, and clips that differ by a turn about Z become the same.
  bool exact_yaw = false;
};

template <Scalar S>
struct SmplVelpMotion {
  std::vector<Matrix3<S>> rotations;  // (frames, joints); joint 0 in the world
  std::vector<Vec3<S>> trans;         // (frames)
};

/// rotations  (frames, joints); joint 0 in the world
/// trans      (frames)
/// result     (frames, 3 + 6 joints), or 3 + 4 joints for quaternions, ...
/// Throws     shape_error 205 if the sizes do not fit
template <Scalar S>
std::vector<S> smplvelp_features(std::span<const Matrix3<S>> rotations, std::span<const Vec3<S>> trans,
                                 const SmplVelpOptions& options = {}) {
  const std::size_t frames = trans.size(), joints = frames == 0 ? 0 : rotations.size() / frames;
  if (rotations.size() != frames * joints || (frames > 0 && joints == 0)) {
    raise<shape_error>(205, "smplvelp_features: ", rotations.size(), " rotations for ", frames, " frames");
  }
  std::vector<S> out;
  if (frames == 0) return out;
  S angle{};
  if (options.canonicalize) {
    angle =
        options.exact_yaw ? detail::zyx_angles(rotations[0], true).z : pytorch3d::matrix_to_axis_angle(rotations[0]).z;
    if (options.offset) angle += S(std::numbers::pi / 2);
  }
  const Matrix3<S> back = axis_rotation(2, -angle);
  for (std::size_t t = 0; t < frames; ++t) {
    const Vec3<S> velocity = back * (trans[t] - trans[t == 0 ? 0 : t - 1]);
    out.insert(out.end(), {trans[t].z, velocity.x, velocity.y});
    for (std::size_t j = 0; j < joints; ++j) {
      const Matrix3<S>& r = rotations[t * joints + j];
      append_rotation(out, options.rotations, j == 0 ? back * r : r);
    }
  }
  return out;
}

/// features  (frames, 3 + 6 joints), not normalised
/// The path starts at x = y = 0; the heading stays what the features say. Throws shape_error 205.
template <Scalar S>
SmplVelpMotion<S> smplvelp_inverse(std::span<const S> features, Index joints = 22,
                                   PoseRepresentation representation = PoseRepresentation::rot6d) {
  const Index numbers = size(representation), width = 3 + numbers * joints;
  if (joints < 1 || std::ssize(features) % width != 0) {
    raise<shape_error>(205, "smplvelp_inverse: ", features.size(), " values are no rows of ", width);
  }
  SmplVelpMotion<S> out;
  Vec3<S> position{};
  for (std::size_t at = 0; at < features.size(); at += static_cast<std::size_t>(width)) {
    if (at > 0) position = position + Vec3<S>{features[at + 1], features[at + 2], S(0)};
    position.z = features[at];
    out.trans.push_back(position);
    for (Index j = 0; j < joints; ++j) {
      const auto own =
          features.subspan(at + 3 + static_cast<std::size_t>(numbers * j), static_cast<std::size_t>(numbers));
      out.rotations.push_back(rotation_from(representation, own));
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_FEATURES_STATISTICS_HPP  // <motionlang/features/statistics.hpp>
#define MOTIONLANG_HAS_FEATURES_STATISTICS_HPP
/// Mean and standard deviation of every feature over many clips, one frame at a time.
///
///     n_k = n_{k-1} + 1,  d = x - mean,  mean += d / n,  m2 += d (x - mean);   std = sqrt(m2 / (n - 1))
///
/// Source  Welford, "Note on a method for calculating corrected sums of squares" (Technometrics 1962). The published
///         scripts (TEMOS, TMR) concatenate all clips and take torch's unbiased deviation: the same up to rounding.
///         HumanML3D takes the deviation of the population, n in place of n - 1, skips clips with NaN, and replaces
///         each deviation by the mean of its group (spec humanml3d-features.md 9):
///
///     for (const auto& clip : clips) statistics.add_finite(std::span<const float>(clip), slots.size());
///     auto std = group_means(statistics.population_deviation(), slots.groups());

namespace motionlang::inline MOTIONLANG_ABI {

class FeatureStatistics {
 public:
  /// Adds the frames of a clip, (frames, features) row by row. Throws shape_error 205 if the values are not whole
  /// frames, 204 if the clips before had another number of features.
  template <Scalar S>
  void add(std::span<const S> frames, Index features) {
    if (features <= 0 || std::ssize(frames) % features != 0) {
      raise<shape_error>(205, "FeatureStatistics: ", frames.size(), " values in frames of ", features);
    }
    if (mean_.empty()) {
      mean_.resize(static_cast<std::size_t>(features));
      squares_.resize(static_cast<std::size_t>(features));
    }
    if (std::ssize(mean_) != features) {
      raise<shape_error>(204, "FeatureStatistics: ", features, " features after ", mean_.size());
    }
    for (std::size_t at = 0; at < frames.size(); at += mean_.size()) {
      ++count_;
      for (std::size_t i = 0; i < mean_.size(); ++i) {
        const double x = static_cast<double>(frames[at + i]), d = x - mean_[i];
        mean_[i] += d / static_cast<double>(count_);
        squares_[i] += d * (x - mean_[i]);
      }
    }
  }

  /// The same, but a clip with a value that is not finite is left out. Returns whether it was added.
  template <Scalar S>
  bool add_finite(std::span<const S> frames, Index features) {
    const bool finite = std::all_of(frames.begin(), frames.end(), [](S x) { return std::isfinite(x); });
    if (finite) add(frames, features);
    return finite;
  }

  /// Frames so far.
  Index count() const { return count_; }
  const std::vector<double>& mean() const { return mean_; }
  /// Unbiased (divided by n - 1). Throws numeric_error 302 below two frames.
  std::vector<double> standard_deviation() const { return deviation(2); }
  /// Of these frames themselves (divided by n). Throws numeric_error 302 of no frame.
  std::vector<double> population_deviation() const { return deviation(1); }

 private:
  std::vector<double> deviation(Index least) const {
    if (count_ < least) raise<numeric_error>(302, "FeatureStatistics: a deviation of ", count_, " frames");
    std::vector<double> out;
    for (double s : squares_) out.push_back(std::sqrt(s / static_cast<double>(count_ + 1 - least)));
    return out;
  }

  Index count_ = 0;
  std::vector<double> mean_, squares_;
};

/// Every value replaced by the mean of its group. Throws shape_error 203 if a group is empty or ends behind the values.
inline std::vector<double> group_means(std::vector<double> values, std::span<const IndexRange> groups) {
  for (const IndexRange& g : groups) {
    if (g.begin < 0 || g.size() <= 0 || g.end > std::ssize(values)) {
      raise<shape_error>(203, "group_means: the group ", g.begin, ":", g.end, " of ", values.size(), " values");
    }
    const auto first = values.begin() + g.begin, last = values.begin() + g.end;
    std::fill(first, last, std::accumulate(first, last, 0.0) / static_cast<double>(g.size()));
  }
  return values;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_DENOISER_HPP  // <motionlang/diffusion/denoiser.hpp>
#define MOTIONLANG_HAS_DIFFUSION_DENOISER_HPP
/// What a denoising network must be, for samplers and for STMC.

#ifndef MOTIONLANG_HAS_DIFFUSION_GAUSSIAN_HPP  // <motionlang/diffusion/gaussian.hpp>
#define MOTIONLANG_HAS_DIFFUSION_GAUSSIAN_HPP
/// The Gaussian diffusion process: all coefficients of a schedule, noising, the posterior, and the four things that a
/// network may predict, converted into each other.
///
/// Notation (Ho et al. 2020)   beta_t, alpha_t = 1 - beta_t, abar_t = prod_{s <= t} alpha_s, abarp_t = abar_{t-1} (1
///                             for t = 0), abarn_t = abar_{t+1} (0 for the last). Index t stands for t + 1 applications of noise.
/// Precision   tables are built in double, the entry for t is rounded to the tensor's scalar, then one multiplication
///             and one addition per term in the order written: what the published code does, and what parity needs.

#ifndef MOTIONLANG_HAS_DIFFUSION_RESPACING_HPP  // <motionlang/diffusion/respacing.hpp>
#define MOTIONLANG_HAS_DIFFUSION_RESPACING_HPP
/// Which steps of a long process a short sampling run keeps.

namespace motionlang::inline MOTIONLANG_ABI {

/// One section of nearly equal size per count; in each, `count` steps evenly from its first to its last, rounded half
/// to even. Source  improved diffusion (Nichol and Dhariwal 2021), `space_timesteps`. Throws config_error 105.
inline std::vector<Index> respace(Index steps, std::span<const Index> counts) {
  std::vector<Index> kept;
  const auto sections = static_cast<Index>(counts.size());
  if (sections == 0) raise<config_error>(105, "respacing: no sections");
  Index begin = 0;
  for (Index i = 0; i < sections; ++i) {
    const Index size = steps / sections + (i < steps % sections ? 1 : 0), count = counts[static_cast<std::size_t>(i)];
    if (count < 1 || size < count)
      raise<config_error>(105, "respacing: cannot take ", count, " of ", size, " steps in section ", i);
    const double stride = count > 1 ? static_cast<double>(size - 1) / static_cast<double>(count - 1) : 1;
    double position = 0;
    for (Index k = 0; k < count; ++k, position += stride)
      kept.push_back(begin + static_cast<Index>(std::nearbyint(position)));
    begin += size;
  }
  return kept;
}

/// "ddimN": the smallest stride that keeps N steps, starting at 0; or a list of counts "10,15,20" (one number is one
/// section). Empty: all steps. Throws config_error 105.
inline std::vector<Index> respace(Index steps, std::string_view specification) {
  auto number = [&](std::string_view digits) {
    Index n = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
    if (error != std::errc{} || end != digits.data() + digits.size() || n < 1) {
      raise<config_error>(105, "respacing: '", specification, "' is neither ddimN nor a list of counts");
    }
    return n;
  };
  if (specification.empty()) return respace(steps, std::vector<Index>{steps});
  if (specification.starts_with("ddim")) {
    const Index wanted = number(specification.substr(4));
    for (Index stride = 1; stride < steps; ++stride) {
      if ((steps + stride - 1) / stride != wanted) continue;
      std::vector<Index> kept;
      for (Index t = 0; t < steps; t += stride) kept.push_back(t);
      return kept;
    }
    raise<config_error>(105, "respacing: no stride keeps ", wanted, " of ", steps, " steps");
  }
  std::vector<Index> counts;
  for (std::size_t at = 0; at <= specification.size();) {
    const std::size_t comma = std::min(specification.find(',', at), specification.size());
    counts.push_back(number(specification.substr(at, comma - at)));
    at = comma + 1;
  }
  return respace(steps, counts);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_SCHEDULE_HPP  // <motionlang/diffusion/schedule.hpp>
#define MOTIONLANG_HAS_DIFFUSION_SCHEDULE_HPP
/// Noise schedules: how much noise step t adds.

namespace motionlang::inline MOTIONLANG_ABI {

/// A forward process q(x_t | x_{t-1}) = N(sqrt(1 - beta_t) x_{t-1}, beta_t I), t = 0 ... steps-1.
/// Minimum   steps, beta(t)
/// Deduced   everything in gaussian.hpp
/// Laws      0 < beta(t) <= 1 (checked where the tables are built)
/// Models    LinearSchedule, ScaledLinearSchedule, CosineSchedule, ChenCosineSchedule, BetaList
template <class S>
concept Schedule = requires(const S& s, Index t) {
  { s.steps } -> std::convertible_to<Index>;
  { s.beta(t) } -> std::convertible_to<double>;
};

/// Ho et al. (2020), rescaled so that any number of steps ends in the same noise:
///     beta_t from 0.0001 c to 0.02 c, c = scale_betas 1000 / steps
struct LinearSchedule {
  Index steps = 1000;
  double scale_betas = 1;

  double beta(Index t) const {
    const double c = scale_betas * 1000 / static_cast<double>(steps), low = c * 0.0001, high = c * 0.02;
    return steps == 1 ? low : low + (high - low) * static_cast<double>(t) / static_cast<double>(steps - 1);
  }
};

/// Linear in the square root, as latent diffusion has it.
struct ScaledLinearSchedule {
  Index steps = 1000;
  double b0 = 0.00085, b1 = 0.012;

  double beta(Index t) const {
    const double a = std::sqrt(b0), b = std::sqrt(b1);
    const double r = steps == 1 ? a : a + (b - a) * static_cast<double>(t) / static_cast<double>(steps - 1);
    return r * r;
  }
};

/// Nichol and Dhariwal (2021), eq. 17; the schedule of MDM and, with 100 steps, of STMC (the thesis cites Chen 2023,
/// the released code has this one):
///     f(u) = cos((u + s) / (1 + s) pi / 2)^2,   beta_t = min(1 - f((t + 1) / steps) / f(t / steps), 0.999)
struct CosineSchedule {
  Index steps = 100;
  double s = 0.008;

  double beta(Index t) const {
    auto f = [&](double u) {
      const double c = std::cos((u + s) / (1 + s) * std::numbers::pi / 2);
      return c * c;
    };
    const double n = static_cast<double>(steps), i = static_cast<double>(t);
    return std::min(1 - f((i + 1) / n) / f(i / n), 0.999);
  }
};

/// Chen (2023), what the thesis cites; no published checkpoint uses it.
///     v(u) = cos((u (end - start) + start) pi / 2)^(2 tau)
///     alpha_bar(u) = clip((v(1) - v(u)) / (v(1) - v(0)), clip_min, 1)
struct ChenCosineSchedule {
  Index steps = 100;
  double start = 0, end = 1, tau = 1, clip_min = 1e-9;

  double alpha_bar(double u) const {
    auto v = [&](double x) { return std::pow(std::cos((x * (end - start) + start) * std::numbers::pi / 2), 2 * tau); };
    return std::clamp((v(1) - v(u)) / (v(1) - v(0)), clip_min, 1.0);
  }
  double beta(Index t) const {
    const double n = static_cast<double>(steps), i = static_cast<double>(t);
    return std::min(1 - alpha_bar((i + 1) / n) / alpha_bar(i / n), 0.999);
  }
};

/// Any list, for example the betas of a respaced process.
struct BetaList {
  std::vector<double> betas;
  Index steps = static_cast<Index>(betas.size());

  double beta(Index t) const { return betas[static_cast<std::size_t>(t)]; }
};

static_assert(Schedule<LinearSchedule> && Schedule<ScaledLinearSchedule> && Schedule<CosineSchedule> &&
              Schedule<ChenCosineSchedule> && Schedule<BetaList>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// What a network says about x_t.
enum class Prediction { x0, eps, score, x_prev };

/// How much noise an ancestral step adds.
///   posterior_std        the standard deviation of q(x_{t-1} | x_t, x0), 0 at t = 0: DDPM as written in the papers
///   posterior_variance   the variance itself: a quirk of the released STMC code with which all its results were made
enum class NoiseScale { posterior_std, posterior_variance };

/// fixed_small: the posterior variance; fixed_large: beta_t (and the posterior variance at t = 1 for t = 0).
enum class Variance { fixed_small, fixed_large };

class GaussianDiffusion {
 public:
  /// Throws config_error 104 if a beta is outside (0, 1].
  template <Schedule S>
  explicit GaussianDiffusion(const S& schedule) {
    std::vector<double> betas;
    for (Index t = 0; t < static_cast<Index>(schedule.steps); ++t) betas.push_back(schedule.beta(t));
    build(std::move(betas));
    for (Index t = 0; t < steps(); ++t) network_t_.push_back(t);
  }
  /// The process that keeps only some steps (respacing.hpp): beta'_i = 1 - abar[S_i] / abar[S_{i-1}]. The network still
  /// receives the original numbers. Throws config_error 104, 105.
  GaussianDiffusion respaced(std::span<const Index> kept) const {
    std::vector<double> betas;
    double last = 1;
    for (Index t : kept) {
      if (t < 0 || t >= steps()) raise<config_error>(105, "respacing: step ", t, " of ", steps());
      betas.push_back(1 - abar(t) / last);
      last = abar(t);
    }
    GaussianDiffusion d{BetaList{betas}};
    d.network_t_.clear();
    for (Index t : kept) d.network_t_.push_back(network_t(t));
    return d;
  }

  Index steps() const { return static_cast<Index>(beta_.size()); }
  /// The number that the network is told at index t of this process.
  Index network_t(Index t) const { return network_t_[at(t)]; }

  double beta(Index t) const { return beta_[at(t)]; }
  double alpha(Index t) const { return 1 - beta_[at(t)]; }
  double abar(Index t) const { return abar_[at(t)]; }
  double abarp(Index t) const { return t == 0 ? 1 : abar_[at(t) - 1]; }
  double abarn(Index t) const { return t + 1 == steps() ? 0 : abar_[at(t) + 1]; }
  /// Variance of the posterior: beta_t (1 - abarp_t) / (1 - abar_t); 0 at t = 0.
  double posterior_variance(Index t) const { return beta(t) * (1 - abarp(t)) / (1 - abar(t)); }
  /// Its logarithm, with index 1 in place of index 0.
  double posterior_log_variance(Index t) const {
    return steps() == 1 ? std::log(1e-20) : std::log(posterior_variance(t == 0 ? 1 : t));
  }
  double large_variance(Index t) const {
    return t == 0 ? posterior_variance(std::min<Index>(1, steps() - 1)) : beta(t);
  }
  /// Weights of x0 and x_t in the posterior mean.
  double c0(Index t) const { return beta(t) * std::sqrt(abarp(t)) / (1 - abar(t)); }
  double ct(Index t) const { return (1 - abarp(t)) * std::sqrt(alpha(t)) / (1 - abar(t)); }

  /// Factor of the noise in an ancestral step; 0 at t = 0.
  double noise_factor(Index t, NoiseScale scale, Variance variance = Variance::fixed_small) const {
    if (t == 0) return 0;
    if (scale == NoiseScale::posterior_variance)
      return variance == Variance::fixed_small ? posterior_variance(t) : large_variance(t);
    return std::exp(0.5 *
                    (variance == Variance::fixed_small ? posterior_log_variance(t) : std::log(large_variance(t))));
  }

 private:
  void build(std::vector<double> betas) {
    double product = 1;
    for (std::size_t t = 0; t < betas.size(); ++t) {
      if (!(betas[t] > 0 && betas[t] <= 1))
        raise<config_error>(104, "diffusion schedule: beta[", t, "] = ", betas[t], " is not in (0, 1]");
      product *= 1 - betas[t];
      abar_.push_back(product);
    }
    if (betas.empty()) raise<config_error>(104, "diffusion schedule: no steps");
    beta_ = std::move(betas);
  }
  static std::size_t at(Index t) { return static_cast<std::size_t>(t); }

  std::vector<double> beta_, abar_;
  std::vector<Index> network_t_;
};

/// One coefficient per sample (leading index) as a tensor that broadcasts over the rest; rounded to the scalar.
template <Backend B, int R, class F>
Tensor<B, R> coefficients(std::span<const Index> t, F f) {
  PoolVector<typename B::scalar> values;
  for (Index i : t) values.push_back(static_cast<typename B::scalar>(f(i)));
  Shape s{static_cast<Index>(t.size())};
  for (int i = 1; i < R; ++i) s.push_back(1);
  return Tensor<B, R>::from(std::span<const typename B::scalar>(values), s);
}

/// x_t = sqrt(abar_t) x0 + sqrt(1 - abar_t) eps.   (Ho et al. 2020, eq. 4) One t per leading index, or one for all.
template <Backend B, int R>
Tensor<B, R> q_sample(const GaussianDiffusion& d, const Tensor<B, R>& x0, std::span<const Index> t,
                      const Tensor<B, R>& eps) {
  return coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.abar(i)); }) * x0 +
         coefficients<B, R>(t, [&](Index i) { return std::sqrt(1 - d.abar(i)); }) * eps;
}

/// Mean of q(x_{t-1} | x_t, x0): c0 x0 + ct x_t.   (eq. 7)
template <Backend B, int R>
Tensor<B, R> posterior_mean(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                            std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return d.c0(i); }) * x0 +
         coefficients<B, R>(t, [&](Index i) { return d.ct(i); }) * x_t;
}
/// The same mean from the noise: (x_t - beta_t / sqrt(1 - abar_t) eps) / sqrt(alpha_t).   (eq. 11)
template <Backend B, int R>
Tensor<B, R> posterior_mean_from_eps(const GaussianDiffusion& d, const Tensor<B, R>& eps, const Tensor<B, R>& x_t,
                                     std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return 1 / std::sqrt(d.alpha(i)); }) * x_t -
         coefficients<B, R>(t, [&](Index i) {
           return d.beta(i) / (std::sqrt(1 - d.abar(i)) * std::sqrt(d.alpha(i)));
         }) * eps;
}
/// The same mean from the score: (x_t + beta_t score) / sqrt(alpha_t).
template <Backend B, int R>
Tensor<B, R> posterior_mean_from_score(const GaussianDiffusion& d, const Tensor<B, R>& score, const Tensor<B, R>& x_t,
                                       std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return 1 / std::sqrt(d.alpha(i)); }) * x_t +
         coefficients<B, R>(t, [&](Index i) { return d.beta(i) / std::sqrt(d.alpha(i)); }) * score;
}

/// x0 from whatever the network predicted.
///     eps:    sqrt(1/abar) x_t - sqrt(1/abar - 1) eps
///     score:  x_t / sqrt(abar) + (1 - abar) / sqrt(abar) score
///     x_prev: x_prev / c0 - ct / c0 x_t
template <Backend B, int R>
Tensor<B, R> to_x0(const GaussianDiffusion& d, Prediction from, const Tensor<B, R>& value, const Tensor<B, R>& x_t,
                   std::span<const Index> t) {
  auto k = [&](auto f) { return coefficients<B, R>(t, f); };
  switch (from) {
    case Prediction::x0:
      return value;
    case Prediction::eps:
      return k([&](Index i) { return std::sqrt(1 / d.abar(i)); }) * x_t -
             k([&](Index i) { return std::sqrt(1 / d.abar(i) - 1); }) * value;
    case Prediction::score:
      return k([&](Index i) { return 1 / std::sqrt(d.abar(i)); }) * x_t +
             k([&](Index i) { return (1 - d.abar(i)) / std::sqrt(d.abar(i)); }) * value;
    case Prediction::x_prev:
      return k([&](Index i) { return 1 / d.c0(i); }) * value - k([&](Index i) { return d.ct(i) / d.c0(i); }) * x_t;
  }
  return value;
}
/// The noise that x_t contains if x0 is right: (sqrt(1/abar) x_t - x0) / sqrt(1/abar - 1).
template <Backend B, int R>
Tensor<B, R> eps_from_x0(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                         std::span<const Index> t) {
  return (coefficients<B, R>(t, [&](Index i) { return std::sqrt(1 / d.abar(i)); }) * x_t - x0) /
         coefficients<B, R>(t, [&](Index i) { return std::sqrt(1 / d.abar(i) - 1); });
}
/// The score that belongs to x0: sqrt(abar) / (1 - abar) x0 - x_t / (1 - abar).
template <Backend B, int R>
Tensor<B, R> score_from_x0(const GaussianDiffusion& d, const Tensor<B, R>& x0, const Tensor<B, R>& x_t,
                           std::span<const Index> t) {
  return coefficients<B, R>(t, [&](Index i) { return std::sqrt(d.abar(i)) / (1 - d.abar(i)); }) * x0 -
         coefficients<B, R>(t, [&](Index i) { return 1 / (1 - d.abar(i)); }) * x_t;
}
/// Any prediction into any other (not into x_prev, which is a sample).
template <Backend B, int R>
Tensor<B, R> convert_prediction(const GaussianDiffusion& d, Prediction from, Prediction to, const Tensor<B, R>& value,
                                const Tensor<B, R>& x_t, std::span<const Index> t) {
  if (from == to) return value;
  if (from == Prediction::eps && to == Prediction::score) {
    return value * coefficients<B, R>(t, [&](Index i) { return -1 / std::sqrt(1 - d.abar(i)); });
  }
  if (from == Prediction::score && to == Prediction::eps) {
    return value * coefficients<B, R>(t, [&](Index i) { return -std::sqrt(1 - d.abar(i)); });
  }
  const auto x0 = to_x0(d, from, value, x_t, t);
  switch (to) {
    case Prediction::x0:
      return x0;
    case Prediction::eps:
      return eps_from_x0(d, x0, x_t, t);
    case Prediction::score:
      return score_from_x0(d, x0, x_t, t);
    case Prediction::x_prev:
      raise<config_error>(102, "convert_prediction: x_prev is a sample, not a statement about x0");
  }
  return x0;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Properties of a denoiser that a host has to know.
struct DenoiserTraits {
  Prediction prediction = Prediction::x0;
  Index crop_frames = 0;            // > 0: every crop has exactly this many frames (MDM and MotionDiffuse: 196)
  Index longest_crop = 0;           // > 0: no crop has more frames
  bool uses_lengths = true;         // false: crops of fixed size are not masked
  bool empty_text_is_null = false;  // MDM: the text "" is the unconditional one, in both calls

  /// Frames that a crop may have; 0: any number.
  Index longest() const { return crop_frames > 0 ? crop_frames : longest_crop; }
};

/// A network that cleans noisy sequences given a text for each.
///     x (frames of all sequences, features), t (one step number per sequence), text (one per sequence) -> as x
/// Laws     a sequence gives the same result alone and in a batch (tests/laws)
/// Models   MdmSmplDenoiser, MdmDenoiser, MotionDiffuseDenoiser, and yours
template <class D, class B>
concept Denoiser = Module<D> &&
    requires(const D& d, const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) {
  { d(x, t, text) } -> std::same_as<Sequences<B>>;
  { d.traits() } -> std::same_as<DenoiserTraits>;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_GUIDANCE_HPP  // <motionlang/diffusion/guidance.hpp>
#define MOTIONLANG_HAS_DIFFUSION_GUIDANCE_HPP
/// Classifier-free guidance.

namespace motionlang::inline MOTIONLANG_ABI {

///     guided = null + w (cond - null)
/// Source  Ho and Salimans (2022), eq. 6 in the form that all motion models use. Applied to whatever the network
///         predicts, before clipping, inpainting and stitching. With w = 1 the unconditional call can be left out.
template <Backend B, int R>
Tensor<B, R> guide(const Tensor<B, R>& cond, const Tensor<B, R>& null, double w) {
  return null + (cond - null) * w;
}
/// One weight per sample (leading index).
template <Backend B, int R>
Tensor<B, R> guide(const Tensor<B, R>& cond, const Tensor<B, R>& null, const Tensor<B, R>& w) {
  return null + (cond - null) * w;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_MDM_HPP  // <motionlang/diffusion/mdm.hpp>
#define MOTIONLANG_HAS_DIFFUSION_MDM_HPP
/// MDM, the Human Motion Diffusion Model, in its three architectures.

namespace motionlang::inline MOTIONLANG_ABI {

enum class MdmArch { trans_enc, trans_dec, gru };
enum class MdmCondition { text, action, none };
/// What stands in front of the frames in trans_dec: nothing, the time embedding with the text's (all checkpoints of
/// 2022-2023), or the time embedding alone (DistilBERT models).
enum class MdmClassToken { none, time_plus_text, time_only };

struct MdmConfig {
  Index nfeats = 263;  // joints times features of the published layout
  MdmArch arch = MdmArch::trans_enc;
  MdmCondition condition = MdmCondition::text;
  Index text_dim = 512;        // CLIP; 768 for DistilBERT
  bool text_sequence = false;  // every token is a memory row (DistilBERT, trans_dec)
  Index num_actions = 1;
  MdmClassToken class_token = MdmClassToken::none;
  Index latent_dim = 512;
  Index ff_size = 1024;
  Index num_layers = 8;
  Index num_heads = 4;
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  bool mask_frames = false;    // newer models: padded frames are not attended to
  bool gru_over_batch = true;  // the released gru runs its recurrence over the batch index; false: over time
  Index crop_frames = 196;     // released models were trained on exactly this many frames
  Index max_len = 1024;
};

/// e = time MLP(pe[t]) + text projection(m * text): one conditioning vector per sequence. m = 0, i.e. features that are
/// zero, is the unconditional call; the projection's bias remains. Actions are one-hot features.
///     trans_enc   [e, frames] + positions -> post-norm encoder -> frames
///     trans_dec   frames (+ class token) + positions attend to e (or to every text token plus time)
///     gru         GRU(Linear([features, e]) + positions)
/// Source  Tevet et al. (2023), section 3; GuyTevet/motion-diffusion-model model/mdm.py, whose keys are the field names
/// Shapes  a published [batch, J, C, frames] motion is here frames rows of J * C features
template <Backend B>
struct MdmDenoiser {
  Linear<B> pose_embedding;
  TimestepEmbedding<B> embed_timestep;
  std::optional<Linear<B>> embed_text;
  std::optional<Tensor<B, 2>> action_embedding;  // (actions, latent)
  std::optional<TransformerEncoder<B>> seqTransEncoder;
  std::optional<TransformerDecoder<B>> seqTransDecoder;
  std::optional<Gru<B>> gru;
  Linear<B> pose_final;
  PositionTable<B> positions;
  MdmConfig config;

  static constexpr auto fields() {
    using M = MdmDenoiser;
    return motionlang::fields("input_process.poseEmbedding", &M::pose_embedding, "embed_timestep", &M::embed_timestep,
                              "embed_text", &M::embed_text, "embed_action.action_embedding", &M::action_embedding,
                              "seqTransEncoder", &M::seqTransEncoder, "seqTransDecoder", &M::seqTransDecoder, "gru",
                              &M::gru, "output_process.poseFinal", &M::pose_final, "positions", &M::positions, "config",
                              &M::config);
  }
  /// The official name of a parameter: the GRU's are numbered, not nested.
  static std::string official_key(const std::string& path) { return gru_key(path); }

  MdmDenoiser() = default;
  MdmDenoiser(const MdmConfig& c, Rng auto& rng)
      : pose_embedding(c.nfeats + (c.arch == MdmArch::gru ? c.latent_dim : 0), c.latent_dim, rng),
        embed_timestep(c.latent_dim, rng),
        pose_final(c.latent_dim, c.nfeats, rng),
        positions(c.max_len, c.latent_dim),
        config(c) {
    const TransformerConfig transformer{.d_model = c.latent_dim,
                                        .heads = c.num_heads,
                                        .d_ff = c.ff_size,
                                        .layers = c.num_layers,
                                        .activation = c.activation,
                                        .dropout = c.dropout};
    if (c.condition == MdmCondition::text) embed_text.emplace(c.text_dim, c.latent_dim, rng);
    if (c.condition == MdmCondition::action)
      action_embedding = normal_init<B, 2>({c.num_actions, c.latent_dim}, 1, rng);
    if (c.arch == MdmArch::trans_enc) seqTransEncoder.emplace(transformer, rng);
    if (c.arch == MdmArch::trans_dec) seqTransDecoder.emplace(transformer, rng);
    if (c.arch == MdmArch::gru) gru.emplace(c.latent_dim, c.latent_dim, c.num_layers, rng);
  }

  DenoiserTraits traits() const {
    return {.crop_frames = config.crop_frames, .uses_lengths = config.mask_frames, .empty_text_is_null = true};
  }

  Tensor<B, 2> time_tokens(std::span<const Index> t) const { return embed_timestep(positions.rows(), t); }

  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& context = {}) const {
    const Index n = x.count();
    if (static_cast<Index>(t.size()) != n || (config.condition != MdmCondition::none && text.count() != n)) {
      raise<shape_error>(204, "MdmDenoiser: ", n, " sequences, ", text.count(), " texts, ", t.size(), " steps");
    }
    const auto time = time_tokens(t);
    if (config.arch == MdmArch::gru) return recurrent(x, conditioned(time, text));
    const auto frames = x.with(pose_embedding(x.rows));
    auto dropped = [&](const Sequences<B>& s) { return s.with(dropout(s.rows, config.dropout, context)); };
    if (config.arch == MdmArch::trans_enc) {
      const Sequences<B> token(conditioned(time, text), Offsets::equal(n, 1));
      const auto tokens = dropped(add_positions(concat_tokens(token, frames), positions.rows()));
      return pose_final(last_rows((*seqTransEncoder)(tokens, context), x.offsets));
    }
    const auto memory =
        config.text_sequence ? text_memory(time, text) : Sequences<B>(conditioned(time, text), Offsets::equal(n, 1));
    auto queries = frames;
    if (config.class_token != MdmClassToken::none) {
      const auto token = config.class_token == MdmClassToken::time_only ? time : conditioned(time, text);
      queries = concat_tokens(Sequences<B>(token, Offsets::equal(n, 1)), frames);
    }
    queries = dropped(add_positions(queries, positions.rows()));
    return pose_final(last_rows((*seqTransDecoder)(queries, memory, context), x.offsets));
  }

 private:
  /// e, one per sequence.
  Tensor<B, 2> conditioned(const Tensor<B, 2>& time, const TextFeatures<B>& text) const {
    if (embed_text) return time + (*embed_text)(text.tokens.rows);
    if (action_embedding) return time + matmul(text.tokens.rows, *action_embedding);
    return time;
  }
  /// Every projected text token plus the time embedding of its sequence.
  Sequences<B> text_memory(const Tensor<B, 2>& time, const TextFeatures<B>& text) const {
    return text.tokens.with((*embed_text)(text.tokens.rows) + repeat_for_rows(time, text.tokens.offsets));
  }
  Sequences<B> recurrent(const Sequences<B>& x, const Tensor<B, 2>& e) const {
    const auto input =
        add_positions(x.with(pose_embedding(concat(1, x.rows, repeat_for_rows(e, x.offsets)))), positions.rows());
    const Index n = x.count(), frames = x.offsets.longest();
    if (x.offsets.rows() != n * frames) raise<shape_error>(207, "MdmDenoiser: the gru needs sequences of one length");
    std::vector<Tensor<B, 2>> steps;
    if (config.gru_over_batch) {
      for (Index s = 0; s < n; ++s) steps.push_back(input[s]);
      return x.with(pose_final(concat(std::span<const Tensor<B, 2>>((*gru)(steps)), 0)));
    }
    std::vector<Index> at(static_cast<std::size_t>(n)), back;
    for (Index f = 0; f < frames; ++f) {
      for (Index s = 0; s < n; ++s) at[static_cast<std::size_t>(s)] = s * frames + f;
      steps.push_back(gather(input.rows, at));
    }
    for (Index s = 0; s < n; ++s) {
      for (Index f = 0; f < frames; ++f) back.push_back(f * n + s);
    }
    return x.with(pose_final(gather(concat(std::span<const Tensor<B, 2>>((*gru)(steps)), 0), back)));
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_MDM_SMPL_HPP  // <motionlang/diffusion/mdm_smpl.hpp>
#define MOTIONLANG_HAS_DIFFUSION_MDM_SMPL_HPP
/// MDM-SMPL: the denoiser of the STMC paper.

namespace motionlang::inline MOTIONLANG_ABI {

/// Published sizes (27 M parameters).
struct MdmSmplConfig {
  Index nfeats = 205;
  Index tx_dim = 512;
  Index latent_dim = 512;
  Index ff_size = 2048;
  Index num_layers = 8;
  Index num_heads = 8;
  Index nb_registers = 2;
  double dropout = 0.1;
  Activation activation = Activation::gelu;
  Index max_len = 1024;  // of a sequence with its tokens, and of the diffusion steps

  /// Frames that fit behind the tokens of time and of a text of one token.
  Index longest_crop() const { return max_len - 2 - nb_registers; }
};

/// The sequence [time, text ..., registers, frames] plus sinusoidal positions through a pre-norm transformer encoder;
/// the frames are read off its end.
/// Source   Petrovich et al., "Multi-track timeline control" (2024), section 4.3; nv-tlabs/stmc src/model/mdm_smpl.py,
///          whose state-dict keys (behind "denoiser.") are the field names
/// Caution  texts of several tokens are placed as the published code pads them: frames come behind the longest text of
///          the batch, so such a sequence depends on its batch mates. With one token per text (CLIP, ours) none
///          does.
/// Differs  from MDM: pre-norm, a text projection of two layers, register tokens, masks (here: packed sequences)
template <Backend B>
struct MdmSmplDenoiser {
  Tensor<B, 2> registers;  // (nb_registers, latent_dim)
  Linear<B> text_in, text_out;
  LayerNorm<B> text_norm;
  Linear<B> skel_embedding;
  TimestepEmbedding<B> timestep_encoder;
  TransformerEncoder<B> seqTransEncoder;
  Linear<B> to_skel_layer;
  PositionTable<B> positions;
  double dropout_p = 0.1;

  static constexpr auto fields() {
    using M = MdmSmplDenoiser;
    return motionlang::fields("registers", &M::registers, "tx_embedding.0", &M::text_in, "tx_embedding.2", &M::text_out,
                              "tx_embedding.3", &M::text_norm, "skel_embedding", &M::skel_embedding, "timestep_encoder",
                              &M::timestep_encoder, "seqTransEncoder", &M::seqTransEncoder, "to_skel_layer",
                              &M::to_skel_layer, "positions", &M::positions, "dropout_p", &M::dropout_p);
  }
  MdmSmplDenoiser() = default;
  MdmSmplDenoiser(const MdmSmplConfig& c, Rng auto& rng)
      : registers(normal_init<B, 2>({c.nb_registers, c.latent_dim}, 1, rng)),
        text_in(c.tx_dim, 2 * c.latent_dim, rng),
        text_out(2 * c.latent_dim, c.latent_dim, rng),
        text_norm(c.latent_dim),
        skel_embedding(c.nfeats, c.latent_dim, rng),
        timestep_encoder(c.latent_dim, rng),
        seqTransEncoder({.d_model = c.latent_dim,
                         .heads = c.num_heads,
                         .d_ff = c.ff_size,
                         .layers = c.num_layers,
                         .activation = c.activation,
                         .norm_first = true,
                         .dropout = c.dropout},
                        rng),
        to_skel_layer(c.latent_dim, c.nfeats, rng),
        positions(c.max_len, c.latent_dim),
        dropout_p(c.dropout) {}

  /// Behind the tokens for time and text and the registers.
  DenoiserTraits traits() const {
    return {.longest_crop =
                MdmSmplConfig{.nb_registers = registers.size(0), .max_len = positions.rows().size(0)}.longest_crop()};
  }

  /// (sequences, latent)
  Tensor<B, 2> time_tokens(std::span<const Index> t) const { return timestep_encoder(positions.rows(), t); }
  /// Token by token.
  Sequences<B> text_tokens(const TextFeatures<B>& text) const {
    return text.tokens.with(text_norm(text_out(text_in(text.tokens.rows, Activation::gelu))));
  }
  /// What enters the first layer.
  Sequences<B> sequence(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) const {
    const Index n = x.count();
    if (text.count() != n || static_cast<Index>(t.size()) != n) {
      raise<shape_error>(204, "MdmSmplDenoiser: ", n, " sequences, ", text.count(), " texts, ", t.size(), " steps");
    }
    const Sequences<B> time(time_tokens(t), Offsets::equal(n, 1));
    const auto tokens =
        concat_tokens(time, text_tokens(text), repeat_sequence(registers, n), x.with(skel_embedding(x.rows)));
    PoolVector<PositionGap> gaps;  // what follows the text stands where it would behind the longest text of the batch
    for (Index s = 0; s < n; ++s) {
      const Index length = text.tokens.offsets.length(s);
      gaps.push_back({1 + length, text.tokens.offsets.longest() - length});
    }
    return add_positions(tokens, positions.rows(), gaps);
  }
  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& context = {}) const {
    auto tokens = sequence(x, t, text);
    if (context.dropout) tokens = tokens.with(dropout(tokens.rows, dropout_p, context));
    return to_skel_layer(last_rows(seqTransEncoder(tokens, context), x.offsets));
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_MOTIONDIFFUSE_HPP  // <motionlang/diffusion/motiondiffuse.hpp>
#define MOTIONLANG_HAS_DIFFUSION_MOTIONDIFFUSE_HPP
/// MotionDiffuse: linear attention, conditioning by scale and shift, a transformer over CLIP's token states.

namespace motionlang::inline MOTIONLANG_ABI {

/// Sizes of the HumanML3D release.
struct MotionDiffuseConfig {
  Index input_feats = 263;
  Index num_frames = 196;  // rows of the learned positions
  Index latent_dim = 512;
  Index ff_size = 1024;
  Index num_layers = 8;
  Index num_heads = 8;
  Index clip_dim = 512;
  Index text_latent_dim = 256;
  Index num_text_layers = 4;
  Index text_num_heads = 4;
  Index text_ff_size = 2048;
  Activation activation = Activation::gelu;
  bool no_eff = false;  // standard attention, which in the released code masks nothing
};

/// "Stylization": Linear(silu(LN(h) (1 + scale) + shift)), scale and shift from the embedding of time and text.
template <Backend B>
struct StylizationBlock {
  Linear<B> emb_layer, out_layer;
  LayerNorm<B> norm;

  static constexpr auto fields() {
    using M = StylizationBlock;
    return motionlang::fields("emb_layers.1", &M::emb_layer, "norm", &M::norm, "out_layers.2", &M::out_layer);
  }
  StylizationBlock() = default;
  StylizationBlock(Index width, Index time_width, Rng auto& rng)
      : emb_layer(time_width, 2 * width, rng), out_layer(width, width, rng), norm(width) {}

  /// h (rows, width), emb (sequences, time width)
  Tensor<B, 2> operator()(const Tensor<B, 2>& h, const Tensor<B, 2>& emb, const Offsets& offsets) const {
    const Index d = h.size(1);
    const auto modulation = repeat_for_rows(emb_layer(activate(emb, Activation::silu)), offsets);
    const auto y = norm(h) * (slice(modulation, 1, 0, d) + 1.0) + slice(modulation, 1, d, 2 * d);
    return out_layer(activate(y, Activation::silu));
  }
};

/// Attention of a decoder block, to the motion itself or to the text.
template <Backend B>
struct MotionDiffuseAttention {
  LayerNorm<B> norm;
  std::optional<LayerNorm<B>> text_norm;  // cross-attention only
  Linear<B> query, key, value;
  StylizationBlock<B> proj_out;
  Index heads = 8;
  bool no_eff = false;

  static constexpr auto fields() {
    using M = MotionDiffuseAttention;
    return motionlang::fields("norm", &M::norm, "text_norm", &M::text_norm, "query", &M::query, "key", &M::key, "value",
                              &M::value, "proj_out", &M::proj_out, "heads", &M::heads, "no_eff", &M::no_eff);
  }
  MotionDiffuseAttention() = default;
  MotionDiffuseAttention(const MotionDiffuseConfig& c, bool cross, Rng auto& rng)
      : norm(c.latent_dim),
        query(c.latent_dim, c.latent_dim, rng),
        key(cross ? c.text_latent_dim : c.latent_dim, c.latent_dim, rng),
        value(cross ? c.text_latent_dim : c.latent_dim, c.latent_dim, rng),
        proj_out(c.latent_dim, 4 * c.latent_dim, rng),
        heads(c.num_heads),
        no_eff(c.no_eff) {
    if (cross) text_norm.emplace(c.text_latent_dim);
  }

  /// Self-attention when there is no text.
  Tensor<B, 2> operator()(const Sequences<B>& x, const Sequences<B>* text, const Tensor<B, 2>& emb) const {
    const auto n = norm(x.rows), source = text == nullptr ? n : (*text_norm)(text->rows);
    const Offsets& keys = text == nullptr ? x.offsets : text->offsets;
    const auto q = query(n), k = key(source), v = value(source);
    const auto y = no_eff ? attention(q, k, v, x.offsets, keys, {.heads = heads})
                          : linear_attention(q, k, v, x.offsets, keys, heads);
    return x.rows + proj_out(y, emb, x.offsets);
  }
};

template <Backend B>
struct MotionDiffuseFeedForward {
  Linear<B> linear1, linear2;
  StylizationBlock<B> proj_out;

  static constexpr auto fields() {
    using M = MotionDiffuseFeedForward;
    return motionlang::fields("linear1", &M::linear1, "linear2", &M::linear2, "proj_out", &M::proj_out);
  }
  Tensor<B, 2> operator()(const Sequences<B>& x, const Tensor<B, 2>& emb) const {
    return x.rows + proj_out(linear2(linear1(x.rows, Activation::gelu)), emb, x.offsets);
  }
};

template <Backend B>
struct MotionDiffuseBlock {
  MotionDiffuseAttention<B> sa_block, ca_block;
  MotionDiffuseFeedForward<B> ffn;

  static constexpr auto fields() {
    using M = MotionDiffuseBlock;
    return motionlang::fields("sa_block", &M::sa_block, "ca_block", &M::ca_block, "ffn", &M::ffn);
  }
  MotionDiffuseBlock() = default;
  MotionDiffuseBlock(const MotionDiffuseConfig& c, Rng auto& rng)
      : sa_block(c, false, rng),
        ca_block(c, true, rng),
        ffn{{c.latent_dim, c.ff_size, rng}, {c.ff_size, c.latent_dim, rng}, {c.latent_dim, 4 * c.latent_dim, rng}} {}

  Sequences<B> operator()(Sequences<B> x, const Sequences<B>& text, const Tensor<B, 2>& emb) const {
    x.rows = sa_block(x, nullptr, emb);
    x.rows = ca_block(x, &text, emb);
    x.rows = ffn(x, emb);
    return x;
  }
};

/// Predicts the noise. Frames beyond a sequence's length are simply absent: linear attention gives masked frames no
/// weight. With `no_eff` the released mask shifts whole rows of scores and hides nothing, so there all frames must be
/// given.
/// Source  Zhang et al. (2022), section 3; mingyuan-zhang/MotionDiffuse text2motion/models/transformer.py, keys
///         as there (without the CLIP tower, whose states after the last layer norm are the input)
template <Backend B>
struct MotionDiffuseDenoiser {
  Tensor<B, 2> sequence_embedding;  // (num_frames, latent)
  Linear<B> text_pre_proj;
  TransformerEncoder<B> textTransEncoder;
  LayerNorm<B> text_ln;
  Linear<B> text_proj, joint_embed, time_in, time_out;
  std::vector<MotionDiffuseBlock<B>> temporal_decoder_blocks;
  Linear<B> out;
  MotionDiffuseConfig config;

  static constexpr auto fields() {
    using M = MotionDiffuseDenoiser;
    return motionlang::fields("sequence_embedding", &M::sequence_embedding, "text_pre_proj", &M::text_pre_proj,
                              "textTransEncoder", &M::textTransEncoder, "text_ln", &M::text_ln, "text_proj.0",
                              &M::text_proj, "joint_embed", &M::joint_embed, "time_embed.0", &M::time_in,
                              "time_embed.2", &M::time_out, "temporal_decoder_blocks", &M::temporal_decoder_blocks,
                              "out", &M::out, "config", &M::config);
  }
  MotionDiffuseDenoiser() = default;
  MotionDiffuseDenoiser(const MotionDiffuseConfig& c, Rng auto& rng)
      : sequence_embedding(normal_init<B, 2>({c.num_frames, c.latent_dim}, 1, rng)),
        text_pre_proj(c.clip_dim, c.text_latent_dim, rng),
        textTransEncoder({.d_model = c.text_latent_dim,
                          .heads = c.text_num_heads,
                          .d_ff = c.text_ff_size,
                          .layers = c.num_text_layers,
                          .activation = c.activation,
                          .dropout = 0},
                         rng),
        text_ln(c.text_latent_dim),
        text_proj(c.text_latent_dim, 4 * c.latent_dim, rng),
        joint_embed(c.input_feats, c.latent_dim, rng),
        time_in(c.latent_dim, 4 * c.latent_dim, rng),
        time_out(4 * c.latent_dim, 4 * c.latent_dim, rng),
        out(c.latent_dim, c.input_feats, rng),
        config(c) {
    for (Index i = 0; i < c.num_layers; ++i) temporal_decoder_blocks.emplace_back(c, rng);
  }

  DenoiserTraits traits() const {
    return {.prediction = Prediction::eps, .crop_frames = config.num_frames, .uses_lengths = !config.no_eff};
  }

  struct EncodedText {
    Tensor<B, 2> xf_proj;  // (sequences, 4 latent)
    Sequences<B> xf_out;   // text rows, text width
  };
  /// Throws shape_error 204 unless every text has an end token, 203 if that lies outside the text.
  EncodedText encode(const TextFeatures<B>& text) const {
    if (static_cast<Index>(text.end_position.size()) != text.count()) {
      raise<shape_error>(204, "MotionDiffuseDenoiser: ", text.count(), " texts, ", text.end_position.size(),
                         " end tokens");
    }
    const auto states = textTransEncoder(text.tokens.with(text_pre_proj(text.tokens.rows)));
    auto xf_out = states.with(text_ln(states.rows));
    PoolVector<Index> end;
    for (Index s = 0; s < text.count(); ++s) {
      const Index position = text.end_position[static_cast<std::size_t>(s)], length = xf_out.offsets.length(s);
      if (position < 0 || position >= length) {
        raise<shape_error>(203, "MotionDiffuseDenoiser: end token at row ", position, " of ", length, " of text ", s);
      }
      end.push_back(xf_out.offsets.begin(s) + position);
    }
    return {text_proj(gather(xf_out.rows, end)), xf_out};
  }
  /// The time MLP over a sinusoid with cosines first: w_k = exp(-ln(10000) k / half).
  Tensor<B, 2> time_embedding(std::span<const Index> t) const {
    using S = typename B::scalar;
    const Index half = config.latent_dim / 2;
    PoolVector<S> values(t.size() * static_cast<std::size_t>(2 * half));
    for (std::size_t s = 0; s < t.size(); ++s) {
      for (Index k = 0; k < half; ++k) {
        const float w =
            std::exp(static_cast<float>(-std::log(10000.0)) * static_cast<float>(k) / static_cast<float>(half));
        const float angle = static_cast<float>(t[s]) * w;
        values[s * static_cast<std::size_t>(2 * half) + static_cast<std::size_t>(k)] = static_cast<S>(std::cos(angle));
        values[s * static_cast<std::size_t>(2 * half) + static_cast<std::size_t>(half + k)] =
            static_cast<S>(std::sin(angle));
      }
    }
    return time_out(time_in(Tensor<B, 2>::from(std::span<const S>(values), {static_cast<Index>(t.size()), 2 * half}), Activation::silu));
  }
  Sequences<B> embed_frames(const Sequences<B>& x) const {
    PoolVector<Index> position;
    for (Index s = 0; s < x.count(); ++s) {
      for (Index i = 0; i < x.offsets.length(s); ++i) position.push_back(i);
    }
    return x.with(joint_embed(x.rows) + gather(sequence_embedding, position));
  }

  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& = {}) const {
    if (text.count() != x.count() || static_cast<Index>(t.size()) != x.count()) {
      raise<shape_error>(204, "MotionDiffuseDenoiser: ", x.count(), " sequences, ", text.count(), " texts, ", t.size(),
                         " steps");
    }
    const EncodedText encoded = encode(text);
    const auto emb = time_embedding(t) + encoded.xf_proj;
    auto h = embed_frames(x);
    for (const auto& block : temporal_decoder_blocks) h = block(h, encoded.xf_out, emb);
    return out(h);
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_DIFFUSION_SAMPLER_HPP  // <motionlang/diffusion/sampler.hpp>
#define MOTIONLANG_HAS_DIFFUSION_SAMPLER_HPP
/// From noise to a sample: ancestral (DDPM), DDIM with its inversion, and PLMS.
///
/// The loops know nothing of motion. They call
///     network(x, t) -> what the network predicts at index t of the process (already guided), same shape as x
///     noise(draw)   -> standard normal numbers of that shape; draw 0 is the first after the initial tensor
///     fix(x0, t)    -> the clean estimate that is used (inpainting, stitching); identity if not given

namespace motionlang::inline MOTIONLANG_ABI {

struct StepOptions {
  Prediction prediction = Prediction::x0;
  NoiseScale noise_scale = NoiseScale::posterior_std;
  Variance variance = Variance::fixed_small;
  bool clip = false;  // x0 to [-1, 1]
};

/// How a whole reverse process is run.
struct SamplingOptions {
  enum class Sampler { ddpm, ddim };
  Sampler sampler = Sampler::ddpm;
  double eta = 0;  // of ddim
  NoiseScale noise_scale = NoiseScale::posterior_variance;
  bool clip = false;
};

/// Names of the steps in the literature: x0 (clean estimate), mean of the posterior, x_{t-1}.
template <Backend B, int R>
struct AncestralStep {
  Tensor<B, R> x0, mean, x_prev;
};

namespace detail {

struct KeepX0 {
  template <class T>
  T operator()(T x0, Index) const {
    return x0;
  }
};

template <Backend B, int R>
Tensor<B, R> clipped(const Tensor<B, R>& x) {
  return -maximum(-maximum(x, Tensor<B, R>(-1.0)), Tensor<B, R>(-1.0));
}
template <Backend B, int R, class Fix>
Tensor<B, R> clean_estimate(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                            std::span<const Index> t, const StepOptions& options, const Fix& fix) {
  auto x0 = to_x0(d, options.prediction, output, x, t);
  if (options.clip) x0 = clipped(x0);
  return fix(std::move(x0), t.front());
}

}  // namespace detail

/// One step of Ho et al. (2020), algorithm 2: x_{t-1} = mean + factor noise.
/// t: one index per sample, or one for all. When the network predicts x_{t-1}, that is the mean.
template <Backend B, int R, class Fix = detail::KeepX0>
AncestralStep<B, R> ancestral_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                                   const Tensor<B, R>& noise, std::span<const Index> t, const StepOptions& options = {},
                                   const Fix& fix = {}) {
  auto x0 = detail::clean_estimate(d, x, output, t, options, fix);
  auto mean = options.prediction == Prediction::x_prev ? output : posterior_mean(d, x0, x, t);
  auto x_prev = mean + coefficients<B, R>(t, [&](Index i) {
                         return d.noise_factor(i, options.noise_scale, options.variance);
                       }) * noise;
  return {std::move(x0), std::move(mean), std::move(x_prev)};
}

/// Called after every step with the index just made and the tensors of that step. Does nothing by default.
struct IgnoreSteps {
  void operator()(Index, const auto&) const {}
};

/// All steps from index `first` (the last of the process when -1) down to 0. Returns the x0 of the last step, which is
/// also the last x (c0 is 1 and the noise factor 0 at t = 0). Throws `cancelled` if progress says so.
template <Backend B, int R, class Network, class Noise, class Fix = detail::KeepX0, class Watch = IgnoreSteps>
Tensor<B, R> sample_ancestral(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, Noise&& noise,
                              const StepOptions& options = {}, const Fix& fix = {}, Progress progress = {},
                              Index first = -1, const Watch& watch = {}) {
  if (first < 0) first = d.steps() - 1;
  for (Index t = first; t >= 0; --t) {
    const auto step = ancestral_step(d, x, network(x, t), noise(first - t), std::span(&t, 1), options, fix);
    watch(t, step);
    x = t > 0 ? step.x_prev : step.x0;
    progress(first - t + 1, first + 1);
  }
  return x;
}

/// One step of DDIM (Song et al. 2021, eq. 12): eta = 0 is deterministic, eta = 1 is ancestral sampling.
///     sigma = eta sqrt((1 - abarp) / (1 - abar)) sqrt(1 - abar / abarp)
///     x_{t-1} = sqrt(abarp) x0 + sqrt(1 - abarp - sigma^2) eps + [t > 0] sigma noise
/// Throws config_error 101 unless 0 <= eta <= 1.
template <Backend B, int R, class Fix = detail::KeepX0>
AncestralStep<B, R> ddim_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output,
                              const Tensor<B, R>* noise, Index t, double eta, const StepOptions& options = {},
                              const Fix& fix = {}) {
  if (!(eta >= 0 && eta <= 1)) raise<config_error>(101, "ddim_step: eta = ", eta, " is not in [0, 1]");
  const std::span<const Index> at(&t, 1);
  auto x0 = detail::clean_estimate(d, x, output, at, options, fix);
  const auto eps = eps_from_x0(d, x0, x, at);
  const double sigma = eta * std::sqrt((1 - d.abarp(t)) / (1 - d.abar(t))) * std::sqrt(1 - d.abar(t) / d.abarp(t));
  auto mean = x0 * std::sqrt(d.abarp(t)) + eps * std::sqrt(1 - d.abarp(t) - sigma * sigma);
  auto x_prev = noise != nullptr && t > 0 && sigma > 0 ? mean + *noise * sigma : mean;
  return {std::move(x0), std::move(mean), std::move(x_prev)};
}

/// A whole DDIM run. It saves time only on a respaced process. `noise` is asked for only if eta > 0, but then at every
/// step.
template <Backend B, int R, class Network, class Noise, class Fix = detail::KeepX0, class Watch = IgnoreSteps>
Tensor<B, R> sample_ddim(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, Noise&& noise, double eta,
                         const StepOptions& options = {}, const Fix& fix = {}, Progress progress = {},
                         const Watch& watch = {}) {
  for (Index t = d.steps() - 1; t >= 0; --t) {
    const auto output = network(x, t);
    const auto step = [&] {
      if (eta == 0) return ddim_step<B, R>(d, x, output, nullptr, t, eta, options, fix);
      const Tensor<B, R> z = noise(d.steps() - 1 - t);
      return ddim_step(d, x, output, &z, t, eta, options, fix);
    }();
    watch(t, step);
    x = step.x_prev;
    progress(d.steps() - t, d.steps());
  }
  return x;
}

/// From a sample towards its noise: one step from index t to t + 1 (DDIM, eta = 0, backwards).
///     x_{t+1} = sqrt(abarn) x0 + sqrt(1 - abarn) eps
template <Backend B, int R>
Tensor<B, R> ddim_inversion_step(const GaussianDiffusion& d, const Tensor<B, R>& x, const Tensor<B, R>& output, Index t,
                                 const StepOptions& options = {}) {
  const std::span<const Index> at(&t, 1);
  const auto x0 = detail::clean_estimate(d, x, output, at, options, detail::KeepX0{});
  return x0 * std::sqrt(d.abarn(t)) + eps_from_x0(d, x0, x, at) * std::sqrt(1 - d.abarn(t));
}

/// Pseudo linear multistep (Liu et al. 2022) of order 2 ... 4: DDIM steps with an extrapolated eps. The first step
/// averages the eps at (x, t) and at the Euler prediction; later ones use as many old values as there are. Returns the
/// x0 of the last step. Throws config_error 101 for another order.
template <Backend B, int R, class Network, class Watch = IgnoreSteps>
Tensor<B, R> sample_plms(const GaussianDiffusion& d, Tensor<B, R> x, Network&& network, int order,
                         const StepOptions& options = {}, Progress progress = {}, const Watch& watch = {}) {
  if (order < 2 || order > 4) raise<config_error>(101, "sample_plms: order ", order, " is not 2, 3 or 4");
  using T = Tensor<B, R>;
  auto predict = [&](const T& at_x, Index t) {
    const std::span<const Index> at(&t, 1);
    return eps_from_x0(d, detail::clean_estimate(d, at_x, network(at_x, t), at, options, detail::KeepX0{}), at_x, at);
  };
  auto advance = [&](const T& from, const T& eps, Index t) {
    auto x0 = to_x0(d, Prediction::eps, eps, from, std::span<const Index>(&t, 1));
    auto next = x0 * std::sqrt(d.abarp(t)) + eps * std::sqrt(1 - d.abarp(t));
    return AncestralStep<B, R>{std::move(x0), next, next};
  };
  std::vector<T> old;  // newest first
  for (Index t = d.steps() - 1; t >= 0; --t) {
    const T e = predict(x, t);
    T used = e;
    switch (std::min<std::size_t>(old.size() + 1, static_cast<std::size_t>(order))) {
      case 1:
        used = t > 0 ? (e + predict(advance(x, e, t).x_prev, t - 1)) * 0.5 : e;
        break;
      case 2:
        used = (e * 3.0 - old[0]) * (1.0 / 2);
        break;
      case 3:
        used = (e * 23.0 - old[0] * 16.0 + old[1] * 5.0) * (1.0 / 12);
        break;
      default:
        used = (e * 55.0 - old[0] * 59.0 + old[1] * 37.0 - old[2] * 9.0) * (1.0 / 24);
        break;
    }
    const auto step = advance(x, used, t);
    watch(t, step);
    x = t > 0 ? step.x_prev : to_x0(d, Prediction::eps, e, x, std::span<const Index>(&t, 1));
    old.insert(old.begin(), e);
    if (old.size() >= static_cast<std::size_t>(order)) old.pop_back();
    progress(d.steps() - t, d.steps());
  }
  return x;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_BERT_HPP  // <motionlang/text/bert.hpp>
#define MOTIONLANG_HAS_TEXT_BERT_HPP
/// The BERT family: DistilBERT, BERT (MiniLM) and MPNet. One network; the members differ in the names of their tensors, in whether
/// there are token types, and in how positions count.
///
///     const DistilBert<B> network = load_text_network<DistilBert<B>>(config, weights);   // io/text_network_file.hpp
///     const Sequences<B> states = network(tokenize(tokenizer, texts)).tokens;
///
/// Batches are packed: padding is never computed, and a text has the same numbers alone and among others. Weights are read where they
/// lie; `prepare` is not needed, and would take the memory of the weights a second time.

#ifndef MOTIONLANG_HAS_TEXT_TOKEN_OFFSETS_HPP  // <motionlang/text/token_offsets.hpp>
#define MOTIONLANG_HAS_TEXT_TOKEN_OFFSETS_HPP
/// Where the texts of a batch of ids begin.

#ifndef MOTIONLANG_HAS_TEXT_TOKENIZER_HPP  // <motionlang/text/tokenizer.hpp>
#define MOTIONLANG_HAS_TEXT_TOKENIZER_HPP
/// The concept of a tokenizer, batches of ids, and the strings that stand for an id wherever they occur in a text.

namespace motionlang::inline MOTIONLANG_ABI {

/// Turns a text into the ids that a network takes, framed by the marks for begin and end.
/// Laws     every id is at least 0 and below size(); any bytes are a text, what is not UTF-8 counts as U+FFFD
/// Models   WordPiece, BertTokenizer, ClipTokenizer, and yours
template <class T>
concept Tokenizer = requires(const T& t, std::string_view text) {
  { t.encode(text) } -> std::same_as<std::vector<Index>>;
  { t.size() } -> std::same_as<Index>;
};

/// The ids of several texts, one text after the other: what an embedding and `Offsets(lengths)` take.
struct TokenBatch {
  std::vector<Index> ids, lengths;

  Index count() const { return static_cast<Index>(lengths.size()); }
  Index longest() const { return lengths.empty() ? 0 : *std::max_element(lengths.begin(), lengths.end()); }

  /// (texts, width), filled up with `pad` on the right; width 0: that of the longest text. Throws shape_error 204 if a text is
  /// longer.
  std::vector<Index> padded(Index pad, Index width = 0) const {
    if (width == 0) width = longest();
    if (width < longest()) raise<shape_error>(204, "padded: width ", width, ", a text of ", longest(), " ids");
    std::vector<Index> out(static_cast<std::size_t>(count() * width), pad);
    auto from = ids.begin();
    for (std::size_t i = 0; i < lengths.size(); from += lengths[i], ++i)
      std::copy_n(from, lengths[i], out.begin() + static_cast<std::ptrdiff_t>(i) * width);
    return out;
  }
};

template <Tokenizer T>
TokenBatch tokenize(const T& tokenizer, std::span<const std::string> texts) {
  TokenBatch out;
  for (const std::string& text : texts) {
    const std::vector<Index> ids = tokenizer.encode(text);
    out.ids.insert(out.ids.end(), ids.begin(), ids.end());
    out.lengths.push_back(static_cast<Index>(ids.size()));
  }
  return out;
}

/// A string that becomes its id before words are looked for. Whether it takes the white space beside it along is no question
/// here, since all our tokenizers drop white space.
struct AddedToken {
  std::string content;
  Index id = 0;
  bool normalized = false;  // looked for in the normalised text, not in the raw one
  bool operator==(const AddedToken&) const = default;
};

namespace detail {

/// Finds added tokens in a text: the leftmost, and the longest of those that begin at one place.
class AddedTokenSearch {
 public:
  AddedTokenSearch() = default;
  explicit AddedTokenSearch(std::vector<AddedToken> tokens) : tokens_(std::move(tokens)) {
    std::erase_if(tokens_, [](const AddedToken& t) { return t.content.empty(); });
    std::stable_sort(tokens_.begin(), tokens_.end(),
                     [](const AddedToken& a, const AddedToken& b) { return a.content.size() > b.content.size(); });
    for (const AddedToken& t : tokens_) begins_[static_cast<unsigned char>(t.content.front())] = true;
  }
  bool empty() const { return tokens_.empty(); }
  bool has(Index id) const {
    return std::any_of(tokens_.begin(), tokens_.end(), [&](const AddedToken& t) { return t.id == id; });
  }

  /// Calls on_text(part) for what lies between the tokens and on_token(id) for them, in the order of the text.
  template <class OnText, class OnToken>
  void split(std::string_view text, OnText on_text, OnToken on_token) const {
    std::size_t from = 0;
    for (std::size_t at = 0; at < text.size();) {
      const AddedToken* token = begins_[static_cast<unsigned char>(text[at])] ? match(text.substr(at)) : nullptr;
      if (token == nullptr) {
        ++at;
        continue;
      }
      if (from < at) on_text(text.substr(from, at - from));
      on_token(token->id);
      from = at += token->content.size();
    }
    if (from < text.size()) on_text(text.substr(from));
  }

 private:
  const AddedToken* match(std::string_view text) const {
    for (const AddedToken& t : tokens_) {
      if (text.starts_with(t.content)) return &t;
    }
    return nullptr;
  }

  std::vector<AddedToken> tokens_;
  std::array<bool, 256> begins_{};
};

}  // namespace detail

/// The frame around one text or a pair: ids and the places of the texts, each with its token type.
/// BERT: [CLS] A [SEP] B [SEP], types 0 0 0 1 1.
struct FramePart {
  enum Kind { token, text_a, text_b };
  Kind kind = token;
  Index id = 0;  // of a token
  Index type = 0;
  bool operator==(const FramePart&) const = default;
};

/// The ids of two texts in one frame, and the token type of each.
struct TokenPair {
  std::vector<Index> ids, types;
};

namespace detail {

inline TokenPair framed(std::span<const FramePart> frame, std::span<const Index> a, std::span<const Index> b = {}) {
  TokenPair out;
  for (const FramePart& part : frame) {
    if (part.kind == FramePart::token) {
      out.ids.push_back(part.id);
    } else {
      const auto text = part.kind == FramePart::text_a ? a : b;
      out.ids.insert(out.ids.end(), text.begin(), text.end());
    }
    out.types.resize(out.ids.size(), part.type);
  }
  return out;
}

/// Ids that a frame adds to its texts.
inline std::size_t frame_size(std::span<const FramePart> frame) {
  return static_cast<std::size_t>(
      std::count_if(frame.begin(), frame.end(), [](const FramePart& p) { return p.kind == FramePart::token; }));
}

/// The ids of a text in its frame, no more than `longest`: what is beyond is cut off, or throws config_error 101 unless `truncate`.
inline std::vector<Index> framed_text(std::string_view tokenizer, std::span<const FramePart> frame, std::vector<Index> ids,
                                      Index longest, bool truncate) {
  const std::size_t around = frame_size(frame), room = static_cast<std::size_t>(longest) - around;
  if (ids.size() > room) {
    if (!truncate) raise<config_error>(101, tokenizer, ": a text of ", ids.size() + around, " ids, at most ", longest);
    ids.resize(room);
  }
  return framed(frame, ids).ids;
}
/// Two texts in one frame; never cut. Throws config_error 101 beyond `longest` ids.
inline TokenPair framed_pair(std::string_view tokenizer, std::span<const FramePart> frame, std::span<const Index> a,
                             std::span<const Index> b, Index longest) {
  TokenPair out = framed(frame, a, b);
  if (std::ssize(out.ids) > longest)
    raise<config_error>(101, tokenizer, ": a text of ", out.ids.size(), " ids, at most ", longest);
  return out;
}

}  // namespace detail

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Throws shape_error 207 if the lengths are not those of the ids.
inline Offsets token_offsets(const TokenBatch& batch) {
  Offsets offsets(batch.lengths);
  if (offsets.rows() != static_cast<Index>(batch.ids.size()))
    raise<shape_error>(207, "TokenBatch: lengths of ", offsets.rows(), " ids, there are ", batch.ids.size());
  return offsets;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

struct BertConfig {
  Index vocabulary = 30522, width = 768, heads = 12, d_ff = 3072, layers = 6, positions = 512;
  Index token_types = 2, buckets = 32;  // only where the member has them
  Index padding = 0;                    // the id of padding; positions of MPNet depend on it
  Activation activation = Activation::gelu;
  double eps = 1e-12;
};

inline constexpr BertConfig distilbert_base{};
inline constexpr BertConfig minilm_l6{.width = 384, .d_ff = 1536};
inline constexpr BertConfig mpnet_base{.vocabulary = 30527, .layers = 12, .positions = 514, .padding = 1, .eps = 1e-5};

/// Names of the published state dicts (Hugging Face), and what a member has.
struct DistilBertKeys {
  static constexpr const char *model_type = "distilbert", *layers = "transformer.layer", *query = "attention.q_lin",
                              *key = "attention.k_lin", *value = "attention.v_lin", *attended = "attention.out_lin",
                              *attended_norm = "sa_layer_norm", *up = "ffn.lin1", *down = "ffn.lin2",
                              *norm = "output_layer_norm";
  static constexpr bool token_types = false, relative_scores = false, positions_behind_padding = false;
};
struct BertKeys {
  static constexpr const char *model_type = "bert", *layers = "encoder.layer", *query = "attention.self.query",
                              *key = "attention.self.key", *value = "attention.self.value",
                              *attended = "attention.output.dense", *attended_norm = "attention.output.LayerNorm",
                              *up = "intermediate.dense", *down = "output.dense", *norm = "output.LayerNorm";
  static constexpr bool token_types = true, relative_scores = false, positions_behind_padding = false;
};
struct MpnetKeys {
  static constexpr const char *model_type = "mpnet", *layers = "encoder.layer", *query = "attention.attn.q",
                              *key = "attention.attn.k", *value = "attention.attn.v", *attended = "attention.attn.o",
                              *attended_norm = "attention.LayerNorm", *up = "intermediate.dense",
                              *down = "output.dense", *norm = "output.LayerNorm";
  static constexpr bool token_types = false, relative_scores = true, positions_behind_padding = true;
};

/// The bucket of a relative position r = key - query, of 32: 0 ... 15 for keys up to the query, 16 ... 31 for later ones; up to a
/// distance of 8 every distance has its own. Source  MPNet (Song et al. 2020), after T5 (Raffel et al. 2020), section 2.1; the borders
/// 8 * 16^(i / 8) as whole numbers (spec text-encoders.md, section 4).
constexpr Index mpnet_bucket(Index r) {
  constexpr Index borders[] = {12, 16, 23, 32, 46, 64, 91};
  const Index distance = r < 0 ? -r : r, later = r > 0 ? 16 : 0;
  if (distance < 8) return later + distance;
  Index offset = 8;
  for (Index border : borders) offset += distance >= border ? 1 : 0;
  return later + offset;
}

/// Post-norm:   x = LN(SA(x) + x);   x = LN(W2 act(W1 x) + x)
template <Backend B, class Keys>
struct BertLayer {
  Linear<B> query, key, value, attended;
  LayerNorm<B> attended_norm;
  Linear<B> up, down;
  LayerNorm<B> norm;
  Index heads = 1;
  Activation activation = Activation::gelu;

  static constexpr auto fields() {
    using M = BertLayer;
    return motionlang::fields(Keys::query, &M::query, Keys::key, &M::key, Keys::value, &M::value, Keys::attended,
                              &M::attended, Keys::attended_norm, &M::attended_norm, Keys::up, &M::up, Keys::down,
                              &M::down, Keys::norm, &M::norm, "heads", &M::heads, "activation", &M::activation);
  }
  BertLayer() = default;
  BertLayer(const BertConfig& c, Rng auto& rng)
      : query(c.width, c.width, rng),
        key(c.width, c.width, rng),
        value(c.width, c.width, rng),
        attended(c.width, c.width, rng),
        attended_norm(c.width),
        up(c.width, c.d_ff, rng),
        down(c.d_ff, c.width, rng),
        norm(c.width),
        heads(c.heads),
        activation(c.activation) {
    check_heads(c.width, c.heads);
    attended_norm.eps = norm.eps = c.eps;
  }

  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets, const Tensor<B, 2>* relative_scores) const {
    const auto a = attention(query(x), key(x), value(x), offsets, offsets, {.heads = heads}, relative_scores);
    const auto y = attended_norm(attended(a, Activation::none, &x));
    return norm(down(up(y, activation), Activation::none, &y));
  }
};

/// Source  Sanh et al. (2019), Devlin et al. (2019), Song et al. (2020); spec text-encoders.md, sections 2 to 4. In evaluation mode,
///         without pooler and heads.
template <Backend B, class Keys>
struct BertNetwork {
  Embedding<B> words, positions;
  std::optional<Embedding<B>> token_types, relative_scores;
  LayerNorm<B> norm;
  std::vector<BertLayer<B, Keys>> layers;
  Index padding = 0;

  static constexpr auto fields() {
    using M = BertNetwork;
    return motionlang::fields("embeddings.word_embeddings", &M::words, "embeddings.position_embeddings", &M::positions,
                              "embeddings.token_type_embeddings", &M::token_types, "embeddings.LayerNorm", &M::norm,
                              Keys::layers, &M::layers, "encoder.relative_attention_bias", &M::relative_scores,
                              "padding", &M::padding);
  }
  using Config = BertConfig;
  using keys = Keys;

  BertNetwork() = default;
  BertNetwork(const BertConfig& c, Rng auto& rng)
      : words(c.vocabulary, c.width, rng, 0.02),
        positions(c.positions, c.width, rng, 0.02),
        norm(c.width),
        padding(c.padding) {
    norm.eps = c.eps;
    if (Keys::token_types) token_types.emplace(c.token_types, c.width, rng, 0.02);
    if (Keys::relative_scores) relative_scores.emplace(c.buckets, c.heads, rng, 0.02);
    for (Index i = 0; i < c.layers; ++i) layers.emplace_back(c, rng);
  }

  /// Ids of the longest text that there are positions for.
  Index longest() const { return positions.weight.size(0) - first_position(); }

  /// The states of the last layer, one row for every id. Throws config_error 101 for a text that is too long, shape_error 203 for
  /// an unknown id.
  TextFeatures<B> operator()(const TokenBatch& batch) const {
    const Offsets offsets = token_offsets(batch);
    if (offsets.longest() > longest())
      raise<config_error>(101, Keys::model_type, ": a text of ", offsets.longest(), " pieces; there are positions for ",
                          longest(), " (let the tokenizer cut it)");
    auto x = words(batch.ids) + positions(position_ids(batch));
    if (token_types) x = x + slice(token_types->weight, 0, 0, 1);
    x = norm(x);
    std::optional<Tensor<B, 2>> scores;
    if (relative_scores) scores = scores_of_distances(std::max<Index>(1, offsets.longest()));
    for (const auto& layer : layers) x = layer(x, offsets, scores ? &*scores : nullptr);
    return {{x, offsets}};
  }

 private:
  Index first_position() const { return Keys::positions_behind_padding ? padding + 1 : 0; }

  std::vector<Index> position_ids(const TokenBatch& batch) const {
    std::vector<Index> out;
    for (Index length : batch.lengths) {
      Index next = first_position();
      for (Index i = 0; i < length; ++i) {
        const bool padded = Keys::positions_behind_padding && batch.ids[out.size()] == padding;
        out.push_back(padded ? padding : next++);
      }
    }
    return out;
  }
  /// (heads, 2 n - 1): for the distances -(n - 1) ... n - 1.
  Tensor<B, 2> scores_of_distances(Index n) const {
    PoolVector<Index> buckets;
    for (Index r = 1 - n; r < n; ++r) buckets.push_back(mpnet_bucket(r));
    return transpose(gather(relative_scores->weight, buckets));
  }
};

template <Backend B>
using DistilBert = BertNetwork<B, DistilBertKeys>;
template <Backend B>
using Bert = BertNetwork<B, BertKeys>;
template <Backend B>
using Mpnet = BertNetwork<B, MpnetKeys>;

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_BERT_TOKENIZER_HPP  // <motionlang/text/bert_tokenizer.hpp>
#define MOTIONLANG_HAS_TEXT_BERT_TOKENIZER_HPP
/// The WordPiece tokenizer of BERT, DistilBERT and MiniLM, and its MPNet variant: ids as the fast tokenizers of Hugging Face give
/// them. Vocabularies are read by io/tokenizer_files.hpp.
///
///     const BertTokenizer bert(read_vocabulary("vocab.txt"));
///     bert.encode("a person walks.");   // [CLS] a person walks . [SEP]
///
/// Source   Devlin et al. (2019), the published tokenizer; spec text-encoders.md 7 and 8
/// Differs  the tables are those of Unicode 15, in the fast tokenizers of Unicode 8: newer punctuation and newer combining marks
///          are known here

#ifndef MOTIONLANG_HAS_TEXT_UNICODE_HPP  // <motionlang/text/unicode.hpp>
#define MOTIONLANG_HAS_TEXT_UNICODE_HPP
/// What tokenizers need of Unicode: classes of characters, lower case, canonical decomposition and composition (NFD, NFC).
/// No locale, no collation, no other normal forms.
///
/// Source  Unicode Standard 15.0, sections 3.11, 3.12 (normal forms, Hangul) and 3.13 (final sigma); the tables are generated
///         by tests/tools/make_unicode_tables.py

#ifndef MOTIONLANG_HAS_TEXT_DETAIL_UNICODE_TABLES_HPP  // <motionlang/text/detail/unicode_tables.hpp>
#define MOTIONLANG_HAS_TEXT_DETAIL_UNICODE_TABLES_HPP
/// Tables of the Unicode Character Database 15.0.0, for text/unicode.hpp.
/// The data are Copyright (C) 1991-2022 Unicode, Inc.; terms of use: https://www.unicode.org/terms_of_use.html
/// Generated by tests/tools/make_unicode_tables.py: do not edit.

// clang-format off
namespace motionlang::inline MOTIONLANG_ABI::detail {

inline constexpr char unicode_version[] = "15.0.0";

/// Runs of code points with the same properties: first << 8 | CharClass.
inline constexpr std::uint32_t class_runs[] = {
    0x10,0x930,0xE10,0x2020,0x2104,0x2400,0x2504,0x2784,0x2804,0x2B00,0x2C04,0x2E84,0x2F04,0x3002,0x3A84,0x3B04,0x3C00,
    0x3F04,0x4141,0x5B04,0x5E80,0x5F04,0x6080,0x6141,0x7B04,0x7C00,0x7D04,0x7E00,0x7F10,0x8530,0x8610,0xA020,0xA104,
    0xA200,0xA704,0xA880,0xA900,0xAA41,0xAB04,0xAC00,0xAD90,0xAE00,0xAF80,0xB000,0xB202,0xB480,0xB541,0xB604,0xB784,
    0xB880,0xB902,0xBA41,0xBB04,0xBC02,0xBF04,0xC041,0xD700,0xD841,0xF700,0xF841,0x1BB01,0x1BC41,0x1C001,0x1C441,0x29401,
    0x29541,0x2B0C1,0x2B981,0x2C0C1,0x2C280,0x2C681,0x2D280,0x2E0C1,0x2E580,0x2EC81,0x2ED80,0x2EE81,0x2EF80,0x30088,
    0x345C8,0x34688,0x37041,0x37481,0x37580,0x37641,0x37800,0x37AC1,0x37B41,0x37E04,0x37F41,0x38000,0x38480,0x38641,
    0x38784,0x38841,0x38B00,0x38C41,0x38D00,0x38E41,0x3A200,0x3A341,0x3F600,0x3F741,0x48200,0x48388,0x48880,0x48A41,
    0x53000,0x53141,0x55700,0x55981,0x55A04,0x55F84,0x56041,0x58904,0x58B00,0x59188,0x5BE04,0x5BF88,0x5C004,0x5C188,
    0x5C304,0x5C488,0x5C604,0x5C788,0x5C800,0x5D001,0x5EB00,0x5EF01,0x5F304,0x5F484,0x5F500,0x60090,0x60600,0x60904,
    0x60B00,0x60C04,0x60E00,0x61088,0x61B04,0x61C90,0x61D04,0x62001,0x64081,0x64101,0x64B88,0x66002,0x66A04,0x66E01,
    0x67088,0x67101,0x6D404,0x6D501,0x6D688,0x6DD90,0x6DE00,0x6DF88,0x6E581,0x6E788,0x6E900,0x6EA88,0x6EE01,0x6F002,
    0x6FA01,0x6FD00,0x6FF01,0x70004,0x70E00,0x70F90,0x71001,0x71188,0x71201,0x73088,0x74B00,0x74D01,0x7A688,0x7B101,
    0x7B200,0x7C002,0x7CA01,0x7EB88,0x7F481,0x7F600,0x7F704,0x7FA81,0x7FB00,0x7FD88,0x7FE00,0x80001,0x81688,0x81A81,
    0x81B88,0x82481,0x82588,0x82881,0x82988,0x82E00,0x83004,0x83F00,0x84001,0x85988,0x85C00,0x85E04,0x85F00,0x86001,
    0x86B00,0x87001,0x88880,0x88901,0x88F00,0x89090,0x89200,0x89888,0x8A001,0x8C981,0x8CA88,0x8E290,0x8E388,0x90300,
    0x90401,0x93A88,0x93B00,0x93C88,0x93D01,0x93E00,0x94188,0x94900,0x94D88,0x94E00,0x95001,0x95188,0x95801,0x96288,
    0x96404,0x96602,0x97004,0x97181,0x97201,0x98188,0x98200,0x98501,0x98D00,0x98F01,0x99100,0x99301,0x9A900,0x9AA01,
    0x9B100,0x9B201,0x9B300,0x9B601,0x9BA00,0x9BC88,0x9BD01,0x9BE00,0x9C188,0x9C500,0x9CD88,0x9CE01,0x9CF00,0x9DC01,
    0x9DE00,0x9DF01,0x9E288,0x9E400,0x9E602,0x9F001,0x9F200,0x9F402,0x9FA00,0x9FC01,0x9FD04,0x9FE88,0x9FF00,0xA0188,
    0xA0300,0xA0501,0xA0B00,0xA0F01,0xA1100,0xA1301,0xA2900,0xA2A01,0xA3100,0xA3201,0xA3400,0xA3501,0xA3700,0xA3801,
    0xA3A00,0xA3C88,0xA3D00,0xA4188,0xA4300,0xA4788,0xA4900,0xA4B88,0xA4E00,0xA5188,0xA5200,0xA5901,0xA5D00,0xA5E01,
    0xA5F00,0xA6602,0xA7088,0xA7201,0xA7588,0xA7604,0xA7700,0xA8188,0xA8300,0xA8501,0xA8E00,0xA8F01,0xA9200,0xA9301,
    0xAA900,0xAAA01,0xAB100,0xAB201,0xAB400,0xAB501,0xABA00,0xABC88,0xABD01,0xABE00,0xAC188,0xAC600,0xAC788,0xAC900,
    0xACD88,0xACE00,0xAD001,0xAD100,0xAE001,0xAE288,0xAE400,0xAE602,0xAF004,0xAF100,0xAF901,0xAFA88,0xB0000,0xB0188,
    0xB0200,0xB0501,0xB0D00,0xB0F01,0xB1100,0xB1301,0xB2900,0xB2A01,0xB3100,0xB3201,0xB3400,0xB3501,0xB3A00,0xB3C88,
    0xB3D01,0xB3E00,0xB3F88,0xB4000,0xB4188,0xB4500,0xB4D88,0xB4E00,0xB5588,0xB5700,0xB5C01,0xB5E00,0xB5F01,0xB6288,
    0xB6400,0xB6602,0xB7000,0xB7101,0xB7202,0xB7800,0xB8288,0xB8301,0xB8400,0xB8501,0xB8B00,0xB8E01,0xB9100,0xB9201,
    0xB9600,0xB9901,0xB9B00,0xB9C01,0xB9D00,0xB9E01,0xBA000,0xBA301,0xBA500,0xBA801,0xBAB00,0xBAE01,0xBBA00,0xBC088,
    0xBC100,0xBCD88,0xBCE00,0xBD001,0xBD100,0xBE602,0xBF300,0xC0088,0xC0100,0xC0488,0xC0501,0xC0D00,0xC0E01,0xC1100,
    0xC1201,0xC2900,0xC2A01,0xC3A00,0xC3C88,0xC3D01,0xC3E88,0xC4100,0xC4688,0xC4900,0xC4A88,0xC4E00,0xC5588,0xC5700,
    0xC5801,0xC5B00,0xC5D01,0xC5E00,0xC6001,0xC6288,0xC6400,0xC6602,0xC7000,0xC7704,0xC7802,0xC7F00,0xC8001,0xC8188,
    0xC8200,0xC8404,0xC8501,0xC8D00,0xC8E01,0xC9100,0xC9201,0xCA900,0xCAA01,0xCB400,0xCB501,0xCBA00,0xCBC88,0xCBD01,
    0xCBE00,0xCBF88,0xCC000,0xCC688,0xCC700,0xCCC88,0xCCE00,0xCDD01,0xCDF00,0xCE001,0xCE288,0xCE400,0xCE602,0xCF000,
    0xCF101,0xCF300,0xD0088,0xD0200,0xD0401,0xD0D00,0xD0E01,0xD1100,0xD1201,0xD3B88,0xD3D01,0xD3E00,0xD4188,0xD4500,
    0xD4D88,0xD4E01,0xD4F00,0xD5401,0xD5700,0xD5802,0xD5F01,0xD6288,0xD6400,0xD6602,0xD7900,0xD7A01,0xD8000,0xD8188,
    0xD8200,0xD8501,0xD9700,0xD9A01,0xDB200,0xDB301,0xDBC00,0xDBD01,0xDBE00,0xDC001,0xDC700,0xDCA88,0xDCB00,0xDD288,
    0xDD500,0xDD688,0xDD700,0xDE602,0xDF000,0xDF404,0xDF500,0xE0101,0xE3188,0xE3201,0xE3488,0xE3B00,0xE4001,0xE4681,
    0xE4788,0xE4F04,0xE5002,0xE5A04,0xE5C00,0xE8101,0xE8300,0xE8401,0xE8500,0xE8601,0xE8B00,0xE8C01,0xEA400,0xEA501,
    0xEA600,0xEA701,0xEB188,0xEB201,0xEB488,0xEBD01,0xEBE00,0xEC001,0xEC500,0xEC681,0xEC700,0xEC888,0xECF00,0xED002,
    0xEDA00,0xEDC01,0xEE000,0xF0001,0xF0100,0xF0404,0xF1300,0xF1404,0xF1500,0xF1888,0xF1A00,0xF2002,0xF3400,0xF3588,
    0xF3600,0xF3788,0xF3800,0xF3988,0xF3A04,0xF3E00,0xF4001,0xF4800,0xF4901,0xF6D00,0xF7188,0xF7F00,0xF8088,0xF8504,
    0xF8688,0xF8801,0xF8D88,0xF9800,0xF9988,0xFBD00,0xFC688,0xFC700,0xFD004,0xFD500,0xFD904,0xFDB00,0x100001,0x102B00,
    0x102D88,0x103100,0x103288,0x103800,0x103988,0x103B00,0x103D88,0x103F01,0x104002,0x104A04,0x105001,0x105600,0x105888,
    0x105A01,0x105E88,0x106101,0x106200,0x106501,0x106700,0x106E01,0x107188,0x107501,0x108288,0x108300,0x108588,0x108700,
    0x108D88,0x108E01,0x108F00,0x109002,0x109A00,0x109D88,0x109E00,0x10A041,0x10C600,0x10C741,0x10C800,0x10CD41,0x10CE00,
    0x10D041,0x10FB04,0x10FCC1,0x10FD41,0x110001,0x124900,0x124A01,0x124E00,0x125001,0x125700,0x125801,0x125900,0x125A01,
    0x125E00,0x126001,0x128900,0x128A01,0x128E00,0x129001,0x12B100,0x12B201,0x12B600,0x12B801,0x12BF00,0x12C001,0x12C100,
    0x12C201,0x12C600,0x12C801,0x12D700,0x12D801,0x131100,0x131201,0x131600,0x131801,0x135B00,0x135D88,0x136004,0x136902,
    0x137D00,0x138001,0x139000,0x13A041,0x13F600,0x13F841,0x13FE00,0x140004,0x140101,0x166D00,0x166E04,0x166F01,0x168020,
    0x168101,0x169B04,0x169D00,0x16A001,0x16EB04,0x16EE02,0x16F101,0x16F900,0x170001,0x171288,0x171500,0x171F01,0x173288,
    0x173400,0x173504,0x173700,0x174001,0x175288,0x175400,0x176001,0x176D00,0x176E01,0x177100,0x177288,0x177400,0x178001,
    0x17B488,0x17B600,0x17B788,0x17BE00,0x17C688,0x17C700,0x17C988,0x17D404,0x17D781,0x17D804,0x17DB00,0x17DC01,0x17DD88,
    0x17DE00,0x17E002,0x17EA00,0x17F002,0x17FA00,0x180004,0x180B88,0x180E90,0x180F88,0x181002,0x181A00,0x182001,0x184381,
    0x184401,0x187900,0x188001,0x188588,0x188701,0x18A988,0x18AA01,0x18AB00,0x18B001,0x18F600,0x190001,0x191F00,0x192088,
    0x192300,0x192788,0x192900,0x193288,0x193300,0x193988,0x193C00,0x194404,0x194602,0x195001,0x196E00,0x197001,0x197500,
    0x198001,0x19AC00,0x19B001,0x19CA00,0x19D002,0x19DB00,0x1A0001,0x1A1788,0x1A1900,0x1A1B88,0x1A1C00,0x1A1E04,0x1A2001,
    0x1A5500,0x1A5688,0x1A5700,0x1A5888,0x1A5F00,0x1A6088,0x1A6100,0x1A6288,0x1A6300,0x1A6588,0x1A6D00,0x1A7388,0x1A7D00,
    0x1A7F88,0x1A8002,0x1A8A00,0x1A9002,0x1A9A00,0x1AA004,0x1AA781,0x1AA804,0x1AAE00,0x1AB088,0x1ABE80,0x1ABF88,0x1ACF00,
    0x1B0088,0x1B0400,0x1B0501,0x1B3488,0x1B3500,0x1B3688,0x1B3B00,0x1B3C88,0x1B3D00,0x1B4288,0x1B4300,0x1B4501,0x1B4D00,
    0x1B5002,0x1B5A04,0x1B6100,0x1B6B88,0x1B7400,0x1B7D04,0x1B7F00,0x1B8088,0x1B8200,0x1B8301,0x1BA100,0x1BA288,0x1BA600,
    0x1BA888,0x1BAA00,0x1BAB88,0x1BAE01,0x1BB002,0x1BBA01,0x1BE688,0x1BE700,0x1BE888,0x1BEA00,0x1BED88,0x1BEE00,0x1BEF88,
    0x1BF200,0x1BFC04,0x1C0001,0x1C2400,0x1C2C88,0x1C3400,0x1C3688,0x1C3800,0x1C3B04,0x1C4002,0x1C4A00,0x1C4D01,0x1C5002,
    0x1C5A01,0x1C7881,0x1C7E04,0x1C8041,0x1C8900,0x1C9041,0x1CBB00,0x1CBD41,0x1CC004,0x1CC800,0x1CD088,0x1CD304,0x1CD488,
    0x1CE100,0x1CE288,0x1CE901,0x1CED88,0x1CEE01,0x1CF488,0x1CF501,0x1CF700,0x1CF888,0x1CFA01,0x1CFB00,0x1D0041,0x1D2CC1,
    0x1D6B41,0x1D78C1,0x1D7941,0x1D9BC1,0x1DC088,0x1E0041,0x1F1600,0x1F1841,0x1F1E00,0x1F2041,0x1F4600,0x1F4841,0x1F4E00,
    0x1F5041,0x1F5800,0x1F5941,0x1F5A00,0x1F5B41,0x1F5C00,0x1F5D41,0x1F5E00,0x1F5F41,0x1F7E00,0x1F8041,0x1FB500,0x1FB641,
    0x1FBD80,0x1FBE41,0x1FBF80,0x1FC241,0x1FC500,0x1FC641,0x1FCD80,0x1FD041,0x1FD400,0x1FD641,0x1FDC00,0x1FDD80,0x1FE041,
    0x1FED80,0x1FF000,0x1FF241,0x1FF500,0x1FF641,0x1FFD80,0x1FFF00,0x200020,0x200B90,0x201004,0x201884,0x201A04,0x202484,
    0x202504,0x202784,0x202820,0x202A90,0x202F20,0x203004,0x204400,0x204504,0x205200,0x205304,0x205F20,0x206090,0x206500,
    0x206690,0x207002,0x2071C1,0x207200,0x207402,0x207A00,0x207D04,0x207FC1,0x208002,0x208A00,0x208D04,0x208F00,0x2090C1,
    0x209D00,0x20D088,0x20DD80,0x20E188,0x20E280,0x20E588,0x20F100,0x210241,0x210300,0x210741,0x210800,0x210A41,0x211400,
    0x211541,0x211600,0x211941,0x211E00,0x212441,0x212500,0x212641,0x212700,0x212841,0x212900,0x212A41,0x212E00,0x212F41,
    0x213501,0x213941,0x213A00,0x213C41,0x214000,0x214541,0x214A00,0x214E41,0x214F00,0x215002,0x216042,0x218002,0x218341,
    0x218502,0x218A00,0x230804,0x230C00,0x232904,0x232B00,0x246002,0x249C00,0x24B640,0x24EA02,0x250000,0x276804,0x277602,
    0x279400,0x27C504,0x27C700,0x27E604,0x27F000,0x298304,0x299900,0x29D804,0x29DC00,0x29FC04,0x29FE00,0x2C0041,0x2C7CC1,
    0x2C7E41,0x2CE500,0x2CEB41,0x2CEF88,0x2CF241,0x2CF400,0x2CF904,0x2CFD02,0x2CFE04,0x2D0041,0x2D2600,0x2D2741,0x2D2800,
    0x2D2D41,0x2D2E00,0x2D3001,0x2D6800,0x2D6F81,0x2D7004,0x2D7100,0x2D7F88,0x2D8001,0x2D9700,0x2DA001,0x2DA700,0x2DA801,
    0x2DAF00,0x2DB001,0x2DB700,0x2DB801,0x2DBF00,0x2DC001,0x2DC700,0x2DC801,0x2DCF00,0x2DD001,0x2DD700,0x2DD801,0x2DDF00,
    0x2DE088,0x2E0004,0x2E2F81,0x2E3004,0x2E5000,0x2E5204,0x2E5E00,0x300020,0x300104,0x300400,0x300581,0x300601,0x300702,
    0x300804,0x301200,0x301404,0x302000,0x302102,0x302A88,0x302E00,0x303004,0x303181,0x303600,0x303802,0x303B81,0x303C01,
    0x303D04,0x303E00,0x304101,0x309700,0x309988,0x309B80,0x309D81,0x309F01,0x30A004,0x30A101,0x30FB04,0x30FC81,0x30FF01,
    0x310000,0x310501,0x313000,0x313101,0x318F00,0x319202,0x319600,0x31A001,0x31C000,0x31F001,0x320000,0x322002,0x322A00,
    0x324802,0x325000,0x325102,0x326000,0x328002,0x328A00,0x32B102,0x32C000,0x340001,0x4DC000,0x4E0001,0xA01581,0xA01601,
    0xA48D00,0xA4D001,0xA4F881,0xA4FE04,0xA50001,0xA60C81,0xA60D04,0xA61001,0xA62002,0xA62A01,0xA62C00,0xA64041,0xA66E01,
    0xA66F88,0xA67080,0xA67304,0xA67488,0xA67E04,0xA67F81,0xA68041,0xA69CC1,0xA69E88,0xA6A001,0xA6E602,0xA6F088,0xA6F204,
    0xA6F800,0xA70080,0xA71781,0xA72080,0xA72241,0xA770C1,0xA77141,0xA78881,0xA78980,0xA78B41,0xA78F01,0xA79041,0xA7CB00,
    0xA7D041,0xA7D200,0xA7D341,0xA7D400,0xA7D541,0xA7DA00,0xA7F2C1,0xA7F541,0xA7F701,0xA7F8C1,0xA7FA41,0xA7FB01,0xA80288,
    0xA80301,0xA80688,0xA80701,0xA80B88,0xA80C01,0xA82300,0xA82588,0xA82700,0xA82C88,0xA82D00,0xA83002,0xA83600,0xA84001,
    0xA87404,0xA87800,0xA88201,0xA8B400,0xA8C488,0xA8C600,0xA8CE04,0xA8D002,0xA8DA00,0xA8E088,0xA8F201,0xA8F804,0xA8FB01,
    0xA8FC04,0xA8FD01,0xA8FF88,0xA90002,0xA90A01,0xA92688,0xA92E04,0xA93001,0xA94788,0xA95200,0xA95F04,0xA96001,0xA97D00,
    0xA98088,0xA98300,0xA98401,0xA9B388,0xA9B400,0xA9B688,0xA9BA00,0xA9BC88,0xA9BE00,0xA9C104,0xA9CE00,0xA9CF81,0xA9D002,
    0xA9DA00,0xA9DE04,0xA9E001,0xA9E588,0xA9E681,0xA9E701,0xA9F002,0xA9FA01,0xA9FF00,0xAA0001,0xAA2988,0xAA2F00,0xAA3188,
    0xAA3300,0xAA3588,0xAA3700,0xAA4001,0xAA4388,0xAA4401,0xAA4C88,0xAA4D00,0xAA5002,0xAA5A00,0xAA5C04,0xAA6001,0xAA7081,
    0xAA7101,0xAA7700,0xAA7A01,0xAA7B00,0xAA7C88,0xAA7D00,0xAA7E01,0xAAB088,0xAAB101,0xAAB288,0xAAB501,0xAAB788,0xAAB901,
    0xAABE88,0xAAC001,0xAAC188,0xAAC201,0xAAC300,0xAADB01,0xAADD81,0xAADE04,0xAAE001,0xAAEB00,0xAAEC88,0xAAEE00,0xAAF004,
    0xAAF201,0xAAF381,0xAAF500,0xAAF688,0xAAF700,0xAB0101,0xAB0700,0xAB0901,0xAB0F00,0xAB1101,0xAB1700,0xAB2001,0xAB2700,
    0xAB2801,0xAB2F00,0xAB3041,0xAB5B80,0xAB5CC1,0xAB6041,0xAB69C1,0xAB6A80,0xAB6C00,0xAB7041,0xABC001,0xABE300,0xABE588,
    0xABE600,0xABE888,0xABE900,0xABEB04,0xABEC00,0xABED88,0xABEE00,0xABF002,0xABFA00,0xAC0001,0xD7A400,0xD7B001,0xD7C700,
    0xD7CB01,0xD7FC00,0xD80010,0xF90001,0xFA6E00,0xFA7001,0xFADA00,0xFB0041,0xFB0700,0xFB1341,0xFB1800,0xFB1D01,0xFB1E88,
    0xFB1F01,0xFB2900,0xFB2A01,0xFB3700,0xFB3801,0xFB3D00,0xFB3E01,0xFB3F00,0xFB4001,0xFB4200,0xFB4301,0xFB4500,0xFB4601,
    0xFBB280,0xFBC300,0xFBD301,0xFD3E04,0xFD4000,0xFD5001,0xFD9000,0xFD9201,0xFDC800,0xFDF001,0xFDFC00,0xFE0088,0xFE1004,
    0xFE1384,0xFE1404,0xFE1A00,0xFE2088,0xFE3004,0xFE5284,0xFE5300,0xFE5404,0xFE5584,0xFE5604,0xFE6200,0xFE6304,0xFE6400,
    0xFE6804,0xFE6900,0xFE6A04,0xFE6C00,0xFE7001,0xFE7500,0xFE7601,0xFEFD00,0xFEFF90,0xFF0000,0xFF0104,0xFF0400,0xFF0504,
    0xFF0784,0xFF0804,0xFF0B00,0xFF0C04,0xFF0E84,0xFF0F04,0xFF1002,0xFF1A84,0xFF1B04,0xFF1C00,0xFF1F04,0xFF2141,0xFF3B04,
    0xFF3E80,0xFF3F04,0xFF4080,0xFF4141,0xFF5B04,0xFF5C00,0xFF5D04,0xFF5E00,0xFF5F04,0xFF6601,0xFF7081,0xFF7101,0xFF9E81,
    0xFFA001,0xFFBF00,0xFFC201,0xFFC800,0xFFCA01,0xFFD000,0xFFD201,0xFFD800,0xFFDA01,0xFFDD00,0xFFE380,0xFFE400,0xFFF990,
    0xFFFC00,0x1000001,0x1000C00,0x1000D01,0x1002700,0x1002801,0x1003B00,0x1003C01,0x1003E00,0x1003F01,0x1004E00,
    0x1005001,0x1005E00,0x1008001,0x100FB00,0x1010004,0x1010300,0x1010702,0x1013400,0x1014002,0x1017900,0x1018A02,
    0x1018C00,0x101FD88,0x101FE00,0x1028001,0x1029D00,0x102A001,0x102D100,0x102E088,0x102E102,0x102FC00,0x1030001,
    0x1032002,0x1032400,0x1032D01,0x1034102,0x1034201,0x1034A02,0x1034B00,0x1035001,0x1037688,0x1037B00,0x1038001,
    0x1039E00,0x1039F04,0x103A001,0x103C400,0x103C801,0x103D004,0x103D102,0x103D600,0x1040041,0x1045001,0x1049E00,
    0x104A002,0x104AA00,0x104B041,0x104D400,0x104D841,0x104FC00,0x1050001,0x1052800,0x1053001,0x1056400,0x1056F04,
    0x1057041,0x1057B00,0x1057C41,0x1058B00,0x1058C41,0x1059300,0x1059441,0x1059600,0x1059741,0x105A200,0x105A341,
    0x105B200,0x105B341,0x105BA00,0x105BB41,0x105BD00,0x1060001,0x1073700,0x1074001,0x1075600,0x1076001,0x1076800,
    0x10780C1,0x1078181,0x10783C1,0x1078600,0x10787C1,0x107B100,0x107B2C1,0x107BB00,0x1080001,0x1080600,0x1080801,
    0x1080900,0x1080A01,0x1083600,0x1083701,0x1083900,0x1083C01,0x1083D00,0x1083F01,0x1085600,0x1085704,0x1085802,
    0x1086001,0x1087700,0x1087902,0x1088001,0x1089F00,0x108A702,0x108B000,0x108E001,0x108F300,0x108F401,0x108F600,
    0x108FB02,0x1090001,0x1091602,0x1091C00,0x1091F04,0x1092001,0x1093A00,0x1093F04,0x1094000,0x1098001,0x109B800,
    0x109BC02,0x109BE01,0x109C002,0x109D000,0x109D202,0x10A0001,0x10A0188,0x10A0400,0x10A0588,0x10A0700,0x10A0C88,
    0x10A1001,0x10A1400,0x10A1501,0x10A1800,0x10A1901,0x10A3600,0x10A3888,0x10A3B00,0x10A3F88,0x10A4002,0x10A4900,
    0x10A5004,0x10A5900,0x10A6001,0x10A7D02,0x10A7F04,0x10A8001,0x10A9D02,0x10AA000,0x10AC001,0x10AC800,0x10AC901,
    0x10AE588,0x10AE700,0x10AEB02,0x10AF004,0x10AF700,0x10B0001,0x10B3600,0x10B3904,0x10B4001,0x10B5600,0x10B5802,
    0x10B6001,0x10B7300,0x10B7802,0x10B8001,0x10B9200,0x10B9904,0x10B9D00,0x10BA902,0x10BB000,0x10C0001,0x10C4900,
    0x10C8041,0x10CB300,0x10CC041,0x10CF300,0x10CFA02,0x10D0001,0x10D2488,0x10D2800,0x10D3002,0x10D3A00,0x10E6002,
    0x10E7F00,0x10E8001,0x10EAA00,0x10EAB88,0x10EAD04,0x10EAE00,0x10EB001,0x10EB200,0x10EFD88,0x10F0001,0x10F1D02,
    0x10F2701,0x10F2800,0x10F3001,0x10F4688,0x10F5102,0x10F5504,0x10F5A00,0x10F7001,0x10F8288,0x10F8604,0x10F8A00,
    0x10FB001,0x10FC502,0x10FCC00,0x10FE001,0x10FF700,0x1100188,0x1100200,0x1100301,0x1103888,0x1104704,0x1104E00,
    0x1105202,0x1107088,0x1107101,0x1107388,0x1107501,0x1107600,0x1107F88,0x1108200,0x1108301,0x110B000,0x110B388,
    0x110B700,0x110B988,0x110BB04,0x110BD90,0x110BE04,0x110C288,0x110C300,0x110CD90,0x110CE00,0x110D001,0x110E900,
    0x110F002,0x110FA00,0x1110088,0x1110301,0x1112788,0x1112C00,0x1112D88,0x1113500,0x1113602,0x1114004,0x1114401,
    0x1114500,0x1114701,0x1114800,0x1115001,0x1117388,0x1117404,0x1117601,0x1117700,0x1118088,0x1118200,0x1118301,
    0x111B300,0x111B688,0x111BF00,0x111C101,0x111C504,0x111C988,0x111CD04,0x111CE00,0x111CF88,0x111D002,0x111DA01,
    0x111DB04,0x111DC01,0x111DD04,0x111E000,0x111E102,0x111F500,0x1120001,0x1121200,0x1121301,0x1122C00,0x1122F88,
    0x1123200,0x1123488,0x1123500,0x1123688,0x1123804,0x1123E88,0x1123F01,0x1124188,0x1124200,0x1128001,0x1128700,
    0x1128801,0x1128900,0x1128A01,0x1128E00,0x1128F01,0x1129E00,0x1129F01,0x112A904,0x112AA00,0x112B001,0x112DF88,
    0x112E000,0x112E388,0x112EB00,0x112F002,0x112FA00,0x1130088,0x1130200,0x1130501,0x1130D00,0x1130F01,0x1131100,
    0x1131301,0x1132900,0x1132A01,0x1133100,0x1133201,0x1133400,0x1133501,0x1133A00,0x1133B88,0x1133D01,0x1133E00,
    0x1134088,0x1134100,0x1135001,0x1135100,0x1135D01,0x1136200,0x1136688,0x1136D00,0x1137088,0x1137500,0x1140001,
    0x1143500,0x1143888,0x1144000,0x1144288,0x1144500,0x1144688,0x1144701,0x1144B04,0x1145002,0x1145A04,0x1145C00,
    0x1145D04,0x1145E88,0x1145F01,0x1146200,0x1148001,0x114B000,0x114B388,0x114B900,0x114BA88,0x114BB00,0x114BF88,
    0x114C100,0x114C288,0x114C401,0x114C604,0x114C701,0x114C800,0x114D002,0x114DA00,0x1158001,0x115AF00,0x115B288,
    0x115B600,0x115BC88,0x115BE00,0x115BF88,0x115C104,0x115D801,0x115DC88,0x115DE00,0x1160001,0x1163000,0x1163388,
    0x1163B00,0x1163D88,0x1163E00,0x1163F88,0x1164104,0x1164401,0x1164500,0x1165002,0x1165A00,0x1166004,0x1166D00,
    0x1168001,0x116AB88,0x116AC00,0x116AD88,0x116AE00,0x116B088,0x116B600,0x116B788,0x116B801,0x116B904,0x116BA00,
    0x116C002,0x116CA00,0x1170001,0x1171B00,0x1171D88,0x1172000,0x1172288,0x1172600,0x1172788,0x1172C00,0x1173002,
    0x1173C04,0x1173F00,0x1174001,0x1174700,0x1180001,0x1182C00,0x1182F88,0x1183800,0x1183988,0x1183B04,0x1183C00,
    0x118A041,0x118E002,0x118F300,0x118FF01,0x1190700,0x1190901,0x1190A00,0x1190C01,0x1191400,0x1191501,0x1191700,
    0x1191801,0x1193000,0x1193B88,0x1193D00,0x1193E88,0x1193F01,0x1194000,0x1194101,0x1194200,0x1194388,0x1194404,
    0x1194700,0x1195002,0x1195A00,0x119A001,0x119A800,0x119AA01,0x119D100,0x119D488,0x119D800,0x119DA88,0x119DC00,
    0x119E088,0x119E101,0x119E204,0x119E301,0x119E400,0x11A0001,0x11A0188,0x11A0B01,0x11A3388,0x11A3900,0x11A3A01,
    0x11A3B88,0x11A3F04,0x11A4788,0x11A4800,0x11A5001,0x11A5188,0x11A5700,0x11A5988,0x11A5C01,0x11A8A88,0x11A9700,
    0x11A9888,0x11A9A04,0x11A9D01,0x11A9E04,0x11AA300,0x11AB001,0x11AF900,0x11B0004,0x11B0A00,0x11C0001,0x11C0900,
    0x11C0A01,0x11C2F00,0x11C3088,0x11C3700,0x11C3888,0x11C3E00,0x11C3F88,0x11C4001,0x11C4104,0x11C4600,0x11C5002,
    0x11C6D00,0x11C7004,0x11C7201,0x11C9000,0x11C9288,0x11CA800,0x11CAA88,0x11CB100,0x11CB288,0x11CB400,0x11CB588,
    0x11CB700,0x11D0001,0x11D0700,0x11D0801,0x11D0A00,0x11D0B01,0x11D3188,0x11D3700,0x11D3A88,0x11D3B00,0x11D3C88,
    0x11D3E00,0x11D3F88,0x11D4601,0x11D4788,0x11D4800,0x11D5002,0x11D5A00,0x11D6001,0x11D6600,0x11D6701,0x11D6900,
    0x11D6A01,0x11D8A00,0x11D9088,0x11D9200,0x11D9588,0x11D9600,0x11D9788,0x11D9801,0x11D9900,0x11DA002,0x11DAA00,
    0x11EE001,0x11EF388,0x11EF500,0x11EF704,0x11EF900,0x11F0088,0x11F0201,0x11F0300,0x11F0401,0x11F1100,0x11F1201,
    0x11F3400,0x11F3688,0x11F3B00,0x11F4088,0x11F4100,0x11F4288,0x11F4304,0x11F5002,0x11F5A00,0x11FB001,0x11FB100,
    0x11FC002,0x11FD500,0x11FFF04,0x1200001,0x1239A00,0x1240002,0x1246F00,0x1247004,0x1247500,0x1248001,0x1254400,
    0x12F9001,0x12FF104,0x12FF300,0x1300001,0x1343090,0x1344088,0x1344101,0x1344788,0x1345600,0x1440001,0x1464700,
    0x1680001,0x16A3900,0x16A4001,0x16A5F00,0x16A6002,0x16A6A00,0x16A6E04,0x16A7001,0x16ABF00,0x16AC002,0x16ACA00,
    0x16AD001,0x16AEE00,0x16AF088,0x16AF504,0x16AF600,0x16B0001,0x16B3088,0x16B3704,0x16B3C00,0x16B4081,0x16B4404,
    0x16B4500,0x16B5002,0x16B5A00,0x16B5B02,0x16B6200,0x16B6301,0x16B7800,0x16B7D01,0x16B9000,0x16E4041,0x16E8002,
    0x16E9704,0x16E9B00,0x16F0001,0x16F4B00,0x16F4F88,0x16F5001,0x16F5100,0x16F8F88,0x16F9381,0x16FA000,0x16FE081,
    0x16FE204,0x16FE381,0x16FE488,0x16FE500,0x1700001,0x187F800,0x1880001,0x18CD600,0x18D0001,0x18D0900,0x1AFF081,
    0x1AFF400,0x1AFF581,0x1AFFC00,0x1AFFD81,0x1AFFF00,0x1B00001,0x1B12300,0x1B13201,0x1B13300,0x1B15001,0x1B15300,
    0x1B15501,0x1B15600,0x1B16401,0x1B16800,0x1B17001,0x1B2FC00,0x1BC0001,0x1BC6B00,0x1BC7001,0x1BC7D00,0x1BC8001,
    0x1BC8900,0x1BC9001,0x1BC9A00,0x1BC9D88,0x1BC9F04,0x1BCA090,0x1BCA400,0x1CF0088,0x1CF2E00,0x1CF3088,0x1CF4700,
    0x1D16788,0x1D16A00,0x1D17390,0x1D17B88,0x1D18300,0x1D18588,0x1D18C00,0x1D1AA88,0x1D1AE00,0x1D24288,0x1D24500,
    0x1D2C002,0x1D2D400,0x1D2E002,0x1D2F400,0x1D36002,0x1D37900,0x1D40041,0x1D45500,0x1D45641,0x1D49D00,0x1D49E41,
    0x1D4A000,0x1D4A241,0x1D4A300,0x1D4A541,0x1D4A700,0x1D4A941,0x1D4AD00,0x1D4AE41,0x1D4BA00,0x1D4BB41,0x1D4BC00,
    0x1D4BD41,0x1D4C400,0x1D4C541,0x1D50600,0x1D50741,0x1D50B00,0x1D50D41,0x1D51500,0x1D51641,0x1D51D00,0x1D51E41,
    0x1D53A00,0x1D53B41,0x1D53F00,0x1D54041,0x1D54500,0x1D54641,0x1D54700,0x1D54A41,0x1D55100,0x1D55241,0x1D6A600,
    0x1D6A841,0x1D6C100,0x1D6C241,0x1D6DB00,0x1D6DC41,0x1D6FB00,0x1D6FC41,0x1D71500,0x1D71641,0x1D73500,0x1D73641,
    0x1D74F00,0x1D75041,0x1D76F00,0x1D77041,0x1D78900,0x1D78A41,0x1D7A900,0x1D7AA41,0x1D7C300,0x1D7C441,0x1D7CC00,
    0x1D7CE02,0x1D80000,0x1DA0088,0x1DA3700,0x1DA3B88,0x1DA6D00,0x1DA7588,0x1DA7600,0x1DA8488,0x1DA8500,0x1DA8704,
    0x1DA8C00,0x1DA9B88,0x1DAA000,0x1DAA188,0x1DAB000,0x1DF0041,0x1DF0A01,0x1DF0B41,0x1DF1F00,0x1DF2541,0x1DF2B00,
    0x1E00088,0x1E00700,0x1E00888,0x1E01900,0x1E01B88,0x1E02200,0x1E02388,0x1E02500,0x1E02688,0x1E02B00,0x1E030C1,
    0x1E06E00,0x1E08F88,0x1E09000,0x1E10001,0x1E12D00,0x1E13088,0x1E13781,0x1E13E00,0x1E14002,0x1E14A00,0x1E14E01,
    0x1E14F00,0x1E29001,0x1E2AE88,0x1E2AF00,0x1E2C001,0x1E2EC88,0x1E2F002,0x1E2FA00,0x1E4D001,0x1E4EB81,0x1E4EC88,
    0x1E4F002,0x1E4FA00,0x1E7E001,0x1E7E700,0x1E7E801,0x1E7EC00,0x1E7ED01,0x1E7EF00,0x1E7F001,0x1E7FF00,0x1E80001,
    0x1E8C500,0x1E8C702,0x1E8D088,0x1E8D700,0x1E90041,0x1E94488,0x1E94B81,0x1E94C00,0x1E95002,0x1E95A00,0x1E95E04,
    0x1E96000,0x1EC7102,0x1ECAC00,0x1ECAD02,0x1ECB000,0x1ECB102,0x1ECB500,0x1ED0102,0x1ED2E00,0x1ED2F02,0x1ED3E00,
    0x1EE0001,0x1EE0400,0x1EE0501,0x1EE2000,0x1EE2101,0x1EE2300,0x1EE2401,0x1EE2500,0x1EE2701,0x1EE2800,0x1EE2901,
    0x1EE3300,0x1EE3401,0x1EE3800,0x1EE3901,0x1EE3A00,0x1EE3B01,0x1EE3C00,0x1EE4201,0x1EE4300,0x1EE4701,0x1EE4800,
    0x1EE4901,0x1EE4A00,0x1EE4B01,0x1EE4C00,0x1EE4D01,0x1EE5000,0x1EE5101,0x1EE5300,0x1EE5401,0x1EE5500,0x1EE5701,
    0x1EE5800,0x1EE5901,0x1EE5A00,0x1EE5B01,0x1EE5C00,0x1EE5D01,0x1EE5E00,0x1EE5F01,0x1EE6000,0x1EE6101,0x1EE6300,
    0x1EE6401,0x1EE6500,0x1EE6701,0x1EE6B00,0x1EE6C01,0x1EE7300,0x1EE7401,0x1EE7800,0x1EE7901,0x1EE7D00,0x1EE7E01,
    0x1EE7F00,0x1EE8001,0x1EE8A00,0x1EE8B01,0x1EE9C00,0x1EEA101,0x1EEA400,0x1EEA501,0x1EEAA00,0x1EEAB01,0x1EEBC00,
    0x1F10002,0x1F10D00,0x1F13040,0x1F14A00,0x1F15040,0x1F16A00,0x1F17040,0x1F18A00,0x1F3FB80,0x1F40000,0x1FBF002,
    0x1FBFA00,0x2000001,0x2A6E000,0x2A70001,0x2B73A00,0x2B74001,0x2B81E00,0x2B82001,0x2CEA200,0x2CEB001,0x2EBE100,
    0x2F80001,0x2FA1E00,0x3000001,0x3134B00,0x3135001,0x323B000,0xE000190,0xE000200,0xE002090,0xE008000,0xE010088,
    0xE01F000,0xF000010,0xFFFFE00,0x10000010,0x10FFFE00,
};

/// Simple lower case: first, first + step, ... last are moved by `difference`.
struct LowerRun {
  std::uint32_t first, last, step;
  std::int32_t difference;
};
inline constexpr LowerRun lower_runs[] = {
    {0x41,0x5A,1,0x20},{0xC0,0xD6,1,0x20},{0xD8,0xDE,1,0x20},{0x100,0x12E,2,1},{0x130,0x130,1,-0xC7},{0x132,0x136,2,1},
    {0x139,0x147,2,1},{0x14A,0x176,2,1},{0x178,0x178,1,-0x79},{0x179,0x17D,2,1},{0x181,0x181,1,0xD2},{0x182,0x184,2,1},
    {0x186,0x186,1,0xCE},{0x187,0x187,1,1},{0x189,0x18A,1,0xCD},{0x18B,0x18B,1,1},{0x18E,0x18E,1,0x4F},
    {0x18F,0x18F,1,0xCA},{0x190,0x190,1,0xCB},{0x191,0x191,1,1},{0x193,0x193,1,0xCD},{0x194,0x194,1,0xCF},
    {0x196,0x196,1,0xD3},{0x197,0x197,1,0xD1},{0x198,0x198,1,1},{0x19C,0x19C,1,0xD3},{0x19D,0x19D,1,0xD5},
    {0x19F,0x19F,1,0xD6},{0x1A0,0x1A4,2,1},{0x1A6,0x1A6,1,0xDA},{0x1A7,0x1A7,1,1},{0x1A9,0x1A9,1,0xDA},{0x1AC,0x1AC,1,1},
    {0x1AE,0x1AE,1,0xDA},{0x1AF,0x1AF,1,1},{0x1B1,0x1B2,1,0xD9},{0x1B3,0x1B5,2,1},{0x1B7,0x1B7,1,0xDB},{0x1B8,0x1B8,1,1},
    {0x1BC,0x1BC,1,1},{0x1C4,0x1C4,1,2},{0x1C5,0x1C5,1,1},{0x1C7,0x1C7,1,2},{0x1C8,0x1C8,1,1},{0x1CA,0x1CA,1,2},
    {0x1CB,0x1DB,2,1},{0x1DE,0x1EE,2,1},{0x1F1,0x1F1,1,2},{0x1F2,0x1F4,2,1},{0x1F6,0x1F6,1,-0x61},{0x1F7,0x1F7,1,-0x38},
    {0x1F8,0x21E,2,1},{0x220,0x220,1,-0x82},{0x222,0x232,2,1},{0x23A,0x23A,1,0x2A2B},{0x23B,0x23B,1,1},
    {0x23D,0x23D,1,-0xA3},{0x23E,0x23E,1,0x2A28},{0x241,0x241,1,1},{0x243,0x243,1,-0xC3},{0x244,0x244,1,0x45},
    {0x245,0x245,1,0x47},{0x246,0x24E,2,1},{0x370,0x372,2,1},{0x376,0x376,1,1},{0x37F,0x37F,1,0x74},{0x386,0x386,1,0x26},
    {0x388,0x38A,1,0x25},{0x38C,0x38C,1,0x40},{0x38E,0x38F,1,0x3F},{0x391,0x3A1,1,0x20},{0x3A3,0x3AB,1,0x20},
    {0x3CF,0x3CF,1,8},{0x3D8,0x3EE,2,1},{0x3F4,0x3F4,1,-0x3C},{0x3F7,0x3F7,1,1},{0x3F9,0x3F9,1,-7},{0x3FA,0x3FA,1,1},
    {0x3FD,0x3FF,1,-0x82},{0x400,0x40F,1,0x50},{0x410,0x42F,1,0x20},{0x460,0x480,2,1},{0x48A,0x4BE,2,1},
    {0x4C0,0x4C0,1,0xF},{0x4C1,0x4CD,2,1},{0x4D0,0x52E,2,1},{0x531,0x556,1,0x30},{0x10A0,0x10C5,1,0x1C60},
    {0x10C7,0x10C7,1,0x1C60},{0x10CD,0x10CD,1,0x1C60},{0x13A0,0x13EF,1,0x97D0},{0x13F0,0x13F5,1,8},
    {0x1C90,0x1CBA,1,-0xBC0},{0x1CBD,0x1CBF,1,-0xBC0},{0x1E00,0x1E94,2,1},{0x1E9E,0x1E9E,1,-0x1DBF},{0x1EA0,0x1EFE,2,1},
    {0x1F08,0x1F0F,1,-8},{0x1F18,0x1F1D,1,-8},{0x1F28,0x1F2F,1,-8},{0x1F38,0x1F3F,1,-8},{0x1F48,0x1F4D,1,-8},
    {0x1F59,0x1F5F,2,-8},{0x1F68,0x1F6F,1,-8},{0x1F88,0x1F8F,1,-8},{0x1F98,0x1F9F,1,-8},{0x1FA8,0x1FAF,1,-8},
    {0x1FB8,0x1FB9,1,-8},{0x1FBA,0x1FBB,1,-0x4A},{0x1FBC,0x1FBC,1,-9},{0x1FC8,0x1FCB,1,-0x56},{0x1FCC,0x1FCC,1,-9},
    {0x1FD8,0x1FD9,1,-8},{0x1FDA,0x1FDB,1,-0x64},{0x1FE8,0x1FE9,1,-8},{0x1FEA,0x1FEB,1,-0x70},{0x1FEC,0x1FEC,1,-7},
    {0x1FF8,0x1FF9,1,-0x80},{0x1FFA,0x1FFB,1,-0x7E},{0x1FFC,0x1FFC,1,-9},{0x2126,0x2126,1,-0x1D5D},
    {0x212A,0x212A,1,-0x20BF},{0x212B,0x212B,1,-0x2046},{0x2132,0x2132,1,0x1C},{0x2160,0x216F,1,0x10},
    {0x2183,0x2183,1,1},{0x24B6,0x24CF,1,0x1A},{0x2C00,0x2C2F,1,0x30},{0x2C60,0x2C60,1,1},{0x2C62,0x2C62,1,-0x29F7},
    {0x2C63,0x2C63,1,-0xEE6},{0x2C64,0x2C64,1,-0x29E7},{0x2C67,0x2C6B,2,1},{0x2C6D,0x2C6D,1,-0x2A1C},
    {0x2C6E,0x2C6E,1,-0x29FD},{0x2C6F,0x2C6F,1,-0x2A1F},{0x2C70,0x2C70,1,-0x2A1E},{0x2C72,0x2C72,1,1},
    {0x2C75,0x2C75,1,1},{0x2C7E,0x2C7F,1,-0x2A3F},{0x2C80,0x2CE2,2,1},{0x2CEB,0x2CED,2,1},{0x2CF2,0x2CF2,1,1},
    {0xA640,0xA66C,2,1},{0xA680,0xA69A,2,1},{0xA722,0xA72E,2,1},{0xA732,0xA76E,2,1},{0xA779,0xA77B,2,1},
    {0xA77D,0xA77D,1,-0x8A04},{0xA77E,0xA786,2,1},{0xA78B,0xA78B,1,1},{0xA78D,0xA78D,1,-0xA528},{0xA790,0xA792,2,1},
    {0xA796,0xA7A8,2,1},{0xA7AA,0xA7AA,1,-0xA544},{0xA7AB,0xA7AB,1,-0xA54F},{0xA7AC,0xA7AC,1,-0xA54B},
    {0xA7AD,0xA7AD,1,-0xA541},{0xA7AE,0xA7AE,1,-0xA544},{0xA7B0,0xA7B0,1,-0xA512},{0xA7B1,0xA7B1,1,-0xA52A},
    {0xA7B2,0xA7B2,1,-0xA515},{0xA7B3,0xA7B3,1,0x3A0},{0xA7B4,0xA7C2,2,1},{0xA7C4,0xA7C4,1,-0x30},
    {0xA7C5,0xA7C5,1,-0xA543},{0xA7C6,0xA7C6,1,-0x8A38},{0xA7C7,0xA7C9,2,1},{0xA7D0,0xA7D0,1,1},{0xA7D6,0xA7D8,2,1},
    {0xA7F5,0xA7F5,1,1},{0xFF21,0xFF3A,1,0x20},{0x10400,0x10427,1,0x28},{0x104B0,0x104D3,1,0x28},
    {0x10570,0x1057A,1,0x27},{0x1057C,0x1058A,1,0x27},{0x1058C,0x10592,1,0x27},{0x10594,0x10595,1,0x27},
    {0x10C80,0x10CB2,1,0x40},{0x118A0,0x118BF,1,0x20},{0x16E40,0x16E5F,1,0x20},{0x1E900,0x1E921,1,0x22},
};

/// Canonical combining classes other than 0.
struct CombiningRun {
  std::uint32_t first, last, combining;
};
inline constexpr CombiningRun combining_runs[] = {
    {0x300,0x314,0xE6},{0x315,0x315,0xE8},{0x316,0x319,0xDC},{0x31A,0x31A,0xE8},{0x31B,0x31B,0xD8},{0x31C,0x320,0xDC},
    {0x321,0x322,0xCA},{0x323,0x326,0xDC},{0x327,0x328,0xCA},{0x329,0x333,0xDC},{0x334,0x338,1},{0x339,0x33C,0xDC},
    {0x33D,0x344,0xE6},{0x345,0x345,0xF0},{0x346,0x346,0xE6},{0x347,0x349,0xDC},{0x34A,0x34C,0xE6},{0x34D,0x34E,0xDC},
    {0x350,0x352,0xE6},{0x353,0x356,0xDC},{0x357,0x357,0xE6},{0x358,0x358,0xE8},{0x359,0x35A,0xDC},{0x35B,0x35B,0xE6},
    {0x35C,0x35C,0xE9},{0x35D,0x35E,0xEA},{0x35F,0x35F,0xE9},{0x360,0x361,0xEA},{0x362,0x362,0xE9},{0x363,0x36F,0xE6},
    {0x483,0x487,0xE6},{0x591,0x591,0xDC},{0x592,0x595,0xE6},{0x596,0x596,0xDC},{0x597,0x599,0xE6},{0x59A,0x59A,0xDE},
    {0x59B,0x59B,0xDC},{0x59C,0x5A1,0xE6},{0x5A2,0x5A7,0xDC},{0x5A8,0x5A9,0xE6},{0x5AA,0x5AA,0xDC},{0x5AB,0x5AC,0xE6},
    {0x5AD,0x5AD,0xDE},{0x5AE,0x5AE,0xE4},{0x5AF,0x5AF,0xE6},{0x5B0,0x5B0,0xA},{0x5B1,0x5B1,0xB},{0x5B2,0x5B2,0xC},
    {0x5B3,0x5B3,0xD},{0x5B4,0x5B4,0xE},{0x5B5,0x5B5,0xF},{0x5B6,0x5B6,0x10},{0x5B7,0x5B7,0x11},{0x5B8,0x5B8,0x12},
    {0x5B9,0x5BA,0x13},{0x5BB,0x5BB,0x14},{0x5BC,0x5BC,0x15},{0x5BD,0x5BD,0x16},{0x5BF,0x5BF,0x17},{0x5C1,0x5C1,0x18},
    {0x5C2,0x5C2,0x19},{0x5C4,0x5C4,0xE6},{0x5C5,0x5C5,0xDC},{0x5C7,0x5C7,0x12},{0x610,0x617,0xE6},{0x618,0x618,0x1E},
    {0x619,0x619,0x1F},{0x61A,0x61A,0x20},{0x64B,0x64B,0x1B},{0x64C,0x64C,0x1C},{0x64D,0x64D,0x1D},{0x64E,0x64E,0x1E},
    {0x64F,0x64F,0x1F},{0x650,0x650,0x20},{0x651,0x651,0x21},{0x652,0x652,0x22},{0x653,0x654,0xE6},{0x655,0x656,0xDC},
    {0x657,0x65B,0xE6},{0x65C,0x65C,0xDC},{0x65D,0x65E,0xE6},{0x65F,0x65F,0xDC},{0x670,0x670,0x23},{0x6D6,0x6DC,0xE6},
    {0x6DF,0x6E2,0xE6},{0x6E3,0x6E3,0xDC},{0x6E4,0x6E4,0xE6},{0x6E7,0x6E8,0xE6},{0x6EA,0x6EA,0xDC},{0x6EB,0x6EC,0xE6},
    {0x6ED,0x6ED,0xDC},{0x711,0x711,0x24},{0x730,0x730,0xE6},{0x731,0x731,0xDC},{0x732,0x733,0xE6},{0x734,0x734,0xDC},
    {0x735,0x736,0xE6},{0x737,0x739,0xDC},{0x73A,0x73A,0xE6},{0x73B,0x73C,0xDC},{0x73D,0x73D,0xE6},{0x73E,0x73E,0xDC},
    {0x73F,0x741,0xE6},{0x742,0x742,0xDC},{0x743,0x743,0xE6},{0x744,0x744,0xDC},{0x745,0x745,0xE6},{0x746,0x746,0xDC},
    {0x747,0x747,0xE6},{0x748,0x748,0xDC},{0x749,0x74A,0xE6},{0x7EB,0x7F1,0xE6},{0x7F2,0x7F2,0xDC},{0x7F3,0x7F3,0xE6},
    {0x7FD,0x7FD,0xDC},{0x816,0x819,0xE6},{0x81B,0x823,0xE6},{0x825,0x827,0xE6},{0x829,0x82D,0xE6},{0x859,0x85B,0xDC},
    {0x898,0x898,0xE6},{0x899,0x89B,0xDC},{0x89C,0x89F,0xE6},{0x8CA,0x8CE,0xE6},{0x8CF,0x8D3,0xDC},{0x8D4,0x8E1,0xE6},
    {0x8E3,0x8E3,0xDC},{0x8E4,0x8E5,0xE6},{0x8E6,0x8E6,0xDC},{0x8E7,0x8E8,0xE6},{0x8E9,0x8E9,0xDC},{0x8EA,0x8EC,0xE6},
    {0x8ED,0x8EF,0xDC},{0x8F0,0x8F0,0x1B},{0x8F1,0x8F1,0x1C},{0x8F2,0x8F2,0x1D},{0x8F3,0x8F5,0xE6},{0x8F6,0x8F6,0xDC},
    {0x8F7,0x8F8,0xE6},{0x8F9,0x8FA,0xDC},{0x8FB,0x8FF,0xE6},{0x93C,0x93C,7},{0x94D,0x94D,9},{0x951,0x951,0xE6},
    {0x952,0x952,0xDC},{0x953,0x954,0xE6},{0x9BC,0x9BC,7},{0x9CD,0x9CD,9},{0x9FE,0x9FE,0xE6},{0xA3C,0xA3C,7},
    {0xA4D,0xA4D,9},{0xABC,0xABC,7},{0xACD,0xACD,9},{0xB3C,0xB3C,7},{0xB4D,0xB4D,9},{0xBCD,0xBCD,9},{0xC3C,0xC3C,7},
    {0xC4D,0xC4D,9},{0xC55,0xC55,0x54},{0xC56,0xC56,0x5B},{0xCBC,0xCBC,7},{0xCCD,0xCCD,9},{0xD3B,0xD3C,9},
    {0xD4D,0xD4D,9},{0xDCA,0xDCA,9},{0xE38,0xE39,0x67},{0xE3A,0xE3A,9},{0xE48,0xE4B,0x6B},{0xEB8,0xEB9,0x76},
    {0xEBA,0xEBA,9},{0xEC8,0xECB,0x7A},{0xF18,0xF19,0xDC},{0xF35,0xF35,0xDC},{0xF37,0xF37,0xDC},{0xF39,0xF39,0xD8},
    {0xF71,0xF71,0x81},{0xF72,0xF72,0x82},{0xF74,0xF74,0x84},{0xF7A,0xF7D,0x82},{0xF80,0xF80,0x82},{0xF82,0xF83,0xE6},
    {0xF84,0xF84,9},{0xF86,0xF87,0xE6},{0xFC6,0xFC6,0xDC},{0x1037,0x1037,7},{0x1039,0x103A,9},{0x108D,0x108D,0xDC},
    {0x135D,0x135F,0xE6},{0x1714,0x1715,9},{0x1734,0x1734,9},{0x17D2,0x17D2,9},{0x17DD,0x17DD,0xE6},{0x18A9,0x18A9,0xE4},
    {0x1939,0x1939,0xDE},{0x193A,0x193A,0xE6},{0x193B,0x193B,0xDC},{0x1A17,0x1A17,0xE6},{0x1A18,0x1A18,0xDC},
    {0x1A60,0x1A60,9},{0x1A75,0x1A7C,0xE6},{0x1A7F,0x1A7F,0xDC},{0x1AB0,0x1AB4,0xE6},{0x1AB5,0x1ABA,0xDC},
    {0x1ABB,0x1ABC,0xE6},{0x1ABD,0x1ABD,0xDC},{0x1ABF,0x1AC0,0xDC},{0x1AC1,0x1AC2,0xE6},{0x1AC3,0x1AC4,0xDC},
    {0x1AC5,0x1AC9,0xE6},{0x1ACA,0x1ACA,0xDC},{0x1ACB,0x1ACE,0xE6},{0x1B34,0x1B34,7},{0x1B44,0x1B44,9},
    {0x1B6B,0x1B6B,0xE6},{0x1B6C,0x1B6C,0xDC},{0x1B6D,0x1B73,0xE6},{0x1BAA,0x1BAB,9},{0x1BE6,0x1BE6,7},{0x1BF2,0x1BF3,9},
    {0x1C37,0x1C37,7},{0x1CD0,0x1CD2,0xE6},{0x1CD4,0x1CD4,1},{0x1CD5,0x1CD9,0xDC},{0x1CDA,0x1CDB,0xE6},
    {0x1CDC,0x1CDF,0xDC},{0x1CE0,0x1CE0,0xE6},{0x1CE2,0x1CE8,1},{0x1CED,0x1CED,0xDC},{0x1CF4,0x1CF4,0xE6},
    {0x1CF8,0x1CF9,0xE6},{0x1DC0,0x1DC1,0xE6},{0x1DC2,0x1DC2,0xDC},{0x1DC3,0x1DC9,0xE6},{0x1DCA,0x1DCA,0xDC},
    {0x1DCB,0x1DCC,0xE6},{0x1DCD,0x1DCD,0xEA},{0x1DCE,0x1DCE,0xD6},{0x1DCF,0x1DCF,0xDC},{0x1DD0,0x1DD0,0xCA},
    {0x1DD1,0x1DF5,0xE6},{0x1DF6,0x1DF6,0xE8},{0x1DF7,0x1DF8,0xE4},{0x1DF9,0x1DF9,0xDC},{0x1DFA,0x1DFA,0xDA},
    {0x1DFB,0x1DFB,0xE6},{0x1DFC,0x1DFC,0xE9},{0x1DFD,0x1DFD,0xDC},{0x1DFE,0x1DFE,0xE6},{0x1DFF,0x1DFF,0xDC},
    {0x20D0,0x20D1,0xE6},{0x20D2,0x20D3,1},{0x20D4,0x20D7,0xE6},{0x20D8,0x20DA,1},{0x20DB,0x20DC,0xE6},
    {0x20E1,0x20E1,0xE6},{0x20E5,0x20E6,1},{0x20E7,0x20E7,0xE6},{0x20E8,0x20E8,0xDC},{0x20E9,0x20E9,0xE6},
    {0x20EA,0x20EB,1},{0x20EC,0x20EF,0xDC},{0x20F0,0x20F0,0xE6},{0x2CEF,0x2CF1,0xE6},{0x2D7F,0x2D7F,9},
    {0x2DE0,0x2DFF,0xE6},{0x302A,0x302A,0xDA},{0x302B,0x302B,0xE4},{0x302C,0x302C,0xE8},{0x302D,0x302D,0xDE},
    {0x302E,0x302F,0xE0},{0x3099,0x309A,8},{0xA66F,0xA66F,0xE6},{0xA674,0xA67D,0xE6},{0xA69E,0xA69F,0xE6},
    {0xA6F0,0xA6F1,0xE6},{0xA806,0xA806,9},{0xA82C,0xA82C,9},{0xA8C4,0xA8C4,9},{0xA8E0,0xA8F1,0xE6},{0xA92B,0xA92D,0xDC},
    {0xA953,0xA953,9},{0xA9B3,0xA9B3,7},{0xA9C0,0xA9C0,9},{0xAAB0,0xAAB0,0xE6},{0xAAB2,0xAAB3,0xE6},{0xAAB4,0xAAB4,0xDC},
    {0xAAB7,0xAAB8,0xE6},{0xAABE,0xAABF,0xE6},{0xAAC1,0xAAC1,0xE6},{0xAAF6,0xAAF6,9},{0xABED,0xABED,9},
    {0xFB1E,0xFB1E,0x1A},{0xFE20,0xFE26,0xE6},{0xFE27,0xFE2D,0xDC},{0xFE2E,0xFE2F,0xE6},{0x101FD,0x101FD,0xDC},
    {0x102E0,0x102E0,0xDC},{0x10376,0x1037A,0xE6},{0x10A0D,0x10A0D,0xDC},{0x10A0F,0x10A0F,0xE6},{0x10A38,0x10A38,0xE6},
    {0x10A39,0x10A39,1},{0x10A3A,0x10A3A,0xDC},{0x10A3F,0x10A3F,9},{0x10AE5,0x10AE5,0xE6},{0x10AE6,0x10AE6,0xDC},
    {0x10D24,0x10D27,0xE6},{0x10EAB,0x10EAC,0xE6},{0x10EFD,0x10EFF,0xDC},{0x10F46,0x10F47,0xDC},{0x10F48,0x10F4A,0xE6},
    {0x10F4B,0x10F4B,0xDC},{0x10F4C,0x10F4C,0xE6},{0x10F4D,0x10F50,0xDC},{0x10F82,0x10F82,0xE6},{0x10F83,0x10F83,0xDC},
    {0x10F84,0x10F84,0xE6},{0x10F85,0x10F85,0xDC},{0x11046,0x11046,9},{0x11070,0x11070,9},{0x1107F,0x1107F,9},
    {0x110B9,0x110B9,9},{0x110BA,0x110BA,7},{0x11100,0x11102,0xE6},{0x11133,0x11134,9},{0x11173,0x11173,7},
    {0x111C0,0x111C0,9},{0x111CA,0x111CA,7},{0x11235,0x11235,9},{0x11236,0x11236,7},{0x112E9,0x112E9,7},
    {0x112EA,0x112EA,9},{0x1133B,0x1133C,7},{0x1134D,0x1134D,9},{0x11366,0x1136C,0xE6},{0x11370,0x11374,0xE6},
    {0x11442,0x11442,9},{0x11446,0x11446,7},{0x1145E,0x1145E,0xE6},{0x114C2,0x114C2,9},{0x114C3,0x114C3,7},
    {0x115BF,0x115BF,9},{0x115C0,0x115C0,7},{0x1163F,0x1163F,9},{0x116B6,0x116B6,9},{0x116B7,0x116B7,7},
    {0x1172B,0x1172B,9},{0x11839,0x11839,9},{0x1183A,0x1183A,7},{0x1193D,0x1193E,9},{0x11943,0x11943,7},
    {0x119E0,0x119E0,9},{0x11A34,0x11A34,9},{0x11A47,0x11A47,9},{0x11A99,0x11A99,9},{0x11C3F,0x11C3F,9},
    {0x11D42,0x11D42,7},{0x11D44,0x11D45,9},{0x11D97,0x11D97,9},{0x11F41,0x11F42,9},{0x16AF0,0x16AF4,1},
    {0x16B30,0x16B36,0xE6},{0x16FF0,0x16FF1,6},{0x1BC9E,0x1BC9E,1},{0x1D165,0x1D166,0xD8},{0x1D167,0x1D169,1},
    {0x1D16D,0x1D16D,0xE2},{0x1D16E,0x1D172,0xD8},{0x1D17B,0x1D182,0xDC},{0x1D185,0x1D189,0xE6},{0x1D18A,0x1D18B,0xDC},
    {0x1D1AA,0x1D1AD,0xE6},{0x1D242,0x1D244,0xE6},{0x1E000,0x1E006,0xE6},{0x1E008,0x1E018,0xE6},{0x1E01B,0x1E021,0xE6},
    {0x1E023,0x1E024,0xE6},{0x1E026,0x1E02A,0xE6},{0x1E08F,0x1E08F,0xE6},{0x1E130,0x1E136,0xE6},{0x1E2AE,0x1E2AE,0xE6},
    {0x1E2EC,0x1E2EF,0xE6},{0x1E4EC,0x1E4ED,0xE8},{0x1E4EE,0x1E4EE,0xDC},{0x1E4EF,0x1E4EF,0xE6},{0x1E8D0,0x1E8D6,0xDC},
    {0x1E944,0x1E949,0xE6},{0x1E94A,0x1E94A,7},
};

/// Canonical decompositions as the database has them, one step; second is 0 for a single one. Hangul is not among them.
struct Decomposition {
  std::uint32_t composed, first, second;
};
inline constexpr Decomposition decompositions[] = {
    {0xC0,0x41,0x300},{0xC1,0x41,0x301},{0xC2,0x41,0x302},{0xC3,0x41,0x303},{0xC4,0x41,0x308},{0xC5,0x41,0x30A},
    {0xC7,0x43,0x327},{0xC8,0x45,0x300},{0xC9,0x45,0x301},{0xCA,0x45,0x302},{0xCB,0x45,0x308},{0xCC,0x49,0x300},
    {0xCD,0x49,0x301},{0xCE,0x49,0x302},{0xCF,0x49,0x308},{0xD1,0x4E,0x303},{0xD2,0x4F,0x300},{0xD3,0x4F,0x301},
    {0xD4,0x4F,0x302},{0xD5,0x4F,0x303},{0xD6,0x4F,0x308},{0xD9,0x55,0x300},{0xDA,0x55,0x301},{0xDB,0x55,0x302},
    {0xDC,0x55,0x308},{0xDD,0x59,0x301},{0xE0,0x61,0x300},{0xE1,0x61,0x301},{0xE2,0x61,0x302},{0xE3,0x61,0x303},
    {0xE4,0x61,0x308},{0xE5,0x61,0x30A},{0xE7,0x63,0x327},{0xE8,0x65,0x300},{0xE9,0x65,0x301},{0xEA,0x65,0x302},
    {0xEB,0x65,0x308},{0xEC,0x69,0x300},{0xED,0x69,0x301},{0xEE,0x69,0x302},{0xEF,0x69,0x308},{0xF1,0x6E,0x303},
    {0xF2,0x6F,0x300},{0xF3,0x6F,0x301},{0xF4,0x6F,0x302},{0xF5,0x6F,0x303},{0xF6,0x6F,0x308},{0xF9,0x75,0x300},
    {0xFA,0x75,0x301},{0xFB,0x75,0x302},{0xFC,0x75,0x308},{0xFD,0x79,0x301},{0xFF,0x79,0x308},{0x100,0x41,0x304},
    {0x101,0x61,0x304},{0x102,0x41,0x306},{0x103,0x61,0x306},{0x104,0x41,0x328},{0x105,0x61,0x328},{0x106,0x43,0x301},
    {0x107,0x63,0x301},{0x108,0x43,0x302},{0x109,0x63,0x302},{0x10A,0x43,0x307},{0x10B,0x63,0x307},{0x10C,0x43,0x30C},
    {0x10D,0x63,0x30C},{0x10E,0x44,0x30C},{0x10F,0x64,0x30C},{0x112,0x45,0x304},{0x113,0x65,0x304},{0x114,0x45,0x306},
    {0x115,0x65,0x306},{0x116,0x45,0x307},{0x117,0x65,0x307},{0x118,0x45,0x328},{0x119,0x65,0x328},{0x11A,0x45,0x30C},
    {0x11B,0x65,0x30C},{0x11C,0x47,0x302},{0x11D,0x67,0x302},{0x11E,0x47,0x306},{0x11F,0x67,0x306},{0x120,0x47,0x307},
    {0x121,0x67,0x307},{0x122,0x47,0x327},{0x123,0x67,0x327},{0x124,0x48,0x302},{0x125,0x68,0x302},{0x128,0x49,0x303},
    {0x129,0x69,0x303},{0x12A,0x49,0x304},{0x12B,0x69,0x304},{0x12C,0x49,0x306},{0x12D,0x69,0x306},{0x12E,0x49,0x328},
    {0x12F,0x69,0x328},{0x130,0x49,0x307},{0x134,0x4A,0x302},{0x135,0x6A,0x302},{0x136,0x4B,0x327},{0x137,0x6B,0x327},
    {0x139,0x4C,0x301},{0x13A,0x6C,0x301},{0x13B,0x4C,0x327},{0x13C,0x6C,0x327},{0x13D,0x4C,0x30C},{0x13E,0x6C,0x30C},
    {0x143,0x4E,0x301},{0x144,0x6E,0x301},{0x145,0x4E,0x327},{0x146,0x6E,0x327},{0x147,0x4E,0x30C},{0x148,0x6E,0x30C},
    {0x14C,0x4F,0x304},{0x14D,0x6F,0x304},{0x14E,0x4F,0x306},{0x14F,0x6F,0x306},{0x150,0x4F,0x30B},{0x151,0x6F,0x30B},
    {0x154,0x52,0x301},{0x155,0x72,0x301},{0x156,0x52,0x327},{0x157,0x72,0x327},{0x158,0x52,0x30C},{0x159,0x72,0x30C},
    {0x15A,0x53,0x301},{0x15B,0x73,0x301},{0x15C,0x53,0x302},{0x15D,0x73,0x302},{0x15E,0x53,0x327},{0x15F,0x73,0x327},
    {0x160,0x53,0x30C},{0x161,0x73,0x30C},{0x162,0x54,0x327},{0x163,0x74,0x327},{0x164,0x54,0x30C},{0x165,0x74,0x30C},
    {0x168,0x55,0x303},{0x169,0x75,0x303},{0x16A,0x55,0x304},{0x16B,0x75,0x304},{0x16C,0x55,0x306},{0x16D,0x75,0x306},
    {0x16E,0x55,0x30A},{0x16F,0x75,0x30A},{0x170,0x55,0x30B},{0x171,0x75,0x30B},{0x172,0x55,0x328},{0x173,0x75,0x328},
    {0x174,0x57,0x302},{0x175,0x77,0x302},{0x176,0x59,0x302},{0x177,0x79,0x302},{0x178,0x59,0x308},{0x179,0x5A,0x301},
    {0x17A,0x7A,0x301},{0x17B,0x5A,0x307},{0x17C,0x7A,0x307},{0x17D,0x5A,0x30C},{0x17E,0x7A,0x30C},{0x1A0,0x4F,0x31B},
    {0x1A1,0x6F,0x31B},{0x1AF,0x55,0x31B},{0x1B0,0x75,0x31B},{0x1CD,0x41,0x30C},{0x1CE,0x61,0x30C},{0x1CF,0x49,0x30C},
    {0x1D0,0x69,0x30C},{0x1D1,0x4F,0x30C},{0x1D2,0x6F,0x30C},{0x1D3,0x55,0x30C},{0x1D4,0x75,0x30C},{0x1D5,0xDC,0x304},
    {0x1D6,0xFC,0x304},{0x1D7,0xDC,0x301},{0x1D8,0xFC,0x301},{0x1D9,0xDC,0x30C},{0x1DA,0xFC,0x30C},{0x1DB,0xDC,0x300},
    {0x1DC,0xFC,0x300},{0x1DE,0xC4,0x304},{0x1DF,0xE4,0x304},{0x1E0,0x226,0x304},{0x1E1,0x227,0x304},{0x1E2,0xC6,0x304},
    {0x1E3,0xE6,0x304},{0x1E6,0x47,0x30C},{0x1E7,0x67,0x30C},{0x1E8,0x4B,0x30C},{0x1E9,0x6B,0x30C},{0x1EA,0x4F,0x328},
    {0x1EB,0x6F,0x328},{0x1EC,0x1EA,0x304},{0x1ED,0x1EB,0x304},{0x1EE,0x1B7,0x30C},{0x1EF,0x292,0x30C},
    {0x1F0,0x6A,0x30C},{0x1F4,0x47,0x301},{0x1F5,0x67,0x301},{0x1F8,0x4E,0x300},{0x1F9,0x6E,0x300},{0x1FA,0xC5,0x301},
    {0x1FB,0xE5,0x301},{0x1FC,0xC6,0x301},{0x1FD,0xE6,0x301},{0x1FE,0xD8,0x301},{0x1FF,0xF8,0x301},{0x200,0x41,0x30F},
    {0x201,0x61,0x30F},{0x202,0x41,0x311},{0x203,0x61,0x311},{0x204,0x45,0x30F},{0x205,0x65,0x30F},{0x206,0x45,0x311},
    {0x207,0x65,0x311},{0x208,0x49,0x30F},{0x209,0x69,0x30F},{0x20A,0x49,0x311},{0x20B,0x69,0x311},{0x20C,0x4F,0x30F},
    {0x20D,0x6F,0x30F},{0x20E,0x4F,0x311},{0x20F,0x6F,0x311},{0x210,0x52,0x30F},{0x211,0x72,0x30F},{0x212,0x52,0x311},
    {0x213,0x72,0x311},{0x214,0x55,0x30F},{0x215,0x75,0x30F},{0x216,0x55,0x311},{0x217,0x75,0x311},{0x218,0x53,0x326},
    {0x219,0x73,0x326},{0x21A,0x54,0x326},{0x21B,0x74,0x326},{0x21E,0x48,0x30C},{0x21F,0x68,0x30C},{0x226,0x41,0x307},
    {0x227,0x61,0x307},{0x228,0x45,0x327},{0x229,0x65,0x327},{0x22A,0xD6,0x304},{0x22B,0xF6,0x304},{0x22C,0xD5,0x304},
    {0x22D,0xF5,0x304},{0x22E,0x4F,0x307},{0x22F,0x6F,0x307},{0x230,0x22E,0x304},{0x231,0x22F,0x304},{0x232,0x59,0x304},
    {0x233,0x79,0x304},{0x340,0x300,0},{0x341,0x301,0},{0x343,0x313,0},{0x344,0x308,0x301},{0x374,0x2B9,0},
    {0x37E,0x3B,0},{0x385,0xA8,0x301},{0x386,0x391,0x301},{0x387,0xB7,0},{0x388,0x395,0x301},{0x389,0x397,0x301},
    {0x38A,0x399,0x301},{0x38C,0x39F,0x301},{0x38E,0x3A5,0x301},{0x38F,0x3A9,0x301},{0x390,0x3CA,0x301},
    {0x3AA,0x399,0x308},{0x3AB,0x3A5,0x308},{0x3AC,0x3B1,0x301},{0x3AD,0x3B5,0x301},{0x3AE,0x3B7,0x301},
    {0x3AF,0x3B9,0x301},{0x3B0,0x3CB,0x301},{0x3CA,0x3B9,0x308},{0x3CB,0x3C5,0x308},{0x3CC,0x3BF,0x301},
    {0x3CD,0x3C5,0x301},{0x3CE,0x3C9,0x301},{0x3D3,0x3D2,0x301},{0x3D4,0x3D2,0x308},{0x400,0x415,0x300},
    {0x401,0x415,0x308},{0x403,0x413,0x301},{0x407,0x406,0x308},{0x40C,0x41A,0x301},{0x40D,0x418,0x300},
    {0x40E,0x423,0x306},{0x419,0x418,0x306},{0x439,0x438,0x306},{0x450,0x435,0x300},{0x451,0x435,0x308},
    {0x453,0x433,0x301},{0x457,0x456,0x308},{0x45C,0x43A,0x301},{0x45D,0x438,0x300},{0x45E,0x443,0x306},
    {0x476,0x474,0x30F},{0x477,0x475,0x30F},{0x4C1,0x416,0x306},{0x4C2,0x436,0x306},{0x4D0,0x410,0x306},
    {0x4D1,0x430,0x306},{0x4D2,0x410,0x308},{0x4D3,0x430,0x308},{0x4D6,0x415,0x306},{0x4D7,0x435,0x306},
    {0x4DA,0x4D8,0x308},{0x4DB,0x4D9,0x308},{0x4DC,0x416,0x308},{0x4DD,0x436,0x308},{0x4DE,0x417,0x308},
    {0x4DF,0x437,0x308},{0x4E2,0x418,0x304},{0x4E3,0x438,0x304},{0x4E4,0x418,0x308},{0x4E5,0x438,0x308},
    {0x4E6,0x41E,0x308},{0x4E7,0x43E,0x308},{0x4EA,0x4E8,0x308},{0x4EB,0x4E9,0x308},{0x4EC,0x42D,0x308},
    {0x4ED,0x44D,0x308},{0x4EE,0x423,0x304},{0x4EF,0x443,0x304},{0x4F0,0x423,0x308},{0x4F1,0x443,0x308},
    {0x4F2,0x423,0x30B},{0x4F3,0x443,0x30B},{0x4F4,0x427,0x308},{0x4F5,0x447,0x308},{0x4F8,0x42B,0x308},
    {0x4F9,0x44B,0x308},{0x622,0x627,0x653},{0x623,0x627,0x654},{0x624,0x648,0x654},{0x625,0x627,0x655},
    {0x626,0x64A,0x654},{0x6C0,0x6D5,0x654},{0x6C2,0x6C1,0x654},{0x6D3,0x6D2,0x654},{0x929,0x928,0x93C},
    {0x931,0x930,0x93C},{0x934,0x933,0x93C},{0x958,0x915,0x93C},{0x959,0x916,0x93C},{0x95A,0x917,0x93C},
    {0x95B,0x91C,0x93C},{0x95C,0x921,0x93C},{0x95D,0x922,0x93C},{0x95E,0x92B,0x93C},{0x95F,0x92F,0x93C},
    {0x9CB,0x9C7,0x9BE},{0x9CC,0x9C7,0x9D7},{0x9DC,0x9A1,0x9BC},{0x9DD,0x9A2,0x9BC},{0x9DF,0x9AF,0x9BC},
    {0xA33,0xA32,0xA3C},{0xA36,0xA38,0xA3C},{0xA59,0xA16,0xA3C},{0xA5A,0xA17,0xA3C},{0xA5B,0xA1C,0xA3C},
    {0xA5E,0xA2B,0xA3C},{0xB48,0xB47,0xB56},{0xB4B,0xB47,0xB3E},{0xB4C,0xB47,0xB57},{0xB5C,0xB21,0xB3C},
    {0xB5D,0xB22,0xB3C},{0xB94,0xB92,0xBD7},{0xBCA,0xBC6,0xBBE},{0xBCB,0xBC7,0xBBE},{0xBCC,0xBC6,0xBD7},
    {0xC48,0xC46,0xC56},{0xCC0,0xCBF,0xCD5},{0xCC7,0xCC6,0xCD5},{0xCC8,0xCC6,0xCD6},{0xCCA,0xCC6,0xCC2},
    {0xCCB,0xCCA,0xCD5},{0xD4A,0xD46,0xD3E},{0xD4B,0xD47,0xD3E},{0xD4C,0xD46,0xD57},{0xDDA,0xDD9,0xDCA},
    {0xDDC,0xDD9,0xDCF},{0xDDD,0xDDC,0xDCA},{0xDDE,0xDD9,0xDDF},{0xF43,0xF42,0xFB7},{0xF4D,0xF4C,0xFB7},
    {0xF52,0xF51,0xFB7},{0xF57,0xF56,0xFB7},{0xF5C,0xF5B,0xFB7},{0xF69,0xF40,0xFB5},{0xF73,0xF71,0xF72},
    {0xF75,0xF71,0xF74},{0xF76,0xFB2,0xF80},{0xF78,0xFB3,0xF80},{0xF81,0xF71,0xF80},{0xF93,0xF92,0xFB7},
    {0xF9D,0xF9C,0xFB7},{0xFA2,0xFA1,0xFB7},{0xFA7,0xFA6,0xFB7},{0xFAC,0xFAB,0xFB7},{0xFB9,0xF90,0xFB5},
    {0x1026,0x1025,0x102E},{0x1B06,0x1B05,0x1B35},{0x1B08,0x1B07,0x1B35},{0x1B0A,0x1B09,0x1B35},{0x1B0C,0x1B0B,0x1B35},
    {0x1B0E,0x1B0D,0x1B35},{0x1B12,0x1B11,0x1B35},{0x1B3B,0x1B3A,0x1B35},{0x1B3D,0x1B3C,0x1B35},{0x1B40,0x1B3E,0x1B35},
    {0x1B41,0x1B3F,0x1B35},{0x1B43,0x1B42,0x1B35},{0x1E00,0x41,0x325},{0x1E01,0x61,0x325},{0x1E02,0x42,0x307},
    {0x1E03,0x62,0x307},{0x1E04,0x42,0x323},{0x1E05,0x62,0x323},{0x1E06,0x42,0x331},{0x1E07,0x62,0x331},
    {0x1E08,0xC7,0x301},{0x1E09,0xE7,0x301},{0x1E0A,0x44,0x307},{0x1E0B,0x64,0x307},{0x1E0C,0x44,0x323},
    {0x1E0D,0x64,0x323},{0x1E0E,0x44,0x331},{0x1E0F,0x64,0x331},{0x1E10,0x44,0x327},{0x1E11,0x64,0x327},
    {0x1E12,0x44,0x32D},{0x1E13,0x64,0x32D},{0x1E14,0x112,0x300},{0x1E15,0x113,0x300},{0x1E16,0x112,0x301},
    {0x1E17,0x113,0x301},{0x1E18,0x45,0x32D},{0x1E19,0x65,0x32D},{0x1E1A,0x45,0x330},{0x1E1B,0x65,0x330},
    {0x1E1C,0x228,0x306},{0x1E1D,0x229,0x306},{0x1E1E,0x46,0x307},{0x1E1F,0x66,0x307},{0x1E20,0x47,0x304},
    {0x1E21,0x67,0x304},{0x1E22,0x48,0x307},{0x1E23,0x68,0x307},{0x1E24,0x48,0x323},{0x1E25,0x68,0x323},
    {0x1E26,0x48,0x308},{0x1E27,0x68,0x308},{0x1E28,0x48,0x327},{0x1E29,0x68,0x327},{0x1E2A,0x48,0x32E},
    {0x1E2B,0x68,0x32E},{0x1E2C,0x49,0x330},{0x1E2D,0x69,0x330},{0x1E2E,0xCF,0x301},{0x1E2F,0xEF,0x301},
    {0x1E30,0x4B,0x301},{0x1E31,0x6B,0x301},{0x1E32,0x4B,0x323},{0x1E33,0x6B,0x323},{0x1E34,0x4B,0x331},
    {0x1E35,0x6B,0x331},{0x1E36,0x4C,0x323},{0x1E37,0x6C,0x323},{0x1E38,0x1E36,0x304},{0x1E39,0x1E37,0x304},
    {0x1E3A,0x4C,0x331},{0x1E3B,0x6C,0x331},{0x1E3C,0x4C,0x32D},{0x1E3D,0x6C,0x32D},{0x1E3E,0x4D,0x301},
    {0x1E3F,0x6D,0x301},{0x1E40,0x4D,0x307},{0x1E41,0x6D,0x307},{0x1E42,0x4D,0x323},{0x1E43,0x6D,0x323},
    {0x1E44,0x4E,0x307},{0x1E45,0x6E,0x307},{0x1E46,0x4E,0x323},{0x1E47,0x6E,0x323},{0x1E48,0x4E,0x331},
    {0x1E49,0x6E,0x331},{0x1E4A,0x4E,0x32D},{0x1E4B,0x6E,0x32D},{0x1E4C,0xD5,0x301},{0x1E4D,0xF5,0x301},
    {0x1E4E,0xD5,0x308},{0x1E4F,0xF5,0x308},{0x1E50,0x14C,0x300},{0x1E51,0x14D,0x300},{0x1E52,0x14C,0x301},
    {0x1E53,0x14D,0x301},{0x1E54,0x50,0x301},{0x1E55,0x70,0x301},{0x1E56,0x50,0x307},{0x1E57,0x70,0x307},
    {0x1E58,0x52,0x307},{0x1E59,0x72,0x307},{0x1E5A,0x52,0x323},{0x1E5B,0x72,0x323},{0x1E5C,0x1E5A,0x304},
    {0x1E5D,0x1E5B,0x304},{0x1E5E,0x52,0x331},{0x1E5F,0x72,0x331},{0x1E60,0x53,0x307},{0x1E61,0x73,0x307},
    {0x1E62,0x53,0x323},{0x1E63,0x73,0x323},{0x1E64,0x15A,0x307},{0x1E65,0x15B,0x307},{0x1E66,0x160,0x307},
    {0x1E67,0x161,0x307},{0x1E68,0x1E62,0x307},{0x1E69,0x1E63,0x307},{0x1E6A,0x54,0x307},{0x1E6B,0x74,0x307},
    {0x1E6C,0x54,0x323},{0x1E6D,0x74,0x323},{0x1E6E,0x54,0x331},{0x1E6F,0x74,0x331},{0x1E70,0x54,0x32D},
    {0x1E71,0x74,0x32D},{0x1E72,0x55,0x324},{0x1E73,0x75,0x324},{0x1E74,0x55,0x330},{0x1E75,0x75,0x330},
    {0x1E76,0x55,0x32D},{0x1E77,0x75,0x32D},{0x1E78,0x168,0x301},{0x1E79,0x169,0x301},{0x1E7A,0x16A,0x308},
    {0x1E7B,0x16B,0x308},{0x1E7C,0x56,0x303},{0x1E7D,0x76,0x303},{0x1E7E,0x56,0x323},{0x1E7F,0x76,0x323},
    {0x1E80,0x57,0x300},{0x1E81,0x77,0x300},{0x1E82,0x57,0x301},{0x1E83,0x77,0x301},{0x1E84,0x57,0x308},
    {0x1E85,0x77,0x308},{0x1E86,0x57,0x307},{0x1E87,0x77,0x307},{0x1E88,0x57,0x323},{0x1E89,0x77,0x323},
    {0x1E8A,0x58,0x307},{0x1E8B,0x78,0x307},{0x1E8C,0x58,0x308},{0x1E8D,0x78,0x308},{0x1E8E,0x59,0x307},
    {0x1E8F,0x79,0x307},{0x1E90,0x5A,0x302},{0x1E91,0x7A,0x302},{0x1E92,0x5A,0x323},{0x1E93,0x7A,0x323},
    {0x1E94,0x5A,0x331},{0x1E95,0x7A,0x331},{0x1E96,0x68,0x331},{0x1E97,0x74,0x308},{0x1E98,0x77,0x30A},
    {0x1E99,0x79,0x30A},{0x1E9B,0x17F,0x307},{0x1EA0,0x41,0x323},{0x1EA1,0x61,0x323},{0x1EA2,0x41,0x309},
    {0x1EA3,0x61,0x309},{0x1EA4,0xC2,0x301},{0x1EA5,0xE2,0x301},{0x1EA6,0xC2,0x300},{0x1EA7,0xE2,0x300},
    {0x1EA8,0xC2,0x309},{0x1EA9,0xE2,0x309},{0x1EAA,0xC2,0x303},{0x1EAB,0xE2,0x303},{0x1EAC,0x1EA0,0x302},
    {0x1EAD,0x1EA1,0x302},{0x1EAE,0x102,0x301},{0x1EAF,0x103,0x301},{0x1EB0,0x102,0x300},{0x1EB1,0x103,0x300},
    {0x1EB2,0x102,0x309},{0x1EB3,0x103,0x309},{0x1EB4,0x102,0x303},{0x1EB5,0x103,0x303},{0x1EB6,0x1EA0,0x306},
    {0x1EB7,0x1EA1,0x306},{0x1EB8,0x45,0x323},{0x1EB9,0x65,0x323},{0x1EBA,0x45,0x309},{0x1EBB,0x65,0x309},
    {0x1EBC,0x45,0x303},{0x1EBD,0x65,0x303},{0x1EBE,0xCA,0x301},{0x1EBF,0xEA,0x301},{0x1EC0,0xCA,0x300},
    {0x1EC1,0xEA,0x300},{0x1EC2,0xCA,0x309},{0x1EC3,0xEA,0x309},{0x1EC4,0xCA,0x303},{0x1EC5,0xEA,0x303},
    {0x1EC6,0x1EB8,0x302},{0x1EC7,0x1EB9,0x302},{0x1EC8,0x49,0x309},{0x1EC9,0x69,0x309},{0x1ECA,0x49,0x323},
    {0x1ECB,0x69,0x323},{0x1ECC,0x4F,0x323},{0x1ECD,0x6F,0x323},{0x1ECE,0x4F,0x309},{0x1ECF,0x6F,0x309},
    {0x1ED0,0xD4,0x301},{0x1ED1,0xF4,0x301},{0x1ED2,0xD4,0x300},{0x1ED3,0xF4,0x300},{0x1ED4,0xD4,0x309},
    {0x1ED5,0xF4,0x309},{0x1ED6,0xD4,0x303},{0x1ED7,0xF4,0x303},{0x1ED8,0x1ECC,0x302},{0x1ED9,0x1ECD,0x302},
    {0x1EDA,0x1A0,0x301},{0x1EDB,0x1A1,0x301},{0x1EDC,0x1A0,0x300},{0x1EDD,0x1A1,0x300},{0x1EDE,0x1A0,0x309},
    {0x1EDF,0x1A1,0x309},{0x1EE0,0x1A0,0x303},{0x1EE1,0x1A1,0x303},{0x1EE2,0x1A0,0x323},{0x1EE3,0x1A1,0x323},
    {0x1EE4,0x55,0x323},{0x1EE5,0x75,0x323},{0x1EE6,0x55,0x309},{0x1EE7,0x75,0x309},{0x1EE8,0x1AF,0x301},
    {0x1EE9,0x1B0,0x301},{0x1EEA,0x1AF,0x300},{0x1EEB,0x1B0,0x300},{0x1EEC,0x1AF,0x309},{0x1EED,0x1B0,0x309},
    {0x1EEE,0x1AF,0x303},{0x1EEF,0x1B0,0x303},{0x1EF0,0x1AF,0x323},{0x1EF1,0x1B0,0x323},{0x1EF2,0x59,0x300},
    {0x1EF3,0x79,0x300},{0x1EF4,0x59,0x323},{0x1EF5,0x79,0x323},{0x1EF6,0x59,0x309},{0x1EF7,0x79,0x309},
    {0x1EF8,0x59,0x303},{0x1EF9,0x79,0x303},{0x1F00,0x3B1,0x313},{0x1F01,0x3B1,0x314},{0x1F02,0x1F00,0x300},
    {0x1F03,0x1F01,0x300},{0x1F04,0x1F00,0x301},{0x1F05,0x1F01,0x301},{0x1F06,0x1F00,0x342},{0x1F07,0x1F01,0x342},
    {0x1F08,0x391,0x313},{0x1F09,0x391,0x314},{0x1F0A,0x1F08,0x300},{0x1F0B,0x1F09,0x300},{0x1F0C,0x1F08,0x301},
    {0x1F0D,0x1F09,0x301},{0x1F0E,0x1F08,0x342},{0x1F0F,0x1F09,0x342},{0x1F10,0x3B5,0x313},{0x1F11,0x3B5,0x314},
    {0x1F12,0x1F10,0x300},{0x1F13,0x1F11,0x300},{0x1F14,0x1F10,0x301},{0x1F15,0x1F11,0x301},{0x1F18,0x395,0x313},
    {0x1F19,0x395,0x314},{0x1F1A,0x1F18,0x300},{0x1F1B,0x1F19,0x300},{0x1F1C,0x1F18,0x301},{0x1F1D,0x1F19,0x301},
    {0x1F20,0x3B7,0x313},{0x1F21,0x3B7,0x314},{0x1F22,0x1F20,0x300},{0x1F23,0x1F21,0x300},{0x1F24,0x1F20,0x301},
    {0x1F25,0x1F21,0x301},{0x1F26,0x1F20,0x342},{0x1F27,0x1F21,0x342},{0x1F28,0x397,0x313},{0x1F29,0x397,0x314},
    {0x1F2A,0x1F28,0x300},{0x1F2B,0x1F29,0x300},{0x1F2C,0x1F28,0x301},{0x1F2D,0x1F29,0x301},{0x1F2E,0x1F28,0x342},
    {0x1F2F,0x1F29,0x342},{0x1F30,0x3B9,0x313},{0x1F31,0x3B9,0x314},{0x1F32,0x1F30,0x300},{0x1F33,0x1F31,0x300},
    {0x1F34,0x1F30,0x301},{0x1F35,0x1F31,0x301},{0x1F36,0x1F30,0x342},{0x1F37,0x1F31,0x342},{0x1F38,0x399,0x313},
    {0x1F39,0x399,0x314},{0x1F3A,0x1F38,0x300},{0x1F3B,0x1F39,0x300},{0x1F3C,0x1F38,0x301},{0x1F3D,0x1F39,0x301},
    {0x1F3E,0x1F38,0x342},{0x1F3F,0x1F39,0x342},{0x1F40,0x3BF,0x313},{0x1F41,0x3BF,0x314},{0x1F42,0x1F40,0x300},
    {0x1F43,0x1F41,0x300},{0x1F44,0x1F40,0x301},{0x1F45,0x1F41,0x301},{0x1F48,0x39F,0x313},{0x1F49,0x39F,0x314},
    {0x1F4A,0x1F48,0x300},{0x1F4B,0x1F49,0x300},{0x1F4C,0x1F48,0x301},{0x1F4D,0x1F49,0x301},{0x1F50,0x3C5,0x313},
    {0x1F51,0x3C5,0x314},{0x1F52,0x1F50,0x300},{0x1F53,0x1F51,0x300},{0x1F54,0x1F50,0x301},{0x1F55,0x1F51,0x301},
    {0x1F56,0x1F50,0x342},{0x1F57,0x1F51,0x342},{0x1F59,0x3A5,0x314},{0x1F5B,0x1F59,0x300},{0x1F5D,0x1F59,0x301},
    {0x1F5F,0x1F59,0x342},{0x1F60,0x3C9,0x313},{0x1F61,0x3C9,0x314},{0x1F62,0x1F60,0x300},{0x1F63,0x1F61,0x300},
    {0x1F64,0x1F60,0x301},{0x1F65,0x1F61,0x301},{0x1F66,0x1F60,0x342},{0x1F67,0x1F61,0x342},{0x1F68,0x3A9,0x313},
    {0x1F69,0x3A9,0x314},{0x1F6A,0x1F68,0x300},{0x1F6B,0x1F69,0x300},{0x1F6C,0x1F68,0x301},{0x1F6D,0x1F69,0x301},
    {0x1F6E,0x1F68,0x342},{0x1F6F,0x1F69,0x342},{0x1F70,0x3B1,0x300},{0x1F71,0x3AC,0},{0x1F72,0x3B5,0x300},
    {0x1F73,0x3AD,0},{0x1F74,0x3B7,0x300},{0x1F75,0x3AE,0},{0x1F76,0x3B9,0x300},{0x1F77,0x3AF,0},{0x1F78,0x3BF,0x300},
    {0x1F79,0x3CC,0},{0x1F7A,0x3C5,0x300},{0x1F7B,0x3CD,0},{0x1F7C,0x3C9,0x300},{0x1F7D,0x3CE,0},{0x1F80,0x1F00,0x345},
    {0x1F81,0x1F01,0x345},{0x1F82,0x1F02,0x345},{0x1F83,0x1F03,0x345},{0x1F84,0x1F04,0x345},{0x1F85,0x1F05,0x345},
    {0x1F86,0x1F06,0x345},{0x1F87,0x1F07,0x345},{0x1F88,0x1F08,0x345},{0x1F89,0x1F09,0x345},{0x1F8A,0x1F0A,0x345},
    {0x1F8B,0x1F0B,0x345},{0x1F8C,0x1F0C,0x345},{0x1F8D,0x1F0D,0x345},{0x1F8E,0x1F0E,0x345},{0x1F8F,0x1F0F,0x345},
    {0x1F90,0x1F20,0x345},{0x1F91,0x1F21,0x345},{0x1F92,0x1F22,0x345},{0x1F93,0x1F23,0x345},{0x1F94,0x1F24,0x345},
    {0x1F95,0x1F25,0x345},{0x1F96,0x1F26,0x345},{0x1F97,0x1F27,0x345},{0x1F98,0x1F28,0x345},{0x1F99,0x1F29,0x345},
    {0x1F9A,0x1F2A,0x345},{0x1F9B,0x1F2B,0x345},{0x1F9C,0x1F2C,0x345},{0x1F9D,0x1F2D,0x345},{0x1F9E,0x1F2E,0x345},
    {0x1F9F,0x1F2F,0x345},{0x1FA0,0x1F60,0x345},{0x1FA1,0x1F61,0x345},{0x1FA2,0x1F62,0x345},{0x1FA3,0x1F63,0x345},
    {0x1FA4,0x1F64,0x345},{0x1FA5,0x1F65,0x345},{0x1FA6,0x1F66,0x345},{0x1FA7,0x1F67,0x345},{0x1FA8,0x1F68,0x345},
    {0x1FA9,0x1F69,0x345},{0x1FAA,0x1F6A,0x345},{0x1FAB,0x1F6B,0x345},{0x1FAC,0x1F6C,0x345},{0x1FAD,0x1F6D,0x345},
    {0x1FAE,0x1F6E,0x345},{0x1FAF,0x1F6F,0x345},{0x1FB0,0x3B1,0x306},{0x1FB1,0x3B1,0x304},{0x1FB2,0x1F70,0x345},
    {0x1FB3,0x3B1,0x345},{0x1FB4,0x3AC,0x345},{0x1FB6,0x3B1,0x342},{0x1FB7,0x1FB6,0x345},{0x1FB8,0x391,0x306},
    {0x1FB9,0x391,0x304},{0x1FBA,0x391,0x300},{0x1FBB,0x386,0},{0x1FBC,0x391,0x345},{0x1FBE,0x3B9,0},{0x1FC1,0xA8,0x342},
    {0x1FC2,0x1F74,0x345},{0x1FC3,0x3B7,0x345},{0x1FC4,0x3AE,0x345},{0x1FC6,0x3B7,0x342},{0x1FC7,0x1FC6,0x345},
    {0x1FC8,0x395,0x300},{0x1FC9,0x388,0},{0x1FCA,0x397,0x300},{0x1FCB,0x389,0},{0x1FCC,0x397,0x345},
    {0x1FCD,0x1FBF,0x300},{0x1FCE,0x1FBF,0x301},{0x1FCF,0x1FBF,0x342},{0x1FD0,0x3B9,0x306},{0x1FD1,0x3B9,0x304},
    {0x1FD2,0x3CA,0x300},{0x1FD3,0x390,0},{0x1FD6,0x3B9,0x342},{0x1FD7,0x3CA,0x342},{0x1FD8,0x399,0x306},
    {0x1FD9,0x399,0x304},{0x1FDA,0x399,0x300},{0x1FDB,0x38A,0},{0x1FDD,0x1FFE,0x300},{0x1FDE,0x1FFE,0x301},
    {0x1FDF,0x1FFE,0x342},{0x1FE0,0x3C5,0x306},{0x1FE1,0x3C5,0x304},{0x1FE2,0x3CB,0x300},{0x1FE3,0x3B0,0},
    {0x1FE4,0x3C1,0x313},{0x1FE5,0x3C1,0x314},{0x1FE6,0x3C5,0x342},{0x1FE7,0x3CB,0x342},{0x1FE8,0x3A5,0x306},
    {0x1FE9,0x3A5,0x304},{0x1FEA,0x3A5,0x300},{0x1FEB,0x38E,0},{0x1FEC,0x3A1,0x314},{0x1FED,0xA8,0x300},{0x1FEE,0x385,0},
    {0x1FEF,0x60,0},{0x1FF2,0x1F7C,0x345},{0x1FF3,0x3C9,0x345},{0x1FF4,0x3CE,0x345},{0x1FF6,0x3C9,0x342},
    {0x1FF7,0x1FF6,0x345},{0x1FF8,0x39F,0x300},{0x1FF9,0x38C,0},{0x1FFA,0x3A9,0x300},{0x1FFB,0x38F,0},
    {0x1FFC,0x3A9,0x345},{0x1FFD,0xB4,0},{0x2000,0x2002,0},{0x2001,0x2003,0},{0x2126,0x3A9,0},{0x212A,0x4B,0},
    {0x212B,0xC5,0},{0x219A,0x2190,0x338},{0x219B,0x2192,0x338},{0x21AE,0x2194,0x338},{0x21CD,0x21D0,0x338},
    {0x21CE,0x21D4,0x338},{0x21CF,0x21D2,0x338},{0x2204,0x2203,0x338},{0x2209,0x2208,0x338},{0x220C,0x220B,0x338},
    {0x2224,0x2223,0x338},{0x2226,0x2225,0x338},{0x2241,0x223C,0x338},{0x2244,0x2243,0x338},{0x2247,0x2245,0x338},
    {0x2249,0x2248,0x338},{0x2260,0x3D,0x338},{0x2262,0x2261,0x338},{0x226D,0x224D,0x338},{0x226E,0x3C,0x338},
    {0x226F,0x3E,0x338},{0x2270,0x2264,0x338},{0x2271,0x2265,0x338},{0x2274,0x2272,0x338},{0x2275,0x2273,0x338},
    {0x2278,0x2276,0x338},{0x2279,0x2277,0x338},{0x2280,0x227A,0x338},{0x2281,0x227B,0x338},{0x2284,0x2282,0x338},
    {0x2285,0x2283,0x338},{0x2288,0x2286,0x338},{0x2289,0x2287,0x338},{0x22AC,0x22A2,0x338},{0x22AD,0x22A8,0x338},
    {0x22AE,0x22A9,0x338},{0x22AF,0x22AB,0x338},{0x22E0,0x227C,0x338},{0x22E1,0x227D,0x338},{0x22E2,0x2291,0x338},
    {0x22E3,0x2292,0x338},{0x22EA,0x22B2,0x338},{0x22EB,0x22B3,0x338},{0x22EC,0x22B4,0x338},{0x22ED,0x22B5,0x338},
    {0x2329,0x3008,0},{0x232A,0x3009,0},{0x2ADC,0x2ADD,0x338},{0x304C,0x304B,0x3099},{0x304E,0x304D,0x3099},
    {0x3050,0x304F,0x3099},{0x3052,0x3051,0x3099},{0x3054,0x3053,0x3099},{0x3056,0x3055,0x3099},{0x3058,0x3057,0x3099},
    {0x305A,0x3059,0x3099},{0x305C,0x305B,0x3099},{0x305E,0x305D,0x3099},{0x3060,0x305F,0x3099},{0x3062,0x3061,0x3099},
    {0x3065,0x3064,0x3099},{0x3067,0x3066,0x3099},{0x3069,0x3068,0x3099},{0x3070,0x306F,0x3099},{0x3071,0x306F,0x309A},
    {0x3073,0x3072,0x3099},{0x3074,0x3072,0x309A},{0x3076,0x3075,0x3099},{0x3077,0x3075,0x309A},{0x3079,0x3078,0x3099},
    {0x307A,0x3078,0x309A},{0x307C,0x307B,0x3099},{0x307D,0x307B,0x309A},{0x3094,0x3046,0x3099},{0x309E,0x309D,0x3099},
    {0x30AC,0x30AB,0x3099},{0x30AE,0x30AD,0x3099},{0x30B0,0x30AF,0x3099},{0x30B2,0x30B1,0x3099},{0x30B4,0x30B3,0x3099},
    {0x30B6,0x30B5,0x3099},{0x30B8,0x30B7,0x3099},{0x30BA,0x30B9,0x3099},{0x30BC,0x30BB,0x3099},{0x30BE,0x30BD,0x3099},
    {0x30C0,0x30BF,0x3099},{0x30C2,0x30C1,0x3099},{0x30C5,0x30C4,0x3099},{0x30C7,0x30C6,0x3099},{0x30C9,0x30C8,0x3099},
    {0x30D0,0x30CF,0x3099},{0x30D1,0x30CF,0x309A},{0x30D3,0x30D2,0x3099},{0x30D4,0x30D2,0x309A},{0x30D6,0x30D5,0x3099},
    {0x30D7,0x30D5,0x309A},{0x30D9,0x30D8,0x3099},{0x30DA,0x30D8,0x309A},{0x30DC,0x30DB,0x3099},{0x30DD,0x30DB,0x309A},
    {0x30F4,0x30A6,0x3099},{0x30F7,0x30EF,0x3099},{0x30F8,0x30F0,0x3099},{0x30F9,0x30F1,0x3099},{0x30FA,0x30F2,0x3099},
    {0x30FE,0x30FD,0x3099},{0xF900,0x8C48,0},{0xF901,0x66F4,0},{0xF902,0x8ECA,0},{0xF903,0x8CC8,0},{0xF904,0x6ED1,0},
    {0xF905,0x4E32,0},{0xF906,0x53E5,0},{0xF907,0x9F9C,0},{0xF908,0x9F9C,0},{0xF909,0x5951,0},{0xF90A,0x91D1,0},
    {0xF90B,0x5587,0},{0xF90C,0x5948,0},{0xF90D,0x61F6,0},{0xF90E,0x7669,0},{0xF90F,0x7F85,0},{0xF910,0x863F,0},
    {0xF911,0x87BA,0},{0xF912,0x88F8,0},{0xF913,0x908F,0},{0xF914,0x6A02,0},{0xF915,0x6D1B,0},{0xF916,0x70D9,0},
    {0xF917,0x73DE,0},{0xF918,0x843D,0},{0xF919,0x916A,0},{0xF91A,0x99F1,0},{0xF91B,0x4E82,0},{0xF91C,0x5375,0},
    {0xF91D,0x6B04,0},{0xF91E,0x721B,0},{0xF91F,0x862D,0},{0xF920,0x9E1E,0},{0xF921,0x5D50,0},{0xF922,0x6FEB,0},
    {0xF923,0x85CD,0},{0xF924,0x8964,0},{0xF925,0x62C9,0},{0xF926,0x81D8,0},{0xF927,0x881F,0},{0xF928,0x5ECA,0},
    {0xF929,0x6717,0},{0xF92A,0x6D6A,0},{0xF92B,0x72FC,0},{0xF92C,0x90CE,0},{0xF92D,0x4F86,0},{0xF92E,0x51B7,0},
    {0xF92F,0x52DE,0},{0xF930,0x64C4,0},{0xF931,0x6AD3,0},{0xF932,0x7210,0},{0xF933,0x76E7,0},{0xF934,0x8001,0},
    {0xF935,0x8606,0},{0xF936,0x865C,0},{0xF937,0x8DEF,0},{0xF938,0x9732,0},{0xF939,0x9B6F,0},{0xF93A,0x9DFA,0},
    {0xF93B,0x788C,0},{0xF93C,0x797F,0},{0xF93D,0x7DA0,0},{0xF93E,0x83C9,0},{0xF93F,0x9304,0},{0xF940,0x9E7F,0},
    {0xF941,0x8AD6,0},{0xF942,0x58DF,0},{0xF943,0x5F04,0},{0xF944,0x7C60,0},{0xF945,0x807E,0},{0xF946,0x7262,0},
    {0xF947,0x78CA,0},{0xF948,0x8CC2,0},{0xF949,0x96F7,0},{0xF94A,0x58D8,0},{0xF94B,0x5C62,0},{0xF94C,0x6A13,0},
    {0xF94D,0x6DDA,0},{0xF94E,0x6F0F,0},{0xF94F,0x7D2F,0},{0xF950,0x7E37,0},{0xF951,0x964B,0},{0xF952,0x52D2,0},
    {0xF953,0x808B,0},{0xF954,0x51DC,0},{0xF955,0x51CC,0},{0xF956,0x7A1C,0},{0xF957,0x7DBE,0},{0xF958,0x83F1,0},
    {0xF959,0x9675,0},{0xF95A,0x8B80,0},{0xF95B,0x62CF,0},{0xF95C,0x6A02,0},{0xF95D,0x8AFE,0},{0xF95E,0x4E39,0},
    {0xF95F,0x5BE7,0},{0xF960,0x6012,0},{0xF961,0x7387,0},{0xF962,0x7570,0},{0xF963,0x5317,0},{0xF964,0x78FB,0},
    {0xF965,0x4FBF,0},{0xF966,0x5FA9,0},{0xF967,0x4E0D,0},{0xF968,0x6CCC,0},{0xF969,0x6578,0},{0xF96A,0x7D22,0},
    {0xF96B,0x53C3,0},{0xF96C,0x585E,0},{0xF96D,0x7701,0},{0xF96E,0x8449,0},{0xF96F,0x8AAA,0},{0xF970,0x6BBA,0},
    {0xF971,0x8FB0,0},{0xF972,0x6C88,0},{0xF973,0x62FE,0},{0xF974,0x82E5,0},{0xF975,0x63A0,0},{0xF976,0x7565,0},
    {0xF977,0x4EAE,0},{0xF978,0x5169,0},{0xF979,0x51C9,0},{0xF97A,0x6881,0},{0xF97B,0x7CE7,0},{0xF97C,0x826F,0},
    {0xF97D,0x8AD2,0},{0xF97E,0x91CF,0},{0xF97F,0x52F5,0},{0xF980,0x5442,0},{0xF981,0x5973,0},{0xF982,0x5EEC,0},
    {0xF983,0x65C5,0},{0xF984,0x6FFE,0},{0xF985,0x792A,0},{0xF986,0x95AD,0},{0xF987,0x9A6A,0},{0xF988,0x9E97,0},
    {0xF989,0x9ECE,0},{0xF98A,0x529B,0},{0xF98B,0x66C6,0},{0xF98C,0x6B77,0},{0xF98D,0x8F62,0},{0xF98E,0x5E74,0},
    {0xF98F,0x6190,0},{0xF990,0x6200,0},{0xF991,0x649A,0},{0xF992,0x6F23,0},{0xF993,0x7149,0},{0xF994,0x7489,0},
    {0xF995,0x79CA,0},{0xF996,0x7DF4,0},{0xF997,0x806F,0},{0xF998,0x8F26,0},{0xF999,0x84EE,0},{0xF99A,0x9023,0},
    {0xF99B,0x934A,0},{0xF99C,0x5217,0},{0xF99D,0x52A3,0},{0xF99E,0x54BD,0},{0xF99F,0x70C8,0},{0xF9A0,0x88C2,0},
    {0xF9A1,0x8AAA,0},{0xF9A2,0x5EC9,0},{0xF9A3,0x5FF5,0},{0xF9A4,0x637B,0},{0xF9A5,0x6BAE,0},{0xF9A6,0x7C3E,0},
    {0xF9A7,0x7375,0},{0xF9A8,0x4EE4,0},{0xF9A9,0x56F9,0},{0xF9AA,0x5BE7,0},{0xF9AB,0x5DBA,0},{0xF9AC,0x601C,0},
    {0xF9AD,0x73B2,0},{0xF9AE,0x7469,0},{0xF9AF,0x7F9A,0},{0xF9B0,0x8046,0},{0xF9B1,0x9234,0},{0xF9B2,0x96F6,0},
    {0xF9B3,0x9748,0},{0xF9B4,0x9818,0},{0xF9B5,0x4F8B,0},{0xF9B6,0x79AE,0},{0xF9B7,0x91B4,0},{0xF9B8,0x96B8,0},
    {0xF9B9,0x60E1,0},{0xF9BA,0x4E86,0},{0xF9BB,0x50DA,0},{0xF9BC,0x5BEE,0},{0xF9BD,0x5C3F,0},{0xF9BE,0x6599,0},
    {0xF9BF,0x6A02,0},{0xF9C0,0x71CE,0},{0xF9C1,0x7642,0},{0xF9C2,0x84FC,0},{0xF9C3,0x907C,0},{0xF9C4,0x9F8D,0},
    {0xF9C5,0x6688,0},{0xF9C6,0x962E,0},{0xF9C7,0x5289,0},{0xF9C8,0x677B,0},{0xF9C9,0x67F3,0},{0xF9CA,0x6D41,0},
    {0xF9CB,0x6E9C,0},{0xF9CC,0x7409,0},{0xF9CD,0x7559,0},{0xF9CE,0x786B,0},{0xF9CF,0x7D10,0},{0xF9D0,0x985E,0},
    {0xF9D1,0x516D,0},{0xF9D2,0x622E,0},{0xF9D3,0x9678,0},{0xF9D4,0x502B,0},{0xF9D5,0x5D19,0},{0xF9D6,0x6DEA,0},
    {0xF9D7,0x8F2A,0},{0xF9D8,0x5F8B,0},{0xF9D9,0x6144,0},{0xF9DA,0x6817,0},{0xF9DB,0x7387,0},{0xF9DC,0x9686,0},
    {0xF9DD,0x5229,0},{0xF9DE,0x540F,0},{0xF9DF,0x5C65,0},{0xF9E0,0x6613,0},{0xF9E1,0x674E,0},{0xF9E2,0x68A8,0},
    {0xF9E3,0x6CE5,0},{0xF9E4,0x7406,0},{0xF9E5,0x75E2,0},{0xF9E6,0x7F79,0},{0xF9E7,0x88CF,0},{0xF9E8,0x88E1,0},
    {0xF9E9,0x91CC,0},{0xF9EA,0x96E2,0},{0xF9EB,0x533F,0},{0xF9EC,0x6EBA,0},{0xF9ED,0x541D,0},{0xF9EE,0x71D0,0},
    {0xF9EF,0x7498,0},{0xF9F0,0x85FA,0},{0xF9F1,0x96A3,0},{0xF9F2,0x9C57,0},{0xF9F3,0x9E9F,0},{0xF9F4,0x6797,0},
    {0xF9F5,0x6DCB,0},{0xF9F6,0x81E8,0},{0xF9F7,0x7ACB,0},{0xF9F8,0x7B20,0},{0xF9F9,0x7C92,0},{0xF9FA,0x72C0,0},
    {0xF9FB,0x7099,0},{0xF9FC,0x8B58,0},{0xF9FD,0x4EC0,0},{0xF9FE,0x8336,0},{0xF9FF,0x523A,0},{0xFA00,0x5207,0},
    {0xFA01,0x5EA6,0},{0xFA02,0x62D3,0},{0xFA03,0x7CD6,0},{0xFA04,0x5B85,0},{0xFA05,0x6D1E,0},{0xFA06,0x66B4,0},
    {0xFA07,0x8F3B,0},{0xFA08,0x884C,0},{0xFA09,0x964D,0},{0xFA0A,0x898B,0},{0xFA0B,0x5ED3,0},{0xFA0C,0x5140,0},
    {0xFA0D,0x55C0,0},{0xFA10,0x585A,0},{0xFA12,0x6674,0},{0xFA15,0x51DE,0},{0xFA16,0x732A,0},{0xFA17,0x76CA,0},
    {0xFA18,0x793C,0},{0xFA19,0x795E,0},{0xFA1A,0x7965,0},{0xFA1B,0x798F,0},{0xFA1C,0x9756,0},{0xFA1D,0x7CBE,0},
    {0xFA1E,0x7FBD,0},{0xFA20,0x8612,0},{0xFA22,0x8AF8,0},{0xFA25,0x9038,0},{0xFA26,0x90FD,0},{0xFA2A,0x98EF,0},
    {0xFA2B,0x98FC,0},{0xFA2C,0x9928,0},{0xFA2D,0x9DB4,0},{0xFA2E,0x90DE,0},{0xFA2F,0x96B7,0},{0xFA30,0x4FAE,0},
    {0xFA31,0x50E7,0},{0xFA32,0x514D,0},{0xFA33,0x52C9,0},{0xFA34,0x52E4,0},{0xFA35,0x5351,0},{0xFA36,0x559D,0},
    {0xFA37,0x5606,0},{0xFA38,0x5668,0},{0xFA39,0x5840,0},{0xFA3A,0x58A8,0},{0xFA3B,0x5C64,0},{0xFA3C,0x5C6E,0},
    {0xFA3D,0x6094,0},{0xFA3E,0x6168,0},{0xFA3F,0x618E,0},{0xFA40,0x61F2,0},{0xFA41,0x654F,0},{0xFA42,0x65E2,0},
    {0xFA43,0x6691,0},{0xFA44,0x6885,0},{0xFA45,0x6D77,0},{0xFA46,0x6E1A,0},{0xFA47,0x6F22,0},{0xFA48,0x716E,0},
    {0xFA49,0x722B,0},{0xFA4A,0x7422,0},{0xFA4B,0x7891,0},{0xFA4C,0x793E,0},{0xFA4D,0x7949,0},{0xFA4E,0x7948,0},
    {0xFA4F,0x7950,0},{0xFA50,0x7956,0},{0xFA51,0x795D,0},{0xFA52,0x798D,0},{0xFA53,0x798E,0},{0xFA54,0x7A40,0},
    {0xFA55,0x7A81,0},{0xFA56,0x7BC0,0},{0xFA57,0x7DF4,0},{0xFA58,0x7E09,0},{0xFA59,0x7E41,0},{0xFA5A,0x7F72,0},
    {0xFA5B,0x8005,0},{0xFA5C,0x81ED,0},{0xFA5D,0x8279,0},{0xFA5E,0x8279,0},{0xFA5F,0x8457,0},{0xFA60,0x8910,0},
    {0xFA61,0x8996,0},{0xFA62,0x8B01,0},{0xFA63,0x8B39,0},{0xFA64,0x8CD3,0},{0xFA65,0x8D08,0},{0xFA66,0x8FB6,0},
    {0xFA67,0x9038,0},{0xFA68,0x96E3,0},{0xFA69,0x97FF,0},{0xFA6A,0x983B,0},{0xFA6B,0x6075,0},{0xFA6C,0x242EE,0},
    {0xFA6D,0x8218,0},{0xFA70,0x4E26,0},{0xFA71,0x51B5,0},{0xFA72,0x5168,0},{0xFA73,0x4F80,0},{0xFA74,0x5145,0},
    {0xFA75,0x5180,0},{0xFA76,0x52C7,0},{0xFA77,0x52FA,0},{0xFA78,0x559D,0},{0xFA79,0x5555,0},{0xFA7A,0x5599,0},
    {0xFA7B,0x55E2,0},{0xFA7C,0x585A,0},{0xFA7D,0x58B3,0},{0xFA7E,0x5944,0},{0xFA7F,0x5954,0},{0xFA80,0x5A62,0},
    {0xFA81,0x5B28,0},{0xFA82,0x5ED2,0},{0xFA83,0x5ED9,0},{0xFA84,0x5F69,0},{0xFA85,0x5FAD,0},{0xFA86,0x60D8,0},
    {0xFA87,0x614E,0},{0xFA88,0x6108,0},{0xFA89,0x618E,0},{0xFA8A,0x6160,0},{0xFA8B,0x61F2,0},{0xFA8C,0x6234,0},
    {0xFA8D,0x63C4,0},{0xFA8E,0x641C,0},{0xFA8F,0x6452,0},{0xFA90,0x6556,0},{0xFA91,0x6674,0},{0xFA92,0x6717,0},
    {0xFA93,0x671B,0},{0xFA94,0x6756,0},{0xFA95,0x6B79,0},{0xFA96,0x6BBA,0},{0xFA97,0x6D41,0},{0xFA98,0x6EDB,0},
    {0xFA99,0x6ECB,0},{0xFA9A,0x6F22,0},{0xFA9B,0x701E,0},{0xFA9C,0x716E,0},{0xFA9D,0x77A7,0},{0xFA9E,0x7235,0},
    {0xFA9F,0x72AF,0},{0xFAA0,0x732A,0},{0xFAA1,0x7471,0},{0xFAA2,0x7506,0},{0xFAA3,0x753B,0},{0xFAA4,0x761D,0},
    {0xFAA5,0x761F,0},{0xFAA6,0x76CA,0},{0xFAA7,0x76DB,0},{0xFAA8,0x76F4,0},{0xFAA9,0x774A,0},{0xFAAA,0x7740,0},
    {0xFAAB,0x78CC,0},{0xFAAC,0x7AB1,0},{0xFAAD,0x7BC0,0},{0xFAAE,0x7C7B,0},{0xFAAF,0x7D5B,0},{0xFAB0,0x7DF4,0},
    {0xFAB1,0x7F3E,0},{0xFAB2,0x8005,0},{0xFAB3,0x8352,0},{0xFAB4,0x83EF,0},{0xFAB5,0x8779,0},{0xFAB6,0x8941,0},
    {0xFAB7,0x8986,0},{0xFAB8,0x8996,0},{0xFAB9,0x8ABF,0},{0xFABA,0x8AF8,0},{0xFABB,0x8ACB,0},{0xFABC,0x8B01,0},
    {0xFABD,0x8AFE,0},{0xFABE,0x8AED,0},{0xFABF,0x8B39,0},{0xFAC0,0x8B8A,0},{0xFAC1,0x8D08,0},{0xFAC2,0x8F38,0},
    {0xFAC3,0x9072,0},{0xFAC4,0x9199,0},{0xFAC5,0x9276,0},{0xFAC6,0x967C,0},{0xFAC7,0x96E3,0},{0xFAC8,0x9756,0},
    {0xFAC9,0x97DB,0},{0xFACA,0x97FF,0},{0xFACB,0x980B,0},{0xFACC,0x983B,0},{0xFACD,0x9B12,0},{0xFACE,0x9F9C,0},
    {0xFACF,0x2284A,0},{0xFAD0,0x22844,0},{0xFAD1,0x233D5,0},{0xFAD2,0x3B9D,0},{0xFAD3,0x4018,0},{0xFAD4,0x4039,0},
    {0xFAD5,0x25249,0},{0xFAD6,0x25CD0,0},{0xFAD7,0x27ED3,0},{0xFAD8,0x9F43,0},{0xFAD9,0x9F8E,0},{0xFB1D,0x5D9,0x5B4},
    {0xFB1F,0x5F2,0x5B7},{0xFB2A,0x5E9,0x5C1},{0xFB2B,0x5E9,0x5C2},{0xFB2C,0xFB49,0x5C1},{0xFB2D,0xFB49,0x5C2},
    {0xFB2E,0x5D0,0x5B7},{0xFB2F,0x5D0,0x5B8},{0xFB30,0x5D0,0x5BC},{0xFB31,0x5D1,0x5BC},{0xFB32,0x5D2,0x5BC},
    {0xFB33,0x5D3,0x5BC},{0xFB34,0x5D4,0x5BC},{0xFB35,0x5D5,0x5BC},{0xFB36,0x5D6,0x5BC},{0xFB38,0x5D8,0x5BC},
    {0xFB39,0x5D9,0x5BC},{0xFB3A,0x5DA,0x5BC},{0xFB3B,0x5DB,0x5BC},{0xFB3C,0x5DC,0x5BC},{0xFB3E,0x5DE,0x5BC},
    {0xFB40,0x5E0,0x5BC},{0xFB41,0x5E1,0x5BC},{0xFB43,0x5E3,0x5BC},{0xFB44,0x5E4,0x5BC},{0xFB46,0x5E6,0x5BC},
    {0xFB47,0x5E7,0x5BC},{0xFB48,0x5E8,0x5BC},{0xFB49,0x5E9,0x5BC},{0xFB4A,0x5EA,0x5BC},{0xFB4B,0x5D5,0x5B9},
    {0xFB4C,0x5D1,0x5BF},{0xFB4D,0x5DB,0x5BF},{0xFB4E,0x5E4,0x5BF},{0x1109A,0x11099,0x110BA},{0x1109C,0x1109B,0x110BA},
    {0x110AB,0x110A5,0x110BA},{0x1112E,0x11131,0x11127},{0x1112F,0x11132,0x11127},{0x1134B,0x11347,0x1133E},
    {0x1134C,0x11347,0x11357},{0x114BB,0x114B9,0x114BA},{0x114BC,0x114B9,0x114B0},{0x114BE,0x114B9,0x114BD},
    {0x115BA,0x115B8,0x115AF},{0x115BB,0x115B9,0x115AF},{0x11938,0x11935,0x11930},{0x1D15E,0x1D157,0x1D165},
    {0x1D15F,0x1D158,0x1D165},{0x1D160,0x1D15F,0x1D16E},{0x1D161,0x1D15F,0x1D16F},{0x1D162,0x1D15F,0x1D170},
    {0x1D163,0x1D15F,0x1D171},{0x1D164,0x1D15F,0x1D172},{0x1D1BB,0x1D1B9,0x1D165},{0x1D1BC,0x1D1BA,0x1D165},
    {0x1D1BD,0x1D1BB,0x1D16E},{0x1D1BE,0x1D1BC,0x1D16E},{0x1D1BF,0x1D1BB,0x1D16F},{0x1D1C0,0x1D1BC,0x1D16F},
    {0x2F800,0x4E3D,0},{0x2F801,0x4E38,0},{0x2F802,0x4E41,0},{0x2F803,0x20122,0},{0x2F804,0x4F60,0},{0x2F805,0x4FAE,0},
    {0x2F806,0x4FBB,0},{0x2F807,0x5002,0},{0x2F808,0x507A,0},{0x2F809,0x5099,0},{0x2F80A,0x50E7,0},{0x2F80B,0x50CF,0},
    {0x2F80C,0x349E,0},{0x2F80D,0x2063A,0},{0x2F80E,0x514D,0},{0x2F80F,0x5154,0},{0x2F810,0x5164,0},{0x2F811,0x5177,0},
    {0x2F812,0x2051C,0},{0x2F813,0x34B9,0},{0x2F814,0x5167,0},{0x2F815,0x518D,0},{0x2F816,0x2054B,0},{0x2F817,0x5197,0},
    {0x2F818,0x51A4,0},{0x2F819,0x4ECC,0},{0x2F81A,0x51AC,0},{0x2F81B,0x51B5,0},{0x2F81C,0x291DF,0},{0x2F81D,0x51F5,0},
    {0x2F81E,0x5203,0},{0x2F81F,0x34DF,0},{0x2F820,0x523B,0},{0x2F821,0x5246,0},{0x2F822,0x5272,0},{0x2F823,0x5277,0},
    {0x2F824,0x3515,0},{0x2F825,0x52C7,0},{0x2F826,0x52C9,0},{0x2F827,0x52E4,0},{0x2F828,0x52FA,0},{0x2F829,0x5305,0},
    {0x2F82A,0x5306,0},{0x2F82B,0x5317,0},{0x2F82C,0x5349,0},{0x2F82D,0x5351,0},{0x2F82E,0x535A,0},{0x2F82F,0x5373,0},
    {0x2F830,0x537D,0},{0x2F831,0x537F,0},{0x2F832,0x537F,0},{0x2F833,0x537F,0},{0x2F834,0x20A2C,0},{0x2F835,0x7070,0},
    {0x2F836,0x53CA,0},{0x2F837,0x53DF,0},{0x2F838,0x20B63,0},{0x2F839,0x53EB,0},{0x2F83A,0x53F1,0},{0x2F83B,0x5406,0},
    {0x2F83C,0x549E,0},{0x2F83D,0x5438,0},{0x2F83E,0x5448,0},{0x2F83F,0x5468,0},{0x2F840,0x54A2,0},{0x2F841,0x54F6,0},
    {0x2F842,0x5510,0},{0x2F843,0x5553,0},{0x2F844,0x5563,0},{0x2F845,0x5584,0},{0x2F846,0x5584,0},{0x2F847,0x5599,0},
    {0x2F848,0x55AB,0},{0x2F849,0x55B3,0},{0x2F84A,0x55C2,0},{0x2F84B,0x5716,0},{0x2F84C,0x5606,0},{0x2F84D,0x5717,0},
    {0x2F84E,0x5651,0},{0x2F84F,0x5674,0},{0x2F850,0x5207,0},{0x2F851,0x58EE,0},{0x2F852,0x57CE,0},{0x2F853,0x57F4,0},
    {0x2F854,0x580D,0},{0x2F855,0x578B,0},{0x2F856,0x5832,0},{0x2F857,0x5831,0},{0x2F858,0x58AC,0},{0x2F859,0x214E4,0},
    {0x2F85A,0x58F2,0},{0x2F85B,0x58F7,0},{0x2F85C,0x5906,0},{0x2F85D,0x591A,0},{0x2F85E,0x5922,0},{0x2F85F,0x5962,0},
    {0x2F860,0x216A8,0},{0x2F861,0x216EA,0},{0x2F862,0x59EC,0},{0x2F863,0x5A1B,0},{0x2F864,0x5A27,0},{0x2F865,0x59D8,0},
    {0x2F866,0x5A66,0},{0x2F867,0x36EE,0},{0x2F868,0x36FC,0},{0x2F869,0x5B08,0},{0x2F86A,0x5B3E,0},{0x2F86B,0x5B3E,0},
    {0x2F86C,0x219C8,0},{0x2F86D,0x5BC3,0},{0x2F86E,0x5BD8,0},{0x2F86F,0x5BE7,0},{0x2F870,0x5BF3,0},{0x2F871,0x21B18,0},
    {0x2F872,0x5BFF,0},{0x2F873,0x5C06,0},{0x2F874,0x5F53,0},{0x2F875,0x5C22,0},{0x2F876,0x3781,0},{0x2F877,0x5C60,0},
    {0x2F878,0x5C6E,0},{0x2F879,0x5CC0,0},{0x2F87A,0x5C8D,0},{0x2F87B,0x21DE4,0},{0x2F87C,0x5D43,0},{0x2F87D,0x21DE6,0},
    {0x2F87E,0x5D6E,0},{0x2F87F,0x5D6B,0},{0x2F880,0x5D7C,0},{0x2F881,0x5DE1,0},{0x2F882,0x5DE2,0},{0x2F883,0x382F,0},
    {0x2F884,0x5DFD,0},{0x2F885,0x5E28,0},{0x2F886,0x5E3D,0},{0x2F887,0x5E69,0},{0x2F888,0x3862,0},{0x2F889,0x22183,0},
    {0x2F88A,0x387C,0},{0x2F88B,0x5EB0,0},{0x2F88C,0x5EB3,0},{0x2F88D,0x5EB6,0},{0x2F88E,0x5ECA,0},{0x2F88F,0x2A392,0},
    {0x2F890,0x5EFE,0},{0x2F891,0x22331,0},{0x2F892,0x22331,0},{0x2F893,0x8201,0},{0x2F894,0x5F22,0},{0x2F895,0x5F22,0},
    {0x2F896,0x38C7,0},{0x2F897,0x232B8,0},{0x2F898,0x261DA,0},{0x2F899,0x5F62,0},{0x2F89A,0x5F6B,0},{0x2F89B,0x38E3,0},
    {0x2F89C,0x5F9A,0},{0x2F89D,0x5FCD,0},{0x2F89E,0x5FD7,0},{0x2F89F,0x5FF9,0},{0x2F8A0,0x6081,0},{0x2F8A1,0x393A,0},
    {0x2F8A2,0x391C,0},{0x2F8A3,0x6094,0},{0x2F8A4,0x226D4,0},{0x2F8A5,0x60C7,0},{0x2F8A6,0x6148,0},{0x2F8A7,0x614C,0},
    {0x2F8A8,0x614E,0},{0x2F8A9,0x614C,0},{0x2F8AA,0x617A,0},{0x2F8AB,0x618E,0},{0x2F8AC,0x61B2,0},{0x2F8AD,0x61A4,0},
    {0x2F8AE,0x61AF,0},{0x2F8AF,0x61DE,0},{0x2F8B0,0x61F2,0},{0x2F8B1,0x61F6,0},{0x2F8B2,0x6210,0},{0x2F8B3,0x621B,0},
    {0x2F8B4,0x625D,0},{0x2F8B5,0x62B1,0},{0x2F8B6,0x62D4,0},{0x2F8B7,0x6350,0},{0x2F8B8,0x22B0C,0},{0x2F8B9,0x633D,0},
    {0x2F8BA,0x62FC,0},{0x2F8BB,0x6368,0},{0x2F8BC,0x6383,0},{0x2F8BD,0x63E4,0},{0x2F8BE,0x22BF1,0},{0x2F8BF,0x6422,0},
    {0x2F8C0,0x63C5,0},{0x2F8C1,0x63A9,0},{0x2F8C2,0x3A2E,0},{0x2F8C3,0x6469,0},{0x2F8C4,0x647E,0},{0x2F8C5,0x649D,0},
    {0x2F8C6,0x6477,0},{0x2F8C7,0x3A6C,0},{0x2F8C8,0x654F,0},{0x2F8C9,0x656C,0},{0x2F8CA,0x2300A,0},{0x2F8CB,0x65E3,0},
    {0x2F8CC,0x66F8,0},{0x2F8CD,0x6649,0},{0x2F8CE,0x3B19,0},{0x2F8CF,0x6691,0},{0x2F8D0,0x3B08,0},{0x2F8D1,0x3AE4,0},
    {0x2F8D2,0x5192,0},{0x2F8D3,0x5195,0},{0x2F8D4,0x6700,0},{0x2F8D5,0x669C,0},{0x2F8D6,0x80AD,0},{0x2F8D7,0x43D9,0},
    {0x2F8D8,0x6717,0},{0x2F8D9,0x671B,0},{0x2F8DA,0x6721,0},{0x2F8DB,0x675E,0},{0x2F8DC,0x6753,0},{0x2F8DD,0x233C3,0},
    {0x2F8DE,0x3B49,0},{0x2F8DF,0x67FA,0},{0x2F8E0,0x6785,0},{0x2F8E1,0x6852,0},{0x2F8E2,0x6885,0},{0x2F8E3,0x2346D,0},
    {0x2F8E4,0x688E,0},{0x2F8E5,0x681F,0},{0x2F8E6,0x6914,0},{0x2F8E7,0x3B9D,0},{0x2F8E8,0x6942,0},{0x2F8E9,0x69A3,0},
    {0x2F8EA,0x69EA,0},{0x2F8EB,0x6AA8,0},{0x2F8EC,0x236A3,0},{0x2F8ED,0x6ADB,0},{0x2F8EE,0x3C18,0},{0x2F8EF,0x6B21,0},
    {0x2F8F0,0x238A7,0},{0x2F8F1,0x6B54,0},{0x2F8F2,0x3C4E,0},{0x2F8F3,0x6B72,0},{0x2F8F4,0x6B9F,0},{0x2F8F5,0x6BBA,0},
    {0x2F8F6,0x6BBB,0},{0x2F8F7,0x23A8D,0},{0x2F8F8,0x21D0B,0},{0x2F8F9,0x23AFA,0},{0x2F8FA,0x6C4E,0},
    {0x2F8FB,0x23CBC,0},{0x2F8FC,0x6CBF,0},{0x2F8FD,0x6CCD,0},{0x2F8FE,0x6C67,0},{0x2F8FF,0x6D16,0},{0x2F900,0x6D3E,0},
    {0x2F901,0x6D77,0},{0x2F902,0x6D41,0},{0x2F903,0x6D69,0},{0x2F904,0x6D78,0},{0x2F905,0x6D85,0},{0x2F906,0x23D1E,0},
    {0x2F907,0x6D34,0},{0x2F908,0x6E2F,0},{0x2F909,0x6E6E,0},{0x2F90A,0x3D33,0},{0x2F90B,0x6ECB,0},{0x2F90C,0x6EC7,0},
    {0x2F90D,0x23ED1,0},{0x2F90E,0x6DF9,0},{0x2F90F,0x6F6E,0},{0x2F910,0x23F5E,0},{0x2F911,0x23F8E,0},{0x2F912,0x6FC6,0},
    {0x2F913,0x7039,0},{0x2F914,0x701E,0},{0x2F915,0x701B,0},{0x2F916,0x3D96,0},{0x2F917,0x704A,0},{0x2F918,0x707D,0},
    {0x2F919,0x7077,0},{0x2F91A,0x70AD,0},{0x2F91B,0x20525,0},{0x2F91C,0x7145,0},{0x2F91D,0x24263,0},{0x2F91E,0x719C,0},
    {0x2F91F,0x243AB,0},{0x2F920,0x7228,0},{0x2F921,0x7235,0},{0x2F922,0x7250,0},{0x2F923,0x24608,0},{0x2F924,0x7280,0},
    {0x2F925,0x7295,0},{0x2F926,0x24735,0},{0x2F927,0x24814,0},{0x2F928,0x737A,0},{0x2F929,0x738B,0},{0x2F92A,0x3EAC,0},
    {0x2F92B,0x73A5,0},{0x2F92C,0x3EB8,0},{0x2F92D,0x3EB8,0},{0x2F92E,0x7447,0},{0x2F92F,0x745C,0},{0x2F930,0x7471,0},
    {0x2F931,0x7485,0},{0x2F932,0x74CA,0},{0x2F933,0x3F1B,0},{0x2F934,0x7524,0},{0x2F935,0x24C36,0},{0x2F936,0x753E,0},
    {0x2F937,0x24C92,0},{0x2F938,0x7570,0},{0x2F939,0x2219F,0},{0x2F93A,0x7610,0},{0x2F93B,0x24FA1,0},
    {0x2F93C,0x24FB8,0},{0x2F93D,0x25044,0},{0x2F93E,0x3FFC,0},{0x2F93F,0x4008,0},{0x2F940,0x76F4,0},{0x2F941,0x250F3,0},
    {0x2F942,0x250F2,0},{0x2F943,0x25119,0},{0x2F944,0x25133,0},{0x2F945,0x771E,0},{0x2F946,0x771F,0},{0x2F947,0x771F,0},
    {0x2F948,0x774A,0},{0x2F949,0x4039,0},{0x2F94A,0x778B,0},{0x2F94B,0x4046,0},{0x2F94C,0x4096,0},{0x2F94D,0x2541D,0},
    {0x2F94E,0x784E,0},{0x2F94F,0x788C,0},{0x2F950,0x78CC,0},{0x2F951,0x40E3,0},{0x2F952,0x25626,0},{0x2F953,0x7956,0},
    {0x2F954,0x2569A,0},{0x2F955,0x256C5,0},{0x2F956,0x798F,0},{0x2F957,0x79EB,0},{0x2F958,0x412F,0},{0x2F959,0x7A40,0},
    {0x2F95A,0x7A4A,0},{0x2F95B,0x7A4F,0},{0x2F95C,0x2597C,0},{0x2F95D,0x25AA7,0},{0x2F95E,0x25AA7,0},{0x2F95F,0x7AEE,0},
    {0x2F960,0x4202,0},{0x2F961,0x25BAB,0},{0x2F962,0x7BC6,0},{0x2F963,0x7BC9,0},{0x2F964,0x4227,0},{0x2F965,0x25C80,0},
    {0x2F966,0x7CD2,0},{0x2F967,0x42A0,0},{0x2F968,0x7CE8,0},{0x2F969,0x7CE3,0},{0x2F96A,0x7D00,0},{0x2F96B,0x25F86,0},
    {0x2F96C,0x7D63,0},{0x2F96D,0x4301,0},{0x2F96E,0x7DC7,0},{0x2F96F,0x7E02,0},{0x2F970,0x7E45,0},{0x2F971,0x4334,0},
    {0x2F972,0x26228,0},{0x2F973,0x26247,0},{0x2F974,0x4359,0},{0x2F975,0x262D9,0},{0x2F976,0x7F7A,0},
    {0x2F977,0x2633E,0},{0x2F978,0x7F95,0},{0x2F979,0x7FFA,0},{0x2F97A,0x8005,0},{0x2F97B,0x264DA,0},{0x2F97C,0x26523,0},
    {0x2F97D,0x8060,0},{0x2F97E,0x265A8,0},{0x2F97F,0x8070,0},{0x2F980,0x2335F,0},{0x2F981,0x43D5,0},{0x2F982,0x80B2,0},
    {0x2F983,0x8103,0},{0x2F984,0x440B,0},{0x2F985,0x813E,0},{0x2F986,0x5AB5,0},{0x2F987,0x267A7,0},{0x2F988,0x267B5,0},
    {0x2F989,0x23393,0},{0x2F98A,0x2339C,0},{0x2F98B,0x8201,0},{0x2F98C,0x8204,0},{0x2F98D,0x8F9E,0},{0x2F98E,0x446B,0},
    {0x2F98F,0x8291,0},{0x2F990,0x828B,0},{0x2F991,0x829D,0},{0x2F992,0x52B3,0},{0x2F993,0x82B1,0},{0x2F994,0x82B3,0},
    {0x2F995,0x82BD,0},{0x2F996,0x82E6,0},{0x2F997,0x26B3C,0},{0x2F998,0x82E5,0},{0x2F999,0x831D,0},{0x2F99A,0x8363,0},
    {0x2F99B,0x83AD,0},{0x2F99C,0x8323,0},{0x2F99D,0x83BD,0},{0x2F99E,0x83E7,0},{0x2F99F,0x8457,0},{0x2F9A0,0x8353,0},
    {0x2F9A1,0x83CA,0},{0x2F9A2,0x83CC,0},{0x2F9A3,0x83DC,0},{0x2F9A4,0x26C36,0},{0x2F9A5,0x26D6B,0},{0x2F9A6,0x26CD5,0},
    {0x2F9A7,0x452B,0},{0x2F9A8,0x84F1,0},{0x2F9A9,0x84F3,0},{0x2F9AA,0x8516,0},{0x2F9AB,0x273CA,0},{0x2F9AC,0x8564,0},
    {0x2F9AD,0x26F2C,0},{0x2F9AE,0x455D,0},{0x2F9AF,0x4561,0},{0x2F9B0,0x26FB1,0},{0x2F9B1,0x270D2,0},{0x2F9B2,0x456B,0},
    {0x2F9B3,0x8650,0},{0x2F9B4,0x865C,0},{0x2F9B5,0x8667,0},{0x2F9B6,0x8669,0},{0x2F9B7,0x86A9,0},{0x2F9B8,0x8688,0},
    {0x2F9B9,0x870E,0},{0x2F9BA,0x86E2,0},{0x2F9BB,0x8779,0},{0x2F9BC,0x8728,0},{0x2F9BD,0x876B,0},{0x2F9BE,0x8786,0},
    {0x2F9BF,0x45D7,0},{0x2F9C0,0x87E1,0},{0x2F9C1,0x8801,0},{0x2F9C2,0x45F9,0},{0x2F9C3,0x8860,0},{0x2F9C4,0x8863,0},
    {0x2F9C5,0x27667,0},{0x2F9C6,0x88D7,0},{0x2F9C7,0x88DE,0},{0x2F9C8,0x4635,0},{0x2F9C9,0x88FA,0},{0x2F9CA,0x34BB,0},
    {0x2F9CB,0x278AE,0},{0x2F9CC,0x27966,0},{0x2F9CD,0x46BE,0},{0x2F9CE,0x46C7,0},{0x2F9CF,0x8AA0,0},{0x2F9D0,0x8AED,0},
    {0x2F9D1,0x8B8A,0},{0x2F9D2,0x8C55,0},{0x2F9D3,0x27CA8,0},{0x2F9D4,0x8CAB,0},{0x2F9D5,0x8CC1,0},{0x2F9D6,0x8D1B,0},
    {0x2F9D7,0x8D77,0},{0x2F9D8,0x27F2F,0},{0x2F9D9,0x20804,0},{0x2F9DA,0x8DCB,0},{0x2F9DB,0x8DBC,0},{0x2F9DC,0x8DF0,0},
    {0x2F9DD,0x208DE,0},{0x2F9DE,0x8ED4,0},{0x2F9DF,0x8F38,0},{0x2F9E0,0x285D2,0},{0x2F9E1,0x285ED,0},{0x2F9E2,0x9094,0},
    {0x2F9E3,0x90F1,0},{0x2F9E4,0x9111,0},{0x2F9E5,0x2872E,0},{0x2F9E6,0x911B,0},{0x2F9E7,0x9238,0},{0x2F9E8,0x92D7,0},
    {0x2F9E9,0x92D8,0},{0x2F9EA,0x927C,0},{0x2F9EB,0x93F9,0},{0x2F9EC,0x9415,0},{0x2F9ED,0x28BFA,0},{0x2F9EE,0x958B,0},
    {0x2F9EF,0x4995,0},{0x2F9F0,0x95B7,0},{0x2F9F1,0x28D77,0},{0x2F9F2,0x49E6,0},{0x2F9F3,0x96C3,0},{0x2F9F4,0x5DB2,0},
    {0x2F9F5,0x9723,0},{0x2F9F6,0x29145,0},{0x2F9F7,0x2921A,0},{0x2F9F8,0x4A6E,0},{0x2F9F9,0x4A76,0},{0x2F9FA,0x97E0,0},
    {0x2F9FB,0x2940A,0},{0x2F9FC,0x4AB2,0},{0x2F9FD,0x29496,0},{0x2F9FE,0x980B,0},{0x2F9FF,0x980B,0},{0x2FA00,0x9829,0},
    {0x2FA01,0x295B6,0},{0x2FA02,0x98E2,0},{0x2FA03,0x4B33,0},{0x2FA04,0x9929,0},{0x2FA05,0x99A7,0},{0x2FA06,0x99C2,0},
    {0x2FA07,0x99FE,0},{0x2FA08,0x4BCE,0},{0x2FA09,0x29B30,0},{0x2FA0A,0x9B12,0},{0x2FA0B,0x9C40,0},{0x2FA0C,0x9CFD,0},
    {0x2FA0D,0x4CCE,0},{0x2FA0E,0x4CED,0},{0x2FA0F,0x9D67,0},{0x2FA10,0x2A0CE,0},{0x2FA11,0x4CF8,0},{0x2FA12,0x2A105,0},
    {0x2FA13,0x2A20E,0},{0x2FA14,0x2A291,0},{0x2FA15,0x9EBB,0},{0x2FA16,0x4D56,0},{0x2FA17,0x9EF9,0},{0x2FA18,0x9EFE,0},
    {0x2FA19,0x9F05,0},{0x2FA1A,0x9F0F,0},{0x2FA1B,0x9F16,0},{0x2FA1C,0x9F3B,0},{0x2FA1D,0x2A600,0},
};

/// Decompositions that may be composed again, in the order of (first, second).
inline constexpr std::uint16_t compositions[] = {
    0x390,0x38D,0x391,0,1,2,3,0x35,0x37,0xEE,4,0x23C,5,0xA5,0xD0,0xD2,0x23A,0x19F,0x39,0x1A1,0x1A3,0x1A5,0x3B,0x3D,0x3F,
    0x41,6,0x1A9,0x43,0x1AB,0x1AF,0x1B1,0x1AD,7,8,9,0x256,0x45,0x47,0x49,0xA,0x254,0x4D,0xD4,0xD6,0x252,0xF0,0x4B,0x1B7,
    0x1B9,0x1BD,0xC6,0x4F,0x1BF,0x51,0x53,0xBB,0x55,0x57,0x1C1,0x1C5,0xEC,0x1C3,0x1C7,0x1C9,0xB,0xC,0xD,0x59,0x5B,0x5D,
    0x61,0xE,0x262,0xA7,0xD8,0xDA,0x264,0x5F,0x1CB,0x62,0x1CF,0xBD,0x1D1,0x64,0x1D3,0x66,0x6A,0x1D5,0x68,0x1DB,0x1D9,
    0x1DD,0x1DF,0x1E1,0xC8,0x6C,0xF,0x1E3,0x70,0x1E5,0x6E,0x1E9,0x1E7,0x10,0x11,0x12,0x13,0x72,0x74,0xF6,0x14,0x268,0x76,
    0xA9,0xDC,0xDE,0xA1,0x266,0xBF,0x1F3,0x1F5,0x78,0x1F7,0x7C,0xE0,0xE2,0x1F9,0x7A,0x1FD,0x7E,0x80,0x1FF,0x84,0x201,
    0xE8,0x82,0x209,0x88,0x20B,0xEA,0x86,0x20F,0x20D,0x15,0x16,0x17,0x8A,0x8C,0x8E,0x18,0x280,0x90,0x92,0xAB,0xE4,0xE6,
    0xA3,0x27E,0x211,0x94,0x215,0x213,0x21B,0x21D,0x21F,0x221,0x96,0x225,0x223,0x227,0x229,0x22B,0x28C,0x19,0x98,0x292,
    0xFA,0x22D,0x9A,0x290,0x28E,0x9B,0x22F,0x9D,0x9F,0x231,0x233,0x1A,0x1B,0x1C,0x1D,0x36,0x38,0xEF,0x1E,0x23D,0x1F,0xA6,
    0xD1,0xD3,0x23B,0x1A0,0x3A,0x1A2,0x1A4,0x1A6,0x3C,0x3E,0x40,0x42,0x20,0x1AA,0x44,0x1AC,0x1B0,0x1B2,0x1AE,0x21,0x22,
    0x23,0x257,0x46,0x48,0x4A,0x24,0x255,0x4E,0xD5,0xD7,0x253,0xF1,0x4C,0x1B8,0x1BA,0x1BE,0xC7,0x50,0x1C0,0x52,0x54,0xBC,
    0x56,0x58,0x1C2,0x1C6,0xED,0x1C4,0x1C8,0x1CA,0x235,0x25,0x26,0x27,0x5A,0x5C,0x5E,0x28,0x263,0xA8,0xD9,0xDB,0x265,
    0x60,0x1CC,0x63,0xC5,0x1D0,0xBE,0x1D2,0x65,0x1D4,0x67,0x6B,0x1D6,0x69,0x1DC,0x1DA,0x1DE,0x1E0,0x1E2,0xC9,0x6D,0x29,
    0x1E4,0x71,0x1E6,0x6F,0x1EA,0x1E8,0x2A,0x2B,0x2C,0x2D,0x73,0x75,0xF7,0x2E,0x269,0x77,0xAA,0xDD,0xDF,0xA2,0x267,0xC0,
    0x1F4,0x1F6,0x79,0x1F8,0x7D,0xE1,0xE3,0x1FA,0x7B,0x1FE,0x7F,0x81,0x200,0x85,0x202,0xE9,0x83,0x20A,0x236,0x89,0x20C,
    0xEB,0x87,0x210,0x20E,0x2F,0x30,0x31,0x8B,0x8D,0x8F,0x32,0x281,0x91,0x93,0xAC,0xE5,0xE7,0xA4,0x27F,0x212,0x95,0x216,
    0x214,0x21C,0x21E,0x220,0x222,0x97,0x226,0x224,0x237,0x228,0x22A,0x22C,0x28D,0x33,0x99,0x293,0xFB,0x22E,0x34,0x291,
    0x238,0x28F,0x9C,0x230,0x9E,0xA0,0x232,0x234,0x36B,0x102,0x343,0x240,0x23E,0x244,0x242,0xB5,0xCA,0xCC,0xB9,0x1A7,
    0x25A,0x258,0x25E,0x25C,0x1CD,0x26C,0x26A,0x270,0x26E,0x1EB,0xF4,0x1ED,0xF2,0xCE,0xB3,0xAF,0xAD,0xB1,0x241,0x23F,
    0x245,0x243,0xB6,0xCB,0xCD,0xBA,0x1A8,0x25B,0x259,0x25F,0x25D,0x1CE,0x26D,0x26B,0x271,0x26F,0x1EC,0xF5,0x1EE,0xF3,
    0xCF,0xB4,0xB0,0xAE,0xB2,0x24A,0x248,0x24E,0x24C,0x24B,0x249,0x24F,0x24D,0x1B3,0x1B5,0x1B4,0x1B6,0x1EF,0x1F1,0x1F0,
    0x1F2,0x203,0x204,0x205,0x206,0x217,0x218,0x219,0x21A,0x239,0x276,0x274,0x27A,0x278,0x27C,0x277,0x275,0x27B,0x279,
    0x27D,0x284,0x282,0x288,0x286,0x28A,0x285,0x283,0x289,0x287,0x28B,0xC3,0xC1,0xC2,0xB7,0xB8,0x1BB,0x1BC,0xF8,0xF9,
    0xC4,0x33F,0x103,0x33E,0x33D,0x29C,0x29D,0x341,0x349,0x105,0x2AA,0x2AB,0x34B,0x106,0x2B8,0x2B9,0x34D,0x359,0x107,
    0x358,0x357,0x10C,0x2C8,0x2C9,0x373,0x108,0x2D6,0x2D7,0x36A,0x368,0x109,0x367,0x366,0x10D,0x2E4,0x375,0x10A,0x2F0,
    0x2F1,0x377,0x33A,0x346,0x2F8,0x10E,0x337,0x336,0x294,0x295,0x33B,0x339,0x2FA,0x10F,0x2A4,0x2A5,0x2FC,0x110,0x2B0,
    0x2B1,0x347,0x345,0x2FE,0x111,0x352,0x351,0x113,0x2C0,0x2C1,0x355,0x300,0x115,0x2D0,0x2D1,0x362,0x363,0x302,0x116,
    0x35F,0x35E,0x114,0x2DC,0x2DD,0x364,0x304,0x117,0x2E8,0x2E9,0x371,0x36F,0x353,0x10B,0x356,0x360,0x112,0x365,0x370,
    0x118,0x119,0x11D,0x12E,0x130,0x11C,0x11A,0x132,0x11B,0x12C,0x136,0x138,0x11F,0x13A,0x121,0x13C,0x11E,0x13E,0x144,
    0x120,0x146,0x148,0x14A,0x14C,0x142,0x12F,0x131,0x125,0x123,0x133,0x124,0x12D,0x137,0x139,0x128,0x13B,0x122,0x13D,
    0x127,0x13F,0x145,0x129,0x147,0x149,0x14B,0x14D,0x143,0x126,0x12A,0x12B,0x134,0x135,0x140,0x141,0x14E,0x14F,0x151,
    0x150,0x152,0x154,0x155,0x153,0x156,0x157,0x158,0x161,0x162,0x16D,0x16C,0x16E,0x171,0x172,0x174,0x173,0x175,0x176,
    0x179,0x177,0x178,0x17A,0x17B,0x17D,0x17C,0x17E,0x17F,0x181,0x180,0x193,0x194,0x195,0x196,0x197,0x198,0x199,0x19A,
    0x19B,0x19C,0x19D,0x19E,0x1D7,0x1D8,0x1FB,0x1FC,0x207,0x208,0x246,0x250,0x247,0x251,0x260,0x261,0x272,0x273,0x296,
    0x298,0x29A,0x306,0x297,0x299,0x29B,0x307,0x308,0x309,0x30A,0x30B,0x30C,0x30D,0x29E,0x2A0,0x2A2,0x30E,0x29F,0x2A1,
    0x2A3,0x30F,0x310,0x311,0x312,0x313,0x314,0x315,0x2A6,0x2A8,0x2A7,0x2A9,0x2AC,0x2AE,0x2AD,0x2AF,0x2B2,0x2B4,0x2B6,
    0x316,0x2B3,0x2B5,0x2B7,0x317,0x318,0x319,0x31A,0x31B,0x31C,0x31D,0x2BA,0x2BC,0x2BE,0x31E,0x2BB,0x2BD,0x2BF,0x31F,
    0x320,0x321,0x322,0x323,0x324,0x325,0x2C2,0x2C4,0x2C6,0x2C3,0x2C5,0x2C7,0x2CA,0x2CC,0x2CE,0x2CB,0x2CD,0x2CF,0x2D2,
    0x2D4,0x2D3,0x2D5,0x2D8,0x2DA,0x2D9,0x2DB,0x2DE,0x2E0,0x2E2,0x2DF,0x2E1,0x2E3,0x2E5,0x2E6,0x2E7,0x2EA,0x2EC,0x2EE,
    0x326,0x2EB,0x2ED,0x2EF,0x327,0x328,0x329,0x32A,0x32B,0x32C,0x32D,0x2F2,0x2F4,0x2F6,0x32E,0x2F3,0x2F5,0x2F7,0x32F,
    0x330,0x331,0x332,0x333,0x334,0x335,0x338,0x344,0x36E,0x33C,0x34E,0x34F,0x350,0x348,0x372,0x35B,0x35C,0x35D,0x37E,
    0x37F,0x380,0x381,0x383,0x382,0x384,0x385,0x386,0x387,0x388,0x389,0x38A,0x38B,0x38C,0x38F,0x38E,0x392,0x393,0x394,
    0x395,0x396,0x397,0x398,0x399,0x3A2,0x3A3,0x39A,0x39B,0x39C,0x39D,0x3A4,0x3A5,0x39E,0x39F,0x3A0,0x3A1,0x3A6,0x3A7,
    0x3A8,0x3A9,0x3C6,0x3AD,0x3AE,0x3AF,0x3B0,0x3B1,0x3B2,0x3B3,0x3B4,0x3B5,0x3B6,0x3B7,0x3B8,0x3B9,0x3BA,0x3BB,0x3BC,
    0x3BD,0x3BE,0x3BF,0x3C0,0x3C1,0x3C2,0x3C3,0x3C4,0x3C5,0x3C7,0x3E1,0x3C8,0x3C9,0x3CA,0x3CB,0x3CC,0x3CD,0x3CE,0x3CF,
    0x3D0,0x3D1,0x3D2,0x3D3,0x3D4,0x3D5,0x3D6,0x3D7,0x3D8,0x3D9,0x3DA,0x3DB,0x3DC,0x3DD,0x3DE,0x3DF,0x3E0,0x3E2,0x3E3,
    0x3E4,0x3E5,0x3E6,0x5D5,0x5D6,0x5D7,0x5D8,0x5D9,0x5DA,0x5DB,0x5DD,0x5DC,0x5DE,0x5DF,0x5E0,0x5E1,
};

/// NFKC of U+FF5F ... U+FFEF; 0 for U+FFE3, which becomes U+0020 U+0304.
inline constexpr std::uint16_t narrow_forms[] = {
    0x2985,0x2986,0x3002,0x300C,0x300D,0x3001,0x30FB,0x30F2,0x30A1,0x30A3,0x30A5,0x30A7,0x30A9,0x30E3,0x30E5,0x30E7,
    0x30C3,0x30FC,0x30A2,0x30A4,0x30A6,0x30A8,0x30AA,0x30AB,0x30AD,0x30AF,0x30B1,0x30B3,0x30B5,0x30B7,0x30B9,0x30BB,
    0x30BD,0x30BF,0x30C1,0x30C4,0x30C6,0x30C8,0x30CA,0x30CB,0x30CC,0x30CD,0x30CE,0x30CF,0x30D2,0x30D5,0x30D8,0x30DB,
    0x30DE,0x30DF,0x30E0,0x30E1,0x30E2,0x30E4,0x30E6,0x30E8,0x30E9,0x30EA,0x30EB,0x30EC,0x30ED,0x30EF,0x30F3,0x3099,
    0x309A,0x1160,0x1100,0x1101,0x11AA,0x1102,0x11AC,0x11AD,0x1103,0x1104,0x1105,0x11B0,0x11B1,0x11B2,0x11B3,0x11B4,
    0x11B5,0x111A,0x1106,0x1107,0x1108,0x1121,0x1109,0x110A,0x110B,0x110C,0x110D,0x110E,0x110F,0x1110,0x1111,0x1112,
    0xFFBF,0xFFC0,0xFFC1,0x1161,0x1162,0x1163,0x1164,0x1165,0x1166,0xFFC8,0xFFC9,0x1167,0x1168,0x1169,0x116A,0x116B,
    0x116C,0xFFD0,0xFFD1,0x116D,0x116E,0x116F,0x1170,0x1171,0x1172,0xFFD8,0xFFD9,0x1173,0x1174,0x1175,0xFFDD,0xFFDE,
    0xFFDF,0xA2,0xA3,0xAC,0,0xA6,0xA5,0x20A9,0xFFE7,0x2502,0x2190,0x2191,0x2192,0x2193,0x25A0,0x25CB,0xFFEF,
};

}  // namespace motionlang::inline MOTIONLANG_ABI::detail
// clang-format on
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// Bits of `char_class`.
namespace CharClass {
inline constexpr unsigned letter = 1;            // L*
inline constexpr unsigned number = 2;            // N*
inline constexpr unsigned punctuation = 4;       // P*
inline constexpr unsigned nonspacing_mark = 8;   // Mn
inline constexpr unsigned other = 16;            // Cc, Cf, Cs, Co; not Cn, the unassigned
inline constexpr unsigned white_space = 32;      // White_Space
inline constexpr unsigned cased = 64;            // Cased
inline constexpr unsigned case_ignorable = 128;  // Case_Ignorable
}  // namespace CharClass

namespace detail {

/// The row of a table of disjoint stretches, ordered by `first`, that holds c; null if none does.
template <class Run>
constexpr const Run* find_run(std::span<const Run> table, char32_t c) {
  const auto after =
      std::upper_bound(table.begin(), table.end(), c, [](char32_t x, const Run& run) { return x < run.first; });
  return after != table.begin() && c <= (after - 1)->last ? &*(after - 1) : nullptr;
}

constexpr unsigned searched_class(char32_t c) {
  const std::span<const std::uint32_t> runs(class_runs);
  return *(std::upper_bound(runs.begin(), runs.end(), c << 8 | 255u) - 1) & 255u;
}
inline constexpr auto first_classes = [] {
  std::array<std::uint8_t, 256> classes{};
  for (char32_t c = 0; c < 256; ++c) classes[c] = static_cast<std::uint8_t>(searched_class(c));
  return classes;
}();

}  // namespace detail

/// The classes that a code point belongs to, bits of CharClass.
constexpr unsigned char_class(char32_t c) {
  return c < 256 ? detail::first_classes[c] : c <= 0x10FFFF ? detail::searched_class(c) : 0u;
}

/// Simple lower case; U+0130 gives i (its full lower case is i, U+0307).
constexpr char32_t lower_case(char32_t c) {
  if (c < 0x80) return c >= 'A' && c <= 'Z' ? c + 32 : c;
  const auto* run = detail::find_run<detail::LowerRun>(detail::lower_runs, c);
  if (run == nullptr || (c - run->first) % run->step != 0) return c;
  return static_cast<char32_t>(static_cast<std::int32_t>(c) + run->difference);
}

/// Canonical_Combining_Class.
constexpr unsigned combining_class(char32_t c) {
  const auto* run = c < 0x300 ? nullptr : detail::find_run<detail::CombiningRun>(detail::combining_runs, c);
  return run == nullptr ? 0 : run->combining;
}

/// Bytes that are not UTF-8 become U+FFFD, one for each.
inline std::u32string to_utf32(std::string_view text) {
  std::u32string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = decode_utf8(text, at);
    out += c == invalid_code_point ? U'\uFFFD' : c;
  }
  return out;
}
inline std::string to_utf8(std::u32string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char32_t c : text) append_utf8(out, c);
  return out;
}

namespace detail {

inline constexpr char32_t hangul = 0xAC00, jamo_l = 0x1100, jamo_v = 0x1161, jamo_t = 0x11A7;
inline constexpr char32_t jamo_v_count = 21, jamo_t_count = 28, hangul_count = 19 * jamo_v_count * jamo_t_count;

inline void append_decomposed(std::u32string& out, char32_t c) {
  if (c < 0xC0) {
    out += c;
  } else if (c - hangul < hangul_count) {
    const char32_t s = c - hangul, t = s % jamo_t_count;
    out += jamo_l + s / (jamo_v_count * jamo_t_count);
    out += jamo_v + s / jamo_t_count % jamo_v_count;
    if (t != 0) out += jamo_t + t;
  } else {
    const std::span<const Decomposition> table(decompositions);
    const auto found = std::lower_bound(table.begin(), table.end(), c,
                                        [](const Decomposition& d, char32_t x) { return d.composed < x; });
    if (found == table.end() || found->composed != c) {
      out += c;
      return;
    }
    append_decomposed(out, found->first);
    if (found->second != 0) append_decomposed(out, found->second);
  }
}

/// The composition of two code points, 0 if there is none.
inline char32_t composed(char32_t first, char32_t second) {
  if (first - jamo_l < 19 && second - jamo_v < jamo_v_count)
    return hangul + ((first - jamo_l) * jamo_v_count + (second - jamo_v)) * jamo_t_count;
  if (first - hangul < hangul_count && (first - hangul) % jamo_t_count == 0 && second - jamo_t - 1 < jamo_t_count - 1)
    return first + (second - jamo_t);
  const std::span<const std::uint16_t> table(compositions);
  const auto before = [&](std::uint16_t i, char32_t) {
    const Decomposition& d = decompositions[i];
    return d.first < first || (d.first == first && d.second < second);
  };
  const auto found = std::lower_bound(table.begin(), table.end(), first, before);
  if (found == table.end()) return 0;
  const Decomposition& d = decompositions[*found];
  return d.first == first && d.second == second ? d.composed : 0;
}

}  // namespace detail

/// Canonical decomposition with marks in canonical order.
inline std::u32string nfd(std::u32string_view text) {
  if (std::all_of(text.begin(), text.end(), [](char32_t c) { return c < 0xC0; })) return std::u32string(text);
  std::u32string out;
  out.reserve(text.size());
  for (const char32_t c : text) detail::append_decomposed(out, c);
  for (std::size_t at = 0; at < out.size();) {
    std::size_t end = at;
    while (end < out.size() && combining_class(out[end]) != 0) ++end;
    std::stable_sort(out.begin() + static_cast<std::ptrdiff_t>(at), out.begin() + static_cast<std::ptrdiff_t>(end),
                     [](char32_t a, char32_t b) { return combining_class(a) < combining_class(b); });
    at = end + 1;
  }
  return out;
}

/// Canonical composition.
inline std::u32string nfc(std::u32string_view text) {
  if (std::all_of(text.begin(), text.end(), [](char32_t c) { return c < 0x300; })) return std::u32string(text);
  std::u32string out = nfd(text);
  std::size_t size = 0, starter = 0;
  bool has_starter = false;
  unsigned last = 0;  // class of the last character kept behind the starter; 0: none, or another starter
  for (const char32_t c : out) {
    const unsigned combining = combining_class(c);
    // c can be reached from the starter if nothing between them has its class or is a starter itself
    const bool adjacent = size == starter + 1;
    if (has_starter && (adjacent || (last != 0 && last < combining))) {
      if (const char32_t both = detail::composed(out[starter], c); both != 0) {
        out[starter] = both;
        continue;
      }
    }
    if (combining == 0) starter = size, has_starter = true;
    last = combining;
    out[size++] = c;
  }
  out.resize(size);
  return out;
}

/// Full lower case without a language: U+0130 becomes i, U+0307, and where `final_sigma` is set a capital sigma at the end of a
/// word U+03C2.
inline std::u32string lower_case(std::u32string_view text, bool final_sigma = true) {
  std::u32string out;
  out.reserve(text.size());
  bool after_cased = false;  // the last character that is not case-ignorable is cased
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char32_t c = text[i];
    if (c == 0x130) {
      out += U"i\u0307";
    } else if (c == 0x3A3 && final_sigma && after_cased) {
      std::size_t next = i + 1;
      while (next < text.size() && (char_class(text[next]) & CharClass::case_ignorable) != 0) ++next;
      const bool inside = next < text.size() && (char_class(text[next]) & CharClass::cased) != 0;
      out += inside ? U'\u03C3' : U'\u03C2';
    } else {
      out += lower_case(c);
    }
    if (const unsigned k = char_class(c); (k & CharClass::case_ignorable) == 0)
      after_cased = (k & CharClass::cased) != 0;
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_WORD_PIECE_HPP  // <motionlang/text/word_piece.hpp>
#define MOTIONLANG_HAS_TEXT_WORD_PIECE_HPP
/// A small word-piece tokenizer whose vocabulary is learnt from the captions of a training set.
///
/// For plain captions: ASCII letters are lowered, everything that is neither letter nor digit separates words. The tokenizers of
/// BERT and CLIP, with their Unicode rules, are other headers.

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Splits a word from the left into the longest known pieces and appends their ids; `unknown` alone if that fails.
/// find(text, first) is the id of a piece that begins the word (first) or continues it, -1 if there is none.
template <class Find>
void append_longest_pieces(std::vector<Index>& ids, std::string_view word, std::size_t longest, Index unknown, Find find) {
  const std::size_t before = ids.size();
  for (std::size_t at = 0; at < word.size();) {
    std::size_t length = std::min(word.size() - at, longest);
    Index id = -1;
    for (; length > 0 && (id = find(word.substr(at, length), at == 0)) < 0; --length) {}
    if (id < 0) {
      ids.resize(before);
      ids.push_back(unknown);
      return;
    }
    ids.push_back(id);
    at += length;
  }
}

}  // namespace detail

/// Pieces that continue a word begin with "##". The first three ids are fixed.
class WordPiece {
 public:
  static constexpr Index begin_id = 0, end_id = 1, unknown_id = 2;

  WordPiece() = default;
  /// Throws config_error 107 unless the vocabulary begins with [CLS], [SEP], [UNK] and has no piece twice; `source` stands in
  /// messages.
  explicit WordPiece(std::vector<std::string> vocabulary, std::string_view source = "WordPiece")
      : pieces_(std::move(vocabulary)) {
    if (pieces_.size() < 3 || pieces_[0] != "[CLS]" || pieces_[1] != "[SEP]" || pieces_[2] != "[UNK]") {
      raise<config_error>(107, source, ": a vocabulary of ", pieces_.size(),
                          " pieces does not begin with [CLS], [SEP], [UNK]");
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!ids_.emplace(pieces_[i], static_cast<Index>(i)).second)
        raise<config_error>(107, source, ": piece '", pieces_[i], "' stands twice");
      longest_ = std::max(longest_, pieces_[i].size());
    }
  }

  /// Learns a vocabulary: all letters, then the merges with the largest count(ab) / (count(a) count(b)) that occur at least
  /// `least` times, until `size` pieces; ties go to the alphabetically first.
  /// Source  the WordPiece criterion as described for BERT (Schuster and Nakajima 2012)
  static WordPiece learn(std::span<const std::string> texts, Index size, Index least = 2) {
    std::map<std::string, Index> counts;
    for (const std::string& t : texts) {
      for (const std::string& w : words(t)) ++counts[w];
    }
    struct Word {
      std::vector<std::string> pieces;
      Index count;
    };
    std::vector<Word> split;
    std::vector<std::string> vocabulary{"[CLS]", "[SEP]", "[UNK]"};
    std::map<std::string, Index> known;
    for (const auto& [word, count] : counts) {
      Word w{{}, count};
      for (std::size_t i = 0; i < word.size(); ++i) w.pieces.push_back((i == 0 ? "" : "##") + word.substr(i, 1));
      for (const auto& p : w.pieces) known[p] += count;
      split.push_back(std::move(w));
    }
    for (const auto& [piece, count] : known) vocabulary.push_back(piece);
    while (static_cast<Index>(vocabulary.size()) < size) {
      std::map<std::string, Index> single;
      std::map<std::pair<std::string, std::string>, Index> pairs;
      for (const Word& w : split) {
        for (std::size_t i = 0; i < w.pieces.size(); ++i) {
          single[w.pieces[i]] += w.count;
          if (i + 1 < w.pieces.size()) pairs[{w.pieces[i], w.pieces[i + 1]}] += w.count;
        }
      }
      double best_score = 0;
      std::pair<std::string, std::string> best;
      for (const auto& [pair, count] : pairs) {
        if (count < least) continue;
        const double score = static_cast<double>(count) /
                             (static_cast<double>(single[pair.first]) * static_cast<double>(single[pair.second]));
        if (score > best_score) best_score = score, best = pair;
      }
      if (best_score == 0) break;
      const std::string merged = best.first + best.second.substr(2);
      for (Word& w : split) {
        for (std::size_t i = 0; i + 1 < w.pieces.size(); ++i) {
          if (w.pieces[i] != best.first || w.pieces[i + 1] != best.second) continue;
          w.pieces[i] = merged;
          w.pieces.erase(w.pieces.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        }
      }
      vocabulary.push_back(merged);
    }
    return WordPiece(std::move(vocabulary));
  }

  const std::vector<std::string>& vocabulary() const { return pieces_; }
  Index size() const { return static_cast<Index>(pieces_.size()); }

  /// [CLS] pieces [SEP], at most `longest` ids; every word is split greedily into the longest known pieces, a word that cannot be
  /// split is [UNK].
  std::vector<Index> encode(std::string_view text, Index longest = 64) const {
    std::vector<Index> ids{begin_id};
    for (const std::string& w : words(text)) append_word(ids, w);
    if (static_cast<Index>(ids.size()) > longest - 1) ids.resize(static_cast<std::size_t>(longest - 1));
    ids.push_back(end_id);
    return ids;
  }

  /// Lower-case runs of letters and digits.
  static std::vector<std::string> words(std::string_view text) {
    std::vector<std::string> out;
    bool inside = false;
    for (char c : text) {
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
      const bool part = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
      if (part && !inside) out.emplace_back();
      if (part) out.back() += c;
      inside = part;
    }
    return out;
  }

 private:
  void append_word(std::vector<Index>& ids, const std::string& word) const {
    detail::append_longest_pieces(ids, word, longest_, unknown_id, [&](std::string_view part, bool first) {
      const auto found = ids_.find((first ? "" : "##") + std::string(part));
      return found == ids_.end() ? Index{-1} : found->second;
    });
  }

  std::vector<std::string> pieces_;
  std::unordered_map<std::string, Index> ids_;
  std::size_t longest_ = 0;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

struct BertTokenizerOptions {
  bool clean_text = true;  // drops control characters, any white space is a blank
  bool split_cjk = true;   // every ideograph is a word
  bool lower_case = true;
  std::optional<bool> strip_accents;  // unless set: as lower_case
  std::string begin = "[CLS]", end = "[SEP]", unknown = "[UNK]", pad = "[PAD]";
  std::string continuation = "##";  // in front of a piece that continues a word
  Index longest_word = 100;         // code points; a longer word is unknown
  /// Strings that are their own ids, in the order of preference; those that the vocabulary lacks are left out.
  std::vector<std::string> special{"[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]"};
  bool pair_has_types = true;      // the second text of a pair has token type 1
  bool pair_has_two_ends = false;  // between the texts of a pair stands the end twice
  Index longest = 512;             // ids of a text with its frame, as many as the network has positions
  bool truncate = false;           // a longer text is cut, else refused

  /// Of all-mpnet-base-v2.
  static BertTokenizerOptions mpnet() {
    BertTokenizerOptions o;
    o.begin = "<s>", o.end = "</s>", o.pad = "<pad>";
    o.special = {"<s>", "<pad>", "</s>", "<unk>", "[UNK]", "<mask>"};
    o.pair_has_types = false, o.pair_has_two_ends = true;
    return o;
  }
};

/// The vocabulary of MPNet from that of BERT: four marks before it, one behind it.
inline std::vector<std::string> mpnet_vocabulary(std::span<const std::string> bert) {
  std::vector<std::string> out{"<s>", "<pad>", "</s>", "<unk>"};
  out.insert(out.end(), bert.begin(), bert.end());
  out.emplace_back("<mask>");
  return out;
}

class BertTokenizer {
 public:
  /// vocabulary   the piece of every id
  /// added        instead of options.special, as a tokenizer.json lists them
  /// Throws       config_error 107, naming `source`: a piece stands twice, is empty or not UTF-8, or begin, end or unknown is
  ///              no piece; 101 if options.longest leaves no room for a text
  explicit BertTokenizer(std::vector<std::string> vocabulary, BertTokenizerOptions options = {},
                         std::string_view source = "BertTokenizer", std::optional<std::vector<AddedToken>> added = {})
      : options_(std::move(options)), pieces_(std::make_shared<const std::vector<std::string>>(std::move(vocabulary))) {
    index_pieces(source);
    begin_ = required(options_.begin, source), end_ = required(options_.end, source);
    unknown_ = required(options_.unknown, source);
    using enum FramePart::Kind;
    const Index second = options_.pair_has_types ? 1 : 0;
    single_ = {{token, begin_, 0}, {text_a}, {token, end_, 0}};
    pair_ = {{token, begin_, 0}, {text_a}, {token, end_, 0}};
    if (options_.pair_has_two_ends) pair_.push_back({token, end_, 0});
    pair_.insert(pair_.end(), {{text_b, 0, second}, {token, end_, second}});
    set_added(added ? std::move(*added) : specials(), source);
    require_room(source);
  }

  const BertTokenizerOptions& options() const { return options_; }
  const std::vector<std::string>& vocabulary() const { return *pieces_; }
  Index size() const { return static_cast<Index>(pieces_->size()); }
  /// The id of a piece as the vocabulary writes it ("walk", "##ing"); none if there is no such piece.
  std::optional<Index> id(std::string_view piece) const {
    const bool continues = !options_.continuation.empty() && piece.starts_with(options_.continuation);
    if (continues) piece.remove_prefix(options_.continuation.size());
    const Index found = find(piece, !continues);
    return found < 0 ? std::nullopt : std::optional(found);
  }
  /// Throws config_error 103 if the vocabulary has no piece for padding.
  Index pad_id() const {
    if (const auto found = id(options_.pad)) return *found;
    raise<config_error>(103, "BertTokenizer: the vocabulary has no piece '", options_.pad, "' for padding");
  }

  /// Other frames than the options make. Throws config_error 107 for ids that are no pieces, 101 as the constructor.
  void set_frames(std::vector<FramePart> single, std::vector<FramePart> pair, std::string_view source) {
    for (const auto* frame : {&single, &pair}) {
      for (const FramePart& part : *frame) {
        if (part.kind == FramePart::token) require_id(part.id, source);
      }
    }
    single_ = std::move(single), pair_ = std::move(pair);
    require_room(source);
  }

  /// The framed ids of a text. Throws config_error 101 if they are more than options().longest and may not be cut.
  std::vector<Index> encode(std::string_view text) const {
    return detail::framed_text("BertTokenizer", single_, encode_words(text), options_.longest, options_.truncate);
  }
  /// Two texts in one frame; never cut.
  TokenPair encode_pair(std::string_view a, std::string_view b) const {
    return detail::framed_pair("BertTokenizer", pair_, encode_words(a), encode_words(b), options_.longest);
  }
  /// Without a frame, of any length.
  std::vector<Index> encode_words(std::string_view text) const {
    std::vector<Index> ids;
    const auto special = [&](Index id) { ids.push_back(id); };
    raw_.split(
        text,
        [&](std::string_view part) {
          const std::string clean = normalized(part);
          if (normalized_.empty()) return append_words(ids, clean);
          normalized_.split(
              clean, [&](std::string_view words) { append_words(ids, words); }, special);
        },
        special);
    return ids;
  }

  /// The words that ids spell, separated by blanks; special tokens are left out. Throws shape_error 203 for an id that is none.
  std::string decode(std::span<const Index> ids) const {
    std::string out;
    for (const Index id : ids) {
      if (id < 0 || id >= size()) raise<shape_error>(203, "BertTokenizer: id ", id, " of ", size());
      if (raw_.has(id) || normalized_.has(id) || id == begin_ || id == end_) continue;
      std::string_view piece = (*pieces_)[static_cast<std::size_t>(id)];
      if (!options_.continuation.empty() && piece.starts_with(options_.continuation) && !out.empty())
        piece.remove_prefix(options_.continuation.size());
      else if (!out.empty())
        out += ' ';
      out += piece;
    }
    return out;
  }

  /// The text of which words are taken: cleaned, ideographs apart, without accents, in lower case, as the options say.
  std::string normalized(std::string_view text) const {
    std::string out;
    out.reserve(text.size());
    for (const char byte : text) {
      const auto c = static_cast<unsigned char>(byte);
      if (c >= 0x80) return normalized_unicode(text);
      const unsigned k = detail::first_classes[c];
      if (options_.clean_text && (k & (CharClass::other | CharClass::white_space)) != 0) {
        if (is_blank(c, k)) out += ' ';
        continue;
      }
      out += options_.lower_case ? static_cast<char>(lower_case(char32_t{c})) : byte;
    }
    return out;
  }

 private:
  /// Of a character that is white space or belongs to Other: whether it separates words. The others vanish.
  static bool is_blank(char32_t c, unsigned k) {
    return c == '\t' || c == '\n' || c == '\r' || (k & CharClass::other) == 0;
  }
  static bool is_cjk(char32_t c) {
    constexpr char32_t ranges[][2] = {{0x3400, 0x4DBF},   {0x4E00, 0x9FFF},   {0xF900, 0xFAFF},   {0x20000, 0x2A6DF},
                                      {0x2A700, 0x2B73F}, {0x2B740, 0x2B81F}, {0x2B920, 0x2CEAF}, {0x2F800, 0x2FA1F}};
    return std::any_of(std::begin(ranges), std::end(ranges), [&](const auto& r) { return c >= r[0] && c <= r[1]; });
  }
  /// ASCII symbols count as punctuation.
  static bool is_punctuation(char32_t c, unsigned k) {
    if (c < 0x80) return c > 0x20 && c < 0x7F && (k & (CharClass::letter | CharClass::number)) == 0;
    return (k & CharClass::punctuation) != 0;
  }

  std::string normalized_unicode(std::string_view text) const {
    std::u32string clean;
    for (const char32_t c : to_utf32(text)) {
      const unsigned k = char_class(c);
      if (options_.clean_text && (c == 0xFFFD || (k & (CharClass::other | CharClass::white_space)) != 0)) {
        if (c != 0xFFFD && is_blank(c, k)) clean += U' ';
      } else if (options_.split_cjk && is_cjk(c)) {
        clean += {U' ', c, U' '};
      } else {
        clean += c;
      }
    }
    if (options_.strip_accents.value_or(options_.lower_case)) {
      clean = nfd(clean);
      std::erase_if(clean, [](char32_t c) { return (char_class(c) & CharClass::nonspacing_mark) != 0; });
    }
    return to_utf8(options_.lower_case ? lower_case(clean, false) : clean);
  }

  void append_words(std::vector<Index>& ids, std::string_view text) const {
    std::size_t begin = 0;
    Index letters = 0;  // of the word that begins there, in code points
    const auto flush = [&](std::size_t end) {
      if (letters > options_.longest_word) {
        ids.push_back(unknown_);
      } else if (letters > 0) {
        detail::append_longest_pieces(ids, text.substr(begin, end - begin), longest_, unknown_,
                                      [&](std::string_view part, bool first) { return find(part, first); });
      }
      letters = 0;
    };
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t start = at;
      const char32_t c = decode_utf8(text, at);
      const unsigned k = char_class(c);
      const bool alone = is_punctuation(c, k);
      if (!alone && (k & CharClass::white_space) == 0) {
        if (letters++ == 0) begin = start;
        continue;
      }
      flush(start);
      if (!alone) continue;
      begin = start, letters = 1;
      flush(at);
    }
    flush(text.size());
  }

  Index find(std::string_view part, bool first) const {
    const auto& ids = first ? starts_ : continuations_;
    const auto found = ids.find(part);
    return found == ids.end() ? Index{-1} : found->second;
  }

  void index_pieces(std::string_view source) {
    for (std::size_t i = 0; i < pieces_->size(); ++i) {
      std::string_view piece = (*pieces_)[i];
      if (piece.empty() || !is_utf8(piece))
        raise<config_error>(107, source, ": piece ", i, piece.empty() ? " is empty" : " is not UTF-8");
      const bool continues = !options_.continuation.empty() && piece.starts_with(options_.continuation);
      if (continues) piece.remove_prefix(options_.continuation.size());
      if (!(continues ? continuations_ : starts_).emplace(piece, static_cast<Index>(i)).second)
        raise<config_error>(107, source, ": piece '", (*pieces_)[i], "' stands twice, the second time as id ", i);
      longest_ = std::max(longest_, piece.size());
    }
  }
  Index required(const std::string& piece, std::string_view source) const {
    if (const auto found = id(piece)) return *found;
    raise<config_error>(107, source, ": a vocabulary of ", size(), " pieces lacks '", piece, "'");
  }
  void require_id(Index id, std::string_view source) const {
    if (id < 0 || id >= size()) raise<config_error>(107, source, ": id ", id, " among ", size(), " pieces");
  }
  void require_room(std::string_view source) const {
    const std::size_t frame = std::max(detail::frame_size(single_), detail::frame_size(pair_));
    if (options_.longest < static_cast<Index>(frame))
      raise<config_error>(101, source, ": at most ", options_.longest, " ids, the frame has ", frame);
  }
  std::vector<AddedToken> specials() const {
    std::vector<AddedToken> out;
    for (const std::string& piece : options_.special) {
      if (const auto found = id(piece)) out.push_back({piece, *found});
    }
    return out;
  }
  void set_added(std::vector<AddedToken> tokens, std::string_view source) {
    std::vector<AddedToken> before, after;
    for (AddedToken& t : tokens) {
      require_id(t.id, source);
      if (t.normalized) t.content = normalized(t.content);
      (t.normalized ? after : before).push_back(std::move(t));
    }
    raw_ = detail::AddedTokenSearch(std::move(before));
    normalized_ = detail::AddedTokenSearch(std::move(after));
  }

  BertTokenizerOptions options_;
  std::shared_ptr<const std::vector<std::string>> pieces_;
  std::unordered_map<std::string_view, Index> starts_, continuations_;  // views into *pieces_
  std::size_t longest_ = 0;                                             // bytes of a piece
  Index begin_ = 0, end_ = 0, unknown_ = 0;
  std::vector<FramePart> single_, pair_;
  detail::AddedTokenSearch raw_, normalized_;
};

static_assert(Tokenizer<BertTokenizer>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_CAPTION_ENCODER_HPP  // <motionlang/text/caption_encoder.hpp>
#define MOTIONLANG_HAS_TEXT_CAPTION_ENCODER_HPP
/// A small text encoder of our own: word pieces, a transformer, one vector per caption. Below 2 MB, so that it can come with a
/// motion model and be trained together with it.

#ifndef MOTIONLANG_HAS_TEXT_TEXT_ENCODER_HPP  // <motionlang/text/text_encoder.hpp>
#define MOTIONLANG_HAS_TEXT_TEXT_ENCODER_HPP
/// The concept of a text encoder.

namespace motionlang::inline MOTIONLANG_ABI {

/// Turns texts into vectors: one sequence of tokens for each, a single row if it pools.
/// Laws     a text gives the same features alone and among others; "" is a text like any other
/// Models   CaptionEncoder, and yours
template <class E, class B>
concept TextEncoder = requires(const E& e, std::span<const std::string> texts) {
  { e.template encode<B>(texts) } -> std::same_as<TextFeatures<B>>;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

struct CaptionEncoderConfig {
  Index width = 128;
  Index heads = 4;
  Index d_ff = 256;
  Index layers = 2;
  Index out = 128;
  double dropout = 0.1;
  Index longest = 64;  // word pieces of a caption, with begin and end
};

/// Pieces -> embedding + positions -> pre-norm transformer -> norm -> the row of [CLS] -> linear.
template <Backend B>
struct CaptionEncoder {
  Embedding<B> embedding;
  TransformerEncoder<B> encoder;
  LayerNorm<B> norm;
  Linear<B> projection;
  PositionTable<B> positions;
  WordPiece tokenizer;

  static constexpr auto fields() {
    using M = CaptionEncoder;
    return motionlang::fields("embedding", &M::embedding, "encoder", &M::encoder, "norm", &M::norm, "projection",
                              &M::projection, "positions", &M::positions, "tokenizer", &M::tokenizer);
  }
  CaptionEncoder() = default;
  CaptionEncoder(const CaptionEncoderConfig& c, WordPiece pieces, Rng auto& rng)
      : embedding(pieces.size(), c.width, rng, 0.5),
        encoder({.d_model = c.width,
                 .heads = c.heads,
                 .d_ff = c.d_ff,
                 .layers = c.layers,
                 .norm_first = true,
                 .dropout = c.dropout},
                rng),
        norm(c.width),
        projection(c.width, c.out, rng),
        positions(c.longest, c.width),
        tokenizer(std::move(pieces)) {}

  /// (texts, out)
  Tensor<B, 2> operator()(std::span<const std::string> texts, const Context& context = {}) const {
    std::vector<Index> ids, lengths, first;
    for (const std::string& t : texts) {
      const auto pieces = tokenizer.encode(t, positions.rows().size(0));
      first.push_back(static_cast<Index>(ids.size()));
      ids.insert(ids.end(), pieces.begin(), pieces.end());
      lengths.push_back(static_cast<Index>(pieces.size()));
    }
    const auto tokens = add_positions(Sequences<B>(embedding(ids), Offsets(lengths)), positions.rows());
    return projection(norm(gather(encoder(tokens, context).rows, first)));
  }
  template <Backend C>
  requires std::same_as<C, B> TextFeatures<C> encode(std::span<const std::string> texts)
  const { return TextFeatures<C>::pooled((*this)(texts)); }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_CLIP_TEXT_HPP  // <motionlang/text/clip_text.hpp>
#define MOTIONLANG_HAS_TEXT_CLIP_TEXT_HPP
/// The text tower of CLIP.
///
///     const ClipText<B> network = load_clip_text<B>(weights);                       // io/text_network_file.hpp
///     const auto text = network(network.until_end(tokenize(tokenizer, texts)));     // nothing behind the end token
///     const auto vectors = network.project(pool(text, Pooling::end));               // what MDM and STMC take

namespace motionlang::inline MOTIONLANG_ABI {

struct ClipTextConfig {
  Index vocabulary = 49408, width = 512, heads = 8, d_ff = 2048, layers = 12, context = 77, out = 512;
  Activation activation = Activation::quick_gelu;
  double eps = 1e-5;
};

inline constexpr ClipTextConfig clip_vit_b32{};
inline constexpr ClipTextConfig clip_vit_l14{.width = 768, .heads = 12, .d_ff = 3072, .out = 768};

/// Pre-norm, every token sees those before it:   x = x + SA(LN1 x);   x = x + W2 act(W1 LN2 x)
template <Backend B>
struct ClipBlock {
  MultiheadAttention<B> attn;
  LayerNorm<B> ln_1, ln_2;
  Linear<B> c_fc, c_proj;
  Activation activation = Activation::quick_gelu;

  static constexpr auto fields() {
    using M = ClipBlock;
    return motionlang::fields("ln_1", &M::ln_1, "attn", &M::attn, "ln_2", &M::ln_2, "mlp.c_fc", &M::c_fc, "mlp.c_proj",
                              &M::c_proj, "activation", &M::activation);
  }
  ClipBlock() = default;
  ClipBlock(const ClipTextConfig& c, Rng auto& rng)
      : attn(c.width, c.heads, 0, rng),
        ln_1(c.width),
        ln_2(c.width),
        c_fc(c.width, c.d_ff, rng),
        c_proj(c.d_ff, c.width, rng),
        activation(c.activation) {
    ln_1.eps = ln_2.eps = c.eps;
  }

  Tensor<B, 2> operator()(const Tensor<B, 2>& x, const Offsets& offsets) const {
    const auto y = attn.self(ln_1(x), offsets, {}, &x, /*causal=*/true);
    return c_proj(c_fc(ln_2(y), activation), Activation::none, &y);
  }
};

/// Source  Radford et al. (2021), section 2.4; parameter names of OpenAI's state dict; spec text-encoders.md, section 5.
template <Backend B>
struct ClipText {
  Embedding<B> token_embedding;
  Tensor<B, 2> positional_embedding;  // (context, width)
  std::vector<ClipBlock<B>> blocks;
  LayerNorm<B> ln_final;
  Tensor<B, 2> text_projection;  // (width, out)

  static constexpr auto fields() {
    using M = ClipText;
    return motionlang::fields("token_embedding", &M::token_embedding, "positional_embedding", &M::positional_embedding,
                              "transformer.resblocks", &M::blocks, "ln_final", &M::ln_final, "text_projection",
                              &M::text_projection);
  }
  ClipText() = default;
  ClipText(const ClipTextConfig& c, Rng auto& rng)
      : token_embedding(c.vocabulary, c.width, rng, 0.02),
        positional_embedding(normal_init<B, 2>({c.context, c.width}, 0.01, rng)),
        ln_final(c.width),
        text_projection(normal_init<B, 2>({c.width, c.out}, 1 / std::sqrt(static_cast<double>(c.width)), rng)) {
    ln_final.eps = c.eps;
    for (Index i = 0; i < c.layers; ++i) blocks.emplace_back(c, rng);
  }

  Index longest() const { return positional_embedding.size(0); }

  /// The normalised states of the last layer, one row for every id, and where the end tokens are: the first of the largest id. A row
  /// depends on the ids before it only. Throws config_error 101 for a text longer than the context, shape_error 203 for an unknown id.
  TextFeatures<B> operator()(const TokenBatch& batch) const {
    const Offsets offsets = token_offsets(batch);
    if (offsets.longest() > longest())
      raise<config_error>(101, "CLIP: a text of ", offsets.longest(), " pieces for a context of ", longest(),
                          " (let the tokenizer cut it)");
    std::vector<Index> position_ids;
    for (Index length : batch.lengths) {
      for (Index i = 0; i < length; ++i) position_ids.push_back(i);
    }
    auto x = token_embedding(batch.ids) + gather(positional_embedding, position_ids);
    for (const auto& block : blocks) x = block(x, offsets);
    return {{ln_final(x), offsets}, end_positions(batch)};
  }

  /// Vectors of end tokens into the space of texts and images, (texts, width) -> (texts, out). Their length is not 1.
  Tensor<B, 2> project(const Tensor<B, 2>& end_rows) const { return matmul(end_rows, text_projection); }

  /// The texts up to their end tokens: what stands behind has no influence on the vector of a text.
  TokenBatch until_end(const TokenBatch& batch) const {
    TokenBatch out;
    token_offsets(batch);  // checks them
    auto from = batch.ids.begin();
    const auto ends = end_positions(batch);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const Index length = std::min(batch.lengths[i], ends[i] + 1);
      out.ids.insert(out.ids.end(), from, from + length);
      out.lengths.push_back(length);
      from += batch.lengths[i];
    }
    return out;
  }

 private:
  static std::vector<Index> end_positions(const TokenBatch& batch) {
    std::vector<Index> out;
    auto from = batch.ids.begin();
    for (Index length : batch.lengths) {
      out.push_back(std::max_element(from, from + length) - from);
      from += length;
    }
    return out;
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_CLIP_TOKENIZER_HPP  // <motionlang/text/clip_tokenizer.hpp>
#define MOTIONLANG_HAS_TEXT_CLIP_TOKENIZER_HPP
/// The tokenizer of CLIP: byte-level pair encoding with a mark at the end of words. Vocabularies are read by
/// io/tokenizer_files.hpp.
///
///     const ClipTokenizer clip = read_clip_tokenizer("bpe_simple_vocab_16e6.txt.gz");
///     clip.encode("a person walks");                     // 49406 320 2533 8192 49407
///     tokenize(clip, texts).padded(clip.pad_id(), 77);   // what the published network takes
///
/// Source   Radford et al. (2021), simple_tokenizer.py; Sennrich et al. (2016); spec text-encoders.md 9
/// Differs  mojibake is not repaired (text_repair.hpp)

#include <queue>          // merges in their order

#ifndef MOTIONLANG_HAS_TEXT_TEXT_REPAIR_HPP  // <motionlang/text/text_repair.hpp>
#define MOTIONLANG_HAS_TEXT_TEXT_REPAIR_HPP
/// What the CLIP tokenizer does to a text before it looks for words: the deterministic steps of ftfy's repair, and HTML entities.
///
/// Source   spec text-encoders.md 9.1; ftfy (Speer 2019); html.unescape of Python, the rules of HTML5
/// Differs  from ftfy: text that was decoded in the wrong encoding ("mojibake") stays as it is; the steps are repeated at most
///          100 times

#ifndef MOTIONLANG_HAS_TEXT_DETAIL_HTML_ENTITIES_HPP  // <motionlang/text/detail/html_entities.hpp>
#define MOTIONLANG_HAS_TEXT_DETAIL_HTML_ENTITIES_HPP
/// The named character references of HTML5, for text/text_repair.hpp.
/// Generated by tests/tools/make_unicode_tables.py: do not edit.

// clang-format off
namespace motionlang::inline MOTIONLANG_ABI::detail {

/// Records: name, blank, code points in hexadecimal joined by +, comma. ? behind a name: its semicolon may be missing.
/// ^ before a name: not of HTML5, a lower-case name in capitals that stands for the capital.
inline constexpr char html_entities[] =
    "AElig? c6,AMP? 26,Aacute? c1,Abreve 102,Acirc? c2,Acy 410,Afr 1d504,Agrave? c0,Alpha 391,Amacr 100,And 2a53,"
    "Aogon 104,Aopf 1d538,ApplyFunction 2061,Aring? c5,Ascr 1d49c,Assign 2254,Atilde? c3,Auml? c4,Backslash 2216,"
    "Barv 2ae7,Barwed 2306,Bcy 411,Because 2235,Bernoullis 212c,Beta 392,Bfr 1d505,Bopf 1d539,Breve 2d8,Bscr 212c,"
    "Bumpeq 224e,CHcy 427,COPY? a9,Cacute 106,Cap 22d2,CapitalDifferentialD 2145,Cayleys 212d,Ccaron 10c,Ccedil? c7,"
    "Ccirc 108,Cconint 2230,Cdot 10a,Cedilla b8,CenterDot b7,Cfr 212d,Chi 3a7,CircleDot 2299,CircleMinus 2296,"
    "CirclePlus 2295,CircleTimes 2297,ClockwiseContourIntegral 2232,CloseCurlyDoubleQuote 201d,CloseCurlyQuote 2019,"
    "Colon 2237,Colone 2a74,Congruent 2261,Conint 222f,ContourIntegral 222e,Copf 2102,Coproduct 2210,"
    "CounterClockwiseContourIntegral 2233,Cross 2a2f,Cscr 1d49e,Cup 22d3,CupCap 224d,DD 2145,DDotrahd 2911,DJcy 402,"
    "DScy 405,DZcy 40f,Dagger 2021,Darr 21a1,Dashv 2ae4,Dcaron 10e,Dcy 414,Del 2207,Delta 394,Dfr 1d507,"
    "DiacriticalAcute b4,DiacriticalDot 2d9,DiacriticalDoubleAcute 2dd,DiacriticalGrave 60,DiacriticalTilde 2dc,"
    "Diamond 22c4,DifferentialD 2146,Dopf 1d53b,Dot a8,DotDot 20dc,DotEqual 2250,DoubleContourIntegral 222f,DoubleDot a8,"
    "DoubleDownArrow 21d3,DoubleLeftArrow 21d0,DoubleLeftRightArrow 21d4,DoubleLeftTee 2ae4,DoubleLongLeftArrow 27f8,"
    "DoubleLongLeftRightArrow 27fa,DoubleLongRightArrow 27f9,DoubleRightArrow 21d2,DoubleRightTee 22a8,DoubleUpArrow 21d1,"
    "DoubleUpDownArrow 21d5,DoubleVerticalBar 2225,DownArrow 2193,DownArrowBar 2913,DownArrowUpArrow 21f5,DownBreve 311,"
    "DownLeftRightVector 2950,DownLeftTeeVector 295e,DownLeftVector 21bd,DownLeftVectorBar 2956,DownRightTeeVector 295f,"
    "DownRightVector 21c1,DownRightVectorBar 2957,DownTee 22a4,DownTeeArrow 21a7,Downarrow 21d3,Dscr 1d49f,Dstrok 110,"
    "ENG 14a,ETH? d0,Eacute? c9,Ecaron 11a,Ecirc? ca,Ecy 42d,Edot 116,Efr 1d508,Egrave? c8,Element 2208,Emacr 112,"
    "EmptySmallSquare 25fb,EmptyVerySmallSquare 25ab,Eogon 118,Eopf 1d53c,Epsilon 395,Equal 2a75,EqualTilde 2242,"
    "Equilibrium 21cc,Escr 2130,Esim 2a73,Eta 397,Euml? cb,Exists 2203,ExponentialE 2147,Fcy 424,Ffr 1d509,"
    "FilledSmallSquare 25fc,FilledVerySmallSquare 25aa,Fopf 1d53d,ForAll 2200,Fouriertrf 2131,Fscr 2131,GJcy 403,GT? 3e,"
    "Gamma 393,Gammad 3dc,Gbreve 11e,Gcedil 122,Gcirc 11c,Gcy 413,Gdot 120,Gfr 1d50a,Gg 22d9,Gopf 1d53e,GreaterEqual 2265,"
    "GreaterEqualLess 22db,GreaterFullEqual 2267,GreaterGreater 2aa2,GreaterLess 2277,GreaterSlantEqual 2a7e,"
    "GreaterTilde 2273,Gscr 1d4a2,Gt 226b,HARDcy 42a,Hacek 2c7,Hat 5e,Hcirc 124,Hfr 210c,HilbertSpace 210b,Hopf 210d,"
    "HorizontalLine 2500,Hscr 210b,Hstrok 126,HumpDownHump 224e,HumpEqual 224f,IEcy 415,IJlig 132,IOcy 401,Iacute? cd,"
    "Icirc? ce,Icy 418,Idot 130,Ifr 2111,Igrave? cc,Im 2111,Imacr 12a,ImaginaryI 2148,Implies 21d2,Int 222c,Integral 222b,"
    "Intersection 22c2,InvisibleComma 2063,InvisibleTimes 2062,Iogon 12e,Iopf 1d540,Iota 399,Iscr 2110,Itilde 128,"
    "Iukcy 406,Iuml? cf,Jcirc 134,Jcy 419,Jfr 1d50d,Jopf 1d541,Jscr 1d4a5,Jsercy 408,Jukcy 404,KHcy 425,KJcy 40c,"
    "Kappa 39a,Kcedil 136,Kcy 41a,Kfr 1d50e,Kopf 1d542,Kscr 1d4a6,LJcy 409,LT? 3c,Lacute 139,Lambda 39b,Lang 27ea,"
    "Laplacetrf 2112,Larr 219e,Lcaron 13d,Lcedil 13b,Lcy 41b,LeftAngleBracket 27e8,LeftArrow 2190,LeftArrowBar 21e4,"
    "LeftArrowRightArrow 21c6,LeftCeiling 2308,LeftDoubleBracket 27e6,LeftDownTeeVector 2961,LeftDownVector 21c3,"
    "LeftDownVectorBar 2959,LeftFloor 230a,LeftRightArrow 2194,LeftRightVector 294e,LeftTee 22a3,LeftTeeArrow 21a4,"
    "LeftTeeVector 295a,LeftTriangle 22b2,LeftTriangleBar 29cf,LeftTriangleEqual 22b4,LeftUpDownVector 2951,"
    "LeftUpTeeVector 2960,LeftUpVector 21bf,LeftUpVectorBar 2958,LeftVector 21bc,LeftVectorBar 2952,Leftarrow 21d0,"
    "Leftrightarrow 21d4,LessEqualGreater 22da,LessFullEqual 2266,LessGreater 2276,LessLess 2aa1,LessSlantEqual 2a7d,"
    "LessTilde 2272,Lfr 1d50f,Ll 22d8,Lleftarrow 21da,Lmidot 13f,LongLeftArrow 27f5,LongLeftRightArrow 27f7,"
    "LongRightArrow 27f6,Longleftarrow 27f8,Longleftrightarrow 27fa,Longrightarrow 27f9,Lopf 1d543,LowerLeftArrow 2199,"
    "LowerRightArrow 2198,Lscr 2112,Lsh 21b0,Lstrok 141,Lt 226a,Map 2905,Mcy 41c,MediumSpace 205f,Mellintrf 2133,"
    "Mfr 1d510,MinusPlus 2213,Mopf 1d544,Mscr 2133,Mu 39c,NJcy 40a,Nacute 143,Ncaron 147,Ncedil 145,Ncy 41d,"
    "NegativeMediumSpace 200b,NegativeThickSpace 200b,NegativeThinSpace 200b,NegativeVeryThinSpace 200b,"
    "NestedGreaterGreater 226b,NestedLessLess 226a,NewLine a,Nfr 1d511,NoBreak 2060,NonBreakingSpace a0,Nopf 2115,"
    "Not 2aec,NotCongruent 2262,NotCupCap 226d,NotDoubleVerticalBar 2226,NotElement 2209,NotEqual 2260,"
    "NotEqualTilde 2242+338,NotExists 2204,NotGreater 226f,NotGreaterEqual 2271,NotGreaterFullEqual 2267+338,"
    "NotGreaterGreater 226b+338,NotGreaterLess 2279,NotGreaterSlantEqual 2a7e+338,NotGreaterTilde 2275,"
    "NotHumpDownHump 224e+338,NotHumpEqual 224f+338,NotLeftTriangle 22ea,NotLeftTriangleBar 29cf+338,"
    "NotLeftTriangleEqual 22ec,NotLess 226e,NotLessEqual 2270,NotLessGreater 2278,NotLessLess 226a+338,"
    "NotLessSlantEqual 2a7d+338,NotLessTilde 2274,NotNestedGreaterGreater 2aa2+338,NotNestedLessLess 2aa1+338,"
    "NotPrecedes 2280,NotPrecedesEqual 2aaf+338,NotPrecedesSlantEqual 22e0,NotReverseElement 220c,NotRightTriangle 22eb,"
    "NotRightTriangleBar 29d0+338,NotRightTriangleEqual 22ed,NotSquareSubset 228f+338,NotSquareSubsetEqual 22e2,"
    "NotSquareSuperset 2290+338,NotSquareSupersetEqual 22e3,NotSubset 2282+20d2,NotSubsetEqual 2288,NotSucceeds 2281,"
    "NotSucceedsEqual 2ab0+338,NotSucceedsSlantEqual 22e1,NotSucceedsTilde 227f+338,NotSuperset 2283+20d2,"
    "NotSupersetEqual 2289,NotTilde 2241,NotTildeEqual 2244,NotTildeFullEqual 2247,NotTildeTilde 2249,NotVerticalBar 2224,"
    "Nscr 1d4a9,Ntilde? d1,Nu 39d,OElig 152,Oacute? d3,Ocirc? d4,Ocy 41e,Odblac 150,Ofr 1d512,Ograve? d2,Omacr 14c,"
    "Omega 3a9,Omicron 39f,Oopf 1d546,OpenCurlyDoubleQuote 201c,OpenCurlyQuote 2018,Or 2a54,Oscr 1d4aa,Oslash? d8,"
    "Otilde? d5,Otimes 2a37,Ouml? d6,OverBar 203e,OverBrace 23de,OverBracket 23b4,OverParenthesis 23dc,PartialD 2202,"
    "Pcy 41f,Pfr 1d513,Phi 3a6,Pi 3a0,PlusMinus b1,Poincareplane 210c,Popf 2119,Pr 2abb,Precedes 227a,PrecedesEqual 2aaf,"
    "PrecedesSlantEqual 227c,PrecedesTilde 227e,Prime 2033,Product 220f,Proportion 2237,Proportional 221d,Pscr 1d4ab,"
    "Psi 3a8,QUOT? 22,Qfr 1d514,Qopf 211a,Qscr 1d4ac,RBarr 2910,REG? ae,Racute 154,Rang 27eb,Rarr 21a0,Rarrtl 2916,"
    "Rcaron 158,Rcedil 156,Rcy 420,Re 211c,ReverseElement 220b,ReverseEquilibrium 21cb,ReverseUpEquilibrium 296f,Rfr 211c,"
    "Rho 3a1,RightAngleBracket 27e9,RightArrow 2192,RightArrowBar 21e5,RightArrowLeftArrow 21c4,RightCeiling 2309,"
    "RightDoubleBracket 27e7,RightDownTeeVector 295d,RightDownVector 21c2,RightDownVectorBar 2955,RightFloor 230b,"
    "RightTee 22a2,RightTeeArrow 21a6,RightTeeVector 295b,RightTriangle 22b3,RightTriangleBar 29d0,"
    "RightTriangleEqual 22b5,RightUpDownVector 294f,RightUpTeeVector 295c,RightUpVector 21be,RightUpVectorBar 2954,"
    "RightVector 21c0,RightVectorBar 2953,Rightarrow 21d2,Ropf 211d,RoundImplies 2970,Rrightarrow 21db,Rscr 211b,Rsh 21b1,"
    "RuleDelayed 29f4,SHCHcy 429,SHcy 428,SOFTcy 42c,Sacute 15a,Sc 2abc,Scaron 160,Scedil 15e,Scirc 15c,Scy 421,Sfr 1d516,"
    "ShortDownArrow 2193,ShortLeftArrow 2190,ShortRightArrow 2192,ShortUpArrow 2191,Sigma 3a3,SmallCircle 2218,Sopf 1d54a,"
    "Sqrt 221a,Square 25a1,SquareIntersection 2293,SquareSubset 228f,SquareSubsetEqual 2291,SquareSuperset 2290,"
    "SquareSupersetEqual 2292,SquareUnion 2294,Sscr 1d4ae,Star 22c6,Sub 22d0,Subset 22d0,SubsetEqual 2286,Succeeds 227b,"
    "SucceedsEqual 2ab0,SucceedsSlantEqual 227d,SucceedsTilde 227f,SuchThat 220b,Sum 2211,Sup 22d1,Superset 2283,"
    "SupersetEqual 2287,Supset 22d1,THORN? de,TRADE 2122,TSHcy 40b,TScy 426,Tab 9,Tau 3a4,Tcaron 164,Tcedil 162,Tcy 422,"
    "Tfr 1d517,Therefore 2234,Theta 398,ThickSpace 205f+200a,ThinSpace 2009,Tilde 223c,TildeEqual 2243,"
    "TildeFullEqual 2245,TildeTilde 2248,Topf 1d54b,TripleDot 20db,Tscr 1d4af,Tstrok 166,Uacute? da,Uarr 219f,"
    "Uarrocir 2949,Ubrcy 40e,Ubreve 16c,Ucirc? db,Ucy 423,Udblac 170,Ufr 1d518,Ugrave? d9,Umacr 16a,UnderBar 5f,"
    "UnderBrace 23df,UnderBracket 23b5,UnderParenthesis 23dd,Union 22c3,UnionPlus 228e,Uogon 172,Uopf 1d54c,UpArrow 2191,"
    "UpArrowBar 2912,UpArrowDownArrow 21c5,UpDownArrow 2195,UpEquilibrium 296e,UpTee 22a5,UpTeeArrow 21a5,Uparrow 21d1,"
    "Updownarrow 21d5,UpperLeftArrow 2196,UpperRightArrow 2197,Upsi 3d2,Upsilon 3a5,Uring 16e,Uscr 1d4b0,Utilde 168,"
    "Uuml? dc,VDash 22ab,Vbar 2aeb,Vcy 412,Vdash 22a9,Vdashl 2ae6,Vee 22c1,Verbar 2016,Vert 2016,VerticalBar 2223,"
    "VerticalLine 7c,VerticalSeparator 2758,VerticalTilde 2240,VeryThinSpace 200a,Vfr 1d519,Vopf 1d54d,Vscr 1d4b1,"
    "Vvdash 22aa,Wcirc 174,Wedge 22c0,Wfr 1d51a,Wopf 1d54e,Wscr 1d4b2,Xfr 1d51b,Xi 39e,Xopf 1d54f,Xscr 1d4b3,YAcy 42f,"
    "YIcy 407,YUcy 42e,Yacute? dd,Ycirc 176,Ycy 42b,Yfr 1d51c,Yopf 1d550,Yscr 1d4b4,Yuml 178,ZHcy 416,Zacute 179,"
    "Zcaron 17d,Zcy 417,Zdot 17b,ZeroWidthSpace 200b,Zeta 396,Zfr 2128,Zopf 2124,Zscr 1d4b5,aacute? e1,^AACUTE c1,"
    "abreve 103,^ABREVE 102,ac 223e,^AC 223e,acE 223e+333,acd 223f,^ACD 223f,acirc? e2,^ACIRC c2,acute? b4,^ACUTE b4,"
    "acy 430,^ACY 410,aelig? e6,^AELIG c6,af 2061,^AF 2061,afr 1d51e,^AFR 1d51e,agrave? e0,^AGRAVE c0,alefsym 2135,"
    "^ALEFSYM 2135,aleph 2135,^ALEPH 2135,alpha 3b1,^ALPHA 391,amacr 101,^AMACR 100,amalg 2a3f,^AMALG 2a3f,amp? 26,"
    "and 2227,^AND 2227,andand 2a55,^ANDAND 2a55,andd 2a5c,^ANDD 2a5c,andslope 2a58,^ANDSLOPE 2a58,andv 2a5a,^ANDV 2a5a,"
    "ang 2220,^ANG 2220,ange 29a4,^ANGE 29a4,angle 2220,^ANGLE 2220,angmsd 2221,^ANGMSD 2221,angmsdaa 29a8,^ANGMSDAA 29a8,"
    "angmsdab 29a9,^ANGMSDAB 29a9,angmsdac 29aa,^ANGMSDAC 29aa,angmsdad 29ab,^ANGMSDAD 29ab,angmsdae 29ac,^ANGMSDAE 29ac,"
    "angmsdaf 29ad,^ANGMSDAF 29ad,angmsdag 29ae,^ANGMSDAG 29ae,angmsdah 29af,^ANGMSDAH 29af,angrt 221f,^ANGRT 221f,"
    "angrtvb 22be,^ANGRTVB 22be,angrtvbd 299d,^ANGRTVBD 299d,angsph 2222,^ANGSPH 2222,angst c5,^ANGST c5,angzarr 237c,"
    "^ANGZARR 237c,aogon 105,^AOGON 104,aopf 1d552,^AOPF 1d552,ap 2248,^AP 2248,apE 2a70,apacir 2a6f,^APACIR 2a6f,"
    "ape 224a,^APE 224a,apid 224b,^APID 224b,apos 27,^APOS 27,approx 2248,^APPROX 2248,approxeq 224a,^APPROXEQ 224a,"
    "aring? e5,^ARING c5,ascr 1d4b6,^ASCR 1d4b6,ast 2a,^AST 2a,asymp 2248,^ASYMP 2248,asympeq 224d,^ASYMPEQ 224d,"
    "atilde? e3,^ATILDE c3,auml? e4,^AUML c4,awconint 2233,^AWCONINT 2233,awint 2a11,^AWINT 2a11,bNot 2aed,backcong 224c,"
    "^BACKCONG 224c,backepsilon 3f6,^BACKEPSILON 3f6,backprime 2035,^BACKPRIME 2035,backsim 223d,^BACKSIM 223d,"
    "backsimeq 22cd,^BACKSIMEQ 22cd,barvee 22bd,^BARVEE 22bd,barwed 2305,^BARWED 2305,barwedge 2305,^BARWEDGE 2305,"
    "bbrk 23b5,^BBRK 23b5,bbrktbrk 23b6,^BBRKTBRK 23b6,bcong 224c,^BCONG 224c,bcy 431,^BCY 411,bdquo 201e,^BDQUO 201e,"
    "becaus 2235,^BECAUS 2235,because 2235,^BECAUSE 2235,bemptyv 29b0,^BEMPTYV 29b0,bepsi 3f6,^BEPSI 3f6,bernou 212c,"
    "^BERNOU 212c,beta 3b2,^BETA 392,beth 2136,^BETH 2136,between 226c,^BETWEEN 226c,bfr 1d51f,^BFR 1d51f,bigcap 22c2,"
    "^BIGCAP 22c2,bigcirc 25ef,^BIGCIRC 25ef,bigcup 22c3,^BIGCUP 22c3,bigodot 2a00,^BIGODOT 2a00,bigoplus 2a01,"
    "^BIGOPLUS 2a01,bigotimes 2a02,^BIGOTIMES 2a02,bigsqcup 2a06,^BIGSQCUP 2a06,bigstar 2605,^BIGSTAR 2605,"
    "bigtriangledown 25bd,^BIGTRIANGLEDOWN 25bd,bigtriangleup 25b3,^BIGTRIANGLEUP 25b3,biguplus 2a04,^BIGUPLUS 2a04,"
    "bigvee 22c1,^BIGVEE 22c1,bigwedge 22c0,^BIGWEDGE 22c0,bkarow 290d,^BKAROW 290d,blacklozenge 29eb,^BLACKLOZENGE 29eb,"
    "blacksquare 25aa,^BLACKSQUARE 25aa,blacktriangle 25b4,^BLACKTRIANGLE 25b4,blacktriangledown 25be,"
    "^BLACKTRIANGLEDOWN 25be,blacktriangleleft 25c2,^BLACKTRIANGLELEFT 25c2,blacktriangleright 25b8,"
    "^BLACKTRIANGLERIGHT 25b8,blank 2423,^BLANK 2423,blk12 2592,^BLK12 2592,blk14 2591,^BLK14 2591,blk34 2593,^BLK34 2593,"
    "block 2588,^BLOCK 2588,bne 3d+20e5,^BNE 3d+20e5,bnequiv 2261+20e5,^BNEQUIV 2261+20e5,bnot 2310,^BNOT 2310,bopf 1d553,"
    "^BOPF 1d553,bot 22a5,^BOT 22a5,bottom 22a5,^BOTTOM 22a5,bowtie 22c8,^BOWTIE 22c8,boxDL 2557,boxDR 2554,boxDl 2556,"
    "boxDr 2553,boxH 2550,boxHD 2566,boxHU 2569,boxHd 2564,boxHu 2567,boxUL 255d,boxUR 255a,boxUl 255c,boxUr 2559,"
    "boxV 2551,boxVH 256c,boxVL 2563,boxVR 2560,boxVh 256b,boxVl 2562,boxVr 255f,boxbox 29c9,^BOXBOX 29c9,boxdL 2555,"
    "boxdR 2552,boxdl 2510,^BOXDL 2510,boxdr 250c,^BOXDR 250c,boxh 2500,^BOXH 2500,boxhD 2565,boxhU 2568,boxhd 252c,"
    "^BOXHD 252c,boxhu 2534,^BOXHU 2534,boxminus 229f,^BOXMINUS 229f,boxplus 229e,^BOXPLUS 229e,boxtimes 22a0,"
    "^BOXTIMES 22a0,boxuL 255b,boxuR 2558,boxul 2518,^BOXUL 2518,boxur 2514,^BOXUR 2514,boxv 2502,^BOXV 2502,boxvH 256a,"
    "boxvL 2561,boxvR 255e,boxvh 253c,^BOXVH 253c,boxvl 2524,^BOXVL 2524,boxvr 251c,^BOXVR 251c,bprime 2035,^BPRIME 2035,"
    "breve 2d8,^BREVE 2d8,brvbar? a6,^BRVBAR a6,bscr 1d4b7,^BSCR 1d4b7,bsemi 204f,^BSEMI 204f,bsim 223d,^BSIM 223d,"
    "bsime 22cd,^BSIME 22cd,bsol 5c,^BSOL 5c,bsolb 29c5,^BSOLB 29c5,bsolhsub 27c8,^BSOLHSUB 27c8,bull 2022,^BULL 2022,"
    "bullet 2022,^BULLET 2022,bump 224e,^BUMP 224e,bumpE 2aae,bumpe 224f,^BUMPE 224f,bumpeq 224f,^BUMPEQ 224f,cacute 107,"
    "^CACUTE 106,cap 2229,^CAP 2229,capand 2a44,^CAPAND 2a44,capbrcup 2a49,^CAPBRCUP 2a49,capcap 2a4b,^CAPCAP 2a4b,"
    "capcup 2a47,^CAPCUP 2a47,capdot 2a40,^CAPDOT 2a40,caps 2229+fe00,^CAPS 2229+fe00,caret 2041,^CARET 2041,caron 2c7,"
    "^CARON 2c7,ccaps 2a4d,^CCAPS 2a4d,ccaron 10d,^CCARON 10c,ccedil? e7,^CCEDIL c7,ccirc 109,^CCIRC 108,ccups 2a4c,"
    "^CCUPS 2a4c,ccupssm 2a50,^CCUPSSM 2a50,cdot 10b,^CDOT 10a,cedil? b8,^CEDIL b8,cemptyv 29b2,^CEMPTYV 29b2,cent? a2,"
    "^CENT a2,centerdot b7,^CENTERDOT b7,cfr 1d520,^CFR 1d520,chcy 447,^CHCY 427,check 2713,^CHECK 2713,checkmark 2713,"
    "^CHECKMARK 2713,chi 3c7,^CHI 3a7,cir 25cb,^CIR 25cb,cirE 29c3,circ 2c6,^CIRC 2c6,circeq 2257,^CIRCEQ 2257,"
    "circlearrowleft 21ba,^CIRCLEARROWLEFT 21ba,circlearrowright 21bb,^CIRCLEARROWRIGHT 21bb,circledR ae,circledS 24c8,"
    "circledast 229b,^CIRCLEDAST 229b,circledcirc 229a,^CIRCLEDCIRC 229a,circleddash 229d,^CIRCLEDDASH 229d,cire 2257,"
    "^CIRE 2257,cirfnint 2a10,^CIRFNINT 2a10,cirmid 2aef,^CIRMID 2aef,cirscir 29c2,^CIRSCIR 29c2,clubs 2663,^CLUBS 2663,"
    "clubsuit 2663,^CLUBSUIT 2663,colon 3a,^COLON 3a,colone 2254,^COLONE 2254,coloneq 2254,^COLONEQ 2254,comma 2c,"
    "^COMMA 2c,commat 40,^COMMAT 40,comp 2201,^COMP 2201,compfn 2218,^COMPFN 2218,complement 2201,^COMPLEMENT 2201,"
    "complexes 2102,^COMPLEXES 2102,cong 2245,^CONG 2245,congdot 2a6d,^CONGDOT 2a6d,conint 222e,^CONINT 222e,copf 1d554,"
    "^COPF 1d554,coprod 2210,^COPROD 2210,copy? a9,copysr 2117,crarr 21b5,^CRARR 21b5,cross 2717,^CROSS 2717,cscr 1d4b8,"
    "^CSCR 1d4b8,csub 2acf,^CSUB 2acf,csube 2ad1,^CSUBE 2ad1,csup 2ad0,^CSUP 2ad0,csupe 2ad2,^CSUPE 2ad2,ctdot 22ef,"
    "^CTDOT 22ef,cudarrl 2938,^CUDARRL 2938,cudarrr 2935,^CUDARRR 2935,cuepr 22de,^CUEPR 22de,cuesc 22df,^CUESC 22df,"
    "cularr 21b6,^CULARR 21b6,cularrp 293d,^CULARRP 293d,cup 222a,^CUP 222a,cupbrcap 2a48,^CUPBRCAP 2a48,cupcap 2a46,"
    "^CUPCAP 2a46,cupcup 2a4a,^CUPCUP 2a4a,cupdot 228d,^CUPDOT 228d,cupor 2a45,^CUPOR 2a45,cups 222a+fe00,^CUPS 222a+fe00,"
    "curarr 21b7,^CURARR 21b7,curarrm 293c,^CURARRM 293c,curlyeqprec 22de,^CURLYEQPREC 22de,curlyeqsucc 22df,"
    "^CURLYEQSUCC 22df,curlyvee 22ce,^CURLYVEE 22ce,curlywedge 22cf,^CURLYWEDGE 22cf,curren? a4,^CURREN a4,"
    "curvearrowleft 21b6,^CURVEARROWLEFT 21b6,curvearrowright 21b7,^CURVEARROWRIGHT 21b7,cuvee 22ce,^CUVEE 22ce,"
    "cuwed 22cf,^CUWED 22cf,cwconint 2232,^CWCONINT 2232,cwint 2231,^CWINT 2231,cylcty 232d,^CYLCTY 232d,dArr 21d3,"
    "dHar 2965,dagger 2020,^DAGGER 2020,daleth 2138,^DALETH 2138,darr 2193,^DARR 2193,dash 2010,^DASH 2010,dashv 22a3,"
    "^DASHV 22a3,dbkarow 290f,^DBKAROW 290f,dblac 2dd,^DBLAC 2dd,dcaron 10f,^DCARON 10e,dcy 434,^DCY 414,dd 2146,"
    "ddagger 2021,^DDAGGER 2021,ddarr 21ca,^DDARR 21ca,ddotseq 2a77,^DDOTSEQ 2a77,deg? b0,^DEG b0,delta 3b4,^DELTA 394,"
    "demptyv 29b1,^DEMPTYV 29b1,dfisht 297f,^DFISHT 297f,dfr 1d521,^DFR 1d521,dharl 21c3,^DHARL 21c3,dharr 21c2,"
    "^DHARR 21c2,diam 22c4,^DIAM 22c4,diamond 22c4,^DIAMOND 22c4,diamondsuit 2666,^DIAMONDSUIT 2666,diams 2666,"
    "^DIAMS 2666,die a8,^DIE a8,digamma 3dd,^DIGAMMA 3dc,disin 22f2,^DISIN 22f2,div f7,^DIV f7,divide? f7,^DIVIDE f7,"
    "divideontimes 22c7,^DIVIDEONTIMES 22c7,divonx 22c7,^DIVONX 22c7,djcy 452,^DJCY 402,dlcorn 231e,^DLCORN 231e,"
    "dlcrop 230d,^DLCROP 230d,dollar 24,^DOLLAR 24,dopf 1d555,^DOPF 1d555,dot 2d9,^DOT 2d9,doteq 2250,^DOTEQ 2250,"
    "doteqdot 2251,^DOTEQDOT 2251,dotminus 2238,^DOTMINUS 2238,dotplus 2214,^DOTPLUS 2214,dotsquare 22a1,^DOTSQUARE 22a1,"
    "doublebarwedge 2306,^DOUBLEBARWEDGE 2306,downarrow 2193,^DOWNARROW 2193,downdownarrows 21ca,^DOWNDOWNARROWS 21ca,"
    "downharpoonleft 21c3,^DOWNHARPOONLEFT 21c3,downharpoonright 21c2,^DOWNHARPOONRIGHT 21c2,drbkarow 2910,^DRBKAROW 2910,"
    "drcorn 231f,^DRCORN 231f,drcrop 230c,^DRCROP 230c,dscr 1d4b9,^DSCR 1d4b9,dscy 455,^DSCY 405,dsol 29f6,^DSOL 29f6,"
    "dstrok 111,^DSTROK 110,dtdot 22f1,^DTDOT 22f1,dtri 25bf,^DTRI 25bf,dtrif 25be,^DTRIF 25be,duarr 21f5,^DUARR 21f5,"
    "duhar 296f,^DUHAR 296f,dwangle 29a6,^DWANGLE 29a6,dzcy 45f,^DZCY 40f,dzigrarr 27ff,^DZIGRARR 27ff,eDDot 2a77,"
    "eDot 2251,eacute? e9,^EACUTE c9,easter 2a6e,^EASTER 2a6e,ecaron 11b,^ECARON 11a,ecir 2256,^ECIR 2256,ecirc? ea,"
    "^ECIRC ca,ecolon 2255,^ECOLON 2255,ecy 44d,^ECY 42d,edot 117,^EDOT 116,ee 2147,^EE 2147,efDot 2252,efr 1d522,"
    "^EFR 1d522,eg 2a9a,^EG 2a9a,egrave? e8,^EGRAVE c8,egs 2a96,^EGS 2a96,egsdot 2a98,^EGSDOT 2a98,el 2a99,^EL 2a99,"
    "elinters 23e7,^ELINTERS 23e7,ell 2113,^ELL 2113,els 2a95,^ELS 2a95,elsdot 2a97,^ELSDOT 2a97,emacr 113,^EMACR 112,"
    "empty 2205,^EMPTY 2205,emptyset 2205,^EMPTYSET 2205,emptyv 2205,^EMPTYV 2205,emsp13 2004,^EMSP13 2004,emsp14 2005,"
    "^EMSP14 2005,emsp 2003,^EMSP 2003,eng 14b,ensp 2002,^ENSP 2002,eogon 119,^EOGON 118,eopf 1d556,^EOPF 1d556,epar 22d5,"
    "^EPAR 22d5,eparsl 29e3,^EPARSL 29e3,eplus 2a71,^EPLUS 2a71,epsi 3b5,^EPSI 395,epsilon 3b5,^EPSILON 395,epsiv 3f5,"
    "^EPSIV 395,eqcirc 2256,^EQCIRC 2256,eqcolon 2255,^EQCOLON 2255,eqsim 2242,^EQSIM 2242,eqslantgtr 2a96,"
    "^EQSLANTGTR 2a96,eqslantless 2a95,^EQSLANTLESS 2a95,equals 3d,^EQUALS 3d,equest 225f,^EQUEST 225f,equiv 2261,"
    "^EQUIV 2261,equivDD 2a78,eqvparsl 29e5,^EQVPARSL 29e5,erDot 2253,erarr 2971,^ERARR 2971,escr 212f,^ESCR 212f,"
    "esdot 2250,^ESDOT 2250,esim 2242,^ESIM 2242,eta 3b7,^ETA 397,eth? f0,euml? eb,^EUML cb,euro 20ac,^EURO 20ac,excl 21,"
    "^EXCL 21,exist 2203,^EXIST 2203,expectation 2130,^EXPECTATION 2130,exponentiale 2147,^EXPONENTIALE 2147,"
    "fallingdotseq 2252,^FALLINGDOTSEQ 2252,fcy 444,^FCY 424,female 2640,^FEMALE 2640,ffilig fb03,^FFILIG 46+46+49,"
    "fflig fb00,^FFLIG 46+46,ffllig fb04,^FFLLIG 46+46+4c,ffr 1d523,^FFR 1d523,filig fb01,^FILIG 46+49,fjlig 66+6a,"
    "^FJLIG 46+4a,flat 266d,^FLAT 266d,fllig fb02,^FLLIG 46+4c,fltns 25b1,^FLTNS 25b1,fnof 192,^FNOF 191,fopf 1d557,"
    "^FOPF 1d557,forall 2200,^FORALL 2200,fork 22d4,^FORK 22d4,forkv 2ad9,^FORKV 2ad9,fpartint 2a0d,^FPARTINT 2a0d,"
    "frac12? bd,^FRAC12 bd,frac13 2153,^FRAC13 2153,frac14? bc,^FRAC14 bc,frac15 2155,^FRAC15 2155,frac16 2159,"
    "^FRAC16 2159,frac18 215b,^FRAC18 215b,frac23 2154,^FRAC23 2154,frac25 2156,^FRAC25 2156,frac34? be,^FRAC34 be,"
    "frac35 2157,^FRAC35 2157,frac38 215c,^FRAC38 215c,frac45 2158,^FRAC45 2158,frac56 215a,^FRAC56 215a,frac58 215d,"
    "^FRAC58 215d,frac78 215e,^FRAC78 215e,frasl 2044,^FRASL 2044,frown 2322,^FROWN 2322,fscr 1d4bb,^FSCR 1d4bb,gE 2267,"
    "gEl 2a8c,gacute 1f5,^GACUTE 1f4,gamma 3b3,^GAMMA 393,gammad 3dd,^GAMMAD 3dc,gap 2a86,^GAP 2a86,gbreve 11f,"
    "^GBREVE 11e,gcirc 11d,^GCIRC 11c,gcy 433,^GCY 413,gdot 121,^GDOT 120,ge 2265,^GE 2265,gel 22db,^GEL 22db,geq 2265,"
    "^GEQ 2265,geqq 2267,^GEQQ 2267,geqslant 2a7e,^GEQSLANT 2a7e,ges 2a7e,^GES 2a7e,gescc 2aa9,^GESCC 2aa9,gesdot 2a80,"
    "^GESDOT 2a80,gesdoto 2a82,^GESDOTO 2a82,gesdotol 2a84,^GESDOTOL 2a84,gesl 22db+fe00,^GESL 22db+fe00,gesles 2a94,"
    "^GESLES 2a94,gfr 1d524,^GFR 1d524,gg 226b,^GG 226b,ggg 22d9,^GGG 22d9,gimel 2137,^GIMEL 2137,gjcy 453,^GJCY 403,"
    "gl 2277,^GL 2277,glE 2a92,gla 2aa5,^GLA 2aa5,glj 2aa4,^GLJ 2aa4,gnE 2269,gnap 2a8a,^GNAP 2a8a,gnapprox 2a8a,"
    "^GNAPPROX 2a8a,gne 2a88,^GNE 2a88,gneq 2a88,^GNEQ 2a88,gneqq 2269,^GNEQQ 2269,gnsim 22e7,^GNSIM 22e7,gopf 1d558,"
    "^GOPF 1d558,grave 60,^GRAVE 60,gscr 210a,^GSCR 210a,gsim 2273,^GSIM 2273,gsime 2a8e,^GSIME 2a8e,gsiml 2a90,"
    "^GSIML 2a90,gt? 3e,gtcc 2aa7,gtcir 2a7a,gtdot 22d7,gtlPar 2995,gtquest 2a7c,gtrapprox 2a86,gtrarr 2978,gtrdot 22d7,"
    "gtreqless 22db,gtreqqless 2a8c,gtrless 2277,gtrsim 2273,gvertneqq 2269+fe00,^GVERTNEQQ 2269+fe00,gvnE 2269+fe00,"
    "hArr 21d4,hairsp 200a,^HAIRSP 200a,half bd,^HALF bd,hamilt 210b,^HAMILT 210b,hardcy 44a,^HARDCY 42a,harr 2194,"
    "^HARR 2194,harrcir 2948,^HARRCIR 2948,harrw 21ad,^HARRW 21ad,hbar 210f,^HBAR 210f,hcirc 125,^HCIRC 124,hearts 2665,"
    "^HEARTS 2665,heartsuit 2665,^HEARTSUIT 2665,hellip 2026,^HELLIP 2026,hercon 22b9,^HERCON 22b9,hfr 1d525,^HFR 1d525,"
    "hksearow 2925,^HKSEAROW 2925,hkswarow 2926,^HKSWAROW 2926,hoarr 21ff,^HOARR 21ff,homtht 223b,^HOMTHT 223b,"
    "hookleftarrow 21a9,^HOOKLEFTARROW 21a9,hookrightarrow 21aa,^HOOKRIGHTARROW 21aa,hopf 1d559,^HOPF 1d559,horbar 2015,"
    "^HORBAR 2015,hscr 1d4bd,^HSCR 1d4bd,hslash 210f,^HSLASH 210f,hstrok 127,^HSTROK 126,hybull 2043,^HYBULL 2043,"
    "hyphen 2010,^HYPHEN 2010,iacute? ed,^IACUTE cd,ic 2063,^IC 2063,icirc? ee,^ICIRC ce,icy 438,^ICY 418,iecy 435,"
    "^IECY 415,iexcl? a1,^IEXCL a1,iff 21d4,^IFF 21d4,ifr 1d526,^IFR 1d526,igrave? ec,^IGRAVE cc,ii 2148,^II 2148,"
    "iiiint 2a0c,^IIIINT 2a0c,iiint 222d,^IIINT 222d,iinfin 29dc,^IINFIN 29dc,iiota 2129,^IIOTA 2129,ijlig 133,^IJLIG 132,"
    "imacr 12b,^IMACR 12a,image 2111,^IMAGE 2111,imagline 2110,^IMAGLINE 2110,imagpart 2111,^IMAGPART 2111,imath 131,"
    "^IMATH 49,imof 22b7,^IMOF 22b7,imped 1b5,^IMPED 1b5,in 2208,^IN 2208,incare 2105,^INCARE 2105,infin 221e,^INFIN 221e,"
    "infintie 29dd,^INFINTIE 29dd,inodot 131,^INODOT 49,int 222b,^INT 222b,intcal 22ba,^INTCAL 22ba,integers 2124,"
    "^INTEGERS 2124,intercal 22ba,^INTERCAL 22ba,intlarhk 2a17,^INTLARHK 2a17,intprod 2a3c,^INTPROD 2a3c,iocy 451,"
    "^IOCY 401,iogon 12f,^IOGON 12e,iopf 1d55a,^IOPF 1d55a,iota 3b9,^IOTA 399,iprod 2a3c,^IPROD 2a3c,iquest? bf,"
    "^IQUEST bf,iscr 1d4be,^ISCR 1d4be,isin 2208,^ISIN 2208,isinE 22f9,isindot 22f5,^ISINDOT 22f5,isins 22f4,^ISINS 22f4,"
    "isinsv 22f3,^ISINSV 22f3,isinv 2208,^ISINV 2208,it 2062,^IT 2062,itilde 129,^ITILDE 128,iukcy 456,^IUKCY 406,"
    "iuml? ef,^IUML cf,jcirc 135,^JCIRC 134,jcy 439,^JCY 419,jfr 1d527,^JFR 1d527,jmath 237,^JMATH 237,jopf 1d55b,"
    "^JOPF 1d55b,jscr 1d4bf,^JSCR 1d4bf,jsercy 458,^JSERCY 408,jukcy 454,^JUKCY 404,kappa 3ba,^KAPPA 39a,kappav 3f0,"
    "^KAPPAV 39a,kcedil 137,^KCEDIL 136,kcy 43a,^KCY 41a,kfr 1d528,^KFR 1d528,kgreen 138,^KGREEN 138,khcy 445,^KHCY 425,"
    "kjcy 45c,^KJCY 40c,kopf 1d55c,^KOPF 1d55c,kscr 1d4c0,^KSCR 1d4c0,lAarr 21da,lArr 21d0,lAtail 291b,lBarr 290e,lE 2266,"
    "lEg 2a8b,lHar 2962,lacute 13a,^LACUTE 139,laemptyv 29b4,^LAEMPTYV 29b4,lagran 2112,^LAGRAN 2112,lambda 3bb,"
    "^LAMBDA 39b,lang 27e8,^LANG 27e8,langd 2991,^LANGD 2991,langle 27e8,^LANGLE 27e8,lap 2a85,^LAP 2a85,laquo? ab,"
    "^LAQUO ab,larr 2190,^LARR 2190,larrb 21e4,^LARRB 21e4,larrbfs 291f,^LARRBFS 291f,larrfs 291d,^LARRFS 291d,"
    "larrhk 21a9,^LARRHK 21a9,larrlp 21ab,^LARRLP 21ab,larrpl 2939,^LARRPL 2939,larrsim 2973,^LARRSIM 2973,larrtl 21a2,"
    "^LARRTL 21a2,lat 2aab,^LAT 2aab,latail 2919,^LATAIL 2919,late 2aad,^LATE 2aad,lates 2aad+fe00,^LATES 2aad+fe00,"
    "lbarr 290c,^LBARR 290c,lbbrk 2772,^LBBRK 2772,lbrace 7b,^LBRACE 7b,lbrack 5b,^LBRACK 5b,lbrke 298b,^LBRKE 298b,"
    "lbrksld 298f,^LBRKSLD 298f,lbrkslu 298d,^LBRKSLU 298d,lcaron 13e,^LCARON 13d,lcedil 13c,^LCEDIL 13b,lceil 2308,"
    "^LCEIL 2308,lcub 7b,^LCUB 7b,lcy 43b,^LCY 41b,ldca 2936,^LDCA 2936,ldquo 201c,^LDQUO 201c,ldquor 201e,^LDQUOR 201e,"
    "ldrdhar 2967,^LDRDHAR 2967,ldrushar 294b,^LDRUSHAR 294b,ldsh 21b2,^LDSH 21b2,le 2264,^LE 2264,leftarrow 2190,"
    "^LEFTARROW 2190,leftarrowtail 21a2,^LEFTARROWTAIL 21a2,leftharpoondown 21bd,^LEFTHARPOONDOWN 21bd,leftharpoonup 21bc,"
    "^LEFTHARPOONUP 21bc,leftleftarrows 21c7,^LEFTLEFTARROWS 21c7,leftrightarrow 2194,^LEFTRIGHTARROW 2194,"
    "leftrightarrows 21c6,^LEFTRIGHTARROWS 21c6,leftrightharpoons 21cb,^LEFTRIGHTHARPOONS 21cb,leftrightsquigarrow 21ad,"
    "^LEFTRIGHTSQUIGARROW 21ad,leftthreetimes 22cb,^LEFTTHREETIMES 22cb,leg 22da,^LEG 22da,leq 2264,^LEQ 2264,leqq 2266,"
    "^LEQQ 2266,leqslant 2a7d,^LEQSLANT 2a7d,les 2a7d,^LES 2a7d,lescc 2aa8,^LESCC 2aa8,lesdot 2a7f,^LESDOT 2a7f,"
    "lesdoto 2a81,^LESDOTO 2a81,lesdotor 2a83,^LESDOTOR 2a83,lesg 22da+fe00,^LESG 22da+fe00,lesges 2a93,^LESGES 2a93,"
    "lessapprox 2a85,^LESSAPPROX 2a85,lessdot 22d6,^LESSDOT 22d6,lesseqgtr 22da,^LESSEQGTR 22da,lesseqqgtr 2a8b,"
    "^LESSEQQGTR 2a8b,lessgtr 2276,^LESSGTR 2276,lesssim 2272,^LESSSIM 2272,lfisht 297c,^LFISHT 297c,lfloor 230a,"
    "^LFLOOR 230a,lfr 1d529,^LFR 1d529,lg 2276,^LG 2276,lgE 2a91,lhard 21bd,^LHARD 21bd,lharu 21bc,^LHARU 21bc,"
    "lharul 296a,^LHARUL 296a,lhblk 2584,^LHBLK 2584,ljcy 459,^LJCY 409,ll 226a,^LL 226a,llarr 21c7,^LLARR 21c7,"
    "llcorner 231e,^LLCORNER 231e,llhard 296b,^LLHARD 296b,lltri 25fa,^LLTRI 25fa,lmidot 140,^LMIDOT 13f,lmoust 23b0,"
    "^LMOUST 23b0,lmoustache 23b0,^LMOUSTACHE 23b0,lnE 2268,lnap 2a89,^LNAP 2a89,lnapprox 2a89,^LNAPPROX 2a89,lne 2a87,"
    "^LNE 2a87,lneq 2a87,^LNEQ 2a87,lneqq 2268,^LNEQQ 2268,lnsim 22e6,^LNSIM 22e6,loang 27ec,^LOANG 27ec,loarr 21fd,"
    "^LOARR 21fd,lobrk 27e6,^LOBRK 27e6,longleftarrow 27f5,^LONGLEFTARROW 27f5,longleftrightarrow 27f7,"
    "^LONGLEFTRIGHTARROW 27f7,longmapsto 27fc,^LONGMAPSTO 27fc,longrightarrow 27f6,^LONGRIGHTARROW 27f6,"
    "looparrowleft 21ab,^LOOPARROWLEFT 21ab,looparrowright 21ac,^LOOPARROWRIGHT 21ac,lopar 2985,^LOPAR 2985,lopf 1d55d,"
    "^LOPF 1d55d,loplus 2a2d,^LOPLUS 2a2d,lotimes 2a34,^LOTIMES 2a34,lowast 2217,^LOWAST 2217,lowbar 5f,^LOWBAR 5f,"
    "loz 25ca,^LOZ 25ca,lozenge 25ca,^LOZENGE 25ca,lozf 29eb,^LOZF 29eb,lpar 28,^LPAR 28,lparlt 2993,^LPARLT 2993,"
    "lrarr 21c6,^LRARR 21c6,lrcorner 231f,^LRCORNER 231f,lrhar 21cb,^LRHAR 21cb,lrhard 296d,^LRHARD 296d,lrm 200e,"
    "^LRM 200e,lrtri 22bf,^LRTRI 22bf,lsaquo 2039,^LSAQUO 2039,lscr 1d4c1,^LSCR 1d4c1,lsh 21b0,^LSH 21b0,lsim 2272,"
    "^LSIM 2272,lsime 2a8d,^LSIME 2a8d,lsimg 2a8f,^LSIMG 2a8f,lsqb 5b,^LSQB 5b,lsquo 2018,^LSQUO 2018,lsquor 201a,"
    "^LSQUOR 201a,lstrok 142,^LSTROK 141,lt? 3c,ltcc 2aa6,ltcir 2a79,ltdot 22d6,lthree 22cb,ltimes 22c9,ltlarr 2976,"
    "ltquest 2a7b,ltrPar 2996,ltri 25c3,ltrie 22b4,ltrif 25c2,lurdshar 294a,^LURDSHAR 294a,luruhar 2966,^LURUHAR 2966,"
    "lvertneqq 2268+fe00,^LVERTNEQQ 2268+fe00,lvnE 2268+fe00,mDDot 223a,macr? af,^MACR af,male 2642,^MALE 2642,malt 2720,"
    "^MALT 2720,maltese 2720,^MALTESE 2720,map 21a6,^MAP 21a6,mapsto 21a6,^MAPSTO 21a6,mapstodown 21a7,^MAPSTODOWN 21a7,"
    "mapstoleft 21a4,^MAPSTOLEFT 21a4,mapstoup 21a5,^MAPSTOUP 21a5,marker 25ae,^MARKER 25ae,mcomma 2a29,^MCOMMA 2a29,"
    "mcy 43c,^MCY 41c,mdash 2014,^MDASH 2014,measuredangle 2221,^MEASUREDANGLE 2221,mfr 1d52a,^MFR 1d52a,mho 2127,"
    "^MHO 2127,micro? b5,^MICRO 39c,mid 2223,^MID 2223,midast 2a,^MIDAST 2a,midcir 2af0,^MIDCIR 2af0,middot? b7,"
    "^MIDDOT b7,minus 2212,^MINUS 2212,minusb 229f,^MINUSB 229f,minusd 2238,^MINUSD 2238,minusdu 2a2a,^MINUSDU 2a2a,"
    "mlcp 2adb,^MLCP 2adb,mldr 2026,^MLDR 2026,mnplus 2213,^MNPLUS 2213,models 22a7,^MODELS 22a7,mopf 1d55e,^MOPF 1d55e,"
    "mp 2213,^MP 2213,mscr 1d4c2,^MSCR 1d4c2,mstpos 223e,^MSTPOS 223e,mu 3bc,^MU 39c,multimap 22b8,^MULTIMAP 22b8,"
    "mumap 22b8,^MUMAP 22b8,nGg 22d9+338,nGt 226b+20d2,nGtv 226b+338,nLeftarrow 21cd,nLeftrightarrow 21ce,nLl 22d8+338,"
    "nLt 226a+20d2,nLtv 226a+338,nRightarrow 21cf,nVDash 22af,nVdash 22ae,nabla 2207,^NABLA 2207,nacute 144,^NACUTE 143,"
    "nang 2220+20d2,^NANG 2220+20d2,nap 2249,^NAP 2249,napE 2a70+338,napid 224b+338,^NAPID 224b+338,napos 149,"
    "^NAPOS 2bc+4e,napprox 2249,^NAPPROX 2249,natur 266e,^NATUR 266e,natural 266e,^NATURAL 266e,naturals 2115,"
    "^NATURALS 2115,nbsp? a0,^NBSP a0,nbump 224e+338,^NBUMP 224e+338,nbumpe 224f+338,^NBUMPE 224f+338,ncap 2a43,"
    "^NCAP 2a43,ncaron 148,^NCARON 147,ncedil 146,^NCEDIL 145,ncong 2247,^NCONG 2247,ncongdot 2a6d+338,^NCONGDOT 2a6d+338,"
    "ncup 2a42,^NCUP 2a42,ncy 43d,^NCY 41d,ndash 2013,^NDASH 2013,ne 2260,^NE 2260,neArr 21d7,nearhk 2924,^NEARHK 2924,"
    "nearr 2197,^NEARR 2197,nearrow 2197,^NEARROW 2197,nedot 2250+338,^NEDOT 2250+338,nequiv 2262,^NEQUIV 2262,"
    "nesear 2928,^NESEAR 2928,nesim 2242+338,^NESIM 2242+338,nexist 2204,^NEXIST 2204,nexists 2204,^NEXISTS 2204,"
    "nfr 1d52b,^NFR 1d52b,ngE 2267+338,nge 2271,^NGE 2271,ngeq 2271,^NGEQ 2271,ngeqq 2267+338,^NGEQQ 2267+338,"
    "ngeqslant 2a7e+338,^NGEQSLANT 2a7e+338,nges 2a7e+338,^NGES 2a7e+338,ngsim 2275,^NGSIM 2275,ngt 226f,^NGT 226f,"
    "ngtr 226f,^NGTR 226f,nhArr 21ce,nharr 21ae,^NHARR 21ae,nhpar 2af2,^NHPAR 2af2,ni 220b,^NI 220b,nis 22fc,^NIS 22fc,"
    "nisd 22fa,^NISD 22fa,niv 220b,^NIV 220b,njcy 45a,^NJCY 40a,nlArr 21cd,nlE 2266+338,nlarr 219a,^NLARR 219a,nldr 2025,"
    "^NLDR 2025,nle 2270,^NLE 2270,nleftarrow 219a,^NLEFTARROW 219a,nleftrightarrow 21ae,^NLEFTRIGHTARROW 21ae,nleq 2270,"
    "^NLEQ 2270,nleqq 2266+338,^NLEQQ 2266+338,nleqslant 2a7d+338,^NLEQSLANT 2a7d+338,nles 2a7d+338,^NLES 2a7d+338,"
    "nless 226e,^NLESS 226e,nlsim 2274,^NLSIM 2274,nlt 226e,^NLT 226e,nltri 22ea,^NLTRI 22ea,nltrie 22ec,^NLTRIE 22ec,"
    "nmid 2224,^NMID 2224,nopf 1d55f,^NOPF 1d55f,not? ac,^NOT ac,notin 2209,^NOTIN 2209,notinE 22f9+338,notindot 22f5+338,"
    "^NOTINDOT 22f5+338,notinva 2209,^NOTINVA 2209,notinvb 22f7,^NOTINVB 22f7,notinvc 22f6,^NOTINVC 22f6,notni 220c,"
    "^NOTNI 220c,notniva 220c,^NOTNIVA 220c,notnivb 22fe,^NOTNIVB 22fe,notnivc 22fd,^NOTNIVC 22fd,npar 2226,^NPAR 2226,"
    "nparallel 2226,^NPARALLEL 2226,nparsl 2afd+20e5,^NPARSL 2afd+20e5,npart 2202+338,^NPART 2202+338,npolint 2a14,"
    "^NPOLINT 2a14,npr 2280,^NPR 2280,nprcue 22e0,^NPRCUE 22e0,npre 2aaf+338,^NPRE 2aaf+338,nprec 2280,^NPREC 2280,"
    "npreceq 2aaf+338,^NPRECEQ 2aaf+338,nrArr 21cf,nrarr 219b,^NRARR 219b,nrarrc 2933+338,^NRARRC 2933+338,"
    "nrarrw 219d+338,^NRARRW 219d+338,nrightarrow 219b,^NRIGHTARROW 219b,nrtri 22eb,^NRTRI 22eb,nrtrie 22ed,^NRTRIE 22ed,"
    "nsc 2281,^NSC 2281,nsccue 22e1,^NSCCUE 22e1,nsce 2ab0+338,^NSCE 2ab0+338,nscr 1d4c3,^NSCR 1d4c3,nshortmid 2224,"
    "^NSHORTMID 2224,nshortparallel 2226,^NSHORTPARALLEL 2226,nsim 2241,^NSIM 2241,nsime 2244,^NSIME 2244,nsimeq 2244,"
    "^NSIMEQ 2244,nsmid 2224,^NSMID 2224,nspar 2226,^NSPAR 2226,nsqsube 22e2,^NSQSUBE 22e2,nsqsupe 22e3,^NSQSUPE 22e3,"
    "nsub 2284,^NSUB 2284,nsubE 2ac5+338,nsube 2288,^NSUBE 2288,nsubset 2282+20d2,^NSUBSET 2282+20d2,nsubseteq 2288,"
    "^NSUBSETEQ 2288,nsubseteqq 2ac5+338,^NSUBSETEQQ 2ac5+338,nsucc 2281,^NSUCC 2281,nsucceq 2ab0+338,^NSUCCEQ 2ab0+338,"
    "nsup 2285,^NSUP 2285,nsupE 2ac6+338,nsupe 2289,^NSUPE 2289,nsupset 2283+20d2,^NSUPSET 2283+20d2,nsupseteq 2289,"
    "^NSUPSETEQ 2289,nsupseteqq 2ac6+338,^NSUPSETEQQ 2ac6+338,ntgl 2279,^NTGL 2279,ntilde? f1,^NTILDE d1,ntlg 2278,"
    "^NTLG 2278,ntriangleleft 22ea,^NTRIANGLELEFT 22ea,ntrianglelefteq 22ec,^NTRIANGLELEFTEQ 22ec,ntriangleright 22eb,"
    "^NTRIANGLERIGHT 22eb,ntrianglerighteq 22ed,^NTRIANGLERIGHTEQ 22ed,nu 3bd,^NU 39d,num 23,^NUM 23,numero 2116,"
    "^NUMERO 2116,numsp 2007,^NUMSP 2007,nvDash 22ad,nvHarr 2904,nvap 224d+20d2,^NVAP 224d+20d2,nvdash 22ac,^NVDASH 22ac,"
    "nvge 2265+20d2,^NVGE 2265+20d2,nvgt 3e+20d2,^NVGT 3e+20d2,nvinfin 29de,^NVINFIN 29de,nvlArr 2902,nvle 2264+20d2,"
    "^NVLE 2264+20d2,nvlt 3c+20d2,^NVLT 3c+20d2,nvltrie 22b4+20d2,^NVLTRIE 22b4+20d2,nvrArr 2903,nvrtrie 22b5+20d2,"
    "^NVRTRIE 22b5+20d2,nvsim 223c+20d2,^NVSIM 223c+20d2,nwArr 21d6,nwarhk 2923,^NWARHK 2923,nwarr 2196,^NWARR 2196,"
    "nwarrow 2196,^NWARROW 2196,nwnear 2927,^NWNEAR 2927,oS 24c8,oacute? f3,^OACUTE d3,oast 229b,^OAST 229b,ocir 229a,"
    "^OCIR 229a,ocirc? f4,^OCIRC d4,ocy 43e,^OCY 41e,odash 229d,^ODASH 229d,odblac 151,^ODBLAC 150,odiv 2a38,^ODIV 2a38,"
    "odot 2299,^ODOT 2299,odsold 29bc,^ODSOLD 29bc,oelig 153,^OELIG 152,ofcir 29bf,^OFCIR 29bf,ofr 1d52c,^OFR 1d52c,"
    "ogon 2db,^OGON 2db,ograve? f2,^OGRAVE d2,ogt 29c1,^OGT 29c1,ohbar 29b5,^OHBAR 29b5,ohm 3a9,^OHM 3a9,oint 222e,"
    "^OINT 222e,olarr 21ba,^OLARR 21ba,olcir 29be,^OLCIR 29be,olcross 29bb,^OLCROSS 29bb,oline 203e,^OLINE 203e,olt 29c0,"
    "^OLT 29c0,omacr 14d,^OMACR 14c,omega 3c9,^OMEGA 3a9,omicron 3bf,^OMICRON 39f,omid 29b6,^OMID 29b6,ominus 2296,"
    "^OMINUS 2296,oopf 1d560,^OOPF 1d560,opar 29b7,^OPAR 29b7,operp 29b9,^OPERP 29b9,oplus 2295,^OPLUS 2295,or 2228,"
    "^OR 2228,orarr 21bb,^ORARR 21bb,ord 2a5d,^ORD 2a5d,order 2134,^ORDER 2134,orderof 2134,^ORDEROF 2134,ordf? aa,"
    "^ORDF aa,ordm? ba,^ORDM ba,origof 22b6,^ORIGOF 22b6,oror 2a56,^OROR 2a56,orslope 2a57,^ORSLOPE 2a57,orv 2a5b,"
    "^ORV 2a5b,oscr 2134,^OSCR 2134,oslash? f8,^OSLASH d8,osol 2298,^OSOL 2298,otilde? f5,^OTILDE d5,otimes 2297,"
    "^OTIMES 2297,otimesas 2a36,^OTIMESAS 2a36,ouml? f6,^OUML d6,ovbar 233d,^OVBAR 233d,par 2225,^PAR 2225,para? b6,"
    "^PARA b6,parallel 2225,^PARALLEL 2225,parsim 2af3,^PARSIM 2af3,parsl 2afd,^PARSL 2afd,part 2202,^PART 2202,pcy 43f,"
    "^PCY 41f,percnt 25,^PERCNT 25,period 2e,^PERIOD 2e,permil 2030,^PERMIL 2030,perp 22a5,^PERP 22a5,pertenk 2031,"
    "^PERTENK 2031,pfr 1d52d,^PFR 1d52d,phi 3c6,^PHI 3a6,phiv 3d5,^PHIV 3a6,phmmat 2133,^PHMMAT 2133,phone 260e,"
    "^PHONE 260e,pi 3c0,^PI 3a0,pitchfork 22d4,^PITCHFORK 22d4,piv 3d6,^PIV 3a0,planck 210f,^PLANCK 210f,planckh 210e,"
    "^PLANCKH 210e,plankv 210f,^PLANKV 210f,plus 2b,^PLUS 2b,plusacir 2a23,^PLUSACIR 2a23,plusb 229e,^PLUSB 229e,"
    "pluscir 2a22,^PLUSCIR 2a22,plusdo 2214,^PLUSDO 2214,plusdu 2a25,^PLUSDU 2a25,pluse 2a72,^PLUSE 2a72,plusmn? b1,"
    "^PLUSMN b1,plussim 2a26,^PLUSSIM 2a26,plustwo 2a27,^PLUSTWO 2a27,pm b1,^PM b1,pointint 2a15,^POINTINT 2a15,"
    "popf 1d561,^POPF 1d561,pound? a3,^POUND a3,pr 227a,^PR 227a,prE 2ab3,prap 2ab7,^PRAP 2ab7,prcue 227c,^PRCUE 227c,"
    "pre 2aaf,^PRE 2aaf,prec 227a,^PREC 227a,precapprox 2ab7,^PRECAPPROX 2ab7,preccurlyeq 227c,^PRECCURLYEQ 227c,"
    "preceq 2aaf,^PRECEQ 2aaf,precnapprox 2ab9,^PRECNAPPROX 2ab9,precneqq 2ab5,^PRECNEQQ 2ab5,precnsim 22e8,"
    "^PRECNSIM 22e8,precsim 227e,^PRECSIM 227e,prime 2032,^PRIME 2032,primes 2119,^PRIMES 2119,prnE 2ab5,prnap 2ab9,"
    "^PRNAP 2ab9,prnsim 22e8,^PRNSIM 22e8,prod 220f,^PROD 220f,profalar 232e,^PROFALAR 232e,profline 2312,^PROFLINE 2312,"
    "profsurf 2313,^PROFSURF 2313,prop 221d,^PROP 221d,propto 221d,^PROPTO 221d,prsim 227e,^PRSIM 227e,prurel 22b0,"
    "^PRUREL 22b0,pscr 1d4c5,^PSCR 1d4c5,psi 3c8,^PSI 3a8,puncsp 2008,^PUNCSP 2008,qfr 1d52e,^QFR 1d52e,qint 2a0c,"
    "^QINT 2a0c,qopf 1d562,^QOPF 1d562,qprime 2057,^QPRIME 2057,qscr 1d4c6,^QSCR 1d4c6,quaternions 210d,^QUATERNIONS 210d,"
    "quatint 2a16,^QUATINT 2a16,quest 3f,^QUEST 3f,questeq 225f,^QUESTEQ 225f,quot? 22,rAarr 21db,rArr 21d2,rAtail 291c,"
    "rBarr 290f,rHar 2964,race 223d+331,^RACE 223d+331,racute 155,^RACUTE 154,radic 221a,^RADIC 221a,raemptyv 29b3,"
    "^RAEMPTYV 29b3,rang 27e9,^RANG 27e9,rangd 2992,^RANGD 2992,range 29a5,^RANGE 29a5,rangle 27e9,^RANGLE 27e9,raquo? bb,"
    "^RAQUO bb,rarr 2192,^RARR 2192,rarrap 2975,^RARRAP 2975,rarrb 21e5,^RARRB 21e5,rarrbfs 2920,^RARRBFS 2920,rarrc 2933,"
    "^RARRC 2933,rarrfs 291e,^RARRFS 291e,rarrhk 21aa,^RARRHK 21aa,rarrlp 21ac,^RARRLP 21ac,rarrpl 2945,^RARRPL 2945,"
    "rarrsim 2974,^RARRSIM 2974,rarrtl 21a3,^RARRTL 21a3,rarrw 219d,^RARRW 219d,ratail 291a,^RATAIL 291a,ratio 2236,"
    "^RATIO 2236,rationals 211a,^RATIONALS 211a,rbarr 290d,^RBARR 290d,rbbrk 2773,^RBBRK 2773,rbrace 7d,^RBRACE 7d,"
    "rbrack 5d,^RBRACK 5d,rbrke 298c,^RBRKE 298c,rbrksld 298e,^RBRKSLD 298e,rbrkslu 2990,^RBRKSLU 2990,rcaron 159,"
    "^RCARON 158,rcedil 157,^RCEDIL 156,rceil 2309,^RCEIL 2309,rcub 7d,^RCUB 7d,rcy 440,^RCY 420,rdca 2937,^RDCA 2937,"
    "rdldhar 2969,^RDLDHAR 2969,rdquo 201d,^RDQUO 201d,rdquor 201d,^RDQUOR 201d,rdsh 21b3,^RDSH 21b3,real 211c,^REAL 211c,"
    "realine 211b,^REALINE 211b,realpart 211c,^REALPART 211c,reals 211d,^REALS 211d,rect 25ad,^RECT 25ad,reg? ae,"
    "rfisht 297d,^RFISHT 297d,rfloor 230b,^RFLOOR 230b,rfr 1d52f,^RFR 1d52f,rhard 21c1,^RHARD 21c1,rharu 21c0,^RHARU 21c0,"
    "rharul 296c,^RHARUL 296c,rho 3c1,^RHO 3a1,rhov 3f1,^RHOV 3a1,rightarrow 2192,^RIGHTARROW 2192,rightarrowtail 21a3,"
    "^RIGHTARROWTAIL 21a3,rightharpoondown 21c1,^RIGHTHARPOONDOWN 21c1,rightharpoonup 21c0,^RIGHTHARPOONUP 21c0,"
    "rightleftarrows 21c4,^RIGHTLEFTARROWS 21c4,rightleftharpoons 21cc,^RIGHTLEFTHARPOONS 21cc,rightrightarrows 21c9,"
    "^RIGHTRIGHTARROWS 21c9,rightsquigarrow 219d,^RIGHTSQUIGARROW 219d,rightthreetimes 22cc,^RIGHTTHREETIMES 22cc,"
    "ring 2da,^RING 2da,risingdotseq 2253,^RISINGDOTSEQ 2253,rlarr 21c4,^RLARR 21c4,rlhar 21cc,^RLHAR 21cc,rlm 200f,"
    "^RLM 200f,rmoust 23b1,^RMOUST 23b1,rmoustache 23b1,^RMOUSTACHE 23b1,rnmid 2aee,^RNMID 2aee,roang 27ed,^ROANG 27ed,"
    "roarr 21fe,^ROARR 21fe,robrk 27e7,^ROBRK 27e7,ropar 2986,^ROPAR 2986,ropf 1d563,^ROPF 1d563,roplus 2a2e,^ROPLUS 2a2e,"
    "rotimes 2a35,^ROTIMES 2a35,rpar 29,^RPAR 29,rpargt 2994,^RPARGT 2994,rppolint 2a12,^RPPOLINT 2a12,rrarr 21c9,"
    "^RRARR 21c9,rsaquo 203a,^RSAQUO 203a,rscr 1d4c7,^RSCR 1d4c7,rsh 21b1,^RSH 21b1,rsqb 5d,^RSQB 5d,rsquo 2019,"
    "^RSQUO 2019,rsquor 2019,^RSQUOR 2019,rthree 22cc,^RTHREE 22cc,rtimes 22ca,^RTIMES 22ca,rtri 25b9,^RTRI 25b9,"
    "rtrie 22b5,^RTRIE 22b5,rtrif 25b8,^RTRIF 25b8,rtriltri 29ce,^RTRILTRI 29ce,ruluhar 2968,^RULUHAR 2968,rx 211e,"
    "^RX 211e,sacute 15b,^SACUTE 15a,sbquo 201a,^SBQUO 201a,sc 227b,^SC 227b,scE 2ab4,scap 2ab8,^SCAP 2ab8,scaron 161,"
    "^SCARON 160,sccue 227d,^SCCUE 227d,sce 2ab0,^SCE 2ab0,scedil 15f,^SCEDIL 15e,scirc 15d,^SCIRC 15c,scnE 2ab6,"
    "scnap 2aba,^SCNAP 2aba,scnsim 22e9,^SCNSIM 22e9,scpolint 2a13,^SCPOLINT 2a13,scsim 227f,^SCSIM 227f,scy 441,^SCY 421,"
    "sdot 22c5,^SDOT 22c5,sdotb 22a1,^SDOTB 22a1,sdote 2a66,^SDOTE 2a66,seArr 21d8,searhk 2925,^SEARHK 2925,searr 2198,"
    "^SEARR 2198,searrow 2198,^SEARROW 2198,sect? a7,^SECT a7,semi 3b,^SEMI 3b,seswar 2929,^SESWAR 2929,setminus 2216,"
    "^SETMINUS 2216,setmn 2216,^SETMN 2216,sext 2736,^SEXT 2736,sfr 1d530,^SFR 1d530,sfrown 2322,^SFROWN 2322,sharp 266f,"
    "^SHARP 266f,shchcy 449,^SHCHCY 429,shcy 448,^SHCY 428,shortmid 2223,^SHORTMID 2223,shortparallel 2225,"
    "^SHORTPARALLEL 2225,shy? ad,^SHY ad,sigma 3c3,^SIGMA 3a3,sigmaf 3c2,^SIGMAF 3a3,sigmav 3c2,^SIGMAV 3a3,sim 223c,"
    "^SIM 223c,simdot 2a6a,^SIMDOT 2a6a,sime 2243,^SIME 2243,simeq 2243,^SIMEQ 2243,simg 2a9e,^SIMG 2a9e,simgE 2aa0,"
    "siml 2a9d,^SIML 2a9d,simlE 2a9f,simne 2246,^SIMNE 2246,simplus 2a24,^SIMPLUS 2a24,simrarr 2972,^SIMRARR 2972,"
    "slarr 2190,^SLARR 2190,smallsetminus 2216,^SMALLSETMINUS 2216,smashp 2a33,^SMASHP 2a33,smeparsl 29e4,^SMEPARSL 29e4,"
    "smid 2223,^SMID 2223,smile 2323,^SMILE 2323,smt 2aaa,^SMT 2aaa,smte 2aac,^SMTE 2aac,smtes 2aac+fe00,^SMTES 2aac+fe00,"
    "softcy 44c,^SOFTCY 42c,sol 2f,^SOL 2f,solb 29c4,^SOLB 29c4,solbar 233f,^SOLBAR 233f,sopf 1d564,^SOPF 1d564,"
    "spades 2660,^SPADES 2660,spadesuit 2660,^SPADESUIT 2660,spar 2225,^SPAR 2225,sqcap 2293,^SQCAP 2293,sqcaps 2293+fe00,"
    "^SQCAPS 2293+fe00,sqcup 2294,^SQCUP 2294,sqcups 2294+fe00,^SQCUPS 2294+fe00,sqsub 228f,^SQSUB 228f,sqsube 2291,"
    "^SQSUBE 2291,sqsubset 228f,^SQSUBSET 228f,sqsubseteq 2291,^SQSUBSETEQ 2291,sqsup 2290,^SQSUP 2290,sqsupe 2292,"
    "^SQSUPE 2292,sqsupset 2290,^SQSUPSET 2290,sqsupseteq 2292,^SQSUPSETEQ 2292,squ 25a1,^SQU 25a1,square 25a1,"
    "^SQUARE 25a1,squarf 25aa,^SQUARF 25aa,squf 25aa,^SQUF 25aa,srarr 2192,^SRARR 2192,sscr 1d4c8,^SSCR 1d4c8,ssetmn 2216,"
    "^SSETMN 2216,ssmile 2323,^SSMILE 2323,sstarf 22c6,^SSTARF 22c6,star 2606,^STAR 2606,starf 2605,^STARF 2605,"
    "straightepsilon 3f5,^STRAIGHTEPSILON 395,straightphi 3d5,^STRAIGHTPHI 3a6,strns af,^STRNS af,sub 2282,^SUB 2282,"
    "subE 2ac5,subdot 2abd,^SUBDOT 2abd,sube 2286,^SUBE 2286,subedot 2ac3,^SUBEDOT 2ac3,submult 2ac1,^SUBMULT 2ac1,"
    "subnE 2acb,subne 228a,^SUBNE 228a,subplus 2abf,^SUBPLUS 2abf,subrarr 2979,^SUBRARR 2979,subset 2282,^SUBSET 2282,"
    "subseteq 2286,^SUBSETEQ 2286,subseteqq 2ac5,^SUBSETEQQ 2ac5,subsetneq 228a,^SUBSETNEQ 228a,subsetneqq 2acb,"
    "^SUBSETNEQQ 2acb,subsim 2ac7,^SUBSIM 2ac7,subsub 2ad5,^SUBSUB 2ad5,subsup 2ad3,^SUBSUP 2ad3,succ 227b,^SUCC 227b,"
    "succapprox 2ab8,^SUCCAPPROX 2ab8,succcurlyeq 227d,^SUCCCURLYEQ 227d,succeq 2ab0,^SUCCEQ 2ab0,succnapprox 2aba,"
    "^SUCCNAPPROX 2aba,succneqq 2ab6,^SUCCNEQQ 2ab6,succnsim 22e9,^SUCCNSIM 22e9,succsim 227f,^SUCCSIM 227f,sum 2211,"
    "^SUM 2211,sung 266a,^SUNG 266a,sup1? b9,^SUP1 b9,sup2? b2,^SUP2 b2,sup3? b3,^SUP3 b3,sup 2283,^SUP 2283,supE 2ac6,"
    "supdot 2abe,^SUPDOT 2abe,supdsub 2ad8,^SUPDSUB 2ad8,supe 2287,^SUPE 2287,supedot 2ac4,^SUPEDOT 2ac4,suphsol 27c9,"
    "^SUPHSOL 27c9,suphsub 2ad7,^SUPHSUB 2ad7,suplarr 297b,^SUPLARR 297b,supmult 2ac2,^SUPMULT 2ac2,supnE 2acc,supne 228b,"
    "^SUPNE 228b,supplus 2ac0,^SUPPLUS 2ac0,supset 2283,^SUPSET 2283,supseteq 2287,^SUPSETEQ 2287,supseteqq 2ac6,"
    "^SUPSETEQQ 2ac6,supsetneq 228b,^SUPSETNEQ 228b,supsetneqq 2acc,^SUPSETNEQQ 2acc,supsim 2ac8,^SUPSIM 2ac8,supsub 2ad4,"
    "^SUPSUB 2ad4,supsup 2ad6,^SUPSUP 2ad6,swArr 21d9,swarhk 2926,^SWARHK 2926,swarr 2199,^SWARR 2199,swarrow 2199,"
    "^SWARROW 2199,swnwar 292a,^SWNWAR 292a,szlig? df,^SZLIG 53+53,target 2316,^TARGET 2316,tau 3c4,^TAU 3a4,tbrk 23b4,"
    "^TBRK 23b4,tcaron 165,^TCARON 164,tcedil 163,^TCEDIL 162,tcy 442,^TCY 422,tdot 20db,^TDOT 20db,telrec 2315,"
    "^TELREC 2315,tfr 1d531,^TFR 1d531,there4 2234,^THERE4 2234,therefore 2234,^THEREFORE 2234,theta 3b8,^THETA 398,"
    "thetasym 3d1,^THETASYM 398,thetav 3d1,^THETAV 398,thickapprox 2248,^THICKAPPROX 2248,thicksim 223c,^THICKSIM 223c,"
    "thinsp 2009,^THINSP 2009,thkap 2248,^THKAP 2248,thksim 223c,^THKSIM 223c,thorn? fe,tilde 2dc,^TILDE 2dc,times? d7,"
    "^TIMES d7,timesb 22a0,^TIMESB 22a0,timesbar 2a31,^TIMESBAR 2a31,timesd 2a30,^TIMESD 2a30,tint 222d,^TINT 222d,"
    "toea 2928,^TOEA 2928,top 22a4,^TOP 22a4,topbot 2336,^TOPBOT 2336,topcir 2af1,^TOPCIR 2af1,topf 1d565,^TOPF 1d565,"
    "topfork 2ada,^TOPFORK 2ada,tosa 2929,^TOSA 2929,tprime 2034,^TPRIME 2034,trade 2122,triangle 25b5,^TRIANGLE 25b5,"
    "triangledown 25bf,^TRIANGLEDOWN 25bf,triangleleft 25c3,^TRIANGLELEFT 25c3,trianglelefteq 22b4,^TRIANGLELEFTEQ 22b4,"
    "triangleq 225c,^TRIANGLEQ 225c,triangleright 25b9,^TRIANGLERIGHT 25b9,trianglerighteq 22b5,^TRIANGLERIGHTEQ 22b5,"
    "tridot 25ec,^TRIDOT 25ec,trie 225c,^TRIE 225c,triminus 2a3a,^TRIMINUS 2a3a,triplus 2a39,^TRIPLUS 2a39,trisb 29cd,"
    "^TRISB 29cd,tritime 2a3b,^TRITIME 2a3b,trpezium 23e2,^TRPEZIUM 23e2,tscr 1d4c9,^TSCR 1d4c9,tscy 446,^TSCY 426,"
    "tshcy 45b,^TSHCY 40b,tstrok 167,^TSTROK 166,twixt 226c,^TWIXT 226c,twoheadleftarrow 219e,^TWOHEADLEFTARROW 219e,"
    "twoheadrightarrow 21a0,^TWOHEADRIGHTARROW 21a0,uArr 21d1,uHar 2963,uacute? fa,^UACUTE da,uarr 2191,^UARR 2191,"
    "ubrcy 45e,^UBRCY 40e,ubreve 16d,^UBREVE 16c,ucirc? fb,^UCIRC db,ucy 443,^UCY 423,udarr 21c5,^UDARR 21c5,udblac 171,"
    "^UDBLAC 170,udhar 296e,^UDHAR 296e,ufisht 297e,^UFISHT 297e,ufr 1d532,^UFR 1d532,ugrave? f9,^UGRAVE d9,uharl 21bf,"
    "^UHARL 21bf,uharr 21be,^UHARR 21be,uhblk 2580,^UHBLK 2580,ulcorn 231c,^ULCORN 231c,ulcorner 231c,^ULCORNER 231c,"
    "ulcrop 230f,^ULCROP 230f,ultri 25f8,^ULTRI 25f8,umacr 16b,^UMACR 16a,uml? a8,^UML a8,uogon 173,^UOGON 172,uopf 1d566,"
    "^UOPF 1d566,uparrow 2191,^UPARROW 2191,updownarrow 2195,^UPDOWNARROW 2195,upharpoonleft 21bf,^UPHARPOONLEFT 21bf,"
    "upharpoonright 21be,^UPHARPOONRIGHT 21be,uplus 228e,^UPLUS 228e,upsi 3c5,^UPSI 3a5,upsih 3d2,^UPSIH 3d2,upsilon 3c5,"
    "^UPSILON 3a5,upuparrows 21c8,^UPUPARROWS 21c8,urcorn 231d,^URCORN 231d,urcorner 231d,^URCORNER 231d,urcrop 230e,"
    "^URCROP 230e,uring 16f,^URING 16e,urtri 25f9,^URTRI 25f9,uscr 1d4ca,^USCR 1d4ca,utdot 22f0,^UTDOT 22f0,utilde 169,"
    "^UTILDE 168,utri 25b5,^UTRI 25b5,utrif 25b4,^UTRIF 25b4,uuarr 21c8,^UUARR 21c8,uuml? fc,^UUML dc,uwangle 29a7,"
    "^UWANGLE 29a7,vArr 21d5,vBar 2ae8,vBarv 2ae9,vDash 22a8,vangrt 299c,^VANGRT 299c,varepsilon 3f5,^VAREPSILON 395,"
    "varkappa 3f0,^VARKAPPA 39a,varnothing 2205,^VARNOTHING 2205,varphi 3d5,^VARPHI 3a6,varpi 3d6,^VARPI 3a0,"
    "varpropto 221d,^VARPROPTO 221d,varr 2195,^VARR 2195,varrho 3f1,^VARRHO 3a1,varsigma 3c2,^VARSIGMA 3a3,"
    "varsubsetneq 228a+fe00,^VARSUBSETNEQ 228a+fe00,varsubsetneqq 2acb+fe00,^VARSUBSETNEQQ 2acb+fe00,"
    "varsupsetneq 228b+fe00,^VARSUPSETNEQ 228b+fe00,varsupsetneqq 2acc+fe00,^VARSUPSETNEQQ 2acc+fe00,vartheta 3d1,"
    "^VARTHETA 398,vartriangleleft 22b2,^VARTRIANGLELEFT 22b2,vartriangleright 22b3,^VARTRIANGLERIGHT 22b3,vcy 432,"
    "^VCY 412,vdash 22a2,^VDASH 22a2,vee 2228,^VEE 2228,veebar 22bb,^VEEBAR 22bb,veeeq 225a,^VEEEQ 225a,vellip 22ee,"
    "^VELLIP 22ee,verbar 7c,^VERBAR 7c,vert 7c,^VERT 7c,vfr 1d533,^VFR 1d533,vltri 22b2,^VLTRI 22b2,vnsub 2282+20d2,"
    "^VNSUB 2282+20d2,vnsup 2283+20d2,^VNSUP 2283+20d2,vopf 1d567,^VOPF 1d567,vprop 221d,^VPROP 221d,vrtri 22b3,"
    "^VRTRI 22b3,vscr 1d4cb,^VSCR 1d4cb,vsubnE 2acb+fe00,vsubne 228a+fe00,^VSUBNE 228a+fe00,vsupnE 2acc+fe00,"
    "vsupne 228b+fe00,^VSUPNE 228b+fe00,vzigzag 299a,^VZIGZAG 299a,wcirc 175,^WCIRC 174,wedbar 2a5f,^WEDBAR 2a5f,"
    "wedge 2227,^WEDGE 2227,wedgeq 2259,^WEDGEQ 2259,weierp 2118,^WEIERP 2118,wfr 1d534,^WFR 1d534,wopf 1d568,^WOPF 1d568,"
    "wp 2118,^WP 2118,wr 2240,^WR 2240,wreath 2240,^WREATH 2240,wscr 1d4cc,^WSCR 1d4cc,xcap 22c2,^XCAP 22c2,xcirc 25ef,"
    "^XCIRC 25ef,xcup 22c3,^XCUP 22c3,xdtri 25bd,^XDTRI 25bd,xfr 1d535,^XFR 1d535,xhArr 27fa,xharr 27f7,^XHARR 27f7,"
    "xi 3be,^XI 39e,xlArr 27f8,xlarr 27f5,^XLARR 27f5,xmap 27fc,^XMAP 27fc,xnis 22fb,^XNIS 22fb,xodot 2a00,^XODOT 2a00,"
    "xopf 1d569,^XOPF 1d569,xoplus 2a01,^XOPLUS 2a01,xotime 2a02,^XOTIME 2a02,xrArr 27f9,xrarr 27f6,^XRARR 27f6,"
    "xscr 1d4cd,^XSCR 1d4cd,xsqcup 2a06,^XSQCUP 2a06,xuplus 2a04,^XUPLUS 2a04,xutri 25b3,^XUTRI 25b3,xvee 22c1,^XVEE 22c1,"
    "xwedge 22c0,^XWEDGE 22c0,yacute? fd,^YACUTE dd,yacy 44f,^YACY 42f,ycirc 177,^YCIRC 176,ycy 44b,^YCY 42b,yen? a5,"
    "^YEN a5,yfr 1d536,^YFR 1d536,yicy 457,^YICY 407,yopf 1d56a,^YOPF 1d56a,yscr 1d4ce,^YSCR 1d4ce,yucy 44e,^YUCY 42e,"
    "yuml? ff,^YUML 178,zacute 17a,^ZACUTE 179,zcaron 17e,^ZCARON 17d,zcy 437,^ZCY 417,zdot 17c,^ZDOT 17b,zeetrf 2128,"
    "^ZEETRF 2128,zeta 3b6,^ZETA 396,zfr 1d537,^ZFR 1d537,zhcy 436,^ZHCY 416,zigrarr 21dd,^ZIGRARR 21dd,zopf 1d56b,"
    "^ZOPF 1d56b,zscr 1d4cf,^ZSCR 1d4cf,zwj 200d,^ZWJ 200d,zwnj 200c,^ZWNJ 200c,";

}  // namespace motionlang::inline MOTIONLANG_ABI::detail
// clang-format on
#endif

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// What Windows-1252 shows for the bytes 0x80 ... 0x9F; five of them are undefined and stay.
constexpr char32_t from_windows_1252(char32_t c) {
  constexpr char16_t shown[] = {0x20AC, 0x81,   0x201A, 0x192,  0x201E, 0x2026, 0x2020, 0x2021, 0x2C6,  0x2030, 0x160,
                                0x2039, 0x152,  0x8D,   0x17D,  0x8F,   0x90,   0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
                                0x2013, 0x2014, 0x2DC,  0x2122, 0x161,  0x203A, 0x153,  0x9D,   0x17E,  0x178};
  return c >= 0x80 && c < 0xA0 ? shown[c - 0x80] : c;
}

struct HtmlEntity {
  std::string text;             // UTF-8
  bool bare = false;            // its semicolon may be missing
  bool only_in_repair = false;  // a name in capitals that HTML does not know
};

inline const std::unordered_map<std::string_view, HtmlEntity>& html_entity_table() {
  static const auto table = [] {
    std::unordered_map<std::string_view, HtmlEntity> out;
    for (std::string_view rest = html_entities; !rest.empty();) {
      std::string_view name = rest.substr(0, rest.find(' '));
      std::string_view points = rest.substr(name.size() + 1, rest.find(',') - name.size() - 1);
      rest.remove_prefix(rest.find(',') + 1);
      HtmlEntity e;
      e.bare = name.ends_with('?'), e.only_in_repair = name.starts_with('^');
      name = name.substr(e.only_in_repair, name.size() - e.bare - e.only_in_repair);
      char32_t c = 0;
      for (const char digit : points) {
        if (digit == '+')
          append_utf8(e.text, std::exchange(c, 0));
        else
          c = c * 16 + static_cast<char32_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
      }
      append_utf8(e.text, c);
      out.emplace(name, std::move(e));
    }
    return out;
  }();
  return table;
}

/// A numeric character reference at text[at] == '&': its text, and the place behind it. None if there is no digit.
struct Reference {
  std::string text;
  std::size_t end = 0;
};
inline std::optional<Reference> numeric_reference(std::string_view text, std::size_t at) {
  if (at + 2 >= text.size() || text[at + 1] != '#') return std::nullopt;
  const bool hexadecimal = (text[at + 2] | 0x20) == 'x';
  const std::size_t first = at + (hexadecimal ? 3 : 2);
  std::size_t end = first;
  char32_t c = 0;
  for (; end < text.size(); ++end) {
    const char lower = static_cast<char>(text[end] | 0x20), plain = text[end];
    const bool digit = plain >= '0' && plain <= '9';
    if (!digit && !(hexadecimal && lower >= 'a' && lower <= 'f')) break;
    c = c * (hexadecimal ? 16 : 10) + static_cast<char32_t>(digit ? plain - '0' : lower - 'a' + 10);
    c = std::min<char32_t>(c, 0x110000);
  }
  if (end == first) return std::nullopt;
  Reference out{{}, end + (end < text.size() && text[end] == ';')};
  c = from_windows_1252(c);
  const bool refused = (c >= 1 && c <= 8) || c == 0xB || (c >= 0xE && c <= 0x1F) || c == 0x7F ||
                       (c >= 0xFDD0 && c <= 0xFDEF) || (c & 0xFFFE) == 0xFFFE;
  if (c == 0 || (c >= 0xD800 && c <= 0xDFFF) || c > 0x10FFFF)
    append_utf8(out.text, 0xFFFD);
  else if (!refused)
    append_utf8(out.text, c);
  return out;
}

constexpr bool is_ascii_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z');
}

/// Replaces what `reference(text, at)` reads at every '&'.
template <class F>
std::string replace_references(std::string_view text, F reference) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t next = std::min(text.find('&', at), text.size());
    out += text.substr(at, next - at);
    at = next;
    if (at == text.size()) break;
    if (const std::optional<Reference> r = reference(text, at)) {
      out += r->text;
      at = r->end;
    } else {
      out += text[at++];
    }
  }
  return out;
}

/// The stricter reading of entities in the repair: they end in ';', and a numeric one is nothing but digits.
inline std::string unescape_closed_references(std::string_view text) {
  return replace_references(text, [](std::string_view t, std::size_t at) -> std::optional<Reference> {
    const bool numeric = t.substr(at + 1).starts_with('#');
    const std::size_t first = at + 1 + numeric;
    std::size_t end = first;
    while (end < t.size() && is_ascii_alphanumeric(t[end])) ++end;
    if (end == first || end - first > 24 || end == t.size() || t[end] != ';') return std::nullopt;
    if (numeric) {
      auto r = numeric_reference(t, at);
      return r && r->end == end + 1 && r->text != ";" ? r : std::nullopt;
    }
    const auto found = html_entity_table().find(t.substr(first, end - first));
    return found == html_entity_table().end() ? std::nullopt : std::optional(Reference{found->second.text, end + 1});
  });
}

/// Letters of ligatures and digraphs; empty for any other character.
constexpr std::u32string_view ligature_letters(char32_t c) {
  switch (c) {
    case 0x132:
      return U"IJ";
    case 0x133:
      return U"ij";
    case 0x149:
      return U"\u02BCn";
    case 0x1C4:
      return U"D\u017D";
    case 0x1C5:
      return U"D\u017E";
    case 0x1C6:
      return U"d\u017E";
    case 0x1C7:
      return U"LJ";
    case 0x1C8:
      return U"Lj";
    case 0x1C9:
      return U"lj";
    case 0x1CA:
      return U"NJ";
    case 0x1CB:
      return U"Nj";
    case 0x1CC:
      return U"nj";
    case 0x1F1:
      return U"DZ";
    case 0x1F2:
      return U"Dz";
    case 0x1F3:
      return U"dz";
    case 0xFB00:
      return U"ff";
    case 0xFB01:
      return U"fi";
    case 0xFB02:
      return U"fl";
    case 0xFB03:
      return U"ffi";
    case 0xFB04:
      return U"ffl";
    case 0xFB05:
      return U"\u017Ft";
    case 0xFB06:
      return U"st";
    default:
      return {};
  }
}

/// NFKC of U+3000 and U+FF01 ... U+FFEF; U+FFE3 becomes two characters, of which this is the second.
constexpr char32_t narrow_form(char32_t c) {
  if (c == 0x3000) return U' ';
  if (c >= 0xFF01 && c <= 0xFF5E) return c - 0xFEE0;
  if (c == 0xFFE3) return 0x304;
  return c >= 0xFF5F && c <= 0xFFEF ? narrow_forms[c - 0xFF5F] : c;
}

constexpr char32_t straight_quote(char32_t c) {
  if (c == 0x2BC || (c >= 0x2018 && c <= 0x201B)) return U'\'';
  return c >= 0x201C && c <= 0x201F ? U'"' : c;
}

constexpr bool is_removed_control(char32_t c) {
  return c <= 8 || c == 0xB || (c >= 0xE && c <= 0x1F) || c == 0x7F || (c >= 0x206A && c <= 0x206F) || c == 0xFEFF ||
         (c >= 0xFFF9 && c <= 0xFFFC);
}

/// The place behind a terminal escape (ESC [ digits and semicolons, a letter) at text[at], `at` if there is none.
inline std::size_t escape_end(std::u32string_view text, std::size_t at) {
  if (text[at] != 0x1B || at + 1 >= text.size() || text[at + 1] != U'[') return at;
  std::size_t end = at + 2;
  while (end < text.size() && ((text[end] >= U'0' && text[end] <= U'9') || text[end] == U';')) ++end;
  const bool letter = end < text.size() && text[end] < 0x80 && (char_class(text[end]) & CharClass::letter) != 0;
  return letter ? end + 1 : at;
}

/// Steps 3 to 11 of spec 9.1, once.
inline std::u32string repaired_once(std::u32string_view text) {
  std::u32string plain;
  for (const char32_t c : text) {
    if (const auto letters = ligature_letters(c); !letters.empty()) {
      for (const char32_t l : letters) plain += straight_quote(l);
      continue;
    }
    if (c == 0xFFE3) plain += U' ';
    plain += straight_quote(narrow_form(from_windows_1252(c)));
  }
  std::u32string out;
  for (std::size_t at = 0; at < plain.size();) {
    if (const std::size_t end = escape_end(plain, at); end > at) {
      at = end;
      continue;
    }
    const char32_t c = plain[at++];
    if (c == U'\r' && at < plain.size() && plain[at] == U'\n') continue;
    if (c == U'\r' || c == 0x2028 || c == 0x2029 || c == 0x85)
      out += U'\n';
    else if (!is_removed_control(c))
      out += c;
  }
  return nfc(out);
}

}  // namespace detail

/// Replaces HTML entities as browsers do: named ones also without their semicolon where HTML allows that, the longest name first.
inline std::string html_unescape(std::string_view text) {
  return detail::replace_references(text, [](std::string_view t, std::size_t at) -> std::optional<detail::Reference> {
    if (auto numeric = detail::numeric_reference(t, at)) return numeric;
    const std::size_t first = at + 1;
    std::size_t end = first;
    while (end < t.size() && end - first < 32 && detail::is_ascii_alphanumeric(t[end])) ++end;
    const bool closed = end < t.size() && t[end] == ';';
    const auto& table = detail::html_entity_table();
    for (std::size_t length = end - first; length > 1; --length) {
      const auto found = table.find(t.substr(first, length));
      if (found == table.end() || found->second.only_in_repair) continue;
      const bool with_semicolon = closed && first + length == end;
      if (with_semicolon || found->second.bare)
        return detail::Reference{found->second.text, first + length + with_semicolon};
    }
    return std::nullopt;
  });
}

/// Repairs a text: entities, C1 controls, ligatures, wide forms, curly quotes, line ends, terminal escapes, control characters,
/// NFC. Bytes that are not UTF-8 become U+FFFD.
inline std::string repair_text(std::string_view text) {
  const auto plain = [](char c) { return (c >= ' ' && c <= '~' && c != '&') || c == '\n' || c == '\t'; };
  if (std::all_of(text.begin(), text.end(), plain)) return std::string(text);
  std::string out;
  bool markup = false;
  while (!text.empty()) {
    const std::size_t size = std::min(text.find('\n'), text.size() - 1) + 1;
    std::string line = to_utf8(to_utf32(text.substr(0, size)));
    text.remove_prefix(size);
    markup = markup || line.find('<') != line.npos;
    for (int round = 0; round < 100; ++round) {
      std::string next =
          to_utf8(detail::repaired_once(to_utf32(markup ? line : detail::unescape_closed_references(line))));
      if (next == line) break;
      line = std::move(next);
    }
    out += line;
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// What happens to a text before its words are looked for.
enum class ClipCleaning {
  original,     // OpenAI's: repair_text, HTML entities twice, white space, lower case with final sigma
  hugging_face  // NFC, white space, lower case without context; spec 9.2
};

struct ClipTokenizerOptions {
  ClipCleaning cleaning = ClipCleaning::original;
  Index longest = 77;                // ids of a text with its frame; MDM takes 22 for HumanML3D and KIT-ML
  bool truncate = true;              // a longer text is cut, else refused
  std::size_t cached_words = 16384;  // words whose ids are remembered
  std::string begin = "<|startoftext|>", end = "<|endoftext|>", unknown = "<|endoftext|>", word_end = "</w>";
};

using BytePairMerges = std::vector<std::pair<std::string, std::string>>;

namespace detail {

/// The symbol of a byte in vocabularies: printable bytes stand for themselves, the others for U+0100 ... in their order.
struct ByteSymbols {
  std::array<std::string, 256> symbol;      // of a byte, UTF-8
  std::array<unsigned char, 256> in_order;  // the bytes as the first ids have them: printable ones first
  std::unordered_map<char32_t, unsigned char> byte;

  ByteSymbols() {
    std::size_t count = 0;
    const auto printable = [](unsigned b) { return (b >= 0x21 && b <= 0x7E) || (b >= 0xA1 && b != 0xAD); };
    char32_t next = 0x100;
    for (const bool wanted : {true, false}) {
      for (unsigned b = 0; b < 256; ++b) {
        if (printable(b) != wanted) continue;
        const char32_t c = wanted ? char32_t{b} : next++;
        append_utf8(symbol[b], c);
        in_order[count++] = static_cast<unsigned char>(b);
        byte.emplace(c, static_cast<unsigned char>(b));
      }
    }
  }
  static const ByteSymbols& get() {
    static const ByteSymbols symbols;
    return symbols;
  }
};

/// Byte pair encoding of single words: merges pairs of neighbours in the order of their rank. A constant table.
class BytePairs {
 public:
  /// Throws config_error 107, naming `source`, if a byte has no symbol and `unknown` < 0, or a merge names or makes no piece.
  BytePairs(const std::vector<std::string>& pieces, const BytePairMerges& merges, const std::string& word_end,
            Index unknown, std::string_view source) {
    std::unordered_map<std::string_view, Index> ids;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (!ids.emplace(pieces[i], static_cast<Index>(i)).second)
        raise<config_error>(107, source, ": piece '", pieces[i], "' stands twice, the second time as id ", i);
    }
    const auto id_of = [&](const std::string& piece) {
      const auto found = ids.find(piece);
      return found == ids.end() ? Index{-1} : found->second;
    };
    for (std::size_t b = 0; b < 256; ++b) {
      const std::string& symbol = ByteSymbols::get().symbol[b];
      for (const bool last : {false, true}) {
        Index id = id_of(last ? symbol + word_end : symbol);
        if (id < 0) id = unknown;
        if (id < 0) raise<config_error>(107, source, ": no piece for byte ", b, last ? " at the end of a word" : "");
        symbols_[last][b] = id;
      }
    }
    for (std::size_t rank = 0; rank < merges.size(); ++rank) {
      const auto& [left, right] = merges[rank];
      const Index a = id_of(left), b = id_of(right), both = id_of(left + right);
      for (const auto& [piece, id] : {std::pair(left, a), std::pair(right, b), std::pair(left + right, both)}) {
        if (id < 0) raise<config_error>(107, source, ": merge ", rank, ": '", piece, "' is no piece");
      }
      if (!merges_.emplace(key(a, b), Merge{rank, both}).second)
        raise<config_error>(107, source, ": merge ", rank, ": '", left, "' and '", right, "' stand twice");
    }
  }

  /// Appends the ids of a word (bytes, not empty). O(n log n).
  void append(std::vector<Index>& out, std::string_view word) const {
    constexpr std::size_t none = static_cast<std::size_t>(-1);
    struct Symbol {
      Index id;  // -1: merged into the one before
      std::size_t previous, next;
    };
    std::vector<Symbol> line(word.size());
    for (std::size_t i = 0; i < word.size(); ++i)
      line[i] = {symbols_[i + 1 == word.size()][static_cast<unsigned char>(word[i])], i - 1, i + 1};
    line.front().previous = line.back().next = none;

    struct Candidate {
      std::size_t rank, at;
      Index left, right, both;
      bool operator>(const Candidate& o) const { return rank != o.rank ? rank > o.rank : at > o.at; }
    };
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> waiting;
    const auto propose = [&](std::size_t at) {
      if (at == none || line[at].next == none) return;
      const Index left = line[at].id, right = line[line[at].next].id;
      if (const auto m = merges_.find(key(left, right)); m != merges_.end())
        waiting.push({m->second.rank, at, left, right, m->second.both});
    };
    for (std::size_t i = 0; i < word.size(); ++i) propose(i);
    // All places of the pair of lowest rank, from left to right, before any pair that they give rise to.
    for (std::vector<Candidate> round; !waiting.empty(); round.clear()) {
      for (const std::size_t rank = waiting.top().rank; !waiting.empty() && waiting.top().rank == rank; waiting.pop())
        round.push_back(waiting.top());
      for (const Candidate& c : round) {
        Symbol& left = line[c.at];
        if (left.id != c.left || left.next == none || line[left.next].id != c.right) continue;
        Symbol& right = line[left.next];
        left.id = c.both, right.id = -1;
        left.next = right.next;
        if (left.next != none) line[left.next].previous = c.at;
        propose(left.previous), propose(c.at);
      }
    }
    for (std::size_t i = 0; i != none; i = line[i].next) out.push_back(line[i].id);
  }

 private:
  struct Merge {
    std::size_t rank;
    Index both;
  };
  static std::uint64_t key(Index a, Index b) {
    return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b);
  }
  std::array<std::array<Index, 256>, 2> symbols_{};  // [at the end of the word][byte]
  std::unordered_map<std::uint64_t, Merge> merges_;
};

/// The ids of words that have been seen. Forgets all of them when it is full. One thread at a time.
class WordCache {
 public:
  explicit WordCache(std::size_t most) : most_(most) {}
  static constexpr std::size_t longest = 64;  // bytes of a word that is kept

  const std::vector<Index>* find(std::string_view word) const {
    const auto found = ids_.find(word);
    return found == ids_.end() ? nullptr : &found->second;
  }
  void keep(std::string_view word, std::span<const Index> ids) {
    if (word.size() > longest || most_ == 0) return;
    if (ids_.size() >= most_) ids_.clear();
    ids_.emplace(std::string(word), std::vector<Index>(ids.begin(), ids.end()));
  }
  std::mutex mutex;  // for the owner

 private:
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  std::size_t most_;
  std::unordered_map<std::string, std::vector<Index>, Hash, std::equal_to<>> ids_;
};

}  // namespace detail

class ClipTokenizer {
 public:
  /// OpenAI's ids: 256 symbols of bytes, the same at the end of words, the merges, begin, end.
  explicit ClipTokenizer(const BytePairMerges& merges, ClipTokenizerOptions options = {},
                         std::string_view source = "ClipTokenizer")
      : ClipTokenizer(openai_pieces(merges, options), merges, options, source) {}
  /// Any ids. `added` instead of begin and end, as a tokenizer.json lists them: they are looked for before the words are.
  /// Throws config_error 107, naming `source`, if begin or end is no piece, a piece stands twice or a merge needs a piece that
  /// there is not; 101 if options.longest leaves no room for the frame
  ClipTokenizer(std::vector<std::string> pieces, const BytePairMerges& merges, ClipTokenizerOptions options = {},
                std::string_view source = "ClipTokenizer", const std::vector<AddedToken>& added = {})
      : options_(std::move(options)) {
    const auto id_of = [&](const std::string& piece) {
      return static_cast<Index>(std::find(pieces.begin(), pieces.end(), piece) - pieces.begin());
    };
    const Index count = static_cast<Index>(pieces.size());
    begin_ = id_of(options_.begin), end_ = id_of(options_.end);
    for (const Index id : {begin_, end_}) {
      if (id == count)
        raise<config_error>(107, source, ": ", count, " pieces lack '", id == begin_ ? options_.begin : options_.end,
                            "'");
    }
    const Index unknown = options_.unknown.empty() ? count : id_of(options_.unknown);
    pairs_ = std::make_shared<const detail::BytePairs>(pieces, merges, options_.word_end,
                                                       unknown == count ? Index{-1} : unknown, source);
    pieces_ = std::make_shared<const std::vector<std::string>>(std::move(pieces));
    cache_ = std::make_shared<detail::WordCache>(options_.cached_words);
    std::vector<AddedToken> before, after;
    for (AddedToken t : added) {
      if (t.id < 0 || t.id >= count) raise<config_error>(107, source, ": id ", t.id, " among ", count, " pieces");
      if (t.normalized) t.content = cleaned(t.content);
      (t.normalized ? after : before).push_back(std::move(t));
    }
    raw_ = detail::AddedTokenSearch(std::move(before));
    cleaned_ = detail::AddedTokenSearch(std::move(after));
    using enum FramePart::Kind;
    set_frames({{token, begin_}, {text_a}, {token, end_}},
               {{token, begin_}, {text_a}, {token, end_}, {token, end_}, {text_b}, {token, end_}}, source);
  }

  const ClipTokenizerOptions& options() const { return options_; }
  const std::vector<std::string>& vocabulary() const { return *pieces_; }
  Index size() const { return static_cast<Index>(pieces_->size()); }
  Index begin_id() const { return begin_; }
  Index end_id() const { return end_; }
  /// OpenAI fills up with 0, Hugging Face with the end.
  Index pad_id() const { return options_.cleaning == ClipCleaning::original ? 0 : end_; }

  /// Other frames than begin, text, end. Throws config_error 107 for ids that are no pieces, 101 as the constructor.
  void set_frames(std::vector<FramePart> single, std::vector<FramePart> pair, std::string_view source) {
    for (const auto* frame : {&single, &pair}) {
      for (const FramePart& part : *frame) {
        if (part.kind == FramePart::token && (part.id < 0 || part.id >= size()))
          raise<config_error>(107, source, ": id ", part.id, " among ", size(), " pieces");
      }
      if (options_.longest < static_cast<Index>(detail::frame_size(*frame)))
        raise<config_error>(101, source, ": at most ", options_.longest, " ids, the frame has ",
                            detail::frame_size(*frame));
    }
    single_ = std::move(single), pair_ = std::move(pair);
  }

  /// The framed ids of a text, at most options().longest: a text that is longer loses its last words, or throws config_error 101.
  std::vector<Index> encode(std::string_view text) const {
    return detail::framed_text("ClipTokenizer", single_, encode_words(text), options_.longest, options_.truncate);
  }
  /// Two texts in one frame; never cut.
  TokenPair encode_pair(std::string_view a, std::string_view b) const {
    return detail::framed_pair("ClipTokenizer", pair_, encode_words(a), encode_words(b), options_.longest);
  }
  /// Without a frame, of any length.
  std::vector<Index> encode_words(std::string_view text) const {
    std::vector<Index> ids;
    const std::unique_lock lock(cache_->mutex, std::try_to_lock);  // a second thread does without the cache
    detail::WordCache* cache = lock.owns_lock() ? cache_.get() : nullptr;
    const auto special = [&](Index id) { ids.push_back(id); };
    raw_.split(
        text,
        [&](std::string_view part) {
          const std::string clean = cleaned(part);
          cleaned_.split(
              clean, [&](std::string_view words) { append_words(ids, words, cache); }, special);
        },
        special);
    return ids;
  }

  /// The text that ids spell, in lower case with a blank behind every word; begin and end are left out. Throws shape_error 203
  /// for an id that is none.
  std::string decode(std::span<const Index> ids) const {
    std::string out;
    for (const Index id : ids) {
      if (id < 0 || id >= size()) raise<shape_error>(203, "ClipTokenizer: id ", id, " of ", size());
      if (id == begin_ || id == end_ || raw_.has(id) || cleaned_.has(id)) continue;
      std::string_view piece = (*pieces_)[static_cast<std::size_t>(id)];
      const bool last = !options_.word_end.empty() && piece.ends_with(options_.word_end);
      if (last) piece.remove_suffix(options_.word_end.size());
      for (std::size_t at = 0; at < piece.size();) {
        const auto byte = detail::ByteSymbols::get().byte.find(decode_utf8(piece, at));
        if (byte != detail::ByteSymbols::get().byte.end()) out += static_cast<char>(byte->second);
      }
      if (last) out += ' ';
    }
    if (out.ends_with(' ')) out.pop_back();
    return out;
  }

  /// The text of which words are taken.
  std::string cleaned(std::string_view text) const {
    std::string kept;
    if (options_.cleaning == ClipCleaning::original) {
      kept = repair_text(text);
      if (kept.find('&') != kept.npos) kept = html_unescape(html_unescape(kept));
      text = kept;
    }
    const bool ascii =
        std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
    std::string out;
    out.reserve(text.size());
    if (ascii) {
      for (const char c : text) {
        const bool white = (char_class(static_cast<unsigned char>(c)) & CharClass::white_space) != 0;
        if (!white)
          out += static_cast<char>(lower_case(char32_t{static_cast<unsigned char>(c)}));
        else if (!out.empty() && out.back() != ' ')
          out += ' ';
      }
      if (out.ends_with(' ')) out.pop_back();
      return out;
    }
    std::u32string single;
    const bool original = options_.cleaning == ClipCleaning::original;
    const std::u32string all = to_utf32(text);
    for (const char32_t c : original ? all : nfc(all)) {
      if ((char_class(c) & CharClass::white_space) == 0)
        single += c;
      else if (!single.empty() && single.back() != U' ')
        single += U' ';
    }
    if (single.ends_with(U' ')) single.pop_back();
    return to_utf8(lower_case(single, original));
  }

 private:
  static std::vector<std::string> openai_pieces(const BytePairMerges& merges, const ClipTokenizerOptions& options) {
    const detail::ByteSymbols& symbols = detail::ByteSymbols::get();
    std::vector<std::string> pieces;
    for (const char* end : {"", options.word_end.c_str()}) {
      for (const unsigned char b : symbols.in_order) pieces.push_back(symbols.symbol[b] + end);
    }
    for (const auto& [left, right] : merges) pieces.push_back(left + right);
    pieces.insert(pieces.end(), {options.begin, options.end});
    return pieces;
  }

  /// What a word may begin with, in the order in which it is tried. Without case, as the original compares, the long s is an s.
  std::size_t literal_at(std::string_view text) const {
    if (text.front() != '<' && text.front() != '\'') return 0;
    for (const std::string_view literal :
         {"<|startoftext|>", "<|endoftext|>", "'s", "'t", "'re", "'ve", "'m", "'ll", "'d"}) {
      if (const std::size_t size = folded_prefix(text, literal); size != 0) return size;
    }
    return 0;
  }
  std::size_t folded_prefix(std::string_view text, std::string_view literal) const {
    std::size_t at = 0;
    for (const char c : literal) {
      if (at < text.size() && text[at] == c)
        ++at;
      else if (c == 's' && options_.cleaning == ClipCleaning::original && text.substr(at).starts_with("\xC5\xBF"))
        at += 2;
      else
        return 0;
    }
    return at;
  }

  /// Words: the literals, runs of letters, single numbers, runs of what is neither nor white space. U+0345 is lost in the original:
  /// it is no letter, but without case it is the iota, which is one, so that neither kind of run takes it.
  void append_words(std::vector<Index>& ids, std::string_view text, detail::WordCache* cache) const {
    const auto kind_of = [&](char32_t c) {
      if (c == 0x345 && options_.cleaning == ClipCleaning::original) return CharClass::white_space;
      return char_class(c) & (CharClass::letter | CharClass::number | CharClass::white_space);
    };
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t begin = at;
      if (const std::size_t size = literal_at(text.substr(at)); size != 0) {
        at += size;
      } else {
        const unsigned kind = kind_of(decode_utf8(text, at));
        if (kind == CharClass::white_space) continue;
        for (std::size_t next = at; kind != CharClass::number && at < text.size(); at = next) {
          if (kind_of(decode_utf8(text, next)) != kind) break;
        }
      }
      append_word(ids, text.substr(begin, at - begin), cache);
    }
  }
  void append_word(std::vector<Index>& ids, std::string_view word, detail::WordCache* cache) const {
    const bool marks = raw_.empty() && cleaned_.empty();  // added tokens have been taken out already
    if (marks && (word == options_.begin || word == options_.end)) {
      ids.push_back(word == options_.begin ? begin_ : end_);
      return;
    }
    if (const auto* known = cache != nullptr ? cache->find(word) : nullptr; known != nullptr) {
      ids.insert(ids.end(), known->begin(), known->end());
      return;
    }
    const std::size_t before = ids.size();
    pairs_->append(ids, word);
    if (cache != nullptr) cache->keep(word, std::span(ids).subspan(before));
  }

  ClipTokenizerOptions options_;
  std::shared_ptr<const std::vector<std::string>> pieces_;
  std::shared_ptr<const detail::BytePairs> pairs_;
  std::shared_ptr<detail::WordCache> cache_;
  detail::AddedTokenSearch raw_, cleaned_;
  Index begin_ = 0, end_ = 0;
  std::vector<FramePart> single_, pair_;
};

static_assert(Tokenizer<ClipTokenizer>);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_GLOVE_HPP  // <motionlang/text/glove.hpp>
#define MOTIONLANG_HAS_TEXT_GLOVE_HPP
/// Word vectors with a part of speech: the text side of TM2T and of the HumanML3D evaluators.
///
///     const GloVe words = read_glove("glove/our_vab");                                       // io/glove_file.hpp
///     const TextFeatures<B> text = words.encode<B>(texts);                  // texts: "a/DET man/NOUN walk/VERB"
///
/// A row is the vector of a word and, behind it, a one among the 15 tags. Texts are lists of word/tag, the second field of the caption
/// files of HumanML3D. A caption without tags is read by approximation, see `caption_tokens`.
/// Source  Guo et al. (CVPR 2022), word_vectorizer.py; spec text-encoders.md, section 6

#ifndef MOTIONLANG_HAS_TEXT_TAGGED_WORD_HPP  // <motionlang/text/tagged_word.hpp>
#define MOTIONLANG_HAS_TEXT_TAGGED_WORD_HPP
/// A word of a caption with its part of speech, as the caption files of HumanML3D list them.

namespace motionlang::inline MOTIONLANG_ABI {

/// A word as its lemma, with its part of speech: "walk" and "VERB". No tag: none was written.
struct TaggedWord {
  std::string word, tag;
  bool operator==(const TaggedWord&) const = default;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

enum class SpeechTag { verb, noun, det, adp, num, aux, pron, adj, adv, loc, body, obj, act, desc, other };
inline constexpr Index speech_tags = 15;

/// By the name in the caption files; SpeechTag::other if there is none.
inline SpeechTag speech_tag(std::string_view name) {
  constexpr std::array<std::string_view, 15> names{"VERB",     "NOUN",    "DET",     "ADP",      "NUM",
                                                   "AUX",      "PRON",    "ADJ",     "ADV",      "Loc_VIP",
                                                   "Body_VIP", "Obj_VIP", "Act_VIP", "Desc_VIP", "OTHER"};
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? SpeechTag::other : static_cast<SpeechTag>(found - names.begin());
}

/// The words that matter to motions have tags of their own: the first list that has the word. Nothing for other words.
inline std::optional<SpeechTag> motion_tag(std::string_view word) {
  constexpr std::array<std::pair<SpeechTag, std::string_view>, 5> lists{
      {{SpeechTag::loc,
        " left right clockwise counterclockwise anticlockwise forward back backward up down straight curve "},
       {SpeechTag::body, " arm chin foot feet face hand mouth leg waist eye knee shoulder thigh "},
       {SpeechTag::obj, " stair dumbbell chair window floor car ball handrail baseball basketball "},
       {SpeechTag::act,
        " walk run swing pick bring kick put squat throw hop dance jump turn stumble stop sit lift lower raise wash "
        "stand kneel "
        "stroll rub bend balance flap jog shuffle lean rotate spin spread climb "},
       {SpeechTag::desc, " slowly carefully fast careful slow quickly happy angry sad happily angrily sadly "}}};
  const std::string whole = concat_text(" ", word, " ");
  for (const auto& [tag, list] : lists) {
    if (list.find(whole) != list.npos) return tag;
  }
  return std::nullopt;
}

/// Vectors of words, with "sos", "eos" and "unk" among them.
class GloVe {
 public:
  /// vectors has a row of `width` numbers for each word. Throws shape_error 205 if it has not, config_error 103 if sos, eos or unk is
  /// missing or a word stands twice.
  GloVe(const std::vector<std::string>& words, std::vector<float> vectors, Index width)
      : vectors_(std::move(vectors)), width_(width) {
    if (width < 1 || vectors_.size() != words.size() * static_cast<std::size_t>(width))
      raise<shape_error>(205, "GloVe: ", vectors_.size(), " numbers for ", words.size(), " words of ", width);
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (!row_.emplace(words[i], i).second) raise<config_error>(103, "GloVe: the word '", words[i], "' stands twice");
    }
    for (const char* mark : {"sos", "eos", "unk"}) {
      if (!row_.contains(mark)) raise<config_error>(103, "GloVe: no word '", mark, "'");
    }
  }

  Index size() const { return static_cast<Index>(row_.size()); }
  Index width() const { return width_; }
  bool contains(const std::string& word) const { return row_.contains(word); }
  std::span<const float> vector(const std::string& word) const {
    const auto found = row_.find(word);
    const std::size_t row = found == row_.end() ? row_.at("unk") : found->second,
                      width = static_cast<std::size_t>(width_);
    return std::span(vectors_).subspan(row * width, width);
  }
  /// The tag that counts: of an unknown word `other`, else the one of the word's list, else the given one.
  SpeechTag tag(const TaggedWord& w) const {
    return contains(w.word) ? motion_tag(w.word).value_or(speech_tag(w.tag)) : SpeechTag::other;
  }

  /// sos, at most `longest` words, eos.
  static std::vector<TaggedWord> framed(std::span<const TaggedWord> words, Index longest) {
    std::vector<TaggedWord> out{{"sos", "OTHER"}};
    const auto count = std::min<std::size_t>(words.size(), static_cast<std::size_t>(longest));
    out.insert(out.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(count));
    out.push_back({"eos", "OTHER"});
    return out;
  }

  /// "word/tag word/tag"; a text without a slash is a caption. Throws config_error 107 for a word with no tag or several.
  std::vector<TaggedWord> tokens(std::string_view text) const {
    if (text.find('/') == text.npos) return caption_tokens(text);
    std::vector<TaggedWord> out;
    for (std::size_t at = 0; (at = text.find_first_not_of(' ', at)) != text.npos;) {
      const std::size_t end = std::min(text.find(' ', at), text.size());
      const std::string_view token = text.substr(at, end - at);
      const std::size_t slash = token.find('/');
      if (slash == token.npos || token.find('/', slash + 1) != token.npos)
        raise<config_error>(107, "GloVe: '", token, "' is not word/tag");
      out.push_back({std::string(token.substr(0, slash)), std::string(token.substr(slash + 1))});
      at = end;
    }
    return out;
  }
  /// An approximation to what was done with spaCy: lower-case words, of which -s, -es, -ed and -ing are taken away where the word is
  /// unknown and the rest is known. Tags come from the lists of `motion_tag` only.
  std::vector<TaggedWord> caption_tokens(std::string_view text) const {
    std::vector<TaggedWord> out;
    for (const std::string& word : WordPiece::words(text)) out.push_back({known_form(word), "OTHER"});
    return out;
  }

  /// Rows of width + 15 numbers: sos, the words, eos.
  template <Backend B>
  TextFeatures<B> encode(std::span<const std::string> texts, Index longest = 20) const {
    std::vector<typename B::scalar> values;
    std::vector<Index> lengths;
    for (const std::string& text : texts) {
      const auto words = framed(tokens(text), longest);
      for (const TaggedWord& w : words) {
        const auto v = vector(w.word);
        values.insert(values.end(), v.begin(), v.end());
        values.resize(values.size() + speech_tags, 0);
        values[values.size() - speech_tags + static_cast<std::size_t>(tag(w))] = 1;
      }
      lengths.push_back(std::ssize(words));
    }
    const Offsets offsets(lengths);
    return {{Tensor<B, 2>::from(values, {offsets.rows(), width_ + speech_tags}), offsets}};
  }

 private:
  std::string known_form(const std::string& word) const {
    if (contains(word)) return word;
    for (const std::string_view end : {"ing", "ed", "es", "s"}) {
      if (!word.ends_with(end) || word.size() < end.size() + 2) continue;
      const std::string stem = word.substr(0, word.size() - end.size());
      if (contains(stem)) return stem;
      if (contains(stem + "e")) return stem + "e";
      if (stem.back() == stem[stem.size() - 2] && contains(stem.substr(0, stem.size() - 1)))
        return stem.substr(0, stem.size() - 1);
    }
    return word;
  }

  std::vector<float> vectors_;
  Index width_;
  std::unordered_map<std::string, std::size_t> row_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_MIRROR_CAPTION_HPP  // <motionlang/text/mirror_caption.hpp>
#define MOTIONLANG_HAS_TEXT_MIRROR_CAPTION_HPP
/// What a mirrored motion is called: left and right exchanged in its caption.
///
///     left <-> right, with the endings -s, -ward(s), -most, -hand(ed)
///     clockwise <-> counterclockwise, anticlockwise -> clockwise; also in parts: "counter-clockwise", "clock-wise"
///
/// Whole words, capitals kept, all at once. "left" as a verb is exchanged, too: words do not tell.
///
/// Source   spec humanml3d-features.md 8; HumanML3D ships finished texts, no program
/// Differs  from the texts of the published KIT annotations, which exchange inside of words: "upright" is "upleft" there

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Letters and digits; bytes of other characters than ASCII belong to words.
constexpr bool in_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         static_cast<unsigned char>(c) >= 0x80;
}
constexpr bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

/// The word for the other side, in small letters; empty if a word has no side.
inline std::string word_of_other_side(std::string_view word) {
  if (word == "clockwise") return "counterclockwise";
  if (word == "counterclockwise" || word == "anticlockwise") return "clockwise";
  constexpr std::array<std::string_view, 7> endings{"", "s", "ward", "wards", "most", "hand", "handed"};
  const bool left = word.starts_with("left");
  if (!left && !word.starts_with("right")) return {};
  const std::string_view ending = word.substr(left ? 4 : 5);
  for (const std::string_view e : endings) {
    if (ending == e) return (left ? "right" : "left") + std::string(ending);
  }
  return {};
}

/// The capitals of `like`: all, the first one, or none.
inline std::string with_capitals(std::string word, std::string_view like) {
  const bool all = like.size() > 1 && is_capital(like[0]) && is_capital(like[1]);
  for (std::size_t i = 0; i < word.size() && (all || (i == 0 && is_capital(like[0]))); ++i) {
    word[i] = static_cast<char>(word[i] - 'a' + 'A');
  }
  return word;
}

/// Words and what stands between them, in turns, beginning with a word (perhaps an empty one).
inline std::vector<std::string_view> words_and_gaps(std::string_view text) {
  std::vector<std::string_view> out;
  for (bool word = true; !text.empty(); word = !word) {
    std::size_t n = 0;
    while (n < text.size() && in_word(text[n]) == word) ++n;
    out.push_back(text.substr(0, n));
    text.remove_prefix(n);
  }
  return out;
}

/// Words `first`, first + 2, ... of `count` in small letters as one; empty if more than a hyphen or a blank parts them.
inline std::string joined_words(const std::vector<std::string_view>& pieces, std::size_t first, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < 2 * count - 1; ++i) {
    if (first + i >= pieces.size()) return {};
    const std::string_view piece = pieces[first + i];
    if (i % 2 == 1 && piece != "-" && piece != " ") return {};
    if (i % 2 == 0) {
      for (const char c : piece) out += is_capital(c) ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  return out;
}

}  // namespace detail

/// The caption of the mirrored motion.
inline std::string mirror_caption(std::string_view caption) {
  const auto pieces = detail::words_and_gaps(caption);
  std::string out;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::size_t words = i % 2 == 0 ? 3 : 0;  // "counter clock-wise" is one word in three
    std::string other;
    for (; words > 0; --words) {
      const std::string word = detail::joined_words(pieces, i, words);
      if (words > 1 && !word.ends_with("clockwise")) continue;
      if (other = detail::word_of_other_side(word); !other.empty()) break;
    }
    if (words == 0) {
      out += pieces[i];
    } else {
      out += detail::with_capitals(other, pieces[i]);
      i += 2 * words - 2;
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_TEXT_TOKENIZED_ENCODER_HPP  // <motionlang/text/tokenized_encoder.hpp>
#define MOTIONLANG_HAS_TEXT_TOKENIZED_ENCODER_HPP
/// A tokenizer and a network make a text encoder.
///
///     const TokenizedEncoder clip(ClipTokenizer(...), load_clip_text<B>(weights), {.pooling = Pooling::end});         // MDM, STMC
///     const TokenizedEncoder tokens(BertTokenizer(...), load_text_network<DistilBert<B>>(config, weights));           // TEMOS, TMR
///     const TokenizedEncoder sentences(BertTokenizer(...), load_text_network<Mpnet<B>>(config, weights),
///                                      {.pooling = Pooling::mean, .normalize = true});

namespace motionlang::inline MOTIONLANG_ABI {

struct TextOptions {
  Pooling pooling = Pooling::none;
  bool normalize = false;  // pooled vectors get the length 1
  Index width = 0;         // fill all texts up to so many ids, as MotionDiffuse wants (77); 0: no padding, as the mean wants
  Index padding = 0;       // the id to fill up with
};

/// The network takes a TokenBatch and gives TextFeatures<B>. Two things are optional: `until_end(batch)`, what suffices for the vector
/// of the end token, and `project(rows)`, through which that vector goes.
template <Tokenizer T, class Network>
struct TokenizedEncoder {
  T tokenizer;
  Network network;
  TextOptions options{};

  TokenizedEncoder(T t, Network n, const TextOptions& o = {})
      : tokenizer(std::move(t)), network(std::move(n)), options(o) {}

  template <Backend B>
  requires requires(const Network& n, const TokenBatch& batch) {
    { n(batch) } -> std::same_as<TextFeatures<B>>;
  }
  TextFeatures<B> encode(std::span<const std::string> texts) const {
    TokenBatch batch = tokenize(tokenizer, texts);
    if (options.width > 0) {
      batch.ids = batch.padded(options.padding, options.width);
      batch.lengths.assign(batch.lengths.size(), options.width);
    }
    if (options.pooling == Pooling::none) return network(batch);
    const bool end = options.pooling == Pooling::end;
    if constexpr (requires { network.until_end(batch); }) {
      if (end) batch = network.until_end(batch);
    }
    auto rows = pool(network(batch), options.pooling);
    if constexpr (requires { network.project(rows); }) {
      if (end) rows = network.project(rows);
    }
    return TextFeatures<B>::pooled(options.normalize ? normalize_rows(rows) : rows);
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_METRICS_INSPECT_MOTION_HPP  // <motionlang/metrics/inspect_motion.hpp>
#define MOTIONLANG_HAS_METRICS_INSPECT_MOTION_HPP
/// What is wrong with a clip: the checks of `motionlang doctor`, and the repair of what can be repaired.
///
///     const Inspection found = inspect_motion(motion);
///     for (const Finding& f : found.findings) std::puts(f.text.c_str());
///     Motion better = mended(motion, found.cure);
///
/// A wrong scale or up axis is put right before the checks that follow it, so that each finding has one cause. All limits
/// are in SI units and named in InspectionLimits.

namespace motionlang::inline MOTIONLANG_ABI {

enum class Fault : int {
  empty,
  not_finite,
  frame_rate,
  lead_in,
  scale,
  up_axis,
  swapped_sides,
  spike,
  jump,
  sliding_feet,
  floor
};
struct FaultInfo {
  std::string_view name, meaning;
  bool mendable;
};
/// By Fault.
inline constexpr std::array<FaultInfo, 11> fault_info{{
    {"no motion", "fewer than two frames", false},
    {"not finite", "a value is NaN or infinite, or a rotation has length 0", false},
    {"frame rate", "no rate that cameras, engines or data sets use", false},
    {"T-pose", "an inserted T-pose at the start that nobody performed", true},
    {"scale", "the figure is not as tall as a person", true},
    {"up axis", "the figure does not stand along +Y", true},
    {"sides", "left and right are exchanged: names against the way the toes point", false},
    {"spike", "one frame stands out from both of its neighbours", true},
    {"jump", "a joint goes a way between two frames that nobody can go", false},
    {"sliding feet", "the foot that carries the body moves over the floor", false},
    {"floor", "the feet are not on y = 0", true},
}};
inline const FaultInfo& info(Fault fault) { return fault_info[static_cast<std::size_t>(fault)]; }

struct Finding {
  Fault fault;
  std::string text;   // with figures and units
  double moment = 0;  // seconds into the clip, of what happens at a time
};

/// What `mended` does, in this order. Frames count in the clip that was inspected.
struct Cure {
  std::vector<Index> spikes;               // frames that are replaced by the middle of their neighbours
  Index lead_in = 0;                       // frames that are cut off at the start
  Quaternion<double> upright{1, 0, 0, 0};  // turns the up axis of the clip to +Y
  double scale = 1;
  double lift = 0;  // metres, after scaling
};

struct Inspection {
  std::vector<Finding> findings;
  Cure cure;

  bool has(Fault fault) const {
    return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.fault == fault; });
  }
};

struct InspectionLimits {
  double shortest = 1.0, tallest = 2.3;  // m: a person
  double upright = 0.8;                  // mean direction of trunk and legs along another axis than +Y; 1: exactly
  double standing = 0.3;                 // m that feet may be off 0 along an axis that is taken for the true one
  double swapped = 0.4;      // mean cosine between the right that names tell and the left that toes and knees tell
  double spike = 0.08;       // m that a joint is off the middle of its neighbours in time
  double jump = 0.15;        // m between two frames, and
  double jump_speed = 8;     // m/s: a fast punch or kick
  double isolated = 5;       // spikes and jumps: so many times what the joint does in the frames around
  double slide = 0.2;        // m/s of feet in contact, median over the contacts; recordings have 0.01 to 0.1
  double low = 0.03;         // m above where a foot joint is when it stands: still on the floor
  double on_the_spot = 0.5;  // m across which the root moves in a clip in place
  double below = 0.08, above = 0.10;  // m that feet may be below or above y = 0
};

namespace detail {

/// Units of files by the factor from what was read to metres.
struct UnitFactor {
  double factor;
  std::string_view unit;
};
inline constexpr std::array<UnitFactor, 9> unit_factors{{
    {100, "the file is in metres where centimetres were expected"},
    {10, "decimetres"},
    {0.1, "millimetres where centimetres were expected"},
    {2.54, "inches where centimetres were expected"},
    {2.54 / 0.45, "the unit of CMU's files, 1/0.45 inch, where centimetres were expected"},
    {0.01, "centimetres where metres were expected"},
    {0.001, "millimetres where metres were expected"},
    {0.0254, "inches where metres were expected"},
    {1000, "metres where millimetres were expected"},
}};

inline double hundredths(double x) { return std::round(x * 100) / 100; }

/// The value below which a share of the values is.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// From the ankles to the head in the rest pose; length 1.
inline Vec3<double> standing_direction(const Skeleton& skeleton, const BodyJoints& body) {
  const auto rest = skeleton.rest_positions();
  auto place = [&](int joint) { return rest[static_cast<std::size_t>(joint)]; };
  return normalized(place(body.head) - 0.5 * (place(body.ankle.left) + place(body.ankle.right)));
}

/// One clip under inspection: its joints in the world, put right as far as causes are known.
class MotionInspector {
 public:
  MotionInspector(const Motion& motion, const InspectionLimits& limits) : motion_(motion), limits_(limits) {}

  Inspection run() {
    if (!check_values()) return std::move(out_);
    check_frame_rate();
    out_.cure.lead_in = detect_t_pose_lead_in(motion_);
    if (out_.cure.lead_in > 0) {
      add(Fault::lead_in, 0, out_.cure.lead_in, out_.cure.lead_in == 1 ? " frame" : " frames",
          " of an inserted T-pose at the start");
    }
    first_ = out_.cure.lead_in;
    positions_ = motion_.positions();
    body_ = find_body_joints(motion_.skeleton);
    if (body_) {
      check_scale();
      check_up_axis();
      check_sides();
    }
    check_jumps();
    if (body_) check_feet();
    return std::move(out_);
  }

 private:
  using Vec = Vec3<double>;

  Vec& at(Index frame, Index joint) {
    return positions_[static_cast<std::size_t>(frame * motion_.skeleton.size() + joint)];
  }
  Vec middle(Index frame, const BodyJoints::Pair& p) { return 0.5 * (at(frame, p.left) + at(frame, p.right)); }
  double seconds(Index frame) const { return static_cast<double>(frame) / motion_.fps; }
  Index frames() const { return motion_.frames(); }

  template <class... T>
  void add(Fault fault, Index frame, const T&... text) {
    out_.findings.push_back({fault, concat_text(text...), seconds(frame)});
  }

  /// False if nothing else can be said.
  bool check_values() {
    for (Index f = 0; f < frames(); ++f) {
      const Vec& r = motion_.root_at(f);
      int wrong = std::isfinite(r.x + r.y + r.z) ? -1 : 0;
      for (int j = 0; j < motion_.skeleton.size() && wrong < 0; ++j) {
        const auto& q = motion_.rotations(f)[static_cast<std::size_t>(j)];
        const double length = dot(q, q);
        if (!std::isfinite(length) || length < 1e-12) wrong = j;
      }
      if (wrong < 0) continue;
      add(Fault::not_finite, f, "frame ", f, ", joint '", motion_.skeleton.name(wrong), "': not a number");
      return false;
    }
    if (frames() < 2) add(Fault::empty, 0, frames(), frames() == 1 ? " frame" : " frames");
    return frames() >= 2;
  }

  void check_frame_rate() {
    constexpr std::array<double, 25> usual{10,    12, 12.5, 15, 20, 23.976, 24,  25,     29.97, 30,  40,  48, 50,
                                           59.94, 60, 72,   75, 90, 100,    120, 119.88, 125,   150, 180, 200};
    constexpr std::array<double, 6> fast{240, 250, 300, 480, 500, 1000};
    auto near = [&](double rate) { return std::abs(motion_.fps / rate - 1) < 5e-4; };
    if (std::any_of(usual.begin(), usual.end(), near) || std::any_of(fast.begin(), fast.end(), near)) return;
    add(Fault::frame_rate, 0, hundredths(motion_.fps), " frames per second");
  }

  /// Sum of the bones from a joint up to one above it.
  double chain(int joint, int above) const {
    double sum = 0;
    for (; joint >= 0 && joint != above; joint = motion_.skeleton.parent(joint)) {
      if (motion_.skeleton.parent(joint) >= 0) sum += norm(motion_.skeleton.offset(joint));
    }
    return sum;
  }

  /// A person is about 1.2 times as tall as the bones from an ankle to the hip and from the pelvis to the head are long.
  void check_scale() {
    const double legs = 0.5 * (chain(body_->ankle.left, body_->hip.left) + chain(body_->ankle.right, body_->hip.right));
    const double height = 1.2 * (legs + chain(body_->head, body_->pelvis));
    auto human = [&](double h) { return h >= limits_.shortest && h <= limits_.tallest; };
    if (human(height) || !(height > 0)) return;
    constexpr double usual_height = 1.7;
    UnitFactor best{usual_height / height, "no usual unit"};
    double farthest = std::log(limits_.tallest / limits_.shortest);
    for (const UnitFactor& u : unit_factors) {
      const double distance = std::abs(std::log(height * u.factor / usual_height));
      if (human(height * u.factor) && distance < farthest) best = u, farthest = distance;
    }
    add(Fault::scale, 0, "the figure is ", hundredths(height), " m tall; x ", std::round(best.factor * 1e4) / 1e4, " (",
        best.unit, ") makes it ", hundredths(height * best.factor), " m");
    out_.cure.scale = best.factor;
    for (Vec& p : positions_) p = best.factor * p;
  }

  /// Trunk and legs point up in most clips. Of those that lie, swim or crawl all the time, the feet would not be on the
  /// floor along the other axis, and their rest pose stands.
  void check_up_axis() {
    Vec trunk{}, legs{};
    for (Index f = first_; f < frames(); ++f) {
      const Vec hips = middle(f, body_->hip);
      trunk = trunk + normalized(middle(f, body_->shoulder) - hips);
      legs = legs + normalized(hips - middle(f, body_->ankle));
    }
    const double n = static_cast<double>(frames() - first_);
    const Vec rest = standing_direction(motion_.skeleton, *body_);
    struct Axis {
      std::string_view name;
      Vec direction;
    };
    for (const Axis& a :
         {Axis{"+Z", {0, 0, 1}}, {"-Z", {0, 0, -1}}, {"+X", {1, 0, 0}}, {"-X", {-1, 0, 0}}, {"-Y", {0, -1, 0}}}) {
      const double up = dot(trunk, a.direction) / n, down = dot(legs, a.direction) / n;
      if (up < limits_.upright || down < limits_.upright) continue;
      if (dot(rest, a.direction) < limits_.upright && std::abs(sole_height(a.direction)) > limits_.standing) continue;
      add(Fault::up_axis, first_, "the body stands along ", a.name, ", not +Y (", hundredths(up), " of 1)");
      out_.cure.upright = rotation_between(a.direction, Vec{0, 1, 0});
      for (Vec& p : positions_) p = rotate(out_.cure.upright, p);
      return;
    }
  }

  /// Left is where up x forward points. Toes point forward while a foot stands flat, and knees bend forward; both, where
  /// there is anything to see of them, must speak against the names.
  void check_sides() {
    struct Witness {
      double legs = 0, arms = 0, weight = 0;
    } toes, knees;
    for (Index f = first_; f < frames(); ++f) {
      const Vec ankles = middle(f, body_->ankle), hips = middle(f, body_->hip);
      auto hear = [&](Witness& witness, Vec forward, double least) {
        const double length = norm(forward);
        forward.y = 0;
        const double weight = norm(forward);
        if (weight < std::max(least, 0.7 * length)) return;
        const Vec left = normalized(cross(Vec{0, 1, 0}, forward));
        witness.legs += weight * dot(left, normalized(at(f, body_->hip.left) - at(f, body_->hip.right)));
        witness.arms += weight * dot(left, normalized(at(f, body_->shoulder.left) - at(f, body_->shoulder.right)));
        witness.weight += weight;
      };
      if (normalized(middle(f, body_->shoulder) - hips).y < 0.7) continue;  // lies or bends down
      if (body_->toe.known()) hear(toes, middle(f, body_->toe) - ankles, 0.05);
      hear(knees, middle(f, body_->knee) - 0.5 * (hips + ankles), 0.04);
    }
    auto wrong = [&](double Witness::*side) {
      double worst = 0;
      for (const Witness& w : {toes, knees}) {
        if (w.weight == 0) continue;
        if (w.*side > -limits_.swapped * w.weight) return 0.0;
        worst = std::min(worst, w.*side / w.weight);
      }
      return worst;
    };
    const double legs = wrong(&Witness::legs), arms = wrong(&Witness::arms);
    if (legs == 0 && arms == 0) return;
    add(Fault::swapped_sides, 0,
        legs < 0 && arms < 0 ? "left and right"
        : legs < 0           ? "the legs"
                             : "the arms",
        " are exchanged: where toes and knees say left, names say right (", hundredths(std::min(legs, arms)), " of 1)");
  }

  void check_jumps() {
    Index worst_jump = -1, worst_joint = 0, spike_joint = 0, jumps = 0;
    double worst = 0, worst_spike = 0;
    for (Index f = first_ + 1; f < frames(); ++f) {
      double off = 0, far = 0;
      Index off_joint = 0, far_joint = 0;
      for (Index j = 0; j < motion_.skeleton.size(); ++j) {
        if (const double e = spike_size(f, j); e > off) off = e, off_joint = j;
        if (const double s = jump_size(f, j); s > far) far = s, far_joint = j;
      }
      if (off > 0) {
        out_.cure.spikes.push_back(f);
        if (off > worst_spike) worst_spike = off, spike_joint = off_joint;
      } else if (far > 0) {
        ++jumps;
        if (far > worst) worst = far, worst_joint = far_joint, worst_jump = f;
      }
    }
    const auto& spikes = out_.cure.spikes;
    if (!spikes.empty()) {
      add(Fault::spike, spikes.front(), spikes.size(), spikes.size() == 1 ? " frame" : " frames", ", first at ",
          hundredths(seconds(spikes.front())), " s; '", motion_.skeleton.name(static_cast<int>(spike_joint)),
          "' up to ", hundredths(worst_spike), " m off");
    }
    if (worst_jump >= 0) {
      add(Fault::jump, worst_jump, jumps, jumps == 1 ? " jump" : " jumps", "; the widest at ",
          hundredths(seconds(worst_jump)), " s: '", motion_.skeleton.name(static_cast<int>(worst_joint)), "' goes ",
          hundredths(worst), " m in a frame, ", std::round(worst * motion_.fps), " m/s");
    }
  }

  double step(Index frame, Index joint) {  // from the frame before
    return frame <= first_ || frame >= frames() ? 0 : norm(at(frame, joint) - at(frame - 1, joint));
  }
  /// How far a joint is off the middle of its neighbours in time, where that is a spike; else 0.
  double spike_size(Index f, Index j) {
    if (f <= first_ || f + 1 >= frames()) return 0;
    const double off = norm(at(f, j) - 0.5 * (at(f - 1, j) + at(f + 1, j)));
    if (off < limits_.spike) return 0;
    const double around =
        std::max({norm(at(f + 1, j) - at(f - 1, j)), step(f - 1, j), step(f - 2, j), step(f + 2, j), step(f + 3, j)});
    return off > limits_.isolated * around ? off : 0;
  }
  double jump_size(Index f, Index j) {
    const double s = step(f, j);
    if (s < limits_.jump || s * motion_.fps < limits_.jump_speed) return 0;
    const double around = std::max({step(f - 2, j), step(f - 1, j), step(f + 1, j), step(f + 2, j)});
    return s > limits_.isolated * around ? s : 0;
  }

  std::vector<int> foot_joints() const {
    std::vector<int> feet{body_->ankle.left, body_->ankle.right};
    if (body_->toe.known()) feet.insert(feet.end(), {body_->toe.left, body_->toe.right});
    return feet;
  }
  /// Where the soles stand along a direction: 5 % of the frames have a foot lower than this.
  double sole_height(const Vec& up) {
    constexpr double toe_height = 0.02, ankle_height = 0.08;  // m above the sole
    std::vector<double> lowest;
    for (Index f = first_; f < frames(); ++f) {
      double low = std::numeric_limits<double>::max();
      for (const int foot : foot_joints()) low = std::min(low, dot(up, at(f, foot)));
      lowest.push_back(low);
    }
    return quantile(std::move(lowest), 0.05) - (body_->toe.known() ? toe_height : ankle_height);
  }

  /// How fast a leg's foot moves over the floor while it is on it, m/s: of every contact the speed that a quarter of it
  /// stays below, so that treading on and rolling off do not count.
  void add_contacts(std::span<const int> feet, std::vector<double>& speeds) {
    // In steps of about 1/25 s, in which noise of the recording is small against the way of a foot that slides.
    const auto stride = std::max<Index>(1, static_cast<Index>(std::lround(motion_.fps / 25)));
    std::vector<double> stands;  // the height at which a joint stands
    for (const int foot : feet) {
      std::vector<double> heights;
      for (Index f = first_; f < frames(); ++f) heights.push_back(at(f, foot).y);
      stands.push_back(quantile(std::move(heights), 0.05));
    }
    std::vector<double> contact;
    for (Index f = first_; f < frames(); f += stride) {
      double slowest = -1;
      for (std::size_t k = 0; k < feet.size() && f + stride < frames(); ++k) {
        const Vec &a = at(f, feet[k]), &b = at(f + stride, feet[k]);
        if (std::max(a.y, b.y) > stands[k] + limits_.low) continue;
        const double speed = norm(Vec{b.x - a.x, 0, b.z - a.z}) * motion_.fps / static_cast<double>(stride);
        if (slowest < 0 || speed < slowest) slowest = speed;
      }
      if (slowest >= 0) {
        contact.push_back(slowest);
      } else if (!contact.empty()) {
        if (contact.size() > 1) speeds.push_back(quantile(contact, 0.25));
        contact.clear();
      }
    }
  }

  void check_feet() {
    std::vector<double> speeds;
    for (const bool left : {true, false}) {
      auto side = [&](const BodyJoints::Pair& p) { return left ? p.left : p.right; };
      std::vector<int> feet{side(body_->ankle)};
      if (body_->toe.known()) feet.push_back(side(body_->toe));
      add_contacts(feet, speeds);
    }
    if (const double speed = quantile(speeds, 0.5); speed > limits_.slide) {
      Vec low = at(first_, 0), high = low;
      for (Index f = first_; f < frames(); ++f) {
        const Vec& p = at(f, 0);
        low = {std::min(low.x, p.x), 0, std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), 0, std::max(high.z, p.z)};
      }
      add(Fault::sliding_feet, first_, "standing feet slide at ", hundredths(speed), " m/s",
          norm(Vec{high.x - low.x, 0, high.z - low.z}) < limits_.on_the_spot ? "; a clip in place" : "");
    }
    const double sole = sole_height({0, 1, 0});
    if (sole >= -limits_.below && sole <= limits_.above) return;
    add(Fault::floor, first_, "the feet are ", hundredths(std::abs(sole)), " m ", sole < 0 ? "below" : "above",
        " y = 0");
    out_.cure.lift = -sole;
  }

  const Motion& motion_;
  const InspectionLimits& limits_;
  Inspection out_;
  std::optional<BodyJoints> body_;
  std::vector<Vec> positions_;  // (frames, joints)
  Index first_ = 0;             // frame after the lead-in
};

}  // namespace detail

/// All findings of a clip. Skeletons that no table of skeleton_tables.hpp fits are checked for values, frame rate, spikes
/// and jumps only. Throws config_error 106 for a malformed skeleton, 101 for a frame rate that is none, shape_error 205
/// if the arrays do not fit.
inline Inspection inspect_motion(const Motion& motion, const InspectionLimits& limits = {}) {
  motion.skeleton.validate();
  if (motion.local.size() != motion.root.size() * static_cast<std::size_t>(motion.skeleton.size())) {
    raise<shape_error>(205, "inspect_motion: '", motion.name, "' has ", motion.local.size(), " rotations for ",
                       motion.frames(), " frames of ", motion.skeleton.size(), " joints");
  }
  if (!(motion.fps > 0 && std::isfinite(motion.fps))) {
    raise<config_error>(101, "inspect_motion: '", motion.name, "' has a frame rate of ", motion.fps);
  }
  return detail::MotionInspector(motion, limits).run();
}

/// The clip with what the cure says. Throws shape_error 203 if it names frames that the clip does not have.
inline Motion mended(const Motion& motion, const Cure& cure) {
  Motion out = motion;
  for (const Index f : cure.spikes) {
    if (f < 1 || f + 1 >= motion.frames())
      raise<shape_error>(203, "mended: spike in frame ", f, " of ", motion.frames());
    out.root[static_cast<std::size_t>(f)] = 0.5 * (out.root_at(f - 1) + motion.root_at(f + 1));
    const auto pose = out.rotations(f), before = out.rotations(f - 1);
    const auto after = motion.rotations(f + 1);
    for (std::size_t j = 0; j < pose.size(); ++j) pose[j] = slerp(before[j], after[j], 0.5);
  }
  out = crop(out, cure.lead_in, out.frames());
  // The rest pose is turned along if it stands along the same axis as the figure.
  const auto& up = cure.upright;
  const auto body = find_body_joints(out.skeleton);
  const bool turn_rest = body && rotate(up, detail::standing_direction(out.skeleton, *body)).y > 0.7;
  for (Vec3<double>& r : out.root) r = cure.scale * rotate(up, r) + Vec3<double>{0, cure.lift, 0};
  for (Vec3<double>& o : out.skeleton.offsets) o = cure.scale * (turn_rest ? rotate(up, o) : o);
  for (Index f = 0; f < out.frames(); ++f) {
    const auto pose = out.rotations(f);
    if (turn_rest) {
      for (auto& q : pose) q = up * q * inverse(up);
    } else {
      pose[0] = up * pose[0];
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_METRICS_MOTION_QUALITY_HPP  // <motionlang/metrics/motion_quality.hpp>
#define MOTIONLANG_HAS_METRICS_MOTION_QUALITY_HPP
/// How physical a clip looks, without a reference: foot skating, jitter, penetration of the floor, constancy of bones.
/// Published figures use many definitions; the ones used here are written down with each function. Y up, metres.

namespace motionlang::inline MOTIONLANG_ABI {

/// Joint positions of a clip, (frames, joints), and how fast they follow each other.
struct JointTracks {
  std::span<const Vec3<double>> positions;
  Index joints = 0;
  double fps = 20;

  Index frames() const { return std::ssize(positions) / joints; }
  const Vec3<double>& at(Index frame, Index joint) const {
    return positions[static_cast<std::size_t>(frame * joints + joint)];
  }
  /// Throws shape_error 205 unless the positions are rows of `joints`, config_error 101 unless fps > 0.
  void validate() const {
    if (joints <= 0 || std::ssize(positions) % joints != 0) {
      raise<shape_error>(205, "JointTracks: ", positions.size(), " positions are not rows of ", joints);
    }
    if (!(fps > 0)) raise<config_error>(101, "JointTracks: frame rate ", fps);
  }
};

struct FootSkate {
  double speed = 0;    // mean horizontal speed of joints in contact, m/s; divide by fps for metres per frame
  double ratio = 0;    // share of contacts faster than the limit
  double contact = 0;  // share of frames x joints in contact
};

/// Sliding feet. A joint is in contact between frames f and f + 1 if it is below its height in both; its speed there is
/// the horizontal distance between the two times fps. `limit` (m/s) counts a contact as skating: 0.5 m/s are the 2.5 cm
/// per frame at 20 fps of GMD (Karunratanakul et al., ICCV 2023).
/// Without contacts everything is 0. Throws as JointTracks::validate, shape_error 203 for a joint out of range.
inline FootSkate foot_skate(const JointTracks& tracks, std::span<const ContactJoint> feet = smpl_contact_joints,
                            double floor = 0, double limit = 0.5) {
  tracks.validate();
  Index contacts = 0, skating = 0, looked_at = 0;
  double sum = 0;
  for (const ContactJoint& foot : feet) {
    if (foot.joint < 0 || foot.joint >= tracks.joints) {
      raise<shape_error>(203, "foot_skate: joint ", foot.joint, " of ", tracks.joints);
    }
    for (Index f = 0; f + 1 < tracks.frames(); ++f, ++looked_at) {
      const auto slide = detail::slide(tracks.positions, tracks.joints, f, foot, floor);
      if (!slide.low) continue;
      const double speed = slide.length() * tracks.fps;
      ++contacts;
      sum += speed;
      skating += speed > limit ? 1 : 0;
    }
  }
  if (contacts == 0) return {};
  const auto n = static_cast<double>(contacts);
  return {sum / n, static_cast<double>(skating) / n, n / static_cast<double>(looked_at)};
}

/// Mean size of the third derivative of joint positions, m/s^3.
///     |p_{f+3} - 3 p_{f+2} + 3 p_{f+1} - p_f| fps^3,   averaged over frames and joints; 0 for fewer than four frames
inline double jitter(const JointTracks& tracks) {
  tracks.validate();
  double sum = 0;
  for (Index f = 0; f + 3 < tracks.frames(); ++f) {
    for (Index j = 0; j < tracks.joints; ++j) {
      sum += norm((tracks.at(f + 3, j) - tracks.at(f, j)) + 3.0 * (tracks.at(f + 1, j) - tracks.at(f + 2, j)));
    }
  }
  const Index terms = std::max<Index>(tracks.frames() - 3, 0) * tracks.joints;
  return terms == 0 ? 0 : sum / static_cast<double>(terms) * tracks.fps * tracks.fps * tracks.fps;
}

struct Penetration {
  double mean = 0;     // depth of the lowest joint, averaged over all frames (0 where nothing is below), metres
  double deepest = 0;  // metres
  double ratio = 0;    // share of frames in which something is below
};

/// How far joints are below the floor.
inline Penetration penetration(const JointTracks& tracks, double floor = 0) {
  tracks.validate();
  Penetration p;
  for (Index f = 0; f < tracks.frames(); ++f) {
    double depth = 0;
    for (Index j = 0; j < tracks.joints; ++j) depth = std::max(depth, floor - tracks.at(f, j).y);
    p.mean += depth;
    p.deepest = std::max(p.deepest, depth);
    p.ratio += depth > 0 ? 1 : 0;
  }
  const auto frames = static_cast<double>(std::max<Index>(tracks.frames(), 1));
  p.mean /= frames;
  p.ratio /= frames;
  return p;
}

/// How much the lengths of bones change: the largest |length - mean| / mean over frames and bones. 0 for a motion that
/// was made by rotations; generated joint positions are not so good. A bone of mean length 0 does not count.
/// Throws as JointTracks::validate, shape_error 204 if there is not one parent for each joint, 203 for a parent out of
/// range.
inline double bone_length_deviation(const JointTracks& tracks, std::span<const int> parents) {
  tracks.validate();
  if (std::ssize(parents) != tracks.joints) {
    raise<shape_error>(204, "bone_length_deviation: ", parents.size(), " parents for ", tracks.joints, " joints");
  }
  double worst = 0;
  std::vector<double> lengths(static_cast<std::size_t>(tracks.frames()));
  for (Index j = 0; j < tracks.joints; ++j) {
    const int parent = parents[static_cast<std::size_t>(j)];
    if (parent < 0) continue;
    if (parent >= tracks.joints) raise<shape_error>(203, "bone_length_deviation: parent ", parent, " of joint ", j);
    double mean = 0;
    for (Index f = 0; f < tracks.frames(); ++f) {
      lengths[static_cast<std::size_t>(f)] = norm(tracks.at(f, j) - tracks.at(f, parent));
      mean += lengths[static_cast<std::size_t>(f)] / static_cast<double>(tracks.frames());
    }
    for (const double length : lengths) worst = mean > 0 ? std::max(worst, std::abs(length - mean) / mean) : worst;
  }
  return worst;
}

struct MotionQuality {
  FootSkate feet;
  double jitter = 0;
  Penetration below_floor;
};
/// All of it for a clip on SMPL's joints (or on others, with their feet) that stands on y = `floor`.
inline MotionQuality motion_quality(const Motion& motion, std::span<const ContactJoint> feet = smpl_contact_joints,
                                    double floor = 0) {
  const std::vector<Vec3<double>> positions = motion.positions();
  const JointTracks tracks{positions, motion.skeleton.size(), motion.fps};
  return {foot_skate(tracks, feet, floor), jitter(tracks), penetration(tracks, floor)};
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_BASELINES_HPP  // <motionlang/compose/baselines.hpp>
#define MOTIONLANG_HAS_COMPOSE_BASELINES_HPP
/// The timelines of the baselines that STMC is compared with: everything on one track, or in one sentence.
///
/// Source  STMC (Petrovich et al. 2024), mtt/create_baselines.py; spec stmc.md 5. They are made from seconds and
///         written to files, which are then read at 20 fps; converting with to_frames gives the same.

#ifndef MOTIONLANG_HAS_COMPOSE_INTERVALS_HPP  // <motionlang/compose/intervals.hpp>
#define MOTIONLANG_HAS_COMPOSE_INTERVALS_HPP
/// Cutting a timeline at every start and end: between two neighbouring cuts the set of active texts is constant.
///
/// Source  STMC (Petrovich et al. 2024), section 3.2; spec stmc.md 3.1

#ifndef MOTIONLANG_HAS_COMPOSE_TIMELINE_HPP  // <motionlang/compose/timeline.hpp>
#define MOTIONLANG_HAS_COMPOSE_TIMELINE_HPP
/// A timeline: texts, each with its time and its body parts. Reading and writing is in timeline_text.hpp.
///
/// Times are frames (Index) where motion is made, and seconds (double) where files are written and edited; the two are
/// different types, so they cannot be mixed.

namespace motionlang::inline MOTIONLANG_ABI {

/// A text that acts on some body parts from `start` up to, not including, `end`.
template <class T>
struct BasicInterval {
  std::string text;
  T start{}, end{};
  BodyParts parts;
  bool operator==(const BasicInterval&) const = default;
};

/// Intervals in the order of the file, which matters: it decides ties.
template <class T>
struct BasicTimeline {
  std::vector<BasicInterval<T>> intervals;

  /// End of the last interval.
  T end() const {
    T last{};
    for (const auto& i : intervals) last = std::max(last, i.end);
    return last;
  }
  bool operator==(const BasicTimeline&) const = default;
};

using Interval = BasicInterval<Index>;
using Timeline = BasicTimeline<Index>;
using IntervalInSeconds = BasicInterval<double>;
using TimelineInSeconds = BasicTimeline<double>;

/// Times beyond this number of frames or seconds are refused.
inline constexpr Index latest_time = 1'000'000'000;

/// trunc(fps * seconds), calculated in double as the published readers do. Throws config_error 101 if it is not a time.
inline Index frame_at(double seconds, double fps) {
  const double frame = std::trunc(fps * seconds);
  if (!(std::abs(frame) <= static_cast<double>(latest_time))) {
    raise<config_error>(101, "frame_at: ", seconds, " s at ", fps, " frames per second is out of range");
  }
  return static_cast<Index>(frame);
}

/// Moves a timeline so that it begins at 0.
template <class T>
void shift_to_zero(BasicTimeline<T>& timeline) {
  if (timeline.intervals.empty()) return;
  T first = timeline.intervals.front().start;
  for (const auto& i : timeline.intervals) first = std::min(first, i.start);
  for (auto& i : timeline.intervals) i.start -= first, i.end -= first;
}

/// Frames of a timeline, shifted to 0 after the conversion. Throws config_error 101.
inline Timeline to_frames(const TimelineInSeconds& timeline, double fps) {
  Timeline out;
  for (const auto& i : timeline.intervals) {
    out.intervals.push_back({i.text, frame_at(i.start, fps), frame_at(i.end, fps), i.parts});
  }
  shift_to_zero(out);
  return out;
}

/// Seconds of a timeline, such that to_frames gives the same frames back. Throws config_error 101.
inline TimelineInSeconds to_seconds(const Timeline& timeline, double fps) {
  const auto seconds = [&](Index frame) {
    double t = static_cast<double>(frame) / fps;
    while (frame_at(t, fps) < frame) t = std::nextafter(t, HUGE_VAL);  // the quotient was rounded down
    return t;
  };
  TimelineInSeconds out;
  for (const auto& i : timeline.intervals) out.intervals.push_back({i.text, seconds(i.start), seconds(i.end), i.parts});
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// A stretch without cuts inside, and the intervals that cover it, in file order.
template <class T>
struct BasicPiece {
  T start{}, end{};
  std::vector<Index> intervals;
  bool operator==(const BasicPiece&) const = default;
};
using Piece = BasicPiece<Index>;

/// The pieces between neighbouring cuts; those of gaps have no intervals. Throws config_error 101 if so many intervals
/// lie over each other that the lists would not be reasonable (10 million entries).
template <class T>
std::vector<BasicPiece<T>> elementary_pieces(const BasicTimeline<T>& timeline) {
  std::vector<std::pair<T, Index>> events;  // every start and end, with the number of its interval
  for (Index i = 0; const auto& interval : timeline.intervals) {
    events.emplace_back(interval.start, i);
    events.emplace_back(interval.end, i++);
  }
  detail::sort(events, [](const auto& a, const auto& b) { return a < b; });

  std::vector<BasicPiece<T>> pieces;
  std::vector<Index> active;  // ascending
  std::size_t entries = 0;
  for (std::size_t at = 0; at < events.size();) {
    const T cut = events[at].first;
    for (; at < events.size() && events[at].first == cut; ++at) {
      const Index i = events[at].second;
      const auto& interval = timeline.intervals[static_cast<std::size_t>(i)];
      const auto place = std::lower_bound(active.begin(), active.end(), i);
      const bool is_active = place != active.end() && *place == i;
      if (is_active && interval.end == cut) active.erase(place);
      if (!is_active && interval.start == cut && interval.end > cut) active.insert(place, i);
    }
    if (at == events.size()) break;
    entries += active.size();
    if (entries > 10'000'000) {
      raise<config_error>(101, "elementary_pieces: too many of ", timeline.intervals.size(), " intervals overlap");
    }
    pieces.push_back({cut, events[at].first, active});
  }
  return pieces;
}

/// Adds an interval with the unconditional text "" and all body parts for every stretch from 0 to the end that no text
/// covers.
template <class T>
void fill_gaps(BasicTimeline<T>& timeline) {
  std::vector<std::pair<T, T>> covered;
  for (const auto& i : timeline.intervals) covered.emplace_back(i.start, i.end);
  detail::sort(covered, [](const auto& a, const auto& b) { return a < b; });
  T reached{};
  for (const auto& [start, end] : covered) {
    if (start > reached) timeline.intervals.push_back({"", reached, start, BodyParts::all()});
    reached = std::max(reached, end);
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

inline BodyParts united(BodyParts a, BodyParts b) { return {a.bits | b.bits}; }

}  // namespace detail

/// One track (DiffCollage): on each piece between cuts the active texts joined by " while ", with all their parts.
/// Pieces without a text are left out.
inline TimelineInSeconds single_track(const TimelineInSeconds& timeline) {
  TimelineInSeconds out;
  for (const auto& piece : elementary_pieces(timeline)) {
    if (piece.intervals.empty()) continue;
    IntervalInSeconds joined{"", piece.start, piece.end, {}};
    for (Index i : piece.intervals) {
      const IntervalInSeconds& active = timeline.intervals[static_cast<std::size_t>(i)];
      joined.text += (i == piece.intervals.front() ? "" : " while ") + active.text;
      joined.parts = detail::united(joined.parts, active.parts);
    }
    out.intervals.push_back(std::move(joined));
  }
  return out;
}

/// One sentence: "T0 and then T1 while T2", from 0 to at most 9.8 s, the longest motion that the models were trained
/// on. The published rule is for three texts; fewer leave its end away, more are joined by further "while".
inline TimelineInSeconds one_text(const TimelineInSeconds& timeline) {
  constexpr double longest = 9.8;
  if (timeline.intervals.empty()) return {};
  IntervalInSeconds joined{"", 0.0, 0.0, {}};
  double first = timeline.intervals.front().start;
  for (std::size_t i = 0; i < timeline.intervals.size(); ++i) {
    const IntervalInSeconds& interval = timeline.intervals[i];
    joined.text += (i == 0 ? "" : i == 1 ? " and then " : " while ") + interval.text;
    joined.parts = detail::united(joined.parts, interval.parts);
    first = std::min(first, interval.start);
  }
  joined.end = std::min(timeline.end() - first, longest);
  return {{std::move(joined)}};
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_BODY_PART_LEXICON_HPP  // <motionlang/compose/body_part_lexicon.hpp>
#define MOTIONLANG_HAS_COMPOSE_BODY_PART_LEXICON_HPP
/// Guesses from a text which body parts it moves, with a small lexicon of English words. A convenience for timelines
/// without parts; a person, a table or a language model (SINC, STMC) does better.
///
///     guess_body_parts("waves with the left hand")   // left arm
///     guess_body_parts("kick twice")                 // legs
///
/// Rule   every known word adds its parts; words of one arm mean the right one unless "left arm", "left hand", ... is
///        written; both arms with "both", with "left and right", or with a plural; nothing known: all parts

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// What a word stem says about the body. `arm` is one arm, whose side the rest of the text tells.
struct WordMeaning {
  std::string_view stem;
  bool arm = false, arms = false, legs = false, head = false, spine = false;
};

// clang-format off
inline constexpr std::array lexicon = {
    // nouns
    WordMeaning{.stem = "arm", .arm = true},       WordMeaning{.stem = "arms", .arms = true},
    WordMeaning{.stem = "hand", .arm = true},      WordMeaning{.stem = "hands", .arms = true},
    WordMeaning{.stem = "elbow", .arm = true},     WordMeaning{.stem = "elbows", .arms = true},
    WordMeaning{.stem = "wrist", .arm = true},     WordMeaning{.stem = "wrists", .arms = true},
    WordMeaning{.stem = "fist", .arm = true},      WordMeaning{.stem = "fists", .arms = true},
    WordMeaning{.stem = "finger", .arm = true},    WordMeaning{.stem = "thumb", .arm = true},
    WordMeaning{.stem = "shoulders", .arms = true}, WordMeaning{.stem = "shoulder", .arm = true},
    WordMeaning{.stem = "leg", .legs = true},      WordMeaning{.stem = "foot", .legs = true},
    WordMeaning{.stem = "feet", .legs = true},     WordMeaning{.stem = "knee", .legs = true},
    WordMeaning{.stem = "ankle", .legs = true},    WordMeaning{.stem = "toe", .legs = true},
    WordMeaning{.stem = "hip", .legs = true},      WordMeaning{.stem = "stair", .legs = true},
    WordMeaning{.stem = "head", .head = true},     WordMeaning{.stem = "neck", .head = true},
    WordMeaning{.stem = "torso", .spine = true},   WordMeaning{.stem = "spine", .spine = true},
    WordMeaning{.stem = "waist", .spine = true},   WordMeaning{.stem = "belly", .spine = true},
    // one arm
    WordMeaning{.stem = "wav", .arm = true},       WordMeaning{.stem = "point", .arm = true},
    WordMeaning{.stem = "throw", .arm = true},     WordMeaning{.stem = "toss", .arm = true},
    WordMeaning{.stem = "punch", .arm = true},     WordMeaning{.stem = "salut", .arm = true},
    WordMeaning{.stem = "knock", .arm = true},     WordMeaning{.stem = "writ", .arm = true},
    WordMeaning{.stem = "scratch", .arm = true},   WordMeaning{.stem = "wip", .arm = true},
    WordMeaning{.stem = "stir", .arm = true},      WordMeaning{.stem = "pour", .arm = true},
    WordMeaning{.stem = "drink", .arm = true, .head = true}, WordMeaning{.stem = "eat", .arm = true, .head = true},
    WordMeaning{.stem = "phon", .arm = true, .head = true},  WordMeaning{.stem = "grab", .arm = true},
    WordMeaning{.stem = "reach", .arm = true},     WordMeaning{.stem = "pick", .arm = true, .spine = true},
    WordMeaning{.stem = "brush", .arm = true},     WordMeaning{.stem = "flick", .arm = true},
    // both arms
    WordMeaning{.stem = "clap", .arms = true},     WordMeaning{.stem = "juggl", .arms = true},
    WordMeaning{.stem = "box", .arms = true},      WordMeaning{.stem = "catch", .arms = true},
    WordMeaning{.stem = "push", .arms = true},     WordMeaning{.stem = "pull", .arms = true},
    WordMeaning{.stem = "lift", .arms = true},     WordMeaning{.stem = "carry", .arms = true},
    WordMeaning{.stem = "hug", .arms = true},      WordMeaning{.stem = "wash", .arms = true},
    WordMeaning{.stem = "sweep", .arms = true},    WordMeaning{.stem = "gestur", .arms = true},
    WordMeaning{.stem = "shrug", .arms = true},    WordMeaning{.stem = "typ", .arms = true},
    WordMeaning{.stem = "guitar", .arms = true},   WordMeaning{.stem = "piano", .arms = true},
    WordMeaning{.stem = "violin", .arms = true},   WordMeaning{.stem = "golf", .arms = true, .spine = true},
    WordMeaning{.stem = "headphone", .arms = true, .head = true},
    // legs
    WordMeaning{.stem = "walk", .legs = true},     WordMeaning{.stem = "run", .legs = true},
    WordMeaning{.stem = "jog", .legs = true},      WordMeaning{.stem = "sprint", .legs = true},
    WordMeaning{.stem = "step", .legs = true},     WordMeaning{.stem = "strid", .legs = true},
    WordMeaning{.stem = "stroll", .legs = true},   WordMeaning{.stem = "march", .legs = true},
    WordMeaning{.stem = "jump", .legs = true},     WordMeaning{.stem = "hop", .legs = true},
    WordMeaning{.stem = "leap", .legs = true},     WordMeaning{.stem = "skip", .legs = true},
    WordMeaning{.stem = "kick", .legs = true},     WordMeaning{.stem = "limp", .legs = true},
    WordMeaning{.stem = "sneak", .legs = true},    WordMeaning{.stem = "tiptoe", .legs = true},
    WordMeaning{.stem = "turn", .legs = true},     WordMeaning{.stem = "spin", .legs = true},
    WordMeaning{.stem = "stand", .legs = true},    WordMeaning{.stem = "lung", .legs = true},
    WordMeaning{.stem = "sit", .legs = true, .spine = true},    WordMeaning{.stem = "squat", .legs = true, .spine = true},
    WordMeaning{.stem = "crouch", .legs = true, .spine = true}, WordMeaning{.stem = "kneel", .legs = true, .spine = true},
    // head and torso
    WordMeaning{.stem = "nod", .head = true},      WordMeaning{.stem = "look", .head = true},
    WordMeaning{.stem = "gaz", .head = true},      WordMeaning{.stem = "peer", .head = true},
    WordMeaning{.stem = "chin", .head = true},     WordMeaning{.stem = "yawn", .head = true},
    WordMeaning{.stem = "bend", .spine = true},    WordMeaning{.stem = "bow", .head = true, .spine = true},
    WordMeaning{.stem = "lean", .spine = true},    WordMeaning{.stem = "twist", .spine = true},
    WordMeaning{.stem = "arch", .spine = true},
    // everything
    WordMeaning{"danc", false, true, true, true, true},      WordMeaning{"swim", false, true, true, true, true},
    WordMeaning{"crawl", false, true, true, true, true},     WordMeaning{"climb", false, true, true, true, true},
    WordMeaning{"cartwheel", false, true, true, true, true}, WordMeaning{"handstand", false, true, true, true, true},
    WordMeaning{"somersault", false, true, true, true, true}, WordMeaning{"exercis", false, true, true, true, true},
    WordMeaning{"fall", false, true, true, true, true},      WordMeaning{"roll", false, true, true, true, true},
};
// clang-format on

/// The longest stem of which the word is a form: the stem and at most four more letters ("step" + "ping").
inline const WordMeaning* meaning_of(std::string_view word) {
  const WordMeaning* best = nullptr;
  for (const WordMeaning& m : lexicon) {
    const bool fits = word.starts_with(m.stem) && word.size() - m.stem.size() <= 4;
    if (fits && (best == nullptr || m.stem.size() > best->stem.size())) best = &m;
  }
  return best;
}

/// Runs of letters in lower case.
inline std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  bool inside = false;
  for (char c : text) {
    const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool letter = lower >= 'a' && lower <= 'z';
    if (letter && !inside) words.emplace_back();
    if (letter) words.back() += lower;
    inside = letter;
  }
  return words;
}

/// "left" and "right" are sides of an arm if the next word, or the one behind "and right", is one: not in "turn left".
struct Sides {
  bool left = false, right = false;

  explicit Sides(std::span<const std::string> words) {
    const auto names_arm = [&](std::size_t i) {
      static constexpr std::array<std::string_view, 10> nouns{"arm",    "arms", "hand",  "hands", "elbow",
                                                              "finger", "fist", "wrist", "thumb", "shoulder"};
      return i < words.size() && std::find(nouns.begin(), nouns.end(), words[i]) != nouns.end();
    };
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] == "both") left = right = true;
      if (words[i] != "left" && words[i] != "right") continue;
      const bool pair = i + 2 < words.size() && (words[i + 1] == "and" || words[i + 1] == "or");
      if (!names_arm(i + 1) && !(pair && names_arm(i + 3))) continue;
      (words[i] == "left" ? left : right) = true;
    }
  }
};

}  // namespace detail

inline BodyParts guess_body_parts(std::string_view text) {
  using enum BodyPart;
  const std::vector<std::string> words = detail::words_of(text);
  detail::WordMeaning sum;
  for (const std::string& word : words) {
    const detail::WordMeaning* m = detail::meaning_of(word);
    if (m == nullptr) continue;
    sum.arm |= m->arm, sum.arms |= m->arms, sum.legs |= m->legs, sum.head |= m->head, sum.spine |= m->spine;
  }
  const detail::Sides sides(words);
  BodyParts parts;
  if (sum.arm || sum.arms) {
    const bool told = sides.left || sides.right;
    if (told ? sides.left : sum.arms) parts = parts.with(left_arm);
    if (told ? sides.right : true) parts = parts.with(right_arm);
  }
  if (sum.legs) parts = parts.with(legs);
  if (sum.head) parts = parts.with(head);
  if (sum.spine) parts = parts.with(spine);
  return parts.empty() ? BodyParts::all() : parts;
}

/// Guesses the parts of all intervals that have none.
template <class T>
void guess_missing_parts(BasicTimeline<T>& timeline) {
  for (auto& i : timeline.intervals) {
    if (i.parts.empty()) i.parts = guess_body_parts(i.text);
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_COLLAGE_HPP  // <motionlang/compose/collage.hpp>
#define MOTIONLANG_HAS_COMPOSE_COLLAGE_HPP
/// The denoising step of STMC: all crops of all timelines through the network in one ragged batch, guided, stitched.
///
/// Independent of the feature type and of the network: any layout with a partition into parts, any `Denoiser`.

#ifndef MOTIONLANG_HAS_COMPOSE_COMBINE_HPP  // <motionlang/compose/combine.hpp>
#define MOTIONLANG_HAS_COMPOSE_COMBINE_HPP
/// Values of a composition: crops cut out of a motion, and a motion put together from crops, per body part and
/// interval.
///
/// All index lists are made once per plan; cutting and stitching are then gathers and scatters of whole rows.

#ifndef MOTIONLANG_HAS_COMPOSE_PLAN_HPP  // <motionlang/compose/plan.hpp>
#define MOTIONLANG_HAS_COMPOSE_PLAN_HPP
/// From timelines to the integers of a composition: which crops to denoise, and which frames of which crop are added to
/// and subtracted from which frames of the motion, for each body part. No tensors here.
///
/// Source     STMC (Petrovich et al. 2024), section 3.3; spec stmc.md 3; reference: nv-tlabs/stmc src/stmc.py
/// Notation   a, b -> start, end of an interval; T -> frames; O, l, r -> Overlap; x -> cut
/// Property   for every body part and frame, additions minus subtractions = 1, however close the cuts are, if extension
///            and transition crops are both on or both off; see net_weights
/// Differs    from the reference, where told to: gaps are filled with the unconditional text "" (the reference stops),
///            and transitions at which no part changes can be left out

#ifndef MOTIONLANG_HAS_COMPOSE_OPTIONS_HPP  // <motionlang/compose/options.hpp>
#define MOTIONLANG_HAS_COMPOSE_OPTIONS_HPP
/// What a caller can choose when timelines are planned.

namespace motionlang::inline MOTIONLANG_ABI {

/// What to do where no text is active: let the model move freely, or throw timeline_error 505.
enum class Gaps { fill, refuse };
/// What to do at a cut at which no part changes its owner, because a text is hidden behind others: throw timeline_error
/// 506, or leave the transition out (the result is the same without it).
enum class HiddenTexts { refuse, ignore };

struct PlanOptions {
  Index overlap = 10;            // frames in total around a cut; 0.5 s at 20 fps
  bool extend = true;            // intervals reach into their neighbours by the overlap
  bool transition_crops = true;  // an unconditional crop around every cut. Both off: SINC, hard cuts
  Gaps gaps = Gaps::fill;
  HiddenTexts hidden = HiddenTexts::refuse;
  Index longest_crop = 0;  // frames that the denoiser accepts; 0: any
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_SINC_ASSIGNMENT_HPP  // <motionlang/compose/sinc_assignment.hpp>
#define MOTIONLANG_HAS_COMPOSE_SINC_ASSIGNMENT_HPP
/// Which text owns which body part while several texts are active.
///
/// Source   SINC (Athanasiou et al., ICCV 2023) heuristic as STMC's code applies it; spec stmc.md 3.2. Where papers and
///          code differ (the base is a text with legs first, ties are random), the code is followed.
/// Rule     1. Base: of the texts with legs (of all, if none has legs) the one with the most body parts. It gets all
///             five parts.
///          2. The others, by number of parts, largest first, in file order among equals, take their parts away from
///             whoever holds them: the text with fewer parts wins, among equals the later one.
/// Ties     between base texts: the first in the file, or random as published when a generator is given

namespace motionlang::inline MOTIONLANG_ABI {

/// Number of the interval that owns each body part.
using PartOwners = std::array<Index, body_part_count>;

/// A generator that can put a list into random order: PythonRandom (as published), NumpyRandom.
template <class G>
concept Shuffler = requires(G& g, std::span<Index> list) {
  g.shuffle(list);
};

/// The library's rule for ties: keep the order of the file.
struct FirstWins {
  void shuffle(std::span<Index>) const {}
};

namespace detail {

/// Of the texts with legs (of all, if there are none) the one with the most parts; of equals the first after a shuffle.
/// Shuffling one text draws nothing.
template <class T, Shuffler G>
Index base_text(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  const auto parts = [&](Index i) { return timeline.intervals[static_cast<std::size_t>(i)].parts; };
  std::vector<Index> candidates;
  for (Index i : texts) {
    if (parts(i).has(BodyPart::legs)) candidates.push_back(i);
  }
  if (candidates.empty()) candidates.assign(texts.begin(), texts.end());
  ties.shuffle(std::span<Index>(candidates));
  Index base = candidates.front();
  for (Index i : candidates) {
    if (parts(i).count() > parts(base).count()) base = i;
  }
  return base;
}

}  // namespace detail

/// Owners of the five parts on a piece with at least one text. `texts` are numbers of intervals in file order.
template <class T, Shuffler G>
PartOwners assign_parts(const BasicTimeline<T>& timeline, std::span<const Index> texts, G& ties) {
  PartOwners owners;
  const Index base = detail::base_text(timeline, texts, ties);
  owners.fill(base);
  for (int count = body_part_count; count > 0; --count) {  // texts with many parts first, in file order among equals
    for (Index i : texts) {
      const BodyParts parts = timeline.intervals[static_cast<std::size_t>(i)].parts;
      if (i == base || parts.count() != count) continue;
      for (int p = 0; p < body_part_count; ++p) {
        if (parts.has(static_cast<BodyPart>(p))) owners[static_cast<std::size_t>(p)] = i;
      }
    }
  }
  return owners;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_TRANSITION_HPP  // <motionlang/compose/transition.hpp>
#define MOTIONLANG_HAS_COMPOSE_TRANSITION_HPP
/// Overlap around the cuts of a timeline: how far texts reach beyond their ends, and the windows of transitions.
///
/// Source   STMC (Petrovich et al. 2024), section 3.3; spec stmc.md 3.4-3.6
/// Differs  from the thesis, which gives 0.25 s on each side: the code splits a total overlap, the longer half to the
///          right

namespace motionlang::inline MOTIONLANG_ABI {

/// A half-open range of frames.
struct FrameRange {
  Index start = 0, end = 0;
  Index size() const { return end - start; }
  bool operator==(const FrameRange&) const = default;
};

/// A total of O frames: l = O div 2 to the left of a cut, r = O - l to the right.
struct Overlap {
  Index left = 0, right = 0;

  /// Throws config_error 101 if it is negative or beyond `latest_time`.
  static Overlap of_frames(Index total) {
    if (total < 0 || total > latest_time) raise<config_error>(101, "Overlap: ", total, " frames");
    return {total / 2, total - total / 2};
  }
  static Overlap of_seconds(double total, double fps) { return of_frames(frame_at(total, fps)); }

  /// [max(s - l, 0), min(e + r, frames))
  FrameRange extend(FrameRange range, Index frames) const {
    return {std::max<Index>(range.start - left, 0), std::min(range.end + right, frames)};
  }
  /// Around a cut x: [max(x - l, 0), min(x + r, frames)).
  FrameRange window(Index cut, Index frames) const { return extend({cut, cut}, frames); }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// A stretch of the timeline that the denoiser sees as one sequence. Crops without frames (overlap 0) are kept, so that
/// numbers agree with the reference; they take part in nothing.
struct Crop {
  Index interval = 0;  // -1: a transition, with the unconditional text
  FrameRange range;
  bool is_transition() const { return interval < 0; }
  bool operator==(const Crop&) const = default;
};

/// A part belongs to one text for a stretch; neighbours have different owners.
struct PartInterval {
  BodyPart part{};
  Index owner = 0;
  FrameRange range;
  bool operator==(const PartInterval&) const = default;
};

/// Frames `from` of a crop go to frames `to` of the motion, for the features of one part.
struct Slice {
  BodyPart part{};
  Index crop = 0;
  FrameRange from, to;
  bool operator==(const Slice&) const = default;
};

/// A window in which a part changes its owner, for interpolation instead of blending (the SINC+lerp baseline).
struct LerpWindow {
  BodyPart part{};
  Index transition = 0;
  FrameRange range;
  bool operator==(const LerpWindow&) const = default;
};

/// Everything about one timeline. All lists are sorted by part, then by time.
struct TimelinePlan {
  Timeline timeline;                 // gaps filled
  Index frames = 0;                  // T
  std::vector<Piece> pieces;         // between cuts
  std::vector<PartOwners> owners;    // on each piece
  std::vector<PartInterval> merged;  // before extension
  std::vector<Crop> crops;           // one for each interval, then the transitions by time
  std::vector<Slice> add, subtract;
  std::vector<LerpWindow> lerp;  // also without transition crops

  /// "" for transitions.
  std::string_view text(const Crop& crop) const {
    if (crop.is_transition()) return {};
    return timeline.intervals[static_cast<std::size_t>(crop.interval)].text;
  }
};

/// Several timelines that are sampled together. The crops of timeline m have the numbers first_crop[m] ...
/// first_crop[m + 1] - 1 in the batch; slices count crops from the first one of their timeline.
struct BatchPlan {
  std::vector<TimelinePlan> timelines;
  std::vector<Index> first_crop{0};
  Index frames = 0;  // of the longest timeline

  Index crops() const { return first_crop.back(); }
};

namespace detail {

inline std::string quoted(const Interval& i) { return concat_text("'", i.text, "' (", i.start, " to ", i.end, ")"); }

inline void check_timeline(const Timeline& timeline) {
  if (timeline.intervals.empty()) raise<timeline_error>(507, "plan_timeline: no interval");
  for (const Interval& i : timeline.intervals) {
    if (i.start < 0 || i.end < i.start || i.end > latest_time) {
      raise<timeline_error>(504, "plan_timeline: ", quoted(i), " is not a range of frames of the motion");
    }
  }
  if (timeline.end() == 0) raise<timeline_error>(504, "plan_timeline: the timeline has no frame");
}

/// Owners piece by piece, in time order. Throws timeline_error 505 at a piece without a text.
template <Shuffler G>
void assign_pieces(TimelinePlan& plan, G& ties) {
  plan.pieces = elementary_pieces(plan.timeline);
  const Index first = plan.pieces.empty() ? plan.frames : plan.pieces.front().start;
  if (first > 0) raise<timeline_error>(505, "plan_timeline: no text covers frames 0 to ", first);
  for (const Piece& piece : plan.pieces) {
    if (piece.intervals.empty()) {
      raise<timeline_error>(505, "plan_timeline: no text covers frames ", piece.start, " to ", piece.end);
    }
    plan.owners.push_back(assign_parts(plan.timeline, piece.intervals, ties));
  }
}

/// Joins neighbouring pieces of a part that have the same owner.
inline void merge_pieces(TimelinePlan& plan) {
  for (std::size_t p = 0; p < body_part_count; ++p) {
    for (std::size_t k = 0; k < plan.pieces.size(); ++k) {
      const Piece& piece = plan.pieces[k];
      const Index owner = plan.owners[k][p];
      if (k > 0 && plan.owners[k - 1][p] == owner)
        plan.merged.back().range.end = piece.end;
      else
        plan.merged.push_back({static_cast<BodyPart>(p), owner, {piece.start, piece.end}});
    }
  }
}

/// The cuts at which a transition is made, ascending: all but the first and the last. Throws timeline_error 506 at one
/// where no part changes its owner, or leaves it out.
inline std::vector<Index> transition_cuts(const TimelinePlan& plan, HiddenTexts hidden) {
  std::vector<Index> cuts;
  for (std::size_t k = 1; k < plan.pieces.size(); ++k) {
    const Index cut = plan.pieces[k].start;
    if (plan.owners[k] != plan.owners[k - 1]) {
      cuts.push_back(cut);
    } else if (hidden == HiddenTexts::refuse) {
      for (const Interval& i : plan.timeline.intervals) {
        if (i.start != cut && i.end != cut) continue;
        raise<timeline_error>(506, "plan_timeline: ", quoted(i), " owns no body part at frame ", cut,
                              ": other texts hide it; give it parts that no text with fewer parts takes");
      }
    }
  }
  return cuts;
}

/// Throws timeline_error 508 at a crop of more than `longest` frames (0: any number).
inline void check_crops(const TimelinePlan& plan, Index longest) {
  for (const Crop& c : plan.crops) {
    if (longest == 0 || c.range.size() <= longest) continue;
    raise<timeline_error>(508, "timeline: '", plan.text(c), "' needs a crop of ", c.range.size(),
                          " frames with its overlap; the denoiser accepts ", longest);
  }
}

inline void make_crops(TimelinePlan& plan, const std::vector<Index>& cuts, const Overlap& overlap,
                       const PlanOptions& options) {
  for (std::size_t i = 0; i < plan.timeline.intervals.size(); ++i) {
    const FrameRange range{plan.timeline.intervals[i].start, plan.timeline.intervals[i].end};
    plan.crops.push_back({static_cast<Index>(i), options.extend ? overlap.extend(range, plan.frames) : range});
  }
  if (options.transition_crops) {
    for (Index cut : cuts) plan.crops.push_back({-1, overlap.window(cut, plan.frames)});
  }
  check_crops(plan, options.longest_crop);
}

/// For each stretch of a part: its extended frames are added from the crop of its owner; where it starts, the window of
/// the transition, which both neighbours have added, is subtracted once.
inline void make_slices(TimelinePlan& plan, const std::vector<Index>& cuts, const Overlap& overlap,
                        const PlanOptions& options) {
  const auto texts = static_cast<Index>(plan.timeline.intervals.size());
  for (const PartInterval& m : plan.merged) {
    const FrameRange to = options.extend ? overlap.extend(m.range, plan.frames) : m.range;
    const Index begin = plan.crops[static_cast<std::size_t>(m.owner)].range.start;
    plan.add.push_back({m.part, m.owner, {to.start - begin, to.end - begin}, to});

    const auto cut = std::lower_bound(cuts.begin(), cuts.end(), m.range.start);
    if (cut == cuts.end() || *cut != m.range.start) continue;  // the beginning
    const Index transition = cut - cuts.begin();
    const FrameRange window = overlap.window(*cut, plan.frames);
    plan.lerp.push_back({m.part, transition, window});
    if (options.transition_crops) plan.subtract.push_back({m.part, texts + transition, {0, window.size()}, window});
  }
}

}  // namespace detail

/// The plan of one timeline. `ties` decides between equal base texts: FirstWins, or a generator (see PlanOptions and
/// sinc_assignment.hpp).
/// Throws     timeline_error 504, 505 (gap), 506 (hidden text), 507, 508 (crop too long), config_error 101
template <Shuffler G>
TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options, G& ties) {
  detail::check_timeline(timeline);
  const Overlap overlap = Overlap::of_frames(options.overlap);
  TimelinePlan plan;
  if (options.gaps == Gaps::fill) fill_gaps(timeline);
  plan.timeline = std::move(timeline);
  plan.frames = plan.timeline.end();
  detail::assign_pieces(plan, ties);
  detail::merge_pieces(plan);
  const std::vector<Index> cuts = detail::transition_cuts(plan, options.hidden);
  detail::make_crops(plan, cuts, overlap, options);
  detail::make_slices(plan, cuts, overlap, options);
  return plan;
}
inline TimelinePlan plan_timeline(Timeline timeline, const PlanOptions& options = {}) {
  FirstWins ties;
  return plan_timeline(std::move(timeline), options, ties);
}

/// Puts plans into one batch.
inline BatchPlan batch_plans(std::vector<TimelinePlan> plans) {
  BatchPlan batch;
  batch.timelines = std::move(plans);
  for (const TimelinePlan& plan : batch.timelines) {
    batch.first_crop.push_back(batch.first_crop.back() + std::ssize(plan.crops));
    batch.frames = std::max(batch.frames, plan.frames);
  }
  return batch;
}

/// Plans of all timelines, in order, with one generator.
template <Shuffler G>
BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options, G& ties) {
  std::vector<TimelinePlan> plans;
  for (const Timeline& t : timelines) plans.push_back(plan_timeline(t, options, ties));
  return batch_plans(std::move(plans));
}
inline BatchPlan plan_timelines(std::span<const Timeline> timelines, const PlanOptions& options = {}) {
  FirstWins ties;
  return plan_timelines(timelines, options, ties);
}

/// Smallest and largest number of additions minus subtractions over all parts and frames. Both are 1 in a plan that
/// extends and has transition crops, or does neither.
struct NetWeights {
  int smallest = 0, largest = 0;
};
inline NetWeights net_weights(const TimelinePlan& plan) {
  NetWeights net{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  for (int p = 0; p < body_part_count; ++p) {
    std::vector<std::pair<Index, int>> steps{{0, 0}, {plan.frames, 0}};  // frame, change of the weight
    const auto count = [&](const std::vector<Slice>& slices, int weight) {
      for (const Slice& s : slices) {
        if (s.part != static_cast<BodyPart>(p)) continue;
        steps.emplace_back(s.to.start, weight), steps.emplace_back(s.to.end, -weight);
      }
    };
    count(plan.add, 1), count(plan.subtract, -1);
    detail::sort(steps, [](const auto& a, const auto& b) { return a < b; });
    int weight = 0;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
      weight += steps[i].second;
      if (steps[i].first == steps[i + 1].first) continue;
      net = {std::min(net.smallest, weight), std::max(net.largest, weight)};
    }
  }
  return net;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// 1 in the columns of a part, else 0: (1, features).
template <Backend B>
Tensor<B, 2> part_mask(const FeatureLayout& layout, BodyPart part) {
  std::vector<typename B::scalar> mask(static_cast<std::size_t>(layout.size));
  for (const IndexRange& r : layout.ranges(part)) {
    for (Index i = r.begin; i < r.end; ++i) mask[static_cast<std::size_t>(i)] = 1;
  }
  return Tensor<B, 2>::from(mask, {1, layout.size});
}

}  // namespace detail

/// The crops of a batch as sequences, in batch order. Motions of the batch lie one after the other, `stride` rows each.
struct CropRows {
  std::vector<Index> rows;  // of the motions, for each row of the crops
  Offsets offsets;          // of the crops
  Index stride = 0;

  /// With crop_frames > 0 every crop has exactly that many frames, whatever follows its range (MDM); the motions need
  /// as many rows behind their end.
  static CropRows of(const BatchPlan& plan, Index crop_frames = 0) {
    CropRows out;
    out.stride = plan.frames + crop_frames;
    std::vector<Index> lengths;
    for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
      for (const Crop& c : plan.timelines[m].crops) {
        const Index n = crop_frames > 0 ? crop_frames : c.range.size();
        for (Index i = 0; i < n; ++i) out.rows.push_back(static_cast<Index>(m) * out.stride + c.range.start + i);
        lengths.push_back(n);
      }
    }
    out.offsets = Offsets(lengths);
    return out;
  }
};

/// Puts crops together: for each body part the additions of the plan, then its subtractions.
///     motion[to, part] = sum crops[from, part] - sum transitions[from, part]
/// Source  STMC, section 3.3, "spatio-temporal stitching"; spec stmc.md 4 step 5
template <Backend B>
class Stitcher {
 public:
  Stitcher() = default;
  /// `crops`: offsets of the crops in batch order; `stride`: rows per motion.
  Stitcher(const BatchPlan& plan, const FeatureLayout& layout, const Offsets& crops, Index stride)
      : rows_(static_cast<Index>(plan.timelines.size()) * stride), features_(layout.size) {
    for (int p = 0; p < body_part_count; ++p) {
      Part part;
      part.mask = detail::part_mask<B>(layout, static_cast<BodyPart>(p));
      std::vector<typename B::scalar> sign;
      for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
        auto take = [&](const std::vector<Slice>& slices, double s) {
          for (const Slice& slice : slices) {
            if (slice.part != static_cast<BodyPart>(p)) continue;
            const Index from = crops.begin(plan.first_crop[m] + slice.crop) + slice.from.start;
            for (Index i = 0; i < slice.to.size(); ++i) {
              part.from.push_back(from + i);
              part.to.push_back(static_cast<Index>(m) * stride + slice.to.start + i);
              sign.push_back(static_cast<typename B::scalar>(s));
            }
          }
        };
        take(plan.timelines[m].add, 1);
        take(plan.timelines[m].subtract, -1);
      }
      part.sign = Tensor<B, 2>::from(sign, {static_cast<Index>(sign.size()), 1});
      parts_.push_back(std::move(part));
    }
  }

  /// crops (rows of all crops, features) -> (motions * stride, features); rows that nothing is added to are 0.
  Tensor<B, 2> operator()(const Tensor<B, 2>& crops) const {
    auto motion = Tensor<B, 2>::zeros({rows_, features_});
    for (const Part& p : parts_)
      motion = std::move(motion) + scatter_add(gather(crops, p.from) * p.sign, p.to, rows_) * p.mask;
    return motion;
  }

 private:
  struct Part {
    std::vector<Index> from, to;
    Tensor<B, 2> sign, mask;  // (rows, 1), (1, features)
  };
  Index rows_ = 0, features_ = 0;
  std::vector<Part> parts_;
};

/// Hard cuts softened afterwards (the SINC+lerp baseline): in every window of the plan the part is interpolated
/// linearly between the values at the window's first and last frame.
///     w v_first + (1 - w) v_last,   w = linspace(1, 0, window)
/// All windows read the hard-cut motion; where they overlap the later one wins. Source: spec stmc.md 5.
template <Backend B>
Tensor<B, 2> interpolate_transitions(const BatchPlan& plan, const FeatureLayout& layout, const Tensor<B, 2>& motion,
                                     Index stride) {
  using S = typename B::scalar;
  const auto read = motion.span();
  std::vector<S> out(read.begin(), read.end());
  const auto width = static_cast<std::size_t>(layout.size);
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    for (const LerpWindow& window : plan.timelines[m].lerp) {
      const auto first = m * static_cast<std::size_t>(stride) + static_cast<std::size_t>(window.range.start);
      const auto n = static_cast<std::size_t>(window.range.size());
      for (std::size_t i = 0; i < n; ++i) {
        const S w = n == 1 ? S(1) : S(1) - static_cast<S>(i) / static_cast<S>(n - 1);
        for (const IndexRange& r : layout.ranges(window.part)) {
          for (auto c = static_cast<std::size_t>(r.begin); c < static_cast<std::size_t>(r.end); ++c) {
            out[(first + i) * width + c] = w * read[first * width + c] + (S(1) - w) * read[(first + n - 1) * width + c];
          }
        }
      }
    }
  }
  return Tensor<B, 2>::from(out, motion.shape());
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

/// What one step computed, for those who want to see it. Rows are those of the crops, in batch order.
template <Backend B>
struct CollageStep {
  Tensor<B, 2> crops, cond, null, guided, x0;
};

/// Source  STMC (Petrovich et al. 2024), algorithm 1; spec stmc.md 4 and 6
/// Cost    crops whose text is "" go through the network once: both calls of guidance would give the same. Texts,
///         offsets and index lists are prepared here, not in the loop.
template <Backend B, Denoiser<B> D>
class Collage {
 public:
  /// text: features of every interval of every timeline, in order; null: of "" (one). The denoiser must outlive the
  /// collage. Throws shape_error 204 if the number of texts is another, timeline_error 508 if a crop is too long for
  /// the denoiser.
  Collage(const D& denoiser, BatchPlan plan, const FeatureLayout& layout, const TextFeatures<B>& text,
          const TextFeatures<B>& null, double guidance)
      : denoiser_(&denoiser), plan_(std::move(plan)), guidance_(guidance) {
    const DenoiserTraits traits = denoiser.traits();
    for (const TimelinePlan& p : plan_.timelines) detail::check_crops(p, traits.longest());
    const bool fixed = traits.crop_frames > 0;
    motion_ = CropRows::of(plan_, traits.crop_frames);
    // With a mask, a crop of fixed size shrinks to its own frames again: masked frames take no part.
    crops_ = fixed && traits.uses_lengths ? own_frames(traits.crop_frames) : motion_;
    stitch_ = Stitcher<B>(plan_, layout, crops_.offsets, motion_.stride);
    build_batch(text, null);
  }

  const BatchPlan& plan() const { return plan_; }
  const Offsets& crop_offsets() const { return crops_.offsets; }
  /// Rows of x per timeline, and of all timelines together.
  Index stride() const { return motion_.stride; }
  Index rows() const { return motion_.stride * static_cast<Index>(plan_.timelines.size()); }

  /// x (rows, features) at network step t -> composite clean estimate. `to_x0` turns the network's output for the crops
  /// into x0 where it predicts something else: to_x0(output rows, crop rows).
  template <class F>
  CollageStep<B> step(const Tensor<B, 2>& x, Index t, F to_x0) const {
    CollageStep<B> s;
    s.crops = gather(x, crops_.rows);
    const PoolVector<Index> steps(static_cast<std::size_t>(batch_offsets_.count()), t);
    const Sequences<B> batch(base_.empty() ? s.crops : gather(x, batch_rows_), batch_offsets_);
    const auto out = (*denoiser_)(batch, steps, batch_text_).rows;
    if (base_.empty()) {
      s.cond = s.null = s.guided = out;
    } else {
      s.cond = slice(out, 0, 0, crops_.offsets.rows());
      s.null = gather(out, base_);
      s.guided = guide(s.cond, s.null, guidance_);
    }
    s.x0 = stitch_(to_x0(s.guided, s.crops));
    return s;
  }
  CollageStep<B> step(const Tensor<B, 2>& x, Index t) const {
    return step(x, t, [](const Tensor<B, 2>& output, const Tensor<B, 2>&) { return output; });
  }
  /// Stitches any values of the crops.
  Tensor<B, 2> stitch(const Tensor<B, 2>& crops) const { return stitch_(crops); }

 private:
  CropRows own_frames(Index crop_frames) const {
    CropRows out = CropRows::of(plan_);
    for (Index& row : out.rows) {  // the same frames in motions with more rows
      const Index m = row / plan_.frames;
      row += m * crop_frames;
    }
    out.stride = motion_.stride;
    return out;
  }

  /// The batch: all crops with their texts, then every crop with a text once more without it.
  void build_batch(const TextFeatures<B>& text, const TextFeatures<B>& null) {
    std::vector<Index> which, lengths, again;
    Index next_text = 0, crop = 0;
    for (const TimelinePlan& p : plan_.timelines) {
      for (const Crop& c : p.crops) {
        const bool own_text = !c.is_transition();
        which.push_back(own_text ? next_text + c.interval : -1);
        if (own_text && !p.text(c).empty()) again.push_back(crop);
        ++crop;
      }
      next_text += static_cast<Index>(p.timeline.intervals.size());
    }
    if (text.count() != next_text || null.count() != 1) {
      raise<shape_error>(204, "Collage: ", text.count(), " texts for ", next_text, " intervals; ", null.count(),
                         " unconditional texts");
    }
    if (guidance_ == 1) again.clear();
    batch_rows_ = crops_.rows;
    for (Index i = 0; i < crop; ++i) lengths.push_back(crops_.offsets.length(i));
    if (!again.empty()) {
      base_.resize(static_cast<std::size_t>(crops_.offsets.rows()));
      for (std::size_t r = 0; r < base_.size(); ++r) base_[r] = static_cast<Index>(r);
      for (Index i : again) {
        which.push_back(-1);
        lengths.push_back(crops_.offsets.length(i));
        for (Index r = crops_.offsets.begin(i); r < crops_.offsets.end(i); ++r) {
          base_[static_cast<std::size_t>(r)] = static_cast<Index>(batch_rows_.size());
          batch_rows_.push_back(crops_.rows[static_cast<std::size_t>(r)]);
        }
      }
    }
    batch_offsets_ = Offsets(lengths);
    // The unconditional text is number `next_text` of the joined features.
    for (Index& i : which) i = i < 0 ? next_text : i;
    TextFeatures<B> all{
        {concat(0, text.tokens.rows, null.tokens.rows), joined(text.tokens.offsets, null.tokens.offsets)},
        text.end_position};
    all.end_position.insert(all.end_position.end(), null.end_position.begin(), null.end_position.end());
    batch_text_ = gather(all, which);
  }
  static Offsets joined(const Offsets& a, const Offsets& b) {
    std::vector<Index> lengths;
    for (const Offsets* o : {&a, &b}) {
      for (Index i = 0; i < o->count(); ++i) lengths.push_back(o->length(i));
    }
    return Offsets(lengths);
  }

  const D* denoiser_;
  BatchPlan plan_;
  double guidance_;
  CropRows motion_, crops_;
  Stitcher<B> stitch_;
  std::vector<Index> batch_rows_, base_;  // base_: for every row of the crops, where its unconditional result is
  Offsets batch_offsets_;
  TextFeatures<B> batch_text_;
};

/// The whole reverse process. noise(0) is the initial x, noise(1), noise(2), ... belong to the steps; all of shape
/// (rows, features).
/// -> clean motions (rows, features), normalised; rows behind a timeline's end mean nothing. `watch(t, step)` sees
/// every step. Throws `cancelled` if progress says so.
template <Backend B, Denoiser<B> D, class Noise, class Watch = IgnoreSteps>
Tensor<B, 2> sample_collage(const Collage<B, D>& collage, const GaussianDiffusion& diffusion, Prediction prediction,
                            Noise&& noise, const SamplingOptions& options = {}, Progress progress = {},
                            const Watch& watch = {}) {
  auto network = [&](const Tensor<B, 2>& x, Index t) {
    return collage
        .step(x, diffusion.network_t(t),
              [&](const Tensor<B, 2>& output, const Tensor<B, 2>& crops) {
                return to_x0(diffusion, prediction, output, crops, std::span<const Index>(&t, 1));
              })
        .x0;
  };
  auto step_noise = [&](Index draw) { return noise(draw + 1); };
  const StepOptions step{.noise_scale = options.noise_scale, .clip = options.clip};
  if (options.sampler == SamplingOptions::Sampler::ddim) {
    return sample_ddim<B, 2>(diffusion, noise(0), network, step_noise, options.eta, step, detail::KeepX0{}, progress,
                             watch);
  }
  return sample_ancestral<B, 2>(diffusion, noise(0), network, step_noise, step, detail::KeepX0{}, progress, -1, watch);
}

/// Every interval of a plan as a motion of its own, for text-to-motion without a timeline and for the SINC baselines.
/// With `frames` > 0 all of them have that many frames.
inline BatchPlan independent_plan(const BatchPlan& plan, Index frames = 0) {
  std::vector<TimelinePlan> alone;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) {
      alone.push_back(plan_timeline({{{i.text, 0, frames > 0 ? frames : i.end - i.start, BodyParts::all()}}}));
    }
  }
  return batch_plans(std::move(alone));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_HANDOVERS_HPP  // <motionlang/compose/handovers.hpp>
#define MOTIONLANG_HAS_COMPOSE_HANDOVERS_HPP
/// Texts cut where what they own changes.
///
/// A text that goes on while another borrows its arms is one crop as published, so the denoiser sees raised arms in the
/// middle of "walk forward" and keeps them up before and after. Cut at these times, it walks with its own arms, then without
/// them, then with its own again; the transitions are where they were.
///
///     const auto motion = stmc.generate(cut_at_handovers(timeline, 10), rng);
///
/// Differs  from STMC (Petrovich et al. 2024), section 3.3, where each text is one crop

namespace motionlang::inline MOTIONLANG_ABI {

/// Cuts every text at the times at which it gets or loses body parts, unless a stretch would be shorter than `least` frames.
/// Throws config_error 101 if too many texts lie over each other.
inline Timeline cut_at_handovers(const Timeline& timeline, Index least) {
  const auto pieces = elementary_pieces(timeline);
  std::vector<PartOwners> owners;
  FirstWins ties;
  for (const Piece& piece : pieces) {
    owners.push_back(piece.intervals.empty() ? PartOwners{} : assign_parts(timeline, piece.intervals, ties));
  }
  least = std::max<Index>(least, 1);
  Timeline out;
  for (Index i = 0; i < std::ssize(timeline.intervals); ++i) {
    Interval rest = timeline.intervals[static_cast<std::size_t>(i)];
    for (std::size_t k = 1; k < pieces.size(); ++k) {
      const Index cut = pieces[k].start;
      const bool changes = [&] {
        for (std::size_t p = 0; p < body_part_count; ++p) {
          if ((owners[k][p] == i) != (owners[k - 1][p] == i)) return true;
        }
        return false;
      }();
      if (!changes || cut - rest.start < least || rest.end - cut < least) continue;
      out.intervals.push_back(rest);
      out.intervals.back().end = cut;
      rest.start = cut;
    }
    out.intervals.push_back(rest);
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_COMPOSE_TIMELINE_TEXT_HPP  // <motionlang/compose/timeline_text.hpp>
#define MOTIONLANG_HAS_COMPOSE_TIMELINE_TEXT_HPP
/// The text form of timelines.
///
///     line      := text "#" start "#" end { "#" body part }          times in seconds
///     timeline  := line { line }
///     file      := timelines separated by blank lines
///
/// Source   STMC (Petrovich et al. 2024), src/stmc.py read_timelines and src/text.py; there is no comment syntax and a
///          text cannot contain '#'
/// Differs  lines of spaces count as blank, any line end is taken (LF, CRLF, CR), a byte order mark is skipped, and an
///          interval that is empty or ends before it starts is refused unless `as_published` is set. Gaps between
///          intervals are no matter of the text: see PlanOptions.
/// Throws   timeline_error 501-504, 507, 509; messages begin "name:line:column: ", columns count characters

namespace motionlang::inline MOTIONLANG_ABI {

struct TimelineTextOptions {
  double fps = 20;  // frame = trunc(fps * seconds)
  bool as_published =
      false;  // take intervals without a frame, and texts without parts as they are; else those move all
  std::string_view name = "timeline";  // of the file, for messages
};

/// A text with a length, for motions of one text each.
struct TimedText {
  std::string text;
  Index frames = 0;
  bool operator==(const TimedText&) const = default;
};

namespace detail {

/// One line of a file, split at '#'. Knows where it stands.
class TimelineLine {
 public:
  TimelineLine(std::string_view line, Index number, std::string_view name) : line_(line), number_(number), name_(name) {
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find('#', at), line.size());
      fields_.push_back(trim(line.substr(at, end - at)));
      at = end + 1;
    }
  }

  std::size_t fields() const { return fields_.size(); }
  std::string_view field(std::size_t i) const { return fields_[i]; }

  /// Throws timeline_error at the beginning of a field (past the last one: at the end of the line).
  template <class... T>
  [[noreturn]] void fail(int id, std::size_t field, const T&... what) const {
    const char* place = field < fields_.size() ? fields_[field].data() : line_.data() + line_.size();
    Index column = 1;
    for (const char* c = line_.data(); c < place; ++c) column += (static_cast<unsigned char>(*c) & 0xC0u) != 0x80u;
    raise<timeline_error>(id, name_, ":", number_, ":", column, ": ", what...);
  }

  /// A time in seconds. Python's spelling: a plus sign is allowed, infinity is not.
  double seconds(std::size_t i) const {
    std::string_view s = fields_[i];
    if (s.size() > 1 && s[0] == '+' && s[1] != '-') s.remove_prefix(1);
    double t = 0;
    const auto [end, status] = std::from_chars(s.data(), s.data() + s.size(), t);
    if (s.empty() || status != std::errc{} || end != s.data() + s.size() || !(std::abs(t) <= double(latest_time))) {
      fail(502, i, "'", fields_[i], "' is not a time in seconds");
    }
    return t;
  }

  BodyParts parts(std::size_t first) const {
    BodyParts parts;
    for (std::size_t i = first; i < fields_.size(); ++i) {
      const auto part = parse_body_part(fields_[i]);
      if (!part) fail(503, i, "'", fields_[i], "' is not a body part (left arm, right arm, legs, head, spine)");
      parts = parts.with(*part);
    }
    return parts;
  }

 private:
  std::string_view line_;
  Index number_;
  std::string_view name_;
  std::vector<std::string_view> fields_;
};

/// T = Index: frames at options.fps; T = double: seconds.
template <class T>
BasicInterval<T> parse_interval(const TimelineLine& line, const TimelineTextOptions& options) {
  if (line.fields() < 3) line.fail(501, line.fields(), "expected 'text # start # end # body parts'");
  const auto time = [&](std::size_t i) {
    if constexpr (std::is_same_v<T, Index>) {
      const double seconds = line.seconds(i);
      if (std::abs(seconds * options.fps) > double(latest_time)) line.fail(502, i, "'", line.field(i), "' is too late");
      return frame_at(seconds, options.fps);
    } else {
      return line.seconds(i);
    }
  };
  BasicInterval<T> out{std::string(line.field(0)), time(1), time(2), line.parts(3)};
  if (out.parts == BodyParts{} && !options.as_published) out.parts = BodyParts::all();
  if (!(out.start < out.end) && !options.as_published) {
    line.fail(504, 2, "the interval ", line.field(1), " to ", line.field(2), " s is empty or ends before it starts");
  }
  return out;
}

template <class T>
std::vector<BasicTimeline<T>> parse_timelines_as(std::string_view text, const TimelineTextOptions& options) {
  if (!(options.fps > 0)) raise<config_error>(101, "parse_timelines: fps ", options.fps);
  std::vector<BasicTimeline<T>> out;
  bool inside = false;
  for_each_line(text, [&](std::string_view line, Index number) {
    const bool blank = trim(line).empty();
    if (!blank) {
      if (!inside) out.emplace_back();
      out.back().intervals.push_back(parse_interval<T>(TimelineLine(line, number, options.name), options));
    }
    inside = !blank;
  });
  if (out.empty()) raise<timeline_error>(507, options.name, ": no line");
  for (auto& timeline : out) {
    shift_to_zero(timeline);
    if (timeline.end() > static_cast<T>(latest_time)) {
      raise<timeline_error>(502, options.name, ": a timeline that lasts ", timeline.end(), " is too long");
    }
  }
  return out;
}

/// Shortest decimal form, as Python prints a float: 5.5, 8.0, 1e-05, 1e+16.
inline void append_python_float(std::string& out, double x) {
  char digits[64];
  const double size = std::abs(x);
  const bool fixed = size == 0 || (size >= 1e-4 && size < 1e16);
  const auto end =
      std::to_chars(digits, digits + sizeof digits, x, fixed ? std::chars_format::fixed : std::chars_format::scientific)
          .ptr;
  const std::string_view text(digits, static_cast<std::size_t>(end - digits));
  out += text;
  if (fixed && text.find('.') == text.npos) out += ".0";
}

}  // namespace detail

/// All timelines of a file, in frames, each shifted to begin at 0.
inline std::vector<Timeline> parse_timelines(std::string_view text, const TimelineTextOptions& options = {}) {
  return detail::parse_timelines_as<Index>(text, options);
}
/// All timelines of a file, in seconds; options.fps has no effect.
inline std::vector<TimelineInSeconds> parse_timelines_in_seconds(std::string_view text,
                                                                 const TimelineTextOptions& options = {}) {
  return detail::parse_timelines_as<double>(text, options);
}
/// The only timeline of a text. Throws timeline_error 509 if there are several.
///
///     auto timeline = parse_timeline("walking in a circle # 0.0 # 6.0 # legs\n"
///                                    "raising both hands  # 2.0 # 5.0 # left arm # right arm\n", {.fps = 20});
inline Timeline parse_timeline(std::string_view text, const TimelineTextOptions& options = {}) {
  auto all = parse_timelines(text, options);
  if (all.size() > 1) raise<timeline_error>(509, options.name, ": ", all.size(), " timelines where one is expected");
  return std::move(all.front());
}

/// Whether a file is a list of single texts ("text # duration") rather than of timelines: every line has fewer than three
/// fields. The published programs ask for one such line only (`as_published`), and then blame the others.
inline bool is_text_list(std::string_view text, const TimelineTextOptions& options = {}) {
  Index lines = 0, short_lines = 0;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    if (detail::trim(line).empty()) return;
    ++lines;
    short_lines += detail::TimelineLine(line, number, options.name).fields() < 3 ? 1 : 0;
  });
  return short_lines > 0 && (options.as_published || short_lines == lines);
}

/// Lines "text # duration"; blank lines are skipped. Throws timeline_error 501, 502, 504, 507.
inline std::vector<TimedText> parse_text_list(std::string_view text, const TimelineTextOptions& options = {}) {
  std::vector<TimedText> out;
  detail::for_each_line(text, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    const detail::TimelineLine line(content, number, options.name);
    if (line.fields() != 2) line.fail(501, std::min<std::size_t>(line.fields(), 2), "expected 'text # duration'");
    const double seconds = line.seconds(1);
    if (std::abs(seconds * options.fps) > double(latest_time)) line.fail(502, 1, "'", line.field(1), "' is too long");
    const Index frames = frame_at(seconds, options.fps);
    if (frames <= 0 && !options.as_published) line.fail(504, 1, "a duration of ", line.field(1), " s has no frame");
    out.push_back({std::string(line.field(0)), frames});
  });
  if (out.empty()) raise<timeline_error>(507, options.name, ": no line");
  return out;
}

/// The text form: fields joined by " # ", body parts in alphabetical order, an empty line after each timeline. Reading
/// it gives the same timelines back (texts trimmed, begin at 0). Throws timeline_error 510 if a text contains '#' or a
/// line end.
inline std::string write_timelines(std::span<const TimelineInSeconds> timelines) {
  using enum BodyPart;
  std::string out;
  for (const TimelineInSeconds& timeline : timelines) {
    for (const IntervalInSeconds& i : timeline.intervals) {
      if (i.text.find_first_of("#\r\n") != i.text.npos) {
        raise<timeline_error>(510, "write_timelines: the text '", i.text, "' contains '#' or a line end");
      }
      out += i.text + " # ";
      detail::append_python_float(out, i.start);
      out += " # ";
      detail::append_python_float(out, i.end);
      for (BodyPart part : {head, left_arm, legs, right_arm, spine}) {
        if (i.parts.has(part)) out += " # " + to_string(part);
      }
      out += '\n';
    }
    out += '\n';
  }
  return out;
}
inline std::string write_timeline(const TimelineInSeconds& timeline) {
  return write_timelines(std::span(&timeline, 1));
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

#ifndef MOTIONLANG_HAS_SYSTEMS_STMC_HPP  // <motionlang/systems/stmc.hpp>
#define MOTIONLANG_HAS_SYSTEMS_STMC_HPP
/// STMC: spatio-temporal motion collage. A timeline of texts on several tracks in, one motion out.
///
/// Source  Petrovich, Litany, Iqbal, Black, Varol, Peng, Rempe: "Multi-track timeline control for text-driven 3D human motion
///         generation" (2024). Works at test time with any denoiser of explicit poses; no training.

#ifndef MOTIONLANG_HAS_SYSTEMS_DETAIL_STMC_CLASS_HPP  // <motionlang/systems/detail/stmc_class.hpp>
#define MOTIONLANG_HAS_SYSTEMS_DETAIL_STMC_CLASS_HPP
/// What a caller sees of STMC: the model and its options. The bodies are in <motionlang/systems/stmc.hpp>.

namespace motionlang::inline MOTIONLANG_ABI {

struct BatchPlan;

/// How crops become one motion.
///   stmc        one noise for the timeline, stitched at every step
///   sinc        every text on its own noise, stitched once at the end with hard cuts (SINC, Athanasiou et al. 2023)
///   sinc_lerp   the same, interpolated around the cuts
enum class StmcMode { stmc, sinc, sinc_lerp };

struct StmcOptions {
  Index overlap = 10;                // frames around a cut, in total
  std::optional<double> guidance{};  // weight of classifier-free guidance, 1: none; the model's own unless given
  Index steps = 0;                   // of sampling; 0: all of the process
  std::optional<SamplingOptions> sampling{};  // the model's own unless given
  StmcMode mode = StmcMode::stmc;
  Gaps gaps = Gaps::fill;
  HiddenTexts hidden = HiddenTexts::refuse;
  Progress progress{};  // called after every step; may cancel
};

/// The denoiser and encoder may be any models of `Denoiser<B>` and `TextEncoder<B>`.
///
///     auto stmc = load_stmc<EigenBackend<float>>("model.safetensors");
///     auto timeline = parse_timeline("walk forward # 0 # 6 # legs\nraise both arms # 2 # 5 # left arm # right arm\n");
///     Tensor<B, 2> motion = stmc.generate(timeline, Philox{.seed = 7});      // (frames, features)
template <Backend B, Denoiser<B> D = MdmSmplDenoiser<B>, TextEncoder<B> E = CaptionEncoder<B>>
struct Stmc {
  D denoiser;
  E text_encoder;
  Normalizer<B> motion_normalizer, text_normalizer;
  GaussianDiffusion diffusion{CosineSchedule{.steps = 100}};
  FeatureLayout layout = smplrifke_layout();
  double guidance = 2.5;       // what the model should be sampled with, where the caller does not say
  SamplingOptions sampling{};  // the same
  double fps = 20;             // of its motions

  static constexpr auto fields() {
    return motionlang::fields("denoiser", &Stmc::denoiser, "text_encoder", &Stmc::text_encoder, "motion_normalizer",
                              &Stmc::motion_normalizer, "text_normalizer", &Stmc::text_normalizer);
  }

  /// One motion per timeline, (frames, features), not normalised. All are sampled together; the noise of each depends only on
  /// the generator and its place in the list. Throws timeline_error 504 ... 508, config_error, `cancelled`.
  std::vector<Tensor<B, 2>> generate(std::span<const Timeline> timelines, const Philox& rng,
                                     const StmcOptions& options = {}) const;
  Tensor<B, 2> generate(const Timeline& timeline, const Philox& rng, const StmcOptions& options = {}) const;

  /// The same with the caller's noise: noise(draw, shape) for draw 0 (initial), 1, 2, ... (steps) is a tensor
  /// (sequences, frames, features) as `shape` says; in the SINC modes every text is a sequence.
  template <class Noise>
  std::vector<Tensor<B, 2>> generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                          const StmcOptions& options = {}) const;

  /// Standard normal numbers of every sequence from its own stream: a timeline alone and in a batch sees the same noise.
  Tensor<B, 3> noise(const Philox& rng, Index draw, const Shape& shape) const;

  /// The process with `steps` steps evenly kept; all when 0.
  GaussianDiffusion process(Index steps) const;

 private:
  TextFeatures<B> encode(const std::vector<std::string>& texts) const;
  static std::vector<std::string> texts_of(const BatchPlan& plan);
  Tensor<B, 2> stitch_independent(const BatchPlan& plan, const Tensor<B, 2>& x0, Index stride) const;
};

/// Generated features (frames, 205) as a motion of the 24-joint skeleton, Y up, metres. Bone lengths are the skeleton's: the
/// rotations are used, not the predicted positions. Published generation starts facing pi.
template <Backend B>
Motion stmc_motion(const Tensor<B, 2>& features, double fps = 20);

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif

namespace motionlang::inline MOTIONLANG_ABI {

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate(std::span<const Timeline> timelines, const Philox& rng,
                                                  const StmcOptions& options) const {
  return generate_from(
      timelines, [&](Index draw, const Shape& shape) { return noise(rng, draw, shape); }, options);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Tensor<B, 2> Stmc<B, D, E>::generate(const Timeline& timeline, const Philox& rng, const StmcOptions& options) const {
  return generate(std::span(&timeline, 1), rng, options).front();
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
template <class Noise>
std::vector<Tensor<B, 2>> Stmc<B, D, E>::generate_from(std::span<const Timeline> timelines, Noise&& noise,
                                                       const StmcOptions& options) const {
  const bool hard_cuts = options.mode != StmcMode::stmc;
  const DenoiserTraits traits = denoiser.traits();
  BatchPlan plan = plan_timelines(timelines, {.overlap = options.overlap,
                                              .extend = !hard_cuts,
                                              .transition_crops = !hard_cuts,
                                              .gaps = options.gaps,
                                              .hidden = options.hidden,
                                              .longest_crop = traits.longest()});
  const auto text = encode(texts_of(plan)), null = encode({std::string()});
  BatchPlan together;  // what is stitched at the end where every text is sampled alone
  if (hard_cuts) {
    together = std::move(plan);
    plan = independent_plan(together, traits.uses_lengths ? 0 : traits.crop_frames);
  }
  const Collage<B, D> collage(denoiser, std::move(plan), layout, text, null, options.guidance.value_or(guidance));
  const BatchPlan& wanted = hard_cuts ? together : collage.plan();
  const auto sequences = static_cast<Index>(collage.plan().timelines.size());
  const Shape shape{sequences, collage.stride(), layout.size};
  auto rows = [&](Index draw) {
    const Tensor<B, 3> z = noise(draw, shape);
    if (z.shape() != shape) raise<shape_error>(204, "Stmc: noise ", z.shape(), " where ", shape, " is needed");
    return reshape<2>(z, {sequences * collage.stride(), layout.size});
  };
  auto x0 = sample_collage<B>(collage, process(options.steps), traits.prediction, rows,
                              options.sampling.value_or(sampling), options.progress);
  Index stride = collage.stride();
  if (hard_cuts) {
    x0 = stitch_independent(wanted, x0, stride);
    stride = wanted.frames;
    if (options.mode == StmcMode::sinc_lerp) x0 = interpolate_transitions(wanted, layout, x0, stride);
  }
  std::vector<Tensor<B, 2>> out;
  for (std::size_t m = 0; m < wanted.timelines.size(); ++m) {
    const Index first = static_cast<Index>(m) * stride;
    out.push_back(motion_normalizer.denormalize(slice(x0, 0, first, first + wanted.timelines[m].frames)));
  }
  return out;
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Tensor<B, 3> Stmc<B, D, E>::noise(const Philox& rng, Index draw, const Shape& shape) const {
  using S = typename B::scalar;
  PoolVector<S> values(static_cast<std::size_t>(shape.count()));
  const auto size = static_cast<std::size_t>(shape[1] * shape[2]);
  for (Index m = 0; m < shape[0]; ++m) {
    auto stream = rng.split("noise").split(static_cast<std::uint64_t>(m)).split(static_cast<std::uint64_t>(draw));
    stream.normal(std::span<S>(values).subspan(static_cast<std::size_t>(m) * size, size));
  }
  return Tensor<B, 3>::from(std::span<const S>(values), shape);
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
GaussianDiffusion Stmc<B, D, E>::process(Index steps) const {
  if (steps == 0 || steps == diffusion.steps()) return diffusion;
  return diffusion.respaced(respace(diffusion.steps(), std::vector<Index>{steps}));
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
TextFeatures<B> Stmc<B, D, E>::encode(const std::vector<std::string>& texts) const {
  auto features = text_encoder.template encode<B>(std::span<const std::string>(texts));
  features.tokens.rows = text_normalizer.normalize(features.tokens.rows);
  if (denoiser.traits().empty_text_is_null) {
    std::vector<typename B::scalar> keep;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const Index rows = features.tokens.offsets.length(static_cast<Index>(i));
      keep.insert(keep.end(), static_cast<std::size_t>(rows), texts[i].empty() ? 0 : 1);
    }
    features.tokens.rows = features.tokens.rows * Tensor<B, 2>::from(keep, {std::ssize(keep), 1});
  }
  return features;
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<std::string> Stmc<B, D, E>::texts_of(const BatchPlan& plan) {
  std::vector<std::string> texts;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) texts.push_back(i.text);
  }
  return texts;
}

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Tensor<B, 2> Stmc<B, D, E>::stitch_independent(const BatchPlan& plan, const Tensor<B, 2>& x0, Index stride) const {
  std::vector<Index> lengths;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Crop& c : p.crops) lengths.push_back(c.range.size());
  }
  const auto all = reshape<3>(x0, {static_cast<Index>(lengths.size()), stride, layout.size});
  const auto clips = from_padded(all, std::span<const Index>(lengths));
  return Stitcher<B>(plan, layout, clips.offsets, plan.frames)(clips.rows);
}

template <Backend B>
Motion stmc_motion(const Tensor<B, 2>& features, double fps) {
  const std::vector<double> values(features.span().begin(), features.span().end());
  return smplrifke_to_motion<double>(values, {.first_angle = std::numbers::pi}, fps);
}

/// The same model over another backend, with copies of all numbers.
template <Backend To, Backend From, template <class> class D, template <class> class E>
Stmc<To, D<To>, E<To>> convert_stmc(const Stmc<From, D<From>, E<From>>& m) {
  return {.denoiser = convert<To>(m.denoiser),
          .text_encoder = convert<To>(m.text_encoder),
          .motion_normalizer = convert<To>(m.motion_normalizer),
          .text_normalizer = convert<To>(m.text_normalizer),
          .diffusion = m.diffusion,
          .layout = m.layout,
          .guidance = m.guidance,
          .sampling = m.sampling,
          .fps = m.fps};
}

/// Weights packed for inference. The model must not be changed afterwards.
template <Backend B, class D, class E>
void prepare(Stmc<B, D, E>& stmc) {
  prepare(stmc.denoiser);
  if constexpr (Module<E>) prepare(stmc.text_encoder);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
#endif
#endif
