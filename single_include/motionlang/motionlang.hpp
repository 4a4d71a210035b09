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
///     tanh(x)
enum class Activation { none, relu, gelu, silu, tanh };

/// Throws config_error 103.
inline Activation parse_activation(std::string_view name) {
  if (name == "none" || name == "identity") return Activation::none;
  if (name == "relu") return Activation::relu;
  if (name == "gelu") return Activation::gelu;
  if (name == "silu") return Activation::silu;
  if (name == "tanh") return Activation::tanh;
  raise<config_error>(103, "activation '", name, "' is none of none, relu, gelu, silu, tanh");
}

constexpr std::string_view to_string(Activation a) {
  constexpr std::string_view names[] = {"none", "relu", "gelu", "silu", "tanh"};
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

/// A list of plain values in memory of the pool: cheap to make again and again in a loop. Does what such lists are for and no
/// more (a std::vector over an allocator would be compiled with sixty functions for every type).
template <class T>
class PoolVector {
  static_assert(std::is_trivially_copyable_v<T>, "motionlang::PoolVector: plain values only");

 public:
  using value_type = T;

  PoolVector() = default;
  explicit PoolVector(std::size_t size, T value = T{}) {
    reserve(size);
    for (; size_ < size; ++size_) data_[size_] = value;
  }
  PoolVector(PoolVector&& o) noexcept
      : memory_(std::move(o.memory_)),
        data_(std::exchange(o.data_, nullptr)),
        size_(std::exchange(o.size_, 0)),
        capacity_(std::exchange(o.capacity_, 0)) {}

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
    if (size_ > 0) std::memcpy(larger.data(), data_, size_ * sizeof(T));
    memory_ = std::move(larger);
    data_ = static_cast<T*>(memory_.data());
    capacity_ = capacity;
  }
  void push_back(T value) {
    if (size_ == capacity_) reserve(size_ < 32 ? 64 : 2 * size_);
    data_[size_++] = value;
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
  std::vector<typename B::tensor> data;
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
                     const Offsets& k_offsets, const AttentionOptions& options) {
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
}

/// softmax(q k^T / sqrt(width)) v for one head of one sequence; q (tq, width), k and v (tk, width).
template <Backend B>
Tensor<B, 2> attend(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, Index first_row, Index head,
                    const AttentionOptions& o) {
  const Index tq = q.size(0), tk = k.size(0);
  auto scores = matmul(q, k, {.transpose_b = true}) * (1.0 / std::sqrt(static_cast<double>(q.size(1))));
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
///     O_h = softmax(Q_h K_h^T / sqrt(width / heads)) V_h     within each sequence
/// q (query rows, width), k and v (key rows, width) -> (query rows, width). Padding does not exist here: a key that is
/// masked is simply not in the sequence (see from_padded). Throws config_error 101, shape_error 204, 207.
template <Backend B>
Tensor<B, 2> attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v, const Offsets& q_offsets,
                       const Offsets& k_offsets, const AttentionOptions& options) {
  detail::check_attention(q, k, v, q_offsets, k_offsets, options);
  if constexpr (requires { B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options); }) {
    return Tensor<B, 2>(B::attention(q.data(), k.data(), v.data(), q_offsets, k_offsets, options));
  } else {
    const Index width = q.size(1) / options.heads;
    std::vector<Tensor<B, 2>> sequences, heads;
    for (Index s = 0; s < q_offsets.count(); ++s) {
      const auto qs = slice(q, 0, q_offsets.begin(s), q_offsets.end(s));
      const auto ks = slice(k, 0, k_offsets.begin(s), k_offsets.end(s)),
                 vs = slice(v, 0, k_offsets.begin(s), k_offsets.end(s));
      heads.clear();
      for (Index h = 0; h < options.heads; ++h) {
        auto columns = [&](const Tensor<B, 2>& t) { return slice(t, 1, h * width, (h + 1) * width); };
        heads.push_back(detail::attend(columns(qs), columns(ks), columns(vs), q_offsets.begin(s), h, options));
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

#ifndef MOTIONLANG_HAS_KINEMATICS_BODY_MODEL_HPP  // <motionlang/kinematics/body_model.hpp>
#define MOTIONLANG_HAS_KINEMATICS_BODY_MODEL_HPP
/// Linear blend skinning with shape and pose blend shapes: the forward pass of SMPL, SMPL-H and SMPL-X, over any backend.
///
/// Source    Loper et al. (2015), eq. 2-12; spec body-models.md 1. The model's arrays come from the user's own file.
/// Notation  V vertices, J joints, K shape coefficients, N poses; beta -> betas, R_j -> rotations, tau -> translation
/// Differs   from the smplx package: rest joints come from the regressor folded into template and shape directions, which is
///           the same sum in another order

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

/// Posed points. vertices (N, V, 3), joints (N, J, 3), extra (N, E, 3): points picked from the vertices.
template <Backend B>
struct PosedBody {
  Tensor<B, 3> vertices, joints, extra;
};

template <Backend B>
struct BodyModel {
  static constexpr bool trainable = false;
  Tensor<B, 2> v_template;   // (V, 3)
  Tensor<B, 2> shapedirs;    // (3 V, K)
  Tensor<B, 2> posedirs;     // (3 V, 9 (J - 1))
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

  /// Throws shape_error 204 if the arrays do not fit together, config_error 106 if a parent does not come before its child.
  void validate() const {
    const Index v = vertices(), j = joints();
    if (shapedirs.size(0) != 3 * v || posedirs.shape() != Shape{3 * v, 9 * (j - 1)} ||
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
    return matmul(betas, regress(shapedirs, k), {.transpose_b = true}) + mean;
  }

  /// betas (N, K), rotations (N, J, 9) local and row by row, translation (N, 3).
  PosedBody<B> operator()(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                          const Tensor<B, 2>& translation) const {
    const Index n = rotations.size(0), j = joints(), v = vertices();
    if (rotations.shape() != Shape{n, j, 9} || betas.shape() != Shape{n, shapedirs.size(1)} ||
        translation.shape() != Shape{n, 3}) {
      raise<shape_error>(204, "BodyModel: betas ", betas.shape(), ", rotations ", rotations.shape(), ", translation ",
                         translation.shape(), " for ", j, " joints and ", shapedirs.size(1), " shape coefficients");
    }
    const auto rest = rest_joints(betas);
    const Chain chain = posed_chain(rest, rotations);

    const auto feature = reshape<2>(slice(rotations, 1, 1, j) - identity_row(), {n, 9 * (j - 1)});
    const auto shaped = matmul(betas, shapedirs, {.transpose_b = true}) + reshape<2>(v_template, {1, 3 * v});
    const auto posed = reshape<3>(shaped + matmul(feature, posedirs, {.transpose_b = true}), {n, v, 3});

    // Transform of every vertex: (V, J) (J, N 12) -> (V, N, 12)
    const auto transforms = permute(chain.skinning, {1, 0, 2});  // (J, N, 12)
    const auto blended =
        permute(reshape<3>(matmul(weights, reshape<2>(transforms, {j, n * 12})), {v, n, 12}), {1, 0, 2});
    std::vector<Tensor<B, 3>> axes;
    for (Index row = 0; row < 3; ++row) {
      auto entry = [&](Index column) { return slice(blended, 2, 4 * row + column, 4 * row + column + 1); };
      axes.push_back(entry(0) * slice(posed, 2, 0, 1) + entry(1) * slice(posed, 2, 1, 2) +
                     entry(2) * slice(posed, 2, 2, 3) + entry(3));
    }
    const auto tau = reshape<3>(translation, {n, 1, 3});
    PosedBody<B> out;
    out.vertices = concat(std::span<const Tensor<B, 3>>(axes), 2) + tau;
    out.joints = chain.positions + tau;
    if (!extra.empty()) out.extra = permute(gather(permute(out.vertices, {1, 0, 2}), extra), {1, 0, 2});
    return out;
  }

  /// Joints only: no vertex is touched. (N, J, 3)
  Tensor<B, 3> posed_joints(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                            const Tensor<B, 2>& translation) const {
    return posed_chain(rest_joints(betas), rotations).positions + reshape<3>(translation, {translation.size(0), 1, 3});
  }

 private:
  struct Chain {
    Tensor<B, 3> positions;  // (N, J, 3)
    Tensor<B, 3> skinning;   // (N, J, 12): [R | t - R J], row by row
  };
  static Tensor<B, 1> identity_row() {
    return Tensor<B, 1>::from(std::vector<typename B::scalar>{1, 0, 0, 0, 1, 0, 0, 0, 1}, {9});
  }
  /// The chain, one joint after the other, all poses at once: every number is a tensor (N, 1).
  Chain posed_chain(const Tensor<B, 2>& rest, const Tensor<B, 3>& rotations) const {
    using S = Tensor<B, 2>;
    const Index n = rotations.size(0);
    auto rest_of = [&](std::size_t j) {
      auto c = [&](Index axis) {
        return slice(rest, 1, 3 * static_cast<Index>(j) + axis, 3 * static_cast<Index>(j) + axis + 1);
      };
      return Vec3<S>{c(0), c(1), c(2)};
    };
    std::vector<Matrix3<S>> rotation(parents.size());
    std::vector<Vec3<S>> position(parents.size());
    std::vector<S> points, transforms;
    for (std::size_t j = 0; j < parents.size(); ++j) {
      const auto flat = reshape<2>(slice(rotations, 1, static_cast<Index>(j), static_cast<Index>(j) + 1), {n, 9});
      Matrix3<S> local;
      for (Index i = 0; i < 9; ++i) local.m[static_cast<std::size_t>(i)] = slice(flat, 1, i, i + 1);
      const Vec3<S> own = rest_of(j);
      if (parents[j] < 0) {
        rotation[j] = local;
        position[j] = own;
      } else {
        const auto p = static_cast<std::size_t>(parents[j]);
        rotation[j] = rotation[p] * local;
        position[j] = position[p] + rotation[p] * (own - rest_of(p));
      }
      const Vec3<S> shift = position[j] - rotation[j] * own;
      points.insert(points.end(), {position[j].x, position[j].y, position[j].z});
      const std::array<S, 3> t{shift.x, shift.y, shift.z};
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) transforms.push_back(rotation[j](row, column));
        transforms.push_back(t[static_cast<std::size_t>(row)]);
      }
    }
    return {reshape<3>(concat(std::span<const S>(points), 1), {n, joints(), 3}),
            reshape<3>(concat(std::span<const S>(transforms), 1), {n, joints(), 12})};
  }
};

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

#ifndef MOTIONLANG_HAS_KINEMATICS_SMOOTHING_HPP  // <motionlang/kinematics/smoothing.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SMOOTHING_HPP
/// Smoothing of curves over time.

namespace motionlang::inline MOTIONLANG_ABI {

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

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_HPP  // <motionlang/kinematics/motion.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_HPP
/// A clip of motion: a skeleton, a frame rate, and for each frame the root position and all local rotations.
///
/// Inside the library every clip is Y up, right-handed, in metres, and a rest pose faces +Z. Readers and writers
/// convert at the edge (BVH files in centimetres, AMASS with Z up, ...). Double precision: files and features are exact
/// to the last printed digit.

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
///     Motion steady = fix_feet(motion);      // path_from_feet, then lock_feet

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

/// (frames): by how much a foot has to be moved to stay where it stands. During a contact the offset undoes the slide; its
/// mean is zero, so that the foot stands where it was on average. Between contacts it fades out and in.
inline std::vector<Vec3<double>> foot_offsets(const Motion& motion, std::span<const Vec3<double>> positions,
                                              const Leg& leg, const FootFixOptions& options) {
  const Index joints = motion.skeleton.size(), frames = motion.frames();
  // held[f]: the foot stands from frame f to f + 1; step: how far it slides meanwhile
  std::vector<std::uint8_t> held(static_cast<std::size_t>(frames), 0), fixed(held);
  std::vector<Vec3<double>> step(held.size()), offset(held.size());
  const auto [ankle_joint, toe_joint] = feet_of(leg, options);
  for (Index f = 0; f + 1 < frames; ++f) {
    const auto ankle = slide(positions, joints, f, ankle_joint, options.floor),
               toe = slide(positions, joints, f, toe_joint, options.floor);
    const auto& pivot = toe.low && (!ankle.low || toe.length() < ankle.length()) ? toe : ankle;
    const auto at = static_cast<std::size_t>(f);
    if (pivot.low && pivot.length() * motion.fps < options.speed) held[at] = 1, step[at] = pivot.step;
  }
  for (std::size_t f = 0; f < held.size(); ++f) {
    if (held[f] == 0) continue;
    const std::size_t first = f;
    Vec3<double> sum{};
    for (; held[f] != 0; ++f) {  // the last frame is never held
      offset[f + 1] = offset[f] - step[f];
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
        const double t = 1 - static_cast<double>(d) / static_cast<double>(options.blend + 1);
        const double weight = t * t * (3 - 2 * t);
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
  JointTransforms<double> world;
  for (const Leg& leg : legs) {
    const auto offset = detail::foot_offsets(motion, positions, leg, options);
    for (Index f = 0; f < motion.frames(); ++f) {
      const Vec3<double> by = offset[static_cast<std::size_t>(f)];
      if (norm(by) < 1e-6) continue;
      out.world(f, world);
      const Vec3<double> target = world.position[static_cast<std::size_t>(leg.limb.end)] + by;
      const Vec3<double> forward = world.rotation[static_cast<std::size_t>(leg.limb.upper)] * Vec3<double>{0, 0, 1};
      reach(out.skeleton, out.rotations(f), world, leg.limb, target, forward);
    }
  }
  return out;
}

/// path_from_feet, then lock_feet. Throws what they throw.
inline Motion fix_feet(const Motion& motion, std::span<const Leg> legs = smpl_legs,
                       const FootFixOptions& options = {}) {
  return lock_feet(path_from_feet(motion, legs, options), legs, options);
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

#ifndef MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_HPP  // <motionlang/kinematics/motion_tools.hpp>
#define MOTIONLANG_HAS_KINEMATICS_MOTION_TOOLS_HPP
/// Editing clips: crop, resample, change speed, join, mirror, and take away the T-pose at the start of CMU files. Pure
/// functions; the clip that is passed stays as it is.

#include <iterator>   // begin

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

/// `second` after `first`, as they stand (no blending, no alignment). Throws config_error 102 if skeletons or frame
/// rates differ.
inline Motion concatenate(const Motion& first, const Motion& second) {
  if (first.skeleton != second.skeleton || first.fps != second.fps) {
    raise<config_error>(102, "concatenate: '", first.name, "' has ", first.skeleton.size(), " joints at ", first.fps,
                        " frames per second, '", second.name, "' ", second.skeleton.size(), " at ", second.fps);
  }
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
/// Retargeting: the same movement on another skeleton, here one with SMPL's joint names.
///
///     G_t(f) = G_s(f) C_s^-1
/// G_s, G_t: world rotations of a source joint s and of the target joint t that follows it; C_s: the world rotation
/// that s has when the source stands in the rest pose of the target (a T-pose, facing +Z). A source in that pose so
/// gives the target's rest pose, whatever its local axes, and chains may have different numbers of joints. Bones keep
/// the target's lengths; the path is scaled by the ratio of the legs.

#ifndef MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_HPP  // <motionlang/kinematics/skeleton_tables.hpp>
#define MOTIONLANG_HAS_KINEMATICS_SKELETON_TABLES_HPP
/// Which joint of a known skeleton moves which joint of SMPL: the tables behind retargeting, and how to recognise one.

namespace motionlang::inline MOTIONLANG_ABI {

/// One joint of the target and the joint of the source whose orientation it takes.
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

/// A kind of skeleton. Hands and toes may be missing in a source; all other joints of the table must be there.
struct SkeletonTable {
  std::string name;
  std::vector<MappedJoint> joints;
  /// Whether limbs are turned so that the source's bones take the directions of the target's; false where the zero pose
  /// (with `turn`) is known to be the T-pose although its bones are not straight.
  bool straighten = true;

  const MappedJoint* find(std::string_view target) const {
    for (const MappedJoint& j : joints) {
      if (j.target == target) return &j;
    }
    return nullptr;
  }
  /// The first joint that the table needs and the skeleton lacks; empty if there is none.
  std::string missing(const Skeleton& source) const {
    for (const MappedJoint& j : joints) {
      const bool optional = j.target.ends_with("_hand") || j.target.ends_with("_foot");
      if (!optional && source.find(j.source) < 0) return j.source;
      if (!j.second.empty() && source.find(j.second) < 0) return j.second;
    }
    return {};
  }
  /// How many of its joints the skeleton has.
  int found(const Skeleton& source) const {
    int n = 0;
    for (const MappedJoint& j : joints) n += source.find(j.source) >= 0 ? 1 : 0;
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
  };
  return tables;
}
// clang-format on

/// The table whose joints the skeleton has; of several the one with the most. Throws config_error 103 with the joint that
/// the closest table misses.
inline const SkeletonTable& detect_skeleton_table(const Skeleton& source) {
  const SkeletonTable* best = nullptr;
  const SkeletonTable* closest = nullptr;
  for (const SkeletonTable& table : skeleton_tables()) {
    const int found = table.found(source);
    if (table.missing(source).empty() && (best == nullptr || found > best->found(source))) best = &table;
    if (closest == nullptr || found > closest->found(source)) closest = &table;
  }
  if (best == nullptr) {
    raise<config_error>(103, "detect_skeleton_table: no table fits a skeleton of ", source.size(), " joints (root '",
                        source.names.front(), "'); the closest, ", closest->name, ", needs a joint '",
                        closest->missing(source), "'");
  }
  return *best;
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

/// What a map did with the joints of both skeletons.
struct RetargetReport {
  std::string table;
  std::vector<std::string> unmapped;    // joints of the target that stay at rest
  std::vector<std::string> unused;      // joints of the source that nothing follows
  double leg_ratio = 1, arm_ratio = 1;  // target / source, 0 without arms; the path is scaled by leg_ratio
};
inline std::string to_string(const RetargetReport& r) {
  auto list = [](const std::vector<std::string>& names) {
    std::string out;
    for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
    return out.empty() ? std::string("none") : out;
  };
  auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
  return concat_text(r.table, ": legs x ", rounded(r.leg_ratio), ", arms x ", rounded(r.arm_ratio),
                     "; target joints at rest: ", list(r.unmapped), "; source joints not used: ", list(r.unused));
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

}  // namespace detail

/// How one skeleton follows another; made once, used for every clip.
class SkeletonMap {
 public:
  /// Throws config_error 103 with the name of a joint that the table needs and a skeleton lacks (or, for axes that are
  /// none), 101 if the legs of a skeleton have no length.
  SkeletonMap(const Skeleton& source, const Skeleton& target, const SkeletonTable& table)
      : source_(source), target_(target) {
    const std::string missing = table.missing(source);
    if (!missing.empty()) raise<config_error>(103, "SkeletonMap: ", table.name, " needs a joint '", missing, "'");
    report_.table = table.name;
    rest_pose(table);
    connect(table);
    measure();
  }
  /// With the built-in table that fits the source.
  explicit SkeletonMap(const Skeleton& source, const Skeleton& target = smpl24_skeleton())
      : SkeletonMap(source, target, detect_skeleton_table(source)) {}

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
      world[t] = link.source < 0 ? up : turned(from, link.source, link.undo);
      if (link.second >= 0) world[t] = slerp(world[t], turned(from, link.second, link.undo_second), link.share);
      local[t] = inverse(up) * world[t];
    }
    const Vec3<double> middle = 0.5 * (position(from, left_hip_) + position(from, right_hip_));
    root = report_.leg_ratio * middle - rotate(world[0], hips_);
  }

 private:
  struct Link {
    int source = -1, second = -1;
    Quaternion<double> undo{1, 0, 0, 0}, undo_second{1, 0, 0, 0};  // C_s^-1
    double share = 0;
  };

  static Quaternion<double> turned(const JointTransforms<double>& from, int joint, const Quaternion<double>& undo) {
    return to_quaternion(from.rotation[static_cast<std::size_t>(joint)]) * undo;
  }
  static const Vec3<double>& position(const JointTransforms<double>& from, int joint) {
    return from.position[static_cast<std::size_t>(joint)];
  }

  /// World rotations (before the bones are turned) and positions of the source in its T-pose.
  void rest_pose(const SkeletonTable& table) {
    const auto joints = static_cast<std::size_t>(source_.size());
    rest_rotation_.assign(joints, Quaternion<double>::identity());
    rest_position_.assign(joints, {});
    std::vector<bool> given(joints, false);
    for (const MappedJoint& m : table.joints) {
      const int s = source_.find(m.source);
      if (s < 0) continue;
      rest_rotation_[static_cast<std::size_t>(s)] = detail::axes_rotation(m);
      given[static_cast<std::size_t>(s)] = true;
    }
    for (std::size_t s = 1; s < joints; ++s) {
      const auto parent = static_cast<std::size_t>(source_.parents[s]);
      if (!given[s]) rest_rotation_[s] = rest_rotation_[parent];
      rest_position_[s] = rest_position_[parent] + rotate(rest_rotation_[parent], source_.offsets[s]);
    }
  }

  void connect(const SkeletonTable& table) {
    links_.resize(static_cast<std::size_t>(target_.size()));
    std::vector<bool> used(static_cast<std::size_t>(source_.size()), false);
    for (std::size_t t = 0; t < links_.size(); ++t) {
      const MappedJoint* row = table.find(target_.names[t]);
      if (row == nullptr || source_.find(row->source) < 0) {
        report_.unmapped.push_back(target_.names[t]);
        continue;
      }
      links_[t] = {.source = source_.find(row->source), .share = row->share};
      used[static_cast<std::size_t>(links_[t].source)] = true;
      if (row->second.empty()) continue;
      links_[t].second = source_.find(row->second);
      used[static_cast<std::size_t>(links_[t].second)] = true;
    }
    std::vector<Quaternion<double>> turn(
        links_.size(), Quaternion<double>::identity());  // of the bones, from the T-pose of the source to the target's
    for (std::size_t t = 0; t < links_.size(); ++t) {
      if (table.straighten) turn[t] = bone_turn(static_cast<int>(t), turn);
      Link& link = links_[t];
      if (link.source >= 0) link.undo = inverse(turn[t] * rest_rotation_[static_cast<std::size_t>(link.source)]);
      if (link.second >= 0) link.undo_second = inverse(turn[t] * rest_rotation_[static_cast<std::size_t>(link.second)]);
    }
    for (std::size_t s = 0; s < used.size(); ++s) {
      if (!used[s]) report_.unused.push_back(source_.names[s]);
    }
  }

  /// The rotation that brings a joint of the source from its T-pose to the target's rest pose. Limbs are turned along,
  /// joint by joint; feet only roll with their shins, so that soles stay level; the trunk is taken as it stands.
  Quaternion<double> bone_turn(int t, const std::vector<Quaternion<double>>& turn) const {
    const auto up =
        target_.parent(t) < 0 ? Quaternion<double>::identity() : turn[static_cast<std::size_t>(target_.parent(t))];
    const std::string& name = target_.name(t);
    if (const detail::LimbBone* limb = detail::find_limb_bone(name)) {
      const Vec3<double> bone = source_bone(*limb), wanted = target_bone(*limb);
      if (norm(bone) < 1e-9 || norm(wanted) < 1e-9) return up;
      return rotation_between(rotate(up, bone), wanted) * up;
    }
    if (name == "left_ankle" || name == "right_ankle") {
      const detail::LimbBone shin{name == "left_ankle" ? "left_knee" : "right_knee", name};
      const Vec3<double> bone = source_bone(shin), wanted = target_bone(shin);
      const double roll = std::atan2(wanted.x, -wanted.y) - std::atan2(bone.x, -bone.y);
      return from_axis_angle(Vec3<double>{0, 0, 1}, roll);
    }
    if (name == "left_foot" || name == "right_foot" || name == "left_hand" || name == "right_hand") return up;
    return Quaternion<double>::identity();
  }
  /// The bone of a limb in the T-pose of the source; zero if a joint is not mapped.
  Vec3<double> source_bone(const detail::LimbBone& limb) const {
    const int a = source_of(limb.joint), b = source_of(limb.end);
    if (a < 0 || b < 0) return {};
    return rest_position_[static_cast<std::size_t>(b)] - rest_position_[static_cast<std::size_t>(a)];
  }
  Vec3<double> target_bone(const detail::LimbBone& limb) const {
    const int end = target_.find(limb.end);
    return end < 0 ? Vec3<double>{} : target_.offset(end);
  }
  int source_of(std::string_view target_joint) const {
    const int t = target_.find(target_joint);
    return t < 0 ? -1 : links_[static_cast<std::size_t>(t)].source;
  }

  /// Lengths of legs and arms, and where the hips are.
  void measure() {
    hips_ = 0.5 * (target_.offset(target_["left_hip"]) + target_.offset(target_["right_hip"]));
    left_hip_ = source_of("left_hip");
    right_hip_ = source_of("right_hip");
    if (left_hip_ < 0 || right_hip_ < 0)
      raise<config_error>(103, "SkeletonMap: ", report_.table, " has no 'left_hip' or no 'right_hip'");
    auto ratio = [&](std::span<const detail::LimbBone> bones) {  // over the bones that both skeletons have
      double here = 0, there = 0;
      for (const detail::LimbBone& bone : bones) {
        const double length = norm(source_bone(bone));
        here += length > 0 ? norm(target_bone(bone)) : 0;
        there += length;
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
  std::vector<Quaternion<double>> rest_rotation_;  // of the source
  std::vector<Vec3<double>> rest_position_;
  std::vector<Link> links_;  // of the target's joints
  int left_hip_ = -1, right_hip_ = -1;
  Vec3<double> hips_{};  // middle of the target's hips, seen from its root
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
/// With the built-in table that fits the clip. Throws config_error 103 with the joint that is missing.
inline Motion retarget(const Motion& motion, const Skeleton& target = smpl24_skeleton(),
                       const RetargetOptions& options = {}) {
  return retarget(motion, SkeletonMap(motion.skeleton, target), options);
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

/// Uniform in [-bound, bound].
template <Backend B, int R>
Tensor<B, R> uniform_init(const Shape& shape, double bound, Rng auto& rng) {
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
  std::vector<Tensor<B, 2>> sequences;
  for (Index s = 0; s < q_offsets.count(); ++s) {
    const auto qs = slice(channels, 0, q_offsets.begin(s), q_offsets.end(s));
    const auto kt = softmax(transpose(slice(k, 0, k_offsets.begin(s), k_offsets.end(s))));  // (width, time)
    const auto vs = slice(v, 0, k_offsets.begin(s), k_offsets.end(s));
    std::vector<Tensor<B, 2>> parts;
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

/// Rows divided by max(norm, 1e-12).
template <Backend B>
Tensor<B, 2> normalize_rows(const Tensor<B, 2>& x) {
  const auto squared = reshape<2>(sum(square(x), 1), {x.size(0), 1});
  return x / sqrt(maximum(squared, Tensor<B, 2>(1e-24)));
}

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
  const auto first = static_cast<Index>(start * fps), last = std::min(static_cast<Index>(end * fps), frames);
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
    std::vector<S> values(t.size() * static_cast<std::size_t>(2 * half));
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
    return time_out(time_in(Tensor<B, 2>::from(values, {static_cast<Index>(t.size()), 2 * half}), Activation::silu));
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

#ifndef MOTIONLANG_HAS_TEXT_WORD_PIECE_HPP  // <motionlang/text/word_piece.hpp>
#define MOTIONLANG_HAS_TEXT_WORD_PIECE_HPP
/// A small word-piece tokenizer whose vocabulary is learnt from the captions of a training set.
///
/// For plain captions: ASCII letters are lowered, everything that is neither letter nor digit separates words. The tokenizers of
/// BERT and CLIP, with their Unicode rules, are other headers.

namespace motionlang::inline MOTIONLANG_ABI {

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
    const std::size_t before = ids.size();
    for (std::size_t at = 0; at < word.size();) {
      const std::string prefix = at == 0 ? "" : "##";
      std::size_t length = std::min(word.size() - at, longest_);
      auto found = ids_.end();
      for (; length > 0 && found == ids_.end(); --length) found = ids_.find(prefix + word.substr(at, length));
      if (found == ids_.end()) {
        ids.resize(before);
        ids.push_back(unknown_id);
        return;
      }
      ids.push_back(found->second);
      at += length + 1;
    }
  }

  std::vector<std::string> pieces_;
  std::unordered_map<std::string, Index> ids_;
  std::size_t longest_ = 0;
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

constexpr std::string_view trim(std::string_view s) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  const std::size_t first = s.find_first_not_of(blanks);
  return first == s.npos ? s.substr(0, 0) : s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

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

/// Calls on_line(line, number) for every line, without its end; numbers count from 1.
template <class F>
void for_each_line(std::string_view text, F on_line) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (Index number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    on_line(text.substr(0, end), number);
    text.remove_prefix(std::min(text.size(), end + (text.substr(end).starts_with("\r\n") ? 2 : 1)));
  }
}

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
