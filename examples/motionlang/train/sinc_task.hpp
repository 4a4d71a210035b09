// Training of SINC: actions alone, actions at the same time, and actions that are combined from two motions.
#pragma once

#include <algorithm>
#include <set>

#include <motionlang/datasets/sinc_items.hpp>
#include <motionlang/text/joined_labels.hpp>

#include "babel_task.hpp"

namespace program {

class SincTask : public BabelTask<ml::Sinc, SincTrainingConfig> {
 public:
  using Base = BabelTask<ml::Sinc, SincTrainingConfig>;

  /// table   body parts of all labels; null if no actions are combined. Outlives the task, as the data do.
  /// Throws  config_error 103 for a label that the table lacks, 102 if table and data.proportion contradict each other
  SincTask(SincTrainingConfig config, const DescribedMotions& data, TextStates states,
           const std::filesystem::path& statistics, const ml::BodyPartTable* table)
      : Base(std::move(config), data, std::move(states), sentences(data), statistics) {
    if ((table == nullptr) != (config_.data.proportion == 0))
      ml::raise<ml::config_error>(102, table == nullptr
                                           ? "data.proportion above 0 needs --body-parts, a table of the body parts of "
                                             "labels; without one: --set data.proportion=0"
                                           : "--body-parts is for data.proportion above 0");
    if (table == nullptr) return;
    const std::set<std::string> known(table->labels().begin(), table->labels().end());
    std::vector<ml::SincItem> items;
    for (const DescribedMotion& m : data.training) {
      const auto labels = labels_of(m);
      for (const std::string& label : labels) {
        if (!known.contains(label))
          ml::raise<ml::config_error>(103, "--body-parts: no parts of '", label, "' (", m.id, ")");
      }
      items.push_back({source_of(m.id), labels, std::ssize(m.rows) / data.width});
    }
    items_.emplace(std::move(items), *table);
  }

  ml::LossTerms<A> loss(ml::Philox rng, ml::Index step, const ml::Context& context) const {
    auto draws = rng.split("items"), conjunctions = rng.split("conjunctions");
    const ml::SincDrawOptions options{.proportion = config_.data.proportion,
                                      .random = config_.data.random,
                                      .window = {.request = config_.data.window, .shortest = config_.data.shortest}};
    std::vector<std::string> texts;
    MotionBatch<A> batch(learner_.model.motion_normalizer);
    for (const ml::Index k : batches_(step, seed())) {
      const DescribedMotion& m = training_motion(k);
      ml::SincElement e{{}, labels_of(m), {}, {}};
      if (items_)
        e = items_->draw(k, options, draws);
      else
        e.window = options.window.of(std::ssize(m.rows) / data_->width, [&](ml::Index n) {
          return static_cast<ml::Index>(draws.below(static_cast<std::uint32_t>(n)));
        });
      texts.push_back(ml::join_labels(e.labels, static_cast<ml::Conjunction>(conjunctions.below(5))));
      if (e.partner)
        batch.add(composed(m, e.parts[0], training_motion(*e.partner), e.parts[1]));
      else
        batch.add(m.rows, e.window);
    }
    return loss_of(learner_.model, texts, batch.normalized(), rng.split("noise"), context);
  }

  /// The loss without dropout, of whole motions and the published evaluation's sentences, with the same noise always.
  std::vector<Measure> validate() {
    return {{"loss", Base::over_validation([&](std::span<const ml::Index> which, const ml::Philox& rng) {
               std::vector<std::string> texts;
               MotionBatch<B> batch(learner_.average.motion_normalizer);
               for (const ml::Index i : which) {
                 const DescribedMotion& m = validation_motion(i);
                 texts.push_back(ml::join_labels(labels_of(m), ml::Conjunction::same_time));
                 batch.add(m.rows);
               }
               const auto terms = loss_of(learner_.average, texts, batch.normalized(), rng, {});
               return static_cast<double>(terms.total().item());
             })}};
  }

 private:
  /// Every label with itself in every sentence: the words that there are.
  static std::vector<std::string> sentences(const DescribedMotions& data) {
    std::vector<std::string> out;
    for (const DescribedMotion& m : data.training) {
      for (const DescribedText& t : m.texts) {
        for (std::uint32_t c = 0; c < 5; ++c)
          out.push_back(ml::join_labels(std::vector{t.text, t.text}, static_cast<ml::Conjunction>(c)));
      }
    }
    return out;
  }
  static ml::SincSource source_of(const std::string& key) {
    return key.starts_with("seg-")             ? ml::SincSource::segment
           : key.starts_with("seq-")           ? ml::SincSource::sequence
           : key.starts_with("spatial_pairs-") ? ml::SincSource::simultaneous
                                               : ml::SincSource::pair;
  }
  /// Rows of two motions in one, turned ahead once more.
  std::vector<float> composed(const DescribedMotion& a, const ml::SincParts& parts_a, const DescribedMotion& b,
                              const ml::SincParts& parts_b) const {
    const auto motion_of = [](const DescribedMotion& m) {
      return ml::smplvelp_inverse(std::span<const float>(m.rows));
    };
    const auto both = ml::compose_motions(motion_of(a), parts_a, motion_of(b), parts_b);
    return ml::smplvelp_features(std::span<const ml::Matrix3<float>>(both.rotations),
                                 std::span<const ml::Vec3<float>>(both.trans),
                                 {.exact_yaw = config_.features == "smplvelp"});
  }

  template <ml::Backend T>
  ml::LossTerms<T> loss_of(const Model<T>& model, const std::vector<std::string>& texts,
                           const ml::Sequences<T>& motions, const ml::Philox& rng, const ml::Context& context) const {
    const auto& l = config_.losses;
    const ml::SincTexts<T> states{Base::tokens(model, texts)};
    const auto noise = ml::TextMotionNoise<T>::draw(motions.count(), config_.network.latent_dim, rng);
    auto options = ml::sinc_loss_options();
    options.recons = l.recons, options.kl = l.kl, options.latent = l.latent;
    return model.system.losses(model.system.branches(states, motions, noise, context), states, motions, options);
  }

  std::optional<ml::SincItems> items_;
};

}  // namespace program
