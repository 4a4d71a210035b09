// SPDX-License-Identifier: MIT
/// Several values that are calculated together: one SIMD register as a `ScalarLike`.
///
/// Geometry over `Lane<float>` computes eight poses at a time with the source text for one. With `with_widest_lanes` it
/// computes as many as a register of this processor holds. The compiler's vector types are used, so the code is the
/// same on every processor. Square roots are refined from an estimate (error below 2 ulp).
#pragma once

#include <array>        // lane access
#include <cstdint>      // bit patterns
#include <type_traits>  // is_arithmetic

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/instruction_set.hpp>

MOTIONLANG_NAMESPACE_BEGIN

// Everything below is inlined, because the caller's instruction set decides how such vectors are passed between
// functions.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

template <Scalar S, int bytes = 32>
struct Lane {
  static constexpr int size = bytes / static_cast<int>(sizeof(S));
  typedef S Register __attribute__((vector_size(bytes)));
  using Bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  typedef Bits BitRegister __attribute__((vector_size(bytes)));

  alignas(bytes) Register v{};  // stated, since GCC aligns it less if such registers are not switched on

  Lane() = default;
  /// Not trivial on purpose: functions then return a lane through memory, for any instruction set of their caller.
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

  /// 1 / sqrt(x) of a normal number x > 0, error below 2 ulp; finite for 0. It starts from the well-known estimate by
  /// shifting the exponent, 3.5 % off. Householder's iteration follows: with y = (1 + e) / sqrt(x) and h = x y^2, the
  /// first terms of y / sqrt(h) around h = 1, which leave 2.5 e^3.
  friend MOTIONLANG_INLINE Lane inverse_sqrt(const Lane& x) {
    constexpr Bits magic = sizeof(S) == 4 ? static_cast<Bits>(0x5F375A86) : static_cast<Bits>(0x5FE6EB50C7B537A9);
    Register y = (Register)(magic - ((BitRegister)x.v >> 1));
    for (int i = 0; i < (sizeof(S) == 4 ? 2 : 3); ++i) {
      const Register h = x.v * y * y;
      y = y * (S(1.875) - h * (S(1.25) - S(0.375) * h));
    }
    return from(y);
  }
  /// x / sqrt(x), and one correction of the root itself. 0 for 0.
  friend MOTIONLANG_INLINE Lane sqrt(const Lane& x) {
    const Register y = inverse_sqrt(x).v, r = x.v * y;
    return from(r + S(0.5) * y * (x.v - r * r));
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

/// Calls f.operator()<Lane<S, bytes>>() with the widest registers of this processor. GCC compiles f and everything that
/// it calls for them.
template <Scalar S, class F>
void with_widest_lanes(const F& f) {
#if defined(MOTIONLANG_WIDER_COPIES)
  static const detail::Isa isa = detail::widest_vectors();
  if (isa == detail::Isa::avx512) return detail::with_avx512([&] { f.template operator()<Lane<S, 64>>(); });
  if (isa == detail::Isa::avx2) return detail::with_avx2([&] { f.template operator()<Lane<S, 32>>(); });
#endif
  f.template operator()<Lane<S, 16>>();
}

MOTIONLANG_NAMESPACE_END
