// ACTOR and TEMOS, as their repositories leave them, behind the Generator: one text, or one action, for each motion.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/io/vae_run.hpp>

#include "../files/feature_motion.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

class ActorGenerator final : public EachAlone {
 public:
  explicit ActorGenerator(ml::ActorRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return 20; }  // the viewer's, of the repository; data have none

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings&) const override {
    const ml::Interval& wanted = only_text(timeline);
    const ml::Index action = action_of(wanted.text, run_.labels, run_.model.config.num_classes), frames = wanted.end - wanted.start;
    const auto rows = ml::generate(run_.model, std::span(&action, 1), std::span(&frames, 1), noise).rows;
    return ml::motion_of_actor(ml::actor_inverse(rows.span(), 24, run_.features), fps());
  }

  ml::ActorRun<B> run_;
};

class TemosGenerator final : public EachAlone {
 public:
  explicit TemosGenerator(ml::TemosRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return run_.fps; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings&) const override {
    const ml::Interval& wanted = only_text(timeline);
    const auto tokens = run_.text_encoder.encode<B>(std::span(&wanted.text, 1)).tokens;
    const auto x = ml::text_to_motion(run_.model, tokens, ml::Offsets{wanted.end - wanted.start}, noise);
    const auto rows = run_.normalizer.denormalize(x.front().rows);
    const std::vector<double> numbers(rows.span().begin(), rows.span().end());
    return motion_of_features(run_.width() == 64 ? "rifke64" : "smplvelp", numbers, run_.width(), run_.fps);
  }

  ml::TemosRun<B> run_;
};

}  // namespace

std::unique_ptr<Generator> load_actor(const std::filesystem::path& run) {
  return std::make_unique<ActorGenerator>(ml::load_actor_run<B>(ml::FilePath(run)));
}
std::unique_ptr<Generator> load_temos(const std::filesystem::path& run, const ModelSources& sources) {
  const ml::RunFolder folder = ml::find_run(run);
  if (!folder.weights.empty()) {
    const std::string system = ml::lightning_system(ml::open_weights(folder.weights));
    if (system == "teach") return load_teach(run, sources);
    if (system == "sinc") return load_sinc(run, sources);
  }
  return std::make_unique<TemosGenerator>(
      ml::load_temos_run<B>(folder, {.text_encoder = sources.text_encoder, .statistics = sources.statistics}));
}

}  // namespace program
