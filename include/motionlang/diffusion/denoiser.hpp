// SPDX-License-Identifier: MIT
/// The concept of a denoising network, for samplers and for STMC.
#pragma once

#include <motionlang/core/context.hpp>
#include <motionlang/core/fields.hpp>
#include <motionlang/diffusion/gaussian.hpp>
#include <motionlang/nn/text_features.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How a sequence's result depends on the rest of its batch. A batch with such dependencies cannot be split.
///     longest_text   the length of the longest text (MDM-SMPL with texts of several lengths)
///     all            everything (the released GRU of MDM)
enum class BatchMates { none, longest_text, all };

/// Properties of a denoiser that its caller must know.
struct DenoiserTraits {
  Prediction prediction = Prediction::x0;
  Index crop_frames = 0;            // > 0: every crop has exactly this many frames (MDM and MotionDiffuse: 196)
  Index longest_crop = 0;           // > 0: no crop has more frames
  bool uses_lengths = true;         // false: crops of fixed size are not masked
  bool empty_text_is_null = false;  // MDM: the text "" is the unconditional one, in both calls
  BatchMates mates = BatchMates::none;

  /// Frames that a crop may have; 0: any number.
  Index longest() const { return crop_frames > 0 ? crop_frames : longest_crop; }
};

/// A network that removes noise from sequences, given a text for each.
///     x (frames of all sequences, features), t (one step number per sequence), text (one per sequence) -> as x
/// Laws     a sequence gives the same result alone and in a batch, unless its traits name mates (tests/laws)
/// Models   MdmSmplDenoiser, MdmDenoiser, MotionDiffuseDenoiser, and yours
template <class D, class B>
concept Denoiser = Module<D> &&
    requires(const D& d, const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) {
  { d(x, t, text) } -> std::same_as<Sequences<B>>;
  { d.traits() } -> std::same_as<DenoiserTraits>;
};

/// A denoiser that does part of its work on the texts alone, once for all steps:
///     d(x, t, d.encode(text)) == d(x, t, text)
/// Models   MdmSmplDenoiser, MotionDiffuseDenoiser, AnyDenoiser
template <class D, class B>
concept EncodesText = Denoiser<D, B> &&
    requires(const D& d, const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text) {
  { d(x, t, d.encode(text)) } -> std::same_as<Sequences<B>>;
};

/// Denoises frames with several texts each. Sequence i of x has the texts uses.begin(i) ... uses.end(i) - 1, such as a
/// text and the empty one for guidance. t: a step for each text. Throws shape_error 204 for other numbers of sequences,
/// texts or steps. A denoiser that shares work between the texts of a sequence takes `uses` after x (MdmSmplDenoiser,
/// AnyDenoiser):
///     d(x, uses, t, text) == d(repeat_sequences(x, uses), t, text)
template <Backend B, Denoiser<B> D, class Text>
Sequences<B> denoise_with_texts(const D& denoiser, const Sequences<B>& x, const Offsets& uses, std::span<const Index> t,
                                const Text& text) {
  if constexpr (requires { denoiser(x, uses, t, text); })
    return denoiser(x, uses, t, text);
  else
    return denoiser(repeat_sequences(x, uses), t, text);
}

/// The texts in the form that a denoiser receives at every step.
template <Backend B, Denoiser<B> D>
auto encoded_text(const D& denoiser, TextFeatures<B> text) {
  if constexpr (EncodesText<D, B>)
    return denoiser.encode(text);
  else
    return text;
}

MOTIONLANG_NAMESPACE_END
