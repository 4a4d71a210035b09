// MDM's models of actions, as their repository leaves them, behind the Generator: one action for each motion.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/mdm_action_run.hpp>

#include "../files/feature_motion.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

class MdmActionGenerator final : public EachAlone {
 public:
  explicit MdmActionGenerator(ml::MdmActionRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return run_.fps; }
  std::string system() const override { return diffusion_model; }
  ml::Index steps() const override { return run_.model.diffusion.steps(); }
  bool takes_actions() const override { return true; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings& s) const override {
    const ml::Interval& wanted = only_text(timeline);
    const ml::MdmConfig& c = run_.model.denoiser.config;
    const ml::Index action = action_of(wanted.text, run_.labels, c.num_actions), frames = wanted.end - wanted.start;
    if (frames > c.crop_frames)
      ml::raise<ml::timeline_error>(508, "'", wanted.text, "' has ", ml::counted(frames, "frame"), ", the model makes ",
                                    c.crop_frames);
    const std::string sampler = s.sampler.empty() ? "ddpm" : s.sampler;
    const auto made = run_.model.generate(
        std::span(&action, 1), noise,
        {.steps = s.steps.value_or(0), .guidance = s.guidance, .sampler = ml::parse_sampler(sampler)});
    const auto rows = ml::slice(made.rows, 0, 0, frames);  // made as long as in training, and cut
    return ml::motion_of_actor(ml::actor_inverse(rows.span(), 24, run_.features), run_.fps);
  }

  ml::MdmActionRun<B> run_;
};

}  // namespace

std::unique_ptr<Generator> load_mdm_actions(const std::filesystem::path& run) {
  return std::make_unique<MdmActionGenerator>(ml::load_mdm_action_run<B>(ml::find_run(run)));
}

}  // namespace program
