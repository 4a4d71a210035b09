// SPDX-License-Identifier: MIT
/// The kernels of every instruction set that this machine has, not only of the one that would be chosen.
#pragma once

#include <doctest/doctest.h>
#include <string>
#include <utility>

#include <motionlang/backend/detail/kernels.hpp>
#include <motionlang/backend/precision.hpp>

namespace kernel_sets {

/// Another value in a place, as long as this lives.
template <class T>
struct Instead {
  Instead(T& p, T value) : place(p), before(std::exchange(p, value)) {}
  ~Instead() { place = before; }
  Instead(const Instead&) = delete;
  Instead& operator=(const Instead&) = delete;

  T& place;
  T before;
};

/// Products in a precision, as long as this lives.
struct InPrecision {
  explicit InPrecision(motionlang::Precision p) { motionlang::set_product_precision(p); }
  ~InPrecision() { motionlang::set_product_precision(before); }
  InPrecision(const InPrecision&) = delete;
  InPrecision& operator=(const InPrecision&) = delete;

  motionlang::Precision before = motionlang::product_precision();
};

/// Calls f() with the kernels for S of each, with those of AMX in bf16x3.
template <class S, class F>
void with_every_kernel(F f) {
  using motionlang::detail::Isa;
  for (const Isa isa : {Isa::portable, Isa::avx2, Isa::avx512, Isa::amx}) {
    const auto* kernels = motionlang::detail::kernels_for<S>(isa);
    if (kernels == nullptr || (isa == Isa::amx && kernels->isa != isa)) continue;
    INFO(std::string(kernels->name));
    const Instead scope(motionlang::detail::current_kernels<S>(), kernels);
    const InPrecision precision(isa == Isa::amx ? motionlang::Precision::bf16x3 : motionlang::Precision::fp32);
    f();
  }
}

/// The same with products in bfloat16.
template <class F>
void with_every_bf16_kernel(F f) {
  using motionlang::detail::Isa;
  for (const Isa isa : {Isa::portable, Isa::avx2, Isa::avx512, Isa::avx512_bf16, Isa::amx}) {
    const auto* kernels = motionlang::detail::bf16_kernels_for(isa);
    if (kernels == nullptr) continue;
    INFO(std::string(kernels->name));
    const Instead scope(motionlang::detail::current_bf16_kernels(), kernels);
    const InPrecision precision(motionlang::Precision::bf16);
    f();
  }
}

}  // namespace kernel_sets
