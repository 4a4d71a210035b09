// SPDX-License-Identifier: MIT
/// Errors: one hierarchy, one id for each kind of failure, one place that throws, one that catches.
///
/// Without exceptions (-fno-exceptions) an error prints its message and ends the program. Define
/// MOTIONLANG_THROW(exception), the same in all units, to change that. It gets the exception as an object (an error,
/// std::bad_alloc, cancelled) on the thread where it happens, and must not return; std::_Exit ends a program from any
/// thread. Errors that the library would catch, for example to skip an unreadable value in a file of weights, also end
/// it.
///
/// A message reads `[motionlang.shape.201] matmul: inner sizes differ: lhs (2, 60, 512), rhs (256, 1024); at
/// layers.3.linear1`. It has the family and the id, the operation, the fault with both values, and (with
/// MOTIONLANG_DIAGNOSTICS) the module path. Text from files appears in it as UTF-8 without control characters.
/// `error_ids` below lists the ids; every one has a test.
#pragma once

#include <concepts>          // integral, floating_point
#include <cstdio>            // fputs
#include <cstdlib>           // abort
#include <initializer_list>  // parts of a message
#include <limits>            // whole numbers
#include <new>               // bad_alloc
#include <stdexcept>         // runtime_error
#include <string>            // string
#include <string_view>       // string_view
#include <utility>           // exchange, move
#include <vector>            // diagnostics path

#include <motionlang/core/standard_library.hpp>  // to_chars: messages without streams and without the locale
#include <motionlang/core/thread_object.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

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
  if constexpr (std::floating_point<N>) {  // 10000000, not 1e+07, while whole numbers are exact
    constexpr N exact = N(1ull << std::numeric_limits<N>::digits);
    if (n > -exact && n < exact && n != 0 && n == N(static_cast<long long>(n)))
      return append(out, static_cast<long long>(n));
  }
  char digits[64];
  out.append(digits, detail::to_chars(digits, digits + sizeof digits, n).ptr);
}
/// Anything with a `to_string` found by name lookup (shapes, enumerations).
template <class T>
requires requires(const T& t) {
  { to_string(t) } -> std::convertible_to<std::string>;
}
void append(std::string& out, const T& t) { out += to_string(t); }

/// A part of a message: where its value is and how it is written. There is one type for all values and one for literals
/// of all lengths. Otherwise each of the many messages would compile code for its own list of types.
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
std::string concat_parts(std::initializer_list<TextPart> parts);

/// A module that is being evaluated. Its name is given, or comes from the fields of the module around it.
struct ModuleStep {
  std::string name;
  const void* module = nullptr;  // null: the name is given
  const void* type = nullptr;    // tells a module from its first member, which has the same address
  /// The path from `module` to a module inside it. "" if that is not inside it.
  std::string (*path_to)(const void* module, const void* inner, const void* inner_type) = nullptr;
};

/// The step into a module (core/fields.hpp).
template <class M>
struct StepInto;

/// The modules that are being evaluated, outermost first. Only kept when MOTIONLANG_DIAGNOSTICS is defined.
struct ModulePath {
  using Steps = std::vector<ModuleStep>;
  static Steps& steps() { return thread_object<Steps, ModulePath>(); }
  /// "layers.3.linear1"
  static std::string text();
  /// While it lives, this thread is inside the modules of another thread, whose work it shares.
  class Continued {
   public:
#ifdef MOTIONLANG_DIAGNOSTICS
    explicit Continued(Steps other) : own_(std::exchange(steps(), std::move(other))) {}
    ~Continued() { steps() = std::move(own_); }
    Continued(const Continued&) = delete;
    Continued& operator=(const Continued&) = delete;

   private:
    Steps own_;
#else
    explicit Continued(const Steps&) {}
    ~Continued() {}
#endif
  };
};

}  // namespace detail

/// The text of all arguments, one after the other. Numbers look as in `std::to_chars`, whole ones without an exponent.
template <class... T>
std::string concat_text(const T&... parts) {
  return detail::concat_parts({detail::text_part(parts)...});
}

/// The items of a list, each written by text(item), with `between` between them: "left, right".
template <class R, class F>
std::string join_text(const R& items, std::string_view between, F text) {
  std::string out;
  bool first = true;
  for (const auto& item : items) {
    if (!first) out += between;
    first = false;
    detail::append(out, text(item));
  }
  return out;
}
template <class R>
std::string join_text(const R& items, std::string_view between = ", ") {
  return join_text(
      items, between, [](const auto& item) -> const auto& { return item; });
}

/// A number of things: "1 frame", "2 frames". For a word with another plural: counted(n, "pass", "passes").
template <std::integral N>
std::string counted(N n, std::string_view one, std::string_view several = {}) {
  std::string out = concat_text(n, ' ', n == 1 || several.empty() ? one : several);
  if (n != 1 && several.empty()) out += 's';
  return out;
}

/// Names the evaluated module while the object lives. Write ModuleScope scope(*this) in its functions, or give the text
/// as arguments. It costs nothing unless MOTIONLANG_DIAGNOSTICS is set.
struct ModuleScope {
#ifdef MOTIONLANG_DIAGNOSTICS
  template <class... T>
  explicit ModuleScope(const T&... name) {
    detail::ModulePath::steps().push_back({.name = concat_text(name...)});
  }
  template <class M>
  requires requires { M::fields(); }
  explicit ModuleScope(const M& module) { detail::ModulePath::steps().push_back(detail::StepInto<M>::step(module)); }
  ~ModuleScope() { detail::ModulePath::steps().pop_back(); }
#else
  template <class... T>
  explicit ModuleScope(const T&...) {}
  ~ModuleScope() {}
#endif
  ModuleScope(const ModuleScope&) = delete;
  ModuleScope& operator=(const ModuleScope&) = delete;
};

namespace detail {

#ifdef __cpp_exceptions
inline constexpr bool has_exceptions = true;
#else
inline constexpr bool has_exceptions = false;
#endif

/// The one place that throws.
template <class E>
[[noreturn]] void throw_exception(const E& exception) {
#if defined(MOTIONLANG_THROW)
  MOTIONLANG_THROW(exception);
  std::abort();
#elif defined(__cpp_exceptions)
  throw exception;
#else
  std::fputs(exception.what(), stderr);
  std::fputs("\n", stderr);
  std::abort();
#endif
}
[[noreturn]] inline void raise_bad_alloc() { throw_exception(std::bad_alloc()); }

/// The one place that catches. Calls f. If f throws an E, calls handle(e), which returns true to stop the exception
/// here and false to pass it on. Returns true if f came to its end.
template <class E, class F, class H>
bool guard(const F& f, [[maybe_unused]] const H& handle) {
#ifdef __cpp_exceptions
  try {
    f();
  } catch (const E& e) {
    if (!handle(e)) throw;
    return false;
  }
#else
  f();
#endif
  return true;
}
/// The same for any exception: handle() sees std::current_exception().
template <class F, class H>
bool guard_all(const F& f, [[maybe_unused]] const H& handle) {
#ifdef __cpp_exceptions
  try {
    f();
  } catch (...) {
    if (!handle()) throw;
    return false;
  }
#else
  f();
#endif
  return true;
}

/// The message of an error of a family.
std::string error_text(std::string_view family, int id, std::initializer_list<TextPart> parts);

template <class E>
[[noreturn]] void raise_parts(int id, std::initializer_list<TextPart> parts) {
  throw_exception(E(id, error_text(E::family, id, parts)));
}

}  // namespace detail

/// Throws E with this id and the text of all parts.
template <class E, class... T>
[[noreturn]] void raise(int id, const T&... parts) {
  detail::raise_parts<E>(id, {detail::text_part(parts)...});
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/error.ipp>
#endif
