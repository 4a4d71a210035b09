// SPDX-License-Identifier: MIT
/// A Stmc with any denoiser and text encoder as a MotionModel.
#pragma once

#include <motionlang/generate/generate_motion.ipp>
#include <motionlang/generate/motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
class StmcMotionModel final : public MotionModel {
 public:
  /// words  of its training texts (text/known_words.hpp); words that have a vector are known with them
  explicit StmcMotionModel(Stmc<B, D, E> model, std::vector<std::string> words = {}, KnownCaptions known = {})
      : model_(std::move(model)), known_(std::move(known)) {
    words_ = KnownWords(std::move(words), encoder() == nullptr ? WordVectors() : encoder()->vectors);
  }

  double fps() const override { return model_.fps; }
  std::string system() const override { return "a diffusion model"; }
  Index steps() const override { return model_.diffusion.steps(); }
  bool takes_timelines() const override { return true; }
  Index longest_crop() const override { return model_.denoiser.traits().longest(); }
  const KnownWords& words() const override { return words_; }
  const KnownCaptions& captions() const override { return known_; }
  TextLength length_of(const std::string& text) const override {
    const CaptionEncoder<B>* encoder = this->encoder();
    if (encoder == nullptr) return {};
    const auto heard = heard_words(encoder->tokenizer, encoder->vectors, std::span(&text, 1), std::ssize(text) + 2);
    return {heard.lengths.front() - 2, encoder->positions.rows().size(0) - 2};  // two are for special tokens
  }

 private:
  std::vector<Motion> make(std::span<const Timeline> timelines, const GenerateOptions& options) const override {
    return generate_motions(model_, timelines, options);
  }
  void require_shareable(std::span<const Timeline> timelines, const GenerateOptions& options) const override {
    require_own_motions(model_, timelines, options);
  }
  /// The encoder of ours, which reads as far as it has positions. Null: another one.
  const CaptionEncoder<B>* encoder() const {
    if constexpr (std::same_as<E, CaptionEncoder<B>>)
      return &model_.text_encoder;
    else if constexpr (requires { model_.text_encoder.captions.has_value(); })
      return model_.text_encoder.captions ? &*model_.text_encoder.captions : nullptr;
    else
      return nullptr;
  }

  Stmc<B, D, E> model_;
  KnownWords words_{};
  KnownCaptions known_;
};

template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::unique_ptr<MotionModel> stmc_motion_model(Stmc<B, D, E> model, std::vector<std::string> words = {},
                                               KnownCaptions known = {}) {
  return std::make_unique<StmcMotionModel<B, D, E>>(std::move(model), std::move(words), std::move(known));
}

MOTIONLANG_NAMESPACE_END
