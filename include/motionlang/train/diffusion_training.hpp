// SPDX-License-Identifier: MIT
/// The trainings of MDM-SMPL, MDM and MotionDiffuse. The model folder has the form that the readers of the published
/// models take (weights/diffusion_run.hpp).
///
///     using A = Autodiff<EigenBackend<float>>;
///     const MdmSmplTrainingConfig config = mdm_smpl_preset("small");
///     const auto data = read_described_motions({.data = "clips", .captions = "captions.tsv"}, config.data,
///                                              row_maker(config.features));
///     train(MdmSmplTraining<A>(config, data), {.out = "run"}, {{"license", "MIT"}, {"provenance", "own recordings"}});
///     const auto stmc = load_diffusion_run<EigenBackend<float>>("run/model");
///
/// `motionlang train-mdm-smpl`, `train-mdm` and `train-motiondiffuse` call it.
/// Source   thesis 6.2.4; Tevet et al. (ICLR 2023); Zhang et al. (TPAMI 2024); their repositories
///          (train/diffusion_systems.hpp)
/// Differs  Each draw has a generator of its own, by seed, step and sample. MotionDiffuse's several GPUs are one batch
#pragma once

#include <algorithm>   // max
#include <filesystem>  // folders
#include <limits>      // no warm-up
#include <map>         // settings
#include <optional>    // an own text encoder
#include <span>        // numbers of motions
#include <string>      // texts
#include <utility>     // move
#include <vector>      // measures

#include <motionlang/datasets/tm2t_data.hpp>
#include <motionlang/train/diffusion_presets.hpp>
#include <motionlang/train/diffusion_systems.hpp>
#include <motionlang/train/diffusion_task.hpp>
#include <motionlang/train/diffusion_texts.hpp>
#include <motionlang/train/feature_statistics.hpp>
#include <motionlang/train/motion_batch.hpp>
#include <motionlang/train/trainer.hpp>
#include <motionlang/weights/own_text_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B, class System>
struct DiffusionModel {
  typename System::template Denoiser<B> denoiser;
  std::optional<OwnTextEncoder<B>> text_encoder{};  // none: the texts come as vectors
  Normalizer<B> motion_normalizer;
  std::optional<Normalizer<B>> text_normalizer{};  // of MDM-SMPL

  static constexpr auto fields() {
    using M = DiffusionModel;
    return motionlang::fields("denoiser", &M::denoiser, "text_encoder", &M::text_encoder, "motion_normalizer",
                              &M::motion_normalizer, "text_normalizer", &M::text_normalizer);
  }
};

/// Motions with a text each, normalised.
template <Backend B>
struct DiffusionBatch {
  std::vector<std::string> texts;
  Sequences<B> x0;             // with the padding that the network sees
  std::vector<Index> lengths;  // frames without padding
};

/// The place of motions in the batch from which random numbers are drawn: by default they are all of it.
struct DiffusionPlace {
  Index first = 0, first_row = 0;  // motions and rows before them
  Index longest = 0;               // the most frames in the batch, if not among these motions
};

namespace detail {

template <AutodiffBackend Tape, class System>
using TextDiffusionTask = DiffusionTask<
    EpochTask<typename System::Config, DiffusionModel<Tape, System>, DiffusionModel<typename Tape::inner, System>>,
    System::drops_last>;

/// Deviations whose root and contacts are divided by `bias`.
template <Backend B>
Normalizer<B> with_feature_bias(Normalizer<B> n, double bias) {
  const Index width = n.std.size(0), joints = (width + 1) / 12;
  n.std = Tensor<B, 1>::from(tm2t_deviation(n.std.to_vector(), joints, bias, 1), {width});
  return n;
}

/// The same features over another backend.
template <Backend To, Backend From>
TextFeatures<To> converted(const TextFeatures<From>& f) {
  const auto rows = f.tokens.rows.span();
  const std::vector<typename To::scalar> values(rows.begin(), rows.end());
  return {{Tensor<To, 2>::from(values, f.tokens.rows.shape()), f.tokens.offsets}, f.end_position, f.padded_tokens};
}

}  // namespace detail

template <AutodiffBackend Tape, class System>
class DiffusionTraining : public detail::TextDiffusionTask<Tape, System> {
 public:
  using Base = detail::TextDiffusionTask<Tape, System>;
  using typename Base::A, typename Base::B, typename Base::Config;

  /// data         must outlive the training
  /// texts        vectors of its texts (diffusion_texts); none for text.encoder = word_pieces
  /// statistics   a folder with those of the features; empty: those of the training motions
  /// Throws       config_error 101, 102, 103 for an invalid configuration
  DiffusionTraining(Config config, const DescribedMotions& data, DiffusionTexts<B> texts = {},
                    const std::filesystem::path& statistics = {});

  void update(const Gradients<A>& gradients, Index step) {
    // From this step on the rate of the average no longer grows.
    constexpr Index no_warmup = std::numeric_limits<std::int32_t>::max();
    learner_.update(gradients, config_.optimiser.rate(step, this->steps()),
                    System::ema_warmup(config_) ? step : no_warmup);
  }
  std::map<std::string, std::string> settings() const;

  /// One term: the published loss of the system.
  LossTerms<A> loss(Philox rng, Index step, const Context& context) const {
    return part_loss(rng, step, {0, this->samples(step)}, context);
  }
  LossTerms<A> part_loss(Philox rng, Index step, const BatchPart& part, const Context& context) const;
  /// The loss without dropout, of first texts and always with the same noise.
  std::vector<Measure> validate();

  /// Writes the folder of the model. `about`: license and provenance, which are required, data, command, ...
  void save(const std::filesystem::path& folder, const std::map<std::string, std::string>& about);

 private:
  template <Backend T>
  using Model = DiffusionModel<T, System>;

  Index text_width() const { return texts_.encode ? texts_.width : config_.text.width; }
  Normalizer<B> motion_statistics(const std::filesystem::path& folder) const;
  Normalizer<B> text_statistics() const;
  /// pick(motion, place in the batch, its frames) -> DiffusionItem
  template <Backend T, class Pick>
  DiffusionBatch<T> batch_of(const Model<T>& model, const std::vector<DescribedMotion>& motions,
                             std::span<const Index> which, Pick pick) const;
  template <Backend T>
  TextFeatures<T> texts_of(const Model<T>& model, std::span<const std::string> texts, const Context& context) const;
  template <Backend T>
  Tensor<T, 0> loss_of(const Model<T>& model, const DiffusionBatch<T>& batch, const Philox& rng, double drop,
                       const Context& context, const DiffusionPlace& place = {}) const;

  using Base::config_, Base::data_, Base::diffusion_, Base::learner_;
  DiffusionTexts<B> texts_;
};

template <AutodiffBackend A>
using MdmSmplTraining = DiffusionTraining<A, MdmSmplSystem>;
template <AutodiffBackend A>
using MdmTraining = DiffusionTraining<A, MdmSystem>;
template <AutodiffBackend A>
using MotionDiffuseTraining = DiffusionTraining<A, MotionDiffuseSystem>;

template <AutodiffBackend Tape, class System>
DiffusionTraining<Tape, System>::DiffusionTraining(Config config, const DescribedMotions& data, DiffusionTexts<B> texts,
                                                   const std::filesystem::path& statistics)
    : Base(System::name, std::move(config), data), texts_(std::move(texts)) {
  const bool pieces = config_.text.encoder == "word_pieces";
  if (pieces == static_cast<bool>(texts_.encode))
    raise<config_error>(102, "text.encoder = ", config_.text.encoder,
                        pieces ? " learns its own vectors of texts; others were given" : " needs vectors of the texts");
  const auto rng = Philox{.seed = this->seed()}.split("init");
  Model<B> model{.denoiser = System::template make<B>(config_, data_->width, text_width(), rng.split("denoiser")),
                 .motion_normalizer = motion_statistics(statistics)};
  if (pieces) {
    std::vector<std::string> all;
    for (const DescribedMotion& m : data_->training) {
      for (const DescribedText& t : m.texts) all.push_back(t.text);
    }
    const auto& t = config_.text;
    auto words = rng.split("words");
    BertConfig sizes;
    sizes.width = t.width, sizes.heads = t.num_heads, sizes.d_ff = t.ff_size, sizes.layers = t.num_layers;
    sizes.dropout = t.dropout;
    model.text_encoder.emplace(sizes, own_vocabulary(all, t.vocabulary), !System::states(config_), words);
  }
  if constexpr (std::is_same_v<System, MdmSmplSystem>)
    model.text_normalizer = pieces ? Normalizer<B>::identity(text_width()) : text_statistics();
  this->begin(std::move(model));
}

template <AutodiffBackend Tape, class System>
auto DiffusionTraining<Tape, System>::motion_statistics(const std::filesystem::path& folder) const -> Normalizer<B> {
  if constexpr (std::is_same_v<System, MdmSmplSystem>) {
    if (!folder.empty()) return statistics_of<B>(folder, data_->width);
    FeatureStatistics statistics;  // of the frames of the first texts
    for (const DescribedMotion& m : data_->training) {
      const FrameSlice frames = first_item(m).frames;
      statistics.add(std::span<const float>(m.rows).subspan(static_cast<std::size_t>(frames.first * data_->width),
                                                            static_cast<std::size_t>(frames.length * data_->width)),
                     data_->width);
    }
    return detail::normalizer_of<B>(statistics);
  } else {
    Normalizer<B> out = statistics_of<B>(folder, *data_);
    if constexpr (std::is_same_v<System, MotionDiffuseSystem>)
      out = detail::with_feature_bias(std::move(out), config_.feat_bias);
    return out;
  }
}

template <AutodiffBackend Tape, class System>
auto DiffusionTraining<Tape, System>::text_statistics() const -> Normalizer<B> {
  FeatureStatistics statistics;
  for (const DescribedMotion& m : data_->training) {
    const auto rows = texts_.encode(std::span(&m.texts.front().text, 1)).tokens.rows;
    statistics.add(std::span<const typename B::scalar>(rows.span()), texts_.width);
  }
  return detail::normalizer_of<B>(statistics);
}

template <AutodiffBackend Tape, class System>
std::map<std::string, std::string> DiffusionTraining<Tape, System>::settings() const {
  auto out = Base::settings();
  if (const auto& own = learner_.average.text_encoder) {
    std::string& pieces = out["text.pieces"];
    for (const std::string& p : own->tokenizer.pieces->vocabulary()) pieces += p + "\n";
  }
  return out;
}

template <AutodiffBackend Tape, class System>
template <Backend T, class Pick>
DiffusionBatch<T> DiffusionTraining<Tape, System>::batch_of(const Model<T>& model,
                                                            const std::vector<DescribedMotion>& motions,
                                                            std::span<const Index> which, Pick pick) const {
  const FramePadding padding = System::pads(config_);
  const auto width = static_cast<std::size_t>(data_->width);
  DiffusionBatch<T> out;
  MotionBatch<T> batch(model.motion_normalizer);
  for (const Index i : which) {
    const DescribedMotion& m = motions[static_cast<std::size_t>(i)];
    const DiffusionItem item = pick(m, std::ssize(out.texts), std::ssize(m.rows) / data_->width);
    out.texts.push_back(item.text);
    out.lengths.push_back(item.frames.length);
    const auto rows = std::span<const float>(m.rows).subspan(static_cast<std::size_t>(item.frames.first) * width,
                                                             static_cast<std::size_t>(item.frames.length) * width);
    if (padding.normalised || padding.frames == 0) {
      batch.add(rows);
    } else {
      std::vector<float> padded(rows.begin(), rows.end());
      padded.resize(static_cast<std::size_t>(padding.frames) * width);
      batch.add(padded);
    }
  }
  out.x0 = batch.normalized();
  if (padding.normalised && padding.frames > 0) out.x0 = from_equal(to_padded(out.x0, 0, padding.frames));
  return out;
}

template <AutodiffBackend Tape, class System>
template <Backend T>
TextFeatures<T> DiffusionTraining<Tape, System>::texts_of(const Model<T>& model, std::span<const std::string> texts,
                                                          const Context& context) const {
  auto out = model.text_encoder ? (*model.text_encoder)(texts, context) : detail::converted<T>(texts_.encode(texts));
  if (model.text_normalizer) out.tokens.rows = model.text_normalizer->normalize(out.tokens.rows);
  return out;
}

template <AutodiffBackend Tape, class System>
template <Backend T>
Tensor<T, 0> DiffusionTraining<Tape, System>::loss_of(const Model<T>& model, const DiffusionBatch<T>& batch,
                                                      const Philox& rng, double drop, const Context& context,
                                                      const DiffusionPlace& place) const {
  const auto drawn = this->draws(rng, place.first, std::ssize(batch.texts), drop);
  const NoisedMotions<T> noised = this->with_noise(batch.x0, place.first_row, rng, drawn.t);
  auto text = texts_of(model, batch.texts, context);
  if (drop > 0) {
    const std::vector<typename T::scalar> kept(drawn.kept.begin(), drawn.kept.end());
    const auto factor = Tensor<T, 2>::from(kept, {std::ssize(kept), 1});
    text.tokens.rows = text.tokens.rows * repeat_for_rows(factor, text.tokens.offsets);
  }
  return System::loss(diffusion_, model.denoiser, noised, std::span<const Index>(batch.lengths), text, context,
                      place.longest);
}

/// All items of the batch are drawn, and the motions of the part are read.
template <AutodiffBackend Tape, class System>
auto DiffusionTraining<Tape, System>::part_loss(Philox rng, Index step, const BatchPart& part,
                                                const Context& context) const -> LossTerms<A> {
  const std::vector<Index> which = this->motions_of(step);
  const auto items_rng = rng.split("items");
  const Index padded = System::pads(config_).frames;
  std::vector<DiffusionItem> items;
  std::vector<Index> lengths;
  DiffusionPlace place{.first = part.first};
  for (Index i = 0; i < std::ssize(which); ++i) {
    const DescribedMotion& m = data_->training[static_cast<std::size_t>(which[static_cast<std::size_t>(i)])];
    items.push_back(
        System::item(config_, m, std::ssize(m.rows) / data_->width, items_rng.split(static_cast<std::uint64_t>(i))));
    const Index frames = items.back().frames.length;
    lengths.push_back(frames);
    place.longest = std::max(place.longest, frames);
    if (i < part.first) place.first_row += padded > 0 ? padded : frames;
  }
  const auto batch = batch_of<A>(
      learner_.model, data_->training, part.of(which),
      [&](const DescribedMotion&, Index i, Index) { return items[static_cast<std::size_t>(part.first + i)]; });
  LossTerms<A> out;
  out.add("loss", System::share(part, std::span<const Index>(lengths)),
          loss_of<A>(learner_.model, batch, rng, System::drops_texts ? config_.text.drop : 0, context, place));
  return out;
}

template <AutodiffBackend Tape, class System>
std::vector<Measure> DiffusionTraining<Tape, System>::validate() {
  return {{"loss", this->over_validation([&](std::span<const Index> which, const Philox& rng) {
             const auto batch = batch_of<B>(learner_.average, data_->validation, which,
                                            [](const DescribedMotion& m, Index, Index) { return System::first(m); });
             return static_cast<double>(loss_of<B>(learner_.average, batch, rng, 0, {}).item());
           })}};
}

template <AutodiffBackend Tape, class System>
void DiffusionTraining<Tape, System>::save(const std::filesystem::path& folder,
                                           const std::map<std::string, std::string>& about) {
  const Model<B>& model = this->result();
  DiffusionRun run = detail::described_texts(System::name, config_.text, System::states(config_));
  run.steps = config_.diffusion.steps, run.schedule = config_.diffusion.schedule, run.fps = data_->fps;
  System::describe(run, config_, data_->width, text_width());
  ModelFolder description = detail::described_diffusion(System::name, run, about);
  description.others["training"] = config_json(config_);
  TensorStore store;
  store.add_module(model.denoiser, System::prefix);
  store.add_module(model.motion_normalizer, "motion_normalizer.");
  if (model.text_normalizer) store.add_module(*model.text_normalizer, "text_normalizer.");
  if (model.text_encoder) write_own_text_encoder(folder / "text_encoder", *model.text_encoder);
  overwrite_model(folder, description, store);
}

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED_TRAINING
#include <motionlang/backend/detail/eigen_class.hpp>
extern template class motionlang::DiffusionTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>,
                                                    motionlang::MdmSmplSystem>;
extern template class motionlang::Trainer<
    motionlang::DiffusionTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>, motionlang::MdmSmplSystem>>;
extern template class motionlang::DiffusionTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>,
                                                    motionlang::MdmSystem>;
extern template class motionlang::Trainer<
    motionlang::DiffusionTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>, motionlang::MdmSystem>>;
extern template class motionlang::DiffusionTraining<motionlang::Autodiff<motionlang::EigenBackend<float>>,
                                                    motionlang::MotionDiffuseSystem>;
extern template class motionlang::Trainer<motionlang::DiffusionTraining<
    motionlang::Autodiff<motionlang::EigenBackend<float>>, motionlang::MotionDiffuseSystem>>;
#endif
