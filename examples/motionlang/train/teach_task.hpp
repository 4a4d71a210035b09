// Training of TEACH: two actions, one after the other.
#pragma once

#include "babel_task.hpp"

namespace program {

class TeachTask : public BabelTask<ml::Teach, TeachTrainingConfig> {
 public:
  using Base = BabelTask<ml::Teach, TeachTrainingConfig>;

  TeachTask(TeachTrainingConfig config, const DescribedMotions& data, const TextStates& states,
            const std::filesystem::path& statistics)
      : Base(std::move(config), data, kept(states, data), labels(data), statistics) {}

  ml::LossTerms<A> loss(ml::Philox rng, ml::Index step, const ml::Context& context) const {
    return loss_of(learner_.model, data_->training, batches_(step, seed()), rng.split("noise"), context);
  }
  /// The loss without dropout, with the same noise every time.
  std::vector<Measure> validate() {
    return {{"loss", Base::over_validation([&](std::span<const ml::Index> which, const ml::Philox& rng) {
               const auto terms = loss_of(learner_.average, data_->validation, which, rng, {});
               return static_cast<double>(terms.total().item());
             })}};
  }

 private:
  static std::vector<std::string> labels(const DescribedMotions& data) {
    std::vector<std::string> out;
    for (const DescribedMotion& m : data.training) {
      for (const DescribedText& t : m.texts) out.push_back(t.text);
    }
    return out;
  }
  /// The states of all labels, asked for once.
  static TextStates kept(const TextStates& states, const DescribedMotions& data) {
    if (!states) return states;
    return [all = std::make_shared<const ml::EmbeddingCache>(states(all_texts(data)))](
               std::span<const std::string> texts) { return states_of(*all, texts); };
  }

  template <ml::Backend T>
  ml::LossTerms<T> loss_of(const Model<T>& model, const std::vector<DescribedMotion>& motions,
                           std::span<const ml::Index> which, const ml::Philox& rng, const ml::Context& context) const {
    std::vector<std::string> first_texts, second_texts;
    MotionBatch<T> first(model.motion_normalizer), second(model.motion_normalizer);
    std::vector<ml::Index> transitions;
    for (const ml::Index i : which) {
      const DescribedMotion& m = motions[static_cast<std::size_t>(i)];
      const DescribedText &a = m.texts[0], &b = m.texts[1];
      const ml::Index cut = a.frames.length, action = b.frames.first;
      first_texts.push_back(a.text), second_texts.push_back(b.text);
      first.add(m.rows, a.frames);
      second.add(m.rows, {cut, action + b.frames.length - cut});
      transitions.push_back(action - cut);
    }
    const ml::TeachPairs<T> pairs{Base::tokens(model, first_texts), Base::tokens(model, second_texts),
                                  first.normalized(), second.normalized(),
                                  ml::Offsets(std::span<const ml::Index>(transitions))};
    const auto noise = ml::TeachNoise<T>::draw(std::ssize(which), config_.network.latent_dim, rng);
    const auto& l = config_.losses;
    ml::TeachLossOptions options{.loss_on_transition = l.loss_on_transition, .velocity = l.velocity};
    options.each.recons = l.recons, options.each.kl = l.kl, options.each.latent = l.latent;
    return ml::teach_losses(model.system.branches(pairs, noise, context, config_.network.teacher_forcing), pairs,
                            options);
  }
};

}  // namespace program
