// SPDX-License-Identifier: MIT
/// TMR as the encoder of an index, trained by us or published.
///
///     const TmrSearchEncoder<EigenBackend<float>> tmr(load_tmr<EigenBackend<float>>("examples/models/tmr_free"));
///     const MotionIndexFile index = MotionIndexFile::open("moves.index");
///     for (const MotionHit& hit : search(index, tmr.encode_text("a person jumps"), {.top = 10}))
///       use(clip_of(index.index(), hit).path, hit.start, hit.end);
///
/// Source  Petrovich et al., "TMR: Text-to-Motion Retrieval Using Contrastive 3D Human Motion Synthesis" (ICCV 2023)
#pragma once

#include <algorithm>  // min

#include <motionlang/search/search_encoder.hpp>
#include <motionlang/weights/tmr_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
class TmrSearchEncoder final : public SearchEncoder {
 public:
  explicit TmrSearchEncoder(TmrCheckpoint<B> checkpoint)
      : tmr_(std::move(checkpoint)),
        model_{.id = tmr_.id,
               .path = tmr_.folder,
               .text_encoder = tmr_.text_encoder,
               .width = tmr_.model.motion_encoder.projection.out(),
               .fps = tmr_.fps} {}

  const TmrCheckpoint<B>& checkpoint() const { return tmr_; }
  const IndexModel& model() const override { return model_; }

  /// Throws config_error 102 if the model reads the states of a language model and none was given.
  std::vector<float> encode_texts(std::span<const std::string> texts) const override {
    constexpr std::size_t at_once = 128;
    std::vector<float> out;
    for (std::size_t begin = 0; begin < texts.size(); begin += at_once) {
      const auto some = texts.subspan(begin, std::min(at_once, texts.size() - begin));
      append(out, tmr_.encode_text(some));
    }
    return out;
  }
  std::vector<float> encode_text(const std::string& text) const { return encode_texts(std::span(&text, 1)); }

  std::vector<float> rows_of(const Motion& motion) const override {
    const auto values = rows_of_motion(*tmr_.features, motion, tmr_.fps);
    return normalised(std::vector<float>(values.begin(), values.end()));
  }
  /// The same for existing rows of features, (frames, features).
  std::vector<float> normalised(std::span<const float> features) const {
    std::vector<typename B::scalar> values(features.begin(), features.end());
    std::vector<float> out;
    append(out, tmr_.normalizer.normalize(Tensor<B, 2>::from(values, {frames(features), tmr_.features->width})));
    return out;
  }
  Index frames(std::span<const float> rows) const override { return std::ssize(rows) / tmr_.features->width; }

  std::vector<float> encode_windows(std::span<const float> rows, std::span<const FrameSlice> windows) const override {
    constexpr std::size_t at_once = 64;
    const Index width = tmr_.features->width;
    std::vector<float> out;
    for (std::size_t begin = 0; begin < windows.size(); begin += at_once) {
      std::vector<typename B::scalar> values;
      std::vector<Index> lengths;
      for (const FrameSlice& w : windows.subspan(begin, std::min(at_once, windows.size() - begin))) {
        const auto part =
            rows.subspan(static_cast<std::size_t>(w.first * width), static_cast<std::size_t>(w.length * width));
        values.insert(values.end(), part.begin(), part.end());
        lengths.push_back(w.length);
      }
      const Offsets offsets(lengths);
      const Sequences<B> motion(Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets);
      append(out, tmr_.model.encode_motion(motion).mu);
    }
    return out;
  }

  const SimilarityScale& similarity() const override { return tmr_.similarity; }
  /// The captions nearest to the query, if the model has a list of its captions (TextTokensConfig::known_captions).
  std::vector<std::string> meant(const std::string& query) const override {
    constexpr Index most = 3;
    return tmr_.captions.empty() ? std::vector{query} : tmr_.captions.meant_texts(query, most);
  }
  KnownWords known_words() const override { return tmr_.known_words; }

 private:
  static void append(std::vector<float>& out, const Tensor<B, 2>& rows) {
    for (const auto x : rows.span()) out.push_back(static_cast<float>(x));
  }

  TmrCheckpoint<B> tmr_;
  IndexModel model_;
};

MOTIONLANG_NAMESPACE_END
