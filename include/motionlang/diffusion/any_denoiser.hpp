// SPDX-License-Identifier: MIT
/// One of the three published denoisers, for code that learns only from a file which one it is.
#pragma once

#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Exactly one of the members is set. The names of its parameters start with that of the member.
template <Backend B>
struct AnyDenoiser {
  std::optional<MdmSmplDenoiser<B>> mdm_smpl{};
  std::optional<MdmDenoiser<B>> mdm{};
  std::optional<MotionDiffuseDenoiser<B>> motiondiffuse{};

  static constexpr auto fields() {
    using M = AnyDenoiser;
    return motionlang::fields("mdm_smpl", &M::mdm_smpl, "mdm", &M::mdm, "motiondiffuse", &M::motiondiffuse);
  }

  DenoiserTraits traits() const {
    return mdm_smpl ? mdm_smpl->traits() : mdm ? mdm->traits() : motiondiffuse->traits();
  }

  /// The texts as they are for MDM, or encoded by the other two before the first step.
  struct EncodedText {
    TextFeatures<B> text;
    std::optional<typename MdmSmplDenoiser<B>::EncodedText> mdm_smpl{};
    std::optional<typename MotionDiffuseDenoiser<B>::EncodedText> motiondiffuse{};
  };
  /// If the encoder of a text marks no end, MotionDiffuse takes its last token as the end.
  EncodedText encode(const TextFeatures<B>& text) const {
    EncodedText out{text};
    if (motiondiffuse && text.end_position.empty()) {
      for (Index i = 0; i < text.count(); ++i) out.text.end_position.push_back(text.tokens.offsets.length(i) - 1);
    }
    if (mdm_smpl) out.mdm_smpl = mdm_smpl->encode(text);
    if (motiondiffuse) out.motiondiffuse = motiondiffuse->encode(out.text);
    return out;
  }

  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const EncodedText& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    if (mdm_smpl) return (*mdm_smpl)(x, t, *text.mdm_smpl, context);
    if (mdm) return (*mdm)(x, t, text.text, context);
    return (*motiondiffuse)(x, t, *text.motiondiffuse, context);
  }
  Sequences<B> operator()(const Sequences<B>& x, const Offsets& uses, std::span<const Index> t,
                          const EncodedText& text) const {
    const ModuleScope scope(*this);
    return mdm_smpl ? (*mdm_smpl)(x, uses, t, *text.mdm_smpl) : (*this)(repeat_sequences(x, uses), t, text);
  }
  Sequences<B> operator()(const Sequences<B>& x, std::span<const Index> t, const TextFeatures<B>& text,
                          const Context& context = {}) const {
    const ModuleScope scope(*this);
    return (*this)(x, t, encode(text), context);
  }
};

MOTIONLANG_NAMESPACE_END
