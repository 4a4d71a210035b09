// Training of ACTOR and of classifiers: windows of motions with the class of each.
#pragma once

#include <functional>

#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/metrics/accuracy.hpp>

#include "actor_model.hpp"
#include "body_points.hpp"
#include "epoch_task.hpp"

namespace program {

/// What both have in common. `Config` has clips, optimiser, validation and data.
template <class Config, ml::Module Tape, ml::Module Plain>
class ActionTask : public EpochTask<Config, Tape, Plain> {
 public:
  using Base = EpochTask<Config, Tape, Plain>;
  using Base::seed;
  using typename Base::A, typename Base::B;

  std::map<std::string, std::string> settings() const {
    auto out = Base::settings();
    for (const std::string& l : labels_) out["labels"] += l + "\n";
    return out;
  }
  ActionModelFile<Config> file() const { return {config_, labels_}; }

 protected:
  ActionTask(std::string system, Config config, const DescribedMotions& data, std::vector<std::string> labels)
      : Base(std::move(system), std::move(config), data),
        labels_(std::move(labels)),
        classes_(classes_of(data.training, labels_)),
        validation_classes_(classes_of(data.validation, labels_)) {}
  ActionBatch<A> batch(const ml::Philox& rng, ml::Index step) const {
    return action_batch<A>(data_->training, classes_, batches_(step, seed()), config_.clips, rng.split("windows"));
  }
  /// The same windows every time.
  ActionBatch<B> validation_batch(std::span<const ml::Index> which, const ml::Philox& rng) const {
    return action_batch<B>(data_->validation, validation_classes_, which, config_.clips, rng.split("windows"));
  }

  using Base::batches_, Base::config_, Base::data_, Base::learner_;
  std::vector<std::string> labels_;
  std::vector<ml::Index> classes_, validation_classes_;
};

class ActorTask : public ActionTask<ActorTrainingConfig, ml::Actor<TrainingTape>, ml::Actor<TrainingBackend>> {
 public:
  /// from       a model to go on from, whose labels are taken
  /// body       whose points are compared, unless losses.points is "joints"
  /// regressor  J_regressor_extra.npy, for points that need it
  ActorTask(const ActorTrainingConfig& config, const DescribedMotions& data, std::optional<ActorModel<B>> from,
            const std::filesystem::path& body, const std::filesystem::path& regressor)
      : ActionTask("actor", config, data, from ? from->file.labels : labels_of(data)) {
    const std::string& points = config_.losses.points;
    if ((points != "joints") != !body.empty())
      ml::raise<ml::config_error>(102, "losses.points = ", points, ", and --body is '", body.string(),
                                  "': points of a body need one, joints have none");
    if (config_.losses.vertstrans && body.empty())
      ml::raise<ml::config_error>(102, "losses.vertstrans is of points of a body; joints follow the way anyway");
    if (!body.empty()) {
      if (config_.clips.is_xyz())
        ml::raise<ml::config_error>(102, "losses.points = ", points, " are made of rotations; clips.pose is xyz");
      points_.emplace(points, body, regressor);
      taped_points_.emplace(*points_);
    } else if (!regressor.empty()) {
      ml::raise<ml::config_error>(102, "losses.points = joints has no use for --joint-regressor ", regressor.string());
    }
    auto rng = ml::Philox{.seed = seed()}.split("init");
    ml::Actor<B> model(actor_sizes(config_, std::ssize(labels_)), rng);
    if (from) {
      require_same_rows(from->file.config.clips, config_.clips);
      ml::zip_tensors(model, from->actor, [](const auto& to, const auto& given) {
        if (to.shape() != given.shape())
          ml::raise<ml::config_error>(102, "--from: '", to.path, "' is ", given.shape(), ", the settings make it ",
                                      to.shape());
        *to.data = *given.data;
      });
    }
    begin(std::move(model));
  }

  ml::LossTerms<A> loss(ml::Philox rng, ml::Index step, const ml::Context& context) const {
    return loss_of(learner_.model, batch(rng, step), rng, context);
  }
  std::vector<Measure> validate() {
    return {{"loss", over_validation([&](std::span<const ml::Index> which, const ml::Philox& rng) {
               const auto b = validation_batch(which, rng);
               return static_cast<double>(loss_of(learner_.average, b, rng, {}).total().item()) /
                      static_cast<double>(b.classes.size()) * static_cast<double>(config_.optimiser.batch);
             })}};
  }

 private:
  template <ml::Backend T>
  ml::LossTerms<T> loss_of(const ml::Actor<T>& model, const ActionBatch<T>& b, const ml::Philox& rng,
                           const ml::Context& context) const {
    const auto latent = model.encode(b.x, b.classes, context);
    auto noise = rng.split("noise");
    const auto written = model.teach(latent.sample(noise), b.classes, b.x, context);
    const auto& l = config_.losses;
    std::optional<ml::ActorLossPoints<T>> points;
    if (l.rcxyz != 0 || l.velxyz != 0) points = {points_of(b.x), points_of(written)};
    return ml::actor_losses(latent, b.x, written,
                            {.rc = l.rc, .rcxyz = l.rcxyz, .kl = l.kl, .vel = l.vel, .velxyz = l.velxyz}, points);
  }
  template <ml::Backend T>
  ml::Sequences<T> points_of(const ml::Sequences<T>& x) const {
    if (!points_) return joint_points(x, config_.clips);
    if constexpr (ml::AutodiffBackend<T>)
      return (*taped_points_)(x, config_.clips, config_.losses.vertstrans);
    else
      return (*points_)(x, config_.clips, config_.losses.vertstrans);
  }

  std::optional<BodyPoints<B>> points_;
  std::optional<BodyPoints<A>> taped_points_;  // the same
};

class ClassifierTask : public ActionTask<ClassifierConfig, Classifier<TrainingTape>, Classifier<TrainingBackend>> {
 public:
  /// generator  an ACTOR that makes config.generated_share of the motions that are learned from; its labels are taken
  /// read       the same data in other rows, for an ACTOR of another pose representation that is given recorded ones
  ClassifierTask(const ClassifierConfig& config, const DescribedMotions& data, std::optional<ActorModel<B>> generator,
                 const std::function<DescribedMotions(const RowMaker&)>& read)
      : ActionTask("classifier", config, data, generator ? generator->file.labels : labels_of(data)),
        generator_(std::move(generator)),
        known_clips_(config_.clips) {
    const double share = config_.generated_share;
    const std::string& kind = config_.generated_kind;
    if (share < 0 || share > 1) ml::raise<ml::config_error>(101, "generated_share ", share, " is not in [0, 1]");
    if ((share > 0) != generator_.has_value())
      ml::raise<ml::config_error>(102, "generated_share = ", share, ", and --generated is ",
                                  generator_ ? "given" : "not given", ": one needs the other");
    if (kind != "sampled" && kind != "denoised" && kind != "interpolated")
      ml::raise<ml::config_error>(103, "generated_kind '", kind, "' is not sampled, denoised or interpolated");
    if (generator_) {
      const ActorClipsConfig& clips = generator_->file.config.clips;
      require_same_clips(clips, config_.clips);
      if (kind != "sampled") {
        known_clips_.pose = clips.pose;
        known_clips_.translation = clips.translation;
        known_clips_.global = clips.global;
        known_clips_.camera = clips.camera;
      }
      if (known_clips_.pose != config_.clips.pose || known_clips_.width() != config_.clips.width() ||
          known_clips_.camera != config_.clips.camera)
        known_ = read(actor_row_maker(known_clips_));
    }
    begin(Classifier<B>(config_, std::ssize(labels_), ml::Philox{.seed = seed()}.split("init")));
  }

  ml::LossTerms<A> loss(ml::Philox rng, ml::Index step, const ml::Context&) {
    const auto b = generator_ ? partly_generated(rng, step) : batch(rng, step);
    ml::LossTerms<A> out;
    out.add("cross entropy", 1, ml::cross_entropy(learner_.model.train(b.x, config_.clips, rng).logits, b.classes));
    return out;
  }
  std::vector<Measure> validate() {
    double right = 0;
    const double loss = over_validation([&](std::span<const ml::Index> which, const ml::Philox& rng) {
      const auto b = validation_batch(which, rng);
      const auto logits = learner_.average(b.x, config_.clips, rng).logits;
      const auto confusion =
          ml::confusion_matrix(ml::Rows(logits.span(), logits.size(1)), std::span<const ml::Index>(b.classes));
      right += ml::accuracy(confusion) * static_cast<double>(b.classes.size());
      return static_cast<double>(ml::cross_entropy(logits, b.classes).item());
    });
    return {{"loss", loss}, {"accuracy", right / static_cast<double>(data_->validation.size()), true}};
  }

 private:
  /// The batch of a step. Generated motions replace some of its motions, which are drawn at random.
  ActionBatch<A> partly_generated(const ml::Philox& rng, ml::Index step) const {
    auto lot = rng.split("generated");
    std::vector<ml::Index> kept, replaced;
    for (const ml::Index i : batches_(step, seed()))
      (lot.uniform() < config_.generated_share ? replaced : kept).push_back(i);
    std::vector<ActionBatch<B>> parts;
    if (!kept.empty())
      parts.push_back(action_batch<B>(data_->training, classes_, kept, config_.clips, rng.split("windows")));
    if (!replaced.empty()) parts.push_back(generated(replaced, lot));
    ActionBatch<A> out;
    std::vector<typename B::scalar> values;
    std::vector<ml::Index> lengths;
    for (const ActionBatch<B>& part : parts) {
      values.insert(values.end(), part.x.rows.span().begin(), part.x.rows.span().end());
      for (ml::Index i = 0; i < part.x.count(); ++i) lengths.push_back(part.x.offsets.length(i));
      out.classes.insert(out.classes.end(), part.classes.begin(), part.classes.end());
    }
    const ml::Offsets offsets{std::span<const ml::Index>(lengths)};
    out.x = {ml::Tensor<A, 2>::from(values, {offsets.rows(), config_.clips.width()}), offsets};
    return out;
  }
  /// Motions of the generator in the places of recorded ones.
  ActionBatch<B> generated(std::span<const ml::Index> which, const ml::Philox& rng) const {
    const RecognitionSets<B> sets{*generator_, known_ ? known_->training : data_->training, classes_, known_clips_,
                                  config_.clips};
    const auto windows = rng.split("windows"), noise = rng.split("noise");
    if (config_.generated_kind == "denoised") return sets.denoised(which, windows);
    if (config_.generated_kind == "interpolated") return sets.interpolated(which, windows, rng.split("others"), noise);
    return sets.sampled(which, windows, noise);
  }

  std::optional<ActorModel<B>> generator_;
  ActorClipsConfig known_clips_;           // windows as the generator is given them
  std::optional<DescribedMotions> known_;  // the data in its rows, where these are others
};

}  // namespace program
