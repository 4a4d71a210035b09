// SPDX-License-Identifier: MIT
/// Laws of Denoiser, f(x, t, text):
///
///     shape      the result has the sequences and the width of x
///     batch      a sequence has the same bits alone and in a batch, on one thread and on two
///     tape       the values on a tape equal those without, up to rounding, and every parameter gets a gradient
///     several    frames with several texts each: the same bits as frame by frame and text by text
///     texts      encoded before the first step they give the same bits (EncodesText)
///     numbers    one step and one text for each sequence, else shape_error 204
#pragma once

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "../support/check_error.hpp"
#include "../support/small_modules.hpp"
#include "../support/threads.hpp"
#include "module_laws.hpp"

namespace laws {

using modules::Index, modules::small_features;

/// Three sequences, three steps, three texts.
template <class Denoiser, ml::Backend B>
void several_texts_law(const Denoiser& model, const ml::Sequences<B>& x, std::span<const Index> t,
                       const ml::TextFeatures<B>& text) {
  const auto encoded = ml::encoded_text<B>(model, text);
  const ml::Offsets uses{2, 0, 1};
  const auto several = ml::denoise_with_texts(model, x, uses, t, encoded);
  CHECK(several.offsets == ml::repeat_lengths(x.offsets, uses));
  CHECK(tensors::same_bits(several.rows, model(ml::repeat_sequences(x, uses), t, text).rows));
  CHECK_ERROR(ml::denoise_with_texts(model, x, uses, t.first(2), encoded), "[motionlang.shape.204]");
  CHECK_ERROR(ml::denoise_with_texts(model, x, ml::Offsets{3}, t, encoded), "[motionlang.shape.204]");
  CHECK_ERROR(ml::denoise_with_texts(model, x, ml::Offsets{1, 0, 1, 1}, t, encoded), "[motionlang.shape.204]");
}

/// `Small` makes the denoiser and texts for it. The lengths are equal, since a recurrent one wants that.
template <class Small, ml::Backend B>
void denoiser_laws() {
  const auto model = Small::template make<B>(ml::Philox{.seed = 1});
  static_assert(ml::Denoiser<decltype(model), B>);
  const Index n = 3, frames = 9;
  ml::Philox rng{.seed = 2};
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({n * frames, small_features}, rng), ml::Offsets::equal(n, frames));
  const std::vector<Index> t{0, 7, 49};
  const auto text = Small::template texts<B>(n, ml::Philox{.seed = 3});

  const auto together = model(x, t, text);
  CHECK(together.rows.shape() == x.rows.shape());
  CHECK(together.offsets == x.offsets);
  if constexpr (ml::EncodesText<decltype(model), B>)
    CHECK(tensors::same_bits(model(x, t, model.encode(text)).rows, together.rows));
  for (int threads : {1, 2, 16}) {
    const Threads set(threads);
    for (Index s = 0; s < n; ++s) {
      const std::vector<Index> which{s};
      const std::vector<Index> step{t[static_cast<std::size_t>(s)]};
      const auto alone = model({x[s], ml::Offsets{frames}}, step, ml::gather(text, which));
      CHECK(tensors::same_bits(alone.rows, together[s]));
    }
  }
  const bool equal = requires { Small::equal_lengths; };
  several_texts_law(model, ml::Sequences<B>(x.rows, equal ? x.offsets : ml::Offsets{5, 9, 13}), t, text);

  const std::vector<Index> two{0, 1};
  CHECK_ERROR(model(x, two, text), "[motionlang.shape.204]");
  CHECK_ERROR(model(x, t, ml::gather(text, two)), "[motionlang.shape.204]");
}

template <class Small, ml::Backend B>
void tape_law() {
  using A = ml::Autodiff<B>;
  const auto plain = Small::template make<B>(ml::Philox{.seed = 1});
  const auto taped = ml::convert<A>(plain);
  const Index n = 2, frames = 9;
  const auto run = [&]<class C>(const auto& model, const C&) {
    ml::Philox rng{.seed = 2};
    const auto rows = ml::Tensor<C, 2>::randn({n * frames, small_features}, rng);
    const std::vector<Index> t{3, 40};
    return model({rows, ml::Offsets::equal(n, frames)}, t, Small::template texts<C>(n, ml::Philox{.seed = 3})).rows;
  };
  const auto result = run(taped, A{});
  CHECK(tensors::distance(result, run(plain, B{})) < 100 * tensors::tolerance<typename B::scalar>);
  const auto gradients = ml::backward(ml::sum(ml::square(result)));
  ml::visit_tensors(
      taped, [&](const std::string& path, const auto& p) { CHECK_MESSAGE(gradients.find(p.data()) != nullptr, path); });
}

}  // namespace laws
