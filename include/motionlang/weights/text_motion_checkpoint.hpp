// SPDX-License-Identifier: MIT
/// A loaded TEMOS, TMR, TEACH or SINC: a network with everything that turns texts and motions into its inputs, and its
/// outputs into motions. The network may be trained here or published.
///
///     const auto tmr = load_tmr<B>("examples/models/tmr_free");
///     const Tensor<B, 2> text = tmr.encode_text("a person jumps");               // (1, latent)
///     const Tensor<B, 2> motion = tmr.encode_motion(read_motion("jump.bvh"));    // (1, latent)
#pragma once

#include <functional>  // tokens of texts
#include <memory>      // states that were read
#include <span>        // texts
#include <string>      // texts

#include <motionlang/features/feature_rows.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/text/known_captions.hpp>
#include <motionlang/text/known_words.hpp>
#include <motionlang/weights/checkpoint_options.hpp>
#include <motionlang/weights/text_motion_model.hpp>
#include <motionlang/weights/text_states.hpp>
#include <motionlang/weights/vae_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B, class Model>
struct TextMotionCheckpoint {
  Model model;                               // with encode_text, encode_motion and decode
  Normalizer<B> normalizer;                  // of the features
  const MotionFeatures* features = nullptr;  // that it reads and writes
  double fps = 0;                            // of its motions
  double longest = 10;                       // in seconds, of its training motions
  /// The input of the model's text encoder. Throws config_error 102 if it reads the states of a language model and the
  /// options named none.
  std::function<Sequences<B>(std::span<const std::string>)> tokens{};
  std::string folder{}, text_encoder{};  // where it was loaded from
  std::string id{};                      // of the weights (tensors_checksum); only for TMR
  SimilarityScale similarity{};          // of texts and motions; empty if the model has none
  KnownWords known_words{};              // of a model with vectors of words or known captions; others cannot tell
  KnownCaptions captions{};              // that tell what a query means (text.known_captions); only for TMR

  /// The means of the latents, (texts, latent).
  Tensor<B, 2> encode_text(std::span<const std::string> texts) const { return model.encode_text(tokens(texts)).mu; }
  Tensor<B, 2> encode_text(const std::string& text) const { return encode_text(std::span(&text, 1)); }
  /// The mean of the latent of a whole motion on any joints, (1, latent). Throws what rows_of_motion throws.
  Tensor<B, 2> encode_motion(const Motion& motion) const {
    const auto rows = rows_of_motion(*features, motion, fps);
    const std::vector<typename B::scalar> values(rows.begin(), rows.end());
    const Index frames = std::ssize(values) / features->width;
    const auto x = normalizer.normalize(Tensor<B, 2>::from(values, {frames, features->width}));
    return model.encode_motion(Sequences<B>(x, Offsets{frames})).mu;
  }
};

/// The features of a published TEMOS, TEACH or SINC with this many values in a frame.
inline const MotionFeatures& published_temos_features(Index width) {
  return motion_features(width == 64 ? "rifke64" : "smplvelp-published");
}

namespace detail {

/// The system of a folder: "tmr" for a published one, "trained tmr" for our own trainings, ... "" if unknown.
std::string checkpoint_system(const RunFolder& run);

/// The words with a piece of their own or with a vector. Empty without vectors: pieces alone do not tell the words of
/// the training texts.
KnownWords known_words_of(const WordPiece& pieces, const WordVectors& vectors);

/// Encodes each text once with a language model or a cache, and remembers the states.
template <Backend B>
std::function<Sequences<B>(std::span<const std::string>)> remembered_states(const std::string& text_encoder) {
  return [states = std::make_shared<EmbeddingCache>(0), asked = std::make_shared<TextStates>(),
          text_encoder](std::span<const std::string> texts) {
    const auto is_known = [&](const std::string& text) { return states->contains(text); };
    if (!std::all_of(texts.begin(), texts.end(), is_known)) {
      if (!*asked) *asked = text_states<B>(text_encoder);
      *states = (*asked)(texts);
    }
    return states->template encode<B>(texts).tokens;
  };
}

/// From a model trained here, or a published TMR.
template <Backend B, template <class> class System, class Config>
TextMotionCheckpoint<B, System<B>> checkpoint_of(TextMotionModel<B, System> model, const TextModelFile<Config>& file,
                                                 double longest, const std::filesystem::path& folder,
                                                 const CheckpointOptions& options) {
  TextMotionCheckpoint<B, System<B>> out{.model = std::move(model.system),
                                         .normalizer = std::move(model.motion_normalizer),
                                         .features = &motion_features(file.config.features),
                                         .fps = file.fps,
                                         .longest = longest,
                                         .folder = folder.string(),
                                         .text_encoder = options.text_encoder.string(),
                                         .similarity = file.similarity};
  if (model.words) {
    const auto words = std::make_shared<const WordPieceTokens<B>>(std::move(*model.words));
    out.tokens = [words](std::span<const std::string> texts) { return (*words)(texts).tokens; };
    out.known_words = known_words_of(words->tokenizer, words->vectors);
  } else if (model.language) {
    out.tokens = [language = std::move(*model.language)](std::span<const std::string> texts) {
      return language(texts, {});
    };
  } else if (out.text_encoder.empty()) {
    out.tokens = [folder = out.folder,
                  encoder = file.config.text.encoder](std::span<const std::string>) -> Sequences<B> {
      raise<config_error>(102, folder, ": this model reads the states of ", encoder, ": `text_encoder` names it");
    };
  } else {
    out.tokens = remembered_states<B>(out.text_encoder);
  }
  return out;
}

/// From a published TEMOS, TEACH or SINC.
template <Backend B, class Model>
TextMotionCheckpoint<B, Model> checkpoint_of(TextMotionRun<B, Model> run, const FilePath& folder,
                                             const CheckpointOptions& options) {
  const MotionFeatures& features = published_temos_features(run.width());
  return {.model = std::move(run.model),
          .normalizer = std::move(run.normalizer),
          .features = &features,
          .fps = run.fps,
          .tokens = [encoder = std::move(run.text_encoder)](
                        std::span<const std::string> texts) { return encoder.template encode<B>(texts).tokens; },
          .folder = folder.string(),
          .text_encoder = options.text_encoder.string()};
}

/// Throws config_error 102 if a folder of our trainings holds another system.
void require_trained(const std::filesystem::path& folder, const std::string& found, const char* wanted);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/text_motion_checkpoint.ipp>
#endif
