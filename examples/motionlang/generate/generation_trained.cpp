// What train-temos, train-tmr and train-actor leave, and TMR as its repository leaves it, behind the Generator: one text, or one action, for each motion.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../files/feature_motion.hpp"
#include "../train/actor_model.hpp"
#include "../train/text_motion_model.hpp"
#include "../train/text_sources.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

template <template <class> class System>
class TrainedTextMotion final : public EachAlone {
 public:
  TrainedTextMotion(const std::filesystem::path& folder, const TextMotionFile& file, std::filesystem::path text_encoder)
      : model_(load_text_motion<System, B>(folder, file)),
        features_(&ml::motion_features(file.config.features)),
        text_encoder_(std::move(text_encoder)) {
    if (!model_.words && text_encoder_.empty())
      ml::raise<ml::config_error>(102, folder.string(), ": this model reads the states of ", file.config.text.encoder,
                                  ": --text-encoder names it");
  }

  double fps() const override { return features_->fps; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings&) const override {
    const ml::Interval& wanted = only_text(timeline);
    const std::span text(&wanted.text, 1);
    std::optional<ml::EmbeddingCache> states;
    if (!model_.words) states = token_states(text_encoder_, text);
    const auto tokens = model_.tokens(text, states ? &*states : nullptr);
    const auto x = ml::text_to_motion(model_.system, tokens, ml::Offsets{wanted.end - wanted.start}, noise);
    return motion_of_features(*features_, model_.motion_normalizer.denormalize(x.front().rows).span());
  }

  TextMotionModel<B, System> model_;
  const ml::MotionFeatures* features_;
  std::filesystem::path text_encoder_;
};

class TrainedActor final : public EachAlone {
 public:
  explicit TrainedActor(const std::filesystem::path& folder) : model_(folder) {}

  double fps() const override { return model_.file.config.clips.fps; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings&) const override {
    const ml::Interval& wanted = only_text(timeline);
    const auto& file = model_.file;
    const ml::Index action = action_of(wanted.text, file.labels, std::ssize(file.labels)),
                    frames = wanted.end - wanted.start;
    const auto rows = ml::generate(model_.actor, std::span(&action, 1), std::span(&frames, 1), noise).rows;
    ml::Motion out = actor_motion(rows.span(), file.config.clips);
    ml::place_on_floor(out);  // its way counts from the first frame
    return out;
  }

  ActorModel<B> model_;
};

}  // namespace

std::unique_ptr<Generator> load_trained_text_motion(const std::filesystem::path& folder, const ModelSources& sources) {
  const TextMotionFile file = read_text_motion_config(folder);
  if (file.system == "tmr") return std::make_unique<TrainedTextMotion<ml::Tmr>>(folder, file, sources.text_encoder);
  return std::make_unique<TrainedTextMotion<ml::Temos>>(folder, file, sources.text_encoder);
}
std::unique_ptr<Generator> load_trained_actor(const std::filesystem::path& folder) {
  return std::make_unique<TrainedActor>(folder);
}

}  // namespace program
