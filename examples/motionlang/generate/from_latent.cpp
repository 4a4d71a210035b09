#include "from_actions.hpp"

#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

namespace program {

using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

/// What brings a clip over another as a whole: the mean turn between their roots, then the mean way over the floor.
ml::Placement placement_over(const ml::Motion& clip, const ml::Motion& other) {
  const Index frames = std::min(clip.frames(), other.frames());
  double sine = 0, cosine = 0;
  for (Index f = 0; f < frames; ++f) {
    const double turn = ml::turn_between(clip.rotations(f)[0], other.rotations(f)[0]);
    sine += std::sin(turn), cosine += std::cos(turn);
  }
  ml::Placement p{std::atan2(sine, cosine), {}};
  ml::Vec3<double> way{};
  for (Index f = 0; f < frames; ++f) way = way + other.root_at(f) - p(clip.root_at(f));
  p.shift = {way.x / static_cast<double>(frames), 0, way.z / static_cast<double>(frames)};
  return p;
}

}  // namespace

std::vector<ml::Motion> FromLatent::between(const ml::Timeline& from, const ml::Timeline& to, Index count,
                                            const GenerationSettings& settings) const {
  require_no_noise(settings);
  require_no_sampling(settings);
  if (count < 2)
    ml::raise<usage_error>(101, ml::counted(count, "motion"),
                           " from one text or action towards another: both ends are among them");
  auto motions = line(from, to, count, noise_of(settings, 0), settings.fact.value_or(1));
  for (ml::Motion& m : motions) m = finished(std::move(m), settings);
  return motions;
}

ml::Motion FromLatent::denoised(const ml::Motion& motion, const std::string& action) const {
  const ml::Motion seen = ml::resample(on_its_joints(motion), fps());
  const Index frames = seen.frames(), most = longest();
  const Index shared = std::min(std::max<Index>(2, most / 4), most - 1);
  const auto part = [&](Index first) { return decoded(ml::crop(seen, first, std::min(frames, first + most)), action); };
  ml::Motion out = part(0);
  for (Index end = most; end < frames;) {
    const Index first = std::min(end - shared, frames - most);
    ml::Motion next = part(first);
    next.skeleton = out.skeleton;  // bones found from positions differ a little from part to part
    out = ml::blend_into(out, next, out.frames() - first);
    end = first + most;
  }
  out = ml::resample(ml::placed(out, placement_over(out, seen)), motion.fps);
  out.name = motion.name;
  return out;
}

const FromLatent& from_latent(const Generator& generator, const std::string& option,
                              const std::filesystem::path& model) {
  const auto* const found = dynamic_cast<const FromLatent*>(&generator);
  if (found == nullptr)
    ml::raise<usage_error>(102, model.string(), ": ", option,
                           " is for models with one latent for every motion (ACTOR, TEMOS, TMR, SINC); this is ",
                           generator.system());
  return *found;
}

namespace {

/// Normal numbers times a factor.
struct ScaledNoise {
  ml::Philox rng;
  float factor = 1;

  void normal(std::span<float> out) {
    rng.normal(out);
    for (float& x : out) x *= factor;
  }
};

class FromActions final : public FromLatent {
 public:
  explicit FromActions(ActorLatents actor) : actor_(std::move(actor)) {}

  double fps() const override { return actor_.fps; }
  bool takes_actions() const override { return true; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings& settings) const override {
    const ml::Interval& wanted = only_text(timeline);
    const Index action = class_of(wanted.text), frames = wanted.end - wanted.start;
    require_frames(frames, actor_.model.fc_decoder.has_value());
    const auto rows = ml::generate(actor_.model, std::span(&action, 1), std::span(&frames, 1), noise,
                                   {.fact = settings.fact.value_or(1)})
                          .rows;
    return actor_.motion_of(rows.span());
  }
  std::vector<ml::Motion> line(const ml::Timeline& from, const ml::Timeline& to, Index count, ml::Philox noise,
                               double fact) const override {
    const ml::Interval &first = only_text(from), &last = only_text(to);
    ScaledNoise scaled{noise, static_cast<float>(fact)};
    const auto made = ml::interpolate_actions(actor_.model, class_of(first.text), class_of(last.text), count,
                                              first.end - first.start, scaled);
    std::vector<ml::Motion> motions;
    for (Index i = 0; i < count; ++i) motions.push_back(actor_.motion_of(made[i].span()));
    return motions;
  }
  ml::Motion on_its_joints(const ml::Motion& motion) const override { return on_smpl(motion); }
  ml::Motion decoded(const ml::Motion& motion, const std::string& action) const override {
    if (action.empty())
      ml::raise<usage_error>(102, "ACTOR has to know which action a motion shows to denoise it: --action names it");
    const Index known = class_of(action), frames = motion.frames(),
                width = actor_.model.config.njoints * actor_.model.config.nfeats;
    require_frames(frames, actor_.model.fc_encoder || actor_.model.fc_decoder);
    const ml::Sequences<B> x(ml::Tensor<B, 2>::from(as_floats(actor_.rows_of(motion)), {frames, width}),
                             ml::Offsets{frames});
    return actor_.motion_of(ml::denoise(actor_.model, x, std::span(&known, 1)).rows.span());
  }
  Index longest() const override { return actor_.longest; }

  /// Fully connected networks have motions of one length.
  void require_frames(Index frames, bool fully_connected) const {
    const Index wanted = actor_.model.config.num_frames;
    if (!fully_connected || frames == wanted) return;
    const auto seconds = [&](Index n) { return static_cast<double>(n) / fps(); };
    ml::raise<usage_error>(101, "a motion of ", ml::counted(frames, "frame"), " (", seconds(frames),
                           " s); this ACTOR is fully connected, its motions have ", ml::counted(wanted, "frame"), " (",
                           seconds(wanted), " s)");
  }
  Index class_of(const std::string& action) const {
    return action_of(action, actor_.labels, actor_.model.config.num_classes);
  }

  ActorLatents actor_;
};

}  // namespace

std::unique_ptr<Generator> from_actions(ActorLatents actor) { return std::make_unique<FromActions>(std::move(actor)); }

}  // namespace program
