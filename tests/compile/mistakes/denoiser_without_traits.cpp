// SPDX-License-Identifier: MIT
// An own denoiser that does not tell STMC what it predicts.
// expect: d\.traits\(\)
#include <motionlang/backend/reference.hpp>
#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/nn/linear.hpp>

namespace ml = motionlang;

template <ml::Backend B>
struct Still {
  ml::Linear<B> out;
  static constexpr auto fields() { return ml::fields("out", &Still::out); }
#ifndef MISTAKE
  ml::DenoiserTraits traits() const { return {}; }
#endif
  ml::Sequences<B> operator()(const ml::Sequences<B>& x, std::span<const ml::Index>, const ml::TextFeatures<B>&) const {
    return out(x);
  }
};

using B = ml::ReferenceBackend<float>;
static_assert(ml::Denoiser<Still<B>, B>);
